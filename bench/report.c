// SPDX-License-Identifier: BSD-3-Clause
#include "report.h"

#include "scene.h"
#include "tools/common/machine.h"
#include "write.h"
#include "tools/common/report.h"

#include <stdint.h>

// Milliseconds at 1920x1080 on a GeForce GTX 660: table 3.1 of the chapter, in the order of its passes.
static const double gtx660_ms[TOOL_PASSES] = {0.13, 0.145, 0.08, 0.08, 0.08, 0.08, 0.455, 0.122, 0.334};
static const double gtx660_all_ms = 1.506;

#if defined(__clang__)
static const char compiler[] = __VERSION__;
#elif defined(__GNUC__)
static const char compiler[] = "gcc " __VERSION__;
#else
static const char compiler[] = "unknown";
#endif

// The arithmetic that the machine at its peak could do in the time of All, MFLOP. It compares machines of different
// speed.
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
    char cpu[128], surfaces[32] = "";
    if (run->args->surfaces > 1)
        snprintf(surfaces, sizeof surfaces, " %d surfaces,", run->args->surfaces);
    tool_cpu(cpu, sizeof cpu);
    fprintf(out, "%s, %s, %d thread%s, %dx%d, scene %s (near %.0f%%, sharp %.0f%%, far %.0f%%)\n", cpu,
            hf_isa_name(run->isa), run->threads, run->threads == 1 ? "" : "s", run->width, run->height,
            run->args->scene, 100 * share(r->stats.all.near_pixels, run), 100 * share(r->stats.all.sharp_pixels, run),
            100 * share(r->stats.all.far_pixels, run));
    fprintf(out, "%s storage, %s to %s, radius %g,%s %d frames, %.1f MB held; hyperfocal %s, %s\n",
            hf_name(HF_NAMES_STORAGE, (int)run->args->params.gather.storage),
            hf_name(HF_NAMES_FORMAT, (int)run->args->in), hf_name(HF_NAMES_FORMAT, (int)run->args->out),
            r->stats.params.max_radius, surfaces, r->frames, (double)r->stats.all.memory_held * 1e-6, hf_version(),
            compiler);
    fprintf(out, "memcpy %.3f ms, peak %.1f GFLOP/s, cost %.1f MFLOP (All x peak), All / memcpy %.2f\n", r->memcpy_ms,
            r->fma_gflops, cost_mflop(r), r->all.median_ms / r->memcpy_ms);
}

// The chapter timed only its own passes, at one size.
static int has_gtx660(const struct bench_run *run)
{
    return run->result->stats.params.engine == HF_ENGINE_CHAPTER && run->width == 1920 && run->height == 1080;
}

static void table_uses(FILE *out, const struct bench_uses *u)
{
    if (u->in_place.median_ms <= 0)
        return;
    fprintf(out,
            "in turn: in place %.3f ms (least %.3f), out of place %.3f (%.3f); first frame of a context %.3f, after "
            "hf_prepare %.3f, later %.3f\n",
            u->in_place.median_ms, u->in_place.min_ms, u->out_of_place.median_ms, u->out_of_place.min_ms, u->first_ms,
            u->prepared_ms, u->later_ms);
}

void bench_report_table(FILE *out, const struct bench_run *run)
{
    const struct bench_result *r = run->result;
    const double all = r->all.median_ms;
    const int chapter = has_gtx660(run);
    fprintf(out, "%-16s %9s %7s%s %9s %9s\n", "Pass", "ms", "of All", chapter ? "   GTX 660    ratio" : "", "min",
            "max");
    for (int p = 0; p < tool_passes(r->stats.params.engine); p++) {
        const struct bench_row *row = &r->pass[p];
        table_row(out, hf_inspect_pass_name(r->stats.params.engine, p), row->median_ms, all,
                  chapter ? gtx660_ms[p] : 0);
        if (row->in >= 0)
            fprintf(out, "   in %s\n", hf_inspect_pass_name(r->stats.params.engine, row->in));
        else
            fprintf(out, " %9.3f %9.3f\n", row->min_ms, row->max_ms);
    }
    table_row(out, "overhead", r->overhead_ms, all, 0);
    fprintf(out, "   of which planning %.3f\n", r->planning_ms);
    table_row(out, "All", all, all, chapter ? gtx660_all_ms : 0);
    fprintf(out, " %9.3f %9.3f\n\n", r->all.min_ms, r->all.max_ms);
    if (bench_is_busy(&r->all))
        fprintf(out, "The machine is busy: the median is %.1f times the least, which is nearer to what it can do.\n",
                all / r->all.min_ms);
    table_uses(out, &r->uses);
    table_machine(out, run);
}

static void json_settings(struct tool_json *j, const struct bench_run *run)
{
    const struct bench_args *a = run->args;
    const struct hf_params *p = &a->params;
    tool_json_text(j, "engine", hf_engine_name(run->result->stats.params.engine));
    tool_json_count(j, "width", run->width);
    tool_json_count(j, "height", run->height);
    tool_json_count(j, "threads", run->threads);
    tool_json_text(j, "isa", hf_isa_name(run->isa));
    tool_json_text(j, "storage", hf_name(HF_NAMES_STORAGE, (int)p->gather.storage));
    tool_json_text(j, "scene", a->scene);
    tool_json_text(j, "in", hf_name(HF_NAMES_FORMAT, (int)a->in));
    tool_json_text(j, "out", hf_name(HF_NAMES_FORMAT, (int)a->out));
    tool_json_number(j, "focus", p->focus);
    tool_json_number(j, "range", p->range.distance);
    tool_json_number(j, "max_radius", run->result->stats.params.max_radius);
    const int chapter = p->engine == HF_ENGINE_CHAPTER;
    tool_json_text(j, "fill", chapter ? hf_name(HF_NAMES_FILL, (int)p->chapter.fill) : NULL);
    tool_json_flag(j, "faithful", chapter && p->chapter.faithful);
    tool_json_flag(j, "deterministic", p->run.deterministic);
    tool_json_flag(j, "no_skip", p->run.no_skip);
    tool_json_flag(j, "karis", p->gather.karis);
    tool_json_flag(j, "bicubic", p->gather.bicubic);
    tool_json_flag(j, "per_pixel_kernel", p->gather.per_pixel_kernel);
}

static void json_machine(struct tool_json *j, const struct bench_run *run)
{
    const struct bench_result *r = run->result;
    tool_json_text(j, "compiler", compiler);
    tool_json_number(j, "near_share", share(r->stats.all.near_pixels, run));
    tool_json_number(j, "sharp_share", share(r->stats.all.sharp_pixels, run));
    tool_json_number(j, "far_share", share(r->stats.all.far_pixels, run));
    tool_json_number(j, "memory_bytes", (double)r->stats.all.memory_held);
    tool_json_count(j, "frames", r->frames);
    tool_json_number(j, "memcpy_ms", r->memcpy_ms);
    tool_json_number(j, "fma_gflops", r->fma_gflops);
    tool_json_number(j, "cost_mflop", cost_mflop(r));
}

static void json_row(struct tool_json *j, const struct bench_row *row)
{
    tool_json_ms(j, "median_ms", row->median_ms);
    tool_json_ms(j, "min_ms", row->min_ms);
    tool_json_ms(j, "max_ms", row->max_ms);
}

void bench_report_json(FILE *out, const struct bench_run *run)
{
    const struct bench_result *r = run->result;
    const struct bench_uses *u = &r->uses;
    const enum hf_engine engine = r->stats.params.engine;
    struct tool_json j;
    bench_json_begin(&j, out, run->command, run->args);
    json_settings(&j, run);
    json_machine(&j, run);
    tool_json_open(&j, "passes", '[');
    for (int p = 0; p < tool_passes(engine); p++) {
        const struct bench_row *row = &r->pass[p];
        tool_json_row(&j, NULL, '{');
        tool_json_text(&j, "name", hf_inspect_pass_name(engine, p));
        json_row(&j, row);
        if (has_gtx660(run))
            tool_json_number(&j, "gtx660_ms", gtx660_ms[p]);
        if (row->in >= 0)
            tool_json_text(&j, "in", hf_inspect_pass_name(engine, row->in));
        tool_json_close(&j);
    }
    tool_json_close(&j);
    tool_json_flag(&j, "busy", bench_is_busy(&r->all));
    tool_json_ms(&j, "overhead_ms", r->overhead_ms);
    tool_json_ms(&j, "planning_ms", r->planning_ms);
    tool_json_ms(&j, "in_place_ms", u->in_place.median_ms);
    tool_json_ms(&j, "out_of_place_ms", u->out_of_place.median_ms);
    tool_json_ms(&j, "first_ms", u->first_ms);
    tool_json_ms(&j, "prepared_ms", u->prepared_ms);
    tool_json_ms(&j, "later_ms", u->later_ms);
    tool_json_row(&j, "all", '{');
    json_row(&j, &r->all);
    if (has_gtx660(run))
        tool_json_number(&j, "gtx660_ms", gtx660_all_ms);
    tool_json_end(&j);
}
