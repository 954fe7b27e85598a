// SPDX-License-Identifier: BSD-3-Clause
#include "flip.h"

#include "convolve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Each comment gives the paper's section; the names are the paper's symbols.
static const float qc = 0.7f, pc = 0.4f,
                   pt = 0.95f;  // 4.1.3: the exponent; where the compression bends, and to which value
static const double w = 0.082;  // 4.2: width of the features that are detected, degrees
static const double csf_b[4] = {0.0047, 0.0053, 0.04, 0.025};  // table 1: A, RG, and BY, whose filter has two parts
static const double csf_a[4] = {1, 1, 34.1, 13.5};

// Linear sRGB to XYZ, D65.
static const float to_xyz[3][3] = {{0.41238656f, 0.35759149f, 0.18045049f},
                                   {0.21263682f, 0.71518298f, 0.07218020f},
                                   {0.01933062f, 0.11919716f, 0.95037259f}};
static const float to_rgb[3][3] = {{3.24100326f, -1.53739899f, -0.49861587f},
                                   {-0.96922426f, 1.87592999f, 0.04155422f},
                                   {0.05563942f, -0.20401120f, 1.05714897f}};
static const float white[3] = {0.95042854f, 1.0f, 1.08890037f};  // XYZ of (1, 1, 1)

struct features {
    float *edge_x, *edge_y, *point_x, *point_y;
};

struct bench_flip {
    int width, height;
    size_t pixels;
    float largest;               // HyAB of green and blue, to the power of qc
    struct bench_kernel csf[4];  // each sums to 1, except the last two, which sum to 1 together
    float share[4];              // of each part in its filter
    struct bench_kernel smooth, edge, point;
    float *memory;
    float *lab[3];  // of the reference picture
    struct features want, got;
    float *plane[3], *grey, *scratch, *part;
};
enum { PLANES = 3 + 4 + 4 + 3 + 3 };

static void multiply(float out[3], const float m[3][3], const float in[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = m[i][0] * in[0] + m[i][1] * in[1] + m[i][2] * in[2];
}

static float clamp01(float v)
{
    return v > 0 ? v < 1 ? v : 1 : 0;
}

// Lab with the Hunt effect: chroma counts less in the dark.
static void lab_of(float lab[3], const float rgb[3])
{
    float xyz[3], f[3];
    multiply(xyz, to_xyz, rgb);
    for (int i = 0; i < 3; i++) {
        const float t = xyz[i] / white[i], delta = 6.0f / 29;
        f[i] = t > delta * delta * delta ? cbrtf(t) : t / (3 * delta * delta) + 4.0f / 29;
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 0.01f * lab[0] * 500 * (f[0] - f[1]);
    lab[2] = 0.01f * lab[0] * 200 * (f[1] - f[2]);
}

static float hyab(const float a[3], const float b[3])
{
    const float da = a[1] - b[1], db = a[2] - b[2];
    return fabsf(a[0] - b[0]) + sqrtf(da * da + db * db);
}

double bench_flip_largest(void)
{
    float green[3], blue[3];
    lab_of(green, (const float[]){0, 1, 0});
    lab_of(blue, (const float[]){0, 0, 1});
    return pow(hyab(green, blue), qc);
}

// A derivative of the gaussian, scaled so that its positive weights sum to 1 and its negative ones to -1.
static struct bench_kernel feature_kernel(int radius, double sigma, int order)
{
    struct bench_kernel k = {.radius = radius};
    double value[2 * BENCH_MOST_RADIUS + 1], plus = 0, minus = 0;
    for (int x = -radius; x <= radius; x++) {
        const double g = exp(-x * x / (2 * sigma * sigma));
        const double v = order == 1 ? -x * g : (x * x / (sigma * sigma) - 1) * g;
        value[x + radius] = v;
        *(v > 0 ? &plus : &minus) += fabs(v);
    }
    for (int i = 0; i <= 2 * radius; i++)
        k.weight[i] = (float)(value[i] / (value[i] > 0 ? plus : minus));
    return k;
}

// The filters of table 1 are sums of gaussians a sqrt(pi / b) exp(-pi^2 d^2 / b), d in degrees; each is separable.
static void make_kernels(struct bench_flip *f, double ppd, int radius, int feature_radius)
{
    const double pi = 3.14159265358979323846;
    double weight[4];
    for (int i = 0; i < 4; i++) {
        const double sigma = sqrt(csf_b[i] / 2) / pi * ppd;
        double sum = 0;
        for (int x = -radius; x <= radius; x++)
            sum += exp(-x * x / (2 * sigma * sigma));
        f->csf[i] = bench_gaussian(radius, sigma);
        weight[i] = csf_a[i] * sqrt(pi / csf_b[i]) * sum * sum;
    }
    f->share[0] = f->share[1] = 1;
    f->share[2] = (float)(weight[2] / (weight[2] + weight[3]));
    f->share[3] = 1 - f->share[2];
    const double sigma = 0.5 * w * ppd;
    f->smooth = bench_gaussian(feature_radius, sigma);
    f->edge = feature_kernel(feature_radius, sigma, 1);
    f->point = feature_kernel(feature_radius, sigma, 2);
}

// YCxCz of the picture in plane[], and its brightness 0..1 in grey.
static void opponents(struct bench_flip *f, const float *rgb)
{
    for (size_t i = 0; i < f->pixels; i++) {
        const float c[3] = {clamp01(rgb[3 * i]), clamp01(rgb[3 * i + 1]), clamp01(rgb[3 * i + 2])};
        float xyz[3];
        multiply(xyz, to_xyz, c);
        const float x = xyz[0] / white[0], y = xyz[1] / white[1], z = xyz[2] / white[2];
        f->plane[0][i] = 116 * y - 16;
        f->plane[1][i] = 500 * (x - y);
        f->plane[2][i] = 200 * (y - z);
        f->grey[i] = y;
    }
}

static void filter(struct bench_flip *f, const float *in, float *out, const struct bench_kernel *kx,
                   const struct bench_kernel *ky)
{
    bench_convolve(out, in, f->scratch, f->width, f->height, kx, ky);
}

// Filter plane[] in place by what the eye resolves.
static void soften(struct bench_flip *f)
{
    filter(f, f->plane[0], f->plane[0], &f->csf[0], &f->csf[0]);
    filter(f, f->plane[1], f->plane[1], &f->csf[1], &f->csf[1]);
    filter(f, f->plane[2], f->part, &f->csf[3], &f->csf[3]);
    filter(f, f->plane[2], f->plane[2], &f->csf[2], &f->csf[2]);
    for (size_t i = 0; i < f->pixels; i++)
        f->plane[2][i] = f->share[2] * f->plane[2][i] + f->share[3] * f->part[i];
}

// Lab of a filtered pixel.
static void lab_at(const struct bench_flip *f, size_t i, float lab[3])
{
    const float y = (f->plane[0][i] + 16) / 116;
    const float xyz[3] = {(f->plane[1][i] / 500 + y) * white[0], y * white[1], (y - f->plane[2][i] / 200) * white[2]};
    float rgb[3];
    multiply(rgb, to_rgb, xyz);
    for (int c = 0; c < 3; c++)
        rgb[c] = clamp01(rgb[c]);
    lab_of(lab, rgb);
}

static void find_features(struct bench_flip *f, struct features *out)
{
    filter(f, f->grey, out->edge_x, &f->edge, &f->smooth);
    filter(f, f->grey, out->edge_y, &f->smooth, &f->edge);
    filter(f, f->grey, out->point_x, &f->point, &f->smooth);
    filter(f, f->grey, out->point_y, &f->smooth, &f->point);
}

struct bench_flip *bench_flip_open(const float *want, int width, int height, double ppd)
{
    const double pi = 3.14159265358979323846;
    const int radius = (int)ceil(3 * sqrt(0.04 / (2 * pi * pi)) * ppd), feature_radius = (int)ceil(3 * 0.5 * w * ppd);
    struct bench_flip *f = calloc(1, sizeof *f);
    const size_t pixels = (size_t)width * (size_t)height;
    float *m = malloc(PLANES * pixels * sizeof *m);
    if (!f || !m || radius > BENCH_MOST_RADIUS || feature_radius > BENCH_MOST_RADIUS) {
        free(f);
        free(m);
        return NULL;
    }
    *f = (struct bench_flip){.width = width, .height = height, .pixels = pixels, .memory = m};
    f->largest = (float)bench_flip_largest();
    float **const planes[PLANES] = {
        &f->lab[0],       &f->lab[1],     &f->lab[2],     &f->want.edge_x, &f->want.edge_y, &f->want.point_x,
        &f->want.point_y, &f->got.edge_x, &f->got.edge_y, &f->got.point_x, &f->got.point_y, &f->plane[0],
        &f->plane[1],     &f->plane[2],   &f->grey,       &f->scratch,     &f->part};
    for (int i = 0; i < PLANES; i++)
        *planes[i] = m + (size_t)i * pixels;
    make_kernels(f, ppd, radius, feature_radius);
    opponents(f, want);
    find_features(f, &f->want);
    soften(f);
    for (size_t i = 0; i < pixels; i++) {
        float lab[3];
        lab_at(f, i, lab);
        for (int c = 0; c < 3; c++)
            f->lab[c][i] = lab[c];
    }
    return f;
}

// 4.1.3: distance of colours, compressed to 0..1.
static float colour_difference(const struct bench_flip *f, size_t i)
{
    float got[3];
    lab_at(f, i, got);
    const float want[3] = {f->lab[0][i], f->lab[1][i], f->lab[2][i]};
    const float d = powf(hyab(want, got), qc), bend = pc * f->largest;
    return d < bend ? pt / bend * d : pt + (d - bend) / (f->largest - bend) * (1 - pt);
}

// 4.2: the larger difference of edges and points.
static float feature_difference(const struct bench_flip *f, size_t i)
{
    const struct features *a = &f->want, *b = &f->got;
    const float edge = fabsf(sqrtf(a->edge_x[i] * a->edge_x[i] + a->edge_y[i] * a->edge_y[i]) -
                             sqrtf(b->edge_x[i] * b->edge_x[i] + b->edge_y[i] * b->edge_y[i]));
    const float point = fabsf(sqrtf(a->point_x[i] * a->point_x[i] + a->point_y[i] * a->point_y[i]) -
                              sqrtf(b->point_x[i] * b->point_x[i] + b->point_y[i] * b->point_y[i]));
    return sqrtf(fmaxf(edge, point) * 0.70710678f);
}

void bench_flip_map(struct bench_flip *f, const float *got, float *map)
{
    opponents(f, got);
    find_features(f, &f->got);
    soften(f);
    for (size_t i = 0; i < f->pixels; i++) {
        const float colour = colour_difference(f, i);
        map[i] = colour > 0 ? powf(colour, 1 - feature_difference(f, i)) : 0;
    }
}

void bench_flip_close(struct bench_flip *f)
{
    if (f)
        free(f->memory);
    free(f);
}
