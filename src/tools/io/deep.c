// SPDX-License-Identifier: BSD-3-Clause
// A deep picture as the rest of the programs sees it: flat, with the depth of what is seen.
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "tools/io/file.h"

struct hf_io_deep hf_io_deep(const struct hf_io_file *file)
{
    const struct hf_exr_samples *s = &file->samples;
    const struct hf_io_view *v = &file->views.view[0];
    if (!s->first)
        return (struct hf_io_deep){NULL};
    return (struct hf_io_deep){.first = s->first,
                               .samples = s->first[(size_t)v->width * (size_t)v->height],
                               .colour = {s->colour[0], s->colour[1], s->colour[2]},
                               .alpha = s->colour[3],
                               .depth = s->depth,
                               .back = s->back};
}

// A sample and its place in the file.
struct order {
    float depth;
    uint64_t at;
};

struct flattening {
    const struct hf_io_deep *deep;
    const struct hf_io_want *want;
    struct order *orders;
    size_t most;  // samples of a pixel
    int width, height;
};

static int by_depth(const void *a, const void *b)
{
    const struct order *x = a, *y = b;
    return x->depth != y->depth ? (x->depth < y->depth ? -1 : 1) : (x->at > y->at) - (x->at < y->at);
}

static float part(float alpha)
{
    return alpha > 0 ? fminf(alpha, 1) : 0;
}

static void flatten_pixel(const struct flattening *f, struct order *list, size_t pixel)
{
    const struct hf_io_deep *d = f->deep;
    const uint64_t from = d->first[pixel];
    const size_t n = (size_t)(d->first[pixel + 1] - from);
    float sum[4] = {0}, open = 1, depth = INFINITY;
    int sorted = 1;  // as most files are
    for (size_t i = 0; i < n; i++) {
        list[i] = (struct order){isnan(d->depth[from + i]) ? INFINITY : d->depth[from + i], from + i};
        sorted &= i == 0 || list[i - 1].depth <= list[i].depth;
    }
    if (!sorted)
        qsort(list, n, sizeof(*list), by_depth);
    for (size_t i = 0; i < n; i++) {
        const uint64_t at = list[i].at;
        const float alpha = part(d->alpha[at]);
        for (int c = 0; c < 4; c++)
            sum[c] += open * (c < 3 ? d->colour[c][at] : alpha);
        depth = alpha > 0 && open > 0.5f ? list[i].depth : depth;
        open *= 1 - alpha;
    }
    for (int c = 0; c < 4; c++)
        if (f->want->planes[c])
            f->want->planes[c][pixel] = sum[c];
    if (f->want->depth)
        f->want->depth[pixel] = depth;
}

static void flatten_row(void *arg, int y, int worker)
{
    const struct flattening *f = arg;
    for (int x = 0; x < f->width; x++)
        flatten_pixel(f, f->orders + f->most * (size_t)worker, (size_t)y * (size_t)f->width + (size_t)x);
}

int hf_io_decode_deep(struct hf_io_file *file, const struct hf_io_want *want, const struct hf_io_run *run,
                      struct hf_io_error *err)
{
    const struct hf_io_view *v = &file->views.view[want->view];
    if (v->depth_part < 0)
        return hf_io_fail(err, "%s: no depth channel Z among the samples", file->path);
    if (!file->samples.first && hf_exr_read_deep(file->exr, v, run, &file->samples, err)) {
        hf_exr_free_deep(&file->samples);
        return -1;
    }
    const struct hf_io_deep deep = hf_io_deep(file);
    struct flattening f = {.deep = &deep, .want = want, .most = 1, .width = v->width, .height = v->height};
    for (size_t i = 0; i < (size_t)v->width * (size_t)v->height; i++)
        f.most = deep.first[i + 1] - deep.first[i] > f.most ? (size_t)(deep.first[i + 1] - deep.first[i]) : f.most;
    f.orders = malloc(f.most * (size_t)hf_io_run_workers(run) * sizeof(*f.orders));
    if (!f.orders)
        return hf_io_fail(err, "%s: out of memory", file->path);
    hf_io_run(run, v->height, flatten_row, &f);
    free(f.orders);
    return 0;
}
