// SPDX-License-Identifier: BSD-3-Clause
// Options that set the library's parameters directly, for both programs. An engine's option belongs here.
#include "tools/common/options.h"

#include <stddef.h>

// A choice is stored as an int.
_Static_assert(sizeof(enum hf_isa) == sizeof(int) && sizeof(enum hf_engine) == sizeof(int), "size of an enum");

// clang-format off
#define FIELD(f) .offset = offsetof(struct hf_params, f), .field = #f
#define FLAG(f) .parse = tool_parse_flag, FIELD(f)
#define NAME(f, of) .parse = tool_parse_name, FIELD(f), .names = HF_NAMES_##of
#define COUNT(f, least, most) .parse = tool_parse_count, FIELD(f), .min = (least), .max = (most)
#define OF(f) offsetof(struct hf_params, f)
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
     "bright discs: what is 1 counts as G, 1 (none, default) to 64, and what the blur leaves alone stays. 8 are three stops. The "
     "command does so for what is small and stands out; the library for all.",
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
     "only for gaussian. Default full.", NAME(hexagon.resolution, RESOLUTION), .also = {OF(scatter.resolution), OF(gaussian.resolution)},
     .engines = "hexagon|scatter|gaussian"},
    {"fill", 0, TOOL_LOOK, "max|mean|none|open", "How gaps between taps are closed: 3x3 maximum (default), 3x3 mean, by three "
     "times as many taps, or not at all. The gather has no gaps: its fill is mean.", NAME(chapter.fill, FILL),
     .engines = "chapter|gather"},
    {"blend", 0, TOOL_LOOK, "linear|smoothstep", "How blur grows from sharp to full. Default linear.",
     NAME(range.blend, BLEND)},
    {"rings", 0, TOOL_LOOK, "N", "Rings of taps, 1 to 64. Default: as many as lie two half-resolution pixels "
     "apart. Fewer are faster. The gather has no taps, and no use for it.", COUNT(chapter.rings, 1, 64),
     .engines = "chapter|gather"},
    {"downsample", 0, TOOL_LOOK, "bilateral|linear|point", "How four pixels become one of half resolution: "
     "far ones by how alike their blur is (default), their mean, or the first of them.", NAME(chapter.downsample, DOWNSAMPLE),
     .engines = "chapter|gather"},
    {"division", 0, TOOL_LOOK, "exact|estimate|newton|newton2", "By sums of weights: exact (default), by the "
     "processor's estimate of the reciprocal, or with one or two steps of Newton's.", NAME(chapter.division, DIVISION),
     .engines = "chapter|gather"},
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
    {"lens-points", 0, TOOL_LOOK, "N", "Points of the lens that are followed where near and far cross, 2 to 192; 1: none. Default by "
     "--layers-quality.", COUNT(layers.lens_points, 1, 192),
     .engines = "layers"},
    {"karis", 0, TOOL_LOOK, NULL, "Weight samples by 1/(1+luminance), against fireflies.", FLAG(gather.karis), .also = {OF(chapter.karis)},
     .engines = "gather|chapter"},
    {"per-pixel-kernel", 0, TOOL_LOOK, NULL, "Scale kernels by each pixel's own blur.",
     FLAG(gather.per_pixel_kernel), .also = {OF(chapter.per_pixel_kernel)},
     .engines = "gather|chapter"},
    {"bicubic", 0, TOOL_LOOK, NULL, "Upsample the near field with a B-spline, not bilinearly.",
     FLAG(gather.bicubic), .also = {OF(chapter.bicubic)},
     .engines = "gather|chapter"},
    {"faithful", 0, TOOL_LOOK, NULL, "Reproduce the published demo, its flaws included.", FLAG(chapter.faithful),
     .also = {OF(gaussian.faithful)}, .engines = "chapter|gather|gaussian"},
    {"storage", 0, TOOL_LOOK, "float|half|packed", "Buffers between passes: 32-bit floats (default), 16-bit floats, "
     "or the packed formats of the book chapter.", NAME(gather.storage, STORAGE), .also = {OF(chapter.storage)},
     .engines = "gather|chapter"},
    {"deterministic", 0, TOOL_RUN, NULL, "Same bits on every instruction set.", FLAG(run.deterministic)},
    {"no-skip", 0, TOOL_RUN, NULL, "Run every pass on every tile: same picture, slower.", FLAG(run.no_skip)},
    {.name = NULL},
};
// clang-format on

const char *tool_choose_chapter(const struct tool_parser *parser, struct hf_params *p)
{
    const struct hf_chapter_params *c = &p->chapter;
    const char *by = c->faithful                                             ? "faithful"
                     : tool_given(parser, "fill") && c->fill != HF_FILL_MEAN ? "fill"
                     : c->downsample                                         ? "downsample"
                     : c->division && !p->run.deterministic                  ? "division"
                                                                             : NULL;
    if (p->engine != HF_ENGINE_GATHER || !by)
        return NULL;
    p->engine = HF_ENGINE_CHAPTER;
    return by;
}
