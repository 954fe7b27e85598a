# SPDX-License-Identifier: BSD-3-Clause
# Functions that the tests of the command source, with PROGRAM SOURCE_ROOT: they run, check, and make small pictures.
# shellcheck shell=sh
. "$(dirname "$0")/../support/check.sh"
program=$1
source_root=$2
if [ ! -x "$program" ] || [ ! -d "$source_root" ]; then
    echo "usage: $0 PROGRAM SOURCE_ROOT" >&2
    exit 1
fi
program=$(absolute "$program")
source_root=$(absolute "$source_root")
work=$dir/work
mkdir "$work" && cd "$work" || exit 1
unset HYPERFOCAL_ISA

explain() {
    echo "hyperfocal $command -> $status"
    sed 's/^/stderr: /' "$dir/err"
}
run() {  # ARGUMENTS...
    command=$*
    "$program" "$@" >"$dir/out" 2>"$dir/err" </dev/null
    status=$?
}
contains() {  # FILE WORD
    grep -qF -e "$2" "$1"
}
# Sets ok to 1 if any of $words, separated by '|', is missing from the file.
lacks() {  # FILE WHAT-IT-IS
    old_ifs=$IFS
    IFS='|'
    for word in $words; do
        contains "$1" "$word" || { ok=1; echo "the $2 lacks '$word':"; }
    done
    IFS=$old_ifs
}

# Bad input: exit CODE, exactly one line on stderr with all of WORDS (separated by '|'), nothing on stdout, and the
# working directory as it was.
bad() {  # CODE WORDS ARGUMENTS...
    code=$1 words=$2
    shift 2
    before=$(ls -lR .)
    run "$@"
    ok=0
    [ "$status" -eq "$code" ] || { ok=1; echo "exit code $status, not $code:"; }
    [ "$(wc -l <"$dir/err")" -eq 1 ] || { ok=1; echo "not one line on stderr:"; }
    [ ! -s "$dir/out" ] || { ok=1; echo "something on stdout:"; }
    [ "$(ls -lR .)" = "$before" ] || { ok=1; echo "files were written or changed:"; }
    lacks "$dir/err" sentence
    result "refuse: $*" $ok
}

# Good input: exit 0 and nothing on stderr.
good() {  # ARGUMENTS...
    run "$@"
    [ "$status" -eq 0 ] && [ ! -s "$dir/err" ]
    result "accept: $*" $?
}

# A dry run whose plan has all of WORDS.
plan() {  # WORDS ARGUMENTS...
    words=$1
    shift
    run "$@" --dry-run
    ok=$status
    lacks "$dir/out" plan
    result "plan: $*" "$ok"
}

json_valid() {  # FILE
    [ -s "$1" ] && { ! command -v python3 >/dev/null || python3 -m json.tool <"$1" >/dev/null; }
}

# Small uncompressed EXR files, all channels 32-bit floats.
make_inputs() {
    command -v python3 >/dev/null || return 1
    export PYTHONPATH="$source_root/tests/cli" PYTHONDONTWRITEBYTECODE=1
    python3 - <<'PYTHON'
import struct
import zlib
from exr import exr, attribute

colour = {'R': lambda x, y: x % 7 / 7, 'G': lambda x, y: y % 5 / 5, 'B': lambda x, y: (x ^ y) % 3}
depth = lambda x, y: 1 + x // 8 if y < 30 else 1e10
lens = {'focus': 4, 'aperture': 2, 'pinholeFocalLength': 50}
exr('plain.exr', dict(colour, Z=depth))
exr('lens.exr', dict(colour, Z=depth), floats=lens)
blender = {'BlenderMultiChannel': 'Blender V2.55.1 and newer'}
exr('blender.exr', dict(colour, Z=depth), floats=lens, texts=blender)
exr('border.exr', dict(colour, Z=depth), floats=lens, texts=blender, window=(0, 0, 48, 37))
exr('focus.exr', dict(colour, Z=depth), floats={'focus': 4})
exr('stop.exr', dict(colour, Z=depth), floats={'focus': 4, 'aperture': 2})
exr('nominal.exr', dict(colour, Z=depth), floats={'focus': 4, 'aperture': 2, 'nominalFocalLength': 50})
exr('unfocused.exr', dict(colour, Z=depth), floats={'aperture': 2, 'pinholeFocalLength': 50, 'focus': 0})
exr('closed.exr', dict(colour, Z=depth), floats={'focus': 4, 'aperture': 0, 'pinholeFocalLength': 50})
exr('flat.exr', colour)
exr('aperture.exr', {'Y': lambda x, y: x > y}, window=(0, 0, 20, 20))
exr('black.exr', {'Y': lambda x, y: 0}, window=(0, 0, 9, 9))
open('broken.exr', 'wb').write(b'no picture')
exr('offset.exr', dict(colour, Z=depth, A=lambda x, y: 1), window=(-10, 20, 53, 59), display=(0, 0, 63, 79))
exr('nan.exr', dict(colour, R=lambda x, y: float('nan') if x == y == 9 else 0.5, Z=depth))
exr('depth.exr', {'Y': depth})
exr('grey.exr', {'Y': lambda x, y: x % 7, 'Z': depth})
exr('steps.exr', {'Y': lambda x, y: 2 ** (x // 16)})
exr('half-steps.exr', {'Y': lambda x, y: 2 ** (x // 8)}, window=(0, 0, 31, 19))
exr('small.exr', {'Y': depth}, window=(0, 0, 9, 9))
exr('deep.exr', dict(colour, **{'my.depth': depth, 'other.depth': depth}))
stereo = dict(colour, Z=depth)
stereo.update({'left.' + n: f for n, f in colour.items()})
exr('half-stereo.exr', stereo, views=['right', 'left'])
stereo['left.Z'] = lambda x, y: 1 + y // 8
exr('stereo.exr', stereo, views=['right', 'left'])
layers = {}
for layer, z in {'ViewLayer': depth, 'Foreground': lambda x, y: 1 + y // 8}.items():
    layers.update({layer + '.Combined.' + n: f for n, f in colour.items()})
    layers[layer + '.Depth.Z'] = z
layers.update({'CryptoObject00.' + n: lambda x, y: x for n in 'rgba'})
exr('layers.exr', layers)
# Depth channels named as colours (Depth.R), as Cinema 4D and Unreal write them, beside others.
for name, layer in {'c4d': 'Z Depth', 'unreal': 'FinalImageMovieRenderQueue_WorldDepth', 'scene': 'X_SceneDepth'}.items():
    exr(name + '.exr', dict(colour, **{layer + '.' + n: depth for n in 'RGB'}, **{'my.depth': depth}))
exr('final.exr', {layer + '.' + n: f for n, f in colour.items() for layer in ['FinalImage', 'FinalImageWorldDepth']})
many = dict(colour, Z=depth)
for i in range(1, 7):
    many.update({'L%d.Combined.%s' % (i, n): f for n, f in colour.items()})
    many['L%d.Depth.Z' % i] = lambda x, y: 1 + y // 8
exr('many.exr', many)
# An object that does not fill the frame, and the same picture cropped to the object.
inside = lambda x, y: 24 <= x <= 43 and 12 <= y <= 27
film = {n: (lambda f: lambda x, y: f(x, y) * inside(x, y))(f) for n, f in colour.items()}
film.update(A=inside, Z=lambda x, y: 1 + x / 40 if inside(x, y) else 1e10, id=lambda x, y: 7)
exr('film.exr', film)
cropped = {n: (lambda f: lambda x, y: f(x + 24, y + 12))(f) for n, f in film.items()}
exr('crop.exr', cropped, window=(24, 12, 43, 27), display=(0, 0, 63, 39))
exr('bare.exr', cropped, window=(0, 0, 19, 15))
# The same depth in other forms: negative, 0 to 1 and 1 to 0 for distances 1 to 9, 1/z, and distance / 3 - 5.
near = lambda x, y: 2 ** (x // 16)
exr('near.exr', dict(colour, Z=near))
exr('filtered.exr', dict(colour, Z=lambda x, y: 2 if x < 30 else 4 if x < 31 else 8))
exr('negative.exr', dict(colour, Z=lambda x, y: -near(x, y)))
exr('background.exr', dict(colour, Z=lambda x, y: -near(x, y) if y < 30 else 0))
exr('mixed.exr', dict(colour, Z=lambda x, y: near(x, y) if y else -1))
exr('normal.exr', dict(colour, Z=lambda x, y: (near(x, y) - 1) / 8))
exr('inverted.exr', dict(colour, Z=lambda x, y: 1 - (near(x, y) - 1) / 8))
exr('inverse.exr', dict(colour, Z=lambda x, y: 1 / near(x, y)))
exr('scaled.exr', dict(colour, Z=lambda x, y: near(x, y) * 4 - 5))
exr('sky.exr', dict(colour, Z=lambda x, y: near(x, y) if y < 30 else 0))
exr('ndc.exr', dict(colour, Z=lambda x, y: (x + 1) / 64))
exr('void.exr', dict(colour, Z=lambda x, y: 0))
def png(path, depth, bits, colours=None, width=64, height=40, profile=None):
    rows = b''
    for y in range(height):
        rows += b'\0' + b''.join(struct.pack('>H' if bits == 16 else 'B', round(f(x, y) * (2 ** bits - 1)))
                                 for x in range(width) for f in ([depth] if not colours else colours))
    chunk = lambda kind, data: (struct.pack('>I', len(data)) + kind + data +
                                struct.pack('>I', zlib.crc32(kind + data)))
    open(path, 'wb').write(b'\x89PNG\r\n\x1a\n' +
        chunk(b'IHDR', struct.pack('>IIBBBBB', width, height, bits, 2 if colours else 0, 0, 0, 0)) +
        (chunk(b'iCCP', b'test\0\0' + zlib.compress(profile)) if profile else b'') +
        chunk(b'IDAT', zlib.compress(rows)) + chunk(b'IEND', b''))
png('map8.png', lambda x, y: x // 13 / 5, 8)
png('soft8.png', lambda x, y: .2 if x < 30 else .5 if x < 31 else .8, 8)
png('half8.png', lambda x, y: 2 * x // 13 / 5, 8, width=32, height=20)
png('map16.png', lambda x, y: x // 13 / 5, 16)
png('white.png', lambda x, y: 1 - x // 13 / 5, 8)
png('photo.png', None, 8, colours=[lambda x, y: x % 7 / 7, lambda x, y: y % 5 / 5, lambda x, y: (x ^ y) % 3 / 3])
# A colour profile of a gamma of 1.8 and the primaries of ProPhoto RGB (ROMM), and one with a table in place of a matrix.
xyz = lambda *v: b'XYZ \0\0\0\0' + struct.pack('>3i', *(round(65536 * x) for x in v))
def icc(tags):
    at, rows, data = 132 + 12 * len(tags), b'', b''
    for name, value in tags.items():
        rows += name + struct.pack('>II', at + len(data), len(value))
        data += value + bytes(-len(value) % 4)
    body = struct.pack('>I', len(tags)) + rows + data
    head = struct.pack('>I4sI4s4s4s12x4s', 128 + len(body), b'none', 0x02400000, b'mntr', b'RGB ', b'XYZ ', b'acsp')
    return head + bytes(28) + struct.pack('>3i', 63190, 65536, 54061) + bytes(48) + body
gamma = b'curv\0\0\0\0' + struct.pack('>IH', 1, 461) + bytes(2)
words = {b'desc': b'desc\0\0\0\0' + struct.pack('>I', 5) + b'Romm\0' + bytes(78), b'wtpt': xyz(.9642, 1, .8249),
         b'cprt': b'text\0\0\0\0none\0\0\0\0'}
romm = icc({**words, b'rXYZ': xyz(.79767, .28804, 0), b'gXYZ': xyz(.13519, .71188, 0),
           b'bXYZ': xyz(.03134, .00009, .82491), b'rTRC': gamma, b'gTRC': gamma, b'bTRC': gamma})
open('romm.icc', 'wb').write(romm)
ramp = [lambda x, y: x / 63, lambda x, y: y / 39, lambda x, y: (x + y) % 40 / 39]
png('romm.png', None, 8, colours=ramp, profile=romm)
png('ramp.png', None, 8, colours=ramp)
# A photograph's EXIF, in a TIFF: f/1.8, 26 mm as seen by 35 mm film, 6.9 mm.
def tiff(path, exif):
    pixels = bytes(round(255 * f(x, y)) for y in range(40) for x in range(64) for f in ramp)
    def directory(at, entries):
        rows, more, end = b'', b'', at + 2 + 12 * len(entries) + 4
        for tag, kind, value in entries:
            data = struct.pack('<2I', *value) if kind == 5 else struct.pack('<%dH' % len(value), *value) if kind == 3 else \
                struct.pack('<I', value[0])
            if len(data) > 4:
                more, data = more + data, struct.pack('<I', end + len(more))
            rows += struct.pack('<HHI', tag, kind, 1 if kind == 5 else len(value)) + data.ljust(4, b'\0')
        return struct.pack('<H', len(entries)) + rows + bytes(4) + more
    first = 8 + len(pixels)
    base = [(256, 3, [64]), (257, 3, [40]), (258, 3, [8, 8, 8]), (259, 3, [1]), (262, 3, [2]), (273, 4, [8]), (277, 3, [3]),
            (278, 3, [40]), (279, 4, [len(pixels)])]
    size = len(directory(first, base + [(34665, 4, [0])]))
    open(path, 'wb').write(b'II*\0' + struct.pack('<I', first) + pixels +
                           directory(first, base + [(34665, 4, [first + size])]) + directory(first + size, exif))
tiff('photo.tif', [(33437, 5, [18, 10]), (37386, 5, [69, 10]), (41989, 3, [26])])
# Cryptomatte: Suzanne at distance 2, Box at 4, Wall at 8; numbers as Blender writes them, of which that of Box is no normal
# float before its bit 23 is turned. Some pixels of the wall have a little of Suzanne in the second pair.
number = {'Suzanne': 0xcb432898, 'Box': 0x803b1009 ^ 1 << 23, 'Wall': 0x2c388f97}
bits = lambda name: struct.unpack('<f', struct.pack('<I', number[name]))[0]
where = lambda x: 'Suzanne' if x < 20 else 'Box' if x < 40 else 'Wall'
mattes = dict(colour, Z=lambda x, y: {'Suzanne': 2, 'Box': 4, 'Wall': 8}[where(x)])
mattes.update({'V.Crypto00.r': lambda x, y: bits(where(x)), 'V.Crypto00.g': lambda x, y: .75 if x > 60 else 1,
               'V.Crypto00.b': lambda x, y: bits('Suzanne') if x > 60 else 0, 'V.Crypto00.a': lambda x, y: .25 if x > 60 else 0})
key = 'cryptomatte/0123456/'
manifest = '{"Suzanne":"cb432898","Wall":"2c388f97", "Box":"803b1009"}'
exr('matte.exr', mattes, texts={key + 'name': 'V.Crypto', key + 'manifest': manifest})
exr('hashed.exr', mattes, texts={key + 'name': 'V.Crypto'})
exr('beside.exr', mattes, texts={key + 'name': 'V.Crypto', key + 'manif_file': 'side.json'})
open('side.json', 'w').write(manifest)
# A camera at 1, 2, 13 that looks along -z: what is at z is at 13 - z.
camera = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, -2, -13, 1]
exr('camera.exr', dict(colour, Z=depth), matrices={'worldToCamera': camera})
exr('ndc-camera.exr', dict(colour, Z=depth), matrices={'worldToNDC': [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, -1, 0, 0, 1, 13]})
# A shot: a head comes from 4 to 3.2 before a wall at 9; in the frames 4 to 6 a wall at 1 comes by. One pixel is noise.
for i in range(9):
    z = lambda x, y: 30 if (x, y) == (31, 20) and i == 0 else 1 if 3 <= i <= 5 and x > 10 else 4 - .1 * i if 20 < x < 45 else 9
    exr('walk.%04d.exr' % (i + 1), dict(colour, Z=z))
# A file of deep scan lines, as far as its header: one part of type deepscanline, version bit 11.
flat = open('depth.exr', 'rb').read()
at = flat.index(b'channels\0')
deep = (struct.pack('<ii', 20000630, 2 | 0x800) + attribute('type', 'string', b'deepscanline') +
        attribute('version', 'int', struct.pack('<i', 1)) + attribute('chunkCount', 'int', struct.pack('<i', 40)) +
        attribute('maxSamplesPerPixel', 'int', struct.pack('<i', 1)) + attribute('name', 'string', b'main') + flat[at:])
open('samples.exr', 'wb').write(deep)
open('png.exr', 'wb').write(b'\x89PNG\r\n\x1a\n' + bytes(40))
open('blend.exr', 'wb').write(b'BLENDER-v304' + bytes(40))
open('garbage.exr', 'wb').write(b'this is not a picture\n' * 10)
whole = open('plain.exr', 'rb').read()
open('short.exr', 'wb').write(whole[:len(whole) // 2])
PYTHON
}

