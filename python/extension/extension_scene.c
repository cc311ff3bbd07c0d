/* SPDX-License-Identifier: Apache-2.0 */
/* What analyses of models take: models with names, terms that are left out or assumed, motions and
 * aids; and pieces of what they give back. */
#include "extension_scene.h"

#include "imukit/aid_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- models ---- */

void models_free(model_list *list)
{
    PyMem_Free(list->memory);
    PyMem_Free(list->assumed);
    *list = (model_list){.count = 0};
}

/* Names of a tuple. @return false with an exception */
static bool take_names(PyObject *names, const char *argument, size_t *count, const char **name)
{
    *count = (size_t)PyTuple_Size(names);
    if (*count == 0 || *count > TERMS_MAX) {
        PyErr_Format(PyExc_ValueError, "%s: expected 1 to %d names of terms", argument, TERMS_MAX);
        return false;
    }
    for (size_t k = 0; k < *count; k++)
        if (!(name[k] = PyUnicode_AsUTF8AndSize(PyTuple_GetItem(names, (Py_ssize_t)k), NULL)))
            return false;
    return true;
}

static bool select_terms(const model_terms *t, imk_model *model)
{
    const char *name[TERMS_MAX];
    size_t count;
    imk_error error;
    PyObject *names = t->only ? t->only : t->without;
    if (!names)
        return true;
    if (!take_names(names, t->only ? "only" : "without", &count, name))
        return false;
    if (imk_model_select(model, t->only != NULL, count, name, &error) == IMK_OK)
        return true;
    raise_error(&error, t->only ? "only" : "without");
    return false;
}

bool terms_take(PyObject *tuple, model_terms *t)
{
    static const char *const classes[] = {"own",      "strategic", "navigation",
                                          "tactical", "AHRS",      "control"};
    const char *assume;
    *t = (model_terms){.grade = IMK_GRADE_NONE};
    if (!PyArg_ParseTuple(tuple, "OOz", &t->only, &t->without, &assume))
        return false;
    t->only = t->only == Py_None ? NULL : t->only;
    t->without = t->without == Py_None ? NULL : t->without;
    if (t->only && t->without) {
        PyErr_SetString(PyExc_ValueError, "only and without exclude each other");
        return false;
    }
    t->assume = assume != NULL;
    for (size_t k = 0; assume && k < sizeof classes / sizeof *classes; k++)
        if (strcmp(assume, classes[k]) == 0) {
            t->grade = k > 0 ? (imk_grade)(k - 1) : IMK_GRADE_NONE;
            return true;
        }
    if (assume)
        PyErr_Format(PyExc_ValueError,
                     "assume_class='%s': expected own, strategic, navigation, tactical, AHRS or "
                     "control",
                     assume);
    return !assume;
}

static bool take_model(PyObject *pair, const model_terms *t, model_list *list, size_t m)
{
    PyObject *object;
    if (!PyArg_ParseTuple(pair, "sO", &list->name[m], &object))
        return false;
    const model_object *given = model_of(object);
    if (!given)
        return false;
    *list->model[m] = *list->whole[m] = *list->given[m] = given->model;
    if (!select_terms(t, list->model[m]))
        return false;
    if (t->assume) {
        imk_model_assume_class(list->model[m], t->grade, &list->assumed[m]);
        imk_model_assume_class(list->whole[m], t->grade, NULL);
    }
    return true;
}

bool models_take(PyObject *pairs, const model_terms *t, model_list *list)
{
    const Py_ssize_t count = PyTuple_Size(pairs);
    *list = (model_list){.terms = *t};
    if (count < 1 || count > IMK_DRIFT_MODELS_MAX) {
        PyErr_Format(PyExc_ValueError, "models: expected 1 to %d, and there are %zd",
                     IMK_DRIFT_MODELS_MAX, count);
        return false;
    }
    list->count = (size_t)count;
    list->memory = PyMem_Calloc(3 * list->count, sizeof *list->memory);
    list->assumed = PyMem_Calloc(list->count, sizeof *list->assumed);
    if (!list->memory || !list->assumed) {
        PyErr_NoMemory();
        return false;
    }
    for (size_t m = 0; m < list->count; m++) {
        list->model[m] = list->memory + 3 * m;
        list->whole[m] = list->model[m] + 1;
        list->given[m] = list->model[m] + 2;
        if (!take_model(PyTuple_GetItem(pairs, (Py_ssize_t)m), t, list, m))
            return false;
    }
    return true;
}

void page_models(const model_list *list, imk_result *result)
{
    imk_result_for(result, IMK_FOR_PAGE);
    for (size_t m = 0; m < list->count; m++) {
        char *text = NULL;
        size_t size = 0;
        if (imk_model_print(list->model[m], NULL, &text, &size, NULL) == IMK_OK) {
            imk_result_heading(result, list->name[m]);
            imk_result_code(result, text);
        }
        free(text);
    }
}

/* ---- motions ---- */

bool motion_take(PyObject *pair, motion_use *use)
{
    PyObject *object;
    if (!PyTuple_Check(pair)) {
        PyErr_SetString(PyExc_TypeError, "expected a motion with its name");
        return false;
    }
    if (!PyArg_ParseTuple(pair, "sO", &use->name, &object))
        return false;
    use->file = motion_of(object);
    return use->file != NULL;
}

/* ---- aids ---- */

bool aids_take(PyObject *texts, imk_aid aid[IMK_AIDS_MAX], size_t *count)
{
    *count = 0;
    for (Py_ssize_t k = 0; k < PyTuple_Size(texts); k++) {
        imk_aid more[IMK_AIDS_MAX];
        size_t found;
        imk_error error;
        const char *text = PyUnicode_AsUTF8AndSize(PyTuple_GetItem(texts, k), NULL);
        if (!text)
            return false;
        if (imk_aid_parse(text, more, &found, &error) != IMK_OK) {
            raise_error(&error, text);
            return false;
        }
        if (*count + found > IMK_AIDS_MAX) {
            PyErr_Format(PyExc_ValueError, "aids: at most %d quantities in all", IMK_AIDS_MAX);
            return false;
        }
        memcpy(aid + *count, more, found * sizeof *more);
        *count += found;
    }
    return true;
}

/* ---- what is given back ---- */

bool add_finding(PyObject *findings, imk_finding_level level, const char *code, const char *format,
                 ...)
{
    char text[1600];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    PyObject *message = PyUnicode_DecodeUTF8(text, (Py_ssize_t)strlen(text), "replace");
    PyObject *item = message ? Py_BuildValue("(isNs)", (int)level, code, message, "") : NULL;
    const bool added = item && PyList_Append(findings, item) == 0;
    Py_XDECREF(item);
    return added;
}

bool add_verdict(PyObject *findings, const imk_verdict *verdict)
{
    bool good = true;
    for (size_t i = 0; i < verdict->count && good; i++)
        good = add_finding(findings, verdict->message[i].level, verdict->message[i].code, "%s",
                           verdict->message[i].text);
    return good;
}

PyObject *numbers_of(const double *number, size_t count)
{
    return PyBytes_FromStringAndSize((const char *)number, (Py_ssize_t)(count * sizeof *number));
}

PyObject *model_text_of(const imk_model *model)
{
    char *text = NULL;
    size_t size = 0;
    imk_error error;
    if (imk_model_print(model, NULL, &text, &size, &error) != IMK_OK)
        return raise_error(&error, NULL);
    PyObject *made = PyUnicode_DecodeUTF8(text, (Py_ssize_t)size, "replace");
    free(text);
    return made;
}
