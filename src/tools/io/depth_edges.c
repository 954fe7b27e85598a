// SPDX-License-Identifier: BSD-3-Clause
// A depth map that was smoothed or scaled down has values at the outlines of objects that lie between the two sides,
// where nothing is. What lies around tells an outline from a slope: two plateaus fill most of the window, with little
// between them.
#include "tools/io/depth_edges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/io/depth_blocks.h"

// Pixels that are read on each side; an outline is found if it is at most half as wide as the window.
enum { REACH = 3 };
_Static_assert(REACH + 2 == HF_IO_EDGE_REACH, "as far as find_ends is asked for");
// The least step that is an outline, relative to the larger value. The background's blur hardly changes below that.
static const float LEAST_STEP = 0.05f;
// Parts of a step. Samples within OF_PLATEAU of its end are the plateau; those within MIXED of it are left alone;
// neighbours in an outline differ by at least STEEP.
static const float OF_PLATEAU = 0.1f, MIXED = 0.05f, STEEP = 0.2f;
// A slope is not an outline: both plateaus together fill less than BOTH of the window. Where a slope begins, one of them
// fills less than LESSER of it, and a wider window exceeds that end by more than CLIMB of the step.
static const float BOTH = 0.5f, LESSER = 0.2f, CLIMB = 0.3f;

struct window {
    const float *depth;
    int width, height, x, y;
};

static float at(const struct window *w, int dx, int dy)
{
    const int x = w->x + dx < 0 ? 0 : w->x + dx >= w->width ? w->width - 1 : w->x + dx;
    const int y = w->y + dy < 0 ? 0 : w->y + dy >= w->height ? w->height - 1 : w->y + dy;
    return w->depth[(size_t)y * (size_t)w->width + (size_t)x];
}

// The least and the largest value around. Returns 0 if one is not finite.
static int find_ends(const struct window *w, int reach, float ends[2])
{
    ends[0] = INFINITY;
    ends[1] = -INFINITY;
    for (int dy = -reach; dy <= reach; dy++)
        for (int dx = -reach; dx <= reach; dx++) {
            const float d = at(w, dx, dy);
            if (!isfinite(d))
                return 0;
            ends[0] = fminf(ends[0], d);
            ends[1] = fmaxf(ends[1], d);
        }
    return 1;
}

// The mean of the plateau's nearest pixels.
static float plateau_at(const struct window *w, float end, float tolerance)
{
    for (int ring = 1; ring <= REACH; ring++) {
        float sum = 0;
        int count = 0;
        for (int dy = -ring; dy <= ring; dy++)
            for (int dx = -ring; dx <= ring; dx++) {
                const float d = at(w, dx, dy);
                if ((abs(dx) == ring || abs(dy) == ring) && fabsf(d - end) <= tolerance) {
                    sum += d;
                    count++;
                }
            }
        if (count)
            return sum / (float)count;
    }
    return end;
}

static float sharpen_one(const struct window *w)
{
    const float d = at(w, 0, 0);
    float near_by[2], ends[2];
    if (!find_ends(w, 1, near_by) || near_by[0] == near_by[1] || !find_ends(w, REACH, ends))
        return d;
    const float step = ends[1] - ends[0], largest = fmaxf(fabsf(ends[0]), fabsf(ends[1]));
    if (!(step >= LEAST_STEP * largest) || near_by[1] - near_by[0] < STEEP * step || d - ends[0] < MIXED * step ||
        ends[1] - d < MIXED * step)
        return d;
    int on[2] = {0, 0};
    for (int dy = -REACH; dy <= REACH; dy++)
        for (int dx = -REACH; dx <= REACH; dx++) {
            const float other = at(w, dx, dy);
            on[0] += other - ends[0] <= OF_PLATEAU * step;
            on[1] += ends[1] - other <= OF_PLATEAU * step;
        }
    const float all = (2 * REACH + 1) * (2 * REACH + 1);
    if ((float)(on[0] + on[1]) < BOTH * all)
        return d;
    const int lesser = on[1] < on[0];
    float beyond[2];
    if ((float)on[lesser] < LESSER * all && find_ends(w, HF_IO_EDGE_REACH, beyond) &&
        fabsf(beyond[lesser] - ends[lesser]) > CLIMB * step)
        return d;
    return plateau_at(w, d - ends[0] < ends[1] - d ? ends[0] : ends[1], OF_PLATEAU * step);
}

// Slightly less than the least difference of neighbours in an outline, relative to the larger; the product is rounded.
static const float LEAST_NEAR_BY = 0.99f * 0.05f * 0.2f;

// The least and the largest value of three rows from x on; infinite if one is not finite.
static void ends_of_columns(const struct hf_io_depth *s, int x, int n, int y, float *least, float *largest)
{
    const float *row[3];
    for (int k = 0; k < 3; k++) {
        const int v = y + k - 1 < 0 ? 0 : y + k - 1 >= s->height ? s->height - 1 : y + k - 1;
        row[k] = s->from + (size_t)v * (size_t)s->width + (size_t)x;
    }
    for (int i = 0; i < n; i++) {
        const float a = row[0][i], b = row[1][i], c = row[2][i];
        const float low = a < b ? a : b, high = a < b ? b : a, none = (a - a) + (b - b) + (c - c);
        const int finite = none == 0;
        least[i] = finite ? (low < c ? low : c) : -INFINITY;
        largest[i] = finite ? (high > c ? high : c) : INFINITY;
    }
}

// Where 3 x 3 pixels differ too little, as in most of a picture, nothing else is checked.
static long long sharpen_block(const struct hf_io_depth *s, const void *unused, int x0, int n, int y)
{
    float least[HF_IO_DEPTH_BLOCK + 2], largest[HF_IO_DEPTH_BLOCK + 2];
    long long changed = 0;
    (void)unused;
    const int from = x0 > 0 ? x0 - 1 : 0, to = x0 + n < s->width ? x0 + n + 1 : s->width;
    float *low = least + (from == x0), *high = largest + (from == x0);
    ends_of_columns(s, from, to - from, y, low, high);
    least[0] = from == x0 ? least[1] : least[0];
    largest[0] = from == x0 ? largest[1] : largest[0];
    least[n + 1] = to == x0 + n ? least[n] : least[n + 1];
    largest[n + 1] = to == x0 + n ? largest[n] : largest[n + 1];
    for (int i = 0; i < n; i++) {
        const float ends[2] = {fminf(fminf(least[i], least[i + 1]), least[i + 2]),
                               fmaxf(fmaxf(largest[i], largest[i + 1]), largest[i + 2])};
        const float step = ends[1] - ends[0];
        if (!(step > 0 && step < INFINITY && step >= LEAST_NEAR_BY * fmaxf(fabsf(ends[0]), fabsf(ends[1]))))
            continue;
        const struct window w = {s->from, s->width, s->height, x0 + i, y};
        float *d = s->to + (size_t)y * (size_t)s->width + (size_t)(x0 + i), sharp = sharpen_one(&w);
        changed += memcmp(&sharp, d, sizeof sharp) != 0;  // a value that is not a number stays so
        *d = sharp;
    }
    return changed;
}

int hf_io_sharpen_depth(float *depth, int width, int height, const struct hf_io_run *run, long long *changed)
{
    return hf_io_depth_blocks(depth, width, height, run, sharpen_block, NULL, changed);
}
