// SPDX-License-Identifier: BSD-3-Clause
// The module hyperfocal._hyperfocal: its functions, and how it begins.
#include "hfpy.h"

static PyObject *depth_at(PyObject *module, PyObject *args, PyObject *kwargs)
{
    struct hfpy_given g;
    struct hfpy_pixels map = {0};
    struct hf_message message = {.size = sizeof message};
    PyObject *positional = NULL, *result = NULL, *depth;
    int x, y;
    float z;
    (void)module;
    if (!PyArg_ParseTuple(args, "Oii:depth_at", &depth, &x, &y))
        return NULL;
    positional = PyTuple_Pack(1, depth);
    if (!positional)
        return NULL;
    if (!hfpy_read(&g, "depth_at", positional, kwargs, 0, HFPY_DEPTH | HFPY_ONLY_DEPTH) &&
        !hfpy_open_plane(&map, depth, "depth", 0) && !hfpy_depth(&map, 0, &g.depth)) {
        const int error = hf_depth_at(&g.depth, map.width, map.height, x, y, &z, &message);
        result = error ? hfpy_raise(error, &message) : PyFloat_FromDouble(z);
    }
    hfpy_close(&map);
    hfpy_release(&g);
    Py_DECREF(positional);
    return result;
}

static PyObject *choose_quality(PyObject *module, PyObject *args, PyObject *kwargs)
{
    struct hfpy_given g;
    struct hf_choice choice = {.size = sizeof choice};
    PyObject *empty = NULL, *settings = NULL, *numbers = NULL, *result = NULL, *words = NULL;
    int height;
    (void)module;
    if (!PyArg_ParseTuple(args, "i:choose_quality", &height))
        return NULL;
    empty = PyTuple_New(0);
    words = kwargs ? PyDict_Copy(kwargs) : PyDict_New();
    if (!empty || !words)
        goto end;
    if (!PyDict_GetItemString(words, "max_error") && !PyDict_GetItemString(words, "quality")) {
        PyErr_SetString(PyExc_TypeError, "choose_quality() needs quality or max_error");
        goto end;
    }
    if (!hfpy_read(&g, "choose_quality", empty, words, 0, 0) && !hfpy_choose(&g, height, &choice)) {
        settings = hfpy_settings(&g);
        numbers = settings ? hfpy_choice_dict(&choice) : NULL;
        result = numbers ? PyTuple_Pack(2, settings, numbers) : NULL;
    }
    hfpy_release(&g);
end:
    Py_XDECREF(numbers);
    Py_XDECREF(settings);
    Py_XDECREF(words);
    Py_XDECREF(empty);
    return result;
}

#define WITH_KEYWORDS(f) (PyCFunction)(void (*)(void))(f), METH_VARARGS | METH_KEYWORDS

static PyMethodDef functions[] = {
    {"coc", WITH_KEYWORDS(hfpy_coc),
     "coc(depth, *, out=None, **parameters)\n\nThe signed radius of the circle of confusion of each pixel, "
     "full-resolution "
     "pixels: negative in front of the focus, 0 in focus. float32, (height, width). depth, out and parameters: as for "
     "defocus. "
     "The gaussian engine may blend its blur by depth instead, which this does not tell."},
    {"depth_at", WITH_KEYWORDS(depth_at),
     "depth_at(depth, x, y, *, depth_type='view', ...)\n\nThe view depth at a pixel, scene units. The other arguments "
     "are "
     "those of defocus about depth. ValueError where there is no surface."},
    {"choose_quality", WITH_KEYWORDS(choose_quality),
     "choose_quality(height, *, quality=None, max_error=None, **parameters)\n\nThe engine and settings for a quality "
     "or an "
     "error. Returns two dicts: keyword arguments for defocus, and what the choice is expected to cost: error and "
     "worst (root "
     "mean square distance of the display-encoded pictures), ms (of a megapixel), and why, if a cheaper one was passed "
     "over. "
     "height: of the pictures, pixels."},
    {0},
};

static int start(PyObject *module)
{
    PyObject *type = PyType_FromModuleAndSpec(module, &hfpy_context_spec, NULL), *words = hfpy_descriptions();
    int failed = !type || !words || PyModule_AddObjectRef(module, "Context", type) ||
                 PyModule_AddObjectRef(module, "parameters", words) ||
                 PyModule_AddStringConstant(module, "__version__", hf_version());
    Py_XDECREF(words);
    Py_XDECREF(type);
    return failed ? -1 : 0;
}

static PyModuleDef_Slot slots[] = {{Py_mod_exec, (void *)start}, {0, NULL}};
static struct PyModuleDef definition = {PyModuleDef_HEAD_INIT, .m_name = "hyperfocal._hyperfocal",
                                        .m_methods = functions, .m_slots = slots};

PyMODINIT_FUNC PyInit__hyperfocal(void);  // Python looks for it
PyMODINIT_FUNC PyInit__hyperfocal(void)
{
    return PyModuleDef_Init(&definition);
}
