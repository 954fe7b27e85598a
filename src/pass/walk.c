// SPDX-License-Identifier: BSD-3-Clause
// Scatter: the sources that reach a cell, row by row, and the sums that they make (splat.c).
//
// Radii of half_to and more go to sums of half the resolution, between half_from and half_to to both. There a source
// is the tent-weighted mean of 4x4 pixels (1 3 3 1), which keeps centroids, where those have like radii; else pixels
// are drawn one by one, each on the four nearest.
#include <math.h>
#include <string.h>

#include "pass/pass_c.h"
#include "scatter.h"

enum { TENT_LINES = 33, TOGETHER = 4 }; // the latter: rows of sources that are drawn at once

// The walk over a window: one field's sums of one group and level.
struct walk {
    const struct hf_frame *f;
    const struct hf_scatter *t;
    const struct hf_splat_group *group;
    int field; // 0 near, 1 far
    int level; // 1: half resolution
    struct hf_sums sums;
    struct hf_splats *list;
    struct hf_run *runs; // of a picture that is its source's own
    // level 1: of the last rows, source radii and pixels; see merge_row
    float *quad[4], *tent[4][4], *pixel[2][4], *mean[4], *nothing;
    int lone[4];
    int tent_x0, tent_x1, quads_done, tents_done; // half-resolution columns; rows up to which they are made
};

// The pictures of a group's channel.
static const struct hf_picture *pictures(const struct walk *w)
{
    const struct hf_aperture *a = w->t->aperture;
    const int plane = a->planes == 3 && w->group->channel[0] < 3 ? w->group->channel[0] : a->planes == 3;
    return a->picture + plane * a->count;
}

static void flush(struct walk *w)
{
    const struct hf_aperture *a = w->t->aperture;
    const struct hf_splats *l = w->list;
    for (int i = 0; a->tap && i < l->count; i++) {
        const struct hf_picture *p = &pictures(w)[l->picture[i]];
        w->f->k->splat_taps(&w->sums, l->x[i] - p->reach_x, l->y[i] + p->top, a->tap + p->first, p->columns, p->rows,
                            l->share[i]);
    }
    if (a->tap) {
        w->list->count = 0;
        return;
    }
    if (a->symmetric && l->count)
        w->f->k->splat(&w->sums, a, l);
    for (int i = 0; !a->symmetric && i < l->count; i++) {
        const struct hf_picture *p = &a->picture[l->picture[i]];
        w->f->k->splat_runs(&w->sums, l->x[i], l->y[i] + p->top, a->run + p->first, p->rows, l->share[i]);
    }
    w->list->count = 0;
}

// What each lane of a source adds for 1 unit of weight.
static void set_share(const struct walk *w, int64_t share[4], const float colour[3], float weight, float part)
{
    for (int c = 0; c < 3; c++)
        share[c] = c < w->group->channels ? (int64_t)((double)(colour[c] * part) * w->t->scale[c]) : 0;
    share[3] = (int64_t)((double)(weight * part) * w->t->scale[3]);
}

static void add_picture(struct walk *w, int x, int y, int number, const float colour[3], float weight, float part)
{
    struct hf_splats *l = w->list;
    l->x[l->count] = x;
    l->y[l->count] = y;
    l->picture[l->count] = number;
    set_share(w, l->share[l->count], colour, weight, part);
    if (++l->count == HF_SPLATS)
        flush(w);
}

// A picture cut by the second circle of a cat's eye, of radius r around (cx, cy): its rows go to w->runs. Returns
// the sum
// of their weights.
static float cut_picture(struct walk *w, const struct hf_picture *p, float r, float cx, float cy)
{
    const struct hf_aperture *a = w->t->aperture;
    const float scale = 256 * a->key.scale_x;
    float area = 0;
    for (int i = 0; i < p->rows; i++) {
        const struct hf_run *run = &a->run[p->first + i];
        const float dy = (float)(p->top + i) - cy, q = r * r - dy * dy, half = q > 0 ? sqrtf(q) : 0;
        const int32_t from = 128 + (int32_t)lrintf((cx - half) * scale);
        const int32_t to = 128 + (int32_t)lrintf((cx + half) * scale);
        struct hf_run cut = {hf_max(run->a, from), hf_min(run->b, to), run->weight};
        if (cut.b <= cut.a)
            cut = (struct hf_run){0};
        area += (float)cut.weight * (float)(cut.b - cut.a);
        w->runs[i] = cut;
    }
    return area;
}

// The same with what is to be drawn of it.
static void draw_cut(struct walk *w, int x, int y, const struct hf_picture *p, const float colour[3], float weight,
                     float part)
{
    int64_t share[4];
    set_share(w, share, colour, weight, part);
    w->f->k->splat_runs(&w->sums, x, y + p->top, w->runs, p->rows, share);
}

// The second circle moves off the lens's axis, towards the corner that the source is near.
static void add_cat_eye(struct walk *w, int x, int y, float r, const float colour[3], float weight)
{
    const struct hf_setup *s = w->f->s;
    const struct hf_picture *picture = w->t->aperture->picture, *p = &picture[hf_picture_number(r)];
    const float step = w->level ? 2 : 1, toward = (w->field ? 1 : -1) * w->t->cat_eye * r;
    const float cx = toward * (2 * (((float)x + 0.5f) * step) - (float)s->width) * w->t->corner;
    const float cy = toward * (2 * (((float)y + 0.5f) * step) - (float)s->height) * w->t->corner;
    const float inner = r * w->t->ring, hole = inner < 0.5f ? 4 * inner * inner : 1;
    const struct hf_picture *inside = &picture[hf_picture_number(inner)];
    const float hidden = hole > 0 ? hole * cut_picture(w, inside, r, cx, cy) : 0;
    float area = cut_picture(w, p, r, cx, cy) - hidden;
    if (area <= 0) {
        w->runs[-p->top] = (struct hf_run){127, 129, HF_WHOLE_ROW};
        area = 2 * HF_WHOLE_ROW;
    }
    draw_cut(w, x, y, p, colour, weight, 1 / area);
    if (hidden > 0) {
        cut_picture(w, inside, r, cx, cy);
        draw_cut(w, x, y, inside, colour, weight, -hole / area);
    }
}

// Add a source to the list of row y: colour already weighted. A ring is its outline less its hole, which is the same
// shape.
static void add_source(struct walk *w, int x, int y, float radius, const float colour[3], float weight)
{
    const struct hf_aperture *a = w->t->aperture;
    const struct hf_picture *picture = pictures(w);
    const float r = radius * w->group->factor[w->field];
    const int number = a->tap ? (hf_picture_number(r) + a->steps / 2) / a->steps : hf_picture_number(r);
    if (w->t->cat_eye > 0) {
        add_cat_eye(w, x, y, r, colour, weight);
        return;
    }
    if (w->t->ring <= 0) {
        add_picture(w, x, y, number, colour, weight, 1 / picture[number].area);
        return;
    }
    // A hole too small for a picture of its own is a faint one.
    const float inner = r * w->t->ring, hole = inner < 0.5f ? 4 * inner * inner : 1;
    const int inside = hf_picture_number(inner);
    const float part = 1 / (picture[number].area - hole * picture[inside].area);
    add_picture(w, x, y, number, colour, weight, part);
    add_picture(w, x, y, inside, colour, weight, -hole * part);
}

// What of a pixel's signed radius is drawn in a field, both levels together.
static float field_weight(const struct hf_scatter *t, int field, float r)
{
    return r > 0 ? field ? 1 : 1 - hf_own_part(t, r) : 0;
}

static void list_run(struct walk *w, int x0, int x1, int y)
{
    const struct hf_frame *f = w->f;
    const float *radius = hf_at(&f->buf[HF_BUF_RADIUS], 0, 0, y), sign = w->field ? 1 : -1;
    for (int x = x0; x < x1; x++) {
        const float r = sign * radius[x];
        const float weight = field_weight(w->t, w->field, r) * (1 - hf_half_part(w->t, r));
        float v[3];
        if (!(weight > 0))
            continue;
        for (int c = 0; c < w->group->channels; c++)
            v[c] = *hf_at(&f->buf[HF_BUF_SOURCE], w->group->channel[c], x, y) * weight;
        add_source(w, x, y, r, v, weight);
    }
}

// Sources of full-resolution rows y0 to y1, four columns at a time: all rows of these draw on nearly the same lines
// of the
// cache, which come from its second level and go back there once for all of them.
static void list_full(struct walk *w, int y0, int y1)
{
    const int reach = w->t->reach_x[w->field][0];
    const int x0 = hf_max(w->sums.x0 - reach, 0), x1 = hf_min(w->sums.x1 + reach, w->f->s->width);
    for (int x = x0; x < x1; x += 4)
        for (int y = y0; y < y1; y++)
            list_run(w, x, hf_min(x + 4, x1), y);
    flush(w);
}

// Radius of a half-resolution pixel whose four have like ones, on this field's side; else 0.
static float quad_radius(float r0, float r1, float r2, float r3)
{
    const float low0 = r0 < r1 ? r0 : r1, low1 = r2 < r3 ? r2 : r3, least = low0 < low1 ? low0 : low1;
    const float high0 = r0 > r1 ? r0 : r1, high1 = r2 > r3 ? r2 : r3, most = high0 > high1 ? high0 : high1;
    return least > 0 && most - least <= 0.5f + least * (1 / 32.0f) ? 0.25f * ((r0 + r1) + (r2 + r3)) : 0;
}

void hf_quad_row_c(const float *above, const float *below, int n, float sign, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] =
            quad_radius(sign * above[2 * i], sign * above[2 * i + 1], sign * below[2 * i], sign * below[2 * i + 1]);
}

static void quad_row(struct walk *w, int q)
{
    const struct hf_setup *s = w->f->s;
    const float sign = w->field ? 1 : -1;
    const int n = w->tent_x1 - w->tent_x0;
    const float *a = hf_at(&w->f->buf[HF_BUF_RADIUS], 0, 2 * w->tent_x0, 2 * q);
    const float *b = hf_at(&w->f->buf[HF_BUF_RADIUS], 0, 2 * w->tent_x0, hf_min(2 * q + 1, s->height - 1));
    float *out = w->quad[q & 3];
    const int odd_edge = 2 * w->tent_x1 > s->width;
    w->f->k->quad_row(a, b, n - odd_edge, sign, out);
    if (odd_edge)
        out[n - 1] = quad_radius(sign * a[2 * n - 2], sign * a[2 * n - 2], sign * b[2 * n - 2], sign * b[2 * n - 2]);
    out[-1] = out[0];
    out[n] = out[n - 1];
}

// Is a pixel of radius r > 0 like those of the quad?
static int alike(float quad, float r)
{
    const float d = quad - r;
    return quad > 0 && (d < 0 ? -d : d) <= 0.5f + r * (1 / 32.0f);
}

// The neighbour of a pixel's quad that its tent reaches, on one axis.
static int beside(int pixel, int count)
{
    const int q = (pixel >> 1) + (pixel & 1 ? 1 : -1);
    return q < 0 ? 0 : q >= count ? count - 1 : q;
}

// Weight of pixel `odd` of half-resolution column i in the half-resolution sums; *merged: as a part of means.
static float tent_weight(const struct hf_tent_row *t, int i, int odd, int *merged)
{
    const float r = t->sign * t->radius[2 * i + odd];
    const int next = odd ? i + 1 : i - 1;
    *merged = alike(t->own[i], r) && alike(t->own[next], r) && alike(t->next[i], r) && alike(t->next[next], r);
    return field_weight(t->scatter, t->sign > 0, r) * hf_half_part(t->scatter, r);
}

int hf_tent_weights_c(const struct hf_tent_row *t, int first)
{
    int lone = 0;
    for (int i = first; i < t->n; i++)
        for (int odd = 0; odd < 2; odd++) {
            int merged;
            const float weight = tent_weight(t, i, odd, &merged);
            t->pixel[odd][3][i] = merged ? weight : 0;
            lone |= weight > 0 && !merged;
            for (int c = 0; c < t->channels; c++)
                t->pixel[odd][c][i] = t->colour[c][2 * i + odd] * t->pixel[odd][3][i];
        }
    return lone;
}

void hf_tent_c(const float *even, const float *odd, int n, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] = 0.375f * (even[i] + odd[i]) + 0.125f * (odd[i - 1] + even[i + 1]);
}

// What the walk knows of row y for its means.
static struct hf_tent_row tent_row_of(const struct walk *w, int y)
{
    const struct hf_frame *f = w->f;
    struct hf_tent_row t = {.scatter = w->t,
                            .sign = w->field ? 1 : -1,
                            .n = w->tent_x1 - w->tent_x0,
                            .channels = w->group->channels,
                            .own = w->quad[y >> 1 & 3],
                            .next = w->quad[beside(y, f->s->half_height) & 3],
                            .radius = hf_at(&f->buf[HF_BUF_RADIUS], 0, 2 * w->tent_x0, y)};
    for (int c = 0; c < t.channels; c++)
        t.colour[c] = hf_at(&f->buf[HF_BUF_SOURCE], w->group->channel[c], 2 * w->tent_x0, y);
    memcpy(t.pixel, w->pixel, sizeof t.pixel);
    return t;
}

// One full-resolution row's pixels that are parts of means, weighted, and their tent along x. Lanes 0..2 are the
// channels, 3 the weight. What the tent would put outside the frame stays at its edge.
static void tent_row(struct walk *w, int y)
{
    const struct hf_tent_row t = tent_row_of(w, y);
    const int n = t.n, width = w->f->s->width;
    w->lone[y & 3] = w->f->k->tent_weights(&t, 0);
    for (int c = 0; c < 4; c++) {
        float *even = t.pixel[0][c], *odd = t.pixel[1][c];
        if (c >= t.channels && c < 3)
            continue;
        odd[-1] = w->tent_x0 == 0 ? even[0] : 0;
        even[n] = 0;
        if (2 * w->tent_x1 == width)
            even[n] = odd[n - 1];
        if (2 * w->tent_x1 > width)
            odd[n - 1] = 0;
        w->f->k->tent(even, odd, n, w->tent[y & 3][c]);
    }
}

// Draw the pixels of row y that have no like neighbours, on half-resolution row q, with a share of `part`.
static void list_lone(struct walk *w, int y, int q, float part)
{
    const struct hf_frame *f = w->f;
    const int reach = w->t->reach_x[w->field][1];
    const int x0 = hf_max(w->sums.x0 - reach, 0), x1 = hf_min(w->sums.x1 + reach, f->s->half_width);
    const struct hf_tent_row t = tent_row_of(w, y);
    for (int x = 2 * w->tent_x0; x < hf_min(2 * w->tent_x1, f->s->width); x++) {
        int merged;
        const float weight = tent_weight(&t, (x >> 1) - w->tent_x0, x & 1, &merged);
        const float r = t.sign * t.radius[x - 2 * w->tent_x0];
        if (!(weight > 0) || merged)
            continue;
        for (int side = 0; side < 2; side++) {
            const int column = side ? beside(x, f->s->half_width) : x >> 1;
            const float share = weight * part * (side ? 0.25f : 0.75f);
            float v[3];
            if (column < x0 || column >= x1)
                continue;
            for (int c = 0; c < w->group->channels; c++)
                v[c] = *hf_at(&f->buf[HF_BUF_SOURCE], w->group->channel[c], x, y) * share;
            add_source(w, column, q, 0.5f * r, v, share);
        }
    }
    flush(w);
}

// Rows of quads up to q + 1 and of tents up to 2 q + 2.
static void prepare_tents(struct walk *w, int q)
{
    const struct hf_setup *s = w->f->s;
    if (w->quads_done < hf_max(q - 1, 0))
        w->quads_done = hf_max(q - 1, 0);
    if (w->tents_done < hf_max(2 * q - 1, 0))
        w->tents_done = hf_max(2 * q - 1, 0);
    // A row of tents needs quads of up to one row on.
    while (w->tents_done <= hf_min(2 * q + 2, s->height - 1)) {
        while (w->quads_done <= hf_min((w->tents_done >> 1) + 1, s->half_height - 1))
            quad_row(w, w->quads_done++);
        tent_row(w, w->tents_done++);
    }
}

void hf_mean_row_c(const float *const tent[4], const float part[4], int n, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] = 0.5f * ((part[0] * tent[0][i] + part[3] * tent[3][i]) + (part[1] * tent[1][i] + part[2] * tent[2][i]));
}

static void list_half(struct walk *w, int q)
{
    static const float parts[4] = {0.25f, 0.75f, 0.75f, 0.25f}; // of full-resolution rows 2q - 1 .. 2q + 2
    const struct hf_setup *s = w->f->s;
    const int reach = w->t->reach_x[w->field][1];
    const int x0 = hf_max(w->sums.x0 - reach, 0), x1 = hf_min(w->sums.x1 + reach, s->half_width);
    prepare_tents(w, q);
    // What a tent would put outside the frame stays in its last row.
    float part[4];
    int row[4];
    for (int i = 0; i < 4; i++) {
        row[i] = 2 * q - 1 + i;
        part[i] = row[i] < 0 || row[i] >= s->height ? 0 : parts[i];
        if (part[i] > 0 && beside(row[i], s->half_height) == q && row[i] >> 1 == q)
            part[i] = 1;
    }
    for (int c = 0; c < 4; c++) {
        const float *tent[4];
        if (c >= w->group->channels && c < 3)
            continue;
        for (int k = 0; k < 4; k++)
            tent[k] = (part[k] > 0 ? w->tent[row[k] & 3][c] : w->nothing) + x0 - w->tent_x0;
        w->f->k->mean_row(tent, part, x1 - x0, w->mean[c]);
    }
    const float *radius = w->quad[q & 3] + x0 - w->tent_x0;
    for (int i = 0; i < x1 - x0; i++) {
        const float v[3] = {w->mean[0][i], w->mean[1][i], w->mean[2][i]};
        if (radius[i] > 0 && w->mean[3][i] > 0)
            add_source(w, x0 + i, q, 0.5f * radius[i], v, w->mean[3][i]);
    }
    flush(w);
    for (int k = 0; k < 4; k++)
        if (part[k] > 0 && w->lone[row[k] & 3])
            list_lone(w, row[k], q, 0.25f * part[k]);
}

// Widths and heights of what a pass keeps while it draws on a rectangle of half-resolution pixels.
struct layout {
    int width[2], height[2], ring[2], stride[2]; // of the sums, each level; stride in lanes
    int tents;                                   // columns of the rows of means
    size_t sums, rows, list, runs, half, lines;  // floats of each part
};

static struct layout layout_of(const struct hf_scatter *t, int field, int cell_width, int cell_height)
{
    struct layout l = {0};
    for (int level = 0; level < 2; level++) {
        if (t->reach_x[field][level] < 0)
            continue;
        l.width[level] = level ? cell_width + 2 : 2 * cell_width;
        l.height[level] = level ? cell_height + 2 : 2 * cell_height;
        l.ring[level] = hf_min(2 * t->reach_y[field][level] + TOGETHER, l.height[level]);
        l.stride[level] = 4 * (l.width[level] + 4);
        const size_t sums = 2 * (size_t)l.stride[level] * (size_t)l.ring[level];
        l.sums = sums > l.sums ? sums : l.sums;
        l.rows = hf_max((int)l.rows, l.height[level]) * sizeof(ptrdiff_t) / sizeof(float);
    }
    if (t->reach_x[field][1] >= 0) {
        l.tents = l.width[1] + 2 * t->reach_x[field][1] + 2;
        l.half = 4 * (size_t)(l.width[1] + HF_PAD) * (size_t)l.height[1];
        l.lines = TENT_LINES * (size_t)(((l.tents + 15) & ~15) + 2 * HF_PAD);
    }
    l.sums = (l.sums + 15) & ~(size_t)15;
    l.rows = (l.rows + 15) & ~(size_t)15;
    int longest = 0;
    for (int level = 0; level < 2; level++)
        longest = hf_max(longest, t->reach_y[field][level]);
    l.runs = ((size_t)(2 * longest + 3) * sizeof(struct hf_run) / sizeof(float) + 15) & ~(size_t)15;
    l.list = (sizeof(struct hf_splats) / sizeof(float) + 15) & ~(size_t)15;
    return l;
}

size_t hf_splat_work(const struct hf_scatter *t, int cell_width, int cell_height)
{
    size_t most = 0;
    for (int field = 0; field < 2; field++) {
        const struct layout l = layout_of(t, field, cell_width, cell_height);
        const size_t all = l.sums + l.rows + l.list + l.runs + l.half + l.lines;
        most = all > most ? all : most;
    }
    return most;
}

// Rows of the result of one level: where settled rows go.
struct target {
    float *ch[4];
    ptrdiff_t stride;
};

static void settle(struct walk *w, const struct target *to, int y)
{
    float *out[4];
    for (int c = 0; c < 4; c++)
        out[c] = to->ch[c] ? to->ch[c] + (ptrdiff_t)(y - w->sums.y0) * to->stride : NULL;
    w->f->k->settle(w->sums.lane + w->sums.row[y - w->sums.y0], w->sums.x1 - w->sums.x0, w->group->channels,
                    w->t->unscale, out);
}

// All sources of a level that reach the window, row by row; each row of sums is settled when the last has passed.
static void walk_level(struct walk *w, const struct layout *l, const struct target *to)
{
    const struct hf_setup *s = w->f->s;
    const int reach = w->t->reach_y[w->field][w->level], height = w->level ? s->half_height : s->height;
    for (int y = 0; y < w->sums.y1 - w->sums.y0; y++)
        w->sums.row[y] = (ptrdiff_t)(y % l->ring[w->level]) * l->stride[w->level];
    memset(w->sums.lane, 0, sizeof *w->sums.lane * (size_t)l->stride[w->level] * (size_t)l->ring[w->level]);
    int settled = w->sums.y0;
    const int end = hf_min(w->sums.y1 + reach, height), step = w->level ? 1 : TOGETHER;
    for (int y = hf_max(w->sums.y0 - reach, 0); y < end; y += step) {
        while (settled < hf_min(y - reach, w->sums.y1))
            settle(w, to, settled++);
        if (w->level)
            list_half(w, y);
        else
            list_full(w, y, hf_min(y + step, end));
    }
    while (settled < w->sums.y1)
        settle(w, to, settled++);
}

// Add half-resolution sums, bilinearly, to row y from pixel x0 on. from: of its pixel (first, top).
static void add_half(const struct hf_setup *s, const float *from, ptrdiff_t stride, int first, int top, int x0, int x1,
                     int y, float *out)
{
    const int ya = y >> 1, yb = beside(y, s->half_height);
    const float *a = from + (ptrdiff_t)(ya - top) * stride - first, *b = from + (ptrdiff_t)(yb - top) * stride - first;
    for (int x = x0; x < x1; x++) {
        const int xa = x >> 1, xb = beside(x, s->half_width);
        out[x - x0] += 0.75f * (0.75f * a[xa] + 0.25f * b[xa]) + 0.25f * (0.75f * a[xb] + 0.25f * b[xb]);
    }
}

// The rows of the half-resolution level, each with HF_PAD floats before and after it.
static void place_lines(struct walk *w, float *memory, int length)
{
    float **const lines[] = {w->quad,    w->tent[0],  w->tent[1],  w->tent[2],
                             w->tent[3], w->pixel[0], w->pixel[1], w->mean};
    memory += HF_PAD;
    for (int i = 0; i < TENT_LINES - 1; i++, memory += length)
        lines[i >> 2][i & 3] = memory;
    w->nothing = memory;
    memset(memory, 0, sizeof *memory * (size_t)(length - HF_PAD));
}

// One group's sums of a field on r.
static void splat_group(struct walk *w, struct hf_rect r, int group, const struct hf_buf *sum,
                        const struct hf_buf *weight)
{
    const struct hf_frame *f = w->f;
    const struct hf_setup *s = f->s;
    const struct layout l = layout_of(w->t, w->field, r.x1 - r.x0, r.y1 - r.y0);
    float *memory = f->work;
    w->group = &w->t->group[group];
    w->sums.lane = (int64_t *)memory;
    w->sums.row = (ptrdiff_t *)(memory += l.sums);
    w->list = (struct hf_splats *)(memory += l.rows);
    w->list->count = 0;
    w->runs = (struct hf_run *)(memory += l.list);
    float *half = memory += l.runs;
    memory += l.half;
    const int x0 = 2 * r.x0, x1 = hf_min(2 * r.x1, s->width), y0 = 2 * r.y0, y1 = hf_min(2 * r.y1, s->height);
    const struct hf_rect h = {hf_max(r.x0 - 1, 0), hf_max(r.y0 - 1, 0), hf_min(r.x1 + 1, s->half_width),
                              hf_min(r.y1 + 1, s->half_height)};
    const ptrdiff_t half_stride = h.x1 - h.x0 + HF_PAD, half_plane = half_stride * (h.y1 - h.y0);
    if (w->t->reach_x[w->field][1] >= 0) {
        place_lines(w, memory, ((l.tents + 15) & ~15) + 2 * HF_PAD);
        const int reach = w->t->reach_x[w->field][1];
        w->level = 1;
        w->sums.x0 = h.x0, w->sums.x1 = h.x1, w->sums.y0 = h.y0, w->sums.y1 = h.y1;
        w->tent_x0 = hf_max(h.x0 - reach - 1, 0);
        w->tent_x1 = hf_min(h.x1 + reach + 1, s->half_width);
        w->quads_done = w->tents_done = 0;
        const struct target to = {{half, half + half_plane, half + 2 * half_plane, half + 3 * half_plane}, half_stride};
        walk_level(w, &l, &to);
    }
    struct target to = {.stride = sum->stride};
    for (int c = 0; c < w->group->channels; c++)
        to.ch[c] = hf_at(sum, w->group->channel[c], x0, y0);
    to.ch[3] = hf_at(weight, group, x0, y0);
    if (w->t->reach_x[w->field][0] >= 0) {
        w->level = 0;
        w->sums.x0 = x0, w->sums.x1 = x1, w->sums.y0 = y0, w->sums.y1 = y1;
        walk_level(w, &l, &to);
    }
    for (int c = 0; c < 4; c++)
        for (int y = y0; y < y1 && to.ch[c]; y++) {
            float *row = to.ch[c] + (ptrdiff_t)(y - y0) * to.stride;
            if (w->t->reach_x[w->field][0] < 0)
                memset(row, 0, sizeof *row * (size_t)(x1 - x0));
            if (w->t->reach_x[w->field][1] >= 0)
                add_half(s, half + c * half_plane, half_stride, h.x0, h.y0, x0, x1, y, row);
        }
}

static void splat_field(const struct hf_frame *f, struct hf_rect r, int field, int sum, int weight)
{
    struct walk w = {.f = f, .t = f->s->tables, .field = field};
    for (int group = 0; group < w.t->groups; group++)
        splat_group(&w, r, group, &f->buf[sum], &f->buf[weight]);
}

void hf_splat_far(const struct hf_frame *f, struct hf_rect r)
{
    splat_field(f, r, 1, HF_BUF_FAR_SUM, HF_BUF_FAR_WEIGHT);
}

void hf_splat_near(const struct hf_frame *f, struct hf_rect r)
{
    splat_field(f, r, 0, HF_BUF_NEAR_SUM, HF_BUF_NEAR_WEIGHT);
}
