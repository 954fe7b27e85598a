#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Another project has hyperfocal as a meson subproject, then finds by pkg-config what that installs: the library alone,
# shared and static, and only the headers of include/. It is built as plain C without optimisation, to be quick.
# Usage: subproject.sh MESON SOURCE_ROOT VERSION C-COMPILER...
. "$(dirname "$0")/../support/check.sh"
meson=$1 source_root=$(absolute "$2") version=$3
shift 3
refused() {
    ! "$@"
}

mkdir -p "$dir/parent/subprojects"
ln -s "$source_root" "$dir/parent/subprojects/hyperfocal"
cd "$dir/parent" || exit 1
cat >meson.build <<'END'
project('parent', 'c', default_options: ['default_library=both', 'optimization=0'])
hyperfocal = dependency('hyperfocal', version: '>=0.1', fallback: 'hyperfocal')
message('version ' + hyperfocal.version())
executable('app', 'app.c', dependencies: hyperfocal)
executable('peeks', 'peeks.c', dependencies: hyperfocal, build_by_default: false)
END
cat >app.c <<'END'
#include <hyperfocal/hyperfocal.h>
#include <stdio.h>
int main(void)
{
    static float colour[8 * 8 * 4], z[8 * 8];
    const struct hf_image picture = {sizeof picture, 8, 8, HF_FORMAT_RGBA32F, HF_TRANSFER_LINEAR, {colour}, {sizeof colour / 8}};
    const struct hf_depth depth = {.size = sizeof depth, .data = z, .stride = sizeof z / 8};
    struct hf_context *c;
    for (int i = 0; i < 64; i++)
        z[i] = 1 + i, colour[4 * i] = colour[4 * i + 3] = 1;
    int err = hf_open(&c, NULL);
    if (!err)
        err = hf_render(c, &picture, &picture, &depth, NULL);
    hf_close(&c);
    printf("%s: %s, %g\n", hf_version(), hf_error_string(err), colour[0]);
    return err != HF_OK;
}
END
mkdir cmake
cat >cmake/CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.18)
project(app C)
find_package(hyperfocal 0.1 REQUIRED)
add_executable(app ../app.c)
target_link_libraries(app hyperfocal::hyperfocal)
END
printf '#include "base/mem.h"\nint main(void)\n{\n    return 0;\n}\n' >peeks.c

# The wrap mode keeps meson from finding a hyperfocal installed on this machine.
check "a parent project is set up" env PKG_CONFIG_PATH= "$meson" setup build --prefix "$dir/dest" \
    --wrap-mode=forcefallback -Dhyperfocal:simd=false
cp "$dir/said" log
check "it is told the version" grep -q "version $version\$" log
check "it builds" "$meson" compile -C build
check "its program runs" build/app
cp "$dir/said" said
check "with the library of this version, and a picture" grep -q "^$version: no error, 1\$" said
check "its programs cannot include what is not public" refused ninja -C build peeks
check "the library is built" grep -q "^build subprojects/hyperfocal/src/" build/build.ninja
for folder in tests bench examples src/tools/cli; do
    check "nothing of $folder is built" refused grep -q "^build subprojects/hyperfocal/$folder/" build/build.ninja
done

check "it installs" "$meson" install -C build --no-rebuild
check "nothing that runs" test ! -e "$dir/dest/bin"
pc=$(find "$dir/dest" -name hyperfocal.pc)
if command -v pkg-config >/dev/null && [ -n "$pc" ]; then
    PKG_CONFIG_PATH=${pc%/*}
    export PKG_CONFIG_PATH
    libdir=$(pkg-config --variable=libdir hyperfocal)
    check "pkg-config tells the version" test "$(pkg-config --modversion hyperfocal)" = "$version"
    # shellcheck disable=SC2046
    check "a program is linked as pkg-config says" "$@" app.c -o shared $(pkg-config --cflags --libs hyperfocal)
    check "to the shared library" env LD_LIBRARY_PATH="$libdir" ./shared
    check "which it needs" refused ./shared
    for kind in shared static; do
        if command -v cmake >/dev/null; then
            check "CMake is set up, $kind" cmake -S cmake -B "cmake-$kind" -DCMAKE_PREFIX_PATH="$dir/dest"
            check "it builds the program" cmake --build "cmake-$kind"
            check "which runs" "cmake-$kind/app"
        fi
        [ $kind = static ] || rm "$libdir"/libhyperfocal.so*
    done
    # shellcheck disable=SC2046
    check "without one as pkg-config --static says" "$@" app.c -o static $(pkg-config --cflags --static --libs hyperfocal)
    check "to the static library" ./static
fi
finish
