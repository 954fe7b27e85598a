// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/log.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tools/cli/choose.h"
#include "tools/cli/guessed.h"
#include "tools/cli/json.h"
#include "tools/cli/summary.h"
#include "tools/cli/warn.h"
#include "tools/common/json.h"
#include "tools/common/machine.h"

// Each line is assembled first and written by one write(), whatever its length, because several threads and several
// processes may append to the file.
struct line {
    struct tool_json json;
    char *text;
    size_t size;
};

static int begin(const struct cli_log *log, struct line *line, const char *event)
{
    *line = (struct line){.text = NULL};
    FILE *out = log->path ? open_memstream(&line->text, &line->size) : NULL;
    const time_t now = time(NULL);
    struct tm utc;
    char text[32];
    if (!out)
        return -1;
    strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
    tool_json_begin(&line->json, out, 1);
    tool_json_text(&line->json, "time", text);
    tool_json_text(&line->json, "event", event);
    return 0;
}

static void lose(struct cli_log *log, int code)
{
    int none = 0;
    atomic_compare_exchange_strong(&log->error, &none, code);
}

static void put_line(struct cli_log *log, const struct line *line)
{
    if (atomic_exchange(&log->torn, 0) && write(log->fd, "\n", 1) != 1)
        lose(log, errno);
    ssize_t n;
    do {
        n = write(log->fd, line->text, line->size);
    } while (n < 0 && errno == EINTR);
    if (n < 0)
        lose(log, errno);
    // A second write for the rest could land behind another process's line, so the line counts as lost.
    if (n >= 0 && (size_t)n < line->size) {
        lose(log, ENOSPC);
        atomic_store(&log->torn, n > 0);
    }
}

static void end(struct cli_log *log, struct line *line)
{
    tool_json_end(&line->json);
    const int failed = ferror(line->json.out);
    if (!fclose(line->json.out) && !failed)
        put_line(log, line);
    else
        lose(log, ENOMEM);
    free(line->text);
}

int cli_log_open(struct cli_log *log, const char *path, int argc, char **argv, int frames, struct tool_error *error)
{
    char host[64] = "";
    struct line line;
    *log = (struct cli_log){.path = path};
    if (!path)
        return 0;
    log->fd = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (log->fd < 0) {
        log->path = NULL;
        return tool_fail(error, CLI_BAD_ARGUMENTS, "--log %s cannot be written: %s", path, strerror(errno));
    }
    if (begin(log, &line, "begin"))
        return 0;
    gethostname(host, sizeof(host) - 1);
    tool_json_command(&line.json, "command", argc, argv);
    tool_json_machine(&line.json, argc - 1, argv + 1);
    tool_json_text(&line.json, "host", host);
    tool_json_count(&line.json, "pid", getpid());
    tool_json_count(&line.json, "frames", frames);
    end(log, &line);
    return 0;
}

static void put_stages(struct tool_json *j, const double ms[CLI_STAGES])
{
    char name[32];
    for (int s = 0; s < CLI_STAGES; s++) {
        snprintf(name, sizeof(name), "%s_ms", cli_stage_names[s]);
        tool_json_ms(j, name, ms[s]);
    }
}

static void put_views(struct tool_json *j, const struct cli_frame *frame)
{
    tool_json_open(j, "views", '[');
    for (int i = 0; i < frame->view_count; i++) {
        const struct cli_view *v = &frame->views[i];
        const struct cli_setup *s = &v->setup;
        tool_json_open(j, NULL, '{');
        tool_json_text(j, "name", v->view->name);
        tool_json_text(j, "layer", v->view->layer);
        cli_json_surfaces(j, v);
        cli_json_map(j, v);
        tool_json_number(j, "focus", s->focus_from && s->params.focus > 0 ? s->params.focus : NAN);
        tool_json_text(j, "focus_from", s->focus_from);
        tool_json_number(j, "max_radius", v->report.params.max_radius);
        tool_json_number(j, "near_radius", v->report.all.near_radius);
        tool_json_number(j, "far_radius", v->report.all.far_radius);
        tool_json_flag(j, "limited", cli_is_limited(v));
        cli_guessed_json(j, frame, v);
        tool_json_count(j, "warnings", cli_warnings_of(frame, v));
        cli_choose_json(j, s, 1e-6 * v->view->width * v->view->height);
        if (s->params.run.budget_ms > 0)
            tool_json_flag(j, "budget_missed", cli_missed_budget(v));
        tool_json_count(j, "colour_repaired", (long long)v->report.all.colour_repaired);
        tool_json_count(j, "depth_repaired", (long long)v->report.all.depth_repaired);
        tool_json_close(j);
    }
    tool_json_close(j);
}

void cli_log_frame(struct cli_log *log, const struct cli_record *r)
{
    static const char *const names[] = {"done", "skipped", "failed"};
    struct line line;
    struct tool_json *j = &line.json;
    if (begin(log, &line, "frame"))
        return;
    tool_json_text(j, "status", names[r->status]);
    if (r->job->numbered)
        tool_json_count(j, "frame", r->job->frame);
    tool_json_text(j, "input", r->job->input);
    tool_json_text(j, "output", r->job->output);
    tool_json_ms(j, "ms", r->ms);
    tool_json_ms(j, "waited_ms", r->waited_ms);
    tool_json_text(j, "hash", r->stamp->hash);
    tool_json_text(j, "settings", r->stamp->settings);
    if (r->status == CLI_FRAME_DONE) {
        put_stages(j, r->frame->ms);
        put_views(j, r->frame);
        cli_json_warnings(j, r->frame);
        tool_json_count(j, "clamped", (long long)r->frame->written.clamped);
        tool_json_text(j, "engine", hf_engine_name(r->report->params.engine));
        tool_json_count(j, "budget_step", r->report->all.budget_step);
        if (r->report->all.budget_steps)
            tool_json_text(j, "budget_options", r->report->inner.budget_options);
    }
    if (r->why)
        tool_json_text(j, "error", r->why);
    end(log, &line);
}

void cli_log_end(struct cli_log *log, const struct cli_progress *p, int at_once, int budget_missed, double peak_memory)
{
    struct line line;
    struct tool_json *j = &line.json;
    double ms[CLI_STAGES];
    if (begin(log, &line, "end"))
        return;
    const double seconds = (tool_now_ms() - p->start) / 1000;
    tool_json_count(j, "frames", p->total);
    tool_json_count(j, "done", p->done);
    tool_json_count(j, "skipped", p->skipped);
    tool_json_count(j, "failed", p->failed);
    tool_json_count(j, "budget_missed", budget_missed);
    tool_json_count(j, "at_once", at_once);
    tool_json_number(j, "seconds", seconds);
    tool_json_number(j, "frames_per_second", seconds > 0 ? p->done / seconds : 0);
    tool_json_count(j, "peak_memory", (long long)peak_memory);
    for (int s = 0; s < CLI_STAGES; s++)
        ms[s] = (double)p->us[s] / 1000;
    put_stages(j, ms);
    end(log, &line);
}

int cli_log_close(struct cli_log *log, struct tool_error *error)
{
    if (log->path && close(log->fd))
        lose(log, errno);
    const char *path = log->path;
    log->path = NULL;
    const int code = atomic_load(&log->error);
    return code ? tool_fail(error, CLI_ALL_FAILED, "--log %s: cannot write: %s", path, strerror(code)) : 0;
}
