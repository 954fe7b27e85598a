// SPDX-License-Identifier: BSD-3-Clause
#include "pixel/repair.h"

#include "pixel/pass_c.h"

static float repaired(const struct hf_image *m, int c, int x, int y)
{
    double sum = 0;  // the sum of eight floats cannot overflow it
    int n = 0;
    for (int v = hf_max(y - 1, 0); v <= hf_min(y + 1, m->height - 1); v++)
        for (int u = hf_max(x - 1, 0); u <= hf_min(x + 1, m->width - 1); u++) {
            const float t = hf_sample(m, c, u, v);
            if (hf_is_finite(t)) {
                sum += t;
                n++;
            }
        }
    return hf_round_to_format(m->format, c, n ? (float)(sum / n) : 0);
}

// Repair n lanes that were loaded from lane x of row y. Returns the number of repaired samples.
static uint64_t repair_row(const struct hf_image *m, int x, int y, int n, float *const even[4], float *const odd[4])
{
    uint64_t count = 0;
    for (int c = 0; c < hf_image_channels(m); c++)
        for (int i = 0; i < n; i++)
            for (int o = 0; o < 2; o++) {
                float *v = o ? &odd[c][i] : &even[c][i];
                const int px = hf_min(2 * (x + i) + o, m->width - 1);
                // Vector loaders may return a sample that is not finite as any number beyond the small formats' range.
                const float t = hf_sample(m, c, px, y);
                if (hf_is_finite(t))
                    continue;
                *v = repaired(m, c, px, y);
                count += px == 2 * (x + i) + o;
            }
    return count;
}

size_t hf_repair_list(const struct hf_image *m, struct hf_rect r, struct hf_repair *list, size_t max)
{
    size_t count = 0;
    for (int y = r.y0; y < r.y1; y++)
        for (int x = r.x0; x < r.x1; x++)
            for (int c = 0; c < hf_image_channels(m); c++) {
                if (hf_is_finite(hf_sample(m, c, x, y)))
                    continue;
                if (count < max)
                    list[count] = (struct hf_repair){x, y, c, repaired(m, c, x, y)};
                count++;
            }
    return count;
}

static void load_row(const struct hf_frame *f, int x, int y, int n, float *const even[4], float *const odd[4],
                     struct hf_counts *counts)
{
    if (f->k->load[f->src->format](f->src, x, y, n, even, odd)) {
        const uint64_t repairs = repair_row(f->src, x, y, n, even, odd);
        if (counts)
            counts->colour_repaired += repairs;
    }
}

// Round to what the storage holds.
static void round_row(const struct hf_frame *f, int n, float *const even[4], float *const odd[4])
{
    if (f->s->storage == HF_STORAGE_PACKED && f->src->format != HF_FORMAT_R11G11B10F) {
        f->k->truncate_r11(even[0], even[1], even[2], n);
        f->k->truncate_r11(odd[0], odd[1], odd[2], n);
    } else if (f->s->storage == HF_STORAGE_HALF && f->src->format != HF_FORMAT_RGBA16F &&
               f->src->format != HF_FORMAT_R11G11B10F) {
        for (int c = 0; c < f->s->channels; c++) {
            f->k->round_half(even[c], n);
            f->k->round_half(odd[c], n);
        }
    }
}

void hf_read_colour(const struct hf_frame *f, int x, int y, int n, float *const even[4], float *const odd[4],
                    struct hf_counts *counts)
{
    load_row(f, x, y, n, even, odd, counts);
    if (f->s->highlight.on) {
        f->k->raise(&f->s->highlight, even[0], even[1], even[2], n);
        f->k->raise(&f->s->highlight, odd[0], odd[1], odd[2], n);
    }
    round_row(f, n, even, odd);
}

void hf_read_given(const struct hf_frame *f, int x, int y, int n, float *const even[4], float *const odd[4],
                   struct hf_counts *counts)
{
    load_row(f, x, y, n, even, odd, counts);
    round_row(f, n, even, odd);
}
