// SPDX-License-Identifier: BSD-3-Clause
#include "frame/resolve.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

#include "pass/engine.h"
#include "frame/check.h"
#include "pixel/depth.h"
#include "pixel/format.h"
#include "pixel/highlight.h"
#include "pixel/limits.h"

enum { MAX_BLADES = 16 };

static float derive(float given, float otherwise)
{
    return given == HF_DERIVE ? otherwise : given;
}

static int is_lens(const struct hf_params *p, const struct hf_depth *depth)
{
    return p->model == HF_MODEL_LENS && depth->type != HF_DEPTH_COC;
}

static int check_range_model(struct hf_settings *r, struct hf_message *message)
{
    struct hf_range_params *p = &r->params.range;
    if (p->distance != HF_DERIVE && !(p->distance >= 0))
        return hf_bad(message, "range.distance", "is %g; it must be >= 0", p->distance);
    if (!(p->strength >= 0 && p->strength <= 1))
        return hf_bad(message, "range.strength", "is %g; it must be 0 to 1", p->strength);
    const float focus = r->params.focus;
    const float range = p->distance = derive(p->distance, focus / 2);
    // With an endless range, near blur would otherwise begin at 0 and stay finite.
    p->near_begin = derive(p->near_begin, range == INFINITY ? -INFINITY : focus - range > 0 ? focus - range : 0);
    p->near_end = derive(p->near_end, focus);
    p->far_begin = derive(p->far_begin, focus);
    p->far_end = derive(p->far_end, focus + range);
    const int endless = focus == INFINITY;  // autofocus where there is no surface
    const float nb = p->near_begin == -INFINITY ? 0 : p->near_begin;
    if (!(nb >= 0 && nb <= p->near_end && (p->near_end < INFINITY || endless)))
        return hf_bad(message, "range.near_begin",
                      "is %g and near blur ends at %g; they must be 0 <= begin <= end, finite", nb, p->near_end);
    if (!(p->far_begin >= 0 && p->far_begin <= p->far_end && (p->far_begin < INFINITY || endless)))
        return hf_bad(message, "range.far_begin", "is %g and far blur is full at %g; they must be 0 <= begin <= end",
                      p->far_begin, p->far_end);
    if (p->near_end > p->far_begin)
        return hf_bad(message, "range.near_end",
                      "is %g; it must be at most %g, where far blur begins: no surface is near and far at once",
                      p->near_end, p->far_begin);
    return HF_OK;
}

static int check_lens(const struct hf_lens_params *p, struct hf_message *message)
{
    const float values[] = {p->focal_length_mm, p->sensor_width_mm, p->world_unit_m};
    const char *const names[] = {"lens.focal_length_mm", "lens.sensor_width_mm", "lens.world_unit_m"};
    if (!(p->f_number > 0))
        return hf_bad(message, "lens.f_number", "is %g; it must be > 0", p->f_number);
    for (int i = 0; i < 3; i++)
        if (!(values[i] > 0 && hf_is_finite(values[i])))
            return hf_bad(message, names[i], "is %g; it must be > 0 and finite", values[i]);
    return HF_OK;
}

// What an aperture picture makes ineffective.
enum { SHAPES = HF_APERTURE_BLADES | HF_APERTURE_ROUNDNESS | HF_APERTURE_RING | HF_APERTURE_CAT_EYE };

// Whether the values are in range, and the engine can draw them.
static int check_aperture(const struct hf_aperture_params *p, const struct hf_engine_def *e, struct hf_message *message)
{
    if (p->blades != 0 && (p->blades < 3 || p->blades > MAX_BLADES))
        return hf_bad(message, "aperture.blades", "is %d; it must be 0 or 3 to %d", p->blades, MAX_BLADES);
    if (!hf_is_finite(p->rotation))
        return hf_bad(message, "aperture.rotation", "is %g; it must be finite", p->rotation);
    const struct {
        const char *name;
        float value, neutral, least, most;
        unsigned bit;
    } rows[] = {{"aperture.blades", (float)p->blades, 0, 0, MAX_BLADES, HF_APERTURE_BLADES},
                {"aperture.roundness", p->roundness, 0, 0, 1, HF_APERTURE_ROUNDNESS},
                {"aperture.ring", p->ring, 0, 0, 0.95f, HF_APERTURE_RING},
                {"aperture.cat_eye", p->cat_eye, 0, 0, 1, HF_APERTURE_CAT_EYE},
                {"aperture.squeeze", p->squeeze, 1, 0.25f, 4, HF_APERTURE_SQUEEZE},
                {"aperture.chromatic", p->chromatic, 0, -0.5f, 0.5f, HF_APERTURE_CHROMATIC}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const char *name = rows[i].name;
        if (hf_check_between(name, rows[i].value, rows[i].least, rows[i].most, message))
            return HF_ERR_ARG;
        if (rows[i].value != rows[i].neutral && !(e->limits.aperture & rows[i].bit))
            return hf_bad(message, name, "is %g; the %s engine cannot draw that", rows[i].value, e->name);
        if (rows[i].value != rows[i].neutral && p->picture && (rows[i].bit & SHAPES))
            return hf_bad(message, name, "is %g beside a picture of the aperture, which is the whole shape",
                          rows[i].value);
    }
    if (!p->picture)
        return HF_OK;
    if (!(e->limits.aperture & HF_APERTURE_PICTURE))
        return hf_bad(message, "aperture.picture", "is given; the %s engine cannot draw it", e->name);
    return hf_check_image(p->picture, "aperture.picture", message);
}

static int check_view(struct hf_settings *r, struct hf_message *message)
{
    struct hf_view_params *v = &r->params.view;
    if (v->display_width == HF_DERIVE)
        v->display_width = r->width;
    if (v->display_height == HF_DERIVE)
        v->display_height = r->height;
    if (v->display_width < 1)
        return hf_bad(message, "view.display_width", "is %d; it must be at least 1", v->display_width);
    if (v->display_height < 1)
        return hf_bad(message, "view.display_height", "is %d; it must be at least 1", v->display_height);
    return hf_check_between("view.pixel_aspect", v->pixel_aspect, 0.1f, 10, message);
}

static int check_focus(struct hf_settings *r, const struct hf_depth *depth, const struct hf_engine_def *e,
                       struct hf_message *message)
{
    struct hf_params *p = &r->params;
    if (p->focus == HF_DERIVE) {
        struct hf_setup s = {.width = r->width, .height = r->height};
        int repaired;
        const int err = hf_check_depth(depth, r->width, message);
        if (err)
            return err;
        hf_setup_depth(&s, depth, p->view.pixel_aspect);
        const float z = hf_depth_surface(&s, depth, r->width / 2, r->height / 2, &repaired);
        p->focus = z > 0 && z < 1e10f ? z : INFINITY;  // along a ray it may be 0
        if (p->focus == INFINITY && !e->limits.focus_anywhere) {
            hf_bad(message, "focus", "is to be read at pixel (%d, %d), where there is no surface", r->width / 2,
                   r->height / 2);
            return message->error = HF_ERR_FOCUS;
        }
        return HF_OK;
    }
    // A lens may be focused at infinity: 1 / focus is 0 then.
    if (p->focus > 0 && (hf_is_finite(p->focus) || p->model == HF_MODEL_LENS))
        return HF_OK;
    return hf_bad(message, "focus",
                  p->model == HF_MODEL_LENS ? "is %g; it must be > 0" : "is %g; it must be > 0 and finite", p->focus);
}

// The limit of the radius, before the engine's own.
static int check_radius(struct hf_settings *r, const struct hf_depth *depth, struct hf_message *message)
{
    struct hf_params *p = &r->params;
    if (p->max_radius != HF_DERIVE) {
        r->limit = HF_LIMIT_GIVEN;
        return hf_check_between("max_radius", p->max_radius, 0, HF_MAX_RADIUS, message);
    }
    r->limit = depth->type == HF_DEPTH_COC || p->model == HF_MODEL_LENS ? HF_LIMIT_NONE : HF_LIMIT_MODEL;
    p->max_radius = hf_asked_radius(p, depth->type, p->view.display_height);
    return HF_OK;
}

// Focal length in pixels of x.
static double lens_focal_px(const struct hf_params *p)
{
    return (double)p->lens.focal_length_mm / p->lens.sensor_width_mm * p->view.display_width;
}

// K in pixels of y. These are smaller than those of x if pixels are wide, because the sensor is as wide as the picture.
static double lens_k(const struct hf_params *p)
{
    const double aperture = p->lens.focal_length_mm / 1000.0 / (2.0 * p->lens.f_number) / p->lens.world_unit_m;
    return aperture * lens_focal_px(p) * p->view.pixel_aspect;
}

// The slope of a CoC that grows from 0 to 1 over a distance. A zero distance is a step; the steepest finite slope is
// one for every pair of different floats. With an infinite distance there is no CoC.
static float slope(float distance)
{
    const float i = 1 / distance;
    return i < FLT_MAX ? i : FLT_MAX;
}

static void set_coc_model(struct hf_setup *s, const struct hf_params *p)
{
    const struct hf_range_params *b = &p->range;
    if (s->form == HF_FORM_COC) {
        s->near_i = s->far_i = slope(s->max_radius);
        s->radius_k = 1;
        return;
    }
    if (p->model == HF_MODEL_RANGE) {
        s->near_0 = b->near_end;
        s->near_i = slope(b->near_end - b->near_begin);
        s->far_0 = b->far_begin;
        s->far_i = slope(b->far_end - b->far_begin);
        return;
    }
    // r = K (1/P - 1/z); v = -1/z, so n = (-1/P - v) K / rho and f = (v - -1/P) K / rho.
    const double k = lens_k(p);
    s->lens = 1;
    s->near_0 = s->far_0 = s->radius_0 = -1 / p->focus;
    s->near_i = s->far_i = s->max_radius > 0 ? (float)fmin(k / s->max_radius, FLT_MAX) : 0;
    s->radius_k = s->near_i > 0 ? (float)fmin(k, FLT_MAX) : 0;
}

// The conversion from depth to CoC, as far as all engines share it.
static void set_coc(struct hf_setup *s, const struct hf_settings *r, const struct hf_depth *depth)
{
    const struct hf_params *p = &r->params;
    s->max_radius = p->max_radius;
    hf_setup_depth(s, depth, p->view.pixel_aspect);
    set_coc_model(s, p);
    s->strength = s->form != HF_FORM_COC && p->model == HF_MODEL_RANGE ? p->range.strength : 1;
}

int hf_params_resolve(struct hf_settings *r, int width, int height, const struct hf_depth *depth,
                      const struct hf_params *params, struct hf_message *message)
{
    *r = (struct hf_settings){.params = *params, .width = width, .height = height};
    struct hf_params *p = &r->params;
    const struct hf_engine_def *e = hf_engine_def(p->engine);
    if (width < 1 || height < 1 || width > HF_MAX_SIZE || height > HF_MAX_SIZE)
        return hf_bad(message, NULL, "the picture is %d x %d pixels; each side must be 1 to %d", width, height,
                      HF_MAX_SIZE);
    int err = hf_check_value("engine", (int)p->engine, 0, HF_ENGINE_COUNT - 1, message);
    if (!err)
        err = hf_check_value("model", (int)p->model, 0, HF_MODEL_LENS, message);
    if (!err)
        err = hf_check_value("range.blend", (int)p->range.blend, 0, HF_BLEND_SMOOTHSTEP, message);
    if (!err && !(p->run.budget_ms >= 0))
        err = hf_bad(message, "run.budget_ms", "is %g; it must be >= 0", p->run.budget_ms);
    if (!err)
        err = hf_check_depth_type(depth, message);
    if (!err)
        err = check_view(r, message);
    if (!err && depth->type != HF_DEPTH_COC) {
        err = check_focus(r, depth, e, message);
        if (!err)
            err = is_lens(p, depth) ? check_lens(&p->lens, message) : check_range_model(r, message);
    }
    if (!err)
        err = check_radius(r, depth, message);
    if (!err)
        err = check_aperture(&p->aperture, e, message);
    if (!err)
        err = hf_check_between("highlight.gain", p->highlight.gain, 1, 64, message);
    if (!err && p->highlight.gain > 1)
        err = hf_check_between("highlight.threshold", p->highlight.threshold, 0, 0.99f, message);
    if (err)
        return err;
    p->aperture.rotation = fmodf(p->aperture.rotation, 360);
    if (is_lens(p, depth)) {
        r->focal_px = (float)lens_focal_px(p);
        r->lens_k = (float)fmin(lens_k(p), FLT_MAX);
    }
    struct hf_setup s = {.width = width, .height = height};
    set_coc(&s, r, depth);
    r->sharp = s.max_radius == 0 || s.strength == 0 || (s.near_i == 0 && s.far_i == 0);
    return e->limits.check ? e->limits.check(r, params, depth, message) : HF_OK;
}

void hf_setup_make(struct hf_setup *s, const struct hf_image *src, const struct hf_image *dst,
                   const struct hf_depth *depth, const struct hf_settings *r, void *own)
{
    const struct hf_params *p = &r->params;
    *s = (struct hf_setup){.width = src->width,
                           .height = src->height,
                           .half_width = (src->width + 1) / 2,
                           .half_height = (src->height + 1) / 2,
                           .region = {0, 0, src->width, src->height},
                           .engine = p->engine,
                           .channels = hf_min(hf_image_channels(src), hf_image_channels(dst)),
                           .smoothstep = p->range.blend == HF_BLEND_SMOOTHSTEP,
                           .pixel_aspect = p->view.pixel_aspect,
                           .highlight = hf_highlight_of(&p->highlight),
                           .resolved = r,
                           .own = own};
    set_coc(s, r, depth);
    const struct hf_engine_def *e = hf_engine_def(p->engine);
    s->measured = e->own.measure != NULL;
    if (e->own.resolve)
        e->own.resolve(own, s, depth, p);
}
