// SPDX-License-Identifier: BSD-3-Clause
// A map of depth that was smoothed or made smaller has distances at the outlines of objects at which there is nothing. They
// are told from slopes by what lies around: two plateaus that fill most of the window, and little between.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/depth_edges.h"

// Pixels to each side that are looked at: an outline is found that is no wider than half of the window.
enum { REACH = 3 };
_Static_assert(REACH + 2 == HF_IO_EDGE_REACH, "as far as find_ends is asked for");
// The least step that is an outline, of the larger number: below, what is behind is hardly blurred otherwise.
static const float LEAST_STEP = 0.05f;
// Parts of a step. Samples within OF_PLATEAU of its end are the plateau; those within MIXED are left alone; an outline's
// neighbours differ by STEEP.
static const float OF_PLATEAU = 0.1f, MIXED = 0.05f, STEEP = 0.2f;
// A slope is no outline: too little of the window is at either end of it; where it begins, what is at the far end is less
// than a part LESSER of the window, and farther on it goes on by more than CLIMB of the step.
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

// The least and the largest number around; 0: some is none.
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

static long long sharpen_all(const float *from, float *depth, int width, int height)
{
    long long changed = 0;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const struct window w = {from, width, height, x, y};
            float *to = depth + (size_t)y * (size_t)width + (size_t)x;
            const float d = sharpen_one(&w);
            changed += memcmp(&d, to, sizeof d) != 0;  // where it is no number it stays that
            *to = d;
        }
    return changed;
}

int hf_io_sharpen_depth(float *depth, int width, int height, long long *changed)
{
    const size_t n = (size_t)width * (size_t)height;
    float *from = malloc(n * sizeof(float));
    if (!from)
        return -1;
    memcpy(from, depth, n * sizeof(float));
    *changed = sharpen_all(from, depth, width, height);
    free(from);
    return 0;
}
