// SPDX-License-Identifier: BSD-3-Clause
// One frame: open its file, set up its views, render each by its own depth, write them.
#ifndef HF_CLI_FRAME_H
#define HF_CLI_FRAME_H

#include "tools/cli/depth.h"
#include "tools/cli/setup.h"
#include "tools/common/report.h"

// The library and threads for files, kept from frame to frame, and what the library said last.
struct cli_session {
    struct hf_context *context;
    struct hf_io_run run;
    struct tool_error log;
    const char *label;  // what is being rendered, for warnings
    int warnings;       // that the library gave of it
    char *said;         // what they were, a line each; NULL: none
};

// Up to this radius, pixels, one may say that something is in focus: half a pixel to each side.
static const float CLI_SHARP_RADIUS = 1;
// Below this one, nobody sees that there is blur.
static const float CLI_SEEN_RADIUS = 0.1f;

struct cli_view {
    int index;  // in the file
    const struct hf_io_view *view;
    char *tag;    // what tells it from others of the frame: "left", "Foreground.Combined"; "" when it is the only one
    char *label;  // "shot.exr", "shot.exr, view left"
    struct cli_setup setup;
    float *depth;  // NULL: not read yet, or not needed any more
    float *planes[4];
    int map_size[2];  // width and height of the depth file, which was scaled; 0: it was not
    int scaled_to[2];
    struct cli_depth_found found;
    long long sharpened, smoothed;  // samples of depth, see --depth-edges
    int map_bits;                   // of the depth file's whole numbers; 0: floats, or no such file
    float least_radius;             // pixels: the surface that is least blurred
    float range[2];     // distances of the nearest surface and the farthest, see cli_coc_measure; [0] > [1]: not known
    float blend[2];     // gaussian: how much of its one blur is mixed in at most, in front of the focus and behind
    float least_reach;  // of all that is blurred at all
    float far_away;     // radius of what is infinitely far
    float *radii;       // of all pixels, see cli_coc_look; NULL
    int warned;         // times by the library
    char *said;         // what it said then, a line each; NULL: nothing
    uint64_t highlights;  // pixels above --highlight-threshold, if they are to be raised
    int whole;            // --grow: the data window was as large as it may get
    int cut;              // pixels by which the blur reaches beyond the data window, and is lost
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
    int loaded;    // the pixels are there
    int in_place;  // OUTPUT is INPUT, also through links
    int alone;     // no frame of a shot
    double ms[CLI_STAGES];
    struct hf_io_written written;
};

// Start the library, on some threads (0: one per processor). Returns 0, or an exit code with *error filled.
int cli_session_open(struct cli_session *session, const struct cli_args *args, int threads, struct tool_error *error);
void cli_session_close(struct cli_session *session);

// The steps, in order; plan, which looks at the pictures but renders nothing, in place of render. Each returns 0, or an
// exit code with *error filled; close after any of them.
int cli_frame_open(struct cli_frame *frame, const struct cli_args *args, const struct hf_io_run *run,
                   struct tool_error *error);
// The focus of the first view, only the rows of depth around it being decoded. In place of the others.
int cli_frame_focus(struct cli_frame *frame, float *focus, struct tool_error *error);
int cli_frame_setup(struct cli_frame *frame, struct tool_error *error);
int cli_frame_plan(struct cli_frame *frame, struct cli_session *session, struct tool_error *error);
int cli_frame_render(struct cli_frame *frame, struct cli_session *session, struct tool_error *error);
// The new file in memory, with some texts in its header; then to the disk.
int cli_frame_encode(struct cli_frame *frame, const struct hf_io_text *texts, int text_count, struct tool_error *error);
int cli_frame_save(struct cli_frame *frame, struct tool_error *error);
void cli_frame_close(struct cli_frame *frame);

#endif
