// SPDX-License-Identifier: BSD-3-Clause
// Copying chunks without looking inside, from one file's part to another's.
#include <stdlib.h>
#include <string.h>

#include "io/exr/chunks.h"

enum { PIECE = 1 << 18 };

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

struct hf_exr_slot *hf_exr_file_order(const struct hf_exr *e, int p, struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[p];
    const size_t n = (size_t)part->chunk_count;
    uint64_t *table = malloc(n * sizeof(*table));  // the table is known to fit the file
    struct hf_exr_slot *slots = calloc(n, sizeof(*slots));
    if (!table || !slots) {
        hf_io_fail(err, "%s: out of memory", e->path);
        goto error;
    }
    if (hf_exr_read_at(e, table, n * sizeof(*table), part->table)) {
        hf_io_fail(err, "%s: truncated or corrupt: cannot read the chunk table of part %d", e->path, p);
        goto error;
    }
    for (size_t i = 0; i < n; i++)
        slots[i] = (struct hf_exr_slot){table[i], (int)i};
    free(table);
    qsort(slots, n, sizeof(*slots), by_offset);
    return slots;
error:
    free(table);
    free(slots);
    return NULL;
}

struct leader {
    uint8_t bytes[40];  // without the part number
    size_t size;
    uint64_t data_size;
};

// What stands before a chunk's data: the part number in multi-part files, where in the picture it belongs, sizes.
static int read_leader(const struct hf_exr *e, int p, uint64_t offset, struct leader *l)
{
    const exr_storage_t s = e->parts[p].storage;
    const bool tiled = s == EXR_STORAGE_TILED || s == EXR_STORAGE_DEEP_TILED, deep = hf_exr_is_deep(&e->parts[p]);
    const size_t place = tiled ? 16 : 4;
    uint8_t number[4];
    if (e->multipart) {
        if (hf_exr_read_at(e, number, sizeof(number), offset) || get32(number) != (uint32_t)p)
            return -1;
        offset += sizeof(number);
    }
    l->size = place + (deep ? 24 : 4);
    if (hf_exr_read_at(e, l->bytes, l->size, offset))
        return -1;
    if (!deep) {
        l->data_size = get32(l->bytes + place);
        return 0;
    }
    const uint64_t counts = get64(l->bytes + place), data = get64(l->bytes + place + 8);
    if (counts > e->size || data > e->size)
        return -1;
    l->data_size = counts + data;
    return 0;
}

int hf_exr_check_chunks(const struct hf_exr *e, int p, struct hf_io_error *err)
{
    struct hf_exr_slot *slots = hf_exr_file_order(e, p, err);
    struct leader l;
    int status = slots ? 0 : -1;
    for (int i = 0; i < e->parts[p].chunk_count && !status; i++) {
        const uint64_t at = slots[i].offset, head = e->multipart ? 4 : 0;
        if (at < e->header_size || at > e->size || read_leader(e, p, at, &l) || l.size + head > e->size - at ||
            l.data_size > e->size - at - l.size - head)
            status = hf_io_fail(err, "%s: truncated or corrupt: chunk %d of part %d is not whole", e->path,
                                slots[i].index, p);
    }
    free(slots);
    return status;
}

static int copy_bytes(const struct hf_exr *e, uint64_t from, uint64_t size, struct hf_out *out, uint8_t *buf,
                      struct hf_io_error *err)
{
    while (size) {
        const size_t n = size < PIECE ? (size_t)size : PIECE;
        if (hf_exr_read_at(e, buf, n, from))
            return hf_io_fail(err, "%s: truncated or corrupt: cannot read at byte %llu", e->path,
                              (unsigned long long)from);
        if (hf_out_write(out, buf, n, err))
            return -1;
        from += n;
        size -= n;
    }
    return 0;
}

int hf_exr_put_leader(struct hf_exr_target *t, const void *leader, size_t size, struct hf_io_error *err)
{
    const int32_t number = t->part;
    if (t->multipart && hf_out_write(t->out, &number, sizeof(number), err))
        return -1;
    t->at += (t->multipart ? sizeof(number) : 0) + size;
    return hf_out_write(t->out, leader, size, err);
}

int hf_exr_copy_chunks(const struct hf_exr *e, int p, struct hf_exr_target *t, struct hf_io_error *err)
{
    const struct hf_exr_part *last = &e->parts[e->part_count - 1];
    uint64_t end = last->table + 8 * (uint64_t)last->chunk_count;
    struct hf_exr_slot *slots = hf_exr_file_order(e, p, err);
    uint8_t *buf = malloc(PIECE);
    int status = slots ? 0 : -1;
    if (!buf)
        status = hf_io_fail(err, "%s: out of memory", e->path);
    for (int i = 0; i < e->parts[p].chunk_count && !status; i++) {
        const uint64_t offset = slots[i].offset;
        struct leader l;
        // Chunks do not overlap: else a short file could make a long one.
        if (offset < end || offset >= e->size || read_leader(e, p, offset, &l) ||
            offset + l.size + (e->multipart ? 4 : 0) > e->size ||
            l.data_size > e->size - offset - l.size - (e->multipart ? 4 : 0)) {
            status = hf_io_fail(err, "%s: truncated or corrupt: chunk %d of part %d is not where its table says",
                                e->path, slots[i].index, p);
            break;
        }
        t->table[slots[i].index] = t->at;
        status = hf_exr_put_leader(t, l.bytes, l.size, err);
        const uint64_t data = offset + l.size + (e->multipart ? 4 : 0);
        if (!status)
            status = copy_bytes(e, data, l.data_size, t->out, buf, err);
        t->at += l.data_size;
        end = data + l.data_size;
    }
    free(buf);
    free(slots);
    return status;
}
