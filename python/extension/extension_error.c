/* SPDX-License-Identifier: Apache-2.0 */
/* Statuses of the library become exceptions. */
#include "extension.h"

#include "imukit/io.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

static PyObject *error_class, *file_error_class;

/* Classes of FileError that are also the class of Python that errno stands for. */
static struct file_kind {
    int number; /* errno */
    const char *name;
    PyObject **base, *made;
} file_kinds[] = {{ENOENT, "imukit._core.MissingFile", &PyExc_FileNotFoundError, NULL},
                  {EACCES, "imukit._core.ForbiddenFile", &PyExc_PermissionError, NULL},
                  {EISDIR, "imukit._core.FolderForFile", &PyExc_IsADirectoryError, NULL}};
enum { FILE_KINDS = sizeof file_kinds / sizeof file_kinds[0] };

/* A class with two bases, which shows its message as the first does. */
static PyObject *class_of_two(const char *name, const char *text, PyObject *first, PyObject *second)
{
    PyObject *bases = PyTuple_Pack(2, first, second), *members = PyDict_New(), *made = NULL;
    PyObject *shown = PyObject_GetAttrString(PyExc_BaseException, "__str__");
    if (bases && members && shown && PyDict_SetItemString(members, "__str__", shown) == 0)
        made = PyErr_NewExceptionWithDoc(name, text, bases, members);
    Py_XDECREF(shown);
    Py_XDECREF(members);
    Py_XDECREF(bases);
    return made;
}

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
    if (error_class)
        file_error_class = class_of_two(
            "imukit.FileError",
            "A file that cannot be opened, read or written.\n\n"
            "It is also an OSError, with errno, strerror and filename where the system refused; "
            "one of a missing file is also a FileNotFoundError, of a forbidden one a "
            "PermissionError, of a folder an IsADirectoryError.",
            error_class, PyExc_OSError);
    for (size_t k = 0; k < FILE_KINDS && file_error_class; k++) {
        struct file_kind *kind = &file_kinds[k];
        kind->made = class_of_two(kind->name, "A FileError.", file_error_class, *kind->base);
        if (!kind->made ||
            PyModule_AddObjectRef(module, strrchr(kind->name, '.') + 1, kind->made) != 0)
            return false;
    }
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
    if (at[1] == '"' || (at[1] == '\\' && at[2] == '"')) { /* in JSON it is escaped */
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

static PyObject *class_of(const imk_error *error)
{
    if (error->status != IMK_ERROR_OPEN && error->status != IMK_ERROR_READ &&
        error->status != IMK_ERROR_WRITE)
        return error_class;
    for (size_t k = 0; k < FILE_KINDS; k++)
        if (error->value == file_kinds[k].number)
            return file_kinds[k].made;
    return file_error_class;
}

/* What the system refused, as of an OSError. */
static bool set_file(PyObject *object, const imk_error *error)
{
    return class_of(error) == error_class || error->value == 0 ||
           (set_attribute(object, "errno", PyLong_FromDouble(error->value)) &&
            set_attribute(object, "strerror", told_text(error->found)) &&
            set_attribute(object, "filename", told_text(error->field)));
}

/* @param findings  a list; NULL: none */
static PyObject *raise(const imk_error *error, const char *message, PyObject *findings)
{
    const imk_status status = error->status;
    if (status == IMK_ERROR_MEMORY)
        return PyErr_NoMemory();
    PyObject *text = told_text(message);
    PyObject *raised = text ? PyObject_CallFunctionObjArgs(class_of(error), text, NULL) : NULL;
    Py_XDECREF(text);
    if (raised && set_attribute(raised, "code", told_text(imk_status_name(status))) &&
        set_attribute(raised, "field", told_text(error->field)) && set_file(raised, error) &&
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
    const char *text = message ? utf8_of(message, NULL) : NULL;
    if (text)
        raise(error, text, list);
    Py_XDECREF(message);
    Py_XDECREF(list);
    return NULL;
}
