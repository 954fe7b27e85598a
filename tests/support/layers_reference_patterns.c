// SPDX-License-Identifier: BSD-3-Clause
// Hidden samples take the colour of places that look alike.
#include <string.h>

#include "support/layers_reference_parts.h"

enum { WINDOW = 4, CHOICES = 6, MOST = 81, SHIFT = 7 };

// The visible samples of a level, and its places: radius (0) of the hidden sample, and that of what hides it (1),
// INFINITY where nothing is hidden.
struct level {
    struct grid seen, place;
    double scale;  // size of its pixels, in eighths of the resolution
};

struct choices {
    int count, x[CHOICES], y[CHOICES];
    double off[CHOICES], variance, unseen, trust;
};

struct patch {
    double radius, slope, sum, variance, unseen, weight[MOST], colour[MOST][4];
    int count, x[MOST], y[MOST];
};

static double unit(double v)
{
    return fmin(fmax(v, 0), 1);
}

static double known(const struct level *v, double radius, double slope, int x, int y)
{
    if (x < v->seen.x0 || y < v->seen.y0 || x >= v->seen.x1 || y >= v->seen.y1)
        return 0;
    const double *s = at(&v->seen, x, y);
    return s[WEIGHT] > 0 ? unit(2 - fabs(s[RADIUS] - radius) * slope) * unit(9 * s[WEIGHT]) : 0;
}

static struct level halve(const struct level *from, int channels)
{
    const int width = (from->seen.x1 + 1) / 2, height = (from->seen.y1 + 1) / 2;
    struct level to = {grid_new(0, 0, width, height, SAMPLE), grid_new(0, 0, width, height, 2), 2 * from->scale};
    for (int i = 0; i < width * height; i++) {
        const int x = i % width, y = i / width;
        const double *in[4];
        double *place = at(&to.place, x, y), count = 0;
        static const double none[SAMPLE];
        place[1] = INFINITY;
        for (int k = 0; k < 4; k++) {
            const int px = 2 * x + k % 2, py = 2 * y + k / 2;
            in[k] = none;
            if (px >= from->seen.x1 || py >= from->seen.y1)
                continue;
            in[k] = at(&from->seen, px, py);
            const double *p = at(&from->place, px, py);
            count += p[1] < INFINITY;
            place[0] += p[1] < INFINITY ? p[0] : 0;
            place[1] = fmin(place[1], p[1]);
        }
        place[0] /= fmax(count, 1);
        layers_reference_merge(in, 4, 4, 0.25, channels, at(&to.seen, x, y));
    }
    return to;
}

static void look_around(const struct level *v, int channels, int x, int y, struct patch *p)
{
    double mean[4] = {0}, square = 0, all = 0;
    p->count = 0;
    p->sum = 0;
    for (int i = 0; i < MOST; i++) {
        const int dx = i % 9 - WINDOW, dy = i / 9 - WINDOW, away = dx * dx + dy * dy;
        const double w = known(v, p->radius, p->slope, x + dx, y + dy) / (1 + away / 4.0);
        all += away <= 19 ? 1 / (1 + away / 4.0) : 0;
        if (away > 19 || !(w > 0))
            continue;
        p->x[p->count] = dx;
        p->y[p->count] = dy;
        p->weight[p->count] = w;
        p->sum += w;
        for (int c = 0; c < channels; c++) {
            const double colour = p->colour[p->count][c] = at(&v->seen, x + dx, y + dy)[c];
            mean[c] += w * colour;
            square += w * colour * colour;
        }
        p->count++;
    }
    p->unseen = 1e-30 + (p->sum > 0 ? 0.0002 * square / p->sum : 0);
    for (int c = 0; c < channels && p->sum > 0; c++)
        square -= mean[c] * mean[c] / p->sum;
    p->variance = p->sum > 0 ? fmax(square, 0) / p->sum : 0;
    p->count = p->sum < all / 10 ? 0 : p->count;
}

static void choose(struct choices *c, int x, int y, double off)
{
    int i = 0;
    while (i < c->count && (abs(c->x[i] - x) > 1 || abs(c->y[i] - y) > 1))
        i++;
    if ((i < c->count && off >= c->off[i]) || (i == CHOICES && off >= c->off[CHOICES - 1]))
        return;
    if (i == c->count)
        i = i < CHOICES ? c->count++ : CHOICES - 1;
    for (; i > 0 && c->off[i - 1] > off; i--) {
        c->x[i] = c->x[i - 1];
        c->y[i] = c->y[i - 1];
        c->off[i] = c->off[i - 1];
    }
    c->x[i] = x;
    c->y[i] = y;
    c->off[i] = off;
}

// Compare with the surroundings of (x + sx, y + sy).
static void compare(const struct level *v, int channels, const struct patch *p, int x, int y, int sx, int sy,
                    struct choices *c)
{
    const double middle = known(v, p->radius, p->slope, x + sx, y + sy);
    double sum = 0, off = 0;
    for (int i = 0; i < p->count && middle > 0; i++) {
        const int px = x + sx + p->x[i], py = y + sy + p->y[i];
        const double k = known(v, p->radius, p->slope, px, py) * p->weight[i];
        sum += k;
        for (int j = 0; j < channels && k > 0; j++)
            off += k * pow(at(&v->seen, px, py)[j] - p->colour[i][j], 2);
    }
    if (middle > 0)
        choose(c, sx, sy,
               (off + fmax(p->sum - sum, 0) * p->variance) / p->sum +
                   (1 - middle + 0.01 * ((sy + sx / 16.0) * v->scale + 10) / 20) * p->variance);
}

static void end_choices(struct choices *c, const struct patch *p)
{
    c->variance = p->variance;
    c->unseen = p->unseen;
    c->trust = c->count ? fmax(1 - c->off[0] / (0.5 * p->variance + p->unseen), 0) : 0;
}

static void refine(const struct level *v, int channels, const struct patch *p, int x, int y, const struct choices *from,
                   struct choices *to)
{
    for (int i = 0; i < from->count; i++)
        for (int k = 0; k < 9; k++)
            compare(v, channels, p, x, y, 2 * from->x[i] + k % 3 - 1, 2 * from->y[i] + k / 3 - 1, to);
}

// The hidden surface at a place; 0: nothing is hidden there.
static int surface(const struct level *v, int x, int y, struct patch *p)
{
    const double *place = at(&v->place, x, y);
    p->radius = place[0];
    p->slope = 4 / fmax(place[0] - place[1], 1);
    return place[1] < INFINITY;
}

static struct choices doubled(struct choices c)
{
    for (int i = 0; i < c.count; i++) {
        c.x[i] *= 2;
        c.y[i] *= 2;
    }
    return c;
}

static struct choices search(const struct level *v, int channels, int x, int y)
{
    struct choices c = {0};
    struct patch p;
    if (!surface(v, x, y, &p))
        return c;
    look_around(v, channels, x, y, &p);
    for (int sy = -SHIFT; sy <= SHIFT && p.count; sy++)
        for (int sx = -SHIFT; sx <= SHIFT; sx++)
            if (sx || sy)
                compare(v, channels, &p, x, y, sx, sy, &c);
    end_choices(&c, &p);
    return c;
}

// Refine the choices of an eighth of the resolution to a quarter and to half of it.
static struct choices search_fine(const struct level *v, int channels, int x, int y)
{
    struct choices c = search(&v[2], channels, x, y);
    struct patch p;
    surface(&v[2], x, y, &p);
    for (int j = 1; j >= 0 && c.count; j--) {
        const int px = j ? 2 * x : 4 * x + 2, py = j ? 2 * y : 4 * y + 2;
        struct choices finer = {0};
        look_around(&v[j], channels, px, py, &p);
        if (!p.count) {
            c = doubled(c);
            continue;
        }
        refine(&v[j], channels, &p, px, py, &c, &finer);
        end_choices(&finer, &p);
        c = finer;
    }
    return c;
}

// The colour (root) of place (x, y), from the choices of the four samples around it.
static void fill(const struct level *v, const struct choices *chosen, int channels, int x, int y, const double *was,
                 double *out)
{
    const int wide = v[2].seen.x1, high = v[2].seen.y1, left = (x + 2) / 4 - 1, above = (y + 2) / 4 - 1;
    const double fx = ((x + 2) % 4 + 0.5) / 4, fy = ((y + 2) % 4 + 0.5) / 4;
    double total[4] = {0}, weight = 0, smooth = 0;
    struct patch p;
    surface(v, x, y, &p);
    for (int i = 0; i < 4; i++) {
        const int px = left + i % 2, py = above + i / 2;
        const double part = (i % 2 ? fx : 1 - fx) * (i / 2 ? fy : 1 - fy);
        if (px < 0 || py < 0 || px >= wide || py >= high)
            continue;
        const struct choices *c = &chosen[py * wide + px];
        double sum = 0, colour[4] = {0};
        for (int k = 0; k < c->count; k++) {
            const double near = fmax(1 - (c->off[k] - c->off[0]) / (0.4 * c->variance + 4 * c->unseen), 0);
            const double g = known(v, p.radius, p.slope, x + c->x[k], y + c->y[k]) * pow(near, 4);
            sum += g;
            for (int j = 0; j < channels && g > 0; j++)
                colour[j] += g * at(&v->seen, x + c->x[k], y + c->y[k])[j];
        }
        const double use = part * c->trust * fmin(sum, 1);
        smooth += c->count ? part - use : 0;
        weight += use;
        for (int j = 0; j < channels && use > 0; j++)
            total[j] += use * colour[j] / sum;
    }
    for (int c = 0; c < channels; c++)
        out[c] = weight > 0 ? (total[c] + smooth * was[c]) / (weight + smooth) : was[c];
}

void layers_reference_patterns(const struct frame *f, const struct grid *quads, struct grid *hidden)
{
    const int channels = f->channels;
    struct level v[3] = {{*quads, grid_new(0, 0, quads->x1, quads->y1, 2), 0.25}};
    for (int i = 0; i < quads->x1 * quads->y1; i++) {
        const int x = i % quads->x1, y = i / quads->x1;
        double *place = at(&v[0].place, x, y);
        place[0] = at(hidden, x, y)[RADIUS];
        place[1] = INFINITY;
        for (int k = 0; k < 4 && at(hidden, x, y)[WEIGHT] > 0; k++)
            place[1] = fmin(layers_reference_hides_from(f, 2 * x + k % 2, 2 * y + k / 2), place[1]);
    }
    v[1] = halve(&v[0], channels);
    v[2] = halve(&v[1], channels);
    const int wide = v[2].seen.x1, high = v[2].seen.y1;
    struct choices *chosen = calloc((size_t)(wide * high), sizeof *chosen);
    for (int i = 0; i < wide * high; i++)
        chosen[i] = search_fine(v, channels, i % wide, i / wide);
    struct grid out = grid_new(0, 0, quads->x1, quads->y1, SAMPLE);
    for (int y = 0; y < quads->y1; y++)
        for (int x = 0; x < quads->x1; x++)
            if (at(hidden, x, y)[WEIGHT] > 0) {
                fill(v, chosen, channels, x, y, at(hidden, x, y), at(&out, x, y));
                memcpy(at(hidden, x, y), at(&out, x, y), sizeof(double) * 4);
            }
    free(out.v);
    free(chosen);
    for (int j = 0; j < 3; j++) {
        free(v[j].place.v);
        if (j)
            free(v[j].seen.v);
    }
}
