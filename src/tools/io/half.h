// SPDX-License-Identifier: BSD-3-Clause
// Half floats in files, as in base/small_float.h, except that infinity and NaN are read as such, and clamps are
// counted.
#ifndef HF_IO_HALF_H
#define HF_IO_HALF_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "base/small_float.h"

static inline float hf_io_from_half(uint16_t h)
{
    if ((h & 0x7c00) != 0x7c00)
        return hf_half_unpack(h);
    return hf_from_bits((uint32_t)(h & 0x8000) << 16 | 0x7f800000 | (uint32_t)(h & 0x3ff) << 13);
}

// NaN becomes 0; a value too large for a half becomes +-65504 and adds one to *clamped.
static inline uint16_t hf_io_to_half(float f, uint64_t *clamped)
{
    *clamped += f > HF_HALF_MAX || f < -HF_HALF_MAX;
    return isnan(f) ? 0 : hf_half_pack(f);
}

// Convert n halves as they lie in a file, at any address.
void hf_io_halves_to_floats(float *to, const uint8_t *from, size_t n);
// Adds the number of clamps to *clamped.
void hf_io_floats_to_halves(uint8_t *to, const float *from, size_t n, uint64_t *clamped);

#endif
