// SPDX-License-Identifier: BSD-3-Clause
#include "args.h"

#include "pack.h"
#include "scene.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum kind { FLAG, COUNT, NUMBER, CHOICE, TEXT, SIZE };

struct option {
    const char *name;         // with its dashes
    const char *placeholder;  // of the value; NULL: takes none. Of a choice the very list of words, "a|b", in the
                              // order of the enum
    const char *help;
    enum kind kind;
    size_t offset;        // in struct bench_args, of what the option sets
    double min, max;      // of a number, inclusive
    int above_min;        // ... but min itself is excluded
    int inf;              // inf is accepted
    enum hf_names names;  // of a choice
    size_t given;         // offset of a flag that says that the option was there; 0: none
};

_Static_assert(sizeof(enum hf_isa) == sizeof(int), "choices are stored as int");

#define FORMATS "rgba32f|rgb32f|rgba16f|r11g11b10f|planar32f|rgba8|bgra8|rgbx8|bgrx8|rgb10a2|rgba16"
#define AT(field) .offset = offsetof(struct bench_args, field)
#define GIVEN(field) .given = offsetof(struct bench_args, field)

static const struct option options[] = {
    {"--size", "WxH", "size of a built-in scene, pixels (1920x1080)", SIZE, AT(width), GIVEN(size_given)},
    {"--scene", "NAME|FILE", "mixed, near, far, both, focus, band:PERCENT, or an EXR file (mixed)", TEXT, AT(scene)},
    {"--images", "DIR", "truth, batch: folder of NAME.exr and NAME.truth.exr (images)", TEXT, AT(images)},
    {"--compression", "NAME", "batch: only this one of none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa, dwab (all)",
     TEXT, AT(compression)},
    {"--frames", "N", "frames to measure (as many as take a few seconds)", COUNT, AT(frames), .min = 1, .max = 1000000},
    {"--threads", "N", "threads, up to 256; 0: one per processor (0)", COUNT, AT(threads), .max = 256},
    {"--isa", "auto|scalar|sse4.1|avx2|avx512|neon", "instruction set (auto)", CHOICE, AT(isa), .names = HF_NAMES_ISA},
    {"--engine", "gather|hexagon|scatter|gaussian|layers", "engine (gather; stability: all)", CHOICE, AT(params.engine),
     .names = HF_NAMES_ENGINE, GIVEN(engine_given)},
    {"--rings", "N", "gather: rings of taps (as many as lie two half-resolution pixels apart)", COUNT,
     AT(params.gather.rings), .min = 1, .max = 64},
    {"--blend", "linear|smoothstep", "how blur grows (linear)", CHOICE, AT(params.range.blend),
     .names = HF_NAMES_BLEND},
    {"--resolution", "full|half|quarter", "working buffers of the engines other than gather (full)", CHOICE,
     AT(resolution), .names = HF_NAMES_RESOLUTION},
    {"--uniform", NULL, "hexagon: the same radius everywhere", FLAG, AT(params.hexagon.uniform)},
    {"--blades", "N", "sides of the aperture; 0: a disc (0)", COUNT, AT(params.aperture.blades), .max = 16},
    {"--iterations", "N", "gaussian: passes of its 5-tap blur (3)", COUNT, AT(params.gaussian.iterations), .max = 64},
    {"--sigma", "PX", "gaussian: one blur of this standard deviation instead (none)", NUMBER, AT(params.gaussian.sigma),
     .max = 256},
    {"--storage", "float|half|packed", "buffers between passes (float)", CHOICE, AT(params.gather.storage),
     .names = HF_NAMES_STORAGE},
    {"--in", FORMATS, "format of the colour read (r11g11b10f)", CHOICE, AT(in), .names = HF_NAMES_FORMAT},
    {"--out", FORMATS, "format of the colour written (r11g11b10f)", CHOICE, AT(out), .names = HF_NAMES_FORMAT},
    {"--focus", "D", "focus distance, scene units (20, or the file's)", NUMBER, AT(params.focus), .above_min = 1,
     .max = 3e38, GIVEN(focus_given)},
    {"--range", "D", "distance from focus to full blur, scene units, or inf (10; for a file half its focus)", NUMBER,
     AT(params.range.distance), .max = 3e38, .inf = 1, GIVEN(range_given)},
    {"--max-radius", "PX", "largest blur radius, pixels, up to 2048 (12)", NUMBER, AT(params.max_radius), .max = 2048,
     GIVEN(max_radius_given)},
    {"--fill", "max|mean|none", "how gaps between taps are closed (max)", CHOICE, AT(params.gather.fill),
     .names = HF_NAMES_FILL},
    {"--faithful", NULL, "the published demo, its flaws included", FLAG, AT(faithful)},
    {"--deterministic", NULL, "same bits on every instruction set", FLAG, AT(params.run.deterministic)},
    {"--no-skip", NULL, "every pass on every tile", FLAG, AT(params.run.no_skip)},
    {"--karis", NULL, "weights against fireflies", FLAG, AT(params.gather.karis)},
    {"--bicubic", NULL, "near field upsampled with a B-spline", FLAG, AT(params.gather.bicubic)},
    {"--per-pixel-kernel", NULL, "far kernel scaled by each pixel's blur", FLAG, AT(params.gather.per_pixel_kernel)},
    {"--full", NULL, "stability: every case there is, some minutes", FLAG, AT(full)},
    {"--json", "FILE|-", "write the numbers as JSON; -: to stdout, instead of the table", TEXT, AT(json)},
    {"--quick", NULL, "tradeoff: fewer settings and rounds, within a minute", FLAG, AT(quick)},
    {"--setting", "OPTIONS", "tradeoff: only the setting that these options make, in quotes", TEXT, AT(setting)},
    {"--html", "FILE", "tradeoff: write a page with charts", TEXT, AT(html)},
    {"--png", "FILE", "tradeoff: write the first chart as a picture", TEXT, AT(png)},
    {"--csv", "FILE", "tradeoff: write the numbers as CSV", TEXT, AT(csv)},
    {"--ladder", "FILE", "tradeoff: write the library's table of settings", TEXT, AT(ladder)},
    {"--cache", "FILE|none", "tradeoff: where measurements are kept (tradeoff.txt in the user's cache folder)", TEXT,
     AT(cache)},
    {"--help", NULL, "print this (-h)", FLAG, AT(help)},
};
enum { OPTIONS = sizeof options / sizeof *options };

void bench_args_default(struct bench_args *args)
{
    *args = (struct bench_args){
        .width = 1920,
        .height = 1080,
        .scene = "mixed",
        .images = "images",
        .in = HF_FORMAT_R11G11B10F,
        .out = HF_FORMAT_R11G11B10F,
        .params = hf_default_params,
    };
    args->params.focus = 20;
    args->params.range.distance = 10;
    args->params.max_radius = 12;
}

// Integer or not, the text must be a number from start to end.
static int parse_number(const struct option *o, const char *text, double *out)
{
    if (o->inf && !strcmp(text, "inf")) {
        *out = INFINITY;
        return 0;
    }
    if (!*text || strspn(text, "+-.0123456789eE") != strlen(text))
        return -1;
    char *end;
    const double x = strtod(text, &end);
    if (end == text || *end || !(x >= o->min && x <= o->max) || (o->above_min && x == o->min) ||
        (o->kind == COUNT && x != floor(x)))
        return -1;
    *out = x;
    return 0;
}

static int parse_size(const char *text, int size[2])
{
    for (int i = 0; i < 2; i++) {
        char *end;
        errno = 0;
        const long n = strtol(text, &end, 10);
        if (*text < '0' || *text > '9' || errno || n < 1 || n > 65536 || *end != (i ? '\0' : 'x'))
            return -1;
        size[i] = (int)n;
        text = end + 1;
    }
    return 0;
}

static int bad_value(const struct option *o, const char *value, struct bench_error *error)
{
    if (o->kind == CHOICE)
        return bench_fail(error, "%s must be one of %s, not '%s'", o->name, o->placeholder, value);
    if (o->kind == SIZE)
        return bench_fail(error, "%s must be WIDTHxHEIGHT, each 1 to 65536, not '%s'", o->name, value);
    return bench_fail(error, "%s must be a%s number %s %g and at most %g%s, not '%s'", o->name,
                      o->kind == COUNT ? " whole" : "", o->above_min ? "greater than" : "of at least", o->min, o->max,
                      o->inf ? ", or inf" : "", value);
}

static int set_option(struct bench_args *args, const struct option *o, const char *value, struct bench_error *error)
{
    void *target = (char *)args + o->offset;
    double number;
    switch (o->kind) {
    case FLAG:
        *(int *)target = 1;
        break;
    case TEXT:
        if (!*value)
            return bench_fail(error, "%s needs a value (%s)", o->name, o->placeholder);
        *(const char **)target = value;
        break;
    case SIZE:
        if (parse_size(value, target))
            return bad_value(o, value, error);
        break;
    case CHOICE:
        if (hf_value(o->names, value, target))
            return bad_value(o, value, error);
        break;
    case COUNT:
    case NUMBER:
        if (parse_number(o, value, &number))
            return bad_value(o, value, error);
        if (o->kind == COUNT)
            *(int *)target = (int)number;
        else
            *(float *)target = (float)number;
        break;
    }
    if (o->given)
        *(int *)((char *)args + o->given) = 1;
    return 0;
}

// The option that a word names, "--name" or "--name=value".
static const struct option *find_option(const char *word)
{
    const size_t n = strcspn(word, "=");
    if (!strcmp(word, "-h"))
        word = "--help";
    for (int i = 0; i < OPTIONS; i++)
        if (!strcmp(word, options[i].name) || (!strncmp(word, options[i].name, n) && !options[i].name[n]))
            return &options[i];
    return NULL;
}

int bench_args_parse(struct bench_args *args, int count, char **words, struct bench_error *error)
{
    for (int i = 0; i < count; i++) {
        const struct option *o = find_option(words[i]);
        if (!o)
            return bench_fail(error, "there is no option '%s'; see hyperfocal-bench --help", words[i]);
        const char *equals = strchr(words[i], '=');
        const char *value = NULL;
        if (o->placeholder) {
            value = equals ? equals + 1 : i + 1 < count ? words[++i] : NULL;
            if (!value)
                return bench_fail(error, "%s needs a value (%s)", o->name, o->placeholder);
        } else if (equals) {
            return bench_fail(error, "%s takes no value", o->name);
        }
        if (set_option(args, o, value, error))
            return -1;
        if (args->help)
            return 0;
    }
    struct hf_params *p = &args->params;
    p->hexagon.resolution = p->scatter.resolution = p->gaussian.resolution = args->resolution;
    p->gather.faithful = p->gaussian.faithful = args->faithful;
    if (!hf_isa_available(args->isa))
        return bench_fail(error, "--isa %s is not available on this CPU and in this build", hf_isa_name(args->isa));
    if (args->size_given && !bench_scene_builtin(args->scene, NULL))
        return bench_fail(error, "--size is for built-in scenes, but '%s' is none", args->scene);
    return 0;
}

void bench_args_help(FILE *out)
{
    for (int i = 0; i < OPTIONS; i++) {
        const struct option *o = &options[i];
        const int used = fprintf(out, "  %s %s", o->name, o->placeholder ? o->placeholder : "");
        if (used > 27)
            fprintf(out, "\n%*s%s\n", 28, "", o->help);
        else
            fprintf(out, "%*s%s\n", 28 - used, "", o->help);
    }
}
