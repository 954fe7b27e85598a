#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# No file is lost and no wrong one written: outputs that are other frames' inputs, closed descriptors, pipes that break,
# machines that share a folder, damage that --resume must see.
# Usage: loss.sh PROGRAM SOURCE_ROOT
. "$(dirname "$0")/common.sh"
make_inputs && command -v timeout >/dev/null || { echo "skipped: no python3"; exit 77; }

look='--focus 4 --range 2 --engine gather --max-radius 4 --threads 2'
helper=$(dirname "$program")/../io/hyperfocal-oiio
has_helper=
[ -x "$helper" ] && has_helper=1

# ---- one frame's output is another's input
mkdir s d other
for i in 1 2 3 11 12 19; do cp plain.exr s/s.$i.exr; done
for i in 1 2 3; do cp plain.exr d/d.$i.exr; done
mkdir reversed && for i in 3 2 1; do cp plain.exr reversed/d.$i.exr; done
ln -s s linked
ln -s ../s/s.3.exr other/o.2.exr
ln s/s.3.exr other/h.2.exr
# shellcheck disable=SC2086
{
    bad 1 "s/s.1.exr|s/s.11.exr|another frame" 's/s.#.exr' -o 's/s.1#.exr' $look
    bad 1 "s/s.1.exr|linked/s.11.exr|another frame" 's/s.#.exr' -o 'linked/s.1#.exr' $look
    bad 1 "s/s.2.exr|other/o.2.exr|s/s.3.exr" 's/s.#.exr' -o 'other/o.#.exr' $look
    bad 1 "s/s.2.exr|other/h.2.exr|s/s.3.exr" 's/s.#.exr' -o 'other/h.#.exr' $look
    bad 1 "s/s.1.exr|d/d.1.exr|--depth-file|of s/s.1.exr" s/s.1.exr s/s.2.exr -o 'd/d.@.exr' $look --depth-file 'd/../d/d.@.exr'
    # The first frame is named, whichever file has the smaller inode.
    bad 1 "s/s.1.exr|reversed/d.1.exr|of s/s.1.exr" s/s.1.exr s/s.2.exr -o 'reversed/d.@.exr' $look --depth-file 'reversed/d.@.exr'
    bad 1 "s/s.1.exr|d/d.11.exr|--depth-file|of s/s.11.exr" 's/s.#.exr' -o 'd/d.1#.exr' $look --depth-file 'd/d.#.exr' \
        --frames 1,11
    bad 1 "s/s.1.exr|s/s.11.exr" 's/s.#.exr' -o 's/s.1#.exr' $look --chunk 1/3 --frames 1,2,11
    # An input that does not exist yet, but is another frame's output.
    bad 1 "s/s.4.exr|s/s.14.exr" 's/s.#.exr' -o 's/s.1#.exr' $look --frames 4,14
    bad 1 "--log|s/s.3.exr|INPUT" 's/s.#.exr' -o 'other/n.#.exr' $look --log other/../s/s.3.exr
}
# shellcheck disable=SC2086
run s/s.1.exr s/s.2.exr -o 's/n.#.exr' $look
[ "$status" -eq 0 ] && [ -s s/n.2.exr ]
result "other names in the same folder" $?
python3 - <<'PYTHON'
import os
from exr import exr
os.mkdir('m')
exr('m/f.0.exr', {n: lambda x, y: 1 + x for n in 'RGBZ'}, window=(0, 0, 3, 3))
for i in range(1, 10000):
    os.link('m/f.0.exr', 'm/f.%d.exr' % i) if i % 5000 else None
PYTHON
# Count system calls, not time: a few for each of 10,000 frames, which are all links to one file.
if command -v strace >/dev/null; then
    command="10,000 frames" status=0
    strace -f -c -o "$dir/calls" "$program" 'm/f.#.exr' -o 'none/f.1#.exr' --dry-run >"$dir/out" 2>"$dir/err"
    calls=$(awk '/total$/ { print $(NF > 4 ? 4 : 3) }' "$dir/calls")
    [ -n "$calls" ] && [ "$calls" -lt 400000 ]
    result "10,000 frames are compared by few calls: $calls" $?
fi
rm -rf s d other linked m

# ---- closed standard descriptors
# shellcheck disable=SC2086
run plain.exr -o good.exr $look
mkdir in out
for i in $(seq 1 2 79); do cp plain.exr in/f.$i.exr; done
# shellcheck disable=SC2086
run 'in/f.#.exr' -o 'out/f.#.exr' $look
mv out whole
# Every second frame is missing, which is said while others are written.
for closed in '<&- >&- 2>&-' '>&- 2>&-' '2>&-' '<&-'; do
    command="with $closed"
    mkdir out
    # shellcheck disable=SC2086
    (eval "exec $closed"; exec "$program" 'in/f.#.exr' -o 'out/f.#.exr' --frames 1-80 $look --threads 8) 2>/dev/null
    status=$?
    [ $status -eq 2 ] && diff -r whole out >/dev/null
    result "a shot with $closed" $?
    rm -rf out
done
"$program" --help >&- 2>/dev/null
[ $? -eq 3 ]
result "help to a closed output is an error" $?

# ---- pipes that break
mkdir out
# shellcheck disable=SC2086
{ "$program" 'in/f.#.exr' -o 'out/f.#.exr' $look --threads 1 --frames 1-7x2; echo $? >"$dir/code"; } 2>&1 >/dev/null | true
sleep 0.1
status=$(cat "$dir/code") command="a shot whose reader went"
[ "$status" -eq 0 ] && cmp -s whole/f.7.exr out/f.7.exr && [ -z "$(ls -A out | grep hyper)" ]
result "a shot goes on when nobody reads its messages" $?
rm -rf out

# ---- the log
mkdir out
long=$(printf '%0200d' 0)
for i in 1 2 3 4 5; do mkdir "in/$long$i" && cp plain.exr "in/$long$i/f.1.exr"; done
deep=in/$long
for i in $(seq 1 13); do deep=$deep/$long; done
mkdir -p "$deep" out/"$long" && cp plain.exr "$deep/f.1.exr"
# shellcheck disable=SC2086
if command -v strace >/dev/null; then
    strace -f -e trace=write,writev -o "$dir/calls" "$program" "$deep/f.#.exr" -o 'out/f.#.exr' $look --log log \
        2>"$dir/err" >"$dir/out"
    command="a log of long lines" status=$?
    lines=$(wc -l <log)
    [ "$status" -eq 0 ] && [ "$(awk 'NR == 1 { print (length > 4096) }' log)" = 1 ] &&
        [ "$(grep -cF '"{\"time' "$dir/calls")" = "$lines" ] &&
        [ "$(grep -c "= $(awk 'NR == 1 { print length + 1 }' log)\$" "$dir/calls")" -ge 1 ]
    result "a line of the log is one write, whatever its length" $?
    rm -f log
fi
for p in 1 2 3 4; do
    mkdir out/$p
    # shellcheck disable=SC2086
    (for n in 1 2 3; do "$program" "$deep/f.#.exr" -o "out/$p/f.#.exr" $look --log log --quiet; done) 2>/dev/null &
done
wait
status=0 command="four processes with one log"
python3 -c '
import json
lines = [json.loads(l) for l in open("log")]
assert len(lines) == 36 and sum(l["event"] == "frame" for l in lines) == 12, len(lines)'
result "four processes with one log: every line is whole" $?
rm -rf out log "in/$long"*

# ---- names with control characters
mkdir out
python3 -c '
import shutil
for i in "12": shutil.copy("plain.exr", "in/\x1b[31m\x07." + i + ".exr"); shutil.copy("plain.exr", "in/\u009b31m." + i + ".exr")'
for name in "$(printf 'in/\033[31m\007.#.exr')" "$(printf 'in/\302\23331m.#.exr')"; do
    # shellcheck disable=SC2086
    run "$name" -o "$(echo "$name" | sed 's/^in/out/')" $look
    [ "$status" -eq 0 ] && ! LC_ALL=C grep -q "$(printf '[\033\007]\|\302\233')" "$dir/err"
    result "progress shows no control characters" $?
    # shellcheck disable=SC2086
    run "$name" -o "$(echo "$name" | sed 's/^in/out/')" $look --dry-run
    [ "$status" -eq 0 ] && ! LC_ALL=C grep -q "$(printf '[\033\007]\|\302\233')" "$dir/out"
    result "nor does a dry run" $?
    command="a bar, $name"
    # shellcheck disable=SC2086
    command -v script >/dev/null &&
        script -qec "'$program' '$name' -o 'out/x.#.exr' $look" /dev/null </dev/null >"$dir/out" 2>/dev/null &&
        { ! LC_ALL=C grep -q "$(printf '\033\\[31m\|\007\|\302\233')" "$dir/out"; result "nor the bar" $?; }
done
rm -rf out in

# ---- two machines of one long name, which see nothing of each other's processes
machine() {  # COMMANDS
    unshare -u -p -f --mount-proc sh -c "hostname $(printf '%064d' 7) && $1" "$program"
}
if machine true 2>/dev/null; then
    mkdir in out
    for i in $(seq 1001 2000); do ln plain.exr in/f.$i.exr 2>/dev/null || cp plain.exr in/f.$i.exr; done
    command="1,000 frames while another machine removes strays"
    # shellcheck disable=SC2016
    machine 'for i in 1 2 3 4 5 6 7 8 9; do /bin/true; done
        "$0" "in/f.#.exr" -o "out/f.#.exr" --focus 4 --range 2 --engine gather --max-radius 4 --resume --quiet; exit' \
        >"$dir/out" 2>"$dir/err" &
    busy=$!
    others=0
    while kill -0 $busy 2>/dev/null; do
        machine '"$0" in/f.1001.exr -o out/x.exr --focus 4 --range 2 --engine gather --resume --quiet; exit' 2>/dev/null
        others=$((others + 1))
    done
    wait $busy
    status=$?
    [ $status -eq 0 ] && [ ! -s "$dir/err" ] && [ "$(ls out | wc -l)" = 1001 ] && [ -z "$(ls -A out | grep hyper)" ]
    result "1,000 frames, and $others times another machine: none is lost" $?
    rm -rf in out
else
    skip "two machines: no name spaces can be made"
fi

# ---- damage that --resume must see
mkdir in good out
python3 - <<'PYTHON'
from exr import exr
for i in range(1, 7):
    exr('in/f.%d.exr' % i, {n: lambda x, y: (x * y * i) % 7 + 1 for n in 'RGBZ'}, window=(0, 0, 299, 199))
PYTHON
for compression in none zip; do
    # shellcheck disable=SC2086
    run 'in/f.#.exr' -o 'good/f.#.exr' $look --compression $compression
    cp good/* out
    # shellcheck disable=SC2086
    run 'in/f.#.exr' -o 'out/f.#.exr' $look --compression $compression --resume
    contains "$dir/err" "0 done, 6 there already"
    result "whole files are whole, $compression" $?
    for damage in tail block append header table leader bits nosum; do
        for seed in 1 2 3; do
            python3 - $damage $seed <<'PYTHON'
import random, sys
from exr import header
kind = sys.argv[1]
random.seed(kind + sys.argv[2])
path = 'out/f.%d.exr' % random.randint(1, 6)
end = header(path)[2] + 1
data = bytearray(open(path, 'rb').read())
chunk = int.from_bytes(data[end:end + 8], 'little')
at = random.randrange(chunk, len(data) - 5000)
if kind == 'tail':
    data[at:] = bytes(len(data) - at)
elif kind == 'block':
    data[at:at + 4096] = bytes(4096)
elif kind == 'append':
    data += b'x' * random.randint(1, 5000)
elif kind == 'nosum':
    data = data.replace(b'hyperfocalSum', b'anotherString')
else:
    low, high = {'header': (8, end), 'table': (end, chunk), 'leader': (chunk, chunk + 4), 'bits': (chunk, len(data))}[kind]
    data[random.randrange(low, high)] ^= 1 << random.randrange(8)
open(path, 'wb').write(data)
PYTHON
            # shellcheck disable=SC2086
            run 'in/f.#.exr' -o 'out/f.#.exr' $look --compression $compression --resume
            [ "$status" -eq 0 ] && contains "$dir/err" "1 done, 5 there already" && diff -r good out >/dev/null
            result "$damage $seed, $compression: that frame is made again" $?
        done
    done
    rm -f out/* good/*
done
# Another picture of the same size and time, uncompressed, so that even the header is the same.
# shellcheck disable=SC2086
run 'in/f.#.exr' -o 'out/f.#.exr' $look --resume
touch -r in/f.2.exr "$dir/time" && cp in/f.3.exr in/f.2.exr && touch -r "$dir/time" in/f.2.exr
# shellcheck disable=SC2086
run 'in/f.#.exr' -o 'out/f.#.exr' $look --resume
contains "$dir/err" "1 done, 5 there already"
result "an input with the size and the time of the old one is another" $?
# A layer of several, and what is made from a photograph.
# shellcheck disable=SC2086
for i in 1 2; do run layers.exr -o out/l.exr $look --layer Foreground --resume; done
contains "$dir/err" "0 done, 1 there already"
result "a layer of several is there already" $?
if [ -n "$has_helper" ]; then
    for i in 1 2 3; do
        [ $i -lt 3 ] || printf x >>out/p.exr
        run photo.png -o out/p.exr --depth-file map8.png --depth-type normalized --near 1 --far 6 --focus 2 --range 2 \
            --resume
        contains "$dir/err" "$((i % 2)) done, $(((i + 1) % 2)) there already"
        result "a photograph's EXR, $i" $?
    done
fi
rm -rf in good out

# ---- what never ends
for list in 1-100000000 1-99999999 1-99999999999999999999 1-99999999y2 1-1000001:1000000; do
    case $list in 1-99999999y2 | 1-99999999 | 1-1000001*) words="more than 1000000 frames" ;; *) words="numbered from" ;; esac
    bad 1 "--frames|$list|$words" 'in/f.#.exr' -o 'o.#.exr' --frames $list
done
run 'none/f.#.exr' -o 'o.#.exr' --frames 1-99999999y1,1-99999999y1,1-99999999y1,1-99999999y1
[ "$status" -eq 1 ] && contains "$dir/err" "has no frame"
result "frames that are none, four times" $?
command="--keys /dev/zero"
# shellcheck disable=SC3045
(ulimit -v 500000 && exec timeout 20 "$program" plain.exr -o o.exr --keys /dev/zero) >"$dir/out" 2>"$dir/err"
status=$?
[ "$status" -eq 1 ] && contains "$dir/err" "--keys /dev/zero, line 1: a zero byte"
result "--keys /dev/zero" $?
head -c 1000000 /dev/zero | tr '\0' x >long.csv
bad 1 "--keys long.csv|line 1|longer than" plain.exr -o o.exr --keys long.csv
rm -f long.csv

# ---- the helper
if [ -n "$has_helper" ]; then
    # A program of its own, whose helper cannot start and later can.
    mkdir bin && cp "$program" bin/hyperfocal && echo '#!/nonexistent' >bin/hyperfocal-oiio && chmod 755 bin/hyperfocal-oiio
    command="-o o.png, with a helper that cannot start"
    LD_LIBRARY_PATH=$(dirname "$program")/../../ bin/hyperfocal plain.exr -o o.png --focus 4 >"$dir/out" 2>"$dir/err"
    status=$?
    [ "$status" -eq 3 ] && contains "$dir/err" "cannot start hyperfocal-oiio"
    result "a helper that cannot start is worth another try" $?
    # One that is killed is started again, and the dead one does not stay.
    mkdir in out
    for i in 1 2 3 4 5 6 7 8 9 10 11 12; do cp photo.png in/p.$i.png; done
    cat >"$dir/kill.py" <<'PYTHON'
import os, subprocess, sys, time
def children(pid):
    found = []
    for p in filter(str.isdigit, os.listdir('/proc')):
        try:
            stat = open('/proc/%s/stat' % p).read().rsplit(')', 1)
            name, fields = stat[0].split('(', 1)[1], stat[1].split()
        except OSError:
            continue
        if int(fields[1]) == pid:
            found.append((int(p), name, fields[0]))
    return found
p = subprocess.Popen(sys.argv[1:], stderr=subprocess.PIPE)
killed, most, made = 0, 0, 0
while p.poll() is None:
    own = children(p.pid)
    most = max(most, sum(c[2] == 'Z' for c in own))
    # Not while it starts: a helper that does not answer fails the frame that asked for it.
    if killed < 3 and len(os.listdir('out')) > made:
        made = len(os.listdir('out'))
        for c in own:
            if c[1].startswith('hyperfocal-oiio') and c[2] != 'Z':
                os.kill(c[0], 9)
                killed += 1
print('%d killed, %d dead at once, exit code %d' % (killed, most, p.returncode))
# One is dead until the next file needs it.
sys.exit(not (killed >= 2 and most <= 1 and len(os.listdir('out')) == 12))
PYTHON
    # shellcheck disable=SC2086
    python3 "$dir/kill.py" "$program" 'in/p.#.png' -o 'out/p.#.png' --depth-file map8.png --depth-type normalized \
        --near 1 --far 6 --focus 2 --range 2 --threads 1 --engine layers >"$dir/out" 2>"$dir/err"
    status=$? command="killed helpers: $(cat "$dir/out")"
    result "$command" $status
    rm -rf in out bin
else
    skip "the helper: built without OpenImageIO"
fi

finish
