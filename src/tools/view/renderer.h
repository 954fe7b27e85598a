// SPDX-License-Identifier: BSD-3-Clause
// Makes pictures on a thread of its own. The newest request wins: what is made for an older one at rest is cancelled.
#ifndef HF_VIEW_RENDERER_H
#define HF_VIEW_RENDERER_H

#include "tools/common/report.h"
#include "tools/view/level.h"
#include "tools/view/picture.h"
#include "tools/view/show.h"

enum { VIEW_BUFFER = 64 };

struct view_request {
    unsigned serial;               // set by view_renderer_ask
    struct view_picture *picture;  // view_renderer_ask takes a reference of its own
    struct hf_params params;       // of the whole picture
    struct hf_depth depth;
    struct hf_region seen;  // the visible part, full-size pixels
    int n;                  // it is seen at 1/n of its size
    int moving;             // more will follow: the quick step is enough
    float gain;             // of the exposure
    enum view_show show;
    char buffer[VIEW_BUFFER];  // which one, with VIEW_SHOW_BUFFER
    double asked_ms;           // tool_now_ms of the event
};

struct view_result {
    unsigned serial;
    struct view_picture *picture;
    enum view_stage stage;
    int failed;  // error says why, and nothing but serial, picture and stage counts
    struct tool_error error;
    int n;                // pixels are 1/n of the picture's
    struct hf_region at;  // in such pixels
    float *plane[3];      // linear colour
    uint32_t *pixels;     // for the display, rows of at.width
    float gain;
    enum view_show show;
    double ms, asked_ms;
    struct tool_report report;
    int width;       // of the whole picture, in such pixels
    uint8_t *tiles;  // enum hf_tile, if the request showed them; or NULL
    size_t tile_count;
    char *buffers;  // what the engine's buffers hold, a line for each, if the request showed one; or NULL
    int channels;   // of the buffer that plane holds; 0: it holds the picture
    int kind;       // of its values, for view_false_colour
};

struct view_renderer;

// deliver is called on the main thread, and owns its result.
struct view_renderer *view_renderer_open(int threads, enum hf_isa isa,
                                         void (*deliver)(void *cookie, struct view_result *), void *cookie,
                                         struct tool_error *error);
void view_renderer_close(struct view_renderer *r);
// Returns the request's number.
unsigned view_renderer_ask(struct view_renderer *r, const struct view_request *request);
// Nothing is wanted any more.
void view_renderer_stop(struct view_renderer *r);
// The serial of the last request that is done to its end, or was given up.
int view_renderer_busy(struct view_renderer *r);

void view_result_free(struct view_result *result);

#endif
