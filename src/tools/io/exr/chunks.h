// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_IO_EXR_CHUNKS_H
#define HF_IO_EXR_CHUNKS_H

#include "tools/io/exr/exr.h"

// An entry of the chunk table: its place in the file, and its number.
struct hf_exr_slot {
    uint64_t offset;
    int index;
};

// The bytes before a chunk's data: the part's number in multi-part files, the chunk's place in the picture, sizes.
struct hf_exr_leader {
    int32_t place[4];  // y of scan lines; x, y, level x, level y of a tile
    size_t size;       // of the leader
    uint64_t data, data_size;
};

// The chunk table of a part, or NULL with *err filled; to be freed.
uint64_t *hf_exr_table(const struct hf_exr *e, int part, struct hf_io_error *err);
// The chunk table of a part, sorted by offset; to be freed. NULL with *err filled.
struct hf_exr_slot *hf_exr_file_order(const struct hf_exr *e, int part, struct hf_io_error *err);
// Returns 0 if all chunks of a part lie inside the file with the lengths that their leaders say, do not overlap, and
// have leaders that name the same places in the picture as the table.
int hf_exr_check_chunks(const struct hf_exr *e, int part, struct hf_io_error *err);
// Returns 0, or -1 if the leader or its data is not inside the file, or belongs to another part.
int hf_exr_read_leader(const struct hf_exr *e, int part, uint64_t offset, struct hf_exr_leader *l);

#endif
