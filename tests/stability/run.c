// SPDX-License-Identifier: BSD-3-Clause
#include "stability/stability.h"

#include <stdlib.h>
#include <string.h>

#include "support/check.h"

// alone: runs without a context, while the process has only this thread. A starting thread may hold the lock of a
// sanitizer's allocator when the process forks, and the child would wait for it forever. looks: runs over looks.c, on the
// widest instruction set, as other tests compare it with the C.
static const struct {
    const char *name;
    void (*alone)(const struct run *r);
    void (*run)(const struct run *r);
    int looks;
} groups[] = {
    {"samples", NULL, samples_cases, 0},       {"sizes", small_sizes_cases, sizes_cases, 0},
    {"invariance", NULL, invariance_cases, 0}, {"continuity", NULL, continuity_cases, 0},
    {"rounding", NULL, rounding_cases, 0},     {"silhouettes", NULL, silhouettes_cases, 0},
    {"pulls", NULL, pulls_cases, 1},           {"local", NULL, local_cases, 1},
    {"pairs", NULL, pairs_cases, 1},           {"lamps", NULL, lamps_cases, 1},
};

static void run_subject(const struct subject *s, int looks, const struct stability_options *o)
{
    for (int isa = HF_ISA_SCALAR; isa <= HF_ISA_NEON; isa++) {
        if (!hf_isa_available((enum hf_isa)isa) || (o->isa != HF_ISA_AUTO && o->isa != (enum hf_isa)isa))
            continue;
        struct run r = {.subject = s,
                        .isa = (enum hf_isa)isa,
                        .isa_name = hf_isa_name((enum hf_isa)isa),
                        .full = o->full,
                        .widest = o->isa != HF_ISA_AUTO || !hf_isa_available((enum hf_isa)(isa + 1)),
                        .seed = o->seed};
        for (size_t i = 0; i < sizeof groups / sizeof *groups && (!looks || r.widest); i++) {
            if (groups[i].looks != looks || (o->only && strcmp(o->only, groups[i].name)))
                continue;
            if (groups[i].alone)
                groups[i].alone(&r);
            r.c = context_new(r.isa, looks ? 1 : 2, 0, 0);
            if (r.c)
                groups[i].run(&r);
            hf_close(&r.c);
        }
    }
}

int stability_run(const struct stability_options *o)
{
    static struct subject subjects[64];  // rows keep pointers to their names
    int any = 0;
    stability_open_table();
    for (int i = 0; i < subject_count() + look_count(); i++) {
        const int looks = i >= subject_count();
        subjects[i] = looks ? look_make(i - subject_count()) : subject_make(i);
        if (o->engine && strncmp(o->engine, subjects[i].name, strlen(o->engine)))
            continue;
        any = 1;
        run_subject(&subjects[i], looks, o);
    }
    return any ? 0 : -1;
}

struct scene calm_scene(unsigned seed, int width, int height, int channels)
{
    struct rng rng = rng_seed(seed);
    struct scene s = scene_new(&rng, SCENE_BLOCKS, width, height, channels);
    for (int c = 0; c < channels; c++)
        for (int i = 0; i < width * height; i++) {
            const double x = i % width, y = i / width, z = s.depth.plane[0][i];
            const double phase = isfinite(z) ? z : 7;
            s.colour.plane[c][i] =
                c == 3 ? 1 : (float)(0.525 + 0.475 * sin(phase * (3 + c) + 0.31 * x) * cos(phase + 0.23 * y));
        }
    return s;
}

double display_code(double v)
{
    v = fmax(0, fmin(1, v));
    return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055);
}

double display_distance(const struct picture *a, const struct picture *b)
{
    const int marked = a->channels == 3 && a->plane[3] && b->plane[3];
    double most = 0;
    for (int c = 0; c < (a->channels < 3 ? a->channels : 3); c++)
        for (size_t i = 0; i < samples_of(a); i++)
            if (a->plane[c][i] != b->plane[c][i] && !(marked && a->plane[3][i] != b->plane[3][i]))
                most = worse(most, fabs(display_code(a->plane[c][i]) - display_code(b->plane[c][i])));
    return most;
}

// The largest sample of the rows or columns within 7 of each, one axis at a time; at least 1.
static float *brightest_around(const struct picture *a, const struct picture *b)
{
    enum { AROUND = 7 };
    const int w = a->width, h = a->height;
    float *most = malloc(samples_of(a) * sizeof *most), *line = malloc(samples_of(a) * sizeof *line);
    for (size_t i = 0; i < samples_of(a); i++) {
        line[i] = 1;
        for (int c = 0; c < 3; c++)
            line[i] = fmaxf(line[i], fmaxf(a->plane[c][i], b->plane[c][i]));
    }
    for (int axis = 0; axis < 2; axis++) {
        for (int i = 0; i < w * h; i++) {
            const int at = axis ? i / w : i % w, step = axis ? w : 1, end = axis ? h : w;
            most[i] = line[i];
            for (int k = -AROUND; k <= AROUND; k++)
                if (at + k >= 0 && at + k < end)
                    most[i] = fmaxf(most[i], line[i + k * step]);
        }
        memcpy(line, most, samples_of(a) * sizeof *line);
    }
    free(line);
    return most;
}

double exposed_distance(const struct picture *a, const struct picture *b)
{
    float *most = brightest_around(a, b);
    double worst = 0;
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < samples_of(a); i++)
            if (a->plane[c][i] != b->plane[c][i])
                worst =
                    worse(worst, fabs(display_code(a->plane[c][i] / most[i]) - display_code(b->plane[c][i] / most[i])));
    free(most);
    return worst;
}

struct large_steps large_steps(struct picture (*at)(void *cookie, double t),
                               double (*distance)(const struct picture *a, const struct picture *b), void *cookie,
                               double from, double to, int steps)
{
    struct large_steps large = {.width = (to - from) / steps};
    struct picture before = at(cookie, from);
    for (int i = 0; i < steps; i++) {
        struct picture now = at(cookie, from + (i + 1) * large.width);
        double d = distance(&before, &now), where = from + i * large.width;
        for (int k = 0; k < LARGE_STEPS; k++)
            if (d > large.change[k]) {
                const double old = large.change[k], old_place = large.place[k];
                large.change[k] = d, large.place[k] = where;
                d = old, where = old_place;
            }
        picture_free(&before);
        before = now;
    }
    picture_free(&before);
    return large;
}

double step_left(struct picture (*at)(void *cookie, double t),
                 double (*distance)(const struct picture *a, const struct picture *b), void *cookie, int halvings,
                 double *from, double *to)
{
    struct picture a = at(cookie, *from), b = at(cookie, *to);
    double left = distance(&a, &b);
    for (int i = 0; i < halvings; i++) {
        const float middle = (float)((*from + *to) / 2);
        if (middle == (float)*from || middle == (float)*to)
            break;
        struct picture m = at(cookie, middle);
        const double first = distance(&a, &m), second = distance(&m, &b);
        struct picture *gone = first > second ? &b : &a;
        picture_free(gone);
        *gone = m;
        *(first > second ? to : from) = middle;
        left = fmax(first, second);
    }
    picture_free(&a);
    picture_free(&b);
    return left;
}
