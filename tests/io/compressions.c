// SPDX-License-Identifier: BSD-3-Clause
// Round trips through every compression, storage and line order.
#include "io/tests.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// The note about a file if only red is replaced.
static const char *note_of(const char *path, const char *compression)
{
    static struct hf_io_written written;
    struct hf_io_error err = {.message = ""};
    struct hf_io_file *f;
    int ignored = 0;
    if (!CHECK_MSG(!hf_io_open(&f, path, NULL, &err), "%s", err.message))
        return "";
    struct planes planes = make_planes(hf_io_view(f, 0), &ignored);
    const struct hf_io_result r = {.view = 0, .planes = {planes.p[0], planes.p[1], planes.p[2], NULL}};
    const struct hf_io_job job = {
        .path = in_folder("note.exr"), .results = &r, .result_count = 1, .compression = compression};
    CHECK_MSG(!hf_io_write(f, &job, &written, &err), "%s", err.message);
    unlink(job.path);
    free_planes(&planes);
    hf_io_close(&f);
    return written.note;
}

void test_compressions(void)
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
            // The note names channels that DWA wears out and nobody asked to change, but not those that it keeps (Z,
            // id, u).
            CHECK_MSG(!note_of(path, names[c])[0], "%s: %s", names[c], note_of(path, names[c]));
            // From DWA to itself and back: OpenImageIO must read what Core cannot.
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
        CHECK(!hf_io_has_oiio() || strstr(note_of(path, "dwaa"), "(x.R) was compressed by dwaa, which"));
        if (hf_io_has_oiio() && !tiled) {
            round_trip(path, "dwaa", false, false);
            rename(in_folder("out.exr"), in_folder("dwa.exr"));
            CHECK_MSG(strstr(note_of(in_folder("dwa.exr"), NULL), "(x.R) was compressed by dwaa a second time"),
                      "tiled %d: %s", tiled, note_of(in_folder("dwa.exr"), NULL));
            CHECK(!note_of(in_folder("dwa.exr"), "zip")[0]);
        }
        // Masks named r keep their bits, so no note is needed.
        parts[0].channels[6] = (struct channel){"x.r", EXR_PIXEL_FLOAT, 0};
        CHECK(!make_exr(path, parts, NULL));
        CHECK(!hf_io_has_oiio() || !note_of(path, "dwaa")[0]);
        // B44 leaves floats alone: chunks that do not shrink.
        memset(parts[0].channels + 5, 0, 2 * sizeof(parts[0].channels[0]));
        CHECK(!make_exr(path, parts, NULL));
        round_trip(path, "b44", false, true);
    }
}
