// SPDX-License-Identifier: BSD-3-Clause
// Lights behind near pixels (gather.h).
#include "engine/gather/gather.h"

enum { LARGEST = 1, COUNTS = 2 };

static float of_pair(float a, float b)
{
    return a < b ? a : b;
}

// The largest channel; beyond the frame more than any, so that the other side is what counts.
static float largest(const struct hf_frame *f, int x, int y)
{
    const struct hf_buf *b = &f->buf[HF_BUF_COLOR4];
    if (x < 0 || y < 0 || x >= f->s->half_width || y >= f->s->half_height)
        return HF_AREA_LARGEST;
    float most = *hf_at(b, 0, x, y);
    for (int c = 1; c < 3; c++)
        most = *hf_at(b, c, x, y) > most ? *hf_at(b, c, x, y) : most;
    return most;
}

void hf_gather_lights_c(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_reach reach = hf_gather_halo(f->s, HF_HALO_TAPS);
    const struct hf_buf *b = &f->buf[HF_BUF_WEIGHT];
    const int apart = hf_gather(f->s)->lights;
    for (int y = r.y0 - reach.y; y < r.y1 + reach.y && !hf_stopped(f->s->stop); y++)
        for (int x = r.x0 - reach.x; x < r.x1 + reach.x; x++)
            *hf_at(b, LARGEST, x, y) = largest(f, x, y);
    for (int y = r.y0 - reach.y + apart; y < r.y1 + reach.y - apart && !hf_stopped(f->s->stop); y++)
        for (int x = r.x0 - reach.x + apart; x < r.x1 + reach.x - apart; x++) {
            const float sides = of_pair(*hf_at(b, LARGEST, x - apart, y), *hf_at(b, LARGEST, x + apart, y));
            const float upright = of_pair(*hf_at(b, LARGEST, x, y - apart), *hf_at(b, LARGEST, x, y + apart));
            const float beside = HF_LIGHT * (sides > upright ? sides : upright), most = beside > 0 ? beside : 0;
            const float own = *hf_at(b, LARGEST, x, y);
            *hf_at(b, COUNTS, x, y) = own > most ? most / own : 1;
        }
}
