// SPDX-License-Identifier: BSD-3-Clause
// Deep pictures: what hf_render_deep takes and refuses, what must not change a picture, and random samples.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "hyperfocal/layers.h"

enum { W = 94, H = 61, N = W * H, MOST = 12 * N };

static struct hf_context *context;
static struct hf_params params;
static uint64_t first[N + 1];
static float red[MOST], green[MOST], blue[MOST], alpha[MOST], depth[MOST], back[MOST];
static uint32_t object[MOST];
static float out[2][4 * N];
static struct hf_depth as = {.size = sizeof as};

struct sample {
    float r, g, b, a, z, back;
    uint32_t object;
};

// A picture in work: samples of one pixel after the other.
static size_t count, pixels;

static void begin(void)
{
    count = pixels = 0;
    first[0] = 0;
}

static void put(struct sample s)
{
    red[count] = s.a * s.r;
    green[count] = s.a * s.g;
    blue[count] = s.a * s.b;
    alpha[count] = s.a;
    depth[count] = s.z;
    back[count] = s.back;
    object[count++] = s.object;
}

static void next(void)
{
    first[++pixels] = count;
}

static struct hf_deep deep(void)
{
    return (struct hf_deep){.size = sizeof(struct hf_deep),
                            .width = W,
                            .height = H,
                            .first = first,
                            .samples = count,
                            .colour = {red, green, blue},
                            .alpha = alpha,
                            .depth = depth,
                            .as = &as};
}

static struct hf_image image(float *rgba)
{
    return (struct hf_image){.size = sizeof(struct hf_image),
                             .width = W,
                             .height = H,
                             .format = HF_FORMAT_RGBA32F,
                             .data = {rgba},
                             .stride = {W * 4 * sizeof(float)}};
}

static int render(int to, const struct hf_deep *d, const struct hf_region *region)
{
    const struct hf_image dst = image(out[to]);
    memset(out[to], 0, sizeof out[to]);
    return hf_render_deep(context, &dst, d, &params, region);
}

static float apart(void)
{
    float most = 0;
    for (int i = 0; i < 4 * N; i++)
        most = fmaxf(fabsf(out[0][i] - out[1][i]), most);
    return most;
}

static int same(void)
{
    return !memcmp(out[0], out[1], sizeof out[0]);
}

// How much of a pixel a near bar with soft edges fills.
static float bar(int x)
{
    return fminf(fmaxf(7.5f - fabsf((float)x - W / 2.0f + 0.25f), 0), 1);
}

static struct sample bar_at(int x)
{
    return (struct sample){0.8f, 0.1f, 0.1f, bar(x), 2, 2, 5};
}

static struct sample wall_at(int x, int y)
{
    return (struct sample){0.2f, bar(x) > 0 ? 0.9f : 0.1f, (float)((x / 4 + y / 4) % 2), 1, 20, 20, 6};
}

// The bar before a wall. how: 1 the other order, 2 with samples that show nothing, 3 the bar in two halves over each other,
// 4 in two halves beside each other of one object.
static void paint(int how)
{
    begin();
    for (int i = 0; i < N; i++) {
        struct sample b = bar_at(i % W), half = b;
        const struct sample w = wall_at(i % W, i / W);
        half.a = how == 3 ? 1 - sqrtf(1 - b.a) : b.a / 2;
        if (how == 1)
            put(w);
        if (how == 2) {
            put((struct sample){1, 1, 1, 0, 1, 1, 0});
            put((struct sample){1, 1, 1, 1, NAN, NAN, 0});
            put((struct sample){NAN, 1, 1, NAN, 3, 3, 0});
        }
        if (b.a > 0 && how < 3)
            put(b);
        for (int k = 0; k < 2 && b.a > 0 && how >= 3; k++)
            put(half);
        if (how != 1)
            put(w);
        next();
    }
}

static void test_neutral(void)
{
    struct hf_deep d;
    paint(0);
    d = deep();
    CHECK_INT(render(0, &d, NULL), HF_OK);
    for (int how = 1; how <= 4; how++) {
        paint(how);
        d = deep();
        d.object = how == 4 ? object : NULL;
        CHECK_INT(render(1, &d, NULL), HF_OK);
        // Halves are put together with a few roundings each, which the sums of slices pass on.
        CHECK_MSG(how < 3 ? same() : apart() <= 1e-4f, "picture %d differs by %g", how, apart());
    }
    paint(0);
    d = deep();
    d.back = back;
    CHECK_INT(render(1, &d, NULL), HF_OK);
    CHECK_MSG(same(), "an end at the depth itself counts");
}

// Two layers with depth are the same picture.
static void test_layers(void)
{
    static float rgba[2][4 * N], z[2][N];
    struct hf_image images[2];
    struct hf_depth depths[2];
    struct hf_layer layers[2];
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < N; i++) {
            const struct sample s = k ? wall_at(i % W, i / W) : bar_at(i % W);
            const float colour[] = {s.a * s.r, s.a * s.g, s.a * s.b, s.a};
            memcpy(rgba[k] + 4 * i, colour, sizeof colour);
            z[k][i] = s.z;
        }
        images[k] = image(rgba[k]);
        depths[k] = (struct hf_depth){.size = sizeof *depths, .data = z[k], .stride = W * sizeof(float)};
        layers[k] = (struct hf_layer){.size = sizeof *layers, .image = &images[k], .depth = &depths[k]};
    }
    paint(0);
    const struct hf_deep d = deep();
    const struct hf_image dst = image(out[1]);
    CHECK_INT(render(0, &d, NULL), HF_OK);
    CHECK_INT(hf_render_layers(context, &dst, layers, 2, &params, NULL), HF_OK);
    CHECK_MSG(same(), "layers and samples differ by %g", apart());
}

// The parts of a fog of one colour before a wall of that colour are that colour: to 64 roundings of sums in the slices.
static void test_constant(void)
{
    begin();
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < 9; k++)
            put((struct sample){0.5f, 0.5f, 0.5f, (float)(1 + (i + k) % 7) / 10, 1.5f + (float)k, 3 + (float)k, 0});
        put((struct sample){0.5f, 0.5f, 0.5f, 1, 20, 20, 0});
        next();
    }
    struct hf_deep d = deep();
    d.back = back;
    float off = 0;
    CHECK_INT(render(0, &d, NULL), HF_OK);
    for (int i = 0; i < 4 * N; i++)
        off = fmaxf(fabsf(out[0][i] - (i % 4 == 3 ? 1 : 0.5f)), off);
    CHECK_MSG(off <= 64 * 1.2e-7f, "a constant scene is off by %g", off);
}

static void test_region(void)
{
    const struct hf_region part = {.size = sizeof part, .x = 30, .y = 20, .width = 40, .height = 23};
    paint(0);
    const struct hf_deep d = deep();
    const struct hf_image dst = image(out[1]);
    CHECK_INT(render(0, &d, NULL), HF_OK);
    memcpy(out[1], out[0], sizeof out[0]);
    CHECK_INT(hf_render_deep(context, &dst, &d, &params, &part), HF_OK);
    CHECK(same());
    CHECK_INT(render(1, &d, &part), HF_OK);
    CHECK(!same());
}

// 1 if the call is refused with a sentence that holds a word.
static int refused(const struct hf_deep *d, const char *word)
{
    struct hf_message why = {.size = sizeof why};
    return render(0, d, NULL) == HF_ERR_ARG && hf_get_problem(context, &why) == HF_OK &&
           strstr(why.sentence, word) != NULL;
}

static void test_refused(void)
{
    paint(0);
    struct hf_deep d = deep();
    CHECK(refused(NULL, "deep"));
    d.first = NULL;
    CHECK(refused(&d, "deep.first"));
    d = deep();
    d.samples--;
    CHECK(refused(&d, "deep.first"));
    d = deep();
    d.alpha = NULL;
    CHECK(refused(&d, "deep"));
    d = deep();
    d.width = 0;
    CHECK(refused(&d, "0 x"));
    d = deep();
    first[7] = UINT64_MAX;
    CHECK(refused(&d, "pixel (6, 0)"));
    first[7] = 0;
    CHECK(refused(&d, "deep.first"));
    paint(0);
    params.engine = HF_ENGINE_GATHER;
    CHECK(refused(&d, "gather"));
    params.engine = HF_ENGINE_LAYERS;
    params.focus = HF_DERIVE;
    CHECK(refused(&d, "focus"));
    params.focus = 6;
}

static int stop(void *cookie, float done)
{
    (void)cookie;
    (void)done;
    return 1;
}

static void test_cancelled(void)
{
    paint(0);
    const struct hf_deep d = deep();
    hf_set_progress(context, stop, NULL);
    CHECK_INT(render(0, &d, NULL), HF_ERR_CANCELLED);
    hf_set_progress(context, NULL, NULL);
    CHECK_INT(render(0, &d, NULL), HF_OK);
}

static uint32_t state = 1;

static uint32_t any(void)
{
    state = state * 1664525 + 1013904223;
    return state >> 8;
}

static float any_float(void)
{
    static const float odd[] = {NAN, INFINITY, -INFINITY, 0, -1, 1e30f, -1e30f, 1e-40f, 3e38f, 1e10f};
    return any() % 4 ? (float)(any() % 1000) / 100 : odd[any() % (sizeof odd / sizeof *odd)];
}

// Samples of any kind: a finite picture, or one sentence.
static void test_random(int rounds)
{
    static const enum hf_depth_type types[] = {HF_DEPTH_VIEW, HF_DEPTH_RAY, HF_DEPTH_NDC_REVERSED, HF_DEPTH_INVERSE,
                                               HF_DEPTH_COC};
    int bad = 0, done = 0;
    for (int round = 0; round < rounds; round++) {
        begin();
        while (pixels < N) {
            const size_t left = MOST - count, n = any() % 5 ? any() % 9 : 0;
            for (size_t k = 0; k < n && k < left; k++) {
                put((struct sample){any_float(), any_float(), any_float(), any_float() / 4, any_float(), any_float(),
                                    any() % 3});
                if (any() % 2)
                    alpha[count - 1] = 1;
            }
            next();
        }
        if (any() % 4 == 0)
            first[any() % (N + 1)] = (uint64_t)any() << any() % 40;
        struct hf_deep d = deep();
        d.back = any() % 2 ? back : NULL;
        d.object = any() % 2 ? object : NULL;
        as.type = types[any() % (sizeof types / sizeof *types)];
        as.near_plane = 0.5f;
        as.far_plane = 50;
        as.focal_px = 100;
        const int status = render(0, &d, NULL);
        done += status == HF_OK;
        bad += status != HF_OK && status != HF_ERR_ARG;
        for (int i = 0; i < 4 * N; i++)
            bad += !isfinite(out[0][i]);
    }
    as = (struct hf_depth){.size = sizeof as};
    CHECK_INT(bad, 0);
    CHECK_MSG(done > rounds / 3, "%d of %d random pictures were rendered", done, rounds);
}

int main(void)
{
    const struct hf_config config = {.size = sizeof config, .threads = 2};
    params = hf_default_params();
    params.engine = HF_ENGINE_LAYERS;
    params.model = HF_MODEL_LENS;
    params.focus = 6;
    params.lens.f_number = 0.5f;
    params.lens.focal_length_mm = 30;
    if (!CHECK_INT(hf_open(&context, &config), HF_OK))
        return check_report();
    for (int quality = HF_LAYERS_STANDARD; quality <= HF_LAYERS_BEST; quality++) {
        params.layers.quality = (enum hf_layers_quality)quality;
        test_neutral();
        test_layers();
        test_constant();
        test_region();
    }
    params.layers.quality = HF_LAYERS_STANDARD;
    const int rounds = getenv("HF_LONG") ? 2000 : 40;
    test_refused();
    test_cancelled();
    test_random(rounds);
    params.engine = HF_ENGINE_SCATTER;
    test_neutral();
    test_layers();
    test_constant();
    test_region();
    test_random(rounds);
    hf_close(&context);
    return check_report();
}
