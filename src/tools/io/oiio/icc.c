// SPDX-License-Identifier: BSD-3-Clause
// ICC.1:2010: the header (7.2), the tag table (7.3), curveType (10.5), parametricCurveType (10.15), XYZType (10.27).
#include "tools/io/oiio/icc.h"

#include <math.h>
#include <string.h>

// XYZ relative to D50, which profiles are in, to linear light of sRGB (IEC 61966-2-1, adapted by Bradford's matrix).
static const double xyz_to_srgb[3][3] = {
    {3.1338561, -1.6168667, -0.4906146}, {-0.9787684, 1.9161415, 0.0334540}, {0.0719453, -0.2289914, 1.4052427}};

struct bytes {
    const uint8_t *data;
    size_t size;
};

static uint32_t word(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static double fixed(const uint8_t *p)
{
    return (double)(int32_t)word(p) / 65536;
}

// The bytes of a tag; size 0 if there is none, or if it lies outside the profile.
static struct bytes tag_of(struct bytes all, const char *name)
{
    const struct bytes none = {NULL, 0};
    const uint32_t count = all.size >= 132 ? word(all.data + 128) : 0;
    for (uint32_t i = 0; i < count && 132 + 12 * (size_t)(i + 1) <= all.size; i++) {
        const uint8_t *row = all.data + 132 + 12 * (size_t)i;
        const size_t at = word(row + 4), size = word(row + 8);
        if (!memcmp(row, name, 4))
            return at <= all.size && size <= all.size - at ? (struct bytes){all.data + at, size} : none;
    }
    return none;
}

static int read_colour(struct bytes all, const char *name, double xyz[3])
{
    const struct bytes tag = tag_of(all, name);
    if (tag.size < 20 || memcmp(tag.data, "XYZ ", 4))
        return -1;
    for (int i = 0; i < 3; i++)
        xyz[i] = fixed(tag.data + 8 + 4 * i);
    return 0;
}

// A curve by a gamma, or by samples with straight lines between them.
static int read_samples(struct bytes tag, float *curve)
{
    const uint32_t n = word(tag.data + 8);
    const uint8_t *samples = tag.data + 12;
    if (tag.size < 12 || n > (tag.size - 12) / 2)
        return -1;
    const double gamma = n == 1 ? (samples[0] * 256 + samples[1]) / 256. : 1;
    for (int i = 0; i <= HF_ICC_STEPS; i++) {
        const double v = (double)i / HF_ICC_STEPS, at = v * (n > 1 ? n - 1 : 0);
        const uint32_t k = n > 1 && at < n - 1 ? (uint32_t)at : n > 1 ? n - 2 : 0;
        if (n < 2) {
            curve[i] = (float)pow(v, gamma);
            continue;
        }
        const double low = samples[2 * k] * 256 + samples[2 * k + 1],
                     high = samples[2 * k + 2] * 256 + samples[2 * k + 3];
        curve[i] = (float)((low + (high - low) * (at - k)) / 65535);
    }
    return 0;
}

static int read_formula(struct bytes tag, float *curve)
{
    static const int counts[] = {1, 3, 4, 5, 7};
    const int kind = tag.size >= 12 ? tag.data[8] * 256 + tag.data[9] : 5;
    double p[7] = {0};  // g a b c d e f
    if (kind > 4 || tag.size < 12 + 4 * (size_t)counts[kind])
        return -1;
    for (int i = 0; i < counts[kind]; i++)
        p[i] = fixed(tag.data + 12 + 4 * i);
    const double a = kind ? p[1] : 1, b = p[2];
    // Kinds 0 to 2 are a power from -b/a on and a constant before; 3 and 4 begin with a line up to d.
    const double from = kind > 2 ? p[4] : kind && a != 0 ? -b / a : 0;
    const double slope = kind > 2 ? p[3] : 0, add = kind == 2 ? p[3] : kind == 4 ? p[5] : 0;
    const double start = kind == 2 ? p[3] : kind == 4 ? p[6] : 0;
    for (int i = 0; i <= HF_ICC_STEPS; i++) {
        const double v = (double)i / HF_ICC_STEPS;
        curve[i] = (float)(v >= from ? pow(fmax(a * v + b, 0), p[0]) + add : slope * v + start);
    }
    return 0;
}

static int read_curve(struct bytes all, const char *name, float *curve)
{
    const struct bytes tag = tag_of(all, name);
    const int samples = tag.size >= 12 && !memcmp(tag.data, "curv", 4);
    const int formula = tag.size >= 12 && !memcmp(tag.data, "para", 4);
    if ((!samples && !formula) || (samples ? read_samples(tag, curve) : read_formula(tag, curve)))
        return -1;
    for (int i = 0; i <= HF_ICC_STEPS; i++) {
        if (!isfinite(curve[i]))
            return -1;
        curve[i] = fminf(fmaxf(curve[i], 0), 1);
        if (i && curve[i] < curve[i - 1])
            return -1;
    }
    return curve[HF_ICC_STEPS] > curve[0] ? 0 : -1;
}

static int invert(double out[3][3], double m[3][3])
{
    double det = 0;
    for (int i = 0; i < 3; i++)
        det += m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3]);
    if (!(fabs(det) > 1e-6))
        return -1;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[j][i] = (m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3] -
                         m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3]) /
                        det;
    return 0;
}

int hf_icc_read(struct hf_icc *icc, const uint8_t *data, size_t size)
{
    static const char *const colours[] = {"rXYZ", "gXYZ", "bXYZ"}, *const curves[] = {"rTRC", "gTRC", "bTRC"};
    const struct bytes all = {data, size};
    if (size < 132 || memcmp(data + 36, "acsp", 4) || memcmp(data + 16, "RGB ", 4) || memcmp(data + 20, "XYZ ", 4))
        return -1;
    for (int k = 0; k < 3; k++) {
        double xyz[3];
        if (read_colour(all, colours[k], xyz) || read_curve(all, curves[k], icc->curve[k]))
            return -1;
        for (int i = 0; i < 3; i++)
            icc->to[i][k] = xyz_to_srgb[i][0] * xyz[0] + xyz_to_srgb[i][1] * xyz[1] + xyz_to_srgb[i][2] * xyz[2];
    }
    return invert(icc->from, icc->to);
}

static void multiply(const double m[3][3], float rgb[3])
{
    const double r = rgb[0], g = rgb[1], b = rgb[2];
    for (int i = 0; i < 3; i++)
        rgb[i] = (float)(m[i][0] * r + m[i][1] * g + m[i][2] * b);
}

void hf_icc_to_light(const struct hf_icc *icc, float rgb[3])
{
    for (int k = 0; k < 3; k++) {
        const double at = fmin(fmax(rgb[k], 0), 1) * HF_ICC_STEPS;
        const int i = at < HF_ICC_STEPS ? (int)at : HF_ICC_STEPS - 1;
        const double low = icc->curve[k][i], high = icc->curve[k][i + 1];
        rgb[k] = (float)(low + (high - low) * (at - i));
    }
    multiply(icc->to, rgb);
}

// The code of a light: the curve, read from its other side.
static float code_of(const float *curve, float light)
{
    int low = 0, high = HF_ICC_STEPS;
    if (!(light > curve[0]))
        return 0;
    if (light >= curve[HF_ICC_STEPS])
        return 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (curve[middle] <= light)
            low = middle;
        else
            high = middle;
    }
    return ((float)low + (light - curve[low]) / (curve[high] - curve[low])) / HF_ICC_STEPS;
}

void hf_icc_to_code(const struct hf_icc *icc, float rgb[3])
{
    multiply(icc->from, rgb);
    for (int k = 0; k < 3; k++)
        rgb[k] = code_of(icc->curve[k], rgb[k]);
}
