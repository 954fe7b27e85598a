// SPDX-License-Identifier: BSD-3-Clause
// A text file with one measurement per line, appended as soon as it is made, so that an interrupted run can go on.
// Fields are separated by tabs: key, kind, options, scene, numbers. Lines that do not parse are skipped: the last one
// may be incomplete.
#include "tradeoff.h"

#include <dlfcn.h>
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { KEY = 128, DISTANCES = 8 };

struct trade_cache {
    FILE *file;  // for appending
    char *path;
    char key[KEY];
};

static uint64_t hash_bytes(uint64_t hash, const void *data, size_t size)
{
    for (const unsigned char *p = data; size; size--)
        hash = (hash ^ *p++) * UINT64_C(0x100000001b3);
    return hash;
}

static uint64_t hash_file(uint64_t hash, const char *path)
{
    char buf[65536];
    FILE *f = fopen(path, "rb");
    for (size_t n; f && (n = fread(buf, 1, sizeof buf, f)) > 0;)
        hash = hash_bytes(hash, buf, n);
    if (f)
        fclose(f);
    return hash;
}

void trade_cache_key(char *key, size_t size, const char *cpu, int threads)
{
    Dl_info library;
    uint64_t hash = hash_file(UINT64_C(0xcbf29ce484222325), "/proc/self/exe");
    if (dladdr((const void *)hf_version, &library) && library.dli_fname)
        hash = hash_file(hash, library.dli_fname);
    snprintf(key, size, "%016llx %d x %s", (unsigned long long)hash, threads, cpu);
    for (char *c = key; *c; c++)
        if (*c == '\t' || *c == '\n')
            *c = ' ';
}

// Create the missing folders of a path.
static void make_folders(const char *path)
{
    char *copy = strdup(path);
    for (char *slash = copy ? strchr(copy + 1, '/') : NULL; slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        mkdir(copy, 0777);
        *slash = '/';
    }
    free(copy);
}

int trade_cache_open(struct trade_cache **out, const char *path, const char *key, struct tool_error *error)
{
    struct trade_cache *c = calloc(1, sizeof *c);
    *out = c;
    if (!c || !(c->path = strdup(path)))
        return tool_fail(error, -1, "there is not enough memory");
    snprintf(c->key, sizeof c->key, "%s", key);
    make_folders(path);
    c->file = fopen(path, "a");
    if (!c->file)
        return tool_fail(error, -1, "--cache: cannot write %s: %s", path, strerror(errno));
    return 0;
}

void trade_cache_close(struct trade_cache *c)
{
    if (!c)
        return;
    if (c->file)
        fclose(c->file);
    free(c->path);
    free(c);
}

static void begin(struct trade_cache *c, char kind, const struct trade_result *r, const char *scene)
{
    fprintf(c->file, "%s\t%c\t%s\t%s\t", c->key, kind, r->setting->options, scene);
}

static void end(struct trade_cache *c)
{
    fputs("end\n", c->file);
    fflush(c->file);
}

void trade_cache_point(struct trade_cache *c, const struct trade *t, const struct trade_result *r, int scene)
{
    if (!c)
        return;
    begin(c, 'D', r, t->scene[scene].text);
    for (int i = 0; i < BENCH_REGIONS; i++) {
        const struct bench_distance *d = &r->at[scene].distance[i];
        fprintf(c->file, "%.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g ", d->share, d->psnr, d->display_rmse,
                d->linear_rmse, d->largest, d->ssim, d->flip, d->energy);
    }
    fprintf(c->file, "%.17g ", r->at[scene].flicker);
    end(c);
}

void trade_cache_axes(struct trade_cache *c, const struct trade_result *r)
{
    if (!c)
        return;
    begin(c, 'A', r, "");
    fprintf(c->file, "%.17g %.17g ", r->rounding, r->faithfulness);
    end(c);
}

void trade_cache_time(struct trade_cache *c, const struct trade *t, const struct trade_result *r, int scene)
{
    const struct trade_time *time = scene < 0 ? &r->both : &r->at[scene].time;
    const int i = time->n - 1;
    if (!c)
        return;
    begin(c, 'T', r, scene < 0 ? "both" : t->scene[scene].text);
    fprintf(c->file, "%.6f ", time->sample[i]);
    for (int p = 0; p < TRADE_PASSES; p++)
        fprintf(c->file, "%.6f ", time->pass[i][p]);
    end(c);
}

// Read numbers up to the word `end`. Returns how many, or -1.
static int numbers(const char *text, double *out, int most)
{
    int n = 0;
    for (; n < most; n++) {
        char *rest;
        out[n] = strtod(text, &rest);
        if (rest == text)
            break;
        text = rest;
    }
    return !strcmp(text + strspn(text, " "), "end") ? n : -1;
}

static int apply(struct trade *t, char kind, const char *options, const char *scene, const char *text)
{
    double v[BENCH_REGIONS * DISTANCES + 1];
    struct trade_result *r = NULL;
    int s = strcmp(scene, "both") ? TRADE_SCENES : -1;
    for (int i = 0; i < t->results; i++)
        if (!strcmp(t->result[i].setting->options, options))
            r = &t->result[i];
    for (int i = 0; i < t->scenes; i++)
        if (!strcmp(t->scene[i].text, scene))
            s = i;
    const int n = numbers(text, v, sizeof v / sizeof *v);
    if (!r || (s == TRADE_SCENES && kind != 'A'))
        return 0;
    if (kind == 'A' && n == 2) {
        r->rounding = v[0];
        r->faithfulness = v[1];
        r->axes_measured = 1;
    } else if (kind == 'D' && s >= 0 && n == BENCH_REGIONS * DISTANCES + 1) {
        for (int i = 0; i < BENCH_REGIONS; i++) {
            const double *d = v + i * DISTANCES;
            r->at[s].distance[i] = (struct bench_distance){d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7]};
        }
        r->at[s].flicker = v[n - 1];
        r->at[s].measured = 1;
    } else if (kind == 'T' && n == 1 + TRADE_PASSES) {
        struct trade_time *time = s < 0 ? &r->both : &r->at[s].time;
        if (time->n == TRADE_ROUNDS)
            return 0;
        time->sample[time->n] = v[0];
        memcpy(time->pass[time->n++], v + 1, TRADE_PASSES * sizeof *v);
    } else {
        return 0;
    }
    return 1;
}

int trade_cache_load(struct trade_cache *c, struct trade *t)
{
    FILE *f = c ? fopen(c->path, "r") : NULL;
    char *line = NULL;
    size_t size = 0;
    int applied = 0;
    for (ssize_t n; f && (n = getline(&line, &size, f)) > 0;) {
        char *field[5], *rest = line;
        int fields = 0;
        line[strcspn(line, "\n")] = '\0';
        while (fields < 5 && (field[fields] = strsep(&rest, "\t")))
            fields++;
        if (fields == 5 && !strcmp(field[0], c->key))
            applied += apply(t, field[1][0], field[2], field[3], field[4]);
    }
    free(line);
    if (f)
        fclose(f);
    return applied;
}
