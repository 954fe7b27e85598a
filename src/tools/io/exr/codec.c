// SPDX-License-Identifier: BSD-3-Clause
// Parts that the codec reads and writes as a whole, in complete rows: DWA.
#include <stdlib.h>
#include <string.h>

#include "tools/io/exr/exr.h"

struct names {
    const char **names;
    uint8_t *types;
};

static void free_names(struct names *n)
{
    free(n->names);
    free(n->types);
}

static int describe(const struct hf_exr *e, int p, int threads, struct hf_io_samples *s, struct names *n,
                    struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[p];
    const size_t count = (size_t)part->channel_count;
    *n = (struct names){calloc(count, sizeof(*n->names)), calloc(count, sizeof(*n->types))};
    *s = (struct hf_io_samples){.x = part->window.min.x,
                                .y = part->window.min.y,
                                .width = part->width,
                                .height = part->height,
                                .channel_count = part->channel_count,
                                .names = n->names,
                                .types = n->types,
                                .tile_width = part->tile_width,
                                .tile_height = part->tile_height,
                                .row_bytes = part->layout.pixel_bytes * (size_t)part->width,
                                .threads = threads};
    if (!n->names || !n->types)
        return hf_io_fail(err, "%s: out of memory", e->path);
    for (int c = 0; c < part->channel_count; c++) {
        n->names[c] = part->channels[c].name;
        n->types[c] = (uint8_t)part->channels[c].type;
        if (part->channels[c].x_sampling != 1 || part->channels[c].y_sampling != 1)
            return hf_io_fail(err, "%s: channel %s is subsampled, which is not supported together with DWA compression",
                              e->path, part->channels[c].name);
    }
    return 0;
}

// Convert between complete rows and tiles.
static void regroup(const struct hf_exr_part *part, uint8_t *rows, uint8_t *tiles, bool to_rows)
{
    const size_t row_bytes = part->layout.pixel_bytes * (size_t)part->width;
    for (int i = 0; i < hf_exr_count_chunks(part, 1); i++) {
        const struct hf_exr_chunk k = hf_exr_chunk_at(part, 1, i);
        for (int y = k.y0; y < k.y0 + k.height; y++)
            for (int c = 0; c < part->channel_count; c++) {
                const size_t bytes = (size_t)part->channels[c].bytes;
                uint8_t *row =
                    rows + (size_t)y * row_bytes + part->layout.channel[c] * (size_t)part->width + (size_t)k.x0 * bytes;
                uint8_t *tile = tiles + k.at + hf_exr_row_at(part, &k, c, y);
                memcpy(to_rows ? row : tile, to_rows ? tile : row, (size_t)k.width * bytes);
            }
    }
}

int hf_exr_codec_read(struct hf_exr *e, int p, uint8_t *samples, int threads, struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[p];
    const bool tiled = part->storage == EXR_STORAGE_TILED;
    struct hf_io_samples s;
    struct names names;
    int status = describe(e, p, threads, &s, &names, err);
    if (!status) {
        s.data = tiled ? hf_io_alloc(part->layout.bytes + 1) : samples;
        status = s.data ? e->dwa->read(e->path, p, &s, err) : hf_io_fail(err, "%s: out of memory", e->path);
    }
    if (tiled) {
        if (!status)
            regroup(part, s.data, samples, false);
        free(s.data);
    }
    free_names(&names);
    return status;
}

int hf_exr_codec_write(struct hf_exr *e, int p, exr_compression_t compression, const uint8_t *samples, int threads,
                       struct hf_io_bytes *made, struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[p];
    struct hf_io_samples s;
    struct names names;
    const bool tiled = part->storage == EXR_STORAGE_TILED;
    float level = 0;
    uint8_t *rows = tiled ? hf_io_alloc(part->layout.bytes + 1) : NULL;
    if (exr_attr_get_float(e->core, p, "dwaCompressionLevel", &level) != EXR_ERR_SUCCESS)
        level = 0;
    int status = describe(e, p, threads, &s, &names, err);
    if (!status && tiled && !rows)
        status = hf_io_fail(err, "%s: out of memory", e->path);
    if (!status) {
        if (tiled)
            regroup(part, rows, (uint8_t *)samples, true);
        s.data = tiled ? rows : (uint8_t *)samples;  // which are only read
        status = e->dwa->write(made, e->path, &s, hf_exr_compression_name(compression), level, err);
    }
    free(rows);
    free_names(&names);
    return status;
}
