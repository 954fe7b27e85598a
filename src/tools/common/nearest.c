// SPDX-License-Identifier: BSD-3-Clause
#include "tools/common/nearest.h"

#include <string.h>

enum { LONGEST = 63 };

static int least(int a, int b)
{
    return a < b ? a : b;
}

// The number of letters to insert, delete, change or swap with the next, to turn one word into the other; words of up
// to LONGEST.
static int word_distance(const char *a, int a_length, const char *b, int b_length)
{
    // Rows of the distance table: that of two letters before, of the last, and of this letter of a.
    int row[3][LONGEST + 1];
    if (a_length > LONGEST || b_length > LONGEST)
        return 2 * LONGEST;
    for (int k = 0; k <= b_length; k++)
        row[0][k] = row[1][k] = k;
    for (int i = 1; i <= a_length; i++) {
        const int *before = row[(i + 1) % 3], *last = row[(i + 2) % 3];
        int *here = row[i % 3];
        if (i == 1)
            last = row[0];
        here[0] = i;
        for (int k = 1; k <= b_length; k++) {
            here[k] = least(last[k - 1] + (a[i - 1] != b[k - 1]), least(last[k], here[k - 1]) + 1);
            if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
                here[k] = least(here[k], before[k - 2] + 1);
        }
    }
    return row[a_length % 3][b_length];
}

// Whether a word at this distance from one of that length is close enough to be suggested.
static int is_near(int distance, int length)
{
    return distance <= (length > 6 ? 3 : length > 3 ? 2 : 1) && distance < length;
}

void tool_nearest_try(struct tool_nearest *nearest, const char *word, int length, const char *wanted)
{
    const int distance = word_distance(word, length, wanted, (int)strlen(wanted));
    if (is_near(distance, length) && (!nearest->word || distance < nearest->distance))
        *nearest = (struct tool_nearest){word, length, distance};
}
