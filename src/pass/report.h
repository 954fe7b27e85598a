// SPDX-License-Identifier: BSD-3-Clause
// What the library notes about a frame: hf_report and hf_inspect_report are made of it.
#ifndef HF_PASS_REPORT_H
#define HF_PASS_REPORT_H

#include "hyperfocal/inspect.h"

#include "pass/frame.h"

// A pass of the frame, as in struct hf_inspect_pass.
struct hf_frame_pass {
    const char *name, *skipped;
    uint32_t run, all, ran;
    double predicted_ms, ms;
};

// The fields are those of struct hf_report and struct hf_inspect_report.
struct hf_frame_report {
    struct hf_settings used;  // without aperture.picture, which is the caller's
    int picture;              // 1: there was one
    int budget_step, budget_steps;
    const char *budget_options;

    int tile_width, tile_height;
    int columns, rows;
    uint32_t tile_count[4];
    int passes;
    struct hf_frame_pass pass[HF_MAX_PASSES];

    float near_radius, far_radius;
    int slices[4], hidden_levels;
    int colour_known;
    float brightest;
    int opaque;
    uint64_t not_finite;

    size_t memory, memory_needed, memory_saved;
    double plan_ms, predicted_ms;

    double total_ms;
    size_t memory_held;
    uint64_t near_pixels, sharp_pixels, far_pixels;
    uint64_t colour_repaired, depth_repaired, no_surface, clamped;
    double guessed;
};

#endif
