// SPDX-License-Identifier: BSD-3-Clause
// Whole frames through the public calls, on every instruction set. Deterministic frames must have the bits of the C
// code; others must be within a bound that follows from the number of operations.
// --quick: fewer frames. --brief: in addition only small frames, and on an emulated CPU no instruction set that would
// be emulated twice. With HF_LONG in the environment all frames run regardless.
//
//     whole_frame [--seed N] [--quick | --brief] [--isa NAME]
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "frame/context.h"
#include "harness.h"
#include "pixel/depth_rows.h"
#include "pixel/unorm.h"
#include "tools/common/report.h"

struct frame_case {
    const char *name;
    int half_width, half_height;
    float max_radius, strength, pixel_aspect;  // 0: random
};

// Cases for which random frames are too small. After them come as many random frames as time allows.
static const struct frame_case special[] = {
    {"the largest reach, little strength", 300, 20, 200, 0.25f, 1},
    {"the largest reach", 150, 24, 120, 1, 0.7f},
    {"several tiles", 160, 70, 0, 0, 0},
    {"1 x 1", 1, 1, 0, 0, 0},
    {"a column", 1, 40, 0, 0, 0},
    {"a row", 70, 1, 0, 0, 0},
};

enum { SPECIALS = sizeof special / sizeof *special, LARGE = 3 };  // the large ones come first

static int passed, failed;
static uint32_t hash = 2166136261u;  // of the C code's pictures: the same on every machine with the same libm

// The gaussian engine, with the other options as they are.
static void make_gaussian(struct world *w)
{
    struct hf_params *p = &w->params;
    p->engine = HF_ENGINE_GAUSSIAN;
    p->gaussian.faithful = p->chapter.faithful;
    p->aperture.blades = 0;
    p->gaussian.iterations = rng_int(&w->rng, 0, 6);
    p->gaussian.sigma = rng_one_in(&w->rng, 3) ? rng_float(&w->rng, 0.1f, 40) : HF_DERIVE;
    p->gaussian.resolution = (enum hf_resolution)rng_int(&w->rng, 0, 2);
    if (rng_one_in(&w->rng, 2)) {
        p->model = HF_MODEL_RANGE;
        p->range.distance = p->range.near_begin = p->range.far_end = HF_DERIVE;
        p->focus = rng_one_in(&w->rng, 2) ? HF_DERIVE : p->focus;
    }
}

static void make_hexagon(struct world *w)
{
    struct hf_params *p = &w->params;
    p->engine = HF_ENGINE_HEXAGON;
    p->aperture.blades = 0;
    p->hexagon.resolution = rng_one_in(&w->rng, 2) ? HF_RESOLUTION_HALF : HF_RESOLUTION_FULL;
    p->hexagon.uniform = rng_one_in(&w->rng, 8);
}

static void make_aperture(struct rng *r, struct hf_aperture_params *a)
{
    a->blades = rng_one_in(r, 3) ? rng_int(r, 3, 16) : 0;
    a->roundness = rng_one_in(r, 2) ? rng_float(r, 0, 1) : 0;
    a->ring = rng_one_in(r, 5) ? rng_float(r, 0, 0.95f) : 0;
    a->chromatic = rng_one_in(r, 5) ? rng_float(r, -0.5f, 0.5f) : 0;
    a->cat_eye = rng_one_in(r, 5) ? rng_float(r, 0, 1) : 0;
    a->squeeze = rng_one_in(r, 5) ? rng_float(r, 0.5f, 2) : 1;
}

// The scatter engine, with some of its options. Its frames always have the bits of the C code, with fused operations
// too.
static void make_scatter(struct world *w)
{
    struct hf_params *p = &w->params;
    struct rng *r = &w->rng;
    p->engine = HF_ENGINE_SCATTER;
    p->scatter.resolution = rng_one_in(r, 4) ? HF_RESOLUTION_HALF : HF_RESOLUTION_FULL;
    make_aperture(r, &p->aperture);
}

// The layers engine, with some of its options.
static void make_layers(struct world *w)
{
    struct hf_params *p = &w->params;
    p->engine = HF_ENGINE_LAYERS;
    p->layers.quality = (enum hf_layers_quality)rng_int(&w->rng, HF_LAYERS_DRAFT, HF_LAYERS_BEST);
    make_aperture(&w->rng, &p->aperture);
}

static void make_case(struct world *w, const struct frame_case *c)
{
    world_clear(w);
    do {
        make_setup(w, c->half_width, c->half_height);
        w->params.max_radius = c->max_radius ? c->max_radius : w->params.max_radius;
        w->params.range.strength = c->strength ? c->strength : w->params.range.strength;
        w->params.view.pixel_aspect = c->pixel_aspect ? c->pixel_aspect : w->params.view.pixel_aspect;
        const int keeps = w->colours != COLOURS_MIXED;  // with negative colours, luminance would cancel
        w->params.gather.karis &= keeps;
        w->params.chapter.karis &= keeps;
    } while (c->max_radius && (w->params.model == HF_MODEL_LENS || w->params.gather.per_pixel_kernel));
    if (rng_one_in(&w->rng, 4))
        make_gaussian(w);
    else if (rng_one_in(&w->rng, 3))
        make_hexagon(w);
    else if (rng_one_in(&w->rng, 3))
        make_scatter(w);
    else if (rng_one_in(&w->rng, 3))
        make_layers(w);
    else
        w->params.engine = rng_one_in(&w->rng, 2) ? HF_ENGINE_GATHER : HF_ENGINE_CHAPTER;
    const int in_place = rng_one_in(&w->rng, 4), bad = rng_one_in(&w->rng, 3);
    make_image(w, &w->src, SLOT_SRC, bad);
    if (in_place)
        w->dst = w->src;
    else
        make_image(w, &w->dst, SLOT_DST, 0);
    make_depth(w, bad);
}

static int is_exact(const struct world *w, const struct level *l)
{
    return l->exact || w->params.engine == HF_ENGINE_SCATTER;
}

// Make depth constant over blocks of a random size, so that some tiles have nothing to do. A tiny depth becomes 0: a
// quotient with it could be anything.
static void smooth_depth(struct world *w)
{
    const size_t bytes = hf_depth_bytes(w->depth.format);
    uint8_t *p = slot_start(w, ARENA_MADE, SLOT_DEPTH);
    p += (const uint8_t *)w->depth.data - p;
    const int size = 1 << rng_int(&w->rng, 0, 7);
    for (int y = 0; y < w->setup.height; y++)
        for (int x = 0; x < w->setup.width; x++) {
            float v = 0;
            memcpy(&v, p + y / size * size * w->depth.stride + (size_t)(x / size * size) * bytes, bytes);
            if (w->depth.format == HF_DEPTH_FORMAT_FLOAT32 && fabsf(v) < 1e-12f)
                v = 0;
            memcpy(p + y * w->depth.stride + (size_t)x * bytes, &v, bytes);
        }
}

static void use_kernels(struct hf_context *c, const struct kernels *k)
{
    for (int fused = 0; fused < 2; fused++) {
        c->kernels[fused] = k->pixel;
        memcpy(c->engine[HF_ENGINE_GATHER].kernels[fused], &k->gather, sizeof k->gather);
        memcpy(c->engine[HF_ENGINE_CHAPTER].kernels[fused], &k->chapter, sizeof k->chapter);
        memcpy(c->engine[HF_ENGINE_HEXAGON].kernels[fused], &k->hexagon, sizeof k->hexagon);
        memcpy(c->engine[HF_ENGINE_SCATTER].kernels[fused], &k->scatter, sizeof k->scatter);
        memcpy(c->engine[HF_ENGINE_GAUSSIAN].kernels[fused], &k->gaussian, sizeof k->gaussian);
        memcpy(c->engine[HF_ENGINE_LAYERS].kernels[fused], &k->layers, sizeof k->layers);
    }
}

static int render(struct world *w, const struct level *l, enum arena a, struct tool_report *stats)
{
    struct hf_config config = {.size = sizeof config, .isa = l->isa ? l->isa : HF_ISA_SCALAR, .threads = 2};
    config.tile_width = rng_one_in(&w->rng, 2) ? 0 : 16 * rng_int(&w->rng, 1, 4);
    config.tile_height = rng_one_in(&w->rng, 2) ? 0 : rng_int(&w->rng, 16, 40);
    struct hf_context *c;
    crash_step = l->name;
    int err = hf_open(&c, &config);
    if (err)
        return err;
    if (!l->isa)  // emulated: no caller could ask for it
        use_kernels(c, &l->k);
    world_reset(w, a);
    const struct hf_frame f = world_frame(w, &l->k, a);
    w->params.run.deterministic = l->exact;
    err = hf_render(c, f.dst, f.src, f.depth, &w->params);
    tool_report_get(c, stats);
    hf_close(&c);
    return err;
}

static double largest_sample(const struct world *w, int c)
{
    double most = 0;
    for (int y = 0; y < w->src.height; y++)
        for (int x = 0; x < w->src.width; x++) {
            const float v = hf_sample(&w->src, c, x, y);
            if (hf_is_finite(v))
                most = fmax(most, fabs((double)v));
        }
    return most;
}

// Roundings through all passes (bound.c derives each): downsample 25; the gather's sums of colour and of weight, and
// their quotient; a mean of nine 9; composite 68.
// Hexagon: each tap of a line rounds the sums of weights and of weighted colours; loading and dividing add 30. The
// divisor is at least a quarter, in each of two passes.
static double frame_roundings(const struct world *w)
{
    if (w->params.engine == HF_ENGINE_GAUSSIAN)
        return 0;  // no operation is ever fused
    if (w->params.engine == HF_ENGINE_HEXAGON)
        return 2 * 4 * (3 * 3 * (w->params.max_radius + 4) / fmin(w->params.view.pixel_aspect, 1) + 30);
    const float h = w->params.max_radius / 2;
    const double rx = ceilf(h / w->params.view.pixel_aspect), ry = ceilf(h);
    return 25 + 2 * (2 * rx + 2 * ry + 4 + 6) + 1 + 9 + 68;
}

// Where passes store small formats, or sums cancel in a divisor, no useful bound follows: only equality is tested.
// Layers sorts samples by depth, and a fused operation may change their order.
static int has_bound(const struct world *w)
{
    return w->params.engine != HF_ENGINE_LAYERS && w->params.gather.storage == HF_STORAGE_FLOAT &&
           !w->params.gather.per_pixel_kernel;
}

// The decoding sRGB curve is steepest at its upper end: 2.4 / 1.055.
static double unorm_step(const struct hf_image *m, int c)
{
    return (m->transfer == HF_TRANSFER_SRGB ? 2.4 / 1.055 : 1) / ((1 << hf_unorm(m->format)->bits[c]) - 1);
}

static double format_step(const struct world *w, int c, double v)
{
    if (hf_unorm(w->dst.format))
        return unorm_step(&w->dst, c);
    if (w->dst.format == HF_FORMAT_RGBA16F)
        return fmax(v * 0x1p-10, 0x1p-24);
    if (w->dst.format == HF_FORMAT_R11G11B10F)
        return c == 2 ? fmax(v * 0x1p-5, 0x1p-19) : fmax(v * 0x1p-6, 0x1p-20);
    return 0;
}

static int compare(const struct world *w, const struct level *l, char message[256])
{
    struct hf_image want = w->dst, got = w->dst;
    for (int i = 0; i < 4; i++) {
        want.data[i] = in_arena(ARENA_REFERENCE, w->dst.data[i]);
        got.data[i] = in_arena(ARENA_TEST, w->dst.data[i]);
    }
    for (int c = 0; c < hf_image_channels(&w->dst); c++) {
        const double bound = is_exact(w, l) ? 0 : frame_roundings(w) * FLT_EPSILON * largest_sample(w, c) + 0x1p-140;
        for (int y = 0; y < want.height && (is_exact(w, l) || has_bound(w)); y++)
            for (int x = 0; x < want.width; x++) {
                const float a = hf_sample(&want, c, x, y), b = hf_sample(&got, c, x, y);
                const double step = is_exact(w, l) ? 0 : format_step(w, c, fmax(fabs((double)a), fabs((double)b)));
                if (hf_bits(a) == hf_bits(b) || (!is_exact(w, l) && fabs((double)a - b) <= bound + step))
                    continue;
                snprintf(message, 256, "channel %d at (%d, %d): %a, the C %a, off by %g of %g", c, x, y, b, a,
                         fabs((double)a - b), bound + step);
                return 0;
            }
    }
    return 1;
}

static void add_to_hash(const struct world *w)
{
    struct hf_image m = w->dst;
    for (int i = 0; i < 4; i++)
        m.data[i] = in_arena(ARENA_REFERENCE, w->dst.data[i]);
    for (int c = 0; c < hf_image_channels(&m); c++)
        for (int y = 0; y < m.height; y++)
            for (int x = 0; x < m.width; x++)
                hash = (hash ^ hf_bits(hf_sample(&m, c, x, y))) * 16777619u;
}

static int same_counts(const struct tool_report *a, const struct tool_report *b, const struct level *l)
{
    return a->all.near_pixels == b->all.near_pixels && a->all.sharp_pixels == b->all.sharp_pixels &&
           a->all.far_pixels == b->all.far_pixels && a->all.colour_repaired == b->all.colour_repaired &&
           a->all.depth_repaired == b->all.depth_repaired && a->all.no_surface == b->all.no_surface &&
           (!l->exact || a->all.clamped == b->all.clamped);
}

static void check(int ok, const struct world *w, const struct level *l, const char *name, uint64_t seed, int number,
                  const char *message)
{
    passed += ok;
    failed += !ok;
    if (ok)
        return;
    const struct hf_params *p = &w->params;
    printf("FAILED %s, frame %d of seed %llu (%s): %s\n", l->name, number, (unsigned long long)seed, name, message);
    printf("    %s, %d x %d, formats %d %d%s, storage %d, radius %g, strength %g, aspect %g, blades %d, fill %d, depth "
           "%d, "
           "model %d%s%s%s%s\n",
           hf_engine_name(p->engine), w->src.width, w->src.height, (int)w->src.format, (int)w->dst.format,
           w->src.data[0] == w->dst.data[0] ? " in place" : "", (int)p->gather.storage, p->max_radius,
           p->range.strength, p->view.pixel_aspect, p->aperture.blades, (int)p->chapter.fill, (int)w->depth.type,
           (int)p->model, p->gather.karis ? ", karis" : "", p->gather.per_pixel_kernel ? ", per-pixel" : "",
           p->gather.bicubic ? ", bicubic" : "", p->chapter.faithful ? ", faithful" : "");
}

static void run_frame(struct world *w, const struct level *levels, int level_count, uint64_t seed, int number)
{
    w->rng = rng_from(seed, (uint64_t)number);
    struct frame_case random = {.name = "random"};
    random.half_width = rng_int(&w->rng, 1, 70);
    random.half_height = rng_int(&w->rng, 1, 40);
    const struct frame_case *c = number < SPECIALS ? &special[number] : &random;
    struct tool_report want, got;
    make_case(w, c);
    smooth_depth(w);
    const int err = render(w, &levels[0], ARENA_REFERENCE, &want);
    check(!err, w, &levels[0], c->name, seed, number, hf_error_string(err));
    add_to_hash(w);
    for (int i = 1; i < level_count; i++) {
        char message[256] = "other statistics than the C";
        const int ok = render(w, &levels[i], ARENA_TEST, &got) == HF_OK && compare(w, &levels[i], message) &&
                       same_counts(&want, &got, &levels[i]);
        check(ok, w, &levels[i], c->name, seed, number, message);
    }
}

int main(int argc, char **argv)
{
    static struct level levels[MAX_LEVELS];
    static struct world w;
    const char *isa = NULL, *seed = getenv("HF_TEST_SEED");
    int frames = 150, first = 0, brief = 0;
    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--quick"))
            frames = 12;
        else if (!strcmp(argv[i], "--brief"))
            frames = 12, first = LARGE, brief = 1;
        else if (!strcmp(argv[i], "--seed") && i + 1 < argc)
            seed = argv[++i];
        else if (!strcmp(argv[i], "--isa") && i + 1 < argc)
            isa = argv[++i];
        else
            return fprintf(stderr, "usage: whole_frame [--seed N] [--quick | --brief] [--isa NAME]\n"), 2;
    }
    if (getenv("HF_LONG"))
        frames = 150, first = 0;
    crash_handlers();
    const int level_count = levels_make(levels, isa, !brief);
    if (isa && level_count == 1)
        return 77;
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    arenas_open();
    for (int i = first; i < SPECIALS + frames; i++)
        run_frame(&w, levels, level_count, seed ? strtoull(seed, NULL, 0) : 1, i);
    hf_gather_engine.own.release(&w.gather, &hf_mem_default);
    printf("hash of the C's pictures: %08x\n", hash);
    printf("%d passed, %d failed\n", passed, failed);
    return failed || !passed;
}
