// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/model.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

int view_option_count(void)
{
    int n = 0;
    for (int s = 0; s < cli_program.section_count; s++)
        for (const struct tool_option *o = cli_program.sections[s].options; o->name; o++)
            n++;
    return n;
}

const struct tool_option *view_option(int option)
{
    for (int s = 0; s < cli_program.section_count; s++)
        for (const struct tool_option *o = cli_program.sections[s].options; o->name; o++)
            if (option-- == 0)
                return o;
    return NULL;
}

int view_option_place(const char *name)
{
    const int n = view_option_count();
    for (int i = 0; i < n; i++)
        if (!strcmp(view_option(i)->name, name))
            return i;
    return -1;
}

static int place_of(const struct tool_option *option)
{
    const int n = view_option_count();
    for (int i = 0; i < n; i++)
        if (view_option(i) == option)
            return i;
    return -1;
}

// States.

static void free_state(struct view_state *s)
{
    for (int i = 0; i < VIEW_OPTIONS; i++)
        free(s->value[i]);
    cli_keys_free(&s->keys);
    *s = (struct view_state){0};
}

static int copy_state(struct view_state *to, const struct view_state *from)
{
    int failed = view_keys_copy(&to->keys, &from->keys);
    to->exposure = from->exposure;
    for (int i = 0; i < VIEW_OPTIONS; i++) {
        to->value[i] = from->value[i] ? strdup(from->value[i]) : NULL;
        failed |= from->value[i] && !to->value[i];
    }
    if (failed)
        free_state(to);
    return failed ? -1 : 0;
}

static void clear(struct view_state **list, int *count)
{
    for (int i = 0; i < *count; i++)
        free_state(&(*list)[i]);
    free(*list);
    *list = NULL;
    *count = 0;
}

// Append a copy of a state to a list. The oldest one goes when the list is full.
static int push(struct view_state **list, int *count, const struct view_state *state)
{
    struct view_state copy;
    if (copy_state(&copy, state))
        return -1;
    if (*count == VIEW_UNDO) {
        free_state(&(*list)[0]);
        memmove(*list, *list + 1, (size_t)-- * count * sizeof(copy));
    }
    struct view_state *more = realloc(*list, ((size_t)*count + 1) * sizeof(copy));
    if (!more) {
        free_state(&copy);
        return -1;
    }
    more[(*count)++] = copy;
    *list = more;
    return 0;
}

// Go to the last state of a list, and remember the present one in the other.
static int go(struct view_model *m, struct view_state **from, int *from_count, struct view_state **to, int *to_count)
{
    if (!*from_count || push(to, to_count, &m->now))
        return 0;
    free_state(&m->now);
    m->now = (*from)[--*from_count];
    m->merged = -1;
    return 1;
}

int view_model_undo(struct view_model *m)
{
    return go(m, &m->past, &m->past_count, &m->future, &m->future_count);
}

int view_model_redo(struct view_model *m)
{
    return go(m, &m->future, &m->future_count, &m->past, &m->past_count);
}

// merge: what the change is of, -1: nothing that is merged.
static int keep(struct view_model *m, int merge)
{
    if (merge >= 0 && m->merged == merge)
        return 0;
    clear(&m->future, &m->future_count);
    m->merged = merge;
    return push(&m->past, &m->past_count, &m->now);
}

enum { MERGE_EXPOSURE = VIEW_OPTIONS, MERGE_KEYS };

int view_model_keep(struct view_model *m, int merge)
{
    return keep(m, merge ? MERGE_KEYS : -1);
}

void view_model_rest(struct view_model *m)
{
    m->merged = -1;
}

void view_model_set_exposure(struct view_model *m, float stops, int merge)
{
    if (stops == m->now.exposure || keep(m, merge ? MERGE_EXPOSURE : -1))
        return;
    m->now.exposure = stops;
}

// The command line.

static const struct tool_option own_options[] = {
    {"demo", 0, TOOL_RUN, NULL, "Show a moving scene in place of a picture. With --frames N it ends after N frames.",
     .parse = tool_parse_flag, .offset = offsetof(struct view_args, demo)},
    {"bench", 0, TOOL_RUN, NULL, "Measure how fast the window answers, print that, and end.", .parse = tool_parse_flag,
     .offset = offsetof(struct view_args, bench)},
    {"dark", 0, TOOL_RUN, NULL, "Light text on dark, whatever the desktop says.", .parse = tool_parse_flag,
     .offset = offsetof(struct view_args, dark)},
    {"fps", 0, TOOL_FILES, "N",
     "Play a shot at this rate, frames a second, 0.1 to 1000. Default: the header's framesPerSecond, "
     "else 24.",
     .parse = tool_parse_number, .offset = offsetof(struct view_args, rate), .min = 0.1f, .max = 1000},
    {"profile", 0, TOOL_RUN, "FILE", "On leaving write the averages of each 100 frames and of every pass.",
     .parse = tool_parse_text, .offset = offsetof(struct view_args, profile)},
    {.name = NULL},
};

const struct tool_program *view_program(void)
{
    static const char *const usual[] = {"focus",   "focus-at",   "fstop",   "focal-length", "engine",
                                        "quality", "depth-file", "frames",  "keys",         "fps",
                                        "demo",    "bench",      "profile", "help",         NULL};
    static const char *const examples[] = {"hyperfocal-view shot.####.exr", "hyperfocal-view --demo", NULL};
    static struct tool_section sections[3];
    static struct tool_program program;
    memcpy(sections, cli_program.sections, 2 * sizeof(sections[0]));
    sections[2] = (struct tool_section){own_options, 0, NULL};
    program = (struct tool_program){
        .name = "hyperfocal-view",
        .subject = "see depth of field while it is set",
        .usage = "[INPUT] [options]",
        .intro = "A window in which a click focuses and sliders turn the lens, while the picture answers. INPUT is "
                 "what hyperfocal "
                 "takes: a picture with depth, or a shot, shot.####.exr. The options are those of hyperfocal.",
        .groups = cli_program.groups,
        .sections = sections,
        .section_count = 3,
        .usual = usual,
        .examples = examples,
        .outro = "Exit codes: 0 done; 1 the command line is wrong, or there is no display.",
    };
    return &program;
}

// tool_parser has no place for more than the arguments: the model lies beside them.
static struct view_model *model_read;

static int on_option(struct tool_parser *p, const struct tool_option *o, const char *value, int apart)
{
    const int i = place_of(o);
    (void)apart;
    if (i < 0)
        return 0;
    free(model_read->now.value[i]);
    model_read->now.value[i] = strdup(value ? value : "");
    return model_read->now.value[i] ? 0 : tool_fail(p->error, -1, "out of memory");
}

static int add_input(struct view_model *m, const char *name)
{
    char **list = realloc(m->inputs, ((size_t)m->input_count + 1) * sizeof(*list));
    if (!list)
        return -1;
    m->inputs = list;
    list[m->input_count] = strdup(name);
    return list[m->input_count] ? (m->input_count++, 0) : -1;
}

static int on_word(struct tool_parser *p, const char *word)
{
    if (!word[0])
        return tool_fail(p->error, -1, "INPUT: '' is empty, it must be a file name");
    return add_input(model_read, word) ? tool_fail(p->error, -1, "out of memory") : 0;
}

static int check(const struct view_model *m, struct tool_error *error)
{
    struct view_words words;
    struct cli_args args;
    if (view_model_words(m, NULL, NULL, &words))
        return tool_fail(error, -1, "out of memory");
    const int status = view_words_parse(&words, &args, error);
    cli_free_args(&args);
    view_words_free(&words);
    return status;
}

int view_model_open(struct view_model *m, struct view_args *own, int argc, char **argv, int *help,
                    struct tool_error *error)
{
    struct tool_parser p = {.program = view_program(), .args = own, .error = error, .word = on_word, .seen = on_option};
    *m = (struct view_model){.merged = -1};
    *own = (struct view_args){.cli = {.params = hf_default_params()}};
    model_read = m;
    const int status = tool_parse_line(&p, argc - 1, argv + 1);
    *help = p.help;
    own->cli.version |= p.stop;
    return status || p.help || p.stop ? status : check(m, error);
}

static void free_inputs(struct view_model *m)
{
    for (int i = 0; i < m->input_count; i++)
        free(m->inputs[i]);
    free(m->inputs);
    m->inputs = NULL;
    m->input_count = 0;
}

void view_model_close(struct view_model *m)
{
    free_state(&m->now);
    clear(&m->past, &m->past_count);
    clear(&m->future, &m->future_count);
    free_inputs(m);
}

int view_model_open_files(struct view_model *m, char *const *names, int count)
{
    int status = 0;
    free_inputs(m);
    for (int i = 0; i < count && !status; i++)
        status = add_input(m, names[i]);
    return status;
}

// Values.

const char *view_model_get(const struct view_model *m, int option)
{
    return option < 0 ? NULL : m->now.value[option];
}

// A given option, other than `kept`, that an error's sentence names; -1: none.
static int named_option(const struct view_model *m, const char *sentence, int kept)
{
    for (const char *c = strstr(sentence, "--"); c; c = strstr(c + 2, "--")) {
        const size_t n = strspn(c + 2, "abcdefghijklmnopqrstuvwxyz-");
        for (int i = 0; i < view_option_count(); i++) {
            const char *name = view_option(i)->name;
            if (i != kept && m->now.value[i] && strlen(name) == n && !memcmp(name, c + 2, n))
                return i;
        }
    }
    return -1;
}

// Take back what cannot stand beside an option, as the command's own sentences name it.
static int settle(struct view_model *m, int option, int *dropped, struct tool_error *error)
{
    int status = check(m, error);
    for (int i = 0; i < 16 && status; i++) {
        const int other = named_option(m, error->text, option);
        if (other < 0)
            return status;
        free(m->now.value[other]);
        m->now.value[other] = NULL;
        *dropped = other;
        status = check(m, error);
    }
    return status;
}

int view_model_set(struct view_model *m, int option, const char *value, int merge, int *dropped,
                   struct tool_error *error)
{
    struct view_state before;
    char *copy = value ? strdup(value) : NULL;
    *dropped = -1;
    if ((value && !copy) || copy_state(&before, &m->now)) {
        free(copy);
        return tool_fail(error, -1, "out of memory");
    }
    free(m->now.value[option]);
    m->now.value[option] = copy;
    const int status = settle(m, option, dropped, error);
    struct view_state after = m->now;
    m->now = before;
    if (status) {
        free_state(&after);
        return status;
    }
    if (keep(m, merge ? option : -1)) {
        free_state(&after);
        return tool_fail(error, -1, "out of memory");
    }
    free_state(&m->now);
    m->now = after;
    return 0;
}

// Words.

void view_words_free(struct view_words *words)
{
    for (int i = 0; i < words->count; i++)
        free(words->list[i]);
    free(words->list);
    *words = (struct view_words){0};
}

static int add_word(struct view_words *w, const char *a, const char *b, const char *c)
{
    char **list = realloc(w->list, ((size_t)w->count + 2) * sizeof(*list));
    if (!list)
        return -1;
    w->list = list;
    list[w->count + 1] = NULL;
    if (asprintf(&list[w->count], "%s%s%s", a, b, c) < 0)
        return -1;
    w->count++;
    return 0;
}

static int add_option(struct view_words *w, const struct tool_option *o, const char *value)
{
    if (!o->placeholder || (o->placeholder[0] == '[' && !value[0]))
        return add_word(w, "--", o->name, "");
    if (o->placeholder[0] != '[' && value[0] != '-')
        return add_word(w, "--", o->name, "") || add_word(w, value, "", "") ? -1 : 0;
    char *head = NULL;
    if (asprintf(&head, "--%s=", o->name) < 0)
        return -1;
    const int status = add_word(w, head, value, "");
    free(head);
    return status;
}

// Options that view_model_words adds by itself.
static int is_added(const char *name)
{
    return !strcmp(name, "output") || !strcmp(name, "dry-run") || !strcmp(name, "keys") || !strcmp(name, "keys-blend");
}

int view_model_words(const struct view_model *m, const char *output, const char *keys, struct view_words *words)
{
    const int n = view_option_count();
    int failed = 0, dashes = 0;
    *words = (struct view_words){0};
    for (int i = 0; i < n && !failed; i++)
        if (m->now.value[i] && !is_added(view_option(i)->name))
            failed = add_option(words, view_option(i), m->now.value[i]);
    if (!failed && keys)
        failed = add_option(words, view_option(view_option_place("keys")), keys);
    if (!failed && keys && m->now.keys.smooth)
        failed = add_word(words, "--keys-blend", "", "") || add_word(words, "smooth", "", "");
    if (!failed && output)
        failed = add_word(words, "-o", "", "") || add_word(words, output, "", "");
    else if (!failed)
        failed = add_word(words, "--dry-run", "", "");
    for (int i = 0; i < m->input_count; i++)
        dashes |= m->inputs[i][0] == '-';
    if (!failed && dashes)
        failed = add_word(words, "--", "", "");
    for (int i = 0; i < m->input_count && !failed; i++)
        failed = add_word(words, m->inputs[i], "", "");
    if (!failed && !m->input_count)
        failed = add_word(words, "picture.exr", "", "");  // there is none yet
    if (failed)
        view_words_free(words);
    return failed ? -1 : 0;
}

int view_words_parse(const struct view_words *words, struct cli_args *args, struct tool_error *error)
{
    char **argv = calloc((size_t)words->count + 2, sizeof(*argv));
    *args = (struct cli_args){0};
    if (!argv)
        return tool_fail(error, -1, "out of memory");
    argv[0] = (char *)"hyperfocal";
    memcpy(argv + 1, words->list, (size_t)words->count * sizeof(*argv));
    const int status = cli_parse_args(args, words->count + 1, argv, error);
    free(argv);
    return status;
}

// A word as a shell reads it: in quotes where it holds more than letters, digits and harmless marks.
static char *quoted(const char *word)
{
    const char *plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./=,:%@+";
    if (word[0] && word[strspn(word, plain)] == '\0')
        return strdup(word);
    char *text = malloc(4 * strlen(word) + 3), *to = text;
    if (!text)
        return NULL;
    *to++ = '\'';
    for (; *word; word++) {
        if (*word == '\'') {
            memcpy(to, "'\\'", 3);
            to += 3;
        }
        *to++ = *word;
    }
    memcpy(to, "'", 2);
    return text;
}

char *view_words_line(const struct view_words *words)
{
    char *line = strdup("hyperfocal");
    for (int i = 0; i < words->count && line; i++) {
        char *word = quoted(words->list[i]), *longer = NULL;
        if (word && asprintf(&longer, "%s %s", line, word) < 0)
            longer = NULL;
        free(word);
        free(line);
        line = longer;
    }
    return line;
}
