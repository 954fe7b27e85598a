#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The code looks as .clang-format says. Exempt are vec_*.h, which are tables of one-line operations, and the
# headers of earlier releases.
# Usage: format.sh SOURCE_ROOT. Skipped without clang-format 14: other versions break lines elsewhere.
cd "$1" || exit 1
for program in clang-format-14 clang-format none; do
    "$program" --version 2>/dev/null | grep -q 'version 14\.' && break
done
if [ "$program" = none ]; then
    echo "clang-format 14 is not installed"
    exit 77
fi
passed=0 failed=0
for file in $(find include src tests bench integrations -name '*.[ch]' -o -name '*.cpp' | grep -v '/vec_[a-z0-9]*\.h$\|^tests/abi/[0-9]' | sort); do
    if "$program" --dry-run --Werror "$file" 2>/dev/null; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $file: clang-format -i it"
    fi
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
