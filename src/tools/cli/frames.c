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

// Fill the error that refuses a list of frames.
enum fault { NO_FAULT, NO_RANGE, TOO_HIGH, TOO_MANY, NO_MEMORY };

static enum fault read_frame(const char **text, int *frame)
{
    const char *c = *text;
    char *end;
    if (!isdigit((unsigned char)c[c[0] == '-']))
        return NO_RANGE;
    errno = 0;
    const long v = strtol(c, &end, 10);
    if (errno || v < -CLI_MAX_FRAME || v > CLI_MAX_FRAME)
        return TOO_HIGH;
    *frame = (int)v;
    *text = end;
    return NO_FAULT;
}

static enum fault read_range(const char **text, struct range *r)
{
    *r = (struct range){.step = 1, .by = 'x'};
    enum fault fault = read_frame(text, &r->from);
    r->to = r->from;
    if (fault || **text != '-')
        return fault;
    ++*text;
    fault = read_frame(text, &r->to);
    if (fault || (**text != 'x' && **text != 'y' && **text != ':'))
        return fault;
    r->by = *(*text)++;
    // A minus sign before the step is accepted: the order of the ends says the same.
    fault = read_frame(text, &r->step);
    r->step = abs(r->step);
    return fault || r->step ? fault : NO_RANGE;
}

static enum fault add(struct cli_frames *frames, int frame)
{
    return frames->count >= CLI_MAX_FRAMES ? TOO_MANY : cli_frames_add(frames, frame) ? NO_MEMORY : NO_FAULT;
}

// For 1-100:3: every third frame first, then every second that is not in yet, then the rest.
static enum fault add_in_turns(struct cli_frames *frames, const struct range *r, int sign, int span)
{
    char *there = calloc((size_t)span, 1);
    enum fault fault = there ? NO_FAULT : NO_MEMORY;
    for (int step = r->step < span ? r->step : span; step > 0 && !fault; step--)
        for (int i = 0; i < span && !fault; i += step)
            if (!there[i]) {
                there[i] = 1;
                fault = add(frames, r->from + sign * i);
            }
    free(there);
    return fault;
}

// The frames of a range, each once.
static enum fault add_range(struct cli_frames *frames, const struct range *r)
{
    const int sign = r->to < r->from ? -1 : 1, span = abs(r->to - r->from) + 1, every = (span - 1) / r->step + 1;
    const int count = r->by == 'x' ? every : r->by == 'y' ? span - every : span;
    enum fault fault = count > CLI_MAX_FRAMES - frames->count ? TOO_MANY : NO_FAULT;
    if (!count || fault)
        return fault;
    if (r->by == ':')
        return add_in_turns(frames, r, sign, span);
    for (int i = 0; i < every && !fault; i++) {
        const int first = r->by == 'x' ? i * r->step : i * r->step + 1,
                  last = r->by == 'x' ? first : first + r->step - 2;
        for (int k = first; k <= last && k < span && !fault; k++)
            fault = add(frames, r->from + sign * k);
    }
    return fault;
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

static int refuse(struct cli_frames *frames, enum fault fault, const char *item, const char *text,
                  struct tool_error *error)
{
    const int whole = (int)strcspn(item, ","), length = whole < 100 ? whole : 100;
    cli_frames_free(frames);
    switch (fault) {
    case TOO_HIGH:
        return tool_fail(error, -1, "--frames: '%.*s' of '%.200s': frames are numbered from %d to %d", length, item,
                         text, -CLI_MAX_FRAME, CLI_MAX_FRAME);
    case TOO_MANY:
        return tool_fail(error, -1, "--frames: '%.200s' has more than %d frames", text, CLI_MAX_FRAMES);
    case NO_MEMORY:
        return tool_fail(error, -1, "--frames: '%.200s': out of memory", text);
    default:
        return tool_fail(error, -1,
                         "--frames: '%.*s' of '%.200s' is not a range of frames such as 7, 1-100, 1-100x2, 10-1 or "
                         "1-100:3",
                         length, item, text);
    }
}

int cli_frames_parse(struct cli_frames *frames, const char *text, struct tool_error *error)
{
    const char *c = text;
    *frames = (struct cli_frames){0};
    for (;;) {
        const char *item = c;
        struct range r;
        enum fault fault = read_range(&c, &r);
        if (!fault)
            fault = *c && *c != ',' ? NO_RANGE : add_range(frames, &r);
        if (fault)
            return refuse(frames, fault, item, text, error);
        if (!*c)
            break;
        c++;
    }
    if (frames->count == 0)
        return tool_fail(error, -1, "--frames: '%.200s' has no frame", text);
    return remove_repeated(frames) ? refuse(frames, NO_MEMORY, text, text, error) : 0;
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
