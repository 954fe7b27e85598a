# SPDX-License-Identifier: BSD-3-Clause
"""The example runs where its packages are: Debian's python3-openimageio and python3-matplotlib."""
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import exr

EXAMPLE = Path(__file__).resolve().parent.parent / "examples/pull_focus.py"


def run(*words):
    return subprocess.run([sys.executable, EXAMPLE, *words], capture_output=True, text=True, timeout=240)


def test_pull_focus(scene, tmp_path):
    pytest.importorskip("OpenImageIO")
    pytest.importorskip("matplotlib")
    color, depth = scene
    picture, plot = tmp_path / "in.exr", tmp_path / "plot.png"
    exr.write(picture, dict(zip("RGB", np.moveaxis(color[..., :3], 2, 0)), Z=depth))
    done = run(picture, plot)
    assert done.returncode == 0, done.stderr
    assert plot.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    exr.write(picture, dict(zip("RGB", np.moveaxis(color[..., :3], 2, 0))))
    done = run(picture, plot)
    assert done.returncode == 1 and "it needs R, G, B and Z" in done.stderr
    done = run(tmp_path / "missing.exr", plot)
    assert done.returncode == 1 and "missing.exr" in done.stderr and "Traceback" not in done.stderr
