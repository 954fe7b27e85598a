// SPDX-License-Identifier: BSD-3-Clause
// An engine is a list of passes and of the buffers between them. Everything else, which passes run where, how large the
// buffers are, who works on what, follows from these tables (plan.c, render.c).
#ifndef HF_ENGINE_H
#define HF_ENGINE_H

#include "frame/pass.h"

struct hf_plan;

struct hf_buf_def {
    const char *name;  // in dumps; NULL: not shown
    int frame;         // a window of the whole frame; else of a cell of the sweep that writes it
    int x, y;          // log2 of its pixels per half-resolution pixel: 1 is full resolution, 0 half, -1 a quarter
    unsigned field;    // the field that it belongs to; 0: wanted for any
    int shrinks;       // x and y are those at full resolution, and smaller with the setup's
    int bare;          // nothing is read beyond the frame: no border
    int narrow;        // of hf_narrow_bytes a sample
};

struct hf_engine_def {
    const char *name;  // the command line's
    const struct hf_pass *passes;
    int pass_count;
    int sweeps;  // sweep 1 is over chunks: its first pass looks at depth alone and counts what there is
    const struct hf_buf_def *bufs;
    int buf_count;
    // Bit i: sweep i takes whole rows or columns, so all of its cells run if any tile needs something.
    unsigned across;
    // The reach of a frame is known only when its depth has been looked at: nothing but the first pass runs before.
    int measured;

    // Tables that follow from the parameters. NULL: none.
    int (*prepare)(struct hf_context *c, struct hf_setup *s, const struct hf_params *p);
    // measured: called with what was counted over the frame; sets the reach.
    void (*measure)(struct hf_setup *s, const struct hf_counts *found);
    // measured: called with what the whole first sweep has counted. NULL: nothing follows from it.
    void (*made)(struct hf_setup *s, const struct hf_counts *found);
    // Channels of a buffer; 0: not wanted with these options.
    int (*channels)(const struct hf_setup *s, int buf);
    // Does a pass run with these options? NULL: all do.
    int (*runs)(const struct hf_setup *s, int pass);
    // How far around a pixel a pass reads.
    struct hf_reach (*halo)(const struct hf_setup *s, enum hf_halo halo);
    // A tile needs a field if there is CoC of that kind within this reach.
    struct hf_reach (*spread)(const struct hf_setup *s, const struct hf_plan *p, unsigned field);
    // Fields of the first sweep's buffers that the passes of a tile with these needs read.
    unsigned (*reads)(const struct hf_setup *s, unsigned needs);
    // Size of a sweep's cells, half-resolution pixels; holds the default, widths stay multiples of 16. NULL: the default.
    void (*cell)(const struct hf_setup *s, int sweep, int *width, int *height);
    // Floats of scratch (hf_frame.work) that a pass may use. NULL: none.
    size_t (*work)(const struct hf_setup *s, const struct hf_plan *p);
};

extern const struct hf_engine_def hf_gather_engine, hf_hexagon_engine, hf_scatter_engine, hf_gaussian_engine;
// Reaches and taps of the gather: its prepare, for a setup whose taps are anyone's.
int hf_gather_setup(struct hf_setup *s, const struct hf_params *p, const struct hf_mem *mem);

// NULL for a number that is no engine.
const struct hf_engine_def *hf_engine_def(enum hf_engine engine);

#endif
