// SPDX-License-Identifier: BSD-3-Clause
// The picture files of the programs: makes small EXR files with OpenEXRCore, sends them through hf_io_write and
// compares what comes out with what went in, channel by channel and byte by byte; then feeds it rubbish.
// HF_SHARED=DIR also tries the stereo pictures in DIR/images/beachball; HF_SEED=N makes other rubbish.
#include <math.h>
#include <signal.h>
#include <sys/resource.h>

#include "io/exr/zip.h"
#include "io/io_files.h"

// ---- round trips ----

static struct hf_io_run threads;  // on which round trips are written and read

// New colours: some do not fit a half.
static float new_value(size_t i, int k)
{
    if (i % 17 == 3)
        return k == 1 ? -1e6f : 70000.0f;
    return (float)(i % 300) * 0.25f + (float)k;
}

struct planes {
    float *p[4];
};

static struct planes make_planes(const struct hf_io_view *v, int *too_large)
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

static void free_planes(struct planes *planes)
{
    for (int k = 0; k < 4; k++)
        free(planes->p[k]);
}

// What was written is what is read: exactly for lossless floats, clamped and rounded for halves.
static void check_written(const char *path, const struct hf_io_file *source, const struct hf_io_result *r, int n,
                          bool half)
{
    struct hf_io_file *f;
    struct hf_io_error err = {""};
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

// Write new colours for all views of a file, then see that nothing else changed.
static void round_trip(const char *path, const char *compression, bool half, bool exact)
{
    const char *target = in_folder("out.exr");
    struct hf_io_result results[4];
    struct planes planes[4];
    struct hf_io_file *f;
    struct hf_io_error err = {""};
    struct hf_io_written written;
    int too_large = 0;
    if (!CHECK_MSG(!hf_io_open(&f, path, NULL, &err), "%s", err.message))
        return;
    const int n = hf_io_view_count(f);
    for (int i = 0; i < n; i++) {
        planes[i] = make_planes(hf_io_view(f, i), &too_large);
        results[i] = (struct hf_io_result){i, {planes[i].p[0], planes[i].p[1], planes[i].p[2], NULL}};
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

// What is said about writing new red alone.
static const char *note_of(const char *path, const char *compression)
{
    static struct hf_io_written written;
    struct hf_io_error err = {""};
    struct hf_io_file *f;
    int ignored = 0;
    if (!CHECK_MSG(!hf_io_open(&f, path, NULL, &err), "%s", err.message))
        return "";
    struct planes planes = make_planes(hf_io_view(f, 0), &ignored);
    const struct hf_io_result r = {0, {planes.p[0], planes.p[1], planes.p[2], NULL}};
    const struct hf_io_job job = {
        .path = in_folder("note.exr"), .results = &r, .result_count = 1, .compression = compression};
    CHECK_MSG(!hf_io_write(f, &job, &written, &err), "%s", err.message);
    unlink(job.path);
    free_planes(&planes);
    hf_io_close(&f);
    return written.note;
}

static const struct channel usual[] = {
    {"A", EXR_PIXEL_HALF, 0},  {"B", EXR_PIXEL_HALF, 0},  {"G", EXR_PIXEL_HALF, 0},    {"R", EXR_PIXEL_HALF, 0},
    {"Z", EXR_PIXEL_FLOAT, 0}, {"id", EXR_PIXEL_UINT, 0}, {"uv.u", EXR_PIXEL_HALF, 0},
};

static struct part usual_part(exr_storage_t storage, exr_compression_t compression, exr_lineorder_t order)
{
    struct part p = {
        .storage = storage, .compression = compression, .order = order, .x = -3, .y = -7, .width = 37, .height = 41};
    memcpy(p.channels, usual, sizeof(usual));
    return p;
}

static void test_compressions(void)
{
    static const char *const names[] = {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"};
    const char *path = in_folder("a.exr");
    for (int c = 0; c <= EXR_COMPRESSION_B44A; c++) {
        for (int tiled = 0; tiled < 2; tiled++) {
            for (int order = 0; order < 2; order++) {
                const struct part parts[MAX_PARTS] = {usual_part(tiled ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE,
                                                                 (exr_compression_t)c, (exr_lineorder_t)order)};
                const int lines = c <= EXR_COMPRESSION_ZIPS                                ? 1
                                  : c == EXR_COMPRESSION_ZIP || c == EXR_COMPRESSION_PXR24 ? 16
                                                                                           : 32;
                const int chunks = tiled ? 5 * 9 : 40 / lines + 1;
                if (tiled && lossy((exr_compression_t)c))
                    continue;  // Core 3.1 writes small B44 tiles that it does not read
                CHECK_MSG(!make_exr(path, parts, NULL), "cannot make %s", names[c]);
                if (order)
                    turn_round(path, chunks);
                round_trip(path, NULL, true, c <= EXR_COMPRESSION_PXR24);
                CHECK(runs_backwards(in_folder("out.exr"), chunks) == (order == 1));
            }
        }
    }
    for (int tiled = 0; tiled < 2; tiled++) {
        struct part parts[MAX_PARTS] = {usual_part(tiled ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE,
                                                   EXR_COMPRESSION_ZIP, EXR_LINEORDER_INCREASING_Y)};
        CHECK(!make_exr(path, parts, NULL));
        for (int c = 0; c < (hf_io_has_oiio() ? 10 : 8); c++) {
            round_trip(path, names[c], true, c <= EXR_COMPRESSION_PXR24);
            if (c < 8)
                continue;
            // Channels that DWA wears out and nobody asked to change are told; those it keeps (Z, id, u) are not.
            CHECK_MSG(!note_of(path, names[c])[0], "%s: %s", names[c], note_of(path, names[c]));
            // From DWA to itself and back: what Core cannot read, OpenImageIO must.
            rename(in_folder("out.exr"), in_folder("dwa.exr"));
            round_trip(in_folder("dwa.exr"), NULL, true, false);
            round_trip(in_folder("dwa.exr"), "zip", true, true);
        }
        for (int k = 0; k < 4; k++)
            parts[0].channels[k].type = EXR_PIXEL_FLOAT;
        CHECK(!make_exr(path, parts, NULL));
        round_trip(path, NULL, false, true);
        parts[0].channels[6] = (struct channel){"x.R", EXR_PIXEL_HALF, 0};
        CHECK(!make_exr(path, parts, NULL));
        CHECK(!note_of(path, "piz")[0] && strstr(note_of(path, "b44"), "1 channel besides the colours (x.R)"));
        CHECK(!hf_io_has_oiio() || strstr(note_of(path, "dwaa"), "(x.R) went through dwaa a second time"));
        // B44 leaves floats alone: chunks that do not shrink.
        memset(parts[0].channels + 5, 0, 2 * sizeof(parts[0].channels[0]));
        CHECK(!make_exr(path, parts, NULL));
        round_trip(path, "b44", false, true);
    }
}

static struct hf_io_file *open_or_complain(const char *path, const char *depth, int views)
{
    struct hf_io_file *f = NULL;
    struct hf_io_error err = {""};
    CHECK_MSG(!hf_io_open(&f, path, depth, &err), "%s", err.message);
    if (f && !CHECK_INT(hf_io_view_count(f), views))
        hf_io_close(&f);
    return f;
}

static void check_view(const struct hf_io_file *f, int i, const char *name, int part, const char *red, int depth_part,
                       const char *depth)
{
    const struct hf_io_view *v = hf_io_view(f, i);
    CHECK_MSG(!strcmp(v->name, name) && v->part == part && !strcmp(v->colour[0], red) && v->depth_part == depth_part &&
                  !strcmp(v->depth, depth),
              "view %d is %s, part %d, %s, depth %d %s", i, v->name, v->part, v->colour[0], v->depth_part, v->depth);
}

static void test_single_part_views(void)
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
        struct hf_io_error err = {""};
        float depth[45];
        CHECK_INT(hf_io_view(f, 0)->depth_part, -1);
        CHECK(hf_io_read_depth(f, 0, depth, &err) == -1 && strstr(err.message, "forward.left.u"));
    }
    hf_io_close(&f);
    round_trip(path, NULL, true, true);
    // The same depth as a file of its own.
    f = open_or_complain(path, NULL, 2);
    for (int i = 0; i < 2 && f; i++) {
        struct hf_io_error err = {""};
        float depth[45], own[45];
        CHECK_MSG(!hf_io_read_depth(f, i, depth, &err), "%s", err.message);
        CHECK_MSG(!hf_io_read_depth_file(path, NULL, hf_io_view(f, i), own, &err), "%s", err.message);
        CHECK(!memcmp(depth, own, sizeof(own)));
    }
    hf_io_close(&f);
}

// Stereo in parts, depth with windows of its own, a deep part that nobody looks into.
static void test_parts(void)
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
        struct hf_io_error err = {""};
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

static void test_names(void)
{
    static const char *const tries[][12] = {
        // what there is; the red channel and the depth that are to be found
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
        struct hf_io_error err = {""};
        struct hf_io_file *f = try_names(tries[i], 1, &err);
        if (f)
            check_view(f, 0, "", 0, found[i][0], found[i][1][0] ? 0 : -1, found[i][1]);
        hf_io_close(&f);
        if (f || i == 0)
            round_trip(in_folder("names.exr"), NULL, true, i != 0);
    }
    static const char *const none[][8] = {{"G", "R", "Z", 0}, {"a.R", "a.G", "a.B", "b.R", "b.G", "b.B", 0}};
    for (size_t i = 0; i < 2; i++) {
        struct hf_io_error err = {""};
        struct hf_io_file *f = try_names(none[i], 0, &err);
        CHECK_MSG(strstr(err.message, none[i][0]), "%s", err.message);
        hf_io_close(&f);
    }
}

static int rewrite(const char *path, const char *target, struct hf_io_error *err)
{
    struct hf_io_file *f;
    int ignored = 0;
    if (hf_io_open(&f, path, NULL, err))
        return -1;
    const struct hf_io_view *v = hf_io_view(f, 0);
    struct planes planes = make_planes(v, &ignored);
    const struct hf_io_result r = {0, {planes.p[0], planes.p[1], planes.p[2], planes.p[3]}};
    const struct hf_io_job job = {.path = target, .results = &r, .result_count = 1};
    const int status = hf_io_write(f, &job, NULL, err);
    free_planes(&planes);
    hf_io_close(&f);
    return status;
}

static void expect_error(int status, const struct hf_io_error *err, const char *part)
{
    CHECK_MSG(status == -1 && strstr(err->message, part), "expected an error with \"%s\", got %d %s", part, status,
              err->message);
}

static void test_unsupported(void)
{
    const char *path = in_folder("odd.exr"), *target = in_folder("none.exr");
    struct hf_io_error err = {""};
    struct part parts[MAX_PARTS] = {usual_part(EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIP, EXR_LINEORDER_INCREASING_Y)};
    parts[0].x = parts[0].y = 0;
    parts[0].width = parts[0].height = 40;
    parts[0].channels[1].sampling = 2;
    CHECK(!make_exr(path, parts, NULL));
    expect_error(rewrite(path, target, &err), &err, "channel B is subsampled");
    parts[0].channels[1].sampling = 0;
    parts[0].channels[6].sampling = 2;
    CHECK(!make_exr(path, parts, NULL));
    round_trip(path, NULL, true, true);
    round_trip(path, "none", true, true);
    parts[0].channels[6].sampling = 0;
    parts[0].channels[3].type = EXR_PIXEL_UINT;
    CHECK(!make_exr(path, parts, NULL));
    expect_error(rewrite(path, target, &err), &err, "channel R holds integers");
    parts[0] = usual_part(EXR_STORAGE_TILED, EXR_COMPRESSION_ZIP, EXR_LINEORDER_INCREASING_Y);
    parts[0].levels = EXR_TILE_MIPMAP_LEVELS;
    CHECK(!make_exr(path, parts, NULL));
    expect_error(rewrite(path, target, &err), &err, "mipmapped");
    CHECK(access(target, F_OK));
}

// ---- what goes wrong ----

static void test_errors(void)
{
    const char *path = in_folder("a.exr");
    const struct part parts[MAX_PARTS] = {
        usual_part(EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIP, EXR_LINEORDER_INCREASING_Y)};
    struct hf_io_error err = {""};
    CHECK(!make_exr(path, parts, NULL));
    expect_error(rewrite(in_folder("missing.exr"), path, &err), &err, "missing.exr: cannot open: No such file");
    expect_error(rewrite(folder, path, &err), &err, "not a regular file");
    expect_error(rewrite(path, in_folder("no/such.exr"), &err), &err, "no/such.exr: cannot create");
    expect_error(rewrite(path, "/dev/full", &err), &err, "/dev/full: cannot write: not a regular file");
    spill(in_folder("empty.exr"), "", 0);
    expect_error(rewrite(in_folder("empty.exr"), path, &err), &err, "empty");
    spill(in_folder("text.exr"), "hello, world", 12);
    expect_error(rewrite(in_folder("text.exr"), path, &err), &err, "not an EXR");
    mkdir(in_folder("locked"), 0555);
    if (geteuid() != 0) {
        expect_error(rewrite(path, in_folder("locked/a.exr"), &err), &err, "Permission denied");
        CHECK_INT(files_in(in_folder("locked")), 0);
    }
    rmdir(in_folder("locked"));
    // The target may be the source.
    const int files = files_in(folder);
    CHECK_MSG(!rewrite(path, path, &err), "%s", err.message);
    CHECK_INT(files_in(folder), files);
}

static void full_disk(const char *source, const char *target)
{
    struct hf_io_error err = {""};
    struct rlimit was, low;
    const int files = files_in(folder);
    getrlimit(RLIMIT_FSIZE, &was);
    low = was;
    low.rlim_cur = 1000;
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &low);
    const int status = rewrite(source, target, &err);
    setrlimit(RLIMIT_FSIZE, &was);
    CHECK_MSG(status == -1, "%s was written to a full disk", target);
    expect_error(status, &err, "cannot write");
    CHECK_INT(files_in(folder), files);
    CHECK(access(target, F_OK));
}

// Reads and writes all of a file; whatever is in it, nothing may crash. Returns whether all went well.
static bool survive(const char *path, const char *target)
{
    struct hf_io_error err = {""};
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
        const struct hf_io_result r = {i, {planes.p[0], NULL, NULL, NULL}};
        const struct hf_io_job job = {.path = target, .results = &r, .result_count = 1};
        ok &= !hf_io_write(f, &job, NULL, &err);
        free_planes(&planes);
    }
    hf_io_close(&f);
    return ok;
}

static void test_rubbish(const char *path)
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
static void test_huge_header(void)
{
    const struct part parts[MAX_PARTS] = {
        usual_part(EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIP, EXR_LINEORDER_INCREASING_Y)};
    const char *path = in_folder("huge.exr");
    struct hf_io_error err = {""};
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

// Headers that Core believes and other readers do not, and files that are called what they are.
static void test_claims(void)
{
    struct part parts[MAX_PARTS] = {usual_part(EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIP, EXR_LINEORDER_INCREASING_Y)};
    const char *path = in_folder("claim.exr"), *target = in_folder("none.exr");
    static const char *const types[] = {"compression\0compression", "lineOrder\0lineOrder", "dataWindow\0box2i"};
    static const size_t lengths[] = {23, 19, 16};
    struct hf_io_error err = {""};
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

// ---- other formats ----

static void test_planes(void)
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

static void test_formats(void)
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

static void test_half(void)
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
    for (int i = 0; i < 200000; i++) {  // nearest, ties to even: no neighbour is nearer
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

// Rows of halves against single ones, from any address, whatever the processor does them with.
static void test_half_rows(void)
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

// Bytes sorted and put back; and the same as a byte at a time.
static void test_zip(void)
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
}

// Fetched and decoded at once on threads, each chunk once: the same as view by view; then encoded twice from one
// decoding. What is written back unchanged is the source, byte for byte, whoever compressed it.
static void test_stages(void)
{
    const char *path = in_folder("stages.exr"), *target = in_folder("out.exr");
    for (int c = EXR_COMPRESSION_NONE; c <= EXR_COMPRESSION_PIZ; c++) {
        struct hf_io_file *f = NULL;
        struct hf_io_error err = {""};
        struct part parts[MAX_PARTS] = {usual_part(c % 2 ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE,
                                                   (exr_compression_t)c, EXR_LINEORDER_INCREASING_Y)};
        float planes[5][37 * 41], own[5][37 * 41];
        CHECK(!make_exr(path, parts, NULL));
        if (!CHECK_MSG(!hf_io_open(&f, path, NULL, &err), "%s", err.message))
            return;
        const struct hf_io_want want = {0, {planes[0], planes[1], planes[2], planes[3]}, planes[4]};
        CHECK_MSG(!hf_io_fetch(f, &want, 1, &err), "%s", err.message);
        CHECK_MSG(!hf_io_decode(f, &want, 1, &threads, &err), "%s", err.message);
        const struct hf_io_result same = {0, {planes[0], planes[1], planes[2], planes[3]}};
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

static void test_shared(void)
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

int main(void)
{
    // In memory if there is such a place: every written file is synced, which takes a disk its time.
    char memory[] = "/dev/shm/hyperfocal-io-XXXXXX", disk[] = "/tmp/hyperfocal-io-XXXXXX", command[100];
    folder = mkdtemp(memory);
    if (!folder)
        folder = mkdtemp(disk);
    if (!folder)
        return CHECK_SKIP;
    if (getenv("HF_SEED"))
        seed = strtoull(getenv("HF_SEED"), NULL, 0);
    printf("seed %llu\n", (unsigned long long)seed);
    if (hf_io_threads_open(&threads, 3))
        return CHECK_SKIP;
    test_half();
    test_half_rows();
    test_zip();
    test_stages();
    test_compressions();
    test_single_part_views();
    test_parts();
    test_names();
    test_unsupported();
    test_errors();
    full_disk(in_folder("views.exr"), in_folder("full.exr"));
    test_huge_header();
    test_claims();
    test_planes();
    test_formats();
    test_rubbish(in_folder("views.exr"));
    test_rubbish(in_folder("parts.exr"));
    test_rubbish(in_folder("odd.exr"));
    test_shared();
    snprintf(command, sizeof(command), "rm -rf %s", folder);
    if (system(command))
        printf("cannot remove %s\n", folder);
    hf_io_threads_close(&threads);
    return check_report();
}
