// SPDX-License-Identifier: BSD-3-Clause
// Views on vectors. The order of operations is that of views_row.c.
#include "engine/layers/kernels.h"
#include "engine/layers/views.h"
#include "simd/simd.h"

// What a cat's eye leaves of a view at 1 vector of pixels.
HF_INLINE vf layers_eye(const struct hf_view_eye *e, int v, int x)
{
    const vf dx = vf_sub(vf_set1(e->point[v][0]), vf_load(e->x + x)), dy = vf_set1(e->point[v][1] - e->y);
    const vf inside = vf_sub(vf_set1(1), vf_sqrt(vf_fma(dx, dx, vf_mul(dy, dy))));
    return vf_saturate(vf_fma(inside, vf_set1(e->sharp), vf_set1(e->point[v][2])));
}

// What a row of pixels sees of planes `from` to `end` in one view. `side` vectors side by side hide each other's latency:
// each slice waits for what the one before it leaves open.
HF_INLINE void layers_look(const struct hf_view_row *r, const int channels, const int side, const int partial, int v,
                           int at, int from, int end, const vf part[2], vf open[2], vf sum[5][2])
{
    // The groups of 16 pixels that so many pixels may touch.
    const uint32_t groups = ((uint32_t)2 << (side * VF_N + 14) / 16) - 1;
    for (int i = from; i < end; i++) {
        const struct hf_view_plane *p = &r->plane[i];
        const int x = r->x + at + p->shift[v][0], y = (r->y + p->shift[v][1]) >> p->level;
        // Most of a slice's plane is 0. The bits spare a load that often misses the cache.
        if (!(p->held[y] >> ((x + p->lead) >> 4) & groups))
            continue;
        const float *in = p->at + y * p->row + x;
        vf weight[2];
        vf most = vf_zero();
        for (int j = 0; j < side; j++) {
            weight[j] = vf_load(in + j * VF_N);
            most = vf_max(most, weight[j]);
        }
        if (!vm_any(vf_gt(most, vf_zero())))
            continue;
        for (int j = 0; j < side; j++, in += VF_N) {
            const vf w = partial ? vf_mul(weight[j], part[j]) : weight[j];
            const vf a = vf_min(w, open[j]);
            open[j] = vf_sub(open[j], a);
            for (int c = 0; c < channels; c++)
                sum[c][j] = vf_fma(a, vf_load(in + (c + 1) * p->channel), sum[c][j]);
            sum[4][j] = vf_add(sum[4][j], a);
        }
        // Nothing farther is seen from here.
        if (!vm_any(vf_gt(side > 1 ? vf_max(open[0], open[side - 1]) : open[0], vf_zero())))
            break;
    }
}

HF_INLINE void layers_views_of(const struct hf_view_row *r, const int channels, const int side, const int partial,
                               int at)
{
    vf near[5][2], far[5][2], total[2];
    for (int j = 0; j < side; j++) {
        total[j] = vf_zero();
        for (int c = 0; c < 5; c++)
            near[c][j] = far[c][j] = vf_zero();
    }
    for (int begin = 0; begin < r->views; begin += HF_LAYERS_VIEWS_SUM) {
        vf near_part[5][2], far_part[5][2];
        for (int j = 0; j < side; j++)
            for (int c = 0; c < 5; c++)
                near_part[c][j] = far_part[c][j] = vf_zero();
        for (int v = begin; v < begin + HF_LAYERS_VIEWS_SUM && v < r->views; v++) {
            vf open[2], part[2];
            for (int j = 0; j < side; j++) {
                part[j] = vf_set1(partial && r->part ? r->part[v] : 1);
                if (partial && r->eye)
                    part[j] = vf_mul(part[j], layers_eye(r->eye, v, r->x + at + j * VF_N));
                open[j] = partial ? vf_mul(part[j], vf_set1(r->one)) : vf_set1(r->one);
                total[j] = partial ? vf_add(total[j], open[j]) : total[j];
            }
            layers_look(r, channels, side, partial, v, at, 0, r->far, part, open, near_part);
            layers_look(r, channels, side, partial, v, at, r->far, r->planes, part, open, far_part);
        }
        for (int j = 0; j < side; j++)
            for (int c = 0; c < 5; c++) {
                near[c][j] = vf_add(near[c][j], near_part[c][j]);
                far[c][j] = vf_add(far[c][j], far_part[c][j]);
            }
    }
    for (int j = 0; j < side; j++) {
        for (int c = 0; c < 5; c++)
            if (c < channels || c == 4) {
                vf_store(r->near[c] + at + j * VF_N, near[c][j]);
                vf_store(r->beyond[c] + at + j * VF_N, far[c][j]);
            }
        if (r->eye)
            vf_store(r->eye->total + at + j * VF_N, total[j]);
    }
}

HF_INLINE void layers_views_row(const struct hf_view_row *r, const int channels, const int partial)
{
    int x = 0;
    for (; x + 2 * VF_N <= r->n; x += 2 * VF_N)
        layers_views_of(r, channels, 2, partial, x);
    for (; x < r->n; x += VF_N)
        layers_views_of(r, channels, 1, partial, x);
}

static void layers_views_simd(const struct hf_view_row *r)
{
    if (r->eye || r->part)
        HF_WITH_CHANNELS(r->channels, layers_views_row(r, CHANNELS, 1));
    else
        HF_WITH_CHANNELS(r->channels, layers_views_row(r, CHANNELS, 0));
}
