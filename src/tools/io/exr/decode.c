// SPDX-License-Identifier: BSD-3-Clause
// Decodes parts: one task per chunk, which is decompressed once and then split into the wanted planes. libdeflate
// decompresses ZIP, Core all other compressions.
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include <libdeflate.h>

#include "tools/io/exr/chunks.h"
#include "tools/io/exr/zip.h"
#include "tools/io/half.h"

struct buffer {
    uint8_t *data;
    size_t size;
};

// The scratch of one thread.
struct worker {
    exr_decode_pipeline_t pipe;
    exr_result_t (*decompress)(exr_decode_pipeline_t *);
    struct libdeflate_decompressor *deflate;
    struct buffer packed, scratch, samples;
};

// One part being decoded.
struct decoding {
    struct hf_exr *e;
    int part;
    const struct hf_exr_plane *planes;
    int plane_count;
    uint8_t *keep;  // all samples of the part, or NULL: each worker's own chunk
    bool decoded;   // keep is filled already
    uint64_t *table;
    struct worker *workers;
    atomic_int failed;
    struct hf_io_error *err;
};

static uint8_t *grow(struct buffer *b, size_t size)
{
    if (size > b->size || !b->data) {
        free(b->data);
        b->data = malloc(size + 1);
        b->size = b->data ? size : 0;
    }
    return b->data;
}

// Only the first error is reported.
static bool first_error(struct decoding *d)
{
    return !atomic_exchange(&d->failed, 1);
}

static int wrong_chunk(struct decoding *d, int index)
{
    if (first_error(d))
        hf_io_fail(d->err, "%s: truncated or corrupt: chunk %d of part %d is damaged", d->e->path, index, d->part);
    return -1;
}

static int no_memory(struct decoding *d)
{
    if (first_error(d))
        hf_io_fail(d->err, "%s: out of memory", d->e->path);
    return -1;
}

// ---- ZIP, ZIPS, none

static int find_chunk(const struct decoding *d, const struct hf_exr_chunk *k, struct hf_exr_leader *l)
{
    const struct hf_exr_part *part = &d->e->parts[d->part];
    if (hf_exr_read_leader(d->e, d->part, d->table[k->index], l) || l->data_size > k->size)
        return -1;
    if (part->storage == EXR_STORAGE_TILED)
        return l->place[0] == k->x0 / part->tile_width && l->place[1] == k->y0 / part->tile_height && !l->place[2] &&
                       !l->place[3]
                   ? 0
                   : -1;
    return l->place[0] == part->window.min.y + k->y0 ? 0 : -1;
}

static int own_chunk(struct decoding *d, struct worker *w, const struct hf_exr_chunk *k, uint8_t *to)
{
    const bool zip = d->e->parts[d->part].compression != EXR_COMPRESSION_NONE;
    struct hf_exr_leader l;
    if (find_chunk(d, k, &l) || (!zip && l.data_size != k->size))
        return wrong_chunk(d, k->index);
    // A chunk that did not shrink is stored uncompressed.
    if (l.data_size == k->size)
        return hf_exr_read_at(d->e, to, k->size, l.data) ? wrong_chunk(d, k->index) : 0;
    const uint8_t *packed = hf_exr_bytes(d->e, l.data_size, l.data);
    if (!w->deflate)
        w->deflate = libdeflate_alloc_decompressor();
    if (!w->deflate || !grow(&w->scratch, k->size) || (!packed && !grow(&w->packed, l.data_size)))
        return no_memory(d);
    if (!packed) {
        if (hf_exr_read_at(d->e, w->packed.data, l.data_size, l.data))
            return wrong_chunk(d, k->index);
        packed = w->packed.data;
    }
    return hf_exr_unzip(w->deflate, to, k->size, packed, l.data_size, w->scratch.data) ? wrong_chunk(d, k->index) : 0;
}

// ---- with Core

static exr_result_t chunk_info(const struct decoding *d, const struct hf_exr_chunk *k, exr_chunk_info_t *info)
{
    const struct hf_exr_part *part = &d->e->parts[d->part];
    if (part->storage == EXR_STORAGE_TILED)
        return exr_read_tile_chunk_info(d->e->core, d->part, k->x0 / part->tile_width, k->y0 / part->tile_height, 0, 0,
                                        info);
    return exr_read_scanline_chunk_info(d->e->core, d->part, part->window.min.y + k->y0, info);
}

static exr_result_t run_core(struct decoding *d, struct worker *w, const exr_chunk_info_t *info)
{
    exr_result_t rv;
    if (!w->pipe.context) {
        rv = exr_decoding_initialize(d->e->core, d->part, info, &w->pipe);
        if (!rv)
            rv = exr_decoding_choose_default_routines(d->e->core, d->part, &w->pipe);
        w->pipe.unpack_and_convert_fn = NULL;  // the rows are used as they are
        w->decompress = w->pipe.decompress_fn;
    } else {
        rv = exr_decoding_update(d->e->core, d->part, info, &w->pipe);
    }
    // A chunk that did not shrink is stored uncompressed with any compression. Core 3.1 forgets that for B44.
    w->pipe.decompress_fn = info->packed_size == info->unpacked_size ? NULL : w->decompress;
    return rv ? rv : exr_decoding_run(d->e->core, d->part, &w->pipe);
}

static int core_chunk(struct decoding *d, struct worker *w, const struct hf_exr_chunk *k, uint8_t *to)
{
    exr_chunk_info_t info = {0};
    hf_exr_quiet();
    exr_result_t rv = chunk_info(d, k, &info);
    if (!rv)
        rv = run_core(d, w, &info);
    if (rv) {
        if (first_error(d))
            hf_exr_fail(d->e, rv, d->err);
        return -1;
    }
    // Core and this code must round subsampled rows in the same way.
    if (!w->pipe.unpacked_buffer || info.unpacked_size != k->size)
        return wrong_chunk(d, k->index);
    memcpy(to, w->pipe.unpacked_buffer, k->size);
    return 0;
}

// ---- samples to planes

static void to_floats(float *to, const uint8_t *samples, int count, exr_pixel_type_t type)
{
    if (type == EXR_PIXEL_FLOAT) {
        memcpy(to, samples, (size_t)count * sizeof(*to));
    } else if (type == EXR_PIXEL_HALF) {
        hf_io_halves_to_floats(to, samples, (size_t)count);
    } else {
        for (int i = 0; i < count; i++) {
            uint32_t u;
            memcpy(&u, samples + 4 * (size_t)i, sizeof(u));
            to[i] = (float)u;
        }
    }
}

// Both windows are within HF_IO_MAX_COORDINATE, so their differences fit.
static void fill_plane(const struct hf_exr_part *part, const struct hf_exr_plane *plane, const struct hf_exr_chunk *k,
                       const uint8_t *samples)
{
    const struct hf_io_box *g = &plane->grid;
    const struct hf_exr_channel *ch = &part->channels[plane->channel];
    const int x = part->window.min.x + k->x0;
    const int from = x > g->x0 ? x : g->x0, to = x + k->width < g->x1 ? x + k->width : g->x1;
    for (int y = k->y0; y < k->y0 + k->height && from < to; y++) {
        const int gy = part->window.min.y + y;
        if (gy < g->y0 || gy >= g->y1)
            continue;
        float *row = plane->to + (size_t)(gy - g->y0) * (size_t)(g->x1 - g->x0) + (from - g->x0);
        to_floats(row, samples + hf_exr_row_at(part, k, plane->channel, y) + (size_t)(from - x) * (size_t)ch->bytes,
                  to - from, ch->type);
    }
}

static bool touches(const struct hf_exr_part *part, const struct hf_exr_plane *plane, const struct hf_exr_chunk *k)
{
    const int x = part->window.min.x + k->x0, y = part->window.min.y + k->y0;
    return x < plane->grid.x1 && x + k->width > plane->grid.x0 && y < plane->grid.y1 && y + k->height > plane->grid.y0;
}

static void decode_task(void *arg, int i, int worker)
{
    struct decoding *d = arg;
    struct worker *w = &d->workers[worker];
    const struct hf_exr_part *part = &d->e->parts[d->part];
    const struct hf_exr_chunk k = hf_exr_chunk_at(part, part->chunk_lines, i);
    bool wanted = d->keep && !d->decoded;
    for (int c = 0; c < d->plane_count; c++)
        wanted |= d->planes[c].part == d->part && touches(part, &d->planes[c], &k);
    if (!wanted || atomic_load(&d->failed))
        return;
    uint8_t *samples = d->keep ? d->keep + k.at : grow(&w->samples, k.size);
    const exr_compression_t c = part->compression;
    const bool own = c == EXR_COMPRESSION_NONE || c == EXR_COMPRESSION_ZIP || c == EXR_COMPRESSION_ZIPS;
    if (!samples)
        no_memory(d);
    else if (d->decoded || !(own ? own_chunk : core_chunk)(d, w, &k, samples))
        for (int n = 0; n < d->plane_count; n++)
            if (d->planes[n].part == d->part)
                fill_plane(part, &d->planes[n], &k, samples);
}

static void free_workers(struct worker *workers, int count)
{
    for (int i = 0; i < count && workers; i++) {
        struct worker *w = &workers[i];
        if (w->pipe.context)
            exr_decoding_destroy(w->pipe.context, &w->pipe);
        libdeflate_free_decompressor(w->deflate);
        free(w->packed.data);
        free(w->scratch.data);
        free(w->samples.data);
    }
    free(workers);
}

static int run_tasks(struct decoding *d, const struct hf_io_run *run)
{
    const struct hf_exr_part *part = &d->e->parts[d->part];
    const int workers = hf_io_run_workers(run);
    d->workers = calloc((size_t)workers, sizeof(*d->workers));
    if (!d->workers)
        return hf_io_fail(d->err, "%s: out of memory", d->e->path);
    hf_io_run(run, hf_exr_count_chunks(part, part->chunk_lines), decode_task, d);
    free_workers(d->workers, workers);
    return atomic_load(&d->failed) ? -1 : 0;
}

static int decode_part(struct hf_exr *e, int p, const struct hf_exr_plane *planes, int count, bool keep,
                       const struct hf_io_run *run, struct hf_io_error *err)
{
    struct hf_exr_part *part = &e->parts[p];
    struct decoding d = {.e = e, .part = p, .planes = planes, .plane_count = count, .err = err};
    if (hf_exr_lay_out(e, p, err))
        return -1;
    d.decoded = part->samples != NULL;
    const bool whole = hf_exr_is_dwa(part->compression);
    d.keep = part->samples;
    if (!d.decoded && (keep || whole)) {
        d.keep = hf_io_alloc(part->layout.bytes + 1);
        if (!d.keep)
            return hf_io_fail(err, "%s: out of memory: %d x %d pixels of %d channels", e->path, part->width,
                              part->height, part->channel_count);
    }
    int status = 0;
    if (!d.decoded && whole) {
        status = hf_exr_codec_read(e, p, d.keep, run ? run->workers : 1, err);
        d.decoded = true;
    } else if (!d.decoded) {
        d.table = hf_exr_table(e, p, err);
        status = d.table ? 0 : -1;
    }
    if (!status)
        status = run_tasks(&d, run);
    free(d.table);
    if (!status && keep)
        part->samples = d.keep;
    else if (d.keep != part->samples)
        free(d.keep);
    return status;
}

int hf_exr_decode(struct hf_exr *e, const struct hf_exr_plane *planes, int count, const struct hf_io_run *run,
                  struct hf_io_error *err)
{
    for (int p = 0; p < e->part_count; p++) {
        bool wanted = false, keep = false;
        for (int i = 0; i < count; i++) {
            wanted |= planes[i].part == p;
            keep |= planes[i].part == p && planes[i].keep;
        }
        if (wanted && decode_part(e, p, planes, count, keep, run, err))
            return -1;
    }
    return 0;
}

int hf_exr_load_samples(struct hf_exr *e, int p, const struct hf_io_run *run, struct hf_io_error *err)
{
    return e->parts[p].samples ? 0 : decode_part(e, p, NULL, 0, true, run, err);
}
