// SPDX-License-Identifier: BSD-3-Clause
// What OpenImageIO does for us. It never runs in the program's own process: a helper program, hyperfocal-oiio, is
// started when the first file needs it, so that a damaged file cannot damage us, libraries that print are not heard, and
// who reads EXR does not wait for OpenImageIO to load. client.c has these functions for the program and asks the
// helper; oiio.cpp and samples.cpp, the only C++, have the same functions for the helper, where serve.c calls them.
#ifndef HF_IO_OIIO_H
#define HF_IO_OIIO_H

#include "tools/io/picture.h"

#ifdef __cplusplus
extern "C" {
#endif

struct hf_oiio;

// Is the helper there? Looked for beside the program and where it is installed and built relative to that.
int hf_oiio_available(void);

// Pictures of any format. A file has at most one view, whose name is ""; none when it has no colour. path must outlive
// the file.
int hf_oiio_open(struct hf_oiio **out, const char *path, const char *depth_channel, struct hf_io_views *views,
                 struct hf_io_error *err);
void hf_oiio_close(struct hf_oiio *oiio);
void hf_oiio_channels(const struct hf_oiio *oiio, char *buf, size_t size);
// Bits of the file's samples when they are integers, else 0.
int hf_oiio_bits(const struct hf_oiio *oiio);
void hf_oiio_size(const struct hf_oiio *oiio, int *width, int *height);
int hf_oiio_read_colour(struct hf_oiio *oiio, float *const planes[4], struct hf_io_error *err);
int hf_oiio_read_depth(struct hf_oiio *oiio, float *depth, struct hf_io_error *err);
// Depth of a file that may have nothing else, of whose size the view must be: see hf_io_read_depth_file.
int hf_oiio_read_depth_only(struct hf_oiio *oiio, const char *depth_channel, const struct hf_io_view *view,
                            float *depth, struct hf_io_error *err);

// Is the format that path's extension says one that hf_oiio_write can write?
int hf_oiio_check_format(const char *path, struct hf_io_error *err);

// A new picture of one view's colours, in the format that path's extension says; the file itself is not touched.
struct hf_oiio_picture {
    const char *path;
    const struct hf_io_view *view;
    const float *planes[4];   // planes[3] NULL when there is no alpha, else the colours are premultiplied
    int bits;                 // of the source: 16 stay 16 where the format has them
    const char *compression;  // NULL: the format's own
    const char *source;       // picture whose camera, orientation, colour profile and texts go along; NULL: none
};
int hf_oiio_write(struct hf_io_bytes *made, const struct hf_oiio_picture *picture, struct hf_io_error *err);

// The samples of one EXR part, whatever its compression.
int hf_oiio_read_samples(const char *path, int part, struct hf_io_samples *s, struct hf_io_error *err);
// A new single-part EXR. compression: "dwaa" or "dwab"; level: its quality, 0 for the default. path is for messages.
int hf_oiio_write_samples(struct hf_io_bytes *made, const char *path, const struct hf_io_samples *s,
                          const char *compression, float level, struct hf_io_error *err);

// Of the helper alone: find all readers and writers, while files can still be opened; and the file that this process
// reads, whatever has its name meanwhile.
void hf_oiio_prepare(void);
void hf_oiio_use_file(int fd);

// Of the program alone: what the last job's sandbox did not forbid, as one sentence, or NULL.
const char *hf_oiio_sandbox(void);

#ifdef __cplusplus
}
#endif

#endif
