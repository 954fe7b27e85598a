// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_API_PARAMS_H
#define HF_API_PARAMS_H

#include "pass/frame.h"

// What hf_resolve tells of settings. picture: 1 if there is one of the aperture.
struct hf_resolved hf_resolved_of(const struct hf_settings *r, int picture);

#endif
