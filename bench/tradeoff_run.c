// SPDX-License-Identifier: BSD-3-Clause
#include "tradeoff_run.h"

#include "tools/common/machine.h"
#include "tools/common/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    BOTH_WIDTH = 1920,
    BOTH_HEIGHT = 1080,
    PULL = 5,
    FEW = 3,
    MOST = 15,  // frames whose median is one sample, for fast settings
};
static const double fast_ms = 40, sample_ms = 60;
static const float pull_step = 0.25f;  // pixels of radius between the frames of a focus pull

static void keep_message(void *cookie, const struct hf_message *message)
{
    if (message->level == HF_LOG_ERROR)
        snprintf(((struct tool_error *)cookie)->text, sizeof((struct tool_error *)cookie)->text, "%s",
                 message->sentence);
}

static int get_context(struct trade_run *run, struct trade_job *job, struct tool_error *error)
{
    int i = 0;
    for (; i < TRADE_CONTEXTS && run->context[i].context; i++)
        if (run->context[i].threads == job->args.threads && run->context[i].isa == job->args.isa) {
            job->context = run->context[i].context;
            return 0;
        }
    if (i == TRADE_CONTEXTS)
        return tool_fail(error, -1, "there are more pairs of --threads and --isa than %d", TRADE_CONTEXTS);
    const struct hf_config config = {.size = sizeof config,
                                     .threads = job->args.threads,
                                     .isa = job->args.isa,
                                     .log = keep_message,
                                     .log_cookie = &run->log};
    const int err = hf_open(&run->context[i].context, &config);
    if (err)
        return tool_fail(error, -1, "%s", *run->log.text ? run->log.text : hf_error_string(err));
    run->context[i].threads = job->args.threads;
    run->context[i].isa = job->args.isa;
    job->context = run->context[i].context;
    return 0;
}

// Split a line into words at blanks; text is changed.
static int split(char *text, char *words[], int most)
{
    int n = 0;
    char *save = NULL;
    for (char *w = strtok_r(text, " ", &save); w && n < most; w = strtok_r(NULL, " ", &save))
        words[n++] = w;
    return n;
}

static int parse_job(struct trade_run *run, struct trade_job *job, const char *options, struct tool_error *error)
{
    enum { WORDS = 64 };
    char text[1024], *words[WORDS];
    bench_args_default(&job->args);
    job->args.params = hf_default_params();
    job->args.threads = run->t->args->threads;
    job->args.isa = run->t->args->isa;
    snprintf(text, sizeof text, "%s", options);
    if (bench_args_parse(&job->args, NULL, split(text, words, WORDS), words, error))
        return -1;
    return get_context(run, job, error);
}

// A gaussian spreads light as far as a disc of twice its standard deviation, at any depth.
static float farthest(const struct hf_params *p)
{
    static const struct hf_depth depth = {.size = sizeof depth, .type = HF_DEPTH_VIEW};
    struct hf_params filled = {.size = sizeof filled};
    if (p->engine != HF_ENGINE_GAUSSIAN || hf_resolve(BOTH_WIDTH, BOTH_HEIGHT, &depth, p, &filled, NULL, NULL))
        return INFINITY;
    return 2 * filled.gaussian.sigma;
}

int trade_run_parse(struct trade_run *run, struct tool_error *error)
{
    struct trade *t = run->t;
    int kept = 0;
    run->job = calloc((size_t)t->results, sizeof *run->job);
    if (!run->job)
        return tool_fail(error, -1, "there is not enough memory");
    for (int i = 0; i < t->results; i++) {
        const char *isa = strstr(t->result[i].setting->options, "--isa ");
        int available = 1;
        for (int k = 0; isa && hf_isa_name((enum hf_isa)k); k++) {
            const size_t n = strlen(hf_isa_name((enum hf_isa)k));
            if (!strncmp(isa + 6, hf_isa_name((enum hf_isa)k), n) && strchr(" ", isa[6 + n]))
                available = hf_isa_available((enum hf_isa)k);
        }
        if (!available)
            continue;
        if (parse_job(run, &run->job[kept], t->result[i].setting->options, error))
            return -1;
        t->result[kept] = t->result[i];
        t->result[kept].params = run->job[kept].args.params;
        t->result[kept].engine = run->job[kept].args.params.engine;
        t->result[kept].farthest = farthest(&run->job[kept].args.params);
        kept++;
    }
    t->results = kept;
    t->threads = hf_context_threads(run->job[0].context);
    t->isa = hf_context_isa(run->job[0].context);
    if (bench_workers_open(&run->workers, t->threads))
        return tool_fail(error, -1, "%d threads could not be started", t->threads);
    return 0;
}

static int open_both(struct trade_run *run, struct tool_error *error)
{
    const struct bench_optics optics = {20, 10, TRADE_RADIUS};
    if (bench_scene_paint(&run->both, "both", BOTH_WIDTH, BOTH_HEIGHT, &optics, error))
        return -1;
    if (bench_image_alloc(&run->both_in, BOTH_WIDTH, BOTH_HEIGHT, HF_FORMAT_R11G11B10F) ||
        bench_image_alloc(&run->both_out, BOTH_WIDTH, BOTH_HEIGHT, HF_FORMAT_R11G11B10F))
        return tool_fail(error, -1, "there is not enough memory");
    bench_image_pack(&run->both_in, run->both.rgb);
    return 0;
}

int trade_run_open(struct trade_run *run, struct trade *t, struct tool_error *error)
{
    *run = (struct trade_run){.t = t};
    const int n = trade_scenes_read(run->scene, t->args->images, error);
    if (n < 0)
        return -1;
    t->scenes = n;
    for (int s = 0; s < n; s++) {
        const struct bench_scene *p = &run->scene[s].picture;
        const size_t samples = 3 * (size_t)p->width * (size_t)p->height;
        snprintf(t->scene[s].text, sizeof t->scene[s].text, "%s", run->scene[s].name);
        t->width[s] = p->width;
        t->height[s] = p->height;
        t->largest[s] = run->scene[s].largest;
        run->pull_samples = samples > run->pull_samples ? samples : run->pull_samples;
        if (bench_image_alloc(&run->in[s], p->width, p->height, HF_FORMAT_RGB32F) ||
            bench_image_alloc(&run->out[s], p->width, p->height, HF_FORMAT_RGB32F))
            return tool_fail(error, -1, "there is not enough memory");
        bench_image_pack(&run->in[s], p->rgb);
    }
    for (int i = 0; i < PULL; i++)
        if (!(run->pull[i] = malloc(run->pull_samples * sizeof(float))))
            return tool_fail(error, -1, "there is not enough memory");
    return open_both(run, error);
}

void trade_run_close(struct trade_run *run)
{
    for (int i = 0; i < TRADE_CONTEXTS; i++)
        hf_close(&run->context[i].context);
    for (int s = 0; run->t && s < run->t->scenes; s++) {
        bench_image_free(&run->in[s]);
        bench_image_free(&run->out[s]);
    }
    if (run->t)
        trade_scenes_free(run->scene, run->t->scenes);
    for (int i = 0; i < PULL; i++)
        free(run->pull[i]);
    bench_workers_close(&run->workers);
    bench_image_free(&run->both_in);
    bench_image_free(&run->both_out);
    bench_scene_free(&run->both);
    free(run->job);
}

// The parameters of a setting on a scene; scene -1: on `both`.
static struct hf_params params_of(const struct trade_run *run, int result, int scene)
{
    const struct bench_args *args = &run->job[result].args;
    struct hf_params p = args->params;
    if (scene < 0) {
        p.focus = 20;
        p.range.distance = 10;
        if (!args->max_radius_given)
            p.max_radius = TRADE_RADIUS;
        return p;
    }
    const struct trade_scene *s = &run->scene[scene];
    p.model = HF_MODEL_LENS;
    p.focus = s->camera.focus;
    p.lens.f_number = s->camera.f_number;
    p.lens.focal_length_mm = s->camera.focal_length_mm;
    p.lens.sensor_width_mm = s->camera.sensor_width_mm;
    return p;
}

static int render(struct trade_run *run, int result, int scene, const struct hf_params *p, struct tool_error *error)
{
    const struct bench_scene *picture = scene < 0 ? &run->both : &run->scene[scene].picture;
    const struct bench_image *in = scene < 0 ? &run->both_in : &run->in[scene];
    const struct bench_image *out = scene < 0 ? &run->both_out : &run->out[scene];
    const struct hf_depth depth = {
        .size = sizeof depth, .data = picture->depth, .stride = picture->width * (ptrdiff_t)sizeof(float)};
    *run->log.text = '\0';
    const int err = hf_render(run->job[result].context, &out->image, &in->image, &depth, p);
    if (err)
        return tool_fail(error, -1, "%s: %s", run->t->result[result].setting->options,
                         *run->log.text ? run->log.text : hf_error_string(err));
    return 0;
}

int trade_run_render(struct trade_run *run, int result, int scene, struct tool_error *error)
{
    const struct hf_params p = params_of(run, result, scene);
    return render(run, result, scene, &p, error);
}

struct encode {
    struct trade_run *run;
    int scene;
    const float *from;
    float *to;
    size_t samples;
};

static void encode_part(void *arg, int i, int threads)
{
    const struct encode *e = arg;
    for (size_t k = e->samples * (size_t)i / (size_t)threads; k < e->samples * ((size_t)i + 1) / (size_t)threads; k++)
        e->to[k] = bench_display(e->from[k]);
}

// Render a focus pull around the scene's focus, and measure how unsteadily the picture changes.
static int measure_flicker(struct trade_run *run, int result, int scene, double *flicker, struct tool_error *error)
{
    const struct trade_scene *s = &run->scene[scene];
    const struct bench_scene *p = &s->picture;
    const size_t samples = 3 * (size_t)p->width * (size_t)p->height;
    // The radius of an infinitely far point times the focus distance.
    const float k = trade_radius(&s->camera, p->width, 0) * s->camera.focus;
    for (int i = 0; i < PULL; i++) {
        struct hf_params params = params_of(run, result, scene);
        params.focus = 1 / (1 / s->camera.focus + (float)(i - PULL / 2) * pull_step / k);
        if (render(run, result, scene, &params, error))
            return -1;
        struct encode e = {run, scene, trade_run_picture(run, scene), run->pull[i], samples};
        bench_workers_run(run->workers, encode_part, &e);
    }
    *flicker = 0;
    for (int i = 1; i + 1 < PULL; i++)
        *flicker += bench_flicker(run->pull[i - 1], run->pull[i], run->pull[i + 1], samples) / (PULL - 2);
    return 0;
}

struct compare {
    struct trade_run *run;
    struct trade_result *result;
    int wanted[TRADE_SCENES];
};

static void compare_part(void *arg, int i, int threads)
{
    const struct compare *c = arg;
    for (int s = i; s < c->run->t->scenes; s += threads)
        if (c->wanted[s])
            bench_metrics_compare(c->run->scene[s].metrics, trade_run_picture(c->run, s), c->result->at[s].distance);
}

int trade_run_distances(struct trade_run *run, int result, int with_flicker, struct tool_error *error)
{
    struct compare c = {run, &run->t->result[result], {0}};
    for (int s = 0; s < run->t->scenes; s++) {
        struct trade_point *point = &c.result->at[s];
        if (point->measured && !(with_flicker && isnan(point->flicker)))
            continue;
        c.wanted[s] = point->measured = 1;
        point->flicker = NAN;
        if ((with_flicker && measure_flicker(run, result, s, &point->flicker, error)) ||
            trade_run_render(run, result, s, error))
            return -1;
    }
    bench_workers_run(run->workers, compare_part, &c);
    return 0;
}

static int timed(struct trade_run *run, int result, int scene, double *ms, double pass[TRADE_PASSES],
                 struct tool_error *error)
{
    const double start = tool_now_ms();
    if (trade_run_render(run, result, scene, error))
        return -1;
    *ms = tool_now_ms() - start;
    struct tool_report report;
    tool_report_get(run->job[result].context, &report);
    for (int i = 0; i < TRADE_PASSES; i++)
        pass[i] = i < report.inner.passes ? report.pass[i].ms : 0;
    return 0;
}

int trade_run_time(struct trade_run *run, int result, int scene, struct tool_error *error)
{
    struct trade_result *r = &run->t->result[result];
    struct trade_time *time = scene < 0 ? &r->both : &r->at[scene].time;
    double ms[MOST], pass[MOST][TRADE_PASSES];
    // The first frame after another setting's frame rearranges the memory, so it is not counted.
    if (timed(run, result, scene, &ms[0], pass[0], error) || timed(run, result, scene, &ms[0], pass[0], error))
        return -1;
    int n = 1, middle = 0;
    if (ms[0] < fast_ms)
        n = (int)fmin(fmax(sample_ms / ms[0], FEW), MOST) | 1;
    for (int i = 1; i < n; i++)
        if (timed(run, result, scene, &ms[i], pass[i], error))
            return -1;
    for (int i = 0; i < n; i++) {
        int less = 0;
        for (int k = 0; k < n; k++)
            less += ms[k] < ms[i] || (ms[k] == ms[i] && k < i);
        if (less == n / 2)
            middle = i;
    }
    time->sample[time->n] = ms[middle];
    memcpy(time->pass[time->n++], pass[middle], sizeof pass[middle]);
    return 0;
}
