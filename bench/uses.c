// SPDX-License-Identifier: BSD-3-Clause
// Times a frame in place and one out of place, and the first frame of a context with and without hf_prepare.
#include "measure.h"
#include "statistics.h"

#include <stdint.h>
#include <string.h>
#include <sys/mman.h>

enum { PAIRS = 41, FIRSTS = 11, LATER = 3 };
static const size_t LARGE_PAGE = 1 << 21;

// Memory that nobody has touched, as a program's first context finds it. Memory that another context gave back to
// malloc has its pages already, and pages are most of the cost of a first frame. It lies on large pages, as the
// library's own does. The mapping's size and start are stored before the caller's part.
static void *fresh_alloc(void *cookie, size_t size, size_t align)
{
    (void)cookie;
    (void)align;  // at most a page
    const size_t bytes = size + 2 * LARGE_PAGE;
    uint8_t *p = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (p == MAP_FAILED)
        return NULL;
    const size_t before = LARGE_PAGE - (uintptr_t)p % LARGE_PAGE;  // at least a page
    size_t *own = (size_t *)(void *)(p + before) - 2;
    own[0] = bytes;
    own[1] = before;
#ifdef MADV_HUGEPAGE
    if (size >= 2 * LARGE_PAGE)
        madvise(p + before, size / LARGE_PAGE * LARGE_PAGE, MADV_HUGEPAGE);
#endif
    return p + before;
}

static void fresh_free(void *cookie, void *memory)
{
    (void)cookie;
    if (!memory)
        return;
    const size_t *own = (const size_t *)memory - 2, bytes = own[0];
    munmap((uint8_t *)memory - own[1], bytes);
}

static struct bench_row row_of(double ms[PAIRS])
{
    const double median = bench_median(ms, PAIRS);
    return (struct bench_row){median, ms[0], ms[PAIRS - 1], -1};
}

// A frame in place overwrites its input, so each one starts from a fresh copy of the picture.
static int in_place(const struct bench_subject *s, struct hf_context *c, double *ms, struct tool_error *error)
{
    memcpy(s->out.memory, s->in.memory, s->in.bytes);
    return bench_measure_frame(s, c, &s->out, ms, error);
}

// ms: the first frame of a context. later: a frame after LATER more, in the same memory.
static int first(const struct bench_subject *s, int prepare, double *ms, double *later, struct tool_error *error)
{
    const struct hf_config config = {.size = sizeof config,
                                     .threads = hf_context_threads(s->context),
                                     .isa = hf_context_isa(s->context),
                                     .alloc = fresh_alloc,
                                     .free = fresh_free};
    struct hf_context *c;
    int err = hf_open(&c, &config);
    if (!err && prepare)
        err = hf_prepare(c, &s->out.image, &s->out.image, &s->depth, &s->params);
    if (err)
        tool_fail(error, -1, "a new context: %s", hf_error_string(err));
    else
        err = in_place(s, c, ms, error);
    for (int i = 0; i <= LATER && !err; i++)
        err = in_place(s, c, later, error);
    hf_close(&c);
    return err ? -1 : 0;
}

int bench_measure_uses(const struct bench_subject *s, struct bench_uses *uses, struct tool_error *error)
{
    double in[PAIRS], out[PAIRS], fresh[FIRSTS], prepared[FIRSTS], later[FIRSTS], unused;
    *uses = (struct bench_uses){0};
    if (s->in.image.format != s->out.image.format)
        return 0;
    for (int i = 0; i < PAIRS; i++)
        if (in_place(s, s->context, &in[i], error) || bench_measure_frame(s, s->context, &s->in, &out[i], error))
            return -1;
    for (int i = 0; i < FIRSTS; i++)
        if (first(s, 0, &fresh[i], &unused, error) || first(s, 1, &prepared[i], &later[i], error))
            return -1;
    *uses = (struct bench_uses){row_of(in), row_of(out), bench_median(fresh, FIRSTS), bench_median(prepared, FIRSTS),
                                bench_median(later, FIRSTS)};
    return 0;
}
