// SPDX-License-Identifier: BSD-3-Clause
#include "io/trip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tools/io/half.h"

struct hf_io_run threads;

// New colours: some do not fit a half.
static float new_value(size_t i, int k)
{
    if (i % 17 == 3)
        return k == 1 ? -1e6f : 70000.0f;
    return (float)(i % 300) * 0.25f + (float)k;
}

struct planes make_planes(const struct hf_io_view *v, int *too_large)
{
    struct planes planes = {{0}};
    const size_t n = (size_t)v->width * (size_t)v->height;
    for (int k = 0; k < 4; k++) {
        planes.p[k] = allocate(n * sizeof(float));
        for (size_t i = 0; i < n; i++) {
            planes.p[k][i] = new_value(i, k);
            *too_large += k < 3 && fabsf(planes.p[k][i]) > HF_HALF_MAX;
        }
    }
    return planes;
}

void free_planes(struct planes *planes)
{
    for (int k = 0; k < 4; k++)
        free(planes->p[k]);
}

// The file has the written values: exactly for lossless floats, clamped and rounded for halves.
static void check_written(const char *path, const struct hf_io_file *source, const struct hf_io_result *r, int n,
                          bool half)
{
    struct hf_io_file *f;
    struct hf_io_error err = {.message = ""};
    if (!CHECK_MSG(!hf_io_open(&f, path, NULL, &err), "%s", err.message))
        return;
    CHECK_INT(hf_io_view_count(f), hf_io_view_count(source));
    for (int i = 0; i < n; i++) {
        const struct hf_io_view *v = hf_io_view(f, r[i].view);
        int ignored = 0, bad = 0;
        struct planes got = make_planes(v, &ignored);
        CHECK_MSG(!hf_io_read_colour(f, r[i].view, got.p, &err), "%s", err.message);
        for (int k = 0; k < 3; k++) {
            for (size_t j = 0; j < (size_t)v->width * (size_t)v->height && v->colour[k][0]; j++) {
                const float want = r[i].planes[k][j];
                uint64_t clamped = 0;
                bad += got.p[k][j] != (half ? hf_io_from_half(hf_io_to_half(want, &clamped)) : want);
            }
        }
        CHECK_MSG(!bad, "%s: %d samples of view %d are not what was written", path, bad, r[i].view);
        free_planes(&got);
    }
    hf_io_close(&f);
}

// Write new colours for all views of a file, and check that nothing else changed.
void round_trip(const char *path, const char *compression, bool half, bool exact)
{
    const char *target = in_folder("out.exr");
    struct hf_io_result results[4];
    struct planes planes[4];
    struct hf_io_file *f;
    struct hf_io_error err = {.message = ""};
    struct hf_io_written written;
    int too_large = 0;
    if (!CHECK_MSG(!hf_io_open(&f, path, NULL, &err), "%s", err.message))
        return;
    const int n = hf_io_view_count(f);
    for (int i = 0; i < n; i++) {
        planes[i] = make_planes(hf_io_view(f, i), &too_large);
        results[i] = (struct hf_io_result){.view = i, .planes = {planes[i].p[0], planes[i].p[1], planes[i].p[2], NULL}};
    }
    unlink(target);
    const int files = files_in(folder);
    const struct hf_io_job job = {
        .path = target, .results = results, .result_count = n, .compression = compression, .run = &threads};
    if (CHECK_MSG(!hf_io_write(f, &job, &written, &err), "%s", err.message)) {
        CHECK_INT(files_in(folder), files + 1);
        if (hf_io_view(f, 0)->colour[1][0] == 'G' || !strcmp(hf_io_view(f, 0)->colour[0], "R"))
            CHECK_INT(written.clamped, half ? too_large : 0);
        if (!compression)
            compare_headers(path, target);
        compare_channels(path, target, f, results, n);
        if (exact)
            check_written(target, f, results, n, half);
    }
    for (int i = 0; i < n; i++)
        free_planes(&planes[i]);
    hf_io_close(&f);
}

static const struct channel usual[] = {
    {"A", EXR_PIXEL_HALF, 0},  {"B", EXR_PIXEL_HALF, 0},  {"G", EXR_PIXEL_HALF, 0},    {"R", EXR_PIXEL_HALF, 0},
    {"Z", EXR_PIXEL_FLOAT, 0}, {"id", EXR_PIXEL_UINT, 0}, {"uv.u", EXR_PIXEL_HALF, 0},
};

struct part usual_part(exr_storage_t storage, exr_compression_t compression, exr_lineorder_t order)
{
    struct part p = {
        .storage = storage, .compression = compression, .order = order, .x = -3, .y = -7, .width = 37, .height = 41};
    memcpy(p.channels, usual, sizeof(usual));
    return p;
}

struct hf_io_file *open_or_complain(const char *path, const char *depth, int views)
{
    struct hf_io_file *f = NULL;
    struct hf_io_error err = {.message = ""};
    CHECK_MSG(!hf_io_open(&f, path, &(struct hf_io_choice){.depth_channel = depth}, &err), "%s", err.message);
    if (f && !CHECK_INT(hf_io_view_count(f), views))
        hf_io_close(&f);
    return f;
}

void check_view(const struct hf_io_file *f, int i, const char *name, int part, const char *red, int depth_part,
                const char *depth)
{
    const struct hf_io_view *v = hf_io_view(f, i);
    CHECK_MSG(!strcmp(v->name, name) && v->part == part && !strcmp(v->colour[0], red) && v->depth_part == depth_part &&
                  !strcmp(v->depth, depth),
              "view %d is %s, part %d, %s, depth %d %s", i, v->name, v->part, v->colour[0], v->depth_part, v->depth);
}

int rewrite(const char *path, const char *target, struct hf_io_error *err)
{
    struct hf_io_file *f;
    int ignored = 0;
    if (hf_io_open(&f, path, NULL, err))
        return -1;
    const struct hf_io_view *v = hf_io_view(f, 0);
    struct planes planes = make_planes(v, &ignored);
    const struct hf_io_result r = {.view = 0, .planes = {planes.p[0], planes.p[1], planes.p[2], planes.p[3]}};
    const struct hf_io_job job = {.path = target, .results = &r, .result_count = 1};
    const int status = hf_io_write(f, &job, NULL, err);
    free_planes(&planes);
    hf_io_close(&f);
    return status;
}

void expect_error(int status, const struct hf_io_error *err, const char *part)
{
    CHECK_MSG(status == -1 && strstr(err->message, part), "expected an error with \"%s\", got %d %s", part, status,
              err->message);
}
