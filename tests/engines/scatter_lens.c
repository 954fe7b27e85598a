// SPDX-License-Identifier: BSD-3-Clause
// The scatter's lens: the size of a highlight for every parameter of the camera, and options that must be neutral.
#include <math.h>

#include "support/check.h"
#include "support/render.h"

static const double PI = 3.14159265358979323846;
enum { SIZE = 120, MIDDLE = SIZE / 2 };

static struct hf_params lens_params(void)
{
    struct hf_params p = hf_default_params();
    p.engine = HF_ENGINE_SCATTER;
    p.model = HF_MODEL_LENS;
    p.focus = 2;
    p.lens.f_number = 0.07f;
    return p;
}

// One highlight before black, at depth z.
static struct picture spot(struct hf_context *c, const struct hf_params *p, float z)
{
    struct picture colour = picture_new(SIZE, SIZE, 3), depth = picture_new(SIZE, SIZE, 1);
    for (int i = 0; i < SIZE * SIZE; i++)
        depth.plane[0][i] = z;
    for (int k = 0; k < 3; k++)
        colour.plane[k][MIDDLE * SIZE + MIDDLE] = 1e4f;
    const struct hf_depth d = picture_depth(&depth);
    const struct picture out = render(c, &colour, &d, p);
    picture_free(&colour);
    picture_free(&depth);
    return out;
}

// The radius of a disc that has the highlight's energy at the brightness of its middle.
static double radius_of(const struct picture *p)
{
    double energy = 0;
    for (int i = 0; i < SIZE * SIZE; i++)
        energy += p->plane[1][i];
    return sqrt(energy / p->plane[1][MIDDLE * SIZE + MIDDLE] / PI);
}

// r = |K (1 / P - 1 / z)|, K = aperture radius x focal length in pixels, limited to the largest radius.
static double expected(const struct hf_params *p, double z)
{
    const double aperture = p->lens.focal_length_mm / 1000.0 / (2 * p->lens.f_number) / p->lens.world_unit_m;
    const double width = p->view.display_width != HF_DERIVE ? p->view.display_width : SIZE;
    const double r = aperture * p->lens.focal_length_mm / p->lens.sensor_width_mm * width * fabs(1 / p->focus - 1 / z);
    return p->max_radius == HF_DERIVE ? r : fmin(r, p->max_radius);
}

static void camera(struct hf_context *c)
{
    const struct hf_params base = lens_params();
    struct {
        const char *name;
        struct hf_params p;
    } cases[8];
    int n = 0;
#define CASE(field, value) cases[n].name = #field, cases[n].p = base, cases[n++].p.field = value
    CASE(lens.f_number, 0.1f);
    CASE(lens.focal_length_mm, 35);
    CASE(lens.sensor_width_mm, 60);
    CASE(lens.world_unit_m, 2);
    CASE(focus, 2.5f);
    CASE(view.display_width, 200);
    CASE(max_radius, 7);
    CASE(max_radius, HF_DERIVE);
    static const float depths[] = {1.4f, 4};
    for (int d = 0; d < 2; d++) {
        struct picture plain = spot(c, &base, depths[d]);
        for (int i = 0; i < n; i++) {
            struct picture out = spot(c, &cases[i].p, depths[d]);
            const double got = radius_of(&out), want = expected(&cases[i].p, depths[d]);
            CHECK_MSG(want > 4 && fabs(got - want) <= 0.5, "%s, depth %g: radius %g, expected %g", cases[i].name,
                      depths[d], got, want);
            CHECK_MSG(picture_same_bits(&out, &plain) == (i == n - 1), "%s, depth %g: %s", cases[i].name, depths[d],
                      i == n - 1 ? "not neutral" : "no effect");
            picture_free(&out);
        }
        picture_free(&plain);
    }
}

// Options of a model that is not chosen, and options at their defaults, change no bit.
static void neutral(struct hf_context *c)
{
    const struct hf_params base = lens_params();
    struct hf_params cases[6];
    for (int i = 0; i < 6; i++)
        cases[i] = base;
    cases[0].aperture.rotation = 30;  // of a disc
    cases[1].aperture.roundness = 0.7f;
    cases[2].max_radius = 200;  // beyond all radii in the frame
    cases[3].aperture.ring = cases[3].aperture.chromatic = cases[3].aperture.cat_eye = 0;
    cases[4].aperture.squeeze = cases[4].view.pixel_aspect = 1;
    cases[5].scatter.resolution = HF_RESOLUTION_FULL;
    struct picture plain = spot(c, &base, 4);
    for (int i = 0; i < 6; i++) {
        struct picture out = spot(c, &cases[i], 4);
        CHECK_MSG(picture_same_bits(&out, &plain), "option %d is not neutral", i);
        picture_free(&out);
    }
    // The converse: each option has an effect once it has another value.
    struct hf_params blades = base;
    blades.aperture.blades = 5;
    struct picture five = spot(c, &blades, 4);
    for (int i = 0; i < 2; i++) {
        struct hf_params p = blades;
        p.aperture.rotation = i ? 0 : 30;
        p.aperture.roundness = i ? 0.7f : 0;
        struct picture out = spot(c, &p, 4);
        CHECK_MSG(!picture_same_bits(&out, &five), "blades: option %d has no effect", i);
        picture_free(&out);
    }
    picture_free(&five);
    picture_free(&plain);
}

int main(void)
{
    struct hf_context *c;
    const struct hf_config config = scene_config(HF_ISA_AUTO, 2);
    CHECK_INT(hf_open(&c, &config), HF_OK);
    camera(c);
    neutral(c);
    hf_close(&c);
    return check_report();
}
