// SPDX-License-Identifier: BSD-3-Clause
// Un-mixing: parts that the vector bodies share.
#ifndef HF_LAYERS_UNMIX_H
#define HF_LAYERS_UNMIX_H

#include "engine/layers/kernels.h"

// Which pixels are mixed: pixel/edges.h. FAINT: by pixels of less weight than this little is un-mixed. LEAN: the mean of a
// side that has less than this of the weight of both leans on those pixels of that side whose colours are farthest from
// the other's. Where a slope is hardly mixed, weights grow from 0 with its radii, ten times as fast: these two fade slowly
// enough that the last bit of a radius shows nowhere. PLAIN: what is brighter than so many times the mixed pixel is
// dimmed, or the mean of a lamp and the wall around it would be brighter than the mixture of the wall and what lies before
// it, and all of that would seem to be the front; what is behind less than an eighth of a pixel may be brighter, and a share
// that small is of little weight.
#define HF_UNMIX_FAINT 0.25f
#define HF_UNMIX_LEAN 0.08f
#define HF_UNMIX_PLAIN 8
// A share by colours, whose variance in units of the distance between front and back is v, and that of the depth sample,
// wrong by an eighth of a pixel or so, are weighed as 1 to 60 v.
#define HF_UNMIX_SPREAD 60

// A mixed pixel LAMP times as bright as front and back are is a lamp's of which the edge leaves so little that no whole pixel
// is of it, wholly from LAMP + 1 / 2 on. Drawn with a sharp front it would be a white speck on the rim, so the light stays
// with a back that is blurred more, and the front is no more than RIM of the pixel. The back has no more than the pixel's
// colour: hidden samples, which repeat it behind the edge, make up for the rest of it. Edges lit from behind are as bright, so
// that a lamp covers fewer than PIXELS of 7 x 7; a line through them does not.
#define HF_UNMIX_LAMP 1.5f
#define HF_UNMIX_PIXELS 7
#define HF_UNMIX_RIM 0.75f

// 1 / d^4 of the 7 x 7, 0 in its middle.
extern const float hf_unmix_weights[7][7];
// Fill in the mean of a side of which there is nothing or little, and take its variance for as little. 0: there are none. A
// mean is colour, radius (4).
int hf_unmix_complete(const struct hf_unmix_row *row, int x, float weight[2], float mean[2][5], float spread[2]);

// How far a pixel is of a lamp. most: brightness of the brighter one of front and back, the sum of channels / 8; alpha: the
// larger one of theirs, if there are any: what is brighter as it covers more is none.
float hf_unmix_lamp(const struct hf_unmix_row *row, int x, float most, float alpha);

// Floats of scratch that un-mixing a row of n pixels takes.
size_t hf_layers_unmix_floats(int width);
// begin: these are the first of a cell; others follow those before them.
void hf_layers_unmix_rows(const struct hf_frame *f, struct hf_rect r, int begin);

#endif
