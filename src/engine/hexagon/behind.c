// SPDX-License-Identifier: BSD-3-Clause
// The hexagon's disocclusion fill (pixel/behind.c): what lies behind near pixels is averaged from all that is visible
// around them, sharp or far. A quad's mean is premultiplied by its visible part.
#include <string.h>

#include "engine/hexagon/kernels.h"
#include "pixel/behind.h"

// ---- full resolution ----

static void near_full(const struct hf_frame *f, int q, int from, int to, float *out)
{
    hf_behind_near(f, &f->buf[HF_HEXAGON_WEIGHT], 1, q, from, to, out);
}

// Stored colours are divided by radii above a pixel; the weights multiply them back.
static unsigned seen_full(const struct hf_frame *f, int q, int from, int to, const float *widest, float *line,
                          float *const plane[HF_BEHIND_PLANES])
{
    const struct hf_buf *weight = &f->buf[HF_HEXAGON_WEIGHT];
    const int channels = f->s->channels, x0 = 2 * from, n = hf_min(2 * to, f->s->width) - x0;
    unsigned seen = 0;
    for (int y = 2 * q; y < hf_min(2 * q + 2, f->s->height); y++) {
        const float *radius = hf_at(weight, 1, x0, y);
        float most = 0;
        for (int x = 0; x < n; x++) {
            const float r = radius[x], size = r < 0 ? -r : r, part = r < 0 ? hf_behind_seen(r, widest[x >> 1]) : 1;
            line[x] = part * (size > 1 ? size : 1);
            most = line[x] > most ? line[x] : most;
        }
        if (!(most > 0))
            continue;
        for (int c = 0; c < channels; c++)
            hf_behind_add(f, hf_at(&f->buf[HF_HEXAGON_COLOUR], c, x0, y), line, 0.25f, n, plane[c]);
        hf_behind_add(f, hf_at(weight, 0, x0, y), line, 0.25f, n, plane[channels]);
        seen = (2u << channels) - 1;
    }
    return seen;
}

// Adds the stored visible part of each quad, and the near part of quads that are less near than others around.

static void near_half(const struct hf_frame *f, int q, int from, int to, float *out)
{
    const float *radius = hf_at(&f->buf[HF_HEXAGON_NEAR_WEIGHT_2], 1, from, q);
    for (int x = 0; x < to - from; x++)
        out[x] = 2 * radius[x] > out[x] ? 2 * radius[x] : out[x];
}

// Add to the visible part of each quad, which is kept already, the near part that is much less near than its surroundings.
static unsigned seen_half(const struct hf_frame *f, int q, int from, int to, const float *widest, float *line,
                          float *const plane[HF_BEHIND_PLANES])
{
    const int channels = f->s->channels, n = to - from;
    const float *radius = hf_at(&f->buf[HF_HEXAGON_NEAR_WEIGHT_2], 1, from, q);
    const float *near_weight = hf_at(&f->buf[HF_HEXAGON_NEAR_WEIGHT_2], 0, from, q);
    const float *weight = hf_at(&f->buf[HF_HEXAGON_SEEN_WEIGHT_2], 0, from, q);
    float most = 0;
    for (int x = 0; x < n; x++) {
        const float r = -2 * radius[x], more = hf_behind_seen(r, widest[x]) - hf_saturate(1.5f + r);
        line[x] = more * (radius[x] > 1 ? radius[x] : 1);
        const float all = weight[x] + line[x] * near_weight[x];
        plane[channels][x] += all;
        most = all > most ? all : most;
    }
    for (int c = 0; c < channels; c++) {
        const float *near = hf_at(&f->buf[HF_HEXAGON_NEAR_COLOUR_2], c, from, q);
        const float *colour = hf_at(&f->buf[HF_HEXAGON_SEEN_COLOUR_2], c, from, q);
        for (int x = 0; x < n; x++)
            plane[c][x] += colour[x] + line[x] * near[x];
    }
    return most > 0 ? (2u << channels) - 1 : 0;
}

// ---- the pass ----

// Copy plane p of a block to a buffer's channel, at the working resolution. h NULL: nothing is visible.
static void put(const struct hf_frame *f, const struct hf_behind *h, int p, const struct hf_buf *out, int c,
                struct hf_rect block)
{
    const struct hf_rect r = hf_hexagon_rect(f->s, block);
    const int n = r.x1 - r.x0, half = hf_hexagon(f->s)->half;
    for (int y = r.y0; y < r.y1; y++) {
        float *row = hf_at(out, c, r.x0, y);
        if (!h)
            memset(row, 0, sizeof *row * (size_t)n);
        else if (half)
            memcpy(row, h->sum[p] + (ptrdiff_t)(y - h->y0) * h->stride + r.x0 - h->x0, sizeof *row * (size_t)n);
        else
            hf_behind_sample(h, f, p, r.x0, y, n, row);
    }
}

void hf_hexagon_behind_pass(const struct hf_frame *f, struct hf_rect r)
{
    static const struct hf_behind_source full = {near_full, seen_full}, half = {near_half, seen_half};
    const struct hf_behind_source *source = hf_hexagon(f->s)->half ? &half : &full;
    const int levels = hf_hexagon(f->s)->behind, channels = f->s->channels;
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y += HF_BEHIND_BLOCK)
        for (int x = r.x0; x < r.x1 && !hf_stopped(f->s->stop); x += HF_BEHIND_BLOCK) {
            const struct hf_rect b = {x, y, hf_min(x + HF_BEHIND_BLOCK, r.x1), hf_min(y + HF_BEHIND_BLOCK, r.y1)};
            struct hf_behind h = {.planes = channels + 1};
            const int is = levels && hf_behind_make(&h, source, f, b, levels, f->work);
            for (int p = 0; p <= channels; p++)
                put(f, is ? &h : NULL, p, hf_hexagon_made(f, p < channels ? HF_HEXAGON_BEHIND : HF_HEXAGON_BEHIND_W),
                    p < channels ? p : 0, b);
        }
}
