# SPDX-License-Identifier: BSD-3-Clause
"""From a rendered multilayer EXR to a defocused picture: by hyperfocal's Python module, or else by its command."""
import os
import shutil
import struct
import subprocess
import tempfile

import numpy as np

from . import exr, lens

try:
    import hyperfocal as module
    module = module if hasattr(module, "Context") else None
except ImportError:
    module = None

INSTALL = ("hyperfocal is not installed: install the package python3-hyperfocal, or put the command hyperfocal into the PATH.")
_context = None


def backend():
    """'module', 'command' or None."""
    return "module" if module else "command" if shutil.which("hyperfocal") else None


def picture(path):
    """Colour (height, width, 4) and depth (height, width) of Blender's multilayer EXR: of the composite, else the first layer;
    the depth of what is nearest in any layer."""
    def wanted(name):
        return name.rsplit(".", 1)[0].endswith("Combined") or name.endswith("Depth.Z")
    planes = exr.read(path, wanted)
    depths = [p for n, p in planes.items() if n.endswith("Depth.Z")]
    groups = sorted({n.rsplit(".", 1)[0] for n in planes if not n.endswith("Depth.Z")}, key=lambda g: not g.startswith("Composite"))
    if not depths or not groups:
        raise ValueError(f"{path} has no depth pass: turn on Z in the view layer's passes")
    color = [planes.get(f"{groups[0]}.{c}") for c in "RGBA"]
    if color[3] is None:
        color[3] = np.ones_like(color[0])
    return np.dstack(color).astype(np.float32, copy=False), np.minimum.reduce(depths)


def defocus(picture_of, given, part=None):
    """Colour and depth to a defocused colour. part: the rows and columns that were rendered; nothing else is touched."""
    global _context
    color, depth = picture_of
    if part:
        out = np.empty(color.shape, np.float32)[::-1]
        out[:] = color
        out[part] = defocus((color[part], depth[part]), given)
        return out
    if module:
        _context = _context or module.Context()
        # Blender's rows begin at the bottom: show() then needs no copy.
        out = np.empty(color.shape, np.float32)[::-1]
        return _context.defocus(color, depth, out=out, **given)
    return by_command(color, depth, given)


def write_views(path, views):
    """One EXR with the views {name: (height, width, 4)}, the first of which has channels without a view's name."""
    names = list(views)
    listed = b"".join(struct.pack("<i", len(n.encode())) + n.encode() for n in names)
    channels = {("" if view == names[0] else f"{view}.") + c: color[..., i]
                for view, color in views.items() for i, c in enumerate("RGBA")}
    exr.write(path, channels, [("multiView", "stringvector", listed)])


def by_command(color, depth, given):
    program = shutil.which("hyperfocal")
    if not program:
        raise ValueError(INSTALL)
    height, width = depth.shape
    # The lens of the whole picture at the size of this part of it, with square pixels as the file says.
    given = dict(given, sensor_width=given["sensor_width"] * width / given["display_width"] / given["pixel_aspect"],
                 squeeze=min(max(given["squeeze"] * given["pixel_aspect"], 0.25), 4))
    with tempfile.TemporaryDirectory() as folder:
        before, after = os.path.join(folder, "in.exr"), os.path.join(folder, "out.exr")
        exr.write(before, dict(zip("RGBA", np.moveaxis(color, 2, 0)), Z=depth))
        done = subprocess.run([program, before, "-o", after, "--compression", "none", "--quiet", *lens.options(given)],
                              capture_output=True, text=True)
        if done.returncode:
            raise ValueError(done.stderr.strip() or "the command hyperfocal failed")
        planes = exr.read(after, lambda name: name in "RGBA")
    return np.dstack([planes[c] for c in "RGBA"])
