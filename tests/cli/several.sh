#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Several pictures of one scene: --over, --peel, and --merge of layers.
# Usage: several.sh PROGRAM SOURCE_ROOT
. "$(dirname "$0")/common.sh"

make_inputs || { echo "skipped: no python3"; exit 77; }

# A bar at distance 2 with soft edges, before a wall at 8 of which the bar hides a green part: as two renders, as one
# with a peel, as layers of one file, and the bar alone cropped to a smaller data window.
python3 - <<'PYTHON'
from exr import exr
part = lambda x, y: min(max(8.5 - abs(x - 32), 0), 1) if 4 <= y < 36 else 0
bar = {'R': part, 'G': lambda x, y: 0, 'B': lambda x, y: 0, 'A': part, 'Z': lambda x, y: 2 if part(x, y) >= .5 else 1e10}
wall = {'R': lambda x, y: 0, 'G': lambda x, y: part(x, y) > 0, 'B': lambda x, y: part(x, y) == 0, 'A': lambda x, y: 1,
        'Z': lambda x, y: 8}
exr('bar.exr', bar)
exr('wall.exr', wall)
exr('opaque.exr', {n: wall[n] for n in 'RGBZ'})
exr('bar2.exr', dict(bar, R=lambda x, y: part(x, y) / 2))
both = {n: (lambda n: lambda x, y: bar[n](x, y) + (1 - part(x, y)) * wall[n](x, y))(n) for n in 'RGBA'}
both['Z'] = lambda x, y: 2 if part(x, y) >= .5 else 8
exr('both.exr', dict(both, id=lambda x, y: x))
exr('peel.exr', dict(wall, A=lambda x, y: part(x, y) > 0, B=lambda x, y: 0))
exr('file.exr', {layer + '.' + n: f for layer, of in {'Near': bar, 'Far': wall}.items() for n, f in of.items()})
exr('one-depth.exr', {**{layer + '.' + n: of[n] for layer, of in {'Near': bar, 'Far': wall}.items() for n in 'RGBA'},
                      'Z': lambda x, y: 3})
exr('crop-bar.exr', {n: (lambda f: lambda x, y: f(x + 20, y + 2))(f) for n, f in bar.items()}, window=(20, 2, 43, 37),
    display=(0, 0, 63, 39))
exr('wide.exr', wall, window=(0, 0, 64, 39))
exr('no-depth.exr', {n: wall[n] for n in 'RGBA'})
for i in (1, 2):
    exr('bar.%04d.exr' % i, dict(bar, R=lambda x, y: part(x, y) * i))
    exr('wall.%04d.exr' % i, wall)
exr('eyes.exr', {p + n: f for p in ('', 'left.') for n, f in bar.items()}, views=['right', 'left'])
PYTHON
look='--focus 8 --focal-length 50 --fstop 0.5 --max-radius 8'

# Do two files have the same channels? Names follow: of both, or FIRST=SECOND.
same() {  # FILE FILE NAMES...
    python3 - "$@" <<'PYTHON'
import sys
from exr import read
a, b = read(sys.argv[1]), read(sys.argv[2])
pairs = [n.partition('=') for n in sys.argv[3:]]
raise SystemExit(any(a[x] != b[y or x] for x, _, y in pairs))
PYTHON
}

# ---- --over
# shellcheck disable=SC2086
{
good wall.exr --over bar.exr -o a.exr $look
good bar.exr --over wall.exr -o b.exr $look
same a.exr b.exr R G B A && same b.exr bar.exr Z
result "the order of pictures does not count, and the rest is that of INPUT" $?
python3 - <<'PYTHON'
import struct
from exr import read
green = struct.unpack('<2560f', read('a.exr')['G'])
raise SystemExit(not max(green) > .3)
PYTHON
result "a lens sees what the bar hides" $?
good wall.exr --over bar.exr -o s.exr $look --engine scatter
good bar.exr --over wall.exr -o c.exr $look --engine scatter
same s.exr c.exr R G B A
result "nor with the other engine that takes several" $?
good opaque.exr --over bar.exr -o c.exr $look
same a.exr c.exr R G B
result "a picture without alpha is opaque" $?
good wall.exr --over crop-bar.exr -o c.exr $look
same a.exr c.exr R G B A
result "a picture with a smaller data window" $?
good crop-bar.exr --over wall.exr -o c.exr $look
same a.exr c.exr R G B A && python3 -c "from exr import window; raise SystemExit(window('c.exr') != (0, 0, 63, 39))"
result "the data window grows to hold all pictures" $?
good wall.exr --over bar.exr --over bar2.exr -o c.exr $look
good eyes.exr --over wall.exr -o c.exr $look
same b.exr c.exr R G B R=left.R G=left.G
result "every view has the further picture" $?
good bar.exr --over wall.exr -o c.exr --focus center --focal-length 50 --fstop 0.5 --max-radius 8 --json j.json
json_valid j.json && contains j.json '"surfaces"' && contains j.json '"wall.exr"' && contains j.json '"focus": 2'
result "the focus, and --json" $?
plan "over wall.exr, depth Z" bar.exr --over wall.exr -o c.exr $look
run bar.exr --over wall.exr -o c.exr --verbose $look
contains "$dir/err" "2 pictures of one scene"
result "--verbose counts the pictures" $?

# ---- --peel
good both.exr -o flat.exr $look
good both.exr --peel peel.exr -o p.exr $look
! same flat.exr p.exr G && same p.exr both.exr id Z
result "a peel is seen, and other channels stay" $?
good both.exr --peel peel.exr --peel peel.exr -o o.exr $look

# ---- --merge
good file.exr --layer Near --layer Far --merge -o m.exr $look
same m.exr b.exr Near.R=R Near.G=G Near.B=B Near.A=A && same m.exr file.exr Far.R Far.G Far.B Far.A Near.Z Far.Z
result "--merge is --over, within a file" $?
good file.exr --layer Near,Far --merge -o n.exr $look
same m.exr n.exr Near.R Near.G
result "--layer given twice is a list" $?
good file.exr --layer all --merge -o n.exr $look
if "$program" wall.exr --over bar.exr -o m.png $look 2>"$dir/err"; then
    good file.exr --layer Near,Far --merge -o n.png $look
    cmp -s m.png n.png
    result "merged layers are one picture" $?
else
    skip "no OpenImageIO"
fi

# ---- --guessed
good both.exr -o o.exr $look --quiet --guessed --json j.json
good bar.exr --over wall.exr -o o.exr $look --quiet --guessed --json k.json
python3 - <<'PYTHON'
import json
one, two = (json.load(open(n))['views'][0]['guessed'] for n in ('j.json', 'k.json'))
raise SystemExit(not 0 <= two < one < .5)
PYTHON
result "less is guessed where more is shown" $?
good both.exr -o c.exr $look --quiet --guessed-image g.exr
same c.exr flat.exr R G B && grep -q guessed g.exr
result "--guessed-image, and the picture stays" $?
good both.exr -o d.exr $look --quiet --guessed
! grep -q guessed c.exr && same d.exr d.exr guessed && same d.exr c.exr R G B A Z id
result "OUTPUT has a channel guessed, and all else that INPUT has" $?
blur='--focus 4 --focal-length 50 --fstop 0.5 --max-radius 8'
run file.exr --layer Near,Far --merge -o d.exr $blur --guessed --json j.json
python3 - <<'PYTHON'
import json
import struct
from exr import read
shares = struct.unpack('<2560f', read('d.exr')['Near.guessed'])
said = json.load(open('j.json'))['views'][0]
# The report adds up 2^-24ths, rounded down.
raise SystemExit(abs(sum(shares) / 2560 - said['guessed']) > 1e-6 or not 0 < said['guessed_beyond'] <= said['guessed'])
PYTHON
result "of a layer the channel is beside it, and --json has its mean" $?
contains "$dir/err" "of the picture rests on guesses; overscan of" && ! contains "$dir/err" "a second layer"
result "with a further layer only the border is guessed" $?
run both.exr -o d.exr $blur --guessed
contains "$dir/err" "a second layer would help"
result "and without, what is hidden" $?
good d.exr -o e.exr $blur --guessed --quiet
good both.exr -o f.exr $blur --guessed --quiet
! same d.exr e.exr guessed && same d.exr f.exr guessed && same e.exr e.exr R
result "a channel that is there is replaced" $?
bad 1 "--guessed|layers" both.exr -o o.exr $look --guessed --engine gather

# ---- shots
good bar.####.exr --over wall.####.exr -o o.####.exr --quiet $look
same o.0001.exr b.exr R G B A && ! same o.0002.exr b.exr R
result "each frame has its own further picture" $?
run bar.####.exr --over wall.####.exr -o o.####.exr --resume $look
contains "$dir/err" "0 done, 2 there already"
result "--resume skips what is there" $?
run bar.####.exr --over wall.####.exr -o o.####.exr --resume --guessed $look
contains "$dir/err" "2 done, 0 there already" && grep -q "frame [12]: .* of the picture rests on guesses" "$dir/err" &&
    same o.0001.exr b.exr R G B && grep -q guessed o.0002.exr
result "--guessed in a shot: a sentence, and frames without the channel are made again" $?
run bar.####.exr --over wall.####.exr -o o.####.exr --resume --quiet $look
cp bar2.exr wall.0002.exr
run bar.####.exr --over wall.####.exr -o o.####.exr --resume --log log.jsonl $look
contains "$dir/err" "1 done, 1 there already" && contains log.jsonl '"wall.0002.exr"'
result "--resume sees that a further picture changed, and --log names it" $?
run bar.####.exr --over wall.####.exr -o o.####.exr --dry-run $look
contains "$dir/out" "over wall.0001.exr"
result "--dry-run names them" $?
good bar.####.exr --over wall.exr -o o.####.exr --quiet $look
run bar.####.exr --over wall.####.exr -o o.####.exr --focus center --print-focus
contains "$dir/out" "1,2"
result "--print-focus sees through the first picture" $?

# ---- what is refused
bad 1 "missing.exr|--over" bar.exr --over missing.exr -o o.exr $look
bad 3 "--over|plain.exr|64 x 40|wide.exr|65 x 40" wide.exr --over plain.exr -o o.exr $look
bad 3 "--over|no-depth.exr|depth" bar.exr --over no-depth.exr -o o.exr $look
bad 3 "--peel|garbage.exr" both.exr --peel garbage.exr -o o.exr $look
bad 1 "--over|--peel" bar.exr --over wall.exr --peel peel.exr -o o.exr $look
bad 1 "--peel|3 times" both.exr --peel peel.exr --peel peel.exr --peel peel.exr -o o.exr $look
bad 1 "--over|layers|scatter|gather" bar.exr --over wall.exr -o o.exr $look --engine gather
bad 1 "--merge|--layer" file.exr --merge --layer Near -o o.exr $look
bad 1 "--merge|--peel" file.exr --merge --layer all --peel peel.exr -o o.exr $look
bad 1 "--depth-file|--over" bar.exr --over wall.exr -o o.exr $look --depth-file depth.exr
bad 1 "--grow|--over" bar.exr --over wall.exr -o o.exr $look --grow
bad 1 "wall.exr|--over" bar.exr --over wall.exr -o wall.exr $look
bad 1 "wall.000|--over" bar.####.exr --over wall.####.exr -o wall.####.exr $look
bad 3 "left" stereo.exr --over half-stereo.exr -o o.exr $look
bad 3 "Near|depth" one-depth.exr --layer all --merge -o o.exr $look
}

finish
