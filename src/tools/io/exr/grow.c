// SPDX-License-Identifier: BSD-3-Clause
// Enlarges a part's data window, or gives it a channel: its samples are laid out again, and new places are filled.
#include <stdlib.h>
#include <string.h>

#include "tools/io/exr/exr.h"
#include "tools/io/half.h"

// Copy samples of one channel in some pixels of a row between pieces of chunks and a plain row.
static void move_row(const struct hf_exr_part *part, int c, int y, int x0, int n, uint8_t *row, bool to_row)
{
    const size_t bytes = (size_t)part->channels[c].bytes;
    const bool tiled = part->storage == EXR_STORAGE_TILED;
    const int across = tiled ? (part->width - 1) / part->tile_width + 1 : 1;
    const int first = tiled ? y / part->tile_height * across : y;
    for (int i = first; i < first + across; i++) {
        const struct hf_exr_chunk k = hf_exr_chunk_at(part, 1, i);
        const int from = x0 > k.x0 ? x0 : k.x0, to = x0 + n < k.x0 + k.width ? x0 + n : k.x0 + k.width;
        if (from >= to)
            continue;
        uint8_t *sample = part->samples + k.at + hf_exr_row_at(part, &k, c, y) + (size_t)(from - k.x0) * bytes;
        uint8_t *pixel = row + (size_t)(from - x0) * bytes;
        memcpy(to_row ? pixel : sample, to_row ? sample : pixel, (size_t)(to - from) * bytes);
    }
}

// Fill a row with n samples of one value.
static void fill_row(uint8_t *row, exr_pixel_type_t type, float value, int n)
{
    uint64_t clamped = 0;
    const uint16_t half = hf_io_to_half(value, &clamped);
    for (int i = 0; i < n; i++) {
        if (type == EXR_PIXEL_FLOAT)
            memcpy(row + 4 * (size_t)i, &value, sizeof(value));
        else if (type == EXR_PIXEL_HALF)
            memcpy(row + 2 * (size_t)i, &half, sizeof(half));
    }
}

// The number that channel c had in the file; -1: it is added.
static int old_channel(const struct hf_exr_part *old, const struct hf_exr_part *part, int c)
{
    return old->channel_count == part->channel_count ? c : hf_exr_find_channel(old, part->channels[c].name);
}

static int move_all(const struct hf_exr_part *old, const struct hf_exr_part *part, const struct hf_exr_fill *fills,
                    int fill_count)
{
    const int dx = old->window.min.x - part->window.min.x, dy = old->window.min.y - part->window.min.y;
    uint8_t *row = malloc(4 * (size_t)part->width);
    for (int c = 0; row && c < part->channel_count; c++) {
        const int from = old_channel(old, part, c);
        float value = 0;
        for (int i = 0; i < fill_count; i++)
            value = fills[i].channel == c ? fills[i].value : value;
        for (int y = 0; y < part->height; y++) {
            memset(row, 0, 4 * (size_t)part->width);
            if (value != 0)
                fill_row(row, part->channels[c].type, value, part->width);
            if (from >= 0 && y >= dy && y < dy + old->height)
                move_row(old, from, y - dy, 0, old->width, row + (size_t)dx * (size_t)part->channels[c].bytes, true);
            move_row(part, c, y, 0, part->width, row, false);
        }
    }
    free(row);
    return row ? 0 : -1;
}

// Lay the samples of a part out as it is now; old: as it was, with its samples and layout.
static int lay_out_again(struct hf_exr *e, int p, struct hf_exr_part *old, const struct hf_exr_fill *fills,
                         int fill_count, struct hf_io_error *err)
{
    struct hf_exr_part *part = &e->parts[p];
    part->layout = (struct hf_exr_layout){0};
    part->samples = NULL;
    part->grown = true;
    int status = hf_exr_lay_out(e, p, err);
    if (!status)
        part->samples = malloc(part->layout.bytes + 1);
    if (!status && (!part->samples || move_all(old, part, fills, fill_count)))
        status = hf_io_fail(err, "%s: out of memory", e->path);
    hf_exr_free_layout(old);
    free(old->samples);
    return status;
}

int hf_exr_grow(struct hf_exr *e, int p, struct hf_io_box box, const struct hf_exr_fill *fills, int fill_count,
                const struct hf_io_run *run, struct hf_io_error *err)
{
    struct hf_exr_part *part = &e->parts[p];
    if (hf_exr_load_samples(e, p, run, err))
        return -1;
    if (!part->layout.channel)
        return hf_io_fail(err, "%s: part %d has subsampled channels, so its data window cannot grow", e->path, p);
    struct hf_exr_part old = *part;
    part->window = (exr_attr_box2i_t){{.x = box.x0, .y = box.y0}, {.x = box.x1 - 1, .y = box.y1 - 1}};
    part->width = box.x1 - box.x0;
    part->height = box.y1 - box.y0;
    return lay_out_again(e, p, &old, fills, fill_count, err);
}

// The channels of a part and one more, in alphabetical order; to be freed.
static struct hf_exr_channel *with_channel(const struct hf_exr_part *part, const char *name)
{
    const int count = part->channel_count;
    struct hf_exr_channel *list = calloc((size_t)count + 1, sizeof(*list));
    int at = 0;
    while (list && at < count && strcmp(part->channels[at].name, name) < 0)
        at++;
    if (!list)
        return NULL;
    memcpy(list, part->channels, (size_t)at * sizeof(*list));
    list[at] = (struct hf_exr_channel){name, EXR_PIXEL_FLOAT, 4, 1, 1};
    memcpy(list + at + 1, part->channels + at, (size_t)(count - at) * sizeof(*list));
    return list;
}

int hf_exr_add_channel(struct hf_exr *e, int p, const char *name, const struct hf_io_run *run, struct hf_io_error *err)
{
    struct hf_exr_part *part = &e->parts[p];
    if (hf_exr_find_channel(part, name) >= 0)
        return 0;
    if (hf_exr_load_samples(e, p, run, err))
        return -1;
    if (!part->layout.channel)
        return hf_io_fail(err, "%s: part %d has subsampled channels, so it cannot take the channel %s", e->path, p,
                          name);
    struct hf_exr_part old = *part;
    char **added = realloc(part->added, ((size_t)part->added_count + 1) * sizeof(*added));
    char *own = added ? strdup(name) : NULL;
    part->added = added ? added : part->added;
    if (own)
        part->added[part->added_count++] = own;
    struct hf_exr_channel *list = own ? with_channel(part, own) : NULL;
    if (!list)
        return hf_io_fail(err, "%s: out of memory", e->path);
    part->channels = list;
    part->channel_count++;
    const int status = lay_out_again(e, p, &old, NULL, 0, err);
    free(old.channels);
    return status;
}
