// SPDX-License-Identifier: BSD-3-Clause
// The highlights of a cell: drawn whole, cut by what is nearer (cut.c), and shown as far as the middle stack leaves them open.
#include <math.h>
#include <string.h>

#include "engine/layers/parts.h"

// What the shares of one radius are drawn from.
static struct hf_build build_of(const struct hf_cell *c, int number, const struct hf_layers_square *square)
{
    return (struct hf_build){.s = &c->l->shine[number],
                             .set = &c->samples->seen,
                             .weight = c->samples->share,
                             .channels = c->l->channels + 1,
                             .square = square};
}

// Whether shares of one radius are left out of the slices of a stack, which have less than full resolution.
static int is_of(const struct hf_layers *l, int stack, int number)
{
    const float r = l->shine[number].radius;
    return fabsf(r) >= l->set.half && (r < 0) == (stack == NEAR);
}

// How much of the drawn shares counts in a row of light: what is cut from t, NULL: all. lifted: the rest of their samples
// lies in the middle stack and must not cover them.
static const float *part_of_row(const struct hf_cell *c, const struct hf_layers_cut *t, int lifted, int x0, int n,
                                int y)
{
    const float *cut = t ? t->at + (y >> 1) * t->row + x0 / 2 : NULL, *lift = c->lift + (y >> 1) * c->lift_row + x0 / 2;
    if (t)
        c->k->up(cut, cut + (y & 1 ? t->row : -t->row), n / 2, c->row[0]);
    if (lifted)
        c->k->up(lift, lift + (y & 1 ? c->lift_row : -c->lift_row), n / 2, c->row[1]);
    for (int x = 0; t && lifted && x < n; x++)
        c->row[0][x] *= c->row[1][x];
    return t ? c->row[0] : lifted ? c->row[1] : c->whole;
}

// Clear the light of tiles that have none yet and get some.
static void begin_light(const struct hf_cell *c, int stack)
{
    const struct hf_window *w = &c->light[stack];
    for (int ty = 0; ty < c->rows; ty++)
        for (int tx = 0; tx < c->columns; tx++) {
            uint8_t *lit = hf_layers_map_at(&c->lit[stack], tx, ty);
            if (*lit || !*hf_layers_map_at(&c->shone, tx, ty))
                continue;
            *lit = 1;
            for (int y = ty * TILE; y < (ty + 1) * TILE; y++)
                for (int i = 0; i <= c->l->channels; i++)
                    memset(w->at + y * w->row + i * w->channel + tx * TILE, 0, sizeof(float) * TILE);
        }
}

// Whether a part of the shares of one radius lies in the middle stack, and must not cover the rest.
static int is_lifted(const struct hf_cell *c, int stack, int number)
{
    return stack == FAR && c->covering && number == c->l->slice[c->l->last + 1].shine;
}

// Add the drawn shares of one radius to a stack's light, or subtract what is cut from those of t, which it holds already.
static void add_light(struct hf_cell *c, int stack, int number, struct hf_rect r, const struct hf_layers_cut *t)
{
    const struct hf_window *to = &c->light[stack];
    const int n = r.x1 - r.x0, lifted = is_lifted(c, stack, number);
    for (int y = r.y0; y < r.y1; y++) {
        const float *part = part_of_row(c, t, lifted, r.x0, n, y);
        for (int i = 0; i <= c->l->channels; i++)
            (t ? c->k->dim : c->k->light)(part, c->shine.at + y * c->shine.row + i * c->shine.channel + r.x0, n,
                                          to->at + y * to->row + i * to->channel + r.x0);
    }
}

// Draw shares of one radius in a stack's light. Those that are lifted are drawn by themselves first.
static void draw_light(struct hf_cell *c, int stack, int number)
{
    const struct hf_build b = build_of(c, number, NULL);
    begin_light(c, stack);
    if (!is_lifted(c, stack, number)) {
        hf_layers_draw_slice(c, &b, &c->light[stack]);
        return;
    }
    hf_layers_clear_tiles(c, &c->shone, &c->shine, 0, 0, b.channels);
    hf_layers_draw_slice(c, &b, &c->shine);
    for (int ty = 0; ty < c->rows && !hf_stopped(c->l->stop); ty++)
        for (int tx = 0, end; (end = hf_layers_next_run(&c->shone, &tx, ty, c->columns, 1)) > tx; tx = end)
            add_light(c, stack, number, (struct hf_rect){tx * TILE, ty * TILE, end * TILE, (ty + 1) * TILE}, NULL);
}

void hf_layers_cut_light(struct hf_cell *c, int stack, const struct hf_layers_square *of, const struct hf_layers_cut *t)
{
    const struct hf_layers *l = c->l;
    for (int i = 0; i < l->shines && !hf_stopped(l->stop); i++) {
        const struct hf_slice *s = &l->shine[i];
        int x0, x1;
        if (!is_of(l, stack, i) || s->before >= of->radii.high || of->radii.low >= s->after ||
            !hf_layers_use_tile(c, of->tx, of->ty, i) || !hf_layers_square_span(c, s, of, &x0, &x1))
            continue;
        const struct hf_build b = build_of(c, i, of);
        const int top = of->ty * TILE + of->dy - s->rows, low = top + HF_LAYERS_SQUARE + 2 * s->rows;
        const struct hf_rect r = {hf_max(x0, t->tiles.x0 * TILE), hf_max(top, t->tiles.y0 * TILE),
                                  hf_min(x1, t->tiles.x1 * TILE), hf_min(low, t->tiles.y1 * TILE)};
        if (r.x0 >= r.x1)
            continue;
        for (int y = hf_max(top, 0); y < hf_min(low, c->rows * TILE); y++)
            for (int k = 0; k < b.channels; k++)
                memset(c->shine.at + y * c->shine.row + k * c->shine.channel + x0, 0,
                       sizeof(float) * (size_t)(x1 - x0));
        hf_layers_draw_slice(c, &b, &c->shine);
        add_light(c, stack, i, r, t);
    }
}

// What light behind the focus would cover if nothing were before it: what it covers before lamps are cut.
static void keep_cover(const struct hf_cell *c)
{
    const struct hf_window *w = &c->light[FAR];
    for (int ty = 0; ty < c->rows; ty++)
        for (int tx = 0, end; (end = hf_layers_next_run(&c->lit[FAR], &tx, ty, c->columns, 1)) > tx; tx = end)
            for (int y = ty * TILE; y < (ty + 1) * TILE; y++) {
                float *p = w->at + y * w->row + c->l->channels * w->channel + tx * TILE;
                memcpy(p + w->channel, p, sizeof(float) * (size_t)((end - tx) * TILE));
            }
}

void hf_layers_draw_lights(struct hf_cell *c, int stack)
{
    const struct hf_layers *l = c->l;
    int any = 0;
    for (int i = 0; l->set.highlights && i < l->shines && !hf_stopped(l->stop); i++)
        if (is_of(l, stack, i) && hf_layers_mark_used(c, i, HF_KIND_SHARES) &&
            hf_layers_mark_touched(c, &l->shine[i], &c->shone)) {
            draw_light(c, stack, i);
            any = 1;
        }
    if (any && stack == FAR)
        keep_cover(c);
    if (any)
        hf_layers_cut_lamps(c, stack);
}

// How much of the light behind the focus the middle stack leaves, of what the near stack leaves open: that has cut the light
// already. Where next to nothing is open, the middle stack says nothing.
#define OPEN (1.0f / 64)

static float left_by_middle(float covered, float near)
{
    return 1 - hf_saturate((covered - near) / hf_larger(1 - near, OPEN));
}

const float *hf_layers_light_at(const struct hf_cell *c, int stack, int channel, int x, int y)
{
    const struct hf_window *w = &c->light[stack];
    return w->at + y * w->row + channel * w->channel + x;
}

void hf_layers_add_near_cover(const struct hf_cell *c, int tx, int end, int y, float *out)
{
    const int from = tx;
    for (int to; c->l->set.highlights && (to = hf_layers_next_run(&c->lit[NEAR], &tx, y / TILE, end, 1)) > tx; tx = to)
        c->k->light(c->whole, hf_layers_light_at(c, NEAR, c->l->channels, tx * TILE, y), (to - tx) * TILE,
                    out + (tx - from) * TILE);
}

// How much of the light behind the focus a row of tiles tx to `end` shows.
static void shown(const struct hf_cell *c, int tx, int end, int y, float *part)
{
    const int ty = y / TILE, n = (end - tx) * TILE;
    float *near = c->row[0], *middle = c->row[1];
    memset(near, 0, sizeof(float) * (size_t)n);
    memset(middle, 0, sizeof(float) * (size_t)n);
    for (int i = tx, to; (to = hf_layers_next_run(&c->near, &i, ty, end, 1)) > i; i = to)
        hf_layers_raise(c, NEAR, c->l->channels, i * TILE, (to - i) * TILE, y, near + (i - tx) * TILE);
    for (int i = tx, to; (to = hf_layers_next_run(&c->begun, &i, ty, end, 1)) > i; i = to)
        memcpy(middle + (i - tx) * TILE, hf_layers_stack_at(c, MIDDLE, i * TILE, y).weight,
               sizeof(float) * TILE * (size_t)(to - i));
    hf_layers_add_near_cover(c, tx, end, y, near);
    hf_layers_add_near_cover(c, tx, end, y, middle);
    for (int x = 0; x < n; x++)
        part[x] = left_by_middle(hf_saturate(middle[x]), hf_saturate(near[x]));
}

void hf_layers_light_row(const struct hf_cell *c, int tx, int end, int y, float *const out[6])
{
    const int channels = c->l->channels, n = (end - tx) * TILE,
              lit[2] = {*hf_layers_map_at(&c->lit[NEAR], tx, y / TILE), *hf_layers_map_at(&c->lit[FAR], tx, y / TILE)};
    float *part = c->row[2];
    for (int i = 0; i < 6; i++)
        memset(out[i], 0, sizeof(float) * (size_t)n);
    if (lit[FAR])
        shown(c, tx, end, y, part);
    for (int stack = NEAR; stack <= FAR; stack++)
        for (int i = 0; lit[stack] && i <= channels; i++)
            c->k->light(stack == FAR ? part : c->whole, hf_layers_light_at(c, stack, i, tx * TILE, y), n,
                        out[i < channels ? i : 4]);
    if (lit[FAR])
        c->k->light(c->whole, hf_layers_light_at(c, FAR, channels + 1, tx * TILE, y), n, out[5]);
}
