// SPDX-License-Identifier: BSD-3-Clause
#include "tools/io/picture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

#include "tools/common/nearest.h"

// The block is not aligned to such a page: the gaps between aligned blocks would add up over a shot.
void *hf_io_alloc(size_t size)
{
    void *ptr = malloc(size);
#ifdef MADV_HUGEPAGE
    const uintptr_t page = (uintptr_t)1 << 21, from = ((uintptr_t)ptr + page - 1) / page * page;
    const uintptr_t to = ((uintptr_t)ptr + size) / page * page;
    if (ptr && from < to)
        madvise((void *)from, to - from, MADV_HUGEPAGE);  // only a hint
#endif
    return ptr;
}

void hf_io_guessed_name(const struct hf_io_view *v, char name[256])
{
    const char *dot = strrchr(v->colour[0], '.');
    snprintf(name, 256, "%.*sguessed", dot ? (int)(dot + 1 - v->colour[0]) : 0, v->colour[0]);
}

const char *hf_io_extension(const char *path)
{
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    return dot && (!slash || dot > slash) ? dot + 1 : "";
}

bool hf_io_is_exr_name(const char *path)
{
    return !strcasecmp(hf_io_extension(path), "exr");
}

int hf_io_check_window(const char *path, const char *which, struct hf_io_box b, struct hf_io_error *err)
{
    const int far = HF_IO_MAX_COORDINATE;
    if (b.x1 > b.x0 && b.y1 > b.y0 && b.x0 >= -far && b.y0 >= -far && b.x1 <= far && b.y1 <= far &&
        b.x1 - b.x0 <= HF_IO_MAX_SIDE && b.y1 - b.y0 <= HF_IO_MAX_SIDE)
        return 0;
    return hf_io_fail(err, "%s: %s (%d %d) - (%lld %lld) is empty, too far out, or larger than %d a side", path, which,
                      b.x0, b.y0, (long long)b.x1 - 1, (long long)b.y1 - 1, HF_IO_MAX_SIDE);
}

void hf_io_list(char *buf, size_t size, const char *part, const char *name, const char *said)
{
    const size_t n = strlen(buf);
    if (n < size)
        snprintf(buf + n, size - n, "%s%s%s%s%s", n ? ", " : "", part ? part : "", part ? ":" : "", name, said);
}

struct hf_io_view *hf_io_add_view(struct hf_io_views *views)
{
    const size_t n = (size_t)views->count;
    struct hf_io_view *list = realloc(views->view, (n + 1) * sizeof(*list));
    if (!list)
        return NULL;
    views->view = list;
    views->count++;
    memset(&list[n], 0, sizeof(list[n]));
    return &list[n];
}

int hf_io_nearest(const char *list, const char *wanted, char nearest[256])
{
    struct tool_nearest best = {NULL, 0, 0};
    for (const char *at = list; *at;) {
        const char *comma = strstr(at, ", ");
        const int n = comma ? (int)(comma - at) : (int)strlen(at);
        struct tool_nearest found = {NULL, 0, 0};
        tool_nearest_try(&found, at, n, wanted);
        // Its pieces: Fg of Fg.Combined.
        for (int from = 0, to = 0; to <= n; to++)
            if (to == n || at[to] == '.') {
                tool_nearest_try(&found, at + from, to - from, wanted);
                from = to + 1;
            }
        if (found.word && (!best.word || found.distance < best.distance))
            best = (struct tool_nearest){at, n, found.distance};
        at += n + (comma ? 2 : 0);
    }
    if (best.word)
        snprintf(nearest, 256, "%.*s", best.length, best.word);
    return best.word != NULL;
}
