// SPDX-License-Identifier: BSD-3-Clause
// --resume: the OUTPUT's header says what a frame was made with, so a stopped run can go on.
#ifndef HF_CLI_RESUME_H
#define HF_CLI_RESUME_H

#include "tools/cli/args.h"
#include "tools/cli/shot.h"
#include "tools/io/io.h"

enum { CLI_STAMP_TEXTS = 3 };

// Three texts for the header: hyperfocalVersion, hyperfocalSettings for people to read, and hyperfocalHash. The hash
// covers the first two texts, and the sizes, the times and some bytes of the input files.
struct cli_stamp {
    struct hf_io_text texts[CLI_STAMP_TEXTS];
    char hash[17];
    char *settings;
};

// Make the stamp of the frame that args describes: of its files, and of its values from --keys or from a focus that
// follows the pictures. Returns 0, or -1 without memory.
int cli_stamp_make(struct cli_stamp *stamp, const struct cli_args *args);
void cli_stamp_free(struct cli_stamp *stamp);

// 1 if the file has this stamp, all its chunks and the right checksum.
int cli_stamp_fits(const struct cli_stamp *stamp, const char *path);

// Remove temporary files of dead processes beside the outputs, by hf_temp_remove_strays. Returns how many.
int cli_remove_strays(const struct cli_shot *shot);

#endif
