// SPDX-License-Identifier: BSD-3-Clause
// Rendering for the tests, and what is asked of the pictures that come out. A call that fails is a failed check.
#ifndef HF_TESTS_RENDER_H
#define HF_TESTS_RENDER_H

#include "support/random_scene.h"

// A context whose memory comes filled with NaN. Tile sizes 0: the library's choice.
struct hf_context *context_new(enum hf_isa isa, int threads, int tile_width, int tile_height);

// Into a picture of that size; in place if both are one. Returns what hf_render says: no check.
int try_render(struct hf_context *c, struct picture *out, const struct picture *colour, const struct hf_depth *depth,
               const struct hf_params *p);
int try_scene(struct hf_context *c, struct picture *out, const struct scene *s, const struct hf_params *p);
struct picture render(struct hf_context *c, const struct picture *colour, const struct hf_depth *depth,
                      const struct hf_params *p);
struct picture render_scene(struct hf_context *c, const struct scene *s, const struct hf_params *p);
// Every pixel's radius is that of the plane, in pixels, near negative.
struct hf_depth picture_radii(const struct picture *radii);
// By such radii, whatever they are, with an engine that has working buffers of half resolution.
struct picture render_radii(struct hf_context *c, enum hf_engine engine, const struct picture *colour,
                            const struct picture *radii, int half);

size_t samples_of(const struct picture *p);  // of a plane
int all_finite(const struct picture *p);
double largest_sample(const struct picture *p);                               // of the finite ones, its magnitude
double largest_difference(const struct picture *a, const struct picture *b);  // NaN if either holds one
int samples_other(const struct picture *a, const struct picture *b);          // how many have other bits
struct picture picture_transposed(const struct picture *p);
void picture_fill(struct picture *p, int channel, float value);

#endif
