// SPDX-License-Identifier: BSD-3-Clause
// Lists of frame numbers.
#include "tools/cli/frames.h"

#include <stdio.h>
#include <string.h>

#include "support/check.h"

static const struct {
    const char *text, *want;  // want NULL: refused
} lists[] = {
    {"7", "7"},
    {"1-5", "1 2 3 4 5"},
    {"1-10x4", "1 5 9"},
    {"5-1", "5 4 3 2 1"},
    {"10-1x4", "10 6 2"},
    {"1,5,9-20x3", "1 5 9 12 15 18"},
    {"-2-2", "-2 -1 0 1 2"},
    {"-5--3", "-5 -4 -3"},
    {"2--2x2", "2 0 -2"},
    {"1-7:3", "1 4 7 3 5 2 6"},
    {"7-1:3", "7 4 1 5 3 6 2"},
    {"1-6y2", "2 4 6"},
    {"1-3,2-4", "1 2 3 4"},
    {"3-3x5", "3"},
    {"1-3x100", "1"},
    {"1-2:1000", "1 2"},
    {"99999999", "99999999"},
    {"", NULL},
    {"1-", NULL},
    {"1-3x", NULL},
    {"1-3x0", NULL},
    {"1,,2", NULL},
    {"1,", NULL},
    {"a", NULL},
    {"1-3z2", NULL},
    {" 1", NULL},
    {"1 2", NULL},
    {"100000000", NULL},
    {"99999999999999999999", NULL},
    {"1-99999999", NULL},
    {"1-1y1", NULL},
};

static void parse(void)
{
    struct tool_error error;
    for (size_t i = 0; i < sizeof(lists) / sizeof(lists[0]); i++) {
        struct cli_frames frames;
        char got[256] = "";
        const int status = cli_frames_parse(&frames, lists[i].text, &error);
        if (!CHECK_MSG(!status == !!lists[i].want, "'%s' gives %d", lists[i].text, status) || status)
            continue;
        for (int k = 0; k < frames.count; k++)
            snprintf(got + strlen(got), sizeof(got) - strlen(got), "%s%d", k ? " " : "", frames.list[k]);
        CHECK_MSG(!strcmp(got, lists[i].want), "'%s' is %s, expected %s", lists[i].text, got, lists[i].want);
        cli_frames_free(&frames);
    }
}

static void gaps(void)
{
    int list[] = {-3, -2, 0, 1, 5, 10};
    const struct cli_frames frames = {list, 6, 6}, one = {list, 1, 1};
    char buf[256];
    CHECK_INT(cli_frames_gaps(&frames, buf, sizeof(buf)), 8);
    CHECK_MSG(!strcmp(buf, "-1, 2-4, 6-9"), "gaps are %s", buf);
    CHECK_INT(cli_frames_gaps(&one, buf, sizeof(buf)), 0);
    CHECK_INT(buf[0], 0);
}

static void missing(void)
{
    struct tool_error error;
    int list[] = {-1, 2, 3, 9};
    const struct cli_frames there = {list, 4, 4}, none = {list, 0, 4};
    struct cli_frames asked;
    char buf[256];
    if (!CHECK(!cli_frames_parse(&asked, "9-1,-2--1", &error)))
        return;
    CHECK_INT(cli_frames_missing(&asked, &there, buf, sizeof(buf)), 7);
    CHECK_MSG(!strcmp(buf, "-2, 1, 4-8"), "missing are %s", buf);
    CHECK_INT(cli_frames_missing(&asked, &none, buf, sizeof(buf)), 11);
    CHECK_MSG(!strcmp(buf, "-2--1, 1-9"), "missing are %s", buf);
    CHECK_INT(cli_frames_missing(&there, &there, buf, sizeof(buf)), 0);
    CHECK_INT(buf[0], 0);
    cli_frames_free(&asked);
}

int main(void)
{
    parse();
    gaps();
    missing();
    return check_report();
}
