/* SPDX-License-Identifier: Apache-2.0 */
/* Models as objects. */
#include "extension.h"

#include <stdlib.h>
#include <string.h>

static PyObject *model_type;

static void model_free(PyObject *self)
{
    PyTypeObject *type = Py_TYPE(self);
    imk_document_free(((model_object *)self)->document);
    ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
    Py_DECREF(type);
}

model_object *model_of(PyObject *object)
{
    if (Py_TYPE(object) == (PyTypeObject *)model_type)
        return (model_object *)object;
    PyErr_SetString(PyExc_TypeError, "expected a model");
    return NULL;
}

PyObject *make_model(const imk_model *model, imk_document *document)
{
    model_object *made = (model_object *)PyType_GenericAlloc((PyTypeObject *)model_type, 0);
    if (!made) {
        imk_document_free(document);
        return NULL;
    }
    made->model = *model;
    made->document = document;
    return (PyObject *)made;
}

static PyObject *finish(imk_status status, const imk_model *model, imk_document *document,
                        const imk_error *error, const char *source)
{
    return status == IMK_OK ? make_model(model, document) : raise_error(error, source);
}

/* open_model(name): a file, or an entry of the catalogue. */
static PyObject *open_model(PyObject *module, PyObject *args)
{
    PyObject *path;
    imk_error error;
    imk_document *document = NULL;
    (void)module;
    if (!PyArg_ParseTuple(args, "O&", PyUnicode_FSConverter, &path))
        return NULL;
    imk_model *model = PyMem_Calloc(1, sizeof *model);
    PyObject *made = NULL;
    if (!model) {
        PyErr_NoMemory();
    } else {
        const imk_status status = imk_model_open(PyBytes_AsString(path), model, &document, &error);
        made = finish(status, model, document, &error, NULL);
    }
    PyMem_Free(model);
    Py_DECREF(path);
    return made;
}

/* parse_model(text) */
static PyObject *parse_model(PyObject *module, PyObject *args)
{
    const char *text;
    Py_ssize_t size;
    imk_error error;
    imk_document *document = NULL;
    (void)module;
    if (!PyArg_ParseTuple(args, "s#", &text, &size))
        return NULL;
    imk_model *model = PyMem_Calloc(1, sizeof *model);
    if (!model)
        return PyErr_NoMemory();
    const imk_status status = imk_model_parse(text, (size_t)size, model, &document, &error);
    PyObject *made = finish(status, model, document, &error, "the model");
    PyMem_Free(model);
    return made;
}

static PyObject *printed(model_object *m, bool json)
{
    char *text = NULL;
    size_t size = 0;
    imk_error error;
    const imk_status status =
        json ? imk_model_print_json(&m->model, m->document, &text, &size, &error)
             : imk_model_print(&m->model, m->document, &text, &size, &error);
    if (status != IMK_OK)
        return raise_error(&error, NULL);
    PyObject *made = PyUnicode_DecodeUTF8(text, (Py_ssize_t)size, "replace");
    free(text);
    return made;
}

static PyObject *yaml(PyObject *self, PyObject *none)
{
    (void)none;
    return printed((model_object *)self, false);
}

static PyObject *json(PyObject *self, PyObject *none)
{
    (void)none;
    return printed((model_object *)self, true);
}

/* save(path) */
static PyObject *save(PyObject *self, PyObject *args)
{
    model_object *m = (model_object *)self;
    PyObject *path;
    imk_error error;
    if (!PyArg_ParseTuple(args, "O&", PyUnicode_FSConverter, &path))
        return NULL;
    const imk_status status =
        imk_model_write(PyBytes_AsString(path), &m->model, m->document, &error);
    Py_DECREF(path);
    if (status != IMK_OK)
        return raise_error(&error, NULL);
    Py_RETURN_NONE;
}

PyMethodDef model_functions[] = {
    {"open_model", open_model, METH_VARARGS, "open_model(name): of a file or the catalogue."},
    {"parse_model", parse_model, METH_VARARGS, "parse_model(text): of a text."},
    {NULL, NULL, 0, NULL}};

static PyMethodDef methods[] = {
    {"yaml", yaml, METH_NOARGS, "yaml(): the text of its file."},
    {"json", json, METH_NOARGS, "json(): the text of its file as JSON."},
    {"save", save, METH_VARARGS, "save(path): write the file."},
    {NULL, NULL, 0, NULL}};

static PyType_Slot slots[] = {
    {Py_tp_dealloc, (void *)model_free}, {Py_tp_methods, methods}, {0, NULL}};
static PyType_Spec spec = {.name = "imukit._core.Model",
                           .basicsize = sizeof(model_object),
                           .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                           .slots = slots};

bool add_model(PyObject *module)
{
    model_type = PyType_FromSpec(&spec);
    return model_type && PyModule_AddObjectRef(module, "Model", model_type) == 0;
}
