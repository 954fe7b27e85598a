// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/choose.h"

#include <math.h>

// Options that set what --quality and --max-error would choose; they exclude each other.
static const char *const knobs[] = {"engine",        "resolution",  "iterations",       "sigma",     "rings",
                                    "fill",          "downsample",  "division",         "storage",   "karis",
                                    "faithful",      "bicubic",     "uniform",          "half-from", "quarter-from",
                                    "spacing",       "no-unmix",    "per-pixel-kernel", "no-hidden", "layers-quality",
                                    "no-highlights", "no-patterns", "lens-points"};

static int by_error(const struct cli_args *args)
{
    return !isnan(args->max_error);
}

const char *cli_quality_words(int word)
{
    static const enum hf_quality words[] = {HF_QUALITY_DRAFT, HF_QUALITY_STANDARD, HF_QUALITY_BEST};
    struct hf_params p = hf_default_params();
    struct tool_choice choice;
    return tool_choose(1080, NULL, &p, words[word], 0, &choice) ? "" : choice.inner.options;
}

int cli_choose_check(const struct cli_args *args, const struct tool_parser *p, struct tool_error *error)
{
    const char *option = by_error(args) ? "max-error" : "quality";
    if (!by_error(args) && args->quality < 0)
        return 0;
    if (by_error(args) && args->quality >= 0)
        return tool_fail(error, -1, "--quality and --max-error cannot be given together: each chooses the settings");
    for (size_t i = 0; i < sizeof(knobs) / sizeof(knobs[0]); i++)
        if (tool_given(p, knobs[i]))
            return tool_fail(error, -1,
                             "--%s and --%s cannot be given together: --%s chooses the engine and its settings",
                             knobs[i], option, option);
    return 0;
}

void cli_choose(struct cli_setup *setup, const struct cli_args *args)
{
    static const struct hf_image any = {.size = sizeof(any)};
    struct hf_params *p = &setup->params;
    const struct hf_image *picture = p->aperture.picture;
    // The aperture's picture may not be read yet. The choice only has to know that there will be one, as not every
    // engine can draw it.
    if (args->aperture_file)
        p->aperture.picture = &any;
    if (by_error(args) || args->quality >= 0)
        tool_choose(p->view.display_height, &setup->depth, p, (enum hf_quality)args->quality,
                    by_error(args) ? args->max_error : 0, &setup->choice);
    setup->missed = by_error(args) && setup->choice.all.error > args->max_error;
    p->aperture.picture = picture;
}

struct cli_word cli_choice_option(const struct cli_args *args)
{
    struct cli_word w;
    if (by_error(args))
        snprintf(w.text, sizeof(w.text), "--max-error %g", args->max_error);
    else
        snprintf(w.text, sizeof(w.text), "--quality %s", hf_name(HF_NAMES_QUALITY, args->quality));
    return w;
}

void cli_choose_print(FILE *out, const struct cli_args *args, const struct cli_setup *setup, double megapixels)
{
    const struct hf_choice *c = &setup->choice.all;
    const struct hf_inspect_choice *s = &setup->choice.inner;
    if (!s->options)
        return;
    fprintf(out, "  %s chose %s, step %d of %d\n", cli_choice_option(args).text, s->options, s->step + 1, s->steps);
    if (s->passed)
        fprintf(out, "  %d cheaper step%s passed over, the first because it %s\n", s->passed,
                s->passed == 1 ? " was" : "s were", c->why);
    if (setup->missed)
        fprintf(out, "  no setting errs as little as was asked for\n");
    fprintf(out,
            "  expected: %.1f ms (%.1f a megapixel); error %.4f of the display's range (%.1f dB), %.4f in the worst "
            "scene\n  measured %s\n",
            c->ms * megapixels, c->ms, c->error, -20 * log10(c->error), c->worst, s->measured);
}

void cli_choose_json(struct tool_json *j, const struct cli_setup *setup, double megapixels)
{
    const struct hf_choice *c = &setup->choice.all;
    const struct hf_inspect_choice *s = &setup->choice.inner;
    if (!s->options)
        return;
    tool_json_open(j, "choice", '{');
    tool_json_text(j, "options", s->options);
    tool_json_count(j, "step", s->step + 1);
    tool_json_count(j, "steps", s->steps);
    tool_json_count(j, "passed_over", s->passed);
    tool_json_text(j, "passed_over_because_it", c->why);
    tool_json_ms(j, "expected_ms", c->ms * megapixels);
    tool_json_number(j, "expected_error", c->error);
    tool_json_number(j, "worst_error", c->worst);
    tool_json_text(j, "measured", s->measured);
    tool_json_close(j);
}
