#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What the command makes of files: layers, depths of all kinds, windows, compressions.
# Usage: files.sh PROGRAM SOURCE_ROOT
. "$(dirname "$0")/common.sh"

make_inputs || { echo "skipped: no python3"; exit 77; }

# ---- layers
plan "layer ViewLayer.Combined|colour ViewLayer.Combined.R|depth ViewLayer.Depth.Z" layers.exr --focus 3
plan "layer Foreground.Combined|colour Foreground.Combined.R|depth Foreground.Depth.Z" layers.exr --focus 3 --layer Foreground
plan "depth ViewLayer.Depth.Z|depth Foreground.Depth.Z" layers.exr --focus 3 --layer all
bad 3 "layers.exr|Forground|did you mean Foreground.Combined?" layers.exr -o o.exr --focus 3 --layer Forground
bad 3 "layers.exr|did you mean ViewLayer.Depth.Z?" layers.exr -o o.exr --focus 3 --depth-channel ViewLayer.Dept.Z
bad 1 "o.png|--layer|ViewLayer.Combined, Foreground.Combined" layers.exr -o o.png --focus 3 --layer all
bad 1 "stereo.exr|'lefft'|did you mean left?" stereo.exr -o o.exr --focus 3 --views lefft
run layers.exr -o one.exr --focus 3 --max-radius 6 --layer Foreground --verbose
[ "$status" -eq 0 ] && contains "$dir/err" "Foreground.Combined with depth Foreground.Depth.Z"
result "--verbose names layer and depth" $?
good layers.exr -o all.exr --focus 3 --max-radius 6 --layer all --json
json_valid "$dir/out" && contains "$dir/out" '"layer": "Foreground.Combined"' &&
    contains "$dir/out" '"depth": "Foreground.Depth.Z"'
result "--json names layer and depth" $?
good layers.exr -o main.exr --focus 3 --max-radius 6
# The layer that was not asked for is as it was, the other is the same as where both are made.
python3 - <<'PYTHON'
from exr import read
before, one, main, both = (read(n) for n in ['layers.exr', 'one.exr', 'main.exr', 'all.exr'])
ok = True
for name in before:
    fg, vl = name.startswith('Foreground.Combined'), name.startswith('ViewLayer.Combined')
    ok &= (one[name] != before[name]) == fg and (main[name] != before[name]) == vl
    ok &= both[name] == (one if fg else main)[name]
raise SystemExit(not ok)
PYTHON
result "each layer by its own depth, and no other touched" $?
bad 3 "png.exr|PNG" png.exr -o o.exr --focus 3
bad 3 "blend.exr|Blender" blend.exr -o o.exr --focus 3
rm -f one.exr all.exr main.exr

finish
