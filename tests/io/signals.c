// SPDX-License-Identifier: BSD-3-Clause
// A signal ends a process that writes files continuously: no incomplete file stays, and no other process's file is
// removed.
#include <dirent.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tools/io/out.h"
#include "io/tests.h"

enum { STRIKES = 60, WRITERS = 3 };

static const int numbers[] = {SIGTERM, SIGINT, SIGHUP};
static const char *struck;  // the folder written to

// Until the process ends.
static void write_on(void *arg, int i, int worker)
{
    (void)arg;
    (void)worker;
    char path[300];
    snprintf(path, sizeof(path), "%s/%d.exr", struck, i);
    for (;;) {
        struct hf_out out;
        struct hf_io_error err;
        int status = hf_out_open(&out, path, &err);
        out.unsynced = true;
        if (!status)
            status = hf_out_write(&out, "whole", 5, &err);
        if (!status)
            hf_out_commit(&out, &err);
        hf_out_abort(&out);
    }
}

static void write_until_struck(void)
{
    struct hf_io_run run;
    hf_io_catch_signals();
    if (!hf_io_threads_open(&run, WRITERS))
        hf_io_run(&run, WRITERS, write_on, NULL);
    _exit(1);
}

// Count the files with temporary names, and those that are incomplete.
static int left_over(void)
{
    int n = 0;
    DIR *d = opendir(struck);
    for (const struct dirent *e; d && (e = readdir(d));) {
        char path[600];
        struct stat st;
        snprintf(path, sizeof(path), "%s/%s", struck, e->d_name);
        n += e->d_name[0] != '.' ? stat(path, &st) || st.st_size != 5 : strlen(e->d_name) > 2;
    }
    if (d)
        closedir(d);
    return n;
}

void test_signals(void)
{
    struck = in_folder("struck");
    mkdir(struck, 0777);
    // The test's caller may ignore a signal (nohup), and the program must leave it ignored. Reset before the fork, as a
    // signal that a child still ignores is lost.
    void (*before[3])(int);
    for (int i = 0; i < 3; i++)
        before[i] = signal(numbers[i], SIG_DFL);
    for (int i = 0; i < STRIKES; i++) {
        const int number = numbers[i % 3];
        const struct timespec pause = {.tv_nsec = 2000000 + (long)(rnd() % 6000000)};
        const pid_t pid = fork();
        if (pid == 0)
            write_until_struck();
        nanosleep(&pause, NULL);
        kill(pid, number);
        int status = 0;
        CHECK(waitpid(pid, &status, 0) == pid && WIFSIGNALED(status) && WTERMSIG(status) == number);
        CHECK_INT(left_over(), 0);
    }
    for (int i = 0; i < 3; i++)
        signal(numbers[i], before[i]);
}
