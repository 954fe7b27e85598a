// SPDX-License-Identifier: BSD-3-Clause
// Picture files for the programs; the library itself does not read files. The floors, from the lowest: errors,
// pictures, files being written, and threads (error, picture, out, half, run); then, side by side, EXR by OpenEXRCore
// (exr) and all other formats by OpenImageIO (oiio); on top the files that choose between these (file, write). Nothing
// here prints.
//
// A frame goes through stages, which a program may overlap with those of other frames:
//
//     hf_io_open     headers                                          a few reads
//     hf_io_fetch    bytes of the chunks that will be needed          disk alone
//     hf_io_decode   planes of floats                                 computing, on the caller's threads
//     hf_io_encode   the bytes of the new file, in memory             computing, on the caller's threads
//     hf_io_save     a temporary file, then renamed                   disk alone
//
// Each stage of a file may run on another thread than the one before, but two stages of a file must never run at the
// same time. Different files are independent.
#ifndef HF_IO_H
#define HF_IO_H

#include "tools/io/picture.h"
#include "tools/io/run.h"

#ifdef __cplusplus
extern "C" {
#endif

// An open picture file: headers parsed, no pixels read.
struct hf_io_file;

// Open a file and find its views, each with the depth of its own layer, as `choice` says (NULL: the main layer, and the
// depth beside it). A layer may be given by its whole name (ViewLayer.Combined), its first pieces (ViewLayer), or its
// last one; a wrong name is an error that suggests the nearest. A view without depth is not an error: it has depth_part
// -1, and hf_io_channels lists the channels. It is an error if the file has no colour (R, G, B or Y), or several layers
// none of which is clearly the picture; the message lists what the file has. Returns 0, or -1 with *err filled.
// Sizes in a header are not trusted: no memory in proportion to a data window is allocated before its pixels are wanted
// and the file is known to be long enough for its chunk table.
int hf_io_open(struct hf_io_file **out, const char *path, const struct hf_io_choice *choice, struct hf_io_error *err);
void hf_io_close(struct hf_io_file **file);

int hf_io_view_count(const struct hf_io_file *file);
const struct hf_io_view *hf_io_view(const struct hf_io_file *file, int view);
// All channel names of the file, "R, G, B, Z" (part names before a colon when there are several parts), truncated to
// size.
void hf_io_channels(const struct hf_io_file *file, char *buf, size_t size);

// The names of other layers with depths of their own, which a choice of NULL leaves out: "Foreground.Combined, Hair",
// one for each depth, and "and 2 more" after the fourth. Returns how many; the text is cut off at size.
int hf_io_other_layers(const struct hf_io_file *file, char *buf, size_t size);

// The name of a part; "" if the file has only one part.
const char *hf_io_part_name(const struct hf_io_file *file, int part);

// A text attribute of an EXR file's first part, cut off at size; "" if there is none. Returns buf.
const char *hf_io_text(const struct hf_io_file *file, const char *name, char *buf, size_t size);
// Whether all chunks of an EXR file are complete, inside the file, and at the place that the table says. Reads no pixels.
// Returns 0, or -1 with *err filled, also for files that are not EXR.
int hf_io_check_whole(const struct hf_io_file *file, struct hf_io_error *err);
// Whether an EXR file still has the checksum that hf_io_encode put into its header together with texts. Reads the whole
// file. Returns 0, or -1 with *err filled, also for files without a checksum.
int hf_io_check_sum(const struct hf_io_file *file, struct hf_io_error *err);

// What to read of a view: tightly packed planes of width * height floats, owned by the caller; NULL: not wanted.
struct hf_io_want {
    int view;
    // R, G, B, A. The plane of a missing channel is not written; greyscale files fill R, G and B with the same values.
    // Values are the file's own, NaN and Inf included.
    float *planes[4];
    // On the grid of the colour's data window; +Inf (no surface) where the depth's own data window does not reach. It
    // is an error if they do not overlap, or if there is no depth channel.
    float *depth;
};

// Read the bytes that hf_io_decode of the same views will need, into memory that the file owns. Optional: otherwise
// decode reads as it goes. Only whether a plane is NULL matters here.
int hf_io_fetch(struct hf_io_file *file, const struct hf_io_want *wants, int count, struct hf_io_error *err);
// Decode what is wanted, each chunk once. run NULL: on this thread. Until hf_io_encode or hf_io_close the file keeps
// everything except colour and depth as it was stored; nothing is decoded twice.
int hf_io_decode(struct hf_io_file *file, const struct hf_io_want *wants, int count, const struct hf_io_run *run,
                 struct hf_io_error *err);

// The samples of a deep view, once it was decoded: those of pixel i, row after row, are first[i] to first[i + 1] - 1 of each
// array. They belong to the file. back is NULL if there is none.
struct hf_io_deep {
    const uint64_t *first;
    uint64_t samples;
    const float *colour[3], *alpha;
    float *depth, *back;  // may be changed
};
struct hf_io_deep hf_io_deep(const struct hf_io_file *file);

// Decode one view's colour or depth on this thread.
int hf_io_read_colour(struct hf_io_file *file, int view, float *planes[4], struct hf_io_error *err);
int hf_io_read_depth(struct hf_io_file *file, int view, float *depth, struct hf_io_error *err);
// Decode some rows of the depth, counted from the top of the data window, into their places in the plane. In an EXR
// only the chunks that contain them are decoded.
int hf_io_read_depth_rows(struct hf_io_file *file, int view, int first, int count, float *depth,
                          struct hf_io_error *err);
// Find an object by its name in an EXR file's Cryptomatte: coverage, width * height floats, gets how much of each pixel of the
// view's data window it fills. An object that the manifest does not have is an error that suggests the nearest; without a
// manifest any name counts. Returns 0, or -1 with *err filled.
int hf_io_read_object(struct hf_io_file *file, int view, const char *object, float *coverage, struct hf_io_error *err);
// Use another display window for a view; the file keeps its own.
void hf_io_set_display(struct hf_io_file *file, int view, struct hf_io_box box);
// Enlarge the data window of a view's part; it must contain the old one. All views of the part have it then, and so
// will the file that hf_io_encode makes. New pixels are 0 in all channels except the depths of views, where they are
// no_surface. Call after hf_io_decode; planes for hf_io_encode have the new size.
int hf_io_grow(struct hf_io_file *file, int view, struct hf_io_box box, float no_surface, const struct hf_io_run *run,
               struct hf_io_error *err);

// The properties of a depth file.
struct hf_io_map {
    int width, height;
    int bits;             // of its samples if they are integers, else 0
    long long sharpened;  // samples that lay between the two sides of an outline, and were moved
    long long smoothed;   // samples of gentle slopes that were smoothed from 8-bit terraces
};
// What to do with depths between the two sides of an outline, where nothing is.
enum hf_io_edges {
    HF_IO_EDGES_AUTO,  // sharpen maps of integers: these were painted, estimated or scaled down
    HF_IO_EDGES_KEEP,
    HF_IO_EDGES_SHARPEN,  // move them to the nearer side, before the map is scaled
};
// Read depth from a separate file in any format that OpenImageIO or OpenEXRCore reads: its depth channel, searched as
// above, or its only channel, or R. If its size is not the view's, the nearest samples are taken; width / height may
// differ by 1 %, and the width must be less than 5 times the view's. run NULL: outlines are sharpened on this thread.
int hf_io_read_depth_file(const char *path, const char *depth_channel, enum hf_io_edges edges,
                          const struct hf_io_view *view, const struct hf_io_run *run, float *depth,
                          struct hf_io_map *map, struct hf_io_error *err);

// What to write, and how. Zero is the default of every member.
struct hf_io_job {
    const char *path;
    const struct hf_io_result *results;
    int result_count;
    const char *compression;  // "none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab", or NULL:
                              // as it was
    int zip_level;  // of ZIP and ZIPS: 1, fast, to 12, small; 0: what makes files no longer than other programs' in little time
    const struct hf_io_text
        *texts;  // for the header of an EXR, in place of those of the same names, and with them a checksum of
                 // the file; DWA made from what is no EXR goes without
    int text_count;
    bool unsynced;                // do not wait for the disk: after a power failure the new file may be empty
    const struct hf_io_run *run;  // NULL: on this thread
};

// A new file in memory, ready to be saved.
struct hf_io_output;

// Make a copy of the file with the colours of some views replaced, to be saved as path. All else stays (windows,
// attributes, parts, channels and their types, tiling, compression, line order); unchanged parts are copied as raw
// chunks when the file is saved. The extension of path decides the format. An EXR source written in another format
// (png, tif, jpg ...) keeps only one view's colour. Formats of 8 and 16 bit integers get the sRGB curve, which reading
// removes; floats stay linear. If path is not .exr, results must hold exactly one view.
// When this returns, planes and job belong to the caller again. The file must stay open until the output is freed.
// *written is cleared first. written and err may be NULL.
int hf_io_encode(struct hf_io_output **out, struct hf_io_file *file, const struct hf_io_job *job,
                 struct hf_io_written *written, struct hf_io_error *err);
// Write the output to a temporary file beside path (.hyperfocal-MACHINE-PID-N.ext), then rename it; after an error
// nothing is left. path may be the source's own. May add a note to *written, which may be NULL.
int hf_io_save(struct hf_io_output *out, struct hf_io_written *written, struct hf_io_error *err);
void hf_io_output_free(struct hf_io_output **out);

// hf_io_encode and hf_io_save in one call.
int hf_io_write(struct hf_io_file *file, const struct hf_io_job *job, struct hf_io_written *written,
                struct hf_io_error *err);

// Planes of floats, to be written as a single-part EXR of float channels: intermediate buffers, tests.
struct hf_io_planes {
    int width, height, channels;
    const char *const *names;  // of the channels, in any order
    const float *const *data;  // a plane for each
    ptrdiff_t stride;          // floats from row to row
};
int hf_io_write_planes(const char *path, const struct hf_io_planes *planes, struct hf_io_error *err);

// Whether this name's format can be written. Call it before any work, so that no work is lost.
int hf_io_check_format(const char *path, struct hf_io_error *err);

// 1 if both names refer to one file, or would once something is written: other spellings and links are resolved.
int hf_io_same_file(const char *a, const char *b);

// After this, SIGTERM, SIGINT, SIGHUP, SIGPIPE and SIGXCPU remove the temporary files of this process before they take
// effect.
void hf_io_catch_signals(void);
// Do the same at once, from a signal handler.
void hf_io_end_by_signal(int number);

// 1 if this build can read and write formats other than EXR.
int hf_io_has_oiio(void);

// Bytes that an open file comes to hold until it is closed, its new one included, when all views are replaced: about, and
// without the caller's planes.
double hf_io_memory(const struct hf_io_file *file);
// Whether another process reads the file, or writes the new one: path (may be NULL), with that compression (NULL: the file's
// own). It makes one frame on one thread for most of the time.
int hf_io_is_helped(const struct hf_io_file *file, const char *path, const char *compression);

// What the sandbox in which formats other than EXR were read did not forbid, as one sentence; NULL if it was whole, or
// nothing was read so.
const char *hf_io_sandbox(void);

#ifdef __cplusplus
}
#endif

#endif
