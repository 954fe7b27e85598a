// SPDX-License-Identifier: BSD-3-Clause
// An engine is a list of passes and of the buffers between them. Everything else, which passes run where, how large the
// buffers are, who works on what, follows from these tables (frame/plan.c, frame/sweep.c).
//
// To add one: a folder src/NAME with
//     NAME.h      its passes, buffers and halos, numbered; struct hf_NAME, what it makes of its parameters and finds in
//                 the depth; struct hf_NAME_kernels, whose first member is struct hf_passes
//     engine.c    the tables below, and HF_CHOOSE_KERNELS(hf_NAME_kernels) (simd/choose.h)
//     *.c         its passes in C, the specification, and *_simd.h on vectors; simd.c enters these in the table
//     meson.build lists the files
// then a line in src/frame/engine.c, the folder in src/meson.build, and its number in enum hf_engine. A pass gets a struct
// hf_frame and a rectangle: its buffers, the images, the depth, f->k for rows of pixels (pixel/kernels.h), f->kernels for
// the engine's own table and f->s->own for its own numbers. It writes what its row of the table says, and nothing else.
#ifndef HF_ENGINE_H
#define HF_ENGINE_H

#include "base/mem.h"
#include "pass/frame.h"
#include "simd/choose.h"

// The two fields: what a scene asks of a tile, was found in a chunk, or a pass or buffer serves.
enum { HF_NEAR = 1, HF_FAR = 2, HF_FIELDS = HF_NEAR | HF_FAR };

// An engine's table of kernels begins with its passes, in their order.
struct hf_passes {
    hf_kernel *pass[HF_MAX_PASSES];
};

struct hf_pass {
    const char *name;
    unsigned reads;   // buffers read at the pixel itself
    unsigned around;  // buffers read in its halo
    unsigned writes;
    unsigned inside;   // scratch of the pass itself, as large as what it writes ...
    unsigned weighed;  // ... and larger by the halo
    int halo;          // the engine's number; 0: none
    int sweep;         // 1: over the input; 2 and more: per cell, from buffers to the output
    unsigned field;    // runs where this field is needed; 0: where any is
    // Guess of its cost until it has been measured: nanoseconds per half-resolution pixel and field, with AVX-512 at about
    // 3 GHz, and how much more for each full-resolution pixel of the field's largest radius.
    float ns, ns_radius;
};

struct hf_reach {
    int x, y;  // half-resolution pixels
};

struct hf_buf_def {
    const char *name;  // in dumps; NULL: not shown
    int frame;         // a window of the whole frame; else of a cell of the sweep that writes it
    int x, y;          // log2 of its pixels per half-resolution pixel: 1 is full resolution, 0 half, -1 a quarter
    unsigned field;    // the field that it belongs to; 0: wanted for any
    int shrinks;       // x and y are those at full resolution, and smaller with the setup's
    int bare;          // nothing is read beyond the frame: no border
    int narrow;        // of hf_narrow_bytes a sample
};

struct hf_cells;

enum { HF_COST_NUMBERS = 12 };

// What of hf_aperture_params an engine can draw.
enum {
    HF_APERTURE_BLADES = 1,
    HF_APERTURE_ROUNDNESS = 2,
    HF_APERTURE_RING = 4,
    HF_APERTURE_CAT_EYE = 8,
    HF_APERTURE_SQUEEZE = 16,
    HF_APERTURE_PICTURE = 32,
    HF_APERTURE_CHROMATIC = 64,
};

struct hf_engine_def {
    const char *name;  // the command line's
    unsigned aperture;
    const char *width;   // what says how wide its blur is, if it is not the radius
    int focus_anywhere;  // where there is no surface to focus on, it focuses on infinity
    const struct hf_pass *passes;
    int pass_count;
    int sweeps;  // sweep 1 is over chunks: its first pass looks at depth alone and counts what there is
    const struct hf_buf_def *bufs;
    int buf_count;
    // Bit i: sweep i takes whole rows or columns, so all of its cells run if any tile needs something.
    unsigned across;
    // Rows of a tile's cell are a multiple of this, half-resolution ones. 0: any number.
    int grain;
    // The reach of a frame is known only when its depth has been looked at: nothing but the first pass runs before. An
    // engine of which that holds with some parameters has resolve set the setup's.
    int measured;

    // Its table of kernels, for an instruction set.
    size_t kernels_bytes;
    void (*kernels)(void *table, enum hf_isa isa, int fused);

    // Check its own parameters, put numbers where they say HF_DERIVE, and change r->params.max_radius, r->limit and
    // r->sharp if they are others for this engine; asked: what was given. Returns HF_OK, or an error with one sentence in
    // message (params.h). NULL: it has no parameters.
    int (*check)(struct hf_resolved *r, const struct hf_params *asked, const struct hf_depth *depth, char *message);

    // The largest radius that it blurs by with parameters that it has not checked yet, pixels. NULL: any.
    float (*farthest)(const struct hf_params *p);

    // What setups call own: zero at first, then as prepare left it for the frame before. It owns memory until release.
    size_t own_bytes;
    // Numbers that follow from the parameters, which are resolved; s holds what is common to all engines, and may be
    // changed. NULL: none.
    void (*resolve)(void *own, struct hf_setup *s, const struct hf_depth *depth, const struct hf_params *p);
    // Tables likewise, if there is anything to blur; returns HF_ERR_MEMORY. NULL: none.
    int (*prepare)(void *own, const struct hf_setup *s, const struct hf_params *p, const struct hf_mem *mem);
    void (*release)(void *own, const struct hf_mem *mem);
    size_t (*bytes)(const void *own);  // of that memory
    // measured: called with what was counted over the frame; sets the reach, and may change how depth becomes CoC.
    // Returns HF_ERR_MEMORY.
    int (*measure)(void *own, struct hf_setup *s, const struct hf_counts *found, const struct hf_mem *mem);
    // What it tells of itself in a report. NULL: nothing.
    void (*tell)(const void *own, struct hf_report *report);
    // measured: called with what the whole first sweep has counted. NULL: nothing follows from it.
    void (*made)(void *own, const struct hf_setup *s, const struct hf_counts *found);

    // Channels of a buffer; 0: not wanted with these options.
    int (*channels)(const struct hf_setup *s, int buf);
    // Does a pass run with these options? NULL: all do.
    int (*runs)(const struct hf_setup *s, int pass);
    // How far around a pixel a pass reads. Not called for 0.
    struct hf_reach (*halo)(const struct hf_setup *s, int halo);
    // A tile needs a field if there is CoC of that kind within this reach.
    struct hf_reach (*spread)(const struct hf_setup *s, const struct hf_cells *p, unsigned field);
    // Fields of the first sweep's buffers that the passes of a tile with these needs read.
    unsigned (*reads)(const struct hf_setup *s, unsigned needs);
    // Size of a sweep's cells, half-resolution pixels; holds the default, widths stay multiples of 16. NULL: the default.
    void (*cell)(const struct hf_setup *s, int sweep, int *width, int *height);
    // Floats of scratch (hf_frame.work) that a pass may use. NULL: none.
    size_t (*work)(const struct hf_setup *s, const struct hf_cells *p);

    // How many times a pass costs what its row says, with what was found in the depth; radius: the field's largest, pixels.
    // NULL: once.
    float (*times)(const struct hf_setup *s, int pass, unsigned field, float radius);
    // Options that change what a unit of work costs; returns how many, at most HF_COST_NUMBERS. *reach: of its blur.
    int (*cost)(const struct hf_setup *s, int numbers[HF_COST_NUMBERS], int *reach);
};

// NULL for a number that is no engine.
const struct hf_engine_def *hf_engine_def(enum hf_engine engine);

#endif
