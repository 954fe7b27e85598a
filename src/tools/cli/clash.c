// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/clash.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/cli/args.h"
#include "tools/io/out.h"

enum role { INPUT, DEPTH_FILE, OTHER, OUTPUT, LOG };

// A file that the shot reads or writes.
struct entry {
    dev_t device;
    ino_t inode;
    const char
        *name;    // NULL: device and inode are the file's; else they are its directory's, and this is its name there
    char *owned;  // name, where it has to be freed
    const char *path;
    enum role role;
    int frame;  // number of the job; the frames around follow the jobs
    const char *input;
};

struct list {
    struct entry *entries;
    int count;
    // The directory of the last look-up: most frames lie in the same one.
    char directory[PATH_MAX];
    struct stat directory_stat;
};

// Find the directory of a path. Consecutive paths in the same directory cost one look-up. Returns 0 or -1.
static int stat_directory(struct list *list, const char *path, struct stat *st)
{
    const char *slash = strrchr(path, '/');
    const size_t n = slash ? (size_t)(slash - path) + 1 : 0;
    if (n >= sizeof(list->directory))
        return -1;
    if (n && strlen(list->directory) == n && !memcmp(list->directory, path, n)) {
        *st = list->directory_stat;
        return 0;
    }
    memcpy(list->directory, n ? path : ".", n ? n : 1);
    list->directory[n ? n : 1] = '\0';
    if (stat(list->directory, st)) {
        list->directory[0] = '\0';
        return -1;
    }
    list->directory_stat = *st;
    return 0;
}

// Find the file that a path means. If even its directory does not exist, there is no file, and none can be written.
static void identify(struct list *list, struct entry *e)
{
    struct stat st;
    if (!stat(e->path, &st)) {
        e->device = st.st_dev;
        e->inode = st.st_ino;
        return;
    }
    const char *path = e->path;
    char *end = NULL;
    if (!lstat(path, &st) && S_ISLNK(st.st_mode))  // a link to a file that does not exist yet
        path = end = hf_out_resolve(path);
    if (path && !stat_directory(list, path, &st)) {
        const char *slash = strrchr(path, '/');
        e->device = st.st_dev;
        e->inode = st.st_ino;
        e->name = slash ? slash + 1 : path;
        e->owned = end;
        end = NULL;
    }
    free(end);
}

static void add(struct list *list, const char *path, enum role role, int frame, const char *input)
{
    if (!path)
        return;
    struct entry *e = &list->entries[list->count];
    *e = (struct entry){.path = path, .role = role, .frame = frame, .input = input};
    identify(list, e);
    list->count += e->inode != 0;
}

static int same_or_order(const struct entry *x, const struct entry *y)
{
    if (x->device != y->device)
        return x->device < y->device ? -1 : 1;
    if (x->inode != y->inode)
        return x->inode < y->inode ? -1 : 1;
    if (!x->name || !y->name)
        return (x->name != NULL) - (y->name != NULL);
    return strcmp(x->name, y->name);
}

static int by_file(const void *a, const void *b)
{
    const struct entry *x = a, *y = b;
    const int order = same_or_order(x, y);
    return order                ? order
           : x->role != y->role ? (int)x->role - (int)y->role
                                : (x->frame > y->frame) - (x->frame < y->frame);
}

static int complain(const struct entry *writer, const struct entry *other, int over_itself, const char *option,
                    struct tool_error *error)
{
    const char *named = other->role == OTHER ? option : "--depth-file";
    if (writer->role == LOG)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "--log %s would be written into %s %s, the same file", writer->path,
                         other->role == OUTPUT  ? "OUTPUT"
                         : other->role == INPUT ? "INPUT"
                                                : named,
                         other->path);
    if (other->role == OUTPUT)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s and %s would both be written to %s%s%s", other->input,
                         writer->input, writer->path, strcmp(writer->path, other->path) ? ", which is also " : "",
                         strcmp(writer->path, other->path) ? other->path : "");
    if (over_itself)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s would be written over INPUT, give a sequence another OUTPUT",
                         writer->path);
    if (other->role == DEPTH_FILE || other->role == OTHER)
        return tool_fail(error, CLI_BAD_ARGUMENTS,
                         "%s would be written to %s, the same file as %s %s of %s: give another OUTPUT", writer->input,
                         writer->path, named, other->path, other->input);
    return tool_fail(error, CLI_BAD_ARGUMENTS,
                     "%s would be written to %s, the same file as INPUT %s of another frame: give another OUTPUT",
                     writer->input, writer->path, other->path);
}

// Hard links count as two files: writing renames a new file to one name, and the other name keeps the old file.
static int same_name(const char *a, const char *b)
{
    char *x = hf_out_resolve(a), *y = hf_out_resolve(b);
    const int same = !x || !y || !strcmp(x, y);
    free(x);
    free(y);
    return same;
}

// A file that is written and lost by that: who writes it, and who else uses it. writer NULL: none.
struct clash {
    const struct entry *writer, *other;
    int over_itself;  // the frame that writes the file also reads it
};

// roles: all uses of one file, sorted by role. There is a clash if the last of them writes the file and another one
// loses by that.
static struct clash check_file(const struct entry *roles, int count)
{
    const struct entry *writer = &roles[count - 1];
    int itself = 0;
    for (int i = 0; i < count; i++)
        itself |= writer->role == OUTPUT && roles[i].role == INPUT && roles[i].frame == writer->frame;
    for (int i = 0; i + 1 < count && writer->role >= OUTPUT; i++) {
        const struct entry *other = &roles[i];
        if (other->role != OUTPUT || writer->role != OUTPUT || same_name(other->path, writer->path))
            return (struct clash){writer, other, itself && other->role == INPUT};
    }
    return (struct clash){NULL, NULL, 0};
}

// The clash of the first frame that writes. The list is sorted by inodes, whose order is the file system's: the message
// must not depend on it.
static struct clash first_clash(const struct list *list)
{
    struct clash first = {NULL, NULL, 0};
    for (int from = 0, to; from < list->count; from = to) {
        for (to = from + 1; to < list->count && !same_or_order(&list->entries[from], &list->entries[to]);)
            to++;
        const struct clash clash = check_file(&list->entries[from], to - from);
        if (clash.writer && (!first.writer || clash.writer->frame < first.writer->frame))
            first = clash;
    }
    return first;
}

int cli_check_clashes(const struct cli_shot *shot, const char *log_file, struct tool_error *error)
{
    const struct cli_jobs *jobs = &shot->jobs, *around = &shot->around;
    struct list list = {.count = 0};
    const size_t others = (size_t)shot->other_count;
    list.entries =
        calloc((3 + others) * (size_t)jobs->count + (2 + others) * (size_t)around->count + 1, sizeof(*list.entries));
    if (!list.entries)
        return tool_fail(error, CLI_ALL_FAILED, "out of memory for %d frames", jobs->count);
    for (int i = 0; i < jobs->count; i++)
        add(&list, jobs->list[i].input, INPUT, i, jobs->list[i].input);
    for (int i = 0; i < jobs->count; i++) {
        add(&list, jobs->list[i].depth_file, DEPTH_FILE, i, jobs->list[i].input);
        for (int k = 0; k < shot->other_count; k++)
            add(&list, jobs->list[i].others[k], OTHER, i, jobs->list[i].input);
    }
    for (int i = 0; i < around->count; i++) {
        add(&list, around->list[i].input, INPUT, jobs->count + i, around->list[i].input);
        add(&list, around->list[i].depth_file, DEPTH_FILE, jobs->count + i, around->list[i].input);
        for (int k = 0; k < shot->other_count; k++)
            add(&list, around->list[i].others[k], OTHER, jobs->count + i, around->list[i].input);
    }
    for (int i = 0; i < jobs->count; i++)
        add(&list, jobs->list[i].output, OUTPUT, i, jobs->list[i].input);
    add(&list, log_file, LOG, -1, NULL);
    qsort(list.entries, (size_t)list.count, sizeof(*list.entries), by_file);
    const struct clash clash = first_clash(&list);
    const int status =
        clash.writer ? complain(clash.writer, clash.other, clash.over_itself, shot->other_option, error) : 0;
    for (int i = 0; i < list.count; i++)
        free(list.entries[i].owned);
    free(list.entries);
    return status;
}
