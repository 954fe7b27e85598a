// SPDX-License-Identifier: BSD-3-Clause
// All that the library tells of a frame, in one struct; and how many there are of what the library lists.
#ifndef HF_TOOL_REPORT_H
#define HF_TOOL_REPORT_H

#include "hyperfocal/inspect.h"

enum { TOOL_PASSES = 16, TOOL_ENGINES = 16 };  // no engine has more passes, and no library more engines

struct tool_report {
    struct hf_report all;
    struct hf_inspect_report inner;
    struct hf_params params;  // the frame's, see hf_get_used
    struct hf_resolved used;
    struct hf_inspect_pass pass[TOOL_PASSES];
};

// Fill *r from the last frame.
static inline void tool_report_get(struct hf_context *c, struct tool_report *r)
{
    r->all.size = sizeof(r->all);
    r->inner.size = sizeof(r->inner);
    r->params.size = sizeof(r->params);
    r->used.size = sizeof(r->used);
    hf_get_report(c, &r->all);
    hf_inspect_get_report(c, &r->inner);
    hf_get_used(c, &r->params, &r->used);
    for (int i = 0; i < TOOL_PASSES; i++) {
        r->pass[i] = (struct hf_inspect_pass){.size = sizeof(r->pass[i])};
        if (i < r->inner.passes)
            hf_inspect_get_pass(c, i, &r->pass[i]);
    }
}

// All that it tells of a choice.
struct tool_choice {
    struct hf_choice all;
    struct hf_inspect_choice inner;
};

// hf_choose_quality (error 0), or else hf_choose_error. inner is 0 where they fail.
static inline int tool_choose(int height, const struct hf_depth *depth, struct hf_params *params,
                              enum hf_quality quality, float error, struct tool_choice *choice)
{
    *choice = (struct tool_choice){.all = {.size = sizeof(choice->all)}, .inner = {.size = sizeof(choice->inner)}};
    hf_inspect_get_choice(height, depth, params, quality, error, &choice->inner);
    return error == 0 ? hf_choose_quality(height, depth, params, quality, &choice->all, NULL)
                      : hf_choose_error(height, depth, params, error, &choice->all, NULL);
}

static inline int tool_engines(void)
{
    int n = 0;
    while (n < TOOL_ENGINES && hf_engine_name((enum hf_engine)n))
        n++;
    return n;
}

static inline int tool_passes(enum hf_engine engine)
{
    int n = 0;
    while (n < TOOL_PASSES && hf_inspect_pass_name(engine, n))
        n++;
    return n;
}

#endif
