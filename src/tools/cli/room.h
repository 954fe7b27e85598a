// SPDX-License-Identifier: BSD-3-Clause
// --memory-limit: which frames may be in work together. What is counted is what frames in work need, and what the library
// keeps in the sessions of workers that have none.
#ifndef HF_CLI_ROOM_H
#define HF_CLI_ROOM_H

#include <stdatomic.h>

#include "tools/cli/frame.h"

struct cli_share {
    struct cli_session *session;
    double held;      // bytes that its library context keeps
    double reserved;  // bytes for the frame in work, held included; 0: none
};

struct cli_room {
    double bytes;  // for all frames together
    double base;   // what the process had before the first
    struct cli_share *shares;
    int count;
    int exploring;       // a frame of a size that was not seen yet is in work, alone
    double most_pixels;  // of the frames so far,
    double per_pixel;    // and what the library kept for one of their pixels, of the largest frames
    atomic_flag lock;
};

// limit: bytes for the process, which has the memory that it has now without frames.
void cli_room_open(struct cli_room *room, double limit);
// Another set of workers. Returns 0, or -1 without memory.
int cli_room_workers(struct cli_room *room, struct cli_session *sessions, int count);
void cli_room_close(struct cli_room *room);

// Wait until there is memory for a frame that was opened and has no pixels yet. A frame that is larger than the limit waits
// until it is alone. Sessions without a frame may lose their library context, context being NULL then.
void cli_room_enter(struct cli_room *room, int worker, const struct cli_frame *frame);
// The frame is closed. pixels and held: of it, and what its context keeps, if it was rendered; else 0 and -1.
void cli_room_leave(struct cli_room *room, int worker, double pixels, double held);

double cli_room_pixels(const struct cli_frame *frame);

#endif
