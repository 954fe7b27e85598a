// SPDX-License-Identifier: BSD-3-Clause
// Temporary files of dead processes are removed, those of living ones never, whatever their machines' names are. Also
// counts the writes that a file takes.
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tools/io/out.h"
#include "tools/io/temp.h"
#include "io/tests.h"

static const char *strays;  // the folder of this test

// Begin a file, report it through the pipe, then wait to be killed or to be told to finish.
static void write_file(int say, int told, const char *name)
{
    struct hf_out out;
    struct hf_io_error err;
    char byte = 0;
    if (hf_out_open(&out, name, &err) || hf_out_write(&out, "whole", 5, &err) || write(say, &byte, 1) != 1)
        _exit(1);
    out.unsynced = true;
    if (read(told, &byte, 1) != 1 || hf_out_commit(&out, &err))
        _exit(2);
    _exit(0);
}

// Two machines with one long name, as a container is, where we may make one.
static bool enter_container(void)
{
    char host[65];
    memset(host, 'h', 64);
    return !unshare(CLONE_NEWUTS | CLONE_NEWPID) && !sethostname(host, 64);
}

struct writer {
    pid_t pid;
    int say[2], tell[2];
};

// Start a process that holds the file (or its parent, which dies with it). False if that is impossible here.
static bool start_writer(struct writer *w, const char *name, bool contained)
{
    char byte;
    if (pipe(w->say) || pipe(w->tell))
        return false;
    w->pid = fork();
    if (w->pid == 0) {
        close(w->say[0]);
        close(w->tell[1]);
        if (!contained)
            write_file(w->say[1], w->tell[0], name);
        if (!enter_container())
            _exit(3);
        const pid_t first = fork();
        if (first == 0)
            write_file(w->say[1], w->tell[0], name);
        int status = 0;
        waitpid(first, &status, 0);
        _exit(WIFEXITED(status) ? WEXITSTATUS(status) : 4);
    }
    close(w->say[1]);
    close(w->tell[0]);
    return read(w->say[0], &byte, 1) == 1;
}

static int end_writer(struct writer *w, bool finish)
{
    int status = -1;
    if (finish && write(w->tell[1], "", 1) != 1)
        CHECK(!"the writer is gone");
    if (!finish)
        kill(w->pid, SIGKILL);
    close(w->tell[1]);
    close(w->say[0]);
    waitpid(w->pid, &status, 0);
    return status;
}

static void test_writers(void)
{
    for (int contained = 0; contained < 2; contained++) {
        struct writer w;
        char name[300];
        snprintf(name, sizeof(name), "%s/%d.exr", strays, contained);
        if (!start_writer(&w, name, contained)) {
            printf("skipped: no process of its own name space can be made\n");
            end_writer(&w, false);
            continue;
        }
        CHECK_INT(hf_temp_remove_strays(strays), 0);
        CHECK_INT(files_in(strays), 1);
        CHECK_INT(end_writer(&w, true), 0);
        CHECK_INT(access(name, F_OK), 0);
        CHECK_INT(hf_temp_remove_strays(strays), 0);
        unlink(name);
    }
    struct writer w;
    if (CHECK(start_writer(&w, in_folder("strays/killed.exr"), false)))
        end_writer(&w, false);
    CHECK_INT(files_in(strays), 1);
    CHECK_INT(hf_temp_remove_strays(strays), 1);
    CHECK_INT(files_in(strays), 0);
}

// Files with various names, ages and locks.
static void test_others(void)
{
    const struct {
        const char *name;
        bool old, locked, goes;
    } files[] = {
        {".hyperfocal-0123456789abcdef-1-0.exr", false, false, false},
        {".hyperfocal-0123456789abcdef-1-1.exr", true, false, true},
        {".hyperfocal-0123456789abcdef-1-2.exr", true, true, false},
        {".hyperfocal-render07.studio-1-3", true, false, true},  // as earlier versions called them
        {".hyperfocal-0123456789abcdef-1-", true, false, false},
        {".hyperfocal-0123456789abcdef-x-1.exr", true, false, false},
        {".hyperfocal", true, false, false},
        {"hyperfocal-0123456789abcdef-1-0.exr", true, false, false},
    };
    enum { COUNT = sizeof(files) / sizeof(files[0]) };
    const struct timespec then[2] = {{.tv_sec = 1000000000}, {.tv_sec = 1000000000}};
    int fds[COUNT], goes = 0;
    char paths[COUNT][300];
    for (int i = 0; i < COUNT; i++) {
        snprintf(paths[i], sizeof(paths[i]), "%s/%s", strays, files[i].name);
        fds[i] = open(paths[i], O_WRONLY | O_CREAT, 0666);
        CHECK(fds[i] >= 0 && (!files[i].locked || !flock(fds[i], LOCK_EX)));
        CHECK(!files[i].old || !futimens(fds[i], then));
        goes += files[i].goes;
    }
    CHECK_INT(hf_temp_remove_strays(strays), goes);
    for (int i = 0; i < COUNT; i++) {
        CHECK_MSG(!access(paths[i], F_OK) == !files[i].goes, "%s", files[i].name);
        close(fds[i]);
        unlink(paths[i]);
    }
}

enum { RACERS = 4, RACES = 500 };

// Writers and removers of strays at once, in one folder: no writer's file is lost.
static void race(void *arg, int i, int worker)
{
    char name[300];
    (void)arg;
    (void)worker;
    snprintf(name, sizeof(name), "%s/race.%d", strays, i);
    for (int n = 0; n < RACES; n++) {
        struct hf_out out;
        struct hf_io_error err;
        if (i % 2) {
            hf_temp_remove_strays(strays);
            continue;
        }
        int status = hf_out_open(&out, name, &err);
        out.unsynced = true;
        status = status || hf_out_write(&out, "whole", 5, &err) || hf_out_commit(&out, &err);
        CHECK_MSG(!status, "%s", err.message);
        hf_out_abort(&out);
    }
}

void test_strays(void)
{
    struct hf_io_run run;
    strays = in_folder("strays");
    mkdir(strays, 0777);
    test_writers();
    test_others();
    if (CHECK(!hf_io_threads_open(&run, RACERS)))
        hf_io_run(&run, RACERS, race, NULL);
    hf_io_threads_close(&run);
    CHECK_INT(files_in(strays), RACERS / 2);
}

// Calls of write() by this process so far; -1: not known.
static long long write_calls(void)
{
    char line[100];
    long long calls = -1;
    FILE *f = fopen("/proc/self/io", "r");
    while (f && fgets(line, sizeof(line), f))
        if (sscanf(line, "syscw: %lld", &calls) == 1)
            break;
    if (f)
        fclose(f);
    return calls;
}

void test_buffer(void)
{
    enum { PIECE = 7654, PIECES = 1442, LONG = 1 << 20 };
    static uint8_t bytes[LONG];
    const char *path = in_folder("buffer");
    struct hf_out out;
    struct hf_io_error err;
    size_t size, at = 0;
    for (int i = 0; i < LONG; i++)
        bytes[i] = (uint8_t)(i * 7 + i / 251);
    const long long before = write_calls();
    if (!CHECK(!hf_out_open(&out, path, &err)))
        return;
    for (int i = 0; i < PIECES; i++)
        CHECK(!hf_out_write(&out, bytes + i, PIECE, &err));
    CHECK(!hf_out_write(&out, bytes, LONG, &err));
    CHECK(!hf_out_patch(&out, PIECE - 2, "patch", 5, &err));
    CHECK(!hf_out_write(&out, "end", 3, &err));
    CHECK(!hf_out_commit(&out, &err));
    hf_out_abort(&out);
    // 11 MB in pieces of 256 KiB; the long piece, the patch, the end, and the flushes before them.
    const long long calls = write_calls() - before, most = (long long)PIECE * PIECES / (1 << 18) + 8;
    if (before >= 0)
        CHECK_MSG(calls <= most, "%lld writes, not %lld at most", calls, most);
    uint8_t *got = slurp(path, &size);
    CHECK_INT(size, (size_t)PIECE * PIECES + LONG + 3);
    int bad = memcmp(got + PIECE - 2, "patch", 5) != 0;
    for (int i = 0; i < PIECES; i++, at += PIECE)
        bad += memcmp(got + at + 3, bytes + i + 3, PIECE - 5) != 0;
    bad += memcmp(got + at, bytes, LONG) || memcmp(got + at + LONG, "end", 3);
    CHECK_INT(bad, 0);
    free(got);
}
