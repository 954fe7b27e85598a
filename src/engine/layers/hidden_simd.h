// SPDX-License-Identifier: BSD-3-Clause
// Hidden samples on vectors. The order of operations is that of hidden.c.
#include "engine/layers/dimmed_vf.h"
#include "engine/layers/hidden.h"
#include "pixel/coc_vf.h"
#include "simd/simd.h"

HF_INLINE vf layers_signed_root(vf v)
{
    const vf s = vf_sqrt(vf_abs(v));
    return vf_select(vf_lt(v, vf_zero()), vf_sub(vf_zero(), s), s);
}

// A row of pixel pairs: which are mixed, and the part that their back is of them.
struct layers_pairs {
    vm mixed[2];
    vf share[2];
};

// Loads such a row, and its weights: a pixel with a tiny back counts partly as itself.
HF_INLINE struct layers_pairs layers_pairs_at(const float *const seen[6], const float *const mixed[6], int x, vf *even,
                                              vf *odd)
{
    const vf one = vf_set1(1), zero = vf_zero();
    struct layers_pairs p;
    vf weight[2];
    for (int i = 0; i < 2; i++) {
        const int at = 2 * x + i * VF_N;
        const vf m = vf_load(mixed[4] + at), s = vf_load(seen[4] + at);
        p.mixed[i] = vf_gt(m, zero);
        p.share[i] = zero;
        weight[i] = s;
        if (!vm_any(p.mixed[i]))
            continue;
        const vf part = vf_mul(vf_set1(HF_LAYERS_EDGE), m), less = vf_max(vf_fnma(part, part, one), zero);
        const vf own = vf_mul(s, vf_mul(less, less));
        weight[i] = vf_select(p.mixed[i], vf_add(m, own), s);
        p.share[i] = vf_keep(p.mixed[i], vf_div(m, weight[i]));
    }
    vf_unzip(weight[0], weight[1], even, odd);
    return p;
}

// Channel c of such a row.
HF_INLINE void layers_pairs(const float *const seen[6], const float *const mixed[6], int c, int x,
                            const struct layers_pairs *p, vf *even, vf *odd)
{
    vf v[2];
    for (int i = 0; i < 2; i++) {
        const int at = 2 * x + i * VF_N;
        v[i] = vf_load(seen[c] + at);
        if (vm_any(p->mixed[i])) {
            const vf own = vf_mul(vf_sub(vf_set1(1), p->share[i]), v[i]);
            v[i] = vf_select(p->mixed[i], vf_fma(p->share[i], vf_load(mixed[c] + at), own), v[i]);
        }
        if (c < 4)
            v[i] = layers_signed_root(v[i]);
    }
    vf_unzip(v[0], v[1], even, odd);
}

HF_INLINE void layers_quads_of(const float *const seen[2][6], const float *const mixed[2][6], const int channels, int n,
                               float *const out[6])
{
    const vf zero = vf_zero(), one = vf_set1(1);
    for (int x = 0; x < n; x += VF_N) {
        struct layers_pairs pairs[2];
        vf r[4], g[4], farthest = vf_set1(HF_LAYERS_NOTHING), sum = zero, radius = zero;
        for (int y = 0; y < 2; y++) {
            pairs[y] = layers_pairs_at(seen[y], mixed[y], x, &g[2 * y], &g[2 * y + 1]);
            layers_pairs(seen[y], mixed[y], 5, x, &pairs[y], &r[2 * y], &r[2 * y + 1]);
        }
        for (int i = 0; i < 4; i++)
            farthest = vf_select(vf_gt(g[i], zero), vf_max(r[i], farthest), farthest);
        for (int i = 0; i < 4; i++) {
            const vf near = vf_fnma(vf_sub(farthest, r[i]), vf_set1(0.5f), one);
            g[i] = vf_mul(g[i], vf_max(near, zero));
            sum = vf_add(sum, g[i]);
            radius = vf_fma(g[i], r[i], radius);
        }
        const vm some = vf_gt(sum, zero);
        const vf inverse = vf_keep(some, vf_div(one, sum));
        vf_store(out[4] + x, vf_mul(sum, vf_set1(0.25f)));
        vf_store(out[5] + x, vf_select(some, vf_mul(radius, inverse), vf_set1(HF_LAYERS_NOTHING)));
        for (int c = 0; c < channels; c++) {
            vf colour = zero;
            for (int y = 0; y < 2; y++) {
                vf even, odd;
                layers_pairs(seen[y], mixed[y], c, x, &pairs[y], &even, &odd);
                colour = vf_fma(g[2 * y], even, colour);
                colour = vf_fma(g[2 * y + 1], odd, colour);
            }
            vf_store(out[c] + x, vf_mul(colour, inverse));
        }
    }
}

static void layers_quads_simd(const float *const seen[2][6], const float *const mixed[2][6], int channels, int n,
                              float *const out[6])
{
    HF_WITH_CHANNELS(channels, layers_quads_of(seen, mixed, CHANNELS, n, out));
}

HF_INLINE void layers_merge_of(const float *const in[3][6], const int channels, float slope, int n, float *const out[6])
{
    for (int x = 0; x < n; x += VF_N) {
        const vf a = vf_load(in[0][5] + x), b = vf_load(in[1][5] + x), c = vf_load(in[2][5] + x);
        const vf farthest = vf_max(vf_max(a, b), c), one = vf_set1(1);
        vf g[3];
        for (int i = 0; i < 3; i++) {
            const vf r = i == 0 ? a : i == 1 ? b : c;
            const vf near = vf_fnma(vf_sub(farthest, r), vf_set1(slope), one);
            g[i] = vf_mul(vf_load(in[i][4] + x), vf_max(near, vf_zero()));
        }
        const vf sum = vf_add(vf_add(g[0], g[1]), g[2]);
        const vm some = vf_gt(sum, vf_zero());
        const vf inverse = vf_keep(some, vf_div(one, sum));
        for (int k = 0; k < channels; k++) {
            const vf v = vf_fma(g[1], vf_load(in[1][k] + x), vf_mul(g[0], vf_load(in[0][k] + x)));
            vf_store(out[k] + x, vf_mul(vf_fma(g[2], vf_load(in[2][k] + x), v), inverse));
        }
        const vf r = vf_mul(vf_fma(g[2], c, vf_fma(g[1], b, vf_mul(g[0], a))), inverse);
        vf_store(out[4] + x, vf_mul(sum, vf_set1(1.0f / 3)));
        vf_store(out[5] + x, vf_select(some, r, vf_set1(HF_LAYERS_NOTHING)));
    }
}

static void layers_merge_simd(const float *const in[3][6], int channels, float slope, int n, float *const out[6])
{
    HF_WITH_CHANNELS(channels, layers_merge_of(in, CHANNELS, slope, n, out));
}

HF_INLINE vf layers_hides(vf more)
{
    return vf_saturate(vf_add(more, more));
}

// Most taps meet nothing that lies far enough behind: a comparison passes over those.
HF_INLINE void layers_taps_of(const struct hf_hidden_tap *const *tap, int count, ptrdiff_t at, const int channels,
                              const float *nearest, int n, float *const sum[7])
{
    for (int x = 0; x < n; x += VF_N) {
        const vf from = vf_load(nearest + x);
        vf all[7];
        for (int c = 0; c < 7; c++)
            if (c < channels || c > 3)
                all[c] = vf_load(sum[c] + x);
        for (int i = 0; i < count; i++) {
            const struct hf_hidden_tap *t = tap[i];
            const vf r = vf_load(t->in[5] + at + x), behind = vf_sub(r, from);
            if (!vm_any(vf_gt(behind, vf_set1(t->least))))
                continue;
            const vf a = vf_saturate(vf_mul(vf_sub(behind, vf_set1(t->from)), vf_set1(t->scale)));
            const vf full = vf_min(vf_mul(vf_set1(9), vf_load(t->in[4] + at + x)), vf_set1(1));
            const vf v = vf_mul(vf_mul(vf_mul(vf_set1(t->part), a), full), layers_hides(vf_sub(behind, vf_set1(1))));
            const vm some = vf_gt(v, vf_set1(HF_LAYERS_SOME));
            if (!vm_any(some))
                continue;
            const vf w = vf_keep(some, v);
            for (int c = 0; c < channels; c++)
                all[c] = vf_fma(w, vf_load(t->in[c] + at + x), all[c]);
            all[4] = vf_add(all[4], w);
            all[5] = vf_select(some, vf_fma(w, r, all[5]), all[5]);
            all[6] = vf_fma(w, vf_set1(t->whole), all[6]);
        }
        for (int c = 0; c < 7; c++)
            if (c < channels || c > 3)
                vf_store(sum[c] + x, all[c]);
    }
}

static void layers_taps_simd(const struct hf_hidden_tap *const *tap, int count, ptrdiff_t at, int channels,
                             const float *nearest, int n, float *const sum[7])
{
    HF_WITH_CHANNELS(channels, layers_taps_of(tap, count, at, CHANNELS, nearest, n, sum));
}

HF_INLINE vf layers_side_of(const struct hf_hidden_line *line, int side, int steps, const float *const in[6],
                            const int channels, int x, vf nearest, vf end[6])
{
    // Nothing lies behind an infinitely far surface.
    vf open = vf_keep(vf_lt(nearest, vf_set1(HUGE_VALF)), vf_set1(1)), whole = vf_zero();
    for (int i = 0; i < 6; i++)
        end[i] = vf_zero();
    for (int i = 0; i < steps; i++) {
        const ptrdiff_t at = line->side[side][i] + x;
        const vf r = vf_load(in[5] + at), behind = vf_sub(r, nearest);
        // Most steps meet nothing that lies far enough behind.
        if (!vm_any(vf_gt(behind, vf_set1(line->least[i]))))
            continue;
        const vf hides = layers_hides(vf_sub(behind, vf_set1(1))), off = vf_set1(1 - line->away[i]);
        const vf sees = vf_mul(hides, vf_saturate(vf_fma(behind, vf_set1(1.0f / 3), off)));
        const vf part = vf_mul(open, vf_mul(vf_saturate(vf_mul(vf_set1(9), vf_load(in[4] + at))), sees));
        open = vf_sub(open, part);
        whole = vf_add(whole, part);
        for (int c = 0; c < channels; c++)
            end[c] = vf_fma(part, vf_load(in[c] + at), end[c]);
        end[4] = vf_fma(part, r, end[4]);
        end[5] = vf_fma(part, vf_set1(line->away[i]), end[5]);
        if (!vm_any(vf_gt(open, vf_zero())))
            break;
    }
    return whole;
}

HF_INLINE void layers_between_of(const struct hf_hidden_line *line, int steps, const float *const in[6],
                                 const int channels, const float *nearest, int n, float *const sum[7])
{
    const vf one = vf_set1(1);
    for (int x = 0; x < n; x += VF_N) {
        const vf from = vf_load(nearest + x);
        vf end[2][6], whole[2], inverse[2], r[2], t[2];
        whole[0] = layers_side_of(line, 0, steps, in, channels, x, from, end[0]);
        if (!vm_any(vf_gt(whole[0], vf_zero())))
            continue;
        whole[1] = layers_side_of(line, 1, steps, in, channels, x, from, end[1]);
        for (int i = 0; i < 2; i++) {
            inverse[i] = vf_keep(vf_gt(whole[i], vf_zero()), vf_div(one, whole[i]));
            r[i] = vf_mul(end[i][4], inverse[i]);
            t[i] = vf_mul(end[i][5], inverse[i]);
        }
        const vf near = vf_min(t[0], t[1]), square = vf_mul(near, near), fourth = vf_mul(square, square);
        const vf behind = vf_sub(vf_mul(vf_add(r[0], r[1]), vf_set1(0.5f)), from);
        const vf unlike = vf_mul(vf_abs(vf_sub(r[0], r[1])), vf_set1(HF_LAYERS_UNLIKE));
        const vf alike = vf_saturate(vf_sub(vf_set1(2), vf_div(unlike, vf_max(behind, one))));
        const vf both = vf_mul(vf_mul(whole[0], whole[1]), alike);
        const vf v = vf_div(vf_mul(both, vf_set1(HF_LAYERS_BETWEEN)), vf_mul(fourth, fourth));
        const vm some = vf_gt(v, vf_set1(HF_LAYERS_SOME));
        if (!vm_any(some))
            continue;
        const vf w = vf_keep(some, v), share = vf_keep(some, vf_div(w, vf_add(t[0], t[1])));
        const vf g0 = vf_mul(vf_mul(share, t[1]), inverse[0]), g1 = vf_mul(vf_mul(share, t[0]), inverse[1]);
        for (int c = 0; c < channels; c++)
            vf_store(sum[c] + x, vf_fma(g1, end[1][c], vf_fma(g0, end[0][c], vf_load(sum[c] + x))));
        vf_store(sum[4] + x, vf_add(vf_load(sum[4] + x), w));
        vf_store(sum[5] + x, vf_fma(g1, end[1][4], vf_fma(g0, end[0][4], vf_load(sum[5] + x))));
        vf_store(sum[6] + x, vf_fma(vf_keep(some, both), vf_set1(HF_LAYERS_REACHED), vf_load(sum[6] + x)));
    }
}

static void layers_between_simd(const struct hf_hidden_line *line, int steps, const float *const in[6], int channels,
                                const float *nearest, int n, float *const sum[7])
{
    HF_WITH_CHANNELS(channels, layers_between_of(line, steps, in, CHANNELS, nearest, n, sum));
}

// hides_from() of hidden.c. Thin fronts are rare, and so are pixels whose samples have changed places, which have two.
HF_INLINE vf layers_hides_from(const float *const radius[4], const float *const weight[4], int row, int at)
{
    const vf one = vf_set1(1), thin = vf_set1(HF_LAYERS_THIN), own = vf_load(radius[row] + at);
    const vf weight_of[2] = {vf_load(weight[row] + at), vf_load(weight[2 + row] + at)};
    const vm two = vf_gt(weight_of[1], vf_zero());
    if (!vm_any(two))
        return own;
    const vf other = vf_select(two, vf_load(radius[2 + row] + at), own), front = vf_min(own, other);
    const vf some = vf_mul(vf_select(vf_lt(other, own), weight_of[1], weight_of[0]), thin);
    return vf_select(vm_and(two, vf_lt(some, one)), vf_fma(some, vf_sub(front, vf_max(own, other)), vf_max(own, other)),
                     front);
}

static void layers_nearest_simd(const float *const radius[4], const float *const weight[4], int n, float *out)
{
    for (int x = 0; x < n; x += VF_N) {
        vf least[2], even, odd;
        for (int i = 0; i < 2; i++)
            least[i] = vf_min(layers_hides_from(radius, weight, 0, 2 * x + i * VF_N),
                              layers_hides_from(radius, weight, 1, 2 * x + i * VF_N));
        vf_unzip(least[0], least[1], &even, &odd);
        vf_store(out + x, vf_min(even, odd));
    }
}

// How much of the pixels from `at` on lies before a radius: visible samples, and backs of mixed ones.
HF_INLINE vf layers_before(const float *const radius[4], const float *const weight[4], int row, int at, vf limit)
{
    const vf seen = vf_mul(vf_load(weight[row] + at), layers_hides(vf_sub(limit, vf_load(radius[row] + at))));
    const vf w = vf_load(weight[2 + row] + at);
    const vm some = vf_gt(w, vf_zero());
    if (!vm_any(some))
        return seen;
    const vf hides = layers_hides(vf_sub(limit, vf_keep(some, vf_load(radius[2 + row] + at))));
    return vf_add(seen, vf_keep(some, vf_mul(w, hides)));
}

static void layers_found_simd(const float *const sum[7], const float *const radius[4], const float *const weight[4],
                              int channels, int n, float *const out[6])
{
    for (int x = 0; x < n; x += VF_N) {
        const vf total = vf_load(sum[4] + x);
        const vm some = vf_gt(total, vf_zero());
        const vf inverse = vf_keep(some, vf_div(vf_set1(1), total));
        const vf r = vf_mul(vf_load(sum[5] + x), inverse), limit = vf_sub(r, vf_set1(1));
        vf before[2], first, second, even, odd;
        vf_zip(limit, limit, &first, &second);
        for (int i = 0; i < 2; i++) {
            const int at = 2 * x + i * VF_N;
            const vf l = i ? second : first;
            before[i] = vf_add(layers_before(radius, weight, 0, at, l), layers_before(radius, weight, 1, at, l));
        }
        vf_unzip(before[0], before[1], &even, &odd);
        const vf all = vf_mul(vf_add(even, odd), vf_set1(0.25f));
        vf_store(out[4] + x, vf_keep(some, vf_mul(all, vf_saturate(vf_load(sum[6] + x)))));
        vf_store(out[5] + x, r);
        for (int c = 0; c < channels; c++)
            vf_store(out[c] + x, vf_mul(vf_load(sum[c] + x), inverse));
    }
}

static void layers_spread_simd(const float *const in[6], const float *const radius[4], const float *const weight[4],
                               int row, int channels, int n, float *const out[6])
{
    for (int x = 0; x < n; x += VF_N) {
        const vf w = vf_load(in[4] + x), limit = vf_sub(vf_load(in[5] + x), vf_set1(1));
        vf before[2][2], far[2], weights[2], even, odd, parts[2];
        vf_zip(limit, limit, &far[0], &far[1]);
        vf_zip(w, w, &weights[0], &weights[1]);
        for (int i = 0; i < 4; i++) {
            const int at = 2 * x + (i & 1) * VF_N;
            before[i >> 1][i & 1] =
                vf_keep(vf_gt(weights[i & 1], vf_zero()), layers_before(radius, weight, i >> 1, at, far[i & 1]));
        }
        vf_unzip(vf_add(before[0][0], before[1][0]), vf_add(before[0][1], before[1][1]), &even, &odd);
        const vf sum = vf_add(even, odd);
        const vf part = vf_keep(vf_gt(sum, vf_zero()), vf_div(vf_mul(vf_set1(4), w), sum));
        const vf most = vf_min(part, vf_set1(1));
        vf_zip(most, most, &parts[0], &parts[1]);
        for (int i = 0; i < 2; i++)
            vf_store(out[4] + 2 * x + i * VF_N, vf_mul(parts[i], before[row][i]));
        for (int c = 0; c < 6; c++) {
            vf low, high;
            if (c == 4 || (c < 4 && c >= channels))
                continue;
            vf_zip(vf_load(in[c] + x), vf_load(in[c] + x), &low, &high);
            vf_store(out[c] + 2 * x, low);
            vf_store(out[c] + 2 * x + VF_N, high);
        }
    }
}

HF_INLINE vf layers_lonely(vf r, vf like, vf others, vf size)
{
    const vf one = vf_set1(1), sharp = vf_set1(HF_LAYERS_SHARP), all = vf_add(like, others);
    const vf part = vf_sub(vf_select(vf_gt(all, vf_zero()), vf_div(like, all), one), vf_set1(HF_LAYERS_ALONE));
    const vf around = vf_select(vf_gt(others, vf_zero()), vf_div(size, others), sharp);
    const vf alone = vf_sub(one, vf_saturate(vf_mul(part, vf_set1(HF_LAYERS_COMPANY))));
    return vf_mul(alone, vf_saturate(vf_sub(sharp, vf_min(vf_abs(r), around))));
}

HF_INLINE vf layers_roots_of(const float *const in[6], int x)
{
    return vf_add(vf_add(vf_abs(vf_load(in[0] + x)), vf_abs(vf_load(in[1] + x))), vf_abs(vf_load(in[2] + x)));
}

// Splits samples' weight in the mean around radius r: *of is the part that is as far as r; returns the rest. company
// adds up both parts, and the rest times the absolute radii. Most samples have no weight.
HF_INLINE vf layers_in_line(const float *weight, const float *radius, vf r, int i, vf *of, vf company[3])
{
    const vf w = vf_load(weight);
    const vm some = vf_gt(w, vf_zero());
    *of = vf_zero();
    if (!vm_any(some))
        return vf_zero();
    const vf far = vf_keep(some, vf_load(radius)), whole = vf_saturate(vf_mul(vf_set1(HF_LAYERS_WHOLE), w));
    const vf line = vf_keep(some, vf_mul(vf_set1(hf_layers_line(i)), whole));
    const vf alike = vf_fnma(vf_abs(vf_sub(far, r)), vf_set1(1.0f / HF_LAYERS_ALIKE), vf_set1(1));
    *of = vf_mul(line, vf_max(alike, vf_zero()));
    const vf rest = vf_sub(line, *of);
    company[0] = vf_add(company[0], *of);
    company[1] = vf_add(company[1], rest);
    company[2] = vf_fma(rest, vf_abs(far), company[2]);
    return rest;
}

// How close a sample's colour is to that of the middle one.
HF_INLINE vf layers_shade(const float *const in[6], const float *const middle[6], int x, vf apart)
{
    vf off = vf_abs(vf_sub(vf_load(in[0] + x), vf_load(middle[0] + x)));
    for (int c = 1; c < 3; c++)
        off = vf_add(off, vf_abs(vf_sub(vf_load(in[c] + x), vf_load(middle[c] + x))));
    const vf v = vf_fnma(off, apart, vf_set1(1)), least = vf_set1(HF_LAYERS_OTHER);
    return vf_select(vf_gt(v, least), v, least);
}

// second: the second of two directions, that is, along is not NULL. In the first no sample is alone.
HF_INLINE void layers_smooth_of(const float *const in[13][6], const float *const along[2], const int second,
                                const int channels, int n, float *const out[6])
{
    const vf zero = vf_zero();
    for (int x = 0; x < n; x += VF_N) {
        const vf r = vf_load(in[HF_LAYERS_SMOOTH][5] + x), weight = vf_load(in[HF_LAYERS_SMOOTH][4] + x);
        const vm there = vf_gt(weight, zero);
        if (!vm_any(there)) {
            for (int c = 0; c < 6; c++)
                if (c < channels || c >= 4)
                    vf_store(out[c] + x, zero);
            continue;
        }
        vf of[HF_LAYERS_TAPS], rest[HF_LAYERS_TAPS], colour[4], alone = zero, sum = zero, radius = zero;
        vf line[3] = {zero, zero, zero}, across[3] = {zero, zero, zero};
        for (int c = 0; c < channels; c++)
            colour[c] = zero;
        for (int i = 0; i < HF_LAYERS_TAPS; i++)
            rest[i] = layers_in_line(in[i][4] + x, in[i][5] + x, r, i, &of[i], line);
        if (second) {
            alone = layers_lonely(r, line[0], line[1], line[2]);
            if (vm_any(vf_gt(alone, zero))) {
                for (int i = 0; i < HF_LAYERS_TAPS; i++) {
                    const int at = x + i - HF_LAYERS_SMOOTH;
                    vf near;
                    layers_in_line(along[0] + at, along[1] + at, r, i, &near, across);
                }
                alone = vf_min(alone, layers_lonely(r, across[0], across[1], across[2]));
            }
        }
        const int lonely = second && vm_any(vf_gt(alone, zero));
        const vf middle = layers_roots_of(in[HF_LAYERS_SMOOTH], x), plain = vf_mul(middle, vf_set1(HF_LAYERS_GLARE));
        const vf apart = vf_div(vf_set1(HF_LAYERS_SHADES), vf_max(middle, vf_set1(HF_LAYERS_SOME)));
        for (int i = 0; i < HF_LAYERS_TAPS; i++) {
            // Most samples count nothing where no sample is alone.
            if (!lonely && !vm_any(vf_gt(of[i], zero)))
                continue;
            const vf shade = layers_shade(in[i], in[HF_LAYERS_SMOOTH], x, apart), near = vf_mul(of[i], shade);
            const vf all = lonely ? vf_fma(alone, vf_sub(rest[i], near), near) : near;
            const vm some = vf_gt(all, zero);
            if (!vm_any(some))
                continue;
            const vf g = vf_mul(all, layers_dimmed(layers_roots_of(in[i], x), plain));
            sum = vf_add(sum, g);
            radius = vf_fma(g, vf_keep(some, vf_load(in[i][5] + x)), radius);
            for (int c = 0; c < channels; c++)
                colour[c] = vf_fma(g, vf_keep(some, vf_load(in[i][c] + x)), colour[c]);
        }
        const vf inverse = vf_keep(vf_gt(sum, vf_set1(HF_LAYERS_SOME)), vf_div(vf_set1(1), sum));
        vf_store(out[4] + x, vf_keep(there, weight));
        vf_store(out[5] + x, vf_keep(there, vf_mul(radius, inverse)));
        for (int c = 0; c < channels; c++) {
            const vf v = vf_keep(there, vf_mul(colour[c], inverse));
            vf_store(out[c] + x, second ? vf_mul(v, vf_abs(v)) : v);
        }
    }
}

static void layers_smooth_simd(const float *const in[13][6], const float *const along[2], int channels, int n,
                               float *const out[6])
{
    if (along)
        HF_WITH_CHANNELS(channels, layers_smooth_of(in, along, 1, CHANNELS, n, out));
    else
        HF_WITH_CHANNELS(channels, layers_smooth_of(in, NULL, 0, CHANNELS, n, out));
}

// A mask of a vector's first n lanes.
HF_INLINE vm layers_first(int n)
{
    static const float lane[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    return vf_lt(vf_load(lane), vf_set1((float)n));
}

static void layers_extremes_simd(const float *radius, const float *weight, ptrdiff_t stride, int n, int rows,
                                 struct hf_layers_range *out)
{
    vf low = vf_set1(out->low), high = vf_set1(out->high);
    float lows[VF_N];
    for (int x = 0; x < n; x += VF_N) {
        const vm own = layers_first(n - x);
        for (int y = 0; y < rows; y++) {
            const ptrdiff_t at = y * stride + x;
            const vf r = vf_load(radius + at);
            const vm some = vm_and(own, vf_gt(weight ? vf_load(weight + at) : vf_set1(1), vf_zero()));
            low = vf_min(vf_select(some, r, low), low);
            high = vf_max(vf_select(some, r, high), high);
        }
    }
    vf_store(lows, low);
    for (int i = 0; i < VF_N; i++)
        out->low = lows[i] < out->low ? lows[i] : out->low;
    out->high = vf_most(high);
}

static int layers_inside_simd(const float *radius, const float *weight, ptrdiff_t stride, int n, int rows, float before,
                              float after)
{
    const vf from = vf_set1(before), to = vf_set1(after);
    for (int x = 0; x < n; x += VF_N) {
        const vm own = layers_first(n - x);
        for (int y = 0; y < rows; y++) {
            const vf r = vf_load(radius + y * stride + x), w = weight ? vf_load(weight + y * stride + x) : vf_set1(1);
            const vm inside = vm_and(vf_gt(r, from), vf_lt(r, to));
            if (vm_any(vm_and(own, vm_and(inside, vf_gt(w, vf_zero())))))
                return 1;
        }
    }
    return 0;
}
