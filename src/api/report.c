// SPDX-License-Identifier: BSD-3-Clause
// What a context tells of its last frame.
#include "frame/report.h"

#include "api/message.h"
#include "api/params.h"
#include "api/sized.h"
#include "hyperfocal/inspect.h"

// Fill the program's struct from own.
static int fill(struct hf_context *c, void *given, const void *own, const struct hf_sized *type, const char *argument)
{
    struct hf_message message;
    return hf_sized_out(given, own, type, argument, &message) ? hf_fail(c, &message) : HF_OK;
}

int hf_get_report(struct hf_context *c, struct hf_report *report)
{
    if (!c || !report)
        return HF_ERR_ARG;
    const struct hf_frame_report *r = &c->report;
    const struct hf_report own = {.budget_step = r->budget_step,
                                  .budget_steps = r->budget_steps,
                                  .near_radius = r->near_radius,
                                  .far_radius = r->far_radius,
                                  .memory = r->memory,
                                  .memory_needed = r->memory_needed,
                                  .predicted_ms = r->predicted_ms,
                                  .total_ms = r->total_ms,
                                  .memory_held = r->memory_held,
                                  .near_pixels = r->near_pixels,
                                  .sharp_pixels = r->sharp_pixels,
                                  .far_pixels = r->far_pixels,
                                  .colour_repaired = r->colour_repaired,
                                  .depth_repaired = r->depth_repaired,
                                  .no_surface = r->no_surface,
                                  .clamped = r->clamped,
                                  .guessed = r->guessed};
    return fill(c, report, &own, &hf_sized_report, "report");
}

int hf_get_used(struct hf_context *c, struct hf_params *params, struct hf_resolved *resolved)
{
    if (!c)
        return HF_ERR_ARG;
    const struct hf_resolved own = hf_resolved_of(&c->report.used, c->report.picture);
    const int err = fill(c, params, &c->report.used.params, &hf_sized_params, "params");
    return err ? err : fill(c, resolved, &own, &hf_sized_resolved, "resolved");
}

int hf_get_problem(const struct hf_context *c, struct hf_message *message)
{
    struct hf_message problem;
    return c && message ? hf_sized_out(message, &c->problem, &hf_sized_message, "message", &problem) : HF_ERR_ARG;
}

int hf_inspect_get_report(struct hf_context *c, struct hf_inspect_report *report)
{
    static const struct hf_sized type = HF_SIZED(hf_inspect_report, budget_options);
    if (!c || !report)
        return HF_ERR_ARG;
    const struct hf_frame_report *r = &c->report;
    struct hf_inspect_report own = {.tile_width = r->tile_width,
                                    .tile_height = r->tile_height,
                                    .columns = r->columns,
                                    .rows = r->rows,
                                    .passes = r->passes,
                                    .hidden_levels = r->hidden_levels,
                                    .colour_known = r->colour_known,
                                    .brightest = r->brightest,
                                    .opaque = r->opaque,
                                    .not_finite = r->not_finite,
                                    .memory_saved = r->memory_saved,
                                    .plan_ms = r->plan_ms,
                                    .budget_options = r->budget_options};
    for (int i = 0; i < 4; i++) {
        own.tile_count[i] = r->tile_count[i];
        own.slices[i] = r->slices[i];
    }
    return fill(c, report, &own, &type, "report");
}

int hf_inspect_get_pass(struct hf_context *c, int pass, struct hf_inspect_pass *report)
{
    static const struct hf_sized type = HF_SIZED(hf_inspect_pass, ms);
    if (!c || !report || pass < 0 || pass >= c->report.passes)
        return HF_ERR_ARG;
    const struct hf_frame_pass *p = &c->report.pass[pass];
    const struct hf_inspect_pass own = {.name = p->name,
                                        .skipped = p->skipped,
                                        .run = p->run,
                                        .all = p->all,
                                        .ran = p->ran,
                                        .predicted_ms = p->predicted_ms,
                                        .ms = p->ms};
    return fill(c, report, &own, &type, "report");
}

size_t hf_inspect_tiles(const struct hf_context *c, uint8_t *tiles, size_t size)
{
    return c ? hf_report_tiles(c, tiles, size) : 0;
}

void hf_inspect_colour(struct hf_context *c, int on)
{
    if (c)
        c->colour_stats = on != 0;
}

void hf_inspect_dump(struct hf_context *c, void (*fn)(void *cookie, const struct hf_inspect_buffer *buffer),
                     void *cookie)
{
    if (!c)
        return;
    c->dump = fn;
    c->dump_cookie = cookie;
}
