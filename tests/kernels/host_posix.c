// SPDX-License-Identifier: BSD-3-Clause
// An instruction that the CPU does not have, or an access outside the buffers, is a failed test with a name.
#include <setjmp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "harness.h"

const char *volatile crash_step = "before the first test";
static sigjmp_buf crash;
static volatile sig_atomic_t calling;

static void on_signal(int number)
{
    if (calling)
        siglongjmp(crash, number);
    char line[160];
    const int n = snprintf(line, sizeof line, "FAILED %s: %s\n0 passed, 1 failed\n", crash_step, strsignal(number));
    _exit(write(STDOUT_FILENO, line, (size_t)n) == n ? 1 : 2);
}

void crash_handlers(void)
{
    const struct sigaction action = {.sa_handler = on_signal};
    const int signals[] = {SIGILL, SIGSEGV, SIGBUS, SIGFPE};
    for (int i = 0; i < 4; i++)
        sigaction(signals[i], &action, NULL);
}

int guarded(void (*call)(struct world *, const struct kernels *, enum arena, int), struct world *w,
            const struct kernels *k, enum arena a, int index)
{
    const int number = sigsetjmp(crash, 1);
    if (!number) {
        calling = 1;
        call(w, k, a, index);
    }
    calling = 0;
    return number;
}

const char *crash_name(int number)
{
    return strsignal(number);
}

void *memory_reserve(size_t bytes)
{
    void *p = mmap(NULL, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (p == MAP_FAILED) {
        perror("mmap");
        exit(1);
    }
    return p;
}

void memory_allow(void *p, size_t bytes)
{
    if (mprotect(p, bytes, PROT_READ | PROT_WRITE)) {
        perror("mprotect");
        exit(1);
    }
}
