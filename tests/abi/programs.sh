#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Programs and libraries of different releases meet. Older releases' headers are those that record.sh kept. The newer release's
# headers are made here: a field is appended to two structs. Its library is built from the same sources, in plain C alone.
# Usage: programs.sh SOURCE_ROOT LIBRARY BUILD_ROOT C-COMPILER...
root=$1 library=$(realpath "$2") build=$3
shift 3
cd "$root" || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0 failed=0
fail()
{
    echo "FAILED: $1"
    failed=$((failed + 1))
}

mkdir "$work/newer" "$work/other" "$work/newer-lib" || exit 1
cp -R include/hyperfocal "$work/newer" && cp -R include/hyperfocal "$work/other" || exit 1
for at in hf_params:params.h hf_report:hyperfocal.h; do
    header=$work/newer/hyperfocal/${at#*:}
    sed "/^struct ${at%:*} {/,/^};/s/^};/    int later[2];\n};/" "$header" >"$work/changed"
    cmp -s "$work/changed" "$header" && fail "no field was appended to struct ${at%:*}"
    cp "$work/changed" "$header"
done
version=$(sed -n 's/^#define HF_ABI_VERSION //p' include/hyperfocal/version.h)
sed -i "s/^#define HF_ABI_VERSION .*/#define HF_ABI_VERSION $((version + 1))/" "$work/other/hyperfocal/version.h"

soname=libhyperfocal.so.$version
# shellcheck disable=SC2046
"$@" -std=gnu11 -D_GNU_SOURCE -O0 -shared -fPIC -fvisibility=hidden -I"$work/newer" -Isrc -I"$build/src" \
    -o "$work/newer-lib/$soname" $(find src/base src/pass src/pixel src/engine src/frame src/api -name '*.c' |
        grep -v '/simd\.c$\|_windows\.c$') \
    -Wl,--version-script=src/api/libhyperfocal.map -Wl,-soname,"$soname" -lm -pthread >"$work/log" 2>&1 ||
    { fail "the newer library does not build"; head "$work/log"; }

# meet NAME HEADERS LIBRARY FLAG...: a program with these headers, run with this library.
meet()
{
    name=$1 headers=$2 with=$3
    shift 3
    # shellcheck disable=SC2086
    if $compiler -std=gnu11 -Wall -Wextra -Werror -I"$headers" -Itests "$@" tests/abi/program.c -o "$work/program" "$with" &&
        LD_LIBRARY_PATH=$(dirname "$with") "$work/program" >"$work/log" 2>&1; then
        passed=$((passed + 1))
    else
        fail "$name"
        cat "$work/log"
    fi
}
compiler=$*
newer=$work/newer-lib/$soname
meet "a program with the library of its release" include "$library"
meet "an older program with a newer library" include "$newer"
meet "a newer program that uses nothing new, with an older library" "$work/newer" "$library" -DLATER=0
meet "a newer program that uses a new field, with an older library" "$work/newer" "$library" -DLATER=1 -DWANT=HF_ERR_ARG
meet "a newer program with a newer library" "$work/newer" "$newer" -DLATER=1
meet "a program of another ABI" "$work/other" "$library" -DWANT=HF_ERR_ABI
for headers in tests/abi/[0-9]*/; do
    if grep -qx "#define HF_ABI_VERSION $version" "$headers/hyperfocal/version.h"; then
        meet "a program of $headers with this library" "$headers" "$library"
        meet "a program of $headers with a newer library" "$headers" "$newer"
    else
        meet "a program of $headers, another ABI" "$headers" "$library" -DWANT=HF_ERR_ABI
    fi
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
