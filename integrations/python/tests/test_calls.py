# SPDX-License-Identifier: BSD-3-Clause
"""Arguments, errors, warnings, threads and memory."""
import gc
import os
import re
import subprocess
import sys
import threading
import time
import warnings

import numpy as np
import pytest

import fields
import hyperfocal
import random_calls


def test_every_field_of_the_header_is_an_argument():
    include = os.environ["HF_INCLUDE"]
    rows, missing, _ = fields.read(include)
    assert not missing, "fields.py knows no type for these"
    assert [row[0] for row in rows] == list(hyperfocal.parameters)
    # Found another way: the groups' names and the names before a semicolon or a comma.
    text = re.sub("//.*", "", open(f"{include}/hyperfocal/params.h", encoding="utf-8").read())
    names = []
    for body in re.findall(r"struct hf_\w*params \{(.*?)\};", text, re.S):
        for line in body.split(";"):
            words = line.strip().split(" ", 1 if not line.strip().startswith(("enum", "struct", "const")) else 2)
            if len(words) > 1 and not line.strip().startswith("struct"):
                names += [w.strip(" *") for w in words[-1].split(",")]
    names = [n.split()[-1].strip("*") for n in names if not re.match("size|reserved", n)]
    offered = sorted(row[1].split(".")[-1] for row in rows if row[5] not in ("depth", "other"))
    assert sorted(names) == offered and len(names) > 50
    assert all(hyperfocal.parameters.values())


def test_each_argument_is_taken(scene):
    color, depth = scene
    for name, _, kind, *_ in fields.read(os.environ["HF_INCLUDE"])[0]:
        with pytest.raises(TypeError, match=name):
            hyperfocal.defocus(color, depth, **{name: object()})
        hyperfocal.defocus(color, depth, **{name: None})
        if kind == "NAME":
            with pytest.raises(ValueError, match=f"{name} is 'none such'; it must be one of "):
                hyperfocal.defocus(color, depth, **{name: "none such"})


@pytest.mark.parametrize("wrong, sentence", [
    ({"focus": -3}, "focus is -3; it must be "),
    ({"f_number": 0, "focal_length": 50}, "f_number is 0; "),
    ({"focus": float("nan")}, "focus is nan; "),
    ({"strength": 2}, "strength is 2; "),
    ({"max_radius": 1e9}, "max_radius is 1e+09; "),
    ({"engine": "gaussian", "gaussian_iterations": 10**30}, "gaussian_iterations is out of range"),
    ({"quality": "best", "engine": "layers"}, "engine and quality cannot be given together"),
    ({"quality": "best", "max_error": 0.1}, "quality and max_error cannot be given together"),
    ({"depth_type": "ray"}, "focal_px is 0"),
    ({"depth_format": "d24s8"}, "depth must have uint32 for this depth_format"),
])
def test_wrong_values(scene, wrong, sentence):
    color, depth = scene
    with pytest.raises(ValueError, match=re.escape(sentence)):
        hyperfocal.defocus(color, depth, **wrong)
    hyperfocal.defocus(color, depth)


@pytest.mark.parametrize("change, error, sentence", [
    (lambda c, z: (c.astype("float64"), z), ValueError, "color has samples of type 'd'; it must have float32"),
    (lambda c, z: (c, z.astype("float64")), ValueError, "depth has samples of type 'd'"),
    (lambda c, z: (c.astype(bool), z), ValueError, "color has samples of type '?'"),
    (lambda c, z: (c[..., :2], z), ValueError, "color must have the shape (height, width, 3) or (height, width, 4)"),
    (lambda c, z: (c[..., 0], z), ValueError, "color must have the shape"),
    (lambda c, z: (c, z[:-1]), ValueError, "depth has 64 x 47 pixels and color has 64 x 48"),
    (lambda c, z: (c[:0], z[:0]), ValueError, "color has no pixels"),
    (lambda c, z: (c, z.astype("uint8")), ValueError, "depth has samples of 8 bits"),
    (lambda c, z: ("colour", z), TypeError, "color must be an array"),
    (lambda c, z: (c, None), TypeError, "depth must be an array"),
    (lambda c, z: ((c[..., 0],) * 2, z), ValueError, "color is a tuple of other than 3 or 4 planes"),
    (lambda c, z: ((c[..., 0], c[..., 1], c[1:, :, 1]), z), ValueError, "color has planes of different shape"),
])
def test_wrong_arrays(scene, change, error, sentence):
    with pytest.raises(error, match=re.escape(sentence)):
        hyperfocal.defocus(*change(*scene))


def test_wrong_calls(scene):
    color, depth = scene
    for call in (lambda: hyperfocal.defocus(color), lambda: hyperfocal.defocus(color, depth, 3),
                 lambda: hyperfocal.defocus(color, depth, fokus=3), lambda: hyperfocal.Context(2).defocus(color, color=color),
                 lambda: hyperfocal.choose_quality(1080)):
        with pytest.raises(TypeError):
            call()
    with pytest.raises(ValueError, match="out has samples that share memory"):
        hyperfocal.defocus(color, depth, out=np.lib.stride_tricks.as_strided(color, color.shape, (16, 16, 4)))
    with pytest.raises(ValueError, match="threads is 1000"):
        hyperfocal.Context(1000)
    with pytest.raises(ValueError, match="isa is 'mmx'"):
        hyperfocal.Context(isa="mmx")


def test_depth_at(scene):
    _, depth = scene
    assert hyperfocal.depth_at(depth, 20, 10) == 3
    assert hyperfocal.depth_at((1 / depth).astype("float16"), 0, 47, depth_type="inverse") == pytest.approx(10, rel=2.0**-10)
    depth[0, 0] = np.inf
    with pytest.raises(ValueError):
        hyperfocal.depth_at(depth, 0, 0)
    with pytest.raises(ValueError):
        hyperfocal.depth_at(depth, 64, 0)
    with pytest.raises(TypeError):
        hyperfocal.depth_at(depth, 1, 1, focus=3)


def test_warnings(scene):
    color, depth = scene
    whole = np.full(depth.shape, 30000, "uint16")
    with hyperfocal.Context() as context, pytest.warns(RuntimeWarning, match="depth_type is view and the format unorm16"):
        context.defocus(color, whole, focus=3)
    with hyperfocal.Context() as context, warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(RuntimeWarning):
            context.defocus(color, whole, focus=3)


def test_report(scene):
    color, depth = scene
    with hyperfocal.Context(threads=2) as context:
        assert context.threads == 2 and context.isa in ("scalar", "sse4.1", "avx2", "avx512", "neon")
        assert context.report["total_ms"] == 0
        color[0, 0, 0] = np.nan
        context.defocus(color, depth, focus=10, distance=3)
        report = context.report
        assert report["near_pixels"] + report["sharp_pixels"] + report["far_pixels"] == 48 * 64
        assert report["colour_repaired"] >= 1 and report["total_ms"] > 0
    for use in (lambda: context.defocus(color, depth), lambda: context.report, lambda: context.threads, context.__enter__):
        with pytest.raises(ValueError, match="the context is closed"):
            use()
    context.close()
    context.cancel()


def test_two_contexts_run_at_once():
    """While one frame runs, other Python code does: the lock of the interpreter is not held."""
    color, depth = np.random.default_rng(2).random((540, 960, 4), np.float32), np.full((540, 960), 30, np.float32)
    running, counted = threading.Event(), [0]

    def count():
        while running.is_set():
            counted[0] += 1

    running.set()
    threads = [threading.Thread(target=hyperfocal.Context(1).defocus, args=(color, depth), kwargs={"focus": 3}) for _ in "ab"]
    counter = threading.Thread(target=count)
    counter.start()
    before = counted[0]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    during = counted[0] - before
    running.clear()
    counter.join()
    assert during > 0


def test_one_context_for_many_threads(scene):
    color, depth = scene
    results = []
    with hyperfocal.Context() as context:
        threads = [threading.Thread(target=lambda: results.append(context.defocus(color, depth, focus=3))) for _ in range(8)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
    assert len(results) == 8 and all(np.array_equal(r, results[0]) for r in results)


def test_cancel():
    color, depth = np.ones((2000, 3000, 4), np.float32), np.linspace(1, 100, 6000000, dtype=np.float32).reshape(2000, 3000)
    with hyperfocal.Context(1) as context:
        stop = threading.Event()

        def cancel():
            while not stop.is_set():
                context.cancel()
                time.sleep(0.001)

        thread = threading.Thread(target=cancel)
        thread.start()
        with pytest.raises(RuntimeError):
            context.defocus(color, depth, focus=5, f_number=0.5, focal_length=100)
        stop.set()
        thread.join()


def test_interrupt():
    """Ctrl-C ends a frame."""
    code = ("import hyperfocal, numpy as np, signal\n"
            "signal.signal(signal.SIGALRM, signal.default_int_handler); signal.setitimer(signal.ITIMER_REAL, 0.3)\n"
            "c = np.ones((4000, 4000, 3), np.float32)\n"
            "z = np.linspace(1, 100, 16000000, dtype=np.float32).reshape(4000, 4000)\n"
            "while True: hyperfocal.defocus(c, z, out=c, focus=5, f_number=0.5, focal_length=100, engine='scatter')")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert done.returncode != 0 and done.stderr.strip().endswith("KeyboardInterrupt")


def test_after_fork(scene):
    color, depth = scene
    want = hyperfocal.defocus(color, depth, focus=3)
    child = os.fork()
    if not child:
        os._exit(0 if np.array_equal(want, hyperfocal.defocus(color, depth, focus=3)) else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_references(scene):
    """Calls, right and wrong, leave the counts of all that they were given, and no block of memory."""
    color, depth = scene
    planes = tuple(np.ascontiguousarray(color[..., c]) for c in range(3))
    foreign = color.astype(">f4")
    out = np.empty_like(color)
    context = hyperfocal.Context(1)
    objects = (color, depth, planes, *planes, foreign, out, context)

    def use():
        context.defocus(color, depth, out=out, focus=3)
        context.defocus(planes, depth, focus=3)
        context.defocus(foreign, depth, focus=3, aperture=foreign)
        hyperfocal.coc(depth, focus=3)
        hyperfocal.depth_at(depth, 1, 1)
        hyperfocal.choose_quality(480, quality="best")
        dict(context.report)
        for wrong in ({"focus": -2}, {"engine": "no"}, {"out": depth}, {"aperture": depth}, {"zzz": 1}):
            with pytest.raises((ValueError, TypeError)):
                context.defocus(color, depth, **wrong)

    def allocated():
        # The interpreter's cache of attributes keeps the names that calls from C look up: up to 130 blocks.
        sys._clear_type_cache()
        gc.collect()
        return sys.getallocatedblocks()

    for _ in range(20):
        use()
    counts, blocks = [sys.getrefcount(o) for o in objects], allocated()
    for _ in range(200):
        use()
    assert [sys.getrefcount(o) for o in objects] == counts
    # One block a call would be 200; one is taken whatever the number of calls.
    assert allocated() - blocks < 20


def test_docs():
    for name in hyperfocal.parameters:
        assert f"{name}: " in hyperfocal.defocus.__doc__
    assert hyperfocal.__version__.count(".") == 2


def test_random_calls():
    good, bad = random_calls.run(400, 7)
    assert good > 40 and bad > 40
