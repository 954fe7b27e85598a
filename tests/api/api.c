// SPDX-License-Identifier: BSD-3-Clause
// The public API: refused arguments, formats, strides.
//
//     api [seed]
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/random_scene.h"
#include "tools/common/report.h"

static unsigned seed = 1;

// A valid call; tests spoil it in one place at a time.
struct call {
    struct scene scene;
    struct picture out;
    struct hf_image dst, src;
    struct hf_depth depth;
    struct hf_params params;
};

static struct call call_new(int width, int height, int channels)
{
    struct rng rng = rng_seed(seed);
    struct call c = {.scene = scene_new(&rng, SCENE_BLOCKS, width, height, channels),
                     .out = picture_new(width, height, channels),
                     .params = scene_params()};
    c.dst = picture_image(&c.out);
    c.src = picture_image(&c.scene.colour);
    c.depth = picture_depth(&c.scene.depth);
    return c;
}

static void call_free(struct call *c)
{
    scene_free(&c->scene);
    picture_free(&c->out);
}

static int logged;
static char last_log[300];

static void on_log(void *cookie, const struct hf_message *message)
{
    CHECK(cookie == &logged);
    CHECK_INT(message->size, sizeof *message);
    CHECK(message->level == HF_LOG_ERROR || message->level == HF_LOG_WARNING || message->level == HF_LOG_INFO);
    CHECK(message->sentence[0] && !strchr(message->sentence, '\n'));
    CHECK_MSG(!strncmp(message->sentence, message->argument, strlen(message->argument)), "%s", message->sentence);
    snprintf(last_log, sizeof last_log, "%s", message->sentence);
    logged++;
}

static void strings(void)
{
    for (int e = -20; e < 20; e++)
        CHECK_MSG(hf_error_string(e) && hf_error_string(e)[0], "error %d has no string", e);
    for (int e = HF_ERR_ABI; e < HF_OK; e++)
        CHECK(strcmp(hf_error_string(e), hf_error_string(e + 1)) != 0);
    char version[32];
    snprintf(version, sizeof version, "%d.%d.", HF_VERSION_MAJOR, HF_VERSION_MINOR);
    CHECK_MSG(strncmp(hf_version(), version, strlen(version)) == 0, "version %s, header %s*", hf_version(), version);
    static const char *const isas[] = {"auto", "scalar", "sse4.1", "avx2", "avx512", "neon"};
    for (int i = 0; i <= HF_ISA_NEON; i++)
        CHECK(strcmp(hf_isa_name((enum hf_isa)i), isas[i]) == 0);
    CHECK(!hf_isa_name((enum hf_isa)99) && !hf_isa_name((enum hf_isa) - 1));
    CHECK_INT(hf_isa_available(HF_ISA_SCALAR), 1);
    CHECK_INT(hf_isa_available(HF_ISA_AUTO), 1);
    CHECK_INT(hf_isa_available((enum hf_isa)99), 0);
    static const char *const passes[] = {"CoC generation",  "Downsample",      "Near CoC Max X", "Near CoC Max Y",
                                         "Near CoC Blur X", "Near CoC Blur Y", "Computation",    "Fill",
                                         "Composite"};
    const int count = tool_passes(HF_ENGINE_CHAPTER);
    CHECK_INT(count, sizeof passes / sizeof *passes);
    for (int i = 0; i < count; i++)
        CHECK(strcmp(hf_inspect_pass_name(HF_ENGINE_CHAPTER, i), passes[i]) == 0);
    CHECK(!hf_inspect_pass_name(HF_ENGINE_CHAPTER, count) && !hf_inspect_pass_name(HF_ENGINE_CHAPTER, -1) &&
          !hf_inspect_pass_name((enum hf_engine) - 1, 0));
}

static void *some_alloc(void *cookie, size_t size, size_t align)
{
    (void)cookie;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void some_free(void *cookie, void *p)
{
    (void)cookie;
    free(p);
}

static void opening(void)
{
    struct hf_context *c;
    CHECK_INT(hf_open(NULL, NULL), HF_ERR_ARG);
    struct hf_config bad[] = {
        {.threads = -1},       {.threads = 257},    {.isa = (enum hf_isa)17}, {.isa = (enum hf_isa) - 1},
        {.alloc = some_alloc}, {.free = some_free}, {.tile_width = 8},        {.tile_width = 40},
        {.tile_width = -16},   {.tile_height = 15}, {.tile_height = -1},      {.tile_width = 65552},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        c = (struct hf_context *)&c;
        bad[i].size = sizeof bad[i];
        const int err = hf_open(&c, &bad[i]);
        CHECK_MSG(err == HF_ERR_ARG || (bad[i].isa && err == HF_ERR_ISA), "config %zu: %d", i, err);
        CHECK(c == NULL);
    }
    for (int isa = HF_ISA_SCALAR; isa <= HF_ISA_NEON; isa++) {
        const struct hf_config config = {.size = sizeof config, .threads = 1, .isa = (enum hf_isa)isa};
        CHECK_INT(hf_open(&c, &config), hf_isa_available((enum hf_isa)isa) ? HF_OK : HF_ERR_ISA);
        if (c)
            CHECK_INT(hf_context_isa(c), isa);
        hf_close(&c);
        CHECK(c == NULL);
    }
    CHECK_INT(hf_open(&c, NULL), HF_OK);
    CHECK(hf_context_threads(c) >= 1 && hf_context_threads(c) <= 256);
    CHECK(hf_context_isa(c) != HF_ISA_AUTO && hf_isa_available(hf_context_isa(c)));
    struct tool_report stats;
    memset(&stats, 0xff, sizeof stats);
    tool_report_get(c, &stats);
    CHECK(stats.all.total_ms == 0 && stats.all.near_pixels == 0 && stats.pass[0].all == 0);
    hf_close(&c);
    hf_close(&c);
    hf_close(NULL);
}

// Render a spoilt call: it must be refused, with a line in the log.
static void refused(struct hf_context *c, const struct call *call, const char *what)
{
    logged = 0;
    CHECK_MSG(hf_render(c, &call->dst, &call->src, &call->depth, &call->params) == HF_ERR_ARG, "%s: not refused", what);
    CHECK_MSG(logged == 1, "%s: %d lines logged", what, logged);
}

static void accepted(struct hf_context *c, const struct call *call, const char *what)
{
    const int err = hf_render(c, &call->dst, &call->src, &call->depth, &call->params);
    CHECK_MSG(err == HF_OK, "%s: %s (%s)", what, hf_error_string(err), last_log);
}

#define SPOIL(assignment)                                                                                              \
    do {                                                                                                               \
        struct call s = good;                                                                                          \
        s.assignment;                                                                                                  \
        refused(c, &s, #assignment);                                                                                   \
    } while (0)
#define ALLOW(assignment)                                                                                              \
    do {                                                                                                               \
        struct call s = good;                                                                                          \
        s.assignment;                                                                                                  \
        accepted(c, &s, #assignment);                                                                                  \
    } while (0)

static void bad_images(struct hf_context *c)
{
    struct call good = call_new(20, 10, 4);
    accepted(c, &good, "good");
    CHECK_INT(hf_render(NULL, &good.dst, &good.src, &good.depth, &good.params), HF_ERR_ARG);
    CHECK_INT(hf_render(c, NULL, &good.src, &good.depth, &good.params), HF_ERR_ARG);
    CHECK_INT(hf_render(c, &good.dst, NULL, &good.depth, &good.params), HF_ERR_ARG);
    CHECK_INT(hf_render(c, &good.dst, &good.src, NULL, &good.params), HF_ERR_ARG);
    CHECK_INT(hf_render(c, &good.dst, &good.src, &good.depth, NULL), HF_OK);
    SPOIL(src.width = 0);
    SPOIL(src.width = -3);
    SPOIL(src.height = 0);
    SPOIL(src.width = 65537);
    SPOIL(dst.height = 70000);
    SPOIL(dst.width = 19);
    SPOIL(src.height = 9);
    SPOIL(src.format = (enum hf_format)99);
    SPOIL(dst.format = (enum hf_format) - 1);
    SPOIL(src.data[0] = NULL);
    SPOIL(src.data[2] = NULL);
    SPOIL(dst.data[1] = NULL);
    SPOIL(src.stride[0] = 79);
    SPOIL(src.stride[3] = 0);
    SPOIL(dst.stride[1] = -79);
    SPOIL(dst.stride[2] = 4);
    ALLOW(src.data[3] = NULL);
    ALLOW(dst.data[3] = NULL);
    SPOIL(depth.data = NULL);
    SPOIL(depth.stride = 79);
    SPOIL(depth.stride = -4);
    SPOIL(depth.type = (enum hf_depth_type)7);
    SPOIL(depth.type = (enum hf_depth_type) - 1);
    for (int type = HF_DEPTH_NDC_D3D; type <= HF_DEPTH_NDC_REVERSED; type++) {
        good.depth.type = (enum hf_depth_type)type;
        good.depth.near_plane = 0.5f;
        good.depth.far_plane = INFINITY;
        accepted(c, &good, "infinite far plane");
        SPOIL(depth.near_plane = 0);
        SPOIL(depth.near_plane = -1);
        SPOIL(depth.near_plane = NAN);
        SPOIL(depth.near_plane = INFINITY);
        SPOIL(depth.far_plane = 0.5f);
        SPOIL(depth.far_plane = 0);
        SPOIL(depth.far_plane = NAN);
    }
    good.depth.type = HF_DEPTH_RAY;
    good.depth.focal_px = 20;
    accepted(c, &good, "ray");
    SPOIL(depth.focal_px = 0);
    SPOIL(depth.focal_px = NAN);
    SPOIL(depth.focal_px = INFINITY);
    SPOIL(depth.center_x = NAN);
    SPOIL(depth.center_y = INFINITY);
    call_free(&good);
}

static void bad_params(struct hf_context *c)
{
    struct call good = call_new(20, 10, 3);
    SPOIL(params.engine = (enum hf_engine)99);
    SPOIL(params.model = (enum hf_model)2);
    SPOIL(params.model = (enum hf_model) - 1);
    static const float not_positive[] = {0, -0.0f, -1, NAN, -INFINITY, INFINITY};
    for (int i = 0; i < 6; i++)
        if (not_positive[i] != HF_DERIVE)
            SPOIL(params.focus = not_positive[i]);
    SPOIL(params.focus = -2);
    SPOIL(params.range.distance = -2);
    SPOIL(params.range.distance = NAN);
    SPOIL(params.range.distance = -INFINITY);
    ALLOW(params.range.distance = 0);
    ALLOW(params.range.distance = INFINITY);
    SPOIL(params.range.strength = -0.01f);
    SPOIL(params.range.strength = 1.01f);
    SPOIL(params.range.strength = NAN);
    ALLOW(params.range.strength = 0);
    SPOIL(params.range.near_begin = 25);
    SPOIL(params.range.near_begin = NAN);
    SPOIL(params.range.near_begin = -3);
    SPOIL(params.range.near_end = 5);
    SPOIL(params.range.near_end = 20.5f);
    SPOIL(params.range.near_end = INFINITY);
    SPOIL(params.range.far_begin = 31);
    SPOIL(params.range.far_begin = NAN);
    SPOIL(params.range.far_end = 19);
    SPOIL(params.range.far_end = -7);
    ALLOW(params.range.near_begin = 20);
    ALLOW(params.range.far_end = 20);
    ALLOW(params.range.far_end = INFINITY);
    SPOIL(params.max_radius = -2);
    SPOIL(params.max_radius = 2049);
    SPOIL(params.max_radius = NAN);
    SPOIL(params.max_radius = INFINITY);
    ALLOW(params.max_radius = 0);
    ALLOW(params.max_radius = 200);
    ALLOW(params.max_radius = 2048);
    SPOIL(params.view.display_width = -2);
    SPOIL(params.view.display_width = 0);
    SPOIL(params.view.display_height = -1080);
    ALLOW(params.view.display_height = 1080);
    SPOIL(params.view.pixel_aspect = 0);
    SPOIL(params.view.pixel_aspect = 11);
    SPOIL(params.view.pixel_aspect = NAN);
    ALLOW(params.view.pixel_aspect = 10);
    ALLOW(params.view.pixel_aspect = 0.1f);
    SPOIL(params.gather.storage = (enum hf_storage)3);
    SPOIL(params.range.blend = (enum hf_blend) - 1);
    for (int blades = -1; blades <= 18; blades++) {
        if (blades == 0 || (blades >= 3 && blades <= 16))
            ALLOW(params.aperture.blades = blades);
        else
            SPOIL(params.aperture.blades = blades);
    }
    SPOIL(params.aperture.rotation = NAN);
    SPOIL(params.aperture.rotation = INFINITY);
    SPOIL(params.aperture.ring = 0.5f);  // the gather does not have it
    SPOIL(params.aperture.squeeze = 2);
    SPOIL(params.run.budget_ms = NAN);
    SPOIL(params.highlight.gain = 0.5f);
    SPOIL(params.highlight.gain = 65);
    SPOIL(params.highlight.gain = NAN);
    ALLOW(params.highlight.threshold = NAN);  // not used
    good.params.highlight.gain = 2;
    SPOIL(params.highlight.threshold = 1);
    SPOIL(params.highlight.threshold = -0.1f);
    SPOIL(params.highlight.threshold = NAN);
    ALLOW(params.highlight.threshold = 0);
    good.params.highlight.gain = 1;
    good.params.engine = HF_ENGINE_CHAPTER;
    SPOIL(params.chapter.storage = (enum hf_storage)3);
    SPOIL(params.chapter.fill = (enum hf_fill)(HF_FILL_OPEN + 1));
    SPOIL(params.chapter.downsample = (enum hf_downsample)(HF_DOWNSAMPLE_POINT + 1));
    SPOIL(params.chapter.division = (enum hf_division)(HF_DIVISION_NEWTON2 + 1));
    SPOIL(params.aperture.ring = 0.5f);
    SPOIL(params.chapter.rings = 0);
    SPOIL(params.chapter.rings = 65);
    // An aperture picture is the complete shape.
    const struct hf_image aperture = good.src;
    good.params.engine = HF_ENGINE_LAYERS;
    good.params.aperture.picture = &aperture;
    ALLOW(params.aperture.squeeze = 2);
    SPOIL(params.aperture.blades = 5);
    SPOIL(params.aperture.ring = 0.5f);
    SPOIL(params.aperture.cat_eye = 0.5f);
    good.params.aperture.picture = NULL;
    ALLOW(params.aperture.cat_eye = 0.5f);
    good.params.engine = HF_ENGINE_GATHER;
    good.params.model = HF_MODEL_LENS;
    ALLOW(params.lens.f_number = INFINITY);
    for (int i = 0; i < 6; i++) {
        if (i < 5)
            SPOIL(params.lens.f_number = not_positive[i]);
        SPOIL(params.lens.focal_length_mm = not_positive[i]);
        SPOIL(params.lens.sensor_width_mm = not_positive[i]);
        SPOIL(params.lens.world_unit_m = not_positive[i]);
    }
    call_free(&good);
}

static void focus_reading(void)
{
    float data[12] = {5, 0, -1, 1e10f, INFINITY, NAN, 7, 0.25f, 1, 3, 4, 6};
    struct hf_depth d = {.size = sizeof d, .data = data, .stride = 16};
    float z = 0;
    CHECK_INT(hf_depth_at(&d, 4, 3, 0, 0, &z, NULL), HF_OK);
    CHECK(z == 5);
    CHECK_INT(hf_depth_at(&d, 4, 3, 2, 1, &z, NULL), HF_OK);
    CHECK(z == 7);
    for (int x = 1; x < 4; x++)
        CHECK_INT(hf_depth_at(&d, 4, 3, x, 0, &z, NULL), HF_ERR_FOCUS);
    CHECK_INT(hf_depth_at(&d, 4, 3, 0, 1, &z, NULL), HF_ERR_FOCUS);
    static const int outside[][2] = {{-1, 0}, {4, 0}, {0, -1}, {0, 3}};
    for (int i = 0; i < 4; i++)
        CHECK_INT(hf_depth_at(&d, 4, 3, outside[i][0], outside[i][1], &z, NULL), HF_ERR_ARG);
    CHECK_INT(hf_depth_at(&d, 65537, 3, 0, 0, &z, NULL), HF_ERR_ARG);
    CHECK_INT(hf_depth_at(&d, 4, 65537, 0, 0, &z, NULL), HF_ERR_ARG);
    CHECK_INT(hf_depth_at(NULL, 4, 3, 0, 0, &z, NULL), HF_ERR_ARG);
    CHECK_INT(hf_depth_at(&d, 4, 3, 0, 0, NULL, NULL), HF_ERR_ARG);
    d.type = HF_DEPTH_COC;
    CHECK_INT(hf_depth_at(&d, 4, 3, 0, 0, &z, NULL), HF_ERR_ARG);
    d.type = HF_DEPTH_INVERSE;
    CHECK_INT(hf_depth_at(&d, 4, 3, 3, 1, &z, NULL), HF_OK);
    CHECK_MSG(z == 4, "inverse 0.25 is %g", z);
    CHECK_INT(hf_depth_at(&d, 4, 3, 1, 0, &z, NULL), HF_ERR_FOCUS);
    data[0] = 2e-10f;
    data[1] = 0.5e-10f;
    CHECK_INT(hf_depth_at(&d, 4, 3, 0, 0, &z, NULL), HF_OK);
    CHECK_INT(hf_depth_at(&d, 4, 3, 1, 0, &z, NULL), HF_ERR_FOCUS);
    // A ray so far off the axis that its depth underflows.
    d.type = HF_DEPTH_RAY;
    d.focal_px = 1e-20f;
    data[0] = 5;
    CHECK_INT(hf_depth_at(&d, 4, 3, 0, 0, &z, NULL), HF_ERR_FOCUS);
    struct hf_params p = hf_default_params();
    p.focus = HF_DERIVE;
    p.model = HF_MODEL_LENS;
    data[6] = 7;
    CHECK_INT(hf_resolve(4, 3, &d, &p, NULL, NULL, NULL), HF_ERR_FOCUS);
    data[0] = 2e-10f;
    d.type = HF_DEPTH_NDC_REVERSED;
    d.near_plane = 0.5f;
    d.far_plane = INFINITY;
    CHECK_INT(hf_depth_at(&d, 4, 3, 3, 1, &z, NULL), HF_OK);
    CHECK_MSG(fabsf(z - 2) < 1e-6f, "reversed 0.25 is %g", z);
    d.type = HF_DEPTH_RAY;
    d.focal_px = 1;
    d.center_x = 3.5f;
    d.center_y = 1.5f;
    CHECK_INT(hf_depth_at(&d, 4, 3, 2, 1, &z, NULL), HF_OK);
    CHECK_MSG(fabsf(z - 7 / sqrtf(2)) < 1e-6f, "ray 7 is %g", z);
}

// Formats: for any input and output format, the bits are those of planar floats with the same values.
static void format_pair(struct hf_context *c, enum hf_format from, enum hf_format to, int variant)
{
    struct rng rng = rng_seed(seed + (unsigned)variant);
    const int w = 37 - variant % 3, h = 23 + variant % 2, alpha_in = variant % 2, alpha_out = variant / 2 % 2;
    struct scene scene = scene_new(&rng, SCENE_HIGHLIGHTS, w, h, 4);
    struct hf_depth depth = picture_depth(&scene.depth);
    struct hf_params p = scene_params();
    struct packed in = packed_new(w, h, from, alpha_in, variant % 4 * 13, variant & 4, variant % 8, 0x5a);
    struct packed out = packed_new(w, h, to, alpha_out, (3 - variant % 4) * 7, variant & 8, variant % 5, 0xa5);
    packed_write(&in, &scene.colour);
    struct picture seen = packed_read(&in), plain = picture_new(w, h, seen.channels);
    const struct hf_image src = picture_image(&seen), dst = picture_image(&plain);
    CHECK_INT(hf_render(c, &dst, &src, &depth, &p), HF_OK);
    CHECK_INT(hf_render(c, &out.image, &in.image, &depth, &p), HF_OK);
    struct packed want = packed_new(w, h, to, alpha_out, (3 - variant % 4) * 7, variant & 8, variant % 5, 0xa5);
    packed_write(&want, &plain);
    for (int i = 0; i < 4 && want.memory[i]; i++)
        CHECK_MSG(memcmp(want.memory[i], out.memory[i], want.size[i]) == 0, "format %d to %d, variant %d, plane %d",
                  from, to, variant, i);
    CHECK(packed_junk_intact(&in, 0x5a));
    CHECK(packed_junk_intact(&out, 0xa5));
    struct picture again = packed_read(&in);
    CHECK(picture_same_bits(&again, &seen));  // the source is not written
    if (from == to && alpha_in == alpha_out) {
        CHECK_INT(hf_render(c, &in.image, &in.image, &depth, &p), HF_OK);
        struct picture a = packed_read(&in), b = packed_read(&out);
        CHECK_MSG(picture_same_bits(&a, &b), "format %d, variant %d: in place differs", from, variant);
        CHECK(packed_junk_intact(&in, 0x5a));
        picture_free(&a);
        picture_free(&b);
    }
    picture_free(&again);
    picture_free(&plain);
    picture_free(&seen);
    packed_free(&in);
    packed_free(&out);
    packed_free(&want);
    scene_free(&scene);
}

// Put a bit pattern that is not finite, or the largest finite number, into a sample.
static void poke(struct packed *p, struct rng *rng, int largest)
{
    const struct hf_image *m = &p->image;
    const int c = rng_below(rng, format_channels(m->format)), x = rng_below(rng, m->width);
    const int plane = m->format == HF_FORMAT_PLANAR32F && m->data[c] ? c : 0;
    unsigned char *pixel = (unsigned char *)m->data[plane] + rng_below(rng, m->height) * m->stride[plane] +
                           x * (ptrdiff_t)format_pixel_size(m->format);
    const int nan = rng_below(rng, 2);
    if (m->format == HF_FORMAT_R11G11B10F) {
        uint32_t word;
        const int shift = 11 * (c % 3), bits = c == 2 ? 10 : 11;
        const uint32_t mask = ((1u << bits) - 1) << shift, infinite = (31u << (bits - 5)) << shift;
        memcpy(&word, pixel, 4);
        word &= ~mask;
        word |= largest ? infinite - (1u << shift) : nan ? mask : infinite;
        memcpy(pixel, &word, 4);
    } else if (m->format == HF_FORMAT_RGBA16F) {
        const uint16_t half = largest ? 0x7bff : nan ? 0xfe01 : 0xfc00;
        memcpy(pixel + 2 * c, &half, 2);
    } else {
        const float f = largest ? 65504 : nan ? NAN : -INFINITY;
        memcpy(pixel + (m->format == HF_FORMAT_PLANAR32F ? 0 : 4 * c), &f, 4);
    }
}

// Samples that are not finite, in every format: in place and out of place give the same bits, and no others change.
static void repairs(struct hf_context *c, enum hf_format format, int variant)
{
    struct rng rng = rng_seed(seed + (unsigned)variant);
    struct scene scene = scene_new(&rng, SCENE_BLOCKS, 50 + variant, 20 + variant, 4);
    const struct hf_depth depth = picture_depth(&scene.depth);
    struct hf_params p = scene_params();
    struct packed a = packed_new(50 + variant, 20 + variant, format, 1, 4, 0, 0, 7);
    struct packed b = packed_new(50 + variant, 20 + variant, format, 1, 4, 0, 0, 7);
    packed_write(&a, &scene.colour);
    for (int i = 0; i < 60; i++)
        poke(&a, &rng, i % 3 == 0);
    struct picture before = packed_read(&a);
    uint64_t bad = 0;
    for (int k = 0; k < before.channels; k++)
        for (int i = 0; i < before.width * before.height; i++)
            bad += !isfinite(before.plane[k][i]);
    p.range.strength = (float)(variant % 2);
    p.run.no_skip = variant / 2 % 2;
    struct tool_report stats;
    CHECK_INT(hf_render(c, &b.image, &a.image, &depth, &p), HF_OK);
    tool_report_get(c, &stats);
    CHECK_INT(stats.all.colour_repaired, bad);
    CHECK_INT(hf_render(c, &a.image, &a.image, &depth, &p), HF_OK);
    tool_report_get(c, &stats);
    CHECK_INT(stats.all.colour_repaired, bad);
    struct picture out = packed_read(&b), in_place = packed_read(&a);
    CHECK_MSG(picture_same_bits(&out, &in_place), "format %d, variant %d: repair in place differs", format, variant);
    int wrong = 0;
    for (int k = 0; k < before.channels; k++)
        for (int i = 0; i < before.width * before.height; i++)
            wrong += !isfinite(out.plane[k][i]) ||
                     (p.range.strength == 0 && isfinite(before.plane[k][i]) && out.plane[k][i] != before.plane[k][i]);
    CHECK_MSG(wrong == 0, "format %d, variant %d: %d samples not finite, or changed by a copy", format, variant, wrong);
    picture_free(&before);
    picture_free(&out);
    picture_free(&in_place);
    packed_free(&a);
    packed_free(&b);
    scene_free(&scene);
}

// Depth rows at odd distances, bottom-up, with junk between them: the same picture; the junk is not read.
static void depth_strides(struct hf_context *c)
{
    struct call good = call_new(33, 21, 3);
    accepted(c, &good, "depth strides");
    struct picture want = picture_copy(&good.out);
    for (int i = 0; i < 4; i++) {
        const ptrdiff_t row = 33 * 4, stride = row + 6 * i;
        unsigned char *memory = malloc((size_t)(stride * 21) + 8);
        memset(memory, 0xff, (size_t)(stride * 21) + 8);  // NaN
        for (int y = 0; y < 21; y++)
            memcpy(memory + 4 + stride * (i & 1 ? 20 - y : y), good.scene.depth.plane[0] + y * 33, (size_t)row);
        good.depth.data = (const float *)(void *)(memory + 4 + (i & 1 ? 20 * stride : 0));
        good.depth.stride = i & 1 ? -stride : stride;
        accepted(c, &good, "depth strides");
        CHECK_MSG(picture_same_bits(&want, &good.out), "depth stride %td", good.depth.stride);
        struct tool_report stats;
        tool_report_get(c, &stats);
        CHECK_INT(stats.all.depth_repaired, 0);
        free(memory);
    }
    picture_free(&want);
    call_free(&good);
}

// A flag is 0 or 1: any other number counts as 1, also where a kernel counts with it.
static void flags(struct hf_context *c)
{
    struct call call = call_new(48, 32, 4);
    struct picture want = picture_new(48, 32, 4);
    const struct hf_image reference = picture_image(&want);
    call.params.engine = HF_ENGINE_GATHER;
    call.params.gather.karis = call.params.gather.bicubic = call.params.gather.per_pixel_kernel = 1;
    CHECK_INT(hf_render(c, &reference, &call.src, &call.depth, &call.params), HF_OK);
    call.params.gather.karis = 7;
    call.params.gather.bicubic = -3;
    call.params.gather.per_pixel_kernel = 1000000;
    CHECK_INT(hf_render(c, &call.dst, &call.src, &call.depth, &call.params), HF_OK);
    CHECK(picture_same_bits(&want, &call.out));
    picture_free(&want);
    call_free(&call);
}

int main(int argc, char **argv)
{
    seed = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 1;
    printf("seed %u\n", seed);
    strings();
    opening();
    focus_reading();
    for (int isa = HF_ISA_SCALAR; isa <= HF_ISA_NEON; isa++) {
        if (!hf_isa_available((enum hf_isa)isa))
            continue;
        const struct hf_config config = {
            .size = sizeof config, .threads = 2, .isa = (enum hf_isa)isa, .log = on_log, .log_cookie = &logged};
        struct hf_context *c;
        if (!CHECK_INT(hf_open(&c, &config), HF_OK))
            continue;
        bad_images(c);
        bad_params(c);
        depth_strides(c);
        flags(c);
        for (int from = 0; from <= HF_FORMAT_PLANAR32F; from++)
            for (int variant = 0; variant < 8; variant++)
                repairs(c, (enum hf_format)from, variant);
        for (int from = 0; from <= HF_FORMAT_PLANAR32F; from++)
            for (int to = 0; to <= HF_FORMAT_PLANAR32F; to++)
                for (int variant = 0; variant < 16; variant++)
                    format_pair(c, (enum hf_format)from, (enum hf_format)to, variant);
        hf_close(&c);
    }
    return check_report();
}
