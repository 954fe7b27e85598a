// SPDX-License-Identifier: BSD-3-Clause
#ifndef HYPERFOCAL_VERSION_H
#define HYPERFOCAL_VERSION_H

// Version of this header. meson.build reads these lines, so they are the only place where it is written.
#define HF_VERSION_MAJOR 0
#define HF_VERSION_MINOR 1
#define HF_VERSION_PATCH 0

#endif
