// SPDX-License-Identifier: BSD-3-Clause
// What AVX-512 would do, for CPUs without it: immintrin.h beside this file does the instructions in plain C, and the
// kernels are compiled over it (tests/kernels/meson.build). Here: does it do what the instructions do?
#include <math.h>

#include "pixel/format_vf.h"

#if HF_FUSED
int emulated_check_vectors(void);

static const float special[16] = {0.0f,       -0.0f,      1.5f,       -1.5f,      __builtin_inff(), -__builtin_inff(),
                                  NAN,        1e-40f,     -1e-45f,    65519.996f, 65520.0f,         -65504.0f,
                                  0x1.004p0f, 0x1.00cp0f, 0x1.8p-25f, 3e9f};

static float lane(vf v, int i)
{
    float f[VF_N];
    vf_store(f, v);
    return f[i];
}

static int same(float a, float b)
{
    return hf_bits(a) == hf_bits(b) || (a != a && b != b);
}

// Comparisons and what is made of them: of two NaN or two zeros the second operand, false for NaN, true for "not
// equal".
static int wrong_pair(float a, float b)
{
    const vf x = vf_set1(a), y = vf_set1(b);
    return !same(lane(vf_max(x, y), 3), a > b ? a : b) + !same(lane(vf_min(x, y), 3), a < b ? a : b) +
           (vf_gt(x, y) != (a > b ? 0xffff : 0)) + (vf_lt(x, y) != (a < b ? 0xffff : 0)) +
           (vf_le(x, y) != (a <= b ? 0xffff : 0)) + (vf_eq(x, y) != (a == b ? 0xffff : 0)) +
           (vf_ne(x, y) != (a != b ? 0xffff : 0)) +
           !same(lane(vf_muladd_fused(x, y, vf_set1(1)), 5), __builtin_fmaf(a, b, 1));
}

// Every half to float and back; ties, overflow and underflow.
static int wrong_halves(void)
{
    static const uint16_t want[16] = {0,      0x8000, 0x3e00, 0xbe00, 0x7c00, 0xfc00, 0x7e00, 0,
                                      0x8000, 0x7bff, 0x7c00, 0xfbff, 0x3c01, 0x3c03, 0x0001, 0x7c00};
    uint16_t h[16];
    vf_store_half(h, vf_load(special));
    int wrong = memcmp(h, want, sizeof h) != 0;
    for (unsigned i = 0; i < 65536; i += 16) {
        uint16_t in[16];
        for (unsigned k = 0; k < 16; k++)
            in[k] = (uint16_t)(i + k);
        const vf v = vf_load_half(in);
        vf_store_half(h, v);
        for (int k = 0; k < 16; k++) {
            const int nan = (in[k] & 0x7fff) > 0x7c00, infinite = (in[k] & 0x7fff) == 0x7c00;
            wrong += h[k] != (nan ? in[k] | 0x200 : in[k]);
            wrong += !nan && !infinite && !same(lane(v, k), hf_half_unpack(in[k]));
        }
    }
    return wrong;
}

static int wrong_roundings(void)
{
    static const int32_t whole[16] = {0, 0,     1,     -1,     INT32_MIN, INT32_MIN, INT32_MIN, 0,
                                      0, 65519, 65520, -65504, 1,         1,         0,         INT32_MIN};
    int32_t got[16];
    vi_store(got, vf_to_vi(vf_load(special)));
    int wrong = memcmp(got, whole, sizeof got) != 0;
    for (int i = 0; i < 16; i++)
        wrong += !same(lane(vf_floor(vf_load(special)), i), __builtin_floorf(special[i])) +
                 !same(lane(vf_abs(vf_load(special)), i), __builtin_fabsf(special[i])) +
                 !same(lane(vi_to_vf(vi_set1((int32_t)(i * 123456789u))), i), (float)(int32_t)(i * 123456789u));
    return wrong;
}

// special[15], then special without its last number.
static int wrong_back(void)
{
    const vf v = vf_back(vf_load(special), vf_add(vf_load(special), vf_zero()));
    int wrong = 0;
    for (int i = 0; i < 16; i++)
        wrong += !same(lane(v, i), i ? special[i - 1] + 0 : special[15]);
    return wrong;
}

static int wrong_bytes(void)
{
    uint8_t in[128], out[64];
    uint16_t words[32];
    uint32_t wide[16];
    for (int i = 0; i < 128; i++)
        in[i] = (uint8_t)(37 * i);
    const vi a = vi_load(in), b = vi_load(in + 64);
    vi_store(out, vi_align(a, b, 5));
    int wrong = memcmp(out, in + 5, 64) != 0;
    vi_store(out, vi_align(a, b, 20));
    wrong += memcmp(out, in + 20, 64) != 0;
    vi_store(words, vi_mulhi16(vi_set16(50000), vi_set16(60001)));
    vi_store(wide, vi_load_u8(in));
    vi_store_u8(out, vi_load_u8(in));
    wrong += memcmp(out, in, 16) != 0;
    for (int i = 0; i < 16; i++)
        wrong += (words[2 * i + 1] != (50000u * 60001u) >> 16) + (wide[i] != in[i]);
    return wrong;
}

int emulated_check_vectors(void)
{
    int wrong = wrong_halves() + wrong_roundings() + wrong_back() + wrong_bytes();
    for (int i = 0; i < 16; i++)
        for (int k = 0; k < 16; k++)
            wrong += wrong_pair(special[i], special[k]);
    return wrong;
}
#endif
