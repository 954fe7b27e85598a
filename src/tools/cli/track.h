// SPDX-License-Identifier: BSD-3-Clause
// A focus that follows the pictures of a shot without jumping.
#ifndef HF_CLI_TRACK_H
#define HF_CLI_TRACK_H

#include "tools/cli/args.h"
#include "tools/cli/keys.h"
#include "tools/cli/shot.h"
#include "tools/io/io.h"

enum { CLI_FOCUS_SMOOTH = 6 };  // frames to each side, by default

// The arguments of one frame: those of all, its files, its keys. *args is to be treated as a copy: nothing to free.
void cli_frame_args(struct cli_args *args, const struct cli_args *all, const struct cli_job *job,
                    const struct cli_keys *keys);

// 1 if the frames' focus is read from the pictures.
int cli_track_wanted(const struct cli_args *args, const struct cli_keys *keys);

// The focus of each job, or NAN where there is nothing to be had: the mean of what the pixel shows in the frames around,
// weights falling linearly to 0 beyond --focus-smooth frames, of inverse distances, because blur is linear in those.
// It depends on the files of the shot alone, not on which of them this process makes. Returns 0, or an exit code with
// *error filled.
int cli_track(float *focus, const struct cli_shot *shot, const struct cli_args *args, const struct cli_keys *keys,
              const struct hf_io_run *run, struct tool_error *error);

#endif
