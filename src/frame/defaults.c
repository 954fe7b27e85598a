// SPDX-License-Identifier: BSD-3-Clause
#include "frame/defaults.h"

const struct hf_params hf_params_defaults = {HF_PARAMS_DEFAULTS};
