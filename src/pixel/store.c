// SPDX-License-Identifier: BSD-3-Clause
// Rows of the result on their way to the caller's picture: only what lies in the region is written there.
#include <string.h>

#include "pixel/pass_c.h"

enum { LANES = 64, PIXEL = 16 };  // lanes in one call; the most bytes of a pixel

// Store part of a row, of at most LANES lanes: write all into a local buffer, and copy the part in the region.
static uint64_t store_block(const struct hf_frame *f, int x, int y, int n, const float *const even[4],
                            const float *const odd[4])
{
    const int first = hf_max(2 * x, f->s->region.x0), end = hf_min(2 * (x + n), f->s->region.x1);
    uint8_t row[4][2 * LANES * PIXEL];
    struct hf_image block = *f->dst;
    if (first >= end)
        return 0;
    for (int p = 0; p < hf_plane_count(f->dst); p++) {
        // As a number, since a pointer to before the array is undefined. The kernel adds the bytes again.
        block.data[p] = (void *)((uintptr_t)row[p] - (uintptr_t)hf_row_bytes(f->dst->format, 2 * x));
        block.stride[p] = 0;
    }
    const uint64_t clamped = f->k->store[f->dst->format](&block, x, y, n, even, odd);
    for (int p = 0; p < hf_plane_count(f->dst); p++)
        memcpy((uint8_t *)f->dst->data[p] + (ptrdiff_t)y * f->dst->stride[p] + hf_row_bytes(f->dst->format, first),
               row[p] + hf_row_bytes(f->dst->format, first - 2 * x), hf_row_bytes(f->dst->format, end - first));
    return clamped;
}

uint64_t hf_store_lanes(const struct hf_frame *f, int x, int y, int n, const float *const even[4],
                        const float *const odd[4])
{
    const struct hf_rect r = f->s->region;
    uint64_t clamped = 0;
    if (!f->s->part || (y >= r.y0 && y < r.y1 && 2 * x >= r.x0 && 2 * (x + n) <= r.x1))
        return f->k->store[f->dst->format](f->dst, x, y, n, even, odd);
    for (int i = 0; i < n && y >= r.y0 && y < r.y1; i += LANES) {
        const float *e[4] = {NULL}, *o[4] = {NULL};
        for (int c = 0; c < 4; c++) {
            e[c] = even[c] ? even[c] + i : NULL;
            o[c] = odd[c] ? odd[c] + i : NULL;
        }
        clamped += store_block(f, x + i, y, hf_min(n - i, LANES), e, o);
    }
    return clamped;
}
