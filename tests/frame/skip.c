// SPDX-License-Identifier: BSD-3-Clause
// Skipping is invisible: for every engine, with random options, sizes and scenes, a render with skipping equals one
// with no_skip, bit for bit. The skipping contexts are reused from scene to scene, as for a shot, so what they remember
// of the last frame is often wrong.
//
//     skip [seed [scenes]]
#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/render.h"
#include "tools/common/report.h"

enum { CONTEXTS = 4 };

static unsigned seed = 1, scenes;

// Half-resolution pixels; 0: the library's choice.
static const int tile_sizes[CONTEXTS][2] = {{0, 0}, {16, 16}, {48, 16}, {32, 40}};

// All sharp except a few pixels just inside and just outside the corners of tiles of 32 pixels and their multiples.
static struct scene corners(struct rng *rng, int w, int h, int channels)
{
    struct scene s = scene_new(rng, SCENE_SHARP, w, h, channels);
    for (int n = 1 + rng_below(rng, 3); n > 0; n--) {
        const int x = 32 * rng_below(rng, w / 32 + 1) - rng_below(rng, 3) + 1;
        const int y = 32 * rng_below(rng, h / 32 + 1) - rng_below(rng, 3) + 1;
        if (x < 0 || y < 0 || x >= w || y >= h)
            continue;
        const int i = y * w + x;
        // Full blur, almost none, and so little that the smallest storage rounds it to 0.
        static const float depths[] = {5, 12, 19.9999f, 19.5f, 40, 28, 20.0001f, 20.5f, 1e10f};
        s.depth.plane[0][i] = depths[rng_below(rng, 9)];
        for (int c = 0; c < channels; c++)
            s.colour.plane[c][i] = c == 3 ? 1 : rng_range(rng, 100, 2000);
    }
    return s;
}

static struct scene random_scene(struct rng *rng, enum hf_engine engine, const char **name)
{
    const int large = rng_below(rng, 6) == 0;
    const int w = 1 + rng_below(rng, large ? 330 : 120), h = 1 + rng_below(rng, large ? 230 : 90);
    const int channels = 3 + rng_below(rng, 2), kind = rng_below(rng, SCENE_KINDS + 4);
    struct scene s;
    if (kind >= SCENE_KINDS) {
        *name = "corners";
        s = corners(rng, w, h, channels);
    } else {
        *name = scene_name((enum scene_kind)kind);
        s = scene_new(rng, (enum scene_kind)kind, w, h, channels);
        if (rng_below(rng, 2))  // only part of it
            for (int i = 0; i < w * h; i++)
                if (i % w >= w / 3 || i / w >= h / 2)
                    s.depth.plane[0][i] = 20;
    }
    // Values that blending with a weight of 0 would change. Not all engines can sum values that overflow.
    const float odd[] = {
        -0.0f,
        -1e-3f,
        1e-42f,
        engine == HF_ENGINE_GATHER || engine == HF_ENGINE_CHAPTER || engine == HF_ENGINE_HEXAGON ? FLT_MAX : 1e30f,
        NAN,
        INFINITY};
    for (int k = 0; k < w * h / 30; k++)
        s.colour.plane[rng_below(rng, 3)][rng_below(rng, w * h)] = odd[rng_below(rng, rng_below(rng, 8) ? 3 : 6)];
    return s;
}

static struct hf_params random_params(struct rng *rng, enum hf_engine engine)
{
    static const float radii[] = {1, 3, 4, 8, 12, 12, 17.5f, 40};
    static const float strengths[] = {1, 1, 1, 0.7f, 0.3f, 0.1f};
    struct hf_params p = scene_params();
    p.engine = engine;
    p.max_radius = radii[rng_below(rng, 8)];
    p.range.strength = strengths[rng_below(rng, 6)];
    p.range.blend = (enum hf_blend)rng_below(rng, 2);
    p.view.pixel_aspect = rng_below(rng, 4) ? 1 : rng_range(rng, 0.6f, 2);
    p.range.distance = rng_below(rng, 5) ? 10 : rng_range(rng, 0, 30);
    p.aperture.rotation = (float)rng_below(rng, 90);
    p.run.deterministic = rng_below(rng, 2);
    p.highlight.gain = rng_below(rng, 3) ? 1 : rng_range(rng, 1, 20);
    p.highlight.threshold = rng_range(rng, 0, 0.99f);
    if (engine == HF_ENGINE_GATHER || engine == HF_ENGINE_CHAPTER) {
        p.chapter.faithful = rng_below(rng, 3) == 0;
        p.gather.karis = p.chapter.karis = rng_below(rng, 3) == 0;
        p.gather.per_pixel_kernel = p.chapter.per_pixel_kernel = rng_below(rng, 3) == 0;
        p.gather.bicubic = p.chapter.bicubic = rng_below(rng, 3) == 0;
        p.chapter.fill = (enum hf_fill)rng_below(rng, 4);
        p.gather.storage = p.chapter.storage = (enum hf_storage)(rng_below(rng, 5) % 3);
        p.aperture.blades = rng_below(rng, 3) ? 0 : 5 + rng_below(rng, 5);
        p.chapter.rings = rng_below(rng, 3) ? HF_DERIVE : 1 + rng_below(rng, 4);
        return p;
    }
    p.hexagon.resolution = p.scatter.resolution = p.gaussian.resolution =
        (enum hf_resolution)rng_below(rng, engine == HF_ENGINE_GAUSSIAN ? 3 : 2);
    p.hexagon.uniform = engine == HF_ENGINE_HEXAGON && rng_below(rng, 6) == 0;
    if (engine == HF_ENGINE_SCATTER || engine == HF_ENGINE_LAYERS) {
        p.aperture.blades = rng_below(rng, 3) ? 0 : 3 + rng_below(rng, 7);
        p.aperture.roundness = rng_below(rng, 2) ? 0 : rng_float(rng);
        p.aperture.ring = rng_below(rng, 4) ? 0 : 0.5f;
        p.aperture.chromatic = rng_below(rng, 4) ? 0 : rng_range(rng, -0.3f, 0.3f);
        p.aperture.cat_eye = rng_below(rng, 4) ? 0 : rng_float(rng);
        p.aperture.squeeze = rng_below(rng, 4) ? 1 : rng_range(rng, 0.5f, 2);
    }
    if (engine == HF_ENGINE_LAYERS)
        p.layers.quality = (enum hf_layers_quality)rng_below(rng, 4);
    if (engine == HF_ENGINE_GAUSSIAN) {
        p.gaussian.faithful = rng_below(rng, 4) == 0;
        p.gaussian.iterations = rng_below(rng, 6);
        p.gaussian.sigma = rng_below(rng, 3) ? HF_DERIVE : rng_range(rng, 0.3f, 9);
        p.range.distance = rng_below(rng, 3) ? p.range.distance : HF_DERIVE;
        p.focus = rng_below(rng, 3) ? p.focus : HF_DERIVE;
    }
    return p;
}

struct tally {
    uint64_t run, all;  // tiles that were not sharp, of how many
};

static void check_scene(struct hf_context *skipping, struct hf_context *whole, enum hf_engine engine, unsigned n,
                        struct tally *tally)
{
    struct rng rng = rng_seed(seed + 1000 * (unsigned)engine + n);
    const char *name;
    struct scene s = random_scene(&rng, engine, &name);
    struct hf_params p = random_params(&rng, engine);
    struct picture a = picture_copy(&s.colour), b = picture_copy(&s.colour);
    struct tool_report report;
    const struct hf_depth depth = picture_depth(&s.depth);
    CHECK_INT(try_render(skipping, &a, n % 3 ? &s.colour : &a, &depth, &p), HF_OK);
    tool_report_get(skipping, &report);
    tally->all += (uint64_t)report.inner.columns * (uint64_t)report.inner.rows;
    tally->run += (uint64_t)report.inner.columns * (uint64_t)report.inner.rows - report.inner.tile_count[HF_TILE_SHARP];
    p.run.no_skip = 1;
    CHECK_INT(try_render(whole, &b, &s.colour, &depth, &p), HF_OK);
    struct tool_report all;
    tool_report_get(whole, &all);
    CHECK_MSG(report.all.near_pixels == all.all.near_pixels && report.all.far_pixels == all.all.far_pixels &&
                  report.all.sharp_pixels == all.all.sharp_pixels &&
                  report.all.depth_repaired == all.all.depth_repaired && report.all.no_surface == all.all.no_surface &&
                  report.all.colour_repaired == all.all.colour_repaired,
              "%s: seed %u, scene %u (%s, %d x %d): skipping counts otherwise", hf_engine_name(engine), seed, n, name,
              a.width, a.height);
    CHECK_MSG(
        picture_same_bits(&a, &b), "%s, %s: seed %u, scene %u (%s, %d x %d, %d channels): skipping gives other bits",
        hf_isa_name(hf_context_isa(skipping)), hf_engine_name(engine), seed, n, name, a.width, a.height, a.channels);
    picture_free(&a);
    picture_free(&b);
    scene_free(&s);
}

static void check_engine(enum hf_isa isa, enum hf_engine engine)
{
    struct hf_context *skipping[CONTEXTS], *whole = context_new(isa, 2, 0, 0);
    struct tally tally = {0, 0};
    for (int i = 0; i < CONTEXTS; i++)
        skipping[i] = context_new(isa, 2, tile_sizes[i][0], tile_sizes[i][1]);
    for (unsigned n = 0; n < scenes; n++)
        check_scene(skipping[n % CONTEXTS], whole, engine, n, &tally);
    printf("%s, %s: %.0f %% of the tiles were not sharp\n", hf_isa_name(isa), hf_engine_name(engine),
           100.0 * (double)tally.run / (double)tally.all);
    CHECK(tally.run < tally.all);
    for (int i = 0; i < CONTEXTS; i++)
        hf_close(&skipping[i]);
    hf_close(&whole);
}

int main(int argc, char **argv)
{
    seed = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 1;
    scenes = argc > 2 ? (unsigned)strtoul(argv[2], NULL, 10) : check_long() ? 300 : 150;
    printf("seed %u\n", seed);
    for (int isa = HF_ISA_SCALAR; isa <= HF_ISA_NEON; isa++)
        for (int engine = 0; engine < tool_engines(); engine++)
            if (hf_isa_available((enum hf_isa)isa) && hf_engine_name((enum hf_engine)engine))
                check_engine((enum hf_isa)isa, (enum hf_engine)engine);
    return check_report();
}
