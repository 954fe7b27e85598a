// SPDX-License-Identifier: BSD-3-Clause
// Apertures of the layers engine: single highlights compared with those of the scatter, a cat's eye that changes with
// its place without a jump, and opaque surfaces with it.
//
//     layers_aperture
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/render.h"

static const float LAMP = 1e4f, AROUND = 0.1f;

// The measures of a highlight: its energy, its centre, its spread, and its orientation: the mean of (x + iy)^n within
// `reach`.
struct spot {
    double energy, x, y, xx, xy, yy, re, im;
};

static struct picture lamp_at(struct hf_context *c, const struct hf_params *p, float radius, int width, int height,
                              int x, int y)
{
    struct picture colour = picture_new(width, height, 3), radii = picture_new(width, height, 1);
    picture_fill(&radii, 0, radius);
    for (int k = 0; k < 3; k++) {
        picture_fill(&colour, k, AROUND);
        colour.plane[k][y * width + x] = LAMP;
    }
    const struct hf_depth depth = picture_radii(&radii);
    struct picture out = render(c, &colour, &depth, p);
    picture_free(&colour);
    picture_free(&radii);
    return out;
}

static struct spot spot_of(const struct picture *out, int channel, int x, int y, int n, double reach)
{
    struct spot s = {0};
    const float *v = out->plane[channel];
    for (int i = 0; i < out->width * out->height; i++) {
        const double w = v[i] - (double)AROUND;
        s.energy += w;
        s.x += w * (i % out->width - x);
        s.y += w * (i / out->width - y);
    }
    s.x /= s.energy;
    s.y /= s.energy;
    for (int i = 0; i < out->width * out->height; i++) {
        const double w = (v[i] - (double)AROUND) / s.energy, dx = i % out->width - x - s.x,
                     dy = i / out->width - y - s.y;
        double re = 1, im = 0;
        for (int k = 0; k < n; k++) {
            const double was = re;
            re = was * dx - im * dy;
            im = was * dy + im * dx;
        }
        s.xx += w * dx * dx;
        s.xy += w * dx * dy;
        s.yy += w * dy * dy;
        s.re += hypot(dx, dy) < reach ? w * re : 0;
        s.im += hypot(dx, dy) < reach ? w * im : 0;
    }
    return s;
}

struct shape {
    const char *name;
    struct hf_aperture_params aperture;
    int n;  // of its symmetry
};

// By how much the two engines may differ; r is the radius in pixels. Scatter's sizes are off by at most 0.2 %, those of
// pictures by half of a 32nd octave, 1.1 %. Its spans end at multiples of 1/256 and its rows are sampled: 0.05 pixels
// of a centre. Both draw slanted edges as rows of spans, which spreads a spot along x by less than a pixel; scatter's
// bilinear half resolution adds 2 / 3 of a square pixel. A spread of s square pixels along x changes the mean of (x +
// iy)^n by at most n (n - 1) / 2 s r^(n-2). With a cat's eye, layers takes the circle of the pixel drawn to and scatter
// that of the source. The two are apart by `apart` = 2 S r^2 / diagonal on the disc's rim, and so are edges; at most a
// half turn of length pi r is cut, of an area of at least r^2.
struct bound {
    double centre, energy, spread, turn;
};

static struct bound bound_of(const struct hf_aperture_params *a, double radius, int n, double diagonal)
{
    const double r = radius * fmax(1, 1 / a->squeeze), size = a->picture ? 0.011 : 0.002;
    const double apart = 2 * a->cat_eye * r * r / diagonal;
    return (struct bound){0.05 + apart + (a->picture ? size * r : 0), 1e-3 + 3.2 * apart / r,
                          2 + 2 * size * r * r + 2 * r * apart, n * (n - 1) / 2.0 * pow(r, n - 2)};
}

static void compare(const struct shape *s, float radius, int channel, const struct spot *want, const struct spot *got,
                    double diagonal)
{
    const struct bound b = bound_of(&s->aperture, fabsf(radius), s->n, diagonal);
    const double moved = hypot(got->x - want->x, got->y - want->y), energy = fabs(got->energy / want->energy - 1);
    const double spread = fabs(got->xx - want->xx) + fabs(got->xy - want->xy) + fabs(got->yy - want->yy);
    const double points = hypot(want->re, want->im), turned = hypot(got->re - want->re, got->im - want->im) / points;
    const double turn = b.turn / points + 0.002 * s->n;
    CHECK_MSG(moved <= b.centre, "%s of %g, channel %d: %g pixels away, bound %g", s->name, radius, channel, moved,
              b.centre);
    CHECK_MSG(energy <= b.energy, "%s of %g, channel %d: energy off by %g, bound %g", s->name, radius, channel, energy,
              b.energy);
    CHECK_MSG(spread <= b.spread, "%s of %g, channel %d: spread off by %g, bound %g", s->name, radius, channel, spread,
              b.spread);
    // Only where the bound means something.
    if (s->n > 1 && s->aperture.cat_eye == 0 && turn < 0.3)
        CHECK_MSG(turned <= turn, "%s of %g, channel %d: points elsewhere by %g, bound %g", s->name, radius, channel,
                  turned, turn);
}

static void against_scatter(struct hf_context *c)
{
    static float tee[3][48 * 48];
    struct hf_image picture = {
        sizeof picture, 48, 48, HF_FORMAT_PLANAR32F, HF_TRANSFER_LINEAR, {tee[0], tee[1], tee[2]}, {192, 192, 192}};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 48 * 48; i++)
            tee[k][i] = (i / 48 < 16 && i % 48 > 4) || abs(i % 48 - 26) < 6 ? 1.0f - 0.25f * (float)k : 0;
    const struct shape shapes[] = {{"disc", {.squeeze = 1}, 1},
                                   {"triangle", {.squeeze = 1, .blades = 3, .rotation = 20}, 3},
                                   {"pentagon", {.squeeze = 1, .blades = 5, .rotation = -7, .roundness = 0.3f}, 5},
                                   {"hexagon", {.squeeze = 1.5f, .blades = 6, .rotation = 11}, 6},
                                   {"ring", {.squeeze = 1, .ring = 0.6f}, 1},
                                   {"square ring", {.squeeze = 1, .blades = 4, .rotation = 5, .ring = 0.45f}, 4},
                                   {"chromatic", {.squeeze = 1, .blades = 3, .chromatic = 0.2f}, 3},
                                   {"picture", {.squeeze = 1, .picture = &picture}, 1},
                                   {"cat's eye", {.squeeze = 1, .cat_eye = 0.9f}, 1},
                                   {"cat's eye, squeezed", {.squeeze = 0.7f, .cat_eye = 0.6f}, 1},
                                   {"cat's eye, ring", {.squeeze = 1, .cat_eye = 0.8f, .ring = 0.5f}, 1},
                                   {"cat's eye, triangle", {.squeeze = 1, .cat_eye = 0.5f, .blades = 3}, 3}};
    static const float radii[] = {5.3f, 11, -14.7f, 24, -37.5f};
    const int width = 320, height = 240;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        for (size_t j = 0; j < sizeof radii / sizeof *radii; j++) {
            const struct shape *s = &shapes[i];
            struct hf_params p = scene_params();
            p.max_radius = HF_DERIVE;
            p.aperture = s->aperture;
            const int x = j % 2 ? 90 : 215, y = j % 3 ? 80 : 155;
            p.engine = HF_ENGINE_SCATTER;
            struct picture a = lamp_at(c, &p, radii[j], width, height, x, y);
            p.engine = HF_ENGINE_LAYERS;
            struct picture b = lamp_at(c, &p, radii[j], width, height, x, y);
            for (int k = 0; k < 3; k++) {
                const double reach = 1.5 * fabsf(radii[j]) + 3;
                const struct spot want = spot_of(&a, k, x, y, s->n, reach), got = spot_of(&b, k, x, y, s->n, reach);
                compare(s, radii[j], k, &want, &got, hypot(width, height));
            }
            picture_free(&a);
            picture_free(&b);
        }
}

// Highlights of lamps a pixel apart differ in each pixel by no more than the circle has moved, also across nodes of the
// blend and borders of cells and tiles. A row's half-width is the circle's mean over a pixel's height. If the circle
// moves by t along columns, it changes by t times the difference of half-widths a pixel apart, at most sqrt(2 r) at its
// top; along rows it changes by t. The sum of weights changes by less than t. Full resolution, because coarser pixels
// would make lamps differ by their place in them.
static void continuous(struct hf_context *c)
{
    const int width = 300, height = 200;
    struct hf_params p = scene_params();
    p.engine = HF_ENGINE_LAYERS;
    p.max_radius = HF_DERIVE;
    p.aperture.cat_eye = 1;
    p.layers.half_from = p.layers.quarter_from = 64;
    for (int n = 0; n < 2; n++) {
        const float r = n ? -12 : 9;
        const double moves = 2 * fabsf(r) / hypot(width, height), bound = moves * (sqrt(2 * fabsf(r)) + 1);
        double worst = 0, brightest = 0;
        struct picture last = {0};
        for (int i = 0; i < 40; i++) {
            const int x = n ? 230 : 236 + i, y = n ? 95 + i : 150;
            struct picture out = lamp_at(c, &p, r, width, height, x, y);
            for (int dy = -15; i && dy <= 15; dy++)
                for (int dx = -15; dx <= 15; dx++) {
                    const float a = out.plane[1][(y + dy) * width + x + dx];
                    const float b = last.plane[1][(y + dy - n) * width + x + dx - !n];
                    worst = fmax(worst, fabs((double)a - b));
                    brightest = fmax(brightest, a);
                }
            picture_free(&last);
            last = out;
        }
        picture_free(&last);
        printf("cat's eye of %g: a pixel changes by %.3f of the brightest, bound %.3f\n", r, worst / brightest, bound);
        CHECK_MSG(worst <= bound * brightest, "radius %g: a pixel changes by %g of %g, bound %g", r, worst, brightest,
                  bound * brightest);
    }
}

// A near surface shows nothing of its background far from its edge, with any aperture.
static void opaque(struct hf_context *c)
{
    const int width = 260, height = 180;
    struct picture colour = picture_new(width, height, 4), radii = picture_new(width, height, 1);
    for (int i = 0; i < width * height; i++) {
        const int near = i % width >= 60;
        radii.plane[0][i] = near ? -20 : 20;
        for (int k = 0; k < 3; k++)
            colour.plane[k][i] = near ? 0 : 1e4f;
        colour.plane[3][i] = 1;
    }
    for (int n = 0; n < 6; n++) {
        struct hf_params p = scene_params();
        const struct hf_depth depth = picture_radii(&radii);
        p.engine = HF_ENGINE_LAYERS;
        p.max_radius = HF_DERIVE;
        p.aperture.cat_eye = n % 3 == 1 ? 1 : 0;
        p.aperture.blades = n < 3 ? 0 : 3;
        p.aperture.ring = n % 3 == 2 ? 0.7f : 0;
        struct picture out = render(c, &colour, &depth, &p);
        double leaks = 0;
        int alpha = 1;
        for (int i = 0; i < width * height; i++) {
            leaks = i % width >= 110 ? fmax(leaks, fabs(out.plane[0][i])) : leaks;
            alpha &= out.plane[3][i] == 1;
        }
        CHECK_MSG(leaks <= 1e4 * 4e-6, "case %d: %g of 1e4 shows through", n, leaks);
        CHECK_MSG(alpha, "case %d: alpha is not 1", n);
        picture_free(&out);
    }
    picture_free(&colour);
    picture_free(&radii);
}

// A shape that covers little of its square has large weights for its samples, 20 and more. Their sums are finite for
// the largest floats too.
static void largest_floats(struct hf_context *c)
{
    struct picture colour = picture_new(40, 24, 4), radii = picture_new(40, 24, 1);
    struct hf_params p = hf_default_params();
    p.engine = HF_ENGINE_LAYERS;
    p.aperture.blades = 3;
    p.aperture.ring = 0.95f;
    p.aperture.squeeze = 4;
    for (int k = 0; k < 4; k++)
        picture_fill(&colour, k, k == 2 ? -FLT_MAX : FLT_MAX);
    for (float radius = 0.25f; radius < 4; radius *= 1.5f) {
        picture_fill(&radii, 0, radius);
        const struct hf_depth depth = picture_radii(&radii);
        struct picture out = render(c, &colour, &depth, &p);
        CHECK_MSG(all_finite(&out), "radius %g of the largest floats is not finite", (double)radius);
        picture_free(&out);
    }
    picture_free(&colour);
    picture_free(&radii);
}

int main(void)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    against_scatter(c);
    continuous(c);
    opaque(c);
    largest_floats(c);
    hf_close(&c);
    return check_report();
}
