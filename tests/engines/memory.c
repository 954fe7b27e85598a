// SPDX-License-Identifier: BSD-3-Clause
// Memory in proportion to what a picture can show: small pictures at the largest radius, with every kind of aperture.
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/render.h"
#include "tools/common/report.h"

// The bytes that the context holds, counted by its own allocator, and the blocks that were written past their end.
struct held {
    size_t now, largest, passed;
};

enum { HEAD = 64, TAIL = 64, MARK = 0xa5 };  // bytes before a block, which hold its size, and after it

static void *take(void *cookie, size_t size, size_t align)
{
    struct held *h = cookie;
    void *p = NULL;
    if (posix_memalign(&p, align < HEAD ? HEAD : align, size + HEAD + TAIL))
        return NULL;
    *(size_t *)p = size;
    memset((char *)p + HEAD + size, MARK, TAIL);
    h->now += size;
    h->largest = size > h->largest ? size : h->largest;
    return (char *)p + HEAD;
}

static void give(void *cookie, void *p)
{
    struct held *h = cookie;
    if (!p)
        return;
    char *start = (char *)p - HEAD;
    const size_t size = *(size_t *)(void *)start;
    int whole = 1;
    for (size_t i = 0; i < TAIL; i++)
        whole &= (unsigned char)start[HEAD + size + i] == MARK;
    h->passed += !whole;
    h->now -= size;
    free(start);
}

enum { RADIUS = 2048, THREADS = 2 };

// One plane of floats of all sources that can reach a picture, clamped border included.
static double plane_bytes(int width, int height, double wide)
{
    return sizeof(float) * (2 * RADIUS * wide + width) * (2.0 * RADIUS + height);
}

struct look {
    const char *name;
    enum hf_engine engine;
    struct hf_aperture_params aperture;
    // How many planes an engine may hold. The gather and the chapter have whole windows of half resolution, a quarter of
    // a plane each: up to 16 of colours, CoC and sums for each of two threads. The chapter's taps reach ten times as far
    // along x where pixels are a tenth as wide as high, so its windows are that much wider. The others have only some
    // rows and tables.
    int planes;
    float pixel_aspect;
};

static void try_one(const struct look *look, int width, int height)
{
    struct rng rng = rng_seed(1);
    struct held held = {0};
    struct hf_params p = hf_default_params();
    struct hf_config config = {
        .size = sizeof config, .threads = THREADS, .alloc = take, .free = give, .alloc_cookie = &held};
    struct hf_context *c = NULL;
    struct tool_report report;
    struct picture colour = picture_new(width, height, 3), out = picture_new(width, height, 3),
                   radius = picture_new(width, height, 1);
    for (int i = 0; i < width * height; i++) {
        for (int k = 0; k < 3; k++)
            colour.plane[k][i] = rng_float(&rng);
        radius.plane[0][i] = rng_below(&rng, 4) ? rng_range(&rng, -RADIUS, RADIUS) : rng_range(&rng, -8, 8);
    }
    p.engine = look->engine;
    p.aperture = look->aperture;
    p.aperture.squeeze = p.aperture.squeeze > 0 ? p.aperture.squeeze : 1;
    p.max_radius = RADIUS;
    p.view.pixel_aspect = look->pixel_aspect;
    CHECK_INT(hf_open(&c, &config), HF_OK);
    struct hf_depth depth = picture_depth(&radius);
    const struct hf_image dst = picture_image(&out), src = picture_image(&colour);
    depth.type = HF_DEPTH_COC;
    CHECK_INT(hf_plan(c, &dst, &src, &depth, &p, NULL), HF_OK);
    tool_report_get(c, &report);
    // A squeezed shape's width does not count: its rows are longer, but there are no more of them.
    const double bound = look->planes * plane_bytes(width, height, 1);
    CHECK_MSG((double)held.now <= bound && (double)report.all.memory <= bound,
              "%s, %s, %d x %d: holds %.0f MB, needs %.0f, bound %.0f", hf_engine_name(p.engine), look->name, width,
              height, (double)held.now / 1e6, (double)report.all.memory / 1e6, bound / 1e6);
    CHECK_MSG(held.largest < (size_t)1 << 31, "%s, %s: a block of %zu bytes", hf_engine_name(p.engine), look->name,
              held.largest);
    hf_close(&c);
    CHECK_MSG(held.now == 0, "%zu bytes are not given back", held.now);
    picture_free(&colour);
    picture_free(&out);
    picture_free(&radius);
}

// A cat's eye of radii at which the cell that memory is planned for, a tile larger than any, has too many chords to keep, and
// those of the frame have not: the plan must hold for both. Radii differ from row to row, so that views fill their memory too.
static void try_cells(void)
{
    enum { WIDTH = 1280, HEIGHT = 720 };
    struct hf_params p = hf_default_params();
    struct held held = {0};
    struct hf_config config = {
        .size = sizeof config, .threads = THREADS, .alloc = take, .free = give, .alloc_cookie = &held};
    struct hf_context *c = NULL;
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radius = picture_new(WIDTH, HEIGHT, 1),
                   out = picture_new(WIDTH, HEIGHT, 3);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        for (int k = 0; k < 3; k++)
            colour.plane[k][i] = (float)(i / 32 % 2);
        const int x = i % WIDTH, y = i / WIDTH;
        if (x < 400 && y < 300)
            radius.plane[0][i] = x / 40 % 2 ? (float)(y % 64) * 2 - 125 : (float)(y % 64) * 1.5f + 5;
    }
    p.engine = HF_ENGINE_LAYERS;
    p.layers.quality = HF_LAYERS_BEST;
    p.layers.no_patterns = 1;
    p.aperture.cat_eye = 0.7f;
    p.max_radius = 128;
    CHECK_INT(hf_open(&c, &config), HF_OK);
    struct hf_depth depth = picture_depth(&radius);
    const struct hf_image dst = picture_image(&out), src = picture_image(&colour);
    depth.type = HF_DEPTH_COC;
    CHECK_INT(hf_render(c, &dst, &src, &depth, &p), HF_OK);
    hf_close(&c);
    CHECK_MSG(held.passed == 0, "%zu blocks are written past their end", held.passed);
    picture_free(&colour);
    picture_free(&radius);
    picture_free(&out);
}

int main(void)
{
    static const struct look looks[] = {
        {"disc", HF_ENGINE_GATHER, {0}, 8, 1},
        {"disc of wide pixels", HF_ENGINE_GATHER, {0}, 8, 0.1f},
        {"disc of high pixels", HF_ENGINE_GATHER, {0}, 8, 10},
        {"disc", HF_ENGINE_CHAPTER, {0}, 8, 1},
        {"disc of narrow pixels", HF_ENGINE_CHAPTER, {0}, 80, 0.1f},
        {"disc", HF_ENGINE_HEXAGON, {0}, 4, 1},
        {"disc", HF_ENGINE_GAUSSIAN, {0}, 4, 1},
        {"disc", HF_ENGINE_SCATTER, {0}, 4, 1},
        {"squeezed", HF_ENGINE_SCATTER, {.squeeze = 0.25f}, 4, 1},
        {"cat's eye", HF_ENGINE_SCATTER, {.cat_eye = 1}, 4, 1},
        {"chromatic ring", HF_ENGINE_SCATTER, {.ring = 0.5f, .chromatic = 0.5f}, 4, 1},
        {"all", HF_ENGINE_SCATTER, {.blades = 5, .cat_eye = 1, .chromatic = 0.5f, .squeeze = 0.25f}, 4, 1},
        {"disc", HF_ENGINE_LAYERS, {0}, 4, 1},
        {"squeezed", HF_ENGINE_LAYERS, {.squeeze = 0.25f}, 4, 1},
        {"upright", HF_ENGINE_LAYERS, {.squeeze = 4}, 4, 1},
        {"cat's eye", HF_ENGINE_LAYERS, {.cat_eye = 1}, 4, 1},
        {"chromatic ring", HF_ENGINE_LAYERS, {.ring = 0.5f, .chromatic = 0.5f}, 4, 1},
        {"all", HF_ENGINE_LAYERS, {.blades = 5, .cat_eye = 1, .chromatic = 0.5f, .squeeze = 0.25f}, 4, 1},
    };
    static const int sizes[][2] = {{19, 47}, {1, 300}};
    for (size_t i = 0; i < sizeof looks / sizeof *looks; i++)
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
            try_one(&looks[i], sizes[k][0], sizes[k][1]);
    try_cells();
    return check_report();
}
