// SPDX-License-Identifier: BSD-3-Clause
// The frames of a shot that were read, as many as fit into a bounded memory.
#ifndef HF_VIEW_FRAMES_H
#define HF_VIEW_FRAMES_H

#include "tools/view/picture.h"

struct view_frames {
    struct view_picture **list;  // by place in the shot; NULL: not read
    int count;
    double bytes, most;  // held, and how many may be
};

// Room for so many frames; all that was held is let go.
void view_frames_open(struct view_frames *f, int count);
void view_frames_close(struct view_frames *f);
struct view_picture *view_frames_get(const struct view_frames *f, int place);
// Keep a frame; those farthest from `shown` are let go when there is no room.
void view_frames_put(struct view_frames *f, int place, struct view_picture *picture, int shown);
void view_frames_drop(struct view_frames *f, int place);
// The next frame to read ahead from `shown` on; -1: none, or no room.
int view_frames_ahead(const struct view_frames *f, int shown);

#endif
