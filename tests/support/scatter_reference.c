// SPDX-License-Identifier: BSD-3-Clause
#include "support/scatter_reference.h"

#include <stdlib.h>

#include "support/reference_edges.h"
#include "support/seen.h"

// A radius rounded to the nearest of 1024 per octave; and half the width of its row dy in 1/256 pixel.
static double kept_radius(float r)
{
    int exponent;
    const double m = frexp(fmax(r, 0.5), &exponent);  // 0.5..1
    return ldexp(floor(m * 2048 + 0.5) / 2048, exponent);
}

static double row_width(double r, int dy)
{
    double y[2] = {dy - 0.5, dy + 0.5}, g[2];
    for (int i = 0; i < 2; i++) {
        const double t = fmin(fmax(y[i], -r), r);
        g[i] = (t * sqrt(r * r - t * t) + r * r * asin(t / r)) / 2;
    }
    const double height = dy == 0 ? 1 : fmin(1, r - (abs(dy) - 0.5));
    return height <= 0 ? 0 : floor(256 * (g[1] - g[0]) / height + 0.5) / 256;
}

// The part of a row's height that a disc covers, in 128ths: the last row's weight; other rows weigh 1.
static double row_weight(double r, int dy)
{
    const double height = fmin(1, r - (abs(dy) - 0.5));
    return dy == 0 || height >= 1 ? 1 : height <= 0 ? 0 : floor(128 * height + 0.5) / 128;
}

static double overlap(double a0, double a1, double b0, double b1)
{
    return fmax(0, fmin(a1, b1) - fmax(a0, b0));
}

static void splat(double *sum, const struct picture *c, int x, int y, const double *colour, float radius, double part)
{
    const double r = kept_radius(radius);
    const int reach = (int)ceil(r) + 1, n = c->channels;
    double area = 0;
    for (int dy = -reach; dy <= reach; dy++)
        area += 2 * row_width(r, dy) * row_weight(r, dy);
    for (int dy = -reach; dy <= reach; dy++)
        for (int dx = -reach; dx <= reach; dx++) {
            const int px = x + dx, py = y + dy;
            if (px < 0 || py < 0 || px >= c->width || py >= c->height)
                continue;
            const double w = row_width(r, dy),
                         share = part * row_weight(r, dy) * overlap(-w, w, dx - 0.5, dx + 0.5) / area;
            double *out = sum + (size_t)(py * c->width + px) * 5;
            for (int k = 0; k < n; k++)
                out[k] += share * colour[k];
            out[4] += share;
        }
}

static double segment(double d)
{
    const double t = fmin(d, 1);
    return 0.5 + t * (0.63662 + t * t * (-0.10610 - t * t * 0.03052));
}

static double visible_part(const struct picture *c, double r, int x, int y)
{
    return (segment((x + 0.5) / r) + segment((c->width - x - 0.5) / r) - 1) *
           (segment((y + 0.5) / r) + segment((c->height - y - 0.5) / r) - 1);
}

static double clamp01(double v)
{
    return fmin(fmax(v, 0), 1);
}

static double own_part(double r)
{
    return clamp01(1.5 - fabs(r));
}

// The blurred radius of a pixel's front or back, and its share.
static double part_of(const struct edge_reference *e, int k, double *radius)
{
    *radius = fabs(e->radius[k]) > 0.5 ? e->radius[k] : 0;
    return k ? e->share : 1 - e->share;
}

// From 0 to 1 without a corner at either end.
static double smooth(double v)
{
    return v * v * (3 - 2 * v);
}

// What is visible around near pixels: planes of sharp and far colours times weight, then both weights.
static struct seen seen_of(const struct picture *c, const struct edge_reference *edge)
{
    const int n = c->channels, pixels = c->width * c->height;
    struct seen s = seen_new((c->width + 1) / 2, (c->height + 1) / 2, 2 * n + 2);
    for (int i = 0; i < pixels; i++)
        if (edge[i].radius[0] < -0.5) {
            double *near = seen_at(&s, 2 * n + 2, i % c->width / 2, i / c->width / 2);
            *near = fmax(*near, -edge[i].radius[0]);
        }
    for (int i = 0; i < 2 * pixels; i++) {
        const int at = i / 2, x = at % c->width / 2, y = at / c->width / 2;
        double r, part = part_of(&edge[at], i & 1, &r);
        // The visible part of a back counts fully, unless its share is almost 0.
        part = i & 1 ? clamp01(64 * part) : part;
        const double own = r > 0 ? own_part(r) : smooth(seen_part(r, seen_widest(&s, x, y))), far = r > 0 ? 1 - own : 0;
        for (int k = 0; k < n; k++) {
            *seen_at(&s, k, x, y) += part * own * edge[at].colour[i & 1][k] / 4;
            *seen_at(&s, n + k, x, y) += part * far * edge[at].colour[i & 1][k] / 4;
        }
        *seen_at(&s, 2 * n, x, y) += part * own / 4;
        *seen_at(&s, 2 * n + 1, x, y) += part * far / 4;
    }
    return seen_around(s);
}

// What lies behind a near pixel, from what is visible around it, and the far and near fields there.
static double behind(const struct seen *s, int n, int k, int x, int y, const double *far, double front)
{
    const double sharp = seen_sample(s, 2 * n, x, y), blurred = seen_sample(s, 2 * n + 1, x, y);
    const double reached = clamp01(16 * far[4]), v = far[4] > 0 ? far[k] / far[4] : 0;
    const double other = front + reached * (v - front);
    const double unblurred = blurred > 0 ? seen_sample(s, n + k, x, y) / blurred : 0;
    const double shown = unblurred + clamp01(far[4]) * (v - unblurred), nothing = 1e-5;
    return (seen_sample(s, k, x, y) + blurred * shown + nothing * other) / (sharp + blurred + nothing);
}

// What a part of pixel i shows in channel k.
static double composite(const struct seen *seen, const struct picture *c, const double *far, const double *near, int i,
                        int k, double radius, double v)
{
    const double size = fabs(radius), own = size <= 0.5 ? 1 : own_part(size),
                 front = near[4] > 0 ? near[k] / near[4] : v;
    double back = far[4] > 0 ? far[k] / far[4] : v, cover = near[4];
    if (radius < 0) {
        back = behind(seen, c->channels, k, i % c->width, i / c->width, far, front);
        cover /= visible_part(c, size, i % c->width, i / c->width);
    }
    // A near pixel that is visible covers the background as far as its own sprite covers that pixel.
    const double show = radius < 0 && own < 1 - cover ? own / (1 - cover) : radius < 0 ? 1 : own;
    const double base = back + show * (v - back);
    return base + clamp01(cover) * (front - base);
}

// The part of a far radius in slice k: slices begin at 4, 12, 36 .. and contain a source fully from 1.25 times that on.
static double slice_part(int k, int slices, double r)
{
    const double from = 4 * pow(3, k - 1), to = from * 3;
    return (k ? clamp01((r / from - 1) * 4) : 1) * (k < slices - 1 ? 1 - clamp01((r / to - 1) * 4) : 1);
}

// The far sums of pixel i: each slice gets the coverage that the slices before it, and the visible part of the pixel
// itself, leave of 1.
static void add_slices(double *sum[], int slices, int channels, int i, const struct edge_reference *e)
{
    double room = 0, r, *all = sum[1] + 5 * (size_t)i;
    for (int k = 0; k < 2; k++) {
        const double part = part_of(e, k, &r);
        room += part * (1 - own_part(r));
    }
    for (int k = 1; k < slices; k++) {
        const double *own = sum[1 + k] + 5 * (size_t)i, left = fmax(room - all[4], 0);
        for (int c = 0; c < channels && own[4] > 0; c++)
            all[c] += own[c] * fmin(1, left / own[4]);
        all[4] += fmin(left, own[4]);
    }
}

struct picture scatter_reference(const struct picture *c, const float *radius)
{
    enum { SLICES = 8 };
    const int n = c->width * c->height;
    double *sum[1 + SLICES], r, largest = 0;
    int slices = 1;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, radius[i]);
    for (double from = 4; from < largest && slices < SLICES; from *= 3)
        slices++;
    for (int k = 0; k < 1 + slices; k++)
        sum[k] = calloc((size_t)n * 5, sizeof(double));
    struct edge_reference *edge = calloc((size_t)n, sizeof *edge);
    struct picture out = picture_copy(c);
    for (int i = 0; i < n; i++)
        edge[i] = edge_reference(c, radius, 0.5, i % c->width, i / c->width);
    struct seen seen = seen_of(c, edge);
    for (int i = 0; i < 2 * n; i++) {
        const int x = i / 2 % c->width, y = i / 2 / c->width;
        const struct edge_reference *e = &edge[i / 2];
        const double part = part_of(e, i & 1, &r) * (1 - own_part(r)), size = fabs(r);
        for (int k = 0; k < slices && r != 0 && part > 0; k++) {
            const double inside = r > 0 ? slice_part(k, slices, size) : k == 0;
            if (inside > 0)
                splat(sum[r > 0 ? 1 + k : 0], c, x, y, e->colour[i & 1], (float)size, part * inside);
        }
    }
    for (int i = 0; i < n; i++)
        add_slices(sum, slices, c->channels, i, &edge[i]);
    for (int i = 0; i < n; i++)
        for (int k = 0; k < c->channels; k++) {
            double v = 0;
            for (int p = 0; p < 2; p++) {
                const double part = part_of(&edge[i], p, &r);
                if (part > 0)
                    v += part * composite(&seen, c, sum[1] + 5 * (size_t)i, sum[0] + 5 * (size_t)i, i, k, r,
                                          edge[i].colour[p][k]);
            }
            out.plane[k][i] = (float)v;
        }
    seen_free(&seen);
    free(edge);
    for (int k = 0; k < 1 + slices; k++)
        free(sum[k]);
    return out;
}
