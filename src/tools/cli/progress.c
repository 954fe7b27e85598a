// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/progress.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tools/common/machine.h"

enum { BAR = 24 };

void cli_progress_begin(struct cli_progress *p, int total, int quiet)
{
    *p = (struct cli_progress){
        .total = total, .quiet = quiet, .bar = !quiet && isatty(STDERR_FILENO), .start = tool_now_ms()};
}

// Which work takes the most time of the frames so far: "reading", "writing" or "computing".
static const char *limit(const struct cli_progress *p)
{
    const long long reading = atomic_load(&p->us[CLI_READ]), writing = atomic_load(&p->us[CLI_WRITE]);
    const long long computing =
        atomic_load(&p->us[CLI_DECODE]) + atomic_load(&p->us[CLI_DEFOCUS]) + atomic_load(&p->us[CLI_ENCODE]);
    return computing >= reading + writing ? "computing" : reading > writing ? "reading" : "writing";
}

// 75 s as "1:15", 2 h as "2:00:00".
static const char *clock_text(double seconds, char *buf, size_t size)
{
    const long s = (long)(seconds + 0.5);
    if (s >= 3600)
        snprintf(buf, size, "%ld:%02ld:%02ld", s / 3600, s / 60 % 60, s % 60);
    else
        snprintf(buf, size, "%ld:%02ld", s / 60, s % 60);
    return buf;
}

static void draw(const struct cli_progress *p, int finished, const char *name)
{
    char bar[BAR + 1], left[32] = "?", shown[TOOL_SHOWN];
    const int rendered = atomic_load(&p->rendered);
    const double seconds = (tool_now_ms() - p->start) / 1000, rate = seconds > 0 ? rendered / seconds : 0;
    const int filled = p->total ? (int)((long long)BAR * finished / p->total) : BAR;
    const char *slash = strrchr(name, '/');
    memset(bar, '-', BAR);
    memset(bar, '#', (size_t)filled);
    bar[BAR] = '\0';
    if (rate > 0)
        clock_text((p->total - finished) / rate, left, sizeof(left));
    fprintf(stderr, "\r\033[K[%s] %d/%d  %.2f frames/s  %s left  %s  (%s)", bar, finished, p->total, rate, left,
            tool_shown(slash ? slash + 1 : name, shown), limit(p));
    fflush(stderr);
    atomic_store(&tool_bar_shown, 1);
}

void cli_progress_frame(struct cli_progress *p, const char *name, const char *text)
{
    char shown[TOOL_SHOWN], about[TOOL_SHOWN];
    const int finished = atomic_load(&p->done) + atomic_load(&p->skipped) + atomic_load(&p->failed);
    // The stream's lock keeps the lines of two threads apart.
    flockfile(stderr);
    if (p->bar)
        draw(p, finished, name);
    else if (!p->quiet)
        fprintf(stderr, "hyperfocal: %d/%d %s: %s\n", finished, p->total, tool_shown(name, shown),
                tool_shown(text, about));
    funlockfile(stderr);
}

void cli_progress_end(struct cli_progress *p)
{
    if (p->bar && atomic_exchange(&tool_bar_shown, 0))
        fputs("\r\033[K", stderr);
}
