// SPDX-License-Identifier: BSD-3-Clause
#include "page_chart.h"

#include "others.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEFT = 52, RIGHT = 46, TOP = 26, BOTTOM = 42, LABELS = 64 };

// One point of a chart.
struct mark {
    int result;  // index in the results; -1: another program
    const char *name;
    enum hf_engine engine;
    double x, low, high, y;
    enum trade_rank rank;  // in this chart
};

struct box {
    double x0, y0, x1, y1;
};

struct view {
    FILE *out;
    const struct trade *t;
    const struct chart *chart;
    int width, height;
    double x0, x1, y0, y1;  // logarithms of the range
    struct mark *mark;
    int marks;
    struct box taken[LABELS + 4 * TRADE_SETTINGS];
    int boxes;
};

// ---- the data of a chart ----

static double region_error(const struct trade *t, const struct trade_result *r, enum bench_region region)
{
    double logs = 0;
    int n = 0;
    for (int s = 0; s < t->scenes; s++)
        if (r->at[s].distance[region].share > 0) {
            logs += log(r->at[s].distance[region].display_rmse);
            n++;
        }
    return n ? exp(logs / n) : NAN;
}

static double flip(const struct trade *t, const struct trade_result *r, enum bench_region region)
{
    double sum = 0;
    for (int s = 0; s < t->scenes; s++)
        sum += r->at[s].distance[region].flip / t->scenes;
    return sum;
}

static double dissimilarity(const struct trade *t, const struct trade_result *r, enum bench_region region)
{
    double sum = 0;
    for (int s = 0; s < t->scenes; s++)
        sum += (1 - r->at[s].distance[region].ssim) / t->scenes;
    return sum;
}

static double linear(const struct trade *t, const struct trade_result *r, enum bench_region region)
{
    double logs = 0;
    for (int s = 0; s < t->scenes; s++)
        logs += log(r->at[s].distance[region].linear_rmse) / t->scenes;
    return exp(logs);
}

static double flicker(const struct trade *t, const struct trade_result *r, enum bench_region region)
{
    double sum = 0;
    (void)region;
    for (int s = 0; s < t->scenes; s++)
        sum += r->at[s].flicker / t->scenes;
    return sum;
}

static double rounding(const struct trade *t, const struct trade_result *r, enum bench_region region)
{
    (void)t;
    (void)region;
    return r->rounding;
}

static double faithfulness(const struct trade *t, const struct trade_result *r, enum bench_region region)
{
    (void)t;
    (void)region;
    return r->faithfulness;
}

const struct chart trade_charts[] = {
    {"truth", "truth", "RMSE from the ray-traced truth, display-encoded", 0, region_error, BENCH_WHOLE, 1},
    {"both", "truth, 1080p", "the same, over the time of 1920x1080 blurred everywhere by 12 pixels", 1, region_error,
     BENCH_WHOLE, 1},
    {"edges", "silhouettes", "RMSE from the truth within reach of a depth edge", 0, region_error, BENCH_SILHOUETTES, 1},
    {"near", "near", "RMSE from the truth in front of the focus, no silhouettes", 0, region_error, BENCH_NEAR, 1},
    {"far", "far", "RMSE from the truth behind the focus, no silhouettes", 0, region_error, BENCH_FAR, 1},
    {"focus", "in focus", "RMSE from the truth in focus, no silhouettes", 0, region_error, BENCH_FOCUS, 1},
    {"lights", "highlights", "RMSE from the truth within reach of a highlight", 0, region_error, BENCH_HIGHLIGHTS, 1},
    {"flip", "FLIP", "FLIP, mean: what a person sees of the difference from the truth", 0, flip, BENCH_WHOLE, 0},
    {"ssim", "SSIM", "1 - SSIM, to the truth", 0, dissimilarity, BENCH_WHOLE, 0},
    {"linear", "linear", "RMSE from the truth, linear light", 0, linear, BENCH_WHOLE, 0},
    {"rounding", "rounding", "RMSE from the same algorithm in double precision, linear", 0, rounding, BENCH_WHOLE, 0},
    {"demo", "faithfulness", "RMSE of the gather from the published demo, display-encoded", 0, faithfulness,
     BENCH_WHOLE, 0},
    {"flicker", "flicker", "second difference of a focus pull, display-encoded", 0, flicker, BENCH_WHOLE, 0},
};
const int trade_chart_count = sizeof trade_charts / sizeof *trade_charts;

static struct trade_interval time_of(const struct chart *c, const struct trade_result *r)
{
    return c->both ? r->both_ms : r->ms;
}

int chart_points(const struct trade *t, const struct chart *c)
{
    int n = 0;
    for (int i = 0; i < t->results; i++) {
        const double e = c->error(t, &t->result[i], c->region);
        n += isfinite(e) && e > 0 && time_of(c, &t->result[i]).median > 0;
    }
    return n;
}

// Add other programs' means over the scenes, if these are the scenes that the programs were measured on.
static void add_others(struct view *v)
{
    double blender = 0, blender_ms = 0, gegl = 0, gegl_ms = 0;
    int n = 0;
    for (int i = 0; i < BENCH_OTHERS; i++)
        for (int s = 0; s < v->t->scenes; s++)
            if (!strcmp(v->t->scene[s].text, bench_others[i].scene)) {
                blender += bench_others[i].blender / BENCH_OTHERS;
                blender_ms += 1e3 * bench_others[i].blender_s / BENCH_OTHERS;
                gegl += bench_others[i].gegl / BENCH_OTHERS;
                gegl_ms += 1e3 * bench_others[i].gegl_s / BENCH_OTHERS;
                n++;
            }
    if (n != BENCH_OTHERS || v->t->scenes != BENCH_OTHERS || v->chart->error != region_error ||
        v->chart->region != BENCH_WHOLE || v->chart->both)
        return;
    v->mark[v->marks++] = (struct mark){-1,         "Blender Defocus (elsewhere)", 0, blender_ms, blender_ms,
                                        blender_ms, pow(10, -blender / 20),        0};
    v->mark[v->marks++] =
        (struct mark){-1, "GEGL lens-blur (elsewhere)", 0, gegl_ms, gegl_ms, gegl_ms, pow(10, -gegl / 20), 0};
}

static int by_time(const void *a, const void *b)
{
    const struct mark *x = a, *y = b;
    return (x->x > y->x) - (x->x < y->x);
}

// Find the front of this chart: settings faster than all that err less. A setting is tied if it is not, but its time
// overlaps with that of each setting that errs no more.
static void find_front(struct view *v)
{
    double least = INFINITY;
    for (int i = 0; i < v->marks; i++)
        if (v->mark[i].result >= 0 && v->mark[i].y < least) {
            v->mark[i].rank = TRADE_FRONT;
            least = v->mark[i].y;
        }
    for (int i = 0; i < v->marks; i++) {
        struct mark *m = &v->mark[i];
        int tied = m->result >= 0 && m->rank != TRADE_FRONT;
        for (int k = 0; k < v->marks && tied; k++)
            tied = !(v->mark[k].result >= 0 && v->mark[k].y <= m->y && v->mark[k].high < m->low);
        m->rank = tied ? TRADE_TIED : m->rank;
    }
}

static int collect(struct view *v)
{
    v->mark = calloc(TRADE_SETTINGS + 2, sizeof *v->mark);
    if (!v->mark)
        return -1;
    for (int i = 0; i < v->t->results; i++) {
        const struct trade_result *r = &v->t->result[i];
        const struct trade_interval ms = time_of(v->chart, r);
        const double e = v->chart->error(v->t, r, v->chart->region);
        if (isfinite(e) && e > 0 && ms.median > 0)
            v->mark[v->marks++] = (struct mark){i, r->setting->name, r->engine, ms.median, ms.low, ms.high, e, 0};
    }
    add_others(v);
    qsort(v->mark, (size_t)v->marks, sizeof *v->mark, by_time);
    find_front(v);
    return 0;
}

// ---- positions ----

static double at_x(const struct view *v, double x)
{
    return LEFT + (log10(x) - v->x0) / (v->x1 - v->x0) * (v->width - LEFT - RIGHT);
}

static double at_y(const struct view *v, double y)
{
    return v->height - BOTTOM - (log10(y) - v->y0) / (v->y1 - v->y0) * (v->height - TOP - BOTTOM);
}

static void find_range(struct view *v)
{
    double x0 = 1.2, x1 = 40, y0 = INFINITY, y1 = 0;
    for (int i = 0; i < v->marks; i++) {
        x0 = fmin(x0, v->mark[i].low);
        x1 = fmax(x1, v->mark[i].high);
        y0 = fmin(y0, v->mark[i].y);
        y1 = fmax(y1, v->mark[i].y);
    }
    v->x0 = log10(x0 / 1.2);
    v->x1 = log10(x1 * 1.3);
    const double pad = fmax(0.06 * log10(y1 / y0), 0.04);
    v->y0 = log10(y0) - 2 * pad;
    v->y1 = log10(y1) + pad;
}

static int collides(const struct view *v, struct box b)
{
    if (b.x0 < LEFT || b.x1 > v->width - RIGHT || b.y0 < TOP || b.y1 > v->height - BOTTOM)
        return 1;
    for (int i = 0; i < v->boxes; i++) {
        const struct box *o = &v->taken[i];
        if (b.x0 < o->x1 && o->x0 < b.x1 && b.y0 < o->y1 && o->y0 < b.y1)
            return 1;
    }
    return 0;
}

static void take(struct view *v, struct box b)
{
    if (v->boxes < (int)(sizeof v->taken / sizeof *v->taken))
        v->taken[v->boxes++] = b;
}

// ---- drawing ----

static void escaped(FILE *out, const char *text)
{
    for (; *text; text++)
        if (*text == '<')
            fputs("&lt;", out);
        else if (*text == '&')
            fputs("&amp;", out);
        else if (*text == '"')
            fputs("&quot;", out);
        else
            fputc(*text, out);
}

// The next tick: at round numbers, as many per decade as there is room for.
static void next_tick(double *tick, double log_range, double pixels)
{
    static const double few[] = {2, 5, 10}, many[] = {1.5, 2, 3, 4, 5, 6, 7, 8, 9, 10}, none[] = {10};
    const double decade = pixels / log_range;
    const double *mantissa = decade > 500 ? many : decade > 90 ? few : none;
    const double power = pow(10, floor(log10(*tick * 1.0001)));
    while (*mantissa * power < *tick * 1.0001)
        mantissa++;
    *tick = *mantissa * power;
}

static void number(char *text, size_t size, double v)
{
    if (v >= 1e-3 && v < 1e5)
        snprintf(text, size, "%.*f", v >= 1 ? 0 : v >= 0.0999 ? 2 : v >= 0.00999 ? 3 : 4, v);
    else
        snprintf(text, size, "%.0e", v);
    // Remove zeros at the end of a fraction.
    for (size_t n = strlen(text);
         strchr(text, '.') && !strchr(text, 'e') && (text[n - 1] == '0' || text[n - 1] == '.');) {
        const int point = text[--n] == '.';
        text[n] = '\0';
        if (point)
            break;
    }
}

static void axes(struct view *v)
{
    const double right = v->width - RIGHT, bottom = v->height - BOTTOM;
    char text[32];
    for (double x = pow(10, floor(v->x0)); x < pow(10, v->x1); next_tick(&x, v->x1 - v->x0, right - LEFT)) {
        if (log10(x) < v->x0)
            continue;
        number(text, sizeof text, x);
        fprintf(v->out,
                "<path class=\"grid\" d=\"M%.1f %dV%.1f\"/><text class=\"tick mid\" x=\"%.1f\" y=\"%.1f\">%s</text>\n",
                at_x(v, x), TOP, bottom, at_x(v, x), bottom + 16, text);
    }
    for (double y = pow(10, floor(v->y0)); y < pow(10, v->y1); next_tick(&y, v->y1 - v->y0, bottom - TOP)) {
        if (log10(y) < v->y0)
            continue;
        number(text, sizeof text, y);
        fprintf(v->out,
                "<path class=\"grid\" d=\"M%d %.1fH%.1f\"/><text class=\"tick end\" x=\"%d\" y=\"%.1f\">%s</text>\n",
                LEFT, at_y(v, y), right, LEFT - 6, at_y(v, y) + 4, text);
        if (v->chart->decibel)
            fprintf(v->out, "<text class=\"tick\" x=\"%.1f\" y=\"%.1f\">%.0f dB</text>\n", right + 5, at_y(v, y) + 4,
                    -20 * log10(y));
    }
    fprintf(
        v->out,
        "<path class=\"axis\" d=\"M%d %dV%.1fH%.1f\"/>\n<text class=\"name mid\" x=\"%.1f\" y=\"%.1f\">milliseconds a "
        "frame%s</text>\n",
        LEFT, TOP, bottom, right, (LEFT + right) / 2, bottom + 34,
        v->width > 600 ? " (both axes are logarithmic)" : "");
}

// Draw a vertical line at a time. Its name runs upwards from the bottom, where no setting is both fast and accurate.
static void time_line(struct view *v, double ms, const char *name)
{
    const double x = at_x(v, ms), bottom = v->height - BOTTOM, length = 6.4 * (double)strlen(name);
    if (log10(ms) < v->x0 || log10(ms) > v->x1)
        return;
    fprintf(v->out,
            "<path class=\"limit\" d=\"M%.1f %dV%.1f\"/><text class=\"limitname\" transform=\"translate(%.1f "
            "%.1f)rotate(-90)\">%s</text>\n",
            x, TOP, bottom, x - 4, bottom - 6, name);
    take(v, (struct box){x - 15, bottom - 6 - length, x + 2, bottom});
}

static void front_line(struct view *v)
{
    const struct mark *last = NULL;
    fputs("<path class=\"front\" d=\"", v->out);
    for (int i = 0; i < v->marks; i++) {
        const struct mark *m = &v->mark[i];
        if (m->rank != TRADE_FRONT)
            continue;
        const double x = at_x(v, m->x), y = at_y(v, m->y);
        fprintf(v->out, last ? "H%.1fV%.1f" : "M%.1f %.1f", x, y);
        if (last) {
            take(v, (struct box){at_x(v, last->x), at_y(v, last->y) - 1, x, at_y(v, last->y) + 1});
            take(v, (struct box){x - 1, at_y(v, last->y), x + 1, y});
        }
        last = m;
    }
    fputs("\"/>\n", v->out);
}

// Each engine has its own shape, so that colour is not the only difference.
static void shape(FILE *out, int engine, double x, double y)
{
    static const char *const paths[] = {
        "m-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0z",  // gather: disc
        "m-5-3 5-3 5 3v6l-5 3-5-3z",             // hexagon
        "m-4.5-4.5h9v9h-9z",                     // scatter: square
        "m0-6 6 6-6 6-6-6z",                     // gaussian: diamond
        "m0-6.5 6 11h-12z",                      // layers: triangle
        "m-2-6h4v4h4v4h-4v4h-4v-4h-4v-4h4z",     // chapter: plus
    };
    const int n = sizeof paths / sizeof *paths;
    fprintf(out, "<path d=\"M%.1f %.1f%s\"/>", x, y, engine < 0 ? "m-5-5 10 10m0-10-10 10" : paths[engine % n]);
}

static void draw_mark(struct view *v, const struct mark *m)
{
    const double x = at_x(v, m->x), y = at_y(v, m->y);
    const struct trade_result *r = m->result >= 0 ? &v->t->result[m->result] : NULL;
    fprintf(v->out, "<g class=\"pt %s%s\"", r ? hf_engine_name(m->engine) : "other",
            m->rank == TRADE_FRONT  ? " on"
            : m->rank == TRADE_TIED ? " on tied"
                                    : "");
    if (r)
        fprintf(v->out, " data-i=\"%d\" tabindex=\"%d\" role=\"button\" aria-label=\"", m->result,
                m->rank == TRADE_FRONT ? 0 : -1);
    else
        fputs(" aria-label=\"", v->out);
    escaped(v->out, m->name);
    fputs("\"><title>", v->out);
    escaped(v->out, m->name);
    fprintf(v->out, ": %.2f ms, %.3g", m->x, m->y);
    if (r) {
        fputs(", ", v->out);
        escaped(v->out, r->setting->options);
    }
    fputs("</title>", v->out);
    if (at_x(v, m->high) - at_x(v, m->low) > 10)
        fprintf(v->out, "<path class=\"span\" d=\"M%.1f %.1fH%.1f\"/>", at_x(v, m->low), y, at_x(v, m->high));
    shape(v->out, r ? (int)m->engine : -1, x, y);
    fprintf(v->out, "<circle class=\"hit\" cx=\"%.1f\" cy=\"%.1f\" r=\"9\"/></g>\n", x, y);
}

// Write a name beside a point, if there is room.
static void label(struct view *v, const struct mark *m)
{
    const double x = at_x(v, m->x), y = at_y(v, m->y), w = 6.3 * (double)strlen(m->name), h = 13;
    // No setting is better, so the space below and to the left is usually free.
    const struct box tries[] = {{x - 9 - w, y + 4, x - 9, y + 4 + h},     {x - 9 - w, y - h + 6, x - 9, y + 6},
                                {x - w - 4, y + 9, x - 4, y + 9 + h},     {x + 7, y + 5, x + 7 + w, y + 5 + h},
                                {x + 9, y - h + 6, x + 9 + w, y + 6},     {x + 7, y - h - 5, x + 7 + w, y - 5},
                                {x - 9 - w, y - h - 5, x - 9, y - 5},     {x - w / 2, y + 9, x + w / 2, y + 9 + h},
                                {x - w / 2, y - h - 9, x + w / 2, y - 9}, {x - w - 9, y + 16, x - 9, y + 16 + h}};
    for (size_t i = 0; i < sizeof tries / sizeof *tries; i++)
        if (!collides(v, tries[i])) {
            fprintf(v->out, "<text class=\"label\" x=\"%.1f\" y=\"%.1f\">", tries[i].x0, tries[i].y1 - 3);
            escaped(v->out, m->name);
            fputs("</text>\n", v->out);
            take(v, tries[i]);
            return;
        }
}

// Is there a setting of an engine?
static int is_used(const struct view *v, int engine)
{
    for (int i = 0; i < v->marks; i++)
        if (v->mark[i].result >= 0 && (int)v->mark[i].engine == engine)
            return 1;
    return 0;
}

static double legend_width(int engine)
{
    return 15 + 6.6 * (double)strlen(hf_engine_name((enum hf_engine)engine)) + 10;
}

// The engines above the chart, in two rows where one is too long.
static void legend(struct view *v)
{
    double x = LEFT, all = 0;
    for (int e = 0; e < tool_engines(); e++)
        all += is_used(v, e) ? legend_width(e) : 0;
    double y = LEFT + all <= v->width ? 15 : 10;
    for (int e = 0; e < tool_engines(); e++) {
        const char *name = hf_engine_name((enum hf_engine)e);
        if (!is_used(v, e))
            continue;
        if (x + legend_width(e) > v->width) {
            x = LEFT;
            y += 13;
        }
        fprintf(v->out, "<g class=\"pt on %s\">", name);
        shape(v->out, e, x + 6, y - 4);
        fprintf(v->out, "</g><text class=\"label\" x=\"%.1f\" y=\"%.0f\">%s</text>\n", x + 15, y, name);
        x += legend_width(e);
    }
}

static void draw(struct view *v)
{
    axes(v);
    time_line(v, 1e3 / 60, "60 Hz");
    time_line(v, 1e3 / 120, "120 Hz");
    time_line(v, 1.506, v->width > 600 ? "GTX 660, 1080p (the chapter's)" : "GTX 660");
    front_line(v);
    for (int i = 0; i < v->marks; i++) {
        const double x = at_x(v, v->mark[i].x), y = at_y(v, v->mark[i].y);
        take(v, (struct box){x - 6, y - 6, x + 6, y + 6});
    }
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < v->marks; i++)
            if ((v->mark[i].rank == TRADE_FRONT) == pass)
                draw_mark(v, &v->mark[i]);
    for (int i = v->marks - 1; i >= 0; i--)
        if (v->mark[i].rank == TRADE_FRONT || v->mark[i].result < 0)
            label(v, &v->mark[i]);
    legend(v);
}

void chart_write(FILE *out, const struct trade *t, const struct chart *c, int width, int height, int alone)
{
    struct view v = {.out = out, .t = t, .chart = c, .width = width, .height = height};
    if (collect(&v) || !v.marks) {
        free(v.mark);
        return;
    }
    find_range(&v);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\" viewBox=\"0 0 %d %d\" role=\"img\" "
            "aria-label=\"",
            width, height);
    escaped(out, c->title);
    fputs("\"", out);
    if (alone)
        fprintf(out, " width=\"%d\" height=\"%d\"", width, height);
    fputs(">\n", out);
    if (alone)
        fprintf(out, "<style>%s</style><rect class=\"paper\" width=\"%d\" height=\"%d\"/>\n", chart_style, width,
                height);
    draw(&v);
    if (alone) {  // on the page the title stands above the chart
        fprintf(out, "<text class=\"end\" x=\"%d\" y=\"16\">", width - 4);
        escaped(out, c->title);
        fputs("</text>\n", out);
    }
    fputs("</svg>\n", out);
    free(v.mark);
}
