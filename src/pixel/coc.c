// SPDX-License-Identifier: BSD-3-Clause
// CoC generation: the normalised near and far circle of confusion of each pixel, from its depth.
#include <math.h>

#include "pixel/depth_rows.h"
#include "pixel/pass_c.h"

// Round a CoC as a storage does.
float hf_round_coc(enum hf_storage storage, float t)
{
    if (storage == HF_STORAGE_PACKED)
        return floorf(t * 255 + 0.5f) * (1 / 255.0f);
    return storage == HF_STORAGE_HALF ? hf_half_unpack(hf_half_pack(t)) : t;
}

float hf_coc_variable(const struct hf_frame *f, int x, int y, struct hf_counts *counts)
{
    const struct hf_setup *s = f->s;
    int repaired = 0;
    const float z = hf_depth_surface(s, f->depth, x, y, &repaired);
    if (counts) {
        counts->depth_repaired += (unsigned)repaired;
        counts->no_surface += z >= 1e10f;
    }
    return s->lens ? -1 / z : z;
}

// Near and far CoC of one pixel.
static void coc_pixel(const struct hf_frame *f, int x, int y, float *n, float *far, struct hf_counts *counts)
{
    const struct hf_setup *s = f->s;
    const float v = hf_coc_variable(f, x, y, counts);
    *n = hf_round_coc(s->storage, hf_ramp(s, (s->near_0 - v) * s->near_i));
    *far = hf_round_coc(s->storage, hf_ramp(s, (v - s->far_0) * s->far_i));
}

static void count(struct hf_counts *c, int lane, float n, float f)
{
    c->near_groups |= (uint64_t)(n > 0) << hf_group(lane);
    c->far_groups |= (uint64_t)(f > 0) << hf_group(lane);
    c->near_pixels += n > 0;
    c->far_pixels += f > 0;
    c->sharp_pixels += !(n > 0 || f > 0);
    c->near_max = n > c->near_max ? n : c->near_max;
    c->far_max = f > c->far_max ? f : c->far_max;
}

void hf_coc_row_c(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts)
{
    for (int i = 0; i < n; i++) {
        const int px = 2 * (x + i);
        coc_pixel(f, px, y, &out[0][i], &out[2][i], counts);
        if (counts)
            count(counts, x + i, out[0][i], out[2][i]);
        if (px + 1 < f->s->width) {
            coc_pixel(f, px + 1, y, &out[1][i], &out[3][i], counts);
            if (counts)
                count(counts, x + i, out[1][i], out[3][i]);
        } else {
            out[1][i] = out[0][i];
            out[3][i] = out[2][i];
        }
    }
}

int hf_sharp_row_c(const struct hf_frame *f, int x, int y, int n)
{
    for (int i = 2 * x; i < hf_min(2 * (x + n), f->s->width); i++) {
        float near, far;
        const float d = hf_depth_sample(f->depth, i, y);
        if (f->s->form != HF_FORM_Z || !(d > 0 && d < 1e10f))
            return 0;
        coc_pixel(f, i, y, &near, &far, NULL);
        if (near > 0 || far > 0)
            return 0;
    }
    return 1;
}
