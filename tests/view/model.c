// SPDX-License-Identifier: BSD-3-Clause
// The viewer's model: options as text, undo, conflicts, the command line, keys.
#include "tools/view/model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "support/check.h"

static struct view_model open_model(int argc, char **argv)
{
    struct view_model m;
    struct view_args own;
    struct tool_error error = {""};
    int help;
    CHECK_MSG(view_model_open(&m, &own, argc, argv, &help, &error) == 0, "opening: %s", error.text);
    return m;
}

static int set(struct view_model *m, const char *name, const char *value, int merge)
{
    struct tool_error error;
    int dropped;
    return view_model_set(m, view_option_place(name), value, merge, &dropped, &error);
}

static const char *get(const struct view_model *m, const char *name)
{
    const char *value = view_model_get(m, view_option_place(name));
    return value ? value : "none";
}

static void check_undo(void)
{
    char *argv[] = {"hyperfocal-view", "in.exr", "--fstop", "2", "--focal-length=50"};
    struct view_model m = open_model(5, argv);
    CHECK_MSG(!strcmp(get(&m, "fstop"), "2") && !strcmp(get(&m, "focal-length"), "50"), "values of the command line");
    set(&m, "fstop", "2.1", 1);
    set(&m, "fstop", "2.2", 1);
    CHECK_MSG(set(&m, "fstop", "0", 1) != 0 && !strcmp(get(&m, "fstop"), "2.2"), "a wrong value changes nothing");
    view_model_set_exposure(&m, 1, 0);
    CHECK_MSG(view_model_undo(&m) && m.now.exposure == 0, "exposure is undone");
    CHECK_MSG(view_model_undo(&m) && !strcmp(get(&m, "fstop"), "2"), "a slider's pull is one step: %s",
              get(&m, "fstop"));
    CHECK_MSG(!view_model_undo(&m), "there is no step before the first");
    CHECK_MSG(view_model_redo(&m) && !strcmp(get(&m, "fstop"), "2.2"), "redo");
    CHECK_MSG(view_model_keep(&m, 0) == 0 && view_keys_set(&m.now.keys, CLI_KEY_FOCUS, 3, 4) == 0, "a key");
    CHECK_MSG(view_model_undo(&m) && !view_keys_any(&m.now.keys), "a key is undone");
    CHECK_MSG(view_model_redo(&m) && view_keys_find(&m.now.keys, CLI_KEY_FOCUS, 3) == 0, "and done again");
    view_model_close(&m);
}

static void check_conflicts(void)
{
    char *argv[] = {"hyperfocal-view", "in.exr", "--focus", "5", "--cat-eye", "0.5"};
    struct view_model m = open_model(6, argv);
    CHECK_MSG(set(&m, "focus-at", "10,20", 0) == 0 && !strcmp(get(&m, "focus"), "none"), "focus-at replaces focus");
    CHECK_MSG(set(&m, "engine", "gather", 0) == 0 && !strcmp(get(&m, "cat-eye"), "none"),
              "an engine takes back what it lacks");
    CHECK_MSG(view_model_undo(&m) && !strcmp(get(&m, "cat-eye"), "0.5"), "and undo brings it back");
    CHECK_MSG(set(&m, "quality", "best", 0) == 0 && set(&m, "engine", "scatter", 0) == 0 &&
                  !strcmp(get(&m, "quality"), "none"),
              "an engine takes the quality back");
    view_model_close(&m);
}

static void check_words(void)
{
    char *argv[] = {"hyperfocal-view",   "it's.exr", "--aperture", "ngon:6",
                    "--depth-offset=-2", "--karis",  "--engine",   "gather"};
    struct view_model m = open_model(8, argv);
    struct view_words words;
    struct cli_args args;
    struct tool_error error = {""};
    CHECK_MSG(view_model_words(&m, "out.exr", NULL, &words) == 0, "words");
    char *line = view_words_line(&words);
    const char *wanted =
        "hyperfocal --depth-offset=-2 --engine gather --aperture ngon:6 --karis -o out.exr 'it'\\''s.exr'";
    CHECK_MSG(line && !strcmp(line, wanted), "the line: %s", line);
    CHECK_MSG(view_words_parse(&words, &args, &error) == 0 && args.depth_offset == -2 &&
                  args.params.gather.karis == 1 && args.params.aperture.blades == 6 && !strcmp(args.output, "out.exr"),
              "the command reads it: %s", error.text);
    cli_free_args(&args);
    view_words_free(&words);
    free(line);
    view_model_close(&m);
}

static void check_keys(void)
{
    struct cli_keys keys = {0}, again;
    struct tool_error error = {""};
    char path[] = "/tmp/view-keys-XXXXXX";
    const int file = mkstemp(path);
    view_keys_set(&keys, CLI_KEY_FOCUS, 8, 0.1f);
    view_keys_set(&keys, CLI_KEY_FOCUS, 1, 5);
    view_keys_set(&keys, CLI_KEY_FOCUS, 4, 3);
    view_keys_set(&keys, CLI_KEY_FOCUS, 4, 2);
    view_keys_set(&keys, CLI_KEY_FSTOP, 2, 1.4);
    view_keys_set(&keys, CLI_KEY_FOCUS_X, 2, 30);
    view_keys_set(&keys, CLI_KEY_FOCUS_Y, 2, 40);
    view_keys_remove(&keys, CLI_KEY_FOCUS, 4);
    CHECK_MSG(view_keys_save(&keys, path, &error) == 0 && cli_keys_load(&again, path, 0, &error) == 0, "a trip: %s",
              error.text);
    CHECK_MSG(again.column[CLI_KEY_FOCUS].count == 2 && (float)again.column[CLI_KEY_FOCUS].keys[1].value == 0.1f,
              "values come back whole: %.17g", again.column[CLI_KEY_FOCUS].keys[1].value);
    CHECK_MSG(again.column[CLI_KEY_FOCUS_X].keys[0].value == 30 && again.column[CLI_KEY_FOCUS_Y].keys[0].value == 40,
              "pixels too");
    CHECK_MSG(view_keys_save(&keys, "/nowhere/keys.csv", &error) != 0 && strstr(error.text, "/nowhere/keys.csv"),
              "no folder");
    cli_keys_free(&keys);
    cli_keys_free(&again);
    close(file);
    unlink(path);
}

int main(void)
{
    check_undo();
    check_conflicts();
    check_words();
    check_keys();
    return check_report();
}
