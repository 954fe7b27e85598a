// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/args.h"

#include "tools/cli/choose.h"
#include "tools/cli/depth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int cli_is_exr(const char *path)
{
    const size_t n = strlen(path);
    return n >= 4 && !strcasecmp(path + n - 4, ".exr");
}

static void set_defaults(struct cli_args *args)
{
    *args = (struct cli_args){
        .params = hf_default_params(), .focus_smooth = -1, .engine = -1, .quality = -1, .max_error = NAN};
    float *const unset[] = {&args->focus,        &args->range,        &args->strength,       &args->near_begin,
                            &args->near_end,     &args->far_begin,    &args->far_end,        &args->fstop,
                            &args->focal_length, &args->sensor_width, &args->world_unit,     &args->near_plane,
                            &args->far_plane,    &args->memory_limit, &args->depth_of_field, &args->depth_scale,
                            &args->depth_offset, &args->blur};
    for (size_t i = 0; i < sizeof(unset) / sizeof(unset[0]); i++)
        *unset[i] = NAN;
}

// Does an option change the pixels of a frame? Then the stamp in the OUTPUT's header lists it. Names of files and
// values that differ from frame to frame are not listed here; resume.c adds them.
static int makes_picture(const struct tool_option *o)
{
    static const char *const others[] = {"views",       "layer",         "merge",     "grow",   "display",
                                         "compression", "deterministic", "budget-ms", "guessed"};
    static const char *const per_frame[] = {"depth-file", "keys", "keys-blend", "focus-smooth", "print-focus"};
    for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
        if (!strcmp(o->name, others[i]))
            return 1;
    for (size_t i = 0; i < sizeof(per_frame) / sizeof(per_frame[0]); i++)
        if (!strcmp(o->name, per_frame[i]))
            return 0;
    return o->group == TOOL_FOCUS || o->group == TOOL_LENS || o->group == TOOL_DEPTH || o->group == TOOL_LOOK;
}

// Append the option to args->settings if it changes the picture. Remember the word after --json, which may turn out to
// be INPUT.
static int on_option(struct tool_parser *p, const struct tool_option *o, const char *value, int apart)
{
    struct cli_args *args = p->args;
    char *settings;
    if (!strcmp(o->name, "json"))
        args->json_word = apart ? value : NULL;
    if (!makes_picture(o))
        return 0;
    if (asprintf(&settings, "%s%s--%s%s%s", args->settings ? args->settings : "", args->settings ? " " : "", o->name,
                 value ? " " : "", value ? value : "") < 0)
        return tool_fail(p->error, -1, "out of memory");
    free(args->settings);
    args->settings = settings;
    return 0;
}

static int on_word(struct tool_parser *p, const char *word)
{
    struct cli_args *args = p->args;
    if (word[0] == '\0')
        return tool_fail(p->error, -1, "INPUT: '' is empty, it must be a file name");
    args->inputs[args->input_count++] = word;
    args->input = args->inputs[0];
    return 0;
}

void cli_free_args(struct cli_args *args)
{
    free(args->settings);
    free(args->inputs);
    free(args->others);
    free(args->layers);
    args->settings = args->layers = NULL;
    args->inputs = args->others = NULL;
}

static int given(float number)
{
    return !isnan(number);
}

// Name of an option that selects the range model, or NULL.
static const char *range_option(const struct cli_args *args)
{
    return given(args->range)            ? "range"
           : given(args->depth_of_field) ? "depth-of-field"
           : given(args->near_begin)     ? "near-begin"
           : given(args->near_end)       ? "near-end"
           : given(args->far_begin)      ? "far-begin"
           : given(args->far_end)        ? "far-end"
           : given(args->strength)       ? "strength"
                                         : NULL;
}

int cli_focus_needs_depth(const struct cli_args *args)
{
    const int radii = args->depth_type == HF_DEPTH_COC;  // with --blur the focus is in them
    return !radii &&
           (args->focus_by == CLI_FOCUS_AT || args->focus_by == CLI_FOCUS_CENTER || args->focus_by == CLI_FOCUS_OBJECT);
}

int cli_check_planes(const struct cli_args *args, enum hf_engine engine, struct tool_error *error)
{
    const enum hf_depth_type type = args->depth_type;
    const int from_planes = type == HF_DEPTH_NDC_D3D || type == HF_DEPTH_NDC_GL || type == HF_DEPTH_NDC_REVERSED ||
                            type == HF_DEPTH_INVERSE || args->normalized;
    // The gaussian engine measures depth by the planes, whatever its type.
    if (from_planes || (engine == HF_ENGINE_GAUSSIAN && type != HF_DEPTH_COC) ||
        (!given(args->near_plane) && !given(args->far_plane)))
        return 0;
    return tool_fail(error, CLI_BAD_ARGUMENTS,
                     "--%s is of use only with --depth-type ndc-d3d, ndc-gl, ndc-reversed, inverse and "
                     "normalized, not %s",
                     given(args->near_plane) ? "near" : "far", cli_depth_type_name(args));
}

static int check_depth(const struct cli_args *args, struct tool_error *error)
{
    const int ndc = args->depth_type == HF_DEPTH_NDC_D3D || args->depth_type == HF_DEPTH_NDC_GL ||
                    args->depth_type == HF_DEPTH_NDC_REVERSED;
    const int inverse = args->depth_type == HF_DEPTH_INVERSE;
    const char *type = cli_depth_type_name(args);
    const int both = given(args->near_plane) && given(args->far_plane);
    if (((ndc || args->normalized) && !both) || (inverse && given(args->far_plane) && !both))
        return tool_fail(error, -1, "--depth-type %s needs --%s", type, given(args->near_plane) ? "far" : "near");
    if (args->normalized && isinf(args->far_plane))
        return tool_fail(error, -1, "--depth-type %s needs a --far that is not inf; inverse may have it", type);
    if (args->near_plane >= args->far_plane)
        return tool_fail(error, -1, "--near %g must be less than --far %g%s", args->near_plane, args->far_plane,
                         args->normalized ? "; for a map that is white where it is near take normalized-inverted" : "");
    // The engine that --quality chooses differs from picture to picture; setup.c checks it.
    if (args->quality < 0 && !given(args->max_error) && cli_check_planes(args, args->params.engine, error))
        return -1;
    if (args->depth_scale == 0)
        return tool_fail(error, -1, "--depth-scale: '0' is out of range, it must not be 0");
    if (args->depth_type == HF_DEPTH_COC && !given(args->blur) &&
        (args->focus_at_given || args->focus_by == CLI_FOCUS_CENTER))
        return tool_fail(error, -1, "--focus%s cannot be used with --depth-type coc, which has no distances",
                         args->focus_at_given ? "-at" : " center");
    return 0;
}

static int check_model(const struct cli_args *args, struct tool_error *error)
{
    const char *range = range_option(args);
    const char *lens = given(args->fstop) ? "fstop" : given(args->focal_length) ? "focal-length" : NULL;
    if (args->depth_type == HF_DEPTH_COC && (range || lens))
        return tool_fail(error, -1, "--%s cannot be used with %s", range ? range : lens,
                         given(args->blur) ? "--blur, which says how much blur there is"
                                           : "--depth-type coc, which holds the blur already");
    if (range && lens)
        return tool_fail(error, -1,
                         "--%s and --%s cannot be given together: one chooses the range model, the other "
                         "the lens",
                         range, lens);
    if (args->near_begin > args->near_end)
        return tool_fail(error, -1, "--near-begin %g must not be more than --near-end %g", args->near_begin,
                         args->near_end);
    if (args->far_begin > args->far_end)
        return tool_fail(error, -1, "--far-begin %g must not be more than --far-end %g", args->far_begin,
                         args->far_end);
    if (args->near_end > args->far_begin)
        return tool_fail(error, -1,
                         "--near-end %g must not be more than --far-begin %g: what lies between would be near and far "
                         "at once",
                         args->near_end, args->far_begin);
    return check_depth(args, error);
}

// Refuse options that the engine does not have; none is ignored silently.
static int check_engine(const struct cli_args *args, const struct tool_parser *parser, struct tool_error *error)
{
    const struct hf_params *p = &args->params;
    const int fields = p->engine == HF_ENGINE_GATHER || p->engine == HF_ENGINE_CHAPTER;
    const int hexagon = p->engine == HF_ENGINE_HEXAGON;
    const int gaussian = p->engine == HF_ENGINE_GAUSSIAN;
    const struct tool_option *misfit = tool_misfit(parser, p->engine);
    char engines[256];
    if (misfit)
        return tool_fail(error, -1, "--%s is of use only with --engine %s, not %s", misfit->name,
                         tool_and(misfit->engines, engines), hf_engine_name(p->engine));
    if (p->hexagon.resolution == HF_RESOLUTION_QUARTER && tool_given(parser, "resolution") && !gaussian)
        return tool_fail(error, -1, "--resolution quarter is of use only with --engine gaussian, not %s",
                         hf_engine_name(p->engine));
    if (tool_given(parser, "highlight-threshold") && !tool_given(parser, "highlight-gain"))
        return tool_fail(error, -1, "--highlight-threshold is of use only with --highlight-gain");
    if (args->aperture_file && p->aperture.cat_eye > 0)
        return tool_fail(error, -1, "--cat-eye cannot be used with --aperture %s: a picture is the whole shape",
                         args->aperture_file);
    const int plain = !args->aperture_file && p->aperture.ring == 0 && p->aperture.roundness == 0;
    if (args->aperture && fields && !plain)
        return tool_fail(error, -1,
                         "--aperture: '%s' is not an aperture of the %s engine, which takes disc or "
                         "ngon:N[:0[:DEGREES]]",
                         args->aperture, hf_engine_name(p->engine));
    if (args->aperture && hexagon && (!plain || (p->aperture.blades != 6)))
        return tool_fail(error, -1,
                         "--aperture: '%s' is not an aperture of the hexagon engine, which takes "
                         "ngon:6[:0[:DEGREES]]",
                         args->aperture);
    if (args->aperture && gaussian)
        return tool_fail(error, -1,
                         "--aperture %s is of use only with --engine gather, chapter, hexagon, scatter and layers",
                         args->aperture);
    return 0;
}

int cli_others_peel(const struct cli_args *args)
{
    return args->other_option && !strcmp(args->other_option, "--peel");
}

// Check options that make several pictures one scene.
static int check_others(const struct cli_args *args, const struct tool_parser *parser, struct tool_error *error)
{
    enum { MOST_OVER = 63, MOST_PEELS = 2 };  // of hf_render_layers, beside INPUT
    // Those that say how one picture becomes what is blurred.
    static const char *const alone[] = {"depth-file", "blur", "grow", "highlight-gain"};
    const char *option = args->merge ? "--merge" : args->other_option;
    const int peels = cli_others_peel(args);
    if (!option)
        return 0;
    for (size_t i = 0; i < sizeof(alone) / sizeof(alone[0]); i++)
        if (tool_given(parser, alone[i]))
            return tool_fail(error, -1, "--%s cannot be used with %s: it is for one picture alone", alone[i], option);
    if (args->merge && tool_given(parser, "depth-channel"))
        return tool_fail(error, -1, "--depth-channel %s cannot be used with --merge: each layer has its own depth",
                         args->depth_channel);
    if (args->merge && (!args->layer || (!strchr(args->layer, ',') && strcmp(args->layer, "all"))))
        return tool_fail(error, -1, "--merge needs several layers, name them with --layer");
    if (args->merge && peels)
        return tool_fail(error, -1, "--merge and --peel cannot be given together: peels are what one picture hides");
    if (peels && args->other_count > MOST_PEELS)
        return tool_fail(error, -1, "--peel is given %d times; a picture and %d surfaces behind it are used at most",
                         args->other_count, MOST_PEELS);
    if (args->other_count > MOST_OVER)
        return tool_fail(error, -1, "--over is given %d times; %d is the most", args->other_count, MOST_OVER);
    return 0;
}

static int check_files(const struct cli_args *args, const struct tool_parser *parser, struct tool_error *error)
{
    if (!args->input)
        return tool_fail(error, -1, "there is no INPUT, see hyperfocal --help");
    if (!args->output && !args->dry_run && !args->print_focus && args->input_count == 2)
        return tool_fail(error, -1, "there is no OUTPUT for %s; if it is %s, write -o before it", args->input,
                         args->inputs[1]);
    if (!args->output && !args->dry_run && !args->print_focus)
        return tool_fail(error, -1, "there is no OUTPUT for %s, name it with -o", args->input);
    if (args->output && args->compression && !cli_is_exr(args->output))
        return tool_fail(error, -1, "--compression %s is for EXR, but OUTPUT is %s", args->compression, args->output);
    if (args->output && args->zip_level && !cli_is_exr(args->output))
        return tool_fail(error, -1, "--zip-level %d is for EXR, but OUTPUT is %s", args->zip_level, args->output);
    if (args->guessed && tool_given(parser, "highlight-gain"))
        return tool_fail(error, -1, "--guessed and --highlight-gain cannot be given together");
    if (args->guessed_image && !cli_is_exr(args->guessed_image))
        return tool_fail(error, -1, "--guessed-image %s: its name must end in .exr", args->guessed_image);
    if (args->zip_level && args->compression && strncmp(args->compression, "zip", 3))
        return tool_fail(error, -1, "--zip-level %d is for ZIP, but --compression is %s", args->zip_level,
                         args->compression);
    if (!args->json_file)
        return 0;
    // A user may forget that the word after --json is its FILE. That must not overwrite a picture.
    if (cli_is_exr(args->json_file) || !strcmp(args->json_file, args->input) ||
        (args->output && !strcmp(args->json_file, args->output)))
        return tool_fail(error, -1, "--json would write over the picture %s", args->json_file);
    return 0;
}

// --blur makes radii of any depth, so from here on the depth is radii, coc.
static int take_blur(struct cli_args *args, const struct tool_parser *parser, struct tool_error *error)
{
    static const char *const useless[] = {"near",           "far",         "keys",        "focus-smooth",
                                          "focus-per-view", "depth-scale", "depth-offset"};
    if (!given(args->blur))
        return 0;
    if (args->focus_by != CLI_FOCUS_AT && args->focus_by != CLI_FOCUS_CENTER)
        return tool_fail(error, -1, "--blur %g needs --focus-at or --focus center: where to focus", args->blur);
    if (args->depth_type == HF_DEPTH_COC)
        return tool_fail(error, -1, "--blur cannot be used with --depth-type coc, which holds the blur already");
    for (size_t i = 0; i < sizeof(useless) / sizeof(useless[0]); i++)
        if (tool_given(parser, useless[i]))
            return tool_fail(error, -1, "--%s is of no use with --blur, which asks for no distances", useless[i]);
    args->blur_typed = tool_given(parser, "depth-type");
    args->blur_type = args->depth_type;
    args->blur_normalized = args->normalized;
    args->depth_type = HF_DEPTH_COC;
    args->normalized = 0;
    return 0;
}

// Each option says where to focus, so there may be one.
static int check_focus(const struct cli_args *args, const struct tool_parser *parser, struct tool_error *error)
{
    static const char *const options[] = {"focus", "focus-at", "focus-object", "focus-point"};
    const char *first = NULL;
    for (size_t i = 0; i < sizeof(options) / sizeof(options[0]); i++) {
        if (!tool_given(parser, options[i]))
            continue;
        if (first)
            return tool_fail(error, -1, "--%s and --%s cannot be given together", first, options[i]);
        first = options[i];
    }
    if (args->depth_type == HF_DEPTH_COC && (args->focus_by == CLI_FOCUS_OBJECT || args->focus_by == CLI_FOCUS_POINT))
        return tool_fail(error, -1, "--%s cannot be used with --depth-type coc, which has no distances", first);
    return 0;
}

// Resolve and check combinations of options. Their order on the command line does not matter.
static int combine(struct cli_args *args, const struct tool_parser *parser, struct tool_error *error)
{
    struct hf_params *p = &args->params;
    if (args->engine >= 0)
        p->engine = (enum hf_engine)args->engine;
    else
        p->engine = HF_ENGINE_LAYERS;
    args->chose_chapter = tool_choose_chapter(parser, p);
    if (args->guessed_image && !args->guessed)
        args->guessed = CLI_GUESSED_IMAGE;
    if (check_focus(args, parser, error) || cli_choose_check(args, parser, error) || take_blur(args, parser, error))
        return -1;
    if (tool_given(parser, "keys-blend") && !args->keys)
        return tool_fail(error, -1, "--keys-blend is of use only with --keys");
    if (args->focus_smooth >= 0 && !args->keys && !cli_focus_needs_depth(args))
        return tool_fail(error, -1,
                         "--focus-smooth is of use only with a focus that is read from the pictures: --focus center, "
                         "--focus-at, --focus-object or keys for it");
    if (args->focus_smooth > 0 && args->focus_per_view)
        return tool_fail(
            error, -1,
            "--focus-smooth and --focus-per-view cannot be given together: a focus that follows is that of "
            "the first view, and all share it");
    if (args->verbose && args->quiet)
        return tool_fail(error, -1, "--verbose and --quiet cannot be given together");
    return 0;
}

int cli_parse_args(struct cli_args *args, int argc, char **argv, struct tool_error *error)
{
    struct tool_parser p = {.program = &cli_program, .args = args, .error = error, .word = on_word, .seen = on_option};
    set_defaults(args);
    args->inputs = calloc((size_t)argc + 1, sizeof(*args->inputs));
    args->others = calloc((size_t)argc + 1, sizeof(*args->others));
    if (!args->inputs || !args->others)
        return tool_fail(error, -1, "out of memory");
    if (tool_parse_line(&p, argc - 1, argv + 1))
        return -1;
    args->help = p.help;
    if (p.help || p.stop)
        return 0;
    for (int i = 0; i < TOOL_MOST_OPTIONS; i++)
        args->metric |= p.state[i].metric;
    if (given(args->world_unit))
        tool_scale_metric(&p, args->world_unit);
    if (combine(args, &p, error))
        return -1;
    if (!args->input && args->json_word) {
        args->json_file = NULL;
        if (on_word(&p, args->json_word))
            return -1;
    }
    if (args->views && !strcmp(args->views, "all"))
        args->views = NULL;
    if (check_files(args, &p, error) || check_engine(args, &p, error) || check_model(args, error) ||
        check_others(args, &p, error))
        return -1;
    return 0;
}
