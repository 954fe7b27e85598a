// SPDX-License-Identifier: BSD-3-Clause
// Computation: the pass that blurs the far and the near field with the aperture's kernels, at half resolution.
//
// Far field: a pixel is the mean of the far samples within the kernel, each weighted by how far out of focus it is.
//
// Near field: each near sample is spread over the area of its blur, and the sum is drawn over the picture. Where a near
// object itself becomes transparent, the lens sees what it hides. The picture does not show that, so the disocclusion
// fill guesses it: the mean of the samples around the pixel that are not near.
//
// With several levels (gather.h):
// - The level that fits a sample's own blur spreads it.
// - A far pixel is the mean of those far samples that are not blurred much more than the pixel itself.
// - The fill of a near pixel is the mean over all levels up to the pixel's own. So the samples at the least distance
//   from it in the picture count most.
// - A level of less than half the radius of a far sample's blur would draw that sample too sharp. The sample keeps its
//   weight in the fill there, but its colour is what the far levels spread to the pixel.
//
// Samples outside the frame have no weight: all sums are of samples within it.
#include <float.h>

#include "engine/gather/gather.h"

int hf_area_inside(const struct hf_setup *s, const struct hf_area_kernel *k, int x, int y, int n, float *inside)
{
    const struct hf_taps *t = &k->taps;
    const int whole = hf_area_is_whole(s, t, y), width = s->half_width;
    if (whole && x >= t->rx && x + n + t->rx <= width)
        return 0;
    const int left = hf_min(hf_max(t->rx - x, 0), n), right = hf_min(hf_max(width - t->rx - x, left), n);
    const float middle = whole ? 1 : hf_area_part(k, -t->rx, t->rx + 1, -y, s->half_height - y);
    for (int i = 0; i < n; i++)
        inside[i] =
            i >= left && i < right ? middle : hf_area_part(k, -(x + i), width - (x + i), -y, s->half_height - y);
    return 1;
}

// How far the near field hides at a pixel what is behind it: 1 where near pixels are fully so.
static float hidden(const struct hf_frame *f, int x, int y)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_NEAR);
    return hf_level_part(l, l->hides, *hf_at(&f->buf[HF_BUF_BLUR], 0, x, y));
}

static void store_near(const struct hf_frame *f, int y, struct hf_rect r)
{
    float *near[4];
    hf_row(&f->buf[HF_BUF_NEAR], f->s->channels, r.x0, y, near);
    hf_store_rgb(f, near, r.x1 - r.x0);
    if (f->s->storage == HF_STORAGE_HALF)
        f->k->round_half(hf_at(&f->buf[HF_BUF_COVER], 0, r.x0, y), r.x1 - r.x0);
}

// A row of a buffer that is used up at once, whatever its y: scratch rows from the third on.
static struct hf_buf lines_from(const struct hf_frame *f, int x0)
{
    struct hf_buf b = {.stride = 0};
    for (int c = 0; c < 4; c++)
        b.ch[c] = hf_line(f, 2 + c) - x0;
    return b;
}

// Near colour, or how much it covers, where it hides m of what is behind.
static void hide(float *v, float m, float behind)
{
    if (m == 1)
        *v = behind;
    else if (m > 0)
        *v += m * (behind - *v);
}

static void near_simple(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const struct hf_area_kernel *k = &hf_gather_levels(s, HF_NEAR)->level[0].kernel;
    const struct hf_buf *near = &f->buf[HF_BUF_NEAR], *cover = &f->buf[HF_BUF_COVER];
    const struct hf_buf behind = lines_from(f, r.x0);
    float *inside = hf_line(f, 1);
    for (int c = 0; c < s->channels; c++)
        hf_convolve_c(f, r, &k->taps, &f->buf[HF_BUF_COLORNEAR4], c, near, c);
    hf_convolve_c(f, r, &k->taps, &f->buf[HF_BUF_COC4], HF_AREA_NEAR, cover, 0);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        const int cut = hf_area_inside(s, k, r.x0, y, r.x1 - r.x0, inside);
        for (int c = 0; c < s->channels; c++)
            hf_convolve_c(f, (struct hf_rect){r.x0, y, r.x1, y + 1}, &k->taps, &f->buf[HF_BUF_COLOR4], c, &behind, c);
        for (int x = r.x0; x < r.x1; x++) {
            const float m = hidden(f, x, y), part = cut ? inside[x - r.x0] : 1;
            for (int c = 0; c < s->channels; c++) {
                *hf_at(near, c, x, y) /= part;
                hide(hf_at(near, c, x, y), m, *hf_at(&behind, c, x, y) / part);
            }
            *hf_at(cover, 0, x, y) /= part;
            hide(hf_at(cover, 0, x, y), m, 1);
        }
        store_near(f, y, r);
    }
}

// ---- levels ----

static struct hf_rect grown(const struct hf_taps *t, struct hf_rect r)
{
    return (struct hf_rect){r.x0 - t->rx, r.y0 - t->ry, r.x1 + t->rx, r.y1 + t->ry};
}

static int in_frame(const struct hf_setup *s, int x, int y)
{
    return x >= 0 && y >= 0 && x < s->half_width && y < s->half_height;
}

// Karis weights, wherever something reaches.
static void weigh(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_reach reach = hf_gather_halo(f->s, HF_HALO_TAPS);
    const struct hf_buf *b = &f->buf[HF_BUF_COLOR4];
    for (int y = r.y0 - reach.y; y < r.y1 + reach.y && !hf_stopped(f->s->stop); y++)
        for (int x = r.x0 - reach.x; x < r.x1 + reach.x; x++)
            *hf_at(&f->buf[HF_BUF_WEIGHT], 0, x, y) =
                hf_fields(f->s)->karis ? hf_karis_weight(*hf_at(b, 0, x, y), *hf_at(b, 1, x, y), *hf_at(b, 2, x, y))
                                       : 1;
}

static float karis(const struct hf_frame *f, int x, int y)
{
    return hf_fields(f->s)->karis ? *hf_at(&f->buf[HF_BUF_WEIGHT], 0, x, y) : 1;
}

enum part { PART_NEAR, PART_FAR };

// What a level's taps are laid over: colour times weight, the weight, and the weight without Karis'.
static void level_planes(const struct hf_frame *f, struct hf_rect r, enum part part, int i)
{
    const struct hf_levels *l = hf_gather_levels(f->s, part == PART_FAR ? HF_FAR : HF_NEAR);
    const struct hf_rect area = grown(&l->level[i].kernel.taps, r);
    const struct hf_buf *coc4 = &f->buf[HF_BUF_COC4];
    const struct hf_buf *from = &f->buf[part == PART_FAR ? HF_BUF_COLORFAR4 : HF_BUF_COLORNEAR4];
    for (int y = area.y0; y < area.y1 && !hf_stopped(f->s->stop); y++)
        for (int x = area.x0; x < area.x1; x++) {
            const float w = karis(f, x, y);
            const float share = part == PART_FAR ? hf_level_spread(l, i, *hf_at(coc4, HF_AREA_FAR_OF_LIGHT, x, y))
                                                 : hf_level_share(l, i, *hf_at(coc4, HF_AREA_NEAR_MOST, x, y));
            const float weight = *hf_at(coc4, part == PART_FAR ? HF_AREA_FAR : HF_AREA_NEAR, x, y);
            for (int c = 0; c < f->s->channels; c++)
                *hf_at(&f->buf[HF_BUF_LEVEL], c, x, y) = *hf_at(from, c, x, y) * (share * w);
            *hf_at(&f->buf[HF_BUF_LEVEL_WEIGHT], 0, x, y) = weight * (share * w);
            *hf_at(&f->buf[HF_BUF_LEVEL_WEIGHT], 1, x, y) = weight * share;
        }
}

// The same of what is not near, less what of far samples is left to the far levels; that is the last weight.
static void behind_planes(const struct hf_frame *f, struct hf_rect r, int i)
{
    const struct hf_levels *l = hf_gather_behind(f->s);
    const struct hf_rect area = grown(&l->level[i].kernel.taps, r);
    const struct hf_buf *coc4 = &f->buf[HF_BUF_COC4], *level = &f->buf[HF_BUF_LEVEL_WEIGHT];
    const int leaves = hf_gather(f->s)->leaves;
    for (int y = area.y0; y < area.y1 && !hf_stopped(f->s->stop); y++)
        for (int x = area.x0; x < area.x1; x++) {
            const float w = karis(f, x, y);
            const float counts = hf_level_limits(f->s, i) ? *hf_at(&f->buf[HF_BUF_WEIGHT], 2, x, y) : 1;
            const float left = leaves ? hf_level_left(l, i, *hf_at(coc4, HF_AREA_FAR_OF_LIGHT, x, y)) : 0;
            const float open = 1 - *hf_at(coc4, HF_AREA_NEAR, x, y), part = hf_open_part(open);
            const float all = leaves ? left * *hf_at(coc4, HF_AREA_FAR, x, y) : 0, far = all * part;
            const float rest = (open - all) * part;
            const float weight = rest > 0 && in_frame(f->s, x, y) ? rest : 0;
            for (int c = 0; c < f->s->channels; c++) {
                const float hidden = leaves ? left * *hf_at(&f->buf[HF_BUF_COLORFAR4], c, x, y) : 0;
                const float colour =
                    (*hf_at(&f->buf[HF_BUF_COLOR4], c, x, y) - *hf_at(&f->buf[HF_BUF_COLORNEAR4], c, x, y)) - hidden;
                *hf_at(&f->buf[HF_BUF_LEVEL], c, x, y) = rest > 0 ? ((colour * part) * counts) * w : 0;
            }
            *hf_at(level, 0, x, y) = weight * w;
            *hf_at(level, 1, x, y) = weight;
            *hf_at(level, 2, x, y) = far;
        }
}

// A tent over values that lie `by` apart, the first at p. Sums and doubles alone, which are the same fused.
static float tent(const float *p, ptrdiff_t by, int step)
{
    const float *middle = p + (step - 1) * by;
    const float beside = middle[-by] + middle[by];
    if (step == 2)
        return beside + (*middle + *middle);
    const float inner = ((middle[-2 * by] + middle[2 * by]) + beside) + (*middle + *middle);
    return ((middle[-3 * by] + middle[3 * by]) + beside) + (inner + inner);
}

// A plane convolved with the taps' tents, in place, as far as taps around r reach. What belongs to a pixel comes to lie where
// the first of its tent's values was.
static void tents(const struct hf_buf *plane, int c, struct hf_rect r, const struct hf_taps *t)
{
    const struct hf_rect all = grown(t, r);
    const int n = all.x1 - all.x0, around = 2 * (t->step - 1);
    for (int y = all.y0; y < all.y1 - around; y++) {
        float *row = hf_at(plane, c, all.x0, y);
        for (int x = 0; x < n; x++)
            row[x] = tent(row + x, plane->stride, t->step);
        for (int x = 0; x < n - around; x++)
            row[x] = tent(row + x, 1, t->step);
    }
}

static void convolve_plane(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, int in, int out, int c)
{
    struct hf_buf from = f->buf[in];
    if (t->step > 1) {
        tents(&from, c, r, t);
        from.ch[c] -= (t->step - 1) * (from.stride + 1);
    }
    hf_convolve_c(f, r, t, &from, c, &f->buf[out], c);
}

static void convolve_level(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t)
{
    for (int c = 0; c < f->s->channels; c++)
        convolve_plane(f, r, t, HF_BUF_LEVEL, HF_BUF_LEVEL_SUM, c);
    for (int c = 0; c < 2; c++)
        convolve_plane(f, r, t, HF_BUF_LEVEL_WEIGHT, HF_BUF_LEVEL_WEIGHT_SUM, c);
}

// Buffers of sums: colour, its weight, and the weight without Karis'.
struct sums {
    const struct hf_buf *colour, *weight[2];
    int channel[2];
};

static void clear(const struct hf_frame *f, struct hf_rect r, const struct sums *to)
{
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++)
        for (int x = r.x0; x < r.x1; x++) {
            for (int c = 0; c < f->s->channels; c++)
                *hf_at(to->colour, c, x, y) = 0;
            for (int i = 0; i < 2; i++)
                *hf_at(to->weight[i], to->channel[i], x, y) = 0;
        }
}

// What has no weight has no colour.
static void add(const struct hf_frame *f, const struct sums *to, int x, int y, float share)
{
    if (!(*hf_at(&f->buf[HF_BUF_LEVEL_WEIGHT_SUM], 1, x, y) > 0))
        return;
    for (int c = 0; c < f->s->channels; c++)
        *hf_at(to->colour, c, x, y) += share * *hf_at(&f->buf[HF_BUF_LEVEL_SUM], c, x, y);
    for (int i = 0; i < 2; i++)
        *hf_at(to->weight[i], to->channel[i], x, y) += share * *hf_at(&f->buf[HF_BUF_LEVEL_WEIGHT_SUM], i, x, y);
}

// Over the weight, which with Karis average is another one than what the colour counts.
static float weighed(float colour, float weight, float counts, int karis)
{
    return !karis ? colour : weight > 0 ? colour / weight * counts : 0;
}

// The weight of the disocclusion fill, such that a sample that counts once has a weight from 0 to 1: what the near field leaves
// free, over `see`, which counts the free part once for each level that sees it.
static float free_part(float cover, float see, float once)
{
    const float room = 1 - cover > 0 ? 1 - cover : 0, part = room / (see > FLT_MIN ? see : FLT_MIN), most = 1 / once;
    return part < most ? part : most;
}

static void finish_levels(const struct hf_frame *f, int x, int y, const struct sums *near, const struct sums *behind)
{
    const int karis = hf_fields(f->s)->karis;
    const float cover = *hf_at(near->weight[1], near->channel[1], x, y);
    const float see = *hf_at(behind->weight[1], behind->channel[1], x, y), most = cover > 1 ? cover : 1;
    const float part = free_part(cover, see, hf_gather(f->s)->once), all = cover + part * see;
    // A blur so small that its weights are 0 hides nothing.
    const float m = all > 0 ? hidden(f, x, y) : 0;
    for (int c = 0; c < f->s->channels; c++) {
        float *v = hf_at(near->colour, c, x, y);
        const float own = weighed(*v, *hf_at(near->weight[0], near->channel[0], x, y), cover, karis);
        const float back =
            weighed(*hf_at(behind->colour, c, x, y), *hf_at(behind->weight[0], behind->channel[0], x, y), see, karis);
        const float outside = own / most;
        *v = m > 0 ? outside + m * ((own + part * back) / all - outside) : outside;
    }
    const float outside = cover / most;
    *hf_at(near->weight[1], near->channel[1], x, y) = m > 0 ? outside + m * (1 - outside) : outside;
}

// What far levels spread to a pixel: as much of it as is seen, and as far samples count in the levels that left them to these.
static void add_far(const struct hf_frame *f, const struct sums *to, int x, int y)
{
    const struct hf_buf *weight = &f->buf[HF_BUF_SPREAD_WEIGHT];
    const float seen = *hf_at(weight, 1, x, y), part = *hf_at(to->weight[0], 2, x, y) / (seen > 1 ? seen : 1);
    if (!(seen > 0 && part > 0))
        return;
    for (int c = 0; c < f->s->channels; c++)
        *hf_at(to->colour, c, x, y) += part * *hf_at(&f->buf[HF_BUF_SPREAD], c, x, y);
    for (int i = 0; i < 2; i++)
        *hf_at(to->weight[i], i, x, y) += part * *hf_at(weight, i, x, y);
}

// One over what of a level lies in the frame.
static const float *beyond(const struct hf_frame *f, const struct hf_area_kernel *k, struct hf_rect r, int y)
{
    float *inside = hf_line(f, 0);
    const int n = r.x1 - r.x0, cut = hf_area_inside(f->s, k, r.x0, y, n, inside);
    for (int x = 0; x < n; x++)
        inside[x] = cut ? 1 / inside[x] : 1;
    return inside;
}

static void add_behind(const struct hf_frame *f, const struct sums *behind, struct hf_rect r, int i)
{
    const struct hf_levels *l = hf_gather_behind(f->s);
    const int leaves = hf_gather(f->s)->leaves;
    if (leaves)
        convolve_plane(f, r, &l->level[i].kernel.taps, HF_BUF_LEVEL_WEIGHT, HF_BUF_LEVEL_WEIGHT_SUM, 2);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        const float *part = beyond(f, &l->level[i].kernel, r, y);
        for (int x = r.x0; x < r.x1; x++) {
            const float coc = *hf_at(&f->buf[HF_BUF_BLUR], 0, x, y);
            const float share = hf_level_near(f->s, i, coc) * part[x - r.x0];
            if (!(coc > 0 && share > 0))
                continue;
            add(f, behind, x, y, share);
            if (leaves)
                *hf_at(behind->weight[0], 2, x, y) += share * *hf_at(&f->buf[HF_BUF_LEVEL_WEIGHT_SUM], 2, x, y);
        }
    }
}

static void near_levels(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_NEAR), *b = hf_gather_behind(f->s);
    const struct sums near = {&f->buf[HF_BUF_NEAR], {&f->buf[HF_BUF_SUM], &f->buf[HF_BUF_COVER]}, {0, 0}};
    const struct sums behind = {
        &f->buf[HF_BUF_BEHIND], {&f->buf[HF_BUF_BEHIND_WEIGHT], &f->buf[HF_BUF_BEHIND_WEIGHT]}, {0, 1}};
    if (hf_gather(f->s)->lights)
        hf_gather_lights_c(f, r);
    clear(f, r, &near);
    clear(f, r, &behind);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++)
        for (int x = r.x0; x < r.x1; x++)
            *hf_at(behind.weight[0], 2, x, y) = 0;
    for (int i = 0; i < l->count && !hf_stopped(f->s->stop); i++) {
        level_planes(f, r, PART_NEAR, i);
        convolve_level(f, r, &l->level[i].kernel.taps);
        for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
            const float *part = beyond(f, &l->level[i].kernel, r, y);
            for (int x = r.x0; x < r.x1; x++)
                add(f, &near, x, y, part[x - r.x0]);
        }
    }
    for (int i = 0; i < b->count && !hf_stopped(f->s->stop); i++) {
        behind_planes(f, r, i);
        convolve_level(f, r, &b->level[i].kernel.taps);
        add_behind(f, &behind, r, i);
    }
    for (int y = r.y0; y < r.y1 && hf_gather(f->s)->leaves && !hf_stopped(f->s->stop); y++)
        for (int x = r.x0; x < r.x1; x++)
            add_far(f, &behind, x, y);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        for (int x = r.x0; x < r.x1; x++)
            finish_levels(f, x, y, &near, &behind);
        store_near(f, y, r);
    }
}

// ---- far ----

// A sum over its weight; alpha as a true quotient, so that what is opaque stays so.
static float far_mean(int c, int x, int y, const struct hf_buf *sum, float weight)
{
    const float divisor = weight > FLT_MIN ? weight : FLT_MIN, v = *hf_at(sum, c, x, y);
    return c == 3 ? v / divisor : v * (1 / divisor);
}

// Is a pixel far, or beside one that is, and upsampled with it?
static int is_wanted(const struct hf_frame *f, int x, int y)
{
    int wanted = 0;
    for (int i = 0; i < 9; i++)
        wanted |= *hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR, x - 1 + i % 3, y - 1 + i / 3) > 0;
    return wanted;
}

static void far_simple(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const struct hf_taps *t = &hf_gather_levels(s, HF_FAR)->level[0].kernel.taps;
    const struct hf_buf *far = &f->buf[HF_BUF_FAR], sum = lines_from(f, r.x0);
    for (int c = 0; c < s->channels; c++)
        hf_convolve_c(f, r, t, &f->buf[HF_BUF_COLORFAR4], c, far, c);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        hf_convolve_c(f, (struct hf_rect){r.x0, y, r.x1, y + 1}, t, &f->buf[HF_BUF_COC4], HF_AREA_FAR, &sum, 0);
        for (int x = r.x0; x < r.x1; x++)
            for (int c = 0; c < s->channels; c++)
                *hf_at(far, c, x, y) = is_wanted(f, x, y) ? far_mean(c, x, y, far, *hf_at(&sum, 0, x, y)) : 0;
    }
}

// A pixel's CoC as it sees the far field: what is not far itself, beside what is, sees what that does.
static float far_seen(const struct hf_frame *f, int x, int y)
{
    const struct hf_buf *coc4 = &f->buf[HF_BUF_COC4];
    const float own = *hf_at(coc4, HF_AREA_FAR_OF_LIGHT, x, y), rest = 1 - *hf_at(coc4, HF_AREA_FAR, x, y);
    float most = 0;
    for (int i = 0; i < 9; i++) {
        const float v = *hf_at(coc4, HF_AREA_FAR_OF_LIGHT, x - 1 + i % 3, y - 1 + i / 3);
        most = v > most ? v : most;
    }
    return rest * most > own ? rest * most : own;
}

// A far pixel takes its mean of what has been spread so far when its level's turn is.
static void take_far(const struct hf_frame *f, const struct sums *all, int x, int y, int i)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_FAR);
    const float share = hf_level_seen(l, i, far_seen(f, x, y));
    for (int c = 0; c < f->s->channels; c++) {
        float *v = hf_at(&f->buf[HF_BUF_FAR], c, x, y);
        *v = i == l->count - 1 ? 0 : *v;
        if (i == 0 && !is_wanted(f, x, y))
            *v = 0;
        else if (share > 0)
            *v += share * far_mean(c, x, y, all->colour, *hf_at(all->weight[0], 0, x, y));
    }
}

// From the smallest level on all that is spread is summed up.
static void far_levels(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_FAR);
    const struct sums all = {
        &f->buf[HF_BUF_SPREAD], {&f->buf[HF_BUF_SPREAD_WEIGHT], &f->buf[HF_BUF_SPREAD_WEIGHT]}, {0, 1}};
    clear(f, r, &all);
    for (int i = l->count - 1; i >= 0; i--) {
        if (i >= l->filled) {
            level_planes(f, r, PART_FAR, i);
            convolve_level(f, r, &l->level[i].kernel.taps);
        }
        for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++)
            for (int x = r.x0; x < r.x1; x++) {
                if (i >= l->filled)
                    add(f, &all, x, y, 1);
                if (f->far)
                    take_far(f, &all, x, y, i);
            }
    }
}

// What is near beside something far is no less out of focus.
static void far_part(const struct hf_frame *f, int x, int y)
{
    const float far = *hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR, x, y);
    *hf_at(&f->buf[HF_BUF_FAR_PART], 0, x, y) = f->near ? far + *hf_at(&f->buf[HF_BUF_COC4], HF_AREA_NEAR, x, y) : far;
}

void hf_gather_computation_c(const struct hf_frame *f, struct hf_rect r)
{
    if (hf_fields(f->s)->karis)
        weigh(f, r);
    const int simple = hf_gather_is_simple(f->s);
    if (f->far && simple)
        far_simple(f, r);
    else if (f->far || (f->near && hf_gather(f->s)->leaves))
        far_levels(f, r);
    if (f->near && simple)
        near_simple(f, r);
    else if (f->near)
        near_levels(f, r);
    for (int y = r.y0; y < r.y1 && f->far && !hf_stopped(f->s->stop); y++) {
        float *far[4];
        hf_row(&f->buf[HF_BUF_FAR], f->s->channels, r.x0, y, far);
        hf_store_rgb(f, far, r.x1 - r.x0);
        for (int x = r.x0; x < r.x1; x++)
            far_part(f, x, y);
    }
}
