// SPDX-License-Identifier: BSD-3-Clause
// Kernels that work on rows: CoC of depth, images in and out, checks and roundings.
#include <stdio.h>
#include <string.h>

#include "harness.h"
#include "pixel/depth_rows.h"
#include "pixel/highlight.h"
#include "pixel/unorm.h"

enum { LANES = 8 };  // scratch rows: even 0..3, odd 4..7

static float *lane(const struct world *w, enum arena a, int i)
{
    return (float *)(void *)slot_start(w, a, SLOT_LINES) + (size_t)i * w->line_floats;
}

// Choose a row: n lanes from lane x of row y.
static void random_row(struct world *w)
{
    struct rng *r = &w->rng;
    const int half = w->setup.half_width;
    w->x = rng_one_in(r, 2) || w->bench ? 0 : rng_int(r, 0, half - 1);
    w->n = rng_one_in(r, 2) || w->bench ? half - w->x : rng_int(r, 1, half - w->x);
    w->y = w->bench ? 0 : rng_int(r, 0, w->setup.height - 1);
    make_lines(w, LANES, (size_t)(w->n + HF_PAD + (w->bench ? 0 : rng_int(r, 0, 40))));
}

static void lane_region(struct world *w, enum region_kind kind, int i)
{
    world_region(w, kind, SLOT_LINES, lane(w, ARENA_MADE, i), (size_t)w->n * 4, HF_PAD * 4, 1, 0);
}

static void make_size(struct world *w)
{
    world_clear(w);
    const int half_width = rng_int(&w->rng, 1, 70), half_height = rng_int(&w->rng, 1, 3);
    make_setup(w, w->bench ? 128 : half_width, w->bench ? 1 : half_height);
}

// ---- CoC of a row ----

void coc_row_make(struct world *w, int index)
{
    (void)index;
    make_size(w);
    random_row(w);
    make_depth(w, rng_one_in(&w->rng, 2));
    w->with_counts = !rng_one_in(&w->rng, 3);
    w->x &= w->with_counts ? ~15 : ~0;
    // The near rows are compared only if counts are wanted.
    for (int i = 0; i < 4; i++)
        lane_region(w, i < 2 && !w->with_counts ? REGION_SCRATCH : REGION_FLOATS, i);
}

void coc_row_call(struct world *w, const struct kernels *k, enum arena a, int index)
{
    (void)index;
    const struct hf_frame f = world_frame(w, k, a);
    float *const out[4] = {lane(w, a, 0), lane(w, a, 1), lane(w, a, 2), lane(w, a, 3)};
    k->pixel.coc_row(&f, w->x, w->y, w->n, out, w->with_counts ? &w->result[a].counts : NULL);
}

// Half of the cases are sharp pictures; half of these have one blurred pixel.
void sharp_row_make(struct world *w, int index)
{
    (void)index;
    make_size(w);
    random_row(w);
    w->depth.format = HF_DEPTH_FORMAT_FLOAT32;
    make_depth(w, rng_one_in(&w->rng, 2));
    const float middle = 0.5f * (w->setup.near_0 + w->setup.far_0), z = w->setup.lens ? -1 / middle : middle;
    const int odd_one = rng_one_in(&w->rng, 2) ? rng_int(&w->rng, 0, w->setup.width - 1) : -1;
    if (rng_one_in(&w->rng, 2) && !w->bench)
        return;
    for (int y = 0; y < w->setup.height; y++)
        for (int x = 0; x < w->setup.width; x++)
            if (x != odd_one || w->bench)
                memcpy((uint8_t *)(uintptr_t)w->depth.data + (ptrdiff_t)y * w->depth.stride + (size_t)x * 4, &z, 4);
}

void sharp_row_call(struct world *w, const struct kernels *k, enum arena a, int index)
{
    (void)index;
    const struct hf_frame f = world_frame(w, k, a);
    w->result[a].returned = k->pixel.sharp_row(&f, w->x, w->y, w->n) != 0;
}

// ---- depth of other formats ----

// Random bits.
void widen_make(struct world *w, int format)
{
    make_size(w);
    random_row(w);
    w->depth.format = (enum hf_depth_format)format;
    make_depth(w, 0);
    for (int y = 0; y < w->setup.height; y++)
        for (size_t i = 0; i < (size_t)w->setup.width * hf_depth_bytes(w->depth.format); i++)
            ((uint8_t *)(uintptr_t)w->depth.data)[y * w->depth.stride + (ptrdiff_t)i] = (uint8_t)rng_next(&w->rng);
    w->n = hf_min(w->n, w->setup.width - w->x);
    lane_region(w, REGION_FLOATS, 0);
}

void widen_call(struct world *w, const struct kernels *k, enum arena a, int format)
{
    const uint8_t *row = (const uint8_t *)w->depth.data + w->y * w->depth.stride;
    k->pixel.depth[format](in_arena(a, (uint8_t *)(uintptr_t)row) + (size_t)w->x * hf_depth_bytes(w->depth.format),
                           w->n, lane(w, a, 0));
}

// ---- images ----

static void make_row_format(struct world *w, struct hf_image *m, int format)
{
    make_size(w);
    const int alpha = rng_one_in(&w->rng, 2);
    m->format = (enum hf_format)format;
    m->transfer = hf_unorm(m->format) && rng_one_in(&w->rng, 2) ? HF_TRANSFER_SRGB : HF_TRANSFER_LINEAR;
    for (int i = 0; i < 4; i++)
        m->data[i] = i < 3 || alpha ? w : NULL;  // for now
    random_row(w);
}

void load_make(struct world *w, int format)
{
    make_row_format(w, &w->src, format);
    w->colours = rng_one_in(&w->rng, 2) ? COLOURS_MIXED : COLOURS_POSITIVE;
    make_image(w, &w->src, SLOT_SRC, rng_one_in(&w->rng, 3));
    // Sometimes random bits.
    if (!w->bench && rng_one_in(&w->rng, 3))
        for (int i = 0; i < hf_plane_count(&w->src); i++) {
            uint8_t *p = (uint8_t *)w->src.data[i] + w->y * w->src.stride[i];
            for (size_t k = 0; k < hf_row_bytes(w->src.format, w->src.width); k++)
                p[k] = (uint8_t)rng_next(&w->rng);
        }
    for (int c = 0; c < hf_image_channels(&w->src); c++) {
        lane_region(w, REGION_FLOATS, c);
        lane_region(w, REGION_FLOATS, 4 + c);
    }
}

void load_call(struct world *w, const struct kernels *k, enum arena a, int format)
{
    const struct hf_frame f = world_frame(w, k, a);
    float *const even[4] = {lane(w, a, 0), lane(w, a, 1), lane(w, a, 2), lane(w, a, 3)};
    float *const odd[4] = {lane(w, a, 4), lane(w, a, 5), lane(w, a, 6), lane(w, a, 7)};
    w->result[a].returned = k->pixel.load[format](f.src, w->x, w->y, w->n, even, odd) != 0;
}

// A false alarm is allowed if the row has something to repair: it only costs time.
static int alarm_is_right(const struct world *w)
{
    if (w->result[ARENA_REFERENCE].returned)
        return w->result[ARENA_TEST].returned;
    if (!w->result[ARENA_TEST].returned)
        return 1;
    for (int c = 0; c < hf_image_channels(&w->src); c++)
        for (int x = 0; x < w->src.width; x++)
            if (!hf_is_finite(hf_sample(&w->src, c, x, w->y)))
                return 1;
    return 0;
}

// A sample that is not finite may come out as anything that is recognised as such, because repair.c overwrites it. For
// the comparison the reference's bits are put there.
int load_check(const struct world *w, const struct level *l, char message[256])
{
    if (!alarm_is_right(w)) {
        snprintf(message, 256, "returned %d, the C %d", w->result[ARENA_TEST].returned,
                 w->result[ARENA_REFERENCE].returned);
        return 0;
    }
    for (int c = 0; c < hf_image_channels(&w->src); c++)
        for (int i = 0; i < 2 * w->n; i++) {
            const int px = hf_min(2 * w->x + i, w->src.width - 1);
            float *got = lane(w, ARENA_TEST, c + (i & 1 ? 4 : 0)) + i / 2;
            const float *want = lane(w, ARENA_REFERENCE, c + (i & 1 ? 4 : 0)) + i / 2;
            if (!hf_is_finite(hf_sample(&w->src, c, px, w->y)) && !(*got > -65536.0f && *got < 65536.0f))
                *got = *want;
        }
    return world_compare(w, l, message);
}

// Rows of hard values; of ordinary ones, for which a kernel may take a shorter path; and of ordinary ones with a single
// hard value, which must not take that path.
static void fill_lanes(struct world *w, const int *lanes, int count)
{
    struct rng *r = &w->rng;
    const int mode = w->bench ? 1 : rng_int(r, 0, 3);
    for (int k = 0; k < count; k++)
        for (int i = 0; i < w->n; i++)
            lane(w, ARENA_MADE, lanes[k])[i] = mode ? rng_float(r, 0.001f, 4) : random_store_value(r);
    const int k = rng_int(r, 0, count - 1), i = rng_int(r, 0, w->n - 1);
    if (mode > 1)
        lane(w, ARENA_MADE, lanes[k])[i] = random_store_value(r);
}

void store_make(struct world *w, int format)
{
    static const int lanes[LANES] = {0, 4, 1, 5, 2, 6, 3, 7};
    make_row_format(w, &w->dst, format);
    make_image(w, &w->dst, SLOT_DST, 0);
    struct hf_image *m = &w->dst;
    fill_lanes(w, lanes, LANES);
    w->no_alpha = rng_one_in(&w->rng, 3);
    for (int i = 0; i < hf_plane_count(m); i++) {
        struct region *g =
            world_region(w, REGION_PIXELS, SLOT_DST + i,
                         (uint8_t *)m->data[i] + w->y * m->stride[i] + hf_row_bytes(m->format, 2 * w->x),
                         hf_row_bytes(m->format, hf_min(2 * (w->x + w->n), m->width) - 2 * w->x), 0, 1, m->stride[i]);
        g->channel = i;
        g->x0 = 2 * w->x;
        g->y0 = w->y;
    }
}

void store_call(struct world *w, const struct kernels *k, enum arena a, int format)
{
    const struct hf_frame f = world_frame(w, k, a);
    const float *even[4], *odd[4];
    for (int c = 0; c < 4; c++) {
        even[c] = c == 3 && w->no_alpha ? NULL : lane(w, a, c);
        odd[c] = c == 3 && w->no_alpha ? NULL : lane(w, a, 4 + c);
    }
    w->result[a].clamped = k->pixel.store[format](f.dst, w->x, w->y, w->n, even, odd);
}

// ---- checks and roundings ----

enum { FINITE_F32, FINITE_F16, FINITE_R11, FINITE_ANY };

// A word with its largest exponent, or with the one below.
static uint32_t extreme_word(struct rng *r, int which, int bad)
{
    const uint32_t random = rng_next(r);
    if (which == FINITE_F32)
        return (random & 0x807fffff) | (bad ? 0x7f800000 : 0x7f000000);
    if (which == FINITE_F16)
        return (random & 0x83ff) | (bad ? 0x7c00 : 0x7800);
    const uint32_t highest[3] = {0x7c0, 0x3e0000, 0xf8000000}, finite = random & ~0x08020040u;
    return bad ? finite | highest[random % 3] : finite | (random & 1 ? 0x780 : 0x3c0000);
}

void finite_make(struct world *w, int which)
{
    make_size(w);
    w->finite = which;
    struct rng *r = &w->rng;
    const size_t size = which == FINITE_F16 ? 2 : 4;
    w->word_count = w->bench ? 256 : (size_t)rng_int(r, 0, rng_one_in(r, 2) ? 40 : 340);
    const size_t front = (size_t)rng_int(r, 0, 70), tail = (size_t)(rng_one_in(r, 2) ? 0 : rng_int(r, 0, 70));
    uint8_t *p = slot_use(w, SLOT_SRC, front + w->word_count * size + tail, 0xff) + front;
    w->words = p;
    const int bad = !w->bench && w->word_count && rng_one_in(r, 2) ? rng_int(r, 0, (int)w->word_count - 1) : -1;
    const int calm = rng_one_in(r, 2);
    for (int i = 0; i < (int)w->word_count; i++) {
        const uint32_t u = calm && i != bad ? 0 : extreme_word(r, which, i == bad);
        memcpy(p + (size_t)i * size, &u, size);
    }
    w->copy = NULL;
    if (w->bench || rng_one_in(r, 3))
        return;
    const size_t before = rng_one_in(r, 2) ? 0 : (size_t)rng_int(r, 0, 70);
    const size_t after = rng_one_in(r, 2) ? 0 : 64 - w->word_count * size % 64;  // then the first may be aligned
    w->copy = slot_use(w, SLOT_DST, before + w->word_count * size + after, 0xff) + before;
    if (w->word_count)
        world_region(w, REGION_SCRATCH, SLOT_DST, w->copy, w->word_count * size, 0, 1, 0);
}

void finite_call(struct world *w, const struct kernels *k, enum arena a, int which)
{
    hf_finite *const f = which == FINITE_F32   ? k->pixel.finite_f32
                         : which == FINITE_F16 ? k->pixel.finite_f16
                         : which == FINITE_R11 ? k->pixel.finite_r11
                                               : k->pixel.finite_any;
    w->result[a].returned = f(in_arena(a, w->words), w->word_count, in_arena(a, w->copy)) != 0;
}

// If samples are not finite, their copy need not be complete.
int finite_check(const struct world *w, const struct level *l, char message[256])
{
    const size_t size = w->finite == FINITE_F16 ? 2 : 4;
    if (w->copy && w->result[ARENA_TEST].returned &&
        memcmp(in_arena(ARENA_TEST, w->copy), in_arena(ARENA_TEST, w->words), w->word_count * size)) {
        snprintf(message, 256, "the copy is another");
        return 0;
    }
    return row_check(w, l, message);
}

// channels 3: truncate_r11; 1: round_half.
void round_make(struct world *w, int channels)
{
    make_size(w);
    random_row(w);
    static const int lanes[3] = {0, 1, 2};
    fill_lanes(w, lanes, channels);
    for (int c = 0; c < channels; c++)
        lane_region(w, REGION_FLOATS, c);
}

void round_call(struct world *w, const struct kernels *k, enum arena a, int channels)
{
    if (channels == 3)
        k->pixel.truncate_r11(lane(w, a, 0), lane(w, a, 1), lane(w, a, 2), w->n);
    else
        k->pixel.round_half(lane(w, a, 0), w->n);
}

// which 0: raised, 1: lowered.
void highlight_make(struct world *w, int which)
{
    static const int lanes[3] = {0, 1, 2};
    (void)which;
    make_size(w);
    random_row(w);
    const struct hf_highlight_params p = {.gain = rng_float(&w->rng, 1, 64), .threshold = rng_float(&w->rng, 0, 0.99f)};
    w->setup.highlight = hf_highlight_of(&p);
    fill_lanes(w, lanes, 3);
    for (int c = 0; c < 3; c++)
        lane_region(w, REGION_FLOATS, c);
}

void highlight_call(struct world *w, const struct kernels *k, enum arena a, int which)
{
    (which ? k->pixel.lower : k->pixel.raise)(&w->setup.highlight, lane(w, a, 0), lane(w, a, 1), lane(w, a, 2), w->n);
}

int row_check(const struct world *w, const struct level *l, char message[256])
{
    const struct result *want = &w->result[ARENA_REFERENCE], *got = &w->result[ARENA_TEST];
    if (want->returned != got->returned || want->clamped != got->clamped ||
        memcmp(&want->counts, &got->counts, sizeof want->counts)) {
        snprintf(message, 256, "returned %d, clamped %llu, the C %d and %llu; or other counts", got->returned,
                 (unsigned long long)got->clamped, want->returned, (unsigned long long)want->clamped);
        return 0;
    }
    return world_compare(w, l, message);
}

int row_pixels(const struct world *w)
{
    return w->word_count ? (int)w->word_count / 2 : w->n;
}
