// SPDX-License-Identifier: BSD-3-Clause
#include "cli/log.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "cli/json.h"

// A line is put together first and written in one piece: several threads, and several processes, may share the file.
static FILE *begin(const struct cli_log *log, char **line, size_t *size)
{
    *line = NULL;
    FILE *out = log->out ? open_memstream(line, size) : NULL;
    const time_t now = time(NULL);
    struct tm utc;
    char text[32];
    if (!out)
        return NULL;
    strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
    fprintf(out, "{\"time\": \"%s\"", text);
    return out;
}

static void end(struct cli_log *log, FILE *out, char **line, const size_t *size)
{
    fputs("}\n", out);
    const int failed = ferror(out);
    if (!fclose(out) && !failed)
        fwrite(*line, 1, *size, log->out);
    fflush(log->out);
    free(*line);
}

int cli_log_open(struct cli_log *log, const char *path, int argc, char **argv, int frames, struct cli_error *error)
{
    char host[64] = "", *line;
    size_t size;
    *log = (struct cli_log){NULL};
    if (!path)
        return 0;
    log->out = fopen(path, "ae");
    if (!log->out)
        return cli_fail(error, CLI_BAD_ARGUMENTS, "--log %s cannot be written: %s", path, strerror(errno));
    FILE *out = begin(log, &line, &size);
    if (!out)
        return 0;
    gethostname(host, sizeof(host) - 1);
    fputs(", \"event\": \"begin\", \"command\": ", out);
    cli_json_command(out, argc, argv);
    fprintf(out, ", \"version\": \"%s\", \"host\": ", hf_version());
    cli_json_text(out, host);
    fprintf(out, ", \"pid\": %ld, \"frames\": %d", (long)getpid(), frames);
    end(log, out, &line, &size);
    return 0;
}

static void put_stages(FILE *out, const struct cli_frame *frame)
{
    for (int s = 0; s < CLI_STAGES; s++)
        fprintf(out, ", \"%s_ms\": %.3f", cli_stage_names[s], frame->ms[s]);
}

static void put_views(FILE *out, const struct cli_frame *frame)
{
    fputs(", \"views\": [", out);
    for (int i = 0; i < frame->view_count; i++) {
        const struct cli_view *v = &frame->views[i];
        const struct cli_setup *s = &v->setup;
        fputs(i ? ", {\"name\": " : "{\"name\": ", out);
        cli_json_text(out, v->view->name);
        fputs(", \"focus\": ", out);
        cli_json_number(out, s->focus_from && s->params.focus > 0 ? s->params.focus : NAN);
        fputs(", \"focus_from\": ", out);
        cli_json_text(out, s->focus_from);
        fputs(", \"max_radius\": ", out);
        cli_json_number(out, v->report.used.params.max_radius);
        fprintf(out, ", \"colour_repaired\": %llu, \"depth_repaired\": %llu}",
                (unsigned long long)v->report.colour_repaired, (unsigned long long)v->report.depth_repaired);
    }
    fputc(']', out);
}

void cli_log_frame(struct cli_log *log, const struct cli_record *r)
{
    static const char *const names[] = {"done", "skipped", "failed"};
    char *line;
    size_t size;
    FILE *out = begin(log, &line, &size);
    if (!out)
        return;
    fprintf(out, ", \"event\": \"frame\", \"status\": \"%s\"", names[r->status]);
    if (r->job->numbered)
        fprintf(out, ", \"frame\": %d", r->job->frame);
    fputs(", \"input\": ", out);
    cli_json_text(out, r->job->input);
    fputs(", \"output\": ", out);
    cli_json_text(out, r->job->output);
    fprintf(out, ", \"ms\": %.3f, \"waited_ms\": %.3f, \"hash\": \"%s\", \"settings\": ", r->ms, r->waited_ms,
            r->stamp->hash);
    cli_json_text(out, r->stamp->settings);
    if (r->status == CLI_FRAME_DONE) {
        put_stages(out, r->frame);
        put_views(out, r->frame);
        fprintf(out, ", \"clamped\": %llu, \"engine\": \"%s\", \"budget_step\": %d",
                (unsigned long long)r->frame->written.clamped, hf_engine_name(r->report->used.params.engine),
                r->report->budget_step);
    }
    if (r->why) {
        fputs(", \"error\": ", out);
        cli_json_text(out, r->why);
    }
    end(log, out, &line, &size);
}

void cli_log_end(struct cli_log *log, const struct cli_progress *p, int at_once, double peak_memory)
{
    char *line;
    size_t size;
    FILE *out = begin(log, &line, &size);
    if (!out)
        return;
    const double seconds = (cli_now_ms() - p->start) / 1000;
    fprintf(out, ", \"event\": \"end\", \"frames\": %d, \"done\": %d, \"skipped\": %d, \"failed\": %d", p->total,
            (int)p->done, (int)p->skipped, (int)p->failed);
    fprintf(out, ", \"at_once\": %d", at_once);
    fprintf(out, ", \"seconds\": %.3f, \"frames_per_second\": %.4f, \"peak_memory\": %.0f", seconds,
            seconds > 0 ? p->done / seconds : 0, peak_memory);
    for (int s = 0; s < CLI_STAGES; s++)
        fprintf(out, ", \"%s_ms\": %.3f", cli_stage_names[s], (double)p->us[s] / 1000);
    end(log, out, &line, &size);
}

void cli_log_close(struct cli_log *log)
{
    if (log->out)
        fclose(log->out);
    log->out = NULL;
}
