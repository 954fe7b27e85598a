// SPDX-License-Identifier: BSD-3-Clause
// Compresses chunks: libdeflate makes ZIP, Core the rest. Core compresses only for a context that it writes to. So
// there is a context that looks like the part, whose output is discarded; the compressed bytes are taken from its
// pipeline.
#include <stdlib.h>
#include <string.h>

#include <libdeflate.h>

#include "tools/io/exr/exr.h"
#include "tools/io/exr/zip.h"

// Files must not be longer than those of the C++ library (zlib, level 4). libdeflate's level 2 makes pictures of halves in
// chunks of 16 lines up to 1.5 % shorter than that, its level 4 by 2 to 4 % in a fifth more time. But what shrinks to less
// than a tenth (gradients, patterns) comes out up to 9 times longer with level 2, so those chunks are tried with level 4
// too. Floats and single lines become 1 to 5 % longer than zlib's with level 2, so they always have level 4: at most 1.5 %
// longer for some floats, and only level 6, in 1.6 times the time, makes these shorter. For noise in all bits, zip.c stores
// the half that does not shrink.
enum { ZIP_FAST = 2, ZIP_USUAL = 4, ZIP_SHRINKS_WELL = 10 };

static int64_t write_nowhere(exr_const_context_t core, void *user, const void *data, uint64_t size, uint64_t offset,
                             exr_stream_error_func_ptr_t error)
{
    (void)core, (void)user, (void)data, (void)offset, (void)error;
    return (int64_t)size;
}

// The chunk's samples already lie as Core wants them.
static exr_result_t pack(exr_encode_pipeline_t *pipe)
{
    const struct hf_exr_encoder *en = pipe->encoding_user_data;
    if (en->raw_size > pipe->packed_alloc_size)
        return EXR_ERR_INVALID_ARGUMENT;
    memcpy(pipe->packed_buffer, en->raw, en->raw_size);
    pipe->packed_bytes = en->raw_size;
    return EXR_ERR_SUCCESS;
}

static exr_result_t start_core(struct hf_exr_encoder *en)
{
    const struct hf_exr_part *part = en->part;
    const bool tiled = part->storage == EXR_STORAGE_TILED;
    const exr_attr_v2f_t center = {.x = 0, .y = 0};
    exr_context_initializer_t init;
    int p;
    hf_exr_context_init(en, &init);
    init.write_fn = write_nowhere;
    exr_result_t rv = exr_start_write(&en->core, en->e->path, EXR_WRITE_FILE_DIRECTLY, &init);
    if (!rv)
        rv = exr_set_longname_support(en->core, 1);
    if (!rv)
        rv = exr_add_part(en->core, "encoder", tiled ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE, &p);
    if (!rv)
        rv = exr_initialize_required_attr(en->core, 0, &part->window, &part->window, 1.0f, &center, 1.0f,
                                          EXR_LINEORDER_INCREASING_Y, en->compression);
    if (!rv && tiled)
        rv = exr_set_tile_descriptor(en->core, 0, (uint32_t)part->tile_width, (uint32_t)part->tile_height,
                                     EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN);
    if (!rv)
        rv = exr_set_channels(en->core, 0, part->list);
    for (int i = 0; i < part->added_count && !rv; i++)
        rv = exr_add_channel(en->core, 0, part->added[i], EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    return rv ? rv : exr_write_header(en->core);
}

static bool is_zip(exr_compression_t c)
{
    return c == EXR_COMPRESSION_ZIP || c == EXR_COMPRESSION_ZIPS;
}

static bool is_fast(const struct hf_exr_part *part, exr_compression_t compression)
{
    bool halves = compression == EXR_COMPRESSION_ZIP;
    for (int c = 0; c < part->channel_count; c++)
        halves &= part->channels[c].type == EXR_PIXEL_HALF;
    return halves;
}

int hf_exr_encoder_open(struct hf_exr_encoder *en, struct hf_exr *e, const struct hf_exr_part *part,
                        exr_compression_t compression, int zip_level, struct hf_io_error *err)
{
    memset(en, 0, sizeof(*en));
    en->e = e;
    en->part = part;
    en->compression = compression;
    en->lines = hf_exr_compression_lines(compression);
    if (is_zip(compression)) {
        const bool fast = !zip_level && is_fast(part, compression);
        en->deflate = libdeflate_alloc_compressor(zip_level ? zip_level : fast ? ZIP_FAST : ZIP_USUAL);
        en->again = fast ? libdeflate_alloc_compressor(ZIP_USUAL) : NULL;
        if (en->deflate && (en->again || !fast))
            return 0;
        hf_exr_encoder_close(en);
        return hf_io_fail(err, "%s: out of memory", e->path);
    }
    if (compression == EXR_COMPRESSION_NONE)
        return 0;
    hf_exr_quiet();
    const exr_result_t rv = start_core(en);
    if (!rv)
        return 0;
    hf_exr_encoder_close(en);
    return hf_io_fail(err, "%s: cannot encode: %s", e->path, hf_exr_said(rv));
}

static exr_result_t chunk_info(const struct hf_exr_encoder *en, const struct hf_exr_chunk *k, exr_chunk_info_t *info)
{
    const struct hf_exr_part *part = en->part;
    if (part->storage == EXR_STORAGE_TILED)
        return exr_write_tile_chunk_info(en->core, 0, k->x0 / part->tile_width, k->y0 / part->tile_height, 0, 0, info);
    return exr_write_scanline_chunk_info(en->core, 0, part->window.min.y + k->y0, info);
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
    pipe->yield_until_ready_fn = NULL;  // nothing is written, so there is no order to keep
    pipe->write_fn = NULL;
    return rv;
}

// Core needs addresses of samples, though pack() fetches them.
static void point_channels(struct hf_exr_encoder *en)
{
    for (int c = 0; c < en->pipe.channel_count; c++) {
        exr_coding_channel_info_t *ch = &en->pipe.channels[c];
        ch->encode_from_ptr = en->raw;
        ch->user_bytes_per_element = ch->bytes_per_element;
        ch->user_data_type = ch->data_type;
        ch->user_pixel_stride = ch->bytes_per_element;
        ch->user_line_stride = ch->bytes_per_element * ch->width;
    }
}

static int encode_by_core(struct hf_exr_encoder *en, const struct hf_exr_chunk *k, const uint8_t **data, size_t *size,
                          struct hf_io_error *err)
{
    exr_encode_pipeline_t *pipe = &en->pipe;
    exr_chunk_info_t info = {0};
    hf_exr_quiet();
    exr_result_t rv = chunk_info(en, k, &info);
    if (!rv)
        rv = en->started ? exr_encoding_update(en->core, 0, &info, pipe) : start_pipe(en, &info);
    if (!rv) {
        point_channels(en);
        rv = exr_encoding_run(en->core, 0, pipe);
    }
    if (rv)
        return hf_io_fail(err, "%s: cannot encode chunk %d: %s", en->e->path, k->index, hf_exr_said(rv));
    if (pipe->compressed_buffer && pipe->compressed_bytes < pipe->packed_bytes) {
        *data = pipe->compressed_buffer;
        *size = pipe->compressed_bytes;
    }
    return 0;
}

static int encode_zip(struct hf_exr_encoder *en, const struct hf_exr_chunk *k, const uint8_t **data, size_t *size,
                      struct hf_io_error *err)
{
    if (k->size > en->scratch_size || !en->scratch) {
        free(en->scratch);
        en->scratch = malloc(4 * k->size + 1);
        en->scratch_size = en->scratch ? k->size : 0;
        if (!en->scratch)
            return hf_io_fail(err, "%s: out of memory", en->e->path);
    }
    uint8_t *packed = en->scratch + 2 * k->size;
    size_t n = hf_exr_zip(en->deflate, packed, en->raw, k->size, en->scratch);
    if (en->again && n && n < k->size / ZIP_SHRINKS_WELL) {
        const size_t again = hf_exr_zip(en->again, packed + k->size, en->raw, k->size, en->scratch);
        packed += again && again < n ? k->size : 0;
        n = again && again < n ? again : n;
    }
    if (n) {
        *data = packed;
        *size = n;
    }
    return 0;
}

int hf_exr_encode(struct hf_exr_encoder *en, const struct hf_exr_chunk *chunk, const uint8_t *raw, const uint8_t **data,
                  size_t *size, struct hf_io_error *err)
{
    en->raw = *data = raw;
    en->raw_size = *size = chunk->size;
    if (en->compression == EXR_COMPRESSION_NONE)
        return 0;
    return (en->deflate ? encode_zip : encode_by_core)(en, chunk, data, size, err);
}

void hf_exr_encoder_close(struct hf_exr_encoder *en)
{
    if (en->started)
        exr_encoding_destroy(en->core, &en->pipe);
    if (en->core)
        exr_finish(&en->core);
    libdeflate_free_compressor(en->deflate);
    libdeflate_free_compressor(en->again);
    free(en->scratch);
    memset(en, 0, sizeof(*en));
}
