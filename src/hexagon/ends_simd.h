// SPDX-License-Identifier: BSD-3-Clause
// The hexagon engine on vectors: what comes before its two passes, and after.
#include "hexagon/blur_simd.h"
#include "hexagon/kernels.h"
#include "pixel/coc_vf.h"

// ---- Load ----

// Are the planes of a frame larger than a cache, and a row's place in them aligned? Then they are written past it: each
// line would be fetched to be overwritten.
static int hex_streams(const struct hf_frame *f, const float *row)
{
    enum { LARGE = 12 << 20 };
    const size_t planes = 3 + (size_t)f->s->channels, stride = (size_t)f->buf[HF_HEXAGON_WEIGHT].stride;
    return planes * stride * (size_t)f->s->height * sizeof(float) > LARGE && (uintptr_t)row % sizeof(vf) == 0;
}

static void hex_load_full_row(const struct hf_frame *f, int y, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, s->width) - x0;
    const struct hf_buf *weight = &f->buf[HF_HEXAGON_WEIGHT];
    float *a = hf_at(weight, 0, x0, y), *q = hf_at(weight, 1, x0, y), *over = hf_at(weight, 2, x0, y), *out[4];
    float *const colour[4] = {hf_line(f, 8), hf_line(f, 9), hf_line(f, 10), hf_line(f, 11)}, *radius = hf_line(f, 12);
    hf_row(&f->buf[HF_HEXAGON_COLOUR], s->channels, x0, y, out);
    hf_read_pixels(f, r.x0, y, r.x1 - r.x0, colour, f->seen);
    f->k->radius_row(f, x0, y, n, radius, NULL);
    // What lies at the frame's edges is read at once, to be repeated outwards.
    const int inner = y > 0 && y < s->height - 1 && hex_streams(f, a);
    for (int x = 0; x < n; x += VF_N) {
        const int stream = inner && x0 + x > 0 && x0 + x + VF_N < s->width;
        const vf own = vf_load(radius + x), spread = vf_max(vf_abs(own), vf_set1(1)), w = vf_div(vf_set1(1), spread);
        vf_put(a + x, w, stream);
        vf_put(q + x, own, stream);
        vf_put(over + x, vf_select(vf_gt(own, vf_zero()), vf_div(w, own), vf_sqrt(w)), stream);
        const vf darker = vf_mul(w, vf_set1(HEXAGON_SCALE));
        for (int c = 0; c < s->channels; c++)
            vf_put(out[c] + x, vf_mul(vf_load(colour[c] + x), darker), stream);
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
    const vf over = colour == HF_HEXAGON_NEAR_COLOUR_2 ? vf_mul(weight, vf_sqrt(spread))
                                                       : vf_keep(vf_gt(q, vf_zero()), vf_div(weight, q));
    vf_store(hf_at(&f->buf[colour + 1], 0, x, y), weight);
    vf_store(hf_at(&f->buf[colour + 1], 1, x, y), q);
    vf_store(hf_at(&f->buf[colour + 1], 2, x, y), over);
    for (int t = 0; t < 4; t++)
        w[t] = vf_mul(w[t], vf_set1(HEXAGON_SCALE));
    for (int c = 0; c < f->s->channels; c++) {
        const vf top = vf_fma(w[1], vf_load(lane[0][1][c] + i), vf_mul(w[0], vf_load(lane[0][0][c] + i)));
        const vf bottom = vf_fma(w[3], vf_load(lane[1][1][c] + i), vf_mul(w[2], vf_load(lane[1][0][c] + i)));
        vf_store(hf_at(&f->buf[colour], c, x, y), vf_mul(vf_add(top, bottom), scale));
    }
}

// Radii of n pairs of pixels of row y, even and odd ones.
static void hex_radius_lanes(const struct hf_frame *f, int x, int y, int n, float *line, float *even, float *odd)
{
    const int pixels = hf_min(2 * n, f->s->width - 2 * x);
    f->k->radius_row(f, 2 * x, y, pixels, line, NULL);
    if (pixels < 2 * n)
        line[pixels] = line[pixels - 1];
    f->k->unzip(line, n, even, odd);
}

static void hex_load_half_row(const struct hf_frame *f, int y, struct hf_rect r)
{
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
    }
}

static void hexagon_load_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int half = f->s->resolution == HF_RESOLUTION_HALF;
    for (int y = half ? r.y0 : 2 * r.y0; y < (half ? r.y1 : hf_min(2 * r.y1, f->s->height)); y++)
        if (half)
            hex_load_half_row(f, y, r);
        else
            hex_load_full_row(f, y, r);
    vf_stream_end();
}

// ---- Composite ----

// The near field over a background.
HF_INLINE vf hex_over(vf near, vf coverage, vf left, vf all, vf b)
{
    return vf_select(vf_eq(coverage, vf_zero()), b, vf_div(vf_fma(left, b, near), all));
}

// Where a field shows, the blend in full brightness.
HF_INLINE void hex_store_blend(vm shows, vf blend, float *colour)
{
    const vf most = vf_set1(HEXAGON_MOST), least = vf_set1(-HEXAGON_MOST);
    const vf v = vf_mul(vf_max(vf_min(blend, most), least), vf_set1(1 / HEXAGON_SCALE));
    vf_store(colour, vf_select(shows, v, vf_load(colour)));
}

HF_INLINE vf hex_left_over(vf coverage, vf p)
{
    const vf own = hex_own(coverage, vf_sub(vf_zero(), p));
    return vf_max(vf_select(vf_lt(p, vf_zero()), own, vf_sub(vf_set1(1), coverage)), vf_zero());
}

HF_INLINE void hex_composite_full(const struct hf_frame *f, int x0, int y, int n, float *const colour[4],
                                  const int has_near, const int has_far)
{
    const float *radius = hf_at(&f->buf[HF_HEXAGON_WEIGHT], 1, x0, y);
    float *near[4], *far[4], *coverage[4];
    hf_row(hf_hexagon_made(f, HF_HEXAGON_NEAR), f->s->channels, x0, y, near);
    hf_row(hf_hexagon_made(f, HF_HEXAGON_FAR), f->s->channels, x0, y, far);
    hf_row(hf_hexagon_made(f, HF_HEXAGON_COVERAGE), 1, x0, y, coverage);
    for (int x = 0; x < n; x += VF_N) {
        const vf p = vf_load(radius + x), a = has_near ? vf_load(coverage[0] + x) : vf_zero();
        const vf left = hex_left_over(a, p), all = vf_add(a, left);
        const vm is_far = vf_gt(p, vf_zero()), is_near = vf_ne(a, vf_zero());
        for (int c = 0; c < f->s->channels; c++) {
            vf b = vf_mul(vf_load(colour[c] + x), vf_set1(HEXAGON_SCALE));
            if (has_far)
                b = vf_select(is_far, vf_load(far[c] + x), b);
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

// Where the four half-resolution neighbours of a row's even or odd pixels are, and their weights.
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

HF_INLINE void hex_composite_half(const struct hf_frame *f, int x0, int n, const float *radius, float *const colour[4],
                                  const struct hex_corner corner[4])
{
    const struct hf_buf *near = hf_hexagon_made(f, HF_HEXAGON_NEAR), *far = hf_hexagon_made(f, HF_HEXAGON_FAR);
    const struct hf_buf *coverage = hf_hexagon_made(f, HF_HEXAGON_COVERAGE);
    for (int x = 0; x < n; x += VF_N) {
        const vf p = vf_load(radius + x);
        vf w[4], far_w[4], far_sum = vf_zero(), a = vf_zero();
        for (int i = 0; i < 4; i++)
            w[i] = vf_set1(corner[i].weight);
        if (f->near)
            a = hex_bilinear(coverage, 0, x0 + x, corner, w);
        for (int i = 0; i < 4; i++) {
            const vf q = vf_load(hf_at(&f->buf[HF_HEXAGON_FAR_WEIGHT_2], 1, x0 + x + corner[i].x, corner[i].y));
            far_w[i] = vf_mul(w[i], coc_saturate(q));
            far_sum = vf_add(far_sum, far_w[i]);
        }
        const vf left = hex_left_over(a, p), all = vf_add(a, left);
        const vf blend = coc_saturate(vf_mul(vf_set1(0.5f), p));
        const vm is_near = vf_ne(a, vf_zero()), is_far = vm_and(vf_gt(p, vf_zero()), vf_gt(far_sum, vf_zero()));
        for (int c = 0; c < f->s->channels; c++) {
            vf b = vf_mul(vf_load(colour[c] + x), vf_set1(HEXAGON_SCALE));
            if (f->far)
                b = vf_select(is_far, vf_lerp(b, vf_div(hex_bilinear(far, c, x0 + x, corner, far_w), far_sum), blend),
                              b);
            if (f->near)
                b = hex_over(hex_bilinear(near, c, x0 + x, corner, w), a, left, all, b);
            hex_store_blend(f->far ? vm_or(is_near, is_far) : is_near, b, colour[c] + x);
        }
    }
}

static void hex_half_row(const struct hf_frame *f, int y, struct hf_rect r)
{
    const int n = r.x1 - r.x0, other = y / 2 + (y & 1 ? 1 : -1);
    float *lane[2][4], *radius[2] = {hf_line(f, 9), hf_line(f, 10)};
    const float *stored[2][4] = {{NULL}};
    for (int i = 0; i < 8; i++)
        lane[i >> 2][i & 3] = hf_line(f, i);
    hf_read_colour(f, r.x0, y, n, lane[0], lane[1], f->counts);
    hex_radius_lanes(f, r.x0, y, n, f->work, radius[0], radius[1]);
    for (int odd = 0; odd < 2; odd++) {
        const int side = odd ? 1 : -1;
        const struct hex_corner corner[4] = {
            {0, y / 2, 0.5625f}, {side, y / 2, 0.1875f}, {0, other, 0.1875f}, {side, other, 0.0625f}};
        hex_composite_half(f, r.x0, n, radius[odd], lane[odd], corner);
        for (int c = 0; c < f->s->channels; c++)
            stored[odd][c] = lane[odd][c];
    }
    f->counts->clamped += f->k->store[f->dst->format](f->dst, r.x0, y, n, stored[0], stored[1]);
}

static void hexagon_composite_simd(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height); y++)
        if (f->s->resolution == HF_RESOLUTION_HALF)
            hex_half_row(f, y, r);
        else
            hex_full_row(f, y, r);
}
