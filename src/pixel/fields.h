// SPDX-License-Identifier: BSD-3-Clause
// What the engines share that blur a near and a far field at half resolution (gather, chapter): the numbers of their first
// passes and buffers, the passes CoC generation and the near field's outward blur, and the way back to full resolution.
#ifndef HF_FIELDS_H
#define HF_FIELDS_H

#include "pass/engine.h"
#include "pixel/pass_c.h"

// In the order of the chapter's table 3.1. Each engine adds its own behind.
enum hf_fields_pass {
    HF_PASS_COC,
    HF_PASS_DOWN,
    HF_PASS_MAX_X,
    HF_PASS_MAX_Y,
    HF_PASS_BLUR_X,
    HF_PASS_BLUR_Y,
    HF_PASS_COMPUTATION,
    HF_PASS_OWN
};

// The buffers of the chapter's figure 3.6. Likewise.
enum hf_fields_buf {
    HF_BUF_COC,        // full resolution: near even, near odd, far even, far odd lanes of each row
    HF_BUF_COLOR4,     // half-resolution colour, R G B (A)
    HF_BUF_COLORFAR4,  // half-resolution colour x far CoC
    HF_BUF_COC4,       // half-resolution near and far CoC
    HF_BUF_MAX_X,      // near CoC: the four steps of its outward blur
    HF_BUF_MAX,
    HF_BUF_BLUR_X,
    HF_BUF_BLUR,
    HF_BUF_NEAR,  // fields: colour
    HF_BUF_FAR,
    HF_BUF_SUM,     // inside Computation: sums of weights, near and far
    HF_BUF_WEIGHT,  // what samples weigh with Karis average
    HF_BUF_OWN
};

// How far around a pixel a pass reads.
enum hf_fields_halo {
    HF_HALO_NONE,
    HF_HALO_MAX_X,  // reach of the near max, along one axis
    HF_HALO_MAX_Y,
    HF_HALO_BLUR_X,  // and of the near blur
    HF_HALO_BLUR_Y,
    HF_HALO_UPSAMPLE,  // one pixel, two for the cubic
    HF_HALO_TAPS,      // the engine's own from here on
    HF_HALO_OWN
};

#define HF_BIT(name) (1u << HF_BUF_##name)

// The rows of both tables. own: what else Downsample writes. CoC that the near field spreads by is channel near_coc of COC4.
#define HF_FIELDS_PASSES(own)                                                                                          \
    {"CoC generation", .writes = HF_BIT(COC), .sweep = 1, .ns = 1.7f},                                                 \
        {"Downsample", .reads = HF_BIT(COC), .writes = HF_BIT(COLOR4) | HF_BIT(COLORFAR4) | HF_BIT(COC4) | (own),      \
         .sweep = 1, .ns = 1.1f},                                                                                      \
        {"Near CoC Max X",                                                                                             \
         .around = HF_BIT(COC4),                                                                                       \
         .writes = HF_BIT(MAX_X),                                                                                      \
         .halo = HF_HALO_MAX_X,                                                                                        \
         .sweep = 2,                                                                                                   \
         .field = HF_NEAR,                                                                                             \
         .ns = 0.7f},                                                                                                  \
        {"Near CoC Max Y",                                                                                             \
         .around = HF_BIT(MAX_X),                                                                                      \
         .writes = HF_BIT(MAX),                                                                                        \
         .halo = HF_HALO_MAX_Y,                                                                                        \
         .sweep = 2,                                                                                                   \
         .field = HF_NEAR,                                                                                             \
         .ns = 0.25f},                                                                                                 \
        {"Near CoC Blur X",                                                                                            \
         .around = HF_BIT(MAX),                                                                                        \
         .writes = HF_BIT(BLUR_X),                                                                                     \
         .halo = HF_HALO_BLUR_X,                                                                                       \
         .sweep = 2,                                                                                                   \
         .field = HF_NEAR,                                                                                             \
         .ns = 0.25f},                                                                                                 \
    {                                                                                                                  \
        "Near CoC Blur Y", .around = HF_BIT(BLUR_X), .writes = HF_BIT(BLUR), .halo = HF_HALO_BLUR_Y, .sweep = 2,       \
                           .field = HF_NEAR, .ns = 0.27f                                                               \
    }

#define HF_FIELDS_BUFS                                                                                                 \
    [HF_BUF_COC] = {"coc", .y = 1}, [HF_BUF_COLOR4] = {"color4", .frame = 1, .field = HF_NEAR},                        \
    [HF_BUF_COLORFAR4] = {"colormulcoc4", .frame = 1, .field = HF_FAR}, [HF_BUF_COC4] = {"coc4", .frame = 1},          \
    [HF_BUF_MAX_X] = {"cocmaxx", .field = HF_NEAR, .narrow = 1},                                                       \
    [HF_BUF_MAX] = {"cocmax", .field = HF_NEAR, .narrow = 1},                                                          \
    [HF_BUF_BLUR_X] = {"cocblurx", .field = HF_NEAR, .narrow = 1}, [HF_BUF_BLUR] = {"cocblur", .field = HF_NEAR},      \
    [HF_BUF_NEAR] = {"near", .field = HF_NEAR}, [HF_BUF_FAR] = {"far", .field = HF_FAR}

// The first member of what both engines make of their parameters.
struct hf_fields {
    int near_coc;      // the channel of COC4 that spreads
    int max_x, max_y;  // near max reach to either side
    int blur_x, blur_y;
    float edge_x, edge_y;  // how much the outermost values in reach count, 0..1: 1 but between whole reaches of taps
    int karis, per_pixel_kernel, bicubic;
    float blend;     // of the fields with the picture: less than 1 below a strength of a quarter
    int smoothstep;  // measured: of the CoC, and how it is stored, once the radii are known
    enum hf_storage storage;
};

static inline const struct hf_fields *hf_fields(const struct hf_setup *s)
{
    return s->own;
}

// Channels of the buffers above.
int hf_fields_channels(const struct hf_setup *s, int buf);
struct hf_reach hf_fields_halo(const struct hf_setup *s, int halo);

// Where radii are found in the depth (engine.h, measured): the largest, full-resolution pixels. More costs more than the
// other engines.
enum { HF_FIELDS_RADIUS = 256 };

// The radius of a frame for which none is given, or why not.
void hf_fields_limit(struct hf_settings *r);
static inline int hf_fields_are_measured(const struct hf_settings *r)
{
    return r->limit == HF_LIMIT_ENGINE;
}
// Until the radii are known the CoC is the radius over the largest there may be, which a byte cannot hold, and nothing has
// a reach.
void hf_fields_wait(struct hf_fields *g, struct hf_setup *s);
// The largest radius of each field, near and far, at least a pixel.
void hf_fields_found(const struct hf_setup *s, const struct hf_counts *found, float radius[2]);
// From now on each field's CoC is relative to one of these radii.
void hf_fields_scale(const struct hf_fields *g, struct hf_setup *s, const float radius[2]);

// One over what 2 m + 1 values weigh, the outermost of them by edge.
static inline float hf_blur_scale(int m, float edge)
{
    return 1 / ((float)(2 * m + 1) - 2 * (1 - edge));
}

// A sample's Karis weight.
static inline float hf_karis_weight(float red, float green, float blue)
{
    const float luma = (0.2126f * red + 0.7152f * green) + 0.0722f * blue;
    return 1 / (1 + (luma > 0 ? luma : 0));
}

// Shared passes.
hf_kernel hf_coc_pass, hf_max_x, hf_max_y, hf_blur_x, hf_blur_y;
hf_kernel hf_max_x_c, hf_max_y_c, hf_blur_x_c, hf_blur_y_c;
#define HF_FIELDS_KERNELS                                                                                              \
    [HF_PASS_COC] = hf_coc_pass, [HF_PASS_MAX_X] = hf_max_x, [HF_PASS_MAX_Y] = hf_max_y, [HF_PASS_BLUR_X] = hf_blur_x, \
    [HF_PASS_BLUR_Y] = hf_blur_y

// So limited; NaN, as of a sum of two infinities, becomes the least.
static inline float hf_limited(float v, float largest)
{
    v = v > -largest ? v : -largest;
    return v < largest ? v : largest;
}

// The half-resolution neighbourhood of a full-resolution pixel: its own half-resolution pixel (x, y) and the
// neighbours on the side where the pixel lies.
struct hf_phase {
    int x, y;    // own
    int nx, ny;  // neighbour's column and row
};

typedef float hf_upsampling(const struct hf_buf *b, int c, struct hf_phase p);
// Sixteen times the bilinear value at a quarter of the way to the neighbour, in x first. Thrice a number and itself are
// four times it, rounded or not: constants stay exact.
hf_upsampling hf_upsample;
// Uniform cubic B-spline there.
hf_upsampling hf_upsample_cubic;

// Uniform cubic B-spline a quarter of a pixel off the centre: weights of the neighbour on that side, of the one on
// the other side, and of the one behind the neighbour. The rest, 235/384, is the pixel's own.
#define CUBIC_NEIGHBOUR (121 / 384.0f)
#define CUBIC_OTHER (27 / 384.0f)
#define CUBIC_BEHIND (1 / 384.0f)

// Put a field over lane i of the colour of the pixel p; coc: its far CoC.
typedef void hf_blend_far(const struct hf_frame *f, struct hf_phase p, float coc, float *const colour[4], int i);
typedef void hf_blend_near(const struct hf_frame *f, struct hf_phase p, float *const colour[4], int i);
// Composite in C: the fields that there are, the far one first.
void hf_composite_with(const struct hf_frame *f, struct hf_rect r, hf_blend_far *far, hf_blend_near *near);

#endif
