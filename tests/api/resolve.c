// SPDX-License-Identifier: BSD-3-Clause
// The public API, third part: names, resolved parameters, a prepared first frame, and what a child process may do.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/check.h"
#include "support/render.h"

// Every value has its own name, and the names lead back to the values.
static void names(void)
{
    static const int counts[HF_NAMES_COUNT] = {
        [HF_NAMES_ISA] = HF_ISA_NEON + 1,
        [HF_NAMES_LOG_LEVEL] = HF_LOG_INFO + 1,
        [HF_NAMES_FORMAT] = HF_FORMAT_RGBA16 + 1,
        [HF_NAMES_TRANSFER] = HF_TRANSFER_SRGB + 1,
        [HF_NAMES_DEPTH_FORMAT] = HF_DEPTH_FORMAT_X8D24 + 1,
        [HF_NAMES_DEPTH_TYPE] = HF_DEPTH_COC + 1,
        [HF_NAMES_ENGINE] = HF_ENGINE_COUNT,
        [HF_NAMES_RESOLUTION] = HF_RESOLUTION_QUARTER + 1,
        [HF_NAMES_MODEL] = HF_MODEL_LENS + 1,
        [HF_NAMES_STORAGE] = HF_STORAGE_PACKED + 1,
        [HF_NAMES_FILL] = HF_FILL_OPEN + 1,
        [HF_NAMES_BLEND] = HF_BLEND_SMOOTHSTEP + 1,
        [HF_NAMES_TILE] = HF_TILE_BOTH + 1,
        [HF_NAMES_LIMIT] = HF_LIMIT_PICTURE + 1,
        [HF_NAMES_QUALITY] = HF_QUALITY_BEST + 1,
        [HF_NAMES_DOWNSAMPLE] = HF_DOWNSAMPLE_POINT + 1,
        [HF_NAMES_DIVISION] = HF_DIVISION_NEWTON2 + 1,
        [HF_NAMES_LAYERS] = HF_LAYERS_BEST + 1,
    };
    for (int of = 0; of < HF_NAMES_COUNT; of++) {
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
    CHECK(!hf_name(HF_NAMES_COUNT, 0));
    CHECK_INT(hf_value(HF_NAMES_STORAGE, "chapter", &storage), HF_OK);
    CHECK_INT(storage, HF_STORAGE_PACKED);
    CHECK(strcmp(hf_name(HF_NAMES_STORAGE, HF_STORAGE_PACKED), "packed") == 0);
}

static struct hf_resolved resolved(int width, int height, const struct hf_depth *depth, const struct hf_params *p)
{
    struct hf_resolved r;
    char message[256];
    CHECK_MSG(hf_resolve(width, height, depth, p, &r, message, sizeof message) == HF_OK, "%s", message);
    return r;
}

// Numbers computed by hand.
static void derived(void)
{
    const struct hf_depth depth = {0};
    struct hf_params p = hf_default_params;
    p.focus = 8;
    struct hf_resolved r = resolved(1920, 1080, &depth, &p);
    CHECK(r.width == 1920 && r.height == 1080 && !r.sharp && r.lens_k == 0);
    CHECK(r.params.range.distance == 4 && r.params.range.near_begin == 4 && r.params.range.near_end == 8);
    CHECK(r.params.range.far_begin == 8 && r.params.range.far_end == 12);
    CHECK(r.params.max_radius == 12 && r.limit == HF_LIMIT_MODEL);
    CHECK_INT(r.params.gather.rings, 3);  // of two half-resolution pixels up to 6
    CHECK(r.params.view.display_width == 1920 && r.params.view.display_height == 1080);
    p.view.display_height = 2160;
    CHECK(resolved(100, 100, &depth, &p).params.max_radius == 24);
    p.max_radius = 9;
    CHECK_INT(resolved(100, 100, &depth, &p).limit, HF_LIMIT_GIVEN);
    p.range.strength = 0;
    CHECK_INT(resolved(100, 100, &depth, &p).sharp, 1);
    p = hf_default_params;
    p.model = HF_MODEL_LENS;
    p.lens.f_number = 2;  // aperture radius 0.05 / (2 * 2) m; 50 / 36 * 1800 pixels
    r = resolved(1800, 1000, &depth, &p);
    CHECK(fabsf(r.focal_px - 2500) < 1e-3f && fabsf(r.lens_k - 31.25f) < 1e-4f);
    // The sensor is as wide as the picture for any shape of pixels; with low pixels a radius covers more of them.
    p.view.pixel_aspect = 2;
    CHECK(fabsf(resolved(1800, 1000, &depth, &p).lens_k - 62.5f) < 1e-4f);
    p.view.pixel_aspect = 1;
    p.engine = HF_ENGINE_SCATTER;
    r = resolved(1800, 1000, &depth, &p);
    CHECK(r.limit == HF_LIMIT_NONE && r.params.max_radius == 2048);
    const struct hf_image picture = {.width = 1, .height = 1, .format = HF_FORMAT_PLANAR32F, .data = {&p, &p, &p}};
    p.aperture.picture = &picture;
    r = resolved(1800, 1000, &depth, &p);
    CHECK(r.limit == HF_LIMIT_PICTURE && r.params.max_radius == 256);
    p = hf_default_params;
    p.engine = HF_ENGINE_GAUSSIAN;
    r = resolved(64, 64, &depth, &p);
    CHECK(r.params.gaussian.by_depth == 1 && fabsf(r.params.gaussian.sigma - sqrtf(3)) < 1e-6f);
    p.range.distance = 3;
    CHECK_INT(resolved(64, 64, &depth, &p).params.gaussian.by_depth, 0);
    p = hf_default_params;  // angles that sines and cosines are still exact for
    p.aperture.blades = 6;
    p.aperture.rotation = -725;
    CHECK(resolved(64, 64, &depth, &p).params.aperture.rotation == -5);
    p.aperture.rotation = 3e38f;
    CHECK(fabsf(resolved(64, 64, &depth, &p).params.aperture.rotation) < 360);
}

// HF_DERIVE is replaced everywhere, for any engine and model.
static void no_sentinels(void)
{
    for (int e = 0; e < HF_ENGINE_COUNT; e++)
        for (int model = 0; model < 2; model++) {
            const struct hf_depth depth = {0};
            struct hf_params p = hf_default_params;
            p.engine = (enum hf_engine)e;
            p.model = (enum hf_model)model;
            const struct hf_resolved r = resolved(640, 480, &depth, &p);
            const struct hf_params *q = &r.params;
            CHECK(q->max_radius > 0 && q->view.display_width == 640 && q->view.display_height == 480);
            CHECK(e != HF_ENGINE_GATHER || q->gather.rings > 0);
            CHECK(e != HF_ENGINE_GAUSSIAN || (q->gaussian.sigma > 0 && q->gaussian.by_depth >= 0));
            if (model == HF_MODEL_RANGE)
                CHECK(q->range.distance > 0 && q->range.near_begin > 0 && q->range.near_end > 0 &&
                      q->range.far_begin > 0 && q->range.far_end > 0);
        }
}

// A focus read from the depth, with and without a surface; errors leave a matching sentence.
static void focus(void)
{
    float z[9] = {0, 0, 0, 0, 6, 0, 0, 0, 0};
    struct hf_depth depth = {.data = z, .stride = 12};
    struct hf_params p = hf_default_params;
    struct hf_resolved r;
    char message[256], small[8];
    p.focus = HF_DERIVE;
    CHECK(resolved(3, 3, &depth, &p).params.focus == 6);
    z[4] = 0;
    CHECK_INT(hf_resolve(3, 3, &depth, &p, &r, message, sizeof message), HF_ERR_FOCUS);
    CHECK_MSG(strstr(message, "(1, 1)") != NULL, "%s", message);
    CHECK_INT(hf_resolve(3, 3, &depth, &p, NULL, NULL, 0), HF_ERR_FOCUS);
    p.engine = HF_ENGINE_GAUSSIAN;
    CHECK(resolved(3, 3, &depth, &p).params.focus == INFINITY);
    depth.data = NULL;
    CHECK_INT(hf_resolve(3, 3, &depth, &p, &r, small, sizeof small), HF_ERR_ARG);
    CHECK_INT(strlen(small), sizeof small - 1);
    p.focus = -3;
    CHECK_INT(hf_resolve(3, 3, &depth, &p, &r, message, sizeof message), HF_ERR_ARG);
    CHECK_MSG(strstr(message, "focus is -3") != NULL, "%s", message);
    p.focus = INFINITY;
    CHECK_INT(hf_resolve(3, 3, &depth, &p, &r, message, sizeof message), HF_ERR_ARG);
    CHECK_MSG(strstr(message, "focus is inf") != NULL, "%s", message);
    p.model = HF_MODEL_LENS;
    CHECK(resolved(3, 3, &depth, &p).params.focus == INFINITY);
}

// Apertures that an engine cannot draw are refused by name.
static void apertures(void)
{
    static const struct {
        enum hf_engine engine;
        const char *word;
        struct hf_aperture_params aperture;
    } refused[] = {
        {HF_ENGINE_GATHER, "ring", {.ring = 0.5f, .squeeze = 1}},
        {HF_ENGINE_GATHER, "roundness", {.blades = 6, .roundness = 0.5f, .squeeze = 1}},
        {HF_ENGINE_GATHER, "blades", {.blades = 2, .squeeze = 1}},
        {HF_ENGINE_HEXAGON, "six sides", {.blades = 5, .squeeze = 1}},
        {HF_ENGINE_HEXAGON, "squeeze", {.squeeze = 2}},
        {HF_ENGINE_GAUSSIAN, "blades", {.blades = 6, .squeeze = 1}},
        {HF_ENGINE_SCATTER, "blades", {.blades = 17, .squeeze = 1}},
        {HF_ENGINE_SCATTER, "cat_eye", {.cat_eye = 1.5f, .squeeze = 1}},
    };
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        const struct hf_depth depth = {0};
        struct hf_params p = hf_default_params;
        char message[256] = "";
        p.engine = refused[i].engine;
        p.aperture = refused[i].aperture;
        CHECK_INT(hf_resolve(64, 64, &depth, &p, NULL, message, sizeof message), HF_ERR_ARG);
        CHECK_MSG(strstr(message, refused[i].word) != NULL, "case %zu: %s", i, message);
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
    struct hf_config config = {.threads = 2, .alloc = some_alloc, .free = some_free};
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
    struct hf_report report;
    hf_get_report(c, &report);
    CHECK(report.total_ms > 0 && report.used.params.engine == engine && report.columns > 0);
    // If there is no memory for a frame, it leaves no report and no tiles.
    struct scene large = scene_new(&rng, SCENE_NOISE, 500, 400, 3);
    struct picture much = picture_new(500, 400, 3);
    uint8_t tiles[4] = {9, 9, 9, 9};
    fail_from = allocations;
    CHECK_INT(try_scene(c, &much, &large, &p), HF_ERR_MEMORY);
    fail_from = -1;
    hf_get_report(c, &report);
    CHECK(report.columns == 0 && report.total_ms == 0);
    CHECK_INT(hf_get_tiles(c, tiles, sizeof tiles), 0);
    CHECK(tiles[0] == 9);
    CHECK_INT(try_scene(c, &much, &large, &p), HF_OK);
    CHECK(hf_get_tiles(c, tiles, 1) > 1);
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
    struct hf_config config = {.threads = threads};
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
    for (int e = 0; e < HF_ENGINE_COUNT; e++)
        prepared((enum hf_engine)e);
    forked(3);
    forked(1);
    return check_report();
}
