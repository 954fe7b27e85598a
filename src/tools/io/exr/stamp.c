// SPDX-License-Identifier: BSD-3-Clause
// Texts in a header that is otherwise copied byte for byte.
#include <stdlib.h>
#include <string.h>

#include "tools/io/exr/exr.h"

enum { MAGIC_AND_VERSION = 8 };

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
    size_t room = *size;
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
    memcpy(to, header + at, *size - at);
    *size = (size_t)(to - stamped) + (*size - at);
    return stamped;
}
