// SPDX-License-Identifier: BSD-3-Clause
// gather and chapter on random scenes, lenses, ranges and options: the worst of some steps between two random values, halved twenty
// times towards the greater change, leaves no jump; one sample changes only what is within its reach; a crop has the whole's bits;
// and a lamp's disc is as large as the lens's.
//
//     gather_steady [rounds [seed]]
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stability/stability.h"
#include "support/check.h"
#include "support/render.h"

enum { WIDTH = 120, HEIGHT = 88, PIXELS = WIDTH * HEIGHT, STEPS = 48, HALVINGS = 20 };

static int rounds = 20;
static unsigned seed = 1;

// ---- random subjects ----

struct shot {
    struct scene scene;
    struct hf_params p;
    char name[160];
};

// Blocks, steps, floors and bars at random depths, in colours of the display, with lamps.
static struct scene any_scene(struct rng *rng)
{
    static const enum scene_kind kinds[] = {SCENE_BLOCKS, SCENE_RAMP, SCENE_FAR, SCENE_NEAR, SCENE_NOISE};
    struct scene s = scene_new(rng, kinds[rng_below(rng, 5)], WIDTH, HEIGHT, 3);
    const float bar = rng_range(rng, 8, 19);
    const int at = rng_below(rng, WIDTH - 12), with_bar = rng_below(rng, 2);
    for (int i = 0; i < PIXELS; i++) {
        if (with_bar && i % WIDTH >= at && i % WIDTH < at + 12)
            s.depth.plane[0][i] = bar;
        const int lamp = rng_below(rng, 60) == 0;
        for (int c = 0; c < 3; c++)
            s.colour.plane[c][i] = lamp ? rng_range(rng, 0.8f, 1) : fminf(s.colour.plane[c][i], 1);
    }
    return s;
}

static void any_options(struct rng *rng, struct hf_params *p)
{
    static const int blades[] = {0, 0, 3, 5, 6};
    p->aperture.blades = blades[rng_below(rng, 5)];
    p->aperture.rotation = p->aperture.blades ? rng_range(rng, 0, 60) : 0;
    p->gather.karis = p->chapter.karis = rng_below(rng, 4) == 0;
    p->gather.per_pixel_kernel = p->chapter.per_pixel_kernel = rng_below(rng, 4) == 0;
    p->gather.bicubic = p->chapter.bicubic = rng_below(rng, 4) == 0;
    p->chapter.fill = (enum hf_fill)rng_below(rng, 4);
}

// A lens whose radii are up to `most` pixels at the depths of these scenes, 8 to 40.
static void use_lens(struct hf_params *p, float most)
{
    p->model = HF_MODEL_LENS;
    p->lens.focal_length_mm = 50;
    p->lens.f_number = 0.05f * 50 * WIDTH / 36 / (2 * most) * (1 / 8.0f - 1 / p->focus);
}

static struct shot any_shot(struct rng *rng, enum hf_engine engine)
{
    struct shot s = {any_scene(rng), scene_params(), ""};
    s.p.engine = engine;
    s.p.focus = rng_range(rng, 10, 30);
    s.p.view.display_width = WIDTH;
    s.p.view.display_height = HEIGHT;
    any_options(rng, &s.p);
    if (rng_below(rng, 3)) {
        s.p.max_radius = HF_DERIVE;
        use_lens(&s.p, rng_below(rng, 2) ? rng_range(rng, 1, 5) : rng_range(rng, 4, 16));
    } else {
        s.p.range.distance = rng_range(rng, 3, 20);
        s.p.max_radius = rng_range(rng, 0.5f, 16);
    }
    snprintf(s.name, sizeof s.name, "%s, %s, blades %d%s%s%s, fill %d", hf_engine_name(engine),
             s.p.model == HF_MODEL_LENS ? "lens" : "range", s.p.aperture.blades, s.p.gather.karis ? ", karis" : "",
             s.p.gather.per_pixel_kernel ? ", per pixel" : "", s.p.gather.bicubic ? ", bicubic" : "",
             (int)s.p.chapter.fill);
    return s;
}

// ---- jumps ----

enum pull { PULL_FOCUS, PULL_APERTURE, PULL_RADIUS, PULL_RANGE, PULL_GAIN, PULLS };
static const char *const pull_names[] = {"focus", "f-number", "largest radius", "range", "highlight gain"};

struct pulling {
    struct hf_context *c;
    const struct shot *s;
    enum pull pull;
};

static struct picture at(void *cookie, double t)
{
    const struct pulling *w = cookie;
    struct hf_params p = w->s->p;
    switch (w->pull) {
    case PULL_FOCUS:
        p.focus = (float)t;
        break;
    case PULL_APERTURE:
        p.lens.f_number = (float)t;
        break;
    case PULL_RADIUS:
        p.max_radius = (float)t;
        break;
    case PULL_RANGE:
        p.range.distance = (float)t;
        break;
    case PULL_GAIN:
    default:
        p.highlight.gain = (float)t;
        break;
    }
    return render_scene(w->c, &w->s->scene, &p);
}

static void any_ends(struct rng *rng, const struct shot *s, enum pull pull, double *from, double *to)
{
    static const float range[PULLS][2] = {{9, 34}, {0.3f, 4}, {0.01f, 18}, {2, 30}, {1, 16}};
    for (int i = 0; i < 2; i++) {
        const float v = rng_range(rng, range[pull][0], range[pull][1]);
        *(i ? to : from) = pull == PULL_APERTURE ? s->p.lens.f_number * v : v;
    }
    if (*from > *to) {
        const double t = *from;
        *from = *to;
        *to = t;
    }
}

// As tests/stability/continuity.c: 20 halvings leave at most 25 / 2^20 of a focus, 2.4e-5. A radius of 16 moves by at most
// 16 * 8 / 10^2 of that here, 3e-5 pixels. A sample depends on it most in the near field's last step to a radius of two
// pixels, where its part grows four times as fast as q, twice that of a pixel of radius: 2 x 3e-5 x 12.92 x 255 is 0.2 codes.
static const double MOST = 0.5;

static double jump_of(struct hf_context *c, const struct shot *s, struct rng *rng)
{
    const int lens = s->p.model == HF_MODEL_LENS;
    struct pulling w = {c, s, PULL_FOCUS};
    const int which = rng_below(rng, 4);
    w.pull = which == 3 ? PULL_GAIN : which < 2 ? (lens ? PULL_FOCUS : PULL_RANGE) : lens ? PULL_APERTURE : PULL_RADIUS;
    double first, last, left = 0;
    any_ends(rng, s, w.pull, &first, &last);
    const struct large_steps large = large_steps(at, display_distance, &w, first, last, STEPS);
    for (int k = 0; k < LARGE_STEPS; k++) {
        double from = large.place[k], to = from + large.width;
        if (large.change[k] <= MOST)
            continue;
        const double jump = step_left(at, display_distance, &w, HALVINGS, &from, &to);
        CHECK_MSG(jump <= MOST, "%s: %s jumps by %.3g codes at %.9g", s->name, pull_names[w.pull], jump, from);
        left = fmax(left, jump);
    }
    return left;
}

static void jumps(struct hf_context *c, enum hf_engine engine)
{
    struct rng rng = rng_seed(seed);
    double worst = 0;
    for (int i = 0; i < rounds; i++) {
        struct shot s = any_shot(&rng, engine);
        const struct scene part = {picture_cut(&s.scene.colour, 0, 0, WIDTH / 2, HEIGHT / 2),
                                   picture_cut(&s.scene.depth, 0, 0, WIDTH / 2, HEIGHT / 2)};
        scene_free(&s.scene);
        s.scene = part;
        if (rng_below(&rng, 2))
            s.p.highlight.gain = rng_range(&rng, 1, 16);
        for (int k = 0; k < 4; k++)
            worst = fmax(worst, jump_of(c, &s, &rng));
        scene_free(&s.scene);
    }
    printf("%s: %d random pulls, the largest jump is %.3g codes\n", hf_engine_name(engine), 4 * rounds, worst);
}

// A near bar whose radius passes 2 pixels, where the near field's second kernel begins, before far lamps and walls.
static void second_kernel(struct hf_context *c)
{
    struct shot s = {
        {picture_new(WIDTH, HEIGHT, 3), picture_new(WIDTH, HEIGHT, 1)}, scene_params(), "bar before lamps"};
    struct rng rng = rng_seed(5);
    for (int i = 0; i < PIXELS; i++) {
        const int x = i % WIDTH, bar = x / 8 % 3 == 0;
        s.scene.depth.plane[0][i] = bar ? 8 : 40;
        for (int k = 0; k < 3; k++)
            s.scene.colour.plane[k][i] = !bar && rng_below(&rng, 60) == 0 ? 1 : 0.2f * rng_float(&rng);
    }
    s.p.engine = HF_ENGINE_GATHER;
    s.p.max_radius = HF_DERIVE;
    s.p.focus = 10;
    use_lens(&s.p, 2);
    struct pulling w = {c, &s, PULL_APERTURE};
    const float at_two = s.p.lens.f_number;
    double from = (double)at_two * 0.99, to = (double)at_two * 1.01;
    const double left = step_left(at, display_distance, &w, HALVINGS, &from, &to);
    CHECK_MSG(left <= MOST, "where the near radius passes 2 pixels the picture jumps by %.3g codes", left);
    printf("where the near radius passes 2 pixels the picture jumps by %.3g codes\n", left);
    scene_free(&s.scene);
}

// ---- locality ----

static struct hf_report report_of(struct hf_context *c)
{
    struct hf_report r = {.size = sizeof r};
    hf_get_report(c, &r);
    return r;
}

// How far from a pixel of the result the samples lie that it may depend on, with these largest radii. In half-resolution pixels:
// upsampling reads 1 or with the cubic 2 around, and from there both engines read an aperture's radius, rounded up. The gather
// reads 1 more for lights, or 3 of the near field's CoC in place of that; the chapter reads twice the radius for it, and 1 more
// for its fill and 1 for taps that lie between. A half-resolution pixel has 2 x 2, and a sample that is not finite would take 1.
// With several kernels the gather's largest has up to twice the radius.
static int reach_of(const struct shot *s, const struct hf_report *r)
{
    const float most = s->p.model == HF_MODEL_LENS ? fmaxf(r->near_radius, r->far_radius) : s->p.max_radius;
    const int many = s->p.engine == HF_ENGINE_GATHER && (s->p.model == HF_MODEL_LENS || s->p.gather.per_pixel_kernel);
    const int taps = (int)ceilf(fmaxf(many ? 2 * most : most, 2) / 2);
    return 2 * (2 + (s->p.engine == HF_ENGINE_GATHER ? (taps + 1 > 3 ? taps + 1 : 3) : 2 * taps + 2)) + 1;
}

// How far from (sx, sy) a pixel has changed, along either axis; -1 if none has.
static int farthest(const struct picture *a, const struct picture *b, int sx, int sy)
{
    int most = -1;
    for (int i = 0; i < PIXELS; i++) {
        const int dx = abs(i % WIDTH - sx), dy = abs(i / WIDTH - sy), away = dx > dy ? dx : dy;
        for (int c = 0; c < 3 && away > most; c++)
            if (memcmp(&a->plane[c][i], &b->plane[c][i], sizeof(float)))
                most = away;
    }
    return most;
}

// Of the samples farther away than `reach`, how many have changed by more than half a code, percent, and the largest change.
static void beyond(const struct picture *a, const struct picture *b, int sx, int sy, int reach, double *part,
                   double *most)
{
    int changed = 0;
    for (int i = 0; i < 3 * PIXELS; i++) {
        const int k = i % PIXELS;
        const double d = fabs(display_code(a->plane[i / PIXELS][k]) - display_code(b->plane[i / PIXELS][k]));
        if (abs(k % WIDTH - sx) <= reach && abs(k / WIDTH - sy) <= reach)
            continue;
        changed += d > 0.5;
        *most = fmax(*most, d);
    }
    *part = fmax(*part, 100.0 * changed / (3 * PIXELS));
}

// One sample of depth, or of colour, becomes another one. Nothing beyond its reach may change; except that the chapter has one
// kernel for each field, of the frame's largest radius, so that a sample with that radius changes others by as much as is printed.
static void one_sample(struct hf_context *c, enum hf_engine engine)
{
    struct rng rng = rng_seed(seed + 1);
    int tried = 0;
    double part = 0, most = 0;
    for (int i = 0; i < 2 * rounds; i++) {
        struct shot s = any_shot(&rng, engine), t = s;
        const int at_pixel = rng_below(&rng, PIXELS), other = rng_below(&rng, PIXELS);
        const int sx = at_pixel % WIDTH, sy = at_pixel / WIDTH;
        t.scene = (struct scene){picture_copy(&s.scene.colour), picture_copy(&s.scene.depth)};
        if (i % 2)
            t.scene.depth.plane[0][at_pixel] = i % 8 == 1 ? (i % 16 == 1 ? 5 : 1e9f) : s.scene.depth.plane[0][other];
        else
            for (int k = 0; k < 3; k++)
                t.scene.colour.plane[k][at_pixel] = rng_float(&rng);
        struct picture a = render_scene(c, &s.scene, &s.p);
        const struct hf_report ra = report_of(c);
        struct picture b = render_scene(c, &t.scene, &s.p);
        const struct hf_report rb = report_of(c);
        const int same = ra.near_radius == rb.near_radius && ra.far_radius == rb.far_radius;
        const int before = reach_of(&s, &ra), now = reach_of(&s, &rb), reach = before > now ? before : now;
        const int far = farthest(&a, &b, sx, sy);
        if (same || s.p.model != HF_MODEL_LENS || engine == HF_ENGINE_GATHER) {
            CHECK_MSG(far <= reach, "%s: the %s sample at (%d, %d) changes pixels %d away, its reach is %d", s.name,
                      i % 2 ? "depth" : "colour", sx, sy, far, reach);
            tried += far >= 0;
        } else {
            beyond(&a, &b, sx, sy, reach, &part, &most);
        }
        picture_free(&a);
        picture_free(&b);
        scene_free(&s.scene);
        scene_free(&t.scene);
    }
    CHECK(tried > rounds);
    printf("%s: %d samples change nothing beyond their reach; one with a lens's largest radius changes %.1f %% by up "
           "to %.1f "
           "codes\n",
           hf_engine_name(engine), tried, part, most);
}

// A crop from even x and y, for the chapter with a lens one that has both largest radii, has the whole's bits farther from its cut than the reach.
static void crops(struct hf_context *c, enum hf_engine engine)
{
    struct rng rng = rng_seed(seed + 2);
    int compared = 0;
    for (int i = 0; i < 2 * rounds; i++) {
        struct shot s = any_shot(&rng, engine), t = s;
        const int x0 = 2 * rng_below(&rng, 8), y0 = 2 * rng_below(&rng, 6);
        const int w = WIDTH - x0 - 2 * rng_below(&rng, 8), h = HEIGHT - y0 - 2 * rng_below(&rng, 6);
        const int x1 = x0 + w, y1 = y0 + h;
        t.scene = (struct scene){picture_cut(&s.scene.colour, x0, y0, w, h), picture_cut(&s.scene.depth, x0, y0, w, h)};
        struct picture a = render_scene(c, &s.scene, &s.p);
        const struct hf_report ra = report_of(c);
        struct picture b = render_scene(c, &t.scene, &s.p);
        const struct hf_report rb = report_of(c);
        const int same = engine == HF_ENGINE_GATHER || s.p.model != HF_MODEL_LENS ||
                         (ra.near_radius == rb.near_radius && ra.far_radius == rb.far_radius);
        const int reach = reach_of(&s, &ra);
        int other = 0;
        for (int k = 0; k < w * h && same; k++) {
            const int x = x0 + k % w, y = y0 + k / w;
            // The frame's own edge is the crop's, too.
            if ((x0 > 0 && x - x0 < reach) || (y0 > 0 && y - y0 < reach) || (x1 < WIDTH && x1 - 1 - x < reach) ||
                (y1 < HEIGHT && y1 - 1 - y < reach))
                continue;
            compared++;
            for (int ch = 0; ch < 3; ch++)
                other += memcmp(&a.plane[ch][y * WIDTH + x], &b.plane[ch][k], sizeof(float)) != 0;
        }
        CHECK_MSG(other == 0, "%s: a crop of %d x %d from (%d, %d) differs in %d samples", s.name, w, h, x0, y0, other);
        picture_free(&a);
        picture_free(&b);
        scene_free(&s.scene);
        scene_free(&t.scene);
    }
    CHECK(compared > 100 * rounds);
    printf("%s: %d pixels of crops have the whole's bits\n", hf_engine_name(engine), compared);
}

// ---- discs ----

// A lamp of one pixel on a wall: its disc's radius by the second moment, and the radius that holds 90 % of its light. Both are
// those of a disc of this radius when divided as here. The mean of the four pixels of a quad.
static void disc_of(struct hf_context *c, float radius, double *moment, double *ninety)
{
    enum { SIZE = 80, MIDDLE = SIZE / 2 };
    double light = 0, second = 0, ring[SIZE * 4] = {0};
    struct hf_params p = scene_params();
    p.engine = HF_ENGINE_GATHER;
    p.max_radius = HF_DERIVE;
    for (int k = 0; k < 4; k++) {
        struct picture colour = picture_new(SIZE, SIZE, 3), radii = picture_new(SIZE, SIZE, 1);
        const int x0 = MIDDLE + k % 2, y0 = MIDDLE + k / 2;
        picture_fill(&radii, 0, radius);
        colour.plane[1][y0 * SIZE + x0] = 1;
        const struct hf_depth depth = picture_radii(&radii);
        struct picture out = render(c, &colour, &depth, &p);
        for (int i = 0; i < SIZE * SIZE; i++) {
            const double dx = i % SIZE - x0, dy = i / SIZE - y0, v = out.plane[1][i];
            light += v;
            second += v * (dx * dx + dy * dy);
            ring[(int)(4 * sqrt(dx * dx + dy * dy))] += v;
        }
        picture_free(&colour);
        picture_free(&radii);
        picture_free(&out);
    }
    double sum = 0;
    int i = 0;
    while (i < SIZE * 4 && sum + ring[i] < 0.9 * light)
        sum += ring[i++];
    *ninety = 0.25 * (i + (ring[i] > 0 ? (0.9 * light - sum) / ring[i] : 0)) / sqrt(0.9);
    *moment = sqrt(2 * second / light);
}

// A pixel's own width adds 1/12 along each axis to the variance twice, in the lamp and in what is seen of it: 1/3, which makes
// a disc of 1 pixel 1.29 times as large; more is the half resolution's. Kernels are polygons of pixels, and what lies between
// two kernels is a blend: 0.12 of the radius.
static void discs(struct hf_context *c)
{
    static const float radii[] = {1, 1.25f, 1.6f, 2, 2.5f, 3.3f, 4, 5, 6.5f, 8, 12};
    for (int near = 0; near < 2; near++)
        for (size_t i = 0; i < sizeof radii / sizeof *radii; i++) {
            double moment, ninety;
            disc_of(c, near ? -radii[i] : radii[i], &moment, &ninety);
            const double r = (double)radii[i], most = sqrt(1 + 2 / (3 * r * r)) + 0.12;
            printf("a %s lamp of radius %4.2f: its disc is %.3f times as large by its variance, %.3f by 90 %% of its "
                   "light\n",
                   near ? "near" : "far ", r, moment / r, ninety / r);
            CHECK_MSG(moment / r <= most && moment / r >= 0.9, "a %s lamp of radius %g: its disc is %g times as large",
                      near ? "near" : "far", r, moment / r);
        }
}

int main(int argc, char **argv)
{
    rounds = argc > 1 ? atoi(argv[1]) : check_long() ? 10 * rounds : rounds;
    seed = argc > 2 ? (unsigned)strtoul(argv[2], NULL, 10) : 1;
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    discs(c);
    second_kernel(c);
    for (int e = 0; e < 2; e++) {
        const enum hf_engine engine = e ? HF_ENGINE_CHAPTER : HF_ENGINE_GATHER;
        jumps(c, engine);
        one_sample(c, engine);
        crops(c, engine);
    }
    hf_close(&c);
    return check_report();
}
