// SPDX-License-Identifier: BSD-3-Clause
// hyperfocal-bench measures whole frames. tests/kernels measures single kernels.
#include "commands.h"

#include "tools/common/nearest.h"
#include "tools/common/options.h"
#include "tools/common/standard.h"

#include <stdio.h>
#include <string.h>

const char *const bench_command_words[][2] = {
    {"passes", "time of each pass of a frame, beside table 3.1 of the chapter"},
    {"batch", "the command on a shot, beside copying its files and beside oiiotool, which must be there"},
    {"truth", "distance of each engine from ray-traced pictures, and its time"},
    {"tradeoff", "time and error of every setting, and which settings are worth having"},
    {"scaling", "time of a frame as its blurred part and its size grow; --size: up to that width"},
    {"formats", "time to read and to store each format of colour and of depth, and of a frame"},
    {"cancel", "how long a cancelled frame takes to return, in all engines: median and worst"},
    {"stability", "hard cases of all engines or one: the case, its bound, the worst value seen"},
    {"history", "frames, memory and distances from commit to commit; --add measures this one"},
    {NULL, NULL},
};
// In the same order.
static bench_command *const commands[] = {bench_passes,  bench_batch,  bench_truth,     bench_tradeoff, bench_scaling,
                                          bench_formats, bench_cancel, bench_stability, bench_history};

static int run(int argc, char **argv, struct tool_error *error)
{
    struct bench_args args;
    int c = 0;
    if (argc < 2)
        return tool_fail(error, -1, "a command is needed, see hyperfocal-bench --help");
    while (bench_command_words[c][0] && strcmp(argv[1], bench_command_words[c][0]))
        c++;
    bench_args_default(&args);
    // The first word may be an option such as --help instead of a command.
    const int known = bench_command_words[c][0] != NULL;
    if (!known && argv[1][0] != '-') {
        struct tool_nearest nearest = {NULL, 0, 0};
        for (c = 0; bench_command_words[c][0]; c++)
            tool_nearest_try(&nearest, bench_command_words[c][0], (int)strlen(bench_command_words[c][0]), argv[1]);
        return tool_fail(error, -1, "there is no command '%s',%s%s%s see hyperfocal-bench --help", argv[1],
                         nearest.word ? " did you mean " : "", nearest.word ? nearest.word : "",
                         nearest.word ? "?" : "");
    }
    if (bench_args_parse(&args, bench_command_words[c][0], argc - 1 - known, argv + 1 + known, error))
        return -1;
    if (args.help > 2)
        tool_print_man(&bench_program);
    else if (args.help)
        tool_print_help(&bench_program, bench_command_words[c][0], 1);
    if (args.help)
        return fflush(stdout) ? tool_fail(error, -1, "standard output could not be written") : 0;
    if (!known)
        return tool_fail(error, -1, "a command is needed before %s, see hyperfocal-bench --help", argv[1]);
    return commands[c](&args, error);
}

int main(int argc, char **argv)
{
    tool_open_standard();
    struct tool_error error = {""};
    tool_program = "hyperfocal-bench";
    if (!run(argc, argv, &error))
        return 0;
    tool_print_line("%s", error.text);
    return 1;
}
