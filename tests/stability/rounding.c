// SPDX-License-Identifier: BSD-3-Clause
// Each engine against itself in double precision; long rows and large radii.
#include "stability/stability.h"

#include <float.h>

#include "support/check.h"
#include "support/reference.h"
#include "support/reference_hexagon.h"
#include "support/scatter_reference.h"

static const double U = FLT_EPSILON / 2;

// The largest sample around a pixel, within the distance that its result comes from.
static double local_largest(const struct picture *p, int c, int x, int y, int reach)
{
    double most = 0;
    for (int j = y - reach; j <= y + reach; j++)
        for (int i = x - reach; i <= x + reach; i++)
            if (i >= 0 && j >= 0 && i < p->width && j < p->height)
                most = fmax(most, fabs((double)p->plane[c][j * p->width + i]));
    return most;
}

// Returns 1 and the picture in double precision, or 0 if there is no such reference.
static int reference_of(const struct run *r, const struct scene *s, const struct hf_depth *depth, struct picture *want)
{
    const struct hf_params *p = &r->subject->params;
    if (p->engine == HF_ENGINE_GATHER || p->engine == HF_ENGINE_CHAPTER) {
        struct reference *ref = reference_render(&s->colour, depth, p, NULL, NULL);
        *want = reference_picture(ref);
        reference_free(ref);
        return 1;
    }
    if (p->engine == HF_ENGINE_HEXAGON) {
        *want = hexagon_reference(&s->colour, &s->depth, p);
        return 1;
    }
    if (p->engine == HF_ENGINE_SCATTER && p->scatter.resolution == HF_RESOLUTION_FULL) {
        *want = scatter_reference(&s->colour, s->depth.plane[0]);
        return 1;
    }
    return 0;
}

static void against_double(const struct run *r)
{
    for (unsigned i = 0; i < (r->full ? 8u : 2u); i++) {
        struct rng rng = rng_seed(r->seed + i);
        struct scene s = scene_new(&rng, i % 2 ? SCENE_HIGHLIGHTS : SCENE_BLOCKS, 60, 44, 3);
        for (size_t k = 0; k < samples_of(&s.depth); k++) {
            const float z = s.depth.plane[0][k];
            s.depth.plane[0][k] = STABILITY_RADIUS * fmaxf(-1, fminf(1, (z - STABILITY_FOCUS) / STABILITY_RANGE));
            if (!isfinite(z))
                s.depth.plane[0][k] = STABILITY_RADIUS;
        }
        const struct hf_depth depth = picture_radii(&s.depth);
        struct picture want, out;
        if (!reference_of(r, &s, &depth, &want)) {
            scene_free(&s);
            return;
        }
        out = render(r->c, &s.colour, &depth, &r->subject->params);
        double worst = 0, squares = 0;
        const int step = r->full ? 1 : 3;
        int n = 0;
        for (int c = 0; c < 3; c++)
            for (int k = (int)i % step; k < 60 * 44; k += step, n++) {
                const double local = local_largest(&s.colour, c, k % 60, k / 60, r->subject->margin);
                const double e =
                    fabs((double)out.plane[c][k] - want.plane[c][k]) / (local > 0 ? local : 1) / FLT_EPSILON;
                worst = worse(worst, e);
                squares += e * e;
            }
        see(r, "rounding: largest error, units in the last place of the local maximum",
            "half a unit for each rounding on the way of a sample", worst, r->subject->roundings / 2,
            "scene %u, rms %.2g", i, sqrt(squares / n));
        picture_free(&out);
        picture_free(&want);
        scene_free(&s);
    }
}

// Half units by which the gather's area sums may change a constant, with kernels as large as the radius: h
// half-resolution pixels. A sample is rounded once with its pair on the other side of a row, h + 1 times as pairs of
// the row are added, and 2 h + 1 times as rows are. The samples of a constant are equal, so their roundings are too,
// all up or all down: they add up. The sums of weights are rounded at most as often, and not at all where samples count
// fully.
static double area_sums(const struct run *r, double radius)
{
    const struct hf_params *p = &r->subject->params;
    const int by_area = p->engine == HF_ENGINE_GATHER && !p->gather.per_pixel_kernel;
    const double h = ceil(radius / 2);
    return by_area ? 2 * (1 + (h + 1) + (2 * h + 1)) : 0;
}

// A constant in a row of 16384 pixels with a radius of 500: sums that drift would show it.
static void long_rows(const struct run *r)
{
    const int w = r->full ? 16384 : 4096, h = 5;
    const float radius = r->full ? 500 : 200;
    struct picture colour = picture_new(w, h, 3), radii = picture_new(w, h, 1);
    for (int i = 0; i < w * h; i++)
        radii.plane[0][i] = radius * (float)((i / 97) % 3 - 1);
    for (int c = 0; c < 3; c++)
        picture_fill(&colour, c, 0.7f);
    struct hf_params p = r->subject->params;
    p.max_radius = radius;
    const struct hf_depth depth = picture_radii(&radii);
    struct picture out = render(r->c, &colour, &depth, &p);
    const double sums = area_sums(r, radius);
    see(r, "long rows, large radii: relative error of a constant",
        sums > 0 ? "that of short rows, and half a unit for each sum of the kernel that a sample goes through"
                 : "that of short rows: errors do not add up",
        largest_difference(&out, &colour) / 0.7, (r->subject->constant + sums) * U, "%d pixels, radius %g", w, radius);
    picture_free(&out);
    picture_free(&colour);
    picture_free(&radii);
}

void rounding_cases(const struct run *r)
{
    if (r->subject->promises & EXACT) {
        against_double(r);
        if (r->full || r->isa != HF_ISA_SCALAR)
            long_rows(r);
    }
}
