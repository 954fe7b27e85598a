// SPDX-License-Identifier: BSD-3-Clause
// Downsample on vectors.
#include "engine/chapter/chapter.h"
#include "engine/chapter/inverse_vf.h"
#include "pixel/down_vf.h"

// Where the rows of r begin in the buffers.
struct down_row {
    const float *near, *far[4];  // full-resolution CoC: near of a quad's first pixel, far of all
    float *colour[4], *colour_far[4], *coc[4];
};

HF_INLINE struct down_row down_row_at(const struct hf_frame *f, const int channels, int x, int y)
{
    const int y1 = hf_min(2 * y + 1, f->s->height - 1);
    const struct hf_buf *coc = &f->buf[HF_BUF_COC];
    struct down_row d = {
        .near = hf_at(coc, 0, x, 2 * y),
        .far = {hf_at(coc, 2, x, 2 * y), hf_at(coc, 3, x, 2 * y), hf_at(coc, 2, x, y1), hf_at(coc, 3, x, y1)}};
    hf_row(&f->buf[HF_BUF_COLOR4], channels, x, y, d.colour);
    hf_row(&f->buf[HF_BUF_COLORFAR4], channels, x, y, d.colour_far);
    hf_row(&f->buf[HF_BUF_COC4], 2, x, y, d.coc);
    return d;
}

HF_INLINE vf down_distance(vf a, vf b)
{
    return vf_fma(vf_set1(1000), vf_abs(vf_sub(a, b)), vf_set1(1));
}

// Are the quads' far CoCs not all the same? Mostly they are.
HF_INLINE int down_differ(const vf f[4])
{
    return vm_any(vm_or(vm_or(vf_ne(f[0], f[1]), vf_ne(f[0], f[2])), vf_ne(f[0], f[3])));
}

HF_INLINE void down_weights(enum hf_division division, const vf f[4], vf w[4])
{
    const vf d1 = down_distance(f[0], f[1]), d2 = down_distance(f[0], f[2]), d3 = down_distance(f[0], f[3]);
    w[0] = vf_mul(d1, vf_mul(d2, d3));
    w[1] = vf_mul(d2, d3);
    w[2] = vf_mul(d1, d3);
    w[3] = vf_mul(d1, d2);
    const vf i = inverse_vf(division, vf_add(vf_add(w[0], w[1]), vf_add(w[2], w[3])));
    for (int t = 0; t < 4; t++)
        w[t] = vf_mul(w[t], i);
    if (division == HF_DIVISION_EXACT)
        return;
    // An estimate of a quarter is not a quarter, and whether this is called depends on other lanes.
    const vm same = vm_and(vm_and(vf_eq(f[0], f[1]), vf_eq(f[0], f[2])), vf_eq(f[0], f[3]));
    for (int t = 0; t < 4; t++)
        w[t] = vf_select(same, vf_set1(0.25f), w[t]);
}

// alpha: over the sum of the weights, which is 1 within rounding.
HF_INLINE vf down_mean(const vf w[4], const vf c[4], const int alpha)
{
    const vf top = vf_fma(w[1], c[1], vf_mul(w[0], c[0])), bottom = vf_fma(w[3], c[3], vf_mul(w[2], c[2]));
    const vf mean = vf_add(top, bottom);
    return alpha ? vf_div(mean, down_sum(w)) : mean;
}

// A row of any format, by way of lines: the fields that are asked for.
HF_INLINE void down_row_lines(const struct hf_frame *f, const enum hf_downsample how, const enum hf_division division,
                              const int channels, const int near, const int far, int x0, int x1, int y)
{
    const int n = x1 - x0;
    const struct down_lines l = down_read(f, x0, y, n);
    const struct down_row d = down_row_at(f, channels, x0, y);
    for (int x = 0; x < n; x += VF_N) {
        const vf g[4] = {vf_load(d.far[0] + x), vf_load(d.far[1] + x), vf_load(d.far[2] + x), vf_load(d.far[3] + x)};
        vf w[4] = {vf_set1(0.25f), vf_set1(0.25f), vf_set1(0.25f), vf_set1(0.25f)};
        if (how == HF_DOWNSAMPLE_POINT) {
            w[0] = vf_set1(1);
            w[1] = w[2] = w[3] = vf_zero();
        } else if (far && how == HF_DOWNSAMPLE_BILATERAL && down_differ(g)) {
            down_weights(division, g, w);
        }
        for (int c = 0; c < channels; c++) {
            vf quad[4];
            const vf sum = down_quads(f, &l, c, x, n, HF_LARGEST, quad);
            if (near)
                vf_store(d.colour[c] + x, down_limited(how == HF_DOWNSAMPLE_POINT ? quad[0] : sum, HF_LARGEST));
            // Limited before the CoC makes it small, by which the gather divides again.
            if (far)
                vf_store(d.colour_far[c] + x, vf_mul(down_limited(down_mean(w, quad, c == 3), HF_LARGEST), g[0]));
        }
        if (near)
            vf_store(d.coc[0] + x, vf_load(d.near + x));
        if (far)
            vf_store(d.coc[1] + x, g[0]);
    }
    if (near)
        hf_store_rgb(f, d.colour, n);
    if (far)
        hf_store_rgb(f, d.colour_far, n);
}

// Downsample VF_N quads of R11G11B10F pixels without a buffer. u: the packed pixels, as down_unpack takes them. x: the
// first quad, counted from the beginning of the row. Returns the largest mean.
HF_INLINE vf down_block_r11(enum hf_storage storage, const struct down_row *d, const int near, const int far, int x,
                            const vi u[4], const int stream)
{
    const vf g[4] = {vf_load(d->far[0] + x), vf_load(d->far[1] + x), vf_load(d->far[2] + x), vf_load(d->far[3] + x)};
    vf quad[3][4], mean[3];
    down_unpack(u, quad);
    for (int c = 0; c < 3; c++) {
        mean[c] = vf_mul(down_sum(quad[c]), vf_set1(0x1p110f));
        if (near)
            vf_put(d->colour[c] + x, round_stored(storage, mean[c], c), stream);
    }
    if (far && down_differ(g)) {
        vf w[4];
        down_weights(HF_DIVISION_EXACT, g, w);
        for (int c = 0; c < 3; c++) {
            for (int i = 0; i < 4; i++)
                quad[c][i] = vf_mul(quad[c][i], vf_set1(0x1p112f));
            vf_put(d->colour_far[c] + x, round_stored(storage, vf_mul(down_mean(w, quad[c], 0), g[0]), c), stream);
        }
    } else if (far) {  // quarters of small floats are exact, so that their sum is the mean
        for (int c = 0; c < 3; c++)
            vf_put(d->colour_far[c] + x, round_stored(storage, vf_mul(mean[c], g[0]), c), stream);
    }
    if (near)
        vf_put(d->coc[0] + x, vf_load(d->near + x), stream);
    if (far)
        vf_put(d->coc[1] + x, g[0], stream);
    return vf_max(vf_max(mean[0], mean[1]), mean[2]);
}

// A row of R11G11B10F. Returns 0 if there may be a sample that is not finite: then nothing of this row counts. The
// frame's border is read at once, to be repeated outwards: it is not streamed.
HF_INLINE int down_row_r11(const struct hf_frame *f, const enum hf_storage storage, const int near, const int far,
                           int x0, int x1, int y, int stream)
{
    const int last = f->s->half_width - VF_N, inner_row = stream && y > 0 && y < f->s->half_height - 1;
    const struct hf_image *m = f->src;
    const uint8_t *p[2];
    down_words(m, x0, y, p);
    const struct down_row d = down_row_at(f, 3, x0, y);
    vf largest = vf_zero();
    for (int x = 0; x < x1 - x0; x += VF_N) {
        vi u[4];
        down_load(m, p, x, u);
        const int inner = inner_row && x0 + x > 0 && x0 + x < last;
        const vf mean =
            inner ? down_block_r11(storage, &d, near, far, x, u, 1) : down_block_r11(storage, &d, near, far, x, u, 0);
        largest = vf_max(largest, mean);
    }
    return down_is_finite(largest);
}

HF_INLINE void down_rows(const struct hf_frame *f, const int near, const int far, struct hf_rect r)
{
    const int stream = down_streams(f, r), channels = f->s->channels;
    const enum hf_downsample how = hf_chapter(f->s)->downsample;
    const enum hf_division division = hf_chapter(f->s)->division;
    const int usual = how == HF_DOWNSAMPLE_BILATERAL && division == HF_DIVISION_EXACT;
    const int words = usual && f->src->format == HF_FORMAT_R11G11B10F && !f->s->highlight.on;
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        int x = r.x0;
        if (words) {
            const int x1 = down_words_end(f, r);
            if (x < x1 &&
                (f->s->storage == HF_STORAGE_FLOAT ? down_row_r11(f, HF_STORAGE_FLOAT, near, far, x, x1, y, stream)
                                                   : down_row_r11(f, f->s->storage, near, far, x, x1, y, stream)))
                x = x1;
        }
        if (x >= r.x1)
            continue;
        if (!usual)
            down_row_lines(f, how, division, channels, near, far, x, r.x1, y);
        else if (channels == 3)
            down_row_lines(f, HF_DOWNSAMPLE_BILATERAL, HF_DIVISION_EXACT, 3, near, far, x, r.x1, y);
        else
            down_row_lines(f, HF_DOWNSAMPLE_BILATERAL, HF_DIVISION_EXACT, 4, near, far, x, r.x1, y);
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
