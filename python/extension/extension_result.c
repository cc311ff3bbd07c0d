/* SPDX-License-Identifier: Apache-2.0 */
/* Results of the library as objects: their data as JSON, their text, page and figure. */
#include "extension.h"

#include <stdlib.h>

static PyObject *result_type;

typedef struct result {
    PyObject_HEAD imk_result *result;
} result;

static void result_free(PyObject *self)
{
    PyTypeObject *type = Py_TYPE(self);
    imk_result_free(((result *)self)->result);
    ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
    Py_DECREF(type);
}

PyObject *make_result(imk_result *made)
{
    result *r = (result *)PyType_GenericAlloc((PyTypeObject *)result_type, 0);
    if (r)
        r->result = made;
    else
        imk_result_free(made);
    return (PyObject *)r;
}

imk_result *begin_result(const char *command)
{
    imk_result *made = imk_result_create(NULL);
    if (!made)
        PyErr_NoMemory();
    imk_result_text(made, "imukit", imk_version());
    imk_result_text(made, "command", command);
    return made;
}

PyObject *result_with(imk_result *made, const imk_findings *findings, const char *record,
                      const char *model)
{
    PyObject *object = make_result(made);
    PyObject *list = object ? list_findings(findings, record, model) : NULL;
    if (list)
        return Py_BuildValue("(NN)", object, list);
    Py_XDECREF(object);
    return NULL;
}

PyObject *extended(PyObject *tuple, PyObject *more)
{
    PyObject *last = tuple && more ? PyTuple_Pack(1, more) : NULL;
    PyObject *made = last ? PySequence_Concat(tuple, last) : NULL;
    Py_XDECREF(last);
    Py_XDECREF(tuple);
    Py_XDECREF(more);
    return made;
}

static PyObject *text_of(imk_status status, char *text, size_t size)
{
    if (status != IMK_OK)
        return PyErr_NoMemory();
    PyObject *object = PyUnicode_DecodeUTF8(text, (Py_ssize_t)size, "replace");
    free(text);
    return object;
}

/* What made a text of the result, which ends in a zero: arguments stand for options. */
static PyObject *told(imk_status status, char *text)
{
    if (status != IMK_OK)
        return PyErr_NoMemory();
    PyObject *object = told_text(text);
    free(text);
    return object;
}

static PyObject *json(PyObject *self, PyObject *none)
{
    char *text = NULL;
    size_t size = 0;
    (void)none;
    const imk_status status = imk_result_to_json(((result *)self)->result, &text, &size);
    return told(status, text);
}

static PyObject *plain(PyObject *self, PyObject *none)
{
    char *text = NULL;
    size_t size = 0;
    (void)none;
    const imk_status status =
        imk_result_to_text(((result *)self)->result, NULL, NULL, &text, &size);
    return told(status, text);
}

static PyObject *page(PyObject *self, PyObject *none)
{
    char *text = NULL;
    size_t size = 0;
    imk_error error;
    (void)none;
    const imk_status status = imk_result_to_page(((result *)self)->result, &text, &size, &error);
    return status == IMK_OK ? text_of(status, text, size) : raise_error(&error, NULL);
}

/* The figure that a plot of the command draws; None where there is none. */
static PyObject *figure(PyObject *self, PyObject *none)
{
    const imk_audience audiences[] = {IMK_FOR_PLOT, IMK_FOR_PAGE, IMK_FOR_TERMINAL};
    const imk_figure *found = NULL;
    char *text = NULL;
    size_t size = 0;
    imk_error error;
    (void)none;
    for (size_t k = 0; k < 3 && !found; k++)
        found = imk_result_figure_get(((result *)self)->result, audiences[k], 0);
    if (!found)
        Py_RETURN_NONE;
    const imk_status status = imk_figure_svg(found, &text, &size, &error);
    if (status == IMK_ERROR_EMPTY)
        Py_RETURN_NONE;
    return status == IMK_OK ? text_of(status, text, size) : raise_error(&error, NULL);
}

static PyMethodDef methods[] = {
    {"json", json, METH_NOARGS, "json(): the data."},
    {"text", plain, METH_NOARGS, "text(): what the command prints."},
    {"page", page, METH_NOARGS, "page(): the page as HTML."},
    {"figure", figure, METH_NOARGS, "figure(): the figure as SVG; None: there is none."},
    {NULL, NULL, 0, NULL}};

static PyType_Slot slots[] = {
    {Py_tp_dealloc, (void *)result_free}, {Py_tp_methods, methods}, {0, NULL}};
static PyType_Spec spec = {.name = "imukit._core.Result",
                           .basicsize = sizeof(result),
                           .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                           .slots = slots};

bool add_result(PyObject *module)
{
    result_type = PyType_FromSpec(&spec);
    return result_type && PyModule_AddObjectRef(module, "Result", result_type) == 0;
}
