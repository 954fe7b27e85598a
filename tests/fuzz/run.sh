#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A fixed number of runs of a fuzz target, from a corpus that stays as it is. What breaks it lands beside the program.
# The limit is 10 seconds without sanitizers, which take three times as long.
# Usage: run.sh PROGRAM RUNS CORPUS [SEED]
found=$(mktemp -d) || exit 1
trap 'rm -rf "$found"' EXIT
"$1" -runs="$2" -seed="${4:-1}" -timeout=30 -rss_limit_mb=2048 -malloc_limit_mb=2048 -max_len=4096 -print_final_stats=1 \
    -verbosity=0 -artifact_prefix="${1%/*}/" "$found" "$3"
