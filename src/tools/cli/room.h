// SPDX-License-Identifier: BSD-3-Clause
// --memory-limit: which frames may be made at the same time. The sum counts what these frames need and what the
// library keeps in the sessions of idle workers.
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
    double base;   // what the process used before the first frame
    struct cli_share *shares;
    int count;
    int exploring;       // a frame larger than all before is being made, alone
    double most_pixels;  // of the largest frame so far
    double per_pixel;    // bytes that the library kept per pixel of the largest frames
    atomic_flag lock;
};

// limit: bytes for the whole process. What it uses now is not for frames.
void cli_room_open(struct cli_room *room, double limit);
// Set the workers. Returns 0, or -1 without memory.
int cli_room_workers(struct cli_room *room, struct cli_session *sessions, int count);
void cli_room_close(struct cli_room *room);

// Wait until there is memory for a frame that is open but has no pixels yet. A frame that is larger than the limit
// waits until it is alone. Idle sessions may lose their library context; their context is NULL then.
void cli_room_enter(struct cli_room *room, int worker, const struct cli_frame *frame);
// Call when the frame is closed. If it was rendered, pixels is its size and held is the bytes that its context keeps;
// else 0 and -1.
void cli_room_leave(struct cli_room *room, int worker, double pixels, double held);

double cli_room_pixels(const struct cli_frame *frame);
// Bytes of a frame without the library's: the stored file, its samples, those of the new file, and the planes.
double cli_room_file_bytes(const struct cli_frame *frame);
// Bytes that the process holds, including memory that it freed but did not give back. 0: not known.
double cli_room_resident(void);

#endif
