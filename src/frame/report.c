// SPDX-License-Identifier: BSD-3-Clause
#include "frame/report.h"

#include "frame/buffers.h"

// Why a pass does not run everywhere.
static const char *reason(const struct hf_plan *p, const struct hf_setup *s, int pass)
{
    const struct hf_pass *def = &p->engine->passes[pass];
    if (s->blend == 0)
        return "no blur at all: the picture is copied";
    if (def->sweep == 1)
        return pass == 0 ? "the depth is not looked at" : "no blurred tile reads there";
    if (def->field == HF_NEAR)
        return "no near CoC within reach";
    if (def->field == HF_FAR)
        return "no far CoC";
    return "sharp: copied";
}

void hf_report_plan(struct hf_context *c, const struct hf_setup *s, const struct hf_counts *found)
{
    const struct hf_plan *p = &c->plan;
    const struct hf_engine_def *e = p->engine;
    struct hf_report *r = &c->report;
    double ms[HF_MAX_PASSES];
    *r = (struct hf_report){.engine = s->engine,
                            .resolution = s->resolution,
                            .budget_step = c->budget.step,
                            .tile_width = 2 * p->cell_width[2],
                            .tile_height = 2 * p->cell_height[2],
                            .columns = p->columns[2],
                            .rows = p->rows[2],
                            .tiles = p->tile_needs,
                            .passes = e->pass_count};
    if (e->rings && s->blend != 0)
        r->rings = e->rings(s);
    for (int i = 0; i < hf_plan_count(p, 2); i++)
        r->tile_count[s->blend == 0 ? 0 : p->tile_needs[i]]++;
    hf_cost_work(&c->work, p, s);
    hf_cost_predict(&c->cost, s, c->isa, c->threads, &c->work, ms);
    for (int i = 0; i < e->pass_count; i++) {
        struct hf_pass_report *row = &r->pass[i];
        *row = (struct hf_pass_report){
            .name = e->passes[i].name, .run = c->work.run[i], .all = c->work.all[i], .predicted_ms = ms[i]};
        if (row->run < row->all)
            row->skipped = reason(p, s, i);
        r->predicted_ms += ms[i];
    }
    if (e->measured) {
        r->near_radius = -found->radius_min;
        r->far_radius = found->radius_max;
    } else {
        r->near_radius = found->near_pixels ? s->max_radius * found->near_max : 0;
        r->far_radius = found->far_pixels ? s->max_radius * found->far_max : 0;
    }
    r->memory = hf_buffers_bytes(c, s, s->blend == 0 ? 0 : p->reads);
    r->memory_saved = hf_buffers_bytes(c, s, HF_FIELDS) - r->memory;
}

void hf_report_colour(struct hf_context *c)
{
    struct hf_report *r = &c->report;
    r->colour_known = r->opaque = 1;
    for (int i = 0; i < c->threads; i++) {
        const struct hf_counts *seen = &c->workers[i].looked;
        r->brightest = i == 0 || seen->brightest > r->brightest ? seen->brightest : r->brightest;
        r->opaque &= seen->alpha_min >= 1;
        r->not_finite += seen->colour_repaired;
    }
}

void hf_report_frame(struct hf_context *c, const struct hf_setup *s)
{
    struct hf_report *r = &c->report;
    for (int i = 0; i < r->passes; i++)
        r->pass[i].ms = c->stats.pass_ms[i];
    r->total_ms = c->stats.total_ms;
    hf_cost_learn(&c->cost, s, c->isa, c->threads, &c->work, c->stats.pass_ms);
}
