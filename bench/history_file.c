// SPDX-License-Identifier: BSD-3-Clause
// Points as lines of a file. They are flat JSON objects of texts, numbers and null; the reader knows only these.
#include "history.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static const struct text {
    const char *name;
    size_t offset;
} texts[] = {
#define TEXT(field)                                                                                                    \
    {                                                                                                                  \
#field, offsetof(struct history_point, field)                                                                  \
    }
    TEXT(commit), TEXT(date), TEXT(source), TEXT(cpu), TEXT(isa), TEXT(truth),
#undef TEXT
};
enum { TEXTS = sizeof texts / sizeof *texts };

double history_get(const struct history_point *p, const char *format, ...)
{
    char name[HISTORY_NAME];
    va_list args;
    va_start(args, format);
    vsnprintf(name, sizeof name, format, args);
    va_end(args);
    for (int i = 0; i < p->values; i++)
        if (!strcmp(p->value[i].name, name))
            return p->value[i].value;
    return NAN;
}

int history_set(struct history_point *p, double value, const char *format, ...)
{
    if (p->values == HISTORY_VALUES)
        return -1;
    struct history_value *v = &p->value[p->values++];
    va_list args;
    va_start(args, format);
    vsnprintf(v->name, sizeof v->name, format, args);
    va_end(args);
    v->value = value;
    return 0;
}

int history_same_machine(const struct history_point *a, const struct history_point *b)
{
    return !strcmp(a->cpu, b->cpu) && !strcmp(a->isa, b->isa) && history_get(a, "threads") == history_get(b, "threads");
}

static const char *space(const char *s)
{
    return s + strspn(s, " \t\r\n");
}

// Read a text at s into out, cut to its size. Returns where the text ends, or NULL if there is none.
static const char *read_text(const char *s, char *out, size_t size)
{
    size_t n = 0;
    if (*s++ != '"')
        return NULL;
    for (; *s && *s != '"'; s++) {
        unsigned c = (unsigned char)*s;
        if (c == '\\') {
            c = (unsigned char)*++s;
            if (c == 'u') {
                char digits[5] = "";
                strncat(digits, s + 1, 4);
                char *end;
                c = (unsigned)strtoul(digits, &end, 16);
                if (end != digits + 4 || c > 126)
                    return NULL;
                s += 4;
            } else if (!c || !strchr("\"\\/", (int)c)) {
                return NULL;
            }
        }
        if (n + 1 < size)
            out[n++] = (char)c;
    }
    out[n] = '\0';
    return *s ? s + 1 : NULL;
}

// Read one member: its name and a text, a number or null. Returns where it ends, or NULL.
static const char *read_member(const char *s, struct history_point *p)
{
    char name[HISTORY_NAME], text[HISTORY_TEXT], *end;
    s = read_text(s, name, sizeof name);
    s = s ? space(s) : "";
    if (*s++ != ':')
        return NULL;
    s = space(s);
    if (*s == '"') {
        s = read_text(s, text, sizeof text);
        for (int i = 0; s && i < TEXTS; i++)
            if (!strcmp(name, texts[i].name))
                strcpy((char *)p + texts[i].offset, text);
        return s;
    }
    if (!strncmp(s, "null", 4))
        return s + 4;
    const double value = strtod(s, &end);
    return end == s || !isfinite(value) || history_set(p, value, "%s", name) ? NULL : end;
}

static int read_point(const char *s, struct history_point *p)
{
    *p = (struct history_point){.values = 0};
    s = space(s);
    if (*s++ != '{')
        return -1;
    for (s = space(s); *s != '}'; s = space(s)) {
        s = read_member(s, p);
        s = s ? space(s) : "";
        if (*s == ',')
            s = space(s + 1);
        else if (*s != '}')
            return -1;
    }
    return *space(s + 1) || !*p->commit ? -1 : 0;
}

int history_read(struct history *h, const char *path, struct tool_error *error)
{
    char *line = NULL;
    size_t size = 0;
    int err = 0;
    *h = (struct history){0};
    FILE *f = fopen(path, "r");
    if (!f)
        return tool_fail(error, -1, "cannot read the history %s: %s", path, strerror(errno));
    for (int number = 1; !err && getline(&line, &size, f) > 0; number++) {
        if (!*space(line))
            continue;
        struct history_point *more = realloc(h->point, (size_t)(h->points + 1) * sizeof *more);
        if (!more) {
            err = tool_fail(error, -1, "there is not enough memory for the history %s", path);
            break;
        }
        h->point = more;
        if (read_point(line, &h->point[h->points]))
            err = tool_fail(error, -1,
                            "%s:%d: no point of a history: a line is a JSON object with a \"commit\", of texts "
                            "and at most %d numbers",
                            path, number, HISTORY_VALUES);
        else
            h->points++;
    }
    if (!err && ferror(f))
        err = tool_fail(error, -1, "cannot read all of the history %s", path);
    free(line);
    fclose(f);
    return err;
}

void history_free(struct history *h)
{
    free(h->point);
    *h = (struct history){0};
}

void history_members(struct tool_json *j, const struct history_point *p)
{
    for (int i = 0; i < TEXTS; i++)
        tool_json_text(j, texts[i].name, (const char *)p + texts[i].offset);
    for (int i = 0; i < p->values; i++)
        tool_json_number(j, p->value[i].name, p->value[i].value);
}

int history_append(const struct history_point *p, const char *path, struct tool_error *error)
{
    struct tool_json j;
    FILE *f = fopen(path, "a");
    if (!f)
        return tool_fail(error, -1, "cannot write the history %s: %s", path, strerror(errno));
    tool_json_begin(&j, f, 1);
    history_members(&j, p);
    tool_json_end(&j);
    const int failed = ferror(f);
    return fclose(f) || failed ? tool_fail(error, -1, "cannot write all of the history %s", path) : 0;
}
