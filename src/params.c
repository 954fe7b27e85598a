// SPDX-License-Identifier: BSD-3-Clause
#include "params.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "frame/engine.h"
#include "pixel/format.h"

const struct hf_params hf_default_params = {
    .engine = HF_ENGINE_GATHER,
    .model = HF_MODEL_RANGE,
    .focus_distance = 10,
    .range = HF_DERIVE,
    .strength = 1,
    .near_begin = HF_DERIVE,
    .near_end = HF_DERIVE,
    .far_begin = HF_DERIVE,
    .far_end = HF_DERIVE,
    .f_number = 2.8f,
    .focal_length_mm = 50,
    .sensor_width_mm = 36,
    .world_unit_m = 1,
    .max_radius = HF_DERIVE,
    .pixel_aspect = 1,
    .squeeze = 1,
    .iterations = 3,
};

enum { MAX_SIZE = 65536, MAX_ITERATIONS = 64, MAX_RINGS = 64 };
static const float MAX_RADIUS = 256, MAX_LENS_RADIUS = 2048;

__attribute__((format(printf, 2, 3))) static int bad(char message[HF_MESSAGE], const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(message, HF_MESSAGE, format, args);
    va_end(args);
    return HF_ERR_ARG;
}

static int check_image(const struct hf_image *m, const char *name, char message[HF_MESSAGE])
{
    if (!m)
        return bad(message, "%s is NULL", name);
    if (m->width < 1 || m->height < 1 || m->width > MAX_SIZE || m->height > MAX_SIZE)
        return bad(message, "%s is %d x %d pixels; each side must be 1 to %d", name, m->width, m->height, MAX_SIZE);
    if ((unsigned)m->format >= HF_FORMAT_COUNT)
        return bad(message, "%s.format is %d, which is no format", name, (int)m->format);
    for (int i = 0; i < hf_plane_count(m); i++) {
        if (!m->data[i])
            return bad(message, "%s.data[%d] is NULL", name, i);
        if ((size_t)llabs((long long)m->stride[i]) < hf_row_bytes(m->format, m->width) && m->height > 1)
            return bad(message, "%s.stride[%d] is %lld bytes, less than the %zu of a row", name, i,
                       (long long)m->stride[i], hf_row_bytes(m->format, m->width));
    }
    return HF_OK;
}

int hf_check_depth(const struct hf_depth *d, int width, char message[HF_MESSAGE])
{
    if (!d)
        return bad(message, "depth is NULL");
    if (!d->data)
        return bad(message, "depth.data is NULL");
    if ((size_t)llabs((long long)d->stride) < (size_t)width * 4)
        return bad(message, "depth.stride is %lld bytes, less than the %zu of a row", (long long)d->stride,
                   (size_t)width * 4);
    if ((unsigned)d->type > HF_DEPTH_COC)
        return bad(message, "depth.type is %d, which is no depth type", (int)d->type);
    const int ndc = d->type == HF_DEPTH_NDC_D3D || d->type == HF_DEPTH_NDC_GL || d->type == HF_DEPTH_NDC_REVERSED;
    if (ndc && !(d->near_plane > 0 && d->near_plane < d->far_plane && hf_is_finite(d->near_plane)))
        return bad(message, "depth.near_plane is %g and far_plane %g; they must be 0 < near < far", d->near_plane,
                   d->far_plane);
    if (d->type == HF_DEPTH_RAY &&
        !(d->focal_px > 0 && hf_is_finite(d->focal_px) && hf_is_finite(d->center_x) && hf_is_finite(d->center_y)))
        return bad(message, "depth.focal_px is %g and the centre (%g, %g); focal_px must be > 0, all finite",
                   d->focal_px, d->center_x, d->center_y);
    return HF_OK;
}

static float derive(float given, float otherwise)
{
    return given == HF_DERIVE ? otherwise : given;
}

// The range model's four distances.
struct band {
    float nb, ne, fb, fe;
};

static struct band band_of(const struct hf_params *p)
{
    const float focus = p->focus_distance, range = derive(p->range, focus / 2);
    return (struct band){derive(p->near_begin, focus - range > 0 ? focus - range : 0), derive(p->near_end, focus),
                         derive(p->far_begin, focus), derive(p->far_end, focus + range)};
}

static int check_range_model(const struct hf_params *p, char message[HF_MESSAGE])
{
    if (p->range != HF_DERIVE && !(p->range >= 0))
        return bad(message, "range is %g; it must be >= 0", p->range);
    if (!(p->strength >= 0 && p->strength <= 1))
        return bad(message, "strength is %g; it must be 0 to 1", p->strength);
    const struct band b = band_of(p);
    const int endless = p->focus_distance == INFINITY;  // autofocus where there is nothing
    if (!(b.nb >= 0 && b.nb <= b.ne && (b.ne < INFINITY || endless)))
        return bad(message, "near_begin is %g and near_end %g; they must be 0 <= begin <= end, finite", b.nb, b.ne);
    if (!(b.fb >= 0 && b.fb <= b.fe && (b.fb < INFINITY || endless)))
        return bad(message, "far_begin is %g and far_end %g; they must be 0 <= begin <= end", b.fb, b.fe);
    return HF_OK;
}

static int check_lens(const struct hf_params *p, char message[HF_MESSAGE])
{
    const float values[] = {p->focal_length_mm, p->sensor_width_mm, p->world_unit_m};
    const char *const names[] = {"focal_length_mm", "sensor_width_mm", "world_unit_m"};
    if (!(p->f_number > 0))
        return bad(message, "f_number is %g; it must be > 0", p->f_number);
    for (int i = 0; i < 3; i++)
        if (!(values[i] > 0 && hf_is_finite(values[i])))
            return bad(message, "%s is %g; it must be > 0 and finite", names[i], values[i]);
    return HF_OK;
}

static int check_options(const struct hf_params *p, char message[HF_MESSAGE])
{
    if (p->max_radius != HF_DERIVE && !(p->max_radius >= 0 && p->max_radius <= MAX_RADIUS))
        return bad(message, "max_radius is %g; it must be 0 to %g", p->max_radius, MAX_RADIUS);
    if (p->display_width < 0 || p->display_height < 0)
        return bad(message, "the display size is %d x %d; it must not be negative", p->display_width,
                   p->display_height);
    if (!(p->pixel_aspect >= 0.1f && p->pixel_aspect <= 10))
        return bad(message, "pixel_aspect is %g; it must be 0.1 to 10", p->pixel_aspect);
    if ((unsigned)p->storage > HF_STORAGE_CHAPTER)
        return bad(message, "storage is %d, which is none", (int)p->storage);
    if ((unsigned)p->fill > HF_FILL_NONE)
        return bad(message, "fill is %d, which is none", (int)p->fill);
    if ((unsigned)p->blend > HF_BLEND_SMOOTHSTEP)
        return bad(message, "blend is %d, which is none", (int)p->blend);
    if (!hf_is_finite(p->blade_rotation))
        return bad(message, "blade_rotation is %g; it must be finite", p->blade_rotation);
    return HF_OK;
}

// Autofocus: what the pixel in the middle shows, at infinity if that is nothing.
float hf_focus_of(const struct hf_params *p, const struct hf_depth *depth, int width, int height)
{
    if (p->engine != HF_ENGINE_GAUSSIAN || p->focus_distance != HF_DERIVE || depth->type == HF_DEPTH_COC)
        return p->focus_distance;
    struct hf_setup s = {.width = width, .height = height};
    int repaired;
    hf_setup_depth(&s, depth, p->pixel_aspect);
    const float z = hf_depth_surface(&s, depth, width / 2, height / 2, &repaired);
    return z < 1e10f ? z : INFINITY;
}

// Does the gaussian engine blend by the distance in depth, as its source does?
int hf_blends_by_depth(const struct hf_params *p, enum hf_depth_type type)
{
    const float given[] = {p->range, p->near_begin, p->near_end, p->far_begin, p->far_end};
    int derived = p->model == HF_MODEL_RANGE;
    for (size_t i = 0; i < sizeof given / sizeof *given; i++)
        derived &= given[i] == HF_DERIVE;
    return p->engine == HF_ENGINE_GAUSSIAN && type != HF_DEPTH_COC && (p->faithful || derived);
}

// The planes that bound its depths: those of the depth, else 1 and 100.
void hf_depth_planes(const struct hf_depth *depth, float *near, float *far)
{
    *near = depth->near_plane > 0 ? depth->near_plane : 1;
    *far = depth->far_plane > 0 && depth->far_plane < INFINITY ? depth->far_plane : 100 * *near;
}

static int check_between(const char *name, float value, float least, float most, char message[HF_MESSAGE])
{
    return value >= least && value <= most ? HF_OK
                                           : bad(message, "%s is %g; it must be %g to %g", name, value, least, most);
}

static int check_scatter(const struct hf_params *p, char message[HF_MESSAGE])
{
    if (p->blades != 0 && (p->blades < 3 || p->blades > 16))
        return bad(message, "blades is %d; it must be 0 or 3 to 16", p->blades);
    if (p->aperture && check_image(p->aperture, "aperture", message))
        return HF_ERR_ARG;
    const struct {
        const char *name;
        float value, least, most;
    } ranges[] = {{"blade_roundness", p->blade_roundness, 0, 1},
                  {"ring", p->ring, 0, 0.95f},
                  {"chromatic", p->chromatic, -0.5f, 0.5f},
                  {"cat_eye", p->cat_eye, 0, 1},
                  {"squeeze", p->squeeze, 0.25f, 4}};
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
        if (check_between(ranges[i].name, ranges[i].value, ranges[i].least, ranges[i].most, message))
            return HF_ERR_ARG;
    return HF_OK;
}

// What only some engines read is checked for those alone.
static int check_engine(const struct hf_params *p, char message[HF_MESSAGE])
{
    if (!(p->budget_ms >= 0))
        return bad(message, "budget_ms is %g; it must be >= 0", p->budget_ms);
    if (p->engine == HF_ENGINE_GATHER && (p->rings < 0 || p->rings > MAX_RINGS))
        return bad(message, "rings is %d; it must be 0 to %d", p->rings, MAX_RINGS);
    if (p->engine == HF_ENGINE_GATHER && p->blades != 0 && (p->blades < 5 || p->blades > 9))
        return bad(message, "blades is %d; it must be 0 or 5 to 9", p->blades);
    if (p->engine == HF_ENGINE_GATHER)
        return HF_OK;
    if (p->storage != HF_STORAGE_FLOAT)
        return bad(message, "storage is %d; the %s engine has float storage only", (int)p->storage,
                   hf_engine_name(p->engine));
    if ((unsigned)p->resolution > HF_RESOLUTION_QUARTER ||
        (p->resolution == HF_RESOLUTION_QUARTER && p->engine != HF_ENGINE_GAUSSIAN))
        return bad(message, "resolution is %d, which the %s engine does not have", (int)p->resolution,
                   hf_engine_name(p->engine));
    if (p->engine == HF_ENGINE_SCATTER)
        return check_scatter(p, message);
    if (p->engine == HF_ENGINE_GAUSSIAN) {
        if (p->iterations < 0 || p->iterations > MAX_ITERATIONS)
            return bad(message, "iterations is %d; it must be 0 to %d", p->iterations, MAX_ITERATIONS);
        return check_between("sigma", p->sigma, 0, MAX_RADIUS, message);
    }
    return HF_OK;
}

int hf_setup_check(const struct hf_image *dst, const struct hf_image *src, const struct hf_depth *depth,
                   const struct hf_params *p, char message[HF_MESSAGE])
{
    if (check_image(src, "src", message) || check_image(dst, "dst", message) ||
        hf_check_depth(depth, src->width, message))
        return HF_ERR_ARG;
    if (src->width != dst->width || src->height != dst->height)
        return bad(message, "dst is %d x %d pixels and src %d x %d; they must be the same", dst->width, dst->height,
                   src->width, src->height);
    if (!hf_engine_def(p->engine))
        return bad(message, "engine is %d, which is none", (int)p->engine);
    if ((unsigned)p->model > HF_MODEL_LENS)
        return bad(message, "model is %d, which is none", (int)p->model);
    if (depth->type != HF_DEPTH_COC) {
        const int autofocus = p->engine == HF_ENGINE_GAUSSIAN && p->focus_distance == HF_DERIVE;
        if (!autofocus && !(p->focus_distance > 0 && hf_is_finite(p->focus_distance)))
            return bad(message, "focus_distance is %g; it must be > 0 and finite", p->focus_distance);
        struct hf_params focused = *p;
        focused.focus_distance = hf_focus_of(p, depth, src->width, src->height);
        const int err = p->model == HF_MODEL_LENS ? check_lens(p, message) : check_range_model(&focused, message);
        if (err)
            return err;
        float near, far;
        hf_depth_planes(depth, &near, &far);
        if (hf_blends_by_depth(p, depth->type) && !(near < far))
            return bad(message, "depth.near_plane is %g and far_plane %g; near must be less than far", near, far);
    }
    const int err = check_options(p, message);
    return err ? err : check_engine(p, message);
}

// Slope of a CoC that grows from 0 to 1 over a distance. A zero distance is a step, which the steepest finite slope
// is for every pair of different floats; an infinite one is no CoC at all.
static float slope(float distance)
{
    const float i = 1 / distance;
    return i < FLT_MAX ? i : FLT_MAX;
}

static void set_coc_model(struct hf_setup *s, const struct hf_params *p, int by_depth)
{
    if (by_depth) {
        s->near_i = s->far_i = 1;  // there is blur
        return;
    }
    if (s->form == HF_FORM_COC) {
        s->near_i = s->far_i = slope(s->max_radius);
        s->radius_k = 1;
        return;
    }
    if (p->model == HF_MODEL_RANGE) {
        const struct band b = band_of(p);
        s->near_0 = b.ne;
        s->near_i = slope(b.ne - b.nb);
        s->far_0 = b.fb;
        s->far_i = slope(b.fe - b.fb);
        if (p->range == INFINITY && p->near_begin == HF_DERIVE)
            s->near_i = 0;  // the near blur would begin at 0 - and stay finite - otherwise
        return;
    }
    // r = K (1/P - 1/z); v = -1/z, so n = (-1/P - v) K / rho and f = (v - -1/P) K / rho.
    const double display_width = p->display_width ? p->display_width : s->width;
    const double aperture = p->focal_length_mm / 1000.0 / (2.0 * p->f_number) / p->world_unit_m;
    const double k = aperture * ((double)p->focal_length_mm / p->sensor_width_mm * display_width);
    s->lens = 1;
    s->near_0 = s->far_0 = s->radius_0 = -1 / p->focus_distance;
    s->near_i = s->far_i = s->max_radius > 0 ? (float)fmin(k / s->max_radius, FLT_MAX) : 0;
    s->radius_k = s->near_i > 0 ? (float)fmin(k, FLT_MAX) : 0;
}

// rho. The lens and given radii have no limit of their own but in the gather, whose reach is fixed.
static float radius_limit(const struct hf_setup *s, const struct hf_params *p)
{
    const float display_height = (float)(p->display_height ? p->display_height : s->height);
    if (p->max_radius != HF_DERIVE)
        return p->max_radius;
    if (p->engine == HF_ENGINE_HEXAGON || p->engine == HF_ENGINE_SCATTER)
        if (s->form == HF_FORM_COC || p->model == HF_MODEL_LENS)
            return MAX_LENS_RADIUS;
    return p->faithful ? 12 : fminf(12 * display_height / 1080, MAX_RADIUS);
}

void hf_setup_make(struct hf_setup *s, const struct hf_image *src, const struct hf_image *dst,
                   const struct hf_depth *depth, const struct hf_params *p, void *own)
{
    *s = (struct hf_setup){.width = src->width,
                           .height = src->height,
                           .half_width = (src->width + 1) / 2,
                           .half_height = (src->height + 1) / 2,
                           .engine = p->engine,
                           .channels = hf_min(hf_image_channels(src), hf_image_channels(dst)),
                           .storage = p->storage,
                           .colour_stats = p->colour_stats,
                           .faithful = p->faithful,
                           .no_skip = p->no_skip,
                           .smoothstep = p->blend == HF_BLEND_SMOOTHSTEP,
                           .pixel_aspect = p->pixel_aspect,
                           .resolution = p->resolution,
                           .own = own};
    hf_setup_depth(s, depth, p->pixel_aspect);
    s->max_radius = radius_limit(s, p);
    struct hf_params focused = *p;
    focused.focus_distance = hf_focus_of(p, depth, s->width, s->height);
    const int by_depth = hf_blends_by_depth(p, depth->type);
    set_coc_model(s, &focused, by_depth);
    const int range_model = s->form != HF_FORM_COC && (p->model == HF_MODEL_RANGE || by_depth);
    s->strength = range_model ? p->strength : 1;
    s->blend = s->strength >= 0.25f ? 1 : 4 * s->strength;
    if (p->engine != HF_ENGINE_GATHER && s->blend > 0)
        s->blend = 1;  // their strength is in the radius, or in the gaussian's blend factor
    const struct hf_engine_def *engine = hf_engine_def(p->engine);
    if (engine->resolve)
        engine->resolve(own, s, depth, p);
    if (s->max_radius == 0 || (s->near_i == 0 && s->far_i == 0 && !s->uniform))
        s->blend = 0;
}
