// SPDX-License-Identifier: BSD-3-Clause
// The history of the benchmark: for some commits the time, memory and error of frames, and the machine they were measured on.
//
//   history.c        the command: measure a point, print the table
//   history_file.c   points as lines of a file
//   history_draw.c   points as charts
//
// A point is one line of the file, a flat JSON object. Its texts name the commit, the date, the machine and the source
// of the numbers. The name of a number has a kind and mostly a place:
//
//   "threads", "memcpy_ms", "fma_gflops"   the machine, as `passes` measures it
//   "busy"                                 how many medians were far above the least time
//   "ms gather"                            milliseconds of a frame of scene `mixed`, 1920x1080, as `passes` measures it
//   "pass gather/Downsample"               of one of its passes
//   "MB gather"                            megabytes held for it
//   "ms gather/lights", "dB gather/lights" a frame of a ray-traced scene, and its error against the truth
#ifndef HF_BENCH_HISTORY_H
#define HF_BENCH_HISTORY_H

#include <stdio.h>

#include "hyperfocal/hyperfocal.h"
#include "tools/common/error.h"
#include "tools/common/json.h"

enum { HISTORY_VALUES = 160, HISTORY_NAME = 64, HISTORY_TEXT = 160 };

struct history_value {
    char name[HISTORY_NAME];
    double value;
};

struct history_point {
    char commit[HISTORY_TEXT], date[HISTORY_TEXT];
    char source[HISTORY_TEXT];  // "measured", or the documents that had the numbers
    char cpu[HISTORY_TEXT], isa[HISTORY_TEXT];
    char truth[HISTORY_TEXT];  // a hash of the ray-traced pictures: errors against others do not compare
    int values;
    struct history_value value[HISTORY_VALUES];
};

struct history {
    int points;
    struct history_point *point;
};

// The number with a name made as by printf; NAN if the point has none.
__attribute__((format(printf, 2, 3))) double history_get(const struct history_point *p, const char *format, ...);
// Returns 0, or -1 when the point is full.
__attribute__((format(printf, 3, 4))) int history_set(struct history_point *p, double value, const char *format, ...);

// Whether both points were measured on the same kind of machine.
int history_same_machine(const struct history_point *a, const struct history_point *b);

// Read all lines of a file. Returns 0, or -1 with *error filled. Free it after an error too.
int history_read(struct history *h, const char *path, struct tool_error *error);
void history_free(struct history *h);

// Append a point to a file, which is created if it does not exist. Returns 0, or -1 with *error filled.
int history_append(const struct history_point *p, const char *path, struct tool_error *error);
// Write the members of a point into an open object.
void history_members(struct tool_json *j, const struct history_point *p);

// Draw small charts beside each other as SVG: frame times of each engine, memory, errors on each scene.
void history_draw(FILE *out, const struct history *h);

#endif
