#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Pull the focus through a picture and plot what becomes of it.

    pull_focus.py images/lights.exr plot.png

Debian: python3-openimageio, python3-matplotlib, python3-hyperfocal. The file needs colour in R, G, B and the distance in a channel
Z or depth.Z.
"""
import sys

import matplotlib
import numpy as np
import OpenImageIO as oiio

import hyperfocal

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402


def read(path):
    """Colour (height, width, 3) and depth (height, width)."""
    file = oiio.ImageInput.open(path)
    if not file:
        sys.exit(f"pull_focus.py: {oiio.geterror()}")
    names = list(file.spec().channelnames)
    pixels = file.read_image(oiio.FLOAT)
    depth = next((i for i, name in enumerate(names) if name.split(".")[-1] in ("Z", "V")), None)
    if depth is None or not {"R", "G", "B"} <= set(names):
        sys.exit(f"pull_focus.py: {path} has the channels {', '.join(names)}; it needs R, G, B and Z")
    return np.ascontiguousarray(pixels[..., [names.index(c) for c in "RGB"]]), np.ascontiguousarray(pixels[..., depth])


def main(path, plot):
    color, depth = read(path)
    solid = depth[(depth > 0) & (depth < 1e10)]
    focuses = np.geomspace(*np.percentile(solid, [5, 95]), 4)
    _, rows = pyplot.subplots(2, len(focuses), figsize=(16, 5))
    with hyperfocal.Context() as context:
        for (above, below), focus in zip(rows.T, focuses):
            lens = {"focus": focus, "f_number": 1.4, "focal_length": 50}
            blurred = context.defocus(color, depth, **lens)
            above.imshow(np.clip(blurred, 0, 1) ** (1 / 2.2))
            above.set_title(f"focus {focus:.2f}: {context.report['total_ms']:.0f} ms")
            below.imshow(hyperfocal.coc(depth, **lens), cmap="coolwarm", vmin=-20, vmax=20)
            below.set_title("radius, pixels")
            above.axis("off")
            below.axis("off")
    pyplot.tight_layout()
    pyplot.savefig(plot)
    print(f"{path} -> {plot}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: pull_focus.py PICTURE.exr PLOT.png")
    main(*sys.argv[1:])
