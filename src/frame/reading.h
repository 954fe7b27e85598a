// SPDX-License-Identifier: BSD-3-Clause
// Between surfaces.c and deep.c: how several samples of a pixel become a picture and what it hides.
#ifndef HF_READING_H
#define HF_READING_H

#include "frame/surfaces.h"

// Rows of a piece of work; planes of what samples are merged into: 6 of each surface, colour and radius, and the rest's radius.
enum { HF_READING_ROWS = 16, HF_MERGED_PLANES = 6 * (HF_MOST_BEHIND + 1) + 6 };

struct hf_reading {
    struct hf_context *c;
    const struct hf_setup *s;
    const struct hf_surface_input *in;
    const struct hf_setup *setup;  // of each surface
    struct hf_known *known;
    int fused, pieces, count;  // count of merged layers
    size_t line_floats, worker_lines, plane;
    float *picture[5], empty;  // merged: colour and radius; the radius of nothing
    float *lines;
    struct hf_counts *counts;  // of each worker
};

// A sample of a pixel: colour premultiplied.
struct hf_sample {
    float radius, alpha, colour[4];
};

// Place memory for planes of the frame's size and for the workers, with more_lines scratch rows for each. setup: of each of
// count surfaces. Returns the first plane, or NULL.
float *hf_reading_begin(struct hf_reading *r, struct hf_setup *setup, int count, size_t planes, size_t more_lines);
// A frame that reads one surface.
struct hf_frame hf_reading_frame(const struct hf_reading *r, int surface, int worker);
// Place what pixels are merged into, in HF_MERGED_PLANES planes.
void hf_reading_merged(struct hf_reading *r, float *memory, struct hf_merged *merged);
// Merge n samples of a pixel, nearest first: what is visible, the front surface and the rest, and what the front hides.
void hf_merge_pixel(const struct hf_reading *r, const struct hf_sample *samples, int n, ptrdiff_t at,
                    struct hf_counts *counts);
// Do all pieces. Returns HF_OK or HF_ERR_CANCELLED.
int hf_reading_finish(struct hf_reading *r, int pieces, void (*piece)(void *arg, int i, int worker));

#endif
