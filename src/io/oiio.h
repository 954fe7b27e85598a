// SPDX-License-Identifier: BSD-3-Clause
// The C side of oiio.cpp. Without OpenImageIO (HF_HAVE_OIIO 0) no_oiio.c provides the same functions, which say so.
#ifndef HF_IO_OIIO_H
#define HF_IO_OIIO_H

#include "io/common.h"
#include "io/out.h"

#ifdef __cplusplus
extern "C" {
#endif

// Pictures of any format. A file has at most one view and its name is "".
int hf_oiio_open(struct hf_io_file *file, const char *depth_channel, struct hf_io_error *err);
void hf_oiio_close(struct hf_oiio *oiio);
void hf_oiio_channels(const struct hf_oiio *oiio, char *buf, size_t size);
int hf_oiio_read_colour(struct hf_io_file *file, float *planes[4], struct hf_io_error *err);
int hf_oiio_read_depth(struct hf_io_file *file, float *depth, struct hf_io_error *err);
// Depth of a file that may have nothing else: see hf_io_read_depth_file.
int hf_oiio_read_depth_only(struct hf_io_file *file, const char *depth_channel, const struct hf_io_view *view,
                            float *depth, struct hf_io_error *err);

// A new picture of one view's colours: planes[3] NULL when there is no alpha, else the colours are premultiplied.
// 16-bit integers stay what they are where the format has them.
int hf_oiio_write(struct hf_out *out, const struct hf_io_file *source, const struct hf_io_view *view,
                  const float *const planes[4], const char *compression, struct hf_io_error *err);

// The samples of one EXR part as OpenEXR stores them: row after row, in a row channel after channel, in alphabetical
// order, little endian. All channels have full resolution.
struct hf_oiio_samples {
    int x, y, width, height;  // the data window
    int channel_count;
    const char *const *names;
    const uint8_t *types;         // 0 uint, 1 half, 2 float
    int tile_width, tile_height;  // 0: scan lines
    size_t row_bytes;
    uint8_t *data;  // height * row_bytes
};

int hf_oiio_read_samples(const char *path, int part, struct hf_oiio_samples *s, struct hf_io_error *err);
// A new single-part EXR. compression: "dwaa" or "dwab"; level: its quality, 0 for the default.
int hf_oiio_write_samples(struct hf_out *out, const struct hf_oiio_samples *s, const char *compression, float level,
                          struct hf_io_error *err);

#ifdef __cplusplus
}
#endif

#endif
