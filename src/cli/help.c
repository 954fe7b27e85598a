// SPDX-License-Identifier: BSD-3-Clause
#include "cli/help.h"

#include "cli/args.h"

#include <stdio.h>
#include <string.h>

enum { COLUMN = 26, WIDTH = 80 };

// Print text from COLUMN on, breaking lines between words. at: column where the cursor is.
static void print_wrapped(const char *text, int at)
{
    if (at >= COLUMN - 1) {
        putchar('\n');
        at = 0;
    }
    int column = COLUMN;
    printf("%*s", COLUMN - at, "");
    while (*text) {
        const int n = (int)strcspn(text, " ");
        if (column > COLUMN && column + 1 + n > WIDTH) {
            printf("\n%*s", COLUMN, "");
            column = COLUMN;
        }
        column += printf("%s%.*s", column > COLUMN ? " " : "", n, text);
        text += n + (text[n] == ' ');
    }
    putchar('\n');
}

// The whole help, or its first sentence.
static void print_option(const struct cli_option *o, int all)
{
    int at = o->letter ? printf("  -%c, ", o->letter) : printf("      ");
    at += printf("--%s", o->name);
    if (o->placeholder)
        at += printf(" %s", o->placeholder);
    const char *end = strstr(o->help, ". ");
    char first[512];
    snprintf(first, sizeof(first), "%.*s", end ? (int)(end - o->help) + 1 : (int)strlen(o->help), o->help);
    print_wrapped(all ? o->help : first, at);
}

// What most people need; the rest is told by --help=all.
static int is_usual(const struct cli_option *o)
{
    static const char *const names[] = {"output",   "focus",        "focus-at",   "range",      "max-radius",
                                        "fstop",    "focal-length", "depth-file", "depth-type", "engine",
                                        "aperture", "dry-run",      "help"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (!strcmp(o->name, names[i]))
            return 1;
    return 0;
}

void cli_print_help(int all)
{
    printf("hyperfocal %s: depth of field for rendered pictures\n\n"
           "    hyperfocal INPUT -o OUTPUT [options]\n\n"
           "INPUT holds linear colour and depth, as EXR does. OUTPUT is a copy of it with\n"
           "the colours defocused. A value follows its option as the next word or after =.\n"
           "A shot: INPUT and OUTPUT with a place for the frame number, shot.####.exr (also\n"
           "#, @@@, %%04d, $F4; %%V for the view), or several INPUT.\n",
           hf_version());
    for (int group = 0; group < CLI_GROUPS; group++) {
        if (all)
            printf("\n%s\n", cli_group_names[group]);
        else if (group == 0)
            printf("\n");
        for (int i = 0; i < cli_option_count; i++)
            if ((int)cli_options[i].group == group && (all || is_usual(&cli_options[i])))
                print_option(&cli_options[i], all);
    }
    if (all)
        printf("\nHow much blur\n"
               "  --range, --strength and --near-begin to --far-end choose the range model: blur\n"
               "  grows over a distance of your choice, whatever lens the header has. --fstop,\n"
               "  --focal-length or a complete lens in the header (focus, aperture and\n"
               "  pinholeFocalLength) choose the lens: blur as a camera has it. With neither,\n"
               "  the range is half the focus distance. --focus goes before the header's.\n");
    printf("\nExamples\n"
           "  hyperfocal shot.exr -o dof.exr --focus 4.2 --range 3\n"
           "  hyperfocal shot.exr -o dof.exr --focus-at 960,540 --fstop 2 --focal-length 50\n"
           "  hyperfocal shot.####.exr -o dof.####.exr --focus center --frames 1-9 --resume\n"
           "\nExit codes: 0 done, 1 bad arguments, 2 some frames failed, 3 all failed.\n");
}
