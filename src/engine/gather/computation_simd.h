// SPDX-License-Identifier: BSD-3-Clause
// Computation on vectors, with one kernel for a field; more of them are levels_simd.h's.
#include <float.h>

#include "engine/gather/part_vf.h"
#include "pixel/coc_vf.h"
#include "pixel/convolve_simd.h"

// Discs of a radius of 4, 6 and 8: 12 pixels of a picture of 1080 lines, and the same at 720 and 1440. And those of near levels
// (near_radii in engine.c), in steps of theirs: 1, 2, the root of 8, 4, the root of 32 and 8. With a step of 4 the weights are
// rounded to larger units, and two of a disc of 8 to 0.
// clang-format off
static const uint16_t disc_1[] = {0x03, 0x03};
static const uint16_t disc_2[] = {RUN(1) | 0x04, 0x07, 0x03};
static const uint16_t disc_root_8[] = {RUN(2) | 0x08, RUN(1) | 0x0c, 0x07, 0x03};
static const uint16_t disc_4[] = {RUN(3) | 0x10, RUN(3) | 0x10, RUN(2) | 0x18, RUN(1) | 0x0c, 0x07};
static const uint16_t disc_root_32[] = {RUN(5) | 0x40, RUN(4) | 0x60, RUN(4) | 0x20, RUN(3) | 0x30,
                                        RUN(2) | 0x18, 0x0f, 0x03};
static const uint16_t disc_6[] = {RUN(5) | 0x40, RUN(5) | 0x40, RUN(4) | 0x60, RUN(4) | 0x20,
                                  RUN(3) | 0x30, RUN(1) | 0x1c, 0x07};
static const uint16_t disc_8[] = {RUN(7) | 0x100, RUN(7) | 0x100, RUN(7) | 0x100,
                                  RUN(6) | 0x180, RUN(6) | 0x080, RUN(5) | 0x0c0,
                                  RUN(4) | 0x060, RUN(2) | 0x038, 0x0f};
static const uint16_t disc_8_rounded[] = {RUN(7) | 0x100, RUN(7) | 0x100, RUN(7) | 0x100,
                                          RUN(6) | 0x180, RUN(6) | 0x080, RUN(5) | 0x040,
                                          RUN(4) | 0x060, RUN(2) | 0x018, 0x0f};
// clang-format on
FIXED_COLUMN(one_1, disc_1, 1, 1, NULL)
FIXED_COLUMN(one_2, disc_2, 2, 1, NULL)
FIXED_COLUMN(one_4, disc_4, 4, 1, NULL)
FIXED_COLUMN(one_6, disc_6, 6, 1, NULL)
FIXED_COLUMN(one_8, disc_8, 8, 1, NULL)
FIXED_COLUMN(any_root_8, disc_root_8, 3, 1, &step)
FIXED_COLUMN(any_4, disc_4, 4, 1, &step)
FIXED_COLUMN(any_root_32, disc_root_32, 6, 1, &step)
FIXED_COLUMN(any_8, disc_8, 8, 1, &step)
FIXED_COLUMN(any_8_rounded, disc_8_rounded, 8, 1, &step)

// The column of such a disc, or NULL.
static fixed_column *area_column(const struct hf_taps *t)
{
    static const struct {
        const uint16_t *rows;
        int r;
        fixed_column *one, *any;  // with a step of 1, and with another
    } discs[] = {
        {disc_1, 1, one_1_column, NULL},
        {disc_2, 2, one_2_column, NULL},
        {disc_root_8, 3, any_root_8_column, any_root_8_column},
        {disc_4, 4, one_4_column, any_4_column},
        {disc_root_32, 6, any_root_32_column, any_root_32_column},
        {disc_6, 6, one_6_column, NULL},
        {disc_8, 8, one_8_column, any_8_column},
        {disc_8_rounded, 8, any_8_rounded_column, any_8_rounded_column},
    };
    for (size_t i = 0; i < sizeof discs / sizeof *discs; i++)
        if (fixed_are(t, discs[i].rows, discs[i].r, 1))
            return t->step == 1 ? discs[i].one : discs[i].any;
    return NULL;
}

// Sums that are used up strip by strip: a strip's rows, on lines that lie an odd number of cache lines apart, at the
// beginning of f->work.
static float *strip_plane(const struct hf_frame *f, int i, int height)
{
    return f->work + (ptrdiff_t)i * height * HF_STRIP;
}

static void convolve_to_strip(struct convolve_job *j, const struct hf_frame *f, struct hf_rect r, int in, int c_in,
                              int plane)
{
    const int i = j->planes++;
    j->stop = f->s->stop;
    j->in[i] = hf_at(&f->buf[in], c_in, r.x0, r.y0);
    j->in_stride[i] = f->buf[in].stride;
    j->out[i] = strip_plane(f, plane, r.y1 - r.y0);
    j->out_stride[i] = HF_STRIP;
    j->of_strip[i] = 1;
}

// Behind the strip's own sums there is room for what the convolution needs.
static void area_convolve(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t,
                          const struct convolve_job *jobs, int count, hf_kernel *finish)
{
    convolve_jobs(f, r, t, area_column(t), strip_plane(f, HF_STRIP_PLANES, r.y1 - r.y0), jobs, count, finish);
}

HF_INLINE vf area_hidden(const struct hf_levels *l, const float *blur)
{
    return level_part(l->curve, vf_set1(l->hides), vf_load(blur));
}

static void area_store_near(const struct hf_frame *f, int y, struct hf_rect r)
{
    float *near[4];
    hf_row(&f->buf[HF_BUF_NEAR], f->s->channels, r.x0, y, near);
    hf_store_rgb(f, near, r.x1 - r.x0);
    if (f->s->storage == HF_STORAGE_HALF)
        f->k->round_half(hf_at(&f->buf[HF_BUF_COVER], 0, r.x0, y), r.x1 - r.x0);
}

// Sums of a strip: of what near pixels hide, by channel; and of the far field's weights.
enum { AREA_BEHIND_SUM, AREA_FAR_SUM = 4 };

// What near pixels hide, under the near field.
static void area_finish_near(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const struct hf_levels *l = hf_gather_levels(s, HF_NEAR);
    const vf one = vf_set1(1);
    const struct hf_area_kernel *k = &l->level[0].kernel;
    const int height = r.y1 - r.y0;
    float *inside = hf_line(f, 0);
    int cut = 0;
    for (int y = r.y0; y < r.y1; y++) {
        float *near[4], *cover = hf_at(&f->buf[HF_BUF_COVER], 0, r.x0, y);
        const float *blur = hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, y);
        const float *behind = strip_plane(f, AREA_BEHIND_SUM, height) + (y - r.y0) * HF_STRIP;
        if (y == r.y0 || !hf_area_is_whole(s, &k->taps, y) || !hf_area_is_whole(s, &k->taps, y - 1))
            cut = hf_area_inside(s, k, r.x0, y, r.x1 - r.x0, inside);
        hf_row(&f->buf[HF_BUF_NEAR], s->channels, r.x0, y, near);
        for (int x = 0; x < r.x1 - r.x0; x += VF_N) {
            const vf m = area_hidden(l, blur + x);
            const vm hides = vf_gt(m, vf_zero()), wholly = vf_eq(m, one);
            const int is_cut = cut && vm_any(vf_lt(vf_load(inside + x), one));
            if (!is_cut && !vm_any(hides))
                continue;
            for (int c = 0; c < s->channels; c++) {
                vf back = vf_load(behind + (ptrdiff_t)c * height * HF_STRIP + x), v = vf_load(near[c] + x);
                if (is_cut) {
                    back = vf_div(back, vf_load(inside + x));
                    v = vf_div(v, vf_load(inside + x));
                }
                const vf both = vf_select(wholly, back, vf_fma(m, vf_sub(back, v), v));
                vf_store(near[c] + x, vf_select(hides, both, v));
            }
            vf v = vf_load(cover + x);
            if (is_cut)
                v = vf_div(v, vf_load(inside + x));
            const vf both = vf_select(wholly, one, vf_fma(m, vf_sub(one, v), v));
            vf_store(cover + x, vf_select(hides, both, v));
        }
        area_store_near(f, y, r);
    }
}

static void area_near_simple(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const struct hf_levels *l = hf_gather_levels(s, HF_NEAR);
    const struct hf_area_kernel *k = &l->level[0].kernel;
    struct convolve_job jobs[2] = {{.reach = {k->taps.rx, k->taps.ry},
                                    .clears = 1,
                                    .full = hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, r.y0),
                                    .full_stride = f->buf[HF_BUF_BLUR].stride,
                                    .gain = l->hides},
                                   {.planes = 0}};
    for (int c = 0; c < s->channels; c++) {
        convolve_plane(&jobs[0], f, r, HF_BUF_COLORNEAR4, c, HF_BUF_NEAR, c);
        convolve_to_strip(&jobs[1], f, r, HF_BUF_COLOR4, c, AREA_BEHIND_SUM + c);
    }
    convolve_plane(&jobs[0], f, r, HF_BUF_COC4, HF_AREA_NEAR, HF_BUF_COVER, 0);
    job_needs(&jobs[0], f, r, HF_BUF_COC4, HF_AREA_NEAR);
    job_needs(&jobs[1], f, r, HF_BUF_BLUR, 0);
    area_convolve(f, r, &k->taps, jobs, 2, area_finish_near);
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

// What is near beside something far is no less out of focus.
static void area_far_part_row(const struct hf_frame *f, int x0, int n, int y)
{
    const float *far = hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR, x0, y);
    const float *near = hf_at(&f->buf[HF_BUF_COC4], HF_AREA_NEAR, x0, y);
    float *part = hf_at(&f->buf[HF_BUF_FAR_PART], 0, x0, y);
    for (int x = 0; x < n; x += VF_N)
        vf_store(part + x, f->near ? vf_add(vf_load(far + x), vf_load(near + x)) : vf_load(far + x));
}

static void area_finish_far(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    for (int y = r.y0; y < r.y1; y++) {
        float *far[4];
        const float *sum = strip_plane(f, AREA_FAR_SUM, r.y1 - r.y0) + (y - r.y0) * HF_STRIP;
        const float *part = hf_at(&f->buf[HF_BUF_COC4], HF_AREA_FAR, r.x0, y);
        hf_row(&f->buf[HF_BUF_FAR], s->channels, r.x0, y, far);
        area_far_part_row(f, r.x0, r.x1 - r.x0, y);
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
    struct convolve_job j = {.reach = {1, 1}, .clears = 1};
    for (int c = 0; c < f->s->channels; c++)
        convolve_plane(&j, f, r, HF_BUF_COLORFAR4, c, HF_BUF_FAR, c);
    convolve_to_strip(&j, f, r, HF_BUF_COC4, HF_AREA_FAR, AREA_FAR_SUM);
    job_needs(&j, f, r, HF_BUF_COC4, HF_AREA_FAR);
    area_convolve(f, r, &hf_gather_levels(f->s, HF_FAR)->level[0].kernel.taps, &j, 1, area_finish_far);
}
