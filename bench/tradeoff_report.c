// SPDX-License-Identifier: BSD-3-Clause
#include "tradeoff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double db(double error)
{
    return -20 * log10(error);
}

// Mean over the scenes in which the region is; NAN where it is in none.
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

static void qualities(FILE *out, const struct trade *t)
{
    static const char *const names[TRADE_QUALITIES] = {"draft", "standard", "high", "best"};
    int place[TRADE_QUALITIES];
    if (t->results < 2 || trade_qualities(t, place))
        return;
    fputc('\n', out);
    for (int q = 0; q < TRADE_QUALITIES; q++)
        fprintf(out, "--quality %-9s %8.2f ms  %6.2f dB  %s\n", names[q], t->result[place[q]].ms.median,
                db(t->result[place[q]].error), t->result[place[q]].setting->options);
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
        "radius 12.\n= overlaps the row above: their order is chance. * on the front, ~ on it but for such a chance; "
        "the number is the step of the ladder.\nDistances from the truth: PSNR in dB, display-encoded, by region; "
        "FLIP; SSIM; linear RMSE; energy over the truth's.\nrounding: linear RMSE from double precision; demo: "
        "display RMSE from the published demo; flicker: of a focus pull.\n");
    qualities(out, t);
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

void trade_json_text(FILE *out, const char *text)
{
    fputc('"', out);
    for (const char *c = text; *c; c++) {
        if (*c == '"' || *c == '\\')
            fputc('\\', out);
        if ((unsigned char)*c < 32 || *c == '<')  // <: the page has this inside an element
            fprintf(out, "\\u%04x", (unsigned)(unsigned char)*c);
        else
            fputc(*c, out);
    }
    fputc('"', out);
}

static void json_field(FILE *out, const char *before, const char *name, double v)
{
    if (isfinite(v))
        fprintf(out, "%s\"%s\": %.7g", before, name, v);
    else
        fprintf(out, "%s\"%s\": null", before, name);
}

static void json_interval(FILE *out, const char *name, struct trade_interval v)
{
    fprintf(out, ", \"%s\": {", name);
    json_field(out, "", "median", v.median);
    json_field(out, ", ", "low", v.low);
    json_field(out, ", ", "high", v.high);
    fputc('}', out);
}

static void json_passes(FILE *out, const struct trade_result *r, const struct trade_time *time)
{
    double values[TRADE_ROUNDS];
    fputs(", \"passes\": [", out);
    for (int p = 0; p < hf_pass_count(r->engine); p++) {
        for (int i = 0; i < time->n; i++)
            values[i] = time->pass[i][p];
        fprintf(out, "%s{\"name\": ", p ? ", " : "");
        trade_json_text(out, hf_pass_name(r->engine, p));
        json_field(out, ", ", "ms", trade_interval(values, time->n).median);
        fputc('}', out);
    }
    fputc(']', out);
}

static void json_scene(FILE *out, const struct trade *t, const struct trade_result *r, int s)
{
    const struct trade_point *p = &r->at[s];
    fputs("{\"scene\": ", out);
    trade_json_text(out, t->scene[s].text);
    json_interval(out, "ms", trade_interval(p->time.sample, p->time.n));
    json_field(out, ", ", "flicker", p->flicker);
    json_passes(out, r, &p->time);
    for (int g = 0; g < BENCH_REGIONS; g++) {
        const struct bench_distance *d = &p->distance[g];
        fprintf(out, ", \"%s\": ", bench_region_name((enum bench_region)g));
        if (d->share == 0) {
            fputs("null", out);
            continue;
        }
        const struct {
            const char *name;
            double value;
        } field[] = {{"psnr_db", d->psnr},
                     {"display_rmse", d->display_rmse},
                     {"linear_rmse", d->linear_rmse},
                     {"largest", d->largest},
                     {"ssim", d->ssim},
                     {"flip", d->flip},
                     {"energy", d->energy}};
        json_field(out, "{", "share", d->share);
        for (size_t k = 0; k < sizeof field / sizeof *field; k++)
            json_field(out, ", ", field[k].name, field[k].value);
        fputc('}', out);
    }
    fputc('}', out);
}

static void json_setting(FILE *out, const struct trade *t, const struct trade_result *r)
{
    static const char *const ranks[] = {"beaten", "tied", "front"};
    fputs("    {\"knob\": ", out);
    trade_json_text(out, r->setting->knob);
    fputs(", \"name\": ", out);
    trade_json_text(out, r->setting->name);
    fputs(", \"options\": ", out);
    trade_json_text(out, r->setting->options);
    fprintf(out, ", \"engine\": \"%s\", \"rank\": \"%s\", \"step\": %d", hf_engine_name(r->engine), ranks[r->rank],
            r->step);
    json_interval(out, "ms", r->ms);
    json_interval(out, "both_ms", r->both_ms);
    json_field(out, ", ", "error", r->error);
    json_field(out, ", ", "worst", r->worst);
    json_field(out, ", ", "rounding", r->rounding);
    json_field(out, ", ", "faithfulness", r->faithfulness);
    fputs(",\n     \"scenes\": [", out);
    for (int s = 0; s < t->scenes; s++) {
        fputs(s ? ",\n      " : "\n      ", out);
        json_scene(out, t, r, s);
    }
    fputs("]}", out);
}

void trade_json(FILE *out, const void *what)
{
    const struct trade *t = what;
    fputs("{\n  \"command\": \"tradeoff\",\n  \"cpu\": ", out);
    trade_json_text(out, t->cpu);
    fprintf(out,
            ",\n  \"isa\": \"%s\",\n  \"threads\": %d,\n  \"date\": \"%s\",\n  \"version\": \"%s\",\n  \"commit\": ",
            hf_isa_name(t->isa), t->threads, t->date, hf_version());
    trade_json_text(out, t->commit);
    fputs(",\n  \"settings\": [\n", out);
    for (int i = 0; i < t->results; i++) {
        json_setting(out, t, &t->result[i]);
        fputs(i + 1 < t->results ? ",\n" : "\n", out);
    }
    fputs("  ]\n}\n", out);
}

static double megapixels(const struct trade *t)
{
    double sum = 0;
    for (int s = 0; s < t->scenes; s++)
        sum += 1e-6 * t->width[s] * t->height[s] / t->scenes;
    return sum;
}

static const struct trade_result *at_step(const struct trade *t, int step)
{
    for (int i = 0; i < t->results; i++)
        if (t->result[i].step == step)
            return &t->result[i];
    return NULL;
}

void trade_ladder_table(FILE *out, const struct trade *t)
{
    const double size = megapixels(t);
    int place[TRADE_QUALITIES];
    fprintf(out,
            "// SPDX-License-Identifier: BSD-3-Clause\n// Made by `hyperfocal-bench tradeoff --ladder "
            "src/frame/ladder_table.h`. Do not edit.\n// clang-format off\n#define HF_LADDER_MEASURED \"%s, %s, %s, %d "
            "thread%s\"\n// options, mean and worst error, milliseconds of a megapixel\n#define HF_LADDER_STEPS",
            t->date, t->cpu, hf_isa_name(t->isa), t->threads, t->threads == 1 ? "" : "s");
    const struct trade_result *r;
    for (int step = 1; (r = at_step(t, step)); step++)
        fprintf(out, "%s \\\n    {\"%s\", %.6ff, %.6ff, %#.4gf}", step > 1 ? "," : "", r->setting->options, r->error,
                r->worst, r->ms.median / size);
    fputs("\n// steps of draft, standard, high and best\n#define HF_LADDER_QUALITIES", out);
    for (int q = 0; q < TRADE_QUALITIES && !trade_qualities(t, place); q++)
        fprintf(out, "%s %d", q ? "," : "", t->result[place[q]].step - 1);
    fputs("\n// milliseconds of a megapixel of each engine as it is\n#define HF_LADDER_ENGINES", out);
    for (int e = 0; e < HF_ENGINE_COUNT; e++) {
        char options[64];
        double ms = 0;
        snprintf(options, sizeof options, "--engine %s", hf_engine_name((enum hf_engine)e));
        for (int i = 0; i < t->results; i++)
            if (!strcmp(t->result[i].setting->options, options))
                ms = t->result[i].ms.median / size;
        fprintf(out, "%s %#.4gf", e ? "," : "", ms);
    }
    fputs("\n// clang-format on\n", out);
}
