// SPDX-License-Identifier: BSD-3-Clause
// The word that somebody who misspelt one may have meant.
#ifndef HF_TOOL_NEAREST_H
#define HF_TOOL_NEAREST_H

// Letters to add, leave out, change or swap with the next to make one word of the other; words of up to 63.
int tool_word_distance(const char *a, int a_length, const char *b, int b_length);

// Is a word at this distance from one of some length near enough to be suggested?
int tool_is_near(int distance, int length);

// The nearest of some words so far: start from zeros.
struct tool_nearest {
    const char *word;  // NULL: none is near
    int length, distance;
};
void tool_nearest_try(struct tool_nearest *nearest, const char *word, int length, const char *wanted);

#endif
