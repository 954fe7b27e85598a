// SPDX-License-Identifier: BSD-3-Clause
// An engine is a list of passes and of the buffers between them. The plan follows from these tables: which passes run
// where, how large buffers are, which worker does what (frame/plan.c, frame/sweep.c).
//
// To add an engine, make a folder src/engine/NAME with
//     NAME.h      numbers of its passes, buffers and halos; struct hf_NAME, which it computes from parameters and the
//                 depth; struct hf_NAME_kernels, whose first member is struct hf_passes
//     engine.c    the tables below, and HF_CHOOSE_KERNELS(hf_NAME_kernels) (simd/choose.h)
//     *.c         its passes in C, which are the specification; *_simd.h on vectors; simd.c enters these in the table
//     meson.build lists the files
// and add two lines: NAME in src/engine/meson.build, and HF_ENGINE_NAME in enum hf_engine. A pass gets a struct
// hf_frame and a rectangle. It reads buffers, images and depth, and uses f->k for rows of pixels (pixel/kernels.h),
// f->kernels for the engine's own table and f->s->own for the engine's own numbers. It writes only what its row of the
// table lists.
#ifndef HF_ENGINE_H
#define HF_ENGINE_H

#include "base/mem.h"
#include "pass/frame.h"
#include "simd/choose.h"

// The two fields. A mask of these says which a tile needs, which a chunk has CoC of, or which a pass or buffer is for.
enum { HF_NEAR = 1, HF_FAR = 2, HF_FIELDS = HF_NEAR | HF_FAR };

// An engine's table of kernels begins with its passes, in the order of its pass table.
struct hf_passes {
    hf_kernel *pass[HF_MAX_PASSES];
};

struct hf_pass {
    const char *name;
    unsigned reads;   // buffers read at the pixel itself
    unsigned around;  // buffers read in its halo
    unsigned writes;
    unsigned inside;   // scratch buffers of the pass itself, as large as what it writes ...
    unsigned weighed;  // ... and others, larger by its halo
    int halo;          // the engine's number of its halo; 0: none
    int sweep;         // 1: over the input; 2 and more: per cell, from buffers to the output
    unsigned field;    // runs where this field is needed; 0: where either is
    // Estimated cost until it is measured: nanoseconds per half-resolution pixel and field, with AVX-512 at about 3
    // GHz; and the increase per full-resolution pixel of the field's largest radius.
    float ns, ns_radius;
};

struct hf_reach {
    int x, y;  // half-resolution pixels
};

struct hf_buf_def {
    const char *name;  // in dumps; NULL: not shown
    int frame;         // covers the whole frame, or a window of it; 0: a cell of the sweep that writes it
    int x, y;          // log2 of its pixels per half-resolution pixel: 1 is full resolution, 0 half, -1 a quarter
    unsigned field;    // the field that it belongs to; 0: allocated for either
    int bare;          // has no border, because nothing is read beyond the frame
    int narrow;        // samples of hf_narrow_bytes each
};

struct hf_cells;

enum { HF_COST_NUMBERS = 12 };

// Parts of hf_aperture_params that an engine may be able to draw.
enum {
    HF_APERTURE_BLADES = 1,
    HF_APERTURE_ROUNDNESS = 2,
    HF_APERTURE_RING = 4,
    HF_APERTURE_CAT_EYE = 8,
    HF_APERTURE_SQUEEZE = 16,
    HF_APERTURE_PICTURE = 32,
    HF_APERTURE_CHROMATIC = 64,
    HF_APERTURE_ALL = 127,
};

// What an engine accepts of struct hf_params. frame/resolve.c and frame/ladder.c ask for it.
struct hf_engine_limits {
    unsigned aperture;   // the parts of hf_aperture_params that it draws
    int focus_anywhere;  // focuses on infinity if there is no surface at the focus
    const char *width;   // the parameter that sets how wide its blur is, if the radius does not
    // Check the engine's own parameters, replace HF_DERIVE by numbers, and set r->params.max_radius, r->limit and
    // r->sharp where the engine needs other values. asked: the caller's parameters. Returns HF_OK, or an error with one
    // sentence in message (pass/check.h). NULL: it has no parameters.
    int (*check)(struct hf_resolved *r, const struct hf_params *asked, const struct hf_depth *depth, char *message);
    // The largest radius that the engine can blur by, in pixels; p is not checked yet. NULL: any.
    float (*farthest)(const struct hf_params *p);
};

// The engine's table of kernels for one instruction set. frame/context.c calls make.
struct hf_engine_kernels {
    size_t bytes;
    void (*make)(void *table, enum hf_isa isa, int fused);
};

// The engine's own state, `own` in the setup: zero at first, then as the last frame left it. A frame calls these
// functions in this order (frame/render.c).
struct hf_engine_own {
    size_t bytes;
    // Set the numbers that follow from the resolved parameters. It may change s, which all engines share.
    void (*resolve)(void *own, struct hf_setup *s, const struct hf_depth *depth, const struct hf_params *p);
    // Make the tables that follow from the resolved parameters; called if anything is blurred. Returns HF_OK or
    // HF_ERR_MEMORY. NULL: there are none.
    int (*prepare)(void *own, const struct hf_setup *s, const struct hf_params *p, const struct hf_mem *mem);
    // Called if s->measured, with what the first pass counted over the frame. Sets the reach of the blur, and may
    // change how depth becomes CoC. Returns HF_OK or HF_ERR_MEMORY. NULL: s->measured is 0.
    int (*measure)(void *own, struct hf_setup *s, const struct hf_counts *found, const struct hf_mem *mem);
    // Called with what the whole first sweep counted. NULL: the engine does not need it.
    void (*made)(void *own, const struct hf_setup *s, const struct hf_counts *found);
    // Fill in the engine's own part of a report. NULL: it has none.
    void (*tell)(const void *own, struct hf_report *report);
    // Free the memory that own holds; and tell how many bytes it holds. NULL: none.
    void (*release)(void *own, const struct hf_mem *mem);
    size_t (*held)(const void *own);
};

// How far passes reach, and in which cells they run. frame/plan.c and frame/buffers.c call these.
struct hf_engine_plan {
    // Bit i: cells of sweep i are whole rows or columns, so if any tile needs something, all of them run.
    unsigned across;
    // The height of a tile's cell is a multiple of this, in half-resolution rows. 0: any.
    int grain;
    // Channels of a buffer; 0: these options do not need it. NULL: as many as the picture has.
    int (*channels)(const struct hf_setup *s, int buf);
    // Whether a pass runs with these options. NULL: all do.
    int (*runs)(const struct hf_setup *s, int pass);
    // How far around a pixel a pass with this halo reads. Not called for halo 0. NULL: no pass has another.
    struct hf_reach (*halo)(const struct hf_setup *s, int halo);
    // A tile needs a field if any CoC of that field is within this reach. NULL: if the tile itself has any.
    struct hf_reach (*spread)(const struct hf_setup *s, const struct hf_cells *p, unsigned field);
    // The fields of the first sweep's buffers that passes of a tile with these needs (not 0) read. NULL: both.
    unsigned (*reads)(const struct hf_setup *s, unsigned needs);
    // How far around its cells a later sweep reads buffers of the whole frame. NULL: as far as the halos of its passes.
    // Bit i of parts: sweep i, which is `across`, may run only parts of its cells, in steps of 16 columns and 8 rows.
    struct hf_reach (*around)(const struct hf_setup *s, int sweep);
    unsigned parts;
    // Change the size of a sweep's cells, in half-resolution pixels, from the default that *width and *height hold.
    // Widths must stay multiples of 16. NULL: the default.
    void (*cell)(const struct hf_setup *s, int sweep, int *width, int *height);
    // Floats of scratch (hf_frame.work) that a pass may use. NULL: none.
    size_t (*work)(const struct hf_setup *s, const struct hf_cells *p);
};

// The expected cost of passes. frame/cost.c calls these.
struct hf_engine_cost {
    // The factor on a pass's estimated cost, from what was found in the depth. radius: the field's largest, in pixels.
    // NULL: 1.
    float (*times)(const struct hf_setup *s, int pass, unsigned field, float radius);
    // Write the options that change the cost of a unit of work, and return how many: at most HF_COST_NUMBERS. *reach:
    // of the blur. NULL: none do.
    int (*numbers)(const struct hf_setup *s, int numbers[HF_COST_NUMBERS], int *reach);
};

struct hf_engine_def {
    const char *name;  // as on the command line
    const struct hf_pass *passes;
    int pass_count;
    int sweeps;  // sweep 1 goes over chunks: its first pass reads only depth, and counts
    const struct hf_buf_def *bufs;
    int buf_count;
    struct hf_engine_limits limits;
    struct hf_engine_kernels kernels;
    struct hf_engine_own own;
    struct hf_engine_plan plan;
    struct hf_engine_cost cost;
};

static inline int hf_engine_channels(const struct hf_engine_def *e, const struct hf_setup *s, int buf)
{
    return e->plan.channels ? e->plan.channels(s, buf) : s->channels;
}

// Returns NULL if the number is not an engine's.
const struct hf_engine_def *hf_engine_def(enum hf_engine engine);

#endif
