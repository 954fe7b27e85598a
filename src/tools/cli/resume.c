// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/resume.h"

#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/io/temp.h"

// FNV-1a of 64 bits. It detects accidents, not forgeries.
static uint64_t mix(uint64_t hash, const void *data, size_t size)
{
    const unsigned char *bytes = data;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
    return hash;
}

static uint64_t mix_text(uint64_t hash, const char *text)
{
    return mix(hash, text, strlen(text) + 1);
}

enum { FIRST = 1 << 16, BLOCK = 4096, BLOCKS = 16 };

// Mix in what tells a new version of a file from the old one: size, time and some bytes, as copying may keep size and
// time. The bytes are those at the beginning, where an EXR has its header and chunk table, and blocks spread over the
// rest.
static uint64_t mix_file(uint64_t hash, const char *path)
{
    struct stat st;
    const int fd = path ? open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK) : -1;
    char *bytes = fd >= 0 ? malloc(FIRST) : NULL;
    if (bytes && !fstat(fd, &st) && S_ISREG(st.st_mode)) {
        const int64_t numbers[3] = {st.st_size, st.st_mtim.tv_sec, st.st_mtim.tv_nsec};
        hash = mix(hash, numbers, sizeof(numbers));
        ssize_t n = pread(fd, bytes, FIRST, 0);
        hash = mix(hash, bytes, n > 0 ? (size_t)n : 0);
        for (int i = 1; i <= BLOCKS && st.st_size > FIRST; i++) {
            n = pread(fd, bytes, BLOCK, FIRST - BLOCK + (st.st_size - FIRST) * i / BLOCKS);
            hash = mix(hash, bytes, n > 0 ? (size_t)n : 0);
        }
    }
    free(bytes);
    if (fd >= 0)
        close(fd);
    return hash;
}

// Write the values that only this frame has, as the options that would set them.
static void put_values(FILE *out, const struct cli_args *args)
{
    const struct {
        const char *name;
        float value;
    } values[] = {{"range", args->range},
                  {"strength", args->strength},
                  {"fstop", args->fstop},
                  {"focal-length", args->focal_length}};
    if (args->focus_by == CLI_FOCUS_DISTANCE)
        fprintf(out, " --focus %.9g", args->focus);
    if (args->focus_by == CLI_FOCUS_AT)
        fprintf(out, " --focus-at %d,%d", args->focus_x, args->focus_y);
    for (size_t i = 0; i < sizeof(values) / sizeof(values[0]) && args->keys; i++)
        if (!isnan(values[i].value))
            fprintf(out, " --%s %.9g", values[i].name, values[i].value);
    if (args->keys && args->params.max_radius != HF_DERIVE)
        fprintf(out, " --max-radius %.9g", args->params.max_radius);
}

int cli_stamp_make(struct cli_stamp *stamp, const struct cli_args *args)
{
    size_t size;
    *stamp = (struct cli_stamp){.settings = NULL};
    FILE *out = open_memstream(&stamp->settings, &size);
    if (!out)
        return -1;
    fputs(args->settings ? args->settings : "", out);
    if (args->keys || args->focus_from)
        put_values(out, args);
    const int failed = ferror(out);
    if (fclose(out) || failed) {
        cli_stamp_free(stamp);
        return -1;
    }
    uint64_t hash = mix_text(UINT64_C(0xcbf29ce484222325), hf_version());
    hash = mix_text(hash, stamp->settings);
    hash = mix_file(mix_file(hash, args->input), args->depth_file);
    hash = mix_file(hash, args->aperture_file);
    for (int i = 0; i < args->other_count; i++)
        hash = mix_file(mix_text(hash, args->other_option), args->others[i]);
    snprintf(stamp->hash, sizeof(stamp->hash), "%016" PRIx64, hash);
    stamp->texts[0] = (struct hf_io_text){"hyperfocalVersion", hf_version()};
    stamp->texts[1] = (struct hf_io_text){"hyperfocalSettings", stamp->settings};
    stamp->texts[2] = (struct hf_io_text){"hyperfocalHash", stamp->hash};
    return 0;
}

void cli_stamp_free(struct cli_stamp *stamp)
{
    free(stamp->settings);
    stamp->settings = NULL;
}

int cli_stamp_fits(const struct cli_stamp *stamp, const char *path)
{
    static const struct hf_io_choice all = {NULL, "all"};
    struct hf_io_file *file;
    char hash[sizeof(stamp->hash) + 1];
    if (access(path, R_OK) || hf_io_open(&file, path, &all, NULL))
        return 0;
    const int fits = !strcmp(hf_io_text(file, "hyperfocalHash", hash, sizeof(hash)), stamp->hash) &&
                     !hf_io_check_whole(file, NULL) && !hf_io_check_sum(file, NULL);
    hf_io_close(&file);
    return fits;
}

int cli_remove_strays(const struct cli_shot *shot)
{
    char *last = NULL;
    int removed = 0;
    for (int i = 0; i < shot->jobs.count; i++) {
        const char *output = shot->jobs.list[i].output;
        const char *slash = output ? strrchr(output, '/') : NULL;
        char *folder = !output ? NULL : slash ? strndup(output, (size_t)(slash - output) + 1) : strdup(".");
        // Frames mostly lie in one folder.
        if (folder && (!last || strcmp(folder, last)))
            removed += hf_temp_remove_strays(folder);
        free(last);
        last = folder;
    }
    free(last);
    return removed;
}
