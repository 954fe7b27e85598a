// SPDX-License-Identifier: BSD-3-Clause
// Opening files and choosing who handles them.
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/exr/chunks.h"
#include "io/file.h"
#include "io/oiio/oiio.h"

static const struct hf_exr_codec dwa = {hf_oiio_read_samples, hf_oiio_write_samples};

// EXR files are known by their first bytes, whatever they are called.
static int open_fd(const char *path, bool *exr, struct hf_io_error *err)
{
    static const unsigned char magic[4] = {0x76, 0x2f, 0x31, 0x01};
    unsigned char first[4] = {0};
    struct stat st;
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0 || fstat(fd, &st)) {
        hf_io_fail(err, "%s: cannot open: %s", path, strerror(errno));
    } else if (!S_ISREG(st.st_mode)) {
        hf_io_fail(err, "%s: cannot open: not a regular file", path);
    } else if (st.st_size == 0) {
        hf_io_fail(err, "%s: the file is empty", path);
    } else {
        *exr = pread(fd, first, sizeof(first), 0) == sizeof(first) && !memcmp(first, magic, sizeof(magic));
        if (*exr || !hf_io_is_exr_name(path))
            return fd;
        hf_io_fail(err, "%s: truncated or corrupt: not an EXR file", path);
    }
    if (fd >= 0)
        close(fd);
    return -1;
}

int hf_io_open_any(struct hf_io_file **out, const char *path, const char *depth_channel, struct hf_io_error *err)
{
    bool exr;
    *out = NULL;
    const int fd = open_fd(path, &exr, err);
    if (fd < 0)
        return -1;
    struct hf_io_file *file = calloc(1, sizeof(*file));
    if (file)
        file->path = strdup(path);
    if (!file || !file->path) {
        free(file);
        close(fd);
        return hf_io_fail(err, "%s: out of memory", path);
    }
    int status;
    if (exr) {
        status = hf_exr_open(&file->exr, file->path, fd, &dwa, err);
        if (!status)
            status = hf_exr_find_views(file->exr, &file->views, depth_channel, err);
    } else {
        close(fd);
        status = hf_oiio_open(&file->oiio, file->path, depth_channel, &file->views, err);
    }
    if (status)
        hf_io_close(&file);
    *out = file;
    return status;
}

int hf_io_open(struct hf_io_file **out, const char *path, const char *depth_channel, struct hf_io_error *err)
{
    char names[300] = "";
    if (hf_io_open_any(out, path, depth_channel, err))
        return -1;
    if ((*out)->views.count)
        return 0;
    const bool deep = (*out)->exr && hf_exr_is_deep(&(*out)->exr->parts[0]);
    hf_io_channels(*out, names, sizeof(names));
    hf_io_close(out);
    if (deep)
        return hf_io_fail(
            err, "%s: a deep picture (several samples per pixel), which is not supported: flatten it first", path);
    return hf_io_fail(err, "%s: no colour channels (R, G, B or Y) among: %s", path, names);
}

void hf_io_close(struct hf_io_file **file)
{
    if (!file || !*file)
        return;
    hf_exr_close((*file)->exr);
    hf_oiio_close((*file)->oiio);
    free((*file)->views.view);
    free((*file)->path);
    free(*file);
    *file = NULL;
}

int hf_io_view_count(const struct hf_io_file *file)
{
    return file->views.count;
}

const struct hf_io_view *hf_io_view(const struct hf_io_file *file, int view)
{
    return view >= 0 && view < file->views.count ? &file->views.view[view] : NULL;
}

const char *hf_io_text(const struct hf_io_file *file, const char *name, char *buf, size_t size)
{
    const char *text = "";
    int32_t length = 0;
    if (!file->exr || exr_attr_get_string(file->exr->core, 0, name, &length, &text) != EXR_ERR_SUCCESS || !text)
        length = 0;
    snprintf(buf, size, "%.*s", (int)length, text);
    return buf;
}

int hf_io_check_whole(const struct hf_io_file *file, struct hf_io_error *err)
{
    if (!file->exr)
        return hf_io_fail(err, "%s: not an EXR file", file->path);
    for (int p = 0; p < file->exr->part_count; p++)
        if (hf_exr_check_chunks(file->exr, p, err))
            return -1;
    return 0;
}

void hf_io_channels(const struct hf_io_file *file, char *buf, size_t size)
{
    if (!size)
        return;
    buf[0] = 0;
    if (file->exr)
        hf_exr_channels(file->exr, buf, size);
    else
        hf_oiio_channels(file->oiio, buf, size);
}

static int check_view(const struct hf_io_file *file, int view, struct hf_io_error *err)
{
    if (view < 0 || view >= file->views.count)
        return hf_io_fail(err, "%s: there is no view number %d", file->path, view);
    return 0;
}

static int read_colour(struct hf_io_file *file, int view, float *const planes[4], struct hf_io_error *err)
{
    return file->exr ? hf_exr_read_colour(file->exr, &file->views.view[view], planes, err)
                     : hf_oiio_read_colour(file->oiio, planes, err);
}

static int read_depth(struct hf_io_file *file, int view, float *depth, struct hf_io_error *err)
{
    char names[300];
    const struct hf_io_view *v = &file->views.view[view];
    if (v->depth_part < 0) {
        hf_io_channels(file, names, sizeof(names));
        return hf_io_fail(err, "%s: no depth channel among: %s", file->path, names);
    }
    if (!file->exr)
        return hf_oiio_read_depth(file->oiio, depth, err);
    const int c = hf_exr_find_channel(&file->exr->parts[v->depth_part], v->depth);
    return hf_exr_read_depth(file->exr, v->depth_part, c, v->data_window, depth, err);
}

int hf_io_fetch(struct hf_io_file *file, const struct hf_io_want *wants, int count, struct hf_io_error *err)
{
    for (int i = 0; i < count; i++)
        if (check_view(file, wants[i].view, err))
            return -1;
    return 0;
}

int hf_io_decode(struct hf_io_file *file, const struct hf_io_want *wants, int count, const struct hf_io_run *run,
                 struct hf_io_error *err)
{
    (void)run;
    for (int i = 0; i < count; i++) {
        const struct hf_io_want *w = &wants[i];
        if (check_view(file, w->view, err) || (w->depth && read_depth(file, w->view, w->depth, err)) ||
            ((w->planes[0] || w->planes[1] || w->planes[2] || w->planes[3]) &&
             read_colour(file, w->view, w->planes, err)))
            return -1;
    }
    return 0;
}

int hf_io_read_colour(struct hf_io_file *file, int view, float *planes[4], struct hf_io_error *err)
{
    const struct hf_io_want want = {.view = view, .planes = {planes[0], planes[1], planes[2], planes[3]}};
    return hf_io_decode(file, &want, 1, NULL, err);
}

int hf_io_read_depth(struct hf_io_file *file, int view, float *depth, struct hf_io_error *err)
{
    const struct hf_io_want want = {.view = view, .depth = depth};
    return hf_io_decode(file, &want, 1, NULL, err);
}

static int exr_depth_only(struct hf_io_file *file, const char *depth_channel, const struct hf_io_view *view,
                          float *depth, struct hf_io_error *err)
{
    char names[300];
    int c;
    const int p = hf_exr_find_depth_only(file->exr, depth_channel, view->name, &c);
    if (p < 0) {
        hf_io_channels(file, names, sizeof(names));
        return hf_io_fail(err, "%s: no depth channel%s%s among: %s", file->path, depth_channel ? " " : "",
                          depth_channel ? depth_channel : "", names);
    }
    const struct hf_exr_part *part = &file->exr->parts[p];
    if (hf_exr_check_part(file->exr, p, err))
        return -1;
    if (part->channels[c].x_sampling != 1 || part->channels[c].y_sampling != 1)
        return hf_io_fail(err, "%s: channel %s is subsampled, which is not supported", file->path,
                          part->channels[c].name);
    if (part->width != view->width || part->height != view->height)
        return hf_io_fail(err, "%s: %d x %d pixels of depth for a picture of %d x %d", file->path, part->width,
                          part->height, view->width, view->height);
    const struct hf_io_box own = {part->window.min.x, part->window.min.y, part->window.max.x + 1,
                                  part->window.max.y + 1};
    return hf_exr_read_depth(file->exr, p, c, own, depth, err);
}

int hf_io_read_depth_file(const char *path, const char *depth_channel, const struct hf_io_view *view, float *depth,
                          struct hf_io_error *err)
{
    struct hf_io_file *file;
    if (hf_io_open_any(&file, path, NULL, err))
        return -1;
    const int status = file->exr ? exr_depth_only(file, depth_channel, view, depth, err)
                                 : hf_oiio_read_depth_only(file->oiio, depth_channel, view, depth, err);
    hf_io_close(&file);
    return status;
}

int hf_io_check_format(const char *path, struct hf_io_error *err)
{
    return hf_io_is_exr_name(path) ? 0 : hf_oiio_check_format(path, err);
}

int hf_io_same_file(const char *a, const char *b)
{
    struct stat x, y;
    const bool there = !stat(a, &x);
    if (there != !stat(b, &y))
        return 0;
    if (there)
        return x.st_dev == y.st_dev && x.st_ino == y.st_ino;
    char *p = hf_out_resolve(a), *q = hf_out_resolve(b);
    const int same = p && q && !strcmp(p, q);
    free(p);
    free(q);
    return same;
}

void hf_io_remove_temporaries(void)
{
    hf_out_remove_all();
}

void hf_io_catch_signals(void)
{
    hf_out_catch_signals();
}

int hf_io_has_oiio(void)
{
    return hf_oiio_available();
}
