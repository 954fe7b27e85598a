// SPDX-License-Identifier: BSD-3-Clause
// Scatter: sources of half resolution. Where pixels have similar radii, a source is the tent-weighted mean of 4x4
// pixels (1 3 3 1), which keeps centroids. Elsewhere pixels are drawn one by one, each on the four nearest
// half-resolution pixels. Between both cases a pixel is drawn partly each way, so a changing radius makes no picture
// jump.
#include <string.h>

#include "engine/scatter/known.h"
#include "engine/scatter/walk.h"

// The weight with which a pixel of radius r is drawn at half resolution.
static float half_weight(const struct hf_scatter *t, float r)
{
    return hf_field_weight(t, r) * hf_half_part(t, r);
}

void hf_quad_row_c(const struct hf_scatter *t, const float *above, const float *below, int n, float sign,
                   float *const out[2])
{
    for (int i = 0; i < n; i++) {
        const float r[4] = {sign * above[2 * i], sign * above[2 * i + 1], sign * below[2 * i], sign * below[2 * i + 1]};
        float w[4];
        for (int k = 0; k < 4; k++)
            w[k] = half_weight(t, r[k]);
        out[0][i] = (w[0] + w[1]) + (w[2] + w[3]);
        out[1][i] = (w[0] * r[0] + w[1] * r[1]) + (w[2] * r[2] + w[3] * r[3]);
    }
}

// Make a row of quads; beyond the frame they are empty.
static void quad_row(struct walk *w, int q)
{
    const struct hf_setup *s = w->f->s;
    const float sign = w->field ? 1 : -1;
    const int x0 = hf_max(w->tent_x0 - 1, 0), x1 = hf_min(w->tent_x1 + 1, s->half_width), n = x1 - x0;
    const float *a = hf_at(&w->f->buf[HF_BUF_RADIUS], 0, 2 * x0, 2 * q);
    const float *b = hf_at(&w->f->buf[HF_BUF_RADIUS], 0, 2 * x0, hf_min(2 * q + 1, s->height - 1));
    float *const out[2] = {w->quad[0][q & 3] + (x0 - w->tent_x0), w->quad[1][q & 3] + (x0 - w->tent_x0)};
    const int odd_edge = 2 * x1 > s->width;
    hf_scatter_kernels(w->f)->quad_row(w->t, a, b, n - odd_edge, sign, out);
    if (odd_edge) {
        const float above[2] = {a[2 * n - 2], a[2 * n - 2]}, below[2] = {b[2 * n - 2], b[2 * n - 2]};
        hf_quad_row_c(w->t, above, below, 1, sign, (float *const[2]){out[0] + n - 1, out[1] + n - 1});
    }
    for (int k = 0; k < 2; k++) {
        if (x0 == 0)
            out[k][-1] = 0;
        if (x1 == s->half_width)
            out[k][n] = 0;
    }
}

// The sum of three by three values, mirrored pairs first.
static float sum_around(const float *const row[3], int i)
{
    float v[3];
    for (int k = 0; k < 3; k++)
        v[k] = row[k][i] + (row[k][i - 1] + row[k][i + 1]);
    return v[1] + (v[0] + v[2]);
}

void hf_site_row_c(const float *const weight[3], const float *const moment[3], int n, float *out)
{
    for (int i = 0; i < n; i++) {
        const float all = weight[1][i] + HF_SITE_AROUND * sum_around(weight, i);
        out[i] = all > 0 ? (moment[1][i] + HF_SITE_AROUND * sum_around(moment, i)) / all : 0;
    }
}

// The radii of a row of half-resolution sources: the mean of the quad. If almost none of the quad is in the field, as
// just beside an object, it is the mean of the quads around.
static void site_row(struct walk *w, int q)
{
    const int n = w->tent_x1 - w->tent_x0;
    const float *quad[2][3];
    float *out = w->site[q & 3];
    for (int k = 0; k < 6; k++) {
        const int row = q + k % 3 - 1, none = row < 0 || row >= w->f->s->half_height;
        quad[k / 3][k % 3] = none ? w->nothing + HF_PAD : w->quad[k / 3][row & 3];
    }
    hf_scatter_kernels(w->f)->site_row(quad[0], quad[1], n, out);
    out[-1] = out[0];
    out[n] = out[n - 1];
}

static float farther(float a, float b, float r)
{
    a = __builtin_fabsf(a - r);
    b = __builtin_fabsf(b - r);
    return a > b ? a : b;
}

// The weight of pixel `odd` of half-resolution column i in the half-resolution sums; *merged: its part that belongs to
// means.
static float tent_weight(const struct hf_tent_row *t, int i, int odd, float *merged)
{
    const float r = t->sign * t->radius[2 * i + odd], weight = half_weight(t->scatter, r);
    const int next = odd ? i + 1 : i - 1;
    const float own = farther(t->own[i], t->own[next], r), other = farther(t->next[i], t->next[next], r);
    *merged = weight * hf_alike(r, own > other ? own : other);
    return weight;
}

int hf_tent_weights_c(const struct hf_tent_row *t, int first)
{
    int lone = 0;
    for (int i = first; i < t->n; i++)
        for (int odd = 0; odd < 2; odd++) {
            float *merged = &t->pixel[odd][3][i];
            lone |= tent_weight(t, i, odd, merged) > *merged;
            for (int c = 0; c < t->channels; c++)
                t->pixel[odd][c][i] = t->colour[c][2 * i + odd] * (*merged * t->scatter->dim);
        }
    return lone;
}

void hf_tent_c(const float *even, const float *odd, int n, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] = 0.375f * (even[i] + odd[i]) + 0.125f * (odd[i - 1] + even[i + 1]);
}

// What the means need of row y.
static struct hf_tent_row tent_row_of(const struct walk *w, int y)
{
    const struct hf_frame *f = w->f;
    struct hf_tent_row t = {.scatter = w->t,
                            .sign = w->field ? 1 : -1,
                            .n = w->tent_x1 - w->tent_x0,
                            .channels = w->group->channels,
                            .own = w->site[y >> 1 & 3],
                            .next = w->site[hf_beside(y, f->s->half_height) & 3],
                            .radius = hf_at(&f->buf[HF_BUF_RADIUS], 0, 2 * w->tent_x0, y)};
    for (int c = 0; c < t.channels; c++)
        t.colour[c] = hf_at(&f->buf[HF_BUF_SOURCE], w->group->channel[c], 2 * w->tent_x0, y);
    memcpy(t.pixel, w->pixel, sizeof t.pixel);
    return t;
}

// Scale a row's pixels by their part in the walk's slice.
static void slice_pixels(const struct walk *w, const struct hf_tent_row *t)
{
    for (int odd = 0; odd < 2; odd++) {
        float *part = w->part[odd];
        for (int i = 0; i < t->n; i++)
            part[i] = hf_scatter_slice_part(&w->slice, t->sign * t->radius[2 * i + odd]);
        for (int c = 0; c < 4; c++)
            for (int i = 0; i < t->n && (c == 3 || c < t->channels); i++)
                t->pixel[odd][c][i] *= part[i];
    }
}

// Weight the pixels of a full-resolution row that belong to means, and apply the tent along x. Lanes 0 to 2 are the
// channels, 3 the weight. What the tent would put outside the frame stays at its edge.
static void tent_row(struct walk *w, int y)
{
    const struct hf_tent_row t = tent_row_of(w, y);
    const int n = t.n, width = w->f->s->width, pixels = hf_min(2 * n, width - 2 * w->tent_x0);
    const float *share = hf_back_shares(w->f, 2 * w->tent_x0, y, pixels);
    w->lone[y & 3] = hf_scatter_kernels(w->f)->tent_weights(&t, 0);
    for (int x = hf_edges_next(share, 0, pixels); x < pixels; x = hf_edges_next(share, x + 1, pixels))
        for (int c = 0; c < 4; c++)
            if (c == 3 || c < t.channels)
                t.pixel[x & 1][c][x >> 1] *= 1 - share[x];
    if (!w->slice.whole)
        slice_pixels(w, &t);
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
        hf_scatter_kernels(w->f)->tent(even, odd, n, w->tent[y & 3][c]);
    }
}

// The half-resolution column that one of a pixel's two sides goes to, -1 if it is outside the window.
static int column_of(const struct walk *w, int x, int side)
{
    const int column = side ? hf_beside(x, w->f->s->half_width) : x >> 1;
    int x0, x1;
    hf_walk_columns(w, &x0, &x1);
    return column >= x0 && column < x1 ? column : -1;
}

// Draw the parts of row y's pixels that have no similar neighbours on half-resolution row q, times `part`.
static void list_lone(struct walk *w, int y, int q, float part)
{
    const struct hf_frame *f = w->f;
    const struct hf_tent_row t = tent_row_of(w, y);
    const float half = 0.5f * w->group->factor[w->field];
    for (int x = 2 * w->tent_x0; x < hf_min(2 * w->tent_x1, f->s->width); x++) {
        const float r = t.sign * t.radius[x - 2 * w->tent_x0];
        float merged;
        if (!(r > 0 && (w->slice.whole || (r > w->slice.begin[0] && r < w->slice.end[1]))))
            continue;
        float weight = tent_weight(&t, (x >> 1) - w->tent_x0, x & 1, &merged);
        if (!(weight > merged))
            continue;
        weight = (weight - merged) * hf_scatter_slice_part(&w->slice, r);
        if (w->t->mixed)
            weight *= 1 - *hf_at(&f->buf[HF_BUF_BACK_AT], 0, x, y);
        for (int side = 0; side < 2; side++) {
            const int column = column_of(w, x, side);
            const float share = weight * part * (side ? 0.25f : 0.75f);
            float v[3] = {0};
            if (column < 0 || !(share > 0))
                continue;
            for (int c = 0; c < w->group->channels; c++)
                v[c] = *hf_at(&f->buf[HF_BUF_SOURCE], w->group->channel[c], x, y) * (share * w->t->dim);
            hf_add_source(w, column, q, r * half, v, share);
        }
    }
    hf_flush_sources(w);
}

// The same for what lies behind the pixels' first samples.
static void list_backs(struct walk *w, int y, int q, float part)
{
    const int x0 = 2 * w->tent_x0, n = hf_min(2 * w->tent_x1, w->f->s->width) - x0;
    struct hf_backs b;
    for (int i = 0; i < hf_scatter_sets(w->field); i++) {
        if (!hf_scatter_backs(w->f, i, x0, y, &b))
            continue;
        for (int x = hf_edges_next(b.share, 0, n); x < n; x = hf_edges_next(b.share, x + 1, n))
            for (int side = 0; side < 2; side++) {
                const int column = column_of(w, x0 + x, side);
                if (column >= 0)
                    hf_add_back(w, &b, x, column, q, part * (side ? 0.25f : 0.75f));
            }
    }
    hf_flush_sources(w);
}

// Make the rows of sources up to q + 2 and of tents up to 2 q + 2.
static void prepare_tents(struct walk *w, int q)
{
    const struct hf_setup *s = w->f->s;
    w->quads_done = hf_max(w->quads_done, hf_max(q - 2, 0));
    w->sites_done = hf_max(w->sites_done, hf_max(q - 1, 0));
    w->tents_done = hf_max(w->tents_done, hf_max(2 * q - 1, 0));
    while (w->sites_done <= hf_min(q + 2, s->half_height - 1)) {
        while (w->quads_done <= hf_min(w->sites_done + 1, s->half_height - 1))
            quad_row(w, w->quads_done++);
        site_row(w, w->sites_done++);
    }
    while (w->tents_done <= hf_min(2 * q + 2, s->height - 1))
        tent_row(w, w->tents_done++);
}

void hf_mean_row_c(const float *const tent[4], const float part[4], int n, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] = 0.5f * ((part[0] * tent[0][i] + part[3] * tent[3][i]) + (part[1] * tent[1][i] + part[2] * tent[2][i]));
}

// The parts of full-resolution rows 2q - 1 to 2q + 2 that go to row q. What the tent would put outside the frame stays
// in its last row.
static void set_parts(const struct hf_setup *s, int q, int row[4], float part[4])
{
    static const float parts[4] = {0.25f, 0.75f, 0.75f, 0.25f};
    for (int i = 0; i < 4; i++) {
        row[i] = 2 * q - 1 + i;
        part[i] = row[i] < 0 || row[i] >= s->height ? 0 : parts[i];
        if (part[i] > 0 && hf_beside(row[i], s->half_height) == q && row[i] >> 1 == q)
            part[i] = 1;
    }
}

void hf_list_half(struct walk *w, int q)
{
    int x0, x1, row[4];
    float part[4];
    hf_walk_columns(w, &x0, &x1);
    prepare_tents(w, q);
    set_parts(w->f->s, q, row, part);
    struct hf_source_row r = {.x = x0,
                              .y = q,
                              .weight = w->mean[3],
                              .radius = w->site[q & 3] + x0 - w->tent_x0,
                              .scale = 0.5f * w->group->factor[w->field],
                              .picture = (int32_t *)w->mean[4]};
    for (int c = 0; c < 4; c++) {
        const float *tent[4];
        if (c < 3)
            r.colour[c] = c < w->group->channels ? w->mean[c] : w->nothing;
        if (c >= w->group->channels && c < 3)
            continue;
        for (int k = 0; k < 4; k++)
            tent[k] = (part[k] > 0 ? w->tent[row[k] & 3][c] : w->nothing) + x0 - w->tent_x0;
        hf_scatter_kernels(w->f)->mean_row(tent, part, x1 - x0, w->mean[c]);
    }
    hf_scatter_kernels(w->f)->source_pictures(r.radius, r.weight, r.scale, x1 - x0, (int32_t *)w->mean[4]);
    hf_list_sources(w, &r, 0, x1 - x0);
    hf_flush_sources(w);
    for (int k = 0; k < 4; k++) {
        if (part[k] > 0 && w->lone[row[k] & 3])
            list_lone(w, row[k], q, 0.25f * part[k]);
        if (part[k] > 0)
            list_backs(w, row[k], q, 0.25f * part[k]);
    }
}

int hf_tent_columns(const struct hf_scatter *t, int field, int width)
{
    return width + 2 * t->reach_x[field][1] + 2;
}

void hf_tent_start(struct walk *w, float *memory, int length)
{
    float **const lines[] = {w->quad[0], w->quad[1], w->site,     w->tent[0],  w->tent[1],
                             w->tent[2], w->tent[3], w->pixel[0], w->pixel[1], w->mean};
    const int reach = w->t->reach_x[w->field][1];
    w->tent_x0 = hf_max(w->sums.x0 - reach - 1, 0);
    w->tent_x1 = hf_min(w->sums.x1 + reach + 1, w->f->s->half_width);
    w->quads_done = w->sites_done = w->tents_done = 0;
    memory += HF_PAD;
    for (int i = 0; i < HF_TENT_LINES - 3; i++, memory += length)
        lines[i >> 2][i & 3] = memory;
    w->mean[4] = memory;
    for (int i = 0; i < 2; i++)
        w->part[i] = memory += length;
}
