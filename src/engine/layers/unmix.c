// SPDX-License-Identifier: BSD-3-Clause
// Un-mixing. The colour of an anti-aliased edge is a mixture of two surfaces, while its depth is that of one. Each
// surface becomes a sample of its own, so that neither is blurred with the other's radius.
//
// Un-mixing fades in: a pixel is the more mixed the more the radii around it differ, and a radius midway between front
// and back belongs to both. So a small change of focus or lens changes the picture little.
#include "engine/layers/unmix.h"

#include <math.h>

#include "pixel/edges.h"
#include "pixel/pass_c.h"

const float hf_unmix_weights[7][7] = {
#define W(x, y) (x) || (y) ? 1.0f / (((x) * (x) + (y) * (y)) * ((x) * (x) + (y) * (y))) : 0
#define ROW(y)                                                                                                         \
    {                                                                                                                  \
        W(-3, y), W(-2, y), W(-1, y), W(0, y), W(1, y), W(2, y), W(3, y)                                               \
    }
    ROW(-3), ROW(-2), ROW(-1), ROW(0),
    ROW(1),  ROW(2),  ROW(3)
#undef ROW
#undef W
};

enum { SIDE = 5 };  // pixels each way

// An eighth of a colour's brightness, which is finite even for the largest samples.
static float eighth_light(float red, float green, float blue)
{
    return (fabsf(red) + fabsf(green) + fabsf(blue)) * 0.125f;
}

static float light_of(const struct hf_unmix_row *u, int y, int x)
{
    return eighth_light(u->colour[y][0][x], u->colour[y][1][x], u->colour[y][2][x]);
}

// The mean of those of 5 x 5 pixels that are on one side, weighted by the eighth power of their distance in colour from
// `other`. That is nearly the farthest pixel alone; but where two are equally far, a moving picture does not jump from
// one to the other. A pixel's distance counts by its share of the side. Otherwise one that barely belongs to it, by the last
// bit of a radius, would outweigh those that do. In a front, samples far brighter than the mixed pixel are dimmed (PLAIN): a
// lamp is the farthest from any other colour. A back is a lamp more often.
static void farthest(const struct hf_unmix_row *u, int x, int front, const float *other, float *colour, float *radius)
{
    const float plain = light_of(u, 3, x) * HF_UNMIX_PLAIN;
    float share[SIDE * SIDE], distance[SIDE * SIDE], most = 0, sum = 0;
    int pixel[SIDE * SIDE], count = 0;
    for (int k = 0; k < SIDE * SIDE; k++) {
        const int y = 1 + k / SIDE, i = x - 2 + k % SIDE;
        const float of_front = hf_edges_front(u->middle[x], u->slope[x], u->radius[y][i]);
        share[count] = front ? of_front * hf_layers_dimmed(light_of(u, y, i), plain) : 1 - of_front;
        pixel[count] = k;
        count += share[count] > 0;  // mostly few pixels
    }
    for (int j = 0; j < count; j++) {
        const int y = 1 + pixel[j] / SIDE, i = x - 2 + pixel[j] % SIDE;
        float d = 0;
        for (int c = 0; c < u->channels; c++)
            d = d + fabsf(u->colour[y][c][i] - other[c]) * 0.125f;  // finite even for the largest samples
        distance[j] = share[j] * d;
        most = distance[j] > most ? distance[j] : most;
    }
    for (int j = 0; j < count; j++) {
        const int y = 1 + pixel[j] / SIDE, i = x - 2 + pixel[j] % SIDE;
        const float far = most > 0 ? distance[j] / most : 1, square = far * far;
        const float w = share[j] * ((square * square) * (square * square)) * 0.03125f;  // sums of 25 are finite
        if (!(w > 0))
            continue;
        sum = sum + w;
        *radius = *radius + w * u->radius[y][i];
        for (int c = 0; c < u->channels; c++)
            colour[c] = colour[c] + w * u->colour[y][c][i];
    }
    *radius = sum > 0 ? *radius / sum : 0;
    for (int c = 0; c < u->channels; c++)
        colour[c] = sum > 0 ? colour[c] / sum : 0;
}

int hf_unmix_complete(const struct hf_unmix_row *u, int x, float weight[2], float mean[2][5], float spread[2])
{
    if (weight[0] == 0 && weight[1] == 0)
        return 0;
    const int side = weight[0] < weight[1] ? 0 : 1;
    const float little = HF_UNMIX_LEAN * (weight[0] + weight[1]);
    float colour[4] = {0}, radius = 0;
    if (!(weight[side] < little))
        return 1;
    const float known = weight[side] / little;
    float apart = 0;
    farthest(u, x, !side, mean[!side], colour, &radius);
    for (int c = 0; c < u->channels; c++) {
        const float d = mean[side][c] - colour[c];
        apart = apart + d * d;
        mean[side][c] = known > 0 ? colour[c] + known * d : colour[c];
    }
    spread[side] = known * (spread[side] + (1 - known) * HF_UNMIX_DOUBT * apart);
    mean[side][4] = known > 0 ? radius + known * (mean[side][4] - radius) : radius;
    return 1;
}

static void keep(const struct hf_unmix_row *u, int x)
{
    for (int c = 0; c < u->channels; c++)
        u->seen[c][x] = u->colour[3][c][x];
    u->seen[4][x] = 1;
    u->mixed[4][x] = 0;
    u->seen[5][x] = u->radius[3][x];
}

// The front's share of the pixel, given the means of both sides and the variances of their colours. Where the colours
// of the pixel's own surface vary too much to tell, it is the share by depth, a0. behind: how much of the front's part of what
// neither mean explains is the back's.
static float share(const struct hf_unmix_row *u, int x, float a0, const float *f, const float *b, const float *spread,
                   float *behind)
{
    float along = 0, apart = 0, size = 0, off = 0;
    for (int c = 0; c < u->channels; c++) {
        const float d = f[c] - b[c];
        along = along + (u->colour[3][c][x] - b[c]) * d;
        apart = apart + d * d;
        size = size + (f[c] * f[c] + b[c] * b[c]);
    }
    const float own = a0 * a0 * spread[0] + (1 - a0) * (1 - a0) * spread[1];
    const float es = HF_UNMIX_SPREAD * own + 1e-3f * size;
    float a = (along + es * a0) / (apart + es);
    a = a > 0 ? a < 1 ? a : 1 : a <= 0 ? 0 : a0;
    for (int c = 0; c < u->channels; c++) {
        const float rest = u->colour[3][c][x] - a * f[c] - (1 - a) * b[c];
        off = off + rest * rest;
    }
    const float trust = apart / (apart + off);
    a = trust >= 0 ? a0 + (a - a0) * trust : a0;
    *behind = apart > 0 ? hf_saturate(off / apart * HF_UNMIX_UNEXPLAINED) *
                              hf_saturate(apart / size * HF_UNMIX_ALIKE - 1) * ((1 - a0) * HF_UNMIX_HALF)
                        : 0;
    return a < 1 - *behind ? a : 1 - *behind;
}

// Turn the sums of a side into its mean. Returns the variance of its colours.
static float finish(int channels, float counted, float squares, float *mean)
{
    float square = 0;
    for (int c = 0; c < 5; c++)
        mean[c] = counted > 0 ? mean[c] / counted : 0;
    for (int c = 0; c < channels; c++)
        square = square + mean[c] * mean[c];
    const float spread = (counted > 0 ? squares / counted : 0) - square;
    return spread > 0 ? spread : 0;
}

float hf_unmix_lamp(const struct hf_unmix_row *u, int x, float most, float alpha)
{
    const float own = light_of(u, 3, x), least = most > 1e-30f ? most : 1e-30f;
    const float over = own - most, scale = 4 / (over > 1e-30f ? over : 1e-30f);
    float count = 0;
    for (int i = 0; i < 49; i++)
        count = count + hf_saturate((light_of(u, i / 7, x + i % 7 - 3) - most) * scale - 1);
    const float lamp = hf_saturate((own / least - HF_UNMIX_LAMP) * 2) * hf_saturate(HF_UNMIX_PIXELS - count);
    if (u->channels < 4)
        return lamp;
    return lamp * hf_saturate((HF_UNMIX_LAMP - u->colour[3][3][x] / (alpha > 1e-30f ? alpha : 1e-30f)) * 4);
}

// How far the pixel shows a lamp behind the edge, 0 to 1.
static float lit(const struct hf_unmix_row *u, int x, float mean[2][5])
{
    const float front = eighth_light(mean[0][0], mean[0][1], mean[0][2]),
                back = eighth_light(mean[1][0], mean[1][1], mean[1][2]);
    const float most = front > back ? front : back, wider = fabsf(mean[1][4]) - fabsf(mean[0][4]);
    const float alpha = mean[0][3] > mean[1][3] ? mean[0][3] : mean[1][3];
    return light_of(u, 3, x) > most * HF_UNMIX_LAMP && wider > 0 ? hf_saturate(wider) * hf_unmix_lamp(u, x, most, alpha)
                                                                 : 0;
}

// The means and variances of the two sides. mixed: what a mixed pixel counts where a sure one counts 1.
static void sides(const struct hf_unmix_row *u, int x, float mixed, float weight[2], float mean[2][5], float spread[2])
{
    const float plain = light_of(u, 3, x) * HF_UNMIX_PLAIN;
    float counted[2] = {0};
    for (int side = 0; side < 2; side++) {
        weight[side] = spread[side] = 0;
        for (int c = 0; c < 5; c++)
            mean[side][c] = 0;
    }
    for (int y = 0; y < 7; y++)
        for (int i = 0; i < 7; i++) {
            const int at = x + i - 3;
            if (y == 3 && i == 3)
                continue;
            const float sure = u->sure[y][at], w = (sure * sure + mixed) * hf_unmix_weights[y][i];
            const float front = w * hf_edges_front(u->middle[x], u->slope[x], u->radius[y][at]);
            const float of[2] = {front, w - front}, counts = hf_layers_dimmed(light_of(u, y, at), plain);
            float square = 0;
            for (int c = 0; c < u->channels; c++)
                square = square + u->colour[y][c][at] * u->colour[y][c][at];
            for (int side = 0; side < 2; side++) {
                const float g = of[side] * counts;
                weight[side] += of[side];
                counted[side] += g;
                spread[side] = spread[side] + g * square;
                for (int c = 0; c < u->channels; c++)
                    mean[side][c] = mean[side][c] + g * u->colour[y][c][at];
                mean[side][4] = mean[side][4] + g * u->radius[y][at];
            }
        }
    for (int side = 0; side < 2; side++)
        spread[side] = finish(u->channels, counted[side], spread[side], mean[side]);
}

// In a thicket no sure pixel says what the front's colour is, so a lamp behind it would pass for the front wherever the depth
// sample is the front's. Where the pixel is far brighter than the dark pixels of both sides, the means become those of a lamp:
// the front's is that of its dark pixels, the back's that of its brightest ones. They do so as far as the brightest pixels are
// the back's, and as far as this is a thicket (thick, 0 to 1).
static void lamp_in_thicket(const struct hf_unmix_row *u, int x, float thick, float mean[2][5], float spread[2])
{
    const float own = light_of(u, 3, x), plain = own * HF_UNMIX_DARK;
    float most = 0, least = own, dark[2] = {0}, light[2] = {0}, bright[2] = {0}, lamp[2][5] = {{0}};
    for (int i = 0; i < 49; i++) {
        const float v = light_of(u, i / 7, x + i % 7 - 3);
        most = v > most ? v : most;
        least = v < least ? v : least;
    }
    if (!(own > least * HF_UNMIX_TIMES))
        return;
    for (int i = 0; i < 49; i++) {
        const int y = i / 7, at = x + i % 7 - 3;
        const float v = light_of(u, y, at), far = v / most, square = far * far, fourth = square * square;
        const float front = hf_edges_front(u->middle[x], u->slope[x], u->radius[y][at]), back = 1 - front;
        const float few = 0.015625f * hf_unmix_weights[y][i % 7] * hf_layers_dimmed(v, plain);  // sums of 49 are finite
        const float brightest = 0.015625f * (fourth * fourth), w[2] = {few * front, brightest * back};
        dark[0] = dark[0] + w[0];
        dark[1] = dark[1] + few * back;
        light[0] = light[0] + w[0] * v;
        light[1] = light[1] + few * back * v;
        bright[0] = bright[0] + brightest * front;
        bright[1] = bright[1] + w[1];
        for (int side = 0; side < 2; side++) {
            for (int c = 0; c < u->channels; c++)
                lamp[side][c] = lamp[side][c] + w[side] * u->colour[y][c][at];
            lamp[side][4] = lamp[side][4] + w[side] * u->radius[y][at];
        }
    }
    if (!(dark[0] > 0) || !(bright[1] > 0))
        return;
    const float front = light[0] / dark[0], back = dark[1] > 0 ? light[1] / dark[1] : 0;
    const float larger = front > back ? front : back, floor = larger > 1e-30f ? larger : 1e-30f;
    const float by = hf_saturate((own / floor - HF_UNMIX_TIMES) * 0.5f) * (bright[1] / (bright[0] + bright[1])) *
                     hf_saturate(thick * 2);
    for (int side = 0; side < 2; side++) {
        spread[side] = spread[side] - by * spread[side];
        for (int c = 0; c < 5; c++) {
            const float v = lamp[side][c] / (side ? bright[1] : dark[0]);
            mean[side][c] = mean[side][c] + by * (v - mean[side][c]);
        }
    }
}

static void unmix_pixel(const struct hf_unmix_row *u, int x)
{
    float weight[2], mean[2][5], spread[2];
    const float own = u->radius[3][x], a0 = hf_edges_front(u->middle[x], u->slope[x], own);
    sides(u, x, 0, weight, mean, spread);
    const float unsure = 1 - hf_saturate((weight[0] + weight[1]) * (1 / HF_UNMIX_FAINT)), told = a0 + a0 - 1;
    const float thick = unsure * (told * told);
    if (thick > 0)
        sides(u, x, thick * HF_UNMIX_UNSURE, weight, mean, spread);
    if (!hf_unmix_complete(u, x, weight, mean, spread)) {
        keep(u, x);
        return;
    }
    const float known = hf_saturate((weight[0] + weight[1]) * (1 / HF_UNMIX_FAINT));
    if (thick > 0)
        lamp_in_thicket(u, x, thick, mean, spread);
    float behind;
    const float own_share = share(u, x, a0, mean[0], mean[1], spread, &behind), by = (1 - u->sure[3][x]) * known;
    const float lamp = lit(u, x, mean), less = own_share < HF_UNMIX_RIM ? own_share : HF_UNMIX_RIM;
    const float a = lamp * (less - own_share) + own_share;
    // The part of the pixel that is not un-mixed keeps its colour and goes with the front.
    const float seen = by * (a - 1) + 1, whole = seen > 0 ? (1 - by) / seen : 0;
    const float scale = a < 1 ? 1 + behind * (a / (1 - a)) : 1;  // at most 2
    for (int c = 0; c < u->channels; c++) {
        const float v = u->colour[3][c][x], rest = v - a * mean[0][c] - (1 - a) * mean[1][c];
        const float more = rest > 0 && c < 3 ? rest : 0;
        const float front = hf_edges_between(rest - lamp * more + mean[0][c], mean[0][c], v);
        u->seen[c][x] = whole * (v - front) + front;
        u->mixed[c][x] = hf_edges_between(mean[1][c] + rest * scale, mean[1][c], v);
    }
    const float front = (1 - a0) * (mean[0][4] - own) + own;
    u->seen[4][x] = seen;  // at most 1, and 1 where the other is 0: slices do not read the weights of such tiles
    u->mixed[4][x] = 1 - seen;
    u->seen[5][x] = whole * (own - front) + front;
    u->mixed[5][x] = a0 * (mean[1][4] - own) + own;
}

void hf_layers_unmix_c(const struct hf_unmix_row *u, int n)
{
    for (int x = 0; x < n; x++)
        if (!(u->sure[3][x] < 1))
            keep(u, x);
        else {
            u->any[x / 16] = 1;
            unmix_pixel(u, x);
        }
}

enum { AROUND = 16 };  // margin of a row of scratch, in floats

// What rings of 8 rows of scratch hold, one after the other: a row of the frame has its place in each. The last has bytes.
enum { SURE, MIDDLE, SLOPE, LIGHT, SQUARE, DONE };

// A row of scratch holds whole vectors, and one more on either side.
static ptrdiff_t stride_of(int width)
{
    return ((width + 15) & ~15) + 2 * AROUND;
}

// Floats that hold a byte for each vector of a row, however short.
static size_t done_floats(ptrdiff_t stride)
{
    return (size_t)stride / 4 / sizeof(float) + 1;
}

size_t hf_layers_unmix_floats(int width)
{
    const size_t stride = (size_t)stride_of(width);
    return (8 * (DONE * stride + done_floats((ptrdiff_t)stride)) + HF_PAD + 15) & ~(size_t)15;
}

// The place of row y in a ring.
static float *row_at(float *ring, ptrdiff_t stride, int which, int y)
{
    return ring + (8 * which + (y & 7)) * stride;
}

static uint8_t *done_at(float *ring, ptrdiff_t stride, int y)
{
    return (uint8_t *)(ring - AROUND + 8 * DONE * stride + (ptrdiff_t)done_floats(stride) * (y & 7));
}

// How surely each pixel of a row is not mixed (1: not mixed), into the row's place in the ring.
static void sure_row(const struct hf_frame *f, int x, int n, int y, float *ring, ptrdiff_t stride)
{
    const struct hf_buf *b = &f->buf[HF_LAYERS_BUF_RADIUS];
    const float *radius[3];
    memset(done_at(ring, stride, y), 0, done_floats(stride) * sizeof(float));
    for (int i = 0; i < 3; i++)
        radius[i] = hf_at(b, 0, x - AROUND, y + i - 1);
    // Widened to whole vectors; only three pixels on either side are read.
    f->k->edges.sure(radius, n + 2 * AROUND, row_at(ring, stride, SURE, y) - AROUND,
                     row_at(ring, stride, MIDDLE, y) - AROUND, row_at(ring, stride, SLOPE, y) - AROUND);
}

// Point u at row y of the frame, from column x on, and at the rows around it.
static void place_row(const struct hf_frame *f, int x, int y, float *ring, ptrdiff_t stride, struct hf_unmix_row *u)
{
    const struct hf_buf *radius = &f->buf[HF_LAYERS_BUF_RADIUS], *colour = &f->buf[HF_LAYERS_BUF_COLOUR];
    const float *first[5] = {NULL};
    first[4] = hf_at(radius, 0, x, y - 3);
    for (int c = 0; c < u->channels; c++)
        first[c] = hf_at(colour, c, x, y - 3);
    for (int i = 0; i < 7; i++) {
        u->radius[i] = first[4] + i * radius->stride;
        u->sure[i] = row_at(ring, stride, SURE, y + i - 3);
        u->light[i] = row_at(ring, stride, LIGHT, y + i - 3);
        u->square[i] = row_at(ring, stride, SQUARE, y + i - 3);
        u->done[i] = done_at(ring, stride, y + i - 3);
        for (int c = 0; c < u->channels; c++)
            u->colour[i][c] = first[c] + i * colour->stride;
    }
    u->middle = row_at(ring, stride, MIDDLE, y);
    u->slope = row_at(ring, stride, SLOPE, y);
    hf_row(&f->buf[HF_LAYERS_BUF_SEEN], u->channels, x, y, u->seen);
    hf_row(&f->buf[HF_LAYERS_BUF_MIXED], u->channels, x, y, u->mixed);
    for (int i = 0; i < 2; i++) {
        u->seen[4 + i] = hf_at(&f->buf[HF_LAYERS_BUF_SEEN_AT], i, x, y);
        u->mixed[4 + i] = hf_at(&f->buf[HF_LAYERS_BUF_MIXED_AT], i, x, y);
    }
}

void hf_layers_unmix_rows(const struct hf_frame *f, struct hf_rect r, int begin, uint8_t *any)
{
    const struct hf_layers *l = hf_layers(f->s);
    const int x = 2 * r.x0, n = hf_min(2 * r.x1, f->s->width) - x, y0 = 2 * r.y0, y1 = hf_min(2 * r.y1, f->s->height);
    struct hf_unmix_row u = {.channels = l->channels, .any = any};
    const ptrdiff_t stride = stride_of(n);
    float *ring = f->work + AROUND;
    for (int y = y0 - 3; begin && l->edges && y < y0 + 3; y++)
        sure_row(f, x, n, y, ring, stride);
    for (int i = 0; begin && !l->edges && i < 8 * stride; i++)
        f->work[i] = 1;
    for (int y = y0; y < y1 && !hf_stopped(f->s->stop); y++) {
        if (l->edges)
            sure_row(f, x, n, y + 3, ring, stride);
        place_row(f, x, y, ring, stride, &u);
        hf_layers_kernels(f)->unmix(&u, n);
    }
}
