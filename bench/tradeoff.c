// SPDX-License-Identifier: BSD-3-Clause
// `hyperfocal-bench tradeoff`: the time of each setting on this machine, and its distance from the truth.
//
// Distances are measured first and once, because pictures do not depend on the time of day. Times are measured in
// rounds over all settings, so that other work on the machine affects all alike. Each measurement goes to the cache at
// once.
#include "commands.h"
#include "machine.h"
#include "page.h"
#include "peels.h"
#include "subject.h"
#include "tools/common/machine.h"
#include "tradeoff.h"
#include "tradeoff_run.h"
#include "write.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROUNDS = 7, QUICK_ROUNDS = 3, SLOW_ROUNDS = 3 };
static const double slow_ms = 100;  // frames that take longer are measured only SLOW_ROUNDS times

static void progress(const char *what, int i, int n, const char *name)
{
    if (isatty(STDERR_FILENO))
        fprintf(stderr, "\r\033[K%s %d/%d  %s%s", what, i + 1, n, name, i + 1 == n ? "\n" : "");
    else if ((i + 1) % 20 == 0 || i + 1 == n)
        fprintf(stderr, "%s %d/%d\n", what, i + 1, n);
}

static int choose_settings(struct trade *t, struct trade_setting *own)
{
    const struct bench_args *a = t->args;
    t->result = calloc(TRADE_SETTINGS, sizeof *t->result);
    if (!t->result)
        return -1;
    if (a->setting) {
        *own = (struct trade_setting){"given", a->setting, a->setting, 1};
        t->result[t->results++].setting = own;
        return 0;
    }
    for (int i = 0; i < trade_setting_count; i++)
        if (!a->quick || trade_settings[i].quick)
            t->result[t->results++].setting = &trade_settings[i];
    return 0;
}

static int open_cache(struct trade_cache **cache, const struct trade *t, struct tool_error *error)
{
    char path[4096], key[256];
    const char *home = getenv("HOME"), *xdg = getenv("XDG_CACHE_HOME");
    if (t->args->cache && !strcmp(t->args->cache, "none"))
        return 0;
    if (t->args->cache)
        snprintf(path, sizeof path, "%s", t->args->cache);
    else if (xdg && *xdg)
        snprintf(path, sizeof path, "%s/hyperfocal/tradeoff.txt", xdg);
    else if (home && *home)
        snprintf(path, sizeof path, "%s/.cache/hyperfocal/tradeoff.txt", home);
    else
        return 0;
    trade_cache_key(key, sizeof key, t->cpu, t->threads);
    return trade_cache_open(cache, path, key, error);
}

static int measure_distances(struct trade_run *run, struct trade_cache *cache, struct tool_error *error)
{
    struct trade *t = run->t;
    for (int i = 0; i < t->results; i++) {
        struct trade_result *r = &t->result[i];
        int missing = 0;
        for (int s = 0; s < t->scenes; s++)
            missing |= !r->at[s].measured || (!t->args->quick && isnan(r->at[s].flicker));
        if (missing && trade_run_distances(run, i, !t->args->quick, error))
            return -1;
        for (int s = 0; s < t->scenes && missing; s++)
            trade_cache_point(cache, t, r, s);
        if (!r->axes_measured) {
            if (trade_run_axes(run, i, error))
                return -1;
            trade_cache_axes(cache, r);
        }
        progress("distances", i, t->results, r->setting->name);
    }
    return 0;
}

static int wants_sample(const struct trade_time *time, int round, int rounds)
{
    if (time->n > 0 && time->sample[0] > slow_ms && rounds > SLOW_ROUNDS)
        rounds = SLOW_ROUNDS;
    return time->n <= round && time->n < rounds;
}

static int measure_times(struct trade_run *run, struct trade_cache *cache, struct tool_error *error)
{
    struct trade *t = run->t;
    const int rounds = t->args->quick ? QUICK_ROUNDS : ROUNDS;
    for (int round = 0; round < rounds; round++)
        for (int i = 0; i < t->results; i++) {
            struct trade_result *r = &t->result[i];
            for (int s = -1; s < t->scenes; s++) {
                if (!wants_sample(s < 0 ? &r->both : &r->at[s].time, round, rounds))
                    continue;
                if (trade_run_time(run, i, s, error))
                    return -1;
                trade_cache_time(cache, t, r, s);
            }
            progress("times", round * t->results + i, rounds * t->results, r->setting->name);
        }
    return 0;
}

// Write a file of one of the other kinds.
static int write_file(const char *path, const char *option, const struct trade *t,
                      void (*write)(FILE *out, const struct trade *t), struct tool_error *error)
{
    if (!path)
        return 0;
    FILE *f = fopen(path, "w");
    if (!f)
        return tool_fail(error, -1, "%s: cannot write %s", option, path);
    write(f, t);
    const int failed = ferror(f);
    if (fclose(f) || failed)
        return tool_fail(error, -1, "%s: cannot write %s", option, path);
    return 0;
}

// The README quotes the typed words, without those that only concern this run.
static int readme(const struct trade *t, struct tool_error *error)
{
    char command[512] = "hyperfocal-bench tradeoff";
    const struct bench_args *a = t->args;
    for (int i = 0; i < a->word_count; i++) {
        const size_t n = strlen(command);
        const char *word = a->words[i];
        if (!strncmp(word, "--html", 6) || !strncmp(word, "--cache", 7) || !strncmp(word, "--csv", 5) ||
            !strncmp(word, "--json", 6))
            i += !strchr(word, '=');
        else
            snprintf(command + n, sizeof command - n, strchr(word, ' ') ? " \"%s\"" : " %s", word);
    }
    return trade_readme(a->readme, t, command, error);
}

// With one, two and three surfaces known, for the page: the standard quality and the best.
static int measure_peels(struct trade *t, struct bench_peels peels[TRADE_PEELS], struct tool_error *error)
{
    static const enum hf_layers_quality qualities[TRADE_PEELS] = {HF_LAYERS_STANDARD, HF_LAYERS_BEST};
    static struct bench_args args[TRADE_PEELS];
    for (int i = 0; i < TRADE_PEELS && t->args->html; i++) {
        args[i] = *t->args;
        args[i].params.engine = HF_ENGINE_LAYERS;
        args[i].params.layers.quality = qualities[i];
        if (bench_peels_measure(&peels[i], &args[i], error))
            return -1;
        t->peels[i] = peels[i].count ? &peels[i] : NULL;
    }
    return 0;
}

static int report(struct trade_run *run, struct tool_error *error)
{
    const struct trade *t = run->t;
    const struct bench_args *a = t->args;
    if (write_file(a->csv, "--csv", t, trade_csv, error))
        return -1;
    if (write_file(a->ladder, "--ladder", t, trade_ladder_table, error))
        return -1;
    if (a->readme && readme(t, error))
        return -1;
    if (a->html && bench_page_write(run, a->html, error))
        return -1;
    if (a->png && bench_page_png(t, a->png, error))
        return -1;
    return bench_write_report(a, trade_table, trade_json, t, error);
}

int bench_tradeoff(struct bench_args *args, struct tool_error *error)
{
    struct trade t = {.args = args};
    struct trade_setting own;
    struct trade_run run = {0};
    struct trade_cache *cache = NULL;
    static struct bench_peels peels[TRADE_PEELS];
    tool_cpu(t.cpu, sizeof t.cpu);
    bench_machine_date(t.date, sizeof t.date);
    t.commit = bench_machine_commit();
    int err = choose_settings(&t, &own) ? tool_fail(error, -1, "there is not enough memory") : 0;
    if (!err && args->ladder && args->setting)
        err = tool_fail(error, -1, "--ladder %s needs all settings, leave --setting away", args->ladder);
    if (!err && args->readme)
        err = trade_readme_check(args->readme, error);
    if (!err && args->png)
        err = bench_page_png_check(error);
    if (!err)
        err = trade_run_open(&run, &t, error);
    if (!err)
        err = trade_run_parse(&run, error);
    if (!err)
        err = open_cache(&cache, &t, error);
    if (!err) {
        const int known = trade_cache_load(cache, &t);
        if (known)
            fprintf(stderr, "%d measurements of this build and machine are taken from the cache\n", known);
        err = measure_distances(&run, cache, error);
    }
    if (!err)
        err = measure_times(&run, cache, error);
    if (!err)
        err = measure_peels(&t, peels, error);
    if (!err) {
        trade_rank(&t);
        trade_ladder(&t);
        err = report(&run, error);
    }
    trade_cache_close(cache);
    trade_run_close(&run);
    free(t.result);
    return err ? -1 : 0;
}
