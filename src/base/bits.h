// SPDX-License-Identifier: BSD-3-Clause
// Runs of bits, each of which stands for a place in a row.
#ifndef HF_BITS_H
#define HF_BITS_H

#include <stdint.h>

// Bits x0 to x1 - 1.
struct hf_bit_run {
    int x0, x1;
};

// The first run of set bits, which are cleared; there must be one. A carry runs through it.
static inline struct hf_bit_run hf_next_bits(uint64_t *bits)
{
    const uint64_t begins = *bits & -*bits, ends = (*bits + begins) & ~*bits;
    *bits &= ends ? -ends : 0;
    return (struct hf_bit_run){__builtin_ctzll(begins), ends ? __builtin_ctzll(ends) : 64};
}

#endif
