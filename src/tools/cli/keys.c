// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/keys.h"

#include "tools/cli/args.h"

#include <ctype.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_COLUMNS = 16, FRAME_COLUMN = CLI_KEY_COUNT };
enum { MAX_LINE = 4096, MAX_LINES = 10000000 };  // nobody keeps a larger table

// Names of the columns and what a value may be, inclusive.
static const struct {
    const char *name;
    enum cli_key key;
    double min, max;
    int above_min;
    enum tool_unit unit;
} columns[] = {
    {"frame", (enum cli_key)FRAME_COLUMN, -1e8, 1e8, 0, TOOL_UNIT_NONE},
    {"focus", CLI_KEY_FOCUS, 0, FLT_MAX, 1, TOOL_UNIT_DISTANCE},
    {"range", CLI_KEY_RANGE, 0, FLT_MAX, 0, TOOL_UNIT_DISTANCE},
    {"strength", CLI_KEY_STRENGTH, 0, 1, 0, TOOL_UNIT_NONE},
    {"fstop", CLI_KEY_FSTOP, 0, FLT_MAX, 1, TOOL_UNIT_FSTOP},
    {"focal-length", CLI_KEY_FOCAL_LENGTH, 0, FLT_MAX, 1, TOOL_UNIT_MM},
    {"max-radius", CLI_KEY_MAX_RADIUS, 0, 2048, 0, TOOL_UNIT_NONE},
    {"focus-at", CLI_KEY_FOCUS_X, -1e8, 1e8, 0, TOOL_UNIT_NONE},
};

struct reader {
    struct cli_keys *keys;
    const char *path;
    int line;
    int order[MAX_COLUMNS];  // of the file: indices into columns
    int count;
    struct tool_error *error;
};

// Cut the next cell off a line, without its spaces and quotes. Returns NULL after the last cell.
static char *next_cell(char **rest)
{
    char *c = *rest;
    if (!c)
        return NULL;
    c += strspn(c, " ");
    char *end, *next;
    if (*c == '"') {
        end = c + 1 + strcspn(c + 1, "\"");
        next = end + strcspn(end, ",;\t");
        c++;
    } else {
        next = end = c + strcspn(c, ",;\t");
    }
    *rest = *next ? next + 1 : NULL;
    *end = '\0';
    while (end > c && isspace((unsigned char)end[-1]))
        *--end = '\0';
    return c;
}

static int fail(const struct reader *r, const char *cell, const char *what)
{
    return tool_fail(r->error, CLI_BAD_ARGUMENTS, "%s, line %d: '%s' %s", r->path, r->line, cell, what);
}

static int read_names(struct reader *r, char *line)
{
    int frame = 0;
    for (char *cell; (cell = next_cell(&line)) && *cell;) {
        int c = 0;
        const int known = (int)(sizeof(columns) / sizeof(columns[0]));
        while (c < known && strcasecmp(cell, columns[c].name))
            c++;
        if (c == known)
            return fail(r, cell,
                        "is not a column: frame, focus, range, strength, fstop, focal-length, max-radius, "
                        "focus-at");
        for (int i = 0; i < r->count; i++)
            if (r->order[i] == c)
                return fail(r, cell, "comes twice");
        if (r->count == MAX_COLUMNS)
            return fail(r, cell, "is one column too many");
        r->order[r->count++] = c;
        frame |= c == 0;
    }
    return frame ? 0 : fail(r, r->count ? columns[r->order[0]].name : "", "is a column, but there is no column frame");
}

static int add_key(struct cli_keys *keys, enum cli_key key, struct cli_keyed added)
{
    const size_t n = (size_t)keys->column[key].count;
    struct cli_keyed *k = keys->column[key].keys;
    if ((n & (n - 1)) == 0) {  // room for a power of two
        k = realloc(k, (n ? 2 * n : 1) * sizeof(*k));
        if (!k)
            return -1;
        keys->column[key].keys = k;
    }
    k[n] = added;
    keys->column[key].count++;
    return 0;
}

static int check_value(const struct reader *r, const char *cell, int column, double value)
{
    return value < columns[column].min || value > columns[column].max ||
                   (columns[column].above_min && value <= columns[column].min)
               ? fail(r, cell, "is out of range")
               : 0;
}

// The number at the beginning of a cell.
static int read_value(const struct reader *r, const char *cell, int column, double *value, char **end)
{
    *value = strtod(cell, end);
    if (*end == cell || isnan(*value))
        return fail(r, cell, "is not a number");
    return check_value(r, cell, column, *value);
}

// X:Y
static int read_pixel(const struct reader *r, const char *cell, int column, double frame)
{
    struct cli_keyed x = {.frame = frame}, y = x;
    char *end;
    if (read_value(r, cell, column, &x.value, &end))
        return CLI_BAD_ARGUMENTS;
    const char *second = end + strspn(end, " :,");
    if (second == end || read_value(r, second, column, &y.value, &end) || *end)
        return fail(r, cell, "is not a pixel, X:Y");
    return add_key(r->keys, CLI_KEY_FOCUS_X, x) || add_key(r->keys, CLI_KEY_FOCUS_Y, y) ? CLI_ALL_FAILED : 0;
}

static int read_cell(const struct reader *r, const char *cell, int column, double frame)
{
    const enum tool_unit unit = columns[column].unit;
    struct cli_keyed key = {.frame = frame};
    char what[64];
    if (columns[column].key == CLI_KEY_FOCUS_X)
        return read_pixel(r, cell, column, frame);
    snprintf(what, sizeof(what), "is not a number%s", tool_units(unit));
    if (tool_read_measure(unit, cell + strspn(cell, " "), &key.value, &key.metric))
        return fail(r, cell, what);
    if (check_value(r, cell, column, key.value))
        return CLI_BAD_ARGUMENTS;
    return add_key(r->keys, columns[column].key, key) ? CLI_ALL_FAILED : 0;
}

static int read_row(struct reader *r, char *line)
{
    char *cells[MAX_COLUMNS] = {NULL}, *end;
    double frame = NAN;
    for (int i = 0; i < r->count; i++)
        cells[i] = next_cell(&line);
    if (line && next_cell(&line)[0])
        return fail(r, "", "there are more cells than columns");
    for (int i = 0; i < r->count; i++)
        if (r->order[i] == 0 && (read_value(r, cells[i] ? cells[i] : "", 0, &frame, &end) || *end))
            return fail(r, cells[i] ? cells[i] : "", "is not a frame's number");
    for (int i = 0; i < r->count; i++) {
        const int status = r->order[i] && cells[i] && *cells[i] ? read_cell(r, cells[i], r->order[i], frame) : 0;
        if (status == CLI_ALL_FAILED)
            return tool_fail(r->error, status, "%s: out of memory", r->path);
        if (status)
            return status;
    }
    return 0;
}

static int by_frame(const void *a, const void *b)
{
    const double x = ((const struct cli_keyed *)a)->frame, y = ((const struct cli_keyed *)b)->frame;
    return (x > y) - (x < y);
}

static int sort_keys(struct reader *r)
{
    int any = 0;
    for (int c = 0; c < CLI_KEY_COUNT; c++) {
        struct cli_keyed *k = r->keys->column[c].keys;
        const int n = r->keys->column[c].count;
        any |= n;
        if (n)
            qsort(k, (size_t)n, sizeof(*k), by_frame);
        for (int i = 1; i < n; i++)
            if (k[i].frame == k[i - 1].frame)
                return tool_fail(r->error, CLI_BAD_ARGUMENTS, "%s: frame %g comes twice", r->path, k[i].frame);
    }
    return any ? 0 : tool_fail(r->error, CLI_BAD_ARGUMENTS, "%s: there is no value in it", r->path);
}

enum { END_OF_FILE = -1 };

// The next line, without its end. Returns 0, END_OF_FILE, or an exit code.
static int read_line(struct reader *r, FILE *in, char line[MAX_LINE])
{
    int n = 0, c;
    r->line++;
    while ((c = getc_unlocked(in)) != EOF && c != '\n') {
        if (!c)
            return tool_fail(r->error, CLI_BAD_ARGUMENTS, "--keys %s, line %d: a zero byte, so this is not a text file",
                             r->path, r->line);
        if (n == MAX_LINE - 1)
            return tool_fail(r->error, CLI_BAD_ARGUMENTS, "--keys %s, line %d is longer than %d bytes", r->path,
                             r->line, MAX_LINE - 1);
        line[n++] = (char)c;
    }
    if (c == EOF && ferror(in))
        return tool_fail(r->error, CLI_BAD_ARGUMENTS, "--keys %s cannot be read: %s", r->path, strerror(errno));
    if (r->line > MAX_LINES)
        return tool_fail(r->error, CLI_BAD_ARGUMENTS, "--keys %s has more than %d lines", r->path, MAX_LINES);
    line[n] = '\0';
    line[strcspn(line, "\r")] = '\0';
    return c == EOF && !n ? END_OF_FILE : 0;
}

int cli_keys_load(struct cli_keys *keys, const char *path, int smooth, struct tool_error *error)
{
    struct reader r = {.keys = keys, .path = path, .error = error};
    char line[MAX_LINE];
    *keys = (struct cli_keys){.smooth = smooth};
    FILE *in = fopen(path, "re");
    if (!in)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "--keys %s: %s", path, strerror(errno));
    int status = 0;
    while (!status && !(status = read_line(&r, in, line))) {
        char *text = line + (r.line == 1 && !strncmp(line, "\xef\xbb\xbf", 3) ? 3 : 0);  // a byte order mark
        if (text[0] == '#' || !text[strspn(text, " \t,;")])
            continue;
        status = r.count ? read_row(&r, text) : read_names(&r, text);
    }
    if (status == END_OF_FILE)
        status = sort_keys(&r);
    fclose(in);
    if (status)
        cli_keys_free(keys);
    return status;
}

void cli_keys_scale(struct cli_keys *keys, double unit)
{
    for (int c = 0; c < CLI_KEY_COUNT; c++)
        for (int i = 0; i < keys->column[c].count; i++)
            if (keys->column[c].keys[i].metric)
                keys->column[c].keys[i].value /= unit;
}

void cli_keys_free(struct cli_keys *keys)
{
    for (int c = 0; c < CLI_KEY_COUNT; c++)
        free(keys->column[c].keys);
    *keys = (struct cli_keys){0};
}

// Slope at key i, so that the cubic keeps to the direction of its keys: the weighted harmonic mean of the slopes on both
// sides, and 0 where those differ in sign or at the ends (F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5, 1984).
static double slope(const struct cli_keyed *k, int n, int i)
{
    if (i == 0 || i == n - 1)
        return 0;
    const double h0 = k[i].frame - k[i - 1].frame, h1 = k[i + 1].frame - k[i].frame;
    const double d0 = (k[i].value - k[i - 1].value) / h0, d1 = (k[i + 1].value - k[i].value) / h1;
    if (d0 * d1 <= 0)
        return 0;
    return 3 * (h0 + h1) / ((2 * h1 + h0) / d0 + (h1 + 2 * h0) / d1);
}

double cli_keys_at(const struct cli_keys *keys, enum cli_key key, double frame)
{
    const struct cli_keyed *k = keys->column[key].keys;
    const int n = keys->column[key].count;
    int i = 0;
    while (i < n && k[i].frame <= frame)
        i++;
    if (i == 0 || i == n)
        return k[i ? n - 1 : 0].value;
    const struct cli_keyed *a = &k[i - 1], *b = &k[i];
    const double h = b->frame - a->frame, t = (frame - a->frame) / h;
    if (!keys->smooth)
        return a->value + t * (b->value - a->value);
    // Hermite's cubic between two values and their slopes.
    const double u = 1 - t;
    return u * u * (1 + 2 * t) * a->value + t * t * (3 - 2 * t) * b->value +
           h * t * u * (u * slope(k, n, i - 1) - t * slope(k, n, i));
}
