// SPDX-License-Identifier: BSD-3-Clause
#include "metrics.h"

#include "flip.h"
#include "ssim.h"
#include "tools/common/luminance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct bench_metrics {
    int width, height;
    const float *want;
    const uint8_t *regions;
    struct bench_ssim *ssim;
    struct bench_flip *flip;
    float *memory;
    float *want_shown;                   // display-encoded, packed
    float *want_luma, *got_luma;         // of the display-encoded picture
    float *shown, *ssim_map, *flip_map;  // mean squared display error of a pixel's samples; and the other two maps
};

const char *bench_region_name(enum bench_region region)
{
    static const char *const names[BENCH_REGIONS] = {"whole", "silhouettes", "near", "far", "focus", "highlights"};
    return names[region];
}

float bench_display(float v)
{
    v = v > 0 ? v < 1 ? v : 1 : 0;
    return v <= 0.0031308f ? 12.92f * v : 1.055f * powf(v, 1 / 2.4f) - 0.055f;
}

// Add a disc of ones around (x, y), as the ends of its rows; marks is one column wider than the picture.
static void mark_disc(int *marks, int x, int y, float radius, int width, int height)
{
    const int reach = (int)ceilf(radius);
    for (int dy = -reach; dy <= reach; dy++) {
        if (y + dy < 0 || y + dy >= height || abs(dy) > radius)
            continue;
        const int half = (int)sqrtf(radius * radius - (float)(dy * dy));
        int *row = marks + (size_t)(y + dy) * ((size_t)width + 1);
        row[x > half ? x - half : 0]++;
        row[x + half + 1 < width ? x + half + 1 : width]--;
    }
}

// Least and largest of the 3 x 3 around a pixel.
static void around(const float *radius, int x, int y, int width, int height, float *least, float *most)
{
    *least = INFINITY;
    *most = -INFINITY;
    for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v < height; v++)
        for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u < width; u++) {
            const float r = radius[(size_t)v * (size_t)width + (size_t)u];
            *least = fminf(*least, r);
            *most = fmaxf(*most, r);
        }
}

static void mark_region(uint8_t *out, int *marks, enum bench_region region, int width, int height)
{
    for (int y = 0; y < height; y++) {
        const int *row = marks + (size_t)y * ((size_t)width + 1);
        int open = 0;
        for (int x = 0; x < width; x++) {
            open += row[x];
            if (open > 0)
                out[(size_t)y * (size_t)width + (size_t)x] |= (uint8_t)(1u << region);
        }
    }
    memset(marks, 0, ((size_t)width + 1) * (size_t)height * sizeof *marks);
}

void bench_regions(uint8_t *out, const float *rgb, const float *radius, int width, int height)
{
    const size_t pixels = (size_t)width * (size_t)height;
    int *marks = calloc(((size_t)width + 1) * (size_t)height, sizeof *marks);
    memset(out, 1 << BENCH_WHOLE, pixels);
    if (!marks)
        return;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            float least, most;
            around(radius, x, y, width, height, &least, &most);
            if (most - least > 1)  // a steeper surface folds under the lens
                mark_disc(marks, x, y, fmaxf(1, fmaxf(-least, most)), width, height);
        }
    mark_region(out, marks, BENCH_SILHOUETTES, width, height);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const size_t i = (size_t)y * (size_t)width + (size_t)x;
            if (fmaxf(rgb[3 * i], fmaxf(rgb[3 * i + 1], rgb[3 * i + 2])) > 1)
                mark_disc(marks, x, y, fmaxf(1, fabsf(radius[i])), width, height);
        }
    mark_region(out, marks, BENCH_HIGHLIGHTS, width, height);
    free(marks);
    for (size_t i = 0; i < pixels; i++)
        if (!(out[i] & 1 << BENCH_SILHOUETTES))
            out[i] |= (uint8_t)(1u << (radius[i] < -1 ? BENCH_NEAR : radius[i] > 1 ? BENCH_FAR : BENCH_FOCUS));
}

static float luma(const float *shown)
{
    return tool_luminance(shown[0], shown[1], shown[2]);
}

struct bench_metrics *bench_metrics_open(const float *want, const uint8_t *regions, int width, int height)
{
    const size_t pixels = (size_t)width * (size_t)height;
    struct bench_metrics *m = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    *m = (struct bench_metrics){.width = width, .height = height, .want = want, .regions = regions};
    m->memory = malloc(8 * pixels * sizeof *m->memory);
    if (m->memory) {
        float **const planes[] = {&m->want_luma, &m->got_luma, &m->shown, &m->ssim_map, &m->flip_map};
        m->want_shown = m->memory;
        for (size_t i = 0; i < 5; i++)
            *planes[i] = m->memory + (3 + i) * pixels;
        for (size_t i = 0; i < 3 * pixels; i++)
            m->want_shown[i] = bench_display(want[i]);
        for (size_t i = 0; i < pixels; i++)
            m->want_luma[i] = luma(m->want_shown + 3 * i);
        m->ssim = bench_ssim_open(m->want_luma, width, height);
        m->flip = bench_flip_open(want, width, height, BENCH_FLIP_PPD);
    }
    if (!m->memory || !m->ssim || !m->flip) {
        bench_metrics_close(m);
        return NULL;
    }
    return m;
}

static void show(struct bench_metrics *m, const float *got)
{
    const size_t pixels = (size_t)m->width * (size_t)m->height;
    for (size_t i = 0; i < pixels; i++) {
        float sum = 0, c[3];
        for (int j = 0; j < 3; j++) {
            c[j] = bench_display(got[3 * i + (size_t)j]);
            const float d = c[j] - m->want_shown[3 * i + (size_t)j];
            sum += d * d;
        }
        m->got_luma[i] = luma(c);
        m->shown[i] = sum / 3;
    }
}

// Average over a region.
static void pool(const struct bench_metrics *m, const float *got, enum bench_region region, struct bench_distance *out)
{
    const size_t pixels = (size_t)m->width * (size_t)m->height;
    double n = 0, shown = 0, linear = 0, largest = 0, ssim = 0, flip = 0, got_sum = 0, want_sum = 0;
    for (size_t i = 0; i < pixels; i++) {
        if (!(m->regions[i] & 1 << region))
            continue;
        n++;
        shown += m->shown[i];
        ssim += m->ssim_map[i];
        flip += m->flip_map[i];
        for (size_t j = 3 * i; j < 3 * i + 3; j++) {
            const double d = (double)got[j] - m->want[j];
            linear += d * d;
            largest = fmax(largest, fabs(d));
            got_sum += got[j];
            want_sum += m->want[j];
        }
    }
    *out = (struct bench_distance){.share = n / (double)pixels};
    if (n == 0)
        return;
    out->display_rmse = sqrt(shown / n);
    out->psnr = -20 * log10(out->display_rmse);
    out->linear_rmse = sqrt(linear / (3 * n));
    out->largest = largest;
    out->ssim = ssim / n;
    out->flip = flip / n;
    out->energy = got_sum / want_sum;
}

void bench_metrics_compare(struct bench_metrics *m, const float *got, struct bench_distance out[BENCH_REGIONS])
{
    show(m, got);
    bench_ssim_map(m->ssim, m->got_luma, m->ssim_map);
    bench_flip_map(m->flip, got, m->flip_map);
    for (int r = 0; r < BENCH_REGIONS; r++)
        pool(m, got, (enum bench_region)r, &out[r]);
}

void bench_metrics_close(struct bench_metrics *m)
{
    if (!m)
        return;
    bench_ssim_close(m->ssim);
    bench_flip_close(m->flip);
    free(m->memory);
    free(m);
}

double bench_flicker(const float *before, const float *now, const float *after, size_t samples)
{
    double sum = 0;
    for (size_t i = 0; i < samples; i++) {
        const double d = (double)before[i] - 2 * (double)now[i] + after[i];
        sum += d * d;
    }
    return sqrt(sum / (double)samples);
}
