// SPDX-License-Identifier: BSD-3-Clause
// The command line of hyperfocal.
#ifndef HF_CLI_ARGS_H
#define HF_CLI_ARGS_H

#include <limits.h>

#include "hyperfocal/hyperfocal.h"
#include "tools/io/io.h"
#include "tools/common/options.h"

enum { CLI_DONE = 0, CLI_BAD_ARGUMENTS = 1, CLI_SOME_FAILED = 2, CLI_ALL_FAILED = 3 };

enum cli_focus {
    CLI_FOCUS_HEADER,    // not on the command line
    CLI_FOCUS_DISTANCE,  // --focus D
    CLI_FOCUS_CENTER,    // --focus center
    CLI_FOCUS_AT,        // --focus-at X,Y
    CLI_FOCUS_OBJECT,    // --focus-object NAME
    CLI_FOCUS_POINT,     // --focus-point X,Y,Z
};

enum { CLI_CENTRED = INT_MIN };  // a place in args->display

enum cli_keys_blend { CLI_KEYS_LINEAR, CLI_KEYS_SMOOTH };

// --guessed: not asked, with a channel of OUTPUT, or for --guessed-image alone.
enum cli_guessed { CLI_GUESSED_NOT, CLI_GUESSED_CHANNEL, CLI_GUESSED_IMAGE };

// What the command line asks for. Numbers that it does not give are NAN, texts NULL.
struct cli_args {
    const char **inputs;  // as given; input: that of the current frame
    int input_count;
    const char *input, *output;
    int help, version, dry_run;  // help: see tool_parser
    int verbose, quiet;

    // Fields that the command line sets as they are: engine, storage, max_radius, the flags, fill, blend, blades.
    // The model and what belongs to it depend on the file, see setup.h.
    struct hf_params params;

    int engine, quality;        // as given; -1: not given
    const char *chose_chapter;  // the option that made the gather the chapter (tool_choose_chapter), or NULL
    float max_error;            // NAN: not given

    enum cli_focus focus_by;
    int focus_given, focus_at_given;  // --focus in either form, --focus-at
    const char *focus_object;         // a name in the Cryptomatte
    float focus_point[3];             // of the world, scene units
    float focus;                      // scene units
    int focus_x, focus_y;             // EXR pixel coordinates

    float range, depth_of_field, strength, near_begin, near_end, far_begin, far_end;
    float fstop, focal_length, sensor_width, world_unit;
    int metric;  // some distance was given in metres

    float blur;                    // --blur: pixels; depth_type is then coc, which depth.c makes of what is there:
    int blur_typed;                // --depth-type says what that is, else the file's kind does
    enum hf_depth_type blur_type;  // as depth_type, and
    int blur_normalized;           // as normalized

    const char *depth_channel, *depth_file;
    enum hf_depth_type depth_type;  // as the library sees it, after cli_depth_prepare
    int normalized;                 // 1: a map from 0 at near_plane to 1 at far_plane; -1: the other way; else 0
    enum hf_io_edges depth_edges;
    float near_plane, far_plane;      // scene units
    float depth_scale, depth_offset;  // applied first, to the numbers as they are stored

    const char *aperture;       // as given
    const char *aperture_file;  // NULL: the shape in params

    // A shot: see shot.h, keys.h, track.h, batch.h.
    const char *frames, *chunk, *keys, *log_file;
    enum cli_keys_blend keys_blend;
    int focus_smooth;        // frames to each side; -1: not given
    int focus_per_view;      // each view has its own focus
    const char *focus_from;  // names what gave a frame its focus; NULL: --focus
    int print_focus, resume, stop_on_error;
    float memory_limit;  // GiB
    char *settings;      // the options that change pixels, as they were given

    const char *views;  // NULL: all, else names with commas
    const char *layer;  // likewise; NULL: the main one
    char *layers;       // what --layer gave several times, joined by commas: args->layer then
    // Other pictures of the scene, see surfaces.h: files of --over or --peel, or layers of --layer.
    const char **others;  // as given; of a frame: its own files
    int other_count;
    const char *other_option;  // "--over", "--peel"; NULL: there are none
    int merge;                 // --merge
    const char *compression;
    int zip_level;   // 0: not given
    int grow;        // --grow: enlarge the data window by the reach of the blur
    int display[4];  // width, height, and the picture's x, y in it; [0] = 0: the file's window
    const char *dump_dir;
    int explain;
    const char *explain_image, *focus_image, *guessed_image;
    int guessed;  // enum cli_guessed
    int json;
    const char *json_file;  // NULL: stdout
    const char *json_word;  // json_file if it was a word of its own, which may turn out to be INPUT
    int threads;
    enum hf_isa isa;
};

// All options, and the other parts of the help text.
extern const struct tool_program cli_program;

// Parsers of values that only this program has.
tool_parse cli_parse_depth_type, cli_parse_display, cli_parse_focus, cli_parse_focus_at, cli_parse_focus_object,
    cli_parse_focus_point, cli_parse_aperture, cli_parse_json, cli_parse_layer, cli_parse_other, cli_parse_version;

// 1 if the focus is read from the depth, so that cli_setup_view needs its pixels.
int cli_focus_needs_depth(const struct cli_args *args);
// Check that the engine uses --near and --far if they were given. Returns 0, or CLI_BAD_ARGUMENTS with one sentence in
// *error. cli_parse_args calls it when the command line names the engine, cli_setup_view when --quality chooses it.
int cli_check_planes(const struct cli_args *args, enum hf_engine engine, struct tool_error *error);
// 1 if the pictures of --over or --peel are peels.
int cli_others_peel(const struct cli_args *args);
// Fill *args from the command line; argv[0] is skipped. Returns 0, or -1 with one sentence in *error. Does not look at
// what follows -h or --version.
int cli_parse_args(struct cli_args *args, int argc, char **argv, struct tool_error *error);
void cli_free_args(struct cli_args *args);

// 1 if a name ends in .exr, whatever its case.
int cli_is_exr(const char *path);

#endif
