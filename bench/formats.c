// SPDX-License-Identifier: BSD-3-Clause
// `hyperfocal-bench formats`: the time to read and to store each format of colour and of depth, and that of a whole
// frame. A frame in which nothing is blurred is only read and stored. Converting between two formats in both directions
// costs the reading and storing of both. Three formats converted among each other give the cost of one, (ab + ac - bc)
// / 2, and with that every other format's.
#include "commands.h"
#include "statistics.h"
#include "subject.h"
#include "write.h"

#include "tools/common/machine.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// On a shared machine other programs only add time, so the least of the rounds' medians counts.
enum { ROUNDS = 3, REPEATS = 7, COLOURS = 17, DEPTHS = 7, PARTNER = 0 };

static const struct {
    enum hf_format format;
    enum hf_transfer transfer;
} colours[COLOURS] = {
    {HF_FORMAT_R11G11B10F, HF_TRANSFER_LINEAR}, {HF_FORMAT_RGBA16F, HF_TRANSFER_LINEAR},
    {HF_FORMAT_RGB32F, HF_TRANSFER_LINEAR},     {HF_FORMAT_RGBA32F, HF_TRANSFER_LINEAR},
    {HF_FORMAT_PLANAR32F, HF_TRANSFER_LINEAR},  {HF_FORMAT_RGBA8, HF_TRANSFER_SRGB},
    {HF_FORMAT_RGBA8, HF_TRANSFER_LINEAR},      {HF_FORMAT_BGRA8, HF_TRANSFER_SRGB},
    {HF_FORMAT_BGRA8, HF_TRANSFER_LINEAR},      {HF_FORMAT_RGBX8, HF_TRANSFER_SRGB},
    {HF_FORMAT_RGBX8, HF_TRANSFER_LINEAR},      {HF_FORMAT_BGRX8, HF_TRANSFER_SRGB},
    {HF_FORMAT_BGRX8, HF_TRANSFER_LINEAR},      {HF_FORMAT_RGB10A2, HF_TRANSFER_SRGB},
    {HF_FORMAT_RGB10A2, HF_TRANSFER_LINEAR},    {HF_FORMAT_RGBA16, HF_TRANSFER_SRGB},
    {HF_FORMAT_RGBA16, HF_TRANSFER_LINEAR},
};

static const struct {
    enum hf_depth_format format;
    enum hf_depth_type type;
    unsigned bytes;
} depths[DEPTHS] = {
    {HF_DEPTH_FORMAT_FLOAT32, HF_DEPTH_VIEW, 4},    {HF_DEPTH_FORMAT_FLOAT16, HF_DEPTH_VIEW, 2},
    {HF_DEPTH_FORMAT_FLOAT32, HF_DEPTH_NDC_D3D, 4}, {HF_DEPTH_FORMAT_UNORM16, HF_DEPTH_NDC_D3D, 2},
    {HF_DEPTH_FORMAT_UNORM32, HF_DEPTH_NDC_D3D, 4}, {HF_DEPTH_FORMAT_D24S8, HF_DEPTH_NDC_D3D, 4},
    {HF_DEPTH_FORMAT_X8D24, HF_DEPTH_NDC_D3D, 4},
};
static const float NEAR = 0.5f, FAR = 1000;  // clip planes of these depths

struct colour_cost {
    size_t bytes;       // size of a picture
    double to, from;    // milliseconds, to the partner format and from it
    double read_store;  // of this format alone
    double frame;       // from this format to itself, with blur
};

struct depth_cost {
    double plan, frame;  // reading it once for the plan; and a whole frame in the partner's format
};

struct formats {
    const struct bench_args *args;
    int threads;
    enum hf_isa isa;
    struct colour_cost colour[COLOURS];
    struct depth_cost depth[DEPTHS];
    double third[2];  // both directions between the two formats that stand in for the partner
};

static int open_image(struct bench_image *m, const struct bench_scene *scene, int row)
{
    if (bench_image_alloc(m, scene->width, scene->height, colours[row].format))
        return -1;
    m->image.transfer = colours[row].transfer;
    bench_image_pack(m, scene->rgb);
    return 0;
}

struct job {
    struct hf_context *context;
    const struct hf_image *to, *from;
    const struct hf_depth *depth;
    const struct hf_params *params;
    int plan;
};

// The median of REPEATS runs after a warm-up. *ms keeps its value if that is less.
static int measure(const struct job *j, double *ms, struct tool_error *error)
{
    double times[REPEATS];
    for (int i = -1; i < REPEATS; i++) {
        const double start = tool_now_ms();
        const int err = j->plan ? hf_plan(j->context, j->to, j->from, j->depth, j->params, NULL)
                                : hf_render(j->context, j->to, j->from, j->depth, j->params);
        if (err)
            return tool_fail(error, -1, "rendering failed: %s", hf_error_string(err));
        if (i >= 0)
            times[i] = tool_now_ms() - start;
    }
    *ms = fmin(*ms, bench_median(times, REPEATS));
    return 0;
}

// Both directions between two formats, with nothing blurred.
static int convert(const struct bench_subject *s, const struct bench_image *a, const struct bench_image *b, double *to,
                   double *from, struct tool_error *error)
{
    struct hf_params sharp = s->params;
    sharp.max_radius = 0;
    const struct job there = {s->context, &b->image, &a->image, &s->depth, &sharp, 0};
    const struct job back = {s->context, &a->image, &b->image, &s->depth, &sharp, 0};
    return measure(&there, to, error) || measure(&back, from, error) ? -1 : 0;
}

static int measure_colour(struct formats *r, int row, const struct bench_subject *s, const struct bench_scene *scene,
                          struct tool_error *error)
{
    struct colour_cost *cost = &r->colour[row];
    struct bench_image in = {0}, out = {0};
    int err =
        open_image(&in, scene, row) || open_image(&out, scene, row)
            ? tool_fail(error, -1, "there is not enough memory for pictures of %dx%d", scene->width, scene->height)
            : 0;
    cost->bytes = in.bytes;
    if (!err && row != PARTNER)
        err = convert(s, &in, &s->out, &cost->to, &cost->from, error);
    const struct job frame = {s->context, &out.image, &in.image, &s->depth, &s->params, 0};
    if (!err)
        err = measure(&frame, &cost->frame, error);
    bench_image_free(&in);
    bench_image_free(&out);
    return err;
}

enum { B = 10, C = 14 };  // RGBX8 and RGB10A2, linear: as large as the partner

static int measure_third(struct formats *r, const struct bench_subject *s, const struct bench_scene *scene,
                         struct tool_error *error)
{
    struct bench_image b = {0}, c = {0};
    const int err =
        open_image(&b, scene, B) || open_image(&c, scene, C)
            ? tool_fail(error, -1, "there is not enough memory for pictures of %dx%d", scene->width, scene->height)
            : convert(s, &b, &c, &r->third[0], &r->third[1], error);
    bench_image_free(&b);
    bench_image_free(&c);
    return err;
}

static void take_partner_out(struct formats *r)
{
    const struct colour_cost *ab = &r->colour[B], *ac = &r->colour[C];
    const double partner = 0.5 * (ab->to + ab->from + ac->to + ac->from - r->third[0] - r->third[1]);
    r->colour[PARTNER].read_store = partner;
    for (int i = 1; i < COLOURS; i++)
        r->colour[i].read_store = r->colour[i].to + r->colour[i].from - partner;
}

// A distance as the depth format stores it.
static uint32_t word_of(int row, float z)
{
    const double n = NEAR, f = FAR, d = fmin(fmax(f * (z - n) / (z * (f - n)), 0), 1);
    switch (depths[row].format) {
    case HF_DEPTH_FORMAT_FLOAT16:
        return bench_to_half(fminf(z, 65504));
    case HF_DEPTH_FORMAT_UNORM16:
        return (uint32_t)(d * 65535 + 0.5);
    case HF_DEPTH_FORMAT_UNORM32:
        return (uint32_t)(d * 4294967295.0 + 0.5);
    case HF_DEPTH_FORMAT_D24S8:
        return (uint32_t)(d * 16777215 + 0.5) << 8;
    case HF_DEPTH_FORMAT_X8D24:
        return (uint32_t)(d * 16777215 + 0.5);
    default: {
        const float v = depths[row].type == HF_DEPTH_VIEW ? z : (float)d;
        uint32_t word;
        memcpy(&word, &v, sizeof word);
        return word;
    }
    }
}

static int measure_depth(struct formats *r, int row, const struct bench_subject *s, const struct bench_scene *scene,
                         struct tool_error *error)
{
    const size_t n = (size_t)scene->width * (size_t)scene->height, bytes = depths[row].bytes;
    uint8_t *words = aligned_alloc(64, (n * bytes + 63) / 64 * 64);
    if (!words)
        return tool_fail(error, -1, "there is not enough memory for %dx%d", scene->width, scene->height);
    for (size_t i = 0; i < n; i++) {
        const uint32_t word = word_of(row, scene->depth[i]);
        memcpy(words + i * bytes, &word, bytes);
    }
    const struct hf_depth depth = {.size = sizeof depth,
                                   .data = words,
                                   .stride = scene->width * (ptrdiff_t)bytes,
                                   .type = depths[row].type,
                                   .format = depths[row].format,
                                   .near_plane = NEAR,
                                   .far_plane = FAR};
    struct job job = {s->context, &s->out.image, &s->in.image, &depth, &s->params, 1};
    int err = measure(&job, &r->depth[row].plan, error);
    job.plan = 0;
    if (!err)
        err = measure(&job, &r->depth[row].frame, error);
    free(words);
    return err;
}

static void table(FILE *out, const void *what)
{
    const struct formats *r = what;
    const char *partner = hf_name(HF_NAMES_FORMAT, (int)colours[PARTNER].format);
    fprintf(out, "%-13s %-8s %7s %13s %9s %11s %9s\n", "colour", "transfer", "MB", "read + store", "only read",
            "only stored", "frame");
    for (int i = 0; i < COLOURS; i++) {
        const struct colour_cost *c = &r->colour[i];
        fprintf(out, "%-13s %-8s %7.1f %13.3f ", hf_name(HF_NAMES_FORMAT, (int)colours[i].format),
                hf_name(HF_NAMES_TRANSFER, (int)colours[i].transfer), (double)c->bytes * 1e-6, c->read_store);
        if (i == PARTNER)
            fprintf(out, "%9s %11s ", "", "");
        else
            fprintf(out, "%9.3f %11.3f ", c->to, c->from);
        fprintf(out, "%9.3f\n", c->frame);
    }
    fprintf(out, "\n%-13s %-8s %7s %13s %9s %11s %9s\n", "depth", "type", "MB", "read, planned", "", "", "frame");
    for (int i = 0; i < DEPTHS; i++)
        fprintf(out, "%-13s %-8s %7.1f %13.3f %9s %11s %9.3f\n", hf_name(HF_NAMES_DEPTH_FORMAT, (int)depths[i].format),
                hf_name(HF_NAMES_DEPTH_TYPE, (int)depths[i].type),
                1e-6 * r->args->width * r->args->height * depths[i].bytes, r->depth[i].plan, "", "", r->depth[i].frame);
    fprintf(out,
            "\nmilliseconds, best of %d rounds of %d; only read: stored as %s; only stored: read from that; frame: as "
            "passes,\n"
            "read and stored in the format. %s, %d threads, %dx%d, engine %s, scene %s\n",
            ROUNDS, REPEATS, partner, hf_isa_name(r->isa), r->threads, r->args->width, r->args->height,
            hf_engine_name(r->args->params.engine), r->args->scene);
}

static void json(FILE *out, const void *what)
{
    const struct formats *r = what;
    struct tool_json j;
    bench_json_begin(&j, out, "formats", r->args);
    tool_json_text(&j, "engine", hf_engine_name(r->args->params.engine));
    tool_json_count(&j, "threads", r->threads);
    tool_json_text(&j, "isa", hf_isa_name(r->isa));
    tool_json_count(&j, "width", r->args->width);
    tool_json_count(&j, "height", r->args->height);
    tool_json_open(&j, "colour", '[');
    for (int i = 0; i < COLOURS; i++) {
        tool_json_row(&j, NULL, '{');
        tool_json_text(&j, "format", hf_name(HF_NAMES_FORMAT, (int)colours[i].format));
        tool_json_text(&j, "transfer", hf_name(HF_NAMES_TRANSFER, (int)colours[i].transfer));
        tool_json_count(&j, "bytes", (long long)r->colour[i].bytes);
        tool_json_ms(&j, "read_store_ms", r->colour[i].read_store);
        tool_json_ms(&j, "read_ms", i == PARTNER ? NAN : r->colour[i].to);
        tool_json_ms(&j, "store_ms", i == PARTNER ? NAN : r->colour[i].from);
        tool_json_ms(&j, "frame_ms", r->colour[i].frame);
        tool_json_close(&j);
    }
    tool_json_close(&j);
    tool_json_open(&j, "depth", '[');
    for (int i = 0; i < DEPTHS; i++) {
        tool_json_row(&j, NULL, '{');
        tool_json_text(&j, "format", hf_name(HF_NAMES_DEPTH_FORMAT, (int)depths[i].format));
        tool_json_text(&j, "type", hf_name(HF_NAMES_DEPTH_TYPE, (int)depths[i].type));
        tool_json_ms(&j, "plan_ms", r->depth[i].plan);
        tool_json_ms(&j, "frame_ms", r->depth[i].frame);
        tool_json_close(&j);
    }
    tool_json_end(&j);
}

int bench_formats(struct bench_args *args, struct tool_error *error)
{
    struct formats r = {.args = args};
    struct bench_scene scene = {0};
    struct bench_subject subject = {0};
    struct tool_error log = {""};
    const struct bench_optics optics = {args->params.focus, args->params.range.distance, args->params.max_radius};
    args->in = args->out = colours[PARTNER].format;
    int err = bench_scene_paint(&scene, args->scene, args->width, args->height, &optics, error);
    if (!err)
        err = bench_subject_open(&subject, args, &scene, &log, error);
    if (!err) {
        r.threads = hf_context_threads(subject.context);
        r.isa = hf_context_isa(subject.context);
    }
    for (int i = 0; i < COLOURS; i++)
        r.colour[i] = (struct colour_cost){.to = INFINITY, .from = INFINITY, .frame = INFINITY};
    for (int i = 0; i < DEPTHS; i++)
        r.depth[i] = (struct depth_cost){INFINITY, INFINITY};
    r.third[0] = r.third[1] = INFINITY;
    for (int round = 0; round < ROUNDS && !err; round++) {
        for (int i = 0; i < COLOURS && !err; i++)
            err = measure_colour(&r, i, &subject, &scene, error);
        if (!err)
            err = measure_third(&r, &subject, &scene, error);
        for (int i = 0; i < DEPTHS && !err; i++)
            err = measure_depth(&r, i, &subject, &scene, error);
    }
    take_partner_out(&r);
    if (err && *log.text)
        tool_fail(error, -1, "%s", log.text);
    if (!err)
        err = bench_write_report(args, table, json, &r, error);
    bench_subject_close(&subject);
    bench_scene_free(&scene);
    return err;
}
