#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# How the command handles files: layers, depths of all kinds, windows, compressions.
# Usage: files.sh PROGRAM SOURCE_ROOT
. "$(dirname "$0")/common.sh"

make_inputs || { echo "skipped: no python3"; exit 77; }

# ---- layers
plan "layer ViewLayer.Combined|colour ViewLayer.Combined.R|depth ViewLayer.Depth.Z" layers.exr --focus 3
plan "layer Foreground.Combined|colour Foreground.Combined.R|depth Foreground.Depth.Z" layers.exr --focus 3 --layer Foreground
plan "depth ViewLayer.Depth.Z|depth Foreground.Depth.Z" layers.exr --focus 3 --layer all
plan "colour R, G, B|depth Z Depth.R," c4d.exr --focus 3
plan "colour R, G, B|depth FinalImageMovieRenderQueue_WorldDepth.R," unreal.exr --focus 3
plan "colour FinalImage.R|depth FinalImageWorldDepth.R," final.exr --focus 3 --layer FinalImage
plan "colour R, G, B|depth X_SceneDepth.R," scene.exr --focus 3
bad 1 "layers.exr|Forground|did you mean Foreground.Combined?" layers.exr -o o.exr --focus 3 --layer Forground
bad 1 "layers.exr|did you mean ViewLayer.Depth.Z?" layers.exr -o o.exr --focus 3 --depth-channel ViewLayer.Dept.Z
bad 1 "layers.exr|'Dept'|did you mean" layers.exr -o o.exr --focus 3 --depth-channel Dept
bad 3 "flat.exr|--depth-file" flat.exr -o o.exr --focus 3
bad 1 "stereo.exr|'lefft'|did you mean left?" stereo.exr -o o.exr --focus 3 --views lefft
run layers.exr -o one.exr --focus 3 --max-radius 6 --layer Foreground --verbose
[ "$status" -eq 0 ] && contains "$dir/err" "Foreground.Combined with depth Foreground.Depth.Z"
result "--verbose names layer and depth" $?
good layers.exr -o all.exr --focus 3 --max-radius 6 --layer all --json
json_valid "$dir/out" && contains "$dir/out" '"layer": "Foreground.Combined"' &&
    contains "$dir/out" '"depth": "Foreground.Depth.Z"'
result "--json names layer and depth" $?
run layers.exr -o main.exr --focus 3 --max-radius 6
[ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] &&
    contains "$dir/err" "Foreground.Combined has a depth too and stays as it is; --layer all blurs each"
result "a layer that could be blurred too is a warning" $?
run layers.exr --focus 3 --dry-run
contains "$dir/err" "Foreground.Combined has a depth too"
result "in a dry run too" $?
good layers.exr -o o.exr --focus 3 --layer ViewLayer
good layers.exr -o o.exr --focus 3 --depth-file depth.exr
run many.exr -o o.exr --focus 3
contains "$dir/err" "L1.Combined, L2.Combined, L3.Combined, L4.Combined and 2 more have depths too and stay as they are"
result "many such layers" $?
# A layer that was not asked for is unchanged; the other one equals the result with --layer all.
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
bad 3 "samples.exr|deep picture" flat.exr -o o.exr --focus 3 --depth-file samples.exr
bad 3 "png.exr|PNG" png.exr -o o.exr --focus 3
bad 3 "blend.exr|Blender" blend.exr -o o.exr --focus 3
rm -f one.exr all.exr main.exr

# ---- depth that is not distance: the same picture from every form of the same depth
look='--engine gather --focus 2 --range 2 --max-radius 6'
# shellcheck disable=SC2086
same() {  # OUTPUT-TO-COMPARE ARGUMENTS...
    want=$1
    shift
    run "$@" -o got.exr $look
    [ "$status" -eq 0 ] && python3 -c '
from exr import read
from sys import argv
a, b = read(argv[1]), read("got.exr")
raise SystemExit(any(a[c] != b[c] for c in "RGB"))' "$want"
    result "as $want: $*" $?
}
# shellcheck disable=SC2086
good near.exr -o near-out.exr $look
same near-out.exr negative.exr
contains "$dir/err" "negative.exr" && contains "$dir/err" "negative, so the camera looks along -z" &&
    [ "$(wc -l <"$dir/err")" -eq 1 ]
result "negative depth is understood, with a note" $?
same near-out.exr normal.exr --depth-type normalized --near 1 --far 9
same near-out.exr inverted.exr --depth-type normalized-inverted --near 1 --far 9
same near-out.exr inverse.exr --depth-type inverse
same near-out.exr inverse.exr --depth-type inverse --near 1 --far inf
same near-out.exr scaled.exr --depth-offset 1.25 --depth-scale 0.25
same near-out.exr negative.exr --depth-scale -1
[ ! -s "$dir/err" ]
result "--depth-scale -1 needs no note" $?
run background.exr -o o.exr --focus 2 --json
[ "$status" -eq 0 ] && contains "$dir/out" '"depth_negative": true' && contains "$dir/out" '"no_surface": 640'
result "negative depth with a background of 0" $?
run mixed.exr -o o.exr --focus 2
[ "$status" -eq 0 ] && contains "$dir/err" "64 samples of depth Z are negative"
result "some negative depths are said to be no surface" $?
plan "type normalized-inverted" inverted.exr --depth-type normalized-inverted --near 1 --far 9 --focus-at 0,0
run inverted.exr --depth-type normalized-inverted --near 1 --far 9 --focus-at 63,0 --dry-run
contains "$dir/out" "focus 8 from --focus-at"
result "the focus is read from the depth that was meant" $?
run negative.exr --print-focus --focus-at 63,0
contains "$dir/out" ",8"
result "--print-focus likewise" $?
bad 1 "normalized|--far" normal.exr -o o.exr --focus 2 --depth-type normalized --near 1
bad 1 "normalized|inf" normal.exr -o o.exr --focus 2 --depth-type normalized --near 1 --far inf
bad 1 "--near 9|--far 1|normalized-inverted" normal.exr -o o.exr --focus 2 --depth-type normalized --near 9 --far 1
bad 1 "inverse|--near" inverse.exr -o o.exr --focus 2 --depth-type inverse --far 1
bad 1 "--depth-scale|'0'" near.exr -o o.exr --focus 2 --depth-scale 0
run void.exr -o o.exr --focus 2
[ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "no surface anywhere"
result "a frame without any surface is a warning" $?
# Not if that is meant: radii of the user's own, one blur everywhere, a lens turned past the subject.
for settings in "--focus 12 --fstop 0.05 --focal-length 50" "--focus 0.5 --fstop 0.05 --focal-length 50" \
    "--depth-type coc" "--engine hexagon --uniform --focus 100 --range 3"; do
    # shellcheck disable=SC2086  # several words
    run near.exr -o o.exr $settings
    [ "$status" -eq 0 ] && ! contains "$dir/err" "nothing is in focus"
    result "no warning that nothing is in focus: $settings" $?
done
run near.exr -o o.exr --focus 100 --fstop 0.05 --focal-length 50
[ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "nothing is in focus"
result "a frame with nothing in focus is a warning" $?
# The focus by an object's name, and by a point of the world.
for file in matte.exr beside.exr hashed.exr; do
    plan "focus 2 from --focus-object" $file --focus-object Suzanne
    plan "focus 4 from --focus-object" $file --focus-object Box
    plan "focus 8 from --focus-object" $file --focus-object Wall
done
bad 1 "no object Suzane|did you mean Suzanne?|Suzanne, Wall, Box" matte.exr -o o.exr --focus-object Suzane
bad 1 "--focus-object Cube is nowhere" hashed.exr -o o.exr --focus-object Cube
bad 1 "plain.exr|no Cryptomatte" plain.exr -o o.exr --focus-object Suzanne
bad 1 "--focus|--focus-object" matte.exr -o o.exr --focus-object Suzanne --focus 2
for file in camera.exr ndc-camera.exr; do
    plan "focus 9 from --focus-point" $file --focus-point 3,-5,4
done
bad 1 "plain.exr|worldToCamera" plain.exr -o o.exr --focus-point 3,-5,4
bad 1 "--focus-point|'1,2'|X,Y,Z" plain.exr -o o.exr --focus-point 1,2
bad 1 "--focus-point|'1,2,3,4'|X,Y,Z" plain.exr -o o.exr --focus-point 1,2,3,4
# Over a shot --focus-at follows the surface of the first frame: the wall that comes by does not take it, nor does noise.
run walk.####.exr --focus-at 31,20 --print-focus --focus-smooth 0
printf '%s\n' frame,focus 1,4 2,3.9 3,3.8 4,3.8 5,3.8 6,3.8 7,3.4 8,3.3 9,3.2 >"$dir/want"
[ "$status" -eq 0 ] && cmp -s "$dir/out" "$dir/want"
result "--focus-at follows a surface" $?
run walk.####.exr --focus-at 31,20 --print-focus --focus-smooth 0 --frames 7-8
[ "$status" -eq 0 ] && [ "$(cat "$dir/out")" = "$(sed -n '1p;8,9p' "$dir/want")" ]
result "--focus-at follows it in whatever frames are asked for" $?
run walk.####.exr --focus center --print-focus --focus-smooth 0
[ "$status" -eq 0 ] && grep -q '^4,1$' "$dir/out"
result "--focus center takes what is there" $?
# A depth whose scale nobody knows: where to focus, and how much blur. The pixel that is farthest off gets that.
blurs() {  # RADII ARGUMENTS...
    words="radius $1"
    shift
    run "$@" --verbose
    ok=$status
    lacks "$dir/err" line
    result "blurs by $words: $*" "$ok"
}
blurs "near 6.0 far 0.0" near.exr -o o.exr --focus-at 63,5 --blur 6
blurs "near 6.0 far 0.0" inverse.exr -o o.exr --focus-at 63,5 --blur 6 --depth-type inverse
blurs "near 6.0 far 0.0" normal.exr -o o.exr --focus-at 63,5 --blur 6 --depth-type normalized
blurs "near 6.0 far" ndc.exr -o o.exr --focus-at 61,5 --blur 6 --depth-type ndc-d3d
# 1/1, 1/2, 1/4, 1/8 from left to right: in focus 1/2; 1/8 is 3/4 as far off as 1/1 is.
blurs "near 6.0 far 4.5" near.exr -o o.exr --focus-at 20,5 --blur 6
bad 1 "--blur 6|--focus-at" near.exr -o o.exr --blur 6
bad 1 "--fstop|--blur" near.exr -o o.exr --blur 6 --focus center --fstop 2
bad 1 "--near|--blur" near.exr -o o.exr --blur 6 --focus center --near 2
bad 1 "--focus-at is pixel 99,5|outside" near.exr -o o.exr --blur 6 --focus-at 99,5
# A depth map of another size is scaled to the picture, with a message.
good flat.exr -o steps-full.exr --focus 2 --max-radius 6 --depth-file steps.exr --json
! contains "$dir/out" depth_scaled_from
result "a depth file of the picture's size is not scaled" $?
run flat.exr -o steps-half.exr --focus 2 --max-radius 6 --depth-file half-steps.exr --json --verbose
[ "$status" -eq 0 ] && json_valid "$dir/out" && contains "$dir/out" '"depth_scaled_from": [32, 20]' &&
    contains "$dir/err" "half-steps.exr, 32 x 20 scaled to 64 x 40"
result "a depth file of half the size is scaled" $?
cmp -s steps-full.exr steps-half.exr
result "to the same picture" $?
bad 3 "small.exr|10 x 10 pixels of depth for a picture of 64 x 40|width / height" flat.exr -o o.exr --focus 2 --depth-file small.exr
run photo.png -o o.png --depth-file map8.png --depth-type normalized --near 1 --far 6 --focus 2 --range 2 --max-radius 6
if contains "$dir/err" "built without OpenImageIO"; then
    skip "photographs and maps (no OpenImageIO)"
else
    [ "$status" -eq 0 ] && [ ! -s "$dir/err" ] && [ -s o.png ] && ! cmp -s o.png photo.png
    result "a photograph in sRGB with an 8-bit map" $?
    rm -f o.png
    bad 1 "o.png|--layer|ViewLayer.Combined, Foreground.Combined" layers.exr -o o.png --focus 3 --layer all
    # Depth maps of 8 and 16 bits whose values are exact distances, with black near and with white near.
    for map in 'map8.png normalized' 'map16.png normalized' 'white.png normalized-inverted'; do
        # shellcheck disable=SC2086
        set -- $map
        for x in 0,1 20,2 63,5; do
            run photo.png --dry-run --depth-file "$1" --depth-type "$2" --near 1 --far 6 --focus-at "${x%,*},9"
            contains "$dir/out" "focus ${x#*,} from" || contains "$dir/out" "focus ${x#*,}.0"
            result "$1, $2 at $x" $?
        done
    done
    # A photograph with an Exif rotation keeps it, or a message says that it does not.
    run photo.png -o upright.jpg --depth-file map8.png --depth-type normalized --near 1 --far 6 --focus 2 --range 2
    python3 -c '
data = open("upright.jpg", "rb").read()
exif = b"Exif\0\0MM\0*\0\0\0\x08\0\1\x01\x12\0\3\0\0\0\1\0\6\0\0\0\0\0\0"
open("turned.jpg", "wb").write(data[:2] + b"\xff\xe1" + (len(exif) + 2).to_bytes(2, "big") + exif + data[2:])'
    run turned.jpg -o out.jpg --depth-file map8.png --depth-type normalized --near 1 --far 6 --focus 2 --range 2
    [ "$status" -eq 0 ] && [ ! -s "$dir/err" ] && python3 -c '
import sys
data = open("out.jpg", "rb").read()
tag = [b"\x01\x12\0\3\0\0\0\1\0\6", b"\x12\x01\3\0\1\0\0\0\6\0"]
sys.exit(not any(t in data for t in tag))'
    result "a photograph's orientation goes along" $?
    run turned.jpg -o out.exr --depth-file map8.png --depth-type normalized --near 1 --far 6 --focus 2 --range 2
    [ "$status" -eq 0 ] && contains "$dir/err" "the orientation of turned.jpg is not kept"
    result "or is told to be lost" $?
    bad 3 "photo.png|a picture in colours|--depth-channel R" photo.png -o o.png --focus 2 --depth-file photo.png
    run photo.png -o photo-out.png --depth-file map8.png --focus 5 --fstop 0.1 --focal-length 50
    [ "$status" -eq 0 ] && contains "$dir/err" "nothing is in focus" && contains "$dir/err" "--depth-type normalized" &&
        ! contains "$dir/err" 65.535
    result "a map taken for distances is a warning" $?
    for map in map8.png half8.png; do
        run photo.png -o "from-$map" --depth-file $map --depth-type normalized --near 1 --far 6 --focus 2 --range 2 \
            --max-radius 6 --verbose
        [ "$status" -eq 0 ] && { [ $map = map8.png ] || contains "$dir/err" "32 x 20 scaled to 64 x 40"; }
        result "$map" $?
    done
    for edges in auto keep; do
        run photo.png -o edges-$edges.png --depth-file soft8.png --depth-type normalized --near 1 --far 6 --focus 2 \
            --range 2 --max-radius 6 --depth-edges $edges --verbose
        said=$(grep -o '[0-9]* samples beside outlines sharpened' "$dir/err")
        [ "$status" -eq 0 ] && [ "$said" = "$([ $edges = keep ] || echo 40 samples beside outlines sharpened)" ]
        result "--depth-edges $edges" $?
    done
    ! cmp -s edges-auto.png edges-keep.png
    result "--depth-edges has an effect" $?
    run photo.png -o photo-out.png --depth-file map16.png --focus 5 --fstop 0.1 --focal-length 50
    contains "$dir/err" "--depth-type normalized" && contains "$dir/err" "--depth-scale 65.535"
    result "a map of 16 bits may be millimetres" $?
    bad 1 "map8.png|8 bits|--depth-type inverse needs --near|--depth-scale" photo.png -o o.png --depth-file map8.png \
        --depth-type inverse --focus 5
    good photo.png -o o.png --depth-file map8.png --depth-type inverse --focus 5 --depth-scale 0.5 --max-radius 6
    good flat.exr -o o.exr --depth-file inverse.exr --depth-type inverse --focus 4 --max-radius 6
    run crop.exr -o o.png --focus 1.5 --range 2
    [ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] &&
        contains "$dir/err" "o.png holds no windows: its picture is the data window, 20 x 16 at 24,12 of the display window, 64 x 40"
    result "a window that PNG cannot hold is a warning" $?
    good bare.exr -o o.png --focus 1.5 --range 2 --max-radius 6
    # The photograph in the README.
    run "$source_root/images/lights-before.png" --depth-file "$source_root/images/lights-depth.png" --depth-type inverse \
        --near 1.5 --far 60 --focus 5 --fstop 0.37 --focal-length 50 -o photo-out.png --verbose
    [ "$status" -eq 0 ] && contains "$dir/err" "radius near 28.0 far 11.0" && contains "$dir/err" "0 warnings"
    result "the README's photograph" $?
    run photo.png --dry-run --depth-file map16.png --depth-scale 65.535 --focus-at 20,9
    contains "$dir/out" "focus 13.107 from"
    result "millimetres in 16 bits" $?
fi

# Highlights: a lamp is small and stands out. lamps.exr has three of 2 x 2 pixels, a bright wall of 20 x 40, and the wall has
# specks that are no brighter than 2.5 times what is around.
python3 - <<'PYTHON'
from exr import exr
lamp = lambda x, y: any(x0 <= x < x0 + 2 and y0 <= y < y0 + 2 for x0, y0 in [(5, 5), (15, 20), (30, 33)])
wall = lambda x, y: .95 + .05 * (x % 5 == y % 5 == 0) if x >= 44 else 1 if lamp(x, y) else .1
exr('lamps.exr', dict({n: wall for n in 'RGB'}, Z=lambda x, y: 8))
exr('wall.exr', dict({n: (lambda x, y: max(.95 if x >= 44 else .1, 0)) for n in 'RGB'}, Z=lambda x, y: 8))
PYTHON
lens='--focus 4 --fstop 0.05 --focal-length 50 --sensor-width 60'
run lamps.exr -o o.exr $lens --verbose --highlight-gain 8 --highlight-threshold 0.8 --json o.json --compression none
[ "$status" -eq 0 ] && contains "$dir/err" "3 lamps, 12 pixels above 0.8 raised, 1 to 8" && contains o.json '"highlight_gain": 8' &&
    contains o.json '"lamps": 3'
result "--highlight-gain tells of lamps" $?
run lamps.exr -o plain-o.exr $lens --compression none
# Beside the lamps there is more light; at the wall's far side none, not a bit; and nowhere is more than the white of 1.
[ "$status" -eq 0 ] && python3 -c '
import struct
from exr import read
a, b = read("o.exr")["G"], read("plain-o.exr")["G"]
v = lambda p, x, y: struct.unpack_from("<f", p, 4 * (64 * y + x))[0]
assert v(a, 7, 7) > 1.5 * v(b, 7, 7), (v(a, 7, 7), v(b, 7, 7))
assert all(v(a, 62, y) == v(b, 62, y) for y in range(40))
assert max(v(a, x, y) for x in range(64) for y in range(40)) <= 1.0001'
result "--highlight-gain raises lamps and no wall" $?
run lamps.exr -o o.exr --focus 8 --range 3 --highlight-gain 8 --highlight-threshold 0.8 --compression none
[ "$status" -eq 0 ] && python3 -c 'from exr import read; a, b = read("o.exr"), read("lamps.exr"); assert a == b'
result "--highlight-gain keeps the bits of lamps that are sharp" $?
run wall.exr -o o.exr $lens --highlight-gain 8
[ "$status" -eq 0 ] && contains "$dir/err" "there is no lamp"
result "a bright wall is no lamp" $?
run lamps.exr -o o.exr $lens --highlight-gain 1 --highlight-threshold 0.4 --compression none
[ "$status" -eq 0 ] && python3 -c "from exr import read; assert read('o.exr') == read('plain-o.exr')"
result "--highlight-gain 1 has no effect" $?
run lamps.exr -o o.exr $lens --highlight-gain 8 --highlight-threshold 0.8 --explain
[ "$status" -eq 0 ] && contains "$dir/out" "highlights above 0.8 raised while they are blurred, 1 to 8: 3 lamps" && [ ! -s "$dir/err" ]
result "--highlight-gain in --explain" $?
plan "highlights above 0.8 raised, 1 to 4" lamps.exr --focus 3 --highlight-gain 4 --highlight-threshold 0.8
exr_dark='from exr import exr; exr("dark.exr", {"Y": lambda x, y: 0.5, "Z": lambda x, y: 2 ** (x // 16)})'
python3 -c "$exr_dark"
run dark.exr -o o.exr $lens --highlight-gain 8
[ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "there is no lamp, small and brighter than 0.9"
result "--highlight-gain without highlights is a warning" $?
rm -f dark.exr o.json plain-o.exr

# The options that --quality chose are on the summary line, in JSON and in the log.
run near.exr -o o.exr --focus 4 --range 2 --quality draft --verbose --json
contains "$dir/err" "gather (--quality draft chose --engine gather" &&
    contains "$dir/out" '"options": "--engine gather'
result "--verbose names what --quality chose" $?
run near.exr -o o.exr --focus 4 --range 2 --max-error 0.04 --verbose --log o.log
contains "$dir/err" "(--max-error 0.04 chose --engine" && contains o.log '"choice": {"options": "--engine'
result "--verbose and --log name what --max-error chose" $?
run near.exr -o o.exr --focus 4 --range 2 --engine layers --explain
[ "$status" -eq 0 ] && grep -q 'the settings do not call for it' "$dir/out"
result "--explain says why a pass does not run" $?
rm -f o.log

# ---- --focus-image: near, in-focus and far pixels, painted
good near.exr -o o.exr --focus 4 --fstop 0.05 --focal-length 50 --focus-image painted.exr
python3 - <<'PYTHON'
import struct
from exr import read
f = read("painted.exr")
at = lambda c, x: struct.unpack_from('<f', f[c], 4 * (20 * 64 + x))[0]
# depths 1 2 4 8: near, near, in focus, far
ok = all(max('RGB', key=lambda c: at(c, x)) == want for x, want in [(4, 'R'), (20, 'R'), (36, 'G'), (52, 'B')])
raise SystemExit(not ok)
PYTHON
result "--focus-image paints near red, in focus green, far blue" $?
rm -f painted.exr
good near.exr --focus 4 --focus-image painted.exr --dry-run
[ -s painted.exr ]
result "--focus-image without rendering" $?
bad 1 "--focus-image|near.exr|INPUT" near.exr -o o.exr --focus 4 --focus-image near.exr
bad 1 "--log|near.exr|INPUT" near.exr -o o.exr --focus 4 --log near.exr
bad 1 "--log|o.exr" near.exr -o o.exr --focus 4 --log o.exr

# ---- messages about what is done and what is ignored
# In place, by any name of the file: done, with a warning. Another hard link counts as another picture.
for name in same.exr ./same.exr link.exr; do
    cp plain.exr same.exr && ln -sf same.exr link.exr
    run same.exr -o $name --focus 3 --json o.json
    [ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "OUTPUT $name is INPUT" &&
        contains o.json '"in_place": true' && contains o.json "\"OUTPUT $name is INPUT" && ! cmp -s plain.exr same.exr
    result "a picture replaced by its blur is a warning, $name" $?
done
cp plain.exr same.exr && ln -f same.exr hard.exr
good same.exr -o hard.exr --focus 3
cmp -s plain.exr same.exr
result "a hard link of the input leaves it as it was" $?
bad 1 "--resume|same.exr is INPUT" same.exr -o same.exr --focus 3 --resume
run plain.exr -o made.exr --focus 3 --resume --quiet
run made.exr -o o.exr --focus 3 --json
[ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "defocused already" &&
    json_valid "$dir/out" && contains "$dir/out" '"hyperfocal made this file'
result "an input that was made here is a warning" $?
run made.exr -o o.exr --focus 3 --resume --verbose --log o.log
contains "$dir/err" "1 warning" && contains o.log '"warning_texts": ["hyperfocal made this file'
result "in a shot and its log too" $?
rm -f o.exr same.exr hard.exr link.exr made.exr o.json o.log

# Options of the range model that give no range: the header's lens is ignored, with a warning.
for option in "--strength 0.5" "--depth-of-field 2"; do
    # shellcheck disable=SC2086
    run lens.exr -o o.exr $option --json
    [ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "${option% *} is of the range model" &&
        contains "$dir/out" "not the header's lens, f/2 and 50 mm"
    result "$option puts the lens aside with a warning" $?
    # shellcheck disable=SC2086
    good lens.exr -o o.exr $option --range 2
    # shellcheck disable=SC2086
    good focus.exr -o o.exr $option
done
rm -f o.exr

# Options for a lens, where no lens is given.
bad 1 "--sensor-width 36|lens|range" plain.exr -o o.exr --focus 3 --sensor-width 36
bad 1 "--world-unit 0.1|lens|range" plain.exr -o o.exr --focus 3 --world-unit 0.1
bad 1 "--world-unit 0.1|lens|depth says" plain.exr -o o.exr --depth-type coc --world-unit 0.1
plan "model range|focus 30 from --focus" plain.exr --focus 3m --world-unit 0.1
plan "model range|focus 40 from header" focus.exr --world-unit 0.1
plan "type ray" plain.exr --focus 3 --depth-type ray --focal-length 50 --fstop 2 --sensor-width 24
plan "type ray|model range" lens.exr --range 3 --depth-type ray --sensor-width 24
# Options of no use for one picture; and messages of the library name the command's options.
run plain.exr -o o.exr --focus 3 --memory-limit 0.5
[ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "--memory-limit 0.5 does nothing for one"
result "--memory-limit for one picture is a warning" $?
run plain.exr -o o.exr --focus 3 --fstop 0.01 --focal-length 50 --engine gather --faithful
[ "$status" -eq 0 ] && contains "$dir/err" "--max-radius is 12 pixels" && ! contains "$dir/err" "max_radius"
result "options have their names in what the library says" $?
rm -f o.exr

# ---- lossy compression
run layers.exr -o dwa.exr --focus 3 --compression dwaa --layer ViewLayer
if contains "$dir/err" "built without OpenImageIO"; then
    skip "DWA (no OpenImageIO)"
else
    run dwa.exr -o o.exr --focus 3 --max-radius 6 --json
    [ "$status" -eq 0 ] && contains "$dir/err" "3 channels besides the colours (Foreground.Combined.B, ...)" &&
        contains "$dir/err" "dwaa a second time" && contains "$dir/err" "--compression zip" && [ "$(wc -l <"$dir/err")" -eq 2 ] &&
        contains "$dir/out" '"note": "dwa.exr'
    result "what DWA wears out is counted" $?
    good dwa.exr -o o.exr --focus 3 --max-radius 6 --compression none --layer ViewLayer
    run dwa.exr -o o2.exr --focus 3 --max-radius 6
    good o2.exr -o o3.exr --focus 3 --max-radius 0 --compression none --layer ViewLayer
    python3 -c '
from exr import read
a, b, c = (read(n) for n in ["layers.exr", "o.exr", "o3.exr"])
raise SystemExit(any(f[n] != a[n] for f in (b, c) for n in a if n.startswith("Crypto") or n.endswith(".Z")))'
    result "masks and depth keep their bits through DWA" $?
    rm -f o2.exr o3.exr
fi

# ---- an incomplete lens
lens() {  # WORDS-ON-STDERR ARGUMENTS...
    words=$1
    shift
    run "$@" -o o.exr
    ok=$status
    [ "$(wc -l <"$dir/err")" -eq 1 ] || { ok=1; echo "not one line on stderr:"; }
    lacks "$dir/err" warning
    result "lens: $*" "$ok"
}
lens "focus 4 and aperture 2, but no pinholeFocalLength|range|give --focal-length" stop.exr
lens "aperture 2, but no pinholeFocalLength|give --focal-length" stop.exr --focus 3
lens "focus 4, but no aperture and no pinholeFocalLength|give --fstop and --focal-length" focus.exr
lens "focus 4 and pinholeFocalLength 50, but aperture 0|give --fstop" closed.exr
lens "no pinholeFocalLength|nominalFocalLength, 50 mm, is taken|--focal-length" nominal.exr
good stop.exr -o o.exr --range 2
good stop.exr -o o.exr --focal-length 50
good closed.exr -o o.exr --fstop 2
good focus.exr -o o.exr --focus 3
good nominal.exr -o o.exr --focal-length 85
plan "model lens|f/2|focal length 50|focus 4 from header" nominal.exr
plan "model lens|f/2|focal length 50|focus 3 from --focus" unfocused.exr --focus 3
bad 1 "no focus distance" unfocused.exr -o o.exr

# ---- messages about a frame
for i in 1 2; do cp near.exr shot.$i.exr; done
good shot.#.exr -o done.#.exr --focus 4 --quiet
run shot.#.exr -o done.#.exr --focus 4 --verbose
[ "$status" -eq 0 ] && [ "$(grep -c 'RGB with depth Z, layers, focus 4 (--focus)' "$dir/err")" -eq 2 ]
result "--verbose of a shot: a line for each frame" $?
cp void.exr shot.2.exr
run shot.#.exr -o done.#.exr --focus 4 --quiet
[ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "shot.2.exr: depth Z has no surface"
result "--quiet leaves warnings" $?
run near.exr -o o.exr --focus 4 --fstop 0.1 --focal-length 50 --engine gaussian --verbose
[ "$status" -eq 0 ] && contains "$dir/err" "not by how much the lens" && ! contains "$dir/err" " 0 warnings"
result "what the library warns of is counted" $?
# As many warnings as the summary counts, each printed once.
told() {  # WARNINGS ARGUMENTS...
    want=$1
    shift
    run "$@" --verbose
    [ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq $((want + 1)) ] && [ "$(sort -u "$dir/err" | wc -l)" -eq $((want + 1)) ] &&
        tail -1 "$dir/err" | grep -q " $want warning"
    result "$want warnings: $*" $?
}
told 0 near.exr -o o.exr --focus 4
told 0 near.exr -o o.exr --focus 4 --fstop 0.1 --focal-length 50 --max-radius 2
contains "$dir/err" "(cut to 2, by --max-radius)"
result "a limit that was asked for is on the line" $?
# Nothing in focus. Pixels without a surface do not count, unless the focus is there. The message names the unit.
warns() {  # WORDS-ON-STDERR ARGUMENTS...
    words=$1
    shift
    told 1 "$@"
    ok=0
    lacks "$dir/err" warning
    result "warns: $*" "$ok"
}
# Filtered depth: sharpen moves a depth between two surfaces to the closer one, also where the focus is read.
for edges in auto sharpen; do
    run filtered.exr -o o.exr --focus-at 30,20 --fstop 0.1 --focal-length 50 --depth-edges $edges --verbose
    [ "$status" -eq 0 ] && contains "$dir/err" "focus $([ $edges = auto ] && echo 4 || echo 2) (--focus-at)"
    result "focus, --depth-edges $edges" $?
    said=$(grep -o '[0-9]* samples beside outlines sharpened' "$dir/err")
    [ "$said" = "$([ $edges = auto ] || echo 40 samples beside outlines sharpened)" ]
    result "depth of an EXR, --depth-edges $edges" $?
    run filtered.exr --print-focus --focus-at 30,20 --depth-edges $edges
    [ "$(tail -n 1 "$dir/out" | cut -d, -f2)" = "$([ $edges = auto ] && echo 4 || echo 2)" ]
    result "--print-focus, --depth-edges $edges" $?
done
warns "nothing is in focus|the depth is 1 to 8, the focus 60: is the focus in other units? 6 would be near" \
    sky.exr -o o.exr --focus 60 --fstop 0.1 --focal-length 50
warns "the depth is 1000 to 8000, the focus 4|--depth-scale 0.001|--world-unit 0.001|4m" \
    near.exr -o o.exr --focus 4 --fstop 0.1 --focal-length 50 --depth-scale 1000
warns "the depth is 1000 to 8000, the focus 4|--world-unit 0.001" lens.exr -o o.exr --fstop 0.1 --depth-scale 1000
warns "0.01562 to 1, the focus 4|normalized, inverse or ndc-d3d" \
    ndc.exr -o o.exr --focus 4 --fstop 0.1 --focal-length 50 --max-radius 50
warns "inverse depth may have a scale of its own" \
    near.exr -o o.exr --focus 4 --fstop 0.1 --focal-length 50 --depth-type inverse
if [ -x "$(dirname "$program")/../io/hyperfocal-oiio" ]; then
    # What estimators write, white near, needs no more; with a type it is as that says.
    blurs "near 6.0 far 0.0" photo.png -o o.png --depth-file white.png --focus-at 60,20 --blur 6
    blurs "near 0.0 far 6.0" photo.png -o o.png --depth-file map8.png --focus-at 60,20 --blur 6
    blurs "near 6.0 far 0.0" photo.png -o o.png --depth-file map8.png --focus-at 60,20 --blur 6 --depth-type normalized
    # EXIF is the lens, unless one is given. 26 mm on film of 43.27 mm across are 6.9 mm on 11.48 mm, of which a picture of
    # 64 x 40 has 9.738 mm in x.
    plan "model lens, f/1.8, focal length 6.9 mm, sensor 9.7|(from EXIF)|focus 3 from --focus" \
        photo.tif --depth-file depth.exr --focus 3
    plan "f/1.8, focal length 50 mm, sensor 36 mm (the rest from EXIF)" photo.tif --depth-file depth.exr --focus 3 --focal-length 50
    plan "f/4, focal length 50 mm, sensor 36 mm, world" photo.tif --depth-file depth.exr --focus 3 --focal-length 50 --fstop 4
    plan "model range" photo.tif --depth-file depth.exr --focus 3 --range 2
    run photo.tif -o o.tif --depth-file depth.exr --focus 3 --verbose
    [ "$status" -eq 0 ] && contains "$dir/err" "f/1.8 6.9 mm (from EXIF)"
    result "--verbose says that the lens is from EXIF" $?
    # A profile of curves and a matrix: what is not blurred keeps its codes, and the profile stays. In an EXR, which has no
    # profile, the light has the primaries of sRGB: a code of 255, 255, 255 is 1, 1, 1 in any profile (to 2e-4, as the
    # profile's numbers have 5 digits); the corner 0, 0, 0 stays; and other pixels are not as the curve of sRGB has them.
    run romm.png -o kept.png --depth-file depth.exr --focus 3 --range inf
    [ "$status" -eq 0 ] && python3 - <<'PYTHON'
import zlib, struct
def chunks(path):
    data, at, found = open(path, 'rb').read(), 8, {}
    while at < len(data):
        size, kind = struct.unpack_from('>I4s', data, at)
        found[kind] = found.get(kind, b'') + data[at + 8:at + 8 + size]
        at += 12 + size
    return found
def pixels(path):
    raw, rows, before = zlib.decompress(chunks(path)[b'IDAT']), [], bytes(192)
    for y in range(40):
        kind, row = raw[193 * y], bytearray(raw[193 * y + 1:193 * y + 193])
        for i in range(192):
            a, b, c = row[i - 3] if i > 2 else 0, before[i], before[i - 3] if i > 2 else 0
            p = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            row[i] = row[i] + [0, a, b, (a + b) // 2, p][kind] & 255
        rows.append(bytes(row))
        before = row
    return rows
assert pixels('kept.png') == pixels('romm.png')
name, rest = chunks('kept.png')[b'iCCP'].split(b'\0', 1)
assert zlib.decompress(rest[1:]) == open('romm.icc', 'rb').read()
PYTHON
    result "a profile stays, and codes that are not blurred" $?
    run romm.png -o o.exr --depth-file depth.exr --focus 3 --range inf --compression none
    [ "$status" -eq 0 ] && ! contains "$dir/err" profile && python3 - <<'PYTHON'
import struct, exr
c = exr.read('o.exr')
size = len(c['R']) // 2560
v = lambda n, x, y: struct.unpack_from('<e' if size == 2 else '<f', c[n], size * (y * 64 + x))[0]
to = [[3.1338561, -1.6168667, -0.4906146], [-0.9787684, 1.9161415, 0.0334540], [0.0719453, -0.2289914, 1.4052427]]
m = [[.79767, .13519, .03134], [.28804, .71188, .00009], [0, 0, .82491]]
for x, y in (0, 0), (63, 39), (20, 30), (5, 33), (61, 2):
    light = [(round(255 * f) / 255) ** (461 / 256) for f in (x / 63, y / 39, (x + y) % 40 / 39)]
    xyz = [sum(a * b for a, b in zip(row, light)) for row in m]
    for n, row in zip('RGB', to):
        want = sum(a * b for a, b in zip(row, xyz))
        assert abs(v(n, x, y) - want) < 2e-4 + abs(want) * 1e-3, (x, y, n, v(n, x, y), want)
PYTHON
    result "a profile's matrix gives the primaries of sRGB" $?
fi
# A crop by Blender's border render does not say so; its shape hints at it.
warns "Blender|unusual shape, 49 x 38|--display 1920x1080+X+Y" border.exr -o o.exr
for picture in "blender.exr" "border.exr --display 64x40" "border.exr --range 2"; do
    # shellcheck disable=SC2086  # several words
    run $picture -o o.exr
    [ "$status" -eq 0 ] && ! contains "$dir/err" "unusual shape"
    result "no crop is suspected: $picture" $?
done
# A warning if nothing is blurred, unless the options ask for that.
warns "nothing is blurred: the largest radius is 0.00 pixels|0.05 mm: is it 50 mm?" \
    near.exr -o o.exr --focus 4 --fstop 2 --focal-length 0.05
warns "nothing is blurred|0.00 pixels|f/800" near.exr -o o.exr --focus 4 --fstop 800 --focal-length 50
warns "nothing is blurred|1000 to 8000|--world-unit 0.001" \
    near.exr -o o.exr --focus 4000 --fstop 2 --focal-length 50 --depth-scale 1000
warns "nothing is blurred|--range inf" near.exr -o o.exr --focus 4 --range inf
told 0 near.exr -o o.exr --focus 4 --strength 0
told 0 near.exr -o o.exr --focus 4 --max-radius 0
told 0 near.exr -o o.exr --focus 4 --fstop inf --focal-length 50
told 0 near.exr -o o.exr --focus 4 --engine hexagon --uniform --max-radius 4
# The gaussian engine mixes in more or less of one blur: 3 |4 - 8| / 100 behind the focus.
told 0 near.exr -o o.exr --focus 4 --engine gaussian --sigma 3
contains "$dir/err" "standard deviation 3.0 mixed in up to near 9 % far 12 %"
result "how much the gaussian engine blurs" $?
run near.exr --focus 4 --engine gaussian --sigma 3 --explain --dry-run --range 2
contains "$dir/out" "standard deviation: 3.00 pixels, of which at most 100 % are mixed in near, 100 % far"
result "--explain of the gaussian engine" $?
told 1 near.exr -o o.exr --focus 4 --fstop 0.0002 --focal-length 50
contains "$dir/err" "--max-radius is 2048 pixels, the most that there can be: larger blur is cut to that"
result "the largest radius that there can be" $?
told 1 near.exr -o o.exr --focus 4 --fstop 0.002 --focal-length 50 --engine gather
told 1 near.exr -o o.exr --focus 4 --fstop 0.1 --focal-length 50 --engine gaussian
told 2 layers.exr -o o.exr --focus 4 --fstop 0.0002 --focal-length 50
if command -v script >/dev/null; then
    script -qec "'$program' near.exr -o o.exr --focus 4" /dev/null >"$dir/out" 2>&1 </dev/null
    contains "$dir/out" "RGB with depth Z, layers, focus 4"
    result "a line on a terminal" $?
fi
rm -f shot.?.exr done.?.exr

# ---- windows
# The object of film.exr fills a part of the frame; crop.exr has only that part, in the same display window.
lens='--focus 2 --fstop 0.1 --focal-length 50 --engine layers'
# shellcheck disable=SC2086
good film.exr -o film-out.exr $lens
# shellcheck disable=SC2086
run crop.exr -o cut.exr $lens
[ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "beyond the data window" &&
    contains "$dir/err" "--grow"
result "blur that is cut is a warning" $?
# shellcheck disable=SC2086
run plain.exr -o o.exr --focus 4 --range 2 --grow
[ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "--grow changes nothing"
result "--grow of a whole frame is a warning" $?
good crop.exr -o grown.exr $lens --grow
python3 - <<'PYTHON'
import struct
from exr import read, window
whole, cut, grown = (read(n) for n in ['film-out.exr', 'cut.exr', 'grown.exr'])
x0, y0, x1, y1 = w = window('grown.exr')
ok = window('cut.exr') == (24, 12, 43, 27) and window('grown.exr', 'displayWindow') == (0, 0, 63, 39)
ok &= x0 < 24 and y0 < 12 and x1 > 43 and y1 > 27 and x0 > 0 and y0 >= 0 and x1 < 63 and y1 <= 39
at = lambda f, w, c, x, y: struct.unpack_from('<f', f[c], 4 * ((y - w[1]) * (w[2] - w[0] + 1) + x - w[0]))[0]
# Premultiplied colours equal those of the whole frame, up to rounding: the same samples are added in another order.
worst = max(abs(at(grown, w, c, x, y) - at(whole, (0, 0, 63, 39), c, x, y))
            for c in 'RGBA' for y in range(y0, y1 + 1) for x in range(x0, x1 + 1))
outside = max(at(whole, (0, 0, 63, 39), 'A', x, y) for y in range(40) for x in range(64)
              if not (x0 <= x <= x1 and y0 <= y <= y1))
spread = at(grown, w, 'A', 23, 20)
ok &= worst < 1e-5 and outside == 0 and spread > 0
ok &= at(grown, w, 'Z', x0, y0) == 1e10 and at(grown, w, 'id', x0, y0) == 0 and at(grown, w, 'id', 30, 20) == 7
if not ok:
    print(w, worst, outside, spread)
raise SystemExit(not ok)
PYTHON
result "--grow is what the whole frame shows" $?
# At half resolution both use the same groups of pixels, and search as far for what lies behind near pixels.
for engine in scatter "scatter --resolution half" hexagon "hexagon --resolution half"; do
    # shellcheck disable=SC2086
    good film.exr -o film-out.exr $lens --engine $engine
    # shellcheck disable=SC2086
    good crop.exr -o grown.exr $lens --grow --engine $engine
    python3 - <<'PYTHON'
import struct
from exr import read, window
whole, grown, (x0, y0, x1, y1) = read('film-out.exr'), read('grown.exr'), window('grown.exr')
at = lambda f, left, top, width, c, x, y: struct.unpack_from('<f', f[c], 4 * ((y - top) * width + x - left))[0]
worst = max(abs(at(grown, x0, y0, x1 - x0 + 1, c, x, y) - at(whole, 0, 0, 64, c, x, y))
            for c in 'RGBA' for y in range(y0, y1 + 1) for x in range(x0, x1 + 1))
if worst >= 1e-5:
    print((x0, y0, x1, y1), worst)
raise SystemExit(worst >= 1e-5)
PYTHON
    result "--grow is what the whole frame shows: $engine" $?
done
# Two views in one part share its window, which grows once, as much as for one view.
python3 - <<'PYTHON'
from exr import exr
one = {c: lambda x, y: 1 for c in 'RGB'} | {'Z': lambda x, y: 4 if x < 30 else 9}
inside = dict(window=(24, 12, 43, 27), display=(0, 0, 63, 39))
exr('one.exr', one, **inside)
exr('two.exr', one | {'right.' + c: f for c, f in one.items()}, views=['left', 'right'], **inside)
PYTHON
for name in one two; do good $name.exr -o $name-out.exr --focus 4 --range 2 --max-radius 3 --grow; done
python3 - <<'PYTHON'
from exr import read, window
one, two, w = read('one-out.exr'), read('two-out.exr'), window('one-out.exr')
ok = w == window('two-out.exr') and 8 < w[0] < 24 and all(one[c] == two[c] == two['right.' + c] for c in 'RGBZ')
raise SystemExit(not ok)
PYTHON
result "--grow of two views of one part" $?
# A crop without window attributes: --display gives the frame that the lens belongs to.
plan "focal length 88.8889 pixels|display window -20,-10 to 43,29" bare.exr --focus 2 --fstop 2 --focal-length 50 \
    --display 64x40+20+10
plan "display window -22,-12 to 41,27" bare.exr --focus 2 --fstop 2 --focal-length 50 --display 64x40
plan "focal length 27.7778 pixels" bare.exr --focus 2 --fstop 2 --focal-length 50
for value in 64 64x 0x40 64x40+1 64x40+1+ 64x40x2; do
    bad 1 "--display|'$value'" bare.exr -o o.exr --focus 2 --display "$value"
done
bad 1 "--display 19x40|20 x 16" bare.exr -o o.exr --focus 2 --display 19x40
bad 1 "--display 64x40|at the place" bare.exr -o o.exr --focus 2 --display 64x40+45+0

finish
