// SPDX-License-Identifier: BSD-3-Clause
// An 8-bit map turns a smooth surface into terraces, and blur draws their edges as faint contours. Where all values
// around differ by no more than rounding makes of a gentle slope, a value becomes their mean. The edge of an object,
// which is more units high, is then not within reach.
#include "tools/io/depth_steps.h"

#include <string.h>

#include "tools/io/depth_blocks.h"

enum { REACH = 6, BLOCK = HF_IO_DEPTH_BLOCK };
// The units by which values around a number may differ. The extra half is for units that are not exact.
static const float MOST = 2.5f;

// For columns x - REACH to x + n + REACH and rows y - REACH to y + REACH: the least, the largest, and the sum.
struct columns {
    float least[BLOCK + 2 * REACH], largest[BLOCK + 2 * REACH], sum[BLOCK + 2 * REACH];
};

static int clamped(int v, int count)
{
    return v < 0 ? 0 : v < count ? v : count - 1;
}

static void look_at_columns(const struct hf_io_depth *d, int x, int n, int y, struct columns *c)
{
    for (int k = -REACH; k <= REACH; k++) {
        const float *row = d->from + (size_t)clamped(y + k, d->height) * (size_t)d->width;
        float line[BLOCK + 2 * REACH];
        for (int i = 0; i < n + 2 * REACH; i++)
            line[i] = row[clamped(x + i - REACH, d->width)];
        for (int i = 0; i < n + 2 * REACH; i++) {
            const float v = line[i];
            c->least[i] = k == -REACH || v < c->least[i] ? v : c->least[i];
            c->largest[i] = k == -REACH || v > c->largest[i] ? v : c->largest[i];
            c->sum[i] = k == -REACH ? v : c->sum[i] + v;
        }
    }
}

static long long smooth_block(const struct hf_io_depth *d, const void *how, int x, int n, int y)
{
    const float most = *(const float *)how;
    struct columns c;
    float least[BLOCK], largest[BLOCK], sum[BLOCK];
    look_at_columns(d, x, n, y, &c);
    memcpy(least, c.least, sizeof least);
    memcpy(largest, c.largest, sizeof largest);
    memcpy(sum, c.sum, sizeof sum);
    for (int k = 1; k <= 2 * REACH; k++)
        for (int i = 0; i < n; i++) {
            least[i] = c.least[i + k] < least[i] ? c.least[i + k] : least[i];
            largest[i] = c.largest[i + k] > largest[i] ? c.largest[i + k] : largest[i];
            sum[i] += c.sum[i + k];
        }
    float *to = d->to + (size_t)y * (size_t)d->width + (size_t)x;
    long long changed = 0;
    for (int i = 0; i < n; i++)
        if (largest[i] > least[i] && largest[i] - least[i] <= most) {
            to[i] = sum[i] * (1.0f / ((2 * REACH + 1) * (2 * REACH + 1)));
            changed++;
        }
    return changed;
}

int hf_io_smooth_steps(float *depth, int width, int height, float unit, const struct hf_io_run *run, long long *changed)
{
    const float most = MOST * unit;
    return hf_io_depth_blocks(depth, width, height, run, smooth_block, &most, changed);
}
