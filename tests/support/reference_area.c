// SPDX-License-Identifier: BSD-3-Clause
// Reference of the gather, with apertures as areas: from full-resolution CoC to the result. Discs only,
// no Karis average, bilinear upsampling, float storage.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/reference.h"

// Half-resolution planes, interleaved by pixel: colour, its near and far parts, the sizes of these parts, the largest near
// CoC, and the mean far CoC of the light.
enum { COLOUR, NEAR = 4, FAR = 8, NEAR_PART = 12, FAR_PART, NEAR_MOST, FAR_OF_LIGHT, PLANES };

enum { MAX_LEVELS = 64 };
struct levels {
    int count;
    double coc[MAX_LEVELS];
    int rx[MAX_LEVELS], ry[MAX_LEVELS];
    double *weight[MAX_LEVELS];
};

struct area {
    const struct reference *r;
    int width, height;
    double *plane[PLANES];
    struct levels levels[3];  // near, far, and of what near pixels hide
};

// The area of the unit disc in x0..x1, y0..y1, integrated in slices.
static double disc_area(double x0, double x1, double y0, double y1)
{
    enum { SLICES = 2000 };
    double sum = 0;
    for (int i = 0; i < SLICES; i++) {
        const double y = y0 + (y1 - y0) * (i + 0.5) / SLICES, half = y * y < 1 ? sqrt(1 - y * y) : 0;
        sum += fmax(fmin(x1, half) - fmax(x0, -half), 0);
    }
    return sum * (y1 - y0) / SLICES;
}

// An area is narrower than the radius that it stands for: the way to half resolution and back, and the lattice, blur too.
static double narrowed(double radius)
{
    const double r = fmax(radius, 1);
    if (r >= 4)
        return r;
    const double square = r * r - (r <= 2.5 ? 1.25 : 1.25 * (4 - r) / 1.5), small = 0.31 + 0.65 * (r - 1);
    return sqrt(square > small ? square : small);
}

// Large near areas as they are on a lattice of every second or fourth pixel, bilinear between: narrower by a tent's variance.
static void add_soft_level(struct area *a, int set, double radius, double full, int step)
{
    struct levels *l = &a->levels[set];
    const double tent = (step * step - 1) / 6.0, wide = radius / a->r->params.view.pixel_aspect;
    const double rx = 2 * sqrt(wide * wide / 4 - tent) / step, ry = 2 * sqrt(radius * radius / 4 - tent) / step;
    const int nx = (int)ceil(rx - 0.5), ny = (int)ceil(ry - 0.5), i = l->count++;
    l->coc[i] = radius / full;
    l->rx[i] = nx * step + step - 1;
    l->ry[i] = ny * step + step - 1;
    const int row = 2 * l->rx[i] + 1, size = row * (2 * l->ry[i] + 1);
    double sum = 0;
    l->weight[i] = calloc((size_t)size, sizeof(double));
    for (int v = -ny; v <= ny; v++)
        for (int u = -nx; u <= nx; u++) {
            const double w = disc_area((u - 0.5) / rx, (u + 0.5) / rx, (v - 0.5) / ry, (v + 0.5) / ry);
            for (int y = 1 - step; y < step; y++)
                for (int x = 1 - step; x < step; x++)
                    l->weight[i][(v * step + y + l->ry[i]) * row + u * step + x + l->rx[i]] +=
                        w * (step - abs(y)) * (step - abs(x));
        }
    for (int k = 0; k < size; k++)
        sum += l->weight[i][k];
    for (int k = 0; k < size; k++)
        l->weight[i][k] /= sum;
}

static void add_level(struct area *a, int set, double radius, double full)
{
    struct levels *l = &a->levels[set];
    const double least = radius / fmax(a->r->params.view.pixel_aspect, 1);
    if (set != 1 && a->r->params.gather.per_pixel_kernel && least >= 5) {
        add_soft_level(a, set, radius, full, least < 20 ? 2 : 4);
        return;
    }
    const double rx = narrowed(radius / a->r->params.view.pixel_aspect), ry = narrowed(radius);
    double sum = 0;
    const int i = l->count++;
    l->coc[i] = radius / full;
    l->rx[i] = (int)fmax(ceil(rx - 0.5), 1);
    l->ry[i] = (int)fmax(ceil(ry - 0.5), 1);
    const int row = 2 * l->rx[i] + 1;
    l->weight[i] = malloc(sizeof(double) * (size_t)row * (size_t)(2 * l->ry[i] + 1));
    for (int y = -l->ry[i]; y <= l->ry[i]; y++)
        for (int x = -l->rx[i]; x <= l->rx[i]; x++)
            sum += l->weight[i][(y + l->ry[i]) * row + x + l->rx[i]] =
                fmax(disc_area((x - 0.5) / rx, (x + 0.5) / rx, (y - 0.5) / ry, (y + 0.5) / ry) * rx * ry,
                     abs(x) <= 1 && abs(y) <= 1 ? 1.0 / 1024 : 0);
    for (int k = 0; k < row * (2 * l->ry[i] + 1); k++)
        l->weight[i][k] /= sum;
}

static void make_levels(struct area *a)
{
    const double full = a->r->reach_y * a->r->kernel_scale, most = fmax(full, 1);
    if (!a->r->params.gather.per_pixel_kernel) {
        for (int set = 0; set < 3; set++)
            add_level(a, set, most, full);
        return;
    }
    for (int k = (int)ceil(2 * log2(most)); k >= 0; k--)
        add_level(a, 0, exp2(k / 2.0), full);
    for (int k = (int)ceil(log2(most)); k >= 0; k--)
        add_level(a, 2, exp2(k), full);
    for (double radius = most; radius > 1; radius *= 0.88)
        add_level(a, 1, radius, full);
    add_level(a, 1, 1, full);
}

static double share(const struct levels *l, int i, double coc)
{
    const double last = l->coc[l->count - 1], v = fmin(fmax(coc, last), l->coc[0]);
    if (i > 0 && v >= l->coc[i - 1])
        return 0;
    if (v >= l->coc[i])
        return i == 0 ? 1 : (l->coc[i - 1] - v) / (l->coc[i - 1] - l->coc[i]);
    return i + 1 < l->count && v > l->coc[i + 1] ? (v - l->coc[i + 1]) / (l->coc[i] - l->coc[i + 1]) : 0;
}

// What near pixels occlude is averaged over all levels up to theirs. Of several, the nearest count most: each by the sixth power
// of the pixel's radius over its own.
static double share_behind(const struct levels *l, int i, double coc, int several)
{
    double sum = 0;
    for (int k = 0; k <= i; k++)
        sum += share(l, k, coc);
    return several ? sum * pow(coc / l->coc[i], 6) : sum / (l->coc[i] * l->coc[i]);
}

// A disc with an area between two levels' is blended from both, so that inside the smaller one it is as bright as it
// should be.
static double share_far(const struct levels *l, int i, double coc)
{
    double area[MAX_LEVELS];
    for (int k = 0; k < l->count; k++)
        area[k] = l->coc[k] * l->coc[k];
    const double own = fmin(fmax(coc * coc, area[l->count - 1]), area[0]);
    double part = 0;
    if (own == area[i])
        part = 1;
    else if (own > area[i] && i > 0 && own < area[i - 1])
        part = (area[i - 1] - own) / (area[i - 1] - area[i]);
    else if (own < area[i] && own > area[i + 1])
        part = (own - area[i + 1]) / (area[i] - area[i + 1]);
    return part * area[i] / own;
}

// A pixel's part in a field: of several kernels as a lens has it, else in proportion to its CoC. Both fields end with the same
// level.
static double curve(int far, double q)
{
    return far ? q * q : (q * q + pow(q, 6)) / 2;
}

static double smallest_part(const struct area *a, int far, double coc)
{
    const double q = 1 / a->levels[0].coc[a->levels[0].count - 1];
    return a->r->params.gather.per_pixel_kernel ? curve(far, fmin(1, a->r->blend * q * coc))
                                                : fmin(1, a->r->blend * curve(far, q) * coc);
}

static void down(struct area *a)
{
    const struct ref_buffer *colour = &a->r->buffer[REF_COLOUR], *coc = &a->r->buffer[REF_COC];
    for (int i = 0; i < a->width * a->height; i++) {
        double all = 0, of_light = 0;
        for (int k = 0; k < 4; k++) {
            const int x = (int)fmin(i % a->width * 2 + k % 2, a->r->width - 1);
            const int y = (int)fmin(i / a->width * 2 + k / 2, a->r->height - 1), at = y * a->r->width + x;
            const double near = smallest_part(a, 0, coc->data[0][at]), far = smallest_part(a, 1, coc->data[1][at]);
            for (int c = 0; c < a->r->channels; c++) {
                a->plane[COLOUR + c][i] += colour->data[c][at] / 4;
                a->plane[NEAR + c][i] += colour->data[c][at] * near / 4;
                a->plane[FAR + c][i] += colour->data[c][at] * far / 4;
            }
            a->plane[NEAR_PART][i] += near / 4;
            a->plane[FAR_PART][i] += far / 4;
            a->plane[NEAR_MOST][i] = fmax(a->plane[NEAR_MOST][i], coc->data[0][at]);
            const double brightest = fmax(fmax(colour->data[0][at], colour->data[1][at]), colour->data[2][at]);
            const double light = far * fmax(brightest, 0x1p-40);
            all += light;
            of_light += light * coc->data[1][at];
        }
        a->plane[FAR_OF_LIGHT][i] = all > 0 ? of_light / all : 0;
    }
}

struct sums {
    double colour[4], part, left;  // left: to the far levels
};

enum kind { KIND_NEAR, KIND_BEHIND, KIND_FAR };

// Samples blurred more than twice as much as a level are left to the far levels there. (Both fields have the same radii.)
static double left_of(const struct levels *l, int i, double coc)
{
    return 1 - 1 / pow(fmax(1, coc / (2 * l->coc[i])), 8);
}

// One level's mean around a pixel; for the near field over the part of the disc within the frame. Beyond the frame
// there is nothing.
static struct sums mean(const struct area *a, int x, int y, int i, enum kind kind)
{
    const struct levels *l = &a->levels[kind == KIND_FAR ? 1 : kind == KIND_BEHIND ? 2 : 0];
    struct sums s = {{0}, 0, 0};
    double inside = 0;
    for (int v = -l->ry[i]; v <= l->ry[i]; v++)
        for (int u = -l->rx[i]; u <= l->rx[i]; u++) {
            if (x + u < 0 || y + v < 0 || x + u >= a->width || y + v >= a->height)
                continue;
            const int at = (y + v) * a->width + x + u;
            double w = l->weight[i][(v + l->ry[i]) * (2 * l->rx[i] + 1) + u + l->rx[i]];
            inside += w;
            if (kind == KIND_NEAR)
                w *= share(l, i, a->plane[NEAR_MOST][at]);
            if (kind == KIND_FAR)
                w *= share_far(l, i, a->plane[FAR_OF_LIGHT][at]);
            const double left = kind == KIND_BEHIND && a->r->params.gather.per_pixel_kernel
                                    ? left_of(l, i, a->plane[FAR_OF_LIGHT][at])
                                    : 0;
            const double rest = 1 - a->plane[NEAR_PART][at] - left * a->plane[FAR_PART][at];
            s.left += w * left * a->plane[FAR_PART][at];
            if (kind == KIND_BEHIND && !(rest > 0))
                continue;
            for (int c = 0; c < a->r->channels; c++)
                s.colour[c] += w * (kind == KIND_NEAR  ? a->plane[NEAR + c][at]
                                    : kind == KIND_FAR ? a->plane[FAR + c][at]
                                                       : a->plane[COLOUR + c][at] - a->plane[NEAR + c][at] -
                                                             left * a->plane[FAR + c][at]);
            s.part += w * (kind == KIND_NEAR  ? a->plane[NEAR_PART][at]
                           : kind == KIND_FAR ? a->plane[FAR_PART][at]
                                              : rest);
        }
    for (int c = 0; c < a->r->channels && kind != KIND_FAR; c++)
        s.colour[c] /= inside;
    s.part /= kind == KIND_FAR ? 1 : inside;
    s.left /= inside;
    return s;
}

// The largest near CoC within two pixels, and the mean of that over three by three.
static double hidden(const struct area *a, int x, int y)
{
    double sum = 0;
    for (int k = 0; k < 9; k++) {
        const int cx = (int)fmin(fmax(x - 1 + k % 3, 0), a->width - 1);
        const int cy = (int)fmin(fmax(y - 1 + k / 3, 0), a->height - 1);
        double most = 0;
        for (int v = cy - 2; v <= cy + 2; v++)
            for (int u = cx - 2; u <= cx + 2; u++)
                if (u >= 0 && v >= 0 && u < a->width && v < a->height)
                    most = fmax(most, a->plane[NEAR_MOST][v * a->width + u]);
        sum += most / 9;
    }
    return sum;
}

// The far field at a pixel: all that is spread by levels of up to 16/9 of its radius. A pixel that is not far itself is
// like its neighbours.
static void far_pixel(const struct area *a, int x, int y, double *far[4])
{
    const struct levels *l = &a->levels[1];
    const int i = y * a->width + x;
    double coc = 0;
    for (int k = 0; k < 9; k++) {
        const int u = x - 1 + k % 3, v = y - 1 + k / 3;
        if (u >= 0 && v >= 0 && u < a->width && v < a->height)
            coc = fmax(coc, (1 - a->plane[FAR_PART][i]) * a->plane[FAR_OF_LIGHT][v * a->width + u]);
    }
    coc = fmax(coc, a->plane[FAR_OF_LIGHT][i]);
    for (int own = 0; own < l->count; own++) {
        struct sums all = {{0}, 0, 0};
        const double part = share(l, own, fmax(coc, l->coc[l->count - 1]) * 16 / 9);
        if (!(part > 0))
            continue;
        for (int k = own; k < l->count; k++) {
            const struct sums f = mean(a, x, y, k, KIND_FAR);
            for (int c = 0; c < a->r->channels; c++)
                all.colour[c] += f.colour[c];
            all.part += f.part;
        }
        for (int c = 0; c < a->r->channels; c++)
            far[c][i] += all.part > 0 ? part * all.colour[c] / all.part : 0;
    }
}

// What is left to the far levels gets the colour that all of them spread to the pixel, and counts by how much they
// spread there.
static void add_far(const struct area *a, int x, int y, struct sums *back)
{
    struct sums far = {{0}, 0, 0};
    for (int k = 0; k < a->levels[1].count && back->left > 0; k++) {
        const struct sums f = mean(a, x, y, k, KIND_FAR);
        for (int c = 0; c < a->r->channels; c++)
            far.colour[c] += f.colour[c];
        far.part += f.part;
    }
    const double part = back->left / fmax(far.part, 1);
    for (int c = 0; c < a->r->channels; c++)
        back->colour[c] += part * far.colour[c];
    back->part += part * far.part;
}

static void near_pixel(const struct area *a, int x, int y, double *near[5])
{
    const struct levels *l = &a->levels[0], *behind = &a->levels[2];
    const int i = y * a->width + x;
    const double hides = hidden(a, x, y),
                 m = smallest_part(a, 0, a->r->params.gather.per_pixel_kernel ? hides : hides * 8 / 7);
    struct sums own = {{0}, 0, 0}, back = {{0}, 0, 0};
    for (int k = 0; k < l->count; k++) {
        const struct sums n = mean(a, x, y, k, KIND_NEAR);
        for (int c = 0; c < a->r->channels; c++)
            own.colour[c] += n.colour[c];
        own.part += n.part;
    }
    for (int k = 0; k < behind->count; k++) {
        const struct sums b = mean(a, x, y, k, KIND_BEHIND);
        const double w = share_behind(behind, k, hides, a->r->params.gather.per_pixel_kernel);
        for (int c = 0; c < a->r->channels; c++)
            back.colour[c] += w * b.colour[c];
        back.part += w * b.part;
        back.left += w * b.left;
    }
    add_far(a, x, y, &back);
    const double room = fmax(1 - own.part, 0), part = back.part > room ? room / back.part : 1;
    for (int c = 0; c < a->r->channels; c++) {
        const double outside = own.colour[c] / fmax(own.part, 1);
        near[c][i] =
            m > 0 ? outside + m * ((own.colour[c] + part * back.colour[c]) / (own.part + part * back.part) - outside)
                  : outside;
    }
    near[4][i] = fmin(own.part, 1) + m * (1 - fmin(own.part, 1));
}

static double up(const struct area *a, const double *plane, int x, int y)
{
    const int hx = x / 2, hy = y / 2, nx = x % 2 ? hx + 1 : hx - 1, ny = y % 2 ? hy + 1 : hy - 1;
    double sum = 0;
    for (int k = 0; k < 4; k++) {
        const int u = k % 2 ? nx : hx, v = k / 2 ? ny : hy;
        const int cu = (int)fmin(fmax(u, 0), a->width - 1), cv = (int)fmin(fmax(v, 0), a->height - 1);
        sum += (k % 2 ? 0.25 : 0.75) * (k / 2 ? 0.25 : 0.75) * plane[cv * a->width + cu];
    }
    return sum;
}

static void composite(const struct area *a, double *const near[5], double *const far[4])
{
    const struct reference *r = a->r;
    for (int y = 0; y < r->height; y++)
        for (int x = 0; x < r->width; x++) {
            const int at = y * r->width + x;
            const double own = smallest_part(a, 1, r->buffer[REF_COC].data[1][at]);
            const double blurred = up(a, a->plane[FAR_PART], x, y) + up(a, a->plane[NEAR_PART], x, y);
            const double t = fmax(fmin(own, 2 * blurred - own), 0), cover = up(a, near[4], x, y);
            for (int c = 0; c < r->channels; c++) {
                double v = r->buffer[REF_COLOUR].data[c][at];
                v = t > 0 ? (1 - t) * v + t * up(a, far[c], x, y) : v;
                r->buffer[REF_RESULT].data[c][at] = (1 - cover) * v + up(a, near[c], x, y);
            }
        }
}

void ref_area(struct reference *r)
{
    struct area a = {.r = r, .width = r->half_width, .height = r->half_height};
    const size_t n = (size_t)a.width * (size_t)a.height;
    double *near[5], *far[4];
    for (int i = 0; i < PLANES; i++)
        a.plane[i] = calloc(n, sizeof(double));
    for (int i = 0; i < 5; i++)
        near[i] = calloc(n, sizeof(double));
    for (int i = 0; i < 4; i++)
        far[i] = calloc(n, sizeof(double));
    make_levels(&a);
    down(&a);
    for (size_t i = 0; i < n; i++) {
        near_pixel(&a, (int)i % a.width, (int)i / a.width, near);
        far_pixel(&a, (int)i % a.width, (int)i / a.width, far);
    }
    composite(&a, near, far);
    for (int i = 0; i < PLANES; i++)
        free(a.plane[i]);
    for (int i = 0; i < 5; i++)
        free(near[i]);
    for (int i = 0; i < 4; i++)
        free(far[i]);
    for (int i = 0; i < 3 * MAX_LEVELS; i++)
        free(a.levels[i / MAX_LEVELS].weight[i % MAX_LEVELS]);
}
