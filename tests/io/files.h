// SPDX-License-Identifier: BSD-3-Clause
// Makes small EXR files with OpenEXRCore alone, and compares files without the code under test.
#ifndef HF_TESTS_IO_FILES_H
#define HF_TESTS_IO_FILES_H

#include <stdbool.h>
#include <stdint.h>

#include <openexr.h>

#include "tools/io/io.h"
#include "support/check.h"

enum { MAX_PARTS = 6, MAX_CHANNELS = 24 };

struct channel {
    const char *name;
    exr_pixel_type_t type;
    int sampling;  // 0 means 1
};

struct part {
    const char *name, *view;
    exr_storage_t storage;
    exr_compression_t compression;
    exr_lineorder_t order;
    int x, y, width, height;
    exr_tile_level_mode_t levels;
    struct channel channels[MAX_CHANNELS];
};

extern const char *folder;  // the folder of the test's files
extern uint64_t seed;

uint32_t rnd(void);
// The path of a file there; valid for good.
const char *in_folder(const char *name);
void *allocate(size_t size);
exr_result_t make_exr(const char *path, const struct part *parts, const char *views);
uint8_t *slurp(const char *path, size_t *size);
void spill(const char *path, const void *data, size_t size);
// Where the header ends and the first part's table of chunks begins.
size_t header_size(const uint8_t *d, size_t size);
// Whether the last chunk of the first part stands before the first.
bool runs_backwards(const char *path, int chunks);
// Core 3.1 writes chunks from the top for any line order; this reverses a single-part file.
void turn_round(const char *path, int chunks);
bool lossy(exr_compression_t c);
// Check that every channel that was not replaced has the same bits in both files.
void compare_channels(const char *a, const char *b, const struct hf_io_file *f, const struct hf_io_result *r, int n);
void compare_headers(const char *a, const char *b);
int files_in(const char *dir);
exr_context_initializer_t context(void);
// All samples of a channel, unpacked by Core. NULL for deep and mipmapped parts.
uint8_t *load_channel(exr_context_t f, int p, int c, size_t *size);

#endif
