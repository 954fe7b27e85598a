#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Call the module with random arguments, right and wrong: a picture, or one sentence.

    random_calls.py [COUNT [SEED]]

Under the address sanitizer (.ci/sanitize) it also looks for leaks at the end, while Python still holds what it needs.
"""
import ctypes
import os
import random
import sys
import warnings

import numpy as np

import hyperfocal

TYPES = ["float32"] * 12 + ["float16", "uint8", "uint16", ">f4", ">f2", ">u2", "float64", "int32", "bool", "uint32", "complex64"]
NUMBERS = [0, 1, -1, 2, 0.5, 3, 7, 20, 64, 1e-30, 1e30, -2, float("nan"), float("inf"), 10**30, "derive", True, "x", None, []]
WORDS = ["layers", "gather", "hexagon", "scatter", "gaussian", "chapter", "lens", "range", "half", "full", "float", "best", "draft",
         "linear", "srgb", "view", "inverse", "coc", "ray", "ndc-gl", "derive", "", "\0", "é"]


def strided(r, array):
    """The same samples in another order in memory, or a part of them."""
    how = r.randrange(10)
    if how == 0:
        return np.asfortranarray(array)
    if how == 1:
        return array[::-1]
    if how == 2:
        return array[:, ::-1]
    if how == 3:
        return array[::2, ::3]
    if how == 4:
        return np.broadcast_to(array[:1], array.shape)
    if how == 5:
        return np.frombuffer(b"x" + array.tobytes(), array.dtype, offset=1).reshape(array.shape)
    if how == 6 and array.ndim == 3:
        return np.moveaxis(np.ascontiguousarray(np.moveaxis(array, 2, 0)), 0, 2)
    if how == 7:
        array.flags.writeable = False
    return array


def picture(r, shape):
    channels = r.choice([3, 4] * 8 + [1, 2, 5])
    samples = np.random.default_rng(r.randrange(1000)).random((*shape, channels)) * r.choice([1, 1, 100, 1e6])
    if r.random() < 0.2:
        samples[r.randrange(shape[0]) if shape[0] else slice(0)] = r.choice([np.nan, np.inf, -1])
    if channels == 4 and r.random() < 0.5:
        samples[..., 3] = 1
    array = samples.astype(r.choice(TYPES))
    if r.random() < 0.1:
        return tuple(strided(r, array[..., c]) for c in range(channels))
    return memoryview(array) if r.random() < 0.05 else strided(r, array)


def plane(r, shape):
    if r.random() < 0.02:
        shape = (shape[0] + 1, shape[1])
    samples = np.random.default_rng(r.randrange(1000)).random(shape) * r.choice([1, 10, 1e5])
    return strided(r, samples.astype(r.choice(TYPES)))


def arguments(r, shape):
    given = {}
    for _ in range(r.choice([0, 1, 2, 2, 3, 6])):
        name = r.choice(list(hyperfocal.parameters))
        given[name] = picture(r, (8, 8)) if name == "aperture" else r.choice(r.choice([NUMBERS[:8], NUMBERS, WORDS]))
    if r.random() < 0.5:
        given["engine"] = r.choice(WORDS[:6])
    if r.random() < 0.3:
        given.update(f_number=r.choice([0.1, 1, 8]), focal_length=50)
    return given


def call(r, contexts):
    shape = (r.choice([0, 1, 2, 2, 7, 7, 16, 16, 33, 33]), r.choice([0, 1, 3, 3, 8, 8, 17, 17, 40, 40]))
    color, depth = picture(r, shape), plane(r, shape)
    given = arguments(r, shape)
    which = r.randrange(12)
    if which == 0:
        return hyperfocal.coc(depth, **given)
    if which == 1:
        return hyperfocal.depth_at(depth, r.randrange(-2, 40), r.randrange(-2, 40), **{k: v for k, v in given.items() if r.random() < .3})
    if which == 2:
        return hyperfocal.choose_quality(r.randrange(-1, 5000), **given)
    if which == 3:
        contexts[r.randrange(2)] = hyperfocal.Context(r.choice([0, 1, 2, 3, -1]), r.choice(["auto", "scalar", "sse4.1", "no"]))
        return None
    if which == 4:
        return contexts[r.randrange(2)].report
    if r.random() < 0.3:
        given["out"] = r.choice([color, depth, picture(r, shape), plane(r, shape)])
    function = contexts[r.randrange(2)].defocus if r.random() < 0.8 else hyperfocal.defocus
    return function(color, depth, **given)


def run(count, seed):
    """Returns how many calls gave a result and how many one sentence."""
    r, contexts, done, refused = random.Random(seed), [hyperfocal.Context(1), hyperfocal.Context(2)], 0, 0
    for i in range(count):
        with warnings.catch_warnings():
            warnings.simplefilter("error" if r.random() < 0.05 else "ignore")
            try:
                call(r, contexts)
                done += 1
            except (ValueError, TypeError, RuntimeWarning) as error:
                refused += 1
                assert str(error) and "\n" not in str(error) and len(str(error)) < 500, (i, str(error))
    return done, refused


if __name__ == "__main__":
    total = int(sys.argv[1]) if len(sys.argv) > 1 else 10000
    good, bad = run(total, int(sys.argv[2]) if len(sys.argv) > 2 else 1)
    print(f"{good} calls gave a result, {bad} one sentence")
    leaks = getattr(ctypes.CDLL(None), "__lsan_do_recoverable_leak_check", None)
    failed = int(bool(leaks and leaks())) + int(good + bad != total or good < total / 10 or bad < total / 10)
    print(f"{2 - failed} passed, {failed} failed", flush=True)
    # What Python frees not at its end is no leak of the module.
    os._exit(failed > 0)
