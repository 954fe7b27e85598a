// SPDX-License-Identifier: BSD-3-Clause
// The gaussian engine's passes, and their rows in plain C; engine.c says what they compute. Multiply and add are fused
// only where that changes no bit, so the bits are the same on every machine, deterministic or not.
#include "engine/gaussian/kernels.h"

#include <float.h>
#include <math.h>

#include "pixel/pass_c.h"

// 1 4 6 4 1 / 16 is 1 2 1 applied twice. A constant keeps its bits, and mirrored samples give mirrored bits. Doubling
// is exact, so a fused multiply-add changes nothing. Samples are divided first, so nothing overflows.
static float smooth(float a, float b, float c)
{
    return (a + c) + 2 * b;
}

static float five(const float v[5])
{
    const float a = v[0] * 0.0625f, b = v[1] * 0.0625f, c = v[2] * 0.0625f, d = v[3] * 0.0625f, e = v[4] * 0.0625f;
    return smooth(smooth(a, b, c), smooth(b, c, d), smooth(c, d, e));
}

// The printed weights. Halves come first, so that nothing overflows; the weights sum to 1 only within rounding.
static float five_faithful(const float v[5])
{
    const float outer = (v[0] * 0.5f + v[4] * 0.5f) * (2 * 0.3f), inner = (v[1] * 0.5f + v[3] * 0.5f) * (2 * 0.15f);
    const float sum = (outer + inner) + v[2] * 0.1f;
    return sum < FLT_MAX ? sum > -FLT_MAX ? sum : -FLT_MAX : FLT_MAX;
}

void hf_gaussian_line_c(const float *in, int n, float *out, int faithful)
{
    for (int i = 0; i < n; i++)
        out[i] = faithful ? five_faithful(in + i - 2) : five(in + i - 2);
}

void hf_gaussian_columns_c(const float *in, ptrdiff_t in_stride, int rows, int from, int to, float *out,
                           ptrdiff_t out_stride, int n, int faithful)
{
    for (int x = 0; x < n; x++) {
        float v[5];
        for (int i = 0; i < 4; i++)
            v[i + 1] = in[hf_max(0, hf_min(rows - 1, from - 2 + i)) * in_stride + x];
        for (int y = from; y < to; y++) {
            for (int i = 0; i < 4; i++)
                v[i] = v[i + 1];
            // At the last row v[3] repeats; in memory that row may be overwritten already.
            v[4] = y + 2 < rows ? in[(y + 2) * in_stride + x] : v[3];
            out[(y - from) * out_stride + x] = faithful ? five_faithful(v) : five(v);
        }
    }
}

static float shape(const struct hf_setup *s, float t)
{
    return s->smoothstep ? hf_smoothstep(t) : t;
}

static float blend_of(const struct hf_setup *s, float z)
{
    const float t = 3 * __builtin_fabsf(hf_gaussian_depth(hf_gaussian(s), z) - hf_gaussian(s)->focus_d);
    return s->strength * shape(s, t < 1 ? t : 1);
}

void hf_blend_row_c(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts)
{
    const struct hf_setup *s = f->s;
    if (!hf_gaussian(s)->by_depth) {
        struct hf_counts unused = {0};
        f->k->coc_row(f, x, y, n, out, counts ? counts : &unused);
        for (int i = 0; i < n; i++)
            for (int o = 0; o < 2; o++)
                out[o][i] = s->strength * (out[o][i] > out[2 + o][i] ? out[o][i] : out[2 + o][i]);
        return;
    }
    for (int i = 0; i < n; i++)
        for (int o = 0; o < 2; o++) {
            if (2 * (x + i) + o >= s->width) {
                out[o][i] = out[0][i];
                continue;
            }
            const float t = blend_of(s, hf_coc_variable(f, 2 * (x + i) + o, y, counts));
            out[o][i] = t;
            if (counts) {
                counts->far_pixels += t > 0;
                counts->far_groups |= (uint64_t)(t > 0) << hf_group(x + i);
                counts->sharp_pixels += !(t > 0);
            }
        }
}

void hf_gaussian_count_c(const struct hf_frame *f, int x, int y, int n, struct hf_counts *counts)
{
    float *const out[4] = {hf_line(f, 0), hf_line(f, 1), hf_line(f, 2), hf_line(f, 3)};
    hf_gaussian_kernels(f)->blend_row(f, x, y, n, out, counts);
}

void hf_lerp_row_c(float *a, const float *b, const float *t, int n)
{
    for (int i = 0; i < n; i++)
        // The difference of the largest floats of opposite sign is no finite float.
        a[i] = fabsf(b[i] - a[i]) <= FLT_MAX ? hf_lerp(a[i], b[i], t[i]) : (1 - t[i]) * a[i] + t[i] * b[i];
}

// a + w (b - a), computed from halves, because the difference of the largest floats of opposite sign is not finite.
static float between(float a, float b, float w)
{
    return a + 2 * w * (0.5f * b - 0.5f * a);
}

// The even and odd pixels of row y of the frame, bilinearly from a smaller buffer.
void hf_gaussian_up_c(const struct hf_buf *b, int c, int quarter, int x, int y, int n, float *even, float *odd)
{
    const int scale = quarter ? 4 : 2, row = y / scale, phase = y % scale;
    static const float weights[2][4] = {{0.25f, 0.25f}, {0.375f, 0.125f, 0.125f, 0.375f}};
    const float *w = weights[quarter], *own = hf_at(b, c, 0, row);
    const float *next = hf_at(b, c, 0, 2 * phase < scale ? row - 1 : row + 1);
    for (int i = 0; i < n; i++)
        for (int o = 0; o < 2; o++) {
            const int px = 2 * (x + i) + o, column = px / scale, p = px % scale;
            const int side = 2 * p < scale ? column - 1 : column + 1;
            const float a = between(own[column], next[column], w[phase]);
            (o ? odd : even)[i] = between(a, between(own[side], next[side], w[phase]), w[p]);
        }
}

// Sums down the rows first, then across. lines: sums, which become the means; sums of odd pixels; and the pixels that
// are read.
void hf_gaussian_shrink_c(const struct hf_frame *f, int x, int y, int n, float *const lines[16])
{
    const struct hf_setup *s = f->s;
    const int rows = 1 << hf_gaussian(s)->resolution;
    const float share = 1.0f / (float)(rows * rows);
    for (int i = 0; i < rows; i++) {
        hf_read_colour(f, x, hf_min(y * rows + i, s->height - 1), n, lines + 8, lines + 12, f->seen);
        for (int c = 0; c < s->channels; c++)
            for (int k = 0; k < n; k++) {
                const float even = lines[8 + c][k] * share, odd = lines[12 + c][k] * share;
                lines[c][k] = i ? lines[c][k] + even : even;
                lines[4 + c][k] = i ? lines[4 + c][k] + odd : odd;
            }
    }
    for (int c = 0; c < s->channels; c++) {
        for (int k = 0; k < n; k++)
            lines[c][k] += lines[4 + c][k];
        for (int k = 0; 2 * k < n && hf_gaussian(s)->resolution == HF_RESOLUTION_QUARTER; k++)
            lines[c][k] = lines[c][2 * k] + lines[c][hf_min(2 * k + 1, n - 1)];
    }
}

void hf_gaussian_merge_c(const struct hf_frame *f, int y, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const struct hf_buf *blur = hf_gaussian_buf(f, HF_GAUSSIAN_BLUR);
    const int n = r.x1 - r.x0;
    float *lane[2][4], *blend[4], *even = hf_line(f, 12), *odd = hf_line(f, 13);
    for (int i = 0; i < 4; i++) {
        lane[0][i] = hf_line(f, i);
        lane[1][i] = hf_line(f, 4 + i);
        blend[i] = hf_line(f, 8 + i);
    }
    hf_gaussian_kernels(f)->blend_row(f, r.x0, y, n, blend, NULL);
    hf_read_colour(f, r.x0, y, n, lane[0], lane[1], f->counts);
    for (int c = 0; c < s->channels; c++) {
        if (hf_gaussian(s)->resolution == HF_RESOLUTION_FULL)
            f->k->unzip(hf_at(blur, c, 2 * r.x0, y), n, even, odd);
        else
            hf_gaussian_kernels(f)->up(blur, c, hf_gaussian(s)->resolution == HF_RESOLUTION_QUARTER, r.x0, y, n, even,
                                       odd);
        hf_gaussian_kernels(f)->lerp_row(lane[0][c], even, blend[0], n);
        hf_gaussian_kernels(f)->lerp_row(lane[1][c], odd, blend[1], n);
    }
    if (s->channels == 3)
        lane[0][3] = lane[1][3] = NULL;
    hf_store_colour(f, r.x0, y, n, (const float *const *)lane[0], (const float *const *)lane[1]);
}

// ---- passes ----

void hf_gaussian_depth_pass(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++) {
        hf_gaussian_kernels(f)->count_row(f, r.x0, y, r.x1 - r.x0, f->counts);
        hf_count_row(f->counts, y);
    }
}

// Scratch of the first sweep.
struct lines {
    float *colour[16];  // see hf_gaussian_shrink
    float *line[2];     // at the working resolution, with HF_PAD floats before them
};

static struct lines lines_of(const struct hf_frame *f, size_t floats)
{
    struct lines l;
    for (int i = 0; i < 16; i++)
        l.colour[i] = f->work + (size_t)i * floats;
    for (int i = 0; i < 2; i++)
        l.line[i] = f->work + (size_t)(16 + 2 * i) * floats + HF_PAD;
    return l;
}

// Make a line of n pixels from a channel of a row at the working resolution: as it was read, or shrunk.
static void make_line(const struct hf_frame *f, const struct lines *l, int c, int lanes, int n, float *line)
{
    if (hf_gaussian(f->s)->resolution == HF_RESOLUTION_FULL)
        f->k->zip(l->colour[c], l->colour[4 + c], lanes, line);
    else
        memcpy(line, l->colour[c], (size_t)n * sizeof *line);
}

// Run all iterations on the line of n pixels in l->line[0]; out receives `count` pixels from `first` on.
static void blur_line(const struct hf_frame *f, const struct lines *l, int n, int first, int count, float *out)
{
    const int iterations = hf_gaussian(f->s)->iterations;
    // The last iteration writes whole vectors, but a quarter of a chunk need not be whole vectors.
    const int direct = iterations > 0 && hf_gaussian(f->s)->resolution != HF_RESOLUTION_QUARTER;
    for (int i = 0; i < iterations; i++) {
        float *line = l->line[i % 2];
        line[-2] = line[-1] = line[0];
        line[n] = line[n + 1] = line[n - 1];
        if (direct && i == iterations - 1)
            hf_gaussian_kernels(f)->line(line + first, count, out, hf_gaussian(f->s)->faithful);
        else
            hf_gaussian_kernels(f)->line(line, n, l->line[(i + 1) % 2], hf_gaussian(f->s)->faithful);
    }
    if (!direct)
        memcpy(out, l->line[iterations % 2] + first, (size_t)count * sizeof(float));
}

// Run all iterations along the rows of the picture, at the working resolution.
void hf_gaussian_rows_pass(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const int reach = hf_gaussian_halo(s);
    const struct hf_rect read = {hf_max(r.x0 - reach, 0), r.y0, hf_min(r.x1 + reach, s->half_width), r.y1};
    const struct hf_rect in = hf_gaussian_working(s, read), out = hf_gaussian_working(s, r);
    const int lanes = read.x1 - read.x0, n = in.x1 - in.x0;
    struct lines l = lines_of(f, hf_gaussian_line_floats(s, r.x1 - r.x0));
    for (int y = out.y0; y < out.y1 && !hf_stopped(f->s->stop); y++) {
        if (hf_gaussian(s)->resolution == HF_RESOLUTION_FULL)
            hf_read_colour(f, read.x0, y, lanes, l.colour, l.colour + 4, f->seen);
        else
            hf_gaussian_kernels(f)->shrink(f, read.x0, y, lanes, l.colour);
        for (int c = 0; c < s->channels; c++) {
            make_line(f, &l, c, lanes, n, l.line[0]);
            blur_line(f, &l, n, out.x0 - in.x0, out.x1 - out.x0,
                      hf_at(hf_gaussian_buf(f, HF_GAUSSIAN_ROWS), c, out.x0, y));
        }
    }
}

// Run all iterations down a strip of columns of channel c, rows r.y0 to r.y1.
static void blur_strip(const struct hf_frame *f, int c, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const struct hf_buf *in = hf_gaussian_buf(f, HF_GAUSSIAN_ROWS), *out = hf_gaussian_buf(f, HF_GAUSSIAN_BLUR);
    const int columns = r.x1 - r.x0, n = hf_gaussian(s)->iterations,
              height = hf_gaussian_size(s, s->height, s->half_height);
    const int top = hf_max(r.y0 - hf_gaussian_reach(s), 0);
    const float *from = hf_at(in, c, r.x0, 0);
    ptrdiff_t stride = in->stride;
    if (n == 0)
        for (int y = r.y0; y < r.y1; y++)
            memcpy(hf_at(out, c, r.x0, y), from + y * stride, (size_t)columns * sizeof(float));
    for (int i = 1; i <= n; i++) {
        // Each iteration makes only the rows that the later ones read.
        const int a = hf_max(r.y0 - 2 * (n - i), 0), b = hf_min(r.y1 + 2 * (n - i), height);
        float *to = i == n ? hf_at(out, c, r.x0, a) : f->work + (ptrdiff_t)(a - top) * HF_GAUSSIAN_STRIP;
        const ptrdiff_t to_stride = i == n ? out->stride : HF_GAUSSIAN_STRIP;
        hf_gaussian_kernels(f)->columns(from, stride, height, a, b, to, to_stride, columns, hf_gaussian(s)->faithful);
        from = f->work - (ptrdiff_t)top * HF_GAUSSIAN_STRIP;
        stride = HF_GAUSSIAN_STRIP;
    }
}

// Run all iterations down the columns.
void hf_gaussian_columns_pass(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_rect w = hf_gaussian_working(f->s, r);
    for (int c = 0; c < f->s->channels; c++)
        for (int x = w.x0; x < w.x1 && !hf_stopped(f->s->stop); x += HF_GAUSSIAN_STRIP)
            blur_strip(f, c, (struct hf_rect){x, w.y0, hf_min(x + HF_GAUSSIAN_STRIP, w.x1), w.y1});
}

void hf_gaussian_merge_pass(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++)
        hf_gaussian_kernels(f)->merge(f, y, r);
}
