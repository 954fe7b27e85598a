// SPDX-License-Identifier: BSD-3-Clause
// Reference: from depth to CoC, and the repair of bad samples.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/reference.h"

static double saturate(double v)
{
    return v > 0 ? (v < 1 ? v : 1) : 0;
}

// Depth between the clip planes, d = 0 at near and 1 at far.
static double from_ndc(double d, double n, double f)
{
    const double divisor = isinf(f) ? 1 - d : f - d * (f - n);
    return divisor > 0 ? (isinf(f) ? n : n * f) / divisor : INFINITY;
}

static double from_reversed(double d, double n, double f)
{
    const double divisor = isinf(f) ? d : n + d * (f - n);
    return divisor > 0 ? (isinf(f) ? n : n * f) / divisor : INFINITY;
}

// pixel_aspect: the focal length is in pixels of x.
static double view_depth(const struct hf_depth *depth, double pixel_aspect, double d, int x, int y)
{
    double z = d;
    switch (depth->type) {
    case HF_DEPTH_COC:
        return d;
    case HF_DEPTH_VIEW:
        z = d > 0 ? d : INFINITY;
        break;
    case HF_DEPTH_RAY: {
        const double tx = (x + 0.5 - depth->center_x) / depth->focal_px;
        const double ty = (y + 0.5 - depth->center_y) / (depth->focal_px * pixel_aspect);
        z = d > 0 ? d / sqrt(1 + tx * tx + ty * ty) : INFINITY;
        break;
    }
    case HF_DEPTH_NDC_D3D:
        z = from_ndc(d, depth->near_plane, depth->far_plane);
        break;
    case HF_DEPTH_NDC_GL:
        z = from_ndc((d + 1) / 2, depth->near_plane, depth->far_plane);
        break;
    case HF_DEPTH_NDC_REVERSED:
        z = from_reversed(d, depth->near_plane, depth->far_plane);
        break;
    case HF_DEPTH_INVERSE:
        z = d > 0 ? 1 / d : INFINITY;
        break;
    }
    return z >= 1e10 ? INFINITY : z;
}

void ref_depths(double *z, const struct hf_depth *depth, double pixel_aspect, int width, int height)
{
    double *raw = malloc(sizeof *raw * (size_t)width * (size_t)height);
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            float d;
            memcpy(&d, (const char *)depth->data + y * depth->stride + x * (ptrdiff_t)sizeof d, sizeof d);
            raw[y * width + x] = isnan(d) ? NAN : view_depth(depth, pixel_aspect, d, x, y);
        }
    }
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            double v = raw[y * width + x];
            if (isnan(v)) {
                v = -INFINITY;
                for (int j = y - 1; j <= y + 1; j++)
                    for (int i = x - 1; i <= x + 1; i++)
                        if (i >= 0 && j >= 0 && i < width && j < height && isfinite(raw[j * width + i]))
                            v = fmax(v, raw[j * width + i]);
                if (isinf(v))
                    v = INFINITY;
            }
            z[y * width + x] = v;
        }
    }
    free(raw);
}

int ref_repair(double *out, const float *in, int width, int height)
{
    int repaired = 0;
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            double v = in[y * width + x];
            if (!isfinite(v)) {
                double sum = 0;
                int count = 0;
                for (int j = y - 1; j <= y + 1; j++) {
                    for (int i = x - 1; i <= x + 1; i++) {
                        if (i < 0 || j < 0 || i >= width || j >= height || !isfinite(in[j * width + i]))
                            continue;
                        sum += in[j * width + i];
                        count++;
                    }
                }
                v = count ? sum / count : 0;
                repaired++;
            }
            out[y * width + x] = v;
        }
    }
    return repaired;
}

// The range model. With an infinite range there is no blur.
static void coc_of_range(const struct hf_params *p, double z, double *n, double *f)
{
    const double focus = p->focus;
    const double range = p->range.distance == HF_DERIVE ? focus / 2 : p->range.distance;
    const double nb = p->range.near_begin == HF_DERIVE ? fmax(0, focus - range) : p->range.near_begin;
    const double ne = p->range.near_end == HF_DERIVE ? focus : p->range.near_end;
    const double fb = p->range.far_begin == HF_DERIVE ? focus : p->range.far_begin;
    const double fe = p->range.far_end == HF_DERIVE ? focus + range : p->range.far_end;
    *n = ne > nb ? saturate((ne - z) / (ne - nb)) : z < ne;
    *f = fe > fb ? (isinf(z) ? 1 : saturate((z - fb) / (fe - fb))) : z > fb;
    if (isinf(range) && p->range.near_begin == HF_DERIVE)
        *n = 0;
    if (isinf(range) && p->range.far_end == HF_DERIVE)
        *f = 0;
}

static double radius_of_lens(const struct reference *r, double z)
{
    const struct hf_params *p = &r->params;
    const double aperture =
        (double)p->lens.focal_length_mm / 1000 / (2 * (double)p->lens.f_number) / p->lens.world_unit_m;
    const int display = p->view.display_width != HF_DERIVE ? p->view.display_width : r->width;
    const double focal_px = (double)p->lens.focal_length_mm / p->lens.sensor_width_mm * display;
    return aperture * focal_px * (1 / (double)p->focus - 1 / z);
}

void ref_coc(const struct reference *r, const struct hf_depth *depth, double z, double *n, double *f)
{
    if (depth->type != HF_DEPTH_COC && r->params.model == HF_MODEL_RANGE) {
        coc_of_range(&r->params, z, n, f);
    } else {
        const double radius = depth->type == HF_DEPTH_COC ? z : radius_of_lens(r, z);
        *n = saturate(-radius / r->rho);
        *f = saturate(radius / r->rho);
    }
    if (r->params.range.blend == HF_BLEND_SMOOTHSTEP) {
        *n = *n * *n * (3 - 2 * *n);
        *f = *f * *f * (3 - 2 * *f);
    }
}
