// SPDX-License-Identifier: BSD-3-Clause
// Lens and range that move in tiny steps, for every look. As in continuity.c, the worst steps are halved twenty times, and
// what is left is a jump.
#include "stability/stability.h"

#include <string.h>

enum { WIDTH = 64, HEIGHT = 44, HALVINGS = 20 };

enum pulled { LENS_FOCUS, LENS_STOP, RANGE_FOCUS, RANGE_DISTANCE, RANGE_RADIUS, RING, CAT_EYE, PULLED };
static const struct {
    const char *name;
    double from, to;
} pulls[PULLED] = {
    {"lens, focus", 11, 33},     {"lens, f-number", 0.5, 4}, {"range, focus", 11, 33},  {"range, distance", 3, 30},
    {"range, radius", 0.05, 30}, {"lens, ring", 0, 0.9},     {"lens, cat's eye", 0, 1},
};

struct pulling {
    const struct run *r;
    const struct scene *s;
    enum pulled pull;
};

static struct picture at(void *cookie, double t)
{
    const struct pulling *w = cookie;
    struct hf_params p = w->r->subject->params;
    const float v = (float)t;
    if (w->pull <= LENS_STOP || w->pull >= RING)
        set_lens(&p, w->s->colour.width, 14);
    switch (w->pull) {
    case LENS_FOCUS:
    case RANGE_FOCUS:
        p.focus = v;
        break;
    case LENS_STOP:
        p.lens.f_number *= v;
        break;
    case RANGE_DISTANCE:
        p.range.distance = v;
        break;
    case RANGE_RADIUS:
        p.max_radius = v;
        break;
    case RING:
        p.aperture.ring = v;
        break;
    default:
        p.aperture.cat_eye = v;
    }
    return render_scene(w->r->c, w->s, &p);
}

double step_bound(const struct hf_params *p, int lamps, const char **why)
{
    *why = "half a code: what the smallest step of a float can make, see continuity.c";
    if (p->engine == HF_ENGINE_SCATTER && lamps) {
        // A sprite's radius steps by a 1024th, which at a radius of 15 moves its rim by 1 / 70 of a pixel; its rows end at
        // whole 256ths. So a pixel on the rim of a lamp changes by 1 / 70 of the disc. The display is exposed for the disc,
        // and where it is darkest, up to 1/30 of it, a code is 12.92 times a linear one; a quarter of that is seen.
        *why = "lamps: sprites have 1024 sizes an octave, see pulls.c";
        return 255 * 12.92 / 70 / 4;
    }
    if (p->engine == HF_ENGINE_SCATTER) {
        // The first and the last row of a sprite have one of 128 heights. Where a radius is little over half a pixel, each of
        // these rows is a pixel wide and the sprite 1.2 pixels large: 2 / 128 / 1.2 is 1.3 % of it, 3 codes where the pixels
        // around are black and white, as noise is.
        *why = "scatter: rows of a sprite have 128 heights, see pulls.c";
        return 3;
    }
    return 0.5;
}

static int takes(const struct hf_params *p, enum pulled pull)
{
    const int shaped = p->engine == HF_ENGINE_SCATTER || p->engine == HF_ENGINE_LAYERS;
    if (p->engine == HF_ENGINE_GAUSSIAN && pull == RANGE_RADIUS)
        return 0;
    if (pull == RING || pull == CAT_EYE)
        return shaped && !p->aperture.picture && p->aperture.squeeze == 1;
    return 1;
}

static void pull_one(const struct run *r, enum pulled pull, const struct scene *s, const char *scene, int lamps,
                     int steps)
{
    struct pulling w = {r, s, pull};
    double (*distance)(const struct picture *a, const struct picture *b) = lamps ? exposed_distance : display_distance;
    char what[80];
    const char *why;
    const double bound = step_bound(&r->subject->params, lamps, &why);
    const struct large_steps large = large_steps(at, distance, &w, pulls[pull].from, pulls[pull].to, steps);
    snprintf(what, sizeof what, "%s: jump, codes%s", pulls[pull].name, lamps ? " of the brightest around" : "");
    see_look(r, row_name(what), why, 0, bound, "%s", scene);
    for (int k = 0; k < (r->full ? LARGE_STEPS : 1); k++) {
        double a = large.place[k], b = a + large.width;
        if (large.change[k] <= bound)
            continue;
        const double left = step_left(at, distance, &w, HALVINGS, &a, &b);
        see_look(r, row_name(what), why, left, bound, "%s, at %.9g to %.9g", scene, a, b);
    }
}

// What ring and cat's eye do as they begin: next to nothing.
static void begin_all(const struct run *r, const struct scene *s, const char *scene)
{
    for (int pull = RING; pull <= CAT_EYE; pull++) {
        struct pulling w = {r, s, (enum pulled)pull};
        char what[80];
        const char *why;
        const double bound = step_bound(&r->subject->params, 0, &why);
        if (!takes(&r->subject->params, w.pull))
            continue;
        struct picture without = at(&w, 0), with = at(&w, 1e-7);
        snprintf(what, sizeof what, "%s: jump as it begins, codes", pulls[pull].name);
        see_look(r, row_name(what), why, display_distance(&without, &with), bound, "%s", scene);
        picture_free(&without);
        picture_free(&with);
    }
}

// The same where everything has one radius, from less than a pixel on: small shapes differ most.
static void begin_flat(const struct run *r)
{
    static const float depths[] = {20.4f, 20.7f, 21, 22.5f, 24, 30, 16};
    struct scene s = stage_make(STAGE_NOISE, r->seed, WIDTH, HEIGHT);
    for (size_t k = 0; k < sizeof depths / sizeof *depths; k++) {
        char scene[40];
        for (size_t i = 0; i < samples_of(&s.depth); i++)
            s.depth.plane[0][i] = depths[k];
        snprintf(scene, sizeof scene, "noise %u at %g", r->seed, depths[k]);
        begin_all(r, &s, scene);
    }
    scene_free(&s);
}

static void pull_all(const struct run *r, const struct scene *s, const char *scene, int lamps, int steps)
{
    for (int k = 0; k < PULLED; k++)
        if (takes(&r->subject->params, (enum pulled)k))
            pull_one(r, (enum pulled)k, s, scene, lamps, steps);
}

// The f-number at which the largest near (sign -1) or far radius of a scene is `radius`, in pixels; 0: there is none.
static double stop_for(const struct hf_params *p, const struct scene *s, int sign, double radius)
{
    double most = 0;
    for (size_t i = 0; i < samples_of(&s->depth); i++) {
        const double z = s->depth.plane[0][i];
        most = fmax(most, sign * (1 / p->focus - (isfinite(z) && z > 0 && z < 1e10 ? 1 / z : 0)));
    }
    const double aperture = p->lens.focal_length_mm / 1000 / 2,
                 focal = p->lens.focal_length_mm / p->lens.sensor_width_mm;
    return most * aperture * focal * s->colour.width / radius;
}

// Where the largest radius of a frame passes the sizes at which engines begin to do more: levels, kernels, neighbourhoods.
static void crossings(const struct run *r, const struct scene *s, const char *scene)
{
    static const double radii[] = {0.5, 0.75, 1, 1.25, 1.5, 2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 24, 28, 32};
    struct pulling w = {r, s, LENS_STOP};
    struct hf_params p = r->subject->params;
    const char *why;
    const double bound = step_bound(&p, 0, &why);
    set_lens(&p, s->colour.width, 14);
    for (int sign = -1; sign <= 1; sign += 2)
        for (size_t k = 0; k < sizeof radii / sizeof *radii; k++) {
            // In units of the lens's own f-number, as at() takes it.
            const double stop = stop_for(&p, s, sign, radii[k]) / p.lens.f_number;
            double from = stop * (1 - 2e-4), to = stop * (1 + 2e-4);
            if (!(stop > 0))
                continue;
            const double left = step_left(at, display_distance, &w, HALVINGS, &from, &to);
            see_look(r, "lens, the largest radius passes a number: jump, codes", why, left, bound, "%s, %s %g, at %.9g",
                     scene, sign < 0 ? "near" : "far", radii[k], from);
        }
}

// Jumps that other seeds once showed.
static void found_before(const struct run *r)
{
    static const struct {
        enum pulled pull;
        enum stage stage;
        unsigned seed;
        double from, to;
    } found[] = {
        // hexagon, 2.6 codes: a front in a mixed pixel, whose share came to nothing, had another radius from there on.
        {RANGE_RADIUS, STAGE_LAMPS, 2, 0.9814, 0.98141},
        // layers, 9.6 codes: the front of a mixed pixel, whose last sure pixel went, leaned on a lamp.
        {RANGE_DISTANCE, STAGE_LAMPS, 1, 6.0798, 6.0799},
        // layers, 3.1 codes: the weight of a card's last sure pixels fell to 0 steeply, and the mean of their side with it.
        {RANGE_DISTANCE, STAGE_CARDS, 5, 9.2014, 9.2015},
    };
    for (size_t k = 0; k < sizeof found / sizeof *found; k++) {
        struct scene s = stage_make(found[k].stage, found[k].seed, WIDTH, HEIGHT);
        struct pulling w = {r, &s, found[k].pull};
        const int lamps = found[k].stage == STAGE_LAMPS;
        double from = found[k].from, to = found[k].to;
        const char *why;
        const double bound = step_bound(&r->subject->params, lamps, &why);
        if (takes(&r->subject->params, w.pull)) {
            const double left = step_left(at, lamps ? exposed_distance : display_distance, &w, HALVINGS, &from, &to);
            see_look(r, "what jumped before, codes", why, left, bound, "%s %u, %s at %.9g", stage_name(found[k].stage),
                     found[k].seed, pulls[w.pull].name, from);
        }
        scene_free(&s);
    }
}

void pulls_cases(const struct run *r)
{
    for (unsigned seed = r->seed; seed < r->seed + (r->full ? 10 : 1); seed++)
        for (int k = 0; k < STAGES; k++) {
            char scene[40];
            if (!r->full && (k == STAGE_FLOOR || k == STAGE_BLOCKS))
                continue;
            struct scene s = stage_make((enum stage)k, seed, WIDTH, HEIGHT);
            snprintf(scene, sizeof scene, "%s %u", stage_name((enum stage)k), seed);
            pull_all(r, &s, scene, k == STAGE_LAMPS, r->full ? 300 : 10);
            if (k != STAGE_LAMPS)
                begin_all(r, &s, scene);
            if (k != STAGE_LAMPS && (r->full || k == STAGE_CARDS))
                crossings(r, &s, scene);
            scene_free(&s);
        }
    begin_flat(r);
    found_before(r);
    struct scene s;
    const char *name;
    const int first = r->full ? 0 : (int)strlen(r->subject->name) % 3;
    for (int k = first; stage_picture(k, r->full ? 160 : 80, r->full ? 120 : 56, &s, &name); k++) {
        pull_all(r, &s, name, 0, r->full ? 60 : 8);
        crossings(r, &s, name);
        scene_free(&s);
        if (!r->full)
            break;
    }
}
