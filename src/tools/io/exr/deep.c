// SPDX-License-Identifier: BSD-3-Clause
// Reads deep parts, scan lines and tiles. A chunk has the counts of its pixels, summed up along each row of it, and the samples
// row after row, in a row channel after channel; both are compressed. The first pass reads all counts, the second the samples.
#include "tools/io/exr/deep.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include <libdeflate.h>

#include "tools/io/exr/chunks.h"
#include "tools/io/exr/zip.h"
#include "tools/io/half.h"

// What deflate and RLE can make of a byte at most, and a few bytes for short chunks.
enum { MOST_RATIO = 1040, MOST_SPARE = 4096 };
// Samples of a part: 20 to 24 bytes each.
static const uint64_t MOST_SAMPLES = (uint64_t)1 << 28;

enum { RED, GREEN, BLUE, ALPHA, DEPTH, BACK, CHANNELS };

struct chunk {
    int x0, y0, width, height;
    uint64_t at, counts, packed, samples;  // in the file; bytes of counts and samples there, and of samples unpacked
};

struct worker {
    struct libdeflate_decompressor *deflate;
    uint8_t *packed, *scratch, *data;
    size_t packed_size, data_size;
};

struct reading {
    struct hf_exr *e;
    const struct hf_exr_part *part;
    int number, chunks, lines;
    uint64_t *table;
    size_t sample_bytes;
    const float *to[CHANNELS];
    int channel[CHANNELS];  // -1: none
    struct hf_exr_samples *out;
    struct worker *workers;
    atomic_int failed;
    struct hf_io_error *err;
};

static int fail(struct reading *r, int index, const char *why)
{
    if (!atomic_exchange(&r->failed, 1))
        hf_io_fail(r->err, "%s: truncated or corrupt: chunk %d of part %d %s", r->e->path, index, r->number, why);
    return -1;
}

static int no_memory(struct reading *r)
{
    if (!atomic_exchange(&r->failed, 1))
        hf_io_fail(r->err, "%s: out of memory", r->e->path);
    return -1;
}

static bool is_tiled(const struct reading *r)
{
    return r->part->storage == EXR_STORAGE_DEEP_TILED;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

// Find chunk i, and check what it says of itself.
static int find_chunk(struct reading *r, int i, struct chunk *k)
{
    const struct hf_exr_part *part = r->part;
    const int across = is_tiled(r) ? (part->width - 1) / part->tile_width + 1 : 1;
    struct hf_exr_leader l;
    uint64_t sizes[3];
    *k = (struct chunk){.width = part->width};
    if (is_tiled(r)) {
        k->x0 = i % across * part->tile_width;
        k->y0 = i / across * part->tile_height;
        k->width = least(part->tile_width, part->width - k->x0);
        k->height = least(part->tile_height, part->height - k->y0);
    } else {
        k->y0 = i * r->lines;
        k->height = least(r->lines, part->height - k->y0);
    }
    if (hf_exr_read_leader(r->e, r->number, r->table[i], &l) ||
        hf_exr_read_at(r->e, sizes, sizeof(sizes), l.data - sizeof(sizes)))
        return fail(r, i, "is not inside the file");
    if (is_tiled(r) ? l.place[0] != i % across || l.place[1] != i / across || l.place[2] || l.place[3]
                    : l.place[0] != part->window.min.y + k->y0)
        return fail(r, i, "is another's");
    k->at = l.data;
    k->counts = sizes[0];
    k->packed = sizes[1];
    k->samples = sizes[2];
    if (k->counts > (uint64_t)k->width * (uint64_t)k->height * 4)
        return fail(r, i, "has more counts than pixels");
    if (k->samples < k->packed || k->samples / MOST_RATIO > k->packed + MOST_SPARE / MOST_RATIO ||
        k->samples / r->sample_bytes > MOST_SAMPLES || k->samples % r->sample_bytes)
        return fail(r, i, "says that it has samples of a size that it cannot have");
    return 0;
}

static int grow(uint8_t **data, size_t *have, size_t size)
{
    if (size <= *have && *data)
        return 0;
    free(*data);
    *data = malloc(size + 1);
    *have = *data ? size : 0;
    return *data ? 0 : -1;
}

// A run of a byte, or a number of bytes as they are.
static int unpack_rle(uint8_t *to, size_t size, const uint8_t *from, size_t packed)
{
    size_t at = 0;
    for (size_t i = 0; i < packed;) {
        const int count = (int8_t)from[i++];
        const size_t n = count < 0 ? (size_t)-count : (size_t)count + 1;
        if (n > size - at || i >= packed || (count < 0 && n > packed - i))
            return -1;
        if (count < 0)
            memcpy(to + at, from + i, n);
        else
            memset(to + at, from[i], n);
        at += n;
        i += count < 0 ? n : 1;
    }
    return at == size ? 0 : -1;
}

// Unpack `size` bytes into w->data.
static int unpack(struct reading *r, struct worker *w, int i, uint64_t at, uint64_t packed, uint64_t size)
{
    size_t scratch = w->data_size;
    if (!size)
        return packed ? fail(r, i, "is damaged") : 0;
    if (grow(&w->packed, &w->packed_size, (size_t)packed))
        return no_memory(r);
    if (w->data_size < size) {
        if (grow(&w->scratch, &scratch, (size_t)size) || grow(&w->data, &w->data_size, (size_t)size)) {
            w->data_size = 0;
            free(w->data);
            w->data = NULL;
            return no_memory(r);
        }
    }
    if (hf_exr_read_at(r->e, w->packed, (size_t)packed, at))
        return fail(r, i, "cannot be read");
    if (packed == size) {
        memcpy(w->data, w->packed, (size_t)size);
        return 0;
    }
    if (r->part->compression == EXR_COMPRESSION_RLE) {
        if (unpack_rle(w->scratch, (size_t)size, w->packed, (size_t)packed))
            return fail(r, i, "is damaged");
        hf_exr_join(w->data, w->scratch, (size_t)size);
        return 0;
    }
    if (r->part->compression == EXR_COMPRESSION_NONE)
        return fail(r, i, "is damaged");
    w->deflate = w->deflate ? w->deflate : libdeflate_alloc_decompressor();
    if (!w->deflate)
        return no_memory(r);
    return hf_exr_unzip(w->deflate, w->data, (size_t)size, w->packed, (size_t)packed, w->scratch)
               ? fail(r, i, "is damaged")
               : 0;
}

// The pixel at which a row of a chunk begins, and the number of samples in that row.
static size_t row_start(const struct reading *r, const struct chunk *k, int y)
{
    return (size_t)(k->y0 + y) * (size_t)r->part->width + (size_t)k->x0;
}

static uint64_t row_samples(const struct reading *r, const struct chunk *k, int y)
{
    const size_t at = row_start(r, k, y);
    return r->out->first[at + (size_t)k->width] - r->out->first[at];
}

// Note the counts of a chunk's pixels in first[], one place late.
static void read_counts(void *arg, int i, int worker)
{
    struct reading *r = arg;
    struct worker *w = &r->workers[worker];
    struct chunk k;
    uint64_t all = 0;
    if (atomic_load(&r->failed) || find_chunk(r, i, &k) ||
        unpack(r, w, i, k.at, k.counts, (uint64_t)k.width * (uint64_t)k.height * 4))
        return;
    for (int y = 0; y < k.height; y++) {
        uint64_t *to = r->out->first + row_start(r, &k, y) + 1;
        int32_t before = 0;
        for (int x = 0; x < k.width; x++) {
            int32_t sum;
            memcpy(&sum, w->data + 4 * ((size_t)y * (size_t)k.width + (size_t)x), sizeof(sum));
            if (sum < before) {
                fail(r, i, "has counts that fall");
                return;
            }
            to[x] = (uint64_t)(sum - before);
            before = sum;
        }
        all += (uint64_t)before;
    }
    if (all * r->sample_bytes != k.samples)
        fail(r, i, "has other samples than its counts say");
}

static void convert(const uint8_t *from, exr_pixel_type_t type, size_t n, float *to)
{
    if (type == EXR_PIXEL_HALF)
        hf_io_halves_to_floats(to, from, n);
    else
        memcpy(to, from, n * sizeof(*to));
}

static void read_samples(void *arg, int i, int worker)
{
    struct reading *r = arg;
    struct worker *w = &r->workers[worker];
    const struct hf_exr_samples *out = r->out;
    float *const to[CHANNELS] = {out->colour[0], out->colour[1], out->colour[2], out->colour[3], out->depth, out->back};
    struct chunk k;
    uint64_t all = 0;
    if (atomic_load(&r->failed) || find_chunk(r, i, &k))
        return;
    for (int y = 0; y < k.height; y++)
        all += row_samples(r, &k, y);
    // Another program may have written to the file since its counts were read.
    if (all * r->sample_bytes != k.samples)
        fail(r, i, "has changed while it was read");
    if (!all || atomic_load(&r->failed) || unpack(r, w, i, k.at + k.counts, k.packed, k.samples))
        return;
    const uint8_t *from = w->data;
    for (int y = 0; y < k.height; y++) {
        const size_t at = row_start(r, &k, y), n = (size_t)row_samples(r, &k, y);
        for (int c = 0; c < r->part->channel_count; c++) {
            for (int t = 0; t < CHANNELS; t++)
                if (r->channel[t] == c && to[t] && (t == 0 || t > 2 || to[t] != to[0]))
                    convert(from, r->part->channels[c].type, n, to[t] + out->first[at]);
            from += n * (size_t)r->part->channels[c].bytes;
        }
    }
}

static int find_channels(struct reading *r, const struct hf_io_view *v)
{
    const char *const names[CHANNELS] = {v->colour[0], v->colour[1], v->colour[2], v->colour[3], v->depth, "ZBack"};
    for (int t = 0; t < CHANNELS; t++) {
        r->channel[t] = names[t][0] ? hf_exr_find_channel(r->part, names[t]) : -1;
        if (r->channel[t] >= 0 && r->part->channels[r->channel[t]].type == EXR_PIXEL_UINT)
            return hf_io_fail(r->err, "%s: channel %s holds whole numbers, which is not supported", r->e->path,
                              names[t]);
    }
    for (int c = 0; c < r->part->channel_count; c++)
        r->sample_bytes += (size_t)r->part->channels[c].bytes;
    return 0;
}

// Turn counts into places, and take memory for the samples.
static int take_memory(struct reading *r)
{
    struct hf_exr_samples *out = r->out;
    const size_t pixels = (size_t)r->part->width * (size_t)r->part->height;
    uint64_t all = 0;
    for (size_t i = 0; i < pixels; i++)
        out->first[i + 1] = all += out->first[i + 1];
    if (all > MOST_SAMPLES)
        return hf_io_fail(r->err, "%s: %llu samples are more than the %llu that can be read", r->e->path,
                          (unsigned long long)all, (unsigned long long)MOST_SAMPLES);
    const size_t bytes = (size_t)all * sizeof(float) + 1;
    bool missing = false;
    for (int t = 0; t < CHANNELS; t++) {
        float **to = t < 4 ? &out->colour[t] : t == DEPTH ? &out->depth : &out->back;
        if (t < 3 && r->channel[t] == r->channel[RED] && t > 0)
            *to = out->colour[0];
        else if (t != BACK || r->channel[t] >= 0)
            missing |= !(*to = hf_io_alloc(bytes));
    }
    for (uint64_t i = 0; i < all && !missing && r->channel[ALPHA] < 0; i++)
        out->colour[3][i] = 1;
    return missing ? hf_io_fail(r->err, "%s: out of memory for %llu samples", r->e->path, (unsigned long long)all) : 0;
}

static int begin(struct reading *r, const struct hf_io_run *run)
{
    const struct hf_exr_part *part = r->part;
    const size_t pixels = (size_t)part->width * (size_t)part->height;
    r->lines = part->chunk_lines;
    r->chunks = part->chunk_count;
    if (part->compression != EXR_COMPRESSION_NONE && part->compression != EXR_COMPRESSION_RLE &&
        part->compression != EXR_COMPRESSION_ZIPS && part->compression != EXR_COMPRESSION_ZIP)
        return hf_io_fail(r->err, "%s: deep samples with compression %s are not supported", r->e->path,
                          hf_exr_compression_name(part->compression));
    if (!part->one_level)
        return hf_io_fail(r->err, "%s: mipmapped deep pictures are not supported", r->e->path);
    r->table = hf_exr_table(r->e, r->number, r->err);
    if (!r->table)
        return -1;
    r->workers = calloc((size_t)hf_io_run_workers(run), sizeof(*r->workers));
    r->out->first = r->workers ? calloc(pixels + 1, sizeof(*r->out->first)) : NULL;
    return r->out->first ? 0 : no_memory(r);
}

int hf_exr_read_deep(struct hf_exr *e, const struct hf_io_view *view, const struct hf_io_run *run,
                     struct hf_exr_samples *to, struct hf_io_error *err)
{
    struct reading r = {.e = e, .part = &e->parts[view->part], .number = view->part, .out = to, .err = err};
    *to = (struct hf_exr_samples){NULL};
    int status = hf_exr_check_part(e, view->part, err);
    if (!status)
        status = find_channels(&r, view);
    if (!status)
        status = begin(&r, run);
    if (!status) {
        hf_io_run(run, r.chunks, read_counts, &r);
        status = atomic_load(&r.failed) ? -1 : take_memory(&r);
    }
    if (!status) {
        hf_io_run(run, r.chunks, read_samples, &r);
        status = atomic_load(&r.failed) ? -1 : 0;
    }
    for (int i = 0; i < hf_io_run_workers(run) && r.workers; i++) {
        libdeflate_free_decompressor(r.workers[i].deflate);
        free(r.workers[i].packed);
        free(r.workers[i].scratch);
        free(r.workers[i].data);
    }
    free(r.workers);
    free(r.table);
    return status;
}

void hf_exr_free_deep(struct hf_exr_samples *s)
{
    for (int c = 0; c < 4; c++)
        if (c == 0 || c > 2 || s->colour[c] != s->colour[0])
            free(s->colour[c]);
    free(s->depth);
    free(s->back);
    free(s->first);
    *s = (struct hf_exr_samples){NULL};
}

double hf_exr_deep_bytes(const struct hf_exr_samples *s, size_t pixels)
{
    const double samples = s->first ? (double)s->first[pixels] : 0;
    return s->first ? 8. * (double)pixels + samples * (s->back ? 24 : 20) : 0;
}
