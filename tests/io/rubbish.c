// SPDX-License-Identifier: BSD-3-Clause
// Damaged files, and headers that promise data that is not there.
#include "io/tests.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// Read and write all of a file; nothing may crash, whatever it contains. Returns whether all went well.
bool survive(const char *path, const char *target)
{
    struct hf_io_error err = {.message = ""};
    struct hf_io_file *f;
    bool ok = true;
    if (hf_io_open(&f, path, NULL, &err)) {
        CHECK_MSG(err.message[0] && !strchr(err.message, '\n'), "an error without a sentence");
        return false;
    }
    for (int i = 0; i < hf_io_view_count(f); i++) {
        const struct hf_io_view *v = hf_io_view(f, i);
        const size_t n = (size_t)v->width * (size_t)v->height;
        if (n > 10000000)  // a corrupt size that the file could just hold
            continue;
        struct planes planes = {{0}};
        for (int k = 0; k < 4; k++)
            planes.p[k] = allocate(n * sizeof(float));
        ok &= !hf_io_read_colour(f, i, planes.p, &err);
        ok &= v->depth_part >= 0 && !hf_io_read_depth(f, i, planes.p[3], &err);
        const struct hf_io_result r = {.view = i, .planes = {planes.p[0], NULL, NULL, NULL}};
        const struct hf_io_job job = {.path = target, .results = &r, .result_count = 1};
        ok &= !hf_io_write(f, &job, NULL, &err);
        free_planes(&planes);
    }
    hf_io_close(&f);
    return ok;
}

void test_rubbish(const char *path)
{
    const char *bad = in_folder("bad.exr"), *target = in_folder("out.exr");
    size_t size;
    uint8_t *data = slurp(path, &size), *copy = allocate(size);
    int good = 0, left;
    unlink(target);
    unlink(bad);
    left = files_in(folder);
    CHECK(size > 100);
    for (size_t n = 0; n < size; n += n < 1500 ? 1 : 7) {
        spill(bad, data, n);
        good += survive(bad, target);
    }
    CHECK_MSG(!good, "%s: %d truncations went unnoticed", path, good);
    for (int i = 0; i < 250 && size > 100; i++) {
        memcpy(copy, data, size);
        for (uint32_t k = 0, n = 1 + rnd() % 4; k < n; k++)
            copy[rnd() % (i & 1 ? size : size < 900 ? size : 900)] = (uint8_t)rnd();
        spill(bad, copy, size);
        survive(bad, target);
    }
    unlink(bad);
    unlink(target);
    CHECK_INT(files_in(folder), left);
    free(data);
    free(copy);
}

// A header that promises 65536 x 65536, or 2^30 x 1, pixels in a file of a few hundred bytes.
void test_huge_header(void)
{
    const struct part parts[MAX_PARTS] = {
        usual_part(EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIP, EXR_LINEORDER_INCREASING_Y)};
    const char *path = in_folder("huge.exr");
    struct hf_io_error err = {.message = ""};
    size_t size;
    CHECK(!make_exr(path, parts, NULL));
    uint8_t *data = slurp(path, &size);
    uint8_t *window = memmem(data, size, "dataWindow\0box2i", 16);
    static const int sizes[][2] = {{65535, 65535}, {1 << 30, 0}, {INT32_MAX, INT32_MAX}, {65535, 100}, {0, 65535}};
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]) && CHECK(window != NULL); i++) {
        int32_t box[4] = {0, 0, sizes[i][0], sizes[i][1]};
        memcpy(window + 21, box, sizeof(box));
        spill(path, data, size);
        expect_error(rewrite(path, in_folder("none.exr"), &err), &err, "huge.exr: ");
    }
    free(data);
}

// The chunk table is found by a number that points to the end of a table beginning there. Swapping its first two
// entries makes each point to another row's chunk, which is intact.
void test_swapped_chunks(void)
{
    const struct part parts[MAX_PARTS] = {
        usual_part(EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIPS, EXR_LINEORDER_INCREASING_Y)};
    const char *path = in_folder("swapped.exr");
    struct hf_io_error err = {.message = ""};
    size_t size, at = 0;
    CHECK(!make_exr(path, parts, NULL));
    uint8_t *data = slurp(path, &size);
    uint64_t entry[2] = {0, 0};
    for (; at + 16 < size; at++) {
        memcpy(entry, data + at, sizeof(entry));
        if (entry[0] > at + 8 && entry[0] < size && (entry[0] - at) % 8 == 0 && entry[1] > entry[0] && entry[1] < size)
            break;
    }
    if (CHECK(at + 16 < size)) {
        memcpy(data + at, &entry[1], 8);
        memcpy(data + at + 8, &entry[0], 8);
        spill(path, data, size);
        expect_error(rewrite(path, in_folder("none.exr"), &err), &err, "swapped.exr: ");
    }
    free(data);
}

// A file that is opened while another program still writes it: it is cut at each length, opened, completed, and read.
// Chunks that were not there when it was opened count as missing, and take no memory.
void test_growing(void)
{
    const struct part parts[MAX_PARTS] = {
        usual_part(EXR_STORAGE_SCANLINE, EXR_COMPRESSION_NONE, EXR_LINEORDER_INCREASING_Y)};
    const char *path = in_folder("growing.exr");
    float planes[5][37 * 41];
    int refused = 0, fetched = 0;
    size_t size;
    CHECK(!make_exr(path, parts, NULL));
    uint8_t *data = slurp(path, &size);
    for (size_t n = 64; n < size; n += 64) {
        struct hf_io_file *f;
        struct hf_io_error err = {.message = ""};
        spill(path, data, n);
        if (hf_io_open(&f, path, NULL, &err))
            continue;  // not even the header and the tables
        const struct hf_io_want want = {0, {planes[0], planes[1], planes[2], planes[3]}, planes[4]};
        spill(path, data, size);
        refused += hf_io_fetch(f, &want, 1, &err) || hf_io_decode(f, &want, 1, NULL, &err);
        CHECK_MSG(strstr(err.message, "growing.exr: ") != NULL, "cut at %zu: %s", n, err.message);
        fetched++;
        hf_io_close(&f);
    }
    CHECK(fetched > 10);
    CHECK_INT(refused, fetched);
    free(data);
}

// Headers that Core accepts and other readers do not, and files that are recognised as what they are.
void test_claims(void)
{
    struct part parts[MAX_PARTS] = {usual_part(EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIP, EXR_LINEORDER_INCREASING_Y)};
    const char *path = in_folder("claim.exr"), *target = in_folder("none.exr");
    static const char *const types[] = {"compression\0compression", "lineOrder\0lineOrder", "dataWindow\0box2i"};
    static const size_t lengths[] = {23, 19, 16};
    struct hf_io_error err = {.message = ""};
    size_t size;
    CHECK(!make_exr(path, parts, NULL));
    uint8_t *data = slurp(path, &size);
    for (int i = 0; i < 3; i++) {
        uint8_t *at = memmem(data, size, types[i], lengths[i]);
        if (!CHECK(at != NULL))
            break;
        at[lengths[i] - 1] ^= 1;
        spill(path, data, size);
        expect_error(rewrite(path, target, &err), &err, "claim.exr: truncated or corrupt");
        at[lengths[i] - 1] ^= 1;
    }
    free(data);
    parts[0] = (struct part){.storage = EXR_STORAGE_DEEP_SCANLINE, .width = 6, .height = 5};
    parts[0].channels[0] = (struct channel){"A", EXR_PIXEL_HALF, 0};
    parts[0].channels[1] = (struct channel){"Z", EXR_PIXEL_FLOAT, 0};
    CHECK(!make_exr(path, parts, NULL));
    expect_error(rewrite(path, target, &err), &err, "deep picture");
    CHECK(access(target, F_OK));
}
