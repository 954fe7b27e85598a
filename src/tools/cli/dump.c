// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/dump.h"

#include "tools/cli/target.h"
#include "hyperfocal/inspect.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void write_buffer(void *cookie, const struct hf_inspect_buffer *buffer)
{
    static const char *const names[5][4] = {{0}, {"Y"}, {"R", "G"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
    struct cli_dump *dump = cookie;
    struct hf_io_error io;
    const struct hf_io_planes planes = {.width = buffer->width,
                                        .height = buffer->height,
                                        .channels = buffer->channels,
                                        .names = names[buffer->channels],
                                        .data = buffer->data,
                                        .stride = buffer->stride / (ptrdiff_t)sizeof(float)};  // there in floats
    char *path;
    if (dump->failed)
        return;
    if (asprintf(&path, "%s/%s%s.exr", dump->dir, dump->prefix, buffer->name) < 0)
        path = NULL;
    // Make the directory only when there is a buffer to put into it.
    if (!path)
        dump->failed = tool_fail(&dump->error, 1, "--dump-passes %s: out of memory", dump->dir);
    else if (cli_check_overwrite(dump->args, "--dump-passes", path, &dump->error))
        dump->failed = 1;
    else if (mkdir(dump->dir, 0777) && errno != EEXIST)
        dump->failed = tool_fail(&dump->error, 1, "--dump-passes %s: %s", dump->dir, strerror(errno));
    else if (hf_io_write_planes(path, &planes, &io))
        dump->failed = tool_fail(&dump->error, 1, "%s", io.message);
    free(path);
}

void cli_dump_begin(struct cli_dump *dump, struct hf_context *context, const struct cli_frame *frame,
                    const struct cli_view *view)
{
    *dump = (struct cli_dump){.args = frame->args, .dir = frame->args->dump_dir};
    if (frame->view_count > 1 && view->tag[0])
        snprintf(dump->prefix, sizeof(dump->prefix), "%s.", view->tag);
    else if (frame->view_count > 1)
        snprintf(dump->prefix, sizeof(dump->prefix), "view%d.", view->index);
    // The view's name comes from the file; it must not lead out of the directory.
    for (char *c = dump->prefix; *c; c++)
        if (*c == '/')
            *c = '_';
    hf_inspect_dump(context, write_buffer, dump);
}

int cli_dump_end(struct cli_dump *dump, struct hf_context *context, const struct hf_image *image,
                 struct tool_error *error)
{
    const struct hf_inspect_buffer composite = {
        .name = "composite",
        .width = image->width,
        .height = image->height,
        .channels = image->data[3] ? 4 : 3,
        .data = {image->data[0], image->data[1], image->data[2], image->data[3]},
        .stride = image->stride[0],
    };
    hf_inspect_dump(context, NULL, NULL);
    write_buffer(dump, &composite);
    return dump->failed ? tool_fail(error, CLI_ALL_FAILED, "%s", dump->error.text) : 0;
}
