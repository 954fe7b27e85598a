// SPDX-License-Identifier: BSD-3-Clause
// EXR files, read and written with OpenEXRCore. Core parses headers, and decodes and encodes chunks. write.c copies the
// layout of a written file (header bytes, chunk tables, chunk order) from the source. So everything that is not
// replaced stays as it was, unknown attributes included.
#ifndef HF_IO_EXR_H
#define HF_IO_EXR_H

#include <openexr.h>

#include "tools/io/out.h"
#include "tools/io/picture.h"
#include "tools/io/run.h"

struct hf_exr_channel {
    const char *name;
    exr_pixel_type_t type;
    int bytes;
    int x_sampling, y_sampling;
};

// Where a part's samples lie if its decoded chunks follow each other in the order of their table: in a chunk row after
// row, in a row channel after channel.
struct hf_exr_layout {
    size_t *row;      // of scan lines: height + 1 offsets; NULL for tiles
    size_t *channel;  // bytes per pixel before each channel; NULL if channels are subsampled, because rows then differ
    size_t pixel_bytes, bytes;
};

struct hf_exr_part {
    const char *name, *view;  // "" if the header has none
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
    uint64_t chunk_count_at;  // of the chunkCount attribute's value; 0 if there is none
    uint64_t window_at;       // of the dataWindow attribute's value
    bool grown;               // window, width, height, layout and samples differ from the file's: see grow.c
    char **added;             // names of channels that the file does not have, see grow.c
    int added_count;
    int channel_count;
    struct hf_exr_channel *channels;
    const exr_attr_chlist_t *list;
    struct hf_exr_layout layout;  // valid once hf_exr_lay_out was called
    uint8_t *samples;             // all decoded chunks, or NULL
};

// The limit for all parts together, because channels are looked up one by one.
enum { HF_EXR_MOST_CHANNELS = 4096 };

// Reads and writes the samples of parts with a compression that Core lacks (DWA). Both functions return 0, or -1 with
// *err filled.
struct hf_exr_codec {
    int (*read)(const char *path, int part, struct hf_io_samples *s, struct hf_io_error *err);
    // Make a new single-part EXR. level: the quality, 0 for the default.
    int (*write)(struct hf_io_bytes *made, const char *path, const struct hf_io_samples *s, const char *compression,
                 float level, struct hf_io_error *err);
};

// The bytes of the file that are in memory: sorted ranges of a buffer as long as the file; other pages of the buffer
// are never touched.
struct hf_exr_fetched {
    uint8_t *bytes;
    int count;
    struct hf_exr_range {
        uint64_t from, to;
    } * range;
};

// Attributes whose size is not that of their type, sorted: from the name to the end of the value. Core does not see them,
// and written files do not have them, because other readers refuse the file or lose their place in it.
struct hf_exr_misfits {
    size_t count, room;
    struct hf_exr_misfit {
        uint64_t from, type_at, to;
    } * list;
};

struct hf_exr {
    const char *path;  // not owned
    const struct hf_exr_codec *dwa;
    int fd;
    const uint8_t *memory;  // the whole file; NULL: fd is read. Not owned
    struct hf_exr_fetched fetched;
    struct hf_exr_misfits misfits;
    uint64_t size;
    uint64_t header_size;
    bool multipart;
    exr_context_t core;
    int part_count;
    struct hf_exr_part *parts;
};

// Takes over fd, also after a failure. path and dwa must outlive the file.
int hf_exr_open(struct hf_exr **out, const char *path, int fd, const struct hf_exr_codec *dwa, struct hf_io_error *err);
// Open a file in memory; bytes must outlive it.
int hf_exr_open_memory(struct hf_exr **out, const char *path, const struct hf_io_bytes *bytes, struct hf_io_error *err);
void hf_exr_close(struct hf_exr *e);
int hf_exr_read_at(const struct hf_exr *e, void *data, size_t size, uint64_t offset);  // 0 or -1
// The bytes at offset if they are in memory, else NULL.
const uint8_t *hf_exr_bytes(const struct hf_exr *e, size_t size, uint64_t offset);
// Forget Core's messages on this thread. The second function returns Core's first message since then, or the meaning of
// its return code.
void hf_exr_quiet(void);
const char *hf_exr_said(exr_result_t code);
int hf_exr_fail(const struct hf_exr *e, exr_result_t code, struct hf_io_error *err);
// Prepare a Core context with our memory and message functions; user_data goes to the functions that read and write.
void hf_exr_context_init(void *user_data, exr_context_initializer_t *init);

// header.c: look at the header before Core does. Sorting channels and looking for layers compares each channel with all
// others, in Core too, so a file with too many is refused. Note the misfits. Any other fault is left to Core.
int hf_exr_survey(struct hf_exr *e, struct hf_io_error *err);
// Find the end of the header and each part's chunk table.
int hf_exr_scan_header(struct hf_exr *e, struct hf_io_error *err);
// Give misfits in bytes read at offset a type that Core does not know, so that it passes over them by their size.
void hf_exr_hide_misfits(const struct hf_exr *e, uint8_t *data, size_t size, uint64_t offset);
// Take misfits out of a copy of the header; returns its new size.
size_t hf_exr_drop_misfits(const struct hf_exr *e, uint8_t *header, size_t size);

bool hf_exr_is_deep(const struct hf_exr_part *part);
bool hf_exr_is_dwa(exr_compression_t compression);
int hf_exr_find_channel(const struct hf_exr_part *part, const char *name);  // index, or -1
const char *hf_exr_compression_name(exr_compression_t compression);
int hf_exr_compression(const char *name);  // enum exr_compression_t, or -1
int hf_exr_compression_lines(exr_compression_t compression);
// The number of samples of channel c in a row of the part's window (its pixels x with x % x_sampling == 0).
int hf_exr_row_samples(const struct hf_exr_part *part, int c);
bool hf_exr_row_has(const struct hf_exr_part *part, int c, int y);

// Check that the part can be decoded: its data window is valid, its compression is supported, it has the chunks that
// its window and levels need, and the file is not far too short for the pixels that the header promises.
int hf_exr_check_part(const struct hf_exr *e, int part, struct hf_io_error *err);

// views.c
int hf_exr_find_views(const struct hf_exr *e, struct hf_io_views *views, const struct hf_io_choice *choice,
                      struct hf_io_error *err);
// Find part and channel of the depth for a view of that name, in a file that may have no colour.
int hf_exr_find_depth_only(const struct hf_exr *e, const char *depth_channel, const char *name, int *channel);
void hf_exr_channels(const struct hf_exr *e, char *buf, size_t size);
void hf_exr_layers(const struct hf_exr *e, char *buf, size_t size);
// Layers with depths that none of the views has; see hf_io_other_layers.
int hf_exr_other_layers(const struct hf_exr *e, const struct hf_io_views *views, char *buf, size_t size);

// layout.c
struct hf_exr_chunk {
    int index;                  // in table order
    int x0, y0, width, height;  // counted from the corner of the data window
    size_t at, size;            // in the part's samples
};
int hf_exr_lay_out(const struct hf_exr *e, int part, struct hf_io_error *err);
void hf_exr_free_layout(struct hf_exr_part *part);
// The number of chunks if each has `lines` scan lines (ignored for tiles), and the chunk with a given number.
int hf_exr_count_chunks(const struct hf_exr_part *part, int lines);
struct hf_exr_chunk hf_exr_chunk_at(const struct hf_exr_part *part, int lines, int index);
// Where row y of channel c begins in a chunk.
size_t hf_exr_row_at(const struct hf_exr_part *part, const struct hf_exr_chunk *chunk, int c, int y);

// decode.c: a channel to be decoded to floats, on a grid of pixels in EXR coordinates. Pixels outside the part's window
// are not written.
struct hf_exr_plane {
    int part, channel;
    bool keep;  // keep the part's samples: they are written again
    struct hf_io_box grid;
    float *to;
};
int hf_exr_decode(struct hf_exr *e, const struct hf_exr_plane *planes, int count, const struct hf_io_run *run,
                  struct hf_io_error *err);
// Make parts[part].samples complete, decoding what is missing.
int hf_exr_load_samples(struct hf_exr *e, int part, const struct hf_io_run *run, struct hf_io_error *err);
// Read the bytes that hf_exr_decode of these planes would read into memory.
int hf_exr_fetch(struct hf_exr *e, const struct hf_exr_plane *planes, int count, struct hf_io_error *err);

// grow.c: enlarge a part's data window. New pixels are 0, or another value in some channels.
struct hf_exr_fill {
    int channel;
    float value;
};
int hf_exr_grow(struct hf_exr *e, int part, struct hf_io_box box, const struct hf_exr_fill *fills, int fill_count,
                const struct hf_io_run *run, struct hf_io_error *err);
// Give a part one more channel, of floats that are 0, unless it has one of that name.
int hf_exr_add_channel(struct hf_exr *e, int part, const char *name, const struct hf_io_run *run,
                       struct hf_io_error *err);

// codec.c: read or write a part that only the codec can handle, as a whole. The samples lie as the layout says.
int hf_exr_codec_read(struct hf_exr *e, int part, uint8_t *samples, int threads, struct hf_io_error *err);
int hf_exr_codec_write(struct hf_exr *e, int part, exr_compression_t compression, const uint8_t *samples, int threads,
                       struct hf_io_bytes *made, struct hf_io_error *err);

// encode.c: compresses chunks of a part; each thread needs one.
struct libdeflate_compressor;
struct hf_exr_encoder {
    struct hf_exr *e;
    const struct hf_exr_part *part;
    exr_compression_t compression;
    int lines;
    exr_context_t core;  // RLE, PIZ, PXR24, B44
    exr_encode_pipeline_t pipe;
    bool started;
    const uint8_t *raw;
    size_t raw_size;
    struct libdeflate_compressor *deflate, *again;  // again: for chunks that shrink well; or NULL
    uint8_t *scratch, *packed;
    size_t scratch_size;
};
// zip_level: libdeflate's, 1 to 12; 0: by what it costs.
int hf_exr_encoder_open(struct hf_exr_encoder *en, struct hf_exr *e, const struct hf_exr_part *part,
                        exr_compression_t compression, int zip_level, struct hf_io_error *err);
// raw: the chunk's samples. *data is valid until the next call; it is raw if that does not shrink.
int hf_exr_encode(struct hf_exr_encoder *en, const struct hf_exr_chunk *chunk, const uint8_t *raw, const uint8_t **data,
                  size_t *size, struct hf_io_error *err);
void hf_exr_encoder_close(struct hf_exr_encoder *en);

// write.c: a new file as a list of pieces, each in memory or in the source.
struct hf_exr_job {
    const struct hf_io_views *views;
    const struct hf_io_result *results;
    int n_results;
    int compression;  // -1: as it was
    int zip_level;    // see hf_exr_encoder_open
    const struct hf_io_text *texts;
    int text_count;
};
struct hf_exr_made;
int hf_exr_encode_file(struct hf_exr_made **out, struct hf_exr *e, const struct hf_exr_job *job,
                       const struct hf_io_run *run, struct hf_io_written *written, struct hf_io_error *err);
int hf_exr_put_file(const struct hf_exr_made *made, struct hf_out *out, struct hf_io_error *err);
void hf_exr_free_file(struct hf_exr_made *made);

// stamp.c: a header, the file's first bytes up to the chunk tables, with one more channel of floats in the list of a part. To be
// freed; NULL without memory.
uint8_t *hf_exr_list_channel(const uint8_t *header, size_t *size, int part, const char *name);
// a copy of a file's first bytes, up to the chunk tables, in which texts replace those of the same names in
// the first part's header, and a checksum, 0 so far, follows them. To be freed; NULL without memory.
uint8_t *hf_exr_stamp(const uint8_t *header, size_t *size, const struct hf_io_text *texts, int count);
// Name of the checksum's attribute. Its value is the CRC-32 of the whole file, in which its own 8 digits count as zeros.
#define HF_EXR_SUM "hyperfocalSum"
// Where in the header the checksum's digits are; 0: there is none.
size_t hf_exr_find_sum(const uint8_t *header, size_t size);
// Add bytes to a checksum that begins at 0, and write its 8 digits.
void hf_exr_add_to_sum(uint32_t *sum, const void *data, size_t size);
void hf_exr_put_sum(uint8_t *digits, uint32_t sum);
// Returns 0 if the file has a checksum that is right.
int hf_exr_check_sum(const struct hf_exr *e, struct hf_io_error *err);

// new.c
struct hf_exr_new {
    struct hf_io_box data_window, display_window;
    float pixel_aspect, screen_center_x, screen_center_y, screen_width;
    exr_compression_t compression;
    int zip_level;  // as of hf_exr_encoder_open
    int channel_count;
    const char *const *names;
    const float *const *planes;
    ptrdiff_t stride;  // floats from row to row
    const struct hf_io_text *texts;
    int text_count;
};
int hf_exr_make_new(struct hf_io_bytes *made, const char *path, const struct hf_exr_new *picture,
                    struct hf_io_error *err);

#endif
