// SPDX-License-Identifier: BSD-3-Clause
// Scatter's disocclusion fill (pixel/behind.c). Far pixels reach behind near ones with their own sprites, sharp pixels
// do not. So sharp and far pixels are averaged separately.
#include "engine/scatter/behind.h"

#include "pixel/pass_c.h"
#include "engine/scatter/kernels.h"
#include "engine/scatter/walk.h"

// Planes: sharp colours x weight, far colours x weight, and both weights. An alpha that is 1 everywhere has no plane.
static int channels_of(const struct hf_setup *s)
{
    return hf_scatter(s)->opaque ? 3 : s->channels;
}

int hf_scatter_behind_planes(int channels)
{
    return 2 * channels + 2;
}

static void near_quads(const struct hf_frame *f, int q, int from, int to, float *out)
{
    hf_behind_near(f, &f->buf[HF_BUF_RADIUS], 0, q, from, to, out);
}

// Add the visible part of a quad's two backs to the planes. A back is the sample closest to what its front hides, so it
// counts fully, but its weight starts at 0.
static unsigned add_backs(const struct hf_frame *f, int x, int y, float widest, int quad,
                          float *const plane[HF_BEHIND_PLANES])
{
    const struct hf_scatter *t = hf_scatter(f->s);
    const int channels = channels_of(f->s);
    float weight[2][2] = {{0}}, v[2] = {0};
    unsigned seen = 0;
    for (int i = 0; i < hf_min(2, f->s->width - x); i++) {
        const float share = *hf_at(&f->buf[HF_BUF_BACK_AT], 0, x + i, y);
        const float r = *hf_at(&f->buf[HF_BUF_BACK_AT], 1, x + i, y);
        float *out[2] = {&weight[0][i], &weight[1][i]};
        if (!(share > 0))
            continue;
        hf_seen_weights_c(t, &r, &widest, 0, 1, out);
        for (int k = 0; k < 2; k++)
            weight[k][i] *= hf_saturate(64 * share);
    }
    for (int k = 0; k < 2; k++) {
        if (!(weight[k][0] + weight[k][1] > 0))
            continue;
        for (int c = 0; c < channels; c++) {
            for (int i = 0; i < 2; i++)
                v[i] = weight[k][i] > 0 ? *hf_at(&f->buf[HF_BUF_BACK], c, x + i, y) * (weight[k][i] * t->dim) : 0;
            plane[k * channels + c][quad] += v[0] + v[1];
        }
        plane[2 * channels + k][quad] += weight[k][0] + weight[k][1];
        seen |= ((1u << channels) - 1) << k * channels | 1u << (2 * channels + k);
    }
    return seen;
}

static unsigned seen_quads(const struct hf_frame *f, int q, int from, int to, const float *widest, float *line,
                           float *const plane[HF_BEHIND_PLANES])
{
    const struct hf_scatter *t = hf_scatter(f->s);
    const int channels = channels_of(f->s), x0 = 2 * from, n = hf_min(2 * to, f->s->width) - x0;
    float *const weight[2] = {line, line + n + HF_PAD}, *one = line + 2 * (n + HF_PAD);
    unsigned seen = 0;
    for (int x = 0; x < n; x++)
        one[x] = 1;
    for (int y = 2 * q; y < hf_min(2 * q + 2, f->s->height); y++) {
        const float *share = hf_back_shares(f, x0, y, n);
        const int some =
            hf_scatter_kernels(f)->seen_weights(t, hf_at(&f->buf[HF_BUF_RADIUS], 0, x0, y), widest, 0, n, weight);
        for (int x = hf_edges_next(share, 0, n); x < n; x = hf_edges_next(share, x + 1, n))
            for (int k = 0; k < 2; k++)
                weight[k][x] *= 1 - share[x];
        for (int k = 0; k < 2; k++) {
            if (!(some >> k & 1))
                continue;
            for (int c = 0; c < channels; c++)
                hf_behind_add(f, hf_at(&f->buf[HF_BUF_SOURCE], c, x0, y), weight[k], t->dim, n,
                              plane[k * channels + c]);
            hf_behind_add(f, one, weight[k], 1, n, plane[2 * channels + k]);
            seen |= ((1u << channels) - 1) << k * channels | 1u << (2 * channels + k);
        }
        for (int x = hf_edges_next(share, 0, n); x < n; x = hf_edges_next(share, (x | 1) + 1, n))
            seen |= add_backs(f, x0 + (x & ~1), y, widest[x >> 1], x >> 1, plane);
    }
    return seen;
}

const struct hf_behind_source hf_scatter_behind_source = {near_quads, seen_quads};

int hf_scatter_behind_begin(const struct hf_scatter_behind *b, const struct hf_scatter_row *row, const float *back,
                            int backs)
{
    int near = 0;
    for (int i = 0; i < row->n; i++)
        near += row->radius[i] < 0;
    for (int i = 0; i < backs; i++)
        near += back[i] < 0;
    for (int k = 0; k < 2 && near; k++)
        hf_behind_sample(b->behind, b->f, 2 * channels_of(b->f->s) + k, row->x, row->y, row->n, b->weight[k]);
    return near > 0;
}

void hf_scatter_behind_row(const struct hf_scatter_behind *b, const struct hf_scatter_row *row, int channel,
                           const float *own, float *out)
{
    const float *const colour[2] = {b->colour[0], b->colour[1]};
    for (int k = 0; k < 2; k++)
        hf_behind_sample(b->behind, b->f, k * channels_of(b->f->s) + channel, row->x, row->y, row->n, b->colour[k]);
    hf_scatter_kernels(b->f)->behind_blend(row, (const float *const *)b->weight, colour, own, out);
}

// What begins to be seen begins without a corner. Where nothing else is seen, the little that a lamp counts would show at
// once.
int hf_seen_weights_c(const struct hf_scatter *t, const float *radius, const float *widest, int first, int n,
                      float *const out[2])
{
    int some = 0;
    for (int x = first; x < n; x++) {
        const float r = radius[x];
        const float own = r > 0 ? hf_own_part(t, r) : hf_smoothstep(hf_behind_seen(r, widest[x >> 1]));
        out[0][x] = 0.25f * own;
        out[1][x] = r > 0 ? 0.25f * (1 - own) : 0;
        some |= (out[0][x] > 0) | (out[1][x] > 0) << 1;
    }
    return some;
}

// The far sprites are trusted by how much of them reaches the pixel. With little, they are the rim of what lies on one
// side of an object, and in the object's middle another side's rim would begin abruptly.
void hf_behind_blend_c(const struct hf_scatter_row *row, const float *const weight[2], const float *const colour[2],
                       const float *own, float *out)
{
    const struct hf_scatter *t = hf_scatter(row->setup);
    for (int i = 0; i < row->n; i++) {
        const float far_weight = row->far ? row->far_weight[i] : 0, near_weight = row->near ? row->near_weight[i] : 0;
        const float mine = own[i] * t->dim;
        const float front = row->near ? hf_field_colour(t, mine, row->near[i], near_weight) : mine;
        const float far = row->far ? hf_field_colour(t, mine, row->far[i], far_weight) : mine;
        const float reached = hf_saturate(16 * far_weight), sharp = weight[0][i], blurred = weight[1][i];
        float v = hf_scatter_mix(front, far, reached);
        if (sharp + blurred > 0) {
            float seen = v;
            if (blurred > 0)
                seen = hf_scatter_mix(colour[1][i] / blurred, far, hf_saturate(far_weight));
            if (sharp > 0)
                seen = hf_scatter_mix(seen, colour[0][i] / sharp, sharp / (sharp + blurred));
            v = hf_scatter_mix(seen, v, HF_SCATTER_NOTHING / ((sharp + blurred) + HF_SCATTER_NOTHING));
        }
        out[i] = v;
    }
}
