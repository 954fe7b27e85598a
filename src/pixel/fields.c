// SPDX-License-Identifier: BSD-3-Clause
#include "pixel/fields.h"

#include "pixel/limits.h"

int hf_fields_channels(const struct hf_setup *s, int buf)
{
    switch (buf) {
    case HF_BUF_COC:
        return 4;
    case HF_BUF_COC4:
    case HF_BUF_SUM:
        return 2;
    case HF_BUF_MAX_X:
    case HF_BUF_MAX:
    case HF_BUF_BLUR_X:
    case HF_BUF_BLUR:
        return 1;
    default:
        return s->channels;
    }
}

struct hf_reach hf_fields_halo(const struct hf_setup *s, int halo)
{
    const struct hf_fields *g = hf_fields(s);
    switch (halo) {
    case HF_HALO_MAX_X:
        return (struct hf_reach){g->max_x, 0};
    case HF_HALO_MAX_Y:
        return (struct hf_reach){0, g->max_y};
    case HF_HALO_BLUR_X:
        return (struct hf_reach){g->blur_x, 0};
    case HF_HALO_BLUR_Y:
        return (struct hf_reach){0, g->blur_y};
    case HF_HALO_UPSAMPLE:
        return g->bicubic ? (struct hf_reach){2, 2} : (struct hf_reach){1, 1};
    default:
        return (struct hf_reach){0, 0};
    }
}

void hf_fields_limit(struct hf_settings *r)
{
    if (r->limit == HF_LIMIT_GIVEN)
        return;
    r->limit = r->limit == HF_LIMIT_NONE ? HF_LIMIT_ENGINE : r->limit;
    r->params.max_radius =
        r->limit == HF_LIMIT_ENGINE ? HF_FIELDS_RADIUS : hf_model_radius(r->params.view.display_height);
}

void hf_fields_wait(struct hf_fields *g, struct hf_setup *s)
{
    g->smoothstep = s->smoothstep;
    g->storage = s->storage;
    s->smoothstep = 0;
    s->storage = HF_STORAGE_FLOAT;
    g->max_x = g->max_y = g->blur_x = g->blur_y = 0;
}

void hf_fields_found(const struct hf_setup *s, const struct hf_counts *found, float radius[2])
{
    radius[0] = __builtin_fmaxf(s->max_radius * found->near_max, 1);
    radius[1] = __builtin_fmaxf(s->max_radius * found->far_max, 1);
}

void hf_fields_scale(const struct hf_fields *g, struct hf_setup *s, const float radius[2])
{
    s->near_i *= s->max_radius / radius[0];
    s->far_i *= s->max_radius / radius[1];
    s->smoothstep = g->smoothstep;
    s->storage = g->storage;
}

// Most of most pictures is sharp or has been looked at before: two comparisons a pixel say so.
static int is_sharp(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++)
        if (!f->k->sharp_row(f, r.x0, y, r.x1 - r.x0))
            return 0;
    return 1;
}

// CoC generation: near and far CoC of every pixel of a chunk, in even and odd lanes. r in half-resolution pixels: the rows
// 2y and 2y + 1 of each.
void hf_coc_pass(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_buf *b = &f->buf[HF_BUF_COC];
    if (f->looking && is_sharp(f, r)) {
        f->counts->sharp_pixels += (uint64_t)(hf_min(2 * r.x1, f->s->width) - 2 * r.x0) *
                                   (uint64_t)(hf_min(2 * r.y1, f->s->height) - 2 * r.y0);
        return;
    }
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++) {
        float *const out[4] = {hf_at(b, 0, r.x0, y), hf_at(b, 1, r.x0, y), hf_at(b, 2, r.x0, y), hf_at(b, 3, r.x0, y)};
        f->k->coc_row(f, r.x0, y, r.x1 - r.x0, out, f->counts);
        hf_count_row(f->counts, y);
    }
}

void hf_max_x(const struct hf_frame *f, struct hf_rect r)
{
    f->k->fields.max_x(f, r);
}

void hf_max_y(const struct hf_frame *f, struct hf_rect r)
{
    f->k->fields.max_y(f, r);
}

void hf_blur_x(const struct hf_frame *f, struct hf_rect r)
{
    f->k->fields.blur_x(f, r);
}

void hf_blur_y(const struct hf_frame *f, struct hf_rect r)
{
    f->k->fields.blur_y(f, r);
}

float hf_upsample(const struct hf_buf *b, int c, struct hf_phase p)
{
    const float v = 3 * *hf_at(b, c, p.x, p.y) + *hf_at(b, c, p.nx, p.y);
    const float w = 3 * *hf_at(b, c, p.x, p.ny) + *hf_at(b, c, p.nx, p.ny);
    return 3 * v + w;
}

static float cubic(float own, float neighbour, float other, float behind)
{
    return own + ((CUBIC_NEIGHBOUR * (neighbour - own) + CUBIC_OTHER * (other - own)) + CUBIC_BEHIND * (behind - own));
}

float hf_upsample_cubic(const struct hf_buf *b, int c, struct hf_phase p)
{
    const int dx = p.nx - p.x, dy = p.ny - p.y;
    const int columns[4] = {p.x, p.nx, p.x - dx, p.nx + dx};
    float v[4];
    for (int i = 0; i < 4; i++)
        v[i] = cubic(*hf_at(b, c, columns[i], p.y), *hf_at(b, c, columns[i], p.ny), *hf_at(b, c, columns[i], p.y - dy),
                     *hf_at(b, c, columns[i], p.ny + dy));
    return cubic(v[0], v[1], v[2], v[3]);
}

static void composite_row(const struct hf_frame *f, int y, struct hf_rect r, hf_blend_far *far, hf_blend_near *near)
{
    const int n = r.x1 - r.x0, ny = y & 1 ? y / 2 + 1 : y / 2 - 1;
    float *lane[2][4], *coc[4];
    for (int i = 0; i < 4; i++) {
        lane[0][i] = hf_line(f, i);
        lane[1][i] = hf_line(f, 4 + i);
        coc[i] = hf_line(f, 8 + i);
    }
    hf_read_colour(f, r.x0, y, n, lane[0], lane[1], f->counts);
    if (f->far)
        f->k->coc_row(f, r.x0, y, n, coc, NULL);
    for (int odd = 0; odd < 2; odd++) {
        for (int i = 0; i < n; i++) {
            const int x = r.x0 + i;
            const struct hf_phase p = {x, y / 2, odd ? x + 1 : x - 1, ny};
            if (f->far)
                far(f, p, coc[2 + odd][i], lane[odd], i);
            if (f->near)
                near(f, p, lane[odd], i);
        }
        hf_store_rgb(f, lane[odd], n);
    }
    if (f->s->channels == 3)
        lane[0][3] = lane[1][3] = NULL;
    hf_store_colour(f, r.x0, y, n, (const float *const *)lane[0], (const float *const *)lane[1]);
}

void hf_composite_with(const struct hf_frame *f, struct hf_rect r, hf_blend_far *far, hf_blend_near *near)
{
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++)
        composite_row(f, y, r, far, near);
}
