// SPDX-License-Identifier: BSD-3-Clause
// Mixed pixels of a sharp front before a far back (pixel/edges.h). Only the back is blurred, by its share, and the
// composite replaces it by what the far field shows there. So the front smears over nothing, and its edge stays smooth.
#include "engine/hexagon/kernels.h"
#include "pixel/edges.h"

// Fronts with radii up to this count as sharp, and a pixel above it not at all.
#define SHARP 1.0f
// From this share on, the sample has the back's radius. No sample weighs less than half of it, because colours are
// divided by weights.
#define ALL (1 / 16.0f)

static struct hf_sides sides_of(const struct hf_frame *f)
{
    struct hf_sides s = {.radius = {hf_line(f, 12), hf_line(f, 22)}, .share = hf_line(f, 23)};
    for (int c = 0; c < 4; c++) {
        s.colour[0][c] = hf_line(f, 8 + c);
        s.colour[1][c] = hf_line(f, 18 + c);
    }
    return s;
}

// The number nearer to 0, or 0 if the two have different signs.
static float nearest(float a, float b)
{
    const float low = a < b ? a : b, high = a > b ? a : b;
    return low > 0 ? low : high < 0 ? high : 0;
}

// The radius of a mixed pixel whose sides are both far: their mean by light. At a light's edge before a dark wall that
// is the light's radius.
static float by_light(const struct hf_sides *s, int x, float own)
{
    float light[2] = {0, 0};
    for (int k = 0; k < 2; k++)
        if (k == 0 || s->share[x] > 0)
            light[k] = (k ? s->share[x] : 1 - s->share[x]) * hf_hexagon_light(s->colour[k][0][x] * HEXAGON_SCALE,
                                                                              s->colour[k][1][x] * HEXAGON_SCALE,
                                                                              s->colour[k][2][x] * HEXAGON_SCALE);
    const float sum = light[0] + light[1];
    if (!(sum > 0))
        return own;
    return light[1] > 0 ? hf_lerp(s->radius[0][x], s->radius[1][x], light[1] / sum) : s->radius[0][x];
}

// Split a pixel into a blurred part with a weight, and a rest that composite.c shows as it is. They sum to the pixel,
// and neither has a colour outside the range of the pixel's own and its sides'. The smaller the back's share, the
// closer the sample lies, so that nothing jumps where an edge comes or goes.
static void take(const struct hf_sides *s, int channels, int x, float *const colour[4], float *radius, float *whole)
{
    const float own = *radius, front = s->radius[0][x], back = s->radius[1][x];
    const float size = front > 0 ? front : 2 * -front, sharp = hf_saturate(SHARP + 1 - size);
    // A front that shows less than noise fades, and the pixel becomes its back: the radius of no front means nothing.
    const float shown = hf_saturate((1 - s->share[x]) * (1 / HF_EDGES_NOISE));
    const float share =
        s->share[x] > 0 ? s->share[x] * (sharp * hf_saturate(back - 2 * (front > 0 ? front : -front))) * shown : 0;
    const float t = hf_saturate(share * (2 / ALL)), u = hf_saturate(share * (2 / ALL) - 1);
    const float both = hf_lerp(front > 0 ? by_light(s, x, own) : own, front, sharp),
                base = shown < 1 ? hf_lerp(back, both, shown) : both;
    const float least = share > ALL / 2 ? share : ALL / 2, w = hf_lerp(1, least, t);
    *radius = u > 0 ? hf_lerp(base, back, u) : base;
    *whole = w;
    for (int c = 0; c < channels; c++) {
        const float v = w * colour[c][x], beside = colour[c][x] - v;
        const float most = share > 0 ? w * s->colour[1][c][x] - v : 0, rest = beside - (1 - w) * s->colour[0][c][x];
        colour[c][x] = v + nearest(most, rest);
    }
}

static void take_row(const struct hf_frame *f, const struct hf_sides *s, int n, float *const colour[4], float *radius,
                     float *whole)
{
    for (int x = 0; x < n; x++) {
        whole[x] = 1;
        if (s->share[x] > 0 || s->radius[0][x] != radius[x])
            take(s, f->s->channels, x, colour, radius + x, whole + x);
    }
}

const float *hf_hexagon_row(struct hf_edges *e, const struct hf_frame *f, int y, struct hf_rect r,
                            float *const colour[4], float *radius)
{
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, f->s->width) - x0;
    const struct hf_sides s = sides_of(f);
    const int some = e && hf_edges_row(e, y, &s);
    hf_read_pixels(f, r.x0, y, r.x1 - r.x0, colour, f->seen);
    f->k->radius_row(f, x0, y, n, radius, NULL);
    if (!some)
        return NULL;
    take_row(f, &s, n, colour, radius, hf_line(f, 24));
    return hf_line(f, 24);
}

void hf_hexagon_load_rows(const struct hf_frame *f, struct hf_rect r, hf_hexagon_load_row *row)
{
    const struct hf_rect p = hf_hexagon_rect(f->s, r);
    const int mixed = hf_hexagon(f->s)->mixed;
    struct hf_edges e;
    if (mixed)
        hf_edges_start(&e, f, r, f->work);
    for (int y = p.y0; y < p.y1 && !hf_stopped(f->s->stop); y++)
        row(f, y, r, mixed ? &e : NULL);
}
