// SPDX-License-Identifier: BSD-3-Clause
// Computation with several kernels for a field, on vectors: what the kernels are laid over.
#include "base/bits.h"
#include "engine/gather/computation_simd.h"

HF_INLINE vf area_reached(const struct hf_levels *l, int i, vf coc)
{
    if (i < 0)
        return vf_zero();
    if (i == l->count - 1)
        return vf_set1(1);
    return vf_saturate(vf_mul(vf_sub(coc, vf_set1(l->level[i + 1].coc)), vf_set1(l->level[i].to_next)));
}

HF_INLINE vf area_share(const struct hf_levels *l, int i, vf coc)
{
    return vf_mul(area_reached(l, i, coc), vf_sub(vf_set1(1), area_reached(l, i - 1, coc)));
}

HF_INLINE vf area_of_level(const struct hf_levels *l, int i, vf area)
{
    if (i < 0 || i == l->count - 1)
        return vf_set1(i >= 0);
    return vf_saturate(vf_mul(vf_sub(area, vf_set1(l->level[i + 1].area)), vf_set1(l->level[i].area_to_next)));
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

struct area_span {
    float least, most;
};

// Both ends, of all lanes.
static struct area_span area_range_ends(const struct area_range *range)
{
    float a[VF_N], b[VF_N];
    vf_store(a, range->least);
    vf_store(b, range->most);
    struct area_span s = {a[0], b[0]};
    for (int i = 1; i < VF_N; i++) {
        s.least = a[i] < s.least ? a[i] : s.least;
        s.most = b[i] > s.most ? b[i] : s.most;
    }
    return s;
}

static void area_span_join(struct area_span *all, struct area_span s)
{
    all->least = s.least < all->least ? s.least : all->least;
    all->most = s.most > all->most ? s.most : all->most;
}

// Of a row, by level: which groups of columns can have a sample of it, bits from the first group on.
struct area_groups {
    uint32_t level[HF_MAX_LEVELS];
};
enum { AREA_GROUPS = 32, AREA_GROUP = 16 };

// Columns x0 to x1 - 1.
struct area_columns {
    int x0, x1;
};

// What is known of rows, wherever taps reach: most samples are in two levels of many, so most levels hold little.
struct area_rows {
    int y0;                      // row of the first
    struct convolve_row *level;  // of the level at hand
    struct area_span *seen;      // of what its pixels see
    struct area_groups *groups;  // of the field's samples
    int x0, wide;                // where the first group begins, and a group's columns
    int n;                       // columns of all groups
    uint32_t *dirty;  // groups where a level's planes may be something else than 0. NULL: they are all written anyway
    float *work;      // what follows is free
};

static struct area_rows area_rows_of(const struct hf_frame *f, struct hf_rect r)
{
    const int reach = hf_gather_halo(f->s, HF_HALO_TAPS).y, n = r.y1 - r.y0 + 2 * reach;
    _Static_assert(sizeof(struct convolve_row) + sizeof(struct area_span) + sizeof(uint32_t) +
                           sizeof(struct area_groups) <=
                       HF_ROW_FLOATS * sizeof(float),
                   "a row");
    struct area_rows rows = {.y0 = r.y0 - reach, .level = (struct convolve_row *)f->work};
    rows.seen = (struct area_span *)(rows.level + n);
    rows.groups = (struct area_groups *)(rows.seen + n);
    rows.work = f->work + HF_ROW_FLOATS * ((n + 1) & ~1);
    return rows;
}

// Can a sample with a CoC between these be in a level?
HF_INLINE int area_is_in(const struct hf_levels *l, const int kind, int i, struct area_span coc)
{
    if (!(coc.most > 0))
        return 0;
    if (kind == AREA_NEAR)
        return hf_level_reached(l, i, coc.most) > 0 && hf_level_reached(l, i - 1, coc.least) < 1;
    return hf_level_area(l, i, coc.most * coc.most) > 0 && hf_level_area(l, i - 1, coc.least * coc.least) < 1;
}

// CoC that can have a share of a level: above `least` and below `most`. Most vectors of a row have none, and comparing their CoC
// is less than finding that out from shares. A little wide, because shares are rounded.
struct area_limits {
    vf least, most;
};

// times: by what CoC are multiplied before.
HF_INLINE float area_limit_least(const struct hf_levels *l, int i, float times)
{
    return i + 1 < l->count ? l->level[i + 1].coc / times * (1 - 4 * FLT_EPSILON) : 0;
}

HF_INLINE float area_limit_most(const struct hf_levels *l, int i, float times)
{
    return i > 0 ? l->level[i - 1].coc / times * (1 + 4 * FLT_EPSILON) : FLT_MAX;
}

HF_INLINE struct area_limits area_limits_of(const struct hf_levels *l, int i, float times)
{
    return (struct area_limits){vf_set1(area_limit_least(l, i, times)), vf_set1(area_limit_most(l, i, times))};
}

HF_INLINE vm area_within(const struct area_limits *a, vf coc)
{
    return vm_and(vf_gt(coc, a->least), vf_lt(coc, a->most));
}

// Move to the levels that CoC between these can have a share of: from the first, the largest, to the last.
HF_INLINE void area_levels_move(const struct hf_levels *l, struct area_span coc, int *first, int *last)
{
    while (*first > 0 && coc.most > area_limit_least(l, *first - 1, 1))
        (*first)--;
    while (*first + 1 < l->count && !(coc.most > area_limit_least(l, *first, 1)))
        (*first)++;
    while (*last + 1 < l->count && coc.least < area_limit_most(l, *last + 1, 1))
        (*last)++;
    while (*last > 0 && !(coc.least < area_limit_most(l, *last, 1)))
        (*last)--;
}

// Which groups of a field's samples are in which level. Returns the CoC of all. The area of a level may not be larger than this.
static struct area_span area_coc_rows(const struct hf_frame *f, struct area_rows *rows, struct hf_rect area,
                                      enum area_kind kind)
{
    const struct hf_levels *l = hf_gather_levels(f->s, kind == AREA_FAR ? HF_FAR : HF_NEAR);
    const int channel = kind == AREA_NEAR ? HF_AREA_NEAR_MOST : HF_AREA_FAR_OF_LIGHT, n = area.x1 - area.x0;
    struct area_span all = {AREA_NONE, 0};
    const int height = area.y1 - rows->y0;
    int first = 0, last = 0;
    rows->x0 = area.x0;
    rows->n = n;
    rows->wide = AREA_GROUP;
    rows->dirty = (uint32_t *)(rows->groups + height);
    memset(rows->dirty, 0xff, (size_t)height * sizeof *rows->dirty);
    while (n > AREA_GROUPS * rows->wide)
        rows->wide *= 2;
    for (int y = area.y0; y < area.y1 && !hf_stopped(f->s->stop); y++) {
        const float *coc = hf_at(&f->buf[HF_BUF_COC4], channel, area.x0, y);
        uint32_t *level = rows->groups[y - rows->y0].level;
        memset(level, 0, (size_t)l->count * sizeof *level);
        for (int x = 0, g = 0; x < n; x += rows->wide, g++) {
            struct area_range range = area_range_none();
            area_range_row(&range, coc + x, hf_min(rows->wide, n - x), AREA_NONE);
            if (!vm_any(vf_gt(range.most, vf_zero())))
                continue;
            const struct area_span own = area_range_ends(&range);
            area_span_join(&all, own);
            area_levels_move(l, own, &first, &last);
            for (int i = first; i <= last; i++)
                level[i] |= (uint32_t)1 << g;
        }
    }
    return all;
}

// The groups that have columns x0 to x1 - 1.
HF_INLINE uint32_t area_groups_in(const struct area_rows *rows, int x0, int x1)
{
    const int first = (x0 - rows->x0) / rows->wide, last = (x1 - 1 - rows->x0) / rows->wide;
    return ~(uint32_t)0 >> (AREA_GROUPS - 1 - last) & ~(uint32_t)0 << first;
}

// The columns of the next run of groups, which are then left out; from the first group's on.
HF_INLINE struct area_columns area_groups_next(const struct area_rows *rows, uint64_t *groups)
{
    const struct hf_bit_run run = hf_next_bits(groups);
    return (struct area_columns){rows->wide * run.x0, hf_min(rows->wide * run.x1, rows->n)};
}

// Zeros in groups of a row of a level's planes, where they are not 0 yet.
static void area_level_clear(const struct hf_frame *f, const struct area_rows *rows, int y, uint32_t groups)
{
    uint32_t *dirty = &rows->dirty[y - rows->y0];
    uint64_t left = groups & *dirty;
    *dirty &= ~groups;
    while (left) {
        const struct area_columns run = area_groups_next(rows, &left);
        for (int i = 0; i < f->s->channels + 1 + hf_fields(f->s)->karis; i++) {
            const int c = i - f->s->channels;
            float *plane = c < 0 ? hf_at(&f->buf[HF_BUF_LEVEL], i, rows->x0, y)
                                 : hf_at(&f->buf[HF_BUF_LEVEL_WEIGHT], c, rows->x0, y);
            for (int x = run.x0; x < run.x1; x += VF_N)
                vf_store(plane + x, vf_zero());
        }
    }
}

// One row of a level's planes, in groups that can have samples of it. Returns which blocks of it hold something.
HF_INLINE uint64_t area_level_row(const struct hf_frame *f, const struct area_rows *rows, const int kind, int i, int y,
                                  uint32_t groups)
{
    const struct hf_setup *s = f->s;
    const struct hf_levels *l = hf_gather_levels(s, kind == AREA_FAR ? HF_FAR : HF_NEAR);
    const int x0 = rows->x0, karis = hf_fields(s)->karis;
    const float *w = karis ? hf_at(&f->buf[HF_BUF_WEIGHT], 0, x0, y) : NULL;
    float *coc[4], *from[4], *to[4], *weight[4];
    hf_row(&f->buf[HF_BUF_COC4], 4, x0, y, coc);
    hf_row(&f->buf[kind == AREA_NEAR ? HF_BUF_COLORNEAR4 : HF_BUF_COLORFAR4], s->channels, x0, y, from);
    hf_row(&f->buf[HF_BUF_LEVEL], s->channels, x0, y, to);
    hf_row(&f->buf[HF_BUF_LEVEL_WEIGHT], 2, x0, y, weight);
    const struct area_limits limits = area_limits_of(l, i, 1);
    uint64_t filled = 0;
    uint64_t left = groups;
    rows->dirty[y - rows->y0] |= groups;
    while (left) {
        const struct area_columns run = area_groups_next(rows, &left);
        for (int x = run.x0; x < run.x1; x += VF_N) {
            const vf most = vf_load(coc[kind == AREA_NEAR ? HF_AREA_NEAR_MOST : HF_AREA_FAR_OF_LIGHT] + x);
            if (!vm_any(area_within(&limits, most))) {
                for (int c = 0; c < s->channels; c++)
                    vf_store(to[c] + x, vf_zero());
                vf_store(weight[0] + x, vf_zero());
                if (karis)
                    vf_store(weight[1] + x, vf_zero());
                continue;
            }
            filled |= convolve_blocks(x0 + x, x0 + x + VF_N);
            vf share = kind == AREA_NEAR ? area_share(l, i, most) : area_spread(l, i, most);
            const vf part = vf_load(coc[kind == AREA_NEAR ? HF_AREA_NEAR : HF_AREA_FAR] + x);
            if (karis) {
                vf_store(weight[1] + x, vf_mul(part, share));
                share = vf_mul(share, vf_load(w + x));
            }
            for (int c = 0; c < s->channels; c++)
                vf_store(to[c] + x, vf_mul(vf_load(from[c] + x), share));
            vf_store(weight[0] + x, vf_mul(part, share));
        }
    }
    return filled;
}

static struct hf_rect area_grown(struct hf_rect r, const struct hf_taps *t)
{
    return (struct hf_rect){r.x0 - t->rx, r.y0 - t->ry, r.x1 + t->rx, r.y1 + t->ry};
}

static void area_level_planes(const struct hf_frame *f, const struct area_rows *rows, struct hf_rect area,
                              enum area_kind kind, int i)
{
    const uint32_t inside = area_groups_in(rows, area.x0, area.x1);
    for (int y = area.y0; y < area.y1 && !hf_stopped(f->s->stop); y++) {
        const uint32_t groups = rows->groups[y - rows->y0].level[i] & inside;
        struct convolve_row *row = &rows->level[y - rows->y0];
        row->wanted = ~(uint64_t)0;
        row->filled = 0;
        if (!groups)
            continue;
        area_level_clear(f, rows, y, inside & ~groups);
        if (kind == AREA_NEAR)
            row->filled = area_level_row(f, rows, AREA_NEAR, i, y, groups);
        else
            row->filled = area_level_row(f, rows, AREA_FAR, i, y, groups);
    }
}

// The part of r within reach of some blocks: rows y0 to y1 - 1 have them. Whole vectors from its left edge, or up to r's right
// one.
static struct hf_rect area_around(struct hf_rect r, struct hf_reach reach, uint64_t blocks, int y0, int y1)
{
    int x0 = r.x1, x1 = r.x0;
    for (int x = (r.x0 - reach.x) & ~15; x < r.x1 + reach.x; x += 16)
        if (blocks & convolve_blocks(x, x + 16)) {
            x0 = hf_min(x0, (x - reach.x) & ~15);
            x1 = x + 16 + reach.x;
        }
    x0 = hf_max(x0, r.x0);
    return (struct hf_rect){x0, hf_max(y0 - reach.y, r.y0), hf_min(x0 + ((x1 - x0 + 15) & ~15), r.x1),
                            hf_min(y1 + reach.y, r.y1)};
}

static int area_is_empty(struct hf_rect r)
{
    return r.x0 >= r.x1 || r.y0 >= r.y1;
}

// Of r, what a level's samples reach, or where it is wanted.
static struct hf_rect area_touched(const struct area_rows *rows, struct hf_rect r, struct hf_reach reach, int wanted)
{
    uint64_t blocks = 0;
    int y0 = r.y1 + reach.y, y1 = r.y0 - reach.y;
    for (int y = r.y0 - reach.y; y < r.y1 + reach.y; y++) {
        const struct convolve_row *row = &rows->level[y - rows->y0];
        const uint64_t own = wanted ? row->wanted : row->filled;
        blocks |= own;
        y0 = own ? hf_min(y0, y) : y0;
        y1 = own ? y + 1 : y1;
    }
    return area_around(r, reach, blocks, y0, y1);
}

HF_INLINE vf area_open_part(vf open)
{
    const vf part = vf_saturate(vf_mul(open, vf_set1(1 / HF_OPEN_WHOLE)));
    return vf_mul(vf_mul(part, part), part);
}

// What is not near, less what of far samples is left to the far levels. Returns which blocks of the row hold something.
HF_INLINE uint64_t area_behind_row(const struct hf_frame *f, const struct hf_rect area, int i, int y, const int karis,
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
    uint64_t filled = 0;
    for (int x = 0; x < area.x1 - x0; x += VF_N) {
        const vf open = vf_sub(vf_set1(1), vf_load(coc[HF_AREA_NEAR] + x));
        if (!vm_any(vf_gt(open, vf_zero()))) {
            for (int c = 0; c < s->channels; c++)
                vf_store(to[c] + x, vf_zero());
            for (int k = 0; k < 3; k++)
                vf_store(weight[k] + x, vf_zero());
            continue;
        }
        filled |= convolve_blocks(x0 + x, x0 + x + VF_N);
        const vf part = area_open_part(open);
        vf rest = open, left = vf_zero();
        if (leaves) {
            left = area_left(l, i, coc[HF_AREA_FAR_OF_LIGHT] + x);
            const vf hidden = vf_mul(left, vf_load(coc[HF_AREA_FAR] + x));
            rest = vf_sub(rest, hidden);
            vf_store(weight[2] + x, vf_mul(hidden, part));
        }
        rest = vf_mul(rest, part);
        const vm counts = vf_gt(rest, vf_zero());
        for (int c = 0; c < s->channels; c++) {
            vf v = vf_sub(vf_load(colour[c] + x), vf_load(near[c] + x));
            if (leaves)
                v = vf_sub(v, vf_mul(left, vf_load(far[c] + x)));
            v = vf_mul(v, part);
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
    return filled;
}

static void area_behind_planes(const struct hf_frame *f, const struct area_rows *rows, struct hf_rect area, int i)
{
    const int karis = hf_fields(f->s)->karis, leaves = area_leaves(f->s, i);
    for (int y = area.y0; y < area.y1 && !hf_stopped(f->s->stop); y++)
        rows->level[y - rows->y0].filled = karis    ? area_behind_row(f, area, i, y, 1, leaves)
                                           : leaves ? area_behind_row(f, area, i, y, 0, 1)
                                                    : area_behind_row(f, area, i, y, 0, 0);
}
