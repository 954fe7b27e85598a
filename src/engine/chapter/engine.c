// SPDX-License-Identifier: BSD-3-Clause
// The chapter: order, names and buffers of its figure 3.6 and table 3.1, and what the engine makes of its parameters.
#include "pass/cells.h"
#include "pass/check.h"
#include "engine/chapter/chapter.h"

#define B(name) HF_BIT(name)

static const struct hf_pass passes[] = {
    HF_FIELDS_PASSES(0),
    {"Computation", .reads = B(BLUR), .around = B(COLOR4) | B(COLORFAR4) | B(COC4), .writes = B(NEAR) | B(FAR),
     .inside = B(SUM), .weighed = B(WEIGHT) | B(COLORW4) | B(COLORFARW4), .halo = HF_HALO_TAPS, .sweep = 2, .ns = 4},
    {"Fill", .reads = B(BLUR), .around = B(NEAR) | B(FAR) | B(COC4), .writes = B(NEAR_FILL) | B(FAR_FILL),
     .halo = HF_HALO_3X3, .sweep = 2, .ns = 0.75f},
    {"Composite", .around = B(NEAR_FILL) | B(FAR_FILL) | B(BLUR) | B(COC4), .halo = HF_HALO_UPSAMPLE, .sweep = 2,
     .ns = 3.2f},
};
_Static_assert(sizeof passes / sizeof *passes == HF_CHAPTER_PASSES, "one row per pass");

static const struct hf_buf_def bufs[HF_CHAPTER_BUFS] = {
    HF_FIELDS_BUFS,
    [HF_BUF_NEAR_FILL] = {"nearfill", .field = HF_NEAR},
    [HF_BUF_FAR_FILL] = {"farfill", .field = HF_FAR},
};

static int channels(const struct hf_setup *s, int b)
{
    const int karis = hf_fields(s)->karis;
    switch (b) {
    case HF_BUF_WEIGHT:
        return karis ? 2 : 0;
    case HF_BUF_COLORW4:
    case HF_BUF_COLORFARW4:
        return karis ? s->channels : 0;
    default:
        return hf_fields_channels(s, b);
    }
}

// The larger tap set of both fields.
static struct hf_reach taps_reach(const struct hf_setup *s)
{
    const struct hf_taps *near = &hf_chapter_taps(s, HF_NEAR)->taps, *far = &hf_chapter_taps(s, HF_FAR)->taps;
    return (struct hf_reach){hf_max(near->rx, far->rx), hf_max(near->ry, far->ry)};
}

struct hf_reach hf_chapter_halo(const struct hf_setup *s, int halo)
{
    // One more for the per-pixel kernel, whose bilinear taps read a neighbour even with weight 0.
    const int more = hf_fields(s)->per_pixel_kernel;
    if (halo == HF_HALO_3X3)
        return (struct hf_reach){1, 1};
    if (halo != HF_HALO_TAPS)
        return hf_fields_halo(s, halo);
    return (struct hf_reach){taps_reach(s).x + more, taps_reach(s).y + more};
}

// Blurred near CoC is 0 unless there is some within the reach of the four passes; the far field stays where it is.
static struct hf_reach spread(const struct hf_setup *s, const struct hf_cells *p, unsigned field)
{
    if (field == HF_FAR)
        return (struct hf_reach){0, 0};
    return (struct hf_reach){p->pass[HF_PASS_MAX_X].x + hf_fields(s)->max_x, p->pass[HF_PASS_MAX_X].y};
}

// Karis weights are made from the colour, whatever they weigh.
static unsigned reads(const struct hf_setup *s, unsigned needs)
{
    return needs && hf_fields(s)->karis ? HF_FIELDS : needs;
}

// What the kernels need: terms, pairs and their sums of the convolution for two rows of strips of up to 80 columns;
// values and partial sums of the near blur for 16; and three rows for the mean fill.
static size_t work(const struct hf_setup *s, const struct hf_cells *p)
{
    const size_t rows = 2 * (size_t)taps_reach(s).y + 1, columns = 2 * (size_t)taps_reach(s).x + 2;
    const size_t sums = 2 * rows * columns + 16 + columns * 160;
    const size_t near = 2 * ((size_t)p->height[2] + 2 * (size_t)p->buf[HF_BUF_BLUR_X].y) * 16;
    const size_t most = sums > near ? sums : near, fill = 3 * p->line_floats;
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

// Where radii are found in the depth, the most rings, which are at most 2 apart up to a radius of 96. More cost more than the
// other engines.
enum { MEASURED_RINGS = 24 };

static int is_measured(const struct hf_settings *r)
{
    return hf_fields_are_measured(r) && !r->params.chapter.faithful;
}

// Faithfully it reaches 12 pixels at any size, with a lens, too.
static int check(struct hf_settings *r, const struct hf_params *asked, const struct hf_depth *depth,
                 struct hf_message *message)
{
    struct hf_chapter_params *c = &r->params.chapter;
    (void)asked;
    (void)depth;
    int err = hf_check_value("chapter.storage", (int)c->storage, 0, HF_STORAGE_PACKED, message);
    if (!err)
        err = hf_check_value("chapter.fill", (int)c->fill, 0, HF_FILL_OPEN, message);
    if (!err)
        err = hf_check_value("chapter.downsample", (int)c->downsample, 0, HF_DOWNSAMPLE_POINT, message);
    if (!err)
        err = hf_check_value("chapter.division", (int)c->division, 0, HF_DIVISION_NEWTON2, message);
    if (err)
        return err;
    if (c->faithful && r->limit != HF_LIMIT_GIVEN) {
        r->limit = HF_LIMIT_ENGINE;
        r->params.max_radius = 12;
    } else {
        hf_fields_limit(r);
    }
    r->rings_given = c->rings != HF_DERIVE;
    if (!r->rings_given)
        c->rings = is_measured(r) ? MEASURED_RINGS : hf_taps_rings(r->params.max_radius / 2);
    if (c->rings < 1 || c->rings > HF_MAX_RINGS)
        return hf_bad(message, "chapter.rings", "is %d; it must be 1 to %d", c->rings, HF_MAX_RINGS);
    return HF_OK;
}

// How much the outermost of so many values to either side count where a window reaches a radius: all in the chapter.
static float edge(const struct hf_setup *s, int reach, float radius)
{
    return hf_chapter(s)->faithful ? 1 : radius - (float)(reach - 1);
}

static void set_reach(struct hf_fields *g, const struct hf_setup *s, float h)
{
    const float hx = h / s->pixel_aspect;
    g->max_x = g->blur_x = (int)__builtin_ceilf(hx);
    g->max_y = g->blur_y = (int)__builtin_ceilf(h);
    g->edge_x = edge(s, g->max_x, hx);
    g->edge_y = edge(s, g->max_y, h);
}

static void resolve(void *own, struct hf_setup *s, const struct hf_depth *depth, const struct hf_params *p)
{
    struct hf_chapter *c = own;
    const float h = s->max_radius / 2;
    (void)depth;
    s->storage = p->chapter.storage;
    c->faithful = p->chapter.faithful;
    c->fill = p->chapter.fill == HF_FILL_OPEN ? HF_FILL_NONE : p->chapter.fill;
    c->downsample = p->chapter.downsample;
    c->division = p->run.deterministic ? HF_DIVISION_EXACT : p->chapter.division;
    // Fields of half resolution come in gradually where the radius is smaller than one of its pixels.
    c->fields = (struct hf_fields){.karis = p->chapter.karis,
                                   .per_pixel_kernel = p->chapter.per_pixel_kernel,
                                   .bicubic = p->chapter.bicubic,
                                   .blend = (s->strength < 0.25f ? 4 * s->strength : 1) * __builtin_fminf(h, 1)};
    set_reach(&c->fields, s, h);
    s->measured = is_measured(s->resolved);
    if (s->measured)
        hf_fields_wait(&c->fields, s);
}

// Rings for a radius of h: those that lie 2 apart where nothing else is said, or of a measured one, if there are so many.
static float ring_count(const struct hf_setup *s, const struct hf_params *p, float radius)
{
    const float most = (float)p->chapter.rings, spaced = hf_taps_spaced(radius);
    if (hf_chapter(s)->faithful || (s->resolved->rings_given && !s->measured))
        return most;
    return spaced < most ? spaced : most;
}

// radius: h.
static int build_taps(struct hf_tap_set *taps, const struct hf_setup *s, const struct hf_params *p, float radius,
                      const struct hf_mem *mem)
{
    const struct hf_taps_key key = {.radius = radius,
                                    .scale = s->strength >= 0.25f ? s->strength : 0.25f,
                                    .pixel_aspect = s->pixel_aspect,
                                    .blades = p->aperture.blades,
                                    .rotation = p->aperture.blades ? p->aperture.rotation : 0,
                                    .dense = p->chapter.fill == HF_FILL_NONE,
                                    .rings = p->chapter.fill == HF_FILL_NONE ? 0 : ring_count(s, p, radius)};
    return hf_tap_set_build(taps, &key, mem);
}

static int build(struct hf_chapter *c, const struct hf_setup *s, const struct hf_params *p, float near, float far,
                 const struct hf_mem *mem)
{
    const int err = build_taps(&c->taps, s, p, near, mem);
    return err || !s->measured ? err : build_taps(&c->far_taps, s, p, far, mem);
}

static int prepare(void *own, const struct hf_setup *s, const struct hf_params *p, const struct hf_mem *mem)
{
    return s->measured ? HF_OK : build(own, s, p, s->max_radius / 2, s->max_radius / 2, mem);
}

static int measure(void *own, struct hf_setup *s, const struct hf_counts *found, const struct hf_mem *mem)
{
    struct hf_chapter *c = own;
    float radius[2];
    hf_fields_found(s, found, radius);
    hf_fields_scale(&c->fields, s, radius);
    set_reach(&c->fields, s, radius[0] / 2);
    return build(c, s, &s->resolved->params, radius[0] / 2, radius[1] / 2, mem);
}

static void release(void *own, const struct hf_mem *mem)
{
    hf_tap_set_free(&((struct hf_chapter *)own)->taps, mem);
    hf_tap_set_free(&((struct hf_chapter *)own)->far_taps, mem);
}

static size_t held(const void *own)
{
    const struct hf_chapter *c = own;
    return c->taps.block.size + c->far_taps.block.size;
}

static int cost(const struct hf_setup *s, int numbers[HF_COST_NUMBERS], int *reach)
{
    const struct hf_chapter *c = hf_chapter(s);
    const struct hf_taps *near = &c->taps.taps, *far = &hf_chapter_taps(s, HF_FAR)->taps;
    numbers[0] = c->fields.karis;
    numbers[1] = c->fields.per_pixel_kernel;
    numbers[2] = c->fields.bicubic;
    numbers[3] = (int)c->fill;
    numbers[4] = 8 * (int)c->downsample + 2 * (int)c->division + c->faithful;
    *reach = hf_max(near->first[near->rows], far->first[far->rows]);  // weights
    return 5;
}

HF_CHOOSE_KERNELS(hf_chapter_kernels)

void hf_chapter_kernels_c(struct hf_chapter_kernels *k)
{
    *k = (struct hf_chapter_kernels){{{
        HF_FIELDS_KERNELS,
        [HF_PASS_DOWN] = hf_chapter_down_c,
        [HF_PASS_COMPUTATION] = hf_chapter_computation_c,
        [HF_CHAPTER_FILL] = hf_chapter_fill_c,
        [HF_CHAPTER_COMPOSITE] = hf_chapter_composite_c,
    }}};
}

const struct hf_engine_def hf_chapter_engine = {
    .name = "chapter",
    .passes = passes,
    .pass_count = HF_CHAPTER_PASSES,
    .sweeps = 2,
    .bufs = bufs,
    .buf_count = HF_CHAPTER_BUFS,
    .limits = {.aperture = HF_APERTURE_BLADES, .check = check},
    .kernels = {sizeof(struct hf_chapter_kernels), hf_chapter_kernels_init},
    .own = {sizeof(struct hf_chapter), .resolve = resolve, .prepare = prepare, .measure = measure, .release = release,
            .held = held},
    .plan =
        {.channels = channels, .halo = hf_chapter_halo, .spread = spread, .reads = reads, .cell = cell, .work = work},
    .cost = {.numbers = cost},
};
