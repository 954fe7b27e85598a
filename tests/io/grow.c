// SPDX-License-Identifier: BSD-3-Clause
// A data window that grows, and a channel that is added: old samples keep their places, new ones are what the header says, for every storage.
#include "io/tests.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static uint8_t *channel_of(exr_context_t f, int p, const char *name, size_t *size)
{
    const exr_attr_chlist_t *list = NULL;
    CHECK(!exr_get_channels(f, p, &list));
    for (int c = 0; list && c < list->num_channels; c++)
        if (!strcmp(list->entries[c].name.str, name))
            return load_channel(f, p, c, size);
    return NULL;
}

// Sample (x, y) of the old window of w x h, at (dx, dy) in one of nw.
static void compare_grown(const char *name, const uint8_t *old, const uint8_t *new, const struct part *part,
                          const int grow[4], size_t bytes, const void *filler)
{
    const int nw = part->width + grow[0] + grow[2], nh = part->height + grow[1] + grow[3];
    int bad = 0;
    for (int y = 0; y < nh; y++)
        for (int x = 0; x < nw; x++) {
            const int ox = x - grow[0], oy = y - grow[1];
            const int inside = ox >= 0 && oy >= 0 && ox < part->width && oy < part->height;
            const void *want = inside ? old + bytes * (size_t)(oy * part->width + ox) : filler;
            bad += memcmp(new + bytes *(size_t)(y * nw + x), want, bytes) != 0;
        }
    CHECK_MSG(!bad, "%s: %d samples are wrong", name, bad);
}

static const int larger[4] = {5, 3, 40, 2};

static void grow_one(const struct part *parts, const char *compression, const int grow[4])
{
    const char *path = in_folder("small.exr"), *target = in_folder("grown.exr");
    struct hf_io_error err = {.message = ""};
    struct hf_io_file *f;
    CHECK(!make_exr(path, parts, NULL));
    if (!CHECK_MSG(!hf_io_open(&f, path, NULL, &err), "%s", err.message))
        return;
    struct hf_io_box box = hf_io_view(f, 0)->data_window;
    box = (struct hf_io_box){box.x0 - grow[0], box.y0 - grow[1], box.x1 + grow[2], box.y1 + grow[3]};
    const size_t n = (size_t)(box.x1 - box.x0) * (size_t)(box.y1 - box.y0);
    float *plane = allocate(n * sizeof(float)), *guessed = allocate(n * sizeof(float));
    for (size_t i = 0; i < n; i++) {
        plane[i] = 0.25f;
        guessed[i] = (float)i;
    }
    const struct hf_io_result result = {0, {plane, plane, plane, NULL}, guessed};
    const struct hf_io_job job = {
        .path = target, .results = &result, .result_count = 1, .compression = compression, .run = &threads};
    if (grow == larger)
        CHECK_MSG(!hf_io_grow(f, 0, box, 1e10f, &threads, &err), "%s", err.message);
    CHECK_INT(hf_io_view(f, 0)->width, parts[0].width + grow[0] + grow[2]);
    CHECK_MSG(!hf_io_write(f, &job, NULL, &err), "%s", err.message);
    hf_io_close(&f);
    free(plane);

    exr_context_t a, b;
    exr_context_initializer_t init = context();
    exr_attr_box2i_t window, display[2];
    CHECK(!exr_start_read(&a, path, &init) && !exr_start_read(&b, target, &init));
    CHECK(!exr_get_data_window(b, 0, &window));
    CHECK(!exr_get_display_window(a, 0, &display[0]) && !exr_get_display_window(b, 0, &display[1]));
    CHECK(window.min.x == box.x0 && window.min.y == box.y0 && window.max.x == box.x1 - 1 && window.max.y == box.y1 - 1);
    CHECK(!memcmp(&display[0], &display[1], sizeof(display[0])));
    static const float far_away = 1e10f;
    static const uint32_t zero = 0;
    static const struct {
        const char *name;
        size_t bytes;
        const void *filler;
    } channels[] = {{"A", 2, &zero}, {"Z", 4, &far_away}, {"id", 4, &zero}, {"uv.u", 2, &zero}};
    for (size_t i = 0; i < sizeof(channels) / sizeof(channels[0]); i++) {
        size_t size;
        uint8_t *old = channel_of(a, 0, channels[i].name, &size), *new = channel_of(b, 0, channels[i].name, &size);
        if (CHECK(old && new))
            compare_grown(channels[i].name, old, new, &parts[0], grow, channels[i].bytes, channels[i].filler);
        free(old);
        free(new);
    }
    size_t size;
    uint8_t *told = channel_of(b, 0, "guessed", &size);
    CHECK_MSG(told && size == n * sizeof(float) && !memcmp(told, guessed, size), "the channel that is added is lost");
    free(told);
    free(guessed);
    exr_finish(&a);
    exr_finish(&b);
    // It reads as any other file, and its colour is the new one everywhere.
    if (CHECK_MSG(!hf_io_open(&f, target, NULL, &err), "%s", err.message)) {
        struct planes planes = {{allocate(n * sizeof(float)), NULL, NULL, NULL}};
        CHECK_MSG(!hf_io_check_whole(f, &err), "%s", err.message);
        CHECK(!hf_io_read_colour(f, 0, planes.p, &err));
        size_t bad = 0;
        for (size_t i = 0; i < n; i++)
            bad += planes.p[0][i] != 0.25f;
        CHECK_INT(bad, 0);
        free_planes(&planes);
        hf_io_close(&f);
    }
    unlink(target);
}

void test_grow(void)
{
    static const exr_storage_t storages[] = {EXR_STORAGE_SCANLINE, EXR_STORAGE_TILED};
    static const char *const compressions[] = {NULL, NULL, "none", "none", "piz", "piz", "zips", "rle"};
    static const int none[4];
    static const exr_lineorder_t orders[] = {EXR_LINEORDER_INCREASING_Y, EXR_LINEORDER_DECREASING_Y};
    for (int s = 0; s < 2; s++)
        for (int o = 0; o < 2 - s; o++) {
            struct part parts[MAX_PARTS] = {usual_part(storages[s], EXR_COMPRESSION_ZIP, orders[o])};
            for (size_t i = 0; i < sizeof(compressions) / sizeof(*compressions); i++)
                grow_one(parts, compressions[i], i % 2 ? none : larger);
            // With another part after it, whose chunks move.
            parts[0].name = "colour";
            parts[1] = usual_part(EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIPS, EXR_LINEORDER_INCREASING_Y);
            parts[1].name = "other";
            grow_one(parts, NULL, larger);
            grow_one(parts, NULL, none);
        }
    struct part odd[MAX_PARTS] = {usual_part(EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIP, EXR_LINEORDER_INCREASING_Y)};
    odd[0].x = odd[0].y = 0;
    odd[0].width = odd[0].height = 40;
    odd[0].channels[6].sampling = 2;
    const char *path = in_folder("small.exr");
    struct hf_io_error err = {.message = ""};
    struct hf_io_file *f = NULL;
    CHECK(!make_exr(path, odd, NULL));
    if (CHECK_MSG(!hf_io_open(&f, path, NULL, &err), "%s", err.message))
        expect_error(hf_io_grow(f, 0, (struct hf_io_box){-1, -1, 41, 41}, 0, NULL, &err), &err, "subsampled channels");
    hf_io_close(&f);
    unlink(path);
}
