// SPDX-License-Identifier: BSD-3-Clause
#include "engine/chapter/taps.h"

#include <math.h>
#include <string.h>

// Weights below this are rounding of a tap that lies on a lattice line (the smallest real ones are above 1e-5).
static const double NEGLIGIBLE = 1e-6;

// Weights of taps are whole numbers of this: floats up to 1 hold them exactly.
#define WEIGHT_UNIT 0x1p-24f

float hf_taps_spaced(float radius)
{
    const float n = radius / 2;
    return n < 1 ? 1 : n > HF_MAX_RINGS ? HF_MAX_RINGS : n;
}

int hf_taps_rings(float radius)
{
    return (int)ceilf(hf_taps_spaced(radius));
}

static int taps_of_rings(int rings)
{
    return 1 + 4 * rings * (rings + 1);
}

static int tap_count(const struct hf_taps_key *k)
{
    const int rings = (int)ceilf(k->rings), blended = k->rings < (float)rings;
    return k->dense ? 144 : taps_of_rings(rings) + (blended ? taps_of_rings(rings - 1) : 0);
}

// Distance from the centre to the side of a unit n-gon in direction t (Sousa 2013).
static double polygon_radius(int n, double t)
{
    return cos(M_PI / n) / cos(t - 2 * M_PI / n * floor((n * t + M_PI) / (2 * M_PI)));
}

// A point of the square -1..1 to the unit disc, equal areas kept (Shirley and Chiu 1997).
static void concentric(double x, double y, double *u, double *v)
{
    if (x == 0 && y == 0) {
        *u = *v = 0;
        return;
    }
    const int wide = fabs(x) > fabs(y);
    const double r = wide ? x : y;
    const double t = wide ? M_PI / 4 * (y / x) : M_PI / 2 - M_PI / 4 * (x / y);
    *u = r * cos(t);
    *v = r * sin(t);
}

static void place_grid(const struct hf_taps_key *k, float *dx, float *dy, float *share)
{
    const double reach = (double)k->radius * k->scale;
    for (int i = 0; i < 144; i++) {
        double u, v;
        concentric((i % 12 + 0.5) / 6 - 1, (i / 12 + 0.5) / 6 - 1, &u, &v);
        if (k->blades) {
            const double t = atan2(v, u) - k->rotation * M_PI / 180;
            u *= polygon_radius(k->blades, t);
            v *= polygon_radius(k->blades, t);
        }
        dx[i] = (float)(u * reach / k->pixel_aspect);
        dy[i] = (float)(v * reach);
        share[i] = 1;
    }
}

static void place_rings(const struct hf_taps_key *k, int rings, float *dx, float *dy)
{
    const double reach = (double)k->radius * k->scale;
    int n = 1;
    dx[0] = dy[0] = 0;
    for (int ring = 1; ring <= rings; ring++) {
        for (int i = 0; i < 8 * ring; i++, n++) {
            const double t = 2 * M_PI * i / (8 * ring);
            double r = reach * ring / rings;
            if (k->blades)
                r *= polygon_radius(k->blades, t - k->rotation * M_PI / 180);
            dx[n] = (float)(r * cos(t) / k->pixel_aspect);
            dy[n] = (float)(r * sin(t));
        }
    }
}

// A further ring moves every tap. The picture must change continuously as the radius grows. So the taps of both
// numbers of rings take part, each weighted by how close its number is.
static void place_taps(const struct hf_taps_key *k, float *dx, float *dy, float *share)
{
    if (k->dense) {
        place_grid(k, dx, dy, share);
        return;
    }
    const int rings = (int)ceilf(k->rings), all = tap_count(k), count = taps_of_rings(rings);
    const double part = 1 - ((double)rings - (double)k->rings);
    place_rings(k, rings, dx, dy);
    if (all > count)
        place_rings(k, rings - 1, dx + count, dy + count);
    for (int i = 0; i < all; i++)
        share[i] = (float)(i < count ? part : (1 - part) * count / (all - count));
}

// Add a tap's four bilinear weights to the lattice w of (2 rx + 1) columns.
static void splat(double *w, int rx, int ry, double x, double y, double share)
{
    const double fx = floor(x), fy = floor(y);
    const double ax = x - fx, ay = y - fy;
    double *p = w + ((int)fy + ry) * (2 * rx + 1) + (int)fx + rx;
    // A tap on the outermost lattice line has no weight beyond it, and there is no room for one.
    if (1 - ax > NEGLIGIBLE && 1 - ay > NEGLIGIBLE)
        p[0] += share * ((1 - ax) * (1 - ay));
    if (ax > NEGLIGIBLE && 1 - ay > NEGLIGIBLE)
        p[1] += share * (ax * (1 - ay));
    p += 2 * rx + 1;
    if (1 - ax > NEGLIGIBLE && ay > NEGLIGIBLE)
        p[0] += share * ((1 - ax) * ay);
    if (ax > NEGLIGIBLE && ay > NEGLIGIBLE)
        p[1] += share * (ax * ay);
}

// Lattice points needed on either side of the centre.
static int lattice_reach(const float *d, int count)
{
    float reach = 0;
    for (int i = 0; i < count; i++)
        reach = fmaxf(reach, fabsf(d[i]));
    return (int)ceil((double)reach - NEGLIGIBLE);
}

static int mirrors(const double *w, int rx, int ry)
{
    const int row = 2 * rx + 1;
    for (int y = -ry; y <= ry; y++)
        for (int x = -rx; x <= rx; x++) {
            const double a = w[(y + ry) * row + x + rx];
            if (fabs(a - w[(y + ry) * row - x + rx]) > 1e-6 || fabs(a - w[(ry - y) * row + x + rx]) > 1e-6)
                return 0;
        }
    return 1;
}

// Entries of the lattice: how often each stands there by symmetry.
static int mirrored(const struct hf_taps *t, int row, int column)
{
    return t->symmetric ? (1 + (row > 0)) * (1 + (column > 0)) : 1;
}

// Gives the largest weight of those that stand there so often what whole units are missing of the sum of all.
static void make_up(struct hf_taps *t, int times, int *missing, const int *first, const int *column, float *weight)
{
    int largest = -1;
    for (int k = 0; k < t->rows; k++)
        for (int i = first[k]; i < first[k + 1]; i++)
            if (mirrored(t, k, column[i]) == times && (largest < 0 || weight[i] > weight[largest]))
                largest = i;
    if (largest < 0)
        return;
    weight[largest] += (float)(*missing / times) * WEIGHT_UNIT;
    *missing %= times;
}

// Round the weights of the lattice to multiples of WEIGHT_UNIT, drop those that become 0, and make the others sum to 1.
// Floats then sum them exactly in any order, so an alpha of 1 stays 1. Weights that mirror each other stay equal,
// because the convolution adds up mirrored samples before it weights them.
static void round_weights(struct hf_taps *t, const double *w, double all, int *first, int *column, float *weight)
{
    const int row = 2 * t->rx + 1, columns = t->symmetric ? t->rx + 1 : row;
    int n = 0, missing = (int)(1 / WEIGHT_UNIT);
    for (int k = 0; k < t->rows; k++) {
        first[k] = n;
        for (int j = 0; j < columns; j++) {
            const double *p = t->symmetric ? w + (k + t->ry) * row + j + t->rx : w + k * row + j;
            const int times = mirrored(t, k, j);
            const int units = (int)rint(*p / all / WEIGHT_UNIT);
            if (units <= 0)
                continue;
            column[n] = j;
            weight[n++] = (float)units * WEIGHT_UNIT;
            missing -= units * times;
        }
    }
    first[t->rows] = n;
    for (int times = 4; times >= 1; times /= 2)
        make_up(t, times, &missing, first, column, weight);
}

int hf_tap_set_build(struct hf_tap_set *t, const struct hf_taps_key *k, const struct hf_mem *mem)
{
    if (!memcmp(k, &t->key, sizeof *k))
        return HF_OK;
    t->key = (struct hf_taps_key){0};
    const int count = tap_count(k);
    // Room for the largest reach there can be: a polygon's corners lie on its circle.
    const int max_rx = (int)ceil((double)k->radius * k->scale / k->pixel_aspect) + 1;
    const int max_ry = (int)ceil((double)k->radius * k->scale) + 1;
    const size_t lattice = (size_t)(2 * max_rx + 1) * (2 * max_ry + 1);
    const size_t size = lattice * (sizeof(double) + sizeof(float) + sizeof(int)) + 3 * (size_t)count * sizeof(float) +
                        (size_t)(2 * max_ry + 2) * sizeof(int);
    const int err = hf_block_grow(&t->block, size, mem);
    if (err)
        return err;
    double *w = t->block.data;
    float *dx = (float *)(w + lattice), *dy = dx + count, *share = dy + count, *weight = share + count;
    int *column = (int *)(weight + lattice), *first = column + lattice;
    memset(w, 0, lattice * sizeof *w);
    place_taps(k, dx, dy, share);
    const int rx = lattice_reach(dx, count), ry = lattice_reach(dy, count);
    // The positions are rounded to float for the per-pixel kernel; the lattice takes the same ones.
    for (int i = 0; i < count; i++)
        splat(w, rx, ry, dx[i], dy[i], share[i]);
    t->count = count;
    t->dx = dx;
    t->dy = dy;
    t->share = share;
    const int symmetric = mirrors(w, rx, ry);
    t->taps = (struct hf_taps){.step = 1,
                               .nx = rx,
                               .ny = ry,
                               .rx = rx,
                               .ry = ry,
                               .symmetric = symmetric,
                               .rows = symmetric ? ry + 1 : 2 * ry + 1,
                               .first = first,
                               .column = column,
                               .weight = weight,
                               .scale = 1};
    round_weights(&t->taps, w, k->dense ? count : taps_of_rings((int)ceilf(k->rings)), first, column, weight);
    t->key = *k;
    return HF_OK;
}

void hf_tap_set_free(struct hf_tap_set *t, const struct hf_mem *mem)
{
    hf_block_free(&t->block, mem);
    *t = (struct hf_tap_set){0};
}
