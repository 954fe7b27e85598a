#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The shared library exports what the public headers declare and nothing else: functions of inspect.h under the symbol version
# HYPERFOCAL_INSPECT_RELEASE, all others under HYPERFOCAL_1 or the node of a later release.
# Usage: exports.sh SOURCE_ROOT LIBRARY
root=$1 library=$2
if ! nm --help 2>/dev/null | grep -q with-symbol-versions; then
    echo "nm does not know --with-symbol-versions"
    exit 77
fi
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# The functions that headers declare: the word before the first parenthesis of a line that begins with HF_API.
declared()
{
    sed -nE 's/^HF_API[^(]*[ *](hf_[a-z0-9_]+)\(.*/\1/p' "$@"
}
{
    declared "$root/include/hyperfocal/hyperfocal.h" "$root/include/hyperfocal/layers.h" "$root/include/hyperfocal/params.h" | sed 's/$/ HYPERFOCAL_1/'
    declared "$root/include/hyperfocal/inspect.h" | sed 's/$/ HYPERFOCAL_INSPECT/'
} | sort >"$work/declared"
# The nodes are in the list of absolute symbols too. A release's node is HYPERFOCAL_1_MINOR or HYPERFOCAL_INSPECT_MAJOR.MINOR.
nm -D --defined-only --with-symbol-versions "$library" |
    awk '$2 != "A" { sub("@@?", " ", $3); print $3 }' |
    sed -E 's/ (HYPERFOCAL_1)(_[0-9]+)$/ \1/; s/ (HYPERFOCAL_INSPECT)_[0-9.]+$/ \1/' | sort >"$work/exported"

failed=$(diff "$work/declared" "$work/exported" | grep -c '^[<>]')
passed=$(comm -12 "$work/declared" "$work/exported" | wc -l)
diff "$work/declared" "$work/exported" | sed -n 's/^</FAILED: declared, not exported:/p; s/^>/FAILED: exported, not declared:/p'
lines=$(cat "$root"/include/hyperfocal/*.h | grep -c '^HF_API ')
if [ "$lines" -ne "$(wc -l <"$work/declared")" ]; then
    echo "FAILED: $lines lines begin with HF_API, and $(wc -l <"$work/declared") functions were found in them"
    failed=$((failed + 1))
fi
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
