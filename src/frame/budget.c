// SPDX-License-Identifier: BSD-3-Clause
#include "frame/budget.h"

#include "frame/defaults.h"
#include "frame/ladder.h"

#include <math.h>

// A cheaper setting follows after OVER frames beyond the budget. A better one follows after PATIENCE frames with room
// for it, twice as many each time that it turned out too slow.
enum { OVER = 2, PATIENCE = 12, MOST_PATIENCE = 192 };
// The better setting is tried if it is expected to take at most this part of the budget. The rest is hysteresis.
static const float ROOM = 0.8f;
// The first frame at a step pays for its memory, up to this many times as long as the next. It counts as beyond the
// budget only if it is beyond that.
static const float COLD = 2.5f;

// Below the ladder: what blurs as far as any lens and costs less than the first step that does. It is far less accurate,
// so only a budget chooses it. ms: by the gather's in the ladder's table; frames of images/fence.exr and images/lights.exr
// took 0.53 to 0.67 of the gather's processor time.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Woverride-init"
static const struct hf_ladder_step beneath = {
    "--engine chapter --rings 3", 0, 0, 17.3f, {HF_PARAMS_DEFAULTS, .engine = HF_ENGINE_CHAPTER, .chapter.rings = 3}};
#pragma GCC diagnostic pop

static void apply(struct hf_params *p, const struct hf_params *asked, const struct hf_ladder_step *step)
{
    *p = *asked;
    hf_ladder_set(p, &step->params);
    hf_ladder_reshape(p);
}

static int is_beneath(const struct hf_params *p)
{
    return hf_ladder_hash(p) == hf_ladder_hash(&beneath.params);
}

// The milliseconds of a megapixel that a setting is known to take before any frame was measured; 0: not known.
static float table_ms(const struct hf_params *p)
{
    const float ms = is_beneath(p) ? beneath.ms : hf_ladder_ms(p);
    return ms < INFINITY ? ms : 0;
}

int hf_budget_ladder(const struct hf_params *asked, float radius, struct hf_params ladder[HF_BUDGET_STEPS])
{
    const float ms = is_beneath(asked) ? beneath.ms : hf_ladder_ms(asked);
    const float far = fminf(radius, hf_ladder_farthest(asked));
    float least = ms;
    int n = 0;
    ladder[n++] = *asked;
    for (int i = hf_ladder_steps - 1; i >= 0 && n < HF_BUDGET_STEPS; i--) {
        if (hf_ladder[i].ms >= ms)
            continue;
        apply(&ladder[n], asked, &hf_ladder[i]);
        if (hf_ladder_farthest(&ladder[n]) >= far) {
            least = hf_ladder[i].ms;
            n++;
        }
    }
    if (beneath.ms < least && n < HF_BUDGET_STEPS)
        apply(&ladder[n++], asked, &beneath);
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

int hf_budget_choose(struct hf_budget *b, const struct hf_params *ladder, int steps)
{
    const uint64_t asked = hash_of(ladder, steps);
    if (b->asked == asked)
        return b->step;
    *b = (struct hf_budget){.asked = asked, .patience = PATIENCE, .told = b->told};
    for (int i = 0; i < steps; i++)
        b->cost[i] = table_ms(&ladder[i]);
    // A setting that nobody measured is taken to cost what the next one does.
    for (int i = steps - 1; i >= 0; i--)
        if (!(b->cost[i] > 0))
            b->cost[i] = i + 1 < steps ? b->cost[i + 1] : 1;
    return b->step;
}

// What a frame at another step is expected to take, by what it takes now.
static float expected(const struct hf_budget *b, int step)
{
    return b->ms * b->cost[step] / b->cost[b->step];
}

static void enter(struct hf_budget *b, int step)
{
    b->climbed = step < b->step;
    b->from = b->step;
    b->from_ms = b->ms;
    b->step = step;
    b->frames = b->over = b->calm = 0;
    b->ms = 0;
}

// The first step below that is expected to keep the budget, or the last.
static void step_down(struct hf_budget *b, float budget_ms, int steps)
{
    int step = b->step + 1;
    if (b->climbed && b->frames < PATIENCE)  // the climb failed
        b->patience = 2 * b->patience < MOST_PATIENCE ? 2 * b->patience : MOST_PATIENCE;
    while (step + 1 < steps && expected(b, step) > budget_ms)
        step++;
    enter(b, step);
}

// The best step above that leaves room.
static int step_above(const struct hf_budget *b, float budget_ms)
{
    int step = 0;
    while (step < b->step && expected(b, step) > ROOM * budget_ms)
        step++;
    return step;
}

// The cost of this step, by what a frame took at the step before: the table is of other pictures and another machine.
static void learn(struct hf_budget *b)
{
    if (b->from != b->step && b->from_ms > 0)
        b->cost[b->step] = b->cost[b->from] * b->ms / b->from_ms;
}

void hf_budget_note(struct hf_budget *b, float budget_ms, int steps, float ms)
{
    if (b->frames++ == 0) {
        b->over = ms > COLD * budget_ms;
        return;
    }
    if (b->frames == 2) {
        b->ms = ms;
        learn(b);
    }
    b->ms += 0.5f * (ms - b->ms);
    b->over = ms > budget_ms ? b->over + 1 : 0;
    if (b->over >= OVER && b->step + 1 < steps) {
        step_down(b, budget_ms, steps);
        return;
    }
    const int above = step_above(b, budget_ms);
    b->calm = above < b->step ? b->calm + 1 : 0;
    if (b->calm >= b->patience)
        enter(b, above);
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
    for (int i = -1; i < hf_ladder_steps; i++) {
        const struct hf_ladder_step *of = i < 0 ? &beneath : &hf_ladder[i];
        struct hf_params p;
        apply(&p, asked, of);
        if (hf_ladder_hash(&p) == hf_ladder_hash(step))
            return of->options;
    }
    return NULL;
}
