// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/lamps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/common/luminance.h"

// A lamp is no wider and no higher than this part of the picture's longer side, or than so many pixels.
static const float PART = 0.04f;
enum { LEAST = 4 };
// What is around it has at most this part of its luminance: more than a stop darker.
static const float DARKER = 0.4f;

// Pixels above the threshold that touch each other, also by corners.
struct spot {
    size_t *at;
    size_t count;
    int x0, y0, x1, y1;
    double sum;  // of luminance
};

static float light(const struct cli_view *v, size_t i)
{
    const float y = tool_luminance(fmaxf(v->planes[0][i], 0), fmaxf(v->planes[1][i], 0), fmaxf(v->planes[2][i], 0));
    return isfinite(y) ? y : 0;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static int most(int a, int b)
{
    return a > b ? a : b;
}

// Gather the spot of pixel i. spot->at has room for all pixels.
static void gather(struct spot *spot, const struct cli_view *v, size_t i, float threshold, unsigned char *seen)
{
    const int width = v->view->width, height = v->view->height;
    const int x = (int)(i % (size_t)width), y = (int)(i / (size_t)width);
    *spot = (struct spot){spot->at, 1, x, y, x, y, 0};
    spot->at[0] = i;
    seen[i] = 1;
    for (size_t k = 0; k < spot->count; k++) {
        const int px = (int)(spot->at[k] % (size_t)width), py = (int)(spot->at[k] / (size_t)width);
        spot->sum += light(v, spot->at[k]);
        spot->x0 = least(spot->x0, px);
        spot->x1 = most(spot->x1, px);
        spot->y0 = least(spot->y0, py);
        spot->y1 = most(spot->y1, py);
        for (int n = 0; n < 9; n++) {
            const int qx = px - 1 + n % 3, qy = py - 1 + n / 3;
            const size_t q = (size_t)qy * (size_t)width + (size_t)qx;
            if (qx < 0 || qy < 0 || qx >= width || qy >= height || seen[q] || !(light(v, q) > threshold))
                continue;
            seen[q] = 1;
            spot->at[spot->count++] = q;
        }
    }
}

// Whether what is around a spot is darker: most pixels of the frame around it, at half its size from it and 2 pixels more,
// beyond what a lens spreads about a lamp.
static int stands_out(const struct spot *spot, const struct cli_view *v)
{
    const int away = 2 + most(spot->x1 - spot->x0, spot->y1 - spot->y0) / 2;
    const int x0 = spot->x0 - away, x1 = spot->x1 + away, y0 = spot->y0 - away, y1 = spot->y1 + away;
    const float dark = DARKER * (float)(spot->sum / (double)spot->count);
    int darker = 0, all = 0;
    for (int y = most(y0, 0); y <= least(y1, v->view->height - 1); y++)
        for (int x = most(x0, 0); x <= least(x1, v->view->width - 1); x++) {
            if (x != x0 && x != x1 && y != y0 && y != y1)
                continue;
            all++;
            darker += light(v, (size_t)y * (size_t)v->view->width + (size_t)x) <= dark;
        }
    return 2 * darker > all;
}

static int is_lamp(const struct spot *spot, const struct cli_view *v)
{
    const int side = most(LEAST, (int)(PART * (float)most(v->view->width, v->view->height)));
    return spot->x1 - spot->x0 < side && spot->y1 - spot->y0 < side && stands_out(spot, v);
}

static int grow(struct cli_lamps *lamps, size_t more)
{
    const size_t n = lamps->count + more;
    size_t *at = realloc(lamps->at, n * sizeof(*at));
    lamps->at = at ? at : lamps->at;
    float *given = at ? realloc(lamps->given, 3 * n * sizeof(*given)) : NULL;
    lamps->given = given ? given : lamps->given;
    float *raised = given ? realloc(lamps->raised, 3 * n * sizeof(*raised)) : NULL;
    lamps->raised = raised ? raised : lamps->raised;
    return raised ? 0 : -1;
}

// As the library raises a pixel, see hf_highlight_params.
static void raise_pixel(const struct hf_highlight_params *p, const float given[3], float raised[3])
{
    const float m = tool_luminance(fmaxf(given[0], 0), fmaxf(given[1], 0), fmaxf(given[2], 0));
    const float t = fminf((m - p->threshold) / (1 - p->threshold), 1);
    for (int c = 0; c < 3; c++)
        raised[c] = given[c] > 0 ? given[c] + given[c] * ((p->gain - 1) * (t * t) / m) : given[c];
}

static int keep(struct cli_lamps *lamps, const struct spot *spot, const struct cli_view *v)
{
    if (grow(lamps, spot->count))
        return -1;
    for (size_t k = 0; k < spot->count; k++) {
        float *given = lamps->given + 3 * lamps->count, *raised = lamps->raised + 3 * lamps->count;
        lamps->at[lamps->count++] = spot->at[k];
        for (int c = 0; c < 3; c++)
            given[c] = v->planes[c][spot->at[k]];
        raise_pixel(&v->setup.params.highlight, given, raised);
    }
    return 0;
}

int cli_lamps_raise(struct cli_lamps *lamps, struct cli_view *v, struct tool_error *error)
{
    const struct hf_highlight_params *p = &v->setup.params.highlight;
    const size_t n = (size_t)v->view->width * (size_t)v->view->height;
    *lamps = (struct cli_lamps){.white = 1};
    v->highlights = 0;
    v->lamps = 0;
    if (!(p->gain > 1))
        return 0;
    struct spot spot = {.at = malloc(n * sizeof(*spot.at))};
    unsigned char *seen = calloc(n, 1);
    int failed = !spot.at || !seen;
    for (size_t i = 0; i < n && !failed; i++) {
        lamps->white = fmaxf(lamps->white, light(v, i));
        if (seen[i] || !(light(v, i) > p->threshold))
            continue;
        gather(&spot, v, i, p->threshold, seen);
        if (!is_lamp(&spot, v))
            continue;
        failed = keep(lamps, &spot, v);
        v->lamps++;
    }
    free(spot.at);
    free(seen);
    for (size_t k = 0; k < lamps->count; k++)
        for (int c = 0; c < 3; c++)
            v->planes[c][lamps->at[k]] = lamps->raised[3 * k + (size_t)c];
    v->highlights = lamps->count;
    return failed ? tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", v->label) : 0;
}

void cli_lamps_lower(struct cli_lamps *lamps, struct cli_view *v)
{
    const size_t n = lamps->count ? (size_t)v->view->width * (size_t)v->view->height : 0;
    for (size_t k = 0; k < lamps->count; k++) {
        const size_t i = lamps->at[k];
        int same = 1;
        for (int c = 0; c < 3; c++)
            same &= !memcmp(&v->planes[c][i], &lamps->raised[3 * k + (size_t)c], sizeof(float));
        for (int c = 0; c < 3 && same; c++)
            v->planes[c][i] = lamps->given[3 * k + (size_t)c];
    }
    for (size_t i = 0; i < n; i++) {
        const float m = light(v, i);
        for (int c = 0; c < 3 && m > lamps->white; c++)
            if (v->planes[c][i] > 0)
                v->planes[c][i] *= lamps->white / m;
    }
}

void cli_lamps_free(struct cli_lamps *lamps)
{
    free(lamps->at);
    free(lamps->given);
    free(lamps->raised);
    *lamps = (struct cli_lamps){0};
}
