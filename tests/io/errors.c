// SPDX-License-Identifier: BSD-3-Clause
// Refused files, and failures.
#include "io/tests.h"

#include <math.h>
#include <stdlib.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <sys/resource.h>

void test_unsupported(void)
{
    const char *path = in_folder("odd.exr"), *target = in_folder("none.exr");
    struct hf_io_error err = {.message = ""};
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

void test_errors(void)
{
    const char *path = in_folder("a.exr");
    const struct part parts[MAX_PARTS] = {
        usual_part(EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIP, EXR_LINEORDER_INCREASING_Y)};
    struct hf_io_error err = {.message = ""};
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

void full_disk(const char *source, const char *target)
{
    struct hf_io_error err = {.message = ""};
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
