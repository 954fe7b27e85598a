// SPDX-License-Identifier: BSD-3-Clause
// The metrics of hyperfocal-bench: values computed by hand from their definitions, the largest colour distance that
// FLIP's authors publish, and on random pictures a slow implementation in double precision that shares no code.
#include "flip.h"
#include "metrics.h"
#include "ssim.h"
#include "support/check.h"
#include "support/image.h"

#include <stdlib.h>
#include <string.h>

enum { W = 48, H = 40, N = W * H, COMPARED = 24 };

static float *uniform(float r, float g, float b)
{
    float *p = malloc(3 * N * sizeof *p);
    for (int i = 0; i < N; i++)
        memcpy(p + 3 * i, (const float[]){r, g, b}, 3 * sizeof *p);
    return p;
}

// Smooth structures of many sizes, some samples beyond the display.
static float *painted(uint64_t seed)
{
    struct rng rng = rng_seed(seed);
    float *p = calloc(3 * N, sizeof *p);
    for (int k = 0; k < 40; k++) {
        const float x0 = rng_range(&rng, 0, W), y0 = rng_range(&rng, 0, H), size = rng_range(&rng, 1, 12);
        const float c[3] = {rng_float(&rng), rng_float(&rng), rng_float(&rng)};
        for (int i = 0; i < 3 * N; i++) {
            const float x = (float)(i / 3 % W) - x0, y = (float)(i / 3 / W) - y0;
            p[i] += 0.5f * c[i % 3] * (x * x + y * y < size * size);
        }
    }
    return p;
}

static double near_to(double a, double b)
{
    return fabs(a - b);
}

// sRGB's curve at its ends, at its joint and at mid grey (IEC 61966-2-1: 0.2140 is shown as 0.5).
static void test_display(void)
{
    CHECK(bench_display(0) == 0 && bench_display(-1) == 0 && bench_display((float)NAN) == 0);
    CHECK(near_to(bench_display(1), 1) < 1e-6 && bench_display(7) == bench_display(1));
    CHECK(near_to(bench_display(0.0031308f), 0.04045) < 1e-6);
    CHECK(near_to(bench_display(0.21404114f), 0.5) < 1e-6);
}

static void measure(const float *want, const float *got, const uint8_t *regions, struct bench_distance *d)
{
    uint8_t *all = malloc(N);
    memset(all, 1, N);
    struct bench_metrics *m = bench_metrics_open(want, regions ? regions : all, W, H);
    if (CHECK(m))
        bench_metrics_compare(m, got, d);
    bench_metrics_close(m);
    free(all);
}

static void test_distances(void)
{
    float *want = uniform(0.21404114f, 0.21404114f, 0.21404114f), *got = uniform(0.21404114f, 0.21404114f, 0.21404114f);
    struct bench_distance d[BENCH_REGIONS];
    measure(want, got, NULL, d);
    CHECK(isinf(d->psnr) && d->display_rmse == 0 && d->linear_rmse == 0 && d->largest == 0 && d->flip == 0);
    CHECK(near_to(d->ssim, 1) < 1e-6 && d->energy == 1 && d->share == 1);
    CHECK(d[BENCH_NEAR].share == 0);

    // One channel of one pixel goes from a display value of 0.5 to 1: a squared error of 1/4 over 3 N samples.
    got[3 * (N / 2) + 1] = 1;
    measure(want, got, NULL, d);
    CHECK_MSG(near_to(d->psnr, -10 * log10(0.25 / (3.0 * N))) < 1e-4, "psnr %g", d->psnr);
    const double step = 1 - 0.21404114;
    CHECK(near_to(d->linear_rmse, step / sqrt(3.0 * N)) < 1e-7 && near_to(d->largest, step) < 1e-6);
    CHECK(near_to(d->energy, 1 + step / (3.0 * N * 0.21404114)) < 1e-7);
    CHECK(d->ssim < 1 && d->flip > 0);
    free(want);
    free(got);
}

// Structure is compared in luminance: a green and a red of the same display value differ as their weights do.
static void test_luminance(void)
{
    float *red = uniform(1, 0, 0), *green = uniform(0, 1, 0);
    struct bench_distance d[BENCH_REGIONS];
    measure(red, green, NULL, d);
    const double r = 0.2126, g = 0.7152;  // Rec. 709
    CHECK_MSG(near_to(d->ssim, (2 * r * g + 1e-4) / (r * r + g * g + 1e-4)) < 1e-3, "%g", d->ssim);
    free(red);
    free(green);
}

// A region gets the error inside it and no other.
static void test_pooling(void)
{
    float *want = uniform(0.2f, 0.3f, 0.4f), *got = uniform(0.2f, 0.3f, 0.4f);
    uint8_t regions[N];
    for (int i = 0; i < N; i++)
        regions[i] = (uint8_t)(1 << BENCH_WHOLE | (i % W < W / 2 ? 1 << BENCH_NEAR : 1 << BENCH_FAR));
    for (int y = 0; y < H; y++)
        got[3 * (y * W + W - 1)] = 0.7f;
    struct bench_distance d[BENCH_REGIONS];
    measure(want, got, regions, d);
    CHECK(d[BENCH_NEAR].display_rmse == 0 && d[BENCH_NEAR].flip == 0);
    CHECK(near_to(d[BENCH_NEAR].share, 0.5) < 1e-12 && d[BENCH_HIGHLIGHTS].share == 0);
    CHECK(near_to(d[BENCH_FAR].display_rmse, sqrt(2) * d->display_rmse) < 1e-7);
    CHECK(near_to(d[BENCH_FAR].linear_rmse, 0.5 / sqrt(3 * W / 2.0)) < 1e-7);
    free(want);
    free(got);
}

// Depth steps by 10 pixels of radius at half the width; one lamp of radius 3 stands in the far half.
static void test_regions(void)
{
    float radius[N], *rgb = uniform(0.1f, 0.1f, 0.1f);
    uint8_t regions[N];
    for (int i = 0; i < N; i++)
        radius[i] = i % W < W / 2 ? -7.0f : i % W < W - 4 ? 3.0f : 0;
    const int lamp = 20 * W + 38;
    rgb[3 * lamp + 2] = 5;
    bench_regions(regions, rgb, radius, W, H);
    for (int x = 0; x < W; x++) {
        // The pixels W/2-1 and W/2 see the step, and 7 on either side are within reach; the step of 3 at W-4 has the
        // same reach.
        const int first = x >= W / 2 - 8 && x <= W / 2 + 7, second = x >= W - 8 && x <= W - 1;
        const int want = 1 << BENCH_WHOLE | (first || second ? 1 << BENCH_SILHOUETTES
                                             : x < W / 2     ? 1 << BENCH_NEAR
                                                             : 1 << BENCH_FAR);
        CHECK_INT(regions[5 * W + x], want);
        CHECK_INT(regions[20 * W + x] >> BENCH_HIGHLIGHTS & 1, abs(x - 38) <= 3);
    }
    memset(radius, 0, sizeof radius);
    bench_regions(regions, rgb, radius, W, H);
    CHECK_INT(regions[0], 1 << BENCH_WHOLE | 1 << BENCH_FOCUS);
    CHECK_INT(regions[lamp], 1 << BENCH_WHOLE | 1 << BENCH_FOCUS | 1 << BENCH_HIGHLIGHTS);
    free(rgb);
}

// Wang's formula with all sums written out.
static double slow_ssim(const float *a, const float *b, int x, int y)
{
    double sum = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
    for (int v = -5; v <= 5; v++)
        for (int u = -5; u <= 5; u++) {
            const int xx = x + u < 0 ? 0 : x + u >= W ? W - 1 : x + u, yy = y + v < 0 ? 0 : y + v >= H ? H - 1 : y + v;
            const double g = exp(-(u * u + v * v) / 4.5), p = a[yy * W + xx], q = b[yy * W + xx];
            sum += g;
            ma += g * p;
            mb += g * q;
            aa += g * p * p;
            bb += g * q * q;
            ab += g * p * q;
        }
    ma /= sum;
    mb /= sum;
    const double va = aa / sum - ma * ma, vb = bb / sum - mb * mb, cov = ab / sum - ma * mb;
    return (2 * ma * mb + 1e-4) * (2 * cov + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
}

static void test_ssim(void)
{
    float a[N], b[N], map[N];
    // For two constants only the first factor remains.
    for (int i = 0; i < N; i++) {
        a[i] = 0.25f;
        b[i] = 0.75f;
    }
    struct bench_ssim *s = bench_ssim_open(a, W, H);
    bench_ssim_map(s, b, map);
    for (int i = 0; i < N; i += 97)
        CHECK_MSG(near_to(map[i], (2 * 0.25 * 0.75 + 1e-4) / (0.0625 + 0.5625 + 1e-4)) < 1e-3, "%g", map[i]);
    bench_ssim_close(s);

    float *p = painted(1), *q = painted(2);
    for (int i = 0; i < N; i++) {
        a[i] = bench_display(p[3 * i]);
        b[i] = bench_display(0.9f * p[3 * i] + 0.1f * q[3 * i]);
    }
    s = bench_ssim_open(a, W, H);
    bench_ssim_map(s, b, map);
    // 22 sums with a rounding error of 2^-24 in each mean; differences of means are divided by at least 9e-4: 22 * 4 *
    // 6e-8 / 9e-4.
    for (int i = 0; i < N; i++)
        CHECK_MSG(near_to(map[i], slow_ssim(a, b, i % W, i / W)) < 6e-3, "pixel %d: %g", i, map[i]);
    bench_ssim_close(s);
    free(p);
    free(q);
}

// FLIP again, from the paper, in double: complete windows, not separated.
struct slow {
    double p[N][3], grey[N], lab[N][3];
};

static void slow_xyz(const double rgb[3], double xyz[3])
{
    static const double m[3][3] = {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                                   {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                                   {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};
    for (int i = 0; i < 3; i++)
        xyz[i] = m[i][0] * rgb[0] + m[i][1] * rgb[1] + m[i][2] * rgb[2];
}

static void slow_rgb(const double xyz[3], double rgb[3])
{
    // Cramer's rule on the columns of the matrix above.
    double c[3][3], col[3];
    for (int j = 0; j < 3; j++) {
        slow_xyz((const double[]){j == 0, j == 1, j == 2}, col);
        for (int i = 0; i < 3; i++)
            c[i][j] = col[i];
    }
    const double det = c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1]) -
                       c[0][1] * (c[1][0] * c[2][2] - c[1][2] * c[2][0]) +
                       c[0][2] * (c[1][0] * c[2][1] - c[1][1] * c[2][0]);
    for (int j = 0; j < 3; j++) {
        double d[3][3];
        for (int i = 0; i < 9; i++)
            d[i / 3][i % 3] = i % 3 == j ? xyz[i / 3] : c[i / 3][i % 3];
        rgb[j] =
            (d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
             d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0])) /
            det;
    }
}

static double slow_f(double t)
{
    return t > 216.0 / 24389 ? cbrt(t) : t * 841 / 108 + 4.0 / 29;
}

static void slow_lab(const double rgb[3], double lab[3])
{
    double xyz[3], white[3];
    slow_xyz(rgb, xyz);
    slow_xyz((const double[]){1, 1, 1}, white);
    lab[0] = 116 * slow_f(xyz[1] / white[1]) - 16;
    lab[1] = 5 * (slow_f(xyz[0] / white[0]) - slow_f(xyz[1] / white[1])) * lab[0];
    lab[2] = 2 * (slow_f(xyz[1] / white[1]) - slow_f(xyz[2] / white[2])) * lab[0];
}

static int clamped(int i, int n)
{
    return i < 0 ? 0 : i >= n ? n - 1 : i;
}

static double csf(int channel, double d2)
{
    const double pi = acos(-1), a[3][2] = {{1, 0}, {1, 0}, {34.1, 13.5}};
    const double b[3][2] = {{0.0047, 1e-5}, {0.0053, 1e-5}, {0.04, 0.025}};
    double sum = 0;
    for (int k = 0; k < 2; k++)
        sum += a[channel][k] * sqrt(pi / b[channel][k]) * exp(-pi * pi * d2 / b[channel][k]);
    return sum;
}

static void slow_prepare(struct slow *s, const float *rgb, double ppd)
{
    const int radius = (int)ceil(3 * sqrt(0.04 / (2 * acos(-1) * acos(-1))) * ppd);
    double white[3];
    slow_xyz((const double[]){1, 1, 1}, white);
    for (int i = 0; i < N; i++) {
        double c[3], xyz[3];
        for (int j = 0; j < 3; j++)
            c[j] = fmin(fmax(rgb[3 * i + j], 0), 1);
        slow_xyz(c, xyz);
        for (int j = 0; j < 3; j++)
            xyz[j] /= white[j];
        s->grey[i] = xyz[1];
        s->p[i][0] = 116 * xyz[1] - 16;
        s->p[i][1] = 500 * (xyz[0] - xyz[1]);
        s->p[i][2] = 200 * (xyz[1] - xyz[2]);
    }
    for (int i = 0; i < N; i++) {
        double sum[3] = {0}, weights[3] = {0};
        for (int v = -radius; v <= radius; v++)
            for (int u = -radius; u <= radius; u++)
                for (int c = 0; c < 3; c++) {
                    const double g = csf(c, (u * u + v * v) / (ppd * ppd));
                    weights[c] += g;
                    sum[c] += g * s->p[clamped(i / W + v, H) * W + clamped(i % W + u, W)][c];
                }
        const double y = (sum[0] / weights[0] + 16) / 116;
        const double xyz[3] = {(sum[1] / weights[1] / 500 + y) * white[0], y * white[1],
                               (y - sum[2] / weights[2] / 200) * white[2]};
        double c[3];
        slow_rgb(xyz, c);
        for (int j = 0; j < 3; j++)
            c[j] = fmin(fmax(c[j], 0), 1);
        slow_lab(c, s->lab[i]);
    }
}

// Strength of edges (order 1) or points (2) at a pixel.
static double slow_feature(const struct slow *s, int i, int order, double ppd)
{
    const double sd = 0.5 * 0.082 * ppd;
    const int r = (int)ceil(3 * sd);
    double plus = 0, minus = 0, dir[2][2] = {{0}};
    for (int v = -r; v <= r; v++)
        for (int u = -r; u <= r; u++) {
            const double g = exp(-(u * u + v * v) / (2 * sd * sd));
            const double k[2] = {order == 1 ? -u * g : (u * u / (sd * sd) - 1) * g,
                                 order == 1 ? -v * g : (v * v / (sd * sd) - 1) * g};
            *(k[0] > 0 ? &plus : &minus) += fabs(k[0]);
            const double y = s->grey[clamped(i / W + v, H) * W + clamped(i % W + u, W)];
            for (int d = 0; d < 2; d++)
                dir[d][k[d] > 0] += k[d] * y;
        }
    return hypot(dir[0][1] / plus + dir[0][0] / minus, dir[1][1] / plus + dir[1][0] / minus);
}

static double slow_flip(const struct slow *a, const struct slow *b, int i, double ppd)
{
    double green[3], blue[3];
    slow_lab((const double[]){0, 1, 0}, green);
    slow_lab((const double[]){0, 0, 1}, blue);
    const double most = pow(fabs(green[0] - blue[0]) + hypot(green[1] - blue[1], green[2] - blue[2]), 0.7);
    const double *p = a->lab[i], *q = b->lab[i];
    const double d = pow(fabs(p[0] - q[0]) + hypot(p[1] - q[1], p[2] - q[2]), 0.7);
    const double colour =
        d < 0.4 * most ? 0.95 / (0.4 * most) * d : 0.95 + (d - 0.4 * most) / (most - 0.4 * most) * 0.05;
    const double edge = fabs(slow_feature(a, i, 1, ppd) - slow_feature(b, i, 1, ppd));
    const double point = fabs(slow_feature(a, i, 2, ppd) - slow_feature(b, i, 2, ppd));
    return pow(colour, 1 - sqrt(fmax(edge, point) / sqrt(2)));
}

// The mean over a picture of two uniform pictures: the colour part alone.
static double flip_of(const float *want, const float *got, double ppd)
{
    static float map[N];
    struct bench_flip *f = bench_flip_open(want, W, H, ppd);
    bench_flip_map(f, got, map);
    double sum = 0;
    for (int i = 0; i < N; i++)
        sum += map[i];
    bench_flip_close(f);
    return sum / N;
}

static void test_flip_values(void)
{
    // Lab of sRGB green is 87.735 -86.183 83.179 and of blue 32.297 79.188 -107.860 (D65, as colour tables have it). With
    // chroma times L / 100: (55.438 + hypot(101.188, 107.815))^0.7 = 203.30^0.7.
    CHECK_MSG(near_to(bench_flip_largest(), 41.2760) < 1e-3, "%g", bench_flip_largest());
    float *black = uniform(0, 0, 0), *white = uniform(1, 1, 1), *green = uniform(0, 1, 0), *blue = uniform(0, 0, 1);
    // Black and white differ by 100 in L alone: 100^0.7 = 25.1189 lies above 0.4 * 41.276, so the value is
    // 0.95 + 0.05 (25.1189 - 16.5104) / 24.7656.
    CHECK_MSG(near_to(flip_of(black, white, BENCH_FLIP_PPD), 0.967380) < 2e-5, "%g",
              flip_of(black, white, BENCH_FLIP_PPD));
    CHECK(near_to(flip_of(green, blue, BENCH_FLIP_PPD), 1) < 2e-5);
    CHECK(flip_of(black, black, BENCH_FLIP_PPD) == 0);
    // Greys of L 50 and 51 differ by 1: 0.95 / 16.5104.
    float *grey = uniform(0.18418651f, 0.18418651f, 0.18418651f), *brighter = uniform(0.19279f, 0.19279f, 0.19279f);
    const double l = 116 * cbrt(0.19279) - 16 - (116 * cbrt(0.18418651) - 16);
    CHECK(near_to(flip_of(grey, brighter, BENCH_FLIP_PPD), 0.95 / 16.5104 * pow(l, 0.7)) < 2e-5);
    CHECK(!bench_flip_open(black, W, H, 1000));
    float *all[] = {black, white, green, blue, grey, brighter};
    for (int i = 0; i < 6; i++)
        free(all[i]);
}

static void test_flip_slow(void)
{
    static struct slow a, b;
    static float map[N];
    float *want = painted(3), *got = painted(3), *other = painted(4);
    for (int i = 0; i < 3 * N; i++)
        got[i] = 0.7f * got[i] + 0.3f * other[i];
    for (double ppd = 30; ppd < 70; ppd += 37.0206432766) {
        slow_prepare(&a, want, ppd);
        slow_prepare(&b, got, ppd);
        struct bench_flip *f = bench_flip_open(want, W, H, ppd);
        bench_flip_map(f, got, map);
        // A filter adds up to 42 products of at most 100, so L, a and b are right to 42 * 100 * 2^-24 = 2.5e-4 at worst and
        // to about the root of that count, 4e-5, as roundings go. The colour part's slope is 0.7 * 0.95 / 16.5 * d^-0.3,
        // below 0.16 where d > 0.01: 4e-5 and, with a factor of 2 for what the features add, 1e-4 is not reached.
        struct rng rng = rng_seed(5);
        for (int k = 0; k < COMPARED; k++) {
            const int i = rng_below(&rng, N);
            CHECK_MSG(near_to(map[i], slow_flip(&a, &b, i, ppd)) < 1e-4, "ppd %g pixel %d: %g, slowly %g", ppd, i,
                      map[i], slow_flip(&a, &b, i, ppd));
        }
        bench_flip_close(f);
    }
    free(want);
    free(got);
    free(other);
}

static void test_flicker(void)
{
    const float a[] = {0, 0.1f, 0.5f}, b[] = {0.1f, 0.1f, 0.5f}, c[] = {0.2f, 0.1f, 0.8f};
    // Only the last sample does not go straight on: by 0.3.
    CHECK(near_to(bench_flicker(a, b, c, 3), 0.3 / sqrt(3)) < 1e-7);
    CHECK(near_to(bench_flicker(a, b, c, 2), 0) < 1e-7);
}

int main(void)
{
    test_display();
    test_distances();
    test_luminance();
    test_pooling();
    test_regions();
    test_ssim();
    test_flip_values();
    test_flip_slow();
    test_flicker();
    return check_report();
}
