// SPDX-License-Identifier: BSD-3-Clause
// Writes the page of made-up measurements, for page.py to look at in a browser: every engine, long names, points on top
// of each other, values that are missing. Usage: page_made_up FILE.html [FILE.png], the latter being the chart alone.
#include "peels.h"
#include "metrics.h"
#include "page.h"
#include "tools/common/report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 320, HEIGHT = 200, SETTINGS = 60, SCENES = 3, SAMPLES = 5 };

// Stands in for rendering: a picture that differs from setting to setting.
int trade_run_render(struct trade_run *run, int result, int scene, struct tool_error *error)
{
    (void)error;
    float *p = run->out[scene].image.data[0];
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
        p[i] = (float)((i / 3 + 7 * result) % WIDTH) / WIDTH;
    return 0;
}

static void make_up(struct trade_result *r, struct trade_setting *s, int i)
{
    static char names[SETTINGS][64], options[SETTINGS][128];
    const char *engine = hf_engine_name((enum hf_engine)(i % tool_engines()));
    snprintf(names[i], sizeof names[i], "%s, %s %d", engine, i % 7 ? "knob" : "a knob with a long name <&>", i);
    snprintf(options[i], sizeof options[i], "--engine %s --knob %d --another-knob-of-it=\"%d\"", engine, i, i / 2);
    *s = (struct trade_setting){"knob", names[i], options[i], 1};
    r->setting = s;
    r->engine = (enum hf_engine)(i % tool_engines());
    r->farthest = INFINITY;
    const double ms = 0.8 * pow(1000, (double)(i - i % 3) / SETTINGS);
    for (int c = 0; c < SCENES; c++) {
        struct trade_point *p = &r->at[c];
        const double error = 0.15 * pow(0.15, (double)i / SETTINGS) * (1 + 0.4 * (i % 5 == 1)) * (1 + 0.3 * c);
        for (int g = 0; g < BENCH_REGIONS; g++)
            p->distance[g] = (struct bench_distance){.share = g == BENCH_HIGHLIGHTS && c ? 0 : 0.5,
                                                     .psnr = -20 * log10(error),
                                                     .display_rmse = error * (1 + 0.1 * g),
                                                     .linear_rmse = error,
                                                     .largest = 1,
                                                     .ssim = 1 - error,
                                                     .flip = 2 * error,
                                                     .energy = 1};
        p->flicker = i % 4 ? 1e-4 * error : NAN;
        p->time.n = SAMPLES;
        for (int k = 0; k < SAMPLES; k++) {
            p->time.sample[k] = ms * (1 + 0.05 * (1 + i % 4) * (k - 2));
            for (int q = 0; q < tool_passes(r->engine); q++)
                p->time.pass[k][q] = ms / 12;
        }
    }
    r->both = r->at[0].time;
    r->rounding = i % 3 ? 1e-8 * (i + 1) : NAN;
    r->faithfulness = i % 4 ? NAN : 1e-3 * (i + 1);
}

int main(int argc, char **argv)
{
    static struct trade_result results[SETTINGS];
    static struct trade_setting settings[SETTINGS];
    static struct trade_run run;
    static const struct bench_args args = {.quick = 1};
    static const struct bench_peels peels = {
        .count = 1,
        .scenes = {
            {"fence",
             3,
             {{33.75, 0.02, 52.2, 90.3, 0}, {44.65, 0.006, 80.8, 150.3, 65.2}, {45.22, 0.005, 104.7, 167.2, 49.3}}}}};
    struct tool_error error = {""};
    struct trade t = {.args = &args,
                      .threads = 2,
                      .isa = HF_ISA_SCALAR,
                      .scenes = SCENES,
                      .results = SETTINGS,
                      .scene = {{"lights"}, {"fence"}, {"foliage"}},
                      .result = results,
                      .cpu = "A CPU & its <name>",
                      .date = "2000-01-01",
                      .commit = "none",
                      .peels = {&peels, &peels}};
    if (argc < 2)
        return 1;
    run.t = &t;
    for (int c = 0; c < SCENES; c++) {
        t.width[c] = run.scene[c].picture.width = WIDTH;
        t.height[c] = run.scene[c].picture.height = HEIGHT;
        run.scene[c].truth.rgb = calloc(3 * WIDTH * HEIGHT, sizeof(float));
        run.out[c].image.data[0] = calloc(3 * WIDTH * HEIGHT, sizeof(float));
        if (!run.scene[c].truth.rgb || !run.out[c].image.data[0])
            return 1;
    }
    for (int i = 0; i < SETTINGS; i++)
        make_up(&results[i], &settings[i], i);
    trade_rank(&t);
    trade_ladder(&t);
    int err = bench_page_write(&run, argv[1], &error);
    if (!err && argc > 2)
        err = bench_page_png(&t, argv[2], &error);
    if (err)
        fprintf(stderr, "%s\n", error.text);
    for (int c = 0; c < SCENES; c++) {
        free(run.scene[c].truth.rgb);
        free(run.out[c].image.data[0]);
    }
    return err ? 1 : 0;
}
