// SPDX-License-Identifier: BSD-3-Clause
// What a pixel's samples become. A medium is cut into parts of equal optical depth. Samples of nearly one blur are put over
// each other, as no lens looks between them; then those whose blur differs least, until SURFACES are left.
#include "frame/deep.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "frame/reading.h"
#include "pixel/depth.h"
#include "pixel/pass_c.h"

enum {
    PARTS = 8,     // of a medium
    SURFACES = 3,  // that a pixel keeps: what is seen, and two that may be hidden
    FEW = 16       // samples whose distances are all looked at
};
static const float ALIKE = 0.25f;  // pixels of radius that make no difference

// A sample, with its place in the order front to back: near, then what tells equally near ones apart.
struct deep_sample {
    float near;
    struct hf_sample s;
    uint32_t object;
};

struct work {
    struct hf_reading r;  // first
    const struct hf_deep_input *in;
    struct hf_context *c;
    int larger;                       // larger numbers are nearer
    char *scratch;                    // of all workers
    size_t worker_bytes, row, pixel;  // floats of a row's depths, samples of a pixel
};

// The scratch of a worker.
struct desk {
    struct deep_sample *samples;
    float *depths, *radii;
};

static struct desk desk_of(const struct work *w, int worker)
{
    char *at = w->scratch + (size_t)worker * w->worker_bytes;
    struct desk d = {.samples = (struct deep_sample *)(void *)at};
    d.depths = (float *)(void *)(d.samples + w->pixel);
    d.radii = d.depths + w->row;
    return d;
}

static int compare(const struct deep_sample *x, const struct deep_sample *y)
{
    const float a[] = {-x->s.alpha, x->s.colour[0], x->s.colour[1], x->s.colour[2]},
                b[] = {-y->s.alpha, y->s.colour[0], y->s.colour[1], y->s.colour[2]};
    if (x->near != y->near)
        return x->near < y->near ? -1 : 1;
    for (size_t i = 0; i < sizeof a / sizeof *a; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return (x->object > y->object) - (x->object < y->object);
}

static int by_depth(const void *a, const void *b)
{
    return compare(a, b);
}

// Samples of most files are in order already.
static void sort(struct deep_sample *s, size_t n)
{
    size_t sorted = 1;
    while (sorted < n && compare(&s[sorted - 1], &s[sorted]) <= 0)
        sorted++;
    if (sorted < n && n > FEW) {
        qsort(s, n, sizeof *s, by_depth);
        return;
    }
    for (size_t i = sorted; i < n; i++) {
        const struct deep_sample own = s[i];
        size_t at = i;
        for (; at > 0 && compare(&s[at - 1], &own) > 0; at--)
            s[at] = s[at - 1];
        s[at] = own;
    }
}

// Successive samples of one object are parts of the pixel beside each other: they add up to 1. As alpha over alpha that is
// more alpha for those behind.
static void add_objects(struct deep_sample *s, size_t n)
{
    float sum = 0;
    for (size_t i = 0; i < n; i++) {
        const int same = i > 0 && s[i].object && s[i].object == s[i - 1].object;
        const float own = s[i].s.alpha, left = 1 - sum;
        sum = same ? sum : 0;
        if (same && sum < 1) {
            const float alpha = own < left ? own / left : 1, by = alpha / own;
            s[i].s.alpha = alpha;
            for (int c = 0; c < 4; c++)
                s[i].s.colour[c] *= by;
        }
        sum = sum + own < 1 ? sum + own : 1;
    }
}

// Put b behind a.
static void join(struct deep_sample *a, const struct deep_sample *b)
{
    const float open = 1 - a->s.alpha, part = open * b->s.alpha, all = a->s.alpha + part;
    for (int c = 0; c < 4; c++)
        a->s.colour[c] = a->s.colour[c] + open * b->s.colour[c];
    a->s.radius = a->s.radius + (b->s.radius - a->s.radius) * (part / all);
    a->s.alpha = all < 1 ? all : 1;
}

// Join neighbours that differ by up to `apart`. Returns how many are left.
static size_t join_alike(struct deep_sample *s, size_t n, float apart)
{
    size_t last = 0;
    float first = n ? s[0].s.radius : 0;
    for (size_t i = 1; i < n; i++) {
        if (s[i].s.radius - first <= apart) {
            join(&s[last], &s[i]);
            continue;
        }
        s[++last] = s[i];
        first = s[last].s.radius;
    }
    return n ? last + 1 : 0;
}

// Join the two neighbours whose blur changes least by that; what is hidden counts for less.
static size_t join_nearest(struct deep_sample *s, size_t n)
{
    size_t best = 0;
    float least = FLT_MAX, open = 1, before = 0;
    for (size_t i = 0; i < n; i++) {
        const float weight = s[i].s.alpha * (0.75f * open + 0.25f);
        const float apart = i > 0 ? s[i].s.radius - s[i - 1].s.radius : 0;
        const float cost = weight * before / (weight + before) * (apart * apart);
        if (i > 0 && cost < least) {
            least = cost;
            best = i - 1;
        }
        before = weight;
        open *= 1 - s[i].s.alpha;
    }
    join(&s[best], &s[best + 1]);
    memmove(&s[best + 1], &s[best + 2], (n - best - 2) * sizeof *s);
    return n - 1;
}

// The samples of a pixel become at most SURFACES.
static int reduce(struct deep_sample *s, size_t n, struct hf_sample to[SURFACES])
{
    float apart = ALIKE;
    sort(s, n);
    add_objects(s, n);
    n = join_alike(s, n, apart);
    while (n > FEW)
        n = join_alike(s, n, apart *= 2);
    while (n > SURFACES)
        n = join_nearest(s, n);
    for (size_t i = 0; i < n; i++)
        to[i] = s[i].s;
    return (int)n;
}

// Whether sample i is a medium, one that reaches farther than its depth.
static int is_medium(const struct work *w, uint64_t i)
{
    const struct hf_deep *d = &w->in->deep;
    const float depth = d->depth[i], back = d->back ? d->back[i] : depth;
    return hf_is_finite(back) && hf_is_finite(depth) && (w->larger ? back < depth : back > depth);
}

// How near a number of the depth is: less is nearer.
static float near_of(const struct work *w, float depth)
{
    const int form = w->r.setup->form;
    if ((form == HF_FORM_Z || form == HF_FORM_RAY) && !(depth > 0))
        return INFINITY;
    return w->larger ? -depth : depth;
}

// The depth of part k of sample i, of `parts` equal ones.
static float depth_of(const struct work *w, uint64_t i, int k, int parts)
{
    const struct hf_deep *d = &w->in->deep;
    const float depth = d->depth[i];
    return parts == 1 ? depth : depth + (d->back[i] - depth) * (((float)k + 0.5f) / (float)parts);
}

// A row of the frame that has depths for the row's samples in place of pixels. Only rays need to know where they are.
static void find_radii(const struct work *w, struct hf_frame *f, const struct desk *d, int y, uint64_t from)
{
    const struct hf_deep *deep = &w->in->deep;
    const uint64_t *first = deep->first + (size_t)y * (size_t)deep->width;
    struct hf_depth depth = w->in->depth;
    float *line = f->depth_lines + (size_t)HF_DEPTH_LINES * f->line_floats;
    size_t n = 0;
    int x = 0;
    f->depth = &depth;
    depth.data = line;
    depth.stride = 0;
    for (uint64_t i = from; i < first[deep->width]; i++) {
        const int parts = is_medium(w, i) ? PARTS : 1;
        for (; first[x + 1] <= i; x++)
            ;
        for (int k = 0; k < parts; k++, n++) {
            d->depths[n] = depth_of(w, i, k, parts);
            line[x] = d->depths[n];
            if (f->s->form == HF_FORM_RAY)
                hf_radius_row_c(f, x, y, 1, &d->radii[n], NULL);
        }
    }
    for (size_t i = 0; i < n && f->s->form != HF_FORM_RAY; i += (size_t)deep->width) {
        const int count = n - i < (size_t)deep->width ? (int)(n - i) : deep->width;
        for (int k = 0; k < deep->width; k++)
            line[k] = k < count && d->depths[i + (size_t)k] == d->depths[i + (size_t)k] ? d->depths[i + (size_t)k] : 0;
        f->k->radius_row(f, 0, y, count, line + f->line_floats, NULL);
        memcpy(d->radii + i, line + f->line_floats, sizeof *d->radii * (size_t)count);
    }
}

// Sample i as samples of its pixel. Returns how many: none, if it shows nothing.
static size_t take(const struct work *w, uint64_t i, const float *depths, const float *radii, struct deep_sample *to)
{
    const struct hf_deep *d = &w->in->deep;
    const int parts = is_medium(w, i) ? PARTS : 1;
    const float alpha = hf_saturate(d->alpha[i]), part = parts == 1 ? alpha : -expm1f(log1pf(-alpha) / PARTS);
    if (!(alpha > 0) || d->depth[i] != d->depth[i])
        return 0;
    for (int k = 0; k < parts; k++) {
        to[k] = (struct deep_sample){.near = near_of(w, depths[k]),
                                     .s = {.radius = radii[k], .alpha = part},
                                     .object = d->object && parts == 1 ? d->object[i] : 0};
        for (int c = 0; c < 4; c++) {
            const float colour = c < 3 ? d->colour[c][i] : alpha;
            to[k].s.colour[c] = hf_is_finite(colour) ? colour * (part / alpha) : 0;
        }
    }
    return (size_t)parts;
}

static void merge_row(const struct work *w, struct hf_frame *f, const struct desk *d, int y)
{
    const struct hf_deep *deep = &w->in->deep;
    const uint64_t *first = deep->first + (size_t)y * (size_t)deep->width;
    size_t at = 0;
    find_radii(w, f, d, y, first[0]);
    for (int x = 0; x < deep->width; x++) {
        struct hf_sample to[SURFACES];
        size_t n = 0;
        for (uint64_t i = first[x]; i < first[x + 1]; i++) {
            n += take(w, i, d->depths + at, d->radii + at, d->samples + n);
            at += is_medium(w, i) ? PARTS : 1;
        }
        hf_merge_pixel(&w->r, to, reduce(d->samples, n, to), y * w->r.known->stride + x, f->counts);
    }
}

static void merge_piece(void *arg, int i, int worker)
{
    const struct work *w = arg;
    struct hf_frame f = hf_reading_frame(&w->r, 0, worker);
    const struct desk d = desk_of(w, worker);
    const int y0 = i * HF_READING_ROWS;
    for (int y = y0; y < hf_min(y0 + HF_READING_ROWS, w->r.s->height) && !hf_stopped(w->r.s->stop); y++)
        merge_row(w, &f, &d, y);
}

// Place the desks of the workers: a row's depths and radii, and a pixel's samples.
static int place_desks(struct work *w)
{
    const size_t parts = w->in->deep.back ? PARTS : 1, most = SIZE_MAX / 4096;
    if (w->in->most_in_row > most || w->in->most_in_pixel > most)
        return HF_ERR_MEMORY;
    w->row = (size_t)w->in->most_in_row * parts;
    w->pixel = (size_t)w->in->most_in_pixel * parts + 1;
    w->worker_bytes = (w->pixel * sizeof(struct deep_sample) + 2 * w->row * sizeof(float) + 63) / 64 * 64;
    if (hf_block_grow(&w->c->samples, w->worker_bytes * (size_t)w->c->threads, &w->c->mem))
        return HF_ERR_MEMORY;
    w->scratch = w->c->samples.data;
    return HF_OK;
}

int hf_deep_merge(struct hf_context *c, const struct hf_setup *s, const struct hf_deep_input *in, int fused,
                  struct hf_merged *merged, struct hf_known *known)
{
    // What sets up a surface: a picture with alpha, and the depth.
    const struct hf_surface_input as = {.image = {.format = HF_FORMAT_RGBA32F}, .depth = in->depth};
    struct hf_setup setup;
    struct work w = {
        .r = {.c = c, .s = s, .in = &as, .known = known, .fused = fused, .count = 1},
        .in = in,
        .c = c,
        .larger = in->depth.type == HF_DEPTH_NDC_REVERSED || in->depth.type == HF_DEPTH_INVERSE,
    };
    float *memory = hf_reading_begin(&w.r, &setup, 1, HF_MERGED_PLANES, 2);
    if (!memory || place_desks(&w))
        return HF_ERR_MEMORY;
    hf_reading_merged(&w.r, memory, merged);
    return hf_reading_finish(&w.r, w.r.pieces, merge_piece);
}
