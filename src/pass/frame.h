// SPDX-License-Identifier: BSD-3-Clause
// What a pass sees of a frame: its numbers, its buffers, the caller's images.
//
// Everything is processed in lanes of half-resolution pixels. A full-resolution row is split into its even and its odd
// pixels, so that lane x stands for pixels 2x and 2x + 1. So no pass ever shuffles: the quads of the downsample and the
// four phases of the upsampling are plain vector arithmetic.
#ifndef HF_FRAME_H
#define HF_FRAME_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "hyperfocal/hyperfocal.h"

// A half-open rectangle, in half-resolution pixels unless said otherwise.
struct hf_rect {
    int x0, y0, x1, y1;
};

// Each engine numbers its own buffers and passes; none has more than these.
enum { HF_MAX_BUFS = 32 };

// Up to four planes of floats at equal distances in memory. ch[c] is the address of the frame's pixel (0, 0); only a
// window of the frame is allocated, perhaps with a border. A narrow buffer (engine.h) holds numbers of hf_narrow_bytes
// instead.
struct hf_buf {
    float *ch[4];
    ptrdiff_t stride;  // in floats, for narrow buffers too
};

// How a depth sample d becomes the variable v in which CoC is linear (pixel/depth.c).
enum hf_depth_form {
    HF_FORM_Z,    // d is z
    HF_FORM_RAY,  // d is distance along the ray
    HF_FORM_IZ,   // 1/z = iz_a + iz_b * (e_a + e_b * d)
    HF_FORM_COC,  // d is the signed radius
};

// Highlights of clipped pictures (pixel/highlight.h).
struct hf_highlight {
    int on;
    float gain, more;         // what 1 becomes, and that minus 1
    float from, span, scale;  // the threshold; 1 minus it; and the inverse of that
};

// What follows from the arguments of a render call; the same for all engines. frame/resolve.c makes it. The engine may
// change it twice: when its parameters are resolved, and after the first pass has read the depth (engine.h: measure).
// Later passes see the change.
struct hf_setup {
    int width, height, half_width, half_height;
    enum hf_engine engine;
    int channels;             // channels that are blurred: 3, or 4 with alpha
    enum hf_storage storage;  // of colour and CoC between passes
    int faithful;             // the gather engine's parameter
    int zero_beyond;          // beyond the frame its buffers are 0, not repeats of its edge
    // The blur radius is known only after the depth pass, so no other pass runs before that one ends.
    int measured;

    // From a depth sample to the variable v.
    enum hf_depth_form form;
    int lens;                    // v is -1/z rather than z
    float e_a, e_b, iz_a, iz_b;  // HF_FORM_IZ
    float ray_cx, ray_cy;        // HF_FORM_RAY: optical axis, pixels
    float ray_sx, ray_sy;        // 1 / focal length squared, per axis

    // From v to near and far CoC, 0..1.
    float near_0, near_i;  // n = sat((near_0 - v) * near_i)
    float far_0, far_i;    // f = sat((v - far_0) * far_i)
    int smoothstep;        // of n and f

    float max_radius;  // rho, full-resolution pixels
    float strength;    // 1 outside the range model
    float pixel_aspect;
    struct hf_highlight highlight;

    // From v to a signed radius in full-resolution pixels, see hf_radius_row.
    float radius_0, radius_k;  // linear: r = (v - radius_0) * radius_k, within +-max_radius; radius_k 0: by range,
                               // r = strength * max_radius * (f - n)
    int uniform;               // instead every radius is max_radius
    float sharp_radius;        // pixels with at most this radius count as sharp, and get radius 0

    const struct hf_resolved *resolved;  // the parameters that the frame is rendered with
    const void *own;                     // what the engine computed from its parameters and the depth

    // The region of the result that is stored, in full-resolution pixels; part: it is not the whole frame.
    struct hf_rect region;
    int part;
    atomic_int *stop;  // not 0: the frame is cancelled, and passes return as soon as they see it (base/stop.h)
};

// Where a chunk has CoC of one field: a bit for each group of lanes (hf_group), and half-resolution rows.
struct hf_found {
    uint64_t groups;
    int y0, y1;
};

// What the passes count. One per worker.
struct hf_counts {
    uint64_t near_pixels, far_pixels, sharp_pixels;
    uint64_t colour_repaired, depth_repaired, no_surface, clamped;
    float radius_min, radius_max;      // from passes that make signed radii; HUGE_VALF and -HUGE_VALF before any
    float near_max, far_max;           // from passes that make near and far CoC
    float brightest, alpha_min;        // of the colour, if asked for
    uint64_t near_groups, far_groups;  // bit hf_group(x): this row has CoC in that group of lanes
    struct hf_found near, far;         // the same for a chunk
    // Of blurred pixels, if the engine's first sweep counts them: the largest absolute sample and the exponents in use,
    // eight exponents to a bit, for colour and for alpha; and how many pixels have an alpha other than 1.
    float largest[2];
    uint32_t exponents[2];
    uint64_t transparent;
};

// Lanes are counted in groups of 64. A frame may have more groups than a mask has bits; then groups share bits.
enum { HF_GROUP = 64 };
static inline int hf_group(int lane)
{
    return lane / HF_GROUP & 63;
}

// The first pass of a chunk calls this after each full-resolution row.
static inline void hf_found_row(struct hf_found *f, uint64_t *groups, int y)
{
    if (*groups) {
        f->y0 = f->groups ? f->y0 : y / 2;
        f->y1 = y / 2 + 1;
    }
    f->groups |= *groups;
    *groups = 0;
}

static inline void hf_count_row(struct hf_counts *c, int y)
{
    hf_found_row(&c->near, &c->near_groups, y);
    hf_found_row(&c->far, &c->far_groups, y);
}

struct hf_pixel_kernels;

// One worker's view of the frame.
struct hf_frame {
    const struct hf_setup *s;
    const struct hf_pixel_kernels *k;  // kernels that all engines share
    const void *kernels;               // the engine's own table
    const struct hf_image *src, *dst;
    const struct hf_depth *depth;
    struct hf_buf buf[HF_MAX_BUFS];
    int near, far;       // which fields the current tile needs
    int repaired;        // in place: repairs have been written into the picture, so all of it is finite
    int looking;         // nobody reads CoC of sharp chunks, so it need not be written
    float *lines;        // scratch rows, see hf_line
    float *depth_lines;  // HF_DEPTH_LINES further rows, see hf_depth_row
    size_t line_floats;  // length of each
    float *work;         // scratch that the engine asked for (engine.h: work)
    struct hf_counts *counts;
    struct hf_counts *seen;  // counts for colour that is read a second time: whether it needed repair, not how often
};

// A pass: computes rectangle r of its output buffers and nothing else. r lies inside the frame, in half-resolution
// pixels. May write up to HF_PAD floats past the end of each row.
typedef void hf_kernel(const struct hf_frame *f, struct hf_rect r);

enum { HF_DEPTH_LINES = 4 };  // two full-resolution rows of depth
enum { HF_LINES = 25 };       // scratch rows of a frame; the scatter's composite uses all of them
enum { HF_PAD = 32 };         // floats that a vector loop may write past a row's end; in a narrow row, as many bytes

// Scratch row i, 64-byte aligned.
static inline float *hf_line(const struct hf_frame *f, int i)
{
    return f->lines + (size_t)i * f->line_floats;
}

static inline float *hf_at(const struct hf_buf *b, int c, int x, int y)
{
    return b->ch[c] + (ptrdiff_t)y * b->stride + x;
}

// Bytes of a narrow buffer's CoC, by the storage: 8-bit, half or float.
static inline int hf_narrow_bytes(enum hf_storage storage)
{
    return storage == HF_STORAGE_PACKED ? 1 : storage == HF_STORAGE_HALF ? 2 : 4;
}

static inline char *hf_narrow_at(const struct hf_buf *b, int c, int x, int y, int bytes)
{
    return (char *)hf_at(b, c, 0, y) + (ptrdiff_t)x * bytes;
}

// Clamps to 0..1; NaN becomes 0.
static inline float hf_saturate(float v)
{
    v = v > 0 ? v : 0;
    return v < 1 ? v : 1;
}

static inline int hf_min(int a, int b)
{
    return a < b ? a : b;
}

static inline int hf_max(int a, int b)
{
    return a > b ? a : b;
}

#endif
