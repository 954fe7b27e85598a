// SPDX-License-Identifier: BSD-3-Clause
// A random search for what layers does abruptly or far away: random scenes and parts of the ray-traced pictures, with
// random lenses, apertures and qualities.
//
//     layers_search images [COUNT [SEED]]      the folder of the ray-traced scenes; how many cases of each kind
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/render.h"

enum { WIDTH = 128, HEIGHT = 80, HALVINGS = 20, IMAGES = 3 };

static struct scene image[IMAGES];
static const char *const names[IMAGES] = {"lights", "fence", "foliage"};

static double code_of(double v)
{
    v = fmin(fmax(v, 0), 1);
    return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055);
}

// The largest difference of two pictures in 8-bit display codes.
static double codes_apart(const struct picture *a, const struct picture *b)
{
    double most = 0;
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < samples_of(a); i++)
            if (a->plane[c][i] != b->plane[c][i])
                most = worse(fabs(code_of(a->plane[c][i]) - code_of(b->plane[c][i])), most);
    return most;
}

// ---- jumps ----

enum { FOCUS, OPENING, RADIUS, RING, CAT_EYE, VARIED };
static const char *const varied[VARIED] = {"focus", "opening", "max_radius", "ring", "cat_eye"};

struct subject {
    struct scene s;
    struct hf_params p;
    char name[120];
    float low[VARIED], high[VARIED];
};

static struct scene part_of(const struct scene *of, int x, int y, int width, int height)
{
    return (struct scene){picture_cut(&of->colour, x, y, width, height), picture_cut(&of->depth, x, y, width, height)};
}

// A random scene under the range model, or a part of a picture under a lens. Colours are those of a display: 0 to 1.
static struct subject subject_new(struct rng *rng)
{
    struct subject t = {.p = scene_params()};
    struct hf_params *p = &t.p;
    const int kind = rng_below(rng, 3) ? rng_below(rng, IMAGES) : -1;
    if (kind < 0) {
        const enum scene_kind random = (enum scene_kind)rng_below(rng, SCENE_KINDS);
        t.s = scene_new(rng, random, WIDTH, HEIGHT, 3);
        snprintf(t.name, sizeof t.name, "%s", scene_name(random));
        p->max_radius = rng_range(rng, 1, 30);
        p->focus = rng_range(rng, 12, 28);
        t.low[FOCUS] = 12, t.high[FOCUS] = 28;
        t.low[OPENING] = 2, t.high[OPENING] = 30;
    } else {
        const int x = rng_below(rng, image[kind].colour.width - WIDTH),
                  y = rng_below(rng, image[kind].colour.height - HEIGHT);
        t.s = part_of(&image[kind], x, y, WIDTH, HEIGHT);
        snprintf(t.name, sizeof t.name, "%s at %d, %d", names[kind], x, y);
        p->model = HF_MODEL_LENS;
        p->lens.sensor_width_mm = 36.0f * WIDTH / 1280;
        p->max_radius = rng_range(rng, 4, 40);
        p->focus = rng_range(rng, 2, 12);
        p->lens.f_number = rng_range(rng, 0.3f, 1.5f);
        t.low[FOCUS] = 2, t.high[FOCUS] = 12;
        t.low[OPENING] = 0.3f, t.high[OPENING] = 1.5f;
    }
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < samples_of(&t.s.colour); i++)
            t.s.colour.plane[c][i] = fminf(fmaxf(t.s.colour.plane[c][i], 0), 1);
    p->engine = HF_ENGINE_LAYERS;
    p->layers.quality = (enum hf_layers_quality)rng_below(rng, 4);
    p->layers.no_patterns = 1;  // they choose the better of two places, and say that they jump
    p->aperture.blades = rng_below(rng, 3) ? 0 : 3 + rng_below(rng, 6);
    p->aperture.ring = rng_below(rng, 3) ? 0 : rng_range(rng, 0.05f, 0.9f);
    p->aperture.cat_eye = rng_below(rng, 3) ? 0 : rng_range(rng, 0.05f, 1);
    t.low[RADIUS] = 0.5f, t.high[RADIUS] = 40;
    t.high[RING] = 0.9f;
    t.high[CAT_EYE] = 1;
    return t;
}

static struct picture at(struct hf_context *c, const struct subject *t, int vary, float v)
{
    struct hf_params p = t->p;
    float *const to[VARIED] = {&p.focus, p.model == HF_MODEL_LENS ? &p.lens.f_number : &p.range.distance, &p.max_radius,
                               &p.aperture.ring, &p.aperture.cat_eye};
    *to[vary] = v;
    return render_scene(c, &t->s, &p);
}

// Halve a step of a parameter, each time towards the greater change; returns the change that is left, in codes.
static double jump(struct hf_context *c, const struct subject *t, int vary, float *from, float *to)
{
    struct picture a = at(c, t, vary, *from), b = at(c, t, vary, *to);
    for (int i = 0; i < HALVINGS; i++) {
        const float middle = *from + (*to - *from) / 2;
        if (middle == *from || middle == *to)
            break;
        struct picture m = at(c, t, vary, middle);
        const int first = codes_apart(&a, &m) > codes_apart(&m, &b);
        picture_free(first ? &b : &a);
        *(first ? &b : &a) = m;
        *(first ? to : from) = middle;
    }
    const double left = codes_apart(&a, &b);
    picture_free(&a);
    picture_free(&b);
    return left;
}

// A millionth of a parameter's range is left of a step: 1e-5 pixels of radius, and with them 1e-4 of a weight. Nobody sees
// half a code.
static void jumps(struct hf_context *c, int count, unsigned seed)
{
    double worst[VARIED] = {0};
    for (int n = 0; n < count; n++) {
        struct rng rng = rng_seed(seed * 1000003u + (unsigned)n);
        struct subject t = subject_new(&rng);
        const int vary = rng_below(&rng, VARIED);
        float from = rng_range(&rng, t.low[vary], t.high[vary]), to = rng_range(&rng, t.low[vary], t.high[vary]);
        if (rng_below(&rng, 6) == 0 && vary >= RING)
            from = 0;
        const double left = jump(c, &t, vary, &from, &to);
        worst[vary] = worse(left, worst[vary]);
        CHECK_MSG(left < 0.5,
                  "jump %d: %s, quality %d, radius %.9g, focus %.9g, opening %.9g, blades %d, ring %.9g, cat's eye "
                  "%.9g: %s from %.9g to %.9g changes a sample by %.3g codes",
                  n, t.name, (int)t.p.layers.quality, (double)t.p.max_radius, (double)t.p.focus,
                  (double)(t.p.model == HF_MODEL_LENS ? t.p.lens.f_number : t.p.range.distance), t.p.aperture.blades,
                  (double)t.p.aperture.ring, (double)t.p.aperture.cat_eye, varied[vary], (double)from, (double)to,
                  left);
        scene_free(&t.s);
    }
    for (int i = 0; i < VARIED; i++)
        printf("largest jump by %s: %.3g codes\n", varied[i], worst[i]);
}

// ---- what a pixel depends on ----

// How far a pixel reads, given the largest radius on either side: the discs; twice the difference of the radii and two
// pixels, where the search finds what is hidden; means of 13 quads, twelve pixels on either side; un-mixing, 4; the
// quads; and two pixels of an eighth of the resolution, once for the grid and once for upsampling.
static int reach_of(float near, float far)
{
    return (int)(fmaxf(near, far) + 2 * (near + far) + 2 + 12 + 4 + 2 + 2 * 16) + 1;
}

// Radii of a random scene, or those of a picture with a thin lens: at most `most`.
static struct scene with_radii(struct rng *rng, float most, int width, int height)
{
    struct scene s;
    const int kind = rng_below(rng, IMAGES + 2);
    if (kind < IMAGES) {
        s = part_of(&image[kind], rng_below(rng, image[kind].colour.width - width),
                    rng_below(rng, image[kind].colour.height - height), width, height);
        const float focus = rng_range(rng, 2, 10);
        for (size_t i = 0; i < samples_of(&s.depth); i++)
            s.depth.plane[0][i] = fmaxf(most * (1 - focus / s.depth.plane[0][i]), -most);
    } else {
        s = scene_new(rng, SCENE_BLOCKS, width, height, 3);
        for (size_t i = 0; i < samples_of(&s.depth); i++)
            s.depth.plane[0][i] = fminf(fmaxf((s.depth.plane[0][i] - 20) * 0.1f, -1), 1) * most;
    }
    return s;
}

static struct hf_params radii_params(struct rng *rng)
{
    struct hf_params p = hf_default_params();
    p.engine = HF_ENGINE_LAYERS;
    p.layers.quality = (enum hf_layers_quality)rng_below(rng, 4);
    p.layers.no_patterns = 1;  // they are searched 48 quads around a band
    p.run.deterministic = 1;
    p.aperture.blades = rng_below(rng, 3) ? 0 : 3 + rng_below(rng, 6);
    return p;
}

// One sample with a wrong depth, or a part of a picture: beyond the reach no bit differs.
static void local(struct hf_context *c, int count, unsigned seed)
{
    enum { W = 448, H = 96, CUT = 64 };
    for (int n = 0; n < count; n++) {
        struct rng rng = rng_seed(seed * 1000003u + (unsigned)n);
        const float most = rng_range(&rng, 2, 30), outlier = rng_range(&rng, -30, 30);
        struct scene s = with_radii(&rng, most, W, H);
        const struct hf_params p = radii_params(&rng);
        struct hf_depth depth = picture_radii(&s.depth);
        struct picture whole = render(c, &s.colour, &depth, &p);
        struct scene cut = part_of(&s, CUT, 0, W - CUT, H);
        depth = picture_radii(&cut.depth);
        struct picture part = render(c, &cut.colour, &depth, &p);
        int other = 0, farthest = 0;
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < (W - CUT) * H; i++)
                if (part.plane[k][i] != whole.plane[k][i / (W - CUT) * W + CUT + i % (W - CUT)]) {
                    other += i % (W - CUT) >= reach_of(most, most);
                    farthest = i % (W - CUT) > farthest ? i % (W - CUT) : farthest;
                }
        CHECK_MSG(!other, "part %d: quality %d, radii up to %g: %d samples differ beyond %d pixels, up to %d", n,
                  (int)p.layers.quality, (double)most, other, reach_of(most, most), farthest);
        s.depth.plane[0][H / 2 * W + 40] = outlier;
        depth = picture_radii(&s.depth);
        struct picture bad = render(c, &s.colour, &depth, &p);
        const float near = fmaxf(most, -outlier), far = fmaxf(most, outlier);
        for (int k = other = farthest = 0; k < 3; k++)
            for (int i = 0; i < W * H; i++)
                if (bad.plane[k][i] != whole.plane[k][i]) {
                    other += abs(i % W - 40) > reach_of(near, far);
                    farthest = abs(i % W - 40) > farthest ? abs(i % W - 40) : farthest;
                }
        CHECK_MSG(!other, "outlier %d: quality %d, radii up to %g, one of %g: %d samples differ beyond %d, up to %d", n,
                  (int)p.layers.quality, (double)most, (double)outlier, other, reach_of(near, far), farthest);
        picture_free(&whole);
        picture_free(&part);
        picture_free(&bad);
        scene_free(&s);
        scene_free(&cut);
    }
}

// ---- pictures that are related ----

// Times 2^-4 and 2^4, no sample changes by more than roundings, also with patterns: a sample is a mean of others, and each
// of at most 400 roundings in a row (layers_exact.c counts them) is half a unit of the largest sample.
static void exposed(struct hf_context *c, int count, unsigned seed)
{
    for (int n = 0; n < count; n++) {
        struct rng rng = rng_seed(seed * 1000003u + (unsigned)n);
        struct subject t = subject_new(&rng);
        t.p.layers.no_patterns = 0;
        t.p.run.deterministic = 1;
        struct picture want = render_scene(c, &t.s, &t.p);
        for (int by = -4; by <= 4; by += 8) {
            struct scene s = {picture_copy(&t.s.colour), picture_copy(&t.s.depth)};
            double worst = 0;
            for (int k = 0; k < 3; k++)
                for (size_t i = 0; i < samples_of(&want); i++)
                    s.colour.plane[k][i] = ldexpf(s.colour.plane[k][i], by);
            struct picture got = render_scene(c, &s, &t.p);
            for (int k = 0; k < 3; k++)
                for (size_t i = 0; i < samples_of(&want); i++)
                    worst = worse(fabs((double)ldexpf(got.plane[k][i], -by) - want.plane[k][i]), worst);
            CHECK_MSG(worst <= 400 * FLT_EPSILON / 2, "exposed %d: %s, quality %d, times 2^%d: %.3g off", n, t.name,
                      (int)t.p.layers.quality, by, worst);
            picture_free(&got);
            scene_free(&s);
        }
        picture_free(&want);
        scene_free(&t.s);
    }
}

int main(int argc, char **argv)
{
    static const char *const rgb[] = {"R", "G", "B"}, *const z[] = {"Z"};
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    const int count = argc > 2 ? atoi(argv[2]) : check_long() ? 400 : 40;
    const unsigned seed = argc > 3 ? (unsigned)atoi(argv[3]) : 1;
    for (int i = 0; i < IMAGES; i++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s.exr", argc > 1 ? argv[1] : "images", names[i]);
        if (!CHECK(!exr_read(&image[i].colour, path, 3, rgb) && !exr_read(&image[i].depth, path, 1, z)))
            return check_report();
    }
    jumps(c, count, seed);
    local(c, count / 2, seed);
    exposed(c, count / 2, seed);
    for (int i = 0; i < IMAGES; i++)
        scene_free(&image[i]);
    hf_close(&c);
    return check_report();
}
