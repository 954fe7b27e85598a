// SPDX-License-Identifier: BSD-3-Clause
// The words for the values of public enums.
#include <string.h>

#include "base/cpu.h"
#include "pass/engine.h"

static const char *const log_levels[] = {"error", "warning", "info", NULL};
static const char *const formats[] = {"rgba32f", "rgb32f", "rgba16f", "r11g11b10f", "planar32f", "rgba8",
                                      "bgra8",   "rgbx8",  "bgrx8",   "rgb10a2",    "rgba16",    NULL};
static const char *const transfers[] = {"linear", "srgb", NULL};
static const char *const depth_formats[] = {"float32", "float16", "unorm16", "unorm32", "d24s8", "x8d24", NULL};
static const char *const depth_types[] = {"view", "ray", "ndc-d3d", "ndc-gl", "ndc-reversed", "inverse", "coc", NULL};
static const char *const resolutions[] = {"full", "half", "quarter", NULL};
static const char *const models[] = {"range", "lens", NULL};
static const char *const storages[] = {"float", "half", "packed", NULL};
static const char *const fills[] = {"max", "mean", "none", "open", NULL};
static const char *const blends[] = {"linear", "smoothstep", NULL};
static const char *const qualities[] = {"draft", "standard", "high", "best", NULL};
static const char *const downsamples[] = {"bilateral", "linear", "point", NULL};
static const char *const divisions[] = {"exact", "estimate", "newton", "newton2", NULL};
static const char *const layers[] = {"standard", "draft", "high", "best", NULL};
static const char *const limits[] = {"none", "given", "model", "engine", "picture", NULL};

// Names of instruction sets and engines are defined with them.
static const char *const *const lists[] = {
    [HF_NAMES_LOG_LEVEL] = log_levels,
    [HF_NAMES_FORMAT] = formats,
    [HF_NAMES_TRANSFER] = transfers,
    [HF_NAMES_DEPTH_FORMAT] = depth_formats,
    [HF_NAMES_DEPTH_TYPE] = depth_types,
    [HF_NAMES_RESOLUTION] = resolutions,
    [HF_NAMES_MODEL] = models,
    [HF_NAMES_STORAGE] = storages,
    [HF_NAMES_FILL] = fills,
    [HF_NAMES_BLEND] = blends,
    [HF_NAMES_LIMIT] = limits,
    [HF_NAMES_QUALITY] = qualities,
    [HF_NAMES_DOWNSAMPLE] = downsamples,
    [HF_NAMES_DIVISION] = divisions,
    [HF_NAMES_LAYERS] = layers,
};

const char *hf_name(enum hf_names of, int value)
{
    if (value < 0 || (unsigned)of >= sizeof lists / sizeof *lists)
        return NULL;
    if (of == HF_NAMES_ISA)
        return hf_cpu_name((enum hf_isa)value);
    if (of == HF_NAMES_ENGINE)
        return hf_engine_name((enum hf_engine)value);
    for (int i = 0; lists[of][i]; i++)
        if (i == value)
            return lists[of][i];
    return NULL;
}

int hf_value(enum hf_names of, const char *name, int *value)
{
    if (!name || !value)
        return HF_ERR_ARG;
    if (of == HF_NAMES_STORAGE && !strcmp(name, "chapter"))
        name = "packed";
    for (int i = 0; hf_name(of, i); i++)
        if (!strcmp(hf_name(of, i), name)) {
            *value = i;
            return HF_OK;
        }
    return HF_ERR_ARG;
}

const char *hf_engine_name(enum hf_engine engine)
{
    const struct hf_engine_def *e = hf_engine_def(engine);
    return e ? e->name : NULL;
}

const char *hf_inspect_pass_name(enum hf_engine engine, int pass)
{
    const struct hf_engine_def *e = hf_engine_def(engine);
    return e && pass >= 0 && pass < e->pass_count ? e->passes[pass].name : NULL;
}
