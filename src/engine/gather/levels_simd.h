// SPDX-License-Identifier: BSD-3-Clause
// Computation with several kernels for a field, on vectors.
#include "engine/gather/lights_simd.h"
#include "engine/gather/tents_simd.h"

// Zeros in a level's rows that hold nothing, which have not been written. Only tents and columns read such rows.
static void area_clear_unfilled(const struct hf_frame *f, const struct area_rows *rows, struct hf_rect area)
{
    const uint32_t inside = area_groups_in(rows, area.x0, area.x1);
    for (int y = area.y0; y < area.y1; y++)
        if (!rows->level[y - rows->y0].filled)
            area_level_clear(f, rows, y, inside);
}

// A level's planes around r, into its sums.
static void area_convolve_level(const struct hf_frame *f, const struct area_rows *rows, struct hf_rect r,
                                const struct hf_taps *t, int leaves)
{
    struct convolve_job j = {.row = &rows->level[r.y0 - rows->y0], .x0 = r.x0, .clears = 1};
    fixed_column *column = area_column(t);
    if (rows->dirty && (column || t->step > 1))
        area_clear_unfilled(f, rows, area_grown(r, t));
    for (int c = 0; c < f->s->channels; c++)
        convolve_plane(&j, f, r, HF_BUF_LEVEL, c, HF_BUF_LEVEL_SUM, c);
    for (int c = 0; c < 3; c++)
        if (c == 0 || (c == 1 && hf_fields(f->s)->karis) || (c == 2 && leaves))
            convolve_plane(&j, f, r, HF_BUF_LEVEL_WEIGHT, c, HF_BUF_LEVEL_WEIGHT_SUM, c);
    if (t->step > 1)
        area_tents(f, rows, r, t, &j);
    convolve_jobs(f, r, t, column, rows->work, &j, 1, NULL);
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

// What near pixels take from a level of what they hide: 0 where there is no near CoC. Returns what blocks take any.
HF_INLINE uint64_t area_near_row(const struct hf_setup *s, int i, const float *coc, int x0, int n, float *share)
{
    const struct hf_levels *l = hf_gather_behind(s);
    const vf weight = vf_set1(l->level[i].counts);
    uint64_t wanted = 0;
    for (int x = 0; x < n; x += VF_N) {
        const vf v = vf_load(coc + x), square = vf_mul(v, v);
        const vf times = hf_gather(s)->many ? vf_mul(vf_mul(square, square), square) : vf_set1(1);
        const vf part = vf_keep(vf_gt(v, vf_zero()), vf_mul(vf_mul(area_reached(l, i, v), times), weight));
        vf_store(share + x, part);
        if (vm_any(vf_gt(part, vf_zero())))
            wanted |= convolve_blocks(x0 + x, x0 + x + VF_N);
    }
    return wanted;
}

HF_INLINE vf area_weighed(vf colour, const float *weight, vf counts, const int karis)
{
    if (!karis)
        return colour;
    const vf w = vf_load(weight);
    return vf_keep(vf_gt(w, vf_zero()), vf_mul(vf_div(colour, w), counts));
}

// As free_part in computation.c.
HF_INLINE vf area_free_part(vf cover, vf see, vf most)
{
    const vf room = vf_max(vf_sub(vf_set1(1), cover), vf_zero());
    return vf_min(vf_div(room, vf_max(see, vf_set1(FLT_MIN))), most);
}

static void area_finish_row(const struct hf_frame *f, int x0, int n, int y)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_NEAR);
    const vf one = vf_set1(1), wholly = vf_set1(1 / hf_gather(f->s)->once);
    const int karis = hf_fields(f->s)->karis;
    const struct area_sums near = area_near_sums(f, x0, y), behind = area_behind_sums(f, x0, y);
    const float *blur = hf_at(&f->buf[HF_BUF_BLUR], 0, x0, y);
    for (int x = 0; x < n; x += VF_N) {
        const vf m = area_hidden(l, blur + x), cover = vf_load(near.weight[1] + x);
        const vf see = vf_load(behind.weight[1] + x), most = vf_max(cover, one);
        const vf part = area_free_part(cover, see, wholly), all = vf_fma(part, see, cover);
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

// One over what of a level lies in the frame, in row y of r; NULL where that is all. before: that of the row above.
static const float *area_beyond(const struct hf_frame *f, const struct hf_area_kernel *k, struct hf_rect r, int y,
                                const float *before)
{
    float *inside = hf_line(f, 1);
    const int n = r.x1 - r.x0;
    if (y > r.y0 && hf_area_is_whole(f->s, &k->taps, y) && hf_area_is_whole(f->s, &k->taps, y - 1))
        return before;
    if (!hf_area_inside(f->s, k, r.x0, y, n, inside))
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
    const float *beyond = NULL;
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        const struct area_sums sums = area_behind_sums(f, r.x0, y);
        float *share = hf_at(&f->buf[HF_BUF_SUM], 1, r.x0, y), *left = hf_at(&f->buf[HF_BUF_BEHIND_WEIGHT], 2, r.x0, y);
        const float *level = hf_at(&f->buf[HF_BUF_LEVEL_WEIGHT_SUM], 2, r.x0, y);
        beyond = area_beyond(f, &l->level[i].kernel, r, y, beyond);
        for (int x = 0; x < n && beyond; x += VF_N)
            vf_store(share + x, vf_mul(vf_load(share + x), vf_load(beyond + x)));
        area_add_row(f, &sums, share, r.x0, n, y);
        for (int x = 0; x < n && leaves; x += VF_N) {
            const vf part = vf_load(share + x);
            area_sum(left + x, level + x, part, vf_gt(part, vf_zero()));
        }
    }
}

static void area_add_near(const struct hf_frame *f, struct hf_rect r, const struct hf_area_kernel *k)
{
    const float *beyond = NULL;
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        const struct area_sums sums = area_near_sums(f, r.x0, y);
        beyond = area_beyond(f, k, r, y, beyond);
        area_add_row(f, &sums, beyond, r.x0, r.x1 - r.x0, y);
    }
}

// What is near. Levels that nothing is in are left out.
static void area_near_spread(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_NEAR);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        const struct area_sums sums = area_near_sums(f, r.x0, y);
        area_clear_row(f, &sums, r.x1 - r.x0);
    }
    struct area_rows rows = area_rows_of(f, r);
    const struct area_span all = area_coc_rows(f, &rows, area_grown(r, &l->level[0].kernel.taps), AREA_NEAR);
    for (int i = 0; i < l->count && !hf_stopped(f->s->stop); i++) {
        const struct hf_taps *t = &l->level[i].kernel.taps;
        if (!area_is_in(l, AREA_NEAR, i, all))
            continue;
        area_level_planes(f, &rows, area_grown(r, t), AREA_NEAR, i);
        const struct hf_rect to = area_touched(&rows, r, (struct hf_reach){t->rx, t->ry}, 0);
        if (area_is_empty(to))
            continue;
        area_convolve_level(f, &rows, to, t, 0);
        area_add_near(f, to, &l->level[i].kernel);
    }
}

// What pixels of this near CoC hide needs this level, the largest, and those after it.
static int area_first_hidden(const struct hf_levels *l, float most)
{
    int i = 0;
    while (i < l->count && !(most > 0 && hf_level_reached(l, i, most) > 0))
        i++;
    return i;
}

// What near pixels hide, of the levels that any takes from. far: there is something that far levels spread here.
static void area_near_hidden(const struct hf_frame *f, struct hf_rect r, int far)
{
    const struct hf_levels *l = hf_gather_behind(f->s);
    const struct area_rows rows = area_rows_of(f, r);
    const int n = r.x1 - r.x0;
    struct area_range range = area_range_none();
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        const struct area_sums sums = area_behind_sums(f, r.x0, y);
        float *left = hf_at(&f->buf[HF_BUF_BEHIND_WEIGHT], 2, r.x0, y);
        area_clear_row(f, &sums, n);
        for (int x = 0; x < n; x += VF_N)
            vf_store(left + x, vf_zero());
        area_range_row(&range, hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, y), n, AREA_NONE);
    }
    const int first = area_first_hidden(l, area_range_ends(&range).most);
    if (first < l->count && hf_level_limits(f->s, first))
        area_lights(f, r, &l->level[first].kernel.taps);
    for (int i = first; i < l->count && !hf_stopped(f->s->stop); i++) {
        const struct hf_taps *t = &l->level[i].kernel.taps;
        const int leaves = far && area_leaves(f->s, i);
        for (int y = r.y0; y < r.y1; y++)
            rows.level[y - rows.y0].wanted = area_near_row(f->s, i, hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, y), r.x0, n,
                                                           hf_at(&f->buf[HF_BUF_SUM], 1, r.x0, y));
        const struct hf_rect to = area_touched(&rows, r, (struct hf_reach){0, 0}, 1);
        if (area_is_empty(to))
            continue;
        area_behind_planes(f, &rows, area_grown(to, t), i);
        area_convolve_level(f, &rows, to, t, leaves);
        area_add_behind(f, to, i, leaves);
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
static struct area_span area_seen_row(const struct hf_frame *f, int x0, int n, int y, float *seen)
{
    struct area_range range = area_range_none();
    const float *coc = hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR_OF_LIGHT, x0, y);
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
    area_range_row(&range, seen, n, 0);
    return area_range_ends(&range);
}

static void area_far_level_row(const struct hf_frame *f, int i, int x0, int n, int y)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_FAR);
    const struct area_sums all = area_far_sums(f, x0, y);
    const float *weight = all.weight[!hf_fields(f->s)->karis], *coc = hf_at(&f->buf[HF_BUF_SUM], 1, x0, y);
    float *far[4];
    hf_row(&f->buf[HF_BUF_FAR], f->s->channels, x0, y, far);
    const struct area_limits limits = area_limits_of(l, i, HF_FAR_WIDER);
    const vf smallest = vf_set1(l->level[l->count - 1].coc);
    for (int x = 0; x < n; x += VF_N) {
        if (!vm_any(area_within(&limits, vf_max(vf_load(coc + x), smallest))))
            continue;
        const vf share = area_seen(l, i, vf_load(coc + x));
        const vm counts = vf_gt(share, vf_zero());
        if (!vm_any(counts))
            continue;
        const vf divisor = vf_max(vf_load(weight + x), vf_set1(FLT_MIN)), inverse = vf_div(vf_set1(1), divisor);
        for (int c = 0; c < f->s->channels; c++) {
            const vf mean = area_mean(c, vf_load(all.colour[c] + x), divisor, inverse), before = vf_load(far[c] + x);
            vf_store(far[c] + x, vf_select(counts, vf_fma(share, mean, before), before));
        }
    }
}

// Does a pixel with a CoC between these take something from a level?
static int area_is_seen(const struct hf_levels *l, int i, struct area_span coc)
{
    const float smallest = l->level[l->count - 1].coc;
    return hf_level_reached(l, i, (coc.most > smallest ? coc.most : smallest) * HF_FAR_WIDER) > 0 &&
           hf_level_reached(l, i - 1, (coc.least > smallest ? coc.least : smallest) * HF_FAR_WIDER) < 1;
}

// Nothing yet. Returns what the pixels of r see.
static struct area_span area_far_begin(const struct hf_frame *f, const struct area_rows *rows, struct hf_rect r)
{
    const int n = r.x1 - r.x0;
    struct area_span all = {AREA_NONE, 0};
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        const struct area_sums sums = area_far_sums(f, r.x0, y);
        float *far[4];
        area_clear_row(f, &sums, n);
        if (!f->far)
            continue;
        hf_row(&f->buf[HF_BUF_FAR], f->s->channels, r.x0, y, far);
        for (int c = 0; c < f->s->channels; c++)
            memset(far[c], 0, (size_t)n * sizeof(float));
        rows->seen[y - rows->y0] = area_seen_row(f, r.x0, n, y, hf_at(&f->buf[HF_BUF_SUM], 1, r.x0, y));
        area_span_join(&all, rows->seen[y - rows->y0]);
    }
    return all;
}

static void area_far_end(const struct hf_frame *f, struct hf_rect r)
{
    const ptrdiff_t stride = f->buf[HF_BUF_COC4].stride;
    const int n = r.x1 - r.x0;
    for (int y = r.y0; y < r.y1 && f->far && !hf_stopped(f->s->stop); y++) {
        const float *part = hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR, r.x0, y);
        float *far[4];
        hf_row(&f->buf[HF_BUF_FAR], f->s->channels, r.x0, y, far);
        for (int x = 0; x < n; x += VF_N) {
            const vm wanted = area_far_wanted(part + x, stride);
            for (int c = 0; c < f->s->channels; c++)
                vf_store(far[c] + x, vf_keep(wanted, vf_load(far[c] + x)));
        }
        hf_store_rgb(f, far, n);
        area_far_part_row(f, r.x0, n, y);
    }
}

static void area_far_levels(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_FAR);
    struct area_rows rows = area_rows_of(f, r);
    const struct hf_rect around = area_grown(r, &l->level[l->filled].kernel.taps);
    const struct area_span coc = area_coc_rows(f, &rows, around, AREA_FAR);
    const struct area_span seen = area_far_begin(f, &rows, r);
    for (int i = l->count - 1; i >= 0 && !hf_stopped(f->s->stop); i--) {
        const struct hf_taps *t = &l->level[i].kernel.taps;
        if (i >= l->filled && area_is_in(l, AREA_FAR, i, coc)) {
            area_level_planes(f, &rows, area_grown(r, t), AREA_FAR, i);
            const struct hf_rect to = area_touched(&rows, r, (struct hf_reach){t->rx, t->ry}, 0);
            if (!area_is_empty(to))
                area_convolve_level(f, &rows, to, t, 0);
            for (int y = to.y0; y < to.y1 && !area_is_empty(to); y++) {
                const struct area_sums all = area_far_sums(f, to.x0, y);
                area_add_row(f, &all, NULL, to.x0, to.x1 - to.x0, y);
            }
        }
        for (int y = r.y0; y < r.y1 && f->far && area_is_seen(l, i, seen) && !hf_stopped(f->s->stop); y++)
            if (area_is_seen(l, i, rows.seen[y - rows.y0]))
                area_far_level_row(f, i, r.x0, r.x1 - r.x0, y);
    }
    area_far_end(f, r);
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
