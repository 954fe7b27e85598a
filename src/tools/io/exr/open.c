// SPDX-License-Identifier: BSD-3-Clause
// Opens an EXR file: Core parses the header, and header.c notes where in the file things are.
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
    if (hf_exr_read_at(e, data, size, offset))
        return -1;
    hf_exr_hide_misfits(e, data, size, offset);
    return (int64_t)size;
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
    if (hf_exr_survey(e, err))
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
    if (hf_exr_scan_header(e, err))
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
    free(e->misfits.list);
    free(e->parts);
    if (e->fd >= 0)
        close(e->fd);
    free(e);
}
