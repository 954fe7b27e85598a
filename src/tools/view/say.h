// SPDX-License-Identifier: BSD-3-Clause
// What tests wait for: with HYPERFOCAL_VIEW_SAY set, the program prints a line for each change of its state.
#ifndef HF_VIEW_SAY_H
#define HF_VIEW_SAY_H

// "WHAT ..." as one line on stdout.
void view_say(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
