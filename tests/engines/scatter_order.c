// SPDX-License-Identifier: BSD-3-Clause
// The scatter engine: occlusion. Nothing shows through a surface, and nothing pops where one field ends and the next
// begins. On one instruction set: the others have the same bits (scatter.c).
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "support/check.h"
#include "support/render.h"

enum { WIDTH = 96, HEIGHT = 64, PIXELS = WIDTH * HEIGHT };

static const double U = FLT_EPSILON / 2;

// A bright surface just in front of the focus, before black far away: inside it nothing is darker. Farther inside than
// a sprite reaches it covers fully, except at the frame's edge, where the outside is estimated; 16 roundings.
static void opaque_inside(struct hf_context *c)
{
    static const float radii[] = {-0.6f, -0.75f, -1, -1.4f, -2};
    for (int i = 0; i < 5; i++) {
        struct picture colour = picture_new(WIDTH, HEIGHT, 3), radius = picture_new(WIDTH, HEIGHT, 1);
        for (int k = 0; k < PIXELS; k++) {
            const int in = k % WIDTH < WIDTH / 2;
            radius.plane[0][k] = in ? radii[i] : 24;
            for (int ch = 0; ch < 3; ch++)
                colour.plane[ch][k] = in ? 1 : 0;
        }
        struct picture out = render_radii(c, HF_ENGINE_SCATTER, &colour, &radius, 0);
        float least = 1;
        for (int k = 0; k < PIXELS; k++)
            if (k % WIDTH > 3 && k % WIDTH < WIDTH / 2 - 4 && k / WIDTH > 3 && k / WIDTH < HEIGHT - 4)
                least = fminf(least, out.plane[0][k]);
        CHECK_MSG(least >= 1 - 16 * U, "radius %g before black: %g inside", (double)radii[i], (double)least);
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
}

// The largest change of any sample between two renders whose radii differ by next to nothing.
static double jump(struct hf_context *c, const struct picture *colour, struct picture *radius, float r, int half)
{
    struct picture out[2];
    double worst = 0;
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < PIXELS; k++)
            if (radius->plane[0][k] != 24)
                radius->plane[0][k] = r + (i ? 1e-5f : -1e-5f);
        out[i] = render_radii(c, HF_ENGINE_SCATTER, colour, radius, half);
    }
    for (int ch = 0; ch < 3; ch++)
        for (int k = 0; k < PIXELS; k++)
            worst = worse(worst, fabs((double)out[0].plane[ch][k] - out[1].plane[ch][k]));
    picture_free(&out[0]);
    picture_free(&out[1]);
    return worst;
}

// Noise of 0 to 1 beside noise far away. A sprite's last rows weigh 128ths: at radius 1.25, the smallest one here where
// its size steps, a row is 0.3 of it. Nothing pops by more.
static void thresholds(struct hf_context *c)
{
    static const float radii[] = {-2.5f, -1.5f, -0.5f, 0, 0.5f, 1.5f, 2.5f};
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radius = picture_new(WIDTH, HEIGHT, 1);
    struct rng rng = rng_seed(3);
    for (int k = 0; k < PIXELS; k++) {
        radius.plane[0][k] = k % WIDTH < WIDTH / 2 || k / WIDTH < HEIGHT / 2 ? 24 : 0;
        for (int ch = 0; ch < 3; ch++)
            colour.plane[ch][k] = rng_float(&rng);
    }
    for (int half = 0; half < 2; half++)
        for (int i = 0; i < 7; i++) {
            const double worst = jump(c, &colour, &radius, radii[i], half);
            CHECK_MSG(worst <= 0.3 / 16, "%s resolution, radius %g: a step of 2e-5 changes a sample by %.3g",
                      half ? "half" : "full", (double)radii[i], worst);
        }
    picture_free(&colour);
    picture_free(&radius);
}

// A bar in front of a black, sharp background is spread over its surroundings exactly once. Of its light all is left
// except what rounding and 16ths of a row lose.
static void drawn_once(struct hf_context *c)
{
    static const float radii[] = {-2, -5, -11};
    static const int widths[] = {1, 3, 6};
    for (int i = 0; i < 18; i++) {
        const int width = widths[i / 3 % 3], half = i / 9;
        struct picture colour = picture_new(WIDTH, HEIGHT, 3), radius = picture_new(WIDTH, HEIGHT, 1);
        double in = 0, sum = 0;
        for (int y = 20; y < HEIGHT - 20; y++)
            for (int x = WIDTH / 2; x < WIDTH / 2 + width; x++) {
                radius.plane[0][y * WIDTH + x] = radii[i % 3];
                colour.plane[0][y * WIDTH + x] = 1;
                in++;
            }
        struct picture out = render_radii(c, HF_ENGINE_SCATTER, &colour, &radius, half);
        for (int k = 0; k < PIXELS; k++)
            sum += out.plane[0][k];
        CHECK_MSG(fabs(sum / in - 1) <= 1e-4, "radius %g, a bar %d wide, %s resolution: %g of its light",
                  (double)radii[i % 3], width, half ? "half" : "full", sum / in);
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
}

// Crossing bars, and one sharp bar, before a flat wall far away. The wall stays the same away from the bars, and behind
// them. The bars are black, so the result is the wall's share, nowhere less than a bar's sprite leaves.
static void crossing_bars(struct hf_context *c)
{
    for (int sharp = 0; sharp < 2; sharp++) {
        struct picture colour = picture_new(WIDTH, HEIGHT, 3), radius = picture_new(WIDTH, HEIGHT, 1);
        for (int k = 0; k < PIXELS; k++) {
            const int bar = abs(k % WIDTH - WIDTH / 2) < 5 || abs(k / WIDTH - HEIGHT / 2) < 5;
            radius.plane[0][k] = bar ? -12 : sharp ? 0 : 4;
            colour.plane[0][k] = bar ? 0 : 1;
        }
        struct picture out = render_radii(c, HF_ENGINE_SCATTER, &colour, &radius, 0);
        // Two bars 9 wide cover at most 18 x 24 - 81 of a disc of 452 where they cross: 0.78. The old star was fully
        // black.
        const float middle = out.plane[0][HEIGHT / 2 * WIDTH + WIDTH / 2];
        CHECK_MSG(middle > 0.2f && middle < 0.5f, "%s wall: %g of it where bars cross", sharp ? "sharp" : "blurred",
                  (double)middle);
        // Across a bar only its own sprite changes: there is no seam in the middle of it.
        for (int x = WIDTH / 2 - 6; x < WIDTH / 2 + 6; x++) {
            const float *row = out.plane[0] + 13 * WIDTH;
            CHECK_MSG(fabsf(row[x + 1] - row[x]) < 0.1f, "%s wall: from %g to %g at column %d of a bar",
                      sharp ? "sharp" : "blurred", (double)row[x], (double)row[x + 1], x);
        }
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
}

// A light of radius 12 beside a nearer wall of a quarter of that radius. Inside the wall's own blur the wall covers all
// that is behind it: slices begin at 4 and are complete at 5, so only rounding is left there.
static void hides_light(struct hf_context *c)
{
    enum { W = 96, H = 64, EDGE = 48, BLUR = 3 };
    struct picture colour = picture_new(W, H, 3), radii = picture_new(W, H, 1);
    for (int i = 0; i < W * H; i++)
        radii.plane[0][i] = i % W < EDGE ? BLUR : 4 * BLUR;
    for (int ch = 0; ch < 3; ch++)
        colour.plane[ch][H / 2 * W + EDGE + 4] = 1e4f;
    struct picture out = render_radii(c, HF_ENGINE_SCATTER, &colour, &radii, 0);
    double on_wall = 0, all = 0;
    for (int i = 0; i < W * H; i++) {
        all += out.plane[1][i];
        on_wall += i % W < EDGE - BLUR - 2 ? out.plane[1][i] : 0;
    }
    CHECK_MSG(on_wall <= 1e-5 * all, "%.3g of a light's energy lie on a nearer wall", on_wall / all);
    picture_free(&out);
    picture_free(&colour);
    picture_free(&radii);
}

int main(void)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    opaque_inside(c);
    thresholds(c);
    drawn_once(c);
    crossing_bars(c);
    hides_light(c);
    hf_close(&c);
    return check_report();
}
