// SPDX-License-Identifier: BSD-3-Clause
// The type Context. One thread at a time works in it; others wait.
#include "hfpy.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

enum { MOST_WARNINGS = 8, SENTENCE = 400 };

struct context {
    PyObject_HEAD struct hf_context *c;  // NULL: closed
    PyThread_type_lock lock;
    // While a frame runs: the thread's state, and when signals were looked at last. Ctrl-C ends a frame.
    PyThreadState *state;
    double looked;
    // What the library warned of during the call.
    int warnings;
    char warning[MOST_WARNINGS][SENTENCE];
};

static void on_log(void *cookie, const struct hf_message *message)
{
    struct context *self = cookie;
    if (message->level == HF_LOG_WARNING && self->warnings < MOST_WARNINGS)
        hfpy_sentence(message, self->warning[self->warnings++], SENTENCE);
}

static double seconds(void)
{
    struct timespec now;
    return timespec_get(&now, TIME_UTC) ? (double)now.tv_sec + 1e-9 * (double)now.tv_nsec : 0;
}

// Look for signals ten times a second: more often would make the frame wait for other threads of Python.
static int on_progress(void *cookie, float done)
{
    struct context *self = cookie;
    const double now = seconds();
    if (done >= 1 || now - self->looked < 0.1)
        return 0;
    self->looked = now;
    PyEval_RestoreThread(self->state);
    const int stop = PyErr_CheckSignals();
    self->state = PyEval_SaveThread();
    return stop;
}

static void lock(struct context *self)
{
    if (PyThread_acquire_lock(self->lock, NOWAIT_LOCK))
        return;
    Py_BEGIN_ALLOW_THREADS PyThread_acquire_lock(self->lock, WAIT_LOCK);
    Py_END_ALLOW_THREADS
}

static PyObject *context_new(PyTypeObject *type, PyObject *args, PyObject *kwargs)
{
    static char *names[] = {"threads", "isa", NULL};
    struct hf_config config = {.size = sizeof config};
    const char *isa = "auto";
    if (!PyArg_ParseTupleAndKeywords(args, kwargs, "|is:Context", names, &config.threads, &isa))
        return NULL;
    int value = 0;
    if (hf_value(HF_NAMES_ISA, isa, &value))
        return PyErr_Format(PyExc_ValueError, "isa is '%.40s'; it must be auto, scalar, sse4.1, avx2, avx512 or neon",
                            isa);
    config.isa = (enum hf_isa)value;
    allocfunc alloc = (allocfunc)PyType_GetSlot(type, Py_tp_alloc);
    struct context *self = (struct context *)alloc(type, 0);
    if (!self)
        return NULL;
    self->lock = PyThread_allocate_lock();
    config.log = on_log;
    config.log_cookie = self;
    const int error = self->lock ? hf_open(&self->c, &config) : HF_ERR_MEMORY;
    if (error) {
        Py_DECREF(self);
        if (error == HF_ERR_ARG)
            return PyErr_Format(PyExc_ValueError, "threads is %d; it must be 0 (all) to 256", config.threads);
        if (error == HF_ERR_ISA)
            return PyErr_Format(PyExc_ValueError, "isa: %s", hf_error_string(error));
        return hfpy_raise(error, NULL);
    }
    hf_set_progress(self->c, on_progress, self);
    return (PyObject *)self;
}

static void context_free(PyObject *object)
{
    struct context *self = (struct context *)object;
    PyTypeObject *type = Py_TYPE(object);
    hf_close(&self->c);
    if (self->lock)
        PyThread_free_lock(self->lock);
    freefunc release = (freefunc)PyType_GetSlot(type, Py_tp_free);
    release(object);
    Py_DECREF(type);
}

static int closed(const struct context *self)
{
    if (!self->c)
        PyErr_SetString(PyExc_ValueError, "the context is closed");
    return !self->c;
}

// Hand what the library warned of to Python's warnings. Returns -1 if they are turned into exceptions.
static int warn(char warnings[][SENTENCE], int count)
{
    for (int i = 0; i < count; i++)
        if (PyErr_WarnEx(PyExc_RuntimeWarning, warnings[i], 2))
            return -1;
    return 0;
}

// A frame whose arrays are open. Called with the lock held.
static int render(struct context *self, const struct hfpy_given *g, const struct hf_image *out,
                  const struct hf_image *in, char warnings[][SENTENCE], int *warning_count)
{
    struct hf_message message = {.size = sizeof message};
    self->warnings = 0;
    self->looked = seconds();
    self->state = PyEval_SaveThread();
    const int error = hf_render(self->c, out, in, &g->depth, &g->params);
    PyEval_RestoreThread(self->state);
    *warning_count = self->warnings;
    memcpy(warnings, self->warning, sizeof self->warning);
    if (!error)
        return 0;
    if (!PyErr_Occurred()) {
        hf_get_problem(self->c, &message);
        hfpy_raise(error, message.error == error ? &message : NULL);
    }
    return -1;
}

static void set_transfer(struct hf_image *i, const struct hfpy_pixels *p, const struct hfpy_given *g)
{
    const int whole = p->type == 'B' || p->type == 'H';
    i->transfer = g->transfer >= 0 ? (enum hf_transfer)g->transfer : whole ? HF_TRANSFER_SRGB : HF_TRANSFER_LINEAR;
}

// The size of a map, or one sentence.
static int same_size(const struct hfpy_pixels *a, const struct hfpy_pixels *b)
{
    if (a->width == b->width && a->height == b->height)
        return 0;
    PyErr_Format(PyExc_ValueError, "%s has %d x %d pixels and %s has %d x %d; they must have the same size", a->name,
                 a->width, a->height, b->name, b->width, b->height);
    return -1;
}

static PyObject *defocus_into(struct context *self, struct hfpy_given *g, struct hfpy_pixels *in, struct hfpy_pixels *z,
                              struct hfpy_pixels *to, PyObject *out)
{
    char warnings[MOST_WARNINGS][SENTENCE];
    int count = 0;
    if (hfpy_open_picture(to, out, "out", 1) || same_size(to, in))
        return NULL;
    if (hfpy_overlaps_itself(to))
        return PyErr_Format(PyExc_ValueError, "out has samples that share memory");
    // In place needs the very same array; another one that shares memory would be read after it is written.
    const int in_place = hfpy_same(to, in);
    if (hfpy_depth(z, hfpy_overlap(to, z), &g->depth) || hfpy_choose(g, in->height, NULL) ||
        hfpy_image_for(in, !in_place && hfpy_overlap(to, in), g->params.engine) ||
        (in_place && !in->copy ? hfpy_image_in_place(to, in) : hfpy_image(to, 0, 0)))
        return NULL;
    const struct hf_image *aperture = g->params.aperture.picture;
    if (aperture && hfpy_overlap(to, &g->aperture)) {
        PyErr_SetString(PyExc_ValueError, "out and aperture share memory");
        return NULL;
    }
    set_transfer(&in->image, in, g);
    set_transfer(&to->image, to, g);
    lock(self);
    const int failed = closed(self) || render(self, g, &to->image, &in->image, warnings, &count);
    PyThread_release_lock(self->lock);
    if (failed)
        return NULL;
    hfpy_write_back(to);
    return warn(warnings, count) ? NULL : Py_NewRef(out);
}

static PyObject *context_defocus(PyObject *object, PyObject *args, PyObject *kwargs)
{
    struct context *self = (struct context *)object;
    struct hfpy_given g;
    struct hfpy_pixels in = {0}, z = {0}, to = {0};
    PyObject *out = NULL, *result = NULL;
    if (!hfpy_read(&g, "defocus", args, kwargs, 0, HFPY_COLOR | HFPY_DEPTH | HFPY_OUT) && !closed(self) &&
        !hfpy_open_picture(&in, g.color, "color", 0) && !hfpy_open_plane(&z, g.depth_map, "depth", 0) &&
        !same_size(&z, &in)) {
        out = g.out ? Py_NewRef(g.out) : hfpy_new_like(g.color, &in);
        if (out)
            result = defocus_into(self, &g, &in, &z, &to, out);
    }
    hfpy_close(&to);
    hfpy_close(&z);
    hfpy_close(&in);
    hfpy_release(&g);
    Py_XDECREF(out);
    return result;
}

static PyObject *context_close(PyObject *object, PyObject *unused)
{
    struct context *self = (struct context *)object;
    (void)unused;
    lock(self);
    hf_close(&self->c);
    PyThread_release_lock(self->lock);
    Py_RETURN_NONE;
}

static PyObject *context_cancel(PyObject *object, PyObject *unused)
{
    (void)unused;
    hf_cancel(((struct context *)object)->c);
    Py_RETURN_NONE;
}

static PyObject *context_enter(PyObject *object, PyObject *unused)
{
    (void)unused;
    return closed((struct context *)object) ? NULL : Py_NewRef(object);
}

static PyObject *context_exit(PyObject *object, PyObject *args)
{
    return context_close(object, args);
}

static PyObject *context_report(PyObject *object, void *unused)
{
    struct context *self = (struct context *)object;
    struct hf_report report = {.size = sizeof report};
    (void)unused;
    lock(self);
    const int failed = closed(self) || hf_get_report(self->c, &report);
    PyThread_release_lock(self->lock);
    return failed ? NULL : hfpy_report_dict(&report);
}

static PyObject *context_threads(PyObject *object, void *unused)
{
    struct context *self = (struct context *)object;
    (void)unused;
    return closed(self) ? NULL : PyLong_FromLong(hf_context_threads(self->c));
}

static PyObject *context_isa(PyObject *object, void *unused)
{
    struct context *self = (struct context *)object;
    (void)unused;
    return closed(self) ? NULL : PyUnicode_FromString(hf_isa_name(hf_context_isa(self->c)));
}

static PyMethodDef methods[] = {
    {"defocus", (PyCFunction)(void (*)(void))context_defocus, METH_VARARGS | METH_KEYWORDS,
     "defocus(color, depth, *, out=None, **parameters)\n\nAs hyperfocal.defocus, in this context."},
    {"cancel", context_cancel, METH_NOARGS,
     "End the frame that runs in this context now; its defocus raises RuntimeError. Any thread may call it."},
    {"close", context_close, METH_NOARGS, "Stop the threads and free the memory. Waits for a frame that runs."},
    {"__enter__", context_enter, METH_NOARGS, NULL},
    {"__exit__", context_exit, METH_VARARGS, NULL},
    {0},
};

static PyGetSetDef properties[] = {
    {"report", context_report, NULL,
     "What the last frame called for and what became of it: a dict of numbers, all 0 before.", NULL},
    {"threads", context_threads, NULL, "The number of threads.", NULL},
    {"isa", context_isa, NULL, "The instruction set in use.", NULL},
    {0},
};

static PyType_Slot slots[] = {
    {Py_tp_doc,
     "Context(threads=0, isa='auto')\n\n"
     "Threads and memory for many frames. threads: 0 (default), one for each processor, to 256. isa: auto (default), "
     "scalar, sse4.1, avx2, avx512 or neon. One thread at a time works in a context, others wait; two contexts run "
     "at once. Use it with `with`, or close() it."},
    {Py_tp_new, context_new},
    {Py_tp_dealloc, context_free},
    {Py_tp_methods, methods},
    {Py_tp_getset, properties},
    {0, NULL},
};

PyType_Spec hfpy_context_spec = {"hyperfocal.Context", sizeof(struct context), 0,
                                 Py_TPFLAGS_DEFAULT | Py_TPFLAGS_IMMUTABLETYPE, slots};
