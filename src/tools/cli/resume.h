// SPDX-License-Identifier: BSD-3-Clause
// What a frame was made with, as its header says, so that work that was stopped can go on.
#ifndef HF_CLI_RESUME_H
#define HF_CLI_RESUME_H

#include "tools/cli/args.h"
#include "tools/cli/shot.h"
#include "tools/io/io.h"

enum { CLI_STAMP_TEXTS = 3 };

// Three texts for the header: hyperfocalVersion, hyperfocalSettings, which a person can read, and hyperfocalHash, of
// these two and of the input files: their sizes, times and some of their bytes.
struct cli_stamp {
    struct hf_io_text texts[CLI_STAMP_TEXTS];
    char hash[17];
    char *settings;
};

// For the frame that args describes: its files, and its values from keys and a focus that follows. Returns 0, or -1
// without memory.
int cli_stamp_make(struct cli_stamp *stamp, const struct cli_args *args);
void cli_stamp_free(struct cli_stamp *stamp);

// 1 if the file has this stamp, all its chunks and the right checksum.
int cli_stamp_fits(const struct cli_stamp *stamp, const char *path);

// Remove the temporary files beside the outputs whose writers have died, see hf_temp_remove_strays. Returns how many.
int cli_remove_strays(const struct cli_shot *shot);

#endif
