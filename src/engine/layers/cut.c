// SPDX-License-Identifier: BSD-3-Clause
// What lies before lamps cuts their discs.
//
// A lamp is small, so its rays pass what lies before it at one place for each point of its disc. From pixel x, the ray to a
// lamp at p of radius R meets a sample of radius r < R at x + (p - x) r / R: a blurred edge before a lamp leaves a sharp
// edge in the lamp's disc. That is looked up in the coverage of each slice, at the resolution of the disc. What is in
// focus, or nearly so, cuts at its own place and is left to the middle stack, which has full resolution.
#include <math.h>
#include <string.h>

#include "engine/layers/parts.h"
#include "pixel/edges.h"

enum {
    SQUARE = HF_LAYERS_SQUARE,
    SQUARES = 4,  // of a tile
    MOST = 256    // lamps that are looked at together
};

// A lamp is what is bright in a square, and all of it is cut alike.
struct lamp {
    struct hf_layers_square of;
    float x, y, radius;        // x, y: in pixels from its tile's corner, so that no cell rounds them otherwise
    float reach;               // how far its disc goes
    struct hf_layers_cut cut;  // `tiles`: those that its disc reaches
    struct hf_rect passed;     // the tiles in which its rays pass the slice that is looked at
    int any;                   // whether something is cut
};

// The coverage of a slice, around the cell.
struct cover {
    float *at;
    struct hf_rect tiles;
    int columns, rows;
    int *first, *end;  // of each row: where something is
};

// ---- what covers ----

// Set the size of the coverage of a slice.
static void shape_cover(const struct hf_cell *c, const struct hf_slice *s, struct hf_rect tiles, struct cover *p)
{
    const int size = TILE >> s->level;
    p->tiles = tiles;
    p->columns = (tiles.x1 - tiles.x0) * size;
    p->rows = (tiles.y1 - tiles.y0) * size;
    p->at = c->cover;
    p->first = (int *)(c->cover + (ptrdiff_t)p->columns * p->rows);
    p->end = p->first + p->rows;
}

size_t hf_layers_cover_floats(const struct hf_cell *c)
{
    const struct hf_layers *l = c->l;
    size_t most = 0;
    for (int i = 0; l->set.highlights && i < l->slices; i++) {
        const struct hf_slice *s = &l->slice[i];
        const int n = 2 * hf_layers_tiles_around(s), size = TILE >> s->level;
        const size_t floats = (size_t)(hf_min(c->columns + n, l->columns + 2) * size + 2) *
                              (size_t)(hf_min(c->rows + n, l->rows + 2) * size);
        most = s->level && floats > most ? floats : most;
    }
    return most;
}

struct taker {
    const struct cover *to;
    int channels, x0, y0;  // the first pixel of the coverage
};

static void take_row(void *cookie, const float *in, ptrdiff_t channel, int x, int y, int n)
{
    const struct taker *t = cookie;
    const struct cover *p = t->to;
    const int from = hf_max(x, t->x0), end = hf_min(x + n, t->x0 + p->columns);
    const int row = y - t->y0;
    float *out = p->at + (ptrdiff_t)row * p->columns;
    for (int i = from; i < end; i++)
        out[i - t->x0] += in[t->channels * channel + i - x];
    p->first[row] = hf_min(from - t->x0, p->first[row]);
    p->end[row] = hf_max(end - t->x0, p->end[row]);
}

// What rays pass: a tile that may matter, and one that has samples.
enum { WANTED = 1, HELD = 2 };

// Leave out used tiles that no ray passes, and note the others. Returns 0 if there are none.
static int keep_passed(const struct hf_cell *c, struct hf_rect r)
{
    uint8_t any = 0;
    for (int ty = r.y0; ty < r.y1; ty++)
        for (int tx = r.x0; tx < r.x1; tx++) {
            uint8_t *used = hf_layers_map_at(&c->used, tx, ty), *passed = hf_layers_map_at(&c->passed, tx, ty);
            *used = *passed & WANTED ? *used : 0;
            *passed |= *used ? HELD : 0;
            any |= *used;
        }
    return any;
}

// Take the weights of a slice's samples of a kind where rays pass. any: whether something is there already.
static int take_weights(struct hf_cell *c, int i, enum hf_kind kind, const struct cover *p, int any)
{
    const struct hf_layers *l = c->l;
    const int hidden = kind == HF_KIND_HIDDEN, quads = hidden && !l->known;
    const struct hf_samples *samples = c->samples;
    const struct hf_slice *of = hf_layers_table(l, kind) + i;
    const struct hf_layers_set *set = hidden ? &samples->hidden : &samples->seen;
    if (!hf_layers_mark_used(c, i, kind))
        return any;
    c->box = (struct hf_rect){hf_max(c->box.x0, p->tiles.x0), hf_max(c->box.y0, p->tiles.y0),
                              hf_min(c->box.x1, p->tiles.x1), hf_min(c->box.y1, p->tiles.y1)};
    if (!keep_passed(c, c->box))
        return any;
    for (int y = 0; !any && y < p->rows; y++) {
        p->first[y] = p->columns;
        p->end[y] = 0;
    }
    if (!any)
        memset(p->at, 0, sizeof(float) * (size_t)p->columns * (size_t)p->rows);
    struct hf_slice s = *of;
    s.level = c->l->slice[i].level;
    s.scale = 1 / (float)(1 << 2 * (s.level - quads));
    const struct hf_build b = {.s = &s,
                               .set = set,
                               .weight = set->weight,
                               .finest = quads,
                               .first = l->channels,
                               .channels = l->channels + 1,
                               .more = hidden ? &samples->beyond : &samples->mixed};
    struct taker to = {
        .to = p, .channels = l->channels, .x0 = p->tiles.x0 * (TILE >> s.level), .y0 = p->tiles.y0 * (TILE >> s.level)};
    hf_layers_take_sources(c, &b, take_row, &to);
    return 1;
}

// ---- what is cut ----

// How far slices lie apart.
static float apart_at(const struct hf_layers *l, float radius)
{
    return hf_larger(l->set.spacing, fabsf(radius) * (1.0f / 32));
}

// How far the disc of a lamp goes that is `size` pixels wide and high: it is drawn with the radius of a slice, pictures of
// the aperture have corners outside a disc, and upsampling goes 3 pixels farther.
static float reach_of(const struct hf_layers *l, float radius, float size)
{
    const float r = fabsf(radius) + apart_at(l, radius);
    return r * (1 + fabsf(l->chromatic)) * (l->key.picture ? 1.42f : 1) + 1.42f * size + 3;
}

// What is bright in a square of the frame, as far as it lies on the stack's side of the focus; (x0, y0) is its first sample.
// Returns 0 if nothing is.
static int find_bright(const struct hf_cell *c, int stack, int x0, int y0, struct lamp *lamp)
{
    const struct hf_layers_set *s = &c->samples->seen;
    static const float none[SQUARE] = {0};
    struct hf_layers_range radii = {HUGE_VALF, -HUGE_VALF};
    float sum_x = 0, sum_y = 0, sum_radius = 0, all = 0;
    int left = SQUARE, right = 0, top = SQUARE, low = 0;
    for (int y = 0; y < SQUARE; y++) {
        const float *shares = c->samples->share + (y0 + y) * s->stride + x0;
        if (!memcmp(shares, none, sizeof none))
            continue;
        for (int x = 0; x < SQUARE; x++) {
            const ptrdiff_t at = (y0 + y) * s->stride + x0 + x;
            const float share = shares[x], r = s->radius[at];
            if (!(share > 0) || (r < 0) != (stack == NEAR))
                continue;
            // Less than the largest float, whatever is summed up.
            const float light = share * (s->colour[0][at] + s->colour[1][at] + s->colour[2][at]) * 0x1p-20f;
            sum_x += light * (float)x;
            sum_y += light * (float)y;
            sum_radius += light * r;
            all += light;
            radii = (struct hf_layers_range){r < radii.low ? r : radii.low, hf_larger(r, radii.high)};
            left = hf_min(x, left);
            right = hf_max(x, right);
            top = hf_min(y, top);
            low = y;
        }
    }
    if (!(all > 0))
        return 0;
    const float one = 1 / all, most = hf_larger(fabsf(radii.low), fabsf(radii.high));
    *lamp = (struct lamp){.x = sum_x * one + 0.5f,
                          .y = sum_y * one + 0.5f,
                          .radius = sum_radius * one,
                          .reach = reach_of(c->l, most, (float)(hf_max(right - left, low - top) + 1)),
                          .of.radii = radii};
    return 1;
}

static int tile_of(float x)
{
    return (int)floorf(x * (1.0f / TILE));
}

// The lamp of a square of tile (tx, ty). Returns 0 if there is none whose disc reaches the cell.
static int find_lamp(const struct hf_cell *c, int stack, int tx, int ty, int square, struct lamp *p)
{
    const struct hf_rect around = hf_layers_tiles_with_samples(c);
    const int dx = square % 2 * SQUARE, dy = square / 2 * SQUARE;
    if (!find_bright(c, stack, c->x0 + hf_layers_within(tx, around.x0, around.x1) * TILE + dx,
                     c->y0 + hf_layers_within(ty, around.y0, around.y1) * TILE + dy, p))
        return 0;
    p->of.tx = tx;
    p->of.ty = ty;
    p->of.dx = dx;
    p->of.dy = dy;
    p->x += (float)dx;
    p->y += (float)dy;
    const float high = p->reach + 1, wide = high * hf_larger(c->l->wide, 1), x = p->x + (float)(tx * TILE),
                y = p->y + (float)(ty * TILE);
    const struct hf_rect r = {hf_max(tile_of(x - wide), 0), hf_max(tile_of(y - high), 0),
                              hf_min(tile_of(x + wide) + 1, c->columns), hf_min(tile_of(y + high) + 1, c->rows)};
    p->cut.tiles = r;
    p->cut.row = (r.x1 - r.x0) * TILE / 2 + 2;
    return r.x0 < r.x1 && r.y0 < r.y1;
}

// How far a slice lies before a lamp: not at all if they may belong to one surface.
static float is_before(const struct hf_layers *l, const struct lamp *p, const struct hf_slice *s)
{
    return hf_saturate((p->radius - s->radius) / (2 * apart_at(l, p->radius)) - 0.5f);
}

// A lamp and a slice before it. All places are counted from the corner of the lamp's tile.
struct passing {
    const struct lamp *lamp;
    float part, wide, high;  // a ray passes this part of the way from its pixel to the lamp, and at most so far from it
    float size, much;        // samples of the coverage for a pixel; how much the lamp counts
    hf_layers_passed *passed;
    float *line;  // scratch
    const struct cover *by;
    int x0, y0;  // the first sample of the coverage
};

// Where a ray from pixel x of half resolution to a lamp passes, in samples of the coverage.
static float passes_at(int x, float lamp, float part, float most, float size)
{
    const float at = 2 * (float)x + 1;
    return (at + hf_edges_between(part * (lamp - at), -most, most)) * size - 0.5f;
}

// floorf() without a call.
static int whole_of(float v)
{
    const int i = (int)v;
    return i - (v < (float)i);
}

void hf_layers_dim_c(const float *part, const float *in, int n, float *out)
{
    for (int x = 0; x < n; x++) {
        const float left = out[x] - part[x] * in[x] * HF_LAYERS_DIM_MORE;
        out[x] = out[x] < 0 ? -hf_larger(-left, 0) : hf_larger(left, 0);
    }
}

int hf_layers_passed_c(const struct hf_layers_rays *r, int n, float *out)
{
    int any = 0;
    for (int x = 0; x < r->samples; x++)
        r->line[x] = r->above * r->upper[x] + r->below * r->lower[x];
    for (int x = 0; x < n; x++) {
        const float u = passes_at(r->x + x, r->lamp, r->part, r->most, r->size);
        const int i = whole_of(u), last = r->samples - 1;
        const float a = r->line[hf_layers_within(i - r->first, 0, last)],
                    b = r->line[hf_layers_within(i + 1 - r->first, 0, last)], found = a + (u - (float)i) * (b - a);
        if (found > 0) {
            out[x] = hf_saturate(out[x] + found);
            any = 1;
        }
    }
    return any;
}

// Add what is cut from pixels x0 to x1 of a row of a lamp's disc. Returns whether anything is.
static int cut_row(const struct passing *w, int x0, int x1, int y, float *out)
{
    const struct cover *by = w->by;
    const float at = passes_at(y, w->lamp->y, w->part, w->high, w->size), v = at - (float)whole_of(at);
    const int n = by->columns, upper = hf_layers_within(whole_of(at) - w->y0, 0, by->rows - 1),
              lower = hf_layers_within(whole_of(at) + 1 - w->y0, 0, by->rows - 1);
    // The samples that the row's rays pass lie between these.
    const int from = whole_of((2 * (float)x0 + 1 - w->wide) * w->size - 0.5f) - w->x0,
              end = whole_of((2 * (float)x1 - 1 + w->wide) * w->size - 0.5f) + 2 - w->x0,
              first = hf_min(by->first[upper], by->first[lower]), last = hf_max(by->end[upper], by->end[lower]);
    if (first >= last || (last < n && from >= last) || (first > 0 && end <= first))
        return 0;
    const int left = hf_layers_within(from, 0, n - 1), right = hf_layers_within(end - 1, 0, n - 1);
    const struct hf_layers_rays r = {.part = w->part,
                                     .most = w->wide,
                                     .lamp = w->lamp->x,
                                     .x = x0,
                                     .size = w->size,
                                     .upper = by->at + (ptrdiff_t)upper * n + left,
                                     .lower = by->at + (ptrdiff_t)lower * n + left,
                                     .above = (1 - v) * w->much,
                                     .below = v * w->much,
                                     .first = w->x0 + left,
                                     .samples = right + 1 - left,
                                     .line = w->line};
    return w->passed(&r, x1 - x0, out + x0);
}

// Add what a slice cuts from the disc of a lamp.
static void cut_lamp(const struct hf_cell *c, const struct cover *by, const struct hf_slice *s, struct lamp *p)
{
    const int size = TILE / 2, step = TILE >> s->level, tx = p->of.tx, ty = p->of.ty;
    const struct hf_rect r = {(p->cut.tiles.x0 - tx) * size - 1, (p->cut.tiles.y0 - ty) * size - 1,
                              (p->cut.tiles.x1 - tx) * size + 1, (p->cut.tiles.y1 - ty) * size + 1};
    const float radius = fabsf(s->radius);
    const struct passing w = {.lamp = p,
                              .part = s->radius / p->radius,
                              .wide = radius * c->l->wide,
                              .high = radius,
                              .size = 1 / (float)(1 << s->level),
                              .much = is_before(c->l, p, s),
                              .passed = c->k->passed,
                              .line = c->line[0],
                              .by = by,
                              .x0 = (by->tiles.x0 - tx) * step,
                              .y0 = (by->tiles.y0 - ty) * step};
    for (int y = r.y0; w.much > 0 && y < r.y1; y++) {
        const float dy = 2 * (float)y + 1 - p->y, square = p->reach * p->reach - dy * dy,
                    half = square > 0 ? sqrtf(square) * hf_larger(c->l->wide, 1) : 0;
        const int x0 = hf_max((int)floorf((p->x - half) / 2), r.x0), x1 = hf_min((int)ceilf((p->x + half) / 2), r.x1);
        if (x0 < x1 && half > 0)
            p->any |= cut_row(&w, x0, x1, y, p->cut.at + (ty * size + y) * p->cut.row + tx * size);
    }
}

static size_t floats_of(const struct lamp *p)
{
    return (size_t)p->cut.row * (size_t)((p->cut.tiles.y1 - p->cut.tiles.y0) * TILE / 2 + 2);
}

// Where along an axis rays from tiles `from` up to `to` to a lamp pass a slice: this part of their way from the pixel, and at most
// so far from it.
static struct hf_layers_range passed_along(float lamp, int from, int to, float part, float most)
{
    // The place changes evenly with the pixel, but for two bends. A pixel of half resolution more is cut on either side.
    const float bend = most / fabsf(part), first = (float)(from * TILE - 2), end = (float)(to * TILE + 2),
                pixel[4] = {first, end, hf_edges_between(lamp - bend, first, end),
                            hf_edges_between(lamp + bend, first, end)};
    struct hf_layers_range r = {HUGE_VALF, -HUGE_VALF};
    for (int i = 0; i < 4; i++) {
        const float at = pixel[i] + hf_edges_between(part * (lamp - pixel[i]), -most, most);
        r = (struct hf_layers_range){at < r.low ? at : r.low, hf_larger(at, r.high)};
    }
    return r;
}

// The tiles in which rays of a lamp's disc in the cell pass a slice before it. Tiles beyond the frame repeat each other, so the
// first of them stand for all.
static struct hf_rect passed_by(const struct hf_cell *c, const struct hf_slice *s, const struct lamp *p)
{
    const struct hf_rect most = hf_layers_tiles_with_samples(c), cut = p->cut.tiles;
    const int n = hf_layers_tiles_around(s);
    // Its x1 and y1 are the last tile's.
    const struct hf_rect all = {hf_max(-n, most.x0), hf_max(-n, most.y0), hf_min(c->columns + n, most.x1 + 1) - 1,
                                hf_min(c->rows + n, most.y1 + 1) - 1};
    const float part = s->radius / p->radius, radius = fabsf(s->radius), more = (float)(2 << s->level);  // two samples
    const struct hf_layers_range x = passed_along(p->x + (float)(p->of.tx * TILE), cut.x0, cut.x1, part,
                                                  radius * c->l->wide),
                                 y = passed_along(p->y + (float)(p->of.ty * TILE), cut.y0, cut.y1, part, radius);
    return (struct hf_rect){hf_layers_within(tile_of(x.low - more), all.x0, all.x1),
                            hf_layers_within(tile_of(y.low - more), all.y0, all.y1),
                            hf_layers_within(tile_of(x.high + more), all.x0, all.x1) + 1,
                            hf_layers_within(tile_of(y.high + more), all.y0, all.y1) + 1};
}

// Mark the tiles in which rays of lamps behind a slice pass it. Returns the least rectangle around them.
static struct hf_rect mark_passed(struct hf_cell *c, const struct hf_slice *s, struct lamp *lamp, int count)
{
    const int n = hf_layers_tiles_around(s);
    struct hf_rect r = {c->columns + n, c->rows + n, -n, -n};
    for (int i = 0; i < count; i++) {
        lamp[i].passed = (struct hf_rect){0};
        if (is_before(c->l, &lamp[i], s) > 0) {
            const struct hf_rect a = lamp[i].passed = passed_by(c, s, &lamp[i]);
            r = (struct hf_rect){hf_min(r.x0, a.x0), hf_min(r.y0, a.y0), hf_max(r.x1, a.x1), hf_max(r.y1, a.y1)};
        }
    }
    for (int ty = r.y0; ty < r.y1; ty++)
        memset(hf_layers_map_at(&c->passed, r.x0, ty), 0, (size_t)(r.x1 - r.x0));
    for (int i = 0; i < count; i++)
        for (int ty = lamp[i].passed.y0; ty < lamp[i].passed.y1; ty++)
            memset(hf_layers_map_at(&c->passed, lamp[i].passed.x0, ty), WANTED,
                   (size_t)(lamp[i].passed.x1 - lamp[i].passed.x0));
    return r;
}

// Whether one of a lamp's rays may pass samples of the slice.
static int passes_samples(const struct hf_cell *c, const struct lamp *p)
{
    for (int ty = p->passed.y0; ty < p->passed.y1; ty++)
        for (int tx = p->passed.x0; tx < p->passed.x1; tx++)
            if (*hf_layers_map_at(&c->passed, tx, ty) & HELD)
                return 1;
    return 0;
}

// Look at lamps, and cut their discs.
static void cut_discs(struct hf_cell *c, int stack, struct lamp *lamp, int count)
{
    const struct hf_layers *l = c->l;
    for (int i = 0; count && i < l->slices && !hf_stopped(l->stop); i++) {
        const struct hf_slice *s = &l->slice[i];
        struct cover p;
        if (s->level == 0)
            continue;
        const struct hf_rect r = mark_passed(c, s, lamp, count);
        if (r.x0 >= r.x1 || r.y0 >= r.y1)
            continue;
        shape_cover(c, s, r, &p);
        int any = take_weights(c, i, HF_KIND_SEEN, &p, 0);
        any = l->levels ? take_weights(c, i, HF_KIND_HIDDEN, &p, any) : any;
        for (int k = 0; any && k < count; k++)
            if (passes_samples(c, &lamp[k]))
                cut_lamp(c, &p, s, &lamp[k]);
    }
    for (int k = 0; k < count; k++)
        if (lamp[k].any)
            hf_layers_cut_light(c, stack, &lamp[k].of, &lamp[k].cut);
}

size_t hf_layers_cut_floats(const struct hf_cell *c)
{
    return c->l->set.highlights ? 4 * (size_t)(c->columns * TILE / 2 + 2) * (size_t)(c->rows * TILE / 2 + 2) + HF_PAD
                                : 0;
}

// Look at all lamps, as many at once as there is room for.
void hf_layers_cut_lamps(struct hf_cell *c, int stack)
{
    const struct hf_layers *l = c->l;
    const int n = l->most_tiles;
    const size_t room = hf_layers_cut_floats(c) - HF_PAD;
    struct lamp lamp[MOST];
    int count = 0;
    size_t used = 0;
    for (int ty = -n; ty < c->rows + n && !hf_stopped(l->stop); ty++)
        for (int i = 0; i < (c->columns + 2 * n) * SQUARES; i++) {
            const int tx = i / SQUARES - n;
            struct lamp p;
            if (*hf_layers_map_at(&c->plain, tx, ty) & DULL || !find_lamp(c, stack, tx, ty, i % SQUARES, &p))
                continue;
            const size_t need = floats_of(&p);
            if (count == MOST || used + need > room) {
                cut_discs(c, stack, lamp, count);
                used = 0;
                count = 0;
            }
            float *first = c->cut_off + used;
            p.cut.at = first - (p.cut.tiles.y0 * TILE / 2 - 1) * p.cut.row - (p.cut.tiles.x0 * TILE / 2 - 1);
            memset(first, 0, sizeof(float) * need);
            lamp[count++] = p;
            used += need;
        }
    cut_discs(c, stack, lamp, count);
}
