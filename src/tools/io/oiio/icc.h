// SPDX-License-Identifier: BSD-3-Clause
// Colour profiles that are three curves and a matrix, as those of cameras and screens are: from a file's code values to
// linear light with the primaries of sRGB, and back. Other profiles (tables, greys, CMYK) are not read.
#ifndef HF_IO_ICC_H
#define HF_IO_ICC_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { HF_ICC_STEPS = 65535 };  // of a curve: the codes of 16 bits, and with them those of 8

struct hf_icc {
    float curve[3][HF_ICC_STEPS + 1];  // light of each code, 0 to 1, never falling
    double to[3][3], from[3][3];       // the profile's light to that of sRGB, and back
};

// Fill *icc from a profile's bytes, of which none is trusted. Returns 0, or -1 if it is none of this kind.
int hf_icc_read(struct hf_icc *icc, const uint8_t *data, size_t size);

// Turn one pixel's codes, 0 to 1, to linear light, and back. Light beyond what the profile holds is cut off on the way back.
void hf_icc_to_light(const struct hf_icc *icc, float rgb[3]);
void hf_icc_to_code(const struct hf_icc *icc, float rgb[3]);

#ifdef __cplusplus
}
#endif

#endif
