// SPDX-License-Identifier: BSD-3-Clause
#include "io/files.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/io/half.h"

const char *folder;
uint64_t seed = 20240229;

uint32_t rnd(void)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(seed >> 33);
}

// The path of a file there; valid for good.
const char *in_folder(const char *name)
{
    static char paths[64][100];
    char path[100];
    int i = 0;
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    while (paths[i][0] && strcmp(paths[i], path))
        i++;
    return strcpy(paths[i], path);
}

void *allocate(size_t size)
{
    void *p = calloc(1, size ? size : 1);
    if (!p)
        abort();
    return p;
}

static void quiet(exr_const_context_t core, exr_result_t code, const char *message)
{
    (void)core, (void)code, (void)message;
}

exr_context_initializer_t context(void)
{
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = quiet;
    return init;
}

// ---- files made with Core alone ----

// Bits of a finite, ordinary value of the type.
static uint32_t value(exr_pixel_type_t type, uint32_t r)
{
    if (type == EXR_PIXEL_HALF)
        return (r & 0x8000u) | (r & 0x7fffu) % 0x7000u;
    if (type == EXR_PIXEL_FLOAT)
        return hf_bits((float)(r % 100000) * 0.001f + 1.0f);
    return r;
}

static exr_result_t write_chunk(exr_context_t f, int p, exr_chunk_info_t *info)
{
    exr_encode_pipeline_t pipe = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_result_t rv = exr_encoding_initialize(f, p, info, &pipe);
    uint8_t *rows[MAX_CHANNELS] = {0};
    for (int c = 0; c < pipe.channel_count && !rv; c++) {
        exr_coding_channel_info_t *ch = &pipe.channels[c];
        const size_t bytes = (size_t)ch->bytes_per_element, n = (size_t)ch->width * (size_t)ch->height;
        rows[c] = allocate((n + 1) * bytes);
        for (size_t i = 0; i < n; i++) {
            const uint32_t v = value((exr_pixel_type_t)ch->data_type, rnd());
            memcpy(rows[c] + i * bytes, &v, bytes);
        }
        ch->encode_from_ptr = rows[c];
        ch->user_bytes_per_element = (int16_t)bytes;
        ch->user_data_type = ch->data_type;
        ch->user_pixel_stride = (int32_t)bytes;
        ch->user_line_stride = (int32_t)bytes * ch->width;
    }
    if (!rv)
        rv = exr_encoding_choose_default_routines(f, p, &pipe);
    if (!rv)
        rv = exr_encoding_run(f, p, &pipe);
    exr_encoding_destroy(f, &pipe);
    for (int c = 0; c < MAX_CHANNELS; c++)
        free(rows[c]);
    return rv;
}

static exr_result_t write_tiles(exr_context_t f, int p)
{
    int32_t nx = 1, ny = 1, w, h, tw, th;
    exr_result_t rv = exr_get_tile_levels(f, p, &nx, &ny);
    for (int l = 0; l < nx && !rv; l++) {
        rv = exr_get_level_sizes(f, p, l, l, &w, &h);
        if (!rv)
            rv = exr_get_tile_sizes(f, p, l, l, &tw, &th);
        for (int t = 0; !rv && t < ((w - 1) / tw + 1) * ((h - 1) / th + 1); t++) {
            exr_chunk_info_t info = {0};
            rv = exr_write_tile_chunk_info(f, p, t % ((w - 1) / tw + 1), t / ((w - 1) / tw + 1), l, l, &info);
            if (!rv)
                rv = write_chunk(f, p, &info);
        }
    }
    return rv;
}

// One sample in every pixel. It is only copied, so its value does not matter.
static exr_result_t write_deep(exr_context_t f, int p, const struct part *part)
{
    int32_t counts[64];
    uint32_t data[64];
    exr_result_t rv = EXR_ERR_SUCCESS;
    for (int y = 0; y < part->height && !rv; y++) {
        for (int x = 0; x < part->width; x++) {
            counts[x] = x + 1;
            data[x] = rnd();
        }
        const uint64_t size = (uint64_t)part->width * 4;
        rv = exr_write_deep_scanline_chunk(f, p, part->y + y, data, size, size, counts, size);
    }
    return rv;
}

static exr_result_t write_part(exr_context_t f, int p, const struct part *part)
{
    int32_t lines;
    exr_result_t rv = EXR_ERR_SUCCESS;
    if (part->storage == EXR_STORAGE_TILED)
        return write_tiles(f, p);
    if (part->storage == EXR_STORAGE_DEEP_SCANLINE)
        return write_deep(f, p, part);
    exr_get_scanlines_per_chunk(f, p, &lines);
    const int n = (part->height - 1) / lines + 1;
    for (int i = 0; i < n && !rv; i++) {
        exr_chunk_info_t info = {0};
        rv = exr_write_scanline_chunk_info(f, p, part->y + i * lines, &info);
        if (!rv)
            rv = write_chunk(f, p, &info);
    }
    return rv;
}

static void add_attributes(exr_context_t f, int p, const struct part *part, const char *views)
{
    const exr_attr_preview_t preview = {.width = 2, .height = 1, .rgba = (const uint8_t *)"12345678"};
    const char *names[2] = {views, views ? strchr(views, 0) + 1 : NULL};
    if (part->view)
        exr_attr_set_string(f, p, "view", part->view);
    if (views)
        exr_attr_set_string_vector(f, p, "multiView", 2, names);
    exr_attr_set_float(f, p, "focus", 3.5f);
    exr_attr_set_float(f, p, "aperture", 2.8f);
    exr_attr_set_preview(f, p, "preview", &preview);
    exr_attr_set_user(f, p, "our own", "nobodyKnows", 5, "\0\1\2\3\4");
}

exr_result_t make_exr(const char *path, const struct part *parts, const char *views)
{
    exr_context_initializer_t init = context();
    const exr_attr_box2i_t display = {.min = {.x = -2, .y = 1}, .max = {.x = 20, .y = 30}};
    const exr_attr_v2f_t center = {.x = 0.25f, .y = -0.5f};
    exr_context_t f;
    exr_result_t rv = exr_start_write(&f, path, EXR_WRITE_FILE_DIRECTLY, &init);
    bool deep = false;
    for (int p = 0; p < MAX_PARTS && parts[p].width; p++)
        deep |= parts[p].storage == EXR_STORAGE_DEEP_SCANLINE;
    for (int p = 0; p < MAX_PARTS && parts[p].width && !rv; p++) {
        const struct part *part = &parts[p];
        const exr_attr_box2i_t data = {.min = {.x = part->x, .y = part->y},
                                       .max = {.x = part->x + part->width - 1, .y = part->y + part->height - 1}};
        int index;
        rv = exr_add_part(f, part->name ? part->name : "part", part->storage, &index);
        if (!rv)
            rv = exr_initialize_required_attr(f, p, &display, &data, 1.5f, &center, 0.75f, part->order,
                                              part->compression);
        if (!rv && part->storage == EXR_STORAGE_TILED)
            rv = exr_set_tile_descriptor(f, p, 8, 5, part->levels, EXR_TILE_ROUND_DOWN);
        for (int c = 0; c < MAX_CHANNELS && part->channels[c].name && !rv; c++) {
            const struct channel *ch = &part->channels[c];
            const int s = ch->sampling ? ch->sampling : 1;
            rv = exr_add_channel(f, p, ch->name, ch->type, EXR_PERCEPTUALLY_LOGARITHMIC, s, s);
        }
        if (!rv && deep)  // Core 3.1 then needs the version in every part
            rv = exr_set_version(f, p, 1);
        add_attributes(f, p, part, views);
    }
    if (!rv)
        rv = exr_write_header(f);
    for (int p = 0; p < MAX_PARTS && parts[p].width && !rv; p++)
        rv = write_part(f, p, &parts[p]);
    const exr_result_t end = exr_finish(&f);
    return rv ? rv : end;
}

// ---- comparing ----

uint8_t *slurp(const char *path, size_t *size)
{
    FILE *f = fopen(path, "rb");
    struct stat st;
    if (!f || fstat(fileno(f), &st)) {
        *size = 0;
        return allocate(1);
    }
    uint8_t *data = allocate((size_t)st.st_size);
    *size = fread(data, 1, (size_t)st.st_size, f);
    fclose(f);
    return data;
}

void spill(const char *path, const void *data, size_t size)
{
    FILE *f = fopen(path, "wb");
    if (f) {
        fwrite(data, 1, size, f);
        fclose(f);
    }
}

// The end of the header: names, types and sizes up to an empty name, once per part, and once more in multi-part files.
size_t header_size(const uint8_t *d, size_t size)
{
    const bool multi = d[5] & 0x10;
    size_t at = 8;
    while (at < size) {
        while (at < size && d[at]) {
            uint32_t n;
            at += strlen((const char *)d + at) + 1;
            at += strlen((const char *)d + at) + 1;
            memcpy(&n, d + at, 4);
            at += 4 + n;
        }
        at++;
        if (!multi || (at < size && !d[at]))
            return at + multi;
    }
    return size;
}

// Whether the last chunk of the first part stands before the first.
bool runs_backwards(const char *path, int chunks)
{
    size_t size;
    uint8_t *d = slurp(path, &size);
    uint64_t *table = allocate((size_t)chunks * 8);
    memcpy(table, d + header_size(d, size), (size_t)chunks * 8);
    const bool backwards = table[0] > table[chunks - 1];
    free(table);
    free(d);
    return backwards;
}

// Core 3.1 writes chunks from the top for any line order; this reverses a single-part file.
void turn_round(const char *path, int chunks)
{
    size_t size;
    uint8_t *d = slurp(path, &size), *out = allocate(size);
    const size_t head = header_size(d, size), n = (size_t)chunks;
    uint64_t *table = allocate(8 * n + 8), at = head + 8 * n;
    memcpy(table, d + head, 8 * n);
    table[n] = size;
    memcpy(out, d, head);
    for (size_t i = n; i-- > 0;) {
        memcpy(out + at, d + table[i], table[i + 1] - table[i]);
        memcpy(out + head + 8 * i, &at, 8);
        at += table[i + 1] - table[i];
    }
    spill(path, out, size);
    free(table);
    free(out);
    free(d);
}

// All samples of a channel, unpacked by Core. NULL for deep and mipmapped parts.
uint8_t *load_channel(exr_context_t f, int p, int c, size_t *size)
{
    exr_attr_box2i_t dw;
    exr_storage_t storage;
    exr_decode_pipeline_t pipe = EXR_DECODE_PIPELINE_INITIALIZER;
    int32_t chunks = 0, lines = 1, tw = 0, th = 0;
    exr_get_data_window(f, p, &dw);
    exr_get_storage(f, p, &storage);
    exr_get_chunk_count(f, p, &chunks);
    exr_get_scanlines_per_chunk(f, p, &lines);
    if (storage == EXR_STORAGE_TILED)
        exr_get_tile_sizes(f, p, 0, 0, &tw, &th);
    const size_t w = (size_t)(dw.max.x - dw.min.x + 1), h = (size_t)(dw.max.y - dw.min.y + 1);
    uint8_t *data = allocate(*size = w * h * 4);
    exr_result_t rv = EXR_ERR_SUCCESS;
    for (int i = 0; i < chunks && !rv; i++) {
        exr_chunk_info_t info;
        const int nx = tw ? ((int)w - 1) / tw + 1 : 1;
        rv = tw ? exr_read_tile_chunk_info(f, p, i % nx, i / nx, 0, 0, &info)
                : exr_read_scanline_chunk_info(f, p, dw.min.y + i * lines, &info);
        if (!rv)
            rv = exr_decoding_initialize(f, p, &info, &pipe);
        if (rv)
            break;
        exr_coding_channel_info_t *ch = &pipe.channels[c];
        const size_t x0 = tw ? (size_t)(info.start_x * tw) : 0;
        const size_t y0 = tw ? (size_t)(info.start_y * th) : (size_t)(info.start_y - dw.min.y);
        ch->decode_to_ptr = data + (y0 / (size_t)ch->y_samples * w + x0) * (size_t)ch->bytes_per_element;
        ch->user_bytes_per_element = ch->bytes_per_element;
        ch->user_data_type = ch->data_type;
        ch->user_pixel_stride = ch->bytes_per_element;
        ch->user_line_stride = (int32_t)w * ch->bytes_per_element;
        rv = exr_decoding_choose_default_routines(f, p, &pipe);
        if (!rv)
            rv = exr_decoding_run(f, p, &pipe);
        exr_decoding_destroy(f, &pipe);
    }
    CHECK_MSG(!rv, "Core cannot read part %d: %s", p, exr_get_error_code_as_string(rv));
    return data;
}

bool lossy(exr_compression_t c)
{
    return c >= EXR_COMPRESSION_PXR24;
}

static bool replaced(const struct hf_io_file *f, const struct hf_io_result *r, int n, int part, const char *name)
{
    for (int i = 0; i < n; i++)
        for (int k = 0; k < 4; k++)
            if (hf_io_view(f, r[i].view)->part == part && r[i].planes[k] &&
                !strcmp(hf_io_view(f, r[i].view)->colour[k], name))
                return true;
    return false;
}

// Check that every channel that was not replaced has the same bits in both files.
void compare_channels(const char *a, const char *b, const struct hf_io_file *f, const struct hf_io_result *r, int n)
{
    exr_context_initializer_t init = context();
    exr_context_t fa, fb;
    int parts = 0;
    if (!CHECK_MSG(!exr_start_read(&fa, a, &init), "Core cannot open %s", a))
        return;
    if (!CHECK_MSG(!exr_start_read(&fb, b, &init), "Core cannot open %s", b))
        return;
    exr_get_count(fa, &parts);
    for (int p = 0; p < parts; p++) {
        const exr_attr_chlist_t *list;
        exr_storage_t storage;
        exr_compression_t ca, cb;
        exr_get_channels(fa, p, &list);
        exr_get_storage(fa, p, &storage);
        exr_get_compression(fa, p, &ca);
        exr_get_compression(fb, p, &cb);
        if (storage >= EXR_STORAGE_DEEP_SCANLINE || lossy(ca) || lossy(cb))
            continue;
        for (int c = 0; c < list->num_channels; c++) {
            size_t sa, sb;
            if (replaced(f, r, n, p, list->entries[c].name.str))
                continue;
            uint8_t *da = load_channel(fa, p, c, &sa), *db = load_channel(fb, p, c, &sb);
            CHECK_MSG(sa == sb && !memcmp(da, db, sa), "%s: channel %s of part %d changed", b,
                      list->entries[c].name.str, p);
            free(da);
            free(db);
        }
    }
    exr_finish(&fa);
    exr_finish(&fb);
}

void compare_headers(const char *a, const char *b)
{
    size_t na, nb;
    uint8_t *da = slurp(a, &na), *db = slurp(b, &nb);
    const size_t ha = na ? header_size(da, na) : 0, hb = nb ? header_size(db, nb) : 0;
    CHECK_MSG(ha && ha == hb && !memcmp(da, db, ha), "%s: header changed (%zu and %zu bytes)", b, ha, hb);
    free(da);
    free(db);
}

int files_in(const char *dir)
{
    int n = 0;
    DIR *d = opendir(dir);
    for (const struct dirent *e; d && (e = readdir(d));)
        n += strcmp(e->d_name, ".") && strcmp(e->d_name, "..");
    if (d)
        closedir(d);
    return n;
}
