// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/lens.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static int given(float number)
{
    return !isnan(number);
}

int cli_lens_usable(float number)
{
    return isfinite(number) && number > 0;
}

float cli_lens_header_focal(const struct hf_io_camera *camera)
{
    return cli_lens_usable(camera->focal_length_mm)     ? camera->focal_length_mm
           : cli_lens_usable(camera->nominal_length_mm) ? camera->nominal_length_mm
                                                        : NAN;
}

static float first(float option, float header, float otherwise)
{
    return given(option) ? option : cli_lens_usable(header) ? header : otherwise;
}

static int names_range(const struct cli_args *args)
{
    return given(args->range) || given(args->near_begin) || given(args->near_end) || given(args->far_begin) ||
           given(args->far_end);
}

static int asks_range(const struct cli_args *args)
{
    return names_range(args) || given(args->depth_of_field) || given(args->strength);
}

// The option that chose the range model although its name does not say so; NULL if --range or the like was given, too.
static const char *hidden_range(const struct cli_args *args)
{
    if (names_range(args))
        return NULL;
    return given(args->depth_of_field) ? "--depth-of-field" : "--strength";
}

// Does the header have the whole lens? A focus that the command line gives need not be there.
static int has_lens(const struct cli_args *args, const struct hf_io_camera *camera)
{
    const int focus = cli_lens_usable(camera->focus) || camera->focus == INFINITY || args->focus_by != CLI_FOCUS_HEADER;
    return focus && cli_lens_usable(camera->f_number) && given(cli_lens_header_focal(camera));
}

enum cli_model cli_lens_model(const struct cli_args *args, const struct hf_io_camera *camera)
{
    if (args->depth_type == HF_DEPTH_COC)
        return CLI_MODEL_COC;
    if (asks_range(args))
        return CLI_MODEL_RANGE;
    if (given(args->fstop) || given(args->focal_length))
        return CLI_MODEL_LENS;
    return has_lens(args, camera) ? CLI_MODEL_LENS : CLI_MODEL_RANGE;
}

const char *cli_lens_from(const struct cli_args *args, const struct hf_io_camera *camera)
{
    const int some = given(args->fstop) || given(args->focal_length),
              all = given(args->fstop) && given(args->focal_length);
    return all            ? ""
           : camera->exif ? some ? " (the rest from EXIF)" : " (from EXIF)"
           : some         ? " (the rest from the header)"
                          : " (from the header)";
}

int cli_lens_set(struct hf_params *p, const struct cli_args *args, const struct hf_io_camera *camera, const char *label,
                 struct tool_error *error)
{
    p->lens.f_number = first(args->fstop, camera->f_number, NAN);
    p->lens.focal_length_mm = first(args->focal_length, cli_lens_header_focal(camera), NAN);
    // EXIF's sensor belongs to its focal length.
    const float sensor = camera->exif && given(args->focal_length) ? NAN : camera->sensor_width_mm;
    p->lens.sensor_width_mm = first(args->sensor_width, sensor, 36);
    p->lens.world_unit_m = given(args->world_unit) ? args->world_unit : 1;
    if (!given(p->lens.focal_length_mm))
        return tool_fail(error, CLI_BAD_ARGUMENTS,
                         "%s: --fstop %g needs --focal-length, the header has no pinholeFocalLength", label,
                         args->fstop);
    if (!given(p->lens.f_number))
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s: --focal-length %g needs --fstop, the header has no aperture",
                         label, args->focal_length);
    return 0;
}

// "focus 4, aperture 2"
static void add(char *list, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));
static void add(char *list, size_t size, const char *format, ...)
{
    const size_t n = strlen(list);
    va_list values;
    if (n)
        snprintf(list + n, size - n, " and ");
    va_start(values, format);
    vsnprintf(list + strlen(list), size - strlen(list), format, values);
    va_end(values);
}

// For a header with an incomplete lens: write what it has, what it lacks, and which options would complete it.
static int tell_gap(const struct cli_args *args, const struct hf_io_camera *camera, char *text, size_t size)
{
    char has[128] = "", lacks[160] = "", options[64] = "";
    const struct {
        const char *name, *option;
        float value;
        int helps;  // whether this value alone hints at a lens; the focus does only if it is the header's
    } parts[] = {{"focus", "--focus", camera->focus, args->focus_by == CLI_FOCUS_HEADER},
                 {"aperture", "--fstop", camera->f_number, 1},
                 {given(camera->nominal_length_mm) && !given(camera->focal_length_mm) ? "nominalFocalLength"
                                                                                      : "pinholeFocalLength",
                  "--focal-length",
                  cli_lens_usable(camera->nominal_length_mm) ? cli_lens_header_focal(camera) : camera->focal_length_mm,
                  1}};
    int some = 0;
    for (int i = 0; i < 3; i++) {
        const float value = parts[i].value;
        if (cli_lens_usable(value)) {
            add(has, sizeof(has), "%s %g", parts[i].name, value);
            some |= parts[i].helps;
        } else if (parts[i].helps) {
            if (given(value))
                add(lacks, sizeof(lacks), "%s %g", parts[i].name, value);
            else
                add(lacks, sizeof(lacks), "no %s", parts[i].name);
            add(options, sizeof(options), "%s", parts[i].option);
        }
    }
    if (!some)
        return 0;
    snprintf(
        text, size,
        "the header's lens is incomplete, %s, but %s: blur follows a range and not the lens; for the lens give %s, "
        "else --range",
        has, lacks, options);
    return 1;
}

int cli_lens_remark(const struct cli_args *args, const struct cli_setup *setup, const struct hf_io_camera *camera,
                    char *text, size_t size)
{
    if (setup->model == CLI_MODEL_RANGE && !asks_range(args))
        return tell_gap(args, camera, text, size);
    const char *option = setup->model == CLI_MODEL_RANGE ? hidden_range(args) : NULL;
    if (option && has_lens(args, camera)) {
        snprintf(text, size,
                 "%s is of the range model, so blur follows a range and not the header's lens, f/%g and %g mm; --range "
                 "says how far it grows",
                 option, camera->f_number, cli_lens_header_focal(camera));
        return 1;
    }
    if (setup->model != CLI_MODEL_LENS || given(args->focal_length) || cli_lens_usable(camera->focal_length_mm))
        return 0;
    snprintf(
        text, size,
        "the header has no pinholeFocalLength: its nominalFocalLength, %g mm, is taken; --focal-length replaces it",
        setup->params.lens.focal_length_mm);
    return 1;
}
