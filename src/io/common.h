// SPDX-License-Identifier: BSD-3-Clause
// What the files of this folder share: errors, the open file, finite checks on sizes.
#ifndef HF_IO_COMMON_H
#define HF_IO_COMMON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "io/io.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    HF_IO_MAX_SIDE = 65536,          // widest and tallest picture
    HF_IO_MAX_COORDINATE = 1 << 30,  // windows stay within +- this, so that no difference of two overflows
};

struct hf_exr;
struct hf_oiio;

struct hf_io_file {
    char *path;
    struct hf_exr *exr;  // one of these two is set
    struct hf_oiio *oiio;
    int view_count;
    struct hf_io_view *views;
};

// Fill err (which may be NULL) and return -1, so that "return hf_io_fail(...)" reads well.
int hf_io_fail(struct hf_io_error *err, const char *format, ...) __attribute__((format(printf, 2, 3)));

// What follows the last dot of the file's name, or "".
const char *hf_io_extension(const char *path);
bool hf_io_is_exr_name(const char *path);

// As hf_io_open, but a file without colour (a depth map) is fine and has no views.
int hf_io_open_any(struct hf_io_file **out, const char *path, const char *depth_channel, struct hf_io_error *err);

// 0, or -1 with *err filled when the window is empty, too large, or too far away.
int hf_io_check_window(const char *path, const char *which, struct hf_io_box box, struct hf_io_error *err);

// png.c: 0 if the file is no PNG or a sound one, else -1 with *err filled.
int hf_io_check_png(const char *path, int fd, struct hf_io_error *err);

// Append name to a list "a, b, c" in buf; what does not fit is cut off.
void hf_io_list(char *buf, size_t size, const char *part, const char *name);

// Append a view, all zero, to file->views. NULL when there is no memory.
struct hf_io_view *hf_io_add_view(struct hf_io_file *file);

#ifdef __cplusplus
}
#endif

#endif
