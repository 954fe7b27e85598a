// SPDX-License-Identifier: BSD-3-Clause
// Single numbers of the small formats: half floats and the unsigned 11 and 10-bit floats of R11G11B10F. All have 5
// exponent bits biased by 15. Encoders never make NaN or infinity: they clamp, and NaN becomes 0.
#ifndef HF_SMALL_FLOAT_H
#define HF_SMALL_FLOAT_H

#include <stdint.h>
#include <string.h>

#define HF_HALF_MAX 65504.0f
#define HF_R11_MAX 65024.0f  // 6 mantissa bits
#define HF_R10_MAX 64512.0f  // 5

static inline uint32_t hf_bits(float f)
{
    uint32_t u;
    memcpy(&u, &f, 4);
    return u;
}

static inline float hf_from_bits(uint32_t u)
{
    float f;
    memcpy(&f, &u, 4);
    return f;
}

// Whether f is neither NaN nor infinite.
static inline int hf_is_finite(float f)
{
    return (hf_bits(f) & 0x7f800000) != 0x7f800000;
}

// Decode an unsigned float with 5 exponent and m mantissa bits in the low bits of u. Shifted so that the exponents line
// up, it is a float 2^112 times too small, denormals included. Infinity and NaN become 65536 and more, which no finite
// value reaches.
static inline float hf_decode_small(uint32_t u, int m)
{
    return hf_from_bits(u << (23 - m)) * 0x1p112f;
}

// Encode, rounding to nearest even. v is 0 to the largest finite value. Below 2^-14 the result is denormal: adding a
// power of two whose last place is the denormals' step makes the addition round.
static inline uint32_t hf_encode_small(float v, int m)
{
    if (v < 0x1p-14f) {
        const float magic = hf_from_bits((uint32_t)(127 + 23 - 14 - m) << 23);
        return hf_bits(v + magic) - hf_bits(magic);
    }
    const uint32_t u = hf_bits(v) - (112u << 23), shift = 23 - m;
    return (u + (1u << (shift - 1)) - 1 + (u >> shift & 1)) >> shift;
}

// Encode, rounding towards zero.
static inline uint32_t hf_truncate_small(float v, int m)
{
    if (v < 0x1p-14f)
        return (uint32_t)(v * (float)(1 << (14 + m)));
    return (hf_bits(v) - (112u << 23)) >> (23 - m);
}

static inline float hf_clamp_unsigned(float v, float max)
{
    v = v > 0 ? v : 0;  // NaN becomes 0, too
    return v < max ? v : max;
}

static inline uint32_t hf_r11_pack(float r, float g, float b)
{
    return hf_encode_small(hf_clamp_unsigned(r, HF_R11_MAX), 6) |
           hf_encode_small(hf_clamp_unsigned(g, HF_R11_MAX), 6) << 11 |
           hf_encode_small(hf_clamp_unsigned(b, HF_R10_MAX), 5) << 22;
}

static inline void hf_r11_unpack(uint32_t u, float *r, float *g, float *b)
{
    *r = hf_decode_small(u & 0x7ff, 6);
    *g = hf_decode_small(u >> 11 & 0x7ff, 6);
    *b = hf_decode_small(u >> 22, 5);
}

static inline float hf_half_unpack(uint16_t h)
{
    const float v = hf_decode_small(h & 0x7fff, 10);
    return h & 0x8000 ? -v : v;
}

static inline uint16_t hf_half_pack(float v)
{
    const uint32_t sign = v == v ? hf_bits(v) >> 16 & 0x8000 : 0;
    const float a = hf_clamp_unsigned(hf_from_bits(hf_bits(v) & 0x7fffffff), HF_HALF_MAX);
    return (uint16_t)(sign | hf_encode_small(a, 10));
}

#endif
