// SPDX-License-Identifier: BSD-3-Clause
// Rendering for the tests, and questions about the resulting pictures. A call that fails is a failed check.
#ifndef HF_TESTS_RENDER_H
#define HF_TESTS_RENDER_H

#include "support/random_scene.h"

// A context whose memory is filled with NaN. Tile sizes 0: the library chooses.
struct hf_context *context_new(enum hf_isa isa, int threads, int tile_width, int tile_height);

// Render into a picture of that size, in place if both are the same. Returns hf_render's result, without a check.
int try_render(struct hf_context *c, struct picture *out, const struct picture *colour, const struct hf_depth *depth,
               const struct hf_params *p);
int try_scene(struct hf_context *c, struct picture *out, const struct scene *s, const struct hf_params *p);
struct picture render(struct hf_context *c, const struct picture *colour, const struct hf_depth *depth,
                      const struct hf_params *p);
struct picture render_scene(struct hf_context *c, const struct scene *s, const struct hf_params *p);
// Depth that gives each pixel's radius in pixels, near negative.
struct hf_depth picture_radii(const struct picture *radii);
// Set the engine of parameters whose .chapter is set: the gather with the same options where fill is HF_FILL_MEAN and no other
// option is the chapter's alone; else the chapter.
void choose_fields(struct hf_params *p);
// Render with any such radii, with an engine that has half-resolution buffers.
struct picture render_radii(struct hf_context *c, enum hf_engine engine, const struct picture *colour,
                            const struct picture *radii, int half);

size_t samples_of(const struct picture *p);  // in one plane
int all_finite(const struct picture *p);
double largest_sample(const struct picture *p);  // the largest magnitude of the finite ones
double largest_difference(const struct picture *a, const struct picture *b);  // NaN if either picture has one
int samples_other(const struct picture *a, const struct picture *b);          // how many differ in bits
struct picture picture_transposed(const struct picture *p);
void picture_fill(struct picture *p, int channel, float value);

#endif
