#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Damaged EXR files: tables of chunks, chunks, channels, attributes, windows, tiles, parts, kinds, bombs, ends. The
# command makes a readable picture of each, or prints one sentence. No file of a few kB takes 2 GiB or 10 seconds of
# processor time.
# Usage: damaged.sh PROGRAM SOURCE_ROOT.
. "$(dirname "$0")/common.sh"
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }

mkdir in && python3 "$source_root/tests/cli/damaged.py" in || exit 1
try() {  # INPUT OUTPUT
    command="$1 -o $2 (ulimit -v 2097152 -t 10)"
    # shellcheck disable=SC3045
    (ulimit -v 2097152 && ulimit -t 10 && exec "$program" "$1" -o "$2" --focus 4 --range 2 --max-radius 6 --engine gather \
        --threads 2) >"$dir/out" 2>"$dir/err" </dev/null
    status=$?
}
# Files that are valid, or that all readers accept; the others must be refused.
accepted='whole longer tiles tiles-random parts parts-one-name order-turned display-one display-pole display-square
display-strip attributes-many long-name longest-name long-type no-type preview preview-negative views-many views-cut
views-negative string-empty chromaticities keycode flags400 channels-open channels-unsorted preview-rle
chromaticities-rle misfits-rle'
# Of these, OpenEXR's own library reads the pictures that are made, though not all inputs.
mended='preview preview-negative views-cut views-negative chromaticities keycode preview-rle chromaticities-rle misfits-rle'
for input in in/*.exr; do
    name=${input#in/}
    name=${name%.exr}
    try "$input" out.exr
    ok=0
    if [ "$status" -eq 0 ]; then
        try out.exr again.exr
        [ "$status" -eq 0 ] || { ok=1; echo "what was made of it cannot be read:"; }
        for word in $(command -v iinfo >/dev/null && echo "$mended"); do
            [ "$word" != "$name" ] || iinfo out.exr >/dev/null 2>&1 || { ok=1; echo "OpenEXR cannot read it:"; }
        done
    else
        [ "$status" -eq 3 ] || { ok=1; echo "exit code $status:"; }
        [ "$(wc -l <"$dir/err")" -eq 1 ] || { ok=1; echo "not one line on stderr:"; }
        [ ! -e out.exr ] || { ok=1; echo "there is a target:"; }
        for word in $accepted; do
            [ "$word" != "$name" ] || { ok=1; echo "refused:"; }
        done
    fi
    # shellcheck disable=SC2126
    [ "$(LC_ALL=C tr -d '[:print:]\n' <"$dir/err" | wc -c)" -eq 0 ] || { ok=1; echo "not all of it can be printed:"; }
    rm -f out.exr again.exr
    result "damaged: $name" $ok
done
[ -z "$(find . -name '.hyperfocal-*')" ]
result "damaged: nothing is left" $?
finish
