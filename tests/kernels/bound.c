// SPDX-License-Identifier: BSD-3-Clause
// How far fused arithmetic may be from the C. Both round, at different places. With k roundings of half an FLT_EPSILON
// each on the way to a result, each is within k / 2 FLT_EPSILON of the exact result, and the two are within k
// FLT_EPSILON of each other, times the sum of the magnitudes of the terms. The counts below are those of the longer of
// the two ways. Where storage rounds the results, they may differ by one step.
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "harness.h"
#include "pixel/unorm.h"

static float reference_at(const struct world *w, int b, int c, int x, int y)
{
    return *hf_at(&w->reference.buf[b], c, x, y);
}

// The distance of neighbouring numbers of a small format at v.
static double half_step(double v)
{
    return fmax(fabs(v) * 0x1p-10, 0x1p-24);
}

static double r11_step(int c, double v)
{
    return c == 2 ? fmax(fabs(v) * 0x1p-5, 0x1p-19) : fmax(fabs(v) * 0x1p-6, 0x1p-20);
}

static double storage_step(const struct world *w, int c, float want, float got)
{
    const double v = fmax(fabs((double)want), fabs((double)got));
    if (w->setup.storage == HF_STORAGE_HALF)
        return half_step(v);
    return w->setup.storage == HF_STORAGE_PACKED && c < 3 ? r11_step(c, v) : 0;
}

// The sRGB curve is steepest at 1: 2.4 / 1.055.
static double unorm_step(const struct hf_image *m, int c)
{
    return (m->transfer == HF_TRANSFER_SRGB ? 2.4 / 1.055 : 1) / ((1 << hf_unorm(m->format)->bits[c]) - 1);
}

static double format_step(const struct world *w, int c, float want, float got)
{
    if (hf_unorm(w->dst.format))
        return unorm_step(&w->dst, c);
    const double v = fmax(fabs((double)want), fabs((double)got));
    if (w->dst.format == HF_FORMAT_RGBA16F)
        return half_step(v);
    return w->dst.format == HF_FORMAT_R11G11B10F ? r11_step(c, v) : 0;
}

// The largest sample of the picture in a rectangle of pixels, and around it where one has to be repaired.
double bound_largest_sample(const struct world *w, int c, int x0, int y0, int x1, int y1)
{
    double most = 0;
    for (int y = hf_max(y0, 0); y <= hf_min(y1, w->src.height - 1); y++)
        for (int x = hf_max(x0, 0); x <= hf_min(x1, w->src.width - 1); x++) {
            const float v = hf_sample(&w->src, c, x, y);
            if (hf_is_finite(v))
                most = fmax(most, fabs((double)v));
        }
    return most;
}

// Downsample, colour x far. Roundings: d within 2, d1 (d2 d3) within 8, the sum of four within 10, its inverse 11, a
// weight 20, the sum of weighted colours 23, times CoC 24.
static double bound_down(const struct world *w, int c, int x, int y)
{
    const double most = bound_largest_sample(w, c, 2 * x - 1, 2 * y - 1, 2 * x + 2, 2 * y + 2);
    return 25 * FLT_EPSILON * most * reference_at(w, HF_BUF_COC, 2, x, 2 * y);
}

// The values at (x +- dx, y +- dy), each counted once.
static double mirrored(const struct world *w, int b, int c, int x, int y, int dx, int dy)
{
    double sum = 0;
    for (int v = y - dy; v <= y + dy; v += 2 * dy + !dy)
        for (int u = x - dx; u <= x + dx; u += 2 * dx + !dx)
            sum += fabs((double)reference_at(w, b, c, u, v));
    return sum;
}

// Sum of |weight x value| over the lattice.
static double lattice_sum(const struct world *w, int b, int c, int x, int y)
{
    const struct hf_taps *t = world_taps(w);
    double sum = 0;
    for (int k = 0; k < t->rows; k++)
        for (int i = t->first[k]; i < t->first[k + 1]; i++)
            sum += fabs((double)t->weight[i]) *
                   (t->symmetric ? mirrored(w, b, c, x, y, t->column[i], k)
                                 : fabs((double)reference_at(w, b, c, x + t->column[i] - t->rx, y + k - t->ry)));
    return sum;
}

// The sum of the magnitudes of all four neighbours of all taps of the per-pixel kernel.
static double taps_sum(const struct world *w, int b, int c, int x, int y)
{
    const struct hf_tap_set *t = &w->chapter.taps;
    const float scale = reference_at(w, HF_BUF_COC4, 1, x, y);
    double sum = 0;
    for (int i = 0; i < t->count; i++) {
        const int u = x + (int)floorf(t->dx[i] * scale), v = y + (int)floorf(t->dy[i] * scale);
        for (int k = 0; k < 4; k++)
            sum += fabs((double)reference_at(w, b, c, u + (k & 1), v + (k >> 1)));
    }
    return sum;
}

// Roundings on the way to a sum of the gather. In a row: the pair, the product, one addition per column; then one
// addition per row. Karis: luminance 3, the weight 5, and 6 more for its product with the value.
static double gather_roundings(const struct world *w)
{
    const struct hf_taps *t = world_taps(w);
    return 2 * t->rx + 2 * t->ry + 4 + (w->chapter.fields.karis ? 6 : 0);
}

// A quotient of sums has the errors of both, and those of the division, or of the inverse and the product with it.
double bound_quotient(double error, double divisor_error, double divisor, double value)
{
    divisor = fmax(divisor, FLT_MIN);
    if (divisor_error > divisor / 2)
        return INFINITY;  // no bound
    return (error + value * divisor_error) / (divisor - divisor_error) + 2 * value * FLT_EPSILON;
}

// Mixing with the pixel's own colour adds four roundings. The mean's part in the result is at most the result plus the
// own colour's part.
static double bound_near(const struct world *w, int c, int x, int y, float want)
{
    const double k = gather_roundings(w) * FLT_EPSILON, blur = reference_at(w, HF_BUF_BLUR, 0, x, y);
    if (!(blur > 0))
        return 0;  // a copy
    double value = fabs((double)want), mixed = 0;
    if (!w->resolved.params.chapter.faithful && HF_NEAR_WHOLE * blur < 1) {
        value += fabs((double)reference_at(w, HF_BUF_COLOR4, c, x, y));
        mixed = 4 * FLT_EPSILON * value;
    }
    if (!w->chapter.fields.karis)
        return k * lattice_sum(w, HF_BUF_COLOR4, c, x, y) + mixed;
    const double divisor = lattice_sum(w, HF_BUF_WEIGHT, 0, x, y);
    return bound_quotient(k * lattice_sum(w, HF_BUF_COLORW4, c, x, y), k * divisor, divisor, value) + mixed;
}

static double bound_far(const struct world *w, int c, int x, int y, float want)
{
    const int colour = w->chapter.fields.karis ? HF_BUF_COLORFARW4 : HF_BUF_COLORFAR4;
    const int weight = w->chapter.fields.karis ? HF_BUF_WEIGHT : HF_BUF_COC4;
    if (!(reference_at(w, HF_BUF_COC4, 1, x, y) > 0))
        return 0;
    // Products of denormals may be off by one denormal step.
    const int n = w->chapter.fields.per_pixel_kernel
                      ? 4 * w->chapter.taps.count
                      : (2 * w->chapter.taps.taps.rx + 1) * (2 * w->chapter.taps.taps.ry + 1);
    const double denormal = n * 0x1p-149;
    double k = gather_roundings(w) * FLT_EPSILON, sum, divisor, divisor_sum;
    if (w->chapter.fields.per_pixel_kernel) {
        // Three interpolations with 3 roundings each; the last one sees the others' magnitudes: 6 of all four
        // neighbours. Then one addition per tap.
        k = (6 + w->chapter.taps.count + (w->chapter.fields.karis ? 6 : 0)) * FLT_EPSILON;
        sum = taps_sum(w, colour, c, x, y);
        divisor_sum = taps_sum(w, weight, 1, x, y);
        divisor = reference_at(w, HF_BUF_SUM, 1, x, y);
    } else {
        sum = lattice_sum(w, colour, c, x, y);
        divisor = divisor_sum = lattice_sum(w, weight, 1, x, y);
    }
    return bound_quotient(k * sum + denormal, k * divisor_sum + denormal, divisor, fabs((double)want));
}

// ---- by area: weights of every kernel are positive and sum to 1, so no sum exceeds the largest sample ----

static double largest_near(const struct world *w, int b, int c, int x, int y)
{
    const struct hf_taps *t = world_taps(w);
    double most = 0;
    for (int v = y - t->ry; v <= y + t->ry; v++)
        for (int u = x - t->rx; u <= x + t->rx; u++)
            most = fmax(most, fabs((double)reference_at(w, b, c, u, v)));
    return most;
}

// Roundings of a level: its planes 8 (12 with Karis), pairs and their sums 2 rx, products and sums along a row 2 rx,
// rows 2 ry, the scale 1; adding a level 3. Then quotients and blends: 16.
static double area_roundings(const struct world *w)
{
    const struct hf_taps *t = w->gather.many ? &w->gather.levels[2].level[0].kernel.taps : world_taps(w);
    return (w->gather.fields.karis ? 12 : 8) + 4 * t->rx + 2 * t->ry + 3 * HF_MAX_LEVELS + 17;
}

// What near pixels occlude is divided by the part of the kernel that lies in the frame, or by all weight that counts.
// That is at least a pixel's weight in its own smallest kernel, a hundredth of 1 or less with one large level. With
// several levels the background counts by what the near field leaves open, so the near field's error is multiplied by
// the background's mean. In a frame that is at most the largest sample, but in buffers of noise it may be anything.
static double area_near_bound(const struct world *w, int c, int x, int y)
{
    const struct hf_taps *t = world_taps(w);
    const struct hf_setup *s = &w->setup;
    double most = 1,
           part = hf_area_part(&w->gather.levels[0].level[0].kernel, -x, s->half_width - x, -y, s->half_height - y);
    if (c >= 0)
        most = fmax(largest_near(w, HF_BUF_COLOR4, c, x, y), largest_near(w, HF_BUF_COLORNEAR4, c, x, y));
    if (!hf_gather_is_simple(s))
        part = fmin(part, t->weight[0] * t->scale) / (w->gather.fields.karis ? 100 : 1);
    double behind = 0;
    if (!hf_gather_is_simple(s) && c >= 0) {
        const double weight = reference_at(w, HF_BUF_BEHIND_WEIGHT, !w->gather.fields.karis, x, y);
        behind = weight > 0 ? fabs((double)reference_at(w, HF_BUF_BEHIND, c, x, y)) / weight : 0;
    }
    return area_roundings(w) * FLT_EPSILON * (most * 2 / part + behind);
}

// The error of a quotient: twice the sum's magnitudes over the weight; of the smallest level, of that and the next, and
// so on. Products of denormals may be off by one denormal step.
static double area_far_bound(const struct world *w, int c, int x, int y)
{
    const struct hf_levels *l = &w->gather.levels[1];
    const struct hf_taps *t = world_taps(w);
    const int simple = hf_gather_is_simple(&w->setup);
    double worst = 0, sum = 0, weight = 0;
    for (int i = l->count - 1; i >= 0; i--) {
        const struct hf_area_kernel *kernel = &l->level[i].kernel;
        const struct hf_taps *k = &kernel->taps;
        for (int v = y - k->ry; v <= y + k->ry; v++)
            for (int u = x - k->rx; u <= x + k->rx; u++) {
                const double part = hf_area_part(kernel, u - x, u - x + 1, v - y, v - y + 1);
                const double reach =
                    simple ? 1 : hf_level_spread(l, i, reference_at(w, HF_BUF_COC4, HF_AREA_FAR_OF_LIGHT, u, v));
                const double karis = w->gather.fields.karis ? reference_at(w, HF_BUF_WEIGHT, 0, u, v) : 1;
                sum += part * reach * karis * fabs((double)reference_at(w, HF_BUF_COLORFAR4, c, u, v));
                weight += part * reach * karis * reference_at(w, HF_BUF_COC4, HF_AREA_FAR, u, v);
            }
        const double denormal = 4 * (2 * t->rx + 1) * (2 * t->ry + 1) * 0x1p-149;
        const double divisor = fmax(weight, FLT_MIN);
        worst = fmax(worst, (2 * area_roundings(w) * FLT_EPSILON * sum + denormal * (1 + sum / divisor)) / divisor);
    }
    return worst;
}

static double area_bound(const struct world *w, int b, int c, int x, int y)
{
    const int cancels = w->gather.fields.karis && w->colours == COLOURS_MIXED;
    if (b == HF_BUF_COLORNEAR4 || b == HF_BUF_COLORFAR4)  // two products, three sums
        return 5 * FLT_EPSILON * bound_largest_sample(w, c, 2 * x - 1, 2 * y - 1, 2 * x + 2, 2 * y + 2);
    if (b == HF_BUF_COVER)
        return cancels ? INFINITY : area_near_bound(w, -1, x, y);
    if (b == HF_BUF_NEAR)
        return cancels ? INFINITY : area_near_bound(w, c, x, y);
    return b != HF_BUF_FAR ? 0 : cancels ? INFINITY : area_far_bound(w, c, x, y);
}

double bound_buffer(const struct world *w, int b, int c, int x, int y, float want, float got)
{
    if (w->engine == &hf_hexagon_engine)
        return hexagon_bound_buffer(w, b, c, x, y, want);
    double bound = 0;
    // Luminance of colours of both signs can cancel, and then no bound holds.
    const int cancels = w->chapter.fields.karis && w->colours == COLOURS_MIXED;
    if (!is_chapter(w))
        bound = area_bound(w, b, c, x, y);
    else if (b == HF_BUF_COLORFAR4)
        bound = bound_down(w, c, x, y);
    else if (b == HF_BUF_NEAR)
        bound = cancels ? INFINITY : bound_near(w, c, x, y, want);
    else if (b == HF_BUF_FAR)
        bound = cancels ? INFINITY : bound_far(w, c, x, y, want);
    return bound > 0 ? bound + 0x1p-140 + storage_step(w, !is_chapter(w) && b == HF_BUF_COVER ? 3 : c, want, got) : 0;
}

// Composite. Far weights: d 2, products 8, their sum 10, inverse 11, together 20; the rest of the colour 25, the blend
// 3 more. The near field: bilinear 3, its weight 4 of a difference of up to twice the largest colour, blend 5: 16. The
// cubic: 10, 11 twice, 5.
double bound_pixel(const struct world *w, int c, int x, int y, float want, float got)
{
    if (w->engine == &hf_hexagon_engine)
        return hexagon_bound_pixel(w, c, x, y) + format_step(w, c, want, got);
    const int bicubic = is_chapter(w) ? w->chapter.fields.bicubic : w->gather.fields.bicubic, reach = bicubic ? 2 : 1;
    const int near = is_chapter(w) ? (int)HF_BUF_NEAR_FILL : (int)HF_BUF_NEAR;
    const int far = is_chapter(w) ? (int)HF_BUF_FAR_FILL : (int)HF_BUF_FAR;
    double most = bound_largest_sample(w, c, x - 1, y - 1, x + 1, y + 1);
    for (int v = y / 2 - reach; v <= y / 2 + reach && c < w->setup.channels; v++)
        for (int u = x / 2 - reach; u <= x / 2 + reach; u++) {
            if (w->near)
                most = fmax(most, fabs((double)reference_at(w, near, c, u, v)));
            if (w->far && abs(u - x / 2) < 2 && abs(v - y / 2) < 2)
                most = fmax(most, fabs((double)reference_at(w, far, c, u, v)));
        }
    const int roundings = (w->far ? 30 : 0) + (w->near ? (bicubic ? 37 : 16) : 0);
    return (roundings + 1) * FLT_EPSILON * most + 0x1p-140 + storage_step(w, c, want, got) +
           format_step(w, c, want, got);
}
