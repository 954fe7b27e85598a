// SPDX-License-Identifier: BSD-3-Clause
// Downsample on vectors.
#include <float.h>

#include "engine/gather/part_vf.h"
#include "pixel/down_vf.h"

// Where a row of quads begins in the buffers: CoC in full resolution, of both fields; what is written.
struct down_row {
    const float *coc[2][4];
    float *colour[4], *part[2][4], *coc4[4];
    vf gain[2];
    struct hf_part_curve curve[2];
    int of_light;  // the far CoC of light is wanted
};

HF_INLINE struct down_row down_row_at(const struct hf_frame *f, const int channels, int x, int y)
{
    const int y1 = hf_min(2 * y + 1, f->s->height - 1);
    const struct hf_buf *b = &f->buf[HF_BUF_COC];
    struct down_row d;
    for (int i = 0; i < 2; i++) {
        d.coc[i][0] = hf_at(b, 2 * i, x, 2 * y);
        d.coc[i][1] = hf_at(b, 2 * i + 1, x, 2 * y);
        d.coc[i][2] = hf_at(b, 2 * i, x, y1);
        d.coc[i][3] = hf_at(b, 2 * i + 1, x, y1);
        d.gain[i] = vf_set1(hf_gather(f->s)->levels[i].gain);
        d.curve[i] = hf_gather(f->s)->levels[i].curve;
    }
    hf_row(&f->buf[HF_BUF_COLOR4], channels, x, y, d.colour);
    hf_row(&f->buf[HF_BUF_COLORNEAR4], channels, x, y, d.part[0]);
    hf_row(&f->buf[HF_BUF_COLORFAR4], channels, x, y, d.part[1]);
    hf_row(&f->buf[HF_BUF_COC4], 4, x, y, d.coc4);
    d.of_light = !hf_gather_is_simple(f->s);
    return d;
}

struct quad {
    vf coc[4], part[4], mean;
};

// unit: a part is the CoC.
HF_INLINE struct quad down_quad_at(const struct down_row *d, const int unit, const int field, int x)
{
    struct quad q;
    for (int i = 0; i < 4; i++) {
        q.coc[i] = vf_load(d->coc[field][i] + x);
        q.part[i] = unit ? q.coc[i] : level_part(d->curve[field], d->gain[field], q.coc[i]);
    }
    q.mean = vf_mul(vf_set1(0.25f), down_sum(q.part));
    return q;
}

// As coc_of_light in down.c.
HF_INLINE vf down_coc_of_light(const struct quad *q, const vf light[4])
{
    const vf *coc = q->coc, least = vf_min(vf_min(coc[0], coc[1]), vf_min(coc[2], coc[3]));
    vf weight[4], beyond[4];
    for (int i = 0; i < 4; i++) {
        weight[i] = vf_mul(q->part[i], vf_min(vf_max(light[i], vf_set1(HF_OF_LIGHT_LEAST)), vf_set1(HF_AREA_LARGEST)));
        beyond[i] = vf_mul(weight[i], vf_sub(coc[i], least));
    }
    return vf_add(least, vf_div(down_sum(beyond), vf_max(down_sum(weight), vf_set1(FLT_MIN))));
}

// Not fused: from right to left, or upwards, it is the same.
HF_INLINE vf down_part(const vf part[4], const vf c[4])
{
    const vf top = vf_add(vf_mul(part[0], c[0]), vf_mul(part[1], c[1]));
    const vf bottom = vf_add(vf_mul(part[2], c[2]), vf_mul(part[3], c[3]));
    return vf_mul(vf_set1(0.25f), vf_add(top, bottom));
}

// In proportion to the mean part, by which the field is divided again.
HF_INLINE vf quad_limited(const struct quad *q, vf v)
{
    v = vf_max(v, vf_mul(vf_set1(-HF_AREA_LARGEST), q->mean));
    return vf_min(v, vf_mul(vf_set1(HF_AREA_LARGEST), q->mean));
}

HF_INLINE void down_put_coc(enum hf_storage storage, const struct down_row *d, const struct quad *q, const int field,
                            int x, int stream)
{
    // Parts round as alpha does: where that is 1 it is their part.
    vf_put(d->coc4[field] + x, round_stored(storage, q->mean, 3), stream);
    if (field == 0)
        vf_put(d->coc4[HF_AREA_NEAR_MOST] + x, vf_max(vf_max(q->coc[0], q->coc[1]), vf_max(q->coc[2], q->coc[3])),
               stream);
}

// A row of any format, by way of lines: the fields that are asked for.
HF_INLINE void down_row_lines(const struct hf_frame *f, const int channels, const int near, const int far, int x0,
                              int x1, int y)
{
    const int n = x1 - x0;
    const struct down_lines l = down_read(f, x0, y, n);
    const struct down_row d = down_row_at(f, channels, x0, y);
    for (int x = 0; x < n; x += VF_N) {
        struct quad q[2];
        if (near)
            q[0] = down_quad_at(&d, 0, 0, x);
        if (far)
            q[1] = down_quad_at(&d, 0, 1, x);
        vf light[4] = {vf_zero(), vf_zero(), vf_zero(), vf_zero()};
        for (int c = 0; c < channels; c++) {
            vf quad[4];
            const vf mean = down_limited(down_quads(f, &l, c, x, n, HF_AREA_LARGEST, quad), HF_AREA_LARGEST);
            if (near) {
                vf_store(d.colour[c] + x, mean);
                vf_store(d.part[0][c] + x, quad_limited(&q[0], down_part(q[0].part, quad)));
            }
            for (int i = 0; i < 4 && far && d.of_light && c < 3; i++)
                light[i] = vf_max(light[i], quad[i]);
            if (far)
                vf_store(d.part[1][c] + x, quad_limited(&q[1], down_part(q[1].part, quad)));
        }
        if (near)
            down_put_coc(f->s->storage, &d, &q[0], 0, x, 0);
        if (far)
            down_put_coc(f->s->storage, &d, &q[1], 1, x, 0);
        if (far && d.of_light)
            vf_store(d.coc4[HF_AREA_FAR_OF_LIGHT] + x, down_coc_of_light(&q[1], light));
    }
    if (near) {
        hf_store_rgb(f, d.colour, n);
        hf_store_rgb(f, d.part[0], n);
    }
    if (far)
        hf_store_rgb(f, d.part[1], n);
}

// CoC and colour of a vector of quads that has nothing of a field, or that belongs to it wholly.
HF_INLINE void down_put_same(const struct down_row *d, const int field, int x, vf coc, const vf colour[3],
                             const int stream)
{
    vf_put(d->coc4[field] + x, coc, stream);
    if (field == 0)
        vf_put(d->coc4[HF_AREA_NEAR_MOST] + x, coc, stream);
    else if (d->of_light)
        vf_put(d->coc4[HF_AREA_FAR_OF_LIGHT] + x, coc, stream);
    for (int c = 0; c < 3; c++)
        vf_put(d->part[field][c] + x, colour[c], stream);
}

// Most vectors of quads have nothing of one of the two fields, and many belong to the other wholly, whose mean is then that of the
// colour.
HF_INLINE int down_is_same(const struct down_row *d, const int unit, const int field, int x, const vf mean[3],
                           const int stream)
{
    const vf one = vf_set1(1), none[3] = {vf_zero(), vf_zero(), vf_zero()};
    vi bits[4];
    for (int i = 0; i < 4; i++)
        bits[i] = vf_as_vi(vf_load(d->coc[field][i] + x));
    if (!vi_any(vi_or(vi_or(bits[0], bits[1]), vi_or(bits[2], bits[3])))) {
        down_put_same(d, field, x, vf_zero(), none, stream);
        return 1;
    }
    // No number below 1 has all bits of 1.
    const vi shared = vi_and(vi_and(bits[0], bits[1]), vi_and(bits[2], bits[3]));
    if (!unit || vi_any(vi_xor(shared, vf_as_vi(one))))
        return 0;
    down_put_same(d, field, x, one, mean, stream);
    return 1;
}

// A vector of quads of R11G11B10F, in registers. Returns the largest mean.
HF_INLINE vf down_block_r11(const enum hf_storage storage, const struct down_row *d, const int near, const int far,
                            const int unit, int x, const vi u[4], const int stream)
{
    vf quad[3][4], mean[3], stored[3];
    down_unpack(u, quad);
    for (int c = 0; c < 3; c++) {
        mean[c] = vf_mul(down_sum(quad[c]), vf_set1(0x1p110f));
        stored[c] = round_stored(storage, mean[c], c);
        if (near)
            vf_put(d->colour[c] + x, stored[c], stream);
    }
    HF_UNROLL(2)
    for (int field = 0; field < 2; field++) {
        if (!(field ? far : near) || down_is_same(d, unit, field, x, stored, stream))
            continue;
        struct quad q = down_quad_at(d, unit, field, x);
        down_put_coc(storage, d, &q, field, x, stream);
        if (field && d->of_light) {
            vf light[4];
            for (int i = 0; i < 4; i++)
                light[i] = vf_mul(vf_max(vf_max(quad[0][i], quad[1][i]), quad[2][i]), vf_set1(0x1p112f));
            vf_put(d->coc4[HF_AREA_FAR_OF_LIGHT] + x, down_coc_of_light(&q, light), stream);
        }
        for (int i = 0; i < 4; i++)  // products are those with samples at full size
            q.part[i] = vf_mul(q.part[i], vf_set1(0x1p112f));
        // No sample exceeds the limit. But the mean of the smallest denormal parts is 0, and then so is what it will divide.
        const vm some = vf_gt(q.mean, vf_zero());
        for (int c = 0; c < 3; c++)
            vf_put(d->part[field][c] + x, round_stored(storage, vf_keep(some, down_part(q.part, quad[c])), c), stream);
    }
    return vf_max(vf_max(mean[0], mean[1]), mean[2]);
}

// A row of R11G11B10F. Returns 0 if there may be a sample that is not finite: then nothing of this row counts.
HF_INLINE int down_row_r11(const struct hf_frame *f, const enum hf_storage storage, const int near, const int far,
                           const int unit, int x0, int x1, int y, int stream)
{
    const struct hf_image *m = f->src;
    const uint8_t *p[2];
    down_words(m, x0, y, p);
    const struct down_row d = down_row_at(f, 3, x0, y);
    vf largest = vf_zero();
    for (int x = 0; x < x1 - x0; x += VF_N) {
        vi u[4];
        down_load(m, p, x, u);
        const vf mean = stream ? down_block_r11(storage, &d, near, far, unit, x, u, 1)
                               : down_block_r11(storage, &d, near, far, unit, x, u, 0);
        largest = vf_max(largest, mean);
    }
    return down_is_finite(largest);
}

// The usual case: parts are CoCs, and floats.
static int down_is_unit(const struct hf_frame *f)
{
    const struct hf_levels *near = hf_gather_levels(f->s, HF_NEAR), *far = hf_gather_levels(f->s, HF_FAR);
    return f->s->storage == HF_STORAGE_FLOAT && near->gain == 1 && near->curve.linear == 1 && far->gain == 1 &&
           far->curve.linear == 1;
}

HF_INLINE void down_rows(const struct hf_frame *f, const int near, const int far, struct hf_rect r)
{
    const int stream = down_streams(f, r);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        int x = r.x0;
        if (f->src->format == HF_FORMAT_R11G11B10F && !f->s->highlight.on) {
            const int x1 = down_words_end(f, r);
            if (x < x1 && (down_is_unit(f) ? down_row_r11(f, HF_STORAGE_FLOAT, near, far, 1, x, x1, y, stream)
                                           : down_row_r11(f, f->s->storage, near, far, 0, x, x1, y, stream)))
                x = x1;
        }
        if (x < r.x1 && f->s->channels == 3)
            down_row_lines(f, 3, near, far, x, r.x1, y);
        else if (x < r.x1)
            down_row_lines(f, 4, near, far, x, r.x1, y);
    }
    if (stream)
        vf_stream_end();
}

static void down_simd(const struct hf_frame *f, struct hf_rect r)
{
    if (f->near && f->far)
        down_rows(f, 1, 1, r);
    else if (f->near)
        down_rows(f, 1, 0, r);
    else
        down_rows(f, 0, 1, r);
}
