// SPDX-License-Identifier: BSD-3-Clause
// Reads the bytes of some parts into memory, so that decoding does not wait for a disk.
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tools/io/exr/chunks.h"

static int compare(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

static bool wants_part(const struct hf_exr_plane *planes, int count, int p)
{
    for (int i = 0; i < count; i++)
        if (planes[i].part == p)
            return true;
    return false;
}

// The starts of all chunks in the file, sorted, followed by the file's end. A chunk ends at the next start at the
// latest.
static uint64_t *all_starts(const struct hf_exr *e, size_t *count, struct hf_io_error *err)
{
    size_t n = 0;
    for (int p = 0; p < e->part_count; p++)
        n += (size_t)e->parts[p].chunk_count;
    uint64_t *starts = malloc((n + 1) * sizeof(*starts));
    n = 0;
    for (int p = 0; p < e->part_count && starts; p++) {
        const size_t own = (size_t)e->parts[p].chunk_count;
        if (hf_exr_read_at(e, starts + n, own * sizeof(*starts), e->parts[p].table)) {
            free(starts);
            hf_io_fail(err, "%s: truncated or corrupt: cannot read the chunk table of part %d", e->path, p);
            return NULL;
        }
        n += own;
    }
    if (!starts) {
        hf_io_fail(err, "%s: out of memory", e->path);
        return NULL;
    }
    qsort(starts, n, sizeof(*starts), compare);
    size_t kept = 0;
    for (size_t i = 0; i < n; i++)
        if (!kept || starts[i] != starts[kept - 1])
            starts[kept++] = starts[i];
    starts[kept] = e->size;
    *count = kept;
    return starts;
}

static int read_range(const struct hf_exr *e, uint8_t *bytes, uint64_t from, uint64_t to, struct hf_io_error *err)
{
    while (from < to) {
        const ssize_t n = pread(e->fd, bytes + from, to - from, (off_t)from);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return hf_io_fail(err, "%s: cannot read at byte %llu: %s", e->path, (unsigned long long)from,
                              n ? strerror(errno) : "the file became shorter");
        from += (uint64_t)n;
    }
    return 0;
}

// Read one part's chunks, as contiguous ranges where possible.
static int fetch_part(struct hf_exr *e, int p, const uint64_t *starts, size_t count, struct hf_io_error *err)
{
    struct hf_exr_fetched *f = &e->fetched;
    struct hf_exr_slot *slots = hf_exr_file_order(e, p, err);
    const struct hf_exr_part *last = &e->parts[e->part_count - 1];
    const uint64_t first = last->table + 8 * (uint64_t)last->chunk_count;
    int status = slots ? 0 : -1;
    for (int i = 0; i < e->parts[p].chunk_count && !status; i++) {
        const uint64_t from = slots[i].offset;
        if (from < first || from >= e->size || (i && from == slots[i - 1].offset))
            continue;  // decoding will report it
        const uint64_t *own = bsearch(&from, starts, count, sizeof(*starts), compare);
        // A chunk that begins after the end does not exist: the file was cut, or is still being written.
        const uint64_t to = !own ? from : own[1] < e->size ? own[1] : e->size;
        if (f->count && f->range[f->count - 1].to == from) {
            f->range[f->count - 1].to = to;
        } else {
            struct hf_exr_range *range = realloc(f->range, (size_t)(f->count + 1) * sizeof(*range));
            if (!range) {
                status = hf_io_fail(err, "%s: out of memory", e->path);
                break;
            }
            f->range = range;
            f->range[f->count++] = (struct hf_exr_range){from, to};
        }
    }
    free(slots);
    return status;
}

int hf_exr_fetch(struct hf_exr *e, const struct hf_exr_plane *planes, int count, struct hf_io_error *err)
{
    struct hf_exr_fetched *f = &e->fetched;
    size_t n;
    if (f->bytes || e->memory)
        return 0;
    uint64_t *starts = all_starts(e, &n, err);
    f->bytes = starts ? malloc(e->size) : NULL;
    int status = starts ? 0 : -1;
    if (starts && !f->bytes)
        status = hf_io_fail(err, "%s: out of memory", e->path);
    const int held = f->count;
    for (int p = 0; p < e->part_count && !status; p++)
        if (wants_part(planes, count, p) && !e->parts[p].samples && !hf_exr_is_dwa(e->parts[p].compression))
            status = fetch_part(e, p, starts, n, err);
    for (int i = held; i < f->count && !status; i++)
        status = read_range(e, f->bytes, f->range[i].from, f->range[i].to, err);
    free(starts);
    if (status) {
        free(f->bytes);
        free(f->range);
        *f = (struct hf_exr_fetched){0};
    }
    return status;
}
