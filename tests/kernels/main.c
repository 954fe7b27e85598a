// SPDX-License-Identifier: BSD-3-Clause
// Tests every kernel of every instruction set against the C, and times them. --quick: a sixth of the cases. --brief: a
// quarter of these, without kernels that an emulated CPU would emulate twice. With HF_LONG in the environment all cases
// run anyway.
//
//     kernels [--seed N] [--quick | --brief] [--isa NAME] [--kernel NAME] [--case N] [--list] [--bench [NAME]]
#include <stdio.h>
#include <stdlib.h>

#include "harness.h"

#define ROW(name, index, cases, make, call, check)                                                                     \
    {                                                                                                                  \
        name, index, cases, make, call, check, row_pixels                                                              \
    }
#define PASS(name, index, cases)                                                                                       \
    {                                                                                                                  \
        name, index, cases, pass_make, pass_call, pass_check, pass_pixels                                              \
    }
#define HEXAGON(name, index, cases)                                                                                    \
    {                                                                                                                  \
        name, index, cases, hexagon_make, hexagon_call, pass_check, pass_pixels                                        \
    }

const struct test tests[] = {
    PASS("coc", HF_PASS_COC, 1200),
    PASS("max_x", HF_PASS_MAX_X, 960),
    PASS("max_y", HF_PASS_MAX_Y, 960),
    PASS("blur_x", HF_PASS_BLUR_X, 960),
    PASS("blur_y", HF_PASS_BLUR_Y, 960),
    PASS("gather_down", HF_PASS_DOWN, 1200),
    PASS("gather_computation", HF_PASS_COMPUTATION, 1000),
    PASS("gather_composite", HF_GATHER_COMPOSITE, 1400),
    PASS("chapter_down", CHAPTER_PASS + HF_PASS_DOWN, 1200),
    PASS("chapter_computation", CHAPTER_PASS + HF_PASS_COMPUTATION, 1000),
    PASS("chapter_fill", CHAPTER_PASS + HF_CHAPTER_FILL, 1600),
    PASS("chapter_composite", CHAPTER_PASS + HF_CHAPTER_COMPOSITE, 1400),
    ROW("coc_row", 0, 2000, coc_row_make, coc_row_call, row_check),
    ROW("sharp_row", 0, 2000, sharp_row_make, sharp_row_call, row_check),
    ROW("load_rgba32f", HF_FORMAT_RGBA32F, 1000, load_make, load_call, load_check),
    ROW("load_rgb32f", HF_FORMAT_RGB32F, 1000, load_make, load_call, load_check),
    ROW("load_rgba16f", HF_FORMAT_RGBA16F, 1000, load_make, load_call, load_check),
    ROW("load_r11g11b10f", HF_FORMAT_R11G11B10F, 1000, load_make, load_call, load_check),
    ROW("load_planar32f", HF_FORMAT_PLANAR32F, 1000, load_make, load_call, load_check),
    ROW("load_rgba8", HF_FORMAT_RGBA8, 1000, load_make, load_call, load_check),
    ROW("load_bgra8", HF_FORMAT_BGRA8, 1000, load_make, load_call, load_check),
    ROW("load_rgbx8", HF_FORMAT_RGBX8, 1000, load_make, load_call, load_check),
    ROW("load_bgrx8", HF_FORMAT_BGRX8, 1000, load_make, load_call, load_check),
    ROW("load_rgb10a2", HF_FORMAT_RGB10A2, 1000, load_make, load_call, load_check),
    ROW("load_rgba16", HF_FORMAT_RGBA16, 1000, load_make, load_call, load_check),
    ROW("store_rgba32f", HF_FORMAT_RGBA32F, 1000, store_make, store_call, row_check),
    ROW("store_rgb32f", HF_FORMAT_RGB32F, 1000, store_make, store_call, row_check),
    ROW("store_rgba16f", HF_FORMAT_RGBA16F, 1000, store_make, store_call, row_check),
    ROW("store_r11g11b10f", HF_FORMAT_R11G11B10F, 1000, store_make, store_call, row_check),
    ROW("store_planar32f", HF_FORMAT_PLANAR32F, 1000, store_make, store_call, row_check),
    ROW("store_rgba8", HF_FORMAT_RGBA8, 1000, store_make, store_call, row_check),
    ROW("store_bgra8", HF_FORMAT_BGRA8, 1000, store_make, store_call, row_check),
    ROW("store_rgbx8", HF_FORMAT_RGBX8, 1000, store_make, store_call, row_check),
    ROW("store_bgrx8", HF_FORMAT_BGRX8, 1000, store_make, store_call, row_check),
    ROW("store_rgb10a2", HF_FORMAT_RGB10A2, 1000, store_make, store_call, row_check),
    ROW("store_rgba16", HF_FORMAT_RGBA16, 1000, store_make, store_call, row_check),
    ROW("depth_float16", HF_DEPTH_FORMAT_FLOAT16, 600, widen_make, widen_call, row_check),
    ROW("depth_unorm16", HF_DEPTH_FORMAT_UNORM16, 600, widen_make, widen_call, row_check),
    ROW("depth_unorm32", HF_DEPTH_FORMAT_UNORM32, 600, widen_make, widen_call, row_check),
    ROW("depth_d24s8", HF_DEPTH_FORMAT_D24S8, 600, widen_make, widen_call, row_check),
    ROW("depth_x8d24", HF_DEPTH_FORMAT_X8D24, 600, widen_make, widen_call, row_check),
    ROW("finite_f32", 0, 2000, finite_make, finite_call, finite_check),
    ROW("finite_f16", 1, 2000, finite_make, finite_call, finite_check),
    ROW("finite_r11", 2, 2000, finite_make, finite_call, finite_check),
    ROW("finite_any", 3, 1000, finite_make, finite_call, finite_check),
    ROW("truncate_r11", 3, 1000, round_make, round_call, row_check),
    ROW("round_half", 1, 1000, round_make, round_call, row_check),
    ROW("highlight_raise", 0, 1000, highlight_make, highlight_call, row_check),
    ROW("highlight_lower", 1, 1000, highlight_make, highlight_call, row_check),
    ROW("radius_row", 0, 2000, radius_make, radius_call, row_check),
    ROW("zip", 1, 600, radius_make, radius_call, row_check),
    ROW("unzip", 2, 600, radius_make, radius_call, row_check),
    HEXAGON("hexagon_load", HEXAGON_LOAD, 1200),
    HEXAGON("hexagon_1", HEXAGON_FIRST, 900),
    HEXAGON("hexagon_2", HEXAGON_SECOND, 900),
    HEXAGON("hexagon_composite", HEXAGON_COMPOSITE, 1600),
    ROW("blend_row", 0, 2000, blend_row_make, blend_row_call, row_check),
    ROW("gaussian_count", 1, 2000, blend_row_make, count_row_call, row_check),
    ROW("lerp_row", 0, 600, lerp_row_make, lerp_row_call, row_check),
    ROW("gaussian_line", 0, 600, gaussian_make, gaussian_call, row_check),
    ROW("gaussian_line_faithful", 1, 600, gaussian_make, gaussian_call, row_check),
    ROW("gaussian_columns", 2, 600, gaussian_make, gaussian_call, row_check),
    ROW("gaussian_columns_faithful", 3, 600, gaussian_make, gaussian_call, row_check),
    ROW("gaussian_columns_in_place", 4, 600, gaussian_make, gaussian_call, row_check),
    ROW("gaussian_up_half", 5, 600, gaussian_make, gaussian_call, row_check),
    ROW("gaussian_up_quarter", 6, 600, gaussian_make, gaussian_call, row_check),
    ROW("wide_block", 0, 600, wide_make, wide_call, row_check),
    ROW("source_weights", SCATTER_WEIGHTS, 800, scatter_make, scatter_call, scatter_check),
    ROW("source_pictures", SCATTER_PICTURES, 800, scatter_make, scatter_call, scatter_check),
    ROW("list_row", SCATTER_LIST, 800, scatter_make, scatter_call, scatter_check),
    ROW("quad_row", SCATTER_QUAD, 800, scatter_make, scatter_call, scatter_check),
    ROW("site_row", SCATTER_SITE, 800, scatter_make, scatter_call, scatter_check),
    ROW("tent_weights", SCATTER_TENT_WEIGHTS, 800, scatter_make, scatter_call, scatter_check),
    ROW("tent", SCATTER_TENT, 800, scatter_make, scatter_call, scatter_check),
    ROW("mean_row", SCATTER_MEAN, 800, scatter_make, scatter_call, scatter_check),
    ROW("scatter_note", SCATTER_NOTE, 800, scatter_make, scatter_call, scatter_check),
    ROW("slice_row", SCATTER_SLICE_ROW, 800, scatter_make, scatter_call, scatter_check),
    ROW("slice_behind", SCATTER_SLICE_BEHIND, 800, scatter_make, scatter_call, scatter_check),
    ROW("splat_runs", SCATTER_RUNS, 800, scatter_make, scatter_call, scatter_check),
    ROW("splat_taps", SCATTER_TAPS, 800, scatter_make, scatter_call, scatter_check),
    ROW("splat", SCATTER_SPLAT, 800, scatter_make, scatter_call, scatter_check),
    ROW("settle", SCATTER_SETTLE, 800, scatter_make, scatter_call, scatter_check),
    ROW("scatter_blend", SCATTER_BLEND, 1600, scatter_make, scatter_call, scatter_check),
    ROW("near_row", SCATTER_NEAR, 800, scatter_make, scatter_call, scatter_check),
    ROW("most_row", SCATTER_MOST, 800, scatter_make, scatter_call, scatter_check),
    ROW("seen_weights", SCATTER_SEEN_WEIGHTS, 800, scatter_make, scatter_call, scatter_check),
    ROW("seen_row", SCATTER_SEEN, 800, scatter_make, scatter_call, scatter_check),
    ROW("third_row", SCATTER_THIRD, 800, scatter_make, scatter_call, scatter_check),
    ROW("part_row", SCATTER_PART, 800, scatter_make, scatter_call, scatter_check),
    ROW("add_part", SCATTER_ADD_PART, 800, scatter_make, scatter_call, scatter_check),
    ROW("up_row", SCATTER_UP, 800, scatter_make, scatter_call, scatter_check),
    ROW("behind_blend", SCATTER_BEHIND, 800, scatter_make, scatter_call, scatter_check),
    ROW("edges_sure", EDGES_SURE, 600, edges_make, edges_call, row_check),
    ROW("edges_take", EDGES_TAKE, 600, edges_make, edges_call, edges_check),
    ROW("layers_unmix", LAYERS_UNMIX, 600, layers_make, layers_call, layers_check),
    ROW("layers_roots", LAYERS_ROOTS, 600, layers_make, layers_call, layers_check),
    ROW("layers_nine", LAYERS_NINE, 600, layers_make, layers_call, layers_check),
    ROW("layers_shares", LAYERS_SHARES, 600, layers_make, layers_call, layers_check),
    ROW("layers_shares alpha", LAYERS_SHARES_ALPHA, 600, layers_make, layers_call, layers_check),
    ROW("layers_lamps", LAYERS_LAMPS, 600, layers_make, layers_call, layers_check),
    ROW("layers_lamps alpha", LAYERS_LAMPS_ALPHA, 600, layers_make, layers_call, layers_check),
    ROW("layers_quads", LAYERS_QUADS, 600, layers_make, layers_call, layers_check),
    ROW("layers_merge", LAYERS_MERGE, 600, layers_make, layers_call, layers_check),
    ROW("layers_taps", LAYERS_TAPS, 600, layers_make, layers_call, layers_check),
    ROW("layers_between", LAYERS_BETWEEN, 600, layers_make, layers_call, layers_check),
    ROW("layers_nearest", LAYERS_NEAREST, 600, layers_make, layers_call, layers_check),
    ROW("layers_spread", LAYERS_SPREAD, 600, layers_make, layers_call, layers_check),
    ROW("layers_found", LAYERS_FOUND, 600, layers_make, layers_call, layers_check),
    ROW("layers_smooth", LAYERS_SMOOTH, 600, layers_make, layers_call, layers_check),
    ROW("layers_alike", LAYERS_ALIKE, 600, layers_make, layers_call, layers_check),
    ROW("layers_extremes", LAYERS_EXTREMES, 600, layers_make, layers_call, layers_check),
    ROW("layers_inside", LAYERS_INSIDE, 600, layers_make, layers_call, layers_check),
    ROW("layers_weigh", LAYERS_WEIGH, 600, layers_make, layers_call, layers_check),
    ROW("layers_fold", LAYERS_FOLD, 600, layers_make, layers_call, layers_check),
    ROW("layers_disc", LAYERS_DISC, 600, layers_make, layers_call, layers_check),
    ROW("layers_pairs", LAYERS_PAIRS, 600, layers_make, layers_call, layers_check),
    ROW("layers_runs", LAYERS_RUNS, 600, layers_make, layers_call, layers_check),
    ROW("layers_weights", LAYERS_WEIGHTS, 600, layers_make, layers_call, layers_check),
    ROW("layers_stamp", LAYERS_STAMP, 600, layers_make, layers_call, layers_check),
    ROW("layers_light", LAYERS_LIGHT, 600, layers_make, layers_call, layers_check),
    ROW("layers_dim", LAYERS_DIM, 600, layers_make, layers_call, layers_check),
    ROW("layers_passed", LAYERS_PASSED, 600, layers_make, layers_call, layers_check),
    ROW("layers_up", LAYERS_UP, 600, layers_make, layers_call, layers_check),
    ROW("layers_blend", LAYERS_BLEND, 600, layers_make, layers_call, layers_check),
    ROW("layers_finish", LAYERS_FINISH, 600, layers_make, layers_call, layers_check),
    ROW("layers_views", LAYERS_VIEWS, 600, layers_make, layers_call, layers_check),
};
const int test_count = sizeof tests / sizeof *tests;

struct options {
    uint64_t seed;
    int share, brief, list, bench, only_case;  // share: one case out of that many
    const char *isa, *kernel;
};

// Run one kernel on one instruction set over all its cases. It ends with the first failure; without the C there is
// nothing to compare with.
struct outcome {
    int cases, failed;
};

static void report(const struct test *t, const struct level *l, uint64_t seed, int number, const char *message,
                   struct world *w)
{
    const struct hf_setup *s = &w->setup;
    const struct hf_fields *g = world_fields(w);
    printf("FAILED %s, %s, case %d of seed %llu: %s\n", t->name, l->name, number, (unsigned long long)seed, message);
    printf("    frame %d x %d, area %d..%d x %d..%d, channels %d, storage %d, radius %g, strength %g, blades %d, fill "
           "%d%s%s%s%s%s%s, formats %d %d, row %d lane %d + %d\n",
           s->width, s->height, w->r.x0, w->r.x1, w->r.y0, w->r.y1, s->channels, (int)s->storage, s->max_radius,
           w->params.range.strength, w->params.aperture.blades, (int)w->chapter.fill, g->karis ? ", karis" : "",
           g->per_pixel_kernel ? ", per-pixel" : "", g->bicubic ? ", bicubic" : "",
           w->resolved.params.chapter.faithful ? ", faithful" : "", w->near ? ", near" : "", w->far ? ", far" : "",
           (int)w->src.format, (int)w->dst.format, w->y, w->x, w->n);
}

static int run_level(struct world *w, const struct test *t, const struct level *l, char message[256])
{
    world_reset(w, ARENA_TEST);
    memset(&w->result[ARENA_TEST], 0, sizeof w->result[ARENA_TEST]);
    const int number = guarded(t->call, w, &l->k, ARENA_TEST, t->index);
    if (number) {
        snprintf(message, 256, "%s", crash_name(number));
        return 0;
    }
    return t->check(w, l, message);
}

static int run_reference(struct world *w, const struct test *t, const struct level *c, char message[256])
{
    world_reset(w, ARENA_REFERENCE);
    const int number = guarded(t->call, w, &c->k, ARENA_REFERENCE, t->index);
    if (number) {
        snprintf(message, 256, "%s", crash_name(number));
        return 0;
    }
    return reference_check(w, message);
}

// Run one case on every level.
static void run_case(struct world *w, const struct test *t, int number, const struct options *o,
                     const struct level *levels, int level_count, struct outcome *outcomes)
{
    char message[256];
    w->rng = rng_from(o->seed, (uint64_t)(t - tests) * 1000000 + (uint64_t)number);
    crash_step = t->name;
    t->make(w, t->index);
    for (int i = 0; i < level_count && !outcomes[0].failed; i++) {
        if (outcomes[i].failed)
            continue;
        outcomes[i].cases++;
        if (!(i ? run_level(w, t, &levels[i], message) : run_reference(w, t, &levels[0], message))) {
            outcomes[i].failed = 1;
            report(t, &levels[i], o->seed, number, message, w);
        }
    }
}

static int run_tests(struct world *w, const struct options *o, const struct level *levels, int level_count)
{
    int passed = 0, failed = 0;
    for (int i = 0; i < test_count; i++) {
        const struct test *t = &tests[i];
        if (o->kernel && strcmp(o->kernel, t->name))
            continue;
        struct outcome outcomes[MAX_LEVELS] = {0};
        const int cases = t->cases / o->share;
        for (int n = o->only_case < 0 ? 0 : o->only_case; n < (o->only_case < 0 ? cases : o->only_case + 1); n++)
            run_case(w, t, n, o, levels, level_count, outcomes);
        for (int l = 0; l < level_count; l++) {
            const int ok = !outcomes[l].failed && (outcomes[l].cases || outcomes[0].failed);
            passed += ok;
            failed += !ok;
        }
    }
    if (emulated_check()) {
        printf("FAILED emulation of AVX-512: %d operations differ from the instructions\n", emulated_check());
        failed++;
    }
    printf("%d passed, %d failed\n", passed, failed);
    return failed + !passed;
}

static void usage(void)
{
    fprintf(stderr, "usage: kernels [--seed N] [--quick | --brief] [--isa NAME] [--kernel NAME] [--case N] [--list] "
                    "[--bench [NAME]]\n");
    exit(2);
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.seed = 1, .share = 1, .only_case = -1};
    if (getenv("HF_TEST_SEED"))
        o.seed = strtoull(getenv("HF_TEST_SEED"), NULL, 0);
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (!strcmp(argv[i], "--quick"))
            o.share = 6;
        else if (!strcmp(argv[i], "--brief")) {
            o.share = 24;
            o.brief = 1;
        } else if (!strcmp(argv[i], "--list"))
            o.list = 1;
        else if (!strcmp(argv[i], "--bench")) {
            o.bench = 1;
            if (value && *value != '-')
                o.kernel = argv[++i];
        } else if (!value)
            usage();
        else if (!strcmp(argv[i], "--seed"))
            o.seed = strtoull(argv[++i], NULL, 0);
        else if (!strcmp(argv[i], "--isa"))
            o.isa = argv[++i];
        else if (!strcmp(argv[i], "--kernel"))
            o.kernel = argv[++i];
        else if (!strcmp(argv[i], "--case"))
            o.only_case = atoi(argv[++i]);
        else
            usage();
    }
    if (getenv("HF_LONG"))
        o.share = 1;
    return o;
}

int main(int argc, char **argv)
{
    struct options o = parse(argc, argv);
    static struct level levels[MAX_LEVELS];
    static struct world world;
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    crash_handlers();
    const int level_count = levels_make(levels, o.isa, !o.brief);
    if (o.isa && level_count == 1) {
        fprintf(stderr, "%s: not on this CPU or not in this build\n", o.isa);
        return 77;
    }
    if (o.list) {
        for (int i = 0; i < level_count; i++)
            printf("isa %s\n", levels[i].name);
        for (int i = 0; i < test_count; i++)
            printf("kernel %s\n", tests[i].name);
        return 0;
    }
    printf("seed %llu; instruction sets:", (unsigned long long)o.seed);
    for (int i = 0; i < level_count; i++)
        printf("%s %s", i ? "," : "", levels[i].name);
    putchar('\n');
    arenas_open();
    if (o.bench)
        o.share = 6;
    const int failed = run_tests(&world, &o, levels, level_count);
    if (!failed && o.bench)
        bench_run(&world, levels, level_count, o.kernel);
    hf_gather_engine.own.release(&world.gather, &hf_mem_default);
    hf_chapter_engine.own.release(&world.chapter, &hf_mem_default);
    hf_hexagon_engine.own.release(&world.hexagon, &hf_mem_default);
    return failed != 0;
}
