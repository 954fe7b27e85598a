// SPDX-License-Identifier: BSD-3-Clause
// hf_io_encode: an EXR made from an EXR is a copy with new colours; any other output is a new picture of one view.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "tools/io/exr/exr.h"
#include "tools/io/file.h"
#include "tools/io/oiio/oiio.h"
#include "tools/io/out.h"

// The planes of one view as they will be written: the given ones, else the file's own.
struct picture {
    const float *planes[5];  // and what was guessed, or NULL
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
    pic->planes[4] = r->guessed;
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

// Make an EXR with colours, and perhaps what was guessed.
static int make_exr(struct hf_io_bytes *made, const struct hf_io_job *job, const struct hf_io_view *v,
                    const float *const planes[5], int compression, struct hf_io_error *err)
{
    static const char *const all_names[5] = {"R", "G", "B", "A", "guessed"};
    const char *names[5];
    const float *used[5];
    int count = 0;
    for (int c = 0; c < 5; c++)
        if (planes[c]) {
            names[count] = all_names[c];
            used[count++] = planes[c];
        }
    const struct hf_exr_new picture = {
        .data_window = v->data_window,
        .display_window = v->display_window,
        .pixel_aspect = v->pixel_aspect,
        .screen_center_x = v->screen_center_x,
        .screen_center_y = v->screen_center_y,
        .screen_width = v->screen_width,
        .compression = compression < 0 ? EXR_COMPRESSION_ZIP : (exr_compression_t)compression,
        .channel_count = count,
        .names = names,
        .planes = used,
        .stride = v->width,
        .zip_level = job->zip_level,
        .texts = job->texts,
        .text_count = job->text_count,
    };
    return hf_exr_make_new(made, job->path, &picture, err);
}

static int make_by_oiio(struct hf_io_bytes *made, const struct hf_io_file *file, const struct hf_io_job *job,
                        const struct hf_io_view *v, const struct picture *pic, struct hf_io_written *written,
                        struct hf_io_error *err)
{
    struct hf_oiio_picture picture = {.path = job->path,
                                      .view = v,
                                      .planes = {pic->planes[0], pic->planes[1], pic->planes[2], pic->planes[3]},
                                      .bits = file->oiio ? hf_oiio_bits(file->oiio) : 0,
                                      .compression = job->compression,
                                      .source = file->oiio ? file->path : NULL};
    if (!hf_oiio_write(made, &picture, err))
        return 0;
    if (!picture.source)
        return -1;
    // A damaged colour profile, or one that the format rejects, is no reason to lose the picture.
    const struct hf_io_error first = *err;
    picture.source = NULL;
    if (hf_oiio_write(made, &picture, err))
        return -1;
    snprintf(written->note, sizeof(written->note),
             "%s: camera, colour profile and texts of %.200s are not kept; with them: %.200s", job->path, file->path,
             first.message);
    return 0;
}

// Make a picture with nothing but the colours of one view.
static int make_view(struct hf_io_bytes *made, struct hf_io_file *file, const struct hf_io_job *job, int compression,
                     struct hf_io_written *written, struct hf_io_error *err)
{
    struct picture pic;
    if (job->result_count != 1)
        return hf_io_fail(err, "%s: only EXR files hold several views, and there are %d to write", job->path,
                          job->result_count);
    const struct hf_io_view *v = &file->views.view[job->results[0].view];
    int status = load_picture(file, &job->results[0], &pic, err);
    if (!status && hf_io_is_exr_name(job->path) && !(compression >= 0 && hf_exr_is_dwa(compression)))
        status = make_exr(made, job, v, pic.planes, compression, err);
    else if (!status)
        status = make_by_oiio(made, file, job, v, &pic, written, err);
    free_picture(&pic);
    return status;
}

// Exactly one of the two members is set.
struct hf_io_output {
    char *path;
    bool unsynced;
    struct hf_exr_made *exr;
    struct hf_io_bytes bytes;
};

void hf_io_output_free(struct hf_io_output **out)
{
    if (!*out)
        return;
    hf_exr_free_file((*out)->exr);
    free((*out)->bytes.data);
    free((*out)->path);
    free(*out);
    *out = NULL;
}

static bool one_of(const char *extension, const char *const *list)
{
    for (; *list; list++)
        if (!strcasecmp(extension, *list))
            return true;
    return false;
}

// Note what a photograph's header says and the new file has no place for.
static void note_lost(const struct hf_io_file *file, const struct hf_io_job *job, struct hf_io_written *written)
{
    static const char *const turned[] = {"jpg", "jpeg", "jpe", "tif", "tiff", NULL};
    static const char *const profiled[] = {"jpg", "jpeg", "jpe", "tif", "tiff", "png", NULL};
    const struct hf_io_view *v = &file->views.view[job->results[0].view];
    const char *extension = hf_io_extension(job->path);
    const bool orientation = v->orientation > 1 && !one_of(extension, turned);
    const bool profile = v->profile && !one_of(extension, profiled);
    if (!orientation && !profile)
        return;
    snprintf(written->note, sizeof(written->note),
             "%s: %s%s%s of %.300s %s not kept, for which such a file has no place%s", job->path,
             orientation ? "the orientation" : "", orientation && profile ? " and " : "",
             profile ? "the colour profile" : "", file->path, orientation && profile ? "are" : "is",
             orientation ? "; the pixels lie as in there" : "");
}

static int check_job(const struct hf_io_file *file, const struct hf_io_job *job, struct hf_io_error *err)
{
    if (hf_out_check(job->path, err))
        return -1;
    for (int i = 0; i < job->result_count; i++)
        if (!hf_io_view(file, job->results[i].view))
            return hf_io_fail(err, "%s: there is no view number %d", file->path, job->results[i].view);
    if (job->compression && hf_exr_compression(job->compression) < 0 && hf_io_is_exr_name(job->path))
        return hf_io_fail(err, "%s: unknown compression %s", job->path, job->compression);
    return 0;
}

// Give the file the channels guessed that it does not have.
static int add_guessed(struct hf_io_file *file, const struct hf_io_job *job, struct hf_io_error *err)
{
    int status = 0;
    for (int i = 0; i < job->result_count && !status; i++) {
        const struct hf_io_view *v = &file->views.view[job->results[i].view];
        char name[256];
        hf_io_guessed_name(v, name);
        if (job->results[i].guessed)
            status = hf_exr_add_channel(file->exr, v->part, name, job->run, err);
    }
    return status;
}

int hf_io_encode(struct hf_io_output **result, struct hf_io_file *file, const struct hf_io_job *job,
                 struct hf_io_written *written, struct hf_io_error *err)
{
    struct hf_io_written ignored;
    *result = NULL;
    if (!written)
        written = &ignored;
    memset(written, 0, sizeof(*written));
    if (check_job(file, job, err))
        return -1;
    struct hf_io_output *o = calloc(1, sizeof(*o));
    if (o)
        o->path = strdup(job->path);
    if (!o || !o->path) {
        hf_io_output_free(&o);
        return hf_io_fail(err, "%s: out of memory", job->path);
    }
    const int compression = job->compression ? hf_exr_compression(job->compression) : -1;
    const struct hf_exr_job exr = {&file->views,   job->results, job->result_count, compression,
                                   job->zip_level, job->texts,   job->text_count};
    o->unsynced = job->unsynced;
    // Deep samples are not written again.
    const bool copies = file->exr && hf_io_is_exr_name(job->path) && !file->views.view[0].deep;
    int status = copies ? add_guessed(file, job, err) : 0;
    if (!status)
        status = copies ? hf_exr_encode_file(&o->exr, file->exr, &exr, job->run, written, err)
                        : make_view(&o->bytes, file, job, compression, written, err);
    if (status)
        hf_io_output_free(&o);
    else if (file->oiio && !written->note[0])
        note_lost(file, job, written);
    *result = o;
    return status;
}

static int save(const char *path, bool unsynced, const struct hf_exr_made *exr, const struct hf_io_bytes *bytes,
                struct hf_io_written *written, struct hf_io_error *err)
{
    struct hf_out out;
    int status = hf_out_open(&out, path, err);
    out.unsynced = unsynced;
    if (!status)
        status = exr ? hf_exr_put_file(exr, &out, err) : hf_out_write(&out, bytes->data, bytes->size, err);
    if (!status)
        status = hf_out_commit(&out, err);
    if (written && out.note[0])
        memcpy(written->note, out.note, sizeof(written->note));
    hf_out_abort(&out);
    return status;
}

int hf_io_save(struct hf_io_output *out, struct hf_io_written *written, struct hf_io_error *err)
{
    return save(out->path, out->unsynced, out->exr, &out->bytes, written, err);
}

int hf_io_write(struct hf_io_file *file, const struct hf_io_job *job, struct hf_io_written *written,
                struct hf_io_error *err)
{
    struct hf_io_output *out;
    int status = hf_io_encode(&out, file, job, written, err);
    if (!status)
        status = hf_io_save(out, written, err);
    hf_io_output_free(&out);
    return status;
}

int hf_io_write_planes(const char *path, const struct hf_io_planes *planes, struct hf_io_error *err)
{
    const struct hf_exr_new picture = {
        .data_window = {0, 0, planes->width, planes->height},
        .display_window = {0, 0, planes->width, planes->height},
        .pixel_aspect = 1,
        .screen_width = 1,
        .compression = EXR_COMPRESSION_ZIP,
        .channel_count = planes->channels,
        .names = planes->names,
        .planes = planes->data,
        .stride = planes->stride,
    };
    struct hf_io_bytes made;
    int status = hf_exr_make_new(&made, path, &picture, err);
    if (!status)
        status = save(path, false, NULL, &made, NULL, err);
    free(made.data);
    return status;
}
