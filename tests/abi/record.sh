#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Record a release's ABI: its headers as tests/abi/VERSION/hyperfocal/*.h, and what abidw says of it as tests/abi/VERSION.abi.
# The tests `programs` and `abidiff` compare later libraries with that. Run it on x86-64 with abigail-tools.
# Usage: record.sh VERSION [C-COMPILER...]
set -eu
cd "$(dirname "$0")/../.."
version=${1:-}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- cc
if ! echo "$version" | grep -Eqx '[0-9]+\.[0-9]+\.[0-9]+'; then
    echo "usage: tests/abi/record.sh MAJOR.MINOR.PATCH [C-COMPILER...]" >&2
    exit 2
fi
sh tests/abi/dump.sh . "tests/abi/$version.abi" "$@"
rm -rf "tests/abi/$version"
mkdir -p "tests/abi/$version/hyperfocal"
cp include/hyperfocal/*.h "tests/abi/$version/hyperfocal"
