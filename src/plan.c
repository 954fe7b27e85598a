// SPDX-License-Identifier: BSD-3-Clause
#include "plan.h"

#include <string.h>

// What measured fastest on two cores with 512 KB of second-level cache each. Large tiles compute little twice at their
// rims and read memory in long runs; smaller ones stay in the cache, and skip more. With more threads they are halved until
// each thread has a few.
enum { TILE_WIDTH = 320, TILE_HEIGHT = 96, MIN_WIDTH = 64, MIN_HEIGHT = 24, TILES_A_THREAD = 4, CHUNK_HEIGHT = 8 };

// Walk the passes backwards from the output, and carry along how far around a tile each buffer is read.
static void find_reaches(struct hf_plan *p, const struct hf_setup *s)
{
    memset(p->buf, 0, sizeof p->buf);
    for (int i = HF_PASS_COUNT - 1; i >= 0; i--) {
        const struct hf_pass *pass = &hf_passes[i];
        const struct hf_reach halo = hf_pass_halo(s, pass->halo);
        struct hf_reach out = {0, 0};
        for (int b = 0; b < HF_BUF_COUNT; b++)
            if (pass->writes >> b & 1) {
                out.x = hf_max(out.x, p->buf[b].x);
                out.y = hf_max(out.y, p->buf[b].y);
            }
        p->pass[i] = out;
        for (int b = 0; b < HF_BUF_COUNT; b++) {
            const int around = pass->around >> b & 1;
            if (around || (pass->reads >> b & 1)) {
                p->buf[b].x = hf_max(p->buf[b].x, out.x + (around ? halo.x : 0));
                p->buf[b].y = hf_max(p->buf[b].y, out.y + (around ? halo.y : 0));
            }
        }
    }
    // The gather's own scratch.
    const struct hf_reach taps = hf_pass_halo(s, HF_HALO_TAPS), out = p->pass[HF_PASS_GATHER];
    p->buf[HF_BUF_SUM] = out;
    p->buf[HF_BUF_WEIGHT] = p->buf[HF_BUF_COLORW4] = p->buf[HF_BUF_COLORFARW4] =
        (struct hf_reach){out.x + taps.x, out.y + taps.y};
}

static int ceil_div(int a, int b)
{
    return (a + b - 1) / b;
}

// Tiles of the default size, smaller if there are many threads. Widths stay multiples of 16: kernels write whole vectors,
// and a chunk's last one must not reach into its neighbour.
static void choose_tile(struct hf_plan *p, const struct hf_setup *s, int threads)
{
    p->tile_width = TILE_WIDTH;
    p->tile_height = TILE_HEIGHT;
    while (ceil_div(s->half_width, p->tile_width) * ceil_div(s->half_height, p->tile_height) <
           TILES_A_THREAD * threads) {
        if (p->tile_width > 2 * p->tile_height && p->tile_width / 2 >= MIN_WIDTH)
            p->tile_width /= 2;
        else if (p->tile_height / 2 >= MIN_HEIGHT)
            p->tile_height /= 2;
        else
            break;
    }
}

void hf_plan_layout(struct hf_plan *p, const struct hf_setup *s, int tile_width, int tile_height, int threads,
                    int whole)
{
    choose_tile(p, s, threads);
    if (tile_width)
        p->tile_width = tile_width;
    if (tile_height)
        p->tile_height = tile_height;
    if (whole) {
        p->tile_width = (s->half_width + 15) & ~15;
        p->tile_height = s->half_height;
    }
    p->chunk_width = p->tile_width;
    p->chunk_height = whole ? p->tile_height : hf_min(CHUNK_HEIGHT, p->tile_height);
    p->chunks_x = ceil_div(s->half_width, p->chunk_width);
    p->chunks_y = ceil_div(s->half_height, p->chunk_height);
    p->tiles_x = ceil_div(s->half_width, p->tile_width);
    p->tiles_y = ceil_div(s->half_height, p->tile_height);
    find_reaches(p, s);
}

size_t hf_plan_bytes(const struct hf_plan *p)
{
    const size_t chunks = (size_t)p->chunks_x * p->chunks_y, tiles = (size_t)p->tiles_x * p->tiles_y;
    return chunks * (sizeof(int) + 2) + tiles;
}

void hf_plan_memory(struct hf_plan *p, void *memory)
{
    const size_t chunks = (size_t)p->chunks_x * p->chunks_y;
    p->deferred = memory;
    p->chunk_found = (uint8_t *)(p->deferred + chunks);
    p->chunk_deferred = p->chunk_found + chunks;
    p->tile_needs = p->chunk_deferred + chunks;
    p->deferred_count = 0;
}

static struct hf_rect cell(int i, int columns, int w, int h, const struct hf_setup *s)
{
    const int x = i % columns * w, y = i / columns * h;
    return (struct hf_rect){x, y, hf_min(x + w, s->half_width), hf_min(y + h, s->half_height)};
}

struct hf_rect hf_plan_chunk(const struct hf_plan *p, const struct hf_setup *s, int i)
{
    return cell(i, p->chunks_x, p->chunk_width, p->chunk_height, s);
}

struct hf_rect hf_plan_tile(const struct hf_plan *p, const struct hf_setup *s, int i)
{
    return cell(i, p->tiles_x, p->tile_width, p->tile_height, s);
}

// The chunks that touch r grown by reach, as a rectangle of chunk numbers.
static struct hf_rect chunks_around(const struct hf_plan *p, struct hf_rect r, struct hf_reach reach)
{
    return (struct hf_rect){hf_max(r.x0 - reach.x, 0) / p->chunk_width, hf_max(r.y0 - reach.y, 0) / p->chunk_height,
                            hf_min((r.x1 + reach.x - 1) / p->chunk_width + 1, p->chunks_x),
                            hf_min((r.y1 + reach.y - 1) / p->chunk_height + 1, p->chunks_y)};
}

static int found_around(const struct hf_plan *p, struct hf_rect r, struct hf_reach reach)
{
    const struct hf_rect c = chunks_around(p, r, reach);
    int found = 0;
    for (int y = c.y0; y < c.y1; y++)
        for (int x = c.x0; x < c.x1; x++)
            found |= p->chunk_found[y * p->chunks_x + x];
    return found;
}

// A deferred chunk that a tile reads is put on the list, once.
static void want_around(struct hf_plan *p, struct hf_rect r, struct hf_reach reach)
{
    const struct hf_rect c = chunks_around(p, r, reach);
    for (int y = c.y0; y < c.y1; y++)
        for (int x = c.x0; x < c.x1; x++) {
            const int i = y * p->chunks_x + x;
            if (p->chunk_deferred[i]) {
                p->chunk_deferred[i] = 0;
                p->deferred[p->deferred_count++] = i;
            }
        }
}

void hf_plan_classify(struct hf_plan *p, const struct hf_setup *s)
{
    const struct hf_reach here = {0, 0};
    // Blurred near CoC is 0 unless there is some within this reach.
    const struct hf_reach near = {p->pass[HF_PASS_MAX_X].x + s->max_x, p->pass[HF_PASS_MAX_X].y};
    struct hf_reach read = {hf_max(p->buf[HF_BUF_COLOR4].x, p->buf[HF_BUF_COC4].x),
                            hf_max(p->buf[HF_BUF_COLOR4].y, p->buf[HF_BUF_COC4].y)};
    for (int i = 0; i < p->tiles_x * p->tiles_y; i++) {
        const struct hf_rect r = hf_plan_tile(p, s, i);
        p->tile_needs[i] = s->no_skip ? HF_NEAR | HF_FAR
                                      : (found_around(p, r, near) & HF_NEAR) | (found_around(p, r, here) & HF_FAR);
        if (p->tile_needs[i])
            want_around(p, r, read);
    }
}
