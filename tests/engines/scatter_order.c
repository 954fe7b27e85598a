// SPDX-License-Identifier: BSD-3-Clause
// The scatter engine: what lies before what. Nothing shows through a surface, and nothing pops where one field ends and
// the next begins. On one instruction set: the others have the same bits (scatter.c).
#include <float.h>
#include <math.h>

#include "support/check.h"
#include "support/render.h"

enum { WIDTH = 96, HEIGHT = 64, PIXELS = WIDTH * HEIGHT };

static const double U = FLT_EPSILON / 2;

static struct hf_params params_new(int half)
{
    struct hf_params p = scene_params();
    p.engine = HF_ENGINE_SCATTER;
    p.max_radius = HF_DERIVE;
    p.scatter.resolution = half ? HF_RESOLUTION_HALF : HF_RESOLUTION_FULL;
    return p;
}

// Blur with the signed radii that plane 0 of `radius` holds.
static struct picture blurred(struct hf_context *c, const struct picture *colour, const struct picture *radius,
                              int half)
{
    const struct hf_params p = params_new(half);
    const struct hf_depth depth = picture_radii(radius);
    return render(c, colour, &depth, &p);
}

// A bright surface that is hardly in front of the focus, before black far away: inside it nothing is darker. What is
// further in than a picture reaches is covered in full, but at the frame's edge, where what lies outside is estimated; 16
// roundings.
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
        struct picture out = blurred(c, &colour, &radius, 0);
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
        out[i] = blurred(c, colour, radius, half);
    }
    for (int ch = 0; ch < 3; ch++)
        for (int k = 0; k < PIXELS; k++)
            worst = worse(worst, fabs((double)out[0].plane[ch][k] - out[1].plane[ch][k]));
    picture_free(&out[0]);
    picture_free(&out[1]);
    return worst;
}

// Noise beside noise far away: 2e-5 pixels of radius may change a sample by a few times that share of its range, which is
// 1, and sizes come in steps of 0.4 % in radius, 0.8 % of what a picture covers. Nothing pops beyond that.
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
            CHECK_MSG(worst <= 0.01, "%s resolution, radius %g: a step of 2e-5 changes a sample by %.3g",
                      half ? "half" : "full", (double)radii[i], worst);
        }
    picture_free(&colour);
    picture_free(&radius);
}

int main(void)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    opaque_inside(c);
    thresholds(c);
    hf_close(&c);
    return check_report();
}
