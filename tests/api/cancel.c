// SPDX-License-Identifier: BSD-3-Clause
// Cancelled calls, from another thread and from the progress callback: what they return, that the next frame has the bits
// of a fresh context's, and which progress is reported. `hyperfocal-bench cancel` measures how long a cancel takes.
//
//     cancel [rounds [seed]]
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "support/check.h"
#include "support/looks.h"
#include "support/render.h"
#include "tools/common/report.h"

enum { WIDTH = 180, HEIGHT = 120 };
static int rounds = 4;
static unsigned seed = 1;

// ---- callers that cancel

// Cancel from another thread, after some turns of an empty loop, again and again until the call returns.
struct canceller {
    struct hf_context *c;
    unsigned turns;
    atomic_int begun, over;
};

static void *cancel_main(void *arg)
{
    struct canceller *k = arg;
    while (!atomic_load(&k->begun))
        ;
    for (volatile unsigned i = 0; i < k->turns; i = i + 1)
        ;
    // If the call has not begun yet, a cancel has no effect.
    const struct timespec pause = {0, 20000};
    while (!atomic_load(&k->over)) {
        hf_cancel(k->c);
        nanosleep(&pause, NULL);
    }
    return NULL;
}

// Cancel from the progress callback, which also checks what it is given.
struct listener {
    pthread_mutex_t lock;  // tried in the callback: no other call may hold it
    pthread_t caller;
    struct hf_context *c;
    int calls, at, refuse, own_thread;  // cancel in that call, by the return value or by hf_cancel; -1: never
    float last;
};

static int listen(void *cookie, float done)
{
    struct listener *l = cookie;
    CHECK_MSG(pthread_mutex_trylock(&l->lock) == 0, "two threads call at once");
    CHECK_MSG(done > l->last || (l->calls == 0 && done == 0), "progress goes from %g to %g", l->last, done);
    CHECK_MSG(done >= 0 && done <= 1, "progress is %g", done);
    if (l->own_thread)
        CHECK_MSG(pthread_equal(l->caller, pthread_self()), "the callback runs on another thread");
    l->last = done;
    const int is = l->calls++ == l->at;
    if (is && !l->refuse)
        hf_cancel(l->c);
    pthread_mutex_unlock(&l->lock);
    return is && l->refuse;
}

static struct listener listener_new(struct hf_context *c)
{
    return (struct listener){
        .lock = PTHREAD_MUTEX_INITIALIZER, .caller = pthread_self(), .c = c, .at = -1, .own_thread = 1};
}

// ---- frames

struct frame {
    struct scene scene;
    struct picture out, want;
    struct hf_params p;
    const struct look *look;
};

static void same_as_fresh(struct hf_context *c, struct frame *f, const char *after)
{
    const int err = try_scene(c, &f->out, &f->scene, &f->p);
    CHECK_MSG(err == HF_OK, "%s: after %s: %s", f->look->name, after, hf_error_string(err));
    CHECK_MSG(picture_same_bits(&f->out, &f->want), "%s: after %s %d samples differ", f->look->name, after,
              samples_other(&f->out, &f->want));
}

// A cancelled call returns its error and leaves a report of zeros.
static void check_cancelled(struct hf_context *c, const struct frame *f, int err)
{
    static struct tool_report report;
    tool_report_get(c, &report);
    CHECK_MSG(err == HF_OK || err == HF_ERR_CANCELLED, "%s: %s", f->look->name, hf_error_string(err));
    if (err)
        CHECK_MSG(report.inner.columns == 0 && report.inner.passes == 0 && report.all.memory == 0,
                  "%s: the report of a cancelled call is not zero", f->look->name);
}

static int from_thread(struct hf_context *c, struct frame *f, int task, unsigned turns)
{
    struct canceller k = {.c = c, .turns = turns};
    pthread_t thread;
    const struct hf_depth depth = picture_depth(&f->scene.depth);
    const struct hf_image dst = picture_image(&f->out), src = picture_image(&f->scene.colour);
    struct hf_report report = {.size = sizeof(report)};
    CHECK_INT(pthread_create(&thread, NULL, cancel_main, &k), 0);
    atomic_store(&k.begun, 1);
    const int err = task == 0   ? hf_render(c, &dst, &src, &depth, &f->p)
                    : task == 1 ? hf_prepare(c, &dst, &src, &depth, &f->p)
                                : hf_plan(c, &dst, &src, &depth, &f->p, &report);
    atomic_store(&k.over, 1);
    pthread_join(thread, NULL);
    check_cancelled(c, f, err);
    return err;
}

static void try_threads(struct rng *rng, struct frame *f, int *cancelled)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 1 + rng_below(rng, 3), 32, 16);
    for (int i = 0; i < rounds; i++) {
        *cancelled +=
            from_thread(c, f, i % 4 == 3 ? 1 + rng_below(rng, 2) : 0, rng_u32(rng) % (1u << rng_below(rng, 20))) != 0;
        same_as_fresh(c, f, "a cancel from another thread");
        if (i % 2) {  // the first frame of a context has tables to make
            hf_close(&c);
            c = context_new(HF_ISA_AUTO, 1 + rng_below(rng, 3), 0, 0);
        }
    }
    hf_close(&c);
}

static void try_callback(struct rng *rng, struct frame *f)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 32, 16);
    struct listener l = listener_new(c);
    hf_set_progress(c, listen, &l);
    same_as_fresh(c, f, "nothing, with a callback");
    CHECK_MSG(l.last == 1 && l.calls <= 101, "%s: %d calls, the last with %g", f->look->name, l.calls, l.last);
    const int calls = l.calls;
    for (int i = 0; i < rounds && calls > 1; i++) {
        l = listener_new(c);
        l.at = rng_below(rng, calls - 1);
        l.refuse = i % 2;
        const int err = try_scene(c, &f->out, &f->scene, &f->p);
        // How many calls come depends on how the workers share the work: there may be fewer.
        CHECK_MSG(err == (l.calls > l.at && l.last < 1 ? HF_ERR_CANCELLED : HF_OK), "%s: cancelled in call %d: %s",
                  f->look->name, l.at, hf_error_string(err));
        CHECK_MSG(err == HF_OK || l.calls == l.at + 1, "%s: %d calls after it was cancelled", f->look->name,
                  l.calls - l.at - 1);
        hf_set_progress(c, NULL, NULL);
        same_as_fresh(c, f, "a cancel from the callback");
        hf_set_progress(c, listen, &l);
    }
    hf_close(&c);
}

// In place the picture may be anything, but the context must be usable.
static void try_in_place(struct rng *rng, struct frame *f)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    struct listener l = listener_new(c);
    struct picture copy = picture_copy(&f->scene.colour);
    const struct hf_depth depth = picture_depth(&f->scene.depth);
    const struct hf_image image = picture_image(&copy);
    l.at = rng_below(rng, 6);
    hf_set_progress(c, listen, &l);
    hf_render(c, &image, &image, &depth, &f->p);
    hf_set_progress(c, NULL, NULL);
    same_as_fresh(c, f, "a cancel in place");
    picture_free(&copy);
    hf_close(&c);
}

// ---- calls with nothing to cancel

static void quiet(void)
{
    struct rng rng = rng_seed(seed);
    struct frame f = {.scene = scene_new(&rng, SCENE_SHARP, WIDTH, HEIGHT, 3), .look = &looks[0]};
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 32, 16);
    struct listener l = listener_new(c);
    f.p = look_params(f.look, WIDTH, 10);
    f.out = picture_new(WIDTH, HEIGHT, 3);
    hf_cancel(NULL);
    hf_set_progress(NULL, listen, &l);
    hf_cancel(c);
    hf_cancel(c);
    CHECK_INT(try_scene(c, &f.out, &f.scene, &f.p), HF_OK);
    CHECK(picture_same_bits(&f.out, &f.scene.colour));
    // A plain copy reports progress too, and can be cancelled.
    f.p.max_radius = 0;
    hf_set_progress(c, listen, &l);
    CHECK_INT(try_scene(c, &f.out, &f.scene, &f.p), HF_OK);
    CHECK(l.last == 1);
    l = listener_new(c);
    l.at = 0;
    const int err = try_scene(c, &f.out, &f.scene, &f.p);
    // Where the other worker copies every row first, the only call is the last one, which cannot cancel any more.
    CHECK_INT(err, l.last < 1 ? HF_ERR_CANCELLED : HF_OK);
    CHECK_INT(l.calls, 1);
    hf_close(&c);
    scene_free(&f.scene);
    picture_free(&f.out);
}

// With the host's threads any of them may call the callback, but only one at a time.
struct host {
    int n, threads;
    void (*fn)(void *arg, int i, int worker);
    void *arg;
    atomic_int next;
};

struct host_worker {
    struct host *host;
    int number;
};

static void *host_main(void *arg)
{
    const struct host_worker *w = arg;
    for (int i; (i = atomic_fetch_add(&w->host->next, 1)) < w->host->n;)
        w->host->fn(w->host->arg, i, w->number);
    return NULL;
}

static void host_for(void *cookie, int n, void (*fn)(void *arg, int i, int worker), void *arg)
{
    struct host h = {.n = n, .fn = fn, .arg = arg};
    struct host_worker w[3];
    pthread_t thread[3];
    (void)cookie;
    for (int i = 0; i < 3; i++) {
        w[i] = (struct host_worker){&h, i};
        pthread_create(&thread[i], NULL, host_main, &w[i]);
    }
    for (int i = 0; i < 3; i++)
        pthread_join(thread[i], NULL);
}

static void host_threads(struct frame *f)
{
    struct hf_config config = scene_config(HF_ISA_AUTO, 3);
    struct hf_context *c = NULL;
    config.parallel_for = host_for;
    config.tile_width = 32;
    config.tile_height = 16;
    CHECK_INT(hf_open(&c, &config), HF_OK);
    struct listener l = listener_new(c);
    l.own_thread = 0;
    hf_set_progress(c, listen, &l);
    same_as_fresh(c, f, "nothing, on the host's threads");
    CHECK_MSG(l.last == 1, "the last progress is %g", l.last);
    l = listener_new(c);
    l.own_thread = 0;
    l.at = 0;
    CHECK_INT(try_scene(c, &f->out, &f->scene, &f->p), HF_ERR_CANCELLED);
    l.at = -1;
    l.last = 0;
    l.calls = 0;
    same_as_fresh(c, f, "a cancel on the host's threads");
    hf_close(&c);
}

int main(int argc, char **argv)
{
    rounds = argc > 1 ? atoi(argv[1]) : check_long() ? 200 : 6;
    seed = argc > 2 ? (unsigned)atoi(argv[2]) : 1;
    int cancelled = 0;
    struct rng rng = rng_seed(seed);
    quiet();
    for (int i = 0; i < LOOKS; i++) {
        struct frame f = {.look = &looks[i]};
        struct hf_context *fresh = context_new(HF_ISA_AUTO, 1, 0, 0);
        f.scene = scene_new(&rng, i % 2 ? SCENE_HIGHLIGHTS : SCENE_BLOCKS, WIDTH, HEIGHT, 3 + i % 2);
        f.out = picture_new(WIDTH, HEIGHT, f.scene.colour.channels);
        f.p = look_params(&looks[i], WIDTH, 20);
        f.want = render_scene(fresh, &f.scene, &f.p);
        hf_close(&fresh);
        try_threads(&rng, &f, &cancelled);
        try_callback(&rng, &f);
        try_in_place(&rng, &f);
        if (i % 4 == 0)
            host_threads(&f);
        scene_free(&f.scene);
        picture_free(&f.out);
        picture_free(&f.want);
    }
    CHECK_MSG(cancelled > 0, "no call was cancelled from another thread");
    return check_report();
}
