// SPDX-License-Identifier: BSD-3-Clause
// Which way an aperture's shape stands. A ray through the point u of a lens meets what lies behind the focus at the offset
// r u of the pixel, with r > 0, and what lies in front of it at r u with r < 0: there the shape is turned by half a turn. A
// triangle, one side of which is at +x, has its corner at -x behind the focus, and at +x in front of it.
#include <math.h>
#include <stdlib.h>

#include "support/check.h"
#include "support/render.h"

enum { SIZE = 240, LAMP = 8 };

// The mean of the light's place along an axis, less `middle`, to the power n. axis: 0 x, 1 y.
static double moment(const struct picture *p, int axis, double middle, int n)
{
    double sum = 0, all = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
        const double v = (double)p->plane[0][i];
        sum += v * pow((axis ? i / SIZE : i % SIZE) - middle, n);
        all += v;
    }
    return sum / all;
}

static double skew(const struct picture *p, int axis)
{
    const double middle = moment(p, axis, 0, 1);
    return moment(p, axis, middle, 3) / pow(moment(p, axis, middle, 2), 1.5);
}

static void stands(struct hf_context *c, const struct hf_params *p, float radius, int axis, const char *name)
{
    struct picture colour = picture_new(SIZE, SIZE, 3), coc = picture_new(SIZE, SIZE, 1);
    picture_fill(&coc, 0, radius);
    for (int i = 0; i < SIZE * SIZE; i++) {
        const int lit = abs(i % SIZE * 2 - SIZE + 1) < LAMP && abs(i / SIZE * 2 - SIZE + 1) < LAMP;
        for (int k = 0; k < 3; k++)
            colour.plane[k][i] = lit ? 10 : 0;
    }
    const struct hf_depth depth = picture_radii(&coc);
    struct picture out = render(c, &colour, &depth, p);
    const double along = skew(&out, axis), across = skew(&out, !axis);
    // A triangle has sqrt(8) / 5 = 0.566 along its axis, and 0 across it. The square that is blurred, 8 pixels wide, and the
    // engines' own kernels add at most 1/8 to the variance at a radius of 40: 0.566 / 1.125^1.5 = 0.474.
    const double want = radius < 0 ? 1 : -1;
    CHECK_MSG(want * along > 0.47 && fabs(across) < 0.02, "%s, radius %g: skew %.3f and %.3f", name, (double)radius,
              along, across);
    picture_free(&out);
    picture_free(&colour);
    picture_free(&coc);
}

int main(void)
{
    static const enum hf_engine engines[] = {HF_ENGINE_LAYERS, HF_ENGINE_SCATTER, HF_ENGINE_GATHER};
    enum { SIDE = 64 };
    static float drawn[SIDE][SIDE][3];
    // A triangle with its base at +x, like that of three blades.
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE * 3 / 4; x++)
            for (int k = 0; k < 3; k++)
                drawn[y][x][k] = abs(2 * y - SIDE + 1) < x * 1.1547f;
    const struct hf_image picture = {.size = sizeof picture,
                                     .width = SIDE,
                                     .height = SIDE,
                                     .format = HF_FORMAT_RGB32F,
                                     .data = {drawn},
                                     .stride = {sizeof drawn[0]}};
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    for (int e = 0; e < 3; e++)
        for (int near = 0; near < 2; near++) {
            const float radius = near ? -40 : 40;
            struct hf_params p = hf_default_params();
            p.engine = engines[e];
            p.model = HF_MODEL_LENS;
            p.max_radius = 40;
            p.aperture.blades = 3;
            stands(c, &p, radius, 0, hf_engine_name(p.engine));
            p.aperture.rotation = 90;
            stands(c, &p, radius, 1, hf_engine_name(p.engine));
            if (p.engine == HF_ENGINE_GATHER)
                continue;
            p.aperture.rotation = 0;
            p.aperture.blades = 0;
            p.aperture.picture = &picture;
            stands(c, &p, radius, 0, "a picture");
        }
    hf_close(&c);
    return check_report();
}
