// SPDX-License-Identifier: BSD-3-Clause
// The top of this folder: an open file, whoever handles it.
#ifndef HF_IO_FILE_H
#define HF_IO_FILE_H

#include "io/io.h"

struct hf_exr;
struct hf_oiio;

struct hf_io_file {
    char *path;
    struct hf_exr *exr;  // one of these two is set
    struct hf_oiio *oiio;
    struct hf_io_views views;
};

#endif
