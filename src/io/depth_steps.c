// SPDX-License-Identifier: BSD-3-Clause
// A map of 8 bits shows a smooth surface as terraces, whose edges blur draws as faint contours. Where all that lies around
// differs by no more than rounding may have made of a gentle slope, a number becomes the mean of that: no edge of an object,
// which is more units high, is within reach.
#include "io/depth_steps.h"

#include <stdlib.h>
#include <string.h>

enum { REACH = 6, GROUP = 16, BLOCK = 512 };
// Units that may lie between what is around a number. Half of one more: units are not exact.
static const float MOST = 2.5f;

struct smoothing {
    const float *from;
    float *to;
    int width, height;
    float most;
    long long *changed;  // by group
};

// Of columns x - REACH to x + n + REACH, rows y - REACH to y + REACH: the least, the largest, and the sum.
struct columns {
    float least[BLOCK + 2 * REACH], largest[BLOCK + 2 * REACH], sum[BLOCK + 2 * REACH];
};

static int clamped(int v, int count)
{
    return v < 0 ? 0 : v < count ? v : count - 1;
}

static void look_at_columns(const struct smoothing *s, int x, int n, int y, struct columns *c)
{
    for (int k = -REACH; k <= REACH; k++) {
        const float *row = s->from + (size_t)clamped(y + k, s->height) * (size_t)s->width;
        float line[BLOCK + 2 * REACH];
        for (int i = 0; i < n + 2 * REACH; i++)
            line[i] = row[clamped(x + i - REACH, s->width)];
        for (int i = 0; i < n + 2 * REACH; i++) {
            const float v = line[i];
            c->least[i] = k == -REACH || v < c->least[i] ? v : c->least[i];
            c->largest[i] = k == -REACH || v > c->largest[i] ? v : c->largest[i];
            c->sum[i] = k == -REACH ? v : c->sum[i] + v;
        }
    }
}

static void smooth_block(const struct smoothing *s, int x, int n, int y, long long *changed)
{
    struct columns c;
    float least[BLOCK], largest[BLOCK], sum[BLOCK];
    look_at_columns(s, x, n, y, &c);
    memcpy(least, c.least, sizeof least);
    memcpy(largest, c.largest, sizeof largest);
    memcpy(sum, c.sum, sizeof sum);
    for (int k = 1; k <= 2 * REACH; k++)
        for (int i = 0; i < n; i++) {
            least[i] = c.least[i + k] < least[i] ? c.least[i + k] : least[i];
            largest[i] = c.largest[i + k] > largest[i] ? c.largest[i + k] : largest[i];
            sum[i] += c.sum[i + k];
        }
    float *to = s->to + (size_t)y * (size_t)s->width + (size_t)x;
    for (int i = 0; i < n; i++)
        if (largest[i] > least[i] && largest[i] - least[i] <= s->most) {
            to[i] = sum[i] * (1.0f / ((2 * REACH + 1) * (2 * REACH + 1)));
            *changed += 1;
        }
}

static void smooth_group(void *arg, int group, int worker)
{
    const struct smoothing *s = arg;
    const int end = (group + 1) * GROUP < s->height ? (group + 1) * GROUP : s->height;
    (void)worker;
    s->changed[group] = 0;
    for (int y = group * GROUP; y < end; y++)
        for (int x = 0; x < s->width; x += BLOCK)
            smooth_block(s, x, x + BLOCK < s->width ? BLOCK : s->width - x, y, &s->changed[group]);
}

int hf_io_smooth_steps(float *depth, int width, int height, float unit, const struct hf_io_run *run, long long *changed)
{
    const size_t n = (size_t)width * (size_t)height;
    const int groups = (height + GROUP - 1) / GROUP;
    float *from = malloc(n * sizeof(float));
    long long *counts = malloc((size_t)groups * sizeof *counts);
    const int status = from && counts ? 0 : -1;
    if (!status) {
        struct smoothing s = {from, depth, width, height, MOST * unit, counts};
        memcpy(from, depth, n * sizeof(float));
        hf_io_run(run, groups, smooth_group, &s);
        *changed = 0;
        for (int i = 0; i < groups; i++)
            *changed += counts[i];
    }
    free(from);
    free(counts);
    return status;
}
