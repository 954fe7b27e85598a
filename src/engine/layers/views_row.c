// SPDX-License-Identifier: BSD-3-Clause
// A row of pixels seen from many points of the lens.
#include <math.h>

#include "engine/layers/kernels.h"
#include "engine/layers/views.h"

// What a cat's eye leaves of a view at a pixel.
static float eye_at(const struct hf_view_eye *e, int v, int x)
{
    const float dx = e->point[v][0] - e->x[x], dy = e->point[v][1] - e->y;
    const float inside = 1 - sqrtf(dx * dx + dy * dy), part = inside * e->sharp + e->point[v][2];
    return part > 0 ? part < 1 ? part : 1 : 0;
}

// What a pixel sees of planes `from` to `end` in one view; returns what is left open.
static float look(const struct hf_view_row *r, int v, int x, int from, int end, float part, float open, float sum[5])
{
    for (int i = from; i < end; i++) {
        const struct hf_view_plane *p = &r->plane[i];
        const float *in = p->at + ((r->y + p->shift[v][1]) >> p->level) * p->row + x + p->shift[v][0];
        const float w = in[0] * part, a = w < open ? w : open;
        open = open - a;
        for (int c = 0; c < r->channels; c++)
            sum[c] = a * in[(c + 1) * p->channel] + sum[c];
        sum[4] = sum[4] + a;
    }
    return open;
}

void hf_layers_views_c(const struct hf_view_row *r)
{
    for (int x = r->x; x < r->x + r->n; x++) {
        float near[5] = {0}, far[5] = {0}, total = 0;
        for (int begin = 0; begin < r->views; begin += HF_LAYERS_VIEWS_SUM) {
            float near_part[5] = {0}, far_part[5] = {0};
            for (int v = begin; v < begin + HF_LAYERS_VIEWS_SUM && v < r->views; v++) {
                const float of = r->part ? r->part[v] : 1, part = r->eye ? of * eye_at(r->eye, v, x) : of,
                            own = part * r->one;
                const float open = look(r, v, x, 0, r->far, part, own, near_part);
                look(r, v, x, r->far, r->planes, part, open, far_part);
                total = total + own;
            }
            for (int c = 0; c < 5; c++) {
                near[c] = near[c] + near_part[c];
                far[c] = far[c] + far_part[c];
            }
        }
        for (int c = 0; c < 5; c++)
            if (c < r->channels || c == 4) {
                r->near[c][x - r->x] = near[c];
                r->beyond[c][x - r->x] = far[c];
            }
        if (r->eye)
            r->eye->total[x - r->x] = total;
    }
}
