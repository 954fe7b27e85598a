// SPDX-License-Identifier: BSD-3-Clause
// Suggests the word that a misspelt one may have meant.
#ifndef HF_TOOL_NEAREST_H
#define HF_TOOL_NEAREST_H

// The nearest word so far; start with zeros.
struct tool_nearest {
    const char *word;  // NULL: none is near
    int length, distance;
};
void tool_nearest_try(struct tool_nearest *nearest, const char *word, int length, const char *wanted);

#endif
