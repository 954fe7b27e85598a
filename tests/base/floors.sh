#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Includes go down only: every #include "FLOOR/..." in src names the includer's own floor or a lower one. Engines do not
# include each other. Programs include only the library's public headers and the floor `base`. Only `base` and the
# programs include headers of the operating system; the rest includes headers of C11 and of vector operations.
# Usage: floors.sh SOURCE_ROOT
cd "$1/src" || exit 1
find . -name '*.[ch]' -o -name '*.inc' -o -name '*.cpp' | sed 's,^\./,,' | sort | xargs awk '
    BEGIN {
        n = split("base simd pass pixel engine frame api", floors); for (i = 1; i <= n; i++) level[floors[i]] = i
        n = split("assert ctype errno float inttypes limits math stdarg stdatomic stdbool stddef stdint stdio stdlib string " \
                  "arm_neon emmintrin immintrin smmintrin", words); for (i = 1; i <= n; i++) plain["<" words[i] ".h>"] = 1
    }
    /^ *# *include "/ {
        split($2, quoted, "\""); split(quoted[2], to, "/"); split(FILENAME, from, "/")
        if (to[1] == "hyperfocal" || !index(quoted[2], "/")) next
        ok = from[1] == "tools" ? to[1] == "tools" || to[1] == "base" : level[to[1]] && level[to[1]] <= level[from[1]]
        if (from[1] == "engine" && to[1] == "engine" && from[2] ~ /^[a-z]*$/ && from[2] != to[2]) ok = 0
        if (ok) passed++; else { failed++; print "FAILED: " FILENAME " includes " quoted[2] }
    }
    /^ *# *include </ && FILENAME !~ /^(base|tools)\// {
        if (plain[$2]) passed++; else { failed++; print "FAILED: " FILENAME " includes " $2 ", which is for src/base" }
    }
    END { print passed + 0 " passed, " failed + 0 " failed"; exit failed > 0 || !passed }'
