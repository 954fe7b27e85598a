// SPDX-License-Identifier: BSD-3-Clause
// File names with places for a frame number and a view's name.
//
//     #            the number, with as many digits as the existing files have
//     ####, @@@    the number, with at least as many digits as there are signs
//     @            the number, with no zeros in front
//     %04d, %d     the number, as printf writes it
//     $F4, $F      the number, as Houdini writes it
//     %V           the view's name
//     %v           the first letter of the view's name
//
// A name may have several such places. The minus sign of a negative number counts as a digit, as for printf.
#ifndef HF_CLI_PATTERN_H
#define HF_CLI_PATTERN_H

#include <stddef.h>

#include "tools/common/error.h"
#include "tools/cli/frames.h"

// Whether a file name has a place for the frame number, or one for the view's name: 1 or 0.
int cli_pattern_has_frame(const char *pattern);
int cli_pattern_has_view(const char *pattern);

// Fill in the number, or the view's name. Returns a text to be freed, or NULL without memory. digits: how many a lone
// # stands for.
char *cli_pattern_fill(const char *pattern, int frame, int digits);
char *cli_pattern_view(const char *pattern, const char *view);

// Find the existing frames, sorted. *digits: the fewest digits that a lone # has in their names; 4 if there are none.
// Returns 0, or an exit code with *error filled if the directory is unreadable or its own name has a place for the
// number: only one directory is searched.
int cli_pattern_scan(const char *pattern, struct cli_frames *found, int *digits, struct tool_error *error);

// The last number in a file's name, "shot.0007.exr": 1 and *frame, *digits; 0 if there is none.
int cli_name_number(const char *path, int *frame, int *digits);

#endif
