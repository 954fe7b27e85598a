// SPDX-License-Identifier: BSD-3-Clause
// The library's chapter engine against the reference in double precision, pass by pass: after each pass the library's
// buffer is compared and then replaces the reference's, so that each tolerance covers only one pass.
//
//     chapter [seed]
//
// Tolerances count roundings, at most U = 2^-24 each, relative to the largest value that went in. A few of them simply
// add up. Many are taken as independent and uniform: n of them have a standard deviation of U sqrt(n / 3), and six of
// those are allowed.
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/reference.h"
#include "support/render.h"
#include "hyperfocal/inspect.h"

static const double U = FLT_EPSILON / 2;

static double many(double roundings)
{
    return 6 * sqrt(roundings / 3) * U;
}

// The buffers from hf_inspect_dump, and the resulting picture.
struct capture {
    struct picture buffer[REF_COUNT];
    int count;
};

// One comparison of a whole frame.
struct job {
    char label[200];
    const struct hf_depth *depth;
    struct capture captured;
};

static void on_buffer(void *cookie, const struct hf_inspect_buffer *b)
{
    static const char *const names[] = {[REF_COC] = "coc",           [REF_COC4] = "coc4",
                                        [REF_COCMAXX] = "cocmaxx",   [REF_COCMAX] = "cocmax",
                                        [REF_COCBLURX] = "cocblurx", [REF_COCBLUR] = "cocblur",
                                        [REF_COLOR4] = "color4",     [REF_COLORMULCOC4] = "colormulcoc4",
                                        [REF_NEAR] = "near",         [REF_FAR] = "far",
                                        [REF_NEARFILL] = "nearfill", [REF_FARFILL] = "farfill"};
    struct capture *capture = cookie;
    for (int id = REF_COC; id < REF_RESULT; id++) {
        if (strcmp(b->name, names[id]) != 0)
            continue;
        CHECK_MSG(!capture->buffer[id].plane[0], "buffer %s came twice", b->name);
        capture->buffer[id] = picture_new(b->width, b->height, b->channels);
        capture->count++;
        for (int c = 0; c < b->channels; c++)
            for (int y = 0; y < b->height; y++)
                memcpy(capture->buffer[id].plane[c] + (ptrdiff_t)y * b->width, (const char *)b->data[c] + y * b->stride,
                       sizeof(float) * (size_t)b->width);
        return;
    }
    CHECK_MSG(0, "unknown buffer %s", b->name);
}

// The largest absolute value of a channel of the full-resolution colour in the half-resolution window (x +- rx, y +-
// ry). It bounds colour4, (colour x far) / far, and what is made of them.
static double colour_near(const struct reference *r, int c, int x, int y, int rx, int ry)
{
    double largest = 0;
    for (int j = 2 * (y - ry); j <= 2 * (y + ry) + 1; j++) {
        for (int i = 2 * (x - rx); i <= 2 * (x + rx) + 1; i++) {
            const int sx = i < 0 ? 0 : i < r->width ? i : r->width - 1;
            const int sy = j < 0 ? 0 : j < r->height ? j : r->height - 1;
            largest = worse(largest, fabs(r->buffer[REF_COLOUR].data[c][sy * r->width + sx]));
        }
    }
    return largest;
}

// Largest absolute value of a half-resolution buffer within reach of (x, y).
static double buffer_near(const struct ref_buffer *b, int c, int x, int y, int reach)
{
    double largest = 0;
    for (int j = y - reach; j <= y + reach; j++)
        for (int i = x - reach; i <= x + reach; i++)
            if (i >= 0 && j >= 0 && i < b->width && j < b->height)
                largest = worse(largest, fabs(b->data[c][j * b->width + i]));
    return largest;
}

// Pass 9. Far: weights of products of three rounded differences (12), their sum (2), the inverse (1), their product
// (28), four products and three sums (4). Near: 4 products and 3 sums for colour and for CoC (14), or for the cubic 4
// rounded weights with 4 roundings each and 15 sums, twice (62). Two lerps, of differences (8).
static double composite_bound(const struct reference *r, int c, int x, int y)
{
    const double roundings = 32 + (r->params.chapter.bicubic ? 62 : 14) + 8;
    const double fields = fmax(buffer_near(&r->buffer[REF_NEARFILL], c, x / 2, y / 2, 2),
                               buffer_near(&r->buffer[REF_FARFILL], c, x / 2, y / 2, 2));
    return many(roundings) * fmax(fabs(r->buffer[REF_COLOUR].data[c][y * r->width + x]), fields);
}

// Pass 1. (ne - z) / (ne - nb): the ends are rounded (U (F + R) each, relative to R), the distance, and the quotient or
// a product with a rounded inverse: 8 U. A depth that is converted first carries the conversion's roundings, c U z / R:
// ray 6 (squares, sum, root, quotient); 1/z and clip planes: 1/z = a + b (1 - d) and its inverse, 6 roundings of a sum
// that is near/z of its largest part, so 6 z / near. The lens: 1/P - 1/z times K/rho, 6 roundings of K/(P rho).
static double coc_bound(const struct reference *r, const struct job *job)
{
    const struct hf_params *p = &r->params;
    const double lens = p->model == HF_MODEL_LENS, f = p->focus;
    const double range = p->range.distance == HF_DERIVE ? f / 2 : fmax(p->range.distance, 1e-6);
    const double end = f + range;  // depths beyond have a CoC of 1
    double converted = 0;
    if (job->depth->type == HF_DEPTH_RAY || job->depth->type == HF_DEPTH_INVERSE)
        converted = 6 * end / range;
    else if (job->depth->type >= HF_DEPTH_NDC_D3D && job->depth->type <= HF_DEPTH_NDC_REVERSED)
        converted = 6 * end / range * end / job->depth->near_plane;
    double bound = 8 + 4 * end / range + converted;
    if (lens)
        bound = 8 + 12 * p->lens.focal_length_mm * p->lens.focal_length_mm / 2000 / p->lens.f_number /
                        p->lens.sensor_width_mm * r->width / f / r->rho;
    return U * (p->range.blend == HF_BLEND_SMOOTHSTEP ? 1.5 * bound + 6 : bound);
}

// Pass 7. L lattice weights: L products and sums, for numerator and denominator, and the quotient: 2 L + 12 roundings
// of the largest colour. Weights are whole numbers of U, each within one U of its value. Tap positions are rounded to
// float: U h per axis, and a bilinear sample moves by 2 * the largest sample per pixel; with the per-pixel kernel the
// position in the picture is rounded too. All is relative to the mean weight of the taps, which can be small.
static double gather_bound(const struct reference *r, enum ref_id id, int c, int x, int y)
{
    const int rx = (int)ceil(r->reach_x * r->kernel_scale) + 1, ry = (int)ceil(r->reach_y * r->kernel_scale) + 1;
    const int pixel = y * r->half_width + x;
    const double mean = id == REF_NEAR ? r->near_mean[pixel] : r->far_mean[pixel];
    if (mean == 0)
        return 2 * U * colour_near(r, c, x, y, 0, 0);  // own colour, at most divided by its CoC
    const int per_pixel = id == REF_FAR && r->params.chapter.per_pixel_kernel;
    const double points = per_pixel ? 4 * r->taps : fmin(4 * r->taps + 1, (2 * rx - 1) * (2 * ry - 1));
    const double moved = fmax(r->reach_x, r->reach_y) + 1 + (per_pixel ? r->half_width + r->half_height : 0);
    const double largest = colour_near(r, c, x, y, rx, ry);
    // Karis weights w = 1 / (1 + Y): w c <= 1 / 0.0722 for every channel.
    const double sample = r->params.chapter.karis ? fmin(largest, 14) : largest;
    const double units = per_pixel ? 0 : many(points);
    // The partial weight of the pixel's own colour adds a product, a difference, a product and a sum.
    return many(2 * points + 12 + 4) * largest + (units + U * 4 * moved) * sample / mean;
}

// Passes 3 to 6 where the outermost values of a window count in part: that part has a rounding of U times the radius,
// times a value of at most 1.
static double edge_bound(const struct reference *r, double radius)
{
    return r->params.chapter.faithful || radius == ceil(radius) ? 0 : U * (ceil(radius) + 1);
}

// A mean of such values: 2 m + 1 positive terms and the scale; minus the missing part of two values, over the weight of
// the others.
static double mean_bound(const struct reference *r, double radius, double want)
{
    const double edge = edge_bound(r, radius);
    return U * want * (2 * ceil(radius) + 3) + (edge > 0 ? (4 * edge + 8 * U) / (2 * ceil(radius) - 1) : 0);
}

// By how much a sample of a buffer may differ, without storage.
static double bound_of(const struct reference *r, const struct job *job, enum ref_id id, int c, int x, int y)
{
    const struct ref_buffer *b = &r->buffer[id];
    const double want = b->raw[c][y * b->width + x];
    switch (id) {
    case REF_COC:
        return coc_bound(r, job);
    case REF_COC4:
        return 0;  // copies
    case REF_COCMAXX:
        return edge_bound(r, r->reach_x);
    case REF_COCMAX:
        return edge_bound(r, r->reach_y);
    case REF_COCBLURX:
        return mean_bound(r, r->reach_x, want);
    case REF_COCBLUR:
        return mean_bound(r, r->reach_y, want);
    case REF_COLOR4:  // three sums
        return 3 * U * colour_near(r, c, x, y, 0, 0);
    case REF_COLORMULCOC4:  // weights of products of three rounded differences (11), their sum (3), the inverse (1),
                            // both times each other (27), four products and three sums, and the CoC
        return 32 * U * colour_near(r, c, x, y, 0, 0) * r->buffer[REF_COC4].data[1][y * b->width + x];
    case REF_NEAR:
    case REF_FAR:
        return gather_bound(r, id, c, x, y);
    case REF_NEARFILL:  // nine terms, and the quotient or a product with a rounded 1/9; of a maximum as below
        return r->params.chapter.fill == HF_FILL_MEAN  ? 11 * U * buffer_near(&r->buffer[REF_NEAR], c, x, y, 1)
               : r->params.chapter.fill == HF_FILL_MAX ? 6 * U * buffer_near(&r->buffer[REF_NEAR], c, x, y, 1)
                                                       : 0;
    case REF_FARFILL:  // of a maximum a difference, a product and a sum, of two values
        return r->params.chapter.fill == HF_FILL_MEAN  ? 11 * U * buffer_near(&r->buffer[REF_FAR], c, x, y, 1)
               : r->params.chapter.fill == HF_FILL_MAX ? 6 * U * buffer_near(&r->buffer[REF_FAR], c, x, y, 1)
                                                       : 0;
    case REF_RESULT:
        return composite_bound(r, c, x, y);
    default:
        return 0;
    }
}

// Compare the library's buffer with the reference's, then let the reference continue with the library's.
static void compare(void *cookie, struct reference *r, enum ref_id id)
{
    struct job *job = cookie;
    struct ref_buffer *b = &r->buffer[id];
    const struct picture *got = &job->captured.buffer[id];
    const struct hf_params *p = &r->params;
    const double unorm = p->chapter.storage == HF_STORAGE_PACKED ? 2 * U : 0;  // n / 255, or n * (1 / 255)
    if (!CHECK_MSG(got->width == b->width && got->height == b->height && got->channels == b->channels,
                   "%s: %s is %d x %d x %d, expected %d x %d x %d", job->label, b->name, got->width, got->height,
                   got->channels, b->width, b->height, b->channels))
        return;
    int wrong = 0;
    char worst[200] = "";
    double worst_excess = 0;
    for (int c = 0; c < b->channels; c++) {
        const int stored_as = id >= REF_COC && id <= REF_COCBLUR ? -1 : c;
        for (int i = 0; i < b->width * b->height; i++) {
            const double raw = b->raw[c][i], have = got->plane[c][i];
            const double bound = bound_of(r, job, id, c, i % b->width, i / b->width);
            // The stored value must be what some value within the bound becomes when stored.
            const double low = ref_store(p->chapter.storage, stored_as, raw - bound) - unorm;
            const double high = ref_store(p->chapter.storage, stored_as, raw + bound) + unorm;
            b->data[c][i] = have;
            if (have >= low && have <= high)
                continue;
            wrong++;
            const double excess = fmax(low - have, have - high);
            if (!(excess <= worst_excess)) {
                worst_excess = excess;
                snprintf(worst, sizeof worst, "channel %d (%d, %d): %.9g, expected %.9g to %.9g", c, i % b->width,
                         i / b->width, have, low, high);
            }
        }
    }
    CHECK_MSG(wrong == 0, "%s: %s: %d wrong, %s", job->label, b->name, wrong, worst);
}

// Check one scene with one set of parameters in one context: the dump against the reference, and the frame against the
// dump.
static void check_frame(struct hf_context *c, const struct scene *s, const struct hf_depth *depth,
                        const struct hf_params *p, const char *label)
{
    struct job job = {.depth = depth};
    snprintf(job.label, sizeof job.label, "%s", label);
    hf_inspect_dump(c, on_buffer, &job.captured);
    struct picture out = job.captured.buffer[REF_RESULT] = render(c, &s->colour, depth, p);
    hf_inspect_dump(c, NULL, NULL);
    struct reference *r = reference_render(&s->colour, depth, p, compare, &job);
    reference_free(r);
    for (int no_skip = 0; no_skip < 2; no_skip++) {
        struct hf_params q = *p;
        q.run.no_skip = no_skip;
        struct picture fused = render(c, &s->colour, depth, &q);
        CHECK_MSG(picture_same_bits(&fused, &out), "%s: fused (no_skip %d) and dumped frames differ", label, no_skip);
        picture_free(&fused);
    }
    for (int id = 0; id < REF_COUNT; id++)
        picture_free(&job.captured.buffer[id]);
}

// Variations of the parameters, one at a time and some together.
struct option {
    const char *name;
    struct hf_params p;  // only the members that differ from scene_params(), see merge
    int big;             // 1: also on the largest size
};

#define ON 1
static const struct option options[] = {
    {"default", {0}, 1},
    {"faithful", {.chapter.faithful = ON}, 1},
    {"strength 0.1", {.range.strength = 0.1f}, 0},
    {"strength 0.3", {.range.strength = 0.3f}, 0},
    {"strength 0.6 faithful", {.range.strength = 0.6f, .chapter.faithful = ON}, 0},
    {"karis", {.chapter.karis = ON}, 1},
    {"per-pixel", {.chapter.per_pixel_kernel = ON}, 1},
    {"per-pixel karis mean",
     {.chapter.per_pixel_kernel = ON, .chapter.karis = ON, .chapter.fill = HF_FILL_MEAN, .chapter.faithful = ON},
     0},
    {"per-pixel none aspect 2",
     {.chapter.per_pixel_kernel = ON, .chapter.fill = HF_FILL_NONE, .view.pixel_aspect = 2},
     0},
    {"bicubic", {.chapter.bicubic = ON}, 1},
    {"bicubic faithful strength 0.2", {.chapter.bicubic = ON, .chapter.faithful = ON, .range.strength = 0.2f}, 0},
    {"mean", {.chapter.fill = HF_FILL_MEAN, .chapter.faithful = ON}, 0},
    {"none", {.chapter.fill = HF_FILL_NONE}, 0},
    {"open, 2 rings", {.chapter.fill = HF_FILL_OPEN, .chapter.rings = 2}, 0},
    {"linear downsample", {.chapter.downsample = HF_DOWNSAMPLE_LINEAR}, 0},
    {"point downsample karis", {.chapter.downsample = HF_DOWNSAMPLE_POINT, .chapter.karis = ON}, 0},
    {"none radius 60", {.chapter.fill = HF_FILL_NONE, .max_radius = 60}, 0},
    {"none radius 60 per-pixel", {.chapter.fill = HF_FILL_NONE, .max_radius = 60, .chapter.per_pixel_kernel = ON}, 0},
    {"none karis 7-gon",
     {.chapter.fill = HF_FILL_NONE, .chapter.karis = ON, .aperture.blades = 7, .aperture.rotation = 20},
     0},
    {"smoothstep", {.range.blend = HF_BLEND_SMOOTHSTEP}, 0},
    {"5-gon", {.aperture.blades = 5}, 0},
    {"5-gon rotated", {.aperture.blades = 5, .aperture.rotation = 33}, 1},
    {"6-gon", {.aperture.blades = 6}, 0},
    {"6-gon rotated", {.aperture.blades = 6, .aperture.rotation = -10}, 0},
    {"7-gon strength 0.6", {.aperture.blades = 7, .range.strength = 0.6f}, 0},
    {"8-gon rotated", {.aperture.blades = 8, .aperture.rotation = 400}, 0},
    {"9-gon karis", {.aperture.blades = 9, .chapter.karis = ON}, 0},
    {"aspect 2", {.view.pixel_aspect = 2}, 0},
    {"aspect 0.6 karis", {.view.pixel_aspect = 0.6f, .chapter.karis = ON}, 0},
    {"radius 1", {.max_radius = 1}, 0},
    {"radius 4", {.max_radius = 4}, 0},
    {"radius 7.3 strength 0.45", {.max_radius = 7.3f, .range.strength = 0.45f}, 0},
    {"radius 40", {.max_radius = 40}, 0},
    {"radius 40 6-gon karis aspect 2",
     {.max_radius = 40, .aperture.blades = 6, .chapter.karis = ON, .view.pixel_aspect = 2},
     0},
    {"range 20 (near begin at 0)", {.range.distance = 20}, 0},
    {"range 35 (near begin clamped)", {.range.distance = 35}, 0},
    {"range 0", {.range.distance = 1e-30f}, 0},
    {"given distances", {.range.near_begin = 5, .range.near_end = 17, .range.far_begin = 22, .range.far_end = 31}, 0},
    {"display 1080", {.max_radius = HF_DERIVE, .view.display_height = 1080}, 0},
    {"derived radius", {.max_radius = HF_DERIVE, .view.display_height = 700}, 0},
    {"derived radius faithful", {.max_radius = HF_DERIVE, .chapter.faithful = ON}, 0},
    {"lens", {.model = HF_MODEL_LENS, .lens.f_number = 0.05f}, 1},
    {"lens smoothstep display",
     {.model = HF_MODEL_LENS,
      .lens.f_number = 0.3f,
      .view.display_width = 500,
      .range.blend = HF_BLEND_SMOOTHSTEP,
      .lens.world_unit_m = 0.5f},
     0},
};
enum { OPTIONS = sizeof options / sizeof *options };

// Take every field that an option sets.
static struct hf_params merge(const struct hf_params *set)
{
    struct hf_params p = scene_params();
    static const struct hf_params zero;
    p.engine = HF_ENGINE_CHAPTER;
    // All fields are 4 bytes wide: enum, int or float.
    for (size_t i = 0; i < sizeof p / 4; i++)
        if (memcmp((const char *)set + 4 * i, (const char *)&zero + 4 * i, 4) != 0)
            memcpy((char *)&p + 4 * i, (const char *)set + 4 * i, 4);
    if (set->range.distance == 1e-30f)
        p.range.distance = 0;
    return p;
}

static const int sizes[][2] = {{1, 1}, {1, 7}, {7, 1}, {2, 2}, {17, 33}, {64, 48}, {131, 67}};
enum { SIZES = sizeof sizes / sizeof *sizes };

static void all_options(struct hf_context *c, const char *isa, unsigned seed)
{
    for (int o = 0; o < OPTIONS; o++) {
        for (int s = 0; s < SIZES; s++) {
            if (s == SIZES - 1 && !options[o].big)
                continue;
            struct rng rng = rng_seed(seed + (unsigned)(o * SIZES + s));
            const enum scene_kind kind = (enum scene_kind)(s < 4 ? rng_below(&rng, SCENE_KINDS) : (o + s) % 2 * 6);
            struct scene scene = scene_new(&rng, kind, sizes[s][0], sizes[s][1], 3 + (o + s) % 2);
            const struct hf_depth depth = picture_depth(&scene.depth);
            const struct hf_params p = merge(&options[o].p);
            char label[120];
            snprintf(label, sizeof label, "%s, %s, %s %d x %d", isa, options[o].name, scene_name(kind), sizes[s][0],
                     sizes[s][1]);
            check_frame(c, &scene, &depth, &p, label);
            scene_free(&scene);
        }
    }
}

static void all_scenes_and_storages(struct hf_context *c, const char *isa, unsigned seed)
{
    static const char *const storages[] = {"float", "half", "chapter"};
    for (int kind = 0; kind < SCENE_KINDS; kind++) {
        for (int storage = 0; storage < 3; storage++) {
            for (int variant = 0; variant < 4; variant++) {
                struct rng rng = rng_seed(seed + 1000 + (unsigned)kind);
                struct scene scene = scene_new(&rng, (enum scene_kind)kind, 45, 38, 3 + variant % 2);
                const struct hf_depth depth = picture_depth(&scene.depth);
                struct hf_params p = scene_params();
                p.engine = HF_ENGINE_CHAPTER;
                p.chapter.storage = (enum hf_storage)storage;
                p.chapter.faithful = variant == 1 || variant == 3;
                p.chapter.karis = variant == 2;
                p.chapter.bicubic = p.chapter.per_pixel_kernel = variant == 3;
                p.chapter.fill = variant == 3 ? HF_FILL_MEAN : HF_FILL_MAX;
                char label[120];
                snprintf(label, sizeof label, "%s, storage %s, variant %d, %s", isa, storages[storage], variant,
                         scene_name((enum scene_kind)kind));
                check_frame(c, &scene, &depth, &p, label);
                scene_free(&scene);
            }
        }
    }
}

// Every depth type against the same scene in view depth. The frame is checked fully against the reference of its own
// type. That the type means what its name says shows in the CoC: it must equal that of the view depth within the
// rounding of the depth samples (at most U d each, and as much for the conversion back).
static void all_depth_types(struct hf_context *c, const char *isa, unsigned seed)
{
    static const char *const types[] = {"view", "ray", "d3d", "gl", "reversed", "inverse", "coc"};
    for (int type = HF_DEPTH_VIEW; type <= HF_DEPTH_COC; type++) {
        struct rng rng = rng_seed(seed + 2000);
        struct scene scene = scene_new(&rng, SCENE_NOISE, 45, 38, 3);
        const struct hf_params p = merge(&options[0].p);
        struct picture samples;
        const struct hf_depth depth = scene_depth_as(&scene, (enum hf_depth_type)type, p.max_radius, &samples);
        char label[120];
        snprintf(label, sizeof label, "%s, depth %s", isa, types[type]);
        check_frame(c, &scene, &depth, &p, label);
        struct hf_params wide = p;
        wide.view.pixel_aspect = 2;
        check_frame(c, &scene, &depth, &wide, label);
        struct job job = {.depth = &depth};
        snprintf(job.label, sizeof job.label, "%s", label);
        hf_inspect_dump(c, on_buffer, &job.captured);
        struct picture out = render(c, &scene.colour, &depth, &p);
        hf_inspect_dump(c, NULL, NULL);
        const struct hf_depth view = picture_depth(&scene.depth);
        struct reference *r = reference_render(&scene.colour, &view, &p, NULL, NULL);
        const struct ref_buffer *coc = &r->buffer[REF_COC];
        // Clip planes: z^2 / near * U for the sample, 6 z^2 / near * U for the conversion back, z <= 30, over the range
        // of 10.
        const double bound = 2 * 7 * U * 30 * 30 / 10;
        double worst = 0;
        for (int k = 0; k < 2; k++)
            for (int i = 0; i < coc->width * coc->height; i++)
                worst = worse(worst, fabs(job.captured.buffer[REF_COC].plane[k][i] - coc->data[k][i]));
        CHECK_MSG(worst <= bound, "%s: CoC differs by %g from that of the view depth, bound %g", label, worst, bound);
        reference_free(r);
        picture_free(&out);
        for (int id = 0; id < REF_COUNT; id++)
            picture_free(&job.captured.buffer[id]);
        picture_free(&samples);
        scene_free(&scene);
    }
}

// Whatever the context made before, a frame has the same bits: nothing that lies past the end of a row counts, and the
// tiles do not either. Estimated reciprocals would show it, because they are not the quotients that even CoCs have.
static void divisions_again(struct hf_context *c, const char *isa, unsigned seed)
{
    struct rng rng = rng_seed(seed + 4100);
    for (int d = HF_DIVISION_ESTIMATE; d <= HF_DIVISION_NEWTON2; d++) {
        struct scene before = scene_new(&rng, SCENE_NOISE, 77, 41, 3), scene = scene_new(&rng, SCENE_BLOCKS, 77, 41, 3);
        struct hf_params p = scene_params();
        p.engine = HF_ENGINE_CHAPTER;
        p.chapter.division = (enum hf_division)d;
        struct hf_context *fresh = context_new(hf_context_isa(c), 1, 0, 0);
        struct hf_context *tiled = context_new(hf_context_isa(c), 1, 32, 32);
        struct picture want = render_scene(fresh, &scene, &p), other = render_scene(c, &before, &p),
                       got = render_scene(c, &scene, &p), small = render_scene(tiled, &scene, &p);
        CHECK_MSG(picture_same_bits(&want, &got), "%s, division %s: a second frame has other bits, %d of them", isa,
                  hf_name(HF_NAMES_DIVISION, d), samples_other(&want, &got));
        CHECK_MSG(picture_same_bits(&want, &small), "%s, division %s: tiles change %d samples", isa,
                  hf_name(HF_NAMES_DIVISION, d), samples_other(&want, &small));
        hf_close(&fresh);
        hf_close(&tiled);
        picture_free(&want);
        picture_free(&other);
        picture_free(&got);
        picture_free(&small);
        scene_free(&before);
        scene_free(&scene);
    }
}

// Estimated reciprocals are as exact as promised. One divides by the sum of a quad's weights, one by that of the far
// field, one by that of the upsampling. Each is a factor of the colour, and the other factor is at most the largest
// sample. An estimate has an error e: 1.5 / 4096 on x86, 1 / 256 on ARM. A Newton step leaves e squared and three
// roundings.
static void divisions(struct hf_context *c, const char *isa, unsigned seed)
{
    struct rng rng = rng_seed(seed + 4000);
    struct scene scene = scene_new(&rng, SCENE_NOISE, 77, 41, 3);
    const struct hf_depth depth = picture_depth(&scene.depth);
    struct hf_params p = scene_params();
    p.engine = HF_ENGINE_CHAPTER;
    struct picture exact = render(c, &scene.colour, &depth, &p);
    double most = 0, e = hf_context_isa(c) == HF_ISA_NEON ? 1 / 256.0 : 1.5 / 4096;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 77 * 41; i++)
            most = fmax(most, fabs(scene.colour.plane[k][i]));
    for (int d = HF_DIVISION_ESTIMATE; d <= HF_DIVISION_NEWTON2; d++) {
        double worst = 0;
        p.chapter.division = (enum hf_division)d;
        p.run.deterministic = 0;
        struct picture out = render(c, &scene.colour, &depth, &p);
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 77 * 41; i++)
                worst = worse(worst, fabs((double)out.plane[k][i] - exact.plane[k][i]));
        const double bound = (3 * e + 64 * U) * most;
        CHECK_MSG(worst <= bound, "%s, division %s: differs by %g, bound %g", isa, hf_name(HF_NAMES_DIVISION, d), worst,
                  bound);
        picture_free(&out);
        p.run.deterministic = 1;
        struct hf_params q = p;
        q.chapter.division = HF_DIVISION_EXACT;
        struct picture a = render(c, &scene.colour, &depth, &p), b = render(c, &scene.colour, &depth, &q);
        CHECK_MSG(picture_same_bits(&a, &b), "%s: division %s changes deterministic bits", isa,
                  hf_name(HF_NAMES_DIVISION, d));
        picture_free(&a);
        picture_free(&b);
        e = e * e + 3 * U;
    }
    picture_free(&exact);
    scene_free(&scene);
}

// With .deterministic every instruction set gives the bits of plain C.
static void deterministic(struct hf_context *scalar, struct hf_context *c, const char *isa, unsigned seed)
{
    for (int o = 0; o < OPTIONS; o++) {
        struct rng rng = rng_seed(seed + 3000 + (unsigned)o);
        struct scene scene = scene_new(&rng, SCENE_HIGHLIGHTS, 77, 41, 3 + o % 2);
        const struct hf_depth depth = picture_depth(&scene.depth);
        struct hf_params p = merge(&options[o].p);
        p.run.deterministic = 1;
        p.chapter.storage = (enum hf_storage)(o % 3);
        struct picture a = render(scalar, &scene.colour, &depth, &p), b = render(c, &scene.colour, &depth, &p);
        CHECK_MSG(picture_same_bits(&a, &b), "%s, deterministic, %s: not the bits of scalar", isa, options[o].name);
        picture_free(&a);
        picture_free(&b);
        scene_free(&scene);
    }
}

int main(int argc, char **argv)
{
    const unsigned seed = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 1;
    printf("seed %u\n", seed);
    struct hf_context *scalar = context_new(HF_ISA_SCALAR, 2, 0, 0);
    for (int isa = HF_ISA_SCALAR; isa <= HF_ISA_NEON; isa++) {
        if (!hf_isa_available((enum hf_isa)isa))
            continue;
        const char *name = hf_isa_name((enum hf_isa)isa);
        struct hf_context *c = context_new((enum hf_isa)isa, 2, 0, 0);
        CHECK_INT(hf_context_isa(c), isa);
        all_options(c, name, seed);
        all_scenes_and_storages(c, name, seed);
        all_depth_types(c, name, seed);
        divisions(c, name, seed);
        divisions_again(c, name, seed);
        deterministic(scalar, c, name, seed);
        hf_close(&c);
    }
    hf_close(&scalar);
    return check_report();
}
