// SPDX-License-Identifier: BSD-3-Clause
// How hyperfocal-bench tradeoff evaluates its measurements: intervals, the front, the ladder, and the cache.
#include "support/check.h"
#include "tradeoff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST = 8, SCENES = 2, SAMPLES = 5 };

static struct trade_setting settings[MOST];
static struct trade_result results[MOST];

static struct trade empty(int n)
{
    memset(results, 0, sizeof results);
    struct trade t = {.scenes = SCENES, .results = n, .result = results, .largest = {10, 20}};
    strcpy(t.scene[0].text, "one");
    strcpy(t.scene[1].text, "two");
    return t;
}

// A setting that takes about ms, its samples spread by that share on both sides, and errs by a and b.
static void put(int i, const char *options, double ms, double spread, double a, double b)
{
    settings[i] = (struct trade_setting){"knob", options, options, 1};
    results[i].setting = &settings[i];
    results[i].farthest = INFINITY;
    const double error[SCENES] = {a, b};
    for (int s = 0; s < SCENES; s++) {
        struct trade_point *p = &results[i].at[s];
        p->measured = 1;
        p->distance[BENCH_WHOLE] = (struct bench_distance){.share = 1, .display_rmse = error[s]};
        p->time.n = SAMPLES;
        for (int k = 0; k < SAMPLES; k++)
            p->time.sample[k] = ms * (1 + spread * (k - SAMPLES / 2) / (SAMPLES / 2));
    }
}

static void test_interval(void)
{
    const double samples[] = {9, 1, 5, 3, 7};
    const struct trade_interval i = trade_interval(samples, 5), one = trade_interval(samples, 1);
    CHECK(i.low == 3 && i.median == 5 && i.high == 7);
    CHECK(one.low == 9 && one.median == 9 && one.high == 9);
    CHECK(isnan(trade_interval(samples, 0).median));
    const double even[] = {4, 1, 2, 3};
    CHECK(trade_interval(even, 4).median == 2.5 && trade_interval(even, 4).low == 1.75);
    CHECK(trade_overlap((struct trade_interval){1, 2, 3}, (struct trade_interval){3, 4, 5}));
    CHECK(!trade_overlap((struct trade_interval){1, 2, 3}, (struct trade_interval){3.1, 4, 5}));
    CHECK(!trade_overlap((struct trade_interval){4, 5, 6}, (struct trade_interval){1, 2, 3}));
}

static void test_rank(void)
{
    struct trade t = empty(6);
    put(0, "cheap", 1, 0.01, 0.1, 0.1);
    put(1, "good", 10, 0.01, 0.01, 0.04);
    put(2, "worse and slower", 20, 0.01, 0.05, 0.05);
    put(3, "worse, slower by chance", 10.1, 0.1, 0.02, 0.03);  // reaches from 9.6 to 10.6
    put(4, "same as good", 10, 0.01, 0.01, 0.04);
    put(5, "best", 100, 0.01, 0.009, 0.04);
    trade_rank(&t);
    CHECK(fabs(results[1].error - 0.02) < 1e-12 && results[1].worst == 0.04);
    CHECK(fabs(results[1].ms.median - 10) < 1e-12);
    CHECK_INT(results[0].rank, TRADE_FRONT);
    CHECK_INT(results[1].rank, TRADE_FRONT);
    CHECK_INT(results[2].rank, TRADE_BEATEN);
    CHECK_INT(results[3].rank, TRADE_TIED);
    CHECK_INT(results[4].rank, TRADE_TIED);
    CHECK_INT(results[5].rank, TRADE_FRONT);
    int order[TRADE_SETTINGS];
    trade_order(&t, order);
    const int want[] = {0, 1, 4, 3, 2, 5};
    for (int i = 0; i < 6; i++)
        CHECK_INT(order[i], want[i]);
}

// The ladder of the settings put; want: their steps.
static void expect_steps(struct trade *t, const int *want)
{
    trade_rank(t);
    trade_ladder(t);
    for (int i = 0; i < t->results; i++)
        CHECK_MSG(results[i].step == want[i], "%s: step %d, expected %d", settings[i].options, results[i].step,
                  want[i]);
}

static void test_ladder(void)
{
    struct trade t = empty(7);
    put(0, "a", 1, 0.01, 0.1, 0.1);
    put(1, "b", 2, 0.01, 0.05, 0.09);
    put(2, "c", 4, 0.01, 0.04, 0.095);  // better than b on the mean, worse on scene two: cannot follow it
    put(3, "d", 8, 0.01, 0.03, 0.09);
    put(4, "e", 16, 0.01, 0.029, 0.088);
    put(5, "e --threads 1", 30, 0.01, 0.025, 0.088);
    put(6, "worse", 20, 0.01, 0.2, 0.2);
    expect_steps(&t, (const int[]){1, 2, 0, 3, 4, 0, 0});
    // Means in dB below the last: a 5.9, b 2.5, d 0.2, e 0.
    int place[TRADE_QUALITIES];
    CHECK_INT(trade_qualities(&t, place), 0);
    CHECK_INT(place[0], 0);
    CHECK_INT(place[1], 3);
    CHECK_INT(place[2], 4);
    CHECK_INT(place[3], 4);

    // A cheap setting from which no way leads up is not the first step.
    put(0, "a", 1, 0.01, 0.02, 0.3);
    put(1, "b", 2, 0.01, 0.05, 0.09);
    trade_rank(&t);
    trade_ladder(&t);
    CHECK_INT(results[0].step, 0);
    CHECK_INT(results[1].step, 1);
    CHECK_INT(results[4].step, 3);

    // Odd knobs that are better on one scene do not shut out an engine as it is.
    t = empty(5);
    put(0, "--engine a", 1, 0.01, 0.1, 0.1);
    put(1, "--engine b --x 1", 2, 0.01, 0.09, 0.04);
    put(2, "--engine b --x 2", 4, 0.01, 0.08, 0.039);
    put(3, "--engine b", 8, 0.01, 0.03, 0.05);
    put(4, "--engine b --x 3", 16, 0.01, 0.02, 0.03);
    expect_steps(&t, (const int[]){1, 0, 0, 2, 3});
}

// An error that is so many dB smaller than 0.1.
static double below(double db)
{
    return 0.1 * pow(10, -db / 20);
}

// A step gains at least 0.2 dB over the one before: of settings that lie closer together, one is kept.
static void test_steps_differ(void)
{
    struct trade t = empty(6);
    int place[TRADE_QUALITIES];
    put(0, "--engine a", 1, 0.01, 0.1, 0.1);
    put(1, "--engine b --x 1", 2, 0.01, below(3.03), below(3.03));
    put(2, "--engine b --x 2", 3, 0.01, below(3.06), below(3.06));
    put(3, "--engine c", 4, 0.01, below(3.09), below(3.09));
    put(4, "--engine b --x 3", 5, 0.01, below(3.12), below(3.12));
    put(5, "--engine b --x 4", 20, 0.01, below(3.5), below(3.5));
    // Of four within 0.1 dB, the engine with default options is chosen, even before cheaper ones.
    expect_steps(&t, (const int[]){1, 0, 0, 2, 0, 3});
    // No step lies between the second and the last, so `high` is the last.
    CHECK_INT(trade_qualities(&t, place), 0);
    CHECK(place[0] == 0 && place[1] == 3 && place[2] == 5 && place[3] == 5);
    // If none has default options, the cheapest is chosen.
    put(3, "--engine b --x 5", 4, 0.01, below(3.09), below(3.09));
    expect_steps(&t, (const int[]){1, 2, 0, 0, 0, 3});
    // The most accurate setting, if better by less than a step, replaces the one before it.
    t = empty(3);
    put(0, "a", 1, 0.01, 0.1, 0.1);
    put(1, "b", 2, 0.01, below(1), below(1));
    put(2, "c", 4, 0.01, below(1.19), below(1.19));
    expect_steps(&t, (const int[]){1, 0, 2});
    put(2, "c", 4, 0.01, below(1.21), below(1.21));
    expect_steps(&t, (const int[]){1, 2, 3});
    CHECK(fabs(trade_gain_db(&results[2], &results[1]) - 0.21) < 1e-9);
}

// A setting that does not reach the radii of a scene is never chosen there.
static void test_reach(void)
{
    struct trade t = empty(6);
    put(0, "soft", 1, 0.01, 0.1, 0.05);
    put(1, "softer", 2, 0.01, 0.08, 0.05);
    put(2, "first", 4, 0.01, 0.05, 0.06);  // worse than those before on scene two, whose radii they do not reach
    put(3, "way", 5, 0.01, 0.045, 0.06);
    put(4, "first -x", 4.01, 0.01, 0.05, 0.06);  // the same in more words
    put(5, "last", 8, 0.01, 0.03, 0.03);
    results[0].farthest = results[1].farthest = 15;
    expect_steps(&t, (const int[]){1, 2, 3, 4, 0, 5});
    // On scene one they do reach: there the first must not be worse than what comes before it.
    put(2, "first", 4, 0.01, 0.09, 0.03);
    trade_rank(&t);
    trade_ladder(&t);
    CHECK_INT(results[1].step, 0);
    CHECK_INT(results[2].step, 2);
    CHECK_INT(results[5].step, 3);
    // Of two ladders among settings that reach, the one with the cheapest start is chosen, not the longest.
    t = empty(5);
    put(0, "cheap", 1, 0.01, 0.1, 0.1);
    put(1, "other", 2, 0.01, 0.11, 0.08);
    put(2, "another", 3, 0.01, 0.105, 0.07);
    put(3, "last", 8, 0.01, 0.03, 0.03);
    put(4, "soft", 0.5, 0.01, 0.12, 0.12);
    results[4].farthest = 15;
    expect_steps(&t, (const int[]){2, 0, 0, 3, 1});
}

static void test_cache(void)
{
    char path[] = "/tmp/hyperfocal-test-XXXXXX";
    struct tool_error error;
    struct trade_cache *cache;
    const int fd = mkstemp(path);
    CHECK(fd >= 0);
    close(fd);
    struct trade t = empty(2);
    put(0, "--engine a", 3, 0.2, 0.125, 0.25);
    put(1, "--engine b", 5, 0.2, 0.1, 0.3);
    results[0].at[1].flicker = NAN;
    results[0].at[0].distance[BENCH_FAR] = (struct bench_distance){.share = 0.5, .psnr = INFINITY, .ssim = 1};
    results[0].rounding = 1e-9;
    results[0].faithfulness = NAN;
    CHECK_INT(trade_cache_open(&cache, path, "key", &error), 0);
    trade_cache_point(cache, &t, &results[0], 0);
    trade_cache_point(cache, &t, &results[0], 1);
    trade_cache_axes(cache, &results[0]);
    trade_cache_time(cache, &t, &results[0], 1);
    results[0].both.n = 1;
    results[0].both.sample[0] = 7;
    results[0].both.pass[0][2] = 0.5;
    trade_cache_time(cache, &t, &results[0], -1);
    trade_cache_close(cache);
    FILE *f = fopen(path, "a");
    fputs("key\tT\t--engine b\tone\t1.5 0 0 0", f);  // cut off
    fclose(f);

    t = empty(2);
    results[0].setting = &settings[0];
    results[1].setting = &settings[1];
    CHECK_INT(trade_cache_open(&cache, path, "another key", &error), 0);
    CHECK_INT(trade_cache_load(cache, &t), 0);
    trade_cache_close(cache);
    CHECK_INT(trade_cache_open(&cache, path, "key", &error), 0);
    CHECK_INT(trade_cache_load(cache, &t), 5);
    trade_cache_close(cache);
    CHECK(results[0].at[0].measured && results[0].at[0].distance[BENCH_WHOLE].display_rmse == 0.125);
    CHECK(results[0].at[1].distance[BENCH_WHOLE].display_rmse == 0.25 && isnan(results[0].at[1].flicker));
    CHECK(isinf(results[0].at[0].distance[BENCH_FAR].psnr) && results[0].at[0].distance[BENCH_FAR].share == 0.5);
    CHECK(results[0].axes_measured && results[0].rounding == 1e-9 && isnan(results[0].faithfulness));
    CHECK(results[0].at[0].time.n == 0 && results[0].at[1].time.n == 1);
    CHECK(fabs(results[0].at[1].time.sample[0] - 3.6) < 1e-9);  // the newest of the five
    CHECK(results[0].both.n == 1 && results[0].both.sample[0] == 7 && results[0].both.pass[0][2] == 0.5);
    CHECK(!results[1].at[0].measured && results[1].at[0].time.n == 0 && !results[1].axes_measured);
    unlink(path);

    CHECK(trade_cache_open(&cache, "/proc/no/such/file", "key", &error) < 0);
    trade_cache_close(cache);
}

int main(void)
{
    test_interval();
    test_rank();
    test_ladder();
    test_steps_differ();
    test_reach();
    test_cache();
    return check_report();
}
