// SPDX-License-Identifier: BSD-3-Clause
// The command line: one table of options that both the parser and the help text walk, so that they cannot disagree.
// Parsing has no side effects; it opens no file and prints nothing.
#ifndef HF_CLI_ARGS_H
#define HF_CLI_ARGS_H

#include "hyperfocal/hyperfocal.h"

#include "cli/error.h"

enum { CLI_DONE = 0, CLI_BAD_ARGUMENTS = 1, CLI_SOME_FAILED = 2, CLI_ALL_FAILED = 3 };

enum cli_focus {
    CLI_FOCUS_HEADER,    // not on the command line
    CLI_FOCUS_DISTANCE,  // --focus D
    CLI_FOCUS_CENTER,    // --focus center
    CLI_FOCUS_AT,        // --focus-at X,Y
};

// --quality: which engine, and how fine.
enum cli_quality { CLI_QUALITY_DRAFT, CLI_QUALITY_STANDARD, CLI_QUALITY_HIGH, CLI_QUALITY_BEST };

enum cli_keys_blend { CLI_KEYS_LINEAR, CLI_KEYS_SMOOTH };

enum { CLI_METRIC = 16 };  // no more options take distances

// What was asked for. Numbers that were not given are NAN, texts NULL.
struct cli_args {
    const char **inputs;  // as given; input: of the frame at hand
    int input_count;
    const char *input, *output;
    int help, version, dry_run;  // help: 2 for all options
    int verbose, quiet;

    // Fields that the command line sets as they are: engine, storage, max_radius, the flags, fill, blend, blades.
    // The model and what belongs to it depend on the file, see setup.h.
    struct hf_params params;

    int engine, quality;            // as given; -1: not given
    enum hf_resolution resolution;  // of whichever engine
    int faithful;                   // likewise

    enum cli_focus focus_by;
    int focus_given, focus_at_given;  // --focus in either form, --focus-at
    float focus;                      // scene units
    int focus_x, focus_y;             // EXR pixel coordinates

    // Offsets of the distances that were given in metres: until the world unit is known they are no scene units.
    size_t metric[CLI_METRIC];
    int metric_count;
    float range, depth_of_field, strength, near_begin, near_end, far_begin, far_end;
    float fstop, focal_length, sensor_width, world_unit;

    const char *depth_channel, *depth_file;
    enum hf_depth_type depth_type;
    float near_plane, far_plane;

    const char *aperture;       // as given
    const char *aperture_file;  // NULL: the shape in params

    // A shot: see shot.h, keys.h, track.h, batch.h.
    const char *frames, *chunk, *keys, *log_file;
    enum cli_keys_blend keys_blend;
    int focus_smooth;        // frames to each side; -1: not given
    int focus_per_view;      // each eye its own
    const char *focus_from;  // whence the focus of a frame; NULL: --focus
    int print_focus, resume, stop_on_error;
    float memory_limit;  // GiB
    char *settings;      // the options that change pixels, as they were given

    const char *views;  // NULL: all, else names with commas
    const char *compression;
    const char *dump_dir;
    int explain;
    const char *explain_image;
    int json;
    const char *json_file;  // NULL: stdout
    int threads;
    enum hf_isa isa;
};

enum cli_group { CLI_FILES, CLI_FOCUS, CLI_LENS, CLI_DEPTH, CLI_LOOK, CLI_RUN, CLI_GROUPS };

// What may stand beside a number: nothing; of a distance m, cm, mm; of millimetres or metres the same; f/ before it.
enum cli_unit { CLI_UNIT_NONE, CLI_UNIT_DISTANCE, CLI_UNIT_MM, CLI_UNIT_M, CLI_UNIT_FSTOP };

struct cli_option;
typedef int cli_parse(struct cli_args *args, const struct cli_option *option, const char *value,
                      struct cli_error *error);

// One row of the table.
struct cli_option {
    const char *name;  // without the dashes
    char letter;       // short form, 0: none
    enum cli_group group;
    const char *placeholder;  // of the value; NULL: takes none; "[FILE]": may have one. Of a choice the very list
                              // of words that are accepted, "a|b"
    const char *help;
    cli_parse *parse;
    size_t offset;        // in struct cli_args, of what parse sets
    float min, max;       // of a number, inclusive
    int above_min;        // ... but min itself is excluded
    enum cli_unit unit;   // that may be written behind a number
    int inf;              // inf is accepted
    enum hf_names names;  // of a choice that the library has words for
};

extern const struct cli_option cli_options[];
extern const int cli_option_count;
extern const char *const cli_group_names[CLI_GROUPS];

// Value parsers, the last column of the table. All return 0, or -1 with *error filled.
cli_parse cli_parse_flag, cli_parse_number, cli_parse_count, cli_parse_text, cli_parse_name, cli_parse_choice,
    cli_parse_choice_text;
cli_parse cli_parse_focus, cli_parse_focus_at, cli_parse_aperture, cli_parse_json, cli_parse_help;

// Fill *args from the command line, argv[0] being skipped. Returns 0, or -1 with one sentence in *error. After -h or
// --version the rest of the line is not looked at.
int cli_parse_args(struct cli_args *args, int argc, char **argv, struct cli_error *error);
void cli_free_args(struct cli_args *args);

// 1 if a name ends in .exr, whatever its case.
int cli_is_exr(const char *path);

#endif
