// SPDX-License-Identifier: BSD-3-Clause
// The bench's scenes are what their names say, and the same on every run; its pictures are packed exactly.
#include "support/check.h"
#include "pack.h"
#include "scene.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const struct bench_optics optics = {.focus = 20, .range = 10, .max_radius = 12};

static struct bench_scene paint(const char *name, int width, int height, const struct bench_optics *o)
{
    struct bench_scene scene;
    struct tool_error error = {""};
    CHECK_MSG(!bench_scene_paint(&scene, name, width, height, o, &error), "%s %dx%d: %s", name, width, height,
              error.text);
    return scene;
}

// CoC as of the chapter: near in *n, far in *f, both 0..1.
static void coc(float z, const struct bench_optics *o, float *n, float *f)
{
    *n = fminf(1, fmaxf(0, (o->focus - z) / o->range));
    *f = fminf(1, fmaxf(0, (z - o->focus) / o->range));
}

struct shares {
    double near, sharp, far;
};

static struct shares shares(const struct bench_scene *s, const struct bench_optics *o)
{
    struct shares result = {0, 0, 0};
    const int pixels = s->width * s->height;
    for (int i = 0; i < pixels; i++) {
        float n, f;
        coc(s->depth[i], o, &n, &f);
        *(n > 0 ? &result.near : f > 0 ? &result.far : &result.sharp) += 1.0 / pixels;
    }
    return result;
}

static void test_values(const char *name, int width, int height)
{
    struct bench_scene a = paint(name, width, height, &optics), b = paint(name, width, height, &optics);
    const size_t pixels = (size_t)width * (size_t)height;
    CHECK_INT(a.width, width);
    CHECK_INT(a.height, height);
    CHECK_MSG(!memcmp(a.rgb, b.rgb, pixels * 12), "%s %dx%d: colours differ on repeat", name, width, height);
    CHECK_MSG(!memcmp(a.depth, b.depth, pixels * 4), "%s %dx%d: depths differ on repeat", name, width, height);
    size_t bad_colours = 0, bad_depths = 0;
    for (size_t i = 0; i < pixels * 3; i++)
        bad_colours += !(a.rgb[i] >= 0 && a.rgb[i] <= 250);
    for (size_t i = 0; i < pixels; i++)
        bad_depths += !(a.depth[i] > 0 && a.depth[i] < 1e4f);
    CHECK_MSG(!bad_colours, "%s %dx%d: %zu colours outside 0..250", name, width, height, bad_colours);
    CHECK_MSG(!bad_depths, "%s %dx%d: %zu depths outside 0..1e4", name, width, height, bad_depths);
    bench_scene_free(&a);
    bench_scene_free(&b);
}

static void test_mixed(int width, int height)
{
    struct bench_scene s = paint("mixed", width, height, &optics);
    const struct shares p = shares(&s, &optics);
    CHECK_MSG(p.near > 0.20 && p.near < 0.47, "%dx%d: near share %g", width, height, p.near);
    CHECK_MSG(p.sharp > 0.20 && p.sharp < 0.47, "%dx%d: sharp share %g", width, height, p.sharp);
    CHECK_MSG(p.far > 0.20 && p.far < 0.47, "%dx%d: far share %g", width, height, p.far);
    if (width >= 480) {
        float brightest = 0;
        for (int i = 0; i < width * height; i++)
            if (s.depth[i] > optics.focus)
                brightest = fmaxf(brightest, s.rgb[i * 3]);
        CHECK_MSG(brightest > 50, "%dx%d: brightest light %g", width, height, (double)brightest);
    }
    bench_scene_free(&s);
}

static void test_pure(const char *name, struct shares want)
{
    struct bench_scene s = paint(name, 480, 270, &optics);
    const struct shares p = shares(&s, &optics);
    CHECK_MSG(fabs(p.near - want.near) < 0.005 && fabs(p.sharp - want.sharp) < 0.005 && fabs(p.far - want.far) < 0.005,
              "%s: near %g, sharp %g, far %g", name, p.near, p.sharp, p.far);
    bench_scene_free(&s);
}

// Is a near sample within reach (half-resolution pixels, a square) of (x, y)? Maximum and box see no farther.
static int near_in_reach(const float *n, int w, int h, int x, int y, int reach)
{
    for (int j = y - reach < 0 ? 0 : y - reach; j <= y + reach && j < h; j++)
        for (int i = x - reach < 0 ? 0 : x - reach; i <= x + reach && i < w; i++)
            if (n[j * w + i] > 0)
                return 1;
    return 0;
}

// `both`: at half resolution the blurred near CoC is > 0 everywhere and f > 0 on most.
static void test_both(float max_radius)
{
    const struct bench_optics o = {20, 10, max_radius};
    struct bench_scene s = paint("both", 480, 270, &o);
    const int w = 240, h = 135, reach = 2 * (int)ceilf(max_radius / 2);
    float *n = malloc((size_t)w * (size_t)h * sizeof *n);
    int far = 0, near = 0;
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            float f;
            coc(s.depth[2 * y * 480 + 2 * x], &o, &n[y * w + x], &f);
            far += f > 0;
        }
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            near += near_in_reach(n, w, h, x, y, reach);
    CHECK_MSG(near == w * h, "radius %g: near reaches %d of %d", (double)max_radius, near, w * h);
    CHECK_MSG(far > w * h * 3 / 4, "radius %g: far on %d of %d", (double)max_radius, far, w * h);
    free(n);
    bench_scene_free(&s);
}

static void test_focus(void)
{
    const float ranges[] = {10, 0, INFINITY};
    for (int i = 0; i < 3; i++) {
        const struct bench_optics o = {7.3f, ranges[i], 12};
        struct bench_scene s = paint("focus", 64, 36, &o);
        int exact = 0;
        for (int p = 0; p < 64 * 36; p++)
            exact += s.depth[p] == o.focus;
        CHECK_INT(exact, 64 * 36);
        bench_scene_free(&s);
    }
    // Range beyond the focus: no surface may come to lie behind the camera.
    const struct bench_optics wide = {5, 50, 12};
    struct bench_scene s = paint("near", 64, 36, &wide);
    int in_front = 0;
    for (int p = 0; p < 64 * 36; p++)
        in_front += s.depth[p] > 0 && s.depth[p] < 5;
    CHECK_INT(in_front, 64 * 36);
    bench_scene_free(&s);
}

static void test_names(void)
{
    float band = -1;
    CHECK(bench_scene_builtin("mixed", NULL));
    CHECK(bench_scene_builtin("band:12.5", &band));
    CHECK(band == 0.125f);
    const char *const bad[] = {"", "Mixed", "band", "band:", "band:P", "band:101", "band:-1", "band:nan", "band:5x"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK_MSG(!bench_scene_builtin(bad[i], NULL), "'%s' counts as a scene", bad[i]);
    struct bench_scene s;
    struct tool_error error = {""};
    CHECK(bench_scene_paint(&s, "nowhere", 4, 4, &optics, &error) == -1);
    CHECK(strstr(error.text, "nowhere") != NULL);
    CHECK(!s.rgb && !s.depth);
}

// Value of a code with 5 exponent and m mantissa bits.
static double decode(unsigned code, int m)
{
    const int e = (int)(code >> m);
    const unsigned fraction = code & ((1u << m) - 1);
    return e ? ldexp(fraction + (double)(1u << m), e - 15 - m) : ldexp(fraction, -14 - m);
}

static unsigned pack(float x, int m)
{
    return m == 10 ? bench_to_half(x) : bench_to_small(x, m);
}

// Every code comes back; half way between two goes to the even one, a bit off half way to the closer one.
static void test_rounding(int m)
{
    const unsigned largest = (31u << m) - 1;
    int exact = 0, ties = 0, above = 0, below = 0;
    for (unsigned c = 0; c <= largest; c++)
        exact += pack((float)decode(c, m), m) == c;
    for (unsigned c = 0; c < largest; c++) {
        const float middle = (float)((decode(c, m) + decode(c + 1, m)) / 2);
        ties += pack(middle, m) == (c & 1 ? c + 1 : c);
        above += pack(nextafterf(middle, INFINITY), m) == c + 1;
        below += pack(nextafterf(middle, 0), m) == c;
    }
    CHECK_INT(exact, largest + 1);
    CHECK_INT(ties, largest);
    CHECK_INT(above, largest);
    CHECK_INT(below, largest);
    CHECK_INT(pack(3e38f, m), largest);
    CHECK_INT(pack(INFINITY, m), largest + 1);
    CHECK(pack(NAN, m) > largest + 1);
}

static void test_formats(void)
{
    const float rgb[] = {0.5f, 1, 2, -1, 0, 1e9f};
    struct bench_image image;
    CHECK(!bench_image_alloc(&image, 2, 1, HF_FORMAT_R11G11B10F));
    bench_image_pack(&image, rgb);
    const uint32_t *words = image.memory;
    CHECK_INT(words[0], 14u << 6 | (15u << 6) << 11 | (16u << 5) << 22);
    CHECK_INT(words[1], ((31u << 5) - 1) << 22);
    bench_image_free(&image);

    CHECK(!bench_image_alloc(&image, 2, 1, HF_FORMAT_RGBA16F));
    bench_image_pack(&image, rgb);
    const uint16_t want[] = {0x3800, 0x3C00, 0x4000, 0x3C00, 0xBC00, 0, 0x7BFF, 0x3C00};
    CHECK(!memcmp(image.memory, want, sizeof want));
    bench_image_free(&image);

    CHECK(!bench_image_alloc(&image, 1, 2, HF_FORMAT_PLANAR32F));
    bench_image_pack(&image, rgb);
    const float planes[] = {0.5f, -1, 1, 0, 2, 1e9f};
    CHECK(!memcmp(image.memory, planes, sizeof planes));
    CHECK(image.image.data[3] == NULL);
    bench_image_free(&image);
}

// The depth alone equals that of painting the scene, except for rounding when it is computed from the depth of `mixed`.
static void test_depth(const char *name)
{
    struct bench_scene mixed, painted;
    struct tool_error error;
    float depth[64 * 40];
    CHECK(!bench_scene_paint(&mixed, "mixed", 64, 40, &optics, &error));
    CHECK(!bench_scene_paint(&painted, name, 64, 40, &optics, &error));
    CHECK(!bench_scene_depth(&mixed, name, &optics, depth, &error));
    for (int i = 0; i < 64 * 40; i++)
        CHECK_MSG(fabsf(depth[i] - painted.depth[i]) <= 1e-5f * painted.depth[i], "%s: %g, painted %g", name, depth[i],
                  painted.depth[i]);
    bench_scene_free(&mixed);
    bench_scene_free(&painted);
}

int main(void)
{
    static const int sizes[][2] = {{1, 1}, {17, 9}, {480, 270}};
    static const char *const bands[4] = {"band-near:40", "band:40", "band-far:7", "band-both:100"};
    for (int i = 0; bench_scene_names[i]; i++)
        for (int k = 0; k < 3; k++)
            test_values(strncmp(bench_scene_names[i], "band", 4) ? bench_scene_names[i] : bands[i % 4], sizes[k][0],
                        sizes[k][1]);
    test_mixed(17, 9);
    test_mixed(480, 270);
    test_mixed(270, 480);
    test_pure("near", (struct shares){1, 0, 0});
    test_pure("far", (struct shares){0, 0, 1});
    test_pure("full", (struct shares){0, 0, 1});
    test_pure("focus", (struct shares){0, 1, 0});
    test_pure("band:0", (struct shares){0, 1, 0});
    test_pure("band:40", (struct shares){0.2, 0.6, 0.2});
    test_pure("band:100", (struct shares){0.5, 0, 0.5});
    test_pure("band-near:25", (struct shares){0.25, 0.75, 0});
    test_pure("band-far:10", (struct shares){0, 0.9, 0.1});
    test_depth("near");
    test_depth("band:30");
    test_depth("band-both:100");
    test_both(12);
    test_both(4);
    test_both(48);
    test_focus();
    test_names();
    test_rounding(5);
    test_rounding(6);
    test_rounding(10);
    test_formats();
    return check_report();
}
