// SPDX-License-Identifier: BSD-3-Clause
// Options of hyperfocal-bench, the same for all its commands: one table that parser and help text walk.
#ifndef HF_BENCH_ARGS_H
#define HF_BENCH_ARGS_H

#include "error.h"
#include "hyperfocal/hyperfocal.h"

#include <stdio.h>

struct bench_args {
    int help;
    int width, height;  // pixels
    int frames;         // 0: as many as take a few seconds
    int threads;        // 0: one per processor
    enum hf_isa isa;
    const char *scene;        // name of a built-in scene, or of a file
    const char *images;       // folder of the truth scenes
    const char *compression;  // batch: one of EXR's, NULL for all
    int engine_given;
    const char *json;  // file, "-" for stdout, NULL for none
    // tradeoff
    int quick;
    const char *setting;                    // the only one to measure: options as one word; NULL: the list
    const char *csv, *html, *png, *ladder;  // files to write; NULL: none
    const char *cache;                      // file, "none", or NULL: the user's cache folder
    enum hf_format in, out;
    struct hf_params params;
    enum hf_resolution resolution;                               // of whichever engine
    int full;                                                    // stability: the long run
    int faithful;                                                // likewise
    int size_given, focus_given, range_given, max_radius_given;  // on the command line
};

// The defaults of DESIGN.md, section 7: 1920x1080, mixed, float storage, R11G11B10F in and out, radius 12.
void bench_args_default(struct bench_args *args);

// Parse the options that follow a command. Returns 0, or -1 with *error filled. Nothing is looked at after -h.
int bench_args_parse(struct bench_args *args, int count, char **options, struct bench_error *error);

// The option part of a help text.
void bench_args_help(FILE *out);

#endif
