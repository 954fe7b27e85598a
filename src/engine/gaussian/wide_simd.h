// SPDX-License-Identifier: BSD-3-Clause
// Boxes of any size on vectors of doubles, one column per lane. Nothing is fused, and the order of operations is that
// of the C.
#include "engine/gaussian/kernels.h"
#include "simd/simd.h"

HF_INLINE void wide_suffixes(const float *in, int n, int width, double *suffix)
{
    vd sum = vd_set1(0);
    for (int i = n - 1, left = (n - 1) % width; i >= 0; i--, left = left ? left - 1 : width - 1) {
        const vd v = vd_load(in + (ptrdiff_t)i * HF_WIDE_LANES);
        sum = i == n - 1 || left == width - 1 ? v : vd_add(v, sum);
        vd_keep_sum(suffix + (ptrdiff_t)i * VD_N, sum);
    }
}

static void wide_box_simd(const float *in, float *out, int n, const struct hf_wide *w, double *suffix)
{
    const int l = w->l, width = 2 * l + 1;
    const vd first = vd_load(in), last = vd_load(in + (ptrdiff_t)(n - 1) * HF_WIDE_LANES);
    const vd alpha = vd_set1(w->alpha), scale = vd_set1(w->scale);
    wide_suffixes(in, n, width, suffix);
    vd prefix = vd_set1(0);
    int end = -1, place = -1;  // the last sample in prefix, and its position in its block
    int block = 0;             // start of the first block that begins inside the window
    for (int i = 0; i < n; i++) {
        const int a = i - l, b = hf_min(i + l, n - 1);
        if (a > block)
            block += width;
        for (; end < b; end++) {
            const vd v = vd_load(in + (ptrdiff_t)(end + 1) * HF_WIDE_LANES);
            place = place + 1 == width ? 0 : place + 1;
            prefix = place == 0 ? v : vd_add(prefix, v);
        }
        vd sum = prefix;
        if (a > 0) {
            sum = vd_sum(suffix + (ptrdiff_t)a * VD_N);
            if (block != a && block <= b)
                sum = vd_add(sum, prefix);
        }
        if (a < 0)
            sum = vd_add(vd_mul(vd_set1(-a), first), sum);
        if (i + l >= n)
            sum = vd_add(sum, vd_mul(vd_set1(i + l - n + 1), last));
        const vd before = vd_load(in + (ptrdiff_t)hf_max(a - 1, 0) * HF_WIDE_LANES);
        const vd after = vd_load(in + (ptrdiff_t)hf_min(i + l + 1, n - 1) * HF_WIDE_LANES);
        const vd ends = vd_mul(alpha, vd_add(before, after));
        vd_store(out + (ptrdiff_t)i * HF_WIDE_LANES, vd_mul(vd_add(sum, ends), scale));
    }
}

static void wide_block_simd(float *block, int n, const struct hf_wide *w, float *work)
{
    float *other = work + HF_WIDE_LANES * (size_t)n;
    for (int x = 0; x < HF_WIDE_LANES; x += VD_N)
        for (int i = 0; i < HF_WIDE_BOXES; i++)
            wide_box_simd((i % 2 ? other : block) + x, (i % 2 ? block : other) + x, n, w, (double *)(void *)work);
}
