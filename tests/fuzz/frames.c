// SPDX-License-Identifier: BSD-3-Clause
// Lists of frames: a byte for how many of them are there and one for the room of a text, then the list.
#include <string.h>

#include "tools/cli/frames.h"
#include "fuzz/fuzz.h"

static int by_number(const void *a, const void *b)
{
    const int x = *(const int *)a, y = *(const int *)b;
    return (x > y) - (x < y);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct bytes b = {data, size};
    const int one_in = 1 + (int)(take_byte(&b) % 5);
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
        qsort(frames.list, (size_t)frames.count, sizeof *frames.list, by_number);
        MUST(frames.list[0] >= -CLI_MAX_FRAME && frames.list[frames.count - 1] <= CLI_MAX_FRAME);
        for (int i = 1; i < frames.count; i++)
            MUST(frames.list[i] > frames.list[i - 1]);
        const long span = (long)frames.list[frames.count - 1] - frames.list[0] + 1;
        MUST(cli_frames_gaps(&frames, gaps, room) == span - frames.count);
        MUST(memchr(gaps, 0, room) != NULL);
        const struct cli_frames there = {frames.list, frames.count / one_in, frames.room};
        MUST(cli_frames_missing(&frames, &there, gaps, room) == frames.count - there.count);
        MUST(memchr(gaps, 0, room) != NULL);
        cli_frames_free(&frames);
    }
    free(gaps);
    free(text);
    return 0;
}
