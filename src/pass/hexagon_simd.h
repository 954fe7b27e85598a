// SPDX-License-Identifier: BSD-3-Clause
// The hexagon engine on vectors.
//
// A line's taps are the same for all pixels, so each is a load at a fixed offset. What a tap costs is asking how much
// of a sample counts, so the radii around each block of pixels are looked at first: no tap is read that none of them
// reaches, and those that all of them reach are plain products, four where there would be ten operations. Skipped
// taps would add nothing and full ones have the same weight either way, so no bit depends on where a block lies.
// Where near and far pixels mix at full resolution, both fields' sums are made at once: they read the same samples,
// and loads that cross cache lines are what there is too much of.
#include "pass/hexagon.h"

enum { HEX_S = 1, HEX_STEP = HEX_S * VF_N, HEX_WIDTH = 128, HEX_HEIGHT = 16 };

struct hex_range {
    float least, most;
};

// Least and most radius in a block and all that a line reaches from it; of samples that hold 0 without a radius, the
// least above 0. Lanes past its end may hold anything: that widens the range, and NaN does not count.
HF_INLINE struct hex_range hex_range(const struct hf_hexagon_field *in, const struct hf_hexagon_line *l,
                                     struct hf_rect b)
{
    vf least = vf_set1(FLT_MAX), most = vf_set1(-FLT_MAX);
    const vf sign = vf_set1(in->sign);
    for (int y = b.y0 + l->y0; y < b.y1 + l->y1; y++)
        for (int x = b.x0 + l->x0; x < b.x1 + l->x1; x += VF_N) {
            const vf q = vf_mul(sign, vf_load(hf_at(in->radius, in->q, x, y)));
            const vf lower = vf_min(q, least);
            least = in->alone ? vf_select(vf_gt(q, vf_zero()), lower, least) : lower;
            most = vf_max(q, most);
        }
    float lanes[2][VF_N];
    vf_store(lanes[0], least);
    vf_store(lanes[1], most);
    struct hex_range r = {lanes[0][0], lanes[1][0]};
    for (int i = 1; i < VF_N; i++) {
        r.least = lanes[0][i] < r.least ? lanes[0][i] : r.least;
        r.most = lanes[1][i] > r.most ? lanes[1][i] : r.most;
    }
    return r;
}

// Least radius above 0 of a block's own pixels.
HF_INLINE float hex_least_far(const struct hf_hexagon_field *in, struct hf_rect b)
{
    vf least = vf_set1(FLT_MAX);
    for (int y = b.y0; y < b.y1; y++)
        for (int x = b.x0; x < b.x1; x += VF_N) {
            const vf q = vf_load(hf_at(in->radius, in->q, x, y));
            least = vf_select(vf_gt(q, vf_zero()), vf_min(q, least), least);
        }
    float lane[VF_N], r = FLT_MAX;
    vf_store(lane, least);
    for (int i = 0; i < VF_N; i++)
        r = lane[i] < r ? lane[i] : r;
    return r;
}

// Taps that every sample in the range reaches in full, and those that some reach.
struct hex_taps {
    const struct hf_hexagon_tap *taps, *full, *end;
    float full_weight;
};

HF_INLINE struct hex_taps hex_taps(const struct hf_hexagon_line *l, struct hex_range r)
{
    struct hex_taps t = {l->taps, l->taps, l->taps + l->count, 0};
    while (t.end > t.taps && !(r.most > t.end[-1].c))
        t.end--;
    while (t.full < t.end && r.least - t.full->c >= t.full->b)
        t.full_weight += t.full++->b;
    return t;
}

struct hex_sums {
    vf colour[4][HEX_S], a[HEX_S], w[HEX_S];
};

struct hex_limit {
    vf limit[HEX_S], slope[HEX_S];
};

// The sum of a line's own weights: not wanted, or with samples that are there in full, or in part.
enum hex_weights { HEX_NONE, HEX_WHOLE, HEX_PART };

// Sums along a line for HEX_STEP pixels from (x, y); limit NULL: none.
HF_INLINE struct hex_sums hex_line(const struct hf_hexagon_field *in, const struct hex_taps *t, const int channels,
                                   const enum hex_weights weights, int x, int y, const struct hex_limit *limit)
{
    const ptrdiff_t stride = in->colour->stride, weight_stride = in->weight->stride;
    const float *colour[4], *a = hf_at(in->weight, in->a, x, y), *radius = hf_at(in->radius, in->q, x, y);
    const float *part = weights == HEX_PART ? hf_at(in->weight, in->part, x, y) : NULL;
    for (int c = 0; c < channels; c++)
        colour[c] = hf_at(in->colour, c, x, y);
    struct hex_sums s;
#pragma GCC unroll 8
    for (int v = 0; v < HEX_S; v++) {
        for (int c = 0; c < channels; c++)
            s.colour[c][v] = vf_zero();
        s.a[v] = vf_zero();
        s.w[v] = vf_set1(weights == HEX_WHOLE ? t->full_weight : 0);
    }
    const struct hf_hexagon_tap *p = t->taps;
    for (; p < t->full && !limit; p++) {
        const ptrdiff_t at = p->dy * stride + p->dx, weight_at = p->dy * weight_stride + p->dx;
        const vf b = vf_set1(p->b);
#pragma GCC unroll 8
        for (int v = 0; v < HEX_S; v++) {
            for (int c = 0; c < channels; c++)
                s.colour[c][v] = vf_fma(b, vf_load(colour[c] + at + v * VF_N), s.colour[c][v]);
            s.a[v] = vf_fma(b, vf_load(a + weight_at + v * VF_N), s.a[v]);
            if (weights == HEX_PART)
                s.w[v] = vf_fma(b, vf_load(part + weight_at + v * VF_N), s.w[v]);
        }
    }
    const vf sign = vf_set1(in->sign);
    for (; p < t->end; p++) {
        const ptrdiff_t at = p->dy * stride + p->dx, weight_at = p->dy * weight_stride + p->dx;
        const vf b = vf_set1(p->b), before = vf_set1(p->c);
#pragma GCC unroll 8
        for (int v = 0; v < HEX_S; v++) {
            const vf q = vf_mul(sign, vf_load(radius + weight_at + v * VF_N));
            vf w = vf_sub(q, before);
            if (limit)
                w = vf_min(w, vf_mul(b, vf_sub(limit->limit[v], vf_mul(limit->slope[v], q))));
            w = vf_max(vf_min(w, b), vf_zero());
            for (int c = 0; c < channels; c++)
                s.colour[c][v] = vf_fma(w, vf_load(colour[c] + at + v * VF_N), s.colour[c][v]);
            s.a[v] = vf_fma(w, vf_load(a + weight_at + v * VF_N), s.a[v]);
            if (weights == HEX_WHOLE)
                s.w[v] = vf_add(s.w[v], w);
            if (weights == HEX_PART)
                s.w[v] = vf_fma(w, vf_load(part + weight_at + v * VF_N), s.w[v]);
        }
    }
    return s;
}

// ---- near ----

HF_INLINE void hex_store_near(const struct hf_frame *f, const struct hex_sums *s, const int channels,
                              enum hf_hexagon_made colour, int weight, int x, int y)
{
    const struct hf_buf *out = hf_hexagon_made(f, colour), *weights = hf_hexagon_made(f, HF_HEXAGON_NEAR_W);
    for (int v = 0; v < HEX_S; v++) {
        const vm any = vf_gt(s->a[v], vf_zero());
        const vf share = vf_keep(any, vf_div(s->a[v], s->w[v]));
        for (int c = 0; c < channels; c++)
            vf_store(hf_at(out, c, x + v * VF_N, y), vf_mul(s->colour[c][v], share));
        vf_store(hf_at(weights, weight, x + v * VF_N, y), vf_mul(s->a[v], share));
        vf_store(hf_at(weights, weight + 1, x + v * VF_N, y), vf_keep(any, vf_div(s->w[v], s->a[v])));
    }
}

HF_INLINE void hex_add(struct hex_sums *u, const struct hex_sums *v, const int channels)
{
    for (int i = 0; i < HEX_S; i++) {
        for (int c = 0; c < channels; c++)
            u->colour[c][i] = vf_add(u->colour[c][i], v->colour[c][i]);
        u->a[i] = vf_add(u->a[i], v->a[i]);
        u->w[i] = vf_add(u->w[i], v->w[i]);
    }
}

HF_INLINE void hex_near_1(const struct hf_frame *f, struct hf_rect b, const int channels,
                          const enum hex_weights weights)
{
    const struct hf_hexagon *h = f->s->tables;
    const struct hf_hexagon_field in = hf_hexagon_field(f, HF_NEAR);
    const struct hex_taps up = hex_taps(&h->line[0], hex_range(&in, &h->line[0], b));
    const struct hex_taps left = hex_taps(&h->line[1], hex_range(&in, &h->line[1], b));
    for (int y = b.y0; y < b.y1; y++)
        for (int x = b.x0; x < b.x1; x += HEX_STEP) {
            struct hex_sums u = hex_line(&in, &up, channels, weights, x, y, NULL);
            hex_store_near(f, &u, channels, HF_HEXAGON_NEAR_U, 0, x, y);
            const struct hex_sums v = hex_line(&in, &left, channels, weights, x, y, NULL);
            hex_add(&u, &v, channels);
            hex_store_near(f, &u, channels, HF_HEXAGON_NEAR_B, 2, x, y);
        }
}

HF_INLINE void hex_near_2(const struct hf_frame *f, struct hf_rect b, const int channels)
{
    const struct hf_hexagon *h = f->s->tables;
    const struct hf_hexagon_field in[2] = {hf_hexagon_field_2(f, HF_NEAR, 0), hf_hexagon_field_2(f, HF_NEAR, 1)};
    const struct hex_taps left = hex_taps(&h->line[1], hex_range(&in[0], &h->line[1], b));
    const struct hex_taps right = hex_taps(&h->line[2], hex_range(&in[1], &h->line[2], b));
    const struct hf_buf *out = hf_hexagon_made(f, HF_HEXAGON_NEAR), *a = hf_hexagon_made(f, HF_HEXAGON_COVERAGE);
    const vf third = vf_set1(1 / 3.0f);
    for (int y = b.y0; y < b.y1; y++)
        for (int x = b.x0; x < b.x1; x += HEX_STEP) {
            const struct hex_sums v = hex_line(&in[0], &left, channels, HEX_NONE, x, y, NULL);
            const struct hex_sums w = hex_line(&in[1], &right, channels, HEX_NONE, x, y, NULL);
            for (int i = 0; i < HEX_S; i++) {
                for (int c = 0; c < channels; c++)
                    vf_store(hf_at(out, c, x + i * VF_N, y), vf_mul(vf_add(v.colour[c][i], w.colour[c][i]), third));
                vf_store(hf_at(a, 0, x + i * VF_N, y), vf_mul(vf_add(v.a[i], w.a[i]), third));
            }
        }
}

// ---- far ----

HF_INLINE vf hex_own(vf found, vf p)
{
    const vf least = vf_sub(vf_set1(HEXAGON_LEAST), found);
    vf o = vf_mul(vf_sub(vf_set1(1), found), coc_saturate(vf_sub(vf_set1(HEXAGON_ALL), p)));
    o = vf_max(o, least);
    return vf_max(o, vf_zero());
}

// A line of the far field in a block: its taps, and whether some pixel may find a sample too far behind it.
struct hex_far {
    struct hf_hexagon_field in;
    struct hex_taps taps;
    int limited;
};

HF_INLINE struct hex_far hex_far(const struct hf_frame *f, const struct hf_hexagon_field *in, int line, float least,
                                 struct hf_rect b)
{
    const struct hf_hexagon_line *l = &((const struct hf_hexagon *)f->s->tables)->line[line];
    const struct hex_range r = hex_range(in, l, b);
    // Clearly below 2p, where limit - slope q is not less than 1 however it is rounded.
    return (struct hex_far){*in, hex_taps(l, r), !(r.most <= 1.9999f * least)};
}

HF_INLINE struct hex_limit hex_limit(const vf p[HEX_S])
{
    struct hex_limit l;
    for (int i = 0; i < HEX_S; i++) {
        l.slope[i] = vf_div(vf_set1(1), vf_min(p[i], vf_set1(1)));
        l.limit[i] = vf_add(vf_mul(vf_mul(vf_set1(2), p[i]), l.slope[i]), vf_set1(1));
    }
    return l;
}

// The sums of a line to colours, with the pixel's own where they are too little.
HF_INLINE void hex_far_colours(const struct hf_hexagon_field *in, const struct hex_sums *s, const int channels, int x,
                               int y, const vf p[HEX_S], vf out[4][HEX_S])
{
    for (int i = 0; i < HEX_S; i++) {
        const vf o = hex_own(s->a[i], p[i]), scale = vf_div(vf_set1(1), vf_add(s->a[i], o));
        const vf mine = vf_div(o, vf_load(hf_at(in->weight, in->a, x + i * VF_N, y)));
        for (int c = 0; c < channels; c++) {
            const vf own = vf_load(hf_at(in->colour, c, x + i * VF_N, y));
            const vf v = vf_mul(vf_fma(mine, own, s->colour[c][i]), scale);
            out[c][i] = vf_keep(vf_gt(p[i], vf_zero()), v);
        }
    }
}

HF_INLINE void hex_far_line(const struct hex_far *l, const int channels, int x, int y, const vf p[HEX_S],
                            vf out[4][HEX_S])
{
    struct hex_sums s;
    if (l->limited) {
        const struct hex_limit limit = hex_limit(p);
        s = hex_line(&l->in, &l->taps, channels, HEX_NONE, x, y, &limit);
    } else {
        s = hex_line(&l->in, &l->taps, channels, HEX_NONE, x, y, NULL);
    }
    hex_far_colours(&l->in, &s, channels, x, y, p, out);
}

// Nothing far in a block: it shows nothing.
HF_INLINE void hex_clear(const struct hf_buf *out, struct hf_rect b, const int channels)
{
    for (int c = 0; c < channels; c++)
        for (int y = b.y0; y < b.y1; y++)
            for (int x = b.x0; x < b.x1; x += VF_N)
                vf_store(hf_at(out, c, x, y), vf_zero());
}

HF_INLINE void hex_store_far(const struct hf_frame *f, const struct hf_hexagon_field *in, const int channels, int x,
                             int y, vf u[4][HEX_S], vf v[4][HEX_S])
{
    const struct hf_buf *up = hf_hexagon_made(f, HF_HEXAGON_FAR_U), *both = hf_hexagon_made(f, HF_HEXAGON_FAR_B);
    for (int i = 0; i < HEX_S; i++) {
        const vf a = vf_load(hf_at(in->weight, in->a, x + i * VF_N, y));
        for (int c = 0; c < channels; c++) {
            vf_store(hf_at(up, c, x + i * VF_N, y), vf_mul(u[c][i], a));
            vf_store(hf_at(both, c, x + i * VF_N, y), vf_mul(vf_add(u[c][i], v[c][i]), a));
        }
    }
}

HF_INLINE void hex_far_1(const struct hf_frame *f, struct hf_rect b, const int channels)
{
    const struct hf_hexagon_field in = hf_hexagon_field(f, HF_FAR);
    const float least = hex_least_far(&in, b);
    if (least == FLT_MAX) {
        hex_clear(hf_hexagon_made(f, HF_HEXAGON_FAR_U), b, channels);
        hex_clear(hf_hexagon_made(f, HF_HEXAGON_FAR_B), b, channels);
        return;
    }
    const struct hex_far up = hex_far(f, &in, 0, least, b), left = hex_far(f, &in, 1, least, b);
    for (int y = b.y0; y < b.y1; y++)
        for (int x = b.x0; x < b.x1; x += HEX_STEP) {
            vf p[HEX_S], u[4][HEX_S], v[4][HEX_S];
            for (int i = 0; i < HEX_S; i++)
                p[i] = vf_load(hf_at(in.radius, in.q, x + i * VF_N, y));
            hex_far_line(&up, channels, x, y, p, u);
            hex_far_line(&left, channels, x, y, p, v);
            hex_store_far(f, &in, channels, x, y, u, v);
        }
}

HF_INLINE void hex_far_2(const struct hf_frame *f, struct hf_rect b, const int channels)
{
    const struct hf_hexagon_field in[2] = {hf_hexagon_field_2(f, HF_FAR, 0), hf_hexagon_field_2(f, HF_FAR, 1)};
    const struct hf_buf *out = hf_hexagon_made(f, HF_HEXAGON_FAR);
    const float least = hex_least_far(&in[0], b);
    if (least == FLT_MAX) {
        hex_clear(out, b, channels);
        return;
    }
    const struct hex_far left = hex_far(f, &in[0], 1, least, b), right = hex_far(f, &in[1], 2, least, b);
    for (int y = b.y0; y < b.y1; y++)
        for (int x = b.x0; x < b.x1; x += HEX_STEP) {
            vf p[HEX_S], v[4][HEX_S], w[4][HEX_S];
            for (int i = 0; i < HEX_S; i++)
                p[i] = vf_load(hf_at(in[0].radius, in[0].q, x + i * VF_N, y));
            hex_far_line(&left, channels, x, y, p, v);
            hex_far_line(&right, channels, x, y, p, w);
            for (int i = 0; i < HEX_S; i++)
                for (int c = 0; c < channels; c++)
                    vf_store(hf_at(out, c, x + i * VF_N, y),
                             vf_mul(vf_add(v[c][i], w[c][i]), vf_set1(1 / 3.0f)));
        }
}

// ---- both fields at once: pass 1 at full resolution ----

// Sums of both fields along a line; limit NULL: none for far.
HF_INLINE void hex_line_both(const struct hf_hexagon_field *in, const struct hf_hexagon_tap *p,
                             const struct hf_hexagon_tap *end, const int channels, int x, int y,
                             const struct hex_limit *limit, struct hex_sums *near, struct hex_sums *far)
{
    const ptrdiff_t stride = in->colour->stride, weight_stride = in->weight->stride;
    const float *colour[4], *a = hf_at(in->weight, in->a, x, y), *radius = hf_at(in->radius, in->q, x, y);
    for (int c = 0; c < channels; c++)
        colour[c] = hf_at(in->colour, c, x, y);
#pragma GCC unroll 8
    for (int v = 0; v < HEX_S; v++) {
        for (int c = 0; c < channels; c++)
            near->colour[c][v] = far->colour[c][v] = vf_zero();
        near->a[v] = near->w[v] = far->a[v] = far->w[v] = vf_zero();
    }
    for (; p < end; p++) {
        const ptrdiff_t at = p->dy * stride + p->dx, weight_at = p->dy * weight_stride + p->dx;
        const vf b = vf_set1(p->b), before = vf_set1(p->c);
#pragma GCC unroll 8
        for (int v = 0; v < HEX_S; v++) {
            const vf r = vf_once(vf_load(radius + weight_at + v * VF_N)), q = vf_sub(vf_zero(), r);
            const vf n = vf_max(vf_min(vf_sub(q, before), b), vf_zero());
            vf w = vf_sub(r, before);
            if (limit)
                w = vf_min(w, vf_mul(b, vf_sub(limit->limit[v], vf_mul(limit->slope[v], r))));
            w = vf_max(vf_min(w, b), vf_zero());
            for (int c = 0; c < channels; c++) {
                const vf value = vf_once(vf_load(colour[c] + at + v * VF_N));
                near->colour[c][v] = vf_fma(n, value, near->colour[c][v]);
                far->colour[c][v] = vf_fma(w, value, far->colour[c][v]);
            }
            const vf weight = vf_once(vf_load(a + weight_at + v * VF_N));
            near->a[v] = vf_fma(n, weight, near->a[v]);
            near->w[v] = vf_add(near->w[v], n);
            far->a[v] = vf_fma(w, weight, far->a[v]);
        }
    }
}

HF_INLINE void hex_both_sums(const struct hf_frame *f, struct hf_rect b, const int channels,
                             const struct hf_hexagon_field *in, const struct hf_hexagon_tap *const end[2],
                             const int limited)
{
    const struct hf_hexagon *h = f->s->tables;
    for (int y = b.y0; y < b.y1; y++)
        for (int x = b.x0; x < b.x1; x += HEX_STEP) {
            struct hex_sums near[2], far[2];
            struct hex_limit limit;
            vf p[HEX_S], colours[2][4][HEX_S];
            for (int i = 0; i < HEX_S; i++)
                p[i] = vf_load(hf_at(in->radius, in->q, x + i * VF_N, y));
            if (limited)
                limit = hex_limit(p);
            for (int i = 0; i < 2; i++) {
                hex_line_both(in, h->line[i].taps, end[i], channels, x, y, limited ? &limit : NULL, &near[i], &far[i]);
                hex_far_colours(in, &far[i], channels, x, y, p, colours[i]);
            }
            hex_store_near(f, &near[0], channels, HF_HEXAGON_NEAR_U, 0, x, y);
            hex_add(&near[0], &near[1], channels);
            hex_store_near(f, &near[0], channels, HF_HEXAGON_NEAR_B, 2, x, y);
            hex_store_far(f, in, channels, x, y, colours[0], colours[1]);
        }
}

// Pass 1 of a block in which both fields may be found.
HF_INLINE void hex_both_1(const struct hf_frame *f, struct hf_rect b, const int channels)
{
    const struct hf_hexagon *h = f->s->tables;
    const struct hf_hexagon_field in = hf_hexagon_field(f, HF_FAR);
    const float least = hex_least_far(&in, b);
    const struct hf_hexagon_tap *end[2];
    float near = 0, far = 0;
    for (int i = 0; i < 2; i++) {
        const struct hex_range r = hex_range(&in, &h->line[i], b);
        near = r.least < near ? r.least : near;
        far = r.most > far ? r.most : far;
        end[i] = hex_taps(&h->line[i], (struct hex_range){0, r.most > -r.least ? r.most : -r.least}).end;
    }
    if (least == FLT_MAX || !(near < 0)) {
        hex_near_1(f, b, channels, HEX_WHOLE);
        hex_far_1(f, b, channels);
    } else if (far <= 1.9999f * least) {
        hex_both_sums(f, b, channels, &in, end, 0);
    } else {
        hex_both_sums(f, b, channels, &in, end, 1);
    }
}

// ---- the passes ----

HF_INLINE void hex_pass(const struct hf_frame *f, struct hf_rect r, const int second, const int channels)
{
    const struct hf_rect p = hf_hexagon_rect(f->s, r);
    for (int y = p.y0; y < p.y1; y += HEX_HEIGHT)
        for (int x = p.x0; x < p.x1; x += HEX_WIDTH) {
            const struct hf_rect b = {x, y, hf_min(x + HEX_WIDTH, p.x1), hf_min(y + HEX_HEIGHT, p.y1)};
            if (!second && f->near && f->far && f->s->resolution == HF_RESOLUTION_FULL) {
                hex_both_1(f, b, channels);
                continue;
            }
            if (f->near && second)
                hex_near_2(f, b, channels);
            else if (f->near && f->s->resolution == HF_RESOLUTION_HALF)
                hex_near_1(f, b, channels, HEX_PART);
            else if (f->near)
                hex_near_1(f, b, channels, HEX_WHOLE);
            if (f->far && second)
                hex_far_2(f, b, channels);
            else if (f->far)
                hex_far_1(f, b, channels);
        }
}

static void hexagon_1_simd(const struct hf_frame *f, struct hf_rect r)
{
    if (f->s->channels == 4)
        hex_pass(f, r, 0, 4);
    else
        hex_pass(f, r, 0, 3);
}

static void hexagon_2_simd(const struct hf_frame *f, struct hf_rect r)
{
    if (f->s->channels == 4)
        hex_pass(f, r, 1, 4);
    else
        hex_pass(f, r, 1, 3);
}
