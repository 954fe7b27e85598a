// SPDX-License-Identifier: BSD-3-Clause
// The contents of fresh memory: no engine's result may depend on it, at any width, resolution and instruction set. Each
// width uses one of four radii, another one at each instruction set, and all of them if HF_LONG is set.
//
//     fresh [seed]
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "support/check.h"
#include "support/render.h"

enum { HEIGHT = 20, WIDEST = 70, SEEDS = 3 };

static unsigned seed = 1;

// ---- memory that was used before

// Words of an old heap: random bits, plausible radii and colours, small integers, numbers near the largest.
static uint32_t old_word(struct rng *rng)
{
    const float value[2] = {rng_range(rng, -40, 40), rng_range(rng, -3e38f, 3e38f)};
    uint32_t bits = rng_u32(rng);
    switch (rng_below(rng, 4)) {
    case 0:
        memcpy(&bits, &value[0], 4);
        return bits;
    case 1:
        memcpy(&bits, &value[1], 4);
        return bits;
    case 2:
        return bits % 5000;
    default:
        return bits;
    }
}

// A file of such words. Each block is a private mapping of it, so unused pages cost nothing. Blocks end at forbidden
// pages, so that an old word used as a large index faults.
enum { OLD_WORDS = 1 << 18, OLD_BYTES = 4 * OLD_WORDS, HEAD = 64, GUARD = 1 << 20 };

static int heap_new(unsigned heap_seed)
{
    const int fd = memfd_create("old heap", MFD_CLOEXEC);
    uint32_t *word = fd < 0 || ftruncate(fd, OLD_BYTES)
                         ? MAP_FAILED
                         : mmap(NULL, OLD_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    struct rng rng = rng_seed(heap_seed);
    if (word == MAP_FAILED)
        return -1;
    for (int i = 0; i < OLD_WORDS; i++)
        word[i] = old_word(&rng);
    munmap(word, OLD_BYTES);
    return fd;
}

static void *alloc_old(void *cookie, size_t size, size_t align)
{
    const int fd = *(const int *)cookie;
    const size_t page = (size_t)sysconf(_SC_PAGESIZE), block = (size + align - 1) / align * align;
    const size_t whole = (block + HEAD + page - 1) / page * page;
    char *memory = mmap(NULL, whole + GUARD, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED || align > HEAD)
        return NULL;
    for (size_t at = 0; at < whole; at += OLD_BYTES)
        if (mmap(memory + at, whole - at < OLD_BYTES ? whole - at : OLD_BYTES, PROT_READ | PROT_WRITE,
                 MAP_PRIVATE | MAP_FIXED, fd, 0) == MAP_FAILED)
            return NULL;
    char *p = memory + whole - block;
    const size_t head[2] = {(size_t)(p - memory), whole + GUARD};
    memcpy(p - HEAD, head, sizeof head);
    return p;
}

static void free_old(void *cookie, void *p)
{
    (void)cookie;
    size_t head[2];
    memcpy(head, (char *)p - HEAD, sizeof head);
    munmap((char *)p - head[0], head[1]);
}

// ---- scenes: every kind of pixel beside every other, up to the edge

static struct scene patches(struct rng *rng, int width, float radius)
{
    struct scene s = {picture_new(width, HEIGHT, 4), picture_new(width, HEIGHT, 1)};
    static const float parts[] = {1, -1, 0, 0.5f, -0.03f};
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < width; x++) {
            const int i = y * width + x;
            s.depth.plane[0][i] = x && rng_below(rng, 4) ? s.depth.plane[0][i - 1] : radius * parts[rng_below(rng, 5)];
            for (int c = 0; c < 3; c++)
                s.colour.plane[c][i] = rng_float(rng);
            s.colour.plane[3][i] = 1;
        }
    return s;
}

static int heaps[SEEDS];

static struct picture render_fresh(const struct scene *s, const struct hf_params *p, enum hf_isa isa, int *heap)
{
    // One cell, so that widths decide what lies past the end of a row.
    const struct hf_config config = {
        .size = sizeof config, .isa = isa, .threads = 1, .alloc = alloc_old, .free = free_old, .alloc_cookie = heap};
    const struct hf_depth depth = picture_radii(&s->depth);
    struct hf_context *c;
    CHECK_INT(hf_open(&c, &config), HF_OK);
    struct picture out = render(c, &s->colour, &depth, p);
    hf_close(&c);
    return out;
}

// Count the renders that differ from that on the first heap.
static int others(const struct scene *s, const struct hf_params *p, enum hf_isa isa)
{
    struct picture want = render_fresh(s, p, isa, &heaps[0]);
    int n = 0;
    for (int i = 1; i < SEEDS; i++) {
        struct picture got = render_fresh(s, p, isa, &heaps[i]);
        n += !picture_same_bits(&want, &got);
        picture_free(&got);
    }
    picture_free(&want);
    return n;
}

static void one(enum hf_engine engine, const char *name, enum hf_isa isa, int width, float radius, int half)
{
    struct rng rng = rng_seed(seed + 100 * (unsigned)width);
    struct scene s = patches(&rng, width, radius);
    struct hf_params p = scene_params();
    p.engine = engine;
    p.max_radius = radius < 1 ? HF_DERIVE : radius;
    p.hexagon.resolution = p.scatter.resolution = p.gaussian.resolution =
        half ? HF_RESOLUTION_HALF : HF_RESOLUTION_FULL;
    p.layers.quality = half ? HF_LAYERS_DRAFT : width & 1 ? HF_LAYERS_BEST : HF_LAYERS_STANDARD;
    const int n = others(&s, &p, isa);
    CHECK_MSG(!n, "%s, %s, %d wide, radius %g, %s resolution: %d of %d heaps give other bits", name, hf_isa_name(isa),
              width, (double)radius, half ? "half" : "full", n, SEEDS - 1);
    scene_free(&s);
}

static void widths(enum hf_engine engine, const char *name, enum hf_isa isa)
{
    // the last is below any normal number
    static const float radii[] = {1, 8, 30, 1e-42f};
    const int resolutions = engine == HF_ENGINE_GATHER || engine == HF_ENGINE_CHAPTER ? 1 : 2;
    for (int width = 1; width <= WIDEST; width++)
        for (int i = 0; i < 4; i++)
            // The neighbouring widths, and other instruction sets, have the other radii. The scatter draws its sprites
            // anew in each context, which takes by far the most time.
            for (int half = 0; half < resolutions; half++)
                if (check_long() || (i + width + width / 4 + (int)isa) % (engine == HF_ENGINE_SCATTER ? 8 : 4) == 0)
                    one(engine, name, isa, width, radii[i], half);
}

int main(int argc, char **argv)
{
    static const enum hf_isa isas[] = {HF_ISA_SCALAR, HF_ISA_SSE41, HF_ISA_AVX2, HF_ISA_AVX512, HF_ISA_NEON};
    static const struct {
        enum hf_engine engine;
        const char *name;
    } engines[] = {{HF_ENGINE_GATHER, "gather"},     {HF_ENGINE_HEXAGON, "hexagon"}, {HF_ENGINE_SCATTER, "scatter"},
                   {HF_ENGINE_GAUSSIAN, "gaussian"}, {HF_ENGINE_LAYERS, "layers"},   {HF_ENGINE_CHAPTER, "chapter"}};
    seed = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 0) : 1;
    printf("seed %u\n", seed);
    for (unsigned i = 0; i < SEEDS; i++) {
        heaps[i] = heap_new(seed + i);
        if (!CHECK(heaps[i] >= 0))
            return check_report();
    }
    for (size_t i = 0; i < sizeof isas / sizeof *isas; i++)
        for (size_t k = 0; k < sizeof engines / sizeof *engines && hf_isa_available(isas[i]); k++)
            widths(engines[k].engine, engines[k].name, isas[i]);
    return check_report();
}
