// SPDX-License-Identifier: BSD-3-Clause
// The gather: order, names and buffers of the chapter's figure 3.6 and table 3.1.
#include "frame/context.h"
#include "frame/plan.h"

#define B(name) HF_BIT(name)

static const struct hf_pass passes[] = {
    {"CoC generation", HF_PASS_COC, .writes = B(COC), .sweep = 1, .ns = 1.7f},
    {"Downsample", HF_PASS_DOWN, .reads = B(COC), .writes = B(COLOR4) | B(COLORFAR4) | B(COC4), .sweep = 1, .ns = 1.1f},
    {"Near CoC Max X", HF_PASS_MAX_X, .around = B(COC4), .writes = B(MAX_X), .halo = HF_HALO_MAX_X, .sweep = 2,
     .field = HF_NEAR, .ns = 0.7f},
    {"Near CoC Max Y", HF_PASS_MAX_Y, .around = B(MAX_X), .writes = B(MAX), .halo = HF_HALO_MAX_Y, .sweep = 2,
     .field = HF_NEAR, .ns = 0.25f},
    {"Near CoC Blur X", HF_PASS_BLUR_X, .around = B(MAX), .writes = B(BLUR_X), .halo = HF_HALO_MAX_X, .sweep = 2,
     .field = HF_NEAR, .ns = 0.25f},
    {"Near CoC Blur Y", HF_PASS_BLUR_Y, .around = B(BLUR_X), .writes = B(BLUR), .halo = HF_HALO_MAX_Y, .sweep = 2,
     .field = HF_NEAR, .ns = 0.27f},
    {"Computation", HF_PASS_GATHER, .reads = B(BLUR), .around = B(COLOR4) | B(COLORFAR4) | B(COC4),
     .writes = B(NEAR) | B(FAR), .inside = B(SUM), .weighed = B(WEIGHT) | B(COLORW4) | B(COLORFARW4),
     .halo = HF_HALO_TAPS, .sweep = 2, .ns = 4},
    {"Fill", HF_PASS_FILL, .reads = B(BLUR), .around = B(NEAR) | B(FAR) | B(COC4), .writes = B(NEAR_FILL) | B(FAR_FILL),
     .halo = HF_HALO_3X3, .sweep = 2, .ns = 0.75f},
    {"Composite", HF_PASS_COMPOSITE, .around = B(NEAR_FILL) | B(FAR_FILL) | B(BLUR) | B(COC4), .halo = HF_HALO_UPSAMPLE,
     .sweep = 2, .ns = 3.2f},
};
_Static_assert(sizeof passes / sizeof *passes == HF_PASS_COUNT, "one row per pass");

static const struct hf_buf_def bufs[HF_BUF_COUNT] = {
    [HF_BUF_COC] = {"coc", .y = 1},
    [HF_BUF_COLOR4] = {"color4", .frame = 1, .field = HF_NEAR},
    [HF_BUF_COLORFAR4] = {"colormulcoc4", .frame = 1, .field = HF_FAR},
    [HF_BUF_COC4] = {"coc4", .frame = 1},
    [HF_BUF_MAX_X] = {"cocmaxx", .field = HF_NEAR, .narrow = 1},
    [HF_BUF_MAX] = {"cocmax", .field = HF_NEAR, .narrow = 1},
    [HF_BUF_BLUR_X] = {"cocblurx", .field = HF_NEAR, .narrow = 1},
    [HF_BUF_BLUR] = {"cocblur", .field = HF_NEAR},
    [HF_BUF_NEAR] = {"near", .field = HF_NEAR},
    [HF_BUF_FAR] = {"far", .field = HF_FAR},
    [HF_BUF_NEAR_FILL] = {"nearfill", .field = HF_NEAR},
    [HF_BUF_FAR_FILL] = {"farfill", .field = HF_FAR},
};

static int channels(const struct hf_setup *s, int b)
{
    switch (b) {
    case HF_BUF_COC:
        return 4;
    case HF_BUF_COC4:
    case HF_BUF_SUM:
        return 2;
    case HF_BUF_MAX_X:
    case HF_BUF_MAX:
    case HF_BUF_BLUR_X:
    case HF_BUF_BLUR:
        return 1;
    case HF_BUF_WEIGHT:
        return s->karis ? 2 : 0;
    case HF_BUF_COLORW4:
    case HF_BUF_COLORFARW4:
        return s->karis ? s->channels : 0;
    default:
        return s->channels;
    }
}

struct hf_reach hf_pass_halo(const struct hf_setup *s, enum hf_halo halo)
{
    switch (halo) {
    case HF_HALO_3X3:
        return (struct hf_reach){1, 1};
    case HF_HALO_MAX_X:
        return (struct hf_reach){s->max_x, 0};
    case HF_HALO_MAX_Y:
        return (struct hf_reach){0, s->max_y};
    case HF_HALO_TAPS:
        // One more for the per-pixel kernel, whose bilinear taps read a neighbour even with weight 0.
        return (struct hf_reach){s->taps->rx + s->per_pixel_kernel, s->taps->ry + s->per_pixel_kernel};
    case HF_HALO_UPSAMPLE:
        return s->bicubic ? (struct hf_reach){2, 2} : (struct hf_reach){1, 1};
    default:
        return (struct hf_reach){0, 0};
    }
}

// Blurred near CoC is 0 unless there is some within the reach of the four passes; the far field stays where it is.
static struct hf_reach spread(const struct hf_setup *s, const struct hf_plan *p, unsigned field)
{
    if (field == HF_FAR)
        return (struct hf_reach){0, 0};
    return (struct hf_reach){p->pass[HF_PASS_MAX_X].x + s->max_x, p->pass[HF_PASS_MAX_X].y};
}

// Karis weights are made from the colour, whatever they weigh.
static unsigned reads(const struct hf_setup *s, unsigned needs)
{
    return s->karis && needs ? HF_FIELDS : needs;
}

// What the kernels need: terms and pairs of the gather for strips of up to 80 columns; values and partial sums of the near
// blur for 16; and three rows for the mean fill.
static size_t work(const struct hf_setup *s, const struct hf_plan *p)
{
    const struct hf_taps *t = s->taps;
    const size_t rows = 2 * (size_t)t->ry + 1, columns = 2 * (size_t)t->rx + 1;
    const size_t gather = 2 * rows * columns + 16 + columns * 80;
    const size_t near = 2 * ((size_t)p->cell_height[2] + 2 * (size_t)p->buf[HF_BUF_BLUR_X].y) * 16;
    const size_t most = gather > near ? gather : near, fill = 3 * p->line_floats;
    return most > fill ? most : fill;
}

// Tiles lower than the default: more of a mixed picture is skipped, and its scratch is smaller.
static void cell(const struct hf_setup *s, int sweep, int *width, int *height)
{
    (void)s;
    (void)sweep;
    (void)width;
    *height = hf_min(*height, 72);
}

int hf_gather_setup(struct hf_setup *s, const struct hf_params *p, const struct hf_mem *mem)
{
    const float h = s->max_radius / 2;
    s->max_x = (int)__builtin_ceilf(h / p->pixel_aspect);
    s->max_y = (int)__builtin_ceilf(h);
    const struct hf_taps_key key = {.radius = h,
                                    .scale = s->strength >= 0.25f ? s->strength : 0.25f,
                                    .pixel_aspect = p->pixel_aspect,
                                    .blades = p->blades,
                                    .rotation = p->blades ? p->blade_rotation : 0,
                                    .dense = p->fill == HF_FILL_NONE,
                                    .rings = s->rings};
    return hf_taps_build(s->taps, &key, mem);
}

static int prepare(struct hf_context *c, struct hf_setup *s, const struct hf_params *p)
{
    return hf_gather_setup(s, p, &c->mem);
}

const struct hf_engine_def hf_gather_engine = {
    .name = "gather",
    .passes = passes,
    .pass_count = HF_PASS_COUNT,
    .sweeps = 2,
    .bufs = bufs,
    .buf_count = HF_BUF_COUNT,
    .prepare = prepare,
    .channels = channels,
    .halo = hf_pass_halo,
    .spread = spread,
    .reads = reads,
    .cell = cell,
    .work = work,
};
