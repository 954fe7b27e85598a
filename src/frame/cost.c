// SPDX-License-Identifier: BSD-3-Clause
#include "frame/cost.h"

static uint64_t mix(uint64_t hash, uint64_t v)
{
    hash = (hash ^ v) * UINT64_C(0x9e3779b97f4a7c15);
    return hash ^ hash >> 29;
}

// A hash of the options that change the cost of a unit of work. Reaches count in steps of about an eighth, because
// similar ones cost the same.
static uint64_t key_of(const struct hf_setup *s, enum hf_isa isa)
{
    const int common[] = {(int)s->engine, s->channels, (int)s->storage, s->smoothstep, (int)s->form, s->lens, (int)isa};
    int own[HF_COST_NUMBERS], reach = 0;
    const struct hf_engine_cost *cost = &hf_engine_def(s->engine)->cost;
    const int count = cost->numbers ? cost->numbers(s, own, &reach) : 0;
    uint64_t hash = 1;
    for (size_t i = 0; i < sizeof common / sizeof *common; i++)
        hash = mix(hash, (uint64_t)common[i]);
    for (int i = 0; i < count; i++)
        hash = mix(hash, (uint64_t)own[i]);
    int scale = 0;
    for (; reach >= 16; reach /= 2)
        scale++;
    return mix(mix(hash, (uint64_t)reach), (uint64_t)scale) | 1;
}

static double area(struct hf_rect r)
{
    return (double)(r.x1 - r.x0) * (r.y1 - r.y0);
}

// The fields for which a pass runs in a cell of a sweep.
static unsigned fields_in(const struct hf_plan *p, const struct hf_pass *pass, int cell)
{
    const int inside = hf_rect_meets(hf_plan_cell(p, pass->sweep, cell), p->area[pass->sweep]);
    const unsigned fields = pass->sweep == 1                   ? p->chunk_reads[cell]
                            : hf_plan_is_tiled(p, pass->sweep) ? p->tile_needs[cell]
                            : inside                           ? p->needs
                                                               : 0;
    return pass->field ? fields & pass->field : fields;
}

// The active part of a cell.
static struct hf_rect cell_of(const struct hf_plan *p, int sweep, int cell)
{
    const struct hf_rect all = hf_plan_cell(p, sweep, cell);
    return hf_plan_is_tiled(p, sweep) ? hf_plan_active(p, cell) : sweep == 1 ? all : hf_rect_both(all, p->area[sweep]);
}

// The table's cost of a unit of work for one field. For a pass that serves both, the larger radius counts.
static double table_ns(const struct hf_plan *p, const struct hf_setup *s, int pass, unsigned field,
                       const float radius[2])
{
    const struct hf_pass *row = &p->engine->passes[pass];
    const float own = radius[field == HF_FAR], most = radius[0] > radius[1] ? radius[0] : radius[1];
    const float times = p->engine->cost.times ? p->engine->cost.times(s, pass, field, own) : 1;
    return (row->ns + row->ns_radius * (row->field ? own : most)) * times;
}

void hf_cost_work(struct hf_work *w, const struct hf_plan *p, const struct hf_setup *s, const float radius[2])
{
    *w = (struct hf_work){0};
    for (int i = 0; i < p->engine->pass_count; i++) {
        const struct hf_pass *pass = &p->engine->passes[i];
        w->all[i] = (uint32_t)hf_plan_count(p, pass->sweep);
        if (!hf_plan_pass_runs(p, s, i))
            continue;
        const double ns[] = {table_ns(p, s, i, HF_NEAR, radius), table_ns(p, s, i, HF_FAR, radius)};
        for (int cell = 0; cell < (int)w->all[i]; cell++) {
            const unsigned fields = i == 0 ? HF_NEAR : fields_in(p, pass, cell);
            w->run[i] += fields > 0;
            for (int f = 0; f < 2; f++)
                if (fields & (f ? HF_FAR : HF_NEAR)) {
                    w->units[i] += area(cell_of(p, pass->sweep, cell));
                    w->ns[i] += ns[f] * area(cell_of(p, pass->sweep, cell));
                }
        }
    }
}

static struct hf_cost_entry *find(struct hf_cost *c, uint64_t key)
{
    for (size_t i = 0; i < sizeof c->entry / sizeof *c->entry; i++)
        if (c->entry[i].key == key) {
            c->entry[i].used = ++c->clock;
            return &c->entry[i];
        }
    return NULL;
}

// How much slower this is than the table, which is for 16 floats per vector.
static float isa_factor(enum hf_isa isa)
{
    switch (isa) {
    case HF_ISA_SCALAR:
        return 12;
    case HF_ISA_SSE41:
    case HF_ISA_NEON:
        return 3;
    case HF_ISA_AVX2:
        return 1.5f;
    default:
        return 1;
    }
}

void hf_cost_predict(struct hf_cost *c, const struct hf_setup *s, enum hf_isa isa, int threads, const struct hf_work *w,
                     double ms[HF_MAX_PASSES])
{
    const struct hf_engine_def *e = hf_engine_def(s->engine);
    const struct hf_cost_entry *known = find(c, key_of(s, isa));
    for (int i = 0; i < HF_MAX_PASSES; i++) {
        ms[i] = 0;
        if (i >= e->pass_count)
            continue;
        const double ns = known && known->ns[i] > 0 ? known->ns[i] * w->units[i] : w->ns[i] * isa_factor(isa);
        ms[i] = 1e-6 * ns / threads;
    }
}

void hf_cost_learn(struct hf_cost *c, const struct hf_setup *s, enum hf_isa isa, int threads, const struct hf_work *w,
                   const double ms[HF_MAX_PASSES])
{
    const uint64_t key = key_of(s, isa);
    struct hf_cost_entry *e = find(c, key);
    if (!e) {
        e = &c->entry[0];
        for (size_t i = 1; i < sizeof c->entry / sizeof *c->entry; i++)
            if (c->entry[i].used < e->used)
                e = &c->entry[i];
        *e = (struct hf_cost_entry){.key = key, .used = ++c->clock};
    }
    // The first frame also pays for memory, so it counts only until there is another.
    const float share = e->frames < 2 ? 1 : 0.25f;
    e->frames++;
    for (int i = 0; i < HF_MAX_PASSES; i++)
        if (w->units[i] > 0) {
            const float ns = (float)(1e6 * ms[i] * threads / w->units[i]);
            e->ns[i] += (e->ns[i] > 0 ? share : 1) * (ns - e->ns[i]);
        }
}
