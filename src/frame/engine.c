// SPDX-License-Identifier: BSD-3-Clause
#include "pass/engine.h"
#include "engine/list.h"

#define DECLARE(number, name) extern const struct hf_engine_def hf_##name##_engine;
#define ENTER(number, name) [HF_ENGINE_##number] = &hf_##name##_engine,

HF_ENGINES(DECLARE)

const struct hf_engine_def *hf_engine_def(enum hf_engine engine)
{
    static const struct hf_engine_def *const engines[HF_ENGINE_COUNT] = {HF_ENGINES(ENTER)};
    return (unsigned)engine < HF_ENGINE_COUNT ? engines[engine] : NULL;
}
