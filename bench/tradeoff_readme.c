// SPDX-License-Identifier: BSD-3-Clause
// Writes the conclusions of the measurements between two marks of a file that is otherwise written by hand.
#include "tradeoff.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const char begins[] = "<!-- tradeoff: made by hyperfocal-bench, do not edit -->\n",
                  ends[] = "<!-- /tradeoff -->";
enum { COLUMNS = 118 };

// Write words after a number, broken into lines that begin below the first word.
static void paragraph(FILE *out, int number, const char *text)
{
    int at = number ? fprintf(out, "%d. ", number) : 0;
    const int indent = at;
    for (const char *word = text + strspn(text, " \n"); *word;) {
        const int n = (int)strcspn(word, " \n");
        if (at > indent && at + 1 + n > COLUMNS)
            at = fprintf(out, "\n%*s", indent, "") - 1;
        else if (at > indent)
            at += fprintf(out, " ");
        at += fprintf(out, "%.*s", n, word);
        word += n;
        word += strspn(word, " \n");
    }
    fputc('\n', out);
}

// Returns non-zero if writing failed.
static int write_part(FILE *out, const struct trade *t, const char *command)
{
    char *text = NULL, *save = NULL, last[512];
    size_t size;
    FILE *sentences = open_memstream(&text, &size);
    if (!sentences)
        return 1;
    trade_sentences(sentences, t, "", "");
    fclose(sentences);
    int number = 0;
    for (char *line = strtok_r(text, "\n", &save); line; line = strtok_r(NULL, "\n", &save))
        paragraph(out, ++number, line);
    free(text);
    fputc('\n', out);
    trade_qualities_table(out, t);
    fputc('\n', out);
    snprintf(last, sizeof last, "Measured with `%s` on %s, %s, %d thread%s, %s.", command, t->cpu, hf_isa_name(t->isa),
             t->threads, t->threads == 1 ? "" : "s", t->date);
    paragraph(out, 0, last);
    return 0;
}

// A whole file, to be freed by the caller; NULL if it cannot be read.
static char *read_all(const char *path)
{
    FILE *f = fopen(path, "r"), *to;
    char *text = NULL, part[4096];
    size_t size;
    if (!f || !(to = open_memstream(&text, &size))) {
        if (f)
            fclose(f);
        return NULL;
    }
    for (size_t n; (n = fread(part, 1, sizeof part, f)) > 0;)
        fwrite(part, 1, n, to);
    fclose(to);
    if (ferror(f)) {
        free(text);
        text = NULL;
    }
    fclose(f);
    return text;
}

// The file's text, to be freed by the caller, and where the part between the marks begins and ends.
static int find_part(const char *path, char **text, char **from, char **to, struct tool_error *error)
{
    *from = *to = NULL;
    *text = read_all(path);
    if (!*text)
        return tool_fail(error, -1, "--readme: cannot read %s: %s", path, strerror(errno));
    *from = strstr(*text, begins);
    *to = *from ? strstr(*from, ends) : NULL;
    return *to ? 0
               : tool_fail(error, -1, "--readme: %s has no lines '%.*s' and '%s' to write between", path,
                           (int)strlen(begins) - 1, begins, ends);
}

int trade_readme_check(const char *path, struct tool_error *error)
{
    char *text, *from, *to;
    const int err = find_part(path, &text, &from, &to, error);
    free(text);
    return err;
}

int trade_readme(const char *path, const struct trade *t, const char *command, struct tool_error *error)
{
    char *text, *from, *to;
    int err = find_part(path, &text, &from, &to, error);
    FILE *f = err ? NULL : fopen(path, "w");
    if (f) {
        fwrite(text, 1, (size_t)(from - text) + strlen(begins), f);
        err = write_part(f, t, command);
        fputs(to, f);
        err |= ferror(f);
        err |= fclose(f);
    }
    if (!f && !err)
        err = tool_fail(error, -1, "--readme: cannot write %s: %s", path, strerror(errno));
    else if (f && err)
        err = tool_fail(error, -1, "--readme: cannot write all of %s", path);
    free(text);
    return err;
}
