# SPDX-License-Identifier: BSD-3-Clause
# EXR files, each wrong in one place, with faults that have crashed readers. Usage: damaged.py FOLDER
import struct
import sys
import zlib

WIDTH, HEIGHT, NAMES = 40, 36, 'ABGRZ'

def attribute(name, kind, data):
    return name.encode() + b'\0' + kind.encode() + b'\0' + struct.pack('<i', len(data)) + data

def ints(*v):
    return struct.pack('<%di' % len(v), *v)

def floats(*v):
    return struct.pack('<%df' % len(v), *v)

def channel(name, kind=2, x=1, y=1, linear=0):
    return (name if isinstance(name, bytes) else name.encode()) + b'\0' + struct.pack('<iB3xii', kind, linear, x, y)

def channels(names=NAMES):
    return b''.join(channel(n) for n in names) + b'\0'

# Attributes: name -> (type, bytes), in the order of the file. None leaves one out.
def header(**changes):
    h = {'channels': ('chlist', channels()), 'compression': ('compression', b'\0'),
         'dataWindow': ('box2i', ints(0, 0, WIDTH - 1, HEIGHT - 1)),
         'displayWindow': ('box2i', ints(0, 0, WIDTH - 1, HEIGHT - 1)), 'lineOrder': ('lineOrder', b'\0'),
         'pixelAspectRatio': ('float', floats(1)), 'screenWindowCenter': ('v2f', floats(0, 0)),
         'screenWindowWidth': ('float', floats(1))}
    for name, v in changes.items():
        if isinstance(v, bytes):
            v = (h[name][0], v)
        h[name] = v
    return h

def packed(h):
    return b''.join(attribute(n, *v) for n, v in h.items() if v) + b'\0'

def start(flags=0, magic=20000630, version=2):
    return struct.pack('<II', magic, version | flags)

def row(y, names=NAMES, width=WIDTH):
    return b''.join(floats(*(((x * 7 + y * 3) % 11) / 2 + 1 for x in range(width))) for n in names)

def chunk(y, data, size=None, part=b''):
    return part + ints(y, len(data) if size is None else size) + data

# A picture of rows, with the given chunks and a table of their offsets.
def file(head, chunks, offsets=None, flags=0, **more):
    begin = start(flags, **more) + head
    at = len(begin) + 8 * len(chunks if offsets is None else offsets)
    where = []
    for c in chunks:
        where.append(at)
        at += len(c)
    if callable(offsets):
        offsets = offsets(where)
    if offsets is None:
        offsets = where
    return begin + b''.join(struct.pack('<Q', o & (2 ** 64 - 1)) for o in offsets) + b''.join(chunks)

def rows():
    return [chunk(y, row(y)) for y in range(HEIGHT)]

def with_offsets(change):
    head, chunks = packed(header()), rows()
    first = 8 + len(head) + 8 * len(chunks)
    where = [first + i * len(chunks[0]) for i in range(len(chunks))]
    return file(head, chunks, change(where))

def with_header(flags=0, chunks=None, **changes):
    return file(packed(header(**changes)), rows() if chunks is None else chunks, flags=flags)

def tiled(mode=0, width=16, height=16, **changes):
    tiles = []
    for ty in range(3):
        for tx in range(3):
            w, h = min(16, WIDTH - 16 * tx), min(16, HEIGHT - 16 * ty)
            data = b''.join(row(16 * ty + y, width=w) for y in range(h))
            tiles.append(ints(tx, ty, 0, 0, len(data)) + data)
    desc = struct.pack('<IIB', width & 0xffffffff, height & 0xffffffff, mode)
    return file(packed(header(tiles=('tiledesc', desc), **changes)), tiles, flags=0x200)

def part(name, chunks=HEIGHT, kind=b'scanlineimage', **changes):
    return packed(header(name=('string', name), type=('string', kind), chunkCount=('int', ints(chunks)), **changes))

def parts(heads, count=1, offsets=None, numbers=None):
    chunks = [chunk(y, row(y), part=ints(numbers(p) if numbers else p)) for p in range(count) for y in range(HEIGHT)]
    return file(b''.join(heads) + b'\0', chunks, offsets, flags=0x1000)

def cases():
    whole = with_header()
    yield 'whole', whole
    # ---- offsets of chunks
    yield 'offsets-zero', with_offsets(lambda w: [0] * len(w))
    yield 'offsets-one-zero', with_offsets(lambda w: w[:20] + [0] + w[21:])
    yield 'offsets-beyond', with_offsets(lambda w: [o + 10 ** 9 for o in w])
    yield 'offsets-negative', with_offsets(lambda w: [-1] * len(w))
    yield 'offsets-smallest', with_offsets(lambda w: [-2 ** 63] * len(w))
    yield 'offsets-into-header', with_offsets(lambda w: [8] * len(w))
    yield 'offsets-into-table', with_offsets(lambda w: [w[0] - 8 * len(w)] * len(w))
    yield 'offsets-same', with_offsets(lambda w: [w[0]] * len(w))
    yield 'offsets-turned', with_offsets(lambda w: w[::-1])
    yield 'offsets-odd', with_offsets(lambda w: [o + 1 for o in w])
    yield 'offsets-at-end', with_offsets(lambda w: w[:-1] + [len(whole) - 4])
    # ---- headers of chunks
    for name, size in {'negative': -1, 'zero': 0, 'smallest': -2 ** 31, 'largest': 2 ** 31 - 1, 'short': 100,
                       'long': 4 * WIDTH * 5 + 4}.items():
        chunks = rows()
        chunks[7] = chunk(7, row(7), size)
        yield 'size-' + name, with_header(chunks=chunks)
    for name, y in {'before': -1, 'behind': HEIGHT, 'again': 6, 'far': 2 ** 31 - 1, 'nowhere': -2 ** 31}.items():
        chunks = rows()
        chunks[7] = chunk(y, row(7))
        yield 'row-' + name, with_header(chunks=chunks)
    # ---- channels
    yield 'channels-none', with_header(channels=b'\0')
    yield 'channels-empty', with_header(channels=b'')
    yield 'channels-open', with_header(channels=channels()[:-1])
    yield 'channels-cut', with_header(channels=channels()[:-9])
    yield 'channels-twice', with_header(channels=channels('RRGBZ'))
    yield 'channels-unsorted', with_header(channels=channels('ZRGBA'))
    yield 'channels-many', with_header(channels=b''.join(channel('c%05d' % i) for i in range(20000)) + b'\0')
    yield 'channels-many-layers', with_header(
        channels=b''.join(channel('l%05d.%s' % (i, n)) for i in range(5000) for n in 'BGRZ') + b'\0')
    yield 'channel-no-name', with_header(channels=channel('') + channels())
    yield 'channel-long-name', with_header(channels=channel('a' * 32) + channels())
    yield 'channel-longer-name', with_header(0x400, channels=channel('a' * 300) + channels())
    yield 'channel-binary-name', with_header(channels=channel(b'\x01\x1b[2J\xff\n') + channels())
    for kind in (3, -1, 2 ** 31 - 1):
        yield 'channel-type%d' % kind, with_header(channels=channel('A', kind) + channels('BGRZ'))
    for x, y in ((0, 1), (1, 0), (-1, 1), (2 ** 31 - 1, 1), (-2 ** 31, -2 ** 31), (7, 5)):
        yield 'channel-sampling%dx%d' % (x, y), with_header(channels=channel('A', 2, x, y) + channels('BGRZ'))
    # ---- attributes
    for name in header():
        yield 'without-' + name, with_header(**{name: None})
        yield 'type-' + name, with_header(**{name: ('string', header()[name][1])})
        yield 'empty-' + name, with_header(**{name: b''})
        yield 'longer-' + name, with_header(**{name: header()[name][1] + b'\0'})
        at = packed(header()).index(name.encode() + b'\0') + 8 + len(name) + 2 + len(header()[name][0])
        for size in (-1, 2 ** 31 - 1, -2 ** 31, len(whole)):
            yield 'length%d-%s' % (size, name), whole[:at] + ints(size) + whole[at + 4:]
        yield 'twice-' + name, file(packed(header())[:-1] + attribute(name, *header()[name]) + b'\0', rows())
    yield 'twice-other-window', file(packed(header())[:-1] + attribute('dataWindow', 'box2i', ints(0, 0, 9999, 9999)) +
                                     b'\0', rows())
    for v in range(10, 256, 49):
        yield 'compression%d' % v, with_header(compression=bytes([v]))
        yield 'order%d' % v, with_header(lineOrder=bytes([v]))
    for v in range(1, 10):
        yield 'compression%d' % v, with_header(compression=bytes([v]))
    yield 'order-random', with_header(lineOrder=b'\2')
    yield 'order-turned', with_header(lineOrder=b'\1')
    yield 'long-name', with_header(**{'a' * 40: ('int', ints(1))})
    yield 'longest-name', with_header(0x400, **{'a' * 255: ('int', ints(1))})
    yield 'too-long-name', with_header(0x400, **{'a' * 5000: ('int', ints(1))})
    yield 'long-type', with_header(odd=('t' * 40, b'1'))
    yield 'no-type', with_header(odd=('', b'1'))
    yield 'preview', with_header(preview=('preview', ints(2 ** 16, 2 ** 16) + bytes(64)))
    yield 'preview-negative', with_header(preview=('preview', ints(-1, -1) + bytes(64)))
    yield 'views-cut', with_header(multiView=('stringvector', ints(2 ** 30) + b'left'))
    yield 'views-negative', with_header(multiView=('stringvector', ints(-5) + b'left'))
    yield 'views-many', with_header(multiView=('stringvector', (ints(1) + b'v') * 20000))
    yield 'string-empty', with_header(comments=('string', b''))
    yield 'chromaticities', with_header(chromaticities=('chromaticities', floats(1, 2)))
    yield 'keycode', with_header(keyCode=('keycode', ints(1)))
    # OpenEXRCore, which reads other compressions than none, loses its place in the header behind such attributes.
    yield 'preview-rle', with_header(compression=b'\1', preview=('preview', ints(2, 1) + bytes(82)))
    yield 'chromaticities-rle', with_header(compression=b'\1', chromaticities=('chromaticities', floats(1, 2)))
    yield 'misfits-rle', with_header(compression=b'\1', **{'m%03d' % i: (kind, bytes(9)) for i, kind in enumerate(
        ['box2i', 'double', 'float', 'int', 'm44f', 'preview', 'rational', 'stringvector', 'timecode', 'v3d'] * 99)})
    yield 'attributes-many', with_header(**{'a%05d' % i: ('int', ints(i)) for i in range(20000)})
    nan, inf = float('nan'), float('inf')
    for v in (nan, inf, -inf, 0, -1, 1e-45, 3e38):
        yield 'aspect%g' % v, with_header(pixelAspectRatio=floats(v))
        yield 'screen%g' % v, with_header(screenWindowWidth=floats(v), screenWindowCenter=floats(v, v))
        yield 'lens%g' % v, with_header(focus=('float', floats(v)), aperture=('float', floats(v)),
                                        pinholeFocalLength=('float', floats(v)))
    # ---- windows
    small, large = -2 ** 31, 2 ** 31 - 1
    for name, box in {'turned': (39, 35, 0, 0), 'empty': (0, 0, -1, -1), 'narrow': (0, 0, 39, -1),
                      'all': (small, small, large, large), 'far': (large - 39, large - 35, large, large),
                      'near': (small, small, small + 39, small + 35), 'wide': (0, 0, large, 35),
                      'high': (0, 0, 39, large), 'square': (0, 0, 65535, 65535), 'strip': (0, 0, 65535, 35),
                      'pole': (0, 0, 0, 65535), 'one': (0, 0, 0, 0)}.items():
        yield 'data-' + name, with_header(dataWindow=ints(*box))
        yield 'display-' + name, with_header(displayWindow=ints(*box))
    # ---- tiles
    yield 'tiles', tiled()
    for w, h in ((0, 16), (16, 0), (-1, -1), (2 ** 31 - 1, 2 ** 31 - 1), (1, 1), (2 ** 31, 1), (2 ** 30, 2 ** 30),
                 (8, 8), (32, 32)):
        yield 'tiles%dx%d' % (w, h), tiled(0, w, h)
    for mode in (1, 2, 3, 15, 16, 17, 18, 0x20, 0xff):
        yield 'levels%d' % mode, tiled(mode)
    yield 'tiles-none', file(packed(header()), rows(), flags=0x200)
    yield 'tiles-flagless', file(packed(header(tiles=('tiledesc', struct.pack('<IIB', 16, 16, 0)))), rows())
    yield 'tiles-short', with_header(0x200, tiles=('tiledesc', b'\1\2'))
    yield 'tiles-random', tiled(lineOrder=b'\2')
    # ---- parts
    yield 'parts', parts([part(b'a'), part(b'b')], 2)
    yield 'parts-one-name', parts([part(b'a'), part(b'a')], 2)
    yield 'parts-no-name', parts([packed(header(type=('string', b'scanlineimage'), chunkCount=('int', ints(HEIGHT))))])
    yield 'parts-no-type', parts([packed(header(name=('string', b'a'), chunkCount=('int', ints(HEIGHT))))])
    yield 'parts-strange-type', parts([part(b'a', kind=b'nothing')])
    yield 'parts-no-count', parts([packed(header(name=('string', b'a'), type=('string', b'scanlineimage')))])
    for n in (0, -1, 2 ** 31 - 1, HEIGHT + 1, HEIGHT - 1):
        yield 'parts-count%d' % n, parts([part(b'a', n)])
    yield 'parts-none', file(b'\0', rows(), flags=0x1000)
    yield 'parts-many', parts([part(b'p%d' % i) for i in range(500)])
    yield 'parts-endless', start(0x1000) + b''.join(part(b'p%d' % i) for i in range(20))
    yield 'parts-number', parts([part(b'a')], 1, numbers=lambda p: 5)
    yield 'parts-number-negative', parts([part(b'a')], 1, numbers=lambda p: -1)
    yield 'parts-cyclic', parts([part(b'a'), part(b'b')], 2, numbers=lambda p: 1 - p)
    yield 'parts-deep', parts([part(b'a', kind=b'deepscanline')])
    yield 'parts-unended', parts([part(b'a')])[:8 + len(part(b'a'))]
    # ---- flags of the kind of file
    yield 'magic', start(magic=20000631) + whole[8:]
    for v in (0, 1, 3, 255):
        yield 'version%d' % v, start(version=v) + whole[8:]
    for flags in (0x200, 0x400, 0x800, 0x1000, 0x1a00, 0x2000, 0xfffff00):
        yield 'flags%x' % flags, start(flags) + whole[8:]
    yield 'type-tiled', with_header(type=('string', b'tiledimage'))
    yield 'type-deep', with_header(type=('string', b'deepscanline'))
    yield 'type-deep-flag', with_header(0x800, type=('string', b'deeptile'), version=('int', ints(1)),
                                        maxSamplesPerPixel=('int', ints(-1)))
    # ---- bombs and rubbish
    bomb = zlib.compress(bytes(1 << 24), 9)
    # one chunk of zip holds 16 rows
    for name, c, lines in (('zip', 3, 16), ('zips', 2, 1), ('rle', 1, 1), ('piz', 4, 32), ('pxr24', 5, 16), ('b44', 6, 32),
                           ('b44a', 7, 32), ('dwaa', 8, 32), ('dwab', 9, 256)):
        n = (HEIGHT + lines - 1) // lines
        # The size is smaller than that of the samples, so a reader takes them for compressed.
        full = 4 * WIDTH * 5 * lines
        for kind, data in (('bomb', bomb[:full - 4]), ('zeros', bytes(full // 2)), ('ones', b'\xff' * (full // 2)),
                           ('runs', b'\x7f\0' * (full // 4)), ('one', b'\1'), ('none', b'')):
            yield '%s-%s' % (name, kind), with_header(chunks=[chunk(i * lines, data) for i in range(n)],
                                                     compression=bytes([c]))
        # A header that claims as many chunks as a table of a few kB holds.
        tall, count = 65536, 65536 // lines
        if lines > 1:
            wide = (2 ** 29 - 1) // (tall * 20)
            data = zlib.compress(bytes(wide * 20 * lines), 9)[:wide * 20 * lines - 1]
            box = ints(0, 0, wide - 1, tall - 1)
            head = packed(header(compression=bytes([c]), dataWindow=box, displayWindow=box))
            where = 8 + len(head) + 8 * count
            yield name + '-claim', start() + head + struct.pack('<Q', where) * count + chunk(0, data)
            box = ints(0, 0, 65535, 65535)
            head = packed(header(compression=bytes([c]), dataWindow=box, displayWindow=box))
            yield name + '-claim-all', start() + head + struct.pack('<Q', where) * count + chunk(0, data)
    # ---- ends
    head = len(packed(header())) + 8
    for n in (0, 1, 3, 4, 7, 8, 9, head // 2, head - 1, head, head + 1, head + 8 * HEIGHT, len(whole) - 1):
        yield 'cut%d' % n, whole[:n]
    yield 'longer', whole + bytes(100)

for name, data in cases():
    open('%s/%s.exr' % (sys.argv[1], name), 'wb').write(data)
