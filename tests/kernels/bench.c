// SPDX-License-Identifier: BSD-3-Clause
// Times the calls of the tests on a typical tile: 128 x 64 half-resolution pixels, radius 12.
#include <stdio.h>
#include <stdlib.h>

#include "base/system.h"
#include "harness.h"

enum { SAMPLES = 41, SAMPLE_NS = 300000 };

static double now_ns(void)
{
    return (double)hf_now_ns();
}

// Cycles of the clock that never changes its speed; 0 if there is none.
static double now_cycles(void)
{
#if defined(__x86_64__)
    return (double)__builtin_ia32_rdtsc();
#else
    return 0;
#endif
}

struct timing {
    double min_ns, median_ns, min_cycles;
};

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void repeat(struct world *w, const struct test *t, const struct kernels *k, int n)
{
    for (int i = 0; i < n; i++)
        t->call(w, k, ARENA_TEST, t->index);
}

static struct timing time_kernel(struct world *w, const struct test *t, const struct kernels *k)
{
    world_reset(w, ARENA_TEST);
    // As many calls per sample as the clock's resolution needs. These calls also warm up.
    int calls = 1;
    for (double ns = 0; ns < SAMPLE_NS && calls < 1 << 20; calls *= 2) {
        const double start = now_ns();
        repeat(w, t, k, calls);
        ns = now_ns() - start;
    }
    double ns[SAMPLES], cycles[SAMPLES];
    for (int i = 0; i < SAMPLES; i++) {
        const double start = now_ns(), start_cycles = now_cycles();
        repeat(w, t, k, calls);
        cycles[i] = (now_cycles() - start_cycles) / calls;
        ns[i] = (now_ns() - start) / calls;
    }
    qsort(ns, SAMPLES, sizeof *ns, by_value);
    qsort(cycles, SAMPLES, sizeof *cycles, by_value);
    return (struct timing){ns[0], ns[SAMPLES / 2], cycles[0]};
}

void bench_run(struct world *w, const struct level *levels, int level_count, const char *name)
{
    printf("%-18s %-16s %12s %12s %10s %8s\n", "kernel", "isa", "min ns", "median ns", "cycles/px", "C / isa");
    for (int i = 0; i < test_count; i++) {
        const struct test *t = &tests[i];
        if (name && strcmp(name, t->name))
            continue;
        w->rng = rng_from(1, 1);
        w->bench = 1;
        t->make(w, t->index);
        w->bench = 0;
        double c_ns = 0;
        for (int l = 0; l < level_count; l++) {
            if (!levels[l].isa)
                continue;
            const struct timing m = time_kernel(w, t, &levels[l].k);
            if (l == 0)
                c_ns = m.min_ns;
            printf("%-18s %-16s %12.0f %12.0f %10.2f %8.2f\n", t->name, levels[l].name, m.min_ns, m.median_ns,
                   m.min_cycles / t->pixels(w), c_ns / m.min_ns);
        }
    }
}
