// SPDX-License-Identifier: BSD-3-Clause
// Lists of frame numbers as the field writes them, in the order in which they are to be made:
//
//     1-100       1-100x2 (every second)   10-1 (backwards)   1,5,9-20x3   -5--1
//     1-100:3     every third first, then every second, then the rest
//     1-100y3     those that 1-100x3 leaves out
//
// A frame that comes twice is made once.
#ifndef HF_CLI_FRAMES_H
#define HF_CLI_FRAMES_H

#include "tools/common/error.h"

enum { CLI_MAX_FRAME = 99999999, CLI_MAX_FRAMES = 1000000 };

struct cli_frames {
    int *list;
    int count, room;
};

// Returns 0, or -1 with *error filled; then there is nothing to free.
int cli_frames_parse(struct cli_frames *frames, const char *text, struct tool_error *error);
// Returns 0, or -1 without memory.
int cli_frames_add(struct cli_frames *frames, int frame);
void cli_frames_free(struct cli_frames *frames);

// Write the numbers missing between the first and the last of a sorted list, as "4, 7-9", cut off at size. Returns how
// many there are.
int cli_frames_gaps(const struct cli_frames *sorted, char *buf, size_t size);

// Write in the same way the numbers of `asked`, in any order, that are not in the sorted list. Returns how many there
// are, or -1 without memory.
int cli_frames_missing(const struct cli_frames *asked, const struct cli_frames *sorted, char *buf, size_t size);

#endif
