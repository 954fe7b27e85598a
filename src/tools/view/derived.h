// SPDX-License-Identifier: BSD-3-Clause
// The value that an option has in effect, whether it was given or not. No GTK.
#ifndef HF_VIEW_DERIVED_H
#define HF_VIEW_DERIVED_H

#include "tools/cli/setup.h"

enum { VIEW_VALUE = 64 };

// params: without HF_DERIVE, see hf_resolve. Writes the value as the option takes it; "" if the library has no such field. Returns
// 1 and *number if it is a number.
int view_derived(const struct tool_option *option, const struct hf_params *params, char text[VIEW_VALUE],
                 double *number);

// What kind of control an option has.
enum view_kind { VIEW_FLAG, VIEW_CHOICE, VIEW_NUMBER, VIEW_TEXT };
enum view_kind view_kind(const struct tool_option *option);

// A slider goes from 0 to 1, along values from low to high. none: there is no slider.
struct view_scale {
    enum { VIEW_SCALE_NONE, VIEW_SCALE_LINEAR, VIEW_SCALE_LOG, VIEW_SCALE_CUBIC } kind;
    double low, high;
    int whole;
};
// nearest and farthest: of the picture's surfaces, for distances.
struct view_scale view_scale(const struct tool_option *option, double nearest, double farthest);
double view_scale_value(const struct view_scale *s, double t);
double view_scale_place(const struct view_scale *s, double value);

#endif
