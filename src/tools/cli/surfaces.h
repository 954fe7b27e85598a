// SPDX-License-Identifier: BSD-3-Clause
// Several pictures of one scene: layers of INPUT (--merge), other files (--over), or what INPUT hides (--peel). Each has
// depth of its own. All are brought to the data window of the view that they belong to, which grows to hold them.
#ifndef HF_CLI_SURFACES_H
#define HF_CLI_SURFACES_H

#include "tools/cli/frame.h"

// Find the further pictures of each view: open their files, and take views that --merge makes one out of frame->views.
// Returns 0, or an exit code with *error filled.
int cli_surfaces_find(struct cli_frame *frame, struct tool_error *error);
// How many of them are in INPUT itself.
int cli_surfaces_inside(const struct cli_frame *frame);
// Read those in other files, and bring all to the window of their view. The views' own pixels must be there.
int cli_surfaces_load(struct cli_frame *frame, struct tool_error *error);
// The depth of what a view and its further pictures show together: of the nearest that fills half of a pixel. To be freed;
// NULL without memory. Peels never show.
float *cli_surfaces_depth(const struct cli_frame *frame, const struct cli_view *v);
// As hf_render, of the view with all of its pictures. *image, the view's own planes, becomes the result's.
int cli_surfaces_render(struct hf_context *c, const struct cli_args *args, struct cli_view *v, struct hf_image *image,
                        const struct hf_params *params);
// Render a view with all that it has into dst, which is none of its pictures. image: the view's colour. Returns what the library does.
int cli_surfaces_render_to(struct hf_context *c, const struct cli_frame *frame, struct cli_view *v,
                           const struct hf_image *image, const struct hf_image *dst, const struct hf_params *params);
// As hf_render, of a deep view.
int cli_deep_render(struct hf_context *c, const struct cli_frame *frame, struct cli_view *v,
                    const struct hf_image *image, const struct hf_params *params);
// "bg.exr, layer Far" or, of a layer of INPUT, "layer Far".
const char *cli_surface_name(const struct cli_view *surface, char *buf, size_t size);
// Bytes that they come to hold, beside the views' own.
double cli_surfaces_bytes(const struct cli_frame *frame);
void cli_surfaces_close(struct cli_frame *frame);

#endif
