/* SPDX-License-Identifier: Apache-2.0 */
/* Models as objects. */
#include "extension.h"

#include "imukit/model_join.h"
#include "imukit/model_path.h"
#include "imukit/model_unstated.h"

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

bool is_model(PyObject *object)
{
    return Py_TYPE(object) == (PyTypeObject *)model_type;
}

model_object *model_of(PyObject *object)
{
    if (is_model(object))
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

static PyObject *text_of(imk_status status, char *text, size_t size, const imk_error *error)
{
    if (status != IMK_OK)
        return raise_error(error, NULL);
    PyObject *made = PyUnicode_DecodeUTF8(text, (Py_ssize_t)size, "replace");
    free(text);
    return made;
}

static PyObject *printed_json(const imk_model *model, const imk_document *document)
{
    char *text = NULL;
    size_t size = 0;
    imk_error error;
    const imk_status status = imk_model_print_json(model, document, &text, &size, &error);
    return text_of(status, text, size, &error);
}

static PyObject *yaml(PyObject *self, PyObject *none)
{
    const model_object *m = (model_object *)self;
    char *text = NULL;
    size_t size = 0;
    imk_error error;
    (void)none;
    const imk_status status = imk_model_print(&m->model, m->document, &text, &size, &error);
    return text_of(status, text, size, &error);
}

static PyObject *json(PyObject *self, PyObject *none)
{
    (void)none;
    return printed_json(&((model_object *)self)->model, ((model_object *)self)->document);
}

/* What the model says, whatever units and order its file has. */
static PyObject *canonical(PyObject *self, PyObject *none)
{
    (void)none;
    return printed_json(&((model_object *)self)->model, NULL);
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

/* assign(text): become the model of a text, but keep the document, so that what did not change is
 * written as it was. */
static PyObject *assign(PyObject *self, PyObject *args)
{
    model_object *m = (model_object *)self;
    const char *text;
    Py_ssize_t size;
    imk_error error;
    if (!PyArg_ParseTuple(args, "s#", &text, &size))
        return NULL;
    imk_model *model = PyMem_Calloc(1, sizeof *model);
    if (!model)
        return PyErr_NoMemory();
    const imk_status status = imk_model_parse(text, (size_t)size, model, NULL, &error);
    if (status == IMK_OK)
        m->model = *model;
    PyMem_Free(model);
    if (status == IMK_OK)
        Py_RETURN_NONE;
    error.line = error.column = 0; /* of a text that the caller did not write */
    return raise_error(&error, NULL);
}

static PyObject *rows_of(const imk_model_numbers *n, const double *numbers)
{
    const int rows = n->axes > 0 ? n->axes : 1;
    PyObject *list = PyList_New(0);
    for (int k = 0; list && k < rows * n->columns; k++) {
        PyObject *number = PyFloat_FromDouble(numbers[k]);
        if (!number || PyList_Append(list, number) != 0)
            Py_CLEAR(list);
        Py_XDECREF(number);
    }
    return list;
}

/* numbers(path) -> (axes, columns, values, sigmas, unit) */
static PyObject *numbers(PyObject *self, PyObject *args)
{
    const char *path;
    imk_model_numbers n;
    imk_error error;
    if (!PyArg_ParseTuple(args, "s", &path))
        return NULL;
    if (imk_model_numbers_get(&((model_object *)self)->model, path, &n, &error) != IMK_OK)
        return raise_error(&error, NULL);
    return Py_BuildValue("(iiNNs)", n.axes, n.columns, rows_of(&n, n.value), rows_of(&n, n.sigma),
                         n.unit);
}

/* model_paths() -> list of paths */
static PyObject *model_paths(PyObject *module, PyObject *none)
{
    char path[IMK_MODEL_PATH];
    PyObject *list = PyList_New(0);
    (void)module;
    (void)none;
    for (size_t k = 0; list && imk_model_path(k, path); k++) {
        PyObject *item = PyUnicode_FromString(path);
        if (!item || PyList_Append(list, item) != 0)
            Py_CLEAR(list);
        Py_XDECREF(item);
    }
    return list;
}

/* path_unit(path) -> unit, or None */
static PyObject *path_unit(PyObject *module, PyObject *path)
{
    const char *text = PyUnicode_AsUTF8AndSize(path, NULL);
    const char *unit = text ? imk_model_path_unit(text) : NULL;
    (void)module;
    if (!text)
        return NULL;
    return unit ? PyUnicode_FromString(unit) : Py_NewRef(Py_None);
}

/* devices() -> list of (name, grade, source, note, is_preset) */
static PyObject *devices(PyObject *module, PyObject *none)
{
    PyObject *list = PyList_New(0);
    (void)module;
    (void)none;
    for (size_t k = 0; list && k < imk_device_count(); k++) {
        const imk_device *d = imk_device_get(k);
        PyObject *item = Py_BuildValue("(ssssN)", d->name, d->grade, d->source, d->note,
                                       PyBool_FromLong(d->is_preset));
        if (!item || PyList_Append(list, item) != 0)
            Py_CLEAR(list);
        Py_XDECREF(item);
    }
    return list;
}

/* assume_class(grade): -> list of (sensor, key, text, value, unit) */
static PyObject *assume_class(PyObject *self, PyObject *args)
{
    int grade;
    imk_unstated assumed;
    if (!PyArg_ParseTuple(args, "i", &grade))
        return NULL;
    imk_model_assume_class(&((model_object *)self)->model, (imk_grade)grade, &assumed);
    PyObject *list = PyList_New(0);
    for (size_t k = 0; list && k < assumed.count; k++) {
        const imk_unstated_term *t = &assumed.term[k];
        PyObject *item =
            PyUnicode_FromFormat("%s.%s", t->sensor == IMK_GYRO ? "gyro" : "accel", t->key);
        if (!item || PyList_Append(list, item) != 0)
            Py_CLEAR(list);
        Py_XDECREF(item);
    }
    return list;
}

/* select(keep, names): switch terms off. */
static PyObject *select_terms(PyObject *self, PyObject *args)
{
    PyObject *tuple;
    int keep;
    const char *names[64];
    imk_error error;
    if (!PyArg_ParseTuple(args, "pO!", &keep, &PyTuple_Type, &tuple))
        return NULL;
    const Py_ssize_t count = PyTuple_Size(tuple);
    if (count < 1 || count > 64)
        return PyErr_Format(PyExc_ValueError, "%zd names of terms: expected 1 to 64", count);
    for (Py_ssize_t k = 0; k < count; k++)
        if (!(names[k] = PyUnicode_AsUTF8AndSize(PyTuple_GetItem(tuple, k), NULL)))
            return NULL;
    if (imk_model_select(&((model_object *)self)->model, keep, (size_t)count, names, &error) !=
        IMK_OK)
        return raise_error(&error, NULL);
    Py_RETURN_NONE;
}

PyMethodDef model_functions[] = {
    {"model_paths", model_paths, METH_NOARGS, "model_paths(): paths of all numbers."},
    {"path_unit", path_unit, METH_O, "path_unit(path): its SI unit, or None."},
    {"devices", devices, METH_NOARGS, "devices(): the catalogue."},
    {"open_model", open_model, METH_VARARGS, "open_model(name): of a file or the catalogue."},
    {"parse_model", parse_model, METH_VARARGS, "parse_model(text): of a text."},
    {NULL, NULL, 0, NULL}};

static PyMethodDef methods[] = {
    {"yaml", yaml, METH_NOARGS, "yaml(): the text of its file."},
    {"json", json, METH_NOARGS, "json(): the text of its file as JSON."},
    {"save", save, METH_VARARGS, "save(path): write the file."},
    {"assign", assign, METH_VARARGS, "assign(text): become the model of a text."},
    {"numbers", numbers, METH_VARARGS, "numbers(path): (axes, columns, values, sigmas, unit)."},
    {"canonical", canonical, METH_NOARGS, "canonical(): JSON in the units of the library."},
    {"assume_class", assume_class, METH_VARARGS, "assume_class(grade): keys that were given."},
    {"select", select_terms, METH_VARARGS, "select(keep, names): switch terms off."},
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
