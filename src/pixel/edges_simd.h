// SPDX-License-Identifier: BSD-3-Clause
// Mixed pixels on vectors, with operations in the order of edges.c and none fused.
#include <float.h>

#include "pixel/edges.h"
#include "simd/simd.h"

// Least and largest radius of a column of three.
HF_INLINE void edges_column(const float *const radius[3], int x, vf *low, vf *high)
{
    const vf a = vf_load(radius[0] + x), b = vf_load(radius[1] + x), c = vf_load(radius[2] + x);
    *low = vf_min(a, vf_min(b, c));
    *high = vf_max(a, vf_max(b, c));
}

static void edges_sure_simd(const float *const radius[3], int n, float *sure, float *middle, float *slope)
{
    vf low[3], high[3];
    edges_column(radius, 0, &low[1], &high[1]);
    low[0] = low[1];
    high[0] = high[1];
    for (int x = 0; x < n; x += VF_N) {
        edges_column(radius, x + VF_N, &low[2], &high[2]);
        const vf least = vf_min(vf_min(vf_back(low[0], low[1]), low[1]), vf_align(low[1], low[2], 1));
        const vf most = vf_max(vf_max(vf_back(high[0], high[1]), high[1]), vf_align(high[1], high[2], 1));
        const vf apart = vf_sub(most, least), from = vf_set1(HF_EDGES_FROM), one = vf_set1(1);
        const vf mixed = vf_mul(vf_sub(apart, from), vf_set1(HF_EDGES_GROWS));
        vf_store(sure + x, vf_sub(one, vf_saturate(mixed)));
        vf_store(slope + x, vf_div(vf_set1(HF_EDGES_SIDES), vf_max(apart, from)));
        vf_store(middle + x, vf_mul(vf_add(least, most), vf_set1(0.5f)));
        for (int i = 0; i < 2; i++) {
            low[i] = low[i + 1];
            high[i] = high[i + 1];
        }
    }
}

HF_INLINE vf edges_front(vf middle, vf slope, vf r)
{
    return vf_saturate(vf_add(vf_mul(vf_sub(middle, r), slope), vf_set1(0.5f)));
}

// For column i of the 5 x 5, on both sides: sums of weights, of weighted radii, and of weighted colours.
HF_INLINE void edges_sums(const struct hf_edge_row *row, int x, int i, const int channels, vf sum[2][6])
{
    const vf middle = vf_load(row->middle + x), slope = vf_load(row->slope + x), faint = vf_set1(HF_EDGES_FAINT);
    vf w[2][5];
    for (int j = 0; j < 5; j++) {
        const vf sure = i == 2 && j == 2 ? vf_zero() : vf_load(row->sure[j] + x + i - 2);
        const vf all = vf_mul(vf_add(sure, faint), vf_set1(hf_edges_weights[j][i]));
        w[0][j] = vf_mul(all, edges_front(middle, slope, vf_load(row->radius[j] + x + i - 2)));
        w[1][j] = vf_sub(all, w[0][j]);
    }
    for (int p = 0; p < channels + 2; p++) {
        vf v[5];
        for (int j = 0; j < 5 && p > 0; j++)
            v[j] = vf_load((p == 1 ? row->radius[j] : row->colour[j][p - 2]) + x + i - 2);
        for (int k = 0; k < 2; k++) {
            vf t[5];
            for (int j = 0; j < 5; j++)
                t[j] = p > 0 ? vf_mul(w[k][j], v[j]) : w[k][j];
            sum[k][p] = vf_add(t[2], vf_add(vf_add(t[1], t[3]), vf_add(t[0], t[4])));
        }
    }
}

HF_INLINE void edges_means(const struct hf_edge_row *row, int x, const int channels, vf mean[2][4], vf radius[2])
{
    vf a[2][6], b[2][6], all[2][6];
    const vf most = vf_set1(FLT_MAX * HF_EDGES_SCALE);
    edges_sums(row, x, 0, channels, all);
    edges_sums(row, x, 4, channels, a);
    for (int i = 0; i < 2 * (channels + 2); i++)
        all[i & 1][i / 2] = vf_add(all[i & 1][i / 2], a[i & 1][i / 2]);
    edges_sums(row, x, 1, channels, a);
    edges_sums(row, x, 3, channels, b);
    for (int i = 0; i < 2 * (channels + 2); i++)
        all[i & 1][i / 2] = vf_add(vf_add(a[i & 1][i / 2], b[i & 1][i / 2]), all[i & 1][i / 2]);
    edges_sums(row, x, 2, channels, a);
    for (int k = 0; k < 2; k++) {
        const vf sum = vf_add(a[k][0], all[k][0]), whole = vf_mul(sum, vf_set1(1 / HF_EDGES_SCALE));
        radius[k] = vf_div(vf_add(a[k][1], all[k][1]), sum);
        for (int c = 0; c < channels; c++)
            mean[k][c] = vf_between(vf_div(vf_add(a[k][2 + c], all[k][2 + c]), whole), vf_sub(vf_zero(), most), most);
    }
}

HF_INLINE vf edges_share(const vf own[4], vf mean[2][4], vf a0)
{
    vf along = vf_zero(), apart = vf_zero(), largest = vf_zero(), off = vf_zero();
    for (int c = 0; c < 3; c++) {
        const vf f = mean[0][c], b = mean[1][c], d = vf_sub(f, b);
        along = vf_max(vf_abs(vf_between(vf_sub(own[c], b), vf_zero(), d)), along);
        apart = vf_max(vf_abs(d), apart);
        largest = vf_max(vf_max(vf_abs(f), vf_abs(b)), largest);
    }
    const vf least = vf_mul(vf_set1(HF_EDGES_ALIKE), largest);
    const vf a = vf_div(vf_add(along, vf_mul(least, a0)), vf_add(apart, least));
    for (int c = 0; c < 3; c++) {
        const vf mixture = vf_add(mean[1][c], vf_mul(a, vf_sub(mean[0][c], mean[1][c])));
        off = vf_max(vf_abs(vf_sub(own[c], mixture)), off);
    }
    const vf trusted = vf_add(a0, vf_mul(vf_sub(a, a0), vf_div(apart, vf_add(apart, off))));
    return vf_select(vf_gt(apart, vf_zero()), trusted, a0);
}

HF_INLINE vf edges_with_sharp(vf r, vf sharp)
{
    const vf zero = vf_zero();
    return vf_select(vf_gt(r, zero), vf_add(r, sharp), vf_keep(vf_lt(r, zero), vf_sub(r, sharp)));
}

// a + t (b - a)
HF_INLINE vf edges_toward(vf a, vf b, vf t)
{
    return vf_add(a, vf_mul(t, vf_sub(b, a)));
}

HF_INLINE void edges_take_vector(const struct hf_edge_row *row, int x, const int channels, vm is_mixed,
                                 const struct hf_sides *out)
{
    const vf own = vf_load(row->radius[2] + x), sure = vf_load(row->sure[2] + x), one = vf_set1(1);
    const vf scale = vf_set1(HF_EDGES_SCALE), unscale = vf_set1(1 / HF_EDGES_SCALE), sharp = vf_set1(row->sharp);
    const vf a0 = edges_front(vf_load(row->middle + x), vf_load(row->slope + x), own), noise = vf_set1(HF_EDGES_NOISE);
    vf mean[2][4], radius[2], v[4];
    edges_means(row, x, channels, mean, radius);
    for (int c = 0; c < channels; c++)
        v[c] = vf_mul(vf_load(row->colour[2][c] + x), scale);
    const vf mixed = vf_sub(one, sure), given = edges_share(v, mean, a0);
    const vf of_front = vf_saturate(vf_mul(vf_sub(given, noise), vf_set1(1 / (1 - 2 * HF_EDGES_NOISE))));
    const vf parts = vf_mul(vf_mul(mixed, vf_sub(one, of_front)), vf_set1(HF_EDGES_PARTS));
    const vf share = vf_mul(vi_to_vf(vf_to_vi(parts)), vf_set1(1.0f / HF_EDGES_PARTS));
    const vf a = vf_sub(one, vf_div(share, mixed)), seen = vf_add(sure, vf_mul(mixed, of_front));
    const vf whole = vf_keep(vf_gt(seen, vf_zero()), vf_div(sure, seen));
    for (int c = 0; c < channels; c++) {
        const vf f = mean[0][c], b = mean[1][c], rest = vf_sub(v[c], edges_toward(b, f, a));
        const vf front = vf_between(vf_add(f, rest), f, v[c]), back = vf_between(vf_add(b, rest), b, v[c]);
        const vf both = vf_mul(vf_between(edges_toward(front, v[c], whole), front, v[c]), unscale);
        vf_store(out->colour[0][c] + x, vf_select(is_mixed, both, vf_load(row->colour[2][c] + x)));
        vf_store(out->colour[1][c] + x, vf_mul(back, unscale));
    }
    const vf front = edges_toward(edges_toward(radius[0], own, a0), own, whole);
    vf_store(out->share + x, vf_keep(is_mixed, share));
    vf_store(out->radius[0] + x, vf_select(is_mixed, edges_with_sharp(front, sharp), vf_load(row->own + x)));
    vf_store(out->radius[1] + x, edges_with_sharp(edges_toward(own, radius[1], a0), sharp));
}

HF_INLINE void edges_take_of(const struct hf_edge_row *row, int n, const int channels, const struct hf_sides *out)
{
    for (int x = 0; x < n; x += VF_N) {
        const vm mixed = vf_lt(vf_load(row->sure[2] + x), vf_set1(1));
        if (vm_any(mixed)) {
            edges_take_vector(row, x, channels, mixed, out);
            continue;
        }
        for (int c = 0; c < channels; c++)
            vf_store(out->colour[0][c] + x, vf_load(row->colour[2][c] + x));
        vf_store(out->radius[0] + x, vf_load(row->own + x));
        vf_store(out->share + x, vf_zero());
    }
}

static void edges_take_simd(const struct hf_edge_row *row, int n, const struct hf_sides *out)
{
    HF_WITH_CHANNELS(row->channels, edges_take_of(row, n, CHANNELS, out));
}
