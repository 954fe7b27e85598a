// SPDX-License-Identifier: BSD-3-Clause
// Patterns: a hidden surface continues like its visible part. For each hidden place the search looks for other places
// around which the same surface looks alike, and the hidden sample takes the colour found there. So edges and checks go
// on behind a rod. Only visible parts of the surface are compared. Coarse shifts are searched at an eighth of the
// frame's resolution, then refined at a quarter and at half of it. A place takes from the choices of the four eighths
// around it. Where two choices are equally good, the result may jump.
#include "engine/layers/patterns.h"

#include <math.h>
#include <string.h>

#include "engine/layers/hidden.h"
#include "pixel/pass_c.h"

enum {
    LEVELS = 3,
    COARSE = 1 << (LEVELS - 1),  // size of a sample of the last level, half-resolution pixels
    REACH = 48,                  // around a band, half-resolution pixels that are read
    PAD = 32,                    // samples beside a row that vectors may read
    WINDOW = 4,                  // samples compared on either side of the place
    MOST = (2 * WINDOW + 1) * (2 * WINDOW + 1),
    SHIFT = 7,  // the largest shift searched, in samples of the last level
    CHOICES = 6,
    LANES = 32  // shifts compared at once, and room for a whole vector
};

// A mean square difference of the roots of colours, over all channels, that nobody sees: this part of their mean square
// around the place. So the exposure changes no choice.
#define UNSEEN 0.0002f
// Parts of the variance around a place. A pattern whose error is ALIKE of it is not trusted. A choice counts in the
// mean if its error exceeds the best one's by less than EQUAL of it.
#define ALIKE 0.5f
#define EQUAL 0.4f
// The part of the variance by which equally good shifts are told apart. A repeating pattern offers many; the order
// makes the search take the same one each time, not the one that rounding or a focus pull prefers.
#define ORDER 0.01f

struct level {
    struct hf_layers_set set;
    float *place, *nearest;  // radii of the hidden sample and of what hides it; HUGE_VALF: nothing is hidden
};

struct choices {
    int count;
    int x[CHOICES], y[CHOICES];
    float off[CHOICES], variance, unseen, trust;
};

struct band {
    const struct hf_frame *f;
    int channels;
    struct hf_rect region;
    struct level level[LEVELS];
    struct choices *choices;  // one for each sample of the last level
};

// The visible parts of the surface around sample (x, y) of a level.
struct patch {
    const struct level *level;
    int x, y;
    struct hf_pattern_place place;
    int count;
    float sum, variance, unseen;
    struct hf_pattern_tap tap[MOST];
};

int hf_layers_patterns_reach(const struct hf_layers *l)
{
    return l->levels && l->set.patterns ? REACH : 0;
}

static struct hf_rect region_of(struct hf_rect r)
{
    return (struct hf_rect){r.x0 - REACH, r.y0 - REACH, (r.x1 + 3) / 4 * 4 + REACH, (r.y1 + 3) / 4 * 4 + REACH};
}

static size_t place(struct band *b, float *memory)
{
    size_t used = 0;
    for (int j = 0; j < LEVELS; j++) {
        struct level *v = &b->level[j];
        const struct hf_rect r = b->region;
        const ptrdiff_t stride = (r.x1 - r.x0) / (1 << j) + 2 * PAD;
        const size_t plane = (size_t)stride * (size_t)((r.y1 - r.y0) / (1 << j));
        float **const planes[] = {&v->set.colour[0], &v->set.colour[1], &v->set.colour[2], &v->set.weight,
                                  &v->set.radius,    &v->place,         &v->nearest,       &v->set.colour[3]};
        v->set.stride = stride;
        for (int i = 0; i < b->channels + 4; i++, used += plane)
            *planes[i] = memory ? memory + used - r.y0 / (1 << j) * stride - r.x0 / (1 << j) + PAD : NULL;
    }
    b->choices = memory ? (struct choices *)(memory + used) : NULL;
    used += (size_t)((b->region.x1 - b->region.x0) / COARSE) * (size_t)((b->region.y1 - b->region.y0) / COARSE) *
            sizeof(struct choices) / sizeof(float);
    return used;
}

size_t hf_layers_patterns_floats(const struct hf_layers *l, int width, int height)
{
    struct band b = {.channels = l->channels, .region = region_of((struct hf_rect){0, 0, width, height})};
    return hf_layers_patterns_reach(l) ? place(&b, NULL) : 0;
}

static struct choices *choices_at(const struct band *b, int x, int y)
{
    const struct hf_rect r = b->region;
    return b->choices + (ptrdiff_t)(y - r.y0 / COARSE) * ((r.x1 - r.x0) / COARSE) + x - r.x0 / COARSE;
}

// ---- levels ----

// Clear a row: beyond the frame there is nothing.
static void clear_row(const struct band *b, int y)
{
    const struct level *v = &b->level[0];
    const int x0 = b->region.x0, n = b->region.x1 - x0;
    const ptrdiff_t at = y * v->set.stride + x0;
    float *const planes[] = {v->set.colour[0], v->set.colour[1], v->set.colour[2],
                             v->set.weight,    v->place,         v->set.colour[3]};
    for (int i = 0; i < b->channels + 2; i++)
        memset(planes[i] + at, 0, sizeof(float) * (size_t)n);
    for (int x = 0; x < n; x++) {
        v->set.radius[at + x] = HF_LAYERS_NOTHING;
        v->nearest[at + x] = HUGE_VALF;
    }
}

// Load a row's farthest samples, and the hidden places behind it. Returns whether there are any.
static int begin_row(const struct band *b, int y)
{
    const struct hf_frame *f = b->f;
    const struct level *v = &b->level[0];
    const struct hf_buf *quads = &f->buf[HF_LAYERS_BUF_QUADS_AT];
    const int x0 = hf_max(b->region.x0, 0), n = hf_min(b->region.x1, f->s->half_width) - x0;
    const size_t bytes = sizeof(float) * (size_t)n;
    const ptrdiff_t at = y * v->set.stride + x0;
    int any = 0;
    for (int c = 0; c < b->channels; c++)
        memcpy(v->set.colour[c] + at, hf_at(&f->buf[HF_LAYERS_BUF_QUADS], c, x0, y), bytes);
    memcpy(v->set.weight + at, hf_at(quads, 0, x0, y), bytes);
    memcpy(v->set.radius + at, hf_at(quads, 1, x0, y), bytes);
    const float *hidden = hf_at(&f->buf[HF_LAYERS_BUF_HIDDEN_AT], 0, x0, y),
                *radius = hf_at(&f->buf[HF_LAYERS_BUF_HIDDEN_AT], 1, x0, y), *nearest = hf_at(quads, 2, x0, y);
    for (int x = 0; x < n; x++) {
        const int some = hidden[x] > 0;
        v->place[at + x] = some ? radius[x] : 0;
        v->nearest[at + x] = some ? nearest[x] : HUGE_VALF;
        any |= some;
    }
    return any;
}

static int begin_levels(const struct band *b)
{
    int any = 0;
    for (int y = b->region.y0; y < b->region.y1 && !hf_stopped(b->f->s->stop); y++) {
        clear_row(b, y);
        if (y >= 0 && y < b->f->s->half_height)
            any |= begin_row(b, y);
    }
    return any;
}

// Halve the resolution: the farthest of four samples, and the mean of their hidden places.
static void halve(const struct level *from, const struct level *to, int channels, int x, int y)
{
    float farthest = HF_LAYERS_NOTHING, sum = 0, radius = 0, place = 0, count = 0, nearest = HUGE_VALF, colour[4] = {0};
    const ptrdiff_t first = 2 * y * from->set.stride + 2 * x, at = y * to->set.stride + x;
    for (int i = 0; i < 4; i++) {
        const ptrdiff_t in = first + i / 2 * from->set.stride + i % 2;
        farthest = from->set.weight[in] > 0 ? fmaxf(from->set.radius[in], farthest) : farthest;
    }
    for (int i = 0; i < 4; i++) {
        const ptrdiff_t in = first + i / 2 * from->set.stride + i % 2;
        const float near = 1 - (farthest - from->set.radius[in]) * 0.25f;
        const float g = from->set.weight[in] > 0 && near > 0 ? from->set.weight[in] * near : 0;
        sum += g;
        radius += g > 0 ? g * from->set.radius[in] : 0;
        for (int c = 0; c < channels; c++)
            colour[c] += g * from->set.colour[c][in];
        if (from->nearest[in] < HUGE_VALF) {
            count += 1;
            place += from->place[in];
            nearest = fminf(from->nearest[in], nearest);
        }
    }
    to->set.weight[at] = sum * 0.25f;
    to->set.radius[at] = sum > 0 ? radius / sum : HF_LAYERS_NOTHING;
    for (int c = 0; c < channels; c++)
        to->set.colour[c][at] = sum > 0 ? colour[c] / sum : 0;
    to->place[at] = count > 0 ? place / count : 0;
    to->nearest[at] = nearest;
}

// Clear both ends of a row.
static void clear_pads(const struct level *v, int channels, int x0, int x1, int y)
{
    float *const planes[] = {v->set.colour[0], v->set.colour[1], v->set.colour[2], v->set.weight, v->set.colour[3]};
    for (int side = 0; side < 2; side++) {
        const ptrdiff_t at = y * v->set.stride + (side ? x1 : x0 - PAD);
        for (int i = 0; i < channels + 1; i++)
            memset(planes[i] + at, 0, sizeof(float) * PAD);
        for (int i = 0; i < PAD; i++)
            v->set.radius[at + i] = HF_LAYERS_NOTHING;
    }
}

// Returns whether anything is hidden.
static int make_levels(const struct band *b)
{
    if (!begin_levels(b))
        return 0;
    for (int j = 0; j < LEVELS; j++) {
        const int x0 = b->region.x0 / (1 << j), x1 = b->region.x1 / (1 << j);
        for (int y = b->region.y0 / (1 << j); y < b->region.y1 / (1 << j) && !hf_stopped(b->f->s->stop); y++) {
            for (int x = x0; j > 0 && x < x1; x++)
                halve(&b->level[j - 1], &b->level[j], b->channels, x, y);
            clear_pads(&b->level[j], b->channels, x0, x1, y);
        }
    }
    return 1;
}

// ---- comparison ----

void hf_layers_alike_c(const struct hf_pattern_place *place, const struct hf_pattern_tap *tap, int count,
                       const float *const in[6], int channels, int n, float *sum, float *off)
{
    for (int x = 0; x < n; x++) {
        float s = 0, e = 0;
        for (int i = 0; i < count; i++) {
            const ptrdiff_t at = tap[i].at + x;
            const float k = hf_pattern_known(*place, in[4][at], in[5][at]) * tap[i].weight;
            float d = 0;
            for (int c = 0; c < channels; c++) {
                const float v = in[c][at] - tap[i].colour[c];
                d = d + v * v;
            }
            s = s + k;
            e = e + k * d;
        }
        sum[x] = s;
        off[x] = e;
    }
}

// The surface of a place: radii closer to its own than a quarter of its distance behind what hides it belong to it,
// those beyond half of that do not.
static struct hf_pattern_place surface_of(float radius, float nearest)
{
    const float apart = radius - nearest;
    return (struct hf_pattern_place){radius, 4 / (apart > 1 ? apart : 1)};
}

static struct hf_pattern_place place_at(const struct level *v, int x, int y)
{
    const ptrdiff_t at = y * v->set.stride + x;
    return surface_of(v->place[at], v->nearest[at]);
}

// Collect the visible samples of the patch's surface around sample (x, y) of a level.
static void look_around(const struct band *b, const struct level *v, int x, int y, struct patch *p)
{
    float mean[4] = {0}, square = 0, all = 0;
    p->level = v;
    p->x = x;
    p->y = y;
    p->count = 0;
    p->sum = p->variance = p->unseen = 0;
    for (int dy = -WINDOW; dy <= WINDOW; dy++)
        for (int dx = -WINDOW; dx <= WINDOW; dx++) {
            const ptrdiff_t apart = dy * v->set.stride + dx, at = y * v->set.stride + x + apart;
            const float away = (float)(dx * dx + dy * dy), near = 1 / (1 + away * 0.25f);
            if (dx * dx + dy * dy > WINDOW * WINDOW + WINDOW - 1)
                continue;
            all += near;
            const float w = hf_pattern_known(p->place, v->set.weight[at], v->set.radius[at]) * near;
            if (!(w > 0))
                continue;
            struct hf_pattern_tap *tap = &p->tap[p->count++];
            *tap = (struct hf_pattern_tap){.at = apart, .weight = w};
            p->sum += w;
            for (int c = 0; c < b->channels; c++) {
                const float colour = tap->colour[c] = v->set.colour[c][at];
                mean[c] += w * colour;
                square += w * colour * colour;
            }
        }
    p->unseen = HF_LAYERS_SOME + (p->sum > 0 ? UNSEEN * square / p->sum : 0);
    for (int c = 0; c < b->channels && p->sum > 0; c++)
        square -= mean[c] * mean[c] / p->sum;
    p->variance = p->sum > 0 && square > 0 ? square / p->sum : 0;
    // At least a tenth of the window must be visible.
    if (p->sum < all * 0.1f)
        p->count = 0;
}

// Add a choice, sorted by error. Of two choices next to each other only the better one stays.
static void choose(struct choices *c, int x, int y, float off)
{
    int i = 0;
    if (c->count == CHOICES && off >= c->off[CHOICES - 1])
        return;
    while (i < c->count && (c->x[i] - x > 1 || x - c->x[i] > 1 || c->y[i] - y > 1 || y - c->y[i] > 1))
        i++;
    if (i < c->count && off >= c->off[i])
        return;
    if (i == c->count) {
        if (i == CHOICES && off >= c->off[CHOICES - 1])
            return;
        i = i < CHOICES ? c->count++ : CHOICES - 1;
    }
    for (; i > 0 && c->off[i - 1] > off; i--) {
        c->x[i] = c->x[i - 1];
        c->y[i] = c->y[i - 1];
        c->off[i] = c->off[i - 1];
    }
    c->x[i] = x;
    c->y[i] = y;
    c->off[i] = off;
}

// The rank of a shift at level j, from 0 to 1; lower ranks are preferred.
static float order_of(int j, int sx, int sy)
{
    const float scale = 1 / (float)(1 << (2 - j)), y = (float)sy * scale, x = (float)sx * scale;
    return (y + x * 0.0625f + 10) * 0.05f;
}

// Compare a patch with those shifted by (sx, sy) and the n - 1 shifts to the right. At the coarsest level, no shift is
// not a choice.
static void compare(const struct band *b, const struct patch *p, int sx, int sy, int n, struct choices *c)
{
    const struct level *v = p->level;
    const int j = (int)(v - b->level);
    const ptrdiff_t at = (p->y + sy) * v->set.stride + p->x + sx;
    const float *in[6] = {NULL};
    float sum[LANES], off[LANES], known[LANES], most = 0;
    for (int i = 0; i < b->channels; i++)
        in[i] = v->set.colour[i] + at;
    in[4] = v->set.weight + at;
    in[5] = v->set.radius + at;
    for (int i = 0; i < n; i++) {
        known[i] = hf_pattern_known(p->place, in[4][i], in[5][i]);
        most = known[i] > most ? known[i] : most;
    }
    if (!(most > 0))
        return;
    hf_layers_kernels(b->f)->alike(&p->place, p->tap, p->count, in, b->channels, n, sum, off);
    for (int i = 0; i < n; i++) {
        const float missing = p->sum - sum[i];
        // Samples that are not visible at the shifted place count as the variance.
        if (known[i] > 0 && !(j == LEVELS - 1 && sx + i == 0 && sy == 0))
            choose(c, sx + i, sy,
                   (off[i] + (missing > 0 ? missing : 0) * p->variance) / p->sum +
                       (1 - known[i] + ORDER * order_of(j, sx + i, sy)) * p->variance);
    }
}

static void end_choices(struct choices *c, const struct patch *p)
{
    c->variance = p->variance;
    c->unseen = p->unseen;
    c->trust = 0;
    if (c->count > 0) {
        const float trust = 1 - c->off[0] / (ALIKE * p->variance + p->unseen);
        c->trust = trust > 0 ? trust : 0;
    }
}

// Search all shifts at an eighth of the resolution.
static void search(const struct band *b, int x, int y)
{
    const struct level *v = &b->level[LEVELS - 1];
    struct choices *c = choices_at(b, x, y);
    struct patch p;
    memset(c, 0, sizeof *c);
    if (!(v->nearest[y * v->set.stride + x] < HUGE_VALF))
        return;
    p.place = place_at(v, x, y);
    look_around(b, v, x, y, &p);
    for (int sy = -SHIFT; sy <= SHIFT && p.count; sy++)
        compare(b, &p, -SHIFT, sy, 2 * SHIFT + 1, c);
    end_choices(c, &p);
}

// Refine choices for a patch at twice their resolution.
static void refine(const struct band *b, const struct patch *p, const struct choices *from, struct choices *c)
{
    for (int i = 0; i < from->count; i++)
        for (int dy = -1; dy <= 1; dy++)
            compare(b, p, 2 * from->x[i] - 1, 2 * from->y[i] + dy, 3, c);
}

static void double_choices(struct choices *c)
{
    for (int i = 0; i < c->count; i++) {
        c->x[i] *= 2;
        c->y[i] *= 2;
    }
}

// Refine the choices of an eighth of the resolution to half-resolution pixels.
static void search_fine(const struct band *b, int x, int y)
{
    struct choices *c = choices_at(b, x, y);
    struct patch p = {.place = place_at(&b->level[LEVELS - 1], x, y)};
    for (int j = LEVELS - 2; j >= 0 && c->count; j--) {
        const int middle = COARSE >> j;  // samples of level j from the place's corner to its middle, rounded
        struct choices finer = {0};
        look_around(b, &b->level[j], x * middle + (j == 0 ? middle / 2 : 0), y * middle + (j == 0 ? middle / 2 : 0),
                    &p);
        if (p.count) {
            refine(b, &p, c, &finer);
            end_choices(&finer, &p);
            *c = finer;
        } else {
            double_choices(c);
        }
    }
}

// Sums of what the four samples around a place choose for it; smooth: weight of the colour that is there already.
struct found {
    float colour[4], weight, smooth;
};

static void add_choices(const struct band *b, const struct choices *c, struct hf_pattern_place place, int x, int y,
                        float part, struct found *found)
{
    const struct level *v = &b->level[0];
    const float scale = 1 / (EQUAL * c->variance + 4 * c->unseen);
    float sum = 0, colour[4] = {0};
    for (int i = 0; i < c->count; i++) {
        const ptrdiff_t at = (y + c->y[i]) * v->set.stride + x + c->x[i];
        const float worse = 1 - (c->off[i] - c->off[0]) * scale, near = worse > 0 ? worse * worse : 0;
        const float g = hf_pattern_known(place, v->set.weight[at], v->set.radius[at]) * near * near;
        sum += g;
        for (int k = 0; k < b->channels; k++)
            colour[k] += g * v->set.colour[k][at];
    }
    const float use = part * c->trust * (sum < 1 ? sum : 1);
    found->smooth += part - use;
    found->weight += use;
    for (int k = 0; k < b->channels && use > 0; k++)
        found->colour[k] += use * (colour[k] / sum);
}

static void fill(const struct band *b, int x, int y)
{
    const struct hf_frame *f = b->f;
    struct found found = {.weight = 0};
    const struct hf_pattern_place place = place_at(&b->level[0], x, y);
    const float fx = ((float)((x + COARSE / 2) % COARSE) + 0.5f) / COARSE,
                fy = ((float)((y + COARSE / 2) % COARSE) + 0.5f) / COARSE;
    for (int i = 0; i < 4; i++) {
        const int right = i & 1, low = i >> 1;
        const struct choices *c =
            choices_at(b, (x + COARSE / 2) / COARSE - 1 + right, (y + COARSE / 2) / COARSE - 1 + low);
        if (c->count > 0)
            add_choices(b, c, place, x, y, (right ? fx : 1 - fx) * (low ? fy : 1 - fy), &found);
    }
    if (!(found.weight > 0))
        return;
    for (int c = 0; c < b->channels; c++) {
        float *colour = hf_at(&f->buf[HF_LAYERS_BUF_HIDDEN], c, x, y);
        const float now = (found.colour[c] + found.smooth * hf_layers_root(*colour)) / (found.weight + found.smooth);
        *colour = now * fabsf(now);
    }
}

void hf_layers_patterns_pass(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_layers *l = hf_layers(f->s);
    struct band b = {.f = f, .channels = l->channels, .region = region_of(r)};
    place(&b, f->work);
    if (!make_levels(&b))
        return;
    for (int y = r.y0 / COARSE - 1; y <= (r.y1 + COARSE - 1) / COARSE; y++)
        for (int x = r.x0 / COARSE - 1; x <= (r.x1 + COARSE - 1) / COARSE && !hf_stopped(f->s->stop); x++) {
            search(&b, x, y);
            search_fine(&b, x, y);
        }
    // Only places that were searched have a choice.
    for (int y = r.y0; y < hf_min(r.y1, f->s->half_height) && !hf_stopped(f->s->stop); y++)
        for (int x = r.x0; x < hf_min(r.x1, f->s->half_width); x++)
            if (b.level[0].nearest[y * b.level[0].set.stride + x] < HUGE_VALF)
                fill(&b, x, y);
}
