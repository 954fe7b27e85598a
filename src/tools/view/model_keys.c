// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/model_keys.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/cli/args.h"

static const char *const names[CLI_KEY_COUNT] = {
    [CLI_KEY_FOCUS] = "focus",
    [CLI_KEY_RANGE] = "range",
    [CLI_KEY_STRENGTH] = "strength",
    [CLI_KEY_FSTOP] = "fstop",
    [CLI_KEY_FOCAL_LENGTH] = "focal-length",
    [CLI_KEY_MAX_RADIUS] = "max-radius",
    [CLI_KEY_FOCUS_X] = "focus-at",
};

int view_keys_column(const char *option)
{
    for (int c = 0; c < CLI_KEY_COUNT; c++)
        if (names[c] && !strcmp(names[c], option))
            return c;
    return -1;
}

const char *view_keys_name(int column)
{
    return names[column];
}

int view_keys_any(const struct cli_keys *k)
{
    int any = 0;
    for (int c = 0; c < CLI_KEY_COUNT; c++)
        any |= k->column[c].count > 0;
    return any;
}

int view_keys_copy(struct cli_keys *to, const struct cli_keys *from)
{
    *to = (struct cli_keys){.smooth = from->smooth};
    for (int c = 0; c < CLI_KEY_COUNT; c++) {
        const size_t size = (size_t)from->column[c].count * sizeof(*from->column[c].keys);
        if (!size)
            continue;
        to->column[c].keys = malloc(size);
        if (!to->column[c].keys) {
            cli_keys_free(to);
            return -1;
        }
        memcpy(to->column[c].keys, from->column[c].keys, size);
        to->column[c].count = from->column[c].count;
    }
    return 0;
}

int view_keys_same(const struct cli_keys *a, const struct cli_keys *b)
{
    int same = a->smooth == b->smooth;
    for (int c = 0; c < CLI_KEY_COUNT; c++) {
        same = same && a->column[c].count == b->column[c].count;
        for (int i = 0; same && i < a->column[c].count; i++)
            same = a->column[c].keys[i].frame == b->column[c].keys[i].frame &&
                   a->column[c].keys[i].value == b->column[c].keys[i].value;
    }
    return same;
}

int view_keys_find(const struct cli_keys *k, int column, double frame)
{
    for (int i = 0; i < k->column[column].count; i++)
        if (k->column[column].keys[i].frame == frame)
            return i;
    return -1;
}

int view_keys_set(struct cli_keys *k, int column, double frame, double value)
{
    const struct cli_keyed key = {.frame = frame, .value = value};
    const int n = k->column[column].count;
    int i = view_keys_find(k, column, frame);
    if (i >= 0) {
        k->column[column].keys[i] = key;
        return 0;
    }
    struct cli_keyed *list = realloc(k->column[column].keys, ((size_t)n + 1) * sizeof(*list));
    if (!list)
        return -1;
    for (i = n; i > 0 && list[i - 1].frame > frame; i--)
        list[i] = list[i - 1];
    list[i] = key;
    k->column[column].keys = list;
    k->column[column].count = n + 1;
    return 0;
}

void view_keys_remove(struct cli_keys *k, int column, double frame)
{
    const int i = view_keys_find(k, column, frame);
    if (i < 0)
        return;
    struct cli_keyed *list = k->column[column].keys;
    const int rest = --k->column[column].count - i;
    memmove(list + i, list + i + 1, (size_t)rest * sizeof(*list));
}

// The next frame after `after` at which any column has a key; NAN: none.
static double next_frame(const struct cli_keys *k, double after)
{
    double next = NAN;
    for (int c = 0; c < CLI_KEY_COUNT; c++)
        for (int i = 0; i < k->column[c].count; i++) {
            const double frame = k->column[c].keys[i].frame;
            if (frame > after && !(next <= frame))
                next = frame;
        }
    return next;
}

static void write_row(FILE *out, const struct cli_keys *k, double frame)
{
    fprintf(out, "%.9g", frame);
    for (int c = 0; c < CLI_KEY_COUNT; c++) {
        const int i = names[c] && k->column[c].count ? view_keys_find(k, c, frame) : -1;
        if (names[c] && k->column[c].count)
            fputc(',', out);
        if (i < 0)
            continue;
        fprintf(out, "%.9g", k->column[c].keys[i].value);
        const int y = c == CLI_KEY_FOCUS_X ? view_keys_find(k, CLI_KEY_FOCUS_Y, frame) : -1;
        if (y >= 0)
            fprintf(out, ":%.9g", k->column[CLI_KEY_FOCUS_Y].keys[y].value);
    }
    fputc('\n', out);
}

int view_keys_save(const struct cli_keys *k, const char *path, struct tool_error *error)
{
    char *temporary = NULL;
    if (asprintf(&temporary, "%s.part", path) < 0)
        return tool_fail(error, -1, "%s: out of memory", path);
    FILE *out = fopen(temporary, "we");
    int failed = !out;
    if (out) {
        fputs("frame", out);
        for (int c = 0; c < CLI_KEY_COUNT; c++)
            if (names[c] && k->column[c].count)
                fprintf(out, ",%s", names[c]);
        fputc('\n', out);
        for (double f = next_frame(k, -INFINITY); !isnan(f); f = next_frame(k, f))
            write_row(out, k, f);
        failed = ferror(out) != 0;
        failed |= fclose(out) != 0;
        failed = failed || rename(temporary, path);
    }
    if (failed) {
        tool_fail(error, -1, "the keys could not be saved as %s: %s", path, strerror(errno));
        if (out)
            remove(temporary);
    }
    free(temporary);
    return failed ? -1 : 0;
}
