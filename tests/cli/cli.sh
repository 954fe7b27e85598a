#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The command, run as a user does: what it accepts, what it refuses and how, and which files it leaves behind.
# Usage: cli.sh PROGRAM SOURCE_ROOT. Inputs are made here with python3 and taken from SOURCE_ROOT/images; tests whose
# input cannot be had are skipped and counted.
. "$(dirname "$0")/common.sh"

# ---- what needs no picture
run --help=all
[ "$status" -eq 0 ] && [ ! -s "$dir/err" ] && contains "$dir/out" "--near-begin" && contains "$dir/out" "Default"
result "--help=all" $?
cp "$dir/out" "$dir/help"
run -h
cp "$dir/out" "$dir/short"
run --help
[ "$status" -eq 0 ] && cmp -s "$dir/out" "$dir/short"
result "-h is --help" $?
[ "$(wc -l <"$dir/short")" -le 60 ]
result "--help fits a screen" $?
tr -s " \n" " " <"$dir/short" >"$dir/flat"
contains "$dir/flat" "draft: --engine" && contains "$dir/flat" "Default view."
result "--help tells what --quality chooses, and defaults" $?
for option in output focus focus-at range strength near-begin near-end far-begin far-end fstop focal-length \
    sensor-width world-unit max-radius depth-channel depth-file depth-type near far views aperture karis \
    per-pixel-kernel bicubic fill blend threads isa no-skip json dump-passes compression dry-run version engine \
    faithful storage deterministic explain explain-image budget-ms rings resolution chromatic cat-eye squeeze uniform \
    iterations sigma highlight-gain highlight-threshold; do
    contains "$dir/help" "--$option"
    result "--help tells of --$option" $?
done
[ "$(awk 'length($0) > 80' "$dir/help" | wc -l)" -eq 0 ]
result "--help fits 80 columns" $?
# The man page is made from the same table: each option has an entry, and man can format the page.
run --help=man
grep -q '^\.TH hyperfocal 1' "$dir/out" && grep -q '^\.SH OPTIONS' "$dir/out" &&
    [ "$(grep -c '^\.B .*\\-\\-[a-z]' "$dir/out")" -eq "$(grep -Ec '^( {6}|  -., )--' "$dir/help")" ]
result "--help=man" $?
if command -v groff >/dev/null; then
    [ -z "$(groff -man -Tascii -ww "$dir/out" 2>&1 >/dev/null)" ]
    result "groff sets the man page without a warning" $?
fi
run --version
[ "$status" -eq 0 ] && [ ! -s "$dir/err" ] && grep -Eq '^hyperfocal [0-9]+\.[0-9]+\.[0-9]+' "$dir/out"
result "--version" $?
if command -v ldd >/dev/null; then
    ! ldd "$program" | grep -qi -e OpenImageIO -e stdc++
    result "the program does not load OpenImageIO" $?
fi
if [ -w /dev/full ]; then
    "$program" --help >/dev/full 2>"$dir/err"
    status=$? command="--help >/dev/full"
    [ "$status" -eq 3 ]
    result "--help to a full device fails" $?
fi

bad 1 "INPUT|--help"
bad 1 "INPUT" -o o.exr
bad 1 "a.exr|-o" a.exr
bad 1 "a.exr|b.png|write -o before it" a.exr b.png --focus 3
bad 1 "o.exr|####" a.exr b.exr -o o.exr
bad 1 "--frames|####|a.exr" a.exr -o o.exr --frames=1-2
bad 1 "o.%V.exr|a.exr is one file|--views" a.exr -o o.%V.exr --focus 3
bad 1 "--bogus|--help" a.exr -o o.exr --bogus
bad 1 "--bogus=3|--help" a.exr -o o.exr --bogus=3
bad 1 "-q|--help" -q a.exr -o o.exr
for option in --qualities=high --frame=1-2 --resumed; do
    bad 1 "$option|--help" a.exr -o o.exr $option
done
bad 1 "-o" a.exr -o
bad 1 "-o|''" a.exr -o ""
bad 1 "-o" a.exr -o --focus
bad 1 "--karis|yes" a.exr -o o.exr --karis=yes
bad 1 "--dry-run|1" a.exr --dry-run=1
bad 1 "--focus" a.exr -o o.exr --focus --range 3
for value in abc 3x "" " 3" nan -1 1e999 -inf 0x 1,5; do
    bad 1 "--range|'$value'" a.exr -o o.exr --range "$value"
    bad 1 "--focus|'$value'" a.exr -o o.exr --focus="$value"
    bad 1 "--threads|'$value'" a.exr -o o.exr --threads "$value"
done
for option in strength near-begin near-end far-begin far-end max-radius; do
    bad 1 "--$option|'-1'" a.exr -o o.exr --$option -1
    bad 1 "--$option|'inf'" a.exr -o o.exr --$option inf
done
for option in focus fstop focal-length sensor-width world-unit near far; do
    bad 1 "--$option|'0'|more than 0" a.exr -o o.exr --$option 0
done
for value in -0 0.0 1e-320; do
    bad 1 "--focus|'$value'|more than 0" a.exr -o o.exr --focus $value
done
for option in focal-length sensor-width world-unit near; do
    bad 1 "--$option|'inf'" a.exr -o o.exr --$option inf
done
bad 1 "--strength|'1.01'|0 to 1" a.exr -o o.exr --strength 1.01
bad 1 "--max-radius|'2049'|0 to 2048" a.exr -o o.exr --max-radius 2049
bad 1 "--threads|'257'" a.exr -o o.exr --threads 257
bad 1 "--threads|'1.5'" a.exr -o o.exr --threads 1.5
bad 1 "--threads|'99999999999999999999'" a.exr -o o.exr --threads 99999999999999999999
for value in 3 "3," ,3 a,b 3,4,5 3.5,4 "3, 4" 99999999999,1; do
    bad 1 "--focus-at|'$value'" a.exr -o o.exr --focus-at "$value"
done
# Units: which ones are accepted, and the suggestion for others.
bad 1 "--focus|'6ft'|units are m, cm and mm" a.exr -o o.exr --focus 6ft
bad 1 "--range|'6ft'|units are m, cm and mm" a.exr -o o.exr --range 6ft
bad 1 "--fstop|'2.8x'|f/2.8" a.exr -o o.exr --fstop 2.8x
bad 1 "--focus 1.2|did you mean --focus 1.2m?" --focus 1.2 m a.exr -o o.exr
bad 1 "--focal-length 50|did you mean --focal-length 50mm?" a.exr --focal-length 50 mm -o o.exr
bad 1 "--focus 6|'ft' is no unit here|m, cm and mm" a.exr --focus 6 ft -o o.exr
bad 1 "--fstop 2|'m' is no unit here" a.exr --fstop 2 m -o o.exr
bad 1 "-fstop|did you mean --fstop?" a.exr -o o.exr -fstop 2
bad 1 "-focus=3|did you mean --focus?" a.exr -o o.exr -focus=3
bad 1 "'hexagon'|did you mean ngon:6?" a.exr -o o.exr --aperture hexagon
bad 1 "'circle'|did you mean disc?" a.exr -o o.exr --aperture circle
bad 1 "--focus|'middle'|center" a.exr -o o.exr --focus middle
bad 1 "--focus|--focus-at" a.exr -o o.exr --focus 3 --focus-at 1,2
bad 1 "--engine|'lager'|gather" a.exr -o o.exr --engine lager
bad 1 "--storage|'double'|float, half, packed" a.exr -o o.exr --storage double
bad 1 "--storage|'fl'" a.exr -o o.exr --storage fl
bad 1 "--fill|'min'|max, mean, none" a.exr -o o.exr --fill min
bad 1 "--blend|'cubic'|linear, smoothstep" a.exr -o o.exr --blend cubic
bad 1 "--isa|'avx9'|scalar" a.exr -o o.exr --isa avx9
bad 1 "--depth-type|'z'|ndc-d3d" a.exr -o o.exr --depth-type z
bad 1 "--compression|'lzma'|piz" a.exr -o o.exr --compression lzma
bad 1 "--compression|zip|o.png" a.exr -o o.png --compression zip
for value in ngon ngon: ngon:2 ngon:17 ngon:x ngon:6:x ngon:6:0:x ngon:6:0:1:2 ngon:6: ngon:6:0:inf ngon:6:0.5 \
    ring:0.5 star.png; do
    bad 1 "--aperture|'$value'" a.exr -o o.exr --engine gather --aperture $value
done
bad 1 "--aperture|ring:0.5|disc or ngon" a.exr -o o.exr --engine gather --aperture ring:0.5
for value in 0 -1 inf nan x; do
    bad 1 "--budget-ms|'$value'" a.exr -o o.exr --budget-ms $value
done
bad 1 "--rings|'65'" a.exr -o o.exr --rings 65
bad 1 "--chromatic|'0.6'" a.exr -o o.exr --engine scatter --chromatic 0.6
bad 1 "--chromatic|scatter|gather" a.exr -o o.exr --engine gather --chromatic 0.1
bad 1 "--engine|--quality" a.exr -o o.exr --engine gather --quality draft
bad 1 "--rings|--max-error" a.exr -o o.exr --rings 3 --max-error 0.05
bad 1 "--quality|--max-error" a.exr -o o.exr --quality draft --max-error 0.05
bad 1 "--max-error|'0'" a.exr -o o.exr --max-error 0
bad 1 "--max-error|'1.5'" a.exr -o o.exr --max-error 1.5
bad 1 "--spacing|layers|scatter" a.exr -o o.exr --spacing 3 --engine scatter
bad 1 "--quality|--layers-quality" a.exr -o o.exr --quality high --layers-quality best
bad 1 "--resolution|scatter|layers" a.exr -o o.exr --resolution half
bad 1 "--quality|'drafty'|draft?" a.exr -o o.exr --quality drafty
bad 1 "--focsu|--focus?" a.exr -o o.exr --focsu 3
bad 1 "--engine|'scater'|scatter?" a.exr -o o.exr --engine scater
bad 1 "--fstop|'f/x'" a.exr -o o.exr --fstop f/x
bad 1 "--focus|'3km'" a.exr -o o.exr --focus 3km
bad 1 "--max-radius|'3mm'" a.exr -o o.exr --max-radius 3mm
bad 1 "--highlight-gain|0.5|1 to 64" a.exr -o o.exr --highlight-gain 0.5
bad 1 "--highlight-threshold|1|0 to 0.99" a.exr -o o.exr --highlight-gain 2 --highlight-threshold 1
bad 1 "--highlight-threshold|--highlight-gain" a.exr -o o.exr --highlight-threshold 0.5
bad 1 "--depth-of-field|--fstop" a.exr -o o.exr --depth-of-field 3 --fstop 2
bad 1 "--verbose|--quiet" a.exr -o o.exr --verbose --quiet
bad 1 "--cat-eye|scatter|hexagon" a.exr -o o.exr --engine hexagon --cat-eye 0.1
bad 1 "--squeeze|scatter" a.exr -o o.exr --engine gather --squeeze 2
bad 1 "--uniform|hexagon" a.exr -o o.exr --uniform
bad 1 "--iterations|gaussian" a.exr -o o.exr --iterations 4
bad 1 "--sigma|gaussian" a.exr -o o.exr --sigma 4
bad 1 "--resolution|hexagon" a.exr -o o.exr --engine gather --resolution half
bad 1 "--resolution quarter|gaussian|scatter" a.exr -o o.exr --engine scatter --resolution quarter
bad 1 "--karis|gather|scatter" a.exr -o o.exr --engine scatter --karis
bad 1 "--storage|gather|hexagon" a.exr -o o.exr --engine hexagon --storage half
bad 1 "--explain-image|''" a.exr -o o.exr --explain-image ""
for value in ngon:2 ngon:17 ngon:6:1.5:3 ring:1 ring:x; do
    bad 1 "--aperture|$value" a.exr -o o.exr --engine scatter --aperture $value
done
bad 1 "--range|--fstop" a.exr -o o.exr --range 3 --fstop 2
bad 1 "--strength|--focal-length" a.exr -o o.exr --focal-length 50 --strength 1
bad 1 "--far-end|--fstop" a.exr -o o.exr --far-end 9 --fstop 2
bad 1 "--near-begin 5|--near-end 4" a.exr -o o.exr --near-begin 5 --near-end 4
bad 1 "--far-begin 5|--far-end 4" a.exr -o o.exr --far-begin 5 --far-end 4
bad 1 "--near-end 9|--far-begin 5" a.exr -o o.exr --near-end 9 --far-begin 5 --far-end 12
for type in ndc-d3d ndc-gl ndc-reversed; do
    bad 1 "$type|--near" a.exr -o o.exr --depth-type $type --far 9
    bad 1 "$type|--far" a.exr -o o.exr --depth-type $type --near 9
    bad 1 "--near 9|--far 3" a.exr -o o.exr --depth-type $type --near 9 --far 3
done
bad 1 "--near|view" a.exr -o o.exr --near 1
bad 1 "--near 9|--far 3" a.exr -o o.exr --engine gaussian --near 9 --far 3
bad 1 "--near|coc" a.exr -o o.exr --engine gaussian --depth-type coc --near 1
bad 1 "--focus center|coc" a.exr -o o.exr --depth-type coc --focus center
bad 1 "--focus-at|coc" a.exr -o o.exr --depth-type coc --focus-at 1,2
bad 1 "--fstop|coc" a.exr -o o.exr --depth-type coc --fstop 2
bad 1 "--json|a.exr" --json a.exr b.exr -o o.exr
bad 1 "--json|o.txt" a.exr -o o.txt --json o.txt
bad 1 "--help|'foo'|all and man" --help=foo
bad 1 "--keys-blend|--keys" a.exr -o o.exr --keys-blend smooth
bad 1 "--focus-smooth|--focus center" a.exr -o o.exr --focus 3 --focus-smooth 3
bad 1 "there are 2 INPUTs, a.exr and extra" a.exr -o o.exr --focus 3 extra
export HYPERFOCAL_ISA=sse9
bad 1 "HYPERFOCAL_ISA is sse9, which is no instruction set|sse4.1" missing.exr -o o.exr --focus 3
unset HYPERFOCAL_ISA
bad 1 "missing.exr|No such file" missing.exr -o o.exr --focus 3
bad 1 "missing.exr|No such file" missing.exr --dry-run --focus 3
bad 1 "missing.####.exr|no such file" missing.####.exr -o o.####.exr --focus 3
bad 1 "no/such/o.exr" missing.exr -o no/such/o.exr --focus 3
bad 1 "-o|.|directory" missing.exr -o . --focus 3
bad 1 "-o|/dev/null" missing.exr -o /dev/null --focus 3
# Other engines refuse an engine's option and name it. Its own engine accepts it: the command then fails at the file.
while read -r engines option; do
    for engine in layers scatter gather hexagon gaussian chapter; do
        # shellcheck disable=SC2086
        case ,$engines, in
        *,$engine,*)
            run missing.exr -o o.exr --engine $engine $option
            contains "$dir/err" "missing.exr: cannot open" ;;
        *)
            run missing.exr -o o.exr --engine $engine $option
            [ "$status" -eq 1 ] && contains "$dir/err" "${option%% *} is of use only with --engine ${engines%%,*}" &&
                contains "$dir/err" "not $engine" ;;
        esac
        result "$option with $engine" $?
    done
done <<'OPTIONS'
layers,scatter --chromatic 0.1
layers,scatter --cat-eye 0.1
layers,scatter --squeeze 2
hexagon --uniform
gaussian --iterations 4
gaussian --sigma 3
hexagon,scatter,gaussian --resolution half
chapter,gather --fill mean
chapter,gather --rings 2
chapter,gather --downsample point
chapter,gather --division newton
gather,chapter --karis
gather,chapter --per-pixel-kernel
gather,chapter --bicubic
gather,chapter --storage half
chapter,gather,gaussian --faithful
layers --layers-quality high
layers --spacing 2
layers --half-from 8
layers --quarter-from 30
layers --no-unmix
layers --no-hidden
layers --no-highlights
OPTIONS
for isa in scalar sse4.1 avx2 avx512 neon; do  # one of x86 and ARM is always missing
    run missing.exr -o o.exr --isa $isa
    if ! contains "$dir/err" "cannot open"; then
        bad 1 "--isa|$isa" missing.exr -o o.exr --isa $isa
    fi
done

# ---- small pictures
picture_tests() {
    bad 3 "garbage.exr" garbage.exr -o o.exr --focus 3
    bad 3 "short.exr" short.exr -o o.exr --focus 3
    bad 3 "flat.exr|depth|B, G, R" flat.exr -o o.exr --focus 3
    bad 1 "plain.exr|'W'|Z" plain.exr -o o.exr --focus 3 --depth-channel W
    bad 3 "deep.exr|my.depth|other.depth" deep.exr -o o.exr --focus 3
    bad 1 "missing.exr" flat.exr -o o.exr --focus 3 --depth-file missing.exr
    bad 3 "small.exr" flat.exr -o o.exr --focus 3 --depth-file small.exr
    bad 1 "no/such" plain.exr -o o.exr --focus 3 --dump-passes no/such/dir
    bad 1 "plain.exr" plain.exr -o o.exr --focus 3 --dump-passes plain.exr
    bad 1 "no/such/s.json" plain.exr -o o.exr --focus 3 --json no/such/s.json

    bad 1 "plain.exr|--focus" plain.exr -o o.exr
    bad 1 "plain.exr|--focus" plain.exr -o o.exr --range 3
    bad 1 "plain.exr|--focus" plain.exr -o o.exr --fstop 2 --focal-length 50
    bad 1 "plain.exr|--focal-length|--fstop 2" plain.exr -o o.exr --focus 3 --fstop 2
    bad 1 "plain.exr|--fstop|--focal-length 50" plain.exr -o o.exr --focus 3 --focal-length 50
    bad 1 "plain.exr|--near-begin 9|focus 3" plain.exr -o o.exr --focus 3 --near-begin 9
    bad 1 "plain.exr|--far-end 2|focus 3" plain.exr -o o.exr --focus 3 --far-end 2
    bad 1 "plain.exr|--focus-at 0,35|no surface" plain.exr -o o.exr --focus-at 0,35
    bad 1 "plain.exr|--focus-at 64,0|outside" plain.exr -o o.exr --focus-at 64,0
    bad 1 "plain.exr|--focus-at -1,0|outside" plain.exr -o o.exr --focus-at -1,0
    bad 1 "offset.exr|--focus-at 0,0|outside" offset.exr -o o.exr --focus-at=0,0
    bad 1 "stereo.exr|'up'|right|left" stereo.exr -o o.exr --focus 3 --views left,up
    bad 1 "stereo.exr|''" stereo.exr -o o.exr --focus 3 --views left,
    bad 1 "plain.exr|'left'" plain.exr -o o.exr --focus 3 --views left
    bad 3 "half-stereo.exr|left|depth" half-stereo.exr -o o.exr --focus 3

    bad 1 "lens.exr|--blend smoothstep|lens" lens.exr -o o.exr --blend smoothstep
    good lens.exr -o o.exr --blend smoothstep --range 2
    rm -f o.exr

    # Which model is chosen.
    plan "model range|focus 3 from --focus|range 1.5" plain.exr --focus 3
    plan "model range|focus 4 from header|range 2" focus.exr
    plan "model range|focus 2 from header" focus.exr --world-unit 2
    plan "model range|range 9" lens.exr --range 9
    plan "model range" lens.exr --strength 0.5
    plan "model range" lens.exr --near-end 2
    plan "model range|focus 3 from --focus" stop.exr --focus 3
    plan "model lens|f/2|focal length 50|sensor 36|focus 4 from header" lens.exr
    plan "model lens|focus 3 from --focus" lens.exr --focus 3
    plan "model lens|f/8|focal length 50" lens.exr --fstop 8
    plan "model lens|f/2|focal length 85|sensor 24" lens.exr --focal-length 85 --sensor-width 24
    plan "model lens|f/2|focal length 35" stop.exr --focal-length 35
    plan "model lens|f/inf" lens.exr --fstop inf
    plan "model coc" lens.exr --depth-type coc
    plan "model coc" plain.exr --depth-type coc
    for focus in inf infinity; do
        plan "model lens|focus inf from --focus" plain.exr --focus $focus --fstop 2 --focal-length 50
        bad 1 "--focus inf is for a lens" plain.exr -o o.exr --focus $focus
        bad 1 "--focus inf is for a lens" plain.exr -o o.exr --focus $focus --range 3
    done
    run plain.exr -o o.exr --focus inf --fstop 0.1 --focal-length 50 --json
    [ "$status" -eq 0 ] && [ ! -s "$dir/err" ] && contains "$dir/out" '"focus": "inf"' && contains "$dir/out" '"far_share": 0,'
    result "a lens focused at infinity" $?
    rm -f o.exr
    plan "focus 3 from --focus-at" plain.exr --focus-at 20,5
    plan "focus 5 from --focus center" plain.exr --focus center
    plan "focus 2 from --focus-at" offset.exr --focus-at=-1,20
    plan "focus 6 from --focus center" offset.exr --focus center
    plan "view right|view left" stereo.exr --focus 3
    plan "view left|focus 3 from --focus-at" stereo.exr --focus-at 40,20 --views left
    plan "depth my.depth" deep.exr --focus 3 --depth-channel my.depth
    plan "depth depth.exr" flat.exr --focus 3 --depth-file depth.exr
    plan "ndc-reversed" plain.exr --focus 3 --depth-type ndc-reversed --near 0.1 --far inf
    plan "model range|the picture's centre" plain.exr --engine gaussian
    plan "model range|the picture's centre" plain.exr --engine gaussian --near 0.5 --far 20
    run plain.exr -o near.exr --engine gaussian --range 3 && run plain.exr -o far.exr --engine gaussian --far 20 &&
        run plain.exr -o none.exr --engine gaussian && [ "$status" -eq 0 ] && ! cmp -s far.exr none.exr &&
        ! cmp -s near.exr none.exr
    result "--engine gaussian focuses by itself, and measures by --far" $?
    before=$(ls -lR .)
    run plain.exr -o o.exr --focus 3 --dry-run --dump-passes passes
    [ "$status" -eq 0 ] && [ "$(ls -lR .)" = "$before" ] && contains "$dir/out" "o.exr"
    result "--dry-run writes nothing" $?
    grep -q 'expected: [1-9][0-9]* MiB, [0-9][0-9]* ms, defocus [0-9]* ms of it' "$dir/out"
    result "--dry-run says what memory and time to expect" $?
    contains "$dir/err" "--dump-passes passes: a dry run renders nothing"
    result "--dry-run says that it dumps no passes" $?
    run plain.exr -o ./plain.exr --focus 3 --dry-run
    [ "$status" -eq 0 ] && contains "$dir/out" "would write ./plain.exr, over the input" &&
        contains "$dir/err" "OUTPUT ./plain.exr is INPUT"
    result "--dry-run says what it would write over" $?
    run plain.exr --focus center --focus-smooth 2 --stop-on-error --dry-run
    contains "$dir/err" "--stop-on-error does nothing for one picture" &&
        contains "$dir/err" "--focus-smooth 2 does nothing for one picture"
    result "what only a shot has a use for" $?
    run plain.exr --focus 3 --range inf --dry-run
    contains "$dir/err" "nothing is blurred"
    result "--dry-run warns as rendering would" $?
    good plain.exr --focus 3 --dry-run --json s.json
    json_valid s.json && contains s.json '"dry_run": true' && contains "$dir/out" "would write nothing"
    result "--dry-run --json FILE writes FILE" $?
    rm -f s.json
    run plain.exr --focus 3 --dry-run --json
    [ "$status" -eq 0 ] && json_valid "$dir/out" && contains "$dir/out" '"dry_run": true' &&
        grep -q '"expected_memory": [1-9]' "$dir/out"
    result "--dry-run --json" $?

    # It succeeds, and says what it did.
    before=$(ls -A)
    good plain.exr -o o.exr --focus 3
    [ -s o.exr ] && [ ! -s "$dir/out" ]
    result "a picture is written, and nothing said" $?
    mv o.exr ../o.exr && [ "$(ls -A)" = "$before" ]
    result "no temporary file is left" $?
    good plain.exr --output=o.exr --focus=3 --strength=0
    good -o o.exr --focus 3 -- plain.exr
    good plain.exr -o o.exr --focus 3 --fstop inf --focal-length 50
    # Units in any order, depth of field, and defaults.
    plan "focus 1.2 from --focus|f/2.8|focal length 50 mm" plain.exr --focus 1.2m --fstop f/2.8 --focal-length 5cm
    for stop in f2.8 F2.8 F/2.8 f/2.8; do
        plan "f/2.8" plain.exr --focus "1.2 m" --fstop $stop --focal-length "50 mm"
    done
    plan "focus 1.2 from" plain.exr --focus "1.2 m" --fstop 2 --focal-length 50
    plan "engine layers|focus 12 from --focus|sensor 36 mm" plain.exr --focus 120cm --world-unit 0.1 --fstop 2 \
        --focal-length 50mm --sensor-width 0.036m
    plan "focus 3 |none from 2.5; far blur none up to 3.5" plain.exr --focus 3 --depth-of-field 1
    plan "engine chapter|rings of taps" plain.exr --focus 3 --engine chapter --max-radius 40
    # What only the chapter has makes the gather the chapter; what it has in common, or what the gather does anyway, does not.
    for option in faithful "fill max" "fill none" "fill open" "downsample linear" "division newton"; do
        # shellcheck disable=SC2086
        plan "engine chapter, as --engine gather with --${option%% *} is" plain.exr --focus 3 --engine gather --$option --explain
    done
    for option in "fill mean" "rings 2" karis "storage half" "division exact"; do
        # shellcheck disable=SC2086
        plan "engine gather, half resolution" plain.exr --focus 3 --engine gather --$option --explain
    done
    plan "engine chapter, 2 rings" plain.exr --focus 3 --engine chapter --rings 2 --explain
    plan "--quality draft chose --engine gather, step |expected: |measured 20" plain.exr --focus 3 --quality draft --explain
    # high was a name of best, and is in no help.
    run plain.exr --focus 3 --quality high --dry-run --explain
    [ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "--quality high chooses what best does" &&
        contains "$dir/out" "--quality best chose --engine layers" && ! contains "$dir/help" "standard|high"
    result "--quality high" $?
    # One blur of one width may do for a range, but not for a lens, nor for --quality draft.
    plan "--max-error 0.9 chose --engine gaussian" plain.exr --focus 3 --max-error 0.9 --explain --near 1 --far 60
    bad 1 "--near|--depth-type" plain.exr -o o.exr --focus 3 --quality draft --near 1 --far 60
    bad 1 "--near|--depth-type" plain.exr -o o.exr --focus 3 --quality draft --fstop 2 --focal-length 50mm --near 1 --far 60
    plan "engine gather|--max-error 0.9 chose --engine gather|passed over, the first because it does not reach" plain.exr --focus 3 \
        --max-error 0.9 --explain --fstop 2 --focal-length 50mm
    plan "engine gather|--max-error 0.9 chose --engine gather|passed over" plain.exr --max-error 0.9 --explain --depth-type coc
    plan "--max-error 0.9 chose --engine|, step 1 of" plain.exr --focus 3 --max-error 0.9 --explain
    plan "no setting errs as little" plain.exr --focus 3 --max-error 0.0001 --explain
    plan "--quality draft chose --engine" plain.exr --focus 3 --quality draft --explain --aperture ring:0.5
    plan "engine layers|best quality|slices (" plain.exr --focus 3 --engine layers --layers-quality best --max-radius 40 --explain
    run plain.exr -o o.exr --focus 3 --range 2 --verbose
    [ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "layers, focus 3" &&
        contains "$dir/err" "0 warnings"
    result "--verbose" $?
    run plain.exr -o o.exr --focus 3 --range 2 --max-error 0.0001 --verbose
    [ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 2 ] && contains "$dir/err" "errs as little as --max-error 0.0001" &&
        contains "$dir/err" "1 warning"
    result "an error that no setting keeps is a warning" $?
    good plain.exr --engine gather -o o.exr --focus 3 --range 2 --karis --per-pixel-kernel --bicubic --fill mean --blend smoothstep
    good plain.exr --engine gather -o o.exr --focus 3 --fill none --aperture ngon:6:0:15 --threads 2 --no-skip --storage half
    good plain.exr --engine gather -o o.exr --focus 3 --faithful --storage chapter --aperture disc --isa scalar
    good plain.exr --engine chapter -o whole.exr --focus 3 --faithful --storage chapter --aperture disc --isa scalar
    cmp -s o.exr whole.exr
    result "--engine gather --faithful is --engine chapter --faithful" $?
    good plain.exr -o o.exr --focus 3 --max-radius 0 --deterministic
    for engine in scatter layers; do
        good plain.exr -o o.exr --focus 3 --engine $engine --max-radius 3
        good plain.exr -o o.exr --focus 3 --engine $engine --max-radius 8 --aperture ngon:4:0.5:30 --chromatic 0.1
        good plain.exr -o o.exr --focus 3 --engine $engine --max-radius 8 --aperture ring:0.5 --cat-eye 0.5 --squeeze 2
        good plain.exr -o o.exr --focus 3 --engine $engine --max-radius 8 --aperture aperture.exr
        good plain.exr -o whole.exr --focus 3 --engine $engine --max-radius 8
        cmp -s o.exr whole.exr && fail=1 || fail=0
        result "the aperture's picture shows, $engine" $fail
    done
    bad 1 "--cat-eye|aperture.exr|whole shape" plain.exr -o o.exr --focus 3 --aperture aperture.exr --cat-eye 0.5
    bad 1 "--aperture|nothing.exr" plain.exr -o o.exr --focus 3 --engine scatter --aperture nothing.exr
    bad 1 "--aperture|black.exr|black" plain.exr -o o.exr --focus 3 --engine scatter --aperture black.exr
    bad 1 "--aperture|broken.exr" plain.exr -o o.exr --focus 3 --engine scatter --aperture broken.exr
    good plain.exr -o o.exr --depth-type coc --depth-offset -3 --max-radius 64
    good plain.exr -o o.exr --focus 3 --depth-type ray
    good plain.exr -o o.exr --focus 3 --depth-type inverse
    good plain.exr -o o.exr --focus 3 --compression piz
    good offset.exr -o o.exr --focus 3
    good grey.exr -o o.exr --focus 3
    good flat.exr -o o.exr --focus 3 --depth-file depth.exr
    good half-stereo.exr -o o.exr --focus 3 --views right
    good stereo.exr -o o.exr --focus 3 --views all
    good plain.exr -o o.exr --focus 3 --max-radius 256
    run stereo.exr -o o.png --focus 3 --views left  # a build without OpenImageIO refuses
    { [ "$status" -eq 0 ] && [ -s o.png ] && [ ! -s "$dir/err" ]; } ||
        { [ "$status" -eq 1 ] && [ ! -e o.png ] && contains "$dir/err" o.png; }
    result "one view as PNG" $?
    if [ "$status" -eq 0 ]; then
        rm -f o.png
        bad 1 "o.png|stereo.exr|--views|left" stereo.exr -o o.png --focus 3
    fi
    rm -f o.png
    rm -f o.exr

    # No output may be an input, or another output, whatever the name says.
    cp plain.exr keep.exr && ln -s keep.exr link.exr && ln keep.exr hard.exr && cp depth.exr deep-map.exr
    sum=$(cksum keep.exr deep-map.exr)
    bad 1 "--explain-image|keep.exr|INPUT" keep.exr -o o.exr --focus 3 --explain-image keep.exr
    bad 1 "--explain-image|hard.exr" keep.exr -o o.exr --focus 3 --explain-image hard.exr
    bad 1 "--explain-image|./o.exr|-o" keep.exr -o o.exr --focus 3 --explain-image ./o.exr
    bad 1 "--json|link" keep.exr -o o.exr --focus 3 --json=link.exr
    bad 1 "--depth-file|-o" flat.exr -o ./deep-map.exr --focus 3 --depth-file deep-map.exr
    ln -s keep.exr link.json
    bad 1 "--json|link.json|INPUT" keep.exr -o o.exr --focus 3 --json=link.json
    bad 1 "--explain-image|t.left.exr|-o" stereo.exr -o t.left.exr --focus 3 --explain-image t.exr
    bad 1 "--explain-image|no/such" keep.exr -o o.exr --focus 3 --explain-image no/such/i.exr
    bad 1 "--explain-image|nothing" keep.exr -o o.exr --focus 3 --explain-image i.nothing
    bad 1 "-o|term" keep.exr -o o.term --focus 3
    mkdir near-dir && cp plain.exr near-dir/near.exr
    run near-dir/near.exr -o o.exr --focus 3 --engine gather --dump-passes near-dir
    [ "$status" -ne 0 ] && cmp -s plain.exr near-dir/near.exr
    result "--dump-passes does not write over INPUT" $?
    [ "$(cksum keep.exr deep-map.exr)" = "$sum" ]
    result "inputs are as they were" $?
    rm -rf near-dir link.json link.exr hard.exr deep-map.exr o.exr

    # A replaced file keeps its mode; a link stays a link, even one that points at no file yet.
    cp plain.exr private.exr && chmod 600 private.exr
    good plain.exr -o private.exr --focus 3
    [ "$(stat -c %a private.exr)" = 600 ]
    result "the mode of what is replaced is kept" $?
    mkdir far-dir && ln -s far-dir/new.exr link.exr
    good plain.exr -o link.exr --focus 3
    [ -h link.exr ] && [ -s far-dir/new.exr ]
    result "a dangling link is written through" $?
    rm -rf private.exr link.exr far-dir keep.exr

    # File names are printed without their control characters.
    name=$(printf 'a\033[31mb.exr') && cp plain.exr "$name"
    run "$name" --dry-run --focus 3
    [ "$status" -eq 0 ] && ! grep -q "$(printf '\033')" "$dir/out"
    result "control characters in a name" $?
    rm -f "$name"

    good plain.exr -o o.exr --focus 3 --json
    json_valid "$dir/out"
    result "--json is JSON" $?
    for key in command input output engine isa threads storage views name width height focus model max_radius total_ms \
        passes ms colour_repaired depth_repaired no_surface clamped near_share sharp_share far_share read_ms \
        write_ms; do
        contains "$dir/out" "\"$key\":"
        result "--json has $key" $?
    done
    good plain.exr -o o.exr --focus 3 --json stats.json
    json_valid stats.json && [ ! -s "$dir/out" ]
    result "--json FILE" $?
    rm -f stats.json
    good --json stats.json plain.exr -o o.exr --focus 3
    json_valid stats.json && [ ! -s "$dir/out" ]
    result "--json FILE INPUT" $?
    good --json plain.exr -o o.exr --focus 3
    json_valid "$dir/out"
    result "--json INPUT" $?
    name=$(printf 'a "b" \\ \303\244 \377\001.exr')
    if cp plain.exr "$name" 2>/dev/null; then
        good "$name" -o o.exr --focus 3 --json=stats.json
        json_valid stats.json
        result "--json with an odd file name" $?
        rm -f "$name"
    fi
    run nan.exr -o o.exr --focus 3 --json
    [ "$status" -eq 0 ] && json_valid "$dir/out" && contains "$dir/out" '"colour_repaired": 1' &&
        [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" nan.exr
    result "NaN is repaired, counted and reported" $?

    # What the picture required.
    good plain.exr --engine gather -o o.exr --focus 3 --explain
    contains "$dir/out" "Computation" && contains "$dir/out" "tiles of" && contains "$dir/out" "memory"
    result "--explain prints a table" $?
    good plain.exr --engine gather -o o.exr --focus 3 --max-radius 0 --explain
    contains "$dir/out" "no blur at all"
    result "--explain says why" $?
    rm -f o.exr
    run plain.exr --engine gather --focus 3 --explain --dry-run
    [ "$status" -eq 0 ] && contains "$dir/out" "predicted" && ! contains "$dir/out" "measured" && [ ! -e o.exr ]
    result "--explain --dry-run" $?
    run plain.exr --engine gather -o o.exr --focus 3 --explain --json
    [ "$status" -eq 0 ] && json_valid "$dir/out" && contains "$dir/out" '"predicted_ms"' &&
        contains "$dir/out" '"memory_saved"' && contains "$dir/err" "Computation"
    result "--explain --json" $?
    good plain.exr -o o.exr --focus 3 --explain-image tiles.exr
    [ -s tiles.exr ]
    result "--explain-image" $?
    good stereo.exr -o o.exr --focus 3 --explain-image tiles.exr
    [ -s tiles.left.exr ] && [ -s tiles.right.exr ]
    result "--explain-image of two views" $?
    rm -f tiles.exr tiles.left.exr tiles.right.exr
    run plain.exr --engine chapter -o o.exr --focus 3 --budget-ms 100 --rings 2 --json
    [ "$status" -eq 0 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" "--budget-ms 100 does nothing for one" &&
        contains "$dir/out" '"budget_step": 0' && contains "$dir/out" '"rings": 2'
    result "--budget-ms and --rings" $?

    passes="coc coc4 cocmaxx cocmax cocblurx cocblur color4 colormulcoc4 colormulnear4 near far farpart cover composite"
    good plain.exr --engine gather -o o.exr --focus 3 --dump-passes passes
    for pass in $passes; do
        [ -s "passes/$pass.exr" ]
        result "--dump-passes writes $pass.exr" $?
    done
    [ "$(find passes -type f | wc -l)" -eq 14 ]
    result "--dump-passes writes nothing else" $?
    good stereo.exr --engine gather -o o.exr --focus 3 --dump-passes passes
    for pass in $passes; do
        [ -s "passes/left.$pass.exr" ] && [ -s "passes/right.$pass.exr" ]
        result "--dump-passes writes left.$pass.exr and right.$pass.exr" $?
    done
    good passes/composite.exr -o o.exr --focus 0.5 --depth-file passes/coc.exr --depth-channel R
    if command -v exrheader >/dev/null; then
        exrheader passes/coc.exr | grep -q '^ *G, 32-bit' && exrheader passes/cocmax.exr | grep -q '^ *Y, 32-bit'
        result "channels of dumped passes" $?
    fi
}
if make_inputs; then
    picture_tests
else
    skip "everything that needs a picture (no python3)"
fi

# ---- a rendered scene
lights=$source_root/images/lights.exr
if [ -f "$lights" ]; then
    plan "model lens|f/0.37|focus 5 from header" "$lights"
    plan "model range|range 2" "$lights" --focus 4 --range 2
    good "$lights" -o scene.exr --json=scene.json
    json_valid scene.json && [ -s scene.exr ]
    result "images/lights.exr" $?
    good "$lights" -o scene2.exr --threads 1 --no-skip
    cmp -s scene.exr scene2.exr
    result "threads and --no-skip change no byte" $?
    # A limit on file size simulates a full disk: one error as usual, and no file left behind.
    run_limited() {
        command=$*
        (ulimit -f 100 && exec "$program" "$@" >"$dir/out" 2>"$dir/err" </dev/null)
        status=$?
    }
    run_limited "$lights" -o full.exr
    [ "$status" -eq 3 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && contains "$dir/err" full.exr &&
        [ -z "$(find . -name '*full*' -o -name '.hyperfocal*')" ]
    result "a full disk" $?
    # Killed in the middle: nothing is left, and the target is the old file.
    echo old >target.exr
    left=0
    for wait in 0.05 0.1 0.15 0.2 0.25 0.3 0.35 0.4 0.5 0.6; do
        for signal in TERM INT HUP; do
            # A background job of a shell ignores SIGINT; env gives it back.
            env --default-signal=INT "$program" "$lights" -o target.exr --engine gather --compression piz 2>/dev/null &
            sleep $wait
            kill -$signal $! 2>/dev/null
            wait $! 2>/dev/null
            [ -z "$(find . -name '.hyperfocal*')" ] || { left=$((left + 1)); rm -f .hyperfocal*; }
        done
    done
    command="killed by signals" status=$left
    [ "$left" -eq 0 ]
    result "no temporary file survives a signal" $?
else
    skip "images/lights.exr"
fi

# What a dry run expects to take is what the run takes: no less than 0.7 of it, as buffers that the engine reserves and
# does not touch cost nothing; and at most 1.05, for what the C library keeps besides.
if [ -r "$source_root/images/lights.exr" ] && command -v python3 >/dev/null; then
    for engine in layers gather; do
        command="--dry-run and run, engine $engine" status=0
        python3 - "$program" "$source_root/images/lights.exr" "$engine" 2>"$dir/err" <<'PYTHON'
import os, re, subprocess, sys
words = [sys.argv[1], sys.argv[2], '--engine', sys.argv[3]]
plan = subprocess.run(words + ['--dry-run'], capture_output=True, text=True, check=True).stdout
expected = int(re.search(r'expected: (\d+) MiB', plan).group(1))
child = os.spawnv(os.P_NOWAIT, words[0], words + ['-o', 'o.exr'])
_, status, usage = os.wait4(child, 0)
peak = usage.ru_maxrss / 1024
assert status == 0 and 0.7 * expected <= peak <= 1.05 * expected, (expected, peak)
PYTHON
        result "a dry run's memory, engine $engine" $?
    done
    rm -f o.exr
fi
finish
