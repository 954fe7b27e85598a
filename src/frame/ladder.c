// SPDX-License-Identifier: BSD-3-Clause
#include "frame/ladder.h"

#include <math.h>
#include <string.h>

#include "frame/budget.h"
#include "frame/defaults.h"
#include "pass/engine.h"
#include "frame/defaults.h"
#include "frame/ladder_fields.h"
#include "frame/ladder_table.h"

// Steps change the defaults.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Woverride-init"
const struct hf_ladder_step hf_ladder[] = {HF_LADDER_STEPS};
#pragma GCC diagnostic pop
_Static_assert(sizeof hf_ladder / sizeof *hf_ladder < HF_BUDGET_STEPS, "a budget may step to all of them");
const int hf_ladder_steps = sizeof hf_ladder / sizeof *hf_ladder;
const float hf_ladder_engine_ms[HF_ENGINE_COUNT] = {HF_LADDER_ENGINES};
const int hf_ladder_quality[] = {HF_LADDER_QUALITIES};
const char hf_ladder_measured[] = HF_LADDER_MEASURED;

void hf_ladder_set(struct hf_params *p, const struct hf_params *of)
{
#define SET(field) p->field = of->field;
    HF_LADDER_FIELDS(SET)
#undef SET
}

void hf_ladder_apply(struct hf_params *p, int step)
{
    hf_ladder_set(p, &hf_ladder[step].params);
}

uint64_t hf_ladder_hash(const struct hf_params *p)
{
#define VALUE(field) (double)p->field,
    const double values[] = {HF_LADDER_FIELDS(VALUE)};
#undef VALUE
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        hash = (hash ^ bits) * UINT64_C(0x100000001b3);
        hash ^= hash >> 29;
    }
    return hash;
}

void hf_ladder_reshape(struct hf_params *p)
{
    const unsigned drawn = hf_engine_def(p->engine)->limits.aperture;
    const struct hf_aperture_params *disc = &hf_params_defaults.aperture;
    struct hf_aperture_params *a = &p->aperture;
    if (!(drawn & HF_APERTURE_BLADES))
        a->blades = disc->blades;
    if (!(drawn & HF_APERTURE_ROUNDNESS))
        a->roundness = disc->roundness;
    if (!(drawn & HF_APERTURE_RING))
        a->ring = disc->ring;
    if (!(drawn & HF_APERTURE_CAT_EYE))
        a->cat_eye = disc->cat_eye;
    if (!(drawn & HF_APERTURE_SQUEEZE))
        a->squeeze = disc->squeeze;
    if (!(drawn & HF_APERTURE_CHROMATIC))
        a->chromatic = disc->chromatic;
    if (!(drawn & HF_APERTURE_PICTURE))
        a->picture = disc->picture;
}

int hf_ladder_can_draw(const struct hf_params *p)
{
    struct hf_params other = *p;
    hf_ladder_reshape(&other);
    const struct hf_aperture_params *a = &p->aperture, *b = &other.aperture;
    return a->blades == b->blades && a->roundness == b->roundness && a->ring == b->ring && a->cat_eye == b->cat_eye &&
           a->squeeze == b->squeeze && a->chromatic == b->chromatic && a->picture == b->picture;
}

float hf_ladder_farthest(const struct hf_params *p)
{
    const struct hf_engine_def *e = hf_engine_def(p->engine);
    return e->limits.farthest ? e->limits.farthest(p) : INFINITY;
}

// The step that params equal, or -1.
static int step_of(const struct hf_params *p)
{
#define SAME(field) &&p->field == of->field
    for (int i = 0; i < hf_ladder_steps; i++) {
        const struct hf_params *of = &hf_ladder[i].params;
        if (1 HF_LADDER_FIELDS(SAME))
            return i;
    }
#undef SAME
    return -1;
}

float hf_ladder_ms(const struct hf_params *p)
{
    const int step = step_of(p);
    return step >= 0                            ? hf_ladder[step].ms
           : hf_ladder_engine_ms[p->engine] > 0 ? hf_ladder_engine_ms[p->engine]
                                                : INFINITY;
}
