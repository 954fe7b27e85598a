// SPDX-License-Identifier: BSD-3-Clause
// A picture that was opened as the command opens it, with all its views, and smaller copies of it. Once made it does not change,
// except that smaller copies are made when they are asked for; any number of threads may look at it.
#ifndef HF_VIEW_PICTURE_H
#define HF_VIEW_PICTURE_H

#include <glib.h>
#include <sys/stat.h>

#include "tools/cli/frame.h"
#include "tools/view/model.h"

enum { VIEW_REDUCTIONS = 16 };  // the smallest copy has a sixteenth of the width

// A view at 1/n of its width and height: linear planes, A may be NULL.
struct view_pixels {
    int width, height;
    float *plane[4], *depth;
};

struct view_picture {
    gatomicrefcount refs;
    struct view_words words;
    struct cli_args args;
    struct cli_frame frame;
    struct hf_io_view made;                       // of a picture that no file holds
    struct stat file;                             // as it was read
    int shown;                                    // the view
    GMutex lock;                                  // of what follows
    struct view_pixels reduced[VIEW_REDUCTIONS];  // [n - 1]; [0] is the view itself
};

// Read what the words name; words becomes empty. input: the file, where words name a shot; NULL: what the words say. NULL with
// *error filled if that fails. view: the one to look at, the first if there is no such view. Any thread may call it.
struct view_picture *view_picture_load(struct view_words *words, const char *input, const char *depth_file, int view,
                                       struct tool_error *error);
// A picture that no file holds, of planes and a depth that become its own. NULL without memory.
struct view_picture *view_picture_make(const struct hf_io_view *view, float *const planes[3], float *depth);
struct view_picture *view_picture_ref(struct view_picture *p);
void view_picture_unref(struct view_picture *p);

const struct cli_view *view_picture_view(const struct view_picture *p);

// 1/n of the picture, 1 <= n <= VIEW_REDUCTIONS; NULL without memory.
const struct view_pixels *view_picture_at(struct view_picture *p, int n);

// What the command would render the shown view with. Returns 0, or -1 with *error filled.
int view_picture_setup(struct view_picture *p, const struct cli_args *args, struct cli_setup *setup,
                       struct tool_error *error);
// The same for 1/n of it.
void view_reduce_setup(struct hf_params *params, struct hf_depth *depth, const struct view_pixels *pixels, int n);

// View distances of the nearest surface and the farthest, by a grid of samples; 1 and 100 if there is none.
void view_picture_distances(const struct view_picture *p, const struct hf_depth *depth, float *nearest,
                            float *farthest);
// 1 if the file is another one now, or is gone (2).
int view_picture_changed(const struct view_picture *p);

#endif
