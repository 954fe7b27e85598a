// SPDX-License-Identifier: BSD-3-Clause
// Layers against rays: several samples in each pixel, and what a lens sees of them, in double precision. The
// reference knows no slices and no coverage: it follows each ray from a point of a pixel through a point of the lens
// to the first sample that it meets. Usage: test-layers_rays [SCENES [SEED]]
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "support/check.h"
#include "support/image.h"
#include "hyperfocal/layers.h"

// Rays of a pixel. A pixel's mean of them is uncertain by at most 0.5 / sqrt(1024) = 0.016 for colours of 0 to 1 if
// the rays were random. They are spread evenly, so it is less: two sets of 1024 are over 50 dB apart.
enum { W = 150, H = 110, N = W * H, PLANES = 3, MOST = 12, RAYS = 1024 };

// Cards that stand at one radius, all of them before a wall.
struct scene {
    int planes;
    double radius[PLANES];  // front to back
    float rgb[PLANES][N][3];
    unsigned char there[PLANES][N];
};

static struct scene scene;
static struct rng rng;

static void paint_card(int p)
{
    const int left = rng_below(&rng, W), top = rng_below(&rng, H), wide = 6 + rng_below(&rng, 40),
              high = 20 + rng_below(&rng, 80), round = rng_below(&rng, 2), from = left - wide / 2, to = top - high / 2;
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            const double dx = (x - from - wide / 2.0) / (wide / 2.0), dy = (y - to - high / 2.0) / (high / 2.0);
            scene.there[p][y * W + x] |= round ? dx * dx + dy * dy < 1 : fabs(dx) < 1 && fabs(dy) < 1;
        }
}

// Each card is painted in blocks of its own colours, so that it shows where a part of it comes from.
static void paint(int planes)
{
    scene = (struct scene){.planes = planes};
    double radius = rng_range(&rng, -MOST, 4 - MOST);
    for (int p = 0; p < scene.planes; p++) {
        const int last = p == scene.planes - 1, block = 5 + rng_below(&rng, 8);
        float colours[16][3];
        for (int i = 0; i < 48; i++)
            colours[i / 3][i % 3] = rng_float(&rng);
        scene.radius[p] = radius;
        radius = fmin(radius + rng_range(&rng, 3, 10), MOST);
        for (int i = 0; i < N; i++) {
            const int at = (i % W / block * 7 + i / W / block * 5) % 16;
            for (int c = 0; c < 3; c++)
                scene.rgb[p][i][c] = colours[at][c];
            scene.there[p][i] = (unsigned char)last;
        }
        for (int n = last ? 0 : 2; n; n--)
            paint_card(p);
    }
}

// The mean of what the rays of a pixel meet. A card of radius r is met r times the lens's point from the pixel.
static void trace(double *rgb, int x, int y)
{
    rgb[0] = rgb[1] = rgb[2] = 0;
    for (int i = 0; i < RAYS; i++) {
        const double angle = i * 2.39996322972865332, far = sqrt((i + 0.5) / RAYS);
        const double u = far * cos(angle), v = far * sin(angle);
        const double px = x + fmod((i + 0.5) * 0.75487766624669276, 1),
                     py = y + fmod((i + 0.5) * 0.56984029099805327, 1);
        for (int p = 0; p < scene.planes; p++) {
            const int qx = (int)fmin(fmax(floor(px + scene.radius[p] * u), 0), W - 1);
            const int qy = (int)fmin(fmax(floor(py + scene.radius[p] * v), 0), H - 1);
            if (!scene.there[p][qy * W + qx])
                continue;
            for (int c = 0; c < 3; c++)
                rgb[c] += scene.rgb[p][qy * W + qx][c] / RAYS;
            break;
        }
    }
}

// Samples of the first `known` surfaces of each pixel.
static float red[PLANES * N], green[PLANES * N], blue[PLANES * N], alpha[PLANES * N], radius[PLANES * N];
static uint64_t first[N + 1];
static float out[4 * N];

static int render(struct hf_context *c, const struct hf_params *params, int known)
{
    uint64_t count = 0;
    for (int i = 0; i < N; i++) {
        first[i] = count;
        for (int p = 0, left = known; p < scene.planes && left; p++) {
            if (!scene.there[p][i])
                continue;
            red[count] = scene.rgb[p][i][0];
            green[count] = scene.rgb[p][i][1];
            blue[count] = scene.rgb[p][i][2];
            alpha[count] = 1;
            radius[count++] = (float)scene.radius[p];
            left--;
        }
    }
    first[N] = count;
    const struct hf_depth as = {.size = sizeof as, .type = HF_DEPTH_COC};
    const struct hf_deep deep = {sizeof deep, W, H, first, count, {red, green, blue}, alpha, radius, &as, NULL, NULL};
    const struct hf_image image = {.size = sizeof image,
                                   .width = W,
                                   .height = H,
                                   .format = HF_FORMAT_RGBA32F,
                                   .data = {out},
                                   .stride = {W * 4 * sizeof(float)}};
    return hf_render_deep(c, &image, &deep, params, NULL);
}

// The mean squared distance from the rays, of pixels whose light comes from inside the frame.
static double apart(double (*truth)[3])
{
    double sum = 0;
    for (int y = MOST + 2; y < H - MOST - 2; y++)
        for (int x = MOST + 2; x < W - MOST - 2; x++)
            for (int c = 0; c < 3; c++) {
                const double d = out[4 * (y * W + x) + c] - truth[y * W + x][c];
                sum += d * d;
            }
    return sum / (3.0 * (W - 2 * MOST - 4) * (H - 2 * MOST - 4));
}

static double decibels(double squared)
{
    return -10 * log10(squared);
}

int main(int argc, char **argv)
{
    const int scenes = argc > 1 ? (int)fmax(atoi(argv[1]), 2) : check_long() ? 40 : 6;
    static double truth[N][3];
    struct hf_context *context = NULL;
    struct hf_params params = hf_default_params();
    params.engine = HF_ENGINE_LAYERS;
    params.focus = 1;
    rng = rng_seed(argc > 2 ? (uint64_t)atoi(argv[2]) : 1);
    CHECK_INT(hf_open(&context, NULL), HF_OK);
    double wall = 0, known[PLANES] = {0};  // the worst of walls alone; means of scenes with cards
    const int with_cards = scenes - (scenes + 2) / 3;
    for (int n = 0; n < scenes; n++) {
        const int planes = n % 3 + 1;
        paint(planes);
        for (int i = 0; i < N; i++)
            trace(truth[i], i % W, i / W);
        for (int surfaces = 1; surfaces <= planes; surfaces++) {
            CHECK_INT(render(context, &params, surfaces), HF_OK);
            const double squared = apart(truth);
            if (planes == 1)
                wall = fmax(squared, wall);
            else if (surfaces < 3)
                known[surfaces] += squared / with_cards;
        }
    }
    hf_close(&context);
    // A wall alone has nothing to hide: what is left are the rays' noise and the slices, 42 to 55 dB.
    CHECK_MSG(decibels(wall) > 40, "a wall alone is %.2f dB from what rays see", decibels(wall));
    // Slices do not know which part of the lens a card covers, so cards that cross are 33 to 42 dB from the rays with
    // all surfaces known, and 30 to 42 dB where what they hide must be guessed: over scenes the squared error falls
    // to 0.35 to 0.5 of that. A second surface that is put in the wrong place or half lost would bring it back to 1.
    CHECK_MSG(known[2] < 0.65 * known[1], "two surfaces are %.2f dB from what rays see, one is %.2f",
              decibels(known[2]), decibels(known[1]));
    CHECK_MSG(decibels(known[2]) > 33, "two surfaces are %.2f dB from what rays see", decibels(known[2]));
    return check_report();
}
