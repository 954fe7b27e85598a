// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_IO_DEPTH_STEPS_H
#define HF_IO_DEPTH_STEPS_H

#include "tools/io/run.h"

// Make gentle slopes again of the terraces that whole numbers of this unit have made of them, in place; *changed: how many
// numbers. Finite ones. run NULL: on this thread. Returns 0, or -1 when memory is out.
int hf_io_smooth_steps(float *depth, int width, int height, float unit, const struct hf_io_run *run,
                       long long *changed);

#endif
