// SPDX-License-Identifier: BSD-3-Clause
#include "frame/engine.h"

#include "gather/gather.h"
#include "gaussian/kernels.h"
#include "hexagon/kernels.h"
#include "scatter/kernels.h"

const struct hf_engine_def *hf_engine_def(enum hf_engine engine)
{
    static const struct hf_engine_def *const engines[HF_ENGINE_COUNT] = {
        [HF_ENGINE_GATHER] = &hf_gather_engine,
        [HF_ENGINE_HEXAGON] = &hf_hexagon_engine,
        [HF_ENGINE_GAUSSIAN] = &hf_gaussian_engine,
        [HF_ENGINE_SCATTER] = &hf_scatter_engine,
    };
    return (unsigned)engine < HF_ENGINE_COUNT ? engines[engine] : NULL;
}

const char *hf_engine_name(enum hf_engine engine)
{
    const struct hf_engine_def *e = hf_engine_def(engine);
    return e ? e->name : NULL;
}

int hf_pass_count(enum hf_engine engine)
{
    const struct hf_engine_def *e = hf_engine_def(engine);
    return e ? e->pass_count : 0;
}

const char *hf_pass_name(enum hf_engine engine, int pass)
{
    return pass >= 0 && pass < hf_pass_count(engine) ? hf_engine_def(engine)->passes[pass].name : NULL;
}
