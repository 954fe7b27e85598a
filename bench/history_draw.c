// SPDX-License-Identifier: BSD-3-Clause
// Nine small charts over the same points: frames of each engine, memory, and distances on each ray-traced scene.
#include "history.h"

#include "others.h"
#include "page_chart.h"
#include "tools/common/report.h"

#include <math.h>
#include <string.h>

enum {
    COLUMNS = 3,
    WIDTH = 380,
    HEIGHT = 230,
    LEFT = 46,
    RIGHT = 14,
    TOP = 44,
    BOTTOM = 34,
    LEGEND = 18,
    MACHINES = 26
};

struct panel {
    const char *title, *unit;
    // The lines of which it is made: names with the engine, or the scene, in place of %s.
    const char *line[TOOL_ENGINES];
    char name[TOOL_ENGINES][HISTORY_NAME];
    const char *style[TOOL_ENGINES];
    int lines;
    int from_zero;  // the axis begins at 0
    int of_truth;   // a line ends where the pictures change, not where the machine does
};

struct view {
    FILE *out;
    const struct history *h;
    const struct panel *panel;
    double x0, y0;       // of the panel
    double least, most;  // of the axis
};

static void put_xml(FILE *out, const char *text)
{
    for (; *text; text++)
        switch (*text) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        case '>':
            fputs("&gt;", out);
            break;
        case '"':
            fputs("&quot;", out);
            break;
        default:
            fputc(*text, out);
        }
}

// The mean over the scenes of what a frame takes; NAN unless all are there.
static double value_of(const struct history_point *p, const char *name)
{
    static const char mean[] = "/truth";
    const size_t n = strlen(name) - strlen(mean);
    if (strlen(name) < sizeof mean || strcmp(name + n, mean))
        return history_get(p, "%s", name);
    double sum = 0;
    for (int s = 0; s < BENCH_OTHERS; s++)
        sum += history_get(p, "%.*s/%s", (int)n, name, bench_others[s].scene) / BENCH_OTHERS;
    return sum;
}

static double x_of(const struct view *v, int point)
{
    const double n = v->h->points > 1 ? v->h->points - 1 : 1;
    return v->x0 + LEFT + (WIDTH - LEFT - RIGHT) * (v->h->points > 1 ? point / n : 0.5);
}

static double y_of(const struct view *v, double value)
{
    return v->y0 + TOP + (HEIGHT - TOP - BOTTOM) * (v->most - value) / (v->most - v->least);
}

// A round number at or above x / 5: what lies between two lines of the grid.
static double grid_step(double x)
{
    const double power = pow(10, floor(log10(x / 5))), of = x / 5 / power;
    return power * (of <= 1 ? 1 : of <= 2 ? 2 : of <= 5 ? 5 : 10);
}

// Returns 0 if there is nothing to draw.
static int find_range(struct view *v)
{
    v->least = INFINITY;
    v->most = -INFINITY;
    for (int l = 0; l < v->panel->lines; l++)
        for (int i = 0; i < v->h->points; i++) {
            const double value = value_of(&v->h->point[i], v->panel->name[l]);
            if (!isnan(value)) {
                v->least = fmin(v->least, value);
                v->most = fmax(v->most, value);
            }
        }
    if (!(v->least <= v->most))
        return 0;
    if (v->panel->from_zero)
        v->least = 0;
    const double step = grid_step(fmax(v->most - v->least, 1e-3 * (fabs(v->most) + 1)));
    v->least = step * floor(v->least / step);
    v->most = step * ceil(v->most / step);
    if (v->most == v->least)
        v->most += step;
    return 1;
}

static void draw_axes(const struct view *v)
{
    const double step = grid_step(v->most - v->least);
    const int n = (int)((v->most - v->least) / step + 0.5), last = v->h->points - 1;
    for (int i = 0; i <= n; i++) {
        const double value = v->least + i * step, y = y_of(v, value);
        fprintf(
            v->out,
            "<path class=\"grid\" d=\"M%.1f %.1fH%.1f\"/><text class=\"tick end\" x=\"%.1f\" y=\"%.1f\">%g</text>\n",
            v->x0 + LEFT, y, v->x0 + WIDTH - RIGHT, v->x0 + LEFT - 6, y + 4, value);
    }
    const double y = v->y0 + HEIGHT - BOTTOM + 16;
    fprintf(v->out, "<text class=\"tick\" x=\"%.1f\" y=\"%.1f\">%.7s</text>\n", v->x0 + LEFT, y, v->h->point[0].commit);
    if (last > 0)
        fprintf(v->out, "<text class=\"tick end\" x=\"%.1f\" y=\"%.1f\">%.7s</text>\n", v->x0 + WIDTH - RIGHT, y,
                v->h->point[last].commit);
}

static int goes_on(const struct panel *panel, const struct history_point *a, const struct history_point *b)
{
    return panel->of_truth ? !strcmp(a->truth, b->truth) : history_same_machine(a, b);
}

static void draw_line(const struct view *v, int line)
{
    const char *style = v->panel->style[line], *name = v->panel->name[line];
    int last = -1;
    fprintf(v->out, "<path class=\"line %s\" d=\"", style);
    for (int i = 0; i < v->h->points; i++) {
        const struct history_point *p = &v->h->point[i];
        const double value = value_of(p, name);
        if (isnan(value))
            continue;
        fprintf(v->out, "%c%.1f %.1f", last >= 0 && goes_on(v->panel, &v->h->point[last], p) ? 'L' : 'M', x_of(v, i),
                y_of(v, value));
        last = i;
    }
    fputs("\"/>\n", v->out);
    for (int i = 0; i < v->h->points; i++) {
        const struct history_point *p = &v->h->point[i];
        const double value = value_of(p, name);
        if (isnan(value))
            continue;
        fprintf(v->out, "<circle class=\"%s on\" cx=\"%.1f\" cy=\"%.1f\" r=\"2.5\"><title>", style, x_of(v, i),
                y_of(v, value));
        fprintf(v->out, "%s: %.4g %s, ", v->panel->line[line], value, v->panel->unit);
        put_xml(v->out, p->commit);
        fputs(", ", v->out);
        put_xml(v->out, p->date);
        fputs(", ", v->out);
        put_xml(v->out, p->cpu);
        fputs(", ", v->out);
        put_xml(v->out, p->source);
        fputs("</title></circle>\n", v->out);
    }
}

static void draw_panel(struct view *v, const struct panel *panel, int place)
{
    v->panel = panel;
    v->x0 = (double)(place % COLUMNS) * WIDTH;
    v->y0 = (double)(place / COLUMNS) * HEIGHT + 24;
    fprintf(v->out, "<text x=\"%.1f\" y=\"%.1f\">%s, %s</text>\n", v->x0 + LEFT, v->y0 + 14, panel->title, panel->unit);
    double x = v->x0 + LEFT;
    for (int l = 0; l < panel->lines; l++) {
        fprintf(v->out,
                "<path class=\"line %s\" d=\"M%.1f %.1fh12\"/><text class=\"tick\" x=\"%.1f\" y=\"%.1f\">%s</text>\n",
                panel->style[l], x, v->y0 + 27, x + 15, v->y0 + 31, panel->line[l]);
        x += 24 + 6.2 * (double)strlen(panel->line[l]);
    }
    if (!find_range(v))
        return;
    draw_axes(v);
    for (int l = 0; l < panel->lines; l++)
        draw_line(v, l);
}

static void add_line(struct panel *panel, const char *words, const char *style, const char *format, const char *engine,
                     const char *scene)
{
    const int l = panel->lines++;
    panel->line[l] = words;
    panel->style[l] = style;
    snprintf(panel->name[l], sizeof panel->name[l], format, engine, scene);
}

static struct panel engine_panel(const char *engine)
{
    struct panel p = {.title = engine, .unit = "ms", .from_zero = 1};
    add_line(&p, "mixed, 1920x1080", engine, "ms %s%s", engine, "");
    add_line(&p, "truth scenes, 1280x720, mean", "grey", "ms %s%s", engine, "/truth");
    return p;
}

// Of all engines: what the format makes of their names and the scene's.
static struct panel all_panel(const char *title, const char *unit, const char *format, const char *scene)
{
    struct panel p = {.title = title, .unit = unit, .from_zero = !*scene, .of_truth = *scene != '\0'};
    for (int e = 0; e < tool_engines(); e++) {
        const char *engine = hf_engine_name((enum hf_engine)e);
        add_line(&p, engine, engine, format, engine, scene);
    }
    return p;
}

static int is_first_of_machine(const struct history *h, int i)
{
    for (int k = 0; k < i; k++)
        if (history_same_machine(&h->point[k], &h->point[i]))
            return 0;
    return 1;
}

static void draw_machines(FILE *out, const struct history *h, double y)
{
    for (int i = 0, n = 0; i < h->points && n < MACHINES; i++) {
        const struct history_point *p = &h->point[i];
        if (!is_first_of_machine(h, i))
            continue;
        n++;
        fprintf(out, "<text class=\"tick\" x=\"%d\" y=\"%.1f\">from %.7s on: ", LEFT, y, p->commit);
        put_xml(out, p->cpu);
        fprintf(out, ", %s, %g threads", p->isa, history_get(p, "threads"));
        const double copy = history_get(p, "memcpy_ms"), fma = history_get(p, "fma_gflops");
        if (!isnan(copy) && !isnan(fma))
            fprintf(out, ", memcpy %.3g ms, peak %.0f GFLOP/s", copy, fma);
        fputs("</text>\n", out);
        y += LEGEND;
    }
}

void history_draw(FILE *out, const struct history *h)
{
    struct view v = {.out = out, .h = h};
    int machines = 0, place = 0;
    for (int i = 0; i < h->points; i++)
        machines += is_first_of_machine(h, i);
    const int panels = tool_engines() + 1 + BENCH_OTHERS, rows = (panels + COLUMNS - 1) / COLUMNS;
    const int width = COLUMNS * WIDTH, height = 24 + rows * HEIGHT + (machines + 2) * LEGEND;
    fprintf(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\">\n"
        "<style>\n%s.chart .line { stroke-width: 1.4; fill: none; }\n.chart .grey { stroke: #777; }\n"
        ".chart .grey.on { fill: #777; }\n</style>\n<rect class=\"paper\" width=\"%d\" height=\"%d\"/>\n",
        width, height, width, height, chart_style, width, height);
    if (h->points)
        fprintf(out, "<text x=\"%d\" y=\"16\">%d points, %s to %s</text>\n", LEFT, h->points, h->point[0].date,
                h->point[h->points - 1].date);
    for (int e = 0; e < tool_engines() && h->points; e++) {
        const struct panel p = engine_panel(hf_engine_name((enum hf_engine)e));
        draw_panel(&v, &p, place++);
    }
    const struct panel memory = all_panel("memory held, mixed, 1920x1080", "MB", "MB %s%s", "");
    if (h->points)
        draw_panel(&v, &memory, place++);
    for (int s = 0; s < BENCH_OTHERS && h->points; s++) {
        const struct panel p = all_panel(bench_others[s].scene, "dB", "dB %s/%s", bench_others[s].scene);
        draw_panel(&v, &p, place++);
    }
    double y = 24 + (double)rows * HEIGHT + LEGEND;
    fprintf(
        out,
        "<text class=\"tick\" x=\"%d\" y=\"%.1f\">A line of times ends where the machine changes, one of dB where the "
        "ray-traced pictures do.</text>\n",
        LEFT, y);
    draw_machines(out, h, y + LEGEND);
    fputs("</svg>\n", out);
}
