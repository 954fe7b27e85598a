// SPDX-License-Identifier: BSD-3-Clause
// The public functions. They check arguments and own memory, but compute no pixel.
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "frame/buffers.h"
#include "frame/report.h"
#include "frame/check.h"
#include "base/cpu.h"
#include "base/system.h"
#include "pixel/depth.h"
#include "pixel/depth_rows.h"
#include "pixel/limits.h"

enum { MAX_THREADS = 256 };

#define STRING_(x) #x
#define STRING(x) STRING_(x)

const char *hf_version(void)
{
    return STRING(HF_VERSION_MAJOR) "." STRING(HF_VERSION_MINOR) "." STRING(HF_VERSION_PATCH);
}

const char *hf_error_string(int error)
{
    switch (error) {
    case HF_OK:
        return "no error";
    case HF_ERR_ARG:
        return "an argument is out of its range";
    case HF_ERR_MEMORY:
        return "out of memory";
    case HF_ERR_THREAD:
        return "a thread could not be started, or is not in this process";
    case HF_ERR_ISA:
        return "the instruction set is not available on this CPU or in this build";
    case HF_ERR_FOCUS:
        return "there is no surface where focus was to be read";
    case HF_ERR_CANCELLED:
        return "the call was cancelled";
    default:
        return "unknown error";
    }
}

HF_PRINTF(3, 4) static void say(const struct hf_config *config, enum hf_log_level level, const char *format, ...)
{
    if (!config->log)
        return;
    char message[HF_MESSAGE];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    config->log(config->log_cookie, level, message);
}

static int check_config(const struct hf_config *g)
{
    if (g->threads < 0 || g->threads > MAX_THREADS) {
        say(g, HF_LOG_ERROR, "config.threads is %d; it must be 0 to %d", g->threads, MAX_THREADS);
        return HF_ERR_ARG;
    }
    if (!g->alloc != !g->free) {
        say(g, HF_LOG_ERROR, "config.%s is NULL; give alloc and free, or neither", g->alloc ? "free" : "alloc");
        return HF_ERR_ARG;
    }
    if (g->tile_width < 0 || g->tile_width > 65536 || g->tile_width % 16 || g->tile_height < 0 ||
        g->tile_height > 65536 || (g->tile_height && g->tile_height < 16)) {
        say(g, HF_LOG_ERROR,
            "config.tile_width is %d and tile_height %d; they must be 0 or 16 to 65536, the width "
            "a multiple of 16",
            g->tile_width, g->tile_height);
        return HF_ERR_ARG;
    }
    if (!hf_isa_name(g->isa)) {
        say(g, HF_LOG_ERROR, "config.isa is %d, which is not an instruction set", (int)g->isa);
        return HF_ERR_ARG;
    }
    return HF_OK;
}

// Log why the value of HYPERFOCAL_ISA cannot be used.
static void say_variable(const struct hf_config *g)
{
    const char *name = hf_cpu_variable();
    int isa;
    if (hf_value(HF_NAMES_ISA, name, &isa))
        say(g, HF_LOG_ERROR,
            "HYPERFOCAL_ISA is %s, which is no instruction set; there are scalar, sse4.1, avx2, avx512 and neon", name);
    else
        say(g, HF_LOG_ERROR, "HYPERFOCAL_ISA is %s, which this CPU or build does not have", name);
}

int hf_open(struct hf_context **out, const struct hf_config *config)
{
    static const struct hf_config defaults;
    const struct hf_config *g = config ? config : &defaults;
    if (!out)
        return HF_ERR_ARG;
    *out = NULL;
    int err = check_config(g);
    if (err)
        return err;
    const enum hf_isa isa = hf_cpu_choose(g->isa);
    if (isa == HF_ISA_AUTO) {
        if (g->isa)
            say(g, HF_LOG_ERROR, "config.isa is %s, which this CPU or build does not have", hf_isa_name(g->isa));
        else
            say_variable(g);
        return HF_ERR_ISA;
    }
    const struct hf_mem mem = g->alloc ? (struct hf_mem){g->alloc, g->free, g->alloc_cookie} : hf_mem_default;
    struct hf_context *c = mem.alloc(mem.cookie, sizeof *c, HF_ALIGN);
    if (!c)
        return HF_ERR_MEMORY;
    memset(c, 0, sizeof *c);
    c->config = *g;
    c->mem = mem;
    c->isa = isa;
    c->pid = hf_process();
    c->threads = g->threads ? g->threads : hf_min(hf_system_processors(), MAX_THREADS);
    const size_t bytes = (size_t)c->threads * sizeof *c->workers;
    c->workers = mem.alloc(mem.cookie, bytes, HF_ALIGN);
    if (!c->workers) {
        err = HF_ERR_MEMORY;
        goto error;
    }
    memset(c->workers, 0, bytes);
    if ((err = hf_engines_open(c)))
        goto error;
    if (!g->parallel_for && (err = hf_pool_open(&c->pool, c->threads, &c->mem)))
        goto error;
    *out = c;
    return HF_OK;
error:
    say(g, HF_LOG_ERROR, "the context could not be made: %s", hf_error_string(err));
    hf_close(&c);
    return err;
}

void hf_close(struct hf_context **context)
{
    struct hf_context *c = context ? *context : NULL;
    if (!c)
        return;
    *context = NULL;
    if (c->pid == hf_process())
        hf_pool_close(&c->pool);
    else
        hf_pool_abandon(&c->pool);
    for (int i = 0; c->workers && i < c->threads; i++)
        hf_block_free(&c->workers[i].scratch, &c->mem);
    if (c->workers)
        c->mem.free(c->mem.cookie, c->workers);
    hf_engines_close(c);
    hf_block_free(&c->planes, &c->mem);
    hf_block_free(&c->chunks, &c->mem);
    hf_block_free(&c->tiles, &c->mem);
    hf_block_free(&c->joined, &c->mem);
    hf_block_free(&c->repairs, &c->mem);
    const struct hf_mem mem = c->mem;
    mem.free(mem.cookie, c);
}

enum hf_isa hf_context_isa(const struct hf_context *c)
{
    return c ? c->isa : HF_ISA_AUTO;
}

int hf_context_threads(const struct hf_context *c)
{
    return c ? c->threads : 0;
}

int hf_depth_at(const struct hf_depth *depth, int width, int height, int x, int y, float *z)
{
    char message[HF_MESSAGE];
    if (!z || width > HF_MAX_SIZE || height > HF_MAX_SIZE || x < 0 || y < 0 || x >= width || y >= height ||
        hf_check_depth(depth, width, message) || depth->type == HF_DEPTH_COC)
        return HF_ERR_ARG;
    struct hf_setup s = {0};
    hf_setup_depth(&s, depth, 1);
    *z = hf_depth_decode(&s, hf_depth_sample(depth, x, y), x, y);
    return *z > 0 && *z < 1e10f ? HF_OK : HF_ERR_FOCUS;
}

// Render a frame with resolved settings.
static int run_resolved(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                        const struct hf_depth *depth, const struct hf_resolved *r, const struct hf_region *region,
                        enum hf_task task)
{
    struct hf_setup s;
    hf_setup_make(&s, src, dst, depth, r, c->engine[r->params.engine].own);
    if (region)
        s.region = (struct hf_rect){region->x, region->y, region->x + region->width, region->y + region->height};
    s.part = region && (region->width < r->width || region->height < r->height);
    return hf_render_frame(c, &s, &(struct hf_job){dst, src, depth, !r->params.run.deterministic, task});
}

// Choose the settings that fit the time budget, and resolve them. Returns how many settings there are to choose from,
// or an error.
static int choose(struct hf_context *c, struct hf_resolved *r, const struct hf_params *p, const struct hf_depth *depth,
                  const char **options, char *message)
{
    struct hf_params ladder[HF_BUDGET_STEPS];
    const int steps = hf_budget_ladder(p, hf_asked_radius(p, depth->type, r->params.view.display_height), ladder);
    const int step = hf_budget_choose(&c->budget, ladder, steps);
    const int err = hf_params_resolve(r, r->width, r->height, depth, &ladder[step], message);
    *options = step ? hf_budget_options(p, &ladder[step]) : NULL;
    return err ? err : steps;
}

// Log what limits the blur, if the camera's would be larger.
static void tell_limit(const struct hf_context *c, const struct hf_depth *depth)
{
    static const char *const why[] = {
        [HF_LIMIT_NONE] = ", the most that there can be",
        [HF_LIMIT_GIVEN] = ", as max_radius says",
        [HF_LIMIT_MODEL] = "",
        [HF_LIMIT_ENGINE] = ": the engine reaches no farther unless max_radius is given",
        [HF_LIMIT_PICTURE] = ": the aperture's picture is drawn no larger",
    };
    const struct hf_report *r = &c->report;
    const struct hf_params *p = &r->used.params;
    const enum hf_limit limit = r->used.limit;
    if (p->model != HF_MODEL_LENS && depth->type != HF_DEPTH_COC)
        return;
    const struct hf_engine_def *engine = hf_engine_def(p->engine);
    if (engine->limits.width)
        say(&c->config, HF_LOG_WARNING, "the %s engine blurs by %s, not by how much the lens or the radii ask for",
            engine->name, engine->limits.width);
    else if (fmaxf(r->near_radius, r->far_radius) >= p->max_radius)
        say(&c->config, limit == HF_LIMIT_GIVEN ? HF_LOG_INFO : HF_LOG_WARNING,
            "blur is cut to %g pixels where it would be larger%s", p->max_radius, why[limit]);
}

// Warn once if whole numbers are taken for distances but surely are none: those of a hardware depth buffer, or numbers
// that would all lie before the focus.
static void tell_depth(struct hf_context *c, const struct hf_depth *d, const struct hf_params *p)
{
    const int hardware = d->format == HF_DEPTH_FORMAT_D24S8 || d->format == HF_DEPTH_FORMAT_X8D24;
    const int whole = hardware || d->format == HF_DEPTH_FORMAT_UNORM16 || d->format == HF_DEPTH_FORMAT_UNORM32;
    const float sharp = p->model == HF_MODEL_LENS ? p->focus : p->range.near_end;
    const int told = 1 + (int)d->format * (HF_DEPTH_COC + 1) + (int)d->type;
    if (!whole || (d->type != HF_DEPTH_VIEW && d->type != HF_DEPTH_RAY) || d->near_plane != 0 || d->far_plane != 0 ||
        !(hardware || sharp > 1) || told == c->depth_told)
        return;
    c->depth_told = told;
    say(&c->config, HF_LOG_WARNING,
        "depth.format is %s and depth.type %s: whole numbers are read as distances 0 to 1; set depth.type",
        hf_name(HF_NAMES_DEPTH_FORMAT, (int)d->format), hf_name(HF_NAMES_DEPTH_TYPE, (int)d->type));
}

static int check_region(const struct hf_region *r, const struct hf_image *src, char *message)
{
    if (r->size != sizeof *r)
        return hf_bad(message, "region.size is %zu; it must be %zu", r->size, sizeof *r);
    if (r->x < 0 || r->y < 0 || r->width < 1 || r->height < 1 || r->x >= src->width || r->y >= src->height ||
        r->width > src->width - r->x || r->height > src->height - r->y)
        return hf_bad(message, "region is %d x %d pixels from (%d, %d); it must lie in the picture of %d x %d",
                      r->width, r->height, r->x, r->y, src->width, src->height);
    return HF_OK;
}

// Check the arguments, choose a setting that fits the budget, and render.
static int run(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
               const struct hf_depth *depth, const struct hf_params *params, const struct hf_region *region,
               enum hf_task task)
{
    if (!c)
        return HF_ERR_ARG;
    const struct hf_params *p = params ? params : &hf_default_params;
    char message[HF_MESSAGE];
    struct hf_resolved r;
    c->report = (struct hf_report){0};
    atomic_store_explicit(&c->stop, 0, memory_order_relaxed);
    if (c->pool && c->threads > 1 && c->pid != hf_process()) {
        say(&c->config, HF_LOG_ERROR, "the context was opened before fork(): its threads are in the parent process");
        return HF_ERR_THREAD;
    }
    int err = hf_check_images(dst, src, region, message);
    if (!err && region)
        err = check_region(region, src, message);
    if (!err)
        err = hf_check_depth(depth, src->width, message);
    if (!err)
        err = hf_params_resolve(&r, src->width, src->height, depth, p, message);
    int steps = 0;
    const char *options = NULL;
    c->budget.step = c->dump || !(p->run.budget_ms > 0) ? 0 : c->budget.step;
    if (!err && p->run.budget_ms > 0 && !c->dump) {
        steps = choose(c, &r, p, depth, &options, message);
        err = hf_min(steps, 0);
    }
    if (err) {
        say(&c->config, HF_LOG_ERROR, "%s", message);
        return err;
    }
    tell_depth(c, depth, &r.params);
    err = run_resolved(c, dst, src, depth, &r, region, task);
    if (!err && !r.sharp)
        tell_limit(c, depth);
    c->report.budget_steps = steps;
    c->report.budget_options = options;
    if (err) {
        c->report = (struct hf_report){0};
        if (err != HF_ERR_CANCELLED)
            say(&c->config, HF_LOG_ERROR, "the frame could not be rendered: %s", hf_error_string(err));
    } else if (steps && task == HF_TASK_RENDER && !region) {
        hf_budget_note(&c->budget, p->run.budget_ms, steps, (float)c->report.total_ms);
        if (hf_budget_missed(&c->budget, p->run.budget_ms, steps))
            say(&c->config, HF_LOG_WARNING,
                "run.budget_ms is %g, which frames miss, and nothing cheaper blurs as far as is asked for: the last "
                "took %.1f",
                p->run.budget_ms, c->report.total_ms);
    }
    return err;
}

int hf_render(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
              const struct hf_depth *depth, const struct hf_params *params)
{
    return run(c, dst, src, depth, params, NULL, HF_TASK_RENDER);
}

int hf_render_region(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                     const struct hf_depth *depth, const struct hf_params *params, const struct hf_region *region)
{
    return run(c, dst, src, depth, params, region, HF_TASK_RENDER);
}

int hf_region_reads(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                    const struct hf_depth *depth, const struct hf_params *params, const struct hf_region *region,
                    struct hf_region *colour, struct hf_region *depth_read)
{
    const int err = run(c, dst, src, depth, params, region, HF_TASK_PLAN);
    struct hf_region *const out[2] = {colour, depth_read};
    for (int i = 0; i < 2; i++) {
        if (!out[i])
            continue;
        const struct hf_rect r = err ? (struct hf_rect){0} : c->reads[i];
        *out[i] = (struct hf_region){sizeof *out[i], r.x0, r.y0, r.x1 - r.x0, r.y1 - r.y0};
    }
    return err;
}

int hf_prepare(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
               const struct hf_depth *depth, const struct hf_params *params)
{
    return run(c, dst, src, depth, params, NULL, HF_TASK_PREPARE);
}

int hf_plan(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src, const struct hf_depth *depth,
            const struct hf_params *params, struct hf_report *report)
{
    const int err = run(c, dst, src, depth, params, NULL, HF_TASK_PLAN);
    hf_get_report(c, report);
    return err;
}

void hf_cancel(struct hf_context *c)
{
    if (c)
        atomic_store_explicit(&c->stop, 1, memory_order_relaxed);
}

void hf_set_progress(struct hf_context *c, int (*fn)(void *cookie, float done), void *cookie)
{
    if (c)
        c->progress = (struct hf_progress_call){fn, cookie};
}

void hf_get_report(const struct hf_context *c, struct hf_report *report)
{
    if (report)
        *report = c ? c->report : (struct hf_report){0};
}

size_t hf_get_tiles(const struct hf_context *c, uint8_t *tiles, size_t size)
{
    return c ? hf_report_tiles(c, tiles, size) : 0;
}

void hf_set_dump(struct hf_context *c, void (*fn)(void *cookie, const struct hf_buffer *buffer), void *cookie)
{
    if (!c)
        return;
    c->dump = fn;
    c->dump_cookie = cookie;
}
