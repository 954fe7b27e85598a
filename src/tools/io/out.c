// SPDX-License-Identifier: BSD-3-Clause
#include "tools/io/out.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "tools/io/picture.h"

static int write_error(const struct hf_out *o, struct hf_io_error *err)
{
    return hf_io_fail(err, "%s: cannot write: %s", o->path, strerror(errno));
}

// ---- temporary files, which a signal must find

enum { LIVE = 64 };  // more than are ever written at a time; those beyond are not known to the handler

static _Atomic(char *) live[LIVE];
static atomic_int creating;  // files that are known, and may or may not be there yet
static atomic_int ending;  // a signal has come: no more are made, and no name is freed that its handler may be reading

static void enter(char *name)
{
    for (int i = 0; i < LIVE; i++) {
        char *none = NULL;
        if (atomic_compare_exchange_strong(&live[i], &none, name))
            return;
    }
}

static void leave(char *name)
{
    for (int i = 0; i < LIVE; i++) {
        char *own = name;
        if (name && atomic_compare_exchange_strong(&live[i], &own, NULL))
            break;
    }
    if (!atomic_load(&ending))
        free(name);
}

// A new file that a signal finds from its first moment on: none comes to this thread in between, and one that comes to
// another thread waits. Fails like open().
static int open_known(char *name, mode_t mode)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    atomic_fetch_add(&creating, 1);
    int fd = -1, code = EINTR;
    if (!atomic_load(&ending)) {
        enter(name);
        // O_EXCL: never follows or overwrites what somebody else put there.
        fd = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        code = errno;
    }
    atomic_fetch_sub(&creating, 1);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    errno = code;
    return fd;
}

void hf_out_end_by_signal(int number)
{
    const struct timespec pause = {.tv_nsec = 1000000};
    atomic_store(&ending, 1);
    for (int i = 0; i < 1000 && atomic_load(&creating); i++)  // a second at most, should a disk hang
        nanosleep(&pause, NULL);
    for (int i = 0; i < LIVE; i++) {
        const char *name = atomic_load(&live[i]);
        if (name)
            unlink(name);
    }
    signal(number, SIG_DFL);
    raise(number);
}

void hf_out_catch_signals(void)
{
    static const int numbers[] = {SIGTERM, SIGINT, SIGHUP};
    for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++) {
        struct sigaction was, ours = {.sa_handler = hf_out_end_by_signal};
        // Who starts us with a signal ignored (nohup) means it.
        if (!sigaction(numbers[i], NULL, &was) && was.sa_handler == SIG_DFL)
            sigaction(numbers[i], &ours, NULL);
    }
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

static void forget_temp(struct hf_out *o)
{
    leave(o->temp);
    o->temp = NULL;
}

static int create_temp(struct hf_out *o, mode_t mode)
{
    for (int i = 0; i < 1000; i++) {
        o->temp = temp_name(o->target);
        if (!o->temp)
            return -1;
        const int fd = open_known(o->temp, mode);
        if (fd >= 0)
            return fd;
        const int code = errno;
        forget_temp(o);  // not ours to remove
        errno = code;
        if (code != EEXIST)
            return -1;
    }
    return -1;
}

// What a symbolic link says, relative to the folder it lies in. To be freed; NULL: no link.
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
    if (at && !lstat(at, &st) && S_ISLNK(st.st_mode)) {  // round and round
        free(at);
        return NULL;
    }
    // The folder's own links, so that two names of one file are one.
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

// A file that is replaced keeps its mode and owner, as it would if it were written in place.
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
    // Renaming over a device or a pipe would replace it rather than write to it.
    if (stat(path, &st) == 0 && !S_ISREG(st.st_mode))
        return hf_io_fail(err, "%s: cannot write: not a regular file", path);
    return 0;
}

int hf_out_open(struct hf_out *o, const char *path, struct hf_io_error *err)
{
    struct stat st;
    memset(o, 0, sizeof(*o));
    o->path = path;
    const bool there = stat(path, &st) == 0;
    if (hf_out_check(path, err))
        return -1;
    o->target = hf_out_resolve(path);
    if (!o->target)
        return hf_io_fail(err, "%s: cannot write: out of memory, or its links go round", path);
    // What was private is never readable by others, not even while it grows.
    const int fd = create_temp(o, there ? st.st_mode & 0600 : 0666);
    if (fd < 0)
        return hf_io_fail(err, "%s: cannot create a file there: %s", path, strerror(errno));
    if (there)
        keep_owner(o, fd, &st);
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

// Some file systems cannot sync and say so; that is no failure to write.
static int sync_fd(int fd)
{
    return fsync(fd) && errno != EINVAL && errno != ENOTSUP ? -1 : 0;
}

static int finish(struct hf_out *o)
{
    const bool bad = fflush(o->f) || (!o->unsynced && sync_fd(fileno(o->f)));
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
    forget_temp(o);
    free(o->target);
    o->target = NULL;
    return 0;
}

void hf_out_abort(struct hf_out *o)
{
    if (o->f)
        fclose(o->f);
    if (o->temp)
        unlink(o->temp);
    forget_temp(o);
    free(o->target);
    memset(o, 0, sizeof(*o));
}
