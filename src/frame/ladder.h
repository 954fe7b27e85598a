// SPDX-License-Identifier: BSD-3-Clause
// The settings worth having, cheapest first, as `hyperfocal-bench tradeoff` measured them. A quality, a largest error
// and a time budget choose from these.
#ifndef HF_LADDER_H
#define HF_LADDER_H

#include "pass/frame.h"

struct hf_ladder_step {
    const char *options;      // the command's words for it
    float error, worst;       // distance from the truth, display-encoded: geometric mean over the scenes, and the worst
    float ms;                 // of a megapixel
    struct hf_params params;  // the defaults, except for the members in ladder_fields.h
};

extern const struct hf_ladder_step hf_ladder[];
extern const int hf_ladder_steps;
extern const int hf_ladder_quality[];    // the step of each enum hf_quality
extern const char hf_ladder_measured[];  // when and on what machine
// Milliseconds of a megapixel for each engine with its defaults; 0: not measured.
extern const float hf_ladder_engine_ms[HF_ENGINE_COUNT];

// Set the members of params in which steps differ, the engine and its options, to those of other parameters or of a step.
void hf_ladder_set(struct hf_params *params, const struct hf_params *of);
void hf_ladder_apply(struct hf_params *params, int step);
// A hash of those members.
uint64_t hf_ladder_hash(const struct hf_params *params);
// 1 if params->engine draws params->aperture.
int hf_ladder_can_draw(const struct hf_params *params);
// The largest radius that params->engine can blur by, pixels; INFINITY: any.
float hf_ladder_farthest(const struct hf_params *params);
// Remove from params->aperture what params->engine cannot draw.
void hf_ladder_reshape(struct hf_params *params);
// The expected milliseconds of a megapixel with params: of the step that they equal, else of their engine; INFINITY if
// that was not measured.
float hf_ladder_ms(const struct hf_params *params);

#endif
