// SPDX-License-Identifier: BSD-3-Clause
// Parameters: the defaults, and the values that they resolve to.
#include <string.h>

#include "api/params.h"
#include "api/sized.h"
#include "frame/check.h"
#include "frame/defaults.h"
#include "frame/resolve.h"

int hf_params_init(struct hf_params *params, size_t size)
{
    struct hf_message message;
    if (!params || size < hf_sized_params.first)
        return HF_ERR_ARG;
    params->size = size;
    return hf_sized_out(params, &hf_params_defaults, &hf_sized_params, "params", &message);
}

struct hf_resolved hf_resolved_of(const struct hf_settings *r, int picture)
{
    return (struct hf_resolved){.width = r->width,
                                .height = r->height,
                                .limit = r->limit,
                                .lens_k = r->lens_k,
                                .focal_px = r->focal_px,
                                .sharp = r->sharp,
                                .picture = picture};
}

// The settings that params come to; the picture that they point to is the program's own.
static int resolve(struct hf_settings *r, int width, int height, const struct hf_depth *depth,
                   const struct hf_params *params, struct hf_message *message)
{
    struct hf_depth own;
    struct hf_given given;
    if (!depth)
        return hf_bad(message, "depth", "is NULL");
    if (hf_given_depth(&own, depth, message) || hf_given_params(&given, params, message))
        return HF_ERR_ARG;
    const int err = hf_params_resolve(r, width, height, &own, &given.params, message);
    r->params.aperture.picture = params ? params->aperture.picture : NULL;
    return err;
}

int hf_resolve(int width, int height, const struct hf_depth *depth, const struct hf_params *params,
               struct hf_params *filled, struct hf_resolved *resolved, struct hf_message *message)
{
    struct hf_settings r;
    struct hf_message own = {.size = sizeof own}, lost;
    int err = resolve(&r, width, height, depth, params, &own);
    const struct hf_resolved numbers =
        err ? (struct hf_resolved){0} : hf_resolved_of(&r, r.params.aperture.picture != NULL);
    const int told = hf_sized_out(filled, err ? NULL : &r.params, &hf_sized_params, "filled", err ? &lost : &own) ||
                     hf_sized_out(resolved, &numbers, &hf_sized_resolved, "resolved", err ? &lost : &own);
    err = err ? err : told ? HF_ERR_ARG : HF_OK;
    return hf_sized_out(message, &own, &hf_sized_message, "message", &lost) && !err ? HF_ERR_ARG : err;
}
