// SPDX-License-Identifier: BSD-3-Clause
// Makes a copy of an EXR file with some colours replaced, as a list of pieces: header bytes with few changes, chunks of
// the source where nothing changes, and new chunks elsewhere, which contain the new colours and the other channels as
// stored.
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/io/exr/chunks.h"
#include "tools/io/half.h"
#include "tools/common/luminance.h"

// A chunk with its leader: in memory, or at `from` in the source.
struct piece {
    uint8_t *data;
    uint64_t from;
    size_t size;
};

struct part_plan {
    bool changed;
    exr_compression_t compression;
    int chunk_count;
    struct piece *pieces;  // by chunk number
    int *order;            // the order of the chunks in the file
};

struct hf_exr_made {
    struct hf_exr *e;
    uint8_t *head;  // header and chunk tables
    size_t header_size, head_size;
    bool stamped;  // there are texts, and a checksum is to be filled in
    int part_count;
    struct part_plan *plans;
};

// The work on one part.
struct encoding {
    struct hf_exr *e;
    int part;
    const struct hf_exr_job *job;
    struct part_plan *plan;
    uint64_t *table;  // of the source
    struct encode_worker {
        struct hf_exr_encoder en;
        bool open;
        uint8_t *raw;
        size_t raw_size;
        float *row;
    } * workers;
    atomic_int failed;
    atomic_ullong clamped;
    struct hf_io_error *err;
};

// The number of a view's channel guessed; -1: there is none.
static int guessed_channel(const struct hf_exr_part *part, const struct hf_io_view *v)
{
    char name[256];
    hf_io_guessed_name(v, name);
    return hf_exr_find_channel(part, name);
}

static int plan_part(struct hf_exr *e, int p, const struct hf_exr_job *job, struct part_plan *plan,
                     struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[p];
    plan->compression = part->compression;
    plan->chunk_count = part->chunk_count;
    for (int i = 0; i < job->n_results; i++) {
        const struct hf_io_view *v = &job->views->view[job->results[i].view];
        for (int k = 0; k < 4; k++) {
            if (v->part != p || !job->results[i].planes[k] || !v->colour[k][0])
                continue;
            const int c = hf_exr_find_channel(part, v->colour[k]);
            if (part->channels[c].type == EXR_PIXEL_UINT)
                return hf_io_fail(err, "%s: channel %s holds integers, which cannot take a blurred colour", e->path,
                                  v->colour[k]);
            plan->changed = true;
        }
        const int guessed = v->part == p && job->results[i].guessed ? guessed_channel(part, v) : -1;
        if (guessed >= 0 && part->channels[guessed].type == EXR_PIXEL_UINT)
            return hf_io_fail(err, "%s: channel %s holds integers, which cannot say how much was guessed", e->path,
                              part->channels[guessed].name);
    }
    if (plan->changed && !part->one_level)
        return hf_io_fail(err, "%s: part %d is mipmapped; writing new colours into it is not supported", e->path, p);
    if (plan->changed && job->compression >= 0)
        plan->compression = (exr_compression_t)job->compression;
    plan->changed |= part->grown;
    if (plan->changed)
        plan->chunk_count = hf_exr_count_chunks(part, hf_exr_compression_lines(plan->compression));
    plan->pieces = calloc((size_t)plan->chunk_count, sizeof(*plan->pieces));
    plan->order = calloc((size_t)plan->chunk_count, sizeof(*plan->order));
    return plan->pieces && plan->order ? 0 : hf_io_fail(err, "%s: out of memory", e->path);
}

// List the channels that parts were given.
static int list_added(const struct hf_exr *e, uint8_t **header, size_t *size, struct hf_io_error *err)
{
    for (int p = 0; p < e->part_count; p++)
        for (int i = 0; i < e->parts[p].added_count; i++) {
            uint8_t *listed = hf_exr_list_channel(*header, size, p, e->parts[p].added[i]);
            if (!listed)
                return hf_io_fail(err, "%s: out of memory", e->path);
            free(*header);
            *header = listed;
        }
    return 0;
}

// The source's header without misfits, with the texts, and with one byte and one number per part changed where the
// compression changes.
static int make_header(struct hf_exr_made *m, const struct hf_exr_job *job, struct hf_io_error *err)
{
    const struct hf_exr *e = m->e;
    size_t size = e->header_size, tables = 0;
    uint8_t *header = malloc(size);
    if (!header)
        return hf_io_fail(err, "%s: out of memory", e->path);
    int status = hf_exr_read_at(e, header, size, 0);
    if (status)
        hf_io_fail(err, "%s: cannot read the header again", e->path);
    for (int p = 0; p < e->part_count && !status; p++) {
        const struct hf_exr_part *part = &e->parts[p];
        const int32_t count = m->plans[p].chunk_count;
        tables += 8 * (size_t)count;
        if (m->plans[p].compression != part->compression)
            header[part->compression_at] = (uint8_t)m->plans[p].compression;
        if (count != part->chunk_count && part->chunk_count_at)
            memcpy(header + part->chunk_count_at, &count, sizeof(count));
        if (part->grown)
            memcpy(header + part->window_at, &part->window, sizeof(part->window));
    }
    if (!status) {
        size = hf_exr_drop_misfits(e, header, size);
        status = list_added(e, &header, &size, err);
    }
    if (!status && job->text_count) {
        uint8_t *stamped = hf_exr_stamp(header, &size, job->texts, job->text_count);
        status = stamped ? 0 : hf_io_fail(err, "%s: out of memory", e->path);
        free(header);
        header = stamped;
    }
    m->stamped = job->text_count > 0;
    m->header_size = size;
    m->head_size = size + tables;
    m->head = status ? NULL : realloc(header, m->head_size);
    if (!m->head) {
        free(header);
        return status ? -1 : hf_io_fail(err, "%s: out of memory", e->path);
    }
    return 0;
}

// Compute the new places of the chunks.
static void fill_tables(struct hf_exr_made *m)
{
    uint64_t at = m->head_size;
    uint8_t *table = m->head + m->header_size;
    for (int p = 0; p < m->part_count; p++) {
        const struct part_plan *plan = &m->plans[p];
        for (int i = 0; i < plan->chunk_count; i++) {
            memcpy(table + 8 * (size_t)plan->order[i], &at, sizeof(at));
            at += plan->pieces[plan->order[i]].size;
        }
        table += 8 * (size_t)plan->chunk_count;
    }
}

// Take all chunks of a part as they are, in their order in e. If e is not the source, they are copied into memory.
static int take_chunks(struct hf_exr *e, int p, struct part_plan *plan, struct hf_io_error *err)
{
    const struct hf_exr_part *last = &e->parts[e->part_count - 1];
    uint64_t end = last->table + 8 * (uint64_t)last->chunk_count;
    struct hf_exr_slot *slots = hf_exr_file_order(e, p, err);
    int status = slots ? 0 : -1;
    for (int i = 0; i < plan->chunk_count && !status; i++) {
        struct hf_exr_leader l;
        // Chunks must not overlap, or a short file could make a long one.
        if (slots[i].offset < end || hf_exr_read_leader(e, p, slots[i].offset, &l)) {
            status = hf_io_fail(err, "%s: truncated or corrupt: chunk %d of part %d is not where its table says",
                                e->path, slots[i].index, p);
            break;
        }
        plan->order[i] = slots[i].index;
        plan->pieces[slots[i].index] = (struct piece){.from = slots[i].offset, .size = l.size + (size_t)l.data_size};
        end = l.data + l.data_size;
    }
    free(slots);
    return status;
}

// One sample of a greyscale picture. Equal colours keep their value exactly.
static float grey(const float *const planes[4], size_t i)
{
    if (!planes[1] || !planes[2] || (planes[0][i] == planes[1][i] && planes[1][i] == planes[2][i]))
        return planes[0][i];
    return tool_luminance(planes[0][i], planes[1][i], planes[2][i]);
}

static void put_row(uint8_t *to, const float *from, int n, exr_pixel_type_t type, uint64_t *clamped)
{
    if (type == EXR_PIXEL_HALF) {
        hf_io_floats_to_halves(to, from, (size_t)n, clamped);
        return;
    }
    for (int i = 0; i < n; i++) {
        const float f = isnan(from[i]) ? 0 : from[i];
        memcpy(to + 4 * (size_t)i, &f, sizeof(f));
    }
}

// Put a new plane over the chunk's samples of a channel.
static void put_plane(const struct encoding *en, struct encode_worker *w, const struct hf_exr_chunk *k, int channel,
                      const float *plane, uint64_t *clamped)
{
    const struct hf_exr_part *part = &en->e->parts[en->part];
    for (int y = k->y0; y < k->y0 + k->height; y++)
        put_row(w->raw + hf_exr_row_at(part, k, channel, y), plane + (size_t)y * (size_t)part->width + (size_t)k->x0,
                k->width, part->channels[channel].type, clamped);
}

// Put the new colours of one view over the chunk's samples.
static void put_view(const struct encoding *en, struct encode_worker *w, const struct hf_exr_chunk *k,
                     const struct hf_io_result *r, uint64_t *clamped)
{
    const struct hf_io_view *v = &en->job->views->view[r->view];
    const struct hf_exr_part *part = &en->e->parts[en->part];
    const bool y_only = !strcmp(v->colour[0], v->colour[1]);
    if (r->guessed)
        put_plane(en, w, k, guessed_channel(part, v), r->guessed, clamped);
    for (int c = 0; c < 4; c++) {
        if (!r->planes[c] || !v->colour[c][0] || (y_only && (c == 1 || c == 2)))
            continue;
        const int channel = hf_exr_find_channel(part, v->colour[c]);
        if (!y_only || c)
            put_plane(en, w, k, channel, r->planes[c], clamped);
        for (int y = k->y0; y < k->y0 + k->height && y_only && !c; y++) {
            const size_t at = (size_t)y * (size_t)part->width + (size_t)k->x0;
            for (int x = 0; x < k->width; x++)
                w->row[x] = grey(r->planes, at + (size_t)x);
            put_row(w->raw + hf_exr_row_at(part, k, channel, y), w->row, k->width, part->channels[channel].type,
                    clamped);
        }
    }
}

static int prepare(struct encoding *en, struct encode_worker *w, size_t size, struct hf_io_error *err)
{
    const struct hf_exr_part *part = &en->e->parts[en->part];
    if (!w->open) {
        if (hf_exr_encoder_open(&w->en, en->e, part, en->plan->compression, en->job->zip_level, err))
            return -1;
        w->open = true;
        w->row = malloc((size_t)part->width * sizeof(*w->row));
    }
    if (size > w->raw_size || !w->raw) {
        free(w->raw);
        w->raw = malloc(size + 1);
        w->raw_size = w->raw ? size : 0;
    }
    return w->raw && w->row ? 0 : hf_io_fail(err, "%s: out of memory", en->e->path);
}

// Keep a chunk in memory, with its leader.
static int keep_piece(const struct encoding *en, const struct hf_exr_chunk *k, const uint8_t *data, size_t size,
                      struct hf_io_error *err)
{
    const struct hf_exr_part *part = &en->e->parts[en->part];
    int32_t leader[6];
    int n = 0;
    if (en->e->multipart)
        leader[n++] = en->part;
    if (part->storage == EXR_STORAGE_TILED) {
        leader[n++] = k->x0 / part->tile_width;
        leader[n++] = k->y0 / part->tile_height;
        leader[n++] = 0;  // levels
        leader[n++] = 0;
    } else {
        leader[n++] = part->window.min.y + k->y0;
    }
    leader[n++] = (int32_t)size;
    struct piece *piece = &en->plan->pieces[k->index];
    piece->size = (size_t)n * sizeof(*leader) + size;
    piece->data = malloc(piece->size);
    if (!piece->data)
        return hf_io_fail(err, "%s: out of memory", en->e->path);
    memcpy(piece->data, leader, (size_t)n * sizeof(*leader));
    memcpy(piece->data + (size_t)n * sizeof(*leader), data, size);
    return 0;
}

static int encode_chunk(struct encoding *en, struct encode_worker *w, int i, struct hf_io_error *err)
{
    const struct hf_exr_part *part = &en->e->parts[en->part];
    const int lines = hf_exr_compression_lines(en->plan->compression);
    const struct hf_exr_chunk k = hf_exr_chunk_at(part, lines, i);
    uint64_t clamped = 0;
    const uint8_t *data;
    size_t size;
    struct hf_exr_leader l;
    if (prepare(en, w, k.size, err))
        return -1;
    memcpy(w->raw, part->samples + k.at, k.size);
    for (int r = 0; r < en->job->n_results; r++)
        if (en->job->views->view[en->job->results[r].view].part == en->part)
            put_view(en, w, &k, &en->job->results[r], &clamped);
    atomic_fetch_add(&en->clamped, clamped);
    // Unchanged chunks are copied, which also keeps lossy compression from losing more.
    if (en->table && !memcmp(w->raw, part->samples + k.at, k.size) &&
        !hf_exr_read_leader(en->e, en->part, en->table[i], &l)) {
        en->plan->pieces[i] = (struct piece){.from = en->table[i], .size = l.size + (size_t)l.data_size};
        return 0;
    }
    return hf_exr_encode(&w->en, &k, w->raw, &data, &size, err) || keep_piece(en, &k, data, size, err) ? -1 : 0;
}

static void encode_task(void *arg, int i, int worker)
{
    struct encoding *en = arg;
    struct hf_io_error err;
    if (!atomic_load(&en->failed) && encode_chunk(en, &en->workers[worker], i, &err) &&
        !atomic_exchange(&en->failed, 1) && en->err)
        *en->err = err;
}

static int encode_chunks(struct encoding *en, const struct hf_io_run *run)
{
    const int workers = hf_io_run_workers(run);
    en->workers = calloc((size_t)workers, sizeof(*en->workers));
    if (!en->workers)
        return hf_io_fail(en->err, "%s: out of memory", en->e->path);
    hf_io_run(run, en->plan->chunk_count, encode_task, en);
    for (int i = 0; i < workers; i++) {
        if (en->workers[i].open)
            hf_exr_encoder_close(&en->workers[i].en);
        free(en->workers[i].raw);
        free(en->workers[i].row);
    }
    free(en->workers);
    return atomic_load(&en->failed) ? -1 : 0;
}

// Let the codec make the part as a file of its own, and take the chunks from that.
static int encode_by_codec(struct encoding *en, const struct hf_io_run *run)
{
    struct hf_exr *e = en->e, *made = NULL;
    struct hf_exr_part *part = &e->parts[en->part];
    struct part_plan *plan = en->plan;
    struct hf_io_bytes bytes = {0};
    struct encode_worker w = {.raw = malloc(part->layout.bytes + 1),
                              .row = malloc((size_t)part->width * sizeof(float))};
    int status = w.raw && w.row ? 0 : hf_io_fail(en->err, "%s: out of memory", e->path);
    uint64_t clamped = 0;
    uint8_t *whole = w.raw;
    if (!status)
        memcpy(whole, part->samples, part->layout.bytes);
    for (int i = 0; i < hf_exr_count_chunks(part, 32) && !status; i++) {
        const struct hf_exr_chunk k = hf_exr_chunk_at(part, 32, i);
        w.raw = whole + k.at;
        for (int r = 0; r < en->job->n_results; r++)
            if (en->job->views->view[en->job->results[r].view].part == en->part)
                put_view(en, &w, &k, &en->job->results[r], &clamped);
    }
    atomic_fetch_add(&en->clamped, clamped);
    // If nothing changed, nothing must be lost by compressing again.
    if (!status && !part->grown && plan->compression == part->compression &&
        !memcmp(whole, part->samples, part->layout.bytes)) {
        free(whole);
        free(w.row);
        return take_chunks(e, en->part, plan, en->err);
    }
    if (!status)
        status = hf_exr_codec_write(e, en->part, plan->compression, whole, run ? run->workers : 1, &bytes, en->err);
    free(whole);
    free(w.row);
    if (!status)
        status = hf_exr_open_memory(&made, e->path, &bytes, en->err);
    if (!status && (made->parts[0].chunk_count != plan->chunk_count || made->parts[0].storage != part->storage))
        status = hf_io_fail(en->err, "%s: DWA was cut into other chunks than it should", e->path);
    if (!status)
        status = take_chunks(made, 0, plan, en->err);
    for (int i = 0; i < plan->chunk_count && !status; i++) {
        struct piece *piece = &plan->pieces[i];
        const size_t number = e->multipart ? sizeof(int32_t) : 0;
        const int32_t own = en->part;
        piece->data = malloc(number + piece->size);
        if (!piece->data) {
            status = hf_io_fail(en->err, "%s: out of memory", e->path);
            break;
        }
        memcpy(piece->data, &own, number);
        memcpy(piece->data + number, bytes.data + piece->from, piece->size);
        piece->size += number;
    }
    hf_exr_close(made);
    free(bytes.data);
    return status;
}

// Use the order of the source if it has the same number of chunks.
static int order_chunks(const struct encoding *en)
{
    struct part_plan *plan = en->plan;
    const struct hf_exr_part *part = &en->e->parts[en->part];
    const bool same = plan->chunk_count == part->chunk_count && !part->grown;
    struct hf_exr_slot *slots = same ? hf_exr_file_order(en->e, en->part, en->err) : NULL;
    if (same && !slots)
        return -1;
    for (int i = 0; i < plan->chunk_count; i++)
        plan->order[i] = slots                                            ? slots[i].index
                         : part->line_order == EXR_LINEORDER_DECREASING_Y ? plan->chunk_count - 1 - i
                                                                          : i;
    free(slots);
    return 0;
}

static bool is_result(const struct hf_exr_job *job, int p, const char *channel)
{
    for (int i = 0; i < job->n_results; i++) {
        const struct hf_io_view *v = &job->views->view[job->results[i].view];
        for (int k = 0; k < 4; k++)
            if (v->part == p && job->results[i].planes[k] && !strcmp(v->colour[k], channel))
                return true;
    }
    return false;
}

static bool is_b44(exr_compression_t c)
{
    return c == EXR_COMPRESSION_B44 || c == EXR_COMPRESSION_B44A;
}

// Whether a compression changes the samples of a channel. DWA decides by the last piece of the name, in capitals only:
// masks named r, g and b keep their bits.
static bool loses(exr_compression_t compression, const struct hf_exr_channel *ch)
{
    static const char *const lossy[] = {"R", "G", "B", "Y", "RY", "BY"};
    const char *dot = strrchr(ch->name, '.'), *last = dot ? dot + 1 : ch->name;
    if (is_b44(compression))
        return ch->type == EXR_PIXEL_HALF;
    for (size_t i = 0; i < sizeof(lossy) / sizeof(lossy[0]); i++)
        if (hf_exr_is_dwa(compression) && ch->type != EXR_PIXEL_UINT && !strcmp(last, lossy[i]))
            return true;
    return false;
}

static bool same_loss(exr_compression_t a, exr_compression_t b)
{
    return (hf_exr_is_dwa(a) && hf_exr_is_dwa(b)) || (is_b44(a) && is_b44(b));
}

static void note_losses(const struct hf_exr *e, int p, const struct hf_exr_job *job, const struct part_plan *plan,
                        struct hf_io_written *written)
{
    const struct hf_exr_part *part = &e->parts[p];
    const char *first = NULL;
    int count = 0;
    bool made = false;
    for (int i = 0; i < plan->chunk_count; i++)
        made |= plan->pieces[i].data != NULL;
    for (int c = 0; c < part->channel_count && made; c++)
        if (loses(plan->compression, &part->channels[c]) && !is_result(job, p, part->channels[c].name)) {
            first = first ? first : part->channels[c].name;
            count++;
        }
    if (count && !written->note[0])
        snprintf(written->note, sizeof(written->note),
                 "%s: %d channel%s besides the colours (%s%s) %s compressed by %s%s, which loses a little; "
                 "--compression zip does not",
                 e->path, count, count > 1 ? "s" : "", first, count > 1 ? ", ..." : "", count > 1 ? "were" : "was",
                 hf_exr_compression_name(plan->compression),
                 same_loss(part->compression, plan->compression) ? " a second time" : "");
}

static int encode_part(struct hf_exr *e, int p, const struct hf_exr_job *job, struct part_plan *plan,
                       const struct hf_io_run *run, struct hf_io_written *written, struct hf_io_error *err)
{
    if (!plan->changed)
        return take_chunks(e, p, plan, err);
    struct encoding en = {.e = e, .part = p, .job = job, .plan = plan, .err = err};
    int status = hf_exr_load_samples(e, p, run, err);
    if (!status)
        status = order_chunks(&en);
    if (!status && hf_exr_is_dwa(plan->compression)) {
        status = encode_by_codec(&en, run);
    } else if (!status) {
        if (plan->compression == e->parts[p].compression && !e->parts[p].grown)
            en.table = hf_exr_table(e, p, err);
        status = encode_chunks(&en, run);
        free(en.table);
    }
    written->clamped += atomic_load(&en.clamped);
    if (!status)
        note_losses(e, p, job, plan, written);
    return status;
}

int hf_exr_encode_file(struct hf_exr_made **out, struct hf_exr *e, const struct hf_exr_job *job,
                       const struct hf_io_run *run, struct hf_io_written *written, struct hf_io_error *err)
{
    struct hf_exr_made *m = calloc(1, sizeof(*m));
    *out = NULL;
    if (m)
        m->plans = calloc((size_t)e->part_count, sizeof(*m->plans));
    int status = m && m->plans ? 0 : hf_io_fail(err, "%s: out of memory", e->path);
    if (!status) {
        m->e = e;
        m->part_count = e->part_count;
    }
    for (int p = 0; p < e->part_count && !status; p++)
        status = plan_part(e, p, job, &m->plans[p], err);
    if (!status)
        status = make_header(m, job, err);
    for (int p = 0; p < e->part_count && !status; p++)
        status = encode_part(e, p, job, &m->plans[p], run, written, err);
    if (status) {
        hf_exr_free_file(m);
        return -1;
    }
    if (e->misfits.count && !written->note[0])
        snprintf(written->note, sizeof(written->note),
                 "%s: %zu attribute%s left out, of another size than the type has", e->path, e->misfits.count,
                 e->misfits.count > 1 ? "s are" : " is");
    fill_tables(m);
    *out = m;
    return 0;
}

enum { PIECE = 1 << 20 };

// What is written, and its checksum so far.
struct summed {
    struct hf_out *out;
    uint32_t sum;
};

static int put(struct summed *to, const void *data, size_t size, struct hf_io_error *err)
{
    hf_exr_add_to_sum(&to->sum, data, size);
    return hf_out_write(to->out, data, size, err);
}

// Copy bytes of the source, in pieces unless they are in memory.
static int copy_range(const struct hf_exr *e, uint64_t from, uint64_t size, uint8_t *buf, struct summed *to,
                      struct hf_io_error *err)
{
    const uint8_t *bytes = hf_exr_bytes(e, size, from);
    if (bytes)
        return put(to, bytes, size, err);
    while (size) {
        const size_t n = size < PIECE ? (size_t)size : PIECE;
        if (hf_exr_read_at(e, buf, n, from))
            return hf_io_fail(err, "%s: truncated or corrupt: cannot read at byte %llu", e->path,
                              (unsigned long long)from);
        if (put(to, buf, n, err))
            return -1;
        from += n;
        size -= n;
    }
    return 0;
}

int hf_exr_put_file(const struct hf_exr_made *m, struct hf_out *out, struct hf_io_error *err)
{
    struct summed to = {.out = out};
    const size_t sum_at = m->stamped ? hf_exr_find_sum(m->head, m->header_size) : 0;
    uint8_t *buf = malloc(PIECE), digits[8];
    int status = buf ? put(&to, m->head, m->head_size, err) : hf_io_fail(err, "%s: out of memory", out->path);
    for (int p = 0; p < m->part_count; p++) {
        const struct part_plan *plan = &m->plans[p];
        for (int i = 0; i < plan->chunk_count && !status; i++) {
            const struct piece *piece = &plan->pieces[plan->order[i]];
            status = piece->data ? put(&to, piece->data, piece->size, err)
                                 : copy_range(m->e, piece->from, piece->size, buf, &to, err);
        }
    }
    free(buf);
    hf_exr_put_sum(digits, to.sum);
    return !status && sum_at ? hf_out_patch(out, sum_at, digits, sizeof(digits), err) : status;
}

void hf_exr_free_file(struct hf_exr_made *m)
{
    for (int p = 0; m && m->plans && p < m->part_count; p++) {
        for (int i = 0; i < m->plans[p].chunk_count && m->plans[p].pieces; i++)
            free(m->plans[p].pieces[i].data);
        free(m->plans[p].pieces);
        free(m->plans[p].order);
    }
    if (m) {
        free(m->plans);
        free(m->head);
    }
    free(m);
}
