// SPDX-License-Identifier: BSD-3-Clause
// Scatter: find the sources that reach a cell, row by row, and draw their sums (splat.c).
//
// Radii from half_to on go to sums of half the resolution (tent.c), those between half_from and half_to to both.
#include "engine/scatter/known.h"
#include "engine/scatter/walk.h"

// Prepare full-resolution row y in the walk's rows: weights, colours and sprites. share: of the backs.
static struct hf_source_row prepare_row(struct walk *w, int x0, int x1, int y, const float *share)
{
    const struct hf_frame *f = w->f;
    const float sign = w->field ? 1 : -1, *colour[3] = {NULL};
    float **row = w->source[y % TOGETHER];
    struct hf_source_row r = {.x = x0,
                              .y = y,
                              .weight = row[3],
                              .scale = sign * w->group->factor[w->field],
                              .radius = hf_at(&f->buf[HF_BUF_RADIUS], 0, x0, y),
                              .picture = (int32_t *)row[4]};
    for (int c = 0; c < 3; c++) {
        r.colour[c] = c < w->group->channels ? row[c] : w->nothing;
        if (c < w->group->channels)
            colour[c] = hf_at(&f->buf[HF_BUF_SOURCE], w->group->channel[c], x0, y);
    }
    hf_scatter_kernels(f)->source_weights(w->t, sign, r.radius, colour, w->group->channels, x1 - x0, row);
    for (int x = hf_edges_next(share, 0, x1 - x0); x < x1 - x0; x = hf_edges_next(share, x + 1, x1 - x0))
        for (int c = 0; c < 4; c++)
            if (c == 3 || c < w->group->channels)
                row[c][x] *= 1 - share[x];
    if (!w->slice.whole)
        hf_scatter_kernels(f)->slice_row(&w->slice, sign, r.radius, w->group->channels, x1 - x0, row);
    hf_scatter_kernels(f)->source_pictures(r.radius, r.weight, r.scale, x1 - x0, (int32_t *)row[4]);
    return r;
}

// List four pixels from x on, of n. Often none of them draws anything: in most cells a slice or the near field has few sources.
static void list_four(struct walk *w, const struct hf_source_row *row, int x, int n)
{
    const int32_t *p = row->picture + x;
    if (x + 4 > n || (p[0] & p[1] & p[2] & p[3]) >= 0)
        hf_list_sources(w, row, x, hf_min(x + 4, n));
}

// Prepare what lies behind the first samples of pixels, n of row y from x0 on, as another row of sources. Returns 0 if
// there is nothing. The rows' memory is the first samples', which have been listed.
static int prepare_backs(struct walk *w, enum hf_backs_set set, int x0, int y, int n, struct hf_source_row *r)
{
    const float sign = w->field ? 1 : -1;
    float **row = w->source[0];
    int32_t *picture = (int32_t *)row[4];
    struct hf_backs b;
    if (!hf_scatter_backs(w->f, set, x0, y, &b))
        return 0;
    int x = hf_edges_next(b.share, 0, n), some = 0;
    if (x < n)
        memset(picture, 0xff, sizeof *picture * (size_t)n);
    for (; x < n; x = hf_edges_next(b.share, x + 1, n)) {
        const float size = sign * b.radius[x], weight = hf_back_weight(w, size, b.share[x]);
        if (!(weight > 0))
            continue;
        row[3][x] = weight;
        for (int c = 0; c < w->group->channels; c++)
            row[c][x] = b.colour[w->group->channel[c]][x] * (weight * w->t->dim);
        picture[x] = hf_picture_number(size * w->group->factor[w->field]);
        some = 1;
    }
    *r = (struct hf_source_row){.x = x0,
                                .y = y,
                                .weight = row[3],
                                .scale = sign * w->group->factor[w->field],
                                .radius = b.radius,
                                .picture = picture};
    for (int c = 0; c < 3; c++)
        r->colour[c] = c < w->group->channels ? row[c] : w->nothing;
    return some;
}

// Draw the sources of full-resolution rows y0 to y1, four columns at a time: all these rows write to nearly the same
// cache lines, which are fetched from the second level and written back only once. Then draw what lies behind the first
// samples of pixels.
static void list_full(struct walk *w, int y0, int y1)
{
    struct hf_source_row row[TOGETHER];
    const float *share[TOGETHER];
    int x0, x1;
    hf_walk_columns(w, &x0, &x1);
    const int n = x1 - x0;
    for (int y = y0; y < y1; y++) {
        share[y - y0] = hf_back_shares(w->f, x0, y, n);
        row[y - y0] = prepare_row(w, x0, x1, y, share[y - y0]);
    }
    for (int x = 0; x < n && !hf_stopped(w->f->s->stop); x += 4)
        for (int i = 0; i < y1 - y0; i++)
            list_four(w, &row[i], x, n);
    for (int y = y0; y < y1; y++)
        for (int i = 0; i < hf_scatter_sets(w->field); i++)
            if (prepare_backs(w, i, x0, y, n, &row[0]))
                for (int x = 0; x < n && !hf_stopped(w->f->s->stop); x += 4)
                    list_four(w, &row[0], x, n);
    hf_flush_sources(w);
}

// The sizes of the scratch that a pass needs for a rectangle of half-resolution pixels.
struct layout {
    int width[2], height[2], ring[2], stride[2];  // of the sums, each level; stride in lanes
    int line[2];                                  // floats of a row of sources, and its padding
    size_t sums, rows, list, runs, half, lines;   // floats of each part
};

static size_t whole_lines(size_t floats)
{
    return (floats + 15) & ~(size_t)15;
}

// Lanes in a row of sums. Each row lies 9 cache lines further within a page, so that the rows of one sprite do not
// compete for the same cache sets.
static int stride_of(int width)
{
    enum { PAGE = 4096 / sizeof(int64_t), STEP = 9 * 64 / sizeof(int64_t) };
    const int lanes = 4 * (width + 2 * HF_SUMS_MARGIN);
    return lanes + (int)((unsigned)(STEP - lanes) % PAGE);
}

static struct layout layout_of(const struct hf_scatter *t, int field, int cell_width, int cell_height)
{
    struct layout l = {0};
    int longest = 0;
    for (int level = 0; level < 2; level++) {
        if (t->reach_x[field][level] < 0)
            continue;
        l.width[level] = level ? cell_width + 2 : 2 * cell_width;
        l.height[level] = level ? cell_height + 2 : 2 * cell_height;
        l.ring[level] = hf_min(2 * t->reach_y[field][level] + TOGETHER, l.height[level]);
        l.stride[level] = stride_of(l.width[level]);
        const int columns = level ? hf_tent_columns(t, field, l.width[1]) : l.width[0] + 2 * t->reach_x[field][0];
        l.line[level] = (int)whole_lines((size_t)columns) + 2 * HF_PAD;
        const size_t sums = 2 * HF_BINS * (size_t)l.stride[level] * (size_t)l.ring[level];
        const size_t lines = (level ? HF_TENT_LINES : 5 * TOGETHER) * (size_t)l.line[level];
        l.sums = sums > l.sums ? sums : l.sums;
        l.lines = lines > l.lines ? lines : l.lines;
        l.rows = (size_t)hf_max((int)l.rows, l.height[level]);
        longest = hf_max(longest, t->reach_y[field][level]);
    }
    if (t->reach_x[field][1] >= 0)
        l.half = 4 * (size_t)(l.width[1] + HF_PAD) * (size_t)l.height[1];
    l.sums = whole_lines(l.sums);
    l.rows = whole_lines(l.rows * sizeof(ptrdiff_t) / sizeof(float));
    l.runs = whole_lines((size_t)(2 * longest + 3) * sizeof(struct hf_run) / sizeof(float));
    l.list = whole_lines(HF_BINS * sizeof(struct hf_splats) / sizeof(float));
    l.lines += (size_t)hf_max(l.line[0], l.line[1]);  // plus one of zeros
    return l;
}

size_t hf_splat_work(const struct hf_scatter *t, int cell_width, int cell_height)
{
    size_t most = 0;
    for (int field = 0; field < 2; field++) {
        const struct layout l = layout_of(t, field, cell_width, cell_height);
        const size_t part = field && t->slices > 1 ? 16 * (size_t)(cell_width + HF_PAD) * (size_t)cell_height : 0;
        const size_t all = l.sums + l.rows + l.list + l.runs + l.half + l.lines + part;
        most = all > most ? all : most;
    }
    return most;
}

static void settle(struct walk *w, const struct hf_target *to, int y)
{
    float *out[4];
    for (int c = 0; c < 4; c++)
        out[c] = to->ch[c] ? to->ch[c] + (ptrdiff_t)(y - w->sums.y0) * to->stride : NULL;
    // The bins in which something has been drawn on this row.
    int64_t *lane[HF_BINS];
    double unscale[HF_BINS][4];
    int n = 0;
    for (int b = 0; b < w->bins->count; b++)
        if (y <= w->drawn[b]) {
            lane[n] = w->sums.lane + b * w->bin_lanes + w->sums.row[y - w->sums.y0];
            memcpy(unscale[n++], w->bins->unscale[b], sizeof *unscale);
        }
    if (n)
        hf_scatter_kernels(w->f)->settle(lane, n, w->sums.x1 - w->sums.x0, w->group->channels,
                                         (const double(*)[4])unscale, out);
    for (int c = 0; c < 4 && !n; c++)
        if (out[c])
            memset(out[c], 0, sizeof *out[c] * (size_t)(w->sums.x1 - w->sums.x0));
}

// Draw all sources of a level that reach the window, row by row. A row of sums is settled once no later source reaches
// it.
static void walk_level(struct walk *w, const struct layout *l, const struct hf_target *to)
{
    const struct hf_setup *s = w->f->s;
    const int reach = w->t->reach_y[w->field][w->level], height = w->level ? s->half_height : s->height;
    for (int y = 0; y < w->sums.y1 - w->sums.y0; y++)
        w->sums.row[y] = (ptrdiff_t)(y % l->ring[w->level]) * l->stride[w->level] + 4 * HF_SUMS_MARGIN;
    w->bins = &w->t->bins[w->level][w->group->channel[0] == 3];
    w->bin_lanes = (ptrdiff_t)l->stride[w->level] * l->ring[w->level];
    for (int b = 0; b < HF_BINS; b++)
        w->drawn[b] = -1;
    int settled = w->sums.y0;
    const int end = hf_min(w->sums.y1 + reach, height), step = w->level ? 1 : TOGETHER;
    for (int y = hf_max(w->sums.y0 - reach, 0); y < end && !hf_stopped(s->stop); y += step) {
        while (settled < hf_min(y - reach, w->sums.y1))
            settle(w, to, settled++);
        w->reached = y + step - 1 + reach;
        if (w->level)
            hf_list_half(w, y);
        else
            list_full(w, y, hf_min(y + step, end));
    }
    while (settled < w->sums.y1 && !hf_stopped(s->stop))
        settle(w, to, settled++);
}

// One plane of a window's half-resolution sums.
struct half_sums {
    const float *plane;
    ptrdiff_t stride;
    struct hf_rect r;
};

// Bilinear at the frame's left or right edge, where the plane continues as it is.
static float at_edge(float own, float over)
{
    const float v = 0.75f * own + 0.25f * over;
    return 0.75f * v + 0.25f * v;
}

// Upsample them bilinearly and add them to pixels x0 (even) to x1 of row y.
static void add_half(const struct hf_frame *f, const struct half_sums *h, int x0, int x1, int y, float *out)
{
    const float *a = h->plane + (ptrdiff_t)((y >> 1) - h->r.y0) * h->stride + ((x0 >> 1) - h->r.x0);
    const float *b = a + (ptrdiff_t)(hf_beside(y, f->s->half_height) - (y >> 1)) * h->stride;
    const int n = x1 - x0, last = (n - 1) >> 1;
    float *up = hf_line(f, 0);
    f->k->behind.up_row(a, b, last + 1, up);
    if (x0 == 0)
        up[0] = at_edge(a[0], b[0]);
    if (x1 == f->s->width && !(n & 1))
        up[n - 1] = at_edge(a[last], b[last]);
    for (int x = 0; x < n; x++)
        out[x] += up[x];
}

// Place the rows of full-resolution sources in memory.
static void place_rows(struct walk *w, float *memory, int length)
{
    memory += HF_PAD;
    for (int i = 0; i < 5 * TOGETHER; i++, memory += length)
        w->source[i / 5][i % 5] = memory;
}

// Draw one group's sums of a field on r, for the walk's slice.
static void splat_slice(struct walk *w, struct hf_rect r, const struct hf_target *to)
{
    const struct hf_frame *f = w->f;
    const struct hf_setup *s = f->s;
    const struct layout l = layout_of(w->t, w->field, r.x1 - r.x0, r.y1 - r.y0);
    float *memory = f->work;
    w->sums.lane = (int64_t *)memory;
    w->sums.row = (ptrdiff_t *)(memory += l.sums);
    w->list = (struct hf_splats *)(memory += l.rows);
    for (int b = 0; b < HF_BINS; b++)
        w->list[b].count = 0;
    w->runs = (struct hf_run *)(memory += l.list);
    float *half = memory += l.runs;
    w->nothing = memory += l.half;
    memory += hf_max(l.line[0], l.line[1]);
    memset(w->nothing, 0, sizeof *memory * (size_t)hf_max(l.line[0], l.line[1]));
    const int x0 = 2 * r.x0, x1 = hf_min(2 * r.x1, s->width), y0 = 2 * r.y0, y1 = hf_min(2 * r.y1, s->height);
    const struct hf_rect h = {hf_max(r.x0 - 1, 0), hf_max(r.y0 - 1, 0), hf_min(r.x1 + 1, s->half_width),
                              hf_min(r.y1 + 1, s->half_height)};
    const ptrdiff_t half_stride = h.x1 - h.x0 + HF_PAD, half_plane = half_stride * (h.y1 - h.y0);
    if (w->t->reach_x[w->field][1] >= 0) {
        w->level = 1;
        w->sums.x0 = h.x0, w->sums.x1 = h.x1, w->sums.y0 = h.y0, w->sums.y1 = h.y1;
        hf_tent_start(w, memory, l.line[1]);
        const struct hf_target sums = {{half, half + half_plane, half + 2 * half_plane, half + 3 * half_plane},
                                       half_stride};
        walk_level(w, &l, &sums);
    }
    if (w->t->reach_x[w->field][0] >= 0) {
        w->level = 0;
        w->sums.x0 = x0, w->sums.x1 = x1, w->sums.y0 = y0, w->sums.y1 = y1;
        place_rows(w, memory, l.line[0]);
        walk_level(w, &l, to);
    }
    for (int c = 0; c < 4; c++)
        for (int y = y0; y < y1 && to->ch[c] && !hf_stopped(s->stop); y++) {
            float *row = to->ch[c] + (ptrdiff_t)(y - y0) * to->stride;
            if (w->t->reach_x[w->field][0] < 0)
                memset(row, 0, sizeof *row * (size_t)(x1 - x0));
            if (w->t->reach_x[w->field][1] >= 0)
                add_half(f, &(struct half_sums){half + c * half_plane, half_stride, h}, x0, x1, y, row);
        }
}

static void clear(const struct hf_setup *s, struct hf_rect r, const struct hf_target *to)
{
    const int n = hf_min(2 * r.x1, s->width) - 2 * r.x0, rows = hf_min(2 * r.y1, s->height) - 2 * r.y0;
    for (int c = 0; c < 4; c++)
        for (int y = 0; y < rows && to->ch[c]; y++)
            memset(to->ch[c] + y * to->stride, 0, sizeof(float) * (size_t)n);
}

// Draw the far field's slices that reach r, from front to back.
static void splat_slices(struct walk *w, struct hf_rect r, const struct hf_target *to, float least, float most)
{
    const struct layout l = layout_of(w->t, w->field, r.x1 - r.x0, r.y1 - r.y0);
    const ptrdiff_t stride = 2 * (r.x1 - r.x0) + HF_PAD, plane = stride * 2 * (r.y1 - r.y0);
    float *memory = (float *)w->f->work + l.sums + l.rows + l.list + l.runs + l.half + l.lines;
    struct hf_target part = {.stride = stride};
    for (int c = 0; c < 4; c++)
        part.ch[c] = to->ch[c] ? memory + c * plane : NULL;
    for (int k = 0; k < w->t->slices && !hf_stopped(w->f->s->stop); k++) {
        w->slice = hf_scatter_slice_make(w->t, k);
        const int none = most <= w->slice.begin[0] || least >= w->slice.end[1];
        w->slice.whole = least >= w->slice.begin[1] && most <= w->slice.end[0];
        if (k == 0 && none)
            clear(w->f->s, r, to);
        else if (!none) {
            splat_slice(w, r, k ? &part : to);
            if (k)
                hf_scatter_slice_behind(w->f, r, to, &part);
        }
    }
}

static void splat_field(const struct hf_frame *f, struct hf_rect r, int field, int sum, int weight)
{
    struct walk w = {.f = f, .t = hf_scatter(f->s), .field = field, .slice = {.whole = 1}};
    const int sliced = field && w.t->slices > 1;
    float least, most;
    if (sliced)
        hf_scatter_slice_range(f, r, &least, &most);
    for (int group = 0; group < w.t->groups; group++) {
        struct hf_target to = {.stride = f->buf[sum].stride};
        w.group = &w.t->group[group];
        for (int c = 0; c < w.group->channels; c++)
            to.ch[c] = hf_at(&f->buf[sum], w.group->channel[c], 2 * r.x0, 2 * r.y0);
        to.ch[3] = hf_at(&f->buf[weight], group, 2 * r.x0, 2 * r.y0);
        if (sliced)
            splat_slices(&w, r, &to, least, most);
        else
            splat_slice(&w, r, &to);
    }
}

void hf_splat_far(const struct hf_frame *f, struct hf_rect r)
{
    splat_field(f, r, 1, HF_BUF_FAR_SUM, HF_BUF_FAR_WEIGHT);
}

void hf_splat_near(const struct hf_frame *f, struct hf_rect r)
{
    splat_field(f, r, 0, HF_BUF_NEAR_SUM, HF_BUF_NEAR_WEIGHT);
}
