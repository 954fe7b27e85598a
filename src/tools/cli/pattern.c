// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/pattern.h"

#include "tools/cli/args.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { AS_FOUND = -1, MAX_DIGITS = 32, DEFAULT_DIGITS = 4 };
enum kind { TEXT, FRAME, VIEW, INITIAL };

// What a text begins with: a place, and how many characters it takes, or plain text.
struct place {
    enum kind kind;
    size_t length;
    int digits;
};

static int limit(size_t digits)
{
    return digits < MAX_DIGITS ? (int)digits : MAX_DIGITS;
}

static struct place place_at(const char *c)
{
    if (*c == '#' || *c == '@') {
        const size_t n = strspn(c, *c == '#' ? "#" : "@");
        return (struct place){FRAME, n, n == 1 && *c == '#' ? AS_FOUND : limit(n)};
    }
    if (c[0] == '%' && (c[1] == 'V' || c[1] == 'v') && !isalnum((unsigned char)c[2]))
        return (struct place){c[1] == 'V' ? VIEW : INITIAL, 2, 0};
    if (c[0] == '%') {
        const size_t n = strspn(c + 1, "0123456789");
        if (c[1 + n] == 'd' && n <= 3 && (n == 0 || c[1] == '0'))
            return (struct place){FRAME, n + 2, limit((size_t)atoi(c + 1))};
    }
    if (c[0] == '$' && c[1] == 'F') {
        const size_t n = strspn(c + 2, "0123456789");
        if (n <= 2 && !isalpha((unsigned char)c[2 + n]) && c[2 + n] != '_')
            return (struct place){FRAME, n + 2, limit((size_t)atoi(c + 2))};
    }
    return (struct place){TEXT, 1, 0};
}

static int has(const char *pattern, enum kind first, enum kind last)
{
    for (const char *c = pattern; *c;) {
        const struct place p = place_at(c);
        if (p.kind >= first && p.kind <= last)
            return 1;
        c += p.length;
    }
    return 0;
}

int cli_pattern_has_frame(const char *pattern)
{
    return has(pattern, FRAME, FRAME);
}

int cli_pattern_has_view(const char *pattern)
{
    return has(pattern, VIEW, INITIAL);
}

// Write what a place becomes. If frame or view is NULL, its places stay as they are.
static void put_place(FILE *out, const char *c, const struct place *p, const int *frame, int digits, const char *view)
{
    if (p->kind == FRAME && frame)
        fprintf(out, "%0*d", p->digits == AS_FOUND ? digits : p->digits, *frame);
    else if (p->kind == VIEW && view)
        fputs(view, out);
    else if (p->kind == INITIAL && view)
        fprintf(out, "%.1s", view);
    else
        fwrite(c, 1, p->length, out);
}

static char *fill(const char *pattern, const int *frame, int digits, const char *view)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    for (const char *c = pattern; *c;) {
        const struct place p = place_at(c);
        put_place(out, c, &p, frame, digits, view);
        c += p.length;
    }
    const int failed = ferror(out);
    if (fclose(out) || failed) {
        free(text);
        return NULL;
    }
    return text;
}

char *cli_pattern_fill(const char *pattern, int frame, int digits)
{
    return fill(pattern, &frame, digits, NULL);
}

char *cli_pattern_view(const char *pattern, const char *view)
{
    return fill(pattern, NULL, 0, view);
}

// Read the number that begins at c. Returns how many characters it has, a minus sign included; 0 if there is no number
// or it is out of range.
static size_t number_at(const char *c, int *frame)
{
    const size_t sign = c[0] == '-', n = strspn(c + sign, "0123456789");
    char *end;
    errno = 0;
    const long v = n ? strtol(c, &end, 10) : 0;
    *frame = (int)v;
    return n && !errno && v >= -CLI_MAX_FRAME && v <= CLI_MAX_FRAME ? sign + n : 0;
}

// Does a file's name fit the pattern? Finds its number and the digits of that. If the pattern has several places, each
// must hold the number of the first.
static int matches(const char *pattern, const char *name, int *frame, int *digits)
{
    size_t at = 0;
    while (pattern[at] && place_at(pattern + at).kind == TEXT)
        at++;
    if (strncmp(pattern, name, at))
        return 0;
    const size_t n = number_at(name + at, frame);
    *digits = (int)n;
    if (!n || n > MAX_DIGITS)
        return 0;
    char *whole = cli_pattern_fill(pattern, *frame, *digits);
    const int same = whole && !strcmp(whole, name);
    free(whole);
    return same;
}

static int by_number(const void *a, const void *b)
{
    const int x = *(const int *)a, y = *(const int *)b;
    return (x > y) - (x < y);
}

static int scan(DIR *dir, const char *name, struct cli_frames *found, int *digits)
{
    const struct dirent *entry;
    int least = 0, frame, n;
    while ((entry = readdir(dir))) {
        if (!matches(name, entry->d_name, &frame, &n))
            continue;
        least = !least || n < least ? n : least;
        if (cli_frames_add(found, frame))
            return -1;
    }
    *digits = least ? least : DEFAULT_DIGITS;
    if (found->count)
        qsort(found->list, (size_t)found->count, sizeof(*found->list), by_number);
    // 7 and 0007 are one frame.
    int kept = 0;
    for (int i = 0; i < found->count; i++)
        if (!kept || found->list[kept - 1] != found->list[i])
            found->list[kept++] = found->list[i];
    found->count = kept;
    return 0;
}

int cli_pattern_scan(const char *pattern, struct cli_frames *found, int *digits, struct tool_error *error)
{
    const char *slash = strrchr(pattern, '/');
    char *folder = slash ? strndup(pattern, (size_t)(slash - pattern) + (slash == pattern)) : strdup(".");
    *found = (struct cli_frames){0};
    *digits = DEFAULT_DIGITS;
    int status = 0;
    DIR *dir = NULL;
    if (folder && slash && cli_pattern_has_frame(folder))
        status = tool_fail(error, CLI_BAD_ARGUMENTS,
                           "%s: the directory's name has a place for the number, so --frames must say which there are",
                           pattern);
    else if (folder && !(dir = opendir(folder)))
        status = tool_fail(error, CLI_ALL_FAILED, "%s: %s: %s", pattern, folder, strerror(errno));
    else if (!folder || scan(dir, slash ? slash + 1 : pattern, found, digits))
        status = tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", pattern);
    if (dir)
        closedir(dir);
    free(folder);
    if (status)
        cli_frames_free(found);
    return status;
}

int cli_name_number(const char *path, int *frame, int *digits)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    const char *end = dot && dot > name ? dot : name + strlen(name);
    while (end > name && !isdigit((unsigned char)end[-1]))
        end--;
    const char *begin = end;
    while (begin > name && isdigit((unsigned char)begin[-1]))
        begin--;
    // shot.-5.exr is frame -5, shot-5.exr frame 5.
    if (begin < end && begin > name && begin[-1] == '-' && (begin == name + 1 || !isalnum((unsigned char)begin[-2])))
        begin--;
    const size_t n = begin < end ? number_at(begin, frame) : 0;
    *digits = (int)n;
    return n > 0;
}
