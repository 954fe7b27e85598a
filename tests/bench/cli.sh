#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# hyperfocal-bench, run as a user does: what it refuses and how, and what the JSON of its commands contains.
# Nothing depends on measured times.
# Usage: cli.sh BENCH SOURCE_ROOT
. "$(dirname "$0")/../support/check.sh"
bench=$(absolute "$1") source_root=$(absolute "$2")
cd "$dir" || exit 1
explain() {
    cat err
}
# Check for exit code 1, one line on stderr with the words, and nothing on stdout.
bad() {  # WORDS ARGUMENTS...
    words=$1
    shift
    "$bench" "$@" >out 2>err
    ok=$?
    [ "$ok" -eq 1 ] && [ ! -s out ] && [ "$(wc -l <err)" -eq 1 ]
    ok=$?
    old_ifs=$IFS
    IFS='|'
    for word in $words; do
        grep -qF -e "$word" err || ok=1
    done
    IFS=$old_ifs
    result "refuse: $*" $ok
}
bad "a command is needed"
bad "'pases'|did you mean passes?" pases
bad "--engin|did you mean --engine?" passes --engin gather
bad "'scater'|did you mean scatter?" passes --engine scater
bad "a command is needed before" --json -
bad "'3x'|WIDTHxHEIGHT" passes --size 3x
bad "'0'|1 to 1000000" passes --frames 0
bad "--html|tradeoff|passes" passes --html x
bad "--karis|gather|scatter" passes --engine scatter --karis
bad "--image|--truth" truth --image a.exr
bad "missing.exr" truth --image missing.exr --truth missing.exr
bad "lights.exr|1280 x 720|640 x 360" truth --image "$source_root/images/lights-before.png" \
    --truth "$source_root/images/lights.exr"
bad "--surfaces|layers|chapter" passes --surfaces 2
bad "1 to 3" passes --engine layers --surfaces 4
bad "lights.peel1.exr" passes --engine layers --surfaces 2 --scene "$source_root/images/lights.exr"
mkdir flat
bad "peel1.exr|flat" truth --peels --images flat
bad "--ladder|--setting" tradeoff --ladder x.h --setting "--engine gaussian"
bad "--readme|missing.md" tradeoff --readme missing.md
echo 'no marks' >plain.md
bad "--readme|plain.md|<!-- /tradeoff -->" tradeoff --readme plain.md
# A folder without programs is refused before anything is measured.
mkdir none
printf '#!/bin/sh\nPATH=%s exec %s "$@"\n' "$dir/none" "$bench" >without
chmod +x without
program=$bench bench=./without
bad "--png|rsvg-convert|librsvg2-bin" tradeoff --png x.png
bench=$program
bad "cannot read the history|missing.jsonl" history --file missing.jsonl
echo '{"date": "2026-01-02"}' >wrong.jsonl
bad "wrong.jsonl:1:|commit" history --file wrong.jsonl
for command in passes truth tradeoff scaling formats batch cancel stability history; do
    "$bench" --help >out 2>err && grep -q "^  $command " out
    result "--help tells of $command" $?
    "$bench" "$command" --help >out 2>err && grep -q "^    hyperfocal-bench $command \[options\]" out &&
        [ "$(grep -c '^  [a-z]' out)" -eq "$((1 + $(grep -c '^  hyperfocal-bench ' out)))" ] &&
        ! grep '^  hyperfocal-bench ' out | grep -qv "^  hyperfocal-bench $command "
    result "$command --help is of that command" $?
done
# The help of a command lists the options it accepts, and none that it refuses.
"$bench" passes --help >out 2>err && grep -q '^      --scene' out && grep -q '^      --karis' out &&
    ! grep -qE -e '^ +--(html|image|add|full|compression)' out
result "passes --help" $?
for command in batch tradeoff cancel stability history; do
    "$bench" $command --help >out 2>err && ! grep -qE -e '^ +--(karis|rings|layers-quality|highlight-gain|blades|scene)' out
    result "$command --help has no options of a look" $?
    bad "--karis|$command" $command --karis
done
"$bench" truth --help >out 2>err && grep -q '^      --karis' out && ! grep -qE -e '^ +--(quick|frames|full|scene)' out
result "truth --help" $?
"$bench" --help >out 2>err && grep -q '^      --html' out && grep -q '^      --scene' out
result "--help has the options of all" $?
[ "$(awk 'length($0) > 80' out | wc -l)" -eq 0 ]
result "--help fits 80 columns" $?
# The text between a file's marks is replaced; the text around them stays.
printf '%s\n' before '<!-- tradeoff: made by hyperfocal-bench, do not edit -->' old '<!-- /tradeoff -->' after >marked.md
"$bench" tradeoff --quick --cache none --setting "--engine gaussian --max-radius 0" --readme marked.md >out 2>err &&
    [ "$(head -n 1 marked.md)$(tail -n 1 marked.md)" = beforeafter ] && ! grep -q old marked.md &&
    grep -q 'hyperfocal-bench tradeoff --quick --setting' marked.md && [ "$(grep -c tradeoff: marked.md)" -eq 1 ]
result "--readme" $?
"$bench" --help=man >out 2>err && grep -q '^.TH hyperfocal-bench 1' out && grep -q '^.SH COMMANDS' out
result "--help=man" $?

command -v python3 >/dev/null || { skip "no python3 for the JSON"; finish; }
"$bench" passes --engine layers --surfaces 3 --size 64x64 --frames 1 >out 2>err && grep -q ' 3 surfaces, 1 frames' out &&
    awk '$1 == "Known" { known = $2 } END { exit !(known > 0) }' out
result "passes --surfaces" $?
"$bench" formats --size 96x54 --threads 1 --json formats.json >out 2>err && [ "$(grep -c '^rgba8 ' out)" -eq 2 ] && python3 -c '
import json
d = json.load(open("formats.json"))
assert d["command"] == "formats" and d["cpu"] and d["width"] == 96
colour = {(c["format"], c["transfer"]): c for c in d["colour"]}
assert len(colour) == 17 and len(d["depth"]) == 7
for c in colour.values():
    assert c["frame_ms"] > 0 and (c["format"] == "r11g11b10f") == (c["read_ms"] is None)
assert colour["rgba8", "srgb"]["bytes"] == 96 * 54 * 4 and colour["rgba32f", "linear"]["bytes"] == 96 * 54 * 16
assert {d["format"] for d in d["depth"]} == {"float32", "float16", "unorm16", "unorm32", "d24s8", "x8d24"}
assert all(d["plan_ms"] > 0 and d["frame_ms"] > 0 for d in d["depth"])'
result "formats" $?
# A made-up point, and then a measured one: a line with every number of one engine.
echo '{"commit": "abc1234567", "date": "2026-01-02", "cpu": "X", "isa": "avx2", "threads": 2, "dB layers/lights": 27,' \
    '"dB layers/fence": 28, "dB layers/foliage": 29.5}' >made.jsonl
"$bench" history --file made.jsonl --svg made.svg --json made.json >out 2>err && grep -q '^abc1234567 2026-01-02 A .* 28.17 *$' out &&
    grep -q '^A  X, avx2, 2 threads' out && python3 -c '
import json, xml.dom.minidom
xml.dom.minidom.parse("made.svg")
d = json.load(open("made.json"))
assert d["command"] == "history" and d["points"][0]["dB layers/fence"] == 28'
result "history" $?
"$bench" history --add --file made.jsonl --svg made.svg --engine gaussian --size 64x64 --frames 1 \
    --images "$source_root/images" >out 2>err && python3 -c '
import json, xml.dom.minidom
first, d = [json.loads(line) for line in open("made.jsonl")]
assert first["commit"] == "abc1234567" and d["source"] == "measured" and len(d["truth"]) == 8
assert all(d[k] for k in "commit date cpu isa".split()) and d["threads"] >= 1
assert all(d[k] > 0 for k in ["memcpy_ms", "fma_gflops", "ms gaussian", "MB gaussian", "pass gaussian/Merge"])
for scene in "lights", "fence", "foliage":
    assert 10 < d["dB gaussian/" + scene] < 30 and d["ms gaussian/" + scene] > 0
assert not any("gather" in k for k in d)
assert xml.dom.minidom.parse("made.svg").getElementsByTagName("circle")'
result "history --add" $?
# A table in a document becomes what its command prints; a block without a command stays.
printf '%s\n' '`hyperfocal-bench passes --size 64x64 --frames 1`: small' '' '    old' '' '    old' '' Text '' '    kept' >tables.md
python3 "$source_root/docs/tables.py" --build "$(dirname "$(dirname "$bench")")" "$dir/tables.md" >out 2>err &&
    ! grep -q old tables.md && grep -q '^    All ' tables.md && [ "$(tail -n 1 tables.md)" = "    kept" ]
result "docs/tables.py" $?
json() {  # KEYS ARGUMENTS...
    keys=$1
    shift
    "$bench" "$@" --json - >out 2>err && python3 - "$keys" "$@" <<'PYTHON' 2>>err
import json, sys
j = json.load(open('out'))
missing = [k for k in ['command', 'cpu', 'version', 'options'] + sys.argv[1].split() if k not in j]
assert not missing, missing
assert j['command'] == sys.argv[2] and j['options'] == sys.argv[3:] + ['--json', '-'], j['options']
if 'passes' in j:
    # Rows and overhead add up to the whole frame, to the nanosecond.
    rows = sum(p['median_ms'] for p in j['passes'])
    assert abs(rows + j['overhead_ms'] - j['all']['median_ms']) < 1e-5, rows
    assert ('gtx660_ms' in j['all']) == (j['width'] == 1920)
PYTHON
    result "JSON of $*" $?
}
json "engine width busy passes overhead_ms all" passes --size 64x64 --frames 3
json "psnr_db linear_rmse ssim flip energy" truth --image "$source_root/images/lights.exr" \
    --truth "$source_root/images/lights.truth.exr"
finish
