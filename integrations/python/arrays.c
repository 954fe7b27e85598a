// SPDX-License-Identifier: BSD-3-Clause
// New arrays for results: numpy's for callers who have numpy's, memoryviews for others.
#include "hfpy.h"

// numpy's module if the object is one of its arrays (a new reference), else NULL without an exception.
static PyObject *numpy_of(PyObject *object)
{
    PyObject *modules = PySys_GetObject("modules");
    PyObject *numpy = modules ? PyDict_GetItemString(modules, "numpy") : NULL;
    PyObject *array = numpy ? PyObject_GetAttrString(numpy, "ndarray") : NULL;
    const int is = array ? PyObject_IsInstance(object, array) : 0;
    Py_XDECREF(array);
    if (is != 1) {
        PyErr_Clear();
        return NULL;
    }
    return Py_NewRef(numpy);
}

static PyObject *new_view(const char *format, int sample, PyObject *shape, Py_ssize_t samples)
{
    PyObject *bytes = PyByteArray_FromStringAndSize(NULL, samples * sample);
    PyObject *view = bytes ? PyMemoryView_FromObject(bytes) : NULL;
    PyObject *cast = view ? PyObject_CallMethod(view, "cast", "sO", format, shape) : NULL;
    Py_XDECREF(view);
    Py_XDECREF(bytes);
    return cast;
}

static PyObject *like_one(PyObject *object, const struct hfpy_pixels *p, int planes)
{
    PyObject *numpy = numpy_of(object), *result = NULL;
    if (numpy) {
        PyObject *empty = PyObject_GetAttrString(numpy, "empty_like");
        PyObject *args = Py_BuildValue("(O)", object), *kwargs = Py_BuildValue("{s:O}", "subok", Py_False);
        if (empty && args && kwargs)
            result = PyObject_Call(empty, args, kwargs);
        Py_XDECREF(kwargs);
        Py_XDECREF(args);
        Py_XDECREF(empty);
        Py_DECREF(numpy);
        return result;
    }
    // A memoryview has numbers in this machine's order, and no float16.
    if (p->swapped || p->type == 'e') {
        PyErr_Format(PyExc_ValueError, "out must be given: a new array like %s takes numpy", p->name);
        return NULL;
    }
    const char format[2] = {p->type, 0};
    PyObject *shape =
        planes ? Py_BuildValue("(ii)", p->height, p->width) : Py_BuildValue("(iii)", p->height, p->width, p->channels);
    if (shape)
        result = new_view(format, p->sample, shape, (Py_ssize_t)p->height * p->width * (planes ? 1 : p->channels));
    Py_XDECREF(shape);
    return result;
}

PyObject *hfpy_new_like(PyObject *object, const struct hfpy_pixels *p)
{
    if (!PyTuple_Check(object))
        return like_one(object, p, 0);
    PyObject *planes = PyTuple_New(p->channels);
    for (int c = 0; planes && c < p->channels; c++) {
        PyObject *plane = like_one(PyTuple_GetItem(object, c), p, 1);
        if (!plane || PyTuple_SetItem(planes, c, plane)) {
            Py_DECREF(planes);
            return NULL;
        }
    }
    return planes;
}

PyObject *hfpy_new_plane(PyObject *object, int height, int width)
{
    PyObject *numpy = numpy_of(object), *shape = Py_BuildValue("(ii)", height, width), *result = NULL;
    if (shape && numpy)
        result = PyObject_CallMethod(numpy, "empty", "Os", shape, "float32");
    else if (shape)
        result = new_view("f", 4, shape, (Py_ssize_t)height * width);
    Py_XDECREF(shape);
    Py_XDECREF(numpy);
    return result;
}
