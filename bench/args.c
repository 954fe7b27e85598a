// SPDX-License-Identifier: BSD-3-Clause
#include "args.h"

#include "measure.h"
#include "pack.h"
#include "scene.h"

#include <float.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

#define FORMATS "rgba32f|rgb32f|rgba16f|r11g11b10f|planar32f|rgba8|bgra8|rgbx8|bgrx8|rgb10a2|rgba16"

// The commands that take one look of the picture, with all its options.
#define LOOKS "passes|truth|scaling|formats"

// clang-format off
#define FIELD(f) .offset = offsetof(struct bench_args, f)
#define FLAG(f) .parse = tool_parse_flag, FIELD(f)
#define TEXT(f) .parse = tool_parse_text, FIELD(f)
#define NAME(f, of) .parse = tool_parse_name, FIELD(f), .names = HF_NAMES_##of
#define COUNT(f, least, most) .parse = tool_parse_count, FIELD(f), .min = (least), .max = (most)
#define NUMBER(f, least, most) .parse = tool_parse_number, FIELD(f), .min = (least), .max = (most)

static const struct tool_option options[] = {
    {"size", 0, TOOL_FILES, "WxH", "Size of a built-in scene, pixels. Default 1920x1080.", .parse = tool_parse_size,
     FIELD(width), .max = 65536, .commands = "passes|scaling|batch|formats|history|cancel"},
    {"scene", 0, TOOL_FILES, "NAME|FILE", "mixed (default), near, far, both, full, focus, band:PERCENT, or an EXR file.",
     TEXT(scene), .commands = "passes"},
    {"images", 0, TOOL_FILES, "DIR", "Folder of NAME.exr and NAME.truth.exr. Default: images "
     "here, in the source, or where it is installed.", TEXT(images), .commands = "truth|batch|tradeoff|history"},
    {"image", 0, TOOL_FILES, "FILE", "Compare this picture with --truth, in place of the scenes.", TEXT(image), .commands = "truth"},
    {"truth", 0, TOOL_FILES, "FILE", "The reference for --image.", TEXT(truth), .commands = "truth"},
    {"peels", 0, TOOL_FILES, NULL, "Measure an engine, layers unless --engine is given, on all scenes of --images that have second "
     "surfaces, NAME.peel1.exr and perhaps NAME.peel2.exr: with one surface known, with two, and with three.", FLAG(peels), .commands = "truth"},
    {"surfaces", 0, TOOL_FILES, "N", "How many surfaces of each pixel are known, 1 (default) to 3: of FILE those in "
     "FILE.peel1.exr and FILE.peel2.exr, of a built-in scene made ones behind every pixel. Needs --engine layers or scatter.",
     COUNT(surfaces, 1, BENCH_SURFACES), .commands = "passes"},
    {"compression", 0, TOOL_FILES, "none|rle|zips|zip|piz|pxr24|b44|b44a|dwaa|dwab", "Only this one. Default "
     "all.", .parse = tool_parse_choice_text, FIELD(compression), .commands = "batch"},
    {"in", 0, TOOL_FILES, FORMATS, "Format of the colour read. Default r11g11b10f.", NAME(in, FORMAT), .commands = "passes|scaling"},
    {"out", 0, TOOL_FILES, FORMATS, "Format of the colour written. Default r11g11b10f.", NAME(out, FORMAT), .commands = "passes|scaling"},

    {"focus", 0, TOOL_FOCUS, "D", "Focus distance, scene units. Default 20, or the file's.",
     NUMBER(params.focus, 0, FLT_MAX), .above_min = 1, .commands = "passes|scaling|formats"},
    {"range", 0, TOOL_FOCUS, "D", "Distance from focus to full blur, scene units, or inf. Default 10; for a file half "
     "its focus.", NUMBER(params.range.distance, 0, FLT_MAX), .inf = 1, .commands = "passes|scaling|formats"},
    {"max-radius", 0, TOOL_FOCUS, "PX", "Largest blur radius, pixels, 0 to 2048. Default 12; truth: as the lens has "
     "it.", NUMBER(params.max_radius, 0, 2048), .commands = LOOKS},

    {"engine", 0, TOOL_LOOK, "gather|hexagon|scatter|gaussian|layers|chapter", "How to blur. Default gather; passes: chapter; truth, stability and history: all.",
     NAME(params.engine, ENGINE), .commands = "passes|truth|scaling|formats|batch|stability|history"},
    {"blades", 0, TOOL_LOOK, "N", "Sides of the aperture; 0 (default): a disc.", COUNT(params.aperture.blades, 0, 16),
     .commands = LOOKS},

    {"frames", 0, TOOL_RUN, "N", "Frames to measure. Default: as many as take a few seconds.",
     COUNT(frames, 1, 1000000), .commands = "passes|scaling|batch|history"},
    {"threads", 0, TOOL_RUN, "N", "Threads, up to 256; 0 (default): one per processor.", COUNT(threads, 0, 256),
     .commands = "passes|batch|truth|tradeoff|scaling|formats|cancel|history"},
    {"isa", 0, TOOL_RUN, "auto|scalar|sse4.1|avx2|avx512|neon", "Instruction set. Default auto.", NAME(isa, ISA),
     .commands = "passes|truth|tradeoff|scaling|formats|cancel|stability|history"},
    {"simulate", 0, TOOL_RUN, NULL, "Measure the tasks of a frame one by one, and print what frames of 1920x1080 and "
     "3840x2160 are expected to take on 1 to 128 threads, and what limits them. --frames: of each number of threads, 7; --threads: only that number, and 1.", FLAG(simulate), .commands = "scaling"},
    {"bandwidth", 0, TOOL_RUN, "GB/S", "With --simulate: what 64 threads move to and from memory. Default 150.",
     NUMBER(bandwidth, 1, 1e5), .commands = "scaling"},
    {"full", 0, TOOL_RUN, NULL, "Run every case, some minutes.", FLAG(full), .commands = "stability"},
    {"json", 0, TOOL_RUN, "FILE|-", "Write the numbers as JSON; -: to stdout, instead of the table.", TEXT(json)},
    {"add", 0, TOOL_RUN, NULL, "Measure this commit, some minutes, and add a line to the history.",
     FLAG(add), .commands = "history"},
    {"file", 0, TOOL_RUN, "FILE", "The history. Default bench/history/history.jsonl.", TEXT(history), .commands = "history"},
    {"svg", 0, TOOL_RUN, "FILE", "Where it is drawn. Default bench/history/history.svg.", TEXT(svg), .commands = "history"},
    {"quick", 0, TOOL_RUN, NULL, "Fewer settings and rounds, within a minute.", FLAG(quick), .commands = "tradeoff"},
    {"setting", 0, TOOL_RUN, "OPTIONS", "Only the setting that these options make, in quotes.",
     TEXT(setting), .commands = "tradeoff"},
    {"html", 0, TOOL_RUN, "FILE", "Write a page with charts.", TEXT(html), .commands = "tradeoff"},
    {"png", 0, TOOL_RUN, "FILE", "Write the first chart as a picture. Needs rsvg-convert.", TEXT(png), .commands = "tradeoff"},
    {"csv", 0, TOOL_RUN, "FILE", "Write the numbers as CSV.", TEXT(csv), .commands = "tradeoff"},
    {"ladder", 0, TOOL_RUN, "FILE", "Write the library's table of settings.", TEXT(ladder), .commands = "tradeoff"},
    {"readme", 0, TOOL_RUN, "FILE", "Write the conclusions between two marks of this file.",
     TEXT(readme), .commands = "tradeoff"},
    {"cache", 0, TOOL_RUN, "FILE|none", "Where measurements are kept. Default tradeoff.txt in the user's "
     "cache folder.", TEXT(cache), .commands = "tradeoff"},
    {"help", 'h', TOOL_RUN, "[man]", "Print this; --help=man: the man page.", .parse = tool_parse_help},
    {.name = NULL},
};
// clang-format on

static const char *const groups[TOOL_GROUPS] = {
    [TOOL_FILES] = "What to measure on",
    [TOOL_FOCUS] = "Focus and range (scene units)",
    [TOOL_LOOK] = "Look",
    [TOOL_RUN] = "Running",
};

const struct tool_program bench_program = {
    .name = "hyperfocal-bench",
    .subject = "what depth of field costs, and how good it is",
    .usage = "COMMAND [options]",
    .intro = "Measures whole frames on this machine. A value follows its option as the next word or after =.",
    .commands = bench_command_words,
    .groups = groups,
    .sections = (const struct tool_section[]){{options, 0, NULL},
                                              {tool_params_options, offsetof(struct bench_args, params), LOOKS}},
    .section_count = 2,
    .examples = (const char *const[]){"hyperfocal-bench passes --scene both", "hyperfocal-bench truth --json -",
                                      "hyperfocal-bench truth --image dof.exr --truth traced.exr",
                                      "hyperfocal-bench history --add", NULL},
    .outro = "Exit codes: 0 done, 1 not.",
};

void bench_args_default(struct bench_args *args)
{
    *args = (struct bench_args){
        .width = 1920,
        .height = 1080,
        .scene = "mixed",
        .in = HF_FORMAT_R11G11B10F,
        .out = HF_FORMAT_R11G11B10F,
        .params = hf_default_params(),
        .bandwidth = 150,
        .surfaces = 1,
    };
    args->params.focus = 20;
    args->params.range.distance = 10;
    args->params.max_radius = 12;
}

// Find the truth scenes: in the caller's folder, in the source tree of this build, or where they are installed.
static void find_images(struct bench_args *args)
{
    static const char *const places[] = {"../../images", "../share/hyperfocal/images"};
    char self[2048], probe[sizeof(args->found) + 32];
    const ssize_t n = readlink("/proc/self/exe", self, sizeof(self) - 1);
    args->images = "images";
    if (!access("images/lights.truth.exr", R_OK) || n <= 0)
        return;
    self[n] = '\0';
    *strrchr(self, '/') = '\0';
    for (size_t i = 0; i < sizeof(places) / sizeof(places[0]); i++) {
        snprintf(args->found, sizeof(args->found), "%.2000s/%s", self, places[i]);
        snprintf(probe, sizeof(probe), "%.4000s/lights.truth.exr", args->found);
        if (!access(probe, R_OK)) {
            args->images = args->found;
            return;
        }
    }
}

int bench_args_parse(struct bench_args *args, const char *command, int count, char **words, struct tool_error *error)
{
    struct tool_parser p = {.program = &bench_program, .command = command, .args = args, .error = error};
    if (tool_parse_line(&p, count, words))
        return -1;
    args->help = p.help;
    if (p.help)
        return 0;
    // Commands that measure one engine refuse options that it does not have; the others accept all engines' options.
    const int one =
        !command || !strcmp(command, "passes") || !strcmp(command, "scaling") || !strcmp(command, "formats");
    if (command && !strcmp(command, "passes") && !tool_given(&p, "engine"))
        args->params.engine = HF_ENGINE_CHAPTER;
    tool_choose_chapter(&p, &args->params);
    const struct tool_option *misfit = one ? tool_misfit(&p, args->params.engine) : NULL;
    char engines[256];
    if (misfit)
        return tool_fail(error, -1, "--%s is of use only with --engine %s, not %s", misfit->name,
                         tool_and(misfit->engines, engines), hf_engine_name(args->params.engine));
    if (args->surfaces > 1 && args->params.engine != HF_ENGINE_LAYERS && args->params.engine != HF_ENGINE_SCATTER)
        return tool_fail(error, -1, "--surfaces %d is of use only with --engine layers and scatter, not %s",
                         args->surfaces, hf_engine_name(args->params.engine));
    if (!args->images)
        find_images(args);
    args->words = words;
    args->word_count = count;
    args->engine_given = tool_given(&p, "engine");
    args->size_given = tool_given(&p, "size");
    args->focus_given = tool_given(&p, "focus");
    args->range_given = tool_given(&p, "range");
    args->max_radius_given = tool_given(&p, "max-radius");
    if (!hf_isa_available(args->isa))
        return tool_fail(error, -1, "--isa %s is not available on this CPU and in this build", hf_isa_name(args->isa));
    if (args->size_given && !bench_scene_builtin(args->scene, NULL))
        return tool_fail(error, -1, "--size is for built-in scenes, but '%s' is not one", args->scene);
    return 0;
}
