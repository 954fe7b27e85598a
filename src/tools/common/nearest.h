// SPDX-License-Identifier: BSD-3-Clause
// The word that somebody who misspelt one may have meant.
#ifndef HF_TOOL_NEAREST_H
#define HF_TOOL_NEAREST_H

// The nearest of some words so far: start from zeros.
struct tool_nearest {
    const char *word;  // NULL: none is near
    int length, distance;
};
void tool_nearest_try(struct tool_nearest *nearest, const char *word, int length, const char *wanted);

#endif
