// SPDX-License-Identifier: BSD-3-Clause
// Reads the header beside Core, for what Core does not report: where things are, and what other readers refuse.
#include <stdlib.h>
#include <string.h>

#include "tools/io/exr/exr.h"

// A cursor over the header bytes, for what Core does not report: where things are.
struct cursor {
    const struct hf_exr *e;
    uint64_t at;     // next byte
    uint64_t begin;  // what buf holds
    size_t held;
    uint8_t buf[4096];
};

// The next byte, or -1 at the end of the file.
static int next_byte(struct cursor *c)
{
    if (c->at >= c->e->size)
        return -1;
    if (c->at < c->begin || c->at >= c->begin + c->held) {
        const uint64_t left = c->e->size - c->at;
        c->begin = c->at;
        c->held = left < sizeof(c->buf) ? (size_t)left : sizeof(c->buf);
        if (hf_exr_read_at(c->e, c->buf, c->held, c->begin))
            return -1;
    }
    return c->buf[c->at++ - c->begin];
}

// A zero-terminated name of up to 255 bytes. Its length, or -1.
static int next_name(struct cursor *c, char name[256])
{
    for (int n = 0; n < 256; n++) {
        const int b = next_byte(c);
        if (b < 0)
            return -1;
        name[n] = (char)b;
        if (!b)
            return n;
    }
    return -1;
}

static int64_t next_int(struct cursor *c)
{
    uint32_t v = 0;
    for (int i = 0; i < 4; i++) {
        const int b = next_byte(c);
        if (b < 0)
            return -1;
        v |= (uint32_t)b << (8 * i);
    }
    return v;
}

// The attributes that every part needs, tiles apart. Core accepts any type and size for these, and accepts missing or
// repeated ones; other readers do not, and written files take them from here.
static const struct {
    const char *name, *type;
    int64_t size;  // -1: any
} needed[] = {
    {"channels", "chlist", -1},       {"compression", "compression", 1}, {"dataWindow", "box2i", 16},
    {"displayWindow", "box2i", 16},   {"lineOrder", "lineOrder", 1},     {"pixelAspectRatio", "float", 4},
    {"screenWindowCenter", "v2f", 8}, {"screenWindowWidth", "float", 4}, {"tiles", "tiledesc", 9},
};
enum { NEEDED = sizeof(needed) / sizeof(needed[0]), NEEDED_BITS = (1 << (NEEDED - 1)) - 1 };

static bool is_needed(const char *name)
{
    for (int i = 0; i < NEEDED; i++)
        if (!strcmp(name, needed[i].name))
            return true;
    return false;
}

// Note which of these an attribute is. False if its type or size is wrong.
static bool right_type(const char *name, const char *type, int64_t size, unsigned *seen)
{
    for (int i = 0; i < NEEDED; i++) {
        if (strcmp(name, needed[i].name))
            continue;
        if (strcmp(type, needed[i].type) || (needed[i].size >= 0 && size != needed[i].size) || (*seen & 1u << i))
            return false;
        *seen |= 1u << i;
    }
    return true;
}

// Count the channels that a list names, up to its end or to where it breaks off.
static int count_channels(struct cursor *c, uint64_t end)
{
    char name[256];
    int n = 0;
    for (; c->at < end && next_name(c, name) > 0; n++)
        c->at += 16;
    return n;
}

// Scan one part's attributes, including the zero byte behind them.
static int scan_part(struct cursor *c, struct hf_exr_part *part)
{
    unsigned seen = 0;
    for (;;) {
        char name[256], type[256];
        const int length = next_name(c, name);
        if (length <= 0)
            return length || (seen & NEEDED_BITS) != NEEDED_BITS ? -1 : 0;
        if (next_name(c, type) < 0)
            return -1;
        const int64_t size = next_int(c);
        if (size < 0 || (uint64_t)size > c->e->size - c->at || !right_type(name, type, size, &seen))
            return -1;
        const uint64_t at = c->at;
        const int last = part->storage == EXR_STORAGE_SCANLINE ? EXR_LINEORDER_DECREASING_Y : EXR_LINEORDER_RANDOM_Y;
        // Core reads the channel list up to its terminating zero, whatever size the attribute gives. Other readers
        // trust the size, so the two must agree.
        if (!strcmp(name, "channels") && (count_channels(c, at + (uint64_t)size) < 1 || c->at != at + (uint64_t)size))
            return -1;
        if (!strcmp(name, "compression"))
            part->compression_at = at;
        if (!strcmp(name, "dataWindow"))
            part->window_at = at;
        if (!strcmp(name, "lineOrder") && next_byte(c) > last)  // Core reads an invalid line order as increasing
            return -1;
        if (!strcmp(name, "chunkCount") && !strcmp(type, "int") && size == 4) {
            part->chunk_count_at = at;
            if (next_int(c) != part->chunk_count)
                return -1;
        }
        c->at = at + (uint64_t)size;
    }
}

// Find the end of the header and each part's chunk table.
int hf_exr_scan_header(struct hf_exr *e, struct hf_io_error *err)
{
    struct cursor c = {.e = e, .at = 4};
    const int64_t version = next_int(&c);
    bool ok = version >= 0;
    e->multipart = ok && (version & 0x1000);
    for (int p = 0; p < e->part_count && ok; p++)
        ok = scan_part(&c, &e->parts[p]) == 0 && e->parts[p].compression_at;
    if (ok && e->multipart)
        ok = next_byte(&c) == 0;
    if (!ok)
        return hf_io_fail(err, "%s: truncated or corrupt: the header does not end, or an attribute is missing or wrong",
                          e->path);
    e->header_size = c.at;
    uint64_t at = c.at;
    for (int p = 0; p < e->part_count; p++) {
        e->parts[p].table = at;
        at += 8 * (uint64_t)e->parts[p].chunk_count;
        if (at > e->size)
            return hf_io_fail(err, "%s: truncated or corrupt: %llu bytes long, its chunk tables alone need %llu",
                              e->path, (unsigned long long)e->size, (unsigned long long)at);
    }
    return 0;
}

// ---- attributes whose size is not that of their type

// Core and OpenEXR read as many bytes as the type has, or none, and take the next attribute's name from there.
static bool is_vector_of_texts(struct cursor *c, uint64_t end)
{
    while (c->at < end) {
        const int64_t length = end - c->at < 4 ? -1 : next_int(c);
        if (length < 0 || (uint64_t)length > end - c->at)
            return false;
        c->at += (uint64_t)length;
    }
    return true;
}

static bool is_preview(struct cursor *c, int64_t size)
{
    const int64_t width = size < 8 ? -1 : next_int(c), height = size < 8 ? -1 : next_int(c);
    return width >= 0 && height >= 0 && width <= INT32_MAX && height <= INT32_MAX &&
           (uint64_t)size - 8 == 4 * (uint64_t)width * (uint64_t)height;
}

// Whether size bytes from the cursor on, which it may leave anywhere, can be a value of that type. Unknown types have any size.
static bool fits_type(struct cursor *c, const char *type, int64_t size)
{
    static const struct {
        const char *type;
        int64_t size;
    } fixed[] = {{"box2f", 16},      {"box2i", 16},   {"chromaticities", 32},
                 {"compression", 1}, {"double", 8},   {"envmap", 1},
                 {"float", 4},       {"int", 4},      {"keycode", 28},
                 {"lineOrder", 1},   {"m33d", 72},    {"m33f", 36},
                 {"m44d", 128},      {"m44f", 64},    {"rational", 8},
                 {"tiledesc", 9},    {"timecode", 8}, {"v2d", 16},
                 {"v2f", 8},         {"v2i", 8},      {"v3d", 24},
                 {"v3f", 12},        {"v3i", 12},     {"deepImageState", 1}};
    const uint64_t end = c->at + (uint64_t)size;
    for (size_t i = 0; i < sizeof(fixed) / sizeof(fixed[0]); i++)
        if (!strcmp(type, fixed[i].type))
            return size == fixed[i].size;
    if (!strcmp(type, "floatvector"))
        return size % 4 == 0;
    if (!strcmp(type, "stringvector"))
        return is_vector_of_texts(c, end);
    if (!strcmp(type, "chlist"))
        return count_channels(c, end) > 0 && c->at == end;
    return strcmp(type, "preview") || is_preview(c, size);
}

static int add_misfit(struct hf_exr *e, struct hf_exr_misfit misfit, struct hf_io_error *err)
{
    struct hf_exr_misfits *m = &e->misfits;
    if (m->count == m->room) {
        const size_t room = 2 * m->room + 8;
        struct hf_exr_misfit *list = realloc(m->list, room * sizeof(*list));
        if (!list)
            return hf_io_fail(err, "%s: out of memory", e->path);
        m->list = list;
        m->room = room;
    }
    m->list[m->count++] = misfit;
    return 0;
}

// The first misfit that ends behind an offset.
static size_t misfit_behind(const struct hf_exr_misfits *m, uint64_t offset)
{
    size_t low = 0, high = m->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (m->list[middle].to > offset)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

void hf_exr_hide_misfits(const struct hf_exr *e, uint8_t *data, size_t size, uint64_t offset)
{
    const struct hf_exr_misfits *m = &e->misfits;
    for (size_t i = misfit_behind(m, offset); i < m->count && m->list[i].from < offset + size; i++)
        if (m->list[i].type_at >= offset && m->list[i].type_at < offset + size)
            data[m->list[i].type_at - offset] = '-';  // begins no type that Core knows
}

size_t hf_exr_drop_misfits(const struct hf_exr *e, uint8_t *header, size_t size)
{
    const struct hf_exr_misfits *m = &e->misfits;
    size_t to = m->count ? (size_t)m->list[0].from : size;
    for (size_t i = 0; i < m->count; i++) {
        const size_t from = (size_t)m->list[i].to, next = i + 1 < m->count ? (size_t)m->list[i + 1].from : size;
        memmove(header + to, header + from, next - from);
        to += next - from;
    }
    return to;
}

// ---- before Core

int hf_exr_survey(struct hf_exr *e, struct hf_io_error *err)
{
    struct cursor c = {.e = e, .at = 4};
    const int64_t version = next_int(&c);
    int count = 0, ends = 0;
    while (version >= 0) {
        char name[256], type[256];
        struct hf_exr_misfit misfit = {.from = c.at};
        const int length = next_name(&c, name);
        ends = length == 0 ? ends + 1 : 0;
        if (length < 0 || ends > 1 || (ends == 1 && !(version & 0x1000)))
            break;
        if (ends)
            continue;
        misfit.type_at = c.at;
        if (next_name(&c, type) < 0)
            break;
        const int64_t size = next_int(&c);
        if (size < 0 || (uint64_t)size > e->size - c.at)
            break;
        const uint64_t at = c.at;
        misfit.to = at + (uint64_t)size;
        count += strcmp(name, "channels") ? 0 : count_channels(&c, misfit.to);
        if (count > HF_EXR_MOST_CHANNELS)
            return hf_io_fail(err, "%s: has %d channels, more than the %d that can be read", e->path, count,
                              HF_EXR_MOST_CHANNELS);
        c.at = at;
        if (!is_needed(name) && !fits_type(&c, type, size) && add_misfit(e, misfit, err))
            return -1;
        c.at = misfit.to;
    }
    return 0;
}
