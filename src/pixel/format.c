// SPDX-License-Identifier: BSD-3-Clause
// Rows of images in every format, in plain C: the specification of the vector versions.
#include "pixel/format.h"

#include "pixel/kernels.h"
#include "pixel/unorm.h"

static const uint8_t *row_of(const struct hf_image *m, int plane, int y)
{
    return (const uint8_t *)m->data[plane] + (ptrdiff_t)y * m->stride[plane];
}

int hf_image_channels(const struct hf_image *m)
{
    switch (m->format) {
    case HF_FORMAT_RGBA32F:
    case HF_FORMAT_RGBA16F:
        return 4;
    case HF_FORMAT_PLANAR32F:
        return m->data[3] ? 4 : 3;
    case HF_FORMAT_RGB32F:
    case HF_FORMAT_R11G11B10F:
        return 3;
    default:
        return hf_unorm(m->format)->channels;
    }
}

int hf_plane_count(const struct hf_image *m)
{
    return m->format == HF_FORMAT_PLANAR32F ? hf_image_channels(m) : 1;
}

size_t hf_row_bytes(enum hf_format format, int n)
{
    static const uint8_t bytes[HF_FORMAT_COUNT] = {16, 12, 8, 4, 4, 4, 4, 4, 4, 4, 8};
    return (size_t)n * bytes[format];
}

// memcpy, because rows need not be aligned.
static float get_float(const uint8_t *p)
{
    float v;
    memcpy(&v, p, 4);
    return v;
}

float hf_sample(const struct hf_image *m, int c, int x, int y)
{
    if (c == 3 && hf_image_channels(m) == 3)
        return 1;
    if (hf_unorm(m->format))
        return hf_unorm_sample(m, c, x, y);
    const uint8_t *row = row_of(m, m->format == HF_FORMAT_PLANAR32F ? c : 0, y);
    uint32_t word;
    uint16_t half;
    float v;
    switch (m->format) {
    case HF_FORMAT_RGBA32F:
        return get_float(row + (size_t)x * 16 + c * 4);
    case HF_FORMAT_RGB32F:
        return get_float(row + (size_t)x * 12 + c * 4);
    case HF_FORMAT_PLANAR32F:
        return get_float(row + (size_t)x * 4);
    case HF_FORMAT_RGBA16F:
        memcpy(&half, row + (size_t)x * 8 + c * 2, 2);
        v = hf_half_unpack(half);
        break;
    case HF_FORMAT_R11G11B10F:
    default: {
        float rgb[3];
        memcpy(&word, row + (size_t)x * 4, 4);
        hf_r11_unpack(word, &rgb[0], &rgb[1], &rgb[2]);
        v = rgb[c];
    }
    }
    return v > -65536.0f && v < 65536.0f ? v : hf_from_bits(0x7fc00000);
}

float hf_round_to_format(enum hf_format format, int c, float v)
{
    if (format == HF_FORMAT_RGBA16F)
        return hf_half_unpack(hf_half_pack(v));
    if (format == HF_FORMAT_R11G11B10F) {
        const int m = c == 2 ? 5 : 6;
        return hf_decode_small(hf_encode_small(hf_clamp_unsigned(v, c == 2 ? HF_R10_MAX : HF_R11_MAX), m), m);
    }
    return v;
}

void hf_put_sample(const struct hf_image *m, int c, int x, int y, float v)
{
    if (hf_unorm(m->format)) {
        hf_unorm_put(m, c, x, y, v);
        return;
    }
    uint8_t *row = (uint8_t *)m->data[m->format == HF_FORMAT_PLANAR32F ? c : 0] +
                   (ptrdiff_t)y * m->stride[m->format == HF_FORMAT_PLANAR32F ? c : 0];
    switch ((int)m->format) {
    case HF_FORMAT_RGBA32F:
        memcpy(row + (size_t)x * 16 + c * 4, &v, 4);
        break;
    case HF_FORMAT_RGB32F:
        memcpy(row + (size_t)x * 12 + c * 4, &v, 4);
        break;
    case HF_FORMAT_PLANAR32F:
        memcpy(row + (size_t)x * 4, &v, 4);
        break;
    case HF_FORMAT_RGBA16F: {
        const uint16_t half = hf_half_pack(v);
        memcpy(row + (size_t)x * 8 + c * 2, &half, 2);
        break;
    }
    case HF_FORMAT_R11G11B10F: {
        const int m_bits = c == 2 ? 5 : 6, shift = c * 11;
        const uint32_t mask = (c == 2 ? 0x3ffu : 0x7ffu) << shift;
        uint32_t word;
        memcpy(&word, row + (size_t)x * 4, 4);
        word &= ~mask;
        word |= hf_encode_small(hf_clamp_unsigned(v, c == 2 ? HF_R10_MAX : HF_R11_MAX), m_bits) << shift;
        memcpy(row + (size_t)x * 4, &word, 4);
        break;
    }
    }
}

// One loop for all formats; the vector versions have one each.
static int load_row_c(const struct hf_image *m, int x, int y, int n, float *const even[4], float *const odd[4])
{
    const int channels = hf_image_channels(m), last = m->width - 1;
    int bad = 0;
    for (int c = 0; c < channels; c++)
        for (int i = 0; i < n; i++) {
            even[c][i] = hf_sample(m, c, 2 * (x + i), y);
            odd[c][i] = hf_sample(m, c, hf_min(2 * (x + i) + 1, last), y);
            bad |= !(hf_is_finite(even[c][i]) && hf_is_finite(odd[c][i]));
        }
    return bad;
}

// The benchmark's format, with the switch outside the loop.
static int load_r11_c(const struct hf_image *m, int x, int y, int n, float *const even[4], float *const odd[4])
{
    const uint8_t *row = row_of(m, 0, y);
    int bad = 0;
    for (int i = 0; i < n; i++) {
        uint32_t a, b;
        memcpy(&a, row + (size_t)(2 * (x + i)) * 4, 4);
        memcpy(&b, row + (size_t)hf_min(2 * (x + i) + 1, m->width - 1) * 4, 4);
        hf_r11_unpack(a, &even[0][i], &even[1][i], &even[2][i]);
        hf_r11_unpack(b, &odd[0][i], &odd[1][i], &odd[2][i]);
        for (int c = 0; c < 3; c++)
            bad |= !(even[c][i] < 65536.0f && odd[c][i] < 65536.0f);
    }
    return bad;
}

static uint64_t store_r11_c(const struct hf_image *m, int x, int y, int n, const float *const even[4],
                            const float *const odd[4])
{
    uint8_t *row = (uint8_t *)m->data[0] + (ptrdiff_t)y * m->stride[0];
    uint64_t clamped = 0;
    for (int i = 2 * x; i < 2 * (x + n) && i < m->width; i++) {
        const float *const *lane = i & 1 ? odd : even;
        const float r = lane[0][i / 2 - x], g = lane[1][i / 2 - x], b = lane[2][i / 2 - x];
        const uint32_t word = hf_r11_pack(r, g, b);
        clamped += !(r >= 0 && r <= HF_R11_MAX) + !(g >= 0 && g <= HF_R11_MAX) + !(b >= 0 && b <= HF_R10_MAX);
        memcpy(row + (size_t)i * 4, &word, 4);
    }
    return clamped;
}

// Whether v fits channel c of a format.
static int fits(enum hf_format format, int c, float v)
{
    if (format == HF_FORMAT_RGBA16F)
        return v >= -HF_HALF_MAX && v <= HF_HALF_MAX;
    if (format == HF_FORMAT_R11G11B10F)
        return v >= 0 && v <= (c == 2 ? HF_R10_MAX : HF_R11_MAX);
    if (hf_unorm(format))
        return v >= 0 && v <= 1;
    return 1;
}

static uint64_t store_row_c(const struct hf_image *m, int x, int y, int n, const float *const even[4],
                            const float *const odd[4])
{
    const int channels = hf_image_channels(m);
    uint64_t clamped = 0;
    for (int c = 0; c < channels; c++)
        for (int i = 2 * x; i < 2 * (x + n) && i < m->width; i++) {
            const float *const *lane = i & 1 ? odd : even;
            const float v = lane[c] ? lane[c][i / 2 - x] : 1;
            clamped += !fits(m->format, c, v);
            hf_put_sample(m, c, i, y, v);
        }
    return clamped;
}

static int finite_f32_c(const void *words, size_t n, void *copy)
{
    const uint8_t *p = words;
    if (copy)
        memcpy(copy, words, n * 4);
    for (size_t i = 0; i < n; i++)
        if (!hf_is_finite(get_float(p + 4 * i)))
            return 0;
    return 1;
}

static int finite_f16_c(const void *words, size_t n, void *copy)
{
    const uint8_t *p = words;
    if (copy)
        memcpy(copy, words, n * 2);
    for (size_t i = 0; i < n; i++) {
        uint16_t h;
        memcpy(&h, p + 2 * i, 2);
        if ((h & 0x7c00) == 0x7c00)
            return 0;
    }
    return 1;
}

// Integers are always finite.
static int finite_any_c(const void *words, size_t n, void *copy)
{
    (void)words;
    if (copy)
        memcpy(copy, words, n * 4);
    return 1;
}

static int finite_r11_c(const void *words, size_t n, void *copy)
{
    const uint8_t *p = words;
    if (copy)
        memcpy(copy, words, n * 4);
    for (size_t i = 0; i < n; i++) {
        uint32_t u;
        memcpy(&u, p + 4 * i, 4);
        if ((u & 0x7c0) == 0x7c0 || (u & 0x3e0000) == 0x3e0000 || (u & 0xf8000000) == 0xf8000000)
            return 0;
    }
    return 1;
}

static void truncate_r11_c(float *r, float *g, float *b, int n)
{
    for (int i = 0; i < n; i++) {
        r[i] = hf_decode_small(hf_truncate_small(hf_clamp_unsigned(r[i], HF_R11_MAX), 6), 6);
        g[i] = hf_decode_small(hf_truncate_small(hf_clamp_unsigned(g[i], HF_R11_MAX), 6), 6);
        b[i] = hf_decode_small(hf_truncate_small(hf_clamp_unsigned(b[i], HF_R10_MAX), 5), 5);
    }
}

static void round_half_c(float *v, int n)
{
    for (int i = 0; i < n; i++)
        v[i] = hf_half_unpack(hf_half_pack(v[i]));
}

void hf_format_kernels_c(struct hf_pixel_kernels *k)
{
    for (int i = 0; i < HF_FORMAT_COUNT; i++) {
        k->load[i] = load_row_c;
        k->store[i] = store_row_c;
    }
    k->load[HF_FORMAT_R11G11B10F] = load_r11_c;
    k->store[HF_FORMAT_R11G11B10F] = store_r11_c;
    k->finite_f32 = finite_f32_c;
    k->finite_f16 = finite_f16_c;
    k->finite_r11 = finite_r11_c;
    k->finite_any = finite_any_c;
    k->truncate_r11 = truncate_r11_c;
    k->round_half = round_half_c;
}
