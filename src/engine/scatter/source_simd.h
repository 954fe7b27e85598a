// SPDX-License-Identifier: BSD-3-Clause
// Scatter: lists of sources on vectors. Nothing is fused: the drawn shares are the same everywhere.
#include "pixel/pass_c.h"
#include "engine/scatter/kernels.h"
#include "simd/simd.h"

static void source_weights_simd(const struct hf_scatter *t, float sign, const float *radius,
                                const float *const colour[3], int channels, int n, float *const out[4])
{
    const vf zero = vf_zero(), one = vf_set1(1);
    for (int i = 0; i < n; i += VF_N) {
        const vf r = vf_mul(vf_set1(sign), vf_load(radius + i));
        const vf half = vf_mul(vf_sub(r, vf_set1(t->half_from)), vf_set1(t->half_slope));
        const vf own = vf_mul(vf_sub(vf_set1(t->fade), r), vf_set1(t->fade_slope));
        const vf blurred = vf_sub(one, vf_min(vf_max(own, zero), one));
        const vf weight = vf_mul(vf_keep(vf_gt(r, zero), blurred), vf_sub(one, vf_min(vf_max(half, zero), one)));
        const vf dim = vf_mul(weight, vf_set1(t->dim));
        vf_store(out[3] + i, weight);
        for (int c = 0; c < channels; c++)
            vf_store(out[c] + i, vf_mul(vf_load(colour[c] + i), dim));
    }
}

static void source_pictures_simd(const float *radius, const float *weight, float scale, int n, int32_t *out)
{
    const vi first = vi_set1(0x3f000000 - (1 << (22 - HF_SIZES_LOG2))), none = vi_set1(-1);
    for (int i = 0; i < n; i += VF_N) {
        const vf r = vf_mul(vf_load(radius + i), vf_set1(scale));
        const vm is = vm_and(vf_gt(r, vf_zero()), vf_gt(vf_load(weight + i), vf_zero()));
        const vi bits = vi_sub(vf_as_vi(vf_max(r, vf_set1(0.5f))), first);
        vf_store(out + i, vf_select(is, vi_as_vf(vi_shr(bits, 23 - HF_SIZES_LOG2)), vi_as_vf(none)));
    }
}

// The bin that all lanes of four adjacent sources fall into; -1: they need several.
HF_INLINE int source_bin(const struct hf_source_row *row, int i, const struct hf_bins *bins)
{
    float least = __builtin_inff(), most = 0;
    int black = 0, b = 0;
    if (bins->count == 1)
        return 0;
    for (int k = 0; k < 4; k++) {
        float own = 0;
        for (int c = 0; c < 3 && row->picture[i + k] >= 0; c++) {
            const float v = __builtin_fabsf(row->colour[c][i + k]);
            least = v > 0 && v < least ? v : least;
            own = v > own ? v : own;
        }
        most = own > most ? own : most;
        black |= own == 0 && row->picture[i + k] >= 0;
    }
    while (b < bins->count - 1 && !(least >= bins->least[b]))
        b++;
    // A black source puts its weight into the first bin.
    return (b == 0 || most < bins->least[b - 1]) && (!black || b == 0) ? b : -1;
}

HF_INLINE v4 source_share(v4 v, v4 part)
{
    const v4 s = v4_mul(v, part), t = v4_mul(s, v4_set1(5));
    return v4_sub(t, v4_sub(t, s));
}

// The shares of four sources side by side: colours are transposed to lanes.
HF_INLINE void source_shares(const struct hf_source_row *row, int i, const float *inverse, const double scale[4],
                             vl share[4])
{
    float part[4];
    for (int k = 0; k < 4; k++)
        part[k] = inverse[hf_max(row->picture[i + k], 0)];
    const v4 parts = v4_load(part);
    v4 v[4] = {source_share(v4_load(row->colour[0] + i), parts), source_share(v4_load(row->colour[1] + i), parts),
               source_share(v4_load(row->colour[2] + i), parts), source_share(v4_load(row->weight + i), parts)};
    v4_transpose(v);
    for (int k = 0; k < 4; k++)
        share[k] = vl_from(v[k], scale);
}

static void list_row_simd(struct hf_splats lists[HF_BINS], const struct hf_source_row *row, int from, int to,
                          const float *inverse, const struct hf_bins *bins)
{
    // Past the row memory holds arbitrary values, which are no valid sprite numbers.
    const int whole = from + (to - from) / 4 * 4;
    for (int i = from; i < whole; i += 4) {
        const int32_t *p = row->picture + i;
        vl share[4];
        if ((p[0] & p[1] & p[2] & p[3]) < 0)
            continue;
        const int b = source_bin(row, i, bins);
        if (b < 0) {
            hf_list_row_c(lists, row, i, i + 4, inverse, bins);
            continue;
        }
        struct hf_splats *list = &lists[b];
        int n = list->count;
        source_shares(row, i, inverse, bins->scale[b], share);
        for (int k = 0; k < 4; k++) {
            if (p[k] < 0)
                continue;
            list->x[n] = row->x + i + k;
            list->y[n] = row->y;
            list->picture[n] = p[k];
            vl_store(list->share[n++], share[k]);
        }
        list->count = n;
    }
    hf_list_row_c(lists, row, whole, to, inverse, bins);
}
