// SPDX-License-Identifier: BSD-3-Clause
// What the files of the layers reference share.
#ifndef HF_TESTS_LAYERS_REFERENCE_PARTS_H
#define HF_TESTS_LAYERS_REFERENCE_PARTS_H

#include <stdlib.h>

#include "support/layers_reference.h"

// n values for each place from (x0, y0) up to (x1, y1).
struct grid {
    int x0, y0, x1, y1, n;
    double *v;
};

static inline struct grid grid_new(int x0, int y0, int x1, int y1, int n)
{
    struct grid g = {x0, y0, x1, y1, n, NULL};
    g.v = calloc((size_t)(x1 - x0) * (size_t)(y1 - y0) * (size_t)n + 1, sizeof *g.v);
    if (!g.v)
        abort();
    return g;
}

static inline double *at(const struct grid *g, int x, int y)
{
    return g->v + ((size_t)(y - g->y0) * (size_t)(g->x1 - g->x0) + (size_t)(x - g->x0)) * (size_t)g->n;
}

static inline int clamp(int v, int low, int high)
{
    return v < low ? low : v > high ? high : v;
}

// Beyond the frame its edges are repeated.
static inline double *edge(const struct grid *g, int x, int y)
{
    return at(g, clamp(x, g->x0, g->x1 - 1), clamp(y, g->y0, g->y1 - 1));
}

// A sample: colour, weight, radius; for visible samples also the share of their weight that is a highlight.
enum { WEIGHT = 4, RADIUS, SHARE, SAMPLE };
// Around the levels' grids, so that upsampling has neighbours.
enum { MARGIN = 8 };
// What is bright in a square of so many pixels, on one side of the focus, is one lamp.
enum { LAYERS_REFERENCE_SQUARE = 8 };

struct slice {
    double before, own, after;
    double hidden[2];  // radii before and after for hidden samples; equal: the slice has none
};

enum kind { SEEN, BEHIND, SHINE };

struct frame {
    const struct picture *colour;
    const float *radius;
    int width, height, channels;
    struct hf_layers_params set;
    struct hf_aperture_params aperture;
    int fine, unmix, hidden, highlights, patterns;
    double wide, half, quarter, low, high;
    double shift;                             // relative change of the radius behind the focus (chromatic aberration)
    int turned;                               // in front of the focus: the aperture by half a turn
    const int *square;                        // column and row of the square whose shares alone are drawn, or NULL
    int plane;                                // channel of a coloured aperture picture
    struct grid seen, mixed, behind, beyond;  // samples
};

static inline double colour_at(const struct frame *f, int c, int x, int y)
{
    return f->colour->plane[c][clamp(y, 0, f->height - 1) * f->width + clamp(x, 0, f->width - 1)];
}

static inline double radius_at(const struct frame *f, int x, int y)
{
    return f->radius[clamp(y, 0, f->height - 1) * f->width + clamp(x, 0, f->width - 1)];
}

// A run of a row, in pixels from the middle of the shape's pixel. Its weight is the part of the row's height that it
// covers.
struct layers_run {
    double a, b, weight;
    double top, low;  // the heights between which its outline covers the row, from the row's middle
};

// A shape of radius r: weights of (2 reach + 1)^2 pixels that sum to 1, and the three runs of each row.
struct layers_shape {
    double r;
    int reach;
    double *weight;
    struct layers_run *run;
};

// (layers_reference_shape.c)
struct layers_shape layers_shape_new(const struct frame *f, double r);
void layers_shape_free(struct layers_shape *s);
// Keep the weights within a circle of radius r (INFINITY: all) around (x, y); if nothing is left, only the pixel
// itself.
void layers_shape_cut(const struct frame *f, struct layers_shape *s, double x, double y, double r);

// How far a surface hides another that is `behind` farther: not at all at a pixel of radius, completely at one and a
// half.
static inline double layers_reference_hides(double behind)
{
    return fmin(fmax(2 * (behind - 1), 0), 1);
}

// From which radius on a pixel hides: its front's, but a front that is hardly there comes nearer to its back the less it is.
double layers_reference_hides_from(const struct frame *f, int x, int y);
// Fill in f's samples: visible, mixed and hidden ones (layers_reference_samples.c).
void layers_reference_samples(struct frame *f);
// Merge samples that are about as far as the farthest of them.
void layers_reference_merge(const double *const *from, int count, double within, double part, int channels,
                            double *out);
// Set the colours (roots) of hidden samples by patterns, from those of quads (layers_reference_patterns.c).
void layers_reference_patterns(const struct frame *f, const struct grid *quads, struct grid *hidden);
// At how many distances hidden samples are looked for.
// How much of a pixel lies before a radius: of what is seen, and of what is behind a mixed edge.
double layers_reference_before(const struct frame *f, int x, int y, double radius);
int layers_reference_levels(const struct frame *f);

// (layers_reference.c)
int layers_reference_level_of(const struct frame *f, double r);
double layers_reference_shared(const struct frame *f, double r);
double layers_reference_part_of(const struct slice *s, double r);
// Add the samples of a set that belong to a slice to the sources of a level, `apart` times half the resolution of theirs. light:
// without their shares. quads: the samples of quads, as those of pixels.
void layers_reference_add(const struct frame *f, const struct slice *s, const struct grid *set, int apart,
                          enum kind kind, int light, int quads, struct grid *to);
// A slice's sums of one kind at a level.
struct grid layers_reference_draw(const struct frame *f, const struct slice *s, int level, enum kind kind, int light);
// The value of a grid at a place of the next finer level.
double layers_reference_up(const struct grid *g, int c, int x, int y);

// The highlights of slices `from` to `end`, which lie on one side of the focus, as far as all that is nearer and has no full
// resolution leaves them: colours, weight, and the weight if nothing were before them (layers_reference_lights.c). lift: the factor for those of the first slice behind the focus, or NULL.
struct grid layers_reference_lights(const struct frame *f, const struct slice *s, int count, int from, int end,
                                    const struct grid *lift);

#endif
