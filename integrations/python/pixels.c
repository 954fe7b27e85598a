// SPDX-License-Identifier: BSD-3-Clause
// Arrays as pictures: which of them the library can use where they lie, and copies of the others.
#include "hfpy.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static int fail(const struct hfpy_pixels *p, const char *sentence)
{
    PyErr_Format(PyExc_ValueError, "%s %s", p->name, sentence);
    return -1;
}

// Read the type of a buffer's samples. The library knows float32, float16, and whole numbers of 8, 16 and 32 bits.
static int sample_type(struct hfpy_pixels *p, const Py_buffer *view)
{
    const char *format = view->format ? view->format : "B";
    const uint16_t one = 1;
    const int little = *(const unsigned char *)&one;
    const int swapped = little ? *format == '>' || *format == '!' : *format == '<';
    if (*format && strchr("<>=!@", *format))
        format++;
    // On some systems a long has 32 bits.
    const char type = *format == 'L' && view->itemsize == 4 ? 'I' : *format;
    static const struct {
        char type;
        int size;
    } known[] = {{'f', 4}, {'e', 2}, {'B', 1}, {'H', 2}, {'I', 4}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (known[i].type == type && !format[1] && view->itemsize == known[i].size) {
            p->type = type;
            p->sample = known[i].size;
            p->swapped = swapped && p->sample > 1;
            return 0;
        }
    PyErr_Format(PyExc_ValueError, "%s has samples of type '%s'; it must have float32, float16, uint8 or uint16%s",
                 p->name, view->format ? view->format : "B", strcmp(p->name, "depth") ? "" : " or uint32");
    return -1;
}

// Take one more buffer.
static int take(struct hfpy_pixels *p, PyObject *object, int writable)
{
    Py_buffer *view = &p->views[p->view_count];
    if (PyObject_GetBuffer(object, view, writable ? PyBUF_RECORDS : PyBUF_RECORDS_RO)) {
        if (PyErr_ExceptionMatches(PyExc_TypeError)) {
            PyErr_Clear();
            PyErr_Format(PyExc_TypeError, "%s must be an array (an object with a buffer)", p->name);
        } else if (writable) {
            PyErr_Clear();
            fail(p, "is read-only");
        }
        return -1;
    }
    p->view_count++;
    return 0;
}

// The size of a picture; 0 and what the library refuses for other reasons is left to the library.
static int set_size(struct hfpy_pixels *p, const Py_buffer *view)
{
    if (view->shape[0] > 65536 || view->shape[1] > 65536) {
        PyErr_Format(PyExc_ValueError, "%s has %zd x %zd pixels; width and height must be 1 to 65536", p->name,
                     view->shape[1], view->shape[0]);
        return -1;
    }
    if (!view->shape[0] || !view->shape[1])
        return fail(p, "has no pixels");
    p->height = (int)view->shape[0];
    p->width = (int)view->shape[1];
    return 0;
}

static void set_channel(struct hfpy_pixels *p, int channel, const Py_buffer *view, ptrdiff_t offset)
{
    p->at[channel] = (char *)view->buf + offset;
    p->row[channel] = p->height > 1 ? view->strides[0] : 0;
    p->column[channel] = p->width > 1 ? view->strides[1] : 0;
}

static int open_planes(struct hfpy_pixels *p, PyObject *object, int writable)
{
    const Py_ssize_t count = PyTuple_Size(object);
    if (count != 3 && count != 4)
        return fail(p, "is a tuple of other than 3 or 4 planes");
    p->channels = (int)count;
    for (int c = 0; c < p->channels; c++) {
        if (take(p, PyTuple_GetItem(object, c), writable))
            return -1;
        const Py_buffer *view = &p->views[c];
        const int width = p->width, height = p->height;
        const char type = p->type;
        const int swapped = p->swapped;
        if (view->ndim != 2)
            return fail(p, "has a plane that is not of shape (height, width)");
        if (sample_type(p, view) || set_size(p, view))
            return -1;
        if (c && (p->width != width || p->height != height || p->type != type || p->swapped != swapped))
            return fail(p, "has planes of different shape or type");
        set_channel(p, c, view, 0);
    }
    return 0;
}

int hfpy_open_picture(struct hfpy_pixels *p, PyObject *object, const char *name, int writable)
{
    *p = (struct hfpy_pixels){.name = name};
    if (PyTuple_Check(object))
        return open_planes(p, object, writable);
    if (take(p, object, writable))
        return -1;
    const Py_buffer *view = &p->views[0];
    if (view->ndim != 3 || (view->shape[2] != 3 && view->shape[2] != 4))
        return fail(p, "must have the shape (height, width, 3) or (height, width, 4), or be a tuple of planes");
    if (sample_type(p, view) || set_size(p, view))
        return -1;
    if (p->type == 'I')
        return fail(p, "has samples of 32 bits; it must have float32, float16, uint8 or uint16");
    p->channels = (int)view->shape[2];
    for (int c = 0; c < p->channels; c++)
        set_channel(p, c, view, c * view->strides[2]);
    return 0;
}

int hfpy_open_plane(struct hfpy_pixels *p, PyObject *object, const char *name, int writable)
{
    *p = (struct hfpy_pixels){.name = name, .channels = 1, .used = 1};
    if (take(p, object, writable))
        return -1;
    const Py_buffer *view = &p->views[0];
    if (view->ndim != 2 && !(view->ndim == 3 && view->shape[2] == 1))
        return fail(p, "must have the shape (height, width)");
    if (sample_type(p, view) || set_size(p, view))
        return -1;
    set_channel(p, 0, view, 0);
    return 0;
}

void hfpy_close(struct hfpy_pixels *p)
{
    for (int i = 0; i < p->view_count; i++)
        PyBuffer_Release(&p->views[i]);
    p->view_count = 0;
    PyMem_Free(p->copy);
    p->copy = NULL;
}

// Whether the samples of channel c lie where the C compiler expects numbers of their size.
static int aligned(const struct hfpy_pixels *p, int c)
{
    return !((uintptr_t)p->at[c] % (uintptr_t)p->sample || p->row[c] % p->sample || p->column[c] % p->sample);
}

// Whether the rows are far enough apart for the library: *stride becomes the distance.
static int rows_apart(const struct hfpy_pixels *p, int c, int pixel, ptrdiff_t *stride)
{
    const ptrdiff_t row = (ptrdiff_t)p->width * pixel;
    *stride = p->height > 1 ? p->row[c] : row;
    return *stride >= row || *stride <= -row;
}

// Channels side by side in each pixel.
static int interleaved(struct hfpy_pixels *p)
{
    const int pixel = p->used * p->sample;
    for (int c = 0; c < p->used; c++)
        if (p->at[c] != p->at[0] + c * p->sample || p->row[c] != p->row[0] || (p->width > 1 && p->column[c] != pixel))
            return 0;
    p->image.data[0] = p->at[0];
    return rows_apart(p, 0, pixel, &p->image.stride[0]);
}

static int planar(struct hfpy_pixels *p)
{
    for (int c = 0; c < p->used; c++) {
        if ((p->width > 1 && p->column[c] != p->sample) || !rows_apart(p, c, p->sample, &p->image.stride[c]))
            return 0;
        p->image.data[c] = p->at[c];
    }
    return 1;
}

// Whether the library can use the array as it is; then p->image is filled.
static int direct(struct hfpy_pixels *p)
{
    struct hf_image *i = &p->image;
    for (int c = 0; c < p->used; c++)
        if (p->swapped || !aligned(p, c))
            return 0;
    if (p->type == 'f') {
        i->format = p->used == 4 ? HF_FORMAT_RGBA32F : HF_FORMAT_RGB32F;
        if (interleaved(p))
            return 1;
        i->format = HF_FORMAT_PLANAR32F;
        return planar(p);
    }
    i->format = p->type == 'e' ? HF_FORMAT_RGBA16F : p->type == 'H' ? HF_FORMAT_RGBA16 : HF_FORMAT_RGBA8;
    return p->used == 4 && interleaved(p);
}

// A half float as a float, which is exact.
static float from_half(uint16_t h)
{
    const int exponent = h >> 10 & 31, fraction = h & 1023;
    const float size = exponent == 31  ? (fraction ? NAN : INFINITY)
                       : exponent == 0 ? ldexpf((float)fraction, -24)
                                       : ldexpf((float)(1024 + fraction), exponent - 25);
    return h & 0x8000 ? -size : size;
}

// Half floats become floats where alpha is left out, as the library has no three of them.
static void copy_half(char *to, const char *from, int swapped)
{
    uint16_t half;
    memcpy(&half, from, sizeof half);
    const float value = from_half(swapped ? (uint16_t)(half << 8 | half >> 8) : half);
    memcpy(to, &value, sizeof value);
}

// Copy one row of a channel; to_copy: from the array.
static void copy_row(const struct hfpy_pixels *p, int c, int y, int to_copy)
{
    char *array = p->at[c] + y * p->row[c];
    char *packed = p->copy + ((size_t)y * (size_t)p->width * (size_t)p->copy_pixel) + c * p->copy_sample;
    // Most pictures: plain floats.
    if (p->sample == 4 && !p->swapped) {
        char *to = to_copy ? packed : array;
        const char *from = to_copy ? array : packed;
        const ptrdiff_t to_step = to_copy ? p->copy_pixel : p->column[c], step = to_copy ? p->column[c] : p->copy_pixel;
        for (int x = 0; x < p->width; x++)
            memcpy(to + x * to_step, from + x * step, 4);
        return;
    }
    for (int x = 0; x < p->width; x++, array += p->column[c], packed += p->copy_pixel) {
        char *to = to_copy ? packed : array;
        const char *from = to_copy ? array : packed;
        if (p->copy_sample != p->sample)
            copy_half(to, from, p->swapped);
        else if (!p->swapped)
            memcpy(to, from, (size_t)p->sample);
        else
            for (int b = 0; b < p->sample; b++)
                to[b] = from[p->sample - 1 - b];
    }
}

static int new_copy(struct hfpy_pixels *p, int pixel, int sample)
{
    p->copy_pixel = pixel;
    p->copy_sample = sample;
    p->copy = PyMem_Malloc((size_t)p->width * (size_t)p->height * (size_t)pixel);
    if (!p->copy) {
        PyErr_Format(PyExc_MemoryError, "%s: out of memory for a copy of %d x %d pixels", p->name, p->width, p->height);
        return -1;
    }
    return 0;
}

// Plain floats of which alpha is left out: most of the copies.
static void pack(const struct hfpy_pixels *p)
{
    for (int y = 0; y < p->height; y++) {
        const char *from = p->at[0] + y * p->row[0];
        char *to = p->copy + (size_t)y * (size_t)p->width * 12;
        for (int x = 0; x < p->width; x++)
            memcpy(to + (size_t)x * 12, from + (size_t)x * 16, 12);
    }
}

static void read_copy(struct hfpy_pixels *p)
{
    if (p->type == 'f' && !p->swapped && p->used == 3 && p->column[0] == 16 && p->at[1] == p->at[0] + 4 &&
        p->at[2] == p->at[0] + 8 && p->row[1] == p->row[0] && p->row[2] == p->row[0]) {
        pack(p);
        return;
    }
    for (int y = 0; y < p->height; y++)
        for (int c = 0; c < p->used; c++)
            copy_row(p, c, y, 1);
    // The library has 16-bit numbers in fours alone: the fourth is an alpha of 1.
    const uint16_t one = 0xffff;
    if (p->used == 3 && p->type == 'H')
        for (size_t i = 0; i < (size_t)p->width * (size_t)p->height; i++)
            memcpy(p->copy + i * (size_t)p->copy_pixel + 3 * sizeof one, &one, sizeof one);
}

// Fill p->image for the channels in use.
static int image(struct hfpy_pixels *p, int copy, int read)
{
    const struct hf_image empty = {.size = sizeof p->image, .width = p->width, .height = p->height};
    const int four = p->used == 4, bare_half = read && p->type == 'e' && !four;
    p->image = empty;
    if (!copy && direct(p))
        return 0;
    p->image = empty;
    p->image.format = p->type == 'f' || bare_half ? (four ? HF_FORMAT_RGBA32F : HF_FORMAT_RGB32F)
                      : p->type == 'e'            ? HF_FORMAT_RGBA16F
                      : p->type == 'H'            ? HF_FORMAT_RGBA16
                      : four                      ? HF_FORMAT_RGBA8
                                                  : HF_FORMAT_RGBX8;
    const int sample = bare_half ? 4 : p->sample;
    if (new_copy(p, (p->type == 'f' || bare_half ? p->used : 4) * sample, sample))
        return -1;
    if (read)
        read_copy(p);
    p->image.data[0] = p->copy;
    p->image.stride[0] = (ptrdiff_t)p->width * p->copy_pixel;
    return 0;
}

// Is alpha 1 everywhere? Then its blur is 1 too, and need not be computed. The command leaves it out, and the layers engine
// has other bits then; that of other engines is the same.
static int is_opaque(const struct hfpy_pixels *p)
{
    const size_t bytes = (size_t)p->sample;
    uint32_t one = 0, sample = 0;
    if (p->type == 'f')
        one = p->swapped ? 0x0000803f : 0x3f800000;
    else
        memcpy(&one, p->swapped ? &(uint16_t){0x003c} : &(uint16_t){0x3c00}, bytes);
    for (int y = 0; y < p->height; y++) {
        const char *at = p->at[3] + y * p->row[3];
        for (int x = 0; x < p->width; x++, at += p->column[3]) {
            if (bytes == 4)
                memcpy(&sample, at, 4);
            else
                memcpy(&sample, at, 2);
            if (sample != one)
                return 0;
        }
    }
    return 1;
}

int hfpy_image(struct hfpy_pixels *p, int copy, int read)
{
    p->used = p->channels;
    return image(p, copy, read);
}

int hfpy_image_for(struct hfpy_pixels *p, int copy, enum hf_engine engine)
{
    const int floats = p->type == 'f' || p->type == 'e';
    p->used = p->channels;
    if (engine == HF_ENGINE_LAYERS && floats && p->channels == 4 && is_opaque(p))
        p->used = 3;
    return image(p, copy, 1);
}

int hfpy_image_in_place(struct hfpy_pixels *to, const struct hfpy_pixels *from)
{
    to->used = from->used;
    return image(to, 0, 0);
}

int hfpy_depth(struct hfpy_pixels *p, int copy, struct hf_depth *depth)
{
    if (p->type == 'B')
        return fail(p, "has samples of 8 bits; it must have float32, float16, uint16 or uint32");
    depth->size = sizeof *depth;
    const int packed = depth->format == HF_DEPTH_FORMAT_D24S8 || depth->format == HF_DEPTH_FORMAT_X8D24;
    if (packed != (p->type == 'I' && packed))
        return fail(p, "must have uint32 for this depth_format");
    if (!packed)
        depth->format = p->type == 'f'   ? HF_DEPTH_FORMAT_FLOAT32
                        : p->type == 'e' ? HF_DEPTH_FORMAT_FLOAT16
                        : p->type == 'H' ? HF_DEPTH_FORMAT_UNORM16
                                         : HF_DEPTH_FORMAT_UNORM32;
    if (!copy && !p->swapped && aligned(p, 0) && (p->width == 1 || p->column[0] == p->sample) &&
        rows_apart(p, 0, p->sample, &depth->stride)) {
        depth->data = p->at[0];
        return 0;
    }
    if (new_copy(p, p->sample, p->sample))
        return -1;
    for (int y = 0; y < p->height; y++)
        copy_row(p, 0, y, 1);
    depth->data = p->copy;
    depth->stride = (ptrdiff_t)p->width * p->sample;
    return 0;
}

void hfpy_write_back(const struct hfpy_pixels *p)
{
    for (int y = 0; p->copy && y < p->height; y++)
        for (int c = 0; c < p->channels; c++)
            copy_row(p, c, y, 0);
}

// The addresses that a channel covers, from *low up to *high.
static void extent(const struct hfpy_pixels *p, int c, uintptr_t *low, uintptr_t *high)
{
    const ptrdiff_t rows = (p->height - 1) * p->row[c], columns = (p->width - 1) * p->column[c];
    *low = (uintptr_t)p->at[c] + (uintptr_t)((rows < 0 ? rows : 0) + (columns < 0 ? columns : 0));
    *high = (uintptr_t)p->at[c] + (uintptr_t)((rows > 0 ? rows : 0) + (columns > 0 ? columns : 0) + p->sample);
}

int hfpy_overlap(const struct hfpy_pixels *a, const struct hfpy_pixels *b)
{
    for (int i = 0; i < a->channels; i++)
        for (int j = 0; j < b->channels; j++) {
            uintptr_t low[2], high[2];
            extent(a, i, &low[0], &high[0]);
            extent(b, j, &low[1], &high[1]);
            if (low[0] < high[1] && low[1] < high[0])
                return 1;
        }
    return 0;
}

int hfpy_same(const struct hfpy_pixels *a, const struct hfpy_pixels *b)
{
    if (a->channels != b->channels || a->type != b->type || a->swapped != b->swapped)
        return 0;
    for (int c = 0; c < a->channels; c++)
        if (a->at[c] != b->at[c] || a->row[c] != b->row[c] || a->column[c] != b->column[c])
            return 0;
    return 1;
}

static ptrdiff_t distance(ptrdiff_t stride)
{
    return stride < 0 ? -stride : stride;
}

// The steps of an array from one channel, column and row to the next: sorted by size, each must go beyond all that the
// smaller ones reach. This refuses some strange arrays without overlap, and no array with one.
int hfpy_overlaps_itself(const struct hfpy_pixels *p)
{
    struct {
        ptrdiff_t step;
        int count;
    } axes[3] = {{distance(p->row[0]), p->height},
                 {distance(p->column[0]), p->width},
                 {p->view_count == 1 && p->channels > 1 ? distance(p->at[1] - p->at[0]) : 0,
                  p->view_count == 1 ? p->channels : 1}};
    ptrdiff_t reach = p->sample;
    for (int n = 0; n < 3; n++) {
        int least = -1;
        for (int i = 0; i < 3; i++)
            if (axes[i].count > 1 && (least < 0 || axes[i].step < axes[least].step))
                least = i;
        if (least < 0)
            break;
        if (axes[least].step < reach)
            return 1;
        reach += axes[least].step * (axes[least].count - 1);
        axes[least].count = 1;
    }
    for (int i = 0; i < p->view_count && p->view_count > 1; i++)
        for (int j = 0; j < i; j++) {
            uintptr_t low[2], high[2];
            extent(p, i, &low[0], &high[0]);
            extent(p, j, &low[1], &high[1]);
            if (low[0] < high[1] && low[1] < high[0])
                return 1;
        }
    return 0;
}
