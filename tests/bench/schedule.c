// SPDX-License-Identifier: BSD-3-Clause
// The expected time of frames of made-up tasks, whose best schedule is known.
#include "schedule.h"
#include "support/check.h"

#include <float.h>
#include <math.h>

enum { TASKS = 1000 };

// Sums of at most TASKS whole numbers and halves are exact. Divided by a number of threads they round twice, relative to
// values below 1e4.
static int near(double a, double b)
{
    return fabs(a - b) <= 4 * DBL_EPSILON * 1e4;
}

static struct bench_expected expect(struct bench_step *steps, int count, int threads)
{
    const struct bench_schedule s = {count, steps, 0};
    return bench_expect(&s, &(struct bench_node){.threads = threads});
}

// n equal tasks on k threads take as many rounds as it needs.
static void test_equal(void)
{
    double ms[TASKS];
    for (int i = 0; i < TASKS; i++)
        ms[i] = 0.5;
    for (int n = 1; n <= TASKS; n += 37)
        for (int k = 1; k <= 128; k *= 2) {
            struct bench_step steps[] = {{n, ms, 0, 0}, {n, ms, 0, 0}};
            const struct bench_expected e = expect(steps, 2, k);
            const double one = 0.5 * ((n + k - 1) / k), idle = one - 0.5 * n / k;
            CHECK_MSG(near(e.ms, 2 * one), "%d tasks on %d threads: %g", n, k, e.ms);
            CHECK(near(e.ideal, 1.0 * n / k));
            CHECK(near(e.lost[BENCH_LIMIT_FIRST], idle));
            CHECK(near(e.lost[BENCH_LIMIT_LONGEST] + e.lost[BENCH_LIMIT_UNEVEN], idle));
            // One task a thread or less: each is the longest.
            CHECK(n > k || near(e.lost[BENCH_LIMIT_UNEVEN], 0));
        }
}

// The order decides: a long task at the end waits for nobody, at the start it is hidden.
static void test_order(void)
{
    double last[] = {1, 1, 1, 1, 4}, first[] = {4, 1, 1, 1, 1};
    struct bench_step empty = {0, NULL, 0, 0};
    struct bench_step late[] = {empty, {5, last, 0, 0}}, early[] = {empty, {5, first, 0, 0}};
    CHECK(near(expect(late, 2, 2).ms, 6));
    CHECK(near(expect(early, 2, 2).ms, 4));
    CHECK(near(expect(late, 2, 1).ms, 8));
    // With three threads the longest task takes 4 of 8 / 3 milliseconds: the rest is idle time that it causes or not.
    const struct bench_expected e = expect(late, 2, 3);
    CHECK(near(e.ms, 5));
    CHECK(near(e.lost[BENCH_LIMIT_LONGEST], 4 - 8.0 / 3));
    CHECK(near(e.lost[BENCH_LIMIT_UNEVEN], 1));
    CHECK_INT(e.most, BENCH_LIMIT_LONGEST);
}

// Each step ends before the next begins, with work of one thread between.
static void test_barriers(void)
{
    double ms[] = {2, 2, 2, 2};
    struct bench_step steps[] = {{4, ms, 0.5, 0}, {4, ms, 0.25, 0}};
    const struct bench_schedule s = {2, steps, 1};
    struct bench_node node = {.threads = 4, .barrier = 3, .barrier_thread = 0.5};
    struct bench_expected e = bench_expect(&s, &node);
    CHECK(near(e.ms, 2 + 2 + 0.75 + 1 + 2 * (3 + 4 * 0.5)));
    CHECK(near(e.lost[BENCH_LIMIT_ALONE], 1.75));
    CHECK_INT(e.most, BENCH_LIMIT_BARRIERS);
    node.threads = 1;
    e = bench_expect(&s, &node);
    CHECK(near(e.ms, 16 + 1.75));
    CHECK(near(e.lost[BENCH_LIMIT_BARRIERS], 0));
}

// A step lasts at least until its bytes are moved; more sockets move more.
static void test_bandwidth(void)
{
    double ms[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    struct bench_step step = {8, ms, 0, 600};
    const struct bench_schedule s = {1, &step, 0};
    struct bench_node node = {.threads = 4, .socket = 4, .bandwidth = 100};
    struct bench_expected e = bench_expect(&s, &node);
    CHECK(near(e.ms, 6));
    CHECK(near(e.lost[BENCH_LIMIT_BANDWIDTH], 4));
    CHECK_INT(e.most, BENCH_LIMIT_BANDWIDTH);
    node.threads = 8;
    CHECK(near(bench_expect(&s, &node).ms, 3));
    node.threads = 1;
    CHECK(near(bench_expect(&s, &node).ms, 8));
}

int main(void)
{
    test_equal();
    test_order();
    test_barriers();
    test_bandwidth();
    return check_report();
}
