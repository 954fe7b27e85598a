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
        struct tap *t = &taps[i];
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

static inline uint32_t blend(uint32_t a, uint32_t b, uint32_t weight)
{
    const uint32_t mask = 0x00ff00ff;
    const uint32_t low = ((a & mask) * (256 - weight) + (b & mask) * weight) >> 8 & mask;
    const uint32_t high = ((a >> 8 & mask) * (256 - weight) + (b >> 8 & mask) * weight) & ~mask;
    return low | high;
}

static void draw_near(const struct view_layer *l, const struct tap *column, uint32_t *to, int begin, int end, int row)
{
    const uint32_t *from = l->pixels + (size_t)row * (size_t)l->width;
    if (end > begin && column[end - 1].first - column[begin].first == end - 1 - begin) {
        memcpy(to + begin, from + column[begin].first, (size_t)(end - begin) * sizeof(*to));
        return;
    }
    for (int x = begin; x < end; x++)
        to[x] = from[column[x].first];
}

// One row of the layer, stretched to the screen's columns.
struct line {
    uint32_t *pixels;
    int row;
};

static const uint32_t *stretch(const struct view_layer *l, struct line *line, const struct tap *column, int begin,
                               int end, int row)
{
    const uint32_t *from = l->pixels + (size_t)row * (size_t)l->width;
    for (int x = begin; x < end && line->row != row; x++)
        line->pixels[x] = blend(from[column[x].first], from[column[x].second], column[x].weight);
    line->row = row;
    return line->pixels;
}

// Rows of the layer follow each other, so a row that two rows of the screen need is stretched once.
static void draw_smooth(const struct view_layer *l, struct line lines[2], const struct tap *column, uint32_t *to,
                        int begin, int end, const struct tap *row)
{
    const uint32_t *a = stretch(l, &lines[row->first & 1], column, begin, end, row->first);
    const uint32_t *b = stretch(l, &lines[row->second & 1], column, begin, end, row->second);
    const uint32_t weight = row->weight;
    for (int x = begin; x < end; x++)
        to[x] = blend(a[x], b[x], weight);
}

static int clamp(double v, int least, int most)
{
    return v < least ? least : v > most ? most : (int)v;
}

void view_compose(const struct view_screen *screen, const struct view_camera *camera, const struct view_layer *l)
{
    const struct view_camera c = view_camera_drawn(camera);
    const double scale = c.zoom * l->n, wide = scale * c.aspect;
    const int whole = l->n == 1, smooth = !whole || scale < 1 || wide < 1;
    // Screen pixels whose centres lie in the layer.
    const int x0 = clamp(ceil(c.x + l->x * wide - 0.5), l->from, l->to);
    const int x1 = clamp(ceil(c.x + (l->x + l->width) * wide - 0.5), l->from, l->to);
    const int y0 = clamp(ceil(c.y + l->y * scale - 0.5), 0, screen->height);
    const int y1 = clamp(ceil(c.y + (l->y + l->height) * scale - 0.5), 0, screen->height);
    struct tap *taps = x1 > x0 && y1 > y0 ? malloc((size_t)(screen->width + screen->height) * sizeof(*taps)) : NULL;
    uint32_t *room = taps ? malloc(2 * (size_t)screen->width * sizeof(*room)) : NULL;
    if (!room) {
        free(taps);
        return;
    }
    struct line lines[2] = {{room, -1}, {room + screen->width, -1}};
    struct tap *rows = taps + screen->width;
    find_taps(taps, x0, x1, c.x, wide, l->x, l->width, whole);
    find_taps(rows, y0, y1, c.y, scale, l->y, l->height, whole);
    for (int y = y0; y < y1; y++) {
        uint32_t *to = screen->pixels + (size_t)y * (size_t)screen->width;
        if (smooth)
            draw_smooth(l, lines, taps, to, x0, x1, &rows[y]);
        else
            draw_near(l, taps, to, x0, x1, rows[y].first);
    }
    free(room);
    free(taps);
}
