// SPDX-License-Identifier: BSD-3-Clause
// The library's own functions with random parameters, formats, strides, sizes up to 256, failing allocations,
// instruction sets, sizes of structs. A call is either refused with one sentence, or it works: its input stays unchanged, its
// output is finite, and all memory is freed. Without AddressSanitizer every block ends at a forbidden page.
#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "fuzz/blocks.h"
#include "fuzz/fuzz.h"
#include "tools/common/report.h"

// ---- memory ----

// The memory of an argument.
struct area {
    void *start;
    size_t bytes;
};

static struct area area_of(size_t bytes)
{
    const struct area a = {block_of(bytes, 4), bytes};
    MUST(a.start != NULL);
    return a;
}

static uint64_t hash_of(const struct area *areas, int count)
{
    uint64_t h = 0xcbf29ce484222325u;
    for (int i = 0; i < count; i++)
        for (size_t k = 0; k < areas[i].bytes; k += sizeof h) {
            const size_t left = areas[i].bytes - k;
            uint64_t word = 0;
            memcpy(&word, (const char *)areas[i].start + k, left < sizeof word ? left : sizeof word);
            h = (h ^ word) * 0x9e3779b97f4a7c15u;
            h ^= h >> 29;
        }
    return h;
}

static long live, calls, fails_at, fails_to;  // which calls fail
static int fresh;                             // the initial contents of memory: dumps show buffers that no pass wrote

static void *take(void *cookie, size_t size, size_t align)
{
    (void)cookie;
    const long call = calls++;
    // Small frames with the largest radius may need more memory than a test machine has.
    const int fails = (call >= fails_at && call < fails_to) || size > (size_t)1 << 31;
    void *p = fails ? NULL : block_of(size, align);
    if (!p)
        return NULL;
    live++;
    return memset(p, fresh, size);
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

// Mostly one of the first `most`, sometimes any value.
static int any_choice(struct bytes *b, unsigned most)
{
    const unsigned v = take_byte(b);
    return v == 255 ? (int)take_word(b) : (int)(v % most);
}

// A float near a sensible one, so that whole calls work sometimes.
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
    struct hf_params p = hf_default_params();
    p.engine = (enum hf_engine)any_choice(b, (unsigned)tool_engines());
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
    p.max_radius = take_byte(b) < 245 ? (float)take_byte(b) / 8 : any_float(b);
    if (fuzz_small && p.max_radius > 64)
        p.max_radius = 64;
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
    p.gather.storage = p.chapter.storage = (enum hf_storage)any_choice(b, 3);
    p.chapter.fill = (enum hf_fill)any_choice(b, 3);
    const unsigned flags = take_byte(b);
    p.chapter.faithful = flags & 1;
    p.gather.karis = p.chapter.karis = flags >> 1 & 1;
    p.gather.per_pixel_kernel = p.chapter.per_pixel_kernel = flags >> 2 & 1;
    p.gather.bicubic = p.chapter.bicubic = flags >> 3 & 1;
    p.hexagon.uniform = flags >> 4 & 1;
    p.run.deterministic = flags >> 5 & 1;
    p.run.no_skip = flags >> 6 & 1;
    if (take_byte(b) < 30)
        p.chapter.rings = scaled(any_choice(b, 70), 1, -1);
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

// Mostly 1 to `most`, sometimes a size that is refused; never one that is accepted and takes gigabytes.
static int any_size(struct bytes *b, unsigned most)
{
    const unsigned v = take_byte(b);
    if (v < 255)
        return 1 + (int)(v % most);
    const int odd = (int)take_word(b);
    return odd >= 1 && odd <= 65536 ? -odd : odd;
}

// Random memory for what the descriptor says; if the description is impossible, none is needed.
static void *any_plane(struct bytes *b, size_t pixel, int w, int h, ptrdiff_t *stride, struct area *area)
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
        return (*area = area_of(1)).start;  // will be refused
    const size_t offset = kind % 7 == 6 ? 1 : 0, bytes = size * (size_t)(h - 1) + row + offset;
    unsigned char *p = (*area = area_of(bytes)).start;
    uint32_t state = take_word(b) | 1;
    const int calm = kind & 1;
    for (size_t i = 0; i < bytes; i++) {
        state = state * 1664525u + 1013904223u;
        p[i] = (unsigned char)(calm ? (i % 4 == 3 ? 0x3e : state >> 25) : state >> 24);
    }
    p += offset;
    return step < 0 ? p + size * (size_t)(h - 1) : p;
}

static struct hf_image any_image(struct bytes *b, int w, int h, struct area areas[4])
{
    static const size_t pixel[] = {16, 12, 8, 4, 4, 4, 4, 4, 4, 4, 8};
    enum { FORMATS = sizeof pixel / sizeof *pixel };
    struct hf_image m = {.size = sizeof m, .width = w, .height = h, .format = (enum hf_format)any_choice(b, FORMATS)};
    const int planes = m.format == HF_FORMAT_PLANAR32F ? 3 + (take_byte(b) & 1) : 1;
    const size_t bytes = (unsigned)m.format < FORMATS ? pixel[m.format] : 0;
    if (m.format >= HF_FORMAT_RGBA8 || take_byte(b) == 255)
        m.transfer = (enum hf_transfer)any_choice(b, 2);
    for (int i = 0; i < planes; i++)
        m.data[i] = any_plane(b, bytes, w, h, &m.stride[i], &areas[i]);
    if (take_byte(b) == 255)
        m.data[0] = NULL;
    return m;
}

static struct hf_depth any_depth(struct bytes *b, int w, int h, struct area *area)
{
    static const size_t sample[] = {4, 2, 2, 4, 4, 4};
    enum { FORMATS = sizeof sample / sizeof *sample };
    struct hf_depth d = {.size = sizeof d,
                         .type = (enum hf_depth_type)any_choice(b, 7),
                         .format = (enum hf_depth_format)any_choice(b, FORMATS)};
    d.data = any_plane(b, (unsigned)d.format < FORMATS ? sample[d.format] : 0, w, h, &d.stride, area);
    maybe(b, &d.near_plane);
    maybe(b, &d.far_plane);
    maybe(b, &d.focal_px);
    return d;
}

// ---- what the API got later, drawn last: stored inputs keep their meaning, and zeros change nothing

// True if a byte is above the usual values of a calm input.
static int now_and_then(struct bytes *b)
{
    return take_byte(b) > 200;
}

// Most of them between 0 and `most`.
static void sensible(struct bytes *b, float *field, float most)
{
    const unsigned kind = take_byte(b);
    if (kind > 230)
        *field = any_float(b);
    else if (kind > 180)
        *field = most * (float)take_byte(b) / 255;
}

static void any_layers(struct bytes *b, struct hf_layers_params *p)
{
    const unsigned flags = take_byte(b);
    p->no_unmix = flags & 1;
    p->no_hidden = flags >> 1 & 1;
    p->no_highlights = flags >> 2 & 1;
    p->no_patterns = flags >> 3 & 1;
    p->quality = (enum hf_layers_quality)any_choice(b, 4);
    p->lens_points = flags >> 4 ? 0 : take_byte(b) % 194;
    sensible(b, &p->spacing, 32);
    sensible(b, &p->half_from, 16);
    sensible(b, &p->quarter_from, 64);
}

// The aperture's picture lies in *picture, its memory in areas.
static void any_more_params(struct bytes *b, struct hf_params *p, struct hf_image *picture, struct area areas[4])
{
    any_layers(b, &p->layers);
    p->chapter.downsample = (enum hf_downsample)any_choice(b, 3);
    p->chapter.division = (enum hf_division)any_choice(b, 4);
    p->gaussian.faithful = take_byte(b) & 1;
    if (now_and_then(b))
        p->gaussian.by_depth = scaled(any_choice(b, 4), 1, -1);
    if (now_and_then(b))
        p->focus = HF_DERIVE;
    if (now_and_then(b))
        sensible(b, &p->aperture.chromatic, 0.5f);
    if (now_and_then(b)) {
        sensible(b, &p->highlight.gain, 64);
        sensible(b, &p->highlight.threshold, 0.99f);
    }
    if (now_and_then(b)) {
        sensible(b, &p->view.pixel_aspect, 10);
        sensible(b, &p->aperture.squeeze, 4);
        sensible(b, &p->aperture.roundness, 1);
        sensible(b, &p->aperture.ring, 0.95f);
        sensible(b, &p->aperture.cat_eye, 1);
        sensible(b, &p->aperture.rotation, 720);
    }
    if (now_and_then(b)) {
        const int w = 1 + (int)take_byte(b) % 40, h = 1 + (int)take_byte(b) % 40;
        *picture = any_image(b, w, h, areas);
        p->aperture.picture = picture;
        if (take_byte(b) & 1)  // without another shape
            p->aperture.blades = 0, p->aperture.roundness = p->aperture.ring = p->aperture.cat_eye = 0;
    }
    if (now_and_then(b))  // the engines that draw most of it
        p->engine = take_byte(b) & 1 ? HF_ENGINE_SCATTER : HF_ENGINE_LAYERS;
}

static void any_more_depth(struct bytes *b, struct hf_depth *d)
{
    if (take_byte(b) % 8) {
        d->near_plane = 0.25f;
        d->far_plane = 100;
        d->focal_px = 50;
    }
    sensible(b, &d->center_x, 256);
    sensible(b, &d->center_y, 24);
    sensible(b, &d->near_plane, 1);
    sensible(b, &d->far_plane, 200);
}

// ---- a host

// The log gets one line, not empty, of printable characters.
static long errors_told;

static void check_sentence(const struct hf_message *m)
{
    const char *message = m->sentence;
    const size_t n = strlen(message);
    MUST(n > 10);
    for (size_t i = 0; i < n; i++)
        MUST((unsigned char)message[i] >= 32 && message[i] != 127);
    MUST(!strncmp(message, m->argument, strlen(m->argument)));
}

static void hear(void *cookie, const struct hf_message *m)
{
    (void)cookie;
    MUST(m->size == sizeof *m && m->level >= HF_LOG_ERROR && m->level <= HF_LOG_INFO);
    check_sentence(m);
    errors_told += m->level == HF_LOG_ERROR;
}

// A host with a single thread: it calls backwards, and alternates between worker numbers.
static void backwards(void *cookie, int n, void (*fn)(void *arg, int i, int worker), void *arg)
{
    const int workers = *(const int *)cookie;
    for (int i = n - 1; i >= 0; i--)
        fn(arg, i, i % workers);
}

static void look(void *cookie, const struct hf_inspect_buffer *m)
{
    (void)cookie;
    MUST(m->name && m->width > 0 && m->height > 0 && m->channels >= 1 && m->channels <= 4);
    for (int c = 0; c < m->channels; c++)
        for (int y = 0; y < m->height; y++) {
            const float *row = (const float *)((const char *)m->data[c] + y * m->stride);
            for (int x = 0; x < m->width; x++)
                MUST(isfinite(row[x]));
        }
}

// One of this processor's instruction sets; or always the one that HYPERFOCAL_ISA names.
static enum hf_isa any_isa(struct bytes *b)
{
    const unsigned first = take_byte(b);
    const char *named = getenv("HYPERFOCAL_ISA");
    if (named) {
        // With an unknown name every call would be refused, and nothing tested.
        int known = 0;
        for (int i = 0; i <= HF_ISA_NEON; i++)
            known |= hf_isa_available((enum hf_isa)i) && !strcmp(hf_isa_name((enum hf_isa)i), named);
        MUST(known);
        return HF_ISA_AUTO;
    }
    for (unsigned i = 0; i <= HF_ISA_NEON; i++) {
        const enum hf_isa isa = (enum hf_isa)((first + i) % (HF_ISA_NEON + 1));
        if (hf_isa_available(isa))
            return isa;
    }
    return HF_ISA_AUTO;
}

// ---- calls

// Counts of the calls' results, by -error.
static long became[7];

void fuzz_told(void)
{
    printf("%ld frames rendered, %ld refused, %ld out of memory, %ld without focus\n", became[0], became[-HF_ERR_ARG],
           became[-HF_ERR_MEMORY], became[-HF_ERR_FOCUS]);
}

// Check for NaN and infinity in formats that could hold them.
static int is_finite_image(const struct hf_image *m)
{
    const int floats = m->format == HF_FORMAT_RGBA32F     ? 4
                       : m->format == HF_FORMAT_RGB32F    ? 3
                       : m->format == HF_FORMAT_PLANAR32F ? 1
                                                          : 0,
              halves = m->format == HF_FORMAT_RGBA16F ? 4 : 0;
    int bad = 0;
    for (int i = 0; i < 4 && m->data[i]; i++)
        for (int y = 0; y < m->height; y++) {
            const char *row = (const char *)m->data[i] + y * m->stride[i];
            for (int x = 0; x < m->width * floats; x++) {
                float v;
                memcpy(&v, row + sizeof v * (size_t)x, sizeof v);
                bad += !isfinite(v);
            }
            for (int x = 0; x < m->width * halves; x++) {
                uint16_t v;
                memcpy(&v, row + sizeof v * (size_t)x, sizeof v);
                bad += (v & 0x7c00) == 0x7c00;
            }
        }
    return !bad;
}

struct frame {
    struct hf_image dst, src, picture;
    struct hf_depth depth;
    struct hf_params p;
    struct area areas[16];  // 4 of src, 1 of depth, 4 of the aperture's picture, 4 of dst
};

// Functions that take only numbers, or one sample.
static void ask(struct bytes *b, struct frame *f)
{
    const int w = f->src.width, h = f->src.height;
    struct hf_message message = {.size = sizeof message};
    struct hf_params filled = {.size = sizeof filled};
    struct hf_resolved r = {.size = sizeof r};
    take_byte(b);
    const int err = hf_resolve(w, h, &f->depth, &f->p, &filled, &r, &message);
    MUST(err == HF_OK || err == HF_ERR_ARG || err == HF_ERR_FOCUS);
    MUST(message.error == err);
    if (err)
        check_sentence(&message);
    MUST(err || (r.width == w && r.height == h && filled.max_radius >= 0 && filled.max_radius <= 2048));
    float z = 1;
    const int x = any_choice(b, 256), y = any_choice(b, 24);
    const int read = hf_depth_at(&f->depth, w, h, x, y, &z, NULL);
    MUST(read == HF_ERR_ARG || (x >= 0 && y >= 0 && x < w && y < h));
    MUST(read || z > 0);
    struct tool_choice choice;
    struct hf_params p = f->p;
    if (now_and_then(b) && !tool_choose(h, &f->depth, &p, (enum hf_quality)any_choice(b, 4), 0, &choice))
        MUST(choice.inner.step >= 0 && choice.inner.step < choice.inner.steps && choice.inner.options);
    if (now_and_then(b)) {
        const float error = any_float(b);
        if (error != 0 && !tool_choose(h, &f->depth, &p, HF_QUALITY_DRAFT, error, &choice))
            MUST(choice.inner.step >= 0 && choice.inner.step < choice.inner.steps && choice.inner.options);
    }
    if (now_and_then(b))
        f->p = p;
}

static void check_report(struct hf_context *c, int w, int h, int err)
{
    struct tool_report report;
    tool_report_get(c, &report);
    // A plain copy reads no depth.
    const uint64_t n = (uint64_t)w * (uint64_t)h,
                   counted = report.all.near_pixels + report.all.sharp_pixels + report.all.far_pixels;
    MUST(err || counted == 0 || counted == n);
    uint8_t tiles[64];
    const size_t count = hf_inspect_tiles(c, tiles, sizeof tiles);
    MUST(count == (size_t)report.inner.columns * (size_t)report.inner.rows);
    for (size_t i = 0; i < count && i < sizeof tiles; i++)
        MUST(tiles[i] <= HF_TILE_BOTH);
    MUST(report.inner.passes >= 0 && report.inner.passes <= TOOL_PASSES);
}

static void render(struct hf_context *c, struct bytes *b, struct frame *f, int in_place)
{
    struct hf_report report = {.size = sizeof report};
    struct hf_resolved r = {.size = sizeof r};
    const uint64_t before = hash_of(in_place ? f->areas + 4 : f->areas, in_place ? 5 : 9);
    const int planned = hf_plan(c, &f->dst, &f->src, &f->depth, &f->p, &report);
    const int prepared = now_and_then(b) ? hf_prepare(c, &f->dst, &f->src, &f->depth, &f->p) : planned;
    hf_inspect_dump(c, fresh ? NULL : look, NULL);
    const long told = errors_told;
    const int err = hf_render(c, &f->dst, &f->src, &f->depth, &f->p);
    MUST(err == HF_OK || err == HF_ERR_ARG || err == HF_ERR_MEMORY || err == HF_ERR_FOCUS);
    MUST((planned == HF_ERR_ARG) == (err == HF_ERR_ARG) && (prepared == HF_ERR_ARG) == (err == HF_ERR_ARG));
    MUST(errors_told == told + (err != 0));
    MUST(before == hash_of(in_place ? f->areas + 4 : f->areas, in_place ? 5 : 9));
    MUST(err || hf_resolve(f->src.width, f->src.height, &f->depth, &f->p, NULL, &r, NULL) || r.sharp ||
         is_finite_image(&f->dst));
    became[-err]++;
    check_report(c, f->src.width, f->src.height, err);
}

static void one_frame(struct hf_context *c, struct bytes *b, unsigned how)
{
    struct frame f = {0};
    const unsigned most = fuzz_small ? 24 : 256;
    const int w = any_size(b, how & 32 ? 24 : most), h = any_size(b, how & 32 ? most : 24);
    f.src = any_image(b, w, h, f.areas);
    f.dst = how & 64 ? f.src : any_image(b, take_byte(b) == 255 ? w + 1 : w, h, f.areas + 9);
    f.depth = any_depth(b, w, h, &f.areas[4]);
    f.p = any_params(b);
    any_more_params(b, &f.p, &f.picture, f.areas + 5);
    any_more_depth(b, &f.depth);
    ask(b, &f);
    render(c, b, &f, how >> 6 & 1);
    for (size_t i = 0; i < sizeof f.areas / sizeof *f.areas; i++)
        free_block(f.areas[i].start);
}

// ---- structs of other sizes, as programs of other releases give them

// A struct in a block of its own size: mostly larger than the library's, with the right contents (NULL: none) and zeros, or
// other bytes, behind. A size that no release can have lies in a block that holds nothing but the size.
static void *any_sized(struct bytes *b, const void *right, size_t own)
{
    enum { MOST = 65536 };
    const unsigned kind = take_byte(b);
    size_t size = own;
    if (kind < 140)
        size = own + take_byte(b);
    else if (kind < 170)
        size = take_byte(b) * 2;
    else if (kind < 200)
        size = take_word(b) % (MOST + 1000);
    else if (kind < 220)
        size = (size_t)take_word(b) << 32 | take_word(b);
    const size_t bytes = size > MOST || size < sizeof size ? sizeof size : size;
    char *p = block_of(bytes, sizeof size);
    MUST(p != NULL);
    memset(p, now_and_then(b), bytes);
    if (right)
        memcpy(p, right, bytes < own ? bytes : own);
    memcpy(p, &size, sizeof size);
    return p;
}

// The size of the first release must do for what the library fills, and so must larger ones.
static void filled(void *p, size_t first, int err)
{
    const size_t size = *(const size_t *)p;
    MUST(err == (size >= first && size <= 65536 ? HF_OK : HF_ERR_ARG));
    free_block(p);
}

static void fill_any_sizes(struct hf_context *c, struct bytes *b)
{
    struct hf_params params = hf_default_params();
    struct hf_report *report = any_sized(b, NULL, sizeof *report);
    filled(report, offsetof(struct hf_report, guessed), hf_get_report(c, report));
    struct hf_params *used = any_sized(b, NULL, sizeof *used);
    filled(used, sizeof *used, hf_get_used(c, used, NULL));
    struct hf_resolved *resolved = any_sized(b, NULL, sizeof *resolved);
    filled(resolved, sizeof *resolved, hf_get_used(c, NULL, resolved));
    struct hf_choice *choice = any_sized(b, NULL, sizeof *choice);
    filled(choice, sizeof *choice, hf_choose_quality(16, NULL, &params, HF_QUALITY_BEST, choice, NULL));
    struct hf_message *message = any_sized(b, NULL, sizeof *message);
    filled(message, sizeof *message, hf_get_problem(c, message));
}

static void give_any_sizes(struct bytes *b)
{
    const struct hf_params right_params = hf_default_params();
    const struct hf_depth right_depth = {.size = sizeof right_depth, .type = HF_DEPTH_COC};
    const struct hf_config right_config = {
        .size = sizeof right_config, .threads = 1, .alloc = take, .free = give, .log = hear};
    struct hf_message message = {.size = sizeof message};
    struct hf_params *params = any_sized(b, &right_params, sizeof *params);
    struct hf_depth *depth = any_sized(b, &right_depth, sizeof *depth);
    struct hf_config *config = any_sized(b, &right_config, sizeof *config);
    const int err = hf_resolve(16, 16, depth, params, NULL, NULL, &message);
    MUST((err == HF_OK || err == HF_ERR_ARG) && message.error == err);
    if (err)
        check_sentence(&message);
    struct hf_context *c = NULL;
    const int opened = hf_open(&c, config);
    MUST(opened == HF_OK || opened == HF_ERR_ARG || opened == HF_ERR_MEMORY);
    MUST(!opened == (c != NULL));
    hf_close(&c);
    free_block(params);
    free_block(depth);
    free_block(config);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct bytes b = {data, size};
    const unsigned how = take_byte(&b);
    int workers = 1 + (how & 1);
    struct hf_config config = {.size = sizeof config,
                               .threads = workers,
                               .isa = any_isa(&b),
                               .alloc = take,
                               .free = give,
                               .log = hear,
                               .parallel_cookie = &workers};
    if (how & 4) {
        config.tile_width = scaled(any_choice(&b, 6), 16, 16);
        config.tile_height = scaled(any_choice(&b, 40), 1, 16);
    }
    if (how & 2)
        config.parallel_for = backwards;
    live = calls = 0;
    fresh = how & 128 ? 0 : 0xff;
    const unsigned fails = how & 8 ? take_byte(&b) : 0;
    fails_at = how & 8 ? (long)(fails % 64) : LONG_MAX;
    fails_to = how & 8 && fails < 192 ? fails_at + 1 : LONG_MAX;
    struct hf_context *c = NULL;
    const int opened = hf_open(&c, &config);
    MUST(!opened == (c != NULL));
    for (int frame = 0; c && frame < 1 + (int)(how >> 4 & 1); frame++)
        one_frame(c, &b, how);
    if (c && now_and_then(&b))
        fill_any_sizes(c, &b);
    if (now_and_then(&b))
        give_any_sizes(&b);
    hf_close(&c);
    MUST(live == 0);
    return 0;
}
