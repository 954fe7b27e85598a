#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Print a hash of the pixels of 77 renders over engines, options, storages and instruction sets. Two builds whose lists
# are equal make the same pictures to the bit:
#     tests/support/hashes.sh old/src/tools/cli/hyperfocal > old.txt; tests/support/hashes.sh build/src/tools/cli/hyperfocal | diff old.txt -
# Needs oiiotool (Debian: openimageio-tools).
set -u
program=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Arguments: the name of a picture, then options.
render()
{
    scene=$1
    shift
    if "$program" "$root/images/$scene.exr" -o "$work/out.exr" --compression none "$@" >/dev/null 2>"$work/error"; then
        hash=$(oiiotool --hash --info "$work/out.exr" | sed -n 's/.*SHA-1: *//p')
    else
        hash=$(head -n 1 "$work/error")
    fi
    echo "$hash  $scene $*"
    rm -f "$work/out.exr"
}

look='--focus 5 --range 3'
for isa in scalar sse4.1 avx2 avx512; do
    render lights --engine gather $look --isa $isa
    render lights --engine gather $look --isa $isa --deterministic
    render fence --engine gather $look --isa $isa --storage half --max-radius 16
    render foliage --engine gather $look --isa $isa --storage chapter --max-radius 9.5
    render foliage --engine hexagon --isa $isa --max-radius 20
    render lights --engine scatter --isa $isa --max-radius 24
    render fence --engine gaussian --isa $isa
    render fence --engine layers --isa $isa
done
for options in --karis --per-pixel-kernel --bicubic '--fill mean' '--fill none' '--blend smoothstep' --faithful \
    '--faithful --storage chapter' '--rings 2' '--aperture ngon:6' '--aperture ngon:5:0:20' '--strength 0.1' \
    '--strength 0.6' '--strength 0' '--max-radius 0' '--max-radius 40' '--no-skip' '--threads 1' '--range inf'; do
    render lights --engine gather $look $options
done
for options in '' '--storage half' '--fill mean' '--fill none' '--fill open' '--downsample linear' '--karis --bicubic' \
    '--rings 2 --aperture ngon:5' '--faithful'; do
    render lights --engine chapter $look $options
done
for options in '--resolution half' '--uniform' '--aperture ngon:6:0:15' '--max-radius 5'; do
    render foliage --engine hexagon --focus 4 --range 2 $options
done
for options in '--resolution half' '--aperture ngon:5:0.4:10' '--aperture ring:0.4' '--chromatic 0.1' '--cat-eye 0.7' \
    '--squeeze 1.6'; do
    render fence --engine scatter --focus 6 --range 3 $options
done
for options in '--sigma 8' '--iterations 9' '--resolution quarter'; do
    render foliage --engine gaussian --focus 4 $options
done
for options in '--layers-quality draft' '--layers-quality best' '--chromatic 0.1' '--aperture ngon:5:0.4:10'; do
    render lights --engine layers $options
done
