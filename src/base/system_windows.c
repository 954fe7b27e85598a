// SPDX-License-Identifier: BSD-3-Clause
#include "base/system.h"

#include <malloc.h>
#include <stdlib.h>
#include <windows.h>

int64_t hf_now_ns(void)
{
    LARGE_INTEGER ticks, per_second;
    QueryPerformanceCounter(&ticks);
    QueryPerformanceFrequency(&per_second);
    // In two parts, because the product would overflow after some minutes.
    const int64_t second = INT64_C(1000000000), rate = per_second.QuadPart;
    return ticks.QuadPart / rate * second + ticks.QuadPart % rate * second / rate;
}

int hf_process(void)
{
    return (int)GetCurrentProcessId();
}

// Counts the processors of the process's own group, up to 64.
int hf_system_processors(void)
{
    DWORD_PTR ours, all;
    int n = 0;
    if (GetProcessAffinityMask(GetCurrentProcess(), &ours, &all))
        for (; ours; ours &= ours - 1)
            n++;
    return n < 1 ? 1 : n;
}

size_t hf_system_cache(void)
{
    DWORD bytes = 0;
    size_t largest = 0;
    GetLogicalProcessorInformation(NULL, &bytes);
    SYSTEM_LOGICAL_PROCESSOR_INFORMATION *list = malloc(bytes ? bytes : 1);
    if (list && GetLogicalProcessorInformation(list, &bytes))
        for (DWORD i = 0; i < bytes / sizeof *list; i++)
            if (list[i].Relationship == RelationCache && list[i].Cache.Level == 3 && list[i].Cache.Size > largest)
                largest = list[i].Cache.Size;
    free(list);
    return largest;
}

void *hf_system_alloc(size_t size, size_t align)
{
    return _aligned_malloc(size, align);
}

void hf_system_free(void *ptr)
{
    _aligned_free(ptr);
}
