// SPDX-License-Identifier: BSD-3-Clause
#include "surfaces.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if HF_HAVE_IO
#include "tools/io/io.h"
#endif

static int allocate(struct bench_peel *p, int width, int height, struct tool_error *error)
{
    const size_t n = (size_t)width * (size_t)height;
    float *memory = calloc(5 * n, sizeof *memory);
    *p = (struct bench_peel){.width = width, .height = height};
    if (!memory)
        return tool_fail(error, -1, "there is not enough memory for a surface of %dx%d", width, height);
    for (size_t c = 0; c < 4; c++)
        p->planes[c] = memory + c * n;
    p->depth = memory + 4 * n;
    return 0;
}

static void count_samples(struct bench_peel *p)
{
    p->samples = 0;
    for (size_t i = 0; i < (size_t)p->width * (size_t)p->height; i++)
        p->samples += p->planes[3][i] > 0;
}

#if HF_HAVE_IO
int bench_peel_read(struct bench_peel *p, const char *path, int k, struct tool_error *error)
{
    const char *dot = strrchr(path, '.');
    char name[4096];
    struct hf_io_error io;
    struct hf_io_file *file;
    *p = (struct bench_peel){0};
    snprintf(name, sizeof name, "%.*s.peel%d.exr", (int)(dot ? dot - path : (ptrdiff_t)strlen(path)), path, k);
    if (hf_io_open(&file, name, NULL, &io))
        return tool_fail(error, -1, "%s", io.message);
    const struct hf_io_view *v = hf_io_view(file, 0);
    int err = v->depth_part < 0 || !v->colour[3][0] ? tool_fail(error, -1, "%s has no depth or no alpha", name) : 0;
    if (!err)
        err = allocate(p, v->width, v->height, error);
    if (!err && (hf_io_read_colour(file, 0, p->planes, &io) || hf_io_read_depth(file, 0, p->depth, &io)))
        err = tool_fail(error, -1, "%s", io.message);
    hf_io_close(&file);
    if (err)
        bench_peel_free(p);
    else
        count_samples(p);
    return err;
}
#else
int bench_peel_read(struct bench_peel *p, const char *path, int k, struct tool_error *error)
{
    (void)k;
    *p = (struct bench_peel){0};
    return tool_fail(error, -1, "%s: this build reads no files", path);
}
#endif

int bench_peel_make(struct bench_peel *p, const struct bench_scene *scene, int k, struct tool_error *error)
{
    if (allocate(p, scene->width, scene->height, error))
        return -1;
    for (size_t i = 0; i < (size_t)p->width * (size_t)p->height; i++) {
        for (size_t c = 0; c < 3; c++)
            p->planes[c][i] = scene->rgb[3 * i + c];
        p->planes[3][i] = 1;
        p->depth[i] = scene->depth[i] * (float)(1 + k);
    }
    count_samples(p);
    return 0;
}

void bench_peel_free(struct bench_peel *p)
{
    free(p->planes[0]);
    *p = (struct bench_peel){0};
}

void bench_subject_peels(struct bench_subject *s, const struct bench_peel *peels, int count)
{
    s->surfaces = 1;
    for (int i = 0; i < count && s->surfaces < BENCH_SURFACES; i++, s->surfaces++) {
        const struct bench_peel *p = &peels[i];
        struct hf_image *image = &s->peel_images[i];
        *image = (struct hf_image){
            .size = sizeof *image, .width = p->width, .height = p->height, .format = HF_FORMAT_PLANAR32F};
        for (int c = 0; c < 4; c++) {
            image->data[c] = p->planes[c];
            image->stride[c] = p->width * (ptrdiff_t)sizeof(float);
        }
        s->peel_depths[i] = s->depth;
        s->peel_depths[i].data = p->depth;
    }
}
