#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Make ENGINES.md: three scenes through all engines beside the ray-traced truth, as pictures and as figures.
#     images/page.sh [BUILD-FOLDER]
set -eu
cd "$(dirname "$0")/.."
build=${1:-build}
hyperfocal=$build/src/cli/hyperfocal
bench=$build/bench/hyperfocal-bench
engines="layers scatter gather hexagon gaussian"
mkdir -p images/engines

picture() {  # SCENE ENGINE
    "$hyperfocal" "images/$1.exr" -o "images/engines/$1-$2.jpg" --engine "$2"
}

cell() {  # FILE WORDS
    printf '<td><img src="images/engines/%s.jpg" width="420" alt="%s"><br>%s</td>\n' "$1" "$2" "$2"
}

for scene in lights fence foliage; do
    # A copy, as there is no blur: the truth has no depth of its own.
    "$hyperfocal" "images/$scene.truth.exr" --depth-file "images/$scene.exr" --focus 1 --range inf \
        -o "images/engines/$scene-truth.jpg"
    "$hyperfocal" "images/$scene.exr" --focus 1 --range inf -o "images/engines/$scene-input.jpg"
    for engine in $engines; do
        picture "$scene" "$engine"
    done
done

{
    echo '# The engines beside the truth'
    echo
    echo 'Three scenes, traced once with a pinhole and once with an open lens, and what each engine makes of the first.'
    echo 'The camera is that of the EXR header. Made by `images/page.sh`.'
    echo
    echo 'Which one: **layers** where the picture counts; it takes edges apart, fills in what objects hide and is the closest'
    echo 'to the truth; the command does it by default. **scatter** for the same bits everywhere. **gather** for a renderer with a budget in milliseconds:'
    echo 'half resolution and a few kernels, each pixel between the two that are its own, cost it some sharpness on `lights`.'
    echo '**hexagon** for its look. **gaussian** for a soft preview: it does not follow a lens. Look at the'
    echo 'rims of near bars before the sharp box (`fence`), at leaves before leaves (`foliage`), and at discs beside the head (`lights`).'
    echo
    echo 'Distance from the truth, PSNR in dB of the displayed picture, and milliseconds of a frame of 1280 x 720'
    echo '(`hyperfocal-bench truth`):'
    echo
    "$bench" truth | sed 's/^/    /'
    for scene in lights fence foliage; do
        printf '\n## %s\n\n<table><tr>\n' "$scene"
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
        printf '</tr></table>\n'
    done
} >ENGINES.md
