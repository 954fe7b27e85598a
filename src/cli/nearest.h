// SPDX-License-Identifier: BSD-3-Clause
// The word that somebody who misspelt one may have meant.
#ifndef HF_CLI_NEAREST_H
#define HF_CLI_NEAREST_H

// Letters to add, leave out, change or swap with the next to make one word of the other; words of up to 63.
int cli_word_distance(const char *a, int a_length, const char *b, int b_length);

// Is a word at this distance from one of some length near enough to be suggested?
int cli_is_near(int distance, int length);

#endif
