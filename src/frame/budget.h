// SPDX-License-Identifier: BSD-3-Clause
// A time budget: chooses the next frame's setting from a ladder that goes from the caller's setting down to the
// cheapest. After two frames beyond the budget it goes at once to the step that is expected to keep it.
#ifndef HF_BUDGET_H
#define HF_BUDGET_H

#include "hyperfocal/hyperfocal.h"

enum { HF_BUDGET_STEPS = 32 };  // more than the ladder has

struct hf_budget {
    uint64_t asked;               // hash of what the ladder was made for; 0: nothing yet
    int step;                     // in use
    int frames;                   // rendered at it
    int over, calm;               // consecutive frames beyond the budget, and with room for the step above
    int patience;                 // calm frames to wait for before going up
    int climbed;                  // this step was reached from a cheaper one
    float told;                   // the budget that was reported as impossible; 0: none
    float ms;                     // of a frame at this step, smoothed
    int from;                     // the step before this one
    float from_ms;                // of a frame at that step when it was left; 0: not known
    float cost[HF_BUDGET_STEPS];  // of each step, in one unit: by the ladder's table, then by frames at the step
};

// Fill ladder with settings to choose from, best first: *asked, and the steps of ladder.h, and one below them for a lens,
// that cost less and reach as far as radius, pixels, or as *asked does itself. Returns how many.
int hf_budget_ladder(const struct hf_params *asked, float radius, struct hf_params ladder[HF_BUDGET_STEPS]);

// Choose the setting for the next frame.
int hf_budget_choose(struct hf_budget *b, const struct hf_params *ladder, int steps);
// Note how long that frame took.
void hf_budget_note(struct hf_budget *b, float budget_ms, int steps, float ms);
// The command's words for a step of the ladder, or NULL.
const char *hf_budget_options(const struct hf_params *asked, const struct hf_params *step);
// Whether frames take longer even at the cheapest setting. Returns 1 only once for a budget.
int hf_budget_missed(struct hf_budget *b, float budget_ms, int steps);

#endif
