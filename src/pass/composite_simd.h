// SPDX-License-Identifier: BSD-3-Clause
// Composite on vectors. Even and odd pixels are lanes of their own, so the four phases of the upsampling are four
// pieces of plain arithmetic over the same half-resolution loads. The near field is interpolated in y once for both
// phases in x.

// The far field around a row: its own and its neighbour's, at lane 0. Channels lie a fixed distance apart, so that a few
// registers address them all; vector stores may alias anything, and pointers kept in memory would be read again after
// each.
struct far_row {
    const float *colour[2];
    const float *coc[2];
    ptrdiff_t plane;
};

// Weights in proportion to 1 / d, each d = 1 + 1000 |CoC difference|.
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
    vf g[4], w[4] = {vf_set1(9 / 16.0f), vf_set1(3 / 16.0f), vf_set1(3 / 16.0f), vf_set1(1 / 16.0f)};
    vf t = vf_mul(blend, coc);
    for (int i = 0; i < 4; i++)
        g[i] = vf_load(far->coc[i >> 1] + x + (i & 1 ? side : 0));
    vm differs = vm_or(vm_or(vf_ne(coc, g[0]), vf_ne(coc, g[1])), vm_or(vf_ne(coc, g[2]), vf_ne(coc, g[3])));
    // Where all CoCs are the same, as inside a far field that is fully blurred, bilinear weights are what would come
    // out.
    if (vm_any(vm_or(differs, vf_eq(coc, vf_zero())))) {
        vf d[4];
        for (int i = 0; i < 4; i++)
            d[i] = vf_fma(vf_set1(1000), vf_abs(vf_sub(coc, g[i])), vf_set1(1));
        weights_of(d, w);
        w[0] = vf_keep(vf_gt(g[0], vf_zero()), vf_mul(vf_set1(9), w[0]));
        w[1] = vf_keep(vf_gt(g[1], vf_zero()), vf_mul(vf_set1(3), w[1]));
        w[2] = vf_keep(vf_gt(g[2], vf_zero()), vf_mul(vf_set1(3), w[2]));
        w[3] = vf_keep(vf_gt(g[3], vf_zero()), w[3]);
        const vf sum = vf_add(vf_add(w[0], w[1]), vf_add(w[2], w[3]));
        // No neighbour far: the pixel keeps its colour.
        t = vf_keep(vf_gt(sum, vf_zero()), t);
        normalise(w, sum);
    }
    for (int c = 0; c < channels; c++) {
        const float *a = far->colour[0] + c * far->plane + x, *b = far->colour[1] + c * far->plane + x;
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
        const float *a = far->colour[0] + c * far->plane + x;
        const float *b = far->colour[down ? 1 : 0] + c * far->plane + x;
        const vf top = vf_fma(w[1], vf_load(a + next), vf_mul(w[0], vf_load(a)));
        const vf bottom = vf_fma(w[3], vf_load(b + next), vf_mul(w[2], vf_load(b)));
        colour[c] = vf_lerp(colour[c], vf_add(top, bottom), vf_mul(blend, coc));
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

// What a row of the composite is made from. Rows of one kind lie `line` floats apart.
struct composite_row {
    float *lane[2];     // the picture, even and odd, channel by channel; overwritten
    const float *coc;   // far CoC, even, then odd
    const float *near;  // near field's channels, then blurred CoC, interpolated in y, from two columns before the row
    ptrdiff_t line;
    struct far_row far;
    float blend;
    int down;           // the neighbour row is the one below
};

// Even or odd pixels of a row. Vectors without CoC are left alone: there is nothing to blend.
HF_INLINE void composite_lanes(const struct composite_row *row, const int channels, const int with_far,
                               const int with_near, const int faithful, const int bicubic, const int side, int n)
{
    const struct composite_row r = *row;  // see far_row
    float *const lane = r.lane[side > 0];
    const float *const coc_row = r.coc + (side > 0 ? r.line : 0), *const near_row = r.near + 2;
    const vf blend = vf_set1(r.blend);
    for (int x = 0; x < n; x += VF_N) {
        const vf coc = with_far ? vf_load(coc_row + x) : vf_zero();
        const vf near = with_near ? vf_mul(blend, near_up(near_row + channels * r.line + x, side, bicubic)) : vf_zero();
        const int is_far = with_far && vm_any(vf_gt(coc, vf_zero())), is_near = with_near && vm_any(vf_ne(near, vf_zero()));
        if (!is_far && !is_near)
            continue;
        vf colour[4];
        for (int c = 0; c < channels; c++)
            colour[c] = vf_load(lane + c * r.line + x);
        if (is_far && faithful)
            blend_far_faithful(&r.far, channels, side, r.down, x, coc, blend, colour);
        else if (is_far)
            blend_far_block(&r.far, channels, side, x, coc, blend, colour);
        if (is_near)
            for (int c = 0; c < channels; c++)
                colour[c] = vf_lerp(colour[c], near_up(near_row + c * r.line + x, side, bicubic), near);
        for (int c = 0; c < channels; c++)
            vf_store(lane + c * r.line + x, colour[c]);
    }
}

// Options become constants, so that no pixel asks for them.
HF_INLINE void composite_fields(const struct composite_row *r, const struct hf_setup *s, int far, int near, int n,
                                const int channels)
{
    if (s->faithful || s->bicubic) {
        composite_lanes(r, channels, far, near, s->faithful, s->bicubic, -1, n);
        composite_lanes(r, channels, far, near, s->faithful, s->bicubic, 1, n);
    } else if (far && near) {
        composite_lanes(r, channels, 1, 1, 0, 0, -1, n);
        composite_lanes(r, channels, 1, 1, 0, 0, 1, n);
    } else if (far) {
        composite_lanes(r, channels, 1, 0, 0, 0, -1, n);
        composite_lanes(r, channels, 1, 0, 0, 0, 1, n);
    } else {
        composite_lanes(r, channels, 0, 1, 0, 0, -1, n);
        composite_lanes(r, channels, 0, 1, 0, 0, 1, n);
    }
}

static void composite_row_simd(const struct hf_frame *f, int y, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const int n = r.x1 - r.x0, hy = y / 2, down = y & 1, ny = down ? hy + 1 : hy - 1;
    float *lane[2][4], *coc[4];
    for (int i = 0; i < 4; i++) {
        lane[0][i] = hf_line(f, i);
        lane[1][i] = hf_line(f, 4 + i);
        coc[i] = hf_line(f, 8 + i);
    }
    struct composite_row row = {.lane = {lane[0][0], lane[1][0]}, .coc = coc[2], .near = hf_line(f, 12),
                                .line = (ptrdiff_t)f->line_floats, .blend = s->blend, .down = down};
    hf_read_colour(f, r.x0, y, n, lane[0], lane[1], f->counts);
    if (f->far) {
        const struct hf_buf *fill = &f->buf[HF_BUF_FAR_FILL];
        f->k->coc_row(f, r.x0, y, n, coc, NULL);
        row.far.plane = fill->ch[1] - fill->ch[0];
        for (int i = 0; i < 2; i++) {
            row.far.colour[i] = hf_at(fill, 0, r.x0, i ? ny : hy);
            row.far.coc[i] = hf_at(&f->buf[HF_BUF_COC4], 1, r.x0, i ? ny : hy);
        }
    }
    if (f->near) {
        for (int c = 0; c < s->channels; c++)
            near_line(f, &f->buf[HF_BUF_NEAR_FILL], c, y, r, hf_line(f, 12 + c));
        near_line(f, &f->buf[HF_BUF_BLUR], 0, y, r, hf_line(f, 12 + s->channels));
    }
    if (s->channels == 3)
        composite_fields(&row, s, f->far, f->near, n, 3);
    else
        composite_fields(&row, s, f->far, f->near, n, 4);
    hf_store_rgb(f, lane[0], n);
    hf_store_rgb(f, lane[1], n);
    if (s->channels == 3)
        lane[0][3] = lane[1][3] = NULL;
    f->counts->clamped += f->k->store[f->dst->format](f->dst, r.x0, y, n, (const float *const *)lane[0],
                                                      (const float *const *)lane[1]);
}

static void composite_simd(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height); y++)
        composite_row_simd(f, y, r);
}
