#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# README's blocks, pasted as they stand: each command runs, in a folder that has of the repository only the images and the
# build's programs, and the program in C is compiled, linked and run.
# Usage: readme.sh PROGRAM SOURCE_ROOT LIBRARY CC...
. "$(dirname "$0")/../support/check.sh"
program=$(absolute "$1") source_root=$2 library=$(absolute "$3")
shift 3
cd "$dir" || exit 1
explain() {
    cat err
}
mkdir -p build/src/tools/cli
ln -s "$source_root/images" images
ln -s "$program" build/src/tools/cli/hyperfocal
ln -s "$(dirname "$program")/../io" build/src/tools/io
# The blocks of the command, one file each: four spaces, a command of the build in it.
awk '/^    / { if (!inside) { inside = 1; name = sprintf("block-%02d", ++n) } print substr($0, 5) >name; next }
     { inside = 0 }' "$source_root/README.md"
for block in block-*; do
    grep -q '^build/src/tools/cli/hyperfocal ' "$block" || continue
    # Without OpenImageIO there are no pictures but EXR.
    if grep -q '\.png' "$block" && [ ! -x build/src/tools/io/hyperfocal-oiio ]; then
        skip "there is no hyperfocal-oiio: $(head -n 1 "$block")"
        continue
    fi
    sh -e "$block" >out 2>err </dev/null
    result "$(cat "$block")" $?
    for made in $(grep -o -e '-o [^ ]*' "$block" | sed 's/^-o //; s/####/0001/' | sort -u); do
        [ -s "$made" ]
        result "$made of $(tail -n 1 "$block")" $?
        rm -f "$made"
    done
done
[ "$(grep -l '^build/src/tools/cli/hyperfocal ' block-* | wc -l)" -ge 5 ]
result "README has blocks to paste" $?
# Scripts that it names exist.
for script in $(grep -h -o '^sh [^ ]*' block-* | cut -d' ' -f2); do
    [ -r "$source_root/$script" ]
    result "$script exists" $?
done
awk '/^```c$/ { inside = 1; next } /^```$/ { inside = 0 } inside' "$source_root/README.md" >program.c
"$@" -Wall -Wextra -Werror -I "$source_root/include" program.c -o program "$library" \
    "-Wl,-rpath,$(dirname "$library")" >out 2>err && ./program >out 2>err
result "the program in C" $?
finish
