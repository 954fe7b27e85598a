// SPDX-License-Identifier: BSD-3-Clause
// Decoding a part: Core reads and decompresses chunks, we pick the channels out of the rows.
#include <math.h>
#include <string.h>

#include "io/exr/exr.h"
#include "io/half.h"

// Chunk number index of level 0, in table order.
static exr_result_t chunk_info(const struct hf_exr *e, int p, int index, exr_chunk_info_t *info)
{
    const struct hf_exr_part *part = &e->parts[p];
    if (part->storage == EXR_STORAGE_TILED) {
        const int nx = (part->width - 1) / part->tile_width + 1;
        return exr_read_tile_chunk_info(e->core, p, index % nx, index / nx, 0, 0, info);
    }
    return exr_read_scanline_chunk_info(e->core, p, part->window.min.y + index * part->chunk_lines, info);
}

// A part being decoded.
struct decoder {
    exr_decode_pipeline_t pipe;
    exr_result_t (*decompress)(exr_decode_pipeline_t *);
};

// Have Core read and decompress one chunk into d->pipe.unpacked_buffer.
static exr_result_t decode_chunk(struct hf_exr *e, int p, const exr_chunk_info_t *info, struct decoder *d)
{
    exr_result_t rv;
    // Core leaves such a chunk's buffer as it finds it.
    if (e->parts[p].compression == EXR_COMPRESSION_NONE && info->packed_size != info->unpacked_size)
        return EXR_ERR_BAD_CHUNK_LEADER;
    if (!d->pipe.context) {
        rv = exr_decoding_initialize(e->core, p, info, &d->pipe);
        if (!rv)
            rv = exr_decoding_choose_default_routines(e->core, p, &d->pipe);
        d->pipe.unpack_and_convert_fn = NULL;  // the rows are used as they are
        d->decompress = d->pipe.decompress_fn;
    } else {
        rv = exr_decoding_update(e->core, p, info, &d->pipe);
    }
    // What did not shrink is stored as it is, whatever the compression. Core 3.1 forgets that for B44.
    d->pipe.decompress_fn = info->packed_size == info->unpacked_size ? NULL : d->decompress;
    return rv ? rv : exr_decoding_run(e->core, p, &d->pipe);
}

// Hand the rows of a decoded chunk out. False when they do not fill it as they should.
static bool chunk_rows(const struct hf_exr *e, int p, const exr_decode_pipeline_t *pipe, hf_exr_row *row, void *arg)
{
    const struct hf_exr_part *part = &e->parts[p];
    const exr_chunk_info_t *info = &pipe->chunk;
    const bool tiled = part->storage == EXR_STORAGE_TILED;
    const int x0 = tiled ? info->start_x * part->tile_width : 0;
    const int y0 = tiled ? info->start_y * part->tile_height : info->start_y - part->window.min.y;
    const uint8_t *at = pipe->unpacked_buffer;
    uint64_t left = info->unpacked_size;
    for (int y = y0; y < y0 + info->height; y++) {
        for (int c = 0; c < part->channel_count; c++) {
            const exr_coding_channel_info_t *ch = &pipe->channels[c];
            const uint64_t bytes = (uint64_t)ch->width * (uint64_t)part->channels[c].bytes;
            if (!hf_exr_row_has(part, c, y))
                continue;
            if (!at || bytes > left || ch->width < 0 || x0 + ch->width > part->width || y >= part->height)
                return false;
            row(arg, c, x0, y, at, ch->width);
            at += bytes;
            left -= bytes;
        }
    }
    return true;
}

static int rows_by_codec(struct hf_exr *e, int p, hf_exr_row *row, void *arg, struct hf_io_error *err)
{
    struct hf_exr_pixels px;
    if (hf_exr_read_pixels(e, p, &px, err))
        return -1;
    for (int y = 0; y < px.part->height; y++)
        for (int c = 0; c < px.part->channel_count; c++)
            row(arg, c, 0, y, hf_exr_pixel_row(&px, c, y), px.part->width);
    hf_exr_free_pixels(&px);
    return 0;
}

int hf_exr_rows(struct hf_exr *e, int p, hf_exr_row *row, void *arg, struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[p];
    struct decoder d = {.decompress = NULL};
    if (hf_exr_is_dwa(part->compression))
        return rows_by_codec(e, p, row, arg, err);
    const int lines = part->storage == EXR_STORAGE_TILED ? part->tile_height : part->chunk_lines;
    const int across = part->storage == EXR_STORAGE_TILED ? (part->width - 1) / part->tile_width + 1 : 1;
    const int count = ((part->height - 1) / lines + 1) * across;
    int status = 0;
    hf_exr_quiet(e);
    for (int i = 0; i < count && !status; i++) {
        exr_chunk_info_t info = {0};
        exr_result_t rv = chunk_info(e, p, i, &info);
        if (!rv)
            rv = decode_chunk(e, p, &info, &d);
        if (rv)
            status = hf_exr_fail(e, rv, err);
        else if (!chunk_rows(e, p, &d.pipe, row, arg))
            status = hf_io_fail(err, "%s: truncated or corrupt: chunk %d of part %d has the wrong size", e->path, i, p);
    }
    exr_decoding_destroy(e->core, &d.pipe);
    return status;
}

static void to_floats(float *to, const uint8_t *samples, int count, exr_pixel_type_t type)
{
    if (type == EXR_PIXEL_FLOAT) {
        memcpy(to, samples, (size_t)count * sizeof(*to));
        return;
    }
    for (int i = 0; i < count; i++) {
        uint16_t h;
        uint32_t u;
        if (type == EXR_PIXEL_HALF) {
            memcpy(&h, samples + 2 * (size_t)i, sizeof(h));
            to[i] = hf_io_from_half(h);
        } else {
            memcpy(&u, samples + 4 * (size_t)i, sizeof(u));
            to[i] = (float)u;
        }
    }
}

struct colour_rows {
    const struct hf_exr_part *part;
    int channel[4];
    float *const *planes;
};

static void colour_row(void *arg, int c, int x, int y, const uint8_t *samples, int count)
{
    const struct colour_rows *r = arg;
    for (int k = 0; k < 4; k++)
        if (r->channel[k] == c && r->planes[k])
            to_floats(r->planes[k] + (size_t)y * (size_t)r->part->width + x, samples, count, r->part->channels[c].type);
}

int hf_exr_read_colour(struct hf_exr *e, const struct hf_io_view *view, float *const planes[4], struct hf_io_error *err)
{
    struct colour_rows r = {.part = &e->parts[view->part], .planes = planes};
    for (int k = 0; k < 4; k++)
        r.channel[k] = view->colour[k][0] ? hf_exr_find_channel(r.part, view->colour[k]) : -1;
    return hf_exr_rows(e, view->part, colour_row, &r, err);
}

struct depth_rows {
    const struct hf_exr_part *part;
    int channel;
    struct hf_io_box grid;
    float *depth;
};

// Both windows are within HF_IO_MAX_COORDINATE, so their differences fit.
static void depth_row(void *arg, int c, int x, int y, const uint8_t *samples, int count)
{
    const struct depth_rows *r = arg;
    const struct hf_exr_part *part = r->part;
    const int gx = part->window.min.x + x, gy = part->window.min.y + y;
    const int from = gx > r->grid.x0 ? gx : r->grid.x0;
    const int to = gx + count < r->grid.x1 ? gx + count : r->grid.x1;
    if (c != r->channel || gy < r->grid.y0 || gy >= r->grid.y1 || from >= to)
        return;
    const size_t width = (size_t)(r->grid.x1 - r->grid.x0);
    to_floats(r->depth + (size_t)(gy - r->grid.y0) * width + (from - r->grid.x0),
              samples + (size_t)(from - gx) * (size_t)part->channels[c].bytes, to - from, part->channels[c].type);
}

int hf_exr_read_depth(struct hf_exr *e, int p, int c, struct hf_io_box grid, float *depth, struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[p];
    const exr_attr_box2i_t *w = &part->window;
    struct depth_rows r = {part, c, grid, depth};
    if (w->max.x < grid.x0 || w->min.x >= grid.x1 || w->max.y < grid.y0 || w->min.y >= grid.y1)
        return hf_io_fail(
            err, "%s: depth channel %s covers (%d %d) - (%d %d), nothing of the colour's (%d %d) - (%d %d)", e->path,
            part->channels[c].name, w->min.x, w->min.y, w->max.x, w->max.y, grid.x0, grid.y0, grid.x1 - 1, grid.y1 - 1);
    const size_t n = (size_t)(grid.x1 - grid.x0) * (size_t)(grid.y1 - grid.y0);
    if (w->min.x > grid.x0 || w->min.y > grid.y0 || w->max.x + 1 < grid.x1 || w->max.y + 1 < grid.y1)
        for (size_t i = 0; i < n; i++)
            depth[i] = INFINITY;
    return hf_exr_rows(e, p, depth_row, &r, err);
}
