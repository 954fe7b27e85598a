// SPDX-License-Identifier: BSD-3-Clause
// What the gather's files share: its passes and buffers, what it makes of its parameters, its kernels.
#ifndef HF_GATHER_H
#define HF_GATHER_H

#include "pass/engine.h"
#include "engine/gather/taps.h"
#include "pixel/pass_c.h"

// In the order of the chapter's table 3.1.
enum hf_gather_pass {
    HF_GATHER_COC,
    HF_GATHER_DOWN,
    HF_GATHER_MAX_X,
    HF_GATHER_MAX_Y,
    HF_GATHER_BLUR_X,
    HF_GATHER_BLUR_Y,
    HF_GATHER_COMPUTATION,
    HF_GATHER_FILL,
    HF_GATHER_COMPOSITE,
    HF_GATHER_PASSES
};

// The buffers of the chapter's figure 3.6.
enum hf_gather_buf {
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
    HF_BUF_NEAR_FILL,
    HF_BUF_FAR_FILL,
    HF_BUF_SUM,         // inside the gather: sums of weights, near and far
    HF_BUF_WEIGHT,      // with Karis average: w and far CoC x w; by area w, the largest channel, and what counts of it
    HF_BUF_COLORW4,     // colour x w
    HF_BUF_COLORFARW4,  // colour x far CoC x w
    // By area (see struct hf_gather):
    HF_BUF_COLORNEAR4,    // colour x near CoC
    HF_BUF_COVER,         // how much of a pixel the near field covers
    HF_BUF_LEVEL,         // one level's part of a field: colour ...
    HF_BUF_LEVEL_WEIGHT,  // ... and its weights
    HF_BUF_LEVEL_SUM,     // and their means
    HF_BUF_LEVEL_WEIGHT_SUM,
    HF_BUF_BEHIND,  // what near pixels hide, and far levels so far: colour, and its weights
    HF_BUF_BEHIND_WEIGHT,
    HF_BUF_SPREAD,  // what all far levels spread
    HF_BUF_SPREAD_WEIGHT,
    HF_BUF_FAR_PART,  // how much of a pixel is out of focus, far or near
    HF_BUF_COUNT
};

// How far around a pixel a pass reads.
enum hf_gather_halo {
    HF_HALO_NONE,
    HF_HALO_3X3,    // one pixel
    HF_HALO_MAX_X,  // reach of the near max, along one axis
    HF_HALO_MAX_Y,
    HF_HALO_BLUR_X,  // and of the near blur
    HF_HALO_BLUR_Y,
    HF_HALO_TAPS,
    HF_HALO_UPSAMPLE,  // one pixel, two for the cubic
};

// The channels of half-resolution CoC by area: the mean near and far CoC of a quad, as weights of its colour; and the
// largest near and far CoC of it, the latter for levels.
enum { HF_AREA_NEAR, HF_AREA_FAR, HF_AREA_NEAR_MOST, HF_AREA_FAR_MOST };

// A kernel as large as some pixels' blur. CoC is relative to the largest radius.
struct hf_level {
    float coc;      // the CoC of pixels as blurred as this
    float inverse;  // 1 / coc
    float again;    // of near ones: how much of it the one before sees already, 0 where that is a whole step larger
    float to_next;  // 1 / (coc - that of the next one)
    float area;     // coc^2, and as for coc:
    float area_to_next;
    float half_far;  // of near ones: times a far CoC, its radius in diameters of this
    struct hf_taps taps;
};

enum { HF_MAX_LEVELS = 34 };

// A far pixel sees what is blurred up to so much more than itself.
#define HF_FAR_WIDER (16 / 9.0f)

// One field's kernels, the largest first. A pixel between two of them is a blend of both; one that is blurred less than the
// smallest is a blend of that and the picture.
struct hf_levels {
    int count;
    float gain;  // 1 / coc of the smallest: min(1, gain x CoC) is a pixel's part in the field
    // Of near pixels: min(1, hides x CoC) is how far the field hides the picture where they are: as gain, but where there is
    // one kernel alone, wholly from seven eighths of its radius on. A light in a mixed pixel would shine through as a speck.
    float hides;
    struct hf_level level[HF_MAX_LEVELS];
};

// area: the default look. Apertures are areas instead of taps, so that nothing is left to fill and highlights are round;
// every sample of a quad counts by its own CoC; the near field is what is near, by how much of a pixel it covers; and
// what lies beyond the frame counts for nothing. Without it the passes are the chapter's.
struct hf_gather {
    float blend;  // of the fields with the picture: less than 1 below a strength of a quarter
    int area;
    struct hf_levels levels[2];  // near, far
    int karis, per_pixel_kernel, bicubic;
    int lights;         // measured, by area: how far apart what is beside a light is looked at; else 0
    enum hf_fill fill;  // of OPEN as of NONE: they differ in the taps
    enum hf_downsample downsample;
    enum hf_division division;
    int rings;
    int max_x, max_y;  // near max reach to either side
    int blur_x, blur_y;
    float edge_x, edge_y;  // how much the outermost values in reach count, 0..1: 1 but between whole reaches of taps
    int smoothstep;        // measured: of the CoC, and how it is stored, once the radii are known
    enum hf_storage storage;
    struct hf_taps taps;      // of both fields
    struct hf_taps far_taps;  // measured: of the far one
};

static inline const struct hf_gather *hf_gather(const struct hf_setup *s)
{
    return s->own;
}

// One over what 2 m + 1 values weigh, the outermost of them by edge.
static inline float hf_blur_scale(int m, float edge)
{
    return 1 / ((float)(2 * m + 1) - 2 * (1 - edge));
}

// Taps: what a pixel becomes where there is near CoC, v, or what it was. The chapter takes v wherever there is any; then what
// the near field begins to reach changes at once, and lights up what is beside. So it comes in by and by, up to an eighth.
#define HF_NEAR_WHOLE 8.0f
static inline float hf_near_part(const struct hf_setup *s, float own, float v, float blur)
{
    const float part = HF_NEAR_WHOLE * blur;
    return !(blur > 0) ? own : s->faithful || part >= 1 ? v : own + part * (v - own);
}

static inline const struct hf_taps *hf_gather_taps(const struct hf_setup *s, unsigned field)
{
    return field == HF_FAR && s->measured ? &hf_gather(s)->far_taps : &hf_gather(s)->taps;
}

// How much a pixel of this CoC takes from a level. All levels' shares sum to 1 exactly: each is one of u, 1 - u and 0.
static inline float hf_level_reached(const struct hf_levels *l, int i, float coc)
{
    return i < 0 ? 0 : i == l->count - 1 ? 1 : hf_saturate((coc - l->level[i + 1].coc) * l->level[i].to_next);
}

static inline float hf_level_share(const struct hf_levels *l, int i, float coc)
{
    return hf_level_reached(l, i, coc) * (1 - hf_level_reached(l, i - 1, coc));
}

// How much a near pixel of this CoC takes from a level of what it hides: of each up to its own, by the inverse of its area
// squared. So a sample counts by the inverse of its distance to the fourth, and a light far off draws no large disc there.
static inline float hf_level_near(const struct hf_levels *l, int i, float coc)
{
    const float part = hf_level_reached(l, i, coc) * (1 - hf_level_reached(l, i - 1, coc) * l->level[i].again);
    return part * (l->level[i].inverse * l->level[i].inverse);
}

// How much of a far sample a level spreads. Both discs together are as bright inside the smaller one as a disc of its own
// radius, and have its light; between them they are dimmer. (Shares that are linear in the radius leave the smaller one
// much brighter.)
static inline float hf_level_area(const struct hf_levels *l, int i, float area)
{
    if (i < 0 || i == l->count - 1)
        return i >= 0;
    return hf_saturate((area - l->level[i + 1].area) * l->level[i].area_to_next);
}

static inline float hf_level_spread(const struct hf_levels *l, int i, float coc)
{
    const float own = coc * coc, least = l->level[l->count - 1].area, area = own > least ? own : least;
    return hf_level_area(l, i, own) * (1 - hf_level_area(l, i - 1, own)) * (l->level[i].area / area);
}

// How much a far pixel takes of what a level and the smaller ones spread. Shares sum to 1 exactly.
static inline float hf_level_seen(const struct hf_levels *l, int i, float coc)
{
    const float least = l->level[l->count - 1].coc;
    return hf_level_share(l, i, (coc > least ? coc : least) * HF_FAR_WIDER);
}

// A row's Karis weight.
static inline float hf_karis_weight(float red, float green, float blue)
{
    const float luma = (0.2126f * red + 0.7152f * green) + 0.0722f * blue;
    return 1 / (1 + (luma > 0 ? luma : 0));
}

static inline const struct hf_levels *hf_gather_levels(const struct hf_setup *s, unsigned field)
{
    return &hf_gather(s)->levels[field == HF_FAR];
}

// Is a field one convolution of what there is?
static inline int hf_gather_is_simple(const struct hf_setup *s, unsigned field)
{
    return hf_gather_levels(s, field)->count == 1 && !hf_gather(s)->karis;
}

// Do levels of what near pixels hide leave anything to the far levels?
static inline int hf_gather_leaves(const struct hf_setup *s)
{
    return hf_gather_levels(s, HF_NEAR)->count > 1 && hf_gather_levels(s, HF_FAR)->count > 1;
}

// How much of a sample of this far CoC a level of what near pixels hide leaves to the far levels: what is blurred more
// than twice as much itself would be too sharp in it, a light a small bright disc before the large one that it is beside. The largest leaves nothing.
static inline float hf_level_left(const struct hf_levels *l, int i, float far)
{
    const float times = far * l->level[i].half_far, square = times * times, most = square > 1 ? square : 1;
    const float fourth = most * most;
    return i == 0 ? 0 : 1 - 1 / (fourth * fourth);
}

struct hf_gather_kernels {
    struct hf_passes passes;
};
HF_DECLARE_KERNELS(hf_gather_kernels);

hf_kernel hf_gather_coc, hf_down_c, hf_max_x_c, hf_max_y_c, hf_blur_x_c, hf_blur_y_c, hf_gather_c, hf_fill_c,
    hf_composite_c;

void hf_convolve_c(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, const struct hf_buf *in,
                   int c_in, const struct hf_buf *out, int c_out);

hf_kernel hf_area_down_c, hf_area_gather_c;

// How much of what is not near counts as what near pixels hide, within reach of their levels: what is more than so many
// times as bright as what is on both sides of it, sideways and up and down, counts as that. It is a light, of which near pixels
// that are farther away than its own disc see nothing; else each level draws a ring of its own size around it, over them.
#define HF_LIGHT 16.0f
void hf_area_lights_c(const struct hf_frame *f, struct hf_rect r);

// Do a level's taps at row y end within the frame, above and below? Then what lies in it is as in all such rows.
static inline int hf_area_is_whole(const struct hf_setup *s, const struct hf_taps *t, int y)
{
    return y >= t->ry && y + t->ry < s->half_height;
}

// Row y of the part of a level's taps that lies in the frame, n pixels from x on. Returns 0 if it is all of them.
int hf_area_inside(const struct hf_setup *s, const struct hf_taps *t, int x, int y, int n, float *inside);

// Sums that Computation by area uses up strip by strip (computation_simd.h): planes, and floats from row to row.
enum { HF_STRIP_PLANES = 5, HF_STRIP = 112 };

struct hf_reach hf_gather_halo(const struct hf_setup *s, int halo);

extern const struct hf_engine_def hf_gather_engine;

// A far pixel takes the colour of a neighbour that is less far than itself, but where it is more than so many times as far
// only so many times the neighbour's part: what begins to be far changes nothing at once, however far the pixels around are.
#define HF_FAR_WHOLE 16.0f
// Weights that sum to less have no inverse; pixels that are so little far stay what they are.
#define HF_FAR_LEAST 0x1p-120f

// Half-resolution colour stays below this, so that no sum of thousands passes the largest float; by area of millions.
#define HF_LARGEST 0x1p115f
// Full-resolution colour that is blended: less a field it is a float.
#define HF_BLENDED 0x1p127f
#define HF_AREA_LARGEST 0x1p104f

// So limited; NaN, as of a sum of two infinities, becomes the least.
static inline float hf_limited(float v, float largest)
{
    v = v > -largest ? v : -largest;
    return v < largest ? v : largest;
}

// Uniform cubic B-spline a quarter of a pixel off the centre: weights of the neighbour on that side, of the one on
// the other side, and of the one behind the neighbour. The rest, 235/384, is the pixel's own.
#define CUBIC_NEIGHBOUR (121 / 384.0f)
#define CUBIC_OTHER (27 / 384.0f)
#define CUBIC_BEHIND (1 / 384.0f)

#endif
