// SPDX-License-Identifier: BSD-3-Clause
// The scatter engine: parameters that move in tiny steps move the picture in tiny steps, beside lights too. The worst
// of some steps is halved until nothing lies between its ends, or twenty times: the remaining change is a jump. On one
// instruction set: the others have the same bits (scatter.c).
#include <math.h>
#include <stdlib.h>

#include "stability/stability.h"
#include "support/check.h"

enum { WIDTH = 72, HEIGHT = 56, PIXELS = WIDTH * HEIGHT, HALVINGS = 20, STEPS = 60 };

// 8-bit codes. Without lights half a code, see continuity.c. A sprite's radius steps by r / 1024, which moves 1 / (1024
// pi r) of a light across its rim: 0.012 of a light of 40 at a radius of one pixel. A code is 1 / 430 on the darkest
// colour here, 0.1: 5.3 codes, plus that half.
static const double NOISE = 0.5, LIGHTS = 5.8;

// A parameter that is changed in small steps.
struct pull {
    const char *name;
    struct hf_params params;
    double from, to, most;  // most: 8-bit codes
    void (*move)(struct picture *radius, struct hf_params *p, float t);
    float light;  // of some pixels
};

static struct hf_params params_new(void)
{
    struct hf_params p = scene_params();
    p.engine = HF_ENGINE_SCATTER;
    p.max_radius = HF_DERIVE;
    return p;
}

// Near on the left, far on the right, a sharp object in the middle of the picture.
static void near_and_far(struct picture *radius, struct hf_params *p, float t)
{
    (void)p;
    for (int k = 0; k < PIXELS; k++) {
        const int x = k % WIDTH, y = k / WIDTH;
        radius->plane[0][k] = x < 20 ? -2 - t : x >= 28 && x < 36 && y > 20 ? 0 : 6 + t;
    }
}

// Through the focus: one half of the picture near, the other far, both only slightly.
static void through_focus(struct picture *radius, struct hf_params *p, float t)
{
    (void)p;
    for (int k = 0; k < PIXELS; k++)
        radius->plane[0][k] = k % WIDTH < WIDTH / 2 ? t : k / WIDTH < HEIGHT / 2 ? 9 : -t;
}

// A bar in front of a far wall.
static void bar(struct picture *radius, struct hf_params *p, float t)
{
    (void)p;
    for (int k = 0; k < PIXELS; k++)
        radius->plane[0][k] = abs(k % WIDTH - WIDTH / 2) < 5 ? -4 - t : 7 + 0.3f * t;
}

static void cat_eye(struct picture *radius, struct hf_params *p, float t)
{
    bar(radius, p, 3);
    p->aperture.cat_eye = t;
}

// A pull at work.
struct pulling {
    struct hf_context *c;
    const struct pull *pull;
    const struct picture *colour;
};

static struct picture at(void *cookie, double t)
{
    const struct pulling *w = cookie;
    struct picture radius = picture_new(WIDTH, HEIGHT, 1);
    struct hf_params p = w->pull->params;
    w->pull->move(&radius, &p, (float)t);
    const struct hf_depth depth = picture_radii(&radius);
    struct picture out = render(w->c, w->colour, &depth, &p);
    picture_free(&radius);
    return out;
}

static void pulled(struct hf_context *c, const struct pull *pull)
{
    struct rng rng = rng_seed(9);
    struct picture colour = picture_new(WIDTH, HEIGHT, 3);
    for (int ch = 0; ch < 3; ch++)
        for (int k = 0; k < PIXELS; k++)
            colour.plane[ch][k] = 0.1f + 0.8f * rng_float(&rng);
    for (int i = 0; i < 25; i++) {
        const int k = rng_below(&rng, PIXELS);
        for (int ch = 0; ch < 3; ch++)
            colour.plane[ch][k] = fmaxf(pull->light, colour.plane[ch][k]);
    }
    struct pulling w = {c, pull, &colour};
    double worst = 0, place = 0;
    const double step = (pull->to - pull->from) / STEPS;
    struct picture before = at(&w, pull->from);
    for (int i = 1; i <= STEPS; i++) {
        struct picture now = at(&w, pull->from + i * step);
        const double d = display_distance(&before, &now);
        if (d > worst)
            worst = d, place = pull->from + (i - 1) * step;
        picture_free(&before);
        before = now;
    }
    picture_free(&before);
    double from = place, to = place + step;
    const double jump = step_left(at, display_distance, &w, HALVINGS, &from, &to);
    printf("%s: the worst step of %.3g changes by %.3g codes and jumps by %.3g near %g\n", pull->name, step, worst,
           jump, place);
    CHECK_MSG(jump <= pull->most, "%s: jumps by %.3g codes near %g, bound %g", pull->name, jump, place, pull->most);
    picture_free(&colour);
}

int main(void)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    struct hf_params full = params_new(), half = full, ring = full, cats = full, polygon = full;
    half.scatter.resolution = HF_RESOLUTION_HALF;
    ring.aperture.ring = 0.9f;
    struct hf_params half_ring = ring;
    half_ring.scatter.resolution = HF_RESOLUTION_HALF;
    polygon.aperture.blades = 5;
    const struct pull pulls[] = {
        {"near and far", full, 0, 8, NOISE, near_and_far, 0},
        {"near and far, lights of 40", full, 0, 8, LIGHTS, near_and_far, 40},
        {"near and far, half", half, 0, 8, NOISE, near_and_far, 0},
        {"near and far, half, lights of 40", half, 0, 8, LIGHTS, near_and_far, 40},
        {"through focus", full, -2, 2, NOISE, through_focus, 0},
        {"through focus, lights of 40", full, -2, 2, LIGHTS, through_focus, 40},
        {"through focus, half", half, -3, 3, NOISE, through_focus, 0},
        {"through focus, half, lights of 40", half, -3, 3, LIGHTS, through_focus, 40},
        {"bar", full, 0, 6, NOISE, bar, 0},
        {"bar, lights of 40", full, 0, 6, LIGHTS, bar, 40},
        {"bar, half, lights of 40", half, 0, 6, LIGHTS, bar, 40},
        {"bar, ring of 0.9", ring, 0, 6, NOISE, bar, 0},
        {"bar, ring of 0.9, half", half_ring, 0, 6, NOISE, bar, 0},
        {"bar, ring of 0.9, half, lights of 40", half_ring, 0, 6, LIGHTS, bar, 40},
        {"bar, five blades, lights of 40", polygon, 0, 6, LIGHTS, bar, 40},
        {"cat's eye from 0", cats, 0, 0.01, NOISE, cat_eye, 0},
        {"cat's eye from 0, lights of 40", cats, 0, 0.01, LIGHTS, cat_eye, 40},
        {"cat's eye", cats, 0.1, 1, NOISE, cat_eye, 0},
        {"cat's eye, five blades", polygon, 0, 0.01, NOISE, cat_eye, 0},
    };
    for (size_t i = 0; i < sizeof pulls / sizeof *pulls; i++)
        pulled(c, &pulls[i]);
    hf_close(&c);
    return check_report();
}
