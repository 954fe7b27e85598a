// SPDX-License-Identifier: BSD-3-Clause
// Compares what a kernel wrote with what the C wrote, and checks that it changed nothing else.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "harness.h"

static const uint8_t *region_row(const struct world *w, enum arena a, const struct region *g, int row)
{
    return slot_start(w, a, g->slot) + g->offset + row * g->stride;
}

// Equal bits, or with fused arithmetic a difference within the bound. NaN matches only NaN.
static int close_enough(float want, float got, double bound)
{
    if (want != want || got != got)
        return want != want && got != got;
    return fabs((double)want - (double)got) <= bound;
}

static int compare_floats(const struct world *w, const struct level *l, const struct region *g, char message[256])
{
    for (int y = 0; y < g->rows; y++) {
        const uint8_t *a = region_row(w, ARENA_REFERENCE, g, y), *b = region_row(w, ARENA_TEST, g, y);
        if (!memcmp(a, b, g->row_bytes))
            continue;
        for (size_t x = 0; x < g->row_bytes / 4; x++) {
            float want, got;
            memcpy(&want, a + 4 * x, 4);
            memcpy(&got, b + 4 * x, 4);
            if (hf_bits(want) == hf_bits(got) || (want != want && got != got))
                continue;
            double bound = 0;
            if (!l->exact && g->buf >= 0) {
                bound = bound_buffer(w, g->buf, g->channel, g->x0 + (int)x, g->y0 + y, want, got);
                if (close_enough(want, got, bound))
                    continue;
            }
            snprintf(message, 256, "slot %d channel %d at (%d, %d): %a, the C %a, off by %g of %g", g->slot, g->channel,
                     g->x0 + (int)x, g->y0 + y, got, want, fabs((double)got - want), bound);
            return 0;
        }
    }
    return 1;
}

static int compare_narrow(const struct world *w, const struct region *g, char message[256])
{
    const int bytes = buf_bytes(w, g->buf);
    for (int y = 0; y < g->rows; y++)
        for (size_t i = 0; i < g->row_bytes; i += (size_t)bytes) {
            const uint8_t *a = region_row(w, ARENA_REFERENCE, g, y) + i, *b = region_row(w, ARENA_TEST, g, y) + i;
            if (!memcmp(a, b, (size_t)bytes))
                continue;
            snprintf(message, 256, "slot %d at (%d, %d): %a, the C %a", g->slot, g->x0 + (int)i / bytes, g->y0 + y,
                     hf_narrow_load(w->setup.storage, b), hf_narrow_load(w->setup.storage, a));
            return 0;
        }
    return 1;
}

// One pixel of dst; first and count: its channels in the region's plane.
static int compare_pixel(const struct world *w, const struct region *g, int x, int y, char message[256])
{
    struct hf_image want_image = w->dst, got_image = w->dst;
    for (int i = 0; i < 4; i++) {
        want_image.data[i] = in_arena(ARENA_REFERENCE, w->dst.data[i]);
        got_image.data[i] = in_arena(ARENA_TEST, w->dst.data[i]);
    }
    const int planar = w->dst.format == HF_FORMAT_PLANAR32F;
    for (int c = planar ? g->channel : 0; c < (planar ? g->channel + 1 : hf_image_channels(&w->dst)); c++) {
        const float want = hf_sample(&want_image, c, x, y), got = hf_sample(&got_image, c, x, y);
        const double bound = hf_bits(want) == hf_bits(got) ? 0 : bound_pixel(w, c, x, y, want, got);
        if (close_enough(want, got, bound))
            continue;
        snprintf(message, 256, "dst channel %d at (%d, %d): %a, the C %a, off by %g of %g", c, x, y, got, want,
                 fabs((double)got - want), bound);
        return 0;
    }
    return 1;
}

static int compare_pixels(const struct world *w, const struct level *l, const struct region *g, char message[256])
{
    const int pixels = (int)(g->row_bytes / hf_row_bytes(w->dst.format, 1));
    for (int y = 0; y < g->rows; y++) {
        const uint8_t *a = region_row(w, ARENA_REFERENCE, g, y), *b = region_row(w, ARENA_TEST, g, y);
        if (!memcmp(a, b, g->row_bytes))
            continue;
        if (!l->exact && w->is_pass) {
            for (int x = 0; x < pixels; x++)
                if (!compare_pixel(w, g, g->x0 + x, g->y0 + y, message))
                    return 0;
            continue;
        }
        size_t i = 0;
        while (a[i] == b[i])
            i++;
        const size_t pixel = i / hf_row_bytes(w->dst.format, 1);
        snprintf(message, 256, "dst plane %d at (%d, %d), byte %zu: %02x, the C %02x", g->channel, g->x0 + (int)pixel,
                 g->y0 + y, i % hf_row_bytes(w->dst.format, 1), b[i], a[i]);
        return 0;
    }
    return 1;
}

static int compare_bytes(const struct world *w, const struct region *g, char message[256])
{
    for (int y = 0; y < g->rows; y++)
        if (memcmp(region_row(w, ARENA_REFERENCE, g, y), region_row(w, ARENA_TEST, g, y), g->row_bytes)) {
            snprintf(message, 256, "slot %d row %d: other bytes than the C", g->slot, y);
            return 0;
        }
    return 1;
}

// Check that everything outside the regions is as it was made.
static int untouched(const struct world *w, enum arena a, char message[256])
{
    static uint8_t *expected;
    static size_t room;
    for (int s = 0; s < SLOT_COUNT; s++) {
        const size_t n = w->bytes[s];
        if (!n || s == SLOT_DEPTH_LINES || (w->is_pass && (s == SLOT_LINES || s == SLOT_WORK)))
            continue;
        if (room < n) {
            free(expected);
            expected = malloc(room = n);
            if (!expected)
                abort();
        }
        memcpy(expected, slot_start(w, ARENA_MADE, s), n);
        const uint8_t *got = slot_start(w, a, s);
        for (int i = 0; i < w->region_count; i++) {
            const struct region *g = &w->regions[i];
            for (int y = 0; y < g->rows && g->slot == s; y++)
                memcpy(expected + g->offset + y * g->stride, got + g->offset + y * g->stride, g->row_bytes + g->spare);
        }
        if (!memcmp(expected, got, n))
            continue;
        size_t i = 0;
        while (expected[i] == got[i])
            i++;
        snprintf(message, 256, "wrote where it must not: slot %d, byte %zu of %zu", s, i, n);
        return 0;
    }
    return 1;
}

int world_compare(const struct world *w, const struct level *l, char message[256])
{
    for (int i = 0; i < w->region_count; i++) {
        const struct region *g = &w->regions[i];
        if ((g->kind == REGION_FLOATS && !compare_floats(w, l, g, message)) ||
            (g->kind == REGION_NARROW && !compare_narrow(w, g, message)) ||
            (g->kind == REGION_BYTES && !compare_bytes(w, g, message)) ||
            (g->kind == REGION_PIXELS && !compare_pixels(w, l, g, message)))
            return 0;
    }
    return untouched(w, ARENA_TEST, message);
}

int reference_check(const struct world *w, char message[256])
{
    for (int i = 0; i < w->region_count && w->is_pass; i++) {
        const struct region *g = &w->regions[i];
        for (int y = 0; y < g->rows && g->kind == REGION_FLOATS; y++)
            for (size_t x = 0; x < g->row_bytes / 4; x++) {
                float v;
                memcpy(&v, region_row(w, ARENA_REFERENCE, g, y) + 4 * x, 4);
                if (!hf_is_finite(v)) {
                    snprintf(message, 256, "slot %d channel %d at (%d, %d): %a", g->slot, g->channel, g->x0 + (int)x,
                             g->y0 + y, v);
                    return 0;
                }
            }
    }
    return untouched(w, ARENA_REFERENCE, message);
}
