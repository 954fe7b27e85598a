// SPDX-License-Identifier: BSD-3-Clause
// The layers engine: lamps far behind a sharp edge that cuts their discs, compared with what a lens sees of both
// surfaces.
#include <math.h>

#include "support/check.h"
#include "support/render.h"

enum { WIDTH = 320, HEIGHT = 96, LAMPS = 3, RADIUS = 16, PARTS = 8 };

static const double PI = 3.14159265358979323846, SIZE = 2.5, BOX = 0.1, WALL = 0.25;
// Heights of the lamps' middles above the edge: half of the first is hidden, a corner of the next; the last is just
// above.
static const double above[LAMPS] = {0, 2, 4};

struct lamps {
    double x[LAMPS], y[LAMPS], light;
};

// The box begins below a line that is not quite level, so its pixels are mixed with all possible shares.
static double edge(double x)
{
    return 56 + 0.06 * x;
}

// The area that two discs share.
static double common(double apart, double a, double b)
{
    const double small = fmin(a, b), large = fmax(a, b);
    if (apart >= a + b)
        return 0;
    if (apart <= large - small)
        return PI * small * small;
    const double d = (apart * apart + small * small - large * large) / (2 * apart), e = apart - d;
    return small * small * acos(d / small) - d * sqrt(small * small - d * d) + large * large * acos(e / large) -
           e * sqrt(large * large - e * e);
}

// The wall with its lamps at a point: blurred, or through a pinhole.
static double wall(const struct lamps *l, double x, double y, int blurred)
{
    double light = 0;
    for (int i = 0; i < LAMPS; i++) {
        const double apart = hypot(x - l->x[i], y - l->y[i]);
        light += blurred ? common(apart, RADIUS, SIZE) / (PI * RADIUS * RADIUS) : apart < SIZE;
    }
    return WALL + light * (l->light - WALL);
}

static double pixel(const struct lamps *l, int x, int y, int blurred)
{
    double sum = 0;
    for (int i = 0; i < PARTS * PARTS; i++) {
        const double px = x + (i % PARTS + 0.5) / PARTS, py = y + (i / PARTS + 0.5) / PARTS;
        sum += py > edge(px) ? BOX : wall(l, px, py, blurred);
    }
    return sum / (PARTS * PARTS);
}

// Whether all of a lamp's light reaches all of a pixel if nothing is before it. The margin is a pixel's half diagonal,
// and a half-resolution pixel on either side, from which discs are upsampled.
static int inside(const struct lamps *l, int i, int x, int y)
{
    return hypot(x + 0.5 - l->x[i], y + 0.5 - l->y[i]) < RADIUS - SIZE - 0.75 - 2;
}

// The back of a mixed pixel may be eight times as bright as the pixel. So the part in which the back is visible is
// found to be at least an eighth of what it is. Of the lamp that the edge cuts in half, the picture shows only half.
static void discs(struct hf_context *c, double light, enum hf_layers_quality quality)
{
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radius = picture_new(WIDTH, HEIGHT, 1);
    struct lamps l = {.light = light};
    struct hf_params p = scene_params();
    for (int i = 0; i < LAMPS; i++) {
        l.x[i] = 50.3 + 100 * i;
        l.y[i] = edge(l.x[i]) - above[i];
    }
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        const int x = k % WIDTH, y = k / WIDTH;
        radius.plane[0][k] = y + 0.5 > edge(x + 0.5) ? 0 : RADIUS;
        for (int i = 0; i < 3; i++)
            colour.plane[i][k] = (float)pixel(&l, x, y, 0);
    }
    p.engine = HF_ENGINE_LAYERS;
    p.max_radius = HF_DERIVE;
    p.layers.quality = quality;
    const struct hf_depth depth = picture_radii(&radius);
    struct picture out = render(c, &colour, &depth, &p);
    for (int i = 0; i < LAMPS; i++) {
        double least = 1;
        int at = 0;
        for (int k = 0; k < WIDTH * HEIGHT; k++) {
            const double want = inside(&l, i, k % WIDTH, k / WIDTH) ? pixel(&l, k % WIDTH, k / WIDTH, 1) : 0;
            if (!(want > 0) || out.plane[1][k] / want >= least)
                continue;
            least = out.plane[1][k] / want;
            at = k;
        }
        CHECK_MSG(least >= 0.125, "light %g, quality %d, lamp %d: %.2f of what is seen at %d, %d", light, (int)quality,
                  i, least, at % WIDTH, at / WIDTH);
    }
    picture_free(&out);
    picture_free(&colour);
    picture_free(&radius);
}

// One pixel of a lamp is left, at the rim of a sharp box and with the box's depth. The box's edge must not keep a
// speck, and the light must appear above it. A line along the rim is the box's own, lit from behind, and stays.
static void rim(struct hf_context *c, double light)
{
    enum { TOP = 60, AT = 60, FROM = 160, TO = 280 };
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radius = picture_new(WIDTH, HEIGHT, 1);
    struct hf_params p = scene_params();
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        const int x = k % WIDTH, y = k / WIDTH, lit = y == TOP && (x == AT || (x >= FROM && x < TO));
        radius.plane[0][k] = y >= TOP ? 0 : RADIUS;
        for (int i = 0; i < 3; i++)
            colour.plane[i][k] = (float)(lit ? light : y >= TOP ? BOX : WALL);
    }
    p.engine = HF_ENGINE_LAYERS;
    p.max_radius = HF_DERIVE;
    const struct hf_depth depth = picture_radii(&radius);
    struct picture out = render(c, &colour, &depth, &p);
    // At most a quarter of the pixel and of those beside it belongs to the back. There the disc is no brighter than
    // that of as many lamps as a mean of hidden samples spreads it to: 13 quads along the rim.
    const double disc = light / (PI * RADIUS * RADIUS), most = BOX + (WALL + 4 * 13 * disc) / 4;
    for (int x = AT - 2; x <= AT + 2; x++)
        CHECK_MSG(out.plane[1][TOP * WIDTH + x] <= most, "light %g: %g at %d of the rim, not %g", light,
                  out.plane[1][TOP * WIDTH + x], x, most);
    // Half of the disc, less the row between the rim and the middle of the lamp's quad, with a quarter of the light. Nothing of
    // the lamp goes on behind the box.
    const double part = 0.5 - 2 / (PI * RADIUS);
    double sum = 0;
    for (int k = 0; k < WIDTH * TOP; k++)
        sum += k % WIDTH < AT + 2 * RADIUS ? out.plane[1][k] - WALL : 0;
    CHECK_MSG(sum >= (light - WALL) / 4 * part, "light %g: %g above the rim", light, sum);
    for (int x = FROM + 4; x < TO - 4; x++)
        CHECK_MSG(fabs(out.plane[1][TOP * WIDTH + x] - light) <= 0.01 * light, "light %g: %g of the line at %d", light,
                  out.plane[1][TOP * WIDTH + x], x);
    picture_free(&out);
    picture_free(&colour);
    picture_free(&radius);
}

// A lamp of 8 x 8 pixels right beside a near bar, before a wall. From a point of the lens that lies u to one side the bar moves
// by -RADIUS u pixels and the lamp by RADIUS / 2 u, so a column of the lamp d pixels beside the bar is seen where
// u > -d / (1.5 RADIUS): a half disc and a strip of that width. Nothing of the lamp is known to be behind the bar. A guess
// that went on with it there showed 0.8 to 0.86 of the light instead of 0.61, and in best, where patterns go on, a second
// lamp elsewhere. What is guessed takes the wall's place, of a quad at the bar's edge: a quarter of a column in 8.
static void beside_bar(struct hf_context *c, double light, enum hf_layers_quality quality)
{
    enum { BAR = 100, WIDE = 24, TALL = 240 };
    struct picture colour = picture_new(WIDTH, TALL, 3), radius = picture_new(WIDTH, TALL, 1), out[2];
    struct hf_params p = scene_params();
    for (int k = 0; k < WIDTH * TALL; k++) {
        const int x = k % WIDTH, bar = x >= BAR && x < BAR + WIDE;
        radius.plane[0][k] = bar ? -RADIUS : RADIUS / 2;
        for (int i = 0; i < 3; i++)
            colour.plane[i][k] = (float)(bar ? BOX : WALL);
    }
    p.engine = HF_ENGINE_LAYERS;
    p.max_radius = HF_DERIVE;
    p.layers.quality = quality;
    const struct hf_depth depth = picture_radii(&radius);
    double gained = 0;
    for (int lit = 0; lit < 2; lit++) {
        for (int k = 0; k < 64 * lit; k++)
            for (int i = 0; i < 3; i++)
                colour.plane[i][(TALL / 2 + k / 8) * WIDTH + BAR + WIDE + k % 8] = (float)light;
        out[lit] = render(c, &colour, &depth, &p);
    }
    for (int k = 0; k < WIDTH * TALL; k++)
        gained += out[1].plane[1][k] - out[0].plane[1][k];
    double seen = 0;
    for (int i = 0; i < 8; i++) {
        const double t = (i + 0.5) / (1.5 * RADIUS);
        seen += (0.5 + (t * sqrt(1 - t * t) + asin(t)) / PI) / 8;
    }
    gained /= 64 * (light - WALL);
    CHECK_MSG(fabs(gained - seen) <= 0.25 / 8, "light %g, quality %d: %.3f of the lamp's light, not %.3f", light,
              (int)quality, gained, seen);
    struct picture *const made[] = {&colour, &radius, &out[0], &out[1]};
    for (int i = 0; i < 4; i++)
        picture_free(made[i]);
}

// A hair in focus, less than a pixel wide, runs across a lamp. The rim of the lamp's disc is as sharp as without the hair: two
// pixels outside, where half-resolution pixels would still show, each of the lamp's pixels leaves at most what is no
// highlight: twice the wall's light, and a thousandth of it for each pixel of the disc (highlights.c).
static void behind_hair(struct hf_context *c, double light)
{
    enum { SHARP = 11 };
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radius = picture_new(WIDTH, HEIGHT, 1);
    const struct lamps l = {.x = {50.3, -1000, -1000}, .y = {48.2, 0, 0}, .light = light};
    struct hf_params p = scene_params();
    int pixels = 0;
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        const double x = k % WIDTH, y = k / WIDTH, hair = 50.2 + 0.1 * (y - 48),
                     cover = fmin(fmax(0.8 - fabs(x - hair), 0), 0.6);
        const double seen = pixel(&l, (int)x, (int)y, 0);
        pixels += hypot(x + 0.5 - l.x[0], y + 0.5 - l.y[0]) < SIZE + 1;
        radius.plane[0][k] = cover > 0.5 ? 0 : SHARP;
        for (int i = 0; i < 3; i++)
            colour.plane[i][k] = (float)(cover * BOX + (1 - cover) * seen);
    }
    p.engine = HF_ENGINE_LAYERS;
    p.max_radius = HF_DERIVE;
    const struct hf_depth depth = picture_radii(&radius);
    struct picture out = render(c, &colour, &depth, &p);
    const double disc = PI * SHARP * SHARP, bound = pixels * WALL * (2 + 0.001 * disc) / disc;
    double most = 0;
    for (int k = 0; k < WIDTH * HEIGHT; k++)
        if (hypot(k % WIDTH + 0.5 - l.x[0], k / WIDTH + 0.5 - l.y[0]) > SHARP + SIZE + 2)
            most = fmax(most, out.plane[1][k] - WALL);
    CHECK_MSG(most <= bound, "light %g: %g outside of the disc, at most %g", light, most, bound);
    picture_free(&out);
    picture_free(&colour);
    picture_free(&radius);
}

// A lamp in the dark: nothing hides it, so all of its light arrives. A pixel at its edge has its depth from a point of the pixel
// that is the lamp or is not; the light of those that have the wall's may go to either. Both parts of a mixed pixel are then
// highlights against surroundings without any light.
static void in_the_dark(struct hf_context *c, double light, double size, float behind)
{
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radius = picture_new(WIDTH, HEIGHT, 1);
    struct hf_params p = scene_params();
    double given = 0, got = 0;
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        const int x = k % WIDTH, y = k / WIDTH;
        const double away = hypot(x + 0.5 - 100.3, y + 0.5 - 48.2), cover = fmin(fmax(size + 0.5 - away, 0), 1);
        radius.plane[0][k] = cover > 0.25 * (1 + (x + y) % 3) ? 8 : behind;
        for (int i = 0; i < 3; i++)
            colour.plane[i][k] = (float)(cover * light);
        given += cover * light;
    }
    p.engine = HF_ENGINE_LAYERS;
    p.max_radius = HF_DERIVE;
    const struct hf_depth depth = picture_radii(&radius);
    struct picture out = render(c, &colour, &depth, &p);
    for (int k = 0; k < WIDTH * HEIGHT; k++)
        got += out.plane[1][k];
    CHECK_MSG(fabs(got / given - 1) <= 0.01, "light %g, size %g, behind %g: %.3f of it arrives", light, size, behind,
              got / given);
    picture_free(&out);
    picture_free(&colour);
    picture_free(&radius);
}

// A lone lamp, one depth everywhere, at radii around those that a slice of full resolution shares with the next: the lamp's own
// surface hides none of its light. Sums of WIDTH * HEIGHT floats lose less than WIDTH * HEIGHT / 2^24 of them.
static void alone(struct hf_context *c, enum hf_layers_quality quality)
{
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radius = picture_new(WIDTH, HEIGHT, 1);
    struct hf_params p = scene_params();
    const double light = 1000;
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
        colour.plane[i / (WIDTH * HEIGHT)][i % (WIDTH * HEIGHT)] = (float)WALL;
    for (int i = 0; i < 3; i++)
        colour.plane[i][48 * WIDTH + 101] = (float)light;
    p.engine = HF_ENGINE_LAYERS;
    p.max_radius = HF_DERIVE;
    p.layers.quality = quality;
    for (double r = 3.9; r < 6.5; r += 0.043) {
        for (int k = 0; k < WIDTH * HEIGHT; k++)
            radius.plane[0][k] = (float)r;
        const struct hf_depth depth = picture_radii(&radius);
        struct picture out = render(c, &colour, &depth, &p);
        double got = 0;
        for (int k = 0; k < WIDTH * HEIGHT; k++)
            got += out.plane[1][k] - WALL;
        CHECK_MSG(fabs(got / (light - WALL) - 1) <= WIDTH * HEIGHT * 0x1p-24,
                  "quality %d, radius %g: %.4f of it arrives", (int)quality, r, got / (light - WALL));
        picture_free(&out);
    }
    picture_free(&colour);
    picture_free(&radius);
}

int main(void)
{
    static const double lights[] = {1.5, 30, 1000, 1e4};
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    for (int quality = HF_LAYERS_STANDARD; quality <= HF_LAYERS_BEST; quality++)
        for (int i = 0; i < 4; i++)
            discs(c, lights[i], (enum hf_layers_quality)quality);
    for (int i = 0; i < 4; i++)
        rim(c, lights[i]);
    for (int quality = HF_LAYERS_STANDARD; quality <= HF_LAYERS_BEST; quality++)
        for (int i = 1; i < 4 && quality != HF_LAYERS_DRAFT; i++)  // a draft has no hidden samples
            beside_bar(c, lights[i], (enum hf_layers_quality)quality);
    for (int i = 1; i < 4; i++)
        behind_hair(c, lights[i]);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 6; k++)
            in_the_dark(c, lights[i], 0.75 + 0.5 * (k % 3), k < 3 ? 16 : 12);
    for (int quality = HF_LAYERS_STANDARD; quality <= HF_LAYERS_BEST; quality++)
        alone(c, (enum hf_layers_quality)quality);
    hf_close(&c);
    return check_report();
}
