// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/coc.h"
#include "tools/common/report.h"

#include <math.h>
#include <stdlib.h>

// What determines the radius of a pixel.
struct model {
    const struct hf_params *p;
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
    return hf_depth_at(m->depth, m->width, m->height, x, y, &z, NULL) == HF_OK ? z : INFINITY;
}

// 0 up to begin, 1 from end on.
static float ramp(float v, float begin, float end)
{
    return v <= begin ? 0 : v >= end ? 1 : (v - begin) / (end - begin);
}

// Signed, pixels; negative in front of the focus.
static float radius_of(const struct model *m, float z)
{
    const struct hf_params *p = m->p;
    const struct hf_range_params *range = &p->range;
    float r;
    if (p->engine == HF_ENGINE_GAUSSIAN && p->gaussian.by_depth) {
        const float far_plane = m->depth->far_plane > 0 ? m->depth->far_plane : 100;
        const float d = fminf(1, z / far_plane) - fminf(1, p->focus / far_plane);
        r = copysignf(range->strength * fminf(1, 3 * fabsf(d)) * 2 * p->gaussian.sigma, d);
    } else if (p->model == HF_MODEL_LENS) {
        r = m->r->lens_k * (1 / p->focus - 1 / z);
        r = fminf(fmaxf(r, -p->max_radius), p->max_radius);
    } else {
        const float n = 1 - ramp(z, range->near_begin, range->near_end), f = ramp(z, range->far_begin, range->far_end);
        r = range->strength * p->max_radius * (f - n);
    }
    return r;
}

// *z becomes the distance, infinite where there is no surface or no distance.
static float radius_at(const struct model *m, int x, int y, float *z)
{
    *z = INFINITY;
    if (m->depth->type != HF_DEPTH_COC) {
        *z = view_depth(m, x, y);
        return radius_of(m, *z);
    }
    const float most = m->p->max_radius;
    const float r = ((const float *)m->depth->data)[(size_t)y * (size_t)m->width + (size_t)x];
    return isfinite(r) ? fminf(fmaxf(r, -most), most) : 0;
}

int cli_coc_look(struct cli_view *v, const struct cli_args *args, struct tool_error *error)
{
    struct hf_params filled = {.size = sizeof(filled)};
    struct hf_resolved resolved = {.size = sizeof(resolved)};
    const int width = v->view->width, height = v->view->height;
    const struct model m = {&filled, &resolved, &v->setup.depth, width, height};
    // Wrong settings are not reported here: the library reports them when it renders.
    if (hf_resolve(width, height, &v->setup.depth, &v->setup.params, &filled, &resolved, NULL))
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
    // The gaussian engine blurs everything equally and blends the result in; its blur reaches three standard
    // deviations.
    v->least_reach = filled.engine == HF_ENGINE_GAUSSIAN ? 3 * filled.gaussian.sigma : 0;
    v->least_radius = resolved.sharp ? 0 : INFINITY;
    // The sky counts as in focus only if the focus is infinite (or the depth holds radii).
    const int sky = m.depth->type == HF_DEPTH_COC || filled.focus == INFINITY;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            float z;
            const float r = radius_at(&m, x, y, &z);
            if (v->radii)
                v->radii[(size_t)y * (size_t)width + (size_t)x] = r;
            else if (v->least_radius < CLI_SHARP_RADIUS)
                return 0;
            if (sky || z < INFINITY)
                v->least_radius = fminf(v->least_radius, fabsf(r));
        }
    return 0;
}

int cli_coc_radii(const struct hf_depth *depth, int width, int height, const struct hf_params *params,
                  const struct hf_io_box *box, float *radii)
{
    struct hf_params filled = {.size = sizeof(filled)};
    struct hf_resolved resolved = {.size = sizeof(resolved)};
    const struct model m = {&filled, &resolved, depth, width, height};
    float z;
    if (hf_resolve(width, height, depth, params, &filled, &resolved, NULL))
        return -1;
    for (int y = box->y0; y < box->y1; y++)
        for (int x = box->x0; x < box->x1; x++)
            *radii++ = radius_at(&m, x, y, &z);
    return 0;
}

float cli_coc_largest(const struct cli_view *v)
{
    const struct tool_report *r = &v->report;
    const struct hf_params *p = &r->params;
    if (p->engine == HF_ENGINE_GAUSSIAN)
        return 2 * p->gaussian.sigma * fmaxf(v->blend[0], v->blend[1]);
    if (p->engine == HF_ENGINE_HEXAGON && p->hexagon.uniform)
        return p->max_radius;
    return fmaxf(r->all.near_radius, r->all.far_radius);
}

void cli_coc_measure(struct cli_view *v)
{
    const struct hf_params *p = &v->report.params;
    const struct model m = {p, &v->report.used, &v->setup.depth, v->view->width, v->view->height};
    const int gaussian = p->engine == HF_ENGINE_GAUSSIAN;
    float largest[2] = {0, 0};
    v->range[0] = INFINITY;
    v->range[1] = -INFINITY;
    v->blend[0] = v->blend[1] = 0;
    if (!gaussian && v->least_radius < CLI_SHARP_RADIUS && cli_coc_largest(v) >= CLI_SEEN_RADIUS)
        return;
    for (int y = 0; y < m.height; y++)
        for (int x = 0; x < m.width; x++) {
            float z;
            const float r = radius_at(&m, x, y, &z);
            largest[r > 0] = fmaxf(largest[r > 0], fabsf(r));
            if (z < INFINITY) {
                v->range[0] = fminf(v->range[0], z);
                v->range[1] = fmaxf(v->range[1], z);
            }
        }
    const float whole = p->gaussian.by_depth ? 2 * p->gaussian.sigma : p->max_radius;
    for (int i = 0; i < 2 && gaussian && !v->report.used.sharp && whole > 0; i++)
        v->blend[i] = fminf(1, largest[i] / whole);
}
