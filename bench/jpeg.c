// SPDX-License-Identifier: BSD-3-Clause
#include "jpeg.h"

#if HF_HAVE_JPEG
#include "metrics.h"

#include <setjmp.h>
#include <stdlib.h>

#include <jpeglib.h>

enum { QUALITY = 82 };

struct failing {
    struct jpeg_error_mgr base;  // first, because libjpeg hands back a pointer to it
    jmp_buf jump;
};

// libjpeg's own handler would print and exit.
static void give_up(j_common_ptr info)
{
    longjmp(((struct failing *)info->err)->jump, 1);
}

static void encode(struct jpeg_compress_struct *c, const float *rgb, int picture_width, int x, int y,
                   unsigned char *row)
{
    c->input_components = 3;
    c->in_color_space = JCS_RGB;
    jpeg_set_defaults(c);
    jpeg_set_quality(c, QUALITY, TRUE);
    jpeg_start_compress(c, TRUE);
    while (c->next_scanline < c->image_height) {
        const float *from = rgb + 3 * ((size_t)(y + (int)c->next_scanline) * (size_t)picture_width + (size_t)x);
        for (size_t i = 0; i < 3 * (size_t)c->image_width; i++)
            row[i] = (unsigned char)(255 * bench_display(from[i]) + 0.5f);
        jpeg_write_scanlines(c, &row, 1);
    }
    jpeg_finish_compress(c);
}

static void base64(FILE *out, const unsigned char *data, size_t n)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < n; i += 3) {
        const unsigned v = data[i] << 16 | (i + 1 < n ? data[i + 1] << 8 : 0) | (i + 2 < n ? data[i + 2] : 0);
        fputc(digits[v >> 18], out);
        fputc(digits[v >> 12 & 63], out);
        fputc(i + 1 < n ? digits[v >> 6 & 63] : '=', out);
        fputc(i + 2 < n ? digits[v & 63] : '=', out);
    }
}

int bench_jpeg_available(void)
{
    return 1;
}

int bench_jpeg_uri(FILE *out, const float *rgb, int picture_width, int x, int y, int width, int height)
{
    struct jpeg_compress_struct c;
    struct failing error;
    unsigned char *data = NULL, *row = malloc(3 * (size_t)width);
    unsigned long size = 0;
    volatile int result = -1;
    if (!row)
        return -1;
    c.err = jpeg_std_error(&error.base);
    error.base.error_exit = give_up;
    if (!setjmp(error.jump)) {
        jpeg_create_compress(&c);
        jpeg_mem_dest(&c, &data, &size);
        c.image_width = (JDIMENSION)width;
        c.image_height = (JDIMENSION)height;
        encode(&c, rgb, picture_width, x, y, row);
        fputs("data:image/jpeg;base64,", out);
        base64(out, data, size);
        result = 0;
    }
    jpeg_destroy_compress(&c);
    free(data);
    free(row);
    return result;
}

#else

int bench_jpeg_available(void)
{
    return 0;
}

int bench_jpeg_uri(FILE *out, const float *rgb, int picture_width, int x, int y, int width, int height)
{
    (void)out;
    (void)rgb;
    (void)picture_width;
    (void)x;
    (void)y;
    (void)width;
    (void)height;
    return -1;
}

#endif
