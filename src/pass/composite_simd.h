// SPDX-License-Identifier: BSD-3-Clause
// Composite on vectors. Even and odd pixels are lanes of their own, so the four phases of the upsampling are four
// pieces of plain arithmetic over the same half-resolution loads; both phases in x are made together and share them.

// A half-resolution row around a row of the picture: its own and its neighbour's, at lane 0. Channels lie a fixed
// distance apart, so that a few registers address them all; vector stores may alias anything, and pointers kept in memory
// would be read again after each.
struct field_row {
    const float *own, *next;
    ptrdiff_t plane;
};

// What a row of the composite is made from.
struct composite_row {
    struct field_row far, far_coc;
    struct field_row near, near_coc;  // cubic: lines interpolated in y, and no neighbours
    float blend;
    int down;  // the neighbour row is the one below
};

// Colours and far CoC of 2 VF_N pixels: even, odd.
struct composite_block {
    vf colour[2][4];
    vf coc[2];
};

// Far CoC of the neighbours of even and odd pixels: own, beside, next, and next beside.
HF_INLINE void load_neighbours(const struct field_row *f, int c, int x, vf g[2][4])
{
    const float *own = f->own + c * f->plane + x, *next = f->next + c * f->plane + x;
    g[0][0] = g[1][0] = vf_load(own);
    g[0][1] = vf_load(own - 1);
    g[1][1] = vf_load(own + 1);
    g[0][2] = g[1][2] = vf_load(next);
    g[0][3] = vf_load(next - 1);
    g[1][3] = vf_load(next + 1);
}

// d: 1 + 1000 |CoC difference|, thrice that for the last.
HF_INLINE void far_distances(vf coc, const vf g[4], vf d[4])
{
    for (int i = 0; i < 4; i++)
        d[i] = vf_fma(vf_set1(i == 3 ? 3000 : 1000), vf_abs(vf_sub(coc, g[i])), vf_set1(i == 3 ? 3 : 1));
}

HF_INLINE void normalise(vf w[4], vf sum)
{
    const vf i = vf_div(vf_set1(1), sum);
    for (int t = 0; t < 4; t++)
        w[t] = vf_mul(w[t], i);
}

// Weights in proportion to 9 3 3 1 / d; returns t, or 0 where no neighbour is far: the pixel keeps its colour.
HF_INLINE vf far_weights_block(vf coc, const vf g[4], vf t, vf w[4])
{
    vf d[4];
    far_distances(coc, g, d);
    const vf p01 = vf_mul(d[0], d[1]), p23 = vf_mul(d[2], d[3]);
    w[0] = vf_keep(vf_gt(g[0], vf_zero()), vf_mul(vf_mul(vf_set1(3), d[1]), p23));
    w[1] = vf_keep(vf_gt(g[1], vf_zero()), vf_mul(d[0], p23));
    w[2] = vf_keep(vf_gt(g[2], vf_zero()), vf_mul(d[3], p01));
    w[3] = vf_keep(vf_gt(g[3], vf_zero()), vf_mul(d[2], p01));
    const vf sum = vf_add(vf_add(w[0], w[1]), vf_add(w[2], w[3]));
    t = vf_keep(vf_gt(sum, vf_zero()), t);
    normalise(w, sum);
    return t;
}

HF_INLINE void blend_far_block(const struct field_row *colour, const struct field_row *coc_row, const int channels,
                               int x, vf blend, struct composite_block *b)
{
    vf g[2][4], w[2][4], t[2];
    load_neighbours(coc_row, 0, x, g);
    const vm differs = vm_or(vm_or(vm_or(vf_ne(b->coc[0], b->coc[1]), vf_ne(b->coc[0], g[0][0])),
                                   vm_or(vf_ne(b->coc[0], g[0][1]), vf_ne(b->coc[0], g[1][1]))),
                             vm_or(vm_or(vf_ne(b->coc[0], g[0][2]), vf_ne(b->coc[0], g[0][3])),
                                   vm_or(vf_ne(b->coc[0], g[1][3]), vf_eq(b->coc[0], vf_zero()))));
    for (int o = 0; o < 2; o++)
        t[o] = vf_mul(blend, b->coc[o]);
    // Where all CoCs are the same, as inside a far field that is fully blurred, bilinear weights are what would come
    // out.
    if (vm_any(differs)) {
        for (int o = 0; o < 2; o++)
            t[o] = far_weights_block(b->coc[o], g[o], t[o], w[o]);
    } else {
        for (int o = 0; o < 2; o++) {
            w[o][0] = vf_set1(9 / 16.0f);
            w[o][1] = w[o][2] = vf_set1(3 / 16.0f);
            w[o][3] = vf_set1(1 / 16.0f);
        }
    }
    for (int c = 0; c < channels; c++) {
        vf v[2][4];
        load_neighbours(colour, c, x, v);
        for (int o = 0; o < 2; o++) {
            vf sum = vf_mul(w[o][0], v[o][0]);
            for (int i = 1; i < 4; i++)
                sum = vf_fma(w[o][i], v[o][i], sum);
            b->colour[o][c] = vf_lerp(b->colour[o][c], sum, t[o]);
        }
    }
}

// The published demo's: CoCs in reading order of the 2x2 block, which for even pixels is the one before.
HF_INLINE void blend_far_faithful(const struct composite_row *r, const int channels, int x, vf blend,
                                  struct composite_block *b)
{
    const float *coc[2] = {r->down ? r->far_coc.own : r->far_coc.next, r->down ? r->far_coc.next : r->far_coc.own};
    const float *below = r->down ? r->far.next : r->far.own;
    for (int o = 0; o < 2; o++) {
        vf d[4], w[4];
        for (int i = 0; i < 4; i++) {
            const vf g = vf_load(coc[i >> 1] + x + (i & 1) - 1 + o);
            d[i] = vf_fma(vf_set1(1000), vf_abs(vf_sub(b->coc[o], g)), vf_set1(1));
        }
        const vf p01 = vf_mul(d[0], d[1]), p23 = vf_mul(d[2], d[3]);
        w[0] = vf_mul(d[1], p23);
        w[1] = vf_mul(d[0], p23);
        w[2] = vf_mul(d[3], p01);
        w[3] = vf_mul(d[2], p01);
        normalise(w, vf_add(vf_add(w[0], w[1]), vf_add(w[2], w[3])));
        for (int c = 0; c < channels; c++) {
            const float *p = r->far.own + c * r->far.plane + x, *q = below + c * r->far.plane + x;
            vf sum = vf_mul(w[0], vf_load(p));
            sum = vf_fma(w[1], vf_load(p + o), sum);
            sum = vf_fma(w[2], vf_load(q), sum);
            sum = vf_fma(w[3], vf_load(q + o), sum);
            b->colour[o][c] = vf_lerp(b->colour[o][c], sum, vf_mul(blend, b->coc[o]));
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

// A row of the near field interpolated in y, from two columns before x0 on.
static void cubic_line(const struct hf_buf *b, int c, int y, struct hf_rect r, float *out)
{
    const int hy = y / 2, step = y & 1 ? 1 : -1;
    const float *own = hf_at(b, c, r.x0 - 2, hy), *next = hf_at(b, c, r.x0 - 2, hy + step);
    const float *other = hf_at(b, c, r.x0 - 2, hy - step), *behind = hf_at(b, c, r.x0 - 2, hy + 2 * step);
    for (int x = 0; x < r.x1 - r.x0 + 4; x += VF_N)
        vf_store(out + x, cubic_vf(vf_load(own + x), vf_load(next + x), vf_load(other + x), vf_load(behind + x)));
}

// A quarter of the way.
HF_INLINE vf lean(vf from, vf to)
{
    return vf_fma(vf_set1(0.25f), vf_sub(to, from), from);
}

// Channel c of the near field at even and odd pixels.
HF_INLINE void near_up(const struct field_row *f, const int bicubic, int c, int x, vf up[2])
{
    const float *own = f->own + c * f->plane + x, *next = f->next + c * f->plane + x;
    if (bicubic) {
        const vf before = vf_load(own - 1), v = vf_load(own), after = vf_load(own + 1);
        up[0] = cubic_vf(v, before, after, vf_load(own - 2));
        up[1] = cubic_vf(v, after, before, vf_load(own + 2));
        return;
    }
    const vf v = lean(vf_load(own), vf_load(next));
    up[0] = lean(v, lean(vf_load(own - 1), vf_load(next - 1)));
    up[1] = lean(v, lean(vf_load(own + 1), vf_load(next + 1)));
}

// Returns 0 if there is nothing to blend: vectors without CoC are left alone.
HF_INLINE int composite_pixels(const struct composite_row *r, const int channels, const int with_far,
                               const int with_near, const int faithful, const int bicubic, int x,
                               struct composite_block *b)
{
    const vf blend = vf_set1(r->blend);
    vf near[2] = {vf_zero(), vf_zero()};
    if (with_near)
        near_up(&r->near_coc, bicubic, 0, x, near);
    for (int o = 0; o < 2; o++)
        near[o] = vf_mul(blend, near[o]);
    const int is_far = with_far && vm_any(vm_or(vf_gt(b->coc[0], vf_zero()), vf_gt(b->coc[1], vf_zero())));
    const int is_near = with_near && vm_any(vm_or(vf_ne(near[0], vf_zero()), vf_ne(near[1], vf_zero())));
    if (is_far && faithful)
        blend_far_faithful(r, channels, x, blend, b);
    else if (is_far)
        blend_far_block(&r->far, &r->far_coc, channels, x, blend, b);
    if (is_near)
        for (int c = 0; c < channels; c++) {
            vf up[2];
            near_up(&r->near, bicubic, c, x, up);
            for (int o = 0; o < 2; o++)
                b->colour[o][c] = vf_lerp(b->colour[o][c], up[o], near[o]);
        }
    return is_far || is_near;
}

// ---- through lines: everything there is ----

// lane: the picture, even and odd, channel by channel, `line` floats apart; overwritten. coc: even, then odd.
HF_INLINE void composite_lines(const struct composite_row *row, const int channels, const int far, const int near,
                               const int faithful, const int bicubic, float *const lane[2], const float *coc,
                               ptrdiff_t line, int n)
{
    const struct composite_row r = *row;  // see field_row
    float *const even = lane[0], *const odd = lane[1];
    for (int x = 0; x < n; x += VF_N) {
        struct composite_block b;
        for (int c = 0; c < channels; c++) {
            b.colour[0][c] = vf_load(even + c * line + x);
            b.colour[1][c] = vf_load(odd + c * line + x);
        }
        b.coc[0] = vf_load(coc + x);
        b.coc[1] = vf_load(coc + line + x);
        if (!composite_pixels(&r, channels, far, near, faithful, bicubic, x, &b))
            continue;
        for (int c = 0; c < channels; c++) {
            vf_store(even + c * line + x, b.colour[0][c]);
            vf_store(odd + c * line + x, b.colour[1][c]);
        }
    }
}

// Options become constants, so that no pixel asks for them.
HF_INLINE void composite_options(const struct composite_row *r, const struct hf_setup *s, int far, int near,
                                 const int channels, float *const lane[2], const float *coc, ptrdiff_t line, int n)
{
    if (s->faithful || s->bicubic)
        composite_lines(r, channels, far, near, s->faithful, s->bicubic, lane, coc, line, n);
    else if (far && near)
        composite_lines(r, channels, 1, 1, 0, 0, lane, coc, line, n);
    else if (far)
        composite_lines(r, channels, 1, 0, 0, 0, lane, coc, line, n);
    else
        composite_lines(r, channels, 0, 1, 0, 0, lane, coc, line, n);
}

// From lane x0 of row y, n lanes.
static void composite_row_lines(const struct hf_frame *f, const struct composite_row *r, int x0, int y, int n)
{
    const struct hf_setup *s = f->s;
    float *lane[2][4], *coc[4];
    for (int i = 0; i < 4; i++) {
        lane[0][i] = hf_line(f, i);
        lane[1][i] = hf_line(f, 4 + i);
        coc[i] = hf_line(f, 8 + i);
    }
    hf_read_colour(f, x0, y, n, lane[0], lane[1], f->counts);
    if (f->far)
        f->k->coc_row(f, x0, y, n, coc, NULL);
    float *const both[2] = {lane[0][0], lane[1][0]};
    if (s->channels == 3)
        composite_options(r, s, f->far, f->near, 3, both, coc[2], (ptrdiff_t)f->line_floats, n);
    else
        composite_options(r, s, f->far, f->near, 4, both, coc[2], (ptrdiff_t)f->line_floats, n);
    hf_store_rgb(f, lane[0], n);
    hf_store_rgb(f, lane[1], n);
    if (s->channels == 3)
        lane[0][3] = lane[1][3] = NULL;
    f->counts->clamped += f->k->store[f->dst->format](f->dst, x0, y, n, (const float *const *)lane[0],
                                                      (const float *const *)lane[1]);
}

// ---- rows ----

static struct field_row field_at(const struct hf_buf *b, int c, int x, int y, int next_y)
{
    return (struct field_row){hf_at(b, c, x, y), hf_at(b, c, x, next_y), b->ch[1] - b->ch[0]};
}

static void composite_row_simd(const struct hf_frame *f, int y, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const int hy = y / 2, down = y & 1, ny = down ? hy + 1 : hy - 1;
    struct composite_row row = {.blend = s->blend, .down = down};
    if (f->far) {
        row.far = field_at(&f->buf[HF_BUF_FAR_FILL], 0, r.x0, hy, ny);
        row.far_coc = field_at(&f->buf[HF_BUF_COC4], 1, r.x0, hy, ny);
    }
    if (f->near && !s->bicubic) {
        row.near = field_at(&f->buf[HF_BUF_NEAR_FILL], 0, r.x0, hy, ny);
        row.near_coc = field_at(&f->buf[HF_BUF_BLUR], 0, r.x0, hy, ny);
    } else if (f->near) {
        for (int c = 0; c < s->channels; c++)
            cubic_line(&f->buf[HF_BUF_NEAR_FILL], c, y, r, hf_line(f, 12 + c));
        cubic_line(&f->buf[HF_BUF_BLUR], 0, y, r, hf_line(f, 16));
        row.near = (struct field_row){.own = hf_line(f, 12) + 2, .plane = (ptrdiff_t)f->line_floats};
        row.near_coc = (struct field_row){.own = hf_line(f, 16) + 2};
    }
    composite_row_lines(f, &row, r.x0, y, r.x1 - r.x0);
}

static void composite_simd(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height); y++)
        composite_row_simd(f, y, r);
}
