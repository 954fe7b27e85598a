// SPDX-License-Identifier: BSD-3-Clause
// The gaussian engine blends the picture with a blurred copy, by depth. It follows a shader of 2010 for a GTX 470,
// which focuses on the depth in the picture's centre.
//
// Blur: n iterations of a 5-tap kernel along the rows and down the columns, 1 4 6 4 1 / 16; with `faithful` the
// printed weights .3 .15 .1 .15 .3, which are upside down. Each iteration clamps to the frame's edge. Filtering rows
// and filtering columns are linear and independent, clamping included. So all iterations along the rows come first,
// from the picture itself, chunk by chunk; that lets the engine work in place. Cost per sample: n times 2 x 4
// additions, or with sigma (wide.c) 2 x 4 boxes of three additions. Half and quarter buffers hold means of 2 x 2 or 4
// x 4 pixels, and are upsampled bilinearly.
//
// Blend: per pixel at full resolution, whatever the buffer's size. If only a focus is given (range model, all of range
// and near_begin to far_end derived), and always when faithful, the factor is strength * sat(3 |d(focus) - d|). There
// d = sat(z / f); with `faithful` d = 2n / (f + n - zw (f - n)) with window depth zw = f (z - n) / (z (f - n)) in
// 0..1. With z' = z clamped to n..f the latter is 2 z' / (z' + f), which does not cancel. n = 1 and f = 100 n, unless
// the depth has clip planes. If a range, a lens or radii are given, the factor is strength * max(n, f) of the gather's
// near and far CoC.
#include <math.h>

#include "pass/cells.h"
#include "engine/gaussian/kernels.h"
#include "pass/check.h"
#include "pixel/limits.h"

// Sweep 2 has no passes, but its cells are the tiles. With sigma, whole columns and then whole rows are blurred between
// the sweeps.
enum { WIDE_COLUMNS = 3, WIDE_ROWS, TILES };

enum { MAX_ITERATIONS = 64 };
static const float MAX_SIGMA = 256;  // pixels

#define B(name) (7u << HF_GAUSSIAN_##name)

// Halos: the reach of the iterations down the columns; and a pixel.
enum { HALO_COLUMNS = 1, HALO_UPSAMPLE };

static const struct hf_pass passes[] = {
    {"Depth", .sweep = 1, .ns = 1.7f},
    {"Horizontal blur", .writes = B(ROWS), .sweep = 1, .ns = 6.5f},
    {"Wide vertical blur", .reads = B(ROWS), .writes = B(ROWS), .sweep = WIDE_COLUMNS, .ns = 15},
    {"Wide horizontal blur", .reads = B(ROWS), .writes = B(ROWS), .sweep = WIDE_ROWS, .ns = 14},
    {"Vertical blur", .around = B(ROWS), .writes = B(BLUR), .halo = HALO_COLUMNS, .sweep = TILES, .ns = 5.5f},
    {"Merge", .around = B(BLUR), .halo = HALO_UPSAMPLE, .sweep = TILES, .ns = 8},
};

// One of each size; only those of the resolution in use have channels.
#define SIZES(b, ...)                                                                                                  \
    [HF_GAUSSIAN_##b] = {__VA_ARGS__, .x = 1, .y = 1}, [HF_GAUSSIAN_##b + 1] = {__VA_ARGS__},                          \
    [HF_GAUSSIAN_##b + 2] = {__VA_ARGS__, .x = -1, .y = -1}

static const struct hf_buf_def bufs[HF_GAUSSIAN_BUFS] = {
    SIZES(ROWS, "rows", .frame = 1),
    SIZES(BLUR, "blur"),
};

static int channels(const struct hf_setup *s, int buf)
{
    return buf % 3 == (int)hf_gaussian(s)->resolution ? s->channels : 0;
}

static struct hf_reach halo(const struct hf_setup *s, int halo)
{
    const int one = hf_gaussian(s)->resolution;  // a pixel of a smaller buffer, in half-resolution pixels
    switch (halo) {
    case HALO_COLUMNS:
        return (struct hf_reach){0, hf_gaussian_halo(s)};
    case HALO_UPSAMPLE:
        return (struct hf_reach){one, one};
    default:
        return (struct hf_reach){0, 0};
    }
}

static int runs(const struct hf_setup *s, int pass)
{
    return hf_gaussian(s)->sigma > 0 || (passes[pass].sweep != WIDE_COLUMNS && passes[pass].sweep != WIDE_ROWS);
}

// Cells are strips of 32 columns of the working buffer, then strips of 16 rows.
static void cell(const struct hf_setup *s, int sweep, int *width, int *height)
{
    if (sweep == WIDE_COLUMNS) {
        *width = 16 << hf_gaussian(s)->resolution;
        *height = s->half_height;
    } else if (sweep == WIDE_ROWS) {
        *width = (s->half_width + 15) & ~15;
        *height = HF_WIDE_LANES / 2 << hf_gaussian(s)->resolution;
    }
}

static size_t work(const struct hf_setup *s, const struct hf_cells *p)
{
    const size_t rows = HF_GAUSSIAN_LINES * hf_gaussian_line_floats(s, p->width[1]);
    const size_t columns = (2 * (size_t)p->height[2] + 2 * (size_t)hf_gaussian_reach(s) + 16) * HF_GAUSSIAN_STRIP;
    const size_t wide = hf_gaussian(s)->sigma > 0 ? hf_wide_floats(hf_max(s->width, s->height)) : 0;
    const size_t most = rows > columns ? rows : columns;
    return most > wide ? most : wide;
}

// The clip planes of the depth, or 1 and 100.
static void depth_planes(const struct hf_depth *depth, float *near, float *far)
{
    *near = depth->near_plane > 0 ? depth->near_plane : 1;
    *far = depth->far_plane > 0 && depth->far_plane < INFINITY ? depth->far_plane : 100 * *near;
}

// Whether only a focus is given. Then the engine blends by the distance in depth, as the original shader does.
static int only_focus(const struct hf_params *asked)
{
    const struct hf_range_params *g = &asked->range;
    return asked->model == HF_MODEL_RANGE && g->distance == HF_DERIVE && g->near_begin == HF_DERIVE &&
           g->near_end == HF_DERIVE && g->far_begin == HF_DERIVE && g->far_end == HF_DERIVE;
}

static float sigma(const struct hf_gaussian_params *g)
{
    return g->sigma == HF_DERIVE ? sqrtf((float)g->iterations) * (float)(1 << g->resolution) : g->sigma;
}

// A gaussian of standard deviation r / 2 spreads light as far as a disc of radius r.
static float farthest(const struct hf_params *p)
{
    return 2 * sigma(&p->gaussian);
}

static int check(struct hf_settings *r, const struct hf_params *asked, const struct hf_depth *depth,
                 struct hf_message *message)
{
    struct hf_gaussian_params *g = &r->params.gaussian;
    int err = hf_check_resolution("gaussian", g->resolution, HF_RESOLUTION_QUARTER, message);
    if (err)
        return err;
    if (g->iterations < 0 || g->iterations > MAX_ITERATIONS)
        return hf_bad(message, "gaussian.iterations", "is %d; it must be 0 to %d", g->iterations, MAX_ITERATIONS);
    if (g->sigma == HF_DERIVE) {
        g->sigma = sigma(g);
    } else {
        g->iterations = 0;
        err = hf_check_between("gaussian.sigma", g->sigma, 0, MAX_SIGMA, message);
    }
    if (r->limit != HF_LIMIT_GIVEN) {
        r->limit = r->limit == HF_LIMIT_NONE || g->faithful ? HF_LIMIT_ENGINE : r->limit;
        r->params.max_radius = g->faithful ? 12 : hf_model_radius(r->params.view.display_height);
    }
    if (g->by_depth == HF_DERIVE)
        g->by_depth = g->faithful || only_focus(asked);
    g->by_depth = g->by_depth && depth->type != HF_DEPTH_COC;
    if (!err && g->by_depth)  // it uses this strength, with a lens too
        err = hf_check_between("range.strength", r->params.range.strength, 0, 1, message);
    if (g->by_depth)
        r->sharp = r->params.max_radius == 0 || r->params.range.strength == 0;
    r->sharp |= g->resolution == HF_RESOLUTION_FULL && g->sigma == 0;
    float near, far;
    depth_planes(depth, &near, &far);
    if (!err && g->by_depth && !(near < far))
        return hf_bad(message, "depth.near_plane", "is %g; it must be less than the far plane, %g", near, far);
    return err;
}

static void resolve(void *own, struct hf_setup *s, const struct hf_depth *depth, const struct hf_params *p)
{
    const struct hf_gaussian_params *from = &p->gaussian;
    struct hf_gaussian *g = own;
    *g = (struct hf_gaussian){.resolution = from->resolution,
                              .faithful = from->faithful,
                              .iterations = from->iterations,
                              .sigma = from->iterations ? 0 : from->sigma};
    g->by_depth = from->by_depth;
    if (!g->by_depth) {
        hf_gaussian_limits(s, g);
        return;
    }
    s->lens = 0;
    s->near_0 = s->far_0 = s->radius_0 = s->radius_k = 0;
    s->near_i = s->far_i = 1;  // there is blur
    s->strength = p->range.strength;
    depth_planes(depth, &g->plane_near, &g->plane_far);
    if (!g->faithful)
        g->plane_near = 0;  // only the far plane matters
    g->focus_d = hf_gaussian_depth(g, p->focus);
}

static int cost(const struct hf_setup *s, int numbers[HF_COST_NUMBERS], int *reach)
{
    numbers[0] = (int)hf_gaussian(s)->resolution;
    numbers[1] = hf_gaussian(s)->iterations;
    numbers[2] = 2 * (hf_gaussian(s)->sigma > 0) + hf_gaussian(s)->faithful;
    *reach = 0;
    return 3;
}

HF_CHOOSE_KERNELS(hf_gaussian_kernels)

void hf_gaussian_kernels_c(struct hf_gaussian_kernels *k)
{
    *k = (struct hf_gaussian_kernels){
        .passes = {{hf_gaussian_depth_pass, hf_gaussian_rows_pass, hf_wide_columns_pass, hf_wide_rows_pass,
                    hf_gaussian_columns_pass, hf_gaussian_merge_pass}},
        .blend_row = hf_blend_row_c,
        .count_row = hf_gaussian_count_c,
        .lerp_row = hf_lerp_row_c,
        .line = hf_gaussian_line_c,
        .columns = hf_gaussian_columns_c,
        .up = hf_gaussian_up_c,
        .shrink = hf_gaussian_shrink_c,
        .merge = hf_gaussian_merge_c,
        .wide_block = hf_wide_block_c,
    };
}

const struct hf_engine_def hf_gaussian_engine = {
    .name = "gaussian",
    .passes = passes,
    .pass_count = sizeof passes / sizeof *passes,
    .sweeps = TILES,
    .bufs = bufs,
    .buf_count = HF_GAUSSIAN_BUFS,
    .limits = {.focus_anywhere = 1, .width = "its iterations or sigma", .check = check, .farthest = farthest},
    .kernels = {sizeof(struct hf_gaussian_kernels), hf_gaussian_kernels_init},
    .own = {sizeof(struct hf_gaussian), .resolve = resolve},
    .plan = {.across = 1 << WIDE_COLUMNS | 1 << WIDE_ROWS,
             .channels = channels,
             .runs = runs,
             .halo = halo,
             .cell = cell,
             .work = work},
    .cost = {.numbers = cost},
};
