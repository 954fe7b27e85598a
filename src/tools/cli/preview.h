// SPDX-License-Identifier: BSD-3-Clause
// --dry-run and --print-focus for a shot: print to stdout what would be done.
#ifndef HF_CLI_PREVIEW_H
#define HF_CLI_PREVIEW_H

#include "tools/cli/args.h"
#include "tools/cli/frame.h"
#include "tools/cli/shot.h"

// What a planned frame is expected to take: bytes of memory beside those that the program has anyway (base), and
// milliseconds if it is made alone, of which defocus_ms are the library's. The time to encode is estimated from the time
// to decode.
struct cli_expected {
    double base, bytes, ms, defocus_ms;
    int helped;  // hf_io_is_helped
};
struct cli_expected cli_expect(const struct cli_frame *frame, const struct cli_session *session);

// Print the frames with their files, and the memory and time that the first frame leads to expect. Returns an exit
// code.
int cli_preview(const struct cli_args *args, const struct cli_shot *shot, struct tool_error *error);

// Print a table frame,focus that --keys can read. Returns an exit code; names frames without a focus on stderr.
int cli_print_focus(const struct cli_args *args, const struct cli_shot *shot, struct tool_error *error);

#endif
