// SPDX-License-Identifier: BSD-3-Clause
// The hexagon engine on vectors: the sum along a line, for a block of pixels.
//
// A line's taps are the same for all pixels, so each is a load at a fixed offset, and most loads are not aligned. A
// line that is not steep meets a column of pixels in two taps. So as many rows are computed together as there are
// registers for their sums, and a sample is loaded once for all rows that meet it (hf_hexagon_step).
//
// The remaining cost of a tap is to find how much of a sample counts. So the range of radii around each block of pixels
// is found first. Taps that no sample reaches are skipped, and taps that all samples reach are plain products: four
// operations instead of ten. Skipped taps would add nothing, and full ones have the same weight either way. Each
// pixel's sums keep their order, so no bit depends on where a block lies.
#ifndef HF_HEXAGON_LINE_SIMD_H
#define HF_HEXAGON_LINE_SIMD_H

#include "engine/hexagon/kernels.h"
#include "pixel/coc_vf.h"

#if defined __aarch64__
enum { HEX_REGISTERS = 32 };
#else
enum { HEX_REGISTERS = VF_N == 16 ? 32 : 16 };
#endif

// Rows computed together, and a block's size.
enum { HEX_ROWS = HEX_REGISTERS == 32 ? 4 : 2, HEX_WIDTH = 128, HEX_HEIGHT = 16 };

struct hex_range {
    float least, most;
};

// The least and largest radius in a block and wherever a line reaches from it. Where samples without a radius hold 0,
// the least radius above 0. Lanes past the block's end may hold anything: that widens the range, and NaN is ignored.
HF_INLINE struct hex_range hex_range(const struct hf_hexagon_field *in, const struct hf_hexagon_line *l,
                                     struct hf_rect b)
{
    vf least = vf_set1(FLT_MAX), most = vf_set1(-FLT_MAX);
    const vf sign = vf_set1(in->sign);
    for (int y = b.y0 + l->y0; y < b.y1 + l->y1; y++)
        for (int x = b.x0 + l->x0; x < b.x1 + l->x1; x += VF_N) {
            const vf q = vf_mul(sign, vf_load(hf_at(in->radius, in->q, x, y)));
            const vf lower = vf_min(q, least);
            least = in->alone ? vf_select(vf_gt(q, vf_zero()), lower, least) : lower;
            most = vf_max(q, most);
        }
    float lanes[2][VF_N];
    vf_store(lanes[0], least);
    vf_store(lanes[1], most);
    struct hex_range r = {lanes[0][0], lanes[1][0]};
    for (int i = 1; i < VF_N; i++) {
        r.least = lanes[0][i] < r.least ? lanes[0][i] : r.least;
        r.most = lanes[1][i] > r.most ? lanes[1][i] : r.most;
    }
    return r;
}

// The least radius above 0 of a block's own pixels.
HF_INLINE float hex_least_far(const struct hf_hexagon_field *in, struct hf_rect b)
{
    vf least = vf_set1(FLT_MAX);
    for (int y = b.y0; y < b.y1; y++)
        for (int x = b.x0; x < b.x1; x += VF_N) {
            const vf q = vf_load(hf_at(in->radius, in->q, x, y));
            least = vf_select(vf_gt(q, vf_zero()), vf_min(q, least), least);
        }
    float lane[VF_N], r = FLT_MAX;
    vf_store(lane, least);
    for (int i = 0; i < VF_N; i++)
        r = lane[i] < r ? lane[i] : r;
    return r;
}

// The steps of a line that some sample in a block reaches. Those before `full` are reached by all samples in full.
struct hex_run {
    const struct hf_hexagon_step *step, *full, *end;
};

// Whether a sample of this radius reaches all taps of a step in full.
HF_INLINE int hex_is_full(const struct hf_hexagon_step *p, float least)
{
    for (int i = 0; i < HEX_ROWS; i++)
        if ((p->rows >> i & 1) && !(least - p->c[i] >= p->b[i]))
            return 0;
    return 1;
}

HF_INLINE struct hex_run hex_run(const struct hf_hexagon_line *l, const int rows, struct hex_range r)
{
    const struct hf_hexagon_steps *s = rows == 1 ? &l->one : rows == 2 ? &l->two : &l->four;
    struct hex_run run = {s->step, s->step, s->step + s->count};
    while (run.end > run.step && !(r.most > run.end[-1].least))
        run.end--;
    while (run.full < run.end && hex_is_full(run.full, r.least))
        run.full++;
    return run;
}

struct hex_sums {
    vf colour[4], a, w;
};

struct hex_limit {
    vf limit, slope;  // the slope is negative
};

// As count_of() of blur.c: how much samples of radii q count at a tap.
HF_INLINE vf hex_count(vf q, float c, float b, float part, const struct hex_limit *limit)
{
    vf w = vf_sub(q, vf_set1(c));
    if (limit)
        w = vf_min(w, vf_mul(vf_set1(b), vf_fma(limit->slope, q, limit->limit)));
    return vf_mul(vf_max(vf_min(w, vf_set1(b)), vf_zero()), vf_set1(part));
}

// The body of hex_line() for one kind of line. The sums are its own until the end, so they stay in registers.
HF_INLINE void hex_line_of(const struct hf_hexagon_field *in, const struct hex_run *run, const int channels,
                           const int first, const int rows, int x, int y, const struct hex_limit *limit,
                           struct hex_sums to[HEX_ROWS])
{
    struct hex_sums s[HEX_ROWS];
    const ptrdiff_t stride = in->colour->stride, weight_stride = in->weight->stride;
    const float *colour[4], *a = hf_at(in->weight, in->a, x, y), *radius = hf_at(in->radius, in->q, x, y);
    const float *mean = first ? hf_at(in->weight, in->mean, x, y) : NULL;
    for (int c = 0; c < channels; c++)
        colour[c] = hf_at(in->colour, c, x, y);
    HF_UNROLL(4)
    for (int i = 0; i < rows; i++) {
        for (int c = 0; c < channels; c++)
            s[i].colour[c] = vf_zero();
        s[i].a = vf_zero();
        s[i].w = vf_zero();
    }
    const struct hf_hexagon_step *p = run->step;
    for (; p < run->full && !limit; p++) {
        const ptrdiff_t at = p->dy * stride + p->dx, weight_at = p->dy * weight_stride + p->dx;
        vf v[4], over = vf_zero();
        for (int c = 0; c < channels; c++)
            v[c] = vf_once(vf_load(colour[c] + at));
        const vf weight = vf_once(vf_load(a + weight_at));
        if (first)
            over = vf_once(vf_load(mean + weight_at));
        HF_UNROLL(4)
        for (int i = 0; i < rows; i++)
            if (p->rows >> i & 1) {
                const vf b = vf_set1(p->whole[i]);
                for (int c = 0; c < channels; c++)
                    s[i].colour[c] = vf_fma(b, v[c], s[i].colour[c]);
                s[i].a = vf_fma(b, weight, s[i].a);
                if (first)
                    s[i].w = vf_fma(b, over, s[i].w);
            }
    }
    const vf sign = vf_set1(in->sign);
    for (; p < run->end; p++) {
        const ptrdiff_t at = p->dy * stride + p->dx, weight_at = p->dy * weight_stride + p->dx;
        vf v[4], over = vf_zero();
        const vf q = vf_once(vf_mul(sign, vf_load(radius + weight_at)));
        if (!vm_any(vf_gt(q, vf_set1(p->least))))
            continue;
        for (int c = 0; c < channels; c++)
            v[c] = vf_once(vf_load(colour[c] + at));
        const vf weight = vf_once(vf_load(a + weight_at));
        if (first)
            over = vf_once(vf_load(mean + weight_at));
        HF_UNROLL(4)
        for (int i = 0; i < rows; i++)
            if (p->rows >> i & 1) {
                const vf w = hex_count(q, p->c[i], p->b[i], p->part[i], limit ? &limit[i] : NULL);
                for (int c = 0; c < channels; c++)
                    s[i].colour[c] = vf_fma(w, v[c], s[i].colour[c]);
                s[i].a = vf_fma(w, weight, s[i].a);
                if (first)
                    s[i].w = vf_fma(w, over, s[i].w);
            }
    }
    HF_UNROLL(4)
    for (int i = 0; i < rows; i++)
        to[i] = s[i];
}

// With 32 registers each kind of line is a function of its own, with and without limits. Among the loops over blocks the compiler
// kept half of the sums on the stack: 4 % of the time. With 16, calls cost 2 % and gain nothing.
#define HEX_LINES(name, channels, first, rows)                                                                         \
    static __attribute__((noinline, unused)) void name(const struct hf_hexagon_field *in, const struct hex_run *run,   \
                                                       int x, int y, const struct hex_limit *limit,                    \
                                                       struct hex_sums s[HEX_ROWS])                                    \
    {                                                                                                                  \
        (void)limit;                                                                                                   \
        hex_line_of(in, run, channels, first, rows, x, y, NULL, s);                                                    \
    }                                                                                                                  \
    static __attribute__((noinline, unused)) void name##_limited(                                                      \
        const struct hf_hexagon_field *in, const struct hex_run *run, int x, int y, const struct hex_limit *limit,     \
        struct hex_sums s[HEX_ROWS])                                                                                   \
    {                                                                                                                  \
        hex_line_of(in, run, channels, first, rows, x, y, limit, s);                                                   \
    }
HEX_LINES(hex_line_3, 3, 0, HEX_ROWS)
HEX_LINES(hex_line_3_one, 3, 0, 1)
HEX_LINES(hex_line_3_first, 3, 1, HEX_ROWS)
HEX_LINES(hex_line_3_first_one, 3, 1, 1)
HEX_LINES(hex_line_4, 4, 0, HEX_ROWS)
HEX_LINES(hex_line_4_one, 4, 0, 1)
HEX_LINES(hex_line_4_first, 4, 1, HEX_ROWS)
HEX_LINES(hex_line_4_first_one, 4, 1, 1)
#undef HEX_LINES

typedef void hex_line_function(const struct hf_hexagon_field *in, const struct hex_run *run, int x, int y,
                               const struct hex_limit *limit, struct hex_sums s[HEX_ROWS]);

// Sum along a line for a vector of pixels from (x, y) in each of some rows. first: pass 1, so radii are summed. limit
// NULL: no limit.
HF_INLINE void hex_line(const struct hf_hexagon_field *in, const struct hex_run *run, const int channels,
                        const int first, const int rows, int x, int y, const struct hex_limit *limit,
                        struct hex_sums s[HEX_ROWS])
{
    static hex_line_function *const kinds[2][2][2][2] = {
#define KINDS(name) {name, name##_limited}
        {{KINDS(hex_line_3), KINDS(hex_line_3_one)}, {KINDS(hex_line_3_first), KINDS(hex_line_3_first_one)}},
        {{KINDS(hex_line_4), KINDS(hex_line_4_one)}, {KINDS(hex_line_4_first), KINDS(hex_line_4_first_one)}},
#undef KINDS
    };
    if (HEX_REGISTERS == 32)
        kinds[channels == 4][first][rows == 1][limit != NULL](in, run, x, y, limit, s);
    else
        hex_line_of(in, run, channels, first, rows, x, y, limit, s);
}

// Walk a block in groups of rows. Where rows are left over, the last group overlaps the one before. In a row, the
// second vector overlaps the first; from there on vectors are aligned.
#define HEX_EACH(b, rows, x, y)                                                                                        \
    for (int y = (b).y0; y < (b).y1; y = y + rows < (b).y1 ? hf_min(y + rows, (b).y1 - rows) : (b).y1)                 \
        for (int x = (b).x0; x < (b).x1; x = (x + VF_N) & ~(VF_N - 1))

// Prefetch the samples under a vector that the block below will be the first to read. They lie too far apart for the
// hardware's prefetchers.
HF_INLINE void hex_fetch(const struct hf_hexagon_field *in, const int channels, const int rows, int x, int y)
{
    for (int i = 0; i < rows; i++) {
        for (int c = 0; c < channels; c++)
            __builtin_prefetch(hf_at(in->colour, c, x, y + i), 0, 2);
        __builtin_prefetch(hf_at(in->weight, in->a, x, y + i), 0, 2);
        __builtin_prefetch(hf_at(in->weight, in->mean, x, y + i), 0, 2);
        __builtin_prefetch(hf_at(in->radius, in->q, x, y + i), 0, 2);
    }
}

#endif
