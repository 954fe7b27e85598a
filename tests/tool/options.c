// SPDX-License-Identifier: BSD-3-Clause
// Command lines with a table of two sections: values, units, refusals and their messages.
#include "tools/common/options.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "support/check.h"
#if HF_HAVE_CLI
#include "tools/cli/choose.h"
#endif
#if HF_HAVE_BENCH
#include "../bench/args.h"
#endif

struct inner {
    int count;
    float stop;
};
struct outer {
    int flag, choice, size[2];
    const char *text;
    float distance, length;
    struct inner inner;
};

#define AT(f) .offset = offsetof(struct outer, f)
static const struct tool_option outer_options[] = {
    {.name = "flag", .letter = 'f', .help = "A flag.", .parse = tool_parse_flag, AT(flag)},
    {.name = "choice", .placeholder = "apple|pear|plum", .help = "A fruit.", .parse = tool_parse_choice, AT(choice)},
    {.name = "size", .placeholder = "WxH", .help = "A size.", .parse = tool_parse_size, AT(size), .max = 100},
    {.name = "text", .placeholder = "TEXT", .help = "A text.", .parse = tool_parse_text, AT(text)},
    {.name = "distance",
     .placeholder = "D",
     .help = "A distance.",
     .parse = tool_parse_number,
     AT(distance),
     .max = 1000,
     .unit = TOOL_UNIT_DISTANCE},
    {.name = "length",
     .placeholder = "MM",
     .help = "A length.",
     .parse = tool_parse_number,
     AT(length),
     .max = 1000,
     .unit = TOOL_UNIT_MM},
    {.name = "help", .letter = 'h', .placeholder = "[all|man]", .help = "Help.", .parse = tool_parse_help},
    {.name = NULL},
};
static const struct tool_option inner_options[] = {
    {.name = "count",
     .placeholder = "N",
     .help = "A count.",
     .parse = tool_parse_count,
     .engines = "gather|gaussian",
     .offset = offsetof(struct inner, count),
     .min = 1,
     .max = 9},
    {.name = "stop",
     .placeholder = "N",
     .help = "A stop.",
     .parse = tool_parse_number,
     .offset = offsetof(struct inner, stop),
     .max = 100,
     .above_min = 1,
     .unit = TOOL_UNIT_FSTOP,
     .inf = 1},
    {.name = NULL},
};
static const struct tool_section sections[] = {{outer_options, 0, NULL},
                                               {inner_options, offsetof(struct outer, inner), NULL}};
static const struct tool_program program = {.name = "fruit", .sections = sections, .section_count = 2};

static struct outer args;
static struct tool_error error;
static struct tool_parser parser;
static char heard[256];

static int on_word(struct tool_parser *p, const char *word)
{
    (void)p;
    strcat(strcat(heard, word), " ");
    return 0;
}

static int on_option(struct tool_parser *p, const struct tool_option *o, const char *value, int apart)
{
    (void)p;
    snprintf(heard + strlen(heard), sizeof(heard) - strlen(heard), "[%s=%s%s] ", o->name, value ? value : "",
             apart ? " apart" : "");
    return 0;
}

// Words with one blank between them.
static int parse(const char *line)
{
    static char text[256];
    char *words[32], *save = NULL;
    int n = 0;
    snprintf(text, sizeof(text), "%s", line);
    for (char *w = strtok_r(text, " ", &save); w; w = strtok_r(NULL, " ", &save))
        words[n++] = w;
    args = (struct outer){.choice = -1};
    error.text[0] = heard[0] = '\0';
    parser =
        (struct tool_parser){.program = &program, .args = &args, .error = &error, .word = on_word, .seen = on_option};
    return tool_parse_line(&parser, n, words);
}

static void good(void)
{
    CHECK(!parse("-f --choice pear --size 3x40 --text=a=b --count 9 --stop f/2.8"));
    CHECK(args.flag == 1 && args.choice == 1 && args.size[0] == 3 && args.size[1] == 40);
    CHECK(!strcmp(args.text, "a=b"));
    CHECK(args.inner.count == 9 && args.inner.stop == 2.8f);
    CHECK(tool_given(&parser, "flag") && tool_given(&parser, "stop") && !tool_given(&parser, "length"));
    CHECK(!strcmp(heard, "[flag=] [choice=pear apart] [size=3x40 apart] [text=a=b] [count=9 apart] "
                         "[stop=f/2.8 apart] "));
    CHECK(!parse("in --text - -- --flag -f"));
    CHECK(!strcmp(heard, "in [text=- apart] --flag -f ") && !args.flag);
    CHECK(!parse("--stop inf") && isinf(args.inner.stop));
    CHECK(!parse("--distance -0") && args.distance == 0 && !signbit(args.distance));
}

static void units(void)
{
    CHECK(!parse("--distance 120cm --length 5cm"));
    CHECK(fabsf(args.distance - 1.2f) < 1e-6f && args.length == 50);
    tool_scale_metric(&parser, 0.1f);
    CHECK_MSG(fabsf(args.distance - 12) < 1e-5f && args.length == 50, "%g %g", args.distance, args.length);
    // The last value counts, with its unit or without.
    CHECK(!parse("--distance 120cm --distance 3"));
    tool_scale_metric(&parser, 0.1f);
    CHECK(args.distance == 3);
    CHECK(!parse("--length 0.036m") && fabsf(args.length - 36) < 1e-5f);
}

static void bad(void)
{
    static const struct {
        const char *line, *word;
    } lines[] = {
        {"--flag=1", "--flag takes no value"},
        {"--chioce pear", "did you mean --choice?"},
        {"--help=foo", "--help: 'foo' is unknown, there are all and man"},
        {"--zzz", "unknown option --zzz, see fruit --help"},
        {"-x", "unknown option -x"},
        {"--choice peer", "did you mean pear?"},
        {"--choice kiwi", "there are apple, pear, plum"},
        {"--size 3", "WIDTHxHEIGHT"},
        {"--size 0x3", "WIDTHxHEIGHT"},
        {"--size 3x101", "1 to 100"},
        {"--text", "--text needs a value, TEXT"},
        {"--text --flag", "--text needs a value"},
        {"--text=", "'' is empty"},
        {"--count 0", "'0' must be a whole number from 1 to 9"},
        {"--count 1.5", "whole number"},
        {"--stop 0", "more than 0"},
        {"--stop f/x", "'f/x' is not a number"},
        {"--stop 2.8mm", "not a number"},
        {"--distance inf", "out of range"},
        {"--distance 3km", "not a number"},
        {"--distance nan", "not a number"},
    };
    for (size_t i = 0; i < sizeof(lines) / sizeof(lines[0]); i++) {
        CHECK_MSG(parse(lines[i].line) == -1, "%s is accepted", lines[i].line);
        CHECK_MSG(strstr(error.text, lines[i].word) != NULL, "%s: %s", lines[i].line, error.text);
    }
}

static void help(void)
{
    CHECK(!parse("-h --nonsense") && parser.help == 1);
    CHECK(!parse("--help=all") && parser.help == 2);
    CHECK(!parse("--help man") && parser.help == 3);
}

// Options that an engine does not use.
static void misfits(void)
{
    char text[256];
    CHECK(!strcmp(tool_and("a", text), "a") && !strcmp(tool_and("a|b", text), "a and b"));
    CHECK(!strcmp(tool_and("a|b|c", text), "a, b and c"));
    CHECK(!parse("--flag --count 3") && !tool_misfit(&parser, HF_ENGINE_GATHER));
    const struct tool_option *misfit = tool_misfit(&parser, HF_ENGINE_LAYERS);
    CHECK(misfit && !strcmp(misfit->name, "count"));
    CHECK(!parse("--flag") && !tool_misfit(&parser, HF_ENGINE_LAYERS));
}

#if HF_HAVE_BENCH
const char *const bench_command_words[][2] = {{NULL, NULL}};
#endif

// Options that take a value and have no default.
static int has_no_default(const char *name)
{
    static const char *const names[] = {"output",    "focus-at", "focus-object",  "focus-point", "keys",
                                        "max-error", "log",      "explain-image", "focus-image", "json",
                                        "image",     "truth",    "setting",       "html",        "dump-passes",
                                        "png",       "csv",      "ladder",        "readme",      "help"};
    for (size_t i = 0; i < sizeof(names) / sizeof(*names); i++)
        if (!strcmp(name, names[i]))
            return 1;
    return 0;
}

// A program's table: each name once, help that ends as a sentence, and a default in the help of each option that has one.
static void table(const struct tool_option *options)
{
    for (const struct tool_option *o = options; o->name; o++) {
        for (const struct tool_option *other = options; other < o; other++)
            CHECK_MSG(strcmp(o->name, other->name) != 0, "--%s is there twice", o->name);
        const char last = o->help[strlen(o->help) - 1];
        CHECK_MSG(last == '.' || (o->chooses && last == ':'), "--%s: %s", o->name, o->help);
        if (o->placeholder)
            CHECK_MSG((strstr(o->help, "efault") != NULL) != has_no_default(o->name), "--%s: %s", o->name, o->help);
    }
}

static void tables(void)
{
    table(tool_params_options);
    for (const struct tool_option *o = tool_params_options; o->name; o++)
        CHECK_MSG(o->offset < sizeof(struct hf_params), "--%s", o->name);
#if HF_HAVE_CLI
    table(cli_program.sections[0].options);
#endif
#if HF_HAVE_BENCH
    table(bench_program.sections[0].options);
#endif
}

#if HF_HAVE_CLI
// The help of --quality names the options that the library chooses.
static void qualities(void)
{
    static const enum hf_quality words[] = {HF_QUALITY_DRAFT, HF_QUALITY_STANDARD, HF_QUALITY_BEST};
    for (int i = 0; i < 3; i++) {
        struct hf_params p = hf_default_params();
        struct tool_choice choice;
        CHECK_INT(tool_choose(1080, NULL, &p, words[i], 0, &choice), HF_OK);
        CHECK_MSG(!strcmp(cli_quality_words(i), choice.inner.options), "%s", cli_quality_words(i));
    }
    CHECK(strstr(cli_quality_words(0), "--engine") != NULL);
}
#endif

int main(void)
{
    good();
    units();
    bad();
    help();
    misfits();
    tables();
#if HF_HAVE_CLI
    qualities();
#endif
    return check_report();
}
