// SPDX-License-Identifier: BSD-3-Clause
#include "tools/common/options.h"

#include <assert.h>
#include <string.h>

#include "tools/common/nearest.h"

int tool_has_word(const char *list, const char *word)
{
    const size_t length = strlen(word);
    for (size_t n; *list; list += n + (list[n] == '|')) {
        n = strcspn(list, "|");
        if (n == length && !memcmp(list, word, n))
            return 1;
    }
    return 0;
}

// Option number i, counted over all sections; NULL after the last.
static const struct tool_option *option_at(const struct tool_program *program, int i)
{
    for (int s = 0; s < program->section_count; s++)
        for (const struct tool_option *o = program->sections[s].options; o->name; o++)
            if (i-- == 0)
                return o;
    return NULL;
}

const char *tool_commands(const struct tool_program *program, const struct tool_option *option)
{
    for (int s = 0; s < program->section_count && !option->commands; s++)
        for (const struct tool_option *o = program->sections[s].options; o->name; o++)
            if (o == option)
                return program->sections[s].commands;
    return option->commands;
}

static int place_of(const struct tool_program *program, const char *name, size_t length)
{
    const struct tool_option *o;
    for (int i = 0; (o = option_at(program, i)); i++)
        if (strlen(o->name) == length && !memcmp(o->name, name, length))
            return i;
    return -1;
}

int tool_given(const struct tool_parser *p, const char *name)
{
    const int i = place_of(p->program, name, strlen(name));
    return i >= 0 && p->state[i].given;
}

const struct tool_option *tool_misfit(const struct tool_parser *p, enum hf_engine engine)
{
    const struct tool_option *o;
    for (int i = 0; (o = option_at(p->program, i)); i++)
        if (p->state[i].given && o->engines && !tool_has_word(o->engines, hf_engine_name(engine)))
            return o;
    return NULL;
}

const char *tool_and(const char *list, char buf[256])
{
    size_t used = 0;
    buf[0] = '\0';
    for (int first = 1; *list && used < 250; first = 0) {
        const size_t n = strcspn(list, "|");
        const char *comma = first ? "" : list[n] ? ", " : " and ";
        used += (size_t)snprintf(buf + used, 256 - used, "%s%.*s", comma, (int)n, list);
        list += n + (list[n] == '|');
    }
    return buf;
}

void tool_scale_metric(struct tool_parser *p, float unit)
{
    const struct tool_option *o;
    for (int i = 0; (o = option_at(p->program, i)); i++)
        if (p->state[i].metric)
            *(float *)tool_field(p, o) /= unit;
}

// The index of the option that a word such as --range, --range=5 or -o names, or -1.
static int find_option(const struct tool_program *program, const char *word)
{
    const struct tool_option *o;
    if (word[1] == '-')
        return place_of(program, word + 2, strcspn(word + 2, "="));
    for (int i = 0; (o = option_at(program, i)); i++)
        if (o->letter && word[1] == o->letter && word[2] == '\0')
            return i;
    return -1;
}

// Refuse an unknown option, and suggest the one that may have been meant.
static int unknown_option(const struct tool_parser *p, const char *word)
{
    const struct tool_option *o;
    struct tool_nearest nearest = {NULL, 0, 0};
    char name[64] = "";
    // -fstop is --fstop with a dash missing.
    const char *first = word + (word[1] == '-' ? 2 : 1);
    snprintf(name, sizeof(name), "%.*s", (int)strcspn(first, "="), first);
    for (int i = 0; (o = option_at(p->program, i)) && strlen(name) > 1; i++)
        tool_nearest_try(&nearest, o->name, (int)strlen(o->name), name);
    return tool_fail(p->error, -1, "unknown option %s,%s%s%s see %s --help", word,
                     nearest.word ? " did you mean --" : "", nearest.word ? nearest.word : "", nearest.word ? "?" : "",
                     p->program->name);
}

static int set_value(struct tool_parser *p, int i, const char *value, int apart)
{
    const struct tool_option *o = option_at(p->program, i);
    const char *commands = tool_commands(p->program, o);
    char list[256];
    if (commands && p->command && !tool_has_word(commands, p->command))
        return tool_fail(p->error, -1, "--%s is of use only with %s, not %s", o->name, tool_and(commands, list),
                         p->command);
    p->metric = 0;
    if (o->parse(p, o, value))
        return -1;
    for (int k = 0; k < 2 && o->also[k]; k++)
        memcpy((char *)tool_field(p, o) - o->offset + o->also[k], tool_field(p, o), sizeof(int));
    p->measured = o->unit == TOOL_UNIT_NONE ? NULL : o;
    p->measure = value;
    p->state[i].given = 1;
    p->state[i].metric = p->metric != 0;
    return p->seen ? p->seen(p, o, value, apart) : 0;
}

// Parse the option at words[0]; returns how many words it took, or -1.
static int parse_option(struct tool_parser *p, int count, char **words)
{
    const char *word = words[0];
    const int i = find_option(p->program, word);
    if (i < 0)
        return unknown_option(p, word);
    const struct tool_option *o = option_at(p->program, i);
    const char *value = word[1] == '-' ? strchr(word, '=') : NULL;
    if (!o->placeholder) {
        if (value)
            return tool_fail(p->error, -1, "--%s takes no value, but '%s' was given", o->name, value + 1);
        return set_value(p, i, NULL, 0) ? -1 : 1;
    }
    if (value)
        return set_value(p, i, value + 1, 0) ? -1 : 1;

    // A number may be negative, but a word that looks like a long option is one: the value was forgotten. Several words
    // in quotes are a value.
    const int optional = o->placeholder[0] == '[';
    const char *next = count > 1 ? words[1] : NULL;
    if (next && (optional ? next[0] == '-' : !strncmp(next, "--", 2) && !strchr(next, ' ')))
        next = NULL;
    if (!next && !optional)
        return tool_fail(p->error, -1, "%s needs a value, %s", word, o->placeholder);
    return set_value(p, i, next, next != NULL) ? -1 : next ? 2 : 1;
}

// Is word one of a list "a|b"?
static int in_list(const char *list, const char *word)
{
    const size_t n = strlen(word);
    for (; list && n; list = strchr(list, '|') ? strchr(list, '|') + 1 : NULL)
        if (!strncmp(list, word, n) && (!list[n] || list[n] == '|'))
            return 1;
    return 0;
}

const char *tool_sentence(const struct tool_program *program, const struct hf_message *message, char buf[TOOL_SENTENCE])
{
    const struct tool_option *o;
    for (int i = 0; (o = option_at(program, i)); i++)
        if (in_list(o->field, message->argument)) {
            snprintf(buf, TOOL_SENTENCE, "--%s%s", o->name, message->sentence + strlen(message->argument));
            return buf;
        }
    snprintf(buf, TOOL_SENTENCE, "%s", message->sentence);
    return buf;
}

// A unit that stands alone after the number of an option.
static int lone_unit(const struct tool_parser *p, const char *word)
{
    static const char *const names[] = {"m", "cm", "mm", "km", "ft", "feet", "in", "inch", "meter", "meters", "metres"};
    char text[64];
    double value;
    int metric, known = 0;
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]) && p->measured; i++)
        known |= !strcmp(word, names[i]);
    if (!known)
        return 0;
    snprintf(text, sizeof(text), "%s%s", p->measure, word);
    if (tool_read_measure(p->measured->unit, text, &value, &metric))
        return tool_fail(p->error, -1, "--%s %s: '%s' is no unit here%s", p->measured->name, p->measure, word,
                         tool_units(p->measured->unit));
    return tool_fail(p->error, -1, "'%s' behind --%s %s: did you mean --%s %s?", word, p->measured->name, p->measure,
                     p->measured->name, text);
}

int tool_parse_line(struct tool_parser *p, int count, char **words)
{
    int words_only = 0;  // only words follow "--"
    assert(!option_at(p->program, TOOL_MOST_OPTIONS));
    for (int i = 0; i < count && !p->help && !p->stop;) {
        const char *word = words[i];
        int taken = 1;
        if (!words_only && lone_unit(p, word))
            return -1;
        p->measured = NULL;
        if (!words_only && !strcmp(word, "--"))
            words_only = 1;
        else if (!words_only && word[0] == '-' && word[1] != '\0')
            taken = parse_option(p, count - i, words + i);
        else if (p->word)
            taken = p->word(p, word) ? -1 : 1;
        else
            taken = tool_fail(p->error, -1, "'%s' is no option, see %s --help", word, p->program->name);
        if (taken < 0)
            return -1;
        i += taken;
    }
    return 0;
}
