// SPDX-License-Identifier: BSD-3-Clause
// File names with a place for the frame number.
#include "tools/cli/pattern.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "support/check.h"

static void fill(void)
{
    static const struct {
        const char *pattern;
        int frame, digits;
        const char *view, *want;
    } names[] = {
        {"shot.####.exr", 7, 2, NULL, "shot.0007.exr"},     {"shot.####.exr", 12345, 2, NULL, "shot.12345.exr"},
        {"shot.####.exr", -7, 2, NULL, "shot.-007.exr"},    {"shot.#.exr", 7, 3, NULL, "shot.007.exr"},
        {"shot.@.exr", 7, 3, NULL, "shot.7.exr"},           {"shot.@@.exr", 7, 3, NULL, "shot.07.exr"},
        {"shot.%04d.exr", 7, 3, NULL, "shot.0007.exr"},     {"shot.%d.exr", 7, 3, NULL, "shot.7.exr"},
        {"shot.$F4.exr", 7, 3, NULL, "shot.0007.exr"},      {"shot.$F.exr", 7, 3, NULL, "shot.7.exr"},
        {"$FOO.%s.%x.exr", 7, 3, "left", "$FOO.%s.%x.exr"}, {"%V/shot_%v.##.exr", 7, 3, "left", "left/shot_l.07.exr"},
        {"%V/#/#.exr", 7, 2, NULL, "%V/07/07.exr"},         {"plain.exr", 7, 2, "left", "plain.exr"},
    };
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        char *named = names[i].view ? cli_pattern_view(names[i].pattern, names[i].view) : strdup(names[i].pattern);
        char *got = named ? cli_pattern_fill(named, names[i].frame, names[i].digits) : NULL;
        free(named);
        CHECK_MSG(got && !strcmp(got, names[i].want), "%s is %s, expected %s", names[i].pattern, got ? got : "NULL",
                  names[i].want);
        free(got);
    }
    CHECK(cli_pattern_has_frame("a.%04d.exr") && cli_pattern_has_frame("a.$F.exr") && !cli_pattern_has_frame("a.exr"));
    CHECK(!cli_pattern_has_frame("a.%4x.exr") && !cli_pattern_has_frame("%V.exr"));
    CHECK(cli_pattern_has_view("%V.#.exr") && cli_pattern_has_view("%v.exr") && !cli_pattern_has_view("#.%Vx.exr"));
}

static char dir[] = "/tmp/hyperfocal-pattern-XXXXXX";

static void with_files(const char *const names[], int create)
{
    char path[256];
    for (int i = 0; names[i]; i++) {
        snprintf(path, sizeof(path), "%s/%s", dir, names[i]);
        if (!create)
            unlink(path);
        else
            close(open(path, O_CREAT | O_WRONLY, 0666));
    }
}

static void scan_as(const char *pattern, const char *want, int want_digits)
{
    struct cli_frames found;
    struct tool_error error;
    char path[256], got[256] = "";
    int digits;
    snprintf(path, sizeof(path), "%s/%s", dir, pattern);
    if (!CHECK_MSG(!cli_pattern_scan(path, &found, &digits, &error), "%s: %s", pattern, error.text))
        return;
    for (int k = 0; k < found.count; k++)
        snprintf(got + strlen(got), sizeof(got) - strlen(got), "%s%d", k ? " " : "", found.list[k]);
    CHECK_MSG(!strcmp(got, want), "%s finds %s, expected %s", pattern, got, want);
    CHECK_MSG(digits == want_digits, "%s has %d digits, expected %d", pattern, digits, want_digits);
    cli_frames_free(&found);
}

static void scan(void)
{
    static const char *const padded[] = {"a.0010.exr",  "a.0009.exr", "a.-001.exr",  "a.10000.exr",     "a.12.exr",
                                         "a.0011.exrx", "a..exr",     "ab.0001.exr", "a.0012.0012.exr", NULL};
    static const char *const plain[] = {"b.8.exr", "b.9.exr", "b.10.exr", "b.-1.exr", NULL};
    with_files(padded, 1);
    with_files(plain, 1);
    scan_as("a.####.exr", "-1 9 10 10000", 4);
    scan_as("a.%04d.exr", "-1 9 10 10000", 4);
    scan_as("a.@.exr", "12 10000", 2);
    scan_as("a.#.#.exr", "12", 4);
    scan_as("b.#.exr", "-1 8 9 10", 1);
    scan_as("b.##.exr", "-1 10", 2);
    scan_as("c.#.exr", "", 4);
    struct cli_frames found;
    struct tool_error error;
    int digits;
    CHECK(cli_pattern_scan("/nonexistent-directory/a.#.exr", &found, &digits, &error) == 3 && error.text[0]);
    CHECK(cli_pattern_scan("####/a.#.exr", &found, &digits, &error) == 1 && strstr(error.text, "--frames"));
    with_files(padded, 0);
    with_files(plain, 0);
}

static void numbers(void)
{
    static const struct {
        const char *name;
        int found, frame, digits;
    } names[] = {
        {"shot.0007.exr", 1, 7, 4},        {"/x.12/shot7.exr", 1, 7, 1}, {"shot.exr", 0, 0, 0},
        {"12/shot.exr", 0, 0, 0},          {"s.-05.exr", 1, -5, 3},      {"s-05.exr", 1, 5, 2},
        {"v2_0100.tif", 1, 100, 4},        {"0100", 1, 100, 4},          {"-3.exr", 1, -3, 2},
        {"a.99999999999999.exr", 0, 0, 0},
    };
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        int frame = 0, digits = 0;
        const int found = cli_name_number(names[i].name, &frame, &digits);
        CHECK_MSG(found == names[i].found && (!found || (frame == names[i].frame && digits == names[i].digits)),
                  "%s: %d, frame %d of %d digits", names[i].name, found, frame, digits);
    }
}

int main(void)
{
    fill();
    numbers();
    if (!CHECK(mkdtemp(dir)))
        return check_report();
    scan();
    rmdir(dir);
    return check_report();
}
