// SPDX-License-Identifier: BSD-3-Clause
// The layers engine: lamps behind blurred things, which cut their discs with sharp edges. The reference follows rays from a
// pixel to the lamp, and knows no slices.
#include <math.h>

#include "support/check.h"
#include "support/render.h"

enum { WIDTH = 192, HEIGHT = 144, PARTS = 8 };

static const double PI = 3.14159265358979323846, SIZE = 2.5, LIGHT = 300, WALL = 0.2, CARD = 0.1;

// A lamp of radius `lamp` at (x, y), and something of radius `card` before it: all that lies left of a slanted line, or a
// band.
struct view {
    double lamp, card, x, y, slope, band;
};

// What covers the point (x, y) of the picture: left of the line through the frame's middle.
static int is_card(const struct view *v, double x, double y)
{
    const double from = x - WIDTH / 2.0 - v->slope * (y - HEIGHT / 2.0);
    return from < 0 && (v->band == 0 || from > -v->band);
}

// The lamp's light at a point of the picture, of that of its whole disc: a ray from (x, y) to the lamp's point (s, t) passes the
// lens at ((s, t) - (x, y)) / lamp, and the card's sample that it meets is that point times the card's radius away.
enum what { SEEN, DISC, FREE };  // the light; without the card; and without the end of the disc

static double lit(const struct view *v, double x, double y, enum what what)
{
    double sum = 0;
    int count = 0;
    for (int i = 0; i < PARTS * PARTS; i++) {
        const double s = ((i % PARTS + 0.5) / PARTS * 2 - 1) * SIZE, t = ((i / PARTS + 0.5) / PARTS * 2 - 1) * SIZE;
        if (hypot(s, t) > SIZE)
            continue;
        count++;
        const double dx = v->x + s - x, dy = v->y + t - y, part = v->card / v->lamp;
        sum +=
            (what == FREE || hypot(dx, dy) <= v->lamp) && (what == DISC || !is_card(v, x + dx * part, y + dy * part));
    }
    return sum / count;
}

static struct picture show(struct hf_context *c, const struct view *v, double light, enum hf_layers_quality quality)
{
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radius = picture_new(WIDTH, HEIGHT, 1);
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        double sum = 0, middle = 0;
        for (int i = 0; i < PARTS * PARTS; i++) {
            const double x = k % WIDTH + (i % PARTS + 0.5) / PARTS, y = k / WIDTH + (i / PARTS + 0.5) / PARTS;
            const int lamp = hypot(x - v->x, y - v->y) < SIZE;
            sum += is_card(v, x, y) ? CARD : lamp ? light : WALL;
            middle += is_card(v, x, y);
        }
        radius.plane[0][k] = (float)(2 * middle > PARTS * PARTS ? v->card : v->lamp);
        for (int i = 0; i < 3; i++)
            colour.plane[i][k] = (float)(sum / (PARTS * PARTS));
    }
    struct hf_params p = scene_params();
    p.engine = HF_ENGINE_LAYERS;
    p.max_radius = HF_DERIVE;
    p.layers.quality = quality;
    p.layers.no_hidden = 1;  // what hidden samples guess of a lamp is no part of the lamp
    const struct hf_depth depth = picture_radii(&radius);
    struct picture out = render(c, &colour, &depth, &p);
    picture_free(&colour);
    picture_free(&radius);
    return out;
}

// The least and most of the lamp's light around a pixel.
static void around(const double *want, int x, int y, int n, double *least, double *most)
{
    *least = 1;
    *most = 0;
    for (int j = y - n; j <= y + n; j++)
        for (int i = x - n; i <= x + n; i++) {
            *least = fmin(*least, want[j * WIDTH + i]);
            *most = fmax(*most, want[j * WIDTH + i]);
        }
}

// What the lamp adds to the picture is 0 where no ray reaches it and its whole disc where all do. Around the line between them
// it is unsure: coverage is that of quads and is looked up between their middles, and so is what is left of the disc, 2 pixels
// each at most, of which a card between two slices adds less than one. The lamp stands for its middle, 2.5 pixels from its rim,
// which moves the line by 1.5 at most.
//
// A part of each of the lamp's pixels stays in its slice: (2 + 33^2 * 0.001 * pi) times the wall at most, that is 0.4 % of
// LIGHT, on 33 pixels for 19.6 whole ones, 0.6 %. It is blurred with the wall, which lacks what the card hides, and divided by
// the coverage that is left, a quarter or more beside the card: 2.5 %. The light as a whole is as much off, and as two lines
// across the disc, 4 radii in all, a sixth of a pixel away are.
static void cut(struct hf_context *c, const struct view *v, enum hf_layers_quality quality)
{
    enum { UNSURE = 5 };
    static double want[WIDTH * HEIGHT], open[WIDTH * HEIGHT], clear[WIDTH * HEIGHT];
    struct picture with = show(c, v, LIGHT, quality), without = show(c, v, WALL, quality);
    const double disc = (LIGHT - WALL) * SIZE * SIZE / (v->lamp * v->lamp);
    double left = 0, lost = 0, total = 0, seen = 0;
    int dark = 0, bright = 0;
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        want[k] = lit(v, k % WIDTH + 0.5, k / WIDTH + 0.5, SEEN);
        open[k] = lit(v, k % WIDTH + 0.5, k / WIDTH + 0.5, DISC);
        clear[k] = lit(v, k % WIDTH + 0.5, k / WIDTH + 0.5, FREE);
    }
    for (int y = UNSURE; y < HEIGHT - UNSURE; y++)
        for (int x = UNSURE; x < WIDTH - UNSURE; x++) {
            const int k = y * WIDTH + x;
            const double got = (with.plane[1][k] - without.plane[1][k]) / disc;
            double least, most, full, unused;
            around(clear, x, y, UNSURE, &least, &most);
            around(open, x, y, UNSURE, &full, &unused);
            total += want[k];
            seen += got;
            if (most == 0) {
                left = fmax(left, got);
                dark += open[k] == 1;
            } else if (least == 1 && full == 1) {
                lost = fmax(lost, 1 - got);
                bright++;
            }
        }
    printf("lamp %g, card %g, slope %g, band %g, quality %d: %d dark with %.4f, %d bright without %.4f, energy %.3f\n",
           v->lamp, v->card, v->slope, v->band, (int)quality, dark, left, bright, lost, seen / total);
    CHECK_MSG(left <= 0.025, "lamp %g, card %g: %g of its disc where nothing is seen", v->lamp, v->card, left);
    CHECK_MSG(fabs(seen / total - 1) <= 0.025 + 4 / (6 * PI * v->lamp), "lamp %g, card %g: %g of its light", v->lamp,
              v->card, seen / total);
    CHECK_MSG(lost <= 0.025, "lamp %g, card %g: %g of its disc lost where all is seen", v->lamp, v->card, lost);
    picture_free(&with);
    picture_free(&without);
}

int main(void)
{
    static const double lamps[] = {12, 21.3, 33}, cards[] = {-30, -17.7, -8}, slopes[] = {0, 0.3, -1.2};
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    for (int i = 0; i < 27; i++) {
        const struct view v = {.lamp = lamps[i / 9],
                               .card = cards[i / 3 % 3],
                               .slope = slopes[i % 3],
                               .band = i % 2 ? 0 : 26,
                               .x = WIDTH / 2.0 + 5.3 + 4 * hypot(1, slopes[i % 3]),
                               .y = HEIGHT / 2.0 + 3.7};
        cut(c, &v, (enum hf_layers_quality)(i % 3 + 1));
    }
    hf_close(&c);
    return check_report();
}
