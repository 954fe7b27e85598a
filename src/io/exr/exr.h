// SPDX-License-Identifier: BSD-3-Clause
// EXR files, read and written with OpenEXRCore. Core parses headers, and decodes and encodes chunks; the layout of a
// written file (header bytes, chunk tables, chunk order) is copied from the source by exr_write.c, which is how
// everything that is not replaced stays as it was, attributes nobody knows included.
#ifndef HF_IO_EXR_H
#define HF_IO_EXR_H

#include <openexr.h>

#include "io/out.h"
#include "io/picture.h"

struct hf_exr_channel {
    const char *name;
    exr_pixel_type_t type;
    int bytes;
    int x_sampling, y_sampling;
};

struct hf_exr_part {
    const char *name, *view;  // "" when the header has none
    exr_storage_t storage;
    exr_compression_t compression;
    exr_lineorder_t line_order;
    exr_attr_box2i_t window;
    bool window_ok;  // width and height are set: 1 .. HF_IO_MAX_SIDE
    int width, height;
    int chunk_lines;  // scan lines per chunk; 0 for tiles
    int tile_width, tile_height;
    bool one_level;  // not mipmapped
    int chunk_count;
    uint64_t table;           // file offsets: of the chunk table,
    uint64_t compression_at;  // of the byte that names the compression,
    uint64_t chunk_count_at;  // of the chunkCount attribute's value; 0 when there is none
    int channel_count;
    struct hf_exr_channel *channels;
    const exr_attr_chlist_t *list;
};

// Who reads and writes the samples of parts whose compression Core does not know (DWA). Both return 0, or -1 with *err
// filled.
struct hf_exr_codec {
    int (*read)(const char *path, int part, struct hf_io_samples *s, struct hf_io_error *err);
    // A new single-part EXR. level: the quality, 0 for the default.
    int (*write)(struct hf_io_bytes *made, const char *path, const struct hf_io_samples *s, const char *compression,
                 float level, struct hf_io_error *err);
};

struct hf_exr {
    const char *path;  // not owned
    const struct hf_exr_codec *dwa;
    int fd;
    const uint8_t *memory;  // all of the file; NULL: fd is read. Not owned
    uint64_t size;
    uint64_t header_size;
    bool multipart;
    exr_context_t core;
    char core_message[256];  // the first thing Core complained about since hf_exr_quiet
    int part_count;
    struct hf_exr_part *parts;
};

// Takes fd over, also on failure. path and dwa must outlive the file.
int hf_exr_open(struct hf_exr **out, const char *path, int fd, const struct hf_exr_codec *dwa, struct hf_io_error *err);
// A file in memory, which must outlive it.
int hf_exr_open_memory(struct hf_exr **out, const char *path, const struct hf_io_bytes *bytes, struct hf_io_error *err);
void hf_exr_close(struct hf_exr *e);
int hf_exr_read_at(const struct hf_exr *e, void *data, size_t size, uint64_t offset);  // 0 or -1
// Forget what Core said; report what it said since. code: what Core returned.
void hf_exr_quiet(struct hf_exr *e);
int hf_exr_fail(const struct hf_exr *e, exr_result_t code, struct hf_io_error *err);
// Core contexts with our memory and message functions. user_data must be the hf_exr.
void hf_exr_context_init(struct hf_exr *e, exr_context_initializer_t *init);

bool hf_exr_is_deep(const struct hf_exr_part *part);
bool hf_exr_is_dwa(exr_compression_t compression);
int hf_exr_find_channel(const struct hf_exr_part *part, const char *name);  // index, or -1
const char *hf_exr_compression_name(exr_compression_t compression);
int hf_exr_compression(const char *name);  // enum exr_compression_t, or -1
int hf_exr_compression_lines(exr_compression_t compression);
// Samples of channel c in a row of the part's window (its pixels x with x % x_sampling == 0).
int hf_exr_row_samples(const struct hf_exr_part *part, int c);
bool hf_exr_row_has(const struct hf_exr_part *part, int c, int y);

// Is the part fit to be decoded: sizes, levels, a file long enough for what the header promises?
int hf_exr_check_part(const struct hf_exr *e, int part, struct hf_io_error *err);

// exr_views.c
int hf_exr_find_views(const struct hf_exr *e, struct hf_io_views *views, const char *depth_channel,
                      struct hf_io_error *err);
// Part and channel of the depth for a view called name, in a file that may have no colour.
int hf_exr_find_depth_only(const struct hf_exr *e, const char *depth_channel, const char *name, int *channel);
void hf_exr_channels(const struct hf_exr *e, char *buf, size_t size);

// exr_read.c: called for every row of every channel in every chunk: count samples of channel c, the first at (x, y)
// counted from the corner of the data window.
typedef void hf_exr_row(void *arg, int c, int x, int y, const uint8_t *samples, int count);
int hf_exr_rows(struct hf_exr *e, int part, hf_exr_row *row, void *arg, struct hf_io_error *err);
int hf_exr_read_colour(struct hf_exr *e, const struct hf_io_view *view, float *const planes[4],
                       struct hf_io_error *err);
// Depth channel c of a part onto a grid of pixels, given in EXR pixel coordinates.
int hf_exr_read_depth(struct hf_exr *e, int part, int c, struct hf_io_box grid, float *depth, struct hf_io_error *err);

// exr_pixels.c: a part's samples as stored: row after row, in a row channel after channel.
struct hf_exr_pixels {
    const struct hf_exr_part *part;
    uint8_t *data;
    size_t *row;      // height + 1 offsets into data
    size_t *channel;  // offsets into a row; NULL when channels are subsampled, so that rows differ
};
int hf_exr_read_pixels(struct hf_exr *e, int part, struct hf_exr_pixels *px, struct hf_io_error *err);
int hf_exr_alloc_pixels(struct hf_exr_pixels *px, const char *path, const struct hf_exr_part *part,
                        struct hf_io_error *err);
void hf_exr_free_pixels(struct hf_exr_pixels *px);
uint8_t *hf_exr_pixel_row(const struct hf_exr_pixels *px, int c, int y);
// The same as a codec wants it; names holds what s points at, and is to be freed.
struct hf_exr_names {
    const char **names;
    uint8_t *types;
};
int hf_exr_samples(const struct hf_exr_pixels *px, const char *path, struct hf_io_samples *s,
                   struct hf_exr_names *names, struct hf_io_error *err);
void hf_exr_free_names(struct hf_exr_names *names);

// exr_encode.c: compresses chunks of a part that looks like the source's.
struct hf_exr_encoder {
    struct hf_exr *e;  // messages go there
    exr_context_t core;
    exr_encode_pipeline_t pipe;
    bool started;
    int chunk_lines;
    const struct hf_exr_pixels *px;
};
int hf_exr_encoder_open(struct hf_exr_encoder *en, struct hf_exr *e, const struct hf_exr_pixels *px,
                        exr_compression_t compression, struct hf_io_error *err);
// Chunk number index (in table order); data is valid until the next call.
int hf_exr_encode(struct hf_exr_encoder *en, int index, const void **data, size_t *size, struct hf_io_error *err);
void hf_exr_encoder_close(struct hf_exr_encoder *en);

// exr_write.c
struct hf_exr_job {
    const struct hf_io_views *views;
    const struct hf_io_result *results;
    int n_results;
    int compression;  // -1: as it was
    const struct hf_io_text *texts;
    int text_count;
};
// All of the new file goes to out, which the caller has opened and commits.
int hf_exr_write(struct hf_exr *e, struct hf_out *out, const struct hf_exr_job *job, uint64_t *clamped,
                 struct hf_io_error *err);

// stamp.c: a copy of a file's first bytes, up to the chunk tables, with texts put into the first part's header in place of
// those that have the same names. To be freed; NULL without memory.
uint8_t *hf_exr_stamp(const uint8_t *header, size_t *size, const struct hf_io_text *texts, int count);

// exr_planes.c
struct hf_exr_new {
    struct hf_io_box data_window, display_window;
    float pixel_aspect, screen_center_x, screen_center_y, screen_width;
    exr_compression_t compression;
    int channel_count;
    const char *const *names;
    const float *const *planes;
    ptrdiff_t stride;  // floats from row to row
};
int hf_exr_write_new(struct hf_out *out, const struct hf_exr_new *picture, struct hf_io_error *err);

#endif
