// SPDX-License-Identifier: BSD-3-Clause
// All samples of a part in memory, in the order and the types in which EXR stores them: a chunk of scan lines is then
// one run of bytes, and channels that are not replaced are never converted.
#include <stdlib.h>
#include <string.h>

#include "io/exr/exr.h"

static size_t sample_bytes(const struct hf_exr_part *part, int c)
{
    return (size_t)hf_exr_row_samples(part, c) * (size_t)part->channels[c].bytes;
}

uint8_t *hf_exr_pixel_row(const struct hf_exr_pixels *px, int c, int y)
{
    size_t at = px->row[y];
    if (px->channel)
        return px->data + at + px->channel[c];
    for (int i = 0; i < c; i++)
        at += hf_exr_row_has(px->part, i, y) ? sample_bytes(px->part, i) : 0;
    return px->data + at;
}

static bool has_subsampling(const struct hf_exr_part *part)
{
    bool any = false;
    for (int c = 0; c < part->channel_count; c++)
        any |= part->channels[c].x_sampling != 1 || part->channels[c].y_sampling != 1;
    return any;
}

int hf_exr_alloc_pixels(struct hf_exr_pixels *px, const char *path, const struct hf_exr_part *part,
                        struct hf_io_error *err)
{
    memset(px, 0, sizeof(*px));
    px->part = part;
    px->row = malloc(((size_t)part->height + 1) * sizeof(*px->row));
    size_t at = 0;
    for (int y = 0; px->row && y <= part->height; y++) {
        px->row[y] = at;
        for (int c = 0; c < part->channel_count; c++)
            at += y < part->height && hf_exr_row_has(part, c, y) ? sample_bytes(part, c) : 0;
    }
    if (!has_subsampling(part))
        px->channel = malloc((size_t)part->channel_count * sizeof(*px->channel));
    at = 0;
    for (int c = 0; px->channel && c < part->channel_count; c++) {
        px->channel[c] = at;
        at += sample_bytes(part, c);
    }
    px->data = px->row ? malloc(px->row[part->height] + 1) : NULL;
    if (px->data)
        return 0;
    hf_exr_free_pixels(px);
    return hf_io_fail(err, "%s: out of memory: %d x %d pixels of %d channels", path, part->width, part->height,
                      part->channel_count);
}

void hf_exr_free_pixels(struct hf_exr_pixels *px)
{
    free(px->data);
    free(px->row);
    free(px->channel);
    memset(px, 0, sizeof(*px));
}

struct copy_rows {
    const struct hf_exr_pixels *px;
    bool bad;
};

static void copy_row(void *arg, int c, int x, int y, const uint8_t *samples, int count)
{
    struct copy_rows *r = arg;
    const struct hf_exr_part *part = r->px->part;
    const int bytes = part->channels[c].bytes;
    // Core and we must agree on how subsampled rows round.
    if (part->storage == EXR_STORAGE_TILED ? x + count > part->width : count != hf_exr_row_samples(part, c)) {
        r->bad = true;
        return;
    }
    memcpy(hf_exr_pixel_row(r->px, c, y) + (size_t)x * (size_t)bytes, samples, (size_t)count * (size_t)bytes);
}

// Every row of the part, whole rows, by the codec.
static int read_by_codec(struct hf_exr *e, int p, struct hf_exr_pixels *px, struct hf_io_error *err)
{
    struct hf_io_samples s;
    struct hf_exr_names names;
    if (hf_exr_samples(px, e->path, &s, &names, err))
        return -1;
    const int status = e->dwa->read(e->path, p, &s, err);
    hf_exr_free_names(&names);
    return status;
}

int hf_exr_read_pixels(struct hf_exr *e, int p, struct hf_exr_pixels *px, struct hf_io_error *err)
{
    struct copy_rows r = {.px = px};
    int status;
    if (hf_exr_alloc_pixels(px, e->path, &e->parts[p], err))
        return -1;
    if (hf_exr_is_dwa(e->parts[p].compression))
        status = read_by_codec(e, p, px, err);
    else
        status = hf_exr_rows(e, p, copy_row, &r, err);
    if (!status && r.bad)
        status =
            hf_io_fail(err, "%s: truncated or corrupt: subsampled rows of part %d have the wrong length", e->path, p);
    if (status)
        hf_exr_free_pixels(px);
    return status;
}

int hf_exr_samples(const struct hf_exr_pixels *px, const char *path, struct hf_io_samples *s,
                   struct hf_exr_names *names, struct hf_io_error *err)
{
    const struct hf_exr_part *part = px->part;
    const size_t n = (size_t)part->channel_count;
    names->names = calloc(n, sizeof(*names->names));
    names->types = calloc(n, sizeof(*names->types));
    *s = (struct hf_io_samples){.x = part->window.min.x,
                                .y = part->window.min.y,
                                .width = part->width,
                                .height = part->height,
                                .channel_count = part->channel_count,
                                .data = px->data,
                                .tile_width = part->tile_width,
                                .tile_height = part->tile_height,
                                .row_bytes = px->row[1],
                                .names = names->names,
                                .types = names->types};
    if (!names->names || !names->types) {
        hf_exr_free_names(names);
        return hf_io_fail(err, "%s: out of memory", path);
    }
    for (int c = 0; c < part->channel_count; c++) {
        names->names[c] = part->channels[c].name;
        names->types[c] = (uint8_t)part->channels[c].type;
        if (part->channels[c].x_sampling == 1 && part->channels[c].y_sampling == 1)
            continue;
        hf_exr_free_names(names);
        return hf_io_fail(err, "%s: channel %s is subsampled, which is not supported together with DWA compression",
                          path, part->channels[c].name);
    }
    return 0;
}

void hf_exr_free_names(struct hf_exr_names *names)
{
    free(names->names);
    free(names->types);
    memset(names, 0, sizeof(*names));
}
