// SPDX-License-Identifier: BSD-3-Clause
// The library against fixed pictures: those that the author's own shaders made, and pixels written down here.
//
//     golden own       a small scene made here, its pixels as numbers below
//     golden print     the same, and prints them
//     golden shared    $HF_SHARED/golden/synthetic (see its README.md); 77 when it is not there
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/reference.h"
#include "support/render.h"
#include "hyperfocal/inspect.h"

// The small scene: a floor in 17 exact CoC steps, a near bar, far highlights. All its numbers are exact as floats.
enum { WIDTH = 96, HEIGHT = 64 };

static void make_own(struct picture *colour, struct picture *z)
{
    *colour = picture_new(WIDTH, HEIGHT, 3);
    *z = picture_new(WIDTH, HEIGHT, 1);
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            const int i = y * WIDTH + x, bar = x >= 30 && x < 37 && y > 6, light = (x * 7 + y * 13) % 331 == 5;
            z->plane[0][i] = bar ? 12.5f : 10 + 1.25f * (float)((y + x / 8) * 17 / 76);
            for (int c = 0; c < 3; c++)
                colour->plane[c][i] = light ? 40 : (float)((x * 37 + y * 91 + c * 53 + x * y) % 64 + 1) / 64;
        }
    }
}

struct pixel {
    int x, y;
    double rgb[3];
};

struct own {
    const char *name;
    struct hf_params set;  // these members are used: faithful, karis, bicubic, fill, blades, per_pixel_kernel
    struct pixel pixels[7];
};

// Numbers of the reference in double precision, printed by `golden print`.
static const struct own owns[] = {
    {"maximum",
     {0},
     {
         {0, 0, {0.474755358, 0.5293789884, 0.5006396801}},
         {95, 63, {0.5739471948, 0.6729065033, 0.6379232622}},
         {29, 30, {0.5521467149, 0.7451575275, 0.7043769727}},
         {33, 40, {0.7180405877, 0.6825991844, 0.6465109391}},
         {47, 20, {0.6641288981, 0.6257405101, 0.7938272126}},
         {70, 44, {0.4075703428, 0.8772242279, 0.7846264482}},
         {53, 57, {0.6942778171, 0.666689393, 0.6355185184}},
     }},
    {"faithful",
     {.chapter.faithful = 1},
     {
         {0, 0, {0.474755358, 0.5293789884, 0.5006396801}},
         {95, 63, {0.5739471948, 0.6729065033, 0.6379232622}},
         {29, 30, {0.5521467149, 0.7451575275, 0.7043769727}},
         {33, 40, {0.7180405877, 0.6825991844, 0.6465109391}},
         {47, 20, {0.6641288981, 0.6257405101, 0.7938272126}},
         {70, 44, {0.4077188371, 0.874956455, 0.7887970735}},
         {53, 57, {0.6950711916, 0.6671676961, 0.6354408985}},
     }},
    {"faithful, karis, bicubic, mean, 6-gon",
     {.chapter.faithful = 1,
      .chapter.karis = 1,
      .chapter.bicubic = 1,
      .chapter.fill = HF_FILL_MEAN,
      .aperture.blades = 6},
     {
         {0, 0, {0.4588938311, 0.5232474704, 0.4843737309}},
         {95, 63, {0.4618032292, 0.5387925463, 0.523588222}},
         {29, 30, {0.3819218827, 0.563958639, 0.5312632307}},
         {33, 40, {0.5290122778, 0.4798513611, 0.4440766032}},
         {47, 20, {0.4614703931, 0.4113715027, 0.6032027664}},
         {70, 44, {0.3228290169, 0.7953144415, 0.6988467902}},
         {53, 57, {0.5897605881, 0.553439345, 0.5376040772}},
     }},
};
enum { OWNS = sizeof owns / sizeof *owns };

static struct hf_params own_params(const struct own *own)
{
    struct hf_params p = own->set;
    const struct hf_params d = hf_default_params();
    p.size = sizeof p;
    p.focus = 20;
    p.range.distance = 10;
    p.range.strength = d.range.strength;
    p.range.near_begin = p.range.near_end = p.range.far_begin = p.range.far_end = HF_DERIVE;
    p.max_radius = 12;
    p.highlight = d.highlight;
    p.view = d.view;
    p.aperture.squeeze = d.aperture.squeeze;
    p.chapter.rings = d.chapter.rings;
    p.engine = HF_ENGINE_CHAPTER;
    return p;
}

// The whole frame against the reference. CoC is exact here, so only the roundings of chapter.c's passes 2, 7, 8 and 9
// remain: (32 + 2 * 129 + 12 + 11 + 102) * 2^-24 = 2.5e-5 of the largest sample nearby.
static void check_own(struct hf_context *c, const char *isa, int o, int print)
{
    struct picture colour, z;
    make_own(&colour, &z);
    const struct hf_params p = own_params(&owns[o]);
    const struct hf_depth depth = picture_depth(&z);
    struct reference *r = reference_render(&colour, &depth, &p, NULL, NULL);
    const struct ref_buffer *want = &r->buffer[REF_RESULT];
    for (int i = 0; print && i < 7; i++) {
        const struct pixel *px = &owns[o].pixels[i];
        const int at = px->y * WIDTH + px->x;
        printf("            { %d, %d, { %.10g, %.10g, %.10g } },\n", px->x, px->y, want->data[0][at], want->data[1][at],
               want->data[2][at]);
    }
    struct picture got = render(c, &colour, &depth, &p);
    double worst = 0;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            worst = worse(worst, fabs(got.plane[k][i] - want->data[k][i]));
    CHECK_MSG(worst <= 2.5e-5 * 40, "%s, %s: %g from the reference", isa, owns[o].name, worst);
    for (int i = 0; i < 7; i++) {
        const struct pixel *px = &owns[o].pixels[i];
        const int at = px->y * WIDTH + px->x;
        for (int k = 0; k < 3; k++) {
            CHECK_MSG(fabs(want->data[k][at] - px->rgb[k]) <= 1e-9 * px->rgb[k] + 1e-10,
                      "%s, channel %d of (%d, %d): reference %.10g, written down %.10g", owns[o].name, k, px->x, px->y,
                      want->data[k][at], px->rgb[k]);
            CHECK_MSG(fabs(got.plane[k][at] - px->rgb[k]) <= 1e-5 * px->rgb[k],
                      "%s, %s, channel %d of (%d, %d): %.9g, written down %.10g", isa, owns[o].name, k, px->x, px->y,
                      got.plane[k][at], px->rgb[k]);
        }
    }
    picture_free(&got);
    reference_free(r);
    picture_free(&colour);
    picture_free(&z);
}

// The shared set.

struct shared {
    char folder[3000];
    const char *isa;
};

static const char *const rgb_names[] = {"R", "G", "B"};
static const char *const near_far_names[] = {"R", "G"};
static const char *const coc_names[] = {"Y"};

static int read_golden(struct picture *out, const struct shared *shared, const char *name, int channels)
{
    char path[3200];
    snprintf(path, sizeof path, "%s/%s.exr", shared->folder, name);
    return exr_read(out, path, channels, channels == 3 ? rgb_names : channels == 2 ? near_far_names : coc_names);
}

static double largest_within(const struct picture *p, int c, int x, int y, int reach)
{
    double largest = 0;
    for (int j = y - reach; j <= y + reach; j++)
        for (int i = x - reach; i <= x + reach; i++)
            if (i >= 0 && j >= 0 && i < p->width && j < p->height)
                largest = fmax(largest, fabs(p->plane[c][j * p->width + i]));
    return largest;
}

// The test of the set's README. Either criterion suffices: no sample over 1e-3 relative and 5e-6 of the largest value
// within 8 half-resolution pixels, or at most 0.05 % of the samples over 1e-3 relative (the composite: 2e-3).
static void fair(const struct shared *shared, const char *name, const struct picture *got, int reach, double relative)
{
    struct picture want;
    if (!CHECK_MSG(read_golden(&want, shared, name, 3) == 0, "cannot read %s", name))
        return;
    CHECK_INT(got->width, want.width);
    CHECK_INT(got->height, want.height);
    long off = 0, unfair = 0;
    const long samples = 3L * want.width * want.height;
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < want.width * want.height; i++) {
            const double b = want.plane[c][i], d = fabs(got->plane[c][i] - b);
            if (d <= relative * fabs(b))
                continue;
            off++;
            unfair += d > relative * fabs(b) + 5e-6 * largest_within(&want, c, i % want.width, i / want.width, reach);
        }
    }
    printf("%s: %-12s %.4f %% over %g, %ld of them unexplained, %.1f dB\n", shared->isa, name,
           100.0 * (double)off / (double)samples, relative, unfair, display_psnr(got, &want));
    CHECK_MSG(unfair == 0 || off <= samples / 2000, "%s: %s: %ld of %ld samples off", shared->isa, name, off, samples);
    picture_free(&want);
}

// CoC buffers: golden and library are both computed in floats, each within 2.4e-7 of the truth as measured; the bound
// is a bit over twice that.
static void coc_close(const struct shared *shared, const struct hf_inspect_buffer *b, const struct picture *got)
{
    struct picture want;
    double worst = 0;
    if (!CHECK_MSG(read_golden(&want, shared, b->name, b->channels) == 0, "cannot read %s", b->name))
        return;
    CHECK_INT(got->width, want.width);
    CHECK_INT(got->height, want.height);
    for (int c = 0; c < b->channels; c++)
        for (int i = 0; i < want.width * want.height; i++)
            worst = worse(worst, fabs((double)got->plane[c][i] - want.plane[c][i]));
    printf("%s: %-12s %.2g\n", shared->isa, b->name, worst);
    CHECK_MSG(worst <= 6e-7, "%s: %s differs by %g", shared->isa, b->name, worst);
    picture_free(&want);
}

static void on_buffer(void *cookie, const struct hf_inspect_buffer *b)
{
    struct shared *shared = cookie;
    struct picture got = picture_new(b->width, b->height, b->channels);
    for (int c = 0; c < b->channels; c++)
        for (int y = 0; y < b->height; y++)
            memcpy(got.plane[c] + (ptrdiff_t)y * b->width, (const char *)b->data[c] + y * b->stride,
                   sizeof(float) * (size_t)b->width);
    if (strncmp(b->name, "coc", 3) == 0)
        coc_close(shared, b, &got);
    else
        fair(shared, b->name, &got, 8, 1e-3);
    picture_free(&got);
}

static void check_shared(struct hf_context *c, struct shared *shared, const struct picture *colour,
                         const struct picture *z)
{
    struct hf_params p = hf_default_params();
    p.focus = 20;
    p.range.distance = 10;
    p.engine = HF_ENGINE_CHAPTER;
    p.chapter.faithful = 1;
    const struct hf_depth depth = picture_depth(z);
    hf_inspect_dump(c, on_buffer, shared);
    struct picture dumped = render(c, colour, &depth, &p);
    hf_inspect_dump(c, NULL, NULL);
    struct picture out = render(c, colour, &depth, &p);
    CHECK_MSG(picture_same_bits(&dumped, &out), "%s: dumped and fused frames differ", shared->isa);
    fair(shared, "composite", &out, 16, 2e-3);
    picture_free(&dumped);
    picture_free(&out);
    struct picture want;
    if (!CHECK(read_golden(&want, shared, "composite_chapter_formats", 3) == 0))
        return;
    p.chapter.storage = HF_STORAGE_PACKED;
    out = render(c, colour, &depth, &p);
    const double psnr = display_psnr(&out, &want);
    printf("%s: chapter      %.2f dB\n", shared->isa, psnr);
    CHECK_MSG(psnr > 55, "%s: chapter storage %.2f dB", shared->isa, psnr);
    picture_free(&out);
    picture_free(&want);
}

// Returns 0 if the set is not there.
static int read_shared(struct shared *shared, struct picture *colour, struct picture *z)
{
    static const char *const z_name[] = {"Z"};
    const char *root = getenv("HF_SHARED");
    if (!root)
        return 0;
    snprintf(shared->folder, sizeof shared->folder, "%s/golden/synthetic", root);
    char path[3200];
    snprintf(path, sizeof path, "%s/input.exr", shared->folder);
    FILE *there = fopen(path, "rb");
    if (!there)
        return 0;
    fclose(there);
    CHECK(exr_read(colour, path, 3, rgb_names) == 0);
    CHECK(exr_read(z, path, 1, z_name) == 0);
    return colour->width > 0 && z->width > 0;
}

int main(int argc, char **argv)
{
    const int own = argc > 1 && strcmp(argv[1], "shared") != 0, print = argc > 1 && strcmp(argv[1], "print") == 0;
    struct shared shared = {0};
    struct picture colour = {0}, z = {0};
    if (!own && !read_shared(&shared, &colour, &z)) {
        puts("skipped: HF_SHARED does not lead to golden/synthetic/input.exr");
        return CHECK_SKIP;
    }
    for (int isa = HF_ISA_SCALAR; isa <= HF_ISA_NEON; isa++) {
        if (!hf_isa_available((enum hf_isa)isa))
            continue;
        const struct hf_config config = {.size = sizeof config, .threads = 2, .isa = (enum hf_isa)isa};
        struct hf_context *c;
        if (!CHECK_INT(hf_open(&c, &config), HF_OK))
            continue;
        shared.isa = hf_isa_name((enum hf_isa)isa);
        if (!own)
            check_shared(c, &shared, &colour, &z);
        for (int o = 0; own && o < OWNS; o++)
            check_own(c, shared.isa, o, print);
        hf_close(&c);
    }
    picture_free(&colour);
    picture_free(&z);
    return check_report();
}
