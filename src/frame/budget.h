// SPDX-License-Identifier: BSD-3-Clause
// A time budget: chooses the next frame's setting from a ladder that goes from the caller's setting down to the
// cheapest.
#ifndef HF_BUDGET_H
#define HF_BUDGET_H

#include "hyperfocal/hyperfocal.h"

enum { HF_BUDGET_STEPS = 32 };  // more than the ladder has

struct hf_budget {
    uint64_t asked;                // hash of what the ladder was made for; 0: nothing yet
    int step;                      // in use
    int frames;                    // rendered at it
    int over, calm;                // consecutive frames beyond the budget, and with room for the step above
    int patience;                  // calm frames to wait for before going up
    int climbed;                   // this step was reached from a cheaper one
    float told;                    // the budget that was reported as impossible; 0: none
    float ms;                      // of a frame at this step, smoothed
    float above;                   // of the step above when it was left for this one; 0: it was not
    float ratio[HF_BUDGET_STEPS];  // cost of the step above over this one's, seen then
};

// Fill ladder with settings to choose from, best first: *asked, and the steps of ladder.h that cost less and reach as far
// as radius, pixels, or as *asked does itself. Returns how many.
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
