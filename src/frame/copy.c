// SPDX-License-Identifier: BSD-3-Clause
#include "frame/copy.h"

#include "pixel/pass_c.h"
#include "pixel/repair.h"
#include "pixel/unorm.h"

struct hf_copy hf_copy_plan(const struct hf_setup *s, const struct hf_image *dst, const struct hf_image *src)
{
    const int alike = dst->format == src->format && dst->transfer == src->transfer &&
                      hf_image_channels(dst) == hf_image_channels(src);
    return (struct hf_copy){.in_place = dst->data[0] == src->data[0],
                            .alike = alike,
                            .raw = alike && (s->storage == HF_STORAGE_FLOAT || src->format == HF_FORMAT_R11G11B10F ||
                                             (s->storage == HF_STORAGE_HALF && src->format == HF_FORMAT_RGBA16F))};
}

// The first byte of a rectangle's row in one plane.
static uint8_t *pixels_at(const struct hf_image *m, int plane, int x, int y)
{
    return (uint8_t *)m->data[plane] + (ptrdiff_t)y * m->stride[plane] + hf_row_bytes(m->format, x);
}

// Whether a row is finite; it is copied to dst if that is given.
static int row_finite(const struct hf_frame *f, int x, int y, int n, const struct hf_image *dst)
{
    const struct hf_image *m = f->src;
    hf_finite *finite = hf_unorm(m->format)                 ? f->k->finite_any
                        : m->format == HF_FORMAT_RGBA16F    ? f->k->finite_f16
                        : m->format == HF_FORMAT_R11G11B10F ? f->k->finite_r11
                                                            : f->k->finite_f32;
    const size_t words = hf_row_bytes(m->format, n) / (m->format == HF_FORMAT_RGBA16F ? 2 : 4);
    for (int p = 0; p < hf_plane_count(m); p++)
        if (!finite(pixels_at(m, p, x, y), words, dst ? pixels_at(dst, p, x, y) : NULL))
            return 0;
    return 1;
}

// Bytes without meaning become 255 in all tiles, because the output must not depend on which tiles are sharp.
static void fill_x(const struct hf_image *m, int x, int y, int n)
{
    if (m->format != HF_FORMAT_RGBX8 && m->format != HF_FORMAT_BGRX8)
        return;
    uint8_t *row = pixels_at(m, 0, x, y);
    for (int i = 0; i < n; i++)
        row[4 * i + 3] = 255;
}

// The part of a rectangle of half-resolution pixels that lies in the region, in full-resolution pixels.
static struct hf_rect in_region(const struct hf_setup *s, struct hf_rect r)
{
    return (struct hf_rect){hf_max(2 * r.x0, s->region.x0), hf_max(2 * r.y0, s->region.y0),
                            hf_min(2 * r.x1, s->region.x1), hf_min(2 * r.y1, s->region.y1)};
}

void hf_copy_scan(struct hf_worker *w, struct hf_rect r)
{
    const struct hf_setup *s = w->frame.s;
    const struct hf_rect p = in_region(s, r);
    for (int y = p.y0; p.x0 < p.x1 && y < p.y1 && !hf_stopped(s->stop); y++)
        w->seen.colour_repaired += !row_finite(&w->frame, p.x0, y, p.x1 - p.x0, NULL);
}

void hf_copy_sharp(const struct hf_copy *copy, struct hf_worker *w, struct hf_rect r)
{
    const struct hf_frame *f = &w->frame;
    const struct hf_rect p = in_region(f->s, r);
    const int first = p.x0 / 2, lanes = (p.x1 + 1) / 2 - first;
    if (p.x0 >= p.x1)
        return;
    float *even[4], *odd[4];
    for (int c = 0; c < 4; c++) {
        even[c] = hf_line(f, c);
        odd[c] = hf_line(f, 4 + c);
    }
    for (int y = p.y0; y < p.y1 && !hf_stopped(f->s->stop); y++) {
        // In place, the pixels were checked, and repaired if necessary, after the first sweep.
        if (copy->raw && (copy->in_place || row_finite(f, p.x0, y, p.x1 - p.x0, f->dst))) {
            fill_x(f->dst, p.x0, y, p.x1 - p.x0);
            continue;
        }
        float *const *alpha = hf_image_channels(f->src) == 4 ? even : NULL;
        hf_read_given(f, first, y, lanes, even, odd, &w->counts);
        const float *const e[4] = {even[0], even[1], even[2], alpha ? even[3] : NULL};
        const float *const o[4] = {odd[0], odd[1], odd[2], alpha ? odd[3] : NULL};
        w->counts.clamped += hf_store_lanes(f, first, y, lanes, e, o);
    }
}

static int seen_bad(const struct hf_context *c)
{
    uint64_t n = 0;
    for (int i = 0; i < c->threads; i++)
        n += c->workers[i].seen.colour_repaired;
    return n != 0;
}

// All repairs of the region, some rows at a time: at most max of them are written to list. Returns how many there are.
static size_t list_repairs(const struct hf_context *c, struct hf_repair *list, size_t max)
{
    enum { ROWS = 4 };
    const struct hf_frame *f = &c->workers[0].frame;
    size_t n = 0;
    const struct hf_rect r = f->s->region;
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y += ROWS) {
        const struct hf_rect rows = {r.x0, y, r.x1, hf_min(y + ROWS, r.y1)};
        n += hf_repair_list(f->src, rows, list ? list + n : NULL, list ? max - n : 0);
    }
    return n;
}

static int write_repairs(struct hf_context *c)
{
    const struct hf_image *m = c->workers[0].frame.src;
    const size_t n = list_repairs(c, NULL, 0);
    const int err = hf_block_grow(&c->repairs, n * sizeof(struct hf_repair), &c->mem);
    if (err)
        return err;
    struct hf_repair *list = c->repairs.data;
    list_repairs(c, list, n);
    if (hf_stopped(&c->stop))
        return HF_ERR_CANCELLED;
    for (size_t i = 0; i < n; i++)
        hf_put_sample(m, list[i].channel, list[i].x, list[i].y, list[i].value);
    c->workers[0].counts.colour_repaired += n;
    return HF_OK;
}

int hf_copy_repair(struct hf_context *c)
{
    const int err = seen_bad(c) ? write_repairs(c) : HF_OK;
    for (int i = 0; i < c->threads; i++)
        c->workers[i].frame.repaired = !err;
    return err;
}
