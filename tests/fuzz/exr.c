// SPDX-License-Identifier: BSD-3-Clause
// The reader of picture files on bytes that claim to be an EXR: headers, every view's colour and depth, and a copy in
// memory. Files that claim more than a few million pixels are only opened.
#include <string.h>
#include <unistd.h>

#include "fuzz/fuzz.h"
#include "tools/io/io.h"

static const unsigned char magic[4] = {0x76, 0x2f, 0x31, 0x01};

static void read_view(struct hf_io_file *file, int v)
{
    const struct hf_io_view *view = hf_io_view(file, v);
    struct hf_io_error err = {.message = ""};
    MUST(view->width > 0 && view->height > 0);
    const size_t n = (size_t)view->width * (size_t)view->height;
    if (n > 1u << 21)
        return;
    float *planes[4], *depth = calloc(n, sizeof *depth);
    for (int c = 0; c < 4; c++) {
        planes[c] = calloc(n, sizeof *planes[c]);
        MUST(planes[c] != NULL);
    }
    MUST(depth != NULL);
    const int colour = hf_io_read_colour(file, v, planes, &err);
    MUST(colour == 0 || (colour == -1 && err.message[0]));
    err.message[0] = 0;
    const int z = hf_io_read_depth(file, v, depth, &err);
    MUST(z == 0 || (z == -1 && err.message[0]));
    if (!colour) {
        const struct hf_io_result result = {.view = v, .planes = {planes[0], planes[1], planes[2], planes[3]}};
        const struct hf_io_job job = {.path = "fuzz.exr", .results = &result, .result_count = 1};
        struct hf_io_output *out = NULL;
        struct hf_io_written written;
        const int made = hf_io_encode(&out, file, &job, &written, &err);
        MUST(made == 0 || (made == -1 && err.message[0]));
        hf_io_output_free(&out);
    }
    for (int c = 0; c < 4; c++)
        free(planes[c]);
    free(depth);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char path[64];
    if (!path[0])
        snprintf(path, sizeof path, "/tmp/hyperfocal-fuzz-%ld.exr", (long)getpid());
    // Other formats are left to OpenImageIO.
    if (size < 4 || memcmp(data, magic, 4))
        return 0;
    FILE *f = fopen(path, "wb");
    MUST(f != NULL);
    MUST(fwrite(data, 1, size, f) == size);
    fclose(f);
    struct hf_io_file *file = NULL;
    struct hf_io_error err = {.message = ""};
    const int opened = hf_io_open(&file, path, NULL, &err);
    MUST(opened == 0 || (opened == -1 && err.message[0] && !file));
    if (!opened) {
        char text[200];
        hf_io_channels(file, text, sizeof text);
        hf_io_text(file, "comments", text, sizeof text);
        for (int v = 0; v < hf_io_view_count(file) && v < 4; v++)
            read_view(file, v);
        hf_io_close(&file);
    }
    remove(path);
    return 0;
}
