# SPDX-License-Identifier: BSD-3-Clause
"""Just enough of OpenEXR: scan lines, written without compression, read also with zip's. Tests outside of Blender use it too."""
import struct
import zlib

import numpy as np


def _inflate(block, size):
    if len(block) == size:
        return block
    delta = np.frombuffer(zlib.decompress(block), np.uint8).astype(np.int64)
    delta[1:] -= 128
    halves = (np.cumsum(delta) & 255).astype(np.uint8)
    joined = np.empty_like(halves)
    joined[0::2], joined[1::2] = halves[:(size + 1) // 2], halves[(size + 1) // 2:]
    return joined.tobytes()


def _header(data):
    """Names and types of the channels, the data window, rows of a block, and where the table of blocks begins."""
    at, channels, box, rows = 8, [], None, 1
    while data[at]:
        end = data.index(b"\0", at)
        name, at = data[at:end], data.index(b"\0", end + 1) + 1
        size, at = struct.unpack_from("<i", data, at)[0], at + 4
        value, at = data[at:at + size], at + size
        if name == b"dataWindow":
            box = struct.unpack("<4i", value)
        elif name == b"compression":
            if value[0] not in (0, 2, 3):
                raise ValueError("the EXR is not compressed by ZIP")
            rows = 16 if value[0] == 3 else 1
        elif name == b"channels":
            while len(value) > 1:
                word, value = value.split(b"\0", 1)
                channels.append((word.decode(), {0: "<u4", 1: "<f2", 2: "<f4"}[struct.unpack_from("<i", value)[0]]))
                value = value[16:]
    return channels, box, rows, at + 1


def read(path, wanted=lambda name: True):
    """{name: array} of the channels for which wanted(name) is true, of a file with one part in scan lines."""
    with open(path, "rb") as file:
        data = file.read()
    channels, box, rows, table = _header(data)
    width, height = box[2] - box[0] + 1, box[3] - box[1] + 1
    planes = {n: np.empty((height, width), t) for n, t in channels if wanted(n)}
    line = sum(width * np.dtype(t).itemsize for _, t in channels)
    for offset in struct.unpack_from(f"<{(height + rows - 1) // rows}Q", data, table):
        y, size = struct.unpack_from("<ii", data, offset)
        y -= box[1]
        count = min(rows, height - y)
        block = np.frombuffer(_inflate(data[offset + 8:offset + 8 + size], line * count), np.uint8).reshape(count, line)
        at = 0
        for name, kind in channels:
            end = at + width * np.dtype(kind).itemsize
            if name in planes:
                planes[name][y:y + count] = np.ascontiguousarray(block[:, at:end]).view(kind)
            at = end
    return planes


def write(path, channels, attributes=()):
    """Uncompressed floats. channels: {name: array (height, width)}; attributes: (name, type, bytes)."""
    names = sorted(channels)
    height, width = channels[names[0]].shape
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    listed = b"".join(n.encode() + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for n in names) + b"\0"
    header = b"\x76\x2f\x31\x01\x02\0\0\0"
    for name, kind, value in (("channels", "chlist", listed), ("compression", "compression", b"\0"), ("dataWindow", "box2i", box),
                              ("displayWindow", "box2i", box), ("lineOrder", "lineOrder", b"\0"),
                              ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                              ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
                              ("screenWindowWidth", "float", struct.pack("<f", 1)), *attributes):
        header += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    header += b"\0"
    line = 8 + 4 * width * len(names)
    planes = np.stack([channels[n] for n in names], axis=1).astype("<f4")
    with open(path, "wb") as file:
        file.write(header + b"".join(struct.pack("<Q", len(header) + 8 * height + line * y) for y in range(height)))
        for y in range(height):
            file.write(struct.pack("<ii", y, line - 8) + planes[y].tobytes())
