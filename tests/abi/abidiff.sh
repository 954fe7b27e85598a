#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The library keeps the ABI of every recorded release of its HF_ABI_VERSION: functions, types, enumerators. It may grow as
# hyperfocal.h says; allowed.suppr has the exceptions. Changes made here on purpose show that abidiff sees what it should.
# Usage: abidiff.sh SOURCE_ROOT C-COMPILER...
root=$1
shift
cd "$root" || exit 1
if ! abidiff --version >/dev/null 2>&1 || ! abidw --version >/dev/null 2>&1; then
    echo "abidiff and abidw (abigail-tools) are not installed"
    exit 77
fi
if [ "$(uname -m)" != x86_64 ]; then
    echo "the ABI is recorded for x86-64"
    exit 77
fi
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0 failed=0 compiler=$*

# True if all that abidiff found is functions added and fields added at the end of structs.
grew()
{
    grep -Eq 'data member insertion|[1-9][0-9]* Added' "$work/log" &&
        ! grep -Eq 'deletion|member change|enumerator change|[1-9][0-9]* Removed|of type .* (changed|was)|return type changed' "$work/log"
}

# compare NAME OLD NEW same|other: abidiff's status has 1 and 2 for errors, 4 for a change, 8 for one that surely breaks programs.
compare()
{
    abidiff --suppressions tests/abi/allowed.suppr "$2" "$3" >"$work/log" 2>&1
    status=$?
    case $status in
    0) found=same ;;
    4) if grew; then found=same; else found=other; fi ;;
    8 | 12) found=other ;;
    *) found=error ;;
    esac
    if [ $found = "$4" ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $1: abidiff returns $status, which means $found; expected $4"
        head -n 30 "$work/log"
    fi
}

# The ABI with headers that the sed script $3 has changed in the file $2, as $1.abi.
changed()
{
    rm -rf "$work/$1"
    mkdir -p "$work/$1/src" || exit 1
    cp -R include "$work/$1" && cp -R src/. "$work/$1/src" || exit 1
    sed -i "$3" "$work/$1/$2"
    cmp -s "$work/$1/$2" "$2" && echo "FAILED: nothing was changed for $1" && failed=$((failed + 1))
    # shellcheck disable=SC2086
    sh tests/abi/dump.sh "$work/$1" "$work/$1.abi" $compiler || exit 1
}

sh tests/abi/dump.sh . "$work/now.abi" "$@" || exit 1
symbols=$(grep -c '<elf-symbol ' "$work/now.abi")
if [ "$symbols" -eq "$(cat include/hyperfocal/*.h | grep -c '^HF_API ')" ]; then
    passed=$((passed + 1))
else
    failed=$((failed + 1))
    echo "FAILED: abidw sees $symbols functions"
fi
for recorded in tests/abi/[0-9]*.abi; do
    abi=$(sed -n 's/^#define HF_ABI_VERSION //p' "${recorded%.abi}/hyperfocal/version.h")
    [ "$abi" != "$(sed -n 's/^#define HF_ABI_VERSION //p' include/hyperfocal/version.h)" ] ||
        compare "${recorded##*/}" "$recorded" "$work/now.abi" same
done

header=include/hyperfocal/hyperfocal.h
changed appended $header '/^struct hf_report {/,/^};/s/^};/    uint64_t later;\n};/'
compare "a field at the end" "$work/now.abi" "$work/appended.abi" same
changed inserted $header '/^struct hf_report {/,/^};/s/^    uint64_t memory;.*/    uint64_t later;\n&/'
compare "a field in the middle" "$work/now.abi" "$work/inserted.abi" other
changed retyped $header '/^struct hf_report {/,/^};/s/^    uint64_t no_surface;.*/    double no_surface;/'
compare "a field of another type" "$work/now.abi" "$work/retyped.abi" other
changed enumerator $header 's/^    HF_LIMIT_MODEL, .*/    HF_LIMIT_OTHER,\n&/'
compare "an enumerator in the middle" "$work/now.abi" "$work/enumerator.abi" other
changed later $header 's/^    HF_LIMIT_PICTURE, .*/&\n    HF_LIMIT_OTHER,/'
compare "an enumerator at the end" "$work/now.abi" "$work/later.abi" same
changed symbol src/api/libhyperfocal.map '/hf_value;/d'
compare "a function less" "$work/now.abi" "$work/symbol.abi" other
compare "a function more" "$work/symbol.abi" "$work/now.abi" same
changed inspect include/hyperfocal/inspect.h 's/^    int step, steps;.*/    int later;\n&/'
compare "inspect.h" "$work/now.abi" "$work/inspect.abi" same
changed release src/api/libhyperfocal.map 's/^HYPERFOCAL_INSPECT_[0-9.]*/HYPERFOCAL_INSPECT_99.9/'
compare "inspect.h of another release" "$work/now.abi" "$work/release.abi" same
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
