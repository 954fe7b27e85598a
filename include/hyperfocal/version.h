// SPDX-License-Identifier: BSD-3-Clause
#ifndef HYPERFOCAL_VERSION_H
#define HYPERFOCAL_VERSION_H

// Version of this header, and of the release that it belongs to. meson.build reads these lines.
#define HF_VERSION_MAJOR 0
#define HF_VERSION_MINOR 9
#define HF_VERSION_PATCH 0

// Version of the binary interface. It names the shared library, libhyperfocal.so.1, and is apart from the release's
// version. It grows by 1 when a program that was compiled against an older header would no longer run right: a function
// of hyperfocal.h goes or changes its arguments, a field goes, moves or changes its meaning, an enumerator changes its
// value, the size of a group inside struct hf_params changes. It stays when functions, enumerators, or fields at the
// end of a struct are added, when reserved words become fields, and when inspect.h changes. meson.build reads this
// line.
#define HF_ABI_VERSION 1

#endif
