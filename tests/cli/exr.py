# SPDX-License-Identifier: BSD-3-Clause
# Uncompressed EXR files of one part, all channels 32-bit floats: written, and read.
import struct

def attribute(name, kind, data):
    return name.encode() + b'\0' + kind.encode() + b'\0' + struct.pack('<i', len(data)) + data

def exr(path, channels, window=(0, 0, 63, 39), display=None, floats={}, views=None, squeeze=1.0,
        texts={}, matrices={}):
    display = display or window
    width, height = window[2] - window[0] + 1, window[3] - window[1] + 1
    names = sorted(channels)
    listed = b''.join(n.encode() + b'\0' + struct.pack('<iB3xii', 2, 0, 1, 1) for n in names) + b'\0'
    head = struct.pack('<ii', 20000630, 2)
    head += attribute('channels', 'chlist', listed) + attribute('compression', 'compression', b'\0')
    head += attribute('dataWindow', 'box2i', struct.pack('<4i', *window))
    head += attribute('displayWindow', 'box2i', struct.pack('<4i', *display))
    head += attribute('lineOrder', 'lineOrder', b'\0')
    head += attribute('pixelAspectRatio', 'float', struct.pack('<f', squeeze))
    head += attribute('screenWindowCenter', 'v2f', struct.pack('<2f', 0, 0))
    head += attribute('screenWindowWidth', 'float', struct.pack('<f', 1))
    for name, value in floats.items():
        head += attribute(name, 'float', struct.pack('<f', value))
    for name, value in matrices.items():
        head += attribute(name, 'm44f', struct.pack('<16f', *value))
    for name, value in texts.items():
        head += attribute(name, 'string', value.encode())
    if views:
        head += attribute('multiView', 'stringvector',
                          b''.join(struct.pack('<i', len(v)) + v.encode() for v in views))
    head += b'\0'
    row = 8 + 4 * width * len(names)
    first = len(head) + 8 * height
    with open(path, 'wb') as f:
        f.write(head + b''.join(struct.pack('<Q', first + row * y) for y in range(height)))
        for y in range(height):
            f.write(struct.pack('<ii', window[1] + y, row - 8))
            for n in names:
                f.write(struct.pack('<%df' % width, *(float(channels[n](x, y)) for x in range(width))))

def header(path):
    data = open(path, 'rb').read()
    at, head = 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b'\0', 2)
        at += len(name) + len(kind) + 2
        size = struct.unpack_from('<i', data, at)[0]
        head[name.decode()] = data[at + 4:at + 4 + size]
        at += 4 + size
    return head, data, at

def window(path, name='dataWindow'):
    return struct.unpack('<4i', header(path)[0][name])

def read(path):
    """The bytes of each channel."""
    head, data, at = header(path)
    window = struct.unpack('<4i', head['dataWindow'])
    width, height = window[2] - window[0] + 1, window[3] - window[1] + 1
    names, rest = [], head['channels']
    while rest[0]:
        end = rest.index(b'\0')
        names.append(rest[:end].decode())
        rest = rest[end + 17:]
    assert head['compression'] == b'\0'
    rows = struct.unpack_from('<%dQ' % height, data, at + 1)
    return {n: b''.join(data[r + 8 + 4 * width * i:r + 8 + 4 * width * (i + 1)] for r in rows)
            for i, n in enumerate(names)}
