// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/room.h"

#include "tools/cli/surfaces.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static const double SLACK = 1.12;   // for what is not counted: headers, tables, scratch of threads
static const double LARGER = 1.25;  // a frame this many times as large as all before is of a new size
static const double WORST = 4;      // the library may take this many times as much for such a frame, by its content

double cli_room_resident(void)
{
    long all, pages = 0;
    FILE *f = fopen("/proc/self/statm", "re");
    if (f && fscanf(f, "%ld %ld", &all, &pages) != 2)
        pages = 0;
    if (f)
        fclose(f);
    return (double)pages * (double)sysconf(_SC_PAGESIZE);
}

void cli_room_open(struct cli_room *room, double limit)
{
    *room = (struct cli_room){.base = cli_room_resident(), .lock = ATOMIC_FLAG_INIT};
    room->bytes = limit - room->base;
}

int cli_room_workers(struct cli_room *room, struct cli_session *sessions, int count)
{
    free(room->shares);
    room->shares = calloc((size_t)count, sizeof(*room->shares));
    room->count = room->shares ? count : 0;
    for (int i = 0; i < room->count; i++)
        room->shares[i].session = &sessions[i];
    return room->shares ? 0 : -1;
}

void cli_room_close(struct cli_room *room)
{
    free(room->shares);
    room->shares = NULL;
}

double cli_room_pixels(const struct cli_frame *frame)
{
    double sum = 0;
    for (int i = 0; i < frame->view_count; i++)
        sum += (double)frame->views[i].view->width * frame->views[i].view->height;
    return sum;
}

double cli_room_file_bytes(const struct cli_frame *frame)
{
    const int planes =
        4 + 1 + (frame->args->depth_file != NULL) + frame->args->grow + 3 * (frame->args->guessed != CLI_GUESSED_NOT);
    double data = 0, display = 0;
    for (int i = 0; i < frame->view_count; i++) {
        const struct hf_io_view *v = frame->views[i].view;
        const struct hf_io_box *b = &v->display_window;
        data += (double)v->width * v->height;
        display += ((double)b->x1 - b->x0) * ((double)b->y1 - b->y0);
    }
    const double grown = frame->args->grow && display > data && data > 0 ? display / data : 1;
    return grown * (data * planes * (double)sizeof(float) + hf_io_memory(frame->file)) + cli_surfaces_bytes(frame);
}

static double taken(const struct cli_room *room)
{
    double sum = 0;
    for (int i = 0; i < room->count; i++)
        sum += room->shares[i].reserved > 0 ? room->shares[i].reserved : room->shares[i].held;
    return sum;
}

static int in_work(const struct cli_room *room)
{
    int n = 0;
    for (int i = 0; i < room->count; i++)
        n += room->shares[i].reserved > 0;
    return n;
}

// Close the library contexts of workers that have no frame now.
static void drop_idle(struct cli_room *room)
{
    for (int i = 0; i < room->count; i++) {
        struct cli_share *s = &room->shares[i];
        if (s->reserved > 0 || !(s->held > 0))
            continue;
        hf_close(&s->session->context);
        s->held = 0;
    }
}

// Give freed memory back to the system if it would leave too little room for `more` bytes.
static void give_back(const struct cli_room *room, double more)
{
#ifdef __GLIBC__
    if (cli_room_resident() + more > room->base + room->bytes)
        malloc_trim(0);
#else
    (void)room, (void)more;
#endif
}

// May the frame begin now? The caller holds the lock.
static int try_enter(struct cli_room *room, struct cli_share *own, double file, double pixels)
{
    const double library = SLACK * room->per_pixel * pixels;
    const int others = in_work(room), is_new = pixels > LARGER * room->most_pixels;
    const double worst = SLACK * file + fmax(is_new ? WORST * library : library, own->held);
    if (room->exploring && others)
        return 0;
    if (taken(room) - own->held + worst > room->bytes) {
        if (room->count > 1)
            drop_idle(room);
        // A frame that is alone may exceed the limit.
        if (others && taken(room) - own->held + worst > room->bytes)
            return 0;
        room->exploring = !others && is_new;
    }
    const double need = SLACK * file + fmax(library, own->held);
    give_back(room, need - own->held);
    own->reserved = need;
    return 1;
}

static void lock(struct cli_room *room)
{
    const struct timespec pause = {.tv_nsec = 20000};
    while (atomic_flag_test_and_set(&room->lock))
        nanosleep(&pause, NULL);
}

void cli_room_enter(struct cli_room *room, int worker, const struct cli_frame *frame)
{
    const struct timespec pause = {.tv_nsec = 2000000};
    const double file = cli_room_file_bytes(frame), pixels = cli_room_pixels(frame);
    for (int entered = 0; !entered;) {
        lock(room);
        entered = try_enter(room, &room->shares[worker], file, pixels);
        atomic_flag_clear(&room->lock);
        if (!entered)
            nanosleep(&pause, NULL);
    }
}

void cli_room_leave(struct cli_room *room, int worker, double pixels, double held)
{
    struct cli_share *own = &room->shares[worker];
    lock(room);
    if (held >= 0)
        own->held = held;
    if (pixels > 0 && held >= 0) {
        const double ratio = held / pixels;
        // Part of the library's memory is the same for all sizes, so the bytes per pixel of small frames say little
        // about large ones.
        if (pixels > LARGER * room->most_pixels)
            room->per_pixel = ratio;
        else if (pixels * LARGER >= room->most_pixels)
            room->per_pixel = fmax(room->per_pixel, ratio);
        room->most_pixels = fmax(room->most_pixels, pixels);
    }
    if (own->reserved > 0 && in_work(room) == 1)
        room->exploring = 0;
    own->reserved = 0;
    atomic_flag_clear(&room->lock);
}
