// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/target.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/io/io.h"

// The directory that a path lies in; to be freed.
static char *directory_of(const char *path)
{
    char *dir = strdup(path);
    char *slash = dir ? strrchr(dir, '/') : NULL;
    if (slash == dir && slash)
        slash[1] = '\0';
    else if (slash)
        *slash = '\0';
    else if (dir) {
        free(dir);
        dir = strdup(".");
    }
    return dir;
}

static int check_directory(const char *dir, const char *option, const char *path, struct tool_error *error)
{
    struct stat st;
    if (stat(dir, &st) == 0 && !S_ISDIR(st.st_mode))
        errno = ENOTDIR;
    else if (access(dir, W_OK | X_OK) == 0)
        return 0;
    return tool_fail(error, CLI_BAD_ARGUMENTS, "%s %s cannot be written: %s: %s", option, path, dir, strerror(errno));
}

// A file is written beside its target and then renamed, so the directory must be writable and an existing target
// replaceable.
static int check_file(const char *path, const char *option, int replaced, struct tool_error *error)
{
    struct stat st;
    if (stat(path, &st) == 0 && (S_ISDIR(st.st_mode) || (replaced && !S_ISREG(st.st_mode))))
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s %s cannot be written: it is %s", option, path,
                         S_ISDIR(st.st_mode) ? "a directory" : "not a regular file");
    char *dir = directory_of(path);
    if (!dir)
        return tool_fail(error, CLI_ALL_FAILED, "%s %s: out of memory", option, path);
    // A device is written where it is.
    const int in_place = !replaced && stat(path, &st) == 0 && !S_ISREG(st.st_mode);
    const int status = in_place ? 0 : check_directory(dir, option, path, error);
    free(dir);
    return status;
}

static int check_dump_dir(const char *dir, struct tool_error *error)
{
    struct stat st;
    if (stat(dir, &st) == 0)
        return check_directory(dir, "--dump-passes", dir, error);
    char *path = strdup(dir);
    for (size_t n = path ? strlen(path) : 0; n > 1 && path[n - 1] == '/'; n--)
        path[n - 1] = '\0';
    char *parent = path ? directory_of(path) : NULL;
    const int status = parent ? check_directory(parent, "--dump-passes", dir, error)
                              : tool_fail(error, CLI_ALL_FAILED, "--dump-passes %s: out of memory", dir);
    free(parent);
    free(path);
    return status;
}

// The files that the arguments name.
struct named {
    const char *option, *path;
    int output;
};

enum { NAMED = 10 };

static void list_files(const struct cli_args *args, struct named files[NAMED])
{
    const struct named all[NAMED] = {
        {"INPUT", args->input, 0},
        {"--depth-file", args->depth_file, 0},
        {"--aperture", args->aperture_file, 0},
        {"--keys", args->keys, 0},
        {"-o", args->output, 1},
        {"--json", args->json_file, 1},
        {"--explain-image", args->explain_image, 1},
        {"--focus-image", args->focus_image, 1},
        {"--guessed-image", args->guessed_image, 1},
        {"--log", args->log_file, 1},
    };
    memcpy(files, all, sizeof(all));
}

int cli_check_overwrite(const struct cli_args *args, const char *option, const char *path, struct tool_error *error)
{
    struct named files[NAMED];
    list_files(args, files);
    for (int i = 0; i < NAMED; i++) {
        if (!files[i].path || !strcmp(files[i].option, option) || !hf_io_same_file(path, files[i].path))
            continue;
        // -o INPUT is the one way to change a picture in place.
        if (!strcmp(option, "-o") && !strcmp(files[i].option, "INPUT"))
            continue;
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s %s would write over %s %s, the same file", option, path,
                         files[i].option, files[i].path);
    }
    for (int i = 0; i < args->other_count; i++)
        if (hf_io_same_file(path, args->others[i]))
            return tool_fail(error, CLI_BAD_ARGUMENTS, "%s %s would write over %s %s, the same file", option, path,
                             args->other_option, args->others[i]);
    return 0;
}

int cli_is_in_place(const struct cli_args *args)
{
    char *input = realpath(args->input, NULL), *output = realpath(args->output, NULL);
    const int same = input && output && !strcmp(input, output);
    free(input);
    free(output);
    return same;
}

int cli_check_targets(const struct cli_args *args, struct tool_error *error)
{
    struct hf_io_error io;
    struct named files[NAMED];
    int status = 0;
    list_files(args, files);
    for (int i = 0; i < NAMED && !status; i++) {
        const struct named *f = &files[i];
        if (!f->output || !f->path)
            continue;
        const int json = f->path == args->json_file;
        status = cli_check_overwrite(args, f->option, f->path, error);
        if (f->path == args->log_file)
            continue;  // the log is appended to, and opening it reports errors
        if (!status)
            status = check_file(f->path, f->option, !json, error);
        if (!status && !json && hf_io_check_format(f->path, &io))
            status =
                tool_fail(error, io.may_pass ? CLI_ALL_FAILED : CLI_BAD_ARGUMENTS, "%s: %s", f->option, io.message);
    }
    if (!status && args->dump_dir)
        status = check_dump_dir(args->dump_dir, error);
    return status;
}
