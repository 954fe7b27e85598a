// SPDX-License-Identifier: BSD-3-Clause
// Times of frames and of their passes: the last ones to draw, and the averages of each 100 for a file. No GTK.
#ifndef HF_VIEW_PROFILE_H
#define HF_VIEW_PROFILE_H

#include "tools/common/error.h"
#include "tools/common/report.h"

enum { PROFILE_SHOWN = 200, PROFILE_BLOCK = 100 };

struct view_profile_block {
    int frames;
    enum hf_engine engine;  // of the last frame
    double all, interval;   // sums: of the calls; from frame to frame
    double pass[TOOL_PASSES];
};

struct view_profile {
    double last[PROFILE_SHOWN];  // a ring, milliseconds of frames
    int count;                   // of all frames
    double before_ms;            // when the frame before was there
    struct tool_report report;   // the newest
    struct view_profile_block *blocks;
    int block_count;
};

void view_profile_add(struct view_profile *p, const struct tool_report *report, double ms, double now_ms);
void view_profile_free(struct view_profile *p);
// Write all blocks. Returns 0, or -1 with *error filled.
int view_profile_write(const struct view_profile *p, const char *path, struct tool_error *error);

#endif
