# SPDX-License-Identifier: BSD-3-Clause
# What shell tests source: a folder of their own, and a count of what passed. A test ends with `finish`.
# shellcheck shell=sh

# The folder goes when the test ends.
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM

passed=0 failed=0 skipped=0
# Count one result; print the name of a failure and what `explain` prints. A test may define an `explain` of its own.
result() {  # NAME STATUS
    if [ "$2" -eq 0 ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $1"
        explain | sed 's/^/  /'
    fi
}
explain() {
    tail -n 20 "$dir/said"
}
# Does the command succeed? What it prints is in "$dir/said".
check() {  # NAME COMMAND...
    checked=$1
    shift
    "$@" >"$dir/said" 2>&1
    result "$checked" $?
}
skip() {  # WHAT
    skipped=$((skipped + 1))
    echo "skipped: $1"
}
# Print the last line and end the test.
finish() {
    [ "$skipped" -eq 0 ] || echo "$skipped skipped"
    echo "$passed passed, $failed failed"
    [ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
    exit
}
# The path from the root.
absolute() {  # PATH
    case $1 in /*) echo "$1" ;; *) echo "$PWD/$1" ;; esac
}
