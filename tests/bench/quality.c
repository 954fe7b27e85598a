// SPDX-License-Identifier: BSD-3-Clause
// Steps of the ladder on the ray-traced scenes, from the first that can make their radii. A later step is never worse; each
// has the error that its table says; the first beats no blur, and the best comes closer to the truth than other programs.
//
//     quality images      the folder of the scenes
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "others.h"
#include "support/check.h"
#include "support/render.h"
#include "tools/common/report.h"

// A step of the ladder may be worse than the one before by 0.1 dB on a scene: trade_ladder's rule. Its mean is better by
// 0.2 dB or more (TRADE_STEP_DB): with errors in the table that are off by less than half of that, the order is right.
static const double SLACK = 0.1, TOLD_APART = 0.1;
// How much better than no blur the cheapest step must be, dB.
static const double WORTH = 3;

enum { SCENES = 3, MOST = 32 };
static const struct {
    const char *name;
    float focus, f_number;  // as in the header
} scenes[SCENES] = {{"lights", 5, 0.37f}, {"fence", 6, 0.46f}, {"foliage", 4, 0.7f}};

struct truth {
    struct picture in, depth, want;
};

static int read_scene(struct truth *t, const char *folder, const char *name)
{
    static const char *const rgb[] = {"R", "G", "B"}, *const z[] = {"Z"};
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.exr", folder, name);
    if (exr_read(&t->in, path, 3, rgb) || exr_read(&t->depth, path, 1, z))
        return -1;
    snprintf(path, sizeof path, "%s/%s.truth.exr", folder, name);
    return exr_read(&t->want, path, 3, rgb);
}

static double psnr_of(struct hf_context *c, const struct truth *t, int scene, struct hf_params p)
{
    const struct hf_depth depth = picture_depth(&t->depth);
    p.focus = scenes[scene].focus;
    p.lens.f_number = scenes[scene].f_number;
    struct picture out = render(c, &t->in, &depth, &p);
    const double psnr = display_psnr(&out, &t->want);
    picture_free(&out);
    return psnr;
}

// The step after *choice that can make any radius, as the scenes need; the first such step if *choice is empty.
// Returns 0 when there are no more.
static int next_step(struct hf_params *p, struct tool_choice *choice)
{
    const struct tool_choice before = *choice;
    if (before.inner.options && before.inner.step + 1 == before.inner.steps)
        return 0;
    *p = hf_default_params();
    p->model = HF_MODEL_LENS;
    const float error = before.inner.options ? before.all.error * 0.99999f : 1;
    CHECK_INT(tool_choose(720, NULL, p, HF_QUALITY_DRAFT, error, choice), HF_OK);
    return before.inner.options ? CHECK_INT(choice->inner.step, before.inner.step + 1)
                                : CHECK(choice->inner.step == choice->inner.passed);
}

static const struct bench_other *other(int scene)
{
    int i = 0;
    while (i + 1 < BENCH_OTHERS && strcmp(bench_others[i].scene, scenes[scene].name))
        i++;
    return &bench_others[i];
}

int main(int argc, char **argv)
{
    struct hf_context *c = NULL;
    struct tool_choice choice[MOST] = {0};
    struct hf_params step[MOST];
    double mean[MOST] = {0};
    int steps = 0;
    if (argc != 2 || !CHECK_INT(hf_open(&c, NULL), HF_OK))
        return 1;
    while (steps < MOST && next_step(&step[steps], &choice[steps])) {
        if (steps + 1 < MOST)
            choice[steps + 1] = choice[steps];
        steps++;
    }
    CHECK(steps > 1 && choice[0].inner.step + steps == choice[0].inner.steps);
    for (int s = 0; s < SCENES; s++) {
        struct truth t;
        const double others = fmax(other(s)->blender, other(s)->gegl);
        double last = other(s)->none + WORTH;
        if (!CHECK_MSG(read_scene(&t, argv[1], scenes[s].name) == 0, "cannot read %s", scenes[s].name))
            break;
        for (int i = 0; i < steps; i++) {
            const double psnr = psnr_of(c, &t, s, step[i]);
            CHECK_MSG(psnr >= last - SLACK, "%s: %s has %.2f dB, before it %.2f", scenes[s].name,
                      choice[i].inner.options, psnr, last);
            mean[i] += psnr / SCENES;
            last = psnr;
        }
        CHECK_MSG(last > others, "%s: the best has %.2f dB, another program %.2f", scenes[s].name, last, others);
        picture_free(&t.in);
        picture_free(&t.depth);
        picture_free(&t.want);
    }
    for (int i = 0; i < steps; i++)
        CHECK_MSG(fabs(mean[i] + 20 * log10(choice[i].all.error)) <= TOLD_APART,
                  "%s errs by %.2f dB, its table says %.2f: make the table anew", choice[i].inner.options, mean[i],
                  -20 * log10(choice[i].all.error));
    hf_close(&c);
    return check_report();
}
