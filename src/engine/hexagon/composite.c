// SPDX-License-Identifier: BSD-3-Clause
// The hexagon's last pass in plain C. The near field goes over the far field, over sharp pixels, and over what lies
// behind.
#include <string.h>

#include "engine/hexagon/kernels.h"

// The fields at a pixel: near with its coverage, far with its weight, and what lies behind with its weight.
struct fields {
    float near[5], far[5], behind[5];
    float source[4], part;  // the blurred part of a far or mixed pixel: colour, and how much of the pixel it is
};

static void fields_full(const struct hf_frame *f, int x, int y, struct fields *v)
{
    for (int c = 0; c < f->s->channels; c++) {
        v->near[c] = f->near ? *hf_at(hf_hexagon_made(f, HF_HEXAGON_NEAR), c, x, y) : 0;
        v->far[c] = f->far ? *hf_at(hf_hexagon_made(f, HF_HEXAGON_FAR), c, x, y) : 0;
        v->behind[c] = f->near ? *hf_at(hf_hexagon_made(f, HF_HEXAGON_BEHIND), c, x, y) : 0;
    }
    v->near[4] = f->near ? *hf_at(hf_hexagon_made(f, HF_HEXAGON_COVERAGE), 0, x, y) : 0;
    v->behind[4] = f->near ? *hf_at(hf_hexagon_made(f, HF_HEXAGON_BEHIND_W), 0, x, y) : 0;
    v->far[4] = 1;
    const float r = *hf_at(&f->buf[HF_HEXAGON_WEIGHT], 1, x, y), size = r > 1 ? r : 1;
    v->part = *hf_at(&f->buf[HF_HEXAGON_WEIGHT], 0, x, y) * size;
    for (int c = 0; c < f->s->channels; c++)
        v->source[c] = *hf_at(&f->buf[HF_HEXAGON_COLOUR], c, x, y) * size;
}

// Bilinear between half-resolution pixels; far ones are weighted by how far they are.
static void fields_half(const struct hf_frame *f, int x, int y, struct fields *v)
{
    for (int c = 0; c < 5; c++)
        v->near[c] = v->far[c] = v->behind[c] = 0;
    for (int i = 0; i < 4; i++) {
        const int u = x / 2 + (i & 1 ? (x & 1 ? 1 : -1) : 0), q = y / 2 + (i & 2 ? (y & 1 ? 1 : -1) : 0);
        float w = (i & 1 ? 0.25f : 0.75f) * (i & 2 ? 0.25f : 0.75f);
        for (int c = 0; c < f->s->channels && f->near; c++) {
            v->near[c] = v->near[c] + w * *hf_at(hf_hexagon_made(f, HF_HEXAGON_NEAR), c, u, q);
            v->behind[c] = v->behind[c] + w * *hf_at(hf_hexagon_made(f, HF_HEXAGON_BEHIND), c, u, q);
        }
        if (f->near) {
            v->near[4] = v->near[4] + w * *hf_at(hf_hexagon_made(f, HF_HEXAGON_COVERAGE), 0, u, q);
            v->behind[4] = v->behind[4] + w * *hf_at(hf_hexagon_made(f, HF_HEXAGON_BEHIND_W), 0, u, q);
        }
        if (!f->far)
            continue;
        w = w * hf_saturate(*hf_at(&f->buf[HF_HEXAGON_FAR_WEIGHT_2], 1, u, q));
        for (int c = 0; c < f->s->channels; c++)
            v->far[c] = v->far[c] + w * *hf_at(hf_hexagon_made(f, HF_HEXAGON_FAR), c, u, q);
        v->far[4] = v->far[4] + w;
    }
}

// One channel of what lies behind a near pixel of radius p < 0: its own colour where it is hardly near; where nothing
// else is visible around it, the near field's colour.
static float background(const struct fields *v, int c, float own, float p)
{
    const float front = v->near[4] > 0 ? v->near[c] / v->near[4] : own, some = v->behind[4];
    const float nothing = HEXAGON_NOTHING * HEXAGON_NOTHING;
    const float seen = some > 0 ? hf_lerp(v->behind[c] / some, front, nothing / (some * some + nothing)) : front;
    return hf_lerp(seen, own, hf_saturate(HEXAGON_ALL + p));
}

// The sum that two blurs find of a near field that covers the whole frame, given that pass 1 makes nothing near beyond
// the frame: the first along side a, and b unless it is -1, the second along c. It is integrated by Simpson's rule,
// because the first blur is linear except at its corners.
static float two_sides(const struct hf_setup *s, int a, int b, int c, const float at[2], float p)
{
    static const float here[2] = {0, 0};
    const struct hf_hexagon *h = hf_hexagon(s);
    const float i = 1 / p, d = hf_hexagon_along(s->width, s->height, h->side[c], at, here, i);
    float sum = 0;
    for (int k = 0; k < 3; k++) {
        const float t = d * p * (0.5f * (float)k), by[2] = {t / h->side[c][0], t / h->side[c][1]};
        float first = hf_hexagon_along(s->width, s->height, h->side[a], at, by, i);
        if (b >= 0)
            first = first + hf_hexagon_along(s->width, s->height, h->side[b], at, by, i);
        sum = sum + (k == 1 ? 4 : 1) * first;
    }
    return d * sum;
}

// The part that near coverage leaves open. Near a frame's edge the missing coverage from beyond is not counted as open.
static float left_over(const struct hf_setup *s, float coverage, float p, int x, int y)
{
    float most = 1;
    if (p < 0) {
        const float at[2] = {(float)x + 0.5f, (float)y + 0.5f};
        most = (two_sides(s, 0, -1, 1, at, -p) + two_sides(s, 0, 1, 2, at, -p)) * (1 / 18.0f);
    }
    const float o = most - coverage;
    return o > 0 ? o : 0;
}

// The colour of a far pixel. In a mixed pixel only its far part is replaced.
static float far_full(const struct fields *v, int c, float own)
{
    return v->part < HEXAGON_WHOLE ? own + (v->part * v->far[c] - v->source[c]) : v->far[c];
}

static void composite_pixel(const struct hf_frame *f, int x, int y, float p, float *const colour[4], int i)
{
    const int half = hf_hexagon(f->s)->half;
    struct fields v;
    (half ? fields_half : fields_full)(f, x, y, &v);
    const float cover = v.near[4], left = left_over(f->s, cover, p, x, y), all = cover + left;
    const int has_far = f->far && p > 0 && v.far[4] > 0;
    for (int c = 0; c < f->s->channels && (has_far || cover != 0); c++) {
        float b = colour[c][i] * HEXAGON_SCALE;
        if (has_far)
            b = half ? hf_lerp(b, v.far[c] / v.far[4], hf_saturate(0.5f * p)) : far_full(&v, c, b);
        if (p < 0)
            b = background(&v, c, b, p);
        if (cover != 0)
            b = (v.near[c] + left * b) / all;
        b = b < HEXAGON_MOST ? b : HEXAGON_MOST;
        b = b > -HEXAGON_MOST ? b : -HEXAGON_MOST;
        colour[c][i] = b * (1 / HEXAGON_SCALE);
    }
}

void hf_hexagon_composite_c(const struct hf_frame *f, struct hf_rect r)
{
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, f->s->width) - x0;
    float *colour[4], *radius = hf_line(f, 12);
    for (int c = 0; c < 4; c++)
        colour[c] = hf_line(f, 8 + c);
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++) {
        hf_read_pixels(f, r.x0, y, r.x1 - r.x0, colour, f->counts);
        if (hf_hexagon(f->s)->half)
            f->k->radius_row(f, x0, y, n, radius, NULL);
        else
            memcpy(radius, hf_at(&f->buf[HF_HEXAGON_WEIGHT], 1, x0, y), sizeof *radius * (size_t)n);
        for (int i = 0; i < n; i++)
            composite_pixel(f, x0 + i, y, radius[i], colour, i);
        hf_write_pixels(f, r.x0, y, r.x1 - r.x0, (const float *const *)colour, f->s->channels == 4);
    }
}
