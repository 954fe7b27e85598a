// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_DUMP_H
#define HF_DUMP_H

#include "frame/context.h"

// Call the context's dump function with every buffer of the frame that was just rendered completely. May return
// HF_ERR_MEMORY.
int hf_dump_buffers(struct hf_context *c, const struct hf_setup *s);

#endif
