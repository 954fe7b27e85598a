// SPDX-License-Identifier: BSD-3-Clause
// New files, and formats that are not EXR.
#include "io/tests.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

void test_planes(void)
{
    static const char *const names[] = {"near", "R", "coc"};
    const char *path = in_folder("planes.exr");
    float buf[3][7 * 16], got[5 * 7];
    const float *planes[3] = {buf[0], buf[1], buf[2]};
    struct hf_io_error err = {""};
    struct hf_io_view v = {.width = 5, .height = 7};
    for (int i = 0; i < 3 * 7 * 16; i++)
        buf[i % 3][i / 3] = (float)i * 0.1f;
    CHECK_MSG(!hf_io_write_planes(path, 5, 7, 3, names, planes, 16, &err), "%s", err.message);
    for (int c = 0; c < 3; c++) {
        CHECK_MSG(!hf_io_read_depth_file(path, names[c], &v, got, &err), "%s", err.message);
        for (int i = 0; i < 35; i++)
            CHECK(got[i] == buf[c][i / 5 * 16 + i % 5]);
    }
    v.width = 6;
    expect_error(hf_io_read_depth_file(path, "R", &v, got, &err), &err, "5 x 7 pixels of depth for a picture of 6 x 7");
    expect_error(hf_io_read_depth_file(path, "x", &v, got, &err), &err, "no depth channel x among: R, coc, near");
    expect_error(hf_io_write_planes(in_folder("no/p.exr"), 5, 7, 3, names, planes, 16, &err), &err, "cannot create");
    CHECK(!hf_io_write_planes(path, 5, 7, 3, names, planes, 16, NULL));
    struct rlimit was, low;
    getrlimit(RLIMIT_FSIZE, &was);
    low = was;
    low.rlim_cur = 300;
    setrlimit(RLIMIT_FSIZE, &low);
    unlink(path);
    const int files = files_in(folder), status = hf_io_write_planes(path, 5, 7, 3, names, planes, 16, &err);
    setrlimit(RLIMIT_FSIZE, &was);
    expect_error(status, &err, "cannot write");
    CHECK_INT(files_in(folder), files);
}

// Ramps from 0 to 1, through a format and back.
static void format_trip(const char *name, float bound, bool alpha)
{
    static const char *const names[] = {"R", "G", "B", "A"};
    enum { N = 64 };
    float buf[4][N * 2], got[4][N * 2], worst = 0;
    const float *planes[4] = {buf[0], buf[1], buf[2], buf[3]};
    float *to[4] = {got[0], got[1], got[2], got[3]};
    struct hf_io_error err = {""};
    struct hf_io_file *f = NULL;
    for (int i = 0; i < 2 * N; i++) {
        buf[3][i] = alpha ? 0.25f + 0.75f * (float)(i % N) / N : 1;
        for (int c = 0; c < 3; c++)
            buf[c][i] = buf[3][i] * (float)(i % N) / (N - 1) * (c == 1 ? 0.5f : 1.0f);
    }
    const char *exr = in_folder("ramp.exr"), *path = in_folder(name);
    CHECK(!hf_io_write_planes(exr, N, 2, alpha ? 4 : 3, names, planes, N, &err));
    if (!CHECK_MSG(!hf_io_open(&f, exr, NULL, &err), "%s", err.message))
        return;
    const struct hf_io_result r = {0, {NULL, planes[1], NULL, NULL}};
    const struct hf_io_job job = {.path = path, .results = &r, .result_count = 1};
    CHECK_MSG(!hf_io_write(f, &job, NULL, &err), "%s", err.message);
    hf_io_close(&f);
    if (!CHECK_MSG(!hf_io_open(&f, path, NULL, &err), "%s", err.message))
        return;
    CHECK_MSG(!hf_io_read_colour(f, 0, to, &err), "%s", err.message);
    CHECK((hf_io_view(f, 0)->colour[3][0] != 0) == alpha);
    for (int c = 0; c < (alpha ? 4 : 3); c++)
        for (int i = 0; i < 2 * N; i++)
            worst = fmaxf(worst, fabsf(got[c][i] - buf[c][i]));
    CHECK_MSG(worst <= bound, "%s is off by %g, more than %g", name, (double)worst, (double)bound);
    // And as the source of an EXR and of itself.
    CHECK_MSG(!rewrite(path, in_folder("from.exr"), &err), "%s", err.message);
    CHECK_MSG(!rewrite(path, in_folder("from.tif"), &err), "%s", err.message);
    CHECK_MSG(!rewrite(in_folder("from.tif"), in_folder("from.exr"), &err), "%s", err.message);
    CHECK_MSG(!rewrite(path, path, &err), "%s", err.message);
    CHECK_MSG(!rewrite(path, in_folder("from.exr"), &err), "%s", err.message);
    hf_io_close(&f);
}

// What OpenImageIO reads: half a file is an error, and rubbish, which crashes some of its readers, is survived.
static void test_damaged(const char *name)
{
    const char *path = in_folder("bad"), *target = in_folder("out.exr");
    struct hf_io_error err = {""};
    size_t size;
    CHECK_MSG(!rewrite(in_folder("ramp.exr"), in_folder(name), &err), "%s", err.message);
    uint8_t *data = slurp(in_folder(name), &size), *copy = allocate(size);
    spill(path, data, size / 2);
    CHECK_MSG(!survive(path, target), "half of %s is read as a picture", name);
    for (int i = 0; i < 12; i++) {
        memcpy(copy, data, size);
        for (uint32_t k = 0, n = 1 + rnd() % 4; k < n; k++)
            copy[rnd() % (i & 1 ? size : size < 300 ? size : 300)] = (uint8_t)rnd();
        spill(path, copy, size);
        survive(path, target);
    }
    unlink(path);
    free(copy);
    free(data);
}

void test_formats(void)
{
    struct hf_io_error err = {""};
    struct hf_io_file *f;
    if (!hf_io_has_oiio()) {
        spill(in_folder("a.png"), "\x89PNG\r\n\x1a\n", 8);
        expect_error(hf_io_open(&f, in_folder("a.png"), NULL, &err), &err, "built without OpenImageIO");
        return;
    }
    // Half a step of 8 bits where the sRGB curve is steepest.
    format_trip("a.png", 0.5f / 255 * 2.3f, false);
    format_trip("alpha.png", 0.5f / 255 * 2.3f + 0.002f, true);
    format_trip("a.jpg", 0.1f, false);
    format_trip("a.tif", 0, false);
    format_trip("alpha.tif", 0, true);
    format_trip("a.hdr", 1.0f / 128, false);
    expect_error(rewrite(in_folder("ramp.exr"), in_folder("a.nothing"), &err), &err, "does not know the format");
    const struct part parts[MAX_PARTS] = {
        usual_part(EXR_STORAGE_SCANLINE, EXR_COMPRESSION_NONE, EXR_LINEORDER_INCREASING_Y)};
    CHECK(!make_exr(in_folder("a.exr"), parts, NULL));
    full_disk(in_folder("a.exr"), in_folder("full.tif"));
    full_disk(in_folder("a.exr"), in_folder("full.png"));
    full_disk(in_folder("a.exr"), in_folder("full.sgi"));
    full_disk(in_folder("a.exr"), in_folder("full.rgb"));
    expect_error(rewrite(in_folder("a.exr"), in_folder("a.term"), &err), &err, "holds no whole picture");
    format_trip("a.sgi", 0.5f / 255 * 2.3f, false);
    format_trip("b.dpx", 0.5f / 255 * 2.3f, false);
    static const char *const damaged[] = {"a.png", "a.jpg", "a.tif", "a.iff", "a.dpx", "a.sgi", "a.hdr", "a.bmp"};
    for (size_t i = 0; i < sizeof(damaged) / sizeof(damaged[0]); i++)
        test_damaged(damaged[i]);
    for (int i = 0; i < 8; i++) {  // a picture cut short
        size_t size;
        uint8_t *data = slurp(in_folder("a.png"), &size);
        spill(in_folder("cut.png"), data, size * (size_t)i / 8);
        CHECK(!survive(in_folder("cut.png"), in_folder("out.exr")));
        free(data);
    }
}
