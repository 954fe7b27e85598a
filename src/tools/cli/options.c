// SPDX-License-Identifier: BSD-3-Clause
// The command's own options, in the order of the help text; those of the library's parameters are in
// src/tools/common/params.c.
#include "tools/cli/args.h"
#include "tools/cli/choose.h"

#include <float.h>
#include <stddef.h>

// A choice is stored as an int.
_Static_assert(sizeof(enum hf_isa) == sizeof(int) && sizeof(enum hf_engine) == sizeof(int), "size of an enum");

// clang-format off
#define FIELD(f) .offset = offsetof(struct cli_args, f)
#define FLAG(f) .parse = tool_parse_flag, FIELD(f)
#define TEXT(f) .parse = tool_parse_text, FIELD(f)
#define NAME(f, of) .parse = tool_parse_name, FIELD(f), .names = HF_NAMES_##of
#define CHOICE(f) .parse = tool_parse_choice, FIELD(f)
#define COUNT(f, least, most) .parse = tool_parse_count, FIELD(f), .min = (least), .max = (most)
#define NUMBER(f, least, most) .parse = tool_parse_number, FIELD(f), .min = (least), .max = (most)
#define POSITIVE(f) NUMBER(f, 0, FLT_MAX), .above_min = 1

static const struct tool_option options[] = {
    {"output", 'o', TOOL_FILES, "OUTPUT", "Picture to write: a copy of INPUT with its colours defocused. A name other "
     "than .exr keeps the colour of one view only.", TEXT(output)},
    {"frames", 0, TOOL_FILES, "LIST", "Frames of an INPUT with a place for the number: 1-100, 1-100x2 (every second), "
     "10-1 (backwards), 1,5,9-20x3, -5--1, 1-100:3 (every third first, then those between). Default: all that "
     "exist.", TEXT(frames)},
    {"chunk", 0, TOOL_FILES, "auto|I/N", "Only part I of N of the frames, for farms. auto: this task's part in a Slurm "
     "array. Default: all of them.", TEXT(chunk)},
    {"views", 0, TOOL_FILES, "all|NAME,...", "Views to defocus, each by its own depth; the others are kept as they "
     "are. Default all.", TEXT(views)},
    {"layer", 0, TOOL_FILES, "all|NAME,...", "Layers to defocus, each by its own depth: ViewLayer.Combined, or just "
     "ViewLayer. all: every layer of colour, but no masks, normals or the like. Given several times: all of these. "
     "Default: the main one.", .parse = cli_parse_layer, FIELD(layer)},
    {"merge", 0, TOOL_FILES, NULL, "The layers of --layer are separate renders of one scene: defocus them together, merged "
     "by depth. The first gets the result; the others are kept as they are. Default: each is defocused by itself.",
     FLAG(merge), .engines = "layers|scatter"},
    {"over", 0, TOOL_FILES, "FILE", "Another picture of INPUT's scene with depth of its own, before or behind it: defocus "
     "both together, merged by depth. May be given several times. A lens then sees past edges what FILE shows, not a "
     "guess. In a shot it has a place for the number, too. Default: INPUT shows all there is.", .parse = cli_parse_other,
     .engines = "layers|scatter"},
    {"peel", 0, TOOL_FILES, "FILE", "What INPUT hides: of each pixel the surface behind it, its depth, and as alpha the "
     "part of the pixel in which there is one. Given twice, the second FILE has what the first hides. Default: it is "
     "guessed.", .parse = cli_parse_other, .engines = "layers|scatter"},
    {"grow", 0, TOOL_FILES, NULL, "Let the data window grow by the reach of the blur, up to the display window. New "
     "pixels are black and transparent, 0 in other channels, and far away in depth. Default: blur beyond the window is "
     "cut, with a warning.", FLAG(grow)},
    {"display", 0, TOOL_FILES, "WxH[+X+Y]", "Treat the picture as a crop of a frame of this size, pixels, at X,Y from "
     "its top left corner, by default in its middle. The lens is that of the whole frame. Default: the file's display "
     "window.",
     .parse = cli_parse_display,
     .field = "view.display_width|view.display_height"},
    {"compression", 0, TOOL_FILES, "none|rle|zips|zip|piz|pxr24|b44|b44a|dwaa|dwab", "Compression of an EXR OUTPUT. "
     "Default: that of INPUT.", .parse = tool_parse_choice_text, FIELD(compression)},
    {"zip-level", 0, TOOL_FILES, "N", "How hard ZIP and ZIPS try to make an EXR OUTPUT small, 1 (fast) to 12 (slow). "
     "Default: fast, and about as small as other programs write it.", COUNT(zip_level, 1, 12)},

    {"focus", 0, TOOL_FOCUS, "D|center", "Distance in perfect focus, scene units, more than 0, or inf with a lens; or "
     "center: what the middle pixel of the display window shows. Default: the header's focus.", .parse = cli_parse_focus,
     FIELD(focus), .unit = TOOL_UNIT_DISTANCE, .max = FLT_MAX, .above_min = 1, .inf = 1,
     .field = "focus"},
    {"focus-at", 0, TOOL_FOCUS, "X,Y", "Focus on what this pixel shows, EXR pixel coordinates. Over a shot: on the surface "
     "that lies there in its first frame, also when another comes between.",
     .parse = cli_parse_focus_at},
    {"focus-object", 0, TOOL_FOCUS, "NAME", "Focus on the object with this name in the EXR's Cryptomatte: the median of its "
     "distances.", .parse = cli_parse_focus_object, FIELD(focus_object)},
    {"focus-point", 0, TOOL_FOCUS, "X,Y,Z", "Focus on this point of the world, through worldToCamera or worldToNDC in the "
     "header.", .parse = cli_parse_focus_point},
    {"focus-smooth", 0, TOOL_FOCUS, "N", "A focus that is read from the pictures of a shot follows the mean of N frames "
     "before and after, so that it does not jump, 0 to 1000. Default 6.", COUNT(focus_smooth, 0, 1000)},
    {"focus-per-view", 0, TOOL_FOCUS, NULL, "If the focus is read from the picture, read it for each view. "
     "Default: all views have that of the first.", FLAG(focus_per_view)},
    {"print-focus", 0, TOOL_FOCUS, NULL, "Print the focus of each frame, as a file for --keys, and do nothing else.",
     FLAG(print_focus)},
    {"keys", 0, TOOL_FOCUS, "FILE", "Values that change over a shot, as CSV: a column frame and any of focus, range, "
     "strength, fstop, focal-length, max-radius, focus-at (X:Y). They replace the values of the options.", TEXT(keys)},
    {"keys-blend", 0, TOOL_FOCUS, "linear|smooth", "How values go from key to key. Default linear.",
     CHOICE(keys_blend)},
    {"range", 0, TOOL_FOCUS, "D", "Distance from the focus to full blur, scene units, 0 or more, or inf. Default: "
     "half the focus distance.", NUMBER(range, 0, FLT_MAX), .unit = TOOL_UNIT_DISTANCE, .inf = 1,
     .field = "range.distance"},
    {"depth-of-field", 0, TOOL_FOCUS, "D", "What lies within half of this before and behind the focus is sharp, scene "
     "units; blur grows from there on over the range. Default 0.", NUMBER(depth_of_field, 0, FLT_MAX),
     .unit = TOOL_UNIT_DISTANCE},
    {"blur", 0, TOOL_FOCUS, "PX", "For a depth of which nobody knows the scale: focus where --focus-at or --focus center says, "
     "and blur what is farthest off by PX pixels, all else in proportion. Whole numbers are then taken as depth estimators "
     "give them, white near, unless --depth-type says otherwise. Default: none, distances count.", NUMBER(blur, 0, 2048)},
    {"strength", 0, TOOL_FOCUS, "S", "Amount of blur, 0 (none) to 1. Default 1.", NUMBER(strength, 0, 1),
     .field = "range.strength"},
    {"near-begin", 0, TOOL_FOCUS, "D", "Near blur is full up to here, scene units. Default: focus - range.",
     NUMBER(near_begin, 0, FLT_MAX), .unit = TOOL_UNIT_DISTANCE,
     .field = "range.near_begin"},
    {"near-end", 0, TOOL_FOCUS, "D", "Near blur ends here, scene units, not beyond --far-begin. Default: the focus.",
     NUMBER(near_end, 0, FLT_MAX), .unit = TOOL_UNIT_DISTANCE,
     .field = "range.near_end"},
    {"far-begin", 0, TOOL_FOCUS, "D", "Far blur begins here, scene units. Default: the focus.",
     NUMBER(far_begin, 0, FLT_MAX), .unit = TOOL_UNIT_DISTANCE,
     .field = "range.far_begin"},
    {"far-end", 0, TOOL_FOCUS, "D", "Far blur is full from here on, scene units. Default: focus + range.",
     NUMBER(far_end, 0, FLT_MAX), .unit = TOOL_UNIT_DISTANCE,
     .field = "range.far_end"},
    {"max-radius", 0, TOOL_FOCUS, "PX", "Largest blur radius, pixels, 0 (none) to 2048. Default: with a lens that "
     "of the lens, else 12 at 1080 lines, in proportion to the height.", NUMBER(params.max_radius, 0, 2048),
     .field = "max_radius"},

    {"fstop", 0, TOOL_LENS, "N", "f-number, more than 0, or inf (no blur). Default: the header's aperture.",
     POSITIVE(fstop), .unit = TOOL_UNIT_FSTOP, .inf = 1,
     .field = "lens.f_number"},
    {"focal-length", 0, TOOL_LENS, "MM", "Focal length, millimetres. Default: the header's pinholeFocalLength, else its "
     "nominalFocalLength.",
     POSITIVE(focal_length), .unit = TOOL_UNIT_MM,
     .field = "lens.focal_length_mm"},
    {"sensor-width", 0, TOOL_LENS, "MM", "Width of the sensor, millimetres. Default: the header's "
     "sensorOverallDimensions, else 36.", POSITIVE(sensor_width), .unit = TOOL_UNIT_MM,
     .field = "lens.sensor_width_mm"},
    {"world-unit", 0, TOOL_LENS, "M", "Metres in one scene unit. Default 1.", POSITIVE(world_unit), .unit = TOOL_UNIT_M,
     .field = "lens.world_unit_m"},

    {"depth-channel", 0, TOOL_DEPTH, "NAME", "Full name of the depth channel. Default: the view's Z or depth.Z, else "
     "the only channel with depth in its name.", TEXT(depth_channel)},
    {"depth-file", 0, TOOL_DEPTH, "FILE", "Take depth from this file. Default: from INPUT. One of another size than the view is scaled to it by the "
     "nearest sample, if its width / height is the same within 1 %.", TEXT(depth_file)},
    {"depth-type", 0, TOOL_DEPTH, "view|ray|ndc-d3d|ndc-gl|ndc-reversed|inverse|normalized|normalized-inverted|coc",
     "What depth holds. Default view. view: distance along the camera's axis; ray: along the ray; ndc-d3d, ndc-gl, "
     "ndc-reversed: a depth buffer from 0 to 1, -1 to 1, 1 to 0; inverse: 1/distance, as depth estimators give it; "
     "normalized, normalized-inverted: a map from black at --near to white at --far, or the other way; coc: signed blur "
     "radii in pixels, near ones negative, which need no focus.", .parse = cli_parse_depth_type, FIELD(depth_type),
     .names = HF_NAMES_DEPTH_TYPE,
     .field = "depth.type"},
    {"near", 0, TOOL_DEPTH, "D", "Distance of the near end of an ndc or normalized depth, scene units. With inverse: "
     "the distance of the number 1, in place of a scale. With gaussian: the near end of any depth. Default with "
     "gaussian 1, else none.", POSITIVE(near_plane), .unit = TOOL_UNIT_DISTANCE,
     .field = "depth.near_plane"},
    {"far", 0, TOOL_DEPTH, "D", "Distance of the far end, or inf; with inverse: of the number 0. Default with "
     "gaussian 100 times --near, with inverse inf, else none.", POSITIVE(far_plane),
     .unit = TOOL_UNIT_DISTANCE, .inf = 1,
     .field = "depth.far_plane"},
    {"depth-scale", 0, TOOL_DEPTH, "S", "Multiply the numbers of the depth by S first, not 0. Whole numbers of a "
     "picture count as 0 to 1. Default 1.", NUMBER(depth_scale, -FLT_MAX, FLT_MAX)},
    {"depth-offset", 0, TOOL_DEPTH, "D", "Add D to them after that. Default 0.",
     NUMBER(depth_offset, -FLT_MAX, FLT_MAX)},
    {"depth-edges", 0, TOOL_DEPTH, "auto|keep|sharpen", "sharpen: numbers between the two sides of an outline, where "
     "no surface is, become those of the nearer side: for depth that was filtered, smoothed or made smaller. auto "
     "(default): sharpen a --depth-file of whole numbers. One of 8 bits or less has its gentle slopes smoothed, too, "
     "unless keep is given.", CHOICE(depth_edges)},

    {"engine", 0, TOOL_LOOK, "gather|hexagon|scatter|gaussian|layers|chapter", "How to blur. Default layers. layers: edges un-mixed, "
     "what objects hide filled in, the most accurate. scatter: every pixel becomes the aperture's picture. gather: "
     "half-resolution near and far fields, the fastest. hexagon: hexagonal highlights in two passes. gaussian: soft, with "
     "autofocus. chapter: the nine passes of the book chapter that the gather grew out of.", NAME(engine, ENGINE),
     .field = "engine"},
    {"quality", 0, TOOL_LOOK, "draft|standard|best", "Let the library choose the engine and its settings. Default: "
     "--engine and its options count. From the settings that were measured, draft chooses the cheapest that blurs as far as "
     "a lens (the gather), best the most accurate, standard the cheapest within 1 dB of that, which is also the one for moving "
     "pictures. --explain says why, what that costs, and how far from a ray tracer it is. Unless the aperture's shape or a large radius needs "
     "another:", NAME(quality, QUALITY), .chooses = cli_quality_words,
     .field = "quality"},
    {"max-error", 0, TOOL_LOOK, "E", "Let the library choose the cheapest setting with at most this error: the root "
     "mean square difference from a ray tracer, over the display's range, more than 0 to 1. 0.03 is 30 dB.",
     NUMBER(max_error, 0, 1), .above_min = 1,
     .field = "error"},
    {"aperture", 0, TOOL_LOOK, "disc|ngon:N[:ROUNDNESS][:DEGREES]|ring:R|FILE", "Shape of a highlight: a disc "
     "(default), or a polygon with 3 to 16 sides, straight (0) to round (1), turned by some degrees: ngon:6:0.5:15. Of "
     "one number alone, up to 1 is the roundness and more the degrees: ngon:6:15. Only layers and scatter draw round "
     "sides, a ring whose hole has R of the radius, 0 to 0.95, or the picture in FILE. hexagon: ngon:6 and the degrees.",
     .parse = cli_parse_aperture,
     .field = "aperture.blades|aperture.rotation|aperture.roundness|aperture.ring|aperture.picture"},

    {"threads", 0, TOOL_RUN, "N", "Threads to work on, up to 256; 0 (default): one per processor.",
     COUNT(threads, 0, 256),
     .field = "config.threads"},
    {"memory-limit", 0, TOOL_RUN, "GIB", "Memory to keep within, GiB: as many frames are worked on at once as fit. "
     "Default: 2, or half of what there is if that is less.", POSITIVE(memory_limit)},
    {"resume", 0, TOOL_RUN, NULL, "Skip frames whose OUTPUT is whole and was made with the same settings from the same "
     "INPUT, make the others, and remove what killed processes left.", FLAG(resume)},
    {"stop-on-error", 0, TOOL_RUN, NULL, "Stop at the first frame that fails. Default: go on with the others.",
     FLAG(stop_on_error)},
    {"log", 0, TOOL_RUN, "FILE", "Append what happens to each frame to FILE, one JSON object a line.",
     TEXT(log_file)},
    {"isa", 0, TOOL_RUN, "auto|scalar|sse4.1|avx2|avx512|neon", "Instruction set to use. Default auto: the best of "
     "this CPU.", NAME(isa, ISA),
     .field = "config.isa"},
    {"budget-ms", 0, TOOL_RUN, "MS", "Milliseconds that a frame may take. After two frames that took longer, the "
     "best setting is chosen that is expected to fit, of those of --quality that blur as far as is asked for, and one below "
     "them. Default: any time.",
     POSITIVE(params.run.budget_ms),
     .field = "run.budget_ms"},
    {"explain", 0, TOOL_RUN, NULL, "Print what the picture needed: on how many tiles each pass ran, why it skipped the "
     "others, memory, time. With --dry-run: what would run.", FLAG(explain)},
    {"explain-image", 0, TOOL_RUN, "FILE", "Write the picture with its tiles painted over: near red, far blue, both "
     "violet, sharp as it is. Of several views each has its own: out.png is out.left.png and out.right.png.", TEXT(explain_image)},
    {"focus-image", 0, TOOL_RUN, "FILE", "Write the picture painted by what each pixel is: near red, in focus green, "
     "far blue. Of several views each has its own: out.png is out.left.png and out.right.png.", TEXT(focus_image)},
    {"guessed", 0, TOOL_RUN, NULL, "Tell how much of the picture's light is guessed: what objects hide and no further picture "
     "shows, and what lies beyond the frame. An EXR OUTPUT gets the share of each pixel as the channel guessed; --json and "
     "--log have the sum. Takes as long again as the blur. Default: it is not asked.", FLAG(guessed), .engines = "layers"},
    {"guessed-image", 0, TOOL_RUN, "FILE", "Write the share of each pixel, 0 to 1, as an EXR of its own with the channel guessed. "
     "Default: none.", TEXT(guessed_image), .engines = "layers"},
    {"json", 0, TOOL_RUN, "[FILE]", "Print statistics and times as JSON, or write them to FILE. A word after it is "
     "FILE unless there is no other INPUT.", .parse = cli_parse_json},
    {"dump-passes", 0, TOOL_RUN, "DIR", "Write every intermediate buffer to DIR as EXR.", TEXT(dump_dir)},
    {"dry-run", 0, TOOL_RUN, NULL, "Say what would be done, write no OUTPUT. Files of --json, --explain-image and "
     "--focus-image are written.", FLAG(dry_run)},
    {"verbose", 0, TOOL_RUN, NULL, "Print a line about each frame, even if stderr is not a terminal.", FLAG(verbose)},
    {"quiet", 0, TOOL_RUN, NULL, "Print only warnings and errors: no line about each frame and no progress, even on a "
     "terminal.", FLAG(quiet)},
    {"help", 'h', TOOL_RUN, "[all|man]", "Print the usual options; --help=all: all of them; --help=man: the man page.",
     .parse = tool_parse_help},
    {"version", 0, TOOL_RUN, NULL, "Print the version.", .parse = cli_parse_version},
    {.name = NULL},
};

static const char *const groups[TOOL_GROUPS] = {
    [TOOL_FILES] = "Files",
    [TOOL_FOCUS] = "Focus and range (in scene units, those of the depth; or as 1.2m, 80cm)",
    [TOOL_LENS] = "Lens",
    [TOOL_DEPTH] = "Depth",
    [TOOL_LOOK] = "Look",
    [TOOL_RUN] = "Running",
};

// clang-format on

// The options that --help prints; --help=all prints all.
static const char *const usual[] = {"output",   "focus",        "focus-at",   "range",      "max-radius", "blur",
                                    "fstop",    "focal-length", "depth-file", "depth-type", "engine",     "quality",
                                    "aperture", "dry-run",      "help",       NULL};

const struct tool_program cli_program = {
    .name = "hyperfocal",
    .subject = "depth of field for rendered pictures",
    .usage = "INPUT -o OUTPUT [options]",
    .intro = "INPUT holds linear colour and depth, as EXR does. OUTPUT is a copy of it with "
             "the colours defocused. A value follows its option as the next word or after =. "
             "A shot: INPUT and OUTPUT with a place for the frame number, shot.####.exr (also "
             "#, @@@, %04d, $F4; %V for the view), or several INPUT.",
    .groups = groups,
    .sections = (const struct tool_section[]){{options, 0, NULL},
                                              {tool_params_options, offsetof(struct cli_args, params), NULL}},
    .section_count = 2,
    .usual = usual,
    .more_title = "How much blur",
    .more = "--range, --strength and --near-begin to --far-end choose the range model: blur "
            "grows over a distance of your choice, whatever lens the header has. --fstop, "
            "--focal-length or a lens in the header (aperture and pinholeFocalLength or "
            "nominalFocalLength) choose the lens: blur as a camera has it. With neither, "
            "the range is half the focus distance. --focus overrides the header's.",
    .examples =
        (const char *const[]){"hyperfocal shot.exr -o dof.exr --focus 4.2 --range 3",
                              "hyperfocal shot.exr -o dof.exr --focus-at 960,540 --fstop 2 --focal-length 50",
                              "hyperfocal shot.####.exr -o dof.####.exr --focus center --frames 1-9 --resume", NULL},
    .outro = "Exit codes: 0 done; 1 the command line is wrong or names what does not exist: do not "
             "try again; 2 some frames failed; 3 all failed.",
};
