// SPDX-License-Identifier: BSD-3-Clause
// Scatter: what happens before and after the splats (splat.c).
#include "scatter/behind.h"
#include "scatter/kernels.h"

#include "pixel/pass_c.h"

// Bit of the exponent of v > 0: eight to a bit, the highest sixteen to the last.
static uint32_t exponent_bit(float v)
{
    const union {
        float f;
        uint32_t i;
    } u = {v < 0x1p120f ? v : 0x1p120f};
    return 1u << (u.i >> 26);
}

void hf_scatter_note_c(const float *radius, float *const colour[4], int channels, int n, struct hf_counts *counts)
{
    for (int x = 0; x < n; x++) {
        counts->transparent += channels == 4 && colour[3][x] != 1;
        for (int c = 0; c < channels && radius[x] != 0; c++) {
            const float v = __builtin_fabsf(colour[c][x]);
            float *largest = &counts->largest[c == 3];
            *largest = v > *largest ? v : *largest;
            if (v > 0)
                counts->exponents[c == 3] |= exponent_bit(v);
        }
    }
}

// Colour and radius of every pixel that some tile reads, and how bright those that will be drawn can be.
void hf_scatter_prepare_c(const struct hf_frame *f, struct hf_rect r)
{
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, f->s->width) - x0;
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height); y++) {
        float *colour[4] = {NULL}, *radius = hf_at(&f->buf[HF_BUF_RADIUS], 0, x0, y);
        hf_row(&f->buf[HF_BUF_SOURCE], f->s->channels, x0, y, colour);
        hf_read_pixels(f, r.x0, y, r.x1 - r.x0, colour, f->seen);
        f->k->radius_row(f, x0, y, n, radius, NULL);
        hf_scatter_kernels(f)->note(radius, colour, f->s->channels, n, f->counts);
    }
}

// How much of a disc's area lies on this side of a line d radii off its centre, 0..1: within 0.002, and exact at the
// ends.
static float segment(float d)
{
    const float t = d < 1 ? d : 1, q = t * t;
    return 0.5f + t * (0.63662f + q * (-0.10610f - q * 0.03052f));
}

// How much of the picture around a near pixel lies inside the frame: its sum of weights cannot be more.
static float inside(const struct hf_setup *s, float reach_x, float reach_y, int x, int y)
{
    const float ix = 1 / reach_x, iy = 1 / reach_y;
    const float left = ((float)x + 0.5f) * ix, right = (((float)s->width - (float)x) - 0.5f) * ix;
    const float above = ((float)y + 0.5f) * iy, below = ((float)(s->height - y) - 0.5f) * iy;
    return ((segment(left) + segment(right)) - 1) * ((segment(above) + segment(below)) - 1);
}

// a + t (b - a), for t of 1 and more b's own bits, as a's for 0: next to a highlight b would lose them.
static float mix(float a, float b, float t)
{
    return t < 1 ? hf_lerp(a, b, t) : b;
}

// Far, the pixel itself, near. What still shows of a near pixel is a part of what covers it: what is behind shows
// through neither. What lies there nobody has seen: where far ones hardly reach, near hides it.
static float composite_sample(float own, float show, float cover, int is_near, const float far[2], const float near[2],
                              const float *behind)
{
    const float front = near[1] > 0 ? near[0] / near[1] : own;
    float v = far[1] > 0 ? far[0] / far[1] : own;
    if (is_near) {
        const float left = 1 - cover;
        v = behind ? *behind : mix(front, v, hf_saturate(16 * far[1]));
        show = show < left ? show / left : 1;
    }
    v = mix(own, v, 1 - show);
    return near[1] > 0 ? mix(v, front, cover) : v;
}

void hf_scatter_blend_c(const struct hf_scatter_row *row, float *out)
{
    const struct hf_scatter *t = hf_scatter(row->setup);
    for (int x = 0; x < row->n; x++) {
        const float far[2] = {row->far ? row->far[x] : 0, row->far ? row->far_weight[x] : 0};
        const float near[2] = {row->near ? row->near[x] : 0, row->near ? row->near_weight[x] : 0};
        const float r = row->radius[x], size = __builtin_fabsf(r), reach_x = size * t->aperture.key.scale_x;
        const float cover = r < 0 ? near[1] / inside(row->setup, reach_x, size, row->x + x, row->y) : near[1];
        const float own = out[x] * t->dim;
        float v =
            composite_sample(own, hf_own_part(t, size), cover, r < 0, far, near, row->behind ? &row->behind[x] : NULL);
        v = v < t->most ? v : t->most;
        v = v > -t->most ? v : -t->most;
        // What is denormal may have lost bits.
        out[x] = v == own ? out[x] : v * t->undim;
    }
}

// behind: NULL if there is nothing but what far pixels say.
static void composite_row(const struct hf_frame *f, int y, struct hf_rect r, const struct hf_behind *behind)
{
    const struct hf_setup *s = f->s;
    const struct hf_scatter *t = hf_scatter(s);
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, s->width) - x0;
    const float *radius = hf_at(&f->buf[HF_BUF_RADIUS], 0, x0, y);
    float *out[4];
    for (int c = 0; c < 4; c++)
        out[c] = hf_line(f, 8 + c);
    hf_read_pixels(f, r.x0, y, r.x1 - r.x0, out, f->counts);
    const struct hf_scatter_row pixels = {.setup = s, .x = x0, .y = y, .n = n, .radius = radius};
    const struct hf_scatter_behind line = {.f = f,
                                           .behind = behind,
                                           .weight = {hf_line(f, 14), hf_line(f, 15)},
                                           .colour = {hf_line(f, 16), hf_line(f, 17)}};
    if (behind && !hf_scatter_behind_begin(&line, &pixels))
        behind = NULL;
    // Alpha that is 1 all over stays so.
    for (int c = 0; c < (t->opaque ? 3 : s->channels); c++) {
        const int group = t->opaque ? 0 : t->group_of[c];
        struct hf_scatter_row row = pixels;
        if (f->far) {
            row.far_weight = hf_at(&f->buf[HF_BUF_FAR_WEIGHT], group, x0, y);
            row.far = hf_at(&f->buf[HF_BUF_FAR_SUM], c, x0, y);
        }
        if (f->near) {
            row.near_weight = hf_at(&f->buf[HF_BUF_NEAR_WEIGHT], group, x0, y);
            row.near = hf_at(&f->buf[HF_BUF_NEAR_SUM], c, x0, y);
        }
        if (behind) {
            row.behind = hf_line(f, 18);
            hf_scatter_behind_row(&line, &row, c, out[c], hf_line(f, 18));
        }
        hf_scatter_kernels(f)->blend(&row, out[c]);
    }
    hf_write_pixels(f, r.x0, y, r.x1 - r.x0, (const float *const *)out, s->channels == 4);
}

void hf_scatter_composite_c(const struct hf_frame *f, struct hf_rect r)
{
    const int levels = f->near ? hf_scatter(f->s)->behind : 0;
    for (int y = r.y0; y < r.y1; y += HF_BEHIND_BLOCK)
        for (int x = r.x0; x < r.x1; x += HF_BEHIND_BLOCK) {
            const struct hf_rect block = {x, y, hf_min(x + HF_BEHIND_BLOCK, r.x1), hf_min(y + HF_BEHIND_BLOCK, r.y1)};
            struct hf_behind behind = {.planes =
                                           hf_scatter_behind_planes(hf_scatter(f->s)->opaque ? 3 : f->s->channels)};
            const int is = levels && hf_behind_make(&behind, &hf_scatter_behind_source, f, block, levels, f->work);
            for (int row = 2 * block.y0; row < hf_min(2 * block.y1, f->s->height); row++)
                composite_row(f, row, block, is ? &behind : NULL);
        }
}
