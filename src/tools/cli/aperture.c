// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/aperture.h"

#include <stdlib.h>

#include "tools/io/io.h"

enum { MAX_SIDE = 4096 };  // pixels; no sprite is drawn with more detail

static int read_file(struct cli_aperture *a, struct hf_io_file *file, const char *path, struct tool_error *error)
{
    struct hf_io_error io;
    const struct hf_io_view *v = hf_io_view(file, 0);
    if (v->width > MAX_SIDE || v->height > MAX_SIDE)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "--aperture %s: %d x %d pixels are more than %d a side", path,
                         v->width, v->height, MAX_SIDE);
    const size_t n = (size_t)v->width * (size_t)v->height;
    a->samples = malloc(3 * n * sizeof *a->samples);
    if (!a->samples)
        return tool_fail(error, CLI_ALL_FAILED, "--aperture %s: out of memory", path);
    float *planes[4] = {a->samples, a->samples + n, a->samples + 2 * n, NULL};
    if (hf_io_read_colour(file, 0, planes, &io))
        return tool_fail(error, CLI_BAD_ARGUMENTS, "--aperture: %s", io.message);
    float brightest = 0;
    for (size_t i = 0; i < 3 * n; i++)
        brightest = a->samples[i] > brightest ? a->samples[i] : brightest;
    if (brightest <= 0)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "--aperture %s: the picture is black, it lets no light through",
                         path);
    a->image = (struct hf_image){
        .size = sizeof(struct hf_image), .width = v->width, .height = v->height, .format = HF_FORMAT_PLANAR32F};
    for (int c = 0; c < 3; c++) {
        a->image.data[c] = planes[c];
        a->image.stride[c] = (ptrdiff_t)v->width * (ptrdiff_t)sizeof(float);
    }
    return 0;
}

int cli_aperture_load(struct cli_aperture *a, struct cli_args *args, struct tool_error *error)
{
    struct hf_io_error io;
    struct hf_io_file *file;
    *a = (struct cli_aperture){0};
    if (!args->aperture_file)
        return 0;
    if (hf_io_open(&file, args->aperture_file, NULL, &io))
        return tool_fail(error, CLI_BAD_ARGUMENTS, "--aperture: %s", io.message);
    const int status = read_file(a, file, args->aperture_file, error);
    hf_io_close(&file);
    args->params.aperture.picture = &a->image;
    return status;
}

void cli_aperture_free(struct cli_aperture *a)
{
    free(a->samples);
    *a = (struct cli_aperture){0};
}
