// SPDX-License-Identifier: BSD-3-Clause
// Bad samples: none leaves a value that is not finite in the picture or in a buffer; none changes pixels beyond the
// reach of the blur; all are counted.
#include "stability/stability.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "tools/common/report.h"

enum { WIDTH = 150, HEIGHT = 110, X = 31, Y = 25 };

enum place { PLACE_ONE, PLACE_CLUSTER, PLACE_ROW, PLACE_ALL, PLACES };
static const char *const place_names[PLACES] = {"one", "a cluster", "a row", "all"};

static int is_bad(enum place place, int x, int y)
{
    switch (place) {
    case PLACE_ONE:
        return x == X && y == Y;
    case PLACE_CLUSTER:
        return x >= X - 2 && x <= X + 2 && y >= Y - 1 && y <= Y + 2;
    case PLACE_ROW:
        return y == Y;
    default:
        return 1;
    }
}

// The largest distance in x or y at which a good sample changed; the bad ones lie at most 2 from (X, Y) or in its row.
static int reach_of_change(const struct picture *a, const struct picture *b, enum place place)
{
    int reach = 0;
    for (int c = 0; c < a->channels; c++)
        for (int y = 0; y < a->height; y++)
            for (int x = 0; x < a->width; x++) {
                const int i = y * a->width + x;
                if (!memcmp(&a->plane[c][i], &b->plane[c][i], sizeof(float)))
                    continue;
                int dx = abs(x - X), dy = abs(y - Y);
                if (place == PLACE_CLUSTER)
                    dx -= 2, dy -= 2;
                if (place == PLACE_ROW)
                    dx = 0;
                const int d = dx > dy ? dx : dy;
                reach = d > reach ? d : reach;
            }
    return reach;
}

static uint64_t not_finite(const struct picture *p)
{
    uint64_t n = 0;
    for (int c = 0; c < p->channels; c++)
        for (size_t i = 0; i < samples_of(p); i++)
            n += !isfinite(p->plane[c][i]);
    return n;
}

struct buffers {
    uint64_t not_finite;
    char first[20];
};

static void look(void *cookie, const struct hf_inspect_buffer *b)
{
    struct buffers *found = cookie;
    for (int c = 0; c < b->channels; c++)
        for (int y = 0; y < b->height; y++) {
            const float *row = (const float *)(const void *)((const char *)b->data[c] + y * b->stride);
            for (int x = 0; x < b->width; x++)
                if (!isfinite(row[x])) {
                    if (!found->not_finite++)
                        snprintf(found->first, sizeof found->first, "%s", b->name);
                }
        }
}

// A dump of a buffer that no pass wrote shows whatever memory held; with this allocator it is zeros.
static void *zeros(void *cookie, size_t size, size_t align)
{
    (void)cookie;
    void *p = aligned_alloc(align, (size + align - 1) / align * align);
    return p ? memset(p, 0, size) : NULL;
}

static void release(void *cookie, void *p)
{
    (void)cookie;
    free(p);
}

static void try_buffers(const struct run *r, const struct scene *s, const char *name, int huge)
{
    const struct hf_config config = {
        .size = sizeof config, .threads = 1, .isa = r->isa, .alloc = zeros, .free = release};
    struct buffers found = {0};
    struct hf_context *c;
    if (!CHECK_INT(hf_open(&c, &config), HF_OK))
        return;
    hf_inspect_dump(c, look, &found);
    struct picture out = render_scene(c, s, &r->subject->params);
    hf_close(&c);
    picture_free(&out);
    see(r,
        huge ? "largest floats: not finite in a buffer on the way" : "bad samples: not finite in a buffer on the way",
        "none may be", (double)found.not_finite, 0, "%s, first in %s", name, found.first);
}

// huge: sums of two samples exceed the largest float.
static void try_picture(const struct run *r, const struct scene *s, const struct picture *good, enum place place,
                        const char *name, uint64_t bad_colours, uint64_t bad_depths, int huge)
{
    static const char *const counted = "the number of samples that were made bad; 0 are counted wrong";
    struct tool_report report;
    struct picture out = render_scene(r->c, s, &r->subject->params);
    tool_report_get(r->c, &report);
    see(r, huge ? "largest floats: not finite in the picture" : "bad samples: not finite in the picture", "none may be",
        (double)not_finite(&out), 0, "%s", name);
    see(r, "bad samples: counted", counted,
        fabs((double)report.all.colour_repaired - (double)bad_colours) +
            fabs((double)report.all.depth_repaired - (double)bad_depths),
        0, "%s", name);
    if (place != PLACE_ALL)
        see(r, "bad samples: distance of the farthest change, pixels",
            "the farthest from which a pixel may come by the radius, and 1 for the repair",
            reach_of_change(good, &out, place), r->subject->margin + 1, "%s", name);
    picture_free(&out);
    try_buffers(r, s, name, huge);
}

// Other tests compare instruction sets with the C. Here each set runs a different quarter of the cases, and the widest
// runs all.
static int chosen(const struct run *r, int number)
{
    return r->full || r->widest || (number + (int)r->isa) % 4 == 0;
}

static void colours(const struct run *r, const struct scene *clean, const struct picture *good)
{
    static const float values[] = {NAN, INFINITY, -INFINITY, 1e-42f, -3, 65504, 1e30f, FLT_MAX, -FLT_MAX};
    for (int v = 0; v < 9; v++) {
        for (int place = 0; place < PLACES; place++) {
            // Colour or alpha, alternately, or both in the long run.
            for (int c = 0; c < 4; c++) {
                if (!r->full && (c != (v + place) % 4 || !chosen(r, v + place)))
                    continue;
                struct scene s = {picture_copy(&clean->colour), picture_copy(&clean->depth)};
                uint64_t bad = 0;
                for (int i = 0; i < WIDTH * HEIGHT; i++)
                    if (is_bad((enum place)place, i % WIDTH, i / WIDTH)) {
                        s.colour.plane[c][i] = values[v];
                        bad += !isfinite(values[v]);
                    }
                char name[60];
                snprintf(name, sizeof name, "%g in channel %d, %s", values[v], c, place_names[place]);
                try_picture(r, &s, good, (enum place)place, name, bad, 0,
                            fabsf(values[v]) > 1e38f && isfinite(values[v]));
                scene_free(&s);
            }
        }
    }
}

static void depths(const struct run *r, const struct scene *clean, const struct picture *good)
{
    static const float values[] = {NAN, INFINITY, -INFINITY, 0, -0.0f, -1, 1e-42f, 65504, 1e30f, FLT_MAX, -FLT_MAX};
    for (int v = 0; v < 11; v++) {
        for (int place = 0; place < PLACES; place++) {
            if (!chosen(r, v + place))
                continue;
            struct scene s = {picture_copy(&clean->colour), picture_copy(&clean->depth)};
            uint64_t bad = 0;
            for (int i = 0; i < WIDTH * HEIGHT; i++)
                if (is_bad((enum place)place, i % WIDTH, i / WIDTH)) {
                    s.depth.plane[0][i] = values[v];
                    bad += isnan(values[v]);
                }
            char name[60];
            snprintf(name, sizeof name, "%g in depth, %s", values[v], place_names[place]);
            try_picture(r, &s, good, (enum place)place, name, 0, bad, 0);
            scene_free(&s);
        }
    }
}

void samples_cases(const struct run *r)
{
    struct scene clean = calm_scene(r->seed, WIDTH, HEIGHT, 4);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        if (!isfinite(clean.depth.plane[0][i]))
            clean.depth.plane[0][i] = 1000;
    struct picture good = render_scene(r->c, &clean, &r->subject->params);
    colours(r, &clean, &good);
    depths(r, &clean, &good);
    picture_free(&good);
    scene_free(&clean);
}
