// SPDX-License-Identifier: BSD-3-Clause
#include "frame/plan.h"

#include <string.h>

// The sizes that were fastest on two cores. Large tiles compute few pixels twice at their rims and read memory in long
// runs; smaller ones stay in the cache and skip more. With more threads, tiles are halved until each thread has a few.
// Chunks are wide, also for long runs, and low enough for their CoC to stay in the cache: 256 KB at 1024 x 8.
enum { TILE_HEIGHT = 96, MIN_WIDTH = 64, MIN_HEIGHT = 24, TILES_A_THREAD = 4 };
// The cells that an engine wants are cut if there are fewer than this for each thread. Strips are cells of whole rows.
enum { CELLS_A_THREAD = 3, MIN_STRIP = 16 };
enum { CHUNK_WIDTH = 1024, CHUNK_HEIGHT = 8 };

static int ceil_div(int a, int b)
{
    return (a + b - 1) / b;
}

static struct hf_reach reach_max(struct hf_reach a, struct hf_reach b)
{
    return (struct hf_reach){hf_max(a.x, b.x), hf_max(a.y, b.y)};
}

int hf_plan_is_tiled(const struct hf_plan *p, int sweep)
{
    return sweep > 1 && !(p->engine->plan.across >> sweep & 1) && p->columns[sweep] == p->columns[2] &&
           p->rows[sweep] == p->rows[2];
}

static struct hf_reach spread_of(const struct hf_plan *p, const struct hf_setup *s, unsigned field)
{
    return p->engine->plan.spread ? p->engine->plan.spread(s, &p->cells, field) : (struct hf_reach){0, 0};
}

// The fields of the first sweep's buffers that are read for these needs.
static unsigned reads_of(const struct hf_plan *p, const struct hf_setup *s, unsigned needs)
{
    return !needs ? 0 : p->engine->plan.reads ? p->engine->plan.reads(s, needs) : HF_FIELDS;
}

int hf_plan_pass_runs(const struct hf_plan *p, const struct hf_setup *s, int pass)
{
    return !p->engine->plan.runs || p->engine->plan.runs(s, pass);
}

int hf_plan_sweep_runs(const struct hf_plan *p, const struct hf_setup *s, int sweep)
{
    for (int i = 0; i < p->engine->pass_count; i++)
        if (p->engine->passes[i].sweep == sweep && hf_plan_pass_runs(p, s, i))
            return 1;
    return 0;
}

// Walk the passes backwards from the output, and find how far around a cell each buffer is read.
static void find_reaches(struct hf_plan *p, const struct hf_setup *s)
{
    const struct hf_engine_def *e = p->engine;
    memset(p->cells.buf, 0, sizeof p->cells.buf);
    for (int i = e->pass_count - 1; i >= 0; i--) {
        const struct hf_pass *pass = &e->passes[i];
        const struct hf_reach halo = pass->halo ? e->plan.halo(s, pass->halo) : (struct hf_reach){0, 0};
        struct hf_reach out = {0, 0};
        // A buffer of the whole frame is made once, without rims.
        for (int b = 0; b < e->buf_count; b++)
            if (pass->writes >> b & 1 && !e->bufs[b].frame)
                out = reach_max(out, p->cells.buf[b]);
        p->cells.pass[i] = out;
        const struct hf_reach around = {out.x + halo.x, out.y + halo.y};
        for (int b = 0; b < e->buf_count; b++) {
            if (pass->reads >> b & 1)
                p->cells.buf[b] = reach_max(p->cells.buf[b], out);
            if (pass->around >> b & 1)
                p->cells.buf[b] = reach_max(p->cells.buf[b], around);
            if (pass->inside >> b & 1)
                p->cells.buf[b] = out;
            if (pass->weighed >> b & 1)
                p->cells.buf[b] = around;
        }
    }
}

// Tiles have the default size, or a smaller one with many threads. Widths are multiples of 16: kernels write whole
// vectors, and the last one of a cell must not reach into the next cell.
static void choose_tile(const struct hf_plan *p, int threads, int *width, int *height)
{
    *width = HF_CELL_WIDTH;
    *height = TILE_HEIGHT;
    while (ceil_div(p->width, *width) * ceil_div(p->height, *height) < TILES_A_THREAD * threads) {
        if (*width > 2 * *height && *width / 2 >= MIN_WIDTH)
            *width /= 2;
        else if (*height / 2 >= MIN_HEIGHT)
            *height /= 2;
        else
            break;
    }
}

// The height of cells, at most the given one, with which the thread that has most of them is done first. around: rows that a
// cell reads, or makes, beyond its own.
static int best_height(const struct hf_plan *p, int width, int height, int least, int step, int around, int threads)
{
    const int columns = ceil_div(p->width, width);
    int best = height;
    int64_t best_cost = INT64_MAX;
    for (int h = height; h >= hf_min(least, height); h -= step) {
        const int64_t cost = (int64_t)ceil_div(columns * ceil_div(p->height, h), threads) * (h + around);
        best = cost < best_cost ? h : best;
        best_cost = cost < best_cost ? cost : best_cost;
    }
    return best;
}

// Cut the cells of a sweep where threads would wait for others: of the second one, and of those whose cells are strips. Strips
// of a few rows are as high as their engine's vectors ask for.
static int cut_height(const struct hf_plan *p, const struct hf_setup *s, int sweep, int width, int height, int threads)
{
    const int strip =
        p->engine->plan.across >> sweep & 1 && width >= p->width && height < p->height && height > 2 * MIN_STRIP;
    const int grain = hf_max(p->engine->plan.grain, 8);
    if ((sweep != 2 && !strip) || ceil_div(p->width, width) * ceil_div(p->height, height) >= CELLS_A_THREAD * threads)
        return height;
    const int around = hf_max(spread_of(p, s, HF_NEAR).y, spread_of(p, s, HF_FAR).y);
    return best_height(p, width, ceil_div(hf_min(height, p->height), grain) * grain, strip ? MIN_STRIP : MIN_HEIGHT,
                       grain, around, threads);
}

// Set a sweep's cells: of this size, or of the frame's if that is smaller, because buffers are made for whole cells.
static void set_cells(struct hf_plan *p, int sweep, int width, int height, int whole)
{
    const int most = (p->width + 15) & ~15;
    p->cells.width[sweep] = whole ? most : hf_min(width, most);
    p->cells.height[sweep] = whole ? p->height : hf_min(height, p->height);
    p->columns[sweep] = ceil_div(p->width, p->cells.width[sweep]);
    p->rows[sweep] = ceil_div(p->height, p->cells.height[sweep]);
}

void hf_plan_chunks(struct hf_plan *p, const struct hf_engine_def *engine, const struct hf_setup *s, int tile_width,
                    int tile_height, int threads, int whole)
{
    int width = s->part ? 2 * MIN_WIDTH : CHUNK_WIDTH;
    p->engine = engine;
    p->part = s->part && !whole;
    p->no_skip = whole || s->resolved->params.run.no_skip;
    p->width = s->half_width;
    p->height = s->half_height;
    while (width > MIN_WIDTH &&
           ceil_div(p->width, width) * ceil_div(p->height, CHUNK_HEIGHT) < TILES_A_THREAD * threads)
        width /= 2;
    set_cells(p, 1, tile_width ? tile_width : width, tile_height ? hf_min(CHUNK_HEIGHT, tile_height) : CHUNK_HEIGHT,
              whole);
    p->cells.line_floats = 2 * (size_t)p->cells.width[1] + 2 * HF_PAD;
}

int hf_rect_meets(struct hf_rect a, struct hf_rect b)
{
    return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

struct hf_rect hf_rect_both(struct hf_rect a, struct hf_rect b)
{
    return (struct hf_rect){hf_max(a.x0, b.x0), hf_max(a.y0, b.y0), hf_min(a.x1, b.x1), hf_min(a.y1, b.y1)};
}

static struct hf_rect rect_around(struct hf_rect a, struct hf_rect b)
{
    return (struct hf_rect){hf_min(a.x0, b.x0), hf_min(a.y0, b.y0), hf_max(a.x1, b.x1), hf_max(a.y1, b.y1)};
}

// A rectangle of the frame grown to whole steps.
static struct hf_rect stepped(const struct hf_plan *p, struct hf_rect r, int width, int height)
{
    return (struct hf_rect){r.x0 / width * width, r.y0 / height * height,
                            hf_min(ceil_div(r.x1, width) * width, p->width),
                            hf_min(ceil_div(r.y1, height) * height, p->height)};
}

static struct hf_rect grown(const struct hf_plan *p, struct hf_rect r, struct hf_reach by)
{
    return (struct hf_rect){hf_max(r.x0 - by.x, 0), hf_max(r.y0 - by.y, 0), hf_min(r.x1 + by.x, p->width),
                            hf_min(r.y1 + by.y, p->height)};
}

static struct hf_rect half_region(const struct hf_setup *s)
{
    const struct hf_rect r = s->region;
    return (struct hf_rect){r.x0 / 2, r.y0 / 2, (r.x1 + 1) / 2, (r.y1 + 1) / 2};
}

struct hf_reach hf_plan_reach(const struct hf_plan *p, const struct hf_setup *s, int sweep)
{
    const struct hf_engine_def *e = p->engine;
    struct hf_reach reach = {0, 0};
    if (e->plan.around)
        return e->plan.around(s, sweep);
    for (int i = 0; i < e->pass_count; i++) {
        const struct hf_pass *pass = &e->passes[i];
        const struct hf_reach halo = pass->halo ? e->plan.halo(s, pass->halo) : (struct hf_reach){0, 0};
        if (pass->sweep == sweep && hf_plan_pass_runs(p, s, i))
            reach = reach_max(reach, (struct hf_reach){p->cells.pass[i].x + halo.x, p->cells.pass[i].y + halo.y});
    }
    return reach;
}

// From the region back to the first sweep: what each has to make for the next. Active parts of tiles are whole vectors and
// steps of four rows from the tile's corner.
static void find_areas(struct hf_plan *p, const struct hf_setup *s)
{
    const struct hf_engine_def *e = p->engine;
    const struct hf_rect all = {0, 0, p->width, p->height};
    struct hf_rect r = p->part ? grown(p, half_region(s), (struct hf_reach){0, 4}) : all;
    for (int sweep = e->sweeps; sweep > 1; sweep--) {
        const int whole = e->plan.across >> sweep & 1 && !(e->plan.parts >> sweep & 1);
        r = stepped(p, r, 16, 8);
        if (whole && hf_plan_sweep_runs(p, s, sweep))
            r = stepped(p, r, p->cells.width[sweep], p->cells.height[sweep]);
        p->area[sweep] = r;
        r = grown(p, r, hf_plan_reach(p, s, sweep));
    }
    p->area[1] = r;
    p->looked = all;
    if (p->part && !s->measured)
        p->looked = grown(p, stepped(p, half_region(s), p->cells.width[2], p->cells.height[2]),
                          reach_max(spread_of(p, s, HF_NEAR), spread_of(p, s, HF_FAR)));
}

void hf_plan_cells(struct hf_plan *p, const struct hf_setup *s, int tile_width, int tile_height, int threads, int whole)
{
    const struct hf_engine_def *e = p->engine;
    int width, height;
    choose_tile(p, threads, &width, &height);
    find_reaches(p, s);
    for (int sweep = 2; sweep <= e->sweeps; sweep++) {
        if (sweep > 2) {
            width = p->cells.width[2];
            height = p->cells.height[2];
        }
        if (e->plan.cell)
            e->plan.cell(s, sweep, &width, &height);
        height = cut_height(p, s, sweep, width, height, threads);
        if (tile_height && sweep == 2)
            height = e->plan.grain ? ceil_div(tile_height, e->plan.grain) * e->plan.grain : tile_height;
        set_cells(p, sweep, tile_width && sweep == 2 ? tile_width : width, height, whole);
    }
    find_areas(p, s);
    int longest = 0;
    for (int i = 0; i < e->pass_count; i++) {
        const int sweep = e->passes[i].sweep;
        longest = hf_max(longest, 2 * hf_min(p->cells.width[sweep], (p->width + 15) & ~15));
        for (int b = 0; hf_plan_pass_runs(p, s, i) && b < e->buf_count; b++) {
            const int touched = (e->passes[i].reads | e->passes[i].around | e->passes[i].writes) >> b & 1;
            const int length = (p->cells.width[sweep] + 2 * p->cells.buf[b].x) << hf_max(e->bufs[b].x, 0);
            longest = touched ? hf_max(longest, length) : longest;
        }
    }
    p->cells.line_floats = (size_t)((longest + 15) & ~15) + 2 * HF_PAD;
}

int hf_plan_count(const struct hf_plan *p, int sweep)
{
    return p->columns[sweep] * p->rows[sweep];
}

size_t hf_plan_tile_bytes(const struct hf_plan *p)
{
    const size_t bytes = (size_t)hf_plan_count(p, 2) * (sizeof *p->tile_active + 1);
    return (bytes + HF_ALIGN - 1) / HF_ALIGN * HF_ALIGN;
}

void hf_plan_tile_memory(struct hf_plan *p, void *memory)
{
    p->tile_active = memory;
    p->tile_needs = (uint8_t *)(p->tile_active + (size_t)hf_plan_count(p, 2));
}

size_t hf_plan_chunk_bytes(const struct hf_plan *p)
{
    return (size_t)hf_plan_count(p, 1) * (2 * sizeof(struct hf_found) + sizeof(int) + 3);
}

void hf_plan_chunk_memory(struct hf_plan *p, void *memory)
{
    const size_t chunks = (size_t)hf_plan_count(p, 1);
    p->near = memory;
    p->far = p->near + chunks;
    p->rest = (int *)(p->far + chunks);
    p->rest_count = 0;
    p->chunk_known = (atomic_uchar *)(p->rest + chunks);
    p->chunk_made = (uint8_t *)(p->chunk_known + chunks);
    p->chunk_reads = p->chunk_made + chunks;
    for (size_t i = 0; i < chunks; i++)
        atomic_init(&p->chunk_known[i], 0);
    memset(p->chunk_made, 0, 2 * chunks);
}

struct hf_rect hf_plan_cell(const struct hf_plan *p, int sweep, int i)
{
    const int w = p->cells.width[sweep], h = p->cells.height[sweep];
    const int x = i % p->columns[sweep] * w, y = i / p->columns[sweep] * h;
    return (struct hf_rect){x, y, hf_min(x + w, p->width), hf_min(y + h, p->height)};
}

struct hf_rect hf_plan_active(const struct hf_plan *p, int tile)
{
    return p->tile_active[tile];
}

// The chunks that touch r grown by reach, as a rectangle of chunk numbers.
static struct hf_rect chunks_around(const struct hf_plan *p, struct hf_rect r, struct hf_reach reach)
{
    const int w = p->cells.width[1], h = p->cells.height[1];
    return (struct hf_rect){hf_max(r.x0 - reach.x, 0) / w, hf_max(r.y0 - reach.y, 0) / h,
                            hf_min((r.x1 + reach.x - 1) / w + 1, p->columns[1]),
                            hf_min((r.y1 + reach.y - 1) / h + 1, p->rows[1])};
}

// How far around a tile its passes read the buffers of the first sweep.
static struct hf_reach read_reach(const struct hf_plan *p)
{
    struct hf_reach reach = {0, 0};
    for (int b = 0; b < p->engine->buf_count; b++)
        if (p->engine->bufs[b].frame)
            reach = reach_max(reach, p->cells.buf[b]);
    return reach;
}

// A sweep with cells of its own reads across the frame, so all chunks are needed.
static int reads_all(const struct hf_plan *p, const struct hf_setup *s)
{
    for (int sweep = 3; sweep <= p->engine->sweeps; sweep++)
        if (hf_plan_sweep_runs(p, s, sweep) &&
            (p->engine->plan.across >> sweep & 1 || p->cells.width[sweep] != p->cells.width[2] ||
             p->cells.height[sweep] != p->cells.height[2]))
            return 1;
    return 0;
}

// Widen the active part of a tile by the blocks that a rectangle in it touches. Blocks are counted from the tile's
// corner; they are a group wide and four rows high, which are whole rows of every buffer.
static void widen(struct hf_rect *active, struct hf_rect tile, int x0, int x1, int y0, int y1)
{
    x0 = (x0 - tile.x0) / HF_GROUP * HF_GROUP + tile.x0;
    x1 = hf_min((x1 - tile.x0 + HF_GROUP - 1) / HF_GROUP * HF_GROUP + tile.x0, tile.x1);
    y0 = (y0 - tile.y0) / 4 * 4 + tile.y0;
    y1 = hf_min((y1 - tile.y0 + 3) / 4 * 4 + tile.y0, tile.y1);
    *active = (struct hf_rect){hf_min(active->x0, x0), hf_min(active->y0, y0), hf_max(active->x1, x1),
                               hf_max(active->y1, y1)};
}

// Widen the active part of a tile by a chunk's CoC of one kind, spread by reach. Returns whether there is any.
static int spread_chunk(const struct hf_found *found, struct hf_rect chunk, struct hf_reach reach, struct hf_rect tile,
                        struct hf_rect *active)
{
    const int y0 = hf_max(found->y0 - reach.y, tile.y0), y1 = hf_min(found->y1 + reach.y, tile.y1);
    const int shared = chunk.x1 - chunk.x0 > 64 * HF_GROUP;  // several groups share a bit
    int any = 0;
    if (!found->groups || y0 >= y1)
        return 0;
    for (int x = chunk.x0; x < chunk.x1; x = (x / HF_GROUP + 1) * HF_GROUP) {
        const int end = hf_min((x / HF_GROUP + 1) * HF_GROUP, chunk.x1);
        if (!shared && !(found->groups >> hf_group(x) & 1))
            continue;
        const int x0 = hf_max(x - reach.x, tile.x0), x1 = hf_min(end + reach.x, tile.x1);
        if (x0 >= x1)
            continue;
        widen(active, tile, x0, x1, y0, y1);
        any = 1;
    }
    return any;
}

static int is_whole(struct hf_rect active, struct hf_rect tile)
{
    return active.x0 == tile.x0 && active.y0 == tile.y0 && active.x1 == tile.x1 && active.y1 == tile.y1;
}

// Find what a tile needs, and in which part of it: a thin object blurs much less than a whole tile.
void hf_plan_classify(struct hf_plan *p, const struct hf_setup *s, int i)
{
    const struct hf_reach near = spread_of(p, s, HF_NEAR), far = spread_of(p, s, HF_FAR);
    const struct hf_rect tile = hf_plan_cell(p, 2, i), c = chunks_around(p, tile, reach_max(near, far));
    struct hf_rect active = {tile.x1, tile.y1, tile.x0, tile.y0};
    unsigned needs = 0;
    const int wanted = !p->part || p->engine->own.made || hf_rect_meets(tile, half_region(s));
    for (int y = c.y0; wanted && y < c.y1; y++)
        for (int x = c.x0; x < c.x1; x++) {
            if (needs == HF_FIELDS && is_whole(active, tile))
                break;
            const int at = y * p->columns[1] + x;
            const struct hf_rect chunk = hf_plan_cell(p, 1, at);
            needs |= spread_chunk(&p->near[at], chunk, near, tile, &active) ? HF_NEAR : 0u;
            needs |= spread_chunk(&p->far[at], chunk, far, tile, &active) ? HF_FAR : 0u;
        }
    const int all = wanted && (p->no_skip || (needs && s->several));
    p->tile_needs[i] = (uint8_t)(all ? HF_FIELDS : needs);
    p->tile_active[i] = p->no_skip ? tile : active;
}

unsigned hf_plan_found(struct hf_plan *p, int chunk, const struct hf_counts *counts)
{
    p->near[chunk] = counts->near;
    p->far[chunk] = counts->far;
    atomic_store_explicit(&p->chunk_known[chunk], 1, memory_order_release);
    return (counts->near.groups ? HF_NEAR : 0u) | (counts->far.groups ? HF_FAR : 0u);
}

// Near CoC makes active what lies within its spread, and tiles read beyond their active part. Only certain needs count,
// so that every buffer made early is read.
unsigned hf_plan_foreseen(const struct hf_plan *p, const struct hf_setup *s, int chunk)
{
    const int columns = p->columns[1], y0 = chunk / columns * p->cells.height[1], reads = read_reach(p).y;
    const int near = spread_of(p, s, HF_NEAR).y + reads, far = spread_of(p, s, HF_FAR).y + reads;
    unsigned needs = 0;
    for (int i = chunk - columns; i >= 0 && needs != HF_FIELDS; i -= columns) {
        if (y0 - (i / columns + 1) * p->cells.height[1] >= hf_max(near, far))
            break;
        if (!atomic_load_explicit(&p->chunk_known[i], memory_order_acquire))
            continue;
        needs |= p->near[i].groups && y0 - p->near[i].y1 < near ? HF_NEAR : 0u;
        needs |= p->far[i].groups && y0 - p->far[i].y1 < far ? HF_FAR : 0u;
    }
    return reads_of(p, s, needs);
}

// The chunks, as a rectangle of chunk numbers, that a tile reads; returns which of their fields.
static unsigned tile_reads(const struct hf_plan *p, const struct hf_setup *s, int tile, struct hf_rect *chunks)
{
    if (!p->tile_needs[tile])
        return 0;
    *chunks = chunks_around(p, hf_plan_active(p, tile), read_reach(p));
    return reads_of(p, s, p->tile_needs[tile]);
}

int hf_plan_makes_chunks(const struct hf_plan *p)
{
    return p->engine->pass_count > 1 && p->engine->passes[1].sweep == 1;
}

static void list_rest(struct hf_plan *p, const struct hf_setup *s, int scan)
{
    const int makes = hf_plan_makes_chunks(p);
    p->rest_count = 0;
    for (int i = 0; i < hf_plan_count(p, 1); i++) {
        const int missing = makes && (p->chunk_reads[i] & ~p->chunk_made[i]);
        const int inside = !p->part || hf_rect_meets(hf_plan_cell(p, 1, i), half_region(s));
        const int unread = inside && (!makes || (!p->chunk_reads[i] && !p->chunk_made[i]));
        if (missing || (scan && unread))
            p->rest[p->rest_count++] = i;
    }
}

// Cut a tile's active part to the region. Engines that count what the first sweep makes need the counts of the whole
// frame, so their tiles are cut only when it is known what they read.
static void cut_tile(struct hf_plan *p, const struct hf_setup *s, int i)
{
    const struct hf_rect tile = hf_plan_cell(p, 2, i), r = hf_rect_both(half_region(s), tile);
    struct hf_rect *active = &p->tile_active[i];
    *active = hf_rect_both(*active, (struct hf_rect){r.x0 / 16 * 16, (r.y0 - tile.y0) / 4 * 4 + tile.y0,
                                                     hf_min((r.x1 + 15) / 16 * 16, tile.x1),
                                                     hf_min((r.y1 - tile.y0 + 3) / 4 * 4 + tile.y0, tile.y1)});
    if (!hf_rect_meets(tile, half_region(s)) || active->x0 >= active->x1 || active->y0 >= active->y1)
        p->tile_needs[i] = 0;
}

// Around chunks an engine reads columns and rows of its halos, pixels beside mixed ones, and what repairs are made from.
void hf_plan_reads(const struct hf_plan *p, const struct hf_setup *s, struct hf_rect *colour, struct hf_rect *depth)
{
    const struct hf_reach halo = read_reach(p);
    const struct hf_rect all = {0, 0, s->width, s->height}, first = p->area[2];
    struct hf_rect half = half_region(s), seen = p->looked;
    int more = 8;
    if (p->needs && !hf_plan_makes_chunks(p)) {
        half = rect_around(half, grown(p, first, p->cells.pass[1]));
    } else if (p->needs) {
        more += hf_max(halo.x, halo.y);
        for (int i = 0; i < hf_plan_count(p, 1); i++)
            half = p->chunk_reads[i] ? rect_around(half, hf_plan_cell(p, 1, i)) : half;
    }
    half = grown(p, half, (struct hf_reach){more, more});
    seen = rect_around(grown(p, seen, (struct hf_reach){1, 1}), half);
    *colour = hf_rect_both(all, (struct hf_rect){2 * half.x0, 2 * half.y0, 2 * half.x1, 2 * half.y1});
    *depth = hf_rect_both(all, (struct hf_rect){2 * seen.x0, 2 * seen.y0, 2 * seen.x1, 2 * seen.y1});
}

void hf_plan_settle(struct hf_plan *p, const struct hf_setup *s, int scan)
{
    const int chunks = hf_plan_count(p, 1), tiles = hf_plan_count(p, 2);
    const int counts = p->engine->own.made != NULL;
    memset(p->chunk_reads, 0, (size_t)chunks);
    p->needs = 0;
    for (int i = 0; i < tiles; i++) {
        struct hf_rect c = {0};
        if (p->part && !counts)
            cut_tile(p, s, i);
        const unsigned reads = tile_reads(p, s, i, &c);
        if (p->part && counts)
            cut_tile(p, s, i);
        p->needs |= p->tile_needs[i];
        for (int y = c.y0; reads && y < c.y1; y++)
            for (int x = c.x0; x < c.x1; x++)
                p->chunk_reads[y * p->columns[1] + x] |= (uint8_t)reads;
    }
    p->reads = reads_of(p, s, p->needs);
    for (int i = 0; i < chunks && p->needs && reads_all(p, s); i++)
        p->chunk_reads[i] = hf_rect_meets(hf_plan_cell(p, 1, i), p->area[1]) ? (uint8_t)p->reads : 0;
    if (!p->needs)
        memset(p->chunk_reads, 0, (size_t)chunks);
    list_rest(p, s, scan);
}
