// SPDX-License-Identifier: BSD-3-Clause
// The gather's levels of large near areas, whose taps have a step of 2 or 4: against the formulas in double precision, and the
// same bits from every instruction set.
#include <math.h>
#include <stdio.h>

#include "support/check.h"
#include "support/reference.h"
#include "support/render.h"

// Radii of up to 64 pixels: at half resolution the largest level has one of 32, and taps that reach 35. A frame whose half is no
// wider than that would have them cut, without a step.
enum { WIDTH = 120, HEIGHT = 102 };
static const float RADIUS = 64;

static struct hf_params steps_params(void)
{
    struct hf_params p = scene_params();
    p.engine = HF_ENGINE_GATHER;
    p.max_radius = RADIUS;
    p.gather.per_pixel_kernel = 1;
    return p;
}

// Blocks of all radii: near and sharp ones on the left, far ones too on the right. Some scenes have alpha.
static struct scene steps_scene(unsigned seed)
{
    struct rng rng = rng_seed(seed);
    struct scene s =
        scene_new(&rng, seed % 2 ? SCENE_HIGHLIGHTS : SCENE_BLOCKS, WIDTH, HEIGHT, 3 + (int)(seed / 2 % 2));
    for (int y = 0; y < HEIGHT; y += 6)
        for (int x = 0; x < WIDTH; x += 10) {
            const float part = rng_range(&rng, -1, 1), r = (x < WIDTH / 2 ? -fabsf(part) : part) * RADIUS;
            for (int k = 0; k < 60; k++)
                s.depth.plane[0][(y + k / 10) * WIDTH + x + k % 10] = fabsf(part) < 0.1f ? 0 : r;
        }
    return s;
}

// Weights of a disc of 8 steps of 4 are whole multiples of 2^-7, and those of about 60 points at its rim are between 0 and 1: each
// is wrong by up to 2^-8 of the 201 that they sum up to. What is rounded on the way is less (tests/stability/rounding.c).
static void against_double(struct hf_context *c)
{
    const double most = 60 * 0x1p-8 / 201;
    for (unsigned seed = 1; seed <= 2; seed++) {
        struct scene s = steps_scene(seed);
        const struct hf_depth depth = picture_radii(&s.depth);
        const struct hf_params p = steps_params();
        struct reference *ref = reference_render(&s.colour, &depth, &p, NULL, NULL);
        struct picture want = reference_picture(ref), out = render(c, &s.colour, &depth, &p);
        const double worst = largest_difference(&out, &want) / largest_sample(&s.colour);
        printf("seed %u: %.3g of the largest sample from double precision, bound %.3g\n", seed, worst, most);
        CHECK_MSG(worst <= most, "seed %u: %g of the largest sample from double precision, bound %g", seed, worst,
                  most);
        reference_free(ref);
        picture_free(&want);
        picture_free(&out);
        scene_free(&s);
    }
}

// Also with blades, which do not mirror; wide pixels; Karis average; small tiles.
static void same_bits(enum hf_isa isa, struct hf_context *plain)
{
    for (unsigned i = 0; i < 8; i++) {
        struct hf_context *c = context_new(isa, 2, i % 2 ? 16 * (int)(1 + i % 3) : 0, i % 2 ? 20 + (int)i : 0);
        struct scene s = steps_scene(10 + i);
        const struct hf_depth depth = picture_radii(&s.depth);
        struct hf_params p = steps_params();
        p.run.deterministic = 1;
        p.max_radius = i % 4 == 3 ? 40 : RADIUS;
        p.aperture.blades = i % 4 == 1 ? 5 : 0;
        p.view.pixel_aspect = i % 4 == 2 ? 1.5f : 1;
        p.gather.karis = i > 3;
        struct picture want = render(plain, &s.colour, &depth, &p), out = render(c, &s.colour, &depth, &p);
        CHECK_MSG(picture_same_bits(&want, &out), "%s: case %u: %d samples are not plain C's", hf_isa_name(isa), i,
                  samples_other(&want, &out));
        picture_free(&want);
        picture_free(&out);
        scene_free(&s);
        hf_close(&c);
    }
}

// A lamp in focus beside what is near: the smallest level's sample of it counts (radius / 2)^6 times for what is wholly near. And
// what it adds stays in proportion to it.
static void bright_lamp(enum hf_isa isa, float radius)
{
    const float lamp = 0x1p100f;
    struct hf_context *c = context_new(isa, 2, 0, 0);
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radii = picture_new(WIDTH, HEIGHT, 1);
    struct hf_params p = steps_params();
    p.max_radius = radius;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            radii.plane[0][y * WIDTH + x] = x < WIDTH / 2 ? -radius : 0;
    for (int k = 0; k < 3; k++)
        picture_fill(&colour, k, 0);
    colour.plane[1][HEIGHT / 2 * WIDTH + WIDTH / 2] = lamp;
    const struct hf_depth depth = picture_radii(&radii);
    struct picture out = render(c, &colour, &depth, &p);
    colour.plane[1][HEIGHT / 2 * WIDTH + WIDTH / 2] = 1;
    struct picture dim = render(c, &colour, &depth, &p);
    int off = 0;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            off += out.plane[k][i] != lamp * dim.plane[k][i];  // also NaN
    CHECK_MSG(!off, "%s: radius %g: of %d samples, %d are not 2^100 times those of a lamp of 1", hf_isa_name(isa),
              (double)radius, 3 * WIDTH * HEIGHT, off);
    picture_free(&out);
    picture_free(&dim);
    picture_free(&colour);
    picture_free(&radii);
    hf_close(&c);
}

int main(void)
{
    struct hf_context *plain = context_new(HF_ISA_SCALAR, 2, 0, 0);
    against_double(plain);
    for (int isa = HF_ISA_SCALAR; isa <= HF_ISA_NEON; isa++)
        if (hf_isa_available((enum hf_isa)isa)) {
            same_bits((enum hf_isa)isa, plain);
            bright_lamp((enum hf_isa)isa, 110);
            bright_lamp((enum hf_isa)isa, 2048);
        }
    hf_close(&plain);
    return check_report();
}
