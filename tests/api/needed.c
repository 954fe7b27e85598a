// SPDX-License-Identifier: BSD-3-Clause
// The memory that hf_plan announces for a frame, compared with what the context's allocator counts.
//
//     needed [seed]
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/looks.h"
#include "support/render.h"

enum { HEAD = 64 };  // bytes before a block, where its size lies

static void *take(void *cookie, size_t size, size_t align)
{
    void *p = NULL;
    if (posix_memalign(&p, align < HEAD ? HEAD : align, size + HEAD))
        return NULL;
    *(size_t *)p = size;
    *(size_t *)cookie += size;
    return (char *)p + HEAD;
}

static void give(void *cookie, void *p)
{
    char *start = (char *)p - HEAD;
    *(size_t *)cookie -= *(size_t *)(void *)start;
    free(start);
}

// One context renders frames of several sizes: memory that it holds from earlier frames counts.
static void try_look(struct rng *rng, int look)
{
    static const int sizes[][2] = {{70, 50}, {640, 360}, {33, 400}, {900, 500}, {1, 1}};
    size_t held = 0;
    const struct hf_config config = {
        .size = sizeof(config), .threads = 1 + rng_below(rng, 3), .alloc = take, .free = give, .alloc_cookie = &held};
    struct hf_context *c = NULL;
    CHECK_INT(hf_open(&c, &config), HF_OK);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const int width = sizes[i][0], height = sizes[i][1];
        struct scene s =
            scene_new(rng, (enum scene_kind)rng_below(rng, SCENE_KINDS), width, height, 3 + rng_below(rng, 2));
        struct picture out = picture_new(width, height, s.colour.channels);
        const struct hf_params p = look_params(&looks[look], width, 20);
        const struct hf_depth depth = picture_depth(&s.depth);
        const struct hf_image dst = picture_image(&out), src = picture_image(&s.colour);
        struct hf_report report = {.size = sizeof(report)};
        CHECK_INT(hf_plan(c, &dst, &src, &depth, &p, &report), HF_OK);
        CHECK_INT(hf_render(c, &dst, &src, &depth, &p), HF_OK);
        CHECK_MSG(held <= report.memory_needed && report.memory_needed <= held + held / 10,
                  "%s, %d x %d, %d threads: %zu bytes are told, %zu are held", looks[look].name, width, height,
                  config.threads, report.memory_needed, held);
        scene_free(&s);
        picture_free(&out);
    }
    hf_close(&c);
    CHECK_MSG(held == 0, "%zu bytes are not given back", held);
}

int main(int argc, char **argv)
{
    struct rng rng = rng_seed(argc > 1 ? (unsigned)atoi(argv[1]) : 1);
    for (int i = 0; i < LOOKS; i++)
        try_look(&rng, i);
    return check_report();
}
