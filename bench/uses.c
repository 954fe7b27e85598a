// SPDX-License-Identifier: BSD-3-Clause
// A frame in place beside one out of place, and the first frame of a context, with and without hf_prepare.
#include "measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PAIRS = 41, FIRSTS = 5 };

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static struct bench_row row_of(double ms[PAIRS])
{
    qsort(ms, PAIRS, sizeof *ms, by_value);
    return (struct bench_row){ms[PAIRS / 2], ms[0], ms[PAIRS - 1], -1};
}

// Milliseconds of a frame from src to dst; below 0 for an error.
static double frame_ms(const struct bench_subject *s, struct hf_context *c, const struct bench_image *src)
{
    const double start = bench_now();
    const int err = hf_render(c, &s->out.image, &src->image, &s->depth, &s->params);
    return err ? -1 : (bench_now() - start) * 1e3;
}

// In place what is drawn is blurred, so each frame begins with the picture as it was.
static double in_place_ms(const struct bench_subject *s, struct hf_context *c)
{
    memcpy(s->out.memory, s->in.memory, s->in.bytes);
    return frame_ms(s, c, &s->out);
}

static double first_ms(const struct bench_subject *s, int prepare)
{
    const struct hf_config config = {.threads = hf_context_threads(s->context), .isa = hf_context_isa(s->context)};
    struct hf_context *c;
    if (hf_open(&c, &config))
        return -1;
    const int err = prepare ? hf_prepare(c, &s->out.image, &s->out.image, &s->depth, &s->params) : HF_OK;
    const double ms = err ? -1 : in_place_ms(s, c);
    hf_close(&c);
    return ms;
}

int bench_measure_uses(const struct bench_subject *s, struct bench_uses *uses, struct bench_error *error)
{
    double in_place[PAIRS], out_of_place[PAIRS], first[FIRSTS], prepared[FIRSTS], least = 0;
    *uses = (struct bench_uses){0};
    if (s->in.image.format != s->out.image.format)
        return 0;
    for (int i = 0; i < PAIRS; i++) {
        in_place[i] = in_place_ms(s, s->context);
        out_of_place[i] = frame_ms(s, s->context, &s->in);
        least = fmin(least, fmin(in_place[i], out_of_place[i]));
    }
    for (int i = 0; i < FIRSTS; i++) {
        first[i] = first_ms(s, 0);
        prepared[i] = first_ms(s, 1);
        least = fmin(least, fmin(first[i], prepared[i]));
    }
    if (least < 0)
        return bench_fail(error, "a frame in place or the first of a context could not be rendered");
    qsort(first, FIRSTS, sizeof *first, by_value);
    qsort(prepared, FIRSTS, sizeof *prepared, by_value);
    *uses = (struct bench_uses){row_of(in_place), row_of(out_of_place), first[FIRSTS / 2], prepared[FIRSTS / 2]};
    return 0;
}
