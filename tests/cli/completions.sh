#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The shells' completions name every option of the help, and bash completes with its own.
# Usage: completions.sh COMMAND COMPLETIONS
command=$1 completions=$2
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
passed=0 failed=0
check() {  # NAME COMMAND...
    name=$1
    shift
    if "$@" >/dev/null 2>&1; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $name"
    fi
}
"$command" --help=all | grep -o '^ *\(-[a-z], \)\?--[a-z-]*' | grep -o -e '--[a-z-]*' | sort -u >"$dir/options"
check "the help has many options" test "$(wc -l <"$dir/options")" -gt 60
for shell in bash zsh fish; do
    "$completions" $shell >"$dir/$shell"
    while read -r option; do
        [ $shell = fish ] && option="-l ${option#--}"
        check "$shell has $option" grep -Eq -e "$option([^a-z-]|\$)" "$dir/$shell"
    done <"$dir/options"
    if command -v $shell >/dev/null; then
        check "$shell reads it" $shell -n "$dir/$shell"
    fi
done
if command -v bash >/dev/null; then
    complete='. "$0"; COMP_WORDS=(hyperfocal "$@"); COMP_CWORD=$#; _hyperfocal; echo "${COMPREPLY[*]}"'
    check "bash: engines" test "$(bash -c "$complete" "$dir/bash" --engine g)" = "gather gaussian"
    check "bash: options" test "$(bash -c "$complete" "$dir/bash" --budget)" = "--budget-ms"
    touch "$dir/picture.exr"
    check "bash: files" test "$(bash -c "$complete" "$dir/bash" "$dir/pict")" = "$dir/picture.exr"
    check "bash: files of an option" test "$(bash -c "$complete" "$dir/bash" --depth-file "$dir/pict")" = "$dir/picture.exr"
fi
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
