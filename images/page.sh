#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Make ENGINES.md and its pictures: three scenes rendered by all engines beside the ray-traced truth, as pictures, as
# crops and in numbers.
# Needs oiiotool (Debian: openimageio-tools).
#     images/page.sh [BUILD-FOLDER]
set -eu
cd "$(dirname "$0")/.."
build=${1:-build}
hyperfocal=$build/src/tools/cli/hyperfocal
bench=$build/bench/hyperfocal-bench
engines="layers scatter gather hexagon gaussian"
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
mkdir -p images/engines images/crops
rm -f images/engines/* images/crops/*

# Crops are 80 x 60 pixels, enlarged four times without interpolation.
cut() {  # FILE X Y OUT
    oiiotool "$1" --ch R,G,B --cut "80x60+$2+$3" --resize:filter=box 320x240 -o "$4"
}

cell() {  # FILE WORDS
    printf '<td><img src="images/engines/%s.jpg" width="420" alt="%s"><br>%s</td>\n' "$1" "$2" "$2"
}

# The truth and all engines, three to a row.
crop() {  # NAME SCENE X Y WORDS...
    name=$1 scene=$2 x=$3 y=$4
    shift 4
    for who in truth $engines; do
        cut "$tmp/$scene-$who.png" "$x" "$y" "$tmp/cut-$who.png"
    done
    oiiotool "$tmp/cut-truth.png" "$tmp/cut-layers.png" "$tmp/cut-scatter.png" "$tmp/cut-gather.png" \
        "$tmp/cut-hexagon.png" "$tmp/cut-gaussian.png" --mosaic:pad=4 3x2 --compression jpeg:92 -o "images/crops/$name.jpg"
    printf '**%s** (`%s`, %s, %s)\n\n![%s](images/crops/%s.jpg)\n\n' "$*" "$scene" "$x" "$y" "$*" "$name"
}

# The truth, then one, two and three surfaces of each pixel known.
surfaces() {  # NAME SCENE X Y WORDS...
    name=$1 scene=$2 x=$3 y=$4
    shift 4
    for who in truth best two three; do
        cut "$tmp/$scene-$who.png" "$x" "$y" "$tmp/cut-$who.png"
    done
    oiiotool "$tmp/cut-truth.png" "$tmp/cut-best.png" "$tmp/cut-two.png" "$tmp/cut-three.png" --mosaic:pad=4 4x1 \
        --compression jpeg:92 -o "images/crops/$name.jpg"
    printf '**%s** (`%s`, %s, %s)\n\n![%s](images/crops/%s.jpg)\n\n' "$*" "$scene" "$x" "$y" "$*" "$name"
}

# "Before" is a picture kept from commit 38b9469. "After", and the truth (or the input if there is none), are made anew.
before() {  # NAME SCENE X Y OPTIONS 'WORDS'
    name=$1 scene=$2 x=$3 y=$4
    shift 4
    options=
    while [ $# -gt 1 ]; do
        options="$options $1"
        shift
    done
    # shellcheck disable=SC2086
    "$hyperfocal" "images/$scene.exr" -o "$tmp/after.png" $options
    third=truth
    case $options in *--range* | *--far-end*) third=input ;; esac
    oiiotool "images/before/$name.png" --resize:filter=box 320x240 -o "$tmp/cut-before.png"
    cut "$tmp/after.png" "$x" "$y" "$tmp/cut-after.png"
    cut "$tmp/$scene-$third.png" "$x" "$y" "$tmp/cut-third.png"
    oiiotool "$tmp/cut-before.png" "$tmp/cut-after.png" "$tmp/cut-third.png" --mosaic:pad=4 3x1 --compression jpeg:92 \
        -o "images/crops/before-$name.jpg"
    printf '**%s** (`%s`, %s, %s; `%s`): before, after, %s.\n\n![%s](images/crops/before-%s.jpg)\n\n' "$1" "$scene" "$x" \
        "$y" "${options# }" "$third" "$1" "$name"
}

# The README's second picture is the demo's.
"$hyperfocal" images/lights.exr -o images/lights-after.png

for scene in lights fence foliage; do
    # The truth has no depth, and nothing is to be blurred: copy it.
    "$hyperfocal" "images/$scene.truth.exr" --depth-file "images/$scene.exr" --focus 1 --range inf -o "$tmp/$scene-truth.png"
    "$hyperfocal" "images/$scene.exr" --focus 1 --range inf -o "$tmp/$scene-input.png"
    for engine in $engines; do
        "$hyperfocal" "images/$scene.exr" -o "$tmp/$scene-$engine.png" --engine "$engine"
    done
    set -- "images/$scene.exr" --layers-quality best
    "$hyperfocal" "$@" -o "$tmp/$scene-best.png"
    if [ "$scene" != lights ]; then
        "$hyperfocal" "$@" -o "$tmp/$scene-two.png" --peel "images/$scene.peel1.exr"
        "$hyperfocal" "$@" -o "$tmp/$scene-three.png" --peel "images/$scene.peel1.exr" --peel "images/$scene.peel2.exr"
    fi
    for who in truth input $engines; do
        oiiotool "$tmp/$scene-$who.png" --ch R,G,B --resize 640x360 --compression jpeg:88 -o "images/engines/$scene-$who.jpg"
    done
done

{
    cat <<'MARKDOWN'
# The engines beside the truth

Three scenes, each ray-traced twice: with a pinhole, which is the engines' input, and with an open lens, which is the truth.
The camera is that of the EXR header. The inputs are EXR files in linear light that nothing clips; the figures do not hold for
a clipped 8-bit picture. `sh images/page.sh` makes this page, its pictures and its figures.

Which one:

- **layers** where the picture counts. It un-mixes anti-aliased edges, fills in what objects hide and is the closest to the
  truth. It is the command's default.
- **scatter** for the same bits on every machine.
- **gather** for a renderer with a budget in milliseconds, and for a draft. It works at half resolution and blends two kernels
  instead of drawing each pixel's own; that costs some sharpness on `lights`.
- **hexagon** for hexagonal highlights.
- **gaussian** for a soft preview: its blur is equally wide everywhere, so it does not follow a lens.

Look at the rims of near bars before the sharp box (`fence`), at leaves before leaves (`foliage`), and at discs beside the
head (`lights`).

Distance from the truth, PSNR in dB of the displayed picture, and milliseconds of a frame of 1280 x 720
(`hyperfocal-bench truth`):

MARKDOWN
    "$bench" truth | sed 's/^/    /;s/ *$//'
    printf '\n## Close up\n\nFour times enlarged. Above: the truth, layers, scatter. Below: gather, hexagon, gaussian.\n\n'
    crop discs lights 940 330 Discs of light beside the sharp head
    crop bar lights 90 440 A near bar before lights
    crop box fence 740 180 Near bars before the sharp box and the far wall
    crop cross fence 430 125 Where bars cross
    crop floor fence 150 640 Near bars before the chequered floor
    crop leaves foliage 370 60 Leaves before leaves
    crop ball foliage 660 170 A near leaf before the sharp ball
    cat <<'MARKDOWN'
## More than one surface

One picture does not show what stands behind. With the second and the third surface of each pixel (`--peel FILE`, or a deep
picture) little is left to guess. Four times enlarged: the truth; one surface, two and three, in the quality `best`.

MARKDOWN
    surfaces surfaces-box fence 740 180 A near bar ends before the box and the far wall
    surfaces surfaces-floor fence 150 640 Near bars before the chequered floor
    surfaces surfaces-leaves foliage 370 60 Leaves before leaves
    surfaces surfaces-ball foliage 660 170 A near leaf before the sharp ball
    printf 'PSNR in dB and milliseconds of a frame, standard and best (`hyperfocal-bench truth --peels`):\n\n'
    for quality in standard best; do
        "$bench" truth --peels --engine layers --layers-quality $quality | sed 's/^/    /;s/ *$//'
        echo
    done
    for scene in lights fence foliage; do
        printf '## %s\n\n<table><tr>\n' "$scene"
        cell "$scene-truth" "$scene, ray-traced"
        cell "$scene-layers" "layers"
        printf '</tr><tr>\n'
        cell "$scene-scatter" "scatter"
        cell "$scene-gather" "gather"
        printf '</tr><tr>\n'
        cell "$scene-hexagon" "hexagon"
        cell "$scene-gaussian" "gaussian"
        printf '</tr><tr>\n'
        cell "$scene-input" "the input"
        printf '</tr></table>\n\n'
    done
    printf '## Before and after\n\nThe left pictures show faults of commit 38b9469, the middle ones the same places now.\n\n'
    # The range model of the demo: the subject between 3.5 and 6, full blur before 1.5 and behind 10.
    range='--focus 5 --near-begin 1.5 --near-end 3.5 --far-begin 6 --far-end 10'
    # shellcheck disable=SC2086
    {
before gather-lens lights 940 330 --engine gather 'gather with a lens: blur was cut to 12 pixels at 1080 lines'
before gather-fence fence 740 180 --engine gather 'gather with a lens, near bars'
before gather-small lights 1000 165 --engine gather $range --max-radius 6 'gather: small highlights were square'
before gather-large lights 1000 165 --engine gather $range --max-radius 16 'gather: large ones a cross'
before gather-focus lights 940 330 --engine gather $range --max-radius 16 'gather: light from behind painted over what is in focus'
before scatter-band lights 480 190 --engine scatter 'scatter: a dark band inside the sharp head'
before scatter-cross fence 430 125 --engine scatter 'scatter: stars and seams where bars cross'
before scatter-half fence 740 180 --engine scatter --resolution half 'scatter at half resolution: blocks and missing pieces'
before hexagon-notch lights 990 430 --engine hexagon 'hexagon: dark notches at the corners of bright hexagons'
before hexagon-head lights 660 80 --engine hexagon 'hexagon: feathers above the head'
    }
} | sed '$d' >"$tmp/page.md"
mv "$tmp/page.md" ENGINES.md
