// SPDX-License-Identifier: BSD-3-Clause
// The gather: its passes and buffers, and what it makes of its parameters.
#include <float.h>
#include <math.h>

#include "pass/cells.h"
#include "pass/check.h"
#include "engine/gather/gather.h"

#define B(name) HF_BIT(name)

static const struct hf_pass passes[] = {
    HF_FIELDS_PASSES(B(COLORNEAR4)),
    {"Computation", .reads = B(BLUR), .around = B(COLOR4) | B(COLORNEAR4) | B(COLORFAR4) | B(COC4),
     .writes = B(NEAR) | B(FAR) | B(COVER) | B(FAR_PART),
     .inside =
         B(SUM) | B(LEVEL_SUM) | B(LEVEL_WEIGHT_SUM) | B(BEHIND) | B(BEHIND_WEIGHT) | B(SPREAD) | B(SPREAD_WEIGHT),
     .weighed = B(WEIGHT) | B(LEVEL) | B(LEVEL_WEIGHT), .halo = HF_HALO_TAPS, .sweep = 2, .ns = 4},
    {"Composite", .around = B(NEAR) | B(FAR) | B(COVER) | B(FAR_PART), .halo = HF_HALO_UPSAMPLE, .sweep = 2,
     .ns = 3.2f},
};
_Static_assert(sizeof passes / sizeof *passes == HF_GATHER_PASSES, "one row per pass");

static const struct hf_buf_def bufs[HF_GATHER_BUFS] = {
    HF_FIELDS_BUFS,
    [HF_BUF_COLORNEAR4] = {"colormulnear4", .frame = 1, .field = HF_NEAR},
    [HF_BUF_COVER] = {"cover", .field = HF_NEAR},
    [HF_BUF_FAR_PART] = {"farpart", .field = HF_FAR},
};

static int channels(const struct hf_setup *s, int b)
{
    const struct hf_gather *g = hf_gather(s);
    const int levels = !hf_gather_is_simple(s);
    switch (b) {
    case HF_BUF_COC4:
        return levels ? HF_AREA_FAR_OF_LIGHT + 1 : HF_AREA_FAR_OF_LIGHT;
    case HF_BUF_SUM:
        return levels ? 2 : 0;
    case HF_BUF_WEIGHT:
        return g->lights ? 3 : g->fields.karis;
    case HF_BUF_COVER:
    case HF_BUF_FAR_PART:
        return 1;
    case HF_BUF_LEVEL:
    case HF_BUF_LEVEL_SUM:
    case HF_BUF_BEHIND:
    case HF_BUF_SPREAD:
        return levels ? s->channels : 0;
    case HF_BUF_LEVEL_WEIGHT:
    case HF_BUF_LEVEL_WEIGHT_SUM:
    case HF_BUF_BEHIND_WEIGHT:
    case HF_BUF_SPREAD_WEIGHT:
        return levels ? 3 : 0;
    default:
        return hf_fields_channels(s, b);
    }
}

static const struct hf_taps *largest(const struct hf_setup *s, unsigned field)
{
    const struct hf_levels *l = hf_gather_levels(s, field);
    return &l->level[l->filled].kernel.taps;
}

// The largest kernel of all.
static struct hf_reach taps_reach(const struct hf_setup *s)
{
    const struct hf_taps *near = largest(s, HF_NEAR), *far = largest(s, HF_FAR);
    const struct hf_taps *behind = &hf_gather_behind(s)->level[0].kernel.taps;
    return (struct hf_reach){hf_max(hf_max(near->rx, far->rx), behind->rx),
                             hf_max(hf_max(near->ry, far->ry), behind->ry)};
}

struct hf_reach hf_gather_halo(const struct hf_setup *s, int halo)
{
    const int more = hf_gather(s)->lights;
    if (halo != HF_HALO_TAPS)
        return hf_fields_halo(s, halo);
    return (struct hf_reach){taps_reach(s).x + more, taps_reach(s).y + more};
}

// Blurred near CoC is 0 unless there is some within the reach of the four passes; the far field stays where it is.
static struct hf_reach spread(const struct hf_setup *s, const struct hf_cells *p, unsigned field)
{
    const struct hf_fields *g = hf_fields(s);
    const struct hf_taps *t = largest(s, HF_NEAR);
    const struct hf_reach up = hf_fields_halo(s, HF_HALO_UPSAMPLE);
    (void)p;
    if (field == HF_FAR)
        return (struct hf_reach){0, 0};
    return (struct hf_reach){hf_max(t->rx, g->max_x + g->blur_x) + up.x, hf_max(t->ry, g->max_y + g->blur_y) + up.y};
}

// Karis weights are made from the colour, whatever they weigh; and what near pixels hide depends on how far it is blurred.
static unsigned reads(const struct hf_setup *s, unsigned needs)
{
    return (needs && hf_fields(s)->karis) || (needs & HF_NEAR && hf_gather(s)->leaves) ? HF_FIELDS : needs;
}

// What the kernels need: a strip's sums, in whose place levels note what their rows hold; terms, pairs and their sums of
// the convolution for two rows of strips of up to 80 columns; and values and partial sums of the near blur for 16.
static size_t work(const struct hf_setup *s, const struct hf_cells *p)
{
    const size_t height = (size_t)p->height[2] + 2 * (size_t)p->pass[HF_PASS_COMPUTATION].y;
    const size_t rows = 2 * (size_t)taps_reach(s).y + 1, columns = 2 * (size_t)taps_reach(s).x + 2;
    const size_t sums = height * HF_STRIP * HF_STRIP_PLANES + 2 * rows * columns + 16 + columns * 160;
    const size_t near = 2 * ((size_t)p->height[2] + 2 * (size_t)p->buf[HF_BUF_BLUR_X].y) * 16;
    return sums > near ? sums : near;
}

// Tiles are wider than the default, because what lies around one is made again for it. They are also lower, so that more of a mixed
// picture is skipped and scratch stays small; but not where the largest kernel reaches so far that this would cost more.
static void cell(const struct hf_setup *s, int sweep, int *width, int *height)
{
    (void)sweep;
    *width = *width == HF_CELL_WIDTH ? 640 : *width;
    *height = taps_reach(s).y < 10 ? hf_min(*height, 72) : *height;
}

static int check(struct hf_settings *r, const struct hf_params *asked, const struct hf_depth *depth,
                 struct hf_message *message)
{
    (void)asked;
    (void)depth;
    const int err = hf_check_value("gather.storage", (int)r->params.gather.storage, 0, HF_STORAGE_PACKED, message);
    if (err)
        return err;
    hf_fields_limit(r);
    return HF_OK;
}

// The near maximum and blur are not the near field's edge: they are where near pixels hide what is behind them, and what
// full-resolution pixels of a quad and its neighbours see of that.
static void set_reach(struct hf_fields *g)
{
    g->max_x = g->max_y = 2;
    g->blur_x = g->blur_y = 1;
}

static void resolve(void *own, struct hf_setup *s, const struct hf_depth *depth, const struct hf_params *p)
{
    struct hf_gather *g = own;
    (void)depth;
    s->storage = p->gather.storage;
    g->lights = g->leaves = 0;
    g->fields = (struct hf_fields){.near_coc = HF_AREA_NEAR_MOST,
                                   .edge_x = 1,
                                   .edge_y = 1,
                                   .karis = p->gather.karis,
                                   .per_pixel_kernel = p->gather.per_pixel_kernel,
                                   .bicubic = p->gather.bicubic,
                                   .blend = s->strength < 0.25f ? 4 * s->strength : 1};
    set_reach(&g->fields);
    s->measured = hf_fields_are_measured(s->resolved);
    if (s->measured)
        hf_fields_wait(&g->fields, s);
}

// Levels' radii, half-resolution pixels, the largest first; these return how many. No sample changes those of others, nor does
// what a frame shows besides: near ones are powers of two or of its root, and far ones are what the lens makes of infinity, 0.88
// of that and so on, as backgrounds are often infinitely far and their highlights are to be discs with an edge. A frame has as
// many as its largest radius needs.
static int near_radii(float largest, int per_octave, float *radius)
{
    int n = 0, k = 0;
    while (k < HF_MAX_LEVELS - 1 && exp2f((float)k / (float)per_octave) < largest)
        k++;
    for (; k >= 0; k--)
        radius[n++] = exp2f((float)k / (float)per_octave);
    return n;
}

// A far pixel sees levels beyond its own radius: these are there, too, so that it is the same in any frame. *filled: the first
// that samples are in.
static int far_radii(float most, float largest, float *radius, int *filled)
{
    const float step = 0.88f;
    int n = 0;
    while (step * most >= HF_FAR_WIDER * largest)
        most *= step;
    *filled = 0;
    for (; n < HF_MAX_LEVELS - 1 && most > 1; most *= step) {
        *filled = most >= largest ? n : *filled;
        radius[n++] = most;
    }
    *filled = largest <= 1 ? n : *filled;
    radius[n++] = 1;
    return n;
}

// Of several levels, parts follow from the lens: a disc of radius r has the variance r^2 / 2, and a blend of the picture with
// the smallest kernel must have it too. Near pixels are counted twice, in the field and in how far it hides the picture under
// it: (q^2 + q^6) / 2 there comes to less than 1.06 q^2, and its slope stays finite at 1. With one kernel alone a pixel's
// part is its CoC, and all of the field fades in so.
static struct hf_part_curve curve_of(int far)
{
    return far ? (struct hf_part_curve){.square = 1} : (struct hf_part_curve){.square = 0.5f, .sixth = 0.5f};
}

// One kernel for each radius. full: the radius whose CoC is 1.
static int build_levels(struct hf_levels *l, int far, const float *radius, int count, float full,
                        const struct hf_setup *s, const struct hf_params *p, const struct hf_mem *mem)
{
    // A pixel gathers what draws on it, so the kernel is the aperture by half a turn. In front of the focus that is by another.
    const float turn = far && p->aperture.blades % 2 ? 180 : 0,
                rotation = p->aperture.blades ? p->aperture.rotation + turn : 0;
    l->count = count;
    for (int i = 0; i < count; i++) {
        struct hf_level *level = &l->level[i];
        const struct hf_area_key key = {.radius = radius[i],
                                        .pixel_aspect = s->pixel_aspect,
                                        .blades = p->aperture.blades,
                                        .rotation = rotation,
                                        // Nothing lies beyond the frame: no pixel has another farther away.
                                        .most_x = hf_max(s->half_width - 1, 1),
                                        .most_y = hf_max(s->half_height - 1, 1),
                                        .soft = hf_gather(s)->many && !far};
        const float after = i + 1 < count ? radius[i + 1] / full : 0;
        level->coc = radius[i] / full;
        level->area = level->coc * level->coc;
        // Radii that differ may have one CoC.
        level->to_next = __builtin_fminf(1 / (level->coc - after), FLT_MAX);
        level->area_to_next = __builtin_fminf(1 / (level->area - after * after), FLT_MAX);
        l->gain = 1 / level->coc;
        const int err = i < l->filled ? HF_OK : hf_area_kernel_build(&level->kernel, &key, mem, s->stop);
        if (err)
            return err;
    }
    return HF_OK;
}

// A field's kernels, of radii up to `largest`; most: the far radius that the others follow.
static int build_field(struct hf_gather *g, int far, const struct hf_setup *s, const struct hf_params *p, float full,
                       float largest, float most, const struct hf_mem *mem)
{
    struct hf_levels *l = &g->levels[far];
    float radius[HF_MAX_LEVELS] = {largest};
    l->filled = 0;
    const int count = !g->many ? 1
                      : far    ? far_radii(most, largest, radius, &l->filled)
                               : near_radii(largest, 2, radius);
    const int err = build_levels(l, far, radius, count, full, s, p, mem);
    l->curve = curve_of(far);
    if (!g->many) {
        l->gain = hf_level_part(l, l->gain, 1);
        l->curve = (struct hf_part_curve){.linear = 1};
    }
    l->gain *= s->strength < 0.25f ? 4 * s->strength : 1;
    l->hides = g->many ? l->gain : l->gain * (8 / 7.0f);
    return err;
}

// Radii of each field, half-resolution pixels: whose CoC is 1, and the largest.
struct radii {
    float full[2], largest[2];
};

static int build(struct hf_gather *g, const struct hf_setup *s, const struct hf_params *p, const struct radii *r,
                 float most, const struct hf_mem *mem)
{
    struct hf_levels *behind = &g->levels[2];
    float radius[HF_MAX_LEVELS] = {r->largest[0]};
    const int count = g->many ? near_radii(r->largest[0], 1, radius) : 1;
    int err = build_field(g, 0, s, p, r->full[0], r->largest[0], 0, mem);
    if (!err)
        err = build_field(g, 1, s, p, r->full[1], r->largest[1], most, mem);
    if (!err)
        err = build_levels(behind, 0, radius, count, r->full[0], s, p, mem);
    if (err)
        return err;
    const float area = behind->level[behind->count - 1].area, counts = 1 / (area * area * area);
    g->once = 1;
    while (g->many && g->once * counts > HF_COUNTS_MOST)
        g->once /= 2;
    for (int i = 0; i < behind->count; i++) {
        struct hf_level *l = &behind->level[i];
        l->counts = g->once / (g->many ? l->area * l->area * l->area : l->area);
        l->half_far = 0.5f * r->full[1] / (r->full[0] * l->coc);
    }
    return HF_OK;
}

static int prepare(void *own, const struct hf_setup *s, const struct hf_params *p, const struct hf_mem *mem)
{
    struct hf_gather *g = own;
    const float scale = s->strength >= 0.25f ? s->strength : 0.25f;
    const float full = s->max_radius / 2 * scale, largest = __builtin_fmaxf(full, 1);
    g->many = s->measured || p->gather.per_pixel_kernel;
    g->leaves = !s->measured && g->many;
    return s->measured ? HF_OK : build(g, s, p, &(struct radii){{full, full}, {largest, largest}}, largest, mem);
}

// hf_gather_lights_c compares each sample with the samples at this distance on its four sides, in half-resolution
// pixels. The distance is the size up to which a light leaves no rings: 16 full-resolution pixels in a frame of 720
// lines.
static int lights_apart(int display_height)
{
    return hf_max(hf_min(display_height / 90, 32), 1);
}

// The radius of what is infinitely far, or the largest there may be.
static float farthest(const struct hf_setup *s)
{
    return s->lens ? __builtin_fminf(-s->radius_0 * s->radius_k, s->max_radius) : s->max_radius;
}

static int measure(void *own, struct hf_setup *s, const struct hf_counts *found, const struct hf_mem *mem)
{
    struct hf_gather *g = own;
    const struct hf_params *p = &s->resolved->params;
    float largest[2], full[2] = {1, 1};
    hf_fields_found(s, found, largest);
    // Powers of two: a larger one changes no bit.
    for (int i = 0; i < 2; i++)
        while (full[i] < largest[i])
            full[i] *= 2;
    hf_fields_scale(&g->fields, s, full);
    set_reach(&g->fields);
    g->lights = found->near_max > 0 ? lights_apart(p->view.display_height) : 0;
    g->leaves = found->near_max > 0 && found->far_max > 0;
    const struct radii r = {{full[0] / 2, full[1] / 2},
                            {__builtin_fmaxf(largest[0] / 2, 1), __builtin_fmaxf(largest[1] / 2, 1)}};
    return build(g, s, p, &r, farthest(s) / 2, mem);
}

static void release(void *own, const struct hf_mem *mem)
{
    struct hf_gather *g = own;
    for (int i = 0; i < 3 * HF_MAX_LEVELS; i++)
        hf_area_kernel_free(&g->levels[i / HF_MAX_LEVELS].level[i % HF_MAX_LEVELS].kernel, mem);
}

static size_t held(const void *own)
{
    const struct hf_gather *g = own;
    size_t sum = 0;
    for (int i = 0; i < 3 * HF_MAX_LEVELS; i++)
        sum += g->levels[i / HF_MAX_LEVELS].level[i % HF_MAX_LEVELS].kernel.block.size;
    return sum;
}

static int cost(const struct hf_setup *s, int numbers[HF_COST_NUMBERS], int *reach)
{
    const struct hf_fields *g = hf_fields(s);
    numbers[0] = g->karis;
    numbers[1] = g->per_pixel_kernel;
    numbers[2] = g->bicubic;
    *reach = taps_reach(s).y;
    return 3;
}

// With levels quads are mixed by each sample's CoC, and every level is a convolution of its own, whose rows grow with its
// radius.
static float times(const struct hf_setup *s, int pass, unsigned field, float radius)
{
    const struct hf_levels *l = field == HF_NEAR ? hf_gather_behind(s) : hf_gather_levels(s, field);
    (void)radius;
    if (!hf_gather(s)->many)
        return 1;
    float sum = 0;  // of the levels' radii, half-resolution pixels
    for (int i = l->filled; i < l->count; i++)
        sum += l->level[i].kernel.key.radius / (float)l->level[i].kernel.taps.step;
    return pass == HF_PASS_DOWN          ? 6
           : pass == HF_PASS_COMPUTATION ? 5.7f + 0.52f * sum
           : pass == HF_GATHER_COMPOSITE ? 2.6f
                                         : 1;
}

HF_CHOOSE_KERNELS(hf_gather_kernels)

void hf_gather_kernels_c(struct hf_gather_kernels *k)
{
    *k = (struct hf_gather_kernels){{{
        HF_FIELDS_KERNELS,
        [HF_PASS_DOWN] = hf_gather_down_c,
        [HF_PASS_COMPUTATION] = hf_gather_computation_c,
        [HF_GATHER_COMPOSITE] = hf_gather_composite_c,
    }}};
}

const struct hf_engine_def hf_gather_engine = {
    .name = "gather",
    .passes = passes,
    .pass_count = HF_GATHER_PASSES,
    .sweeps = 2,
    .bufs = bufs,
    .buf_count = HF_GATHER_BUFS,
    .limits = {.aperture = HF_APERTURE_BLADES, .check = check},
    .kernels = {sizeof(struct hf_gather_kernels), hf_gather_kernels_init},
    .own = {sizeof(struct hf_gather), .resolve = resolve, .prepare = prepare, .measure = measure, .release = release,
            .held = held},
    .plan = {.zero_beyond = 1,
             .channels = channels,
             .halo = hf_gather_halo,
             .spread = spread,
             .reads = reads,
             .cell = cell,
             .work = work},
    .cost = {.times = times, .numbers = cost},
};
