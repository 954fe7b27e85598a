// SPDX-License-Identifier: BSD-3-Clause
// The hexagon engine on vectors: Load and Composite.
#include "engine/hexagon/blur_simd.h"
#include "engine/hexagon/kernels.h"
#include "pixel/coc_vf.h"

// ---- Load ----

// Whether the planes of a frame are larger than a cache, and a row is aligned. Then stores go past the cache: otherwise
// each line would be fetched only to be overwritten.
static int hex_streams(const struct hf_frame *f, const float *row)
{
    enum { LARGE = 12 << 20 };
    const size_t planes = 3 + (size_t)f->s->channels, stride = (size_t)f->buf[HF_HEXAGON_WEIGHT].stride;
    return planes * stride * (size_t)f->s->height * sizeof(float) > LARGE && (uintptr_t)row % sizeof(vf) == 0;
}

// What the mean radius of far samples is summed from.
HF_INLINE vf hex_light_over(const vf colour[3], vf q)
{
    return vf_div(hex_light(colour), vf_max(q, vf_set1(HEXAGON_LEAST_MEAN)));
}

static void hex_load_full_row(const struct hf_frame *f, int y, struct hf_rect r, struct hf_edges *e)
{
    const struct hf_setup *s = f->s;
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, s->width) - x0;
    const struct hf_buf *weight = &f->buf[HF_HEXAGON_WEIGHT];
    float *a = hf_at(weight, 0, x0, y), *q = hf_at(weight, 1, x0, y), *over = hf_at(weight, 2, x0, y), *out[4];
    float *const colour[4] = {hf_line(f, 13), hf_line(f, 14), hf_line(f, 15), hf_line(f, 16)}, *radius = hf_line(f, 17);
    hf_row(&f->buf[HF_HEXAGON_COLOUR], s->channels, x0, y, out);
    const float *whole = hf_hexagon_row(e, f, y, r, colour, radius);
    // Pixels at the frame's edges are read soon, to be repeated outwards, so they stay in the cache.
    const int inner = y > 0 && y < s->height - 1 && hex_streams(f, a);
    for (int x = 0; x < n; x += VF_N) {
        const int stream = inner && x0 + x > 0 && x0 + x + VF_N < s->width;
        const vf own = vf_load(radius + x), share = vf_div(vf_set1(1), vf_max(vf_abs(own), vf_set1(1)));
        const vf part = whole ? vf_load(whole + x) : vf_set1(1), w = vf_mul(part, share);
        vf_put(a + x, w, stream);
        vf_put(q + x, own, stream);
        const vf darker = vf_mul(share, vf_set1(HEXAGON_SCALE));
        vf v[4];
        for (int c = 0; c < s->channels; c++) {
            v[c] = vf_mul(vf_load(colour[c] + x), darker);
            vf_put(out[c] + x, v[c], stream);
        }
        const vf far = hex_light_over(v, own), near = vf_mul(part, vf_sqrt(share));
        vf_put(over + x, vf_select(vf_gt(own, vf_zero()), far, near), stream);
    }
}

// The sums of quads' colours with weights w, times scale.
HF_INLINE void hex_quad_colours(const struct hf_frame *f, int colour, int x, int y, vf w[4], vf scale,
                                float *const lane[2][2][4], int i, vf out[4])
{
    for (int t = 0; t < 4; t++)
        w[t] = vf_mul(w[t], vf_set1(HEXAGON_SCALE));
    for (int c = 0; c < f->s->channels; c++) {
        const vf top = vf_fma(w[1], vf_load(lane[0][1][c] + i), vf_mul(w[0], vf_load(lane[0][0][c] + i)));
        const vf bottom = vf_fma(w[3], vf_load(lane[1][1][c] + i), vf_mul(w[2], vf_load(lane[1][0][c] + i)));
        out[c] = vf_mul(vf_add(top, bottom), scale);
        vf_store(hf_at(&f->buf[colour], c, x, y), out[c]);
    }
}

HF_INLINE void hex_load_quads(const struct hf_frame *f, int colour, int x, int y, const vf radius[4],
                              float *const lane[2][2][4], int i)
{
    vf w[4], q = vf_zero();
    for (int t = 0; t < 4; t++) {
        const vf m = vf_max(radius[t], vf_zero());
        w[t] = vf_min(vf_mul(vf_set1(2), m), vf_set1(1));
        q = vf_add(q, vf_mul(w[t], m));
    }
    const vf sum = vf_add(vf_add(w[0], w[1]), vf_add(w[2], w[3]));
    q = vf_keep(vf_gt(sum, vf_zero()), vf_mul(vf_set1(0.5f), vf_div(q, sum)));
    const vf spread = vf_max(q, vf_set1(1)), scale = vf_div(vf_set1(0.25f), spread), weight = vf_mul(sum, scale);
    vf v[4];
    hex_quad_colours(f, colour, x, y, w, scale, lane, i, v);
    const vf over = colour == HF_HEXAGON_NEAR_COLOUR_2 ? vf_mul(weight, vf_sqrt(spread)) : hex_light_over(v, q);
    vf_store(hf_at(&f->buf[colour + 1], 0, x, y), weight);
    vf_store(hf_at(&f->buf[colour + 1], 1, x, y), q);
    vf_store(hf_at(&f->buf[colour + 1], 2, x, y), over);
}

HF_INLINE void hex_load_seen(const struct hf_frame *f, int x, int y, const vf radius[4], float *const lane[2][2][4],
                             int i)
{
    vf w[4];
    for (int t = 0; t < 4; t++)
        w[t] = vf_saturate(vf_add(vf_set1(1.5f), radius[t]));
    const vf sum = vf_add(vf_add(w[0], w[1]), vf_add(w[2], w[3])), quarter = vf_set1(0.25f);
    vf v[4];
    vf_store(hf_at(&f->buf[HF_HEXAGON_SEEN_WEIGHT_2], 0, x, y), vf_mul(sum, quarter));
    hex_quad_colours(f, HF_HEXAGON_SEEN_COLOUR_2, x, y, w, quarter, lane, i, v);
}

// The radii of n pairs of pixels of row y, split into even and odd ones.
static void hex_radius_lanes(const struct hf_frame *f, int x, int y, int n, float *line, float *even, float *odd)
{
    const int pixels = hf_min(2 * n, f->s->width - 2 * x);
    f->k->radius_row(f, 2 * x, y, pixels, line, NULL);
    if (pixels < 2 * n)
        line[pixels] = line[pixels - 1];
    f->k->unzip(line, n, even, odd);
}

static void hex_load_half_row(const struct hf_frame *f, int y, struct hf_rect r, struct hf_edges *e)
{
    (void)e;
    const int n = r.x1 - r.x0, y1 = hf_min(2 * y + 1, f->s->height - 1);
    float *lane[2][2][4], *radius[4];
    for (int i = 0; i < 16; i++)
        lane[i >> 3][i >> 2 & 1][i & 3] = hf_line(f, i);
    hf_read_colour(f, r.x0, 2 * y, n, lane[0][0], lane[0][1], f->seen);
    hf_read_colour(f, r.x0, y1, n, lane[1][0], lane[1][1], f->seen);
    for (int i = 0; i < 4; i++)
        radius[i] = hf_line(f, 16 + i);
    float *line = f->work;
    hex_radius_lanes(f, r.x0, 2 * y, n, line, radius[0], radius[1]);
    hex_radius_lanes(f, r.x0, y1, n, line, radius[2], radius[3]);
    for (int i = 0; i < n; i += VF_N) {
        vf near[4], far[4];
        for (int t = 0; t < 4; t++) {
            far[t] = vf_load(radius[t] + i);
            near[t] = vf_sub(vf_zero(), far[t]);
        }
        hex_load_quads(f, HF_HEXAGON_NEAR_COLOUR_2, r.x0 + i, y, near, lane, i);
        hex_load_quads(f, HF_HEXAGON_FAR_COLOUR_2, r.x0 + i, y, far, lane, i);
        hex_load_seen(f, r.x0 + i, y, far, lane, i);
    }
}

static void hexagon_load_simd(const struct hf_frame *f, struct hf_rect r)
{
    hf_hexagon_load_rows(f, r, hf_hexagon(f->s)->half ? hex_load_half_row : hex_load_full_row);
    vf_stream_end();
}

// ---- Composite ----

// Composite the near field over a background.
HF_INLINE vf hex_over(vf near, vf coverage, vf left, vf all, vf b)
{
    return vf_select(vf_eq(coverage, vf_zero()), b, vf_div(vf_fma(left, b, near), all));
}

// Where a field shows, store the blend at full brightness.
HF_INLINE void hex_store_blend(vm shows, vf blend, float *colour)
{
    const vf most = vf_set1(HEXAGON_MOST), least = vf_set1(-HEXAGON_MOST);
    const vf v = vf_mul(vf_max(vf_min(blend, most), least), vf_set1(1 / HEXAGON_SCALE));
    vf_store(colour, vf_select(shows, v, vf_load(colour)));
}

// As two_sides in composite.c.
HF_INLINE vf hex_two_sides(const struct hf_setup *s, int a, int b, int c, const vf at[2], vf p)
{
    const struct hf_hexagon *h = hf_hexagon(s);
    const vf here[2] = {vf_zero(), vf_zero()};
    const vf i = vf_div(vf_set1(1), p), d = hex_along(s->width, s->height, h->side[c], at, here, i);
    vf sum = vf_zero();
    for (int k = 0; k < 3; k++) {
        const vf t = vf_mul(vf_mul(d, p), vf_set1(0.5f * (float)k));
        const vf by[2] = {vf_div(t, vf_set1(h->side[c][0])), vf_div(t, vf_set1(h->side[c][1]))};
        vf first = hex_along(s->width, s->height, h->side[a], at, by, i);
        if (b >= 0)
            first = vf_add(first, hex_along(s->width, s->height, h->side[b], at, by, i));
        sum = vf_add(sum, k == 1 ? vf_mul(vf_set1(4), first) : first);
    }
    return vf_mul(d, sum);
}

// Whether hexagons of radii q around (u, v) may leave the frame. Elsewhere the sums of two_sides are exactly 18.
HF_INLINE vm hex_at_edge(const struct hf_setup *s, vf u, vf v, vf q)
{
    const float *clear = hf_hexagon(s)->clear;
    const vf one = vf_set1(1), x = vf_fma(q, vf_set1(clear[0]), one), y = vf_fma(q, vf_set1(clear[1]), one);
    const vf width = vf_set1((float)s->width), height = vf_set1((float)s->height);
    return vm_or(vm_or(vf_lt(u, x), vf_lt(v, y)), vm_or(vf_lt(vf_sub(width, u), x), vf_lt(vf_sub(height, v), y)));
}

// The open part of pixels from column x of row y on, `step` apart; p: their radii.
HF_INLINE vf hex_left_over(const struct hf_setup *s, vf coverage, vf p, int x, int step, int y)
{
    static const float steps[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const vm near = vf_lt(p, vf_zero());
    vf most = vf_set1(1);
    if (vm_any(near)) {
        const vf q = vf_select(near, vf_sub(vf_zero(), p), most);
        const vf u = vf_add(vf_set1((float)x + 0.5f), vf_mul(vf_set1((float)step), vf_load(steps)));
        const vf at[2] = {u, vf_set1((float)y + 0.5f)};
        if (vm_any(vm_and(near, hex_at_edge(s, at[0], at[1], q)))) {
            const vf sum = vf_add(hex_two_sides(s, 0, -1, 1, at, q), hex_two_sides(s, 0, 1, 2, at, q));
            most = vf_select(near, vf_mul(sum, vf_set1(1 / 18.0f)), most);
        }
    }
    return vf_max(vf_sub(most, coverage), vf_zero());
}

// What lies behind near pixels: sampled channels and their weight.
struct hex_behind {
    vf colour[4], weight;
};

HF_INLINE vf hex_background(const struct hex_behind *v, int c, vf near, vf coverage, vf own, vf p)
{
    const vf zero = vf_zero(), nothing = vf_set1(HEXAGON_NOTHING * HEXAGON_NOTHING);
    const vf front = vf_select(vf_gt(coverage, zero), vf_div(near, coverage), own);
    const vf share = vf_div(nothing, vf_fma(v->weight, v->weight, nothing));
    const vf some = vf_lerp(vf_div(v->colour[c], v->weight), front, share);
    const vf seen = vf_select(vf_gt(v->weight, zero), some, front);
    return vf_lerp(seen, own, vf_saturate(vf_add(vf_set1(HEXAGON_ALL), p)));
}

// The colour of a far pixel. In a mixed pixel only its far part is replaced.
HF_INLINE vf hex_far_colour(vf far, vf source, vf own, vf part, vf size, vm is_far)
{
    const vf mixed = vf_add(own, vf_sub(vf_mul(part, far), vf_mul(source, size)));
    return vf_select(is_far, vf_select(vf_lt(part, vf_set1(HEXAGON_WHOLE)), mixed, far), own);
}

HF_INLINE void hex_composite_full(const struct hf_frame *f, int x0, int y, int n, float *const colour[4],
                                  const int has_near, const int has_far)
{
    const float *radius = hf_at(&f->buf[HF_HEXAGON_WEIGHT], 1, x0, y);
    const float *share = hf_at(&f->buf[HF_HEXAGON_WEIGHT], 0, x0, y);
    float *near[4], *far[4], *coverage[4], *behind[4], *weight[4], *source[4];
    hf_row(&f->buf[HF_HEXAGON_COLOUR], f->s->channels, x0, y, source);
    hf_row(hf_hexagon_made(f, HF_HEXAGON_BEHIND), f->s->channels, x0, y, behind);
    hf_row(hf_hexagon_made(f, HF_HEXAGON_BEHIND_W), 1, x0, y, weight);
    hf_row(hf_hexagon_made(f, HF_HEXAGON_NEAR), f->s->channels, x0, y, near);
    hf_row(hf_hexagon_made(f, HF_HEXAGON_FAR), f->s->channels, x0, y, far);
    hf_row(hf_hexagon_made(f, HF_HEXAGON_COVERAGE), 1, x0, y, coverage);
    for (int x = 0; x < n; x += VF_N) {
        const vf p = vf_load(radius + x), a = has_near ? vf_load(coverage[0] + x) : vf_zero();
        const vf left = has_near ? hex_left_over(f->s, a, p, x0 + x, 1, y) : vf_zero(), all = vf_add(a, left);
        const vm is_far = vf_gt(p, vf_zero()), is_near = vf_ne(a, vf_zero()), covers = vf_lt(p, vf_zero());
        const vf size = vf_max(p, vf_set1(1)), part = vf_mul(vf_load(share + x), size);
        const int any = has_near && vm_any(covers);
        struct hex_behind back = {.weight = vf_zero()};
        for (int c = 0; c < f->s->channels && any; c++)
            back.colour[c] = vf_load(behind[c] + x);
        if (any)
            back.weight = vf_load(weight[0] + x);
        for (int c = 0; c < f->s->channels; c++) {
            vf b = vf_mul(vf_load(colour[c] + x), vf_set1(HEXAGON_SCALE));
            if (has_far)
                b = hex_far_colour(vf_load(far[c] + x), vf_load(source[c] + x), b, part, size, is_far);
            if (any)
                b = vf_select(covers, hex_background(&back, c, vf_load(near[c] + x), a, b, p), b);
            if (has_near)
                b = hex_over(vf_load(near[c] + x), a, left, all, b);
            hex_store_blend(!has_far ? is_near : has_near ? vm_or(is_near, is_far) : is_far, b, colour[c] + x);
        }
    }
}

static void hex_full_row(const struct hf_frame *f, int y, struct hf_rect r)
{
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, f->s->width) - x0;
    float *colour[4];
    for (int c = 0; c < 4; c++)
        colour[c] = hf_line(f, 8 + c);
    hf_read_pixels(f, r.x0, y, r.x1 - r.x0, colour, f->counts);
    if (f->near && f->far)
        hex_composite_full(f, x0, y, n, colour, 1, 1);
    else if (f->near)
        hex_composite_full(f, x0, y, n, colour, 1, 0);
    else
        hex_composite_full(f, x0, y, n, colour, 0, 1);
    hf_write_pixels(f, r.x0, y, r.x1 - r.x0, (const float *const *)colour, f->s->channels == 4);
}

// Offsets of the four half-resolution neighbours of a row's even or odd pixels, and their weights.
struct hex_corner {
    int x, y;
    float weight;
};

HF_INLINE vf hex_bilinear(const struct hf_buf *b, int channel, int x, const struct hex_corner corner[4],
                          const vf weight[4])
{
    vf sum = vf_zero();
    for (int i = 0; i < 4; i++)
        sum = vf_fma(weight[i], vf_load(hf_at(b, channel, x + corner[i].x, corner[i].y)), sum);
    return sum;
}

// Composite the even or odd pixels of row y.
HF_INLINE void hex_composite_half(const struct hf_frame *f, struct hf_rect r, int y, int odd, const float *radius,
                                  float *const colour[4])
{
    const int x0 = r.x0, n = r.x1 - r.x0, side = odd ? 1 : -1, other = y / 2 + (y & 1 ? 1 : -1);
    const struct hex_corner corner[4] = {
        {0, y / 2, 0.5625f}, {side, y / 2, 0.1875f}, {0, other, 0.1875f}, {side, other, 0.0625f}};
    const struct hf_buf *near = hf_hexagon_made(f, HF_HEXAGON_NEAR), *far = hf_hexagon_made(f, HF_HEXAGON_FAR);
    const struct hf_buf *coverage = hf_hexagon_made(f, HF_HEXAGON_COVERAGE);
    const struct hf_buf *behind = hf_hexagon_made(f, HF_HEXAGON_BEHIND);
    const struct hf_buf *weight = hf_hexagon_made(f, HF_HEXAGON_BEHIND_W);
    for (int x = 0; x < n; x += VF_N) {
        const vf p = vf_load(radius + x);
        vf w[4], far_w[4], far_sum = vf_zero(), a = vf_zero();
        for (int i = 0; i < 4; i++)
            w[i] = vf_set1(corner[i].weight);
        if (f->near)
            a = hex_bilinear(coverage, 0, x0 + x, corner, w);
        for (int i = 0; i < 4; i++) {
            const vf q = vf_load(hf_at(&f->buf[HF_HEXAGON_FAR_WEIGHT_2], 1, x0 + x + corner[i].x, corner[i].y));
            far_w[i] = vf_mul(w[i], vf_saturate(q));
            far_sum = vf_add(far_sum, far_w[i]);
        }
        const vf left = f->near ? hex_left_over(f->s, a, p, 2 * (x0 + x) + odd, 2, y) : vf_zero();
        const vf all = vf_add(a, left), blend = vf_saturate(vf_mul(vf_set1(0.5f), p));
        const vm is_near = vf_ne(a, vf_zero()), is_far = vm_and(vf_gt(p, vf_zero()), vf_gt(far_sum, vf_zero()));
        const vm covers = vf_lt(p, vf_zero());
        const int any = f->near && vm_any(covers);
        struct hex_behind back = {.weight = vf_zero()};
        for (int c = 0; c < f->s->channels && any; c++)
            back.colour[c] = hex_bilinear(behind, c, x0 + x, corner, w);
        if (any)
            back.weight = hex_bilinear(weight, 0, x0 + x, corner, w);
        for (int c = 0; c < f->s->channels; c++) {
            vf b = vf_mul(vf_load(colour[c] + x), vf_set1(HEXAGON_SCALE));
            if (f->far)
                b = vf_select(is_far, vf_lerp(b, vf_div(hex_bilinear(far, c, x0 + x, corner, far_w), far_sum), blend),
                              b);
            const vf front = f->near ? hex_bilinear(near, c, x0 + x, corner, w) : vf_zero();
            if (any)
                b = vf_select(covers, hex_background(&back, c, front, a, b, p), b);
            if (f->near)
                b = hex_over(front, a, left, all, b);
            hex_store_blend(f->far ? vm_or(is_near, is_far) : is_near, b, colour[c] + x);
        }
    }
}

static void hex_half_row(const struct hf_frame *f, int y, struct hf_rect r)
{
    const int n = r.x1 - r.x0;
    float *lane[2][4], *radius[2] = {hf_line(f, 9), hf_line(f, 10)};
    const float *stored[2][4] = {{NULL}};
    for (int i = 0; i < 8; i++)
        lane[i >> 2][i & 3] = hf_line(f, i);
    hf_read_colour(f, r.x0, y, n, lane[0], lane[1], f->counts);
    hex_radius_lanes(f, r.x0, y, n, f->work, radius[0], radius[1]);
    for (int odd = 0; odd < 2; odd++) {
        hex_composite_half(f, r, y, odd, radius[odd], lane[odd]);
        for (int c = 0; c < f->s->channels; c++)
            stored[odd][c] = lane[odd][c];
    }
    hf_store_colour(f, r.x0, y, n, stored[0], stored[1]);
}

static void hexagon_composite_simd(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++)
        if (hf_hexagon(f->s)->half)
            hex_half_row(f, y, r);
        else
            hex_full_row(f, y, r);
}
