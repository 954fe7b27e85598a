// SPDX-License-Identifier: BSD-3-Clause
#include "statistics.h"
#include "tradeoff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct trade_interval trade_interval(const double *samples, int n)
{
    double sorted[TRADE_ROUNDS];
    if (n < 1)
        return (struct trade_interval){NAN, NAN, NAN};
    memcpy(sorted, samples, (size_t)n * sizeof *sorted);
    bench_median(sorted, n);
    return (struct trade_interval){bench_quantile(sorted, n, 0.25), bench_quantile(sorted, n, 0.5),
                                   bench_quantile(sorted, n, 0.75)};
}

int trade_overlap(struct trade_interval a, struct trade_interval b)
{
    return a.low <= b.high && b.low <= a.high;
}

// Of each round the mean over the scenes, so that what the scenes cost differently is no spread.
static struct trade_interval mean_time(const struct trade *t, const struct trade_result *r)
{
    double mean[TRADE_ROUNDS];
    int n = TRADE_ROUNDS;
    for (int s = 0; s < t->scenes; s++)
        n = r->at[s].time.n < n ? r->at[s].time.n : n;
    for (int i = 0; i < n; i++) {
        mean[i] = 0;
        for (int s = 0; s < t->scenes; s++)
            mean[i] += r->at[s].time.sample[i] / t->scenes;
    }
    return trade_interval(mean, t->scenes ? n : 0);
}

static void sum_up(const struct trade *t, struct trade_result *r)
{
    double logs = 0;
    r->worst = 0;
    for (int s = 0; s < t->scenes; s++) {
        const double e = r->at[s].distance[BENCH_WHOLE].display_rmse;
        logs += log(e);
        r->worst = fmax(r->worst, e);
    }
    r->error = exp(logs / t->scenes);
    r->ms = mean_time(t, r);
    r->both_ms = trade_interval(r->both.sample, r->both.n);
}

void trade_rank(struct trade *t)
{
    for (int i = 0; i < t->results; i++)
        sum_up(t, &t->result[i]);
    for (int i = 0; i < t->results; i++) {
        struct trade_result *r = &t->result[i];
        r->rank = TRADE_FRONT;
        for (int j = 0; j < t->results && r->rank != TRADE_BEATEN; j++) {
            const struct trade_result *o = &t->result[j];
            const int same = o->error == r->error && o->ms.median == r->ms.median;
            if (j == i || o->error > r->error || (same && j > i))
                continue;
            if (o->ms.high < r->ms.low)
                r->rank = TRADE_BEATEN;
            else if (o->ms.median <= r->ms.median)
                r->rank = TRADE_TIED;
        }
    }
}

// Not for options that change how a frame is run and not what it is; nor for a copy.
static int may_be_chosen(const struct trade_setting *s)
{
    return !strstr(s->options, "--threads") && !strstr(s->options, "--isa") && !strstr(s->options, "--max-radius");
}

static int is_no_worse(const struct trade *t, const struct trade_result *better, const struct trade_result *than)
{
    for (int s = 0; s < t->scenes; s++)
        if (better->at[s].distance[BENCH_WHOLE].display_rmse > than->at[s].distance[BENCH_WHOLE].display_rmse)
            return 0;
    return better->error < than->error && better->ms.median > than->ms.median;
}

void trade_order(const struct trade *t, int order[])
{
    for (int i = 0; i < t->results; i++) {
        int j = i;
        for (; j > 0 && t->result[order[j - 1]].ms.median > t->result[i].ms.median; j--)
            order[j] = order[j - 1];
        order[j] = i;
    }
}

void trade_ladder(struct trade *t)
{
    // Backwards from the most accurate: the longest way from there down to each setting.
    int order[TRADE_SETTINGS], length[TRADE_SETTINGS] = {0}, above[TRADE_SETTINGS], last = -1, first = -1;
    trade_order(t, order);
    for (int i = 0; i < t->results; i++) {
        t->result[i].step = 0;
        if (may_be_chosen(t->result[i].setting) && (last < 0 || t->result[i].error < t->result[last].error))
            last = i;
    }
    if (last < 0)
        return;
    length[last] = 1;
    above[last] = -1;
    for (int k = t->results - 1; k >= 0; k--) {
        const int i = order[k];
        if (i == last || !may_be_chosen(t->result[i].setting) || t->result[i].rank == TRADE_BEATEN)
            continue;
        for (int m = k + 1; m < t->results; m++) {
            const int j = order[m];
            if (length[j] > 0 && length[j] >= length[i] && is_no_worse(t, &t->result[j], &t->result[i])) {
                length[i] = length[j] + 1;
                above[i] = j;
            }
        }
    }
    // The cheapest setting from which there is a way; what lies between is as fine as can be.
    for (int k = t->results - 1; k >= 0; k--)
        if (length[order[k]] > 0)
            first = order[k];
    for (int i = first, step = 1; i >= 0; i = above[i])
        t->result[i].step = step++;
}

int trade_qualities(const struct trade *t, int place[TRADE_QUALITIES])
{
    int order[TRADE_SETTINGS], last = -1;
    static const double within_db[TRADE_QUALITIES] = {INFINITY, 1, 0.25, 0};
    trade_order(t, order);
    for (int i = 0; i < t->results; i++)
        if (t->result[i].step > 0 && (last < 0 || t->result[i].step > t->result[last].step))
            last = i;
    if (last < 0)
        return -1;
    for (int q = 0; q < TRADE_QUALITIES; q++) {
        place[q] = last;
        for (int k = 0; k < t->results; k++) {
            const struct trade_result *r = &t->result[order[k]];
            if (r->step > 0 && 20 * log10(r->error / t->result[last].error) <= within_db[q]) {
                place[q] = order[k];
                break;
            }
        }
    }
    return 0;
}
