// SPDX-License-Identifier: BSD-3-Clause
// Cancelling a frame. Any thread may set the flag. All workers of the frame read it about every tenth of a millisecond
// and return if it is set; the picture is then unusable.
#ifndef HF_STOP_H
#define HF_STOP_H

#include <stdatomic.h>

// stop NULL: the frame cannot be cancelled.
static inline int hf_stopped(atomic_int *stop)
{
    return stop && atomic_load_explicit(stop, memory_order_relaxed);
}

#endif
