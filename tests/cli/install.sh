#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What is installed works wherever it is put: programs find the library, the helper and the scenes from where they are.
# Usage: install.sh BUILD MESON SOURCE_ROOT. Skipped where not all is built.
. "$(dirname "$0")/../support/check.sh"
build=$1 meson=$2 source_root=$(absolute "$3")
"$meson" install -C "$build" --no-rebuild --destdir "$dir/dest" >"$dir/out" 2>&1 || {
    echo "skipped: not all is built"
    exit 77
}
check "the command alone is installed" "$meson" install -C "$build" --no-rebuild --destdir "$dir/alone" --tags runtime,devel,man
check "it is there" test -n "$(find "$dir/alone" -path '*/bin/hyperfocal')"
check "and its man page" test -n "$(find "$dir/alone" -name 'hyperfocal.1')"
check "and nothing of the bench" test -z "$(find "$dir/alone" -name '*.exr' -o -name 'hyperfocal-bench*')"
program=$(find "$dir/dest" -path '*/bin/hyperfocal' -type f)
# A prefix other than the configured one.
mv "$(dirname "$(dirname "$program")")" "$dir/elsewhere" || exit 1
bin=$dir/elsewhere/bin
cd "$dir" || exit 1
unset LD_LIBRARY_PATH
check "starts" "$bin/hyperfocal" --version
check "the bench starts" "$bin/hyperfocal-bench" --help
for page in hyperfocal hyperfocal-bench; do
    check "man page of $page" grep -q "^.TH $page 1" "$dir/elsewhere/share/man/man1/$page.1"
done
if command -v readelf >/dev/null; then
    for file in "$bin/hyperfocal" "$bin/hyperfocal-bench"; do
        check "no path of this machine in $(basename "$file")" sh -c \
            'readelf -d "$1" | grep -E "R(UN)?PATH" | grep -q "\[\$ORIGIN/[^:]*\]$"' - "$file"
    done
fi
check "defocuses" "$bin/hyperfocal" "$source_root/images/lights.exr" -o dof.exr --max-radius 2 --engine gaussian
if [ -x "$dir/elsewhere/libexec/hyperfocal/hyperfocal-oiio" ]; then
    check "finds its helper" "$bin/hyperfocal" "$source_root/images/lights.exr" -o dof.png --max-radius 2 --engine gaussian
    # A helper of another build is refused with one sentence.
    helper=$dir/elsewhere/libexec/hyperfocal/hyperfocal-oiio
    printf '#!/bin/sh\nprintf "9.8.7 (1, 2)" >&3\nsleep 5\n' >"$helper.new"
    chmod +x "$helper.new"
    mv "$helper.new" "$helper"
    "$bin/hyperfocal" "$source_root/images/lights.exr" -o other.png --max-radius 2 2>other
    status=$?
    check "a helper of another version is refused" test $status -eq 1 -a ! -e other.png
    check "in one sentence" grep -q "hyperfocal-oiio is of version 9.8.7 (1, 2), but this program of [0-9]" other
    check "and no more" test "$(wc -l <other)" -eq 1
    # A helper that does not understand the question about its version, and exits.
    printf '#!/bin/sh\nhead -c 1 <&3 >/dev/null\n' >"$helper.new"
    chmod +x "$helper.new"
    mv "$helper.new" "$helper"
    "$bin/hyperfocal" "$source_root/images/lights.exr" -o other.png --max-radius 2 2>other
    check "a helper that does not answer is refused" grep -q "cannot start hyperfocal-oiio" other
fi
# Skipped in an old build directory, whose hyperfocal.pc has absolute paths.
pc=$(find "$dir/elsewhere" -name hyperfocal.pc)
if command -v pkg-config >/dev/null && grep -q pcfiledir "$pc"; then
    check "pkg-config finds the header" sh -c 'h=$(PKG_CONFIG_PATH=${1%/*} pkg-config --cflags hyperfocal) && \
        test -f "$(echo "${h#-I}" | sed "s/ *$//")/hyperfocal/hyperfocal.h"' - "$pc"
    check "and the library" sh -c 'l=$(PKG_CONFIG_PATH=${1%/*} pkg-config --variable=libdir hyperfocal) && \
        test -e "$l/libhyperfocal.so"' - "$pc"
fi
# Run away from the source tree, so that the scenes are the installed ones.
check "the bench finds its scenes" "$bin/hyperfocal-bench" tradeoff --quick --cache none \
    --setting "--engine gaussian --resolution quarter --iterations 1 --threads 1"
check "the bench scores a picture" "$bin/hyperfocal-bench" truth --image dof.exr \
    --truth "$dir/elsewhere/share/hyperfocal/images/lights.truth.exr"
mv said score
check "by a number of dB" grep -Eq "^ +[0-9]+\.[0-9]{2} " score
check "the same is the same" sh -c '"$1" truth --image dof.exr --truth dof.exr --json - | grep -q "\"linear_rmse\": 0,"' - \
    "$bin/hyperfocal-bench"
finish
