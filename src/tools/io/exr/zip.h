// SPDX-License-Identifier: BSD-3-Clause
// ZIP and ZIPS chunks by libdeflate: several times as fast as zlib, and any EXR reader reads what it makes.
#ifndef HF_IO_EXR_ZIP_H
#define HF_IO_EXR_ZIP_H

#include <stddef.h>
#include <stdint.h>

struct libdeflate_compressor;
struct libdeflate_decompressor;

// EXR deflates not the samples but their bytes sorted: first the even ones, then the odd ones, each as its difference
// to the one before. from and to have size bytes and do not overlap; from is spoilt by joining.
void hf_exr_split(uint8_t *to, uint8_t *scratch, const uint8_t *from, size_t size);
void hf_exr_join(uint8_t *to, uint8_t *from, size_t size);

// A chunk of `packed` bytes becomes exactly size bytes; scratch holds size too. 0 or -1: corrupt.
int hf_exr_unzip(struct libdeflate_decompressor *d, uint8_t *to, size_t size, const uint8_t *from, size_t packed,
                 uint8_t *scratch);
// Returns the compressed size, or 0 when it is not below size. to has size bytes, scratch two times size.
size_t hf_exr_zip(struct libdeflate_compressor *c, uint8_t *to, const uint8_t *from, size_t size, uint8_t *scratch);

#endif
