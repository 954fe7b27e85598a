// SPDX-License-Identifier: BSD-3-Clause
// Command lines: tables of options that parser, help text and man page walk, so that they cannot disagree. Parsing has
// no side effects; it opens no file and prints nothing.
#ifndef HF_TOOL_OPTIONS_H
#define HF_TOOL_OPTIONS_H

#include <stdio.h>

#include "hyperfocal/hyperfocal.h"
#include "tools/common/error.h"

// What may stand beside a number: nothing; of a distance m, cm, mm; of millimetres or metres the same; f/ before it.
enum tool_unit { TOOL_UNIT_NONE, TOOL_UNIT_DISTANCE, TOOL_UNIT_MM, TOOL_UNIT_M, TOOL_UNIT_FSTOP };

// Headings under which options are told of.
enum tool_group { TOOL_FILES, TOOL_FOCUS, TOOL_LENS, TOOL_DEPTH, TOOL_LOOK, TOOL_RUN, TOOL_GROUPS };

struct tool_option;
struct tool_parser;
typedef int tool_parse(struct tool_parser *p, const struct tool_option *option, const char *value);

// One row of a table.
struct tool_option {
    const char *name;  // without the dashes
    char letter;       // short form, 0: none
    enum tool_group group;
    const char *placeholder;  // of the value; NULL: takes none; "[FILE]": may have one. Of a choice the very list
                              // of words that are accepted, "a|b"
    const char *help;         // sentences; the short help has the first, and the one that begins with "Default"
    // Of a choice, or NULL: what the word of this number chooses.
    const char *(*chooses)(int number);
    tool_parse *parse;
    size_t offset;         // of what parse sets, in the section's struct
    float min, max;        // of a number, inclusive
    int above_min;         // ... but min itself is excluded
    enum tool_unit unit;   // that may be written behind a number
    int inf;               // inf is accepted
    enum hf_names names;   // of a choice that the library has words for
    const char *engines;   // that it is of use with, "a|b"; NULL: any
    const char *commands;  // likewise, of a program that has some
};

// Options whose values lie in one struct, which lies at base in the arguments.
struct tool_section {
    const struct tool_option *options;  // up to one without a name
    size_t base;
};

// A program, in words. Texts are flowing; who prints them breaks the lines.
struct tool_program {
    const char *name, *subject;  // "depth of field for rendered pictures"
    const char *usage;           // "INPUT -o OUTPUT [options]"
    const char *intro;
    const char *const (*commands)[2];  // names and what they do, up to NULL; or NULL
    const char *const *groups;         // headings, TOOL_GROUPS of them
    const struct tool_section *sections;
    int section_count;
    const char *const *usual;             // options that the short help tells of, up to NULL; NULL: of all
    const char *more_title, *more;        // what is said behind all of the options, or NULL
    const char *const *examples, *outro;  // up to NULL; or NULL
};

enum { TOOL_MOST_OPTIONS = 128 };

struct tool_parser {
    const struct tool_program *program;
    const char *command;  // of the program, if it has some; NULL: not known yet
    void *args;           // in which the sections lie
    struct tool_error *error;
    // What to do with a word that is no option, and after an option was set; NULL: refuse, nothing. apart: the value
    // was a word of its own.
    int (*word)(struct tool_parser *p, const char *word);
    // The option whose value the last word was, if it may have a unit, which a word by itself then is not; else NULL.
    const struct tool_option *measured;
    const char *measure;  // its value
    int (*seen)(struct tool_parser *p, const struct tool_option *option, const char *value, int apart);
    int help;    // 1, or 2 for all of it, or 3 as a man page; the rest of the line is not looked at
    int stop;    // likewise, for another reason
    int metric;  // set by the parser of a value that is in metres
    // Of each option, in the order of the sections.
    struct {
        unsigned char given, metric;  // metric: the value is in metres
    } state[TOOL_MOST_OPTIONS];
};

// Parse the words after the program's name. Returns 0, or -1 with one sentence in *p->error.
int tool_parse_line(struct tool_parser *p, int count, char **words);

// Was the option on the line?
int tool_given(const struct tool_parser *p, const char *name);
// Divide by it what was given in metres: it is how many metres a scene unit has.
void tool_scale_metric(struct tool_parser *p, float unit);

// The first option on the line that is of no use with an engine, or NULL; and a list of words "a|b" as "a and b".
const struct tool_option *tool_misfit(const struct tool_parser *p, enum hf_engine engine);
const char *tool_and(const char *list, char buf[256]);

// Where an option's value lies.
void *tool_field(const struct tool_parser *p, const struct tool_option *option);

// Value parsers. All return 0, or -1 with *p->error filled.
tool_parse tool_parse_flag, tool_parse_number, tool_parse_count, tool_parse_text, tool_parse_name, tool_parse_choice,
    tool_parse_choice_text, tool_parse_size, tool_parse_help;
// The same of a number that stands for itself, and a whole number; *end is what follows that.
int tool_parse_float(struct tool_parser *p, const struct tool_option *option, const char *text, float *out);
int tool_read_int(const char *text, int *value, char **end);
// A number with what may stand beside it, in the option's own unit; *metric: it is in metres. What an error says of the
// units that there are, "" without: "; units are m, cm and mm".
int tool_read_measure(enum tool_unit unit, const char *text, double *value, int *metric);
const char *tool_units(enum tool_unit unit);
// All of a text that is a number, no spaces, no NaN; infinity is left to the caller. Returns 0 or -1.
int tool_read_number(const char *text, double *value);

// The help text: the usual options, or all.
void tool_print_help(const struct tool_program *program, int all);
// The man page, in roff.
void tool_print_man(const struct tool_program *program);

// Options of how a picture looks and how the library runs that mean the same in both programs; their section's struct
// is a struct hf_params.
extern const struct tool_option tool_params_options[];

#endif
