// SPDX-License-Identifier: BSD-3-Clause
// Reference: the sample positions of the gather.
#include <math.h>
#include <stdlib.h>

#include "support/reference.h"

static const double pi = 3.14159265358979323846;

// Sousa's polygon: the factor by which a radius shrinks at an angle.
static double polygon(const struct hf_params *p, double angle)
{
    if (p->aperture.blades == 0)
        return 1;
    const double n = p->aperture.blades;
    const double t = angle - p->aperture.rotation * pi / 180;
    return cos(pi / n) / cos(t - 2 * pi / n * floor((n * t + pi) / (2 * pi)));
}

static void add_tap(struct reference *r, double radius, double angle, double share)
{
    const double scaled = radius * polygon(&r->params, angle) * r->kernel_scale;
    r->tap_x[r->taps] = scaled * cos(angle) / r->params.view.pixel_aspect;
    r->tap_y[r->taps] = scaled * sin(angle);
    r->tap_share[r->taps] = share;
    r->shares += share;
    r->taps++;
}

static void add_rings(struct reference *r, int rings, double share)
{
    for (int k = 1; k <= rings; k++)
        for (int i = 0; i < 8 * k; i++)
            add_tap(r, r->reach_y * k / rings, 2 * pi * i / (8 * k), share);
    r->centre += share;
    r->shares += share;
}

// Rings two pixels apart. If that is not a whole number of rings, the two nearest numbers are blended, each as a mean.
static void make_rings(struct reference *r)
{
    const double apart = fmax(1, r->reach_y / 2);
    const int given = r->params.chapter.rings, rings = given > 0 ? given : (int)ceil(apart);
    const double more = given > 0 || r->params.chapter.faithful ? 1 : 1 - (rings - apart);
    const double all = 1 + 4 * rings * (rings + 1), fewer = 1 + 4 * rings * (rings - 1);
    add_rings(r, rings, more);
    if (more < 1)
        add_rings(r, rings - 1, (1 - more) * all / fewer);
}

// Shirley and Chiu: squares around the centre become circles.
static void make_grid(struct reference *r)
{
    for (int j = 0; j < 12; j++) {
        for (int i = 0; i < 12; i++) {
            const double a = 2 * (i + 0.5) / 12 - 1, b = 2 * (j + 0.5) / 12 - 1;
            double radius, angle;
            if (fabs(a) > fabs(b)) {
                radius = a;
                angle = pi / 4 * (b / a);
            } else {
                radius = b;
                angle = pi / 2 - pi / 4 * (a / b);
            }
            if (radius < 0) {
                radius = -radius;
                angle += pi;
            }
            add_tap(r, r->reach_y * radius, angle, 1);
        }
    }
}

void ref_make_taps(struct reference *r)
{
    r->tap_x = malloc(sizeof *r->tap_x * REF_MAX_TAPS);
    r->tap_y = malloc(sizeof *r->tap_y * REF_MAX_TAPS);
    r->tap_share = malloc(sizeof *r->tap_share * REF_MAX_TAPS);
    r->taps = 0;
    r->centre = r->shares = 0;
    if (r->params.chapter.fill == HF_FILL_NONE)
        make_grid(r);
    else
        make_rings(r);
}
