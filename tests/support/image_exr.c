// SPDX-License-Identifier: BSD-3-Clause
#include <stdio.h>
#include <string.h>

#include <OpenEXR/openexr.h>

#include "support/image.h"

static void quiet(exr_const_context_t c, exr_result_t code, const char *message)
{
    (void)c;
    (void)code;
    fprintf(stderr, "exr: %s\n", message);
}

// Point the decoder's channels to the rows of a chunk; other channels are not decoded.
static void aim(exr_decode_pipeline_t *decoder, struct picture *out, int row, const char *const names[])
{
    for (int i = 0; i < decoder->channel_count; i++) {
        exr_coding_channel_info_t *channel = &decoder->channels[i];
        channel->decode_to_ptr = NULL;
        for (int c = 0; c < out->channels; c++) {
            if (strcmp(channel->channel_name, names[c]) != 0)
                continue;
            channel->decode_to_ptr = (uint8_t *)(out->plane[c] + (ptrdiff_t)row * out->width);
            channel->user_bytes_per_element = 4;
            channel->user_data_type = EXR_PIXEL_FLOAT;
            channel->user_pixel_stride = 4;
            channel->user_line_stride = out->width * 4;
        }
    }
}

static int read_chunks(exr_context_t file, struct picture *out, int top, const char *const names[])
{
    int32_t step;
    if (exr_get_scanlines_per_chunk(file, 0, &step) != EXR_ERR_SUCCESS)
        return -1;
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    int bad = 0;
    for (int y = 0; y < out->height && !bad; y += step) {
        exr_chunk_info_t chunk;
        bad = exr_read_scanline_chunk_info(file, 0, top + y, &chunk) != EXR_ERR_SUCCESS;
        if (!bad && y == 0)
            bad = exr_decoding_initialize(file, 0, &chunk, &decoder) != EXR_ERR_SUCCESS;
        else if (!bad)
            bad = exr_decoding_update(file, 0, &chunk, &decoder) != EXR_ERR_SUCCESS;
        if (bad)
            break;
        aim(&decoder, out, y, names);
        if (y == 0)
            bad = exr_decoding_choose_default_routines(file, 0, &decoder) != EXR_ERR_SUCCESS;
        bad = bad || exr_decoding_run(file, 0, &decoder) != EXR_ERR_SUCCESS;
    }
    exr_decoding_destroy(file, &decoder);
    return bad ? -1 : 0;
}

int exr_read(struct picture *out, const char *path, int channels, const char *const names[])
{
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = quiet;
    exr_context_t file;
    *out = (struct picture){0};
    if (exr_start_read(&file, path, &setup) != EXR_ERR_SUCCESS)
        return -1;
    exr_attr_box2i_t window;
    int bad = exr_get_data_window(file, 0, &window) != EXR_ERR_SUCCESS;
    if (!bad) {
        *out = picture_new(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, channels);
        bad = read_chunks(file, out, window.min.y, names) != 0;
    }
    exr_finish(&file);
    if (bad)
        picture_free(out);
    return bad ? -1 : 0;
}
