// SPDX-License-Identifier: BSD-3-Clause
// Single samples of images and of narrow buffers.
#ifndef HF_FORMAT_H
#define HF_FORMAT_H

#include <stdint.h>
#include <string.h>

#include "base/small_float.h"
#include "hyperfocal/hyperfocal.h"

enum { HF_FORMAT_COUNT = HF_FORMAT_RGBA16 + 1, HF_DEPTH_FORMAT_COUNT = HF_DEPTH_FORMAT_X8D24 + 1 };

// A sample of a narrow buffer (frame.h), 0..1, as a float that the storage holds exactly.
static inline float hf_narrow_load(enum hf_storage storage, const void *p)
{
    float v;
    uint16_t half;
    if (storage == HF_STORAGE_PACKED)
        return (float)*(const uint8_t *)p * (1 / 255.0f);
    if (storage == HF_STORAGE_HALF) {
        memcpy(&half, p, sizeof half);
        return hf_half_unpack(half);
    }
    memcpy(&v, p, sizeof v);
    return v;
}

// Store v, rounded to nearest.
static inline void hf_narrow_store(enum hf_storage storage, void *p, float v)
{
    if (storage == HF_STORAGE_PACKED) {
        *(uint8_t *)p = (uint8_t)(v * 255 + 0.5f);
    } else if (storage == HF_STORAGE_HALF) {
        const uint16_t half = hf_half_pack(v);
        memcpy(p, &half, sizeof half);
    } else {
        memcpy(p, &v, sizeof v);
    }
}

// Channel c (0..3) of pixel (x, y), as the row kernels read it; a missing alpha is 1. A value that is not finite stays
// so.
float hf_sample(const struct hf_image *image, int c, int x, int y);
// Overwrite that sample, rounded to the format.
void hf_put_sample(const struct hf_image *image, int c, int x, int y, float v);
// v rounded to what the format holds in channel c.
float hf_round_to_format(enum hf_format format, int c, float v);

// 4 if the image has alpha, else 3.
int hf_image_channels(const struct hf_image *image);
// Bytes of a row of n pixels in one plane.
size_t hf_row_bytes(enum hf_format format, int n);
int hf_plane_count(const struct hf_image *image);

#endif
