// SPDX-License-Identifier: BSD-3-Clause
// Planes of levels convolved with their taps' tents, on vectors.
#include "engine/gather/levels_planes_simd.h"

// Over the values at p[0] to p[2 step - 2] of columns x on. Sums and doubles alone, which are the same fused.
HF_INLINE vf tent(const float *const *p, int x, const int step)
{
    const vf middle = vf_load(p[step - 1] + x), beside = vf_add(vf_load(p[step - 2] + x), vf_load(p[step] + x));
    if (step == 2)
        return vf_add(beside, vf_add(middle, middle));
    const vf second = vf_add(vf_load(p[step - 3] + x), vf_load(p[step + 1] + x));
    const vf third = vf_add(vf_load(p[step - 4] + x), vf_load(p[step + 2] + x));
    const vf inner = vf_add(vf_add(second, beside), vf_add(middle, middle));
    return vf_add(vf_add(third, beside), vf_add(inner, inner));
}

HF_INLINE void tents(const float *const *p, int n, const int step, float *out)
{
    for (int x = 0; x < n; x += VF_N)
        vf_store(out + x, tent(p, x, step));
}

// n columns of these rows, in y and then in x. out may be the first row.
HF_INLINE void tents_of_rows(const float *const *rows, int n, const int step, float *out)
{
    const float *columns[HF_MAX_TENT];
    for (int i = 0; i < 2 * step - 1; i++)
        columns[i] = out + i;
    tents(rows, n, step, out);
    tents(columns, n - 2 * (step - 1), step, out);
}

// Which blocks of a level's rows will hold something when its planes have been convolved: tents reach half a tent up and down, and
// into the blocks beside.
static void area_tents_filled(const struct area_rows *rows, struct hf_rect r, const struct hf_taps *t)
{
    const int half = t->step - 1;
    struct convolve_row *row = rows->level + (r.y0 - t->ry - rows->y0);
    uint64_t above[HF_MAX_STEP - 1];  // of the rows above the one at hand, as they were
    for (int i = 0; i < half; i++)
        above[i] = (row++)->filled;
    for (int y = r.y0 - t->ry + half; y < r.y1 + t->ry - half; y++, row++) {
        uint64_t any = 0, own = row->filled;
        for (int i = 0; i < half; i++)
            any |= above[i] | row[i + 1].filled;
        any |= own;
        row->filled = any | any << 1 | any >> 63 | any >> 1 | any << 63;
        for (int i = 0; i + 1 < half; i++)
            above[i] = above[i + 1];
        above[half - 1] = own;
    }
}

// A level's plane convolved in place, as far as taps around r reach; the rows know already what will be in them, and what holds
// nothing is 0. What belongs to a pixel comes to lie where the first of its tent's values was: half a tent to the left of and above
// its place.
static void area_tents(const struct hf_frame *f, const struct area_rows *rows, struct hf_rect r,
                       const struct hf_taps *t, const struct hf_buf *plane, int c)
{
    const int half = t->step - 1, n = r.x1 - r.x0 + 2 * t->rx;
    for (int y = r.y0 - t->ry + half; y < r.y1 + t->ry - half && !hf_stopped(f->s->stop); y++) {
        if (!rows->level[y - rows->y0].filled)
            continue;
        const float *from[HF_MAX_TENT];
        float *first = hf_at(plane, c, r.x0 - t->rx, y - half);
        for (int i = 0; i <= 2 * half; i++)
            from[i] = first + i * plane->stride;
        if (t->step == 2)
            tents_of_rows(from, n, 2, first);
        else
            tents_of_rows(from, n, 4, first);
    }
}
