// SPDX-License-Identifier: BSD-3-Clause
// Command lines: parser, help text and man page all walk the same tables of options, so they cannot disagree. Parsing
// has no side effects: it opens no file and prints nothing.
#ifndef HF_TOOL_OPTIONS_H
#define HF_TOOL_OPTIONS_H

#include <stdio.h>

#include "hyperfocal/hyperfocal.h"
#include "tools/common/error.h"

// The units that a number may have: none; for a distance m, cm, mm; the same for millimetres or metres; f/ before a
// number.
enum tool_unit { TOOL_UNIT_NONE, TOOL_UNIT_DISTANCE, TOOL_UNIT_MM, TOOL_UNIT_M, TOOL_UNIT_FSTOP };

// Headings under which options are listed.
enum tool_group { TOOL_FILES, TOOL_FOCUS, TOOL_LENS, TOOL_DEPTH, TOOL_LOOK, TOOL_RUN, TOOL_GROUPS };

struct tool_option;
struct tool_parser;
typedef int tool_parse(struct tool_parser *p, const struct tool_option *option, const char *value);

// One row of a table.
struct tool_option {
    const char *name;  // without the dashes
    char letter;       // short form, 0: none
    enum tool_group group;
    // Of the value; NULL: it takes none; "[FILE]": it may have one. For a choice the list of accepted words, "a|b".
    const char *placeholder;
    const char *help;  // sentences; the short help has the first, and the one that begins with "Default"
    // Of a choice, or NULL: what the word of this number chooses.
    const char *(*chooses)(int number);
    tool_parse *parse;
    size_t offset;         // of the member that parse sets, in the section's struct
    size_t also[2];        // of ints and enums that get the same value; 0: none
    float min, max;        // of a number, inclusive
    int above_min;         // min itself is excluded
    enum tool_unit unit;   // of the number, if the user writes one
    int inf;               // inf is accepted
    enum hf_names names;   // for a choice, the library's words
    const char *engines;   // engines that it works with, "a|b"; NULL: any
    const char *commands;  // in programs with commands: those that accept it
    const char *field;     // what it sets of the library's arguments, as in hf_message, "a|b"; NULL: nothing
};

// Options whose values lie in one struct, at offset base in the arguments.
struct tool_section {
    const struct tool_option *options;  // ends with one without a name
    size_t base;
    const char *commands;  // in programs with commands: those that accept them, "a|b"; NULL: all
};

// The texts of a program. They are flowing; the printing functions break the lines.
struct tool_program {
    const char *name, *subject;  // "depth of field for rendered pictures"
    const char *usage;           // "INPUT -o OUTPUT [options]"
    const char *intro;
    const char *const (*commands)[2];  // names and descriptions, ends with NULL; or NULL
    const char *const *groups;         // headings, TOOL_GROUPS of them
    const struct tool_section *sections;
    int section_count;
    const char *const *usual;             // options listed in the short help, ends with NULL; NULL: all
    const char *more_title, *more;        // printed after all options, or NULL
    const char *const *examples, *outro;  // ends with NULL; or NULL
};

enum { TOOL_MOST_OPTIONS = 128 };

struct tool_parser {
    const struct tool_program *program;
    const char *command;  // the program's command, if it has some; NULL: not known yet
    void *args;           // contains the sections' structs
    struct tool_error *error;
    // Called for a word that is not an option (NULL: such words are refused), and after an option was set (NULL:
    // nothing). apart: the value was a separate word.
    int (*word)(struct tool_parser *p, const char *word);
    // The option whose value the last word was, if that value may have a unit; the next word may be the unit. Else
    // NULL.
    const struct tool_option *measured;
    const char *measure;  // its value
    int (*seen)(struct tool_parser *p, const struct tool_option *option, const char *value, int apart);
    int help;    // 1: short help, 2: all of it, 3: man page; the rest of the line is ignored
    int stop;    // stop parsing for another reason; the rest of the line is ignored
    int metric;  // a value's parser sets this if the value is in metres
    // The state of each option, in the order of the sections.
    struct {
        unsigned char given, metric;  // metric: the value is in metres
    } state[TOOL_MOST_OPTIONS];
};

// Parse the words after the program's name. Returns 0, or -1 with one sentence in *p->error.
int tool_parse_line(struct tool_parser *p, int count, char **words);

enum { TOOL_SENTENCE = 512 };
// A sentence of the library about an argument, in the program's words: about its option, if it has one. Returns buf.
const char *tool_sentence(const struct tool_program *program, const struct hf_message *message,
                          char buf[TOOL_SENTENCE]);

// The commands that accept an option, "a|b": its own or its section's; NULL: all.
const char *tool_commands(const struct tool_program *program, const struct tool_option *option);
// Whether the option was on the command line.
int tool_given(const struct tool_parser *p, const char *name);
// Convert the values that were given in metres to scene units; unit: metres per scene unit.
void tool_scale_metric(struct tool_parser *p, float unit);

// The first option on the command line that has no effect with an engine, or NULL; and a list of words "a|b" as "a and
// b".
const struct tool_option *tool_misfit(const struct tool_parser *p, enum hf_engine engine);
const char *tool_and(const char *list, char buf[256]);
// Whether a list "a|b" holds a word.
int tool_has_word(const char *list, const char *word);

// The address of an option's value.
void *tool_field(const struct tool_parser *p, const struct tool_option *option);

// Value parsers. All return 0, or -1 with *p->error filled.
tool_parse tool_parse_flag, tool_parse_number, tool_parse_count, tool_parse_text, tool_parse_name, tool_parse_choice,
    tool_parse_choice_text, tool_parse_size, tool_parse_help;
// Parse a number that stands alone, and an integer; *end is what follows it.
int tool_parse_float(struct tool_parser *p, const struct tool_option *option, const char *text, float *out);
int tool_read_int(const char *text, int *value, char **end);
// A number with its unit, converted to the option's own unit; *metric: it was in metres. The second function returns
// the part of an error message that lists the units, "; units are m, cm and mm", or "".
int tool_read_measure(enum tool_unit unit, const char *text, double *value, int *metric);
const char *tool_units(enum tool_unit unit);
// A text that is entirely a number, without spaces; NaN is refused, infinity is left to the caller. Returns 0 or -1.
int tool_read_number(const char *text, double *value);

// Print the help text with the usual options, or with all. command: only that command's; NULL: of all commands.
void tool_print_help(const struct tool_program *program, const char *command, int all);
// The man page, in roff.
void tool_print_man(const struct tool_program *program);

// Options for the look of a picture and for running the library that mean the same in both programs. Their section's
// struct is a struct hf_params.
extern const struct tool_option tool_params_options[];
// The gather, with an option that only the chapter has, is the chapter: those were one engine. Returns that option's name, or
// NULL.
const char *tool_choose_chapter(const struct tool_parser *p, struct hf_params *params);

#endif
