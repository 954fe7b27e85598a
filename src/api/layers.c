// SPDX-License-Identifier: BSD-3-Clause
#include "api/layers.h"

#include <stdio.h>

#include "api/sized.h"
#include "frame/check.h"

static const struct hf_sized sized_layer = HF_SIZED(hf_layer, depth), sized_deep = HF_SIZED(hf_deep, object);

// One layer; a message of its picture or depth names it too.
static int take(struct hf_surface_input *to, const struct hf_layer *given, const char *name, struct hf_message *message)
{
    struct hf_layer own = {0};
    char image[40];
    *to = (struct hf_surface_input){0};
    if (hf_sized_in(&own, given, &sized_layer, name, message))
        return HF_ERR_ARG;
    if (own.reserved)
        return hf_bad(message, name, "has reserved bits that are not zero");
    if (hf_check_value(name, (int)own.kind, 0, HF_LAYER_PEEL, message))
        return HF_ERR_ARG;
    if (!own.image || !own.depth)
        return hf_bad(message, name, "has no %s", own.image ? "depth" : "image");
    snprintf(image, sizeof image, "%s.image", name);
    if (hf_sized_in(&to->image, own.image, &hf_sized_image, image, message) ||
        hf_given_depth(&to->depth, own.depth, message) || hf_check_image(&to->image, image, message) ||
        hf_check_depth(&to->depth, to->image.width, message))
        return HF_ERR_ARG;
    to->kind = own.kind;
    return HF_OK;
}

int hf_take_layers(struct hf_surface_input *to, const struct hf_layer *layers, int count, struct hf_message *message)
{
    if (!layers)
        return hf_bad(message, "layers", "is NULL");
    if (count < 1 || count > HF_MOST_LAYERS)
        return hf_bad(message, "count", "is %d; it must be 1 to %d", count, HF_MOST_LAYERS);
    int peels = 0;
    for (int i = 0; i < count; i++) {
        char name[32];
        snprintf(name, sizeof name, "layers[%d]", i);
        // Structs of another release's size follow each other at that size.
        const struct hf_layer *given = (const void *)((const char *)layers + (size_t)i * layers->size);
        if (take(&to[i], given, name, message))
            return HF_ERR_ARG;
        if (to[i].image.width != to->image.width || to[i].image.height != to->image.height)
            return hf_bad(message, name, "is %d x %d pixels, the first layer %d x %d", to[i].image.width,
                          to[i].image.height, to->image.width, to->image.height);
        if ((to[i].depth.type == HF_DEPTH_COC) != (to->depth.type == HF_DEPTH_COC))
            return hf_bad(message, name, "has distances and another layer has CoC radii; give one kind");
        if (i == 0 && to[i].kind == HF_LAYER_PEEL)
            return hf_bad(message, name, "is a peel, with nothing before it");
        if (i > 0 && to[i].kind == HF_LAYER_WHOLE && to[i - 1].kind == HF_LAYER_PEEL)
            return hf_bad(message, name, "is whole and follows a peel; peels come last");
        peels += to[i].kind == HF_LAYER_PEEL;
    }
    if (peels && peels < count - 1)
        return hf_bad(message, "layers", "holds %d peels behind %d whole layers; peels belong to one picture", peels,
                      count - peels);
    return HF_OK;
}

// Check where the samples of each pixel are, and count.
static int check_first(struct hf_deep_input *to, struct hf_message *message)
{
    const struct hf_deep *d = &to->deep;
    const size_t pixels = (size_t)d->width * (size_t)d->height, width = (size_t)d->width;
    uint64_t in_pixel = 0, in_row = 0;
    for (size_t i = 0; i < pixels; i++) {
        if (d->first[i] > d->first[i + 1] || d->first[i + 1] > d->samples)
            return hf_bad(message, "deep.first",
                          "has %llu and then %llu at pixel (%zu, %zu); it must not fall, nor exceed the %llu samples",
                          (unsigned long long)d->first[i], (unsigned long long)d->first[i + 1], i % width, i / width,
                          (unsigned long long)d->samples);
        in_pixel = d->first[i + 1] - d->first[i] > in_pixel ? d->first[i + 1] - d->first[i] : in_pixel;
    }
    for (size_t y = 0; y < pixels; y += width)
        in_row = d->first[y + width] - d->first[y] > in_row ? d->first[y + width] - d->first[y] : in_row;
    to->most_in_pixel = in_pixel;
    to->most_in_row = in_row;
    return HF_OK;
}

int hf_take_deep(struct hf_deep_input *to, struct hf_image *image, const struct hf_deep *deep,
                 struct hf_message *message)
{
    static const float nothing;
    *to = (struct hf_deep_input){0};
    if (!deep)
        return hf_bad(message, "deep", "is NULL");
    if (hf_sized_in(&to->deep, deep, &sized_deep, "deep", message))
        return HF_ERR_ARG;
    const struct hf_deep *d = &to->deep;
    if (d->width < 1 || d->height < 1 || d->width > HF_MAX_SIZE || d->height > HF_MAX_SIZE)
        return hf_bad(message, "deep", "is %d x %d pixels; each side must be 1 to %d", d->width, d->height,
                      HF_MAX_SIZE);
    const int missing = d->samples && (!d->colour[0] || !d->colour[1] || !d->colour[2] || !d->alpha || !d->depth);
    if (!d->first || !d->as || missing)
        return hf_bad(message,
                      !d->first ? "deep.first"
                      : !d->as  ? "deep.as"
                                : "deep",
                      "%s", missing ? "lacks colour, alpha or depth" : "is NULL");
    if (hf_given_depth(&to->depth, d->as, message))
        return HF_ERR_ARG;
    // Samples follow each other; the rest of the description is that of a picture's depth.
    to->depth.data = d->depth ? d->depth : &nothing;
    to->depth.stride = (ptrdiff_t)d->width * (ptrdiff_t)sizeof(float);
    to->depth.format = HF_DEPTH_FORMAT_FLOAT32;
    *image =
        (struct hf_image){.size = sizeof *image, .width = d->width, .height = d->height, .format = HF_FORMAT_RGBA32F};
    image->data[0] = (void *)&nothing;
    image->stride[0] = 4 * to->depth.stride;
    const int err = hf_check_depth(&to->depth, d->width, message);
    return err ? err : check_first(to, message);
}
