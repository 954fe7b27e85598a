// SPDX-License-Identifier: BSD-3-Clause
// Numerical stability of every engine: what was tried, the bound and where it comes from, the worst value seen. The
// cases are run by a test, which fails where a bound is exceeded, and by `hyperfocal-bench stability`, which prints the
// table.
//
//   subjects.c    what is tried: engines in their variants, and what each of them promises
//   table.c       rows: findings of many pictures and instruction sets become one line
//   samples.c     bad samples in colour, alpha and depth
//   sizes.c       every small size between guard pages, memory filled with junk, copies
//   invariance.c  constants, energy, centre, range, opacity, shifts, crops, flips, transposes, exposure, sums
//   continuity.c  pulls and ramps in tiny steps, flicker
//   rounding.c    against references in double precision; long rows and large radii
//   silhouettes.c anti-aliased outlines in focus
#ifndef HF_TESTS_STABILITY_H
#define HF_TESTS_STABILITY_H

#include <stdio.h>

#include "support/render.h"

// Focus, range and largest radius of all cases, as scene_params() has them.
#define STABILITY_FOCUS 20.0f
#define STABILITY_RANGE 10.0f
#define STABILITY_RADIUS 12.0f

// What a subject promises beyond what all do.
enum promise {
    KEEPS_ENERGY = 1 << 0,      // of a highlight where everything has one CoC
    ADDS = 1 << 1,              // the blur of a sum is the sum of the blurs
    EXPOSES = 1 << 2,           // a factor of 2^k passes through exactly
    FLIPS = 1 << 3,             // left to right, bit for bit
    FLIPS_EVEN = 1 << 4,        // FLIPS, but for near pixels at odd widths
    FLIPS_QUADS = 1 << 5,       // the same where depth is constant per quad and the size even
    TRANSPOSES = 1 << 6,        // within rounding
    PERMUTES = 1 << 7,          // channels, bit for bit
    EXACT = 1 << 8,             // float storage: bounds are those of rounding alone
    ADDS_ONE_SURFACE = 1 << 9,  // as ADDS, but for mixed pixels
    ADDS_ONE_RADIUS = 1 << 10,  // as ADDS_ONE_SURFACE, of what is far where that has one radius
    KEEPS_CENTRE = 1 << 11,     // a highlight's centre of gravity, far and near
    SMOOTH = 1 << 12,           // anti-aliased silhouettes before what is blurred stay nearer to smooth than to stairs
    UNMIXES = 1 << 13,          // and are as they were
};

struct subject {
    const char *name;
    struct hf_params params;
    unsigned promises;  // of enum promise
    int margin;         // pixels from which a pixel's result may come, for the largest radius above
    double constant;    // by how much a constant may move, half ulps: roundings that do not cancel
    double roundings;   // roundings on the way of a sample, half ulps of the largest
    double step;        // relative step of the storage
};

int subject_count(void);
struct subject subject_make(int index);

// One subject on one instruction set.
struct run {
    const struct subject *subject;
    enum hf_isa isa;
    const char *isa_name;
    struct hf_context *c;
    int full;    // the long run: more of everything
    int widest;  // of the instruction sets that are tried
    unsigned seed;
};

// One finding of a case: its value, its bound and where that comes from; the rest says where, as printf does. A NaN
// exceeds every bound. Findings with the same subject and case are one row: that nearest to its bound, or farthest
// beyond it, is kept.
__attribute__((format(printf, 6, 7))) void see(const struct run *r, const char *what, const char *why, double value,
                                               double bound, const char *where, ...);

// Before the first finding.
void stability_open_table(void);
// All rows so far as a table; returns how many exceed their bound.
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
    const char *engine;  // only subjects whose name begins so; NULL: all
    const char *only;    // only this file's cases, by its name without .c; NULL: all
    enum hf_isa isa;     // AUTO: all that there are
    int full;
    unsigned seed;
};
// Run the cases. Returns 0, or -1 when there is nothing to run.
int stability_run(const struct stability_options *o);

void samples_cases(const struct run *r);
void small_sizes_cases(const struct run *r);  // in a process of its own: r->c is not there
void sizes_cases(const struct run *r);
void invariance_cases(const struct run *r);
void continuity_cases(const struct run *r);
void rounding_cases(const struct run *r);
void silhouettes_cases(const struct run *r);

// A picture of blocks with a soft pattern in each, 0.05 .. 1, alpha as asked for, and depths on both sides of the focus.
struct scene calm_scene(unsigned seed, int width, int height, int channels);
// In codes of 8 bits after clamping and the sRGB curve: a value, and how far two pictures are apart at the worst sample. Of
// pictures of 3 channels a fourth plane may mark pixels: where the marks differ, they are not compared.
double display_code(double v);
double display_distance(const struct picture *a, const struct picture *b);

// What is left of the step of a parameter from *from to *to, as display_distance tells, when it has been halved towards the
// greater change until no float lies between its ends, or `halvings` times. at: the picture for a value of it.
double step_left(struct picture (*at)(void *cookie, double t), void *cookie, int halvings, double *from, double *to);

#endif
