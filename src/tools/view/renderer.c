// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/renderer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/common/machine.h"
#include "tools/view/false_colour.h"
#include "tools/view/look.h"

enum {
    REST_MS = 16,   // after a quick picture, before a better one
    LATE_MS = 100,  // a quick picture that takes longer is cancelled for a newer one
};

struct view_renderer {
    GThread *thread;
    GMutex lock;
    GCond wake;
    struct view_request *next;  // NULL: none
    int quit, busy;
    gint newest;                    // serial; read without the lock
    struct hf_context *context[2];  // for quick pictures, for those at rest: each keeps its buffers
    struct view_levels levels;
    void (*deliver)(void *cookie, struct view_result *result);
    void *cookie;
    // What is rendered now.
    const struct view_request *request;
    enum view_stage stage;
    double start;
};

void view_result_free(struct view_result *result)
{
    if (!result)
        return;
    view_picture_unref(result->picture);
    for (int c = 0; c < 3; c++)
        free(result->plane[c]);
    free(result->pixels);
    free(result->buffers);
    free(result->tiles);
    free(result);
}

static void free_request(struct view_request *request)
{
    if (request)
        view_picture_unref(request->picture);
    free(request);
}

static int is_old(const struct view_renderer *r)
{
    return (unsigned)g_atomic_int_get(&r->newest) != r->request->serial;
}

static int on_progress(void *cookie, float done)
{
    const struct view_renderer *r = cookie;
    (void)done;
    return is_old(r) && (r->stage != VIEW_QUICK || tool_now_ms() - r->start > LATE_MS);
}

// Delivery on the main thread.
struct delivery {
    struct view_renderer *renderer;
    struct view_result *result;
};

static gboolean deliver(gpointer data)
{
    struct delivery *d = data;
    d->renderer->deliver(d->renderer->cookie, d->result);
    free(d);
    return G_SOURCE_REMOVE;
}

static void send(struct view_renderer *r, struct view_result *result)
{
    struct delivery *d = malloc(sizeof(*d));
    if (!d) {
        view_result_free(result);
        return;
    }
    *d = (struct delivery){r, result};
    g_idle_add_full(G_PRIORITY_DEFAULT, deliver, d, NULL);
}

// The part that is seen, in pixels of 1/n.
static struct hf_region part_of(const struct hf_region *seen, const struct view_pixels *p, int n)
{
    const int x0 = CLAMP(seen->x / n, 0, p->width - 1), y0 = CLAMP(seen->y / n, 0, p->height - 1);
    const int x1 = CLAMP((seen->x + seen->width + n - 1) / n, x0 + 1, p->width);
    const int y1 = CLAMP((seen->y + seen->height + n - 1) / n, y0 + 1, p->height);
    return (struct hf_region){sizeof(struct hf_region), x0, y0, x1 - x0, y1 - y0};
}

// An image of planes that hold a part only.
static struct hf_image image_of(float *const *plane, int channels, const struct view_pixels *p,
                                const struct hf_region *part)
{
    struct hf_image image = {
        .size = sizeof(image), .width = p->width, .height = p->height, .format = HF_FORMAT_PLANAR32F};
    const ptrdiff_t row = part ? part->width : p->width;
    for (int c = 0; c < channels && plane[c]; c++) {
        image.data[c] =
            part ? (void *)((uintptr_t)plane[c] - (uintptr_t)(part->y * row + part->x) * sizeof(float)) : plane[c];
        image.stride[c] = row * (ptrdiff_t)sizeof(float);
    }
    return image;
}

static void copy_part(const struct view_pixels *p, struct view_result *result)
{
    const struct hf_region *at = &result->at;
    for (int c = 0; c < 3; c++)
        for (int y = 0; y < at->height; y++)
            memcpy(result->plane[c] + (size_t)y * (size_t)at->width,
                   p->plane[c] + (size_t)(at->y + y) * (size_t)p->width + (size_t)at->x,
                   (size_t)at->width * sizeof(float));
}

static int fail(struct view_result *result, const char *sentence)
{
    result->failed = 1;
    return tool_fail(&result->error, HF_ERR_ARG, "%s", sentence);
}

static int make_room(struct view_result *result)
{
    const size_t n = (size_t)result->at.width * (size_t)result->at.height;
    int failed = !(result->pixels = hf_io_alloc(n * sizeof(*result->pixels)));
    for (int c = 0; c < 3; c++)
        failed |= !(result->plane[c] = hf_io_alloc(n * sizeof(float)));
    return failed ? fail(result, "there is not enough memory for the picture") : 0;
}

static void keep_tiles(const struct hf_context *c, struct view_result *result)
{
    result->tile_count = hf_inspect_tiles(c, NULL, 0);
    result->tiles = malloc(result->tile_count + 1);
    if (result->tiles)
        hf_inspect_tiles(c, result->tiles, result->tile_count);
}

// Names of the library's arguments become those of the options.
static int render(struct view_renderer *r, struct view_result *result, const struct view_pixels *p,
                  const struct hf_params *params, const struct hf_depth *depth)
{
    struct hf_context *c = r->context[r->stage != VIEW_QUICK];
    struct hf_message message = {.size = sizeof(message)};
    char buf[TOOL_SENTENCE];
    const struct hf_image src = image_of(p->plane, 4, p, NULL), dst = image_of(result->plane, 3, p, &result->at);
    struct view_dump dump = {.result = result, .wanted = r->request->buffer};
    const int dumps = r->request->show == VIEW_SHOW_BUFFER && r->stage == VIEW_FINAL;
    r->start = tool_now_ms();
    if (dumps)
        hf_inspect_dump(c, view_dump_buffer, &dump);
    int status;
    do  // what was meant to cancel the request before may reach this one
        status = hf_render_region(c, &dst, &src, depth, params, &result->at);
    while (status == HF_ERR_CANCELLED && !is_old(r));
    if (dumps)
        hf_inspect_dump(c, NULL, NULL);
    result->ms = tool_now_ms() - r->start;
    if (status == HF_OK) {
        tool_report_get(c, &result->report);
        if (r->request->show == VIEW_SHOW_TILES)
            keep_tiles(c, result);
        const double megapixels = (double)result->at.width * result->at.height / 1e6;
        if (!dumps)
            view_levels_tell(&r->levels, r->stage, megapixels, result->ms);
        return 0;
    }
    if (status == HF_ERR_CANCELLED) {
        // Too slow to finish: expect at least this time.
        if (r->stage == VIEW_QUICK)
            view_levels_tell(&r->levels, r->stage, (double)result->at.width * result->at.height / 1e6, 2 * LATE_MS);
        return status;
    }
    hf_get_problem(c, &message);
    return fail(result, message.sentence[0] ? tool_sentence(&cli_program, &message, buf) : hf_error_string(status));
}

static void paint(const struct view_request *q, const struct view_pixels *p, const struct hf_params *params,
                  const struct hf_depth *depth, struct view_result *result)
{
    const struct hf_region *at = &result->at;
    for (int y = 0; y < at->height; y++) {
        const size_t i = (size_t)y * (size_t)at->width;
        view_look_row(result->plane[0] + i, result->plane[1] + i, result->plane[2] + i, q->gain, result->pixels + i,
                      at->width);
    }
    view_false_colour(q, p, params, depth, result);
}

static struct view_result *new_result(const struct view_request *q, enum view_stage stage, int n)
{
    struct view_result *result = calloc(1, sizeof(*result));
    if (!result)
        return NULL;
    result->serial = q->serial;
    result->picture = view_picture_ref(q->picture);
    result->stage = stage;
    result->n = n;
    result->gain = q->gain;
    result->show = q->show;
    result->asked_ms = q->asked_ms;
    return result;
}

// Make a picture and send it, or nothing if it was cancelled. Returns 0 if the next stage may follow.
static int make(struct view_renderer *r, enum view_stage stage, int n, struct hf_params params)
{
    const struct view_request *q = r->request;
    struct hf_depth depth = q->depth;
    struct view_result *result = new_result(q, stage, n);
    if (!result)
        return -1;
    const struct view_pixels *p = view_picture_at(q->picture, n);
    r->stage = stage;
    int status = p ? 0 : fail(result, "there is not enough memory for the picture");
    if (!status) {
        result->at = part_of(&q->seen, p, n);
        result->width = p->width;
        status = make_room(result);
    }
    if (!status) {
        view_reduce_setup(&params, &depth, p, n);
        if (q->show == VIEW_SHOW_AFTER || q->show >= VIEW_SHOW_PEAKING)
            status = render(r, result, p, &params, &depth);
        else
            copy_part(p, result);
    }
    if (status == HF_ERR_CANCELLED) {
        view_result_free(result);
        return -1;
    }
    if (!status)
        paint(q, p, &params, &depth, result);
    send(r, result);
    return status;
}

// Wait a little for a newer request; 1 if there is one.
static int wait_for_newer(struct view_renderer *r)
{
    const gint64 until = g_get_monotonic_time() + REST_MS * 1000;
    g_mutex_lock(&r->lock);
    while (!is_old(r) && !r->quit && g_cond_wait_until(&r->wake, &r->lock, until))
        ;
    const int newer = is_old(r) || r->quit;
    g_mutex_unlock(&r->lock);
    return newer;
}

static void serve(struct view_renderer *r)
{
    const struct view_request *q = r->request;
    struct hf_params params;
    enum view_stage stage;
    if (q->show != VIEW_SHOW_AFTER && q->show < VIEW_SHOW_PEAKING) {
        make(r, VIEW_FINAL, q->n, q->params);
        return;
    }
    const int n = view_levels_choose(&r->levels, &q->params, &q->depth, (double)q->seen.width * q->seen.height, q->n,
                                     &params, &stage);
    if (stage == VIEW_QUICK && (make(r, VIEW_QUICK, n, params) || q->moving || wait_for_newer(r)))
        return;
    if (stage == VIEW_QUICK && view_levels_standard(&q->params, &q->depth, &params) &&
        make(r, VIEW_STANDARD, q->n, params))
        return;
    if (!is_old(r) || stage == VIEW_FINAL)
        make(r, VIEW_FINAL, q->n, q->params);
}

static gpointer run(gpointer data)
{
    struct view_renderer *r = data;
    g_mutex_lock(&r->lock);
    while (!r->quit) {
        struct view_request *request = r->next;
        if (!request) {
            r->busy = 0;
            g_cond_wait(&r->wake, &r->lock);
            continue;
        }
        r->next = NULL;
        r->request = request;
        g_mutex_unlock(&r->lock);
        serve(r);
        free_request(request);
        g_mutex_lock(&r->lock);
    }
    g_mutex_unlock(&r->lock);
    return NULL;
}

struct view_renderer *view_renderer_open(int threads, enum hf_isa isa,
                                         void (*deliver_result)(void *cookie, struct view_result *), void *cookie,
                                         struct tool_error *error)
{
    struct view_renderer *r = calloc(1, sizeof(*r));
    const struct hf_config config = {.size = sizeof(config), .threads = threads, .isa = isa};
    int status = r ? HF_OK : HF_ERR_MEMORY;
    for (int i = 0; i < 2 && status == HF_OK; i++)
        status = hf_open(&r->context[i], &config);
    if (status != HF_OK) {
        tool_fail(error, -1, "--threads %d, --isa %s: %s", threads, hf_isa_name(isa), hf_error_string(status));
        hf_close(r ? &r->context[0] : NULL);
        free(r);
        return NULL;
    }
    for (int i = 0; i < 2; i++)
        hf_set_progress(r->context[i], on_progress, r);
    view_levels_open(&r->levels);
    g_mutex_init(&r->lock);
    g_cond_init(&r->wake);
    r->deliver = deliver_result;
    r->cookie = cookie;
    r->thread = g_thread_new("renderer", run, r);
    return r;
}

static unsigned give(struct view_renderer *r, struct view_request *request)
{
    g_mutex_lock(&r->lock);
    const unsigned serial = (unsigned)r->newest + 1;
    if (request)
        request->serial = serial;
    free_request(r->next);
    r->next = request;
    r->busy = request != NULL;
    g_atomic_int_set(&r->newest, (gint)serial);
    g_cond_signal(&r->wake);
    g_mutex_unlock(&r->lock);
    hf_cancel(r->context[1]);
    return serial;
}

unsigned view_renderer_ask(struct view_renderer *r, const struct view_request *request)
{
    struct view_request *copy = malloc(sizeof(*copy));
    if (!copy)
        return 0;
    *copy = *request;
    copy->picture = view_picture_ref(request->picture);
    return give(r, copy);
}

void view_renderer_stop(struct view_renderer *r)
{
    give(r, NULL);
}

int view_renderer_busy(struct view_renderer *r)
{
    g_mutex_lock(&r->lock);
    const int busy = r->busy;
    g_mutex_unlock(&r->lock);
    return busy;
}

void view_renderer_close(struct view_renderer *r)
{
    if (!r)
        return;
    g_mutex_lock(&r->lock);
    r->quit = 1;
    g_atomic_int_inc(&r->newest);
    g_cond_signal(&r->wake);
    g_mutex_unlock(&r->lock);
    hf_cancel(r->context[0]);
    hf_cancel(r->context[1]);
    g_thread_join(r->thread);
    free_request(r->next);
    for (int i = 0; i < 2; i++)
        hf_close(&r->context[i]);
    g_mutex_clear(&r->lock);
    g_cond_clear(&r->wake);
    free(r);
}
