// SPDX-License-Identifier: BSD-3-Clause
// The public functions: check arguments, own memory, touch no pixel.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "api/layers.h"
#include "api/message.h"
#include "api/sized.h"
#include "base/cpu.h"
#include "base/system.h"
#include "frame/buffers.h"
#include "frame/check.h"
#include "frame/deep.h"
#include "frame/report.h"
#include "frame/surfaces.h"
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

int hf_abi_version(void)
{
    return HF_ABI_VERSION;
}

const char *hf_isa_name(enum hf_isa isa)
{
    return hf_cpu_name(isa);
}

int hf_isa_available(enum hf_isa isa)
{
    return hf_cpu_has(isa);
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
    case HF_ERR_ABI:
        return "the program was compiled for another version of the library's interface";
    default:
        return "unknown error";
    }
}

static int bad_tile(int size, int step)
{
    return size && (size < 16 || size > 65536 || size % step);
}

static int check_config(const struct hf_config *g, struct hf_message *message)
{
    if (g->threads < 0 || g->threads > MAX_THREADS)
        return hf_bad(message, "config.threads", "is %d; it must be 0 to %d", g->threads, MAX_THREADS);
    if (!g->alloc != !g->free)
        return hf_bad(message, g->alloc ? "config.free" : "config.alloc", "is NULL; give alloc and free, or neither");
    if (bad_tile(g->tile_width, 16))
        return hf_bad(message, "config.tile_width", "is %d; it must be 0 or 16 to 65536, a multiple of 16",
                      g->tile_width);
    if (bad_tile(g->tile_height, 1))
        return hf_bad(message, "config.tile_height", "is %d; it must be 0 or 16 to 65536", g->tile_height);
    return hf_check_value("config.isa", (int)g->isa, 0, HF_ISA_NEON, message);
}

// Why there is no instruction set to use.
static void say_isa(const struct hf_config *g)
{
    const char *name = hf_cpu_variable();
    int isa;
    if (g->isa)
        hf_say_error(g, HF_ERR_ISA, "config.isa", "is %s, which this CPU or build does not have", hf_cpu_name(g->isa));
    else if (hf_value(HF_NAMES_ISA, name, &isa))
        hf_say_error(
            g, HF_ERR_ISA, NULL,
            "HYPERFOCAL_ISA is %s, which is no instruction set; there are scalar, sse4.1, avx2, avx512 and neon", name);
    else
        hf_say_error(g, HF_ERR_ISA, NULL, "HYPERFOCAL_ISA is %s, which this CPU or build does not have", name);
}

// Memory, kernels and threads of a context whose config is known to be right.
static int set_up(struct hf_context *c)
{
    const size_t bytes = (size_t)c->threads * sizeof *c->workers;
    c->workers = c->mem.alloc(c->mem.cookie, bytes, HF_ALIGN);
    if (!c->workers)
        return HF_ERR_MEMORY;
    memset(c->workers, 0, bytes);
    const int err = hf_engines_open(c);
    return err || c->config.parallel_for ? err : hf_pool_open(&c->pool, c->threads, &c->mem);
}

static int open_context(struct hf_context **out, const struct hf_config *g)
{
    struct hf_message message;
    if (check_config(g, &message)) {
        hf_say_error(g, HF_ERR_ARG, NULL, "%s", message.sentence);
        return HF_ERR_ARG;
    }
    const enum hf_isa isa = hf_cpu_choose(g->isa);
    if (isa == HF_ISA_AUTO) {
        say_isa(g);
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
    hf_queue_open(&c->queue);
    c->threads = g->threads ? g->threads : hf_min(hf_system_processors(), MAX_THREADS);
    const int err = set_up(c);
    if (err) {
        hf_say_error(g, err, NULL, "the context could not be made: %s", hf_error_string(err));
        hf_close(&c);
    }
    *out = c;
    return err;
}

int hf_open_abi(struct hf_context **out, const struct hf_config *config, int abi)
{
    struct hf_config own = {.size = sizeof own};
    struct hf_message message;
    if (!out)
        return HF_ERR_ARG;
    *out = NULL;
    if (abi != HF_ABI_VERSION)
        return HF_ERR_ABI;
    if (config && hf_sized_in(&own, config, &hf_sized_config, "config", &message)) {
        if (hf_sized_is_possible(config->size, &hf_sized_config) && config->log)
            config->log(config->log_cookie, &message);
        return HF_ERR_ARG;
    }
    return open_context(out, &own);
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
    hf_queue_close(&c->queue, &c->mem);
    hf_block_free(&c->planes, &c->mem);
    hf_block_free(&c->chunks, &c->mem);
    hf_block_free(&c->tiles, &c->mem);
    hf_block_free(&c->joined, &c->mem);
    hf_block_free(&c->surfaces, &c->mem);
    hf_block_free(&c->samples, &c->mem);
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

static int depth_at(const struct hf_depth *depth, int width, int height, int x, int y, float *z,
                    struct hf_message *message)
{
    struct hf_depth own;
    if (!z || !depth)
        return hf_bad(message, z ? "depth" : "z", "is NULL");
    if (width < 1 || height < 1 || width > HF_MAX_SIZE || height > HF_MAX_SIZE)
        return hf_bad(message, NULL, "the depth is %d x %d pixels; each side must be 1 to %d", width, height,
                      HF_MAX_SIZE);
    if (x < 0 || y < 0 || x >= width || y >= height)
        return hf_bad(message, NULL, "pixel (%d, %d) is outside of the depth, %d x %d pixels", x, y, width, height);
    if (hf_given_depth(&own, depth, message) || hf_check_depth(&own, width, message))
        return HF_ERR_ARG;
    if (own.type == HF_DEPTH_COC)
        return hf_bad(message, "depth.type", "is %s: it holds no distances", hf_name(HF_NAMES_DEPTH_TYPE, own.type));
    struct hf_setup s = {0};
    hf_setup_depth(&s, &own, 1);
    *z = hf_depth_decode(&s, hf_depth_sample(&own, x, y), x, y);
    if (*z > 0 && *z < 1e10f)
        return HF_OK;
    hf_bad(message, NULL, "pixel (%d, %d) shows no surface", x, y);
    return message->error = HF_ERR_FOCUS;
}

int hf_depth_at(const struct hf_depth *depth, int width, int height, int x, int y, float *z, struct hf_message *message)
{
    struct hf_message own = {.size = sizeof own};
    const int err = depth_at(depth, width, height, x, y, z, &own);
    const int told = hf_sized_out(message, &own, &hf_sized_message, "message", &(struct hf_message){0});
    return err ? err : told;
}

// What a program gives to render a frame, copied.
struct call {
    const struct hf_region *region;  // NULL: all
    struct hf_region own_region;
    struct hf_image dst, src;
    struct hf_depth depth;
    struct hf_given given;
    struct hf_surface_input layers[HF_MOST_LAYERS];
    int count;  // of layers, 0: one picture
    int is_deep;
    struct hf_deep_input deep;
};

// Whether it gives more than one picture of one surface.
static int is_several(const struct call *call)
{
    return call->count > 1 || call->is_deep;
}

// Several pictures, or a deep one, become one picture and what the engine knows beside it.
static int merge(struct hf_context *c, struct hf_setup *s, const struct call *call, int fused, struct hf_merged *merged,
                 struct hf_known *known)
{
    const int peels = call->count > 1 && call->layers[1].kind == HF_LAYER_PEEL;
    *merged = (struct hf_merged){call->src, call->depth};
    if (call->is_deep)
        return hf_deep_merge(c, s, &call->deep, fused, merged, known);
    if (peels)
        return hf_surfaces_read(c, s, call->layers + 1, hf_min(call->count - 1, HF_MOST_BEHIND), fused, known);
    return hf_surfaces_merge(c, s, call->layers, call->count, fused, merged, known);
}

// A frame whose settings are known.
static int run_resolved(struct hf_context *c, const struct call *call, const struct hf_settings *r, enum hf_task task)
{
    const int fused = !r->params.run.deterministic, peels = call->count > 1 && call->layers[1].kind == HF_LAYER_PEEL;
    // Without blur nothing is seen of what a picture hides.
    const int several = is_several(call) && !(r->sharp && peels);
    const struct hf_region *region = call->region;
    struct hf_merged merged = {call->src, call->depth};
    struct hf_known known;
    struct hf_setup s;
    hf_setup_make(&s, &merged.image, &call->dst, &merged.depth, r, c->engine[r->params.engine].own);
    s.stop = &c->stop;
    if (several) {
        const int err = merge(c, &s, call, fused, &merged, &known);
        if (err)
            return err;
        hf_setup_make(&s, &merged.image, &call->dst, &merged.depth, r, c->engine[r->params.engine].own);
        s.stop = &c->stop;
        s.several = 1;
        hf_engine_def(s.engine)->own.know(c->engine[s.engine].own, &known);
    }
    if (region)
        s.region = (struct hf_rect){region->x, region->y, region->x + region->width, region->y + region->height};
    s.part = region && (region->width < r->width || region->height < r->height);
    return hf_render_frame(c, &s, &(struct hf_job){&call->dst, &merged.image, &merged.depth, fused, task});
}

// Choose the settings that fit the time budget, and resolve them. Returns how many settings there are to choose from, or an
// error.
static int choose(struct hf_context *c, struct hf_settings *r, const struct hf_params *p, const struct hf_depth *depth,
                  int several, const char **options, struct hf_message *message)
{
    struct hf_params ladder[HF_BUDGET_STEPS];
    const int all = hf_budget_ladder(p, hf_asked_radius(p, depth->type, r->params.view.display_height), ladder);
    int steps = 0;
    // Of several pictures only engines that take them.
    for (int i = 0; i < all; i++)
        if (!several || hf_engine_def(ladder[i].engine)->own.know)
            ladder[steps++] = ladder[i];
    const int step = hf_budget_choose(&c->budget, ladder, steps);
    const int err = hf_params_resolve(r, r->width, r->height, depth, &ladder[step], message);
    *options = step ? hf_budget_options(p, &ladder[step]) : NULL;
    return err ? err : steps;
}

// What keeps a picture from being the one that the camera would take.
static void tell_limit(const struct hf_context *c, const struct hf_depth *depth)
{
    static const char *const why[] = {
        [HF_LIMIT_NONE] = ", the most that there can be",
        [HF_LIMIT_GIVEN] = ", as given",
        [HF_LIMIT_MODEL] = "",
        [HF_LIMIT_ENGINE] = ": the engine reaches no farther unless the radius is given",
        [HF_LIMIT_PICTURE] = ": the aperture's picture is drawn no larger",
    };
    const struct hf_frame_report *r = &c->report;
    const struct hf_params *p = &r->used.params;
    const enum hf_limit limit = r->used.limit;
    if (p->model != HF_MODEL_LENS && depth->type != HF_DEPTH_COC)
        return;
    const struct hf_engine_def *engine = hf_engine_def(p->engine);
    if (engine->limits.width)
        hf_say(&c->config, HF_LOG_WARNING, NULL,
               "the %s engine blurs by %s, not by how much the lens or the radii ask for", engine->name,
               engine->limits.width);
    else if (fmaxf(r->near_radius, r->far_radius) >= p->max_radius)
        hf_say(&c->config, limit == HF_LIMIT_GIVEN ? HF_LOG_INFO : HF_LOG_WARNING, "max_radius",
               "is %g pixels%s: larger blur is cut to that", p->max_radius, why[limit]);
}

// Whole numbers taken for distances, where they are surely none: those of a hardware depth buffer, or all before the focus.
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
    hf_say(&c->config, HF_LOG_WARNING, "depth.type",
           "is %s and the format %s: whole numbers are read as distances 0 to 1; set the type",
           hf_name(HF_NAMES_DEPTH_TYPE, (int)d->type), hf_name(HF_NAMES_DEPTH_FORMAT, (int)d->format));
}

static int check_region(const struct hf_region *r, const struct hf_image *src, struct hf_message *message)
{
    if (r->x < 0 || r->y < 0 || r->width < 1 || r->height < 1 || r->x >= src->width || r->y >= src->height ||
        r->width > src->width - r->x || r->height > src->height - r->y)
        return hf_bad(message, "region", "is %d x %d pixels from (%d, %d); it must lie in the picture of %d x %d",
                      r->width, r->height, r->x, r->y, src->width, src->height);
    return HF_OK;
}

static int take(struct call *call, const struct hf_image *dst, const struct hf_image *src, const struct hf_depth *depth,
                const struct hf_params *params, const struct hf_region *region, struct hf_message *message)
{
    call->region = region ? &call->own_region : NULL;
    if (!src || !dst || !depth)
        return hf_bad(message, !src ? "src" : !dst ? "dst" : "depth", "is NULL");
    if (hf_sized_in(&call->src, src, &hf_sized_image, "src", message) ||
        hf_sized_in(&call->dst, dst, &hf_sized_image, "dst", message) || hf_given_depth(&call->depth, depth, message) ||
        hf_given_params(&call->given, params, message) ||
        (region && hf_sized_in(&call->own_region, region, &hf_sized_region, "region", message)))
        return HF_ERR_ARG;
    int err = hf_check_images(&call->dst, &call->src, call->region, message);
    if (!err && region)
        err = check_region(&call->own_region, &call->src, message);
    return err ? err : hf_check_depth(&call->depth, call->src.width, message);
}

// Whether the engine takes several pictures. An engine that does not exist is an error of its own, later.
static int check_engine(const struct call *call, struct hf_message *message)
{
    const struct hf_engine_def *engine = hf_engine_def(call->given.params.engine);
    if (!engine || engine->own.know)
        return HF_OK;
    return hf_bad(message, "engine", "is %s, which takes one picture; the engines layers and scatter take several",
                  engine->name);
}

// Settings for the frame: those of the parameters, or what the budget leaves of them. *steps: how many it chooses from.
static int settle(struct hf_context *c, const struct call *call, struct hf_settings *r, int *steps,
                  const char **options, struct hf_message *message)
{
    const struct hf_params *p = &call->given.params;
    const int err = hf_params_resolve(r, call->src.width, call->src.height, &call->depth, p, message);
    const int budget = !c->dump && p->run.budget_ms > 0;
    if (!budget)
        c->budget.step = 0;
    if (err || !budget)
        return err;
    *steps = choose(c, r, p, &call->depth, is_several(call), options, message);
    return hf_min(*steps, 0);
}

// Learn from a frame whether its setting keeps the budget.
static void note_budget(struct hf_context *c, float budget_ms, int steps)
{
    hf_budget_note(&c->budget, budget_ms, steps, (float)c->report.total_ms);
    if (hf_budget_missed(&c->budget, budget_ms, steps))
        hf_say(&c->config, HF_LOG_WARNING, "run.budget_ms",
               "is %g, which frames miss, and nothing cheaper blurs as far as is asked for: the last took %.1f",
               budget_ms, c->report.total_ms);
}

static int fail_by(struct hf_context *c, int error, const char *sentence)
{
    struct hf_message message;
    hf_bad(&message, NULL, "%s", sentence);
    message.error = error;
    return hf_fail(c, &message);
}

// In place of a picture and its depth.
struct scene {
    const struct hf_layer *layers;
    int count, is_deep;
    const struct hf_deep *deep;
};

// Check the arguments, choose a setting that fits the budget, and render.
static int run(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
               const struct hf_depth *depth, const struct hf_params *params, const struct hf_region *region,
               const struct scene *scene, enum hf_task task)
{
    if (!c)
        return HF_ERR_ARG;
    struct hf_message message;
    struct call call;
    struct hf_image image;
    struct hf_settings r;
    int steps = 0;
    const char *options = NULL;
    c->report = (struct hf_frame_report){0};
    atomic_store_explicit(&c->stop, 0, memory_order_relaxed);
    if (c->pool && c->threads > 1 && c->pid != hf_process())
        return fail_by(c, HF_ERR_THREAD, "the context was opened before fork(): its threads are in the parent process");
    int err = HF_OK;
    call.count = 0;
    call.is_deep = scene && scene->is_deep;
    if (call.is_deep)
        err = hf_take_deep(&call.deep, &image, scene->deep, &message);
    else if (scene)
        err = hf_take_layers(call.layers, scene->layers, call.count = scene->count, &message);
    if (!err && scene) {
        src = call.is_deep ? &image : &call.layers->image;
        depth = call.is_deep ? &call.deep.depth : &call.layers->depth;
    }
    if (!err)
        err = take(&call, dst, src, depth, params, region, &message);
    if (!err && call.is_deep && call.given.params.focus == HF_DERIVE)
        err = hf_bad(&message, "focus", "is to be read from a deep picture; give a distance");
    if (!err && is_several(&call))
        err = check_engine(&call, &message);
    if (!err)
        err = settle(c, &call, &r, &steps, &options, &message);
    if (err)
        return hf_fail(c, &message);
    tell_depth(c, &call.depth, &r.params);
    err = run_resolved(c, &call, &r, task);
    if (err) {
        char sentence[128];
        c->report = (struct hf_frame_report){0};
        if (err == HF_ERR_CANCELLED)
            return err;
        snprintf(sentence, sizeof sentence, "the frame could not be rendered: %s", hf_error_string(err));
        return fail_by(c, err, sentence);
    }
    if (!r.sharp)
        tell_limit(c, &call.depth);
    c->report.budget_steps = steps;
    c->report.budget_options = options;
    if (steps && task == HF_TASK_RENDER && !region)
        note_budget(c, call.given.params.run.budget_ms, steps);
    return HF_OK;
}

int hf_render(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
              const struct hf_depth *depth, const struct hf_params *params)
{
    return run(c, dst, src, depth, params, NULL, NULL, HF_TASK_RENDER);
}

int hf_render_region(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                     const struct hf_depth *depth, const struct hf_params *params, const struct hf_region *region)
{
    return run(c, dst, src, depth, params, region, NULL, HF_TASK_RENDER);
}

int hf_render_layers(struct hf_context *c, const struct hf_image *dst, const struct hf_layer *layers, int count,
                     const struct hf_params *params, const struct hf_region *region)
{
    const struct scene scene = {.layers = layers, .count = count};
    return run(c, dst, NULL, NULL, params, region, &scene, HF_TASK_RENDER);
}

int hf_render_deep(struct hf_context *c, const struct hf_image *dst, const struct hf_deep *deep,
                   const struct hf_params *params, const struct hf_region *region)
{
    const struct scene scene = {.is_deep = 1, .deep = deep};
    return run(c, dst, NULL, NULL, params, region, &scene, HF_TASK_RENDER);
}

int hf_region_reads(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                    const struct hf_depth *depth, const struct hf_params *params, const struct hf_region *region,
                    struct hf_region *colour, struct hf_region *depth_read)
{
    const int err = run(c, dst, src, depth, params, region, NULL, HF_TASK_PLAN);
    struct hf_region *const out[2] = {colour, depth_read};
    struct hf_message message;
    for (int i = 0; i < 2 && c; i++) {
        const struct hf_rect r = err ? (struct hf_rect){0} : c->reads[i];
        const struct hf_region own = {sizeof own, r.x0, r.y0, r.x1 - r.x0, r.y1 - r.y0};
        if (hf_sized_out(out[i], &own, &hf_sized_region, i ? "depth_read" : "colour", &message))
            return hf_fail(c, &message);
    }
    return err;
}

int hf_prepare(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
               const struct hf_depth *depth, const struct hf_params *params)
{
    return run(c, dst, src, depth, params, NULL, NULL, HF_TASK_PREPARE);
}

int hf_plan(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src, const struct hf_depth *depth,
            const struct hf_params *params, struct hf_report *report)
{
    const int err = run(c, dst, src, depth, params, NULL, NULL, HF_TASK_PLAN);
    const int told = c && report ? hf_get_report(c, report) : HF_OK;
    return err ? err : told;
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
