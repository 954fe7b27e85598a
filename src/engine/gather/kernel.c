// SPDX-License-Identifier: BSD-3-Clause
#include "engine/gather/kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/gather/area.h"

// Where all that the area covers of a row is one run around its middle, it is one entry.
static void enter_areas(struct hf_taps *t, const double *w, int *first, int *column, float *weight)
{
    const int row = 2 * t->nx + 1;
    int n = 0;
    t->runs = t->symmetric && t->nx > 1 && t->ny > 1;
    for (int k = 0; k < t->rows; k++) {
        const double *p = t->symmetric ? w + (k + t->ny) * row + t->nx : w + k * row;
        int from = 0, run = 0;
        first[k] = n;
        while (t->runs && run <= t->nx && p[run] == 1)
            run++;
        if (run > 1) {
            column[n] = t->nx + run;
            weight[n++] = 1;
            from = run;
        }
        for (int j = from; j < (t->symmetric ? t->nx + 1 : row); j++)
            if (p[j] > 0) {
                column[n] = j;
                weight[n++] = (float)p[j];
            }
    }
    first[t->rows] = n;
}

// Add a weight to the pixels that its tents reach; sums: the first of them.
static void add_tents(int *sums, int row, int step, int weight)
{
    for (int y = 0; y < 2 * step - 1; y++)
        for (int x = 0; x < 2 * step - 1; x++)
            sums[y * row + x] += weight * (step - abs(y - (step - 1))) * (step - abs(x - (step - 1)));
}

static void sum_areas(int *sums, const double *w, float unit, const struct hf_taps *t)
{
    const int row = 2 * t->rx + 2, height = 2 * t->ry + 2, columns = 2 * t->nx + 1;
    memset(sums, 0, (size_t)row * height * sizeof *sums);
    for (int y = 0; y <= 2 * t->ny; y++)
        for (int x = 0; x < columns; x++)
            add_tents(sums + (y * t->step + 1) * row + x * t->step + 1, row, t->step,
                      (int)(w[y * columns + x] / (double)unit));
    for (int y = 1; y < height; y++)
        for (int x = 1; x < row; x++)
            sums[y * row + x] += sums[y * row + x - 1] + sums[(y - 1) * row + x] - sums[(y - 1) * row + x - 1];
}

float hf_area_part(const struct hf_area_kernel *k, int x0, int x1, int y0, int y1)
{
    const struct hf_taps *t = &k->taps;
    const int row = 2 * t->rx + 2;
    x0 = (x0 > -t->rx ? x0 : -t->rx) + t->rx;
    x1 = (x1 < t->rx + 1 ? x1 : t->rx + 1) + t->rx;
    y0 = (y0 > -t->ry ? y0 : -t->ry) + t->ry;
    y1 = (y1 < t->ry + 1 ? y1 : t->ry + 1) + t->ry;
    const int sum = k->sums[y1 * row + x1] - k->sums[y1 * row + x0] - (k->sums[y0 * row + x1] - k->sums[y0 * row + x0]);
    return (float)sum * k->unit * t->scale;
}

// The radius of an area that, on the way to half resolution and back, has the variance of a disc of this radius in the picture,
// r^2 / 2. In half-resolution pixels, the mean of a quad has 1/8, its upsampling 3/8, and the lattice about 1/6, less the 1/12
// that a pixel of the lens's own disc has: so its square is about r^2 - 5/4, except below a radius of about 1.3, where the area
// covers little of the pixels beside the middle one; the line there is fitted to the lattice's variance. A radius of 1 has the
// variance of the way there and back alone, and no area has less. From 2.5 on the difference is faded out, up to 4.
static double narrowed(double radius)
{
    const double r = fmax(radius, 1), fade = fmin(fmax((4 - r) / 1.5, 0), 1);
    return fade > 0 ? sqrt(fmax(r * r - 1.25 * fade, 0.31 + 0.65 * (r - 1))) : r;
}

// The radius of an area on a lattice of that step, in steps: with the tents, whose variance is (step^2 - 1) / 6, it has the
// variance r^2 / 4 in x and in y.
static double spaced(double radius, int step)
{
    return step > 1 ? sqrt(radius * radius - (step * step - 1) * (2 / 3.0)) / step : narrowed(radius);
}

// An area that may be soft has a weight for every pixel below a radius of 5, for every second one below 20, and for every fourth
// from there on. (`fence` and `foliage` have 32.65 and 33.27 dB so, 32.67 and 33.26 with one for every pixel; `fence` has 32.64
// with every fourth from 16 on.)
static int step_of(const struct hf_area_key *k)
{
    const float r = k->pixel_aspect > 1 ? k->radius / k->pixel_aspect : k->radius;
    return !k->soft || r < 5 ? 1 : r < 20 ? 2 : HF_MAX_STEP;
}

static int reach_of(int points, int step)
{
    return points * step + step - 1;
}

// The lattice of an area: a pixel to either side at least, so that what lies between two pixels has both.
static struct hf_area area_of(const struct hf_area_key *k, int step)
{
    const double y = spaced((double)k->radius, step);
    const double x = spaced((double)k->radius / k->pixel_aspect, step);
    const int mirrors = k->blades % 2 == 0 && fmod(k->rotation, 180.0 / (k->blades ? k->blades : 1)) == 0;
    const int rx = (int)fmax(ceil(x - 0.5), 1), ry = (int)fmax(ceil(y - 0.5), 1);
    return (struct hf_area){.radius_x = x,
                            .radius_y = y,
                            .rx = rx < k->most_x ? rx : k->most_x,
                            .ry = ry < k->most_y ? ry : k->most_y,
                            .blades = k->blades,
                            .rotation = k->rotation,
                            .symmetric = !k->blades || mirrors,
                            .cut = reach_of(rx, step) > k->most_x || reach_of(ry, step) > k->most_y,
                            .times = step * step * step * step};
}

int hf_area_kernel_build(struct hf_area_kernel *kernel, const struct hf_area_key *k, const struct hf_mem *mem,
                         atomic_int *stop)
{
    if (!memcmp(k, &kernel->key, sizeof *k))
        return HF_OK;
    kernel->key = (struct hf_area_key){0};
    int step = step_of(k);
    struct hf_area a = area_of(k, step);
    // The rim of what is cut is not met; and with a large area and step, weights would be rounded to 0 or 1 (hf_area_unit).
    while (step > 1 && (a.cut || hf_area_unit(&a) > 0.5))
        a = area_of(k, step /= 2);
    const int rx = reach_of(a.rx, step), ry = reach_of(a.ry, step);
    const size_t lattice = (size_t)(2 * a.rx + 1) * (2 * a.ry + 1), sums = (size_t)(2 * rx + 2) * (2 * ry + 2);
    const int err = hf_block_grow(&kernel->block,
                                  lattice * (sizeof(double) + sizeof(float) + sizeof(int)) + sums * sizeof(int) +
                                      (size_t)(2 * a.ry + 2) * sizeof(int),
                                  mem);
    if (err)
        return err;
    struct hf_taps *t = &kernel->taps;
    double *w = kernel->block.data;
    float *weight = (float *)(w + lattice);
    int *column = (int *)(weight + lattice), *first = column + lattice, *sum = first + 2 * a.ry + 2;
    hf_area_cover(w, &a, stop);
    if (hf_stopped(stop))
        return HF_ERR_CANCELLED;
    *t = (struct hf_taps){.step = step,
                          .nx = a.rx,
                          .ny = a.ry,
                          .rx = rx,
                          .ry = ry,
                          .symmetric = a.symmetric,
                          .rows = a.symmetric ? a.ry + 1 : 2 * a.ry + 1,
                          .first = first,
                          .column = column,
                          .weight = weight,
                          .scale = hf_area_weights(w, &a) / (float)a.times};
    enter_areas(t, w, first, column, weight);
    kernel->unit = (float)hf_area_unit(&a);
    kernel->sums = sum;
    sum_areas(sum, w, kernel->unit, t);
    kernel->key = *k;
    return HF_OK;
}

void hf_area_kernel_free(struct hf_area_kernel *k, const struct hf_mem *mem)
{
    hf_block_free(&k->block, mem);
    *k = (struct hf_area_kernel){0};
}
