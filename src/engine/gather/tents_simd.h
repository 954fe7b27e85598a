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

// 64 blocks of columns have 32 runs at most.
struct tents_runs {
    struct area_columns run[32];
    int count;
};

// The runs of n columns from x on that have these blocks. More columns than there are bits are one run.
static void tents_find(uint64_t blocks, int x, int n, struct tents_runs *runs)
{
    const int first = x >> 4, most = ((x + n - 1) >> 4) - first + 1, at = first & 63;
    runs->count = 0;
    if (most > 64) {
        runs->run[runs->count++] = (struct area_columns){0, n};
        return;
    }
    uint64_t left = (blocks >> at | blocks << (-at & 63)) & (~(uint64_t)0 >> (64 - most));
    while (left) {
        const struct hf_bit_run run = hf_next_bits(&left);
        runs->run[runs->count++] =
            (struct area_columns){hf_max(16 * (first + run.x0) - x, 0), hf_min(16 * (first + run.x1) - x, n)};
    }
}

// Between two runs there is a block at least, and all of it is 0: a run's last vector may reach into it.
HF_INLINE void tents(const float *const *p, const struct tents_runs *runs, const int step, float *out)
{
    _Static_assert(VF_N <= 16, "a vector is no wider than a block");
    for (int i = 0; i < runs->count; i++)
        for (int x = runs->run[i].x0; x < runs->run[i].x1; x += VF_N)
            vf_store(out + x, tent(p, x, step));
}

// These rows, in y and then in x. out may be the first row.
HF_INLINE void tents_of_rows(const float *const *rows, const struct tents_runs *in_y, const struct tents_runs *in_x,
                             const int step, float *out)
{
    const float *columns[HF_MAX_TENT];
    for (int i = 0; i < 2 * step - 1; i++)
        columns[i] = out + i;
    tents(rows, in_y, step, out);
    tents(columns, in_x, step, out);
}

// Row y of a job's planes convolved with the taps' tents: n columns, of which the rows that it reads hold these blocks.
static void area_tents_row(const struct convolve_job *j, const struct hf_taps *t, int y, int n, uint64_t blocks)
{
    const int half = t->step - 1, x = j->x0 - t->rx;
    struct tents_runs in_y, in_x;
    tents_find(blocks, x, n, &in_y);
    tents_find(blocks | blocks >> 1 | blocks << 63, x, n - 2 * half, &in_x);  // values come from the right
    for (int i = 0; i < j->planes; i++) {
        const float *from[HF_MAX_TENT];
        float *first = (float *)j->in[i] + (y - half) * j->in_stride[i] - t->rx;
        for (int k = 0; k <= 2 * half; k++)
            from[k] = first + k * j->in_stride[i];
        if (t->step == 2)
            tents_of_rows(from, &in_y, &in_x, 2, first);
        else
            tents_of_rows(from, &in_y, &in_x, 4, first);
    }
}

// A job's planes convolved in place, as far as taps around r reach. What holds nothing is 0, and stays so: tents reach half a tent up
// and down, and into the blocks beside, and the rows know afterwards what is in them. What belongs to a pixel comes to lie where
// the first of its tent's values was: half a tent to the left of and above its place.
static void area_tents(const struct hf_frame *f, const struct area_rows *rows, struct hf_rect r,
                       const struct hf_taps *t, struct convolve_job *j)
{
    const int half = t->step - 1;
    struct convolve_row *row = rows->level + (r.y0 - t->ry - rows->y0);
    uint64_t above[HF_MAX_STEP - 1];  // of the rows above the one at hand, as they were
    for (int i = 0; i < half; i++)
        above[i] = (row++)->filled;
    for (int y = half - t->ry; y < r.y1 - r.y0 + t->ry - half && !hf_stopped(f->s->stop); y++, row++) {
        uint64_t any = 0, own = row->filled;
        for (int i = 0; i < half; i++)
            any |= above[i] | row[i + 1].filled;
        any |= own;
        row->filled = any | any << 1 | any >> 63 | any >> 1 | any << 63;
        if (any) {
            if (rows->dirty)
                rows->dirty[r.y0 + y - half - rows->y0] = ~(uint32_t)0;
            area_tents_row(j, t, y, r.x1 - r.x0 + 2 * t->rx, any);
        }
        for (int i = 0; i + 1 < half; i++)
            above[i] = above[i + 1];
        above[half - 1] = own;
    }
    for (int i = 0; i < j->planes; i++)
        j->in[i] -= half * (j->in_stride[i] + 1);
}
