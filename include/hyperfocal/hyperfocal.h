// SPDX-License-Identifier: BSD-3-Clause
//
// hyperfocal: depth of field for rendered pictures, on the CPU.
//
// Give it a colour picture and its depth, and it returns what a lens would have seen. Typical use:
//
//     struct hf_context *c;
//     struct hf_params p = hf_default_params();     // take the defaults, change what you need
//     p.focus = 20.0f;
//     p.range.distance = 10.0f;
//     if (hf_open(&c, NULL) == HF_OK)
//         err = hf_render(c, &picture, &picture, &depth, &p);      // in place
//     hf_close(&c);
//
// Words. "CoC" is the circle of confusion: what the lens makes of a point. Its radius is counted in full-resolution
// pixels, negative in front of the plane in focus (near), positive behind it (far). Depth is view depth unless said
// otherwise: positive distance along the camera axis, in scene units. Pixel centres lie at +0.5. Colours are linear and
// premultiplied by alpha. "The chapter" is W. Sterna, "Practical Gather-based Bokeh Depth of Field", GPU Zen 2, which
// the engine of that name reproduces.
//
// Threads. One thread at a time may use a context. Any number of contexts may be used at once. After fork() the child
// has none of the context's threads: a context with threads of its own returns HF_ERR_THREAD there, and hf_close frees
// its memory. Functions without a context may be called by any thread at any time.
//
// Errors. Functions return HF_OK (0) or a negative enum hf_error. No function prints, exits or aborts. The reason is
// one sentence in a struct hf_message: functions with a context send it to the log and keep it for hf_get_problem,
// functions without one fill the struct that the caller gives.
//
// How this interface grows. Every struct begins with its size. The caller sets it to sizeof the struct, also before a
// call that fills the struct. A new release adds fields at the end; 0 is always a valid value of a new field, and keeps
// the old behaviour.
//   - Older program, newer library: the library takes the fields that it does not get as their defaults, and writes no
//     byte beyond size.
//   - Newer program, older library: the library accepts a struct that is larger than its own if all bytes beyond are 0,
//     else it returns HF_ERR_ARG and says so. Where it fills such a struct, it sets the bytes beyond to 0.
//   - A size below that of release 0.9.0 is HF_ERR_ARG.
// Enumerators are added at the end, so a program must expect values that it does not know. Lists (engines, words) have
// no count: call their function with 0, 1, ... until it returns NULL. Reserved words and bytes must be 0.
// HF_ABI_VERSION in version.h says when all this does not suffice. What benchmarks and viewers need beyond this header
// is in inspect.h, which may change in any release.
#ifndef HYPERFOCAL_H
#define HYPERFOCAL_H

#include <stddef.h>
#include <stdint.h>

#include "params.h"
#include "version.h"

#ifdef __cplusplus
extern "C" {
#endif

// What functions return.
enum hf_error {
    HF_OK = 0,
    HF_ERR_ARG = -1,        // an argument is out of its documented range; the message names it and its value
    HF_ERR_MEMORY = -2,     // the allocator returned NULL
    HF_ERR_THREAD = -3,     // a thread could not be started, or is not in this process (after fork)
    HF_ERR_ISA = -4,        // the instruction set asked for is not available on this CPU or in this build
    HF_ERR_FOCUS = -5,      // there is no surface where the focus was to be read
    HF_ERR_CANCELLED = -6,  // hf_cancel was called, or the progress callback asked for it
    HF_ERR_ABI = -7,        // the program was compiled for another HF_ABI_VERSION
};

// One sentence for an error code. Never NULL, also for numbers that are no code.
HF_API const char *hf_error_string(int error);

// Version of the library in use as "major.minor.patch". HF_VERSION_* is the header's.
HF_API const char *hf_version(void);
// HF_ABI_VERSION of the library in use.
HF_API int hf_abi_version(void);

enum hf_log_level { HF_LOG_ERROR, HF_LOG_WARNING, HF_LOG_INFO };

// What the library says about a call.
struct hf_message {
    size_t size;              // sizeof(struct hf_message)
    enum hf_log_level level;  // HF_LOG_ERROR: the call fails
    int error;                // what the call returns, HF_OK for warnings and notes
    // The field or argument that the sentence is about, as in C: "range.strength", "src.format". "" if there is none.
    char argument[64];
    // One sentence without line break. It begins with the argument, if there is one: a program that calls it something
    // else, an option perhaps, prints its own name and then sentence + strlen(argument).
    char sentence[256];
};

// Instruction sets, lowest first. HF_ISA_AUTO is the best one that CPU and build have, unless the environment variable
// HYPERFOCAL_ISA holds the name of another one: scalar, sse4.1, avx2, avx512 or neon. Other names are HF_ERR_ISA.
enum hf_isa { HF_ISA_AUTO, HF_ISA_SCALAR, HF_ISA_SSE41, HF_ISA_AVX2, HF_ISA_AVX512, HF_ISA_NEON };

// The name of an instruction set; NULL for a number that is none.
HF_API const char *hf_isa_name(enum hf_isa isa);
// 1 if this CPU and this build can run it, else 0. AUTO and SCALAR are always available.
HF_API int hf_isa_available(enum hf_isa isa);

// How a context is set up. 0 is the default of every field except size.
struct hf_config {
    size_t size;  // sizeof(struct hf_config)
    // Threads to work on, the caller included: 0 (default), one for each online processor, to 256. With parallel_for it
    // is the number of worker slots that the host promises never to exceed.
    int threads;
    // The instruction set to use. Default HF_ISA_AUTO. HF_ERR_ISA if it is not available.
    enum hf_isa isa;

    // Allocator: both functions or neither. Default: malloc's family. alloc returns size bytes aligned to align (a
    // power of two), or NULL. The library allocates in hf_open and on the first frame of a size, not on every frame.
    // Thread stacks and the C library's own memory for threads do not come from here.
    void *(*alloc)(void *cookie, size_t size, size_t align);
    void (*free)(void *cookie, void *ptr);
    void *alloc_cookie;

    // Receives each error, warning and note, on the caller's thread. The message lives until log returns. Default:
    // none.
    void (*log)(void *cookie, const struct hf_message *message);
    void *log_cookie;

    // Size of the tiles that threads are given, half-resolution pixels: 0 (default), which measured fastest, or 16 to
    // 65536, tile_width a multiple of 16. It changes speed and memory, never a bit.
    int tile_width, tile_height;

    // The host's own threads. parallel_for must call fn(arg, i, worker) once for each i in [0, n), from any threads,
    // with 0 <= worker < threads and no worker number in use twice at a time, and return when all calls are done. NULL
    // (default): the library starts threads of its own in hf_open.
    void (*parallel_for)(void *cookie, int n, void (*fn)(void *arg, int i, int worker), void *arg);
    void *parallel_cookie;
};

struct hf_context;

// Make a context. config may be NULL (defaults) and need only live until the call returns. On error *out is NULL. abi
// is the caller's HF_ABI_VERSION: when it is another one than the library's, config is not read. Errors: HF_ERR_ABI,
// HF_ERR_ARG, HF_ERR_MEMORY, HF_ERR_THREAD, HF_ERR_ISA.
HF_API int hf_open_abi(struct hf_context **out, const struct hf_config *config, int abi);

// The same for programs that are compiled with this header.
static inline int hf_open(struct hf_context **out, const struct hf_config *config)
{
    return hf_open_abi(out, config, HF_ABI_VERSION);
}

// Stop the threads, free everything, set *c to NULL. c and *c may be NULL.
HF_API void hf_close(struct hf_context **c);

// What the context really uses in place of AUTO and 0.
HF_API enum hf_isa hf_context_isa(const struct hf_context *c);
HF_API int hf_context_threads(const struct hf_context *c);

// Layout of the pixels of an image.
enum hf_format {
    HF_FORMAT_RGBA32F,     // 4 floats a pixel
    HF_FORMAT_RGB32F,      // 3 floats a pixel
    HF_FORMAT_RGBA16F,     // 4 IEEE half floats a pixel
    HF_FORMAT_R11G11B10F,  // one 32-bit word a pixel: R in bits 0-10, G 11-21, B 22-31; 5 exponent bits, no sign
    HF_FORMAT_PLANAR32F,   // three or four planes of floats
    // Whole numbers: 0 is 0, the largest is 1. hf_image.transfer says how they follow from light.
    HF_FORMAT_RGBA8,    // 4 bytes a pixel: R, G, B, A in memory
    HF_FORMAT_BGRA8,    // B, G, R, A
    HF_FORMAT_RGBX8,    // R, G, B and an unused byte: read as alpha 1, written as 255
    HF_FORMAT_BGRX8,    // B, G, R and an unused byte
    HF_FORMAT_RGB10A2,  // one 32-bit word a pixel: R in bits 0-9, G 10-19, B 20-29, A 30-31
    HF_FORMAT_RGBA16,   // 4 16-bit numbers a pixel
};

// How the numbers of a format of whole numbers follow from light. Alpha is always linear.
enum hf_transfer {
    HF_TRANSFER_LINEAR,
    HF_TRANSFER_SRGB,  // IEC 61966-2-1: what a display is sent
};

// A picture in the caller's memory.
struct hf_image {
    size_t size;            // sizeof(struct hf_image)
    int width, height;      // pixels, 1 to 65536 each
    enum hf_format format;  // layout of a pixel, and of the planes
    // Default HF_TRANSFER_LINEAR. HF_TRANSFER_SRGB for formats of whole numbers only, else HF_ERR_ARG.
    enum hf_transfer transfer;
    void *data[4];  // the top left pixel. PLANAR32F: of R, G, B, A (A may be NULL: no alpha). Other formats: data[0]
    // Bytes from one row to the next, for each plane in use: at least those of a row, or at most minus that (bottom-up
    // pictures). Bytes between rows are neither read nor written.
    ptrdiff_t stride[4];
};

// What the numbers of a depth buffer mean; z is view depth. "No surface" counts as infinitely far.
enum hf_depth_type {
    HF_DEPTH_VIEW,          // z itself; 0, negative, >= 1e10 and +Inf: no surface
    HF_DEPTH_RAY,           // distance along the pixel's ray: z = t / sqrt(1 + tan^2); no surface as for VIEW
    HF_DEPTH_NDC_D3D,       // 0 at near_plane to 1 at far_plane (also OpenGL's window depth)
    HF_DEPTH_NDC_GL,        // -1 at near_plane to 1 at far_plane
    HF_DEPTH_NDC_REVERSED,  // 1 at near_plane to 0 at far_plane: d = n(f-z)/(z(f-n)), with infinite far d = n/z
    HF_DEPTH_INVERSE,       // 1/z; 0 or negative: no surface
    HF_DEPTH_COC,           // signed CoC radius in full-resolution pixels; no lens or range is applied
};

// How a depth sample is stored. Whole numbers are divided by their largest value, which gives 0 to 1, and are rounded
// to the nearest float. The log warns where whole numbers are surely no distances.
enum hf_depth_format {
    HF_DEPTH_FORMAT_FLOAT32,
    HF_DEPTH_FORMAT_FLOAT16,
    HF_DEPTH_FORMAT_UNORM16,
    HF_DEPTH_FORMAT_UNORM32,
    HF_DEPTH_FORMAT_D24S8,  // a 32-bit word, depth in its upper 24 bits: OpenGL's UNSIGNED_INT_24_8
    HF_DEPTH_FORMAT_X8D24,  // a 32-bit word, depth in its lower 24 bits: Direct3D, Vulkan
};

// Depth of a picture of the same width and height. It is never written. A NaN counts as the largest finite depth among
// its 8 neighbours; where there is none, as no surface.
struct hf_depth {
    size_t size;                  // sizeof(struct hf_depth)
    const void *data;             // the top left pixel
    ptrdiff_t stride;             // bytes from one row to the next, as for hf_image
    enum hf_depth_type type;      // default HF_DEPTH_VIEW
    enum hf_depth_format format;  // default HF_DEPTH_FORMAT_FLOAT32
    // Clip planes for HF_DEPTH_NDC_*, scene units: 0 < near_plane < far_plane; far_plane may be INFINITY. The gaussian
    // engine scales depth by them whatever the type: there 0 (default) means 1 for near_plane and 100 times near_plane
    // for far_plane.
    float near_plane, far_plane;
    // For HF_DEPTH_RAY: focal length in pixels (> 0), and the picture's optical axis in pixels from the top left
    // corner.
    float focal_px, center_x, center_y;
    uint32_t reserved;
};

// Read the view depth at pixel (x, y) of a width x height depth buffer (at most 65536 each) into *z: for a viewer's
// command to focus where the user points. message may be NULL. Errors: HF_ERR_FOCUS if there is no surface; HF_ERR_ARG,
// also for HF_DEPTH_COC, which holds no distances.
HF_API int hf_depth_at(const struct hf_depth *depth, int width, int height, int x, int y, float *z,
                       struct hf_message *message);

// Blur src into dst. Both have the same size; their formats may differ. dst may be src itself, with the same pointers,
// strides and format; any other overlap is undefined. An output without alpha drops it. An output with alpha gets alpha
// 1 from an input without. A colour sample that is NaN or infinite counts as the mean of the finite ones among its 8
// neighbours, else as 0, and the report counts it. params may be NULL (defaults). On error the pixels of dst are
// unspecified. Errors: HF_ERR_ARG, HF_ERR_FOCUS, HF_ERR_MEMORY, HF_ERR_THREAD, HF_ERR_CANCELLED.
HF_API int hf_render(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                     const struct hf_depth *depth, const struct hf_params *params);

// A rectangle of a picture.
struct hf_region {
    size_t size;              // sizeof(struct hf_region)
    int x, y, width, height;  // pixels from the top left corner; width and height at least 1, all of it in the picture
};

// As hf_render, but of dst only the pixels of a region (NULL: all) are written: with the bits that hf_render of the
// whole picture writes there. src, depth and dst describe whole pictures. Of dst no byte outside the region is read or
// written, so its memory may be a tile: data then points to where pixel (0, 0) would be, and stride is the tile's. dst
// may be src, as for hf_render. The cost grows with the region and with what is blurred into it. Some numbers are of
// the whole picture:
//   - All depth is looked at, as the largest radius decides how many levels, slices or kernels there are. The gaussian
//     engine, and the gather with max_radius given or the range model, look at depth around the region alone.
//   - Scatter reads all colour that is blurred, as the brightest sample decides the units of its sums.
//   - The gaussian engine reads all colour when sigma is given, as it blurs whole columns and rows.
// The context holds as much memory as for a whole picture. The report counts what was worked on. run.budget_ms chooses
// the setting that hf_render would use next, but the time of a region is not counted. With hf_inspect_dump the whole
// picture is made. Errors as for hf_render, and HF_ERR_ARG for a region that is not in the picture.
HF_API int hf_render_region(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                            const struct hf_depth *depth, const struct hf_params *params,
                            const struct hf_region *region);

// What hf_render_region with the same arguments will read of the colour and of the depth: samples outside these
// rectangles do not count. The rectangles may be larger than need be. With params->focus HF_DERIVE, the depth in the
// middle of the picture is read as well. This call looks at the depth as hf_plan does, and not at the colour. colour
// and depth_read may be NULL; their contents before the call are not looked at. On error they are empty. Errors as for
// hf_render_region.
HF_API int hf_region_reads(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                           const struct hf_depth *depth, const struct hf_params *params, const struct hf_region *region,
                           struct hf_region *colour, struct hf_region *depth_read);

// Cancel the call of hf_render, hf_prepare or hf_plan that runs on c now: from any thread, also from callbacks. The
// call returns HF_ERR_CANCELLED soon: within about a millisecond of work, plus what the system takes to wake a thread,
// and in a context's first frame to give it memory (up to tens of milliseconds). hf_cancel itself does not wait. The
// pixels of dst are then unspecified: in place, the picture is lost. The report is all zero and the log says nothing.
// The context is as good as before, and so is all that it holds. A call that has just finished its picture returns
// HF_OK all the same. When none runs nothing happens, and a call that begins later is not cancelled; who cannot know
// whether the call has begun cancels through the progress callback. c must not be closed meanwhile; NULL does nothing.
HF_API void hf_cancel(struct hf_context *c);

// From now on call fn while hf_render runs on c; fn NULL (default) ends it. done says how much of the frame is done, 0
// to 1, as far as earlier frames or a table tell: it never falls, and comes at most about a hundred times. If the call
// succeeds the last one has done 1, when the picture is whole; a call that returns an error may have no such. If fn
// returns other than 0 the call is cancelled as by hf_cancel, except that what fn returns for 1 is not looked at. fn is
// called by the thread that called hf_render; with parallel_for by any of the host's threads, never by two at a time.
// It may call hf_cancel, and no other function with this context. hf_set_progress itself is to be called when nothing
// runs on c.
HF_API void hf_set_progress(struct hf_context *c, int (*fn)(void *cookie, float done), void *cookie);

// Take all memory that frames of this size will use, with these parameters and with CoC radii as in this depth, so that
// the first frame is not late. It renders nothing, and looks neither at dst nor at the colour of src. Errors as for
// hf_render.
HF_API int hf_prepare(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                      const struct hf_depth *depth, const struct hf_params *params);

// What limits the CoC radius.
enum hf_limit {
    HF_LIMIT_NONE,     // nothing except the library's largest radius, 2048 pixels
    HF_LIMIT_GIVEN,    // max_radius was given
    HF_LIMIT_MODEL,    // the range model blurs up to 12 pixels at 1080 lines unless max_radius is given
    HF_LIMIT_ENGINE,   // the engine reaches no farther unless max_radius is given
    HF_LIMIT_PICTURE,  // aperture.picture is drawn up to this size only
};

// What parameters come to for a picture.
struct hf_resolved {
    size_t size;          // sizeof(struct hf_resolved)
    int width, height;    // of the image, pixels
    enum hf_limit limit;  // what set max_radius
    float lens_k;         // K of the lens model, scene units * pixels; 0 with other models
    float focal_px;       // focal length of the lens, pixels of the display width; 0 with other models
    int sharp;            // 1: nothing can be blurred, the frame will be a copy
    int picture;          // 1: there is an aperture.picture
    uint32_t reserved;
};

// What hf_render would make of params (NULL: defaults) for a width x height picture: *filled gets the parameters
// without HF_DERIVE, *resolved the numbers that follow. If hf_render would fail, *message gets the reason. All three
// may be NULL. depth->data may be NULL if there are no pixels yet; then params->focus must not be HF_DERIVE. Errors:
// HF_ERR_ARG, HF_ERR_FOCUS; then *filled and *resolved are 0 except for their size.
HF_API int hf_resolve(int width, int height, const struct hf_depth *depth, const struct hf_params *params,
                      struct hf_params *filled, struct hf_resolved *resolved, struct hf_message *message);

// How good a picture has to be. Each quality is a step on a ladder of settings. Each step is slower than the one
// before, at least 0.2 dB closer to what a ray tracer sees on the mean, and farther from it on no measured scene where
// either can be chosen.
enum hf_quality {
    HF_QUALITY_DRAFT,     // the cheapest that blurs as far as any lens: the gather
    HF_QUALITY_STANDARD,  // the cheapest within 1.5 dB of the best; also for moving pictures
    HF_QUALITY_HIGH,      // an old name of the best
    HF_QUALITY_BEST,      // the most accurate
};

// What a choice is expected to cost and how far it is from a ray-traced picture, as `hyperfocal-bench tradeoff`
// measured it on scenes of 1280 x 720 pixels with CoC radii of up to 57 pixels. Other machines and scenes differ.
struct hf_choice {
    size_t size;  // sizeof(struct hf_choice)
    // Root mean square distance of the display-encoded pictures, 0 to 1: geometric mean over the scenes, and the worst
    // scene.
    float error, worst;
    float ms;  // milliseconds of a megapixel
    uint32_t reserved;
    // Why a cheaper setting of this quality or error was passed over, as the rest of "it ...": NULL if none was. Lives
    // as long as the library.
    const char *why;
};

// Set the engine of *params and the engine's knobs to those of a quality, and leave all other fields as they are.
// height: of the pictures, pixels. Only the type of depth counts (NULL: distances). A step that does not reach as far
// as the blur asked for, or does not draw params->aperture, is passed over for the next better one that does. The blur
// asked for is max_radius. Without max_radius it is 12 pixels at 1080 lines with the range model, and any radius with a
// lens or HF_DEPTH_COC: the gaussian engine, whose blur has one width everywhere (twice its standard deviation), is
// never chosen then. choice and message may be NULL. Errors: HF_ERR_ARG.
HF_API int hf_choose_quality(int height, const struct hf_depth *depth, struct hf_params *params,
                             enum hf_quality quality, struct hf_choice *choice, struct hf_message *message);
// The same by the largest acceptable error, as in hf_choice: more than 0, at most 1. It chooses the cheapest step whose
// expected error is not larger; if there is none, the last step.
HF_API int hf_choose_error(int height, const struct hf_depth *depth, struct hf_params *params, float error,
                           struct hf_choice *choice, struct hf_message *message);

// What a frame calls for, and what became of it.
struct hf_report {
    size_t size;  // sizeof(struct hf_report)
    // Cheaper settings that run.budget_ms made the library take: 0, as asked for; each step is cheaper. And of how many
    // steps; 0 without a budget.
    int budget_step, budget_steps;
    // The largest CoC radii in front of the focus and behind it, full-resolution pixels.
    float near_radius, far_radius;
    uint64_t memory;  // bytes of buffers that the frame needs
    // Bytes that the context will hold when hf_render has made this frame, from its allocator, what it holds now
    // included: to the byte, unless hf_inspect_dump is in use, or the frame is made in place and has samples that are
    // not finite. hf_plan has taken the tables and the scratch of the threads by then, but nothing as large as the
    // frame.
    uint64_t memory_needed;
    double predicted_ms;  // expected time of the whole frame

    // The following is 0 after hf_plan and hf_prepare.
    double total_ms;                                 // wall time of the call
    uint64_t memory_held;                            // bytes that the context holds
    uint64_t near_pixels, sharp_pixels, far_pixels;  // pixels by their own CoC
    uint64_t colour_repaired;                        // colour samples (channels of pixels) that were NaN or infinite
    uint64_t depth_repaired;                         // depth samples that were NaN
    uint64_t no_surface;                             // pixels without a surface
    uint64_t clamped;  // samples clamped: of the output to the range of its format, of the input as the engine needs it
    // With layers.guessed: the share of the light of all rendered pixels that was guessed, 0 to 1; else 0.
    double guessed;
};

// What hf_render would do with the same arguments: it looks at the depth only and renders nothing. report may be NULL.
// Errors as for hf_render.
HF_API int hf_plan(struct hf_context *c, const struct hf_image *dst, const struct hf_image *src,
                   const struct hf_depth *depth, const struct hf_params *params, struct hf_report *report);

// What the last hf_render, hf_plan or hf_prepare did. If there was none, or it failed, all fields except size are 0.
// Errors: HF_ERR_ARG.
HF_API int hf_get_report(struct hf_context *c, struct hf_report *report);
// What that frame was rendered with: the parameters without HF_DERIVE, of a cheaper setting where the budget chose one,
// and what they came to. aperture.picture is NULL, because the caller may have freed it. Both may be NULL. Errors:
// HF_ERR_ARG.
HF_API int hf_get_used(struct hf_context *c, struct hf_params *params, struct hf_resolved *resolved);
// Why the last call with this context that failed did so. Before the first one, error is HF_OK and the texts are "".
// Errors: HF_ERR_ARG.
HF_API int hf_get_problem(const struct hf_context *c, struct hf_message *message);

// Families of words: the names that command lines and files use for values.
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
    HF_NAMES_LIMIT,         // none, given, model, engine, picture
    HF_NAMES_QUALITY,       // draft, standard, high, best
    HF_NAMES_DOWNSAMPLE,    // bilateral, linear, point
    HF_NAMES_DIVISION,      // exact, estimate, newton, newton2
    HF_NAMES_LAYERS,        // standard, draft, high, best: enum hf_layers_quality
};

// The word for a value. NULL for a value or a family that does not exist. Values of all families begin at 0 and have no
// gaps.
HF_API const char *hf_name(enum hf_names of, int value);
// The value of a word. Returns HF_OK with the value in *value, or HF_ERR_ARG for a word that does not exist. "chapter"
// is an old word for packed.
HF_API int hf_value(enum hf_names of, const char *name, int *value);
// The same as hf_name(HF_NAMES_ENGINE, engine).
HF_API const char *hf_engine_name(enum hf_engine engine);

#ifdef __cplusplus
}
#endif

#endif
