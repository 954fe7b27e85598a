// SPDX-License-Identifier: BSD-3-Clause
// Prints what a shell needs to complete the command's options, from the table that the command parses with.
//
//     completions bash|zsh|fish
#include <stdio.h>
#include <string.h>

#include "tools/cli/args.h"

enum { WORDS = 512, HELP = 512 };

// What the value of an option may be.
struct value {
    char words[WORDS];  // of a choice, with spaces between them
    int file, folder;
};

// Whether a word of a placeholder stands for itself: "N" and "[FILE]" stand for something else.
static int is_literal(const char *word, size_t n)
{
    return n > 0 && word[0] != '.' && strspn(word, "abcdefghijklmnopqrstuvwxyz0123456789.-") >= n;
}

static struct value value_of(const struct tool_option *o)
{
    struct value v = {.file = o->placeholder && (strstr(o->placeholder, "FILE") || strstr(o->placeholder, "OUTPUT")),
                      .folder = o->placeholder && !strcmp(o->placeholder, "DIR")};
    size_t used = 0;
    for (const char *word = o->placeholder; word && *word;) {
        const size_t n = strcspn(word, "|,:[]");
        if (is_literal(word, n) && (!word[n] || strchr("|,]", word[n])) && used + n + 2 < WORDS)
            used += (size_t)snprintf(v.words + used, WORDS - used, "%s%.*s", used ? " " : "", (int)n, word);
        word += n + (word[n] != 0);
        // What follows a colon belongs to the word before it.
        if (n && word[-1] == ':')
            word += strcspn(word, "|");
    }
    return v;
}

// The first sentence of an option's help, without its full stop and what a shell would read as its own.
static const char *brief(const struct tool_option *o, char text[HELP])
{
    // An enumeration after a colon is not for one line.
    const char *stop = strstr(o->help, ". "), *colon = strstr(o->help, ": ");
    const char *end = colon && (!stop || colon < stop) ? colon : stop;
    const size_t n = end ? (size_t)(end - o->help) : strlen(o->help);
    size_t used = 0;
    for (size_t i = 0; i < n && used + 1 < HELP; i++)
        if (!strchr("'[]:\\`$\"", o->help[i]))
            text[used++] = o->help[i];
    while (used && text[used - 1] == '.')
        used--;
    text[used] = '\0';
    return text;
}

static void each(void (*print)(const struct tool_option *option, const struct value *value))
{
    for (int s = 0; s < cli_program.section_count; s++)
        for (const struct tool_option *o = cli_program.sections[s].options; o->name; o++) {
            const struct value v = value_of(o);
            print(o, &v);
        }
}

static void bash_name(const struct tool_option *o, const struct value *v)
{
    (void)v;
    printf(" --%s", o->name);
}

static void bash_value(const struct tool_option *o, const struct value *v)
{
    if (!o->placeholder || *o->placeholder == '[')
        return;
    printf("    --%s", o->name);
    if (o->letter)
        printf(" | -%c", o->letter);
    printf(") COMPREPLY=(");
    if (v->words[0])
        printf("$(compgen -W '%s' -- \"$cur\") ", v->words);
    if (v->file || v->folder)
        printf("$(compgen -%c -- \"$cur\")", v->folder ? 'd' : 'f');
    printf("); return ;;\n");
}

static void bash(void)
{
    printf("# bash completion for hyperfocal. Made from the command's table of options.\n"
           "_hyperfocal()\n{\n    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]}\n"
           "    compopt -o filenames 2>/dev/null\n    case $prev in\n");
    each(bash_value);
    printf("    esac\n    case $cur in\n    -*) COMPREPLY=($(compgen -W '");
    each(bash_name);
    printf("' -- \"$cur\")) ;;\n    *) COMPREPLY=($(compgen -f -- \"$cur\")) ;;\n    esac\n}\n"
           "complete -F _hyperfocal hyperfocal\n");
}

static void zsh_option(const struct tool_option *o, const struct value *v)
{
    char text[HELP];
    if (o->letter)
        printf("    '(-%c --%s)'{-%c,--%s}'[%s]", o->letter, o->name, o->letter, o->name, brief(o, text));
    else
        printf("    '--%s[%s]", o->name, brief(o, text));
    if (o->placeholder && *o->placeholder != '[') {
        printf(":%s:", v->words[0] ? "word" : o->placeholder);
        if (v->file || v->folder)
            printf("_files%s", v->folder ? " -/" : "");
        else if (v->words[0])
            printf("(%s)", v->words);
    }
    printf("' \\\n");
}

static void zsh(void)
{
    printf("#compdef hyperfocal\n# zsh completion for hyperfocal. Made from the command's table of "
           "options.\n_arguments \\\n");
    each(zsh_option);
    printf("    '*:picture:_files'\n");
}

static void fish_option(const struct tool_option *o, const struct value *v)
{
    char text[HELP];
    printf("complete -c hyperfocal -l %s", o->name);
    if (o->letter)
        printf(" -s %c", o->letter);
    if (o->placeholder && *o->placeholder != '[')
        printf(v->file || v->folder ? " -r -F" : " -x");
    if (v->words[0] && o->placeholder && *o->placeholder != '[')
        printf(" -a '%s'", v->words);
    printf(" -d '%s'\n", brief(o, text));
}

int main(int argc, char **argv)
{
    const char *shell = argc == 2 ? argv[1] : "";
    if (!strcmp(shell, "bash"))
        bash();
    else if (!strcmp(shell, "zsh"))
        zsh();
    else if (!strcmp(shell, "fish")) {
        printf("# fish completion for hyperfocal. Made from the command's table of options.\n");
        each(fish_option);
    } else {
        fprintf(stderr, "usage: completions bash|zsh|fish\n");
        return 1;
    }
    return 0;
}
