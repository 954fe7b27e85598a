// SPDX-License-Identifier: BSD-3-Clause
//
// A look inside a frame, for benchmarks, viewers and tests. This header is not stable: it may change in any release,
// and HF_ABI_VERSION does not change with it. The library exports its functions under a symbol version of the release,
// so that a program that uses them does not start with another release.
//
// Structs begin with their size and sizes are checked as in hyperfocal.h. Texts live as long as the library.
#ifndef HYPERFOCAL_INSPECT_H
#define HYPERFOCAL_INSPECT_H

#include "hyperfocal.h"

#ifdef __cplusplus
extern "C" {
#endif

// What a scene asks of a tile: no blur, near blur, far blur or both.
enum hf_tile { HF_TILE_SHARP, HF_TILE_NEAR, HF_TILE_FAR, HF_TILE_BOTH };

// The name of an engine's pass, in the order in which passes run; those of HF_ENGINE_CHAPTER are the names in the
// chapter's table 3.1. NULL for numbers that are none.
HF_API const char *hf_inspect_pass_name(enum hf_engine engine, int pass);

// More of what hf_get_report tells.
struct hf_inspect_report {
    size_t size;                  // sizeof(struct hf_inspect_report)
    int tile_width, tile_height;  // full-resolution pixels
    int columns, rows;            // of tiles, see hf_inspect_tiles
    uint32_t tile_count[4];       // by enum hf_tile
    int passes;                   // of the engine, see hf_inspect_get_pass
    // layers: how many slices lie between the radii, at full, half, a quarter and an eighth of the resolution; and at
    // how many distances, each twice the one before, it looks for hidden samples.
    int slices[4], hidden_levels;
    // Colour where it is read for blurring. Known (colour_known is 1) only after hf_inspect_colour.
    int colour_known;
    float brightest;  // largest finite sample of R, G and B
    int opaque;       // 1: no alpha below 1
    uint32_t reserved;
    uint64_t not_finite;         // samples, repaired before use
    uint64_t memory_saved;       // bytes that no_skip would need besides
    double plan_ms;              // time for planning, without the look at the depth
    const char *budget_options;  // the command's words for the setting that the budget chose; NULL: as asked for
};

// The frame of hf_get_report. Errors: HF_ERR_ARG.
HF_API int hf_inspect_get_report(struct hf_context *c, struct hf_inspect_report *report);

// A pass of that frame: on how many tiles it runs, and what it costs.
struct hf_inspect_pass {
    size_t size;          // sizeof(struct hf_inspect_pass)
    const char *name;     // see hf_inspect_pass_name
    const char *skipped;  // why the other tiles do without; NULL if all run
    uint32_t run, all;    // tiles (chunks in the first sweep) that call for the pass, of how many
    uint32_t ran;         // tiles that ran it; 0 in a plan
    uint32_t reserved;
    double predicted_ms;  // expected time in the pass over the number of threads, from earlier frames or a table
    double ms;            // the time that it took; 0 in a plan
};

// Errors: HF_ERR_ARG, also for a pass that the frame does not have.
HF_API int hf_inspect_get_pass(struct hf_context *c, int pass, struct hf_inspect_pass *report);

// Copy that frame's tiles: enum hf_tile, row by row from the top left, as many as there are or fit into size bytes.
// Returns how many there are, columns * rows; 0 where the report is 0.
HF_API size_t hf_inspect_tiles(const struct hf_context *c, uint8_t *tiles, size_t size);

// 1: look at the colour of what is blurred from now on, for the report, which takes time. 0 (default): do not.
HF_API void hf_inspect_colour(struct hf_context *c, int on);

// An intermediate buffer: planes of floats.
struct hf_inspect_buffer {
    size_t size;  // sizeof(struct hf_inspect_buffer), the library's
    // gather and chapter: coc, coc4, cocmaxx, cocmax, cocblurx, cocblur, color4, colormulcoc4, near, far; gather also
    // colormulnear4, farpart and cover; chapter also nearfill and farfill. layers: samples, each a buffer of colour
    // and, with "at" behind its name, one of weight and radius, and of seen a third channel, the share drawn as a
    // highlight: seen, one for each pixel; mixed, the back one of an edge's pixel; quads, the farthest of four; hidden
    // and beyond, what surfaces hide; second and third, the same with known surfaces. A sample of weight 0 is none. And
    // slices: the place of the sample that is seen among the slices, 0 for the nearest, with fractions between two.
    const char *name;
    int width, height;  // full, half or quarter resolution
    int channels;       // 1 to 4: near and far CoC, one CoC, or R, G, B and perhaps A
    uint32_t reserved;
    const float *data[4];  // planes, one for each channel
    ptrdiff_t stride;      // bytes from one row to the next, the same for all channels
};

// From now on call fn with every intermediate buffer of each frame, after the frame; NULL ends it. A frame then runs as
// with no_skip, pass by pass over whole buffers: same bits, more time and memory. The buffers live until fn returns.
HF_API void hf_inspect_dump(struct hf_context *c, void (*fn)(void *cookie, const struct hf_inspect_buffer *buffer),
                            void *cookie);

// More of what hf_choose_quality and hf_choose_error tell.
struct hf_inspect_choice {
    size_t size;      // sizeof(struct hf_inspect_choice)
    int step, steps;  // of the ladder: 0 is the cheapest, of how many
    int passed;       // steps that were good enough and were passed over, see hf_choice.why
    uint32_t reserved;
    const char *options;   // the command's words for the step
    const char *measured;  // when and on what machine the ladder was measured
};

// What hf_choose_quality (error 0) or else hf_choose_error chooses for the same arguments; *params stays as it is.
// Errors: HF_ERR_ARG.
HF_API int hf_inspect_get_choice(int height, const struct hf_depth *depth, const struct hf_params *params,
                                 enum hf_quality quality, float error, struct hf_inspect_choice *choice);

#ifdef __cplusplus
}
#endif

#endif
