// SPDX-License-Identifier: BSD-3-Clause
// Which channels are a picture, and which one is its depth: views, parts, layers, names.
#include "io/tests.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void test_single_part_views(void)
{
    const exr_pixel_type_t h = EXR_PIXEL_HALF;
    const char *path = in_folder("views.exr");
    const struct part parts[MAX_PARTS] = {{.width = 9,
                                           .height = 5,
                                           .compression = EXR_COMPRESSION_ZIP,
                                           .channels = {{"A", h, 0},
                                                        {"B", h, 0},
                                                        {"G", h, 0},
                                                        {"R", h, 0},
                                                        {"Z", h, 0},
                                                        {"forward.left.u", h, 0},
                                                        {"forward.right.R", h, 0},
                                                        {"left.B", h, 0},
                                                        {"left.G", h, 0},
                                                        {"left.R", h, 0},
                                                        {"left.Z", h, 0},
                                                        {"left.my", h, 0},
                                                        {"my", h, 0}}}};
    CHECK(!make_exr(path, parts, "right\0left"));
    struct hf_io_file *f = open_or_complain(path, NULL, 2);
    if (f) {
        const struct hf_io_view *v = hf_io_view(f, 0);
        check_view(f, 0, "right", 0, "R", 0, "Z");
        check_view(f, 1, "left", 0, "left.R", 0, "left.Z");
        CHECK(v->camera.focus == 3.5f && v->camera.f_number == 2.8f && isnan(v->camera.focal_length_mm));
        CHECK(v->pixel_aspect == 1.5f && v->screen_width == 0.75f && v->screen_center_y == -0.5f);
        CHECK(v->display_window.x0 == -2 && v->display_window.x1 == 21 && v->display_window.y1 == 31);
        CHECK(!strcmp(hf_io_view(f, 1)->colour[3], ""));
    }
    hf_io_close(&f);
    f = open_or_complain(path, "my", 2);
    if (f)
        check_view(f, 1, "left", 0, "left.R", 0, "left.my");
    hf_io_close(&f);
    f = open_or_complain(path, "nothing", 2);
    if (f) {
        struct hf_io_error err = {.message = ""};
        float depth[45];
        CHECK_INT(hf_io_view(f, 0)->depth_part, -1);
        CHECK(hf_io_read_depth(f, 0, depth, &err) == -1 && strstr(err.message, "forward.left.u"));
    }
    hf_io_close(&f);
    round_trip(path, NULL, true, true);
    // The same depth as a file of its own.
    f = open_or_complain(path, NULL, 2);
    for (int i = 0; i < 2 && f; i++) {
        struct hf_io_error err = {.message = ""};
        float depth[45], own[45];
        struct hf_io_map found;
        CHECK_MSG(!hf_io_read_depth(f, i, depth, &err), "%s", err.message);
        CHECK_MSG(!hf_io_read_depth_file(path, NULL, HF_IO_EDGES_KEEP, hf_io_view(f, i), NULL, own, &found, &err), "%s",
                  err.message);
        CHECK(!memcmp(depth, own, sizeof(own)));
    }
    hf_io_close(&f);
}

// Stereo in parts, depth with its own windows, and a deep part that is not read.
void test_parts(void)
{
    const exr_pixel_type_t h = EXR_PIXEL_HALF, fl = EXR_PIXEL_FLOAT;
    const char *path = in_folder("parts.exr");
    const struct part parts[MAX_PARTS] = {
        {.name = "rgb_r",
         .view = "right",
         .x = 4,
         .y = 2,
         .width = 20,
         .height = 20,
         .compression = EXR_COMPRESSION_ZIP,
         .channels = {{"B", h, 0}, {"G", h, 0}, {"R", h, 0}, {"half", h, 2}}},
        {.name = "depth_l",
         .view = "left",
         .x = 6,
         .y = 3,
         .width = 10,
         .height = 30,
         .compression = EXR_COMPRESSION_PIZ,
         .channels = {{"Z", fl, 0}}},
        {.name = "deep", .storage = EXR_STORAGE_DEEP_SCANLINE, .width = 6, .height = 5, .channels = {{"Z", fl, 0}}},
        {.name = "rgb_l",
         .view = "left",
         .x = 5,
         .y = 2,
         .width = 20,
         .height = 19,
         .storage = EXR_STORAGE_TILED,
         .compression = EXR_COMPRESSION_RLE,
         .channels = {{"B", h, 0}, {"G", h, 0}, {"R", h, 0}}},
        {.name = "depth_r",
         .view = "right",
         .x = 4,
         .y = 2,
         .width = 20,
         .height = 20,
         .order = EXR_LINEORDER_DECREASING_Y,
         .compression = EXR_COMPRESSION_ZIPS,
         .channels = {{"Z", fl, 0}}},
        {.name = "motion", .width = 3, .height = 3, .channels = {{"forward.left.u", h, 0}}},
    };
    CHECK(!make_exr(path, parts, NULL));
    struct hf_io_file *f = open_or_complain(path, NULL, 2);
    if (f) {
        struct hf_io_error err = {.message = ""};
        float depth[380];
        check_view(f, 0, "right", 0, "R", 4, "Z");
        check_view(f, 1, "left", 3, "R", 1, "Z");
        CHECK_MSG(!hf_io_read_depth(f, 1, depth, &err), "%s", err.message);
        for (int i = 0; i < 380; i++) {
            const int x = 5 + i % 20, y = 2 + i / 20;
            CHECK(isinf(depth[i]) == !(x >= 6 && x < 16 && y >= 3));
        }
    }
    hf_io_close(&f);
    round_trip(path, NULL, true, true);
    round_trip(path, "zips", true, true);
    round_trip(path, "none", true, true);
}

// One part of half channels with these names.
static struct hf_io_file *try_names(const char *const names[], int views, struct hf_io_error *err)
{
    const char *path = in_folder("names.exr");
    struct part parts[MAX_PARTS] = {{.width = 4, .height = 3}};
    struct hf_io_file *f = NULL;
    for (int c = 0; names[c]; c++)
        parts[0].channels[c] = (struct channel){names[c], EXR_PIXEL_HALF, 0};
    CHECK(!make_exr(path, parts, NULL));
    const int status = hf_io_open(&f, path, NULL, err);
    CHECK_MSG(views ? status == 0 && hf_io_view_count(f) == views : status == -1, "%s...: %s", names[0], err->message);
    return f;
}

void test_names(void)
{
    static const char *const tries[][12] = {
        // the channels; the expected red channel and depth
        {"Y", "Z", 0},
        {"B", "G", "R", "depth.Z", 0},
        {"B", "G", "R", "SceneDepth", 0},
        {"B", "G", "R", "depth1", "depth2", 0},
        {"VL.Combined.R", "VL.Combined.G", "VL.Combined.B", "VL.Depth.Z", "VL.Diff.R", "VL.Diff.G", "VL.Diff.B", 0},
        {"beauty.R", "beauty.G", "beauty.B", "beauty.Z", 0},
        {"r", "g", "b", "a", "z", 0},
        {"red", "green", "blue", "Pz", 0},
        {"B", "G", "R", "depth.R", "depth.G", "depth.B", 0},
        {"B", "G", "R", "VRayZDepth.R", "VRayZDepth.G", "VRayZDepth.B", 0},
        {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B", "ViewLayer.Depth.V", 0},
        {"Fg.Combined.R", "Fg.Combined.G", "Fg.Combined.B", "Fg.Depth.Z", "Vl.Combined.R", "Vl.Combined.G",
         "Vl.Combined.B", "Vl.Depth.Z", 0},
        {"Fg.Combined.R", "Fg.Combined.G", "Fg.Combined.B", "Vl.Combined.R", "Vl.Combined.G", "Vl.Combined.B",
         "Vl.Depth.Z", 0},
        {"Ci.r", "Ci.g", "Ci.b", "Ci.a", "zfiltered", 0},
    };
    static const char *const found[][2] = {{"Y", "Z"},
                                           {"R", "depth.Z"},
                                           {"R", "SceneDepth"},
                                           {"R", ""},
                                           {"VL.Combined.R", "VL.Depth.Z"},
                                           {"beauty.R", "beauty.Z"},
                                           {"r", "z"},
                                           {"red", "Pz"},
                                           {"R", "depth.R"},
                                           {"R", "VRayZDepth.R"},
                                           {"ViewLayer.Combined.R", "ViewLayer.Depth.V"},
                                           {"Fg.Combined.R", "Fg.Depth.Z"},
                                           {"Vl.Combined.R", "Vl.Depth.Z"},
                                           {"Ci.r", "zfiltered"}};
    for (size_t i = 0; i < sizeof(found) / sizeof(found[0]); i++) {
        struct hf_io_error err = {.message = ""};
        struct hf_io_file *f = try_names(tries[i], 1, &err);
        if (f)
            check_view(f, 0, "", 0, found[i][0], found[i][1][0] ? 0 : -1, found[i][1]);
        hf_io_close(&f);
        if (f || i == 0)
            round_trip(in_folder("names.exr"), NULL, true, i != 0);
    }
    static const char *const none[][8] = {{"G", "R", "Z", 0}, {"a.R", "a.G", "a.B", "b.R", "b.G", "b.B", 0}};
    for (size_t i = 0; i < 2; i++) {
        struct hf_io_error err = {.message = ""};
        struct hf_io_file *f = try_names(none[i], 0, &err);
        CHECK_MSG(strstr(err.message, i ? "choose with --layer: a, b" : "G, R, Z"), "%s", err.message);
        hf_io_close(&f);
    }
}

// Check which layers a choice finds, as "view:layer:red:depth" separated by blanks; or the error.
static void expect_layers(const char *path, const char *wanted, const char *want)
{
    struct hf_io_error err = {.message = ""};
    struct hf_io_file *f = NULL;
    char got[1024] = "";
    const struct hf_io_choice choice = {.layer = wanted};
    if (hf_io_open(&f, path, &choice, &err)) {
        CHECK_MSG(strstr(err.message, want) != NULL, "%s: %s", wanted, err.message);
        return;
    }
    for (int i = 0; i < hf_io_view_count(f); i++) {
        const struct hf_io_view *v = hf_io_view(f, i);
        const size_t n = strlen(got);
        snprintf(got + n, sizeof(got) - n, "%s%s:%s:%s:%s", i ? " " : "", v->name, v->layer, v->colour[0], v->depth);
    }
    CHECK_MSG(!strcmp(got, want), "%s: %s", wanted ? wanted : "no choice", got);
    hf_io_close(&f);
}

static void make_names(const char *path, const char *const names[], const char *views)
{
    struct part parts[MAX_PARTS] = {{.width = 4, .height = 3}};
    for (int c = 0; names[c]; c++)
        parts[0].channels[c] = (struct channel){names[c], EXR_PIXEL_HALF, 0};
    CHECK(!make_exr(path, parts, views));
}

// Every layer has its own depth, and no other's.
void test_layers(void)
{
    static const char *const blender[] = {"Bg.Combined.R",    "Bg.Combined.G",    "Bg.Combined.B",
                                          "CryptoObject00.r", "CryptoObject00.g", "CryptoObject00.b",
                                          "Fg.Combined.R",    "Fg.Combined.G",    "Fg.Combined.B",
                                          "Fg.Depth.Z",       "Fg.Glow.R",        "Fg.Glow.G",
                                          "Fg.Glow.B",        "Vl.Combined.R",    "Vl.Combined.G",
                                          "Vl.Combined.B",    "Vl.Depth.Z",       "Vl.Normal.R",
                                          "Vl.Normal.G",      "Vl.Normal.B",      NULL};
    const char *path = in_folder("layers.exr");
    make_names(path, blender, NULL);
    expect_layers(path, "Fg", ":Fg.Combined:Fg.Combined.R:Fg.Depth.Z");
    expect_layers(path, "vl", ":Vl.Combined:Vl.Combined.R:Vl.Depth.Z");
    expect_layers(path, "Fg.Glow", ":Fg.Glow:Fg.Glow.R:Fg.Depth.Z");
    expect_layers(path, "Glow", ":Fg.Glow:Fg.Glow.R:Fg.Depth.Z");
    expect_layers(path, "Vl,Fg.Glow,Vl", ":Vl.Combined:Vl.Combined.R:Vl.Depth.Z :Fg.Glow:Fg.Glow.R:Fg.Depth.Z");
    expect_layers(path, "Bg", ":Bg.Combined:Bg.Combined.R:");
    expect_layers(path, "all",
                  ":Fg.Combined:Fg.Combined.R:Fg.Depth.Z :Bg.Combined:Bg.Combined.R: "
                  ":Fg.Glow:Fg.Glow.R:Fg.Depth.Z :Vl.Combined:Vl.Combined.R:Vl.Depth.Z");
    expect_layers(path, "Vl.Combned", "did you mean Vl.Combined?");
    expect_layers(path, "Foo", "the layers are: Bg.Combined, CryptoObject00, Fg.Combined, Fg.Glow");
    expect_layers(path, "", "there is no layer");

    static const char *const plain[] = {"A",      "B",      "G",   "R",   "Z",   "spec.B",
                                        "spec.G", "spec.R", "N.B", "N.G", "N.R", NULL};
    make_names(path, plain, NULL);
    expect_layers(path, NULL, "::R:Z");
    expect_layers(path, "rgb", "::R:Z");
    expect_layers(path, "spec", ":spec:spec.R:Z");
    expect_layers(path, "all", "::R:Z :spec:spec.R:Z");

    static const char *const stereo[] = {"V.Combined.left.B",
                                         "V.Combined.left.G",
                                         "V.Combined.left.R",
                                         "V.Depth.left.Z",
                                         "W.Combined.left.B",
                                         "W.Combined.left.G",
                                         "W.Combined.left.R",
                                         "W.Depth.left.Z",
                                         "V.Combined.right.B",
                                         "V.Combined.right.G",
                                         "V.Combined.right.R",
                                         "V.Depth.right.Z",
                                         "W.Combined.right.B",
                                         "W.Combined.right.G",
                                         "W.Combined.right.R",
                                         "W.Depth.right.Z",
                                         NULL};
    make_names(path, stereo, "left\0right");
    expect_layers(path, "W",
                  "left:W.Combined:W.Combined.left.R:W.Depth.left.Z "
                  "right:W.Combined:W.Combined.right.R:W.Depth.right.Z");

    const exr_pixel_type_t h = EXR_PIXEL_HALF;
    const struct part parts[MAX_PARTS] = {
        {.name = "bg.rgba", .width = 4, .height = 3, .channels = {{"B", h, 0}, {"G", h, 0}, {"R", h, 0}}},
        {.name = "bg.depth", .width = 4, .height = 3, .channels = {{"Z", h, 0}}},
        {.name = "fg.rgba", .width = 4, .height = 3, .channels = {{"B", h, 0}, {"G", h, 0}, {"R", h, 0}}},
        {.name = "fg.depth", .width = 4, .height = 3, .channels = {{"Z", h, 0}}},
        {.name = "mg.rgba", .width = 4, .height = 3, .channels = {{"B", h, 0}, {"G", h, 0}, {"R", h, 0}}},
    };
    CHECK(!make_exr(path, parts, NULL));
    struct hf_io_file *f = NULL;
    struct hf_io_error err = {.message = ""};
    if (CHECK_MSG(!hf_io_open(&f, path, &(struct hf_io_choice){.layer = "all"}, &err), "%s", err.message) &&
        CHECK_INT(hf_io_view_count(f), 3)) {
        CHECK_INT(hf_io_view(f, 0)->depth_part, 1);
        CHECK_INT(hf_io_view(f, 1)->depth_part, 3);
        CHECK_INT(hf_io_view(f, 2)->depth_part, -1);
    }
    hf_io_close(&f);
    expect_layers(path, "fg", ":fg.rgba:R:Z");
    unlink(path);
}
