// SPDX-License-Identifier: BSD-3-Clause
// The kernels of layers of an instruction set.
#include "simd/simd.h"

#include "engine/layers/blur_simd.h"
#include "engine/layers/composite_simd.h"
#include "engine/layers/cut_simd.h"
#include "engine/layers/hidden_simd.h"
#include "engine/layers/highlights_simd.h"
#include "engine/layers/patterns_simd.h"
#include "engine/layers/runs_simd.h"
#include "engine/layers/unmix_simd.h"
#include "engine/layers/views_simd.h"

void HF_SIMD_NAME(hf_layers_kernels)(struct hf_layers_kernels *k)
{
    k->unmix = layers_unmix_simd;
    k->roots = layers_roots_simd;
    k->nine = layers_nine_simd;
    k->shares = layers_shares_simd;
    k->lamps = layers_lamps_simd;
    k->quads = layers_quads_simd;
    k->merge = layers_merge_simd;
    k->taps = layers_taps_simd;
    k->between = layers_between_simd;
    k->nearest = layers_nearest_simd;
    k->found = layers_found_simd;
    k->spread = layers_spread_simd;
    k->smooth = layers_smooth_simd;
    k->alike = layers_alike_simd;
    k->extremes = layers_extremes_simd;
    k->inside = layers_inside_simd;
    k->weigh = layers_weigh_simd;
    k->fold = layers_fold_simd;
    k->disc = layers_disc_simd;
    k->pairs = layers_pairs_simd;
    k->runs = layers_runs_simd;
    k->weights = layers_weights_simd;
    k->stamp = layers_stamp_simd;
    k->light = layers_light_simd;
    k->up = layers_up_simd;
    k->blend = layers_blend_simd;
    k->finish = layers_finish_simd;
    k->dim = layers_dim_simd;
    k->passed = layers_passed_simd;
    k->views = layers_views_simd;
}
