// SPDX-License-Identifier: BSD-3-Clause
// Opens files, and chooses what handles them.
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/io/exr/chunks.h"
#include "tools/io/file.h"
#include "tools/io/oiio/oiio.h"
#include "tools/io/temp.h"

static const struct hf_exr_codec dwa = {hf_oiio_read_samples, hf_oiio_write_samples};

// What kind of file it is if it is no EXR, from its first bytes; NULL: unknown.
static const char *kind_of(const unsigned char *first, size_t size)
{
    static const struct {
        const char *bytes, *kind;
        size_t at;
    } kinds[] = {{"\x89PNG", "a PNG", 0},
                 {"\xff\xd8\xff", "a JPEG", 0},
                 {"II*", "a TIFF", 0},
                 {"MM", "a TIFF", 0},
                 {"#?RADIANCE", "a Radiance HDR", 0},
                 {"8BPS", "a Photoshop file", 0},
                 {"BLENDER", "a Blender scene", 0},
                 {"ftyp", "a video or HEIF", 4},
                 {"\x1a\x45\xdf\xa3", "a video", 0},
                 {"\x28\xb5\x2f\xfd", "compressed by zstd", 0},
                 {"\x1f\x8b", "compressed by gzip", 0},
                 {"PK", "a zip archive", 0},
                 {"%PDF", "a PDF", 0},
                 {"\x7f"
                  "ELF",
                  "a program", 0}};
    for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++) {
        const size_t n = strlen(kinds[i].bytes);
        if (kinds[i].at + n <= size && !memcmp(first + kinds[i].at, kinds[i].bytes, n))
            return kinds[i].kind;
    }
    return NULL;
}

// EXR files are recognised by their first bytes, whatever their names are.
static int open_fd(const char *path, bool *exr, struct hf_io_error *err)
{
    static const unsigned char magic[4] = {0x76, 0x2f, 0x31, 0x01};
    unsigned char first[16] = {0};
    struct stat st;
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0 || fstat(fd, &st)) {
        hf_io_fail(err, "%s: cannot open: %s", path, strerror(errno));
    } else if (!S_ISREG(st.st_mode)) {
        hf_io_fail(err, "%s: cannot open: not a regular file", path);
    } else if (st.st_size == 0) {
        hf_io_fail(err, "%s: the file is empty", path);
    } else {
        const ssize_t n = pread(fd, first, sizeof(first), 0);
        const char *kind = kind_of(first, n > 0 ? (size_t)n : 0);
        *exr = n >= (ssize_t)sizeof(magic) && !memcmp(first, magic, sizeof(magic));
        if (*exr || !hf_io_is_exr_name(path))
            return fd;
        hf_io_fail(err, "%s: not an EXR file%s%s", path, kind ? ", whatever its name says, but " : "",
                   kind ? kind : "");
    }
    if (fd >= 0)
        close(fd);
    return -1;
}

int hf_io_open_any(struct hf_io_file **out, const char *path, const struct hf_io_choice *choice,
                   struct hf_io_error *err)
{
    static const struct hf_io_choice as_searched = {NULL, NULL};
    choice = choice ? choice : &as_searched;
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
            status = hf_exr_find_views(file->exr, &file->views, choice, err);
    } else {
        close(fd);
        status = hf_oiio_open(&file->oiio, file->path, choice->depth_channel, &file->views, err);
        if (!status && choice->layer && strcmp(choice->layer, "all"))
            status = hf_io_fail(err, "%s: there is no layer %s: only EXR has layers", path, choice->layer);
    }
    if (status)
        hf_io_close(&file);
    *out = file;
    return status;
}

bool hf_io_is_deep(const struct hf_io_file *file)
{
    bool deep = file->exr;
    for (int p = 0; file->exr && p < file->exr->part_count; p++)
        deep &= hf_exr_is_deep(&file->exr->parts[p]);
    return deep;
}

int hf_io_fail_deep(const char *path, struct hf_io_error *err)
{
    return hf_io_fail(
        err, "%s: a deep picture (several samples per pixel), which cannot be used here, or has no colours", path);
}

int hf_io_open(struct hf_io_file **out, const char *path, const struct hf_io_choice *choice, struct hf_io_error *err)
{
    char names[1024] = "";
    if (hf_io_open_any(out, path, choice, err))
        return -1;
    if ((*out)->views.count)
        return 0;
    const bool deep = hf_io_is_deep(*out);
    bool several = false;
    if ((*out)->exr)
        hf_exr_layers((*out)->exr, names, sizeof(names));
    several = names[0] != 0;
    if (!several)
        hf_io_channels(*out, names, sizeof(names));
    hf_io_close(out);
    if (deep)
        return hf_io_fail_deep(path, err);
    if (several)
        return hf_io_fail(err, "%s: it is not clear which layer is the picture, choose with --layer: %s", path, names);
    return hf_io_fail(err, "%s: no colour channels (R, G, B or Y) among: %s", path, names);
}

void hf_io_close(struct hf_io_file **file)
{
    if (!file || !*file)
        return;
    hf_exr_free_deep(&(*file)->samples);
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

const char *hf_io_part_name(const struct hf_io_file *file, int part)
{
    const int there = file->exr && file->exr->part_count > 1 && part >= 0 && part < file->exr->part_count;
    return there ? file->exr->parts[part].name : "";
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

int hf_io_check_sum(const struct hf_io_file *file, struct hf_io_error *err)
{
    return file->exr ? hf_exr_check_sum(file->exr, err) : hf_io_fail(err, "%s: not an EXR file", file->path);
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

int hf_io_other_layers(const struct hf_io_file *file, char *buf, size_t size)
{
    buf[0] = 0;
    return file->exr ? hf_exr_other_layers(file->exr, &file->views, buf, size) : 0;
}

static int check_view(const struct hf_io_file *file, int view, struct hf_io_error *err)
{
    if (view < 0 || view >= file->views.count)
        return hf_io_fail(err, "%s: there is no view number %d", file->path, view);
    return 0;
}

// List what is wanted of a view as planes of an EXR file. Appends to list, which has room for five more.
static int list_planes(const struct hf_io_file *file, const struct hf_io_want *w, struct hf_exr_plane *list, int *count,
                       struct hf_io_error *err)
{
    char names[300];
    const struct hf_io_view *v = &file->views.view[w->view];
    const struct hf_exr_part *parts = file->exr->parts;
    for (int k = 0; k < 4; k++) {
        const int c = v->colour[k][0] ? hf_exr_find_channel(&parts[v->part], v->colour[k]) : -1;
        if (w->planes[k] && c >= 0)
            list[(*count)++] = (struct hf_exr_plane){v->part, c, true, v->data_window, w->planes[k]};
    }
    if (!w->depth)
        return 0;
    if (v->depth_part < 0) {
        hf_io_channels(file, names, sizeof(names));
        return hf_io_fail(err, "%s: no depth channel among: %s", file->path, names);
    }
    const struct hf_exr_part *part = &parts[v->depth_part];
    const struct hf_io_box *g = &v->data_window;
    const exr_attr_box2i_t *b = &part->window;
    if (b->max.x < g->x0 || b->min.x >= g->x1 || b->max.y < g->y0 || b->min.y >= g->y1)
        return hf_io_fail(
            err, "%s: depth channel %s covers (%d %d) - (%d %d), nothing of the colour's (%d %d) - (%d %d)", file->path,
            v->depth, b->min.x, b->min.y, b->max.x, b->max.y, g->x0, g->y0, g->x1 - 1, g->y1 - 1);
    bool colours = false;  // its part will be written again
    for (int i = 0; i < file->views.count; i++)
        colours |= file->views.view[i].part == v->depth_part;
    list[(*count)++] = (struct hf_exr_plane){v->depth_part, hf_exr_find_channel(part, v->depth), colours, *g, w->depth};
    return 0;
}

// All wanted planes, to be freed; NULL with *err filled.
static struct hf_exr_plane *all_planes(const struct hf_io_file *file, const struct hf_io_want *wants, int count,
                                       int *planes, struct hf_io_error *err)
{
    struct hf_exr_plane *list = calloc((size_t)count * 5 + 1, sizeof(*list));
    *planes = 0;
    if (!list)
        hf_io_fail(err, "%s: out of memory", file->path);
    for (int i = 0; i < count && list; i++)
        if (check_view(file, wants[i].view, err) || list_planes(file, &wants[i], list, planes, err)) {
            free(list);
            return NULL;
        }
    return list;
}

// Fill in "no surface" where the depth's own window does not reach.
static void clear_depth(const struct hf_io_file *file, const struct hf_io_want *w)
{
    const struct hf_io_view *v = &file->views.view[w->view];
    const exr_attr_box2i_t *b = &file->exr->parts[v->depth_part].window;
    const struct hf_io_box *g = &v->data_window;
    const size_t n = (size_t)v->width * (size_t)v->height;
    if (b->min.x > g->x0 || b->min.y > g->y0 || b->max.x + 1 < g->x1 || b->max.y + 1 < g->y1)
        for (size_t i = 0; i < n; i++)
            w->depth[i] = INFINITY;
}

// Such a file has that view alone.
static bool has_deep_view(const struct hf_io_file *file)
{
    return file->views.count && file->views.view[0].deep;
}

int hf_io_fetch(struct hf_io_file *file, const struct hf_io_want *wants, int count, struct hf_io_error *err)
{
    int planes;
    if (!file->exr || has_deep_view(file))
        return 0;
    struct hf_exr_plane *list = all_planes(file, wants, count, &planes, err);
    const int status = list ? hf_exr_fetch(file->exr, list, planes, err) : -1;
    free(list);
    return status;
}

static int decode_by_oiio(struct hf_io_file *file, const struct hf_io_want *w, struct hf_io_error *err)
{
    char names[300];
    if (check_view(file, w->view, err))
        return -1;
    if (w->depth && file->views.view[w->view].depth_part < 0) {
        hf_io_channels(file, names, sizeof(names));
        return hf_io_fail(err, "%s: no depth channel among: %s", file->path, names);
    }
    if (w->depth && hf_oiio_read_depth(file->oiio, w->depth, err))
        return -1;
    const bool colour = w->planes[0] || w->planes[1] || w->planes[2] || w->planes[3];
    return colour ? hf_oiio_read_colour(file->oiio, w->planes, err) : 0;
}

int hf_io_decode(struct hf_io_file *file, const struct hf_io_want *wants, int count, const struct hf_io_run *run,
                 struct hf_io_error *err)
{
    int planes, status = 0;
    for (int i = 0; i < count && !file->exr && !status; i++)
        status = decode_by_oiio(file, &wants[i], err);
    for (int i = 0; i < count && has_deep_view(file) && !status; i++)
        status = check_view(file, wants[i].view, err) ? -1 : hf_io_decode_deep(file, &wants[i], run, err);
    if (!file->exr || has_deep_view(file))
        return status;
    struct hf_exr_plane *list = all_planes(file, wants, count, &planes, err);
    for (int i = 0; i < count && list; i++)
        if (wants[i].depth)
            clear_depth(file, &wants[i]);
    status = list ? hf_exr_decode(file->exr, list, planes, run, err) : -1;
    free(list);
    return status;
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

int hf_io_read_depth_rows(struct hf_io_file *file, int view, int first, int count, float *depth,
                          struct hf_io_error *err)
{
    const struct hf_io_want want = {.view = view, .depth = depth};
    int planes;
    if (!file->exr || has_deep_view(file))
        return hf_io_read_depth(file, view, depth, err);
    struct hf_exr_plane *list = all_planes(file, &want, 1, &planes, err);
    if (!list)
        return -1;
    const size_t width = (size_t)file->views.view[view].width;
    list[0].keep = false;  // otherwise all would be decoded
    list[0].grid.y0 += first;
    list[0].grid.y1 = list[0].grid.y0 + count;
    list[0].to += (size_t)first * width;
    for (size_t i = 0; i < (size_t)count * width; i++)
        list[0].to[i] = INFINITY;  // where the depth's own window does not reach
    const int status = hf_exr_decode(file->exr, list, planes, NULL, err);
    free(list);
    return status;
}

void hf_io_set_display(struct hf_io_file *file, int view, struct hf_io_box box)
{
    file->views.view[view].display_window = box;
}

int hf_io_grow(struct hf_io_file *file, int view, struct hf_io_box box, float no_surface, const struct hf_io_run *run,
               struct hf_io_error *err)
{
    const int part = file->views.view[view].part;
    if (check_view(file, view, err) || hf_io_check_window(file->path, "the grown data window", box, err))
        return -1;
    struct hf_exr_fill *fills = calloc((size_t)file->views.count + 1, sizeof(*fills));
    int count = 0, status = fills ? 0 : hf_io_fail(err, "%s: out of memory", file->path);
    for (int i = 0; i < file->views.count && !status && file->exr; i++) {
        const struct hf_io_view *v = &file->views.view[i];
        if (v->depth_part == part)
            fills[count++] = (struct hf_exr_fill){hf_exr_find_channel(&file->exr->parts[part], v->depth), no_surface};
    }
    if (!status && file->exr)
        status = hf_exr_grow(file->exr, part, box, fills, count, run, err);
    free(fills);
    for (int i = 0; i < file->views.count && !status; i++) {
        struct hf_io_view *v = &file->views.view[i];
        if (v->part != part)
            continue;
        v->data_window = box;
        v->width = box.x1 - box.x0;
        v->height = box.y1 - box.y0;
    }
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

void hf_io_catch_signals(void)
{
    hf_temp_catch_signals();
}

void hf_io_end_by_signal(int number)
{
    hf_temp_end_by_signal(number);
}

int hf_io_has_oiio(void)
{
    return hf_oiio_available();
}

const char *hf_io_sandbox(void)
{
    return hf_oiio_sandbox();
}

int hf_io_is_helped(const struct hf_io_file *file, const char *path, const char *compression)
{
    const int wanted = compression ? hf_exr_compression(compression) : -1;
    if (!file->exr || (path && !hf_io_is_exr_name(path)) || (wanted >= 0 && hf_exr_is_dwa((exr_compression_t)wanted)))
        return 1;
    for (int i = 0; i < file->views.count; i++)
        if (hf_exr_is_dwa(file->exr->parts[file->views.view[i].part].compression))
            return 1;
    return 0;
}

double hf_io_memory(const struct hf_io_file *file)
{
    double bytes = file->exr ? (double)file->exr->size : 0;
    for (int p = 0; file->exr && p < file->exr->part_count; p++) {
        const struct hf_exr_part *part = &file->exr->parts[p];
        double pixel = 0;
        bool colours = false;
        for (int c = 0; c < part->channel_count; c++)
            pixel += (double)part->channels[c].bytes / (part->channels[c].x_sampling * part->channels[c].y_sampling);
        for (int i = 0; i < file->views.count; i++)
            colours |= file->views.view[i].part == p;
        // The samples, and the chunks of the new file. The codec that does DWA whole has each once more.
        if (colours)
            bytes += (hf_exr_is_dwa(part->compression) ? 4 : 2) * pixel * part->width * part->height;
    }
    // Samples that were not read yet are taken to be half as long in the file.
    if (has_deep_view(file))
        bytes += fmax(
            2. * (double)file->exr->size,
            hf_exr_deep_bytes(&file->samples, (size_t)file->views.view[0].width * (size_t)file->views.view[0].height));
    for (int i = 0; i < file->views.count && !file->exr; i++)
        bytes += 16. * file->views.view[i].width * file->views.view[i].height;
    return bytes;
}
