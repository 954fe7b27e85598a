// SPDX-License-Identifier: BSD-3-Clause
// The samples of the reference: mixed pixels, highlights, hidden samples.
#include <string.h>

#include "support/layers_reference_parts.h"

static const double PI = 3.14159265358979323846;

// ---- mixed pixels ----

// How far 3 x 3 pixels are one surface; the middle of their radii; and how steeply front becomes back around it.
static double sure(const struct frame *f, int x, int y, double *middle, double *slope)
{
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < 9; i++) {
        const double r = radius_at(f, x + i % 3 - 1, y + i / 3 - 1);
        low = fmin(low, r);
        high = fmax(high, r);
    }
    *middle = (low + high) / 2;
    *slope = 2 / fmax(high - low, 0.75);
    return 1 - fmin(fmax((high - low - 0.75) * 2, 0), 1);
}

static double front_of(double r, double middle, double slope)
{
    return fmin(fmax((middle - r) * slope + 0.5, 0), 1);
}

// The weight of a sample of that brightness in a mean: less from `plain` on.
static double dimmed(double light, double plain)
{
    return light > plain ? pow(fmax(plain / light, 1.0 / 256), 4) : 1;
}

static double light_of(const struct frame *f, int x, int y)
{
    return fabs(colour_at(f, 0, x, y)) + fabs(colour_at(f, 1, x, y)) + fabs(colour_at(f, 2, x, y));
}

// Mean colour and radius of one side around a mixed pixel, and its colours' variance; returns its weight. Samples more
// than eight times as bright as the pixel count less.
static double side_mean(const struct frame *f, int x, int y, double middle, double slope, int front, double mean[5],
                        double *spread)
{
    const double own = 8 * light_of(f, x, y);
    double sum = 0, all = 0, squares = 0, unused;
    memset(mean, 0, 5 * sizeof *mean);
    for (int v = -3; v <= 3; v++)
        for (int u = -3; u <= 3; u++) {
            // Beyond the frame samples repeat its edge.
            const double s = front_of(radius_at(f, x + u, y + v), middle, slope), part = front ? s : 1 - s;
            if ((!u && !v) || part == 0)
                continue;
            const double known = part * pow(sure(f, x + u, y + v, &unused, &unused), 2) / pow(u * u + v * v, 2);
            const double w = known * dimmed(light_of(f, x + u, y + v), own);
            all += known;
            sum += w;
            for (int c = 0; c < f->channels; c++) {
                mean[c] += w * colour_at(f, c, x + u, y + v);
                squares += w * pow(colour_at(f, c, x + u, y + v), 2);
            }
            mean[4] += w * radius_at(f, x + u, y + v);
        }
    for (int c = 0; c < 5; c++)
        mean[c] = sum > 0 ? mean[c] / sum : 0;
    *spread = sum > 0 ? squares / sum : 0;
    for (int c = 0; c < f->channels; c++)
        *spread -= mean[c] * mean[c];
    *spread = fmax(*spread, 0);
    return all;
}

// The mean of a side, weighted by the eighth power of the difference of colours from `other` times its part. In a front,
// samples more than eight times as bright as the pixel count less.
static void side_farthest(const struct frame *f, int x, int y, double middle, double slope, int front,
                          const double other[5], double mean[5])
{
    double far[25], part[25], most = 0, sum = 0;
    for (int i = 0; i < 25; i++) {
        const int px = x + i % 5 - 2, py = y + i / 5 - 2;
        const double s = front_of(radius_at(f, px, py), middle, slope);
        part[i] = front ? s * dimmed(light_of(f, px, py), 8 * light_of(f, x, y)) : 1 - s;
        far[i] = 0;
        for (int c = 0; c < f->channels; c++)
            far[i] += part[i] * fabs(colour_at(f, c, px, py) - other[c]);
        most = part[i] > 0 ? fmax(most, far[i]) : most;
    }
    memset(mean, 0, 5 * sizeof *mean);
    for (int i = 0; i < 25; i++) {
        const double w = part[i] * (most > 0 ? pow(far[i] / most, 8) : 1);
        sum += w;
        for (int c = 0; c < f->channels; c++)
            mean[c] += w * colour_at(f, c, x + i % 5 - 2, y + i / 5 - 2);
        mean[4] += w * radius_at(f, x + i % 5 - 2, y + i / 5 - 2);
    }
    for (int c = 0; c < 5; c++)
        mean[c] = sum > 0 ? mean[c] / sum : 0;
}

// behind: how much of what neither mean explains is the back's alone, up to half, where its depth is the back's and the means
// differ. The front has no more than the rest.
static double share_of(const struct frame *f, int x, int y, double a0, const double *front, const double *back,
                       const double spread[2], double *behind)
{
    double along = 0, apart = 0, size = 0, off = 0;
    for (int c = 0; c < f->channels; c++) {
        along += (colour_at(f, c, x, y) - back[c]) * (front[c] - back[c]);
        apart += pow(front[c] - back[c], 2);
        size += front[c] * front[c] + back[c] * back[c];
    }
    const double depth = 1e-3 * size + 60 * (a0 * a0 * spread[0] + (1 - a0) * (1 - a0) * spread[1]);
    const double a = apart + depth > 0 ? fmin(fmax((along + depth * a0) / (apart + depth), 0), 1) : a0;
    for (int c = 0; c < f->channels; c++)
        off += pow(colour_at(f, c, x, y) - a * front[c] - (1 - a) * back[c], 2);
    const double trusted = a0 + (a - a0) * (apart + off > 0 ? apart / (apart + off) : 0);
    *behind = apart > 0 ? fmin(150 * off / apart, 1) * fmin(fmax(5 * apart / size - 1, 0), 1) * (1 - a0) / 2 : 0;
    return fmin(trusted, 1 - *behind);
}

// How far a mixed pixel belongs to a small lamp behind the edge: one and a half times to twice as bright as either
// side, with fewer than six to seven pixels that have a quarter to a half of its excess.
static double lamp_of(const struct frame *f, int x, int y, double mean[2][5])
{
    double most = 0, count = 0;
    const double own = light_of(f, x, y), wider = fabs(mean[1][4]) - fabs(mean[0][4]);
    for (int i = 0; i < 2; i++)
        most = fmax(most, fabs(mean[i][0]) + fabs(mean[i][1]) + fabs(mean[i][2]));
    if (own <= 1.5 * most || wider <= 0)
        return 0;
    for (int i = 0; i < 49; i++) {
        const double over = light_of(f, x + i % 7 - 3, y + i / 7 - 3) - most;
        count += fmin(fmax(4 * over / (own - most) - 1, 0), 1);
    }
    const double bright = most > 0 ? fmin(2 * (own / most - 1.5), 1) : 1;
    const double alpha = f->channels == 4 ? colour_at(f, 3, x, y) / fmax(mean[0][3], mean[1][3]) : 1;
    return bright * fmin(wider, 1) * fmin(fmax(7 - count, 0), 1) * fmin(fmax(4 * (1.5 - alpha), 0), 1);
}

static void unmix(struct frame *f, int x, int y)
{
    double *seen = at(&f->seen, x, y), *mixed = at(&f->mixed, x, y), middle, slope, mean[2][5], weight[2], far[5] = {0};
    double spread[2];
    for (int c = 0; c < f->channels; c++)
        seen[c] = colour_at(f, c, x, y);
    seen[WEIGHT] = 1;
    seen[RADIUS] = radius_at(f, x, y);
    const double apart = 1 - sure(f, x, y, &middle, &slope), own = radius_at(f, x, y);
    if (!f->unmix || apart == 0)
        return;
    for (int i = 0; i < 2; i++)
        weight[i] = side_mean(f, x, y, middle, slope, !i, mean[i], &spread[i]);
    if (weight[0] == 0 && weight[1] == 0)
        return;
    const int less = weight[0] < weight[1] ? 0 : 1;
    const double known = fmin(weight[less] / (0.08 * (weight[0] + weight[1])), 1);
    side_farthest(f, x, y, middle, slope, !less, mean[!less], far);
    double doubt = 0;
    for (int c = 0; c < f->channels; c++)
        doubt += pow(mean[less][c] - far[c], 2) * (1 - known) / 4096;
    for (int c = 0; c < 5 && known < 1; c++)
        mean[less][c] = known * mean[less][c] + (1 - known) * far[c];
    spread[less] = known * (spread[less] + doubt);
    const double a0 = front_of(own, middle, slope), lamp = lamp_of(f, x, y, mean);
    double behind;
    const double share = share_of(f, x, y, a0, mean[0], mean[1], spread, &behind),
                 a = share + lamp * (fmin(share, 0.75) - share);
    const double by = apart * fmin((weight[0] + weight[1]) / 0.25, 1);
    seen[WEIGHT] = 1 - by * (1 - a);
    mixed[WEIGHT] = by * (1 - a);
    const double whole = seen[WEIGHT] > 0 ? (1 - by) / seen[WEIGHT] : 0;
    const double scale = a < 1 ? 1 + behind * a / (1 - a) : 1;
    for (int c = 0; c < f->channels; c++) {
        const double v = colour_at(f, c, x, y), rest = v - a * mean[0][c] - (1 - a) * mean[1][c];
        const double moved = c < 3 ? lamp * fmax(rest, 0) : 0;
        const double front = fmin(fmax(mean[0][c] + rest - moved, fmin(mean[0][c], v)), fmax(mean[0][c], v));
        seen[c] = whole * v + (1 - whole) * front;
        mixed[c] = fmin(fmax(mean[1][c] + rest * scale, fmin(mean[1][c], v)), fmax(mean[1][c], v));
    }
    seen[RADIUS] = whole * own + (1 - whole) * (a0 * own + (1 - a0) * mean[0][4]);
    mixed[RADIUS] = a0 * mean[1][4] + (1 - a0) * own;
}

// ---- highlights ----

static double root(double v)
{
    return v > 0 ? sqrt(v) : v < 0 ? -sqrt(-v) : 0;
}

// The root of a pixel's brightness, for that many channels.
static double bright_root(const struct frame *f, int from, int to, int x, int y)
{
    double sum = 0;
    for (int c = from; c < to; c++)
        sum += colour_at(f, c, x, y);
    return root(fmax(sum, 0));
}

// The mean of that of the 18 x 18 pixels around the quad of (x, y).
static double bright_mean(const struct frame *f, int from, int to, int x, int y)
{
    double mean = 0;
    for (int v = -8; v < 10; v++)
        for (int u = -8; u < 10; u++)
            mean += bright_root(f, from, to, x + u, y + v) / (18 * 18);
    return mean;
}

// How much of a sample's light is no highlight.
static double plain_part(const struct frame *f, const double *s, int x, int y)
{
    static const int side[5][2] = {{0, 0}, {-18, 0}, {18, 0}, {0, -18}, {0, 18}};
    double mean = INFINITY, light = s[0] + s[1] + s[2];
    for (int i = 0; i < 5; i++) {
        const int px = (x & ~1) + side[i][0], py = (y & ~1) + side[i][1];
        const double open = f->channels == 4 ? fmax(1 - bright_mean(f, 3, 4, px, py), 0) : 0;
        mean = fmin(mean, (i ? 3 : 1) * bright_mean(f, 0, 3, px, py) + open * root(fmax(light, 0)));
    }
    const double cap = mean * mean * (2 + 0.001 * PI * s[RADIUS] * s[RADIUS]);
    return fabs(s[RADIUS]) > 4 && light > cap ? cap / light : 1;
}

// Of a mixed pixel's samples that with more light above its cap is shown, less what the other one has. From here on that is
// `seen`, whether it is in front or not. What is behind counts from four times its cap on.
static void highlight(struct frame *f, int x, int y)
{
    double *s[2] = {at(&f->seen, x, y), at(&f->mixed, x, y)}, share[2], light[2];
    for (int i = 0; i < 2; i++) {
        const double part = s[i][WEIGHT] > 0 ? plain_part(f, s[i], x, y) : 1;
        share[i] = s[i][WEIGHT] * (1 - fmin((i ? 4 : 1) * part, 1));
        light[i] = share[i] > 0 ? share[i] * (s[i][0] + s[i][1] + s[i][2]) : 0;
    }
    const int more = light[1] > light[0];
    for (int i = 0; i < SAMPLE && more; i++) {
        const double kept = s[0][i];
        s[0][i] = s[1][i];
        s[1][i] = kept;
    }
    s[0][SHARE] = light[more] > 0 ? share[more] * (1 - light[!more] / light[more]) : 0;
    s[0][SHARE] *= layers_reference_shared(f, s[0][RADIUS]);
}

// ---- hidden samples ----

void layers_reference_merge(const double *const *from, int count, double within, double part, int channels, double *out)
{
    double farthest = -INFINITY, sum = 0;
    for (int i = 0; i < count; i++)
        farthest = from[i][WEIGHT] > 0 ? fmax(farthest, from[i][RADIUS]) : farthest;
    memset(out, 0, SAMPLE * sizeof *out);
    for (int i = 0; i < count; i++) {
        const double g = from[i][WEIGHT] > 0 ? from[i][WEIGHT] * fmax(0, 1 - (farthest - from[i][RADIUS]) / within) : 0;
        sum += g;
        for (int c = 0; c < channels && g > 0; c++)
            out[c] += g * from[i][c];
        out[RADIUS] += g > 0 ? g * from[i][RADIUS] : 0;
    }
    for (int c = 0; c < channels; c++)
        out[c] = sum > 0 ? out[c] / sum : 0;
    out[RADIUS] = sum > 0 ? out[RADIUS] / sum : 0;
    out[WEIGHT] = sum * part;
}

// How much a quad is a lamp, or next to one: from 8 times as bright as what stands no nearer 10 and 16 pixels beside it to 16
// times. Lamps do not go on behind what hides them. Where nothing around stands as far, nobody can tell.
static double lamp(const struct frame *f, int x, int y, const double *quad)
{
    static const int distance[] = {2, 10, 16};
    double light = 0, seen = 0, mean = 0;
    for (int c = 0; c < 3; c++)
        light += quad[c] * fabs(quad[c]);
    double most = root(fmax(light, 0));
    const double own = most;
    double whole = own;
    for (int i = 0; i < 12; i++) {
        const int away = (i % 2 ? 1 : -1) * distance[i / 4], u = 2 * x + (i & 2 ? 0 : away),
                  v = 2 * y + (i & 2 ? away : 0);
        double nearest = INFINITY, around = 0, open = 0;
        for (int k = 0; k < 4; k++) {
            const int px = u + k % 2, py = v + k / 2;
            nearest = fmin(nearest, radius_at(f, px, py));
            around += bright_root(f, 0, 3, px, py) / 4;
            open += f->channels == 4 ? (1 - colour_at(f, 3, px, py)) / 4 : 0;
        }
        around += fmax(open, 0) * own;
        const double w = fmin(fmax(nearest - quad[RADIUS] + 2, 0), 1);
        most = i < 4 ? fmax(most, w * around) : most;
        whole = i < 4 ? fmax(whole, around) : whole;
        seen += i < 4 ? 0 : w;
        mean += i < 4 ? 0 : w * around;
    }
    mean = fmax(seen > 0 ? mean / seen : 0, whole / 256);
    return quad[WEIGHT] > 0 && most > 0 ? fmin(seen, 1) * (1 - fmin(fmax(pow(4 * mean / most, 2) - 1, 0), 1)) : 0;
}

// The surface behind a mixed pixel's edge, as roots; a pixel with less than a 64th of back counts partly as itself.
static void quad(const struct frame *f, int x, int y, double *out)
{
    double s[4][SAMPLE];
    const double *from[4] = {s[0], s[1], s[2], s[3]};
    for (int i = 0; i < 4; i++) {
        const int px = clamp(2 * x + i % 2, 0, f->width - 1), py = clamp(2 * y + i / 2, 0, f->height - 1);
        const double *mixed = at(&f->mixed, px, py), *seen = at(&f->seen, px, py);
        const double own = seen[WEIGHT] * pow(fmax(1 - pow(64 * mixed[WEIGHT], 2), 0), 2), weight = mixed[WEIGHT] + own;
        for (int c = 0; c < SAMPLE; c++)
            s[i][c] = mixed[WEIGHT] > 0 ? (mixed[WEIGHT] * mixed[c] + own * seen[c]) / weight : seen[c];
        s[i][WEIGHT] = weight;
        for (int c = 0; c < f->channels; c++)
            s[i][c] = root(s[i][c]);
    }
    layers_reference_merge(from, 4, 2, 0.25, f->channels, out);
    out[WEIGHT] *= f->highlights ? 1 - lamp(f, x, y, out) : 1;
}

// A ray from the rim of the lens that passes a near edge at a distance of its CoC radius, r pixels, meets a surface of
// radius s at most s - r pixels behind the edge. A search has to reach that far, for each pixel by itself. This is how
// many pixels the first n levels reach: a tap lies two pixels times 2^j away, and its sample is merged from two pixels
// of each step before it.
static double reach_of(int n)
{
    double reach = 0;
    for (int j = 0; j < n; j++)
        reach += 2 * (1 << j);
    return reach;
}

int layers_reference_levels(const struct frame *f)
{
    int n = 0;
    // No more than the pixel with the farthest ray needs: those beyond weigh nothing anywhere.
    if (f->hidden && f->high - f->low >= 1)
        for (n = 1; n < 7 && reach_of(n) <= f->high - f->low;)
            n++;
    return n;
}

static void step(const struct frame *f, const struct grid *from, struct grid *to, int dx, int dy, double within)
{
    for (int y = to->y0; y < to->y1; y++)
        for (int x = to->x0; x < to->x1; x++) {
            const double *in[3];
            for (int i = 0; i < 3; i++)
                in[i] = edge(from, x + (i - 1) * dx, y + (i - 1) * dy);  // beyond what is read the edge is never
            layers_reference_merge(in, 3, within, 1.0 / 3, f->channels, at(to, x, y));
        }
}

double layers_reference_hides_from(const struct frame *f, int x, int y)
{
    const double *front = edge(&f->seen, x, y), *back = edge(&f->mixed, x, y), some = 256 * front[WEIGHT];
    return some < 1 && back[WEIGHT] > 0 ? some * front[RADIUS] + (1 - some) * back[RADIUS] : front[RADIUS];
}

// The radius that a search looks behind: the nearest visible one, or half that of a near sample that was found behind
// it.
static double look_from(const struct frame *f, const struct grid *found, int x, int y)
{
    double nearest = INFINITY;
    if (found)
        // From a sixteenth of its quad on it counts as near as it is, and less before.
        return at(found, x, y)[WEIGHT] > 0 && at(found, x, y)[RADIUS] < -1
                   ? fmin(1, 16 * at(found, x, y)[WEIGHT]) * (at(found, x, y)[RADIUS] / 2 + 1) - 1
                   : INFINITY;
    for (int i = 0; i < 4; i++)
        nearest = fmin(nearest, layers_reference_hides_from(f, 2 * x + i % 2, 2 * y + i / 2));
    return nearest;
}

double layers_reference_before(const struct frame *f, int x, int y, double radius)
{
    const double *seen = edge(&f->seen, x, y), *mixed = edge(&f->mixed, x, y);
    return seen[WEIGHT] * layers_reference_hides(radius - seen[RADIUS]) +
           (mixed[WEIGHT] > 0 ? mixed[WEIGHT] * layers_reference_hides(radius - mixed[RADIUS]) : 0);
}

// The first surface on one side of a line behind `nearest`, possibly made of several samples: its colour, radius,
// distance, and its total weight.
static double side_of(const struct frame *f, const struct grid *quads, const double nearest, const int from[2],
                      const int by[2], int most, double *end, double *distance)
{
    double open = 1;
    *distance = 0;
    for (int i = 1; i <= most && i <= 16; i += i < 8 ? 1 : 2) {
        const double *q = at(quads, from[0] + i * by[0], from[1] + i * by[1]);
        const double part = open * fmin(9 * q[WEIGHT], 1) * layers_reference_hides(q[RADIUS] - nearest) *
                            fmin(fmax((q[RADIUS] - nearest) / 3 - i * hypot(by[0], by[1]) + 1, 0), 1);
        open -= part;
        for (int c = 0; c < f->channels && part > 0; c++)
            end[c] += part * q[c];
        end[RADIUS] += part > 0 ? part * q[RADIUS] : 0;
        *distance += part * i * hypot(by[0], by[1]);
    }
    for (int c = 0; c < f->channels && open < 1; c++)
        end[c] /= 1 - open;
    end[RADIUS] /= open < 1 ? 1 - open : 1;
    *distance /= open < 1 ? 1 - open : 1;
    return 1 - open;
}

// Add a surface that is found on both sides of a line. Returns how surely it is one.
static double find_between(const struct frame *f, const struct grid *quads, int levels, double nearest, int x, int y,
                           double *sum)
{
    static const int along[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
    double known = 0;
    for (int k = 0; k < 4; k++) {
        const int from[2] = {x, y}, back[2] = {-along[k][0], -along[k][1]};
        double a[SAMPLE] = {0}, b[SAMPLE] = {0}, t0, t1;
        const double whole = side_of(f, quads, nearest, from, along[k], 1 << levels, a, &t0) *
                             side_of(f, quads, nearest, from, back, 1 << levels, b, &t1);
        if (whole <= 0)
            continue;
        const double behind = (a[RADIUS] + b[RADIUS]) / 2 - nearest, apart = fabs(a[RADIUS] - b[RADIUS]);
        const double alike = fmin(fmax(2 - 4 * apart / fmax(behind, 1), 0), 1);
        const double w = 256 * whole * alike / pow(fmin(t0, t1), 8);
        for (int c = 0; c < f->channels; c++)
            sum[c] += w * (t1 * a[c] + t0 * b[c]) / (t0 + t1);
        sum[WEIGHT] += w;
        sum[RADIUS] += w * (t1 * a[RADIUS] + t0 * b[RADIUS]) / (t0 + t1);
        known += whole * alike;
    }
    return known;
}

static void find(const struct frame *f, const struct grid *level, int levels, double nearest, int x, int y, double *out)
{
    double sum[SAMPLE] = {0}, whole = 0;
    for (int j = 0; j < levels; j++)
        for (int i = 0; i < 9; i++) {
            const int u = i % 3 - 1, v = i / 3 - 1;
            const double *q = at(&level[j], x + u * (1 << j), y + v * (1 << j)), behind = q[RADIUS] - nearest;
            // A tap begins where a ray reaches half a step before it, but not before the nearer levels end; it counts
            // fully half a step behind it.
            const double from = fmax((hypot(u, v) - 0.5) * (2 << j), reach_of(j)),
                         to = (u || v || !j ? hypot(u, v) + 0.5 : 1.5) * (2 << j);
            const double a = fmin(fmax((behind - from) / (to - from), 0), 1);
            const double some = fmin(9 * q[WEIGHT], 1), part = pow(256, -j);
            const double w = part * (u ? 0.5 : 1) * (v ? 0.5 : 1) * a * some * layers_reference_hides(behind);
            whole += 4 * w / part;
            for (int c = 0; c < f->channels; c++)
                sum[c] += w * q[c];
            sum[WEIGHT] += w;
            sum[RADIUS] += w * q[RADIUS];
        }
    whole += 4 * find_between(f, &level[0], levels, nearest, x, y, sum);
    if (sum[WEIGHT] <= 0)
        return;
    out[RADIUS] = sum[RADIUS] / sum[WEIGHT];
    for (int c = 0; c < f->channels; c++)
        out[c] = sum[c] / sum[WEIGHT];
    for (int i = 0; i < 4; i++)
        out[WEIGHT] += layers_reference_before(f, 2 * x + i % 2, 2 * y + i / 2, out[RADIUS]) / 4;
    // A sample that taps have just reached covers nothing yet.
    out[WEIGHT] *= fmin(whole, 1);
}

static double roots_of(const double *s)
{
    return fabs(s[0]) + fabs(s[1]) + fabs(s[2]);
}

// How close a sample's colour is to another's.
static double shade(const double *s, const double *other)
{
    double off = 0;
    for (int c = 0; c < 3; c++)
        off += fabs(s[c] - other[c]);
    return fmax(1 - 2 * off / fmax(roots_of(other), 1e-30), 0.1);
}

struct company {
    double of[13], rest[13], like, others, size;
    const double *line[13];
};

// The parts of a hidden sample's row or column that are as far, and that are not.
static struct company company_of(const struct grid *from, int x, int y, int dx, int dy)
{
    const double *middle = at(from, x, y);
    struct company c = {{0}, {0}, 0, 0, 0, {NULL}};
    for (int i = 0; i < 13; i++) {
        const int px = x + (i - 6) * dx, py = y + (i - 6) * dy;
        if (px < from->x0 || px >= from->x1 || py < from->y0 || py >= from->y1 || !middle[WEIGHT])
            continue;
        const double *s = c.line[i] = at(from, px, py);
        const double weight = s[WEIGHT] > 0 ? (7 - abs(i - 6)) * fmin(16 * s[WEIGHT], 1) : 0;
        c.of[i] = weight * fmax(1 - fabs(s[RADIUS] - middle[RADIUS]) / 4, 0);
        c.rest[i] = weight - c.of[i];
        c.like += c.of[i];
        c.others += c.rest[i];
        c.size += c.rest[i] * fabs(s[RADIUS]);
    }
    return c;
}

// How lonely it is there, where it or the rest is drawn sharp.
static double lonely(const struct company *c, double r)
{
    const double part = c->like + c->others > 0 ? c->like / (c->like + c->others) : 1;
    const double around = c->others > 0 ? c->size / c->others : 2;
    return (1 - fmin(fmax(4 * (part - 1.0 / 7), 0), 1)) * fmin(fmax(2 - fmin(fabs(r), around), 0), 1);
}

// Means of 13 in a row or column, of samples about as far. A sample that is lonely in both becomes the mean of the rest
// of its column.
static struct grid smooth(const struct frame *f, const struct grid *from, int down)
{
    struct grid to = grid_new(from->x0, from->y0, from->x1, from->y1, SAMPLE);
    for (int y = to.y0; y < to.y1; y++)
        for (int x = to.x0; x < to.x1; x++) {
            const double *middle = at(from, x, y);
            const struct company c = company_of(from, x, y, !down, down), other = company_of(from, x, y, down, !down);
            const double alone = down ? fmin(lonely(&c, middle[RADIUS]), lonely(&other, middle[RADIUS])) : 0;
            double *out = at(&to, x, y), sum = 0;
            for (int i = 0; i < 13; i++) {
                const double *s = c.line[i];
                const double of = s ? c.of[i] * shade(s, middle) : 0;
                const double g = s ? (of + alone * (c.rest[i] - of)) * dimmed(roots_of(s), 16 * roots_of(middle)) : 0;
                sum += g;
                for (int k = 0; k < f->channels && g > 0; k++)
                    out[k] += g * c.line[i][k];
                out[RADIUS] += g > 0 ? g * c.line[i][RADIUS] : 0;
            }
            for (int k = 0; k < f->channels; k++)
                out[k] = sum > 0 ? out[k] / sum : 0;
            out[RADIUS] = sum > 0 ? out[RADIUS] / sum : 0;
            out[WEIGHT] = middle[WEIGHT];
        }
    return to;
}

// One sample for each quad, behind `found` or, if that is NULL, behind the visible surface: roots, not smoothed.
static struct grid search(const struct frame *f, const struct grid *level, int levels, const struct grid *found)
{
    struct grid to = grid_new(0, 0, (f->width + 1) / 2, (f->height + 1) / 2, SAMPLE);
    for (int y = to.y0; y < to.y1 && levels; y++)
        for (int x = to.x0; x < to.x1; x++) {
            const double from = look_from(f, found, x, y);
            find(f, level, levels, from, x, y, at(&to, x, y));
            at(&to, x, y)[WEIGHT] *= found ? fmin(fmax(-1 - from, 0), 1) : 1;
        }
    return to;
}

// Smooth what was found; with quads, patterns set its colours.
static struct grid smooth_found(const struct frame *f, const struct grid *found, const struct grid *quads)
{
    struct grid along = smooth(f, found, 0), down = smooth(f, &along, 1);
    if (quads)
        layers_reference_patterns(f, quads, &down);
    for (int y = down.y0; y < down.y1; y++)
        for (int x = down.x0; x < down.x1; x++)
            for (int c = 0; c < f->channels; c++)
                at(&down, x, y)[c] *= fabs(at(&down, x, y)[c]);
    free(along.v);
    return down;
}

static void find_hidden(struct frame *f)
{
    const int width = (f->width + 1) / 2, height = (f->height + 1) / 2, levels = layers_reference_levels(f),
              m = 2 << levels;
    struct grid level[7] = {{0}}, quads = grid_new(0, 0, width, height, SAMPLE);
    for (int y = 0; y < height && levels; y++)
        for (int x = 0; x < width; x++)
            quad(f, x, y, at(&quads, x, y));
    for (int j = 0; j < levels; j++) {
        struct grid across = grid_new(-m, -m, width + m, height + m, SAMPLE);
        level[j] = grid_new(-m, -m, width + m, height + m, SAMPLE);
        for (int y = -m; y < height + m && !j; y++)
            for (int x = -m; x < width + m; x++)
                memcpy(at(&level[0], x, y), edge(&quads, x, y), SAMPLE * sizeof(double));
        if (j) {
            step(f, &level[j - 1], &across, 1 << (j - 1), 0, reach_of(j));
            step(f, &across, &level[j], 0, 1 << (j - 1), reach_of(j));
        }
        free(across.v);
    }
    const struct grid behind = search(f, level, levels, NULL), beyond = search(f, level, levels, &behind);
    f->behind = smooth_found(f, &behind, levels && f->patterns ? &quads : NULL);
    f->beyond = smooth_found(f, &beyond, NULL);
    free(behind.v);
    free(beyond.v);
    for (int j = 0; j < levels; j++)
        free(level[j].v);
    free(quads.v);
}

void layers_reference_samples(struct frame *f)
{
    f->seen = grid_new(0, 0, f->width, f->height, SAMPLE);
    f->mixed = grid_new(0, 0, f->width, f->height, SAMPLE);
    for (int i = 0; i < f->width * f->height; i++)
        unmix(f, i % f->width, i / f->width);
    find_hidden(f);
    for (int i = 0; i < f->width * f->height && f->highlights; i++)
        highlight(f, i % f->width, i / f->width);
}
