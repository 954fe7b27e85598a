// SPDX-License-Identifier: BSD-3-Clause
#include "pixel/depth_rows.h"

#include <math.h>

size_t hf_depth_bytes(enum hf_depth_format format)
{
    return format == HF_DEPTH_FORMAT_FLOAT16 || format == HF_DEPTH_FORMAT_UNORM16 ? 2 : 4;
}

static const uint8_t *sample_at(const struct hf_depth *depth, int x, int y)
{
    return (const uint8_t *)depth->data + (ptrdiff_t)y * depth->stride + (size_t)x * hf_depth_bytes(depth->format);
}

static float half_of(uint16_t h)
{
    if ((h & 0x7c00) != 0x7c00)
        return hf_half_unpack(h);
    return h & 0x3ff ? NAN : h & 0x8000 ? -INFINITY : INFINITY;
}

static float widen(enum hf_depth_format format, const uint8_t *p)
{
    float v;
    uint32_t word = 0;
    memcpy(&word, p, hf_depth_bytes(format));
    switch (format) {
    case HF_DEPTH_FORMAT_FLOAT16:
        return half_of((uint16_t)word);
    case HF_DEPTH_FORMAT_UNORM16:
        return (float)word * HF_DEPTH_UNIT_16;
    case HF_DEPTH_FORMAT_UNORM32:
        return (float)word * HF_DEPTH_UNIT_32;
    case HF_DEPTH_FORMAT_D24S8:
        return (float)(word >> 8) * HF_DEPTH_UNIT_24;
    case HF_DEPTH_FORMAT_X8D24:
        return (float)(word & 0xffffff) * HF_DEPTH_UNIT_24;
    case HF_DEPTH_FORMAT_FLOAT32:
    default:
        memcpy(&v, p, 4);
        return v;
    }
}

float hf_depth_sample(const struct hf_depth *depth, int x, int y)
{
    return widen(depth->format, sample_at(depth, x, y));
}

void hf_widen_depth_c(enum hf_depth_format format, const void *p, int n, float *out)
{
    const size_t bytes = hf_depth_bytes(format);
    for (int i = 0; i < n; i++)
        out[i] = widen(format, (const uint8_t *)p + (size_t)i * bytes);
}

#define WIDEN(name, format)                                                                                            \
    static void widen_##name##_c(const void *p, int n, float *out)                                                     \
    {                                                                                                                  \
        hf_widen_depth_c(format, p, n, out);                                                                           \
    }
WIDEN(float16, HF_DEPTH_FORMAT_FLOAT16)
WIDEN(unorm16, HF_DEPTH_FORMAT_UNORM16)
WIDEN(unorm32, HF_DEPTH_FORMAT_UNORM32)
WIDEN(d24s8, HF_DEPTH_FORMAT_D24S8)
WIDEN(x8d24, HF_DEPTH_FORMAT_X8D24)

void hf_depth_rows_c(struct hf_pixel_kernels *k)
{
    k->depth[HF_DEPTH_FORMAT_FLOAT32] = NULL;
    k->depth[HF_DEPTH_FORMAT_FLOAT16] = widen_float16_c;
    k->depth[HF_DEPTH_FORMAT_UNORM16] = widen_unorm16_c;
    k->depth[HF_DEPTH_FORMAT_UNORM32] = widen_unorm32_c;
    k->depth[HF_DEPTH_FORMAT_D24S8] = widen_d24s8_c;
    k->depth[HF_DEPTH_FORMAT_X8D24] = widen_x8d24_c;
}

const uint8_t *hf_depth_row(const struct hf_frame *f, int x, int y, int n, int row)
{
    const uint8_t *p = sample_at(f->depth, x, y);
    if (f->depth->format == HF_DEPTH_FORMAT_FLOAT32)
        return p;
    float *out = f->depth_lines + (size_t)row * 2 * f->line_floats;
    f->k->depth[f->depth->format](p, n, out);
    return (const uint8_t *)out;
}
