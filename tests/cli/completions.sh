#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The shells' completions and the man page name every option of the help and no other, and bash completes with its own.
# Usage: completions.sh COMMAND COMPLETIONS
. "$(dirname "$0")/../support/check.sh"
command=$1 completions=$2
"$command" --help=all | grep -o '^ *\(-[a-z], \)\?--[a-z-]*' | grep -o -e '--[a-z-]*' | sort -u >"$dir/options"
check "the help has many options" test "$(wc -l <"$dir/options")" -gt 60
for shell in bash zsh fish; do
    "$completions" $shell >"$dir/$shell"
    while read -r option; do
        [ $shell = fish ] && option="-l ${option#--}"
        check "$shell has $option" grep -Eq -e "$option([^a-z-]|\$)" "$dir/$shell"
    done <"$dir/options"
    # In fish options stand behind -l, and without their dashes.
    [ $shell = fish ] && sed -n 's/.* -l \([a-z-]*\).*/--\1/p' "$dir/fish" >"$dir/named" ||
        grep -o -e '--[a-z][a-z-]*' "$dir/$shell" >"$dir/named"
    check "$shell has no others: $(sort -u "$dir/named" | comm -13 "$dir/options" - | tr '\n' ' ')" \
        sh -c '[ -s "$1/named" ] && [ -z "$(sort -u "$1/named" | comm -13 "$1/options" -)" ]' - "$dir"
    if command -v $shell >/dev/null; then
        check "$shell reads it" $shell -n "$dir/$shell"
    fi
done
# The entries of the man page's options, their dashes escaped.
"$command" --help=man | sed 's/\\-/-/g; s/\\f[A-Z]//g' | grep -A1 '^\.TP' | grep -o -e '--[a-z][a-z-]*' | sort -u >"$dir/man"
check "the man page has the same options: $(comm -3 "$dir/options" "$dir/man" | tr '\n\t' '  ')" cmp "$dir/options" "$dir/man"
if command -v bash >/dev/null; then
    complete='. "$0"; COMP_WORDS=(hyperfocal "$@"); COMP_CWORD=$#; _hyperfocal; echo "${COMPREPLY[*]}"'
    check "bash: engines" test "$(bash -c "$complete" "$dir/bash" --engine g)" = "gather gaussian"
    check "bash: options" test "$(bash -c "$complete" "$dir/bash" --budget)" = "--budget-ms"
    touch "$dir/picture.exr"
    check "bash: files" test "$(bash -c "$complete" "$dir/bash" "$dir/pict")" = "$dir/picture.exr"
    check "bash: files of an option" test "$(bash -c "$complete" "$dir/bash" --depth-file "$dir/pict")" = "$dir/picture.exr"
fi
finish
