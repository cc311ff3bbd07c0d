/* SPDX-License-Identifier: Apache-2.0 */
/* Statuses of the library become exceptions. */
#include "extension.h"

#include "imukit/io.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

static PyObject *error_class, *file_error_class;

bool add_errors(PyObject *module)
{
    error_class = PyErr_NewExceptionWithDoc(
        "imukit.Error",
        "What imukit refuses, and why.\n\n"
        "The message says what was found, what was expected and what to do. Attributes: code (such "
        "as 'IMK_ERROR_RANGE'), field (the parameter, column or file), index (axis, row or "
        "element; "
        "-1: none), value and limit (SI), line and column (in a text, from 1; 0: none). A job that "
        "fails because of the data has the attribute findings, too.",
        PyExc_ValueError, NULL);
    PyObject *bases = error_class ? PyTuple_Pack(2, error_class, PyExc_OSError) : NULL;
    if (bases)
        file_error_class = PyErr_NewExceptionWithDoc(
            "imukit.FileError", "A file that cannot be opened, read or written.", bases, NULL);
    Py_XDECREF(bases);
    return file_error_class && PyModule_AddObjectRef(module, "Error", error_class) == 0 &&
           PyModule_AddObjectRef(module, "FileError", file_error_class) == 0;
}

static bool set_attribute(PyObject *object, const char *name, PyObject *value)
{
    const bool set = value && PyObject_SetAttrString(object, name, value) == 0;
    Py_XDECREF(value);
    return set;
}

/* Options of the command become arguments: "add --rate 100Hz" is "add rate='100Hz'", "--gyro-unit"
 * is "gyro_unit". @return what follows in the message */
static const char *put_argument(const char *option, char **to)
{
    const char *at = option + 2;
    for (; islower((unsigned char)*at) || *at == '-'; at++)
        *(*to)++ = *at == '-' ? '_' : *at;
    if (*at != ' ')
        return at;
    size_t length = strcspn(at + 1, " ,;:)\"");
    char value[128];
    snprintf(value, sizeof value, "%.*s", (int)length, at + 1);
    const bool number = strspn(value, "0123456789") == strlen(value);
    const bool word = strpbrk(value, "0123456789_=/") != NULL;
    if (at[1] == '"') {
        *(*to)++ = '=';
        return at + 1;
    }
    if (!word && !isupper((unsigned char)value[0]))
        return at;
    length -= length > 0 && at[length] == '.';
    *to += sprintf(*to, word && !number ? "='%.*s'" : "=%.*s", (int)length, at + 1);
    return at + 1 + length;
}

PyObject *told_text(const char *text)
{
    char *words = PyMem_Malloc(2 * strlen(text) + 1), *end = words;
    if (!words)
        return PyErr_NoMemory();
    for (char before = ' '; *text;) {
        const bool option = strncmp(text, "--", 2) == 0 && islower((unsigned char)text[2]) &&
                            strchr(" (\"'", before);
        before = *text;
        if (option)
            text = put_argument(text, &end);
        else
            *end++ = *text++;
    }
    PyObject *object = PyUnicode_DecodeUTF8(words, end - words, "replace");
    PyMem_Free(words);
    return object;
}

/* @param findings  a list; NULL: none */
static PyObject *raise(const imk_error *error, const char *message, PyObject *findings)
{
    const imk_status status = error->status;
    if (status == IMK_ERROR_MEMORY)
        return PyErr_NoMemory();
    const bool file =
        status == IMK_ERROR_OPEN || status == IMK_ERROR_READ || status == IMK_ERROR_WRITE;
    PyObject *text = told_text(message);
    PyObject *raised =
        text ? PyObject_CallFunctionObjArgs(file ? file_error_class : error_class, text, NULL)
             : NULL;
    Py_XDECREF(text);
    if (raised && set_attribute(raised, "code", told_text(imk_status_name(status))) &&
        set_attribute(raised, "field", told_text(error->field)) &&
        set_attribute(raised, "index", PyLong_FromLong(error->index)) &&
        set_attribute(raised, "value", PyFloat_FromDouble(error->value)) &&
        set_attribute(raised, "limit", PyFloat_FromDouble(error->limit)) &&
        set_attribute(raised, "line", PyLong_FromSize_t(error->line)) &&
        set_attribute(raised, "column", PyLong_FromSize_t(error->column)) &&
        (!findings || PyObject_SetAttrString(raised, "findings", findings) == 0))
        PyErr_SetObject((PyObject *)Py_TYPE(raised), raised);
    Py_XDECREF(raised);
    return NULL;
}

PyObject *raise_message(const imk_error *error, const char *message)
{
    return raise(error, message, NULL);
}

PyObject *raise_error(const imk_error *error, const char *source)
{
    char text[1200];
    imk_error_text(error, source, text, sizeof text);
    return raise(error, text, NULL);
}

static PyObject *message_of(const imk_finding *finding, const char *record, const char *model)
{
    const size_t size = imk_finding_message(finding, record, model, NULL, 0) + 1;
    char *text = PyMem_Malloc(size);
    if (!text)
        return PyErr_NoMemory();
    imk_finding_message(finding, record, model, text, size);
    PyObject *message = told_text(text);
    PyMem_Free(text);
    return message;
}

PyObject *list_findings(const imk_findings *findings, const char *record, const char *model)
{
    PyObject *list = PyList_New(0);
    for (size_t k = 0; list && k < findings->count; k++) {
        const imk_finding *f = &findings->item[k];
        PyObject *message = message_of(f, record, model);
        PyObject *item =
            message ? Py_BuildValue("(isNs)", (int)f->level, imk_finding_code(f), message, f->name)
                    : NULL;
        if (!item || PyList_Append(list, item) != 0)
            Py_CLEAR(list);
        Py_XDECREF(item);
    }
    return list;
}

PyObject *raise_failure(const imk_findings *findings, const imk_error *error, const char *record,
                        const char *model)
{
    const imk_finding *failure = findings ? imk_findings_failure(findings) : NULL;
    if (!failure || error->status == IMK_ERROR_MEMORY)
        return raise_error(error, record);
    PyObject *list = list_findings(findings, record, model);
    PyObject *message = list ? message_of(failure, record, model) : NULL;
    const char *text = message ? PyUnicode_AsUTF8AndSize(message, NULL) : NULL;
    if (text)
        raise(error, text, list);
    Py_XDECREF(message);
    Py_XDECREF(list);
    return NULL;
}
