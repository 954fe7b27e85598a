// SPDX-License-Identifier: BSD-3-Clause
// Prints the same table of options as a help text and as a man page.
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "tools/common/options.h"

enum { INDENT = 10, COLUMN = 26, WIDTH = 80 };

// Print text, breaking lines between words, indented by column; at: where the cursor is.
static void print_wrapped(const char *text, int column, int at)
{
    if (at > 0 && at >= column - 1) {
        putchar('\n');
        at = 0;
    }
    int here = column;
    printf("%*s", column - at, "");
    while (*text) {
        const int n = (int)strcspn(text, " ");
        if (here > column && here + 1 + n > WIDTH) {
            printf("\n%*s", column, "");
            here = column;
        }
        here += printf("%s%.*s", here > column ? " " : "", n, text);
        text += n + (text[n] == ' ');
    }
    putchar('\n');
}

enum { HELP = 1024 };

// Append `count` letters of words to a text, as far as there is room.
static void add(char text[HELP], const char *words, int count)
{
    const size_t n = strlen(text);
    snprintf(text + n, HELP - n, "%.*s", count, words);
}

// How long the sentence at text is, with its full stop.
static int sentence(const char *text)
{
    const char *end = strstr(text, ". ");
    return end ? (int)(end - text) + 1 : (int)strlen(text);
}

// " draft: --engine gather; best: --engine layers."
static void add_choices(char text[HELP], const struct tool_option *o)
{
    const char *word = o->placeholder;
    for (int i = 0; *word; i++) {
        const int n = (int)strcspn(word, "|");
        add(text, i ? "; " : " ", 2);
        add(text, word, n);
        add(text, ": ", 2);
        add(text, o->chooses(i), HELP);
        word += n + (word[n] == '|');
    }
    add(text, ".", 1);
}

// The help of an option, or its first sentence and the default, behind the engines or commands that it is for. In the
// help of one command its name is left away.
static const char *words_of(const struct tool_option *o, int all, const char *command, char text[HELP])
{
    char engines[256];
    const char *only = o->engines ? o->engines : command ? NULL : o->commands, *dflt = strstr(o->help, ". Default");
    const int length = all ? (int)strlen(o->help) : sentence(o->help);
    text[0] = '\0';
    if (only) {
        add(text, tool_and(only, engines), 256);
        add(text, ": ", 2);
    }
    char *first = text + strlen(text);
    add(text, o->help, length);
    if (only && length > 1 && islower((unsigned char)first[1]))
        *first = (char)tolower((unsigned char)*first);
    if (!all && dflt)
        add(text, dflt + 1, 1 + sentence(dflt + 2));
    if (o->chooses)
        add_choices(text, o);
    return text;
}

// Print an option with its whole help, or the short one.
static void print_option(const struct tool_option *o, int all, const char *command)
{
    int at = o->letter ? printf("  -%c, ", o->letter) : printf("      ");
    at += printf("--%s", o->name);
    // A long list of words may be broken after a bar.
    for (const char *word = o->placeholder; word && *word;) {
        const int n = (int)strcspn(word, "|"), bar = word[n] == '|';
        if (at + 1 + n + bar > WIDTH) {
            printf("\n%*s", INDENT, "");
            at = INDENT;
        }
        at += printf("%s%.*s", word == o->placeholder ? " " : "", n + bar, word);
        word += n + bar;
    }
    char text[HELP];
    print_wrapped(words_of(o, all, command, text), COLUMN, at);
}

static int is_usual(const struct tool_program *program, const struct tool_option *o)
{
    for (int i = 0; program->usual && program->usual[i]; i++)
        if (!strcmp(o->name, program->usual[i]))
            return 1;
    return !program->usual;
}

static int is_of_command(const struct tool_program *program, const struct tool_option *o, const char *command)
{
    const char *commands = tool_commands(program, o);
    return !command || !commands || tool_has_word(commands, command);
}

// Call a function, if not NULL, for each option of a group, in order; of a command, for those that it takes. Returns how
// many there are.
static int each_option(const struct tool_program *program, int group, const char *command,
                       void (*print)(const struct tool_option *option, int all, const char *command), int all)
{
    int count = 0;
    for (int s = 0; s < program->section_count; s++)
        for (const struct tool_option *o = program->sections[s].options; o->name; o++)
            if ((int)o->group == group && (all || is_usual(program, o)) && is_of_command(program, o, command)) {
                count++;
                if (print)
                    print(o, all, command);
            }
    return count;
}

// Print all commands, or the one whose help it is.
static void print_commands(const struct tool_program *program, const char *command)
{
    for (int i = 0, first = 1; program->commands && program->commands[i][0]; i++)
        if (!command || !strcmp(command, program->commands[i][0])) {
            const char *name = program->commands[i][0];
            print_wrapped(program->commands[i][1], COLUMN, printf("%s  %s", first ? "\n" : "", name) - first);
            first = 0;
        }
}

// Print all examples, or those of a command, which begin with the program's name and its own.
static void print_examples(const struct tool_program *program, const char *command)
{
    char begin[128] = "";
    int count = 0;
    if (command)
        snprintf(begin, sizeof begin, "%s %s ", program->name, command);
    for (int i = 0; program->examples[i]; i++)
        if (!strncmp(program->examples[i], begin, strlen(begin)))
            printf("%s  %s\n", count++ ? "" : "\nExamples\n", program->examples[i]);
}

void tool_print_help(const struct tool_program *program, const char *command, int all)
{
    all |= !program->usual;
    printf("%s %s: %s\n\n    %s ", program->name, hf_version(), program->subject, program->name);
    if (command)
        printf("%s [options]\n\n", command);
    else
        printf("%s\n\n", program->usage);
    print_wrapped(program->intro, 0, 0);
    print_commands(program, command);
    if (!all)
        printf("\n");
    for (int group = 0; group < TOOL_GROUPS; group++) {
        if (all && program->groups[group] && each_option(program, group, command, NULL, all))
            printf("\n%s\n", program->groups[group]);
        each_option(program, group, command, print_option, all);
    }
    if (all && program->more) {
        printf("\n%s\n", program->more_title);
        print_wrapped(program->more, 2, 0);
    }
    print_examples(program, command);
    printf("\n");
    print_wrapped(program->outro, 0, 0);
}

// Print text in roff: backslashes and hyphens are escaped, and so are ' and . at the start of a line.
static void put_roff(const char *text)
{
    if (*text == '\'' || *text == '.')
        fputs("\\&", stdout);
    for (; *text; text++)
        switch (*text) {
        case '\\':
            fputs("\\e", stdout);
            break;
        case '-':
            fputs("\\-", stdout);
            break;
        default:
            putchar(*text);
        }
}

static void man_option(const struct tool_option *o, int all, const char *command)
{
    (void)all;
    fputs(".TP\n.B ", stdout);
    if (o->letter)
        printf("\\-%c, ", o->letter);
    fputs("\\-\\-", stdout);
    put_roff(o->name);
    if (o->placeholder) {
        fputs(" \\fR", stdout);
        put_roff(o->placeholder);
    }
    putchar('\n');
    char text[HELP];
    put_roff(words_of(o, 1, command, text));
    putchar('\n');
}

void tool_print_man(const struct tool_program *program)
{
    printf(".TH %s 1 \"\" \"hyperfocal %s\"\n.SH NAME\n%s \\- %s\n.SH SYNOPSIS\n.B %s\n", program->name, hf_version(),
           program->name, program->subject, program->name);
    put_roff(program->usage);
    fputs("\n.SH DESCRIPTION\n", stdout);
    put_roff(program->intro);
    putchar('\n');
    for (int i = 0; program->commands && program->commands[i][0]; i++) {
        printf("%s.TP\n.B %s\n", i ? "" : ".SH COMMANDS\n", program->commands[i][0]);
        put_roff(program->commands[i][1]);
        putchar('\n');
    }
    fputs(".SH OPTIONS\n", stdout);
    for (int group = 0; group < TOOL_GROUPS; group++) {
        if (program->groups[group]) {
            fputs(".SS \"", stdout);
            put_roff(program->groups[group]);
            fputs("\"\n", stdout);
        }
        each_option(program, group, NULL, man_option, 1);
    }
    if (program->more) {
        fputs(".SH \"", stdout);
        put_roff(program->more_title);
        fputs("\"\n", stdout);
        put_roff(program->more);
        putchar('\n');
    }
    fputs(".SH EXAMPLES\n.nf\n", stdout);
    for (int i = 0; program->examples[i]; i++) {
        put_roff(program->examples[i]);
        putchar('\n');
    }
    fputs(".fi\n.SH \"EXIT STATUS\"\n", stdout);
    put_roff(program->outro);
    putchar('\n');
}
