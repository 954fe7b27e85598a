// SPDX-License-Identifier: BSD-3-Clause
// The hexagon: two passes of blurs along lines, see hexagon.h. A pixel costs O(largest radius around it) taps. With one
// radius everywhere (uniform) that is O(radius): four lines with two taps every 1.15 pixels.
#include <math.h>

#include "pass/cells.h"
#include "pass/check.h"
#include "engine/hexagon/kernels.h"
#include "pixel/behind.h"
#include "pixel/edges.h"

#define FRAME(name) (1u << HF_HEXAGON_##name)
#define MADE(name)                                                                                                     \
    (1u << (HF_HEXAGON_MADE + HF_HEXAGON_##name) | 1u << (HF_HEXAGON_MADE + HF_HEXAGON_MADE_COUNT + HF_HEXAGON_##name))
#define FIELDS (MADE(NEAR) | MADE(COVERAGE) | MADE(FAR))
#define WEIGHTS (FRAME(WEIGHT) | FRAME(NEAR_WEIGHT_2) | FRAME(FAR_WEIGHT_2))
#define INPUT (WEIGHTS | FRAME(COLOUR) | FRAME(NEAR_COLOUR_2) | FRAME(FAR_COLOUR_2))
#define FAR_2 (FRAME(FAR_COLOUR_2) | FRAME(FAR_WEIGHT_2))
#define SEEN ((INPUT & ~FAR_2) | FRAME(SEEN_COLOUR_2) | FRAME(SEEN_WEIGHT_2))
#define BEHIND (MADE(BEHIND) | MADE(BEHIND_W))

// Halos: twice the largest CoC radius; the neighbourhoods around near pixels; and a pixel.
enum { HALO_RADIUS = 1, HALO_BEHIND, HALO_UPSAMPLE };

static const struct hf_pass passes[HF_HEXAGON_PASSES] = {
    {"CoC generation", .sweep = 1, .ns = 3},
    {"Load", .writes = INPUT | SEEN, .sweep = 1, .ns = 20},
    {"Passes 1 and 2", .around = INPUT, .writes = FIELDS, .halo = HALO_RADIUS, .sweep = 2, .ns = 27, .ns_radius = 2.7f},
    {"Behind", .around = SEEN, .writes = BEHIND, .halo = HALO_BEHIND, .sweep = 2, .field = HF_NEAR, .ns = 23,
     .ns_radius = 1.45f},
    {"Composite", .reads = FRAME(WEIGHT) | FRAME(COLOUR), .around = FIELDS | BEHIND | FRAME(FAR_WEIGHT_2),
     .halo = HALO_UPSAMPLE, .sweep = 2, .ns = 14},
};

#define FULL .x = 1, .y = 1
#define NAMED(b, name, ...)                                                                                            \
    [HF_HEXAGON_MADE + HF_HEXAGON_##b] = {name, FULL, __VA_ARGS__},                                                    \
                       [HF_HEXAGON_MADE + HF_HEXAGON_MADE_COUNT + HF_HEXAGON_##b] = {name, __VA_ARGS__}

static const struct hf_buf_def bufs[HF_HEXAGON_BUF_COUNT] = {
    [HF_HEXAGON_COLOUR] = {"colour", .frame = 1, FULL},
    [HF_HEXAGON_WEIGHT] = {"weight", .frame = 1, FULL},
    [HF_HEXAGON_NEAR_COLOUR_2] = {"nearcolour", .frame = 1},
    [HF_HEXAGON_NEAR_WEIGHT_2] = {"nearweight", .frame = 1},
    [HF_HEXAGON_FAR_COLOUR_2] = {"farcolour", .frame = 1},
    [HF_HEXAGON_FAR_WEIGHT_2] = {"farweight", .frame = 1},
    [HF_HEXAGON_SEEN_COLOUR_2] = {"seencolour", .frame = 1},
    [HF_HEXAGON_SEEN_WEIGHT_2] = {"seenweight", .frame = 1},
    NAMED(NEAR, "near", .field = HF_NEAR),
    NAMED(COVERAGE, "nearcoverage", .field = HF_NEAR),
    NAMED(FAR, "far", .field = HF_FAR),
    NAMED(BEHIND, "behind", .field = HF_NEAR),
    NAMED(BEHIND_W, "behindweight", .field = HF_NEAR),
};

static int channels(const struct hf_setup *s, int b)
{
    const int half = hf_hexagon(s)->half;
    if (half !=
        (b >= HF_HEXAGON_MADE + HF_HEXAGON_MADE_COUNT || (b >= HF_HEXAGON_NEAR_COLOUR_2 && b < HF_HEXAGON_MADE)))
        return 0;
    if (b < HF_HEXAGON_MADE)
        return b == HF_HEXAGON_SEEN_WEIGHT_2 ? 1 : b % 2 ? 3 : s->channels;
    switch ((b - HF_HEXAGON_MADE) % HF_HEXAGON_MADE_COUNT) {
    case HF_HEXAGON_NEAR_W:
    case HF_HEXAGON_FAR_W:
        return 4;
    case HF_HEXAGON_COVERAGE:
    case HF_HEXAGON_BEHIND_W:
        return 1;
    default:
        return s->channels;
    }
}

// How far lines go, in working pixels. A sample that is near by less than a pixel is spread thinly over one.
static float working(const struct hf_setup *s, float radius)
{
    return fmaxf(hf_hexagon(s)->half ? radius / 2 : radius, 1);
}

// The most places that a line can have. They are at least as far apart as columns of narrow pixels.
static int place_count(const struct hf_setup *s, float radius)
{
    return (int)ceil((working(s, radius) + 4) / fmin(s->pixel_aspect, 1));
}

static int check(struct hf_settings *r, const struct hf_params *asked, const struct hf_depth *depth,
                 struct hf_message *message)
{
    const struct hf_params *p = &r->params;
    (void)asked;
    if (p->aperture.blades && p->aperture.blades != 6)
        return hf_bad(message, "aperture.blades", "is %d; the hexagon engine draws six sides (0 or 6)",
                      p->aperture.blades);
    if (p->hexagon.uniform)  // at any depth
        r->sharp =
            p->max_radius == 0 || (depth->type != HF_DEPTH_COC && p->model == HF_MODEL_RANGE && p->range.strength == 0);
    return hf_check_resolution("hexagon", p->hexagon.resolution, HF_RESOLUTION_HALF, message);
}

static void resolve(void *own, struct hf_setup *s, const struct hf_depth *depth, const struct hf_params *p)
{
    struct hf_hexagon *h = own;
    (void)depth;
    h->ready = h->reach_x = h->reach_y = h->behind = h->mixed = 0;
    h->rotation = p->aperture.rotation;
    h->half = p->hexagon.resolution == HF_RESOLUTION_HALF;
    h->made = HF_HEXAGON_MADE + (h->half ? HF_HEXAGON_MADE_COUNT : 0);
    h->width = h->half ? s->half_width : s->width;
    h->height = h->half ? s->half_height : s->height;
    s->uniform = p->hexagon.uniform;
    // Below this radius weights and colours times radii would be denormal, and a pixel's soft edge would have no slope.
    s->sharp_radius = 0x1p-40f;
}

static int prepare(void *own, const struct hf_setup *s, const struct hf_params *p, const struct hf_mem *mem)
{
    struct hf_hexagon *h = own;
    (void)p;
    // A place has 2 x 2 taps; for two and four rows together they are 2 x 3 and 2 x 5. One more step ends the list.
    const size_t n = (size_t)place_count(s, s->max_radius), taps = 4 * n + 1, two = 6 * n + 1, four = 10 * n + 1;
    const size_t line = taps * sizeof(struct hf_hexagon_tap) + (taps + two + four) * sizeof(struct hf_hexagon_step);
    const int err = hf_block_grow(&h->block, 3 * line, mem);
    if (err)
        return err;
    h->ready = 1;
    struct hf_hexagon_step *step = h->block.data;
    for (int i = 0; i < 3; i++, step += taps + two + four)
        h->line[i] =
            (struct hf_hexagon_line){.one.step = step, .two.step = step + taps, .four.step = step + taps + two};
    for (int i = 0; i < 3; i++)
        h->line[i].taps = (struct hf_hexagon_tap *)step + i * taps;
    return HF_OK;
}

static void release(void *own, const struct hf_mem *mem)
{
    hf_block_free(&((struct hf_hexagon *)own)->block, mem);
}

static size_t held(const void *own)
{
    return ((const struct hf_hexagon *)own)->block.size;
}

// A line's direction in units of 2^-40 pixel. Distances along it are exact, so their order is the same from every
// pixel.
struct direction {
    int64_t x, y;
};

// Whether (ax, ay) comes before (bx, by) on the line.
static int comes_before(const struct direction *d, int ax, int ay, int bx, int by)
{
    const int64_t t = (ax - bx) * d->x + (ay - by) * d->y;
    return t != 0 ? t < 0 : ax != bx ? ax < bx : ay < by;
}

// Insert a tap by its distance. The pixels of a place are close to each other, so it moves past few.
static void add_tap(struct hf_hexagon_line *l, const struct direction *d, const struct hf_hexagon_tap *tap)
{
    int i = l->count++;
    for (; i > 0 && comes_before(d, tap->dx, tap->dy, l->taps[i - 1].dx, l->taps[i - 1].dy); i--)
        l->taps[i] = l->taps[i - 1];
    l->taps[i] = *tap;
    l->x0 = hf_min(l->x0, tap->dx);
    l->x1 = hf_max(l->x1, tap->dx);
    l->y0 = hf_min(l->y0, tap->dy);
    l->y1 = hf_max(l->y1, tap->dy);
}

// Unit vectors of the three sides, x and y in units of a pixel's height.
static void directions(float rotation, double u[3][2])
{
    for (int i = 0; i < 3; i++) {
        const double angle = (rotation + (i == 0 ? 0 : i == 1 ? 240 : 120)) * (M_PI / 180);
        u[i][0] = sin(angle);
        u[i][1] = -cos(angle);
    }
}

// The distance of a line's places. The line farthest from both axes has a place on every column or row. Where pixels
// are far from square, that would put the other lines' places too far apart, so it is limited.
static double spacing(const struct hf_setup *s, const double u[3][2])
{
    double most = 0, least = INFINITY;
    for (int i = 0; i < 3; i++) {
        const double each = 1 / fmax(fabs(u[i][0]) / s->pixel_aspect, fabs(u[i][1]));
        most = fmax(most, each);
        least = fmin(least, each);
    }
    return fmin(most, 1.16 * least);
}

// Make the taps of a line in direction u (pixels of height 1), as far as a sample of this radius reaches.
static void make_line(const struct hf_setup *s, struct hf_hexagon_line *l, const struct direction *d, const double u[2],
                      double step, float radius)
{
    const float reach = working(s, radius);
    // Upsampling from half resolution widens what is drawn. Places therefore lie a little nearer; the ray-traced scenes
    // gave the value.
    const double nearer = hf_hexagon(s)->half ? 0.05 : 0;
    float c = 0;
    l->count = l->x0 = l->y0 = l->x1 = l->y1 = 0;
    for (int k = 0; c < reach; k++) {
        // Rounded to 4096ths of a pixel, so that a place on a row or column stays on it.
        const double t = k ? k * step - nearer : 0;
        const double x = round(t * u[0] / s->pixel_aspect * 4096) / 4096, y = round(t * u[1] * 4096) / 4096;
        const int ix = (int)floor(x), iy = (int)floor(y);
        const float b = (float)(k ? step : 0.5 * step);
        for (int i = 0; i < 4; i++) {
            const int dx = ix + (i & 1), dy = iy + (i >> 1);
            const double part = (1 - fabs(x - dx)) * (1 - fabs(y - dy));
            if (part > 0)
                add_tap(l, d, &(struct hf_hexagon_tap){dx, dy, b, c, (float)part});
        }
        c += b;
    }
}

// Make the steps for rows computed together. They meet each sample once, in the order of its distance from the first
// row, which is also the order for each other row.
static void make_steps(const struct hf_hexagon_line *l, const struct direction *d, int rows, struct hf_hexagon_steps *s)
{
    int next[HF_HEXAGON_ROWS] = {0};
    for (s->count = 0;; s->count++) {
        struct hf_hexagon_step *step = &s->step[s->count];
        *step = (struct hf_hexagon_step){.least = INFINITY};
        int first = -1;
        for (int i = 0; i < rows; i++) {
            const struct hf_hexagon_tap *t = &l->taps[next[i]];
            if (next[i] == l->count || (first >= 0 && !comes_before(d, t->dx, t->dy + i, step->dx, step->dy)))
                continue;
            first = i;
            step->dx = t->dx;
            step->dy = t->dy + i;
        }
        if (first < 0)
            return;
        for (int i = 0; i < rows; i++) {
            const struct hf_hexagon_tap *t = &l->taps[next[i]];
            if (next[i] == l->count || t->dx != step->dx || t->dy + i != step->dy)
                continue;
            step->rows |= 1u << i;
            step->b[i] = t->b;
            step->c[i] = t->c;
            step->part[i] = t->part;
            step->whole[i] = t->part * t->b;
            step->least = fminf(step->least, t->c);
            next[i]++;
        }
    }
}

// Limit a line's taps to twice the frame's size. From any pixel, taps that far away find nothing (hf_hexagon_nearest).
// Returns whether there were such taps.
static int keep_inside(const struct hf_setup *s, struct hf_hexagon_line *l)
{
    const int x = 2 * s->width, y = 2 * s->height, outside = l->x0 < -x || l->x1 > x || l->y0 < -y || l->y1 > y;
    for (int i = 0; i < l->count; i++) {
        l->taps[i].dx = hf_max(hf_min(l->taps[i].dx, x), -x);
        l->taps[i].dy = hf_max(hf_min(l->taps[i].dy, y), -y);
        l->one.step[i].dx = l->taps[i].dx;
        l->one.step[i].dy = l->taps[i].dy;
    }
    l->x0 = hf_max(l->x0, -x);
    l->x1 = hf_min(l->x1, x);
    l->y0 = hf_max(l->y0, -y);
    l->y1 = hf_min(l->y1, y);
    return outside;
}

static int half_resolution(const struct hf_setup *s, int working)
{
    return hf_hexagon(s)->half ? working : (working + 1) / 2;
}

static int measure(void *own, struct hf_setup *s, const struct hf_counts *found, const struct hf_mem *mem)
{
    struct hf_hexagon *h = own;
    (void)mem;
    const float radius = fmaxf(-found->radius_min, found->radius_max);
    int x = 0, y = 0;
    double u[3][2];
    directions(h->rotation, u);
    const double step = spacing(s, u);
    h->mixed = !h->half && found->radius_max - found->radius_min > HF_EDGES_FROM;
    h->behind = hf_behind_levels(fmaxf(-found->radius_min, 0));
    for (int i = 0; i < 3; i++) {
        struct hf_hexagon_line *l = &h->line[i];
        const struct direction d = {llround(u[i][0] * s->pixel_aspect * 0x1p40), llround(u[i][1] * 0x1p40)};
        h->side[i][0] = (float)copysign(fmin(s->pixel_aspect / fabs(u[i][0]), 0x1p40), u[i][0]);
        h->side[i][1] = (float)copysign(fmin(1 / fabs(u[i][1]), 0x1p40), u[i][1]);
        make_line(s, l, &d, u[i], step, radius);
        make_steps(l, &d, 1, &l->one);
        make_steps(l, &d, 2, &l->two);
        make_steps(l, &d, 4, &l->four);
        if (keep_inside(s, l))
            l->two.count = l->four.count = 0;
        x = hf_max(x, hf_max(-l->x0, l->x1));
        y = hf_max(y, hf_max(-l->y0, l->y1));
    }
    for (int i = 0; i < 2; i++)
        h->clear[i] = 2.01f / fminf(fabsf(h->side[0][i]), fminf(fabsf(h->side[1][i]), fabsf(h->side[2][i])));
    const struct hf_hexagon_line *v = &h->line[1], *w = &h->line[2];
    h->reach_x = half_resolution(s, x);
    h->reach_y = half_resolution(s, y);
    h->left = half_resolution(s, -hf_min(v->x0, w->x0));
    h->right = half_resolution(s, hf_max(v->x1, w->x1));
    h->above = half_resolution(s, -hf_min(v->y0, w->y0));
    h->below = half_resolution(s, hf_max(v->y1, w->y1));
    return HF_OK;
}

static struct hf_reach halo(const struct hf_setup *s, int halo)
{
    const int behind = hf_behind_halo(hf_hexagon(s)->behind), upsample = hf_hexagon(s)->half;
    if (halo == HALO_RADIUS)
        return (struct hf_reach){2 * hf_hexagon(s)->reach_x, 2 * hf_hexagon(s)->reach_y};
    return halo == HALO_BEHIND ? (struct hf_reach){behind, behind} : (struct hf_reach){upsample, upsample};
}

// A far pixel, or the background behind a near one, changes only the pixel itself and those mixed with it. A near pixel
// changes all that its blur reaches.
static struct hf_reach spread(const struct hf_setup *s, const struct hf_cells *p, unsigned field)
{
    const struct hf_reach made = p->pass[HF_HEXAGON_BLUR], around = halo(s, HALO_RADIUS);
    const int mixed = hf_hexagon(s)->mixed;
    return field == HF_FAR ? (struct hf_reach){mixed, mixed} : (struct hf_reach){made.x + around.x, made.y + around.y};
}

// Scratch for a row of radii, or for a band. Where results are upsampled, a band is a pixel wider on either side.
static size_t work(const struct hf_setup *s, const struct hf_cells *p)
{
    const size_t band = hf_hexagon(s)->ready ? hf_hexagon_band_floats(s, p->width[2] + 2) : 0;
    const size_t behind = hf_behind_floats(hf_hexagon(s)->behind, s->channels + 1);
    const size_t most = band > behind ? band : behind;
    const size_t edges = hf_hexagon(s)->mixed ? hf_edges_floats(p->width[1], s->channels) : 0;
    const size_t all = most > edges ? most : edges;
    return all > p->line_floats ? all : p->line_floats;
}

// Narrow enough that a band stays in the second-level cache, but wider than its rim, which is computed twice.
static void cell(const struct hf_setup *s, int sweep, int *width, int *height)
{
    (void)sweep;
    *width = hf_max(hf_min(*width, 192), (4 * hf_hexagon(s)->reach_x + 15) & ~15);
    *height = hf_max(*height, 4 * hf_hexagon(s)->reach_y);
}

static int cost(const struct hf_setup *s, int numbers[HF_COST_NUMBERS], int *reach)
{
    numbers[0] = hf_hexagon(s)->half;
    numbers[1] = s->uniform;
    *reach = hf_max(hf_hexagon(s)->reach_x, hf_hexagon(s)->reach_y);
    return 2;
}

HF_CHOOSE_KERNELS(hf_hexagon_kernels)

void hf_hexagon_kernels_c(struct hf_hexagon_kernels *k)
{
    *k = (struct hf_hexagon_kernels){
        .passes = {{hf_radius_pass, hf_hexagon_load_c, hf_hexagon_blur_pass, hf_hexagon_behind_pass,
                    hf_hexagon_composite_c}},
        .first = hf_hexagon_1_c,
        .second = hf_hexagon_2_c,
        .beyond = hf_hexagon_beyond_c,
    };
}

const struct hf_engine_def hf_hexagon_engine = {
    .name = "hexagon",
    .passes = passes,
    .pass_count = HF_HEXAGON_PASSES,
    .sweeps = 2,
    .bufs = bufs,
    .buf_count = HF_HEXAGON_BUF_COUNT,
    .limits = {.aperture = HF_APERTURE_BLADES, .check = check},
    .kernels = {sizeof(struct hf_hexagon_kernels), hf_hexagon_kernels_init},
    .own = {sizeof(struct hf_hexagon), .resolve = resolve, .prepare = prepare, .measure = measure, .release = release,
            .held = held},
    .plan = {.zero_beyond = 1, .channels = channels, .halo = halo, .spread = spread, .cell = cell, .work = work},
    .cost = {.numbers = cost},
};
