// SPDX-License-Identifier: BSD-3-Clause
// Layers compared with a ray-traced lens: each quality is as accurate as promised, and a higher one is never worse.
//
//     layers_truth images      the folder of the ray-traced scenes
#include <stdio.h>

#include "support/check.h"
#include "support/render.h"

enum { QUALITIES = 4 };
static const enum hf_layers_quality order[QUALITIES] = {HF_LAYERS_DRAFT, HF_LAYERS_STANDARD, HF_LAYERS_HIGH,
                                                        HF_LAYERS_BEST};

struct truth {
    const char *name;
    float focus, f_number;
    double standard;  // dB that the standard quality has
};

// By that it may be worse before someone has to look: a step of the ladder. Instruction sets differ by 0.01 dB.
static const double MARGIN = 0.2;

static const struct truth scenes[] = {
    {"lights", 5, 0.37f, 31.30},
    {"fence", 6, 0.46f, 34.36},
    {"foliage", 4, 0.7f, 34.33},
};

static void measure(struct hf_context *c, const char *folder, const struct truth *t)
{
    static const char *const rgb[] = {"R", "G", "B"}, *const z[] = {"Z"};
    struct picture in, depth, want;
    char path[4096];
    double before = 0;
    snprintf(path, sizeof path, "%s/%s.exr", folder, t->name);
    if (!CHECK(exr_read(&in, path, 3, rgb) == 0 && exr_read(&depth, path, 1, z) == 0))
        return;
    snprintf(path, sizeof path, "%s/%s.truth.exr", folder, t->name);
    if (!CHECK(exr_read(&want, path, 3, rgb) == 0))
        return;
    const struct hf_depth d = picture_depth(&depth);
    for (int i = 0; i < QUALITIES; i++) {
        struct hf_params p = hf_default_params();
        p.engine = HF_ENGINE_LAYERS;
        p.model = HF_MODEL_LENS;
        p.focus = t->focus;
        p.lens.f_number = t->f_number;
        p.layers.quality = order[i];
        struct picture out = render(c, &in, &d, &p);
        const double psnr = display_psnr(&out, &want);
        if (order[i] == HF_LAYERS_STANDARD)
            CHECK_MSG(psnr >= t->standard - MARGIN, "%s: %.2f dB from the truth, it was %.2f", t->name, psnr,
                      t->standard);
        // A tolerance for the luck of one scene's pattern.
        CHECK_MSG(psnr > before - 0.1, "%s: quality %d of %d is %.2f dB from the truth, the one below %.2f", t->name,
                  i + 1, QUALITIES, psnr, before);
        before = psnr;
        picture_free(&out);
    }
    picture_free(&in);
    picture_free(&depth);
    picture_free(&want);
}

int main(int argc, char **argv)
{
    struct hf_context *c = NULL;
    if (!CHECK_INT(hf_open(&c, NULL), HF_OK))
        return check_report();
    for (size_t i = 0; argc > 1 && i < sizeof scenes / sizeof *scenes; i++)
        measure(c, argv[1], &scenes[i]);
    hf_close(&c);
    return check_report();
}
