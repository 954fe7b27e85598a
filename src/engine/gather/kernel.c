// SPDX-License-Identifier: BSD-3-Clause
#include "engine/gather/kernel.h"

#include <math.h>
#include <string.h>

#include "engine/gather/area.h"

// Where all that the area covers of a row is one run around its middle, it is one entry.
static void enter_areas(struct hf_taps *t, const double *w, int *first, int *column, float *weight)
{
    const int row = 2 * t->rx + 1;
    int n = 0;
    t->runs = t->symmetric && t->rx > 1 && t->ry > 1;
    for (int k = 0; k < t->rows; k++) {
        const double *p = t->symmetric ? w + (k + t->ry) * row + t->rx : w + k * row;
        int from = 0, run = 0;
        first[k] = n;
        while (t->runs && run <= t->rx && p[run] == 1)
            run++;
        if (run > 1) {
            column[n] = t->rx + run;
            weight[n++] = 1;
            from = run;
        }
        for (int j = from; j < (t->symmetric ? t->rx + 1 : row); j++)
            if (p[j] > 0) {
                column[n] = j;
                weight[n++] = (float)p[j];
            }
    }
    first[t->rows] = n;
}

static void sum_areas(int *sums, const double *w, float unit, int rx, int ry)
{
    const int row = 2 * rx + 2;
    memset(sums, 0, (size_t)row * sizeof *sums);
    for (int y = 0; y <= 2 * ry; y++) {
        sums[(y + 1) * row] = 0;
        for (int x = 0; x <= 2 * rx; x++)
            sums[(y + 1) * row + x + 1] = sums[(y + 1) * row + x] + sums[y * row + x + 1] - sums[y * row + x] +
                                          (int)(w[y * (2 * rx + 1) + x] / (double)unit);
    }
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

// The lattice of an area: a pixel to either side at least, so that what lies between two pixels has both.
static struct hf_area area_of(const struct hf_area_key *k)
{
    const double y = narrowed((double)k->radius);
    const double x = narrowed((double)k->radius / k->pixel_aspect);
    const int mirrors = k->blades % 2 == 0 && fmod(k->rotation, 180.0 / (k->blades ? k->blades : 1)) == 0;
    const int rx = (int)fmax(ceil(x - 0.5), 1), ry = (int)fmax(ceil(y - 0.5), 1);
    return (struct hf_area){.radius_x = x,
                            .radius_y = y,
                            .rx = rx < k->most_x ? rx : k->most_x,
                            .ry = ry < k->most_y ? ry : k->most_y,
                            .blades = k->blades,
                            .rotation = k->rotation,
                            .symmetric = !k->blades || mirrors,
                            .cut = rx > k->most_x || ry > k->most_y};
}

int hf_area_kernel_build(struct hf_area_kernel *kernel, const struct hf_area_key *k, const struct hf_mem *mem,
                         atomic_int *stop)
{
    if (!memcmp(k, &kernel->key, sizeof *k))
        return HF_OK;
    kernel->key = (struct hf_area_key){0};
    const struct hf_area a = area_of(k);
    const size_t lattice = (size_t)(2 * a.rx + 1) * (2 * a.ry + 1), sums = (size_t)(2 * a.rx + 2) * (2 * a.ry + 2);
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
    *t = (struct hf_taps){.rx = a.rx,
                          .ry = a.ry,
                          .symmetric = a.symmetric,
                          .rows = a.symmetric ? a.ry + 1 : 2 * a.ry + 1,
                          .first = first,
                          .column = column,
                          .weight = weight,
                          .scale = hf_area_weights(w, &a)};
    enter_areas(t, w, first, column, weight);
    kernel->unit = (float)hf_area_unit(&a);
    kernel->sums = sum;
    sum_areas(sum, w, kernel->unit, a.rx, a.ry);
    kernel->key = *k;
    return HF_OK;
}

void hf_area_kernel_free(struct hf_area_kernel *k, const struct hf_mem *mem)
{
    hf_block_free(&k->block, mem);
    *k = (struct hf_area_kernel){0};
}
