// SPDX-License-Identifier: BSD-3-Clause
// --bench: how fast the window answers.
#ifndef HF_VIEW_BENCH_H
#define HF_VIEW_BENCH_H

#include "tools/view/app.h"

// The size of the canvas.
enum { VIEW_BENCH_WIDTH = 1920, VIEW_BENCH_HEIGHT = 1080 };

void view_bench_begin(struct view_app *app);
// A result is on the screen.
void view_bench_drawn(struct view_app *app, const struct view_result *result);
void view_bench_free(struct view_app *app);

#endif
