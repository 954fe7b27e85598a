// SPDX-License-Identifier: BSD-3-Clause
// What one sample changes, and what a region reads. A sample may change only pixels within its reach, whatever the rest of the
// frame holds.
#include "stability/stability.h"

#include <stdlib.h>
#include <string.h>

#include "support/check.h"

enum { WIDTH = 208, HEIGHT = 160, RADIUS = 14 };

// How far away a sample may change pixels, for radii up to `radius` before and after.
static int reach_of(const struct hf_params *p, int radius)
{
    const int half = (radius + 1) / 2;
    switch (p->engine) {
    case HF_ENGINE_GATHER:
    case HF_ENGINE_CHAPTER:
        return 2 * (2 * half + half + 4);  // as fields_margin() of subjects.c
    case HF_ENGINE_HEXAGON:
    case HF_ENGINE_SCATTER:
        // Two blurs of the hexagon, one sprite of scatter; and the disocclusion fill of both, which looks twice a near radius
        // and a quad far, where a pixel's visible part depends on the nearest within 7 quads; two pixels for mixed ones.
        return 2 * radius + 2 + 14 + 4;
    case HF_ENGINE_GAUSSIAN:
        // As in subjects.c.
        return p->gaussian.sigma > 0 ? (int)(4 * p->gaussian.sigma) + 8 : 2 * 3 * (p->gaussian.resolution ? 4 : 1) + 8;
    case HF_ENGINE_LAYERS:
        // As layers() of subjects.c, and a cell of 4 pixels. Where a sample begins to hide something, views count from that
        // tile on, fade out over another, and by its corners reach into a third.
        return radius + 4 + 32 + 4 + 2 + 4 + (p->layers.lens_points > 1 ? 3 * 16 : 0);
    default:
        return 0;
    }
}

// The largest distance, along x or y, of a changed pixel from (x, y); *most: the largest change beyond `reach`, codes.
static int farthest(const struct picture *a, const struct picture *b, int x, int y, int reach, double *most)
{
    int far = 0;
    *most = 0;
    for (int c = 0; c < a->channels; c++)
        for (int i = 0; i < a->width * a->height; i++) {
            const int dx = abs(i % a->width - x), dy = abs(i / a->width - y), d = dx > dy ? dx : dy;
            if (!memcmp(&a->plane[c][i], &b->plane[c][i], sizeof(float)))
                continue;
            far = d > far ? d : far;
            if (d > reach)
                *most = worse(*most, fabs(display_code(a->plane[c][i]) - display_code(b->plane[c][i])));
        }
    return far;
}

// Change one sample, of depth or, for i = DEPTHS, of colour.
static void change(const struct run *r, const struct hf_params *p, struct scene *s, const struct picture *before, int x,
                   int y, int i, const char *where)
{
    // Nearest, hardly near, in focus, hardly far, farthest, no surface, unknown.
    static const float depths[] = {0.5f, 17, 20, 24, 900, INFINITY, NAN};
    enum { DEPTHS = sizeof depths / sizeof *depths };
    const int at = y * WIDTH + x, reach = reach_of(p, RADIUS), is_colour = i >= DEPTHS;
    const float depth = s->depth.plane[0][at], colour = s->colour.plane[1][at];
    double most;
    if (is_colour)
        s->colour.plane[1][at] = 300;
    else
        s->depth.plane[0][at] = depths[i];
    struct picture after = render_scene(r->c, s, p);
    const int far = farthest(before, &after, x, y, reach, &most);
    see_look(r, is_colour ? "one colour sample changed: reach, pixels" : "one depth sample changed: reach, pixels",
             "the reach of its radius, see local.c", far, reach, "%s at (%d, %d), case %d, by %.2g codes beyond", where,
             x, y, i, most);
    picture_free(&after);
    s->depth.plane[0][at] = depth;
    s->colour.plane[1][at] = colour;
}

static void one_sample(const struct run *r, enum stage stage, int lens)
{
    struct hf_params p = r->subject->params;
    struct scene s = stage_make(stage, r->seed, WIDTH, HEIGHT);
    struct rng rng = rng_seed(r->seed + 900);
    char where[40];
    if (lens)
        set_lens(&p, WIDTH, RADIUS);
    p.max_radius = RADIUS;
    snprintf(where, sizeof where, "%s, %s", stage_name(stage), lens ? "lens" : "range");
    struct picture before = render_scene(r->c, &s, &p);
    for (int k = 0; k < (r->full ? 20 : 2); k++) {
        const int x = WIDTH / 4 + rng_below(&rng, WIDTH / 2), y = HEIGHT / 4 + rng_below(&rng, HEIGHT / 2);
        for (int i = 0; i < 8; i++)
            change(r, &p, &s, &before, x, y, i, where);
    }
    picture_free(&before);
    scene_free(&s);
}

// ---- regions ----

// Set all samples of a channel outside a rectangle to what they are not.
static void spoil_outside(struct picture *p, int c, const struct hf_region *keep, float value)
{
    for (int i = 0; i < p->width * p->height; i++) {
        const int x = i % p->width, y = i / p->width;
        if (x < keep->x || y < keep->y || x >= keep->x + keep->width || y >= keep->y + keep->height)
            p->plane[c][i] = value;
    }
}

// A region has the whole's bits, also when all that it does not read is something else.
static void region(const struct run *r, enum stage stage, int lens)
{
    struct hf_params p = r->subject->params;
    struct scene s = stage_make(stage, r->seed, WIDTH, HEIGHT);
    if (lens)
        set_lens(&p, WIDTH, RADIUS);
    struct picture whole = render_scene(r->c, &s, &p), part = picture_new(WIDTH, HEIGHT, 3);
    const struct hf_image dst = picture_image(&part), src = picture_image(&s.colour);
    struct hf_depth depth = picture_depth(&s.depth);
    const struct hf_region want = {sizeof want, 92, 68, 24, 20};
    struct hf_region colour = {.size = sizeof colour}, read = {.size = sizeof read};
    CHECK_INT(hf_region_reads(r->c, &dst, &src, &depth, &p, &want, &colour, &read), HF_OK);
    for (int c = 0; c < 3; c++)
        spoil_outside(&s.colour, c, &colour, 0.77f);
    spoil_outside(&s.depth, 0, &read, 3);
    CHECK_INT(hf_render_region(r->c, &dst, &src, &depth, &p, &want), HF_OK);
    struct picture a = picture_cut(&whole, want.x, want.y, want.width, want.height);
    struct picture b = picture_cut(&part, want.x, want.y, want.width, want.height);
    see_look(r, "regions: samples that are not the whole's bits", "none may be", samples_other(&a, &b), 0,
             "%s, %s, reads %d x %d of colour", stage_name(stage), lens ? "lens" : "range", colour.width,
             colour.height);
    picture_free(&a);
    picture_free(&b);
    picture_free(&part);
    picture_free(&whole);
    scene_free(&s);
}

// A part cut out with what the library says that it reads has the whole's bits: the lens measures other radii there.
static void crop(const struct run *r, enum stage stage)
{
    struct hf_params p = r->subject->params;
    struct scene s = stage_make(stage, r->seed, WIDTH, HEIGHT);
    set_lens(&p, WIDTH, RADIUS);
    p.max_radius = RADIUS;
    p.view.display_width = WIDTH;
    p.view.display_height = HEIGHT;
    const int m = reach_of(&p, RADIUS), x0 = (WIDTH / 2 - 8 - m) / 4 * 4, y0 = (HEIGHT / 2 - 8 - m) / 4 * 4;
    const int left = x0 > 0 ? x0 : 0, top = y0 > 0 ? y0 : 0;
    const int w = WIDTH / 2 + 8 + m - left, h = HEIGHT / 2 + 8 + m - top;
    struct scene part = {
        picture_cut(&s.colour, left, top, w < WIDTH - left ? w : WIDTH - left, h < HEIGHT - top ? h : HEIGHT - top),
        picture_cut(&s.depth, left, top, w < WIDTH - left ? w : WIDTH - left, h < HEIGHT - top ? h : HEIGHT - top)};
    struct picture whole = render_scene(r->c, &s, &p), cut = render_scene(r->c, &part, &p);
    struct picture a = picture_cut(&whole, WIDTH / 2 - 8, HEIGHT / 2 - 8, 16, 16);
    struct picture b = picture_cut(&cut, WIDTH / 2 - 8 - left, HEIGHT / 2 - 8 - top, 16, 16);
    // A cat's eye depends on the place in the frame, and the frame is the part.
    if (!(p.aperture.cat_eye > 0))
        see_look(r, "crops with a lens: worst sample, codes", "rounding: a tenth of a code", display_distance(&a, &b),
                 0.1, "%s, margin %d", stage_name(stage), m);
    picture_free(&a);
    picture_free(&b);
    picture_free(&cut);
    picture_free(&whole);
    scene_free(&part);
    scene_free(&s);
}

// ---- corners ----

// One near pixel in the corner of a frame in focus is no sign of an object as large as its blur. It may cover four pixels, as if
// it were mirrored at both edges.
static void corner(const struct run *r)
{
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radii = picture_new(WIDTH, HEIGHT, 1);
    const struct hf_depth depth = picture_radii(&radii);
    struct hf_params p = r->subject->params;
    double sum = 0;
    p.max_radius = HF_DERIVE;
    for (int c = 0; c < 3; c++)
        colour.plane[c][0] = 1;
    radii.plane[0][0] = -32;
    struct picture out = render(r->c, &colour, &depth, &p);
    for (size_t i = 0; i < samples_of(&out); i++)
        sum += out.plane[1][i];
    see_look(r, "a near pixel in a corner: pixels that it covers", "four: mirrored at both edges", sum, 4, "radius 32");
    picture_free(&out);
    picture_free(&colour);
    picture_free(&radii);
}

void local_cases(const struct run *r)
{
    if (r->subject->params.engine == HF_ENGINE_LAYERS)
        corner(r);
    for (int k = 0; k < (r->full ? (int)STAGE_NOISE + 1 : (int)STAGE_BLOCKS); k++)
        for (int lens = 0; lens < 2; lens++) {
            one_sample(r, (enum stage)k, lens);
            region(r, (enum stage)k, lens);
            if (lens)
                crop(r, (enum stage)k);
        }
}
