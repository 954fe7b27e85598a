// SPDX-License-Identifier: BSD-3-Clause
// Options that set the library's parameters directly, for both programs. An engine's option belongs here.
#include "tools/common/options.h"

#include <stddef.h>

// A choice is stored as an int.
_Static_assert(sizeof(enum hf_isa) == sizeof(int) && sizeof(enum hf_engine) == sizeof(int), "size of an enum");

// The struct that contains the option's value.
static struct hf_params *params_of(const struct tool_parser *p, const struct tool_option *option)
{
    return (struct hf_params *)((char *)tool_field(p, option) - option->offset);
}

// Sets the resolution of every engine, because the engine is not known yet.
static int parse_resolution(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct hf_params *params = params_of(p, option);
    if (tool_parse_name(p, option, value))
        return -1;
    params->scatter.resolution = params->gaussian.resolution = params->hexagon.resolution;
    return 0;
}

static int parse_faithful(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct hf_params *params = params_of(p, option);
    (void)value;
    params->gather.faithful = params->gaussian.faithful = 1;
    return 0;
}

// clang-format off
#define FIELD(f) .offset = offsetof(struct hf_params, f), .field = #f
#define FLAG(f) .parse = tool_parse_flag, FIELD(f)
#define NAME(f, of) .parse = tool_parse_name, FIELD(f), .names = HF_NAMES_##of
#define COUNT(f, least, most) .parse = tool_parse_count, FIELD(f), .min = (least), .max = (most)
#define NUMBER(f, least, most) .parse = tool_parse_number, FIELD(f), .min = (least), .max = (most)

const struct tool_option tool_params_options[] = {
    {"chromatic", 0, TOOL_LOOK, "S", "Red highlights larger by this fraction and blue ones smaller behind the "
     "focus, the other way before it, -0.5 to 0.5. Default 0.", NUMBER(aperture.chromatic, -0.5, 0.5),
     .engines = "layers|scatter"},
    {"cat-eye", 0, TOOL_LOOK, "S", "Cut highlights towards the corners, 0 (default) to 1.",
     NUMBER(aperture.cat_eye, 0, 1),
     .engines = "layers|scatter"},
    {"squeeze", 0, TOOL_LOOK, "S", "Height over width of a highlight, 0.25 to 4. Default 1.",
     NUMBER(aperture.squeeze, 0.25, 4),
     .engines = "layers|scatter"},
    {"highlight-gain", 0, TOOL_LOOK, "G", "Give clipped highlights light back while they are blurred, so that lamps leave "
     "bright discs: what is 1 counts as G, 1 (none, default) to 64, and what the blur leaves alone stays. 8 are three stops.",
     NUMBER(highlight.gain, 1, 64)},
    {"highlight-threshold", 0, TOOL_LOOK, "V", "Linear luminance (Rec. 709) above which --highlight-gain sets in, 0 to 0.99: "
     "not saturated paint. Default 0.9, a grey of 243 of 255 in sRGB.", NUMBER(highlight.threshold, 0, 0.99)},
    {"uniform", 0, TOOL_LOOK, NULL, "The same blur everywhere, --max-radius.", FLAG(hexagon.uniform),
     .engines = "hexagon"},
    {"iterations", 0, TOOL_LOOK, "N", "Passes of the 5-tap blur, 0 to 64. Default 3.",
     COUNT(gaussian.iterations, 0, 64),
     .engines = "gaussian"},
    {"sigma", 0, TOOL_LOOK, "PX", "One blur of this standard deviation, pixels, in place of --iterations, 0 "
     "to 256. Default: iterations.", NUMBER(gaussian.sigma, 0, 256),
     .engines = "gaussian"},
    {"resolution", 0, TOOL_LOOK, "full|half|quarter", "Size of the working buffers, quarter "
     "only for gaussian. Default full.", .parse = parse_resolution,
     .offset = offsetof(struct hf_params, hexagon.resolution),
     .field = "hexagon.resolution|scatter.resolution|gaussian.resolution", .names = HF_NAMES_RESOLUTION,
     .engines = "hexagon|scatter|gaussian"},
    {"fill", 0, TOOL_LOOK, "max|mean|none|open", "How gaps between taps are closed: mean over the aperture's area "
     "(default), 3x3 maximum (with --faithful), by three times as many taps, or not at all.", NAME(gather.fill, FILL),
     .engines = "gather"},
    {"blend", 0, TOOL_LOOK, "linear|smoothstep", "How blur grows from sharp to full. Default linear.",
     NAME(range.blend, BLEND)},
    {"rings", 0, TOOL_LOOK, "N", "Rings of taps, 1 to 64. Default: as many as lie two half-resolution pixels "
     "apart. Fewer are faster.", COUNT(gather.rings, 1, 64),
     .engines = "gather"},
    {"downsample", 0, TOOL_LOOK, "bilateral|linear|point", "How four pixels become one of half resolution: "
     "far ones by how alike their blur is (default), their mean, or the first of them.", NAME(gather.downsample, DOWNSAMPLE),
     .engines = "gather"},
    {"division", 0, TOOL_LOOK, "exact|estimate|newton|newton2", "By sums of weights: exact (default), by the "
     "processor's estimate of the reciprocal, or with one or two steps of Newton's.", NAME(gather.division, DIVISION),
     .engines = "gather"},
    {"layers-quality", 0, TOOL_LOOK, "standard|draft|high|best", "What its accuracy may cost. Default standard.",
     NAME(layers.quality, LAYERS),
     .engines = "layers"},
    {"spacing", 0, TOOL_LOOK, "PX", "Between slices, pixels of radius, 0.25 to 32. Default by --layers-quality.",
     NUMBER(layers.spacing, 0.25, 32),
     .engines = "layers"},
    {"half-from", 0, TOOL_LOOK, "PX", "Radius from which slices are blurred at half the resolution, 1 to 2048. "
     "Default by --layers-quality.", NUMBER(layers.half_from, 1, 2048),
     .engines = "layers"},
    {"quarter-from", 0, TOOL_LOOK, "PX", "At a quarter of it. Default by --layers-quality.",
     NUMBER(layers.quarter_from, 1, 2048),
     .engines = "layers"},
    {"no-unmix", 0, TOOL_LOOK, NULL, "Edges keep their mixed colours.", FLAG(layers.no_unmix),
     .engines = "layers"},
    {"no-hidden", 0, TOOL_LOOK, NULL, "Nothing is filled in behind objects.", FLAG(layers.no_hidden),
     .engines = "layers"},
    {"no-highlights", 0, TOOL_LOOK, NULL, "Highlights are blurred like all else.", FLAG(layers.no_highlights),
     .engines = "layers"},
    {"no-patterns", 0, TOOL_LOOK, NULL, "Behind objects no edges and patterns go on (quality best).",
     FLAG(layers.no_patterns),
     .engines = "layers"},
    {"karis", 0, TOOL_LOOK, NULL, "Weight samples by 1/(1+luminance), against fireflies.", FLAG(gather.karis),
     .engines = "gather"},
    {"per-pixel-kernel", 0, TOOL_LOOK, NULL, "Scale the far kernel by each pixel's own blur.",
     FLAG(gather.per_pixel_kernel),
     .engines = "gather"},
    {"bicubic", 0, TOOL_LOOK, NULL, "Upsample the near field with a B-spline, not bilinearly.",
     FLAG(gather.bicubic),
     .engines = "gather"},
    {"faithful", 0, TOOL_LOOK, NULL, "Reproduce the published demo, its flaws included.", .parse = parse_faithful, FIELD(gather.faithful),
     .engines = "gather|gaussian"},
    {"storage", 0, TOOL_LOOK, "float|half|packed", "Buffers between passes: 32-bit floats (default), 16-bit floats, "
     "or the packed formats of the book chapter.", NAME(gather.storage, STORAGE),
     .engines = "gather"},
    {"deterministic", 0, TOOL_RUN, NULL, "Same bits on every instruction set.", FLAG(run.deterministic)},
    {"no-skip", 0, TOOL_RUN, NULL, "Run every pass on every tile: same picture, slower.", FLAG(run.no_skip)},
    {.name = NULL},
};
// clang-format on
