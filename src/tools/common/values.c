// SPDX-License-Identifier: BSD-3-Clause
// Parsers of option values. They are strict: the whole word must be a valid value.
#include <ctype.h>
#include <errno.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/common/nearest.h"
#include "tools/common/options.h"

void *tool_field(const struct tool_parser *p, const struct tool_option *option)
{
    for (int s = 0; s < p->program->section_count; s++) {
        const struct tool_section *section = &p->program->sections[s];
        for (const struct tool_option *o = section->options; o->name; o++)
            if (o == option)
                return (char *)p->args + section->base + option->offset;
    }
    return NULL;
}

// Describe the range of a number: "more than 0", "0 to 1024", "0 or more, or inf".
static void describe_limits(const struct tool_option *option, char *buf, size_t size)
{
    const char *inf = option->inf ? ", or inf" : "";
    if (option->max < FLT_MAX && option->above_min)
        snprintf(buf, size, "more than %g and up to %g%s", option->min, option->max, inf);
    else if (option->max < FLT_MAX)
        snprintf(buf, size, "%g to %g%s", option->min, option->max, inf);
    else if (option->above_min)
        snprintf(buf, size, "more than %g%s", option->min, inf);
    else
        snprintf(buf, size, "%g or more%s", option->min, inf);
}

int tool_read_number(const char *text, double *value)
{
    char *end;
    if (text[0] == '\0' || isspace((unsigned char)text[0]))
        return -1;
    errno = 0;
    *value = strtod(text, &end);
    if (*end != '\0' || isnan(*value))
        return -1;
    // A number too large for a double is not infinity: the user did not write inf.
    return isinf(*value) && errno == ERANGE ? -1 : 0;
}

static const struct {
    const char *name;
    double metres;
} units[] = {{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}};

const char *tool_units(enum tool_unit unit)
{
    return unit == TOOL_UNIT_NONE ? "" : unit == TOOL_UNIT_FSTOP ? "; f/2.8 will do too" : "; units are m, cm and mm";
}

int tool_read_measure(enum tool_unit unit, const char *text, double *value, int *metric)
{
    const size_t length = strlen(text);
    char number[64];
    *metric = 0;
    if (unit == TOOL_UNIT_FSTOP && (text[0] == 'f' || text[0] == 'F'))
        return tool_read_number(text + (text[1] == '/' ? 2 : 1), value);
    const int takes = unit == TOOL_UNIT_DISTANCE || unit == TOOL_UNIT_MM || unit == TOOL_UNIT_M;
    for (int i = 0; i < 3 && takes; i++) {
        size_t n = length - strlen(units[i].name);
        if (length <= strlen(units[i].name) || strcmp(text + n, units[i].name))
            continue;
        while (n > 1 && text[n - 1] == ' ')  // "1.2 m"
            n--;
        if (n >= sizeof(number) || !(isdigit((unsigned char)text[n - 1]) || text[n - 1] == '.'))
            continue;
        snprintf(number, sizeof(number), "%.*s", (int)n, text);
        if (tool_read_number(number, value))
            return -1;
        *value *= units[i].metres * (unit == TOOL_UNIT_MM ? 1000 : 1);
        *metric = unit == TOOL_UNIT_DISTANCE;
        return 0;
    }
    return tool_read_number(text, value);
}

int tool_parse_float(struct tool_parser *p, const struct tool_option *option, const char *text, float *out)
{
    char limits[64];
    double value;
    int metric;
    describe_limits(option, limits, sizeof(limits));
    if (tool_read_measure(option->unit, text, &value, &metric))
        return tool_fail(p->error, -1, "--%s: '%s' is not a number, it must be %s%s", option->name, text, limits,
                         tool_units(option->unit));
    // The library computes in float, so the float must be in range.
    const float f = (float)value + 0.0f;
    const int is_inf = isinf(value) && value > 0 && option->inf;
    if (!is_inf && (isinf(f) || f < option->min || f > option->max || (option->above_min && f <= option->min)))
        return tool_fail(p->error, -1, "--%s: '%s' is out of range, it must be %s", option->name, text, limits);
    *out = f;
    p->metric = metric;
    return 0;
}

int tool_parse_number(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    return tool_parse_float(p, option, value, tool_field(p, option));
}

int tool_parse_flag(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    (void)value;
    *(int *)tool_field(p, option) = 1;
    return 0;
}

int tool_parse_help(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    if (value && strcmp(value, "man") && strcmp(value, "all"))
        return tool_fail(p->error, -1, "--%s: '%s' is unknown, there are all and man", option->name, value);
    p->help = !value ? 1 : strcmp(value, "man") ? 2 : 3;
    return 0;
}

int tool_read_int(const char *text, int *value, char **end)
{
    if (!isdigit((unsigned char)text[0]) && !(text[0] == '-' && isdigit((unsigned char)text[1])))
        return -1;
    errno = 0;
    const long v = strtol(text, end, 10);
    if (errno || v < INT_MIN || v > INT_MAX)
        return -1;
    *value = (int)v;
    return 0;
}

int tool_parse_count(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    char *end;
    int count;
    if (tool_read_int(value, &count, &end) || *end || count < option->min || count > option->max)
        return tool_fail(p->error, -1, "--%s: '%s' must be a whole number from %.0f to %.0f", option->name, value,
                         option->min, option->max);
    *(int *)tool_field(p, option) = count;
    return 0;
}

int tool_parse_size(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    int size[2];
    char *end;
    if (tool_read_int(value, &size[0], &end) || *end != 'x' || tool_read_int(end + 1, &size[1], &end) || *end ||
        size[0] < 1 || size[1] < 1 || size[0] > option->max || size[1] > option->max)
        return tool_fail(p->error, -1, "--%s: '%s' must be WIDTHxHEIGHT, each a whole number from 1 to %g",
                         option->name, value, option->max);
    memcpy(tool_field(p, option), size, sizeof(size));
    return 0;
}

int tool_parse_text(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    if (!value || value[0] == '\0')
        return tool_fail(p->error, -1, "--%s: '' is empty, it must be %s", option->name, option->placeholder);
    *(const char **)tool_field(p, option) = value;
    return 0;
}

// The index of a word in "a|b|c", or -1 with an error that may suggest the nearest.
static int choice(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct tool_nearest nearest = {NULL, 0, 0};
    char list[256] = "", meant[80] = "";
    size_t used = 0;
    int i = 0;
    for (const char *word = option->placeholder; *word; i++) {
        const int n = (int)strcspn(word, "|");
        if ((size_t)n == strlen(value) && !memcmp(word, value, (size_t)n))
            return i;
        if (used < sizeof(list))
            used += (size_t)snprintf(list + used, sizeof(list) - used, "%s%.*s", i ? ", " : "", n, word);
        tool_nearest_try(&nearest, word, n, value);
        word += n + (word[n] == '|');
    }
    if (nearest.word)
        snprintf(meant, sizeof(meant), " (did you mean %.*s?)", nearest.length, nearest.word);
    return tool_fail(p->error, -1, "--%s: '%s' is unknown, there %s %s%s", option->name, value, i > 1 ? "are" : "is",
                     list, meant);
}

int tool_parse_name(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    // Enums of the library are ints.
    return hf_value(option->names, value, tool_field(p, option)) == HF_OK || choice(p, option, value) >= 0 ? 0 : -1;
}

int tool_parse_choice(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    const int i = choice(p, option, value);
    if (i >= 0)
        *(int *)tool_field(p, option) = i;
    return i < 0 ? -1 : 0;
}

int tool_parse_choice_text(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    if (choice(p, option, value) < 0)
        return -1;
    *(const char **)tool_field(p, option) = value;
    return 0;
}
