// SPDX-License-Identifier: BSD-3-Clause
// Rows that are known to exceed their bound: why, and by how much at most. They are printed as open; what is worse than
// that fails. A row that keeps its bound goes from here; none may be added to hide something new.
#ifndef HF_TESTS_STABILITY_OPEN_H
#define HF_TESTS_STABILITY_OPEN_H

static const struct {
    const char *what;
    const char *subject;  // its name, or how the names of several begin
    double most;
    const char *reason;
} open_rows[] = {
    {"transposes: difference, of the largest", "scatter", 0.015,
     "a disc's rows end between pixels, its first and last row do not: its outline differs along the axes"},
    {"flips: samples that are not the mirror's bits", "scatter", 5400,
     "what lies behind near pixels is made from quads counted from the left: an odd width has others in the mirror"},
};

#endif
