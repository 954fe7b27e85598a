// SPDX-License-Identifier: BSD-3-Clause
// `hyperfocal-bench truth --image A --truth B`: the distances of any picture from any other.
#include "commands.h"
#include "metrics.h"
#include "scene.h"
#include "write.h"

#include <stdlib.h>
#include <string.h>

struct score {
    const struct bench_args *args;
    int width, height;
    struct bench_distance distance;
};

static void table(FILE *out, const void *what)
{
    const struct score *s = what;
    const struct bench_distance *d = &s->distance;
    fprintf(out, "%s, %d x %d, beside %s\n", s->args->image, s->width, s->height, s->args->truth);
    fprintf(out, "%9s %9s %9s %9s %9s %9s\n", "dB", "RMSE", "largest", "SSIM", "FLIP", "energy");
    fprintf(out, "%9.2f %9.5f %9.4g %9.4f %9.4f %9.4f\n", d->psnr, d->linear_rmse, d->largest, d->ssim, d->flip,
            d->energy);
    fputs("PSNR of the display-encoded pictures (clamped to 0..1, sRGB); the rest as in tradeoff\n", out);
}

static void json(FILE *out, const void *what)
{
    const struct score *s = what;
    const struct bench_distance *d = &s->distance;
    struct tool_json j;
    bench_json_begin(&j, out, "truth", s->args);
    tool_json_text(&j, "image", s->args->image);
    tool_json_text(&j, "truth", s->args->truth);
    tool_json_count(&j, "width", s->width);
    tool_json_count(&j, "height", s->height);
    tool_json_number(&j, "psnr_db", d->psnr);
    tool_json_number(&j, "linear_rmse", d->linear_rmse);
    tool_json_number(&j, "largest", d->largest);
    tool_json_number(&j, "ssim", d->ssim);
    tool_json_number(&j, "flip", d->flip);
    tool_json_number(&j, "energy", d->energy);
    tool_json_end(&j);
}

static int compare(struct score *s, const struct bench_scene *image, const struct bench_scene *truth,
                   struct tool_error *error)
{
    struct bench_distance distances[BENCH_REGIONS];
    if (image->width != truth->width || image->height != truth->height)
        return tool_fail(error, -1, "%s is %d x %d, but %s is %d x %d", s->args->image, image->width, image->height,
                         s->args->truth, truth->width, truth->height);
    s->width = image->width;
    s->height = image->height;
    uint8_t *regions = malloc((size_t)s->width * (size_t)s->height);
    if (regions)
        memset(regions, 1 << BENCH_WHOLE, (size_t)s->width * (size_t)s->height);
    struct bench_metrics *m = regions ? bench_metrics_open(truth->rgb, regions, s->width, s->height) : NULL;
    if (m)
        bench_metrics_compare(m, image->rgb, distances);
    s->distance = m ? distances[BENCH_WHOLE] : (struct bench_distance){0};
    bench_metrics_close(m);
    free(regions);
    return m ? 0 : tool_fail(error, -1, "there is not enough memory for pictures of %d x %d", s->width, s->height);
}

int bench_score(struct bench_args *args, struct tool_error *error)
{
    struct score s = {.args = args};
    struct bench_scene image = {0}, truth = {0};
    if (!args->image || !args->truth)
        return tool_fail(error, -1, "--%s needs --%s: one is compared with the other", args->image ? "image" : "truth",
                         args->image ? "truth" : "image");
    int err = bench_scene_read(&image, args->image, 0, NULL, error);
    if (!err)
        err = bench_scene_read(&truth, args->truth, 0, NULL, error);
    if (!err)
        err = compare(&s, &image, &truth, error);
    if (!err)
        err = bench_write_report(args, table, json, &s, error);
    bench_scene_free(&image);
    bench_scene_free(&truth);
    return err;
}
