// SPDX-License-Identifier: BSD-3-Clause
// libpng, as OpenImageIO drives it, prints to stderr when a file is damaged. Looking at the checksums first keeps it
// from seeing one.
#include <string.h>
#include <unistd.h>

#include "io/oiio/oiio.h"

// CRC-32 as PNG has it, four bits at a time.
static uint32_t crc32_of(uint32_t crc, const uint8_t *data, size_t size)
{
    static const uint32_t table[16] = {
        0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac, 0x76dc4190, 0x6b6b51f4, 0x4db26158, 0x5005713c,
        0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c, 0x9b64c2b0, 0x86d3d2d4, 0xa00ae278, 0xbdbdf21c,
    };
    for (size_t i = 0; i < size; i++) {
        crc ^= data[i];
        crc = crc >> 4 ^ table[crc & 15];
        crc = crc >> 4 ^ table[crc & 15];
    }
    return crc;
}

static uint32_t big_endian(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

// One chunk: length, type, data, checksum of type and data. Returns its whole size, or 0.
static uint64_t check_chunk(int fd, uint64_t at, bool *last)
{
    uint8_t head[8], buf[16384];
    if (pread(fd, head, 8, (off_t)at) != 8)
        return 0;
    const uint64_t size = big_endian(head);
    uint32_t crc = crc32_of(0xffffffffu, head + 4, 4);
    for (uint64_t done = 0; done < size;) {
        const size_t n = size - done < sizeof(buf) ? (size_t)(size - done) : sizeof(buf);
        if (pread(fd, buf, n, (off_t)(at + 8 + done)) != (ssize_t)n)
            return 0;
        crc = crc32_of(crc, buf, n);
        done += n;
    }
    if (pread(fd, buf, 4, (off_t)(at + 8 + size)) != 4 || big_endian(buf) != ~crc)
        return 0;
    *last = !memcmp(head + 4, "IEND", 4);
    return 12 + size;
}

int hf_io_check_png(const char *path, int fd, struct hf_io_error *err)
{
    static const uint8_t magic[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    uint8_t first[8];
    bool last = false;
    uint64_t at = 8;
    const ssize_t n = pread(fd, first, 8, 0);
    if (n < 4 || memcmp(first, magic, 4))
        return 0;  // not a PNG at all
    if (n < 8 || memcmp(first, magic, 8))
        return hf_io_fail(err, "%s: truncated or corrupt: not a PNG file beyond its first bytes", path);
    while (!last) {
        const uint64_t size = check_chunk(fd, at, &last);
        if (!size)
            return hf_io_fail(err, "%s: truncated or corrupt: the PNG chunk at byte %llu is damaged", path,
                              (unsigned long long)at);
        at += size;
    }
    return 0;
}
