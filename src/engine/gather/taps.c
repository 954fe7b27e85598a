// SPDX-License-Identifier: BSD-3-Clause
#include "engine/gather/taps.h"

#include "engine/gather/area.h"

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

// One ring more moves every tap. So that a radius that grows changes the picture by and by, taps of both numbers of rings
// take part, each by how near its number is.
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

// Round the lattice to units, keep what is not 0, and make the sum 1: sums of weights are exact then in any order, so that
// alpha of 1 stays 1. Weights that are equal stay equal, as rows of them are added up before they are weighted.
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

float hf_taps_part(const struct hf_taps *t, int x0, int x1, int y0, int y1)
{
    const int row = 2 * t->rx + 2;
    x0 = (x0 > -t->rx ? x0 : -t->rx) + t->rx;
    x1 = (x1 < t->rx + 1 ? x1 : t->rx + 1) + t->rx;
    y0 = (y0 > -t->ry ? y0 : -t->ry) + t->ry;
    y1 = (y1 < t->ry + 1 ? y1 : t->ry + 1) + t->ry;
    const int sum = t->sums[y1 * row + x1] - t->sums[y1 * row + x0] - (t->sums[y0 * row + x1] - t->sums[y0 * row + x0]);
    return (float)sum * t->unit * t->scale;
}

// The lattice of an area: a pixel to either side at least, so that what lies between two pixels has both.
static struct hf_area area_of(const struct hf_taps_key *k)
{
    const double y = fmax((double)k->radius * k->scale, 1);
    const double x = fmax((double)k->radius * k->scale / k->pixel_aspect, 1);
    const int mirrors = k->blades % 2 == 0 && fmod(k->rotation, 180.0 / (k->blades ? k->blades : 1)) == 0;
    const int rx = (int)fmax(ceil(x - 0.5), 1), ry = (int)fmax(ceil(y - 0.5), 1);
    const int most_x = k->most_x ? k->most_x : rx, most_y = k->most_y ? k->most_y : ry;
    return (struct hf_area){.radius_x = x,
                            .radius_y = y,
                            .rx = rx < most_x ? rx : most_x,
                            .ry = ry < most_y ? ry : most_y,
                            .blades = k->blades,
                            .rotation = k->rotation,
                            .symmetric = !k->blades || mirrors,
                            .cut = rx > most_x || ry > most_y};
}

static int build_area(struct hf_taps *t, const struct hf_taps_key *k, const struct hf_mem *mem, atomic_int *stop)
{
    const struct hf_area a = area_of(k);
    const size_t lattice = (size_t)(2 * a.rx + 1) * (2 * a.ry + 1), sums = (size_t)(2 * a.rx + 2) * (2 * a.ry + 2);
    const int err = hf_block_grow(&t->block,
                                  lattice * (sizeof(double) + sizeof(float) + sizeof(int)) + sums * sizeof(int) +
                                      (size_t)(2 * a.ry + 2) * sizeof(int),
                                  mem);
    if (err)
        return err;
    double *w = t->block.data;
    float *weight = (float *)(w + lattice);
    int *column = (int *)(weight + lattice), *first = column + lattice, *sum = first + 2 * a.ry + 2;
    hf_area_cover(w, &a, stop);
    if (hf_stopped(stop))
        return HF_ERR_CANCELLED;
    t->scale = hf_area_weights(w, &a);
    t->unit = (float)hf_area_unit(&a);
    t->count = 0;
    t->rx = a.rx;
    t->ry = a.ry;
    t->symmetric = a.symmetric;
    t->rows = t->symmetric ? t->ry + 1 : 2 * t->ry + 1;
    t->first = first;
    t->column = column;
    t->weight = weight;
    t->sums = sum;
    enter_areas(t, w, first, column, weight);
    sum_areas(sum, w, t->unit, a.rx, a.ry);
    t->key = *k;
    return HF_OK;
}

int hf_taps_build(struct hf_taps *t, const struct hf_taps_key *k, const struct hf_mem *mem, atomic_int *stop)
{
    if (!memcmp(k, &t->key, sizeof *k))
        return HF_OK;
    t->key = (struct hf_taps_key){0};
    if (k->area)
        return build_area(t, k, mem, stop);
    t->runs = 0;
    t->scale = 1;
    t->sums = NULL;
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
    t->rx = rx;
    t->ry = ry;
    t->symmetric = mirrors(w, rx, ry);
    t->rows = t->symmetric ? ry + 1 : 2 * ry + 1;
    t->first = first;
    t->column = column;
    t->weight = weight;
    round_weights(t, w, k->dense ? count : taps_of_rings((int)ceilf(k->rings)), first, column, weight);
    t->key = *k;
    return HF_OK;
}

void hf_taps_free(struct hf_taps *t, const struct hf_mem *mem)
{
    hf_block_free(&t->block, mem);
    *t = (struct hf_taps){0};
}
