// SPDX-License-Identifier: BSD-3-Clause
// Halves, ZIP, the stages of a frame, files that share a helper process.
#include "io/tests.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <libdeflate.h>

#include "tools/io/exr/zip.h"
#include "tools/io/half.h"

void test_half(void)
{
    int bad = 0;
    uint64_t clamped = 0;
    for (uint32_t h = 0; h < 65536; h++) {
        const float f = hf_io_from_half((uint16_t)h);
        if ((h & 0x7c00) == 0x7c00)
            bad += (h & 0x3ff) ? !isnan(f) : !isinf(f);
        else
            bad += hf_io_to_half(f, &clamped) != h;
    }
    CHECK_INT(bad, 0);
    CHECK_INT(clamped, 0);
    for (int i = 0; i < 200000; i++) {  // rounded to nearest, ties to even: no other half is nearer
        const float f = ldexpf((float)(rnd() & 0xffffff) + 0.5f, (int)(rnd() % 40) - 50);
        const uint16_t h = hf_io_to_half(f, &clamped);
        const float own = fabsf(hf_io_from_half(h) - f), up = fabsf(hf_io_from_half((uint16_t)(h + 1)) - f);
        const float down = h ? fabsf(hf_io_from_half((uint16_t)(h - 1)) - f) : INFINITY;
        bad += own > up || own > down || ((own == up || own == down) && (h & 1));
    }
    CHECK_INT(bad, 0);
    CHECK_INT(clamped, 0);
    CHECK(hf_io_to_half(65504.0f, &clamped) == 0x7bff && clamped == 0);
    CHECK(hf_io_to_half(-INFINITY, &clamped) == 0xfbff && clamped == 1);
    CHECK(hf_io_to_half(NAN, &clamped) == 0 && clamped == 1);
}

// Rows of halves compared with single ones, from any address, on any processor.
void test_half_rows(void)
{
    static float floats[65536 + 16], want;
    static uint8_t halves[2 * 65536 + 1];
    uint64_t clamped = 0, expected = 0;
    int bad = 0;
    for (uint32_t h = 0; h < 65536; h++)
        memcpy(halves + 1 + 2 * h, &(uint16_t){(uint16_t)h}, 2);
    hf_io_halves_to_floats(floats, halves + 1, 65536);
    for (uint32_t h = 0; h < 65536; h++) {
        want = hf_io_from_half((uint16_t)h);
        bad += isnan(want) ? !isnan(floats[h]) : hf_bits(floats[h]) != hf_bits(want);
    }
    for (int i = 0; i < 65536; i++)
        floats[i] = hf_from_bits(rnd() << 1 ^ rnd());
    floats[1] = NAN, floats[2] = INFINITY, floats[3] = -65504.0f, floats[4] = 65504.1f, floats[5] = -0.0f;
    for (int n = 0; n < 20; n++) {
        const int count = n < 19 ? n : 65536;
        clamped = expected = 0;
        hf_io_floats_to_halves(halves + 1, floats, (size_t)count, &clamped);
        for (int i = 0; i < count; i++) {
            uint16_t got;
            memcpy(&got, halves + 1 + 2 * i, 2);
            bad += got != hf_io_to_half(floats[i], &expected);
        }
        CHECK_INT(clamped, expected);
    }
    CHECK_INT(bad, 0);
}

// Noisy floats around 1: our chunks are shorter than libdeflate's own, and decode to the same floats. Completely random
// bytes do not shrink.
static void noise_zipped(void)
{
    enum { N = 160000 };
    struct libdeflate_compressor *c = libdeflate_alloc_compressor(4);
    struct libdeflate_decompressor *d = libdeflate_alloc_decompressor();
    uint8_t *from = malloc(N), *scratch = malloc(2 * N), *to = malloc(N), *back = malloc(N);
    for (size_t i = 0; i < N; i += 4) {
        const float unit = 1 / 2147483648.0f;
        const float v = 1 + 0.6f * ((float)rnd() * unit + (float)rnd() * unit + (float)rnd() * unit - 1.5f);
        memcpy(from + i, &v, 4);
    }
    hf_exr_split(scratch, scratch + N, from, N);
    const size_t alone = libdeflate_zlib_compress(c, scratch, N, to, N), packed = hf_exr_zip(c, to, from, N, scratch);
    CHECK_MSG(packed && packed < alone, "%zu of %zu bytes, alone %zu", packed, (size_t)N, alone);
    CHECK_INT(hf_exr_unzip(d, back, N, to, packed, scratch), 0);
    CHECK(!memcmp(back, from, N));
    for (size_t i = 0; i < N; i++)
        from[i] = (uint8_t)(rnd() >> 7);
    CHECK_INT(hf_exr_zip(c, to, from, N, scratch), 0);
    libdeflate_free_compressor(c);
    libdeflate_free_decompressor(d);
    free(from);
    free(scratch);
    free(to);
    free(back);
}

// Bytes sorted and restored; and the same done byte by byte.
void test_zip(void)
{
    enum { N = 300 };
    uint8_t from[N], sorted[N], scratch[N], back[N];
    int bad = 0;
    for (size_t n = 1; n < N; n++) {
        for (size_t i = 0; i < n; i++)
            from[i] = (uint8_t)rnd();
        hf_exr_split(sorted, scratch, from, n);
        for (size_t i = 0; i < n; i++) {
            const size_t half = (n + 1) / 2;
            const uint8_t own = from[i < half ? 2 * i : 2 * (i - half) + 1];
            const uint8_t before = !i ? 128 : from[i - 1 < half ? 2 * (i - 1) : 2 * (i - 1 - half) + 1];
            bad += i ? sorted[i] != (uint8_t)(own - before + 128) : sorted[i] != own;
        }
        hf_exr_join(back, sorted, n);
        bad += memcmp(back, from, n) != 0;
    }
    CHECK_INT(bad, 0);
    noise_zipped();
}

// Fetched and decoded on several threads at once, each chunk once: the result equals that of view by view. Then encoded
// twice from one decoding. What is written back unchanged equals the source, byte for byte, whichever program
// compressed it.
void test_stages(void)
{
    const char *path = in_folder("stages.exr"), *target = in_folder("out.exr");
    for (int c = EXR_COMPRESSION_NONE; c <= EXR_COMPRESSION_PIZ; c++) {
        struct hf_io_file *f = NULL;
        struct hf_io_error err = {.message = ""};
        struct part parts[MAX_PARTS] = {usual_part(c % 2 ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE,
                                                   (exr_compression_t)c, EXR_LINEORDER_INCREASING_Y)};
        float planes[5][37 * 41], own[5][37 * 41];
        CHECK(!make_exr(path, parts, NULL));
        if (!CHECK_MSG(!hf_io_open(&f, path, NULL, &err), "%s", err.message))
            return;
        const struct hf_io_want want = {0, {planes[0], planes[1], planes[2], planes[3]}, planes[4]};
        CHECK_MSG(!hf_io_fetch(f, &want, 1, &err), "%s", err.message);
        CHECK_MSG(!hf_io_decode(f, &want, 1, &threads, &err), "%s", err.message);
        const struct hf_io_result same = {.view = 0, .planes = {planes[0], planes[1], planes[2], planes[3]}};
        const struct hf_io_job job = {.path = target, .results = &same, .result_count = 1, .run = &threads};
        CHECK_MSG(!hf_io_write(f, &job, NULL, &err), "%s", err.message);
        hf_io_close(&f);
        size_t a, b;
        uint8_t *before = slurp(path, &a), *after = slurp(target, &b);
        CHECK_MSG(a == b && !memcmp(before, after, a), "compression %d: unchanged colours change the file", c);
        free(before);
        free(after);
        CHECK(!hf_io_open(&f, path, NULL, &err));
        float *const colour[4] = {own[0], own[1], own[2], own[3]};
        CHECK_MSG(!hf_io_read_colour(f, 0, (float **)colour, &err), "%s", err.message);
        CHECK_MSG(!hf_io_read_depth(f, 0, own[4], &err), "%s", err.message);
        CHECK(!memcmp(planes, own, sizeof(own)));
        hf_io_close(&f);
    }
}

void test_shared(void)
{
    static const char *const names[] = {"multipart.0001", "multipart.0002", "singlepart.0001", "singlepart.0004"};
    const char *shared = getenv("HF_SHARED");
    for (int i = 0; shared && i < 4; i++) {
        char path[1000];
        snprintf(path, sizeof(path), "%s/images/beachball/%s.exr", shared, names[i]);
        if (access(path, R_OK)) {
            printf("skipped: %s is not there\n", path);
            continue;
        }
        struct hf_io_file *f = open_or_complain(path, NULL, 2);
        const bool multi = names[i][0] == 'm';
        if (f) {
            check_view(f, 0, "right", 0, "R", multi ? 5 : 0, "Z");
            check_view(f, 1, "left", multi ? 4 : 0, multi ? "R" : "left.R", multi ? 1 : 0, multi ? "Z" : "left.Z");
        }
        hf_io_close(&f);
        round_trip(path, NULL, true, true);
    }
}
