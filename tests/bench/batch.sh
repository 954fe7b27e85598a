#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# hyperfocal-bench batch runs, and its JSON says what it should. Usage: batch.sh BENCH SOURCE_ROOT. No time decides here.
bench=$1
source_root=$2
command -v oiiotool >/dev/null && command -v python3 >/dev/null || { echo "skipped: no oiiotool or python3"; exit 77; }
"$bench" batch --size 160x90 --frames 2 --compression zip --images "$source_root/images" --json - | python3 -c '
import json, sys
j = json.load(sys.stdin)
row, = j["rows"]
stages = ["read", "decode", "defocus", "encode", "write", "wait"]
shares = [row[s + "_share"] for s in stages]
ok = [j["frames"] == 2, row["compression"] == "zip", row["seconds"] > 0, row["oiiotool_seconds"] > 0,
      row["copy_seconds"] > 0, all(s >= 0 for s in shares), row["defocus_share"] > 0, row["peak_memory"] > 1e6]
print(sum(ok), "passed,", len(ok) - sum(ok), "failed")
sys.exit(not all(ok))'
