// SPDX-License-Identifier: BSD-3-Clause
// Loaded before a program: requests of HF_NO_MEMORY bytes exactly find no memory.
#include <dlfcn.h>
#include <errno.h>
#include <stddef.h>
#include <stdlib.h>

void *malloc(size_t size);

void *malloc(size_t size)
{
    static void *(*next)(size_t);
    static size_t refused;
    if (!next) {
        *(void **)&next = dlsym(RTLD_NEXT, "malloc");
        const char *text = getenv("HF_NO_MEMORY");
        refused = text ? strtoul(text, NULL, 10) : 0;
    }
    if (size == refused && size) {
        errno = ENOMEM;
        return NULL;
    }
    return next(size);
}
