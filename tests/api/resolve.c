// SPDX-License-Identifier: BSD-3-Clause
// The public API, third part: names, resolved parameters, a prepared first frame, and what a child process may do.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/check.h"
#include "support/render.h"
#include "tools/common/report.h"

// Every value has its own name, and the names lead back to the values.
static void names(void)
{
    const int counts[] = {
        [HF_NAMES_ISA] = HF_ISA_NEON + 1,
        [HF_NAMES_LOG_LEVEL] = HF_LOG_INFO + 1,
        [HF_NAMES_FORMAT] = HF_FORMAT_RGBA16 + 1,
        [HF_NAMES_TRANSFER] = HF_TRANSFER_SRGB + 1,
        [HF_NAMES_DEPTH_FORMAT] = HF_DEPTH_FORMAT_X8D24 + 1,
        [HF_NAMES_DEPTH_TYPE] = HF_DEPTH_COC + 1,
        [HF_NAMES_ENGINE] = tool_engines(),
        [HF_NAMES_RESOLUTION] = HF_RESOLUTION_QUARTER + 1,
        [HF_NAMES_MODEL] = HF_MODEL_LENS + 1,
        [HF_NAMES_STORAGE] = HF_STORAGE_PACKED + 1,
        [HF_NAMES_FILL] = HF_FILL_OPEN + 1,
        [HF_NAMES_BLEND] = HF_BLEND_SMOOTHSTEP + 1,
        [HF_NAMES_LIMIT] = HF_LIMIT_PICTURE + 1,
        [HF_NAMES_QUALITY] = HF_QUALITY_BEST + 1,
        [HF_NAMES_DOWNSAMPLE] = HF_DOWNSAMPLE_POINT + 1,
        [HF_NAMES_DIVISION] = HF_DIVISION_NEWTON2 + 1,
        [HF_NAMES_LAYERS] = HF_LAYERS_BEST + 1,
    };
    enum { FAMILIES = sizeof counts / sizeof *counts };
    for (int of = 0; of < FAMILIES; of++) {
        for (int i = 0; i < counts[of]; i++) {
            const char *name = hf_name((enum hf_names)of, i);
            int value = -1;
            if (CHECK_MSG(name != NULL, "names %d: value %d has none", of, i))
                CHECK_INT(hf_value((enum hf_names)of, name, &value), HF_OK);
            CHECK_INT(value, i);
        }
        int value = 77;
        CHECK(!hf_name((enum hf_names)of, -1) && !hf_name((enum hf_names)of, counts[of]));
        CHECK_INT(hf_value((enum hf_names)of, "no such word", &value), HF_ERR_ARG);
        CHECK_INT(hf_value((enum hf_names)of, NULL, &value), HF_ERR_ARG);
        CHECK_INT(value, 77);
    }
    int storage = -1;
    CHECK(!hf_name((enum hf_names)FAMILIES, 0));
    CHECK_INT(hf_value(HF_NAMES_STORAGE, "chapter", &storage), HF_OK);
    CHECK_INT(storage, HF_STORAGE_PACKED);
    CHECK(strcmp(hf_name(HF_NAMES_STORAGE, HF_STORAGE_PACKED), "packed") == 0);
}

// What hf_resolve tells.
struct told {
    struct hf_params params;
    struct hf_resolved r;
};

static struct told resolved(int width, int height, const struct hf_depth *depth, const struct hf_params *p)
{
    struct told t = {.params = {.size = sizeof t.params}, .r = {.size = sizeof t.r}};
    struct hf_message message = {.size = sizeof message};
    CHECK_MSG(hf_resolve(width, height, depth, p, &t.params, &t.r, &message) == HF_OK, "%s", message.sentence);
    return t;
}

// Numbers computed by hand.
static void derived(void)
{
    const struct hf_depth depth = {.size = sizeof depth};
    struct hf_params p = hf_default_params();
    p.focus = 8;
    struct told r = resolved(1920, 1080, &depth, &p);
    CHECK(r.r.width == 1920 && r.r.height == 1080 && !r.r.sharp && r.r.lens_k == 0);
    CHECK(r.params.range.distance == 4 && r.params.range.near_begin == 4 && r.params.range.near_end == 8);
    CHECK(r.params.range.far_begin == 8 && r.params.range.far_end == 12);
    CHECK(r.params.max_radius == 12 && r.r.limit == HF_LIMIT_MODEL);
    p.engine = HF_ENGINE_CHAPTER;
    CHECK_INT(resolved(1920, 1080, &depth, &p).params.chapter.rings, 3);  // of two half-resolution pixels up to 6
    p.engine = HF_ENGINE_GATHER;
    CHECK(r.params.view.display_width == 1920 && r.params.view.display_height == 1080);
    p.view.display_height = 2160;
    CHECK(resolved(100, 100, &depth, &p).params.max_radius == 24);
    p.max_radius = 9;
    CHECK_INT(resolved(100, 100, &depth, &p).r.limit, HF_LIMIT_GIVEN);
    p.range.strength = 0;
    CHECK_INT(resolved(100, 100, &depth, &p).r.sharp, 1);
    p = hf_default_params();
    p.model = HF_MODEL_LENS;
    p.lens.f_number = 2;  // aperture radius 0.05 / (2 * 2) m; 50 / 36 * 1800 pixels
    r = resolved(1800, 1000, &depth, &p);
    CHECK(fabsf(r.r.focal_px - 2500) < 1e-3f && fabsf(r.r.lens_k - 31.25f) < 1e-4f);
    // The sensor is as wide as the picture for any shape of pixels; with low pixels a radius covers more of them.
    p.view.pixel_aspect = 2;
    CHECK(fabsf(resolved(1800, 1000, &depth, &p).r.lens_k - 62.5f) < 1e-4f);
    p.view.pixel_aspect = 1;
    p.engine = HF_ENGINE_SCATTER;
    r = resolved(1800, 1000, &depth, &p);
    CHECK(r.r.limit == HF_LIMIT_NONE && r.params.max_radius == 2048);
    const struct hf_image picture = {
        .size = sizeof picture, .width = 1, .height = 1, .format = HF_FORMAT_PLANAR32F, .data = {&p, &p, &p}};
    p.aperture.picture = &picture;
    r = resolved(1800, 1000, &depth, &p);
    CHECK(r.r.limit == HF_LIMIT_PICTURE && r.params.max_radius == 256);
    p = hf_default_params();
    p.engine = HF_ENGINE_GAUSSIAN;
    r = resolved(64, 64, &depth, &p);
    CHECK(r.params.gaussian.by_depth == 1 && fabsf(r.params.gaussian.sigma - sqrtf(3)) < 1e-6f);
    p.range.distance = 3;
    CHECK_INT(resolved(64, 64, &depth, &p).params.gaussian.by_depth, 0);
    p = hf_default_params();  // angles that sines and cosines are still exact for
    p.aperture.blades = 6;
    p.aperture.rotation = -725;
    CHECK(resolved(64, 64, &depth, &p).params.aperture.rotation == -5);
    p.aperture.rotation = 3e38f;
    CHECK(fabsf(resolved(64, 64, &depth, &p).params.aperture.rotation) < 360);
}

// HF_DERIVE is replaced everywhere, for any engine and model.
static void no_sentinels(void)
{
    for (int e = 0; e < tool_engines(); e++)
        for (int model = 0; model < 2; model++) {
            const struct hf_depth depth = {.size = sizeof depth};
            struct hf_params p = hf_default_params();
            p.engine = (enum hf_engine)e;
            p.model = (enum hf_model)model;
            const struct told r = resolved(640, 480, &depth, &p);
            const struct hf_params *q = &r.params;
            CHECK(q->max_radius > 0 && q->view.display_width == 640 && q->view.display_height == 480);
            CHECK(e != HF_ENGINE_CHAPTER || q->chapter.rings > 0);
            CHECK(e != HF_ENGINE_GAUSSIAN || (q->gaussian.sigma > 0 && q->gaussian.by_depth >= 0));
            if (model == HF_MODEL_RANGE)
                CHECK(q->range.distance > 0 && q->range.near_begin > 0 && q->range.near_end > 0 &&
                      q->range.far_begin > 0 && q->range.far_end > 0);
        }
}

// Refused, about an argument, in a sentence that holds some words.
static void refused(const struct hf_depth *depth, const struct hf_params *p, int error, const char *argument,
                    const char *words)
{
    struct told t;
    memset(&t, 0xff, sizeof t);
    t.params.size = sizeof t.params;
    t.r.size = sizeof t.r;
    struct hf_message message = {.size = sizeof message};
    CHECK_INT(hf_resolve(3, 3, depth, p, &t.params, &t.r, &message), error);
    CHECK_INT(message.error, error);
    CHECK_MSG(!strcmp(message.argument, argument), "%s", message.argument);
    CHECK_MSG(strstr(message.sentence, words) && !strncmp(message.sentence, argument, strlen(argument)), "%s",
              message.sentence);
    CHECK(t.r.width == 0 && t.params.focus == 0 && t.params.size == sizeof t.params);
    CHECK_INT(hf_resolve(3, 3, depth, p, NULL, NULL, NULL), error);
}

// A focus read from the depth, with and without a surface; errors leave a matching sentence.
static void focus(void)
{
    float z[9] = {0, 0, 0, 0, 6, 0, 0, 0, 0};
    struct hf_depth depth = {.size = sizeof depth, .data = z, .stride = 12};
    struct hf_params p = hf_default_params();
    p.focus = HF_DERIVE;
    CHECK(resolved(3, 3, &depth, &p).params.focus == 6);
    z[4] = 0;
    refused(&depth, &p, HF_ERR_FOCUS, "focus", "(1, 1)");
    p.engine = HF_ENGINE_GAUSSIAN;
    CHECK(resolved(3, 3, &depth, &p).params.focus == INFINITY);
    depth.data = NULL;
    refused(&depth, &p, HF_ERR_ARG, "depth.data", "is NULL");
    p.focus = -3;
    refused(&depth, &p, HF_ERR_ARG, "focus", "is -3");
    p.focus = INFINITY;
    refused(&depth, &p, HF_ERR_ARG, "focus", "is inf");
    p.model = HF_MODEL_LENS;
    CHECK(resolved(3, 3, &depth, &p).params.focus == INFINITY);
    p.engine = HF_ENGINE_CHAPTER;
    p.chapter.fill = (enum hf_fill)9;
    refused(&depth, &p, HF_ERR_ARG, "chapter.fill", "chapter.fill is 9: no such value (0 to 3)");
    p = hf_default_params();
    p.range.near_end = 12;
    refused(&depth, &p, HF_ERR_ARG, "range.near_end", "is 12; it must be at most 10");
}

// Apertures that an engine cannot draw are refused by name.
static void apertures(void)
{
    static const struct {
        enum hf_engine engine;
        const char *word;
        struct hf_aperture_params aperture;
    } cases[] = {
        {HF_ENGINE_GATHER, "ring", {.ring = 0.5f, .squeeze = 1}},
        {HF_ENGINE_GATHER, "roundness", {.blades = 6, .roundness = 0.5f, .squeeze = 1}},
        {HF_ENGINE_GATHER, "blades", {.blades = 2, .squeeze = 1}},
        {HF_ENGINE_HEXAGON, "six sides", {.blades = 5, .squeeze = 1}},
        {HF_ENGINE_HEXAGON, "squeeze", {.squeeze = 2}},
        {HF_ENGINE_GAUSSIAN, "blades", {.blades = 6, .squeeze = 1}},
        {HF_ENGINE_SCATTER, "blades", {.blades = 17, .squeeze = 1}},
        {HF_ENGINE_SCATTER, "cat_eye", {.cat_eye = 1.5f, .squeeze = 1}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct hf_depth depth = {.size = sizeof depth};
        struct hf_params p = hf_default_params();
        struct hf_message message = {.size = sizeof message};
        p.engine = cases[i].engine;
        p.aperture = cases[i].aperture;
        CHECK_INT(hf_resolve(64, 64, &depth, &p, NULL, NULL, &message), HF_ERR_ARG);
        CHECK_MSG(strstr(message.sentence, cases[i].word) != NULL, "case %zu: %s", i, message.sentence);
    }
}

static long allocations, fail_from = -1;

static void *some_alloc(void *cookie, size_t size, size_t align)
{
    (void)cookie;
    if (fail_from >= 0 && allocations >= fail_from)
        return NULL;
    allocations++;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void some_free(void *cookie, void *p)
{
    (void)cookie;
    free(p);
}

// After hf_prepare, no frame with the same radii allocates, whatever parts of it are blurred; and the bits are the
// same.
static void prepared(enum hf_engine engine)
{
    struct rng rng = rng_seed(7);
    struct hf_config config = {.size = sizeof config, .threads = 2, .alloc = some_alloc, .free = some_free};
    struct scene s = scene_new(&rng, SCENE_NOISE, 150, 90, 3);
    struct picture plain = picture_new(150, 90, 3), out = picture_new(150, 90, 3);
    struct hf_params p = scene_params();
    struct hf_context *c;
    p.engine = engine;
    CHECK_INT(hf_open(&c, &config), HF_OK);
    CHECK_INT(try_scene(c, &plain, &s, &p), HF_OK);
    hf_close(&c);
    CHECK_INT(hf_open(&c, &config), HF_OK);
    const struct hf_image dst = picture_image(&out), src = picture_image(&s.colour);
    const struct hf_depth depth = picture_depth(&s.depth);
    CHECK_INT(hf_prepare(c, &dst, &src, &depth, &p), HF_OK);
    const long before = allocations;
    CHECK_INT(try_scene(c, &out, &s, &p), HF_OK);
    CHECK_MSG(allocations == before, "%s: %ld allocations in a frame that was prepared", hf_engine_name(engine),
              allocations - before);
    CHECK(picture_same_bits(&plain, &out));
    struct tool_report report;
    tool_report_get(c, &report);
    CHECK(report.all.total_ms > 0 && report.params.engine == engine && report.inner.columns > 0);
    // If there is no memory for a frame, it leaves no report and no tiles.
    struct scene large = scene_new(&rng, SCENE_NOISE, 500, 400, 3);
    struct picture much = picture_new(500, 400, 3);
    uint8_t tiles[4] = {9, 9, 9, 9};
    fail_from = allocations;
    CHECK_INT(try_scene(c, &much, &large, &p), HF_ERR_MEMORY);
    fail_from = -1;
    tool_report_get(c, &report);
    CHECK(report.inner.columns == 0 && report.all.total_ms == 0);
    CHECK_INT(hf_inspect_tiles(c, tiles, sizeof tiles), 0);
    CHECK(tiles[0] == 9);
    CHECK_INT(try_scene(c, &much, &large, &p), HF_OK);
    CHECK(hf_inspect_tiles(c, tiles, 1) > 1);
    CHECK(tiles[0] <= HF_TILE_BOTH && tiles[1] == 9);
    hf_close(&c);
    picture_free(&much);
    picture_free(&out);
    picture_free(&plain);
    scene_free(&large);
    scene_free(&s);
}

// In a child after fork the threads are missing: the context refuses to render, can be closed, and a new context of the
// child works. A context of one thread has none that could be missing.
static void forked(int threads)
{
    struct rng rng = rng_seed(7);
    struct hf_config config = {.size = sizeof config, .threads = threads};
    struct scene s = scene_new(&rng, SCENE_NOISE, 60, 40, 3);
    struct picture out = picture_new(60, 40, 3);
    struct hf_params p = scene_params();
    struct hf_context *c;
    CHECK_INT(hf_open(&c, &config), HF_OK);
    CHECK_INT(try_scene(c, &out, &s, &p), HF_OK);
    const pid_t child = fork();
    if (child == 0) {
        alarm(60);
        int wrong = try_scene(c, &out, &s, &p) != (threads > 1 ? HF_ERR_THREAD : HF_OK);
        hf_close(&c);
        wrong |= c != NULL || hf_open(&c, &config) != HF_OK || try_scene(c, &out, &s, &p) != HF_OK;
        hf_close(&c);
        _exit(wrong);
    }
    int status = -1;
    CHECK(child > 0 && waitpid(child, &status, 0) == child);
    CHECK_MSG(WIFEXITED(status) && WEXITSTATUS(status) == 0, "the child ended with status %d", status);
    CHECK_INT(try_scene(c, &out, &s, &p), HF_OK);
    hf_close(&c);
    picture_free(&out);
    scene_free(&s);
}

int main(void)
{
    names();
    derived();
    no_sentinels();
    focus();
    apertures();
    for (int e = 0; e < tool_engines(); e++)
        prepared((enum hf_engine)e);
    forked(3);
    forked(1);
    return check_report();
}
