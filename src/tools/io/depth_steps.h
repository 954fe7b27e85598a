// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_IO_DEPTH_STEPS_H
#define HF_IO_DEPTH_STEPS_H

#include "tools/io/run.h"

// Smooth the terraces that integers of this unit made of gentle slopes, in place. *changed: how many values. All values
// must be finite. run NULL: on this thread. Returns 0, or -1 without memory.
int hf_io_smooth_steps(float *depth, int width, int height, float unit, const struct hf_io_run *run,
                       long long *changed);

#endif
