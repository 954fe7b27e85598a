// SPDX-License-Identifier: BSD-3-Clause
#include "tradeoff.h"
#include "write.h"
#include "frame/ladder_fields.h"
#include "tools/common/report.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double db(double error)
{
    return -20 * log10(error);
}

// The mean over the scenes that have the region; NAN if none has.
static double mean_of(const struct trade *t, const struct trade_result *r, enum bench_region region, size_t field)
{
    double sum = 0;
    int n = 0;
    for (int s = 0; s < t->scenes; s++) {
        const struct bench_distance *d = &r->at[s].distance[region];
        if (d->share == 0)
            continue;
        sum += *(const double *)((const char *)d + field);
        n++;
    }
    return n ? sum / n : NAN;
}
#define MEAN(t, r, region, field) mean_of(t, r, region, offsetof(struct bench_distance, field))

static double mean_flicker(const struct trade *t, const struct trade_result *r)
{
    double sum = 0;
    for (int s = 0; s < t->scenes; s++)
        sum += r->at[s].flicker / t->scenes;
    return sum;
}

static void cell(FILE *out, int width, int digits, double v)
{
    if (isfinite(v))
        fprintf(out, " %*.*f", width, digits, v);
    else
        fprintf(out, " %*s", width, "-");
}

static void small_cell(FILE *out, double v)
{
    if (isfinite(v))
        fprintf(out, " %8.1e", v);
    else
        fprintf(out, " %8s", "-");
}

static void row(FILE *out, const struct trade *t, const struct trade_result *r, const struct trade_result *before)
{
    static const char marks[] = {[TRADE_BEATEN] = ' ', [TRADE_TIED] = '~', [TRADE_FRONT] = '*'};
    char step[8] = "";
    if (r->step)
        snprintf(step, sizeof step, "%d", r->step);
    fprintf(out, "%c%2s %-26s %c%8.2f %5.1f%%", marks[r->rank], step, r->setting->name,
            before && trade_overlap(before->ms, r->ms) ? '=' : ' ', r->ms.median,
            50 * (r->ms.high - r->ms.low) / r->ms.median);
    cell(out, 8, 2, r->both_ms.median);
    for (int s = 0; s < t->scenes; s++)
        cell(out, 8, 2, r->at[s].distance[BENCH_WHOLE].psnr);
    cell(out, 6, 2, db(r->error));
    for (int g = BENCH_SILHOUETTES; g < BENCH_REGIONS; g++)
        cell(out, 6, 2, MEAN(t, r, (enum bench_region)g, psnr));
    cell(out, 6, 4, MEAN(t, r, BENCH_WHOLE, flip));
    cell(out, 6, 4, MEAN(t, r, BENCH_WHOLE, ssim));
    cell(out, 7, 4, MEAN(t, r, BENCH_WHOLE, linear_rmse));
    cell(out, 6, 3, MEAN(t, r, BENCH_WHOLE, energy));
    small_cell(out, r->rounding);
    small_cell(out, r->faithfulness);
    small_cell(out, mean_flicker(t, r));
    fprintf(out, "  %s\n", r->setting->options);
}

static const struct trade_result *at_step(const struct trade *t, int step)
{
    for (int i = 0; i < t->results; i++)
        if (t->result[i].step == step)
            return &t->result[i];
    return NULL;
}

// The setting that a quality stands for.
static const struct trade_result *of_quality(const struct trade *t, int quality)
{
    int place[TRADE_QUALITIES];
    return t->results < 2 || trade_qualities(t, place) ? NULL : &t->result[place[quality]];
}

// Those that choose the same step stand in one row: "standard, best". The word high is another for best, and stands in none.
// Returns the first quality of the next row.
static int row_of_qualities(const struct trade *t, int q, char names[64])
{
    const struct trade_result *r = of_quality(t, q);
    for (int n = 0; q < TRADE_QUALITIES && of_quality(t, q) == r; q++)
        if (q != HF_QUALITY_HIGH)
            n += snprintf(names + n, 64 - (size_t)n, "%s%s", n ? ", " : "", hf_name(HF_NAMES_QUALITY, q));
    return q;
}

static void qualities(FILE *out, const struct trade *t)
{
    char names[64];
    if (!of_quality(t, 0))
        return;
    fputc('\n', out);
    for (int q = 0, next; q < TRADE_QUALITIES; q = next) {
        const struct trade_result *r = of_quality(t, q);
        next = row_of_qualities(t, q, names);
        fprintf(out, "--quality %-16s %8.2f ms  %6.2f dB  %s\n", names, r->ms.median, db(r->error),
                r->setting->options);
    }
}

void trade_qualities_table(FILE *out, const struct trade *t)
{
    char names[64];
    if (!of_quality(t, 0))
        return;
    fputs("| `--quality` | chooses | ms | dB |\n|---|---|---|---|\n", out);
    for (int q = 0, next; q < TRADE_QUALITIES; q = next) {
        const struct trade_result *r = of_quality(t, q);
        next = row_of_qualities(t, q, names);
        fprintf(out, "| %s | `%s` | %.1f | %.1f |\n", names, r->setting->options, r->ms.median, db(r->error));
    }
}

static double pass_of_both(const struct trade_result *r, const char *name)
{
    double values[TRADE_ROUNDS];
    for (int p = 0; p < tool_passes(r->engine); p++)
        if (!strcmp(hf_inspect_pass_name(r->engine, p), name)) {
            for (int i = 0; i < r->both.n; i++)
                values[i] = r->both.pass[i][p];
            return trade_interval(values, r->both.n).median;
        }
    return NAN;
}

int trade_taps(const struct trade *t, int i, struct trade_taps *taps)
{
    const struct trade_result *r = &t->result[i];
    if (strcmp(r->setting->knob, "taps"))
        return 0;
    *taps = (struct trade_taps){r->setting->name, pass_of_both(r, "Computation"), pass_of_both(r, "Fill"),
                                r->both_ms.median, db(r->error)};
    return 1;
}

static void taps_table(FILE *out, const struct trade *t)
{
    struct trade_taps taps;
    int n = 0;
    for (int i = 0; i < t->results; i++)
        if (trade_taps(t, i, &taps)) {
            if (!n++)
                fprintf(out, "\n1920 x 1080, scene `both`, the same reach, ms:\n%-22s %11s %7s %7s %7s\n", "",
                        "Computation", "Fill", "frame", "dB");
            fprintf(out, "%-22s %11.2f %7.2f %7.2f %7.2f\n", taps.name, taps.computation, taps.fill, taps.frame,
                    taps.db);
        }
}

static const struct trade_result *by_options(const struct trade *t, const char *options)
{
    for (int i = 0; i < t->results; i++)
        if (!strcmp(t->result[i].setting->options, options))
            return &t->result[i];
    return NULL;
}

static void say_taps(FILE *out, const struct trade *t, const char *before, const char *after)
{
    const struct trade_result *few = by_options(t, "--engine chapter --rings 3");
    const struct trade_result *many = by_options(t, "--engine chapter --fill none");
    if (!few || !many)
        return;
    const double few_ms = pass_of_both(few, "Computation"), many_ms = pass_of_both(many, "Computation");
    fprintf(out,
            "%sThe chapter takes 49 taps and fills the gaps between them. Without the fill the same radius needs 144 "
            "taps. On "
            "this CPU the pass Computation takes %.1f ms with 49 and %.1f with 144, %.2f times as long, and a whole "
            "frame of "
            "1920 x 1080 takes %.1f and %.1f ms, %.2f times as long. They reach %.1f and %.1f dB.%s\n",
            before, few_ms, many_ms, many_ms / few_ms, few->both_ms.median, many->both_ms.median,
            many->both_ms.median / few->both_ms.median, db(few->error), db(many->error), after);
}

void trade_sentences(FILE *out, const struct trade *t, const char *before, const char *after)
{
    const struct trade_result *draft = of_quality(t, 0), *standard = of_quality(t, 1), *best = of_quality(t, 3);
    const struct trade_result *soft = at_step(t, 1);
    if (!soft || draft == standard)
        return;
    fprintf(
        out,
        "%sA draft with a lens takes %.1f ms for a frame of %d x %d and reaches %.1f dB against what a ray-traced lens "
        "sees%s",
        before, draft->ms.median, t->width[0], t->height[0], db(draft->error), soft == draft ? "." : "; where");
    if (soft != draft)
        fprintf(out, " blur of one width up to 12 pixels will do, `%s` takes %.1f ms (%.1f at 1920 x 1080).",
                soft->setting->options, soft->ms.median, soft->both_ms.median);
    fprintf(out, "%s\n%sThe standard quality takes %.1f times as long, %.0f ms, and comes %.1f dB closer", after,
            before, standard->ms.median / draft->ms.median, standard->ms.median,
            db(standard->error) - db(draft->error));
    if (best != standard)
        fprintf(out, "; the best there is takes %.1f times that for another %.2f dB.%s\n",
                best->ms.median / standard->ms.median, db(best->error) - db(standard->error), after);
    else
        fprintf(out, ", which is the best there is.%s\n", after);
    say_taps(out, t, before, after);
}

void trade_table(FILE *out, const void *what)
{
    const struct trade *t = what;
    int order[TRADE_SETTINGS];
    trade_order(t, order);
    fprintf(out, "%3s %-26s %9s %6s %8s", "", "setting", "ms", "+-", "1080p");
    for (int s = 0; s < t->scenes; s++)
        fprintf(out, " %8.8s", t->scene[s].text);
    fprintf(out, " %6s %6s %6s %6s %6s %6s %6s %6s %7s %6s %8s %8s %8s  %s\n", "dB", "edges", "near", "far", "focus",
            "lights", "FLIP", "SSIM", "RMSE", "energy", "rounding", "demo", "flicker", "options");
    for (int i = 0; i < t->results; i++)
        row(out, t, &t->result[order[i]], i ? &t->result[order[i - 1]] : NULL);
    fprintf(
        out,
        "\nms: mean over the scenes, median of the rounds, half the distance of the quartiles; 1080p: scene `both`, "
        "radius 12.\n= overlaps the row above: their order is chance. * on the front, ~ perhaps on it: the times "
        "overlap; the number is the step of the ladder.\nDistances from the truth: PSNR in dB, display-encoded, by "
        "region; "
        "FLIP; SSIM; linear RMSE; energy relative to the truth.\nrounding: linear RMSE from double precision; demo: "
        "display RMSE from the published demo; flicker: in a focus pull.\n");
    taps_table(out, t);
    qualities(out, t);
    fputc('\n', out);
    trade_sentences(out, t, "", "");
    fprintf(out, "\n%s, %s, %d thread%s, %s; hyperfocal %s, commit %s\n", t->cpu, hf_isa_name(t->isa), t->threads,
            t->threads == 1 ? "" : "s", t->date, hf_version(), t->commit);
}

static void csv_number(FILE *out, double v)
{
    if (isfinite(v))
        fprintf(out, ",%.9g", v);
    else
        fputc(',', out);
}

static void csv_distance(FILE *out, const struct bench_distance *d)
{
    const double values[] = {d->psnr, d->display_rmse, d->linear_rmse, d->largest, d->ssim, d->flip, d->energy};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++)
        csv_number(out, d->share > 0 ? values[i] : NAN);
}

// One line for each setting, scene and region.
void trade_csv(FILE *out, const struct trade *t)
{
    fputs("knob,setting,options,rank,step,scene,region,share,psnr_db,display_rmse,linear_rmse,largest,ssim,flip,energy,"
          "median_ms,low_ms,high_ms,flicker,rounding,faithfulness\n",
          out);
    static const char *const ranks[] = {"beaten", "tied", "front"};
    for (int i = 0; i < t->results; i++) {
        const struct trade_result *r = &t->result[i];
        for (int s = 0; s < t->scenes; s++)
            for (int g = 0; g < BENCH_REGIONS; g++) {
                const struct bench_distance *d = &r->at[s].distance[g];
                const struct trade_interval ms = trade_interval(r->at[s].time.sample, r->at[s].time.n);
                fprintf(out, "%s,\"%s\",\"%s\",%s,%d,%s,%s", r->setting->knob, r->setting->name, r->setting->options,
                        ranks[r->rank], r->step, t->scene[s].text, bench_region_name((enum bench_region)g));
                csv_number(out, d->share);
                csv_distance(out, d);
                const double rest[] = {ms.median, ms.low, ms.high, r->at[s].flicker, r->rounding, r->faithfulness};
                for (size_t k = 0; k < sizeof rest / sizeof *rest; k++)
                    csv_number(out, rest[k]);
                fputc('\n', out);
            }
    }
}

static void json_interval(struct tool_json *j, const char *name, struct trade_interval v)
{
    tool_json_open(j, name, '{');
    tool_json_number(j, "median", v.median);
    tool_json_number(j, "low", v.low);
    tool_json_number(j, "high", v.high);
    tool_json_close(j);
}

static void json_passes(struct tool_json *j, const struct trade_result *r, const struct trade_time *time)
{
    double values[TRADE_ROUNDS];
    tool_json_open(j, "passes", '[');
    for (int p = 0; p < tool_passes(r->engine); p++) {
        for (int i = 0; i < time->n; i++)
            values[i] = time->pass[i][p];
        tool_json_open(j, NULL, '{');
        tool_json_text(j, "name", hf_inspect_pass_name(r->engine, p));
        tool_json_number(j, "ms", trade_interval(values, time->n).median);
        tool_json_close(j);
    }
    tool_json_close(j);
}

static void json_distance(struct tool_json *j, const char *name, const struct bench_distance *d)
{
    if (d->share == 0) {
        tool_json_text(j, name, NULL);
        return;
    }
    tool_json_open(j, name, '{');
    tool_json_number(j, "share", d->share);
    tool_json_number(j, "psnr_db", d->psnr);
    tool_json_number(j, "display_rmse", d->display_rmse);
    tool_json_number(j, "linear_rmse", d->linear_rmse);
    tool_json_number(j, "largest", d->largest);
    tool_json_number(j, "ssim", d->ssim);
    tool_json_number(j, "flip", d->flip);
    tool_json_number(j, "energy", d->energy);
    tool_json_close(j);
}

static void json_scene(struct tool_json *j, const struct trade *t, const struct trade_result *r, int s)
{
    const struct trade_point *p = &r->at[s];
    tool_json_row(j, NULL, '{');
    tool_json_text(j, "scene", t->scene[s].text);
    json_interval(j, "ms", trade_interval(p->time.sample, p->time.n));
    tool_json_number(j, "flicker", p->flicker);
    json_passes(j, r, &p->time);
    for (int g = 0; g < BENCH_REGIONS; g++)
        json_distance(j, bench_region_name((enum bench_region)g), &p->distance[g]);
    tool_json_close(j);
}

static void json_setting(struct tool_json *j, const struct trade *t, const struct trade_result *r)
{
    static const char *const ranks[] = {"beaten", "tied", "front"};
    tool_json_open(j, NULL, '{');
    tool_json_text(j, "knob", r->setting->knob);
    tool_json_text(j, "name", r->setting->name);
    tool_json_text(j, "options", r->setting->options);
    tool_json_text(j, "engine", hf_engine_name(r->engine));
    tool_json_text(j, "rank", ranks[r->rank]);
    tool_json_count(j, "step", r->step);
    json_interval(j, "ms", r->ms);
    json_interval(j, "both_ms", r->both_ms);
    tool_json_number(j, "error", r->error);
    tool_json_number(j, "worst", r->worst);
    tool_json_number(j, "rounding", r->rounding);
    tool_json_number(j, "faithfulness", r->faithfulness);
    tool_json_open(j, "scenes", '[');
    for (int s = 0; s < t->scenes; s++)
        json_scene(j, t, r, s);
    tool_json_close(j);
    tool_json_close(j);
}

void trade_json(FILE *out, const void *what)
{
    const struct trade *t = what;
    struct tool_json j;
    bench_json_begin(&j, out, "tradeoff", t->args);
    tool_json_text(&j, "isa", hf_isa_name(t->isa));
    tool_json_count(&j, "threads", t->threads);
    tool_json_text(&j, "date", t->date);
    tool_json_text(&j, "commit", t->commit);
    tool_json_open(&j, "settings", '[');
    for (int i = 0; i < t->results; i++)
        json_setting(&j, t, &t->result[i]);
    tool_json_end(&j);
}

static double megapixels(const struct trade *t)
{
    double sum = 0;
    for (int s = 0; s < t->scenes; s++)
        sum += 1e-6 * t->width[s] * t->height[s] / t->scenes;
    return sum;
}

static double of_engine(const struct trade *t, int engine)
{
    char options[64];
    snprintf(options, sizeof options, "--engine %s", hf_engine_name((enum hf_engine)engine));
    const struct trade_result *r = by_options(t, options);
    return r ? r->ms.median : 0;
}

static void initialiser(FILE *out, const char *field, double value)
{
    fprintf(out, ", .%s = ", field);
    if (strcmp(field, "engine")) {
        fprintf(out, "%.9g", value);
        return;
    }
    fputs("HF_ENGINE_", out);
    for (const char *c = hf_engine_name((enum hf_engine)(int)value); *c; c++)
        fputc(toupper((unsigned char)*c), out);
}

// A setting's parameters, as C: those that are not the defaults.
static void initialisers(FILE *out, const struct trade_result *r)
{
    const struct hf_params *p = &r->params, plain = hf_default_params();
    struct hf_params written = plain;
    fputs("{HF_PARAMS_DEFAULTS", out);
#define WRITE(field)                                                                                                   \
    if (p->field != plain.field)                                                                                       \
        initialiser(out, #field, p->field);                                                                            \
    written.field = p->field;
    HF_LADDER_FIELDS(WRITE)
#undef WRITE
    fputc('}', out);
    if (memcmp(&written, p, sizeof written))
        fprintf(out, "\n#error \"%s sets a field that src/frame/ladder_fields.h does not list\"\n",
                r->setting->options);
}

void trade_ladder_table(FILE *out, const struct trade *t)
{
    const double size = megapixels(t);
    int place[TRADE_QUALITIES];
    fprintf(
        out,
        "// SPDX-License-Identifier: BSD-3-Clause\n"
        "// Made by `hyperfocal-bench tradeoff --ladder src/frame/ladder_table.h`. Do not edit.\n"
        "//\n"
        "// Settings worth having, cheapest first. Each takes a fifth longer than the one before and errs less by 0.2 "
        "dB or "
        "more on\n"
        "// average; on no scene where both may be chosen does it err by 0.1 dB more. Those of the gaussian engine are "
        "for blur\n"
        "// no wider than theirs; for a lens the list begins below them.\n"
        "// clang-format off\n"
        "#define HF_LADDER_MEASURED \"%s, %s, %s, %d thread%s\"\n// The command's words; display-encoded root mean "
        "square "
        "error, geometric mean of the scenes and of the worst;\n// milliseconds of a megapixel; the parameters "
        "that the "
        "words stand for.\n#define HF_LADDER_STEPS",
        t->date, t->cpu, hf_isa_name(t->isa), t->threads, t->threads == 1 ? "" : "s");
    const struct trade_result *r;
    for (int step = 1; (r = at_step(t, step)); step++) {
        fprintf(out, "%s \\\n    {\"%s\", %.6ff, %.6ff, %#.4gf, \\\n     ", step > 1 ? "," : "", r->setting->options,
                r->error, r->worst, r->ms.median / size);
        initialisers(out, r);
        fputc('}', out);
    }
    fputs("\n// steps of draft, standard, high and best\n#define HF_LADDER_QUALITIES", out);
    for (int q = 0; q < TRADE_QUALITIES && !trade_qualities(t, place); q++)
        fprintf(out, "%s %d", q ? "," : "", t->result[place[q]].step - 1);
    fputs("\n// milliseconds per megapixel of each engine with its default settings\n#define HF_LADDER_ENGINES", out);
    for (int e = 0; e < tool_engines(); e++)
        fprintf(out, "%s %#.4gf", e ? "," : "", of_engine(t, e) / size);
    fputs("\n// clang-format on\n", out);
}
