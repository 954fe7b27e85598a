// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/compose.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct view_camera view_camera_drawn(const struct view_camera *camera)
{
    if (camera->zoom < 1)
        return *camera;
    return (struct view_camera){camera->zoom, camera->aspect, round(camera->x), round(camera->y)};
}

void view_compose_clear(const struct view_screen *screen, uint32_t colour)
{
    const size_t n = (size_t)screen->width * (size_t)screen->height;
    for (size_t i = 0; i < n; i++)
        screen->pixels[i] = colour;
}

// The samples of a layer that a column or a row of the screen shows.
struct tap {
    int first, second;
    uint32_t weight;  // of the second, 0 to 256
};

// from: where the picture begins on the screen; first, count: of the layer's pixels. whole: its pixels are shown as they are.
// Where one of them covers less than one of the screen, or they are smaller copies, neighbours are mixed.
static void find_taps(struct tap *taps, int begin, int end, double from, double scale, int first, int count, int whole)
{
    const int smooth = !(whole && scale >= 1);
    for (int i = begin; i < end; i++) {
        const double place = (i + 0.5 - from) / scale - first;
        struct tap *t = &taps[i - begin];
        if (!smooth) {
            const int k = (int)floor(place);
            t->first = t->second = k < 0 ? 0 : k >= count ? count - 1 : k;
            t->weight = 0;
            continue;
        }
        const double p = fmin(fmax(place - 0.5, 0), count - 1);
        const int k = (int)p;
        *t = (struct tap){k, k + 1 < count ? k + 1 : k, (uint32_t)((p - k) * 256 + 0.5)};
    }
}

static void draw_near(const struct view_layer *l, const struct tap *column, int count, int row, uint32_t *to)
{
    const uint32_t *from = l->pixels + (size_t)row * (size_t)l->width;
    if (column[count - 1].first - column[0].first == count - 1) {
        memcpy(to, from + column[0].first, (size_t)count * sizeof(*to));
        return;
    }
    for (int x = 0; x < count; x++)
        to[x] = from[column[x].first];
}

// Mix bytes: weight, 0 to 256, is that of b. Products fit 16 bits, in which compilers do eight at a time.
static inline uint8_t blend(uint8_t a, uint8_t b, uint16_t weight)
{
    const uint16_t first = (uint16_t)(a * (uint16_t)(256 - weight)), second = (uint16_t)(b * weight);
    return (uint8_t)((uint16_t)(first + second) >> 8);
}

static void blend_columns(const uint8_t *restrict a, const uint8_t *restrict b, const uint16_t *restrict weight,
                          uint8_t *restrict to, int n)
{
    for (int i = 0; i < n; i++)
        to[i] = blend(a[i], b[i], weight[i]);
}

// a and b may be the same row.
static void blend_rows(const uint8_t *a, const uint8_t *b, uint16_t weight, uint8_t *restrict to, int n)
{
    for (int i = 0; i < n; i++)
        to[i] = blend(a[i], b[i], weight);
}

// What stretching rows takes. Columns count from the first that is drawn.
struct stretch {
    const struct tap *column;
    int count;
    uint32_t *left, *right;  // the two samples of each column
    uint16_t *weight;        // of the right one, for each byte
    struct {
        uint32_t *pixels;
        int row;  // of the layer, -1: none
    } line[2];
};

static int open_stretch(struct stretch *s, const struct tap *column, int count)
{
    const size_t n = (size_t)count;
    uint32_t *room = malloc(6 * n * sizeof(*room));
    if (!room)
        return -1;
    *s = (struct stretch){
        column, count, room, room + n, (uint16_t *)(room + 2 * n), {{room + 4 * n, -1}, {room + 5 * n, -1}}};
    for (int x = 0; x < count; x++)
        for (int c = 0; c < 4; c++)
            s->weight[4 * x + c] = (uint16_t)column[x].weight;
    return 0;
}

static void close_stretch(struct stretch *s)
{
    free(s->left);
}

// One row of the layer, stretched to the screen's columns. Rows of the layer follow each other, so one that several rows of the
// screen need is stretched once.
static const uint8_t *stretch(struct stretch *s, const struct view_layer *l, int row)
{
    const uint32_t *from = l->pixels + (size_t)row * (size_t)l->width;
    uint8_t *to = (uint8_t *)s->line[row & 1].pixels;
    if (s->line[row & 1].row == row)
        return to;
    s->line[row & 1].row = row;
    for (int x = 0; x < s->count; x++) {
        s->left[x] = from[s->column[x].first];
        s->right[x] = from[s->column[x].second];
    }
    blend_columns((const uint8_t *)s->left, (const uint8_t *)s->right, s->weight, to, 4 * s->count);
    return to;
}

static void draw_smooth(struct stretch *s, const struct view_layer *l, const struct tap *row, uint32_t *pixels)
{
    const uint8_t *a = stretch(s, l, row->first), *b = stretch(s, l, row->second);
    blend_rows(a, b, (uint16_t)row->weight, (uint8_t *)pixels, 4 * s->count);
}

static int clamp(double v, int least, int most)
{
    return v < least ? least : v > most ? most : (int)v;
}

// Screen pixels whose centres lie in the layer.
struct place {
    int x0, x1, y0, y1;
};

static struct place place_of(const struct view_screen *screen, const struct view_camera *c, const struct view_layer *l)
{
    const double scale = c->zoom * l->n, wide = scale * c->aspect;
    return (struct place){clamp(ceil(c->x + l->x * wide - 0.5), l->from, l->to),
                          clamp(ceil(c->x + (l->x + l->width) * wide - 0.5), l->from, l->to),
                          clamp(ceil(c->y + l->y * scale - 0.5), 0, screen->height),
                          clamp(ceil(c->y + (l->y + l->height) * scale - 0.5), 0, screen->height)};
}

int view_compose_covers(const struct view_screen *screen, const struct view_camera *camera, const struct view_layer *l)
{
    const struct view_camera c = view_camera_drawn(camera);
    const struct place p = place_of(screen, &c, l);
    return p.x0 == 0 && p.y0 == 0 && p.x1 == screen->width && p.y1 == screen->height;
}

int view_compose(const struct view_screen *screen, const struct view_camera *camera, const struct view_layer *l)
{
    const struct view_camera c = view_camera_drawn(camera);
    const struct place p = place_of(screen, &c, l);
    const double scale = c.zoom * l->n, wide = scale * c.aspect;
    const int whole = l->n == 1, smooth = !whole || scale < 1 || wide < 1;
    if (p.x1 <= p.x0 || p.y1 <= p.y0)
        return 0;
    struct tap *column = malloc((size_t)(p.x1 - p.x0 + p.y1 - p.y0) * sizeof(*column)), *row = column + (p.x1 - p.x0);
    struct stretch s;
    if (!column)
        return -1;
    find_taps(column, p.x0, p.x1, c.x, wide, l->x, l->width, whole);
    find_taps(row, p.y0, p.y1, c.y, scale, l->y, l->height, whole);
    if (smooth && open_stretch(&s, column, p.x1 - p.x0)) {
        free(column);
        return -1;
    }
    for (int y = p.y0; y < p.y1; y++) {
        uint32_t *to = screen->pixels + (size_t)y * (size_t)screen->width + p.x0;
        if (smooth)
            draw_smooth(&s, l, &row[y - p.y0], to);
        else
            draw_near(l, column, p.x1 - p.x0, row[y - p.y0].first, to);
    }
    if (smooth)
        close_stretch(&s);
    free(column);
    return 0;
}
