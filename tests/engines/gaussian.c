// SPDX-License-Identifier: BSD-3-Clause
// The gaussian engine against its formulas in double precision: blur, blend, autofocus, and that each parameter has an
// effect. Its hard cases are in gaussian_hard.c.
//
//     gaussian [seed]
//
// Tolerances count roundings, U = 2^-24 each at most, relative to the largest sample; they simply add up.
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/gaussian.h"
#include "support/reference.h"

static const double U = FLT_EPSILON / 2;
static unsigned seed = 1;

// ---- the engine in double precision ----

struct plane {
    int width, height;
    double *v;
};

static struct plane plane_new(int width, int height)
{
    struct plane p = {width, height, calloc((size_t)width * (size_t)height, sizeof(double))};
    if (!p.v)
        abort();
    return p;
}

static int clamped(int i, int n)
{
    return i < 0 ? 0 : i >= n ? n - 1 : i;
}

static double at(const struct plane *p, int x, int y)
{
    return p->v[clamped(y, p->height) * p->width + clamped(x, p->width)];
}

// One pass of the shader.
static void blur(struct plane *p, int dx, int dy, int faithful)
{
    static const double printed[5] = {.3, .15, .1, .15, .3}, mended[5] = {1, 4, 6, 4, 1};
    struct plane out = plane_new(p->width, p->height);
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++)
            for (int i = -2; i <= 2; i++)
                out.v[y * p->width + x] +=
                    (faithful ? printed[i + 2] : mended[i + 2] / 16) * at(p, x + i * dx, y + i * dy);
    free(p->v);
    *p = out;
}

// A gaussian of standard deviation sigma, as wide as doubles can represent it.
static void true_gaussian(struct plane *p, int dx, int dy, double sigma)
{
    const int reach = (int)ceil(8 * sigma);
    double *w = calloc((size_t)reach + 1, sizeof *w), sum = 0;
    struct plane out = plane_new(p->width, p->height);
    for (int i = 0; i <= reach; i++)
        sum += (i ? 2 : 1) * (w[i] = exp(-i * i / (2 * sigma * sigma)));
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++)
            for (int i = -reach; i <= reach; i++)
                out.v[y * p->width + x] += w[abs(i)] / sum * at(p, x + i * dx, y + i * dy);
    free(w);
    free(p->v);
    *p = out;
}

// The mean of size x size pixels. At an odd edge half-resolution quads repeat their last pixel, and quarter-resolution
// blocks their last quad.
static struct plane shrunk(const struct plane *p, int size)
{
    const int hw = (p->width + 1) / 2, hh = (p->height + 1) / 2;
    struct plane out = plane_new(size == 2 ? hw : (hw + 1) / 2, size == 2 ? hh : (hh + 1) / 2);
    for (int y = 0; y < out.height; y++)
        for (int x = 0; x < out.width; x++)
            for (int j = 0; j < size; j++)
                for (int i = 0; i < size; i++) {
                    const int half_x = clamped((x * size + i) / 2, hw);
                    out.v[y * out.width + x] += at(p, 2 * half_x + i % 2, y * size + j) / (size * size);
                }
    return out;
}

static double enlarged(const struct plane *p, int size, int x, int y)
{
    const double px = (x + .5) / size - .5, py = (y + .5) / size - .5;
    const int ix = (int)floor(px), iy = (int)floor(py);
    const double fx = px - ix, fy = py - iy;
    return (1 - fy) * ((1 - fx) * at(p, ix, iy) + fx * at(p, ix + 1, iy)) +
           fy * ((1 - fx) * at(p, ix, iy + 1) + fx * at(p, ix + 1, iy + 1));
}

static double sat(double v)
{
    return v > 0 ? fmin(v, 1) : 0;
}

static double shape(const struct hf_params *p, double t)
{
    return p->range.blend == HF_BLEND_SMOOTHSTEP ? t * t * (3 - 2 * t) : t;
}

static double clamp_depth(double z, double n, double f, int faithful)
{
    if (!faithful)
        return sat(z / f);
    const double window = isinf(z) ? 1 : sat(f * (z - n) / (z * (f - n)));
    return 2 * n / (f + n - window * (f - n));
}

static int nothing_given(const struct hf_params *p)
{
    return p->model == HF_MODEL_RANGE && p->range.distance == HF_DERIVE && p->range.near_begin == HF_DERIVE &&
           p->range.near_end == HF_DERIVE && p->range.far_begin == HF_DERIVE && p->range.far_end == HF_DERIVE;
}

static double blend_factor(const struct hf_params *p, const struct hf_depth *d, double z, double focus, int width)
{
    if (p->gaussian.faithful || nothing_given(p)) {
        const double n = d->near_plane > 0 ? d->near_plane : 1;
        const double f = d->far_plane > 0 && d->far_plane < INFINITY ? d->far_plane : 100 * n;
        const double distance =
            fabs(clamp_depth(focus, n, f, p->gaussian.faithful) - clamp_depth(z, n, f, p->gaussian.faithful));
        return p->range.strength * shape(p, sat(3 * distance));
    }
    if (p->model == HF_MODEL_LENS) {
        const double k = p->lens.focal_length_mm / 1000. / (2 * p->lens.f_number) / p->lens.world_unit_m *
                         p->lens.focal_length_mm / p->lens.sensor_width_mm * width;
        return shape(p, sat(fabs(k * (1 / focus - 1 / z)) / p->max_radius));
    }
    const double near = sat((focus - z) / p->range.distance), far = sat((z - focus) / p->range.distance);
    return p->range.strength * fmax(shape(p, near), shape(p, far));
}

static struct picture expected(const struct scene *s, const struct hf_depth *depth, const struct hf_params *p)
{
    const int w = s->colour.width, h = s->colour.height, size = 1 << p->gaussian.resolution;
    struct picture out = picture_copy(&s->colour);
    double *z = malloc(sizeof *z * (size_t)(w * h));
    ref_depths(z, depth, 1, w, h);
    const double focus = p->focus == HF_DERIVE ? z[h / 2 * w + w / 2] : p->focus;
    for (int c = 0; c < out.channels; c++) {
        struct plane colour = plane_new(w, h), b = plane_new(w, h);
        ref_repair(colour.v, s->colour.plane[c], w, h);
        memcpy(b.v, colour.v, sizeof *b.v * (size_t)(w * h));
        if (size > 1) {
            free(b.v);
            b = shrunk(&colour, size);
        }
        for (int i = 0; i < p->gaussian.iterations; i++) {
            blur(&b, 1, 0, p->gaussian.faithful);
            blur(&b, 0, 1, p->gaussian.faithful);
        }
        for (int i = 0; i < w * h; i++) {
            const double blurred = size > 1 ? enlarged(&b, size, i % w, i / w) : b.v[i];
            const double t = blend_factor(p, depth, z[i], focus, w);
            out.plane[c][i] = (float)(colour.v[i] + t * (blurred - colour.v[i]));
        }
        free(colour.v);
        free(b.v);
    }
    free(z);
    return out;
}

// Roundings from the picture to the result. Each iteration has two directions of four additions (faithfully four, three
// products and three weights that are no floats); 16 additions and a product downwards, 2 x 3 operations upwards; 3 for
// the blend, at twice the largest sample. The blend factor, times the same: three for z / f or 2 z / (z + f), at either
// end, and two for z itself (NDC eight), times 3, and eight for the shape.
static double bound_of(const struct hf_params *p, const struct hf_depth *d)
{
    const double iterations = (p->gaussian.faithful ? 20 : 8) * p->gaussian.iterations,
                 sizes = p->gaussian.resolution ? 17 + 12 : 0;
    const double z = d->type == HF_DEPTH_VIEW ? 2 : 24;  // the conversion from NDC cancels, which amplifies its errors
    double t = 3 * (3 + 3 + 2 * z) + 8;
    if (!p->gaussian.faithful &&
        !nothing_given(p))  // max(n, f): slopes times twice the roundings of the largest depth that matters
        t = 16 + 8 * (p->model == HF_MODEL_LENS ? 200 : 30 / 10);
    return (iterations + sizes + 2 * (3 + t)) * U;
}

static void against_double(struct hf_context *c, const char *isa)
{
    static const enum hf_depth_type types[] = {HF_DEPTH_VIEW, HF_DEPTH_VIEW, HF_DEPTH_RAY, HF_DEPTH_NDC_REVERSED,
                                               HF_DEPTH_INVERSE};
    double worst = 0;
    for (unsigned i = 0; i < 100; i++) {
        struct rng rng = rng_seed(seed + i);
        const enum scene_kind kind = (enum scene_kind)rng_below(&rng, SCENE_KINDS);
        struct scene s =
            scene_new(&rng, kind, 1 + rng_below(&rng, 120), 1 + rng_below(&rng, 70), 3 + rng_below(&rng, 2));
        struct hf_params p = random_params(&rng);
        p.gaussian.sigma = HF_DERIVE;
        struct picture samples = {0};
        struct hf_depth depth = picture_depth(&s.depth);
        if (p.gaussian.faithful || nothing_given(&p)) {
            depth = scene_depth_as(&s, types[i % 5], 12, &samples);
            if (i % 2 && depth.type == HF_DEPTH_VIEW)
                depth.near_plane = depth.far_plane = 0;
        }
        struct picture want = expected(&s, &depth, &p), got = render(c, &s.colour, &depth, &p);
        const double error = largest_difference(&want, &got), bound = bound_of(&p, &depth) * largest_sample(&s.colour);
        worst = worse(worst, error / bound);
        CHECK_MSG(error <= bound,
                  "%s: seed %u, %s %d x %d: off by %g, bound %g (iterations %d, resolution %d, faithful %d, "
                  "range %g, model %d, depth %d, focus %g)",
                  isa, seed + i, scene_name(kind), s.colour.width, s.colour.height, error, bound, p.gaussian.iterations,
                  p.gaussian.resolution, p.gaussian.faithful, p.range.distance, p.model, depth.type, p.focus);
        picture_free(&want);
        picture_free(&got);
        if (samples.width)
            picture_free(&samples);
        scene_free(&s);
    }
    printf("%s: against double precision: %.2g of the bound\n", isa, worst);
}

// Four boxes are not quite a gaussian, but have exactly its variance. A unit line, a unit step, and random samples
// between 0 and 1 are compared with a true gaussian. Below sigma 1 a sampled gaussian has a different variance.
static void against_gaussian(struct hf_context *c, const char *isa)
{
    enum { W = 301, MIDDLE = 150 };
    static const float sigmas[] = {0.2f, 0.3f, 0.7f, 1, 1.5f, 2, 3, 5, 8, 12, 20};
    // The excess kurtosis of k boxes is -1.2 / k, which lowers the peak by an eighth of that, 0.0375, and by more with
    // few taps.
    static const double bounds[3] = {0.065, 0.013, 0.03};
    double worst[3] = {0};
    for (int i = 0; i < 11; i++) {
        struct rng rng = rng_seed(seed);
        struct scene s = {picture_new(W, 3, 3), picture_new(W, 3, 1)};
        for (int x = 0; x < W; x++) {
            const float value = rng_float(&rng);
            for (int y = 0; y < 3; y++) {
                s.colour.plane[0][y * W + x] = x == MIDDLE;
                s.colour.plane[1][y * W + x] = x >= MIDDLE;
                s.colour.plane[2][y * W + x] = value;
                s.depth.plane[0][y * W + x] = 100;
            }
        }
        struct hf_params p = gaussian_params();
        p.gaussian.sigma = sigmas[i];
        struct picture a = render_scene(c, &s, &p);
        double mass = 0, variance = 0;
        for (int x = 0; x < W; x++) {
            mass += a.plane[0][x];
            variance += a.plane[0][x] * (x - MIDDLE) * (x - MIDDLE);
        }
        CHECK_MSG(fabs(mass - 1) < 1e-6, "%s: sigma %g: a line of 1 becomes %g", isa, sigmas[i], mass);
        CHECK_MSG(fabs(variance / (sigmas[i] * sigmas[i]) - 1) < 1e-5, "%s: sigma %g: variance %g", isa, sigmas[i],
                  variance);
        for (int ch = 0; ch < 3 && sigmas[i] >= 1; ch++) {
            struct plane want = plane_new(W, 1);
            for (int k = 0; k < W; k++)
                want.v[k] = s.colour.plane[ch][k];
            true_gaussian(&want, 1, 0, sigmas[i]);
            const double height = ch == 0 ? want.v[MIDDLE] : 1;
            for (int k = MIDDLE - 60; k <= MIDDLE + 60; k++) {  // away from the edges, where each box repeats them
                worst[ch] = worse(worst[ch], fabs(want.v[k] - a.plane[ch][k]) / height);
                CHECK_MSG(a.plane[ch][k] >= 0, "%s: sigma %g: %g", isa, sigmas[i], a.plane[ch][k]);
            }
            free(want.v);
        }
        picture_free(&a);
        scene_free(&s);
    }
    printf("%s: four boxes against a gaussian: a line %.2g of its height, a step %.2g, noise %.2g\n", isa, worst[0],
           worst[1], worst[2]);
    for (int ch = 0; ch < 3; ch++)
        CHECK_MSG(worst[ch] <= bounds[ch], "%s: off by %g, bound %g", isa, worst[ch], bounds[ch]);
}

// The depth at the picture's centre.
static void autofocus(struct hf_context *c, const char *isa)
{
    for (unsigned i = 0; i < 24; i++) {
        struct rng rng = rng_seed(seed + i);
        const int w = 3 + rng_below(&rng, 40), h = 3 + rng_below(&rng, 40), centre = h / 2 * w + w / 2;
        struct scene s = scene_new(&rng, SCENE_NOISE, w, h, 3);
        struct hf_params p = random_params(&rng);
        p.focus = HF_DERIVE;
        float want = s.depth.plane[0][centre] = 7 + (float)i;
        if (i % 4 == 1) {  // then the largest finite depth around it counts
            s.depth.plane[0][centre] = NAN;
            want = s.depth.plane[0][centre + 1] = 60;
        }
        if (i % 4 == 2) {
            s.depth.plane[0][centre] = i % 8 == 2 ? INFINITY : 0;
            want = 1e9f;  // for the clip planes and the lens this is as far away
            p.range.distance = HF_DERIVE;
        }
        struct picture a = render_scene(c, &s, &p);
        p.focus = want;
        struct picture b = render_scene(c, &s, &p);
        const double bound = i % 4 == 2 ? 1e-6 : 0;
        CHECK_MSG(largest_difference(&a, &b) <= bound, "%s: seed %u: autofocus %u is not focus %g: %g", isa, seed + i,
                  i % 4, want, largest_difference(&a, &b));
        picture_free(&a);
        picture_free(&b);
        scene_free(&s);
    }
}

// Each parameter changes the picture, and setting its default equals leaving it alone.
static void effects(struct hf_context *c, const char *isa)
{
    struct rng rng = rng_seed(seed);
    struct scene s = scene_new(&rng, SCENE_BLOCKS, 90, 64, 3);
    const struct hf_params base = gaussian_params();
    struct picture plain = render_scene(c, &s, &base);
    for (int i = 0; i < 12; i++) {
        struct hf_params p = base;
        struct hf_depth depth = picture_depth(&s.depth);
        p.gaussian.iterations = i == 0 ? 4 : p.gaussian.iterations;
        p.gaussian.resolution = i == 1 ? HF_RESOLUTION_HALF : i == 2 ? HF_RESOLUTION_QUARTER : p.gaussian.resolution;
        p.range.strength = i == 3 ? 0.5f : p.range.strength;
        p.gaussian.faithful = i == 4;
        p.range.blend = i == 5 ? HF_BLEND_SMOOTHSTEP : p.range.blend;
        p.range.distance = i == 6 ? 10 : p.range.distance;
        p.range.far_begin = i == 7 ? 25 : p.range.far_begin;
        p.range.far_end = i == 7 ? 30 : p.range.far_end;
        p.model = i == 8 ? HF_MODEL_LENS : p.model;
        p.lens.f_number = i == 8 ? 0.05f : p.lens.f_number;
        p.focus = i == 9 ? 25 : p.focus;
        depth.far_plane = i == 10 ? 40 : 0;
        struct picture a = render(c, &s.colour, &depth, &p);
        CHECK_MSG(picture_same_bits(&a, &plain) == (i == 11), "%s: parameter %d has no effect", isa, i);
        picture_free(&a);
    }
    // With sigma, which is in units of a pixel's height, the pixel aspect matters; with a lens the radius of full blur
    // does.
    for (int i = 0; i < 4; i++) {
        struct hf_params one = base, two;
        one.gaussian.sigma = i < 2 ? 3.0f : HF_DERIVE;
        one.model = i < 2 ? base.model : HF_MODEL_LENS;
        one.lens.f_number = 0.05f;
        two = one;
        two.view.pixel_aspect = i == 0 ? 2 : 1;
        two.max_radius = i == 2 ? one.max_radius / 4 : one.max_radius;
        struct picture a = render_scene(c, &s, &one), b = render_scene(c, &s, &two);
        CHECK_MSG(picture_same_bits(&a, &b) == (i % 2 == 1), "%s: case %d has no effect, or one by itself", isa, i);
        picture_free(&a);
        picture_free(&b);
    }
    // When faithful, the near plane matters for depths before it; otherwise it does not.
    struct hf_params p = base;
    struct hf_depth depth = picture_depth(&s.depth);
    p.focus = 1;
    depth.near_plane = 1;
    depth.far_plane = 100;
    struct picture one = render(c, &s.colour, &depth, &p);
    depth.near_plane = 15;
    struct picture other = render(c, &s.colour, &depth, &p);
    CHECK(picture_same_bits(&one, &other));
    picture_free(&one);
    picture_free(&other);
    depth = picture_depth(&s.depth);
    p.gaussian.faithful = 1;
    struct picture a = render(c, &s.colour, &depth, &p);
    depth.near_plane = 15;
    depth.far_plane = 100;
    struct picture b = render(c, &s.colour, &depth, &p);
    CHECK(!picture_same_bits(&a, &b));
    picture_free(&a);
    picture_free(&b);
    depth.near_plane = 200;
    CHECK_INT(try_render(c, &s.colour, &s.colour, &depth, &p), HF_ERR_ARG);
    picture_free(&plain);
    scene_free(&s);
}

int main(int argc, char **argv)
{
    seed = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 1;
    printf("seed %u\n", seed);
    for (int id = HF_ISA_SCALAR; id <= HF_ISA_NEON; id++) {
        if (!hf_isa_available((enum hf_isa)id))
            continue;
        const char *isa = hf_isa_name((enum hf_isa)id);
        struct hf_context *c = context_new((enum hf_isa)id, 2, 0, 0);
        against_double(c, isa);
        against_gaussian(c, isa);
        autofocus(c, isa);
        effects(c, isa);
        hf_close(&c);
    }
    return check_report();
}
