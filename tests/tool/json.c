// SPDX-License-Identifier: BSD-3-Clause
// The JSON writer, letter by letter.
#include "tools/common/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"

static char *text;
static size_t size;

static struct tool_json begin(int on_line)
{
    struct tool_json j;
    free(text);
    tool_json_begin(&j, open_memstream(&text, &size), on_line);
    return j;
}

static void expect(struct tool_json *j, const char *want)
{
    tool_json_end(j);
    fclose(j->out);
    CHECK_MSG(!strcmp(text, want), "%s\ninstead of\n%s", text, want);
}

static void fill(struct tool_json *j)
{
    tool_json_text(j, "a", "x");
    tool_json_open(j, "list", '[');
    tool_json_row(j, NULL, '{');
    tool_json_count(j, "n", -3);
    tool_json_open(j, "in", '[');
    tool_json_flag(j, NULL, 1);
    tool_json_close(j);
    tool_json_close(j);
    tool_json_open(j, NULL, '{');
    tool_json_number(j, "f", 0.5);
    tool_json_close(j);
    tool_json_open(j, NULL, '[');
    tool_json_close(j);
    tool_json_close(j);
    tool_json_ms(j, "ms", 1e4 / 3);
}

int main(void)
{
    struct tool_json j = begin(0);
    fill(&j);
    expect(&j, "{\n  \"a\": \"x\",\n  \"list\": [\n    {\"n\": -3, \"in\": [true]},\n    {\n      \"f\": 0.5\n    },\n"
               "    []\n  ],\n  \"ms\": 3333.333333\n}\n");
    j = begin(1);
    fill(&j);
    expect(&j, "{\"a\": \"x\", \"list\": [{\"n\": -3, \"in\": [true]}, {\"f\": 0.5}, []], \"ms\": 3333.333333}\n");
    // Ending the JSON closes what is open.
    j = begin(1);
    tool_json_open(&j, "a", '[');
    tool_json_open(&j, NULL, '{');
    expect(&j, "{\"a\": [{}]}\n");
    // The shortest digits of a float, nine of a double.
    j = begin(1);
    tool_json_number(&j, "f", 0.8f);
    tool_json_number(&j, "t", 1.0f / 3);
    tool_json_number(&j, "d", 0.123456789012);
    tool_json_number(&j, "i", 1732123);
    tool_json_number(&j, "l", 123456789);
    tool_json_number(&j, "z", -0.0);
    expect(&j, "{\"f\": 0.8, \"t\": 0.33333334, \"d\": 0.123456789, \"i\": 1732123, \"l\": 123456789, \"z\": -0}\n");
    // Values for which JSON has no word, and characters that would end a string or a page's element.
    j = begin(1);
    tool_json_number(&j, "n", NAN);
    tool_json_ms(&j, "i", INFINITY);
    tool_json_text(&j, "t", NULL);
    tool_json_text(&j, "q", "\"\\\n</script>\303\244\377\300\200\355\240\200");
    expect(&j, "{\"n\": null, \"i\": null, \"t\": null, \"q\": \"\\\"\\\\\\u000a\\u003c/script>\303\244"
               "\\ufffd\\ufffd\\ufffd\\ufffd\\ufffd\\ufffd\"}\n");
    // A command as a shell would take it.
    char *words[] = {"a", "b c", "", "it's", "x=1"};
    j = begin(1);
    tool_json_command(&j, "c", 5, words);
    expect(&j, "{\"c\": \"a 'b c' '' 'it'\\\\''s' x=1\"}\n");
    free(text);
    return check_report();
}
