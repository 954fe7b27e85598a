// SPDX-License-Identifier: BSD-3-Clause
// What other programs reach on the scenes in images/, measured elsewhere on two threads with the exact radius given to
// each. GEGL on lights and foliage: against the truth of commit 38b9469, which was noisier.
#ifndef HF_BENCH_OTHERS_H
#define HF_BENCH_OTHERS_H

struct bench_other {
    const char *scene;
    double none;                // PSNR of the input itself, dB
    double blender, blender_s;  // Blender 3.4's Defocus, dB and seconds
    double gegl, gegl_s;        // GEGL 0.4.42's lens-blur
};

enum { BENCH_OTHERS = 3 };
static const struct bench_other bench_others[BENCH_OTHERS] = {
    {"lights", 14.20, 26.48, 8.4, 25.37, 0.3},
    {"fence", 19.85, 21.51, 2.7, 24.36, 0.3},
    {"foliage", 21.66, 27.61, 16.2, 29.34, 0.3},
};

#endif
