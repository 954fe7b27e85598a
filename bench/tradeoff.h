// SPDX-License-Identifier: BSD-3-Clause
// What accuracy costs in time: the settings, their measurements, and the selection of settings worth having.
//
//   tradeoff.c         the command: scenes, rounds, progress
//   tradeoff_list.c    the settings
//   tradeoff_scene.c   pictures with their truth
//   tradeoff_cache.c   what was measured before, by build, machine and setting
//   tradeoff_front.c   medians, the Pareto front, the ladder that the library uses
//   tradeoff_readme.c  its part of the README
//   tradeoff_report.c  table, CSV, JSON and the library's own table
//   page*.c            the HTML page and its charts
#ifndef HF_BENCH_TRADEOFF_H
#define HF_BENCH_TRADEOFF_H

#include "args.h"
#include "metrics.h"
#include "tools/common/report.h"

#include <stdio.h>

enum {
    TRADE_SCENES = 8,
    TRADE_SETTINGS = 160,
    TRADE_ROUNDS = 9,
    TRADE_PASSES = TOOL_PASSES,
    TRADE_RADIUS = 12,  // of `both`, pixels
};

// A setting is what a user types: the same words for both programs.
struct trade_setting {
    const char *knob;     // the option that is varied: "engine", "taps" ...
    const char *name;     // short, for a chart
    const char *options;  // "--engine scatter --resolution half"
    int quick;            // measured with --quick too
};

extern const struct trade_setting trade_settings[];
extern const int trade_setting_count;

// Milliseconds of frames, one from each round, and of their passes.
struct trade_time {
    int n;
    double sample[TRADE_ROUNDS];
    double pass[TRADE_ROUNDS][TRADE_PASSES];
};

// Median and quartiles. If two intervals overlap, their order is chance.
struct trade_interval {
    double low, median, high;
};

// A setting on a scene.
struct trade_point {
    int measured;  // the members below are valid, except the time
    struct bench_distance distance[BENCH_REGIONS];
    double flicker;  // of a focus pull, display-encoded
    struct trade_time time;
};

enum trade_rank { TRADE_BEATEN, TRADE_TIED, TRADE_FRONT };

struct trade_result {
    const struct trade_setting *setting;
    enum hf_engine engine;
    struct hf_params params;  // its options, parsed
    float farthest;           // the largest radius by which it can blur, pixels; INFINITY: any
    struct trade_point at[TRADE_SCENES];
    struct trade_time both;  // 1920x1080, scene `both`, radius 12: what `passes` measures
    int axes_measured;       // the two members below are valid
    double rounding;      // linear root mean square distance from the algorithm in double precision; NAN: there is none
    double faithfulness;  // display-encoded, from the published demo; NAN: another algorithm

    // Computed by trade_rank:
    struct trade_interval ms;  // mean over the scenes
    struct trade_interval both_ms;
    double error;  // geometric mean over the scenes of the whole picture's display error; it belongs to the mean PSNR
    double worst;  // largest of them
    enum trade_rank rank;
    int step;  // position on the ladder, from 1; 0: not on it
};

struct bench_peels;
enum { TRADE_PEELS = 2 };

struct trade_scene_name {
    char text[64];
};

struct trade {
    const struct bench_args *args;
    int threads;
    enum hf_isa isa;
    int scenes, results;
    struct trade_scene_name scene[TRADE_SCENES];
    int width[TRADE_SCENES], height[TRADE_SCENES];
    float largest[TRADE_SCENES];  // CoC radius in each scene, pixels
    struct trade_result *result;  // of `results`
    double gflops;
    char cpu[128], date[32];
    const char *commit;
    // Scenes with one, two and three surfaces known, by layers in two qualities; NULL: not measured.
    const struct bench_peels *peels[TRADE_PEELS];
};

// The median and quartiles of samples.
struct trade_interval trade_interval(const double *samples, int n);
int trade_overlap(struct trade_interval a, struct trade_interval b);

// Compute what follows from the measurements. A setting is beaten if another errs no more and is surely faster: its
// whole interval lies below. It is tied if the other is faster only by the median.
void trade_rank(struct trade *t);
// How much smaller the error of one setting is than that of another, dB of the geometric mean over the scenes.
double trade_gain_db(const struct trade_result *better, const struct trade_result *than);
// What a step of the ladder gains at least over the one before: a difference that a user can see.
static const double TRADE_STEP_DB = 0.2;
// Fill in step: the longest list of settings from the cheapest to the most accurate, in which each is slower by a fifth
// than the one before, gains TRADE_STEP_DB, and is not worse on any scene. A setting is never chosen for a scene with radii beyond
// its reach (hf_choose_quality), so there a setting with more reach may be worse. The part of the list that reaches any
// radius begins with the cheapest engine with its defaults. Only settings that blur and use the machine's own threads
// and instruction set are listed; among settings that do the same thing, the one with the fewest words.
void trade_ladder(struct trade *t);
// The results in the order of the table: by time.
void trade_order(const struct trade *t, int order[]);

// The steps of the ladder for --quality: the cheapest that reaches any radius; the cheapest within 1.5 dB of the last;
// the cheapest within 0.25 dB; the last. Where no step lies between two qualities, both are the same step. place receives
// indices of results. Returns 0, or -1 if there is no ladder.
enum { TRADE_QUALITIES = 4 };
int trade_qualities(const struct trade *t, int place[TRADE_QUALITIES]);

// The cache: opened for a build and a machine, read completely, appended to line by line.
struct trade_cache;
int trade_cache_open(struct trade_cache **cache, const char *path, const char *key, struct tool_error *error);
// Fill in what the cache has of the results. Returns how many lines applied.
int trade_cache_load(struct trade_cache *cache, struct trade *t);
void trade_cache_point(struct trade_cache *cache, const struct trade *t, const struct trade_result *r, int scene);
void trade_cache_axes(struct trade_cache *cache, const struct trade_result *r);
// Append the newest sample; scene -1: of `both`.
void trade_cache_time(struct trade_cache *cache, const struct trade *t, const struct trade_result *r, int scene);
void trade_cache_close(struct trade_cache *cache);
// Make a key for this build of program and library on this machine.
void trade_cache_key(char *key, size_t size, const char *cpu, int threads);

void trade_table(FILE *out, const void *t);
// Write the conclusions in three sentences, each between `before` and `after`.
void trade_sentences(FILE *out, const struct trade *t, const char *before, const char *after);
// Write the qualities as rows of Markdown: what they choose, take and err.
void trade_qualities_table(FILE *out, const struct trade *t);
// Write both between the marks of a file, with the command that measured. Returns 0, or -1 with *error filled.
int trade_readme_check(const char *path, struct tool_error *error);  // before anything is measured
int trade_readme(const char *path, const struct trade *t, const char *command, struct tool_error *error);
// Settings with taps of the same reach, on `both`: milliseconds of two passes and of the frame. Returns 0 for other
// settings.
struct trade_taps {
    const char *name;
    double computation, fill, frame, db;
};
int trade_taps(const struct trade *t, int result, struct trade_taps *taps);
void trade_csv(FILE *out, const struct trade *t);
// src/frame/ladder_table.h
void trade_ladder_table(FILE *out, const struct trade *t);
void trade_json(FILE *out, const void *t);

#endif
