// SPDX-License-Identifier: BSD-3-Clause
#include "cli/coc.h"

#include <math.h>
#include <stdlib.h>

// What a radius follows from.
struct model {
    const struct hf_resolved *r;
    const struct hf_depth *depth;
    int width, height;
};

// Infinite where there is no surface.
static float view_depth(const struct model *m, int x, int y)
{
    float z;
    if (m->depth->type == HF_DEPTH_VIEW) {
        z = ((const float *)m->depth->data)[(size_t)y * (size_t)m->width + (size_t)x];
        return z > 0 && z < 1e10f ? z : INFINITY;
    }
    return hf_depth_at(m->depth, m->width, m->height, x, y, &z) == HF_OK ? z : INFINITY;
}

// 0 up to begin, 1 from end on.
static float ramp(float v, float begin, float end)
{
    return v <= begin ? 0 : v >= end ? 1 : (v - begin) / (end - begin);
}

// Signed, pixels; negative in front of the focus.
static float radius_of(const struct model *m, float z)
{
    const struct hf_params *p = &m->r->params;
    const struct hf_range_params *range = &p->range;
    float r;
    if (p->engine == HF_ENGINE_GAUSSIAN && p->gaussian.by_depth) {
        const float far_plane = m->depth->far_plane > 0 ? m->depth->far_plane : 100;
        const float d = fminf(1, z / far_plane) - fminf(1, p->focus / far_plane);
        r = copysignf(fminf(1, 3 * fabsf(d)) * 2 * p->gaussian.sigma, d);
    } else if (p->model == HF_MODEL_LENS) {
        r = m->r->lens_k * (1 / p->focus - 1 / z);
        r = fminf(fmaxf(r, -p->max_radius), p->max_radius);
    } else {
        const float n = 1 - ramp(z, range->near_begin, range->near_end), f = ramp(z, range->far_begin, range->far_end);
        r = range->strength * p->max_radius * (f - n);
    }
    return r;
}

static float radius_at(const struct model *m, int x, int y)
{
    if (m->depth->type != HF_DEPTH_COC)
        return radius_of(m, view_depth(m, x, y));
    const float most = m->r->params.max_radius;
    const float r = ((const float *)m->depth->data)[(size_t)y * (size_t)m->width + (size_t)x];
    return isfinite(r) ? fminf(fmaxf(r, -most), most) : 0;
}

int cli_coc_look(struct cli_view *v, const struct cli_args *args, struct tool_error *error)
{
    struct hf_resolved resolved;
    const int width = v->view->width, height = v->view->height;
    const struct model m = {&resolved, &v->setup.depth, width, height};
    // What is wrong with the settings is the library's to say.
    if (hf_resolve(width, height, &v->setup.depth, &v->setup.params, &resolved, NULL, 0))
        return 0;
    const struct hf_io_box *data = &v->view->data_window, *display = &v->view->display_window;
    const int inside =
        data->x0 > display->x0 || data->y0 > display->y0 || data->x1 < display->x1 || data->y1 < display->y1;
    free(v->radii);
    v->radii = NULL;
    if (args->focus_image || args->grow || inside) {
        v->radii = malloc((size_t)width * (size_t)height * sizeof(float));
        if (!v->radii)
            return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", v->label);
    }
    v->far_away = m.depth->type == HF_DEPTH_COC ? 0 : fabsf(radius_of(&m, INFINITY));
    // What the gaussian engine blurs at all it blurs alike, and blends: three standard deviations far.
    v->least_reach = resolved.params.engine == HF_ENGINE_GAUSSIAN ? 3 * resolved.params.gaussian.sigma : 0;
    v->least_radius = resolved.sharp ? 0 : INFINITY;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const float r = radius_at(&m, x, y);
            if (v->radii)
                v->radii[(size_t)y * (size_t)width + (size_t)x] = r;
            else if (v->least_radius < CLI_SHARP_RADIUS)
                return 0;
            v->least_radius = fminf(v->least_radius, fabsf(r));
        }
    return 0;
}
