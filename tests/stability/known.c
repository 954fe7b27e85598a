// SPDX-License-Identifier: BSD-3-Clause
// What does not keep the bound that all others keep: how far it goes, and why. docs/measurements.md says the same. Figures
// are of one seed and of SSE4.1; bounds are half as large again, for other seeds and instruction sets.
#include "stability/stability.h"

#include <string.h>

static const char *const
    rows_of_runs = "known: discs are drawn in rows, whose ends are steps, so a lamp's is not its own transpose",
    *const quads = "known: half-resolution pixels take the CoC of their top left pixel, in the mirror another's",
    *const orders = "known: the hexagon's second blur reads what the first has divided, and left comes before right",
    *const mixed = "known: a lamp that shows in mixed pixels alone cannot be told from their front",
    *const patterns = "known: best continues patterns by choices among what is around, which no_patterns leaves out",
    *const nodes = "known: a cat's eye has its shape at nodes, counted from the left and the top",
    *const unexplained = "known: not explained so far",
    *const levels =
        "known: what begins to be seen closely outweighs 256 times, for each level, what was found farther away",
    *const traces =
        "known: before black surroundings a trace of a lamp decides steeply by which radius they are blurred",
    *const units =
        "known: a sprite has one of 1024 sizes an octave, its rows' ends are 256ths of a pixel, their heights 128ths",
    *const draws = "known: what is hidden is searched along rows and columns in turn";

static const struct known {
    const char *subject, *what;  // they begin with this
    double figure;
    const char *const *why;
} known[] = {
    {"chapter", "mirrored", 67.4, &quads},
    {"hexagon", "mirrored", 124, &orders},
    {"layers cat's eye", "mirrored", 27.6, &nodes},
    {"scatter", "transposed", 71.3, &rows_of_runs},
    {"layers picture", "transposed", 4, &draws},
    {"layers", "transposed", 78.6, &rows_of_runs},
    {"layers best", "lens", 10.3, &patterns},
    {"layers best", "range", 17.4, &patterns},
    {"layers", "lens", 0.631, &levels},
    {"layers best", "one depth", 81, &patterns},
    {"layers best", "one colour", 87, &patterns},
    {"layers best", "crops", 8.85, &patterns},
    {"hexagon", "a lamp behind", 188, &mixed},
    {"scatter", "a lamp behind", 152, &mixed},
    {"layers", "a lamp behind", 77.2, &mixed},
    // In search.c.
    {"hexagon", "a step: focus", 0.587, &unexplained},
    {"layers best", "a step", 18.6, &patterns},
    {"layers", "a step: a depth sample", 3.34, &levels},
    {"hexagon", "a step at night", 0.659, &traces},
    {"scatter", "a step at night", 21.6, &units},
    {"layers", "a step at night", 14.5, &unexplained},
};

double known_bound(const struct run *r, const char *what, double bound, const char **why)
{
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        const struct known *k = &known[i];
        if (strncmp(r->subject->name, k->subject, strlen(k->subject)) || strncmp(what, k->what, strlen(k->what)))
            continue;
        *why = *k->why;
        return 1.5 * k->figure;
    }
    return bound;
}
