// SPDX-License-Identifier: BSD-3-Clause
// Un-mixing: parts that the vector bodies share.
#ifndef HF_LAYERS_UNMIX_H
#define HF_LAYERS_UNMIX_H

#include "engine/layers/kernels.h"

// Which pixels are mixed: pixel/edges.h. In the means of both sides a pixel counts by the square of how surely it is not
// mixed, so the weight of a thin thing's last sure pixels falls to 0 gently.
// FAINT: un-mixing fades out as the weight of both sides falls below this. But where the pixel's own radius is clearly the
// front's or the back's, mixed pixels count in the means as well then, in the end UNSURE each: otherwise hair and grass, of
// which no pixel is sure, would keep their mixtures and become rows of dots. On a steep slope, where all pixels are as mixed,
// radii are neither.
// LEAN: where one side has less than this share of the weight, its mean leans on those of its pixels whose colours are
// farthest from the other side's mean. On a slope that is barely mixed, weights change ten times as fast as radii. FAINT
// and LEAN fade slowly enough that the last bit of a radius is never visible.
// PLAIN: samples more than this many times as bright as the mixed pixel are dimmed. Otherwise the mean of a lamp and
// the wall around it would be so bright that a mixture of the wall and the front would seem to be all front. A back
// that covers less than an eighth of the pixel may truly be that bright, but so small a share matters little.
// DOUBT: the variance of such a mean grows by this part of that between its two estimates. Where the pixel and both sides are
// black, what is left of a lamp's colour in a mean would decide otherwise, by the last bit of a radius.
#define HF_UNMIX_FAINT 0.25f
#define HF_UNMIX_UNSURE 0.1f
#define HF_UNMIX_LEAN 0.08f
#define HF_UNMIX_DOUBT 0x1p-12f
#define HF_UNMIX_PLAIN 8
// The front's share is a mean of two estimates: by colour, with weight 1, and by the pixel's depth, with weight
// SPREAD * v. v is the variance of the estimate by colour: the sides' colour variance over the squared distance between
// front and back. The estimate by depth is wrong by about an eighth of a pixel.
#define HF_UNMIX_SPREAD 60
// A straight edge covers at most half of a pixel whose middle it does not cover. So where a pixel has the back's depth, but
// its colour is not a mixture of both means, something else shows beside the front: the front's share is at most HALF
// then, and HALF of the front's part of what is not explained goes to the back as well. Where the means explain the colour
// they are believed: renderers take depth anywhere in the pixel.
// UNEXPLAINED: a rest whose square is 1 / UNEXPLAINED of the squared distance between the means counts fully, a smaller one
// less. ALIKE: where that distance is below 1 / ALIKE of the sum of their squares the means are alike, and a rest says
// nothing; from 2 / ALIKE on it counts fully.
#define HF_UNMIX_HALF 0.5f
#define HF_UNMIX_UNEXPLAINED 150
#define HF_UNMIX_ALIKE 5

// A mixed pixel more than LAMP times as bright as its front and its back shows part of a lamp: the edge hides so much
// of the lamp that no whole pixel shows it. From LAMP + 1 / 2 on it counts wholly as a lamp. Drawn with a sharp front
// it would be a white speck on the rim. So the light stays with the back, which is blurred more, and the front's share
// is at most RIM. The back gets at most the pixel's colour: hidden samples, which repeat it behind the edge, add the
// rest. Edges lit from behind are as bright, but those are lines; a lamp covers fewer than PIXELS of 7 x 7.
#define HF_UNMIX_LAMP 1.5f
#define HF_UNMIX_PIXELS 7
#define HF_UNMIX_RIM 0.75f
// In a thicket a pixel more than TIMES as bright as the dark pixels of both sides begins to count as a lamp, from TIMES + 2 on
// wholly. Pixels brighter than DARK of its own light are dimmed in the means of the dark ones.
#define HF_UNMIX_TIMES 2
#define HF_UNMIX_DARK 0.125f

// 1 / d^4 for 7 x 7 pixels; 0 for the middle one.
extern const float hf_unmix_weights[7][7];
// Complete the mean of the side with less weight (LEAN), and make its variance that of the mixture (DOUBT). mean: colour, radius (4).
// Returns 0 if neither side has any weight.
int hf_unmix_complete(const struct hf_unmix_row *row, int x, float weight[2], float mean[2][5], float spread[2]);

// How far a pixel shows a lamp, 0 to 1. most: brightness of the brighter of front and back, the sum of channels / 8.
// alpha: the larger of the two sides', with four channels: a pixel whose alpha also exceeds it is bright because it
// covers more, and is no lamp.
float hf_unmix_lamp(const struct hf_unmix_row *row, int x, float most, float alpha);

// Floats of scratch for un-mixing rows of `width` pixels.
size_t hf_layers_unmix_floats(int width);
// Un-mix rows. begin: r holds the first rows of a cell; later rows of that cell continue with what they left in
// scratch. any: as in struct hf_unmix_row.
void hf_layers_unmix_rows(const struct hf_frame *f, struct hf_rect r, int begin, uint8_t *any);

#endif
