// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/frames.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// One item of the list: from, to, and how to step.
struct range {
    int from, to, step;
    char by;  // 'x', 'y', ':'
};

void cli_frames_free(struct cli_frames *frames)
{
    free(frames->list);
    *frames = (struct cli_frames){0};
}

int cli_frames_add(struct cli_frames *frames, int frame)
{
    if (frames->count == frames->room) {
        const int room = frames->room ? 2 * frames->room : 64;
        int *list = realloc(frames->list, (size_t)room * sizeof(*list));
        if (!list)
            return -1;
        frames->list = list;
        frames->room = room;
    }
    frames->list[frames->count++] = frame;
    return 0;
}

static int read_frame(const char **text, int *frame)
{
    const char *c = *text;
    char *end;
    if (!isdigit((unsigned char)c[c[0] == '-']))
        return -1;
    errno = 0;
    const long v = strtol(c, &end, 10);
    if (errno || v < -CLI_MAX_FRAME || v > CLI_MAX_FRAME)
        return -1;
    *frame = (int)v;
    *text = end;
    return 0;
}

static int read_range(const char **text, struct range *r)
{
    *r = (struct range){.step = 1, .by = 'x'};
    if (read_frame(text, &r->from))
        return -1;
    r->to = r->from;
    if (**text != '-')
        return 0;
    ++*text;
    if (read_frame(text, &r->to))
        return -1;
    if (**text != 'x' && **text != 'y' && **text != ':')
        return 0;
    r->by = *(*text)++;
    // A minus sign before the step says what the order of the ends says already.
    if (read_frame(text, &r->step) || r->step == 0)
        return -1;
    r->step = abs(r->step);
    return 0;
}

// Frames by the step; those that it leaves out when others is set.
static int add_steps(struct cli_frames *frames, const struct range *r, int step, int others)
{
    const int sign = r->to < r->from ? -1 : 1, last = abs(r->to - r->from);
    for (int i = 0; i <= last; i += others ? 1 : step) {
        if (others && i % step == 0)
            continue;
        if (frames->count >= CLI_MAX_FRAMES || cli_frames_add(frames, r->from + sign * i))
            return -1;
        if (i > last - step && !others)
            break;
    }
    return 0;
}

// Every step-th first, then every (step - 1)-th ...: what comes again is removed with all other repetitions.
static int add_range(struct cli_frames *frames, const struct range *r)
{
    if (r->by != ':')
        return add_steps(frames, r, r->step, r->by == 'y');
    const int span = abs(r->to - r->from) + 1;
    for (int step = r->step < span ? r->step : span; step > 0; step--)
        if (add_steps(frames, r, step, 0))
            return -1;
    return 0;
}

struct numbered {
    int frame, place;
};

static int by_frame(const void *a, const void *b)
{
    const struct numbered *x = a, *y = b;
    return x->frame != y->frame ? (x->frame > y->frame) - (x->frame < y->frame) : x->place - y->place;
}

static int by_place(const void *a, const void *b)
{
    return ((const struct numbered *)a)->place - ((const struct numbered *)b)->place;
}

static int remove_repeated(struct cli_frames *frames)
{
    const size_t n = (size_t)frames->count;
    struct numbered *all = malloc(n * sizeof(*all));
    if (!all)
        return -1;
    for (size_t i = 0; i < n; i++)
        all[i] = (struct numbered){frames->list[i], (int)i};
    qsort(all, n, sizeof(*all), by_frame);
    size_t kept = 0;
    for (size_t i = 0; i < n; i++)
        if (!kept || all[kept - 1].frame != all[i].frame)
            all[kept++] = all[i];
    qsort(all, kept, sizeof(*all), by_place);
    for (size_t i = 0; i < kept; i++)
        frames->list[i] = all[i].frame;
    frames->count = (int)kept;
    free(all);
    return 0;
}

int cli_frames_parse(struct cli_frames *frames, const char *text, struct tool_error *error)
{
    const char *c = text;
    *frames = (struct cli_frames){0};
    for (;;) {
        const char *item = c;
        struct range r;
        if (read_range(&c, &r) || (*c && *c != ',')) {
            cli_frames_free(frames);
            return tool_fail(error, -1,
                             "--frames: '%.*s' of '%s' is not a range of frames such as 7, 1-100, 1-100x2, 10-1 or "
                             "1-100:3",
                             (int)strcspn(item, ","), item, text);
        }
        if (add_range(frames, &r)) {
            cli_frames_free(frames);
            return tool_fail(error, -1, "--frames: '%s' has more than %d frames", text, CLI_MAX_FRAMES);
        }
        if (!*c)
            break;
        c++;
    }
    if (frames->count == 0 || remove_repeated(frames)) {
        const int none = frames->count == 0;
        cli_frames_free(frames);
        return tool_fail(error, -1, none ? "--frames: '%s' has no frame" : "--frames: '%s': out of memory", text);
    }
    return 0;
}

// "4, 7-9", cut off at size.
static void say_range(char *buf, size_t size, int from, int to)
{
    const size_t used = strlen(buf);
    if (used + 32 >= size)
        return;
    const int n = snprintf(buf + used, size - used, "%s%d", used ? ", " : "", from);
    if (to > from)
        snprintf(buf + used + n, size - used - (size_t)n, "-%d", to);
}

int cli_frames_gaps(const struct cli_frames *sorted, char *buf, size_t size)
{
    int missing = 0;
    buf[0] = '\0';
    for (int i = 1; i < sorted->count; i++) {
        const int from = sorted->list[i - 1] + 1, to = sorted->list[i] - 1;
        if (from > to)
            continue;
        missing += to - from + 1;
        say_range(buf, size, from, to);
    }
    return missing;
}

static int compare(const void *a, const void *b)
{
    const int x = *(const int *)a, y = *(const int *)b;
    return (x > y) - (x < y);
}

int cli_frames_missing(const struct cli_frames *asked, const struct cli_frames *sorted, char *buf, size_t size)
{
    const size_t bytes = (size_t)asked->count * sizeof(*asked->list);
    int *list = malloc(bytes + 1), missing = 0;
    buf[0] = '\0';
    if (!list)
        return -1;
    memcpy(list, asked->list, bytes);
    qsort(list, (size_t)asked->count, sizeof(*list), compare);
    for (int i = 0, at = 0; i < asked->count; i++) {
        while (at < sorted->count && sorted->list[at] < list[i])
            at++;
        if (at == sorted->count || sorted->list[at] != list[i])
            list[missing++] = list[i];
    }
    for (int from = 0, to; from < missing; from = to + 1) {
        for (to = from; to + 1 < missing && list[to + 1] == list[to] + 1;)
            to++;
        say_range(buf, size, list[from], list[to]);
    }
    free(list);
    return missing;
}
