// SPDX-License-Identifier: BSD-3-Clause
// Options of hyperfocal-bench, the same for all its commands.
#ifndef HF_BENCH_ARGS_H
#define HF_BENCH_ARGS_H

#include "hyperfocal/hyperfocal.h"
#include "tools/common/options.h"

#include <stdio.h>

struct bench_args {
    int help;            // see tool_parser
    char *const *words;  // as given, without the command
    int word_count;
    int width, height;  // pixels
    int frames;         // 0: as many as take a few seconds
    int threads;        // 0: one per processor
    enum hf_isa isa;
    const char *scene;          // name of a built-in scene, or of a file
    const char *images;         // folder of the truth scenes
    const char *image, *truth;  // truth: any picture and what it should be; NULL: the scenes
    char found[4096];           // what images points at if the folder was looked for
    const char *compression;    // batch: one of EXR's, NULL for all
    int engine_given;
    const char *json;  // file, "-" for stdout, NULL for none
    // tradeoff
    int quick;
    const char *setting;                             // the only one to measure: options as one word; NULL: the list
    const char *csv, *html, *png, *ladder, *readme;  // files to write; NULL: none
    const char *cache;                               // file, "none", or NULL: the user's cache folder
    enum hf_format in, out;
    struct hf_params params;
    int full;                                                    // stability: the long run
    int size_given, focus_given, range_given, max_radius_given;  // on the command line
};

// The defaults of DESIGN.md, section 7: 1920x1080, mixed, float storage, R11G11B10F in and out, radius 12.
void bench_args_default(struct bench_args *args);

// Parse the options that follow a command. Returns 0, or -1 with *error filled. Nothing is looked at after -h.
// command: which it is, NULL for a setting of any.
int bench_args_parse(struct bench_args *args, const char *command, int count, char **options, struct tool_error *error);

// All options, and what else is said of the program; the commands are main.c's.
extern const struct tool_program bench_program;
extern const char *const bench_command_words[][2];

#endif
