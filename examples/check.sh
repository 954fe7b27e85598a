#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Check that an example renders its frames, says how long each took, and leaves a picture in which something is blurred.
set -u
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$1" 320x180 8 "$work/last.ppm" > "$work/log" || { echo "$1 failed"; cat "$work/log"; echo "0 passed, 1 failed"; exit 1; }
passed=0
failed=0
check()
{
    if [ "$2" = "$3" ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "$1: got $2, expected $3"
    fi
}
check "lines of frame times" "$(grep -c '^frame .* ms' "$work/log")" 8
check "a frame with blur" "$(grep -c 'blurred 0 %' "$work/log")" 0
check "the picture's head" "$(head -c 15 "$work/last.ppm" | tr '\n' ' ')" "P6 320 180 255 "
check "the picture's size" "$(wc -c < "$work/last.ppm" | tr -d ' ')" $((320 * 180 * 3 + 15))
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
