#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Every header compiles alone, without a warning; the public ones as C11 and as C++17. Vector bodies are written over
# an instruction set's operations: here over those of the lowest one.
# Usage: headers.sh SOURCE_ROOT FAMILY C++-COMPILER|none C-COMPILER...
root=$1
family=$2
cxx=$3
shift 3
cd "$root" || exit 1
passed=0 failed=0

# try NAME COMMAND...: the command compiles it.
try()
{
    name=$1
    shift
    if output=$("$@" 2>&1); then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $name"
        echo "$output" | head -n 6
    fi
}

warnings='-Wall -Wextra -Wshadow -Wvla -Werror -Wno-unused-function -Wno-unused-const-variable -Wno-unused-macros'
internal="-std=gnu11 -D_GNU_SOURCE $warnings -Iinclude -Isrc -Itests -Ibench -Itests/kernels -DHF_FUSED=0"
case $family in
x86_64) internal="$internal -DHF_X86=1 -DHF_SIMD=1 -DHF_SUFFIX=sse41_exact" vectors=simd/vec_sse41.h ;;
aarch64) internal="$internal -DHF_ARM=1 -DHF_SIMD=1 -DHF_SUFFIX=neon_exact" vectors=simd/vec_neon.h ;;
*) vectors= ;;
esac
if pkg-config --exists OpenEXR 2>/dev/null; then
    exr=$(pkg-config --cflags OpenEXR)
else
    exr=none
fi

if pkg-config --exists gtk4 2>/dev/null; then
    gtk=$(pkg-config --cflags gtk4)
else
    gtk=none
fi

# Include the public headers as an application does.
stub=$(mktemp -d) || exit 1
trap 'rm -rf "$stub"' EXIT
for header in include/hyperfocal/*.h; do
    printf '#include <%s>\nint nothing;\n' "${header#include/}" >"$stub/alone.c"
    cp "$stub/alone.c" "$stub/alone.cpp"
    # shellcheck disable=SC2086
    try "$header as C11" "$@" -std=c11 -pedantic $warnings -Iinclude -fsyntax-only "$stub/alone.c"
    [ "$cxx" = none ] ||
        try "$header as C++17" "$cxx" -std=c++17 -pedantic -Wall -Wextra -Werror -Iinclude -fsyntax-only "$stub/alone.cpp"
done

for header in $(find src tests bench -name '*.h' | grep -v '^tests/abi/[0-9]' | sort); do
    flags=
    case $header in
    src/simd/vec_avx2.h) flags='-mavx2 -mfma -mf16c' isa=x86_64 ;;
    src/simd/vec_avx512.h | src/simd/vec_long.h)
        flags='-mavx512f -mavx512bw -mavx512dq -mavx512vl -mfma -mf16c' isa=x86_64 ;;
    src/simd/vec_sse41.h) flags=-msse4.1 isa=x86_64 ;;
    src/simd/vec_neon.h) isa=aarch64 ;;
    *_simd.h | *_vf.h | src/simd/*)
        [ -n "$vectors" ] || continue
        flags="-DHF_VEC=\"$vectors\"" isa=$family
        [ "$family" != x86_64 ] || flags="-msse4.1 $flags" ;;
    tests/kernels/emulated/*)
        # Stands in for the compiler's own header of this name.
        flags='-Itests/kernels/emulated -Wno-psabi' isa=x86_64
        echo '#include <simde/x86/avx512.h>' | "$@" -fsyntax-only -x c - 2>/dev/null || continue ;;
    src/tools/io/* | tests/io/*)
        [ "$exr" != none ] || continue
        flags=$exr isa=$family ;;
    src/tools/view/*)
        [ "$gtk" != none ] || continue
        flags=$gtk isa=$family ;;
    *) isa=$family ;;
    esac
    [ "$isa" = "$family" ] || continue
    # shellcheck disable=SC2086
    try "$header" "$@" $internal $flags -fsyntax-only -x c "$header"
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
