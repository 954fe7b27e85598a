// SPDX-License-Identifier: BSD-3-Clause
// Rows that are known to exceed their bound: why, and by how much at most. They are printed as open; what is worse than
// that fails. A row that keeps its bound goes from here; none may be added to hide something new.
#ifndef HF_TESTS_STABILITY_OPEN_H
#define HF_TESTS_STABILITY_OPEN_H

static const struct {
    const char *what;
    const char *subject;  // its name, or how the names of several begin
    double most;
    const char *reason;
} open_rows[] = {
    {"constant in, constant out: relative error", "gather faithful", 0.9,
     "the chapter's max fill starts from zero where a field is empty: 0 beats a negative constant"},
    {"centre of a highlight, half resolution: off, pixels", "hexagon half", 0.7,
     "a slanted line's pixels are filled one after the other by distance, though two taps share each: the first takes "
     "some "
     "of the second's too early, its mean is nearer than half the radius, and only the upright line's is not"},
    {"opaque: samples of alpha that are not 1", "gather max", 4000,
     "the chapter's weights of taps add up to 1 only within rounding"},
    {"opaque: samples of alpha that are not 1", "gather none", 4000, "the same"},
    {"opaque: samples of alpha that are not 1", "gather faithful", 4000, "the same"},
    {"opaque: samples of alpha that are not 1", "gather packed max", 4000, "the same"},
    {"opaque: samples of alpha that are not 1", "hexagon", 600,
     "alpha is summed like colour; its weights add up to 1 only within rounding"},
    {"transposes: difference, of the largest", "scatter", 0.015,
     "a disc's rows end between pixels, its first and last row do not: its outline differs along the axes"},
    {"flips: samples that are not the mirror's bits", "scatter", 5000,
     "what lies behind near pixels is made from quads counted from the left: an odd width has others in the mirror"},
    {"a focus pull: worst jump, 8-bit codes", "gather max", 10,
     "the chapter's quads have the CoC of their first pixel: at 0 it takes no part in the far field, and all of it "
     "just beside"},
    {"a focus pull: worst jump, 8-bit codes", "gather faithful", 10, "the same"},
    {"a focus pull: worst jump, 8-bit codes", "gather packed max", 10, "the same"},
    {"a focus pull: worst jump, 8-bit codes", "gather packed", 3, "steps of 8-bit CoC"},
    {"a range pull: worst jump, 8-bit codes", "gather packed", 3, "steps of 8-bit CoC"},
    {"a strength pull: worst jump, 8-bit codes", "gather packed", 6,
     "steps of 8-bit CoC; and from strength 0, which is a copy, to colours that are truncated when they are read"},
    {"a dolly: worst jump, 8-bit codes", "gather max", 10, "as for the focus pull"},
    {"a dolly: worst jump, 8-bit codes", "gather faithful", 10, "the same"},
    {"a dolly: worst jump, 8-bit codes", "gather packed max", 10, "the same"},
    {"a dolly: worst jump, 8-bit codes", "gather packed", 3, "steps of 8-bit CoC"},
    {"a radius ramp: worst jump, 8-bit codes", "gather max", 19,
     "whole numbers of the chapter's rings and of its near maximum's reach"},
    {"a radius ramp: worst jump, 8-bit codes", "gather none", 19, "the same"},
    {"a radius ramp: worst jump, 8-bit codes", "gather faithful", 19, "the same"},
    {"a radius ramp: worst jump, 8-bit codes", "gather packed max", 19, "the same"},
    {"a radius ramp: worst jump, 8-bit codes", "gather packed", 3, "steps of 8-bit CoC"},
    {"radius 0 and the least above it: jump, 8-bit codes", "gather max", 170,
     "the chapter's far field comes from half resolution however small the radius is"},
    {"radius 0 and the least above it: jump, 8-bit codes", "gather none", 170, "the same"},
    {"radius 0 and the least above it: jump, 8-bit codes", "gather faithful", 170, "the same"},
    {"radius 0 and the least above it: jump, 8-bit codes", "gather packed max", 170, "the same"},
    {"radius 0 and the least above it: jump, 8-bit codes", "gather packed", 6,
     "radius 0 is a copy, and otherwise colours are truncated when they are read"},
};

#endif
