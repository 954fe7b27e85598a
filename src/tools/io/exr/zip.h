// SPDX-License-Identifier: BSD-3-Clause
// ZIP and ZIPS chunks by libdeflate: several times as fast as zlib, and readable by any EXR reader.
#ifndef HF_IO_EXR_ZIP_H
#define HF_IO_EXR_ZIP_H

#include <stddef.h>
#include <stdint.h>

struct libdeflate_compressor;
struct libdeflate_decompressor;

// EXR does not deflate the samples but their sorted bytes: first the even ones, then the odd ones, each as its
// difference from the one before. from and to have size bytes and must not overlap; joining overwrites from.
void hf_exr_split(uint8_t *to, uint8_t *scratch, const uint8_t *from, size_t size);
void hf_exr_join(uint8_t *to, uint8_t *from, size_t size);

// Expand a chunk of `packed` bytes to exactly size bytes; scratch has size bytes too. Returns 0, or -1 if it is
// corrupt.
int hf_exr_unzip(struct libdeflate_decompressor *d, uint8_t *to, size_t size, const uint8_t *from, size_t packed,
                 uint8_t *scratch);
// Returns the compressed size, or 0 if that is not below size. to has size bytes, scratch twice that.
size_t hf_exr_zip(struct libdeflate_compressor *c, uint8_t *to, const uint8_t *from, size_t size, uint8_t *scratch);

#endif
