// SPDX-License-Identifier: BSD-3-Clause
// Texts in a header that is otherwise copied byte for byte, and the checksum among them: the CRC-32 of the whole file, as if
// the checksum's own digits were zeros.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <libdeflate.h>

#include "tools/io/exr/exr.h"

enum { MAGIC_AND_VERSION = 8, DIGITS = 8 };

static const struct hf_io_text no_sum = {HF_EXR_SUM, "00000000"};

// Length of the attribute at `at` (name, type, size, value), 0 at the zero byte that ends the part or when it is cut off.
static size_t attribute_size(const uint8_t *at, size_t left)
{
    const uint8_t *name_end = memchr(at, 0, left);
    if (!name_end || name_end == at)
        return 0;
    const uint8_t *type = name_end + 1, *type_end = memchr(type, 0, left - (size_t)(type - at));
    uint32_t size;
    if (!type_end || left - (size_t)(type_end + 1 - at) < sizeof(size))
        return 0;
    memcpy(&size, type_end + 1, sizeof(size));
    const size_t head = (size_t)(type_end + 1 - at) + sizeof(size);
    return size <= left - head ? head + size : 0;
}

static bool is_one_of(const uint8_t *name, const struct hf_io_text *texts, int count)
{
    if (!strcmp((const char *)name, no_sum.name))
        return true;
    for (int i = 0; i < count; i++)
        if (!strcmp((const char *)name, texts[i].name))
            return true;
    return false;
}

static uint8_t *put_text(uint8_t *to, const struct hf_io_text *text)
{
    static const char type[] = "string";
    const uint32_t size = (uint32_t)strlen(text->value);
    const size_t name = strlen(text->name) + 1;
    memcpy(to, text->name, name);
    memcpy(to + name, type, sizeof(type));
    memcpy(to + name + sizeof(type), &size, sizeof(size));
    memcpy(to + name + sizeof(type) + sizeof(size), text->value, size);
    return to + name + sizeof(type) + sizeof(size) + size;
}

uint8_t *hf_exr_stamp(const uint8_t *header, size_t *size, const struct hf_io_text *texts, int count)
{
    size_t room = *size + strlen(no_sum.name) + DIGITS + 16;
    for (int i = 0; i < count; i++)
        room += strlen(texts[i].name) + strlen(texts[i].value) + 16;
    uint8_t *stamped = malloc(room), *to = stamped;
    if (!stamped)
        return NULL;
    memcpy(to, header, MAGIC_AND_VERSION);
    to += MAGIC_AND_VERSION;
    // The first part's attributes, without those that get another value.
    size_t at = MAGIC_AND_VERSION, n;
    while ((n = attribute_size(header + at, *size - at))) {
        if (!is_one_of(header + at, texts, count)) {
            memcpy(to, header + at, n);
            to += n;
        }
        at += n;
    }
    for (int i = 0; i < count; i++)
        to = put_text(to, &texts[i]);
    to = put_text(to, &no_sum);
    memcpy(to, header + at, *size - at);
    *size = (size_t)(to - stamped) + (*size - at);
    return stamped;
}

// Where the list of a part's channels is, as an attribute; 0: nowhere.
static size_t find_channels(const uint8_t *header, size_t size, int part)
{
    size_t at = MAGIC_AND_VERSION, n;
    for (int p = 0; p <= part; p++, at++)
        for (; (n = attribute_size(header + at, size - at)); at += n)
            if (p == part && !strcmp((const char *)header + at, "channels"))
                return at;
    return 0;
}

uint8_t *hf_exr_list_channel(const uint8_t *header, size_t *size, int part, const char *name)
{
    enum { AFTER_NAME = 16, LONG_NAME = 31, LONG_NAMES = 4 };
    static const size_t head = sizeof("channels") + sizeof("chlist");
    const size_t list = find_channels(header, *size, part), added = strlen(name) + 1 + AFTER_NAME;
    // Type float, not linear to the eye, of full resolution.
    const int32_t entry[AFTER_NAME / 4] = {EXR_PIXEL_FLOAT, 0, 1, 1};
    uint8_t *made = list ? malloc(*size + added) : NULL;
    if (!made)
        return NULL;
    size_t at = list + head + sizeof(uint32_t);
    while (header[at] && strcmp((const char *)header + at, name) < 0)
        at += strlen((const char *)header + at) + 1 + AFTER_NAME;
    memcpy(made, header, at);
    memcpy(made + at, name, strlen(name) + 1);
    memcpy(made + at + strlen(name) + 1, entry, sizeof(entry));
    memcpy(made + at + added, header + at, *size - at);
    uint32_t bytes;
    memcpy(&bytes, header + list + head, sizeof(bytes));
    bytes += (uint32_t)added;
    memcpy(made + list + head, &bytes, sizeof(bytes));
    if (strlen(name) > LONG_NAME)
        made[5] |= LONG_NAMES;  // a flag in the version
    *size += added;
    return made;
}

size_t hf_exr_find_sum(const uint8_t *header, size_t size)
{
    size_t at = MAGIC_AND_VERSION, n;
    if (size < MAGIC_AND_VERSION)
        return 0;
    while ((n = attribute_size(header + at, size - at))) {
        const size_t expected = strlen(no_sum.name) + 1 + sizeof("string") + sizeof(uint32_t) + DIGITS;
        if (!strcmp((const char *)header + at, no_sum.name))
            return n == expected ? at + n - DIGITS : 0;
        at += n;
    }
    return 0;
}

void hf_exr_add_to_sum(uint32_t *sum, const void *data, size_t size)
{
    *sum = libdeflate_crc32(*sum, data, size);
}

void hf_exr_put_sum(uint8_t *digits, uint32_t sum)
{
    char text[DIGITS + 1];
    snprintf(text, sizeof(text), "%08x", (unsigned)sum);
    memcpy(digits, text, DIGITS);
}

int hf_exr_check_sum(const struct hf_exr *e, struct hf_io_error *err)
{
    enum { PIECE = 1 << 18 };
    uint8_t *header = malloc(e->header_size + 1), *piece = malloc(PIECE), digits[DIGITS] = "", found[DIGITS] = "";
    size_t at = 0;
    uint32_t sum = 0;
    int status = header && piece ? 0 : hf_io_fail(err, "%s: out of memory", e->path);
    if (!status && !hf_exr_read_at(e, header, e->header_size, 0))
        at = hf_exr_find_sum(header, e->header_size);
    if (!status && !at)
        status = hf_io_fail(err, "%s: it has no checksum", e->path);
    if (!status) {
        memcpy(found, header + at, DIGITS);
        memcpy(header + at, no_sum.value, DIGITS);
        hf_exr_add_to_sum(&sum, header, e->header_size);
    }
    for (uint64_t from = e->header_size; from < e->size && !status; from += PIECE) {
        const size_t n = e->size - from < PIECE ? (size_t)(e->size - from) : PIECE;
        if (hf_exr_read_at(e, piece, n, from))
            status = hf_io_fail(err, "%s: truncated or corrupt: cannot read at byte %llu", e->path,
                                (unsigned long long)from);
        else
            hf_exr_add_to_sum(&sum, piece, n);
    }
    hf_exr_put_sum(digits, sum);
    if (!status && memcmp(digits, found, DIGITS))
        status = hf_io_fail(err, "%s: damaged: its checksum is %.8s, not %.8s", e->path, digits, found);
    free(header);
    free(piece);
    return status;
}
