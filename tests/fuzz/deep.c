// SPDX-License-Identifier: BSD-3-Clause
// Deep pictures given to the library: counts, depths and colours are any bytes, and so are the places at which pixels begin.
// A call is refused with one sentence, or its picture is finite; it reads nothing beyond the arrays, and all memory is freed.
#include <float.h>
#include <math.h>
#include <string.h>

#include <hyperfocal/layers.h>

#include "fuzz/blocks.h"
#include "fuzz/fuzz.h"

enum { MOST_SIDE = 24, MOST_SAMPLES = 2000 };

static long became[2];  // pictures, and refused ones

void fuzz_told(void)
{
    printf("%ld deep pictures rendered, %ld refused\n", became[0], became[1]);
}

// Floats come from a generator that the bytes start, as there are more of them than bytes.
static float any_float(uint32_t *state, int calm)
{
    static const float odd[] = {NAN, INFINITY, -INFINITY, FLT_MAX, -FLT_MAX, 1e-42f, -1, 0, 1, 1e20f, 65504};
    *state = *state * 1664525u + 1013904223u;
    const unsigned v = *state >> 24;
    return v < 32 && !calm ? odd[v % (sizeof odd / sizeof *odd)] : (float)v / 64;
}

// An array of floats that ends where its block ends.
static float *any_floats(struct bytes *b, size_t n)
{
    float *p = block_of(n * sizeof *p, sizeof *p);
    uint32_t state = take_word(b);
    const int calm = take_byte(b) & 1;
    MUST(p != NULL);
    for (size_t i = 0; i < n; i++)
        p[i] = any_float(&state, calm);
    return p;
}

// Where the samples of each pixel begin; sometimes one place is any number. Returns how many samples there are.
static uint64_t any_places(struct bytes *b, uint64_t *first, size_t pixels)
{
    uint64_t all = 0;
    const unsigned most = 1 + take_byte(b) % 12;
    for (size_t i = 0; i < pixels; i++) {
        const unsigned count = take_byte(b);
        first[i] = all;
        all += count == 255 ? 100 : count % most;
        all = all < MOST_SAMPLES ? all : MOST_SAMPLES;
    }
    first[pixels] = all;
    if (take_byte(b) > 200)
        first[take_word(b) % (pixels + 1)] = (uint64_t)take_word(b) << take_byte(b) % 40;
    if (take_byte(b) > 240)
        first[pixels] = UINT64_MAX;
    return all;
}

static struct hf_params any_look(struct bytes *b)
{
    struct hf_params p = hf_default_params();
    const unsigned flags = take_byte(b);
    p.engine = flags % 16 ? (flags & 32 ? HF_ENGINE_SCATTER : HF_ENGINE_LAYERS) : HF_ENGINE_GATHER;
    p.focus = flags % 32 == 17 ? HF_DERIVE : 2;
    p.range.distance = 0.5f;
    p.max_radius = (float)(take_byte(b) % 128) / 8;
    p.layers.quality = (enum hf_layers_quality)(take_byte(b) % 4);
    p.layers.guessed = p.engine == HF_ENGINE_LAYERS && flags >> 6 & 1;
    return p;
}

static void render(struct hf_context *c, struct bytes *b, struct hf_deep *d)
{
    const size_t pixels = (size_t)d->width * (size_t)d->height;
    struct hf_depth as = {.size = sizeof as, .type = (enum hf_depth_type)(take_byte(b) % 7)};
    if (as.type == HF_DEPTH_NDC_D3D || as.type == HF_DEPTH_NDC_GL || as.type == HF_DEPTH_NDC_REVERSED) {
        as.near_plane = 0.25f;
        as.far_plane = 100;
    }
    as.focal_px = 50;
    d->as = &as;
    const struct hf_params p = any_look(b);
    float *out = block_of(4 * pixels * sizeof *out, sizeof *out);
    MUST(out != NULL);
    memset(out, 0, 4 * pixels * sizeof *out);
    const struct hf_image dst = {.size = sizeof dst,
                                 .width = d->width,
                                 .height = d->height,
                                 .format = HF_FORMAT_RGBA32F,
                                 .data = {out},
                                 .stride = {16 * (ptrdiff_t)d->width}};
    const int status = hf_render_deep(c, &dst, d, &p, NULL);
    MUST(status == HF_OK || status == HF_ERR_ARG || status == HF_ERR_MEMORY || status == HF_ERR_FOCUS);
    struct hf_message problem = {.size = sizeof problem};
    MUST(hf_get_problem(c, &problem) == HF_OK && (status == HF_OK || strlen(problem.sentence) > 10));
    for (size_t i = 0; i < 4 * pixels && status == HF_OK; i++)
        MUST(isfinite(out[i]) && (!p.layers.guessed || (out[i] >= 0 && out[i] <= 1)));
    became[status != HF_OK]++;
    free_block(out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct hf_context *c;
    struct bytes b = {data, size};
    const struct hf_config config = {.size = sizeof config, .threads = 1};
    MUST(c || hf_open(&c, &config) == HF_OK);
    struct hf_deep d = {.size = sizeof d};
    d.width = 1 + (int)(take_byte(&b) % MOST_SIDE);
    d.height = 1 + (int)(take_byte(&b) % MOST_SIDE);
    const size_t pixels = (size_t)d.width * (size_t)d.height;
    uint64_t *first = block_of((pixels + 1) * sizeof *first, sizeof *first);
    MUST(first != NULL);
    d.samples = any_places(&b, first, pixels);
    d.first = first;
    float *planes[6];
    for (int i = 0; i < 6; i++)
        planes[i] = any_floats(&b, (size_t)d.samples);
    for (int i = 0; i < 3; i++)
        d.colour[i] = planes[i];
    d.alpha = planes[3];
    d.depth = planes[4];
    d.back = take_byte(&b) & 1 ? planes[5] : NULL;
    uint32_t *object = block_of((size_t)d.samples * sizeof *object, sizeof *object);
    MUST(object != NULL);
    uint32_t state = take_word(&b);
    for (uint64_t i = 0; i < d.samples; i++)
        object[i] = (state = state * 1664525u + 1013904223u) >> 30;
    d.object = take_byte(&b) & 1 ? object : NULL;
    render(c, &b, &d);
    for (int i = 0; i < 6; i++)
        free_block(planes[i]);
    free_block(object);
    free_block(first);
    return 0;
}
