// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/derived.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

// Fields that options of the command set; those of params.c have their own offset.
static const struct {
    const char *option;
    size_t offset;
} fields[] = {
    {"focus", offsetof(struct hf_params, focus)},
    {"range", offsetof(struct hf_params, range.distance)},
    {"strength", offsetof(struct hf_params, range.strength)},
    {"near-begin", offsetof(struct hf_params, range.near_begin)},
    {"near-end", offsetof(struct hf_params, range.near_end)},
    {"far-begin", offsetof(struct hf_params, range.far_begin)},
    {"far-end", offsetof(struct hf_params, range.far_end)},
    {"max-radius", offsetof(struct hf_params, max_radius)},
    {"fstop", offsetof(struct hf_params, lens.f_number)},
    {"focal-length", offsetof(struct hf_params, lens.focal_length_mm)},
    {"sensor-width", offsetof(struct hf_params, lens.sensor_width_mm)},
    {"world-unit", offsetof(struct hf_params, lens.world_unit_m)},
    {"engine", offsetof(struct hf_params, engine)},
    {"budget-ms", offsetof(struct hf_params, run.budget_ms)},
};

// Where an option's value is in struct hf_params; NULL: nowhere.
static const void *field_of(const struct tool_option *option, const struct hf_params *params)
{
    for (const struct tool_option *o = tool_params_options; o->name; o++)
        if (o == option)
            return (const char *)params + o->offset;
    for (size_t i = 0; i < sizeof(fields) / sizeof(fields[0]); i++)
        if (!strcmp(fields[i].option, option->name))
            return (const char *)params + fields[i].offset;
    return NULL;
}

enum view_kind view_kind(const struct tool_option *o)
{
    if (!o->placeholder)
        return VIEW_FLAG;
    if (o->parse == tool_parse_number || o->parse == tool_parse_count || o->parse == cli_parse_focus)
        return VIEW_NUMBER;
    // A list of words without a place for something else.
    const int words = strchr(o->placeholder, '|') && !strpbrk(o->placeholder, "ABCDEFGHIJKLMNOPQRSTUVWXYZ[");
    return words && o->parse != tool_parse_text ? VIEW_CHOICE : VIEW_TEXT;
}

int view_derived(const struct tool_option *o, const struct hf_params *params, char text[VIEW_VALUE], double *number)
{
    const void *field = field_of(o, params);
    const enum view_kind kind = view_kind(o);
    text[0] = '\0';
    if (!field)
        return 0;
    if (kind == VIEW_CHOICE) {
        const char *name = hf_name(o->names, *(const int *)field);
        snprintf(text, VIEW_VALUE, "%s", name ? name : "");
        return 0;
    }
    if (kind != VIEW_NUMBER)
        return 0;
    *number = o->parse == tool_parse_count ? *(const int *)field : (double)*(const float *)field;
    if (*number == HF_DERIVE && o->min > HF_DERIVE)
        return 0;
    snprintf(text, VIEW_VALUE, "%.4g", *number);
    return 1;
}

struct view_scale view_scale(const struct tool_option *o, double nearest, double farthest)
{
    const int whole = o->parse == tool_parse_count;
    if (view_kind(o) != VIEW_NUMBER)
        return (struct view_scale){VIEW_SCALE_NONE, 0, 0, 0};
    switch (o->unit) {
    case TOOL_UNIT_FSTOP:
        return (struct view_scale){VIEW_SCALE_LOG, 0.35, 64, 0};
    case TOOL_UNIT_MM:
        return (struct view_scale){VIEW_SCALE_LOG, 4, 1200, 0};
    case TOOL_UNIT_M:
        return (struct view_scale){VIEW_SCALE_LOG, 0.001, 1000, 0};
    case TOOL_UNIT_DISTANCE:
        return (struct view_scale){VIEW_SCALE_LOG, nearest * 0.5, farthest * 2, 0};
    case TOOL_UNIT_NONE:
        break;
    }
    if (o->max >= FLT_MAX || o->min <= -FLT_MAX)
        return (struct view_scale){VIEW_SCALE_NONE, 0, 0, 0};
    return (struct view_scale){o->max - o->min >= 200 ? VIEW_SCALE_CUBIC : VIEW_SCALE_LINEAR, o->min, o->max, whole};
}

double view_scale_value(const struct view_scale *s, double t)
{
    const double v = s->kind == VIEW_SCALE_LOG     ? s->low * pow(s->high / s->low, t)
                     : s->kind == VIEW_SCALE_CUBIC ? s->low + (s->high - s->low) * t * t * t
                                                   : s->low + (s->high - s->low) * t;
    return s->whole ? round(v) : v;
}

double view_scale_place(const struct view_scale *s, double value)
{
    const double t = s->kind == VIEW_SCALE_LOG     ? log(fmax(value, s->low) / s->low) / log(s->high / s->low)
                     : s->kind == VIEW_SCALE_CUBIC ? cbrt((value - s->low) / (s->high - s->low))
                                                   : (value - s->low) / (s->high - s->low);
    return t >= 0 && t <= 1 ? t : t > 1 ? 1 : 0;
}
