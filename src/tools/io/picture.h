// SPDX-License-Identifier: BSD-3-Clause
// The contents of a picture file, independent of its format: windows, camera, views.
#ifndef HF_IO_PICTURE_H
#define HF_IO_PICTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tools/io/error.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    HF_IO_MAX_SIDE = 65536,          // widest and tallest picture
    HF_IO_MAX_COORDINATE = 1 << 30,  // windows stay within +- this, so that no difference of two overflows
};

// Camera attributes of a header; NAN if the header has none. Names are those of the EXR attributes.
struct hf_io_camera {
    float focus;              // metres
    float f_number;           // "aperture"
    float focal_length_mm;    // "pinholeFocalLength"
    float sensor_width_mm;    // "sensorOverallDimensions".x
    float nominal_length_mm;  // "nominalFocalLength": what is written on the lens
    // Distance along the camera's axis of a point x, y, z of the world: |axis . (x, y, z, 1)|, from "worldToCamera", else from
    // "worldToNDC". The first is NAN if the header has neither.
    float axis[4];
    bool exif;  // the lens is that of a photograph's EXIF
};

struct hf_io_box {
    int x0, y0, x1, y1;  // x1, y1 exclusive
};

// One picture that can be defocused: a set of colour channels and their depth. A stereo file has one for each view.
struct hf_io_view {
    char name[64];        // view name ("left"), or "" when the file names none
    char layer[256];      // layer of its colours ("ViewLayer.Combined"), or "" for one without a name
    int part;             // part that holds the colour
    int depth_part;       // part that holds the depth; -1: no depth channel found
    char colour[4][256];  // full channel names of R, G, B, A in the part; "" when there is no such channel
    char depth[256];      // full channel name of the depth; ""
    int width, height;    // of the colour's data window
    struct hf_io_box data_window, display_window;
    float pixel_aspect;
    double frame_rate;                       // "framesPerSecond"; 0: the header does not say
    float screen_center_x, screen_center_y;  // screenWindowCenter
    float screen_width;                      // screenWindowWidth
    struct hf_io_camera camera;
    // For a photograph: how to turn it upright, in EXIF's numbering, 1 upright; 0 unknown. Pixels are never turned.
    int orientation;
    bool deep;     // any number of samples in a pixel: see hf_io_deep
    bool profile;  // it has a colour profile other than sRGB's, which is not used: the colours count as sRGB
};

// The views of a file, a growing list.
struct hf_io_views {
    int count;
    struct hf_io_view *view;
};

// How to look for a file's pictures. NULL members: by the usual search.
struct hf_io_choice {
    const char *depth_channel;  // full name of the depth channel of every view
    const char *layer;          // names of layers with commas between, or "all"; NULL: the main one
};

// New colour for a view. planes[c] NULL: the channel stays as it was. Greyscale files take the Rec. 709 luminance of
// the three.
struct hf_io_result {
    int view;
    const float *planes[4];
    const float
        *guessed;  // of an EXR: the channel guessed beside the colours, which the file gets if it has none; NULL: no
};

// A text in a file's header: an EXR attribute of type string, with a name of at most 31 characters.
struct hf_io_text {
    const char *name, *value;
};

// Facts about a written picture.
struct hf_io_written {
    uint64_t clamped;          // samples too large for a half channel, which became +-65504
    char note[HF_IO_MESSAGE];  // a sentence about what could not be kept, or ""
};

// Append a view, all zero. NULL when there is no memory.
struct hf_io_view *hf_io_add_view(struct hf_io_views *views);

// The full name of the channel guessed of a view: that of its red with this last piece.
void hf_io_guessed_name(const struct hf_io_view *v, char name[256]);

// The part of the file's name after the last dot, or "".
const char *hf_io_extension(const char *path);
bool hf_io_is_exr_name(const char *path);

// 0, or -1 with *err filled when the window is empty, too large, or too far away.
int hf_io_check_window(const char *path, const char *which, struct hf_io_box box, struct hf_io_error *err);

// Append a name, and a remark on it, to a list "a, b, c" in buf; text that does not fit is cut off.
void hf_io_list(char *buf, size_t size, const char *part, const char *name, const char *said);

// Find the name in such a list that is nearest to a misspelt one, or one of its pieces (Fg of Fg.Combined). Returns 0
// if none is near.
int hf_io_nearest(const char *list, const char *wanted, char nearest[256]);

// Memory for pixels, on large pages if there are any: one page fault for each 2 MiB instead of 4 KiB. To be freed with
// free(); NULL without memory.
void *hf_io_alloc(size_t size);

// The bytes of a file in memory; data is to be freed.
struct hf_io_bytes {
    uint8_t *data;
    size_t size;
};

// Samples as OpenEXR stores them: row after row, in a row channel after channel, in alphabetical order, little endian.
// All channels have full resolution.
struct hf_io_samples {
    int x, y, width, height;  // the data window
    int channel_count;
    const char *const *names;
    const uint8_t *types;         // 0 uint, 1 half, 2 float
    int tile_width, tile_height;  // 0: scan lines
    size_t row_bytes;
    uint8_t *data;  // height * row_bytes
    int threads;    // how many may work on them; 0: one per processor
};

#ifdef __cplusplus
}
#endif

#endif
