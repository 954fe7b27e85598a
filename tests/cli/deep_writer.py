# SPDX-License-Identifier: BSD-3-Clause
"""Writes small deep EXR files: scan lines or tiles, one part or several, uncompressed, RLE or ZIPS."""
import struct
import zlib
from exr import attribute


def split(data):
    """Even bytes, then odd ones, as differences."""
    data = data[::2] + data[1::2]
    return bytes((b - a + 128) & 255 if i else b for i, (a, b) in enumerate(zip(b'\0' + data, data)))


def rle(data):
    out, at = b'', 0
    while at < len(data):
        run = 1
        while at + run < len(data) and run < 128 and data[at + run] == data[at]:
            run += 1
        if run >= 3:
            out += bytes([run - 1, data[at]])
            at += run
            continue
        end = at
        while end < len(data) and end - at < 127 and not (data[end:end + 1] * 3 == data[end:end + 3]):
            end += 1
        end = max(end, at + 1)
        out += bytes([256 - (end - at)]) + data[at:end]
        at = end
    return out


def pack(data, compression):
    packed = {0: lambda d: d, 1: lambda d: rle(split(d)), 2: lambda d: zlib.compress(split(d))}[compression](data)
    return packed if len(packed) < len(data) else data


def part(samples, width, height, compression, tile, name, halves):
    """samples(x, y): a list of dicts of R, G, B, A, Z and the like. Returns the header and the chunks."""
    names = sorted({k for y in range(height) for x in range(width) for s in samples(x, y) for k in s})
    kind = {n: 1 if n in halves else 2 for n in names}
    listed = b''.join(n.encode() + b'\0' + struct.pack('<iB3xii', kind[n], 0, 1, 1) for n in names) + b'\0'
    window = struct.pack('<4i', 0, 0, width - 1, height - 1)
    head = attribute('channels', 'chlist', listed) + attribute('compression', 'compression', bytes([compression]))
    head += attribute('dataWindow', 'box2i', window) + attribute('displayWindow', 'box2i', window)
    head += attribute('lineOrder', 'lineOrder', b'\0') + attribute('pixelAspectRatio', 'float', struct.pack('<f', 1))
    head += attribute('screenWindowCenter', 'v2f', struct.pack('<2f', 0, 0))
    head += attribute('screenWindowWidth', 'float', struct.pack('<f', 1))
    head += attribute('type', 'string', b'deeptile' if tile else b'deepscanline')
    head += attribute('version', 'int', struct.pack('<i', 1)) + attribute('name', 'string', name.encode())
    head += attribute('maxSamplesPerPixel', 'int', struct.pack('<i', -1))
    if tile:
        head += attribute('tiles', 'tiledesc', struct.pack('<IIB', tile, tile, 0))
    step = tile or width
    chunks = []
    for y0 in range(0, height, tile or 1):
        for x0 in range(0, width, step):
            counts, data = b'', b''
            for y in range(y0, min(y0 + (tile or 1), height)):
                row, total = [samples(x, y) for x in range(x0, min(x0 + step, width))], 0
                for pixel in row:
                    total += len(pixel)
                    counts += struct.pack('<i', total)
                for n in names:
                    for pixel in row:
                        data += b''.join(struct.pack('<e' if kind[n] == 1 else '<f', s[n]) for s in pixel)
            place = struct.pack('<4i', x0 // step, y0 // tile, 0, 0) if tile else struct.pack('<i', y0)
            packed = pack(counts, compression), pack(data, compression)
            chunks.append(place + struct.pack('<3Q', len(packed[0]), len(packed[1]), len(data)) + packed[0] + packed[1])
    head += attribute('chunkCount', 'int', struct.pack('<i', len(chunks)))
    return head + b'\0', chunks


def deep(path, samples, width, height, compression=0, tile=0, parts=('main',), halves=()):
    """Every part but the last has no samples that show anything."""
    made = [part(samples if i == len(parts) - 1 else lambda x, y: [dict(R=0, G=0, B=0, A=0, Z=1)], width, height,
                 compression, tile, name, halves) for i, name in enumerate(parts)]
    several = len(parts) > 1
    head = struct.pack('<ii', 20000630, 2 | 0x800 | (0x1000 if several else 0))
    head += b''.join(h for h, _ in made) + (b'\0' if several else b'')
    at = len(head) + sum(8 * len(c) for _, c in made)
    tables, body = b'', b''
    for i, (_, chunks) in enumerate(made):
        for chunk in chunks:
            tables += struct.pack('<Q', at + len(body))
            body += (struct.pack('<i', i) if several else b'') + chunk
    open(path, 'wb').write(head + tables + body)
