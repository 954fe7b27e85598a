// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/frames.h"

#include <stdlib.h>
#include <unistd.h>

enum { AHEAD = 48 };

static double size_of(const struct view_picture *p)
{
    const struct hf_io_view *v = view_picture_view(p)->view;
    double bytes = 0;
    for (int i = 0; i < p->frame.view_count; i++)
        bytes += 5.0 * sizeof(float) * p->frame.views[i].view->width * p->frame.views[i].view->height;
    // Half of that again for smaller copies of the view that is shown.
    return bytes + 2.5 * sizeof(float) * v->width * v->height + hf_io_memory(p->frame.file);
}

void view_frames_open(struct view_frames *f, int count)
{
    const double memory = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    view_frames_close(f);
    f->list = calloc((size_t)count + 1, sizeof(struct view_picture *));
    f->count = f->list ? count : 0;
    f->most = MIN(2.0 * (1 << 30), memory / 4);
}

void view_frames_close(struct view_frames *f)
{
    for (int i = 0; i < f->count; i++)
        view_picture_unref(f->list[i]);
    free(f->list);
    *f = (struct view_frames){0};
}

struct view_picture *view_frames_get(const struct view_frames *f, int place)
{
    return place >= 0 && place < f->count ? f->list[place] : NULL;
}

void view_frames_drop(struct view_frames *f, int place)
{
    if (!view_frames_get(f, place))
        return;
    f->bytes -= size_of(f->list[place]);
    view_picture_unref(f->list[place]);
    f->list[place] = NULL;
}

void view_frames_put(struct view_frames *f, int place, struct view_picture *picture, int shown)
{
    if (place < 0 || place >= f->count || f->list[place] == picture)
        return;
    view_frames_drop(f, place);
    f->list[place] = view_picture_ref(picture);
    f->bytes += size_of(picture);
    while (f->bytes > f->most) {
        int farthest = -1;
        for (int i = 0; i < f->count; i++)
            if (f->list[i] && i != place && (farthest < 0 || abs(i - shown) > abs(farthest - shown)))
                farthest = i;
        if (farthest < 0)
            return;
        view_frames_drop(f, farthest);
    }
}

int view_frames_ahead(const struct view_frames *f, int shown)
{
    const struct view_picture *now = view_frames_get(f, shown);
    if (!now)
        return -1;
    for (int i = 1; i <= AHEAD && i < f->count; i++) {
        const int place = (shown + i) % f->count;
        // Only frames that lie nearer than those already held may push others out.
        if (!f->list[place])
            return f->bytes + size_of(now) <= f->most || i < 4 ? place : -1;
    }
    return -1;
}
