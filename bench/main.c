// SPDX-License-Identifier: BSD-3-Clause
// hyperfocal-bench: measures whole frames. Single kernels are the business of tests/kernels.
#include "commands.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    bench_command *run;
    const char *help;
} commands[] = {
    {"passes", bench_passes, "time of each pass of a frame, beside table 3.1 of the chapter"},
    {"batch", bench_batch, "the command on a shot, beside copying its files and beside oiiotool, which must be there"},
    {"truth", bench_truth, "distance of each engine from ray-traced pictures, and its time"},
    {"tradeoff", bench_tradeoff, "what every step of accuracy costs in time, and which settings are worth it"},
    {"scaling", bench_scaling, "time of a frame as its blurred part and its size grow; --size: up to that width"},
    {"stability", bench_stability,
     "hard cases: what was tried, the bound, the worst value seen; of all engines or one"},
};
enum { COMMANDS = sizeof commands / sizeof *commands };

static int fail(const struct bench_error *error)
{
    fprintf(stderr, "hyperfocal-bench: %s\n", error->text);
    return 1;
}

static int help(void)
{
    fputs("usage: hyperfocal-bench COMMAND [options]\n\nCommands:\n", stdout);
    for (int i = 0; i < COMMANDS; i++)
        printf("  %-25s %s\n", commands[i].name, commands[i].help);
    fputs("\nOptions (defaults in brackets):\n", stdout);
    bench_args_help(stdout);
    return fflush(stdout) != 0;
}

int main(int argc, char **argv)
{
    struct bench_error error = {""};
    if (argc < 2) {
        bench_fail(&error, "a command is needed; see hyperfocal-bench --help");
        return fail(&error);
    }
    if (!strcmp(argv[1], "-h") || !strcmp(argv[1], "--help"))
        return help();
    for (int i = 0; i < COMMANDS; i++) {
        if (strcmp(argv[1], commands[i].name))
            continue;
        struct bench_args args;
        bench_args_default(&args);
        if (bench_args_parse(&args, argc - 2, argv + 2, &error))
            return fail(&error);
        if (args.help)
            return help();
        return commands[i].run(&args, &error) ? fail(&error) : 0;
    }
    bench_fail(&error, "there is no command '%s'; see hyperfocal-bench --help", argv[1]);
    return fail(&error);
}
