# SPDX-License-Identifier: BSD-3-Clause
"""Just enough of OpenEXR for tests: scan lines of floats without compression."""
import struct

import numpy as np


def write(path, channels, attributes=()):
    """channels: {name: array (height, width) of float32}. attributes: (name, type, bytes)."""
    names = sorted(channels)
    height, width = channels[names[0]].shape
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    listed = b"".join(n.encode() + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for n in names) + b"\0"
    header = b"\x76\x2f\x31\x01\x02\0\0\0"
    for name, kind, data in [("channels", "chlist", listed), ("compression", "compression", b"\0"),
                             ("dataWindow", "box2i", box), ("displayWindow", "box2i", box), ("lineOrder", "lineOrder", b"\0"),
                             ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                             ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
                             ("screenWindowWidth", "float", struct.pack("<f", 1)), *attributes]:
        header += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data
    header += b"\0"
    line = 8 + 4 * width * len(names)
    table = b"".join(struct.pack("<Q", len(header) + 8 * height + line * y) for y in range(height))
    planes = np.stack([channels[n] for n in names], axis=1).astype("<f4")
    lines = b"".join(struct.pack("<ii", y, line - 8) + planes[y].tobytes() for y in range(height))
    with open(path, "wb") as file:
        file.write(header + table + lines)


def read(path):
    """{name: array} of a file such as write makes; channels may have half floats too."""
    with open(path, "rb") as file:
        data = file.read()
    at, names, types, box = 8, [], {}, None
    while data[at]:
        end = data.index(b"\0", at)
        name, at = data[at:end].decode(), data.index(b"\0", end + 1) + 1
        size, at = struct.unpack_from("<i", data, at)[0], at + 4
        value, at = data[at:at + size], at + size
        if name == "dataWindow":
            box = struct.unpack("<4i", value)
        elif name == "compression" and value != b"\0":
            raise ValueError(f"{path} is compressed")
        elif name == "channels":
            while len(value) > 1:
                word, value = value.split(b"\0", 1)
                names.append(word.decode())
                types[names[-1]] = {1: "<f2", 2: "<f4"}[struct.unpack_from("<i", value)[0]]
                value = value[16:]
    width, height = box[2] - box[0] + 1, box[3] - box[1] + 1
    planes = {n: np.empty((height, width), types[n]) for n in names}
    offsets = struct.unpack_from(f"<{height}Q", data, at + 1)
    for offset in offsets:
        y, here = struct.unpack_from("<i", data, offset)[0] - box[1], offset + 8
        for n in names:
            planes[n][y] = np.frombuffer(data, types[n], width, here)
            here += width * planes[n].itemsize
    return planes
