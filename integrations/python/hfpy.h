// SPDX-License-Identifier: BSD-3-Clause
// The Python module over the library's public API. It uses Python's limited API alone, so one binary serves 3.11 and later.
#ifndef HFPY_H
#define HFPY_H

#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030b0000
#include <Python.h>

#include "hyperfocal/hyperfocal.h"

// A picture or a map of depth in Python's memory, as the library sees it.
struct hfpy_pixels {
    const char *name;  // the argument's, for errors
    Py_buffer views[4];
    int view_count;
    int height, width, channels;
    char type;    // of a sample, as in the module struct: f e B H I
    int sample;   // bytes of a sample
    int swapped;  // its bytes are in another order than this machine's
    int used;     // channels that the library gets: 3 of 4 where alpha is 1 everywhere
    char *at[4];  // first sample of each channel
    ptrdiff_t row[4], column[4];
    char *copy;                   // packed samples, where the library cannot use the array itself; NULL: it can
    int copy_pixel, copy_sample;  // bytes of a pixel and of a sample of copy
    struct hf_image image;
};

// Take the buffers of an array (height, width, 3 or 4) or of a tuple of 3 or 4 planes. Returns 0, or -1 with an exception.
int hfpy_open_picture(struct hfpy_pixels *p, PyObject *object, const char *name, int writable);
// Of an array (height, width) or (height, width, 1).
int hfpy_open_plane(struct hfpy_pixels *p, PyObject *object, const char *name, int writable);
// Fill p->image; into a copy where the library cannot use the array, or where `copy` says so. read: the copy gets the samples.
int hfpy_image(struct hfpy_pixels *p, int copy, int read);
// The same for an input of this engine: alpha is left out where the engine has other bits without it.
int hfpy_image_for(struct hfpy_pixels *p, int copy, enum hf_engine engine);
// The same for an output that is the very array of the input.
int hfpy_image_in_place(struct hfpy_pixels *to, const struct hfpy_pixels *from);
int hfpy_depth(struct hfpy_pixels *p, int copy, struct hf_depth *depth);
// Write the samples of the copy, if there is one, into the array.
void hfpy_write_back(const struct hfpy_pixels *p);
void hfpy_close(struct hfpy_pixels *p);
// Whether two may use the same bytes, and whether they are the same array.
int hfpy_overlap(const struct hfpy_pixels *a, const struct hfpy_pixels *b);
int hfpy_same(const struct hfpy_pixels *a, const struct hfpy_pixels *b);
// Whether two samples of one array may be the same bytes.
int hfpy_overlaps_itself(const struct hfpy_pixels *p);
// A new array like `object`: numpy's where that is numpy's, else a memoryview; a tuple of planes for a tuple.
PyObject *hfpy_new_like(PyObject *object, const struct hfpy_pixels *p);
// A new array of float32, (height, width).
PyObject *hfpy_new_plane(PyObject *object, int height, int width);

enum { HFPY_MOST_FIELDS = 128 };
enum hfpy_kind { FIELD_FLOAT, FIELD_INT, FIELD_NAME, FIELD_PICTURE };

// The arguments of a call, as the library wants them.
struct hfpy_given {
    struct hf_params params;
    struct hf_depth depth;
    int transfer, quality;
    float max_error;
    struct hfpy_pixels aperture;
    unsigned char given[HFPY_MOST_FIELDS];
    PyObject *color, *depth_map, *out;  // borrowed
};

// A keyword argument.
struct hfpy_field {
    const char *keyword, *path, *doc;
    enum hfpy_kind kind;
    enum hf_names names;
    size_t offset;  // in struct hfpy_given
    const char *group;
    int engine;  // a setting that a quality chooses
};
struct hfpy_number {
    const char *name;
    char type;
    size_t offset;
};

// What a function takes besides the fields.
enum { HFPY_COLOR = 1, HFPY_DEPTH = 2, HFPY_OUT = 4, HFPY_ONLY_DEPTH = 8 };

// Read a call's arguments. skip: positional arguments before those that `takes` names. Returns 0, or -1 with an exception.
// hfpy_release must follow in both cases.
int hfpy_read(struct hfpy_given *g, const char *function, PyObject *args, PyObject *kwargs, int skip, int takes);
// Choose the engine's settings, if quality or max_error is given.
int hfpy_choose(struct hfpy_given *g, int height, struct hf_choice *choice);
void hfpy_release(struct hfpy_given *g);
// A dict of the engine's settings, and one of what the choice costs.
PyObject *hfpy_settings(const struct hfpy_given *g);
PyObject *hfpy_report_dict(const struct hf_report *report);
PyObject *hfpy_choice_dict(const struct hf_choice *choice);
// A dict: the description of each keyword argument.
PyObject *hfpy_descriptions(void);

// Raise what an error code means, with the library's sentence in the module's words. Returns NULL.
PyObject *hfpy_raise(int error, const struct hf_message *message);
// The sentence with the argument's name in Python.
void hfpy_sentence(const struct hf_message *message, char *text, size_t size);

PyObject *hfpy_coc(PyObject *module, PyObject *args, PyObject *kwargs);
extern PyType_Spec hfpy_context_spec;

#endif
