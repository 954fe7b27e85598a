// SPDX-License-Identifier: BSD-3-Clause
// Depth from a separate file. A depth estimator's map of a photograph is often smaller than the photograph.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/io/depth_edges.h"
#include "tools/io/depth_steps.h"
#include "tools/io/exr/chunks.h"
#include "tools/io/file.h"
#include "tools/io/oiio/oiio.h"

enum {
    LARGEST = 5
};  // times the picture's width: a file of a few bytes may claim to be larger, but gets no more memory than this

// Where the depth is, and its size.
struct source {
    struct hf_io_file *file;
    int part, channel;  // of an EXR
    int width, height;
    int bits;
    enum hf_io_edges edges;
    long long sharpened, smoothed;
    const struct hf_io_run *run;
};

static int find_exr(struct source *s, const char *depth_channel, const struct hf_io_view *view, struct hf_io_error *err)
{
    char names[300];
    const struct hf_exr *exr = s->file->exr;
    s->part = hf_exr_find_depth_only(exr, depth_channel, view->name, &s->channel);
    if (s->part < 0 && hf_io_is_deep(s->file))
        return hf_io_fail_deep(s->file->path, err);
    if (s->part < 0) {
        hf_io_channels(s->file, names, sizeof(names));
        return hf_io_fail(err, "%s: no depth channel%s%s among: %s", s->file->path, depth_channel ? " " : "",
                          depth_channel ? depth_channel : "", names);
    }
    const struct hf_exr_part *part = &exr->parts[s->part];
    const struct hf_exr_channel *c = &part->channels[s->channel];
    if (hf_exr_check_part(exr, s->part, err))
        return -1;
    if (c->x_sampling != 1 || c->y_sampling != 1)
        return hf_io_fail(err, "%s: channel %s is subsampled, which is not supported", s->file->path, c->name);
    s->width = part->width;
    s->height = part->height;
    return 0;
}

static int read_samples(const struct source *s, const char *depth_channel, const struct hf_io_view *view, float *depth,
                        struct hf_io_error *err)
{
    struct hf_io_view own = *view;
    own.width = s->width;
    own.height = s->height;
    if (!s->file->exr)
        return hf_oiio_read_depth_only(s->file->oiio, depth_channel, &own, depth, err);
    const exr_attr_box2i_t *b = &s->file->exr->parts[s->part].window;
    const struct hf_io_box window = {b->min.x, b->min.y, b->max.x + 1, b->max.y + 1};
    const struct hf_exr_plane plane = {s->part, s->channel, false, window, depth};
    return hf_exr_decode(s->file->exr, &plane, 1, NULL, err);
}

static int read_own_size(struct source *s, const char *depth_channel, const struct hf_io_view *view, float *depth,
                         struct hf_io_error *err)
{
    if (read_samples(s, depth_channel, view, depth, err))
        return -1;
    if ((s->edges == HF_IO_EDGES_SHARPEN || (s->edges == HF_IO_EDGES_AUTO && s->bits)) &&
        hf_io_sharpen_depth(depth, s->width, s->height, s->run, &s->sharpened))
        return hf_io_fail(err, "%s: out of memory", s->file->path);
    if (s->edges != HF_IO_EDGES_KEEP && s->bits && s->bits <= 8 &&
        hf_io_smooth_steps(depth, s->width, s->height, 1.0f / (float)((1 << s->bits) - 1), s->run, &s->smoothed))
        return hf_io_fail(err, "%s: out of memory", s->file->path);
    return 0;
}

// Scale by the nearest sample: a mean of two surfaces would be a distance where nothing is.
static void resample(const float *from, const struct source *s, float *to, int width, int height)
{
    for (int y = 0; y < height; y++) {
        const float *row = from + (size_t)((2LL * y + 1) * s->height / (2LL * height)) * (size_t)s->width;
        for (int x = 0; x < width; x++)
            *to++ = row[(2LL * x + 1) * s->width / (2LL * width)];
    }
}

static int read_other_size(struct source *s, const char *depth_channel, const struct hf_io_view *view, float *depth,
                           struct hf_io_error *err)
{
    const double shape = (double)s->width * view->height / ((double)s->height * view->width);
    if (!(fabs(shape - 1) <= 0.01) || s->width / view->width >= LARGEST)
        return hf_io_fail(err,
                          "%s: %d x %d pixels of depth for a picture of %d x %d: a map is scaled to the picture when "
                          "its width / height is the same within 1 %%, and it is less than %d times as wide",
                          s->file->path, s->width, s->height, view->width, view->height, LARGEST);
    float *own = malloc((size_t)s->width * (size_t)s->height * sizeof(float));
    if (!own)
        return hf_io_fail(err, "%s: out of memory", s->file->path);
    const int status = read_own_size(s, depth_channel, view, own, err);
    if (!status)
        resample(own, s, depth, view->width, view->height);
    free(own);
    return status;
}

// Depth is one number per pixel. The red channel of a coloured picture is not depth: the user named a photograph by
// mistake, or a map coloured for people. Compression changes grey by at most a twentieth.
static int check_grey(struct source *s, const char *depth_channel, struct hf_io_error *err)
{
    const struct hf_io_view *v = hf_io_view(s->file, 0);
    if (depth_channel || !v || v->depth_part >= 0 || !strcmp(v->colour[0], v->colour[1]) || v->width != s->width ||
        v->height != s->height)
        return 0;
    const size_t n = (size_t)v->width * (size_t)v->height;
    float *memory = malloc(3 * n * sizeof(float)), largest = 0, apart = 0;
    if (!memory)
        return hf_io_fail(err, "%s: out of memory", s->file->path);
    float *planes[4] = {memory, memory + n, memory + 2 * n, NULL};
    const int status = hf_io_read_colour(s->file, 0, planes, err);
    for (size_t i = 0; i < n && !status; i++) {
        const float r = planes[0][i], g = planes[1][i], b = planes[2][i];
        if (isfinite(r) && isfinite(g) && isfinite(b)) {
            largest = fmaxf(largest, fmaxf(fabsf(r), fmaxf(fabsf(g), fabsf(b))));
            apart = fmaxf(apart, fmaxf(fabsf(r - g), fabsf(r - b)));
        }
    }
    free(memory);
    if (!status && apart > largest / 20)
        return hf_io_fail(
            err,
            "%s: a picture in colours, where depth should be one number a pixel; --depth-channel %s takes that one",
            s->file->path, v->colour[0]);
    return status;
}

int hf_io_read_depth_file(const char *path, const char *depth_channel, enum hf_io_edges edges,
                          const struct hf_io_view *view, const struct hf_io_run *run, float *depth,
                          struct hf_io_map *map, struct hf_io_error *err)
{
    struct source s = {.edges = edges, .run = run};
    *map = (struct hf_io_map){0};
    int status = hf_io_open_any(&s.file, path, NULL, err);
    if (!status && s.file->exr)
        status = find_exr(&s, depth_channel, view, err);
    else if (!status)
        hf_oiio_size(s.file->oiio, &s.width, &s.height);
    if (!status && !s.file->exr)
        s.bits = hf_oiio_bits(s.file->oiio);
    if (!status && s.width == view->width && s.height == view->height)
        status = read_own_size(&s, depth_channel, view, depth, err);
    else if (!status)
        status = read_other_size(&s, depth_channel, view, depth, err);
    if (!status)
        status = check_grey(&s, depth_channel, err);
    if (!status)
        *map = (struct hf_io_map){s.width, s.height, s.bits, s.sharpened, s.smoothed};
    hf_io_close(&s.file);
    return status;
}
