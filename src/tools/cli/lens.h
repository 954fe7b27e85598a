// SPDX-License-Identifier: BSD-3-Clause
// The lens that options and header make, whether it is whole, and what is missing.
#ifndef HF_CLI_LENS_H
#define HF_CLI_LENS_H

#include "tools/cli/setup.h"

// Is a number of a header one that can be used? Headers hold zeros where nobody knew better.
int cli_lens_usable(float number);
// The header's focal length, millimetres: pinholeFocalLength, else nominalFocalLength; NAN.
float cli_lens_header_focal(const struct hf_io_camera *camera);

// How much blur there is follows from the lens when one was asked for, or when the header has a whole one.
enum cli_model cli_lens_model(const struct cli_args *args, const struct hf_io_camera *camera);

// Fill p->lens. Returns 0, or an exit code with *error filled when something is missing.
int cli_lens_set(struct hf_params *p, const struct cli_args *args, const struct hf_io_camera *camera, const char *label,
                 struct tool_error *error);

// Is there something to say of the header's lens: that it is not whole, or what was taken for what? Then it is in text.
int cli_lens_remark(const struct cli_args *args, const struct cli_setup *setup, const struct hf_io_camera *camera,
                    char *text, size_t size);

#endif
