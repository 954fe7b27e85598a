// SPDX-License-Identifier: BSD-3-Clause
// Numerical stability of every engine: each case has a bound with its reason, and the worst value found. A test runs
// the cases and fails where a bound is exceeded; `hyperfocal-bench stability` prints them as a table.
//
//   subjects.c    the engines in their variants, and what each of them promises
//   table.c       rows: findings of many pictures and instruction sets become one line
//   samples.c     bad samples in colour, alpha and depth
//   sizes.c       every small size between guard pages, memory filled with junk, copies
//   invariance.c  constants, energy, centre, range, opacity, shifts, crops, flips, transposes, exposure, sums
//   continuity.c  pulls and ramps in tiny steps, flicker
//   rounding.c    against references in double precision; long rows and large radii
//   silhouettes.c anti-aliased outlines in focus
// and over looks.c, each engine's qualities and apertures:
//   stages.c      their scenes, and parts of real pictures
//   pulls.c       lens and range in tiny steps
//   local.c       one sample changed, and regions with the reads that the library names
//   pairs.c       exposure, mirrored, transposed
//   known.c       what goes beyond the bounds there, how far and why
//   lamps.c       lamps that move behind sharp edges, and noise of other seeds
// search.c is a program of its own, which draws scenes, looks and steps at random.
#ifndef HF_TESTS_STABILITY_H
#define HF_TESTS_STABILITY_H

#include <stdio.h>

#include "support/render.h"

// Focus, range and largest radius of all cases, as in scene_params().
#define STABILITY_FOCUS 20.0f
#define STABILITY_RANGE 10.0f
#define STABILITY_RADIUS 12.0f

// Properties that only some subjects promise.
enum promise {
    KEEPS_ENERGY = 1 << 0,      // of a highlight, with one CoC everywhere
    ADDS = 1 << 1,              // the blur of a sum is the sum of the blurs
    EXPOSES = 1 << 2,           // a factor of 2^k passes through exactly
    FLIPS = 1 << 3,             // left to right, bit for bit
    FLIPS_EVEN = 1 << 4,        // FLIPS, except near pixels at odd widths
    FLIPS_QUADS = 1 << 5,       // FLIPS, where depth is constant per quad and the size is even
    TRANSPOSES = 1 << 6,        // within rounding
    PERMUTES = 1 << 7,          // channels, bit for bit
    EXACT = 1 << 8,             // float storage: bounds are those of rounding only
    ADDS_ONE_SURFACE = 1 << 9,  // as ADDS, except mixed pixels
    ADDS_ONE_RADIUS = 1 << 10,  // as ADDS_ONE_SURFACE, for far pixels that have one radius
    KEEPS_CENTRE = 1 << 11,     // a highlight's centre of gravity stays, far and near
    SMOOTH = 1 << 12,           // anti-aliased silhouettes before blur are closer to smooth than to stairs
    UNMIXES = 1 << 13,          // such silhouettes stay as they were
    MIRRORS = 1 << 14,          // looks: left to right, within codes
    TURNS = 1 << 15,            // looks: transposed, within codes
};

struct subject {
    const char *name;
    struct hf_params params;
    unsigned promises;  // of enum promise
    int margin;         // how far a pixel's result may come from, at the largest radius above
    double constant;    // how much a constant may move, in half ulps: roundings that do not cancel
    double roundings;   // roundings of a sample, in half ulps of the largest one
    double step;        // relative step of the storage
};

int subject_count(void);
struct subject subject_make(int index);
// The same for looks.c: each engine's qualities and apertures, for the cases that run over all of them.
int look_count(void);
struct subject look_make(int index);

// One subject on one instruction set.
struct run {
    const struct subject *subject;
    enum hf_isa isa;
    const char *isa_name;
    struct hf_context *c;
    int full;    // the long run: more of everything
    int widest;  // of the instruction sets under test
    unsigned seed;
};

// Record a finding of a case: its value, its bound and the bound's reason; the other arguments say where it occurred,
// as for printf. A NaN exceeds every bound. Findings with the same subject and case share a row, which keeps the one
// nearest to its bound, or farthest beyond it.
__attribute__((format(printf, 6, 7))) void see(const struct run *r, const char *what, const char *why, double value,
                                               double bound, const char *where, ...);

// The same for looks: rows of known.c have the bound that stands there, with its reason.
__attribute__((format(printf, 6, 7))) void see_look(const struct run *r, const char *what, const char *why,
                                                    double value, double bound, const char *where, ...);
// The bound of a row, and its reason, if it stands in known.c; else `bound`.
double known_bound(const struct run *r, const char *what, double bound, const char **why);

// Call before the first finding.
void stability_open_table(void);
// Print all rows so far as a table; returns how many exceed their bound.
int stability_print(FILE *to);
int stability_passed(void);
// Each row.
struct stability_row {
    const char *subject, *what, *why, *where;
    double value, bound;
    int within;
};
void stability_each(void (*fn)(void *cookie, const struct stability_row *row), void *cookie);

struct stability_options {
    const char *engine;  // only subjects whose name begins with this; NULL: all
    const char *only;    // only the cases of this file, named without .c; NULL: all
    enum hf_isa isa;     // AUTO: all of this machine's
    int full;
    unsigned seed;
};
// Run the cases. Returns 0, or -1 if no case was selected.
int stability_run(const struct stability_options *o);

void samples_cases(const struct run *r);
void small_sizes_cases(const struct run *r);  // run in a process of its own, without r->c
void sizes_cases(const struct run *r);
void invariance_cases(const struct run *r);
void continuity_cases(const struct run *r);
void rounding_cases(const struct run *r);
void silhouettes_cases(const struct run *r);
// Over looks.
void pulls_cases(const struct run *r);
void local_cases(const struct run *r);
void pairs_cases(const struct run *r);
void lamps_cases(const struct run *r);

// A picture of blocks with a soft pattern in each, 0.05 .. 1, with or without alpha, and depths on both sides of the
// focus.
struct scene calm_scene(unsigned seed, int width, int height, int channels);
// In 8-bit codes after clamping and the sRGB curve: a value; and the distance of two pictures at the worst sample. In
// pictures of 3 channels a fourth plane may hold marks: pixels whose marks differ are not compared.
double display_code(double v);
double display_distance(const struct picture *a, const struct picture *b);

// The same, where each pixel is exposed so that the brightest sample within 7 pixels of it in either picture, if that is over
// 1, is white.
double exposed_distance(const struct picture *a, const struct picture *b);

// A pull from `from` to `to` in equal steps: those with the greatest changes by `distance`, the greatest first, and where each
// begins. at: makes the picture for a value of the parameter.
enum { LARGE_STEPS = 3 };
struct large_steps {
    double change[LARGE_STEPS], place[LARGE_STEPS], width;
};
struct large_steps large_steps(struct picture (*at)(void *cookie, double t),
                               double (*distance)(const struct picture *a, const struct picture *b), void *cookie,
                               double from, double to, int steps);

// The change that remains when the step of a parameter from *from to *to has been halved, each time towards the greater
// change by `distance`, until no float lies between its ends, or `halvings` times. at: makes the picture for a
// value of the parameter.
double step_left(struct picture (*at)(void *cookie, double t),
                 double (*distance)(const struct picture *a, const struct picture *b), void *cookie, int halvings,
                 double *from, double *to);

// The bound of such a change, and its reason; lamps: seen with the exposure of exposed_distance().
double step_bound(const struct hf_params *p, int lamps, const char **why);

// A copy of a row's name that lives as long as the program.
const char *row_name(const char *name);

// Scenes for looks: depths are for a focus of STABILITY_FOCUS.
enum stage { STAGE_FLOOR, STAGE_CARDS, STAGE_BLOCKS, STAGE_NOISE, STAGE_LAMPS, STAGES };
struct scene stage_make(enum stage stage, unsigned seed, int width, int height);
const char *stage_name(enum stage stage);
// A part of that size of a picture of the folder images. Returns 0 if there are no more, or none can be read.
int stage_picture(int index, int width, int height, struct scene *s, const char **name);
// A lens that makes radii of up to about `reach` pixels in a stage of that width.
void set_lens(struct hf_params *p, int width, float reach);

#endif
