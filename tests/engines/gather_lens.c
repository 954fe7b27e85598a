// SPDX-License-Identifier: BSD-3-Clause
// The gather with radii that it finds in the depth: each field has its own kernels, light is conserved, and the picture
// comes closer to what a lens sees.
//
//     gather_lens images      the folder of the ray-traced scenes
#include <stdio.h>
#include <stdlib.h>

#include "support/check.h"
#include "support/render.h"
#include "tools/common/report.h"

enum { WIDTH = 320, HEIGHT = 120, MIDDLE = HEIGHT / 2, EDGE = 100, POINT = 230 };
static const float NEAR = 30, FAR = 6;

static struct hf_params lens_params(void)
{
    struct hf_params p = hf_default_params();
    p.engine = HF_ENGINE_GATHER;
    return p;
}

// Near on the left, far on the right, with a quad of light at (x, MIDDLE).
static struct picture light_at(struct hf_context *c, const struct hf_params *p, int x)
{
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radii = picture_new(WIDTH, HEIGHT, 1);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        radii.plane[0][i] = i % WIDTH < EDGE ? -NEAR : FAR;
    for (int k = 0; k < 12; k++)
        colour.plane[k / 4][(MIDDLE + k / 2 % 2) * WIDTH + x + k % 2] = 1000;
    const struct hf_image src = picture_image(&colour);
    const struct hf_depth depth = picture_radii(&radii);
    const struct picture out = render(c, &colour, &depth, p);
    struct tool_report report;
    CHECK_INT(hf_plan(c, &src, &src, &depth, p, NULL), HF_OK);
    tool_report_get(c, &report);
    // Dividing the radius by the largest possible one and multiplying back rounds twice.
    CHECK(fabsf(report.all.near_radius - NEAR) < 1e-5f && fabsf(report.all.far_radius - FAR) < 1e-5f);
    picture_free(&colour);
    picture_free(&radii);
    return out;
}

// How far down from the light there is some. Rows below hold nothing of the other field.
static int extent(const struct picture *p, int x)
{
    int most = 0;
    for (int y = MIDDLE; y < HEIGHT; y++)
        if (p->plane[1][y * WIDTH + x] > 0)
            most = y - MIDDLE;
    return most;
}

static void own_radii(struct hf_context *c)
{
    const struct hf_params p = lens_params();
    struct picture far = light_at(c, &p, POINT), near = light_at(c, &p, 40);
    // The lattice reaches h half-resolution pixels, the fill one more and the upsampling another: at most two pixels
    // each; the quad itself is two pixels.
    const int far_reach = extent(&far, POINT), near_reach = extent(&near, 40);
    CHECK_MSG(far_reach >= (int)FAR && far_reach <= (int)FAR + 6, "far light reaches %d pixels, not %g", far_reach,
              (double)FAR);
    CHECK_MSG(near_reach >= (int)NEAR && near_reach <= (int)NEAR + 6, "near light reaches %d pixels, not %g",
              near_reach, (double)NEAR);
    // Every step is a weighted mean with fixed weights on a quad's own grid, so light only moves. A sample is the sum
    // of about 50 roundings of 6e-8.
    double sum = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        sum += far.plane[1][i];
    CHECK_MSG(fabs(sum / 4000 - 1) < 50 * 6e-8, "light of %g became %g", 4000.0, sum);
    picture_free(&far);
    picture_free(&near);
}

// Without blur nothing is near or far. Radii too small for a byte next to 256 pixels stay what they are in every
// storage.
static void small_radii(struct hf_context *c)
{
    for (int storage = HF_STORAGE_FLOAT; storage <= HF_STORAGE_PACKED; storage++) {
        struct hf_params p = lens_params();
        struct picture colour = picture_new(64, 48, 3), radii = picture_new(64, 48, 1);
        for (int i = 0; i < 64 * 48; i++) {
            radii.plane[0][i] = 2;
            colour.plane[1][i] = i % 64 == 31 ? 16 : 0;
        }
        const struct hf_depth depth = picture_radii(&radii);
        p.gather.storage = (enum hf_storage)storage;
        struct picture out = render(c, &colour, &depth, &p);
        CHECK_MSG(out.plane[1][24 * 64 + 31] < 8, "storage %d: a radius of 2 leaves %g of 16", storage,
                  (double)out.plane[1][24 * 64 + 31]);
        picture_free(&colour);
        picture_free(&radii);
        picture_free(&out);
    }
}

// was: dB that it has. By a fifth of a dB, a step of the ladder, it may be worse before someone has to look; instruction sets
// differ by 0.01 dB.
static void truth(struct hf_context *c, const char *folder, const char *scene, float focus, float f_number, double was)
{
    static const char *const rgb[] = {"R", "G", "B"}, *const z[] = {"Z"};
    struct picture in, depth, want;
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.exr", folder, scene);
    if (!CHECK(exr_read(&in, path, 3, rgb) == 0 && exr_read(&depth, path, 1, z) == 0))
        return;
    snprintf(path, sizeof path, "%s/%s.truth.exr", folder, scene);
    if (!CHECK(exr_read(&want, path, 3, rgb) == 0))
        return;
    struct hf_params p = lens_params();
    p.model = HF_MODEL_LENS;
    p.focus = focus;
    p.lens.f_number = f_number;
    const struct hf_depth d = picture_depth(&depth);
    struct picture out = render(c, &in, &d, &p);
    const double before = display_psnr(&in, &want), after = display_psnr(&out, &want);
    CHECK_MSG(after > before + 3, "%s: %.2f dB from the truth, and %.2f dB without blur", scene, after, before);
    CHECK_MSG(after >= was - 0.2, "%s: %.2f dB from the truth, it was %.2f", scene, after, was);
    picture_free(&in);
    picture_free(&depth);
    picture_free(&want);
    picture_free(&out);
}

// ---- the default look, for any source of the radius ----

static struct picture at_radius(struct hf_context *c, const struct picture *colour, const struct picture *radii,
                                float radius)
{
    struct hf_params p = hf_default_params();
    struct picture out = picture_new(colour->width, colour->height, 3);
    const struct hf_image src = picture_image(colour), dst = picture_image(&out);
    struct hf_depth depth = picture_depth(radii);
    depth.type = HF_DEPTH_COC;
    p.max_radius = radius;
    CHECK_INT(hf_render(c, &dst, &src, &depth, &p), HF_OK);
    return out;
}

// How far from a quad's middle half of its brightest pixel's value is reached, along (dx, dy).
static double half_reach(const struct picture *p, int x, int y, int dx, int dy)
{
    const double most = p->plane[1][y * p->width + x];
    double before = most;
    for (int i = 1; i < 40; i++) {
        const double now = p->plane[1][(y + i * dy) * p->width + x + i * dx];
        if (now < most / 2)
            return (i - 1 + (before - most / 2) / (before - now)) * sqrt(dx * dx + dy * dy) + 0.5 * sqrt(dx + dy);
        before = now;
    }
    return 40;
}

// A square of half side r reaches 0.41 r farther along the diagonal. The bound, a fifth of r plus a quarter of a pixel
// for linear interpolation on the half-resolution grid, is less than that from radius 2 on.
static void round_highlights(struct hf_context *c)
{
    struct picture colour = picture_new(96, 96, 3), radii = picture_new(96, 96, 1);
    for (int k = 0; k < 12; k++)
        colour.plane[k / 4][(48 + k / 2 % 2) * 96 + 48 + k % 2] = 1000;
    for (float radius = 2; radius <= 16; radius += 2) {
        picture_fill(&radii, 0, radius);
        struct picture out = at_radius(c, &colour, &radii, radius);
        const double axis = half_reach(&out, 49, 49, 1, 0), diagonal = half_reach(&out, 49, 49, 1, 1);
        CHECK_MSG(fabs(axis - diagonal) <= 0.1 * radius + 0.25,
                  "radius %g: %.2f along the axis, %.2f along the diagonal", (double)radius, axis, diagonal);
        picture_free(&out);
    }
    picture_free(&colour);
    picture_free(&radii);
}

static double energy(const struct picture *p)
{
    double sum = 0;
    for (int i = 0; i < p->width * p->height; i++)
        sum += p->plane[1][i];
    return sum;
}

// A light of 1.4 pixels that leaves the frame: at most half of its disc lies inside, and may count twice.
static void leaving_light(struct hf_context *c)
{
    struct picture colour = picture_new(96, 96, 3), radii = picture_new(96, 96, 1);
    double inside = 0, most = 0;
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 60; i++) {
            const double left = 10 - 0.2 * i;
            for (int x = 0; x < 96; x++)
                colour.plane[1][48 * 96 + x] = (float)(1000 * fmax(fmin(x + 1, left + 1.4) - fmax(x, left), 0));
            picture_fill(&radii, 0, 12.0f * (float)side);
            struct picture out = at_radius(c, &colour, &radii, 12);
            inside = i == 0 ? energy(&out) : inside;
            most = fmax(most, energy(&out) / inside);
            picture_free(&out);
        }
    CHECK_MSG(most <= 2, "a light that leaves the frame becomes %g times as bright", most);
    picture_free(&colour);
    picture_free(&radii);
}

// A near bar of 1.4 pixels, lit by the part of each pixel that it covers, moves 0.1 pixel a frame. Depth has no parts
// of pixels, so one or two columns are near, and colours mixed with the black behind belong to either. One column more
// or less changes the near light by its mixed part, up to 0.4 of 1.4, 29 % of the light.
static void thin_bar(struct hf_context *c)
{
    struct picture colour = picture_new(96, 96, 3), radii = picture_new(96, 96, 1);
    double least = INFINITY, most = 0;
    for (int i = 0; i < 40; i++) {
        const double left = 40 + 0.1 * i;
        for (int k = 0; k < 96 * 96; k++) {
            const int x = k % 96;
            colour.plane[1][k] = (float)fmax(fmin(x + 1, left + 1.4) - fmax(x, left), 0);
            radii.plane[0][k] = x + 0.5 >= left && x + 0.5 < left + 1.4 ? -12 : 0;
        }
        struct picture out = at_radius(c, &colour, &radii, 12);
        least = fmin(least, energy(&out));
        most = fmax(most, energy(&out));
        picture_free(&out);
    }
    CHECK_MSG((most - least) / most <= 0.29, "a thin near bar flickers by %.1f %%", 100 * (most - least) / most);
    printf("a thin near bar flickers by %.1f %%\n", 100 * (most - least) / most);
    picture_free(&colour);
    picture_free(&radii);
}

// A dark near bar before a bright wall, both out of focus by different radii: from its middle outwards it only gets
// brighter. The tolerance of half a display code, 1/510, is for the upsampling of a slope.
static void near_bar(struct hf_context *c)
{
    enum { COLUMN = WIDTH / 2, END = WIDTH - 40 };
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radii = picture_new(WIDTH, HEIGHT, 1);
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        const int bar = abs(k % WIDTH - COLUMN) < 10;
        colour.plane[1][k] = !bar;
        radii.plane[0][k] = bar ? -24 : 9;
    }
    struct picture out = at_radius(c, &colour, &radii, HF_DERIVE);
    const float *row = out.plane[1] + MIDDLE * WIDTH;
    float most = 0, back = 0;
    for (int x = COLUMN; x < END; x++) {
        most = fmaxf(most, row[x]);
        back = fmaxf(back, most - row[x]);
    }
    CHECK_MSG(back <= 1 / 510.0f, "beside a near bar a line is %g brighter than what is farther out", (double)back);
    CHECK(row[END] > 0.99f && row[COLUMN] < 0.8f);
    struct picture *const made[] = {&colour, &radii, &out};
    for (int i = 0; i < 3; i++)
        picture_free(made[i]);
}

// What is hidden behind a near bar continues what is visible nearest to its edge: here 8 columns of black, then white.
// In the half disc of radius 30 beyond the edge, 8 columns are a third of the area; weighted by the inverse eighth power
// of the distance they are almost all.
static void nearest_behind(struct hf_context *c)
{
    struct hf_params p = lens_params();
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radii = picture_new(WIDTH, HEIGHT, 1);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        radii.plane[0][i] = i % WIDTH < EDGE ? -NEAR : 0;
        for (int k = 0; k < 3; k++)
            colour.plane[k][i] = i % WIDTH < EDGE || i % WIDTH >= EDGE + 8;
    }
    // Half of the bar's colour is left at its edge, and the background fills the rest. White beyond the 8 columns is at
    // least twice as far away as their middle, and counts less than half of it.
    const struct hf_depth depth = picture_radii(&radii);
    struct picture out = render(c, &colour, &depth, &p);
    const float v = out.plane[1][MIDDLE * WIDTH + EDGE - 1];
    CHECK_MSG(v > 0.4f && v < 0.75f, "behind the edge of a near bar the nearest is black, but it shows %g", (double)v);
    struct picture *const made[] = {&colour, &radii, &out};
    for (int i = 0; i < 3; i++)
        picture_free(made[i]);
}

// A light of 4 x 4 pixels of radius 16 before a wall of radius 22. Its disc is flat up to 7 pixels from its middle: its
// radius times the step between levels, less the reach of its corner and of upsampling. The wall's discs are there too,
// with a hole. All weights are equal wherever all of the light is visible, within some 50 roundings.
static void flat_highlight(struct hf_context *c)
{
    enum { X = WIDTH / 2, REACH = 7 };
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radii = picture_new(WIDTH, HEIGHT, 1);
    picture_fill(&radii, 0, 22);
    for (int k = 0; k < 16; k++) {
        const int at = (MIDDLE - 2 + k / 4) * WIDTH + X - 2 + k % 4;
        radii.plane[0][at] = 16;
        colour.plane[1][at] = 1000;
    }
    struct picture out = at_radius(c, &colour, &radii, HF_DERIVE);
    float least = INFINITY, most = 0;
    for (int y = -REACH; y < REACH; y++)
        for (int x = -REACH; x < REACH; x++) {
            const float v = out.plane[1][(MIDDLE + y) * WIDTH + X + x];
            if ((x + 0.5) * (x + 0.5) + (y + 0.5) * (y + 0.5) < REACH * REACH) {
                least = fminf(least, v);
                most = fmaxf(most, v);
            }
        }
    CHECK_MSG(most - least <= most * 50 * 6e-8f, "a highlight is %g and %g inside", (double)least, (double)most);
    struct picture *const made[] = {&colour, &radii, &out};
    for (int i = 0; i < 3; i++)
        picture_free(made[i]);
}

// A light of 3 x 3 pixels of radius 16, in quads of which it fills a part, before a black wall of radius 40. Its disc is its
// own: the kernel around 16 ends at 16.4 pixels, the light 1.5 beside its middle, and the lattice and upsampling reach 2
// each. With the wall's radius the quads at its rim reached 40.
static void disc_before_wall(struct hf_context *c)
{
    enum { X = WIDTH / 2 + 1, REACH = 22 };
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radii = picture_new(WIDTH, HEIGHT, 1);
    picture_fill(&radii, 0, 40);
    for (int k = 0; k < 9; k++) {
        const int at = (MIDDLE + k / 3) * WIDTH + X - 1 + k % 3;
        radii.plane[0][at] = 16;
        colour.plane[1][at] = 1000;
    }
    struct picture out = at_radius(c, &colour, &radii, HF_DERIVE);
    double inside = 0, outside = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const int x = i % WIDTH - X, y = i / WIDTH - MIDDLE - 1;
        *(x * x + y * y <= REACH * REACH ? &inside : &outside) += out.plane[1][i];
    }
    CHECK_MSG(inside > 0 && outside <= 1e-6 * inside, "of a light's disc %g lies inside of it, %g outside", inside,
              outside);
    struct picture *const made[] = {&colour, &radii, &out};
    for (int i = 0; i < 3; i++)
        picture_free(made[i]);
}

// A light of 2 x 2 pixels on the frame's lowest rows, in a disc of radius 9 whose lower half lies outside. 16 of 1000
// remains, times two for the missing half, and times two for upsampling.
static void no_speck(struct hf_context *c)
{
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radii = picture_new(WIDTH, HEIGHT, 1);
    picture_fill(&radii, 0, 9);
    for (int k = 0; k < 4; k++)
        colour.plane[1][(HEIGHT - 2 + k / 2) * WIDTH + EDGE + k % 2] = 1000;
    struct picture out = at_radius(c, &colour, &radii, HF_DERIVE);
    float most = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        most = fmaxf(most, out.plane[1][i]);
    CHECK_MSG(most < 64, "at the frame's edge a light of 1000 leaves a speck of %g", (double)most);
    struct picture *const made[] = {&colour, &radii, &out};
    for (int i = 0; i < 3; i++)
        picture_free(made[i]);
}

// A bar that continues beyond the frame covers as much at its edge as inside. At the edge half of a disc is visible;
// its middle row is 2 R of pi R^2 / 2 + R, R being half the radius, and half as much of a whole disc. So a difference
// of rows, at most 1, counts by R / (pi R^2 / 2 + R). A quarter more is for discs made of pixels.
static void bar_at_border(struct hf_context *c, float max_radius)
{
    enum { LEFT = 140, RIGHT = 180, BAR_RADIUS = 24 };
    const float h = BAR_RADIUS / 2, bound = 1.25f * h / ((float)M_PI * h * h / 2 + h);
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radii = picture_new(WIDTH, HEIGHT, 1);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const int bar = i % WIDTH >= LEFT && i % WIDTH < RIGHT;
        colour.plane[1][i] = (float)bar;
        radii.plane[0][i] = bar ? -BAR_RADIUS : 0;
    }
    struct picture out = at_radius(c, &colour, &radii, max_radius);
    for (int edge = 0; edge < 2; edge++)
        for (int x = 0; x < WIDTH; x++) {
            const float at = out.plane[1][edge * (HEIGHT - 1) * WIDTH + x], within = out.plane[1][MIDDLE * WIDTH + x];
            if (!CHECK_MSG(fabsf(at - within) <= bound, "at column %d a bar is %g at the frame's edge, %g within", x,
                           (double)at, (double)within))
                break;
        }
    struct picture *const made[] = {&colour, &radii, &out};
    for (int i = 0; i < 3; i++)
        picture_free(made[i]);
}

// A lamp beside a near bar: its own disc, of radius 6, does not reach over the bar. What shows through the bar comes
// from the lamp's surroundings, and is at most 4 times as bright as without the lamp.
static void no_ring(struct hf_context *c)
{
    static const float WALL = 0x1p-10f;
    struct hf_params p = lens_params();
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radii = picture_new(WIDTH, HEIGHT, 1);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        radii.plane[0][i] = i % WIDTH < EDGE ? -NEAR : FAR;
        colour.plane[1][i] = i % WIDTH < EDGE ? 0 : WALL;
    }
    for (int k = 0; k < 16; k++)
        colour.plane[1][(MIDDLE + k / 4) * WIDTH + EDGE + 10 + k % 4] = 1000;
    const struct hf_depth depth = picture_radii(&radii);
    p.view.display_height = 720;
    struct picture out = render(c, &colour, &depth, &p);
    float most = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        most = i % WIDTH < EDGE - 6 ? fmaxf(most, out.plane[1][i]) : most;
    // 50 roundings.
    CHECK_MSG(most > 0 && most <= 4 * WALL * (1 + 50 * 6e-8f), "a lamp beside a bar shows through it: %g",
              (double)most);
    struct picture *const made[] = {&colour, &radii, &out};
    for (int i = 0; i < 3; i++)
        picture_free(made[i]);
}

int main(int argc, char **argv)
{
    struct hf_context *c = NULL;
    if (!CHECK_INT(hf_open(&c, NULL), HF_OK))
        return check_report();
    own_radii(c);
    small_radii(c);
    round_highlights(c);
    leaving_light(c);
    thin_bar(c);
    near_bar(c);
    nearest_behind(c);
    flat_highlight(c);
    disc_before_wall(c);
    no_speck(c);
    no_ring(c);
    bar_at_border(c, HF_DERIVE);
    bar_at_border(c, 24);
    if (argc > 1) {
        truth(c, argv[1], "lights", 5, 0.37f, 26.00);
        truth(c, argv[1], "fence", 6, 0.46f, 32.65);
        truth(c, argv[1], "foliage", 4, 0.7f, 33.27);
    }
    hf_close(&c);
    return check_report();
}
