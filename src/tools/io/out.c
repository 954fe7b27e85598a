// SPDX-License-Identifier: BSD-3-Clause
#include "tools/io/out.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/io/temp.h"

enum { HF_OUT_BUFFER = 1 << 18 };

static int write_error(const struct hf_out *o, struct hf_io_error *err)
{
    return hf_io_fail(err, "%s: cannot write: %s", o->path, strerror(errno));
}

static void free_all(struct hf_out *o)
{
    hf_temp_forget(o->temp);
    free(o->target);
    free(o->buffer);
    o->temp = o->target = NULL;
    o->buffer = NULL;
}

// The target of a symbolic link, relative to the folder of the link. To be freed; NULL: not a link.
static char *link_target(const char *path)
{
    char text[PATH_MAX], *joined;
    const ssize_t n = readlink(path, text, sizeof(text) - 1);
    const char *slash = strrchr(path, '/');
    if (n <= 0)
        return NULL;
    text[n] = 0;
    const int folder = slash && text[0] != '/' ? (int)(slash - path + 1) : 0;
    return asprintf(&joined, "%.*s%s", folder, path, text) < 0 ? NULL : joined;
}

char *hf_out_resolve(const char *path)
{
    char *at = realpath(path, NULL);
    if (at)
        return at;
    at = strdup(path);
    for (int i = 0; i < 40 && at; i++) {
        char *next = link_target(at);
        if (!next)
            break;
        free(at);
        at = next;
    }
    struct stat st;
    if (at && !lstat(at, &st) && S_ISLNK(st.st_mode)) {  // the links form a circle
        free(at);
        return NULL;
    }
    // Links in the folder's path are resolved too, so that two names of one file become one.
    const char *slash = at ? strrchr(at, '/') : NULL;
    char *folder = !at ? NULL : slash ? strndup(at, (size_t)(slash - at + 1)) : strdup(".");
    char *real = folder ? realpath(folder, NULL) : NULL, *joined = NULL;
    if (real && asprintf(&joined, "%s/%s", strcmp(real, "/") ? real : "", slash ? slash + 1 : at) > 0) {
        free(at);
        at = joined;
    }
    free(real);
    free(folder);
    return at;
}

// Give the new file the mode and owner of the replaced one, as if that had been written in place.
static void keep_owner(struct hf_out *o, int fd, const struct stat *st)
{
    struct stat made;
    if (fstat(fd, &made))
        return;
    if ((made.st_uid != st->st_uid || made.st_gid != st->st_gid) && fchown(fd, st->st_uid, st->st_gid) &&
        (made.st_gid == st->st_gid || fchown(fd, (uid_t)-1, st->st_gid) || made.st_uid != st->st_uid))
        snprintf(o->note, sizeof(o->note), "%s: it belonged to user %ld, group %ld, which could not be kept", o->path,
                 (long)st->st_uid, (long)st->st_gid);
    if ((made.st_mode & 07777) != (st->st_mode & 07777) && fchmod(fd, st->st_mode & 07777) && !o->note[0])
        snprintf(o->note, sizeof(o->note), "%s: its mode %03o could not be kept", o->path,
                 (unsigned)st->st_mode & 07777);
}

int hf_out_check(const char *path, struct hf_io_error *err)
{
    struct stat st;
    // Renaming over a device or a pipe would replace it instead of writing to it.
    if (stat(path, &st) == 0 && !S_ISREG(st.st_mode))
        return hf_io_fail(err, "%s: cannot write: not a regular file", path);
    return 0;
}

int hf_out_open(struct hf_out *o, const char *path, struct hf_io_error *err)
{
    struct stat st;
    memset(o, 0, sizeof(*o));
    o->fd = -1;
    o->path = path;
    const bool there = stat(path, &st) == 0;
    if (hf_out_check(path, err))
        return -1;
    o->target = hf_out_resolve(path);
    if (!o->target)
        return hf_io_fail(err, "%s: cannot write: out of memory, or its links go round", path);
    o->buffer = malloc(HF_OUT_BUFFER);
    if (!o->buffer)
        return hf_io_fail(err, "%s: out of memory", path);
    // A private file must never be readable by others, not even while it grows.
    o->fd = hf_temp_create(o->target, there ? st.st_mode & 0600 : 0666, &o->temp);
    if (o->fd < 0)
        return hf_io_fail(err, "%s: cannot create a file there: %s", path, strerror(errno));
    if (there)
        keep_owner(o, o->fd, &st);
    return 0;
}

// Write all of it, at a place in the file or, if at is -1, at the end.
static int write_fd(int fd, const uint8_t *data, size_t size, off_t at)
{
    while (size) {
        const ssize_t n = at < 0 ? write(fd, data, size) : pwrite(fd, data, size, at);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return -1;
        data += n;
        size -= (size_t)n;
        at += at < 0 ? 0 : n;
    }
    return 0;
}

static int flush(struct hf_out *o)
{
    const size_t used = o->used;
    o->used = 0;
    return write_fd(o->fd, o->buffer, used, -1);
}

int hf_out_write(struct hf_out *o, const void *data, size_t size, struct hf_io_error *err)
{
    const uint8_t *from = data;
    while (size) {
        const size_t room = HF_OUT_BUFFER - o->used, n = size < room ? size : room;
        // Data that would fill the buffer alone are written directly.
        if (!o->used && size >= HF_OUT_BUFFER)
            return write_fd(o->fd, from, size, -1) ? write_error(o, err) : 0;
        memcpy(o->buffer + o->used, from, n);
        o->used += n;
        from += n;
        size -= n;
        if (o->used == HF_OUT_BUFFER && flush(o))
            return write_error(o, err);
    }
    return 0;
}

int hf_out_patch(struct hf_out *o, uint64_t at, const void *data, size_t size, struct hf_io_error *err)
{
    return flush(o) || write_fd(o->fd, data, size, (off_t)at) ? write_error(o, err) : 0;
}

// Some file systems cannot sync and say so; that is not a write error.
static int sync_fd(int fd)
{
    return fsync(fd) && errno != EINVAL && errno != ENOTSUP ? -1 : 0;
}

// Get the error that close() would report while the file stays open, and therefore locked: network disks report errors
// only then.
static int close_copy(int fd)
{
    const int copy = dup(fd);
    return copy < 0 || close(copy) ? -1 : 0;
}

int hf_out_commit(struct hf_out *o, struct hf_io_error *err)
{
    if (flush(o) || (!o->unsynced && sync_fd(o->fd)) || close_copy(o->fd))
        return write_error(o, err);
    // The lock is still held, so no process takes the file for one whose writer has died.
    if (rename(o->temp, o->target))
        return hf_io_fail(err, "%s: cannot rename the finished file: %s", o->path, strerror(errno));
    close(o->fd);
    o->fd = -1;
    free_all(o);
    return 0;
}

void hf_out_abort(struct hf_out *o)
{
    if (o->temp)
        unlink(o->temp);
    if (o->fd >= 0)
        close(o->fd);
    free_all(o);
    memset(o, 0, sizeof(*o));
    o->fd = -1;
}
