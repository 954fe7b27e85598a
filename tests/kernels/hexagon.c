// SPDX-License-Identifier: BSD-3-Clause
// The hexagon's kernels one by one: load, the two passes of blurs, composite. Inputs are as the kernel before would
// make them, and only as large as the lines reach.
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "harness.h"
#include "pixel/pass_c.h"

static int is_half(const struct world *w)
{
    return w->hexagon.half;
}

// The buffer of a result at the setup's resolution.
static int made(const struct world *w, enum hf_hexagon_made b)
{
    return HF_HEXAGON_MADE + (is_half(w) ? HF_HEXAGON_MADE_COUNT : 0) + (int)b;
}

static int colour_buf(const struct world *w, unsigned field)
{
    return !is_half(w) ? HF_HEXAGON_COLOUR : field == HF_NEAR ? HF_HEXAGON_NEAR_COLOUR_2 : HF_HEXAGON_FAR_COLOUR_2;
}

static struct hf_rect working_rect(const struct world *w)
{
    return hf_hexagon_rect(&w->setup, w->r);
}

// The rectangle that two lines reach.
static struct hf_rect reached(const struct world *w, int line_a, int line_b)
{
    const struct hf_hexagon_line *a = &w->hexagon.line[line_a], *b = &w->hexagon.line[line_b];
    const struct hf_rect r = working_rect(w);
    return (struct hf_rect){r.x0 + hf_min(a->x0, b->x0), r.y0 + hf_min(a->y0, b->y0), r.x1 + hf_max(a->x1, b->x1),
                            r.y1 + hf_max(a->y1, b->y1)};
}

// ---- inputs ----

// Equal radii everywhere, so that whole lines count in full; radii in patches, some sharp; random radii.
enum { RADII_ALIKE, RADII_PATCHES, RADII_ANY };

static struct {
    int mode, size;
    uint32_t pattern;
    float most, alike;
} radii;

static void choose_radii(struct world *w, float most)
{
    struct rng *r = &w->rng;
    radii.mode = w->bench ? RADII_PATCHES : rng_int(r, RADII_ALIKE, RADII_ANY);
    radii.size = w->bench ? 64 : 4 << rng_int(r, 0, 4);
    radii.pattern = rng_next(r);
    radii.most = most;
    radii.alike = rng_float(r, 0, most);
}

// A radius >= 0: 0, or at least the sharp limit.
static float radius_at(struct world *w, int x, int y)
{
    static const float tiny[] = {0x1p-40f, 0x1p-20f, 1e-3f, 0.25f};
    struct rng *r = &w->rng;
    const int patch = radii.pattern >> ((x + 4096) / radii.size + 3 * ((y + 4096) / 2 / radii.size)) % 32 & 1;
    if (radii.mode == RADII_ALIKE)
        return radii.alike * (rng_one_in(r, 2) ? 1 : 0.9f);
    if (radii.mode == RADII_PATCHES)
        return patch ? 0 : radii.most * (rng_one_in(r, 40) ? 0.3f : 1);
    switch (rng_int(r, 0, 7)) {
    case 0:
        return 0;
    case 1:
        return fminf(tiny[rng_int(r, 0, 3)], radii.most);
    case 2:
        return radii.most;
    default:
        return rng_float(r, 0, radii.most);
    }
}

static void put(struct world *w, int b, int c, int x, int y, float v)
{
    *world_at(w, ARENA_MADE, b, c, x, y) = v;
}

static void put_colour(struct world *w, int b, int x, int y, float weight)
{
    for (int c = 0; c < w->setup.channels; c++)
        put(w, b, c, x, y, random_colour(&w->rng, w->colours) * (weight * HEXAGON_SCALE));
}

#define EACH(r, x, y)                                                                                                  \
    for (int y = (r).y0; y < (r).y1; y++)                                                                              \
        for (int x = (r).x0; x < (r).x1; x++)

// As Load leaves them. Each block of pixels lies on one side of the focus, so that both sides occur.
static void make_samples(struct world *w, struct hf_rect r)
{
    const int half = is_half(w);
    for (unsigned field = HF_NEAR; field <= (half ? HF_FAR : HF_NEAR); field++) {
        const int colour = colour_buf(w, field);
        make_buf(w, colour, r);
        make_buf(w, colour + 1, r);
        EACH(r, x, y)
        {
            const int near = radii.pattern >> ((x + 4096) / 16 + (y + 4096) / 8) % 29 & 1;
            const float q = radius_at(w, x, y), part = q > 0 ? half ? rng_float(&w->rng, 0.01f, 1) : 1 : 0;
            const float a = (half ? part : 1) / fmaxf(q, 1);
            put(w, colour + 1, 0, x, y, a);
            put(w, colour + 1, 1, x, y, half || !near ? q : -q);
            const int is_near = half ? field == HF_NEAR : near;
            put_colour(w, colour, x, y, a);
            const float light =
                hf_hexagon_light(*world_at(w, ARENA_MADE, colour, 0, x, y), *world_at(w, ARENA_MADE, colour, 1, x, y),
                                 *world_at(w, ARENA_MADE, colour, 2, x, y));
            const float over = light / fmaxf(q, HEXAGON_LEAST_MEAN);
            put(w, colour + 1, 2, x, y, is_near || q == 0 ? a * sqrtf(fmaxf(q, 1)) : over);
        }
    }
}

// As pass 1 leaves them: 0 where there is no radius.
static void make_first(struct world *w, struct hf_rect r)
{
    const int weights = made(w, HF_HEXAGON_NEAR_W), far_weights = made(w, HF_HEXAGON_FAR_W);
    make_buf(w, weights, r);
    make_buf(w, far_weights, r);
    for (int b = 0; b < 2; b++) {
        const int near = made(w, b ? HF_HEXAGON_NEAR_B : HF_HEXAGON_NEAR_U);
        const int far = made(w, b ? HF_HEXAGON_FAR_B : HF_HEXAGON_FAR_U);
        make_buf(w, near, r);
        make_buf(w, far, r);
        EACH(r, x, y)
        {
            const float q = radius_at(w, x, y), a = q > 0 ? rng_float(&w->rng, 0.001f, 1) / fmaxf(q, 1) : 0;
            put(w, weights, 2 * b, x, y, a);
            put(w, weights, 2 * b + 1, x, y, q);
            put_colour(w, near, x, y, a);
            // If the pixel itself is far, something was found.
            const int weight = colour_buf(w, HF_FAR) + 1;
            const float own = *world_at(w, ARENA_MADE, weight, 1, x, y);
            const float found = own > 0 ? fmaxf(radius_at(w, x, y), 0.01f) : 0,
                        far_a = own > 0 ? 1 / fmaxf(found, 1) : 0;
            put(w, far_weights, 2 * b, x, y, far_a);
            put(w, far_weights, 2 * b + 1, x, y, found);
            put_colour(w, far, x, y, far_a);
        }
    }
}

// As pass 2 leaves them; the radii are the frame's own.
static void make_second(struct world *w, const struct hf_frame *f)
{
    const int half = is_half(w);
    const struct hf_rect r = half ? rect_grown(w->r, (struct hf_reach){1, 1}) : working_rect(w);
    const int near = made(w, HF_HEXAGON_NEAR), far = made(w, HF_HEXAGON_FAR), cover = made(w, HF_HEXAGON_COVERAGE);
    const int weight = colour_buf(w, HF_FAR) + 1;
    make_buf(w, near, r);
    make_buf(w, far, r);
    const int behind = made(w, HF_HEXAGON_BEHIND), behind_weight = made(w, HF_HEXAGON_BEHIND_W);
    make_buf(w, cover, r);
    make_buf(w, weight, r);
    make_buf(w, behind, r);
    make_buf(w, behind_weight, r);
    make_buf(w, colour_buf(w, HF_FAR), r);
    choose_radii(w, 1.25f);  // coverage
    EACH(r, x, y)
    {
        const float a = radius_at(w, x, y);
        put(w, cover, 0, x, y, a);
        put_colour(w, near, x, y, a);
        put_colour(w, far, x, y, 1);
        // Either no weight, or a weight well above the smallest that counts.
        const float seen = rng_one_in(&w->rng, 3) ? 0 : rng_float(&w->rng, 0.01f, 2);
        put(w, behind_weight, 0, x, y, seen);
        put_colour(w, behind, x, y, seen);
        // A whole sample, or that of a mixed pixel.
        const float part = rng_one_in(&w->rng, 3) ? rng_float(&w->rng, 0.03f, 1) : 1;
        put(w, weight, 0, x, y, part);
        put_colour(w, colour_buf(w, HF_FAR), x, y, part);
    }
    choose_radii(w, 4);
    EACH(r, x, y)
    if (half)
        put(w, weight, 1, x, y, radius_at(w, x, y));
    for (int y = r.y0; y < r.y1 && !half; y++)
        hf_radius_row_c(f, r.x0, y, r.x1 - r.x0, world_at(w, ARENA_MADE, weight, 1, r.x0, y), NULL);
}

static void make_lines_and_work(struct world *w)
{
    const int width = w->r.x1 - w->r.x0;
    make_lines(w, HF_LINES, (size_t)(2 * width + 2 * HF_PAD));
    slot_use(w, SLOT_WORK, w->line_floats * sizeof(float), 0xff);
}

static void start(struct world *w)
{
    struct rng *r = &w->rng;
    world_clear(w);
    do {
        make_setup(w, w->bench ? 128 : rng_int(r, 1, 70), w->bench ? 64 : rng_int(r, 1, 10));
        w->params.engine = HF_ENGINE_HEXAGON;
        w->params.aperture.blades = 0;
        w->params.hexagon.resolution = !w->bench && rng_one_in(r, 2) ? HF_RESOLUTION_HALF : HF_RESOLUTION_FULL;
        w->params.hexagon.uniform = 0;
        world_setup(w, &w->hexagon);
    } while (w->resolved.sharp);
    w->engine = &hf_hexagon_engine;
    const float most = w->setup.max_radius * (w->bench || rng_one_in(r, 4) ? 1 : rng_float(r, 0, 1));
    const struct hf_counts found = {.radius_min = -most, .radius_max = most / 2};
    if (w->engine->own.prepare(&w->hexagon, &w->setup, &w->resolved.params, &hf_mem_default) != HF_OK ||
        w->engine->own.measure(&w->hexagon, &w->setup, &found, &hf_mem_default) != HF_OK)
        abort();
    w->hexagon.mixed = 0;  // tests/engines/hexagon.c
    choose_radii(w, is_half(w) ? most / 2 : most);
    random_area(w);
    w->is_pass = 1;
    w->near = w->far = 1;
    if (!w->bench && rng_one_in(r, 2))
        rng_one_in(r, 2) ? (w->near = 0) : (w->far = 0);
    make_lines_and_work(w);
}

static void output(struct world *w, int b)
{
    make_output(w, REGION_FLOATS, b, working_rect(w));
}

void hexagon_make(struct world *w, int which)
{
    start(w);
    if (which == HEXAGON_LOAD || which == HEXAGON_COMPOSITE) {
        make_image(w, &w->src, SLOT_SRC, rng_one_in(&w->rng, 4));
        make_depth(w, rng_one_in(&w->rng, 4));
    }
    const struct kernels *none = &(const struct kernels){0};
    switch (which) {
    case HEXAGON_LOAD:
        w->near = w->far = 1;
        for (int b = 0; b < HF_HEXAGON_MADE; b++)
            if (buf_channels(w, b))
                output(w, b);
        return;
    case HEXAGON_FIRST:
        make_samples(w, reached(w, 0, 1));
        for (int b = w->near ? HF_HEXAGON_NEAR_U : HF_HEXAGON_FAR_U; b < (w->far ? HF_HEXAGON_NEAR : HF_HEXAGON_FAR_U);
             b++)
            output(w, made(w, (enum hf_hexagon_made)b));
        return;
    case HEXAGON_SECOND:
        make_samples(w, reached(w, 1, 2));
        make_first(w, reached(w, 1, 2));
        for (int b = w->near ? HF_HEXAGON_NEAR : HF_HEXAGON_FAR; b < (w->far ? HF_HEXAGON_BEHIND : HF_HEXAGON_FAR); b++)
            output(w, made(w, (enum hf_hexagon_made)b));
        return;
    default: {
        const struct hf_frame f = world_frame(w, none, ARENA_MADE);
        make_second(w, &f);
        make_dst(w);
    }
    }
}

void hexagon_call(struct world *w, const struct kernels *k, enum arena a, int which)
{
    const struct hf_frame f = world_frame(w, k, a);
    if (a == ARENA_REFERENCE)
        w->reference = f;
    hf_kernel *const kernel[] = {k->hexagon.passes.pass[HF_HEXAGON_LOAD], k->hexagon.first, k->hexagon.second,
                                 k->hexagon.passes.pass[HF_HEXAGON_COMPOSITE]};
    kernel[which](&f, w->r);
}

// ---- how far fused arithmetic may be from the C: see bound.c for what is counted ----

// A line's sums in double precision; the terms' magnitudes; the number of additions.
struct line_sums {
    double colour, colour_size, a, a_size, w, w_size, n;
};

// p: the far pixel's radius; 0: near, without a limit.
static struct line_sums sum_line(const struct world *w, const struct hf_hexagon_field *in, int line, int c, int x,
                                 int y, float p)
{
    const struct hf_hexagon_line *l = &w->hexagon.line[line];
    struct line_sums s = {.n = l->count};
    for (const struct hf_hexagon_tap *t = l->taps; t < l->taps + l->count; t++) {
        const int u = x + t->dx, v = y + t->dy;
        const double q = in->sign * *hf_at(in->radius, in->q, u, v), colour = *hf_at(in->colour, c, u, v);
        const double a = *hf_at(in->weight, in->a, u, v);
        double weight = fmin(q - t->c, t->b);
        if (!(weight > 0))
            continue;
        if (p > 0)
            weight = fmax(fmin(weight, t->b * (2 * p / fmin(p, 1) + 1 - q / fmin(p, 1))), 0);
        const double most = t->b * t->part;
        weight *= t->part;
        s.colour += weight * colour;
        s.colour_size += most * fabs(colour);
        s.a += weight * a;
        s.a_size += most * a;
        s.w += in->mean < 0 ? 0 : weight * *hf_at(in->weight, in->mean, u, v);
        s.w_size += in->mean < 0 ? 0 : most * *hf_at(in->weight, in->mean, u, v);
    }
    return s;
}

// A line of the far field. Roundings of each sum: a product and an addition per tap, and 3 for the tap's weight (2 for
// its limit, 3 minus a smaller product; 1 for its product with the tap's part). The pixel's own weight, 1 minus the sum
// of weights or less, has the error of that sum and 4 roundings more. The divisor is at least a quarter.
struct far_sums {
    double value, error, w, w_error;  // the colour; light over radii
};

static struct far_sums far_line(const struct world *w, const struct hf_hexagon_field *in, int line, int c, int x, int y,
                                float p)
{
    struct far_sums f = {0};
    if (!(p > 0))
        return f;
    const struct line_sums s = sum_line(w, in, line, c, x, y, p);
    const double k = (s.n + 4) * FLT_EPSILON, a_error = k * s.a_size;
    const double own = fmax(fmax((1 - s.a) * fmin(fmax(HEXAGON_ALL - p, 0), 1), HEXAGON_LEAST - s.a), 0);
    const double mine = *hf_at(in->colour, c, x, y) / (double)*hf_at(in->weight, in->a, x, y);
    const double sum = s.colour + own * mine, divisor = s.a + own;
    const double error = k * s.colour_size + (a_error + (4 + 2 * own) * FLT_EPSILON) * fabs(mine);
    f.value = sum / divisor;
    f.error = bound_quotient(error, 2 * a_error + 6 * FLT_EPSILON, divisor, fabs(f.value));
    if (in->mean >= 0) {
        const double over = *hf_at(in->weight, in->mean, x, y) / (double)*hf_at(in->weight, in->a, x, y);
        f.w = (s.w + own * over) / divisor;
        f.w_error = bound_quotient(k * s.w_size + (a_error + (4 + 2 * own) * FLT_EPSILON) * over,
                                   2 * a_error + 6 * FLT_EPSILON, divisor, f.w);
    }
    return f;
}

// What pass 1 computes along one line, or along both.
static struct far_sums far_lines(const struct world *w, int both, int c, int x, int y, float p)
{
    const struct hf_hexagon_field in = hf_hexagon_field(&w->reference, HF_FAR);
    struct far_sums u = far_line(w, &in, 0, c, x, y, p);
    if (both) {
        const struct far_sums v = far_line(w, &in, 1, c, x, y, p);
        u.error += v.error + FLT_EPSILON * (fabs(u.value) + fabs(v.value));
        u.value += v.value;
        u.w += v.w;
        u.w_error += v.w_error + 2 * FLT_EPSILON * u.w;
    }
    return u;
}

static double bound_far_1(const struct world *w, int b, int c, int x, int y)
{
    const struct hf_hexagon_field in = hf_hexagon_field(&w->reference, HF_FAR);
    const float p = *hf_at(in.radius, in.q, x, y);
    const int is_weight = b == HF_HEXAGON_FAR_W, both = is_weight ? c >= 2 : b == HF_HEXAGON_FAR_B;
    double light = 0, size = 0, light_error = 0;
    if (!(p > 0))
        return 0;
    for (int i = 0; i < 3; i++) {
        const struct far_sums u = far_lines(w, both, i, x, y, p);
        light += u.value;
        size += fabs(u.value);
        light_error += u.error;
    }
    // The mean radius; and the weight: the pixel's share in the far field over that radius, or over 1 if that is
    // larger.
    const double part = *hf_at(in.weight, in.a, x, y) * fmax(p, 1);
    const struct far_sums u = far_lines(w, both, is_weight ? 0 : c, x, y, p);
    light_error += 2 * FLT_EPSILON * size;
    const double mean = u.w > 0 ? fabs(light) / u.w : p, q = fmax(mean, HEXAGON_LEAST_MEAN), a = part / fmax(q, 1);
    const double q_error = u.w > 0 ? bound_quotient(light_error, u.w_error, u.w, mean) + FLT_EPSILON * mean : 0;
    const double a_error = a * (q_error / fmax(q, 1) * 2 + 2 * FLT_EPSILON);
    if (is_weight)
        return c % 2 ? q_error : a_error;
    return (u.error + 2 * FLT_EPSILON * fabs(u.value)) * a + fabs(u.value) * a_error;
}

static double bound_far_2(const struct world *w, int c, int x, int y)
{
    const struct hf_hexagon_field in[2] = {hf_hexagon_field_2(&w->reference, HF_FAR, 0),
                                           hf_hexagon_field_2(&w->reference, HF_FAR, 1)};
    const struct hf_hexagon_field pixel = hf_hexagon_field(&w->reference, HF_FAR);
    const float p = *hf_at(pixel.radius, pixel.q, x, y);
    const struct far_sums v = far_line(w, &in[0], 1, c, x, y, p), u = far_line(w, &in[1], 2, c, x, y, p);
    return (v.error + u.error + 2 * FLT_EPSILON * (fabs(v.value) + fabs(u.value))) / 3;
}

// Near sums have no negative terms, except those of colour. A quotient of two of them has at most twice the roundings
// of their additions, its square four times, and the product of that square with a third sum five times.
static double bound_near_1(const struct world *w, int b, int c, int x, int y)
{
    const struct hf_hexagon_field in = hf_hexagon_field(&w->reference, HF_NEAR);
    const int colour = b == HF_HEXAGON_NEAR_W ? 0 : c;
    struct line_sums s = sum_line(w, &in, 0, colour, x, y, 0);
    if (b == HF_HEXAGON_NEAR_B || (b == HF_HEXAGON_NEAR_W && c >= 2)) {
        const struct line_sums v = sum_line(w, &in, 1, colour, x, y, 0);
        s.colour_size += v.colour_size;
        s.a += v.a;
        s.w += v.w;
        s.n += v.n + 1;
    }
    if (!(s.a > 0))
        return 0;
    const double root = s.a / s.w, share = root * root, k = (5 * s.n + 16) * FLT_EPSILON;
    if (b == HF_HEXAGON_NEAR_W)
        return c % 2 ? k / share : k * s.a * share;
    return k * s.colour_size * share;
}

static double bound_near_2(const struct world *w, int b, int c, int x, int y)
{
    double size = 0, n = 0;
    for (int i = 0; i < 2; i++) {
        const struct hf_hexagon_field in = hf_hexagon_field_2(&w->reference, HF_NEAR, i);
        const struct line_sums s = sum_line(w, &in, 1 + i, b == HF_HEXAGON_COVERAGE ? 0 : c, x, y, 0);
        size += b == HF_HEXAGON_COVERAGE ? s.a_size : s.colour_size;
        n = fmax(n, s.n);
    }
    return (n + 3) * FLT_EPSILON * size / 3;
}

// Load: products and two additions for a mean of four colours, then the product with a weight. Light: the sum of three
// such means over a radius.
static double bound_load(const struct world *w, int b, int c, int x, int y)
{
    const int is_colour =
        b == HF_HEXAGON_NEAR_COLOUR_2 || b == HF_HEXAGON_FAR_COLOUR_2 || b == HF_HEXAGON_SEEN_COLOUR_2;
    if (b == HF_HEXAGON_FAR_WEIGHT_2 && c == 2) {
        double light = 0;
        for (int i = 0; i < 3; i++)
            light += (5 + 3) * FLT_EPSILON * HEXAGON_SCALE *
                     bound_largest_sample(w, i, 2 * x - 1, 2 * y - 1, 2 * x + 2, 2 * y + 2);
        return light / HEXAGON_LEAST_MEAN;
    }
    const double most = bound_largest_sample(w, c, 2 * x - 1, 2 * y - 1, 2 * x + 2, 2 * y + 2);
    return is_colour ? 5 * FLT_EPSILON * HEXAGON_SCALE * most : 0;
}

double hexagon_bound_buffer(const struct world *w, int b, int c, int x, int y, float want)
{
    double bound = 0;
    (void)want;
    const int m = b < HF_HEXAGON_MADE ? -1 : (b - HF_HEXAGON_MADE) % HF_HEXAGON_MADE_COUNT;
    switch (m) {
    case -1:
        bound = bound_load(w, b, c, x, y);
        break;
    case HF_HEXAGON_FAR_U:
    case HF_HEXAGON_FAR_B:
    case HF_HEXAGON_FAR_W:
        bound = bound_far_1(w, m, c, x, y);
        break;
    case HF_HEXAGON_FAR:
        bound = bound_far_2(w, c, x, y);
        break;
    case HF_HEXAGON_NEAR:
    case HF_HEXAGON_COVERAGE:
        bound = bound_near_2(w, m, c, x, y);
        break;
    default:
        bound = bound_near_1(w, m, c, x, y);
    }
    return bound > 0 ? bound + 0x1p-140 : 0;
}

// The largest colour in a rectangle: channel c of a premultiplied buffer over its weight.
static double largest_colour(const struct hf_frame *f, enum hf_hexagon_made colour, enum hf_hexagon_made weight, int c,
                             struct hf_rect r)
{
    double most = 0;
    EACH(r, x, y)
    {
        const double a = weight == colour ? 1 : *hf_at(hf_hexagon_made(f, weight), 0, x, y);
        if (a > 0)
            most = fmax(most, fabs((double)*hf_at(hf_hexagon_made(f, colour), c, x, y)) / a / HEXAGON_SCALE);
    }
    return most;
}

// Composite: a mean of a near colour and a background, weighted by coverage and by the rest. Roundings, of the largest
// colour. At half resolution, coverage and the background are quotients of means of four (4 and 4, 1), blended twice (3
// each); the far colour has no more. The rest is 1 minus coverage (4 and 1). An error in both weights counts by the
// difference of the two colours, at most twice the largest. Then a product, two additions and a quotient (4). In a
// mixed pixel the sample times its radius is subtracted and as much of the far field added: two products and two
// additions (4) of three colours.
double hexagon_bound_pixel(const struct world *w, int c, int x, int y)
{
    const struct hf_frame *f = &w->reference;
    double source = 0, most = bound_largest_sample(w, c, x - 1, y - 1, x + 1, y + 1);
    const int half = is_half(w), reach = half ? 1 : 0, u = half ? x / 2 : x, v = half ? y / 2 : y;
    const struct hf_rect r = {u - reach, v - reach, u + reach + 1, v + reach + 1};
    if (w->near && c < w->setup.channels) {
        most = fmax(most, largest_colour(f, HF_HEXAGON_NEAR, HF_HEXAGON_COVERAGE, c, r));
        most = fmax(most, largest_colour(f, HF_HEXAGON_BEHIND, HF_HEXAGON_BEHIND_W, c, r));
    }
    if (w->far && c < w->setup.channels)
        most = fmax(most, largest_colour(f, HF_HEXAGON_FAR, HF_HEXAGON_FAR, c, r));
    if (!half && c < w->setup.channels)
        EACH(r, i, j)
        {
            const float size = fmaxf(1, *hf_at(&f->buf[HF_HEXAGON_WEIGHT], 1, i, j));
            source = fabs((double)*hf_at(&f->buf[HF_HEXAGON_COLOUR], c, i, j)) * size / HEXAGON_SCALE;
        }
    return ((4 + 4 + 1 + 3 + 3 + 2 * (4 + 4 + 1) + 4) * most + (half ? 0 : 4 * (2 * most + source))) * FLT_EPSILON +
           0x1p-130;
}
