// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_IO_EXR_CHUNKS_H
#define HF_IO_EXR_CHUNKS_H

#include "io/exr/exr.h"

// A chunk of the table: where in the file, and its number.
struct hf_exr_slot {
    uint64_t offset;
    int index;
};

// The part being written.
struct hf_exr_target {
    struct hf_out *out;
    uint64_t at;  // bytes written so far
    bool multipart;
    int part;
    uint64_t *table;  // filled: offset of each chunk
};

// The chunk table of a part sorted by offset; to be freed. NULL with *err filled.
struct hf_exr_slot *hf_exr_file_order(const struct hf_exr *e, int part, struct hf_io_error *err);
// 0 if all chunks of a part lie within the file, as long as their leaders say.
int hf_exr_check_chunks(const struct hf_exr *e, int part, struct hf_io_error *err);
// Copy all chunks of a part, in the order in which they stand in the file.
int hf_exr_copy_chunks(const struct hf_exr *e, int part, struct hf_exr_target *t, struct hf_io_error *err);
// Write a chunk's leader: the part number if the file wants one, and what is given.
int hf_exr_put_leader(struct hf_exr_target *t, const void *leader, size_t size, struct hf_io_error *err);

#endif
