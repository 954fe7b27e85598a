// SPDX-License-Identifier: BSD-3-Clause
#ifndef PF_ROWS
#define PF_ROWS 2
#define PF_IN 1
#define PF_OUT 1
#endif
// Composite on vectors. Even and odd pixels are lanes of their own, so the four phases of the upsampling are four
// pieces of plain arithmetic over the same half-resolution loads; both phases in x are made together and share them.

// The half-resolution row of a row of the picture and its neighbour, at lane 0. Channels lie a fixed distance apart, so
// that a few registers address them all; vector stores may alias anything, and pointers kept in memory would be read
// again after each.
struct field_row {
    const float *own, *next;
    ptrdiff_t plane;
};

// What a row of the composite is made from.
struct composite_row {
    struct field_row far, far_coc;
    struct field_row near, near_coc;  // in lines: interpolated in y, and without neighbours
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

// Weights of even and odd pixels' neighbours, and how much the sums count.
HF_INLINE void far_weights(const struct field_row *coc_row, int x, vf blend, const vf coc[2], vf w[2][4], vf t[2])
{
    vf g[2][4];
    load_neighbours(coc_row, 0, x, g);
    vi differs = vi_xor(vf_as_vi(coc[0]), vf_as_vi(coc[1]));
    for (int i = 0; i < 4; i++)
        for (int o = 0; o < 2; o++)
            differs = vi_or_xor(differs, vf_as_vi(coc[0]), vf_as_vi(g[o][i]));
    for (int o = 0; o < 2; o++)
        t[o] = vf_mul(blend, coc[o]);
    // Where all CoCs are the same, as inside a far field that is fully blurred, bilinear weights are what would come
    // out.
    if (vi_any(differs)) {
        for (int o = 0; o < 2; o++)
            t[o] = far_weights_block(coc[o], g[o], t[o], w[o]);
    } else {
        for (int o = 0; o < 2; o++) {
            w[o][0] = vf_set1(9 / 16.0f);
            w[o][1] = w[o][2] = vf_set1(3 / 16.0f);
            w[o][3] = vf_set1(1 / 16.0f);
        }
    }
}

HF_INLINE void blend_far_channel(const struct field_row *colour, int c, int x, vf w[2][4], const vf t[2],
                                 struct composite_block *b)
{
    vf v[2][4];
    load_neighbours(colour, c, x, v);
    for (int o = 0; o < 2; o++) {
        vf sum = vf_mul(w[o][0], v[o][0]);
        for (int i = 1; i < 4; i++)
            sum = vf_fma(w[o][i], v[o][i], sum);
        b->colour[o][c] = vf_lerp(b->colour[o][c], sum, t[o]);
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

// A quarter of the way.
HF_INLINE vf lean(vf from, vf to)
{
    return vf_fma(vf_set1(0.25f), vf_sub(to, from), from);
}

// Sixteen lanes interpolate the near field in y as they need it; with fewer, a line of it made first is faster. The
// cubic always has lines.
enum { NEAR_LINES = VF_N < 16 };

// A row of the near field interpolated in y, from 16 columns before x0, so that loads are aligned, to two behind its
// end.
static void near_line(const struct hf_setup *s, const struct hf_buf *b, int c, int y, struct hf_rect r, float *out)
{
    const int hy = y / 2, step = y & 1 ? 1 : -1, x0 = r.x0 - 16, n = r.x1 - x0 + 2;
    const float *own = hf_at(b, c, x0, hy), *next = hf_at(b, c, x0, hy + step);
    if (!s->bicubic) {
        for (int x = 16 - VF_N; x < n; x += VF_N)
            vf_store(out + x, lean(vf_load(own + x), vf_load(next + x)));
        return;
    }
    const float *other = hf_at(b, c, x0, hy - step), *behind = hf_at(b, c, x0, hy + 2 * step);
    for (int x = 16 - VF_N; x < n; x += VF_N)
        vf_store(out + x, cubic_vf(vf_load(own + x), vf_load(next + x), vf_load(other + x), vf_load(behind + x)));
}

// The same, a vector of it: either made here or in a line.
HF_INLINE vf near_at(const struct field_row *f, const int line, ptrdiff_t x)
{
    return line ? vf_load(f->own + x) : lean(vf_load(f->own + x), vf_load(f->next + x));
}

// Channel c of the near field at even and odd pixels.
HF_INLINE void near_up(const struct field_row *f, const int bicubic, int c, int x, vf up[2])
{
    const ptrdiff_t at = c * f->plane + x;
    const int line = NEAR_LINES || bicubic;
    const vf before = near_at(f, line, at - 1), v = near_at(f, line, at), after = near_at(f, line, at + 1);
    up[0] = bicubic ? cubic_vf(v, before, after, near_at(f, 1, at - 2)) : lean(v, before);
    up[1] = bicubic ? cubic_vf(v, after, before, near_at(f, 1, at + 2)) : lean(v, after);
}

// Returns 0 if there is nothing to blend: vectors without CoC are left alone. Colours of the near field are made before
// the far field is blended: that is what there is to do while its weights wait for their division.
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
    vf w[2][4] = {{vf_zero()}}, t[2] = {vf_zero()}, up[4][2] = {{vf_zero()}};
    if (is_far && !faithful)
        far_weights(&r->far_coc, x, blend, b->coc, w, t);
    if (is_near)
        for (int c = 0; c < channels; c++)
            near_up(&r->near, bicubic, c, x, up[c]);
    if (is_far && faithful)
        blend_far_faithful(r, channels, x, blend, b);
    else if (is_far)
        for (int c = 0; c < channels; c++)
            blend_far_channel(&r->far, c, x, w, t, b);
    if (is_near)
        for (int c = 0; c < channels; c++)
            for (int o = 0; o < 2; o++)
                b->colour[o][c] = vf_lerp(b->colour[o][c], up[c][o], near[o]);
    return is_far || is_near;
}

// ---- through lines: everything there is ----

// Lanes of a row that have been read: the picture, even and odd, channel by channel, `line` floats apart; overwritten.
// Far CoC: even, then odd.
struct composite_line {
    int first, n;
    float *even, *odd;
    const float *coc;
    ptrdiff_t line;
};

HF_INLINE void composite_lines(const struct composite_row *row, const struct composite_line *lines, const int channels,
                               const int far, const int near, const int faithful, const int bicubic)
{
    const struct composite_row r = *row;  // see field_row
    const struct composite_line l = *lines;
    for (int x = 0; x < l.n; x += VF_N) {
        struct composite_block b;
        for (int c = 0; c < channels; c++) {
            b.colour[0][c] = vf_load(l.even + c * l.line + x);
            b.colour[1][c] = vf_load(l.odd + c * l.line + x);
        }
        for (int o = 0; o < 2; o++)
            b.coc[o] = vf_load(l.coc + o * l.line + x);
        if (!composite_pixels(&r, channels, far, near, faithful, bicubic, l.first + x, &b))
            continue;
        for (int c = 0; c < channels; c++) {
            vf_store(l.even + c * l.line + x, b.colour[0][c]);
            vf_store(l.odd + c * l.line + x, b.colour[1][c]);
        }
    }
}

// Options become constants, so that no pixel asks for them.
HF_INLINE void composite_options(const struct composite_row *r, const struct composite_line *l,
                                 const struct hf_setup *s, int far, int near, const int channels)
{
    if (s->faithful || s->bicubic)
        composite_lines(r, l, channels, far, near, s->faithful, s->bicubic);
    else if (far && near)
        composite_lines(r, l, channels, 1, 1, 0, 0);
    else if (far)
        composite_lines(r, l, channels, 1, 0, 0, 0);
    else
        composite_lines(r, l, channels, 0, 1, 0, 0);
}

// Row y of rectangle r, from its lane `first` on.
static void composite_row_lines(const struct hf_frame *f, const struct composite_row *row, int y, struct hf_rect r,
                                int first)
{
    const struct hf_setup *s = f->s;
    const int x0 = r.x0 + first, n = r.x1 - x0;
    float *lane[2][4], *coc[4];
    for (int i = 0; i < 4; i++) {
        lane[0][i] = hf_line(f, i);
        lane[1][i] = hf_line(f, 4 + i);
        coc[i] = hf_line(f, 8 + i);
    }
    hf_read_colour(f, x0, y, n, lane[0], lane[1], f->counts);
    if (f->far)
        f->k->coc_row(f, x0, y, n, coc, NULL);
    const struct composite_line l = {first, n, lane[0][0], lane[1][0], coc[2], (ptrdiff_t)f->line_floats};
    if (s->channels == 3)
        composite_options(row, &l, s, f->far, f->near, 3);
    else
        composite_options(row, &l, s, f->far, f->near, 4);
    hf_store_rgb(f, lane[0], n);
    hf_store_rgb(f, lane[1], n);
    if (s->channels == 3)
        lane[0][3] = lane[1][3] = NULL;
    f->counts->clamped += f->k->store[f->dst->format](f->dst, x0, y, n, (const float *const *)lane[0],
                                                      (const float *const *)lane[1]);
}

// ---- in registers: R11G11B10F to R11G11B10F ----

// Rows of pixels from lane 0 on.
struct packed_row {
    const uint8_t *from, *depth;
    uint8_t *to;
    ptrdiff_t from_stride, depth_stride, to_stride;
};

// 2 VF_N pixels of the row after next: a tile's rows are too short for hardware prefetchers to catch on.
#define FETCH_AHEAD(p, stride, write)                                                                                \
    for (int k_ = 0; k_ < 8 * VF_N; k_ += 64)                                                                        \
    __builtin_prefetch((const uint8_t *)((uintptr_t)(p) + (uintptr_t)(2 * (stride))) + k_, write)

// Far CoC of 2 VF_N pixels from their distances. Returns lanes that are no number.
HF_INLINE vm far_coc(const struct hf_setup *s, const uint8_t *depth, vf coc[2])
{
    vf d[2];
    vf_unzip(vf_load(depth), vf_load(depth + 4 * VF_N), &d[0], &d[1]);
    for (int o = 0; o < 2; o++) {
        vm none;
        const vf v = coc_variable(s, HF_FORM_Z, d[o], vf_zero(), vf_zero(), &none);
        coc[o] = coc_saturate(vf_mul(vf_sub(v, vf_set1(s->far_0)), vf_set1(s->far_i)));
        if (s->smoothstep)
            coc[o] = coc_shape(coc[o]);
        coc[o] = coc_round(s->storage, coc[o]);
    }
    return vm_or(vf_ne(d[0], d[0]), vf_ne(d[1], d[1]));
}

// n lanes: a multiple of VF_N, all inside the picture. made: far CoC is in coc, even, then odd; else it is made from
// distances, a vector ahead, as the blending of the one at hand begins with it and is one long chain. Returns how many
// lanes were done: all, or those before a sample that is not finite.
HF_INLINE int composite_packed(const struct composite_row *row, const struct packed_row *packed,
                               const struct hf_setup *s, const int far, const int near, const int made,
                               const float *coc, ptrdiff_t line, int n, vi *clamped)
{
    const struct composite_row r = *row;  // see field_row
    const struct packed_row p = *packed;
    vf next[2];
    vm next_bad = vf_gt(vf_zero(), vf_zero());
    if (far && !made && n > 0)
        next_bad = far_coc(s, p.depth, next);
    for (int x = 0; x < n; x += VF_N) {
        const size_t at = (size_t)x * 8;
        struct composite_block b;
        FETCH_AHEAD(p.from + at, p.from_stride, 0);
        FETCH_AHEAD(p.to + at, p.to_stride, 1);
        for (int o = 0; o < 2 && far; o++)
            b.coc[o] = made ? vf_load(coc + o * line + x) : next[o];
        if (vm_any(vm_or(next_bad, load_block(HF_FORMAT_R11G11B10F, p.from + at, b.colour[0], b.colour[1]))))
            return x;
        composite_pixels(&r, 3, far, near, 0, 0, x, &b);
        if (far && !made) {
            FETCH_AHEAD(p.depth + at, p.depth_stride, 0);
            next_bad = far_coc(s, p.depth + (size_t)hf_min(x + VF_N, n - VF_N) * 8, next);
        }
        if (s->storage == HF_STORAGE_CHAPTER)
            for (int c = 0; c < 6; c++)
                b.colour[c / 3][c % 3] = truncate_channel(b.colour[c / 3][c % 3], c % 3);
        store_block(HF_FORMAT_R11G11B10F, p.to + at, b.colour[0], b.colour[1], clamped);
    }
    return n;
}

// What can be done in registers of row y of rectangle r: returns how many lanes, the rest goes through lines.
static int composite_row_packed(const struct hf_frame *f, const struct composite_row *row, int y, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const int x0 = r.x0, pixels = hf_min(2 * r.x1, s->width) - 2 * x0, n = pixels / 2 / VF_N * VF_N;
    if (f->src->format != HF_FORMAT_R11G11B10F || f->dst->format != HF_FORMAT_R11G11B10F ||
        s->storage == HF_STORAGE_HALF || s->faithful || s->bicubic)
        return 0;
    const struct packed_row p = {
        plane_at(f->src, 0, 4, x0, y),
        (const uint8_t *)f->depth->data + (ptrdiff_t)y * f->depth->stride + (size_t)x0 * 8,
        plane_at(f->dst, 0, 4, x0, y),
        f->src->stride[0], f->depth->stride, f->dst->stride[0]};
    // In place, a sample that is not finite wants neighbours that have not been overwritten.
    if (p.from == p.to && !f->k->finite_r11(p.from, (size_t)pixels, NULL))
        return 0;
    const ptrdiff_t line = (ptrdiff_t)f->line_floats;
    float *const coc[4] = {hf_line(f, 8), hf_line(f, 9), hf_line(f, 10), hf_line(f, 11)};
    const int made = s->form != HF_FORM_Z;
    if (f->far && made)
        f->k->coc_row(f, x0, y, n, coc, NULL);
    vi clamped = vi_set1(0);
    int done;
    if (!f->far)
        done = composite_packed(row, &p, s, 0, 1, 1, coc[2], line, n, &clamped);
    else if (f->near)
        done = made ? composite_packed(row, &p, s, 1, 1, 1, coc[2], line, n, &clamped)
                    : composite_packed(row, &p, s, 1, 1, 0, coc[2], line, n, &clamped);
    else
        done = made ? composite_packed(row, &p, s, 1, 0, 1, coc[2], line, n, &clamped)
                    : composite_packed(row, &p, s, 1, 0, 0, coc[2], line, n, &clamped);
    f->counts->clamped += vi_sum(clamped);
    return done;
}

// ---- rows ----

static struct field_row field_at(const struct hf_buf *b, int c, int x, int y, int next_y)
{
    return (struct field_row){hf_at(b, c, x, y), hf_at(b, c, x, next_y), 0};
}

static void composite_row_simd(const struct hf_frame *f, int y, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const int hy = y / 2, down = y & 1, ny = down ? hy + 1 : hy - 1;
    struct composite_row row = {.blend = s->blend, .down = down};
    if (f->far) {
        row.far = field_at(&f->buf[HF_BUF_FAR_FILL], 0, r.x0, hy, ny);
        row.far.plane = f->buf[HF_BUF_FAR_FILL].ch[1] - f->buf[HF_BUF_FAR_FILL].ch[0];
        row.far_coc = field_at(&f->buf[HF_BUF_COC4], 1, r.x0, hy, ny);
    }
    if (f->near && !NEAR_LINES && !s->bicubic) {
        row.near = field_at(&f->buf[HF_BUF_NEAR_FILL], 0, r.x0, hy, ny);
        row.near.plane = f->buf[HF_BUF_NEAR_FILL].ch[1] - f->buf[HF_BUF_NEAR_FILL].ch[0];
        row.near_coc = field_at(&f->buf[HF_BUF_BLUR], 0, r.x0, hy, ny);
    } else if (f->near) {
        for (int c = 0; c < s->channels; c++)
            near_line(s, &f->buf[HF_BUF_NEAR_FILL], c, y, r, hf_line(f, 12 + c));
        near_line(s, &f->buf[HF_BUF_BLUR], 0, y, r, hf_line(f, 16));
        const float *near = hf_line(f, 12) + 16, *near_coc = hf_line(f, 16) + 16;
        row.near = (struct field_row){near, near, (ptrdiff_t)f->line_floats};
        row.near_coc = (struct field_row){near_coc, near_coc, 0};
    }
    const int done = composite_row_packed(f, &row, y, r);
    if (done < r.x1 - r.x0)
        composite_row_lines(f, &row, y, r, done);
}

static void composite_simd(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height); y++)
        composite_row_simd(f, y, r);
}
