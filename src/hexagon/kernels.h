// SPDX-License-Identifier: BSD-3-Clause
// The hexagon's kernels.
#ifndef HF_HEXAGON_KERNELS_H
#define HF_HEXAGON_KERNELS_H

#include "frame/engine.h"
#include "hexagon/hexagon.h"

struct hf_hexagon_kernels {
    struct hf_passes passes;
    hf_kernel *first, *second;  // the two passes of blurs, of a band
};
HF_DECLARE_KERNELS(hf_hexagon_kernels);

static inline const struct hf_hexagon_kernels *hf_hexagon_kernels(const struct hf_frame *f)
{
    return f->kernels;
}

hf_kernel hf_hexagon_load_c, hf_hexagon_1_c, hf_hexagon_2_c, hf_hexagon_blur_pass, hf_hexagon_behind_pass,
    hf_hexagon_composite_c;

extern const struct hf_engine_def hf_hexagon_engine;

#endif
