// SPDX-License-Identifier: BSD-3-Clause
// A program as users write them, to be compiled with headers of one release and run with the library of another. Every struct
// that the library fills lies between canaries. With WANT=HF_ERR_ARG or HF_ERR_ABI it expects to be refused with a reason, and
// with -DLATER=V it sets the field `later` that the test has appended to two structs.
#include <string.h>

#include "hyperfocal/hyperfocal.h"
#include "support/check.h"

#ifndef WANT
#define WANT HF_OK
#endif

enum { WIDTH = 32, HEIGHT = 16, AROUND = 64, CANARY = 0xa5 };

// A struct of the program between canaries.
#define GUARDED(type)                                                                                                  \
    static struct {                                                                                                    \
        unsigned char before[AROUND];                                                                                  \
        struct hf_##type it;                                                                                           \
        unsigned char behind[AROUND];                                                                                  \
    } type

GUARDED(params);
GUARDED(report);
GUARDED(resolved);
GUARDED(choice);
GUARDED(message);
GUARDED(region);

static const struct {
    const char *name;
    unsigned char *before, *behind;
    size_t *size, own;
} all[] = {
#define ENTRY(type)                                                                                                    \
    {                                                                                                                  \
#type, type.before, type.behind, &type.it.size, sizeof type.it                                                 \
    }
    ENTRY(params), ENTRY(report), ENTRY(resolved), ENTRY(choice), ENTRY(message), ENTRY(region),
#undef ENTRY
};
enum { STRUCTS = sizeof all / sizeof *all };

static float colour[HEIGHT][WIDTH][4], blurred[HEIGHT][WIDTH][4], distances[HEIGHT][WIDTH];

static void begin(void)
{
    for (int i = 0; i < STRUCTS; i++) {
        memset(all[i].before, CANARY, AROUND + all[i].own + AROUND);
        *all[i].size = all[i].own;
    }
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            distances[y][x] = x < WIDTH / 2 ? 10 : 20;
            for (int i = 0; i < 4; i++)
                colour[y][x][i] = i == 3 || (x / 2 + y / 2) % 2;
        }
}

static void check_canaries(void)
{
    for (int i = 0; i < STRUCTS; i++) {
        int bad = 0;
        for (int k = 0; k < AROUND; k++)
            bad += (all[i].before[k] != CANARY) + (all[i].behind[k] != CANARY);
        CHECK_MSG(!bad, "%d bytes around struct hf_%s changed", bad, all[i].name);
        CHECK_MSG(*all[i].size == all[i].own, "the size of struct hf_%s is %zu now", all[i].name, *all[i].size);
    }
}

static struct hf_params wanted(void)
{
    struct hf_params p = hf_default_params();
    p.max_radius = 4;
    p.run.deterministic = 1;
#ifdef LATER
    CHECK_INT(p.later[0], 0);
    p.later[0] = LATER;
#endif
    return p;
}

// What the library says of a frame that it made.
static void check_told(struct hf_context *c)
{
    CHECK_INT(hf_get_report(c, &report.it), HF_OK);
    CHECK_INT(report.it.near_pixels + report.it.sharp_pixels + report.it.far_pixels, WIDTH * HEIGHT);
    CHECK_INT(report.it.far_pixels, WIDTH / 2 * HEIGHT);
    CHECK_INT(report.it.clamped, 0);
    CHECK(report.it.far_radius > 3 && report.it.far_radius <= 4 && report.it.total_ms > 0);
    CHECK_INT(hf_get_used(c, &params.it, &resolved.it), HF_OK);
    CHECK(params.it.max_radius == 4 && params.it.run.deterministic == 1 && params.it.run.budget_ms == 0);
    CHECK_INT(resolved.it.limit, HF_LIMIT_GIVEN);
    CHECK_INT(hf_get_problem(c, &message.it), HF_OK);
    CHECK_INT(message.it.error, HF_OK);
#ifdef LATER
    CHECK_INT(report.it.later[0], 0);
    CHECK_INT(report.it.later[1], 0);
#endif
}

static void check_refused(struct hf_context *c, const struct hf_params *p, const struct hf_depth *depth)
{
    CHECK_INT(hf_get_problem(c, &message.it), HF_OK);
    CHECK_INT(message.it.error, HF_ERR_ARG);
    CHECK_MSG(strstr(message.it.sentence, "newer library") && strcmp(message.it.argument, "params") == 0, "'%s'",
              message.it.sentence);
    CHECK_INT(hf_resolve(WIDTH, HEIGHT, depth, p, &params.it, &resolved.it, &message.it), HF_ERR_ARG);
    CHECK_MSG(strstr(message.it.sentence, "newer library"), "'%s'", message.it.sentence);
}

static void render(struct hf_context *c)
{
    const struct hf_image src = {sizeof src,        WIDTH, HEIGHT, HF_FORMAT_RGBA32F, HF_TRANSFER_LINEAR, {colour},
                                 {sizeof colour[0]}},
                          dst = {sizeof dst,         WIDTH, HEIGHT, HF_FORMAT_RGBA32F, HF_TRANSFER_LINEAR, {blurred},
                                 {sizeof blurred[0]}};
    const struct hf_depth depth = {.size = sizeof depth, .data = distances, .stride = sizeof distances[0]};
    const struct hf_region part = {sizeof part, 0, 0, WIDTH, HEIGHT};
    struct hf_params p = wanted();
    CHECK_INT(hf_render(c, &dst, &src, &depth, &p), WANT);
    if (WANT != HF_OK) {
        check_refused(c, &p, &depth);
        return;
    }
    check_told(c);
    CHECK(memcmp(blurred[0][0], colour[0][0], sizeof blurred[0] / 4) == 0);  // far from the far half: sharp
    CHECK(memcmp(blurred[0][WIDTH / 2], colour[0][WIDTH / 2], sizeof blurred[0] / 4) != 0);
    CHECK_INT(hf_region_reads(c, &dst, &src, &depth, &p, &part, &region.it, NULL), HF_OK);
    CHECK_INT(region.it.height, HEIGHT);
    CHECK_INT(hf_resolve(WIDTH, HEIGHT, &depth, &p, &params.it, &resolved.it, &message.it), HF_OK);
    CHECK_INT(resolved.it.width, WIDTH);
    CHECK_INT(hf_choose_quality(HEIGHT, &depth, &params.it, HF_QUALITY_BEST, &choice.it, &message.it), HF_OK);
    CHECK_INT(params.it.engine, HF_ENGINE_LAYERS);
    CHECK(choice.it.error > 0 && params.it.max_radius == 4);
}

int main(void)
{
    struct hf_context *c;
    const struct hf_config config = {.size = sizeof config, .threads = 1};
    begin();
    if (WANT == HF_ERR_ABI) {
        CHECK_INT(hf_open(&c, &config), HF_ERR_ABI);
        CHECK(!c && strcmp(hf_error_string(HF_ERR_ABI), hf_error_string(-1000)) != 0);
        return check_report();
    }
    if (!CHECK_INT(hf_open(&c, &config), HF_OK))
        return check_report();
    render(c);
    check_canaries();
    hf_close(&c);
    return check_report();
}
