// SPDX-License-Identifier: BSD-3-Clause
#include "tools/io/exr/zip.h"

#include <string.h>

#include <libdeflate.h>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

void hf_exr_split(uint8_t *restrict to, uint8_t *restrict scratch, const uint8_t *restrict from, size_t size)
{
    const size_t evens = (size + 1) / 2, pairs = size / 2;
    uint8_t *restrict odd = scratch + evens;
    for (size_t i = 0; i < pairs; i++) {
        scratch[i] = from[2 * i];
        odd[i] = from[2 * i + 1];
    }
    if (size & 1)
        scratch[pairs] = from[size - 1];
    if (size)
        to[0] = scratch[0];
    for (size_t i = 1; i < size; i++)
        to[i] = (uint8_t)(scratch[i] - scratch[i - 1] + 128);
}

// Undo the differences: a running sum of bytes.
static void add_up(uint8_t *p, size_t size)
{
    size_t i = 0;
    uint8_t last = 128;  // makes the first byte itself
#if defined(__SSE2__)
    const __m128i bias = _mm_set1_epi8((char)128);
    __m128i sum = _mm_set1_epi8((char)last);
    for (; i + 16 <= size; i += 16) {
        __m128i v = _mm_sub_epi8(_mm_loadu_si128((const __m128i *)(p + i)), bias);
        v = _mm_add_epi8(v, _mm_slli_si128(v, 1));
        v = _mm_add_epi8(v, _mm_slli_si128(v, 2));
        v = _mm_add_epi8(v, _mm_slli_si128(v, 4));
        v = _mm_add_epi8(v, _mm_slli_si128(v, 8));
        v = _mm_add_epi8(v, sum);
        _mm_storeu_si128((__m128i *)(p + i), v);
        // Copy the last byte to all places.
        const __m128i high = _mm_unpackhi_epi8(v, v);
        sum = _mm_shuffle_epi32(_mm_shufflehi_epi16(high, 0xff), 0xff);
    }
    if (i)
        last = p[i - 1];
#endif
    for (; i < size; i++)
        p[i] = last = (uint8_t)(last + p[i] - 128);
}

void hf_exr_join(uint8_t *restrict to, uint8_t *restrict from, size_t size)
{
    const size_t evens = (size + 1) / 2, pairs = size / 2;
    add_up(from, size);
    const uint8_t *odd = from + evens;
    for (size_t i = 0; i < pairs; i++) {
        to[2 * i] = from[i];
        to[2 * i + 1] = odd[i];
    }
    if (size & 1)
        to[size - 1] = from[pairs];
}

int hf_exr_unzip(struct libdeflate_decompressor *d, uint8_t *to, size_t size, const uint8_t *from, size_t packed,
                 uint8_t *scratch)
{
    if (libdeflate_zlib_decompress(d, from, packed, scratch, size, NULL) != LIBDEFLATE_SUCCESS)
        return -1;
    hf_exr_join(to, scratch, size);
    return 0;
}

enum { STORED = 65535, STORED_HEAD = 5, ZLIB_HEAD = 2, ZLIB_TAIL = 4 };

// Make a zlib stream of the sorted bytes (hf_exr_split) whose first half is stored and whose second half is deflated.
// In noise the first half holds the low bytes, which do not shrink. A deflate block that spans both halves suits
// neither. Returns the stream's size, or 0 if there is no room.
static size_t zip_noise(struct libdeflate_compressor *c, uint8_t *to, size_t room, const uint8_t *sorted, size_t size)
{
    const size_t half = (size + 1) / 2, blocks = (half + STORED - 1) / STORED;
    uint8_t *p = to;
    if (half + blocks * STORED_HEAD + ZLIB_HEAD + ZLIB_TAIL >= room)
        return 0;
    *p++ = 0x78;  // deflate with a window of 32 KB
    *p++ = 0x01;  // makes both bytes a multiple of 31
    for (size_t at = 0; at < half; at += STORED) {
        const size_t n = half - at < STORED ? half - at : STORED;
        *p++ = 0;  // a stored block, not the last one
        *p++ = (uint8_t)n;
        *p++ = (uint8_t)(n >> 8);
        *p++ = (uint8_t)~n;
        *p++ = (uint8_t)(~n >> 8);
        memcpy(p, sorted + at, n);
        p += n;
    }
    const size_t left = room - (size_t)(p - to) - ZLIB_TAIL;
    const size_t rest = libdeflate_deflate_compress(c, sorted + half, size - half, p, left);
    if (!rest)
        return 0;
    p += rest;
    const uint32_t sum = libdeflate_adler32(1, sorted, size);
    for (int shift = 24; shift >= 0; shift -= 8)
        *p++ = (uint8_t)(sum >> shift);
    return (size_t)(p - to);
}

size_t hf_exr_zip(struct libdeflate_compressor *c, uint8_t *to, const uint8_t *from, size_t size, uint8_t *scratch)
{
    hf_exr_split(scratch, scratch + size, from, size);
    const size_t packed = size ? libdeflate_zlib_compress(c, scratch, size, to, size) : 0;
    if (size && (!packed || packed > size - size / 10)) {
        const size_t noise = zip_noise(c, scratch + size, (packed ? packed : size) - 1, scratch, size);
        if (noise) {
            memcpy(to, scratch + size, noise);
            return noise;
        }
    }
    return packed < size ? packed : 0;
}
