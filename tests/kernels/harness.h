// SPDX-License-Identifier: BSD-3-Clause
// What the files of the kernel tests share.
//
// A case is a "world": a frame's parameters, buffers and images, small and random. It exists three times in memory, at
// the same offsets: as it was made, as the C reference left it, and as the kernel under test left it. A test makes a
// case, calls the kernel on the latter two, and compares all of both.
#ifndef HF_TESTS_HARNESS_H
#define HF_TESTS_HARNESS_H

#include "engine/chapter/chapter.h"
#include "engine/gather/gather.h"
#include "engine/gaussian/kernels.h"
#include "engine/hexagon/kernels.h"
#include "engine/layers/kernels.h"
#include "engine/scatter/kernels.h"

// ---- random numbers: one seed gives one sequence, so no expression draws twice in an order that C leaves open ----

struct rng {
    uint64_t state;
};

struct rng rng_from(uint64_t seed, uint64_t stream);
uint32_t rng_next(struct rng *r);
int rng_int(struct rng *r, int low, int high);  // both included
int rng_one_in(struct rng *r, int n);
float rng_float(struct rng *r, float low, float high);

enum colours {
    COLOURS_PLAIN,     // 0..1
    COLOURS_POSITIVE,  // 1 in 8 near zero or denormal, 1 in 8 huge
    COLOURS_MIXED,     // also negative and -0
    COLOURS_COUNT
};
float random_colour(struct rng *r, enum colours kind);
// 0, 1, tiny, denormal or anything between, in a value that the storage holds.
float random_coc(struct rng *r, enum hf_storage storage);
// Values for encoders: ties, ends of ranges, negative, infinite, NaN.
float random_store_value(struct rng *r);

// ---- instruction sets ----

// All tables of kernels of an instruction set.
struct kernels {
    struct hf_pixel_kernels pixel;
    struct hf_gather_kernels gather;
    struct hf_chapter_kernels chapter;
    struct hf_hexagon_kernels hexagon;
    struct hf_scatter_kernels scatter;
    struct hf_gaussian_kernels gaussian;
    struct hf_layers_kernels layers;
};

struct level {
    char name[32];
    enum hf_isa isa;  // 0: emulated
    int exact;        // promises the bits of the C
    struct kernels k;
};

enum { MAX_LEVELS = 12 };
// Make every table that this CPU can run, the C first. filter: NULL, or part of a name. emulated: also the tables that
// need no CPU of their own. Returns how many.
int levels_make(struct level levels[MAX_LEVELS], const char *filter, int emulated);
// AVX-512 in plain C (emulated/). Returns 0 if this build has none.
int emulated_kernels(struct kernels *k, int fused);
// Check that the emulation does what the instructions do. Returns the number of operations that differ.
int emulated_check(void);

// ---- worlds ----

enum arena { ARENA_MADE, ARENA_REFERENCE, ARENA_TEST, ARENA_COUNT };

// Blocks of memory. Each ends at a forbidden page, so that reading past the last row crashes.
enum {
    SLOT_BUF = 0,  // + 4 * buffer + channel
    SLOT_SRC = 4 * HF_MAX_BUFS,
    SLOT_DST = SLOT_SRC + 4,
    SLOT_DEPTH = SLOT_DST + 4,
    SLOT_LINES,
    SLOT_DEPTH_LINES,
    SLOT_WORK,
    SLOT_COUNT
};

enum region_kind {
    REGION_FLOATS,   // compared, with tolerance where the kernel may fuse
    REGION_PIXELS,   // of dst, compared in the same way
    REGION_NARROW,   // CoC in the storage's format: compared without tolerance
    REGION_BYTES,    // compared bit by bit
    REGION_SCRATCH,  // may be written, is not compared
};

// Rows of a slot that a kernel may write. Nothing else may change.
struct region {
    enum region_kind kind;
    int slot;
    size_t offset, row_bytes;
    size_t spare;  // bytes after each row that may be written too
    int rows;
    ptrdiff_t stride;  // bytes
    int buf, channel, x0, y0;
};

enum { MAX_REGIONS = 80 };

struct result {
    int returned;
    uint64_t clamped;
    struct hf_counts counts, seen;
};

struct world {
    struct rng rng;
    int bench;  // typical input instead of random input
    struct hf_params params;
    struct hf_settings resolved;
    struct hf_setup setup;
    struct hf_gather gather;
    struct hf_chapter chapter;
    struct hf_gaussian gaussian;
    struct hf_hexagon hexagon;
    struct hf_scatter scatter;
    struct hf_layers layers;
    enum colours colours;
    struct hf_image src, dst;  // in ARENA_MADE
    struct hf_depth depth;
    const struct hf_engine_def *engine;  // whose buffers they are: of make_setup the gather or the chapter
    struct hf_buf buf[HF_MAX_BUFS];
    struct hf_rect r;
    int near, far;
    int is_pass;  // may use scratch, and may round differently with fused arithmetic
    size_t line_floats;
    size_t bytes[SLOT_COUNT];  // in use, at the end of the slot

    // Rows: n lanes from lane x of row y. For the finiteness checks: words, their kind, and where a copy goes.
    int x, y, n, with_counts, no_alpha;
    const uint8_t *words;
    uint8_t *copy;
    size_t word_count;
    int finite;

    struct region regions[MAX_REGIONS];
    int region_count;
    struct hf_frame reference;  // as the C reference saw it
    struct result result[ARENA_COUNT];
};

void arenas_open(void);
// The same byte in another arena.
void *in_arena(enum arena a, const void *made);
uint8_t *slot_start(const struct world *w, enum arena a, int slot);
// Fill the first `bytes` bytes of a slot with `fill`. A new case has no slots.
uint8_t *slot_use(struct world *w, int slot, size_t bytes, int fill);
void world_clear(struct world *w);
// Restore an arena to what was made.
void world_reset(const struct world *w, enum arena a);
struct region *world_region(struct world *w, enum region_kind kind, int slot, const void *first, size_t row_bytes,
                            size_t spare, int rows, ptrdiff_t stride);

// Compute w->setup from w->params.
void world_setup(struct world *w, void *own);
// Random parameters of a picture of some size, formats and depth type; repeated until the setup has something to blur.
void make_setup(struct world *w, int half_width, int half_height);
void make_image(struct world *w, struct hf_image *m, int slot, int bad);
void make_depth(struct world *w, int bad);
// Scratch rows, filled with NaN.
void make_lines(struct world *w, int lines, size_t floats);
// Make buffer b readable in r, with random contents.
void make_buf(struct world *w, int b, struct hf_rect r);
float *world_at(const struct world *w, enum arena a, int b, int c, int x, int y);
// Bytes of a sample of a buffer; and the value nearest to v that the buffer can hold.
int buf_bytes(const struct world *w, int b);
void world_put(struct world *w, int b, int c, int x, int y, float v);
struct hf_frame world_frame(struct world *w, const struct kernels *k, enum arena a);
int buf_channels(const struct world *w, int b);

// ---- tests ----

struct test {
    const char *name;
    int index;  // pass or format
    int cases;
    void (*make)(struct world *w, int index);
    // Calls the kernel and does nothing else: the benchmark times this too.
    void (*call)(struct world *w, const struct kernels *k, enum arena a, int index);
    // Checks what the call returned. Returns 0 with a message if it is wrong.
    int (*check)(const struct world *w, const struct level *l, char message[256]);
    // Half-resolution pixels of the typical case, for the benchmark.
    int (*pixels)(const struct world *w);
};

extern const struct test tests[];
extern const int test_count;

// passes.c
// A pass of the gather, or of the chapter.
enum { CHAPTER_PASS = HF_MAX_PASSES };
static inline int is_chapter(const struct world *w)
{
    return w->engine == &hf_chapter_engine;
}
static inline struct hf_fields *world_fields(struct world *w)
{
    return is_chapter(w) ? &w->chapter.fields : &w->gather.fields;
}
// The largest kernel, of both fields.
const struct hf_taps *world_taps(const struct world *w);
void pass_make(struct world *w, int index);
void pass_call(struct world *w, const struct kernels *k, enum arena a, int index);
int pass_check(const struct world *w, const struct level *l, char message[256]);
int pass_pixels(const struct world *w);
// Choose a random part of the frame to compute, half-resolution pixels.
void random_area(struct world *w);
struct hf_rect rect_grown(struct hf_rect r, struct hf_reach by);
// Allow the pass to write a buffer in r, or the target's pixels of w->r.
void make_output(struct world *w, enum region_kind kind, int b, struct hf_rect r);
void make_dst(struct world *w);

// hexagon.c
enum { HEXAGON_LOAD, HEXAGON_FIRST, HEXAGON_SECOND, HEXAGON_COMPOSITE };
void hexagon_make(struct world *w, int which);
void hexagon_call(struct world *w, const struct kernels *k, enum arena a, int which);
double hexagon_bound_buffer(const struct world *w, int b, int c, int x, int y, float want);
double hexagon_bound_pixel(const struct world *w, int c, int x, int y);

// rows.c
void widen_make(struct world *w, int format);
void widen_call(struct world *w, const struct kernels *k, enum arena a, int format);
void sharp_row_make(struct world *w, int index);
void sharp_row_call(struct world *w, const struct kernels *k, enum arena a, int index);
void coc_row_make(struct world *w, int index);
void coc_row_call(struct world *w, const struct kernels *k, enum arena a, int index);
void load_make(struct world *w, int format);
void load_call(struct world *w, const struct kernels *k, enum arena a, int format);
int load_check(const struct world *w, const struct level *l, char message[256]);
void store_make(struct world *w, int format);
void store_call(struct world *w, const struct kernels *k, enum arena a, int format);
void finite_make(struct world *w, int which);
void finite_call(struct world *w, const struct kernels *k, enum arena a, int which);
int finite_check(const struct world *w, const struct level *l, char message[256]);
void round_make(struct world *w, int channels);
void round_call(struct world *w, const struct kernels *k, enum arena a, int channels);
void highlight_make(struct world *w, int which);
void highlight_call(struct world *w, const struct kernels *k, enum arena a, int which);
int row_check(const struct world *w, const struct level *l, char message[256]);
int row_pixels(const struct world *w);

// gaussian.c
void radius_make(struct world *w, int index);
void radius_call(struct world *w, const struct kernels *k, enum arena a, int index);
void blend_row_make(struct world *w, int count);
void blend_row_call(struct world *w, const struct kernels *k, enum arena a, int index);
void count_row_call(struct world *w, const struct kernels *k, enum arena a, int index);
void lerp_row_make(struct world *w, int index);
void lerp_row_call(struct world *w, const struct kernels *k, enum arena a, int index);
void gaussian_make(struct world *w, int which);
void gaussian_call(struct world *w, const struct kernels *k, enum arena a, int which);
void wide_make(struct world *w, int index);
void wide_call(struct world *w, const struct kernels *k, enum arena a, int index);

// scatter.c
enum {
    SCATTER_WEIGHTS,
    SCATTER_PICTURES,
    SCATTER_LIST,
    SCATTER_QUAD,
    SCATTER_SITE,
    SCATTER_TENT_WEIGHTS,
    SCATTER_TENT,
    SCATTER_MEAN,
    SCATTER_NOTE,
    SCATTER_SLICE_ROW,
    SCATTER_SLICE_BEHIND,
    SCATTER_RUNS,
    SCATTER_TAPS,
    SCATTER_SPLAT,
    SCATTER_SETTLE,
    SCATTER_BLEND,
    SCATTER_NEAR,
    SCATTER_MOST,
    SCATTER_SEEN_WEIGHTS,
    SCATTER_SEEN,
    SCATTER_THIRD,
    SCATTER_PART,
    SCATTER_ADD_PART,
    SCATTER_UP,
    SCATTER_BEHIND
};
void scatter_make(struct world *w, int which);
void scatter_call(struct world *w, const struct kernels *k, enum arena a, int which);
int scatter_check(const struct world *w, const struct level *l, char message[256]);

// edges.c
enum { EDGES_SURE, EDGES_TAKE };
void edges_make(struct world *w, int which);
void edges_call(struct world *w, const struct kernels *k, enum arena a, int which);
int edges_check(const struct world *w, const struct level *l, char message[256]);

// layers.c
enum {
    LAYERS_UNMIX,
    LAYERS_ROOTS,
    LAYERS_NINE,
    LAYERS_SHARES,
    LAYERS_SHARES_ALPHA,
    LAYERS_LAMPS,
    LAYERS_LAMPS_ALPHA,
    LAYERS_QUADS,
    LAYERS_MERGE,
    LAYERS_TAPS,
    LAYERS_BETWEEN,
    LAYERS_NEAREST,
    LAYERS_FOUND,
    LAYERS_SPREAD,
    LAYERS_SMOOTH,
    LAYERS_ALIKE,
    LAYERS_EXTREMES,
    LAYERS_INSIDE,
    LAYERS_WEIGH,
    LAYERS_FOLD,
    LAYERS_DISC,
    LAYERS_PAIRS,
    LAYERS_RUNS,
    LAYERS_WEIGHTS,
    LAYERS_STAMP,
    LAYERS_LIGHT,
    LAYERS_DIM,
    LAYERS_PASSED,
    LAYERS_UP,
    LAYERS_BLEND,
    LAYERS_FINISH,
    LAYERS_VIEWS
};
void layers_make(struct world *w, int which);
void layers_call(struct world *w, const struct kernels *k, enum arena a, int which);
int layers_check(const struct world *w, const struct level *l, char message[256]);

// compare.c: compares all regions, and everything outside them.
int world_compare(const struct world *w, const struct level *l, char message[256]);
// Check that the reference itself stayed in its area and made only finite numbers.
int reference_check(const struct world *w, char message[256]);

// bound.c: by how much a fused kernel may differ at a pixel where the C gives `want` and the kernel `got`; 0 where
// nothing may be fused.
double bound_buffer(const struct world *w, int b, int c, int x, int y, float want, float got);
// The largest sample of the picture in pixels x0..x1, y0..y1, all included.
double bound_largest_sample(const struct world *w, int c, int x0, int y0, int x1, int y1);
// Bound of the error of a quotient; value: its magnitude.
double bound_quotient(double error, double divisor_error, double divisor, double value);
double bound_pixel(const struct world *w, int c, int x, int y, float want, float got);

// host_posix.c, host_windows.c. A crash ends the program, as a failed test that names its step. On POSIX one in guarded does
// not: guarded returns the number of the signal, else 0, and crash_name gives its words.
void crash_handlers(void);
extern const char *volatile crash_step;
int guarded(void (*call)(struct world *, const struct kernels *, enum arena, int), struct world *w,
            const struct kernels *k, enum arena a, int index);
const char *crash_name(int number);
// Addresses whose use is a crash, and leave to use some of them, whole pages. Ends the program if the system refuses.
void *memory_reserve(size_t bytes);
void memory_allow(void *p, size_t bytes);

// bench.c
void bench_run(struct world *w, const struct level *levels, int level_count, const char *name);

#endif
