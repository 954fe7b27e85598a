// SPDX-License-Identifier: BSD-3-Clause
// The public API, second part: what a context does with memory, threads and statistics.
//
//     context [seed]
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/render.h"
#include "tools/common/report.h"

static unsigned seed = 1;

// An allocator that counts, fails on demand, and checks what is freed.
struct counter {
    pthread_mutex_t lock;
    long calls, live;
    size_t bytes, most;
    long fail_at;  // this call and all later ones return NULL; -1: never
};

struct header {
    void *block;
    size_t size, magic;
};

static void *count_alloc(void *cookie, size_t size, size_t align)
{
    struct counter *n = cookie;
    pthread_mutex_lock(&n->lock);
    const int fail = n->fail_at >= 0 && n->calls >= n->fail_at;
    n->calls++;
    if (!fail) {
        n->live++;
        n->bytes += size;
        n->most = n->bytes > n->most ? n->bytes : n->most;
    }
    pthread_mutex_unlock(&n->lock);
    if (fail)
        return NULL;
    CHECK_MSG(size > 0, "allocation of 0 bytes");
    CHECK_MSG(align && (align & (align - 1)) == 0, "alignment %zu", align);
    const size_t step = align > sizeof(struct header) ? align : sizeof(struct header);
    unsigned char *block = malloc(size + 2 * step + align);
    uintptr_t p = ((uintptr_t)block + step + align - 1) / align * align;
    *(struct header *)(p - sizeof(struct header)) = (struct header){block, size, 0x600d600d};
    memset((void *)p, 0xff, size);  // NaN: no code may rely on zeros
    return (void *)p;
}

static void count_free(void *cookie, void *p)
{
    struct counter *n = cookie;
    if (!CHECK_MSG(p != NULL, "free of NULL"))
        return;
    struct header *h = (struct header *)((uintptr_t)p - sizeof *h);
    CHECK_MSG(h->magic == 0x600d600d, "free of a pointer that alloc did not return");
    h->magic = 0;
    pthread_mutex_lock(&n->lock);
    n->live--;
    n->bytes -= h->size;
    pthread_mutex_unlock(&n->lock);
    free(h->block);
}

static struct counter counter_new(void)
{
    return (struct counter){.lock = PTHREAD_MUTEX_INITIALIZER, .fail_at = -1};
}

static struct hf_config counted(struct counter *n)
{
    return (struct hf_config){
        .size = sizeof(struct hf_config), .threads = 2, .alloc = count_alloc, .free = count_free, .alloc_cookie = n};
}

// All options on, so that every kind of buffer is allocated.
static struct hf_params rich_params(void)
{
    struct hf_params p = scene_params();
    p.gather = (struct hf_gather_params){.karis = 1, .per_pixel_kernel = 1, .bicubic = 1};
    p.aperture.blades = 7;
    return p;
}

// With tiles larger than the frame, a context takes no more memory than for one of the frame's size.
static void large_tiles(void)
{
    struct rng rng = rng_seed(seed);
    struct scene s = scene_new(&rng, SCENE_BLOCKS, 60, 40, 4);
    struct picture out = picture_new(60, 40, 4);
    for (int e = 0; e < tool_engines(); e++) {
        size_t held[2];
        struct hf_params p = scene_params();
        p.engine = (enum hf_engine)e;
        for (int i = 0; i < 2; i++) {
            struct counter n = counter_new();
            struct hf_config config = counted(&n);
            struct hf_context *c;
            config.tile_width = i ? 65536 : 32;
            config.tile_height = i ? 65536 : 32;
            CHECK_INT(hf_open(&c, &config), HF_OK);
            CHECK_INT(try_scene(c, &out, &s, &p), HF_OK);
            held[i] = n.most;
            hf_close(&c);
        }
        CHECK_MSG(held[1] <= 2 * held[0], "engine %d: %zu bytes with tiles of 65536, %zu with those of 32", e, held[1],
                  held[0]);
    }
    picture_free(&out);
    scene_free(&s);
}

static void memory(void)
{
    struct rng rng = rng_seed(seed);
    struct scene small = scene_new(&rng, SCENE_BLOCKS, 60, 40, 4), big = scene_new(&rng, SCENE_BLOCKS, 301, 203, 4);
    struct picture out = picture_new(60, 40, 4), big_out = picture_new(301, 203, 4);
    const struct hf_params p = rich_params();
    struct counter n = counter_new();
    struct hf_config config = counted(&n);
    struct hf_context *c;
    CHECK_INT(hf_open(&c, &config), HF_OK);
    CHECK_INT(try_scene(c, &out, &small, &p), HF_OK);
    long calls = n.calls;
    for (int i = 0; i < 3; i++)
        CHECK_INT(try_scene(c, &out, &small, &p), HF_OK);
    CHECK_MSG(n.calls == calls, "%ld allocations on frames of a known size", n.calls - calls);
    CHECK_INT(try_scene(c, &big_out, &big, &p), HF_OK);
    calls = n.calls;
    CHECK_INT(try_scene(c, &big_out, &big, &p), HF_OK);
    CHECK_MSG(n.calls == calls, "%ld allocations on a second big frame", n.calls - calls);
    struct tool_report stats;
    tool_report_get(c, &stats);
    CHECK_MSG(stats.all.memory_held == n.bytes, "statistics say %zu bytes, the allocator %zu", stats.all.memory_held,
              n.bytes);
    hf_close(&c);
    CHECK_INT(n.live, 0);
    CHECK_INT(n.bytes, 0);
    picture_free(&out);
    picture_free(&big_out);
    scene_free(&small);
    scene_free(&big);
}

static void no_dump(void *cookie, const struct hf_inspect_buffer *b)
{
    (void)b;
    ++*(int *)cookie;
}

// Each allocation fails once. The context stays usable, and nothing leaks.
static void failing_memory(int dump)
{
    struct rng rng = rng_seed(seed);
    struct scene s = scene_new(&rng, SCENE_BLOCKS, 60, 40, 4);
    struct picture out = picture_new(60, 40, 4), want = picture_new(60, 40, 4);
    const struct hf_params p = rich_params();
    struct hf_context *c;
    CHECK_INT(hf_open(&c, NULL), HF_OK);
    CHECK_INT(try_scene(c, &want, &s, &p), HF_OK);
    hf_close(&c);
    int failures = 0;
    for (long k = 0; k < 1000; k++) {
        struct counter n = counter_new();
        struct hf_config config = counted(&n);
        n.fail_at = k;
        int dumped = 0, err = hf_open(&c, &config);
        if (err) {
            CHECK_INT(err, HF_ERR_MEMORY);
            CHECK(c == NULL);
        } else {
            if (dump)
                hf_inspect_dump(c, no_dump, &dumped);
            err = try_scene(c, &out, &s, &p);
            CHECK_MSG(err == HF_OK || err == HF_ERR_MEMORY, "allocation %ld fails: error %d", k, err);
            n.fail_at = -1;
            CHECK_INT(try_scene(c, &out, &s, &p), HF_OK);
            CHECK_MSG(picture_same_bits(&out, &want), "other bits after allocation %ld failed", k);
            hf_close(&c);
        }
        CHECK_MSG(n.live == 0, "%ld blocks leak when allocation %ld fails", n.live, k);
        failures += err != HF_OK;
        if (!err)
            break;
    }
    CHECK_MSG(failures >= 2 && failures < 999, "%d allocations failed", failures);
    picture_free(&out);
    picture_free(&want);
    scene_free(&s);
}

// A host's parallel_for: serial, backwards, using as many worker numbers as promised.
struct host {
    int threads, calls, items;
};

static void backwards(void *cookie, int n, void (*fn)(void *arg, int i, int worker), void *arg)
{
    struct host *h = cookie;
    h->calls++;
    for (int i = n - 1; i >= 0; i--) {
        fn(arg, i, i % h->threads);
        h->items++;
    }
}

// Another one: threads made for each call.
struct share {
    void (*fn)(void *arg, int i, int worker);
    void *arg;
    int n, worker, threads;
};

static void *run_share(void *arg)
{
    const struct share *s = arg;
    for (int i = s->worker; i < s->n; i += s->threads)
        s->fn(s->arg, i, s->worker);
    return NULL;
}

static void forwards(void *cookie, int n, void (*fn)(void *arg, int i, int worker), void *arg)
{
    struct host *h = cookie;
    pthread_t thread[8];
    struct share share[8];
    h->calls++;
    h->items += n;
    for (int t = 0; t < h->threads; t++) {
        share[t] = (struct share){fn, arg, n, t, h->threads};
        pthread_create(&thread[t], NULL, run_share, &share[t]);
    }
    for (int t = 0; t < h->threads; t++)
        pthread_join(thread[t], NULL);
}

static void host_threads(void)
{
    struct rng rng = rng_seed(seed);
    struct scene s = scene_new(&rng, SCENE_BLOCKS, 301, 203, 3);
    struct picture out = picture_new(301, 203, 3), want = picture_new(301, 203, 3);
    struct hf_context *c;
    const struct hf_config one = {.size = sizeof one, .threads = 1};
    const struct hf_params p = scene_params();
    CHECK_INT(hf_open(&c, &one), HF_OK);
    CHECK_INT(try_scene(c, &want, &s, &p), HF_OK);
    hf_close(&c);
    for (int threads = 1; threads <= 8; threads++) {
        for (int kind = 0; kind < 3; kind++) {
            struct host h = {.threads = threads};
            const struct hf_config config = {.size = sizeof config,
                                             .threads = threads,
                                             .parallel_for = kind == 0   ? backwards
                                                             : kind == 1 ? forwards
                                                                         : NULL,
                                             .parallel_cookie = &h};
            CHECK_INT(hf_open(&c, &config), HF_OK);
            CHECK_INT(hf_context_threads(c), threads);
            for (int i = 0; i < 3; i++) {
                CHECK_INT(try_scene(c, &out, &s, &p), HF_OK);
                CHECK_MSG(picture_same_bits(&out, &want), "other bits with %d threads, kind %d", threads, kind);
            }
            CHECK(kind == 2 || (h.calls > 0 && h.items >= h.calls));
            hf_close(&c);
        }
    }
    picture_free(&out);
    picture_free(&want);
    scene_free(&s);
}

// Contexts of several threads at once.
struct user {
    const struct scene *scene;
    const struct picture *want;
    enum hf_isa isa;
    int bad;
};

static void *use_context(void *arg)
{
    struct user *u = arg;
    const struct hf_params p = scene_params();
    const struct hf_config config = {.size = sizeof config, .threads = 2, .isa = u->isa};
    for (int round = 0; round < 3; round++) {
        struct hf_context *c;
        struct picture out = picture_new(u->want->width, u->want->height, u->want->channels);
        if (hf_open(&c, &config) != HF_OK)
            u->bad++;
        for (int i = 0; i < 5; i++)
            if (try_scene(c, &out, u->scene, &p) != HF_OK || !picture_same_bits(&out, u->want))
                u->bad++;
        hf_close(&c);
        picture_free(&out);
    }
    return NULL;
}

static void many_contexts(void)
{
    enum { USERS = 6 };
    struct rng rng = rng_seed(seed);
    struct scene scene[USERS];
    struct picture want[USERS];
    struct user user[USERS];
    pthread_t thread[USERS];
    const struct hf_params p = scene_params();
    for (int i = 0; i < USERS; i++) {
        const struct hf_config config = {
            .size = sizeof config, .threads = 1, .isa = i & 1 ? HF_ISA_SCALAR : HF_ISA_AUTO};
        struct hf_context *c;
        scene[i] = scene_new(&rng, SCENE_BLOCKS, 50 + 13 * i, 60 - 5 * i, 3 + i % 2);
        want[i] = picture_new(50 + 13 * i, 60 - 5 * i, 3 + i % 2);
        user[i] = (struct user){&scene[i], &want[i], config.isa, 0};
        CHECK_INT(hf_open(&c, &config), HF_OK);
        CHECK_INT(try_scene(c, &want[i], &scene[i], &p), HF_OK);
        hf_close(&c);
    }
    for (int i = 0; i < USERS; i++)
        pthread_create(&thread[i], NULL, use_context, &user[i]);
    for (int i = 0; i < USERS; i++) {
        pthread_join(thread[i], NULL);
        CHECK_MSG(user[i].bad == 0, "context %d: %d bad frames", i, user[i].bad);
        picture_free(&want[i]);
        scene_free(&scene[i]);
    }
}

static const struct hf_inspect_pass *pass_of(const struct tool_report *r, const char *name)
{
    int i = 0;
    while (i < r->inner.passes && strcmp(r->pass[i].name, name))
        i++;
    CHECK_MSG(i < r->inner.passes, "there is no pass %s", name);
    return &r->pass[i % TOOL_PASSES];
}

static void check_stats(const struct tool_report *s, int pixels)
{
    CHECK_INT(s->all.near_pixels + s->all.sharp_pixels + s->all.far_pixels, pixels);
    CHECK(s->all.total_ms > 0 && s->all.memory_held > 0);
    double sum = 0;
    for (int i = 0; i < s->inner.passes; i++) {
        CHECK(s->pass[i].ms >= 0 && s->pass[i].ran <= s->pass[i].all && s->pass[i].all > 0);
        sum += s->pass[i].ms;
    }
    CHECK_MSG(sum <= s->all.total_ms * 1.05 + 0.1, "passes %g ms, frame %g ms", sum, s->all.total_ms);
}

static void statistics(void)
{
    struct rng rng = rng_seed(seed);
    struct hf_context *c;
    struct tool_report stats;
    struct hf_params p = scene_params();
    struct picture out = picture_new(64, 48, 3);
    CHECK_INT(hf_open(&c, NULL), HF_OK);
    struct scene sharp = scene_new(&rng, SCENE_SHARP, 64, 48, 3);
    CHECK_INT(try_scene(c, &out, &sharp, &p), HF_OK);
    tool_report_get(c, &stats);
    check_stats(&stats, 64 * 48);
    CHECK_INT(stats.all.sharp_pixels, 64 * 48);
    CHECK_INT(pass_of(&stats, "Computation")->ran, 0);
    CHECK_INT(pass_of(&stats, "Computation")->ran, 0);
    CHECK(stats.params.max_radius == 12);
    CHECK(picture_same_bits(&out, &sharp.colour));
    // One near, two far, one without surface (far), one NaN (among sharp ones: sharp); two bad colour samples.
    sharp.depth.plane[0][5] = 12;
    sharp.depth.plane[0][300] = 25;
    sharp.depth.plane[0][301] = 1000;
    sharp.depth.plane[0][1500] = 0;
    sharp.depth.plane[0][2000] = NAN;
    sharp.colour.plane[0][700] = NAN;
    sharp.colour.plane[2][701] = -INFINITY;
    for (int no_skip = 0; no_skip < 2; no_skip++) {
        p.run.no_skip = no_skip;
        CHECK_INT(try_scene(c, &out, &sharp, &p), HF_OK);
        tool_report_get(c, &stats);
        check_stats(&stats, 64 * 48);
        CHECK_INT(stats.all.near_pixels, 1);
        CHECK_INT(stats.all.far_pixels, 3);
        CHECK_INT(stats.all.no_surface, 1);
        CHECK_INT(stats.all.depth_repaired, 1);
        CHECK_INT(stats.all.colour_repaired, 2);
        CHECK_INT(stats.all.clamped, 0);
        CHECK(!no_skip || pass_of(&stats, "Computation")->ran == pass_of(&stats, "Computation")->all);
    }
    // Counts do not depend on skipping. Negative and too large samples are clamped by the format.
    struct packed packed = packed_new(64, 48, HF_FORMAT_R11G11B10F, 0, 0, 0, 0, 0);
    scene_free(&sharp);
    sharp = scene_new(&rng, SCENE_SHARP, 64, 48, 3);
    sharp.colour.plane[0][0] = -1;
    sharp.colour.plane[1][3000] = 1e6f;
    const struct hf_image src = picture_image(&sharp.colour);
    const struct hf_depth depth = picture_depth(&sharp.depth);
    CHECK_INT(hf_render(c, &packed.image, &src, &depth, &p), HF_OK);
    tool_report_get(c, &stats);
    CHECK_INT(stats.all.clamped, 2);
    CHECK_INT(stats.all.colour_repaired, 0);
    packed_free(&packed);
    scene_free(&sharp);
    p.max_radius = HF_DERIVE;
    p.view.display_height = 2160;
    struct scene blocks = scene_new(&rng, SCENE_BLOCKS, 64, 48, 3);
    CHECK_INT(try_scene(c, &out, &blocks, &p), HF_OK);
    tool_report_get(c, &stats);
    CHECK_MSG(stats.params.max_radius == 24, "max_radius %g", stats.params.max_radius);
    scene_free(&blocks);
    picture_free(&out);
    hf_close(&c);
}

// A lens for which everything is near, or far: buffers of the other field do not exist, and no pass may use them.
static void one_field(void)
{
    for (int engine = 0; engine < tool_engines(); engine++)
        for (int far = 0; far < 2; far++) {
            struct rng rng = rng_seed(seed);
            struct scene s = scene_new(&rng, far ? SCENE_FAR : SCENE_NEAR, 40, 30, 4);
            struct hf_context *c = context_new(HF_ISA_SCALAR, 2, 0, 0);
            struct hf_params p = hf_default_params();
            p.engine = (enum hf_engine)engine;
            p.model = HF_MODEL_LENS;
            p.focus = 20;
            p.lens.f_number = 2.8f;
            p.lens.focal_length_mm = 400;
            p.lens.world_unit_m = 1;
            struct picture out = render_scene(c, &s, &p);
            CHECK_MSG(all_finite(&out), "%s, %s field alone: not finite", hf_engine_name(p.engine),
                      far ? "far" : "near");
            picture_free(&out);
            scene_free(&s);
            hf_close(&c);
        }
}

int main(int argc, char **argv)
{
    seed = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 1;
    printf("seed %u\n", seed);
    memory();
    large_tiles();
    failing_memory(0);
    failing_memory(1);
    host_threads();
    many_contexts();
    statistics();
    one_field();
    return check_report();
}
