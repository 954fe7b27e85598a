// SPDX-License-Identifier: BSD-3-Clause
// Opens an EXR file: Core parses the header, and this file notes where in the file things are.
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tools/io/exr/exr.h"

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "sample rows are used as they are stored, which is little endian"
#endif

const uint8_t *hf_exr_bytes(const struct hf_exr *e, size_t size, uint64_t offset)
{
    if (e->memory)
        return offset <= e->size && size <= e->size - offset ? e->memory + offset : NULL;
    for (int i = 0; i < e->fetched.count; i++) {
        const struct hf_exr_range *r = &e->fetched.range[i];
        if (offset >= r->from && offset <= r->to && size <= r->to - offset)
            return e->fetched.bytes + offset;
    }
    return NULL;
}

int hf_exr_read_at(const struct hf_exr *e, void *data, size_t size, uint64_t offset)
{
    char *to = data;
    const uint8_t *bytes = hf_exr_bytes(e, size, offset);
    if (bytes || e->memory) {
        if (bytes)
            memcpy(data, bytes, size);
        return bytes ? 0 : -1;
    }
    while (size) {
        const ssize_t n = pread(e->fd, to, size, (off_t)offset);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return -1;
        to += n;
        offset += (uint64_t)n;
        size -= (size_t)n;
    }
    return 0;
}

static int64_t core_read(exr_const_context_t core, void *user, void *data, uint64_t size, uint64_t offset,
                         exr_stream_error_func_ptr_t error)
{
    const struct hf_exr *e = user;
    (void)core;
    (void)error;
    if (offset >= e->size)
        return 0;
    if (size > e->size - offset)
        size = e->size - offset;
    return hf_exr_read_at(e, data, size, offset) ? -1 : (int64_t)size;
}

static int64_t core_size(exr_const_context_t core, void *user)
{
    (void)core;
    return (int64_t)((const struct hf_exr *)user)->size;
}

// Core reports some corrupt chunks (B44) as a lack of memory.
static _Thread_local bool core_ran_out;

// Zeroed, with spare bytes behind: Core 3.1 reads a few bytes past the end of some corrupt chunks. No valid header or
// chunk needs as much as the limit.
static void *core_alloc(size_t size)
{
    void *p = size > (size_t)4 << 30 ? NULL : calloc(1, size + 64);
    core_ran_out |= !p;
    return p;
}

static void core_free(void *p)
{
    free(p);
}

// Core first reports the cause, then its consequences, all on the thread that called it.
static _Thread_local char core_message[256];

static void core_error(exr_const_context_t core, exr_result_t code, const char *message)
{
    (void)core, (void)code;
    if (!core_message[0] && message)
        snprintf(core_message, sizeof(core_message), "%s", message);
}

void hf_exr_context_init(void *user_data, exr_context_initializer_t *init)
{
    *init = (exr_context_initializer_t)EXR_DEFAULT_CONTEXT_INITIALIZER;
    init->error_handler_fn = core_error;
    init->alloc_fn = core_alloc;
    init->free_fn = core_free;
    init->user_data = user_data;
}

void hf_exr_quiet(void)
{
    core_message[0] = 0;
    core_ran_out = false;
}

const char *hf_exr_said(exr_result_t code)
{
    return core_message[0] ? core_message : exr_get_default_error_message(code);
}

int hf_exr_fail(const struct hf_exr *e, exr_result_t code, struct hf_io_error *err)
{
    if (code == EXR_ERR_OUT_OF_MEMORY && core_ran_out)
        return hf_io_fail(err, "%s: out of memory", e->path);
    if (code == EXR_ERR_OUT_OF_MEMORY)
        code = EXR_ERR_CORRUPT_CHUNK;
    return hf_io_fail(err, "%s: truncated or corrupt: %s", e->path, hf_exr_said(code));
}

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
static int scan_header(struct hf_exr *e, struct hf_io_error *err)
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

// Sorting channels and looking for layers compares each channel with all others, in Core too. So a file with too many
// is refused before Core sees them. Any other fault is left to Core.
static int limit_channels(const struct hf_exr *e, struct hf_io_error *err)
{
    struct cursor c = {.e = e, .at = 4};
    const int64_t version = next_int(&c);
    int count = 0, ends = 0;
    while (version >= 0) {
        char name[256], type[256];
        const int length = next_name(&c, name);
        ends = length == 0 ? ends + 1 : 0;
        if (length < 0 || ends > 1 || (ends == 1 && !(version & 0x1000)))
            break;
        if (ends)
            continue;
        if (next_name(&c, type) < 0)
            break;
        const int64_t size = next_int(&c);
        if (size < 0 || (uint64_t)size > e->size - c.at)
            break;
        const uint64_t end = c.at + (uint64_t)size;
        count += strcmp(name, "channels") ? 0 : count_channels(&c, end);
        if (count > HF_EXR_MOST_CHANNELS)
            return hf_io_fail(err, "%s: has %d channels, more than the %d that can be read", e->path, count,
                              HF_EXR_MOST_CHANNELS);
        c.at = end;
    }
    return 0;
}

static const char *string_attribute(const struct hf_exr *e, int part, const char *name)
{
    const char *s = NULL;
    int32_t length = 0;
    if (exr_attr_get_string(e->core, part, name, &length, &s) != EXR_ERR_SUCCESS || !s)
        return "";
    return s;
}

static int load_channels(struct hf_exr *e, int p, struct hf_io_error *err)
{
    struct hf_exr_part *part = &e->parts[p];
    if (exr_get_channels(e->core, p, &part->list) != EXR_ERR_SUCCESS || !part->list || part->list->num_channels < 1)
        return hf_io_fail(err, "%s: truncated or corrupt: part %d has no channels", e->path, p);
    part->channel_count = part->list->num_channels;
    part->channels = calloc((size_t)part->channel_count, sizeof(*part->channels));
    if (!part->channels)
        return hf_io_fail(err, "%s: out of memory", e->path);
    for (int c = 0; c < part->channel_count; c++) {
        const exr_attr_chlist_entry_t *from = &part->list->entries[c];
        struct hf_exr_channel *to = &part->channels[c];
        to->name = from->name.str;
        to->type = from->pixel_type;
        to->bytes = from->pixel_type == EXR_PIXEL_HALF ? 2 : 4;
        to->x_sampling = from->x_sampling;
        to->y_sampling = from->y_sampling;
        if (to->x_sampling < 1 || to->y_sampling < 1)
            return hf_io_fail(err, "%s: truncated or corrupt: channel %s has sampling %d %d", e->path, to->name,
                              to->x_sampling, to->y_sampling);
    }
    return 0;
}

static void load_window(struct hf_exr_part *part)
{
    const exr_attr_box2i_t *w = &part->window;
    const int64_t width = (int64_t)w->max.x - w->min.x + 1, height = (int64_t)w->max.y - w->min.y + 1;
    const int64_t far = HF_IO_MAX_COORDINATE;
    part->window_ok = width >= 1 && height >= 1 && width <= HF_IO_MAX_SIDE && height <= HF_IO_MAX_SIDE &&
                      w->min.x >= -far && w->min.y >= -far && w->max.x < far && w->max.y < far;
    if (part->window_ok) {
        part->width = (int)width;
        part->height = (int)height;
    }
}

static int load_part(struct hf_exr *e, int p, struct hf_io_error *err)
{
    struct hf_exr_part *part = &e->parts[p];
    exr_result_t rv = exr_get_storage(e->core, p, &part->storage);
    if (!rv)
        rv = exr_get_compression(e->core, p, &part->compression);
    if (!rv)
        rv = exr_get_lineorder(e->core, p, &part->line_order);
    if (!rv)
        rv = exr_get_data_window(e->core, p, &part->window);
    if (!rv)
        rv = exr_get_chunk_count(e->core, p, &part->chunk_count);
    if (!rv && part->chunk_count < 1)
        rv = EXR_ERR_FILE_BAD_HEADER;
    if (rv)
        return hf_exr_fail(e, rv, err);
    part->name = string_attribute(e, p, "name");
    part->view = string_attribute(e, p, "view");
    load_window(part);
    part->one_level = true;
    if (part->storage == EXR_STORAGE_TILED || part->storage == EXR_STORAGE_DEEP_TILED) {
        uint32_t tw = 0, th = 0;
        exr_tile_level_mode_t mode = EXR_TILE_ONE_LEVEL;
        exr_tile_round_mode_t round;
        rv = exr_get_tile_descriptor(e->core, p, &tw, &th, &mode, &round);
        if (rv || tw < 1 || th < 1 || tw > INT32_MAX || th > INT32_MAX)
            return hf_io_fail(err, "%s: truncated or corrupt: part %d has tiles of %u x %u pixels", e->path, p, tw, th);
        part->tile_width = (int)tw;
        part->tile_height = (int)th;
        part->one_level = mode == EXR_TILE_ONE_LEVEL;
    } else if (part->storage == EXR_STORAGE_SCANLINE || part->storage == EXR_STORAGE_DEEP_SCANLINE) {
        part->chunk_lines = hf_exr_compression_lines(part->compression);
    }
    return load_channels(e, p, err);
}

// e says what is to be read; it is closed after a failure.
static int open_core(struct hf_exr **out, struct hf_exr *e, struct hf_io_error *err)
{
    exr_context_initializer_t init;
    exr_result_t rv = EXR_ERR_SUCCESS;
    if (limit_channels(e, err))
        goto error;
    hf_exr_context_init(e, &init);
    init.read_fn = core_read;
    init.size_fn = core_size;
    init.flags =
        EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;  // half a picture is an error and must not be reconstructed
    hf_exr_quiet();
    rv = exr_start_read(&e->core, e->path, &init);
    if (!rv)
        rv = exr_get_count(e->core, &e->part_count);
    if (rv || e->part_count < 1) {
        hf_exr_fail(e, rv, err);
        goto error;
    }
    e->parts = calloc((size_t)e->part_count, sizeof(*e->parts));
    if (!e->parts) {
        hf_io_fail(err, "%s: out of memory", e->path);
        goto error;
    }
    for (int p = 0; p < e->part_count; p++)
        if (load_part(e, p, err))
            goto error;
    if (scan_header(e, err))
        goto error;
    *out = e;
    return 0;
error:
    hf_exr_close(e);
    return -1;
}

int hf_exr_open(struct hf_exr **out, const char *path, int fd, const struct hf_exr_codec *dwa, struct hf_io_error *err)
{
    struct hf_exr *e = calloc(1, sizeof(*e));
    *out = NULL;
    if (!e) {
        close(fd);
        return hf_io_fail(err, "%s: out of memory", path);
    }
    e->fd = fd;
    e->path = path;
    e->dwa = dwa;
    e->size = (uint64_t)lseek(fd, 0, SEEK_END);
    return open_core(out, e, err);
}

int hf_exr_open_memory(struct hf_exr **out, const char *path, const struct hf_io_bytes *bytes, struct hf_io_error *err)
{
    struct hf_exr *e = calloc(1, sizeof(*e));
    *out = NULL;
    if (!e)
        return hf_io_fail(err, "%s: out of memory", path);
    e->fd = -1;
    e->path = path;
    e->memory = bytes->data;
    e->size = bytes->size;
    return open_core(out, e, err);
}

void hf_exr_close(struct hf_exr *e)
{
    if (!e)
        return;
    if (e->core)
        exr_finish(&e->core);
    for (int p = 0; e->parts && p < e->part_count; p++) {
        hf_exr_free_layout(&e->parts[p]);
        free(e->parts[p].samples);
        free(e->parts[p].channels);
        for (int i = 0; i < e->parts[p].added_count; i++)
            free(e->parts[p].added[i]);
        free(e->parts[p].added);
    }
    free(e->fetched.bytes);
    free(e->fetched.range);
    free(e->parts);
    if (e->fd >= 0)
        close(e->fd);
    free(e);
}
