// SPDX-License-Identifier: BSD-3-Clause
// Runs the hexagon's two passes alternately on bands of rows of a tile, for one field and then the other. Pass 2 reads
// what pass 1 made of a band while it is in the cache. Rows that the next band reads too are moved into its place, so
// no row is made twice.
#include <string.h>

#include "engine/hexagon/kernels.h"

// The results of pass 1 for a band: planes of rows, with the rows above and below that pass 2 reads.
struct band {
    float *memory;
    ptrdiff_t stride;
    int rows, planes, left;
};

static int scale_of(const struct hf_setup *s)
{
    return hf_hexagon(s)->half ? 1 : 2;
}

static struct band band_of(const struct hf_setup *s, int width)
{
    const struct hf_hexagon *h = hf_hexagon(s);
    const int scale = scale_of(s), left = (h->left * scale + 15) & ~15, right = (h->right * scale + 15) & ~15;
    return (struct band){.stride = left + ((width * scale + 30) & ~15) + right + HF_PAD,
                         .rows = (h->above + HF_HEXAGON_BAND + h->below) * scale,
                         .left = left};
}

size_t hf_hexagon_band_floats(const struct hf_setup *s, int width)
{
    const struct band b = band_of(s, width);
    return (2 * (size_t)s->channels + 4) * (size_t)b.rows * (size_t)b.stride + HF_PAD;
}

// Let the field's buffers point into the band; (x, y) is its first half-resolution pixel.
static void place(struct hf_frame *f, struct band *b, int x, int y)
{
    static const enum hf_hexagon_made made[2][3] = {{HF_HEXAGON_NEAR_U, HF_HEXAGON_NEAR_B, HF_HEXAGON_NEAR_W},
                                                    {HF_HEXAGON_FAR_U, HF_HEXAGON_FAR_B, HF_HEXAGON_FAR_W}};
    const struct hf_hexagon *h = hf_hexagon(f->s);
    const int scale = scale_of(f->s);
    float *memory = b->memory + b->left - (x * scale & ~15) - (y - h->above) * scale * b->stride;
    b->planes = 0;
    for (int i = 0; i < 3; i++) {
        struct hf_buf *buf = &f->buf[hf_hexagon_made(f, made[f->far][i]) - f->buf];
        buf->stride = b->stride;
        for (int c = 0; c < (i == 2 ? 4 : f->s->channels); c++)
            buf->ch[c] = memory + b->planes++ * b->rows * b->stride;
    }
}

// Pass 1 of a part beyond the frame, in working pixels: far light continues there, and nothing is near.
static void beyond(const struct hf_frame *f, const struct band *b, struct hf_rect r)
{
    if (r.x0 >= r.x1 || r.y0 >= r.y1)
        return;
    if (f->far) {
        hf_hexagon_kernels(f)->beyond(f, r);
        return;
    }
    const struct hf_buf *first = hf_hexagon_made(f, HF_HEXAGON_NEAR_U);
    for (int i = 0; i < b->planes; i++)
        for (int y = r.y0; y < r.y1; y++)
            memset(hf_at(first, 0, r.x0, y) + i * b->rows * b->stride, 0, (size_t)(r.x1 - r.x0) * sizeof(float));
}

// Pass 1 of some rows (half-resolution pixels), inside the frame and around it. It goes from left to right, because
// vectors write beyond the right end of what they are asked for.
static void make_rows(const struct hf_frame *f, const struct band *b, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const int scale = scale_of(s);
    const struct hf_rect inside = {hf_max(r.x0, 0), hf_max(r.y0, 0), hf_min(r.x1, s->half_width),
                                   hf_min(r.y1, s->half_height)};
    const struct hf_rect all = {r.x0 * scale, r.y0 * scale, r.x1 * scale, r.y1 * scale};
    const int top = hf_max(hf_min(0, all.y1), all.y0), bottom = hf_min(hf_max(hf_hexagon_height(s), all.y0), all.y1);
    if (top < bottom) {
        beyond(f, b, (struct hf_rect){all.x0, top, 0, bottom});
        hf_hexagon_kernels(f)->first(f, inside);
        beyond(f, b, (struct hf_rect){hf_hexagon_width(s), top, all.x1, bottom});
    }
    beyond(f, b, (struct hf_rect){all.x0, all.y0, all.x1, top});
    beyond(f, b, (struct hf_rect){all.x0, bottom, all.x1, all.y1});
}

static void blur(const struct hf_frame *frame, struct hf_rect r, unsigned field)
{
    struct hf_frame f = *frame;
    const struct hf_setup *s = f.s;
    const struct hf_hexagon *h = hf_hexagon(s);
    struct band b = band_of(s, r.x1 - r.x0);
    const int scale = scale_of(s);
    b.memory = f.work;
    f.near = field == HF_NEAR;
    f.far = field == HF_FAR;
    struct hf_rect make = {.x0 = r.x0 - h->left, .x1 = r.x1 + h->right, .y1 = r.y0 - h->above};
    for (int y = r.y0; y < r.y1 && !hf_stopped(s->stop); y += HF_HEXAGON_BAND) {
        const struct hf_rect out = {r.x0, y, r.x1, hf_min(y + HF_HEXAGON_BAND, r.y1)};
        make.y0 = make.y1;
        make.y1 = out.y1 + h->below;
        place(&f, &b, r.x0, y);
        make_rows(&f, &b, make);
        hf_hexagon_kernels(&f)->second(&f, out);
        for (int i = 0; i < b.planes; i++) {
            float *plane = b.memory + i * b.rows * b.stride;
            const ptrdiff_t by = HF_HEXAGON_BAND * scale;
            memmove(plane, plane + by * b.stride, (size_t)((b.rows - by) * b.stride) * sizeof(float));
        }
    }
}

void hf_hexagon_blur_pass(const struct hf_frame *f, struct hf_rect r)
{
    if (f->near)
        blur(f, r, HF_NEAR);
    if (f->far)
        blur(f, r, HF_FAR);
}
