// SPDX-License-Identifier: BSD-3-Clause
// Picture files for the programs (the library itself knows no files). The floors: errors,
// pictures and files being written (error, picture, out, half); on them, beside each other, EXR by OpenEXRCore (exr)
// and everything else by OpenImageIO (oiio); on top what chooses between them (file, write). Nothing here prints.
#ifndef HF_IO_H
#define HF_IO_H

#include "io/picture.h"

#ifdef __cplusplus
extern "C" {
#endif

// An open picture file: headers parsed, no pixels read.
struct hf_io_file;

// Open a file and find its views. depth_channel: full name of the depth channel to use for every view (or NULL: search
// the view's own Z, depth.Z, then any single channel named *depth*). A view without depth is no error here: it
// has depth_part -1, and hf_io_channels says which channels there are. A file without colour (R, G, B or Y) is an
// error that lists its channels. Returns 0, or -1 with *err filled.
// Header sizes are not trusted: nothing is allocated in proportion to a data window before its pixels are asked for
// and the file has been seen to be long enough to hold its chunk table.
int hf_io_open(struct hf_io_file **out, const char *path, const char *depth_channel, struct hf_io_error *err);
void hf_io_close(struct hf_io_file **file);

int hf_io_view_count(const struct hf_io_file *file);
const struct hf_io_view *hf_io_view(const struct hf_io_file *file, int view);
// All channel names of the file, "R, G, B, Z" (part names before a colon when there are several parts), truncated to
// size.
void hf_io_channels(const struct hf_io_file *file, char *buf, size_t size);

// Read a view's colour into tightly packed float planes of width * height (planes[3] may be NULL or the channel
// absent: left alone). Greyscale files fill R, G, B with the same. Values are the file's, NaN and Inf included.
int hf_io_read_colour(struct hf_io_file *file, int view, float *planes[4], struct hf_io_error *err);
// Read the view's depth onto the grid of its colour's data window: width * height floats. Where the depth's own data
// window does not reach: +Inf (no surface). Error when there is no overlap at all, or no depth channel.
int hf_io_read_depth(struct hf_io_file *file, int view, float *depth, struct hf_io_error *err);
// Depth from a file of its own, any format OpenImageIO or OpenEXRCore reads: its depth channel as searched above (or
// its only channel, or R). Must have the same data window size as the view.
int hf_io_read_depth_file(const char *path, const char *depth_channel, const struct hf_io_view *view, float *depth,
                          struct hf_io_error *err);

struct hf_io_write_options {
    const char *compression;  // "none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab", or NULL:
                              // as it was
};

// Write a copy of the file to path with the colours of some views replaced: everything else (windows, attributes,
// parts, channels and their types, tiling, compression, line order) stays; parts with nothing to change are copied as
// raw chunks. *clamped counts samples that did not fit a half channel (clamped to +-65504). Written to a temporary file
// beside path, then renamed; on error nothing is left. The format follows path's extension; an EXR source
// written as something else (png, tif, jpg ...) keeps only one view's colour; formats of 8 and 16 bit integers get the
// sRGB curve (reading takes it off again), floats stay linear. When path is not .exr, results must hold exactly one view.
// clamped, options and err may be NULL. path may be the file's own.
int hf_io_write(struct hf_io_file *file, const char *path, const struct hf_io_result *results, int n_results,
                const struct hf_io_write_options *options, uint64_t *clamped, struct hf_io_error *err);

// Write planes of floats as a new single-part EXR of float channels (names[c], any order): intermediate buffers, tests.
int hf_io_write_planes(const char *path, int width, int height, int channels, const char *const names[],
                       const float *const planes[], ptrdiff_t stride, struct hf_io_error *err);

// 1 if this build can read and write anything but EXR.
int hf_io_has_oiio(void);

#ifdef __cplusplus
}
#endif

#endif
