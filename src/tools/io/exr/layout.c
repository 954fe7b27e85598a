// SPDX-License-Identifier: BSD-3-Clause
// Where a part's samples lie in memory: as in its chunks, so that channels that are not replaced are never converted.
#include <stdlib.h>

#include "tools/io/exr/exr.h"

static size_t sample_bytes(const struct hf_exr_part *part, int c)
{
    return (size_t)hf_exr_row_samples(part, c) * (size_t)part->channels[c].bytes;
}

static bool has_subsampling(const struct hf_exr_part *part)
{
    bool any = false;
    for (int c = 0; c < part->channel_count; c++)
        any |= part->channels[c].x_sampling != 1 || part->channels[c].y_sampling != 1;
    return any;
}

void hf_exr_free_layout(struct hf_exr_part *part)
{
    free(part->layout.row);
    free(part->layout.channel);
    part->layout = (struct hf_exr_layout){0};
}

int hf_exr_lay_out(const struct hf_exr *e, int p, struct hf_io_error *err)
{
    struct hf_exr_part *part = &e->parts[p];
    struct hf_exr_layout *l = &part->layout;
    const bool tiled = part->storage == EXR_STORAGE_TILED;
    if (l->row || l->channel)
        return 0;
    if (hf_exr_check_part(e, p, err))
        return -1;
    if (tiled && has_subsampling(part))
        return hf_io_fail(err, "%s: truncated or corrupt: tiles of subsampled channels in part %d", e->path, p);
    if (!has_subsampling(part))
        l->channel = malloc((size_t)part->channel_count * sizeof(*l->channel));
    for (int c = 0; c < part->channel_count && l->channel; c++) {
        l->channel[c] = l->pixel_bytes;
        l->pixel_bytes += (size_t)part->channels[c].bytes;
    }
    l->bytes = l->pixel_bytes * (size_t)part->width * (size_t)part->height;
    if (!tiled)
        l->row = malloc(((size_t)part->height + 1) * sizeof(*l->row));
    size_t at = 0;
    for (int y = 0; l->row && y <= part->height; y++) {
        l->row[y] = at;
        if (l->channel)
            at += l->pixel_bytes * (size_t)part->width;
        for (int c = 0; c < part->channel_count && !l->channel; c++)
            at += y < part->height && hf_exr_row_has(part, c, y) ? sample_bytes(part, c) : 0;
    }
    if (l->row)
        l->bytes = l->row[part->height];
    if ((tiled || l->row) && (l->channel || has_subsampling(part)))
        return 0;
    hf_exr_free_layout(part);
    return hf_io_fail(err, "%s: out of memory", e->path);
}

int hf_exr_count_chunks(const struct hf_exr_part *part, int lines)
{
    if (part->storage == EXR_STORAGE_TILED)
        return ((part->width - 1) / part->tile_width + 1) * ((part->height - 1) / part->tile_height + 1);
    return (part->height - 1) / lines + 1;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

struct hf_exr_chunk hf_exr_chunk_at(const struct hf_exr_part *part, int lines, int index)
{
    const struct hf_exr_layout *l = &part->layout;
    struct hf_exr_chunk c = {.index = index, .width = part->width};
    if (part->storage == EXR_STORAGE_TILED) {
        const int nx = (part->width - 1) / part->tile_width + 1;
        c.x0 = index % nx * part->tile_width;
        c.y0 = index / nx * part->tile_height;
        c.width = least(part->tile_width, part->width - c.x0);
        c.height = least(part->tile_height, part->height - c.y0);
        // The rows of tiles above, and the tiles to the left in this row.
        c.at = l->pixel_bytes * ((size_t)part->width * (size_t)c.y0 + (size_t)c.x0 * (size_t)c.height);
        c.size = l->pixel_bytes * (size_t)c.width * (size_t)c.height;
    } else {
        c.y0 = index * lines;
        c.height = least(lines, part->height - c.y0);
        c.at = l->row[c.y0];
        c.size = l->row[c.y0 + c.height] - c.at;
    }
    return c;
}

size_t hf_exr_row_at(const struct hf_exr_part *part, const struct hf_exr_chunk *chunk, int c, int y)
{
    const struct hf_exr_layout *l = &part->layout;
    if (l->channel)
        return (size_t)chunk->width * (l->pixel_bytes * (size_t)(y - chunk->y0) + l->channel[c]);
    size_t at = l->row[y] - chunk->at;
    for (int i = 0; i < c; i++)
        at += hf_exr_row_has(part, i, y) ? sample_bytes(part, i) : 0;
    return at;
}
