#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The operation gives the library's picture, in the command gegl: test.py GEGL COMMAND MODULE."""
import os
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "blender/hyperfocal_dof"))
import exr  # noqa: E402

gegl, command, module = (Path(p).resolve() for p in sys.argv[1:])
passed = failed = 0


def check(name, ok):
    global passed, failed
    passed, failed = passed + bool(ok), failed + (not ok)
    if not ok:
        print(f"FAILED: {name}")


def run(*words, **more):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=120, **more)


def scene(channels):
    random = np.random.default_rng(1)
    color = random.random((90, 160, channels), np.float32)
    color[20:24, 40:44, :3] = 8
    if channels == 4:
        color[..., 3] = random.random((90, 160), np.float32)
        color[..., :3] *= color[..., 3:]
    depth = np.full((90, 160), 20, np.float32)
    depth[18:60, 36:100] = 3
    depth[70:] = 10
    return color, depth


def write_png(path, color, bits):
    """Whole numbers of 8 or 16 bits, without a filter."""
    height, width, channels = color.shape
    samples = np.round(np.clip(color, 0, 1) * (2**bits - 1)).astype(">u2" if bits == 16 else np.uint8)
    lines = b"".join(b"\0" + row.tobytes() for row in samples)
    head = struct.pack(">2I5B", width, height, bits, 2 if channels == 3 else 6, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for name, data in ((b"IHDR", head), (b"IDAT", zlib.compress(lines)), (b"IEND", b"")):
            file.write(struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)))


def close(a, b):
    """float32 colours that passed babl: equal, or one rounding apart where it goes by way of another format."""
    return np.allclose(a, b, rtol=2.0**-22, atol=2.0**-24)


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    # The operation beside those of the system, and none of the user's settings.
    plugins = run("pkg-config", "--variable=pluginsdir", "gegl-0.4").stdout.strip() or "/usr/lib/x86_64-linux-gnu/gegl-0.4"
    os.environ.update(GEGL_PATH=f"{plugins}:{module.parent}", HOME=folder)
    for channels in (3, 4):
        color, depth = scene(channels)
        names = "RGBA"[:channels]
        exr.write("in.exr", dict(zip(names, np.moveaxis(color, 2, 0)), Z=depth))
        exr.write("rgb.exr", dict(zip(names, np.moveaxis(color, 2, 0))))
        exr.write("z.exr", {"Y": depth})
        for options, properties in (
                ("--focus 10 --fstop 0.5 --focal-length 100", "focus=10 f-number=0.5 focal-length=100"),
                ("--focus 10 --range 5 --aperture ngon:5 --max-radius 6",
                 "focus=10 model=range distance=5 blades=5 max-radius=6")):
            lib = run(command, "in.exr", "-o", "lib.exr", *options.split())
            said = run(gegl, "rgb.exr", "-o", "out.exr", "--", "hyperfocal:defocus", *properties.split(), "aux=[", "load",
                       "path=z.exr", "]")
            words = f"{channels} channels, {properties}"
            check(f"{words}: {lib.stderr} {said.stderr}", not lib.returncode and not said.returncode and Path("out.exr").exists())
            want, got = exr.read("lib.exr"), exr.read("out.exr")
            for n in names:
                check(f"{words}: {n} is off by {abs(want[n] - got[n]).max()}", close(want[n], got[n]))
            check(f"{words}: it blurs", not close(color[..., 0], got["R"]))
            Path("out.exr").unlink()
    # Part of the picture: the same pixels as of the whole.
    whole = run(gegl, "rgb.exr", "-o", "whole.exr", "--", "hyperfocal:defocus", "aux=[", "load", "path=z.exr", "]")
    part = run(gegl, "rgb.exr", "-o", "part.exr", "--", "hyperfocal:defocus", "aux=[", "load", "path=z.exr", "]",
               "crop", "x=30", "y=20", "width=50", "height=40")
    a, b = exr.read("whole.exr"), exr.read("part.exr")
    check("a crop has the whole picture's pixels", all(np.array_equal(a[n][20:60, 30:80], b[n]) for n in b))
    # The picture in four pieces: tiles do not show.
    for x, y in (0, 0), (80, 0), (0, 45), (80, 45):
        run(gegl, "rgb.exr", "-o", "quarter.exr", "--", "hyperfocal:defocus", "aux=[", "load", "path=z.exr", "]",
            "crop", f"x={x}", f"y={y}", "width=80", "height=45")
        b = exr.read("quarter.exr")
        check(f"the quarter at {x}, {y}", all(np.array_equal(a[n][y:y + 45, x:x + 80], b[n]) for n in b))
    # 8 and 16 bits, with and without transparency: the picture of the same samples as floats.
    for bits in 8, 16:
        for names in "RGB", "RGBA":
            words = f"{bits} bits, {names}"
            write_png("in.png", color[..., :len(names)], bits)
            run(gegl, "in.png", "-o", "floats.exr", "--", "gegl:nop")
            exr.write("in.exr", {**{n: v.astype(np.float32) for n, v in exr.read("floats.exr").items()}, "Z": depth})
            run(command, "in.exr", "-o", "lib.exr", "--focus", "10", "--fstop", "0.5", "--focal-length", "100")
            run(gegl, "in.png", "-o", "out.exr", "--", "hyperfocal:defocus", "focus=10", "f-number=0.5", "focal-length=100",
                "aux=[", "load", "path=z.exr", "]")
            want, got = exr.read("lib.exr"), exr.read("out.exr")
            # babl takes a conversion that errs by up to 1e-6 of full scale, several one after the other.
            for n in names:
                check(f"{words}: {n} is off by {abs(want[n] - got[n]).max()}", np.allclose(want[n], got[n], atol=4e-6, rtol=0))
            # And out again as whole numbers: half a step of 255 where sRGB is steepest, 2.28 times, is 0.0045 in light.
            run(gegl, "in.png", "-o", "out.png", "--", "hyperfocal:defocus", "focus=10", "f-number=0.5", "focal-length=100",
                "aux=[", "load", "path=z.exr", "]")
            check(f"{words}: a file", Path("out.png").exists())
            if names == "RGB":
                run(gegl, "out.png", "-o", "again.exr", "--", "gegl:nop")
                check(f"{words}: as a PNG", np.allclose(exr.read("again.exr")["G"], want["G"], atol=0.0046, rtol=0))
            Path("out.png").unlink()
    # Without a map the picture stays, and a wrong value is one sentence.
    run(gegl, "rgb.exr", "-o", "same.exr", "--", "hyperfocal:defocus")
    check("without aux nothing changes", close(exr.read("same.exr")["R"], color[..., 0]))
    wrong = run(gegl, "rgb.exr", "-o", "wrong.exr", "--", "hyperfocal:defocus", "blades=2", "aux=[", "load", "path=z.exr", "]")
    check(f"a wrong value is told: {wrong.stderr}", "aperture.blades is 2" in wrong.stderr)
    check("and leaves the picture", close(exr.read("wrong.exr")["R"], color[..., 0]))
print(f"{passed} passed, {failed} failed")
sys.exit(failed > 0)
