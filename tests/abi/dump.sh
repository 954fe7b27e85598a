#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Write the library's ABI, as abidw of libabigail describes it. Every public function is in src/api: those files alone are
# compiled with debug information, and linked without what they call. That the real library exports the same symbols is
# checked by exports.sh.
# Usage: dump.sh SOURCE_ROOT FILE.abi C-COMPILER...
root=$1 out=$2
shift 2
case $out in
/*) ;;
*) out=$PWD/$out ;;
esac
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$root" || exit 1
soname=libhyperfocal.so.$(sed -n 's/^#define HF_ABI_VERSION //p' include/hyperfocal/version.h)
"$@" -std=gnu11 -D_GNU_SOURCE -g -gdwarf-4 -O0 -shared -fPIC -fvisibility=hidden -Iinclude -Isrc -o "$work/$soname" src/api/*.c \
    -Wl,--version-script=src/api/libhyperfocal.map -Wl,-soname,"$soname" -Wl,--unresolved-symbols=ignore-all || exit 1
# Places in files, names of parameters and what is private to the library are no part of it.
abidw --no-corpus-path --no-comp-dir-path --no-show-locs --no-parameter-names --no-elf-needed --headers-dir include \
    --drop-private-types --exported-interfaces-only --out-file "$out" "$work/$soname"
