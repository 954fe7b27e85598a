// SPDX-License-Identifier: BSD-3-Clause
// Parsers of option values. Strict: the whole word must be the value, and in range.
#include "cli/args.h"

#include "cli/nearest.h"

#include <ctype.h>
#include <errno.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *field(struct cli_args *args, const struct cli_option *option)
{
    return (char *)args + option->offset;
}

// What a number may be: "more than 0", "0 to 1024", "0 or more, or inf".
static void describe_limits(const struct cli_option *option, char *buf, size_t size)
{
    const char *inf = option->inf ? ", or inf" : "";
    if (option->max < FLT_MAX)
        snprintf(buf, size, "%g to %g%s", option->min, option->max, inf);
    else if (option->above_min)
        snprintf(buf, size, "more than %g%s", option->min, inf);
    else
        snprintf(buf, size, "%g or more%s", option->min, inf);
}

// The number that text is, all of it. No spaces, no NaN; infinity is left to the caller.
static int read_number(const char *text, double *value)
{
    char *end;
    if (text[0] == '\0' || isspace((unsigned char)text[0]))
        return -1;
    errno = 0;
    *value = strtod(text, &end);
    if (*end != '\0' || isnan(*value))
        return -1;
    // Too large is not what the user called infinite.
    return isinf(*value) && errno == ERANGE ? -1 : 0;
}

// The number before a unit, in the option's own; *metric: it is in metres.
static int read_measure(const struct cli_option *option, const char *text, double *value, int *metric)
{
    static const struct {
        const char *name;
        double metres;
    } units[] = {{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}};
    const size_t length = strlen(text);
    char number[64];
    *metric = 0;
    if (option->unit == CLI_UNIT_FSTOP && (text[0] == 'f' || text[0] == 'F') && text[1] == '/')
        return read_number(text + 2, value);
    const int takes = option->unit == CLI_UNIT_DISTANCE || option->unit == CLI_UNIT_MM || option->unit == CLI_UNIT_M;
    for (int i = 0; i < 3 && takes; i++) {
        const size_t n = strlen(units[i].name);
        if (length <= n || length - n >= sizeof(number) || strcmp(text + length - n, units[i].name) ||
            !(isdigit((unsigned char)text[length - n - 1]) || text[length - n - 1] == '.'))
            continue;
        snprintf(number, sizeof(number), "%.*s", (int)(length - n), text);
        if (read_number(number, value))
            return -1;
        *value *= units[i].metres * (option->unit == CLI_UNIT_MM ? 1000 : 1);
        *metric = option->unit == CLI_UNIT_DISTANCE;
        return 0;
    }
    return read_number(text, value);
}

static int number(struct cli_args *args, const struct cli_option *option, const char *text, float *out,
                  struct cli_error *error)
{
    char limits[64];
    double value;
    int metric;
    describe_limits(option, limits, sizeof(limits));
    for (int i = 0; i < args->metric_count; i++)
        if (args->metric[i] == option->offset)
            args->metric[i--] = args->metric[--args->metric_count];
    if (read_measure(option, text, &value, &metric))
        return cli_fail(error, -1, "--%s: '%s' is not a number, it must be %s", option->name, text, limits);
    // The library computes in float, so that is what has to be in range.
    const float f = (float)value + 0.0f;
    const int is_inf = isinf(value) && value > 0 && option->inf;
    if (!is_inf && (isinf(f) || f < option->min || f > option->max || (option->above_min && f <= option->min)))
        return cli_fail(error, -1, "--%s: '%s' is out of range, it must be %s", option->name, text, limits);
    *out = f;
    if (metric && args->metric_count < CLI_METRIC)
        args->metric[args->metric_count++] = option->offset;
    return 0;
}

int cli_parse_help(struct cli_args *args, const struct cli_option *option, const char *value, struct cli_error *error)
{
    (void)option;
    (void)error;
    args->help = value && !strcmp(value, "all") ? 2 : 1;
    return 0;
}

int cli_parse_flag(struct cli_args *args, const struct cli_option *option, const char *value, struct cli_error *error)
{
    (void)value;
    (void)error;
    *(int *)field(args, option) = 1;
    return 0;
}

int cli_parse_number(struct cli_args *args, const struct cli_option *option, const char *value, struct cli_error *error)
{
    return number(args, option, value, field(args, option), error);
}

// A decimal integer; *end is what follows it.
static int read_int(const char *text, int *value, char **end)
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

int cli_parse_count(struct cli_args *args, const struct cli_option *option, const char *value, struct cli_error *error)
{
    char *end;
    int count;
    if (read_int(value, &count, &end) || *end || count < option->min || count > option->max)
        return cli_fail(error, -1, "--%s: '%s' must be a whole number from %g to %g", option->name, value, option->min,
                        option->max);
    *(int *)field(args, option) = count;
    return 0;
}

int cli_parse_text(struct cli_args *args, const struct cli_option *option, const char *value, struct cli_error *error)
{
    if (value[0] == '\0')
        return cli_fail(error, -1, "--%s: '' is empty, it must be %s", option->name, option->placeholder);
    *(const char **)field(args, option) = value;
    return 0;
}

// Place of a word in "a|b|c", -1 when it is not there.
static int find_choice(const char *list, const char *word)
{
    const size_t length = strlen(word);
    for (int i = 0; *list; i++) {
        const size_t n = strcspn(list, "|");
        if (n == length && !memcmp(list, word, n))
            return i;
        list += n + (list[n] == '|');
    }
    return -1;
}

// Place of the word in "a|b|c" that is nearest to one that is not there; -1 if none is near.
static int nearest_choice(const char *list, const char *word)
{
    const int length = (int)strlen(word);
    int best = -1, least = 0;
    for (int i = 0; *list; i++) {
        const int n = (int)strcspn(list, "|"), distance = cli_word_distance(list, n, word, length);
        if (cli_is_near(distance, n) && (best < 0 || distance < least)) {
            best = i;
            least = distance;
        }
        list += n + (list[n] == '|');
    }
    return best;
}

static int choice(const struct cli_option *option, const char *value, struct cli_error *error)
{
    const int i = find_choice(option->placeholder, value);
    if (i >= 0)
        return i;
    char list[128] = "", meant[64] = "";
    for (const char *c = option->placeholder; *c && strlen(list) < sizeof(list) - 3; c++) {
        const char piece[3] = {*c == '|' ? ',' : *c, *c == '|' ? ' ' : '\0', '\0'};
        strcat(list, piece);
    }
    const char *word = option->placeholder;
    const int near = nearest_choice(word, value);
    for (int k = 0; k < near; k++)
        word = strchr(word, '|') + 1;
    if (near >= 0)
        snprintf(meant, sizeof(meant), " (did you mean %.*s?)", (int)strcspn(word, "|"), word);
    return cli_fail(error, -1, "--%s: '%s' is unknown, there %s %s%s", option->name, value,
                    strchr(option->placeholder, '|') ? "are" : "is", list, meant);
}

int cli_parse_name(struct cli_args *args, const struct cli_option *option, const char *value, struct cli_error *error)
{
    // Enums of the library are ints.
    return hf_value(option->names, value, field(args, option)) == HF_OK || choice(option, value, error) >= 0 ? 0 : -1;
}

int cli_parse_choice(struct cli_args *args, const struct cli_option *option, const char *value, struct cli_error *error)
{
    const int i = choice(option, value, error);
    if (i >= 0)
        *(int *)field(args, option) = i;
    return i < 0 ? -1 : 0;
}

int cli_parse_choice_text(struct cli_args *args, const struct cli_option *option, const char *value,
                          struct cli_error *error)
{
    if (choice(option, value, error) < 0)
        return -1;
    *(const char **)field(args, option) = value;
    return 0;
}

int cli_parse_focus(struct cli_args *args, const struct cli_option *option, const char *value, struct cli_error *error)
{
    args->focus_given = 1;
    args->focus_by = CLI_FOCUS_CENTER;
    if (!strcmp(value, "center"))
        return 0;
    args->focus_by = CLI_FOCUS_DISTANCE;
    if (isalpha((unsigned char)value[0]) && strncasecmp(value, "inf", 3))
        return cli_fail(error, -1, "--focus: '%s' is neither a distance nor center", value);
    return number(args, option, value, &args->focus, error);
}

int cli_parse_focus_at(struct cli_args *args, const struct cli_option *option, const char *value,
                       struct cli_error *error)
{
    char *end;
    args->focus_at_given = 1;
    args->focus_by = CLI_FOCUS_AT;
    if (read_int(value, &args->focus_x, &end) || *end != ',' || read_int(end + 1, &args->focus_y, &end) || *end)
        return cli_fail(error, -1, "--%s: '%s' must be two whole numbers X,Y", option->name, value);
    return 0;
}

// ngon:N[:ROUNDNESS[:DEGREES]], the part after "ngon:".
static int parse_ngon(struct hf_params *params, const char *value, struct cli_error *error)
{
    char *end, part[32];
    const char *text = value + strlen("ngon:");
    double number[2] = {0, 0};  // roundness, degrees
    int count = 0;
    if (read_int(text, &params->aperture.blades, &end) || (*end && *end != ':') || params->aperture.blades < 3 ||
        params->aperture.blades > 16)
        return cli_fail(error, -1, "--aperture: '%s' must have 3 to 16 sides, as in ngon:6", value);
    for (int i = 0; *end; i++) {
        const size_t n = strcspn(end + 1, ":");
        snprintf(part, sizeof(part), "%.*s", (int)n, end + 1);
        if (i > 1 || n >= sizeof(part) || read_number(part, &number[i]) || !isfinite((float)number[i]))
            return cli_fail(error, -1, "--aperture: '%s' is not ngon:N[:ROUNDNESS[:DEGREES]]", value);
        end += 1 + n;
        count++;
    }
    // ngon:6:15 is turned by 15 degrees.
    if (count == 1 && fabs(number[0]) > 1) {
        number[1] = number[0];
        number[0] = 0;
    }
    if (!(number[0] >= 0 && number[0] <= 1))
        return cli_fail(error, -1, "--aperture: '%s' must be rounded by 0 to 1", value);
    params->aperture.roundness = (float)number[0];
    params->aperture.rotation = (float)number[1];
    return 0;
}

int cli_parse_aperture(struct cli_args *args, const struct cli_option *option, const char *value,
                       struct cli_error *error)
{
    struct hf_params *p = &args->params;
    double hole = 0;
    p->aperture.blades = 0;
    p->aperture.rotation = p->aperture.roundness = p->aperture.ring = 0;
    args->aperture = value;
    args->aperture_file = NULL;
    if (!strcmp(value, "disc"))
        return 0;
    if (!strncmp(value, "ngon:", 5))
        return parse_ngon(p, value, error);
    if (strncmp(value, "ring:", 5)) {
        args->aperture_file = value;
        return value[0] ? 0
                        : cli_fail(error, -1, "--%s: '' is empty, it must be %s", option->name, option->placeholder);
    }
    if (read_number(value + 5, &hole) || !(hole >= 0 && hole <= 0.95))
        return cli_fail(error, -1, "--%s: the hole of '%s' must be 0 to 0.95 of the radius", option->name, value);
    p->aperture.ring = (float)hole;
    return 0;
}

int cli_parse_json(struct cli_args *args, const struct cli_option *option, const char *value, struct cli_error *error)
{
    if (value && value[0] == '\0')
        return cli_fail(error, -1, "--%s: '' is empty, it must be a file name", option->name);
    args->json = 1;
    args->json_file = value;
    return 0;
}
