// SPDX-License-Identifier: BSD-3-Clause
// Pictures whose results must be related, for every look, in codes of a display: exposure, mirrored, transposed.
#include "stability/stability.h"

#include "support/check.h"

enum { WIDTH = 72, HEIGHT = 56 };

// Half a code: nobody sees the difference.
static const double SAME = 0.5;
static const char *const same = "half a code";

static struct picture made(const struct run *r, const struct picture *colour, const struct picture *depth)
{
    struct hf_params p = r->subject->params;
    const struct hf_depth d = picture_depth(depth);
    return render(r->c, colour, &d, &p);
}

static void exposed(const struct run *r, const struct scene *s, enum stage stage)
{
    static const float factors[] = {1 / 16.0f, 16};
    struct picture whole = made(r, &s->colour, &s->depth);
    for (int i = 0; i < 2; i++) {
        struct picture other = picture_copy(&s->colour);
        for (int c = 0; c < 3; c++)
            for (size_t k = 0; k < samples_of(&other); k++)
                other.plane[c][k] *= factors[i];
        struct picture out = made(r, &other, &s->depth);
        for (int c = 0; c < 3; c++)
            for (size_t k = 0; k < samples_of(&out); k++)
                out.plane[c][k] /= factors[i];
        see_look(r, "exposure by 1/16 and 16: difference, codes", same, exposed_distance(&whole, &out), SAME,
                 "%s, times %g", stage_name(stage), factors[i]);
        picture_free(&out);
        picture_free(&other);
    }
    picture_free(&whole);
}

static void turned(const struct run *r, const struct scene *s, enum stage stage,
                   struct picture (*turn)(const struct picture *p), const char *what)
{
    struct scene t = {turn(&s->colour), turn(&s->depth)};
    struct picture a = made(r, &s->colour, &s->depth), b = made(r, &t.colour, &t.depth), back = turn(&b);
    see_look(r, what, same, exposed_distance(&a, &back), SAME, "%s", stage_name(stage));
    picture_free(&a);
    picture_free(&b);
    picture_free(&back);
    scene_free(&t);
}

void pairs_cases(const struct run *r)
{
    for (unsigned seed = r->seed; seed < r->seed + (r->full ? 10 : 2); seed++)
        for (int k = 0; k < STAGES; k++) {
            struct scene s = stage_make((enum stage)k, seed, WIDTH, HEIGHT);
            exposed(r, &s, (enum stage)k);
            if (r->subject->promises & MIRRORS)
                turned(r, &s, (enum stage)k, picture_flipped, "mirrored: difference, codes");
            if (r->subject->promises & TURNS)
                turned(r, &s, (enum stage)k, picture_transposed, "transposed: difference, codes");
            scene_free(&s);
        }
}
