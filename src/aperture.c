// SPDX-License-Identifier: BSD-3-Clause
#include "aperture.h"

#include <math.h>
#include <string.h>

// Integral from 0 to y of the half-width of a disc's rows, radius r.
static double half_disc(double r, double y)
{
    const double t = y > r ? r : y < -r ? -r : y;
    return (t * sqrt(r * r - t * t) + r * r * asin(t / r)) / 2;
}

// Half a disc's mean width over row dy, plus half a pixel, in 1/256 pixel.
static int32_t disc_row(double r, double scale_x, int dy)
{
    return (int32_t)lround(256 * ((half_disc(r, dy + 0.5) - half_disc(r, dy - 0.5)) * scale_x + 0.5));
}

static int disc_rows(double r)
{
    return (int)ceil(r + 0.5);
}

// Rows of the pictures, all together.
static size_t count_rows(const struct hf_aperture *a)
{
    size_t rows = 0;
    for (int i = 0; i < a->count; i++)
        rows += (size_t)disc_rows(hf_picture_radius(i));
    return rows;
}

static void build_disc(struct hf_aperture *a, int number, int first)
{
    struct hf_picture *p = &a->picture[number];
    const double r = hf_picture_radius(number);
    double area = 0;
    *p = (struct hf_picture){.first = first, .rows = disc_rows(r)};
    for (int dy = 0; dy < p->rows; dy++) {
        const int32_t half = disc_row(r, a->key.scale_x, dy);
        a->half[first + dy] = half;
        area += (dy ? 2.0 : 1.0) * (2 * half - 256);
    }
    // Rows that round to nothing.
    while (p->rows > 1 && a->half[first + p->rows - 1] <= 128)
        p->rows--;
    if (area <= 0) {
        a->half[first] = 129;
        area = 2;
    }
    p->reach_y = p->rows - 1;
    p->reach_x = (a->half[first] >> 8) + 1;
    p->inverse = (float)(1 / area);
}

int hf_aperture_build(struct hf_aperture *a, const struct hf_aperture_key *key, const struct hf_mem *mem)
{
    if (a->count && !memcmp(&a->key, key, sizeof *key))
        return HF_OK;
    a->count = hf_picture_number(key->largest) + 2;
    a->key = *key;
    a->symmetric = 1;
    a->unit = 256;
    a->headroom = 5;
    const size_t rows = count_rows(a), pictures = (size_t)a->count * sizeof *a->picture;
    const int err = hf_block_grow(&a->block, pictures + rows * sizeof *a->half, mem);
    if (err) {
        a->count = 0;
        return err;
    }
    a->picture = a->block.data;
    a->half = (int32_t *)(a->picture + a->count);
    for (int i = 0, first = 0; i < a->count; i++) {
        build_disc(a, i, first);
        first += disc_rows(hf_picture_radius(i));
    }
    return HF_OK;
}
