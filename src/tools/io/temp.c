// SPDX-License-Identifier: BSD-3-Clause
#include "tools/io/temp.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "tools/io/picture.h"

#define TEMP_PREFIX ".hyperfocal-"

// ---- the temporary files of this process, for signal handlers

enum { LIVE = 64 };  // more than are ever written at once; the handler does not know files beyond these

static _Atomic(char *) live[LIVE];
static atomic_int creating;  // files whose names are in `live` and that may or may not exist yet
static atomic_int
    ending;  // a signal has come: no more files are created, and no name is freed, because the handler may read it

static void enter(char *name)
{
    for (int i = 0; i < LIVE; i++) {
        char *none = NULL;
        if (atomic_compare_exchange_strong(&live[i], &none, name))
            return;
    }
}

void hf_temp_forget(char *name)
{
    for (int i = 0; i < LIVE; i++) {
        char *own = name;
        if (name && atomic_compare_exchange_strong(&live[i], &own, NULL))
            break;
    }
    if (!atomic_load(&ending))
        free(name);
}

// Create a file that a signal handler can find from the first moment on: signals are blocked on this thread meanwhile,
// and a handler on another thread waits for `creating`. Fails like open().
static int open_known(char *name, mode_t mode)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    atomic_fetch_add(&creating, 1);
    int fd = -1, code = EINTR;
    if (!atomic_load(&ending)) {
        enter(name);
        // O_EXCL never follows or overwrites what somebody else put there.
        fd = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        code = errno;
    }
    atomic_fetch_sub(&creating, 1);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    errno = code;
    return fd;
}

void hf_temp_end_by_signal(int number)
{
    const struct timespec pause = {.tv_nsec = 1000000};
    atomic_store(&ending, 1);
    for (int i = 0; i < 1000 && atomic_load(&creating); i++)  // at most a second, in case a disk hangs
        nanosleep(&pause, NULL);
    for (int i = 0; i < LIVE; i++) {
        const char *name = atomic_load(&live[i]);
        if (name)
            unlink(name);
    }
    signal(number, SIG_DFL);
    raise(number);
}

void hf_temp_catch_signals(void)
{
    static const int numbers[] = {SIGTERM, SIGINT, SIGHUP, SIGPIPE, SIGXCPU};
    for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++) {
        struct sigaction was, ours = {.sa_handler = hf_temp_end_by_signal};
        // A signal that the caller ignores (nohup) stays ignored.
        if (!sigaction(numbers[i], NULL, &was) && was.sa_handler == SIG_DFL)
            sigaction(numbers[i], &ours, NULL);
    }
}

// ---- names and locks

// FNV-1a of 64 bits.
static uint64_t mix(uint64_t hash, const char *text)
{
    for (; *text; text++)
        hash = (hash ^ (unsigned char)*text) * UINT64_C(0x100000001b3);
    return hash;
}

// Identifies the machine or container in which process numbers are valid and locks are surely visible: by the boot id
// of its kernel and its process namespace, and by its host name, for copies of a virtual machine.
static uint64_t machine_id(void)
{
    static atomic_ullong known;  // concurrent threads compute the same
    if (atomic_load(&known))
        return atomic_load(&known);
    char text[300] = "";
    uint64_t id = UINT64_C(0xcbf29ce484222325);
    FILE *f = fopen("/proc/sys/kernel/random/boot_id", "re");
    if (f && fgets(text, sizeof(text), f))
        id = mix(id, text);
    if (f)
        fclose(f);
    const ssize_t n = readlink("/proc/self/ns/pid", text, sizeof(text) - 1);
    text[n > 0 ? n : 0] = 0;
    id = mix(id, text);
    text[0] = 0;
    gethostname(text, sizeof(text) - 1);
    id = mix(id, text);
    atomic_store(&known, id ? id : 1);
    return id ? id : 1;
}

// A new name beside the target. It is short, because the target's name may already have the maximal length. It contains
// machine and process, so no two processes that write to one folder use the same name.
static char *temp_name(const char *target)
{
    static atomic_uint counter;
    const char *slash = strrchr(target, '/');
    const char *ext = hf_io_extension(target);
    const int folder = slash ? (int)(slash - target + 1) : 0;
    char *name;
    if (strlen(ext) > 16)
        ext = "";
    if (asprintf(&name, "%.*s" TEMP_PREFIX "%016" PRIx64 "-%ld-%u%s%s", folder, target, machine_id(), (long)getpid(),
                 atomic_fetch_add(&counter, 1), *ext ? "." : "", ext) < 0)
        return NULL;
    return name;
}

// Whose file a name (without folder) denotes, if it is one of our temporary files; *pid is the process that made it.
enum owner { NOT_OURS, THIS_MACHINE, OTHER_MACHINE };

static enum owner owner_of(const char *name, long *pid)
{
    char own[17], *end;
    if (strncmp(name, TEMP_PREFIX, strlen(TEMP_PREFIX)))
        return NOT_OURS;
    const char *theirs = name + strlen(TEMP_PREFIX), *dash = strchr(theirs, '-');
    if (!dash || !isdigit((unsigned char)dash[1]))
        return NOT_OURS;
    errno = 0;
    *pid = strtol(dash + 1, &end, 10);
    if (errno || *pid < 1 || *end != '-' || !isdigit((unsigned char)end[1]))
        return NOT_OURS;
    snprintf(own, sizeof(own), "%016" PRIx64, machine_id());
    return dash - theirs == 16 && !memcmp(own, theirs, 16) ? THIS_MACHINE : OTHER_MACHINE;
}

// Lock a file that was just created. Returns false if another process that removes strays was faster: the file is gone
// then, or soon. On file systems without locks the file is used unlocked.
static int lock_own(int fd, const char *name)
{
    struct stat st;
    if (flock(fd, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK) {
        unlink(name);
        return 0;
    }
    return fstat(fd, &st) || st.st_nlink > 0;
}

int hf_temp_create(const char *target, mode_t mode, char **name)
{
    for (int i = 0; i < 1000; i++) {
        *name = temp_name(target);
        if (!*name)
            return -1;
        const int fd = open_known(*name, mode);
        if (fd >= 0 && lock_own(fd, *name))
            return fd;
        const int code = fd >= 0 ? EEXIST : errno;
        if (fd >= 0)
            close(fd);
        hf_temp_forget(*name);  // not ours to remove any more
        *name = NULL;
        errno = code;
        if (code != EEXIST)
            return -1;
    }
    return -1;
}

// ---- strays: files whose writers have died

enum { FOREIGN_AGE = 3600 };  // seconds

// Whether the writer of an open file has died. From here on its lock is held, until fd is closed.
static int is_abandoned(int fd, enum owner owner, long pid)
{
    if (!flock(fd, LOCK_EX | LOCK_NB))
        return 1;
    if (errno == EWOULDBLOCK)
        return 0;
    // The file system has no locks: for processes of this machine we can ask whether they live, for others only the age
    // tells.
    return owner == OTHER_MACHINE || (kill((pid_t)pid, 0) && errno == ESRCH);
}

static int remove_stray(int dir, const char *name)
{
    struct stat st, opened;
    long pid;
    const enum owner owner = owner_of(name, &pid);
    if (owner == NOT_OURS || fstatat(dir, name, &st, AT_SYMLINK_NOFOLLOW) || !S_ISREG(st.st_mode))
        return 0;
    if (owner == OTHER_MACHINE && time(NULL) - st.st_mtime <= FOREIGN_AGE)
        return 0;
    // Opened for writing, because a lock over NFS needs that.
    const int fd = openat(dir, name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0)
        return 0;
    // Whoever renames or removes a file holds its lock, so the name denotes this file until we release the lock.
    const int gone = is_abandoned(fd, owner, pid) && !fstat(fd, &opened) &&
                     !fstatat(dir, name, &st, AT_SYMLINK_NOFOLLOW) && opened.st_dev == st.st_dev &&
                     opened.st_ino == st.st_ino && !unlinkat(dir, name, 0);
    close(fd);
    return gone;
}

int hf_temp_remove_strays(const char *folder)
{
    int removed = 0;
    DIR *dir = opendir(folder);
    const struct dirent *entry;
    while (dir && (entry = readdir(dir)))
        removed += remove_stray(dirfd(dir), entry->d_name);
    if (dir)
        closedir(dir);
    return removed;
}
