// SPDX-License-Identifier: BSD-3-Clause
// Compressing chunks. Core compresses only for a context it writes to, so there is one that looks like the part and
// whose output goes nowhere; the compressed bytes are taken out of its pipeline.
#include <string.h>

#include "io/exr/exr.h"

static int64_t write_nowhere(exr_const_context_t core, void *user, const void *data, uint64_t size, uint64_t offset,
                             exr_stream_error_func_ptr_t error)
{
    (void)core, (void)user, (void)data, (void)offset, (void)error;
    return (int64_t)size;
}

// The chunk's samples as one run of bytes. Scan lines are one already; a tile is gathered row by row.
static exr_result_t pack(exr_encode_pipeline_t *pipe)
{
    const struct hf_exr_encoder *en = pipe->encoding_user_data;
    const struct hf_exr_part *part = en->px->part;
    const exr_chunk_info_t *info = &pipe->chunk;
    uint8_t *to = pipe->packed_buffer;
    if (part->storage != EXR_STORAGE_TILED) {
        const int y = info->start_y - part->window.min.y;
        const size_t size = en->px->row[y + info->height] - en->px->row[y];
        if (size > pipe->packed_alloc_size)
            return EXR_ERR_INVALID_ARGUMENT;
        memcpy(to, en->px->data + en->px->row[y], size);
        pipe->packed_bytes = size;
        return EXR_ERR_SUCCESS;
    }
    const int x0 = info->start_x * part->tile_width, y0 = info->start_y * part->tile_height;
    size_t size = 0;
    for (int y = y0; y < y0 + info->height; y++) {
        for (int c = 0; c < part->channel_count; c++) {
            const size_t bytes = (size_t)part->channels[c].bytes, n = (size_t)info->width * bytes;
            if (x0 + info->width > part->width || y >= part->height || size + n > pipe->packed_alloc_size)
                return EXR_ERR_INVALID_ARGUMENT;
            memcpy(to + size, hf_exr_pixel_row(en->px, c, y) + (size_t)x0 * bytes, n);
            size += n;
        }
    }
    pipe->packed_bytes = size;
    return EXR_ERR_SUCCESS;
}

static exr_result_t start_core(struct hf_exr_encoder *en, exr_compression_t compression)
{
    const struct hf_exr_part *part = en->px->part;
    const bool tiled = part->storage == EXR_STORAGE_TILED;
    const exr_attr_v2f_t center = {.x = 0, .y = 0};
    exr_context_initializer_t init;
    int p;
    hf_exr_context_init(en->e, &init);
    init.write_fn = write_nowhere;
    init.zip_level = 4;  // as the C++ library: half the time of 6 for files a few percent longer
    exr_result_t rv = exr_start_write(&en->core, en->e->path, EXR_WRITE_FILE_DIRECTLY, &init);
    if (!rv)
        rv = exr_set_longname_support(en->core, 1);
    if (!rv)
        rv = exr_add_part(en->core, "encoder", tiled ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE, &p);
    if (!rv)
        rv = exr_initialize_required_attr(en->core, 0, &part->window, &part->window, 1.0f, &center, 1.0f,
                                          EXR_LINEORDER_INCREASING_Y, compression);
    if (!rv && tiled)
        rv = exr_set_tile_descriptor(en->core, 0, (uint32_t)part->tile_width, (uint32_t)part->tile_height,
                                     EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN);
    if (!rv)
        rv = exr_set_channels(en->core, 0, part->list);
    return rv ? rv : exr_write_header(en->core);
}

int hf_exr_encoder_open(struct hf_exr_encoder *en, struct hf_exr *e, const struct hf_exr_pixels *px,
                        exr_compression_t compression, struct hf_io_error *err)
{
    memset(en, 0, sizeof(*en));
    en->e = e;
    en->px = px;
    en->chunk_lines = hf_exr_compression_lines(compression);
    hf_exr_quiet(e);
    const exr_result_t rv = start_core(en, compression);
    if (!rv)
        return 0;
    hf_exr_encoder_close(en);
    return hf_io_fail(err, "%s: cannot encode: %s", e->path,
                      e->core_message[0] ? e->core_message : exr_get_default_error_message(rv));
}

static exr_result_t chunk_info(const struct hf_exr_encoder *en, int index, exr_chunk_info_t *info)
{
    const struct hf_exr_part *part = en->px->part;
    if (part->storage == EXR_STORAGE_TILED) {
        const int nx = (part->width - 1) / part->tile_width + 1;
        return exr_write_tile_chunk_info(en->core, 0, index % nx, index / nx, 0, 0, info);
    }
    return exr_write_scanline_chunk_info(en->core, 0, part->window.min.y + index * en->chunk_lines, info);
}

static exr_result_t start_pipe(struct hf_exr_encoder *en, const exr_chunk_info_t *info)
{
    exr_encode_pipeline_t *pipe = &en->pipe;
    exr_result_t rv = exr_encoding_initialize(en->core, 0, info, pipe);
    if (rv)
        return rv;
    en->started = true;
    rv = exr_encoding_choose_default_routines(en->core, 0, pipe);
    pipe->encoding_user_data = en;
    pipe->convert_and_pack_fn = pack;
    pipe->yield_until_ready_fn = NULL;  // nothing is written, so no order is to be kept
    pipe->write_fn = NULL;
    return rv;
}

// Core wants to know where samples come from, though pack() is what fetches them.
static void point_channels(struct hf_exr_encoder *en)
{
    for (int c = 0; c < en->pipe.channel_count; c++) {
        exr_coding_channel_info_t *ch = &en->pipe.channels[c];
        ch->encode_from_ptr = en->px->data;
        ch->user_bytes_per_element = ch->bytes_per_element;
        ch->user_data_type = ch->data_type;
        ch->user_pixel_stride = ch->bytes_per_element;
        ch->user_line_stride = ch->bytes_per_element * ch->width;
    }
}

int hf_exr_encode(struct hf_exr_encoder *en, int index, const void **data, size_t *size, struct hf_io_error *err)
{
    exr_encode_pipeline_t *pipe = &en->pipe;
    exr_chunk_info_t info = {0};
    hf_exr_quiet(en->e);
    exr_result_t rv = chunk_info(en, index, &info);
    if (!rv)
        rv = en->started ? exr_encoding_update(en->core, 0, &info, pipe) : start_pipe(en, &info);
    if (!rv) {
        point_channels(en);
        rv = exr_encoding_run(en->core, 0, pipe);
    }
    if (rv)
        return hf_io_fail(err, "%s: cannot encode chunk %d: %s", en->e->path, index,
                          en->e->core_message[0] ? en->e->core_message : exr_get_default_error_message(rv));
    // What does not shrink is stored as it is.
    const bool smaller = pipe->compressed_buffer && pipe->compressed_bytes < pipe->packed_bytes;
    *data = smaller ? pipe->compressed_buffer : pipe->packed_buffer;
    *size = smaller ? pipe->compressed_bytes : pipe->packed_bytes;
    return 0;
}

void hf_exr_encoder_close(struct hf_exr_encoder *en)
{
    if (en->started)
        exr_encoding_destroy(en->core, &en->pipe);
    if (en->core)
        exr_finish(&en->core);
    memset(en, 0, sizeof(*en));
}
