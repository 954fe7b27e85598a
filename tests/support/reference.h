// SPDX-License-Identifier: BSD-3-Clause
// A second implementation of gather and chapter: literal, slow, in double precision, without code of the library, so
// that the two can be compared.
//
//   reference_coc.c    depth types, repair of depth and colour, models, CoC generation
//   reference_taps.c   sample positions: rings, polygons, the dense grid
//   reference.c        storage, and passes 2 to 9
//   reference_area.c   all after pass 1 of the default look
#ifndef HF_TESTS_REFERENCE_H
#define HF_TESTS_REFERENCE_H

#include "hyperfocal/hyperfocal.h"
#include "support/image.h"

enum { REF_MAX_TAPS = 2 * (8 * 256 * 257 / 2 + 1) };

// A buffer of the pipeline: planes of doubles, tightly packed.
struct ref_buffer {
    const char *name;
    int width, height, channels;
    double *data[4];
    double *raw[4];  // the same before rounding for storage
};

enum ref_id {
    REF_COLOUR,  // the input, repaired and stored
    REF_COC,
    REF_COC4,
    REF_COCMAXX,
    REF_COCMAX,
    REF_COCBLURX,
    REF_COCBLUR,
    REF_COLOR4,
    REF_COLORMULCOC4,
    REF_NEAR,
    REF_FAR,
    REF_NEARFILL,
    REF_FARFILL,
    REF_RESULT,
    REF_COUNT
};

struct reference {
    int width, height, half_width, half_height, channels;
    struct hf_params params;
    double rho;               // largest CoC radius, full-resolution pixels
    double reach_y, reach_x;  // rho / 2, and that in pixels of x
    double strength;          // of the range model; 1 with a lens or given radii
    double kernel_scale, blend;
    int taps;                      // without the centre
    double *tap_x, *tap_y;         // half-resolution pixels, kernel scale included
    double *tap_share;             // each tap's weight: 1, except where two numbers of rings are blended
    double centre, shares;         // the weight of the centre, and of all taps
    double *near_mean, *far_mean;  // mean weight of the taps of a half-resolution pixel; 0 if none was taken
    struct ref_buffer buffer[REF_COUNT];
};

// Called when a buffer is complete, before anything reads it; it may read and change the buffer.
typedef void reference_hook(void *cookie, struct reference *r, enum ref_id id);

// Run the engine with valid parameters. hook may be NULL. Free the result with reference_free. With a largest radius or
// a strength of 0 there is only the result, a copy of the input.
struct reference *reference_render(const struct picture *colour, const struct hf_depth *depth,
                                   const struct hf_params *params, reference_hook *hook, void *cookie);
void reference_free(struct reference *r);

// Find a buffer by its name in hf_inspect_buffer, or "result"; NULL if there is none.
const struct ref_buffer *reference_find(const struct reference *r, const char *name);
// The result rounded to float.
struct picture reference_picture(const struct reference *r);

// Internal; shared by the files named above.

// View depth of every pixel (for HF_DEPTH_COC: the radius), NaN repaired, "no surface" as INFINITY.
void ref_depths(double *z, const struct hf_depth *depth, double pixel_aspect, int width, int height);
// Copy colour, repairing samples that are not finite. Returns how many there were.
int ref_repair(double *out, const float *in, int width, int height);
// Normalised near and far CoC of one depth, before storage.
void ref_coc(const struct reference *r, const struct hf_depth *depth, double z, double *n, double *f);
// Fill taps, tap_x, tap_y, centre.
void ref_make_taps(struct reference *r);

// From CoC to the result, by area.
void ref_area(struct reference *r);

// The value after storing it. channel: 0..3 for colour, -1 for CoC.
double ref_store(enum hf_storage storage, int channel, double v);

#endif
