// SPDX-License-Identifier: BSD-3-Clause
#include "stability/stability.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "support/check.h"

enum { MAX_ROWS = 2000 };

struct row {
    const char *subject, *what, *why;
    double value, bound;
    char where[100];
    int findings;
};

// Shared with children, so that a case may crash in one.
static struct {
    int count;
    struct row rows[MAX_ROWS];
} * table;
#define rows (table->rows)
#define row_count (table->count)

void stability_open_table(void)
{
    table = mmap(NULL, sizeof *table, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (table == MAP_FAILED)
        abort();
}

static int within(double value, double bound)
{
    return value <= bound;  // NaN is not
}

// Share of the bound, for telling which finding is worse; a bound of 0 is for counts.
static double share(double value, double bound)
{
    if (isnan(value))
        return INFINITY;
    return bound > 0 ? value / bound : value > 0 ? 1 + value : 0;
}

static struct row *row_of(const char *subject, const char *what)
{
    for (int i = 0; i < row_count; i++)
        if (!strcmp(rows[i].subject, subject) && !strcmp(rows[i].what, what))
            return &rows[i];
    if (row_count == MAX_ROWS) {
        fprintf(stderr, "more than %d rows\n", MAX_ROWS);
        abort();
    }
    rows[row_count] = (struct row){.subject = subject, .what = what};
    return &rows[row_count++];
}

static void add_finding(const struct run *r, const char *what, const char *why, double value, double bound,
                        const char *where, va_list args)
{
    struct row *row = row_of(r->subject->name, what);
    if (row->findings++ && share(value, bound) <= share(row->value, row->bound))
        return;
    row->why = why;
    row->value = value;
    row->bound = bound;
    const int n = snprintf(row->where, sizeof row->where, "%s, ", r->isa_name);
    vsnprintf(row->where + n, sizeof row->where - (size_t)n, where, args);
}

void see(const struct run *r, const char *what, const char *why, double value, double bound, const char *where, ...)
{
    va_list args;
    va_start(args, where);
    add_finding(r, what, why, value, bound, where, args);
    va_end(args);
}

void see_look(const struct run *r, const char *what, const char *why, double value, double bound, const char *where,
              ...)
{
    va_list args;
    va_start(args, where);
    bound = known_bound(r, what, bound, &why);
    add_finding(r, what, why, value, bound, where, args);
    va_end(args);
}

const char *row_name(const char *name)
{
    for (int i = 0; i < row_count; i++)
        if (!strcmp(rows[i].what, name))
            return rows[i].what;
    return strdup(name);
}

int stability_passed(void)
{
    int n = 0;
    for (int i = 0; i < row_count; i++)
        n += within(rows[i].value, rows[i].bound);
    return n;
}

void stability_each(void (*fn)(void *cookie, const struct stability_row *row), void *cookie)
{
    for (int i = 0; i < row_count; i++) {
        const struct row *r = &rows[i];
        const struct stability_row row = {
            r->subject, r->what, r->why, r->where, r->value, r->bound, within(r->value, r->bound)};
        fn(cookie, &row);
    }
}

int stability_print(FILE *to)
{
    int failed = 0;
    const char *what = "";
    for (int first = 0; first < row_count; first++) {
        int seen_before = 0;
        for (int i = 0; i < first; i++)
            seen_before |= !strcmp(rows[i].what, rows[first].what);
        if (seen_before)
            continue;
        what = rows[first].what;
        fprintf(to, "\n%s\n    bound: %s\n", what, rows[first].why);
        for (int i = first; i < row_count; i++) {
            const struct row *row = &rows[i];
            if (strcmp(row->what, what))
                continue;
            const int ok = within(row->value, row->bound);
            fprintf(to, "    %-18s %10.4g of %-10.4g %-7s %s\n", row->subject, row->value, row->bound,
                    ok ? "" : "FAILED", row->where);
            if (strcmp(row->why, rows[first].why))
                fprintf(to, "    %18s bound: %s\n", "", row->why);
            failed += !ok;
        }
    }
    return failed;
}
