// SPDX-License-Identifier: BSD-3-Clause
// Two distances that need no ray-traced truth: from the same algorithm in double precision, and from the published
// demo. Both use a small scene that has CoC radii instead of depth, so that every engine blurs equally.
#include "tradeoff_run.h"

#include "support/image.h"
#include "support/layers_reference.h"
#include "support/reference.h"
#include "support/reference_hexagon.h"
#include "support/scatter_reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 320, HEIGHT = 180, RADIUS = 12 };

struct input {
    struct picture colour, radius;
    struct hf_depth depth;
};

static int make_input(struct input *in, struct tool_error *error)
{
    const struct bench_optics optics = {20, 10, RADIUS};
    struct bench_scene scene;
    if (bench_scene_paint(&scene, "mixed", WIDTH, HEIGHT, &optics, error))
        return -1;
    in->colour = picture_new(WIDTH, HEIGHT, 3);
    in->radius = picture_new(WIDTH, HEIGHT, 1);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        for (int c = 0; c < 3; c++)
            in->colour.plane[c][i] = scene.rgb[3 * i + c];
        const float ranges = (scene.depth[i] - optics.focus) / optics.range;
        in->radius.plane[0][i] = RADIUS * fminf(fmaxf(ranges, -1), 1);
    }
    in->depth = picture_depth(&in->radius);
    in->depth.type = HF_DEPTH_COC;
    bench_scene_free(&scene);
    return 0;
}

static struct hf_params params_of(const struct trade_job *job)
{
    struct hf_params p = job->args.params;
    p.max_radius = RADIUS;
    return p;
}

// A setting's algorithm in double precision, without rounding for storage; an empty picture if there is none.
static struct picture in_double(const struct input *in, struct hf_params p)
{
    struct picture out = {0};
    p.gather.storage = p.chapter.storage = HF_STORAGE_FLOAT;
    if (p.engine == HF_ENGINE_GATHER || p.engine == HF_ENGINE_CHAPTER) {
        struct reference *r = reference_render(&in->colour, &in->depth, &p, NULL, NULL);
        out = reference_picture(r);
        reference_free(r);
    } else if (p.engine == HF_ENGINE_HEXAGON) {
        out = hexagon_reference(&in->colour, &in->radius, &p);
    } else if (p.engine == HF_ENGINE_SCATTER && p.scatter.resolution == HF_RESOLUTION_FULL) {
        out = scatter_reference(&in->colour, in->radius.plane[0]);
    } else if (p.engine == HF_ENGINE_LAYERS) {
        struct hf_params filled = {.size = sizeof filled};
        // The reference has slices alone.
        if (hf_resolve(WIDTH, HEIGHT, &in->depth, &p, &filled, NULL, NULL) == HF_OK && filled.layers.lens_points == 1)
            out = layers_reference(&in->colour, in->radius.plane[0], &filled);
    }
    return out;
}

static double linear_distance(const struct picture *a, const struct picture *b)
{
    double sum = 0;
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            const double d = (double)a->plane[c][i] - b->plane[c][i];
            sum += d * d;
        }
    return sqrt(sum / (3.0 * WIDTH * HEIGHT));
}

static double shown_distance(const struct picture *a, const struct picture *b)
{
    double sum = 0;
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            const double d = (double)bench_display(a->plane[c][i]) - bench_display(b->plane[c][i]);
            sum += d * d;
        }
    return sqrt(sum / (3.0 * WIDTH * HEIGHT));
}

int trade_run_axes(struct trade_run *run, int result, struct tool_error *error)
{
    struct trade_result *r = &run->t->result[result];
    const struct trade_job *job = &run->job[result];
    struct hf_params p = params_of(job);
    struct input in;
    if (make_input(&in, error))
        return -1;
    struct picture got = picture_new(WIDTH, HEIGHT, 3), exact = in_double(&in, p), demo = {0};
    const struct hf_image dst = picture_image(&got), src = picture_image(&in.colour);
    const int err = hf_render(job->context, &dst, &src, &in.depth, &p);
    r->rounding = exact.width ? linear_distance(&got, &exact) : NAN;
    r->faithfulness = NAN;
    if (p.engine == HF_ENGINE_GATHER || p.engine == HF_ENGINE_CHAPTER) {
        struct hf_params published = hf_default_params();
        published.engine = HF_ENGINE_CHAPTER;
        published.chapter.faithful = 1;
        published.max_radius = RADIUS;
        demo = in_double(&in, published);
        r->faithfulness = shown_distance(&got, &demo);
    }
    r->axes_measured = 1;
    picture_free(&in.colour);
    picture_free(&in.radius);
    picture_free(&got);
    picture_free(&exact);
    picture_free(&demo);
    return err ? tool_fail(error, -1, "%s: %s", r->setting->options, hf_error_string(err)) : 0;
}
