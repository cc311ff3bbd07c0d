/* SPDX-License-Identifier: Apache-2.0 */
/* Models in the formats of other programs. */
#include "extension.h"

#include "imukit/parameter_file.h"

#include <stdlib.h>
#include <string.h>

static const setting parameter_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_parameter_settings, field), words                               \
    }
    ROW(rate, SETTING_QUANTITY, "Hz"),
    ROW(density, SETTING_CHOICE, "as-the-program|two-sided|one-sided"),
    ROW(sensor, SETTING_TEXT, NULL),
    ROW(frame_rate, SETTING_QUANTITY, "Hz"),
    ROW(bias_instability_tau, SETTING_QUANTITY, "s"),
    ROW(use_bounds, SETTING_FLAG, NULL),
    {"flicker", SETTING_CHOICE, offsetof(imk_parameter_settings, filter.flicker),
     "random-walk|gauss-markov|two-gauss-markov|left-out"},
    {"tau_from", SETTING_QUANTITY, offsetof(imk_parameter_settings, filter.from), "s"},
    {"tau_to", SETTING_QUANTITY, offsetof(imk_parameter_settings, filter.to), "s"},
#undef ROW
};

/* The format of a name, "" for one that is to be found. @return false with an exception */
static bool read_format(const char *name, imk_parameter_format *format)
{
    *format = imk_parameter_format_find(name);
    if (*format != IMK_PARAMETERS_UNKNOWN || name[0] == '\0')
        return true;
    PyErr_Format(PyExc_ValueError, "'%s' is no format of parameters: see parameter_formats()",
                 name);
    return false;
}

/* A list of (lost, text). */
static PyObject *list_notes(const imk_parameter_notes *notes)
{
    PyObject *list = PyList_New(0);
    for (size_t k = 0; list && k < notes->count; k++) {
        const char *text = notes->note[k].text;
        PyObject *item =
            Py_BuildValue("(NN)", PyBool_FromLong(notes->note[k].lost),
                          PyUnicode_DecodeUTF8(text, (Py_ssize_t)strlen(text), "replace"));
        if (!item || PyList_Append(list, item) != 0)
            Py_CLEAR(list);
        Py_XDECREF(item);
    }
    return list;
}

/* read_parameters(path or None, text or None, format, settings) -> (model, notes) */
static PyObject *read_parameters(PyObject *module, PyObject *args)
{
    PyObject *path, *dictionary, *encoded = NULL, *made = NULL;
    const char *text, *format;
    Py_ssize_t size;
    imk_parameter_settings s = imk_parameter_default();
    imk_error error;
    (void)module;
    if (!PyArg_ParseTuple(args, "Oz#sO!", &path, &text, &size, &format, &PyDict_Type,
                          &dictionary) ||
        !SETTINGS_READ(dictionary, parameter_rows, &s) || !read_format(format, &s.format) ||
        (!text && !PyUnicode_FSConverter(path, &encoded)))
        return NULL;
    imk_model *model = PyMem_Calloc(1, sizeof *model);
    imk_parameter_notes *notes = PyMem_Calloc(1, sizeof *notes);
    const char *name = encoded ? PyBytes_AsString(encoded) : "the parameters";
    if (!model || !notes) {
        PyErr_NoMemory();
    } else if ((text ? imk_parameters_parse(text, (size_t)size, &s, model, notes, &error)
                     : imk_parameters_read(name, &s, model, notes, &error)) != IMK_OK) {
        raise_error(&error, name);
    } else {
        PyObject *object = make_model(model, NULL);
        made = object ? Py_BuildValue("(NN)", object, list_notes(notes)) : NULL;
    }
    PyMem_Free(notes);
    PyMem_Free(model);
    Py_XDECREF(encoded);
    return made;
}

/* write_parameters(model, path or None, format, settings) -> (text, notes); without a path the file
 * is not written */
static PyObject *write_parameters(PyObject *module, PyObject *args)
{
    PyObject *object, *path, *dictionary, *encoded = NULL, *made = NULL;
    const char *format;
    char *text = NULL;
    size_t size = 0;
    imk_parameter_settings s = imk_parameter_default();
    imk_error error;
    (void)module;
    if (!PyArg_ParseTuple(args, "OOsO!", &object, &path, &format, &PyDict_Type, &dictionary))
        return NULL;
    const model_object *m = model_of(object);
    if (!m || !SETTINGS_READ(dictionary, parameter_rows, &s) || !read_format(format, &s.format) ||
        (path != Py_None && !PyUnicode_FSConverter(path, &encoded)))
        return NULL;
    const char *name = encoded ? PyBytes_AsString(encoded) : NULL;
    imk_parameter_notes *notes = PyMem_Calloc(1, sizeof *notes);
    if (!notes) {
        PyErr_NoMemory();
    } else if ((name && imk_parameters_write(name, &s, &m->model, notes, &error) != IMK_OK) ||
               imk_parameters_print(name, &s, &m->model, &text, &size, notes, &error) != IMK_OK) {
        raise_error(&error, NULL);
    } else {
        PyObject *list = list_notes(notes);
        PyObject *written = PyUnicode_DecodeUTF8(text, (Py_ssize_t)size, "replace");
        made = list && written ? PyTuple_Pack(2, written, list) : NULL;
        Py_XDECREF(list);
        Py_XDECREF(written);
    }
    free(text);
    PyMem_Free(notes);
    Py_XDECREF(encoded);
    return made;
}

/* parameter_formats() -> list of names */
static PyObject *parameter_formats(PyObject *module, PyObject *none)
{
    PyObject *list = PyList_New(0);
    const char *name;
    (void)module;
    (void)none;
    for (int k = 1; list && (name = imk_parameter_format_name((imk_parameter_format)k)); k++) {
        PyObject *item = PyUnicode_FromString(name);
        if (!item || PyList_Append(list, item) != 0)
            Py_CLEAR(list);
        Py_XDECREF(item);
    }
    return list;
}

PyMethodDef parameter_functions[] = {
    {"read_parameters", read_parameters, METH_VARARGS,
     "read_parameters(path, text, format, settings) -> (model, notes)."},
    {"write_parameters", write_parameters, METH_VARARGS,
     "write_parameters(model, path, format, settings) -> (text, notes)."},
    {"parameter_formats", parameter_formats, METH_NOARGS, "parameter_formats(): their names."},
    {NULL, NULL, 0, NULL}};
