// SPDX-License-Identifier: BSD-3-Clause
// Scatter: slices on vectors. Nothing is fused: this engine has the same bits everywhere.
#include "pixel/coc_vf.h"
#include "engine/scatter/kernels.h"
#include "engine/scatter/walk.h"
#include "simd/simd.h"

// How far r has gone from edge[0] to edge[1], 0 to 1.
HF_INLINE vf slice_past(const float edge[2], vf r)
{
    return vf_saturate(vf_div(vf_sub(r, vf_set1(edge[0])), vf_set1(edge[1] - edge[0])));
}

static void slice_row_simd(const struct hf_scatter_slice *s, float sign, const float *radius, int channels, int n,
                           float *const row[4])
{
    const int whole = s->whole ? 0 : n / VF_N * VF_N;
    for (int x = 0; x < whole; x += VF_N) {
        const vf r = vf_mul(vf_set1(sign), vf_load(radius + x));
        const vf part = vf_mul(slice_past(s->begin, r), vf_sub(vf_set1(1), slice_past(s->end, r)));
        for (int c = 0; c < 4; c++)
            if (c == 3 || c < channels)
                vf_store(row[c] + x, vf_mul(vf_load(row[c] + x), part));
    }
    float *const rest[4] = {row[0] + whole, row[1] + whole, row[2] + whole, row[3] + whole};
    hf_slice_row_c(s, sign, radius + whole, channels, n - whole, rest);
}

// The part of pixels of that radius which sprites can cover.
HF_INLINE vf slice_room(const struct hf_scatter *t, vf radius)
{
    const vf own = vf_saturate(vf_mul(vf_sub(vf_set1(t->fade), vf_abs(radius)), vf_set1(t->fade_slope)));
    return vf_sub(vf_set1(1), own);
}

// Most of a slice is 0 in most cells, and is skipped.
static void slice_behind_simd(const struct hf_scatter *t, const float *const at[3], float *const slice[4], int n,
                              float *const to[4])
{
    // What lies past the row belongs to another cell.
    const int whole = n / VF_N * VF_N;
    for (int x = 0; x < whole; x += VF_N) {
        const vf own = vf_load(slice[3] + x);
        const vm some = vf_gt(own, vf_zero());
        if (!vm_any(some))
            continue;
        vf room = slice_room(t, vf_load(at[0] + x));
        if (at[1]) {
            const vf share = vf_load(at[1] + x), back = slice_room(t, vf_load(at[2] + x));
            room = vf_select(vf_gt(share, vf_zero()), vf_add(room, vf_mul(share, vf_sub(back, room))), room);
        }
        const vf left = vf_max(vf_sub(room, vf_load(to[3] + x)), vf_zero());
        const vf part = vf_select(vf_lt(left, own), vf_div(left, own), vf_set1(1));
        for (int c = 0; c < 4; c++)
            if (to[c]) {
                const vf v = vf_load(to[c] + x);
                vf_store(to[c] + x, vf_select(some, vf_add(v, vf_mul(vf_load(slice[c] + x), part)), v));
            }
    }
    const float *const rest[3] = {at[0] + whole, at[1] ? at[1] + whole : NULL, at[2] ? at[2] + whole : NULL};
    float *of[4], *out[4];
    for (int c = 0; c < 4; c++) {
        of[c] = to[c] ? slice[c] + whole : NULL;
        out[c] = to[c] ? to[c] + whole : NULL;
    }
    hf_slice_behind_c(t, rest, of, n - whole, out);
}
