// SPDX-License-Identifier: BSD-3-Clause
// From the arguments of a render call to the numbers that the passes need.
#ifndef HF_RESOLVE_H
#define HF_RESOLVE_H

#include "pass/frame.h"

// hf_resolve for the library's own use: params must not be NULL.
int hf_params_resolve(struct hf_settings *r, int width, int height, const struct hf_depth *depth,
                      const struct hf_params *params, struct hf_message *message);

// Fill *s from resolved parameters, to which it will point, and compute the engine's own numbers in its memory `own`;
// the engine's tables are made by its prepare.
void hf_setup_make(struct hf_setup *s, const struct hf_image *src, const struct hf_image *dst,
                   const struct hf_depth *depth, const struct hf_settings *r, void *own);

#endif
