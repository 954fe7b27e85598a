// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/look.h"

#include <glib.h>
#include <math.h>
#include <string.h>

// The command's curve, in float as there, and its rounding.
static int encode(float v)
{
    v = isnan(v) ? 0 : fminf(fmaxf(v, 0), 1);
    const float s = v <= 0.0031308f ? v * 12.92f : 1.055f * powf(v, 1.0f / 2.4f) - 0.055f;
    return (int)(s * 255.0f + 0.5f);
}

// For the upper bits of a float: the byte of its least value. The byte of others is that or the next one, and from[] tells which.
enum { SHIFT = 14, ENTRIES = 1 << (31 - SHIFT) };
static uint8_t first[ENTRIES];
static float from[257];  // the least float of each byte; the last is beyond all

static float least_of(int byte)
{
    uint32_t low = 0, high = 0x3f800000;  // 0 and 1, whose bits grow with the number
    while (low < high) {
        const uint32_t middle = (low + high) / 2;
        float v;
        memcpy(&v, &middle, sizeof(v));
        if (encode(v) >= byte)
            high = middle;
        else
            low = middle + 1;
    }
    float v;
    memcpy(&v, &low, sizeof(v));
    return v;
}

static void make_tables(void)
{
    static gsize made;
    if (!g_once_init_enter(&made))
        return;
    for (int i = 0; i < 256; i++)
        from[i] = least_of(i);
    from[256] = INFINITY;
    for (uint32_t i = 0; i < ENTRIES; i++) {
        const uint32_t bits = i << SHIFT;
        float v;
        memcpy(&v, &bits, sizeof(v));
        first[i] = (uint8_t)encode(v);
    }
    g_once_init_leave(&made, 1);
}

static inline uint32_t byte_of(float v)
{
    uint32_t bits;
    v = v > 0 ? v : 0;  // NaN too
    v = v < 1 ? v : 1;
    memcpy(&bits, &v, sizeof(bits));
    uint32_t byte = first[bits >> SHIFT];
    while (v >= from[byte + 1])
        byte++;
    return byte;
}

uint8_t view_look_byte(float linear)
{
    make_tables();
    return (uint8_t)byte_of(linear);
}

void view_look_row(const float *r, const float *g, const float *b, float gain, uint32_t *to, int n)
{
    make_tables();
    for (int i = 0; i < n; i++)
        to[i] = 0xff000000u | byte_of(r[i] * gain) << 16 | byte_of(g[i] * gain) << 8 | byte_of(b[i] * gain);
}

uint32_t view_look_pixel(float r, float g, float b)
{
    const float v[3] = {r, g, b};
    uint32_t pixel = 0xff;
    for (int c = 0; c < 3; c++)
        pixel = pixel << 8 | (uint32_t)(fminf(fmaxf(v[c], 0), 1) * 255 + 0.5f);
    return pixel;
}
