// SPDX-License-Identifier: BSD-3-Clause
// Reference: storage, and passes 2 to 9 of the chapter over whole buffers; the gather from CoC on is reference_area.c's.
#include "support/reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const names[REF_COUNT] = {
    "colour", "coc",          "coc4", "cocmaxx", "cocmax",   "cocblurx", "cocblur",
    "color4", "colormulcoc4", "near", "far",     "nearfill", "farfill",  "result",
};

static int clamp(int v, int low, int high)
{
    return v < low ? low : v > high ? high : v;
}

// A sample with the position clamped to the edge.
static double at(const struct ref_buffer *b, int c, int x, int y)
{
    return b->data[c][clamp(y, 0, b->height - 1) * b->width + clamp(x, 0, b->width - 1)];
}

// Bilinear, at a position in pixels where whole numbers are pixel centres.
static double bilinear(const struct ref_buffer *b, int c, double x, double y)
{
    const double x0 = floor(x), y0 = floor(y), fx = x - x0, fy = y - y0;
    const int i = (int)x0, j = (int)y0;
    return (1 - fy) * ((1 - fx) * at(b, c, i, j) + fx * at(b, c, i + 1, j)) +
           fy * ((1 - fx) * at(b, c, i, j + 1) + fx * at(b, c, i + 1, j + 1));
}

// Uniform cubic B-spline.
static double bicubic(const struct ref_buffer *b, int c, double x, double y)
{
    const double x0 = floor(x), y0 = floor(y);
    double sum = 0;
    for (int j = -1; j <= 2; j++) {
        for (int i = -1; i <= 2; i++) {
            const double dx = fabs(x - (x0 + i)), dy = fabs(y - (y0 + j));
            const double wx = dx < 1 ? 2.0 / 3 - dx * dx + dx * dx * dx / 2 : pow(2 - dx, 3) / 6;
            const double wy = dy < 1 ? 2.0 / 3 - dy * dy + dy * dy * dy / 2 : pow(2 - dy, 3) / 6;
            sum += wx * wy * at(b, c, (int)x0 + i, (int)y0 + j);
        }
    }
    return sum;
}

// Truncate a finite non-negative number to that many mantissa bits, with the exponent range of half floats. A value
// within double precision's roundings of a boundary counts as on it.
static double truncate_to(double v, int mantissa_bits, double largest)
{
    if (!(v > 0))
        return 0;
    if (v >= largest)
        return largest;
    const double step = ldexp(1, (int)fmax(ilogb(v), -14) - mantissa_bits);
    return floor(v / step + 1e-9) * step;
}

double ref_store(enum hf_storage storage, int channel, double v)
{
    if (storage == HF_STORAGE_HALF)
        return half_to_double(double_to_half(v));
    if (storage == HF_STORAGE_FLOAT || channel == 3)
        return v;
    if (channel < 0)
        return floor(v * 255 + 0.5) / 255;
    return truncate_to(v, channel == 2 ? 5 : 6, channel == 2 ? 64512 : 65024);
}

static void store(struct reference *r, enum ref_id id, int c, int x, int y, double v)
{
    struct ref_buffer *b = &r->buffer[id];
    const int is_coc = id >= REF_COC && id <= REF_COCBLUR;
    b->raw[c][y * b->width + x] = v;
    b->data[c][y * b->width + x] =
        ref_store(r->params.engine == HF_ENGINE_GATHER ? r->params.gather.storage : r->params.chapter.storage,
                  is_coc ? -1 : c, v);
}

static struct ref_buffer *new_buffer(struct reference *r, enum ref_id id)
{
    struct ref_buffer *b = &r->buffer[id];
    const int full = id == REF_COLOUR || id == REF_COC || id == REF_RESULT;
    b->name = names[id];
    b->width = full ? r->width : r->half_width;
    b->height = full ? r->height : r->half_height;
    b->channels = id == REF_COC || id == REF_COC4 ? 2 : id > REF_COC4 && id <= REF_COCBLUR ? 1 : r->channels;
    for (int c = 0; c < b->channels; c++) {
        b->data[c] = calloc((size_t)b->width * (size_t)b->height, sizeof(double));
        b->raw[c] = calloc((size_t)b->width * (size_t)b->height, sizeof(double));
    }
    return b;
}

// Pass 1.
static void coc_generation(struct reference *r, const struct hf_depth *depth)
{
    new_buffer(r, REF_COC);
    double *z = malloc(sizeof *z * (size_t)r->width * (size_t)r->height);
    ref_depths(z, depth, r->params.view.pixel_aspect, r->width, r->height);
    for (int y = 0; y < r->height; y++) {
        for (int x = 0; x < r->width; x++) {
            double n, f;
            ref_coc(r, depth, z[y * r->width + x], &n, &f);
            store(r, REF_COC, 0, x, y, n);
            store(r, REF_COC, 1, x, y, f);
        }
    }
    free(z);
}

// Pass 2. Weights as printed: 1000 for the top left sample, 1 / (|df| + 0.001) for the others.
static void downsample(struct reference *r)
{
    const enum hf_downsample how = r->params.chapter.downsample;
    const struct ref_buffer *colour = &r->buffer[REF_COLOUR], *coc = &r->buffer[REF_COC];
    new_buffer(r, REF_COC4);
    new_buffer(r, REF_COLOR4);
    new_buffer(r, REF_COLORMULCOC4);
    for (int y = 0; y < r->half_height; y++) {
        for (int x = 0; x < r->half_width; x++) {
            const double f00 = at(coc, 1, 2 * x, 2 * y);
            store(r, REF_COC4, 0, x, y, at(coc, 0, 2 * x, 2 * y));
            store(r, REF_COC4, 1, x, y, f00);
            for (int c = 0; c < r->channels; c++) {
                double sum = 0, weighted = 0, weights = 0;
                for (int i = 0; i < 4; i++) {
                    const int sx = 2 * x + i % 2, sy = 2 * y + i / 2;
                    const double alike = i == 0 ? 1000 : 1 / (fabs(f00 - at(coc, 1, sx, sy)) + 0.001);
                    const double w = how == HF_DOWNSAMPLE_LINEAR ? 1 : how == HF_DOWNSAMPLE_POINT ? i == 0 : alike;
                    sum += at(colour, c, sx, sy);
                    weighted += w * at(colour, c, sx, sy);
                    weights += w;
                }
                store(r, REF_COLOR4, c, x, y, how == HF_DOWNSAMPLE_POINT ? weighted : sum / 4);
                store(r, REF_COLORMULCOC4, c, x, y, weighted / weights * f00);
            }
        }
    }
}

// Passes 3 to 6: maximum or mean over 2 * reach + 1 samples along one axis. By default the outermost samples fade in as
// the radius reaches them.
static void window(struct reference *r, enum ref_id from, enum ref_id to, int dx, int dy, int mean)
{
    const struct ref_buffer *in = &r->buffer[from];
    const double radius = dx ? r->reach_x : r->reach_y;
    const int reach = (int)ceil(radius);
    const double edge = r->params.chapter.faithful ? 1 : radius - (reach - 1);
    new_buffer(r, to);
    for (int y = 0; y < r->half_height; y++) {
        for (int x = 0; x < r->half_width; x++) {
            double sum = 0, largest = 0;
            for (int i = -reach; i <= reach; i++) {
                const double v = at(in, 0, x + i * dx, y + i * dy) * (i == -reach || i == reach ? edge : 1);
                sum += v;
                largest = worse(largest, v);
            }
            store(r, to, 0, x, y, mean ? sum / (2 * reach - 1 + 2 * edge) : largest);
        }
    }
}

// The planes that pass 7 samples: colour (times w), w, colour x far (times w), far (times w).
struct planes {
    struct ref_buffer near, near_weight, far, far_weight;
};

static struct planes weigh(const struct reference *r)
{
    struct planes p = {.near = r->buffer[REF_COLOR4], .far = r->buffer[REF_COLORMULCOC4]};
    const size_t n = (size_t)r->half_width * (size_t)r->half_height;
    const struct ref_buffer weight = {.width = r->half_width, .height = r->half_height, .channels = 1};
    p.near_weight = p.far_weight = weight;
    p.near_weight.data[0] = malloc(n * sizeof(double));
    p.far_weight.data[0] = malloc(n * sizeof(double));
    for (int c = 0; c < r->channels; c++) {
        p.near.data[c] = malloc(n * sizeof(double));
        p.far.data[c] = malloc(n * sizeof(double));
    }
    double *const *colour = r->buffer[REF_COLOR4].data;
    for (size_t i = 0; i < n; i++) {
        const double y709 = 0.2126 * colour[0][i] + 0.7152 * colour[1][i] + 0.0722 * colour[2][i];
        const double w = r->params.chapter.karis ? 1 / (1 + fmax(y709, 0)) : 1;
        p.near_weight.data[0][i] = w;
        p.far_weight.data[0][i] = r->buffer[REF_COC4].data[1][i] * w;
        for (int c = 0; c < r->channels; c++) {
            p.near.data[c][i] = colour[c][i] * w;
            p.far.data[c][i] = r->buffer[REF_COLORMULCOC4].data[c][i] * w;
        }
    }
    return p;
}

static void planes_free(struct planes *p)
{
    free(p->near_weight.data[0]);
    free(p->far_weight.data[0]);
    for (int c = 0; c < p->near.channels; c++) {
        free(p->near.data[c]);
        free(p->far.data[c]);
    }
}

static double gather_one(const struct reference *r, const struct ref_buffer *b, int c, int x, int y, double scale)
{
    double sum = r->centre * at(b, c, x, y);
    for (int i = 0; i < r->taps; i++)
        sum += r->tap_share[i] * bilinear(b, c, x + scale * r->tap_x[i], y + scale * r->tap_y[i]);
    return sum;
}

static double lerp(double a, double b, double t)
{
    return t == 0 ? a : a + t * (b - a);
}

// By default the near field fades in over the first eighth of the blurred near CoC.
static double near_part(const struct reference *r, int x, int y)
{
    const double blur = at(&r->buffer[REF_COCBLUR], 0, x, y);
    return r->params.chapter.faithful ? blur > 0 : fmin(1, 8 * blur);
}

// Pass 7.
static void computation(struct reference *r)
{
    struct planes p = weigh(r);
    const double taps = r->shares;
    r->near_mean = calloc((size_t)r->half_width * (size_t)r->half_height, sizeof(double));
    r->far_mean = calloc((size_t)r->half_width * (size_t)r->half_height, sizeof(double));
    new_buffer(r, REF_NEAR);
    new_buffer(r, REF_FAR);
    for (int y = 0; y < r->half_height; y++) {
        for (int x = 0; x < r->half_width; x++) {
            const double f = at(&r->buffer[REF_COC4], 1, x, y);
            const int has_near = at(&r->buffer[REF_COCBLUR], 0, x, y) > 0;
            const double scale = r->params.chapter.per_pixel_kernel ? f : 1;
            const double near_weight = has_near ? gather_one(r, &p.near_weight, 0, x, y, 1) : 1;
            const double far_weight = f > 0 ? gather_one(r, &p.far_weight, 0, x, y, scale) : 1;
            r->near_mean[y * r->half_width + x] = has_near ? near_weight / taps : 0;
            r->far_mean[y * r->half_width + x] = f > 0 ? far_weight / taps : 0;
            // The dense grid has no tap on the pixel itself, and may meet no far sample at all; then the pixel's own
            // colour counts.
            const int alone = far_weight < 1e-9 * f * taps;
            for (int c = 0; c < r->channels; c++) {
                const double own = at(&r->buffer[REF_COLORMULCOC4], c, x, y) / f,
                             colour = at(&r->buffer[REF_COLOR4], c, x, y);
                store(r, REF_NEAR, c, x, y,
                      has_near ? lerp(colour, gather_one(r, &p.near, c, x, y, 1) / near_weight, near_part(r, x, y))
                               : colour);
                store(r, REF_FAR, c, x, y,
                      !(f > 0) ? 0
                      : alone  ? own
                               : gather_one(r, &p.far, c, x, y, scale) / far_weight);
            }
        }
    }
    planes_free(&p);
}

// One sample of pass 8. coc4 is given for the far field: only neighbours with far colour enter a mean, and with the
// per-pixel kernel only those of similar CoC enter at all. By default a far neighbour fades in over the first quarter
// of its CoC, and fades out over a quarter of difference.
static double fill_one(const struct reference *r, const struct ref_buffer *b, const struct ref_buffer *coc4, int c,
                       int x, int y)
{
    const int faithful = r->params.chapter.faithful;
    double largest = at(b, c, x, y), sum = 0, count = 0;
    for (int j = y - 1; j <= y + 1; j++) {
        for (int i = x - 1; i <= x + 1; i++) {
            const double df = coc4 ? fabs(at(coc4, 1, i, j) - at(coc4, 1, x, y)) : 0;
            const int holds = !coc4 || at(coc4, 1, i, j) > 0;
            double part = coc4 && !faithful ? fmin(1, 4 * at(coc4, 1, i, j)) : 1;
            if (r->params.chapter.per_pixel_kernel)
                part *= faithful ? df <= 0.25 : fmax(0, fmin(1, 2 - 4 * df));
            largest = fmax(largest, lerp(at(b, c, x, y), at(b, c, i, j), part));
            if (!holds)
                continue;
            sum += part * at(b, c, i, j);
            count += part;
        }
    }
    return r->params.chapter.fill == HF_FILL_MAX ? largest : sum / count;
}

// Pass 8.
static void fill(struct reference *r)
{
    const struct ref_buffer *near = &r->buffer[REF_NEAR], *far = &r->buffer[REF_FAR];
    const struct ref_buffer *coc4 = &r->buffer[REF_COC4];
    const int none = r->params.chapter.fill >= HF_FILL_NONE;
    new_buffer(r, REF_NEARFILL);
    new_buffer(r, REF_FARFILL);
    for (int y = 0; y < r->half_height; y++) {
        for (int x = 0; x < r->half_width; x++) {
            const int has_near = !none && at(&r->buffer[REF_COCBLUR], 0, x, y) > 0;
            const int has_far = !none && at(coc4, 1, x, y) > 0;
            for (int c = 0; c < r->channels; c++) {
                const double own = at(near, c, x, y);
                store(r, REF_NEARFILL, c, x, y,
                      has_near ? lerp(own, fill_one(r, near, NULL, c, x, y), near_part(r, x, y)) : own);
                store(r, REF_FARFILL, c, x, y, has_far ? fill_one(r, far, coc4, c, x, y) : at(far, c, x, y));
            }
        }
    }
}

// The far field at full resolution. Returns how far the pixel is blended to it: each tap gives at most 16 times its own
// part.
static double upsample_far(const struct reference *r, int x, int y, double out[4])
{
    const struct ref_buffer *coc4 = &r->buffer[REF_COC4];
    const double f = at(&r->buffer[REF_COC], 1, x, y);
    const int faithful = r->params.chapter.faithful;
    const double hx = (x + 0.5) / 2 - 0.5, hy = (y + 0.5) / 2 - 0.5;
    const int cx = (int)floor(hx), cy = (int)floor(hy);  // of the CoCs: (k-1, k) for pixel 2k, (k, k+1) for 2k+1
    double weights = 0, most = 0;
    for (int c = 0; c < 4; c++)
        out[c] = 0;
    for (int j = 0; j < 2; j++) {
        for (int i = 0; i < 2; i++) {
            const double f_half = at(coc4, 1, cx + i, cy + j);
            const double bx = i ? hx - cx : 1 - (hx - cx), by = j ? hy - cy : 1 - (hy - cy);
            const double has = faithful ? f : fmin(16 * f_half, f);
            const double w = (faithful ? 0.25 : has * bx * by) / (fabs(f - f_half) + 0.001);
            const int tx = faithful ? (x + i) / 2 : cx + i, ty = faithful ? (y + j) / 2 : cy + j;
            for (int c = 0; c < r->channels; c++)
                out[c] += w * at(&r->buffer[REF_FARFILL], c, tx, ty);
            weights += w;
            most = fmax(most, has);
        }
    }
    for (int c = 0; c < r->channels && weights > 0; c++)
        out[c] /= weights;
    return most;
}

// Pass 9.
static void composite(struct reference *r)
{
    double (*const sample)(const struct ref_buffer *, int, double, double) =
        r->params.chapter.bicubic ? bicubic : bilinear;
    new_buffer(r, REF_RESULT);
    for (int y = 0; y < r->height; y++) {
        for (int x = 0; x < r->width; x++) {
            double far[4];
            const double hx = (x + 0.5) / 2 - 0.5, hy = (y + 0.5) / 2 - 0.5;
            const double near_t = r->blend * sample(&r->buffer[REF_COCBLUR], 0, hx, hy);
            const double far_t = r->blend * upsample_far(r, x, y, far);
            for (int c = 0; c < r->channels; c++) {
                const double v = lerp(at(&r->buffer[REF_COLOUR], c, x, y), far[c], far_t);
                store(r, REF_RESULT, c, x, y, lerp(v, sample(&r->buffer[REF_NEARFILL], c, hx, hy), near_t));
            }
        }
    }
}

static void set_scales(struct reference *r, const struct hf_depth *depth)
{
    const struct hf_params *p = &r->params;
    const int display = p->view.display_height != HF_DERIVE ? p->view.display_height : r->height;
    const int faithful = p->engine == HF_ENGINE_CHAPTER && p->chapter.faithful;
    r->rho = p->max_radius != HF_DERIVE ? p->max_radius : faithful ? 12 : 12.0 * display / 1080;
    r->reach_y = r->rho / 2;
    r->reach_x = r->reach_y / p->view.pixel_aspect;
    r->strength = p->model == HF_MODEL_RANGE && depth->type != HF_DEPTH_COC ? p->range.strength : 1;
    r->kernel_scale = fmax(r->strength, 0.25);
    r->blend = fmin(1, 4 * r->strength);
    if (p->engine == HF_ENGINE_CHAPTER)
        r->blend *= fmin(1, r->reach_y);
}

// Store the colour as the passes read it. Returns 1 if the picture is only copied.
static int read_colour(struct reference *r, const struct picture *colour)
{
    struct ref_buffer *input = new_buffer(r, REF_COLOUR);
    const int copy = r->rho == 0 || r->strength == 0;
    for (int c = 0; c < r->channels; c++) {
        ref_repair(input->data[c], colour->plane[c], r->width, r->height);
        for (int i = 0; i < r->width * r->height && !copy; i++)
            store(r, REF_COLOUR, c, i % r->width, i / r->width, input->data[c][i]);
    }
    return copy;
}

static void run_passes(struct reference *r, const struct hf_depth *depth, reference_hook *hook, void *cookie)
{
    coc_generation(r, depth);
    if (r->params.engine == HF_ENGINE_GATHER) {
        new_buffer(r, REF_RESULT);
        ref_area(r);
        return;
    }
    hook(cookie, r, REF_COC);
    downsample(r);
    hook(cookie, r, REF_COC4);
    hook(cookie, r, REF_COLOR4);
    hook(cookie, r, REF_COLORMULCOC4);
    window(r, REF_COC4, REF_COCMAXX, 1, 0, 0);
    hook(cookie, r, REF_COCMAXX);
    window(r, REF_COCMAXX, REF_COCMAX, 0, 1, 0);
    hook(cookie, r, REF_COCMAX);
    window(r, REF_COCMAX, REF_COCBLURX, 1, 0, 1);
    hook(cookie, r, REF_COCBLURX);
    window(r, REF_COCBLURX, REF_COCBLUR, 0, 1, 1);
    hook(cookie, r, REF_COCBLUR);
    computation(r);
    hook(cookie, r, REF_NEAR);
    hook(cookie, r, REF_FAR);
    fill(r);
    hook(cookie, r, REF_NEARFILL);
    hook(cookie, r, REF_FARFILL);
    composite(r);
}

static void no_hook(void *cookie, struct reference *r, enum ref_id id)
{
    (void)cookie;
    (void)r;
    (void)id;
}

struct reference *reference_render(const struct picture *colour, const struct hf_depth *depth,
                                   const struct hf_params *params, reference_hook *hook, void *cookie)
{
    struct reference *r = calloc(1, sizeof *r);
    r->width = colour->width;
    r->height = colour->height;
    r->half_width = (r->width + 1) / 2;
    r->half_height = (r->height + 1) / 2;
    r->channels = colour->channels;
    r->params = *params;
    set_scales(r, depth);
    ref_make_taps(r);
    if (read_colour(r, colour)) {
        new_buffer(r, REF_RESULT);
        for (int c = 0; c < r->channels; c++)
            memcpy(r->buffer[REF_RESULT].data[c], r->buffer[REF_COLOUR].data[c],
                   sizeof(double) * (size_t)r->width * (size_t)r->height);
    } else {
        run_passes(r, depth, hook ? hook : no_hook, cookie);
    }
    if (hook)
        hook(cookie, r, REF_RESULT);
    return r;
}

void reference_free(struct reference *r)
{
    if (!r)
        return;
    for (int id = 0; id < REF_COUNT; id++)
        for (int c = 0; c < 4; c++) {
            free(r->buffer[id].data[c]);
            free(r->buffer[id].raw[c]);
        }
    free(r->near_mean);
    free(r->far_mean);
    free(r->tap_x);
    free(r->tap_share);
    free(r->tap_y);
    free(r);
}

const struct ref_buffer *reference_find(const struct reference *r, const char *name)
{
    for (int id = 0; id < REF_COUNT; id++)
        if (r->buffer[id].name && strcmp(r->buffer[id].name, name) == 0)
            return &r->buffer[id];
    return NULL;
}

struct picture reference_picture(const struct reference *r)
{
    struct picture p = picture_new(r->width, r->height, r->channels);
    for (int c = 0; c < r->channels; c++)
        for (int i = 0; i < r->width * r->height; i++)
            p.plane[c][i] = (float)r->buffer[REF_RESULT].data[c][i];
    return p;
}
