// SPDX-License-Identifier: BSD-3-Clause
// The page: one HTML file that opens from disk, with charts, and crops and passes of each setting.
#ifndef HF_BENCH_PAGE_H
#define HF_BENCH_PAGE_H

#include "tradeoff_run.h"

// Renders each setting once more for its crops. Returns 0, or -1 with *error filled.
int bench_page_write(struct trade_run *run, const char *path, struct tool_error *error);
// Check before anything is measured that rsvg-convert is installed. Returns 0, or -1 with *error filled.
int bench_page_png_check(struct tool_error *error);
// Write the page's first chart as a PNG, drawn by rsvg-convert. Returns 0, or -1 with *error filled.
int bench_page_png(const struct trade *t, const char *path, struct tool_error *error);

#endif
