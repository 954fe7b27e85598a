// SPDX-License-Identifier: BSD-3-Clause
// The kernels of the hexagon engine in plain C. hexagon.h says what they compute.
#include <math.h>

#include "engine/hexagon/kernels.h"

// ---- Load ----

// What the mean radius of far samples is summed from.
static float light_over(float r, float g, float b, float q)
{
    return hf_hexagon_light(r, g, b) / (q > HEXAGON_LEAST_MEAN ? q : HEXAGON_LEAST_MEAN);
}

static void load_full_row(const struct hf_frame *f, int y, struct hf_rect r, struct hf_edges *e)
{
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, f->s->width) - x0;
    const struct hf_buf *weight = &f->buf[HF_HEXAGON_WEIGHT];
    float *colour[4], *a = hf_at(weight, 0, x0, y), *q = hf_at(weight, 1, x0, y), *over = hf_at(weight, 2, x0, y);
    hf_row(&f->buf[HF_HEXAGON_COLOUR], f->s->channels, x0, y, colour);
    const float *whole = hf_hexagon_row(e, f, y, r, colour, q);
    for (int x = 0; x < n; x++) {
        const float m = __builtin_fabsf(q[x]);
        const float share = 1 / (m > 1 ? m : 1), w = whole ? whole[x] : 1;
        a[x] = w * share;
        for (int c = 0; c < f->s->channels; c++)
            colour[c][x] *= share * HEXAGON_SCALE;
        over[x] = q[x] > 0 ? light_over(colour[0][x], colour[1][x], colour[2][x], q[x]) : w * sqrtf(share);
    }
}

// The sum of a quad's colours with weights w, times scale.
static void quad_colour(const struct hf_frame *f, float w[4], float scale, float *const lane[2][2][4], int i,
                        float *const to[4])
{
    for (int t = 0; t < 4; t++)
        w[t] = w[t] * HEXAGON_SCALE;
    for (int c = 0; c < f->s->channels; c++)
        *to[c] = ((w[0] * lane[0][0][c][i] + w[1] * lane[0][1][c][i]) +
                  (w[2] * lane[1][0][c][i] + w[3] * lane[1][1][c][i])) *
                 scale;
}

// One field's part of a quad: its mean radius in half-resolution pixels, and its part of the area. Pixels with a radius
// below half a pixel count less, so that none comes or goes abruptly.
static void load_quad(const struct hf_frame *f, int colour, int x, int y, const float radius[4],
                      float *const lane[2][2][4], int i)
{
    float w[4], q = 0, sum = 0;
    for (int t = 0; t < 4; t++) {
        const float m = radius[t] > 0 ? radius[t] : 0;
        w[t] = 2 * m < 1 ? 2 * m : 1;
        q = q + w[t] * m;
    }
    sum = (w[0] + w[1]) + (w[2] + w[3]);  // in the same order as the colours, so that an alpha of 1 gives the weights
    q = sum > 0 ? 0.5f * (q / sum) : 0;
    const float spread = q > 1 ? q : 1, scale = 0.25f / spread;
    *hf_at(&f->buf[colour + 1], 0, x, y) = sum * scale;
    *hf_at(&f->buf[colour + 1], 1, x, y) = q;
    float *to[4];
    hf_row(&f->buf[colour], f->s->channels, x, y, to);
    quad_colour(f, w, scale, lane, i, to);
    *hf_at(&f->buf[colour + 1], 2, x, y) =
        colour == HF_HEXAGON_NEAR_COLOUR_2 ? (sum * scale) * sqrtf(spread) : light_over(*to[0], *to[1], *to[2], q);
}

// The visible part of a quad for near pixels around it: all pixels that are not near, or hardly near.
static void load_seen(const struct hf_frame *f, int x, int y, const float radius[4], float *const lane[2][2][4], int i)
{
    float w[4];
    for (int t = 0; t < 4; t++)
        w[t] = hf_saturate(1.5f + radius[t]);
    *hf_at(&f->buf[HF_HEXAGON_SEEN_WEIGHT_2], 0, x, y) = ((w[0] + w[1]) + (w[2] + w[3])) * 0.25f;
    float *to[4];
    hf_row(&f->buf[HF_HEXAGON_SEEN_COLOUR_2], f->s->channels, x, y, to);
    quad_colour(f, w, 0.25f, lane, i, to);
}

static void load_half_row(const struct hf_frame *f, int y, struct hf_rect r, struct hf_edges *e)
{
    (void)e;
    const int n = r.x1 - r.x0, y1 = hf_min(2 * y + 1, f->s->height - 1), last = f->s->width - 1 - 2 * r.x0;
    float *lane[2][2][4];  // [row][odd][channel]
    for (int i = 0; i < 16; i++)
        lane[i >> 3][i >> 2 & 1][i & 3] = hf_line(f, i);
    float *top = hf_line(f, 16), *bottom = hf_line(f, 17);
    hf_read_colour(f, r.x0, 2 * y, n, lane[0][0], lane[0][1], f->seen);
    hf_read_colour(f, r.x0, y1, n, lane[1][0], lane[1][1], f->seen);
    f->k->radius_row(f, 2 * r.x0, 2 * y, hf_min(2 * n, last + 1), top, NULL);
    f->k->radius_row(f, 2 * r.x0, y1, hf_min(2 * n, last + 1), bottom, NULL);
    for (int i = 0; i < n; i++) {
        const int odd = hf_min(2 * i + 1, last);
        const float far[4] = {top[2 * i], top[odd], bottom[2 * i], bottom[odd]};
        const float near[4] = {-far[0], -far[1], -far[2], -far[3]};
        load_quad(f, HF_HEXAGON_NEAR_COLOUR_2, r.x0 + i, y, near, lane, i);
        load_quad(f, HF_HEXAGON_FAR_COLOUR_2, r.x0 + i, y, far, lane, i);
        load_seen(f, r.x0 + i, y, far, lane, i);
    }
}

void hf_hexagon_load_c(const struct hf_frame *f, struct hf_rect r)
{
    hf_hexagon_load_rows(f, r, hf_hexagon(f->s)->half ? load_half_row : load_full_row);
}

// ---- the passes ----

// Sums along a line: of colour x weight, of the weights a, and of what their mean radius is summed from.
struct sums {
    float colour[4], a, w;
};

// A far pixel of radius p takes samples up to a radius of 2p. Beyond, they fade out over one pixel (p, where that is
// smaller): the factor is limit - slope q, between 0 and 1.
struct limit {
    float limit, slope;
};

static struct limit limit_of(float p)
{
    const float slope = 1 / (p < 1 ? p : 1);
    return (struct limit){(2 * p) * slope + 1, slope};
}

// How much a sample of radius q counts at a tap.
static float count_of(const struct hf_hexagon_tap *t, const struct limit *limit, float q)
{
    float w = q - t->c;
    if (limit) {
        const float most = t->b * (limit->limit - limit->slope * q);
        w = w < most ? w : most;
    }
    w = w < t->b ? w : t->b;
    return (w > 0 ? w : 0) * t->part;
}

static struct sums sum_line(const struct hf_frame *f, const struct hf_hexagon_field *in, int line, int x, int y,
                            const struct limit *limit)
{
    const struct hf_hexagon_line *l = &hf_hexagon(f->s)->line[line];
    struct sums sum = {{0}, 0, 0};
    for (const struct hf_hexagon_tap *t = l->taps; t < l->taps + l->count; t++) {
        const int u = x + t->dx, v = y + t->dy;
        const float q = in->sign * *hf_at(in->radius, in->q, u, v);
        const float w = count_of(t, limit, q);
        for (int c = 0; c < f->s->channels; c++)
            sum.colour[c] = sum.colour[c] + w * *hf_at(in->colour, c, u, v);
        sum.a = sum.a + w * *hf_at(in->weight, in->a, u, v);
        if (in->mean >= 0)
            sum.w = sum.w + w * *hf_at(in->weight, in->mean, u, v);
    }
    return sum;
}

// Near: store the coverage a. What covers the line spreads a / w far, so each of its pixels gets w / a of it.
static void store_near(const struct hf_frame *f, const struct sums *s, enum hf_hexagon_made colour, int weight, int x,
                       int y)
{
    const int any = s->a > 0;
    const float root = any ? s->a / s->w : 0, share = root * root, mean = any ? s->w / s->a : 0;
    for (int c = 0; c < f->s->channels; c++)
        *hf_at(hf_hexagon_made(f, colour), c, x, y) = s->colour[c] * share;
    *hf_at(hf_hexagon_made(f, HF_HEXAGON_NEAR_W), weight, x, y) = s->a * share;
    *hf_at(hf_hexagon_made(f, HF_HEXAGON_NEAR_W), weight + 1, x, y) = mean * mean;
}

static void near_1(const struct hf_frame *f, int x, int y)
{
    const struct hf_hexagon_field in = hf_hexagon_field(f, HF_NEAR);
    struct sums u = sum_line(f, &in, 0, x, y, NULL), v = sum_line(f, &in, 1, x, y, NULL);
    store_near(f, &u, HF_HEXAGON_NEAR_U, 0, x, y);
    for (int c = 0; c < f->s->channels; c++)
        u.colour[c] = u.colour[c] + v.colour[c];
    u.a = u.a + v.a;
    u.w = u.w + v.w;
    store_near(f, &u, HF_HEXAGON_NEAR_B, 2, x, y);
}

static void near_2(const struct hf_frame *f, int x, int y)
{
    const struct hf_hexagon_field in[2] = {hf_hexagon_field_2(f, HF_NEAR, 0), hf_hexagon_field_2(f, HF_NEAR, 1)};
    const struct sums v = sum_line(f, &in[0], 1, x, y, NULL), w = sum_line(f, &in[1], 2, x, y, NULL);
    for (int c = 0; c < f->s->channels; c++)
        *hf_at(hf_hexagon_made(f, HF_HEXAGON_NEAR), c, x, y) = (v.colour[c] + w.colour[c]) * (1 / 3.0f);
    *hf_at(hf_hexagon_made(f, HF_HEXAGON_COVERAGE), 0, x, y) = (v.a + w.a) * (1 / 3.0f);
}

// How much of its own colour a pixel of radius p > 0 adds to what it found.
static float own(float found, float p)
{
    float o = (1 - found) * hf_saturate(HEXAGON_ALL - p);
    const float least = HEXAGON_LEAST - found;
    o = o > least ? o : least;
    return o > 0 ? o : 0;
}

// A blur of the far field at a far pixel: mean colour, the total weight that was found, and in pass 1 the mean light
// over radius.
struct found {
    float colour[4], a, w;
};

static struct found far_line(const struct hf_frame *f, const struct hf_hexagon_field *in, int line, int x, int y,
                             float p)
{
    const struct limit limit = limit_of(p);
    const struct sums s = sum_line(f, in, line, x, y, &limit);
    const float o = own(s.a, p), mine = o / *hf_at(in->weight, in->a, x, y);
    struct found all = {.a = s.a + o};
    const float i = 1 / all.a;
    if (in->mean >= 0)
        all.w = (s.w + mine * *hf_at(in->weight, in->mean, x, y)) * i;
    for (int c = 0; c < 3; c++)
        all.colour[c] = (s.colour[c] + mine * *hf_at(in->colour, c, x, y)) * i;
    // Dividing by the factor of the multiplication makes sums of 1 exactly 1.
    if (f->s->channels == 4)
        all.colour[3] = (s.colour[3] + o * (*hf_at(in->colour, 3, x, y) / *hf_at(in->weight, in->a, x, y))) / all.a;
    return all;
}

// Store the colours found, with a weight and the mean radius; without light the pixel's own radius. A pixel that is
// only partly far gets a smaller weight. whole: how much was found of a full weight.
static void store_far(const struct hf_frame *f, const struct found *all, float p, float part, float whole,
                      enum hf_hexagon_made colour, int weight, int x, int y)
{
    const int any = all->a > 0;
    const float light = hf_hexagon_light(all->colour[0], all->colour[1], all->colour[2]);
    const float mean = all->w > 0 ? light / all->w : p, least = mean > HEXAGON_LEAST_MEAN ? mean : HEXAGON_LEAST_MEAN;
    const float q = any ? least : 0, a = any ? part / (q > 1 ? q : 1) : 0;
    for (int c = 0; c < f->s->channels; c++)
        *hf_at(hf_hexagon_made(f, colour), c, x, y) = all->colour[c] * a;
    *hf_at(hf_hexagon_made(f, HF_HEXAGON_FAR_W), weight, x, y) = whole * a;
    *hf_at(hf_hexagon_made(f, HF_HEXAGON_FAR_W), weight + 1, x, y) = q;
}

static void add(struct found *u, const struct found *v, int channels)
{
    for (int c = 0; c < channels; c++)
        u->colour[c] = u->colour[c] + v->colour[c];
    u->a = u->a + v->a;
    u->w = u->w + v->w;
}

// Scale what a line found by the part of the line within the frame; returns that part.
static float keep_within(const struct hf_frame *f, struct found *s, int line, int x, int y, float p)
{
    static const float here[2] = {0, 0};
    const float at[2] = {(float)x + 0.5f, (float)y + 0.5f};
    const float part = hf_hexagon_along(hf_hexagon_width(f->s), hf_hexagon_height(f->s), hf_hexagon(f->s)->side[line],
                                        at, here, 1 / p);
    for (int c = 0; c < f->s->channels; c++)
        s->colour[c] = s->colour[c] * part;
    s->w = s->w * part;
    return part;
}

// What shines along a line of pass 1: the sum of w m, and that of w m ^ 2. m counts in units of all.
struct lit {
    float sum, squares;
};

static void add_lit(const struct hf_frame *f, const struct hf_hexagon_field *in, int line, int x, int y, float p,
                    float all, struct lit *lit)
{
    const struct hf_hexagon_line *l = &hf_hexagon(f->s)->line[line];
    const struct limit limit = limit_of(p);
    for (const struct hf_hexagon_tap *t = l->taps; t < l->taps + l->count; t++) {
        const int u = x + t->dx, v = y + t->dy;
        const float w = count_of(t, &limit, in->sign * *hf_at(in->radius, in->q, u, v));
        const float m = *hf_at(in->weight, in->mean, u, v) / all, light = w > 0 ? w * m : 0;
        lit->sum = lit->sum + light;
        lit->squares = lit->squares + (w > 0 ? light * m : 0);
    }
}

// Bring a stored mean radius towards the pixel's own, p, as far as it is of but a trace of light. bright: how much the pixel
// itself has of what makes it bright.
static void fade_mean(const struct hf_frame *f, const struct lit *lit, float p, float bright,
                      enum hf_hexagon_made colour, int weight, int x, int y)
{
    const float length = (lit->sum / lit->squares) * (lit->sum * (1 / HEXAGON_TRACE));
    const float sure = length > bright ? length : bright;
    if (!(lit->squares > 0) || !(sure < 1))
        return;
    float *q = hf_at(hf_hexagon_made(f, HF_HEXAGON_FAR_W), weight + 1, x, y);
    const float mean = *q + (p - *q) * (1 - sure), least = mean > HEXAGON_LEAST_MEAN ? mean : HEXAGON_LEAST_MEAN;
    const float a = (*q > 1 ? *q : 1) / (least > 1 ? least : 1);
    for (int c = 0; c < f->s->channels; c++)
        *hf_at(hf_hexagon_made(f, colour), c, x, y) *= a;
    *hf_at(hf_hexagon_made(f, HF_HEXAGON_FAR_W), weight, x, y) *= a;
    *q = least;
}

// After pass 1 has stored what it found at a pixel whose own m is own. all: the mean m of both lines.
static void fade_traces(const struct hf_frame *f, const struct hf_hexagon_field *in, int x, int y, float p, float own,
                        float all)
{
    const float dark = all * HEXAGON_DARK;
    struct lit lit = {0, 0};
    if (!(dark > own))
        return;
    add_lit(f, in, 0, x, y, p, all, &lit);
    fade_mean(f, &lit, p, own / dark, HF_HEXAGON_FAR_U, 0, x, y);
    add_lit(f, in, 1, x, y, p, all, &lit);
    fade_mean(f, &lit, p, own / dark, HF_HEXAGON_FAR_B, 2, x, y);
}

static void far_1(const struct hf_frame *f, int x, int y)
{
    const struct hf_hexagon_field in = hf_hexagon_field(f, HF_FAR);
    const float p = *hf_at(in.radius, in.q, x, y), part = *hf_at(in.weight, in.a, x, y) * (p > 1 ? p : 1);
    struct found u = {{0}, 0, 0}, v = u;
    float up = 1, left = 1;
    if (p > 0) {
        u = far_line(f, &in, 0, x, y, p);
        v = far_line(f, &in, 1, x, y, p);
        up = keep_within(f, &u, 0, x, y, p);
        left = keep_within(f, &v, 1, x, y, p);
    }
    store_far(f, &u, p, part, up, HF_HEXAGON_FAR_U, 0, x, y);
    add(&u, &v, f->s->channels);
    store_far(f, &u, p, part, 0.5f * (up + left), HF_HEXAGON_FAR_B, 2, x, y);
    fade_traces(f, &in, x, y, p, *hf_at(in.weight, in.mean, x, y), u.w);
}

// The sums of a line that reaches beyond the frame. They are normalised only if their weight exceeds 1.
static struct found beyond_line(const struct hf_frame *f, const struct hf_hexagon_field *in, int line, int x, int y,
                                float p)
{
    const struct limit limit = limit_of(p);
    const struct sums s = sum_line(f, in, line, x, y, &limit);
    const float i = 1 / (s.a > 1 ? s.a : 1);
    struct found all = {.a = s.a * i, .w = s.w * i};
    for (int c = 0; c < f->s->channels; c++)
        all.colour[c] = s.colour[c] * i;
    return all;
}

static void far_beyond(const struct hf_frame *f, int x, int y)
{
    const struct hf_hexagon_field in = hf_hexagon_field(f, HF_FAR);
    int at_x = x, at_y = y;
    const int is = hf_hexagon_nearest(f->s, &at_x, &at_y);
    const float p = is ? *hf_at(in.radius, in.q, at_x, at_y) : 0;
    const float part = *hf_at(in.weight, in.a, at_x, at_y) * (p > 1 ? p : 1);
    struct found u = {{0}, 0, 0}, v = u;
    if (p > 0) {
        u = beyond_line(f, &in, 0, x, y, p);
        v = beyond_line(f, &in, 1, x, y, p);
    }
    store_far(f, &u, p, part, u.a, HF_HEXAGON_FAR_U, 0, x, y);
    add(&u, &v, f->s->channels);
    store_far(f, &u, p, part, 0.5f * u.a, HF_HEXAGON_FAR_B, 2, x, y);
    fade_traces(f, &in, x, y, p, *hf_at(in.weight, in.mean, at_x, at_y), u.w);
}

static void far_2(const struct hf_frame *f, int x, int y)
{
    const struct hf_hexagon_field in[2] = {hf_hexagon_field_2(f, HF_FAR, 0), hf_hexagon_field_2(f, HF_FAR, 1)};
    const struct hf_hexagon_field pixel = hf_hexagon_field(f, HF_FAR);
    const float p = *hf_at(pixel.radius, pixel.q, x, y);
    struct found v = {{0}, 0, 0}, w = v;
    if (p > 0) {
        v = far_line(f, &in[0], 1, x, y, p);
        w = far_line(f, &in[1], 2, x, y, p);
    }
    for (int c = 0; c < f->s->channels; c++)
        *hf_at(hf_hexagon_made(f, HF_HEXAGON_FAR), c, x, y) = (v.colour[c] + w.colour[c]) * (1 / 3.0f);
}

static void each_pixel(const struct hf_frame *f, struct hf_rect p, void (*fn)(const struct hf_frame *f, int x, int y))
{
    for (int y = p.y0; y < p.y1 && !hf_stopped(f->s->stop); y++)
        for (int x = p.x0; x < p.x1; x++)
            fn(f, x, y);
}

void hf_hexagon_1_c(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_rect p = hf_hexagon_rect(f->s, r);
    if (f->near)
        each_pixel(f, p, near_1);
    if (f->far)
        each_pixel(f, p, far_1);
}

void hf_hexagon_2_c(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_rect p = hf_hexagon_rect(f->s, r);
    if (f->near)
        each_pixel(f, p, near_2);
    if (f->far)
        each_pixel(f, p, far_2);
}

void hf_hexagon_beyond_c(const struct hf_frame *f, struct hf_rect r)
{
    each_pixel(f, r, far_beyond);
}
