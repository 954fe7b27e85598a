#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Comments name what exists: FILE.c, FILE.h and the like in a comment is how the path of a file here ends, and hf_NAME
# and HF_NAME stand in code too. What has a * or capitals (NAME.c) stands for several; headers of the system are known.
# Usage: names.sh SOURCE_ROOT
cd "$1" || exit 1
list=$(mktemp) || exit 1
trap 'rm -f "$list"' EXIT
find src bench tests include examples integrations docs images .ci -type f | grep -v '^tests/abi/[0-9]' | sort >"$list"
grep -E '\.(c|h|inc|cpp|sh)$|meson\.build$' "$list" | xargs awk -v list="$list" '
    function check_file(name, ok) {
        if (name ~ /[*]|[A-Z][A-Z]|^_|^(windows|immintrin|pthread|math)[.]h$/) return
        if (name in exists) passed++
        else { failed++; print "FAILED: " FILENAME ":" FNR " names " name }
    }
    BEGIN {
        while ((getline path < list) > 0) {
            exists[path] = 1
            while (i = index(path, "/")) { path = substr(path, i + 1); exists[path] = 1 }
        }
    }
    {
        in_c = FILENAME ~ /[.](c|h|inc|cpp)$/
        at = index($0, in_c ? "//" : "# ")
        comment = in_c ? (at ? substr($0, at) : "") : (at == 1 ? $0 : "")
        rest = !in_c ? "" : at ? substr($0, 1, at - 1) : $0
        for (; match(rest, /(hf|HF)_[A-Za-z0-9_]+/); rest = substr(rest, RSTART + RLENGTH))
            known[substr(rest, RSTART, RLENGTH)] = 1
        for (rest = comment; match(rest, "[A-Za-z0-9_./*-]+[.](c|h|inc|cpp|sh)($|[^A-Za-z0-9_(])"); rest = substr(rest, RSTART + RLENGTH)) {
            name = substr(rest, RSTART, RLENGTH)
            sub(/[^A-Za-z0-9_]$/, "", name)
            sub("^/", "", name)
            check_file(name)
        }
        for (rest = in_c ? comment : ""; match(rest, /(hf|HF)_[A-Za-z0-9_]+/); rest = substr(rest, RSTART + RLENGTH)) {
            name = substr(rest, RSTART, RLENGTH)
            if (name !~ /NAME|_$/ && substr(rest, RSTART + RLENGTH, 1) != "*") said[name] = FILENAME ":" FNR
        }
    }
    END {
        for (name in said)
            if (name in known) passed++
            else { failed++; print "FAILED: " said[name] " names " name }
        print passed + 0 " passed, " failed + 0 " failed"
        exit failed > 0 || !passed
    }'
