/* SPDX-License-Identifier: Apache-2.0 */
/* Settings: a dictionary of Python becomes a structure of the library. */
#include "extension.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *utf8_of(PyObject *object, Py_ssize_t *size)
{
    if (PyUnicode_Check(object))
        return PyUnicode_AsUTF8AndSize(object, size);
    PyErr_Format(PyExc_TypeError, "expected a text, not %R", (PyObject *)Py_TYPE(object));
    return NULL;
}

/* Numbers that were meant in degrees are refused where an angle has an end. */
static bool angle_check(double value, const char *name, const char *unit)
{
    static const struct {
        const char *end;
        double most; /* [rad] */
    } angles[] = {{"latitude", 1.5707963267948968},  {"dip", 1.5707963267948968},
                  {"longitude", 6.2831853071795872}, {"roll", 6.2831853071795872},
                  {"pitch", 6.2831853071795872},     {"yaw", 6.2831853071795872},
                  {"heading", 6.2831853071795872}};
    const size_t length = strlen(name);
    imk_error error;
    for (size_t k = 0; k < sizeof angles / sizeof angles[0] && strcmp(unit, "rad") == 0; k++) {
        const size_t size = strlen(angles[k].end);
        if (size > length || strcmp(name + length - size, angles[k].end) != 0 ||
            fabs(value) <= angles[k].most)
            continue;
        char text[200];
        snprintf(
            text, sizeof text,
            "%.40s=%g: a number is taken as radians, and expected within %.4g; write degrees as "
            "a text: '%g deg'",
            name, value, angles[k].most, value);
        imk_error_set(&error, IMK_ERROR_RANGE, name, "", "");
        error.value = value;
        error.limit = angles[k].most;
        raise_message(&error, text);
        return false;
    }
    return true;
}

bool quantity_read(PyObject *object, const char *name, const char *unit, double *value)
{
    imk_error error;
    double sigma;
    size_t count;
    if (PyBool_Check(object)) {
        PyErr_Format(PyExc_TypeError, "%s=%R: expected a number, or a text with a unit", name,
                     object);
        return false;
    }
    if (!PyUnicode_Check(object)) {
        *value = PyFloat_AsDouble(object);
        return !PyErr_Occurred() && angle_check(*value, name, unit);
    }
    Py_ssize_t size;
    const char *text = utf8_of(object, &size);
    if (!text)
        return false;
    if (imk_quantity_parse(text, text + size, imk_unit_of(unit).dimension, 1, value, &sigma, &count,
                           NULL, &error) == IMK_OK)
        return true;
    raise_error(&error, name);
    return false;
}

static bool choice_read(PyObject *object, const setting *row, int *value)
{
    const char *text = utf8_of(object, NULL);
    if (!text)
        return false;
    const size_t length = strlen(text);
    *value = 0;
    for (const char *word = row->words; *word; (*value)++) {
        const size_t size = strcspn(word, "|");
        if (size == length && memcmp(word, text, size) == 0)
            return true;
        word += size + (word[size] == '|');
    }
    PyErr_Format(PyExc_ValueError, "%s='%s': expected one of %s", row->name, text, row->words);
    return false;
}

bool unit_read(PyObject *object, const char *name, imk_unit *unit)
{
    Py_ssize_t size;
    imk_error error;
    const char *text = utf8_of(object, &size);
    if (!text)
        return false;
    if (imk_unit_parse(text, text + size, unit, &error) == IMK_OK)
        return true;
    raise_error(&error, name);
    return false;
}

/* A whole number from `least` on. */
static bool whole_read(PyObject *object, const setting *row, long long least, long long *value)
{
    *value = PyLong_AsLongLong(object);
    if (PyErr_Occurred())
        return false;
    if (*value >= least)
        return true;
    PyErr_Format(PyExc_ValueError, "%s=%lld: expected at least %lld", row->name, *value, least);
    return false;
}

/* True, False, or a number that is 1 or 0, such as a bool of NumPy. */
static bool flag_read(PyObject *object, const char *name, bool *value)
{
    *value = PyObject_RichCompareBool(object, Py_True, Py_EQ) == 1;
    if (*value || PyObject_RichCompareBool(object, Py_False, Py_EQ) == 1)
        return true;
    if (!PyErr_Occurred())
        PyErr_Format(PyExc_TypeError, "%s=%R: expected True or False", name, object);
    return false;
}

static bool value_read(PyObject *object, const setting *row, void *at)
{
    long long whole;
    switch (row->kind) {
    case SETTING_NUMBER:
        *(double *)at = PyFloat_AsDouble(object);
        return !PyErr_Occurred();
    case SETTING_QUANTITY:
        return quantity_read(object, row->name, row->words, at);
    case SETTING_FLAG:
        return flag_read(object, row->name, at);
    case SETTING_INT:
        if (!whole_read(object, row, -2147483647, &whole) || whole > 2147483647)
            break;
        *(int *)at = (int)whole;
        return true;
    case SETTING_SIZE:
        if (!whole_read(object, row, 0, &whole))
            return false;
        *(size_t *)at = (size_t)whole;
        return true;
    case SETTING_COUNT:
        *(uint64_t *)at = PyLong_AsUnsignedLongLong(object);
        return !PyErr_Occurred();
    case SETTING_TEXT:
        *(const char **)at = utf8_of(object, NULL);
        return *(const char **)at != NULL;
    case SETTING_CHOICE:
        return choice_read(object, row, at);
    case SETTING_UNIT:
        return unit_read(object, row->name, at);
    }
    if (!PyErr_Occurred())
        PyErr_Format(PyExc_ValueError, "%s: the number is too large", row->name);
    return false;
}

bool settings_read(PyObject *dictionary, size_t count, const setting *rows, void *structure)
{
    PyObject *key, *value;
    Py_ssize_t at = 0;
    while (PyDict_Next(dictionary, &at, &key, &value)) {
        const char *name = utf8_of(key, NULL);
        size_t k = 0;
        if (!name)
            return false;
        while (k < count && strcmp(rows[k].name, name) != 0)
            k++;
        if (k == count) {
            PyErr_Format(PyExc_TypeError, "there is no setting '%s'", name);
            return false;
        }
        if (value != Py_None && !value_read(value, &rows[k], (char *)structure + rows[k].offset))
            return false;
    }
    return true;
}
