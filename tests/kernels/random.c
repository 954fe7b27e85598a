// SPDX-License-Identifier: BSD-3-Clause
// Random numbers (splitmix64), and values on which floats are known to fail.
#include <math.h>

#include "harness.h"
#include "pixel/pass_c.h"

struct rng rng_from(uint64_t seed, uint64_t stream)
{
    struct rng r = {seed ^ stream * 0xd1342543de82ef95u};
    rng_next(&r);
    return r;
}

uint32_t rng_next(struct rng *r)
{
    uint64_t z = r->state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (uint32_t)((z ^ (z >> 31)) >> 32);
}

int rng_int(struct rng *r, int low, int high)
{
    return low + (int)(((uint64_t)rng_next(r) * (uint64_t)(high - low + 1)) >> 32);
}

int rng_one_in(struct rng *r, int n)
{
    return rng_int(r, 1, n) == 1;
}

float rng_float(struct rng *r, float low, float high)
{
    return low + (high - low) * ((float)(rng_next(r) >> 8) * 0x1p-24f);
}

float random_colour(struct rng *r, enum colours kind)
{
    static const float tiny[] = {0, 0, 1e-45f, 3e-42f, 1e-38f, 1e-30f, 0x1p-24f, 5e-6f};
    static const float huge[] = {65504, 65505, 65024, 1000, 1e6f, 1e20f, 1e30f, 3e4f};
    if (kind == COLOURS_PLAIN)
        return rng_float(r, 0, 1);
    const int what = rng_int(r, 0, 7);
    const float v = what == 0 ? tiny[rng_int(r, 0, 7)] : what == 1 ? huge[rng_int(r, 0, 7)] : rng_float(r, 0, 4);
    return kind == COLOURS_MIXED && rng_one_in(r, 3) ? -v : v;
}

float random_coc(struct rng *r, enum hf_storage storage)
{
    static const float tiny[] = {1e-45f, 1e-40f, 2e-38f, 1e-30f, 1e-9f, 6e-8f, 1e-4f, 0.9999999f};
    const int what = rng_int(r, 0, 11);
    const float t = what < 3 ? 0 : what < 5 ? 1 : what == 5 ? tiny[rng_int(r, 0, 7)] : rng_float(r, 0, 1);
    return hf_round_coc(storage, t);
}

float random_store_value(struct rng *r)
{
    static const float ends[] = {0,          65504,    65519.996f, 65520,    65024,    65023.996f,  65536,    64512,
                                 64511.99f,  0x1p-14f, 0x1p-15f,   0x1p-20f, 0x1p-19f, 0x1p-21f,    0x1p-24f, 0x1p-25f,
                                 0x1.8p-24f, 1e-45f,   1e-38f,     3.4e38f,  1e10f,    0x1.ffep-15f};
    const int what = rng_int(r, 0, 7);
    const uint32_t exponent = (uint32_t)rng_int(r, 98, 144), mantissa = rng_next(r);
    float v;
    switch (what) {
    case 0:
        v = ends[rng_int(r, 0, (int)(sizeof ends / sizeof *ends) - 1)];
        break;
    case 1:  // ties of 5, 6 and 10 mantissa bits
        v = hf_from_bits(exponent << 23 | (mantissa & 0x7f0000));
        break;
    case 2:
        v = hf_from_bits(exponent << 23 | (mantissa & 0x7ff000));
        break;
    case 3:
        v = rng_one_in(r, 4) ? INFINITY : hf_from_bits(mantissa & 0x7f7fffff);
        break;
    case 4:
        if (rng_one_in(r, 4))
            return NAN;
        v = rng_float(r, 0, 70000);
        break;
    default:
        v = rng_float(r, 0, 2);
    }
    return rng_one_in(r, 5) ? -v : v;
}
