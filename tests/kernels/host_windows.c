// SPDX-License-Identifier: BSD-3-Clause
// An instruction that the CPU does not have, or an access outside the buffers, ends the program, which names the test.
#include <stdio.h>
#include <stdlib.h>

#include "harness.h"

// It defines near and far.
#include <windows.h>

const char *volatile crash_step = "before the first test";

static LONG WINAPI on_exception(EXCEPTION_POINTERS *e)
{
    const DWORD code = e->ExceptionRecord->ExceptionCode;
    if (code != EXCEPTION_ACCESS_VIOLATION && code != EXCEPTION_ILLEGAL_INSTRUCTION &&
        code != EXCEPTION_STACK_OVERFLOW && code != EXCEPTION_INT_DIVIDE_BY_ZERO)
        return EXCEPTION_CONTINUE_SEARCH;
    printf("FAILED %s: exception %08lx at %p\n0 passed, 1 failed\n", crash_step, code,
           e->ExceptionRecord->ExceptionAddress);
    fflush(stdout);
    _exit(1);
}

void crash_handlers(void)
{
    AddVectoredExceptionHandler(1, on_exception);
}

int guarded(void (*call)(struct world *, const struct kernels *, enum arena, int), struct world *w,
            const struct kernels *k, enum arena a, int index)
{
    call(w, k, a, index);
    return 0;
}

const char *crash_name(int number)
{
    (void)number;
    return "";
}

void *memory_reserve(size_t bytes)
{
    void *p = VirtualAlloc(NULL, bytes, MEM_RESERVE, PAGE_NOACCESS);
    if (!p) {
        fprintf(stderr, "VirtualAlloc: error %lu\n", GetLastError());
        exit(1);
    }
    return p;
}

void memory_allow(void *p, size_t bytes)
{
    if (!VirtualAlloc(p, bytes, MEM_COMMIT, PAGE_READWRITE)) {
        fprintf(stderr, "VirtualAlloc: error %lu\n", GetLastError());
        exit(1);
    }
}
