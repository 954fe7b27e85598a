// SPDX-License-Identifier: BSD-3-Clause
// The hexagon engine on vectors: the near and the far blur, of sums along lines (line_simd.h).
#ifndef HF_HEXAGON_BLUR_SIMD_H
#define HF_HEXAGON_BLUR_SIMD_H

#include "engine/hexagon/line_simd.h"

// ---- near ----

HF_INLINE void hex_store_near(const struct hf_buf *made, const struct hex_sums *s, const int channels,
                              enum hf_hexagon_made colour, int weight, int x, int y)
{
    const struct hf_buf *out = made + colour, *weights = made + HF_HEXAGON_NEAR_W;
    const vm any = vf_gt(s->a, vf_zero());
    const vf root = vf_keep(any, vf_div(s->a, s->w)), share = vf_mul(root, root);
    const vf mean = vf_keep(any, vf_div(s->w, s->a));
    for (int c = 0; c < channels; c++)
        vf_store(hf_at(out, c, x, y), vf_mul(s->colour[c], share));
    vf_store(hf_at(weights, weight, x, y), vf_mul(s->a, share));
    vf_store(hf_at(weights, weight + 1, x, y), vf_mul(mean, mean));
}

HF_INLINE void hex_add(struct hex_sums *u, const struct hex_sums *v, const int channels)
{
    for (int c = 0; c < channels; c++)
        u->colour[c] = vf_add(u->colour[c], v->colour[c]);
    u->a = vf_add(u->a, v->a);
    u->w = vf_add(u->w, v->w);
}

// Clear a block where the field has nothing.
HF_INLINE void hex_clear(const struct hf_buf *out, struct hf_rect b, const int channels)
{
    for (int c = 0; c < channels; c++)
        for (int y = b.y0; y < b.y1; y++)
            for (int x = b.x0; x < b.x1; x += VF_N)
                vf_store(hf_at(out, c, x, y), vf_zero());
}

HF_INLINE void hex_near_1(const struct hf_frame *f, struct hf_rect b, const int channels, const int rows)
{
    const struct hf_buf *made = hf_hexagon_made(f, 0);
    const struct hf_hexagon *h = hf_hexagon(f->s);
    const struct hf_hexagon_field in = hf_hexagon_field(f, HF_NEAR);
    const int below = hf_max(h->line[0].y1, h->line[1].y1);
    const struct hex_run up = hex_run(&h->line[0], rows, hex_range(&in, &h->line[0], b));
    const struct hex_run left = hex_run(&h->line[1], rows, hex_range(&in, &h->line[1], b));
    if (up.end == up.step && left.end == left.step) {
        hex_clear(made + HF_HEXAGON_NEAR_U, b, channels);
        hex_clear(made + HF_HEXAGON_NEAR_B, b, channels);
        hex_clear(made + HF_HEXAGON_NEAR_W, b, 4);
        return;
    }
    HEX_EACH(b, rows, x, y)
    {
        struct hex_sums u[HEX_ROWS], v[HEX_ROWS];
        hex_fetch(&in, channels, rows, x, y + HEX_HEIGHT + below);
        hex_line(&in, &up, channels, 1, rows, x, y, NULL, u);
        for (int i = 0; i < rows; i++)
            hex_store_near(made, &u[i], channels, HF_HEXAGON_NEAR_U, 0, x, y + i);
        hex_line(&in, &left, channels, 1, rows, x, y, NULL, v);
        for (int i = 0; i < rows; i++) {
            hex_add(&u[i], &v[i], channels);
            hex_store_near(made, &u[i], channels, HF_HEXAGON_NEAR_B, 2, x, y + i);
        }
    }
}

HF_INLINE void hex_near_2(const struct hf_frame *f, struct hf_rect b, const int channels, const int rows)
{
    const struct hf_hexagon *h = hf_hexagon(f->s);
    const struct hf_hexagon_field in[2] = {hf_hexagon_field_2(f, HF_NEAR, 0), hf_hexagon_field_2(f, HF_NEAR, 1)};
    const struct hex_run left = hex_run(&h->line[1], rows, hex_range(&in[0], &h->line[1], b));
    const struct hex_run right = hex_run(&h->line[2], rows, hex_range(&in[1], &h->line[2], b));
    const struct hf_buf *out = hf_hexagon_made(f, HF_HEXAGON_NEAR), *a = hf_hexagon_made(f, HF_HEXAGON_COVERAGE);
    const vf third = vf_set1(1 / 3.0f);
    if (left.end == left.step && right.end == right.step) {
        hex_clear(out, b, channels);
        hex_clear(a, b, 1);
        return;
    }
    HEX_EACH(b, rows, x, y)
    {
        struct hex_sums v[HEX_ROWS], w[HEX_ROWS];
        hex_line(&in[0], &left, channels, 0, rows, x, y, NULL, v);
        hex_line(&in[1], &right, channels, 0, rows, x, y, NULL, w);
        for (int i = 0; i < rows; i++) {
            for (int c = 0; c < channels; c++)
                vf_store(hf_at(out, c, x, y + i), vf_mul(vf_add(v[i].colour[c], w[i].colour[c]), third));
            vf_store(hf_at(a, 0, x, y + i), vf_mul(vf_add(v[i].a, w[i].a), third));
        }
    }
}

// ---- far ----

HF_INLINE vf hex_own(vf found, vf p)
{
    const vf least = vf_sub(vf_set1(HEXAGON_LEAST), found);
    vf o = vf_mul(vf_sub(vf_set1(1), found), vf_saturate(vf_sub(vf_set1(HEXAGON_ALL), p)));
    o = vf_max(o, least);
    return vf_max(o, vf_zero());
}

// A line of the far field in a block: its taps, and whether some pixel may meet a sample too far behind it.
struct hex_far {
    struct hf_hexagon_field in;
    struct hex_run run;
    int limited;
};

HF_INLINE struct hex_far hex_far(const struct hf_frame *f, const struct hf_hexagon_field *in, int line, float least,
                                 struct hf_rect b, const int rows)
{
    const struct hf_hexagon_line *l = &hf_hexagon(f->s)->line[line];
    const struct hex_range r = hex_range(in, l, b);
    // Clearly below 2p, limit - slope q is at least 1, however it is rounded.
    return (struct hex_far){*in, hex_run(l, rows, r), !(r.most <= 1.9999f * least)};
}

HF_INLINE struct hex_limit hex_limit(vf p)
{
    const vf slope = vf_div(vf_set1(1), vf_min(p, vf_set1(1)));
    return (struct hex_limit){vf_add(vf_mul(vf_mul(vf_set1(2), p), slope), vf_set1(1)), vf_sub(vf_zero(), slope)};
}

// As hf_hexagon_light.
HF_INLINE vf hex_light(const vf colour[3])
{
    const vf low = vf_min(colour[0], colour[1]), high = vf_max(colour[0], colour[1]), b = colour[2];
    const vf most = vf_max(high, b), other = vf_min(high, b), least = vf_min(low, b), middle = vf_max(low, other);
    return vf_abs(vf_add(vf_add(most, least), middle));
}

// Turn a line's sums at pixels of radius p into mean colours, the weight found, and in pass 1 the mean light over
// radius. The pixel's own colour is added where too little was found.
HF_INLINE struct hex_sums hex_found(const struct hf_hexagon_field *in, const struct hex_sums *s, const int channels,
                                    const int first, int x, int y, vf p)
{
    const vf o = hex_own(s->a, p), all = vf_add(s->a, o), scale = vf_div(vf_set1(1), all);
    const vf mine = vf_div(o, vf_load(hf_at(in->weight, in->a, x, y)));
    const vm is = vf_gt(p, vf_zero());
    struct hex_sums found;  // no initialiser: gcc would clear all of it by a string instruction
    found.a = vf_keep(is, all);
    found.w = vf_zero();
    if (first) {
        const vf own = vf_load(hf_at(in->weight, in->mean, x, y));
        found.w = vf_keep(is, vf_mul(vf_fma(mine, own, s->w), scale));
    }
    for (int c = 0; c < 3; c++) {
        const vf own = vf_load(hf_at(in->colour, c, x, y));
        found.colour[c] = vf_keep(is, vf_mul(vf_fma(mine, own, s->colour[c]), scale));
    }
    if (channels == 4) {
        const vf own = vf_div(vf_load(hf_at(in->colour, 3, x, y)), vf_load(hf_at(in->weight, in->a, x, y)));
        found.colour[3] = vf_keep(is, vf_div(vf_fma(o, own, s->colour[3]), all));
    }
    return found;
}

// The sums without the pixel's own colour.
HF_INLINE void hex_far_sums(const struct hex_far *l, const int channels, const int first, const int rows, int x, int y,
                            const vf p[HEX_ROWS], struct hex_sums s[HEX_ROWS])
{
    if (l->limited) {
        struct hex_limit limit[HEX_ROWS];
        for (int i = 0; i < rows; i++)
            limit[i] = hex_limit(p[i]);
        hex_line(&l->in, &l->run, channels, first, rows, x, y, limit, s);
    } else {
        hex_line(&l->in, &l->run, channels, first, rows, x, y, NULL, s);
    }
}

HF_INLINE void hex_far_line(const struct hex_far *l, const int channels, const int first, const int rows, int x, int y,
                            const vf p[HEX_ROWS], struct hex_sums out[HEX_ROWS])
{
    struct hex_sums s[HEX_ROWS];
    hex_far_sums(l, channels, first, rows, x, y, p, s);
    for (int i = 0; i < rows; i++)
        out[i] = hex_found(&l->in, &s[i], channels, first, x, y + i, p[i]);
}

HF_INLINE void hex_store_far(const struct hf_buf *made, const struct hex_sums *s, const int channels, vf p, vf part,
                             vf whole, enum hf_hexagon_made colour, int weight, int x, int y)
{
    const struct hf_buf *out = made + colour, *weights = made + HF_HEXAGON_FAR_W;
    const vf one = vf_set1(1);
    const vm any = vf_gt(s->a, vf_zero());
    const vf mean = vf_select(vf_gt(s->w, vf_zero()), vf_div(hex_light(s->colour), s->w), p);
    const vf q = vf_keep(any, vf_max(mean, vf_set1(HEXAGON_LEAST_MEAN)));
    const vf a = vf_keep(any, vf_div(part, vf_max(q, one)));
    for (int c = 0; c < channels; c++)
        vf_store(hf_at(out, c, x, y), vf_mul(s->colour[c], a));
    vf_store(hf_at(weights, weight, x, y), vf_mul(whole, a));
    vf_store(hf_at(weights, weight + 1, x, y), q);
}

// As hf_hexagon_along.
HF_INLINE vf hex_beside(float side, int size, vf at, vf by)
{
    const vf inside = side > 0 ? vf_sub(vf_sub(vf_set1((float)size), at), by) : vf_add(at, by);
    return vf_max(inside, vf_set1(0x1p-10f));
}

HF_INLINE vf hex_along(int width, int height, const float side[2], const vf at[2], const vf by[2], vf i)
{
    const vf right = hex_beside(side[0], width, at[0], by[0]), down = hex_beside(side[1], height, at[1], by[1]);
    const vf d = vf_min(vf_mul(vf_mul(right, vf_set1(__builtin_fabsf(side[0]))), i),
                        vf_mul(vf_mul(down, vf_set1(__builtin_fabsf(side[1]))), i));
    return vf_min(d, vf_set1(1));
}

HF_INLINE vf hex_across(int x)
{
    static const float steps[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    return vf_add(vf_set1((float)x + 0.5f), vf_load(steps));
}

// Scale what a line of pixels of radius p found by its part within the frame; returns that part.
HF_INLINE vf hex_keep_within(const struct hf_frame *f, struct hex_sums *s, const int channels, int line, int x, int y,
                             vf p)
{
    const vf here[2] = {vf_zero(), vf_zero()}, at[2] = {hex_across(x), vf_set1((float)y + 0.5f)};
    const vf i = vf_div(vf_set1(1), vf_select(vf_gt(p, vf_zero()), p, vf_set1(1)));
    const vf part =
        hex_along(hf_hexagon_width(f->s), hf_hexagon_height(f->s), hf_hexagon(f->s)->side[line], at, here, i);
    for (int c = 0; c < channels; c++)
        s->colour[c] = vf_mul(s->colour[c], part);
    s->w = vf_mul(s->w, part);
    return part;
}

// Whether a line of some pixel in a block may leave the frame. If not, all lines lie within it. A line reaches less
// than 2 pixels beyond its last place.
HF_INLINE int hex_leaves(const struct hf_frame *f, struct hf_rect b)
{
    const struct hf_hexagon_line *u = &hf_hexagon(f->s)->line[0], *v = &hf_hexagon(f->s)->line[1];
    return b.x0 + hf_min(u->x0, v->x0) < 2 || b.x1 + hf_max(u->x1, v->x1) > hf_hexagon_width(f->s) - 2 ||
           b.y0 + hf_min(u->y0, v->y0) < 2 || b.y1 + hf_max(u->y1, v->y1) > hf_hexagon_height(f->s) - 2;
}

// What vectors of rows have once pass 1 has stored what it found there: radii, their own m, and the mean m of both lines.
struct hex_mean {
    vf p[HEX_ROWS], own[HEX_ROWS], all[HEX_ROWS];
};

// As add_lit() of blur.c.
HF_INLINE void hex_add_lit(const struct hf_frame *f, const struct hf_hexagon_field *in, int line, int x, int y, vf p,
                           vf all, vf lit[2])
{
    const struct hf_hexagon_line *l = &hf_hexagon(f->s)->line[line];
    const struct hex_limit limit = hex_limit(p);
    const vf zero = vf_zero(), sign = vf_set1(in->sign);
    for (const struct hf_hexagon_tap *t = l->taps; t < l->taps + l->count; t++) {
        const vf q = vf_mul(sign, vf_load(hf_at(in->radius, in->q, x + t->dx, y + t->dy)));
        const vf w = hex_count(q, t->c, t->b, t->part, &limit);
        const vf m = vf_div(vf_load(hf_at(in->weight, in->mean, x + t->dx, y + t->dy)), all);
        const vf light = vf_keep(vf_gt(w, zero), vf_mul(w, m));
        lit[0] = vf_add(lit[0], light);
        lit[1] = vf_add(lit[1], vf_keep(vf_gt(w, zero), vf_mul(light, m)));
    }
}

// As fade_mean() of blur.c, where dark.
HF_INLINE void hex_fade_mean(const struct hf_frame *f, const vf lit[2], vf p, vf bright, vm dark,
                             enum hf_hexagon_made colour, int weight, int x, int y)
{
    const struct hf_buf *weights = hf_hexagon_made(f, HF_HEXAGON_FAR_W);
    const vf one = vf_set1(1), length = vf_mul(vf_div(lit[0], lit[1]), vf_mul(lit[0], vf_set1(1 / HEXAGON_TRACE)));
    const vf sure = vf_max(length, bright);
    const vm is = vm_and(dark, vm_and(vf_gt(lit[1], vf_zero()), vf_lt(sure, one)));
    if (!vm_any(is))
        return;
    float *q = hf_at(weights, weight + 1, x, y), *whole = hf_at(weights, weight, x, y);
    const vf old = vf_load(q), mean = vf_fma(vf_sub(p, old), vf_sub(one, sure), old);
    const vf least = vf_max(mean, vf_set1(HEXAGON_LEAST_MEAN)), a = vf_div(vf_max(old, one), vf_max(least, one));
    for (int c = 0; c < f->s->channels; c++) {
        float *to = hf_at(hf_hexagon_made(f, colour), c, x, y);
        vf_store(to, vf_select(is, vf_mul(vf_load(to), a), vf_load(to)));
    }
    vf_store(whole, vf_select(is, vf_mul(vf_load(whole), a), vf_load(whole)));
    vf_store(q, vf_select(is, least, old));
}

// As fade_traces() of blur.c. Few vectors are dark.
static __attribute__((noinline)) void hex_fade_traces(const struct hf_frame *f, const int rows, int x, int y,
                                                      const struct hex_mean *mean)
{
    const struct hf_hexagon_field in = hf_hexagon_field(f, HF_FAR);
    for (int i = 0; i < rows; i++) {
        const vf p = mean->p[i], own = mean->own[i], all = mean->all[i], most = vf_mul(all, vf_set1(HEXAGON_DARK));
        const vf bright = vf_div(own, most);
        const vm dark = vf_gt(most, own);
        vf lit[2] = {vf_zero(), vf_zero()};
        if (!vm_any(dark))
            continue;
        hex_add_lit(f, &in, 0, x, y + i, p, all, lit);
        hex_fade_mean(f, lit, p, bright, dark, HF_HEXAGON_FAR_U, 0, x, y + i);
        hex_add_lit(f, &in, 1, x, y + i, p, all, lit);
        hex_fade_mean(f, lit, p, bright, dark, HF_HEXAGON_FAR_B, 2, x, y + i);
    }
}

// u: the sums of both lines. A copy of them leaves those of the loops in registers.
HF_INLINE void hex_traces(const struct hf_frame *f, const int rows, int x, int y, const vf p[HEX_ROWS],
                          const vf own[HEX_ROWS], const struct hex_sums u[HEX_ROWS])
{
    vm dark = vf_gt(vf_mul(u[0].w, vf_set1(HEXAGON_DARK)), own[0]);
    for (int i = 1; i < rows; i++)
        dark = vm_or(dark, vf_gt(vf_mul(u[i].w, vf_set1(HEXAGON_DARK)), own[i]));
    if (!vm_any(dark))
        return;
    struct hex_mean mean;
    for (int i = 0; i < rows; i++) {
        mean.p[i] = p[i];
        mean.own[i] = own[i];
        mean.all[i] = u[i].w;
    }
    hex_fade_traces(f, rows, x, y, &mean);
}

HF_INLINE void hex_far_1(const struct hf_frame *f, struct hf_rect b, const int channels, const int rows)
{
    const struct hf_buf *made = hf_hexagon_made(f, 0);
    const struct hf_hexagon_field in = hf_hexagon_field(f, HF_FAR);
    const struct hf_hexagon *h = hf_hexagon(f->s);
    const int below = hf_max(h->line[0].y1, h->line[1].y1);
    const float least = hex_least_far(&in, b);
    if (least == FLT_MAX) {
        hex_clear(made + HF_HEXAGON_FAR_U, b, channels);
        hex_clear(made + HF_HEXAGON_FAR_B, b, channels);
        hex_clear(made + HF_HEXAGON_FAR_W, b, 4);
        return;
    }
    const struct hex_far up = hex_far(f, &in, 0, least, b, rows), left = hex_far(f, &in, 1, least, b, rows);
    const int leaves = hex_leaves(f, b);
    HEX_EACH(b, rows, x, y)
    {
        vf p[HEX_ROWS], part[HEX_ROWS], all[HEX_ROWS];
        struct hex_sums u[HEX_ROWS], v[HEX_ROWS];
        hex_fetch(&in, channels, rows, x, y + HEX_HEIGHT + below);
        for (int i = 0; i < rows; i++) {
            p[i] = vf_load(hf_at(in.radius, in.q, x, y + i));
            part[i] = vf_mul(vf_load(hf_at(in.weight, in.a, x, y + i)), vf_max(p[i], vf_set1(1)));
        }
        hex_far_line(&up, channels, 1, rows, x, y, p, u);
        for (int i = 0; i < rows; i++) {
            all[i] = leaves ? hex_keep_within(f, &u[i], channels, 0, x, y + i, p[i]) : vf_set1(1);
            hex_store_far(made, &u[i], channels, p[i], part[i], all[i], HF_HEXAGON_FAR_U, 0, x, y + i);
        }
        hex_far_line(&left, channels, 1, rows, x, y, p, v);
        for (int i = 0; i < rows; i++) {
            if (leaves)
                all[i] = vf_mul(vf_set1(0.5f), vf_add(all[i], hex_keep_within(f, &v[i], channels, 1, x, y + i, p[i])));
            hex_add(&u[i], &v[i], channels);
            hex_store_far(made, &u[i], channels, p[i], part[i], all[i], HF_HEXAGON_FAR_B, 2, x, y + i);
        }
        vf own[HEX_ROWS];
        for (int i = 0; i < rows; i++)
            own[i] = vf_load(hf_at(in.weight, in.mean, x, y + i));
        hex_traces(f, rows, x, y, p, own, u);
    }
}

// ---- far, beyond the frame ----

// For the pixels of a block, the frame's nearest pixels; a vector past a row's end is 0.
struct hex_nearest {
    float p[HEX_HEIGHT][HEX_WIDTH + VF_N], part[HEX_HEIGHT][HEX_WIDTH + VF_N], own[HEX_HEIGHT][HEX_WIDTH + VF_N];
    float least;  // the least radius above 0
};

static void hex_nearest(const struct hf_frame *f, const struct hf_hexagon_field *in, struct hf_rect b,
                        struct hex_nearest *n)
{
    n->least = FLT_MAX;
    for (int y = b.y0; y < b.y1; y++)
        for (int x = b.x0; x < b.x1 + VF_N; x++) {
            int u = x, v = y;
            const int is = hf_hexagon_nearest(f->s, &u, &v) && x < b.x1;
            const float q = is ? *hf_at(in->radius, in->q, u, v) : 0;
            n->p[y - b.y0][x - b.x0] = q;
            n->part[y - b.y0][x - b.x0] = is ? *hf_at(in->weight, in->a, u, v) * (q > 1 ? q : 1) : 0;
            n->own[y - b.y0][x - b.x0] = is ? *hf_at(in->weight, in->mean, u, v) : 0;
            if (q > 0 && q < n->least)
                n->least = q;
        }
}

// The sums of a line that reaches beyond the frame. They are normalised only if their weight exceeds 1.
HF_INLINE void hex_beyond_line(const struct hex_far *l, const int channels, const int rows, int x, int y,
                               const vf p[HEX_ROWS], struct hex_sums s[HEX_ROWS])
{
    const vf one = vf_set1(1);
    hex_far_sums(l, channels, 1, rows, x, y, p, s);
    for (int i = 0; i < rows; i++) {
        const vm is = vf_gt(p[i], vf_zero());
        const vf scale = vf_div(one, vf_max(s[i].a, one));
        s[i].a = vf_keep(is, vf_mul(s[i].a, scale));
        s[i].w = vf_keep(is, vf_mul(s[i].w, scale));
        for (int c = 0; c < channels; c++)
            s[i].colour[c] = vf_keep(is, vf_mul(s[i].colour[c], scale));
    }
}

HF_INLINE void hex_far_beyond(const struct hf_frame *f, struct hf_rect b, const int channels, const int rows)
{
    const struct hf_buf *made = hf_hexagon_made(f, 0);
    const struct hf_hexagon_field in = hf_hexagon_field(f, HF_FAR);
    struct hex_nearest n;
    hex_nearest(f, &in, b, &n);
    const struct hex_far up = hex_far(f, &in, 0, n.least, b, rows), left = hex_far(f, &in, 1, n.least, b, rows);
    if (n.least == FLT_MAX || (up.run.end == up.run.step && left.run.end == left.run.step)) {
        hex_clear(made + HF_HEXAGON_FAR_U, b, channels);
        hex_clear(made + HF_HEXAGON_FAR_B, b, channels);
        hex_clear(made + HF_HEXAGON_FAR_W, b, 4);
        return;
    }
    HEX_EACH(b, rows, x, y)
    {
        vf p[HEX_ROWS], part[HEX_ROWS], own[HEX_ROWS];
        struct hex_sums u[HEX_ROWS], v[HEX_ROWS];
        for (int i = 0; i < rows; i++) {
            own[i] = vf_load(&n.own[y + i - b.y0][x - b.x0]);
            p[i] = vf_load(&n.p[y + i - b.y0][x - b.x0]);
            part[i] = vf_load(&n.part[y + i - b.y0][x - b.x0]);
        }
        hex_beyond_line(&up, channels, rows, x, y, p, u);
        for (int i = 0; i < rows; i++)
            hex_store_far(made, &u[i], channels, p[i], part[i], u[i].a, HF_HEXAGON_FAR_U, 0, x, y + i);
        hex_beyond_line(&left, channels, rows, x, y, p, v);
        for (int i = 0; i < rows; i++) {
            hex_add(&u[i], &v[i], channels);
            hex_store_far(made, &u[i], channels, p[i], part[i], vf_mul(vf_set1(0.5f), u[i].a), HF_HEXAGON_FAR_B, 2, x,
                          y + i);
        }
        hex_traces(f, rows, x, y, p, own, u);
    }
}

HF_INLINE void hex_far_2(const struct hf_frame *f, struct hf_rect b, const int channels, const int rows)
{
    const struct hf_hexagon_field pixel = hf_hexagon_field(f, HF_FAR);
    const struct hf_hexagon_field in[2] = {hf_hexagon_field_2(f, HF_FAR, 0), hf_hexagon_field_2(f, HF_FAR, 1)};
    const struct hf_buf *out = hf_hexagon_made(f, HF_HEXAGON_FAR);
    const float least = hex_least_far(&pixel, b);
    if (least == FLT_MAX) {
        hex_clear(out, b, channels);
        return;
    }
    const struct hex_far left = hex_far(f, &in[0], 1, least, b, rows), right = hex_far(f, &in[1], 2, least, b, rows);
    HEX_EACH(b, rows, x, y)
    {
        vf p[HEX_ROWS];
        struct hex_sums v[HEX_ROWS], w[HEX_ROWS];
        for (int i = 0; i < rows; i++)
            p[i] = vf_load(hf_at(pixel.radius, pixel.q, x, y + i));
        hex_far_line(&left, channels, 0, rows, x, y, p, v);
        hex_far_line(&right, channels, 0, rows, x, y, p, w);
        for (int i = 0; i < rows; i++)
            for (int c = 0; c < channels; c++)
                vf_store(hf_at(out, c, x, y + i), vf_mul(vf_add(v[i].colour[c], w[i].colour[c]), vf_set1(1 / 3.0f)));
    }
}

// ---- the passes ----

enum { HEX_FIRST, HEX_SECOND, HEX_BEYOND };

HF_INLINE void hex_block(const struct hf_frame *f, struct hf_rect b, const int which, const int channels,
                         const int rows)
{
    if (which == HEX_BEYOND) {
        hex_far_beyond(f, b, channels, rows);
        return;
    }
    if (f->near && which == HEX_SECOND)
        hex_near_2(f, b, channels, rows);
    else if (f->near)
        hex_near_1(f, b, channels, rows);
    if (f->far && which == HEX_SECOND)
        hex_far_2(f, b, channels, rows);
    else if (f->far)
        hex_far_1(f, b, channels, rows);
}

// Whether rows can be computed together.
HF_INLINE int hex_is_shared(const struct hf_hexagon *h)
{
    for (int i = 0; i < 3; i++)
        if (!(HEX_ROWS == 4 ? h->line[i].four : h->line[i].two).count)
            return 0;
    return 1;
}

HF_INLINE void hex_pass(const struct hf_frame *f, struct hf_rect p, const int which, const int channels)
{
    const int shared = hex_is_shared(hf_hexagon(f->s));
    for (int y = p.y0; y < p.y1; y += HEX_HEIGHT)
        for (int x = p.x0; x < p.x1 && !hf_stopped(f->s->stop); x = (x + HEX_WIDTH) & ~(HEX_WIDTH - 1)) {
            const struct hf_rect b = {x, y, hf_min((x + HEX_WIDTH) & ~(HEX_WIDTH - 1), p.x1),
                                      hf_min(y + HEX_HEIGHT, p.y1)};
            if (shared && b.y1 - b.y0 >= HEX_ROWS)
                hex_block(f, b, which, channels, HEX_ROWS);
            else
                hex_block(f, b, which, channels, 1);
        }
}

static void hexagon_1_simd(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_rect p = hf_hexagon_rect(f->s, r);
    HF_WITH_CHANNELS(f->s->channels, hex_pass(f, p, HEX_FIRST, CHANNELS));
}

static void hexagon_2_simd(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_rect p = hf_hexagon_rect(f->s, r);
    HF_WITH_CHANNELS(f->s->channels, hex_pass(f, p, HEX_SECOND, CHANNELS));
}

static void hexagon_beyond_simd(const struct hf_frame *f, struct hf_rect p)
{
    HF_WITH_CHANNELS(f->s->channels, hex_pass(f, p, HEX_BEYOND, CHANNELS));
}

#endif
