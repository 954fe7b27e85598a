// SPDX-License-Identifier: BSD-3-Clause
// The table of options. Order is that of the help text.
#include "cli/args.h"

#include <float.h>
#include <stddef.h>

// A choice is stored as an int.
_Static_assert(sizeof(enum hf_isa) == sizeof(int) && sizeof(enum hf_engine) == sizeof(int), "size of an enum");

// clang-format off
const char *const cli_group_names[CLI_GROUPS] = {
    [CLI_FILES] = "Files",
    [CLI_FOCUS] = "Focus and range (in scene units, those of the depth; 1.2m or 80cm will do)",
    [CLI_LENS] = "Lens",
    [CLI_DEPTH] = "Depth",
    [CLI_LOOK] = "Look",
    [CLI_RUN] = "Running",
};

#define FIELD(f) .offset = offsetof(struct cli_args, f)
#define FLAG(f) .parse = cli_parse_flag, FIELD(f)
#define TEXT(f) .parse = cli_parse_text, FIELD(f)
#define NAME(f, of) .parse = cli_parse_name, FIELD(f), .names = HF_NAMES_##of
#define CHOICE(f) .parse = cli_parse_choice, FIELD(f)
#define NUMBER(f, least, most) .parse = cli_parse_number, FIELD(f), .min = (least), .max = (most)
#define POSITIVE(f) NUMBER(f, 0, FLT_MAX), .above_min = 1

const struct cli_option cli_options[] = {
    {"output", 'o', CLI_FILES, "OUTPUT", "Picture to write: a copy of INPUT with its colours defocused. A name other "
     "than .exr keeps the colour of one view only.", TEXT(output)},
    {"frames", 0, CLI_FILES, "LIST", "Frames of an INPUT with a place for the number: 1-100, 1-100x2 (every second), "
     "10-1 (backwards), 1,5,9-20x3, -5--1, 1-100:3 (every third first, then those between). Default: those that there "
     "are.", TEXT(frames)},
    {"chunk", 0, CLI_FILES, "auto|I/N", "Only part I of N of the frames, for farms. auto: this task's part in a Slurm "
     "array.", TEXT(chunk)},
    {"views", 0, CLI_FILES, "all|NAME,...", "Views to defocus, each by its own depth; the others are kept as they "
     "are. Default all.", TEXT(views)},
    {"compression", 0, CLI_FILES, "none|rle|zips|zip|piz|pxr24|b44|b44a|dwaa|dwab", "Compression of an EXR OUTPUT. "
     "Default: that of INPUT.", .parse = cli_parse_choice_text, FIELD(compression)},

    {"focus", 0, CLI_FOCUS, "D|center", "Distance in perfect focus, scene units, more than 0; or center: what the "
     "middle pixel of the display window shows. Default: the header's focus.", .parse = cli_parse_focus,
     FIELD(focus), .unit = CLI_UNIT_DISTANCE, .max = FLT_MAX, .above_min = 1},
    {"focus-at", 0, CLI_FOCUS, "X,Y", "Focus on what this pixel shows, EXR pixel coordinates.",
     .parse = cli_parse_focus_at},
    {"focus-smooth", 0, CLI_FOCUS, "N", "A focus that is read from the pictures of a shot follows the mean of N frames "
     "before and after, so that it does not jump, 0 to 1000. Default 6.", .parse = cli_parse_count, FIELD(focus_smooth),
     .max = 1000},
    {"focus-per-view", 0, CLI_FOCUS, NULL, "A focus that is read from the picture is each view's own. Default: all "
     "have that of the first.", FLAG(focus_per_view)},
    {"print-focus", 0, CLI_FOCUS, NULL, "Print the focus of each frame, as a file for --keys, and do nothing else.",
     FLAG(print_focus)},
    {"keys", 0, CLI_FOCUS, "FILE", "Values that change over a shot, as CSV: a column frame and any of focus, range, "
     "strength, fstop, focal-length, max-radius, focus-at (X:Y). They go before the options.", TEXT(keys)},
    {"keys-blend", 0, CLI_FOCUS, "linear|smooth", "How values go from key to key. Default linear.",
     CHOICE(keys_blend)},
    {"range", 0, CLI_FOCUS, "D", "Distance from the focus to full blur, scene units, 0 or more, or inf. Default: "
     "half the focus distance.", NUMBER(range, 0, FLT_MAX), .unit = CLI_UNIT_DISTANCE, .inf = 1},
    {"depth-of-field", 0, CLI_FOCUS, "D", "What lies within half of this before and behind the focus is sharp, scene "
     "units; blur grows from there on over the range. Default 0.", NUMBER(depth_of_field, 0, FLT_MAX),
     .unit = CLI_UNIT_DISTANCE},
    {"strength", 0, CLI_FOCUS, "S", "Amount of blur, 0 (none) to 1. Default 1.", NUMBER(strength, 0, 1)},
    {"near-begin", 0, CLI_FOCUS, "D", "Near blur is full up to here, scene units. Default: focus - range.",
     NUMBER(near_begin, 0, FLT_MAX), .unit = CLI_UNIT_DISTANCE},
    {"near-end", 0, CLI_FOCUS, "D", "Near blur ends here, scene units. Default: the focus.",
     NUMBER(near_end, 0, FLT_MAX), .unit = CLI_UNIT_DISTANCE},
    {"far-begin", 0, CLI_FOCUS, "D", "Far blur begins here, scene units. Default: the focus.",
     NUMBER(far_begin, 0, FLT_MAX), .unit = CLI_UNIT_DISTANCE},
    {"far-end", 0, CLI_FOCUS, "D", "Far blur is full from here on, scene units. Default: focus + range.",
     NUMBER(far_end, 0, FLT_MAX), .unit = CLI_UNIT_DISTANCE},
    {"max-radius", 0, CLI_FOCUS, "PX", "Largest blur radius, pixels, 0 (none) to 2048. Default: with a lens that "
     "of the lens, else 12 at 1080 lines, in proportion to the height.", NUMBER(params.max_radius, 0, 2048)},

    {"fstop", 0, CLI_LENS, "N", "f-number, more than 0, or inf (no blur). Default: the header's aperture.",
     POSITIVE(fstop), .unit = CLI_UNIT_FSTOP, .inf = 1},
    {"focal-length", 0, CLI_LENS, "MM", "Focal length, millimetres. Default: the header's pinholeFocalLength.",
     POSITIVE(focal_length), .unit = CLI_UNIT_MM},
    {"sensor-width", 0, CLI_LENS, "MM", "Width of the sensor, millimetres. Default: the header's "
     "sensorOverallDimensions, else 36.", POSITIVE(sensor_width), .unit = CLI_UNIT_MM},
    {"world-unit", 0, CLI_LENS, "M", "Metres in one scene unit. Default 1.", POSITIVE(world_unit), .unit = CLI_UNIT_M},

    {"depth-channel", 0, CLI_DEPTH, "NAME", "Full name of the depth channel. Default: the view's Z or depth.Z, else "
     "the only channel with depth in its name.", TEXT(depth_channel)},
    {"depth-file", 0, CLI_DEPTH, "FILE", "Take depth from this file, with the same data window size as the view.",
     TEXT(depth_file)},
    {"depth-type", 0, CLI_DEPTH, "view|ray|ndc-d3d|ndc-gl|ndc-reversed|inverse|coc", "What depth holds: distance "
     "along the camera's axis (view, the default) or along the ray; a depth buffer from 0 to 1 (ndc-d3d), -1 to 1 "
     "(ndc-gl) or 1 to 0 (ndc-reversed), which need --near and --far; 1/distance; or signed blur radii in pixels, "
     "near ones negative (coc), which need no focus.", NAME(depth_type, DEPTH_TYPE)},
    {"near", 0, CLI_DEPTH, "D", "Near clip plane of an ndc depth, scene units; with gaussian of any.",
     POSITIVE(near_plane), .unit = CLI_UNIT_DISTANCE},
    {"far", 0, CLI_DEPTH, "D", "Far clip plane of an ndc depth, scene units, or inf; with gaussian of any.",
     POSITIVE(far_plane), .unit = CLI_UNIT_DISTANCE, .inf = 1},

    {"engine", 0, CLI_LOOK, "gather|hexagon|scatter|gaussian|layers", "How to blur. scatter (default): every pixel "
     "becomes the aperture's picture. layers: edges un-mixed, what objects hide filled in: the most accurate, discs "
     "only. gather: half-resolution near and far fields, the fastest. hexagon: hexagonal highlights in two passes. "
     "gaussian: soft, with autofocus.", NAME(engine, ENGINE)},
    {"quality", 0, CLI_LOOK, "draft|standard|high|best", "In place of --engine: draft is the gather, all others are the "
     "scatter.", CHOICE(quality)},
    {"aperture", 0, CLI_LOOK, "disc|ngon:N[:ROUNDNESS][:DEGREES]|ring:R|FILE", "Shape of a highlight: a disc "
     "(default), or a polygon with 3 to 16 sides turned by some degrees. scatter: rounded by 0 to 1 (a lone number above 1 is the degrees); a "
     "ring whose hole has R of the radius, 0 to 0.95; or the picture in FILE. hexagon: ngon:6 and the degrees.",
     .parse = cli_parse_aperture},
    {"chromatic", 0, CLI_LOOK, "S", "scatter: red highlights larger by this fraction and blue ones smaller behind the "
     "focus, the other way before it, -0.5 to 0.5. Default 0.", NUMBER(params.scatter.chromatic, -0.5, 0.5)},
    {"cat-eye", 0, CLI_LOOK, "S", "scatter: cut highlights towards the corners, 0 (default) to 1.",
     NUMBER(params.aperture.cat_eye, 0, 1)},
    {"squeeze", 0, CLI_LOOK, "S", "scatter: height over width of a highlight, 0.25 to 4. Default 1.",
     NUMBER(params.aperture.squeeze, 0.25, 4)},
    {"uniform", 0, CLI_LOOK, NULL, "hexagon: the same blur everywhere, --max-radius.", FLAG(params.hexagon.uniform)},
    {"iterations", 0, CLI_LOOK, "N", "gaussian: passes of the 5-tap blur, 0 to 64. Default 3.",
     .parse = cli_parse_count, FIELD(params.gaussian.iterations), .max = 64},
    {"sigma", 0, CLI_LOOK, "PX", "gaussian: one blur of this standard deviation, pixels, in place of --iterations, 0 "
     "to 256. Default: iterations.", NUMBER(params.gaussian.sigma, 0, 256)},
    {"resolution", 0, CLI_LOOK, "full|half|quarter", "hexagon, scatter, gaussian: size of the working buffers, quarter "
     "only for gaussian. Default full.", NAME(resolution, RESOLUTION)},
    {"fill", 0, CLI_LOOK, "max|mean|none", "How gaps between taps are closed: 3x3 maximum (default), 3x3 mean, or "
     "three times as many taps.", NAME(params.gather.fill, FILL)},
    {"blend", 0, CLI_LOOK, "linear|smoothstep", "How blur grows from sharp to full. Default linear.",
     NAME(params.range.blend, BLEND)},
    {"rings", 0, CLI_LOOK, "N", "gather: rings of taps, 1 to 64. Default: as many as lie two half-resolution pixels "
     "apart. Fewer are faster.", .parse = cli_parse_count, FIELD(params.gather.rings), .min = 1, .max = 64},
    {"karis", 0, CLI_LOOK, NULL, "Weight samples by 1/(1+luminance), against fireflies.", FLAG(params.gather.karis)},
    {"per-pixel-kernel", 0, CLI_LOOK, NULL, "Scale the far kernel by each pixel's own blur.",
     FLAG(params.gather.per_pixel_kernel)},
    {"bicubic", 0, CLI_LOOK, NULL, "Upsample the near field with a B-spline, not bilinearly.",
     FLAG(params.gather.bicubic)},
    {"faithful", 0, CLI_LOOK, NULL, "Reproduce the published demo, its flaws included.", FLAG(faithful)},
    {"storage", 0, CLI_LOOK, "float|half|packed", "Buffers between passes: 32-bit floats (default), 16-bit floats, "
     "or the packed formats of the book chapter.", NAME(params.gather.storage, STORAGE)},

    {"threads", 0, CLI_RUN, "N", "Threads to work on, up to 256; 0 (default): one per processor.",
     .parse = cli_parse_count, FIELD(threads), .max = 256},
    {"memory-limit", 0, CLI_RUN, "GIB", "Memory to keep within, GiB: as many frames are worked on at once as fit. "
     "Default: 2, or half of what there is if that is less.", POSITIVE(memory_limit)},
    {"resume", 0, CLI_RUN, NULL, "Skip frames whose OUTPUT is whole and was made with the same settings from the same "
     "INPUT, make the others, and remove what killed processes left.", FLAG(resume)},
    {"stop-on-error", 0, CLI_RUN, NULL, "Stop at the first frame that fails. Default: go on with the others.",
     FLAG(stop_on_error)},
    {"log", 0, CLI_RUN, "FILE", "Append what happens to each frame to FILE, one JSON object a line.",
     TEXT(log_file)},
    {"isa", 0, CLI_RUN, "auto|scalar|sse4.1|avx2|avx512|neon", "Instruction set to use. Default auto: the best of "
     "this CPU.", NAME(isa, ISA)},
    {"deterministic", 0, CLI_RUN, NULL, "Same bits on every instruction set.", FLAG(params.run.deterministic)},
    {"no-skip", 0, CLI_RUN, NULL, "Run every pass on every tile: same picture, slower.", FLAG(params.run.no_skip)},
    {"budget-ms", 0, CLI_RUN, "MS", "Milliseconds that a frame may take. When the frames before took longer, cheaper "
     "settings are chosen: smaller buffers, the gather, fewer rings. Default: any time.",
     POSITIVE(params.run.budget_ms)},
    {"explain", 0, CLI_RUN, NULL, "Print what the picture called for: on which tiles each pass ran and why not on the "
     "others, memory, time. With --dry-run: what would run.", FLAG(explain)},
    {"explain-image", 0, CLI_RUN, "FILE", "Write the picture with its tiles painted over: near red, far blue, both "
     "violet, sharp as it is.", TEXT(explain_image)},
    {"json", 0, CLI_RUN, "[FILE]", "Print statistics and times as JSON, or write them to FILE. A word after it is "
     "FILE unless there is no other INPUT.", .parse = cli_parse_json},
    {"dump-passes", 0, CLI_RUN, "DIR", "Write every intermediate buffer to DIR as EXR.", TEXT(dump_dir)},
    {"dry-run", 0, CLI_RUN, NULL, "Say what would be done, write nothing.", FLAG(dry_run)},
    {"verbose", 0, CLI_RUN, NULL, "Say in a line what was done with each frame, as on a terminal.", FLAG(verbose)},
    {"quiet", 0, CLI_RUN, NULL, "Do not, on a terminal either.", FLAG(quiet)},
    {"help", 'h', CLI_RUN, "[all]", "Print the usual options; --help=all: all of them.", .parse = cli_parse_help},
    {"version", 0, CLI_RUN, NULL, "Print the version.", FLAG(version)},
};
// clang-format on

const int cli_option_count = sizeof(cli_options) / sizeof(cli_options[0]);
