// SPDX-License-Identifier: BSD-3-Clause
#include "api/sized.h"

#include <string.h>

#include "frame/defaults.h"
#include "pass/check.h"

// A size beyond this is no size but an uninitialised number.
enum { MOST = 65536 };

const struct hf_sized hf_sized_choice = HF_SIZED(hf_choice, why);
const struct hf_sized hf_sized_config = HF_SIZED(hf_config, parallel_cookie);
const struct hf_sized hf_sized_depth = HF_SIZED(hf_depth, reserved);
const struct hf_sized hf_sized_image = HF_SIZED(hf_image, stride);
const struct hf_sized hf_sized_message = HF_SIZED(hf_message, sentence);
const struct hf_sized hf_sized_params = HF_SIZED(hf_params, run);
const struct hf_sized hf_sized_region = HF_SIZED(hf_region, height);
const struct hf_sized hf_sized_report = HF_SIZED(hf_report, clamped);
const struct hf_sized hf_sized_resolved = HF_SIZED(hf_resolved, reserved);

static int is_zero(const char *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (bytes[i])
            return 0;
    return 1;
}

int hf_sized_is_possible(size_t size, const struct hf_sized *type)
{
    return size >= type->first && size <= MOST;
}

static int check_size(size_t size, const struct hf_sized *type, const char *argument, struct hf_message *message)
{
    if (hf_sized_is_possible(size, type))
        return HF_OK;
    hf_bad(message, argument, "has the size %zu; set its field size to sizeof(struct %s), at least %zu", size,
           type->name, type->first);
    return HF_ERR_ARG;
}

int hf_sized_in(void *own, const void *given, const struct hf_sized *type, const char *argument,
                struct hf_message *message)
{
    const size_t size = *(const size_t *)given, own_size = type->own;
    if (check_size(size, type, argument, message))
        return HF_ERR_ARG;
    if (size > own_size && !is_zero((const char *)given + own_size, size - own_size))
        return hf_bad(message, argument,
                      "is %zu bytes, of which this library (%s) knows %zu; what lies beyond them is not zero: it was "
                      "made for a newer library",
                      size, hf_version(), own_size);
    memcpy(own, given, size < own_size ? size : own_size);
    *(size_t *)own = own_size;
    return HF_OK;
}

int hf_sized_out(void *given, const void *own, const struct hf_sized *type, const char *argument,
                 struct hf_message *message)
{
    if (!given)
        return HF_OK;
    const size_t size = *(const size_t *)given, known = size < type->own ? size : type->own, skip = sizeof size;
    if (check_size(size, type, argument, message))
        return HF_ERR_ARG;
    memset((char *)given + skip, 0, size - skip);
    if (own)
        memcpy((char *)given + skip, (const char *)own + skip, known - skip);
    return HF_OK;
}

// What groups of parameters may grow into.
static const struct {
    const char *name;
    size_t offset, bytes;
} reserved[] = {
#define GROUP(group)                                                                                                   \
    {                                                                                                                  \
#group ".reserved", offsetof(struct hf_params, group.reserved), sizeof((struct hf_params *)0)->group.reserved  \
    }
    GROUP(range),   GROUP(lens),    GROUP(aperture), GROUP(highlight), GROUP(view),   GROUP(gather),
    GROUP(chapter), GROUP(hexagon), GROUP(scatter),  GROUP(gaussian),  GROUP(layers), GROUP(run),
#undef GROUP
};

static int bad_reserved(struct hf_message *message, const char *argument)
{
    return hf_bad(message, argument,
                  "is not zero, and this library (%s) knows nothing there; begin with defaults or zeros", hf_version());
}

// Fields that are 0 or 1. Kernels count with some of them.
static const size_t flags[] = {
    offsetof(struct hf_params, gather.karis),       offsetof(struct hf_params, gather.per_pixel_kernel),
    offsetof(struct hf_params, gather.bicubic),     offsetof(struct hf_params, chapter.faithful),
    offsetof(struct hf_params, chapter.karis),      offsetof(struct hf_params, chapter.per_pixel_kernel),
    offsetof(struct hf_params, chapter.bicubic),    offsetof(struct hf_params, hexagon.uniform),
    offsetof(struct hf_params, gaussian.faithful),  offsetof(struct hf_params, layers.no_unmix),
    offsetof(struct hf_params, layers.no_hidden),   offsetof(struct hf_params, layers.no_highlights),
    offsetof(struct hf_params, layers.no_patterns), offsetof(struct hf_params, layers.guessed),
    offsetof(struct hf_params, run.deterministic),  offsetof(struct hf_params, run.no_skip),
};

int hf_given_params(struct hf_given *own, const struct hf_params *params, struct hf_message *message)
{
    *own = (struct hf_given){.params = hf_params_defaults};
    if (!params)
        return HF_OK;
    if (hf_sized_in(&own->params, params, &hf_sized_params, "params", message))
        return HF_ERR_ARG;
    for (size_t i = 0; i < sizeof reserved / sizeof *reserved; i++)
        if (!is_zero((const char *)&own->params + reserved[i].offset, reserved[i].bytes))
            return bad_reserved(message, reserved[i].name);
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) {
        int *flag = (int *)(void *)((char *)&own->params + flags[i]);
        *flag = *flag != 0;
    }
    const struct hf_image **picture = &own->params.aperture.picture;
    if (*picture && hf_sized_in(&own->picture, *picture, &hf_sized_image, "aperture.picture", message))
        return HF_ERR_ARG;
    *picture = *picture ? &own->picture : NULL;
    return HF_OK;
}

int hf_given_depth(struct hf_depth *own, const struct hf_depth *depth, struct hf_message *message)
{
    *own = (struct hf_depth){0};
    if (hf_sized_in(own, depth, &hf_sized_depth, "depth", message))
        return HF_ERR_ARG;
    return own->reserved ? bad_reserved(message, "depth.reserved") : HF_OK;
}
