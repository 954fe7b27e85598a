// SPDX-License-Identifier: BSD-3-Clause
// An engine is a list of passes and of the buffers between them. Everything else, which passes run where, how large the
// buffers are, who works on what, follows from these tables (frame/plan.c, frame/sweep.c).
//
// To add one: a folder src/engine/NAME with
//     NAME.h      its passes, buffers and halos, numbered; struct hf_NAME, what it makes of its parameters and finds in
//                 the depth; struct hf_NAME_kernels, whose first member is struct hf_passes
//     engine.c    the tables below, and HF_CHOOSE_KERNELS(hf_NAME_kernels) (simd/choose.h)
//     *.c         its passes in C, the specification, and *_simd.h on vectors; simd.c enters these in the table
//     meson.build lists the files
// then two lines: NAME in src/engine/meson.build, and HF_ENGINE_NAME in enum hf_engine. A pass gets a struct hf_frame and a
// rectangle: its buffers, the images, the depth, f->k for rows of pixels (pixel/kernels.h), f->kernels for the engine's own
// table and f->s->own for its own numbers. It writes what its row of the table says, and nothing else.
#ifndef HF_ENGINE_H
#define HF_ENGINE_H

#include "base/mem.h"
#include "pass/frame.h"
#include "pass/known.h"
#include "pass/report.h"
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
    HF_APERTURE_ALL = 127,
};

// What of struct hf_params an engine takes: called by frame/resolve.c and frame/ladder.c.
struct hf_engine_limits {
    unsigned aperture;   // the parts of hf_aperture_params that it draws
    int focus_anywhere;  // focuses on infinity if there is no surface at the focus
    const char *width;   // the parameter that sets how wide its blur is, if the radius does not
    // Check the engine's own parameters, replace HF_DERIVE by numbers, and set r->params.max_radius, r->limit and
    // r->sharp where the engine needs other values. asked: the caller's parameters. Returns HF_OK, or an error with the
    // message filled (pass/check.h). NULL: it has no parameters.
    int (*check)(struct hf_settings *r, const struct hf_params *asked, const struct hf_depth *depth,
                 struct hf_message *message);
    // The largest radius that the engine can blur by, in pixels; p is not checked yet. NULL: any.
    float (*farthest)(const struct hf_params *p);
};

// Its table of kernels for an instruction set: made by frame/context.c.
struct hf_engine_kernels {
    size_t bytes;
    void (*make)(void *table, enum hf_isa isa, int fused);
};

// What setups call own: zero at first, then what the frame before left. A frame calls these in this order (frame/render.c).
struct hf_engine_own {
    size_t bytes;
    // Set numbers that follow from the resolved parameters. s holds what is common to all engines, and may be changed.
    void (*resolve)(void *own, struct hf_setup *s, const struct hf_depth *depth, const struct hf_params *p);
    // Take surfaces that the caller gives beside the picture, which stay as they are until the frame has ended. Called after
    // resolve, if there are any. NULL: it takes none.
    void (*know)(void *own, const struct hf_known *known);
    // Make tables likewise, if there is anything to blur; returns HF_ERR_MEMORY. NULL: none.
    int (*prepare)(void *own, const struct hf_setup *s, const struct hf_params *p, const struct hf_mem *mem);
    // Called if s->measured, with what the first pass counted over the frame: sets the reach of the blur, and may change how
    // depth becomes CoC. Returns HF_ERR_MEMORY. NULL: s->measured is 0.
    int (*measure)(void *own, struct hf_setup *s, const struct hf_counts *found, const struct hf_mem *mem);
    // Called with what the whole first sweep counted. NULL: nothing follows from it.
    void (*made)(void *own, const struct hf_setup *s, const struct hf_counts *found);
    // Fill in the engine's own part of a report. NULL: it has none.
    void (*tell)(const void *own, struct hf_frame_report *report);
    // For dumps, a row of what own knows of each pixel and no buffer holds, under this name. NULL: nothing.
    const char *shown;
    void (*show)(const void *own, const struct hf_frame *f, int y, float *row);
    // Free the memory that own holds; and tell how many bytes it holds. NULL: none.
    void (*release)(void *own, const struct hf_mem *mem);
    size_t (*held)(const void *own);
};

// How far a frame's passes reach, and in which cells they run: called by frame/plan.c and frame/buffers.c.
struct hf_engine_plan {
    // Bit i: sweep i takes whole rows or columns, so all of its cells run if any tile needs something.
    unsigned across;
    // Rows of a tile's cell are a multiple of this, half-resolution ones. 0: any number.
    int grain;
    int zero_beyond;  // buffers of the whole frame are 0 beyond it; else like its edge
    // Is this buffer of the whole frame 0 beyond it? NULL: as zero_beyond says.
    int (*zero)(const struct hf_setup *s, int buf);
    // Channels of a buffer; 0: not wanted with these options. NULL: the picture's.
    int (*channels)(const struct hf_setup *s, int buf);
    // Does a pass run with these options? NULL: all do.
    int (*runs)(const struct hf_setup *s, int pass);
    // How far around a pixel a pass reads. Not called for 0; NULL: there is no other.
    struct hf_reach (*halo)(const struct hf_setup *s, int halo);
    // A tile needs a field if there is CoC of that kind within this reach. NULL: if it has some itself.
    struct hf_reach (*spread)(const struct hf_setup *s, const struct hf_cells *p, unsigned field);
    // Fields of the first sweep's buffers that the passes of a tile with these needs, which are not 0, read. NULL: both.
    unsigned (*reads)(const struct hf_setup *s, unsigned needs);
    // How far around what a later sweep makes it reads buffers of the whole frame, if not as the halos of its passes say.
    // NULL: as they say. Bit i of parts: a sweep across may make a
    // part of its cells, of columns and rows in steps of 16 and 8, in place of all.
    struct hf_reach (*around)(const struct hf_setup *s, int sweep);
    unsigned parts;
    // Must all cells of the sweep before be done when a cell of this sweep begins? If not, only those must be done that lie
    // within its reach, see around; the sweep must then write nothing that the sweep before reads. NULL: yes, in all sweeps.
    int (*waits)(const struct hf_setup *s, int sweep);
    // Size of a sweep's cells, half-resolution pixels; holds the default, widths stay multiples of 16. NULL: the default.
    void (*cell)(const struct hf_setup *s, int sweep, int *width, int *height);
    // Floats of scratch (hf_frame.work) that a pass may use. NULL: none.
    size_t (*work)(const struct hf_setup *s, const struct hf_cells *p);
};

// What its passes are expected to cost: called by frame/cost.c.
struct hf_engine_cost {
    // How many times a pass costs what its row says, with what was found in the depth; radius: the field's largest, pixels.
    // NULL: once.
    float (*times)(const struct hf_setup *s, int pass, unsigned field, float radius);
    // Options that change what a unit of work costs; returns how many, at most HF_COST_NUMBERS. *reach: of its blur. NULL:
    // there are none.
    int (*numbers)(const struct hf_setup *s, int numbers[HF_COST_NUMBERS], int *reach);
};

struct hf_engine_def {
    const char *name;  // the command line's
    const struct hf_pass *passes;
    int pass_count;
    int sweeps;  // sweep 1 is over chunks: its first pass looks at depth alone and counts what there is
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

// NULL for a number that is no engine.
const struct hf_engine_def *hf_engine_def(enum hf_engine engine);

#endif
