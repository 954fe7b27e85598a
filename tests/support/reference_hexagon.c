// SPDX-License-Identifier: BSD-3-Clause
// The hexagon engine in double precision, from its description, pixel by pixel.
#include "support/reference_hexagon.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/reference_edges.h"
#include "support/seen.h"

static double clamp01(double v)
{
    return v < 0 ? 0 : v > 1 ? 1 : v;
}

static int clampi(int v, int n)
{
    return v < 0 ? 0 : v < n ? v : n - 1;
}

enum { MAX_TAPS = 16000 };

struct tap {
    int dx, dy;
    double b, before, part;
};

struct line {
    struct tap tap[MAX_TAPS];
    int count;
    double degrees, aspect;
};

// The distance of places: the line farthest from the axes has one on each column or row, unless the other lines' would
// be too far apart.
static double spacing(double degrees, double aspect)
{
    double most = 0, least = INFINITY;
    for (int i = 0; i < 3; i++) {
        const double angle = (degrees + 120 * i) * M_PI / 180, each = fmax(fabs(sin(angle)) / aspect, fabs(cos(angle)));
        most = fmax(most, 1 / each);
        least = fmin(least, 1 / each);
    }
    return fmin(most, 1.16 * least);
}

// The pixels around places along a direction, and the length of the line that each place stands for. nearer: at half
// resolution places lie that much nearer, except the pixel itself.
static void make_line(struct line *l, double degrees, double aspect, double reach, double step, double nearer)
{
    const double ux = sin(degrees * M_PI / 180), uy = -cos(degrees * M_PI / 180);
    l->count = 0;
    l->degrees = degrees;
    l->aspect = aspect;
    for (int k = 0; k == 0 || (k - 0.5) * step < reach + 1; k++) {
        const double t = k ? k * step - nearer : 0;
        const double x = floor(t * ux / aspect * 4096 + 0.5) / 4096, y = floor(t * uy * 4096 + 0.5) / 4096;
        for (int j = (int)floor(y); j <= (int)floor(y) + 1; j++)
            for (int i = (int)floor(x); i <= (int)floor(x) + 1; i++)
                l->tap[l->count++] = (struct tap){i, j, k ? step : step / 2, k ? (k - 0.5) * step : 0,
                                                  (1 - fabs(x - i)) * (1 - fabs(y - j))};
    }
}

struct field {
    int x0, y0, width, height, channels;  // position of its first pixel in the picture
    double *colour[4], *a, *q;
};

static double light_of(double r, double g, double b)
{
    return fabs(r + g + b);
}

static struct field field_new(int width, int height, int channels)
{
    struct field f = {.width = width, .height = height, .channels = channels};
    const size_t n = (size_t)width * (size_t)height;
    f.a = calloc(n, sizeof *f.a);
    f.q = calloc(n, sizeof *f.q);
    for (int c = 0; c < channels; c++)
        f.colour[c] = calloc(n, sizeof *f.a);
    return f;
}

// A frame of a field, extended by as much as lines reach, but at most by the frame's own size.
static struct field field_around(const struct field *in, int reach)
{
    const int x = reach < in->width ? reach : in->width, y = reach < in->height ? reach : in->height;
    struct field f = field_new(in->width + 2 * x, in->height + 2 * y, in->channels);
    f.x0 = -x;
    f.y0 = -y;
    return f;
}

static int at_of(const struct field *f, int x, int y)
{
    return clampi(y - f->y0, f->height) * f->width + clampi(x - f->x0, f->width);
}

static void field_free(struct field *f)
{
    for (int c = 0; c < f->channels; c++)
        free(f->colour[c]);
    free(f->a);
    free(f->q);
}

struct sum {
    double colour[4], a, w;
};

// How much a sample of radius q counts at a tap; p < 0: near, every sample counts.
static double count_of(const struct tap *t, double q, double p)
{
    double w = fmin(t->b, q - t->before);
    if (p > 0)
        w = fmin(w, t->b * (1 + (2 * p - q) / fmin(p, 1)));
    return fmax(w, 0) * t->part;
}

// Sum along a line at a pixel.
static struct sum sum_of(const struct field *f, const struct line *l, int x, int y, double p)
{
    struct sum s = {{0}, 0, 0};
    for (int i = 0; i < l->count; i++) {
        const struct tap *t = &l->tap[i];
        // Beyond the field there is nothing.
        const int u = x + t->dx - f->x0, v = y + t->dy - f->y0, at = at_of(f, x + t->dx, y + t->dy);
        const double q = u == clampi(u, f->width) && v == clampi(v, f->height) ? f->q[at] : 0;
        const double w = count_of(t, q, p);
        for (int c = 0; c < f->channels; c++)
            s.colour[c] += w * f->colour[c][at];
        s.a += w * f->a[at];
        if (w > 0)
            s.w += p > 0 ? w * light_of(f->colour[0][at], f->colour[1][at], f->colour[2][at]) / fmax(q, 0.25)
                         : w * f->a[at] * sqrt(fmax(q, 1));
    }
    return s;
}

static double own_of(double found, double p)
{
    return fmax(0, fmax((1 - found) * clamp01(2 - p), 0.25 - found));
}

static void put_near(struct field *out, const struct sum *s, int at)
{
    if (!(s->a > 0))
        return;
    out->q[at] = pow(s->w / s->a, 2);
    out->a[at] = s->a / out->q[at];
    for (int c = 0; c < out->channels; c++)
        out->colour[c][at] = s->colour[c] / out->q[at];
}

static void near_field(const struct field *in, const struct line l[3], struct field *out)
{
    struct field u = field_new(in->width, in->height, in->channels), b = field_new(in->width, in->height, in->channels);
    for (int at = 0; at < in->width * in->height; at++) {
        struct sum s = sum_of(in, &l[0], at % in->width, at / in->width, -1);
        const struct sum v = sum_of(in, &l[1], at % in->width, at / in->width, -1);
        put_near(&u, &s, at);
        for (int c = 0; c < in->channels; c++)
            s.colour[c] += v.colour[c];
        s.a += v.a;
        s.w += v.w;
        put_near(&b, &s, at);
    }
    for (int at = 0; at < in->width * in->height; at++) {
        const struct sum v = sum_of(&u, &l[1], at % in->width, at / in->width, -1);
        const struct sum w = sum_of(&b, &l[2], at % in->width, at / in->width, -1);
        for (int c = 0; c < in->channels; c++)
            out->colour[c][at] = (v.colour[c] + w.colour[c]) / 3;
        out->a[at] = (v.a + w.a) / 3;
    }
    field_free(&u);
    field_free(&b);
}

// Light over radius of a sample.
static double over_of(const struct field *f, int at)
{
    return light_of(f->colour[0][at], f->colour[1][at], f->colour[2][at]) / fmax(f->q[at], 0.25);
}

// Blur premultiplied colours at a far pixel of radius p: plain colours, the total weight found, and light over radii.
static struct sum far_blur(const struct field *in, const struct line *l, int x, int y, double p)
{
    struct sum s = sum_of(in, l, x, y, p);
    const int at = at_of(in, x, y);
    const double o = own_of(s.a, p);
    for (int c = 0; c < in->channels; c++)
        s.colour[c] = (s.colour[c] + o * in->colour[c][at] / in->a[at]) / (s.a + o);
    s.w = (s.w + o * over_of(in, at) / in->a[at]) / (s.a + o);
    s.a += o;
    return s;
}

static struct sum both(const struct sum *u, const struct sum *v)
{
    struct sum s = {.a = u->a + v->a, .w = u->w + v->w};
    for (int c = 0; c < 4; c++)
        s.colour[c] = u->colour[c] + v->colour[c];
    return s;
}

// whole: how much was found of a full weight.
static void put_far(struct field *out, const struct sum *s, double p, double part, double whole, int at)
{
    if (!(s->a > 0))
        return;
    out->q[at] = fmax(s->w > 0 ? light_of(s->colour[0], s->colour[1], s->colour[2]) / s->w : p, 0.25);
    out->a[at] = whole * part / fmax(out->q[at], 1);
    for (int c = 0; c < out->channels; c++)
        out->colour[c][at] = s->colour[c] * part / fmax(out->q[at], 1);
}

// Blur premultiplied colours beyond the frame; normalised only where more than a full weight was found.
static struct sum beyond_blur(const struct field *in, const struct line *l, int x, int y, double p)
{
    struct sum s = sum_of(in, l, x, y, p);
    const double all = fmax(s.a, 1);
    for (int c = 0; c < in->channels; c++)
        s.colour[c] /= all;
    s.a /= all;
    s.w /= all;
    return s;
}

// The part of a side of length p that lies within the frame.
static double along(double degrees, double aspect, int width, int height, double x, double y, double p)
{
    const double dx = p * sin(degrees * M_PI / 180) / aspect, dy = p * -cos(degrees * M_PI / 180);
    const double right = fmax(dx > 0 ? width - x : x, 1 / 1024.0), down = fmax(dy > 0 ? height - y : y, 1 / 1024.0);
    return fmin(1, fmin(right / fabs(dx), down / fabs(dy)));
}

// Scale what a line found by that part.
static void keep_within(struct sum *s, double part, int channels)
{
    for (int c = 0; c < channels; c++)
        s->colour[c] *= part;
    s->w *= part;
    s->a = part;
}

// What shines along a line: the sum of w m, m being light over radius, and that of w m ^ 2.
static void add_lit(const struct field *f, const struct line *l, int x, int y, double p, double lit[2])
{
    for (int i = 0; i < l->count; i++) {
        const struct tap *t = &l->tap[i];
        const int u = x + t->dx, v = y + t->dy, at = at_of(f, u, v);
        if (u - f->x0 != clampi(u - f->x0, f->width) || v - f->y0 != clampi(v - f->y0, f->height))
            continue;
        const double w = count_of(t, f->q[at], p), m = over_of(f, at);
        lit[0] += w * m;
        lit[1] += w * m * m;
    }
}

// Where all that shines is seen along less than a 256th of a pixel, bring the mean radius towards the pixel's own. bright: the
// least of that which is left.
static void fade_mean(struct field *out, const double lit[2], double p, double bright, int at)
{
    if (!(lit[1] > 0))
        return;
    const double sure = fmin(1, fmax(256 * lit[0] * lit[0] / lit[1], bright)), q = out->q[at];
    out->q[at] = fmax(q + (p - q) * (1 - sure), 0.25);
    const double a = fmax(q, 1) / fmax(out->q[at], 1);
    out->a[at] *= a;
    for (int c = 0; c < out->channels; c++)
        out->colour[c][at] *= a;
}

// Pass 1 at a pixel in the frame, or beyond it with the radius of the frame's nearest pixel.
static void far_first(const struct field *in, const struct line l[3], int x, int y, struct field *u, struct field *b)
{
    const int nearest = at_of(in, x, y), to = at_of(u, x, y);
    const int inside = x == clampi(x, in->width) && y == clampi(y, in->height);
    const double p = in->q[nearest], part = in->a[nearest] * fmax(p, 1);
    if (!(p > 0))
        return;
    struct sum up = (inside ? far_blur : beyond_blur)(in, &l[0], x, y, p);
    struct sum left = (inside ? far_blur : beyond_blur)(in, &l[1], x, y, p);
    if (inside) {
        keep_within(&up, along(l[0].degrees, l[0].aspect, in->width, in->height, x + 0.5, y + 0.5, p), in->channels);
        keep_within(&left, along(l[1].degrees, l[1].aspect, in->width, in->height, x + 0.5, y + 0.5, p), in->channels);
    }
    const struct sum sum = both(&up, &left);
    put_far(u, &up, p, part, up.a, to);
    put_far(b, &sum, p, part, sum.a / 2, to);
    // The pixel itself is dark beside what it finds.
    const double bright = 65536 * over_of(in, nearest) / sum.w;
    double lit[2] = {0, 0};
    if (!(bright < 1))
        return;
    add_lit(in, &l[0], x, y, p, lit);
    fade_mean(u, lit, p, bright, to);
    add_lit(in, &l[1], x, y, p, lit);
    fade_mean(b, lit, p, bright, to);
}

static void far_field(const struct field *in, const struct line l[3], int reach, struct field *out)
{
    struct field u = field_around(in, reach), b = field_around(in, reach);
    for (int y = u.y0; y < u.y0 + u.height; y++)
        for (int x = u.x0; x < u.x0 + u.width; x++)
            far_first(in, l, x, y, &u, &b);
    for (int at = 0; at < in->width * in->height; at++) {
        const double p = in->q[at];
        if (!(p > 0))
            continue;
        const int x = at % in->width, y = at / in->width;
        const struct sum left = far_blur(&u, &l[1], x, y, p), right = far_blur(&b, &l[2], x, y, p);
        for (int c = 0; c < in->channels; c++)
            out->colour[c][at] = (left.colour[c] + right.colour[c]) / 3;
    }
    field_free(&u);
    field_free(&b);
}

// The blurred part of a pixel: its size, colours times that, and its radius.
struct sample {
    double colour[4], whole, q;
};

static double nearer_to_0(double a, double b)
{
    return a * b <= 0 ? 0 : fabs(a) < fabs(b) ? a : b;
}

// For a mixed pixel with a sharp front, the back.
static struct sample sample_of(const struct picture *c, const float *r, int at, int half)
{
    struct sample s = {.whole = 1, .q = r[at]};
    for (int k = 0; k < c->channels; k++)
        s.colour[k] = c->plane[k][at];
    if (half)
        return s;
    const struct edge_reference e = edge_reference(c, r, 0x1p-40, at % c->width, at / c->width);
    const double front = e.radius[0], back = e.radius[1];
    if (!(e.share > 0) && front == r[at])
        return s;
    const double sharp = clamp01(2 - (front > 0 ? front : -2 * front));
    // Where less than 1 / 256 of the front is seen, the pixel becomes its back.
    const double shown = clamp01(256 * (1 - e.share));
    const double share = e.share > 0 ? shown * e.share * sharp * clamp01(back - 2 * fabs(front)) : 0;
    double by_light = r[at];
    if (front > 0) {
        const double lf = (1 - e.share) * light_of(e.colour[0][0], e.colour[0][1], e.colour[0][2]);
        const double lb = e.share > 0 ? e.share * light_of(e.colour[1][0], e.colour[1][1], e.colour[1][2]) : 0;
        by_light = lf + lb > 0 ? front + (lb > 0 ? lb / (lf + lb) * (back - front) : 0) : r[at];
    }
    const double both = by_light + sharp * (front - by_light), base = shown < 1 ? back + shown * (both - back) : both;
    const double least = fmax(share, 1 / 32.0);
    s.whole = 1 + (least - 1) * clamp01(32 * share);
    s.q = share > 1 / 32.0 ? base + (back - base) * clamp01(32 * share - 1) : base;
    for (int k = 0; k < c->channels; k++) {
        const double own = s.colour[k], to_back = share > 0 ? s.whole * (e.colour[1][k] - own) : 0;
        s.colour[k] = s.whole * own + nearer_to_0(to_back, (1 - s.whole) * (own - e.colour[0][k]));
    }
    return s;
}

static void load_full(const struct picture *colour, const struct sample *from, struct field *f, int sign)
{
    for (int at = 0; at < f->width * f->height; at++) {
        f->q[at] = sign * from[at].q;
        f->a[at] = from[at].whole / fmax(fabs(f->q[at]), 1);
        for (int c = 0; c < colour->channels; c++)
            f->colour[c][at] = from[at].colour[c] / fmax(fabs(f->q[at]), 1);
    }
}

static void load_half(const struct picture *colour, const struct sample *sample, struct field *f, int sign)
{
    for (int at = 0; at < f->width * f->height; at++) {
        double sum = 0, q = 0, mean[4] = {0};
        for (int i = 0; i < 4; i++) {
            const int x = clampi(at % f->width * 2 + i % 2, colour->width);
            const int y = clampi(at / f->width * 2 + i / 2, colour->height), from = y * colour->width + x;
            const double m = fmax(sign * sample[from].q, 0), w = fmin(2 * m, 1);
            sum += w;
            q += w * m;
            for (int c = 0; c < f->channels; c++)
                mean[c] += w * colour->plane[c][from];
        }
        f->q[at] = sum > 0 ? q / sum / 2 : 0;
        f->a[at] = sum / 4 / fmax(f->q[at], 1);
        for (int c = 0; c < f->channels; c++)
            f->colour[c][at] = mean[c] / 4 / fmax(f->q[at], 1);
    }
}

// Premultiplied near field with its coverage, and far field, at a full-resolution pixel.
static double fields_at(const struct field *near, const struct field *far, const struct field *far_in, int half, int x,
                        int y, double near_out[4], double far_out[4])
{
    double coverage = 0, sum = 0;
    memset(near_out, 0, 4 * sizeof *near_out);
    memset(far_out, 0, 4 * sizeof *far_out);
    for (int i = 0; i < (half ? 4 : 1); i++) {
        const int u0 = i % 2 ? x / 2 + (x % 2 ? 1 : -1) : x / 2, v0 = i / 2 ? y / 2 + (y % 2 ? 1 : -1) : y / 2;
        const int u = half ? clampi(u0, near->width) : x, v = half ? clampi(v0, near->height) : y;
        const double w = half ? (i % 2 ? 0.25 : 0.75) * (i / 2 ? 0.25 : 0.75) : 1;
        const int at = v * near->width + u;
        const double wf = !half ? 1 : u == u0 && v == v0 ? w * clamp01(far_in->q[at]) : 0;
        coverage += w * near->a[at];
        sum += wf;
        for (int c = 0; c < near->channels; c++) {
            near_out[c] += w * near->colour[c][at];
            far_out[c] += wf * far->colour[c][at];
        }
    }
    for (int c = 0; c < near->channels && sum > 0; c++)
        far_out[c] /= sum;
    return coverage;
}

// What is visible around near pixels: colours times weight, and the weight.
static struct seen seen_of(const struct picture *c, const struct sample *from, const struct field *near, int half)
{
    const int n = c->channels, width = (c->width + 1) / 2, height = (c->height + 1) / 2;
    struct seen s = seen_new(width, height, n + 1);
    for (int i = 0; i < (half ? width * height : c->width * c->height); i++) {
        double *most = seen_at(&s, n + 1, half ? i % width : i % c->width / 2, half ? i / width : i / c->width / 2);
        *most = fmax(*most, half ? 2 * near->q[i] : fmax(0, -from[i].q));
    }
    for (int i = 0; i < 4 * width * height; i++) {
        const int px = i % (2 * width), py = i / (2 * width), x = px / 2, y = py / 2;
        const int at = clampi(py, c->height) * c->width + clampi(px, c->width);
        const double r = from[at].q;
        double part = clamp01(1.5 + r);
        if (!half)
            part = at != py * c->width + px || px >= c->width ? 0 : r < 0 ? seen_part(r, seen_widest(&s, x, y)) : 1;
        for (int k = 0; k < n; k++)
            *seen_at(&s, k, x, y) += part * from[at].colour[k] / 4;
        *seen_at(&s, n, x, y) += part * from[at].whole / 4;
    }
    for (int i = 0; half && i < width * height; i++) {
        const double q = near->q[i], p = -2 * q;
        const double more = (seen_part(p, seen_widest(&s, i % width, i / width)) - clamp01(1.5 + p)) * fmax(q, 1);
        for (int k = 0; k < n; k++)
            *seen_at(&s, k, i % width, i / width) += more * near->colour[k][i];
        *seen_at(&s, n, i % width, i / width) += more * near->a[i];
    }
    return seen_around(s);
}

// Beyond the frame quads repeat its edge, at half resolution.
static double behind_sample(const struct seen *s, int p, int x, int y, int half)
{
    double v = 0;
    for (int k = 0; k < 4 && half; k++)
        v += (k & 1 ? 0.25 : 0.75) * (k & 2 ? 0.25 : 0.75) *
             *seen_at(s, p, clampi(x / 2 + (k & 1 ? (x & 1 ? 1 : -1) : 0), s->width),
                      clampi(y / 2 + (k & 2 ? (y & 1 ? 1 : -1) : 0), s->height));
    return half ? v : seen_sample(s, p, x, y);
}

// The sum that two blurs find of a near field that covers the whole frame, by Simpson's rule along the second.
static double most_coverage(const struct picture *c, const struct hf_params *par, int x, int y, double p)
{
    const double turn = par->aperture.rotation, aspect = par->view.pixel_aspect,
                 side[3] = {turn, turn + 240, turn + 120};
    double sum = 0;
    for (int k = 0; k < 9; k++) {
        // First up, then down left; first up, then down right; first down left, then down right.
        const double second = side[k / 3 == 0 ? 1 : 2], first = side[k / 3 == 2];
        const double d = along(second, aspect, c->width, c->height, x + 0.5, y + 0.5, p), t = d * p * (k % 3) / 2;
        const double u = x + 0.5 + t * sin(second * M_PI / 180) / aspect, v = y + 0.5 - t * cos(second * M_PI / 180);
        sum += d * (k % 3 == 1 ? 4 : 1) / 6 * along(first, aspect, c->width, c->height, u, v, p);
    }
    return sum / 3;
}

struct picture hexagon_reference(const struct picture *colour, const struct picture *r, const struct hf_params *p)
{
    static struct line l[3];
    const int half = p->hexagon.resolution == HF_RESOLUTION_HALF, n = colour->channels;
    const int w = half ? (colour->width + 1) / 2 : colour->width, h = half ? (colour->height + 1) / 2 : colour->height;
    double reach = 0;
    for (int i = 0; i < r->width * r->height; i++)
        reach = worse(reach, fabs((double)r->plane[0][i]));
    const double step = spacing(p->aperture.rotation, p->view.pixel_aspect);
    for (int i = 0; i < 3; i++)
        make_line(&l[i],
                  p->aperture.rotation + (i == 0   ? 0
                                          : i == 1 ? 240
                                                   : 120),
                  p->view.pixel_aspect, reach, step, half ? 0.05 : 0);
    struct sample *sample = calloc((size_t)(colour->width * colour->height), sizeof *sample);
    for (int i = 0; i < colour->width * colour->height; i++)
        sample[i] = sample_of(colour, r->plane[0], i, half);
    struct field near_in = field_new(w, h, n), far_in = field_new(w, h, n);
    struct field near = field_new(w, h, n), far = field_new(w, h, n);
    (half ? load_half : load_full)(colour, sample, &near_in, -1);
    (half ? load_half : load_full)(colour, sample, &far_in, 1);
    near_field(&near_in, l, &near);
    far_field(&far_in, l, (int)(reach / fmin(p->view.pixel_aspect, 1)) + 4, &far);
    struct picture out = picture_new(colour->width, colour->height, n);
    struct seen seen = seen_of(colour, sample, &near_in, half);
    for (int i = 0; i < out.width * out.height; i++) {
        double nc[4], fc[4];
        const int x = i % out.width, y = i / out.width;
        const double q = sample[i].q, some = behind_sample(&seen, n, x, y, half);
        const double cover = fields_at(&near, &far, &far_in, half, x, y, nc, fc);
        const double part = q < 0 ? most_coverage(&out, p, x, y, -q) : 1;
        const double left = fmax(0, part - cover);
        for (int c = 0; c < n; c++) {
            double b = colour->plane[c][i];
            if (q > 0)
                b += half ? clamp01(q / 2) * (fc[c] - b) : sample[i].whole * fc[c] - sample[i].colour[c];
            if (q < 0 && cover > 0) {
                const double front = nc[c] / cover;
                const double back = some > 0 ? behind_sample(&seen, c, x, y, half) / some : 0;
                const double seen_part = some * some, nothing = 6e-5 * 6e-5;
                const double other = (seen_part * back + nothing * front) / (seen_part + nothing);
                b = other + clamp01(2 + q) * (b - other);
            }
            out.plane[c][i] = (float)(cover == 0 ? b : (nc[c] + left * b) / (cover + left));
        }
    }
    free(sample);
    seen_free(&seen);
    field_free(&near_in);
    field_free(&far_in);
    field_free(&near);
    field_free(&far);
    return out;
}
