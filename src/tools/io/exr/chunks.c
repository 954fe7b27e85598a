// SPDX-License-Identifier: BSD-3-Clause
// Finds the chunks of a part, without reading their contents.
#include <stdlib.h>
#include <string.h>

#include "tools/io/exr/chunks.h"

static uint32_t get32(const uint8_t *p)
{
    uint32_t v;
    memcpy(&v, p, sizeof(v));
    return v;
}

static uint64_t get64(const uint8_t *p)
{
    uint64_t v;
    memcpy(&v, p, sizeof(v));
    return v;
}

static int by_offset(const void *a, const void *b)
{
    const struct hf_exr_slot *x = a, *y = b;
    if (x->offset != y->offset)
        return x->offset < y->offset ? -1 : 1;
    return x->index < y->index ? -1 : x->index > y->index;
}

uint64_t *hf_exr_table(const struct hf_exr *e, int p, struct hf_io_error *err)
{
    const size_t n = (size_t)e->parts[p].chunk_count;
    uint64_t *table = malloc(n * sizeof(*table));  // the table is known to fit the file
    if (table && !hf_exr_read_at(e, table, n * sizeof(*table), e->parts[p].table))
        return table;
    hf_io_fail(err, table ? "%s: truncated or corrupt: cannot read the chunk table of part %d" : "%s: out of memory",
               e->path, p);
    free(table);
    return NULL;
}

struct hf_exr_slot *hf_exr_file_order(const struct hf_exr *e, int p, struct hf_io_error *err)
{
    const size_t n = (size_t)e->parts[p].chunk_count;
    uint64_t *table = hf_exr_table(e, p, err);
    struct hf_exr_slot *slots = table ? calloc(n, sizeof(*slots)) : NULL;
    if (table && !slots)
        hf_io_fail(err, "%s: out of memory", e->path);
    for (size_t i = 0; i < n && slots; i++)
        slots[i] = (struct hf_exr_slot){table[i], (int)i};
    if (slots)
        qsort(slots, n, sizeof(*slots), by_offset);
    free(table);
    return slots;
}

int hf_exr_read_leader(const struct hf_exr *e, int p, uint64_t offset, struct hf_exr_leader *l)
{
    const exr_storage_t s = e->parts[p].storage;
    const bool tiled = s == EXR_STORAGE_TILED || s == EXR_STORAGE_DEEP_TILED, deep = hf_exr_is_deep(&e->parts[p]);
    const size_t place = tiled ? 16 : 4, number = e->multipart ? 4 : 0;
    uint8_t bytes[sizeof(l->place) + 32];
    l->size = number + place + (deep ? 24 : 4);
    if (offset < e->header_size || offset > e->size || l->size > e->size - offset ||
        hf_exr_read_at(e, bytes, l->size, offset) || (number && get32(bytes) != (uint32_t)p))
        return -1;
    memcpy(l->place, bytes + number, place);
    l->data_size = get32(bytes + number + place);
    if (deep) {
        const uint64_t counts = get64(bytes + number + place), data = get64(bytes + number + place + 8);
        if (counts > e->size || data > e->size)
            return -1;
        l->data_size = counts + data;
    }
    l->data = offset + l->size;
    return l->data_size <= e->size - l->data ? 0 : -1;
}

// Does a chunk say of itself that it belongs where the table has it? Of mipmapped parts only the table knows.
static bool is_in_place(const struct hf_exr_part *part, int index, const struct hf_exr_leader *l)
{
    if (hf_exr_is_deep(part) || !part->one_level || !part->window_ok)
        return true;
    if (part->storage == EXR_STORAGE_SCANLINE)
        return l->place[0] == part->window.min.y + index * part->chunk_lines;
    const int across = (part->width - 1) / part->tile_width + 1;
    return l->place[0] == index % across && l->place[1] == index / across && !l->place[2] && !l->place[3];
}

int hf_exr_check_chunks(const struct hf_exr *e, int p, struct hf_io_error *err)
{
    struct hf_exr_slot *slots = hf_exr_file_order(e, p, err);
    struct hf_exr_leader l;
    uint64_t end = e->header_size;
    int status = slots ? 0 : -1;
    for (int i = 0; i < e->parts[p].chunk_count && !status; i++) {
        if (slots[i].offset < end || hf_exr_read_leader(e, p, slots[i].offset, &l) ||
            !is_in_place(&e->parts[p], slots[i].index, &l))
            status = hf_io_fail(err, "%s: truncated or corrupt: chunk %d of part %d is not whole, or another's",
                                e->path, slots[i].index, p);
        end = status ? end : l.data + l.data_size;
    }
    free(slots);
    return status;
}
