// SPDX-License-Identifier: BSD-3-Clause
// 16-bit floats, exact both ways: NaN payloads and denormals survive the way to float, and back rounds to
// nearest even.
#ifndef HF_IO_HALF_H
#define HF_IO_HALF_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#define HF_HALF_MAX 65504.0f

static inline uint32_t hf_io_float_bits(float f)
{
    uint32_t u;
    memcpy(&u, &f, sizeof(u));
    return u;
}

static inline float hf_io_bits_float(uint32_t u)
{
    float f;
    memcpy(&f, &u, sizeof(f));
    return f;
}

static inline float hf_io_from_half(uint16_t h)
{
    const uint32_t sign = (uint32_t)(h & 0x8000u) << 16;
    const uint32_t rest = (uint32_t)(h & 0x7fffu) << 13;
    const uint32_t exponent = rest & 0x0f800000u;
    if (exponent == 0x0f800000u)  // Inf, NaN
        return hf_io_bits_float(sign | 0x7f800000u | rest);
    if (exponent == 0)  // zero, denormal: exact in float
        return hf_io_bits_float(sign | hf_io_float_bits((float)(rest >> 13) * 0x1p-24f));
    return hf_io_bits_float(sign | (rest + (112u << 23)));
}

// NaN becomes 0, what is larger than a half can hold becomes +-65504 and adds one to *clamped.
static inline uint16_t hf_io_to_half(float f, uint64_t *clamped)
{
    const uint32_t bits = hf_io_float_bits(f);
    const uint16_t sign = (uint16_t)(bits >> 16 & 0x8000u);
    const float a = hf_io_bits_float(bits & 0x7fffffffu);
    if (isnan(f))
        return 0;
    if (a > HF_HALF_MAX) {
        ++*clamped;
        return sign | 0x7bffu;
    }
    if (a < 0x1p-14f)  // denormal: adding 0.5 rounds at the last bit of the half
        return (uint16_t)(sign | (hf_io_float_bits(a + 0.5f) - 0x3f000000u));
    const uint32_t u = hf_io_float_bits(a);
    return (uint16_t)(sign | ((u + 0xfffu + (u >> 13 & 1u) - (112u << 23)) >> 13));
}

#endif
