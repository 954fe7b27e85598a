// SPDX-License-Identifier: BSD-3-Clause
// The gaussian engine: a blurred copy of the picture, blended with it by depth. After a shader of 2010 for a GTX 470,
// which focuses on what the picture's centre shows.
//
// Blur. n iterations of a 5-tap kernel along the rows and down the columns, 1 4 6 4 1 / 16, faithfully .3 .15 .1 .15 .3
// (the printed weights, which are upside down). Each iteration clamps to the frame's edge. Along the rows and down the
// columns are linear and independent, clamping included, so all iterations along the rows come first: from the picture
// itself, chunk by chunk, which is why the engine works in place. Cost: n times 2 x 4 additions a sample, or with sigma
// (wide.c) 2 x 4 boxes of three. Half and quarter buffers: mean of 2 x 2 or 4 x 4 pixels, bilinear back.
//
// Blend, per pixel at full resolution whatever the buffer's size. With nothing but a focus given (range model, all of
// range and near_begin to far_end derived), and always when faithful: strength * sat(3 |d(focus) - d|), where
// d = sat(z / f), faithfully 2n / (f + n - zw (f - n)) with window depth zw = f (z - n) / (z (f - n)) in 0..1. With
// z' = z clamped to n..f that is 2 z' / (z' + f), which does not cancel. n = 1 and f = 100 n but for the clip planes of
// the depth. Given a range, a lens or radii: strength * max(n, f) of the gather's near and far CoC.
#include "frame/context.h"
#include "gaussian/wide.h"

// Sweep 2 has no passes, but its cells are the tiles. With sigma, whole columns and then whole rows are blurred in
// between.
enum { WIDE_COLUMNS = 3, WIDE_ROWS, TILES };

#define B(name) (1u << HF_GAUSSIAN_##name)

static const struct hf_pass passes[] = {
    {"Depth", HF_KERNEL_GAUSSIAN_DEPTH, .sweep = 1, .ns = 1.7f},
    {"Horizontal blur", HF_KERNEL_GAUSSIAN_ROWS, .writes = B(ROWS), .sweep = 1, .ns = 4},
    {"Wide vertical blur", HF_KERNEL_WIDE_COLUMNS, .reads = B(ROWS), .writes = B(ROWS), .sweep = WIDE_COLUMNS,
     .ns = 15},
    {"Wide horizontal blur", HF_KERNEL_WIDE_ROWS, .reads = B(ROWS), .writes = B(ROWS), .sweep = WIDE_ROWS, .ns = 14},
    {"Vertical blur", HF_KERNEL_GAUSSIAN_COLUMNS, .around = B(ROWS), .writes = B(BLUR), .halo = HF_HALO_COLUMNS,
     .sweep = TILES, .ns = 4},
    {"Merge", HF_KERNEL_GAUSSIAN_MERGE, .around = B(BLUR), .halo = HF_HALO_UPSAMPLE, .sweep = TILES, .ns = 5},
};

static const struct hf_buf_def bufs[HF_GAUSSIAN_BUFS] = {
    [HF_GAUSSIAN_ROWS] = {"rows", .frame = 1, .x = 1, .y = 1, .shrinks = 1},
    [HF_GAUSSIAN_BLUR] = {"blur", .x = 1, .y = 1, .shrinks = 1},
};

static int channels(const struct hf_setup *s, int buf)
{
    (void)buf;
    return s->channels;
}

static struct hf_reach halo(const struct hf_setup *s, enum hf_halo halo)
{
    const int one = s->resolution;  // a pixel of a smaller buffer, in half-resolution pixels
    switch (halo) {
    case HF_HALO_COLUMNS:
        return (struct hf_reach){0, hf_gaussian_halo(s)};
    case HF_HALO_UPSAMPLE:
        return (struct hf_reach){one, one};
    default:
        return (struct hf_reach){0, 0};
    }
}

// The blend is each pixel's own affair.
static struct hf_reach spread(const struct hf_setup *s, const struct hf_plan *p, unsigned field)
{
    (void)s;
    (void)p;
    (void)field;
    return (struct hf_reach){0, 0};
}

// The same buffers for near and far.
static unsigned reads(const struct hf_setup *s, unsigned needs)
{
    (void)s;
    return needs ? HF_FIELDS : 0;
}

static int runs(const struct hf_setup *s, int pass)
{
    return s->sigma > 0 || (passes[pass].sweep != WIDE_COLUMNS && passes[pass].sweep != WIDE_ROWS);
}

// Strips of 32 columns of the working buffer, and of 16 rows.
static void cell(const struct hf_setup *s, int sweep, int *width, int *height)
{
    if (sweep == WIDE_COLUMNS) {
        *width = 16 << s->resolution;
        *height = s->half_height;
    } else if (sweep == WIDE_ROWS) {
        *width = (s->half_width + 15) & ~15;
        *height = HF_WIDE_LANES / 2 << s->resolution;
    }
}

static size_t work(const struct hf_setup *s, const struct hf_plan *p)
{
    const size_t rows = HF_GAUSSIAN_LINES * hf_gaussian_line_floats(s, p->cell_width[1]);
    const size_t columns = (2 * (size_t)p->cell_height[2] + 2 * (size_t)hf_gaussian_reach(s) + 16) * HF_GAUSSIAN_STRIP;
    const size_t wide = s->sigma > 0 ? hf_wide_floats(hf_max(s->width, s->height)) : 0;
    const size_t most = rows > columns ? rows : columns;
    return most > wide ? most : wide;
}

const struct hf_engine_def hf_gaussian_engine = {
    .name = "gaussian",
    .passes = passes,
    .pass_count = sizeof passes / sizeof *passes,
    .sweeps = TILES,
    .across = 1 << WIDE_COLUMNS | 1 << WIDE_ROWS,
    .bufs = bufs,
    .buf_count = HF_GAUSSIAN_BUFS,
    .channels = channels,
    .halo = halo,
    .spread = spread,
    .reads = reads,
    .work = work,
    .runs = runs,
    .cell = cell,
};
