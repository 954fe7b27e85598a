#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a call from Python costs beside the library's own time: 1920 x 1080, float32, in turn.

    PYTHONPATH=build/integrations/python integrations/python/examples/measure.py [FRAMES]

report["total_ms"] is the time of hf_render inside the same call; the rest is Python's. On an idle machine.
"""
import statistics
import sys
import time

import numpy as np

import hyperfocal


def measure(frames, channels, opaque, engine):
    random = np.random.default_rng(1)
    color = random.random((1080, 1920, channels), np.float32)
    if opaque and channels == 4:
        color[..., 3] = 1
    depth = np.full((1080, 1920), 20, np.float32)
    depth[300:800, 500:1200] = 4
    out = np.empty_like(color)
    whole, inside = [], []
    with hyperfocal.Context() as context:
        for _ in range(frames + 3):
            start = time.perf_counter()
            context.defocus(color, depth, out=out, focus=10, f_number=1.4, focal_length=50, engine=engine)
            whole.append(1000 * (time.perf_counter() - start))
            inside.append(context.report["total_ms"])
    call, render = statistics.median(whole[3:]), statistics.median(inside[3:])
    words = f"{channels} channels{', alpha 1' if opaque and channels == 4 else ''}"
    print(f"{engine:8} {words:20} {call:9.2f} ms, hf_render {render:9.2f} ms: {100 * (call / render - 1):+.2f} %")


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 21
    for name in ("layers", "gather"):
        measure(count, 3, False, name)
        measure(count, 4, False, name)
        measure(count, 4, True, name)
