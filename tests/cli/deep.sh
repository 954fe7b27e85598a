#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Deep pictures: every way in which they are stored, and damaged ones.
# Usage: deep.sh PROGRAM SOURCE_ROOT
. "$(dirname "$0")/common.sh"

make_inputs || { echo "skipped: no python3"; exit 77; }

# The bar before a wall of several.sh, as samples and as two flat pictures.
python3 - <<'PYTHON'
from exr import exr
from deep_writer import deep
W, H = 64, 40
part = lambda x, y: min(max(8.5 - abs(x - 32), 0), 1) if 4 <= y < 36 else 0
bar = {'R': part, 'G': lambda x, y: 0, 'B': lambda x, y: 0, 'A': part, 'Z': lambda x, y: 2}
wall = {'R': lambda x, y: 0, 'G': lambda x, y: part(x, y) > 0, 'B': lambda x, y: part(x, y) == 0, 'A': lambda x, y: 1,
        'Z': lambda x, y: 8}
exr('bar.exr', bar)
exr('wall.exr', wall)
one = lambda of, x, y: {n: float(f(x, y)) for n, f in of.items()}
both = lambda x, y: ([one(bar, x, y)] if part(x, y) else []) + [one(wall, x, y)]
turned = lambda x, y: both(x, y)[::-1]
ends = lambda x, y: [dict(s, ZBack=s['Z']) for s in both(x, y)]
for compression, name in enumerate(['none', 'rle', 'zips']):
    deep('line-%s.exr' % name, both, W, H, compression)
    deep('tile-%s.exr' % name, turned, W, H, compression, tile=24)
deep('parts.exr', both, W, H, 2, parts=('mask', 'beauty'))
deep('tile-parts.exr', both, W, H, 1, tile=16, parts=('mask', 'beauty'))
deep('half.exr', turned, W, H, 2, halves='RGBA')
deep('ends.exr', ends, W, H, 2)
deep('fog.exr', lambda x, y: ends(x, y) + [dict(R=.1, G=.1, B=.1, A=.5, Z=1, ZBack=7)], W, H, 2)
deep('empty.exr', lambda x, y: both(x, y) if y % 2 == 0 else [], W, H, 2)
deep('no-z.exr', lambda x, y: [{n: v for n, v in s.items() if n != 'Z'} for s in both(x, y)], W, H)
PYTHON
look='--focus 8 --focal-length 50 --fstop 0.5 --max-radius 8 --compression none'

same() {  # FILE FILE
    python3 - "$@" <<'PYTHON'
import sys
from exr import read
a, b = read(sys.argv[1]), read(sys.argv[2])
raise SystemExit(any(a[n] != b[n] for n in 'RGB'))
PYTHON
}

# shellcheck disable=SC2086
{
good wall.exr --over bar.exr -o flat.exr $look
for file in line-none line-rle line-zips tile-none tile-rle tile-zips half ends; do
    good $file.exr -o o.exr $look
    same o.exr flat.exr
    result "$file.exr is the picture of its flat layers" $?
done
for file in parts tile-parts; do
    good $file.exr -o o.exr $look --layer beauty
    same o.exr flat.exr
    result "$file.exr, the part that --layer names" $?
done
run fog.exr -o o.exr $look
[ "$status" -eq 0 ] && ! same o.exr flat.exr
result "a medium is seen" $?
good empty.exr -o o.exr $look
plan "depth Z|colour R, G, B, A" line-zips.exr $look
good line-zips.exr -o o.exr --focus center --focal-length 50 --fstop 0.5 --max-radius 8 --json j.json
contains j.json '"focus": 2'
result "the focus is on what is seen" $?
cp line-zips.exr shot.0001.exr
cp tile-zips.exr shot.0002.exr
good shot.####.exr -o o.####.exr --quiet $look
same o.0001.exr flat.exr && same o.0002.exr flat.exr
result "a shot" $?
run shot.####.exr -o o.####.exr --resume $look
contains "$dir/err" "0 done, 2 there already"
result "--resume" $?

bad 3 "no-z.exr|depth" no-z.exr -o o.exr $look
bad 1 "gather" line-none.exr -o o.exr $look --engine gather
bad 1 "--over|deep" line-none.exr --over bar.exr -o o.exr $look
bad 1 "--grow|deep" line-none.exr -o o.exr $look --grow
bad 1 "nobody" parts.exr -o o.exr $look --layer nobody
}

# ---- damaged: a picture, or one sentence, within little memory and time
python3 - <<'PYTHON'
import random
import struct
files = ['tile-none', 'line-none', 'line-zips', 'tile-rle', 'line-rle']
for number in range(40):
    any_ = random.Random(number)
    data = bytearray(open(files[number % 5] + '.exr', 'rb').read())
    table = data.index(b'chunkCount\0') + len(b'chunkCount\0int\0') + 8
    first = struct.unpack_from('<Q', data, table + 1)[0]
    how = number % 4
    if how == 0:
        del data[any_.randrange(table, len(data)):]
    elif how == 1:
        for _ in range(4):
            data[any_.randrange(first, len(data))] = any_.randrange(256)
    elif how == 2:  # a chunk's sizes
        size = any_.choice([0, 1, 2**31, 2**40, 2**63, 2**64 - 1, 10**9])
        struct.pack_into('<Q', data, first + 4 + 8 * any_.randrange(3), size)
    else:  # a count, or a place
        at = any_.randrange(table, min(first + 400, len(data) - 4))
        struct.pack_into('<i', data, at, any_.choice([-1, 2**31 - 1, 10**6, 0]))
    open('damaged.%d.exr' % number, 'wb').write(data)
PYTHON
command="damaged files" status=0 bad_ones=0
for file in damaged.*.exr; do
    # shellcheck disable=SC2086
    (ulimit -v 1500000; "$program" "$file" -o o.exr $look >"$dir/out" 2>"$dir/err" </dev/null)
    status=$?
    { [ $status -eq 0 ] || { [ $status -eq 3 ] && [ "$(wc -l <"$dir/err")" -eq 1 ]; }; } && continue
    bad_ones=$((bad_ones + 1))
    echo "$file: $status"
    cat "$dir/err"
done
[ $bad_ones -eq 0 ]
result "damaged files" $?

finish
