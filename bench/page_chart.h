// SPDX-License-Identifier: BSD-3-Clause
// Charts of time against error, as SVG: the only writer of charts, for the page and for the picture in the README.
#ifndef HF_BENCH_PAGE_CHART_H
#define HF_BENCH_PAGE_CHART_H

#include "tradeoff.h"

struct chart {
    const char *id;
    const char *name;   // short, for a switch
    const char *title;  // what the error is
    int both;           // time of 1080p `both` instead of the scenes' mean
    // What is drawn upwards, of a region where it is a distance; NAN: has none.
    double (*error)(const struct trade *t, const struct trade_result *r, enum bench_region region);
    enum bench_region region;
    int decibel;  // a second scale
};

extern const struct chart trade_charts[];
extern const int trade_chart_count;

// Settings that can be drawn. A chart of none is not written.
int chart_points(const struct trade *t, const struct chart *c);
// alone: a file of its own, with style; else a part of the page.
void chart_write(FILE *out, const struct trade *t, const struct chart *c, int width, int height, int alone);

// The style of charts, from chart.css.
extern const char chart_style[];

#endif
