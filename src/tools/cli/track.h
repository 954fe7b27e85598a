// SPDX-License-Identifier: BSD-3-Clause
// A focus that follows the pictures of a shot without jumping.
#ifndef HF_CLI_TRACK_H
#define HF_CLI_TRACK_H

#include "tools/cli/args.h"
#include "tools/cli/keys.h"
#include "tools/cli/shot.h"
#include "tools/io/io.h"

enum { CLI_FOCUS_SMOOTH = 6 };  // frames to each side, by default

// The arguments of one frame: those of all frames, its files, its keys. *args owns nothing that has to be freed.
void cli_frame_args(struct cli_args *args, const struct cli_args *all, const struct cli_job *job,
                    const struct cli_keys *keys);

// 1 if the frames' focus is read from the pictures.
int cli_track_wanted(const struct cli_args *args, const struct cli_keys *keys);

// Find the focus of each job, or NAN if no frame around it has one. It is the mean of the distances in the frames around: of
// what the middle pixel or that of the keys shows, of an object, or of the surface that --focus-at names in the first frame
// that exists, which is followed (see follow() in track.c). The weights fall linearly to 0 beyond --focus-smooth frames. The mean is taken of
// inverse distances, because blur is linear in those. It depends only on the files of the shot, not on which of them
// this process makes. Returns 0, or an exit code with *error filled.
int cli_track(float *focus, const struct cli_shot *shot, const struct cli_args *args, const struct cli_keys *keys,
              const struct hf_io_run *run, struct tool_error *error);

#endif
