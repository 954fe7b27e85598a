// SPDX-License-Identifier: BSD-3-Clause
// Writes a new EXR file of float channels, without a source to copy from.
#include <stdlib.h>
#include <string.h>

#include "tools/io/exr/exr.h"

struct new_file {
    struct hf_io_bytes bytes;
    size_t room;
};

static int64_t write_out(exr_const_context_t core, void *user, const void *data, uint64_t size, uint64_t offset,
                         exr_stream_error_func_ptr_t error)
{
    struct new_file *n = user;
    (void)core;
    (void)error;
    if (size > SIZE_MAX / 4 || offset > SIZE_MAX / 4)
        return -1;
    if (offset + size > n->room) {
        const size_t room = 2 * (size_t)(offset + size);
        uint8_t *grown = realloc(n->bytes.data, room);
        if (!grown)
            return -1;
        n->bytes.data = grown;
        n->room = room;
    }
    if (offset > n->bytes.size)
        memset(n->bytes.data + n->bytes.size, 0, (size_t)offset - n->bytes.size);
    memcpy(n->bytes.data + offset, data, size);
    n->bytes.size = offset + size > n->bytes.size ? (size_t)(offset + size) : n->bytes.size;
    return (int64_t)size;
}

static exr_attr_box2i_t to_attr(struct hf_io_box b)
{
    return (exr_attr_box2i_t){.min = {.x = b.x0, .y = b.y0}, .max = {.x = b.x1 - 1, .y = b.y1 - 1}};
}

static exr_result_t describe(exr_context_t core, const struct hf_exr_new *picture)
{
    const exr_attr_box2i_t data = to_attr(picture->data_window), display = to_attr(picture->display_window);
    const exr_attr_v2f_t center = {.x = picture->screen_center_x, .y = picture->screen_center_y};
    int p;
    exr_result_t rv = exr_set_longname_support(core, 1);
    if (!rv)
        rv = exr_add_part(core, "picture", EXR_STORAGE_SCANLINE, &p);
    if (!rv)
        rv = exr_initialize_required_attr(core, 0, &display, &data, picture->pixel_aspect, &center,
                                          picture->screen_width, EXR_LINEORDER_INCREASING_Y, picture->compression);
    for (int i = 0; i < picture->text_count && !rv; i++)
        rv = exr_attr_set_string(core, 0, picture->texts[i].name, picture->texts[i].value);
    if (!rv && picture->text_count)
        rv = exr_attr_set_string(core, 0, HF_EXR_SUM, "00000000");
    for (int c = 0; c < picture->channel_count && !rv; c++)
        rv = exr_add_channel(core, 0, picture->names[c], EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    return rv ? rv : exr_write_header(core);
}

// The plane of a channel, by name, because Core sorts channels.
static const float *plane_of(const struct hf_exr_new *picture, const char *name)
{
    for (int c = 0; c < picture->channel_count; c++)
        if (!strcmp(picture->names[c], name))
            return picture->planes[c];
    return NULL;
}

typedef exr_result_t compressor(exr_encode_pipeline_t *pipe);

// Core's own compressor, except for a chunk that becomes exactly as long as it was: readers take such a chunk for an
// uncompressed one.
static exr_result_t compress(exr_encode_pipeline_t *pipe)
{
    compressor *const *own = pipe->encoding_user_data;
    const exr_result_t rv = (*own)(pipe);
    if (!rv && pipe->compressed_bytes == pipe->packed_bytes)
        memcpy(pipe->compressed_buffer, pipe->packed_buffer, (size_t)pipe->packed_bytes);
    return rv;
}

// own: Core's compressor, kept from the first chunk on.
static exr_result_t write_chunk(exr_context_t core, const struct hf_exr_new *picture, int y,
                                exr_encode_pipeline_t *pipe, compressor **own)
{
    exr_chunk_info_t info = {0};
    const bool first = !pipe->context;
    exr_result_t rv = exr_write_scanline_chunk_info(core, 0, picture->data_window.y0 + y, &info);
    if (!rv)
        rv = first ? exr_encoding_initialize(core, 0, &info, pipe) : exr_encoding_update(core, 0, &info, pipe);
    for (int c = 0; c < pipe->channel_count && !rv; c++) {
        exr_coding_channel_info_t *ch = &pipe->channels[c];
        const float *plane = plane_of(picture, ch->channel_name);
        ch->encode_from_ptr = plane ? (const uint8_t *)(plane + (ptrdiff_t)y * picture->stride) : NULL;
        ch->user_bytes_per_element = sizeof(float);
        ch->user_data_type = EXR_PIXEL_FLOAT;
        ch->user_pixel_stride = sizeof(float);
        ch->user_line_stride = (int32_t)(picture->stride * (ptrdiff_t)sizeof(float));
    }
    if (!rv && first)
        rv = exr_encoding_choose_default_routines(core, 0, pipe);
    if (!rv && first && pipe->compress_fn) {
        *own = pipe->compress_fn;
        pipe->encoding_user_data = own;
        pipe->compress_fn = compress;
    }
    return rv ? rv : exr_encoding_run(core, 0, pipe);
}

static exr_result_t write_chunks(exr_context_t core, const struct hf_exr_new *picture)
{
    exr_encode_pipeline_t pipe = EXR_ENCODE_PIPELINE_INITIALIZER;
    compressor *own = NULL;
    const int height = picture->data_window.y1 - picture->data_window.y0;
    const int lines = hf_exr_compression_lines(picture->compression);
    exr_result_t rv = EXR_ERR_SUCCESS;
    for (int y = 0; y < height && !rv; y += lines)
        rv = write_chunk(core, picture, y, &pipe, &own);
    if (pipe.context)
        exr_encoding_destroy(core, &pipe);
    return rv;
}

static int check_new(const char *path, const struct hf_exr_new *picture, struct hf_io_error *err)
{
    if (hf_io_check_window(path, "data window", picture->data_window, err) ||
        hf_io_check_window(path, "display window", picture->display_window, err))
        return -1;
    if (picture->channel_count < 1 || picture->stride > INT32_MAX / 8 || picture->stride < -INT32_MAX / 8)
        return hf_io_fail(err, "%s: cannot write %d channels with rows %td floats apart", path, picture->channel_count,
                          picture->stride);
    for (int c = 0; c < picture->channel_count; c++)
        for (int i = 0; i < c; i++)
            if (!strcmp(picture->names[c], picture->names[i]))
                return hf_io_fail(err, "%s: cannot write two channels named %s", path, picture->names[c]);
    return 0;
}

int hf_exr_make_new(struct hf_io_bytes *made, const char *path, const struct hf_exr_new *picture,
                    struct hf_io_error *err)
{
    struct new_file n = {.room = 0};
    exr_context_initializer_t init;
    exr_context_t core = NULL;
    *made = n.bytes;
    if (check_new(path, picture, err))
        return -1;
    hf_exr_quiet();
    hf_exr_context_init(&n, &init);
    init.write_fn = write_out;
    init.zip_level = !picture->zip_level ? 4 : picture->zip_level < 9 ? picture->zip_level : 9;  // zlib's
    exr_result_t rv = exr_start_write(&core, path, EXR_WRITE_FILE_DIRECTLY, &init);
    if (!rv)
        rv = describe(core, picture);
    if (!rv)
        rv = write_chunks(core, picture);
    const exr_result_t end = core ? exr_finish(&core) : EXR_ERR_SUCCESS;  // writes the chunk table
    rv = rv ? rv : end;
    if (rv) {
        free(n.bytes.data);
        return hf_io_fail(err, "%s: cannot write: %s", path, hf_exr_said(rv));
    }
    const size_t sum_at = picture->text_count ? hf_exr_find_sum(n.bytes.data, n.bytes.size) : 0;
    uint32_t sum = 0;
    if (sum_at) {
        hf_exr_add_to_sum(&sum, n.bytes.data, n.bytes.size);
        hf_exr_put_sum(n.bytes.data + sum_at, sum);
    }
    *made = n.bytes;
    return 0;
}
