// SPDX-License-Identifier: BSD-3-Clause
// Charts of time against error, as SVG, for the page and for the README's picture.
#ifndef HF_BENCH_PAGE_CHART_H
#define HF_BENCH_PAGE_CHART_H

#include "tradeoff.h"

struct chart {
    const char *id;
    const char *name;   // label of its button
    const char *title;  // what the error is
    int both;           // time of 1080p `both`, not the mean over the scenes
    // The value drawn upwards; for a distance, that of a region. NAN: a setting has none.
    double (*error)(const struct trade *t, const struct trade_result *r, enum bench_region region);
    enum bench_region region;
    int decibel;  // with a second scale in decibels
};

extern const struct chart trade_charts[];
extern const int trade_chart_count;

// How many settings can be drawn. A chart without any is left out.
int chart_points(const struct trade *t, const struct chart *c);
// Write a chart. alone: as a file of its own, with style; else as a part of the page.
void chart_write(FILE *out, const struct trade *t, const struct chart *c, int width, int height, int alone);

// The style of charts, from chart.css.
extern const char chart_style[];

#endif
