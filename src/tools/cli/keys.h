// SPDX-License-Identifier: BSD-3-Clause
// Parameters that change over a shot: a table of values at some frames (--keys FILE), as a spreadsheet saves it.
//
//     frame,focus,range,focus-at
//     1,4.5,2,960:540
//     40,3,,
//
// The first row names the columns: frame, and any of those below. A value holds before the first and after the last
// row that has one; between two, it goes linearly or smoothly (a cubic through all of them that never overshoots).
// An empty cell is no key. Lines that begin with # are comments; ; and tabs separate too. Numbers may have the units that
// those of the options may: 4.5m, 50mm, f/2.8.
#ifndef HF_CLI_KEYS_H
#define HF_CLI_KEYS_H

#include "tools/common/error.h"

enum cli_key {
    CLI_KEY_FOCUS,
    CLI_KEY_RANGE,
    CLI_KEY_STRENGTH,
    CLI_KEY_FSTOP,
    CLI_KEY_FOCAL_LENGTH,
    CLI_KEY_MAX_RADIUS,
    CLI_KEY_FOCUS_X,  // the column focus-at has both, X:Y
    CLI_KEY_FOCUS_Y,
    CLI_KEY_COUNT
};

struct cli_keyed {
    double frame, value;
    int metric;  // value is in metres
};

struct cli_keys {
    int smooth;
    struct {
        struct cli_keyed *keys;  // by frame, each frame once
        int count;               // 0: the column is not there or has no value
    } column[CLI_KEY_COUNT];
};

// Returns 0, or an exit code with *error filled, which names the line.
int cli_keys_load(struct cli_keys *keys, const char *path, int smooth, struct tool_error *error);
// Convert values in metres to scene units; unit: metres in a scene unit. Call once.
void cli_keys_scale(struct cli_keys *keys, double unit);
void cli_keys_free(struct cli_keys *keys);

// Value of a column that has keys.
double cli_keys_at(const struct cli_keys *keys, enum cli_key key, double frame);

#endif
