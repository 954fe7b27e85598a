// SPDX-License-Identifier: BSD-3-Clause
// What the samples of a depth buffer mean.
#include <math.h>

#include "pixel/depth_rows.h"
#include "pixel/depth.h"

void hf_setup_depth(struct hf_setup *s, const struct hf_depth *d, float pixel_aspect)
{
    const double n = d->near_plane, f = d->far_plane;
    switch (d->type) {
    case HF_DEPTH_VIEW:
        s->form = HF_FORM_Z;
        break;
    case HF_DEPTH_RAY:
        s->form = HF_FORM_RAY;
        s->ray_cx = d->center_x;
        s->ray_cy = d->center_y;
        s->ray_sx = (float)(1 / ((double)d->focal_px * d->focal_px));
        s->ray_sy = (float)(1 / ((double)d->focal_px * d->focal_px * pixel_aspect * pixel_aspect));
        break;
    case HF_DEPTH_NDC_D3D:
    case HF_DEPTH_NDC_GL:
        // 1/z = 1/f + e (1/n - 1/f) with e = 1 - d. That difference is exact where depth values are densest; 1/n - d
        // (1/n - 1/f) would cancel there.
        s->form = HF_FORM_IZ;
        s->e_a = d->type == HF_DEPTH_NDC_GL ? 0.5f : 1;
        s->e_b = d->type == HF_DEPTH_NDC_GL ? -0.5f : -1;
        s->iz_a = (float)(1 / f);
        s->iz_b = (float)(1 / n - 1 / f);
        break;
    case HF_DEPTH_NDC_REVERSED:
        s->form = HF_FORM_IZ;
        s->e_a = 0;
        s->e_b = 1;
        s->iz_a = (float)(1 / f);
        s->iz_b = (float)(1 / n - 1 / f);
        break;
    case HF_DEPTH_INVERSE:
        s->form = HF_FORM_IZ;
        s->e_a = s->iz_a = 0;
        s->e_b = s->iz_b = 1;
        break;
    case HF_DEPTH_COC:
        s->form = HF_FORM_COC;
        break;
    }
}

float hf_depth_decode(const struct hf_setup *s, float d, int x, int y)
{
    if (d != d)
        return d;
    switch (s->form) {
    case HF_FORM_COC:
        return d;
    case HF_FORM_IZ: {
        const float iz = s->iz_a + s->iz_b * (s->e_a + s->e_b * d);
        return iz > 1e-10f ? 1 / iz : INFINITY;
    }
    case HF_FORM_RAY: {
        const float dx = (float)x + 0.5f - s->ray_cx, dy = (float)y + 0.5f - s->ray_cy;
        const float t = d > 0 && d < 1e10f ? d : INFINITY;
        return t / sqrtf(1 + (dx * dx * s->ray_sx + dy * dy * s->ray_sy));
    }
    case HF_FORM_Z:
    default:
        return d > 0 && d < 1e10f ? d : INFINITY;
    }
}

// The largest finite depth among the 8 neighbours; without one, no surface.
static float repair_depth(const struct hf_setup *s, const struct hf_depth *depth, int x, int y)
{
    float best = -INFINITY;
    for (int v = hf_max(y - 1, 0); v <= hf_min(y + 1, s->height - 1); v++)
        for (int u = hf_max(x - 1, 0); u <= hf_min(x + 1, s->width - 1); u++) {
            const float z = hf_depth_decode(s, hf_depth_sample(depth, u, v), u, v);
            if (hf_is_finite(z) && z > best)
                best = z;
        }
    return best > -INFINITY ? best : INFINITY;
}

float hf_depth_surface(const struct hf_setup *s, const struct hf_depth *depth, int x, int y, int *repaired)
{
    const float z = hf_depth_decode(s, hf_depth_sample(depth, x, y), x, y);
    *repaired = z != z;
    return z != z ? repair_depth(s, depth, x, y) : z;
}
