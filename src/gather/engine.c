// SPDX-License-Identifier: BSD-3-Clause
// The gather: order, names and buffers of the chapter's figure 3.6 and table 3.1.
#include "frame/plan.h"
#include "gather/gather.h"

#define B(name) (1u << HF_BUF_##name)

static const struct hf_pass passes[] = {
    {"CoC generation", .writes = B(COC), .sweep = 1, .ns = 1.7f},
    {"Downsample", .reads = B(COC), .writes = B(COLOR4) | B(COLORFAR4) | B(COC4), .sweep = 1, .ns = 1.1f},
    {"Near CoC Max X", .around = B(COC4), .writes = B(MAX_X), .halo = HF_HALO_MAX_X, .sweep = 2, .field = HF_NEAR,
     .ns = 0.7f},
    {"Near CoC Max Y", .around = B(MAX_X), .writes = B(MAX), .halo = HF_HALO_MAX_Y, .sweep = 2, .field = HF_NEAR,
     .ns = 0.25f},
    {"Near CoC Blur X", .around = B(MAX), .writes = B(BLUR_X), .halo = HF_HALO_MAX_X, .sweep = 2, .field = HF_NEAR,
     .ns = 0.25f},
    {"Near CoC Blur Y", .around = B(BLUR_X), .writes = B(BLUR), .halo = HF_HALO_MAX_Y, .sweep = 2, .field = HF_NEAR,
     .ns = 0.27f},
    {"Computation", .reads = B(BLUR), .around = B(COLOR4) | B(COLORFAR4) | B(COC4), .writes = B(NEAR) | B(FAR),
     .inside = B(SUM), .weighed = B(WEIGHT) | B(COLORW4) | B(COLORFARW4), .halo = HF_HALO_TAPS, .sweep = 2, .ns = 4},
    {"Fill", .reads = B(BLUR), .around = B(NEAR) | B(FAR) | B(COC4), .writes = B(NEAR_FILL) | B(FAR_FILL),
     .halo = HF_HALO_3X3, .sweep = 2, .ns = 0.75f},
    {"Composite", .around = B(NEAR_FILL) | B(FAR_FILL) | B(BLUR) | B(COC4), .halo = HF_HALO_UPSAMPLE, .sweep = 2,
     .ns = 3.2f},
};
_Static_assert(sizeof passes / sizeof *passes == HF_GATHER_PASSES, "one row per pass");

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
        return hf_gather(s)->karis ? 2 : 0;
    case HF_BUF_COLORW4:
    case HF_BUF_COLORFARW4:
        return hf_gather(s)->karis ? s->channels : 0;
    default:
        return s->channels;
    }
}

struct hf_reach hf_gather_halo(const struct hf_setup *s, int halo)
{
    const struct hf_gather *g = hf_gather(s);
    switch (halo) {
    case HF_HALO_3X3:
        return (struct hf_reach){1, 1};
    case HF_HALO_MAX_X:
        return (struct hf_reach){g->max_x, 0};
    case HF_HALO_MAX_Y:
        return (struct hf_reach){0, g->max_y};
    case HF_HALO_TAPS:
        // One more for the per-pixel kernel, whose bilinear taps read a neighbour even with weight 0.
        return (struct hf_reach){hf_max(g->taps.rx, hf_gather_taps(s, HF_FAR)->rx) + g->per_pixel_kernel,
                                 hf_max(g->taps.ry, hf_gather_taps(s, HF_FAR)->ry) + g->per_pixel_kernel};
    case HF_HALO_UPSAMPLE:
        return g->bicubic ? (struct hf_reach){2, 2} : (struct hf_reach){1, 1};
    default:
        return (struct hf_reach){0, 0};
    }
}

// Blurred near CoC is 0 unless there is some within the reach of the four passes; the far field stays where it is.
static struct hf_reach spread(const struct hf_setup *s, const struct hf_plan *p, unsigned field)
{
    if (field == HF_FAR)
        return (struct hf_reach){0, 0};
    return (struct hf_reach){p->pass[HF_GATHER_MAX_X].x + hf_gather(s)->max_x, p->pass[HF_GATHER_MAX_X].y};
}

// Karis weights are made from the colour, whatever they weigh.
static unsigned reads(const struct hf_setup *s, unsigned needs)
{
    return hf_gather(s)->karis && needs ? HF_FIELDS : needs;
}

// What the kernels need: terms and pairs of the gather for strips of up to 80 columns; values and partial sums of the near
// blur for 16; and three rows for the mean fill.
static size_t work(const struct hf_setup *s, const struct hf_plan *p)
{
    const struct hf_taps *near_taps = hf_gather_taps(s, HF_NEAR), *far_taps = hf_gather_taps(s, HF_FAR);
    const size_t rows = 2 * (size_t)hf_max(near_taps->ry, far_taps->ry) + 1;
    const size_t columns = 2 * (size_t)hf_max(near_taps->rx, far_taps->rx) + 1;
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

// Where radii are found in the depth (engine.h, measured): the largest, full-resolution pixels, and the most rings, which
// are at most 2 apart up to a radius of 96. More of either cost more than the other engines.
enum { MEASURED_RADIUS = 256, MEASURED_RINGS = 24 };

static int is_measured(const struct hf_resolved *r)
{
    return r->limit == HF_LIMIT_ENGINE && !r->params.gather.faithful;
}

// Faithfully it reaches 12 pixels at any size, with a lens, too.
static int check(struct hf_resolved *r, const struct hf_params *asked, const struct hf_depth *depth, char *message)
{
    struct hf_gather_params *g = &r->params.gather;
    (void)asked;
    (void)depth;
    if ((unsigned)g->storage > HF_STORAGE_PACKED)
        return hf_bad(message, "gather.storage is %d, which is none", (int)g->storage);
    if ((unsigned)g->fill > HF_FILL_OPEN)
        return hf_bad(message, "gather.fill is %d, which is none", (int)g->fill);
    if ((unsigned)g->downsample > HF_DOWNSAMPLE_POINT)
        return hf_bad(message, "gather.downsample is %d, which is none", (int)g->downsample);
    if ((unsigned)g->division > HF_DIVISION_NEWTON2)
        return hf_bad(message, "gather.division is %d, which is none", (int)g->division);
    if (r->limit != HF_LIMIT_GIVEN) {
        r->limit = r->limit == HF_LIMIT_NONE || g->faithful ? HF_LIMIT_ENGINE : r->limit;
        r->params.max_radius = g->faithful ? 12 : r->limit == HF_LIMIT_ENGINE ? MEASURED_RADIUS : hf_model_radius(r);
    }
    if (g->rings == HF_DERIVE)
        g->rings = is_measured(r) ? MEASURED_RINGS : hf_taps_rings(r->params.max_radius / 2);
    if (g->rings < 1 || g->rings > HF_MAX_RINGS)
        return hf_bad(message, "gather.rings is %d; it must be 1 to %d", g->rings, HF_MAX_RINGS);
    return HF_OK;
}

static void resolve(void *own, struct hf_setup *s, const struct hf_depth *depth, const struct hf_params *p)
{
    struct hf_gather *g = own;
    const float h = s->max_radius / 2;
    (void)depth;
    s->storage = p->gather.storage;
    s->faithful = p->gather.faithful;
    g->blend = s->strength < 0.25f ? 4 * s->strength : 1;
    g->karis = p->gather.karis;
    g->per_pixel_kernel = p->gather.per_pixel_kernel;
    g->bicubic = p->gather.bicubic;
    g->fill = p->gather.fill == HF_FILL_OPEN ? HF_FILL_NONE : p->gather.fill;
    g->downsample = p->gather.downsample;
    g->division = p->run.deterministic ? HF_DIVISION_EXACT : p->gather.division;
    g->rings = p->gather.rings;
    g->max_x = (int)__builtin_ceilf(h / s->pixel_aspect);
    g->max_y = (int)__builtin_ceilf(h);
    s->measured = is_measured(s->resolved);
    if (s->measured) {  // until then the CoC is the radius over the largest there may be, which a byte cannot hold
        g->smoothstep = s->smoothstep;
        g->storage = s->storage;
        s->smoothstep = 0;
        s->storage = HF_STORAGE_FLOAT;
        g->max_x = g->max_y = 0;
    }
}

// radius: h. Of a measured one rings lie at most 2 apart, if there are so many.
static int build_taps(struct hf_taps *taps, const struct hf_setup *s, const struct hf_params *p, float radius,
                      const struct hf_mem *mem)
{
    const struct hf_taps_key key = {.radius = radius,
                                    .scale = s->strength >= 0.25f ? s->strength : 0.25f,
                                    .pixel_aspect = s->pixel_aspect,
                                    .blades = p->aperture.blades,
                                    .rotation = p->aperture.blades ? p->aperture.rotation : 0,
                                    .dense = p->gather.fill == HF_FILL_NONE,
                                    .rings =
                                        s->measured ? hf_min(p->gather.rings, hf_taps_rings(radius)) : p->gather.rings};
    return hf_taps_build(taps, &key, mem);
}

static int prepare(void *own, const struct hf_setup *s, const struct hf_params *p, const struct hf_mem *mem)
{
    struct hf_gather *g = own;
    return s->measured ? HF_OK : build_taps(&g->taps, s, p, s->max_radius / 2, mem);
}

// Each field's CoC is relative to the largest radius that there is of its kind, and so are its kernels. That is at least
// a pixel.
static int measure(void *own, struct hf_setup *s, const struct hf_counts *found, const struct hf_mem *mem)
{
    struct hf_gather *g = own;
    const struct hf_params *p = &s->resolved->params;
    const float near = __builtin_fmaxf(s->max_radius * found->near_max, 1);
    const float far = __builtin_fmaxf(s->max_radius * found->far_max, 1);
    s->near_i *= s->max_radius / near;
    s->far_i *= s->max_radius / far;
    s->smoothstep = g->smoothstep;
    s->storage = g->storage;
    g->max_x = (int)__builtin_ceilf(near / 2 / s->pixel_aspect);
    g->max_y = (int)__builtin_ceilf(near / 2);
    const int err = build_taps(&g->taps, s, p, near / 2, mem);
    return err ? err : build_taps(&g->far_taps, s, p, far / 2, mem);
}

static void release(void *own, const struct hf_mem *mem)
{
    hf_taps_free(&((struct hf_gather *)own)->taps, mem);
    hf_taps_free(&((struct hf_gather *)own)->far_taps, mem);
}

static size_t bytes(const void *own)
{
    const struct hf_gather *g = own;
    return g->taps.block.size + g->far_taps.block.size;
}

static int cost(const struct hf_setup *s, int numbers[HF_COST_NUMBERS], int *reach)
{
    const struct hf_gather *g = hf_gather(s);
    numbers[0] = g->karis;
    numbers[1] = g->per_pixel_kernel;
    numbers[2] = g->bicubic;
    numbers[3] = (int)g->fill;
    const struct hf_taps *far = hf_gather_taps(s, HF_FAR);
    *reach = hf_max(g->taps.first[g->taps.rows], far->first[far->rows]);  // weights
    numbers[4] = 4 * (int)g->downsample + (int)g->division;
    return 5;
}

HF_CHOOSE_KERNELS(hf_gather_kernels)

void hf_gather_kernels_c(struct hf_gather_kernels *k)
{
    *k = (struct hf_gather_kernels){{{
        [HF_GATHER_COC] = hf_gather_coc,
        [HF_GATHER_DOWN] = hf_down_c,
        [HF_GATHER_MAX_X] = hf_max_x_c,
        [HF_GATHER_MAX_Y] = hf_max_y_c,
        [HF_GATHER_BLUR_X] = hf_blur_x_c,
        [HF_GATHER_BLUR_Y] = hf_blur_y_c,
        [HF_GATHER_COMPUTATION] = hf_gather_c,
        [HF_GATHER_FILL] = hf_fill_c,
        [HF_GATHER_COMPOSITE] = hf_composite_c,
    }}};
}

static void kernels(void *table, enum hf_isa isa, int fused)
{
    hf_gather_kernels_init(table, isa, fused);
}

const struct hf_engine_def hf_gather_engine = {
    .name = "gather",
    .aperture = HF_APERTURE_BLADES,
    .check = check,
    .passes = passes,
    .pass_count = HF_GATHER_PASSES,
    .sweeps = 2,
    .bufs = bufs,
    .buf_count = HF_BUF_COUNT,
    .kernels_bytes = sizeof(struct hf_gather_kernels),
    .kernels = kernels,
    .own_bytes = sizeof(struct hf_gather),
    .resolve = resolve,
    .prepare = prepare,
    .release = release,
    .bytes = bytes,
    .measure = measure,
    .channels = channels,
    .halo = hf_gather_halo,
    .spread = spread,
    .reads = reads,
    .cell = cell,
    .work = work,
    .cost = cost,
};
