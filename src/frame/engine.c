// SPDX-License-Identifier: BSD-3-Clause
#include "pass/engine.h"

// Adding an engine adds a line.
#define ENGINES(DO)                                                                                                    \
    DO(GATHER, gather)                                                                                                 \
    DO(HEXAGON, hexagon)                                                                                               \
    DO(GAUSSIAN, gaussian)                                                                                             \
    DO(SCATTER, scatter)                                                                                               \
    DO(LAYERS, layers)

#define DECLARE(number, name) extern const struct hf_engine_def hf_##name##_engine;
#define ENTER(number, name) [HF_ENGINE_##number] = &hf_##name##_engine,

ENGINES(DECLARE)

const struct hf_engine_def *hf_engine_def(enum hf_engine engine)
{
    static const struct hf_engine_def *const engines[HF_ENGINE_COUNT] = {ENGINES(ENTER)};
    return (unsigned)engine < HF_ENGINE_COUNT ? engines[engine] : NULL;
}
