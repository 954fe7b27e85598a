// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_LAYERS_HIGHLIGHTS_H
#define HF_LAYERS_HIGHLIGHTS_H

#include "engine/layers/kernels.h"

// Half-resolution pixels around a sample that are read; columns that are loaded around a cell: the same in whole cache lines.
enum { HF_LAYERS_BRIGHT_REACH = 13, HF_LAYERS_BRIGHT_COLUMNS = 16 };

// Square roots of brightness must exceed the mean beside a sample this much more than the mean around it. So edges of
// patterns up to eighteen times as bright as what is next to them have no highlights.
#define HF_LAYERS_BESIDE 3

// Of a sample of radius r, what exceeds BRIGHT_PLAIN + BRIGHT_LEAST pi r^2 times its surroundings is a highlight (highlights.c).
#define HF_LAYERS_BRIGHT_PLAIN 2
#define HF_LAYERS_BRIGHT_LEAST 0.001f

// The back of a mixed pixel is a highlight only from this many times its cap on. A lamp behind a hair exceeds that. The sky behind
// leaves does not: it is everywhere, and would cost 4 % of the instructions.
#define HF_LAYERS_BEHIND 4

// Floats of scratch for a cell of half-resolution pixels.
size_t hf_layers_highlight_floats(int width, int height);
// Fill scratch with the means around a cell's pixels.
void hf_layers_highlight_means(const struct hf_frame *f, struct hf_rect cell, float *scratch);
// Compute the shares of some of its rows, from their samples. Where the back of a mixed pixel is the brighter highlight it
// becomes the visible sample, so what must know fronts from backs without looking at their radii comes first.
void hf_layers_highlights(const struct hf_frame *f, struct hf_rect cell, struct hf_rect rows, const float *scratch,
                          const struct hf_layers_any *any);

// Take lamps out of the farthest samples of some of its quads, from which hidden samples are made. A quad that is more than LAMP
// times as bright as what lies 10 and 16 pixels beside it loses weight, and so does one next to it; from twice that on it has
// none. Surfaces that are nearer by two pixels of radius do not count as beside. A lamp is small: what is hidden next to it is
// the wall, not more of the lamp.
// No surroundings are taken to be darker (a square root of brightness) than LAMP_DARK of the quad or what is next to it:
// before a black wall the last trace of a lamp would be one too.
#define HF_LAYERS_LAMP 8
#define HF_LAYERS_LAMP_DARK 0x1p-8f
void hf_layers_leave_lamps(const struct hf_frame *f, struct hf_rect cell, struct hf_rect rows, const float *scratch);

#endif
