// SPDX-License-Identifier: BSD-3-Clause
// Computation with several kernels for a field, on vectors.
#include "engine/gather/computation_simd.h"
#include "engine/gather/lights_simd.h"

HF_INLINE vf area_reached(const struct hf_levels *l, int i, vf coc)
{
    if (i < 0)
        return vf_zero();
    if (i == l->count - 1)
        return vf_set1(1);
    return coc_saturate(vf_mul(vf_sub(coc, vf_set1(l->level[i + 1].coc)), vf_set1(l->level[i].to_next)));
}

HF_INLINE vf area_share(const struct hf_levels *l, int i, vf coc)
{
    return vf_mul(area_reached(l, i, coc), vf_sub(vf_set1(1), area_reached(l, i - 1, coc)));
}

HF_INLINE vf area_of_level(const struct hf_levels *l, int i, vf area)
{
    if (i < 0 || i == l->count - 1)
        return vf_set1(i >= 0);
    return coc_saturate(vf_mul(vf_sub(area, vf_set1(l->level[i + 1].area)), vf_set1(l->level[i].area_to_next)));
}

HF_INLINE vf area_spread(const struct hf_levels *l, int i, vf coc)
{
    const vf own = vf_mul(coc, coc), area = vf_max(own, vf_set1(l->level[l->count - 1].area));
    const vf share = vf_mul(area_of_level(l, i, own), vf_sub(vf_set1(1), area_of_level(l, i - 1, own)));
    return vf_mul(share, vf_div(vf_set1(l->level[i].area), area));
}

HF_INLINE vf area_seen(const struct hf_levels *l, int i, vf coc)
{
    const vf least = vf_set1(l->level[l->count - 1].coc);
    return area_share(l, i, vf_mul(vf_max(coc, least), vf_set1(HF_FAR_WIDER)));
}

HF_INLINE vf area_left(const struct hf_levels *l, int i, const float *far)
{
    const vf times = vf_mul(vf_load(far), vf_set1(l->level[i].half_far)), one = vf_set1(1);
    const vf most = vf_max(vf_mul(times, times), one), fourth = vf_mul(most, most);
    return vf_sub(one, vf_div(one, vf_mul(fourth, fourth)));
}

// Level i of the disoccluded colour leaves strongly blurred far samples to the far levels, in part or wholly
// (hf_level_left). Can there be such a sample?
static int area_leaves(const struct hf_setup *s, int i)
{
    return hf_gather(s)->leaves && hf_gather_behind(s)->level[i].half_far > 1;
}

enum area_kind { AREA_NEAR, AREA_FAR };

// Zeros of a row where it lies beyond the frame.
static void area_clear_beyond(const struct hf_setup *s, float *row, int x0, int x1, int y)
{
    const int beyond = y < 0 || y >= s->half_height;
    for (int x = x0; x < (beyond ? x1 : hf_min(x1, 0)); x++)
        row[x - x0] = 0;
    for (int x = hf_max(x0, s->half_width); x < x1; x++)
        row[x - x0] = 0;
}

// Returns whether there is anything in the row.
HF_INLINE int area_level_row(const struct hf_frame *f, const struct hf_rect area, const int kind, int i, int y)
{
    const struct hf_setup *s = f->s;
    const struct hf_levels *l = hf_gather_levels(s, kind == AREA_FAR ? HF_FAR : HF_NEAR);
    const int x0 = area.x0, karis = hf_fields(s)->karis;
    const float *w = karis ? hf_at(&f->buf[HF_BUF_WEIGHT], 0, x0, y) : NULL;
    float *coc[4], *from[4], *to[4], *weight[4];
    hf_row(&f->buf[HF_BUF_COC4], 4, x0, y, coc);
    hf_row(&f->buf[kind == AREA_NEAR ? HF_BUF_COLORNEAR4 : HF_BUF_COLORFAR4], s->channels, x0, y, from);
    hf_row(&f->buf[HF_BUF_LEVEL], s->channels, x0, y, to);
    hf_row(&f->buf[HF_BUF_LEVEL_WEIGHT], 2, x0, y, weight);
    vm any = vf_gt(vf_zero(), vf_zero());
    for (int x = 0; x < area.x1 - x0; x += VF_N) {
        vf share = kind == AREA_NEAR ? area_share(l, i, vf_load(coc[HF_AREA_NEAR_MOST] + x))
                                     : area_spread(l, i, vf_load(coc[HF_AREA_FAR_MOST] + x));
        const vf part = vf_load(coc[kind == AREA_NEAR ? HF_AREA_NEAR : HF_AREA_FAR] + x);
        if (karis)
            vf_store(weight[1] + x, vf_mul(part, share));
        if (karis)
            share = vf_mul(share, vf_load(w + x));
        for (int c = 0; c < s->channels; c++)
            vf_store(to[c] + x, vf_mul(vf_load(from[c] + x), share));
        const vf counts = vf_mul(part, share);
        vf_store(weight[0] + x, counts);
        any = vm_or(any, vf_gt(counts, vf_zero()));
    }
    return vm_any(any);
}

static int area_level_planes(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, enum area_kind kind,
                             int i)
{
    const struct hf_rect area = {r.x0 - t->rx, r.y0 - t->ry, r.x1 + t->rx, r.y1 + t->ry};
    int any = 0;
    for (int y = area.y0; y < area.y1 && !hf_stopped(f->s->stop); y++)
        any |= kind == AREA_NEAR ? area_level_row(f, area, AREA_NEAR, i, y) : area_level_row(f, area, AREA_FAR, i, y);
    return any;
}

// The least and the largest CoC of some pixels.
struct area_range {
    vf least, most;
};

static const float AREA_NONE = 2;  // more than any CoC

HF_INLINE struct area_range area_range_none(void)
{
    return (struct area_range){vf_set1(AREA_NONE), vf_zero()};
}

// zero: what a CoC of 0 counts as.
HF_INLINE void area_range_row(struct area_range *range, const float *coc, int n, const float zero)
{
    for (int x = 0; x < n; x += VF_N) {
        const vf v = vf_load(coc + x);
        range->most = vf_max(v, range->most);
        range->least = vf_min(vf_select(vf_gt(v, vf_zero()), v, vf_set1(zero)), range->least);
    }
}

// Both ends, of all lanes.
static void area_range_ends(const struct area_range *range, float *least, float *most)
{
    float a[VF_N], b[VF_N];
    vf_store(a, range->least);
    vf_store(b, range->most);
    *least = a[0];
    *most = b[0];
    for (int i = 1; i < VF_N; i++) {
        *least = a[i] < *least ? a[i] : *least;
        *most = b[i] > *most ? b[i] : *most;
    }
}

// Of a channel of the half-resolution CoC, wherever taps reach, of samples that are in other levels than the last.
static void area_range_around(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, int channel,
                              float *least, float *most)
{
    struct area_range range = area_range_none();
    for (int y = r.y0 - t->ry; y < r.y1 + t->ry && !hf_stopped(f->s->stop); y++)
        area_range_row(&range, hf_at(&f->buf[HF_BUF_COC4], channel, r.x0 - t->rx, y), r.x1 - r.x0 + 2 * t->rx,
                       AREA_NONE);
    area_range_ends(&range, least, most);
}

// What is not near, less what of far samples is left to the far levels.
HF_INLINE void area_behind_row(const struct hf_frame *f, const struct hf_rect area, int i, int y, const int karis,
                               const int leaves)
{
    const struct hf_setup *s = f->s;
    const struct hf_levels *l = hf_gather_behind(s);
    const int x0 = area.x0;
    const float *w = karis ? hf_at(&f->buf[HF_BUF_WEIGHT], 0, x0, y) : NULL;
    const float *lights = hf_level_limits(s, i) ? hf_at(&f->buf[HF_BUF_WEIGHT], 2, x0, y) : NULL;
    float *coc[4], *colour[4], *near[4], *far[4], *to[4], *weight[4];
    hf_row(&f->buf[HF_BUF_COC4], 4, x0, y, coc);
    hf_row(&f->buf[HF_BUF_COLOR4], s->channels, x0, y, colour);
    hf_row(&f->buf[HF_BUF_COLORNEAR4], s->channels, x0, y, near);
    hf_row(&f->buf[HF_BUF_COLORFAR4], s->channels, x0, y, far);
    hf_row(&f->buf[HF_BUF_LEVEL], s->channels, x0, y, to);
    hf_row(&f->buf[HF_BUF_LEVEL_WEIGHT], 3, x0, y, weight);
    for (int x = 0; x < area.x1 - x0; x += VF_N) {
        vf rest = vf_sub(vf_set1(1), vf_load(coc[HF_AREA_NEAR] + x)), left = vf_zero();
        if (leaves) {
            left = area_left(l, i, coc[HF_AREA_FAR_MOST] + x);
            const vf hidden = vf_mul(left, vf_load(coc[HF_AREA_FAR] + x));
            rest = vf_sub(rest, hidden);
            vf_store(weight[2] + x, hidden);
        }
        const vm counts = vf_gt(rest, vf_zero());
        for (int c = 0; c < s->channels; c++) {
            vf v = vf_sub(vf_load(colour[c] + x), vf_load(near[c] + x));
            if (leaves)
                v = vf_sub(v, vf_mul(left, vf_load(far[c] + x)));
            if (lights)
                v = vf_mul(v, vf_load(lights + x));
            vf_store(to[c] + x, vf_keep(counts, karis ? vf_mul(v, vf_load(w + x)) : v));
        }
        vf_store(weight[karis] + x, vf_keep(counts, rest));
        if (karis)
            vf_store(weight[0] + x, vf_keep(counts, vf_mul(rest, vf_load(w + x))));
    }
    for (int k = 0; k < 1 + karis; k++)
        area_clear_beyond(s, weight[k], x0, area.x1, y);
}

static void area_behind_planes(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, int i)
{
    const struct hf_rect area = {r.x0 - t->rx, r.y0 - t->ry, r.x1 + t->rx, r.y1 + t->ry};
    const int karis = hf_fields(f->s)->karis, leaves = area_leaves(f->s, i);
    for (int y = area.y0; y < area.y1 && !hf_stopped(f->s->stop); y++)
        if (karis)
            area_behind_row(f, area, i, y, 1, leaves);
        else if (leaves)
            area_behind_row(f, area, i, y, 0, 1);
        else
            area_behind_row(f, area, i, y, 0, 0);
}

// Convolved where a channel of a buffer says that there is need, within reach.
static void area_convolve_level(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, int need,
                                int channel, struct hf_reach reach, int leaves)
{
    struct convolve_job j = {.reach = reach, .clears = 1};
    for (int c = 0; c < f->s->channels; c++)
        convolve_plane(&j, f, r, HF_BUF_LEVEL, c, HF_BUF_LEVEL_SUM, c);
    for (int c = 0; c < 1 + hf_fields(f->s)->karis; c++)
        convolve_plane(&j, f, r, HF_BUF_LEVEL_WEIGHT, c, HF_BUF_LEVEL_WEIGHT_SUM, c);
    if (leaves)
        convolve_plane(&j, f, r, HF_BUF_LEVEL_WEIGHT, 2, HF_BUF_LEVEL_WEIGHT_SUM, 2);
    job_needs(&j, f, r, need, channel);
    area_convolve(f, r, t, &j, 1, NULL);
}

// Rows of a field's sums: colour, its weight, and the weight without Karis'; without Karis average they are one, the last.
struct area_sums {
    float *colour[4], *weight[2];
};

static struct area_sums area_near_sums(const struct hf_frame *f, int x, int y)
{
    struct area_sums s = {.weight = {hf_at(&f->buf[HF_BUF_SUM], 0, x, y), hf_at(&f->buf[HF_BUF_COVER], 0, x, y)}};
    hf_row(&f->buf[HF_BUF_NEAR], f->s->channels, x, y, s.colour);
    return s;
}

static struct area_sums area_sums_in(const struct hf_frame *f, int colour, int weight, int x, int y)
{
    const struct hf_buf *b = &f->buf[weight];
    struct area_sums s = {.weight = {hf_at(b, 0, x, y), hf_at(b, 1, x, y)}};
    hf_row(&f->buf[colour], f->s->channels, x, y, s.colour);
    return s;
}

static struct area_sums area_behind_sums(const struct hf_frame *f, int x, int y)
{
    return area_sums_in(f, HF_BUF_BEHIND, HF_BUF_BEHIND_WEIGHT, x, y);
}

static struct area_sums area_far_sums(const struct hf_frame *f, int x, int y)
{
    return area_sums_in(f, HF_BUF_SPREAD, HF_BUF_SPREAD_WEIGHT, x, y);
}

HF_INLINE void area_sum(float *to, const float *level, vf share, vm counts)
{
    const vf sum = vf_load(to);
    vf_store(to, vf_select(counts, vf_fma(share, vf_load(level), sum), sum));
}

static void area_clear_row(const struct hf_frame *f, const struct area_sums *s, int n)
{
    for (int x = 0; x < n; x += VF_N) {
        for (int c = 0; c < f->s->channels; c++)
            vf_store(s->colour[c] + x, vf_zero());
        for (int k = !hf_fields(f->s)->karis; k < 2; k++)
            vf_store(s->weight[k] + x, vf_zero());
    }
}

// Add share (1 where it is NULL) of a level's row to the sums.
static void area_add_row(const struct hf_frame *f, const struct area_sums *to, const float *share, int x0, int n, int y)
{
    const int karis = hf_fields(f->s)->karis;
    float *colour[4], *weight[4];
    hf_row(&f->buf[HF_BUF_LEVEL_SUM], f->s->channels, x0, y, colour);
    hf_row(&f->buf[HF_BUF_LEVEL_WEIGHT_SUM], 2, x0, y, weight);
    for (int x = 0; x < n; x += VF_N) {
        const vf part = share ? vf_load(share + x) : vf_set1(1);
        const vm counts = vm_and(vf_gt(part, vf_zero()), vf_gt(vf_load(weight[karis] + x), vf_zero()));
        if (!vm_any(counts))
            continue;
        for (int c = 0; c < f->s->channels; c++)
            area_sum(to->colour[c] + x, colour[c] + x, part, counts);
        area_sum(to->weight[1] + x, weight[karis] + x, part, counts);
        if (karis)
            area_sum(to->weight[0] + x, weight[0] + x, part, counts);
    }
}

// What near pixels take from a level of what they hide: 0 where there is no near CoC. Returns whether any does.
HF_INLINE int area_near_row(const struct hf_levels *l, int i, const float *coc, int n, float *share)
{
    const vf weight = vf_set1(l->level[i].counts);
    vm any = vf_gt(vf_zero(), vf_zero());
    for (int x = 0; x < n; x += VF_N) {
        const vf v = vf_load(coc + x), part = vf_keep(vf_gt(v, vf_zero()), vf_mul(area_reached(l, i, v), weight));
        vf_store(share + x, part);
        any = vm_or(any, vf_gt(part, vf_zero()));
    }
    return vm_any(any);
}

HF_INLINE vf area_weighed(vf colour, const float *weight, vf counts, const int karis)
{
    if (!karis)
        return colour;
    const vf w = vf_load(weight);
    return vf_keep(vf_gt(w, vf_zero()), vf_mul(vf_div(colour, w), counts));
}

// As free_part in computation.c.
HF_INLINE vf area_free_part(vf cover, vf see)
{
    const vf one = vf_set1(1), room = vf_max(vf_sub(one, cover), vf_zero());
    return vf_min(vf_div(room, vf_max(see, vf_set1(FLT_MIN))), one);
}

static void area_finish_row(const struct hf_frame *f, int x0, int n, int y)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_NEAR);
    const vf one = vf_set1(1);
    const int karis = hf_fields(f->s)->karis;
    const struct area_sums near = area_near_sums(f, x0, y), behind = area_behind_sums(f, x0, y);
    const float *blur = hf_at(&f->buf[HF_BUF_BLUR], 0, x0, y);
    for (int x = 0; x < n; x += VF_N) {
        const vf m = area_hidden(l, blur + x), cover = vf_load(near.weight[1] + x);
        const vf see = vf_load(behind.weight[1] + x), most = vf_max(cover, one);
        const vf part = area_free_part(cover, see), all = vf_fma(part, see, cover);
        const vm hides = vm_and(vf_gt(m, vf_zero()), vf_gt(all, vf_zero()));
        for (int c = 0; c < f->s->channels; c++) {
            const vf own = area_weighed(vf_load(near.colour[c] + x), near.weight[0] + x, cover, karis);
            const vf back = area_weighed(vf_load(behind.colour[c] + x), behind.weight[0] + x, see, karis);
            const vf outside = vf_div(own, most);
            const vf both = vf_fma(m, vf_sub(vf_div(vf_fma(part, back, own), all), outside), outside);
            vf_store(near.colour[c] + x, vf_select(hides, both, outside));
        }
        const vf outside = vf_div(cover, most);
        vf_store(near.weight[1] + x, vf_select(hides, vf_fma(m, vf_sub(one, outside), outside), outside));
    }
}

// As add_far in computation.c.
static void area_add_far_row(const struct hf_frame *f, int x0, int n, int y)
{
    const struct area_sums to = area_behind_sums(f, x0, y), far = area_far_sums(f, x0, y);
    const float *left = hf_at(&f->buf[HF_BUF_BEHIND_WEIGHT], 2, x0, y);
    for (int x = 0; x < n; x += VF_N) {
        const vf seen = vf_load(far.weight[1] + x), part = vf_div(vf_load(left + x), vf_max(seen, vf_set1(1)));
        const vm counts = vm_and(vf_gt(seen, vf_zero()), vf_gt(part, vf_zero()));
        if (!vm_any(counts))
            continue;
        for (int c = 0; c < f->s->channels; c++)
            area_sum(to.colour[c] + x, far.colour[c] + x, part, counts);
        for (int k = !hf_fields(f->s)->karis; k < 2; k++)
            area_sum(to.weight[k] + x, far.weight[k] + x, part, counts);
    }
}

// One over what of a level lies in the frame; NULL where that is all.
static const float *area_beyond(const struct hf_frame *f, const struct hf_area_kernel *k, int x0, int n, int y)
{
    float *inside = hf_line(f, 1);
    if (!hf_area_inside(f->s, k, x0, y, n, inside))
        return NULL;
    for (int x = 0; x < n; x += VF_N)
        vf_store(inside + x, vf_div(vf_set1(1), vf_load(inside + x)));
    return inside;
}

// leaves: the level leaves something to the far levels.
static void area_add_behind(const struct hf_frame *f, struct hf_rect r, int i, int leaves)
{
    const struct hf_levels *l = hf_gather_behind(f->s);
    const int n = r.x1 - r.x0;
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        const struct area_sums sums = area_behind_sums(f, r.x0, y);
        float *share = hf_at(&f->buf[HF_BUF_SUM], 1, r.x0, y), *left = hf_at(&f->buf[HF_BUF_BEHIND_WEIGHT], 2, r.x0, y);
        const float *level = hf_at(&f->buf[HF_BUF_LEVEL_WEIGHT_SUM], 2, r.x0, y);
        const float *beyond = area_beyond(f, &l->level[i].kernel, r.x0, n, y);
        for (int x = 0; x < n && beyond; x += VF_N)
            vf_store(share + x, vf_mul(vf_load(share + x), vf_load(beyond + x)));
        area_add_row(f, &sums, share, r.x0, n, y);
        for (int x = 0; x < n && leaves; x += VF_N) {
            const vf part = vf_load(share + x);
            area_sum(left + x, level + x, part, vf_gt(part, vf_zero()));
        }
    }
}

// What is near. Levels that nothing is in are left out.
static void area_near_spread(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_NEAR);
    const int n = r.x1 - r.x0;
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        const struct area_sums sums = area_near_sums(f, r.x0, y);
        area_clear_row(f, &sums, n);
    }
    float least, most;
    area_range_around(f, r, &l->level[0].kernel.taps, HF_AREA_NEAR_MOST, &least, &most);
    for (int i = 0; i < l->count && !hf_stopped(f->s->stop); i++) {
        const struct hf_taps *t = &l->level[i].kernel.taps;
        const int in = i == l->count - 1 || (hf_level_reached(l, i, most) > 0 && hf_level_reached(l, i - 1, least) < 1);
        if (!in || !area_level_planes(f, r, t, AREA_NEAR, i))
            continue;
        area_convolve_level(f, r, t, HF_BUF_LEVEL_WEIGHT, 0, (struct hf_reach){t->rx, t->ry}, 0);
        for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
            const struct area_sums sums = area_near_sums(f, r.x0, y);
            area_add_row(f, &sums, area_beyond(f, &l->level[i].kernel, r.x0, n, y), r.x0, n, y);
        }
    }
}

// What near pixels hide, of the levels that any takes from. far: there is something that far levels spread here.
static void area_near_hidden(const struct hf_frame *f, struct hf_rect r, int far)
{
    const struct hf_levels *l = hf_gather_behind(f->s);
    const int n = r.x1 - r.x0;
    if (hf_gather(f->s)->lights)
        area_lights(f, r);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        const struct area_sums sums = area_behind_sums(f, r.x0, y);
        float *left = hf_at(&f->buf[HF_BUF_BEHIND_WEIGHT], 2, r.x0, y);
        area_clear_row(f, &sums, n);
        for (int x = 0; x < n; x += VF_N)
            vf_store(left + x, vf_zero());
    }
    for (int i = 0; i < l->count && !hf_stopped(f->s->stop); i++) {
        const struct hf_taps *t = &l->level[i].kernel.taps;
        const int leaves = far && area_leaves(f->s, i);
        int any = 0;
        for (int y = r.y0; y < r.y1; y++)
            any |=
                area_near_row(l, i, hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, y), n, hf_at(&f->buf[HF_BUF_SUM], 1, r.x0, y));
        if (!any)
            continue;
        area_behind_planes(f, r, t, i);
        area_convolve_level(f, r, t, HF_BUF_SUM, 1, (struct hf_reach){0, 0}, leaves);
        area_add_behind(f, r, i, leaves);
    }
}

static void area_near_levels(const struct hf_frame *f, struct hf_rect r, int far)
{
    area_near_spread(f, r);
    area_near_hidden(f, r, far);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        if (far)
            area_add_far_row(f, r.x0, r.x1 - r.x0, y);
        area_finish_row(f, r.x0, r.x1 - r.x0, y);
        area_store_near(f, y, r);
    }
}

// CoC as pixels see the far field: what is not far itself, beside what is, sees what that does.
static void area_seen_row(const struct hf_frame *f, int x0, int n, int y, float *seen, struct area_range *range)
{
    const float *coc = hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR_MOST, x0, y);
    const float *part = hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR, x0, y);
    const ptrdiff_t stride = f->buf[HF_BUF_COC4].stride;
    for (int x = 0; x < n; x += VF_N) {
        const vf own = vf_load(coc + x), rest = vf_sub(vf_set1(1), vf_load(part + x));
        vf most = own;
        if (vm_any(vf_ne(rest, vf_zero())))
            for (int i = 0; i < 9; i++)
                most = vf_max(vf_load(coc + x + (i / 3 - 1) * stride + i % 3 - 1), most);
        vf_store(seen + x, vf_max(vf_mul(rest, most), own));
    }
    area_range_row(range, seen, n, 0);
}

static void area_far_level_row(const struct hf_frame *f, int i, int x0, int n, int y)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_FAR);
    const struct area_sums all = area_far_sums(f, x0, y);
    const float *part = hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR, x0, y), *weight = all.weight[!hf_fields(f->s)->karis];
    const float *coc = hf_at(&f->buf[HF_BUF_SUM], 1, x0, y);
    float *far[4];
    hf_row(&f->buf[HF_BUF_FAR], f->s->channels, x0, y, far);
    for (int x = 0; x < n; x += VF_N) {
        const vf share = area_seen(l, i, vf_load(coc + x));
        const vm counts = vf_gt(share, vf_zero());
        const vm wanted = i == 0 ? area_far_wanted(part + x, f->buf[HF_BUF_COC4].stride) : vf_eq(share, share);
        if (i > 0 && i < l->count - 1 && !vm_any(counts))
            continue;
        const vf divisor = vf_max(vf_load(weight + x), vf_set1(FLT_MIN)), inverse = vf_div(vf_set1(1), divisor);
        for (int c = 0; c < f->s->channels; c++) {
            const vf mean = area_mean(c, vf_load(all.colour[c] + x), divisor, inverse);
            const vf before = i < l->count - 1 ? vf_load(far[c] + x) : vf_zero();
            vf_store(far[c] + x, vf_keep(wanted, vf_select(counts, vf_fma(share, mean, before), before)));
        }
    }
}

// Does a pixel with a CoC between these take something from a level?
static int area_is_seen(const struct hf_levels *l, int i, float least, float most)
{
    const float smallest = l->level[l->count - 1].coc;
    return hf_level_reached(l, i, (most > smallest ? most : smallest) * HF_FAR_WIDER) > 0 &&
           hf_level_reached(l, i - 1, (least > smallest ? least : smallest) * HF_FAR_WIDER) < 1;
}

static void area_far_levels(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_FAR);
    const int n = r.x1 - r.x0, last = l->count - 1;
    struct area_range range = area_range_none();
    float least, most, seen_least, seen_most;
    area_range_around(f, r, &l->level[l->filled].kernel.taps, HF_AREA_FAR_MOST, &least, &most);
    for (int y = r.y0; y < r.y1 && f->far && !hf_stopped(f->s->stop); y++)
        area_seen_row(f, r.x0, n, y, hf_at(&f->buf[HF_BUF_SUM], 1, r.x0, y), &range);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        const struct area_sums all = area_far_sums(f, r.x0, y);
        area_clear_row(f, &all, n);
    }
    area_range_ends(&range, &seen_least, &seen_most);
    for (int i = last; i >= 0 && !hf_stopped(f->s->stop); i--) {
        const struct hf_taps *t = &l->level[i].kernel.taps;
        const int in =
            i == last || (hf_level_area(l, i, most * most) > 0 && hf_level_area(l, i - 1, least * least) < 1);
        const int any = i >= l->filled && in && area_level_planes(f, r, t, AREA_FAR, i);
        const int seen = f->far && (i == 0 || i == last || area_is_seen(l, i, seen_least, seen_most));
        if (any)
            area_convolve_level(f, r, t, HF_BUF_LEVEL_WEIGHT, 0, (struct hf_reach){t->rx, t->ry}, 0);
        for (int y = r.y0; y < r.y1 && (any || seen) && !hf_stopped(f->s->stop); y++) {
            const struct area_sums all = area_far_sums(f, r.x0, y);
            if (any)
                area_add_row(f, &all, NULL, r.x0, n, y);
            if (seen)
                area_far_level_row(f, i, r.x0, n, y);
        }
    }
    for (int y = r.y0; y < r.y1 && f->far && !hf_stopped(f->s->stop); y++) {
        float *far[4];
        hf_row(&f->buf[HF_BUF_FAR], f->s->channels, r.x0, y, far);
        hf_store_rgb(f, far, n);
        area_far_part_row(f, r.x0, n, y);
    }
}

// Does anything far reach a rectangle?
static int area_far_reaches(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_FAR);
    const struct hf_taps *t = &l->level[l->filled].kernel.taps;
    vm any = vf_gt(vf_zero(), vf_zero());
    for (int y = r.y0 - t->ry; y < r.y1 + t->ry && !vm_any(any) && !hf_stopped(f->s->stop); y++) {
        const float *far = hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR, r.x0 - t->rx, y);
        for (int x = 0; x < r.x1 - r.x0 + 2 * t->rx; x += VF_N)
            any = vm_or(any, vf_gt(vf_load(far + x), vf_zero()));
    }
    return vm_any(any);
}

static void computation_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int simple = hf_gather_is_simple(f->s);
    const int far = !simple && (f->far || (f->near && hf_gather(f->s)->leaves && area_far_reaches(f, r)));
    if (hf_fields(f->s)->karis)
        area_weigh(f, r);
    if (far)
        area_far_levels(f, r);
    else if (f->far)
        area_far_simple(f, r);
    if (f->near && simple)
        area_near_simple(f, r);
    else if (f->near)
        area_near_levels(f, r, far);
}
