// SPDX-License-Identifier: BSD-3-Clause
// Regions of a picture: they have the bits of the whole, write nothing else, read only the announced rectangles, and cost little.
//
//     region [rounds [seed]]
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/looks.h"
#include "support/render.h"
#include "tools/common/report.h"

static int rounds = 3;
static unsigned seed = 1;

static const enum hf_format formats[] = {HF_FORMAT_RGBA32F, HF_FORMAT_RGB32F, HF_FORMAT_RGBA16F, HF_FORMAT_R11G11B10F,
                                         HF_FORMAT_PLANAR32F};
enum { FORMATS = sizeof formats / sizeof *formats, JUNK = 0xa5 };

struct subject {
    const struct look *look;
    struct hf_params p;
    struct scene scene;
    struct hf_depth depth;
    struct packed src, whole;
};

static struct hf_region any_region(struct rng *rng, int width, int height)
{
    struct hf_region r = {.size = sizeof r};
    const int small = rng_below(rng, 2);
    r.width = 1 + rng_below(rng, small && width > 40 ? 40 : width);
    r.height = 1 + rng_below(rng, small && height > 40 ? 40 : height);
    r.x = rng_below(rng, width - r.width + 1);
    r.y = rng_below(rng, height - r.height + 1);
    return r;
}

// Bytes of a pixel, in one plane.
static size_t bytes_of(enum hf_format f)
{
    return f == HF_FORMAT_PLANAR32F ? 4 : (size_t)format_pixel_size(f);
}

// Count the pixels of dst that differ: inside the region from the whole frame, outside from what was there before.
static void compare(const struct packed *got, const struct packed *was, const struct packed *whole,
                    const struct hf_region *r, int *inside, int *outside)
{
    const struct hf_image *m = &got->image;
    const size_t bytes = bytes_of(m->format);
    *inside = *outside = 0;
    for (int k = 0; k < 4 && m->data[k]; k++)
        for (int y = 0; y < m->height; y++)
            for (int x = 0; x < m->width; x++) {
                const int in = x >= r->x && x < r->x + r->width && y >= r->y && y < r->y + r->height;
                const struct hf_image *like = in ? &whole->image : &was->image;
                const int other = memcmp((char *)m->data[k] + y * m->stride[k] + (size_t)x * bytes,
                                         (char *)like->data[k] + y * like->stride[k] + (size_t)x * bytes, bytes) != 0;
                *inside += in && other;
                *outside += !in && other;
            }
}

static void say(const struct subject *s, const struct hf_region *r, const char *what, int inside, int outside)
{
    CHECK_MSG(
        inside == 0 && outside == 0,
        "%s, %s, %d x %d of format %s, region %d x %d from (%d, %d): %d pixels differ inside, %d are written outside",
        s->look->name, what, s->src.image.width, s->src.image.height,
        hf_name(HF_NAMES_FORMAT, (int)s->src.image.format), r->width, r->height, r->x, r->y, inside, outside);
}

static struct packed like(const struct packed *p, unsigned char junk)
{
    return packed_new(p->image.width, p->image.height, p->image.format, p->image.data[3] != NULL, 5, 0, 0, junk);
}

static void copy_pixels(struct packed *to, const struct packed *from)
{
    for (int k = 0; k < 4 && from->image.data[k]; k++)
        for (int y = 0; y < from->image.height; y++)
            memcpy((char *)to->image.data[k] + y * to->image.stride[k],
                   (char *)from->image.data[k] + y * from->image.stride[k],
                   (size_t)from->image.width * bytes_of(from->image.format));
}

// Render the region into a separate picture, and in place.
static void try_bits(struct hf_context *c, const struct subject *s, const struct hf_region *r)
{
    int inside, outside;
    for (int in_place = 0; in_place < 2; in_place++) {
        struct packed got = like(&s->src, JUNK), was = like(&s->src, JUNK);
        if (in_place) {
            copy_pixels(&got, &s->src);
            copy_pixels(&was, &s->src);
        }
        CHECK_INT(hf_render_region(c, &got.image, in_place ? &got.image : &s->src.image, &s->depth, &s->p, r), HF_OK);
        compare(&got, &was, &s->whole, r, &inside, &outside);
        say(s, r, in_place ? "in place" : "out of place", inside, outside);
        CHECK(packed_junk_intact(&got, JUNK));
        packed_free(&got);
        packed_free(&was);
    }
}

// Render into memory for the region only, so that pixel (0, 0) would lie before it.
static void try_tile(struct hf_context *c, const struct subject *s, const struct hf_region *r)
{
    enum { GUARD = 64 };
    const enum hf_format format = s->src.image.format;
    const size_t bytes = bytes_of(format), row = (size_t)r->width * bytes, size = row * (size_t)r->height;
    const size_t stride = row + size % 3 * bytes;
    struct hf_image dst = s->src.image;
    unsigned char *memory[4] = {NULL};
    int bad = 0, guard = 0;
    for (int k = 0; k < 4 && dst.data[k]; k++) {
        memory[k] =
            memset(malloc(stride * (size_t)r->height + 2 * GUARD), JUNK, stride * (size_t)r->height + 2 * GUARD);
        dst.stride[k] = (ptrdiff_t)stride;
        dst.data[k] = memory[k] + GUARD - (ptrdiff_t)((size_t)r->y * stride + (size_t)r->x * bytes);
    }
    CHECK_INT(hf_render_region(c, &dst, &s->src.image, &s->depth, &s->p, r), HF_OK);
    for (int k = 0; k < 4 && dst.data[k]; k++) {
        for (int y = 0; y < r->height; y++) {
            const unsigned char *got = memory[k] + GUARD + (size_t)y * stride;
            bad += memcmp(got,
                          (char *)s->whole.image.data[k] + (r->y + y) * s->whole.image.stride[k] + (size_t)r->x * bytes,
                          row) != 0;
            for (size_t i = row; i < stride; i++)
                guard += got[i] != JUNK;
        }
        for (int i = 0; i < GUARD; i++)
            guard += (memory[k][i] != JUNK) + (memory[k][GUARD + stride * (size_t)r->height + (size_t)i] != JUNK);
        free(memory[k]);
    }
    CHECK_MSG(!bad && !guard, "%s: of a tile of %zu bytes %d rows differ, and %d bytes around it are written",
              s->look->name, size, bad, guard);
}

static int is_in(const struct hf_region *r, int x, int y)
{
    return x >= r->x && x < r->x + r->width && y >= r->y && y < r->y + r->height;
}

// Pixels outside the rectangles that hf_region_reads announces are NaN, so reading them would show.
static void try_reads(struct hf_context *c, const struct subject *s, const struct hf_region *r)
{
    struct hf_region colour = {.size = sizeof(colour)}, depth = {.size = sizeof(depth)};
    CHECK_INT(hf_region_reads(c, &s->src.image, &s->src.image, &s->depth, &s->p, r, &colour, &depth), HF_OK);
    CHECK_MSG(is_in(&colour, r->x, r->y) && is_in(&colour, r->x + r->width - 1, r->y + r->height - 1),
              "%s: the region itself is not read", s->look->name);
    struct packed src = like(&s->src, 0xff), got = like(&s->src, JUNK), was = like(&s->src, JUNK);
    struct picture z = picture_copy(&s->scene.depth);
    struct hf_depth poisoned = picture_depth(&z);
    const size_t bytes = bytes_of(src.image.format);
    int inside, outside;
    copy_pixels(&src, &s->src);
    for (int y = 0; y < src.image.height; y++)
        for (int x = 0; x < src.image.width; x++) {
            for (int k = 0; k < 4 && src.image.data[k] && !is_in(&colour, x, y); k++)
                memset((char *)src.image.data[k] + y * src.image.stride[k] + (size_t)x * bytes, 0xff, bytes);
            if (!is_in(&depth, x, y))
                z.plane[0][y * z.width + x] = NAN;
        }
    CHECK_INT(hf_render_region(c, &got.image, &src.image, &poisoned, &s->p, r), HF_OK);
    compare(&got, &was, &s->whole, r, &inside, &outside);
    say(s, r, "poison around what is read", inside, outside);
    packed_free(&src);
    packed_free(&got);
    packed_free(&was);
    picture_free(&z);
}

static struct subject subject_new(struct rng *rng, int look, int width, int height)
{
    struct subject s = {.look = &looks[look]};
    const enum hf_format format = formats[rng_below(rng, FORMATS)];
    const enum scene_kind kinds[] = {SCENE_BLOCKS, SCENE_NOISE, SCENE_RAMP, SCENE_HIGHLIGHTS, SCENE_SHARP};
    s.scene = scene_new(rng, kinds[rng_below(rng, 5)], width, height, format_channels(format));
    s.p = look_params(s.look, width, 20);
    s.depth = picture_depth(&s.scene.depth);
    // Samples that are not finite are repaired from their neighbours.
    for (int i = rng_below(rng, 2) ? 8 : 0; i > 0; i--)
        s.scene.colour.plane[rng_below(rng, 3)][rng_below(rng, width * height)] = i % 2 ? NAN : INFINITY;
    if (rng_below(rng, 4) == 0)
        s.p.highlight.gain = 6;
    s.src = packed_new(width, height, format, format_channels(format) == 4, 5, 0, 0, JUNK);
    s.whole = like(&s.src, JUNK);
    packed_write(&s.src, &s.scene.colour);
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    CHECK_INT(hf_render(c, &s.whole.image, &s.src.image, &s.depth, &s.p), HF_OK);
    hf_close(&c);
    return s;
}

static void subject_free(struct subject *s)
{
    scene_free(&s->scene);
    packed_free(&s->src);
    packed_free(&s->whole);
}

static void try_look(struct rng *rng, int look)
{
    const int width = 60 + rng_below(rng, 200), height = 40 + rng_below(rng, 160);
    struct subject s = subject_new(rng, look, width, height);
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, rng_below(rng, 2) ? 32 : 0, rng_below(rng, 2) ? 24 : 0);
    for (int i = 0; i < 2; i++) {
        const struct hf_region r = any_region(rng, width, height);
        try_bits(c, &s, &r);
        try_tile(c, &s, &r);
        try_reads(c, &s, &r);
    }
    // A whole frame after a region is as without it.
    struct packed got = like(&s.src, JUNK);
    const struct hf_region all = {sizeof all, 0, 0, width, height};
    int inside, outside;
    CHECK_INT(hf_render(c, &got.image, &s.src.image, &s.depth, &s.p), HF_OK);
    compare(&got, &got, &s.whole, &all, &inside, &outside);
    say(&s, &all, "a whole frame after regions", inside, outside);
    CHECK_INT(hf_render_region(c, &got.image, &s.src.image, &s.depth, &s.p, NULL), HF_OK);
    compare(&got, &got, &s.whole, &all, &inside, &outside);
    say(&s, &all, "no region", inside, outside);
    packed_free(&got);
    hf_close(&c);
    subject_free(&s);
}

// A small region of a large picture runs on few cells: those that it, or the blur around it, touches.
static void try_cost(struct rng *rng, int look)
{
    enum { WIDTH = 1024, HEIGHT = 768 };
    static const struct hf_region r = {sizeof r, 500, 300, 32, 32};
    struct scene s = scene_new(rng, SCENE_NOISE, WIDTH, HEIGHT, 3);
    struct picture out = picture_new(WIDTH, HEIGHT, 3);
    struct hf_params p = look_params(&looks[look], WIDTH, 20);
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 32, 24);
    const struct hf_depth depth = picture_depth(&s.depth);
    const struct hf_image dst = picture_image(&out), src = picture_image(&s.colour);
    static struct tool_report report;
    p.max_radius = p.max_radius > 16 || p.max_radius < 0 ? 16 : p.max_radius;
    CHECK_INT(hf_render_region(c, &dst, &src, &depth, &p, &r), HF_OK);
    tool_report_get(c, &report);
    // The last pass runs only on the tiles (64 x 48 pixels) that the region meets. Engines that choose their own cells
    // have larger ones. Every engine has at least 20, and the region meets at most 4 of them.
    const struct hf_inspect_pass *last = &report.pass[report.inner.passes - 1];
    CHECK_MSG(last->ran >= 1 && last->ran <= 4 && last->all >= 20, "%s: %s ran on %u of %u tiles", looks[look].name,
              last->name, last->ran, last->all);
    // The first sweep's second pass, or the first of the tiles, does not run everywhere. hf_render_region names the
    // exceptions.
    const int reads_all = looks[look].engine == HF_ENGINE_SCATTER || looks[look].sigma > 0;
    CHECK_MSG(reads_all || report.pass[1].ran * 3 <= report.pass[1].all, "%s: %s ran on %u of %u cells",
              looks[look].name, report.pass[1].name, report.pass[1].ran, report.pass[1].all);
    hf_close(&c);
    scene_free(&s);
    picture_free(&out);
}

static void refused(void)
{
    struct picture p = picture_new(20, 10, 3), z = picture_new(20, 10, 1);
    struct hf_context *c = context_new(HF_ISA_AUTO, 1, 0, 0);
    const struct hf_image image = picture_image(&p);
    const struct hf_depth depth = picture_depth(&z);
    static const struct hf_region bad[] = {
        {sizeof *bad, -1, 0, 5, 5}, {sizeof *bad, 0, -1, 5, 5},         {sizeof *bad, 0, 0, 0, 5},
        {sizeof *bad, 0, 0, 5, 0},  {sizeof *bad, 16, 0, 5, 5},         {sizeof *bad, 0, 6, 5, 5},
        {sizeof *bad, 20, 0, 1, 1}, {sizeof *bad, 1, 0, 0x7fffffff, 5}, {0, 0, 0, 5, 5},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct hf_region colour = bad[0], read = bad[0];
        CHECK_INT(hf_render_region(c, &image, &image, &depth, NULL, &bad[i]), HF_ERR_ARG);
        CHECK_INT(hf_region_reads(c, &image, &image, &depth, NULL, &bad[i], &colour, &read), HF_ERR_ARG);
        CHECK(colour.width == 0 && read.height == 0);
    }
    CHECK_INT(hf_region_reads(c, &image, &image, &depth, NULL, NULL, NULL, NULL), HF_OK);
    CHECK_INT(hf_render_region(NULL, &image, &image, &depth, NULL, NULL), HF_ERR_ARG);
    hf_close(&c);
    picture_free(&p);
    picture_free(&z);
}

int main(int argc, char **argv)
{
    rounds = argc > 1 ? atoi(argv[1]) : check_long() ? 60 : 4;
    seed = argc > 2 ? (unsigned)atoi(argv[2]) : 1;
    struct rng rng = rng_seed(seed);
    refused();
    for (int i = 0; i < LOOKS; i++) {
        for (int k = 0; k < rounds; k++)
            try_look(&rng, i);
        try_cost(&rng, i);
    }
    return check_report();
}
