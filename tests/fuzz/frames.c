// SPDX-License-Identifier: BSD-3-Clause
// Lists of frames: two bytes for a part of them, then the list.
#include <string.h>

#include "cli/frames.h"
#include "fuzz/fuzz.h"

static int by_number(const void *a, const void *b)
{
    const int x = *(const int *)a, y = *(const int *)b;
    return (x > y) - (x < y);
}

// The parts are the whole, in order.
static void check_parts(const char *text, const struct cli_frames *whole, int parts)
{
    struct tool_error error = {""};
    int next = 0;
    for (int part = 0; part < parts; part++) {
        struct cli_frames some;
        MUST(cli_frames_parse(&some, text, &error) == 0);
        cli_frames_chunk(&some, part, parts);
        MUST(next + some.count <= whole->count);
        MUST(!memcmp(some.list, whole->list + next, (size_t)some.count * sizeof *some.list));
        next += some.count;
        cli_frames_free(&some);
    }
    MUST(next == whole->count);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct bytes b = {data, size};
    const int parts = 1 + (int)(take_byte(&b) % 5);
    const size_t room = 1 + take_byte(&b);
    char *text = malloc(b.size + 1), *gaps = malloc(room);
    struct cli_frames frames;
    struct tool_error error = {""};
    MUST(text && gaps);
    memcpy(text, b.data, b.size);
    text[b.size] = 0;
    const int status = cli_frames_parse(&frames, text, &error);
    MUST((status == 0) == (error.text[0] == 0));
    if (!status) {
        MUST(frames.count > 0 && frames.count <= CLI_MAX_FRAMES);
        if (frames.count < 10000)
            check_parts(text, &frames, parts);
        qsort(frames.list, (size_t)frames.count, sizeof *frames.list, by_number);
        MUST(frames.list[0] >= -CLI_MAX_FRAME && frames.list[frames.count - 1] <= CLI_MAX_FRAME);
        for (int i = 1; i < frames.count; i++)
            MUST(frames.list[i] > frames.list[i - 1]);
        const long span = (long)frames.list[frames.count - 1] - frames.list[0] + 1;
        MUST(cli_frames_gaps(&frames, gaps, room) == span - frames.count);
        MUST(memchr(gaps, 0, room) != NULL);
        cli_frames_free(&frames);
    }
    free(gaps);
    free(text);
    return 0;
}
