// SPDX-License-Identifier: BSD-3-Clause
#include "cli/json.h"

#include "cli/explain.h"
#include "cli/summary.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

#include "io/out.h"

// Length of the UTF-8 sequence at s, 0 when it is none: file names may be any bytes.
static int utf8_length(const unsigned char *s)
{
    const int n = s[0] < 0x80                   ? 1
                  : s[0] >= 0xc2 && s[0] < 0xe0 ? 2
                  : s[0] >= 0xe0 && s[0] < 0xf0 ? 3
                  : s[0] >= 0xf0 && s[0] < 0xf5 ? 4
                                                : 0;
    for (int i = 1; i < n; i++)
        if ((s[i] & 0xc0) != 0x80)
            return 0;
    // Overlong forms, surrogates and what lies beyond the last code point.
    if ((s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xed && s[1] >= 0xa0) || (s[0] == 0xf0 && s[1] < 0x90) ||
        (s[0] == 0xf4 && s[1] >= 0x90))
        return 0;
    return n;
}

static void put_escaped(FILE *out, const char *text, size_t length)
{
    const unsigned char *s = (const unsigned char *)text, *end = s + length;
    while (s < end) {
        const int n = utf8_length(s);
        if (*s == '"' || *s == '\\')
            fprintf(out, "\\%c", *s);
        else if (*s < 0x20)
            fprintf(out, "\\u%04x", *s);
        else if (n)
            fwrite(s, 1, (size_t)n, out);
        else
            fputs("\\ufffd", out);
        s += n ? n : 1;
    }
}

void cli_json_text(FILE *out, const char *text)
{
    if (!text) {
        fputs("null", out);
        return;
    }
    putc('"', out);
    put_escaped(out, text, strlen(text));
    putc('"', out);
}

// JSON has no infinity and no NaN.
void cli_json_number(FILE *out, double number)
{
    if (isfinite(number))
        fprintf(out, "%.9g", number);
    else
        fputs("null", out);
}

void cli_json_command(FILE *out, int argc, char **argv)
{
    putc('"', out);
    for (int i = 0; i < argc; i++) {
        const char *word = argv[i];
        const int quote = !*word || word[strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                                      "-_=+.,:/@%")];
        fputs(i ? " " : "", out);
        fputs(quote ? "'" : "", out);
        for (const char *part = word;; part++) {
            const size_t n = strcspn(part, "'");
            put_escaped(out, part, n);
            part += n;
            if (!*part)
                break;
            fputs("'\\\\''", out);
        }
        fputs(quote ? "'" : "", out);
    }
    putc('"', out);
}

static void put_model(FILE *out, const struct cli_setup *setup)
{
    const struct hf_params *p = &setup->params;
    fprintf(out, ",\n      \"model\": \"%s\"", cli_model_name(setup->model));
    fputs(",\n      \"focus\": ", out);
    cli_json_number(out, setup->focus_from && p->focus != HF_DERIVE ? p->focus : NAN);
    fputs(",\n      \"focus_from\": ", out);
    cli_json_text(out, setup->focus_from);
    if (setup->model != CLI_MODEL_LENS)
        return;
    const struct {
        const char *name;
        float value;
    } lens[] = {{"fstop", p->lens.f_number},
                {"focal_length", p->lens.focal_length_mm},
                {"sensor_width", p->lens.sensor_width_mm},
                {"world_unit", p->lens.world_unit_m}};
    for (size_t i = 0; i < sizeof(lens) / sizeof(lens[0]); i++) {
        fprintf(out, ",\n      \"%s\": ", lens[i].name);
        cli_json_number(out, lens[i].value);
    }
}

static void put_stats(FILE *out, const struct cli_view *v, const struct cli_frame *frame)
{
    const struct hf_report *s = &v->report;
    const double pixels = (double)v->view->width * v->view->height;
    // The file layer counts over all views, so with several only the sum is known, which is beside them.
    const uint64_t clamped = s->clamped + (frame->view_count == 1 ? frame->written.clamped : 0);
    fprintf(out, ",\n      \"max_radius\": ");
    cli_json_number(out, s->used.params.max_radius);
    fprintf(out, ",\n      \"limit\": \"%s\",\n      \"limited\": %s", hf_name(HF_NAMES_LIMIT, (int)s->used.limit),
            cli_is_limited(v) ? "true" : "false");
    fprintf(out,
            ",\n      \"near_share\": %.9g,\n      \"sharp_share\": %.9g,\n      \"far_share\": %.9g"
            ",\n      \"colour_repaired\": %" PRIu64 ",\n      \"depth_repaired\": %" PRIu64
            ",\n      \"no_surface\": %" PRIu64 ",\n      \"clamped\": %" PRIu64,
            (double)s->near_pixels / pixels, (double)s->sharp_pixels / pixels, (double)s->far_pixels / pixels,
            s->colour_repaired, s->depth_repaired, s->no_surface, clamped);
    fprintf(out, ",\n      \"total_ms\": %.6f,\n      \"passes\": [", s->total_ms);
    for (int i = 0; i < hf_pass_count(s->used.params.engine); i++)
        fprintf(out, "%s\n        {\"name\": \"%s\", \"ms\": %.6f}", i ? "," : "",
                hf_pass_name(s->used.params.engine, i), s->pass[i].ms);
    fputs("\n      ]", out);
}

static void put_report(FILE *out, const struct hf_report *r)
{
    const struct hf_params *used = &r->used.params;
    const int rings = used->engine == HF_ENGINE_GATHER && !r->used.sharp ? used->gather.rings : 0;
    fprintf(out,
            ",\n      \"plan\": {\n        \"engine\": \"%s\",\n        \"resolution\": \"%s\",\n        \"rings\": %d"
            ",\n        \"budget_step\": %d,\n        \"tile_size\": [%d, %d]"
            ",\n        \"tiles\": {\"sharp\": %u, \"near\": %u, \"far\": %u, \"both\": %u}",
            hf_engine_name(used->engine), hf_name(HF_NAMES_RESOLUTION, (int)cli_explain_resolution(used)), rings,
            r->budget_step, r->tile_width, r->tile_height, r->tile_count[HF_TILE_SHARP], r->tile_count[HF_TILE_NEAR],
            r->tile_count[HF_TILE_FAR], r->tile_count[HF_TILE_BOTH]);
    if (r->colour_known)
        fprintf(out, ",\n        \"brightest\": %.9g,\n        \"opaque\": %s,\n        \"not_finite\": %" PRIu64,
                r->brightest, r->opaque ? "true" : "false", r->not_finite);
    fprintf(out,
            ",\n        \"near_radius\": %.9g,\n        \"far_radius\": %.9g,\n        \"memory\": %zu"
            ",\n        \"memory_saved\": %zu,\n        \"plan_ms\": %.6f,\n        \"predicted_ms\": %.6f"
            ",\n        \"passes\": [",
            r->near_radius, r->far_radius, r->memory, r->memory_saved, r->plan_ms, r->predicted_ms);
    for (int i = 0; i < r->passes; i++) {
        const struct hf_pass_report *p = &r->pass[i];
        fprintf(out, "%s\n          {\"name\": \"%s\", \"run\": %u, \"all\": %u, \"predicted_ms\": %.6f, \"ms\": %.6f",
                i ? "," : "", p->name, p->run, p->all, p->predicted_ms, p->ms);
        if (p->skipped)
            fprintf(out, ", \"skipped\": \"%s\"", p->skipped);
        fputc('}', out);
    }
    fputs("\n        ]\n      }", out);
}

static void put_view(FILE *out, const struct cli_view *v, const struct cli_frame *frame)
{
    const struct hf_io_box *data = &v->view->data_window, *display = &v->view->display_window;
    fputs("\n    {\n      \"name\": ", out);
    cli_json_text(out, v->view->name);
    fprintf(out,
            ",\n      \"width\": %d,\n      \"height\": %d,\n      \"data_window\": [%d, %d, %d, %d]"
            ",\n      \"display_window\": [%d, %d, %d, %d]",
            v->view->width, v->view->height, data->x0, data->y0, data->x1 - 1, data->y1 - 1, display->x0, display->y0,
            display->x1 - 1, display->y1 - 1);
    put_model(out, &v->setup);
    if (!frame->args->dry_run)
        put_stats(out, v, frame);
    if (v->tiles)
        put_report(out, &v->report);
    fputs("\n    }", out);
}

void cli_write_json(FILE *out, int argc, char **argv, const struct cli_frame *frame, const struct hf_context *context)
{
    const struct cli_args *args = frame->args;
    fputs("{\n  \"command\": ", out);
    cli_json_command(out, argc, argv);
    fprintf(out, ",\n  \"version\": \"%s\"", hf_version());
    fputs(",\n  \"input\": ", out);
    cli_json_text(out, args->input);
    fputs(",\n  \"output\": ", out);
    cli_json_text(out, args->output);
    fprintf(out, ",\n  \"engine\": \"%s\"", hf_engine_name(args->params.engine));
    fprintf(out, ",\n  \"isa\": \"%s\",\n  \"threads\": %d", hf_isa_name(hf_context_isa(context)),
            hf_context_threads(context));
    fprintf(out, ",\n  \"storage\": \"%s\"", hf_name(HF_NAMES_STORAGE, (int)args->params.gather.storage));
    if (args->dry_run)
        fputs(",\n  \"dry_run\": true", out);
    else
        fprintf(out, ",\n  \"read_ms\": %.6f,\n  \"write_ms\": %.6f,\n  \"clamped\": %" PRIu64,
                frame->ms[CLI_READ] + frame->ms[CLI_DECODE], frame->ms[CLI_ENCODE] + frame->ms[CLI_WRITE],
                frame->written.clamped);
    fputs(",\n  \"views\": [", out);
    for (int i = 0; i < frame->view_count; i++) {
        fputs(i ? "," : "", out);
        put_view(out, &frame->views[i], frame);
    }
    fputs("\n  ]\n}\n", out);
}

static int write_device(int argc, char **argv, const struct cli_frame *frame, const struct hf_context *context,
                        struct cli_error *error)
{
    const char *path = frame->args->json_file;
    FILE *out = fopen(path, "w");
    if (!out)
        return cli_fail(error, CLI_ALL_FAILED, "--json %s cannot be written: %s", path, strerror(errno));
    cli_write_json(out, argc, argv, frame, context);
    const int failed = ferror(out);
    if (fclose(out) || failed)
        return cli_fail(error, CLI_ALL_FAILED, "--json %s could not be written", path);
    return 0;
}

int cli_write_json_file(int argc, char **argv, const struct cli_frame *frame, const struct hf_context *context,
                        struct cli_error *error)
{
    struct hf_out out;
    struct hf_io_error io;
    struct stat st;
    if (!stat(frame->args->json_file, &st) && !S_ISREG(st.st_mode))
        return write_device(argc, argv, frame, context, error);
    int status = hf_out_open(&out, frame->args->json_file, &io);
    if (!status) {
        cli_write_json(out.f, argc, argv, frame, context);
        status = hf_out_commit(&out, &io);
    }
    hf_out_abort(&out);
    return status ? cli_fail(error, CLI_ALL_FAILED, "--json %s", io.message) : 0;
}
