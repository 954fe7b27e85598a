// SPDX-License-Identifier: BSD-3-Clause
// The C side of oiio.cpp. Without OpenImageIO (HF_HAVE_OIIO 0) no_oiio.c provides the same functions, which say so.
#ifndef HF_IO_OIIO_H
#define HF_IO_OIIO_H

#include "io/out.h"
#include "io/picture.h"

#ifdef __cplusplus
extern "C" {
#endif

struct hf_oiio;

// Is OpenImageIO there?
int hf_oiio_available(void);

// Pictures of any format. A file has at most one view, whose name is ""; none when it has no colour. path must outlive
// the file.
int hf_oiio_open(struct hf_oiio **out, const char *path, const char *depth_channel, struct hf_io_views *views,
                 struct hf_io_error *err);
void hf_oiio_close(struct hf_oiio *oiio);
void hf_oiio_channels(const struct hf_oiio *oiio, char *buf, size_t size);
int hf_oiio_read_colour(struct hf_oiio *oiio, float *const planes[4], struct hf_io_error *err);
int hf_oiio_read_depth(struct hf_oiio *oiio, float *depth, struct hf_io_error *err);
// Depth of a file that may have nothing else: see hf_io_read_depth_file.
int hf_oiio_read_depth_only(struct hf_oiio *oiio, const char *depth_channel, const struct hf_io_view *view,
                            float *depth, struct hf_io_error *err);

// A new picture of one view's colours: planes[3] NULL when there is no alpha, else the colours are premultiplied.
// source: what was read, whose 16-bit integers stay what they are where the format has them; NULL when that was EXR.
int hf_oiio_write(struct hf_out *out, const struct hf_oiio *source, const struct hf_io_view *view,
                  const float *const planes[4], const char *compression, struct hf_io_error *err);

// The samples of one EXR part, whatever its compression.
int hf_oiio_read_samples(const char *path, int part, struct hf_io_samples *s, struct hf_io_error *err);
// A new single-part EXR. compression: "dwaa" or "dwab"; level: its quality, 0 for the default.
int hf_oiio_write_samples(struct hf_out *out, const struct hf_io_samples *s, const char *compression, float level,
                          struct hf_io_error *err);

// png.c: 0 if the file is no PNG or a sound one, else -1 with *err filled.
int hf_io_check_png(const char *path, int fd, struct hf_io_error *err);

#ifdef __cplusplus
}
#endif

#endif
