// SPDX-License-Identifier: BSD-3-Clause
// Scatter: from pixels to lists of sprites (walk.c), and shapes that depend on the source.
#include <math.h>
#include <string.h>

#include "engine/scatter/known.h"
#include "engine/scatter/walk.h"

void hf_source_weights_c(const struct hf_scatter *t, float sign, const float *radius, const float *const colour[3],
                         int channels, int n, float *const out[4])
{
    for (int i = 0; i < n; i++) {
        const float weight = hf_field_weight(t, sign * radius[i]) * (1 - hf_half_part(t, sign * radius[i]));
        out[3][i] = weight;
        for (int c = 0; c < channels; c++)
            out[c][i] = colour[c][i] * (weight * t->dim);
    }
}

void hf_source_pictures_c(const float *radius, const float *weight, float scale, int n, int32_t *out)
{
    for (int i = 0; i < n; i++) {
        const float r = radius[i] * scale;
        out[i] = r > 0 && weight[i] > 0 ? hf_picture_number(r) : -1;
    }
}

// How a source draws a sprite. share: the part of its colour for one pixel, 1 / area. part: 0 to 1 adds the sprite with
// that weight, -1 to 0 takes it away, as the hole of a ring.
struct part {
    float share, part;
};

// A part's share is a whole number of the units of the whole share, so a faint one is not rounded away by its bin's
// units.
static float part_share(float share, float part)
{
    const float t = 4 * share, size = __builtin_fabsf(part), whole = size < 1 ? (t + share * size) - t : share;
    return part < 0 ? -whole : whole;
}

// The weight of a ring's hole. A hole too small for a sprite of its own is drawn as a fainter one, and so is one that
// leaves less than a pixel of the ring.
static float hole_of(const struct hf_scatter *t, float r)
{
    const float inner = r * t->ring, hole = inner < 0.5f ? 4 * inner * inner : 1;
    return hole * hf_saturate((1 - t->ring) * r);
}

// The lanes that bin b holds of a source, one bit each, 0 for none. A channel goes to the bin of its own brightness.
// The weight (bit 3) goes with the first channel; for a black source with the first bin.
static int lanes_of(const struct hf_bins *bins, int b, const float colour[3])
{
    int held = 0, before = 0, black = 1;
    for (int c = 0; c < 3; c++) {
        const float v = __builtin_fabsf(colour[c]);
        black &= v == 0;
        held |= (v > 0 && v >= bins->least[b] && (!b || v < bins->least[b - 1])) << c;
        before |= b && v >= bins->least[b - 1];
    }
    return held | (!before && (held || (black && !b))) << 3;
}

// What each lane of a source adds to bin b per unit of weight. part: 1 / the sprite's area.
static void set_share(const struct hf_bins *bins, int b, int lanes, const float colour[3], float weight,
                      struct part part, int64_t share[4])
{
    for (int c = 0; c < 4; c++) {
        const float v = hf_share((c == 3 ? weight : colour[c]) * part.share);
        share[c] = lanes >> c & 1 ? (int64_t)((double)part_share(v, part.part) * bins->scale[b][c]) : 0;
    }
}

void hf_list_row_c(struct hf_splats list[HF_BINS], const struct hf_source_row *row, int from, int to,
                   const float *inverse, const struct hf_bins *bins)
{
    for (int i = from; i < to; i++)
        for (int b = 0; b < bins->count && row->picture[i] >= 0; b++) {
            const float v[3] = {row->colour[0][i], row->colour[1][i], row->colour[2][i]};
            const int lanes = lanes_of(bins, b, v);
            if (!lanes)
                continue;
            const int k = list[b].count++;
            list[b].x[k] = row->x + i;
            list[b].y[k] = row->y;
            list[b].picture[k] = row->picture[i];
            set_share(bins, b, lanes, v, row->weight[i], (struct part){inverse[row->picture[i]], 1}, list[b].share[k]);
        }
}

// The sprites of a group's channel.
static const struct hf_picture *pictures(const struct walk *w)
{
    const struct hf_aperture *a = hf_scatter_aperture(w->t, w->field);
    const int plane = a->planes == 3 && w->group->channel[0] < 3 ? w->group->channel[0] : a->planes == 3;
    return a->picture + plane * a->count;
}

const float *hf_back_shares(const struct hf_frame *f, int x, int y, int n)
{
    const float *share = hf_scatter(f->s)->mixed ? hf_at(&f->buf[HF_BUF_BACK_AT], 0, x, y) : NULL;
    return hf_edges_next(share, 0, n) < n ? share : NULL;
}

// A bin's sums, ready to be drawn on; cleared first if nothing has been drawn there.
static struct hf_sums draw_bin(struct walk *w, int b)
{
    struct hf_sums s = w->sums;
    s.lane += b * w->bin_lanes;
    if (w->drawn[b] < 0)
        memset(s.lane, 0, sizeof *s.lane * (size_t)w->bin_lanes);
    w->drawn[b] = w->reached;
    return s;
}

void hf_flush_sources(struct walk *w)
{
    const struct hf_aperture *a = hf_scatter_aperture(w->t, w->field);
    for (int b = 0; b < w->bins->count; b++) {
        struct hf_splats *l = &w->list[b];
        if (hf_stopped(w->f->s->stop))
            l->count = 0;
        if (!l->count)
            continue;
        const struct hf_sums sums = draw_bin(w, b);
        if (a->symmetric)
            hf_scatter_kernels(w->f)->splat(&sums, a, l);
        for (int i = 0; !a->symmetric && i < l->count; i++) {
            const struct hf_picture *p = &pictures(w)[l->picture[i]];
            if (a->tap)
                hf_scatter_kernels(w->f)->splat_taps(&sums, l->x[i] - p->reach_x, l->y[i] + p->top, a->tap + p->first,
                                                     p->columns, p->rows, l->share[i]);
            else
                hf_scatter_kernels(w->f)->splat_runs(&sums, l->x[i], l->y[i] + p->top, a->run + p->first, p->rows,
                                                     l->share[i]);
        }
        l->count = 0;
    }
}

static void add_picture(struct walk *w, int x, int y, int number, const float colour[3], float weight, struct part part)
{
    for (int b = 0; b < w->bins->count; b++) {
        struct hf_splats *l = &w->list[b];
        const int lanes = lanes_of(w->bins, b, colour);
        if (!lanes)
            continue;
        l->x[l->count] = x;
        l->y[l->count] = y;
        l->picture[l->count] = number;
        set_share(w->bins, b, lanes, colour, weight, part, l->share[l->count]);
        if (++l->count == HF_SPLATS)
            hf_flush_sources(w);
    }
}

// A sprite between two sizes: its rows are interpolated, so a radius that grows moves its rim by the units of runs alone. All
// rows are the larger's, which the smaller's may lack.
struct between {
    const struct hf_run *small, *large;  // row 0 of both
    const struct hf_picture *picture;    // the larger
    int top, bottom;                     // the smaller's rows
    float t;
};

static struct between between(const struct hf_aperture *a, float r)
{
    enum { BITS = 23 - HF_SIZES_LOG2 };
    const uint32_t over = hf_bits(r > 0.5f ? r : 0.5f) - 0x3f000000;
    const struct hf_picture *p = &a->picture[over >> BITS];
    return (struct between){a->run + p[0].first - p[0].top,
                            a->run + p[1].first - p[1].top,
                            &p[1],
                            p[0].top,
                            p[0].top + p[0].rows - 1,
                            (float)(over & ((1 << BITS) - 1)) * (1.0f / (1 << BITS))};
}

// A row of real numbers, in the units of runs but from the pixel's middle on, so that mirrored rows have the same bits.
struct real_row {
    float a, b, weight;
};

// Two rows by parts of 1. A row's ends count by its weight: those of the first and last rows depend steeply on the radius.
static struct real_row mix_rows(struct real_row v, struct real_row w, float t)
{
    const float weight = hf_lerp(v.weight, w.weight, t);
    const float part = v.weight == w.weight ? t : weight > 0 ? t * w.weight / weight : 0;
    return (struct real_row){hf_lerp(v.a, w.a, part), hf_lerp(v.b, w.b, part), weight};
}

static struct real_row real_of(const struct hf_run *run)
{
    return (struct real_row){(float)(run->a - 128), (float)(run->b - 128), (float)run->weight};
}

// Row dy of a sprite between two sizes; nothing beyond its rows.
static struct real_row row_of(const struct between *s, int dy)
{
    const int top = s->picture->top;
    if (dy < top || dy >= top + s->picture->rows)
        return (struct real_row){0};
    const int both = dy >= s->top && dy <= s->bottom;
    return mix_rows(both ? real_of(&s->small[dy]) : (struct real_row){0}, real_of(&s->large[dy]), s->t);
}

// A row of the cat's eye's second circle where it cuts a polygon, dy rows from the circle's centre: the widest within the
// row, so that a circle that has not moved cuts no corner.
static struct real_row circle_row(const struct hf_aperture *a, float r, float dy)
{
    const float far = __builtin_fabsf(dy), near = far > 0.5f ? far - 0.5f : 0, q = r * r - near * near;
    const float height = hf_saturate(r + 0.5f - far), half = q > 0 ? 256 * a->key.scale_x * sqrtf(q) : 0;
    return (struct real_row){-half, half, HF_WHOLE_ROW * height};
}

// Cut a sprite by the cat's eye's second circle, of radius r around (cx, cy), with the shape `disc`. Where that is a disc, its
// rows are interpolated from two of the sprite's, so that a circle that has not moved cuts nothing. The rows go to w->runs.
// Returns the sum of their weights.
static float cut_picture(struct walk *w, const struct between *s, const struct between *disc, float r, float cx,
                         float cy)
{
    const struct hf_aperture *a = hf_scatter_aperture(w->t, w->field);
    const struct hf_picture *p = s->picture;
    const float shift = 256 * a->key.scale_x * cx, dy = (float)p->top - cy, first = floorf(dy);
    struct real_row next = row_of(disc, (int)first);
    float area = 0;
    for (int i = 0; i < p->rows; i++) {
        const struct real_row run = row_of(s, p->top + i), before = next;
        next = row_of(disc, (int)first + i + 1);
        const struct real_row c = a->key.blades ? circle_row(a, r, dy + (float)i) : mix_rows(before, next, dy - first);
        const float from = c.a + shift, to = c.b + shift;
        struct hf_run cut = {128 + (int32_t)lrintf(run.a > from ? run.a : from),
                             128 + (int32_t)lrintf(run.b < to ? run.b : to),
                             (int32_t)lrintf(run.weight < c.weight ? run.weight : c.weight)};
        if (cut.b <= cut.a)
            cut = (struct hf_run){0};
        area += (float)cut.weight * (float)(cut.b - cut.a);
        w->runs[i] = cut;
    }
    return area;
}

// Cut a sprite and draw the rest.
static void draw_cut(struct walk *w, int x, int y, const struct hf_picture *p, const float colour[3], float weight,
                     struct part part)
{
    for (int b = 0; b < w->bins->count; b++) {
        const int lanes = lanes_of(w->bins, b, colour);
        if (!lanes)
            continue;
        const struct hf_sums sums = draw_bin(w, b);
        int64_t share[4];
        set_share(w->bins, b, lanes, colour, weight, part, share);
        hf_scatter_kernels(w->f)->splat_runs(&sums, x, y + p->top, w->runs, p->rows, share);
    }
}

// The second circle moves from the lens's axis towards the corner that is nearest to the source.
static void add_cat_eye(struct walk *w, int x, int y, float r, const float colour[3], float weight)
{
    const struct hf_setup *s = w->f->s;
    const struct between outer = between(hf_scatter_aperture(w->t, w->field), r);
    const struct hf_picture *p = outer.picture;
    const float step = w->level ? 2 : 1, toward = (w->field ? 1 : -1) * w->t->cat_eye * r;
    const float cx = toward * (2 * (((float)x + 0.5f) * step) - (float)s->width) * w->t->corner;
    const float cy = toward * (2 * (((float)y + 0.5f) * step) - (float)s->height) * w->t->corner;
    const float inner = r * w->t->ring, hole = hole_of(w->t, r);
    const struct between inside = between(hf_scatter_aperture(w->t, w->field), inner);
    const float hidden = hole > 0 ? hole * cut_picture(w, &inside, &outer, r, cx, cy) : 0;
    float area = cut_picture(w, &outer, &outer, r, cx, cy) - hidden;
    if (area <= 0) {
        w->runs[-p->top] = (struct hf_run){127, 129, HF_WHOLE_ROW};
        area = 2 * HF_WHOLE_ROW;
    }
    draw_cut(w, x, y, p, colour, weight, (struct part){1 / area, 1});
    if (hidden > 0) {
        cut_picture(w, &inside, &outer, r, cx, cy);
        draw_cut(w, x, y, inside.picture, colour, weight, (struct part){1 / area, -hole});
    }
}

// A ring is its outline minus its hole, which has the same shape.
void hf_add_source(struct walk *w, int x, int y, float r, const float colour[3], float weight)
{
    const struct hf_aperture *a = hf_scatter_aperture(w->t, w->field);
    const struct hf_picture *picture = pictures(w);
    const int size = hf_picture_number(r), number = size / a->steps;
    if (w->t->cat_eye > 0) {
        add_cat_eye(w, x, y, r, colour, weight);
        return;
    }
    if (w->t->ring <= 0) {
        // Between two sizes of an image both are drawn.
        const float over = (float)(size % a->steps) / (float)a->steps;
        add_picture(w, x, y, number, colour, weight, (struct part){1 / picture[number].area, 1 - over});
        if (over > 0)
            add_picture(w, x, y, number + 1, colour, weight, (struct part){1 / picture[number + 1].area, over});
        return;
    }
    const float inner = r * w->t->ring, hole = hole_of(w->t, r);
    const int inside = hf_picture_number(inner);
    const float part = 1 / (picture[number].area - hole * picture[inside].area);
    add_picture(w, x, y, number, colour, weight, (struct part){part, 1});
    add_picture(w, x, y, inside, colour, weight, (struct part){part, -hole});
}

void hf_list_sources(struct walk *w, const struct hf_source_row *row, int from, int to)
{
    const struct hf_scatter *t = w->t;
    if (!t->aperture.tap && t->ring <= 0 && t->cat_eye <= 0) {
        for (int at = from; at < to; at += HF_SPLATS) {
            const int end = hf_min(at + HF_SPLATS, to);
            for (int b = 0; b < w->bins->count; b++)
                if (w->list[b].count + end - at > HF_SPLATS)
                    hf_flush_sources(w);
            hf_scatter_kernels(w->f)->list_row(w->list, row, at, end, hf_scatter_aperture(t, w->field)->inverse,
                                               w->bins);
        }
        return;
    }
    for (int i = from; i < to; i++) {
        const float v[3] = {row->colour[0][i], row->colour[1][i], row->colour[2][i]};
        if (row->picture[i] >= 0)
            hf_add_source(w, row->x + i, row->y, row->radius[i] * row->scale, v, row->weight[i]);
    }
}

void hf_add_back(struct walk *w, const struct hf_backs *b, int x, int to_x, int to_y, float part)
{
    const float size = (w->field ? 1 : -1) * b->radius[x], weight = hf_back_weight(w, size, b->share[x] * part);
    float v[3] = {0};
    if (!(weight > 0))
        return;
    for (int c = 0; c < w->group->channels; c++)
        v[c] = b->colour[w->group->channel[c]][x] * (weight * w->t->dim);
    hf_add_source(w, to_x, to_y, size * (w->level ? 0.5f : 1) * w->group->factor[w->field], v, weight);
}
