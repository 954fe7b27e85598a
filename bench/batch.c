// SPDX-License-Identifier: BSD-3-Clause
// What a shot costs. It runs the command on a shot made of one of the project's pictures, a copy of the shot's files,
// and oiiotool reading and writing them, alternately and for each compression.
#include "commands.h"
#include "statistics.h"
#include "tools/common/machine.h"
#include "write.h"

#include <errno.h>
#include <libgen.h>
#include <limits.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { TURNS = 3, MAX_WORDS = 48, STAGES = 6 };
static const char *const compressions[] = {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"};
enum { COMPRESSIONS = sizeof(compressions) / sizeof(compressions[0]) };
static const char *const stage_names[STAGES] = {"read", "decode", "defocus", "encode", "write", "wait"};

// Results for one compression: seconds are medians, shares are of the threads' time.
struct row {
    const char *compression;
    double batch, copy, oiiotool;
    double stage[STAGES];
    double peak_memory;  // bytes
};

struct bench {
    const struct bench_args *args;
    char program[PATH_MAX], dir[PATH_MAX];
    char threads[16], frames[32], size[32];
    struct tool_error *error;
    struct row rows[COMPRESSIONS];
    int count;
};

// Run a program with the words that follow its name, up to NULL; its output is discarded. Returns seconds, or -1 with
// *error filled.
static double run(const struct bench *b, const char *const words[])
{
    posix_spawn_file_actions_t quiet;
    pid_t pid;
    int status = -1;
    posix_spawn_file_actions_init(&quiet);
    posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", 1, 0);
    posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", 1, 0);
    const double start = tool_now_ms();
    const int failed = posix_spawnp(&pid, words[0], &quiet, NULL, (char *const *)words, environ);
    if (!failed)
        waitpid(pid, &status, 0);
    const double seconds = 1e-3 * (tool_now_ms() - start);
    posix_spawn_file_actions_destroy(&quiet);
    if (failed)
        return tool_fail(b->error, -1, "%s cannot be started: %s", words[0], strerror(failed));
    if (!WIFEXITED(status) || WEXITSTATUS(status))
        return tool_fail(b->error, -1, "%s failed, status %d, in %s", words[0], status, b->dir);
    return seconds;
}

// Find the command of this build, else the installed one.
static void find_program(struct bench *b)
{
    static const char *const places[] = {"../src/tools/cli/hyperfocal", "hyperfocal"};
    char self[PATH_MAX];
    const ssize_t n = readlink("/proc/self/exe", self, sizeof(self) - 1);
    self[n > 0 ? n : 0] = '\0';
    char *folder = dirname(self);
    for (size_t i = 0; i < sizeof(places) / sizeof(places[0]); i++) {
        snprintf(b->program, sizeof(b->program), "%.2000s/%s", folder, places[i]);
        if (!access(b->program, X_OK))
            return;
    }
    snprintf(b->program, sizeof(b->program), "hyperfocal");
}

static char *name(const struct bench *b, const char *file, char buf[PATH_MAX])
{
    snprintf(buf, PATH_MAX, "%.2000s/%s", b->dir, file);
    return buf;
}

// Make the shot: each frame is the picture moved by some pixels, in half floats, depth included.
static int make_shot(const struct bench *b, const char *compression)
{
    char source[PATH_MAX], file[64], target[PATH_MAX], shift[32];
    snprintf(source, sizeof(source), "%.2000s/foliage.exr", b->args->images);
    for (int i = 1; i <= b->args->frames; i++) {
        snprintf(file, sizeof(file), "in.%04d.exr", i);
        snprintf(shift, sizeof(shift), "+%d+0", 3 * i);
        const char *const words[] = {
            "oiiotool",  source, "--resize:filter=box", b->size, "--cshift", shift, "-d", "half", "--compression",
            compression, "-o",   name(b, file, target), NULL};
        if (run(b, words) < 0)
            return -1;
    }
    return 0;
}

static double run_copy(const struct bench *b)
{
    char script[2 * PATH_MAX];
    snprintf(script, sizeof(script), "for f in '%.2000s'/in.*; do cp \"$f\" \"${f%%/*}/copy.${f##*/}\" || exit 1; done",
             b->dir);
    const char *const words[] = {"sh", "-c", script, NULL};
    return run(b, words);
}

static double run_oiiotool(const struct bench *b)
{
    char in[PATH_MAX], out[PATH_MAX];
    const char *const words[] = {"oiiotool", "--threads",
                                 b->threads, "--frames",
                                 b->frames,  name(b, "in.#.exr", in),
                                 "-o",       name(b, "oiio.#.exr", out),
                                 NULL};
    return run(b, words);
}

static double run_batch(const struct bench *b, const char *log)
{
    char in[PATH_MAX], out[PATH_MAX];
    const char *words[MAX_WORDS] = {
        b->program, name(b, "in.####.exr", in), "-o", name(b, "out.####.exr", out), "--threads", b->threads, "--log",
        log};
    int n = 8;
    if (b->args->engine_given) {
        words[n++] = "--engine";
        words[n++] = hf_engine_name(b->args->params.engine);
    }
    return run(b, words);
}

// A number of the log's last line, 0 if it is missing.
static double logged(const char *line, const char *key)
{
    char quoted[64];
    snprintf(quoted, sizeof(quoted), "\"%s\": ", key);
    const char *at = strstr(line, quoted);
    return at ? strtod(at + strlen(quoted), NULL) : 0;
}

static int read_log(const struct bench *b, const char *path, struct row *row)
{
    char line[1 << 14] = "", key[32];
    FILE *in = fopen(path, "r");
    if (!in)
        return tool_fail(b->error, -1, "%s cannot be read: %s", path, strerror(errno));
    while (fgets(line, sizeof(line), in))
        ;
    fclose(in);
    const double seconds = logged(line, "seconds"), all = seconds * logged(line, "at_once");
    double busy = 0;
    for (int s = 0; s < STAGES - 1; s++) {
        snprintf(key, sizeof(key), "%s_ms", stage_names[s]);
        row->stage[s] = all > 0 ? logged(line, key) / 1000 / all : 0;
        busy += row->stage[s];
    }
    row->stage[STAGES - 1] = busy < 1 ? 1 - busy : 0;
    row->peak_memory = logged(line, "peak_memory");
    return 0;
}

static int measure(const struct bench *b, const char *compression, struct row *row)
{
    char log[PATH_MAX];
    double batch[TURNS], copy[TURNS], oiiotool[TURNS];
    *row = (struct row){.compression = compression};
    if (make_shot(b, compression))
        return -1;
    for (int i = 0; i < TURNS; i++) {
        if ((batch[i] = run_batch(b, name(b, "log", log))) < 0 || (oiiotool[i] = run_oiiotool(b)) < 0 ||
            (copy[i] = run_copy(b)) < 0)
            return -1;
    }
    row->batch = bench_median(batch, TURNS);
    row->copy = bench_median(copy, TURNS);
    row->oiiotool = bench_median(oiiotool, TURNS);
    return read_log(b, log, row);
}

static void print_row(const struct bench *b, const struct row *r)
{
    printf("%-6s %9.2f %9.2f %9.2f %9.2f", r->compression, b->args->frames / r->batch, b->args->frames / r->copy,
           b->args->frames / r->oiiotool, r->batch / r->oiiotool);
    for (int s = 0; s < STAGES; s++)
        printf(" %7.1f%%", 100 * r->stage[s]);
    printf(" %8.0f\n", r->peak_memory / (1 << 20));
    fflush(stdout);
}

static void json(FILE *out, const void *what)
{
    const struct bench *b = what;
    struct tool_json j;
    bench_json_begin(&j, out, "batch", b->args);
    tool_json_count(&j, "width", b->args->width);
    tool_json_count(&j, "height", b->args->height);
    tool_json_count(&j, "frames", b->args->frames);
    tool_json_count(&j, "threads", atoi(b->threads));
    tool_json_open(&j, "rows", '[');
    for (int i = 0; i < b->count; i++) {
        const struct row *r = &b->rows[i];
        tool_json_row(&j, NULL, '{');
        tool_json_text(&j, "compression", r->compression);
        tool_json_number(&j, "seconds", r->batch);
        tool_json_number(&j, "copy_seconds", r->copy);
        tool_json_number(&j, "oiiotool_seconds", r->oiiotool);
        tool_json_number(&j, "frames_per_second", b->args->frames / r->batch);
        tool_json_count(&j, "peak_memory", (long long)r->peak_memory);
        for (int s = 0; s < STAGES; s++) {
            char name[32];
            snprintf(name, sizeof(name), "%s_share", stage_names[s]);
            tool_json_number(&j, name, r->stage[s]);
        }
        tool_json_close(&j);
    }
    tool_json_end(&j);
}

// Rows are printed as soon as they are measured, so there is no table at the end.
static void no_table(FILE *out, const void *what)
{
    (void)out;
    (void)what;
}

static void clean(const struct bench *b)
{
    struct tool_error ignored;
    struct bench quiet = *b;
    const char *const words[] = {"rm", "-rf", b->dir, NULL};
    quiet.error = &ignored;
    run(&quiet, words);
}

int bench_batch(struct bench_args *args, struct tool_error *error)
{
    struct bench b = {.args = args, .error = error};
    int status = 0;
    const char *tmp = getenv("TMPDIR");
    args->frames = args->frames ? args->frames : 16;
    const long online = sysconf(_SC_NPROCESSORS_ONLN);
    snprintf(b.threads, sizeof(b.threads), "%d", args->threads ? args->threads : (int)online);
    snprintf(b.frames, sizeof(b.frames), "1-%d", args->frames);
    snprintf(b.size, sizeof(b.size), "%dx%d", args->width, args->height);
    snprintf(b.dir, sizeof(b.dir), "%.2000s/hyperfocal-bench-XXXXXX", tmp ? tmp : "/tmp");
    find_program(&b);
    if (!mkdtemp(b.dir))
        return tool_fail(error, -1, "%s cannot be made: %s", b.dir, strerror(errno));
    const int table = !args->json || strcmp(args->json, "-");
    if (table)
        printf("%d frames of %s, half RGBA and Z, %s threads; frames/s, then where the threads' time goes\n"
               "             batch      copy  oiiotool    /oiiot     read   decode  defocus   encode    write"
               "     wait  peak MiB\n",
               args->frames, b.size, b.threads);
    fflush(stdout);
    for (int i = 0; i < COMPRESSIONS && !status; i++) {
        if (args->compression && strcmp(args->compression, compressions[i]))
            continue;
        status = measure(&b, compressions[i], &b.rows[b.count]);
        if (!status && table)
            print_row(&b, &b.rows[b.count]);
        b.count += !status;
    }
    clean(&b);
    if (!status && args->json)
        status = bench_write_report(args, no_table, json, &b, error);
    return status;
}
