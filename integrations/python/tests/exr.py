# SPDX-License-Identifier: BSD-3-Clause
"""Just enough of OpenEXR for tests: scan lines of floats, written without compression, read also with zip's."""
import struct
import zlib

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


def inflate(block, size):
    """The bytes of a block that was compressed by zip."""
    if len(block) == size:
        return block
    delta = np.frombuffer(zlib.decompress(block), np.uint8).astype(np.int64)
    delta[1:] -= 128
    halves = (np.cumsum(delta) & 255).astype(np.uint8)
    joined = np.empty_like(halves)
    joined[0::2], joined[1::2] = halves[:(size + 1) // 2], halves[(size + 1) // 2:]
    return joined.tobytes()


def read(path):
    """{name: array} of a file with one part; channels may have half floats too."""
    with open(path, "rb") as file:
        data = file.read()
    at, names, types, box, lines = 8, [], {}, None, 1
    while data[at]:
        end = data.index(b"\0", at)
        name, at = data[at:end].decode(), data.index(b"\0", end + 1) + 1
        size, at = struct.unpack_from("<i", data, at)[0], at + 4
        value, at = data[at:at + size], at + size
        if name == "dataWindow":
            box = struct.unpack("<4i", value)
        elif name == "compression":
            if value[0] not in (0, 2, 3):
                raise ValueError(f"{path} is compressed by method {value[0]}, which this reader lacks")
            lines = 16 if value[0] == 3 else 1
        elif name == "channels":
            while len(value) > 1:
                word, value = value.split(b"\0", 1)
                names.append(word.decode())
                types[names[-1]] = {1: "<f2", 2: "<f4"}[struct.unpack_from("<i", value)[0]]
                value = value[16:]
    width, height = box[2] - box[0] + 1, box[3] - box[1] + 1
    planes = {n: np.empty((height, width), types[n]) for n in names}
    row = sum(width * planes[n].itemsize for n in names)
    for offset in struct.unpack_from(f"<{(height + lines - 1) // lines}Q", data, at + 1):
        y, size = struct.unpack_from("<ii", data, offset)
        y -= box[1]
        block, here = inflate(data[offset + 8:offset + 8 + size], row * min(lines, height - y)), 0
        for line in range(y, min(height, y + lines)):
            for n in names:
                planes[n][line] = np.frombuffer(block, types[n], width, here)
                here += width * planes[n].itemsize
    return planes
