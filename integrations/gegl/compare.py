#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""hyperfocal:defocus beside gegl:lens-blur on the scenes with a ray-traced truth: median processor time of the command gegl,
less that of adding the map to the picture, and display-encoded PSNR.

    compare.py COMMAND IMAGES [SCENE ...]      in a build: GEGL_PATH=...:build/integrations/gegl

gegl:lens-blur takes one largest radius and a map from 0 (sharp) to 1 (full); it is given the radii of hyperfocal's own lens.
"""
import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import numpy as np
except ImportError:
    sys.exit(f"{sys.argv[0]}: {sys.executable} has no numpy (Debian: python3-numpy, for /usr/bin/python3)")

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "blender/hyperfocal_dof"))
import exr  # noqa: E402
import hyperfocal  # noqa: E402

REPEATS = 7
command, images = (Path(p).resolve() for p in sys.argv[1:3])


def lens(path):
    """Focus, f-number, focal length and sensor width in the header, as the command reads them."""
    said = subprocess.run([command, path, "-o", "none.exr", "--dry-run", "--json"], check=True, capture_output=True, text=True).stdout
    view = json.loads(said)["views"][0]
    return {"focus": view["focus"], "f_number": view["fstop"], "focal_length": view["focal_length"],
            "sensor_width": view["sensor_width"]}


def color_of(planes):
    return np.dstack([planes[c].astype(np.float32) for c in "RGB"])


def decibels(a, b):
    def display(c):
        c = np.clip(c, 0, 1)
        return np.where(c <= 0.0031308, 12.92 * c, 1.055 * np.maximum(c, 1e-9) ** (1 / 2.4) - 0.055)
    return -10 * math.log10(np.mean((display(a) - display(b)) ** 2))


def with_map(path):
    return ["aux=[", "load", f"path={path}", "]"]


def gegl(*words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(["gegl", "color.exr", "-o", "out.exr", "--", *words], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, color_of(exr.read("out.exr"))


def main(scenes):
    print("| scene | hyperfocal:defocus | gegl:lens-blur |\n|---|---|---|")
    for name in scenes:
        path = images / f"{name}.exr"
        camera, planes, truth = lens(path), exr.read(path), color_of(exr.read(images / f"{name}.truth.exr"))
        z = planes["Z"].astype(np.float32)
        radii = np.abs(hyperfocal.coc(z, **camera))
        exr.write("color.exr", {c: planes[c].astype(np.float32) for c in "RGB"})
        exr.write("z.exr", {"Y": z})
        exr.write("radii.exr", {"Y": radii / radii.max()})
        words = [f"{k.replace('_', '-')}={v}" for k, v in camera.items()]
        ways = {"sum": ["gegl:add", *with_map("z.exr")], "ours": ["hyperfocal:defocus", *words, *with_map("z.exr")],
                "theirs": ["gegl:lens-blur", f"radius={radii.max()}", "linear-mask=true", *with_map("radii.exr")]}
        done = {way: [] for way in ways}
        for _ in range(REPEATS):  # in turn, as machines are not always equally fast
            for way, some in ways.items():
                done[way].append(gegl(*some))
        took = {way: statistics.median(seconds for seconds, _ in some) for way, some in done.items()}
        row = [f"{took[way] - took['sum']:.2f} s, {decibels(done[way][0][1], truth):.1f} dB" for way in ("ours", "theirs")]
        print(f"| {name} | {row[0]} | {row[1]} |", flush=True)


with tempfile.TemporaryDirectory() as work:
    os.chdir(work)
    main(sys.argv[3:] or ["fence", "foliage", "lights"])
