#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Shots through the command: names and frames, which frames are skipped or made again, what a kill leaves behind.
# Usage: batch.sh PROGRAM SOURCE_ROOT. The shot is made of SOURCE_ROOT/images; the beachball shot is taken from
# $HF_SHARED/images when it is there. HF_KILLS: how often to kill (default 8).
. "$(dirname "$0")/../support/check.sh"
program=$(absolute "$1")
source_root=$(absolute "$2")
shared=${HF_SHARED:-/nonexistent}/images
[ -x "$program" ] && [ -d "$source_root/images" ] || { echo "usage: $0 PROGRAM SOURCE_ROOT" >&2; exit 1; }
cd "$dir" || exit 1
unset HYPERFOCAL_ISA SLURM_ARRAY_TASK_ID

explain() {
    echo "hyperfocal $command -> $status"
    sed 's/^/stderr: /' err
}
run() {  # ARGUMENTS...
    command=$*
    "$program" "$@" >out 2>err </dev/null
    status=$?
}
exits() { [ "$status" -eq "$1" ]; }
says() { grep -qF -e "$1" err; }
files() {  # DIRECTORY NAMES: just these
    [ "$(cd "$1" && ls -A | tr '\n' ' ')" = "$2${2:+ }" ]
}
same() {  # DIRECTORY DIRECTORY: every file, bit for bit
    diff -r "$1" "$2" >/dev/null
}

# Six frames, two of each picture, with settings that render quickly.
mkdir in
for i in 1 2 3 4 5 6; do
    case $i in 1 | 4) p=lights ;; 2 | 5) p=fence ;; *) p=foliage ;; esac
    cp "$source_root/images/$p.exr" "in/shot.000$i.exr"
done
quick="--engine gather --focus 5 --range 3 --max-radius 6"
all="shot.0001.exr shot.0002.exr shot.0003.exr shot.0004.exr shot.0005.exr shot.0006.exr"

# Names.
mkdir good a
run in/shot.####.exr -o good/shot.####.exr $quick
check "a shot" exits 0
check "all its frames" files good "$all"
check "what was used is said" says "peak memory"
for pattern in 'shot.#.exr' 'shot.%04d.exr' 'shot.@@@@.exr' 'shot.$F4.exr'; do
    rm -f a/*
    run "in/$pattern" -o "a/$pattern" $quick --threads 1
    check "$pattern: done" exits 0
    check "$pattern: the same bits on one thread" same good a
done
rm -f a/*
run in/shot.0003.exr in/shot.0001.exr -o a/x.%d.exr $quick
check "a list" exits 0
check "a list's names" files a "x.1.exr x.3.exr"
rm -f a/*
run in/shot.####.exr -o a/shot.####.exr $quick --frames 6-1x-2 --memory-limit 0.001
check "one at a time where there is little memory" says "one at a time"
check "backwards" files a "shot.0002.exr shot.0004.exr shot.0006.exr"
check "the limit changes no bit" cmp a/shot.0004.exr good/shot.0004.exr
rm -f a/*
# Two threads share a frame, but a process that decodes or encodes whole frames works on one thread.
run in/shot.####.exr -o a/shot.####.exr $quick --threads 2 --dry-run
check "a frame for every two threads" grep -q ", 1 at a time" out
run in/shot.####.exr -o a/shot.####.exr $quick --threads 2 --dry-run --compression dwaa
check "a frame for every thread where another process encodes it" grep -q ", 2 at a time" out
# The frames after a tiny one are many times its size: when memory is short they wait for each other.
mkdir grow
cp "$source_root/tests/fuzz/corpus/exr/none.exr" grow/g.0001.exr
for i in 2 3 4 5 6 7 8 9; do cp in/shot.0001.exr grow/g.000$i.exr; done
run grow/g.####.exr -o a/g.####.exr $quick --threads 4 --memory-limit 0.1 --log grow/log
check "frames that grow" exits 0
check "frames that grow wait for each other" grep -q '"waited_ms": [0-9]*[1-9]\.' grow/log
# The same with sizes mixed: the peak is at most a tenth over the limit, which one frame at a time keeps within and all at once do
# not. No frame here needs a helper, so the command's own peak is all of it.
cp in/shot.0002.exr grow/g.0004.exr
cp "$source_root/tests/fuzz/corpus/exr/none.exr" grow/g.0005.exr
cp in/shot.0003.exr grow/g.0007.exr
for i in 10 11 12 13 14 15 16; do cp in/shot.0001.exr grow/g.00$i.exr; done
if command -v python3 >/dev/null; then
    for limit in 0.1 0.15; do
        rm -f a/*
        command="a shot within $limit GiB"
        python3 - "$program" $limit >out 2>err <<'PYTHON'
import os, sys
words = [sys.argv[1], 'grow/g.####.exr', '-o', 'a/g.####.exr', '--engine', 'gather', '--focus', '5', '--fstop', '0.4',
         '--focal-length', '50', '--threads', '8', '--memory-limit', sys.argv[2]]
_, status, usage = os.wait4(os.spawnv(os.P_NOWAIT, words[0], words), 0)
peak, limit = usage.ru_maxrss / 1024, float(sys.argv[2]) * 1024
assert status == 0 and peak <= 1.1 * limit, (status, peak, limit)
PYTHON
        status=$?
        check "a shot of mixed sizes within $limit GiB" exits 0
    done
else
    skip "memory of a shot: no python3"
fi
rm -rf a/* grow
run in/shot.####.exr -o a/shot.exr $quick
check "an output without a place" exits 1
check "is refused by name" says "no place for the frame number"
check "before anything is done" files a ""
run in/shot.0001.exr in/shot.0002.exr -o a/shot.exr $quick
check "a list into one file" exits 1
run in/shot.####.exr -o in/shot.####.exr $quick
check "over the input" exits 1
run in/shot.0001.exr ./in/shot.0001.exr -o a/shot.#.exr $quick
check "twice the same" says "would both be written"
run in/none.####.exr -o a/x.####.exr $quick
check "no such shot" exits 1
run in/shot.0001.exr -o a/x.exr --frames 1-3 $quick
check "frames of a single file" exits 1
run in/shot.####.exr -o a/x.####.exr --frames 1-x $quick
check "frames that are none" says "'1-x'"
run in/shot.####.exr -o a/x.####.exr $quick --json
check "what is for one frame" says "--json is for one picture by its own name"
run in/shot.####.exr -o a/x.####.exr $quick --layer Nope
check "a layer that no frame has" exits 1
run in/shot.####.exr -o a/x.####.exr $quick --depth-channel nope
check "a depth channel that no frame has" exits 1
run in/shot.####.exr -o a/x.####.exr $quick --depth-file nope.exr
check "a depth file for all frames that is not there" exits 1
run in/shot.####.exr -o a/x.####.exr $quick --depth-file nope.####.exr
check "depth files that are not there, or not yet" exits 3
run in/shot.####.exr -o none/x.####.exr $quick
check "a directory that is not there" exits 1
run in/shot.####.exr -o a/x.####.exr $quick --dry-run --log log
check "a dry run's log" says "--log log: a dry run makes no frames"
check "is not written" test ! -e log
run in/shot.####.exr -o a/x.####.exr $quick --dry-run
check "a dry run" exits 0
check "says what it would do" grep -q 'in/shot.0006.exr -> a/x.0006.exr' out
check "and what that takes" grep -q 'MiB' out
check "nothing was written so far" files a ""

# Missing and damaged frames.
mkdir holes b
cp in/shot.0001.exr in/shot.0004.exr in/shot.0006.exr holes
run holes/shot.#.exr -o b/shot.#.exr $quick
check "gaps are no failure" exits 0
check "gaps are named" says "3 frames are missing: 2-3, 5"
run holes/shot.#.exr -o b/y.#.exr $quick --frames 7-1x2 --dry-run
check "a dry run looks at a frame that is there" grep -q 'MiB' out
check "frames that were asked for and are not there are named" says "3 frames are missing: 3, 5, 7"
rm -f b/*
head -c 100000 in/shot.0004.exr >holes/shot.0004.exr
run holes/shot.#.exr -o b/shot.#.exr $quick --log log
check "a bad frame" exits 2
check "is named" says "shot.0004.exr"
check "the others go on" files b "shot.0001.exr shot.0006.exr"
run holes/shot.#.exr -o b/y.#.exr $quick --frames 4,6 --stop-on-error --threads 1
check "the first error stops" files b "shot.0001.exr shot.0006.exr"
run holes/shot.#.exr -o b/y.#.exr $quick --frames 2-5
check "none was possible" exits 3
if command -v python3 >/dev/null; then
    check "the log is JSON by line" python3 -c '
import json
lines = [json.loads(l) for l in open("log")]
assert [l["event"] for l in lines] == ["begin", "frame", "frame", "frame", "end"], lines
frames = {l["frame"]: l for l in lines[1:4]}
assert frames[4]["status"] == "failed" and "shot.0004.exr" in frames[4]["error"]
assert frames[6]["status"] == "done" and frames[6]["views"][0]["focus"] == 5 and frames[6]["defocus_ms"] > 0
assert lines[4]["done"] == 2 and lines[4]["failed"] == 1 and lines[4]["peak_memory"] > 1e6
'
else
    skip "the log, without python3"
fi

# Resuming.
rm -f a/*
cp good/* a
run in/shot.####.exr -o a/shot.####.exr $quick --resume
check "nothing left to do" says "0 done, 6 there already"
rm a/shot.0002.exr
head -c 300000 good/shot.0003.exr >a/shot.0003.exr
cp in/shot.0005.exr a/shot.0005.exr
: >a/shot.0006.exr
: >"a/.hyperfocal-elsewhere-1-0.exr"
: >"a/.hyperfocal-elsewhere-2-0.exr"
: >"a/.hyperfocal-elsewhere-3-0.exr"
touch -d '2 hours ago' a/.hyperfocal-elsewhere-[23]-0.exr
# Lock the file as a writer does.
flock a/.hyperfocal-elsewhere-3-0.exr sleep 30 &
alive=$!
sleep 0.2
run in/shot.####.exr -o a/shot.####.exr $quick --resume
check "what is missing, cut off, empty or not ours is made" says "4 done, 2 there already"
check "what dead processes left is removed" says "files left by killed processes: 1 removed"
check "what living ones may still write is kept" test -e a/.hyperfocal-elsewhere-1-0.exr -a \
    -e a/.hyperfocal-elsewhere-3-0.exr
kill $alive 2>/dev/null
rm -f a/.hyper*
check "all as if undisturbed" same good a
run in/shot.####.exr -o a/shot.####.exr $quick --range 4 --resume
check "other settings: all again" says "6 done, 0 there already"
run in/shot.####.exr -o a/shot.####.exr $quick --range 4 --resume --threads 1 --log log2
check "threads are no such setting" says "0 done, 6 there already"
touch -d '2001-01-01' in/shot.0002.exr
run in/shot.####.exr -o a/shot.####.exr $quick --range 4 --resume
check "another input: that one again" says "1 done, 5 there already"
run in/shot.####.exr -o a/shot.####.tif $quick --resume
check "formats that keep no record" says "--resume needs an EXR OUTPUT"
rm -f good/* a/*
run in/shot.####.exr -o good/shot.####.exr $quick

# Signals. The shot takes long enough for a signal to arrive while it is rendered.
list="in/shot.0001.exr"
"$program" in/shot.####.exr -o a/shot.####.exr $quick --threads 1 >out 2>err &
pid=$!
while [ ! -e a/shot.0001.exr ] && kill -0 $pid 2>/dev/null; do sleep 0.02; done
kill -TERM $pid 2>/dev/null
wait $pid
status=$? command="terminated"
if says "6 done"; then
    skip "SIGTERM: the shot was done too soon"
else
    check "SIGTERM: some are missing" exits 2
    check "how to go on is said" says "with --resume"
    check "nothing half-written" sh -c '! ls a/.hyper* 2>/dev/null'
fi
run in/shot.####.exr -o a/shot.####.exr $quick --resume
check "after SIGTERM: all there" same good a

# The second signal does not wait for the frames being rendered, which are slowed down here.
slow="--quality best --focus 5 --range .1 --max-radius 400 --threads 2 --compression none"
rm -f a/*
for strike in 1 2 3; do
    "$program" in/shot.####.exr -o a/shot.####.exr $slow >out 2>err &
    pid=$!
    i=0
    while ! ls -A a | grep -q "$([ $strike = 3 ] && echo hyper || echo shot)" && kill -0 $pid 2>/dev/null &&
        [ $i -lt 500 ]; do sleep 0.02; i=$((i + 1)); done
    kill -TERM $pid 2>/dev/null
    sleep 0.4
    kill -TERM $pid 2>/dev/null
    wait $pid
    status=$? command="terminated twice, strike $strike"
    if [ $status -eq 143 ]; then
        check "a second SIGTERM: said" says "stopped; the same command with --resume"
    elif says "6 done"; then
        skip "strike $strike: the shot was done before the signal"
    else
        check "SIGTERM: as the first says" says "finishing the frames in work"
    fi
    check "a second SIGTERM: nothing half-written" sh -c '! ls a/.hyper* 2>/dev/null'
    rm -f a/*
done

kills=${HF_KILLS:-8}
i=0
rm -f a/*
while [ $i -lt "$kills" ]; do
    i=$((i + 1))
    # Start over now and then; otherwise all frames would be done and nothing left to kill.
    [ $((i % 3)) -eq 1 ] && rm -f a/shot.*
    "$program" in/shot.####.exr -o a/shot.####.exr $quick --resume >/dev/null 2>&1 &
    pid=$!
    sleep "$(awk -v s="$i$$" 'BEGIN { srand(s); printf "%.2f", 0.03 + rand() * 0.8 }')"
    kill -KILL $pid 2>/dev/null
    wait $pid 2>/dev/null
done
run in/shot.####.exr -o a/shot.####.exr $quick --resume
check "killed $kills times: done" exits 0
check "killed $kills times: the same bits, no stray file" same good a

# Two processes on the same frames.
rm -f a/*
"$program" in/shot.####.exr -o a/shot.####.exr $quick >/dev/null 2>&1 &
pid=$!
run in/shot.####.exr -o a/shot.####.exr $quick
wait $pid
check "two at once: done" exits 0
check "two at once: the same bits" same good a

# Parts of a shot.
rm -f a/*
for task in 3 5 7 9; do
    SLURM_ARRAY_TASK_ID=$task SLURM_ARRAY_TASK_MIN=3 SLURM_ARRAY_TASK_MAX=9 SLURM_ARRAY_TASK_STEP=2 \
        "$program" in/shot.####.exr -o a/shot.####.exr $quick --frames 1-6 --chunk auto >out 2>err || status=9
done
check "tasks of an array make the whole" same good a
rm -f a/*
run in/shot.####.exr -o a/shot.####.exr $quick --chunk 2/3
check "a part" files a "shot.0003.exr shot.0004.exr"
run in/shot.####.exr -o a/shot.####.exr $quick --frames 1-2 --chunk 2/5
check "a part of nothing" exits 0
run in/shot.####.exr -o a/shot.####.exr $quick --chunk auto
check "no array" exits 1
run in/shot.####.exr -o a/shot.####.exr $quick --chunk 4/3
check "no such part" exits 1

# Focus over a shot.
printf 'frame,focus,range\n1,4,2\n5,6,\n' >keys.csv
run in/shot.####.exr --print-focus --keys keys.csv --frames 1-6
check "keys" exits 0
check "keys between and after" test "$(tr '\n' ' ' <out)" = "frame,focus 1,4 2,4.5 3,5 4,5.5 5,6 6,6 "
rm -f a/*
run in/shot.####.exr -o a/shot.####.exr --engine gather --focus 5 --strength 1 --max-radius 6 --keys keys.csv --frames 2 --log keylog
check "keys in the log" grep -q '"focus": 4.5' keylog
printf 'frame,focus\n1,4\n1,5\n' >twice.csv
run in/shot.####.exr --print-focus --keys twice.csv
check "keys that are none" exits 1
run in/shot.####.exr --print-focus --keys keys.csv --focus-smooth 3
check "smoothing of keys" says "--focus-smooth 3 is of no use: --keys keys.csv has the focus itself"
run in/shot.####.exr --print-focus --focus center --focus-smooth 3 --focus-per-view
check "smoothing of each view" says "--focus-smooth and --focus-per-view cannot be given together"
run in/shot.####.exr --print-focus --focus center --focus-smooth 0
check "focus of the pictures" exits 0
cp out raw
run in/shot.####.exr --print-focus --focus center --focus-smooth 2
cp out smooth
# Triangular weights 1 2 3 2 1 of inverse distances, worked out from the raw ones; both are printed with six digits.
check "a focus that follows" awk -F, 'FNR == 1 { file++; next }
    file == 1 { raw[$1] = $2 } file == 2 { soft[$1] = $2 }
    END { for (f = 1; f <= 6; f++) { s = w = 0
            for (k = f - 2; k <= f + 2; k++) if (k in raw) { d = k < f ? f - k : k - f; s += (3 - d) / raw[k]; w += 3 - d }
            e = soft[f] * s / w - 1; if (e < 0) e = -e; if (e > 2e-5 || !(f in soft)) exit 1 } }' raw smooth
run in/shot.####.exr --print-focus --focus center --focus-smooth 2 --frames 3-4
check "does not depend on the part" test "$(sed 1d out | tr '\n' ' ')" = "$(sed -n '4,5p' smooth | tr '\n' ' ')"

# What an output keeps of its input.
if command -v python3 >/dev/null; then
    cat >header.py <<'P'
# The attributes of all parts of an EXR file, except those that say which program made it.
import struct, sys
def attributes(path):
    data = open(path, "rb").read()
    multipart = struct.unpack("<I", data[4:8])[0] & 0x1000
    at, parts = 8, []
    while True:
        part = []
        while data[at]:
            name, kind, _ = data[at:at + 600].split(b"\0", 2)
            at += len(name) + len(kind) + 2
            size = struct.unpack("<I", data[at:at + 4])[0]
            if not name.startswith(b"hyperfocal"):
                part.append((name, kind, data[at + 4:at + 4 + size]))
            at += 4 + size
        at += 1
        parts.append(part)
        if not multipart or not data[at]:
            return parts
a, b = map(attributes, sys.argv[1:3])
sys.exit(a != b)
P
    for f in 1 2 3; do
        check "header of frame $f" python3 header.py "in/shot.000$f.exr" "good/shot.000$f.exr"
    done
    check "what made it can be read" grep -qa -e '--engine gather --focus 5' good/shot.0001.exr
else
    skip "headers, without python3"
fi
kept() {  # FILE FILE CHANNEL: the same samples
    oiiotool "$1" --ch "$3" "$2" --ch "$3" --fail 0 --hardfail 0 --diff
}
if command -v oiiotool >/dev/null; then
    check "depth is kept" kept in/shot.0001.exr good/shot.0001.exr Z
else
    skip "channels, without oiiotool"
fi

# Rendering a finished shot again: the new record replaces the old one.
rm -f a/*
run good/shot.####.exr -o a/shot.####.exr $quick --frames 1 --range 2
check "one record" test "$(grep -ao hyperfocalHash a/shot.0001.exr | wc -l)" = 1
check "of what was done last" grep -qa -e '--range 3 --max-radius 6 --range 2' a/shot.0001.exr

# Views in separate files, with depth in separate files.
mkdir left right depth
for i in 1 2; do
    cp "in/shot.000$i.exr" "left/l.0$i.exr"
    cp "in/shot.000$i.exr" "right/r.0$i.exr"
    cp "in/shot.000$i.exr" "depth/d.$i.exr"
done
mkdir v
run %V/%v.##.exr -o v/%V.##.exr --views left,right $quick
check "views as files" files v "left.01.exr left.02.exr right.01.exr right.02.exr"
run %V/%v.##.exr -o v/x.##.exr --views left,right $quick
check "an output without a place for the view" exits 1
run %V/%v.##.exr -o v/%V.##.exr $quick
check "no names for the views" says "--views"
run in/shot.####.exr -o v/d.####.exr --depth-file depth/d.#.exr --frames 1-2 $quick
check "depth of its own" exits 0
check "depth of its own: the same picture" sh -c '! command -v oiiotool ||
    oiiotool v/d.0002.exr good/shot.0002.exr --fail 0 --hardfail 0 --diff'

# A time budget acts from frame to frame. This one cannot be met, so cheaper settings are chosen and named.
rm -f a/*
run in/shot.####.exr -o a/shot.####.exr --engine scatter --focus 5 --range 3 --max-radius 6 --budget-ms 0.001
check "a budget" exits 0
check "says what it chose" sh -c 'grep -q "for the budget --engine" err && grep -q "frames at step" err'
check "says that it is missed" says "--budget-ms 0.001: 6 frames took longer"
run in/shot.####.exr -o a/shot.####.exr --engine gaussian --resolution quarter --iterations 1 --focus 5 --range 3 \
    --budget-ms 0.001 --log log
check "a budget that nothing meets" says "6 frames took longer, and nothing cheaper blurs as far as is asked for"
check "is told once by the library" test "$(grep -c -e '--budget-ms is 0.001, which frames miss' err)" = 1
check "is in the log" sh -c 'grep -q "\"budget_missed\": true" log && grep -q "\"budget_missed\": 6" log'
rm -f log

# Frames as Blender writes them.
if [ -d "$shared/../blender" ]; then
    mkdir blender blended
    for f in m.0002 stereo.0001 bcrop.0001; do
        cp "$shared/../blender/$f.exr" "blender/${f%%.*}.0001.exr"
        cp "$shared/../blender/$f.exr" "blender/${f%%.*}.0002.exr"
        run "blender/${f%%.*}.#.exr" -o "blended/${f%%.*}.#.exr" --engine gather --focus 5 --fstop .8 --focal-length 50
        check "Blender's $f" exits 0
        command -v python3 >/dev/null &&
            check "Blender's $f: header" python3 header.py "blender/${f%%.*}.0002.exr" "blended/${f%%.*}.0002.exr"
    done
    command -v oiiotool >/dev/null && check "Blender's depth is kept" kept blender/stereo.0002.exr \
        blended/stereo.0002.exr ViewLayer.Depth.right.Z
else
    skip "Blender's frames: HF_SHARED does not name them"
fi

# A real stereo shot.
if [ -d "$shared/beachball" ]; then
    mkdir ball
    run "$shared/beachball/singlepart.#.exr" -o ball/s.#.exr --engine gather --focus center --log ballog
    check "beachball" exits 0
    run "$shared/beachball/multipart.#.exr" -o ball/m.#.exr --engine gather --focus center
    check "beachball, multi-part" exits 0
    run "$shared/beachball/multipart.0001.exr" --engine gather --focus center --dry-run
    check "a dry run names the parts" grep -q ' of part ' out
    run "$shared/beachball/multipart.0001.exr" -o ball.exr --engine gather --focus center --verbose
    check "and so does the summary" sh -c 'grep -q "rgba_left with depth Z of part depth_left," err &&
        grep -q "rgba_right with depth Z of part depth_right," err'
    check "its frames" files ball "m.0001.exr m.0002.exr s.0001.exr s.0002.exr s.0003.exr s.0004.exr"
    if command -v python3 >/dev/null; then
        for f in 1 2 3 4; do
            check "beachball header $f" python3 header.py "$shared/beachball/singlepart.000$f.exr" "ball/s.000$f.exr"
        done
        check "multi-part header" python3 header.py "$shared/beachball/multipart.0002.exr" ball/m.0002.exr
        check "both eyes share one focus, which does not jump" python3 -c '
import json
f = [[v["focus"] for v in l["views"]] for l in map(json.loads, open("ballog")) if l["event"] == "frame"]
assert len(f) == 4 and all(len(v) == 2 and v[0] == v[1] > 0 for v in f), f
assert max(v[0] for v in f) / min(v[0] for v in f) < 1.02, f
'
    fi
    if command -v oiiotool >/dev/null; then
        for f in 2 4; do
            for c in Z left.Z disparityL.x forward.left.u; do
                check "beachball $f: $c" kept "$shared/beachball/singlepart.000$f.exr" "ball/s.000$f.exr" $c
            done
        done
    fi
else
    skip "beachball: HF_SHARED does not name it"
fi

finish
