// SPDX-License-Identifier: BSD-3-Clause
// What a pass sees of a frame: its numbers, its buffers, the caller's images.
//
// Everything is processed in half-resolution lanes. A full-resolution row is kept split into its even and its odd
// pixels, so that lane x stands for the pixels 2x and 2x + 1 and no pass ever shuffles: the quad of the downsample
// and the four phases of the upsampling are plain vector arithmetic.
#ifndef HF_FRAME_H
#define HF_FRAME_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "hyperfocal/hyperfocal.h"

// A rectangle: x0 <= x < x1, y0 <= y < y1, in half-resolution pixels unless said otherwise.
struct hf_rect {
    int x0, y0, x1, y1;
};

// Each engine numbers its own buffers and passes; none has more than these.
enum { HF_MAX_BUFS = 32, HF_MAX_PASSES = 12 };

// How many engines there are.
enum { HF_ENGINE_COUNT = HF_ENGINE_CHAPTER + 1 };

// What parameters come to for a picture; hf_resolve tells most of it.
struct hf_settings {
    struct hf_params params;  // without HF_DERIVE
    int width, height;        // of the image
    enum hf_limit limit;      // what set params.max_radius
    int rings_given;          // 1: params.gather.rings was; 0: it is rounded up
    float lens_k;             // K, scene units * pixels; 0 unless the lens is in use
    float focal_px;           // focal length of the lens, pixels of the display width
    int sharp;                // nothing can be blurred: the frame will be a copy
};

// Up to four planes of floats, all the same distance apart. ch[c] is where pixel (0, 0) of the frame would be; what is
// allocated is a window of the frame, perhaps with a border around it. A narrow buffer (engine.h) holds numbers of
// hf_narrow_bytes instead.
struct hf_buf {
    float *ch[4];
    ptrdiff_t stride;  // floats, whatever it holds
};

// How a depth sample d becomes the variable v in which CoC is linear (params.c).
enum hf_depth_form {
    HF_FORM_Z,    // d is z
    HF_FORM_RAY,  // d is distance along the ray
    HF_FORM_IZ,   // 1/z = iz_a + iz_b * (e_a + e_b * d)
    HF_FORM_COC,  // d is the signed radius
};

// Highlights of clipped pictures (pixel/highlight.h).
struct hf_highlight {
    int on;
    float gain, more;         // what 1 becomes, and how much more that is
    float from, span, scale;  // the threshold, what lies between it and 1, and 1 over that
};

// What follows from the arguments of a render call, the same for all engines. frame/resolve.c makes it, and the engine may
// change it twice: when its parameters are resolved, and once the first pass has looked at the depth (engine.h: measure).
// Other passes see what it is then.
struct hf_setup {
    int width, height, half_width, half_height;
    enum hf_engine engine;
    int channels;             // blurred: 3, or 4 with alpha
    enum hf_storage storage;  // of colour between passes, and of CoC
    // The blur radius is known only after the depth pass; nothing else runs before it.
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
    int uniform;               // instead r is max_radius, whatever v is
    float sharp_radius;        // up to here a pixel counts as sharp, and its radius as 0

    const struct hf_settings *resolved;  // the parameters that the frame is rendered with
    const void *own;                     // what the engine computed from its parameters and the depth

    // Of the result, full-resolution pixels, that is stored; part: that is not all of it.
    struct hf_rect region;
    int part;
    int several;       // surfaces are known that the picture hides: any tile with blur may show light of both fields
    atomic_int *stop;  // not 0: the frame is cancelled, and passes return as soon as they see it (base/stop.h)
};

// Where a chunk has CoC of a kind: groups of lanes, see hf_group, 0 if nowhere; and half-resolution rows.
struct hf_found {
    uint64_t groups;
    int y0, y1;
};

// What the passes count. One per worker.
struct hf_counts {
    uint64_t near_pixels, far_pixels, sharp_pixels;
    uint64_t colour_repaired, depth_repaired, no_surface, clamped;
    uint64_t guessed, looked_at;   // shares of light that was guessed, in 2^-24ths of a pixel, and of how many pixels
    float radius_min, radius_max;  // of passes that make signed radii; before any, HUGE_VALF and -HUGE_VALF
    float near_max, far_max;       // of those that make near and far CoC
    float brightest, alpha_min;    // of the colour, if somebody asks
    uint64_t near_groups, far_groups;  // bit hf_group(x): there is CoC in that group of lanes of a row
    struct hf_found near, far;         // and of a chunk
    // Of blurred pixels, if the engine's first sweep notes it: the largest absolute sample, and which exponents there are,
    // eight to a bit; of colour, and of alpha. And how many have another alpha than 1.
    float largest[2];
    uint32_t exponents[2];
    uint64_t transparent;
};

// Lanes are looked at in groups of 64; there may be more than bits, then several share one.
enum { HF_GROUP = 64 };
static inline int hf_group(int lane)
{
    return lane / HF_GROUP & 63;
}

// What the first pass of a chunk does after each of its full-resolution rows.
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
    const struct hf_pixel_kernels *k;  // what all engines share
    const void *kernels;               // the engine's own table
    const struct hf_image *src, *dst;
    const struct hf_depth *depth;
    struct hf_buf buf[HF_MAX_BUFS];
    int near, far;       // which fields the tile at hand needs
    int repaired;        // in place: the picture is finite, repairs have been written into it
    int looking;         // nobody reads the CoC where there is none: it need not be written
    float *lines;        // scratch rows, see hf_line
    float *depth_lines;  // and HF_DEPTH_LINES more, see hf_depth_row
    size_t line_floats;  // length of each
    float *work;         // scratch that the engine asked for
    struct hf_counts *counts;
    struct hf_counts *seen;  // for colour read a second time: whether there was something to repair, not how often
};

// Computes r of the pass's output buffers, nothing else: r lies inside the frame, in half-resolution pixels. May
// write up to HF_PAD floats past the end of each row of them.
typedef void hf_kernel(const struct hf_frame *f, struct hf_rect r);

enum { HF_DEPTH_LINES = 4 };  // two rows of depth of full resolution
enum { HF_LINES = 25 };       // scratch rows a frame has; scatter's composite uses them all
enum { HF_PAD = 32 };  // floats that a vector loop may write past the end of a row; of a narrow one as many bytes

// Scratch row i, 64-byte aligned.
static inline float *hf_line(const struct hf_frame *f, int i)
{
    return f->lines + (size_t)i * f->line_floats;
}

static inline float *hf_at(const struct hf_buf *b, int c, int x, int y)
{
    return b->ch[c] + (ptrdiff_t)y * b->stride + x;
}

// Narrow buffers hold CoC as the storage does: 8-bit, half, float.
static inline int hf_narrow_bytes(enum hf_storage storage)
{
    return storage == HF_STORAGE_PACKED ? 1 : storage == HF_STORAGE_HALF ? 2 : 4;
}

static inline char *hf_narrow_at(const struct hf_buf *b, int c, int x, int y, int bytes)
{
    return (char *)hf_at(b, c, 0, y) + (ptrdiff_t)x * bytes;
}

// fmaxf() of numbers, without a call.
static inline float hf_larger(float a, float b)
{
    return a > b ? a : b;
}

// From 0 to 1 without a corner at either end.
static inline float hf_smoothstep(float t)
{
    return (t * t) * (3 - 2 * t);
}

// 0..1; NaN becomes 0.
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
