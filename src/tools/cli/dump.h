// SPDX-License-Identifier: BSD-3-Clause
// --dump-passes: every intermediate buffer of a view as an EXR file of its own.
#ifndef HF_CLI_DUMP_H
#define HF_CLI_DUMP_H

#include "tools/cli/frame.h"

struct cli_dump {
    const struct cli_args *args;
    const char *dir;
    char prefix[80];  // "left." when the frame has several views
    int failed;
    struct tool_error error;  // the first one
};

// From now on the context writes its buffers to files.
void cli_dump_begin(struct cli_dump *dump, struct hf_context *context, const struct cli_frame *frame,
                    const struct cli_view *view);
// Stop that, and write the rendered image as composite.exr. Returns 0, or an exit code with *error filled.
int cli_dump_end(struct cli_dump *dump, struct hf_context *context, const struct hf_image *image,
                 struct tool_error *error);

#endif
