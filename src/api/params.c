// SPDX-License-Identifier: BSD-3-Clause
// Parameters: the defaults, and the values that they resolve to.
#include <stdio.h>

#include "frame/defaults.h"
#include "frame/resolve.h"
#include "pass/check.h"

const struct hf_params hf_default_params = {HF_PARAMS_DEFAULTS};

int hf_resolve(int width, int height, const struct hf_depth *depth, const struct hf_params *params,
               struct hf_resolved *resolved, char *message, size_t size)
{
    struct hf_resolved r;
    char sentence[HF_MESSAGE] = "";
    const int err = hf_params_resolve(&r, width, height, depth, params ? params : &hf_default_params, sentence);
    if (message && size)
        snprintf(message, size, "%s", sentence);
    if (resolved)
        *resolved = err ? (struct hf_resolved){0} : r;
    return err;
}
