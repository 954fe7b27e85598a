// SPDX-License-Identifier: BSD-3-Clause
// One frame: open its file, set up its views, render each with its own depth, write the result.
#ifndef HF_CLI_FRAME_H
#define HF_CLI_FRAME_H

#include "tools/cli/depth.h"
#include "tools/cli/setup.h"
#include "tools/common/report.h"

// What stays open from frame to frame: the library's context and the threads for files. Also what the library logged
// last.
struct cli_session {
    struct hf_context *context;
    struct hf_io_run run;
    struct tool_error log;
    const char *label;  // names what is being rendered, in warnings
    int warnings;       // how many of them the library logged
    char *said;         // their texts, one per line; NULL: none
    double base;        // bytes that the process held before
};

// Up to this radius, pixels, one may say that something is in focus: half a pixel to each side.
static const float CLI_SHARP_RADIUS = 1;
// Nobody sees blur of a smaller radius, in pixels.
static const float CLI_SEEN_RADIUS = 0.1f;

// --guessed: the share of a view's light that was guessed, all of it and what lies beyond the frame, how far beyond blur reads
// there, pixels, and what the view has.
struct cli_guess {
    float share, beyond;
    int overscan, surfaces, deep;
};

struct cli_view {
    int index;  // in the file
    const struct hf_io_view *view;
    struct cli_view *surfaces;  // further pictures of its scene, see surfaces.h
    int surface_count;
    int samples_ready;        // of a deep view: their depths are what the library takes
    struct hf_io_file *file;  // of such a picture: the file that it is in, NULL: INPUT; that file's name; and where its
    const char *path;         // pixels are in the view's window
    struct hf_io_box place;
    char *tag;    // tells it from other views of the frame: "left", "Foreground.Combined"; "" if it is the only one
    char *label;  // "shot.exr", "shot.exr, view left"
    struct cli_setup setup;
    float *depth;  // NULL: not read yet, or not needed any more
    float *planes[4];
    int map_size[2];  // width and height of a depth file that was scaled; 0: none was
    int scaled_to[2];
    struct cli_depth_found found;
    long long sharpened, smoothed;  // samples of depth, see --depth-edges
    int map_bits;                   // bits of a depth file's whole numbers; 0: floats, or no depth file
    float least_radius;             // radius of the least blurred surface, pixels
    float range[2];     // distances of the nearest surface and the farthest, see cli_coc_measure; [0] > [1]: not known
    float blend[2];     // gaussian: largest share of its blur that is mixed in, in front of the focus and behind it
    float least_reach;  // how far everything that is blurred reaches at least
    float far_away;     // radius at infinite distance
    float *radii;       // of all pixels, see cli_coc_look; may be NULL
    int warned;         // how many warnings the library gave
    char *said;         // their texts, one per line; NULL: none
    uint64_t highlights;     // pixels of lamps, which --highlight-gain raises
    int lamps;               // how many lamps
    struct cli_guess guess;  // --guessed
    float *guesses;          // the share of each pixel
    int whole;               // --grow had nothing to do: the data window was as large as allowed
    int cut;                 // pixels that the blur reaches beyond the data window, where it is lost
    struct tool_report report;
    uint8_t *tiles;  // of the report; NULL unless asked for
};

// Where a frame's time goes. Only computing keeps threads busy; reading and writing wait for the disk.
enum cli_stage { CLI_READ, CLI_DECODE, CLI_DEFOCUS, CLI_ENCODE, CLI_WRITE, CLI_STAGES };
extern const char *const cli_stage_names[CLI_STAGES];

struct cli_frame {
    const struct cli_args *args;
    const struct hf_io_run *run;  // threads to decode and encode on
    struct hf_io_file *file;
    struct hf_io_output *output;
    struct cli_view *views;  // the selected ones, in the order of the file
    int view_count;
    struct hf_io_file **others;  // further files, those of --over or --peel
    int other_count;
    int loaded;    // the pixels are there
    int in_place;  // OUTPUT is INPUT, also through links
    int alone;     // no frame of a shot
    double ms[CLI_STAGES];
    struct hf_io_written written;
};

// Start the library, on some threads (0: one per processor). Returns 0, or an exit code with *error filled.
int cli_session_open(struct cli_session *session, const struct cli_args *args, int threads, struct tool_error *error);
void cli_session_close(struct cli_session *session);

// The steps of a frame, in order. cli_frame_plan stands in place of render: it reads the pictures but renders nothing.
// Each returns 0, or an exit code with *error filled. Call close after any of them.
int cli_frame_open(struct cli_frame *frame, const struct cli_args *args, const struct hf_io_run *run,
                   struct tool_error *error);
// Read the pixels of all views into their planes and depth, unless that was done. The steps below do it when they need them.
int cli_frame_load(struct cli_frame *frame, struct tool_error *error);
// Steps of that for one picture: make its planes, and ask for them; then, where they hold what was asked for, make its depth
// what the library takes. cli_view_free frees all that a view holds, except its further pictures.
int cli_view_want(struct cli_view *v, int depth, struct hf_io_want *want, struct tool_error *error);
int cli_view_prepare(struct cli_frame *frame, struct cli_view *v, struct tool_error *error);
void cli_view_free(struct cli_view *v);
// A view's colour, in its planes, as the library gets it: without its alpha where that is 1 everywhere, unless it is kept.
struct hf_image cli_view_image(const struct cli_view *v, int keep_alpha);
// In place of all steps: read the focus of the first view, decoding only the rows of depth around it.
int cli_frame_focus(struct cli_frame *frame, float *focus, struct tool_error *error);
// In place of all steps, too: what lies around --focus-at, see focus.h.
struct cli_around;
int cli_frame_around(struct cli_frame *frame, struct cli_around *around, struct tool_error *error);
int cli_frame_setup(struct cli_frame *frame, struct tool_error *error);
int cli_frame_plan(struct cli_frame *frame, struct cli_session *session, struct tool_error *error);
int cli_frame_render(struct cli_frame *frame, struct cli_session *session, struct tool_error *error);
// Encode makes the new file in memory, with the given texts in its header. Save writes it to the disk.
int cli_frame_encode(struct cli_frame *frame, const struct hf_io_text *texts, int text_count, struct tool_error *error);
int cli_frame_save(struct cli_frame *frame, struct tool_error *error);
void cli_frame_close(struct cli_frame *frame);

#endif
