// SPDX-License-Identifier: BSD-3-Clause
// Tables of parameters that change over a shot.
#include "tools/cli/keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "support/check.h"

static char path[] = "/tmp/hyperfocal-keys-XXXXXX";

static int load(struct cli_keys *keys, const char *text, int smooth, struct tool_error *error)
{
    FILE *out = fopen(path, "w");
    if (!out || fputs(text, out) < 0 || fclose(out))
        return -1;
    return cli_keys_load(keys, path, smooth, error);
}

static void linear(void)
{
    struct cli_keys keys;
    struct tool_error error = {""};
    const char *text =
        "\xef\xbb\xbf# a comment\r\nframe, Focus ,range,focus-at\r\n40,3,,\"200,50\"\r\n1,4.5,2,960:540\r\n"
        "\n11,,4,\n";
    if (!CHECK_MSG(!load(&keys, text, 0, &error), "%s", error.text))
        return;
    CHECK(cli_keys_at(&keys, CLI_KEY_FOCUS, -5) == 4.5 && cli_keys_at(&keys, CLI_KEY_FOCUS, 1) == 4.5);
    CHECK(cli_keys_at(&keys, CLI_KEY_FOCUS, 40) == 3 && cli_keys_at(&keys, CLI_KEY_FOCUS, 1e6) == 3);
    // 13 of 39 frames on the way from 4.5 to 3: two roundings, each below one unit of 2^-52 relative.
    CHECK(fabs(cli_keys_at(&keys, CLI_KEY_FOCUS, 14) - 4) <= 4 * 3 * 2.3e-16);
    CHECK(cli_keys_at(&keys, CLI_KEY_RANGE, 6) == 3 && cli_keys_at(&keys, CLI_KEY_RANGE, 40) == 4);
    CHECK(cli_keys_at(&keys, CLI_KEY_FOCUS_X, 1) == 960 && cli_keys_at(&keys, CLI_KEY_FOCUS_Y, 1) == 540);
    CHECK(cli_keys_at(&keys, CLI_KEY_FOCUS_X, 40) == 200 && cli_keys_at(&keys, CLI_KEY_FOCUS_Y, 40) == 50);
    CHECK_INT(keys.column[CLI_KEY_STRENGTH].count, 0);
    cli_keys_free(&keys);
}

// The curve goes through every key, is monotone between two, and never exceeds them: a focus between two positive ones
// stays positive.
static void smooth(void)
{
    static const double at[] = {1, 4, 5, 20, 21, 30}, want[] = {10, 1, 1, 0.5, 8, 7};
    struct cli_keys keys;
    struct tool_error error = {""};
    const char *text = "frame,focus\n1,10\n4,1\n5,1\n20,0.5\n21,8\n30,7\n";
    if (!CHECK_MSG(!load(&keys, text, 1, &error), "%s", error.text))
        return;
    for (int i = 0; i < 6; i++)
        CHECK(cli_keys_at(&keys, CLI_KEY_FOCUS, at[i]) == want[i]);
    for (int i = 0; i < 5; i++) {
        double before = want[i];
        for (double f = at[i]; f <= at[i + 1]; f += 0.125) {
            const double v = cli_keys_at(&keys, CLI_KEY_FOCUS, f);
            // Values up to 10 after a handful of roundings of 2^-53 relative.
            CHECK_MSG((v - before) * (want[i + 1] - want[i]) >= -1e-13, "frame %g: %g after %g", f, v, before);
            before = v;
        }
    }
    // Flat at a turning point: second derivatives stay below 6 x 7.5 a frame squared, so a difference over 2^-16 is
    // below 2^-10.
    const double e = 1. / 65536, turn = (cli_keys_at(&keys, CLI_KEY_FOCUS, 20 + e) - 0.5) / e;
    CHECK_MSG(fabs(turn) < 1. / 1024, "slope %g where it turns", turn);
    // No corner: the slopes from both sides agree at a key in the middle of a rise. With cubics on intervals of 10 and
    // values below 4, second derivatives stay below 0.25, so a difference over 1/1024 is off by less than 2^-12.
    cli_keys_free(&keys);
    if (!CHECK_MSG(!load(&keys, "frame,focus\n0,1\n10,2\n20,4\n", 1, &error), "%s", error.text))
        return;
    const double h = 1. / 1024, left = (2 - cli_keys_at(&keys, CLI_KEY_FOCUS, 10 - h)) / h,
                 right = (cli_keys_at(&keys, CLI_KEY_FOCUS, 10 + h) - 2) / h;
    CHECK_MSG(fabs(left - right) < 1. / 2048 && left > 0.05, "slopes %g and %g", left, right);
    cli_keys_free(&keys);
}

// Numbers as the options take them: metres become scene units of half a metre, millimetres and f-numbers stay.
static void units(void)
{
    struct cli_keys keys;
    struct tool_error error = {""};
    const char *text =
        "frame,focus,range,focal-length,fstop,max-radius\n1,2 m,50cm,5cm,f/2.8,2048\n2,2,\" 1\",50,F2,4\n";
    if (!CHECK_MSG(!load(&keys, text, 0, &error), "%s", error.text))
        return;
    cli_keys_scale(&keys, 0.5);
    CHECK(cli_keys_at(&keys, CLI_KEY_FOCUS, 1) == 4 && cli_keys_at(&keys, CLI_KEY_FOCUS, 2) == 2);
    CHECK(cli_keys_at(&keys, CLI_KEY_RANGE, 1) == 1 && cli_keys_at(&keys, CLI_KEY_RANGE, 2) == 1);
    CHECK(cli_keys_at(&keys, CLI_KEY_FOCAL_LENGTH, 1) == 50 && cli_keys_at(&keys, CLI_KEY_FOCAL_LENGTH, 2) == 50);
    CHECK(cli_keys_at(&keys, CLI_KEY_FSTOP, 1) == 2.8 && cli_keys_at(&keys, CLI_KEY_FSTOP, 2) == 2);
    CHECK(cli_keys_at(&keys, CLI_KEY_MAX_RADIUS, 1) == 2048);
    cli_keys_free(&keys);
}

static void refused(void)
{
    static const struct {
        const char *text, *says;
    } bad[] = {
        {"", "no value"},
        {"frame,focus\n", "no value"},
        {"focus\n1\n", "no column frame"},
        {"frame,colour\n1,2\n", "'colour' is not a column"},
        {"frame,focus,focus\n1,2,3\n", "comes twice"},
        {"frame,focus\n1,2\n1,3\n", "frame 1 comes twice"},
        {"frame,focus\n1,x\n", "line 2: 'x' is not a number"},
        {"frame,focus\n1,2ft\n", "'2ft' is not a number; units are m, cm and mm"},
        {"frame,fstop\n1,2m\n", "'2m' is not a number; f/2.8 will do too"},
        {"frame,max-radius\n1,2m\n", "'2m' is not a number"},
        {"frame,max-radius\n1,2049\n", "'2049' is out of range"},
        {"frame,focus\n,2\n", "is not a frame's number"},
        {"frame,focus\n1,0\n", "'0' is out of range"},
        {"frame,focus\n1,nan\n", "'nan' is not a number"},
        {"frame,focus\n1,inf\n", "'inf' is out of range"},
        {"frame,strength\n1,1.5\n", "'1.5' is out of range"},
        {"frame,focus\n1,2,3\n", "more cells"},
        {"frame,focus-at\n1,5\n", "is not a pixel"},
    };
    struct cli_keys keys;
    struct tool_error error;
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        const int status = load(&keys, bad[i].text, 0, &error);
        CHECK_MSG(status == 1 && strstr(error.text, bad[i].says), "%s gives %d: %s", bad[i].text, status, error.text);
    }
    CHECK(cli_keys_load(&keys, "/nonexistent/keys.csv", 0, &error) == 1 && strstr(error.text, "/nonexistent"));
}

int main(void)
{
    const int fd = mkstemp(path);
    if (!CHECK(fd >= 0))
        return check_report();
    close(fd);
    linear();
    smooth();
    units();
    refused();
    unlink(path);
    return check_report();
}
