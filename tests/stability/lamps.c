// SPDX-License-Identifier: BSD-3-Clause
// Lamps that move behind sharp edges by parts of a pixel, and noise of other seeds: no pixel may stand far above all around it in
// one frame and not in the next.
#include "stability/stability.h"

#include "support/check.h"

enum { WIDTH = 96, HEIGHT = 64, FRAMES = 3 };

// A lamp of 1.4 pixels before a dark far wall, behind a sharp bar with an anti-aliased edge.
static struct scene lamp_scene(double x)
{
    struct scene s = {picture_new(WIDTH, HEIGHT, 3), picture_new(WIDTH, HEIGHT, 1)};
    const double edge = 48.4;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const int u = i % WIDTH, v = i / WIDTH;
        const double bar = fmin(1, fmax(0, u + 1 - edge)) * (u < 60 ? 1 : 0);
        const double w = fmin(u + 1, x + 1.4) - fmax(u, x), h = fmin(v + 1, 32.3 + 1.4) - fmax(v, 32.3);
        const double lamp = w > 0 && h > 0 ? 60 * w * h : 0;
        for (int c = 0; c < 3; c++)
            s.colour.plane[c][i] = (float)((1 - bar) * (0.02 + lamp) + bar * 0.2);
        s.depth.plane[0][i] = bar >= 0.5 ? STABILITY_FOCUS : 32;
    }
    return s;
}

// How far a pixel stands above all 8 around it, linear; 0 if it does not.
static double stands(const struct picture *p, int x, int y)
{
    double most = 0;
    for (int c = 0; c < 3; c++) {
        double around = 0;
        for (int k = 0; k < 9; k++)
            if (k != 4)
                around = fmax(around, p->plane[c][(y + k / 3 - 1) * p->width + x + k % 3 - 1]);
        most = fmax(most, p->plane[c][y * p->width + x] - around);
    }
    return most;
}

// The largest such height in the second of three pictures that neither of the others has within a pixel, codes from grey.
static double lone(const struct picture p[FRAMES])
{
    double worst = 0;
    for (int y = 2; y < p[1].height - 2; y++)
        for (int x = 2; x < p[1].width - 2; x++) {
            double before = 0, now = stands(&p[1], x, y);
            for (int k = 0; k < 9 && now > 0; k++)
                before = fmax(before, fmax(stands(&p[0], x + k % 3 - 1, y + k / 3 - 1),
                                           stands(&p[2], x + k % 3 - 1, y + k / 3 - 1)));
            worst = fmax(worst, display_code(now) - display_code(before));
        }
    return worst;
}

static void moving(const struct run *r, double step)
{
    struct picture p[FRAMES] = {{0}};
    struct hf_params params = r->subject->params;
    set_lens(&params, WIDTH, 14);
    for (int i = 0; i < (r->full ? 200 : 30); i++) {
        struct scene s = lamp_scene(44 + step * i);
        picture_free(&p[0]);
        p[0] = p[1], p[1] = p[2];
        p[2] = render_scene(r->c, &s, &params);
        scene_free(&s);
        if (p[0].width)
            see_look(r, "a lamp behind a sharp edge: lone pixel, codes", "a tenth of the display", lone(p), 25.5,
                     "step %g, frame %d", step, i - 1);
    }
    for (int i = 0; i < FRAMES; i++)
        picture_free(&p[i]);
}

void lamps_cases(const struct run *r)
{
    moving(r, 0.1);
    moving(r, 0.37);
}
