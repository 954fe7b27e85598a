// SPDX-License-Identifier: BSD-3-Clause
// Sprites from an image of the aperture: box-filtered to every size, with a weight for every pixel.
#include <float.h>
#include <math.h>
#include <string.h>

#include "pixel/aperture.h"
#include "pixel/format.h"

// 32 sizes per octave are kept. FULL is the weight of the brightest pixel. Parts of an image beyond LONGEST times its
// shorter side are cut off.
enum { STEPS = HF_SIZES / 32, FULL = 1023, LONGEST = 2 };

static float transmission(const struct hf_image *m, int c, int x, int y)
{
    const float v = hf_sample(m, c, x, y);
    return v > 0 && v < INFINITY ? v : 0;
}

uint64_t hf_aperture_hash(const struct hf_image *m, atomic_int *stop)
{
    uint64_t h = 0xcbf29ce484222325u;
    for (int y = 0; y < m->height && !hf_stopped(stop); y++)
        for (int x = 0; x < m->width; x++)
            for (int c = 0; c < 3; c++) {
                h = (h ^ hf_bits(transmission(m, c, x, y))) * 0x100000001b3u;
            }
    return h;
}

int hf_aperture_coloured(const struct hf_image *m, atomic_int *stop)
{
    for (int y = 0; y < m->height && !hf_stopped(stop); y++)
        for (int x = 0; x < m->width; x++)
            if (hf_sample(m, 0, x, y) != hf_sample(m, 1, x, y) || hf_sample(m, 0, x, y) != hf_sample(m, 2, x, y))
                return 1;
    return 0;
}

double hf_integral_at(const struct hf_integral *t, double x, double y)
{
    x = fmin(fmax(x, 0), t->width);
    y = fmin(fmax(y, 0), t->height);
    const int i = (int)fmin(x, t->width - 1), j = (int)fmin(y, t->height - 1);
    const double fx = x - i, fy = y - j;
    const double *a = t->sum + (size_t)j * (size_t)(t->width + 1) + i, *b = a + t->width + 1;
    return (a[0] * (1 - fx) + a[1] * fx) * (1 - fy) + (b[0] * (1 - fx) + b[1] * fx) * fy;
}

size_t hf_integral_bytes(const struct hf_image *m)
{
    return ((size_t)m->width + 1) * ((size_t)m->height + 1) * sizeof(double);
}

struct hf_integral hf_integral_make(double *sum, const struct hf_image *m, int c, atomic_int *stop)
{
    const size_t row = (size_t)m->width + 1;
    memset(sum, 0, row * sizeof *sum);
    for (int y = 0; y < m->height && !hf_stopped(stop); y++) {
        double *out = sum + (size_t)(y + 1) * row, line = 0;
        out[0] = 0;
        for (int x = 0; x < m->width; x++) {
            line += transmission(m, c, x, y);
            out[x + 1] = out[x - (ptrdiff_t)row + 1] + line;
        }
    }
    return (struct hf_integral){sum, m->width, m->height};
}

// The most light that rounding alone can show within so many rows where there is none: a difference of four values of the integral,
// of which each has two errors for each row between them and eight for places between pixels, of half a unit in the last place of all
// light.
static double noise_of(const struct hf_integral *t, double rows)
{
    const double all = t->sum[(size_t)t->height * ((size_t)t->width + 1) + (size_t)t->width];
    return (4 * (rows + 2) + 32) * DBL_EPSILON / 2 * all;
}

// The pixels of a sprite of radius r on either side of its centre.
static struct hf_picture frame_of(const struct hf_image *m, double r, double scale_x)
{
    const double shorter = m->width < m->height ? m->width : m->height;
    struct hf_picture p = {.reach_x = (int)ceil(r * scale_x * fmin(m->width / shorter, LONGEST) + 0.5),
                           .reach_y = (int)ceil(r * fmin(m->height / shorter, LONGEST) + 0.5)};
    p.top = -p.reach_y;
    p.rows = 2 * p.reach_y + 1;
    p.columns = 2 * p.reach_x + 2;  // one more, because differences are stored
    return p;
}

// The weights of one size, as differences along x. Returns their sum.
static double draw(struct hf_aperture *a, const struct hf_picture *p, const struct hf_integral *t, double r)
{
    const double shorter = t->width < t->height ? t->width : t->height, unit = shorter / 2 / r,
                 step_x = unit / a->key.scale_x;
    const int turned = a->key.rotation != 0;
    const double none = noise_of(t, unit);
    double most = 0, area = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int j = 0; j < p->rows; j++) {
            const int row = turned ? p->rows - 1 - j : j;
            int16_t *tap = a->tap + p->first + (ptrdiff_t)j * p->columns;
            const double y0 = t->height / 2.0 + (p->top + row - 0.5) * unit, y1 = y0 + unit;
            int last = 0;
            for (int i = 0; i < p->columns; i++) {
                const int from = turned ? p->reach_x - i : i - p->reach_x;
                const double x0 = t->width / 2.0 + (from - 0.5) * step_x, x1 = x0 + step_x;
                const double light = i + 1 < p->columns ? hf_integral_at(t, x1, y1) - hf_integral_at(t, x0, y1) -
                                                              hf_integral_at(t, x1, y0) + hf_integral_at(t, x0, y0)
                                                        : 0;
                const double v = light > none ? light : 0;
                if (pass == 0) {
                    most = v > most ? v : most;
                    continue;
                }
                const int w = most > 0 ? (int)lround(FULL * v / most) : 0;
                tap[i] = (int16_t)(w - last);
                last = w;
                area += w;
            }
        }
    }
    return area;
}

int hf_aperture_build_image(struct hf_aperture *a, const struct hf_aperture_key *key, const struct hf_image *image,
                            const struct hf_mem *mem, atomic_int *stop)
{
    struct hf_aperture_key with = *key;
    with.image = hf_aperture_hash(image, stop);
    with.width = image->width;
    with.height = image->height;
    if (hf_stopped(stop))
        return HF_ERR_CANCELLED;
    if (a->count && !memcmp(&a->key, &with, sizeof with))
        return HF_OK;
    a->key = with;
    a->symmetric = 0;
    a->planes = hf_aperture_coloured(image, stop) ? 3 : 1;
    a->headroom = 12;
    a->steps = STEPS;
    a->count = (hf_picture_number(key->largest) + STEPS / 2) / STEPS + 2;
    const size_t pictures = (size_t)(a->count * a->planes) * sizeof *a->picture;
    const size_t table = hf_integral_bytes(image);
    size_t taps = 0;
    for (int i = 0; i < a->count; i++) {
        const struct hf_picture p = frame_of(image, hf_picture_radius(i * STEPS), key->scale_x);
        taps += (size_t)p.rows * (size_t)p.columns * (size_t)a->planes;
    }
    const int err = hf_block_grow(&a->block, table + pictures + taps * sizeof *a->tap, mem);
    if (err) {
        a->count = 0;
        return err;
    }
    double *sum = a->block.data;
    a->picture = (struct hf_picture *)((char *)a->block.data + table);
    a->tap = (int16_t *)((char *)a->picture + pictures);
    int first = 0;
    for (int c = 0; c < a->planes; c++) {
        const struct hf_integral t = hf_integral_make(sum, image, c, stop);
        for (int i = 0; i < a->count; i++) {
            if (hf_stopped(stop)) {
                a->count = 0;
                return HF_ERR_CANCELLED;
            }
            struct hf_picture *p = &a->picture[c * a->count + i];
            const double r = hf_picture_radius(i * STEPS);
            *p = frame_of(image, r, key->scale_x);
            p->first = first;
            first += p->rows * p->columns;
            double area = draw(a, p, &t, r);
            if (area <= 0) {  // a black image: the pixel itself
                int16_t *tap = a->tap + p->first - (ptrdiff_t)p->top * p->columns + p->reach_x;
                tap[0] = 1;
                tap[1] = -1;
                area = 1;
            }
            p->area = (float)area;
        }
    }
    return HF_OK;
}
