// SPDX-License-Identifier: BSD-3-Clause
// Scatter: the steps before and after the splats (splat.c).
#include "pixel/edges.h"
#include "pixel/pass_c.h"
#include "engine/scatter/behind.h"
#include "engine/scatter/kernels.h"
#include "engine/scatter/known.h"
#include "engine/scatter/walk.h"

// The bit for the exponent of v > 0: each bit stands for eight exponents, the highest for sixteen.
static uint32_t exponent_bit(float v)
{
    return 1u << (hf_bits(v < 0x1p120f ? v : 0x1p120f) >> 26);
}

void hf_scatter_note_c(const float *radius, float *const colour[4], int channels, int n, struct hf_counts *counts)
{
    for (int x = 0; x < n; x++) {
        counts->transparent += channels == 4 && colour[3][x] != 1;
        for (int c = 0; c < channels && radius[x] != 0; c++) {
            const float v = __builtin_fabsf(colour[c][x]);
            float *largest = &counts->largest[c == 3];
            *largest = v > *largest ? v : *largest;
            if (v > 0)
                counts->exponents[c == 3] |= exponent_bit(v);
        }
    }
}

// Note the brightness of a row of samples behind the first.
static void note_backs(const struct hf_frame *f, const struct hf_backs *b, int n)
{
    float *colour[4], *radius = hf_line(f, 12);
    int count = 0;
    for (int c = 0; c < 4; c++)
        colour[c] = hf_line(f, 8 + c);
    for (int x = hf_edges_next(b->share, 0, n); x < n; x = hf_edges_next(b->share, x + 1, n)) {
        radius[count] = b->radius[x];
        for (int c = 0; c < f->s->channels; c++)
            colour[c][count] = b->colour[c][x];
        count++;
    }
    hf_scatter_kernels(f)->note(radius, colour, f->s->channels, count, f->counts);
}

// Load the colour and radius of each pixel that a tile reads; for mixed pixels those of both sides. Note how bright the
// pixels that will be drawn can be.
void hf_scatter_prepare_c(const struct hf_frame *f, struct hf_rect r)
{
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, f->s->width) - x0, may_mix = hf_scatter(f->s)->mixed;
    struct hf_edges e;
    if (may_mix)
        hf_edges_start(&e, f, r, f->work);
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++) {
        struct hf_sides row = {.radius = {hf_at(&f->buf[HF_BUF_RADIUS], 0, x0, y)}};
        hf_row(&f->buf[HF_BUF_SOURCE], f->s->channels, x0, y, row.colour[0]);
        if (may_mix) {
            hf_row(&f->buf[HF_BUF_BACK], f->s->channels, x0, y, row.colour[1]);
            row.share = hf_at(&f->buf[HF_BUF_BACK_AT], 0, x0, y);
            row.radius[1] = hf_at(&f->buf[HF_BUF_BACK_AT], 1, x0, y);
            hf_edges_row(&e, y, &row);
            hf_scatter_know_edges(f, x0, y, n, &row);
        } else {
            hf_read_pixels(f, r.x0, y, r.x1 - r.x0, row.colour[0], f->seen);
            f->k->radius_row(f, x0, y, n, row.radius[0], NULL);
        }
        hf_scatter_know(f, x0, y, n, &row);
        for (int i = 0; i < HF_BACKS; i++) {
            struct hf_backs b;
            if (hf_scatter_backs(f, i, x0, y, &b))
                note_backs(f, &b, n);
        }
        hf_scatter_kernels(f)->note(row.radius[0], row.colour[0], f->s->channels, n, f->counts);
    }
}

// The part, 0 to 1, of a disc's area on this side of a line d radii from its centre: within 0.002, and exact at the
// ends.
static float segment(float d)
{
    const float t = d < 1 ? d : 1, q = t * t;
    return 0.5f + t * (0.63662f + q * (-0.10610f - q * 0.03052f));
}

// The part of the sprite around a near pixel that lies inside the frame. Its sum of weights cannot be larger.
static float inside(const struct hf_setup *s, float reach_x, float reach_y, int x, int y)
{
    const float ix = 1 / reach_x, iy = 1 / reach_y;
    const float left = ((float)x + 0.5f) * ix, right = (((float)s->width - (float)x) - 0.5f) * ix;
    const float above = ((float)y + 0.5f) * iy, below = ((float)(s->height - y) - 0.5f) * iy;
    return ((segment(left) + segment(right)) - 1) * ((segment(above) + segment(below)) - 1);
}

// Composite one sample: far field, then the pixel itself, then the near field. The visible part of a near pixel belongs
// to what covers, so the background shows through neither. Nobody has seen that background; where far sprites hardly
// reach, the near field hides it.
static float composite_sample(const struct hf_scatter *t, float own, float show, float cover, int is_near,
                              const float far[2], const float near[2], const float *behind)
{
    const float front = hf_field_colour(t, own, near[0], near[1]);
    float v = hf_field_colour(t, own, far[0], far[1]);
    if (is_near) {
        const float left = 1 - cover;
        v = behind ? *behind : hf_scatter_mix(front, v, hf_saturate(16 * far[1]));
        show = show < left ? show / left : 1;
    }
    v = hf_scatter_mix(own, v, 1 - show);
    return near[1] > 0 ? hf_scatter_mix(v, front, cover) : v;
}

void hf_scatter_blend_c(const struct hf_scatter_row *row, float *out)
{
    const struct hf_scatter *t = hf_scatter(row->setup);
    for (int x = 0; x < row->n; x++) {
        const float far[2] = {row->far ? row->far[x] : 0, row->far ? row->far_weight[x] : 0};
        const float near[2] = {row->near ? row->near[x] : 0, row->near ? row->near_weight[x] : 0};
        const float r = row->radius[x], size = __builtin_fabsf(r), reach_x = size * t->aperture.key.scale_x;
        const int at = row->column ? (int)row->column[x] : row->x + x;
        const float cover = r < 0 ? near[1] / inside(row->setup, reach_x, size, at, row->y) : near[1];
        const float own = out[x] * t->dim;
        float v = composite_sample(t, own, hf_own_part(t, size), cover, r < 0, far, near,
                                   row->behind ? &row->behind[x] : NULL);
        v = v < t->most ? v : t->most;
        v = v > -t->most ? v : -t->most;
        // Denormal values may have lost bits.
        out[x] = v == own ? out[x] : v * t->undim;
    }
}

// Set a row's pointers to channel c of the fields.
static void set_fields(const struct hf_frame *f, int c, struct hf_scatter_row *row)
{
    const struct hf_scatter *t = hf_scatter(f->s);
    const int group = t->opaque ? 0 : t->group_of[c];
    if (f->far) {
        row->far_weight = hf_at(&f->buf[HF_BUF_FAR_WEIGHT], group, row->x, row->y);
        row->far = hf_at(&f->buf[HF_BUF_FAR_SUM], c, row->x, row->y);
    }
    if (f->near) {
        row->near_weight = hf_at(&f->buf[HF_BUF_NEAR_WEIGHT], group, row->x, row->y);
        row->near = hf_at(&f->buf[HF_BUF_NEAR_SUM], c, row->x, row->y);
    }
}

// The mixed pixels of a row: their columns, and a compact row of only these.
struct backs {
    const float *share;  // of the row's pixels; NULL: none is mixed
    int count;
    int32_t *column;
    float *radius, *place;
};

static struct backs find_backs(const struct hf_frame *f, int x0, int y, int n)
{
    struct backs b = {.share = hf_back_shares(f, x0, y, n),
                      .column = (int32_t *)(void *)hf_line(f, 19),
                      .radius = hf_line(f, 20),
                      .place = hf_line(f, 21)};
    for (int x = hf_edges_next(b.share, 0, n); x < n; x = hf_edges_next(b.share, x + 1, n)) {
        b.radius[b.count] = *hf_at(&f->buf[HF_BUF_BACK_AT], 1, x0 + x, y);
        b.place[b.count] = (float)(x0 + x);
        b.column[b.count++] = x;
    }
    return b;
}

// Copy those columns of a row to line i.
static const float *pick(const struct hf_frame *f, const struct backs *b, const float *row, int i)
{
    float *out = hf_line(f, i);
    for (int k = 0; k < b->count && row; k++)
        out[k] = row[b->column[k]];
    return row ? out : NULL;
}

// Add what shows in the mixed pixels' backs, by their shares, in one channel.
static void add_backs(const struct hf_frame *f, const struct hf_scatter_row *pixels, const struct backs *b, int c,
                      const struct hf_scatter_behind *behind, float *out)
{
    struct hf_scatter_row row = *pixels;
    float *back = hf_line(f, 22);
    row.n = b->count;
    row.radius = b->radius;
    row.column = b->place;
    row.far = pick(f, b, row.far, 12);
    row.far_weight = pick(f, b, row.far_weight, 13);
    row.near = pick(f, b, row.near, 23);
    row.near_weight = pick(f, b, row.near_weight, 24);
    pick(f, b, hf_at(&f->buf[HF_BUF_BACK], c, row.x, row.y), 22);
    if (behind) {
        const float *const weight[2] = {pick(f, b, behind->weight[0], 0), pick(f, b, behind->weight[1], 1)};
        const float *const colour[2] = {pick(f, b, behind->colour[0], 2), pick(f, b, behind->colour[1], 3)};
        row.behind = hf_line(f, 18);
        hf_scatter_kernels(f)->behind_blend(&row, weight, colour, back, hf_line(f, 18));
    }
    hf_scatter_kernels(f)->blend(&row, back);
    for (int k = 0; k < b->count; k++) {
        const int x = b->column[k];
        out[x] = out[x] * (1 - b->share[x]) + back[k] * b->share[x];
    }
}

// behind: NULL if only far sprites show behind near pixels.
static void composite_row(const struct hf_frame *f, int y, struct hf_rect r, const struct hf_behind *behind)
{
    const struct hf_setup *s = f->s;
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, s->width) - x0, channels = hf_scatter(s)->opaque ? 3 : s->channels;
    float *out[4];
    for (int c = 0; c < 4; c++)
        out[c] = hf_line(f, 8 + c);
    hf_read_pixels(f, r.x0, y, r.x1 - r.x0, out, f->counts);
    const struct backs backs = find_backs(f, x0, y, n);
    const struct hf_scatter_row pixels = {
        .setup = s, .x = x0, .y = y, .n = n, .radius = hf_at(&f->buf[HF_BUF_RADIUS], 0, x0, y)};
    const struct hf_scatter_behind line = {.f = f,
                                           .behind = behind,
                                           .weight = {hf_line(f, 14), hf_line(f, 15)},
                                           .colour = {hf_line(f, 16), hf_line(f, 17)}};
    if (behind && !hf_scatter_behind_begin(&line, &pixels, backs.radius, backs.count))
        behind = NULL;
    // An alpha that is 1 everywhere stays 1.
    for (int c = 0; c < channels; c++) {
        const float *front = hf_at(&f->buf[HF_BUF_SOURCE], c, x0, y);
        struct hf_scatter_row row = pixels;
        set_fields(f, c, &row);
        for (int k = 0; k < backs.count; k++)
            out[c][backs.column[k]] = front[backs.column[k]];
        if (behind) {
            row.behind = hf_line(f, 18);
            hf_scatter_behind_row(&line, &row, c, out[c], hf_line(f, 18));
            hf_scatter_known_row(f, &row, c, hf_line(f, 18));
        }
        hf_scatter_kernels(f)->blend(&row, out[c]);
        if (backs.count)
            add_backs(f, &row, &backs, c, behind ? &line : NULL, out[c]);
    }
    hf_write_pixels(f, r.x0, y, r.x1 - r.x0, (const float *const *)out, s->channels == 4);
}

void hf_scatter_composite_c(const struct hf_frame *f, struct hf_rect r)
{
    const int levels = f->near ? hf_scatter(f->s)->behind : 0;
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y += HF_BEHIND_BLOCK)
        for (int x = r.x0; x < r.x1 && !hf_stopped(f->s->stop); x += HF_BEHIND_BLOCK) {
            const struct hf_rect block = {x, y, hf_min(x + HF_BEHIND_BLOCK, r.x1), hf_min(y + HF_BEHIND_BLOCK, r.y1)};
            struct hf_behind behind = {.planes =
                                           hf_scatter_behind_planes(hf_scatter(f->s)->opaque ? 3 : f->s->channels)};
            // What is known shows also where nothing is visible to guess from: `behind` is 0 there.
            const int is = levels && (hf_behind_make(&behind, &hf_scatter_behind_source, f, block, levels, f->work) ||
                                      hf_scatter(f->s)->given);
            for (int row = 2 * block.y0; row < hf_min(2 * block.y1, f->s->height) && !hf_stopped(f->s->stop); row++)
                composite_row(f, row, block, is ? &behind : NULL);
        }
}
