// SPDX-License-Identifier: BSD-3-Clause
// How linear colour becomes what a display is sent: exposure, then the sRGB curve, then 8 bits, as the command writes pictures
// of 8 bits. No GTK.
#ifndef HF_VIEW_LOOK_H
#define HF_VIEW_LOOK_H

#include <stddef.h>
#include <stdint.h>

// One sample.
uint8_t view_look_byte(float linear);
// Pixels of B, G, R and 255 from planes of linear colour, a row of n. gain: 2 to the power of the exposure.
void view_look_row(const float *r, const float *g, const float *b, float gain, uint32_t *to, int n);
// The colour of numbers already encoded for the display, 0 to 1.
uint32_t view_look_pixel(float r, float g, float b);

#endif
