// SPDX-License-Identifier: BSD-3-Clause
// Picture files for the programs (the library itself knows no files). The floors: errors, pictures, files being written
// and threads (error, picture, out, half, run); on them, beside each other, EXR by OpenEXRCore (exr) and everything
// else by OpenImageIO (oiio); on top what chooses between them (file, write). Nothing here prints.
//
// A frame goes through stages, which a program may overlap with those of other frames:
//
//     hf_io_open     headers                                          a few reads
//     hf_io_fetch    bytes of the chunks that will be needed          disk alone
//     hf_io_decode   planes of floats                                 computing, on the caller's threads
//     hf_io_encode   the bytes of the new file, in memory             computing, on the caller's threads
//     hf_io_save     a temporary file, then renamed                   disk alone
//
// Each stage of one file may run on another thread than the one before, but two stages of a file never run at the same
// time. Different files know nothing of each other.
#ifndef HF_IO_H
#define HF_IO_H

#include "tools/io/picture.h"
#include "tools/io/run.h"

#ifdef __cplusplus
extern "C" {
#endif

// An open picture file: headers parsed, no pixels read.
struct hf_io_file;

// Open a file and find its views, each with the depth of its own layer, as the choice says (NULL: the main layer, and
// the depth that programs write beside it). A layer's name may be its whole name (ViewLayer.Combined), its first pieces
// (ViewLayer), or its last one; a wrong one is an error that suggests the nearest. A view without depth is no error
// here: it has depth_part -1, and hf_io_channels says which channels there are. A file without colour (R, G, B or Y),
// or with several layers none of which is clearly the picture, is an error that lists what there is. Returns 0, or -1
// with *err filled.
// Header sizes are not trusted: nothing is allocated in proportion to a data window before its pixels are asked for
// and the file has been seen to be long enough to hold its chunk table.
int hf_io_open(struct hf_io_file **out, const char *path, const struct hf_io_choice *choice, struct hf_io_error *err);
void hf_io_close(struct hf_io_file **file);

int hf_io_view_count(const struct hf_io_file *file);
const struct hf_io_view *hf_io_view(const struct hf_io_file *file, int view);
// All channel names of the file, "R, G, B, Z" (part names before a colon when there are several parts), truncated to
// size.
void hf_io_channels(const struct hf_io_file *file, char *buf, size_t size);

// Names of other layers with a depth of their own, which the choice NULL has left out, "Foreground.Combined, Hair": one
// for each depth, "and 2 more" behind the fourth. Returns how many; cut off at size.
int hf_io_other_layers(const struct hf_io_file *file, char *buf, size_t size);

// The name of a part; "" where there is but one.
const char *hf_io_part_name(const struct hf_io_file *file, int part);

// A text in the header of an EXR file's first part, cut off at size; "" when there is none. Returns buf.
const char *hf_io_text(const struct hf_io_file *file, const char *name, char *buf, size_t size);
// Are all chunks of an EXR file there, as long as they say and none after the file's end? Looks at no pixels. 0, or -1
// with *err filled, also for files that are no EXR.
int hf_io_check_whole(const struct hf_io_file *file, struct hf_io_error *err);

// What to read of a view: tightly packed planes of width * height floats, the caller's; NULL what is not wanted.
struct hf_io_want {
    int view;
    // R, G, B, A. A channel that the file does not have is left alone; greyscale files fill R, G and B with the same.
    // Values are the file's, NaN and Inf included.
    float *planes[4];
    // On the grid of the colour's data window. Where the depth's own data window does not reach: +Inf (no surface).
    // An error when there is no overlap at all, or no depth channel.
    float *depth;
};

// Read the bytes that hf_io_decode of the same views will need into memory that the file owns. Optional: without it
// decode reads as it goes. What planes point at does not matter, only whether they are NULL.
int hf_io_fetch(struct hf_io_file *file, const struct hf_io_want *wants, int count, struct hf_io_error *err);
// Decode what is wanted, each chunk once. run NULL: on this thread. The file keeps what is not colour or depth as it
// was stored, until hf_io_encode or hf_io_close; nothing is decoded a second time.
int hf_io_decode(struct hf_io_file *file, const struct hf_io_want *wants, int count, const struct hf_io_run *run,
                 struct hf_io_error *err);

// The same for one view's colour or depth, in one call on this thread.
int hf_io_read_colour(struct hf_io_file *file, int view, float *planes[4], struct hf_io_error *err);
int hf_io_read_depth(struct hf_io_file *file, int view, float *depth, struct hf_io_error *err);
// Some rows of the depth, counted from the top of the data window, into their places in the plane: of an EXR only the
// chunks in which they lie are decoded.
int hf_io_read_depth_rows(struct hf_io_file *file, int view, int first, int count, float *depth,
                          struct hf_io_error *err);
// Take another display window for a view than the file's, which keeps its own.
void hf_io_set_display(struct hf_io_file *file, int view, struct hf_io_box box);
// Give the part of a view a larger data window, which must hold the old one: all its views have it then, and so will the
// file that hf_io_encode makes. What is new is 0 in all channels but the depths of views, which are no_surface there.
// After hf_io_decode; planes for hf_io_encode are of the new size.
int hf_io_grow(struct hf_io_file *file, int view, struct hf_io_box box, float no_surface, const struct hf_io_run *run,
               struct hf_io_error *err);

// What a depth file is.
struct hf_io_map {
    int width, height;
    int bits;             // of its samples when they are whole numbers, else 0
    long long sharpened;  // samples that lay between the two sides of an outline
    long long smoothed;   // samples of gentle slopes that 8 bits had made terraces of
};
// What becomes of depths between the two sides of an outline, at which there is nothing.
enum hf_io_edges {
    HF_IO_EDGES_AUTO,  // sharpen whole numbers: maps that were painted, estimated or made smaller
    HF_IO_EDGES_KEEP,
    HF_IO_EDGES_SHARPEN,  // they go to the nearer side, before the map is scaled
};
// Depth from a file of its own, any format OpenImageIO or OpenEXRCore reads: its depth channel as searched above (or
// its only channel, or R). When its size is not the view's, the nearest samples are taken; width / height may differ by
// 1 %, and the width be less than 5 times the view's. run NULL: outlines are sharpened on this thread.
int hf_io_read_depth_file(const char *path, const char *depth_channel, enum hf_io_edges edges,
                          const struct hf_io_view *view, const struct hf_io_run *run, float *depth,
                          struct hf_io_map *map, struct hf_io_error *err);

// What to write, and how. All that is zero is the default.
struct hf_io_job {
    const char *path;
    const struct hf_io_result *results;
    int result_count;
    const char *compression;  // "none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab", or NULL:
                              // as it was
    const struct hf_io_text
        *texts;  // for the header of an EXR, in place of those of the same names; DWA made from what
                 // is no EXR goes without
    int text_count;
    bool unsynced;                // do not wait until the disk has it: after a power failure the new file may be empty
    const struct hf_io_run *run;  // NULL: on this thread
};

// A new file in memory, ready to be saved.
struct hf_io_output;

// Make a copy of the file, to be saved as path, with the colours of some views replaced: everything else (windows,
// attributes, parts, channels and their types, tiling, compression, line order) stays; parts with nothing to change are
// copied as raw chunks when it is saved. The format follows path's extension; an EXR source written as something else
// (png, tif, jpg ...) keeps only one view's colour; formats of 8 and 16 bit integers get the sRGB curve (reading takes
// it off again), floats stay linear. When path is not .exr, results must hold exactly one view.
// The planes and the job are the caller's again when this returns; the file must stay open until the output is freed.
// written (which is set to zero first) and err may be NULL.
int hf_io_encode(struct hf_io_output **out, struct hf_io_file *file, const struct hf_io_job *job,
                 struct hf_io_written *written, struct hf_io_error *err);
// Write it to a temporary file beside path (.hyperfocal-MACHINE-PID-N.ext), then rename; on error nothing is left. path may be
// the source's own. A note may be added to *written, which may be NULL.
int hf_io_save(struct hf_io_output *out, struct hf_io_written *written, struct hf_io_error *err);
void hf_io_output_free(struct hf_io_output **out);

// Both in one call.
int hf_io_write(struct hf_io_file *file, const struct hf_io_job *job, struct hf_io_written *written,
                struct hf_io_error *err);

// Planes of floats, for a new single-part EXR of float channels: intermediate buffers, tests.
struct hf_io_planes {
    int width, height, channels;
    const char *const *names;  // of the channels, in any order
    const float *const *data;  // a plane for each
    ptrdiff_t stride;          // floats from row to row
};
int hf_io_write_planes(const char *path, const struct hf_io_planes *planes, struct hf_io_error *err);

// Can a picture be written under this name, as far as its format goes? Before any work, so that it is not in vain.
int hf_io_check_format(const char *path, struct hf_io_error *err);

// 1 if both names are of one file, or would be if something were written: other spellings and links are looked through.
int hf_io_same_file(const char *a, const char *b);

// SIGTERM, SIGINT, SIGHUP, SIGPIPE and SIGXCPU remove the temporary files of this process, then do what they do.
void hf_io_catch_signals(void);
// The same at once, from a signal's handler.
void hf_io_end_by_signal(int number);

// 1 if this build can read and write anything but EXR.
int hf_io_has_oiio(void);

#ifdef __cplusplus
}
#endif

#endif
