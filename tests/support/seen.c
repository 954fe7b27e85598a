// SPDX-License-Identifier: BSD-3-Clause
#include "support/seen.h"

#include <math.h>
#include <stdlib.h>

enum { RIM = 20 };  // beyond the frame, what neighbourhoods pass on

static double clamp01(double v)
{
    return fmin(fmax(v, 0), 1);
}

struct seen seen_new(int width, int height, int planes)
{
    struct seen s = {width, height, planes, {0}};
    for (int p = 0; p <= planes; p++)
        s.plane[p] = calloc((size_t)(width + 2 * RIM) * (size_t)(height + 2 * RIM), sizeof(double));
    return s;
}

void seen_free(struct seen *s)
{
    for (int p = 0; p <= s->planes; p++)
        free(s->plane[p]);
}

double *seen_at(const struct seen *s, int p, int x, int y)
{
    return &s->plane[p][(size_t)(y + RIM) * (size_t)(s->width + 2 * RIM) + (size_t)(x + RIM)];
}

double seen_widest(const struct seen *s, int x, int y)
{
    double most = 0;
    for (int v = y - 7; v <= y + 7; v++)
        for (int u = x - 7; u <= x + 7; u++)
            if (u >= 0 && v >= 0 && u < s->width && v < s->height)
                most = fmax(most, *seen_at(s, s->planes, u, v));
    return most;
}

double seen_part(double r, double widest)
{
    return fmax(clamp01(1.5 + r), clamp01(widest / 2 + r));
}

static double at_or_0(const struct seen *s, int p, int x, int y)
{
    return x < -RIM || y < -RIM || x >= s->width + RIM || y >= s->height + RIM ? 0 : *seen_at(s, p, x, y);
}

// Neighbourhood j is the mean of neighbourhood j - 1 over three by three, 2^(j-1) apart. It weighs 4^-j, and less where
// 2^j exceeds half a quad's radius plus 1.
struct seen seen_around(struct seen level)
{
    struct seen sum = seen_new(level.width, level.height, level.planes);
    for (int p = 0; p < level.planes; p++)
        for (int k = 0; k < (level.width + 2 * RIM) * (level.height + 2 * RIM); k++)
            sum.plane[p][k] = level.plane[p][k];
    for (int j = 1; j < 5; j++) {
        struct seen next = seen_new(level.width, level.height, level.planes);
        for (int y = -RIM; y < level.height + RIM; y++)
            for (int x = -RIM; x < level.width + RIM; x++) {
                const double q = *seen_at(&level, level.planes, x, y);
                const double part = pow(0.25, j) * clamp01(2 - pow(2, j) / (q / 2 + 1));
                *seen_at(&next, level.planes, x, y) = q;
                for (int p = 0; p < level.planes; p++) {
                    double mean = 0;
                    for (int k = 0; k < 9; k++)
                        mean +=
                            at_or_0(&level, p, x + (k % 3 - 1) * (1 << (j - 1)), y + (k / 3 - 1) * (1 << (j - 1))) / 9;
                    *seen_at(&next, p, x, y) = mean;
                    *seen_at(&sum, p, x, y) += part * mean;
                }
            }
        seen_free(&level);
        level = next;
    }
    seen_free(&level);
    return sum;
}

double seen_sample(const struct seen *s, int p, int x, int y)
{
    double v = 0;
    for (int k = 0; k < 4; k++)
        v += (k & 1 ? 0.25 : 0.75) * (k & 2 ? 0.25 : 0.75) *
             at_or_0(s, p, x / 2 + (k & 1 ? (x & 1 ? 1 : -1) : 0), y / 2 + (k & 2 ? (y & 1 ? 1 : -1) : 0));
    return v;
}
