// SPDX-License-Identifier: BSD-3-Clause
// Taps with a step (pixel/convolve.h) are laid over a plane that has been convolved with a tent of that width in y and then with
// the same in x: 1 2 1, or 1 2 3 4 3 2 1. It is not divided by the tent's sum; the taps' scale is.
#ifndef HF_TENTS_H
#define HF_TENTS_H

enum { HF_MAX_STEP = 4, HF_MAX_TENT = 2 * HF_MAX_STEP - 1 };

#endif
