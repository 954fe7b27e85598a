# SPDX-License-Identifier: BSD-3-Clause
import os
import sys
from pathlib import Path

import numpy as np
import pytest

# The add-on's reader and writer of EXR files.
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "blender/hyperfocal_dof"))


@pytest.fixture
def scene():
    """A picture of lamps before a wall, (48, 64, 4), and its depth."""
    random = np.random.default_rng(1)
    color = random.random((48, 64, 4), np.float32)
    color[10:14, 20:24, :3] = 8
    color[..., 3] = 1
    depth = np.full((48, 64), 20, np.float32)
    depth[8:30, 16:40] = 3
    depth[36:] = 10
    return color, depth


@pytest.fixture
def command():
    return os.environ["HF_COMMAND"]


def pytest_terminal_summary(terminalreporter):
    count = {k: len(terminalreporter.stats.get(k, [])) for k in ("passed", "failed", "error")}
    terminalreporter.write_line(f"{count['passed']} passed, {count['failed'] + count['error']} failed")
