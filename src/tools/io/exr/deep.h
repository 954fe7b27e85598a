// SPDX-License-Identifier: BSD-3-Clause
// Deep parts: any number of samples in a pixel.
#ifndef HF_IO_EXR_DEEP_H
#define HF_IO_EXR_DEEP_H

#include "tools/io/exr/exr.h"

// The samples of a part's pixels: those of pixel i, row after row, are first[i] to first[i + 1] - 1 of each array.
struct hf_exr_samples {
    uint64_t *first;      // width * height + 1
    float *colour[4];     // R, G, B and alpha; a grey picture has three times the same pointer
    float *depth, *back;  // back NULL: there is none
};

// The names of the channels to read: of R, G, B, A and the depth. Without A alpha is 1. Every number of the file is checked
// against the sizes of its chunks before memory is taken. Returns 0, or -1 with *err filled; free it in either case.
int hf_exr_read_deep(struct hf_exr *e, const struct hf_io_view *view, const struct hf_io_run *run,
                     struct hf_exr_samples *to, struct hf_io_error *err);
void hf_exr_free_deep(struct hf_exr_samples *s);
double hf_exr_deep_bytes(const struct hf_exr_samples *s, size_t pixels);

#endif
