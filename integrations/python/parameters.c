// SPDX-License-Identifier: BSD-3-Clause
// Keyword arguments as the library's parameters, by the table that fields.py makes from the library's headers.
#include "hfpy.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "fields.h"

enum { FIELDS = sizeof fields / sizeof fields[0] };

static void *field_of(const struct hfpy_given *g, int i)
{
    return (char *)(uintptr_t)g + fields[i].offset;
}

void hfpy_sentence(const struct hf_message *message, char *text, size_t size)
{
    const char *argument = message->argument, *name = NULL;
    for (int i = 0; i < FIELDS && !name; i++)
        if (!strcmp(fields[i].path, argument))
            name = fields[i].keyword;
    if (!name && !strncmp(argument, "src", 3))
        name = "color";
    if (!name && !strncmp(argument, "dst", 3))
        name = "out";
    if (!name && !strncmp(argument, "aperture.picture", 16))
        name = "aperture";
    if (name)
        snprintf(text, size, "%s%s", name, message->sentence + strlen(argument));
    else
        snprintf(text, size, "%s", message->sentence);
}

PyObject *hfpy_raise(int error, const struct hf_message *message)
{
    PyObject *type = error == HF_ERR_MEMORY                                ? PyExc_MemoryError
                     : error == HF_ERR_THREAD || error == HF_ERR_CANCELLED ? PyExc_RuntimeError
                                                                           : PyExc_ValueError;
    char text[400];
    if (message && message->sentence[0])
        hfpy_sentence(message, text, sizeof text);
    else
        snprintf(text, sizeof text, "%s", hf_error_string(error));
    PyErr_SetString(type, text);
    return NULL;
}

static int bad_word(const struct hfpy_field *f, const char *word)
{
    char list[256] = "";
    const char *name;
    for (int v = 0; (name = hf_name(f->names, v)); v++) {
        const size_t n = strlen(list);
        snprintf(list + n, sizeof list - n, "%s%s", v ? ", " : "", name);
    }
    PyErr_Format(PyExc_ValueError, "%s is '%.40s'; it must be one of %s", f->keyword, word, list);
    return -1;
}

static int set_name(const struct hfpy_field *f, PyObject *value, int *field)
{
    if (!PyUnicode_Check(value)) {
        PyErr_Format(PyExc_TypeError, "%s must be a str", f->keyword);
        return -1;
    }
    const char *word = PyUnicode_AsUTF8AndSize(value, NULL);
    if (!word)
        return -1;
    return hf_value(f->names, word, field) == HF_OK ? 0 : bad_word(f, word);
}

static int set_number(const struct hfpy_field *f, PyObject *value, void *field)
{
    const int derive = PyUnicode_Check(value) && PyUnicode_CompareWithASCIIString(value, "derive") == 0;
    if (f->kind == FIELD_FLOAT) {
        const double number = derive ? HF_DERIVE : PyFloat_AsDouble(value);
        if (number == -1 && PyErr_Occurred())
            goto no_number;
        // The library refuses what it has no use for, and says so; what a float cannot hold becomes infinite.
        *(float *)field = (float)number;
        return 0;
    }
    if (!derive && PyFloat_Check(value))
        goto no_number;
    const long number = derive ? HF_DERIVE : PyLong_AsLong(value);
    if (number == -1 && PyErr_Occurred())
        goto no_number;
    if (number < INT32_MIN || number > INT32_MAX) {
        PyErr_Format(PyExc_ValueError, "%s is %ld, which is out of range", f->keyword, number);
        return -1;
    }
    *(int *)field = (int)number;
    return 0;
no_number:
    if (PyErr_Occurred() && PyErr_ExceptionMatches(PyExc_OverflowError)) {
        PyErr_Clear();
        PyErr_Format(PyExc_ValueError, "%s is out of range", f->keyword);
    } else if (!PyErr_Occurred() || PyErr_ExceptionMatches(PyExc_TypeError)) {
        PyErr_Clear();
        PyErr_Format(PyExc_TypeError, "%s must be %s, or 'derive'", f->keyword,
                     f->kind == FIELD_INT ? "a whole number or a bool" : "a number");
    }
    return -1;
}

static int set_picture(struct hfpy_given *g, PyObject *value, const struct hf_image **field)
{
    if (hfpy_open_picture(&g->aperture, value, "aperture", 0) || hfpy_image(&g->aperture, 0, 1))
        return -1;
    *field = &g->aperture.image;
    return 0;
}

// Whether field i was given as a keyword argument.
static int find(const char *keyword)
{
    for (int i = 0; i < FIELDS; i++)
        if (!strcmp(fields[i].keyword, keyword))
            return i;
    return -1;
}

static int given(const struct hfpy_given *g, const char *keyword)
{
    const int i = find(keyword);
    return i >= 0 && g->given[i];
}

static int set(struct hfpy_given *g, const char *function, const char *keyword, PyObject *value, int takes)
{
    PyObject **object = takes & HFPY_COLOR && !strcmp(keyword, "color")   ? &g->color
                        : takes & HFPY_DEPTH && !strcmp(keyword, "depth") ? &g->depth_map
                        : takes & HFPY_OUT && !strcmp(keyword, "out")     ? &g->out
                                                                          : NULL;
    if (object && *object) {
        PyErr_Format(PyExc_TypeError, "%s() got multiple values for argument '%s'", function, keyword);
        return -1;
    }
    if (object) {
        *object = value;
        return 0;
    }
    const int i = find(keyword);
    if (i < 0 || (takes & HFPY_ONLY_DEPTH && strcmp(fields[i].group, "depth"))) {
        PyErr_Format(PyExc_TypeError, "%s() got an unexpected keyword argument '%s'", function, keyword);
        return -1;
    }
    if (value == Py_None)
        return 0;
    g->given[i] = 1;
    switch (fields[i].kind) {
    case FIELD_NAME:
        return set_name(&fields[i], value, field_of(g, i));
    case FIELD_PICTURE:
        return set_picture(g, value, field_of(g, i));
    case FIELD_FLOAT:
    case FIELD_INT:
        break;
    }
    return set_number(&fields[i], value, field_of(g, i));
}

// As in the command: a range if one of its arguments is given, else a lens if one of its is.
static void set_model(struct hfpy_given *g)
{
    int range = 0;
    for (int i = 0; i < FIELDS; i++)
        range |= g->given[i] && !strcmp(fields[i].group, "range");
    if (!given(g, "model") && !range && (given(g, "f_number") || given(g, "focal_length")))
        g->params.model = HF_MODEL_LENS;
}

// A quality chooses the engine's settings: they must not be given as well.
static int check_choice(const struct hfpy_given *g)
{
    const char *by = given(g, "quality") ? "quality" : given(g, "max_error") ? "max_error" : NULL;
    if (by && given(g, "quality") && given(g, "max_error")) {
        PyErr_SetString(PyExc_ValueError, "quality and max_error cannot be given together: each chooses the settings");
        return -1;
    }
    for (int i = 0; i < FIELDS && by; i++)
        if (g->given[i] && fields[i].engine) {
            PyErr_Format(PyExc_ValueError, "%s and %s cannot be given together: %s chooses the engine and its settings",
                         fields[i].keyword, by, by);
            return -1;
        }
    return 0;
}

static int read_positional(struct hfpy_given *g, const char *function, PyObject *args, int skip, int takes)
{
    PyObject **places[2];
    int count = 0;
    if (takes & HFPY_COLOR)
        places[count++] = &g->color;
    if (takes & HFPY_DEPTH)
        places[count++] = &g->depth_map;
    const Py_ssize_t n = PyTuple_Size(args) - skip;
    if (n > count) {
        PyErr_Format(PyExc_TypeError, "%s() takes %d positional arguments but %zd were given", function, count + skip,
                     n + skip);
        return -1;
    }
    for (Py_ssize_t i = 0; i < n; i++)
        *places[i] = PyTuple_GetItem(args, i + skip);
    return 0;
}

int hfpy_read(struct hfpy_given *g, const char *function, PyObject *args, PyObject *kwargs, int skip, int takes)
{
    *g = (struct hfpy_given){.params = hf_default_params(), .depth = {.size = sizeof g->depth}, .transfer = -1};
    g->params.engine = HF_ENGINE_LAYERS;
    if (read_positional(g, function, args, skip, takes))
        return -1;
    PyObject *key, *value;
    for (Py_ssize_t at = 0; kwargs && PyDict_Next(kwargs, &at, &key, &value);) {
        const char *keyword = PyUnicode_AsUTF8AndSize(key, NULL);
        if (!keyword || set(g, function, keyword, value, takes))
            return -1;
    }
    const char *missing = takes & HFPY_COLOR && !g->color       ? "color"
                          : takes & HFPY_DEPTH && !g->depth_map ? "depth"
                                                                : NULL;
    if (missing) {
        PyErr_Format(PyExc_TypeError, "%s() missing the argument '%s'", function, missing);
        return -1;
    }
    if (g->out == Py_None)
        g->out = NULL;
    set_model(g);
    return check_choice(g);
}

int hfpy_choose(struct hfpy_given *g, int height, struct hf_choice *choice)
{
    struct hf_message message = {.size = sizeof message};
    int error = HF_OK;
    if (given(g, "max_error"))
        error = hf_choose_error(height, &g->depth, &g->params, g->max_error, choice, &message);
    else if (given(g, "quality"))
        error = hf_choose_quality(height, &g->depth, &g->params, (enum hf_quality)g->quality, choice, &message);
    if (error)
        hfpy_raise(error, &message);
    return error ? -1 : 0;
}

void hfpy_release(struct hfpy_given *g)
{
    hfpy_close(&g->aperture);
}

// Put a new reference into a dict.
static int put(PyObject *dict, const char *key, PyObject *value)
{
    const int failed = !value || PyDict_SetItemString(dict, key, value);
    Py_XDECREF(value);
    return failed ? -1 : 0;
}

static PyObject *or_none(PyObject *dict, int failed)
{
    if (failed)
        Py_DECREF(dict);
    return failed ? NULL : dict;
}

PyObject *hfpy_settings(const struct hfpy_given *g)
{
    static const char *const derive = "derive";
    const struct hf_params plain = hf_default_params();
    PyObject *dict = PyDict_New();
    int failed = 0;
    for (int i = 0; dict && !failed && i < FIELDS; i++) {
        const struct hfpy_field *f = &fields[i];
        const void *field = field_of(g, i);
        const int engine = !strcmp(f->path, "engine");
        // All that differs from the defaults; the engine in any case.
        if (!f->engine ||
            (!engine && !memcmp(field, (const char *)&plain + (f->offset - offsetof(struct hfpy_given, params)), 4)))
            continue;
        const double number = f->kind == FIELD_FLOAT ? *(const float *)field : *(const int *)field;
        failed = put(dict, f->keyword,
                     f->kind == FIELD_NAME    ? PyUnicode_FromString(hf_name(f->names, (int)number))
                     : number == HF_DERIVE    ? PyUnicode_FromString(derive)
                     : f->kind == FIELD_FLOAT ? PyFloat_FromDouble(number)
                                              : PyLong_FromLong((long)number));
    }
    return dict ? or_none(dict, failed) : NULL;
}

static PyObject *numbers(const void *from, const struct hfpy_number *rows, size_t count)
{
    PyObject *dict = PyDict_New();
    int failed = 0;
    for (size_t i = 0; dict && !failed && i < count; i++) {
        const void *field = (const char *)from + rows[i].offset;
        failed = put(dict, rows[i].name,
                     rows[i].type == 'i'   ? PyLong_FromLong(*(const int *)field)
                     : rows[i].type == 'u' ? PyLong_FromUnsignedLongLong(*(const uint64_t *)field)
                     : rows[i].type == 'f' ? PyFloat_FromDouble(*(const float *)field)
                                           : PyFloat_FromDouble(*(const double *)field));
    }
    return dict ? or_none(dict, failed) : NULL;
}

PyObject *hfpy_report_dict(const struct hf_report *report)
{
    return numbers(report, report_numbers, sizeof report_numbers / sizeof report_numbers[0]);
}

PyObject *hfpy_choice_dict(const struct hf_choice *choice)
{
    PyObject *dict = numbers(choice, choice_numbers, sizeof choice_numbers / sizeof choice_numbers[0]);
    if (dict && choice->why && put(dict, "why", PyUnicode_FromString(choice->why)))
        Py_CLEAR(dict);
    return dict;
}

PyObject *hfpy_descriptions(void)
{
    PyObject *dict = PyDict_New();
    int failed = 0;
    for (int i = 0; dict && !failed && i < FIELDS; i++)
        failed = put(dict, fields[i].keyword, PyUnicode_FromString(fields[i].doc));
    return dict ? or_none(dict, failed) : NULL;
}
