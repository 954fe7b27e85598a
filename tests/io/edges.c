// SPDX-License-Identifier: BSD-3-Clause
// What happens to a depth map's outlines and slopes.
#include "tools/io/depth_edges.h"
#include "tools/io/depth_steps.h"

#include <math.h>
#include <string.h>

#include "io/tests.h"
#include "support/check.h"

enum { W = 48, H = 40 };

static long long sharpen(float *depth)
{
    long long changed = -1;
    CHECK(!hf_io_sharpen_depth(depth, W, H, NULL, &changed));
    return changed;
}

// A disc at one distance before another, each pixel the mean of 8 x 8 samples: mixed values go to the side that has
// most of their samples, and nothing else changes.
static void disc(float near_by, float far_away)
{
    float depth[W * H], should[W * H];
    int mixed = 0, wrong = 0;
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            int inside = 0;
            for (int s = 0; s < 64; s++) {
                const float dx = (float)x + ((float)(s % 8) + 0.5f) / 8 - 23.3f;
                const float dy = (float)y + ((float)(s / 8) + 0.5f) / 8 - 19.6f;
                inside += dx * dx + dy * dy < 14.5f * 14.5f;
            }
            // A value in the middle belongs to neither side; one within a twentieth of the step from a side is left
            // alone.
            const float cover = inside == 32 ? 31 / 64.0f : (float)inside / 64;
            depth[y * W + x] = far_away + (near_by - far_away) * cover;
            const int kept = cover < 0.05f || cover > 0.95f;
            should[y * W + x] = kept ? depth[y * W + x] : cover > 0.5f ? near_by : far_away;
            mixed += !kept;
        }
    const long long changed = sharpen(depth);
    // The nearest samples of a plateau may be ones that were left alone.
    for (int i = 0; i < W * H; i++)
        wrong += !(fabsf(depth[i] - should[i]) <= 0.051f * fabsf(near_by - far_away));
    CHECK_MSG(changed == mixed && mixed > 60, "%lld changed of %d", changed, mixed);
    CHECK_MSG(wrong == 0, "%d are on the wrong side", wrong);
}

// An upright outline that is blurred over three pixels returns to its place.
static void soft(void)
{
    static const float ramp[] = {0.75f, 0.5001f, 0.25f};
    float depth[W * H];
    for (int i = 0; i < W * H; i++) {
        const int x = i % W;
        depth[i] = x < 20 ? 1 : x < 23 ? ramp[x - 20] : 0;
    }
    CHECK(sharpen(depth) == 3 * H);
    for (int i = 0; i < W * H; i++)
        CHECK_MSG(depth[i] == (i % W < 22 ? 1 : 0), "%d: %g", i % W, (double)depth[i]);
}

static void unchanged(const char *what, const float *depth)
{
    float copy[W * H];
    memcpy(copy, depth, sizeof(copy));
    CHECK_MSG(sharpen(copy) == 0 && !memcmp(copy, depth, sizeof(copy)), "%s", what);
}

// On a gentle slope in codes only rounding is removed; a step of more than two codes stays, bit for bit.
static void steps(void)
{
    enum { STEP = 30 };
    const float unit = 1 / 255.0f;
    float depth[W * H], slope[W * H];
    long long changed = 0, wrong = 0;
    for (int i = 0; i < W * H; i++) {
        slope[i] = (0.07f * (float)(i % W) + 0.04f * (float)(i / W)) * unit + (i % W < STEP ? 0 : 40 * unit);
        depth[i] = roundf(slope[i] * 255) * unit;
    }
    float copy[W * H], off[2] = {0, 0};
    memcpy(copy, depth, sizeof(copy));
    CHECK(!hf_io_smooth_steps(copy, W, H, unit, NULL, &changed));
    CHECK_MSG(changed > W * H / 3, "%lld", changed);
    for (int i = 0; i < W * H; i++) {
        const int x = i % W, y = i / W;
        const int beside = x >= STEP - 6 && x < STEP + 6;
        wrong += beside && copy[i] != depth[i];
        // A mean equals the slope's own value where 13 x 13 pixels lie inside the map.
        if (beside || x < 6 || y < 6 || x >= W - 6 || y >= H - 6)
            continue;
        off[0] += (depth[i] - slope[i]) * (depth[i] - slope[i]);
        off[1] += (copy[i] - slope[i]) * (copy[i] - slope[i]);
    }
    CHECK_MSG(wrong == 0, "%lld samples beside the step changed", wrong);
    // Along a row the rounding error has a period of 1 / 0.07 = 14.3 pixels; a mean of 13 leaves a tenth of it. Its
    // square is a hundredth, and with what the rows add far less than a quarter.
    CHECK_MSG(off[1] < off[0] / 4, "squares of %g, before %g", (double)off[1], (double)off[0]);
    for (int i = 0; i < W * H; i++)
        depth[i] = i % W < STEP ? 0.2f : 0.2f + 3 * unit;
    memcpy(copy, depth, sizeof(copy));
    CHECK(!hf_io_smooth_steps(copy, W, H, unit, NULL, &changed) && changed == 0);
    CHECK(!memcmp(copy, depth, sizeof(copy)));
}

void test_depth_edges(void)
{
    steps();
    float depth[W * H];
    disc(0.8f, 0.2f);
    disc(3, 40);
    soft();
    for (int k = 0; k < 4; k++) {
        // Slopes in all directions, as steep as the depth allows.
        for (int i = 0; i < W * H; i++)
            depth[i] = (float)(k == 0   ? i % W
                               : k == 1 ? i / W
                               : k == 2 ? i % W + i / W
                                        : 2 * (i % W) + H - i / W) /
                       255;
        unchanged("a slope", depth);
    }
    for (int k = 1; k <= 8; k++) {
        for (int i = 0; i < W * H; i++)
            depth[i] = 0.3f + 0.02f * (float)k * (float)(i % W > 20 ? i % W - 20 : 0);
        unchanged("where a slope begins", depth);
    }
    for (int i = 0; i < W * H; i++)
        depth[i] = (float)(100 + i * 7919 % 3) / 255;
    unchanged("noise of a code", depth);
    for (int i = 0; i < W * H; i++)
        depth[i] = i % W < 20 ? 1.0f : i % W > 20 ? INFINITY : 30.0f;
    unchanged("a step to infinity", depth);
    for (int i = 0; i < W * H; i++)
        depth[i] = i % W < 20 ? 1.0f : i % W > 20 ? 8.0f : NAN;
    unchanged("no number between", depth);
    float one = 0.5f;
    long long changed;
    CHECK(!hf_io_sharpen_depth(&one, 1, 1, NULL, &changed) && changed == 0 && one == 0.5f);
}
