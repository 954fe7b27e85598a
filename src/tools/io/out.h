// SPDX-License-Identifier: BSD-3-Clause
// A file being written: it grows under another name beside its target and takes the target's name when it is complete.
// So nobody sees half a picture, and the target may be the file that is being read. An existing target keeps its mode
// and owner. A symbolic link stays a link, and the file that it points to is written.
#ifndef HF_IO_OUT_H
#define HF_IO_OUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tools/io/error.h"

#ifdef __cplusplus
extern "C" {
#endif

struct hf_out {
    const char *path;  // as the user wrote it, for messages; not owned
    char *target;      // path with symbolic links resolved
    char *temp;        // same folder and extension as target
    int fd;            // of temp; -1: not open
    uint8_t *buffer;   // data that is not written yet
    size_t used;
    bool unsynced;             // do not wait for the disk in hf_out_commit
    char note[HF_IO_MESSAGE];  // what could not be kept of the old target, or ""
};

// Returns 0, or -1 with *err filled if path names something other than a regular file.
int hf_out_check(const char *path, struct hf_io_error *err);
// All return 0, or -1 with *err filled; then hf_out_abort must be called (it may always be called).
int hf_out_open(struct hf_out *o, const char *path, struct hf_io_error *err);
int hf_out_write(struct hf_out *o, const void *data, size_t size, struct hf_io_error *err);
// Overwrite bytes that were written before.
int hf_out_patch(struct hf_out *o, uint64_t at, const void *data, size_t size, struct hf_io_error *err);
// Flush to the disk and take the target's place.
int hf_out_commit(struct hf_out *o, struct hf_io_error *err);
// Close and remove what was not committed.
void hf_out_abort(struct hf_out *o);

// The file that writing to path would change: all links are followed, also if the file does not exist yet. To be freed;
// NULL without memory, or if links form a circle.
char *hf_out_resolve(const char *path);

#ifdef __cplusplus
}
#endif

#endif
