// SPDX-License-Identifier: BSD-3-Clause
//
// hyperfocal: depth of field for rendered pictures, on the CPU.
//
// Give it a colour picture and its depth, get back what a lens would have seen. Typical use:
//
//     struct hf_context *c;
//     struct hf_params p = hf_default_params;      // copy the defaults, change what you need
//     p.focus = 20.0f;
//     p.range.distance = 10.0f;
//     if (hf_open(&c, NULL) == HF_OK)
//         err = hf_render(c, &picture, &picture, &depth, &p);      // in place
//     hf_close(&c);
//
// Words. "CoC" is the circle of confusion. Its radius is given in full-resolution pixels, negative in front of
// the plane in focus (near), positive behind it (far). Depth is view depth unless said otherwise: positive distance
// along the camera axis, in scene units. Pixel centres lie at +0.5. Colours are linear and premultiplied by alpha.
// "Chapter" is W. Sterna, "Practical Gather-based Bokeh Depth of Field", GPU Zen 2, the source of the default engine
// and of its names.
//
// A context may be used by one thread at a time; any number of contexts may be used at once. After fork() the child
// has none of the context's threads: a context that has threads of its own answers HF_ERR_THREAD there, and hf_close
// frees its memory. Functions return HF_OK (0) or a negative enum hf_error; none of them prints, exits or aborts.
#ifndef HYPERFOCAL_H
#define HYPERFOCAL_H

#include <stddef.h>
#include <stdint.h>

#include "version.h"

#ifdef __cplusplus
extern "C" {
#endif

// On Windows define HF_STATIC before the include where the static library is linked.
#if defined(_WIN32) && defined(HF_STATIC)
#define HF_API
#elif defined(_WIN32) && defined(HF_BUILDING)
#define HF_API __declspec(dllexport)
#elif defined(_WIN32)
#define HF_API __declspec(dllimport)
#else
#define HF_API __attribute__((visibility("default")))
#endif

enum hf_error {
    HF_OK = 0,
    HF_ERR_ARG = -1,        // an argument is out of its documented range; the log names it and its value
    HF_ERR_MEMORY = -2,     // the allocator returned NULL
    HF_ERR_THREAD = -3,     // a thread could not be started, or is not in this process (after fork)
    HF_ERR_ISA = -4,        // the instruction set asked for is not one of this CPU or of this build
    HF_ERR_FOCUS = -5,      // there is no surface where focus was to be read
    HF_ERR_CANCELLED = -6,  // hf_cancel was called, or the progress callback asked for it
};

// One sentence for an error code; never NULL, also for numbers that are no code.
HF_API const char *hf_error_string(int error);

// Version of the library in use as "major.minor.patch"; compare with HF_VERSION_* of the header.
HF_API const char *hf_version(void);

// Instruction sets, lowest first. AUTO is the best one that CPU and build have, unless the environment variable
// HYPERFOCAL_ISA holds another one's name (scalar, sse4.1, avx2, avx512, neon; anything else is HF_ERR_ISA).
enum hf_isa { HF_ISA_AUTO, HF_ISA_SCALAR, HF_ISA_SSE41, HF_ISA_AVX2, HF_ISA_AVX512, HF_ISA_NEON };

// The command line's name for an instruction set; NULL for a number that is none.
HF_API const char *hf_isa_name(enum hf_isa isa);
// 1 if this CPU and this build can run it, else 0. AUTO and SCALAR always can.
HF_API int hf_isa_available(enum hf_isa isa);

enum hf_log_level { HF_LOG_ERROR, HF_LOG_WARNING, HF_LOG_INFO };

// How a context is set up. All zero is the default and means: own threads, malloc, no log.
struct hf_config {
    // Threads to work on, counting the caller. 0 (default) means one per online processor; at most 256. With
    // parallel_for it is the number of worker slots that the host promises never to exceed.
    int threads;
    // Highest instruction set to use. Default HF_ISA_AUTO. HF_ERR_ISA if not available.
    enum hf_isa isa;

    // Allocator. Both or neither; default malloc's family. alloc returns size bytes aligned to align (a power of
    // two), or NULL. The library allocates on hf_open and on the first frame of a size, not per frame. The thread
    // stacks and what the C library needs for threads are not taken from here.
    void *(*alloc)(void *cookie, size_t size, size_t align);
    void (*free)(void *cookie, void *ptr);
    void *alloc_cookie;

    // Receives one line without line break for each error, warning or note. Called on the caller's thread.
    void (*log)(void *cookie, enum hf_log_level level, const char *message);
    void *log_cookie;

    // Size of the tiles that threads are given, half-resolution pixels: 0 (default) is what measured fastest, else
    // 16 to 65536, tile_width a multiple of 16. Changes speed and memory, never a bit.
    int tile_width, tile_height;

    // The host's own threads. Must call fn(arg, i, worker) once for each i in [0, n), from any threads, with
    // 0 <= worker < threads and no worker number in use twice at a time, and return when all are done. When NULL
    // (default) the library starts threads of its own, once, in hf_open.
    void (*parallel_for)(void *cookie, int n, void (*fn)(void *arg, int i, int worker), void *arg);
    void *parallel_cookie;
};

struct hf_context;

// Make a context. config may be NULL (defaults) and need only live until the call returns. On error *out is NULL.
// Errors: HF_ERR_ARG, HF_ERR_MEMORY, HF_ERR_THREAD, HF_ERR_ISA.
HF_API int hf_open(struct hf_context **out, const struct hf_config *config);

// Stop the threads, free everything, set *c to NULL. c or *c may be NULL.
HF_API void hf_close(struct hf_context **c);

// What the context really uses, after AUTO and 0 have been resolved.
HF_API enum hf_isa hf_context_isa(const struct hf_context *c);
HF_API int hf_context_threads(const struct hf_context *c);

// Layout of the pixels of an image.
enum hf_format {
    HF_FORMAT_RGBA32F,     // 4 floats a pixel
    HF_FORMAT_RGB32F,      // 3 floats a pixel
    HF_FORMAT_RGBA16F,     // 4 IEEE half floats a pixel
    HF_FORMAT_R11G11B10F,  // one 32-bit word a pixel: R in bits 0-10, G 11-21, B 22-31; 5 exponent bits, no sign
    HF_FORMAT_PLANAR32F,   // three or four planes of floats
    // Whole numbers, 0 for 0 and the largest for 1; hf_image.transfer says how they follow from light.
    HF_FORMAT_RGBA8,    // 4 bytes a pixel: R, G, B, A in memory
    HF_FORMAT_BGRA8,    // B, G, R, A
    HF_FORMAT_RGBX8,    // R, G, B and a byte without meaning: read as alpha 1, written as 255
    HF_FORMAT_BGRX8,    // B, G, R and the same
    HF_FORMAT_RGB10A2,  // one 32-bit word a pixel: R in bits 0-9, G 10-19, B 20-29, A 30-31
    HF_FORMAT_RGBA16,   // 4 16-bit numbers a pixel
};

// How the numbers of a format of whole numbers follow from light. Alpha is always linear.
enum hf_transfer {
    HF_TRANSFER_LINEAR,
    HF_TRANSFER_SRGB,  // IEC 61966-2-1: what a display is sent
};

// A picture in the caller's memory. Any stride of at least one row's bytes, or of at most minus that (bottom-up
// pictures: data points to the top row). What lies between rows is neither read nor written.
struct hf_image {
    int width, height;  // pixels, 1..65536 each
    enum hf_format format;
    void *data[4];        // top left pixel. PLANAR32F: R, G, B, A (A may be NULL: no alpha). Others: data[0]
    ptrdiff_t stride[4];  // bytes from one row to the next, one per plane in use
    // Default (0) HF_TRANSFER_LINEAR. HF_TRANSFER_SRGB for formats of whole numbers alone, else HF_ERR_ARG.
    enum hf_transfer transfer;
};

// What the numbers of a depth buffer mean; z is view depth. "No surface" counts as infinitely far.
enum hf_depth_type {
    HF_DEPTH_VIEW,          // z itself; 0, negative, >= 1e10 and +Inf: no surface
    HF_DEPTH_RAY,           // distance along the pixel's ray: z = t / sqrt(1 + tan^2); no surface as for VIEW
    HF_DEPTH_NDC_D3D,       // 0 at near_plane .. 1 at far_plane (also OpenGL's window depth)
    HF_DEPTH_NDC_GL,        // -1 at near_plane .. 1 at far_plane
    HF_DEPTH_NDC_REVERSED,  // 1 at near_plane .. 0 at far_plane: d = n(f-z)/(z(f-n)), with infinite far d = n/z
    HF_DEPTH_INVERSE,       // 1/z; 0 or negative: no surface
    HF_DEPTH_COC,           // signed CoC radius in full-resolution pixels, no lens or range is applied
};

// How a depth sample is stored. Whole numbers are divided by their largest: 0..1, for the NDC types, HF_DEPTH_INVERSE, or
// whatever hf_depth.type makes of it. They count as the nearest float. The log warns of some that are surely no distances.
enum hf_depth_format {
    HF_DEPTH_FORMAT_FLOAT32,
    HF_DEPTH_FORMAT_FLOAT16,
    HF_DEPTH_FORMAT_UNORM16,
    HF_DEPTH_FORMAT_UNORM32,
    HF_DEPTH_FORMAT_D24S8,  // a 32-bit word, depth in its upper 24 bits: OpenGL's UNSIGNED_INT_24_8
    HF_DEPTH_FORMAT_X8D24,  // a 32-bit word, depth in its lower 24 bits: Direct3D, Vulkan
};

// Depth of a picture, same width and height. It is never written. A NaN counts as the largest finite depth among
// its 8 neighbours, else as no surface.
struct hf_depth {
    const void *data;             // top left pixel
    ptrdiff_t stride;             // bytes from one row to the next, as for hf_image
    enum hf_depth_type type;      // default (0): HF_DEPTH_VIEW
    enum hf_depth_format format;  // default (0): HF_DEPTH_FORMAT_FLOAT32
    // Clip planes, scene units, for NDC_*: 0 < near_plane < far_plane. far_plane may be INFINITY. The gaussian engine
    // measures depth by them, whatever the type: 0 (default) means 1 and 100 times that.
    float near_plane, far_plane;
    // For RAY: focal length in pixels (> 0), and the picture's optical axis in pixels from the top left corner.
    float focal_px, center_x, center_y;
};

// The view depth at pixel (x, y) of a width x height depth buffer of at most 65536 each: what the focus commands of a
// viewer read. For HF_DEPTH_COC there is no distance: HF_ERR_ARG. HF_ERR_FOCUS if there is no surface.
HF_API int hf_depth_at(const struct hf_depth *depth, int width, int height, int x, int y, float *z);

enum hf_engine {
    HF_ENGINE_GATHER,    // Sterna's gather over half-resolution near and far fields: nine passes
    HF_ENGINE_HEXAGON,   // hexagonal bokeh in two passes of directional blurs (White and Barre-Brisebois, 2011)
    HF_ENGINE_SCATTER,   // every pixel becomes its aperture's picture (Wronski, 2012)
    HF_ENGINE_GAUSSIAN,  // iterated 5-tap blur blended by depth, with autofocus (2010)
    HF_ENGINE_LAYERS,  // un-mixed edges, hidden surfaces filled in, slices put together in order of depth: most accurate
    HF_ENGINE_COUNT,   // how many there are: none itself
};

// The command line's name for an engine; NULL for a number that is none. As hf_name(HF_NAMES_ENGINE, engine).
HF_API const char *hf_engine_name(enum hf_engine engine);

// Size of the buffers in which hexagon, scatter and gaussian work. Smaller is faster and softer. gather works at half
// resolution, layers at several at once.
enum hf_resolution {
    HF_RESOLUTION_FULL,
    HF_RESOLUTION_HALF,     // half the width and half the height
    HF_RESOLUTION_QUARTER,  // a quarter of each; gaussian only
};

// How the normalised near and far CoC follow from depth.
enum hf_model {
    HF_MODEL_RANGE,  // focus distance F and range R: the chapter's empirical model
    HF_MODEL_LENS,   // a thin lens: radius K * (1/P - 1/z), see struct hf_lens_params
};

// How the gather stores intermediate buffers between passes.
enum hf_storage {
    HF_STORAGE_FLOAT,   // float32 everywhere
    HF_STORAGE_HALF,    // float16 everywhere, the colour read and the result included; clamped to +-65504
    HF_STORAGE_PACKED,  // the chapter's: R11G11B10F truncated towards zero for colour, 8 bits rounded for CoC, the
                        // colour read and the result included; alpha stays float32
};

// How the gaps between the gather's taps are closed (chapter 3.3.5).
enum hf_fill {
    HF_FILL_MAX,  // 3x3 maximum: brighter highlights than energy allows, the chapter's choice. Far neighbours come in by and
                  // by over the first quarter of their CoC, but with .faithful
    HF_FILL_MEAN,  // no gaps: each tap is the mean over its part of the aperture's area, which keeps energy; 3x3 mean with
                   // .faithful or where downsample or division are not the default
    HF_FILL_NONE,  // none; instead 144 taps, a 12x12 grid mapped to the disc (Shirley and Chiu 1997)
    HF_FILL_OPEN,  // none, and no more taps: gaps stay
};

// How the gather makes a pixel of half resolution of four (chapter 3.3.2).
enum hf_downsample {
    HF_DOWNSAMPLE_BILATERAL,  // near: their mean; far: weighed by how alike their CoCs are to the first one's
    HF_DOWNSAMPLE_LINEAR,     // their mean: what is in focus beside the far field gets into it
    HF_DOWNSAMPLE_POINT,      // the first of them: no filter, so that what is small comes and goes
};

// How the gather divides by sums of weights.
enum hf_division {
    HF_DIVISION_EXACT,     // to nearest
    HF_DIVISION_ESTIMATE,  // by what the processor estimates the reciprocal to be, 8 to 14 bits of it
    HF_DIVISION_NEWTON,    // and a step of Newton's, which doubles the bits
    HF_DIVISION_NEWTON2,   // and two
};

enum hf_blend {
    HF_BLEND_LINEAR,      // CoC grows linearly between begin and end
    HF_BLEND_SMOOTHSTEP,  // 3t^2 - 2t^3 of that
};

// What a scene asks of a tile.
enum hf_tile { HF_TILE_SHARP, HF_TILE_NEAR, HF_TILE_FAR, HF_TILE_BOTH };

// Why a CoC radius cannot be larger than max_radius.
enum hf_limit {
    HF_LIMIT_NONE,     // nothing limits it short of the 2048 pixels that there can be
    HF_LIMIT_GIVEN,    // max_radius was given
    HF_LIMIT_MODEL,    // the range model blurs up to 12 pixels at 1080 lines unless told otherwise
    HF_LIMIT_ENGINE,   // the engine reaches no farther unless told otherwise
    HF_LIMIT_PICTURE,  // aperture.picture is drawn up to this size
};

// The words that command lines and files have for values. NULL for a number that is none.
enum hf_names {
    HF_NAMES_ISA,        // auto, scalar, sse4.1, avx2, avx512, neon
    HF_NAMES_LOG_LEVEL,  // error, warning, info
    // rgba32f, rgb32f, rgba16f, r11g11b10f, planar32f, rgba8, bgra8, rgbx8, bgrx8, rgb10a2, rgba16
    HF_NAMES_FORMAT,
    HF_NAMES_TRANSFER,      // linear, srgb
    HF_NAMES_DEPTH_FORMAT,  // float32, float16, unorm16, unorm32, d24s8, x8d24
    HF_NAMES_DEPTH_TYPE,    // view, ray, ndc-d3d, ndc-gl, ndc-reversed, inverse, coc
    HF_NAMES_ENGINE,        // gather, hexagon, scatter, gaussian, layers
    HF_NAMES_RESOLUTION,    // full, half, quarter
    HF_NAMES_MODEL,         // range, lens
    HF_NAMES_STORAGE,       // float, half, packed
    HF_NAMES_FILL,          // max, mean, none, open
    HF_NAMES_BLEND,         // linear, smoothstep
    HF_NAMES_TILE,          // sharp, near, far, both
    HF_NAMES_LIMIT,         // none, given, model, engine, picture
    HF_NAMES_QUALITY,       // draft, standard, high, best
    HF_NAMES_DOWNSAMPLE,    // bilateral, linear, point
    HF_NAMES_DIVISION,      // exact, estimate, newton, newton2
    HF_NAMES_LAYERS,        // standard, draft, high, best: enum hf_layers_quality
    HF_NAMES_COUNT
};
HF_API const char *hf_name(enum hf_names of, int value);
// The other way: HF_OK with the value in *value, or HF_ERR_ARG for a word that is none. "chapter" is an old word for
// packed.
HF_API int hf_value(enum hf_names of, const char *name, int *value);

// Value of whatever can be worked out from the rest, and is unless it is given: see each "HF_DERIVE". hf_resolve tells
// what comes of it.
#define HF_DERIVE (-1)

// Distances of the range model, scene units of view depth; used with HF_MODEL_RANGE alone, but for blend.
struct hf_range_params {
    // Distance over which sharp turns into fully blurred, on both sides of the focus: >= 0, INFINITY for no blur at
    // all. HF_DERIVE (default): half the focus distance. Chapter 3.2.
    float distance;
    // 0 (the input, bit for bit) to 1 (default). From 0.25 up it scales the kernel's radius; below, the kernel stays at
    // a quarter and the result is blended with the input by 4 * strength. Chapter, listing 3.14.
    float strength;
    // Near blur is full up to near_begin and gone at near_end; far blur starts at far_begin and is full at far_end:
    // >= 0, near_begin <= near_end <= far_begin <= far_end, as nothing is near and far at once. HF_DERIVE (default):
    // max(0, F - R), F, F, F + R. Chapter, figure 3.2.
    float near_begin, near_end, far_begin, far_end;
    enum hf_blend blend;  // default HF_BLEND_LINEAR
};

// Lens model: r(z) = K (1/focus - 1/z), K = aperture radius in scene units * focal length in pixels, aperture radius =
// focal_length_mm / 1000 / (2 f_number) / world_unit_m, focal length in pixels = focal_length_mm / sensor_width_mm *
// display width * pixel_aspect, as radii count pixels of y. All > 0 and finite, but f_number may be INFINITY (no blur).
struct hf_lens_params {
    float f_number;         // default 2.8
    float focal_length_mm;  // millimetres, default 50
    float sensor_width_mm;  // millimetres, default 36
    float world_unit_m;     // metres per scene unit, default 1
};

// Shape of the aperture. What an engine cannot draw is HF_ERR_ARG: gather takes blades and rotation, hexagon its own six
// sides and rotation, layers and scatter all, gaussian none.
struct hf_aperture_params {
    // 0 (default) a disc, else a regular polygon with 3 to 16 sides, the middle of one on the +x axis turned by rotation
    // degrees (any finite value, default 0; whole turns do not count).
    int blades;
    float rotation;
    // Sides of the polygon bent towards the circle around it: 0 (default) straight .. 1 a disc.
    float roundness;
    // Radius of a central obstruction, as a mirror lens has, over the aperture's, and of its shape: 0 (default, none)
    // .. 0.95.
    float ring;
    // Mechanical vignetting: how far the exit pupil's second circle moves towards the picture's corner there, in
    // aperture radii, 0 (default, none) .. 1. Highlights in the corners become cat's eyes.
    float cat_eye;
    // Anamorphic squeeze: height over width of a highlight, 0.25..4, default 1. Heights are kept.
    float squeeze;
    // Axial chromatic aberration: red CoCs are larger by this fraction and blue ones smaller (behind the focus; the
    // other way in front of it), -0.5..0.5, default 0.
    float chromatic;
    // A picture of the aperture, its centre the lens's axis and its shorter side the diameter; brightness is
    // transmission, per channel. NULL (default): the shape above. Must stay alive and unchanged during the call. Every
    // pixel of it is drawn, so its cost grows with the square of the radius, which is at most 256 then, and at most 512 /
    // sqrt(w) where squeeze and pixel_aspect make it w > 4 times as wide as high. It is the whole shape: blades, roundness,
    // ring and cat_eye with it are HF_ERR_ARG.
    const struct hf_image *picture;
};

// Light that a clipped picture has lost is given back before the blur and taken away after it, so that a lamp held as 1
// leaves a disc and the paper beside it does not. The luminance m, 0.2126 R + 0.7152 G + 0.0722 B of what is above 0
// (Rec. 709), becomes m + (gain - 1) t^2, t = (m - threshold) / (1 - threshold) within 0..1; R, G and B above 0 grow alike. So
// white grows to gain, and paint that is full in one channel stays. Back it goes the same way: what is evenly bright stays
// as it was; only where light falls on what is full of one colour may that channel exceed 1, as on a sensor. A pixel that
// the blur leaves alone keeps its bits.
struct hf_highlight_params {
    // What 1 becomes, as a multiple, 1 (default: all stays as it is, and costs nothing) to 64; 8 are three stops. Ours.
    float gain;
    // Luminance from which there is more: 0 to 0.99, default 0.9 (a grey of 243 in sRGB). Not looked at when gain is 1.
    float threshold;
};

// Of what picture the image given is a part, and of what pixels. Pixels of coarser resolutions are counted from the part's
// own top left corner: where it is to have the bits of the whole, it begins at even x and y of that for gather, and at
// multiples of 4 for the other engines (there are none for HF_LAYERS_BEST).
struct hf_view_params {
    // Size of the whole picture when the image given is a part of it: pixels, > 0. HF_DERIVE (default): the image's own.
    // Only scales blur: the height max_radius, the width the lens.
    int display_width, display_height;
    // Width of a pixel over its height, 0.1 to 10, default 1. Blur is narrower by this, counted in pixels of x.
    float pixel_aspect;
};

// What only one engine reads; the others' are not looked at.

struct hf_gather_params {
    enum hf_storage storage;  // default HF_STORAGE_FLOAT
    // Reproduce the published demo, the flaws of its composite included. Default 0: those are mended.
    int faithful;
    // Rings of taps, 1..64. HF_DERIVE (default): as many as keep them two half-resolution pixels apart, up to 64; where
    // that is no whole number, a blend of both beside it, so that the picture follows a radius without a jump, but with
    // .faithful. Fewer are faster and leave gaps. Ignored with HF_FILL_NONE, and with HF_FILL_MEAN where that has no taps.
    int rings;
    // Weight samples by 1 / (1 + luminance) in the gather, against fireflies: darker highlights. Default 0.
    // B. Karis, "Tone mapping", 2013; chapter 3.4.4.
    int karis;
    // Scale the far kernel by each pixel's own CoC; the far fill then takes only neighbours whose CoC is within
    // 0.25. Default 0. Chapter 3.5.
    int per_pixel_kernel;
    // Upsample the near field with a uniform cubic B-spline instead of bilinearly. Default 0. Chapter 3.4.6.
    int bicubic;
    // HF_DERIVE (default): HF_FILL_MEAN, and HF_FILL_MAX with .faithful or where downsample or division are not the default.
    enum hf_fill fill;
    enum hf_downsample downsample;  // default HF_DOWNSAMPLE_BILATERAL
    // Default HF_DIVISION_EXACT, which plain C and run.deterministic always do. Others give other bits on each kind of
    // processor, and are here to be measured.
    enum hf_division division;
};

struct hf_hexagon_params {
    enum hf_resolution resolution;  // full (default) or half
    // Every pixel gets max_radius, whatever its depth: the plain blur, whose cost does not grow with the square of the
    // radius. Default 0.
    int uniform;
};

struct hf_scatter_params {
    enum hf_resolution resolution;  // full (default) or half
};

struct hf_gaussian_params {
    enum hf_resolution resolution;  // default full
    // Passes of the 5-tap kernel over the buffer, 0..64, default 3: a standard deviation of sqrt(iterations) of its
    // pixels, square or not.
    int iterations;
    // Standard deviation in full-resolution pixels (of y; pixel_aspect narrows it) of one blur that costs the same for
    // any, in place of the iterations: 0 (none) to 256. HF_DERIVE (default): iterations. Four boxes: within 1.3 % of a
    // true gaussian's edge.
    float sigma;
    // The published weights and depth, whose flaws are its look. Default 0.
    int faithful;
    // 1: the blend with the picture is strength * sat(3 |d(focus) - d(z)|), d = sat(z / far plane). 0: strength *
    // max(n, f) of the near and far CoC. HF_DERIVE (default): 1 when faithful, or for the range model when distance,
    // near_* and far_* are all derived, else 0. Always 0 for HF_DEPTH_COC.
    int by_depth;
};

// layers: what its accuracy may cost. Words: HF_NAMES_LAYERS.
enum hf_layers_quality {
    HF_LAYERS_STANDARD,
    HF_LAYERS_DRAFT,  // few slices, and nothing is filled in behind objects: hard rims where a lens sees past them
    HF_LAYERS_HIGH,   // finer slices
    HF_LAYERS_BEST,   // finer still
};

// HF_DERIVE leaves a number to the quality.
struct hf_layers_params {
    enum hf_layers_quality quality;  // default HF_LAYERS_STANDARD
    // Distance between slices, pixels of radius, 0.25 to 32. From 1 on they lie at most 1, or a third of their radius, of DRAFT
    // half of it, apart, beyond 64 at least a 32nd of it; those of HIGH and BEST closer together by this over 2. Default
    // HF_DERIVE.
    float spacing;
    // CoC radii from which slices are blurred at half and a quarter of the resolution (and from four times the latter at
    // an eighth), 1 to 2048 pixels, half_from <= quarter_from. Default HF_DERIVE.
    float half_from, quarter_from;
    int no_unmix;       // edges keep their mixed colours. Default 0
    int no_hidden;      // nothing is filled in behind objects. Default 0
    int no_highlights;  // highlights are blurred like all else: the pixels of coarser resolutions show. Default 0
    // BEST fills in behind objects by what looks alike around them, so that edges and patterns go on, but may jump from
    // frame to frame; 1: by means, as the others do. Default 0
    int no_patterns;
};

// How a frame is run, apart from what it looks like.
struct hf_run_params {
    // Same bits on every instruction set and architecture: no fused multiply-add. Default 0. Bits never depend on
    // threads or tiles, with or without this.
    int deterministic;
    // Run every pass on every tile, also where the scene does not call for it. Default 0. Changes no bit.
    int no_skip;
    // Look at the colour of what will be blurred, for hf_report. Default 0: that takes time and serves nothing else.
    int colour_stats;
    // Milliseconds that a frame may take, 0 (default): any. What was asked for is then the best that a frame may be;
    // if earlier frames of this context took longer, cheaper settings are tried in turn, those of the ladder from which
    // hf_choose_quality chooses that reach as far as the blur that is asked for. It goes back only when the better setting
    // would leave a fifth of the budget for a dozen frames on end, so that a shot does not flicker between two looks.
    // The log warns once when even the cheapest of them takes longer.
    float budget_ms;
};

struct hf_params {
    enum hf_engine engine;  // default HF_ENGINE_GATHER
    enum hf_model model;    // default HF_MODEL_RANGE. Ignored for HF_DEPTH_COC.
    // Distance of the plane in focus, scene units of view depth, > 0, finite; HF_MODEL_LENS may have INFINITY. Default 10.
    // Both models. HF_DERIVE: what pixel (width / 2, height / 2) shows; HF_ERR_FOCUS if that is no surface, but infinity
    // for the gaussian engine. Ignored for HF_DEPTH_COC.
    float focus;
    struct hf_range_params range;
    struct hf_lens_params lens;
    // Largest CoC radius, full-resolution pixels, 0 (the input, bit for bit) to 2048. HF_DERIVE (default): 12 at 1080
    // lines and by display height (12 when faithful), the chapter's reach; for the lens model and HF_DEPTH_COC, 2048 in
    // hexagon, scatter and layers, and 256 in the gather, whose near and far kernels are then as large as the radii found.
    float max_radius;
    struct hf_aperture_params aperture;
    struct hf_highlight_params highlight;
    struct hf_view_params view;
    struct hf_gather_params gather;
    struct hf_hexagon_params hexagon;
    struct hf_scatter_params scatter;
    struct hf_gaussian_params gaussian;
    struct hf_layers_params layers;
    struct hf_run_params run;
};

// The defaults given above. Copy it, then change what you need.
HF_API extern const struct hf_params hf_default_params;

// Blur src into dst, which have the same size and may have different formats. dst may be src itself: the same
// pointers, strides and format; any other overlap is undefined. An output without alpha drops it; an output with
// alpha from an input without gets alpha 1 (alpha is not blurred then). A colour sample that is NaN or infinite
// counts as the mean of the finite ones among its 8 neighbours, else 0, and is counted in the statistics. params may
// be NULL (defaults). On error the pixels of dst are unspecified. Errors: HF_ERR_ARG, HF_ERR_MEMORY, HF_ERR_FOCUS,
// HF_ERR_CANCELLED.
HF_API int hf_render(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                     const struct hf_depth *depth, const struct hf_params *params);

// A rectangle of a picture.
struct hf_region {
    size_t size;              // sizeof(struct hf_region)
    int x, y, width, height;  // pixels from the top left corner; width and height at least 1, all of it in the picture
};

// As hf_render, but of dst only the pixels of a region (NULL: all) are written: with the bits that hf_render of the whole
// picture writes there. src, depth and dst describe whole pictures. Of dst no byte outside the region is read or written, so
// its memory may be a tile: data then points to where pixel (0, 0) would be, and stride is the tile's. dst may be src, as for
// hf_render. The cost grows with the region and with what is blurred into it. Some numbers are of the whole picture:
//   - All depth is looked at, as the largest radius decides how things are blurred. The gaussian engine, and the gather with
//     max_radius given or the range model, look at depth around the region alone.
//   - Scatter reads all colour that is blurred, as the brightest sample decides the units of its sums.
//   - The gaussian engine reads all colour when sigma is given, as it blurs whole columns and rows.
// The context holds as much memory as for a whole picture. The report counts what was worked on. run.budget_ms chooses the
// setting that hf_render would use next, but the time of a region is not counted. With hf_set_dump the whole picture is made.
// Errors as for hf_render, and HF_ERR_ARG for a region that is not in the picture.
HF_API int hf_render_region(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                            const struct hf_depth *depth, const struct hf_params *params,
                            const struct hf_region *region);

// What hf_render_region with the same arguments will read of the colour and of the depth: samples outside these rectangles do
// not count. The rectangles may be larger than need be. With params->focus HF_DERIVE, the depth in the middle of the picture
// is read as well. This call looks at the depth as hf_plan does, and not at the colour. colour and depth_read may be NULL;
// their contents before the call are not looked at. On error they are empty. Errors as for hf_render_region.
HF_API int hf_region_reads(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                           const struct hf_depth *depth, const struct hf_params *params, const struct hf_region *region,
                           struct hf_region *colour, struct hf_region *depth_read);

// Cancel the call of hf_render, hf_prepare or hf_plan that runs on c now: from any thread, also from callbacks. The call
// returns HF_ERR_CANCELLED soon: within about a millisecond of work, plus what the system takes to wake a thread. hf_cancel
// itself does not wait. The pixels of dst are then unspecified: in place, the picture is lost. The report is all zero and the
// log says nothing. The context is as good as before, and so is all that it holds. A call that has just finished its picture
// returns HF_OK all the same. When none runs nothing happens, and a call that begins later is not cancelled; who cannot
// know whether the call has begun cancels through the progress callback. c must not be closed meanwhile; NULL does nothing.
HF_API void hf_cancel(struct hf_context *c);

// From now on call fn while hf_render runs on c; fn NULL (default) ends it. done says how much of the frame is done, 0 to 1,
// as far as earlier frames or a table tell: it never falls, and comes at most about a hundred times. If the call succeeds the
// last one has done 1, when the picture is whole; a call that returns an error may have no such. If fn returns other than 0
// the call is cancelled as by hf_cancel, except that what fn returns for 1 is not looked at. fn is called by the thread that
// called hf_render; with parallel_for by any of the host's threads, never by two at a time. It may call hf_cancel, and no
// other function with this context. hf_set_progress itself is to be called when nothing runs on c.
HF_API void hf_set_progress(struct hf_context *c, int (*fn)(void *cookie, float done), void *cookie);

// How good a picture has to be. Settings that are worth having lie on a ladder, each slower than the one before, at least
// 0.2 dB closer to what a ray tracer sees on the mean, and on no measured scene where either can be chosen farther from it;
// a quality is a step of it. Where no step lies between two qualities, both are the same step: today high is best.
enum hf_quality {
    HF_QUALITY_DRAFT,     // the cheapest that blurs as far as any lens: the gather
    HF_QUALITY_STANDARD,  // the cheapest within 1 dB of the best
    HF_QUALITY_HIGH,      // the cheapest within 0.25 dB of it
    HF_QUALITY_BEST,      // the most accurate
};

// What was chosen, and what it is expected to cost and err: as `hyperfocal-bench tradeoff` measured it on ray-traced
// scenes of 1280 x 720 with CoC radii of up to 57 pixels. Other machines and scenes differ.
struct hf_choice {
    int step, steps;       // 0 is the cheapest, of how many
    const char *options;   // the command's words for it; lives as long as the library
    float error, worst;    // root mean square distance of the display-encoded picture, 0..1: geometric mean over the
                           // scenes, and of the worst
    float ms;              // milliseconds of a megapixel
    int passed;            // steps that were passed over
    const char *why;       // why the first of them was, for "it ..."; NULL if none. Lives as long as the library
    const char *measured;  // when and on what machine
};

// Set the engine and its knobs to those of a quality and leave all else as it is, for pictures of this height and such a
// depth, of which only the type counts (NULL: distances). A step that does not reach as far as the blur that is asked for
// is passed over for the next better one that does, and so is one that does not draw params->aperture. Asked for is
// max_radius; without it 12 pixels at 1080 lines with the range model, and with a lens or HF_DEPTH_COC any radius: then no
// step of the gaussian engine will do, whose one blur is as wide everywhere (twice its standard deviation). choice may be
// NULL. Errors: HF_ERR_ARG for a quality or a height that is none.
HF_API int hf_choose_quality(int height, const struct hf_depth *depth, struct hf_params *params,
                             enum hf_quality quality, struct hf_choice *choice);
// The same by the largest error that is acceptable, as in hf_choice: more than 0, at most 1. The cheapest step that is
// expected to err no more, or the last one, whose error may then be larger.
HF_API int hf_choose_error(int height, const struct hf_depth *depth, struct hf_params *params, float error,
                           struct hf_choice *choice);

// What parameters come to for a picture: numbers only.
struct hf_resolved {
    struct hf_params params;  // as given, but HF_DERIVE nowhere
    int width, height;        // of the image
    enum hf_limit limit;      // why params.max_radius is what it is
    int rings_given;          // 1: params.gather.rings was; 0: that is rounded up, see there
    float lens_k;             // K, scene units * pixels; 0 unless the lens is in use
    float focal_px;           // focal length of the lens, pixels of the display width
    int sharp;                // nothing can be blurred: the frame will be a copy
};

// What hf_render would make of params (NULL: defaults) for a width x height picture, or why it would not: then the
// sentence is in message, cut to size bytes (message may be NULL, size 0 then). depth->data may be NULL if there are no
// pixels yet; then params->focus must not be HF_DERIVE. Errors: HF_ERR_ARG, HF_ERR_FOCUS.
HF_API int hf_resolve(int width, int height, const struct hf_depth *depth, const struct hf_params *params,
                      struct hf_resolved *resolved, char *message, size_t size);

// Do what makes a first frame late: allocate and touch all memory that frames of this size with these parameters and
// radii like this depth's will use, whatever parts of them turn out blurred. Renders nothing; dst and the colour of src
// are not looked at. Errors as for hf_render.
HF_API int hf_prepare(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                      const struct hf_depth *depth, const struct hf_params *params);

// No engine has more passes.
enum { HF_MAX_PASSES = 12 };

// An engine's passes in the order in which they run, and their names: for the gather those of table 3.1. 0 and NULL
// for numbers that are none.
HF_API int hf_pass_count(enum hf_engine engine);
HF_API const char *hf_pass_name(enum hf_engine engine, int pass);

// A pass of a frame: on how many tiles it runs, and what it costs.
struct hf_pass_report {
    const char *name;
    const char *skipped;  // why the other tiles do without; NULL if all run. Both texts live as long as the library
    uint32_t run, all;    // tiles, or chunks of the first sweep, that call for the pass, of how many
    uint32_t ran;         // that ran it; 0 in a plan
    double predicted_ms;  // time in the pass over the number of threads, from earlier frames or a table
    double ms;            // what it was; 0 in a plan
};

// What a frame calls for, and what became of it. Numbers, and words that live as long as the library.
struct hf_report {
    // In use: what was asked for, or what a budget left of it. Of aperture.picture only whether there was one: it is
    // NULL here, picture says so.
    struct hf_resolved used;
    int picture;
    int budget_step, budget_steps;  // 0: as asked for, each step is cheaper; of how many, 0 without a budget
    const char *budget_options;     // the command's words for a step, for ever; NULL: as asked for

    int tile_width, tile_height;  // full-resolution pixels
    int columns, rows;            // of tiles, see hf_get_tiles
    uint32_t tile_count[4];       // by enum hf_tile
    int passes;
    struct hf_pass_report pass[HF_MAX_PASSES];

    // CoC radii that there are, full-resolution pixels: the largest in front of the focus and behind it.
    float near_radius, far_radius;
    // layers: how many slices lie between them, at full, half, a quarter and an eighth of the resolution; and at how many
    // distances, each twice the one before, hidden samples are looked for.
    int slices[4], hidden_levels;
    // Colour where it is read for blurring; known only with params.run.colour_stats.
    int colour_known;
    float brightest;      // largest finite sample of R, G and B
    int opaque;           // no alpha below 1
    uint64_t not_finite;  // samples, repaired before anything was made of them

    size_t memory;  // bytes of buffers that the frame needs
    // Bytes that the context will hold when hf_render has made this frame, from its allocator, what it holds now included: to
    // the byte, unless hf_set_dump is in use, or the frame is made in place and has samples that are not finite. hf_plan has
    // taken the tables and the scratch of the threads by then, but nothing as large as the frame.
    size_t memory_needed;
    size_t memory_saved;  // bytes that it would need besides with no_skip
    double plan_ms;       // time for planning, the look at the depth not included
    double predicted_ms;  // of the whole frame

    // What follows is 0 in a plan.
    double total_ms;                                 // wall time of the call
    size_t memory_held;                              // bytes that the context holds
    uint64_t near_pixels, sharp_pixels, far_pixels;  // pixels by their own CoC: n > 0, both 0, f > 0
    uint64_t colour_repaired;                        // colour samples (channels of pixels) that were NaN or infinite
    uint64_t depth_repaired;                         // depth samples that were NaN
    uint64_t no_surface;                             // pixels without a surface
    uint64_t clamped;  // samples clamped: of the output to the range of its format, of the input as engines need it
};

// What hf_render would do with the same arguments, without rendering: looks at the depth only. Errors as for hf_render.
HF_API int hf_plan(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                   const struct hf_depth *depth, const struct hf_params *params, struct hf_report *report);
// What the last hf_render, hf_plan or hf_prepare did. All zero before the first and after one that failed.
HF_API void hf_get_report(const struct hf_context *c, struct hf_report *report);
// Copy what the report's tiles are: enum hf_tile, row by row from the top left, as many as there are or fit. Returns how
// many there are, columns * rows; 0 where the report is zero.
HF_API size_t hf_get_tiles(const struct hf_context *c, uint8_t *tiles, size_t size);

// One intermediate buffer, for looking at and for tests: planes of floats.
struct hf_buffer {
    const char *name;   // gather: coc, coc4, cocmaxx, cocmax, cocblurx, cocblur, color4, colormulcoc4, near, far,
                        // nearfill, farfill; by area colormulnear4, farpart and cover instead of the last two
    int width, height;  // full, half or quarter resolution
    int channels;       // 1..4: near and far CoC, one CoC, or R, G, B and perhaps A
    const float *data[4];
    ptrdiff_t stride;  // bytes from one row to the next, the same for all channels
};

// From now on call fn with every intermediate buffer of each frame, after it; NULL ends it. The frame then runs as
// with no_skip, pass by pass over whole buffers: same bits, more time and memory. The buffers live until fn returns.
HF_API void hf_set_dump(struct hf_context *c, void (*fn)(void *cookie, const struct hf_buffer *buffer), void *cookie);

#ifdef __cplusplus
}
#endif

#endif
