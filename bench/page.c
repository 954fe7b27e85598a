// SPDX-License-Identifier: BSD-3-Clause
#include "page.h"

#include "jpeg.h"
#include "others.h"
#include "page_chart.h"
#include "peels.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static const char style[] =
#include "page_css.h"
    ;
static const char script[] =
#include "page_js.h"
    ;

enum { WIDE = 860, WIDE_HEIGHT = 560, NARROW = 390, NARROW_HEIGHT = 430 };

static void text(FILE *out, const char *s)
{
    for (; *s; s++)
        if (*s == '<')
            fputs("&lt;", out);
        else if (*s == '&')
            fputs("&amp;", out);
        else
            fputc(*s, out);
}

static void heading(FILE *out, const struct trade *t)
{
    fputs(
        "<header><h1>What accuracy costs</h1>\n<p>Every point is a setting: the time of a frame with it, and the "
        "distance of its picture from what a ray-traced lens sees. Down and to the left is better. The line is the "
        "front: a smaller error than there takes longer. Point at a setting, or reach it with the Tab and arrow keys, "
        "to see its picture, its passes and the commands that make it.</p>\n<p class=\"soft\">",
        out);
    text(out, t->cpu);
    fprintf(out, ", %s, %d thread%s; %s; hyperfocal %s, commit ", hf_isa_name(t->isa), t->threads,
            t->threads == 1 ? "" : "s", t->date, hf_version());
    text(out, t->commit);
    fprintf(out,
            ".<br>Made by <code>hyperfocal-bench tradeoff%s --html FILE</code>; times are medians of frames of the "
            "scenes (",
            t->args->quick ? " --quick" : "");
    for (int s = 0; s < t->scenes; s++) {
        fputs(s ? ", " : "", out);
        text(out, t->scene[s].text);
        fprintf(out, " %d x %d", t->width[s], t->height[s]);
    }
    fputs("), whiskers their quartiles.</p>\n", out);
    trade_sentences(out, t, "<p>", "</p>");
    fputs("</header>\n", out);
}

static void charts(FILE *out, const struct trade *t)
{
    int shown = 0;
    fputs("<div class=\"tabs\" role=\"group\" aria-label=\"What to show\">", out);
    for (int i = 0; i < trade_chart_count; i++)
        if (chart_points(t, &trade_charts[i]))
            fprintf(out, "<button data-view=\"%s\" aria-pressed=\"%s\">%s</button>", trade_charts[i].id,
                    shown++ ? "false" : "true", trade_charts[i].name);
    fputs("</div>\n<div class=\"stage\"><div>\n", out);
    shown = 0;
    for (int i = 0; i < trade_chart_count; i++) {
        const struct chart *c = &trade_charts[i];
        if (!chart_points(t, c))
            continue;
        fprintf(out, "<section class=\"view%s\" id=\"view-%s\"><p class=\"soft\">%s</p>\n<div class=\"wide\">",
                shown++ ? "" : " shown", c->id, c->title);
        chart_write(out, t, c, WIDE, WIDE_HEIGHT, 0);
        fputs("</div><div class=\"narrow\">", out);
        chart_write(out, t, c, NARROW, NARROW_HEIGHT, 0);
        fputs("</div></section>\n", out);
    }
    fputs("<p class=\"soft\">Filled: on the front. Pale: perhaps on it, because times overlap. Hollow: another setting "
          "is surely faster and errs no more. Crosses were measured elsewhere: Blender 3.4's Defocus and GEGL "
          "0.4.42's lens-blur, each given the exact radius, on two threads. GTX 660: the chapter's figure for "
          "1920 x 1080.</p></div>\n"
          "<aside class=\"detail\" id=\"detail\" aria-live=\"polite\"></aside></div>\n",
          out);
}

static void cell(FILE *out, int digits, double v)
{
    if (isfinite(v))
        fprintf(out, "<td>%.*f</td>", digits, v);
    else
        fputs("<td>-</td>", out);
}

static void small_cell(FILE *out, double v)
{
    if (isfinite(v))
        fprintf(out, "<td>%.1e</td>", v);
    else
        fputs("<td>-</td>", out);
}

static void row(FILE *out, const struct trade *t, int i, const struct trade_result *before)
{
    const struct trade_result *r = &t->result[i];
    static const char *const ranks[] = {"", "overlaps", "front"};
    fprintf(out, "<tr data-i=\"%d\"%s><td>", i, r->rank == TRADE_FRONT ? " class=\"front\"" : "");
    text(out, r->setting->name);
    fprintf(out, "</td><td>%s</td><td>", ranks[r->rank]);
    if (r->step)
        fprintf(out, "%d", r->step);
    fprintf(out, "</td><td>%s%.2f</td>", before && trade_overlap(before->ms, r->ms) ? "&asymp; " : "", r->ms.median);
    cell(out, 2, r->both_ms.median);
    for (int s = 0; s < t->scenes; s++)
        cell(out, 2, r->at[s].distance[BENCH_WHOLE].psnr);
    cell(out, 2, -20 * log10(r->error));
    small_cell(out, r->rounding);
    small_cell(out, r->faithfulness);
    fputs("<td><code>", out);
    text(out, r->setting->options);
    fputs("</code></td></tr>\n", out);
}

static void table(FILE *out, const struct trade *t)
{
    int order[TRADE_SETTINGS];
    trade_order(t, order);
    fputs(
        "<h2>All settings</h2>\n<p class=\"soft\">By time; &asymp; overlaps the row above: their order is chance. "
        "The step is that of the ladder from which <code>--quality</code>, <code>--max-error</code> and "
        "<code>--budget-ms</code> choose.</p>\n<div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th>setting</th>"
        "<th></th><th>step</th><th>ms</th><th>1080p ms</th>",
        out);
    for (int s = 0; s < t->scenes; s++) {
        fputs("<th>", out);
        text(out, t->scene[s].text);
        fputs(" dB</th>", out);
    }
    fputs("<th>mean dB</th><th>rounding</th><th>demo</th><th>options</th></tr></thead><tbody>\n", out);
    for (int i = 0; i < t->results; i++)
        row(out, t, order[i], i ? &t->result[order[i - 1]] : NULL);
    fputs("</tbody></table></div>\n", out);
}

static void taps_table(FILE *out, const struct trade *t)
{
    struct trade_taps taps;
    int n = 0;
    for (int i = 0; i < t->results; i++) {
        if (!trade_taps(t, i, &taps))
            continue;
        if (!n++)
            fputs(
                "<h2>Taps</h2>\n<p class=\"soft\">The chapter, all taps with the same reach: milliseconds of two "
                "passes and of the frame, 1920 x 1080 blurred everywhere by 12 pixels; dB of the scenes.</p>\n"
                "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th>taps</th><th>Computation</th><th>Fill</th>"
                "<th>frame</th><th>mean dB</th><th>options</th></tr></thead><tbody>\n",
                out);
        fprintf(out, "<tr data-i=\"%d\"><td>", i);
        text(out, taps.name);
        fputs("</td>", out);
        cell(out, 2, taps.computation);
        cell(out, 2, taps.fill);
        cell(out, 2, taps.frame);
        cell(out, 2, taps.db);
        fputs("<td><code>", out);
        text(out, t->result[i].setting->options);
        fputs("</code></td></tr>\n", out);
    }
    if (n)
        fputs("</tbody></table></div>\n", out);
}

// What a second and a third surface of each pixel are worth.
static void surfaces(FILE *out, const struct trade *t)
{
    if (!t->peels[0])
        return;
    fputs("<h2>Surfaces known</h2>\n<p>layers, with one picture and with the surfaces behind it "
          "(<code>--peel</code>).</p>\n"
          "<div class=\"scroll\"><table><thead><tr><th>scene</th><th>surfaces</th><th>standard, dB</th><th>ms</th>"
          "<th>best, dB</th><th>ms</th></tr></thead><tbody>\n",
          out);
    for (int s = 0; s < t->peels[0]->count; s++)
        for (int k = 0; k < t->peels[0]->scenes[s].known; k++) {
            fprintf(out, "<tr><td>%s</td><td>%d</td>", k ? "" : t->peels[0]->scenes[s].name, k + 1);
            for (int i = 0; i < TRADE_PEELS && t->peels[i]; i++)
                fprintf(out, "<td>%.2f</td><td>%.1f</td>", t->peels[i]->scenes[s].at[k].psnr,
                        t->peels[i]->scenes[s].at[k].ms);
            fputs("</tr>\n", out);
        }
    fputs("</tbody></table></div>\n", out);
}

static void others(FILE *out, const struct trade *t)
{
    int n = 0;
    for (int s = 0; s < t->scenes; s++)
        for (int i = 0; i < BENCH_OTHERS; i++)
            n += !strcmp(t->scene[s].text, bench_others[i].scene);
    if (!n)
        return;
    fputs(
        "<h2>Measured elsewhere</h2>\n<div class=\"scroll\"><table><thead><tr><th>scene</th><th>as it is, dB</th>"
        "<th>Blender Defocus, dB</th><th>seconds</th><th>GEGL lens-blur, dB</th><th>seconds</th></tr></thead><tbody>\n",
        out);
    for (int i = 0; i < BENCH_OTHERS; i++)
        fprintf(out, "<tr><td>%s</td><td>%.2f</td><td>%.2f</td><td>%.1f</td><td>%.2f</td><td>%.1f</td></tr>\n",
                bench_others[i].scene, bench_others[i].none, bench_others[i].blender, bench_others[i].blender_s,
                bench_others[i].gegl, bench_others[i].gegl_s);
    fputs("</tbody></table></div>\n", out);
}

// The same window of every scene, from each setting and from the truth.
static int crop(FILE *out, const struct trade_scene *s, const float *rgb, struct tool_error *error)
{
    const int w = s->picture.width < TRADE_CROP_WIDTH ? s->picture.width : TRADE_CROP_WIDTH;
    const int h = s->picture.height < TRADE_CROP_HEIGHT ? s->picture.height : TRADE_CROP_HEIGHT;
    fputc('"', out);
    if (bench_jpeg_uri(out, rgb, s->picture.width, s->crop_x, s->crop_y, w, h))
        return tool_fail(error, -1, "--html: there is not enough memory for a picture");
    fputc('"', out);
    return 0;
}

static int crops(FILE *out, struct trade_run *run, struct tool_error *error)
{
    const struct trade *t = run->t;
    fputs("<script type=\"application/json\" id=\"crops\">{\"settings\":[", out);
    for (int i = 0; i < t->results && bench_jpeg_available(); i++) {
        fputs(i ? ",\n[" : "[", out);
        for (int s = 0; s < t->scenes; s++) {
            fputs(s ? "," : "", out);
            if (trade_run_render(run, i, s, error) || crop(out, &run->scene[s], trade_run_picture(run, s), error))
                return -1;
        }
        fputc(']', out);
    }
    fputs("],\"truth\":[", out);
    for (int s = 0; s < t->scenes && bench_jpeg_available(); s++) {
        fputs(s ? "," : "", out);
        if (crop(out, &run->scene[s], run->scene[s].truth.rgb, error))
            return -1;
    }
    fputs("]}</script>\n", out);
    return 0;
}

static int write_page(FILE *out, struct trade_run *run, struct tool_error *error)
{
    const struct trade *t = run->t;
    fprintf(out,
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
            "content=\"width=device-width, initial-scale=1\">\n<title>hyperfocal: what accuracy costs</title>\n"
            "<link rel=\"icon\" href=\"data:,\">\n<style>\n%s%s</style>\n</head>\n<body>\n",
            chart_style, style);
    heading(out, t);
    fputs("<main>\n", out);
    charts(out, t);
    table(out, t);
    taps_table(out, t);
    surfaces(out, t);
    others(out, t);
    fputs("</main>\n<script type=\"application/json\" id=\"numbers\">", out);
    trade_json(out, t);
    fputs("</script>\n", out);
    if (crops(out, run, error))
        return -1;
    fprintf(out, "<script>\n%s</script>\n</body>\n</html>\n", script);
    return 0;
}

int bench_page_write(struct trade_run *run, const char *path, struct tool_error *error)
{
    FILE *f = fopen(path, "w");
    if (!f)
        return tool_fail(error, -1, "--html: cannot write %s: %s", path, strerror(errno));
    const int err = write_page(f, run, error), failed = ferror(f);
    if (fclose(f) || failed)
        return err ? -1 : tool_fail(error, -1, "--html: cannot write %s: %s", path, strerror(errno));
    return err;
}

// Run a program from PATH, without its stdout. Returns its exit status, or 127 if it is not installed.
static int run_program(char *const words[])
{
    pid_t child;
    int status;
    posix_spawn_file_actions_t quiet;
    if (posix_spawn_file_actions_init(&quiet))
        return 126;
    posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    const int failed =
        posix_spawnp(&child, words[0], &quiet, NULL, words, environ) || waitpid(child, &status, 0) != child;
    posix_spawn_file_actions_destroy(&quiet);
    return failed ? 127 : WIFEXITED(status) ? WEXITSTATUS(status) : 126;
}

static int no_converter(struct tool_error *error)
{
    return tool_fail(error, -1, "--png needs the program rsvg-convert (Debian: librsvg2-bin)");
}

int bench_page_png_check(struct tool_error *error)
{
    char *const words[] = {"rsvg-convert", "--version", NULL};
    return run_program(words) ? no_converter(error) : 0;
}

int bench_page_png(const struct trade *t, const char *path, struct tool_error *error)
{
    char svg[] = "/tmp/hyperfocal-chart-XXXXXX";
    const int fd = mkstemp(svg);
    FILE *f = fd < 0 ? NULL : fdopen(fd, "w");
    if (!f)
        return tool_fail(error, -1, "--png: cannot write %s: %s", svg, strerror(errno));
    chart_write(f, t, &trade_charts[0], WIDE, WIDE_HEIGHT, 1);
    const int failed = ferror(f);
    char *const words[] = {"rsvg-convert", "--zoom", "2", "--output", (char *)path, svg, NULL};
    const int status = fclose(f) || failed ? 126 : run_program(words);
    unlink(svg);
    if (status == 127)
        return no_converter(error);
    return status ? tool_fail(error, -1, "--png: cannot write %s", path) : 0;
}
