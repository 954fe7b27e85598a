// SPDX-License-Identifier: BSD-3-Clause
// The history of the benchmark, on made-up points: what is written is read again, what is no point is refused with its
// line, and the charts draw each number once and end a line where machine or truth change.
#include "history.h"
#include "support/check.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

static char path[] = "/tmp/hyperfocal-test-XXXXXX";

static struct history_point point(const char *commit, const char *cpu, const char *truth)
{
    struct history_point p = {.source = "made <up>", .isa = "avx2", .date = "2026-01-02"};
    snprintf(p.commit, sizeof p.commit, "%s", commit);
    snprintf(p.cpu, sizeof p.cpu, "%s", cpu);
    snprintf(p.truth, sizeof p.truth, "%s", truth);
    history_set(&p, 2, "threads");
    return p;
}

static void put_file(const char *text)
{
    FILE *f = fopen(path, "w");
    fputs(text, f);
    fclose(f);
}

static void test_round_trip(void)
{
    struct history h;
    struct tool_error error;
    struct history_point p = point("abc1234", "A \"quoted\" \\ CPU", "00ff");
    CHECK_INT(history_set(&p, 12.375, "ms %s", "gather"), 0);
    CHECK_INT(history_set(&p, 1e-7, "pass %s/%s", "gather", "Near CoC Max X"), 0);
    put_file("");
    CHECK_INT(history_read(&h, path, &error), 0);
    CHECK_INT(h.points, 0);
    history_free(&h);
    CHECK_INT(history_append(&p, path, &error), 0);
    CHECK_INT(history_append(&p, path, &error), 0);
    CHECK_INT(history_read(&h, path, &error), 0);
    if (CHECK_INT(h.points, 2)) {
        const struct history_point *q = &h.point[1];
        CHECK(!strcmp(q->commit, p.commit) && !strcmp(q->cpu, p.cpu) && !strcmp(q->source, p.source));
        CHECK(!strcmp(q->isa, p.isa) && !strcmp(q->truth, p.truth) && !strcmp(q->date, p.date));
        CHECK_INT(q->values, 3);
        CHECK(history_get(q, "ms gather") == 12.375 && history_get(q, "pass gather/Near CoC Max X") == 1e-7);
        CHECK(isnan(history_get(q, "ms layers")));
        CHECK(history_same_machine(q, &h.point[0]));
    }
    history_free(&h);
    // A point that is full takes no more numbers.
    while (p.values < HISTORY_VALUES)
        history_set(&p, 1, "x");
    CHECK_INT(history_set(&p, 1, "x"), -1);
}

static void test_refused(void)
{
    static const char *const wrong[] = {
        "[]",
        "{\"commit\": \"a\"",
        "{\"commit\": \"a\" \"date\": \"b\"}",
        "{\"commit\": \"a\", \"ms gather\": x}",
        "{\"commit\": \"a\", \"ms gather\": {}}",
        "{\"commit\": \"a\", \"ms gather\": 1e999}",
        "{\"commit\": \"a}",
        "{\"commit\": \"\\q\"}",
        "{\"commit\": \"\\u00",
        "{\"date\": \"a\"}",
        "{\"commit\": \"a\"} more",
        "{\"commit\"",
        "{",
    };
    struct history h;
    struct tool_error error;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char text[256];
        snprintf(text, sizeof text, "{\"commit\": \"good\", \"ms gather\": null, \"other\": \"text\"}\n\n%s\n",
                 wrong[i]);
        put_file(text);
        CHECK_MSG(history_read(&h, path, &error) < 0 && strstr(error.text, ":3:"), "%s: %s", wrong[i], error.text);
        CHECK_INT(h.points, 1);
        history_free(&h);
    }
    CHECK(history_read(&h, "/proc/no/such/file", &error) < 0 && strstr(error.text, "/proc/no/such/file"));
    history_free(&h);
}

// How often one text occurs in another.
static int count(const char *text, const char *part)
{
    int n = 0;
    for (; (text = strstr(text, part)); text++)
        n++;
    return n;
}

static char *draw(const struct history *h)
{
    char *text;
    size_t size;
    FILE *f = open_memstream(&text, &size);
    history_draw(f, h);
    fclose(f);
    return text;
}

// Count the starts and the segments of the first line with a given style.
static void path_of(const char *text, const char *style, int *begins, int *goes_on)
{
    char head[64];
    snprintf(head, sizeof head, "<path class=\"line %s\" d=\"", style);
    *begins = *goes_on = 0;
    // The legend's own line comes first.
    const char *s = strstr(text, head);
    s = s ? strstr(s + 1, head) : NULL;
    for (s = s ? s + strlen(head) : ""; *s && *s != '"'; s++) {
        *begins += *s == 'M';
        *goes_on += *s == 'L';
    }
}

static void test_draw(void)
{
    struct history_point p[4] = {point("first", "one & only", "1"), point("second", "one & only", "1"),
                                 point("third", "another", "1"), point("fourth", "another", "2")};
    int begins, goes_on;
    for (int i = 0; i < 4; i++) {
        history_set(&p[i], 5 + i, "ms gather");
        history_set(&p[i], 30, "dB layers/lights");
        history_set(&p[i], 20 + i, "ms layers/lights");
        if (i != 1)
            history_set(&p[i], 20 + i, "ms layers/fence");
        history_set(&p[i], 20 + i, "ms layers/foliage");
    }
    struct history h = {4, p};
    char *text = draw(&h);
    CHECK(!strncmp(text, "<svg ", 5) && !strcmp(text + strlen(text) - 7, "</svg>\n"));
    // Four of gather, four of dB, and of layers three means: one has not all scenes.
    CHECK_INT(count(text, "<circle "), 11);
    CHECK_INT(count(text, "</circle>"), 11);
    CHECK_INT(count(text, "one &amp; only"), 5 + 1);  // two points each, less one; the machines' list
    CHECK(!strstr(text, "<up>") && strstr(text, "made &lt;up&gt;"));
    CHECK_INT(count(text, "from first on:"), 1);
    CHECK_INT(count(text, "from third on:"), 1);
    CHECK_INT(count(text, " on: "), 2);
    // Times: two machines with two points each.
    path_of(text, "gather", &begins, &goes_on);
    CHECK(begins == 2 && goes_on == 2);
    // Lines of errors go on across machines, but not across different true pictures.
    const char *lights = strstr(text, ">lights, dB<");
    path_of(lights ? lights : "", "layers", &begins, &goes_on);
    CHECK(begins == 2 && goes_on == 2);
    free(text);
    // Equal values, a single point, no point.
    h.points = 1;
    text = draw(&h);
    CHECK(count(text, "<circle ") == 3 && !strstr(text, "nan") && !strstr(text, "inf"));
    free(text);
    h.points = 0;
    text = draw(&h);
    CHECK(count(text, "<circle ") == 0 && strstr(text, "</svg>"));
    free(text);
}

int main(void)
{
    const int fd = mkstemp(path);
    if (!CHECK(fd >= 0))
        return check_report();
    close(fd);
    test_round_trip();
    test_refused();
    test_draw();
    unlink(path);
    return check_report();
}
