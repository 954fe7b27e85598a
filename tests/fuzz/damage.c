// SPDX-License-Identifier: BSD-3-Clause
// Gives damaged EXR files to the command: headers, chunk tables, chunks and their sizes, cut ends. For any file the
// command either makes a readable picture, or prints one sentence and leaves existing files alone. It takes memory in
// proportion to the file, and at most 10 seconds.
//
//     fuzz-damage HYPERFOCAL [COUNT [SEED]]
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/files.h"

// Limits for a file of a few kB: buffers of every engine are below 100 bytes a pixel, and a damaged window may be as
// many times larger as a compression can shrink it. Seconds of processor time; a process that waits for something has
// ten times as many.
enum { MOST_KB = 512 * 1024, MOST_SECONDS = 10, SOURCES = 16, WORDS = 24 };

struct source {
    const char *name;
    uint8_t *data;
    size_t size, table;  // where the table of chunks begins
    int deep;
};

static const char *program;
static struct source sources[SOURCES];
static int source_count;

// ---- the command ----

struct outcome {
    int status;  // of wait
    long kb;
    char said[4096];
};

static void redirect(const char *path, int to)
{
    const int f = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (f < 0 || dup2(f, to) < 0)
        _exit(99);
}

static struct outcome run(const char *const *words)
{
    struct outcome o = {.status = -1};
    const char *argv[WORDS] = {program}, *said = in_folder("said.txt");
    for (int i = 0; words[i]; i++)
        argv[i + 1] = words[i];
    const pid_t child = fork();
    if (child == 0) {
        const struct rlimit seconds = {MOST_SECONDS, MOST_SECONDS}, none = {0, 0};
        setrlimit(RLIMIT_CPU, &seconds);
        setrlimit(RLIMIT_CORE, &none);
        redirect("/dev/null", 1);
        redirect(said, 2);
        alarm(10 * MOST_SECONDS);
        execv(program, (char *const *)argv);
        _exit(99);
    }
    struct rusage usage = {0};
    if (child > 0 && wait4(child, &o.status, 0, &usage) == child)
        o.kb = usage.ru_maxrss;
    size_t size;
    uint8_t *text = slurp(said, &size);
    size = size < sizeof o.said - 1 ? size : sizeof o.said - 1;
    memcpy(o.said, text, size);
    free(text);
    unlink(said);
    return o;
}

// ---- files to damage ----

static void add_file(const char *name, const char *path)
{
    struct source *s = &sources[source_count++];
    s->name = name;
    s->data = slurp(path, &s->size);
    s->table = header_size(s->data, s->size);
    CHECK_MSG(s->size > 200 && s->table < s->size, "%s: no file to damage", name);
}

static void add_source(const char *name)
{
    add_file(name, in_folder(name));
}

// Core writes the compressions that it can; the command makes the others from those.
static void make_sources(void)
{
    static const char *const compressions[] = {"rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"};
    static char names[sizeof compressions / sizeof *compressions][16];
    const struct channel colour[] = {{"A", EXR_PIXEL_HALF, 0}, {"B", EXR_PIXEL_HALF, 0},  {"G", EXR_PIXEL_HALF, 0},
                                     {"R", EXR_PIXEL_HALF, 0}, {"Z", EXR_PIXEL_FLOAT, 0}, {NULL, EXR_PIXEL_HALF, 0}};
    struct part one = {.name = "main", .compression = EXR_COMPRESSION_NONE, .width = 41, .height = 37},
                parts[MAX_PARTS];
    memcpy(one.channels, colour, sizeof colour);
    memset(parts, 0, sizeof parts);
    parts[0] = one;
    CHECK(!make_exr(in_folder("none.exr"), parts, NULL));
    parts[0].storage = EXR_STORAGE_TILED;
    parts[0].compression = EXR_COMPRESSION_ZIP;
    CHECK(!make_exr(in_folder("tiled.exr"), parts, NULL));
    parts[0] = parts[1] = one;
    parts[0].compression = EXR_COMPRESSION_ZIP;
    parts[1].name = "second";
    parts[1].compression = EXR_COMPRESSION_PIZ;
    CHECK(!make_exr(in_folder("parts.exr"), parts, NULL));
    add_source("none.exr");
    add_source("tiled.exr");
    add_source("parts.exr");
    for (size_t i = 0; i < sizeof compressions / sizeof *compressions; i++) {
        snprintf(names[i], sizeof names[i], "%s.exr", compressions[i]);
        const struct outcome o = run((const char *[]){in_folder("none.exr"), "-o", in_folder(names[i]), "--focus", "5",
                                                      "--compression", compressions[i], "--quiet", NULL});
        if (o.status && strstr(o.said, "without OpenImageIO"))
            printf("no %s: built without OpenImageIO\n", names[i]);
        else if (CHECK_MSG(o.status == 0, "%s cannot be made: %s", names[i], o.said))
            add_source(names[i]);
    }
    add_file("deep-none.exr", CORPUS "deep-none.exr");
    add_file("deep-rle-tiled.exr", CORPUS "deep-rle-tiled.exr");
    add_file("deep-zips-half.exr", CORPUS "deep-zips-half.exr");
    for (int i = 1; i <= 3; i++)
        sources[source_count - i].deep = 1;
}

// ---- damage ----

static void put_number(uint8_t *d, size_t size, size_t at, size_t bytes)
{
    static const uint64_t odd[] = {0,          1,          2,          0xff,       0xffff,     0x10000,
                                   0x7fffffff, 0x80000000, 0xffffffff, 0x40000000, UINT64_MAX, (uint64_t)1 << 40};
    const uint64_t v = rnd() % 4 ? odd[rnd() % (sizeof odd / sizeof *odd)] : rnd() % (2 * size);
    if (at + bytes <= size)
        memcpy(d + at, &v, bytes);
}

static const char *const kinds[] = {"header bytes", "header numbers", "chunk table",
                                    "chunk sizes",  "chunk bytes",    "cut"};
enum { KINDS = sizeof kinds / sizeof *kinds };

// Damage a copy; returns its size.
static size_t damage(const struct source *s, int kind, uint8_t *d)
{
    size_t size = s->size;
    const size_t after = size - s->table;
    memcpy(d, s->data, size);
    for (uint32_t n = 1 + rnd() % 4; n; n--) {
        const size_t entry = s->table + 8 * (rnd() % (after < 320 ? 1 + after / 16 : 20));
        uint64_t chunk = 0;
        switch (kind) {
        case 0:
            d[rnd() % s->table] = (uint8_t)rnd();
            break;
        case 1:
            put_number(d, size, 8 + rnd() % (s->table - 8), rnd() % 2 ? 4 : 1);
            break;
        case 2:
            put_number(d, size, entry, 8);
            break;
        case 3:  // the sizes that a chunk says, and where it says it lies
            memcpy(&chunk, s->data + entry, 8);
            put_number(d, size, (chunk < size ? (size_t)chunk : s->table) + 4 * (rnd() % (s->deep ? 12 : 5)),
                       s->deep && rnd() % 2 ? 8 : 4);
            break;
        case 4:
            d[s->table + rnd() % after] ^= (uint8_t)(1u << rnd() % 8);
            break;
        default: {
            const size_t from = rnd() % size, gone = rnd() % 3 ? size - from : 1 + rnd() % (size - from);
            memmove(d + from, d + from + gone, size - from - gone);
            return size - gone;
        }
        }
    }
    return size;
}

// ---- what must hold ----

static int is_sentence(const char *said)
{
    const size_t n = strlen(said);
    if (strncmp(said, "hyperfocal: ", 12) || n < 20 || said[n - 1] != '\n')
        return 0;
    for (size_t i = 0; i < n - 1; i++)
        if ((unsigned char)said[i] < 32 || said[i] == 127)
            return 0;
    return 1;
}

// Check that everything in a picture file can be read.
static int is_whole(const char *path)
{
    struct hf_io_file *f;
    struct hf_io_error err = {.message = ""};
    if (hf_io_open(&f, path, NULL, &err))
        return 0;
    int ok = hf_io_view_count(f) > 0;
    for (int i = 0; i < hf_io_view_count(f); i++) {
        const struct hf_io_view *v = hf_io_view(f, i);
        float *planes[4];
        for (int k = 0; k < 4; k++)
            planes[k] = allocate((size_t)v->width * (size_t)v->height * sizeof(float));
        ok &= !hf_io_read_colour(f, i, planes, &err);
        for (int k = 0; k < 4; k++)
            free(planes[k]);
    }
    hf_io_close(&f);
    return ok;
}

static void try_one(uint64_t number)
{
    static const char *const engines[] = {"layers", "gather", "scatter", "hexagon", "gaussian"};
    seed = number * 0x9e3779b97f4a7c15u + 1;
    for (int i = 0; i < 4; i++)
        rnd();
    const struct source *s = &sources[rnd() % (uint32_t)source_count];
    const int kind = (int)(rnd() % KINDS), before = files_in(folder);
    const char *bad = in_folder("bad.exr"), *out = in_folder("out.exr");
    uint8_t *d = allocate(s->size);
    spill(bad, d, damage(s, kind, d));
    free(d);
    spill(out, "old", 3);
    const struct outcome o =
        run((const char *[]){bad, "-o", out, "--engine", engines[s->deep ? 0 : rnd() % 5], "--focus", "5", "--range",
                             "3", "--max-radius", "8", "--threads", "2", NULL});
    size_t size;
    uint8_t *now = slurp(out, &size);
    const int kept = size == 3 && !memcmp(now, "old", 3), code = WIFEXITED(o.status) ? WEXITSTATUS(o.status) : -1;
    free(now);
    const unsigned long long n = number;
    CHECK_MSG(code >= 0 && code <= 3, "%llu: %s, %s: ends with status %#x: %s", n, s->name, kinds[kind],
              (unsigned)o.status, o.said);
    CHECK_MSG(code == 0 || (kept && is_sentence(o.said)), "%llu: %s, %s: %s; says: %s", n, s->name, kinds[kind],
              kept ? "what was there is kept" : "what was there is lost", o.said);
    CHECK_MSG(code != 0 || is_whole(out), "%llu: %s, %s: the picture cannot be read", n, s->name, kinds[kind]);
    CHECK_MSG(o.kb <= MOST_KB, "%llu: %s, %s: takes %ld MB", n, s->name, kinds[kind], o.kb / 1024);
    unlink(bad);
    unlink(out);
    CHECK_MSG(files_in(folder) == before, "%llu: %s, %s: files are left", n, s->name, kinds[kind]);
}

int main(int argc, char **argv)
{
    char name[] = "/tmp/hyperfocal-damage-XXXXXX";
    const long count = argc > 2 ? strtol(argv[2], NULL, 10) : check_long() ? 16000 : 120;
    const unsigned long long first = argc > 3 ? strtoull(argv[3], NULL, 10) : 1;
    if (argc < 2 || !mkdtemp(name)) {
        fprintf(stderr, "usage: fuzz-damage HYPERFOCAL [COUNT [SEED]]\n");
        return 1;
    }
    program = argv[1];
    folder = name;
    make_sources();
    printf("%ld damaged files from %llu on\n", count, first);
    fflush(stdout);
    for (long i = 0; i < count && source_count; i++)
        try_one(first + (unsigned long long)i);
    for (int i = 0; i < source_count; i++) {
        unlink(in_folder(sources[i].name));
        free(sources[i].data);
    }
    rmdir(name);
    return check_report();
}
