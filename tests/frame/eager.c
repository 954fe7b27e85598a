// SPDX-License-Identifier: BSD-3-Clause
// What an engine says of how far its sweeps read is enough: cells are taken as early as the queue allows, so of the sweep before
// only what they read is made, and the rest of the memory is NaN. The bits are those of sweeps one after the other.
//
//     eager [seed]
#include <string.h>

#include "frame/context.h"
#include "hyperfocal/layers.h"
#include "support/check.h"
#include "support/render.h"

// Cells of the latest sweep first; of these the last, or any.
static int any;
static struct rng choice;

int __real_hf_queue_take(struct hf_queue *q, const struct hf_plan *p, hf_queue_find *find, int *sweep);
int __wrap_hf_queue_take(struct hf_queue *q, const struct hf_plan *p, hf_queue_find *find, int *sweep);

static int find_last(const struct hf_queue *q, const struct hf_plan *p, int *step)
{
    for (*step = q->steps - 1; *step >= 0; --*step) {
        const int count = q->step[*step].count, from = any ? rng_below(&choice, count) : count - 1;
        for (int i = 0; i < count; i++)
            if (hf_queue_may_take(q, p, *step, (from - i + count) % count))
                return (from - i + count) % count;
    }
    return -1;
}

int __wrap_hf_queue_take(struct hf_queue *q, const struct hf_plan *p, hf_queue_find *find, int *sweep)
{
    (void)find;
    return __real_hf_queue_take(q, p, find_last, sweep);
}

// One cell after the other, without a queue.
static void in_order(void *cookie, int n, void (*fn)(void *arg, int i, int worker), void *arg)
{
    (void)cookie;
    for (int i = 0; i < n; i++)
        fn(arg, i, 0);
}

static struct hf_context *barriers(int tile)
{
    struct hf_config config = scene_config(HF_ISA_AUTO, 1);
    struct hf_context *c = NULL;
    config.parallel_for = in_order;
    config.tile_width = config.tile_height = tile;
    CHECK_INT(hf_open(&c, &config), HF_OK);
    return c;
}

// Render a region of a scene, with as many peels of another one behind it.
static struct picture make(struct hf_context *c, const struct scene s[2], int peels, const struct hf_params *p,
                           const struct hf_region *region)
{
    struct picture out = picture_new(s->colour.width, s->colour.height, s->colour.channels);
    const struct hf_image dst = picture_image(&out),
                          image[2] = {picture_image(&s[0].colour), picture_image(&s[1].colour)};
    const struct hf_depth depth[2] = {picture_depth(&s[0].depth), picture_depth(&s[1].depth)};
    struct hf_layer layer[3];
    for (int i = 0; i < 3; i++)
        layer[i] = (struct hf_layer){.size = sizeof layer[i],
                                     .kind = i ? HF_LAYER_PEEL : HF_LAYER_WHOLE,
                                     .image = &image[i > 0],
                                     .depth = &depth[i > 0]};
    CHECK_INT(hf_render_layers(c, &dst, layer, 1 + peels, p, region), HF_OK);
    return out;
}

static void one(struct rng *rng, int number)
{
    const int width = 40 + rng_below(rng, 200), height = 200 + rng_below(rng, 600), channels = 3 + rng_below(rng, 2);
    const int tile = 32 << rng_below(rng, 3), peels = rng_below(rng, 3), kind = number % SCENE_KINDS;
    struct scene s[2] = {scene_new(rng, (enum scene_kind)kind, width, height, channels),
                         scene_new(rng, SCENE_BLOCKS, width, height, channels)};
    struct hf_region region = {.size = sizeof region, .x = rng_below(rng, width / 2), .y = rng_below(rng, height / 2)};
    struct hf_params p = scene_params();
    const int part = rng_below(rng, 2);
    region.width = 1 + rng_below(rng, width - region.x);
    region.height = 1 + rng_below(rng, height - region.y);
    p.engine = HF_ENGINE_LAYERS;
    p.layers.quality = (enum hf_layers_quality)rng_below(rng, HF_LAYERS_BEST + 1);
    p.max_radius = 2 + (float)rng_below(rng, rng_below(rng, 3) ? 20 : 60);
    p.aperture.chromatic = rng_below(rng, 4) ? 0 : 0.1f;
    struct hf_context *c[2] = {barriers(tile), context_new(HF_ISA_AUTO, 2, tile, tile)};
    struct picture out[2];
    any = rng_below(rng, 2);
    for (int i = 0; i < 2; i++) {
        out[i] = make(c[i], s, peels, &p, part ? &region : NULL);
        CHECK(all_finite(&out[i]));
    }
    CHECK_MSG(picture_same_bits(&out[0], &out[1]),
              "%s %dx%dx%d, tiles of %d, quality %d, radius %g, %d peels%s: %d samples differ",
              scene_name((enum scene_kind)kind), width, height, channels, tile, (int)p.layers.quality,
              (double)p.max_radius, peels, part ? ", a region" : "", samples_other(&out[0], &out[1]));
    for (int i = 0; i < 2; i++) {
        picture_free(&out[i]);
        scene_free(&s[i]);
        hf_close(&c[i]);
    }
}

int main(int argc, char **argv)
{
    const unsigned seed = argc > 1 ? (unsigned)atoi(argv[1]) : 1;
    for (int i = 0; i < (check_long() ? 400 : 40); i++) {
        struct rng rng = rng_seed(seed * 1000 + (unsigned)i);
        choice = rng_seed(seed);
        one(&rng, i);
    }
    return check_report();
}
