// SPDX-License-Identifier: BSD-3-Clause
// Cryptomatte, after its specification 1.2.0: attributes cryptomatte/KEY/name and /manifest or /manif_file, layers NAME00,
// NAME01 ... with two pairs of an object's number and its coverage each. A number is the 32-bit MurmurHash3 of the object's
// name, as the bits of a float.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/common/nearest.h"
#include "tools/io/exr/exr.h"
#include "tools/io/file.h"

enum { KEY = 64, MOST_LAYERS = 16, MOST_MANIFEST = 1 << 26 };

struct matte {
    char key[KEY];
    char name[256];  // of its layers, without their number
    char *manifest;  // JSON, {"name":"1a2b3c4d", ...}; NULL: none
};

// What to look for, and what was found besides.
struct search {
    const struct hf_io_file *file;
    const char *object;
    struct matte found;
    uint32_t id;
    int mattes, listed;
    char names[256];  // some of the objects
    struct tool_nearest nearest;
    char near[128];
};

static uint32_t rotate(uint32_t v, int by)
{
    return v << by | v >> (32 - by);
}

// A number as the pixels hold it: its bits are those of a normal float. Manifests by Blender have it as it was before.
static uint32_t normal(uint32_t id)
{
    const uint32_t exponent = id >> 23 & 255;
    return exponent == 0 || exponent == 255 ? id ^ 1u << 23 : id;
}

// MurmurHash3_x86_32 with seed 0 (Appleby, public domain).
static uint32_t id_of(const char *name)
{
    const size_t n = strlen(name);
    const unsigned char *bytes = (const unsigned char *)name;
    uint32_t h = 0;
    for (size_t i = 0; i < n; i += 4) {
        uint32_t k = 0;
        for (size_t j = 0; j < 4 && i + j < n; j++)
            k |= (uint32_t)bytes[i + j] << (8 * j);
        h ^= rotate(k * 0xcc9e2d51u, 15) * 0x1b873593u;
        if (i + 4 <= n)
            h = rotate(h, 13) * 5 + 0xe6546b64u;
    }
    h ^= (uint32_t)n;
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    return h ^ h >> 16;
}

// The text of an attribute of a part, to be freed; NULL: none.
static char *text_of(const struct hf_exr *e, int part, const char *key, const char *what)
{
    char name[128];
    const char *text = NULL;
    int32_t length = 0;
    snprintf(name, sizeof(name), "cryptomatte/%s/%s", key, what);
    if (exr_attr_get_string(e->core, part, name, &length, &text) != EXR_ERR_SUCCESS || !text || length < 0)
        return NULL;
    return strndup(text, (size_t)length);
}

// A manifest that is a file beside the picture's.
static char *read_beside(const char *path, const char *name)
{
    char *full = NULL, *text = NULL;
    const char *slash = strrchr(path, '/');
    const int folder = name[0] == '/' || !slash ? 0 : (int)(slash - path) + 1;
    if (asprintf(&full, "%.*s%s", folder, path, name) < 0)
        return NULL;
    FILE *f = fopen(full, "re");
    free(full);
    const long size = f && !fseek(f, 0, SEEK_END) ? ftell(f) : -1;
    if (size > 0 && size < MOST_MANIFEST && !fseek(f, 0, SEEK_SET))
        text = calloc((size_t)size + 1, 1);
    if (text && fread(text, 1, (size_t)size, f) != (size_t)size)
        text[0] = '\0';
    if (f)
        fclose(f);
    return text;
}

// The next text in quotes, cut off at size; returns what follows it, or NULL at the end.
static const char *next_text(const char *json, char *text, size_t size)
{
    size_t n = 0;
    json = strchr(json, '"');
    for (json = json ? json + 1 : NULL; json && *json != '"'; json++) {
        if (*json == '\\' && json[1])
            json++;
        if (!*json)
            return NULL;
        if (n + 1 < size)
            text[n++] = *json;
    }
    text[n] = '\0';
    return json ? json + 1 : NULL;
}

// Look for the object in a manifest. Returns 1 if it is there, with its number.
static int in_manifest(struct search *s, const char *json)
{
    char name[128], number[32];
    while ((json = next_text(json, name, sizeof(name))) && (json = next_text(json, number, sizeof(number)))) {
        if (!strcmp(name, s->object)) {
            s->id = (uint32_t)strtoul(number, NULL, 16);
            return 1;
        }
        if (s->listed++ < 8)
            hf_io_list(s->names, sizeof(s->names), NULL, name, "");
        tool_nearest_try(&s->nearest, name, (int)strlen(name), s->object);
        if (s->nearest.word == name) {
            snprintf(s->near, sizeof(s->near), "%s", name);
            s->nearest.word = s->near;
        }
    }
    return 0;
}

// Look at one Cryptomatte. Returns 1 if it has the object.
static int try_matte(struct search *s, int part, const char *key)
{
    const struct hf_exr *e = s->file->exr;
    char *name = text_of(e, part, key, "name"), *manifest = text_of(e, part, key, "manifest");
    char *beside = manifest ? NULL : text_of(e, part, key, "manif_file");
    if (beside)
        manifest = read_beside(s->file->path, beside);
    s->mattes += name != NULL;
    const int has = name && manifest && in_manifest(s, manifest);
    // Without a manifest the name's hash is the number.
    if (has || (name && !manifest && !s->found.name[0])) {
        snprintf(s->found.name, sizeof(s->found.name), "%s", name);
        s->id = normal(has ? s->id : id_of(s->object));
    }
    free(name);
    free(manifest);
    free(beside);
    return has;
}

static void find_matte(struct search *s)
{
    static const char begin[] = "cryptomatte/", end[] = "/name";
    const struct hf_exr *e = s->file->exr;
    for (int p = 0; p < e->part_count; p++) {
        int32_t count = 0;
        exr_get_attribute_count(e->core, p, &count);
        for (int32_t i = 0; i < count; i++) {
            const exr_attribute_t *a = NULL;
            char key[KEY];
            if (exr_get_attribute_by_index(e->core, p, EXR_ATTR_LIST_FILE_ORDER, i, &a) != EXR_ERR_SUCCESS ||
                strncmp(a->name, begin, strlen(begin)))
                continue;
            const char *middle = a->name + strlen(begin), *tail = strrchr(middle, '/');
            if (!tail || strcmp(tail, end))
                continue;
            snprintf(key, sizeof(key), "%.*s", (int)(tail - middle), middle);
            if (try_matte(s, p, key))
                return;
        }
    }
}

// The channel of a layer by its letter, in any part: NAME00.r, NAME00.R, NAME00.red. Returns 0, or -1.
static int find_plane(const struct hf_exr *e, const char *layer, int letter, struct hf_exr_plane *plane)
{
    static const char *const names[4][3] = {
        {"r", "R", "red"}, {"g", "G", "green"}, {"b", "B", "blue"}, {"a", "A", "alpha"}};
    for (int p = 0; p < e->part_count; p++)
        for (int i = 0; i < 3; i++) {
            char name[300];
            const int own = e->part_count > 1 && !strcmp(e->parts[p].name, layer);
            snprintf(name, sizeof(name), "%s.%s", layer, names[letter][i]);
            plane->part = p;
            plane->channel = hf_exr_find_channel(&e->parts[p], name);
            if (plane->channel < 0 && own)
                plane->channel = hf_exr_find_channel(&e->parts[p], names[letter][i]);
            if (plane->channel >= 0)
                return 0;
        }
    return -1;
}

// Add the coverage that a layer has of the number.
static int add_layer(struct hf_io_file *file, const struct hf_io_view *v, const struct hf_exr_plane found[4],
                     uint32_t id, float *coverage, struct hf_io_error *err)
{
    const size_t n = (size_t)v->width * (size_t)v->height;
    float *memory = calloc(4 * n, sizeof(float));
    struct hf_exr_plane planes[4];
    int status = memory ? 0 : hf_io_fail(err, "%s: out of memory", file->path);
    for (int k = 0; k < 4 && memory; k++)
        planes[k] =
            (struct hf_exr_plane){found[k].part, found[k].channel, false, v->data_window, memory + (size_t)k * n};
    if (!status)
        status = hf_exr_decode(file->exr, planes, 4, NULL, err);
    for (int k = 0; k < 4 && !status; k += 2)
        for (size_t i = 0; i < n; i++) {
            uint32_t bits;
            memcpy(&bits, &planes[k].to[i], sizeof(bits));
            if (bits == id)
                coverage[i] += planes[k + 1].to[i];
        }
    free(memory);
    return status;
}

int hf_io_read_object(struct hf_io_file *file, int view, const char *object, float *coverage, struct hf_io_error *err)
{
    struct search s = {.file = file, .object = object};
    const struct hf_io_view *v = hf_io_view(file, view);
    int layers = 0, status = 0;
    if (!file->exr || !v)
        return hf_io_fail(err, "%s: only EXR files have a Cryptomatte, which names objects", file->path);
    find_matte(&s);
    if (!s.mattes)
        return hf_io_fail(err, "%s: there is no Cryptomatte, which names objects: no attribute cryptomatte/.../name",
                          file->path);
    if (!s.found.name[0])
        return hf_io_fail(err, "%s: there is no object %s in the Cryptomatte%s%s%s, there %s %s%s", file->path, object,
                          s.near[0] ? " (did you mean " : "", s.near, s.near[0] ? "?)" : "",
                          s.listed == 1 ? "is" : "are", s.names, s.listed > 8 ? " and more" : "");
    memset(coverage, 0, (size_t)v->width * (size_t)v->height * sizeof(float));
    for (; layers < MOST_LAYERS && !status; layers++) {
        struct hf_exr_plane planes[4];
        char layer[270];
        int there = 1;
        snprintf(layer, sizeof(layer), "%s%02d", s.found.name, layers);
        for (int k = 0; k < 4; k++)
            there &= !find_plane(file->exr, layer, k, &planes[k]);
        if (!there)
            break;
        status = add_layer(file, v, planes, s.id, coverage, err);
    }
    if (!layers)
        return hf_io_fail(err, "%s: the Cryptomatte %s has no layers %s00", file->path, s.found.name, s.found.name);
    return status;
}
