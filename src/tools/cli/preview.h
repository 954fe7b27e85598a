// SPDX-License-Identifier: BSD-3-Clause
// What would be done with a shot: --dry-run and --print-focus, on stdout.
#ifndef HF_CLI_PREVIEW_H
#define HF_CLI_PREVIEW_H

#include "tools/cli/args.h"
#include "tools/cli/frame.h"
#include "tools/cli/shot.h"

// What a frame that was planned will take: bytes of memory, milliseconds alone, and those of them that defocus takes.
// Encoding is guessed from decoding.
struct cli_expected {
    double bytes, ms, defocus_ms;
};
struct cli_expected cli_expect(const struct cli_frame *frame, struct hf_context *context);

// The frames with their files, and the memory and time that the first lets expect. Returns an exit code.
int cli_preview(const struct cli_args *args, const struct cli_shot *shot, struct tool_error *error);

// A table frame,focus, as --keys reads it. Returns an exit code; frames without a focus are named on stderr.
int cli_print_focus(const struct cli_args *args, const struct cli_shot *shot, struct tool_error *error);

#endif
