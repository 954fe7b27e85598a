// SPDX-License-Identifier: BSD-3-Clause
#include "tools/io/depth_blocks.h"

#include <stdlib.h>
#include <string.h>

enum { GROUP = 16 };  // rows per task

struct work {
    struct hf_io_depth d;
    hf_io_depth_block *block;
    const void *how;
    long long *changed;  // count for each group
};

static void change_group(void *arg, int group, int worker)
{
    const struct work *w = arg;
    const int width = w->d.width, end = (group + 1) * GROUP < w->d.height ? (group + 1) * GROUP : w->d.height;
    (void)worker;
    w->changed[group] = 0;
    for (int y = group * GROUP; y < end; y++)
        for (int x = 0; x < width; x += HF_IO_DEPTH_BLOCK) {
            const int n = x + HF_IO_DEPTH_BLOCK < width ? HF_IO_DEPTH_BLOCK : width - x;
            w->changed[group] += w->block(&w->d, w->how, x, n, y);
        }
}

int hf_io_depth_blocks(float *depth, int width, int height, const struct hf_io_run *run, hf_io_depth_block *block,
                       const void *how, long long *changed)
{
    const size_t n = (size_t)width * (size_t)height;
    const int groups = (height + GROUP - 1) / GROUP;
    float *from = malloc(n * sizeof(float));
    long long *counts = malloc((size_t)groups * sizeof *counts);
    const int status = from && counts ? 0 : -1;
    if (!status) {
        struct work w = {{from, depth, width, height}, block, how, counts};
        memcpy(from, depth, n * sizeof(float));
        hf_io_run(run, groups, change_group, &w);
        *changed = 0;
        for (int i = 0; i < groups; i++)
            *changed += counts[i];
    }
    free(from);
    free(counts);
    return status;
}
