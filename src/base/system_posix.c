// SPDX-License-Identifier: BSD-3-Clause
#include "base/system.h"

#include <stdlib.h>
#include <time.h>
#include <unistd.h>
#ifdef __linux__
#include <sched.h>
#include <sys/mman.h>
#endif
#ifdef __APPLE__
#include <sys/sysctl.h>
#endif

// The size of Linux's huge pages. Memory in them takes one page fault instead of 512, and fewer misses of the page
// table's cache where a loop reads many rows at once.
enum { LARGE_PAGE = 1 << 21 };

int64_t hf_now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * INT64_C(1000000000) + t.tv_nsec;
}

int hf_process(void)
{
    return (int)getpid();
}

int hf_system_processors(void)
{
#ifdef __linux__
    cpu_set_t set;
    const long n = sched_getaffinity(0, sizeof set, &set) ? 1 : CPU_COUNT(&set);
#else
    const long n = sysconf(_SC_NPROCESSORS_ONLN);
#endif
    return n < 1 ? 1 : (int)n;
}

size_t hf_system_cache(void)
{
#if defined(__APPLE__)
    uint64_t told = 0;
    size_t size = sizeof told;
    return sysctlbyname("hw.l3cachesize", &told, &size, NULL, 0) ? 0 : (size_t)told;
#elif defined(_SC_LEVEL3_CACHE_SIZE)
    const long told = sysconf(_SC_LEVEL3_CACHE_SIZE);  // slow: asks the processor, which a virtual machine intercepts
    return told > 0 ? (size_t)told : 0;
#else
    return 0;
#endif
}

void *hf_system_alloc(size_t size, size_t align)
{
    void *ptr = NULL;
#ifdef MADV_HUGEPAGE
    const int large = size >= 2 * (size_t)LARGE_PAGE;
    if (posix_memalign(&ptr, large ? LARGE_PAGE : align, size))
        return NULL;
    if (large)
        madvise(ptr, size / LARGE_PAGE * LARGE_PAGE, MADV_HUGEPAGE);  // a hint
    return ptr;
#else
    return posix_memalign(&ptr, align, size) ? NULL : ptr;
#endif
}

void hf_system_free(void *ptr)
{
    free(ptr);
}
