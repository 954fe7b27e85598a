// SPDX-License-Identifier: BSD-3-Clause
// Downsample on vectors: rows come split into even and odd pixels, so a quad is four aligned loads.

HF_INLINE vf down_distance(vf a, vf b)
{
    return vf_fma(vf_set1(1000), vf_abs(vf_sub(a, b)), vf_set1(1));
}

HF_INLINE void down_row_simd(const struct hf_frame *f, const int channels, const int near, const int far, int y,
                             struct hf_rect r)
{
    const int n = r.x1 - r.x0, y1 = hf_min(2 * y + 1, f->s->height - 1);
    float *lane[2][2][4];  // [row][odd][channel]
    for (int i = 0; i < 16; i++)
        lane[i >> 3][i >> 2 & 1][i & 3] = hf_line(f, i);
    hf_read_colour(f, r.x0, 2 * y, n, lane[0][0], lane[0][1], f->seen);
    hf_read_colour(f, r.x0, y1, n, lane[1][0], lane[1][1], f->seen);

    const struct hf_buf *coc = &f->buf[HF_BUF_COC];
    const float *near_coc = hf_at(coc, 0, r.x0, 2 * y);
    const float *f00 = hf_at(coc, 2, r.x0, 2 * y), *f10 = hf_at(coc, 3, r.x0, 2 * y);
    const float *f01 = hf_at(coc, 2, r.x0, y1), *f11 = hf_at(coc, 3, r.x0, y1);
    float *colour[4], *colour_far[4], *coc4[4];
    hf_row(&f->buf[HF_BUF_COLOR4], channels, r.x0, y, colour);
    hf_row(&f->buf[HF_BUF_COLORFAR4], channels, r.x0, y, colour_far);
    hf_row(&f->buf[HF_BUF_COC4], 2, r.x0, y, coc4);
    for (int x = 0; x < n; x += VF_N) {
        if (near)
            vf_store(coc4[0] + x, vf_load(near_coc + x));
        const vf f0 = vf_load(f00 + x), g1 = vf_load(f10 + x), g2 = vf_load(f01 + x), g3 = vf_load(f11 + x);
        vf w0 = vf_set1(0.25f), w1 = w0, w2 = w0, w3 = w0;
        // Where the far CoC is the same all over, as it mostly is, so are the weights.
        if (far && vm_any(vm_or(vm_or(vf_ne(f0, g1), vf_ne(f0, g2)), vf_ne(f0, g3)))) {
            const vf d1 = down_distance(f0, g1), d2 = down_distance(f0, g2), d3 = down_distance(f0, g3);
            w0 = vf_mul(d1, vf_mul(d2, d3));
            w1 = vf_mul(d2, d3);
            w2 = vf_mul(d1, d3);
            w3 = vf_mul(d1, d2);
            const vf i = vf_div(vf_set1(1), vf_add(vf_add(w0, w1), vf_add(w2, w3)));
            w0 = vf_mul(w0, i);
            w1 = vf_mul(w1, i);
            w2 = vf_mul(w2, i);
            w3 = vf_mul(w3, i);
        }
        for (int c = 0; c < channels; c++) {
            const vf c00 = vf_load(lane[0][0][c] + x), c10 = vf_load(lane[0][1][c] + x);
            const vf c01 = vf_load(lane[1][0][c] + x), c11 = vf_load(lane[1][1][c] + x);
            if (near)
                vf_store(colour[c] + x, vf_mul(vf_set1(0.25f), vf_add(vf_add(c00, c10), vf_add(c01, c11))));
            if (!far)
                continue;
            const vf top = vf_fma(w1, c10, vf_mul(w0, c00)), bottom = vf_fma(w3, c11, vf_mul(w2, c01));
            vf_store(colour_far[c] + x, vf_mul(vf_add(top, bottom), f0));
        }
        if (far)
            vf_store(coc4[1] + x, f0);
    }
    if (near)
        hf_store_rgb(f, colour, n);
    if (far)
        hf_store_rgb(f, colour_far, n);
}

HF_INLINE void down_row_fields(const struct hf_frame *f, const int channels, int y, struct hf_rect r)
{
    if (f->near && f->far)
        down_row_simd(f, channels, 1, 1, y, r);
    else if (f->near)
        down_row_simd(f, channels, 1, 0, y, r);
    else
        down_row_simd(f, channels, 0, 1, y, r);
}

static void down_simd(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = r.y0; y < r.y1; y++) {
        if (f->s->channels == 3)
            down_row_fields(f, 3, y, r);
        else
            down_row_fields(f, 4, y, r);
    }
}
