#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Doxygen makes the API's reference without a warning: whatever a public header declares has a comment.
# Usage: doxygen.sh DOXYFILE. Skipped without doxygen.
command -v doxygen >/dev/null || {
    echo "doxygen is not installed"
    exit 77
}
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
{ cat "$1" && echo "OUTPUT_DIRECTORY = $dir"; } >"$dir/Doxyfile"
passed=0 failed=0
if doxygen "$dir/Doxyfile" >"$dir/out" 2>&1 && [ ! -s "$dir/out" ]; then
    passed=$((passed + 1))
else
    failed=$((failed + 1))
    echo "FAILED: doxygen warns"
    cat "$dir/out"
fi
# What it read was not empty.
for name in hf_render hf_params HF_ENGINE_GATHER HF_API; do
    if grep -rqs "$name" "$dir/html"; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: nothing about $name"
    fi
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
