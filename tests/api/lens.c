// SPDX-License-Identifier: BSD-3-Clause
// The lens: signed radii against the form in which White and Barre-Brisebois's hexagonal blur gives CoC, for a depth
// d of 0 at the near plane to 1 at the far one,
//     CoC(d) = d scale + bias,  scale = A L P (zf - zn) / ((P - L) zn zf),  bias = A L (zn - P) / ((P - L) zn),
// a diameter on the sensor of a lens that breathes: A its aperture's diameter, L its focal length, P the distance in
// focus, all in one unit. The radius in pixels of a picture W wide, with a field of view that does not breathe, is
//     r = CoC / 2 (P - L) / P W / sensor.
#include <math.h>
#include <stdio.h>

#include "support/check.h"
#include "engine/hexagon/kernels.h"
#include "frame/resolve.h"
#include "pass/check.h"

enum { N = 1001 };

struct lens {
    float focal_mm, f_number, sensor_mm, unit, focus, near, far;
    int width;
};

static const struct lens lenses[] = {
    {50, 2.8f, 36, 1, 10, 0.1f, 100, 1920}, {85, 1.4f, 36, 1, 2, 0.5f, 50, 1280},
    {24, 8, 23.5f, 1, 3, 0.05f, 1000, 640}, {35, 2, 36, 0.01f, 250, 10, 20000, 1920},
    {200, 4, 36, 1, 30, 1, 500, 4096},      {8, 1.8f, 6.4f, 1, 0.5f, 0.1f, 20, 800},
};

static void radii_of(const struct lens *l, enum hf_depth_type type, const float *depth, float *out)
{
    static float colour[3 * N];
    const struct hf_image image = {.size = sizeof image,
                                   .width = N,
                                   .height = 1,
                                   .format = HF_FORMAT_RGB32F,
                                   .data = {colour},
                                   .stride = {sizeof colour}};
    const struct hf_depth d = {.size = sizeof d,
                               .data = depth,
                               .stride = N * sizeof(float),
                               .type = type,
                               .near_plane = l->near,
                               .far_plane = l->far};
    struct hf_params p = hf_default_params();
    p.engine = HF_ENGINE_HEXAGON;
    p.model = HF_MODEL_LENS;
    p.focus = l->focus;
    p.lens.focal_length_mm = l->focal_mm;
    p.lens.f_number = l->f_number;
    p.lens.sensor_width_mm = l->sensor_mm;
    p.lens.world_unit_m = l->unit;
    p.view.display_width = l->width;
    struct hf_message message;
    struct hf_setup s;
    struct hf_settings r;
    struct hf_pixel_kernels k;
    struct hf_hexagon own = {0};
    struct hf_counts counts = {0};
    CHECK_MSG(hf_params_resolve(&r, N, 1, &d, &p, &message) == HF_OK, "%s", message.sentence);
    hf_setup_make(&s, &image, &image, &d, &r, &own);
    hf_pixel_kernels_init(&k, HF_ISA_SCALAR, 0);
    const struct hf_frame f = {.s = &s, .k = &k, .src = &image, .dst = &image, .depth = &d, .counts = &counts};
    k.radius_row(&f, 0, 0, N, out, &counts);
}

// Rounding: d scale and bias cancel at the focus, so errors are relative to the larger of the radius and its limit far
// away, which is bias + scale with an infinite far plane.
static void test_same_curve(const struct lens *l)
{
    static float depth[N], got[N];
    for (int i = 0; i < N; i++)
        depth[i] = (float)i / (N - 1);
    radii_of(l, HF_DEPTH_NDC_D3D, depth, got);
    const double length = l->focal_mm / 1000.0 / l->unit, a = length / l->f_number, p = l->focus;
    const double zn = l->near, zf = l->far;
    const double scale = a * length * p * (zf - zn) / ((p - length) * zn * zf);
    const double bias = a * length * (zn - p) / ((p - length) * zn);
    const double to_pixels = 0.5 * (p - length) / p * l->width / (l->sensor_mm / 1000.0 / l->unit);
    const double far = a * length / p / (1 - length / p) * to_pixels;
    for (int i = 0; i < N; i++) {
        const double want = (depth[i] * scale + bias) * to_pixels;
        const double most = 2048;  // the library's limit
        if (fabs(want) > most)
            CHECK_MSG(fabs(got[i]) == most, "radius %g where the limit is %g", got[i], most);
        else
            CHECK_MSG(fabs(got[i] - want) <= 1e-5 * fmax(fabs(want), far), "%g mm, d = %g: radius %.8g, want %.8g",
                      l->focal_mm, depth[i], got[i], want);
    }
}

// By distance: 0 in focus, negative in front, positive behind, and half of the limit at twice the distance.
static void test_focus(const struct lens *l)
{
    static float depth[N], got[N];
    for (int i = 0; i < N; i++)
        depth[i] = l->focus * 1.5f;
    depth[0] = l->focus;
    depth[1] = l->focus / 2;
    depth[2] = l->focus * 2;
    depth[3] = INFINITY;
    radii_of(l, HF_DEPTH_VIEW, depth, got);
    const double length = l->focal_mm / 1000.0 / l->unit;
    const double k = length / l->f_number / 2 * (l->focal_mm / l->sensor_mm * l->width) / l->focus;
    CHECK_MSG(got[0] == 0, "in focus the radius is %g", got[0]);
    CHECK_MSG(fabs(got[1] + k) <= 1e-5 * k, "at half the focus %g, want %g", got[1], -k);
    CHECK_MSG(fabs(got[2] - k / 2) <= 1e-5 * k, "at twice the focus %g, want %g", got[2], k / 2);
    CHECK_MSG(fabs(got[3] - k) <= 1e-5 * k, "at infinity %g, want %g", got[3], k);
}

// Focused at infinity, where 1 / focus is 0: -K / z, and 0 at infinity and where there is no surface.
static void test_infinite_focus(const struct lens *of)
{
    struct lens l = *of;
    float depth[N] = {0}, got[N];
    l.focus = INFINITY;
    depth[1] = INFINITY;
    for (int i = 2; i < N; i++)
        depth[i] = l.near * (float)i;
    radii_of(&l, HF_DEPTH_VIEW, depth, got);
    const double length = l.focal_mm / 1000.0 / l.unit;
    const double k = length / l.f_number / 2 * (l.focal_mm / l.sensor_mm * l.width);
    CHECK_MSG(got[0] == 0 && got[1] == 0, "far away the radius is %g and %g", got[0], got[1]);
    // K, the quotient and the product are each rounded to float; so are the four numbers that K follows from.
    for (int i = 2; i < N; i++) {
        const double want = -fmin(k / depth[i], 2048);
        CHECK_MSG(fabs(got[i] - want) <= 8 * 6e-8 * -want, "at %g the radius is %g, want %g", depth[i], got[i], want);
    }
}

// Given radii are taken as they are.
static void test_given(void)
{
    static float radius[N], got[N];
    for (int i = 0; i < N; i++)
        radius[i] = 0.137f * (float)(i - N / 2);
    radii_of(&lenses[0], HF_DEPTH_COC, radius, got);
    for (int i = 0; i < N; i++)
        CHECK_MSG(got[i] == radius[i], "radius %g became %g", radius[i], got[i]);
}

int main(void)
{
    for (size_t i = 0; i < sizeof lenses / sizeof *lenses; i++) {
        test_same_curve(&lenses[i]);
        test_focus(&lenses[i]);
        test_infinite_focus(&lenses[i]);
    }
    test_given();
    return check_report();
}
