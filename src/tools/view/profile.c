// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/profile.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The block that the next frame belongs to; NULL without memory.
static struct view_profile_block *block_of(struct view_profile *p)
{
    if (p->block_count && p->blocks[p->block_count - 1].frames < PROFILE_BLOCK)
        return &p->blocks[p->block_count - 1];
    struct view_profile_block *more = realloc(p->blocks, ((size_t)p->block_count + 1) * sizeof(*more));
    if (!more)
        return NULL;
    p->blocks = more;
    more[p->block_count] = (struct view_profile_block){0};
    return &more[p->block_count++];
}

void view_profile_add(struct view_profile *p, const struct tool_report *report, double ms, double now_ms)
{
    struct view_profile_block *b = block_of(p);
    p->report = *report;
    p->last[p->count++ % PROFILE_SHOWN] = ms;
    if (b) {
        b->frames++;
        b->engine = report->params.engine;
        b->all += ms;
        b->interval += p->before_ms > 0 ? now_ms - p->before_ms : ms;
        for (int i = 0; i < report->inner.passes && i < TOOL_PASSES; i++)
            b->pass[i] += report->pass[i].ms;
    }
    p->before_ms = now_ms;
}

void view_profile_free(struct view_profile *p)
{
    free(p->blocks);
    *p = (struct view_profile){0};
}

int view_profile_write(const struct view_profile *p, const char *path, struct tool_error *error)
{
    FILE *out = fopen(path, "we");
    int failed = !out;
    for (int k = 0; k < p->block_count && out; k++) {
        const struct view_profile_block *b = &p->blocks[k];
        fprintf(out, "frames %d to %d: averages in milliseconds, engine %s\n", k * PROFILE_BLOCK + 1,
                k * PROFILE_BLOCK + b->frames, hf_engine_name(b->engine));
        for (int i = 0; i < TOOL_PASSES && hf_inspect_pass_name(b->engine, i); i++)
            fprintf(out, "    %-24s %8.3f\n", hf_inspect_pass_name(b->engine, i), b->pass[i] / b->frames);
        fprintf(out, "    %-24s %8.3f\n    %-24s %8.3f\n\n", "All", b->all / b->frames, "from frame to frame",
                b->interval / b->frames);
    }
    if (out) {
        failed = ferror(out) != 0;
        failed |= fclose(out) != 0;
    }
    return failed ? tool_fail(error, -1, "--profile %s cannot be written: %s", path, strerror(errno)) : 0;
}
