// SPDX-License-Identifier: BSD-3-Clause
// Aperture pictures: the light that falls on each pixel of a given size.
#include <math.h>

#include "engine/layers/shape.h"

enum { LONGEST = 2 };  // parts beyond this ratio of length to width are cut off

static double shorter_of(const struct hf_integral *a)
{
    return a->width < a->height ? a->width : a->height;
}

void hf_shape_frame(struct hf_shape *s, const struct hf_integral *area, double wide)
{
    const double shorter = shorter_of(area);
    const int high = (int)ceil(s->radius * fmin(area->height / shorter, LONGEST) - 0.5);
    s->reach = (int)ceil(s->radius * wide * fmin(area->width / shorter, LONGEST) - 0.5);
    s->reach = s->reach > 0 ? s->reach : 0;
    s->top = high > 0 ? -high : 0;
    s->rows = 1 - 2 * s->top;
}

// Row i of the weights.
static void draw_row(const struct hf_shape *s, const struct hf_integral *t, double wide, int i, float *out)
{
    const double unit = shorter_of(t) / 2 / s->radius, step = unit / wide;
    const double y0 = t->height / 2.0 + (s->top + i - 0.5) * unit, y1 = y0 + unit;
    double from = 0;
    for (int x = 0; x <= 2 * s->reach + 1; x++) {
        const double at = t->width / 2.0 + (x - s->reach - 0.5) * step;
        const double to = hf_integral_at(t, at, y1) - hf_integral_at(t, at, y0);
        // Differences of integrals leave rounding errors where there is nothing.
        const double v = (to - from) / (unit * step);
        if (x)
            out[x - 1] = v > 1e-9 ? (float)v : 0;
        from = to;
    }
}

static void reverse(float *w, int n)
{
    for (int i = 0; i < n / 2; i++) {
        const float v = w[i];
        w[i] = w[n - 1 - i];
        w[n - 1 - i] = v;
    }
}

void hf_shape_draw(struct hf_shape *s, const struct hf_integral *area, double wide, struct hf_shape_row *row,
                   float *weight, int turned)
{
    const int columns = 2 * s->reach + 1, stride = (columns + 15) / 16 * 16;
    s->row = row;
    s->weight = weight;
    s->sum = 0;
    for (int i = 0; i < s->rows; i++) {
        float *w = weight + i * stride;
        int first = 0, last = columns;
        draw_row(s, area, wide, turned ? s->rows - 1 - i : i, w);
        if (turned)
            reverse(w, columns);
        while (first < last && !(w[first] > 0))
            first++;
        while (last > first && !(w[last - 1] > 0))
            last--;
        row[i] = (struct hf_shape_row){i * stride + first, last - first, first - s->reach, 0, 0};
        for (int x = first; x < last; x++)
            s->sum += w[x];
    }
    if (s->sum > 0)
        return;
    // A black picture is drawn as the pixel itself.
    struct hf_shape_row *middle = &row[-s->top];
    *middle = (struct hf_shape_row){-s->top * stride, 1, 0, 0, 0};
    weight[middle->first] = 1;
    s->sum = 1;
}
