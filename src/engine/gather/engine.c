// SPDX-License-Identifier: BSD-3-Clause
// The gather: order, names and buffers of the chapter's figure 3.6 and table 3.1.
#include <float.h>

#include "pass/cells.h"
#include "pass/check.h"
#include "pixel/limits.h"
#include "engine/gather/gather.h"

#define B(name) (1u << HF_BUF_##name)

static const struct hf_pass passes[] = {
    {"CoC generation", .writes = B(COC), .sweep = 1, .ns = 1.7f},
    {"Downsample", .reads = B(COC), .writes = B(COLOR4) | B(COLORNEAR4) | B(COLORFAR4) | B(COC4), .sweep = 1,
     .ns = 1.1f},
    {"Near CoC Max X", .around = B(COC4), .writes = B(MAX_X), .halo = HF_HALO_MAX_X, .sweep = 2, .field = HF_NEAR,
     .ns = 0.7f},
    {"Near CoC Max Y", .around = B(MAX_X), .writes = B(MAX), .halo = HF_HALO_MAX_Y, .sweep = 2, .field = HF_NEAR,
     .ns = 0.25f},
    {"Near CoC Blur X", .around = B(MAX), .writes = B(BLUR_X), .halo = HF_HALO_BLUR_X, .sweep = 2, .field = HF_NEAR,
     .ns = 0.25f},
    {"Near CoC Blur Y", .around = B(BLUR_X), .writes = B(BLUR), .halo = HF_HALO_BLUR_Y, .sweep = 2, .field = HF_NEAR,
     .ns = 0.27f},
    {"Computation", .reads = B(BLUR), .around = B(COLOR4) | B(COLORNEAR4) | B(COLORFAR4) | B(COC4),
     .writes = B(NEAR) | B(FAR) | B(COVER) | B(FAR_PART),
     .inside =
         B(SUM) | B(LEVEL_SUM) | B(LEVEL_WEIGHT_SUM) | B(BEHIND) | B(BEHIND_WEIGHT) | B(SPREAD) | B(SPREAD_WEIGHT),
     .weighed = B(WEIGHT) | B(COLORW4) | B(COLORFARW4) | B(LEVEL) | B(LEVEL_WEIGHT), .halo = HF_HALO_TAPS, .sweep = 2,
     .ns = 4},
    {"Fill", .reads = B(BLUR), .around = B(NEAR) | B(FAR) | B(COC4), .writes = B(NEAR_FILL) | B(FAR_FILL),
     .halo = HF_HALO_3X3, .sweep = 2, .ns = 0.75f},
    {"Composite", .around = B(NEAR) | B(FAR) | B(NEAR_FILL) | B(FAR_FILL) | B(COVER) | B(FAR_PART) | B(BLUR) | B(COC4),
     .halo = HF_HALO_UPSAMPLE, .sweep = 2, .ns = 3.2f},
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
    [HF_BUF_COLORNEAR4] = {"colormulnear4", .frame = 1, .field = HF_NEAR},
    [HF_BUF_COVER] = {"cover", .field = HF_NEAR},
    [HF_BUF_FAR_PART] = {"farpart", .field = HF_FAR},
};

static int channels(const struct hf_setup *s, int b)
{
    const struct hf_gather *g = hf_gather(s);
    const int levels = g->area && !(hf_gather_is_simple(s, HF_NEAR) && hf_gather_is_simple(s, HF_FAR));
    switch (b) {
    case HF_BUF_COC:
        return 4;
    case HF_BUF_COC4:
        return !g->area ? 2 : hf_gather_is_simple(s, HF_FAR) ? HF_AREA_FAR_MOST : HF_AREA_FAR_MOST + 1;
    case HF_BUF_SUM:
        return !g->area || levels ? 2 : 0;
    case HF_BUF_MAX_X:
    case HF_BUF_MAX:
    case HF_BUF_BLUR_X:
    case HF_BUF_BLUR:
        return 1;
    case HF_BUF_WEIGHT:
        return g->area ? (g->lights ? 3 : g->karis) : g->karis ? 2 : 0;
    case HF_BUF_COLORW4:
    case HF_BUF_COLORFARW4:
        return g->karis && !g->area ? s->channels : 0;
    case HF_BUF_NEAR_FILL:
    case HF_BUF_FAR_FILL:
        return g->area ? 0 : s->channels;
    case HF_BUF_COLORNEAR4:
        return g->area ? s->channels : 0;
    case HF_BUF_COVER:
    case HF_BUF_FAR_PART:
        return g->area;
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
        return s->channels;
    }
}

// The largest kernel of both fields.
static struct hf_reach taps_reach(const struct hf_setup *s)
{
    const struct hf_gather *g = hf_gather(s);
    const struct hf_taps *near = g->area ? &g->levels[0].level[0].taps : hf_gather_taps(s, HF_NEAR);
    const struct hf_taps *far = g->area ? &g->levels[1].level[0].taps : hf_gather_taps(s, HF_FAR);
    return (struct hf_reach){hf_max(near->rx, far->rx), hf_max(near->ry, far->ry)};
}

struct hf_reach hf_gather_halo(const struct hf_setup *s, int halo)
{
    const struct hf_gather *g = hf_gather(s);
    switch (halo) {
    case HF_HALO_3X3:
        return (struct hf_reach){!g->area, !g->area};
    case HF_HALO_MAX_X:
        return (struct hf_reach){g->max_x, 0};
    case HF_HALO_MAX_Y:
        return (struct hf_reach){0, g->max_y};
    case HF_HALO_BLUR_X:
        return (struct hf_reach){g->blur_x, 0};
    case HF_HALO_BLUR_Y:
        return (struct hf_reach){0, g->blur_y};
    case HF_HALO_TAPS:
        // One more for the per-pixel kernel, whose bilinear taps read a neighbour even with weight 0.
        return (struct hf_reach){taps_reach(s).x + g->per_pixel_kernel + g->lights,
                                 taps_reach(s).y + g->per_pixel_kernel + g->lights};
    case HF_HALO_UPSAMPLE:
        return g->bicubic ? (struct hf_reach){2, 2} : (struct hf_reach){1, 1};
    default:
        return (struct hf_reach){0, 0};
    }
}

// Blurred near CoC is 0 unless there is some within the reach of the four passes; the far field stays where it is.
static struct hf_reach spread(const struct hf_setup *s, const struct hf_cells *p, unsigned field)
{
    const struct hf_gather *g = hf_gather(s);
    if (field == HF_FAR)
        return (struct hf_reach){0, 0};
    if (g->area) {
        const struct hf_taps *t = &g->levels[0].level[0].taps;
        const struct hf_reach up = hf_gather_halo(s, HF_HALO_UPSAMPLE);
        return (struct hf_reach){hf_max(t->rx, g->max_x + g->blur_x) + up.x,
                                 hf_max(t->ry, g->max_y + g->blur_y) + up.y};
    }
    return (struct hf_reach){p->pass[HF_GATHER_MAX_X].x + g->max_x, p->pass[HF_GATHER_MAX_X].y};
}

// Karis weights are made from the colour, whatever they weigh; and what near pixels hide hangs on how far it is blurred.
static unsigned reads(const struct hf_setup *s, unsigned needs)
{
    const struct hf_gather *g = hf_gather(s);
    const int leaves = g->area && hf_gather_leaves(s);
    return (needs && g->karis) || (needs & HF_NEAR && leaves) ? HF_FIELDS : needs;
}

// The passes that fill in between taps are for taps.
static int runs(const struct hf_setup *s, int pass)
{
    return !(hf_gather(s)->area && pass == HF_GATHER_FILL);
}

// What the kernels need: terms, pairs and their sums of the gather for strips of up to 80 columns, and by area a strip's
// sums; values and partial sums of the near blur for 16; and three rows for the mean fill.
static size_t work(const struct hf_setup *s, const struct hf_cells *p)
{
    const size_t height = (size_t)p->height[2] + 2 * (size_t)p->pass[HF_GATHER_COMPUTATION].y;
    const size_t strip = hf_gather(s)->area ? height * HF_STRIP * HF_STRIP_PLANES : 0;
    const size_t rows = 2 * (size_t)taps_reach(s).y + 1, columns = 2 * (size_t)taps_reach(s).x + 2;
    const size_t gather = strip + 2 * rows * columns + 16 + columns * 80;
    const size_t near = 2 * ((size_t)p->height[2] + 2 * (size_t)p->buf[HF_BUF_BLUR_X].y) * 16;
    const size_t most = gather > near ? gather : near, fill = 3 * p->line_floats;
    return most > fill ? most : fill;
}

// Tiles lower than the default: more of a mixed picture is skipped, and its scratch is smaller. By area they are wider:
// fewer columns are made twice, and most sums take no room.
static void cell(const struct hf_setup *s, int sweep, int *width, int *height)
{
    (void)sweep;
    *width = hf_gather(s)->area && *width == 320 ? 480 : *width;
    *height = hf_min(*height, 72);
}

// Where radii are found in the depth (engine.h, measured): the largest, full-resolution pixels, and the most rings, which
// are at most 2 apart up to a radius of 96. More of either cost more than the other engines.
enum { MEASURED_RADIUS = 256, MEASURED_RINGS = 24 };

static int is_measured(const struct hf_settings *r)
{
    return r->limit == HF_LIMIT_ENGINE && !r->params.gather.faithful;
}

// Faithfully it reaches 12 pixels at any size, with a lens, too.
static int check(struct hf_settings *r, const struct hf_params *asked, const struct hf_depth *depth,
                 struct hf_message *message)
{
    struct hf_gather_params *g = &r->params.gather;
    (void)asked;
    (void)depth;
    int err = hf_check_value("gather.storage", (int)g->storage, 0, HF_STORAGE_PACKED, message);
    if (!err)
        err = hf_check_value("gather.fill", (int)g->fill, HF_FILL_AUTO, HF_FILL_OPEN, message);
    if (!err)
        err = hf_check_value("gather.downsample", (int)g->downsample, 0, HF_DOWNSAMPLE_POINT, message);
    if (!err)
        err = hf_check_value("gather.division", (int)g->division, 0, HF_DIVISION_NEWTON2, message);
    if (err)
        return err;
    if (g->fill == HF_FILL_AUTO)
        g->fill =
            g->faithful || g->downsample || (g->division && !r->params.run.deterministic) ? HF_FILL_MAX : HF_FILL_MEAN;
    if (r->limit != HF_LIMIT_GIVEN) {
        r->limit = r->limit == HF_LIMIT_NONE || g->faithful ? HF_LIMIT_ENGINE : r->limit;
        r->params.max_radius = g->faithful                   ? 12
                               : r->limit == HF_LIMIT_ENGINE ? MEASURED_RADIUS
                                                             : hf_model_radius(r->params.view.display_height);
    }
    r->rings_given = g->rings != HF_DERIVE;
    if (!r->rings_given)
        g->rings = is_measured(r) ? MEASURED_RINGS : hf_taps_rings(r->params.max_radius / 2);
    if (g->rings < 1 || g->rings > HF_MAX_RINGS)
        return hf_bad(message, "gather.rings", "is %d; it must be 1 to %d", g->rings, HF_MAX_RINGS);
    return HF_OK;
}

// By area the near maximum and blur are not the near field's edge: they are where near pixels hide what is behind them,
// and what full-resolution pixels of a quad and its neighbours see of that.
enum { AREA_MAX = 2, AREA_BLUR = 1 };

// How much the outermost of so many values to either side count where a window reaches a radius: all in the chapter.
static float edge(const struct hf_gather *g, const struct hf_setup *s, int reach, float radius)
{
    return g->area || s->faithful ? 1 : radius - (float)(reach - 1);
}

static void set_reach(struct hf_gather *g, const struct hf_setup *s, float h)
{
    const float hx = h / s->pixel_aspect;
    g->max_x = g->area ? AREA_MAX : (int)__builtin_ceilf(hx);
    g->max_y = g->area ? AREA_MAX : (int)__builtin_ceilf(h);
    g->edge_x = edge(g, s, g->max_x, hx);
    g->edge_y = edge(g, s, g->max_y, h);
    g->blur_x = g->area ? AREA_BLUR : g->max_x;
    g->blur_y = g->area ? AREA_BLUR : g->max_y;
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
    g->lights = 0;
    g->area = !s->faithful && g->fill == HF_FILL_MEAN && !g->downsample && !g->division;
    s->zero_beyond = g->area;
    // Fields of half resolution come in by and by where the radius is smaller than one of its pixels, as by area.
    if (!g->area)
        g->blend *= __builtin_fminf(h, 1);
    set_reach(g, s, h);
    s->measured = is_measured(s->resolved);
    if (s->measured) {  // until then the CoC is the radius over the largest there may be, which a byte cannot hold
        g->smoothstep = s->smoothstep;
        g->storage = s->storage;
        s->smoothstep = 0;
        s->storage = HF_STORAGE_FLOAT;
        g->max_x = g->max_y = g->blur_x = g->blur_y = 0;
    }
}

// Levels' radii: of one, from the one before. Far highlights are to be discs with an edge; the near field's larger ones are
// dear, and mostly lie over one another.
static const float LEVEL_STEP[2] = {0.5f, 0.8f};

// Rings for a radius of h: those that lie 2 apart where nothing else is said, or of a measured one, if there are so many.
static float ring_count(const struct hf_setup *s, const struct hf_params *p, float radius)
{
    const float most = (float)p->gather.rings, spaced = hf_taps_spaced(radius);
    if (s->faithful || (s->resolved->rings_given && !s->measured))
        return most;
    return spaced < most ? spaced : most;
}

// radius: h.
static int build_taps(struct hf_taps *taps, const struct hf_setup *s, const struct hf_params *p, float radius,
                      const struct hf_mem *mem)
{
    const struct hf_taps_key key = {.radius = radius,
                                    .scale = s->strength >= 0.25f ? s->strength : 0.25f,
                                    .pixel_aspect = s->pixel_aspect,
                                    .blades = p->aperture.blades,
                                    .rotation = p->aperture.blades ? p->aperture.rotation : 0,
                                    .dense = p->gather.fill == HF_FILL_NONE,
                                    .rings = p->gather.fill == HF_FILL_NONE ? 0 : ring_count(s, p, radius)};
    return hf_taps_build(taps, &key, mem, s->stop);
}

// radius: h. With levels from it down to 1, each a step smaller than the one before; the last is 1, so that a radius that
// grows adds a level where there is one already. Where levels are summed, that one counts by how far it is away from the one
// before, else its samples would at once count twice.
static int build_levels(struct hf_gather *g, int far, const struct hf_setup *s, const struct hf_params *p, float radius,
                        const struct hf_mem *mem)
{
    struct hf_levels *l = &g->levels[far];
    const float scale = s->strength >= 0.25f ? s->strength : 0.25f, largest = __builtin_fmaxf(radius * scale, 1);
    const int many = s->measured || p->gather.per_pixel_kernel;
    l->count = 0;
    for (float r = largest, before = 0, next; l->count < HF_MAX_LEVELS; before = r, r = next) {
        struct hf_level *level = &l->level[l->count++];
        const struct hf_taps_key key = {.radius = r,
                                        .scale = 1,
                                        .pixel_aspect = s->pixel_aspect,
                                        .blades = p->aperture.blades,
                                        .rotation = p->aperture.blades ? p->aperture.rotation : 0,
                                        .area = 1,
                                        // Nothing lies beyond the frame: no pixel has another farther away.
                                        .most_x = hf_max(s->half_width - 1, 1),
                                        .most_y = hf_max(s->half_height - 1, 1)};
        level->coc = r / (radius * scale);
        level->inverse = 1 / level->coc;
        level->again = before > 0 ? 1 - (1 - r / before) / (1 - LEVEL_STEP[far]) : 0;
        level->area = level->coc * level->coc;
        next = __builtin_fmaxf(LEVEL_STEP[far] * r, 1);
        const float after = next / (radius * scale);
        // Radii that differ may have one CoC.
        level->to_next = r > next ? __builtin_fminf(1 / (level->coc - after), FLT_MAX) : 0;
        level->area_to_next = r > next ? __builtin_fminf(1 / (level->area - after * after), FLT_MAX) : 0;
        l->gain = (s->strength < 0.25f ? 4 * s->strength : 1) / level->coc;
        l->hides = many ? l->gain : l->gain * (8 / 7.0f);
        const int err = hf_taps_build(&level->taps, &key, mem, s->stop);
        if (err)
            return err;
        if (!many || r <= 1)
            break;
    }
    return HF_OK;
}

static int build(struct hf_gather *g, const struct hf_setup *s, const struct hf_params *p, float near, float far,
                 const struct hf_mem *mem)
{
    if (g->area) {
        const int err = build_levels(g, 0, s, p, near, mem);
        for (int i = 0; i < g->levels[0].count; i++)
            g->levels[0].level[i].half_far = far / near * 0.5f * g->levels[0].level[i].inverse;
        return err ? err : build_levels(g, 1, s, p, far, mem);
    }
    const int err = build_taps(&g->taps, s, p, near, mem);
    return err || !s->measured ? err : build_taps(&g->far_taps, s, p, far, mem);
}

static int prepare(void *own, const struct hf_setup *s, const struct hf_params *p, const struct hf_mem *mem)
{
    struct hf_gather *g = own;
    return s->measured ? HF_OK : build(g, s, p, s->max_radius / 2, s->max_radius / 2, mem);
}

// How far apart what is beside a light is looked at: as far as a light is large that leaves no rings, 16 pixels in a frame
// of 720 lines.
static int lights_apart(int display_height)
{
    return hf_max(hf_min(display_height / 90, 32), 1);
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
    set_reach(g, s, near / 2);
    const int err = build(g, s, p, near / 2, far / 2, mem);
    g->lights = g->area && g->levels[0].count > 1 ? lights_apart(s->resolved->params.view.display_height) : 0;
    return err;
}

static void release(void *own, const struct hf_mem *mem)
{
    struct hf_gather *g = own;
    for (int i = 0; i < 2 * HF_MAX_LEVELS; i++)
        hf_taps_free(&g->levels[i / HF_MAX_LEVELS].level[i % HF_MAX_LEVELS].taps, mem);
    hf_taps_free(&((struct hf_gather *)own)->taps, mem);
    hf_taps_free(&((struct hf_gather *)own)->far_taps, mem);
}

static size_t held(const void *own)
{
    const struct hf_gather *g = own;
    size_t sum = g->taps.block.size + g->far_taps.block.size;
    for (int i = 0; i < 2 * HF_MAX_LEVELS; i++)
        sum += g->levels[i / HF_MAX_LEVELS].level[i % HF_MAX_LEVELS].taps.block.size;
    return sum;
}

static int cost(const struct hf_setup *s, int numbers[HF_COST_NUMBERS], int *reach)
{
    const struct hf_gather *g = hf_gather(s);
    numbers[0] = g->karis;
    numbers[1] = g->per_pixel_kernel;
    numbers[2] = g->bicubic;
    numbers[3] = (int)g->fill;
    if (g->area) {
        *reach = taps_reach(s).y;
        return 4;
    }
    const struct hf_taps *far = hf_gather_taps(s, HF_FAR);
    *reach = hf_max(g->taps.first[g->taps.rows], far->first[far->rows]);  // weights
    numbers[4] = 4 * (int)g->downsample + (int)g->division;
    return 5;
}

// With levels quads are mixed by each sample's CoC, and every level is a convolution of its own, whose rows grow with its
// radius.
static float times(const struct hf_setup *s, int pass, unsigned field, float radius)
{
    const struct hf_levels *l = hf_gather_levels(s, field);
    if (!hf_gather(s)->area || l->count < 2)
        return 1;
    float sum = 0;  // of the levels' radii, half-resolution pixels
    for (int i = 0; i < l->count; i++)
        sum += l->level[i].coc * radius / 2;
    return pass == HF_GATHER_DOWN          ? 6
           : pass == HF_GATHER_COMPUTATION ? 5.7f + 0.52f * sum
           : pass == HF_GATHER_COMPOSITE   ? 2.6f
                                           : 1;
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

const struct hf_engine_def hf_gather_engine = {
    .name = "gather",
    .passes = passes,
    .pass_count = HF_GATHER_PASSES,
    .sweeps = 2,
    .bufs = bufs,
    .buf_count = HF_BUF_COUNT,
    .limits = {.aperture = HF_APERTURE_BLADES, .check = check},
    .kernels = {sizeof(struct hf_gather_kernels), hf_gather_kernels_init},
    .own = {sizeof(struct hf_gather), .resolve = resolve, .prepare = prepare, .measure = measure, .release = release,
            .held = held},
    .plan = {.channels = channels,
             .runs = runs,
             .halo = hf_gather_halo,
             .spread = spread,
             .reads = reads,
             .cell = cell,
             .work = work},
    .cost = {.times = times, .numbers = cost},
};
