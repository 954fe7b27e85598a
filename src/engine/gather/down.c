// SPDX-License-Identifier: BSD-3-Clause
// Downsample: what a quad's pixels are, and what of it is near and far. Every pixel counts by its own CoC, so that a
// thin thing that moves by a part of a pixel brings as much light as before.
#include <float.h>

#include "engine/gather/gather.h"

// A quad's CoC of one kind, as what it adds to that field.
struct quad {
    float coc[4], part[4], mean;
};

static struct quad quad_of(const struct hf_frame *f, int even, int odd, int x, int y, int y1, const struct hf_levels *l)
{
    const struct hf_buf *b = &f->buf[HF_BUF_COC];
    struct quad q = {
        .coc = {*hf_at(b, even, x, y), *hf_at(b, odd, x, y), *hf_at(b, even, x, y1), *hf_at(b, odd, x, y1)}};
    for (int i = 0; i < 4; i++)
        q.part[i] = hf_level_part(l, l->gain, q.coc[i]);
    q.mean = 0.25f * ((q.part[0] + q.part[1]) + (q.part[2] + q.part[3]));
    return q;
}

// What of four samples belongs to a field. Where all of them do it is their mean. It is limited in proportion to their
// mean part, by which the field is divided again.
static float part_of(const struct quad *q, const float c[4])
{
    return 0.25f * ((q->part[0] * c[0] + q->part[1] * c[1]) + (q->part[2] * c[2] + q->part[3] * c[3]));
}

static float most_of(const struct quad *q)
{
    return __builtin_fmaxf(__builtin_fmaxf(q->coc[0], q->coc[1]), __builtin_fmaxf(q->coc[2], q->coc[3]));
}

// The mean CoC, in which a pixel counts by its part and its light. Of four equal ones it is that CoC, to the bit.
static float coc_of_light(const struct quad *q, const float light[4])
{
    const float *coc = q->coc;
    const float least = __builtin_fminf(__builtin_fminf(coc[0], coc[1]), __builtin_fminf(coc[2], coc[3]));
    float weight[4], beyond[4];
    for (int i = 0; i < 4; i++) {
        weight[i] = q->part[i] * __builtin_fminf(__builtin_fmaxf(light[i], HF_OF_LIGHT_LEAST), HF_AREA_LARGEST);
        beyond[i] = weight[i] * (coc[i] - least);
    }
    const float all = (weight[0] + weight[1]) + (weight[2] + weight[3]);
    return least + ((beyond[0] + beyond[1]) + (beyond[2] + beyond[3])) / __builtin_fmaxf(all, FLT_MIN);
}

static void down_row(const struct hf_frame *f, int y, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const int n = r.x1 - r.x0, y1 = hf_min(2 * y + 1, s->height - 1);
    const struct hf_buf *coc4 = &f->buf[HF_BUF_COC4];
    float *lane[2][2][4];  // [row][odd][channel]
    for (int i = 0; i < 16; i++)
        lane[i >> 3][i >> 2 & 1][i & 3] = hf_line(f, i);
    hf_read_colour(f, r.x0, 2 * y, n, lane[0][0], lane[0][1], f->seen);
    hf_read_colour(f, r.x0, y1, n, lane[1][0], lane[1][1], f->seen);

    float *colour[4], *near[4], *far[4];
    hf_row(&f->buf[HF_BUF_COLOR4], s->channels, r.x0, y, colour);
    hf_row(&f->buf[HF_BUF_COLORNEAR4], s->channels, r.x0, y, near);
    hf_row(&f->buf[HF_BUF_COLORFAR4], s->channels, r.x0, y, far);
    for (int x = 0; x < n; x++) {
        const struct quad nq = quad_of(f, 0, 1, r.x0 + x, 2 * y, y1, hf_gather_levels(s, HF_NEAR));
        const struct quad fq = quad_of(f, 2, 3, r.x0 + x, 2 * y, y1, hf_gather_levels(s, HF_FAR));
        float light[4] = {0};
        for (int c = 0; c < s->channels; c++) {
            const float quad[4] = {lane[0][0][c][x], lane[0][1][c][x], lane[1][0][c][x], lane[1][1][c][x]};
            const float sum = 0.25f * ((quad[0] + quad[1]) + (quad[2] + quad[3])),
                        mean = hf_limited(sum, HF_AREA_LARGEST);
            for (int i = 0; i < 4 && c < 3; i++)
                light[i] = __builtin_fmaxf(light[i], quad[i]);
            f->counts->clamped += !(__builtin_fabsf(sum) <= HF_AREA_LARGEST);
            if (f->near) {
                colour[c][x] = mean;
                near[c][x] = hf_limited(part_of(&nq, quad), HF_AREA_LARGEST * nq.mean);
            }
            if (f->far)
                far[c][x] = hf_limited(part_of(&fq, quad), HF_AREA_LARGEST * fq.mean);
        }
        if (f->near) {
            *hf_at(coc4, HF_AREA_NEAR, r.x0 + x, y) = nq.mean;
            *hf_at(coc4, HF_AREA_NEAR_MOST, r.x0 + x, y) = most_of(&nq);
        }
        if (f->far) {
            *hf_at(coc4, HF_AREA_FAR, r.x0 + x, y) = fq.mean;
            if (!hf_gather_is_simple(s))
                *hf_at(coc4, HF_AREA_FAR_OF_LIGHT, r.x0 + x, y) = coc_of_light(&fq, light);
        }
    }
    if (f->near) {
        hf_store_rgb(f, colour, n);
        hf_store_rgb(f, near, n);
    }
    if (f->far)
        hf_store_rgb(f, far, n);
    // Parts round as alpha does: where that is 1 it is their part.
    for (int i = 0; i < 2 && s->storage == HF_STORAGE_HALF; i++)
        if (i ? f->far : f->near)
            f->k->round_half(hf_at(coc4, i, r.x0, y), n);
}

void hf_gather_down_c(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++)
        down_row(f, y, r);
}
