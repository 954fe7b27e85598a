// SPDX-License-Identifier: BSD-3-Clause
// One frame in two sweeps over the full-resolution data. The first makes CoC and the half-resolution buffers, chunk
// by chunk, and notes what each chunk contains; the second takes each tile through all other passes while its buffers
// are in the cache.
#include <string.h>
#include <time.h>

#include "context.h"
#include "plan.h"
#include "repair.h"

struct job {
    struct hf_context *c;
    const struct hf_setup *s;
    struct hf_plan plan;
    int in_place;
    int raw_copy;      // a sharp pixel's bits may be copied as they are
};

static int64_t now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * INT64_C(1000000000) + t.tv_nsec;
}

// fn(arg, i, worker) for i in [0, n), on the pool or on the host's threads.
static void parallel(struct hf_context *c, int n, void (*fn)(void *arg, int i, int worker), void *arg)
{
    if (n == 1)
        fn(arg, 0, 0);
    else if (c->pool)
        hf_pool_run(c->pool, n, fn, arg);
    else
        c->config.parallel_for(c->config.parallel_cookie, n, fn, arg);
}

static struct hf_rect grow(struct hf_rect r, struct hf_reach by)
{
    return (struct hf_rect){r.x0 - by.x, r.y0 - by.y, r.x1 + by.x, r.y1 + by.y};
}

static struct hf_rect inside_frame(struct hf_rect r, const struct hf_setup *s)
{
    return (struct hf_rect){hf_max(r.x0, 0), hf_max(r.y0, 0), hf_min(r.x1, s->half_width),
                            hf_min(r.y1, s->half_height)};
}

// Channels of a buffer; 0: not wanted with these options.
static int buf_channels(const struct hf_setup *s, int b)
{
    switch (b) {
    case HF_BUF_COC:
        return 4;
    case HF_BUF_COC4:
    case HF_BUF_SUM:
        return 2;
    case HF_BUF_MAX_X:
    case HF_BUF_MAX:
    case HF_BUF_BLUR_X:
    case HF_BUF_BLUR:
        return 1;
    case HF_BUF_WEIGHT:
        return s->karis ? 2 : 0;
    case HF_BUF_COLORW4:
    case HF_BUF_COLORFARW4:
        return s->karis ? s->channels : 0;
    default:
        return s->channels;
    }
}

static int is_frame_buf(int b)
{
    return b == HF_BUF_COLOR4 || b == HF_BUF_COLORFAR4 || b == HF_BUF_COC4;
}

// A buffer's window: size and where its first pixel lies relative to the area it surrounds.
struct window {
    int stride, rows, left, top;
};

static struct window window_of(const struct hf_plan *p, int b, int width, int height)
{
    struct window w = {.left = (p->buf[b].x + 15) & ~15, .top = p->buf[b].y};
    w.stride = ((width + 15) & ~15) + 2 * w.left + HF_PAD;
    if (w.stride % 1024 == 0)
        w.stride += 16;  // rows 4 KB apart would share cache sets
    w.rows = height + 2 * w.top;
    return w;
}

static size_t window_floats(struct window w)
{
    return (size_t)w.stride * w.rows;
}

// Point the channels of a buffer into memory, for an area that starts at (x0, y0). Returns what comes after it.
static float *place(struct hf_buf *buf, struct window w, int channels, float *memory, int x0, int y0)
{
    buf->stride = w.stride;
    for (int c = 0; c < channels; c++) {
        buf->ch[c] = memory + (ptrdiff_t)w.stride * (w.top - y0) + w.left - x0;
        memory += window_floats(w);
    }
    return memory;
}

// Window of a worker's buffer; HF_BUF_COC holds a chunk's full-resolution rows, the others a tile and its reach.
static struct window scratch_window(const struct job *j, int b)
{
    const struct hf_plan *p = &j->plan;
    return b == HF_BUF_COC ? window_of(p, b, p->chunk_width, 2 * p->chunk_height)
                           : window_of(p, b, p->tile_width, p->tile_height);
}

// A scratch row holds what a pass may read of a tile's row: the widest window there is.
static size_t line_floats(const struct job *j)
{
    int reach = 0;
    for (int b = 0; b < HF_BUF_COUNT; b++)
        reach = hf_max(reach, j->plan.buf[b].x);
    return (size_t)((j->plan.tile_width + 2 * reach + 15) & ~15) + 2 * HF_PAD;
}

// What the kernels need for strips of up to 80 columns: terms and pairs of the gather, rows of the near max and partial
// sums of the near blur; and three rows for the mean fill.
static size_t work_floats(const struct job *j)
{
    const struct hf_taps *t = j->s->taps;
    const size_t rows = 2 * (size_t)t->ry + 1, columns = 2 * (size_t)t->rx + 1;
    const size_t gather = 2 * rows * columns + 16 + columns * 80;
    const size_t near = 12 * ((size_t)j->plan.tile_height + 2 * (size_t)j->plan.buf[HF_BUF_MAX_X].y + 64) * 64;
    const size_t most = gather > near ? gather : near, fill = 3 * line_floats(j);
    return most > fill ? most : fill;
}

static int allocate(struct job *j)
{
    struct hf_context *c = j->c;
    const struct hf_setup *s = j->s;
    size_t frame = 0, scratch = HF_LINES * line_floats(j) + work_floats(j);
    for (int b = 0; b < HF_BUF_COUNT; b++) {
        if (is_frame_buf(b))
            frame += buf_channels(s, b) * window_floats(window_of(&j->plan, b, s->half_width, s->half_height));
        else
            scratch += buf_channels(s, b) * window_floats(scratch_window(j, b));
    }
    int err = hf_block_grow(&c->planes, frame * sizeof(float), &c->mem);
    if (!err)
        err = hf_block_grow(&c->tiles, hf_plan_bytes(&j->plan), &c->mem);
    for (int i = 0; i < c->threads && !err; i++)
        err = hf_block_grow(&c->workers[i].scratch, scratch * sizeof(float), &c->mem);
    if (err)
        return err;
    hf_plan_memory(&j->plan, c->tiles.data);
    float *memory = c->planes.data;
    struct hf_buf planes[HF_BUF_COUNT] = {0};
    for (int b = 0; b < HF_BUF_COUNT; b++)
        if (is_frame_buf(b))
            memory = place(&planes[b], window_of(&j->plan, b, s->half_width, s->half_height), buf_channels(s, b),
                           memory, 0, 0);
    for (int i = 0; i < c->threads; i++) {
        struct hf_frame *f = &c->workers[i].frame;
        memcpy(f->buf, planes, sizeof planes);
        f->line_floats = line_floats(j);
        f->lines = c->workers[i].scratch.data;
        f->work = f->lines + HF_LINES * f->line_floats;
    }
    return HF_OK;
}

// Point a worker's buffers at an area of the frame.
static void place_scratch(const struct job *j, struct hf_frame *f, int x0, int y0)
{
    float *memory = f->work + work_floats(j);
    for (int b = 0; b < HF_BUF_COUNT; b++)
        if (!is_frame_buf(b))
            memory = place(&f->buf[b], scratch_window(j, b), buf_channels(j->s, b), memory, x0,
                           b == HF_BUF_COC ? 2 * y0 : y0);
}

// All sampling clamps to the edge: repeat the border of `have` outwards up to `want`.
static void extend(const struct hf_buf *b, int channels, struct hf_rect have, struct hf_rect want)
{
    for (int c = 0; c < channels; c++) {
        for (int y = have.y0; y < have.y1; y++) {
            float *row = hf_at(b, c, 0, y);
            for (int x = want.x0; x < have.x0; x++)
                row[x] = row[have.x0];
            for (int x = have.x1; x < want.x1; x++)
                row[x] = row[have.x1 - 1];
        }
        const size_t bytes = (size_t)(want.x1 - want.x0) * sizeof(float);
        for (int y = want.y0; y < have.y0; y++)
            memcpy(hf_at(b, c, want.x0, y), hf_at(b, c, want.x0, have.y0), bytes);
        for (int y = have.y1; y < want.y1; y++)
            memcpy(hf_at(b, c, want.x0, y), hf_at(b, c, want.x0, have.y1 - 1), bytes);
    }
}

static void run_pass(struct hf_worker *w, enum hf_pass_id pass, struct hf_rect r, int64_t *clock)
{
    w->frame.k->pass[pass](&w->frame, r);
    w->tiles[pass]++;
    const int64_t now = now_ns();
    w->ns[pass] += now - *clock;
    *clock = now;
}

// The half-resolution buffers of a chunk, and of the border beside it where it lies at the frame's edge.
static void downsample(const struct job *j, struct hf_worker *w, struct hf_rect r, int64_t *clock)
{
    const struct hf_setup *s = j->s;
    w->frame.k->pass[HF_PASS_DOWN](&w->frame, r);
    for (int b = 0; b < HF_BUF_COUNT; b++) {
        if (!is_frame_buf(b))
            continue;
        const struct hf_reach reach = j->plan.buf[b];
        extend(&w->frame.buf[b], buf_channels(s, b), r,
               (struct hf_rect){r.x0 == 0 ? -reach.x : r.x0, r.y0 == 0 ? -reach.y : r.y0,
                                r.x1 == s->half_width ? r.x1 + reach.x : r.x1,
                                r.y1 == s->half_height ? r.y1 + reach.y : r.y1});
    }
    w->tiles[HF_PASS_DOWN]++;
    const int64_t now = now_ns();
    w->ns[HF_PASS_DOWN] += now - *clock;
    *clock = now;
}

// First byte of the pixels of a rectangle's row in one plane.
static uint8_t *pixels_at(const struct hf_image *m, int plane, int x, int y)
{
    return (uint8_t *)m->data[plane] + (ptrdiff_t)y * m->stride[plane] + hf_row_bytes(m->format, x);
}

static int row_finite(const struct hf_frame *f, int x, int y, int n)
{
    const struct hf_image *m = f->src;
    hf_finite *finite = m->format == HF_FORMAT_RGBA16F      ? f->k->finite_f16
                        : m->format == HF_FORMAT_R11G11B10F ? f->k->finite_r11
                                                            : f->k->finite_f32;
    const size_t words = hf_row_bytes(m->format, n) / (m->format == HF_FORMAT_RGBA16F ? 2 : 4);
    for (int p = 0; p < hf_plane_count(m); p++)
        if (!finite(pixels_at(m, p, x, y), words))
            return 0;
    return 1;
}

static void scan_finite(struct hf_worker *w, struct hf_rect r)
{
    const struct hf_setup *s = w->frame.s;
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, s->height); y++)
        w->seen.colour_repaired += !row_finite(&w->frame, 2 * r.x0, y, hf_min(2 * r.x1, s->width) - 2 * r.x0);
}

static void first_sweep(void *arg, int i, int worker)
{
    struct job *j = arg;
    struct hf_worker *w = &j->c->workers[worker];
    const struct hf_rect r = hf_plan_chunk(&j->plan, j->s, i);
    int64_t clock = now_ns();
    const struct hf_counts before = w->counts;
    place_scratch(j, &w->frame, r.x0, r.y0);
    run_pass(w, HF_PASS_COC, r, &clock);
    const int found = (w->counts.near_pixels > before.near_pixels ? HF_NEAR : 0) |
                      (w->counts.far_pixels > before.far_pixels ? HF_FAR : 0);
    j->plan.chunk_found[i] = (uint8_t)found;
    j->plan.chunk_deferred[i] = !found && !j->s->no_skip;
    if (!j->plan.chunk_deferred[i])
        downsample(j, w, r, &clock);
    else if (j->in_place)
        scan_finite(w, r);
}

// A chunk without CoC that a neighbour's tile reads after all.
static void first_sweep_deferred(void *arg, int i, int worker)
{
    struct job *j = arg;
    struct hf_worker *w = &j->c->workers[worker];
    const struct hf_rect r = hf_plan_chunk(&j->plan, j->s, j->plan.deferred[i]);
    int64_t clock = now_ns();
    place_scratch(j, &w->frame, r.x0, r.y0);
    const struct hf_buf *coc = &w->frame.buf[HF_BUF_COC];
    for (int ch = 0; ch < 4; ch++)
        for (int y = 2 * r.y0; y < 2 * r.y1; y++)
            memset(hf_at(coc, ch, r.x0, y), 0, (size_t)(r.x1 - r.x0) * sizeof(float));
    downsample(j, w, r, &clock);
}

// Copy a rectangle that is sharp, non-finite samples repaired.
static void copy_sharp(const struct job *j, struct hf_worker *w, struct hf_rect r)
{
    const struct hf_frame *f = &w->frame;
    const int x = 2 * r.x0, n = hf_min(2 * r.x1, j->s->width) - x;
    float *even[4], *odd[4];
    for (int c = 0; c < 4; c++) {
        even[c] = hf_line(f, c);
        odd[c] = hf_line(f, 4 + c);
    }
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, j->s->height); y++) {
        if (j->raw_copy && j->in_place)
            continue;  // checked, and repaired if need be, after the first sweep
        if (j->raw_copy && row_finite(f, x, y, n)) {
            for (int p = 0; p < hf_plane_count(f->src); p++)
                memcpy(pixels_at(f->dst, p, x, y), pixels_at(f->src, p, x, y), hf_row_bytes(f->src->format, n));
            continue;
        }
        float *const *alpha = hf_image_channels(f->src) == 4 ? even : NULL;
        hf_read_colour(f, r.x0, y, r.x1 - r.x0, even, odd, &w->counts);
        const float *const e[4] = {even[0], even[1], even[2], alpha ? even[3] : NULL};
        const float *const o[4] = {odd[0], odd[1], odd[2], alpha ? odd[3] : NULL};
        w->counts.clamped += f->k->store[f->dst->format](f->dst, r.x0, y, r.x1 - r.x0, e, o);
    }
}

static void second_sweep(void *arg, int i, int worker)
{
    struct job *j = arg;
    struct hf_worker *w = &j->c->workers[worker];
    const struct hf_rect tile = hf_plan_tile(&j->plan, j->s, i);
    const int needs = j->s->blend == 0 ? 0 : j->plan.tile_needs[i];
    int64_t clock = now_ns();
    if (!needs) {
        copy_sharp(j, w, tile);
        w->ns[HF_PASS_COMPOSITE] += now_ns() - clock;
        return;
    }
    place_scratch(j, &w->frame, tile.x0, tile.y0);
    w->frame.near = needs & HF_NEAR;
    w->frame.far = needs & HF_FAR;
    for (int p = 0; p < HF_PASS_COUNT; p++) {
        const int near_only = p >= HF_PASS_MAX_X && p <= HF_PASS_BLUR_Y;
        if (hf_passes[p].sweep != 2 || (near_only && !w->frame.near))
            continue;
        const struct hf_rect r = inside_frame(grow(tile, j->plan.pass[p]), j->s);
        w->frame.k->pass[p](&w->frame, r);
        for (int b = 0; b < HF_BUF_COUNT; b++)
            if (hf_passes[p].writes >> b & 1)
                extend(&w->frame.buf[b], buf_channels(j->s, b), r, grow(tile, j->plan.buf[b]));
        w->tiles[p]++;
        const int64_t now = now_ns();
        w->ns[p] += now - clock;
        clock = now;
    }
}

// In place, a tile overwrites what its neighbours' repairs are made from: write all repairs first.
static int repair_in_place(struct job *j)
{
    struct hf_context *c = j->c;
    const struct hf_image *m = c->workers[0].frame.src;
    const struct hf_rect all = {0, 0, m->width, m->height};
    const size_t n = hf_repair_list(m, all, NULL, 0);
    const int err = hf_block_grow(&c->repairs, n * sizeof(struct hf_repair), &c->mem);
    if (err)
        return err;
    struct hf_repair *list = c->repairs.data;
    hf_repair_list(m, all, list, n);
    for (size_t i = 0; i < n; i++)
        hf_put_sample(m, list[i].channel, list[i].x, list[i].y, list[i].value);
    c->workers[0].counts.colour_repaired += n;
    return HF_OK;
}

static void scan_tile(void *arg, int i, int worker)
{
    struct job *j = arg;
    scan_finite(&j->c->workers[worker], hf_plan_tile(&j->plan, j->s, i));
}

static int seen_bad(const struct hf_context *c)
{
    uint64_t n = 0;
    for (int i = 0; i < c->threads; i++)
        n += c->workers[i].seen.colour_repaired;
    return n != 0;
}

static void collect_stats(const struct job *j, int64_t start)
{
    struct hf_context *c = j->c;
    struct hf_stats *t = &c->stats;
    *t = (struct hf_stats){.max_radius = j->s->max_radius};
    t->memory = sizeof *c + c->planes.size + c->tiles.size + c->joined.size + c->repairs.size + c->taps.block.size +
                (c->pool ? hf_pool_bytes(c->threads) : 0);
    for (int i = 0; i < c->threads; i++) {
        const struct hf_worker *w = &c->workers[i];
        for (int p = 0; p < HF_PASS_COUNT; p++) {
            t->pass_ms[p] += (double)w->ns[p] * 1e-6 / c->threads;
            t->tiles_run[p] += w->tiles[p];
        }
        t->near_pixels += w->counts.near_pixels;
        t->far_pixels += w->counts.far_pixels;
        t->sharp_pixels += w->counts.sharp_pixels;
        t->colour_repaired += w->counts.colour_repaired;
        t->depth_repaired += w->counts.depth_repaired;
        t->no_surface += w->counts.no_surface;
        t->clamped += w->counts.clamped;
        t->memory += w->scratch.size + sizeof *w;
    }
    for (int p = 0; p < HF_PASS_COUNT; p++)
        t->tiles_all[p] = (uint32_t)(hf_passes[p].sweep == 1 ? j->plan.chunks_x * j->plan.chunks_y
                                                             : j->plan.tiles_x * j->plan.tiles_y);
    if (j->s->blend == 0)
        t->sharp_pixels = (uint64_t)j->s->width * j->s->height;
    t->total_ms = (double)(now_ns() - start) * 1e-6;
}

// The CoC buffer holds even and odd pixels apart: put them side by side.
static int join_coc(const struct job *j, struct hf_buffer *out)
{
    struct hf_context *c = j->c;
    const struct hf_buf *b = &c->workers[0].frame.buf[HF_BUF_COC];
    const int width = j->s->width, height = j->s->height;
    const int err = hf_block_grow(&c->joined, 2 * (size_t)width * height * sizeof(float), &c->mem);
    if (err)
        return err;
    float *p = c->joined.data;
    for (int ch = 0; ch < 2; ch++) {
        out->data[ch] = p;
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++)
                *p++ = *hf_at(b, 2 * ch + (x & 1), x / 2, y);
    }
    out->width = width;
    out->height = height;
    out->channels = 2;
    out->stride = width * (ptrdiff_t)sizeof(float);
    return HF_OK;
}

static int dump_buffers(const struct job *j)
{
    static const char *const names[HF_BUF_COUNT] = {
        [HF_BUF_COC] = "coc", [HF_BUF_COLOR4] = "color4", [HF_BUF_COLORFAR4] = "colormulcoc4",
        [HF_BUF_COC4] = "coc4", [HF_BUF_MAX_X] = "cocmaxx", [HF_BUF_MAX] = "cocmax", [HF_BUF_BLUR_X] = "cocblurx",
        [HF_BUF_BLUR] = "cocblur", [HF_BUF_NEAR] = "near", [HF_BUF_FAR] = "far", [HF_BUF_NEAR_FILL] = "nearfill",
        [HF_BUF_FAR_FILL] = "farfill"};
    struct hf_context *c = j->c;
    const struct hf_frame *f = &c->workers[0].frame;
    for (int b = 0; b < HF_BUF_COUNT; b++) {
        if (!names[b])
            continue;
        struct hf_buffer out = {.name = names[b], .width = j->s->half_width, .height = j->s->half_height,
                                .channels = buf_channels(j->s, b),
                                .stride = f->buf[b].stride * (ptrdiff_t)sizeof(float)};
        for (int ch = 0; ch < out.channels; ch++)
            out.data[ch] = f->buf[b].ch[ch];
        const int err = b == HF_BUF_COC ? join_coc(j, &out) : HF_OK;
        if (err)
            return err;
        c->dump(c->dump_cookie, &out);
    }
    return HF_OK;
}

static void start_workers(const struct job *j, const struct hf_image *dst, const struct hf_image *src,
                          const struct hf_depth *depth, int fused)
{
    struct hf_context *c = j->c;
    for (int i = 0; i < c->threads; i++) {
        struct hf_worker *w = &c->workers[i];
        memset(&w->counts, 0, sizeof w->counts);
        memset(&w->seen, 0, sizeof w->seen);
        memset(w->ns, 0, sizeof w->ns);
        memset(w->tiles, 0, sizeof w->tiles);
        w->frame.s = j->s;
        w->frame.k = fused ? &c->fused : &c->exact;
        w->frame.src = src;
        w->frame.dst = dst;
        w->frame.depth = depth;
        w->frame.counts = &w->counts;
        w->frame.seen = &w->seen;
    }
}

int hf_render_frame(struct hf_context *c, const struct hf_setup *s, const struct hf_image *dst,
                    const struct hf_image *src, const struct hf_depth *depth, int fused)
{
    const int64_t start = now_ns();
    struct job j = {.c = c, .s = s};
    j.in_place = dst->data[0] == src->data[0];
    j.raw_copy = dst->format == src->format && hf_image_channels(dst) == hf_image_channels(src) &&
                 (s->blend == 0 || s->storage == HF_STORAGE_FLOAT || src->format == HF_FORMAT_R11G11B10F ||
                  (s->storage == HF_STORAGE_HALF && src->format == HF_FORMAT_RGBA16F));
    start_workers(&j, dst, src, depth, fused);
    hf_plan_layout(&j.plan, s, c->config.tile_width, c->config.tile_height, c->threads, c->dump != NULL);
    int err = allocate(&j);
    if (err)
        return err;
    if (s->blend == 0) {
        if (j.in_place)
            parallel(c, j.plan.tiles_x * j.plan.tiles_y, scan_tile, &j);
    } else {
        parallel(c, j.plan.chunks_x * j.plan.chunks_y, first_sweep, &j);
        hf_plan_classify(&j.plan, s);
        if (j.plan.deferred_count)
            parallel(c, j.plan.deferred_count, first_sweep_deferred, &j);
    }
    if (j.in_place && seen_bad(c) && (err = repair_in_place(&j)))
        return err;
    parallel(c, j.plan.tiles_x * j.plan.tiles_y, second_sweep, &j);
    collect_stats(&j, start);
    return c->dump && s->blend != 0 ? dump_buffers(&j) : HF_OK;
}
