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

// For each round the mean over the scenes, so that differences between scenes do not count as spread.
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

// Whether the ladder may have a setting: not one whose options change only how a frame is run; not a plain copy; not
// the published algorithms.
static int may_be_chosen(const struct trade_setting *s)
{
    static const char *const never[] = {"--threads", "--isa",      "--max-radius", "--deterministic",
                                        "--no-skip", "--faithful", "--blend",      "--engine chapter"};
    for (size_t i = 0; i < sizeof never / sizeof *never; i++)
        if (strstr(s->options, never[i]))
            return 0;
    return 1;
}

double trade_gain_db(const struct trade_result *better, const struct trade_result *than)
{
    return 20 * log10(than->error / better->error);
}

static double error_on(const struct trade_result *r, int scene)
{
    return r->at[scene].distance[BENCH_WHOLE].display_rmse;
}

// What takes less than this times another's milliseconds is nearly as fast.
static const double SLOWER = 1.2;

// Whether a setting may be the next step: it takes a fifth longer, gains TRADE_STEP_DB overall, and loses at most 0.1 dB
// on any scene. What is nearly as fast stands in the place of what errs more.
static int may_follow(const struct trade *t, const struct trade_result *better, const struct trade_result *than)
{
    static const double same = 1.0116;  // 0.1 dB
    for (int s = 0; s < t->scenes; s++) {
        const int choosable = than->farthest >= t->largest[s] || better->farthest < t->largest[s];
        if (choosable && error_on(better, s) > same * error_on(than, s))
            return 0;
    }
    return trade_gain_db(better, than) >= TRADE_STEP_DB && better->ms.median > SLOWER * than->ms.median;
}

// Whether another setting with fewer words errs equally and takes equally long, as far as can be told.
static int is_wordy(const struct trade *t, const struct trade_result *r)
{
    static const double same = 1.002;  // 0.02 dB
    for (int i = 0; i < t->results; i++) {
        const struct trade_result *o = &t->result[i];
        int differs = o->farthest != r->farthest || !trade_overlap(o->ms, r->ms) || !may_be_chosen(o->setting) ||
                      strlen(o->setting->options) >= strlen(r->setting->options);
        for (int s = 0; s < t->scenes && !differs; s++)
            differs = error_on(o, s) > same * error_on(r, s);
        if (!differs)
            return 1;
    }
    return 0;
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

static int is_limited(const struct trade_result *r)
{
    return isfinite(r->farthest);
}

// Paths up the ladder: for each setting the length of the longest path to the most accurate one, 0 for none, and the
// next setting on it.
struct ways {
    const struct trade *t;
    int order[TRADE_SETTINGS];  // by time
    int candidate[TRADE_SETTINGS];
    int length[TRADE_SETTINGS], above[TRADE_SETTINGS];
};

// Whether a setting is an engine with its defaults.
static int is_plain(const struct trade_result *r)
{
    return !strstr(r->setting->options + 1, " --");
}

// Find the settings that may be chosen. Returns the most accurate one of those that reach any radius, or -1.
static int find_candidates(struct ways *w)
{
    int last = -1;
    for (int i = 0; i < w->t->results; i++) {
        const struct trade_result *r = &w->t->result[i];
        w->candidate[i] = may_be_chosen(r->setting) && !is_wordy(w->t, r) && (r->rank != TRADE_BEATEN || is_plain(r));
        if (w->candidate[i] && !is_limited(r) && (last < 0 || r->error < w->t->result[last].error))
            last = i;
    }
    return last;
}

// Find the longest path from each setting, among those with limited reach, or those without. Paths through engines with
// their defaults come first: most users get these, and odd options that win a tenth of a dB on one scene must not
// exclude them.
static void find_ways(struct ways *w, int limited)
{
    const struct trade *t = w->t;
    for (int k = t->results - 1; k >= 0; k--) {
        const int i = w->order[k];
        if (!w->candidate[i] || is_limited(&t->result[i]) != limited)
            continue;
        const int by = !limited && is_plain(&t->result[i]) ? TRADE_SETTINGS : 1;
        for (int m = k + 1; m < t->results; m++) {
            const int j = w->order[m];
            if (w->length[j] > 0 && w->length[j] + by > w->length[i] && may_follow(t, &t->result[j], &t->result[i])) {
                w->length[i] = w->length[j] + by;
                w->above[i] = j;
            }
        }
    }
}

// The cheapest setting that has a path, or the one among those nearly as cheap with as long a path that errs least; as many
// steps lie above it as TRADE_STEP_DB leaves room for. plain: only the cheapest of engines with their defaults.
static int cheapest(const struct ways *w, int plain)
{
    int first = -1, best = -1;
    for (int k = 0; k < w->t->results; k++) {
        const int i = w->order[k];
        const struct trade_result *r = &w->t->result[i];
        if (w->length[i] <= 0 || (plain && (!is_plain(r) || first >= 0)))
            continue;
        if (first < 0)
            first = best = i;
        else if (r->ms.median <= SLOWER * w->t->result[first].ms.median && w->length[i] == w->length[first] &&
                 r->error < w->t->result[best].error)
            best = i;
    }
    return best;
}

void trade_ladder(struct trade *t)
{
    struct ways w = {.t = t};
    trade_order(t, w.order);
    for (int i = 0; i < t->results; i++)
        t->result[i].step = 0;
    const int last = find_candidates(&w);
    if (last < 0)
        return;
    w.length[last] = 1;
    w.above[last] = -1;
    find_ways(&w, 0);
    // For a lens, the first step is an engine with its defaults, because its look was tuned with care. Other settings
    // that reach any radius have no path from those that do not.
    int first = cheapest(&w, 1);
    if (first < 0)
        first = cheapest(&w, 0);
    for (int i = 0; i < t->results; i++)
        w.length[i] = i == first ? w.length[i] : 0;
    find_ways(&w, 1);
    for (int i = cheapest(&w, 0), step = 1; i >= 0; i = w.above[i])
        t->result[i].step = step++;
}

int trade_qualities(const struct trade *t, int place[TRADE_QUALITIES])
{
    int order[TRADE_SETTINGS], last = -1;
    static const double within_db[TRADE_QUALITIES] = {INFINITY, 1.5, 0, 0};
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
            if (r->step > 0 && (q > 0 || r->farthest == INFINITY) &&
                trade_gain_db(&t->result[last], r) <= within_db[q]) {
                place[q] = order[k];
                break;
            }
        }
    }
    return 0;
}
