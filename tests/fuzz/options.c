// SPDX-License-Identifier: BSD-3-Clause
// The command line's parser: one argument a line.
#include <string.h>

#include "tools/cli/args.h"
#include "fuzz/fuzz.h"

enum { MAX_ARGS = 40 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1), *argv[MAX_ARGS + 2] = {(char *)"hyperfocal"};
    int argc = 1;
    MUST(text != NULL);
    memcpy(text, data, size);
    text[size] = 0;
    for (char *line = text; line && argc <= MAX_ARGS;) {
        char *end = strchr(line, '\n');
        if (end)
            *end++ = 0;
        argv[argc++] = line;
        line = end;
    }
    struct cli_args args;
    struct tool_error error = {""};
    const int err = cli_parse_args(&args, argc, argv, &error);
    // A refused line gives one sentence, an accepted one none; the sentence has no line break and no terminal escape.
    MUST(err == 0 || err == -1);
    MUST(!err == !error.text[0]);
    MUST(memchr(error.text, 0, sizeof error.text) != NULL);
    cli_free_args(&args);
    free(text);
    return 0;
}
