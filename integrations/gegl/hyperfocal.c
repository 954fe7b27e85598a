// SPDX-License-Identifier: BSD-3-Clause
// GEGL's operation hyperfocal:defocus: a picture as input, its depth as aux. GEGL includes this file into itself, once for the
// properties and once for their use.
#include <glib.h>

#define GETTEXT_PACKAGE "hyperfocal"
#include <glib/gi18n-lib.h>

// clang-format off
#ifdef GEGL_PROPERTIES

enum_start(hyperfocal_depth)
    enum_value(HYPERFOCAL_DISTANCE, "distance", N_("Distance along the camera's axis"))
    enum_value(HYPERFOCAL_INVERSE, "inverse", N_("1 / distance"))
    enum_value(HYPERFOCAL_MAP_INVERSE, "map-inverse", N_("Map, white is near: 1 / distance grows evenly"))
    enum_value(HYPERFOCAL_MAP, "map", N_("Map, white is far: distance grows evenly"))
    enum_value(HYPERFOCAL_RADIUS, "radius", N_("Radius of the blur in pixels, negative in front"))
enum_end(HyperfocalDepth)

enum_start(hyperfocal_quality)
    enum_value(HYPERFOCAL_DRAFT, "draft", N_("Draft"))
    enum_value(HYPERFOCAL_STANDARD, "standard", N_("Standard"))
    enum_value(HYPERFOCAL_HIGH, "high", N_("High"))
    enum_value(HYPERFOCAL_BEST, "best", N_("Best"))
enum_end(HyperfocalQuality)

enum_start(hyperfocal_model)
    enum_value(HYPERFOCAL_LENS, "lens", N_("Lens"))
    enum_value(HYPERFOCAL_RANGE, "range", N_("Range"))
enum_end(HyperfocalModel)

property_enum(depth, _("Depth"), HyperfocalDepth, hyperfocal_depth, HYPERFOCAL_DISTANCE)
    description(_("What the numbers of the depth map (aux) mean"))
property_double(near_plane, _("Nearest"), 1.0)
    description(_("Distance of the nearest value of a map, scene units"))
    value_range(1e-6, 1e9) ui_range(0.1, 100.0) ui_gamma(2.0)
property_double(far_plane, _("Farthest"), 100.0)
    description(_("Distance of the farthest value of a map, scene units"))
    value_range(1e-6, 1e9) ui_range(1.0, 1000.0) ui_gamma(2.0)
property_double(focus, _("Focus"), 10.0)
    description(_("Distance in perfect focus, scene units"))
    value_range(1e-6, 1e9) ui_range(0.1, 100.0) ui_gamma(2.0)
property_enum(quality, _("Quality"), HyperfocalQuality, hyperfocal_quality, HYPERFOCAL_STANDARD)
    description(_("How accurate the picture is, and how slow"))
property_enum(model, _("Blur by"), HyperfocalModel, hyperfocal_model, HYPERFOCAL_LENS)
    description(_("How the blur follows from the distance"))
property_double(f_number, _("f-number"), 2.8)
    description(_("Lens: focal length over the aperture's diameter"))
    value_range(0.01, 1000.0) ui_range(0.5, 32.0) ui_gamma(2.0)
property_double(focal_length, _("Focal length (mm)"), 50.0)
    description(_("Lens: millimetres"))
    value_range(0.1, 10000.0) ui_range(10.0, 400.0) ui_gamma(2.0) ui_meta("unit", "mm")
property_double(sensor_width, _("Sensor width (mm)"), 36.0)
    description(_("Lens: millimetres"))
    value_range(0.1, 10000.0) ui_range(4.0, 60.0) ui_meta("unit", "mm")
property_double(world_unit, _("Scene unit (m)"), 1.0)
    description(_("Lens: metres of a scene unit"))
    value_range(1e-6, 1e6) ui_range(0.001, 10.0) ui_gamma(3.0) ui_meta("unit", "m")
property_double(distance, _("Range"), -1.0)
    description(_("Range: from the focus to full blur, scene units; -1 is half the focus"))
    value_range(-1.0, 1e9) ui_range(-1.0, 100.0)
property_double(strength, _("Strength"), 1.0)
    description(_("Range: amount of blur"))
    value_range(0.0, 1.0)
property_double(max_radius, _("Largest radius (pixels)"), -1.0)
    description(_("Largest blur radius in pixels; -1 is what the lens asks for, or 12 pixels at 1080 lines with a range"))
    value_range(-1.0, 2048.0) ui_range(-1.0, 100.0) ui_meta("unit", "pixel-distance")
property_int(blades, _("Blades"), 0)
    description(_("Sides of the aperture; 0 is a disc, else 3 to 16"))
    value_range(0, 16)
property_double(rotation, _("Rotation (degrees)"), 0.0)
    description(_("Of the aperture"))
    value_range(-360.0, 360.0) ui_meta("unit", "degree")
property_double(roundness, _("Roundness"), 0.0)
    description(_("How far the aperture's sides bend: 0 straight, 1 a disc"))
    value_range(0.0, 1.0)
property_double(ring, _("Ring"), 0.0)
    description(_("Radius of a central obstruction, of the aperture's"))
    value_range(0.0, 0.95)
property_double(cat_eye, _("Cat's eye"), 0.0)
    description(_("How far highlights in the corners are cut"))
    value_range(0.0, 1.0)
property_double(squeeze, _("Squeeze"), 1.0)
    description(_("Height over width of a highlight"))
    value_range(0.25, 4.0)
property_double(chromatic, _("Chromatic aberration"), 0.0)
    description(_("Red highlights larger by this fraction behind the focus, blue ones in front"))
    value_range(-0.5, 0.5)
property_double(highlight_gain, _("Highlight gain"), 1.0)
    description(_("What white counts as while it is blurred: clipped lamps get their light back"))
    value_range(1.0, 64.0)
property_double(highlight_threshold, _("Highlight threshold"), 0.9)
    description(_("Linear luminance above which the gain sets in"))
    value_range(0.0, 0.99)

#else
// clang-format on

#define GEGL_OP_COMPOSER
#define GEGL_OP_NAME hyperfocal
#define GEGL_OP_C_SOURCE hyperfocal.c

#include "gegl-op.h"

#include <math.h>

#include "hyperfocal/hyperfocal.h"

// The blur of a pixel comes from anywhere: the operation takes all of its inputs, and makes all of its output at once.
static GeglRectangle whole(GeglOperation *operation, const gchar *pad)
{
    const GeglRectangle *box = gegl_operation_source_get_bounding_box(operation, pad);
    return box ? *box : *GEGL_RECTANGLE(0, 0, 0, 0);
}

static GeglRectangle get_bounding_box(GeglOperation *operation)
{
    return whole(operation, "input");
}

static GeglRectangle get_required_for_output(GeglOperation *operation, const gchar *pad, const GeglRectangle *roi)
{
    const GeglRectangle box = whole(operation, pad);
    return gegl_rectangle_is_infinite_plane(&box) ? *roi : box;
}

static GeglRectangle get_cached_region(GeglOperation *operation, const GeglRectangle *roi)
{
    return get_required_for_output(operation, "input", roi);
}

static int has_alpha(const Babl *format)
{
    return !format || babl_format_has_alpha(format);
}

// Whole numbers of a map are its values; those of a picture of floats are linear. The samples are those of `format`.
static const Babl *depth_format(const Babl *format)
{
    const Babl *type = format ? babl_format_get_type(format, 0) : NULL;
    const int floats = !type || type == babl_type("float") || type == babl_type("half") || type == babl_type("double");
    return babl_format_with_space(floats ? "Y float" : "Y' float", format);
}

static void prepare(GeglOperation *operation)
{
    const Babl *format = gegl_operation_get_source_format(operation, "input");
    const Babl *own = babl_format_with_space(has_alpha(format) ? "RaGaBaA float" : "RGB float", format);
    gegl_operation_set_format(operation, "input", own);
    gegl_operation_set_format(operation, "output", own);
    gegl_operation_set_format(operation, "aux", depth_format(gegl_operation_get_source_format(operation, "aux")));
}

static struct hf_params params_of(const GeglProperties *o)
{
    struct hf_params p = hf_default_params();
    p.engine = HF_ENGINE_LAYERS;
    p.model = o->model == HYPERFOCAL_LENS ? HF_MODEL_LENS : HF_MODEL_RANGE;
    p.focus = (float)o->focus;
    p.lens.f_number = (float)o->f_number;
    p.lens.focal_length_mm = (float)o->focal_length;
    p.lens.sensor_width_mm = (float)o->sensor_width;
    p.lens.world_unit_m = (float)o->world_unit;
    p.range.distance = o->distance < 0 ? HF_DERIVE : (float)o->distance;
    p.range.strength = (float)o->strength;
    p.max_radius = o->max_radius < 0 ? HF_DERIVE : (float)o->max_radius;
    p.aperture.blades = o->blades;
    p.aperture.rotation = (float)o->rotation;
    p.aperture.roundness = (float)o->roundness;
    p.aperture.ring = (float)o->ring;
    p.aperture.cat_eye = (float)o->cat_eye;
    p.aperture.squeeze = (float)o->squeeze;
    p.aperture.chromatic = (float)o->chromatic;
    p.highlight.gain = (float)o->highlight_gain;
    p.highlight.threshold = (float)o->highlight_threshold;
    return p;
}

// A map's values as distances, or as 1 / distance.
static void map_depth(const GeglProperties *o, float *depth, size_t n)
{
    const int inverse = o->depth == HYPERFOCAL_MAP_INVERSE;
    const float at_0 = (float)(inverse ? 1 / o->far_plane : o->near_plane);
    const float at_1 = (float)(inverse ? 1 / o->near_plane : o->far_plane);
    if (inverse || o->depth == HYPERFOCAL_MAP)
        for (size_t i = 0; i < n; i++)
            depth[i] = at_0 + (at_1 - at_0) * depth[i];
}

static void say(void *cookie, const struct hf_message *message)
{
    (void)cookie;
    if (message->level != HF_LOG_INFO)
        g_warning("hyperfocal:defocus: %s", message->sentence);
}

// Blur colour in place.
static int defocus(const GeglProperties *o, const struct hf_image *colour, float *data)
{
    const struct hf_config config = {.size = sizeof config, .log = say};
    const struct hf_depth depth = {.size = sizeof depth,
                                   .data = data,
                                   .stride = colour->width * (ptrdiff_t)sizeof *data,
                                   .type = o->depth == HYPERFOCAL_RADIUS ? HF_DEPTH_COC
                                           : o->depth == HYPERFOCAL_INVERSE || o->depth == HYPERFOCAL_MAP_INVERSE
                                               ? HF_DEPTH_INVERSE
                                               : HF_DEPTH_VIEW};
    struct hf_params p = params_of(o);
    struct hf_context *c = NULL;
    map_depth(o, data, (size_t)colour->width * (size_t)colour->height);
    int error =
        hf_choose_quality(colour->height, &depth, &p, (enum hf_quality)(o->quality - HYPERFOCAL_DRAFT), NULL, NULL);
    if (!error)
        error = hf_open(&c, &config);
    if (!error)
        error = hf_render(c, colour, colour, &depth, &p);
    hf_close(&c);
    return error;
}

static gboolean process(GeglOperation *operation, GeglBuffer *input, GeglBuffer *aux, GeglBuffer *output,
                        const GeglRectangle *result, gint level)
{
    const GeglRectangle box = *gegl_buffer_get_extent(input);
    const Babl *format = gegl_operation_get_format(operation, "output");
    const int channels = has_alpha(format) ? 4 : 3;
    (void)level;
    if (!aux || box.width < 1 || box.height < 1) {
        gegl_buffer_copy(input, result, GEGL_ABYSS_NONE, output, result);
        return TRUE;
    }
    float *colour = g_try_malloc_n((gsize)box.width * (gsize)box.height, (gsize)channels * sizeof(float));
    float *depth = g_try_malloc_n((gsize)box.width * (gsize)box.height, sizeof(float));
    const struct hf_image image = {.size = sizeof image,
                                   .width = box.width,
                                   .height = box.height,
                                   .format = channels == 4 ? HF_FORMAT_RGBA32F : HF_FORMAT_RGB32F,
                                   .data = {colour},
                                   .stride = {box.width * (ptrdiff_t)(channels * (int)sizeof(float))}};
    int error = colour && depth ? HF_OK : HF_ERR_MEMORY;
    if (error)
        g_warning("hyperfocal:defocus: out of memory for %d x %d pixels", box.width, box.height);
    if (!error) {
        gegl_buffer_get(input, &box, 1.0, format, colour, GEGL_AUTO_ROWSTRIDE, GEGL_ABYSS_NONE);
        gegl_buffer_get(aux, &box, 1.0, depth_format(gegl_buffer_get_format(aux)), depth, GEGL_AUTO_ROWSTRIDE,
                        GEGL_ABYSS_CLAMP);
        error = defocus(GEGL_PROPERTIES(operation), &image, depth);
    }
    // On an error the picture stays as it is.
    if (error)
        gegl_buffer_copy(input, result, GEGL_ABYSS_NONE, output, result);
    else
        gegl_buffer_set(output, &box, 0, format, colour, GEGL_AUTO_ROWSTRIDE);
    g_free(colour);
    g_free(depth);
    return TRUE;
}

static void gegl_op_class_init(GeglOpClass *klass)
{
    GeglOperationClass *operation = GEGL_OPERATION_CLASS(klass);
    operation->prepare = prepare;
    operation->get_bounding_box = get_bounding_box;
    operation->get_required_for_output = get_required_for_output;
    operation->get_cached_region = get_cached_region;
    // The library has threads of its own.
    operation->threaded = FALSE;
    GEGL_OPERATION_COMPOSER_CLASS(klass)->process = process;
    gegl_operation_class_set_keys(operation, "name", "hyperfocal:defocus", "title", _("Depth of field (hyperfocal)"),
                                  "categories", "blur", "description",
                                  _("Blur a picture as a lens would have taken it, by a map of its depth (aux)"), NULL);
}

#endif
