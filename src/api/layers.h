// SPDX-License-Identifier: BSD-3-Clause
// The layers that a program gives, copied and checked.
#ifndef HF_API_LAYERS_H
#define HF_API_LAYERS_H

#include "frame/surfaces.h"

// Copy and check count layers. Returns HF_OK, or HF_ERR_ARG with the message filled.
int hf_take_layers(struct hf_surface_input *to, const struct hf_layer *layers, int count, struct hf_message *message);

#endif
