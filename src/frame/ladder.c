// SPDX-License-Identifier: BSD-3-Clause
#include "frame/ladder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "frame/budget.h"
#include "pass/engine.h"
#include "frame/ladder_table.h"

const struct hf_ladder_step hf_ladder[] = {HF_LADDER_STEPS};
_Static_assert(sizeof hf_ladder / sizeof *hf_ladder < HF_BUDGET_STEPS, "a budget may step to all of them");
const int hf_ladder_steps = sizeof hf_ladder / sizeof *hf_ladder;
const float hf_ladder_engine_ms[HF_ENGINE_COUNT] = {HF_LADDER_ENGINES};
const int hf_ladder_quality[] = {HF_LADDER_QUALITIES};
const char hf_ladder_measured[] = HF_LADDER_MEASURED;

// The options that steps may have. A word of several rows sets all of them.
static const struct word {
    const char *name;
    size_t offset;
    enum { NAME, WHOLE, REAL, FLAG } kind;
    enum hf_names names;
} words[] = {
#define AT(field) offsetof(struct hf_params, field)
    {"--engine", AT(engine), NAME, HF_NAMES_ENGINE},
    {"--resolution", AT(hexagon.resolution), NAME, HF_NAMES_RESOLUTION},
    {"--resolution", AT(scatter.resolution), NAME, HF_NAMES_RESOLUTION},
    {"--resolution", AT(gaussian.resolution), NAME, HF_NAMES_RESOLUTION},
    {"--iterations", AT(gaussian.iterations), WHOLE, 0},
    {"--sigma", AT(gaussian.sigma), REAL, 0},
    {"--rings", AT(gather.rings), WHOLE, 0},
    {"--fill", AT(gather.fill), NAME, HF_NAMES_FILL},
    {"--storage", AT(gather.storage), NAME, HF_NAMES_STORAGE},
    {"--faithful", AT(gather.faithful), FLAG, 0},
    {"--karis", AT(gather.karis), FLAG, 0},
    {"--bicubic", AT(gather.bicubic), FLAG, 0},
    {"--per-pixel-kernel", AT(gather.per_pixel_kernel), FLAG, 0},
    {"--downsample", AT(gather.downsample), NAME, HF_NAMES_DOWNSAMPLE},
    {"--division", AT(gather.division), NAME, HF_NAMES_DIVISION},
    {"--layers-quality", AT(layers.quality), NAME, HF_NAMES_LAYERS},
    {"--spacing", AT(layers.spacing), REAL, 0},
    {"--half-from", AT(layers.half_from), REAL, 0},
    {"--quarter-from", AT(layers.quarter_from), REAL, 0},
    {"--no-unmix", AT(layers.no_unmix), FLAG, 0},
    {"--no-hidden", AT(layers.no_hidden), FLAG, 0},
    {"--no-highlights", AT(layers.no_highlights), FLAG, 0},
    {"--no-patterns", AT(layers.no_patterns), FLAG, 0},
#undef AT
};
enum { WORDS = sizeof words / sizeof *words };
_Static_assert(sizeof(enum hf_engine) == sizeof(int) && sizeof(float) == sizeof(int), "fields have one size");

static void set(struct hf_params *p, const struct word *w, const char *value)
{
    void *field = (char *)p + w->offset;
    char name[32] = "";
    switch (w->kind) {
    case FLAG:
        *(int *)field = 1;
        break;
    case WHOLE:
        *(int *)field = atoi(value);
        break;
    case REAL:
        *(float *)field = (float)atof(value);
        break;
    case NAME:
        strncat(name, value, strcspn(value, " ") < sizeof name ? strcspn(value, " ") : 0);
        hf_value(w->names, name, field);
        break;
    }
}

// Set what options say. Returns how many words of them are not understood.
static int apply(struct hf_params *p, const char *options)
{
    int unknown = 0;
    for (const char *text = options; *text; text += strspn(text, " ")) {
        const size_t n = strcspn(text, " ");
        const char *value = text + n + strspn(text + n, " ");
        int takes_value = 0, known = 0;
        for (int i = 0; i < WORDS; i++)
            if (strlen(words[i].name) == n && !memcmp(words[i].name, text, n)) {
                set(p, &words[i], value);
                takes_value = words[i].kind != FLAG;
                known = 1;
            }
        unknown += !known;
        text = takes_value ? value + strcspn(value, " ") : text + n;
    }
    return unknown;
}

void hf_ladder_apply(struct hf_params *p, int step)
{
    for (int i = 0; i < WORDS; i++)
        memcpy((char *)p + words[i].offset, (const char *)&hf_default_params + words[i].offset, sizeof(int));
    apply(p, hf_ladder[step].options);
}

int hf_ladder_understands(int step)
{
    struct hf_params p = hf_default_params;
    return !apply(&p, hf_ladder[step].options);
}

uint64_t hf_ladder_hash(const struct hf_params *p)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (int i = 0; i < WORDS; i++) {
        uint32_t field;
        memcpy(&field, (const char *)p + words[i].offset, sizeof field);
        hash = (hash ^ field) * UINT64_C(0x100000001b3);
        hash ^= hash >> 29;
    }
    return hash;
}

void hf_ladder_reshape(struct hf_params *p)
{
    const unsigned drawn = hf_engine_def(p->engine)->limits.aperture;
    const struct hf_aperture_params *disc = &hf_default_params.aperture;
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

// The step that params are, or -1.
static int step_of(const struct hf_params *p)
{
    for (int i = 0; i < hf_ladder_steps; i++) {
        struct hf_params other = *p;
        hf_ladder_apply(&other, i);
        int same = 1;
        for (int k = 0; k < WORDS; k++)
            same &= !memcmp((const char *)p + words[k].offset, (const char *)&other + words[k].offset, sizeof(int));
        if (same)
            return i;
    }
    return -1;
}

float hf_ladder_ms(const struct hf_params *p)
{
    const int step = step_of(p);
    return step >= 0                            ? hf_ladder[step].ms
           : hf_ladder_engine_ms[p->engine] > 0 ? hf_ladder_engine_ms[p->engine]
                                                : INFINITY;
}
