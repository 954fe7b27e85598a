// SPDX-License-Identifier: BSD-3-Clause
// The slices of the reference, and how they are composited.
#include <string.h>

#include "support/layers_reference_parts.h"

// ---- slices ----

static double next_radius(const struct frame *f, double r)
{
    const double spacing = f->set.spacing;
    if (r < 1)
        return r + 1;
    if (f->fine > 1)
        return r + fmin(fmax(0.5, r / 4), fmax(1, r / 16)) * spacing / 2;
    return r + fmax(fmin(fmax(1, floor(r / (2 + f->fine))), spacing), r / 32);
}

int layers_reference_level_of(const struct frame *f, double r)
{
    return fabs(r) < f->half                                      ? 0
           : fabs(r) < f->quarter                                 ? 1
           : fabs(r) < (f->aperture.picture ? 2 : 4) * f->quarter ? 2
                                                                  : 3;
}

// Whether hidden samples skip slice n, counted from the focus: its neighbours are coarser than half resolution and
// close to each other.
static int is_left_out(const struct frame *f, int n, double before, double r)
{
    return n % 2 && layers_reference_level_of(f, before) > 1 && next_radius(f, r) - before <= r / 8;
}

// Behind the focus, how much of a highlight is drawn as one: nothing until an eighth of the way from the last slice of the
// middle stack to the next, by the square of the radius; all from a quarter on.
double layers_reference_shared(const struct frame *f, double r)
{
    double from = 0, to = next_radius(f, 0);
    for (; layers_reference_level_of(f, to) == 0; to = next_radius(f, to))
        from = to;
    return r > 0 ? fmin(fmax(8 * (r * r - from * from) / (to * to - from * from) - 1, 0), 1) : 1;
}

double layers_reference_part_of(const struct slice *s, double r)
{
    if (r <= s->before || r >= s->after)
        return 0;
    if (r < s->own)
        return isinf(s->before) ? 1 : (r * r - s->before * s->before) / (s->own * s->own - s->before * s->before);
    return isinf(s->after) ? 1 : 1 - (r * r - s->own * s->own) / (s->after * s->after - s->own * s->own);
}

// How much a sample of that radius, at an edge of the frame, counts beyond it: twice the depth at which its surface, of at
// least half its radius and surely of a quarter, is seen inside, over its radius. Samples up to 2 pixels before the focus
// count fully, from 4 on as is said here.
static double part_beyond(const struct frame *f, double radius, int x, int y, int dx, int dy)
{
    const double near = fmin(fmax(-radius / 2 - 1, 0), 1);
    double open = 1, deep = 0;
    for (int i = 0; near > 0 && i < -radius && i < (dx ? f->width : f->height); i++) {
        double here = 0;
        for (int k = 0; k < 2; k++) {
            const double *s = at(k ? &f->mixed : &f->seen, x + i * dx, y + i * dy);
            here += s[WEIGHT] > 0 ? s[WEIGHT] * fmin(fmax(4 * s[RADIUS] / radius - 1, 0), 1) : 0;
        }
        open = fmin(open, here);
        deep += open * fmin(-radius - i, 1);
    }
    return near > 0 ? 1 - near * (1 - fmin(2 * deep / -radius, 1)) : 1;
}

// How much a visible or mixed sample at (x, y) counts there, which may be beyond the frame.
static double counts(const struct frame *f, const double *sample, int x, int y)
{
    const int inside_x = clamp(x, 0, f->width - 1), inside_y = clamp(y, 0, f->height - 1);
    double part = 1;
    if (!(sample[WEIGHT] > 0))
        return 0;
    // At odd sizes the last column or row is doubled first.
    if (x < 0 || x >= (f->width + 1) / 2 * 2)
        part *= part_beyond(f, sample[RADIUS], inside_x, inside_y, x < 0 ? 1 : -1, 0);
    if (y < 0 || y >= (f->height + 1) / 2 * 2)
        part *= part_beyond(f, sample[RADIUS], inside_x, inside_y, 0, y < 0 ? 1 : -1);
    return part;
}

// What lies before a radius, as layers_reference_before().
static double before_beyond(const struct frame *f, int x, int y, double radius)
{
    double sum = 0;
    for (int k = 0; k < 2; k++) {
        const double *s = edge(k ? &f->mixed : &f->seen, x, y), part = counts(f, s, x, y);
        sum += part > 0 ? part * s[WEIGHT] * layers_reference_hides(radius - s[RADIUS]) : 0;
    }
    return sum;
}

// The hidden sample of a quad as that of pixel (x, y): its weight goes to the parts that lie before it, and is at most
// theirs.
static void spread(const struct frame *f, const struct grid *set, int x, int y, double *out)
{
    const int left = 2 * (int)floor(x / 2.0), top = 2 * (int)floor(y / 2.0);
    double before = 0, own = 0;
    memcpy(out, edge(set, left / 2, top / 2), SAMPLE * sizeof *out);
    for (int i = 0; i < 4; i++) {
        const double w = before_beyond(f, left + i % 2, top + i / 2, out[RADIUS]);
        before += w / 4;
        own = left + i % 2 == x && top + i / 2 == y ? w : own;
    }
    out[WEIGHT] = before > 0 ? own * fmin(out[WEIGHT] / before, 1) : 0;
}

void layers_reference_add(const struct frame *f, const struct slice *s, const struct grid *set, int apart,
                          enum kind kind, int light, int quads, struct grid *to)
{
    for (int y = to->y0 * (1 << apart); y < to->y1 * (1 << apart); y++)
        for (int x = to->x0 * (1 << apart); x < to->x1 * (1 << apart); x++) {
            double pixel[SAMPLE];
            const double *v = edge(set, x, y);
            if (kind == SHINE && f->square &&
                (floor(x / (double)LAYERS_REFERENCE_SQUARE) != f->square[0] ||
                 floor(y / (double)LAYERS_REFERENCE_SQUARE) != f->square[1]))
                continue;
            if (quads) {
                spread(f, set, x, y, pixel);
                v = pixel;
            }
            double *out =
                at(to, x >= 0 ? x >> apart : -((-x - 1) >> apart) - 1, y >= 0 ? y >> apart : -((-y - 1) >> apart) - 1);
            const double all = set == &f->seen || set == &f->mixed ? counts(f, v, x, y) : 1;
            const double part = v[WEIGHT] > 0 ? all * layers_reference_part_of(s, v[RADIUS]) / pow(4, apart) : 0;
            const double w = part * (kind == SHINE           ? v[SHARE]
                                     : kind == SEEN && light ? v[WEIGHT] - v[SHARE]
                                                             : v[WEIGHT]);
            for (int c = 0; c < f->channels; c++)
                out[c] += w * v[c];
            out[4] += w;
        }
}

// Draw the shape of every source.
static void scatter(const struct layers_shape *s, const struct grid *source, const struct grid *out)
{
    const int reach = s->reach;
    for (int y = source->y0; y < source->y1; y++)
        for (int x = source->x0; x < source->x1; x++) {
            const double *v = at(source, x, y);
            if (v[4] == 0)
                continue;
            for (int j = clamp(y - reach, out->y0, out->y1); j < clamp(y + reach + 1, out->y0, out->y1); j++)
                for (int i = clamp(x - reach, out->x0, out->x1); i < clamp(x + reach + 1, out->x0, out->x1); i++) {
                    const double k = s->weight[(j - y + reach) * (2 * reach + 1) + i - x + reach];
                    for (int c = 0; c < 5; c++)
                        at(out, i, j)[c] += k * v[c];
                }
        }
}

// The distance of the columns at which a cat's eye is made: from one to the next its second circle moves by at most 1.5
// pixels. Between them the shapes are blended. wide: how far they have the double distance, in its last quarter.
static int node_apart(const struct frame *f, double r, int level, double *wide)
{
    const double far =
        1.5 * hypot(f->width, f->height) / (1 << level) / (2 * f->aperture.cat_eye * r * fmax(f->wide, 1));
    int n = 4;
    while (2 * n <= far && n < 256)
        n *= 2;
    *wide = n < 256 ? fmax(4 * far / n - 7, 0) : 0;
    return n;
}

// A cat's eye is the part of the shape in a second circle. The circle is that of the pixel drawn to: moved by cat_eye
// radii towards the corner there, and before the focus the other way.
static void gather_cut(const struct frame *f, struct layers_shape *s, int sign, int level, const struct grid *source,
                       const struct grid *out)
{
    double wide = 0;
    const int reach = s->reach, apart = s->r > 0 ? node_apart(f, s->r, level, &wide) : 1, size = 1 << level;
    const double move = sign * (double)f->aperture.cat_eye * s->r / hypot(f->width, f->height);
    for (int node = (out->x0 / apart - 2) * apart; node < out->x1 + 2 * apart; node += apart)
        for (int y = out->y0; y < out->y1; y++) {
            const double px = fmin(fmax((node + 0.5) * size, 0), f->width),
                         py = fmin(fmax((y + 0.5) * size, 0), f->height);
            layers_shape_cut(f, s, move * (2 * px - f->width) * f->wide, move * (2 * py - f->height), s->r);
            for (int x = clamp(node - 2 * apart, out->x0, out->x1); x < clamp(node + 2 * apart, out->x0, out->x1); x++)
                for (int j = -reach; j <= reach; j++)
                    for (int i = -reach; i <= reach; i++) {
                        const double *v = at(source, clamp(x - i, source->x0, source->x1 - 1),
                                             clamp(y - j, source->y0, source->y1 - 1));
                        const double near = fmax(1 - abs(x - node) / (double)apart, 0),
                                     far = node % (2 * apart) ? 0 : 1 - abs(x - node) / (2.0 * apart);
                        const double k =
                            ((1 - wide) * near + wide * far) * s->weight[(j + reach) * (2 * reach + 1) + i + reach];
                        for (int c = 0; c < 5; c++)
                            at(out, x, y)[c] += k * v[c];
                    }
        }
}

// A slice's sums of one kind at a level, with a shape of some radius.
static struct grid draw_at(const struct frame *f, const struct slice *s, double radius, int level, enum kind kind,
                           int light)
{
    struct frame side = *f;
    side.turned = radius < 0;
    struct layers_shape shape =
        layers_shape_new(&side, fabs(radius) * (1 + (radius < 0 ? -f->shift : f->shift)) / (1 << level));
    const int reach = shape.reach;
    const int width = (f->width - 1) / (1 << level) + 1, height = (f->height - 1) / (1 << level) + 1,
              m = MARGIN + reach;
    struct grid source = grid_new(-m, -m, width + m, height + m, 5);
    struct grid out = grid_new(-MARGIN, -MARGIN, width + MARGIN, height + MARGIN, 5);
    if (kind == BEHIND) {
        layers_reference_add(f, s, &f->behind, level ? level - 1 : 0, kind, 0, !level, &source);
        layers_reference_add(f, s, &f->beyond, level ? level - 1 : 0, kind, 0, !level, &source);
    } else {
        layers_reference_add(f, s, &f->seen, level, kind, light, 0, &source);
        if (kind == SEEN)
            layers_reference_add(f, s, &f->mixed, level, BEHIND, 0, 0, &source);
    }
    if (f->aperture.cat_eye > 0)
        gather_cut(f, &shape, s->own < 0 ? -1 : 1, level, &source, &out);
    else
        scatter(&shape, &source, &out);
    free(source.v);
    layers_shape_free(&shape);
    return out;
}

struct grid layers_reference_draw(const struct frame *f, const struct slice *s, int level, enum kind kind, int light)
{
    return draw_at(f, s, s->own, level, kind, light);
}

double layers_reference_up(const struct grid *g, int c, int x, int y)
{
    const int xa = x >= 0 ? x / 2 : -((1 - x) / 2), ya = y >= 0 ? y / 2 : -((1 - y) / 2);
    const int xb = x - 2 * xa ? xa + 1 : xa - 1, yb = y - 2 * ya ? ya + 1 : ya - 1;
    return 0.75 * (0.75 * edge(g, xa, ya)[c] + 0.25 * edge(g, xb, ya)[c]) +
           0.25 * (0.75 * edge(g, xa, yb)[c] + 0.25 * edge(g, xb, yb)[c]);
}

// Upsample a grid until it has the pixels of level `to`.
static void refine(struct grid *g, const struct frame *f, int level, int to)
{
    for (; level > to; level--) {
        const int width = (f->width - 1) / (1 << (level - 1)) + 1, height = (f->height - 1) / (1 << (level - 1)) + 1;
        struct grid fine = grid_new(-MARGIN, -MARGIN, width + MARGIN, height + MARGIN, g->n);
        for (int y = fine.y0; y < fine.y1; y++)
            for (int x = fine.x0; x < fine.x1; x++)
                for (int c = 0; c < g->n; c++)
                    at(&fine, x, y)[c] = layers_reference_up(g, c, x, y);
        free(g->v);
        *g = fine;
    }
}

// ---- stacks: colour, weight (4), openness (5), what hidden samples may still cover (6), and visible coverage behind
// the focus that is withheld for them (7) ----

enum { OPEN = 5, BEHIND_OPEN, HELD, STACK };

static struct grid stack_new(const struct frame *f, int level)
{
    const int width = (f->width - 1) / (1 << level) + 1, height = (f->height - 1) / (1 << level) + 1;
    struct grid g = grid_new(-MARGIN, -MARGIN, width + MARGIN, height + MARGIN, STACK);
    for (int y = g.y0; y < g.y1; y++)
        for (int x = g.x0; x < g.x1; x++)
            at(&g, x, y)[OPEN] = at(&g, x, y)[BEHIND_OPEN] = 1;
    return g;
}

// Put sums under a stack. Visible samples before the focus hide others;
// those behind it belong to surfaces of which other parts are hidden.
enum sums { HIDING, WITH_HIDDEN, HELD_BACK, HIDDEN };

static void put_under(struct grid *stack, const struct grid *sums, enum sums kind)
{
    for (int y = stack->y0; y < stack->y1; y++)
        for (int x = stack->x0; x < stack->x1; x++) {
            double *s = at(stack, x, y), *v = edge(sums, x, y);
            const double hold = kind == HELD_BACK ? fmin(v[4], s[HELD]) : 0;
            const double k =
                hold > 0 ? fmin(v[4] - hold, s[OPEN]) / v[4]
                         : s[OPEN] / fmax(v[4], fmax(fmax(s[OPEN], kind == HIDDEN ? s[BEHIND_OPEN] : 0), 1e-30));
            s[HELD] -= hold;
            for (int c = 0; c < 5; c++)
                s[c] += k * v[c];
            s[OPEN] = fmax(0, s[OPEN] - k * v[4]);
            s[BEHIND_OPEN] -= kind == HIDING ? 0 : fmin(v[4], s[BEHIND_OPEN]);
        }
}

// Put one slice into its stack.
static void put_slice(const struct frame *f, const struct slice *s, struct grid *stack)
{
    const int level = layers_reference_level_of(f, s->own), finest = level ? 1 : 0;
    struct grid sums = layers_reference_draw(f, s, level, SEEN, f->highlights && level);
    refine(&sums, f, level, finest);
    put_under(stack, &sums, level ? s->own < 0 ? HIDING : WITH_HIDDEN : s->own > 0 ? HELD_BACK : WITH_HIDDEN);
    free(sums.v);
    if (layers_reference_levels(f) && s->hidden[0] < s->hidden[1]) {
        const struct slice behind = {s->hidden[0], s->own, s->hidden[1], {0}};
        const int coarse = level > 1 ? level : level == 0 && fabs(s->own) < 2 ? 0 : 1;
        struct grid hidden = layers_reference_draw(f, &behind, coarse, BEHIND, 0);
        refine(&hidden, f, coarse, finest);
        put_under(stack, &hidden, HIDDEN);
        free(hidden.v);
    }
}

// Samples between the last slice of the middle and the first of the far stack: the middle's part reduces the far
// stack's openness, and is 0 at the slice's own radius. lift receives the factor by which the far stack's sums are
// multiplied for that.
static void cover(const struct frame *f, const struct slice *last, struct grid *far, struct grid *lift)
{
    const double from = last->own * last->own, to = last->after * last->after;
    for (int y = far->y0; y < far->y1; y++)
        for (int x = far->x0; x < far->x1; x++)
            at(lift, x, y)[0] = 1;
    for (int hidden = 0; hidden <= (layers_reference_levels(f) > 0) && isfinite(last->after); hidden++) {
        const struct slice s = {last->own, sqrt((7 * from + to) / 8), last->after, {0}};
        struct grid sums = draw_at(f, &s, last->own, 1, hidden ? BEHIND : SEEN, 0);
        for (int y = far->y0; y < far->y1; y++)
            for (int x = far->x0; x < far->x1; x++) {
                double *v = at(far, x, y);
                const double left = fmax(1 - 0.875 * edge(&sums, x, y)[4], 0);
                v[OPEN] *= left;
                v[BEHIND_OPEN] *= hidden ? left : 1;
                at(lift, x, y)[0] = 1 / fmax(v[OPEN], 1.0 / 16);
            }
        free(sums.v);
    }
}

static int slices_new(const struct frame *f, struct slice **out)
{
    int count[2] = {0};
    for (int side = 0; side < 2; side++) {
        double r = 0, before = 0;
        for (; r < (side ? f->high : -f->low) || is_left_out(f, count[side], before, r); count[side]++) {
            before = r;
            r = next_radius(f, r);
        }
    }
    const int near = count[0], far = count[1];
    struct slice *s = calloc((size_t)(near + far) + 1, sizeof *s);
    int *left_out = calloc((size_t)(near + far) + 1, sizeof *left_out);
    if (!s || !left_out)
        abort();
    for (int side = -1; side <= 1; side += 2) {
        double r, before = 0;
        for (int i = 1; i <= count[side > 0]; i++, before = r) {
            r = next_radius(f, before);
            s[near + side * i].own = side * r;
            left_out[near + side * i] = is_left_out(f, i, before, r);
        }
    }
    for (int i = 0; i <= near + far; i++) {
        s[i].before = i ? s[i - 1].own : -INFINITY;
        s[i].after = i < near + far ? s[i + 1].own : INFINITY;
    }
    // The neighbours of a slice that is left out are kept.
    for (int i = 0; i <= near + far; i++) {
        s[i].hidden[0] = left_out[i] ? 0 : i && left_out[i - 1] ? s[i - 1].before : s[i].before;
        s[i].hidden[1] = left_out[i] ? 0 : i < near + far && left_out[i + 1] ? s[i + 1].after : s[i].after;
    }
    free(left_out);
    *out = s;
    return near + far + 1;
}

static void put_together(const struct frame *f, struct picture *out)
{
    struct slice *s;
    const int count = slices_new(f, &s);
    struct grid near = stack_new(f, 1), far = stack_new(f, 1), middle = stack_new(f, 0);
    int i = 0, first;
    for (; i < count && s[i].own < 0 && layers_reference_level_of(f, s[i].own); i++)
        put_slice(f, &s[i], &near);
    struct grid light[2] = {layers_reference_lights(f, s, count, 0, i, NULL)};
    for (int y = 0; y < f->height; y++)
        for (int x = 0; x < f->width; x++) {
            double *m = at(&middle, x, y);
            for (int c = 0; c < 5; c++)
                m[c] = layers_reference_up(&near, c, x, y);
            m[OPEN] = fmax(0, 1 - m[4] - at(&light[0], x, y)[4]);
            m[BEHIND_OPEN] = layers_reference_up(&near, BEHIND_OPEN, x, y);
        }
    for (; i < count && !layers_reference_level_of(f, s[i].own); i++) {
        // A part of the near coverage is withheld from visible samples behind the focus.
        const double part = f->hidden ? (f->patterns ? 0.75 : 0.25) : 0;
        for (int p = 0; s[i].own == 0 && p < f->width * f->height; p++) {
            double *m = at(&middle, p % f->width, p / f->width);
            m[HELD] = part * (1 - m[OPEN]);
        }
        put_slice(f, &s[i], &middle);
    }
    struct grid lift = grid_new(far.x0, far.y0, far.x1, far.y1, 1);
    cover(f, &s[i - 1], &far, &lift);
    first = i;
    for (; i < count; i++)
        put_slice(f, &s[i], &far);
    light[1] = layers_reference_lights(f, s, count, first, count, &lift);
    for (int y = far.y0; y < far.y1; y++)
        for (int x = far.x0; x < far.x1; x++)
            for (int c = 0; c < 5; c++)
                at(&far, x, y)[c] *= at(&lift, x, y)[0];
    for (int y = 0; y < f->height; y++)
        for (int x = 0; x < f->width; x++) {
            // The middle stack leaves light as much as it leaves of what the near one leaves. Sums fill what light leaves.
            const double *m = at(&middle, x, y), *l[2] = {at(&light[0], x, y), at(&light[1], x, y)};
            const double a = layers_reference_up(&far, 4, x, y), w = fmin(m[4] + l[0][4], 1),
                         n = fmin(layers_reference_up(&near, 4, x, y) + l[0][4], 1),
                         left = fmin(fmax(1 - (w - n) / fmax(1 - n, 1.0 / 64), 0), 1), lit = l[0][4] + left * l[1][4],
                         g = fmax(1 - m[4] - lit, 0) / fmax(fmax(a, (f->hidden ? 0.5 : 1e-3) - l[1][5]), 1e-30),
                         sum = m[4] + g * a;
            for (int c = 0; c < f->channels; c++) {
                const double own = sum > 1e-30 ? (m[c] + g * layers_reference_up(&far, c, x, y)) / sum
                                               : (double)f->colour->plane[c][y * f->width + x];
                if (sum > 1e-30 || lit > 0)
                    out->plane[c][y * f->width + x] = (float)(fmax(1 - lit, 0) * own + l[0][c] + left * l[1][c]);
            }
        }
    free(near.v);
    free(far.v);
    free(lift.v);
    free(middle.v);
    free(light[0].v);
    free(light[1].v);
    free(s);
}

struct picture layers_reference(const struct picture *colour, const float *radius, const struct hf_params *params)
{
    const struct hf_layers_params *p = &params->layers;
    struct frame f = {.colour = colour,
                      .radius = radius,
                      .width = colour->width,
                      .height = colour->height,
                      .channels = colour->channels,
                      .set = *p,
                      .aperture = params->aperture,
                      .fine = p->quality == HF_LAYERS_DRAFT      ? 0
                              : p->quality == HF_LAYERS_STANDARD ? 1
                                                                 : 2,
                      .unmix = !p->no_unmix,
                      .hidden = !p->no_hidden && p->quality != HF_LAYERS_DRAFT,
                      .highlights = !p->no_highlights,
                      .patterns = !p->no_patterns && p->quality == HF_LAYERS_BEST,
                      .wide = 1 / ((double)params->view.pixel_aspect * params->aperture.squeeze),
                      .half = p->half_from,
                      .quarter = p->quarter_from};
    struct picture out = picture_copy(colour);  // pixels that nothing reaches stay
    for (int i = 0; i < f.width * f.height; i++) {
        f.low = fmin(f.low, radius[i]);
        f.high = fmax(f.high, radius[i]);
    }
    layers_reference_samples(&f);
    // Red discs are larger behind the focus and smaller before it, blue ones the other way; alpha belongs to green. A
    // coloured aperture picture has a shape for each channel.
    const int groups = f.aperture.chromatic != 0 || f.aperture.picture ? 3 : 1;
    for (int i = 0; i < groups; i++) {
        struct picture group = picture_new(f.width, f.height, f.channels);
        f.shift = f.aperture.chromatic == 0 ? 0 : (1 - i) * (double)f.aperture.chromatic;
        f.plane = f.aperture.picture ? i : 0;
        put_together(&f, &group);
        for (int c = 0; c < f.channels; c++)
            if (groups == 1 || i == (c < 3 ? c : 1))
                memcpy(out.plane[c], group.plane[c], (size_t)f.width * (size_t)f.height * sizeof(float));
        picture_free(&group);
    }
    free(f.seen.v);
    free(f.mixed.v);
    free(f.behind.v);
    free(f.beyond.v);
    return out;
}
