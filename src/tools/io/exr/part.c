// SPDX-License-Identifier: BSD-3-Clause
// Small questions about a part, and whether its header is plausible.
#include <string.h>
#include <strings.h>

#include "tools/io/exr/exr.h"

static const struct {
    const char *name;
    int lines;  // scan lines per chunk
} compressions[] = {
    [EXR_COMPRESSION_NONE] = {"none", 1},  [EXR_COMPRESSION_RLE] = {"rle", 1},
    [EXR_COMPRESSION_ZIPS] = {"zips", 1},  [EXR_COMPRESSION_ZIP] = {"zip", 16},
    [EXR_COMPRESSION_PIZ] = {"piz", 32},   [EXR_COMPRESSION_PXR24] = {"pxr24", 16},
    [EXR_COMPRESSION_B44] = {"b44", 32},   [EXR_COMPRESSION_B44A] = {"b44a", 32},
    [EXR_COMPRESSION_DWAA] = {"dwaa", 32}, [EXR_COMPRESSION_DWAB] = {"dwab", 256},
};

const char *hf_exr_compression_name(exr_compression_t compression)
{
    const bool known = compression >= 0 && compression < EXR_COMPRESSION_LAST_TYPE && compressions[compression].name;
    return known ? compressions[compression].name : "unknown";
}

int hf_exr_compression_lines(exr_compression_t compression)
{
    return compression >= 0 && compression < EXR_COMPRESSION_LAST_TYPE ? compressions[compression].lines : 0;
}

int hf_exr_compression(const char *name)
{
    if (!strcasecmp(name, "pxr"))
        name = "pxr24";
    for (int i = 0; i < EXR_COMPRESSION_LAST_TYPE; i++)
        if (compressions[i].name && !strcasecmp(compressions[i].name, name))
            return i;
    return -1;
}

bool hf_exr_is_deep(const struct hf_exr_part *part)
{
    return part->storage == EXR_STORAGE_DEEP_SCANLINE || part->storage == EXR_STORAGE_DEEP_TILED;
}

bool hf_exr_is_dwa(exr_compression_t compression)
{
    return compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB;
}

int hf_exr_find_channel(const struct hf_exr_part *part, const char *name)
{
    for (int c = 0; c < part->channel_count; c++)
        if (!strcmp(part->channels[c].name, name))
            return c;
    return -1;
}

static int floor_div(int a, int b)
{
    return a / b - (a % b != 0 && (a < 0) != (b < 0));
}

int hf_exr_row_samples(const struct hf_exr_part *part, int c)
{
    const int s = part->channels[c].x_sampling;
    return floor_div(part->window.max.x, s) - floor_div(part->window.min.x - 1, s);
}

bool hf_exr_row_has(const struct hf_exr_part *part, int c, int y)
{
    return (part->window.min.y + y) % part->channels[c].y_sampling == 0;
}

// The size of the decoded part in bytes, except for the rounding of subsampled channels.
static uint64_t decoded_bytes(const struct hf_exr_part *part)
{
    uint64_t sum = 0;
    for (int c = 0; c < part->channel_count; c++) {
        const struct hf_exr_channel *ch = &part->channels[c];
        sum +=
            (uint64_t)(part->width / ch->x_sampling) * (uint64_t)(part->height / ch->y_sampling) * (uint64_t)ch->bytes;
    }
    return sum;
}

static bool is_tiled(const struct hf_exr_part *part)
{
    return part->storage == EXR_STORAGE_TILED || part->storage == EXR_STORAGE_DEEP_TILED;
}

static int chunks_needed(const struct hf_exr_part *part)
{
    if (is_tiled(part)) {
        const int64_t nx = (part->width - 1) / part->tile_width + 1, ny = (part->height - 1) / part->tile_height + 1;
        return nx * ny > INT32_MAX ? INT32_MAX : (int)(nx * ny);
    }
    return (part->height - 1) / part->chunk_lines + 1;
}

int hf_exr_check_part(const struct hf_exr *e, int p, struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[p];
    const exr_attr_box2i_t *w = &part->window;
    if (part->grown)
        return 0;
    if (!part->window_ok)
        return hf_io_fail(err, "%s: data window (%d %d) - (%d %d) is empty, too far out, or larger than %d a side",
                          e->path, w->min.x, w->min.y, w->max.x, w->max.y, HF_IO_MAX_SIDE);
    if (!is_tiled(part) && part->chunk_lines < 1)
        return hf_io_fail(err, "%s: part %d has a compression (%d) that is not supported", e->path, p,
                          (int)part->compression);
    const int needed = chunks_needed(part);
    if (part->one_level ? part->chunk_count != needed : part->chunk_count < needed)
        return hf_io_fail(err, "%s: truncated or corrupt: part %d has %d chunks but its data window needs %d", e->path,
                          p, part->chunk_count, needed);
    // Pictures of one colour compress without limit (PIZ, DWA), and black frames are legitimate. But if every header
    // were believed, a short file could demand any amount of memory. So beyond half a gigabyte the limit is twice what
    // deflate can reach.
    const uint64_t bytes = decoded_bytes(part);
    if (bytes > (uint64_t)1 << 29 && bytes / 2048 > e->size)
        return hf_io_fail(err, "%s: truncated or corrupt: %llu bytes cannot hold %d x %d pixels of %d channels",
                          e->path, (unsigned long long)e->size, part->width, part->height, part->channel_count);
    return 0;
}
