// SPDX-License-Identifier: BSD-3-Clause
#include "frame/report.h"

#include <math.h>
#include <string.h>

#include "frame/buffers.h"

// The reason why a pass does not run everywhere.
static const char *reason(const struct hf_plan *p, const struct hf_setup *s, int pass)
{
    const struct hf_pass *def = &p->engine->passes[pass];
    if (!hf_plan_pass_runs(p, s, pass))
        return "the settings do not call for it";
    if (def->sweep == 1)
        return pass == 0 ? "the depth is not looked at" : "no blurred tile reads there";
    if (def->field == HF_NEAR)
        return "no near CoC within reach";
    if (def->field == HF_FAR)
        return "no far CoC";
    return "sharp: copied";
}

static void add_counts(struct hf_counts *sum, const struct hf_counts *c)
{
    sum->near_pixels += c->near_pixels;
    sum->far_pixels += c->far_pixels;
    sum->sharp_pixels += c->sharp_pixels;
    sum->colour_repaired += c->colour_repaired;
    sum->depth_repaired += c->depth_repaired;
    sum->no_surface += c->no_surface;
    sum->clamped += c->clamped;
    sum->guessed += c->guessed;
    sum->looked_at += c->looked_at;
    sum->near_max = c->near_max > sum->near_max ? c->near_max : sum->near_max;
    sum->far_max = c->far_max > sum->far_max ? c->far_max : sum->far_max;
    sum->radius_min = c->radius_min < sum->radius_min ? c->radius_min : sum->radius_min;
    sum->radius_max = c->radius_max > sum->radius_max ? c->radius_max : sum->radius_max;
    for (int i = 0; i < 2; i++) {
        sum->largest[i] = c->largest[i] > sum->largest[i] ? c->largest[i] : sum->largest[i];
        sum->exponents[i] |= c->exponents[i];
    }
    sum->transparent += c->transparent;
}

struct hf_counts hf_report_counts(const struct hf_context *c)
{
    struct hf_counts sum = {.radius_min = HUGE_VALF, .radius_max = -HUGE_VALF};
    for (int i = 0; i < c->threads; i++)
        add_counts(&sum, &c->workers[i].counts);
    return sum;
}

// All but the buffers.
static size_t memory_beside(const struct hf_context *c)
{
    return sizeof *c + c->chunks.size + c->tiles.size + c->queue.memory.size + c->joined.size + c->repairs.size +
           c->surfaces.size + c->samples.size + hf_engines_bytes(c) + (c->pool ? hf_pool_bytes(c->threads) : 0) +
           (size_t)c->threads * sizeof *c->workers;
}

static size_t memory_held(const struct hf_context *c)
{
    size_t bytes = memory_beside(c) + c->planes.size;
    for (int i = 0; i < c->threads; i++)
        bytes += c->workers[i].scratch.size;
    return bytes;
}

// Fill in what all frames have.
static void start_report(struct hf_context *c, const struct hf_setup *s)
{
    const struct hf_plan *p = &c->plan;
    struct hf_frame_report *r = &c->report;
    *r = (struct hf_frame_report){.used = *s->resolved,
                                  .picture = s->resolved->params.aperture.picture != NULL,
                                  .budget_step = c->budget.step,
                                  .tile_width = 2 * p->cells.width[2],
                                  .tile_height = 2 * p->cells.height[2],
                                  .columns = p->columns[2],
                                  .rows = p->rows[2],
                                  .passes = p->engine->pass_count};
    r->used.params.aperture.picture = NULL;  // the caller's, and he may free it
    for (int i = 0; i < r->passes; i++)
        r->pass[i] = (struct hf_frame_pass){.name = p->engine->passes[i].name,
                                            .all = (uint32_t)hf_plan_count(p, p->engine->passes[i].sweep)};
}

void hf_report_copy(struct hf_context *c, const struct hf_setup *s)
{
    struct hf_frame_report *r = &c->report;
    start_report(c, s);
    r->tile_count[HF_TILE_SHARP] = (uint32_t)hf_plan_count(&c->plan, 2);
    for (int i = 0; i < r->passes; i++)
        r->pass[i].skipped = "no blur at all: the picture is copied";
    memset(c->plan.tile_needs, 0, r->tile_count[HF_TILE_SHARP]);
    r->memory = hf_buffers_bytes(c, s, 0);
    r->memory_needed = memory_beside(c) + hf_buffers_after(c, s, 0);
    r->memory_saved = hf_buffers_bytes(c, s, HF_FIELDS) - r->memory;
}

void hf_report_plan(struct hf_context *c, const struct hf_setup *s, const struct hf_counts *found)
{
    const struct hf_plan *p = &c->plan;
    const struct hf_engine_def *e = p->engine;
    struct hf_frame_report *r = &c->report;
    double ms[HF_MAX_PASSES];
    start_report(c, s);
    for (int i = 0; i < hf_plan_count(p, 2); i++)
        r->tile_count[p->tile_needs[i]]++;
    if (found->radius_min <= found->radius_max) {
        r->near_radius = found->radius_min < 0 ? -found->radius_min : 0;
        r->far_radius = found->radius_max > 0 ? found->radius_max : 0;
    } else {
        r->near_radius = found->near_pixels ? s->max_radius * found->near_max : 0;
        r->far_radius = found->far_pixels ? s->max_radius * found->far_max : 0;
    }
    hf_cost_work(&c->work, p, s, (const float[]){r->near_radius, r->far_radius});
    hf_cost_predict(&c->cost, s, c->isa, c->threads, &c->work, ms);
    for (int i = 0; i < e->pass_count; i++) {
        struct hf_frame_pass *row = &r->pass[i];
        row->run = c->work.run[i];
        row->predicted_ms = ms[i];
        if (row->run < row->all)
            row->skipped = reason(p, s, i);
        r->predicted_ms += ms[i];
    }
    if (e->own.tell)
        e->own.tell(s->own, r);
    r->memory = hf_buffers_bytes(c, s, p->reads);
    // Where the reach is known before the depth, buffers are there before it is looked at.
    r->memory_needed = memory_beside(c) + hf_buffers_after(c, s, s->measured ? p->reads : HF_FIELDS);
    r->memory_saved = hf_buffers_bytes(c, s, HF_FIELDS) - r->memory;
}

void hf_report_colour(struct hf_context *c)
{
    struct hf_frame_report *r = &c->report;
    r->colour_known = r->opaque = 1;
    for (int i = 0; i < c->threads; i++) {
        const struct hf_counts *seen = &c->workers[i].looked;
        r->brightest = i == 0 || seen->brightest > r->brightest ? seen->brightest : r->brightest;
        r->opaque &= seen->alpha_min >= 1;
        r->not_finite += seen->colour_repaired;
    }
}

void hf_report_frame(struct hf_context *c, double total_ms)
{
    struct hf_frame_report *r = &c->report;
    const struct hf_counts n = hf_report_counts(c);
    r->total_ms = total_ms;
    r->memory_held = memory_held(c);
    r->near_pixels = n.near_pixels;
    r->far_pixels = n.far_pixels;
    r->sharp_pixels = n.sharp_pixels;
    r->colour_repaired = n.colour_repaired;
    r->depth_repaired = n.depth_repaired;
    r->no_surface = n.no_surface;
    r->clamped = n.clamped;
    r->guessed = n.looked_at ? (double)n.guessed * 0x1p-24 / (double)n.looked_at : 0;
    for (int i = 0; i < r->passes; i++) {
        for (int k = 0; k < c->threads; k++) {
            r->pass[i].ms += (double)c->workers[k].ns[i] * 1e-6 / c->threads;
            r->pass[i].ran += c->workers[k].tiles[i];
        }
    }
}

void hf_report_learn(struct hf_context *c, const struct hf_setup *s)
{
    double ms[HF_MAX_PASSES] = {0};
    for (int i = 0; i < c->report.passes; i++)
        ms[i] = c->report.pass[i].ms;
    hf_cost_learn(&c->cost, s, c->isa, c->threads, &c->work, ms);
}

size_t hf_report_tiles(const struct hf_context *c, uint8_t *tiles, size_t size)
{
    const size_t n = (size_t)c->report.columns * (size_t)c->report.rows;
    if (n && tiles)
        memcpy(tiles, c->plan.tile_needs, size < n ? size : n);
    return n;
}
