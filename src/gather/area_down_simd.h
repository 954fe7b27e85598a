// SPDX-License-Identifier: BSD-3-Clause
// Downsample by area on vectors.
#include "gather/gather.h"
#include "pixel/coc_vf.h"

// Where a row of quads begins in the buffers: CoC in full resolution, of both fields; what is written.
struct area_row {
    const float *coc[2][4];
    float *colour[4], *part[2][4], *coc4[4];
    vf gain[2];
};

HF_INLINE struct area_row area_row_at(const struct hf_frame *f, const int channels, int x, int y)
{
    const int y1 = hf_min(2 * y + 1, f->s->height - 1);
    const struct hf_buf *b = &f->buf[HF_BUF_COC];
    struct area_row d;
    for (int i = 0; i < 2; i++) {
        d.coc[i][0] = hf_at(b, 2 * i, x, 2 * y);
        d.coc[i][1] = hf_at(b, 2 * i + 1, x, 2 * y);
        d.coc[i][2] = hf_at(b, 2 * i, x, y1);
        d.coc[i][3] = hf_at(b, 2 * i + 1, x, y1);
        d.gain[i] = vf_set1(hf_gather(f->s)->levels[i].gain);
    }
    hf_row(&f->buf[HF_BUF_COLOR4], channels, x, y, d.colour);
    hf_row(&f->buf[HF_BUF_COLORNEAR4], channels, x, y, d.part[0]);
    hf_row(&f->buf[HF_BUF_COLORFAR4], channels, x, y, d.part[1]);
    hf_row(&f->buf[HF_BUF_COC4], 4, x, y, d.coc4);
    return d;
}

struct area_quad {
    vf part[4], mean, most;
    vm differs;
    int any;  // differs
};

HF_INLINE struct area_quad area_quad_at(const struct area_row *d, const int field, int x)
{
    struct area_quad q;
    vf coc[4];
    for (int i = 0; i < 4; i++) {
        coc[i] = vf_load(d->coc[field][i] + x);
        q.part[i] = vf_min(vf_mul(d->gain[field], coc[i]), vf_set1(1));
    }
    q.most = vf_max(vf_max(coc[0], coc[1]), vf_max(coc[2], coc[3]));
    q.differs = vm_or(vm_or(vf_ne(q.part[0], q.part[1]), vf_ne(q.part[0], q.part[2])), vf_ne(q.part[0], q.part[3]));
    q.any = vm_any(q.differs);
    q.mean = q.part[0];
    if (q.any)
        q.mean = vf_select(q.differs, vf_mul(vf_set1(0.25f), down_sum(q.part)), q.part[0]);
    return q;
}

HF_INLINE vf area_part(const struct area_quad *q, const vf c[4], vf mean)
{
    const vf whole = vf_mul(mean, q->part[0]);
    if (!q->any)
        return whole;
    const vf top = vf_fma(q->part[1], c[1], vf_mul(q->part[0], c[0]));
    const vf bottom = vf_fma(q->part[3], c[3], vf_mul(q->part[2], c[2]));
    return vf_select(q->differs, vf_mul(vf_set1(0.25f), vf_add(top, bottom)), whole);
}

HF_INLINE void area_put_coc(enum hf_storage storage, const struct area_row *d, const struct area_quad *q,
                            const int field, int x, int stream)
{
    // Parts round as alpha does: where that is 1 it is their part.
    vf_put(d->coc4[field] + x, round_stored(storage, q->mean, 3), stream);
    vf_put(d->coc4[2 + field] + x, q->most, stream);
}

// A row of any format, by way of lines: the fields that are asked for.
HF_INLINE void area_row_lines(const struct hf_frame *f, const int channels, const int near, const int far, int x0,
                              int x1, int y)
{
    const int n = x1 - x0, y1 = hf_min(2 * y + 1, f->s->height - 1);
    float *lane[4][4];  // [row and even or odd][channel]
    for (int i = 0; i < 16; i++)
        lane[i >> 2][i & 3] = hf_line(f, i);
    hf_read_colour(f, x0, 2 * y, n, lane[0], lane[1], f->seen);
    hf_read_colour(f, x0, y1, n, lane[2], lane[3], f->seen);
    const struct area_row d = area_row_at(f, channels, x0, y);
    for (int x = 0; x < n; x += VF_N) {
        struct area_quad q[2];
        if (near)
            q[0] = area_quad_at(&d, 0, x);
        if (far)
            q[1] = area_quad_at(&d, 1, x);
        for (int c = 0; c < channels; c++) {
            const vf quad[4] = {vf_load(lane[0][c] + x), vf_load(lane[1][c] + x), vf_load(lane[2][c] + x),
                                vf_load(lane[3][c] + x)};
            const vf sum = vf_mul(vf_set1(0.25f), down_sum(quad)), mean = down_limited(sum);
            if (vm_any(vm_not(vf_le(vf_abs(sum), vf_set1(HF_LARGEST)))))
                f->counts->clamped += down_count(sum, n - x);
            if (near) {
                vf_store(d.colour[c] + x, mean);
                vf_store(d.part[0][c] + x, down_limited(area_part(&q[0], quad, mean)));
            }
            if (far)
                vf_store(d.part[1][c] + x, down_limited(area_part(&q[1], quad, mean)));
        }
        if (near)
            area_put_coc(f->s->storage, &d, &q[0], 0, x, 0);
        if (far)
            area_put_coc(f->s->storage, &d, &q[1], 1, x, 0);
    }
    if (near) {
        hf_store_rgb(f, d.colour, n);
        hf_store_rgb(f, d.part[0], n);
    }
    if (far)
        hf_store_rgb(f, d.part[1], n);
}

// A vector of quads of R11G11B10F, in registers. Returns the largest mean.
HF_INLINE vf area_block_r11(enum hf_storage storage, const struct area_row *d, const int near, const int far, int x,
                            const vi u[4], const int stream)
{
    vf quad[3][4], mean[3];
    down_unpack(u, quad);
    for (int c = 0; c < 3; c++) {
        mean[c] = vf_mul(down_sum(quad[c]), vf_set1(0x1p110f));
        if (near)
            vf_put(d->colour[c] + x, round_stored(storage, mean[c], c), stream);
    }
    for (int field = 0; field < 2; field++) {
        if (!(field ? far : near))
            continue;
        const struct area_quad q = area_quad_at(d, field, x);
        if (q.any) {
            for (int c = 0; c < 3; c++) {
                vf full[4];  // products want samples at full size
                for (int i = 0; i < 4; i++)
                    full[i] = vf_mul(quad[c][i], vf_set1(0x1p112f));
                vf_put(d->part[field][c] + x, round_stored(storage, area_part(&q, full, mean[c]), c), stream);
            }
        } else {
            for (int c = 0; c < 3; c++)
                vf_put(d->part[field][c] + x, round_stored(storage, vf_mul(mean[c], q.part[0]), c), stream);
        }
        area_put_coc(storage, d, &q, field, x, stream);
    }
    return vf_max(vf_max(mean[0], mean[1]), mean[2]);
}

// As down_row_r11.
HF_INLINE int area_row_r11(const struct hf_frame *f, const int near, const int far, int x0, int x1, int y, int stream)
{
    const struct hf_image *m = f->src;
    const uint8_t *p[2] = {plane_at(m, 0, 4, x0, 2 * y), plane_at(m, 0, 4, x0, hf_min(2 * y + 1, m->height - 1))};
    const struct area_row d = area_row_at(f, 3, x0, y);
    vf largest = vf_zero();
    for (int x = 0; x < x1 - x0; x += VF_N) {
        vi u[4];
        for (int row = 0; row < 2; row++) {
            const uint8_t *from = p[row] + 8 * x;
            vf even, odd;
            for (int k = 0; k < 8 * VF_N; k += 64)
                __builtin_prefetch((const uint8_t *)((uintptr_t)from + (uintptr_t)(2 * m->stride[0])) + k);
            vf_unzip(vf_load(from), vf_load(from + 4 * VF_N), &even, &odd);
            u[2 * row] = vf_as_vi(even);
            u[2 * row + 1] = vf_as_vi(odd);
        }
        const vf mean = stream ? area_block_r11(f->s->storage, &d, near, far, x, u, 1)
                               : area_block_r11(f->s->storage, &d, near, far, x, u, 0);
        largest = vf_max(largest, mean);
    }
    // One sample that is not finite makes 65536 / 4 at least.
    return !vm_any(vm_not(vf_lt(largest, vf_set1(16384))));
}

HF_INLINE void area_rows(const struct hf_frame *f, const int near, const int far, struct hf_rect r)
{
    const int stream = down_streams(f, r);
    for (int y = r.y0; y < r.y1; y++) {
        int x = r.x0;
        if (f->src->format == HF_FORMAT_R11G11B10F) {
            // Up to the last vector that lies in the picture as a whole.
            const int x1 = hf_min(r.x1, x + (f->s->width / 2 - x) / VF_N * VF_N);
            if (x < x1 && area_row_r11(f, near, far, x, x1, y, stream))
                x = x1;
        }
        if (x < r.x1 && f->s->channels == 3)
            area_row_lines(f, 3, near, far, x, r.x1, y);
        else if (x < r.x1)
            area_row_lines(f, 4, near, far, x, r.x1, y);
    }
    if (stream)
        vf_stream_end();
}

static void area_down_simd(const struct hf_frame *f, struct hf_rect r)
{
    if (f->near && f->far)
        area_rows(f, 1, 1, r);
    else if (f->near)
        area_rows(f, 1, 0, r);
    else
        area_rows(f, 0, 1, r);
}
