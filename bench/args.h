// SPDX-License-Identifier: BSD-3-Clause
// Options of hyperfocal-bench, shared by all its commands.
#ifndef HF_BENCH_ARGS_H
#define HF_BENCH_ARGS_H

#include "hyperfocal/hyperfocal.h"
#include "tools/common/options.h"

#include <stdio.h>

struct bench_args {
    int help;            // set by --help, see tool_parser
    char *const *words;  // as typed, without the command
    int word_count;
    int width, height;  // pixels
    int frames;         // 0: as many as take a few seconds
    int threads;        // 0: one per processor
    enum hf_isa isa;
    const char *scene;          // name of a built-in scene, or of a file
    const char *images;         // folder of the truth scenes
    const char *image, *truth;  // for truth: any picture and its reference; NULL: the scenes
    char found[4096];           // the folder that images points at, if it was searched for
    const char *compression;    // for batch: one of EXR's, NULL for all
    int engine_given;
    int peels;     // for truth
    int surfaces;  // for passes: known ones
    int simulate;  // for scaling
    float bandwidth;
    const char *json;  // file, "-" for stdout, NULL for none
    // tradeoff
    int quick;
    const char *setting;  // the only setting to measure, its options in one string; NULL: the list
    const char *csv, *html, *png, *ladder, *readme;  // files to write; NULL: none
    const char *cache;                               // file, "none", or NULL: the user's cache folder
    // history
    int add;
    const char *history, *svg;  // files; NULL: the default
    enum hf_format in, out;
    struct hf_params params;
    int full;                                                    // for stability: the long run
    int size_given, focus_given, range_given, max_radius_given;  // whether they were given on the command line
};

// The defaults: 1920x1080, mixed, float storage, R11G11B10F in and out, radius 12.
void bench_args_default(struct bench_args *args);

// Parse the options after a command. Returns 0, or -1 with *error filled. After -h the other options are ignored.
// command: its name; NULL accepts the options of every command, for a setting.
int bench_args_parse(struct bench_args *args, const char *command, int count, char **options, struct tool_error *error);

// All options, and the program's other help texts; main.c has the commands.
extern const struct tool_program bench_program;
extern const char *const bench_command_words[][2];

#endif
