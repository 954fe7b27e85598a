// SPDX-License-Identifier: BSD-3-Clause
// Structs that cross the border between programs and library: each begins with its size, and the program's may be of an older
// or a newer release. Every function copies them by these two, and works on copies of its own size.
#ifndef HF_SIZED_H
#define HF_SIZED_H

#include "hyperfocal/hyperfocal.h"

struct hf_sized {
    const char *name;   // "hf_params"
    size_t own, first;  // bytes in this release, and in the first one that programs may be compiled for
};

extern const struct hf_sized hf_sized_choice, hf_sized_config, hf_sized_depth, hf_sized_image, hf_sized_message,
    hf_sized_params, hf_sized_region, hf_sized_report, hf_sized_resolved;

// The entry of a struct whose last field in the first release was last.
#define HF_SIZED(type, last)                                                                                           \
    {                                                                                                                  \
#type, sizeof(struct type), offsetof(struct type, last) + sizeof((struct type *)0)->last                       \
    }

// 1: a release may have a struct of this size, so what the first release has is there to be read. 0: only its size is.
int hf_sized_is_possible(size_t size, const struct hf_sized *type);

// Copy what the program gave over *own, which holds defaults or zeros. argument is what the message calls it. Returns HF_OK,
// or HF_ERR_ARG with the message filled.
int hf_sized_in(void *own, const void *given, const struct hf_sized *type, const char *argument,
                struct hf_message *message);
// The other way: fill the struct at given, as far as its size goes, from own; bytes that own does not have become 0. NULL:
// nothing is filled. own NULL: all becomes 0.
int hf_sized_out(void *given, const void *own, const struct hf_sized *type, const char *argument,
                 struct hf_message *message);

// The program's parameters, and the picture of the aperture that they point to.
struct hf_given {
    struct hf_params params;
    struct hf_image picture;
};

// Copy params (NULL: defaults) and check that what is reserved is 0.
int hf_given_params(struct hf_given *own, const struct hf_params *params, struct hf_message *message);
// Copy a depth that is not NULL.
int hf_given_depth(struct hf_depth *own, const struct hf_depth *depth, struct hf_message *message);

#endif
