// SPDX-License-Identifier: BSD-3-Clause
// What the window's user has asked for: the command's options with their values as text, the keys of a shot, the
// exposure. All of it can be undone. There is no GTK here.
#ifndef HF_VIEW_MODEL_H
#define HF_VIEW_MODEL_H

#include "tools/cli/args.h"
#include "tools/view/model_keys.h"

// What the command line asks for beyond the command's own options.
struct view_args {
    struct cli_args cli;  // the first member, as the options' tables expect
    int demo, bench, dark;
    const char *profile;
    float rate;  // frames a second; 0: the header's
};

enum { VIEW_OPTIONS = TOOL_MOST_OPTIONS, VIEW_UNDO = 1000 };

// One state of all that can be undone.
struct view_state {
    char *value
        [VIEW_OPTIONS];  // of the options of cli_program, in their order; NULL: not given, "": given, without value
    struct cli_keys keys;
    float exposure;  // stops
};

struct view_model {
    struct view_state now;
    struct view_state *past, *future;  // the last one is the next to go to
    int past_count, future_count;
    int merged;  // the option whose changes make one step at the moment; -1: none
    char **inputs;
    int input_count;
};

// A command line as the command reads it. It owns its texts.
struct view_words {
    char **list;
    int count;
};

const struct tool_program *view_program(void);

// Fill the model from the words of a command line. own gets the viewer's own options; its texts are those of argv. *help is as in struct
// tool_parser. Returns 0, or -1 with *error filled. Close it in either case.
int view_model_open(struct view_model *m, struct view_args *own, int argc, char **argv, int *help,
                    struct tool_error *error);
void view_model_close(struct view_model *m);

// The options of the command: how many there are, one of them, the place of a name or -1.
int view_option_count(void);
const struct tool_option *view_option(int option);
int view_option_place(const char *name);

// The value of an option; NULL: not given.
const char *view_model_get(const struct view_model *m, int option);
// Give an option another value, NULL: its default. Options that cannot stand beside it are taken back: *dropped is the
// last of them, or -1. merge: consecutive changes of this option are one step of undo. Returns 0, or -1 with *error
// filled and the model as it was.
int view_model_set(struct view_model *m, int option, const char *value, int merge, int *dropped,
                   struct tool_error *error);
void view_model_set_exposure(struct view_model *m, float stops, int merge);
// Before a change of keys: the state now becomes a step of undo.
int view_model_keep(struct view_model *m, int merge);
// The next change begins a step of its own.
void view_model_rest(struct view_model *m);
// Replace the inputs. Returns 0, or -1 without memory.
int view_model_open_files(struct view_model *m, char *const *names, int count);

// Return 1 if there was a step to go.
int view_model_undo(struct view_model *m);
int view_model_redo(struct view_model *m);

// The command line without the program's name: options, then inputs. output and keys: values for these options, or NULL. To be
// freed with view_words_free. Returns 0, or -1 without memory.
int view_model_words(const struct view_model *m, const char *output, const char *keys, struct view_words *words);
void view_words_free(struct view_words *words);
// What the command makes of such words. *args needs them alive, and cli_free_args. Returns 0, or -1 with *error filled.
int view_words_parse(const struct view_words *words, struct cli_args *args, struct tool_error *error);
// The words as one line for a shell, the program's name first; to be freed. NULL without memory.
char *view_words_line(const struct view_words *words);

#endif
