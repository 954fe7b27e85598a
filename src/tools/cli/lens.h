// SPDX-License-Identifier: BSD-3-Clause
// The lens, made of options and header: is it complete, and if not, what is missing?
#ifndef HF_CLI_LENS_H
#define HF_CLI_LENS_H

#include "tools/cli/setup.h"

// Is a header's number usable? Programs write 0 into headers when they do not know a value.
int cli_lens_usable(float number);
// The header's focal length, millimetres: pinholeFocalLength, else nominalFocalLength; NAN.
float cli_lens_header_focal(const struct hf_io_camera *camera);

// The model: the lens if an option asks for one, or if the header has a complete one and no option asks for a range.
enum cli_model cli_lens_model(const struct cli_args *args, const struct hf_io_camera *camera);

// Where a lens comes from that no option gives, as " (from EXIF)"; "" if options give all of it.
const char *cli_lens_from(const struct cli_args *args, const struct hf_io_camera *camera);

// Fill p->lens. Returns 0, or an exit code with *error filled when something is missing.
int cli_lens_set(struct hf_params *p, const struct cli_args *args, const struct hf_io_camera *camera, const char *label,
                 struct tool_error *error);

// Write a warning about the header's lens to text: that it is incomplete, or that one value stands in for another.
// Returns 1 if there is one.
int cli_lens_remark(const struct cli_args *args, const struct cli_setup *setup, const struct hf_io_camera *camera,
                    char *text, size_t size);

#endif
