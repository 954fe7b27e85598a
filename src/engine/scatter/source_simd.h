// SPDX-License-Identifier: BSD-3-Clause
// Scatter: lists of sources on vectors. Nothing is fused: the drawn shares are the same everywhere.
#include <string.h>

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
        const vf blurred = vf_sub(one, vf_saturate(own));
        const vf weight = vf_mul(vf_keep(vf_gt(r, zero), blurred), vf_sub(one, vf_saturate(half)));
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

// Four floats and four whole numbers as vectors of the compiler, which can compare and mask them on every target.
typedef float source_4f __attribute__((vector_size(16)));
typedef int32_t source_4i __attribute__((vector_size(16)));

HF_INLINE int source_any(source_4i v)
{
    uint64_t half[2];
    memcpy(half, &v, sizeof half);
    return (half[0] | half[1]) != 0;
}

// The bins of four adjacent sources: of each channel by its own brightness, -1 where it is 0 or there is no source;
// of the weights (3) that of the brightest channel, the first for black. Also the first and the last bin that any
// falls into.
HF_INLINE void source_bins(const struct hf_source_row *row, int i, const struct hf_bins *bins, source_4i bin[4],
                           int *first, int *last)
{
    const source_4i none = {HF_BINS, HF_BINS, HF_BINS, HF_BINS};
    source_4i is, brightest = none, darkest = {0, 0, 0, 0}, n[3] = {{0}};
    source_4f v[3];
    memcpy(&is, row->picture + i, sizeof is);
    is = is >= 0;
    for (int c = 0; c < 3; c++)
        v[c] = (source_4f)((source_4i)v4_load(row->colour[c] + i) & 0x7fffffff);
    // Most samples are in the first bins, so the darker ones are seldom compared.
    for (int b = 0; b < bins->count - 1; b++) {
        const source_4i less[3] = {v[0] < bins->least[b], v[1] < bins->least[b], v[2] < bins->least[b]};
        if (!source_any(less[0] | less[1] | less[2]))
            break;
        for (int c = 0; c < 3; c++)
            n[c] -= less[c];
    }
    for (int c = 0; c < 3; c++) {
        const source_4i some = is & (v[c] > 0), less = some & (n[c] < brightest), more = some & (n[c] > darkest);
        bin[c] = (n[c] & some) | ~some;
        brightest = (n[c] & less) | (brightest & ~less);
        darkest = (n[c] & more) | (darkest & ~more);
    }
    brightest &= brightest < HF_BINS;  // black
    bin[3] = (brightest & is) | ~is;
    brightest = (brightest & is) | (none & ~is);
    *first = hf_min(hf_min(brightest[0], brightest[1]), hf_min(brightest[2], brightest[3]));
    *last = hf_max(hf_max(darkest[0], darkest[1]), hf_max(darkest[2], darkest[3]));
}

HF_INLINE v4 source_share(v4 v, v4 part)
{
    const v4 s = v4_mul(v, part), t = v4_mul(s, v4_set1(5));
    return v4_sub(t, v4_sub(t, s));
}

// What bin b holds of four sources side by side: colours are transposed to lanes.
HF_INLINE void source_shares(const struct hf_source_row *row, int i, v4 parts, const source_4i bin[4], int b,
                             const double scale[4], vl share[4])
{
    v4 v[4];
    for (int c = 0; c < 4; c++)
        v[c] =
            (v4)((source_4i)source_share(v4_load((c < 3 ? row->colour[c] : row->weight) + i), parts) & (bin[c] == b));
    v4_transpose(v);
    for (int k = 0; k < 4; k++)
        share[k] = vl_from(v[k], scale);
}

// Where four sources fall into several bins, each of these lists all four, with zeros for what is elsewhere: so they
// are drawn together, as four of one bin are.
static void list_row_simd(struct hf_splats lists[HF_BINS], const struct hf_source_row *row, int from, int to,
                          const float *inverse, const struct hf_bins *bins)
{
    // Past the row memory holds arbitrary values, which are no valid sprite numbers.
    const int whole = from + (to - from) / 4 * 4;
    for (int i = from; i < whole; i += 4) {
        const int32_t *p = row->picture + i;
        source_4i bin[4];
        vl share[4];
        float part[4];
        int first, last;
        if ((p[0] & p[1] & p[2] & p[3]) < 0)
            continue;
        for (int k = 0; k < 4; k++)
            part[k] = inverse[hf_max(p[k], 0)];
        source_bins(row, i, bins, bin, &first, &last);
        for (int b = first; b <= last; b++) {
            const source_4i any = (bin[0] == b) | (bin[1] == b) | (bin[2] == b) | (bin[3] == b);
            if (!source_any(any))
                continue;
            struct hf_splats *list = &lists[b];
            int n = list->count;
            source_shares(row, i, v4_load(part), bin, b, bins->scale[b], share);
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
    }
    hf_list_row_c(lists, row, whole, to, inverse, bins);
}
