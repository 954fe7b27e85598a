// SPDX-License-Identifier: BSD-3-Clause
#include "report.h"

#include "machine.h"
#include "scene.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

// Milliseconds at 1920x1080 on a GeForce GTX 660: table 3.1 of the chapter, in the order of its passes.
static const double gtx660_ms[HF_MAX_PASSES] = {0.13, 0.145, 0.08, 0.08, 0.08, 0.08, 0.455, 0.122, 0.334};
static const double gtx660_all_ms = 1.506;

#if defined(__clang__)
static const char compiler[] = __VERSION__;
#elif defined(__GNUC__)
static const char compiler[] = "gcc " __VERSION__;
#else
static const char compiler[] = "unknown";
#endif

// What All would be in arithmetic at the machine's peak, MFLOP: compares machines of different speed.
static double cost_mflop(const struct bench_result *r)
{
    return r->all.median_ms * r->fma_gflops;
}

static double share(uint64_t pixels, const struct bench_run *run)
{
    return (double)pixels / ((double)run->width * run->height);
}

static void table_row(FILE *out, const char *name, double ms, double all_ms, double gtx)
{
    fprintf(out, "%-16s %9.3f %6.1f%%", name, ms, all_ms > 0 ? 100 * ms / all_ms : 0);
    if (gtx > 0)
        fprintf(out, " %9.3f %8.1f", gtx, ms / gtx);
}

static void table_machine(FILE *out, const struct bench_run *run)
{
    const struct bench_result *r = run->result;
    char cpu[128];
    bench_machine_cpu(cpu, sizeof cpu);
    fprintf(out, "%s, %s, %d thread%s, %dx%d, scene %s (near %.0f%%, sharp %.0f%%, far %.0f%%)\n", cpu,
            hf_isa_name(run->isa), run->threads, run->threads == 1 ? "" : "s", run->width, run->height,
            run->args->scene, 100 * share(r->stats.near_pixels, run), 100 * share(r->stats.sharp_pixels, run),
            100 * share(r->stats.far_pixels, run));
    fprintf(out, "%s storage, %s to %s, radius %g, %d frames, %.1f MB held; hyperfocal %s, %s\n",
            hf_name(HF_NAMES_STORAGE, (int)run->args->params.gather.storage),
            hf_name(HF_NAMES_FORMAT, (int)run->args->in), hf_name(HF_NAMES_FORMAT, (int)run->args->out),
            r->stats.used.params.max_radius, r->frames, (double)r->stats.memory_held * 1e-6, hf_version(), compiler);
    fprintf(out, "memcpy %.3f ms, peak %.1f GFLOP/s, cost %.1f MFLOP (All x peak), All / memcpy %.2f\n", r->memcpy_ms,
            r->fma_gflops, cost_mflop(r), r->all.median_ms / r->memcpy_ms);
}

// The chapter timed the gather alone, at one size.
static int has_gtx660(const struct bench_run *run)
{
    return run->result->stats.used.params.engine == HF_ENGINE_GATHER && run->width == 1920 && run->height == 1080;
}

static void table_uses(FILE *out, const struct bench_uses *u)
{
    if (u->in_place.median_ms <= 0)
        return;
    fprintf(out,
            "in turn: in place %.3f ms (least %.3f), out of place %.3f (%.3f); first frame of a context %.3f, after "
            "hf_prepare %.3f\n",
            u->in_place.median_ms, u->in_place.min_ms, u->out_of_place.median_ms, u->out_of_place.min_ms, u->first_ms,
            u->prepared_ms);
}

void bench_report_table(FILE *out, const struct bench_run *run)
{
    const struct bench_result *r = run->result;
    const double all = r->all.median_ms;
    const int gather = has_gtx660(run);
    fprintf(out, "%-16s %9s %7s%s %9s %9s\n", "Pass", "ms", "of All", gather ? "   GTX 660    ratio" : "", "min",
            "max");
    for (int p = 0; p < hf_pass_count(r->stats.used.params.engine); p++) {
        const struct bench_row *row = &r->pass[p];
        table_row(out, hf_pass_name(r->stats.used.params.engine, p), row->median_ms, all, gather ? gtx660_ms[p] : 0);
        if (row->in >= 0)
            fprintf(out, "   in %s\n", hf_pass_name(r->stats.used.params.engine, row->in));
        else
            fprintf(out, " %9.3f %9.3f\n", row->min_ms, row->max_ms);
    }
    table_row(out, "overhead", r->overhead_ms, all, 0);
    fprintf(out, "   of which planning %.3f\n", r->planning_ms);
    table_row(out, "All", all, all, gather ? gtx660_all_ms : 0);
    fprintf(out, " %9.3f %9.3f\n\n", r->all.min_ms, r->all.max_ms);
    table_uses(out, &r->uses);
    table_machine(out, run);
}

static void json_text(FILE *out, const char *text)
{
    fputc('"', out);
    for (const char *c = text; *c; c++) {
        if (*c == '"' || *c == '\\')
            fputc('\\', out);
        if ((unsigned char)*c < 32)
            fprintf(out, "\\u%04x", (unsigned)(unsigned char)*c);
        else
            fputc(*c, out);
    }
    fputc('"', out);
}

// JSON has no infinity.
static void json_number(FILE *out, const char *name, double value)
{
    if (isfinite(value))
        fprintf(out, "  \"%s\": %.9g,\n", name, value);
    else
        fprintf(out, "  \"%s\": null,\n", name);
}

static void json_named(FILE *out, const char *name, const char *text)
{
    fprintf(out, "  \"%s\": ", name);
    json_text(out, text);
    fputs(",\n", out);
}

static void json_settings(FILE *out, const struct bench_run *run)
{
    const struct bench_args *a = run->args;
    json_named(out, "command", run->command);
    json_named(out, "engine", hf_engine_name(run->result->stats.used.params.engine));
    fprintf(out, "  \"width\": %d,\n  \"height\": %d,\n  \"threads\": %d,\n", run->width, run->height, run->threads);
    json_named(out, "isa", hf_isa_name(run->isa));
    json_named(out, "storage", hf_name(HF_NAMES_STORAGE, (int)a->params.gather.storage));
    json_named(out, "scene", a->scene);
    json_named(out, "in", hf_name(HF_NAMES_FORMAT, (int)a->in));
    json_named(out, "out", hf_name(HF_NAMES_FORMAT, (int)a->out));
    json_number(out, "focus", a->params.focus);
    json_number(out, "range", a->params.range.distance);
    json_number(out, "max_radius", run->result->stats.used.params.max_radius);
    json_named(out, "fill", hf_name(HF_NAMES_FILL, (int)a->params.gather.fill));
    const struct {
        const char *name;
        int value;
    } flags[] = {{"faithful", a->faithful},
                 {"deterministic", a->params.run.deterministic},
                 {"no_skip", a->params.run.no_skip},
                 {"karis", a->params.gather.karis},
                 {"bicubic", a->params.gather.bicubic},
                 {"per_pixel_kernel", a->params.gather.per_pixel_kernel}};
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
        fprintf(out, "  \"%s\": %s,\n", flags[i].name, flags[i].value ? "true" : "false");
}

static void json_machine(FILE *out, const struct bench_run *run)
{
    const struct bench_result *r = run->result;
    char cpu[128];
    bench_machine_cpu(cpu, sizeof cpu);
    json_named(out, "cpu", cpu);
    json_named(out, "compiler", compiler);
    json_named(out, "version", hf_version());
    json_number(out, "near_share", share(r->stats.near_pixels, run));
    json_number(out, "sharp_share", share(r->stats.sharp_pixels, run));
    json_number(out, "far_share", share(r->stats.far_pixels, run));
    json_number(out, "memory_bytes", (double)r->stats.memory_held);
    fprintf(out, "  \"frames\": %d,\n", r->frames);
    json_number(out, "memcpy_ms", r->memcpy_ms);
    json_number(out, "fma_gflops", r->fma_gflops);
    json_number(out, "cost_mflop", cost_mflop(r));
}

void bench_report_json(FILE *out, const struct bench_run *run)
{
    const struct bench_result *r = run->result;
    fputs("{\n", out);
    json_settings(out, run);
    json_machine(out, run);
    fputs("  \"passes\": [", out);
    for (int p = 0; p < hf_pass_count(r->stats.used.params.engine); p++) {
        const struct bench_row *row = &r->pass[p];
        fprintf(out, "%s\n    {\"name\": \"%s\", \"median_ms\": %.6f, \"min_ms\": %.6f, \"max_ms\": %.6f", p ? "," : "",
                hf_pass_name(r->stats.used.params.engine, p), row->median_ms, row->min_ms, row->max_ms);
        if (has_gtx660(run))
            fprintf(out, ", \"gtx660_ms\": %g", gtx660_ms[p]);
        if (row->in >= 0)
            fprintf(out, ", \"in\": \"%s\"", hf_pass_name(r->stats.used.params.engine, row->in));
        fputc('}', out);
    }
    const struct bench_uses *u = &r->uses;
    fprintf(out, "\n  ],\n  \"overhead_ms\": %.6f,\n  \"planning_ms\": %.6f,\n", r->overhead_ms, r->planning_ms);
    fprintf(out,
            "  \"in_place_ms\": %.6f,\n  \"out_of_place_ms\": %.6f,\n  \"first_ms\": %.6f,\n  \"prepared_ms\": %.6f,\n",
            u->in_place.median_ms, u->out_of_place.median_ms, u->first_ms, u->prepared_ms);
    fprintf(out, "  \"all\": {\"median_ms\": %.6f, \"min_ms\": %.6f, \"max_ms\": %.6f", r->all.median_ms, r->all.min_ms,
            r->all.max_ms);
    if (has_gtx660(run))
        fprintf(out, ", \"gtx660_ms\": %g", gtx660_all_ms);
    fputs("}\n}\n", out);
}
