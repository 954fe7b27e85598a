// SPDX-License-Identifier: BSD-3-Clause
// Radii of circles of confusion, from the numbers that hf_resolve works out.
#include "hfpy.h"

#include <math.h>

// 0 up to begin, 1 from end on.
static float ramp(float v, float begin, float end, enum hf_blend blend)
{
    const float t = v <= begin ? 0 : v >= end ? 1 : (v - begin) / (end - begin);
    return blend == HF_BLEND_SMOOTHSTEP ? t * t * (3 - 2 * t) : t;
}

// Signed, pixels; negative in front of the focus.
static float radius(const struct hf_params *p, const struct hf_resolved *r, float z)
{
    const struct hf_range_params *range = &p->range;
    if (p->model == HF_MODEL_LENS)
        return fminf(fmaxf(r->lens_k * (1 / p->focus - 1 / z), -p->max_radius), p->max_radius);
    const float near = 1 - ramp(z, range->near_begin, range->near_end, range->blend);
    const float far = ramp(z, range->far_begin, range->far_end, range->blend);
    return range->strength * p->max_radius * (far - near);
}

static void fill(const struct hfpy_given *g, const struct hf_params *p, const struct hf_resolved *r,
                 struct hfpy_pixels *to)
{
    for (int y = 0; y < to->height; y++)
        for (int x = 0; x < to->width; x++) {
            float z;
            float *at = (float *)(void *)(to->at[0] + y * to->row[0] + x * to->column[0]);
            if (g->depth.type == HF_DEPTH_COC) {
                const float given =
                    *(const float *)(const void *)((const char *)g->depth.data + y * g->depth.stride + x * 4);
                *at = isfinite(given) ? fminf(fmaxf(given, -p->max_radius), p->max_radius) : 0;
            } else {
                *at =
                    radius(p, r, hf_depth_at(&g->depth, to->width, to->height, x, y, &z, NULL) == HF_OK ? z : INFINITY);
            }
        }
}

static int work(struct hfpy_given *g, struct hfpy_pixels *z, struct hfpy_pixels *to)
{
    struct hf_params p = {.size = sizeof p};
    struct hf_resolved r = {.size = sizeof r};
    struct hf_message message = {.size = sizeof message};
    if (to->type != 'f' || to->swapped || to->width != z->width || to->height != z->height ||
        hfpy_overlaps_itself(to) || (size_t)to->at[0] % 4 || to->row[0] % 4 || to->column[0] % 4) {
        PyErr_SetString(PyExc_ValueError, "out must be an array of float32 of the size of depth");
        return -1;
    }
    if (hfpy_depth(z, hfpy_overlap(z, to), &g->depth) || hfpy_choose(g, z->height, NULL))
        return -1;
    if (g->depth.type == HF_DEPTH_COC && g->depth.format != HF_DEPTH_FORMAT_FLOAT32) {
        PyErr_SetString(PyExc_ValueError, "depth must have float32 where it holds radii");
        return -1;
    }
    int error;
    Py_BEGIN_ALLOW_THREADS error = hf_resolve(z->width, z->height, &g->depth, &g->params, &p, &r, &message);
    if (!error)
        fill(g, &p, &r, to);
    Py_END_ALLOW_THREADS if (error) hfpy_raise(error, &message);
    return error ? -1 : 0;
}

PyObject *hfpy_coc(PyObject *module, PyObject *args, PyObject *kwargs)
{
    struct hfpy_given g;
    struct hfpy_pixels z = {0}, to = {0};
    PyObject *out = NULL;
    int failed = 1;
    (void)module;
    if (!hfpy_read(&g, "coc", args, kwargs, 0, HFPY_DEPTH | HFPY_OUT) &&
        !hfpy_open_plane(&z, g.depth_map, "depth", 0)) {
        out = g.out ? Py_NewRef(g.out) : hfpy_new_plane(g.depth_map, z.height, z.width);
        failed = !out || hfpy_open_plane(&to, out, "out", 1) || work(&g, &z, &to);
    }
    hfpy_close(&to);
    hfpy_close(&z);
    hfpy_release(&g);
    if (failed)
        Py_CLEAR(out);
    return out;
}
