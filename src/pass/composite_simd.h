// SPDX-License-Identifier: BSD-3-Clause
// Composite on vectors. Even and odd pixels are lanes of their own, so the four phases of the upsampling are four
// pieces of plain arithmetic over the same half-resolution loads. The near field is interpolated in y once for both
// phases in x.

struct far_row {
    const float *colour[2][4];  // [own, neighbour row][channel], at lane 0
    const float *coc[2];
};

// d[1] of four weights in proportion to b / d, each d = 1 + 1000 |CoC difference|.
HF_INLINE void weights_of(const vf d[4], vf w[4])
{
    const vf p01 = vf_mul(d[0], d[1]), p23 = vf_mul(d[2], d[3]);
    w[0] = vf_mul(d[1], p23);
    w[1] = vf_mul(d[0], p23);
    w[2] = vf_mul(d[3], p01);
    w[3] = vf_mul(d[2], p01);
}

HF_INLINE void normalise(vf w[4], vf sum)
{
    const vf i = vf_div(vf_set1(1), sum);
    for (int t = 0; t < 4; t++)
        w[t] = vf_mul(w[t], i);
}

// side: -1 for even pixels, 1 for odd ones.
HF_INLINE void blend_far_block(const struct far_row *far, const int channels, const int side, int x, vf coc, vf blend,
                               vf colour[4])
{
    static const float bilinear[4] = {9, 3, 3, 1};
    vf d[4], w[4];
    vm is_far[4];
    for (int i = 0; i < 4; i++) {
        const vf g = vf_load(far->coc[i >> 1] + x + (i & 1 ? side : 0));
        d[i] = vf_fma(vf_set1(1000), vf_abs(vf_sub(coc, g)), vf_set1(1));
        is_far[i] = vf_gt(g, vf_zero());
    }
    weights_of(d, w);
    for (int i = 0; i < 4; i++)
        w[i] = vf_keep(is_far[i], i < 3 ? vf_mul(vf_set1(bilinear[i]), w[i]) : w[i]);
    const vf sum = vf_add(vf_add(w[0], w[1]), vf_add(w[2], w[3]));
    // No neighbour far: the pixel keeps its colour.
    const vf t = vf_keep(vf_gt(sum, vf_zero()), vf_mul(blend, coc));
    normalise(w, sum);
    for (int c = 0; c < channels; c++) {
        const float *a = far->colour[0][c] + x, *b = far->colour[1][c] + x;
        const vf top = vf_fma(w[1], vf_load(a + side), vf_mul(w[0], vf_load(a)));
        const vf bottom = vf_fma(w[3], vf_load(b + side), vf_mul(w[2], vf_load(b)));
        colour[c] = vf_lerp(colour[c], vf_add(top, bottom), t);
    }
}

// The published demo's; down: the neighbour row is the one below.
HF_INLINE void blend_far_faithful(const struct far_row *far, const int channels, const int side, const int down, int x,
                                  vf coc, vf blend, vf colour[4])
{
    vf d[4], w[4];
    for (int i = 0; i < 4; i++) {
        // CoCs in reading order of the 2x2 block.
        const float *row = far->coc[(i >> 1) == down];
        const int column = side > 0 ? i & 1 : (i & 1) - 1;
        d[i] = vf_fma(vf_set1(1000), vf_abs(vf_sub(coc, vf_load(row + x + column))), vf_set1(1));
    }
    weights_of(d, w);
    normalise(w, vf_add(vf_add(w[0], w[1]), vf_add(w[2], w[3])));
    const int next = side > 0 ? 1 : 0;
    for (int c = 0; c < channels; c++) {
        const float *a = far->colour[0][c] + x, *b = far->colour[down ? 1 : 0][c] + x;
        const vf top = vf_fma(w[1], vf_load(a + next), vf_mul(w[0], vf_load(a)));
        const vf bottom = vf_fma(w[3], vf_load(b + next), vf_mul(w[2], vf_load(b)));
        colour[c] = vf_lerp(colour[c], vf_add(top, bottom), vf_mul(blend, coc));
    }
}

static void blend_far_row(const struct hf_frame *f, int y, struct hf_rect r, float *const lane[2][4],
                          float *const coc[4])
{
    const int n = r.x1 - r.x0, hy = y / 2, down = y & 1, ny = down ? hy + 1 : hy - 1, channels = f->s->channels;
    struct far_row far;
    for (int i = 0; i < 2; i++) {
        for (int c = 0; c < channels; c++)
            far.colour[i][c] = hf_at(&f->buf[HF_BUF_FAR_FILL], c, r.x0, i ? ny : hy);
        far.coc[i] = hf_at(&f->buf[HF_BUF_COC4], 1, r.x0, i ? ny : hy);
    }
    const vf blend = vf_set1(f->s->blend);
    for (int odd = 0; odd < 2; odd++) {
        const int side = odd ? 1 : -1;
        for (int x = 0; x < n; x += VF_N) {
            vf colour[4];
            const vf k = vf_load(coc[2 + odd] + x);
            for (int c = 0; c < channels; c++)
                colour[c] = vf_load(lane[odd][c] + x);
            if (f->s->faithful)
                blend_far_faithful(&far, channels, side, down, x, k, blend, colour);
            else
                blend_far_block(&far, channels, side, x, k, blend, colour);
            for (int c = 0; c < channels; c++)
                vf_store(lane[odd][c] + x, colour[c]);
        }
    }
}

HF_INLINE vf cubic_vf(vf own, vf neighbour, vf other, vf behind)
{
    vf v = vf_mul(vf_set1(CUBIC_NEIGHBOUR), vf_sub(neighbour, own));
    v = vf_fma(vf_set1(CUBIC_OTHER), vf_sub(other, own), v);
    v = vf_fma(vf_set1(CUBIC_BEHIND), vf_sub(behind, own), v);
    return vf_add(own, v);
}

// A row interpolated in y, from two columns before x0 on.
static void near_line(const struct hf_frame *f, const struct hf_buf *b, int c, int y, struct hf_rect r, float *out)
{
    const int hy = y / 2, step = y & 1 ? 1 : -1;
    const float *own = hf_at(b, c, r.x0 - 2, hy), *next = hf_at(b, c, r.x0 - 2, hy + step);
    const int n = r.x1 - r.x0 + 4;
    if (!f->s->bicubic) {
        for (int x = 0; x < n; x += VF_N) {
            const vf v = vf_load(own + x);
            vf_store(out + x, vf_fma(vf_set1(0.25f), vf_sub(vf_load(next + x), v), v));
        }
        return;
    }
    const float *other = hf_at(b, c, r.x0 - 2, hy - step), *behind = hf_at(b, c, r.x0 - 2, hy + 2 * step);
    for (int x = 0; x < n; x += VF_N)
        vf_store(out + x, cubic_vf(vf_load(own + x), vf_load(next + x), vf_load(other + x), vf_load(behind + x)));
}

// The other direction: p at the pixel's own column.
HF_INLINE vf near_up(const float *p, const int side, const int bicubic)
{
    const vf own = vf_load(p);
    if (bicubic)
        return cubic_vf(own, vf_load(p + side), vf_load(p - side), vf_load(p + 2 * side));
    return vf_fma(vf_set1(0.25f), vf_sub(vf_load(p + side), own), own);
}

HF_INLINE void blend_near_lanes(const struct hf_frame *f, float *const line[5], float *const lane[4], int n,
                                const int side, const int bicubic, const int channels)
{
    const vf blend = vf_set1(f->s->blend);
    for (int x = 0; x < n; x += VF_N) {
        const vf t = vf_mul(blend, near_up(line[4] + 2 + x, side, bicubic));
        for (int c = 0; c < channels; c++)
            vf_store(lane[c] + x,
                     vf_lerp(vf_load(lane[c] + x), near_up(line[c] + 2 + x, side, bicubic), t));
    }
}

static void blend_near_row(const struct hf_frame *f, int y, struct hf_rect r, float *const lane[2][4])
{
    const int n = r.x1 - r.x0, channels = f->s->channels;
    float *line[5];
    for (int i = 0; i < 5; i++)
        line[i] = hf_line(f, 12 + i);
    for (int c = 0; c < channels; c++)
        near_line(f, &f->buf[HF_BUF_NEAR_FILL], c, y, r, line[c]);
    near_line(f, &f->buf[HF_BUF_BLUR], 0, y, r, line[4]);
    for (int odd = 0; odd < 2; odd++) {
        if (f->s->bicubic)
            blend_near_lanes(f, line, lane[odd], n, odd ? 1 : -1, 1, channels);
        else if (channels == 3)
            blend_near_lanes(f, line, lane[odd], n, odd ? 1 : -1, 0, 3);
        else
            blend_near_lanes(f, line, lane[odd], n, odd ? 1 : -1, 0, 4);
    }
}

static void composite_row_simd(const struct hf_frame *f, int y, struct hf_rect r)
{
    const int n = r.x1 - r.x0;
    float *lane[2][4], *coc[4];
    for (int i = 0; i < 4; i++) {
        lane[0][i] = hf_line(f, i);
        lane[1][i] = hf_line(f, 4 + i);
        coc[i] = hf_line(f, 8 + i);
    }
    hf_read_colour(f, r.x0, y, n, lane[0], lane[1], f->counts);
    if (f->far) {
        f->k->coc_row(f, r.x0, y, n, coc, NULL);
        blend_far_row(f, y, r, lane, coc);
    }
    if (f->near)
        blend_near_row(f, y, r, lane);
    hf_store_rgb(f, lane[0], n);
    hf_store_rgb(f, lane[1], n);
    if (f->s->channels == 3)
        lane[0][3] = lane[1][3] = NULL;
    f->counts->clamped += f->k->store[f->dst->format](f->dst, r.x0, y, n, (const float *const *)lane[0],
                                                      (const float *const *)lane[1]);
}

static void composite_simd(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height); y++)
        composite_row_simd(f, y, r);
}
