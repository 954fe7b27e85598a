// SPDX-License-Identifier: BSD-3-Clause
// Parsers of option values that are the command's own.
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/cli/args.h"

int cli_parse_depth_type(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct cli_args *args = p->args;
    args->normalized = !strcmp(value, "normalized") - !strcmp(value, "normalized-inverted");
    if (!args->normalized)
        return tool_parse_name(p, option, value);
    args->depth_type = HF_DEPTH_VIEW;
    return 0;
}

// WxH, or WxH+X+Y.
int cli_parse_display(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct cli_args *args = p->args;
    int d[4] = {0, 0, CLI_CENTRED, CLI_CENTRED};
    char *end;
    int bad = tool_read_int(value, &d[0], &end) || *end != 'x' || tool_read_int(end + 1, &d[1], &end);
    if (!bad && *end == '+')
        bad = tool_read_int(end + 1, &d[2], &end) || *end != '+' || tool_read_int(end + 1, &d[3], &end);
    if (bad || *end || d[0] < 1 || d[1] < 1 || d[0] > 65536 || d[1] > 65536)
        return tool_fail(p->error, -1,
                         "--%s: '%s' must be WxH or WxH+X+Y, whole numbers of pixels, up to 65536 each way",
                         option->name, value);
    memcpy(args->display, d, sizeof(d));
    return 0;
}

int cli_parse_focus(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct cli_args *args = p->args;
    args->focus_given = 1;
    args->focus_by = CLI_FOCUS_CENTER;
    if (!strcmp(value, "center"))
        return 0;
    args->focus_by = CLI_FOCUS_DISTANCE;
    if (isalpha((unsigned char)value[0]) && strncasecmp(value, "inf", 3))
        return tool_fail(p->error, -1, "--focus: '%s' is neither a distance nor center%s", value,
                         tool_units(option->unit));
    return tool_parse_float(p, option, value, &args->focus);
}

int cli_parse_focus_at(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct cli_args *args = p->args;
    char *end;
    args->focus_at_given = 1;
    args->focus_by = CLI_FOCUS_AT;
    if (tool_read_int(value, &args->focus_x, &end) || *end != ',' || tool_read_int(end + 1, &args->focus_y, &end) ||
        *end)
        return tool_fail(p->error, -1, "--%s: '%s' must be two whole numbers X,Y", option->name, value);
    return 0;
}

int cli_parse_focus_object(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct cli_args *args = p->args;
    args->focus_by = CLI_FOCUS_OBJECT;
    return tool_parse_text(p, option, value);
}

// Each --layer adds to those before it.
int cli_parse_layer(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct cli_args *args = p->args;
    const char *before = args->layer;
    char *joined;
    if (tool_parse_text(p, option, value))
        return -1;
    if (!before)
        return 0;
    if (asprintf(&joined, "%s,%s", before, value) < 0)
        return tool_fail(p->error, -1, "out of memory");
    free(args->layers);
    args->layer = args->layers = joined;
    return 0;
}

int cli_parse_other(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct cli_args *args = p->args;
    const int peels = !strcmp(option->name, "peel");
    if (value[0] == '\0')
        return tool_fail(p->error, -1, "--%s: '' is empty, it must be a file name", option->name);
    if (args->other_count && peels != cli_others_peel(args))
        return tool_fail(p->error, -1, "--over and --peel cannot be given together: peels are what one picture hides");
    args->other_option = peels ? "--peel" : "--over";
    args->others[args->other_count++] = value;
    return 0;
}

int cli_parse_focus_point(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct cli_args *args = p->args;
    const char *rest = value;
    int bad = 0;
    args->focus_by = CLI_FOCUS_POINT;
    for (int i = 0; i < 3 && !bad; i++) {
        char part[64];
        double number;
        const size_t n = strcspn(rest, ",");
        snprintf(part, sizeof(part), "%.*s", (int)n, rest);
        bad = n >= sizeof(part) || tool_read_number(part, &number) || !isfinite((float)number) ||
              (rest[n] == ',') != (i < 2);
        args->focus_point[i] = bad ? 0 : (float)number;
        rest += n + (rest[n] == ',');
    }
    return bad ? tool_fail(p->error, -1, "--%s: '%s' must be three numbers X,Y,Z", option->name, value) : 0;
}

// ngon:N[:ROUNDNESS[:DEGREES]], the part after "ngon:".
static int parse_ngon(struct hf_aperture_params *aperture, const char *value, struct tool_error *error)
{
    char *end, part[32];
    const char *text = value + strlen("ngon:");
    double number[2] = {0, 0};  // roundness, degrees
    int count = 0;
    if (tool_read_int(text, &aperture->blades, &end) || (*end && *end != ':') || aperture->blades < 3 ||
        aperture->blades > 16)
        return tool_fail(error, -1, "--aperture: '%s' must have 3 to 16 sides, as in ngon:6", value);
    for (int i = 0; *end; i++) {
        const size_t n = strcspn(end + 1, ":");
        snprintf(part, sizeof(part), "%.*s", (int)n, end + 1);
        if (i > 1 || n >= sizeof(part) || tool_read_number(part, &number[i]) || !isfinite((float)number[i]))
            return tool_fail(error, -1, "--aperture: '%s' is not ngon:N[:ROUNDNESS[:DEGREES]]", value);
        end += 1 + n;
        count++;
    }
    // ngon:6:15 is turned by 15 degrees.
    if (count == 1 && fabs(number[0]) > 1) {
        number[1] = number[0];
        number[0] = 0;
    }
    if (!(number[0] >= 0 && number[0] <= 1))
        return tool_fail(error, -1, "--aperture: '%s' must be rounded by 0 to 1", value);
    aperture->roundness = (float)number[0];
    aperture->rotation = (float)number[1];
    return 0;
}

// The --aperture value that a common word for a shape means; NULL for other words, which may be file names.
static const char *aperture_word(const char *value)
{
    static const char *const words[][2] = {{"circle", "disc"},     {"round", "disc"},      {"disk", "disc"},
                                           {"triangle", "ngon:3"}, {"square", "ngon:4"},   {"pentagon", "ngon:5"},
                                           {"hexagon", "ngon:6"},  {"heptagon", "ngon:7"}, {"octagon", "ngon:8"},
                                           {"ngon", "ngon:6"},     {"polygon", "ngon:6"},  {"ring", "ring:0.5"}};
    for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
        if (!strcasecmp(value, words[i][0]))
            return words[i][1];
    return NULL;
}

int cli_parse_aperture(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct cli_args *args = p->args;
    struct hf_aperture_params *aperture = &args->params.aperture;
    double hole = 0;
    aperture->blades = 0;
    aperture->rotation = aperture->roundness = aperture->ring = 0;
    args->aperture = value;
    args->aperture_file = NULL;
    if (!strcmp(value, "disc"))
        return 0;
    if (!strncmp(value, "ngon:", 5))
        return parse_ngon(aperture, value, p->error);
    const char *meant = aperture_word(value);
    if (meant)
        return tool_fail(p->error, -1, "--%s: '%s' is neither %s, did you mean %s?", option->name, value,
                         "disc, ngon:N, ring:R nor a picture", meant);
    if (strncmp(value, "ring:", 5)) {
        args->aperture_file = value;
        return value[0]
                   ? 0
                   : tool_fail(p->error, -1, "--%s: '' is empty, it must be %s", option->name, option->placeholder);
    }
    if (tool_read_number(value + 5, &hole) || !(hole >= 0 && hole <= 0.95))
        return tool_fail(p->error, -1, "--%s: the hole of '%s' must be 0 to 0.95 of the radius", option->name, value);
    aperture->ring = (float)hole;
    return 0;
}

int cli_parse_json(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct cli_args *args = p->args;
    if (value && value[0] == '\0')
        return tool_fail(p->error, -1, "--%s: '' is empty, it must be a file name", option->name);
    args->json = 1;
    args->json_file = value;
    return 0;
}

int cli_parse_version(struct tool_parser *p, const struct tool_option *option, const char *value)
{
    struct cli_args *args = p->args;
    (void)option;
    (void)value;
    args->version = p->stop = 1;
    return 0;
}
