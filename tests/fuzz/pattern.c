// SPDX-License-Identifier: BSD-3-Clause
// File names with places for the number and the view: a frame's number, the number of digits, then the pattern. A
// folder contains files of some names that can be found.
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "tools/cli/pattern.h"
#include "fuzz/fuzz.h"

static char folder[] = "/tmp/hyperfocal-pattern-XXXXXX";
static const char *const names[] = {"shot.0007.exr",
                                    "shot.7.exr",
                                    "shot.0008.exr",
                                    "shot.-003.exr",
                                    "shot.00099999.exr",
                                    "left.0001.exr",
                                    "l0001_1",
                                    "12",
                                    "%04d",
                                    "#"};
enum { NAMES = sizeof names / sizeof *names };

static void remove_folder(void)
{
    char path[128];
    for (int i = 0; i < NAMES; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        unlink(path);
    }
    rmdir(folder);
}

static void make_folder(void)
{
    static int made;
    char path[128];
    if (made++)
        return;
    MUST(mkdtemp(folder) != NULL);
    for (int i = 0; i < NAMES; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        const int fd = open(path, O_CREAT | O_WRONLY, 0600);
        MUST(fd >= 0);
        close(fd);
    }
    atexit(remove_folder);
}

// Every frame found exists: the pattern, with its number in some number of digits, is the name of a file.
static void check_scan(const char *pattern, const char *path)
{
    struct cli_frames found;
    struct tool_error error = {""};
    int digits;
    const int status = cli_pattern_scan(path, &found, &digits, &error);
    MUST((status == 0) == (error.text[0] == 0));
    MUST(status != 0 || digits > 0);
    for (int i = 0; i < found.count; i++) {
        int same = 0;
        MUST(i == 0 || found.list[i] > found.list[i - 1]);
        for (int n = 1; n <= 9; n++) {
            char *name = cli_pattern_fill(pattern, found.list[i], n);
            MUST(name != NULL);
            for (int k = 0; k < NAMES; k++)
                same |= !strcmp(name, names[k]);
            free(name);
        }
        MUST(same);
    }
    cli_frames_free(&found);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct bytes b = {data, size};
    const int frame = (int)(take_word(&b) % (2u * CLI_MAX_FRAME + 1)) - CLI_MAX_FRAME,
              digits = (int)(take_byte(&b) % 9);
    char *pattern = malloc(b.size + 1), *path = malloc(b.size + 64);
    make_folder();
    MUST(pattern && path);
    memcpy(pattern, b.data, b.size);
    pattern[b.size] = 0;
    char *filled = cli_pattern_fill(pattern, frame, digits), *viewed = cli_pattern_view(pattern, "left");
    MUST(filled && viewed);
    MUST(cli_pattern_has_frame(pattern) || !strcmp(filled, pattern));
    MUST(cli_pattern_has_view(pattern) || !strcmp(viewed, pattern));
    int number, width;
    if (cli_name_number(pattern, &number, &width))
        MUST(width > 0 && number >= -CLI_MAX_FRAME && number <= CLI_MAX_FRAME);
    sprintf(path, "%s/%s", folder, pattern);
    if (!strchr(pattern, '/'))
        check_scan(pattern, path);
    free(viewed);
    free(filled);
    free(path);
    free(pattern);
    return 0;
}
