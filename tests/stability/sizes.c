// SPDX-License-Identifier: BSD-3-Clause
// Every small size, with each block of memory between forbidden pages and filled with different kinds of junk: no bit
// may depend on it, and bytes between rows must stay. Parameters without blur give the input's bits.
#include "stability/stability.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

// ---- memory: a page for notes, a forbidden one, the block up to a page's end, a forbidden one ----

enum { PAGE = 4096 };

static size_t up(size_t n, size_t to)
{
    return (n + to - 1) / to * to;
}

enum { JUNK_PAGES = 256 * PAGE };

// A file of pages full of one byte, of which blocks are private copies: pages that nobody uses cost nothing.
static int junk_file(unsigned char byte)
{
    static int files[256];
    const int fd = files[byte] ? files[byte] : memfd_create("junk", MFD_CLOEXEC);
    if (files[byte] || fd < 0 || ftruncate(fd, JUNK_PAGES))
        return fd;
    void *bytes = mmap(NULL, JUNK_PAGES, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (bytes == MAP_FAILED)
        return -1;
    memset(bytes, byte, JUNK_PAGES);
    munmap(bytes, JUNK_PAGES);
    return files[byte] = fd;
}

static void *guarded_alloc(void *cookie, size_t size, size_t align)
{
    const size_t block = up(size, align), pages = up(block, PAGE);
    const int fd = junk_file(*(const unsigned char *)cookie);
    unsigned char *base = mmap(NULL, pages + 3 * PAGE, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (base == MAP_FAILED || mprotect(base, PAGE, PROT_READ | PROT_WRITE))
        return NULL;
    memcpy(base, &pages, sizeof pages);
    for (size_t i = 0; i < pages; i += JUNK_PAGES)
        if (mmap(base + 2 * PAGE + i, pages - i < JUNK_PAGES ? pages - i : JUNK_PAGES, PROT_READ | PROT_WRITE,
                 MAP_PRIVATE | MAP_FIXED, fd, 0) == MAP_FAILED)
            return NULL;
    return base + 2 * PAGE + pages - block;
}

// block lies in the first of its pages.
static void guarded_free(void *cookie, void *block)
{
    (void)cookie;
    if (!block)
        return;
    unsigned char *base = (unsigned char *)((uintptr_t)block / PAGE * PAGE) - 2 * PAGE;
    size_t pages;
    memcpy(&pages, base, sizeof pages);
    munmap(base, pages + 3 * PAGE);
}

enum { AT = 120 };
static char *at;  // the current case, also known after a crash

// ---- pictures: rows with junk between them, the last one ending at a forbidden page ----

enum { JUNK_BYTES = 12, CHANNELS = 4 };
static const unsigned char picture_junk = 0xa5;

struct shot {
    struct hf_image src, dst;
    struct hf_depth depth;
    ptrdiff_t stride;
    size_t bytes;
};

static float *plane_new(const struct shot *s, const float *from, int width, int height)
{
    unsigned char junk = picture_junk, *p = guarded_alloc(&junk, s->bytes, sizeof(float));
    for (int y = 0; p && from && y < height; y++)
        memcpy(p + y * s->stride, from + (size_t)y * (size_t)width, (size_t)width * sizeof(float));
    return (float *)(void *)p;
}

static struct shot shot_new(const struct scene *s)
{
    const int w = s->colour.width, h = s->colour.height;
    struct shot shot = {.stride = w * (ptrdiff_t)sizeof(float) + JUNK_BYTES};
    shot.bytes = (size_t)(h - 1) * (size_t)shot.stride + (size_t)w * sizeof(float);
    shot.src = shot.dst =
        (struct hf_image){.size = sizeof(struct hf_image), .width = w, .height = h, .format = HF_FORMAT_PLANAR32F};
    for (int c = 0; c < CHANNELS; c++) {
        shot.src.data[c] = plane_new(&shot, s->colour.plane[c], w, h);
        shot.dst.data[c] = plane_new(&shot, NULL, w, h);
        shot.src.stride[c] = shot.dst.stride[c] = shot.stride;
    }
    shot.depth = picture_depth(&s->depth);
    shot.depth.data = plane_new(&shot, s->depth.plane[0], w, h);
    shot.depth.stride = shot.stride;
    return shot;
}

static void shot_free(struct shot *s)
{
    for (int c = 0; c < CHANNELS; c++) {
        guarded_free(NULL, s->src.data[c]);
        guarded_free(NULL, s->dst.data[c]);
    }
    guarded_free(NULL, (void *)(uintptr_t)s->depth.data);
}

// Count the bytes between rows that changed.
static int junk_written(const struct shot *s)
{
    int n = 0;
    for (int c = 0; c < CHANNELS; c++)
        for (int y = 0; y + 1 < s->dst.height; y++)
            for (int i = 0; i < JUNK_BYTES; i++)
                n += ((unsigned char *)s->dst.data[c])[y * s->stride + s->stride - JUNK_BYTES + i] != picture_junk;
    return n;
}

static int samples_apart(const struct shot *a, const struct shot *b)
{
    int n = 0;
    for (int c = 0; c < CHANNELS; c++)
        for (int y = 0; y < a->dst.height; y++)
            for (int x = 0; x < a->dst.width; x++)
                n += memcmp((char *)a->dst.data[c] + y * a->stride + 4 * x,
                            (char *)b->dst.data[c] + y * b->stride + 4 * x, 4) != 0;
    return n;
}

static int shot_not_finite(const struct shot *s)
{
    int n = 0;
    for (int c = 0; c < CHANNELS; c++)
        for (int y = 0; y < s->dst.height; y++)
            for (int x = 0; x < s->dst.width; x++) {
                float v;
                memcpy(&v, (char *)s->dst.data[c] + y * s->stride + 4 * x, sizeof v);
                n += !isfinite(v);
            }
    return n;
}

static int render_shot(const struct run *r, struct shot *s, unsigned char junk, const struct hf_params *p)
{
    const struct hf_config config = {.size = sizeof config,
                                     .threads = 1,
                                     .isa = r->isa,
                                     .alloc = guarded_alloc,
                                     .free = guarded_free,
                                     .alloc_cookie = &junk};
    struct hf_context *c;
    int err = hf_open(&c, &config);
    if (!err)
        err = hf_render(c, &s->dst, &s->src, &s->depth, p);
    hf_close(&c);
    return err;
}

static void try_size(const struct run *r, int w, int h, const struct hf_params *p, const char *what)
{
    static const unsigned char junk[] = {0xff, 0x4b, 0x00};
    struct rng rng = rng_seed(r->seed + (unsigned)(100 * w + h));
    struct scene s = scene_new(&rng, rng_below(&rng, 3) ? SCENE_NOISE : SCENE_HIGHLIGHTS, w, h, CHANNELS);
    struct shot shots[3];
    for (int i = 0; i < 2 + r->full; i++) {
        shots[i] = shot_new(&s);
        snprintf(at, AT, "%s, %s, %d x %d, %s, memory filled with %02x", r->subject->name, r->isa_name, w, h, what,
                 junk[i]);
        const int err = render_shot(r, &shots[i], junk[i], p);
        see(r, "sizes: errors", "none may be", -err, 0, "%s", at);
        see(r, "sizes: samples that depend on old contents of memory", "none may",
            i ? samples_apart(&shots[0], &shots[i]) : 0, 0, "%s", at);
        see(r, "sizes: bytes between rows that changed", "none may", junk_written(&shots[i]), 0, "%s", at);
        see(r, "sizes: samples that are not finite", "none may be", shot_not_finite(&shots[i]), 0, "%s", at);
    }
    for (int i = 0; i < 2 + r->full; i++)
        shot_free(&shots[i]);
    scene_free(&s);
}

static void small_sizes(const struct run *r)
{
    static const int heights[] = {1, 2, 9, 40}, widths[] = {1, 3, 33};
    struct hf_params p = r->subject->params;
    for (int w = 1; w <= 70; w++)
        for (int h = 1; h <= 40; h++) {
            int listed = r->full;
            for (int i = 0; i < 4; i++)
                listed |= h == heights[(i + w) % 4] && i < 2;
            for (int i = 0; i < 3; i++)
                listed |= w == widths[i] && h % 2 == w % 2;
            // Other tests compare instruction sets with the C. The widest set runs all of these, the others a quarter
            // each.
            if (listed && (r->full || r->widest || (w + w / 4 + h + (int)r->isa) % 4 == 0))
                try_size(r, w, h, &p, "radius 12");
        }
    // A CoC larger than the picture, and all kinds of strides at once.
    p.max_radius = 100;
    for (int n = 1; n <= 40; n += r->full ? 1 : 6)
        try_size(r, n, 41 - n, &p, "radius 100");
    p.max_radius = 1e-42f;
    try_size(r, 37, 11, &p, "a denormal radius");
    p = r->subject->params;
    p.range.distance = 0;
    try_size(r, 37, 11, &p, "range 0");
    p.range.distance = 1e-42f;
    try_size(r, 37, 11, &p, "a denormal range");
}

// ---- copies ----

static void copies(const struct run *r)
{
    static const char *const names[] = {"strength 0", "radius 0", "infinite range", "infinite f-number"};
    struct scene s = calm_scene(r->seed, 61, 37, CHANNELS);
    static const float strange[] = {1e-40f, -0.0f, -3, 65504, 1e30f, 3.4e38f, -3.4e38f};
    for (int i = 0; i < 61 * 37; i += 5)
        s.colour.plane[i % 4][i] = strange[i / 5 % 7];
    for (int i = 0; i < 4; i++) {
        struct hf_params p = r->subject->params;
        if (i == 0)
            p.range.strength = 0;
        if (i == 1)
            p.max_radius = 0;
        if (i == 2)
            p.range.distance = INFINITY;
        if (i == 3) {
            p.model = HF_MODEL_LENS;
            p.lens.f_number = INFINITY;
        }
        struct picture out = render_scene(r->c, &s, &p);
        int other = 0;
        for (int c = 0; c < CHANNELS; c++)
            for (size_t k = 0; k < samples_of(&out); k++)
                other += memcmp(&out.plane[c][k], &s.colour.plane[c][k], 4) != 0;
        see(r, "no blur: samples that are not the input's bits", "none may be", other, 0, "%s", names[i]);
        picture_free(&out);
    }
    scene_free(&s);
}

void small_sizes_cases(const struct run *r)
{
    at = mmap(NULL, PAGE, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (at == MAP_FAILED)
        return;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        small_sizes(r);
        _exit(0);
    }
    int status = 1;
    const int lost = child < 0 || waitpid(child, &status, 0) != child || status != 0;
    see(r, "sizes: crashes", "none may be", lost, 0, "%s", lost ? at : "all sizes");
    munmap(at, PAGE);
}

void sizes_cases(const struct run *r)
{
    copies(r);
}
