// SPDX-License-Identifier: BSD-3-Clause
// What program and helper say to each other, over a socket: a request, what belongs to it, a reply, what belongs to it.
// Both are of one build, so structs travel as they are; the helper's first words on the control socket say whether it is.
#ifndef HF_IO_WIRE_H
#define HF_IO_WIRE_H

#include <errno.h>
#include <stdio.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hyperfocal/version.h"
#include "tools/io/oiio/oiio.h"

enum {
    HF_WIRE_CONTROL = 3,  // the helper's descriptor on which sockets of new jobs arrive
    HF_WIRE_PATH = 4096,
    HF_WIRE_CHANNELS = 256,  // most channels of an EXR part
};

enum { HF_WIRE_HELLO = 64 };

enum hf_wire_op {
    HF_WIRE_OPEN,        // path, name: depth channel
    HF_WIRE_COLOUR,      // planes; the reply is followed by those that there are
    HF_WIRE_DEPTH,       // the reply is followed by the plane
    HF_WIRE_DEPTH_ONLY,  // view, name
    HF_WIRE_FORMAT,      // path
    HF_WIRE_WRITE,       // view, planes, bits, source, name: compression; followed by the planes; then the file
    HF_WIRE_READ,        // samples, part, followed by the names; the reply by the data
    HF_WIRE_MAKE,        // samples, level, name: compression, followed by names and data; the reply by the file
};

struct hf_wire_name {
    char text[256];
    uint8_t type;
};

struct hf_wire_request {
    uint32_t op;
    uint32_t planes;  // bit k: plane k
    int32_t part, bits;
    float level;
    uint32_t has_name;
    char name[256], path[HF_WIRE_PATH], source[HF_WIRE_PATH];
    struct hf_io_view view;
    struct hf_io_samples samples;  // its pointers mean nothing
};

struct hf_wire_reply {
    int32_t status;  // 0 or -1: err
    struct hf_io_error err;
    uint64_t size;  // bytes that follow
    // of HF_WIRE_OPEN
    int32_t has_view, bits, width, height;
    struct hf_io_view view;
    char channels[2048];
};

// What both sides must agree on: the version, and the layout of what travels.
static inline void hf_wire_hello(char hello[HF_WIRE_HELLO])
{
    snprintf(hello, HF_WIRE_HELLO, "%d.%d.%d (%zu, %zu)", HF_VERSION_MAJOR, HF_VERSION_MINOR, HF_VERSION_PATCH,
             sizeof(struct hf_wire_request), sizeof(struct hf_wire_reply));
}

// All of it, or -1: the other side is gone.
static inline int hf_wire_get(int fd, void *data, size_t size)
{
    char *to = (char *)data;
    while (size) {
        const ssize_t n = read(fd, to, size);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return -1;
        to += n;
        size -= (size_t)n;
    }
    return 0;
}

static inline int hf_wire_put(int fd, const void *data, size_t size)
{
    const char *from = (const char *)data;
    while (size) {
        const ssize_t n = send(fd, from, size, MSG_NOSIGNAL);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return -1;
        from += n;
        size -= (size_t)n;
    }
    return 0;
}

#endif
