// SPDX-License-Identifier: BSD-3-Clause
// Writing a copy of an EXR file with some colours replaced. Header bytes and the chunks of untouched parts are copied
// as they are; in a touched part the new colours are put between the samples of the other channels, as stored, and the
// whole is compressed again.
#include <stdlib.h>
#include <string.h>

#include "io/exr/chunks.h"
#include "io/half.h"

struct part_plan {
    bool changed;
    exr_compression_t compression;
    int chunk_count;
    uint64_t *table;  // new chunk offsets
};

struct writer {
    struct hf_exr *e;
    const struct hf_exr_job *job;
    struct part_plan *plans;
    struct hf_out *out;
    uint64_t at, header_size;
    uint64_t *clamped;
    struct hf_io_error *err;
};

static int plan_part(struct writer *w, int p)
{
    const int compression = w->job->compression;
    const struct hf_exr_part *part = &w->e->parts[p];
    struct part_plan *plan = &w->plans[p];
    plan->compression = part->compression;
    plan->chunk_count = part->chunk_count;
    for (int i = 0; i < w->job->n_results; i++) {
        const struct hf_io_view *v = &w->job->views->view[w->job->results[i].view];
        for (int k = 0; k < 4; k++) {
            if (v->part != p || !w->job->results[i].planes[k] || !v->colour[k][0])
                continue;
            const int c = hf_exr_find_channel(part, v->colour[k]);
            if (part->channels[c].type == EXR_PIXEL_UINT)
                return hf_io_fail(w->err, "%s: channel %s holds integers, which cannot take a blurred colour",
                                  w->e->path, v->colour[k]);
            plan->changed = true;
        }
    }
    if (plan->changed && !part->one_level)
        return hf_io_fail(w->err, "%s: part %d is mipmapped; writing new colours into it is not supported", w->e->path,
                          p);
    if (plan->changed && compression >= 0)
        plan->compression = (exr_compression_t)compression;
    if (plan->changed && part->storage == EXR_STORAGE_SCANLINE)
        plan->chunk_count = (part->height - 1) / hf_exr_compression_lines(plan->compression) + 1;
    plan->table = calloc((size_t)plan->chunk_count, sizeof(*plan->table));
    return plan->table ? 0 : hf_io_fail(w->err, "%s: out of memory", w->e->path);
}

// The source's header with what a change of compression changes: one byte and one number per part.
static int write_header(struct writer *w)
{
    const struct hf_exr *e = w->e;
    size_t size = e->header_size;
    uint8_t *header = malloc(e->header_size);
    if (!header)
        return hf_io_fail(w->err, "%s: out of memory", e->path);
    int status = hf_exr_read_at(e, header, e->header_size, 0);
    if (status)
        hf_io_fail(w->err, "%s: cannot read the header again", e->path);
    for (int p = 0; p < e->part_count && !status; p++) {
        const struct hf_exr_part *part = &e->parts[p];
        const int32_t count = w->plans[p].chunk_count;
        if (w->plans[p].compression != part->compression)
            header[part->compression_at] = (uint8_t)w->plans[p].compression;
        if (count != part->chunk_count && part->chunk_count_at)
            memcpy(header + part->chunk_count_at, &count, sizeof(count));
    }
    if (!status && w->job->text_count) {
        uint8_t *stamped = hf_exr_stamp(header, &size, w->job->texts, w->job->text_count);
        status = stamped ? 0 : hf_io_fail(w->err, "%s: out of memory", e->path);
        free(header);
        header = stamped;
    }
    if (!status)
        status = hf_out_write(w->out, header, size, w->err);
    w->at = w->header_size = size;
    free(header);
    return status;
}

static int write_tables(struct writer *w)
{
    for (int p = 0; p < w->e->part_count; p++) {
        const size_t size = (size_t)w->plans[p].chunk_count * sizeof(uint64_t);
        if (hf_out_write(w->out, w->plans[p].table, size, w->err))
            return -1;
    }
    return 0;
}

// One sample of a greyscale picture. Equal colours pass as they are.
static float grey(const float *const planes[4], size_t i)
{
    if (!planes[1] || !planes[2] || (planes[0][i] == planes[1][i] && planes[1][i] == planes[2][i]))
        return planes[0][i];
    return 0.2126f * planes[0][i] + 0.7152f * planes[1][i] + 0.0722f * planes[2][i];
}

static void put_row(uint8_t *to, const float *from, int n, exr_pixel_type_t type, uint64_t *clamped)
{
    for (int i = 0; i < n; i++) {
        if (type == EXR_PIXEL_HALF) {
            const uint16_t h = hf_io_to_half(from[i], clamped);
            memcpy(to + 2 * (size_t)i, &h, sizeof(h));
        } else {
            const float f = isnan(from[i]) ? 0 : from[i];
            memcpy(to + 4 * (size_t)i, &f, sizeof(f));
        }
    }
}

static int put_colours(struct writer *w, struct hf_exr_pixels *px, const struct hf_io_view *v,
                       const float *const planes[4])
{
    const struct hf_exr_part *part = px->part;
    const bool y_only = !strcmp(v->colour[0], v->colour[1]);
    float *row = malloc((size_t)part->width * sizeof(*row));
    if (!row)
        return hf_io_fail(w->err, "%s: out of memory", w->e->path);
    for (int k = 0; k < 4; k++) {
        if (!planes[k] || !v->colour[k][0] || (y_only && (k == 1 || k == 2)))
            continue;
        const int c = hf_exr_find_channel(part, v->colour[k]);
        for (int y = 0; y < part->height; y++) {
            const float *from = planes[k] + (size_t)y * (size_t)part->width;
            if (y_only && k == 0) {
                for (int x = 0; x < part->width; x++)
                    row[x] = grey(planes, (size_t)y * (size_t)part->width + (size_t)x);
                from = row;
            }
            put_row(hf_exr_pixel_row(px, c, y), from, part->width, part->channels[c].type, w->clamped);
        }
    }
    free(row);
    return 0;
}

static struct hf_exr_target target_of(struct writer *w, int p)
{
    return (struct hf_exr_target){w->out, w->at, w->e->multipart, p, w->plans[p].table};
}

static int put_chunk(struct hf_exr_target *t, const struct hf_exr_pixels *px, int index, int chunk_lines,
                     const void *data, size_t size, struct hf_io_error *err)
{
    const struct hf_exr_part *part = px->part;
    int32_t leader[5] = {part->window.min.y + index * chunk_lines, (int32_t)size};
    const bool tiled = part->storage == EXR_STORAGE_TILED;
    if (tiled) {
        const int nx = (part->width - 1) / part->tile_width + 1;
        leader[0] = index % nx;
        leader[1] = index / nx;
        leader[4] = (int32_t)size;
    }
    t->table[index] = t->at;
    if (hf_exr_put_leader(t, leader, tiled ? 20 : 8, err) || hf_out_write(t->out, data, size, err))
        return -1;
    t->at += size;
    return 0;
}

// Compress all chunks, in the order the source has them where there are as many.
static int encode_part(struct writer *w, int p, const struct hf_exr_pixels *px)
{
    const struct part_plan *plan = &w->plans[p];
    const struct hf_exr_part *part = px->part;
    struct hf_exr_target t = target_of(w, p);
    struct hf_exr_encoder en;
    struct hf_exr_slot *slots = NULL;
    if (hf_exr_encoder_open(&en, w->e, px, plan->compression, w->err))
        return -1;
    int status = 0;
    if (plan->chunk_count == part->chunk_count) {
        slots = hf_exr_file_order(w->e, p, w->err);
        status = slots ? 0 : -1;
    }
    for (int i = 0; i < plan->chunk_count && !status; i++) {
        const void *data;
        size_t size;
        const int backwards = plan->chunk_count - 1 - i;
        const int index = slots ? slots[i].index : part->line_order == EXR_LINEORDER_DECREASING_Y ? backwards : i;
        status = hf_exr_encode(&en, index, &data, &size, w->err);
        if (!status)
            status = put_chunk(&t, px, index, en.chunk_lines, data, size, w->err);
    }
    w->at = t.at;
    free(slots);
    hf_exr_encoder_close(&en);
    return status;
}

// Have the codec write the part as a file of its own and take the chunks out of that: it alone can compress DWA,
// but would not keep the rest of the file as it is.
static int encode_dwa(struct writer *w, int p, const struct hf_exr_pixels *px)
{
    struct hf_exr_target t = target_of(w, p);
    struct hf_io_samples s;
    struct hf_exr_names names;
    struct hf_io_bytes bytes = {0};
    struct hf_exr *made = NULL;
    float level = 0;
    if (exr_attr_get_float(w->e->core, p, "dwaCompressionLevel", &level) != EXR_ERR_SUCCESS)
        level = 0;
    if (hf_exr_samples(px, w->e->path, &s, &names, w->err))
        return -1;
    int status =
        w->e->dwa->write(&bytes, w->out->path, &s, hf_exr_compression_name(w->plans[p].compression), level, w->err);
    if (!status)
        status = hf_exr_open_memory(&made, w->out->path, &bytes, w->err);
    if (!status &&
        (made->parts[0].chunk_count != w->plans[p].chunk_count || made->parts[0].storage != px->part->storage))
        status = hf_io_fail(w->err, "%s: OpenImageIO cut the picture into other chunks than it should", w->out->path);
    if (!status)
        status = hf_exr_copy_chunks(made, 0, &t, w->err);
    w->at = t.at;
    hf_exr_close(made);
    free(bytes.data);
    hf_exr_free_names(&names);
    return status;
}

static int write_part(struct writer *w, int p)
{
    struct hf_exr_pixels px;
    if (!w->plans[p].changed) {
        struct hf_exr_target t = target_of(w, p);
        const int status = hf_exr_copy_chunks(w->e, p, &t, w->err);
        w->at = t.at;
        return status;
    }
    if (hf_exr_read_pixels(w->e, p, &px, w->err))
        return -1;
    int status = 0;
    for (int i = 0; i < w->job->n_results && !status; i++) {
        const struct hf_io_view *v = &w->job->views->view[w->job->results[i].view];
        if (v->part == p)
            status = put_colours(w, &px, v, w->job->results[i].planes);
    }
    if (!status)
        status = hf_exr_is_dwa(w->plans[p].compression) ? encode_dwa(w, p, &px) : encode_part(w, p, &px);
    hf_exr_free_pixels(&px);
    return status;
}

static int write_all(struct writer *w)
{
    if (write_header(w) || write_tables(w))
        return -1;
    for (int p = 0; p < w->e->part_count; p++)
        w->at += (uint64_t)w->plans[p].chunk_count * sizeof(uint64_t);
    for (int p = 0; p < w->e->part_count; p++)
        if (write_part(w, p))
            return -1;
    return hf_out_seek(w->out, w->header_size, w->err) || write_tables(w) ? -1 : 0;
}

int hf_exr_write(struct hf_exr *e, struct hf_out *out, const struct hf_exr_job *job, uint64_t *clamped,
                 struct hf_io_error *err)
{
    struct writer w = {.e = e, .out = out, .job = job, .clamped = clamped, .err = err};
    w.plans = calloc((size_t)w.e->part_count, sizeof(*w.plans));
    int status = w.plans ? 0 : hf_io_fail(err, "%s: out of memory", out->path);
    for (int p = 0; p < w.e->part_count && !status; p++)
        status = plan_part(&w, p);
    if (!status)
        status = write_all(&w);
    for (int p = 0; w.plans && p < w.e->part_count; p++)
        free(w.plans[p].table);
    free(w.plans);
    return status;
}
