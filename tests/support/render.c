// SPDX-License-Identifier: BSD-3-Clause
#include "support/render.h"

#include <string.h>

#include "support/check.h"

struct hf_context *context_new(enum hf_isa isa, int threads, int tile_width, int tile_height)
{
    struct hf_config config = scene_config(isa, threads);
    struct hf_context *c = NULL;
    config.tile_width = tile_width;
    config.tile_height = tile_height;
    CHECK_INT(hf_open(&c, &config), HF_OK);
    return c;
}

int try_render(struct hf_context *c, struct picture *out, const struct picture *colour, const struct hf_depth *depth,
               const struct hf_params *p)
{
    const struct hf_image dst = picture_image(out), src = picture_image(colour);
    return hf_render(c, &dst, &src, depth, p);
}

int try_scene(struct hf_context *c, struct picture *out, const struct scene *s, const struct hf_params *p)
{
    const struct hf_depth depth = picture_depth(&s->depth);
    return try_render(c, out, &s->colour, &depth, p);
}

struct picture render(struct hf_context *c, const struct picture *colour, const struct hf_depth *depth,
                      const struct hf_params *p)
{
    struct picture out = picture_new(colour->width, colour->height, colour->channels);
    const int err = try_render(c, &out, colour, depth, p);
    CHECK_MSG(err == HF_OK, "render: %s", hf_error_string(err));
    return out;
}

struct picture render_scene(struct hf_context *c, const struct scene *s, const struct hf_params *p)
{
    const struct hf_depth depth = picture_depth(&s->depth);
    return render(c, &s->colour, &depth, p);
}

struct hf_depth picture_radii(const struct picture *radii)
{
    struct hf_depth d = picture_depth(radii);
    d.type = HF_DEPTH_COC;
    return d;
}

size_t samples_of(const struct picture *p)
{
    return (size_t)p->width * (size_t)p->height;
}

int all_finite(const struct picture *p)
{
    for (int c = 0; c < p->channels; c++)
        for (size_t i = 0; i < samples_of(p); i++)
            if (!isfinite(p->plane[c][i]))
                return 0;
    return 1;
}

double largest_sample(const struct picture *p)
{
    double largest = 0;
    for (int c = 0; c < p->channels; c++)
        for (size_t i = 0; i < samples_of(p); i++)
            if (isfinite(p->plane[c][i]))
                largest = fmax(largest, fabs((double)p->plane[c][i]));
    return largest;
}

double largest_difference(const struct picture *a, const struct picture *b)
{
    double largest = 0;
    for (int c = 0; c < a->channels; c++)
        for (size_t i = 0; i < samples_of(a); i++)
            largest = worse(largest, fabs((double)a->plane[c][i] - b->plane[c][i]));
    return largest;
}

int samples_other(const struct picture *a, const struct picture *b)
{
    int n = 0;
    for (int c = 0; c < a->channels; c++)
        for (size_t i = 0; i < samples_of(a); i++)
            n += memcmp(&a->plane[c][i], &b->plane[c][i], sizeof(float)) != 0;
    return n;
}

struct picture picture_transposed(const struct picture *p)
{
    struct picture out = picture_new(p->height, p->width, p->channels);
    for (int c = 0; c < p->channels; c++)
        for (int y = 0; y < p->height; y++)
            for (int x = 0; x < p->width; x++)
                out.plane[c][x * p->height + y] = p->plane[c][y * p->width + x];
    return out;
}

void picture_fill(struct picture *p, int channel, float value)
{
    for (size_t i = 0; i < samples_of(p); i++)
        p->plane[channel][i] = value;
}

void choose_fields(struct hf_params *p)
{
    const struct hf_chapter_params *c = &p->chapter;
    p->engine = c->fill == HF_FILL_MEAN && !c->faithful && !c->downsample && !c->division ? HF_ENGINE_GATHER
                                                                                          : HF_ENGINE_CHAPTER;
    p->gather.storage = c->storage;
    p->gather.karis = c->karis;
    p->gather.per_pixel_kernel = c->per_pixel_kernel;
    p->gather.bicubic = c->bicubic;
}

struct picture render_radii(struct hf_context *c, enum hf_engine engine, const struct picture *colour,
                            const struct picture *radii, int half)
{
    struct hf_params p = scene_params();
    p.engine = engine;
    p.max_radius = HF_DERIVE;
    p.scatter.resolution = p.hexagon.resolution = half ? HF_RESOLUTION_HALF : HF_RESOLUTION_FULL;
    const struct hf_depth depth = picture_radii(radii);
    return render(c, colour, &depth, &p);
}
