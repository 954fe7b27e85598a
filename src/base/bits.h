// SPDX-License-Identifier: BSD-3-Clause
// Runs of bits, each of which stands for a place in a row, and bytes of a row, eight at a time.
#ifndef HF_BITS_H
#define HF_BITS_H

#include <stdint.h>
#include <string.h>

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

// Eight bytes of a row; the lowest byte is the first.
static inline uint64_t hf_bytes_at(const uint8_t *p)
{
    uint64_t v;
    memcpy(&v, p, sizeof v);
#if defined __BYTE_ORDER__ && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    v = __builtin_bswap64(v);
#endif
    return v;
}

// The number of the first byte that is not 0; there must be one.
static inline int hf_first_byte(uint64_t bytes)
{
    return __builtin_ctzll(bytes) / 8;
}

// Not 0 in the first byte that is 0, and 0 in all before it, so hf_first_byte() of it finds that byte; 0 if there is none. Bytes
// after the first may be wrong, as the subtraction borrows there.
static inline uint64_t hf_zero_bytes(uint64_t bytes)
{
    return (bytes - 0x0101010101010101) & ~bytes & 0x8080808080808080;
}

#endif
