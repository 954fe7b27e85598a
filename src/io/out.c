// SPDX-License-Identifier: BSD-3-Clause
#include "io/out.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/picture.h"

static int write_error(const struct hf_out *o, struct hf_io_error *err)
{
    return hf_io_fail(err, "%s: cannot write: %s", o->path, strerror(errno));
}

enum { HOST_LENGTH = 32 };
#define TEMP_PREFIX ".hyperfocal-"

// This machine's name, as far as it can stand in a file's name between dashes.
static const char *host_name(char buf[HOST_LENGTH + 1])
{
    if (gethostname(buf, HOST_LENGTH + 1))
        buf[0] = 0;
    buf[HOST_LENGTH] = 0;
    for (char *c = buf; *c; c++)
        if (!isalnum((unsigned char)*c) && *c != '.')
            *c = '_';
    return buf[0] ? buf : "_";
}

// A fresh name beside the target: short, because the target's own may already be as long as names get. Machine and
// process are in it, so that two that write to one folder do not meet, and what a dead one left is known.
static char *temp_name(const char *target)
{
    static atomic_uint counter;
    char host[HOST_LENGTH + 1];
    const char *slash = strrchr(target, '/');
    const char *ext = hf_io_extension(target);
    const int folder = slash ? (int)(slash - target + 1) : 0;
    char *name;
    if (strlen(ext) > 16)
        ext = "";
    if (asprintf(&name, "%.*s" TEMP_PREFIX "%s-%ld-%u%s%s", folder, target, host_name(host), (long)getpid(),
                 atomic_fetch_add(&counter, 1), *ext ? "." : "", ext) < 0)
        return NULL;
    return name;
}

enum hf_out_owner hf_out_owner_of(const char *name, long *pid)
{
    char host[HOST_LENGTH + 1], *end;
    if (strncmp(name, TEMP_PREFIX, strlen(TEMP_PREFIX)))
        return HF_OUT_NOT_OURS;
    const char *theirs = name + strlen(TEMP_PREFIX), *dash = strchr(theirs, '-');
    if (!dash || !isdigit((unsigned char)dash[1]))
        return HF_OUT_NOT_OURS;
    errno = 0;
    *pid = strtol(dash + 1, &end, 10);
    if (errno || *pid < 1 || *end != '-' || !isdigit((unsigned char)end[1]))
        return HF_OUT_NOT_OURS;
    const char *own = host_name(host);
    return strlen(own) == (size_t)(dash - theirs) && !memcmp(own, theirs, strlen(own)) ? HF_OUT_THIS_HOST
                                                                                       : HF_OUT_OTHER_HOST;
}

// O_EXCL: never follows or overwrites what somebody else put there.
static int create_temp(struct hf_out *o)
{
    for (int i = 0; i < 1000; i++) {
        free(o->temp);
        o->temp = temp_name(o->target);
        if (!o->temp)
            return -1;
        const int fd = open(o->temp, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd >= 0 || errno != EEXIST)
            return fd;
    }
    return -1;
}

int hf_out_open(struct hf_out *o, const char *path, struct hf_io_error *err)
{
    struct stat st;
    memset(o, 0, sizeof(*o));
    o->path = path;
    // Renaming over a device or a pipe would replace it rather than write to it.
    if (stat(path, &st) == 0 && !S_ISREG(st.st_mode))
        return hf_io_fail(err, "%s: cannot write: not a regular file", path);
    o->target = realpath(path, NULL);
    if (!o->target)
        o->target = strdup(path);
    if (!o->target)
        return hf_io_fail(err, "%s: out of memory", path);
    const int fd = create_temp(o);
    if (fd < 0) {
        const int code = errno;
        free(o->temp);  // not ours to remove
        o->temp = NULL;
        return hf_io_fail(err, "%s: cannot create a file there: %s", path, strerror(code));
    }
    o->f = fdopen(fd, "wb");
    if (!o->f) {
        close(fd);
        return hf_io_fail(err, "%s: out of memory", path);
    }
    setvbuf(o->f, NULL, _IOFBF, 1 << 18);
    return 0;
}

int hf_out_write(struct hf_out *o, const void *data, size_t size, struct hf_io_error *err)
{
    if (size && fwrite(data, 1, size, o->f) != size)
        return write_error(o, err);
    return 0;
}

int hf_out_seek(struct hf_out *o, uint64_t offset, struct hf_io_error *err)
{
    if (fseeko(o->f, (off_t)offset, SEEK_SET))
        return write_error(o, err);
    return 0;
}

// Some file systems cannot sync and say so; that is no failure to write.
static int sync_fd(int fd)
{
    return fsync(fd) && errno != EINVAL && errno != ENOTSUP ? -1 : 0;
}

static int finish(struct hf_out *o)
{
    const bool bad = fflush(o->f) || sync_fd(fileno(o->f));
    const int code = errno;
    FILE *f = o->f;
    o->f = NULL;
    if (fclose(f))
        return -1;
    errno = code;
    return bad ? -1 : 0;
}

int hf_out_commit(struct hf_out *o, struct hf_io_error *err)
{
    if (finish(o))
        return write_error(o, err);
    if (rename(o->temp, o->target))
        return hf_io_fail(err, "%s: cannot rename the finished file: %s", o->path, strerror(errno));
    free(o->temp);
    o->temp = NULL;
    hf_out_abort(o);
    return 0;
}

void hf_out_abort(struct hf_out *o)
{
    if (o->f)
        fclose(o->f);
    if (o->temp)
        unlink(o->temp);
    free(o->temp);
    free(o->target);
    memset(o, 0, sizeof(*o));
}
