// SPDX-License-Identifier: BSD-3-Clause
// What the gather's files share: its passes and buffers, what it makes of its parameters, its kernels.
//
// Apertures are areas, so that highlights are round and keep their light; every sample of a quad counts by its own CoC; the
// near field is what is near, by how much of a pixel it covers; and what lies beyond the frame counts for nothing.
#ifndef HF_GATHER_H
#define HF_GATHER_H

#include "engine/gather/kernel.h"
#include "pixel/fields.h"

enum { HF_GATHER_COMPOSITE = HF_PASS_OWN, HF_GATHER_PASSES };

enum hf_gather_buf {
    HF_BUF_COLORNEAR4 = HF_BUF_OWN,  // colour x near CoC
    HF_BUF_COVER,                    // how much of a pixel the near field covers
    HF_BUF_LEVEL,                    // one level's part of a field: colour ...
    HF_BUF_LEVEL_WEIGHT,             // ... and its weights
    HF_BUF_LEVEL_SUM,                // and their means
    HF_BUF_LEVEL_WEIGHT_SUM,
    HF_BUF_BEHIND,  // what near pixels hide, and far levels so far: colour, and its weights
    HF_BUF_BEHIND_WEIGHT,
    HF_BUF_SPREAD,  // what all far levels spread
    HF_BUF_SPREAD_WEIGHT,
    HF_BUF_FAR_PART,  // how much of a pixel is out of focus, far or near
    HF_GATHER_BUFS
};

// The channels of half-resolution CoC: the mean near and far CoC of a quad, as weights of its colour; the largest near CoC
// of it; and for levels a mean far CoC, in which a pixel counts by its part and its largest channel. So a lamp before a wall
// that is farther away has a disc of its own radius: with the quad's largest CoC its rim had the wall's (`lights` had 23.2 dB
// instead of 26.0).
enum { HF_AREA_NEAR, HF_AREA_FAR, HF_AREA_NEAR_MOST, HF_AREA_FAR_OF_LIGHT };

// The largest channel counts as this at least, so that black quads have a CoC too; and as HF_AREA_LARGEST at most, so that
// sums are finite.
#define HF_OF_LIGHT_LEAST 0x1p-40f

// A kernel as large as some pixels' blur. CoC is relative to a radius no smaller than the frame's largest (engine.c).
struct hf_level {
    float coc;      // the CoC of pixels as blurred as this
    float counts;   // of what near pixels hide: hf_gather.once times what its sample counts, for pixels whose CoC is 1
    float to_next;  // 1 / (coc - that of the next one)
    float area;     // coc^2, and as for coc:
    float area_to_next;
    float half_far;  // of that: times a far CoC, its radius in diameters of this
    struct hf_area_kernel kernel;
};

enum { HF_MAX_LEVELS = 64 };

// A pixel's part in a field, from how much it is blurred, 0 to 1, against the field's smallest kernel: a polynomial, 1 at 1.
struct hf_part_curve {
    float linear, square, sixth;
};

// A far pixel sees what is blurred up to so much more than itself.
#define HF_FAR_WIDER (16 / 9.0f)

// One field's kernels, the largest first. A pixel between two of them is a blend of both; one that is blurred less than the
// smallest is a blend of that and the picture.
struct hf_levels {
    int count;
    int filled;  // the first that any sample is in: those before it are only seen, and have no kernel
    float gain;  // 1 / coc of the smallest: hf_level_part of min(1, gain x CoC) is a pixel's part in the field
    // Of near pixels: the same of min(1, hides x CoC) is how far the field hides the picture where they are: as gain, but where
    // there is one kernel alone, wholly from seven eighths of its radius on. A light in a mixed pixel would shine through as a
    // speck.
    float hides;
    struct hf_part_curve curve;
    struct hf_level level[HF_MAX_LEVELS];
};

struct hf_gather {
    struct hf_fields fields;
    struct hf_levels levels[3];  // near, far, and of what near pixels hide; CoC there is near CoC
    float once;  // what a sample that counts once adds to what near pixels hide: 1, or a smaller power of two
    int many;    // fields have levels, be it one, else a kernel
    int leaves;  // there are near and far levels: the disocclusion fill leaves far samples to the far ones
    int lights;  // measured: how far apart what is beside a light is looked at; else 0
};

static inline const struct hf_gather *hf_gather(const struct hf_setup *s)
{
    return s->own;
}

static inline const struct hf_levels *hf_gather_behind(const struct hf_setup *s)
{
    return &hf_gather(s)->levels[2];
}

static inline float hf_level_part(const struct hf_levels *l, float gain, float coc)
{
    const float own = gain * coc, q = own < 1 ? own : 1, square = q * q;
    return q * l->curve.linear + square * (l->curve.sixth * (square * square) + l->curve.square);
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

// How much a near pixel of this CoC takes from a level of what it hides: of each up to its own, by the sixth power of its
// radius over the level's. A level is a mean over its area, so a sample counts by the inverse of its distance to the eighth:
// what is hidden is most often what is seen nearest to it. (To the fourth, `fence` had 31.9 dB instead of 32.7.) In its own
// level a sample counts once. Where all count less, farther away than the blur is wide, they fade out.
// With one kernel all count alike. All of it is times hf_gather.once.
static inline float hf_level_near(const struct hf_setup *s, int i, float coc)
{
    const struct hf_levels *l = hf_gather_behind(s);
    const float square = coc * coc, times = hf_gather(s)->many ? (square * square) * square : 1;
    return (hf_level_reached(l, i, coc) * times) * l->level[i].counts;
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

// Among what near pixels hide a sample counts by how much of it is not near (`open`), times this: 1, but less where it is hardly
// open. Without it a sample a millionth less blurred than a wholly near one would fill all that is around it, because its share
// in hf_level_near is 8e4 for a pixel whose blur is 13 pixels.
#define HF_OPEN_WHOLE 0.125f
static inline float hf_open_part(float open)
{
    const float part = hf_saturate(open * (1 / HF_OPEN_WHOLE));
    return part * part * part;
}

// How much a far pixel takes of what a level and the smaller ones spread. Shares sum to 1 exactly.
static inline float hf_level_seen(const struct hf_levels *l, int i, float coc)
{
    const float least = l->level[l->count - 1].coc;
    return hf_level_share(l, i, (coc > least ? coc : least) * HF_FAR_WIDER);
}

static inline const struct hf_levels *hf_gather_levels(const struct hf_setup *s, unsigned field)
{
    return &hf_gather(s)->levels[field == HF_FAR];
}

// Is a field one convolution of what there is?
static inline int hf_gather_is_simple(const struct hf_setup *s)
{
    return !hf_gather(s)->many && !hf_fields(s)->karis;
}

// How much of a sample with this far CoC level i of the disocclusion fill leaves to the far levels, 0 to 1. A sample
// that is blurred more than twice as much as the level would look too sharp in it: a light would show a small bright
// disc in front of its large one.
static inline float hf_level_left(const struct hf_levels *l, int i, float far)
{
    const float times = far * l->level[i].half_far, square = times * times, most = square > 1 ? square : 1;
    const float fourth = most * most;
    return 1 - 1 / (fourth * fourth);
}

struct hf_gather_kernels {
    struct hf_passes passes;
};
HF_DECLARE_KERNELS(hf_gather_kernels);

hf_kernel hf_gather_down_c, hf_gather_computation_c, hf_gather_composite_c;

// How much of what is not near counts as what near pixels hide, within reach of their levels: what is more than so many
// times as bright as what is on both sides of it, sideways and up and down, counts as that. It is a light, of which near pixels
// that are farther away than its own disc see nothing; else each level draws a ring of its own size around it, over them.
#define HF_LIGHT 4.0f
// The smallest level, whose ring is no wider than a pixel, sees them whole.
static inline int hf_level_limits(const struct hf_setup *s, int i)
{
    return hf_gather(s)->lights && i < hf_gather_behind(s)->count - 1;
}
void hf_gather_lights_c(const struct hf_frame *f, struct hf_rect r);

// Do a level's taps at row y end within the frame, above and below? Then what lies in it is as in all such rows.
static inline int hf_area_is_whole(const struct hf_setup *s, const struct hf_taps *t, int y)
{
    return y >= t->ry && y + t->ry < s->half_height;
}

// Row y of the part of a level's taps that lies in the frame, n pixels from x on. Returns 0 if it is all of them.
int hf_area_inside(const struct hf_setup *s, const struct hf_area_kernel *k, int x, int y, int n, float *inside);

// Sums that Computation uses up strip by strip (computation_simd.h): planes, and floats from row to row.
enum { HF_STRIP_PLANES = 5, HF_STRIP = 112 };
// What is known of a row of levels (levels_planes_simd.h), in floats.
enum { HF_ROW_FLOATS = HF_MAX_LEVELS + 8 };

struct hf_reach hf_gather_halo(const struct hf_setup *s, int halo);

extern const struct hf_engine_def hf_gather_engine;

// Half-resolution colour stays below this, so that no sum of millions passes the largest float.
#define HF_AREA_LARGEST 0x1p104f
// Sums of what near pixels hide stay finite because no sample counts more than this there. By itself one of the smallest level,
// which counts most, would count by the sixth power of the largest radius: 2^60 for one of 1024. A sample is the difference of
// three colours, at most 3 x 2^104; all levels together count at most 64 / 63 of the smallest; and in a frame's corner a quarter of
// a kernel stands for all of it. So sums are at most 2^124.
#define HF_COUNTS_MOST 0x1p16f

#endif
