// SPDX-License-Identifier: BSD-3-Clause
// The top floor of this folder: an open file, whatever handles it.
#ifndef HF_IO_FILE_H
#define HF_IO_FILE_H

#include "tools/io/exr/deep.h"
#include "tools/io/io.h"

struct hf_exr;
struct hf_oiio;

struct hf_io_file {
    char *path;
    struct hf_exr *exr;  // one of these two is set
    struct hf_oiio *oiio;
    struct hf_io_views views;
    struct hf_exr_samples samples;  // of a deep view, once it was decoded
};

// deep.c: decode a deep view, of which there is no other in the file. What is wanted is the flat picture of its samples, over
// each other, and the depth of the nearest behind which less than half of a pixel is seen.
int hf_io_decode_deep(struct hf_io_file *file, const struct hf_io_want *want, const struct hf_io_run *run,
                      struct hf_io_error *err);

// As hf_io_open, but accepts a file without colour (a depth map), which has no views.
int hf_io_open_any(struct hf_io_file **out, const char *path, const struct hf_io_choice *choice,
                   struct hf_io_error *err);

// Whether all parts of it are deep; and the error for callers that cannot use such a file, which returns -1.
bool hf_io_is_deep(const struct hf_io_file *file);
int hf_io_fail_deep(const char *path, struct hf_io_error *err);

#endif
