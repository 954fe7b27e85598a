// SPDX-License-Identifier: BSD-3-Clause
#include "schedule.h"

enum { MOST_THREADS = 256 };

const char *const bench_limit_names[BENCH_LIMITS] = {
    [BENCH_LIMIT_ALONE] = "one thread's work", [BENCH_LIMIT_FIRST] = "first sweep",
    [BENCH_LIMIT_LONGEST] = "longest cell",    [BENCH_LIMIT_UNEVEN] = "uneven cells",
    [BENCH_LIMIT_BARRIERS] = "barriers",       [BENCH_LIMIT_BANDWIDTH] = "bandwidth",
};

// When the last task of a step ends, if each task goes to the thread that is free first.
static double end_of(const struct bench_step *s, int threads)
{
    double free_at[MOST_THREADS] = {0}, end = 0;
    for (int i = 0; i < s->count; i++) {
        int first = 0;
        for (int k = 1; k < threads; k++)
            first = free_at[k] < free_at[first] ? k : first;
        free_at[first] += s->ms[i];
        end = free_at[first] > end ? free_at[first] : end;
    }
    return end;
}

static void add_step(struct bench_expected *e, const struct bench_step *s, const struct bench_node *node, int first)
{
    const int threads = node->threads < MOST_THREADS ? node->threads : MOST_THREADS;
    double sum = 0, longest = 0;
    for (int i = 0; i < s->count; i++) {
        sum += s->ms[i];
        longest = s->ms[i] > longest ? s->ms[i] : longest;
    }
    const double end = end_of(s, threads), idle = end - sum / threads;
    const double above = longest - sum / threads, alone = above > 0 ? above : 0;
    const int sockets = node->socket ? (threads + node->socket - 1) / node->socket : 1;
    const double moving = node->bandwidth > 0 ? s->bytes / (node->bandwidth * sockets) : 0;
    e->ideal += sum / threads;
    if (first) {
        e->lost[BENCH_LIMIT_FIRST] += idle;
    } else {
        e->lost[BENCH_LIMIT_LONGEST] += alone;
        e->lost[BENCH_LIMIT_UNEVEN] += idle - alone;
    }
    e->lost[BENCH_LIMIT_ALONE] += s->before;
    e->lost[BENCH_LIMIT_BARRIERS] += threads > 1 ? node->barrier + node->barrier_thread * threads : 0;
    e->lost[BENCH_LIMIT_BANDWIDTH] += moving > end ? moving - end : 0;
}

struct bench_expected bench_expect(const struct bench_schedule *s, const struct bench_node *node)
{
    struct bench_expected e = {.lost[BENCH_LIMIT_ALONE] = s->after};
    for (int i = 0; i < s->count; i++)
        add_step(&e, &s->steps[i], node, i == 0);
    e.ms = e.ideal;
    for (int i = 0; i < BENCH_LIMITS; i++) {
        e.ms += e.lost[i];
        e.most = e.lost[i] > e.lost[e.most] ? (enum bench_limit)i : e.most;
    }
    return e;
}
