// SPDX-License-Identifier: BSD-3-Clause
// The keys of a shot, as the window changes and saves them. Reading and interpolating is the command's (cli/keys.h).
#ifndef HF_VIEW_MODEL_KEYS_H
#define HF_VIEW_MODEL_KEYS_H

#include "tools/cli/keys.h"

// Copy; returns 0, or -1 without memory and with *to empty.
int view_keys_copy(struct cli_keys *to, const struct cli_keys *from);

// The column of an option's name, that of X for focus-at; -1: none. And the name of a column.
int view_keys_column(const char *option);
const char *view_keys_name(int column);
// 1 if both hold the same keys.
int view_keys_same(const struct cli_keys *a, const struct cli_keys *b);
// 1 if there is any key.
int view_keys_any(const struct cli_keys *k);
// The place of the key at a frame in its column; -1: none.
int view_keys_find(const struct cli_keys *k, int column, double frame);
// Set a key, or take it away if it is there. Returns 0, or -1 without memory.
int view_keys_set(struct cli_keys *k, int column, double frame, double value);
void view_keys_remove(struct cli_keys *k, int column, double frame);

// Write the CSV that `hyperfocal --keys` reads: to a file beside path, then renamed. Returns 0, or -1 with *error filled.
int view_keys_save(const struct cli_keys *k, const char *path, struct tool_error *error);

#endif
