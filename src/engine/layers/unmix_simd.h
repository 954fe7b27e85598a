// SPDX-License-Identifier: BSD-3-Clause
// Un-mixing on vectors, with operations in the order of unmix.c.
#include "engine/layers/dimmed_vf.h"
#include "engine/layers/unmix.h"
#include "simd/simd.h"

// Half a vector of pixels from each of two places in a row. Mixed pixels stand in narrow lines, two or three abreast, so most
// lanes of a whole vector would be computed in vain.
struct layers_two {
    int a, b;
};

HF_INLINE vf layers_load_two(const float *row, struct layers_two x)
{
    return vf_load_halves(row + x.a, row + x.b);
}

// As many pixels farther on.
HF_INLINE struct layers_two layers_beside(struct layers_two x, int i)
{
    return (struct layers_two){x.a + i, x.b + i};
}

HF_INLINE void layers_store_two(float *row, struct layers_two x, vf v)
{
    vf_store_halves(row + x.a, row + x.b, v);
}

HF_INLINE void layers_keep(const struct hf_unmix_row *u, int x, const int channels)
{
    for (int c = 0; c < channels; c++)
        vf_store(u->seen[c] + x, vf_load(u->colour[3][c] + x));
    layers_leave(u->seen[4] + x, vf_set1(1));
    layers_leave(u->mixed[4] + x, vf_zero());
    vf_store(u->seen[5] + x, vf_load(u->radius[3] + x));
}

// How much of a radius belongs to the front, 0 to 1.
HF_INLINE vf layers_front(vf middle, vf slope, vf r)
{
    const vf s = vf_fma(vf_sub(middle, r), slope, vf_set1(0.5f));
    return vf_saturate(s);
}

// An eighth of a colour's brightness, which is finite even for the largest samples.
HF_INLINE vf layers_eighth_light(vf red, vf green, vf blue)
{
    return vf_mul(vf_add(vf_add(vf_abs(red), vf_abs(green)), vf_abs(blue)), vf_set1(0.125f));
}

HF_INLINE vf layers_light_of(const struct hf_unmix_row *u, int y, int x)
{
    return layers_eighth_light(vf_load(u->colour[y][0] + x), vf_load(u->colour[y][1] + x),
                               vf_load(u->colour[y][2] + x));
}

// See to it that light and squares are there in the rows around a vector, and beside it.
HF_INLINE void layers_prepare(const struct hf_unmix_row *u, int x, const int channels)
{
    for (int y = 0; y < 7; y++)
        for (int i = -1; i < 2; i++) {
            const int at = x + i * VF_N;
            uint8_t *done = &u->done[y][1 + x / VF_N + i];
            if (*done)
                continue;
            vf square = vf_zero();
            for (int c = 0; c < channels; c++) {
                const vf v = vf_load(u->colour[y][c] + at);
                square = vf_fma(v, v, square);
            }
            vf_store(u->light[y] + at, layers_light_of(u, y, at));
            vf_store(u->square[y] + at, square);
            *done = 1;
        }
}

// Turn the sums of a side into its mean. Returns the variance of its colours.
HF_INLINE vf layers_finish(const int channels, vf counted, vf squares, vf *mean)
{
    const vm some = vf_gt(counted, vf_zero());
    vf square = vf_zero();
    for (int c = 0; c < 5; c++)
        mean[c] = vf_keep(some, vf_div(mean[c], counted));
    for (int c = 0; c < channels; c++)
        square = vf_fma(mean[c], mean[c], square);
    const vf spread = vf_sub(vf_keep(some, vf_div(squares, counted)), square);
    return vf_keep(vf_gt(spread, vf_zero()), spread);
}

// farthest() of unmix.c for all lanes at once: the five rows of five are gone over twice, first for the largest
// distance. lacks: lanes that want a mean. front: those that want the front's. Most of the pixels around are on the other side in
// all these lanes; they are passed over.
static __attribute__((noinline)) void layers_farthest(const struct hf_unmix_row *u, struct layers_two x,
                                                      const int channels, vm lacks, vm front, const vf other[4],
                                                      vf colour[5])
{
    const vf middle = layers_load_two(u->middle, x), slope = layers_load_two(u->slope, x), one = vf_set1(1);
    const vf plain = vf_mul(layers_load_two(u->light[3], x), vf_set1(HF_UNMIX_PLAIN));
    vf share[25], distance[25], most = vf_zero(), sum = vf_zero();
    int place[25], count = 0;
    for (int k = 0; k < 25; k++) {
        const int y = 1 + k / 5;
        const struct layers_two at = layers_beside(x, k % 5 - 2);
        const vf s = vf_add(vf_mul(vf_sub(middle, layers_load_two(u->radius[y], at)), slope), vf_set1(0.5f));
        const vf of_front = vf_saturate(s);
        vf d = vf_zero(), of = vf_keep(lacks, vf_select(front, of_front, vf_sub(one, of_front)));
        if (!vm_any(vf_gt(of, vf_zero())))
            continue;
        const vf counts = layers_dimmed(layers_load_two(u->light[y], at), plain);
        of = vf_select(front, vf_mul(of, counts), of);
        for (int c = 0; c < channels; c++) {
            const vf apart = vf_abs(vf_sub(layers_load_two(u->colour[y][c], at), other[c]));
            d = vf_add(d, vf_mul(apart, vf_set1(0.125f)));
        }
        share[count] = of;
        distance[count] = vf_mul(of, d);
        most = vf_max(distance[count], most);
        place[count++] = k;
    }
    for (int c = 0; c < 5; c++)
        colour[c] = vf_zero();
    for (int i = 0; i < count; i++) {
        const int y = 1 + place[i] / 5;
        const struct layers_two at = layers_beside(x, place[i] % 5 - 2);
        const vf far = vf_select(vf_gt(most, vf_zero()), vf_div(distance[i], most), one), square = vf_mul(far, far);
        const vf fourth = vf_mul(square, square);
        const vf w = vf_mul(vf_mul(share[i], vf_mul(fourth, fourth)), vf_set1(0.03125f));
        sum = vf_add(sum, w);
        colour[4] = vf_add(colour[4], vf_mul(w, layers_load_two(u->radius[y], at)));
        for (int c = 0; c < channels; c++)
            colour[c] = vf_add(colour[c], vf_mul(w, layers_load_two(u->colour[y][c], at)));
    }
    for (int c = 0; c < 5; c++)
        colour[c] = vf_keep(vf_gt(sum, vf_zero()), vf_div(colour[c], sum));
}

// hf_unmix_complete for all lanes at once. lacks: lanes where a side has less weight than `little`.
HF_INLINE void layers_complete(const struct hf_unmix_row *u, struct layers_two x, const int channels, vm lacks,
                               const vf weight[2], vf little, vf mean[2][5], vf spread[2])
{
    const vm front = vf_lt(weight[0], weight[1]);
    const vf known = vf_div(vf_select(front, weight[0], weight[1]), little);
    const vm of[2] = {vm_and(lacks, front), vm_and(lacks, vm_not(front))};
    vf other[4], colour[5];
    for (int c = 0; c < channels; c++)
        other[c] = vf_select(front, mean[1][c], mean[0][c]);
    layers_farthest(u, x, channels, lacks, front, other, colour);
    const vf doubt = vf_mul(vf_sub(vf_set1(1), known), vf_set1(HF_UNMIX_DOUBT));
    for (int i = 0; i < 2; i++) {
        vf apart = vf_zero();
        for (int c = 0; c < 5; c++) {
            if (c < channels || c == 4) {
                const vf d = vf_sub(mean[i][c], colour[c]), part = vf_add(colour[c], vf_mul(known, d));
                mean[i][c] = vf_select(of[i], vf_select(vf_gt(known, vf_zero()), part, colour[c]), mean[i][c]);
                if (c < channels)
                    apart = vf_add(apart, vf_mul(d, d));
            }
        }
        spread[i] = vf_select(of[i], vf_mul(known, vf_add(spread[i], vf_mul(doubt, apart))), spread[i]);
    }
}

// Means and variances of the two sides. mixed: what a mixed pixel counts where a sure one counts 1.
HF_INLINE void layers_sides(const struct hf_unmix_row *u, struct layers_two x, const int channels, vf mixed,
                            vf weight[2], vf mean[2][5], vf spread[2])
{
    const vf middle = layers_load_two(u->middle, x), slope = layers_load_two(u->slope, x);
    const vf plain = vf_mul(layers_load_two(u->light[3], x), vf_set1(HF_UNMIX_PLAIN));
    vf counted[2] = {vf_zero(), vf_zero()};
    for (int i = 0; i < 2; i++) {
        weight[i] = spread[i] = vf_zero();
        for (int c = 0; c < 5; c++)
            mean[i][c] = vf_zero();
    }
    for (int y = 0; y < 7; y++)
        for (int i = 0; i < 7; i++) {
            const struct layers_two at = layers_beside(x, i - 3);
            if (y == 3 && i == 3)
                continue;
            const vf sure = layers_load_two(u->sure[y], at);
            const vf w = vf_mul(vf_fma(sure, sure, mixed), vf_set1(hf_unmix_weights[y][i]));
            const vf r = layers_load_two(u->radius[y], at), f = vf_mul(w, layers_front(middle, slope, r)),
                     b = vf_sub(w, f);
            weight[0] = vf_add(weight[0], f);
            weight[1] = vf_add(weight[1], b);
            const vf counts = layers_dimmed(layers_load_two(u->light[y], at), plain);
            const vf front = vf_mul(f, counts), back = vf_mul(b, counts);
            counted[0] = vf_add(counted[0], front);
            counted[1] = vf_add(counted[1], back);
            const vf square = layers_load_two(u->square[y], at);
            for (int c = 0; c < channels; c++) {
                const vf v = layers_load_two(u->colour[y][c], at);
                mean[0][c] = vf_fma(front, v, mean[0][c]);
                mean[1][c] = vf_fma(back, v, mean[1][c]);
            }
            spread[0] = vf_fma(front, square, spread[0]);
            spread[1] = vf_fma(back, square, spread[1]);
            mean[0][4] = vf_fma(front, r, mean[0][4]);
            mean[1][4] = vf_fma(back, r, mean[1][4]);
        }
    for (int i = 0; i < 2; i++)
        spread[i] = layers_finish(channels, counted[i], spread[i], mean[i]);
}

// Out of line: most rows have no thicket.
static __attribute__((noinline)) void layers_sides_in_thicket(const struct hf_unmix_row *u, struct layers_two x,
                                                              const int channels, vf thick, vf weight[2], vf mean[2][5],
                                                              vf spread[2])
{
    layers_sides(u, x, channels, vf_mul(thick, vf_set1(HF_UNMIX_UNSURE)), weight, mean, spread);
}

// The channels of pixel `at` of row y, and its radius behind them.
HF_INLINE vf layers_value(const struct hf_unmix_row *u, int y, struct layers_two at, int c)
{
    return layers_load_two(c < 4 ? u->colour[y][c] : u->radius[y], at);
}

// lamp_in_thicket() of unmix.c for all lanes at once.
static __attribute__((noinline)) void layers_lamp_in_thicket(const struct hf_unmix_row *u, struct layers_two x,
                                                             const int channels, vf thick, vf mean[2][5], vf spread[2])
{
    const vf middle = layers_load_two(u->middle, x), slope = layers_load_two(u->slope, x), zero = vf_zero(),
             one = vf_set1(1);
    const vf own = layers_load_two(u->light[3], x), plain = vf_mul(own, vf_set1(HF_UNMIX_DARK));
    vf most = zero, least = own, dark[2] = {zero, zero}, light[2] = {zero, zero}, bright[2] = {zero, zero};
    vf lamp[2][5];
    for (int i = 0; i < 49; i++) {
        const vf v = layers_load_two(u->light[i / 7], layers_beside(x, i % 7 - 3));
        most = vf_max(v, most);
        least = vf_min(v, least);
    }
    const vm wanted = vm_and(vf_gt(thick, zero), vf_gt(own, vf_mul(least, vf_set1(HF_UNMIX_TIMES))));
    if (!vm_any(wanted))
        return;
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < 5; c++)
            lamp[side][c] = zero;
    for (int i = 0; i < 49; i++) {
        const int y = i / 7;
        const struct layers_two at = layers_beside(x, i % 7 - 3);
        const vf v = layers_load_two(u->light[y], at), far = vf_div(v, most), square = vf_mul(far, far);
        const vf fourth = vf_mul(square, square);
        const vf front = layers_front(middle, slope, layers_load_two(u->radius[y], at)), back = vf_sub(one, front);
        const vf few = vf_mul(vf_set1(0.015625f * hf_unmix_weights[y][i % 7]), layers_dimmed(v, plain));
        const vf brightest = vf_mul(vf_set1(0.015625f), vf_mul(fourth, fourth));
        const vf w[2] = {vf_mul(few, front), vf_mul(brightest, back)}, few_back = vf_mul(few, back);
        dark[0] = vf_add(dark[0], w[0]);
        dark[1] = vf_add(dark[1], few_back);
        light[0] = vf_fma(w[0], v, light[0]);
        light[1] = vf_fma(few_back, v, light[1]);
        bright[0] = vf_fma(brightest, front, bright[0]);
        bright[1] = vf_add(bright[1], w[1]);
        for (int side = 0; side < 2; side++)
            for (int c = 0; c < 5; c++)
                if (c < channels || c == 4)
                    lamp[side][c] = vf_fma(w[side], layers_value(u, y, at, c), lamp[side][c]);
    }
    const vm both = vm_and(wanted, vm_and(vf_gt(dark[0], zero), vf_gt(bright[1], zero)));
    const vf front = vf_div(light[0], dark[0]), back = vf_keep(vf_gt(dark[1], zero), vf_div(light[1], dark[1]));
    const vf floor = vf_max(vf_max(front, back), vf_set1(1e-30f));
    const vf times = vf_mul(vf_sub(vf_div(own, floor), vf_set1(HF_UNMIX_TIMES)), vf_set1(0.5f));
    const vf of_back = vf_div(bright[1], vf_add(bright[0], bright[1]));
    const vf by = vf_mul(vf_mul(vf_saturate(times), of_back), vf_saturate(vf_mul(thick, vf_set1(2))));
    for (int side = 0; side < 2; side++) {
        spread[side] = vf_select(both, vf_fnma(by, spread[side], spread[side]), spread[side]);
        for (int c = 0; c < 5; c++)
            if (c < channels || c == 4) {
                const vf v = vf_div(lamp[side][c], side ? bright[1] : dark[0]);
                mean[side][c] = vf_select(both, vf_fma(by, vf_sub(v, mean[side][c]), mean[side][c]), mean[side][c]);
            }
    }
}

// What both sides of each pixel are, and how much of that is known. Returns the lanes that have both sides.
HF_INLINE vm layers_both_sides(const struct hf_unmix_row *u, struct layers_two x, const int channels, vm mixed, vf a0,
                               vf mean[2][5], vf spread[2], vf *known)
{
    const vf zero = vf_zero(), one = vf_set1(1), told = vf_sub(vf_add(a0, a0), one);
    vf weight[2];
    layers_sides(u, x, channels, zero, weight, mean, spread);
    const vf unsure = vf_sub(one, vf_saturate(vf_mul(vf_add(weight[0], weight[1]), vf_set1(1 / HF_UNMIX_FAINT))));
    const vf thick = vf_keep(mixed, vf_mul(unsure, vf_mul(told, told)));
    const int thicket = vm_any(vf_gt(thick, zero));
    if (thicket)
        layers_sides_in_thicket(u, x, channels, thick, weight, mean, spread);
    const vf both_weigh = vf_add(weight[0], weight[1]), little = vf_mul(vf_set1(HF_UNMIX_LEAN), both_weigh);
    *known = vf_min(vf_mul(both_weigh, vf_set1(1 / HF_UNMIX_FAINT)), one);
    mixed = vm_and(mixed, vf_gt(both_weigh, zero));
    const vm lacks = vm_and(mixed, vf_lt(vf_min(weight[0], weight[1]), little));
    if (vm_any(lacks))
        layers_complete(u, x, channels, lacks, weight, little, mean, spread);
    if (thicket)
        layers_lamp_in_thicket(u, x, channels, thick, mean, spread);
    return mixed;
}

HF_INLINE vf layers_rest(const struct hf_unmix_row *u, struct layers_two x, int c, vf a, vf mean[2][5])
{
    return vf_fnma(vf_sub(vf_set1(1), a), mean[1][c], vf_fnma(a, mean[0][c], layers_load_two(u->colour[3][c], x)));
}

HF_INLINE vf layers_share(const struct hf_unmix_row *u, struct layers_two x, const int channels, vf a0, vf mean[2][5],
                          const vf spread[2], vf *behind)
{
    vf along = vf_zero(), apart = vf_zero(), size = vf_zero(), off = vf_zero();
    for (int c = 0; c < channels; c++) {
        const vf f = mean[0][c], b = mean[1][c], d = vf_sub(f, b);
        along = vf_fma(vf_sub(layers_load_two(u->colour[3][c], x), b), d, along);
        apart = vf_fma(d, d, apart);
        size = vf_add(size, vf_fma(f, f, vf_mul(b, b)));
    }
    const vf zero = vf_zero(), one = vf_set1(1), b0 = vf_sub(one, a0);
    const vf own = vf_fma(vf_mul(a0, a0), spread[0], vf_mul(vf_mul(b0, b0), spread[1]));
    const vf es = vf_fma(vf_set1(HF_UNMIX_SPREAD), own, vf_mul(vf_set1(1e-3f), size));
    vf a = vf_div(vf_fma(es, a0, along), vf_add(apart, es));
    a = vf_select(vf_gt(a, zero), vf_select(vf_lt(a, one), a, one), vf_select(vf_le(a, zero), zero, a0));
    for (int c = 0; c < channels; c++) {
        const vf rest = layers_rest(u, x, c, a, mean);
        off = vf_fma(rest, rest, off);
    }
    const vf trust = vf_div(apart, vf_add(apart, off));
    a = vf_select(vf_le(zero, trust), vf_fma(vf_sub(a, a0), trust, a0), a0);
    const vf unexplained = vf_mul(vf_div(off, apart), vf_set1(HF_UNMIX_UNEXPLAINED));
    const vf differ = vf_sub(vf_mul(vf_div(apart, size), vf_set1(HF_UNMIX_ALIKE)), one);
    const vf part = vf_mul(vf_saturate(unexplained), vf_saturate(differ));
    *behind = vf_keep(vf_gt(apart, zero), vf_mul(part, vf_mul(b0, vf_set1(HF_UNMIX_HALF))));
    return vf_min(a, vf_sub(one, *behind));
}

// How far each pixel shows a lamp behind the edge, lane by lane: lamps are few.
HF_INLINE vf layers_lit(const struct hf_unmix_row *u, struct layers_two x, vm mixed, vf mean[2][5])
{
    vf light[2];
    for (int i = 0; i < 2; i++)
        light[i] = layers_eighth_light(mean[i][0], mean[i][1], mean[i][2]);
    const vf most = vf_max(light[0], light[1]), wider = vf_sub(vf_abs(mean[1][4]), vf_abs(mean[0][4]));
    const vm bright = vm_and(vf_gt(layers_load_two(u->light[3], x), vf_mul(most, vf_set1(HF_UNMIX_LAMP))),
                             vm_and(mixed, vf_gt(wider, vf_zero())));
    if (!vm_any(bright))
        return vf_zero();
    float lamp[VF_N], limit[VF_N], alpha[VF_N];
    vf_store(lamp, vf_keep(bright, vf_min(wider, vf_set1(1))));
    vf_store(limit, most);
    vf_store(alpha, vf_max(mean[0][3], mean[1][3]));
    for (int lane = 0; lane < VF_N; lane++)
        if (lamp[lane] > 0) {
            const int at = lane < VF_N / 2 ? x.a + lane : x.b + lane - VF_N / 2;
            lamp[lane] = lamp[lane] * hf_unmix_lamp(u, at, limit[lane], alpha[lane]);
        }
    return vf_load(lamp);
}

HF_INLINE void layers_unmix_two(const struct hf_unmix_row *u, struct layers_two x, const int channels)
{
    vm mixed = vf_lt(layers_load_two(u->sure[3], x), vf_set1(1));
    vf mean[2][5], spread[2], known;
    const vf own = layers_load_two(u->radius[3], x), one = vf_set1(1), zero = vf_zero();
    const vf a0 = layers_front(layers_load_two(u->middle, x), layers_load_two(u->slope, x), own);
    mixed = layers_both_sides(u, x, channels, mixed, a0, mean, spread, &known);
    const vf by = vf_mul(vf_sub(one, layers_load_two(u->sure[3], x)), known), lamp = layers_lit(u, x, mixed, mean);
    vf behind, a = layers_share(u, x, channels, a0, mean, spread, &behind);
    a = vf_fma(lamp, vf_sub(vf_min(a, vf_set1(HF_UNMIX_RIM)), a), a);
    const vf seen = vf_fma(by, vf_sub(a, one), one);
    const vf whole = vf_keep(vf_gt(seen, zero), vf_div(vf_sub(one, by), seen));
    const vf more_back = vf_mul(behind, vf_div(a, vf_sub(one, a)));
    const vf scale = vf_select(vf_lt(a, one), vf_add(one, more_back), one);  // at most 2
    for (int c = 0; c < channels; c++) {
        const vf rest = layers_rest(u, x, c, a, mean);
        const vf v = layers_load_two(u->colour[3][c], x);
        const vf more = c < 3 ? vf_max(rest, zero) : zero;
        const vf front = vf_between(vf_add(vf_fnma(lamp, more, rest), mean[0][c]), mean[0][c], v);
        const vf back = vf_between(vf_fma(rest, scale, mean[1][c]), mean[1][c], v);
        layers_store_two(u->seen[c], x, vf_select(mixed, vf_fma(whole, vf_sub(v, front), front), v));
        layers_store_two(u->mixed[c], x, vf_keep(mixed, back));
    }
    const vf front = vf_fma(vf_sub(one, a0), vf_sub(mean[0][4], own), own);
    layers_store_two(u->seen[4], x, vf_select(mixed, seen, one));
    layers_store_two(u->mixed[4], x, vf_keep(mixed, vf_sub(one, seen)));
    layers_store_two(u->seen[5], x, vf_select(mixed, vf_fma(whole, vf_sub(own, front), front), own));
    layers_store_two(u->mixed[5], x, vf_select(mixed, vf_fma(a0, vf_sub(mean[1][4], own), own), own));
}

// Un-mixes half a vector from x on together with the one that waits, or lets it wait for another. Returns the one that waits,
// or -1.
HF_INLINE int layers_unmix_half(const struct hf_unmix_row *u, int waits, int x, const int channels)
{
    if (waits < 0)
        return x;
    layers_unmix_two(u, (struct layers_two){waits, x}, channels);
    return -1;
}

// Where the first half of a vector's mixed pixels begins; it must not reach beyond the vector.
HF_INLINE int layers_first_half(const float *sure)
{
    int i = 0;
    while (i < VF_N / 2 && !(sure[i] < 1))
        i++;
    return i;
}

HF_INLINE void layers_unmix_of(const struct hf_unmix_row *u, int n, const int channels)
{
    int waits = -1;
    for (int x = 0; x < n; x += VF_N) {
        const vm mixed = vf_lt(vf_load(u->sure[3] + x), vf_set1(1));
        layers_keep(u, x, channels);
        if (!vm_any(mixed))
            continue;
        u->any[x / 16] = 1;
        layers_prepare(u, x, channels);
        const int first = layers_first_half(u->sure[3] + x);
        int more = 0;
        for (int i = first + VF_N / 2; i < VF_N; i++)
            more |= u->sure[3][x + i] < 1;
        waits = layers_unmix_half(u, waits, x + first, channels);
        if (more)
            waits = layers_unmix_half(u, waits, x + VF_N / 2, channels);
    }
    if (waits >= 0)
        layers_unmix_two(u, (struct layers_two){waits, waits}, channels);
}

static void layers_unmix_simd(const struct hf_unmix_row *u, int n)
{
    HF_WITH_CHANNELS(u->channels, layers_unmix_of(u, n, CHANNELS));
}
