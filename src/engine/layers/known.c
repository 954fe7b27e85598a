// SPDX-License-Identifier: BSD-3-Clause
// Hidden samples at full resolution: those of known surfaces, and guesses where none is known.
//
// A known sample counts as far as visible ones cover its pixel (else it would stand beside what it continues), and only
// if a lens can see it at all: past an object a lens sees no farther than the difference of the two radii. So within
// that distance there must be a pixel whose surface is not nearer than the sample.
#include <math.h>
#include <string.h>

#include "engine/layers/hidden.h"
#include "pixel/pass_c.h"

// The four samples of a quad may be of two surfaces, one of which a lens sees and the other not: where one ends
// behind what hides both. So the band tests the nearest and the farthest of them, and a sample between takes the view
// of one of them.
enum { NEAREST, FARTHEST, SIDES };

// A lens that sees little past an edge needs pixels, not quads: up to NARROW pixels each one around is tested. From
// half of that on quads begin to count.
enum { NARROW = 8, AROUND = NARROW / 2 };
_Static_assert((int)AROUND <= (int)HF_LAYERS_SMOOTH, "bands of quads reach farther than that");

// A band of quads. away: the distance of a pixel so many columns and rows away. farthest: the largest visible radius
// within a distance that grows from level to level. around: that of all pixels that narrow() looks at. Of each
// surface and quad, for either side: how far a lens sees past what hides it, in quads; the least radius that leaves
// it in view; and whether some does, 0 to 1. sides: 1 where no quad of the band has two.
struct band {
    const struct hf_frame *f;
    struct hf_rect r;
    int reach;
    ptrdiff_t wide, stride;  // of farthest, and of the others
    float away[NARROW + 2][NARROW + 2];
    float *farthest, *across, *around, *apart[HF_MOST_BEHIND][SIDES], *least[HF_MOST_BEHIND][SIDES],
        *open[HF_MOST_BEHIND][SIDES];
    int sides[HF_MOST_BEHIND];
};

static size_t wide_floats(const struct hf_layers *l, int width)
{
    return ((size_t)width + 2 * (size_t)hf_layers_hidden_reach(l) + 15) / 16 * 16 + HF_PAD;
}

size_t hf_layers_known_floats(const struct hf_layers *l, int width, int height)
{
    if (!l->known)
        return 0;
    const size_t rows = (size_t)height + 2 * (size_t)hf_layers_hidden_reach(l);
    return 2 * wide_floats(l, width) * rows +
           (size_t)(3 * SIDES * HF_MOST_BEHIND + 1) * (size_t)(width + HF_PAD) * (size_t)height;
}

static struct band place(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_layers *l = hf_layers(f->s);
    const int width = r.x1 - r.x0, height = r.y1 - r.y0;
    struct band b = {.f = f, .r = r, .reach = hf_layers_hidden_reach(l)};
    float *memory = f->work;
    for (int v = 0; v < NARROW + 2; v++)
        for (int u = 0; u < NARROW + 2; u++)
            b.away[v][u] = sqrtf((float)(u * u + v * v));
    b.wide = (ptrdiff_t)wide_floats(l, width);
    b.stride = width + HF_PAD;
    const ptrdiff_t all = b.wide * (height + 2 * b.reach), plane = b.stride * height;
    b.farthest = memory + b.reach * b.wide + b.reach;
    b.across = b.farthest + all;
    memory += 2 * all;
    b.around = memory;
    memory += plane;
    for (int i = 0; i < SIDES * HF_MOST_BEHIND; i++, memory += 3 * plane) {
        const int k = i / SIDES, side = i % SIDES;
        b.apart[k][side] = memory;
        b.least[k][side] = memory + plane;
        b.open[k][side] = memory + 2 * plane;
    }
    return b;
}

// What hides a sample of surface k most closely: the surface before it, or what is visible.
static float before_of(const struct hf_known *known, int k, ptrdiff_t at, float visible)
{
    return k > 0 && known->behind[k - 1].weight[at] > 0 ? hf_larger(known->behind[k - 1].radius[at], visible) : visible;
}

// The radius of the nearer of a pixel's two samples, the second with a weight.
static float front_of(float seen, float weight, float mixed)
{
    return weight > 0 && mixed < seen ? mixed : seen;
}

// The radius of the farther one.
static float back_of(float seen, float weight, float mixed)
{
    return weight > 0 && mixed > seen ? mixed : seen;
}

// Samples of a quad this near to each other are of one surface.
static const float ONE_SURFACE = 0.25f;

// Whether a quad's samples are of two surfaces.
static int has_two(const struct band *b, int k, ptrdiff_t quad)
{
    return b->apart[k][NEAREST][quad] > 0 && b->least[k][FARTHEST][quad] > b->least[k][NEAREST][quad] + ONE_SURFACE;
}

// Note what the samples of a row of quads need.
static void look_row(struct band *b, int k, int y)
{
    const struct hf_frame *f = b->f;
    const struct hf_known *known = hf_layers(f->s)->given;
    const ptrdiff_t to = (y - b->r.y0) * b->stride;
    const size_t bytes = sizeof(float) * (size_t)(b->r.x1 - b->r.x0);
    for (int side = 0; side < SIDES; side++) {
        memset(b->apart[k][side] + to, 0, bytes);
        memset(b->least[k][side] + to, 0, bytes);
        memset(b->open[k][side] + to, 0, bytes);
    }
    for (int py = 2 * y; py < hf_min(2 * y + 2, f->s->height); py++) {
        const ptrdiff_t row = py * known->stride;
        const float *weight = known->behind[k].weight + row, *radius = known->behind[k].radius + row;
        const float *visible = hf_at(&f->buf[HF_LAYERS_BUF_SEEN_AT], 1, 0, py),
                    *mixed[2] = {hf_at(&f->buf[HF_LAYERS_BUF_MIXED_AT], 0, 0, py),
                                 hf_at(&f->buf[HF_LAYERS_BUF_MIXED_AT], 1, 0, py)};
        for (int x = 2 * b->r.x0; x < hf_min(2 * b->r.x1, f->s->width); x++) {
            const float front = front_of(visible[x], mixed[0][x], mixed[1][x]);
            const float d = weight[x] > 0 ? (radius[x] - before_of(known, k, row + x, front)) * 0.5f : 0;
            if (!(d > 0))
                continue;
            for (int side = 0; side < SIDES; side++) {
                float *apart = b->apart[k][side] + to + x / 2 - b->r.x0,
                      *least = b->least[k][side] + to + x / 2 - b->r.x0;
                const float before = side == NEAREST ? *least - (radius[x] - 1) : radius[x] - 1 - *least;
                if (!(*apart > 0) || before > ONE_SURFACE || (before >= -ONE_SURFACE && d > *apart)) {
                    *least = radius[x] - 1;
                    *apart = d;
                }
            }
        }
    }
    for (int x = 0; x < b->r.x1 - b->r.x0; x++)
        if (has_two(b, k, to + x))
            b->sides[k] = SIDES;
}

// Test whether something within `from` quads leaves the samples in view; it counts fully for those that a lens sees by
// as much, and not at all for those it sees by less than `before`.
static void test(const struct band *b, int k, int side, int before, int from)
{
    const float scale = from > before ? 1 / (float)(from - before) : 1;
    for (int y = b->r.y0; y < b->r.y1 && !hf_stopped(b->f->s->stop); y++) {
        const ptrdiff_t row = (y - b->r.y0) * b->stride;
        const float *apart = b->apart[k][side] + row, *least = b->least[k][side] + row,
                    *farthest = b->farthest + (y - b->r.y0) * b->wide;
        float *open = b->open[k][side] + row;
        for (int x = 0; x < b->r.x1 - b->r.x0; x++) {
            const float reached = from > 0 ? hf_saturate((apart[x] - (float)before) * scale) : 1;
            const float v = reached * (1 - hf_layers_hides(least[x] - farthest[x]));
            open[x] = v > open[x] ? v : open[x];
        }
    }
}

// Grow the distance by `step` quads. have: how far around the band there are samples; afterwards `step` less.
static void grow(const struct band *b, int step, int have)
{
    const int height = b->r.y1 - b->r.y0, width = b->r.x1 - b->r.x0, left = have - step;
    for (int y = -have; y < height + have && !hf_stopped(b->f->s->stop); y++) {
        const float *in = b->farthest + y * b->wide;
        float *out = b->across + y * b->wide;
        for (int x = -left; x < width + left; x++) {
            const float a = in[x - step] > in[x] ? in[x - step] : in[x];
            out[x] = a > in[x + step] ? a : in[x + step];
        }
    }
    for (int y = -left; y < height + left && !hf_stopped(b->f->s->stop); y++) {
        const float *in = b->across + y * b->wide, *above = in - step * b->wide, *below = in + step * b->wide;
        float *out = b->farthest + y * b->wide;
        for (int x = -left; x < width + left; x++) {
            const float a = above[x] > in[x] ? above[x] : in[x];
            out[x] = a > below[x] ? a : below[x];
        }
    }
}

// The farthest surface of a row of quads' pixels: the visible one, or the back of a mixed edge.
static void farthest_of(const struct band *b, int y, int x0, int x1, float *to)
{
    for (int x = x0; x < x1; x++)
        to[x - x0] = -HUGE_VALF;
    for (int py = 2 * y; py < 2 * y + 2; py++) {
        const float *radius = hf_at(&b->f->buf[HF_LAYERS_BUF_SEEN_AT], 1, 0, py),
                    *weight = hf_at(&b->f->buf[HF_LAYERS_BUF_MIXED_AT], 0, 0, py),
                    *behind = hf_at(&b->f->buf[HF_LAYERS_BUF_MIXED_AT], 1, 0, py);
        for (int x = 2 * x0; x < 2 * x1; x++)
            to[(x >> 1) - x0] = hf_larger(to[(x >> 1) - x0], back_of(radius[x], weight[x], behind[x]));
    }
}

// Find the farthest surface that narrow() may meet around a quad, to see at once that none leaves a sample in view. The
// neighbourhood grows by 1 quad and then by 3, to AROUND in all.
static void find_around(const struct band *b)
{
    const int width = b->r.x1 - b->r.x0, height = b->r.y1 - b->r.y0;
    for (int y = -AROUND; y < height + AROUND && !hf_stopped(b->f->s->stop); y++)
        farthest_of(b, b->r.y0 + y, b->r.x0 - AROUND, b->r.x0 + width + AROUND, b->farthest + y * b->wide - AROUND);
    grow(b, 1, AROUND);
    grow(b, AROUND - 1, AROUND - 1);
    for (int y = 0; y < height; y++)
        memcpy(b->around + y * b->stride, b->farthest + y * b->wide, sizeof(float) * (size_t)(b->r.x1 - b->r.x0));
}

// Find which samples a lens can see.
static void find_open(struct band *b)
{
    const struct hf_buf *quads = &b->f->buf[HF_LAYERS_BUF_QUADS_AT];
    const int count = hf_layers(b->f->s)->given->count;
    float most = 0;
    find_around(b);
    for (int y = b->r.y0 - b->reach; y < b->r.y1 + b->reach && !hf_stopped(b->f->s->stop); y++)
        memcpy(b->farthest + (y - b->r.y0) * b->wide - b->reach, hf_at(quads, 1, b->r.x0 - b->reach, y),
               sizeof(float) * (size_t)(b->r.x1 - b->r.x0 + 2 * b->reach));
    for (int k = 0; k < count; k++) {
        b->sides[k] = 1;
        for (int y = b->r.y0; y < b->r.y1 && !hf_stopped(b->f->s->stop); y++) {
            look_row(b, k, y);
            for (int side = 0; side < SIDES; side++)
                for (int x = 0; x < b->r.x1 - b->r.x0; x++)
                    most = hf_larger(b->apart[k][side][(y - b->r.y0) * b->stride + x], most);
        }
    }
    // Distances 0, 1, 3, 7 and so on.
    for (int from = 0, before = 0, step = 1; !hf_stopped(b->f->s->stop); step *= 2) {
        for (int k = 0; k < count; k++)
            for (int side = 0; side < b->sides[k]; side++)
                test(b, k, side, before, from);
        if ((float)from >= most || from + step > b->reach)
            break;
        grow(b, step, b->reach - from);
        before = from;
        from += step;
    }
}

// Rows of samples: colour, weight (4), radius (5).
static void planes_at(const struct hf_frame *f, int colour, int at, int x, int y, float *row[6])
{
    hf_row(&f->buf[colour], f->s->channels, x, y, row);
    row[4] = hf_at(&f->buf[at], 0, x, y);
    row[5] = hf_at(&f->buf[at], 1, x, y);
}

// The visible samples of a row of pixels: the first, and those behind mixed edges.
struct seen {
    const float *weight[2], *radius[2];
};

// How much of a pixel lies at least a pixel of radius before r.
static float cover(const struct seen *s, int x, float r)
{
    float sum = 0;
    for (int i = 0; i < 2; i++)
        if (s->weight[i][x] > 0)
            sum = sum + s->weight[i][x] * hf_layers_hides(r - 1 - s->radius[i][x]);
    return sum;
}

// Whether a pixel within `apart` pixels leaves a sample of radius r in view, 0 to 1.
static float narrow(const struct band *b, int x, int y, float apart, float r)
{
    const struct hf_buf *seen = &b->f->buf[HF_LAYERS_BUF_SEEN_AT], *mixed = &b->f->buf[HF_LAYERS_BUF_MIXED_AT];
    const int reach = (int)apart + 1;
    float open = 0;
    for (int v = -reach; v <= reach && open < 1; v++) {
        const float *radius = hf_at(seen, 1, x, y + v), *weight = hf_at(mixed, 0, x, y + v),
                    *behind = hf_at(mixed, 1, x, y + v), *away = b->away[v < 0 ? -v : v];
        for (int u = -reach; u <= reach; u++) {
            const float reached = hf_saturate(apart + 0.5f - away[u < 0 ? -u : u]);
            const float back = back_of(radius[u], weight[u], behind[u]);
            const float here = reached * (1 - hf_layers_hides(r - 1 - back));
            open = here > open ? here : open;
        }
    }
    return open;
}

// How far a quad's samples of radius r are in view, 0 to 1. What is one surface with the nearest sample is seen as
// that.
static float in_view(const struct band *b, int k, ptrdiff_t quad, float r)
{
    const float near = b->open[k][NEAREST][quad];
    if (!has_two(b, k, quad))
        return near;
    const float behind = hf_saturate((r - 1 - b->least[k][NEAREST][quad]) / ONE_SURFACE - 1);
    return near + behind * (b->open[k][FARTHEST][quad] - near);
}

// Replace guesses by a known surface.
static void take_known(const struct band *b, int k, const struct seen *seen, int y, float *const out[6])
{
    const struct hf_frame *f = b->f;
    const struct hf_surface *known = &hf_layers(f->s)->given->behind[k];
    const ptrdiff_t row = (y / 2 - b->r.y0) * b->stride;
    const int x0 = 2 * b->r.x0, n = hf_min(2 * b->r.x1, f->s->width) - x0;
    const ptrdiff_t at = y * hf_layers(f->s)->given->stride + x0;
    const float largest = hf_layers(f->s)->largest;
    const int guessed = hf_layers(f->s)->guessed, edges = hf_layers(f->s)->given->edges;
    float *mixed[6] = {NULL};
    planes_at(f, HF_LAYERS_BUF_MIXED, HF_LAYERS_BUF_MIXED_AT, x0, y, mixed);
    for (int i = 0; i < n; i++) {
        const float all = known->weight[at + i];
        if (!(all > 0))
            continue;
        const float r = known->radius[at + i], most = cover(seen, i, r);
        const float front = front_of(seen->radius[0][i], seen->weight[1][i], seen->radius[1][i]);
        const float apart = most > 0 ? r - before_of(hf_layers(f->s)->given, k, at + i, front) : NARROW;
        float view = in_view(b, k, row + i / 2, r);
        if (apart < NARROW) {
            const float part = hf_saturate(2 - apart * (2.0f / NARROW));
            const int none = hf_layers_hides(r - 1 - b->around[row + i / 2]) >= 1;
            view = view + part * ((none ? 0 : narrow(b, x0 + i, y, apart > 0 ? apart : 0, r)) - view);
        }
        out[4][i] = (all < most ? all : most) * view;
        out[5][i] = r;
        const float part = edges ? 0 : seen->weight[1][i],
                    same = part > 0 ? hf_known_beside(part, seen->radius[1][i], r) : 0;
        for (int c = 0; c < f->s->channels; c++) {
            const float v = hf_known_within(known->colour[c][at + i] / all, largest);
            // Without weight a mixed sample's colour is undefined.
            out[c][i] = guessed ? 1 : same > 0 ? v + same * (mixed[c][i] - v) : v;
        }
    }
}

static void make_row(const struct band *b, int y)
{
    static const int guess[2][2] = {{HF_LAYERS_BUF_HIDDEN, HF_LAYERS_BUF_HIDDEN_AT},
                                    {HF_LAYERS_BUF_BEYOND, HF_LAYERS_BUF_BEYOND_AT}},
                     known[2][2] = {{HF_LAYERS_BUF_SECOND, HF_LAYERS_BUF_SECOND_AT},
                                    {HF_LAYERS_BUF_THIRD, HF_LAYERS_BUF_THIRD_AT}};
    static const int visible[2] = {HF_LAYERS_BUF_SEEN_AT, HF_LAYERS_BUF_MIXED_AT};
    const struct hf_frame *f = b->f;
    const int x = 2 * b->r.x0;
    const float *radius[4], *weight[4];
    struct seen seen;
    for (int i = 0; i < 4; i++) {
        const struct hf_buf *at = &f->buf[visible[i / 2]];
        const int row = hf_min((y & ~1) + i % 2, f->s->height - 1);
        weight[i] = hf_at(at, 0, x, row);
        radius[i] = hf_at(at, 1, x, row);
    }
    for (int i = 0; i < 2; i++) {
        seen.weight[i] = hf_at(&f->buf[visible[i]], 0, x, y);
        seen.radius[i] = hf_at(&f->buf[visible[i]], 1, x, y);
    }
    for (int k = 0; k < 2; k++) {
        float *in[6] = {NULL}, *out[6] = {NULL};
        planes_at(f, guess[k][0], guess[k][1], x / 2, y / 2, in);
        planes_at(f, known[k][0], known[k][1], x, y, out);
        hf_layers_kernels(f)->spread((const float *const *)in, radius, weight, y & 1, f->s->channels, b->r.x1 - b->r.x0,
                                     out);
        if (k < hf_layers(f->s)->given->count)
            take_known(b, k, &seen, y, out);
    }
}

void hf_layers_known_pass(const struct hf_frame *f, struct hf_rect r)
{
    if (!hf_layers(f->s)->known)
        return;
    struct band b = place(f, r);
    find_open(&b);
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++)
        make_row(&b, y);
    if (!hf_stopped(f->s->stop))
        hf_layers_mark_hidden(f, r, NULL);
}

void hf_layers_take_edges(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_known *known = hf_layers(f->s)->given;
    const float largest = hf_layers(f->s)->largest;
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, f->s->width) - x0;
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height); y++) {
        const ptrdiff_t at = y * known->stride + x0;
        float *colour[4] = {NULL}, *seen[6] = {NULL}, *mixed[6] = {NULL};
        hf_row(&f->buf[HF_LAYERS_BUF_COLOUR], f->s->channels, x0, y, colour);
        planes_at(f, HF_LAYERS_BUF_SEEN, HF_LAYERS_BUF_SEEN_AT, x0, y, seen);
        planes_at(f, HF_LAYERS_BUF_MIXED, HF_LAYERS_BUF_MIXED_AT, x0, y, mixed);
        for (int x = 0; x < n; x++) {
            const float w = known->front.weight[at + x];
            if (!(w > HF_LAYERS_LEAST && w < 1 - HF_LAYERS_LEAST))
                continue;
            for (int c = 0; c < f->s->channels; c++) {
                const float front = known->front.colour[c][at + x];
                seen[c][x] = hf_known_within(front / w, largest);
                mixed[c][x] = hf_known_within((colour[c][x] - front) / (1 - w), largest);
            }
            seen[4][x] = w;
            mixed[4][x] = 1 - w;
            seen[5][x] = known->front.radius[at + x];
            mixed[5][x] = known->rest[at + x];
        }
    }
}
