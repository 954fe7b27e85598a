// SPDX-License-Identifier: BSD-3-Clause
// The layers that a program gives, copied and checked.
#ifndef HF_API_LAYERS_H
#define HF_API_LAYERS_H

#include "frame/deep.h"

// Copy and check count layers. Returns HF_OK, or HF_ERR_ARG with the message filled.
int hf_take_layers(struct hf_surface_input *to, const struct hf_layer *layers, int count, struct hf_message *message);
// Copy and check a deep picture. *image becomes a picture of its size, whose pixels are not to be read.
int hf_take_deep(struct hf_deep_input *to, struct hf_image *image, const struct hf_deep *deep,
                 struct hf_message *message);

#endif
