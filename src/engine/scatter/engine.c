// SPDX-License-Identifier: BSD-3-Clause
// The scatter engine: B. Wronski, "Bokeh depth of field - going insane! part 1", 2014. Every blurred pixel draws a
// sprite, the picture of the aperture. Near and far are summed separately, and each is divided by its weights. They are
// composited back to front: far field, pixels in focus, near field. The near sum of weights is its coverage, 1 inside a
// large object and less across its silhouette. So a near object melts into its background, which is guessed from what
// is visible around it (behind.c).
//
// Cost of a blurred pixel of radius r, in additions of four 64-bit lanes:
//    disc         4 (2 r + 1); 2.5 (2 r + 1) where four side by side have rows equally long to a pixel
//    polygon      4 (2 r + 1), with three products per row instead of one
//    ring of R    1 + R times its outline
//    cat's eye    as a polygon, with a square root and two conversions per row
//    file         4 r^2, for each channel if it is coloured
// From radius 24 to 28 on (8 to 12 for files) sprites are drawn at half the resolution, where neighbours have similar
// radii: a quarter of the sources and half the rows of each, an eighth in all (a sixteenth for files). An alpha that is
// not 1 doubles the cost, chromatic aberration triples it. Sources far away from a cell are checked but not drawn.
#include <float.h>
#include <math.h>
#include <string.h>

#include "pass/cells.h"
#include "pass/check.h"
#include "pixel/limits.h"
#include "pixel/edges.h"
#include "pixel/pass_c.h"
#include "engine/scatter/behind.h"
#include "engine/scatter/kernels.h"

#define B(name) (1u << HF_BUF_##name)
#define SOURCES (B(SOURCE) | B(RADIUS) | B(BACK) | B(BACK_AT) | B(HIDDEN) | B(HIDDEN_AT))

enum {
    HALO_RADIUS = 1,  // the largest CoC radius
    HALO_BEHIND,      // what is visible around near pixels
};

enum { COC, PREPARE, FAR, NEAR, COMPOSITE, PASSES };

static const struct hf_pass passes[PASSES] = {
    {"CoC generation", .sweep = 1, .ns = 2.5f},
    {"Prepare", .writes = SOURCES, .sweep = 1, .ns = 20},
    {"Far splats", .around = SOURCES, .writes = B(FAR_SUM) | B(FAR_WEIGHT), .halo = HALO_RADIUS, .sweep = 2,
     .field = HF_FAR, .ns = 106, .ns_radius = 3.1f},
    {"Near splats", .around = SOURCES, .writes = B(NEAR_SUM) | B(NEAR_WEIGHT), .halo = HALO_RADIUS, .sweep = 2,
     .field = HF_NEAR, .ns = 106, .ns_radius = 3.1f},
    {"Composite", .reads = B(FAR_SUM) | B(FAR_WEIGHT) | B(NEAR_SUM) | B(NEAR_WEIGHT), .around = SOURCES,
     .halo = HALO_BEHIND, .sweep = 2, .ns = 39, .ns_radius = 1.15f},
};

static const struct hf_buf_def bufs[HF_SCATTER_BUFS] = {
    [HF_BUF_SOURCE] = {"source", .frame = 1, .bare = 1, .x = 1, .y = 1},
    [HF_BUF_RADIUS] = {"radius", .frame = 1, .bare = 1, .x = 1, .y = 1},
    [HF_BUF_BACK] = {"back", .frame = 1, .bare = 1, .x = 1, .y = 1},
    [HF_BUF_BACK_AT] = {"backat", .frame = 1, .bare = 1, .x = 1, .y = 1},
    [HF_BUF_HIDDEN] = {"hidden", .frame = 1, .bare = 1, .x = 1, .y = 1},
    [HF_BUF_HIDDEN_AT] = {"hiddenat", .frame = 1, .bare = 1, .x = 1, .y = 1},
    [HF_BUF_FAR_SUM] = {"far", .x = 1, .y = 1, .field = HF_FAR},
    [HF_BUF_FAR_WEIGHT] = {"farweight", .x = 1, .y = 1, .field = HF_FAR},
    [HF_BUF_NEAR_SUM] = {"near", .x = 1, .y = 1, .field = HF_NEAR},
    [HF_BUF_NEAR_WEIGHT] = {"nearweight", .x = 1, .y = 1, .field = HF_NEAR},
};

// Until the whole frame is loaded, alpha may be anything, so it has a group of its own.
static void set_groups(struct hf_scatter *t, const struct hf_setup *s, float chromatic)
{
    t->groups = 0;
    for (int c = 0; c < s->channels; c++) {
        // Behind the focus red sprites are larger and blue ones smaller; in front of it the other way round.
        const float shift = c == 0 ? chromatic : c == 2 ? -chromatic : 0;
        struct hf_splat_group *g = &t->group[t->groups];
        if (c == 0 || c == 3 || chromatic != 0 || t->aperture.planes == 3) {
            *g = (struct hf_splat_group){.factor = {1 - shift, 1 + shift}};
            t->groups++;
        } else {
            g--;
        }
        g->channel[g->channels++] = c;
        t->group_of[c] = t->groups - 1;
    }
}

static int check(struct hf_settings *r, const struct hf_params *asked, const struct hf_depth *depth,
                 struct hf_message *message)
{
    struct hf_params *p = &r->params;
    (void)asked;
    (void)depth;
    if (p->aperture.picture && p->max_radius > hf_most_picture_radius(p)) {
        p->max_radius = hf_most_picture_radius(p);
        r->limit = HF_LIMIT_PICTURE;
    }
    return hf_check_resolution("scatter", p->scatter.resolution, HF_RESOLUTION_HALF, message);
}

static void resolve(void *own, struct hf_setup *s, const struct hf_depth *depth, const struct hf_params *p)
{
    struct hf_scatter *t = own;
    (void)depth;
    (void)p;
    t->ready = t->around_x = t->around_y = t->mixed = 0;
    t->given = NULL;
    s->sharp_radius = 0.5f;
}

static void know(void *own, const struct hf_known *known)
{
    struct hf_scatter *t = own;
    t->given = known;
}

static int build(struct hf_aperture *to, const struct hf_aperture_key *key, const struct hf_image *picture,
                 const struct hf_setup *s, const struct hf_mem *mem)
{
    return picture ? hf_aperture_build_image(to, key, picture, mem, s->stop) : hf_aperture_build(to, key, mem, s->stop);
}

static int prepare(void *own, const struct hf_setup *s, const struct hf_params *p, const struct hf_mem *mem)
{
    struct hf_scatter *t = own;
    struct hf_aperture *aperture = &t->aperture;
    const struct hf_aperture_params *a = &p->aperture;
    *t = (struct hf_scatter){
        .given = t->given, .aperture = *aperture, .turned = t->turned, .half_from = 24, .half_to = 28, .fade = 1.5f};
    if (p->scatter.resolution == HF_RESOLUTION_HALF) {
        t->half_from = -1;
        t->half_to = 0;
        t->fade = 2.5f;
    }
    // Drawing a file costs every pixel of the image, so it drops to half the resolution earlier.
    if (a->picture && t->half_to > 0)
        t->half_from = 8, t->half_to = 12;
    t->half_slope = 1 / (t->half_to - t->half_from);
    t->fade_slope = 1 / (t->fade - 0.5f);
    struct hf_aperture_key key;
    memset(&key, 0, sizeof key);
    const float largest = s->max_radius * (1 + fabsf(p->aperture.chromatic));
    key.largest = t->half_to > 0 && largest <= t->half_to ? largest : fmaxf(largest / 2, 1.5f * t->half_to);
    key.blades = a->blades;
    key.outline = a->cat_eye > 0;
    if (a->blades) {
        key.rotation = a->rotation;
        key.roundness = a->roundness;
    }
    t->ring = a->picture ? 0 : a->ring;
    t->cat_eye = a->picture ? 0 : a->cat_eye;
    // Sprites that may leave their own pixels out.
    const float hollow = a->picture ? 1 : fminf(4 * (t->ring + t->cat_eye), 1);
    t->trust = hollow > 0 ? 4 / hollow : INFINITY;
    t->corner = 1 / hypotf((float)s->width, (float)s->height);
    key.scale_x = 1 / (s->pixel_aspect * a->squeeze);
    int err = build(aperture, &key, a->picture, s, mem);
    // In front of the focus the rays have not crossed yet. An even number of sides does not show it.
    t->turns = a->picture || a->blades % 2;
    key.rotation += 180;
    if (!err && t->turns)
        err = build(&t->turned, &key, a->picture, s, mem);
    t->ready = !err;
    set_groups(t, s, p->aperture.chromatic);
    return err;
}

static void release(void *own, const struct hf_mem *mem)
{
    struct hf_scatter *t = own;
    hf_block_free(&t->aperture.block, mem);
    hf_block_free(&t->turned.block, mem);
}

static size_t held(const void *own)
{
    const struct hf_scatter *t = own;
    return t->aperture.block.size + t->turned.block.size;
}

// How far the largest sprites of a field reach at each level.
static void set_reach(struct hf_scatter *t, int field)
{
    for (int level = 0; level < 2; level++)
        t->reach_x[field][level] = t->reach_y[field][level] = -1;
    if (t->largest[field] <= 0)
        return;
    for (int level = 0; level < 2; level++) {
        float r = level ? t->largest[field] / 2 : fminf(t->largest[field], t->half_to);
        if (level ? t->largest[field] <= t->half_from : t->half_to <= 0)
            continue;
        float factor = 0;
        for (int g = 0; g < t->groups; g++)
            factor = fmaxf(factor, t->group[g].factor[field]);
        const struct hf_aperture *a = hf_scatter_aperture(t, field);
        const struct hf_picture *p = &a->picture[hf_picture_number(r * factor) / a->steps + 1];
        t->reach_x[field][level] = p->reach_x;
        t->reach_y[field][level] = p->reach_y;
    }
}

static int measure(void *own, struct hf_setup *s, const struct hf_counts *found, const struct hf_mem *mem)
{
    struct hf_scatter *t = own;
    (void)s;
    (void)mem;
    t->largest[0] = fmaxf(-found->radius_min, 0);
    t->largest[1] = fmaxf(found->radius_max, 0);
    if (t->given)
        t->largest[1] = fmaxf(t->largest[1], t->given->radius_max);
    t->mixed = found->radius_max - found->radius_min > HF_EDGES_FROM;
    t->behind = hf_behind_levels(t->largest[0]);
    t->slices = hf_scatter_slice_count(t->largest[1]);
    t->around_x = t->around_y = 0;
    for (int field = 0; field < 2; field++) {
        set_reach(t, field);
        // A mixed pixel draws what stands beside it. At half resolution: the level's own pixels, one more for upsampling, one for
        // the tent and one for its radii.
        const int beside = t->mixed, half = 3 + beside, full = 1 + beside;
        t->around_x = hf_max(t->around_x, hf_max((t->reach_x[field][0] + full) / 2, t->reach_x[field][1] + half));
        t->around_y = hf_max(t->around_y, hf_max((t->reach_y[field][0] + full) / 2, t->reach_y[field][1] + half));
    }
    return HF_OK;
}

// How many exponents below the brightest sample a drawn share can be. A share is at least 2^-25 of its pixel at radius
// 0.5; the back's share can be 2^-20, a tent's corner 2^-6, and the part that belongs to means 2^-HF_ALIKE_LOG2; where
// a mean's shares nearly cancel, 2^-24 of the least remains.
enum { FADE = 25 + 20 + 6 + HF_ALIKE_LOG2 + 24, LEAST_EXPONENT = -149 };

// How many exponents a bin takes so that the shares of its samples are whole numbers: all bits of its units, less those
// of a share and of the largest sprite's area. Larger sprites lose the darkest samples of a bin.
static int bin_bits(const struct hf_scatter *t, int level, int room)
{
    enum { SHARE = 22 };
    float area = 1;
    for (int field = 0; field < 2; field++) {
        const struct hf_aperture *a = hf_scatter_aperture(t, field);
        const float r = level ? t->largest[field] / 2 : fminf(t->largest[field], fmaxf(t->half_to, 0));
        for (int g = 0; g < t->groups && r > 0; g++) {
            const int number = hf_picture_number(r * t->group[g].factor[field]) / a->steps + 1;
            for (int plane = 0; plane < a->planes; plane++)
                area = fmaxf(area, a->picture[plane * a->count + number].area);
        }
    }
    return hf_max(room - SHARE + 1 - (int)ceil(log2((double)area)), HF_BIN_BITS);
}

// The fixed point of a level's bins.
struct bin_units {
    int room;   // bits between the unit and the brightest sample of the first bin
    int spill;  // fewer of the others
    int bits;   // exponents that the others take
    int dim;
};

// The exponents of the first bin. Bins end with the darkest sample, so what is left over is the first bin's: bright
// samples are few, so few sources belong to two bins.
static int first_bits(uint32_t exponents, int top, const struct bin_units *u)
{
    const int range = exponents ? top - (8 * __builtin_ctz(exponents) - 127) : 0;
    return range > u->bits + u->spill ? (range - 1) % u->bits + 1 : u->bits + u->spill;
}

// Make bins from the brightest exponent downwards. top: samples are below 2^top. An alpha of 1 uses the units of
// weights, so where it is 1 everywhere its sum equals theirs.
static void set_bins(struct hf_bins *bins, uint32_t exponents, int top, const struct bin_units *u, int alpha)
{
    int own = alpha ? u->bits : first_bits(exponents, top, u);
    int faded = top;  // shares of the samples seen so far can be as small as this
    for (bins->count = 0; bins->count < HF_BINS && (exponents || top > faded || !bins->count); bins->count++) {
        const int b = bins->count, bottom = alpha && top > 1 ? hf_max(top - own, 1) : top - own;
        for (int c = 0; c < 4; c++) {
            const int room = u->room - (c == 3 || alpha || b ? u->spill : 0);
            const int unit = c == 3 ? room - 1 : room - top - u->dim;
            bins->scale[b][c] = ldexp(1, unit);
            bins->unscale[b][c] = ldexp(1, -unit);
        }
        // Bit k stands for the exponents 8 k - 127 to 8 k - 120, the last bit for those up to 127, which are not split.
        int next = 0, k = 0;
        for (; exponents && !next; exponents &= next ? ~0u : ~(1u << k)) {
            k = 31 - __builtin_clz(exponents);
            next = 8 * k - 127 < bottom && k < 30;
            if (8 * k - 119 > bottom)
                faded = hf_max(8 * k - 127 - FADE, LEAST_EXPONENT);
        }
        // Leave out whole bins where no sample lies, and no share of one either.
        const int unused = exponents && bottom <= faded ? hf_max(bottom - (8 * k - 119), 0) : 0;
        top = bottom - (alpha ? unused : unused / u->bits * u->bits);
        bins->least[b] = ldexpf(1, top + u->dim);
        own = u->bits;
    }
    bins->least[bins->count - 1] = 0;
}

// Choose the sums' fixed point, so that shares of the brightest sample leave room for all that can meet in one pixel.
static void made(void *own, const struct hf_setup *s, const struct hf_counts *found)
{
    struct hf_scatter *t = own;
    // Sums are at most 2^14 times the largest sample. Known surfaces can double them.
    const int ring = t->ring <= 0 ? 0 : t->aperture.symmetric ? 6 : 4;
    struct bin_units u = {.room = 63 - (t->aperture.headroom + ring + (t->cat_eye > 0 ? 2 : 0) + (t->given != NULL)),
                          .dim = fmaxf(found->largest[0], found->largest[1]) > 0x1p110f ? -14 : 0};
    t->dim = ldexpf(1, u.dim);
    t->undim = 1 / t->dim;
    t->most = t->dim * FLT_MAX;
    for (int level = 0; level < 2; level++)
        for (int alpha = 0; alpha < 2; alpha++) {
            int top;
            frexpf(found->largest[alpha], &top);
            // Faint parts of bright samples go to lower bins, where several from one pixel each have its largest value:
            // those of a mixed one's two sides, and at half resolution those of the pixels around.
            u.spill = level ? 3 : 1;
            u.bits = bin_bits(t, level, u.room - u.spill);
            set_bins(&t->bins[level][alpha], found->exponents[alpha], top, &u, alpha);
        }
    // With an alpha of 1 everywhere, its sum is that of the weights.
    t->opaque = s->channels == 4 && !found->transparent && t->groups == 2;
    if (t->opaque)
        t->groups = 1;
}

static int channels(const struct hf_setup *s, int b)
{
    const struct hf_scatter *t = hf_scatter(s);
    if (b == HF_BUF_RADIUS)
        return 1;
    if (b == HF_BUF_HIDDEN || b == HF_BUF_HIDDEN_AT)
        return !t->given ? 0 : b == HF_BUF_HIDDEN ? s->channels : 2;
    if (b == HF_BUF_BACK || b == HF_BUF_BACK_AT)
        return !t->mixed ? 0 : b == HF_BUF_BACK ? s->channels : 2;
    return b == HF_BUF_FAR_WEIGHT || b == HF_BUF_NEAR_WEIGHT ? (t->ready ? t->groups : 1) : s->channels;
}

static struct hf_reach halo(const struct hf_setup *s, int halo)
{
    const struct hf_scatter *t = hf_scatter(s);
    const int behind = hf_behind_halo(t->behind);
    return halo == HALO_RADIUS ? (struct hf_reach){t->around_x, t->around_y} : (struct hf_reach){behind, behind};
}

// The far field shows only in pixels that are blurred themselves, or mixed with such pixels: far ones, and near ones
// that it shines through.
static struct hf_reach spread(const struct hf_setup *s, const struct hf_cells *p, unsigned field)
{
    const struct hf_scatter *t = hf_scatter(s);
    (void)p;
    if (field == HF_FAR && t->largest[0] <= 0)
        return (struct hf_reach){t->mixed, t->mixed};
    return (struct hf_reach){t->around_x, t->around_y};
}

// Cells are large compared with the reach, because the surroundings of each cell are read again. They are narrow enough
// for the rows of sums in use, 32 bytes a pixel, to stay in the second-level cache.
static void cell(const struct hf_setup *s, int sweep, int *width, int *height)
{
    const struct hf_scatter *t = hf_scatter(s);
    const int enough = hf_min(12 * t->around_y, (s->half_height + 1) / 2);
    (void)sweep;
    *height = hf_max(*height, hf_min(enough, 512));
    for (int field = 0; t->ready && field < 2; field++) {
        const int column = 2 * 32 * (2 * hf_max(t->reach_y[field][0], 0) + 8);  // bytes per half-resolution column
        if (t->reach_x[field][1] < 0)
            *width = hf_min(*width, hf_max(hf_max(400000 / column, 4 * t->around_x) & ~15, 64));
    }
}

static size_t work(const struct hf_setup *s, const struct hf_cells *p)
{
    const struct hf_scatter *t = hf_scatter(s);
    if (!t->ready)
        return 0;
    const size_t splats = hf_splat_work(t, p->width[2], p->height[2]);
    const size_t behind = hf_behind_floats(t->behind, hf_scatter_behind_planes(s->channels));
    const size_t edges = t->mixed ? hf_edges_floats(p->width[1], s->channels) : 0;
    const size_t most = splats > behind ? splats : behind;
    return most > edges ? most : edges;
}

static int cost(const struct hf_setup *s, int numbers[HF_COST_NUMBERS], int *reach)
{
    const struct hf_scatter *t = hf_scatter(s);
    numbers[0] = t->half_to <= 0;
    *reach = hf_max(t->around_x, t->around_y);
    return 1;
}

HF_CHOOSE_KERNELS(hf_scatter_kernels)

void hf_scatter_kernels_c(struct hf_scatter_kernels *k)
{
    *k = (struct hf_scatter_kernels){
        .passes = {{hf_radius_pass, hf_scatter_prepare_c, hf_splat_far, hf_splat_near, hf_scatter_composite_c}},
        .splat = hf_splat_c,
        .splat_runs = hf_splat_runs_c,
        .splat_taps = hf_splat_taps_c,
        .source_weights = hf_source_weights_c,
        .source_pictures = hf_source_pictures_c,
        .list_row = hf_list_row_c,
        .settle = hf_settle_c,
        .quad_row = hf_quad_row_c,
        .site_row = hf_site_row_c,
        .tent_weights = hf_tent_weights_c,
        .tent = hf_tent_c,
        .mean_row = hf_mean_row_c,
        .slice_row = hf_slice_row_c,
        .slice_behind = hf_slice_behind_c,
        .note = hf_scatter_note_c,
        .blend = hf_scatter_blend_c,
        .seen_weights = hf_seen_weights_c,
        .behind_blend = hf_behind_blend_c,
    };
}

const struct hf_engine_def hf_scatter_engine = {
    .name = "scatter",
    .passes = passes,
    .pass_count = PASSES,
    .sweeps = 2,
    .bufs = bufs,
    .buf_count = HF_SCATTER_BUFS,
    .limits = {.aperture = HF_APERTURE_ALL, .check = check},
    .kernels = {sizeof(struct hf_scatter_kernels), hf_scatter_kernels_init},
    .own = {sizeof(struct hf_scatter), .resolve = resolve, .know = know, .prepare = prepare, .measure = measure,
            .made = made, .release = release, .held = held},
    .plan = {.channels = channels, .halo = halo, .spread = spread, .cell = cell, .work = work},
    .cost = {.numbers = cost},
};
