#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Failing files: a disk that fills up, a target that may not be written, an input replaced while it is read, two
# processes with one target, hardly any memory or file descriptors, headers that claim too much. Whatever happens, the
# target is the old file or the whole new one, nothing else is left, and a failure is one sentence.
# Usage: fire.sh PROGRAM SOURCE_ROOT.
. "$(dirname "$0")/common.sh"
make_inputs && command -v timeout >/dev/null || { echo "skipped: no python3"; exit 77; }

look='--focus 4 --range 2 --engine gather'
# A picture that takes a while: 512 x 384, half of it blurred.
python3 - <<'PYTHON'
from exr import exr
size = (0, 0, 511, 383)
depth = lambda x, y: 1 + x // 8
exr('a.exr', {'R': lambda x, y: x % 7, 'G': lambda x, y: y % 5, 'B': lambda x, y: 1, 'Z': depth}, window=size)
exr('b.exr', {'R': lambda x, y: y % 9, 'G': lambda x, y: 2, 'B': lambda x, y: x % 3, 'Z': depth}, window=size)
huge = open('plain.exr', 'rb').read()
for name, box in {'square': (0, 0, 65535, 65535), 'wide': (0, 0, 2 ** 30, 0), 'tall': (0, 0, 0, 65535),
                  'moved': (2 ** 31 - 70000, 0, 2 ** 31 - 2, 65535)}.items():
    import struct
    at = huge.index(b'dataWindow\0box2i\0') + 21
    open(name + '.exr', 'wb').write(huge[:at] + struct.pack('<4i', *box) + huge[at + 16:])
PYTHON

# Check that it was refused with one sentence, without a signal, and that no file but the unchanged target is left.
refused() {  # NAME TARGET OLD
    ok=0
    { [ "$status" -ge 1 ] && [ "$status" -le 3 ]; } || { ok=1; echo "exit code $status:"; }
    [ "$(wc -l <"$dir/err")" -eq 1 ] || { ok=1; echo "not one line on stderr:"; }
    if [ -n "$3" ]; then
        cmp -s "$2" "$3" || { ok=1; echo "the target is another:"; }
    elif [ -e "$2" ]; then
        ok=1
        echo "there is a target:"
    fi
    [ -z "$(find . -name '.hyperfocal-*')" ] || { ok=1; echo "a temporary file is left:"; }
    result "$1" $ok
}
limited() {  # LIMIT VALUE ARGUMENTS...
    limit=$1 value=$2
    shift 2
    command="$* (ulimit $limit $value)"
    # shellcheck disable=SC3045
    (ulimit "$limit" "$value" && exec timeout 60 "$program" "$@") >"$dir/out" 2>"$dir/err" </dev/null
    status=$?
}

# ---- a disk that fills up
# shellcheck disable=SC2086
run a.exr -o new.exr $look
cp new.exr a-done.exr
echo old >old
for name in out.exr out.png out.tif out.jpg; do
    # shellcheck disable=SC2086
    limited -f 2 a.exr -o $name $look
    refused "file limit, $name" $name ""
    cp old $name
    # shellcheck disable=SC2086
    limited -f 2 a.exr -o $name $look
    refused "file limit, over an old $name" $name old
    rm -f $name
done
# A file system of 256 kilobytes, where mounting one is allowed.
mkdir disk
cat >"$dir/disk.sh" <<'SH'
mount -t tmpfs -o size=256k none disk || exit 77
echo old >disk/old.exr
for name in new.exr old.exr; do
    "$1" a.exr -o disk/$name --focus 4 --range 2 --engine gather --compression none 2>"$2/err" >"$2/out"
    status=$?
    [ $status -eq 3 ] || { echo "exit code $status for $name"; exit 1; }
    [ "$(wc -l <"$2/err")" -eq 1 ] || { echo "not one line for $name"; exit 1; }
    [ "$(ls -A disk)" = old.exr ] || { echo "left: $(ls -A disk)"; exit 1; }
    [ "$(cat disk/old.exr)" = old ] || { echo "old.exr is another"; exit 1; }
done
# The frame is made, and a message says that its log is not.
head -c 300000 /dev/zero >disk/fill 2>/dev/null
"$1" a.exr -o logged.exr --focus 4 --range 2 --engine gather --log disk/log --quiet 2>"$2/err" >"$2/out"
status=$?
rm -f disk/fill
[ $status -eq 3 ] && [ -s logged.exr ] || { echo "exit code $status with a log"; exit 1; }
[ "$(wc -l <"$2/err")" -eq 1 ] && grep -q -e "--log disk/log" "$2/err" || { echo "not one line for a log"; exit 1; }
SH
unshare -m sh "$dir/disk.sh" "$program" "$dir" >"$dir/disk.out" 2>&1
status=$? command="on a disk of 256 kB"
if [ $status -ne 77 ] && ! grep -q "unshare" "$dir/disk.out"; then
    cat "$dir/disk.out"
    result "a full disk" $status
else
    skip "a full disk: no file system can be mounted"
fi

# ---- a target that may not be written
mkdir locked && cp old locked/out.exr && chmod 555 locked && chmod 444 locked/out.exr
as_user=
[ "$(id -u)" -ne 0 ] || as_user='setpriv --reuid 65534 --regid 65534 --clear-groups'
if [ -z "$as_user" ] || { chmod 755 "$dir" "$dir/work" && $as_user "$program" --version >/dev/null 2>&1; }; then
    for target in locked/new.exr locked/out.exr none/out.exr locked/out.png; do
        command="a.exr -o $target, read-only"
        # shellcheck disable=SC2086
        $as_user "$program" a.exr -o $target $look >"$dir/out" 2>"$dir/err" </dev/null
        status=$?
        if [ $target = locked/out.exr ]; then refused "read-only $target" $target old; else refused "read-only $target" $target ""; fi
    done
else
    skip "read-only targets: cannot become another user"
fi
chmod 755 locked

# ---- an input replaced while it is read
# shellcheck disable=SC2086
run b.exr -o b-done.exr $look
whole=0 broken=0 i=0
cp a.exr in.exr
: >"$dir/go"
(
    while [ -e "$dir/go" ]; do
        cp b.exr next.exr && mv next.exr in.exr
        cp a.exr next.exr && mv next.exr in.exr
    done
) &
writer=$!
while [ $i -lt 25 ]; do
    i=$((i + 1))
    # shellcheck disable=SC2086
    run in.exr -o out.exr $look
    if [ "$status" -eq 0 ] && { cmp -s out.exr a-done.exr || cmp -s out.exr b-done.exr; }; then
        whole=$((whole + 1))
    else
        broken=$((broken + 1))
    fi
    rm -f out.exr
done
rm -f "$dir/go"
wait $writer
status=$broken command="in.exr, renamed over while it is read"
[ "$broken" -eq 0 ] && [ "$whole" -eq 25 ]
result "an input replaced by another" $?
# An input overwritten in place may be a mixture, or short: the result is a picture or a sentence, never a signal.
: >"$dir/go"
(
    while [ -e "$dir/go" ]; do
        cat b.exr >in.exr
        cat a.exr >in.exr
    done
) &
writer=$!
i=0 strange=0 how=0
while [ $i -lt 60 ]; do
    i=$((i + 1))
    # shellcheck disable=SC2086
    run in.exr -o out.exr $look
    ok=0
    [ "$status" -le 3 ] && { [ "$status" -eq 0 ] || [ "$(wc -l <"$dir/err")" -eq 1 ]; } || ok=1
    [ "$status" -eq 0 ] || [ ! -e out.exr ] || ok=1
    [ $ok -eq 0 ] || { strange=$((strange + 1)) how=$status && cp "$dir/err" "$dir/strange"; }
    rm -f out.exr
done
rm -f "$dir/go"
wait $writer
[ $strange -eq 0 ] || cp "$dir/strange" "$dir/err"
status=$how command="in.exr, written over while it is read, $strange of $i times"
[ "$strange" -eq 0 ]
result "an input written over in place" $?

# ---- two processes, one target
i=0 torn=0
while [ $i -lt 12 ]; do
    i=$((i + 1))
    # shellcheck disable=SC2086
    "$program" a.exr -o both.exr $look >/dev/null 2>&1 &
    # shellcheck disable=SC2086
    "$program" b.exr -o both.exr $look >/dev/null 2>&1
    one=$?
    wait $! && [ $one -eq 0 ] && { cmp -s both.exr a-done.exr || cmp -s both.exr b-done.exr; } || torn=$((torn + 1))
done
status=$torn command="two processes on both.exr"
[ "$torn" -eq 0 ] && [ -z "$(find . -name '.hyperfocal-*')" ]
result "two processes, one target" $?

# ---- hardly any file descriptors, hardly any memory
cp old out.exr
for n in 4 5 6 7 8 10 14; do
    # shellcheck disable=SC2086
    limited -n $n a.exr -o out.exr $look
    if [ "$status" -eq 0 ]; then
        cmp -s out.exr a-done.exr
        result "$n file descriptors: the whole picture" $?
        cp old out.exr
    elif [ "$status" -eq 127 ] || [ "$status" -eq 126 ]; then
        skip "$n file descriptors: too few for a program's libraries"
    else
        refused "$n file descriptors" out.exr old
    fi
done
for kilobytes in 20000 40000 60000 80000 100000 140000 200000 400000; do
    # shellcheck disable=SC2086
    limited -v $kilobytes a.exr -o out.exr $look --threads 2
    if [ "$status" -eq 0 ]; then
        cmp -s out.exr a-done.exr
        result "$kilobytes kB: the whole picture" $?
        cp old out.exr
    elif [ "$status" -eq 127 ]; then
        skip "$kilobytes kB: too little for a program's libraries"
    else
        refused "$kilobytes kB" out.exr old
    fi
done

# ---- headers that claim more than the file holds: the memory is the file's, not the claim's
for name in square wide tall moved; do
    # shellcheck disable=SC2086
    limited -v 500000 $name.exr -o out.exr $look
    refused "a header that claims too much: $name" out.exr old
done

finish
