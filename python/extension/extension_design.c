/* SPDX-License-Identifier: Apache-2.0 */
/* Instruments from first principles: their descriptions, and designs as objects. */
#include "extension_design.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static PyObject *design_type;

/* ---- descriptions ---------------------------------------------------------------------------- */

/* The value of a field in SI: a float, an int, a word, or a bool. */
static PyObject *field_value(const imk_design_field *field, const void *from)
{
    const char *place = (const char *)from + field->offset;
    char word[64];
    double number;
    int whole;
    bool is_on;
    switch (field->kind) {
    case IMK_DESIGN_NUMBER:
        memcpy(&number, place, sizeof number);
        return PyFloat_FromDouble(number);
    case IMK_DESIGN_COUNT:
        memcpy(&whole, place, sizeof whole);
        return PyLong_FromLong(whole);
    case IMK_DESIGN_SWITCH:
        memcpy(&is_on, place, sizeof is_on);
        return PyBool_FromLong(is_on);
    default:
        imk_design_field_text(field, from, 0, word, sizeof word);
        return PyUnicode_FromString(word);
    }
}

/* A number in SI as text in the unit of the field: "400 Hz". */
static PyObject *text_in_unit(const imk_design_field *field, double value)
{
    char text[64];
    imk_design_field one = *field;
    int whole = isfinite(value) ? (int)fmax(fmin(value, 2147483647.0), -2147483647.0) : 0;
    if (!isfinite(value) || field->kind == IMK_DESIGN_CHOICE || field->kind == IMK_DESIGN_SWITCH)
        return Py_NewRef(Py_None);
    one.offset = 0;
    imk_design_field_text(&one, one.kind == IMK_DESIGN_COUNT ? (void *)&whole : (void *)&value, 6,
                          text, sizeof text);
    return PyUnicode_FromString(text);
}

/* (path, kind, unit, SI unit, minimum, maximum, open, choices, help, default as text) */
static PyObject *describe_field(const imk_design_field *f, const void *standard)
{
    static const char *const kinds[] = {"number", "count", "choice", "switch"};
    char si[40] = "", text[128] = "";
    if (f->kind == IMK_DESIGN_NUMBER)
        imk_dimension_si(imk_unit_of(f->unit).dimension, si, sizeof si);
    imk_design_field_text(f, standard, 6, text, sizeof text);
    return Py_BuildValue("(ssssNNOzss)", f->path, kinds[f->kind], f->unit ? f->unit : "", si,
                         text_in_unit(f, f->minimum), text_in_unit(f, f->maximum),
                         f->open ? Py_True : Py_False, f->choices, f->help, text);
}

/* (name, SI unit, unit, help) */
static PyObject *describe_signal(const imk_signal *s)
{
    return Py_BuildValue("(ssss)", s->name, s->si, s->unit, s->help);
}

static PyObject *describe_fields(const imk_instrument *i)
{
    void *standard = PyMem_Calloc(1, i->design_size);
    PyObject *list = standard ? PyList_New(0) : PyErr_NoMemory();
    if (standard)
        i->set_default(standard);
    for (size_t k = 0; list && k < i->field_count; k++)
        if (!append(list, describe_field(&i->fields[k], standard)))
            Py_CLEAR(list);
    PyMem_Free(standard);
    return list;
}

static PyObject *describe_signals(size_t count, const imk_signal *signals)
{
    PyObject *list = PyList_New(0);
    for (size_t k = 0; list && k < count; k++)
        if (!append(list, describe_signal(&signals[k])))
            Py_CLEAR(list);
    return list;
}

static PyObject *describe_views(const imk_instrument *i)
{
    PyObject *list = PyList_New(0);
    for (size_t k = 0; list && k < i->view_count; k++)
        if (!append(list, Py_BuildValue("(ss)", i->views[k].title, i->views[k].caption)))
            Py_CLEAR(list);
    return list;
}

/* instruments() -> list of (name, title, technology, source, sensor, fields, outputs, signals,
 * views) */
static PyObject *instruments(PyObject *module, PyObject *none)
{
    PyObject *list = PyList_New(0);
    (void)module;
    (void)none;
    for (size_t k = 0; list && k < imk_instrument_count(); k++) {
        const imk_instrument *i = imk_instrument_get(k);
        if (!append(list, Py_BuildValue(
                              "(sssssNNNN)", i->name, i->title, i->technology, i->source,
                              i->sensor == IMK_GYRO ? "gyro" : "accel", describe_fields(i),
                              describe_signals(i->output_count, i->outputs),
                              describe_signals(i->signal_count, i->signals), describe_views(i))))
            Py_CLEAR(list);
    }
    return list;
}

/* ---- designs --------------------------------------------------------------------------------- */

static void design_free(PyObject *self)
{
    PyTypeObject *type = Py_TYPE(self);
    imk_design_file_free(&((design *)self)->file);
    ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
    Py_DECREF(type);
}

design *design_of(PyObject *object)
{
    if (Py_TYPE(object) == (PyTypeObject *)design_type)
        return (design *)object;
    PyErr_SetString(PyExc_TypeError, "expected a design");
    return NULL;
}

static PyObject *make_design(imk_status status, imk_design_file *file, const imk_error *error,
                             const char *source)
{
    if (status != IMK_OK)
        return raise_error(error, source);
    design *made = (design *)PyType_GenericAlloc((PyTypeObject *)design_type, 0);
    if (made)
        made->file = *file;
    else
        imk_design_file_free(file);
    return (PyObject *)made;
}

/* open_design(name): a file, or the default design of an instrument. */
static PyObject *open_design(PyObject *module, PyObject *args)
{
    PyObject *path;
    imk_design_file file = {0};
    imk_error error;
    (void)module;
    if (!PyArg_ParseTuple(args, "O&", PyUnicode_FSConverter, &path))
        return NULL;
    const char *name = PyBytes_AsString(path);
    const imk_status status = imk_design_open(name, &file, &error);
    PyObject *made = make_design(status, &file, &error,
                                 status == IMK_ERROR_NAME_UNKNOWN && error.line == 0 ? NULL : name);
    Py_DECREF(path);
    return made;
}

/* parse_design(text, instrument): of this instrument; None: of the one that the text names. */
static PyObject *parse_design(PyObject *module, PyObject *args)
{
    const char *text, *name;
    Py_ssize_t size;
    imk_design_file file = {0};
    imk_error error;
    (void)module;
    if (!PyArg_ParseTuple(args, "s#z", &text, &size, &name))
        return NULL;
    const imk_instrument *kind = name ? imk_instrument_find(name) : NULL;
    const imk_status status = imk_design_parse_as(kind, text, (size_t)size, &file, &error);
    return make_design(status, &file, &error, "the design");
}

static PyObject *print_design(PyObject *self, PyObject *none)
{
    char *text = NULL;
    size_t size = 0;
    imk_error error;
    (void)none;
    if (imk_design_print(&((design *)self)->file, &text, &size, &error) != IMK_OK)
        return raise_error(&error, NULL);
    PyObject *made = PyUnicode_DecodeUTF8(text, (Py_ssize_t)size, "replace");
    free(text);
    return made;
}

static PyObject *save(PyObject *self, PyObject *args)
{
    PyObject *path;
    imk_error error;
    if (!PyArg_ParseTuple(args, "O&", PyUnicode_FSConverter, &path))
        return NULL;
    const imk_status status =
        imk_design_write(PyBytes_AsString(path), &((design *)self)->file, &error);
    Py_DECREF(path);
    if (status != IMK_OK)
        return raise_error(&error, NULL);
    Py_RETURN_NONE;
}

static const imk_design_field *find_field(const design *d, const char *path)
{
    const imk_instrument *i = d->file.instrument;
    for (size_t k = 0; path && k < i->field_count; k++)
        if (strcmp(i->fields[k].path, path) == 0)
            return &i->fields[k];
    if (path)
        PyErr_Format(PyExc_KeyError, "the %s has no parameter '%s'", i->title, path);
    return NULL;
}

static PyObject *get(PyObject *self, PyObject *path)
{
    const imk_design_field *field = find_field((design *)self, utf8_of(path, NULL));
    return field ? field_value(field, ((design *)self)->file.design) : NULL;
}

/* The rows of settings.h do for a field what they do for a setting. */
static bool set_field(PyObject *dictionary, PyObject *value, const imk_design_field *field,
                      void *into)
{
    static const setting_kind kinds[] = {SETTING_QUANTITY, SETTING_INT, SETTING_CHOICE,
                                         SETTING_FLAG};
    if (field->kind == IMK_DESIGN_SWITCH && PyUnicode_Check(value)) {
        const setting word = {field->path, SETTING_CHOICE, 0, "no|yes"};
        int is_on = 0;
        if (!settings_read(dictionary, 1, &word, &is_on))
            return false;
        *(bool *)((char *)into + field->offset) = is_on != 0;
        return true;
    }
    const setting row = {.name = field->path,
                         .kind = kinds[field->kind],
                         .offset = field->offset,
                         .words = field->kind == IMK_DESIGN_NUMBER ? field->unit : field->choices};
    return settings_read(dictionary, 1, &row, into);
}

static bool set_fields(design *d, PyObject *values, void *into)
{
    PyObject *key, *value;
    Py_ssize_t at = 0;
    while (PyDict_Next(values, &at, &key, &value)) {
        const imk_design_field *field = find_field(d, utf8_of(key, NULL));
        PyObject *one = field ? PyDict_New() : NULL;
        const bool good =
            one && PyDict_SetItem(one, key, value) == 0 && set_field(one, value, field, into);
        Py_XDECREF(one);
        if (!good)
            return false;
    }
    return true;
}

/* assign(values): all of them, or, where one is refused, none. */
static PyObject *assign(PyObject *self, PyObject *args)
{
    design *d = (design *)self;
    PyObject *values;
    imk_error error;
    const imk_instrument *i = d->file.instrument;
    if (!PyArg_ParseTuple(args, "O!", &PyDict_Type, &values))
        return NULL;
    if (d->busy)
        return PyErr_Format(PyExc_RuntimeError, "the design is in use by a run");
    void *copy = PyMem_Malloc(i->design_size);
    if (!copy)
        return PyErr_NoMemory();
    memcpy(copy, d->file.design, i->design_size);
    if (set_fields(d, values, copy)) {
        if (imk_design_check(i, copy, &error) == IMK_OK) {
            memcpy(d->file.design, copy, i->design_size);
        } else {
            imk_design_error_in_units(i, copy, &error);
            raise_error(&error, i->title);
        }
    }
    PyMem_Free(copy);
    return PyErr_Occurred() ? NULL : Py_NewRef(Py_None);
}

/* about() -> (instrument, name, description) */
static PyObject *about(PyObject *self, PyObject *none)
{
    const imk_design_file *f = &((design *)self)->file;
    (void)none;
    return Py_BuildValue("(sss)", f->instrument->name, f->name, f->description);
}

/* rename(name, description) */
static PyObject *set_name(PyObject *self, PyObject *args)
{
    imk_design_file *f = &((design *)self)->file;
    const char *name, *description;
    if (!PyArg_ParseTuple(args, "ss", &name, &description))
        return NULL;
    if (strlen(name) >= sizeof f->name || strlen(description) >= sizeof f->description)
        return PyErr_Format(PyExc_ValueError, "name: expected at most %zu bytes, description: %zu",
                            sizeof f->name - 1, sizeof f->description - 1);
    memcpy(f->name, name, strlen(name) + 1);
    memcpy(f->description, description, strlen(description) + 1);
    Py_RETURN_NONE;
}

/* derived() -> list of (name, symbol, value, SI unit, equation, source, absent) */
static PyObject *derived(PyObject *self, PyObject *none)
{
    const imk_design_file *f = &((design *)self)->file;
    PyObject *list = PyList_New(0);
    (void)none;
    for (const imk_derived *row = f->instrument->derived; list && row && row->name; row++) {
        const double value = imk_derived_value(row, f->design);
        if (!append(list, Py_BuildValue("(ssdssszs)", row->name, row->symbol, value, row->si,
                                        row->equation, row->source,
                                        isnan(value) ? row->absent : NULL, row->unit)))
            Py_CLEAR(list);
    }
    return list;
}

PyMethodDef design_functions[] = {
    {"instruments", instruments, METH_NOARGS, "instruments(): descriptions of all."},
    {"open_design", open_design, METH_VARARGS, "open_design(name): of a file, or a default."},
    {"parse_design", parse_design, METH_VARARGS, "parse_design(text, instrument)."},
    {NULL, NULL, 0, NULL}};

static PyMethodDef methods[] = {
    {"yaml", print_design, METH_NOARGS, "yaml(): the text of its file."},
    {"save", save, METH_VARARGS, "save(path): write the file."},
    {"get", get, METH_O, "get(path): a parameter in SI."},
    {"assign", assign, METH_VARARGS, "assign(values): set parameters, all or none."},
    {"about", about, METH_NOARGS, "about(): (instrument, name, description)."},
    {"rename", set_name, METH_VARARGS, "rename(name, description)."},
    {"derived", derived, METH_NOARGS, "derived(): what follows from the parts."},
    {NULL, NULL, 0, NULL}};

static PyType_Slot slots[] = {
    {Py_tp_dealloc, (void *)design_free}, {Py_tp_methods, methods}, {0, NULL}};
static PyType_Spec spec = {.name = "imukit._core.Design",
                           .basicsize = sizeof(design),
                           .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                           .slots = slots};

bool add_design(PyObject *module)
{
    design_type = PyType_FromSpec(&spec);
    return design_type && PyModule_AddObjectRef(module, "Design", design_type) == 0;
}
