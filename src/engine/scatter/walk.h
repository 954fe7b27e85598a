// SPDX-License-Identifier: BSD-3-Clause
// What the parts of the scatter's walk share: walk.c goes over a window, tent.c makes the half-resolution sources, and
// source.c draws what they list.
#ifndef HF_WALK_H
#define HF_WALK_H

#include "pixel/edges.h"
#include "pixel/pass_c.h"
#include "engine/scatter/kernels.h"

struct hf_backs;

enum { TOGETHER = 4 };  // rows of full-resolution sources drawn together

// A slice of radii: sources from begin[1] to end[0] belong to it fully, those from begin[0] and up to end[1] in part.
struct hf_scatter_slice {
    int whole;  // all radii belong to it; the other members are unset
    float begin[2], end[2];
};

// One group's sums on a window.
struct hf_target {
    float *ch[4];
    ptrdiff_t stride;
};

// A walk over a window: the sums of one field, group and level.
struct walk {
    const struct hf_frame *f;
    const struct hf_scatter *t;
    const struct hf_splat_group *group;
    int field;                      // 0 near, 1 far
    int level;                      // 1: half resolution
    struct hf_sums sums;            // of the first bin
    const struct hf_bins *bins;     // of the group and level
    ptrdiff_t bin_lanes;            // distance from one bin's sums to the next
    struct hf_splats *list;         // of each bin
    int reached, drawn[HF_BINS];    // the last row that the sources at hand reach; the last row drawn in each bin
    struct hf_run *runs;            // scratch for a sprite that belongs to one source only
    struct hf_scatter_slice slice;  // the radii that are drawn
    float *source[TOGETHER][5];     // level 0: channels, weight, sprite numbers
    // Level 1, for the last rows: quads' weights, these times radii, source radii, and pixels; see hf_list_half.
    float *quad[2][4], *site[4], *tent[4][4], *pixel[2][4], *mean[5], *part[2], *nothing;
    int lone[4];
    int tent_x0, tent_x1, quads_done, sites_done,
        tents_done;  // half-resolution columns; rows up to which they are made
};

// How much of a source of radius r > 0 belongs to the slice.
static inline float hf_scatter_slice_part(const struct hf_scatter_slice *s, float r)
{
    if (s->whole)
        return 1;
    return hf_saturate((r - s->begin[0]) / (s->begin[1] - s->begin[0])) *
           (1 - hf_saturate((r - s->end[0]) / (s->end[1] - s->end[0])));
}

// How much of a back of radius r, with that share of its pixel, the walk draws.
static inline float hf_back_weight(const struct walk *w, float r, float share)
{
    const float half = hf_half_part(w->t, r);
    return hf_field_weight(w->t, r) * (w->level ? half : 1 - half) * share * hf_scatter_slice_part(&w->slice, r);
}

// The columns x0 to x1 of sources that reach the window.
static inline void hf_walk_columns(const struct walk *w, int *x0, int *x1)
{
    const int reach = w->t->reach_x[w->field][w->level];
    *x0 = hf_max(w->sums.x0 - reach, 0);
    *x1 = hf_min(w->sums.x1 + reach, w->level ? w->f->s->half_width : w->f->s->width);
}

// a + t (b - a), but exactly b's bits from t = 1 on and a's at 0: beside a highlight b would lose them.
static inline float hf_scatter_mix(float a, float b, float t)
{
    return t < 1 ? hf_lerp(a, b, t) : b;
}

// A field's colour from its sums. Where sprites may leave their own pixels out, weights can be as small as sprites' rims are
// thin: there the pixel's own colour takes over gradually. It begins without a corner, because it may be a lamp's in the
// dark, and a weight changes with every size of a sprite.
static inline float hf_field_colour(const struct hf_scatter *t, float own, float sum, float weight)
{
    if (!(weight > 0))
        return own;
    return hf_scatter_mix(own, sum / weight, hf_smoothstep(hf_saturate(weight * t->trust)));
}

// The neighbour, on one axis, of a pixel's half-resolution pixel that its tent reaches.
static inline int hf_beside(int pixel, int count)
{
    const int q = (pixel >> 1) + (pixel & 1 ? 1 : -1);
    return q < 0 ? 0 : q >= count ? count - 1 : q;
}

// Shares of the backs of n pixels from (x, y) on; NULL if there are none.
const float *hf_back_shares(const struct hf_frame *f, int x, int y, int n);
// Add sources `from` to `to` of a row to the list; a full list is drawn.
void hf_list_sources(struct walk *w, const struct hf_source_row *row, int from, int to);
// Add one source, its colour already weighted. r: radius of its sprite.
void hf_add_source(struct walk *w, int x, int y, float r, const float colour[3], float weight);
// Draw a part of sample x of a row (known.h) on pixel (to_x, to_y) of the level, if it belongs to the walk's field.
void hf_add_back(struct walk *w, const struct hf_backs *b, int x, int to_x, int to_y, float part);
// Draw the list.
void hf_flush_sources(struct walk *w);

// Slice k of the far field, and the range of far radii that reach the window r.
struct hf_scatter_slice hf_scatter_slice_make(const struct hf_scatter *t, int k);
void hf_scatter_slice_range(const struct hf_frame *f, struct hf_rect r, float *least, float *most);
// Composite a slice behind the slices in front of it.
void hf_scatter_slice_behind(const struct hf_frame *f, struct hf_rect r, const struct hf_target *to,
                             const struct hf_target *slice);

// For a window of that width: columns of means, floats of a line, and number of lines.
int hf_tent_columns(const struct hf_scatter *t, int field, int width);
enum { HF_TENT_LINES = 8 + 4 + 16 + 8 + 5 + 2 };
// Place those lines, each with HF_PAD floats before and after it. Call before the first hf_list_half of a window.
void hf_tent_start(struct walk *w, float *memory, int length);
// Add the sources of half-resolution row q.
void hf_list_half(struct walk *w, int q);

#endif
