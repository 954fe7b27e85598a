// SPDX-License-Identifier: BSD-3-Clause
// The plan of a frame and its result, for people.
#ifndef HF_REPORT_H
#define HF_REPORT_H

#include "frame/context.h"

// Fill in the context's report: of a frame that is only copied; or from its plan and what the first sweep counted.
void hf_report_copy(struct hf_context *c, const struct hf_setup *s);
void hf_report_plan(struct hf_context *c, const struct hf_setup *s, const struct hf_counts *found);
// Add what the workers found in the colour.
void hf_report_colour(struct hf_context *c);
// Add what the frame's workers did.
void hf_report_frame(struct hf_context *c, double total_ms);
// Learn from the report what passes cost.
void hf_report_learn(struct hf_context *c, const struct hf_setup *s);
// What all workers have counted so far.
struct hf_counts hf_report_counts(const struct hf_context *c);
// hf_inspect_tiles for the current report.
size_t hf_report_tiles(const struct hf_context *c, uint8_t *tiles, size_t size);

#endif
