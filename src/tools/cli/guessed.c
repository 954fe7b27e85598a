// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/guessed.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tools/cli/coc.h"
#include "tools/cli/surfaces.h"

// Less than this share is not worth another render, and a cause of less than this part of it is not worth a word.
static const float LITTLE = 0.001f, MINOR = 0.1f;

static int write_image(const struct cli_frame *frame, const struct cli_view *v, struct tool_error *error)
{
    static const char *const name = "guessed";
    const float *plane = v->guesses;
    const struct hf_io_planes planes = {.width = v->view->width,
                                        .height = v->view->height,
                                        .channels = 1,
                                        .names = &name,
                                        .data = &plane,
                                        .stride = v->view->width};
    struct hf_io_error io;
    if (!frame->args->guessed_image || !hf_io_write_planes(frame->args->guessed_image, &planes, &io))
        return 0;
    return tool_fail(error, CLI_ALL_FAILED, "--guessed-image: %s", io.message);
}

// The part of a disc that lies beyond a line at a distance from its centre: r^2 (acos t - t sqrt(1 - t^2)) of pi r^2.
static float segment(float radius, float distance)
{
    const float t = radius > 0 ? distance / radius : 1;
    return t < 1 ? (acosf(t) - t * sqrtf(1 - t * t)) / 3.14159265f : 0;
}

// How much of the light of pixel (x, y) comes from beyond the frame, if what is there is blurred as at the border.
static float beyond(const float *radii, int width, int height, int x, int y)
{
    const float own = fabsf(radii[(size_t)y * (size_t)width + (size_t)x]);
    const struct {
        int x, y, away;
    } sides[4] = {{0, y, x}, {width - 1, y, width - 1 - x}, {x, 0, y}, {x, height - 1, height - 1 - y}};
    float sum = 0;
    for (int i = 0; i < 4; i++) {
        const float there = fabsf(radii[(size_t)sides[i].y * (size_t)width + (size_t)sides[i].x]);
        sum += segment(fmaxf(own, there), (float)sides[i].away + 0.5f);
    }
    return sum;
}

// Divide what was guessed between what lies beyond the frame and what objects hide.
static int divide(struct cli_view *v, struct tool_error *error)
{
    const int width = v->view->width, height = v->view->height;
    const size_t n = (size_t)width * (size_t)height;
    const struct hf_io_box all = {0, 0, width, height};
    struct hf_depth depth = v->setup.depth;
    float *radii = hf_io_alloc(n * sizeof(*radii)), most = 0;
    double sum = 0;
    depth.data = v->depth;
    if (!radii)
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", v->label);
    if (v->depth && !cli_coc_radii(&depth, width, height, &v->setup.params, &all, radii))
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++) {
                const size_t i = (size_t)y * (size_t)width + (size_t)x;
                const int border = x == 0 || y == 0 || x == width - 1 || y == height - 1;
                most = border ? fmaxf(most, fabsf(radii[i])) : most;
                sum += v->guesses[i] > 0 ? fminf(v->guesses[i], beyond(radii, width, height, x, y)) : 0;
            }
    free(radii);
    v->guess.beyond = (float)(sum / (double)n);
    v->guess.overscan = (int)ceilf(most);
    return 0;
}

int cli_guessed_find(struct cli_session *session, const struct cli_frame *frame, struct cli_view *v,
                     const struct hf_image *image, struct tool_error *error)
{
    const size_t n = (size_t)v->view->width * (size_t)v->view->height;
    struct hf_report report = {.size = sizeof(report)};
    struct hf_params params = v->setup.params;
    struct hf_image dst = *image;
    float *memory = hf_io_alloc(3 * n * sizeof(float));
    if (!memory)
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", v->label);
    for (int c = 0; c < 4; c++)
        dst.data[c] = c < 3 ? memory + (size_t)c * n : NULL;
    params.layers.guessed = 1;
    params.run.budget_ms = 0;
    const int status = cli_surfaces_render_to(session->context, frame, v, image, &dst, &params);
    free(v->guesses);
    v->guesses = memory;
    if (status != HF_OK)
        return tool_fail(error, status == HF_ERR_ARG ? CLI_BAD_ARGUMENTS : CLI_ALL_FAILED, "%s: %s", v->label,
                         session->log.text[0] ? session->log.text : hf_error_string(status));
    hf_get_report(session->context, &report);
    v->guess = (struct cli_guess){.share = (float)report.guessed, .surfaces = v->surface_count, .deep = v->view->deep};
    const int divided = divide(v, error);
    return divided ? divided : write_image(frame, v, error);
}

const char *cli_guessed_sentence(const struct cli_guess *g, const char *about, char *text, size_t size)
{
    int n = snprintf(text, size, "%.2g %% of the picture rests on guesses%s", 100 * g->share, about);
    const int border = g->beyond > MINOR * g->share && g->overscan > 0,
              hidden = g->share - g->beyond > MINOR * g->share;
    if (g->share < LITTLE)
        return text;
    if (border)
        n += snprintf(text + n, size - (size_t)n, "; overscan of %d pixel%s", g->overscan, g->overscan == 1 ? "" : "s");
    if (hidden)
        n += snprintf(text + n, size - (size_t)n, "%s%s", border ? " or " : "; ",
                      g->deep       ? "deep samples of what objects hide"
                      : g->surfaces ? "a further layer"
                                    : "a second layer");
    if (border || hidden)
        snprintf(text + n, size - (size_t)n, " would help");
    return text;
}

void cli_guessed_print(const struct cli_frame *frame)
{
    char text[256];
    for (int i = 0; i < frame->view_count && frame->args->guessed && !frame->args->quiet; i++)
        tool_print_line("%s: %s", frame->views[i].label,
                        cli_guessed_sentence(&frame->views[i].guess, "", text, sizeof(text)));
}

void cli_guessed_json(struct tool_json *j, const struct cli_frame *frame, const struct cli_view *v)
{
    if (!frame->args->guessed)
        return;
    tool_json_number(j, "guessed", v->guess.share);
    tool_json_number(j, "guessed_beyond", v->guess.beyond);
    tool_json_count(j, "overscan", v->guess.overscan);
}
