// SPDX-License-Identifier: BSD-3-Clause
// Anti-aliased silhouettes: a sharp disc before a wall of one colour. A lens changes nothing of that, because behind
// each mixed pixel the blurred wall equals the sharp one. For a mixed pixel, depth only says which of both surfaces is
// in its middle.
#include "stability/stability.h"

#define DISC 24.3
enum { SIDE = 96, FINE = 16 };

static const double light[] = {0.8, 0.5, 0.2}, dark[] = {0.06, 0.1, 0.14};

static double beyond(double x, double y, double middle)
{
    return hypot(x - middle, y - middle) - DISC;
}

// The part of a pixel that the disc covers.
static double share_of(int x, int y, double middle)
{
    const double d = beyond(x + 0.5, y + 0.5, middle);
    if (fabs(d) > 1)
        return d < 0;
    int inside = 0;
    for (int i = 0; i < FINE * FINE; i++)
        inside += beyond(x + (i % FINE + 0.5) / FINE, y + ((double)(i / FINE) + 0.5) / FINE, middle) < 0;
    return inside / (double)(FINE * FINE);
}

// The mean change of pixels up to one pixel outside the outline, in codes; *stair: how far the worst of them is from
// the wall.
static double halo_of(const struct picture *out, const struct picture *in, double middle, double wall, double *stair)
{
    double sum = 0;
    int count = 0;
    *stair = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double d = beyond(i % SIDE + 0.5, (double)(i / SIDE) + 0.5, middle), code = display_code(in->plane[0][i]);
        if (d <= 0 || d > 1)
            continue;
        sum += display_code(out->plane[0][i]) - code;
        *stair = fmax(*stair, fabs(display_code(wall) - code));
        count++;
    }
    return sum / count;
}

static void silhouette(const struct run *r, float radius, double middle, int bright)
{
    const double *front = bright ? light : dark, *back = bright ? dark : light;
    struct picture colour = picture_new(SIDE, SIDE, 3), radii = picture_new(SIDE, SIDE, 1);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double share = share_of(i % SIDE, i / SIDE, middle);
        for (int c = 0; c < 3; c++)
            colour.plane[c][i] = (float)(share * front[c] + (1 - share) * back[c]);
        radii.plane[0][i] = beyond(i % SIDE + 0.5, (double)(i / SIDE) + 0.5, middle) < 0 ? 0 : radius;
    }
    const struct hf_depth depth = picture_radii(&radii);
    struct picture out = render(r->c, &colour, &depth, &r->subject->params);
    double stair;
    const double halo = halo_of(&out, &colour, middle, back[0], &stair), worst = display_distance(&out, &colour);
    const char *disc = bright ? "bright" : "dark";
    if (r->subject->promises & UNMIXES)
        see(r, "a silhouette in focus, un-mixed: worst pixel, codes", "one code: what 8 bits show", worst, 1,
            "radius %g behind a %s disc, halo %+.2f", radius, disc, halo);
    else if (r->subject->promises & SMOOTH)
        see(r, "a silhouette in focus: worst pixel, codes", "half a stair: nearer to a smooth outline than to stairs",
            worst, stair / 2, "radius %g behind a %s disc, halo %+.2f", radius, disc, halo);
    else
        see(r, "a silhouette in focus, mixed pixels in one piece: worst pixel, codes",
            "a mean of both: their whole difference", worst, fabs(display_code(light[0]) - display_code(dark[0])),
            "radius %g behind a %s disc, halo %+.2f", radius, disc, halo);
    picture_free(&out);
    picture_free(&colour);
    picture_free(&radii);
}

void silhouettes_cases(const struct run *r)
{
    static const float radii[] = {2, 6, 12};
    for (int i = 0; i < 12; i++)
        silhouette(r, radii[i % 3], i / 3 % 2 ? 48 : 47.3, i / 6);
}
