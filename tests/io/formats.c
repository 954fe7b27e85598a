// SPDX-License-Identifier: BSD-3-Clause
// New files, and formats that are not EXR.
#include "tools/io/exr/exr.h"
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
    const float *data[3] = {buf[0], buf[1], buf[2]};
    const struct hf_io_planes planes = {5, 7, 3, names, data, 16};
    struct hf_io_error err = {.message = ""};
    struct hf_io_view v = {.width = 5, .height = 7};
    struct hf_io_map found;
    for (int i = 0; i < 3 * 7 * 16; i++)
        buf[i % 3][i / 3] = (float)i * 0.1f;
    CHECK_MSG(!hf_io_write_planes(path, &planes, &err), "%s", err.message);
    for (int c = 0; c < 3; c++) {
        CHECK_MSG(!hf_io_read_depth_file(path, names[c], HF_IO_EDGES_KEEP, &v, NULL, got, &found, &err), "%s",
                  err.message);
        for (int i = 0; i < 35; i++)
            CHECK(got[i] == buf[c][i / 5 * 16 + i % 5]);
    }
    v.width = 6;
    expect_error(hf_io_read_depth_file(path, "R", HF_IO_EDGES_KEEP, &v, NULL, got, &found, &err), &err,
                 "5 x 7 pixels of depth for a picture of 6 x 7");
    expect_error(hf_io_read_depth_file(path, "x", HF_IO_EDGES_KEEP, &v, NULL, got, &found, &err), &err,
                 "no depth channel x among: R, coc, near");
    expect_error(hf_io_write_planes(in_folder("no/p.exr"), &planes, &err), &err, "cannot create");
    CHECK(!hf_io_write_planes(path, &planes, NULL));
    struct rlimit was, low;
    getrlimit(RLIMIT_FSIZE, &was);
    low = was;
    low.rlim_cur = 300;
    setrlimit(RLIMIT_FSIZE, &low);
    unlink(path);
    const int files = files_in(folder), status = hf_io_write_planes(path, &planes, &err);
    setrlimit(RLIMIT_FSIZE, &was);
    expect_error(status, &err, "cannot write");
    CHECK_INT(files_in(folder), files);
}

// A depth file of another size than the picture: the sample that contains the middle of a pixel is taken.
void test_depth_file_sizes(void)
{
    static const char *const names[] = {"Z"};
    static const struct {
        int width, height, from_width, from_height;
    } cases[] = {{8, 4, 4, 2}, {9, 6, 6, 4}, {4, 2, 16, 8}, {200, 100, 150, 75}, {5, 5, 1, 1}};
    float map[200 * 100], got[200 * 100];
    const float *data[1] = {map};
    struct hf_io_error err = {.message = ""};
    struct hf_io_map found;
    for (int i = 0; i < 200 * 100; i++)
        map[i] = (float)(i + 1);
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        const int w = cases[i].width, h = cases[i].height, fw = cases[i].from_width, fh = cases[i].from_height;
        const struct hf_io_planes planes = {fw, fh, 1, names, data, fw};
        const struct hf_io_view v = {.width = w, .height = h};
        const char *path = in_folder("map.exr");
        CHECK(!hf_io_write_planes(path, &planes, &err));
        CHECK_MSG(!hf_io_read_depth_file(path, NULL, HF_IO_EDGES_KEEP, &v, NULL, got, &found, &err), "%s", err.message);
        CHECK(found.width == fw && found.height == fh);
        for (int y = 0; y < h; y++)
            for (int x = 0; x < w; x++) {
                const int sx = (int)floor((x + 0.5) * fw / w), sy = (int)floor((y + 0.5) * fh / h);
                CHECK_MSG(got[y * w + x] == map[sy * fw + sx], "case %zu: %d %d of %g", i, x, y,
                          (double)got[y * w + x]);
            }
    }
    const struct hf_io_planes planes = {10, 10, 1, names, data, 10};
    const struct hf_io_view other = {.width = 100, .height = 98}, tiny = {.width = 2, .height = 2};
    CHECK(!hf_io_write_planes(in_folder("map.exr"), &planes, &err));
    expect_error(hf_io_read_depth_file(in_folder("map.exr"), NULL, HF_IO_EDGES_KEEP, &other, NULL, got, &found, &err),
                 &err, "10 x 10 pixels of depth for a picture of 100 x 98");
    expect_error(hf_io_read_depth_file(in_folder("map.exr"), NULL, HF_IO_EDGES_KEEP, &tiny, NULL, got, &found, &err),
                 &err, "less than 5 times");
}

// Chunks of all lengths around the one at which compressing gains nothing.
static void new_files(void)
{
    static const char *const names[] = {"Z"}, *const kinds[] = {"none", "rle", "zips", "zip", "piz"};
    enum { MOST = 24 };
    float map[MOST * MOST], got[MOST * MOST];
    const float *data[1] = {map};
    const char *path = in_folder("new.exr");
    for (int i = 0; i < 300; i++) {
        const int w = 1 + (int)(rnd() % MOST), h = 1 + (int)(rnd() % MOST), calm = (int)(rnd() % 24);
        const struct hf_exr_new picture = {.data_window = {0, 0, w, h},
                                           .display_window = {0, 0, w, h},
                                           .pixel_aspect = 1,
                                           .screen_width = 1,
                                           .compression = hf_exr_compression(kinds[i % 5]),
                                           .channel_count = 1,
                                           .names = names,
                                           .planes = data,
                                           .stride = w};
        const struct hf_io_view v = {.width = w, .height = h};
        struct hf_io_bytes made;
        struct hf_io_error err = {.message = ""};
        struct hf_io_map found;
        // Mantissas of few bits compress, those of many do not.
        for (int k = 0; k < w * h; k++)
            map[k] = i % 2 ? (float)(k + 1) : ldexpf((float)(rnd() >> 8 >> calm), -12);
        CHECK_MSG(!hf_exr_make_new(&made, path, &picture, &err), "%s", err.message);
        spill(path, made.data, made.size);
        free(made.data);
        CHECK_MSG(!hf_io_read_depth_file(path, NULL, HF_IO_EDGES_KEEP, &v, NULL, got, &found, &err), "%s", err.message);
        CHECK_MSG(!memcmp(map, got, (size_t)w * (size_t)h * sizeof(float)), "%s, %d x %d", kinds[i % 5], w, h);
    }
}

// Ramps from 0 to 1, through a format and back.
static void format_trip(const char *name, float bound, bool alpha)
{
    static const char *const names[] = {"R", "G", "B", "A"};
    enum { N = 64 };
    float buf[4][N * 2], got[4][N * 2], worst = 0;
    const float *data[4] = {buf[0], buf[1], buf[2], buf[3]};
    const struct hf_io_planes planes = {N, 2, alpha ? 4 : 3, names, data, N};
    float *to[4] = {got[0], got[1], got[2], got[3]};
    struct hf_io_error err = {.message = ""};
    struct hf_io_file *f = NULL;
    for (int i = 0; i < 2 * N; i++) {
        buf[3][i] = alpha ? 0.25f + 0.75f * (float)(i % N) / N : 1;
        for (int c = 0; c < 3; c++)
            buf[c][i] = buf[3][i] * (float)(i % N) / (N - 1) * (c == 1 ? 0.5f : 1.0f);
    }
    const char *exr = in_folder("ramp.exr"), *path = in_folder(name);
    CHECK(!hf_io_write_planes(exr, &planes, &err));
    if (!CHECK_MSG(!hf_io_open(&f, exr, NULL, &err), "%s", err.message))
        return;
    const struct hf_io_result r = {.view = 0, .planes = {NULL, data[1], NULL, NULL}};
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

// Reading with OpenImageIO: half a file is an error, and random bytes, which crash some of its readers, do not crash
// the program.
static void test_damaged(const char *name)
{
    const char *path = in_folder("bad"), *target = in_folder("out.exr");
    struct hf_io_error err = {.message = ""};
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
    new_files();
    struct hf_io_error err = {.message = ""};
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
