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

static void print_option(const struct cli_option *o)
{
    int at = o->letter ? printf("  -%c, ", o->letter) : printf("      ");
    at += printf("--%s", o->name);
    if (o->placeholder)
        at += printf(" %s", o->placeholder);
    print_wrapped(o->help, at);
}

void cli_print_help(void)
{
    printf("hyperfocal %s: depth of field for rendered pictures\n\n"
           "    hyperfocal INPUT -o OUTPUT [options]\n\n"
           "INPUT holds linear colour and depth, as EXR does. OUTPUT is a copy of it with\n"
           "the colours defocused. A value follows its option as the next word or after =.\n"
           "A shot: INPUT and OUTPUT with a place for the frame number, shot.####.exr (also\n"
           "#, @@@, %%04d, $F4; %%V for the view), or several INPUT.\n",
           hf_version());
    for (int group = 0; group < CLI_GROUPS; group++) {
        printf("\n%s\n", cli_group_names[group]);
        for (int i = 0; i < cli_option_count; i++)
            if ((int)cli_options[i].group == group)
                print_option(&cli_options[i]);
    }
    printf("\nHow much blur\n"
           "  --range, --strength and --near-begin to --far-end choose the range model: blur\n"
           "  grows over a distance of your choice, whatever lens the header has. --fstop,\n"
           "  --focal-length or a complete lens in the header (focus, aperture and\n"
           "  pinholeFocalLength) choose the lens: blur as a camera has it. With neither,\n"
           "  the range is half the focus distance. --focus goes before the header's.\n"
           "\nExamples\n"
           "  hyperfocal shot.exr -o dof.exr --focus 4.2 --range 3\n"
           "  hyperfocal shot.exr -o dof.exr --focus-at 960,540 --fstop 2 --focal-length 50\n"
           "  hyperfocal shot.####.exr -o dof.####.exr --focus center --frames 1-9 --resume\n"
           "\nExit codes: 0 done, 1 bad arguments, 2 some frames failed, 3 all failed.\n");
}
