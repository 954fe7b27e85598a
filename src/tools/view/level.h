// SPDX-License-Identifier: BSD-3-Clause
// Which settings a frame may have while something moves: the best whose expected time holds 60 frames a second on this machine. No
// GTK.
#ifndef HF_VIEW_LEVEL_H
#define HF_VIEW_LEVEL_H

#include "hyperfocal/hyperfocal.h"

// How a picture of a request was made: while something moves, at rest by the standard quality, at rest as the command makes it.
enum view_stage { VIEW_QUICK, VIEW_STANDARD, VIEW_FINAL, VIEW_STAGES };

struct view_levels {
    double ms[2];  // of a megapixel: by the quick settings, by those of the command
};

#define VIEW_TARGET_MS 8.0  // of a sixtieth of a second the rest is for the window

void view_levels_open(struct view_levels *l);
// A frame of so many megapixels took so long.
void view_levels_tell(struct view_levels *l, enum view_stage stage, double megapixels, double ms);

// Choose the settings to move with for a part of so many full-size pixels, seen at 1/n of its size. Returns 1/how much of its size
// to render at, and fills *params from those of the command. *stage becomes VIEW_FINAL if those of the command at 1/n are fast enough.
int view_levels_choose(const struct view_levels *l, const struct hf_params *final, const struct hf_depth *depth,
                       double pixels, int n, struct hf_params *params, enum view_stage *stage);

// The settings of the standard quality, if those of the command cost more: 1 and *params, else 0.
int view_levels_standard(const struct hf_params *final, const struct hf_depth *depth, struct hf_params *params);

#endif
