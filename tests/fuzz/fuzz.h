// SPDX-License-Identifier: BSD-3-Clause
// Fuzz targets: each is a function of bytes, which libFuzzer makes up or replay.c takes from files. What is wrong is an
// abort, a sanitizer's report, or time and memory beyond the limits given on the command line.
#ifndef HF_TESTS_FUZZ_H
#define HF_TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ADDRESS_SANITIZER
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define ADDRESS_SANITIZER
#endif

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
// Set by replay.c when it makes many random inputs: most of them should be small.
__attribute__((weak)) int fuzz_small;
// A target may define this to print its counts when replay.c is done.
__attribute__((weak)) void fuzz_told(void);

// Bytes as a source of choices; zeros when they are used up.
struct bytes {
    const uint8_t *data;
    size_t size;
};

static inline unsigned take_byte(struct bytes *b)
{
    if (!b->size)
        return 0;
    b->size--;
    return *b->data++;
}

static inline uint32_t take_word(struct bytes *b)
{
    uint32_t v = 0;
    for (int i = 0; i < 4; i++)
        v = v << 8 | take_byte(b);
    return v;
}

// A condition that must hold for any input.
#define MUST(ok)                                                                                                       \
    do {                                                                                                               \
        if (!(ok)) {                                                                                                   \
            fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #ok);                                           \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

#endif
