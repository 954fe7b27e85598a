// SPDX-License-Identifier: BSD-3-Clause
//
// The parameters of a render: what the blur looks like and how a frame is run. hyperfocal.h includes this header and
// explains its words.
//
// A group (struct hf_range_params and the others) keeps its size for ever, so that the groups behind it keep their
// places. It grows into the reserved words at its end, which must be 0. struct hf_params itself grows at its end.
#ifndef HYPERFOCAL_PARAMS_H
#define HYPERFOCAL_PARAMS_H

#include <stddef.h>
#include <stdint.h>

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

struct hf_image;

// A number of this value is worked out from the rest. Fields that take it say so and say what they become; hf_resolve
// returns the result.
#define HF_DERIVE (-1)

// The algorithms. Engines are numbered from 0 without gaps; hf_engine_name returns NULL after the last one.
enum hf_engine {
    HF_ENGINE_GATHER,    // near and far field at half resolution, each pixel the mean over its aperture's area
    HF_ENGINE_HEXAGON,   // hexagonal bokeh in two passes of directional blurs (White and Barre-Brisebois, 2011)
    HF_ENGINE_SCATTER,   // every pixel becomes the aperture's picture (Wronski, 2012)
    HF_ENGINE_GAUSSIAN,  // an iterated 5-tap blur, blended by depth, with autofocus (2010)
    HF_ENGINE_LAYERS,  // un-mixed edges, filled-in hidden surfaces, slices blended in order of depth: the most accurate
    HF_ENGINE_CHAPTER,  // Sterna's nine passes as published: taps in place of areas, and a fill between them
};

// Size of the buffers in which hexagon, scatter and gaussian work. Smaller is faster and softer. gather and chapter
// work at half resolution, layers at several resolutions.
enum hf_resolution {
    HF_RESOLUTION_FULL,
    HF_RESOLUTION_HALF,     // half the width and half the height
    HF_RESOLUTION_QUARTER,  // a quarter of each; gaussian only
};

// How the CoC follows from depth.
enum hf_model {
    HF_MODEL_RANGE,  // from a focus distance F and a range R: the chapter's empirical model
    HF_MODEL_LENS,   // from a thin lens: radius K * (1/P - 1/z), see struct hf_lens_params
};

// How gather and chapter store the buffers between their passes. The colour that they read and their result are stored
// likewise.
enum hf_storage {
    HF_STORAGE_FLOAT,  // float32
    HF_STORAGE_HALF,   // float16, clamped to +-65504
    // The chapter's: R11G11B10F truncated towards zero for colour, 8 bits rounded for CoC; alpha is float32.
    HF_STORAGE_PACKED,
};

// How the chapter closes the gaps between its taps (chapter 3.3.5).
enum hf_fill {
    // 3x3 maximum, the published choice: highlights are brighter than their energy allows. Far neighbours count little
    // at first and fully once a pixel's CoC is a quarter of the largest; with chapter.faithful they always count fully.
    HF_FILL_MAX,
    HF_FILL_MEAN,  // 3x3 mean, which keeps energy
    HF_FILL_NONE,  // nothing; there are 144 taps instead, a 12x12 grid mapped to the disc (Shirley and Chiu, 1997)
    HF_FILL_OPEN,  // nothing, and no more taps: the gaps stay
};

// How the chapter makes one pixel of half resolution from four (chapter 3.3.2).
enum hf_downsample {
    HF_DOWNSAMPLE_BILATERAL,  // near: their mean; far: weighted by how similar their CoCs are to the first pixel's
    HF_DOWNSAMPLE_LINEAR,     // their mean: pixels in focus bleed into the far field beside them
    HF_DOWNSAMPLE_POINT,      // the first of them: no filter, so small details flicker
};

// How the chapter divides by sums of weights.
enum hf_division {
    HF_DIVISION_EXACT,     // rounded to the nearest
    HF_DIVISION_ESTIMATE,  // by the processor's estimate of the reciprocal, 8 to 14 bits
    HF_DIVISION_NEWTON,    // the estimate and one Newton step, which doubles its bits
    HF_DIVISION_NEWTON2,   // the estimate and two steps
};

// How the CoC of the range model grows between begin and end.
enum hf_blend {
    HF_BLEND_LINEAR,      // linearly: t
    HF_BLEND_SMOOTHSTEP,  // 3t^2 - 2t^3
};

// Distances of the range model, scene units of view depth. Read with HF_MODEL_RANGE only; HF_DEPTH_COC reads blend too.
struct hf_range_params {
    // Distance over which sharp turns into fully blurred, on both sides of the focus: >= 0; INFINITY is no blur at all.
    // HF_DERIVE (default): half the focus distance. Chapter 3.2.
    float distance;
    // 0 (the input, bit for bit) to 1 (default). From 0.25 up it scales the kernel's radius. Below that the kernel
    // stays at a quarter of its radius, and the result is blended with the input by 4 * strength. Chapter, listing
    // 3.14.
    float strength;
    // Near blur is full up to near_begin and gone at near_end. Far blur starts at far_begin and is full at far_end. All
    // >= 0, near_begin <= near_end <= far_begin <= far_end, because no surface is near and far at once. HF_DERIVE
    // (default): max(0, F - R), F, F, F + R. Chapter, figure 3.2.
    float near_begin, near_end, far_begin, far_end;
    enum hf_blend blend;  // default HF_BLEND_LINEAR
    uint32_t reserved[5];
};

// Lens model: r(z) = K (1/focus - 1/z), K = aperture radius in scene units * focal length in pixels, aperture radius =
// focal_length_mm / 1000 / (2 f_number) / world_unit_m, focal length in pixels = focal_length_mm / sensor_width_mm *
// display_width * pixel_aspect, because radii are counted in pixels of y. All > 0 and finite; f_number may be INFINITY,
// which is no blur.
struct hf_lens_params {
    float f_number;         // default 2.8
    float focal_length_mm;  // millimetres, default 50
    float sensor_width_mm;  // millimetres, default 36
    float world_unit_m;     // metres per scene unit, default 1
    uint32_t reserved[4];
};

// Shape of the aperture. layers and scatter draw all of it, gather and chapter blades and rotation, hexagon its own six
// sides and rotation, gaussian nothing. HF_ERR_ARG for what the engine in use cannot draw. Highlights behind the focus
// have the shape as it is described here, seen from behind the camera; those in front of it have it by half a turn, as
// in a lens. The chapter's fields share their taps, so there both have it by half a turn.
struct hf_aperture_params {
    // A picture of the aperture: its centre is the lens's axis, its shorter side the diameter, its brightness the
    // transmission of each channel. NULL (default): the shape that the other fields describe. The picture must stay
    // alive and unchanged during the call. Its cost grows with the square of the radius, which is therefore at most 256
    // pixels, and at most 512 / sqrt(w) where squeeze and pixel_aspect make the picture w > 4 times as wide as high.
    // The picture is the whole shape: HF_ERR_ARG if blades, roundness, ring or cat_eye are set as well.
    const struct hf_image *picture;
    // 0 (default): a disc. 3 to 16: the sides of a regular polygon. The middle of one side lies on the +x axis, turned
    // by rotation degrees: any finite value, default 0.
    int blades;
    float rotation;
    // How far the polygon's sides bend towards the circle around it: 0 (default), straight, to 1, a disc.
    float roundness;
    // Radius of a central obstruction, as a mirror lens has, as a part of the aperture's radius: 0 (default, none) to
    // 0.95. It has the aperture's shape.
    float ring;
    // Mechanical vignetting: how far the exit pupil's second circle has moved towards the corner for a pixel in the
    // corner, in aperture radii: 0 (default, none) to 1. Highlights in the corners become cat's eyes.
    float cat_eye;
    // Anamorphic squeeze: height over width of a highlight, 0.25 to 4, default 1. The height stays, the width changes.
    float squeeze;
    // Axial chromatic aberration: behind the focus, red CoCs are larger by this fraction and blue ones smaller; in
    // front of the focus it is the other way. -0.5 to 0.5, default 0.
    float chromatic;
    uint32_t reserved[5];
};

// A clipped picture has lost the light of its lamps. This gives it back before the blur and takes it away after it, so
// that a lamp stored as 1 leaves a disc and the paper beside it does not. Let m be the luminance 0.2126 R + 0.7152 G +
// 0.0722 B (Rec. 709) of the channels above 0. It becomes m + (gain - 1) t^2 with t = (m - threshold) / (1 - threshold)
// within 0..1; the channels above 0 are scaled by the same factor. White becomes gain. Paint that is full in one
// channel stays. The way back is the inverse: an evenly bright area keeps its value. A channel may exceed 1 only where
// light falls on a pixel that is full in that channel, as on a sensor. A pixel that the blur leaves alone keeps its
// bits.
struct hf_highlight_params {
    // What 1 becomes: 1 (default, no change and no cost) to 64. 8 is three stops.
    float gain;
    // Luminance above which a pixel is raised: 0 to 0.99, default 0.9 (a grey of 243 in sRGB). Read only when gain > 1.
    float threshold;
    uint32_t reserved[4];
};

// How the image relates to the whole picture, and the shape of its pixels. An image that is a part of a picture gets
// the whole picture's bits (away from its borders) if its top left corner lies at even x and y for gather, and at
// multiples of 4 for the other engines. HF_LAYERS_BEST has no such positions. hf_params.max_radius says what gather and
// chapter need besides.
struct hf_view_params {
    // Size of the whole picture when the image is a part of it: pixels, > 0. HF_DERIVE (default): the image's own size.
    // It only scales the blur: max_radius follows the height, the lens the width.
    int display_width, display_height;
    // Width of a pixel over its height: 0.1 to 10, default 1. Counted in pixels of x, the blur is narrower by this
    // factor.
    float pixel_aspect;
    uint32_t reserved[5];
};

// One group for each engine. An engine ignores the groups of the others.

// Of the gather.
struct hf_gather_params {
    enum hf_storage storage;  // default HF_STORAGE_FLOAT
    // Weight samples by 1 / (1 + luminance), against fireflies: darker highlights. Default 0. B. Karis, "Tone mapping",
    // 2013; chapter 3.4.4.
    int karis;
    // Scale both kernels by each pixel's own CoC, as the lens model always does. Default 0. Chapter 3.5.
    int per_pixel_kernel;
    // Upsample the near field with a uniform cubic B-spline instead of bilinearly. Default 0. Chapter 3.4.6.
    int bicubic;
    uint32_t reserved[8];
};

// Of the chapter.
struct hf_chapter_params {
    enum hf_storage storage;  // default HF_STORAGE_FLOAT
    // Reproduce the published demo, the flaws of its composite included. Default 0: those are mended.
    int faithful;
    // Rings of taps, 1..64. HF_DERIVE (default): as many as keep them two half-resolution pixels apart, up to 64; where
    // that is no whole number, a blend of both beside it, so that the picture follows a radius without a jump, except
    // with .faithful. Fewer are faster and leave gaps. Ignored with HF_FILL_NONE.
    int rings;
    int karis;  // as for the gather
    // Scale the far kernel by each pixel's own CoC; the far fill then takes only neighbours whose CoC is within
    // 0.25. Default 0. Chapter 3.5.
    int per_pixel_kernel;
    int bicubic;                    // as for the gather
    enum hf_fill fill;              // default HF_FILL_MAX
    enum hf_downsample downsample;  // default HF_DOWNSAMPLE_BILATERAL
    // Default HF_DIVISION_EXACT, which plain C and run.deterministic always do. Others give other bits on each kind of
    // processor, and are here to be measured.
    enum hf_division division;
    uint32_t reserved[7];
};

// Of the hexagon.
struct hf_hexagon_params {
    enum hf_resolution resolution;  // full (default) or half
    // 1: every pixel gets the radius max_radius, whatever its depth. This is the plain blur, whose cost does not grow
    // with the square of the radius. Default 0.
    int uniform;
    uint32_t reserved[4];
};

// Of scatter.
struct hf_scatter_params {
    enum hf_resolution resolution;  // full (default) or half
    uint32_t reserved[5];
};

// Of the gaussian.
struct hf_gaussian_params {
    enum hf_resolution resolution;  // full (default), half or quarter
    // Passes of the 5-tap kernel over the buffer: 0 to 64, default 3. The standard deviation is sqrt(iterations) of the
    // buffer's pixels.
    int iterations;
    // Standard deviation of one blur that replaces the iterations, in full-resolution pixels of y (pixel_aspect narrows
    // it): 0 (no blur) to 256. Every value costs the same. Four boxes make it: an edge is within 1.3 % of a true
    // gaussian's. HF_DERIVE (default): use the iterations.
    float sigma;
    // 1: the published weights and depth, whose flaws are its look. Default 0.
    int faithful;
    // How the blur is blended with the picture. 1: by strength * sat(3 |d(focus) - d(z)|), d = sat(z / far plane). 0:
    // by strength * max(n, f) of the near and far CoC. HF_DERIVE (default): 1 with faithful, 1 for the range model when
    // distance, near_* and far_* are all derived, else 0. Always 0 for HF_DEPTH_COC.
    int by_depth;
    uint32_t reserved[5];
};

// How accurate layers is. HF_NAMES_LAYERS has the words.
enum hf_layers_quality {
    HF_LAYERS_STANDARD,
    HF_LAYERS_DRAFT,  // few slices; nothing is filled in behind objects, so near objects keep hard rims
    HF_LAYERS_HIGH,   // finer slices
    // As HIGH, and edges and patterns go on behind objects. Where near and far cross, each point of the lens is followed
    // by itself, so that what a near edge hides is told from what lies beside it.
    HF_LAYERS_BEST,
};

// Of layers.
struct hf_layers_params {
    enum hf_layers_quality quality;  // default HF_LAYERS_STANDARD
    // Distance between two slices, in pixels of CoC radius: 0.25 to 32. Slices lie closer where the radius is small (at
    // most 1 pixel, or a third of the radius, apart from 1 pixel on; half the radius with DRAFT) and farther apart
    // beyond 64 pixels (at least a 32nd of the radius). HIGH and BEST divide this by 2. HF_DERIVE (default): by the
    // quality.
    float spacing;
    // CoC radii from which slices are blurred at half and at a quarter of the resolution: 1 to 2048 pixels, half_from
    // <= quarter_from. From four times quarter_from on they are blurred at an eighth. HF_DERIVE (default): by the
    // quality.
    float half_from, quarter_from;
    int no_unmix;   // 1: edges keep their mixed colours. Default 0
    int no_hidden;  // 1: nothing is filled in behind objects. Default 0
    // 1: highlights are blurred like everything else, and pixels of coarser resolutions show. Default 0
    int no_highlights;
    // 1: BEST fills in behind objects by means, as the other qualities do. 0 (default): it continues edges and patterns
    // from around the object, which may jump from frame to frame.
    int no_patterns;
    // 1: in place of the picture, how much of each pixel's light was guessed, 0 to 1, in all three colours; alpha is 1.
    // Guessed is what objects hide, where no further picture shows it, and what lies beyond the frame. Needs
    // highlight.gain 1. Default 0
    int guessed;
    // Points of the lens that are followed one by one where near and far cross, so that what a near edge
    // hides is told from what lies beside it: 2 to 192; 1: none, only slices, but where surfaces far in front of the focus
    // hide each other. 0 (default): 96 with BEST, else 1. More are for large radii; time grows with them.
    int lens_points;
    uint32_t reserved[6];
};

// How a frame is run, apart from what it looks like.
struct hf_run_params {
    // 1: the same bits on every instruction set and architecture, without fused multiply-add. Default 0. The bits never
    // depend on threads or tiles, with this or without.
    int deterministic;
    // 1: run every pass on every tile, also where the scene does not need it. Default 0. It does not change a bit.
    int no_skip;
    // Milliseconds that a frame may take; 0 (default): any time. The given parameters are then the best that a frame
    // may get. When two frames of the context took longer, the next gets the best setting that is expected to keep the
    // budget, by what those frames took and what settings cost: one of those from which hf_choose_quality chooses that
    // reach as far as the blur asked for, or the chapter with 3 rings where nothing cheaper than the gather does. It
    // returns to a better setting only when that would leave a fifth of the budget for a dozen frames in a row, so that
    // a shot does not flicker between two looks. The log warns once when even the cheapest setting takes longer.
    float budget_ms;
    uint32_t reserved[5];
};

// All parameters. hf_default_params returns the defaults; change what you need.
struct hf_params {
    size_t size;            // sizeof(struct hf_params); hf_default_params sets it
    enum hf_engine engine;  // default HF_ENGINE_GATHER
    enum hf_model model;    // default HF_MODEL_RANGE. Ignored for HF_DEPTH_COC.
    // Distance of the plane in focus, scene units of view depth: > 0 and finite, default 10. INFINITY with
    // HF_MODEL_LENS only. HF_DERIVE: the distance of the surface at pixel (width / 2, height / 2). Where there is no
    // surface, the gaussian engine focuses at infinity, and the others return HF_ERR_FOCUS. Ignored for HF_DEPTH_COC.
    float focus;
    struct hf_range_params range;
    struct hf_lens_params lens;
    // Largest CoC radius, full-resolution pixels: 0 (the input, bit for bit) to 2048. HF_DERIVE (default): with the
    // range model, the chapter's 12 pixels at 1080 lines, in proportion to the display height (always 12 with
    // chapter.faithful). With the lens model and HF_DEPTH_COC: 2048 in hexagon, scatter and layers; 256 in gather and
    // chapter. By its design the chapter has one kernel for each field, which then is as large as the largest near or
    // far radius in the picture: there a sample that is nearer or farther than all others changes pixels that it does
    // not reach, in random small pictures three quarters of all samples by up to 170 codes of 8 bits, and a part of a
    // picture must show the same two radii to have the whole's bits. Where max_radius is given, and in the other
    // engines, no pixel depends on what does not reach it.
    float max_radius;
    struct hf_aperture_params aperture;
    struct hf_highlight_params highlight;
    struct hf_view_params view;
    struct hf_gather_params gather;
    struct hf_chapter_params chapter;
    struct hf_hexagon_params hexagon;
    struct hf_scatter_params scatter;
    struct hf_gaussian_params gaussian;
    struct hf_layers_params layers;
    struct hf_run_params run;
};

// Fill the first size bytes of *params with the defaults given above, params->size included. Bytes beyond what the
// library knows become 0. Returns HF_ERR_ARG, and writes nothing, if params is NULL or size is less than that of
// release 0.9.0.
HF_API int hf_params_init(struct hf_params *params, size_t size);

// The defaults given above.
static inline struct hf_params hf_default_params(void)
{
    struct hf_params params;
    hf_params_init(&params, sizeof params);
    return params;
}

#ifdef __cplusplus
}
#endif

#endif
