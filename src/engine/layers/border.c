// SPDX-License-Identifier: BSD-3-Clause
// Samples beyond the frame. They repeat those at its edge, so a near pixel in a corner would be taken for an object as large as
// its own blur. A near sample counts beyond the frame only as far as its surface is seen to go on inside: a surface that is seen
// half its radius deep counts fully. At odd sizes the last column or row is doubled first, because quads need it.
#include <math.h>
#include <string.h>

#include "engine/layers/hidden.h"
#include "pixel/pass_c.h"

// Surfaces up to FROM pixels before the focus count fully, and are bound fully from twice that on: their blur reaches little.
#define FROM 2.0f
// The samples of a line of pixels: of the visible surfaces, and of those behind mixed ones.
struct line {
    const float *weight[2], *radius[2];
    ptrdiff_t step[2];
    int n;
};

// How much of pixel i may be the surface that has this radius at the edge: what is at least half as near may, and what is a
// quarter as near does not.
static float goes_on(const struct line *l, int i, float radius)
{
    float part = 0;
    for (int k = 0; k < 2; k++) {
        const float weight = l->weight[k][i * l->step[k]];
        if (weight > 0)
            part = part + weight * hf_saturate(4 * l->radius[k][i * l->step[k]] / radius - 1);
    }
    return part;
}

// How much a sample of that radius counts beyond the edge.
static float part_beyond(const struct line *l, float radius)
{
    const float near = hf_saturate((-radius - FROM) / FROM), reach = -radius;
    float open = 1, deep = 0;
    if (!(near > 0))
        return 1;
    for (int i = 0; i < l->n && (float)i < reach && open > 0; i++) {
        const float here = goes_on(l, i, radius);
        open = here < open ? here : open;
        deep = deep + open * hf_saturate(reach - (float)i);
    }
    return 1 - near * (1 - hf_saturate(2 * deep / reach));
}

// The parts of the visible and of the mixed sample of an edge pixel; dx and dy point inwards.
static void parts_of(const struct hf_frame *f, int x, int y, int dx, int dy, float part[2])
{
    static const int at[2] = {HF_LAYERS_BUF_SEEN_AT, HF_LAYERS_BUF_MIXED_AT};
    struct line l = {.n = dx ? f->s->width : f->s->height};
    for (int k = 0; k < 2; k++) {
        l.weight[k] = hf_at(&f->buf[at[k]], 0, x, y);
        l.radius[k] = hf_at(&f->buf[at[k]], 1, x, y);
        l.step[k] = dy * f->buf[at[k]].stride + dx;
    }
    for (int k = 0; k < 2; k++)
        part[k] = *l.weight[k] > 0 ? part_beyond(&l, *l.radius[k]) : 1;
}

// Set the weights of n samples of a row beyond the frame to parts of those of an edge pixel.
static void set_row(const struct hf_frame *f, int x, int y, int from_x, int from_y, int n, const float part[2])
{
    const struct hf_buf *seen = &f->buf[HF_LAYERS_BUF_SEEN_AT], *mixed = &f->buf[HF_LAYERS_BUF_MIXED_AT];
    const float weight = *hf_at(seen, 0, from_x, from_y) * part[0], share = *hf_at(seen, 2, from_x, from_y) * part[0],
                back = *hf_at(mixed, 0, from_x, from_y) * part[1];
    for (int i = 0; i < n; i++) {
        *hf_at(seen, 0, x + i, y) = weight;
        *hf_at(seen, 2, x + i, y) = share;
        *hf_at(mixed, 0, x + i, y) = back;
    }
}

// The corners beside pixel x of the first or last row, where it is the row's first or last.
static void set_corners(const struct hf_frame *f, int x, int edge, int from, int around, const float part[2])
{
    for (int right = 0; right < 2; right++) {
        float side[2];
        if (x != (right ? f->s->width - 1 : 0))
            continue;
        parts_of(f, x, edge, right ? -1 : 1, 0, side);
        const float both[2] = {part[0] * side[0], part[1] * side[1]};
        for (int y = from; y < from + around; y++)
            set_row(f, right ? 2 * f->s->half_width : -around, y, x, edge, around, both);
    }
}

// Rows beyond the upper (dy 1) or the lower edge (dy -1), with their corners. The first of them is made, and repeated.
static void set_rows(const struct hf_frame *f, struct hf_rect r, int dy, int around)
{
    const int edge = dy > 0 ? 0 : f->s->height - 1, from = dy > 0 ? -around : 2 * f->s->half_height,
              width = f->s->width, x0 = 2 * r.x0;
    for (int x = x0; x < hf_min(2 * r.x1, width) && !hf_stopped(f->s->stop); x++) {
        float part[2];
        parts_of(f, x, edge, 0, dy, part);
        set_row(f, x, from, x, edge, x == width - 1 ? 2 * f->s->half_width - x : 1, part);
        set_corners(f, x, edge, from, around, part);
    }
    static const int at[3][2] = {{HF_LAYERS_BUF_SEEN_AT, 0}, {HF_LAYERS_BUF_SEEN_AT, 2}, {HF_LAYERS_BUF_MIXED_AT, 0}};
    for (int i = 0; i < 3; i++)
        for (int y = from + 1; y < from + around && !hf_stopped(f->s->stop); y++)
            memcpy(hf_at(&f->buf[at[i][0]], at[i][1], x0, y), hf_at(&f->buf[at[i][0]], at[i][1], x0, from),
                   sizeof(float) * (size_t)(2 * (r.x1 - r.x0)));
}

void hf_layers_bound_border(const struct hf_frame *f, struct hf_rect r)
{
    const int width = f->s->width, around = hf_min(hf_layers(f->s)->around, HF_LAYERS_BORDER);
    float part[2];
    if (!(hf_layers(f->s)->nearest < -FROM))
        return;
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++) {
        if (r.x0 == 0) {
            parts_of(f, 0, y, 1, 0, part);
            set_row(f, -around, y, 0, y, around, part);
            if (y == f->s->height - 1 && f->s->height % 2)
                set_row(f, -around, y + 1, 0, y, around, part);
        }
        if (r.x1 == f->s->half_width) {
            parts_of(f, width - 1, y, -1, 0, part);
            set_row(f, 2 * f->s->half_width, y, width - 1, y, around, part);
            if (y == f->s->height - 1 && f->s->height % 2)
                set_row(f, 2 * f->s->half_width, y + 1, width - 1, y, around, part);
        }
    }
    if (r.y0 == 0)
        set_rows(f, r, 1, around);
    if (r.y1 == f->s->half_height)
        set_rows(f, r, -1, around);
}
