// SPDX-License-Identifier: BSD-3-Clause
#include "frame/budget.h"

#include "frame/ladder.h"

#include <math.h>

// A cheaper setting follows after OVER frames beyond the budget. A better one follows after PATIENCE frames with room
// for it, twice as many each time that it turned out too slow.
enum { OVER = 2, PATIENCE = 12, MOST_PATIENCE = 192 };
// The better setting is tried if it is expected to take at most this part of the budget. The rest is hysteresis.
static const float ROOM = 0.8f;

int hf_budget_ladder(const struct hf_params *asked, float radius, struct hf_params ladder[HF_BUDGET_STEPS])
{
    const float ms = hf_ladder_ms(asked), far = fminf(radius, hf_ladder_farthest(asked));
    int n = 0;
    ladder[n++] = *asked;
    for (int i = hf_ladder_steps - 1; i >= 0 && n < HF_BUDGET_STEPS; i--) {
        if (hf_ladder[i].ms >= ms)
            continue;
        struct hf_params *p = &ladder[n];
        *p = *asked;
        hf_ladder_apply(p, i);
        hf_ladder_reshape(p);
        n += hf_ladder_farthest(p) >= far;
    }
    return n;
}

// A hash of all that the ladder depends on.
static uint64_t hash_of(const struct hf_params *ladder, int steps)
{
    uint64_t hash = (uint64_t)steps;
    for (int i = 0; i < steps; i++) {
        hash = (hash ^ hf_ladder_hash(&ladder[i])) * UINT64_C(0x9e3779b97f4a7c15);
        hash ^= hash >> 31;
    }
    return hash | 1;
}

static void enter(struct hf_budget *b, int step)
{
    b->climbed = step < b->step;
    b->step = step;
    b->frames = b->over = b->calm = 0;
    b->ms = b->above = 0;
}

int hf_budget_choose(struct hf_budget *b, const struct hf_params *ladder, int steps)
{
    const uint64_t asked = hash_of(ladder, steps);
    if (b->asked != asked)
        *b = (struct hf_budget){.asked = asked, .patience = PATIENCE, .told = b->told};
    return b->step;
}

static void step_down(struct hf_budget *b)
{
    const float above = b->ms;
    if (b->climbed && b->frames < PATIENCE)  // the climb failed
        b->patience = 2 * b->patience < MOST_PATIENCE ? 2 * b->patience : MOST_PATIENCE;
    enter(b, b->step + 1);
    b->above = above;
}

void hf_budget_note(struct hf_budget *b, float budget_ms, int steps, float ms)
{
    // The first frame at a step pays for its memory.
    if (b->frames++ == 0)
        return;
    if (b->frames == 2) {
        b->ms = ms;
        if (b->above > 0)
            b->ratio[b->step] = b->above > ms ? b->above / ms : 1;
    }
    b->ms += 0.5f * (ms - b->ms);
    b->over = ms > budget_ms ? b->over + 1 : 0;
    if (b->over >= OVER && b->step + 1 < steps) {
        step_down(b);
        return;
    }
    const int room = b->step > 0 && b->ms * b->ratio[b->step] <= ROOM * budget_ms;
    b->calm = room ? b->calm + 1 : 0;
    if (b->calm >= b->patience)
        enter(b, b->step - 1);
}

int hf_budget_missed(struct hf_budget *b, float budget_ms, int steps)
{
    const int missed = b->step + 1 == steps && b->over >= OVER && b->told != budget_ms;
    if (missed)
        b->told = budget_ms;
    return missed;
}

const char *hf_budget_options(const struct hf_params *asked, const struct hf_params *step)
{
    for (int i = 0; i < hf_ladder_steps; i++) {
        struct hf_params p = *asked;
        hf_ladder_apply(&p, i);
        hf_ladder_reshape(&p);
        if (hf_ladder_hash(&p) == hf_ladder_hash(step))
            return hf_ladder[i].options;
    }
    return NULL;
}
