// SPDX-License-Identifier: BSD-3-Clause
// The library's own functions: any parameters, formats, strides, sizes to 256, failing allocations, instruction sets. A
// call is refused or it works; it touches nothing but what its arguments describe, and gives all memory back. Without
// AddressSanitizer every block ends where a page begins that nobody may touch.
#include <float.h>
#include <math.h>
#include <string.h>
#include <sys/mman.h>

#include "fuzz/fuzz.h"
#include "hyperfocal/hyperfocal.h"

// ---- memory ----

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ADDRESS_SANITIZER
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define ADDRESS_SANITIZER
#endif

#ifdef ADDRESS_SANITIZER
static void *block_of(size_t size, size_t align)
{
    void *p = NULL;
    return posix_memalign(&p, align < sizeof(void *) ? sizeof(void *) : align, size ? size : 1) ? NULL : p;
}

static void free_block(void *p)
{
    free(p);
}
#else
enum { PAGE = 4096 };

// A page that says how long it is, the block at the end of its pages, a page that nobody may touch.
static void *block_of(size_t size, size_t align)
{
    const size_t whole = ((size ? size : 1) + align - 1) / align * align;
    const size_t room = (whole + PAGE - 1) / PAGE * PAGE, all = room + 2 * PAGE;
    char *start = mmap(NULL, all, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (start == MAP_FAILED)
        return NULL;
    memcpy(start, &all, sizeof(all));
    MUST(!mprotect(start + PAGE + room, PAGE, PROT_NONE));
    return start + PAGE + room - whole;
}

static void free_block(void *p)
{
    if (!p)
        return;
    char *start = (char *)((uintptr_t)p / PAGE * PAGE) - PAGE;  // it begins in the second page
    size_t all;
    memcpy(&all, start, sizeof(all));
    MUST(!munmap(start, all));
}
#endif

static long live, calls, fails_at;

static void *take(void *cookie, size_t size, size_t align)
{
    (void)cookie;
    // Small frames under the largest radius may want more than a machine that runs tests has to give.
    void *p = calls++ == fails_at || size > (size_t)1 << 31 ? NULL : block_of(size, align);
    if (!p)
        return NULL;
    live++;
    return memset(p, 0xff, size);
}

static void give(void *cookie, void *p)
{
    (void)cookie;
    MUST(p != NULL);
    live--;
    free_block(p);
}

// ---- arguments ----

static float any_float(struct bytes *b)
{
    static const float odd[] = {0,        -0.0f, 1,        -1,        0.5f,  2,       12,    255,
                                256,      2048,  1e-42f,   1e-20f,    1e20f, -1e-42f, 1e30f, FLT_MAX,
                                -FLT_MAX, NAN,   INFINITY, -INFINITY, 0.25f, 0.249f,  20,    100};
    const unsigned kind = take_byte(b);
    if (kind < 160)
        return odd[kind % (sizeof odd / sizeof *odd)];
    if (kind < 220)
        return (float)take_byte(b) / 16;
    const uint32_t bits = take_word(b);
    float v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

// Mostly one of the first `most`, now and then anything.
static int any_choice(struct bytes *b, unsigned most)
{
    const unsigned v = take_byte(b);
    return v == 255 ? (int)take_word(b) : (int)(v % most);
}

// A float near a sensible one, so that whole calls work now and then.
static void maybe(struct bytes *b, float *field)
{
    if (take_byte(b) < 40)
        *field = any_float(b);
}

// by * v + plus; v may be any int.
static int scaled(int v, unsigned by, int plus)
{
    return (int)((unsigned)v * by + (unsigned)plus);
}

static struct hf_params any_params(struct bytes *b)
{
    struct hf_params p = hf_default_params;
    p.engine = (enum hf_engine)any_choice(b, HF_ENGINE_COUNT);
    p.model = (enum hf_model)any_choice(b, 2);
    maybe(b, &p.focus);
    maybe(b, &p.range.distance);
    maybe(b, &p.range.strength);
    maybe(b, &p.range.near_begin);
    maybe(b, &p.range.near_end);
    maybe(b, &p.range.far_begin);
    maybe(b, &p.range.far_end);
    p.range.blend = (enum hf_blend)any_choice(b, 2);
    maybe(b, &p.lens.f_number);
    maybe(b, &p.lens.focal_length_mm);
    maybe(b, &p.lens.sensor_width_mm);
    maybe(b, &p.lens.world_unit_m);
    p.max_radius = take_byte(b) < 200 ? (float)take_byte(b) / 8 : any_float(b);
    if (take_byte(b) < 60) {
        p.aperture.blades = any_choice(b, 17);
        maybe(b, &p.aperture.rotation);
        maybe(b, &p.aperture.roundness);
        maybe(b, &p.aperture.ring);
        maybe(b, &p.aperture.cat_eye);
        maybe(b, &p.aperture.squeeze);
    }
    if (take_byte(b) < 40) {
        p.view.display_width = scaled(any_choice(b, 255), 16, -16);
        p.view.display_height = scaled(any_choice(b, 255), 16, -16);
        maybe(b, &p.view.pixel_aspect);
    }
    p.gather.storage = (enum hf_storage)any_choice(b, 3);
    p.gather.fill = (enum hf_fill)any_choice(b, 3);
    const unsigned flags = take_byte(b);
    p.gather.faithful = flags & 1;
    p.gather.karis = flags >> 1 & 1;
    p.gather.per_pixel_kernel = flags >> 2 & 1;
    p.gather.bicubic = flags >> 3 & 1;
    p.hexagon.uniform = flags >> 4 & 1;
    p.run.deterministic = flags >> 5 & 1;
    p.run.no_skip = flags >> 6 & 1;
    p.run.colour_stats = flags >> 7;
    if (take_byte(b) < 30)
        p.gather.rings = scaled(any_choice(b, 70), 1, -1);
    p.hexagon.resolution = (enum hf_resolution)any_choice(b, 2);
    p.scatter.resolution = (enum hf_resolution)any_choice(b, 2);
    p.gaussian.resolution = (enum hf_resolution)any_choice(b, 3);
    maybe(b, &p.aperture.chromatic);
    p.gaussian.iterations = scaled(any_choice(b, 70), 1, -1);
    maybe(b, &p.gaussian.sigma);
    maybe(b, &p.run.budget_ms);
    maybe(b, &p.highlight.gain);
    maybe(b, &p.highlight.threshold);
    return p;
}

// Mostly 1 to `most`; now and then what is refused. Nothing that is accepted and takes gigabytes.
static int any_size(struct bytes *b, unsigned most)
{
    const unsigned v = take_byte(b);
    if (v < 255)
        return 1 + (int)(v % most);
    const int odd = (int)take_word(b);
    return odd >= 1 && odd <= 65536 ? -odd : odd;
}

// Memory for what the descriptor says, filled with anything; if it cannot be true, none is needed.
static void *any_plane(struct bytes *b, size_t pixel, int w, int h, ptrdiff_t *stride, void **block)
{
    const size_t row = w > 0 ? pixel * (size_t)w : 0;
    const unsigned kind = take_byte(b);
    ptrdiff_t step = (ptrdiff_t)row + (kind % 4 == 0 ? kind / 4 : 0);
    if (kind == 255)
        step = h > 1 ? (ptrdiff_t)(take_word(b) & 0x1ffff) - (1 << 16) : (ptrdiff_t)take_word(b) - (1 << 20);
    if (kind % 5 == 4)
        step = -step;
    *stride = step;
    const size_t size = (step < 0 ? (size_t)-step : (size_t)step);
    if (!row || h < 1 || w > 65536 || h > 65536 || size < row)
        return *block = block_of(1, 1);  // to be refused
    const size_t offset = kind % 7 == 6 ? 1 : 0, bytes = size * (size_t)(h - 1) + row + offset;
    unsigned char *p = *block = block_of(bytes, 4);
    MUST(p != NULL);
    uint32_t state = take_word(b) | 1;
    const int calm = kind & 1;
    for (size_t i = 0; i < bytes; i++) {
        state = state * 1664525u + 1013904223u;
        p[i] = (unsigned char)(calm ? (i % 4 == 3 ? 0x3e : state >> 25) : state >> 24);
    }
    p += offset;
    return step < 0 ? p + size * (size_t)(h - 1) : p;
}

static struct hf_image any_image(struct bytes *b, int w, int h, void *blocks[4])
{
    static const size_t pixel[] = {16, 12, 8, 4, 4, 4, 4, 4, 4, 4, 8};
    enum { FORMATS = sizeof pixel / sizeof *pixel };
    struct hf_image m = {.width = w, .height = h, .format = (enum hf_format)any_choice(b, FORMATS)};
    const int planes = m.format == HF_FORMAT_PLANAR32F ? 3 + (take_byte(b) & 1) : 1;
    const size_t bytes = (unsigned)m.format < FORMATS ? pixel[m.format] : 0;
    if (m.format >= HF_FORMAT_RGBA8 || take_byte(b) == 255)
        m.transfer = (enum hf_transfer)any_choice(b, 2);
    for (int i = 0; i < planes; i++)
        m.data[i] = any_plane(b, bytes, w, h, &m.stride[i], &blocks[i]);
    if (take_byte(b) == 255)
        m.data[0] = NULL;
    return m;
}

static struct hf_depth any_depth(struct bytes *b, int w, int h, void **block)
{
    static const size_t sample[] = {4, 2, 2, 4, 4, 4};
    enum { FORMATS = sizeof sample / sizeof *sample };
    struct hf_depth d = {.type = (enum hf_depth_type)any_choice(b, 7),
                         .format = (enum hf_depth_format)any_choice(b, FORMATS)};
    d.data = any_plane(b, (unsigned)d.format < FORMATS ? sample[d.format] : 0, w, h, &d.stride, block);
    maybe(b, &d.near_plane);
    maybe(b, &d.far_plane);
    maybe(b, &d.focal_px);
    return d;
}

// One of those that this processor has; all calls the one that HYPERFOCAL_ISA names.
static enum hf_isa any_isa(struct bytes *b)
{
    const unsigned first = take_byte(b);
    if (getenv("HYPERFOCAL_ISA"))
        return HF_ISA_AUTO;
    for (unsigned i = 0; i <= HF_ISA_NEON; i++) {
        const enum hf_isa isa = (enum hf_isa)((first + i) % (HF_ISA_NEON + 1));
        if (hf_isa_available(isa))
            return isa;
    }
    return HF_ISA_AUTO;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct bytes b = {data, size};
    void *blocks[12] = {0};
    const unsigned how = take_byte(&b);
    struct hf_config config = {.threads = 1 + (how & 1), .isa = any_isa(&b), .alloc = take, .free = give};
    if (how & 4) {
        config.tile_width = scaled(any_choice(&b, 6), 16, 16);
        config.tile_height = scaled(any_choice(&b, 40), 1, 16);
    }
    live = calls = 0;
    fails_at = how & 8 ? (long)take_byte(&b) : -1;
    struct hf_context *c = NULL;
    const int opened = hf_open(&c, &config);
    MUST(!opened == (c != NULL));
    for (int frame = 0; c && frame < 1 + (int)(how >> 4 & 1); frame++) {
        const int w = any_size(&b, how & 32 ? 24 : 256), h = any_size(&b, how & 32 ? 256 : 24);
        const struct hf_image src = any_image(&b, w, h, blocks);
        struct hf_image dst = how & 64 ? src : any_image(&b, take_byte(&b) == 255 ? w + 1 : w, h, blocks + 4);
        const struct hf_depth depth = any_depth(&b, w, h, &blocks[8]);
        const struct hf_params p = any_params(&b);
        struct hf_report report;
        const int planned = hf_plan(c, &dst, &src, &depth, &p, &report);
        const int err = hf_render(c, &dst, &src, &depth, &p);
        MUST(err == HF_OK || err == HF_ERR_ARG || err == HF_ERR_MEMORY || err == HF_ERR_FOCUS);
        MUST(planned != HF_ERR_ARG || err == HF_ERR_ARG);
        hf_get_report(c, &report);
        // Ranges that overlap make a pixel near and far at once; a copy looks at no depth.
        const uint64_t n = (uint64_t)w * (uint64_t)h,
                       counted = report.near_pixels + report.sharp_pixels + report.far_pixels;
        MUST(err || counted == 0 ||
             (counted >= n && report.near_pixels <= n && report.sharp_pixels + report.far_pixels <= n));
        for (int i = 0; i < 12; i++) {
            free_block(blocks[i]);
            blocks[i] = NULL;
        }
    }
    hf_close(&c);
    MUST(live == 0);
    return 0;
}
