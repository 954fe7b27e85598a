// SPDX-License-Identifier: BSD-3-Clause
// CoC as a signed radius in full-resolution pixels, negative in front of the focus, for all engines except the gather.
#include <math.h>

#include "pixel/pass_c.h"

static float radius_of(const struct hf_setup *s, float v)
{
    float r;
    if (s->radius_k > 0) {
        r = (v - s->radius_0) * s->radius_k;
        r = r > -s->max_radius ? r : -s->max_radius;
        r = r < s->max_radius ? r : s->max_radius;
    } else {
        const float n = hf_ramp(s, (s->near_0 - v) * s->near_i);
        const float f = hf_ramp(s, (v - s->far_0) * s->far_i);
        r = (s->strength * s->max_radius) * (f - n);
    }
    if (s->uniform)
        r = s->max_radius;
    return fabsf(r) > s->sharp_radius ? r : 0;
}

void hf_radius_row_c(const struct hf_frame *f, int x, int y, int n, float *out, struct hf_counts *counts)
{
    for (int i = 0; i < n; i++) {
        const float r = radius_of(f->s, hf_coc_variable(f, x + i, y, counts));
        out[i] = r;
        if (!counts)
            continue;
        counts->near_groups |= (uint64_t)(r < 0) << hf_group((x + i) / 2);
        counts->far_groups |= (uint64_t)(r > 0) << hf_group((x + i) / 2);
        counts->near_pixels += r < 0;
        counts->far_pixels += r > 0;
        counts->sharp_pixels += r == 0;
        counts->radius_min = r < counts->radius_min ? r : counts->radius_min;
        counts->radius_max = r > counts->radius_max ? r : counts->radius_max;
    }
}

void hf_radius_pass(const struct hf_frame *f, struct hf_rect r)
{
    const int x0 = 2 * r.x0, x1 = hf_min(2 * r.x1, f->s->width);
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++) {
        f->k->radius_row(f, x0, y, x1 - x0, hf_line(f, 0), f->counts);
        hf_count_row(f->counts, y);
    }
}

void hf_zip_row_c(const float *even, const float *odd, int n, float *out)
{
    for (int i = 0; i < n; i++) {
        out[2 * i] = even[i];
        out[2 * i + 1] = odd[i];
    }
}

void hf_unzip_row_c(const float *in, int n, float *even, float *odd)
{
    for (int i = 0; i < n; i++) {
        even[i] = in[2 * i];
        odd[i] = in[2 * i + 1];
    }
}

void hf_read_pixels(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts)
{
    float *even[4], *odd[4];
    for (int c = 0; c < 4; c++) {
        even[c] = hf_line(f, c);
        odd[c] = hf_line(f, 4 + c);
    }
    hf_read_colour(f, x, y, n, even, odd, counts);
    for (int c = 0; c < f->s->channels; c++)
        f->k->zip(even[c], odd[c], n, out[c]);
}

void hf_write_pixels(const struct hf_frame *f, int x, int y, int n, const float *const in[4], int alpha)
{
    float *even[4], *odd[4];
    const float *e[4] = {NULL}, *o[4] = {NULL};
    for (int c = 0; c < 3 + alpha; c++) {
        even[c] = hf_line(f, c);
        odd[c] = hf_line(f, 4 + c);
        f->k->unzip(in[c], n, even[c], odd[c]);
        e[c] = even[c];
        o[c] = odd[c];
    }
    hf_store_colour(f, x, y, n, e, o);
}
