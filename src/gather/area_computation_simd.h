// SPDX-License-Identifier: BSD-3-Clause
// Computation by area, on vectors.

// ---- one kernel ----

HF_INLINE vf area_hidden(const float *blur, vf gain)
{
    return vf_min(vf_mul(gain, vf_load(blur)), vf_set1(1));
}

static void area_store_near(const struct hf_frame *f, int y, struct hf_rect r)
{
    float *near[4];
    hf_row(&f->buf[HF_BUF_NEAR], f->s->channels, r.x0, y, near);
    hf_store_rgb(f, near, r.x1 - r.x0);
    if (f->s->storage == HF_STORAGE_HALF)
        f->k->round_half(hf_at(&f->buf[HF_BUF_COVER], 0, r.x0, y), r.x1 - r.x0);
}

// What near pixels hide, under the near field.
static void area_finish_near(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const struct hf_levels *l = hf_gather_levels(s, HF_NEAR);
    const vf gain = vf_set1(l->gain), one = vf_set1(1);
    float *inside = hf_line(f, 0);
    for (int y = r.y0; y < r.y1; y++) {
        float *near[4], *behind[4], *cover = hf_at(&f->buf[HF_BUF_COVER], 0, r.x0, y);
        const float *blur = hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, y);
        const int cut = hf_area_inside(s, &l->level[0].taps, r.x0, y, r.x1 - r.x0, inside);
        hf_row(&f->buf[HF_BUF_NEAR], s->channels, r.x0, y, near);
        hf_row(&f->buf[HF_BUF_BEHIND], s->channels, r.x0, y, behind);
        for (int x = 0; x < r.x1 - r.x0; x += VF_N) {
            const vf m = area_hidden(blur + x, gain);
            const vm hides = vf_gt(m, vf_zero());
            if (!vm_any(hides))
                continue;
            for (int c = 0; c < s->channels; c++) {
                vf back = vf_load(behind[c] + x);
                if (cut)
                    back = vf_div(back, vf_load(inside + x));
                const vf v = vf_load(near[c] + x);
                vf_store(near[c] + x, vf_select(hides, vf_fma(m, vf_sub(back, v), v), v));
            }
            const vf v = vf_load(cover + x);
            vf_store(cover + x, vf_select(hides, vf_fma(m, vf_sub(one, v), v), v));
        }
        area_store_near(f, y, r);
    }
}

static void area_near_simple(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const struct hf_taps *t = &hf_gather_levels(s, HF_NEAR)->level[0].taps;
    struct gather_job near = {.reach = {t->rx, t->ry}, .clears = 1}, behind = {.planes = 0};
    for (int c = 0; c < s->channels; c++) {
        gather_plane(&near, f, r, HF_BUF_COLORNEAR4, c, HF_BUF_NEAR, c);
        gather_plane(&behind, f, r, HF_BUF_COLOR4, c, HF_BUF_BEHIND, c);
    }
    gather_plane(&near, f, r, HF_BUF_COC4, HF_AREA_NEAR, HF_BUF_COVER, 0);
    gather_run(f, r, t, &near, &f->buf[HF_BUF_COC4], HF_AREA_NEAR, NULL);
    gather_run(f, r, t, &behind, &f->buf[HF_BUF_BLUR], 0, NULL);
    area_finish_near(f, r);  // in place: once, not strip by strip, which may overlap
}

// A sum over its weight; alpha as a true quotient.
HF_INLINE vf area_mean(int c, vf sum, vf divisor, vf inverse)
{
    return c == 3 ? vf_div(sum, divisor) : vf_mul(sum, inverse);
}

// Pixels that are far, and their neighbours, which are upsampled with them.
HF_INLINE vm area_far_wanted(const float *part, ptrdiff_t stride)
{
    const vf own = vf_load(part);
    if (!vm_any(vm_not(vf_gt(own, vf_zero()))))
        return vf_gt(own, vf_zero());
    vf most = own;
    for (int y = -1; y <= 1; y++)
        for (int x = -1; x <= 1; x++)
            most = vf_max(vf_load(part + y * stride + x), most);
    return vf_gt(most, vf_zero());
}

static void area_finish_far(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    for (int y = r.y0; y < r.y1; y++) {
        float *far[4];
        const float *sum = hf_at(&f->buf[HF_BUF_SUM], 1, r.x0, y);
        const float *part = hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR, r.x0, y);
        hf_row(&f->buf[HF_BUF_FAR], s->channels, r.x0, y, far);
        for (int x = 0; x < r.x1 - r.x0; x += VF_N) {
            const vm wanted = area_far_wanted(part + x, f->buf[HF_BUF_COC4].stride);
            const vf divisor = vf_max(vf_load(sum + x), vf_set1(FLT_MIN)), inverse = vf_div(vf_set1(1), divisor);
            for (int c = 0; c < s->channels; c++)
                vf_store(
                    far[c] + x,
                    round_stored(s->storage, vf_keep(wanted, area_mean(c, vf_load(far[c] + x), divisor, inverse)), c));
        }
    }
}

// The neighbours of what is far are upsampled with it.
static void area_far_simple(const struct hf_frame *f, struct hf_rect r)
{
    struct gather_job j = {.reach = {1, 1}, .clears = 1};
    for (int c = 0; c < f->s->channels; c++)
        gather_plane(&j, f, r, HF_BUF_COLORFAR4, c, HF_BUF_FAR, c);
    gather_plane(&j, f, r, HF_BUF_COC4, HF_AREA_FAR, HF_BUF_SUM, 1);
    gather_run(f, r, &hf_gather_levels(f->s, HF_FAR)->level[0].taps, &j, &f->buf[HF_BUF_COC4], HF_AREA_FAR,
               area_finish_far);
}

// ---- levels ----

HF_INLINE vf area_reached(const struct hf_levels *l, int i, vf coc)
{
    if (i < 0)
        return vf_zero();
    if (i == l->count - 1)
        return vf_set1(1);
    return coc_saturate(vf_mul(vf_sub(coc, vf_set1(l->level[i + 1].coc)), vf_set1(l->level[i].to_next)));
}

HF_INLINE vf area_share(const struct hf_levels *l, int i, vf coc)
{
    return vf_mul(area_reached(l, i, coc), vf_sub(vf_set1(1), area_reached(l, i - 1, coc)));
}

HF_INLINE vf area_reach(const struct hf_levels *l, int i, vf coc)
{
    const vf least = vf_max(coc, vf_set1(l->level[l->count - 1].coc));
    return vf_min(vf_mul(least, vf_set1(l->level[i].inverse)), vf_set1(1));
}

static void area_weigh(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_reach reach = hf_gather_halo(f->s, HF_HALO_TAPS);
    const int x0 = r.x0 - reach.x, n = r.x1 + reach.x - x0;
    for (int y = r.y0 - reach.y; y < r.y1 + reach.y; y++) {
        float *colour[4], *out = hf_at(&f->buf[HF_BUF_WEIGHT], 0, x0, y);
        hf_row(&f->buf[HF_BUF_COLOR4], 3, x0, y, colour);
        for (int x = 0; x < n; x += VF_N) {
            vf luma = vf_mul(vf_set1(0.2126f), vf_load(colour[0] + x));
            luma = vf_fma(vf_set1(0.7152f), vf_load(colour[1] + x), luma);
            luma = vf_fma(vf_set1(0.0722f), vf_load(colour[2] + x), luma);
            vf_store(out + x, vf_div(vf_set1(1), vf_add(vf_set1(1), vf_max(luma, vf_zero()))));
        }
    }
}

enum area_kind { AREA_NEAR, AREA_BEHIND, AREA_FAR };

// Zeros of a row where it lies beyond the frame.
static void area_clear_beyond(const struct hf_setup *s, float *row, int x0, int x1, int y)
{
    const int beyond = y < 0 || y >= s->half_height;
    for (int x = x0; x < (beyond ? x1 : hf_min(x1, 0)); x++)
        row[x - x0] = 0;
    for (int x = hf_max(x0, s->half_width); x < x1; x++)
        row[x - x0] = 0;
}

HF_INLINE void area_level_row(const struct hf_frame *f, const struct hf_rect area, const int kind, int i, int y)
{
    const struct hf_setup *s = f->s;
    const struct hf_levels *l = hf_gather_levels(s, kind == AREA_FAR ? HF_FAR : HF_NEAR);
    const int x0 = area.x0, karis = hf_gather(s)->karis;
    const float *w = karis ? hf_at(&f->buf[HF_BUF_WEIGHT], 0, x0, y) : NULL;
    float *coc[4], *from[4], *near[4], *to[4], *weight[4];
    hf_row(&f->buf[HF_BUF_COC4], 4, x0, y, coc);
    hf_row(&f->buf[kind == AREA_NEAR     ? HF_BUF_COLORNEAR4
                   : kind == AREA_BEHIND ? HF_BUF_COLOR4
                                         : HF_BUF_COLORFAR4],
           s->channels, x0, y, from);
    hf_row(&f->buf[HF_BUF_COLORNEAR4], s->channels, x0, y, near);
    hf_row(&f->buf[HF_BUF_LEVEL], s->channels, x0, y, to);
    hf_row(&f->buf[HF_BUF_LEVEL_WEIGHT], 2, x0, y, weight);
    for (int x = 0; x < area.x1 - x0; x += VF_N) {
        vf share = vf_set1(1), part;
        if (kind == AREA_NEAR) {
            share = area_share(l, i, vf_load(coc[HF_AREA_NEAR_MOST] + x));
            part = vf_load(coc[HF_AREA_NEAR] + x);
        } else if (kind == AREA_FAR) {
            share = area_reach(l, i, vf_load(coc[HF_AREA_FAR_MOST] + x));
            part = vf_load(coc[HF_AREA_FAR] + x);
        } else {
            part = vf_sub(vf_set1(1), vf_load(coc[HF_AREA_NEAR] + x));
        }
        if (karis)
            vf_store(weight[1] + x, vf_mul(part, share));
        if (karis)
            share = vf_mul(share, vf_load(w + x));
        for (int c = 0; c < s->channels; c++) {
            vf v = vf_load(from[c] + x);
            if (kind == AREA_BEHIND)
                v = vf_sub(v, vf_load(near[c] + x));
            vf_store(to[c] + x, vf_mul(v, share));
        }
        vf_store(weight[0] + x, vf_mul(part, share));
    }
    for (int k = 0; k < 1 + karis && kind == AREA_BEHIND; k++)
        area_clear_beyond(s, weight[k], x0, area.x1, y);
}

static void area_level_planes(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, enum area_kind kind,
                              int i)
{
    const struct hf_rect area = {r.x0 - t->rx, r.y0 - t->ry, r.x1 + t->rx, r.y1 + t->ry};
    for (int y = area.y0; y < area.y1; y++)
        if (kind == AREA_NEAR)
            area_level_row(f, area, AREA_NEAR, i, y);
        else if (kind == AREA_BEHIND)
            area_level_row(f, area, AREA_BEHIND, i, y);
        else
            area_level_row(f, area, AREA_FAR, i, y);
}

// Convolved where a buffer says that there is need, within reach.
static void area_convolve_level(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t,
                                const struct hf_buf *need, int need_channel, struct hf_reach reach)
{
    struct gather_job j = {.reach = reach, .clears = 1};
    for (int c = 0; c < f->s->channels; c++)
        gather_plane(&j, f, r, HF_BUF_LEVEL, c, HF_BUF_LEVEL_SUM, c);
    for (int c = 0; c < 1 + hf_gather(f->s)->karis; c++)
        gather_plane(&j, f, r, HF_BUF_LEVEL_WEIGHT, c, HF_BUF_LEVEL_WEIGHT_SUM, c);
    gather_run(f, r, t, &j, need, need_channel, NULL);
}

// Rows of a field's sums: colour, its weight, and the weight without Karis'; without Karis average they are one, the last.
struct area_sums {
    float *colour[4], *weight[2];
};

static struct area_sums area_near_sums(const struct hf_frame *f, int x, int y)
{
    struct area_sums s = {.weight = {hf_at(&f->buf[HF_BUF_SUM], 0, x, y), hf_at(&f->buf[HF_BUF_COVER], 0, x, y)}};
    hf_row(&f->buf[HF_BUF_NEAR], f->s->channels, x, y, s.colour);
    return s;
}

static struct area_sums area_behind_sums(const struct hf_frame *f, int x, int y)
{
    const struct hf_buf *b = &f->buf[HF_BUF_BEHIND_WEIGHT];
    struct area_sums s = {.weight = {hf_at(b, 0, x, y), hf_at(b, 1, x, y)}};
    hf_row(&f->buf[HF_BUF_BEHIND], f->s->channels, x, y, s.colour);
    return s;
}

HF_INLINE void area_sum(float *to, const float *level, vf share, vm counts, int first)
{
    const vf sum = first ? vf_zero() : vf_load(to);
    vf_store(to, vf_select(counts, vf_fma(share, vf_load(level), sum), sum));
}

// Add share (1 where it is NULL) of a level's row to the sums.
static void area_add_row(const struct hf_frame *f, const struct area_sums *to, const float *share, int x0, int n, int y,
                         int first)
{
    const int karis = hf_gather(f->s)->karis;
    float *colour[4], *weight[4];
    hf_row(&f->buf[HF_BUF_LEVEL_SUM], f->s->channels, x0, y, colour);
    hf_row(&f->buf[HF_BUF_LEVEL_WEIGHT_SUM], 2, x0, y, weight);
    for (int x = 0; x < n; x += VF_N) {
        const vf part = share ? vf_load(share + x) : vf_set1(1);
        const vm counts = vf_gt(part, vf_zero());
        if (!first && !vm_any(counts))
            continue;
        for (int c = 0; c < f->s->channels; c++)
            area_sum(to->colour[c] + x, colour[c] + x, part, counts, first);
        area_sum(to->weight[1] + x, weight[karis] + x, part, counts, first);
        if (karis)
            area_sum(to->weight[0] + x, weight[0] + x, part, counts, first);
    }
}

// Shares of a level, as a buffer's row has CoC: 0 where there is none.
HF_INLINE void area_share_row(const struct hf_levels *l, int i, const float *coc, int n, const int any, float *share)
{
    for (int x = 0; x < n; x += VF_N) {
        const vf v = vf_load(coc + x), u = area_share(l, i, v);
        vf_store(share + x, any ? u : vf_keep(vf_gt(v, vf_zero()), u));
    }
}

HF_INLINE vf area_weighed(vf colour, const float *weight, vf counts, const int karis)
{
    if (!karis)
        return colour;
    const vf w = vf_load(weight);
    return vf_keep(vf_gt(w, vf_zero()), vf_mul(vf_div(colour, w), counts));
}

static void area_finish_row(const struct hf_frame *f, int x0, int n, int y)
{
    const vf gain = vf_set1(hf_gather_levels(f->s, HF_NEAR)->gain), one = vf_set1(1);
    const int karis = hf_gather(f->s)->karis;
    const struct area_sums near = area_near_sums(f, x0, y), behind = area_behind_sums(f, x0, y);
    const float *blur = hf_at(&f->buf[HF_BUF_BLUR], 0, x0, y);
    for (int x = 0; x < n; x += VF_N) {
        const vf m = area_hidden(blur + x, gain), cover = vf_load(near.weight[1] + x);
        const vf see = vf_load(behind.weight[1] + x), most = vf_max(cover, one), all = vf_add(cover, see);
        const vm hides = vf_gt(m, vf_zero());
        for (int c = 0; c < f->s->channels; c++) {
            const vf own = area_weighed(vf_load(near.colour[c] + x), near.weight[0] + x, cover, karis);
            const vf back = area_weighed(vf_load(behind.colour[c] + x), behind.weight[0] + x, see, karis);
            const vf outside = vf_div(own, most);
            const vf both = vf_fma(m, vf_sub(vf_div(vf_add(own, back), all), outside), outside);
            vf_store(near.colour[c] + x, vf_select(hides, both, outside));
        }
        const vf outside = vf_div(cover, most);
        vf_store(near.weight[1] + x, vf_select(hides, vf_fma(m, vf_sub(one, outside), outside), outside));
    }
}

static void area_near_levels(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_NEAR);
    const int n = r.x1 - r.x0;
    for (int i = 0; i < l->count; i++) {
        const struct hf_taps *t = &l->level[i].taps;
        area_level_planes(f, r, t, AREA_NEAR, i);
        area_convolve_level(f, r, t, &f->buf[HF_BUF_LEVEL_WEIGHT], 0, (struct hf_reach){t->rx, t->ry});
        for (int y = r.y0; y < r.y1; y++) {
            const struct area_sums sums = area_near_sums(f, r.x0, y);
            area_add_row(f, &sums, NULL, r.x0, n, y, i == 0);
        }
        area_level_planes(f, r, t, AREA_BEHIND, i);
        area_convolve_level(f, r, t, &f->buf[HF_BUF_BLUR], 0, (struct hf_reach){0, 0});
        for (int y = r.y0; y < r.y1; y++) {
            const struct area_sums sums = area_behind_sums(f, r.x0, y);
            area_share_row(l, i, hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, y), n, 0, hf_line(f, 0));
            area_add_row(f, &sums, hf_line(f, 0), r.x0, n, y, i == 0);
        }
    }
    for (int y = r.y0; y < r.y1; y++) {
        area_finish_row(f, r.x0, n, y);
        area_store_near(f, y, r);
    }
}

static void area_far_level_row(const struct hf_frame *f, int i, int x0, int n, int y)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_FAR);
    const float *coc = hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR_MOST, x0, y);
    const float *part = hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR, x0, y);
    float *far[4], *sum[4], *weight = hf_at(&f->buf[HF_BUF_LEVEL_WEIGHT_SUM], 0, x0, y);
    hf_row(&f->buf[HF_BUF_FAR], f->s->channels, x0, y, far);
    hf_row(&f->buf[HF_BUF_LEVEL_SUM], f->s->channels, x0, y, sum);
    for (int x = 0; x < n; x += VF_N) {
        const vf share = area_share(l, i, vf_load(coc + x));
        const vm counts = vf_gt(share, vf_zero());
        const vm wanted =
            i == l->count - 1 ? area_far_wanted(part + x, f->buf[HF_BUF_COC4].stride) : vf_eq(share, share);
        const vf divisor = vf_max(vf_load(weight + x), vf_set1(FLT_MIN)), inverse = vf_div(vf_set1(1), divisor);
        for (int c = 0; c < f->s->channels; c++) {
            const vf mean = area_mean(c, vf_load(sum[c] + x), divisor, inverse);
            const vf before = i ? vf_load(far[c] + x) : vf_zero();
            vf_store(far[c] + x, vf_keep(wanted, vf_select(counts, vf_fma(share, mean, before), before)));
        }
    }
}

static void area_far_levels(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_FAR);
    for (int i = 0; i < l->count; i++) {
        const struct hf_taps *t = &l->level[i].taps;
        area_level_planes(f, r, t, AREA_FAR, i);
        // A pixel that is not far itself, beside one that is, takes the smallest level.
        for (int y = r.y0; y < r.y1 && i < l->count - 1; y++)
            area_share_row(l, i, hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR_MOST, r.x0, y), r.x1 - r.x0, 1,
                           hf_at(&f->buf[HF_BUF_SUM], 1, r.x0, y));
        if (i < l->count - 1)
            area_convolve_level(f, r, t, &f->buf[HF_BUF_SUM], 1, (struct hf_reach){0, 0});
        else
            area_convolve_level(f, r, t, &f->buf[HF_BUF_COC4], HF_AREA_FAR, (struct hf_reach){1, 1});
        for (int y = r.y0; y < r.y1; y++)
            area_far_level_row(f, i, r.x0, r.x1 - r.x0, y);
    }
    for (int y = r.y0; y < r.y1; y++) {
        float *far[4];
        hf_row(&f->buf[HF_BUF_FAR], f->s->channels, r.x0, y, far);
        hf_store_rgb(f, far, r.x1 - r.x0);
    }
}

static void area_gather_simd(const struct hf_frame *f, struct hf_rect r)
{
    if (hf_gather(f->s)->karis)
        area_weigh(f, r);
    if (f->near && hf_gather_is_simple(f->s, HF_NEAR))
        area_near_simple(f, r);
    else if (f->near)
        area_near_levels(f, r);
    if (f->far && hf_gather_is_simple(f->s, HF_FAR))
        area_far_simple(f, r);
    else if (f->far)
        area_far_levels(f, r);
}
