// SPDX-License-Identifier: BSD-3-Clause
// Properties that blur must preserve, and pairs of pictures whose results must be related.
#include "stability/stability.h"

#include <float.h>
#include <string.h>

#include "support/check.h"

static const double U = FLT_EPSILON / 2;

// The relative error that a sample may have: roundings, and six steps of the storage (read, down, gathered, filled,
// merged, written).
static double relative(const struct subject *s, double roundings)
{
    return roundings * U + 6 * s->step;
}

static const char *const from_roundings = "roundings on the way of a sample, and the storage's steps";

// How far samples lie outside 0 to `value`, relative to it.
static double beyond_zero(const struct picture *p, double value)
{
    double beyond = 0;
    for (int c = 0; c < p->channels; c++)
        for (size_t i = 0; i < samples_of(p); i++)
            beyond = worse(beyond, fmax(p->plane[c][i] / value - 1, -p->plane[c][i] / value));
    return beyond;
}

static void constants(const struct run *r)
{
    static const float values[] = {1, 0.1f, 1.0f / 3, 7.77f, 60000, 1e-3f, -3.3f, 1e-30f, 1e30f};
    const int narrow = !(r->subject->promises & EXACT);
    for (int v = 0; v < (narrow ? 5 : 9); v++) {
        struct scene s = calm_scene(r->seed + (unsigned)v, 65, 47, 4);
        for (int c = 0; c < 4; c++)
            picture_fill(&s.colour, c, values[v]);
        struct picture out = render_scene(r->c, &s, &r->subject->params);
        const double bound = relative(r->subject, r->subject->constant);
        if (r->subject->params.chapter.faithful)
            see(r, "constant in: how far beyond it and 0, relative",
                "the demo takes what holds no far colour for black, and the largest of that and a negative number",
                beyond_zero(&out, values[v]), bound, "%g", values[v]);
        else
            see(r, "constant in, constant out: relative error", "roundings that do not cancel, and the storage's steps",
                largest_difference(&out, &s.colour) / fabs(values[v]), bound, "%g", values[v]);
        picture_free(&out);
        scene_free(&s);
    }
}

// ---- one highlight, one radius everywhere ----

enum { SPOT = 96 };

// How far a highlight may differ from its transpose, relative to its energy. A disc is made of rows. In a row the
// outline falls from 1 inside to 0 outside over a length l; the engine draws a step at its mean, which is off by at
// most l / 2. The lengths of a quarter's rows add up to the radius: 4 r / 2 of an area of pi r^2, and twice that for
// both pictures. At half resolution r is half as large; upsampling adds nothing. Rows are whole 128ths of a pixel high
// and 256ths wide: each is off by at most (1 / 256 + 2 / 512) of itself, in both.
static void turned_disc(const struct run *r, const struct picture *out, float radius, int x, int y)
{
    const double size = radius < 0 ? -radius : radius, half = r->subject->params.scatter.resolution ? 2 : 1;
    double off = 0, sum = 0;
    for (int j = -40; j <= 40; j++)
        for (int i = -40; i <= 40; i++) {
            const double v = out->plane[1][(y + j) * SPOT + x + i];
            off += fabs(v - out->plane[1][(y + i) * SPOT + x + j]);
            sum += v;
        }
    see(r, "a disc and its transpose: difference, of its energy", "what rows are off by along its outline", off / sum,
        half * 4 / (M_PI * size) + 2.0 / 128, "radius %g at (%d, %d)", radius, x, y);
}

static void highlight(const struct run *r, float radius, int x, int y)
{
    struct picture colour = picture_new(SPOT, SPOT, 3), radii = picture_new(SPOT, SPOT, 1);
    picture_fill(&radii, 0, radius);
    for (int c = 0; c < 3; c++)
        colour.plane[c][y * SPOT + x] = 1e4f;
    const struct hf_depth depth = picture_radii(&radii);
    struct picture out = render(r->c, &colour, &depth, &r->subject->params);
    double sum = 0, sx = 0, sy = 0;
    for (int i = 0; i < SPOT * SPOT; i++) {
        sum += out.plane[1][i];
        sx += out.plane[1][i] * (i % SPOT);
        sy += out.plane[1][i] * (double)(i / SPOT);
    }
    if (r->subject->promises & KEEPS_ENERGY)
        see(r, "energy of a highlight: error", "1e-5, as the design says", fabs(sum / 1e4 - 1), 1e-5,
            "radius %g at (%d, %d)", radius, x, y);
    else
        see(r, "energy of a highlight, times", "a maximum over 3 x 3 can take each share nine times", sum / 1e4, 9,
            "radius %g at (%d, %d)", radius, x, y);
    const double off = fmax(fabs(sx / sum - x), fabs(sy / sum - y));
    if (r->subject->promises & KEEPS_CENTRE)
        see(r, "centre of a highlight: off, pixels", "a thousandth", off, 1e-3, "radius %g at (%d, %d)", radius, x, y);
    else
        see(r, "centre of a highlight, half resolution: off, pixels",
            "the middle of its quad is half a pixel away, and a thousandth; faithful takes the next quad's", off,
            r->subject->params.chapter.faithful ? 1.001 : 0.501, "radius %g at (%d, %d)", radius, x, y);
    if (r->subject->params.engine == HF_ENGINE_SCATTER && (x - y) % 2 == 0)
        turned_disc(r, &out, radius, x, y);
    picture_free(&out);
    picture_free(&colour);
    picture_free(&radii);
}

static void highlights(const struct run *r)
{
    // In gather, chapter and gaussian, radii below the largest are blends with the picture.
    static const float radii[] = {12, -12, 0.3f, -0.7f, 1, 1.9f, -3, 6.5f, 9};
    const enum hf_engine engine = r->subject->params.engine;
    const int blends = engine == HF_ENGINE_GATHER || engine == HF_ENGINE_CHAPTER || engine == HF_ENGINE_GAUSSIAN;
    for (int i = 0; i < (blends ? 2 : 9); i++)
        for (int k = 0; k < 4; k++)
            highlight(r, radii[i], 47 + k % 2, 46 + k / 2);
}

// ---- range and opacity ----

// Whether the demo upsamples the far field at a pixel from a quad whose first pixel is not far.
static int takes_black(const struct picture *depth, int pixel)
{
    for (int i = 0; i < 4; i++) {
        const int x = (pixel % depth->width + i % 2) / 2, y = (pixel / depth->width + i / 2) / 2;
        const int x0 = 2 * x < depth->width ? 2 * x : 2 * x - 2, y0 = 2 * y < depth->height ? 2 * y : 2 * y - 2;
        if (!(depth->plane[0][y0 * depth->width + x0] > STABILITY_FOCUS))
            return 1;
    }
    return 0;
}

static void bounds(const struct run *r)
{
    for (unsigned i = 0; i < 4; i++) {
        struct rng rng = rng_seed(r->seed + i);
        struct scene s = scene_new(&rng, i % 2 ? SCENE_HIGHLIGHTS : SCENE_BLOCKS, 75, 52, 4);
        picture_fill(&s.colour, 3, 1);
        struct picture out = render_scene(r->c, &s, &r->subject->params);
        double beyond = 0;
        for (int c = 0; c < 3; c++) {
            double low = INFINITY, high = -INFINITY;
            for (size_t k = 0; k < samples_of(&out); k++) {
                low = fmin(low, s.colour.plane[c][k]);
                high = fmax(high, s.colour.plane[c][k]);
            }
            for (size_t k = 0; k < samples_of(&out); k++)
                beyond = worse(beyond, fmax(out.plane[c][k] - high, low - out.plane[c][k]) / high);
        }
        see(r, "range of the sources: beyond it, of the largest", from_roundings, beyond,
            relative(r->subject, r->subject->roundings), "scene %u", i);
        const int faithful = r->subject->params.chapter.faithful;
        int thin = 0;
        for (size_t k = 0; k < samples_of(&out); k++)
            thin += out.plane[3][k] != 1 && !(faithful && takes_black(&s.depth, (int)k));
        see(r,
            faithful ? "opaque: samples of alpha that are not 1, but beside quads that are not far"
                     : "opaque: samples of alpha that are not 1",
            faithful ? "none may be; the demo takes those quads for black and clear" : "none may be", thin, 0,
            "scene %u", i);
        picture_free(&out);
        scene_free(&s);
    }
}

// ---- pairs ----

static void crops(const struct run *r)
{
    for (unsigned i = 0; i < 3; i++) {
        struct scene s = calm_scene(r->seed + i, 210, 170, 3);
        // A bright spot outside the crop.
        for (int c = 0; c < 3; c++)
            s.colour.plane[c][2 * 210 + 200] = i ? 300 : 1;
        const int x0 = 4 * (int)(1 + i), y0 = 4 * (int)(3 + i), w = 150 - (int)i, h = 130 - (int)i,
                  m = r->subject->margin;
        struct scene part = {picture_cut(&s.colour, x0, y0, w, h), picture_cut(&s.depth, x0, y0, w, h)};
        struct picture whole = render_scene(r->c, &s, &r->subject->params);
        struct picture a = render_scene(r->c, &part, &r->subject->params);
        struct picture want = picture_cut(&whole, x0 + m, y0 + m, w - 2 * m, h - 2 * m);
        struct picture got = picture_cut(&a, m, m, w - 2 * m, h - 2 * m);
        see(r,
            i ? "crops, a light outside: samples that are not the whole's bits"
              : "crops: samples that are not the whole's bits",
            "none may be", samples_other(&want, &got), 0, "from (%d, %d)", x0, y0);
        picture_free(&whole);
        picture_free(&a);
        picture_free(&want);
        picture_free(&got);
        scene_free(&part);
        scene_free(&s);
    }
}

static void quads(struct picture *depth)
{
    for (int y = 0; y < depth->height; y++)
        for (int x = 0; x < depth->width; x++)
            depth->plane[0][y * depth->width + x] = depth->plane[0][(y & ~1) * depth->width + (x & ~1)];
}

// Whether a pixel is near at most two pixels away, from where mixed pixels take their sides.
static int near_around(const struct picture *depth, int x, int y)
{
    for (int k = 0; k < 25; k++) {
        const int i = x + k % 5 - 2, j = y + k / 5 - 2;
        if (i >= 0 && j >= 0 && i < depth->width && j < depth->height &&
            depth->plane[0][j * depth->width + i] < STABILITY_FOCUS)
            return 1;
    }
    return 0;
}

// Count the samples of two pictures that differ in bits, near pixels left out; *compared: how many were compared.
static int others_not_near(const struct picture *a, const struct picture *b, const struct picture *depth, int *compared)
{
    int n = 0;
    *compared = 0;
    for (int y = 0; y < a->height; y++)
        for (int x = 0; x < a->width; x++) {
            const size_t i = (size_t)(y * a->width + x);
            if (near_around(depth, x, y))
                continue;
            *compared += a->channels;
            for (int c = 0; c < a->channels; c++)
                n += memcmp(&a->plane[c][i], &b->plane[c][i], sizeof(float)) != 0;
        }
    return n;
}

// The background of near pixels is made of quads, counted from the left so that a crop has the bits of the whole. In
// the mirror of an odd width these are other quads, so near pixels that show some background are left out.
static void flips(const struct run *r)
{
    const int only_quads = (r->subject->promises & FLIPS_QUADS) != 0;
    for (unsigned i = 0; i < 3; i++) {
        const int width = only_quads ? 64 : 63 + (int)i;
        const int but_near = width % 2 && r->subject->promises & FLIPS_EVEN;
        struct scene s = calm_scene(r->seed + i, width, only_quads ? 48 : 47, 4);
        if (only_quads)
            quads(&s.depth);
        struct scene mirror = {picture_flipped(&s.colour), picture_flipped(&s.depth)};
        struct picture a = render_scene(r->c, &s, &r->subject->params);
        struct picture b = render_scene(r->c, &mirror, &r->subject->params), back = picture_flipped(&b);
        int compared, other = but_near ? others_not_near(&a, &back, &s.depth, &compared) : samples_other(&a, &back);
        if (but_near)
            see(r, "flips of odd widths: samples that are not the mirror's bits, but of near pixels", "none may be",
                other, 0, "scene %u, %d samples", i, compared);
        else
            see(r, "flips: samples that are not the mirror's bits", "none may be", other, 0, "scene %u", i);
        picture_free(&a);
        picture_free(&b);
        picture_free(&back);
        scene_free(&mirror);
        scene_free(&s);
    }
}

// A round aperture picture that is its own transpose.
static struct picture round_aperture(void)
{
    enum { SIZE = 16 };
    struct picture p = picture_new(SIZE, SIZE, 3);
    for (int i = 0; i < SIZE * SIZE; i++)
        for (int c = 0; c < 3; c++)
            p.plane[c][i] = hypot(i % SIZE - (SIZE - 1) / 2.0, i / SIZE - (SIZE - 1) / 2.0) < SIZE / 2.0;
    return p;
}

// The scatter's own disc is made of rows, so it is not symmetric: see turned_disc().
static void transposes(const struct run *r)
{
    struct picture aperture = round_aperture();
    const struct hf_image image = picture_image(&aperture);
    for (unsigned i = 0; i < 3; i++) {
        struct scene s = calm_scene(r->seed + i, 70, 52, 3);
        struct scene turned = {picture_transposed(&s.colour), picture_transposed(&s.depth)};
        struct hf_params p = r->subject->params;
        if (p.engine == HF_ENGINE_SCATTER)
            p.aperture.picture = &image;
        struct picture a = render_scene(r->c, &s, &p), b = render_scene(r->c, &turned, &p),
                       back = picture_transposed(&b);
        see(r, "transposes: difference, of the largest", "twice the roundings on the way of a sample",
            largest_difference(&a, &back) / largest_sample(&s.colour), 2 * relative(r->subject, r->subject->roundings),
            "scene %u", i);
        picture_free(&a);
        picture_free(&b);
        picture_free(&back);
        scene_free(&turned);
        scene_free(&s);
    }
    picture_free(&aperture);
}

static void permutations(const struct run *r)
{
    struct scene s = calm_scene(r->seed, 70, 52, 4), other = {picture_copy(&s.colour), picture_copy(&s.depth)};
    for (int c = 0; c < 3; c++)
        memcpy(other.colour.plane[c], s.colour.plane[(c + 1) % 3], samples_of(&s.colour) * sizeof(float));
    struct picture a = render_scene(r->c, &s, &r->subject->params), b = render_scene(r->c, &other, &r->subject->params);
    int n = 0;
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < samples_of(&a); i++)
            n += memcmp(&b.plane[c][i], &a.plane[(c + 1) % 3][i], sizeof(float)) != 0;
    see(r, "channels permuted: samples that are not the same bits", "none may be", n, 0, "R G B to G B R");
    picture_free(&a);
    picture_free(&b);
    scene_free(&other);
    scene_free(&s);
}

static void exposures(const struct run *r)
{
    static const int exponents[] = {-20, -3, 1, 12, 30};
    for (int i = 0; i < 5; i++) {
        struct scene s = calm_scene(r->seed, 70, 52, 3);
        struct picture a = render_scene(r->c, &s, &r->subject->params);
        const float scale = ldexpf(1, exponents[i]);
        for (int c = 0; c < 3; c++)
            for (size_t k = 0; k < samples_of(&a); k++) {
                a.plane[c][k] *= scale;
                s.colour.plane[c][k] *= scale;
            }
        struct picture b = render_scene(r->c, &s, &r->subject->params);
        see(r, "exposure by 2^k: samples that are not scaled exactly", "none may be", samples_other(&a, &b), 0,
            "k = %d", exponents[i]);
        picture_free(&a);
        picture_free(&b);
        scene_free(&s);
    }
}

// From near to far along both axes: 0.9 of the range on either side of the focus over 122 pixels. So radii of 3 x 3
// pixels differ by 4 * 2 * 0.9 * 12 / 122 = 0.71, and no pixel is mixed.
static void one_surface(struct scene *s)
{
    const int w = s->depth.width, steps = w + s->depth.height;
    for (int k = 0; k < w * s->depth.height; k++)
        s->depth.plane[0][k] =
            STABILITY_FOCUS + 0.9f * STABILITY_RANGE * (2 * (float)(k % w + k / w) / (float)steps - 1);
}

// Either only its near part, with the far part sharp, or one far radius.
static void one_radius(struct scene *s, int far)
{
    one_surface(s);
    for (int k = 0; k < s->depth.width * s->depth.height; k++)
        s->depth.plane[0][k] =
            far ? STABILITY_FOCUS + 0.9f * STABILITY_RANGE : fminf(s->depth.plane[0][k], STABILITY_FOCUS);
}

static void sums(const struct run *r)
{
    for (unsigned i = 0; i < 3; i++) {
        struct scene s = calm_scene(r->seed + i, 70, 52, 3);
        if (r->subject->promises & ADDS_ONE_SURFACE)
            one_surface(&s);
        if (r->subject->promises & ADDS_ONE_RADIUS)
            one_radius(&s, i % 2);
        struct scene t = {picture_new(70, 52, 3), picture_copy(&s.depth)};
        struct scene both = {picture_new(70, 52, 3), picture_copy(&s.depth)};
        struct rng rng = rng_seed(r->seed + 50 + i);
        for (int c = 0; c < 3; c++)
            for (size_t k = 0; k < samples_of(&s.colour); k++) {
                t.colour.plane[c][k] = rng_float(&rng);
                both.colour.plane[c][k] = s.colour.plane[c][k] + t.colour.plane[c][k];
            }
        struct picture a = render_scene(r->c, &s, &r->subject->params), b = render_scene(r->c, &t, &r->subject->params);
        struct picture want = render_scene(r->c, &both, &r->subject->params);
        double worst = 0;
        for (int c = 0; c < 3; c++)
            for (size_t k = 0; k < samples_of(&a); k++)
                worst = worse(worst, fabs((double)a.plane[c][k] + b.plane[c][k] - want.plane[c][k]));
        see(r, "sum of two pictures: difference, of the largest", "twice the roundings on the way of a sample",
            worst / largest_sample(&both.colour), 2 * relative(r->subject, r->subject->roundings), "scene %u", i);
        picture_free(&a);
        picture_free(&b);
        picture_free(&want);
        scene_free(&both);
        scene_free(&t);
        scene_free(&s);
    }
}

void invariance_cases(const struct run *r)
{
    const unsigned promises = r->subject->promises;
    constants(r);
    if (promises & EXACT)
        highlights(r);
    bounds(r);
    crops(r);
    if (promises & (FLIPS | FLIPS_QUADS))
        flips(r);
    if (promises & TRANSPOSES)
        transposes(r);
    if (promises & PERMUTES)
        permutations(r);
    if (promises & EXPOSES)
        exposures(r);
    if (promises & (ADDS | ADDS_ONE_SURFACE | ADDS_ONE_RADIUS))
        sums(r);
}
