// SPDX-License-Identifier: BSD-3-Clause
// Highlights of clipped pictures in plain C: the specification of the vector version.
#include "pixel/highlight.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "pixel/pass_c.h"

static float luminance(float r, float g, float b)
{
    const float red = r > 0 ? r : 0, green = g > 0 ? g : 0, blue = b > 0 ? b : 0;
    const float y = (HF_LUMINANCE_R * red + HF_LUMINANCE_G * green) + HF_LUMINANCE_B * blue;
    return y < FLT_MAX ? y : FLT_MAX;
}

void hf_raise_row_c(const struct hf_highlight *h, float *r, float *g, float *b, int n)
{
    float *const rgb[3] = {r, g, b};
    for (int i = 0; i < n; i++) {
        const float m = luminance(r[i], g[i], b[i]);
        if (!(m > h->from))
            continue;
        const float far = (m - h->from) * h->scale, t = far < 1 ? far : 1;
        const float part = (h->more * (t * t)) / m;
        for (int c = 0; c < 3; c++)
            if (rgb[c][i] > 0)
                rgb[c][i] = rgb[c][i] + rgb[c][i] * part;
    }
}

// (-span + sqrt(span^2 + 4 more d)) / (2 more), written without a subtraction of nearly equal numbers.
void hf_lower_row_c(const struct hf_highlight *h, float *r, float *g, float *b, int n)
{
    float *const rgb[3] = {r, g, b};
    const float more4 = 4 * h->more, span2 = h->span * h->span;
    for (int i = 0; i < n; i++) {
        const float most = luminance(r[i], g[i], b[i]);
        if (!(most > h->from))
            continue;
        const float below = most < h->gain ? most : h->gain, d = below - h->from;
        const float far = (d + d) / (h->span + sqrtf(span2 + more4 * d)), t = far < 1 ? far : 1;
        const float m = (h->from + h->span * t) + (most - below), part = m / most;
        for (int c = 0; c < 3; c++)
            if (rgb[c][i] > 0)
                rgb[c][i] = rgb[c][i] * part;
    }
}

// ---- storing an engine's rows ----

enum { LANES = 64 };

// Both rows, even and odd pixels, all channels.
struct block {
    _Alignas(64) float row[2][4][LANES + HF_PAD];
};

static void read_block(const struct hf_frame *f, int x, int y, int n, int raised, struct block *b)
{
    float *even[4], *odd[4];
    for (int c = 0; c < 4; c++) {
        even[c] = b->row[0][c];
        odd[c] = b->row[1][c];
    }
    (raised ? hf_read_colour : hf_read_given)(f, x, y, n, even, odd, f->seen);
}

// A pixel whose three channels all are as they were read is not blurred, and is stored with the picture's own bits. (One
// channel alone may be so by chance, in a maximum for instance: its light still counts in what the others are lowered by.)
static void keep_given(struct block *out, const struct block *given, const struct block *raised,
                       const float *const from[4], int odd, int at, int n)
{
    for (int i = 0; i < n; i++) {
        uint32_t other = 0;
        for (int c = 0; c < 3; c++)
            other |= hf_bits(from[c][at + i]) ^ hf_bits(raised->row[odd][c][i]);
        for (int c = 0; c < 3 && !other; c++)
            out->row[odd][c][i] = given->row[odd][c][i];
    }
}

static void store_block(const struct hf_frame *f, int x, int y, int n, const float *const from[2][4], int at)
{
    struct block given, raised, out;
    const float *rows[2][4];
    read_block(f, x, y, n, 0, &given);
    read_block(f, x, y, n, 1, &raised);
    for (int o = 0; o < 2; o++) {
        for (int c = 0; c < 3; c++)
            memcpy(out.row[o][c], from[o][c] + at, (size_t)n * sizeof(float));
        f->k->lower(&f->s->highlight, out.row[o][0], out.row[o][1], out.row[o][2], n);
        keep_given(&out, &given, &raised, from[o], o, at, n);
        for (int c = 0; c < 3; c++)
            rows[o][c] = out.row[o][c];
        rows[o][3] = from[o][3] ? from[o][3] + at : NULL;
    }
    f->counts->clamped += hf_store_lanes(f, x, y, n, rows[0], rows[1]);
}

void hf_store_colour(const struct hf_frame *f, int x, int y, int n, const float *const even[4],
                     const float *const odd[4])
{
    if (!f->s->highlight.on) {
        f->counts->clamped += hf_store_lanes(f, x, y, n, even, odd);
        return;
    }
    const float *const rows[2][4] = {{even[0], even[1], even[2], even[3]}, {odd[0], odd[1], odd[2], odd[3]}};
    for (int i = 0; i < n; i += LANES)
        store_block(f, x + i, y, hf_min(n - i, LANES), rows, i);
}
