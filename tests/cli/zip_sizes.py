#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
# The command's ZIP files of halves are no longer than zlib's level 4 would make them, and --zip-level decides their size.
# usage: zip_sizes.py COMMAND
import math
import os
import random
import struct
import subprocess
import sys
import tempfile
import zlib

WIDTH, HEIGHT, LINES = 320, 192, 16
CHANNELS = (b'B', b'G', b'R', b'Z')
passed = failed = 0


def check(ok, what):
    global passed, failed
    passed, failed = passed + bool(ok), failed + (not ok)
    if not ok:
        print('FAILED:', what)


def attribute(name, kind, value):
    return name + b'\0' + kind + b'\0' + struct.pack('<i', len(value)) + value


def make(path, value):
    """Write an uncompressed EXR of halves; value(x, y, c) is a sample."""
    box = struct.pack('<4i', 0, 0, WIDTH - 1, HEIGHT - 1)
    channels = b''.join(c + b'\0' + struct.pack('<iiii', 1, 0, 1, 1) for c in CHANNELS) + b'\0'
    head = struct.pack('<II', 20000630, 2) + b''.join((
        attribute(b'channels', b'chlist', channels), attribute(b'compression', b'compression', b'\0'),
        attribute(b'dataWindow', b'box2i', box), attribute(b'displayWindow', b'box2i', box),
        attribute(b'lineOrder', b'lineOrder', b'\0'), attribute(b'pixelAspectRatio', b'float', struct.pack('<f', 1)),
        attribute(b'screenWindowCenter', b'v2f', struct.pack('<ff', 0, 0)),
        attribute(b'screenWindowWidth', b'float', struct.pack('<f', 1)))) + b'\0'
    size = 8 + 2 * WIDTH * len(CHANNELS)
    table = struct.pack('<%dQ' % HEIGHT, *(len(head) + 8 * HEIGHT + y * size for y in range(HEIGHT)))
    with open(path, 'wb') as f:
        f.write(head + table)
        for y in range(HEIGHT):
            row = [value(x, y, c) for c in range(len(CHANNELS)) for x in range(WIDTH)]
            f.write(struct.pack('<ii%de' % len(row), y, size - 8, *row))


def chunks(path):
    """The contents of a file's ZIP chunks, as they are stored."""
    data = open(path, 'rb').read()
    at = 8
    while data[at]:
        at = data.index(b'\0', data.index(b'\0', at) + 1) + 1
        at += 4 + struct.unpack_from('<i', data, at)[0]
    for offset in struct.unpack_from('<%dQ' % (HEIGHT // LINES), data, at + 1):
        yield data[offset + 8:offset + 8 + struct.unpack_from('<i', data, offset + 4)[0]]


def depth(x, y):
    return 2 + 8 * ((x // 40 + y // 30) % 3)


# Level 2 makes both of these longer than zlib does, so their chunks need the second try.
def gradient(x, y, c):
    return depth(x, y) if c == 3 else 0.1 + 0.9 * (x + (c + 1) * y) / 1000


def pattern(x, y, c):
    return depth(x, y) if c == 3 else ((x * 7 + y * 3) % 23 + x // 9 * y // 9 % 5) / 7


def flat(x, y, c):
    return 4 if c == 3 else 0.25 * c


def render(x, y, c):
    """Surfaces with a little noise, which most renders have."""
    light = 0.3 + 0.2 * math.sin(x / 17 + c) * math.cos(y / 23)
    return depth(x, y) if c == 3 else light * depth(x, y) / 10 + dice.gauss(0, 0.01)


def noise(x, y, c):
    return depth(x, y) if c == 3 else dice.random()


def run(*options):
    subprocess.run([sys.argv[1], *options], check=True, stdout=subprocess.DEVNULL)


dice = random.Random(1)
raw = 2 * WIDTH * LINES * len(CHANNELS)
with tempfile.TemporaryDirectory() as folder:
    source, target = os.path.join(folder, 'a.exr'), os.path.join(folder, 'o.exr')
    for value in (gradient, pattern, flat, render, noise):
        make(source, value)
        sizes = {}
        for blur in ('0', '6'):
            look = (source, '-o', target, '--focus', '4', '--range', '4', '--engine', 'gather', '--max-radius', blur,
                    '--compression', 'zip')
            for level in ('', '1', '12'):
                run(*look, *(('--zip-level', level) if level else ()))
                sizes[level] = sum(map(len, chunks(target)))
                # A chunk of full length is stored as it is.
                sorted_bytes = [zlib.decompress(c) for c in chunks(target) if len(c) < raw]
                check(all(len(c) == raw for c in sorted_bytes), '%s: chunks of %d bytes' % (value.__name__, raw))
                if level:
                    continue
                reference = sum(min(len(zlib.compress(c, 4)), raw) for c in sorted_bytes)
                stored = sum(len(c) for c in chunks(target) if len(c) == raw)
                # A block's header may be longer by a few bytes; libdeflate's are, for chunks of a few hundred bytes.
                most = reference + stored + 16 * (HEIGHT // LINES)
                check(sizes[level] <= most, '%s, blur %s: %d bytes, zlib %d' % (value.__name__, blur, sizes[level], most))
            check(sizes['12'] <= sizes[''] and sizes['12'] < sizes['1'],
                  '%s, blur %s: level 12 %d bytes, 1 %d, default %d' % (value.__name__, blur, sizes['12'], sizes['1'],
                                                                        sizes['']))
print('%d passed, %d failed' % (passed, failed))
sys.exit(failed > 0)
