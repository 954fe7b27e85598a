// SPDX-License-Identifier: BSD-3-Clause
// hf_io_write: an EXR made from an EXR is a copy with new colours; anything else is a new picture of one view.
#include <stdlib.h>
#include <string.h>

#include "io/exr/exr.h"
#include "io/file.h"
#include "io/oiio/oiio.h"
#include "io/out.h"

// The planes of one view as they will be: the given ones, and the file's own where none is given.
struct picture {
    const float *planes[4];
    float *own[4];
};

static void free_picture(struct picture *pic)
{
    for (int k = 0; k < 4; k++)
        free(pic->own[k]);
}

static int load_picture(struct hf_io_file *file, const struct hf_io_result *r, struct picture *pic,
                        struct hf_io_error *err)
{
    const struct hf_io_view *v = &file->views.view[r->view];
    bool missing = false;
    memset(pic, 0, sizeof(*pic));
    for (int k = 0; k < 4; k++) {
        pic->planes[k] = v->colour[k][0] ? r->planes[k] : NULL;
        if (!v->colour[k][0] || pic->planes[k])
            continue;
        pic->own[k] = calloc((size_t)v->width * (size_t)v->height, sizeof(float));
        if (!pic->own[k])
            return hf_io_fail(err, "%s: out of memory", file->path);
        pic->planes[k] = pic->own[k];
        missing = true;
    }
    return missing ? hf_io_read_colour(file, r->view, pic->own, err) : 0;
}

static int write_new_exr(const char *path, const struct hf_io_view *v, const float *const planes[4], int compression,
                         struct hf_io_error *err)
{
    static const char *const names[4] = {"R", "G", "B", "A"};
    const struct hf_exr_new picture = {
        .data_window = v->data_window,
        .display_window = v->display_window,
        .pixel_aspect = v->pixel_aspect,
        .screen_center_x = v->screen_center_x,
        .screen_center_y = v->screen_center_y,
        .screen_width = v->screen_width,
        .compression = compression < 0 ? EXR_COMPRESSION_ZIP : (exr_compression_t)compression,
        .channel_count = planes[3] ? 4 : 3,
        .names = names,
        .planes = planes,
        .stride = v->width,
    };
    return hf_exr_write_new(path, &picture, err);
}

static int write_by_oiio(const struct hf_oiio *source, const char *path, const struct hf_io_view *v,
                         const float *const planes[4], const char *compression, struct hf_io_error *err)
{
    struct hf_out out;
    int status = hf_out_open(&out, path, err);
    if (!status)
        status = hf_oiio_write(&out, source, v, planes, compression, err);
    if (!status)
        status = hf_out_commit(&out, err);
    hf_out_abort(&out);
    return status;
}

// A picture with nothing but the colours of one view.
static int write_view(struct hf_io_file *file, const char *path, const struct hf_io_result *results, int n_results,
                      const char *compression, int exr_compression, struct hf_io_error *err)
{
    struct picture pic;
    if (n_results != 1)
        return hf_io_fail(err, "%s: only EXR files hold several views, and there are %d to write", path, n_results);
    const struct hf_io_view *v = &file->views.view[results[0].view];
    int status = load_picture(file, &results[0], &pic, err);
    if (!status && hf_io_is_exr_name(path) && !(exr_compression >= 0 && hf_exr_is_dwa(exr_compression)))
        status = write_new_exr(path, v, pic.planes, exr_compression, err);
    else if (!status)
        status = write_by_oiio(file->oiio, path, v, pic.planes, compression, err);
    free_picture(&pic);
    return status;
}

int hf_io_write(struct hf_io_file *file, const char *path, const struct hf_io_result *results, int n_results,
                const struct hf_io_write_options *options, uint64_t *clamped, struct hf_io_error *err)
{
    const char *compression = options ? options->compression : NULL;
    const int exr_compression = compression ? hf_exr_compression(compression) : -1;
    uint64_t ignored;
    if (!clamped)
        clamped = &ignored;
    *clamped = 0;
    for (int i = 0; i < n_results; i++)
        if (!hf_io_view(file, results[i].view))
            return hf_io_fail(err, "%s: there is no view number %d", file->path, results[i].view);
    if (compression && exr_compression < 0 && hf_io_is_exr_name(path))
        return hf_io_fail(err, "%s: unknown compression %s", path, compression);
    const struct hf_exr_job job = {&file->views, results, n_results, exr_compression};
    if (file->exr && hf_io_is_exr_name(path))
        return hf_exr_write(file->exr, path, &job, clamped, err);
    return write_view(file, path, results, n_results, compression, exr_compression, err);
}
