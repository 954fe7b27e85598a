// SPDX-License-Identifier: BSD-3-Clause
// A frame that is cancelled: any thread sets the flag, and whoever works on the frame looks at it about every tenth of a
// millisecond and returns. What it has been making is then worth nothing.
#ifndef HF_STOP_H
#define HF_STOP_H

#include <stdatomic.h>

// stop NULL: nobody can cancel.
static inline int hf_stopped(atomic_int *stop)
{
    return stop && atomic_load_explicit(stop, memory_order_relaxed);
}

#endif
