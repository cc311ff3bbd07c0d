/* SPDX-License-Identifier: Apache-2.0 */
/* Records: arrays, logs, and logs that are loaded as a whole, whose columns are arrays of Python
 * without a copy. */
#include "extension.h"

#include <math.h>
#include <string.h>

static PyObject *record_type, *column_type;

static void record_free(PyObject *self)
{
    record *r = (record *)self;
    PyTypeObject *type = Py_TYPE(self);
    imk_log_close(r->reader);
    columns_release(&r->columns);
    PyMem_Free(r->name);
    ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
    Py_DECREF(type);
}

static record *new_record(const char *name)
{
    record *r = (record *)PyType_GenericAlloc((PyTypeObject *)record_type, 0);
    if (!r)
        return NULL;
    const size_t size = strlen(name) + 1;
    r->name = PyMem_Malloc(size);
    if (!r->name) {
        Py_DECREF(r);
        PyErr_NoMemory();
        return NULL;
    }
    memcpy(r->name, name, size);
    return r;
}

record *record_begin(PyObject *object)
{
    if (Py_TYPE(object) != (PyTypeObject *)record_type) {
        PyErr_SetString(PyExc_TypeError, "expected a record");
        return NULL;
    }
    record *r = (record *)object;
    if (r->busy) {
        PyErr_SetString(PyExc_RuntimeError, "another thread reads this record");
        return NULL;
    }
    r->busy = true;
    return r;
}

void record_end(record *r)
{
    r->busy = false;
}

PyObject *record_of_reader(void *reader, const char *name)
{
    record *r = new_record(name);
    if (!r) {
        imk_log_close(reader);
        return NULL;
    }
    r->reader = reader;
    r->source = imk_log_source(reader);
    return (PyObject *)r;
}

/* arrays(name, names, data, rate) */
static PyObject *of_arrays(PyObject *module, PyObject *args)
{
    const char *name, *names[IMK_LOG_COLUMNS_MAX];
    PyObject *list, *data;
    double rate;
    imk_error error;
    (void)module;
    if (!PyArg_ParseTuple(args, "sO!Od", &name, &PyTuple_Type, &list, &data, &rate))
        return NULL;
    record *r = new_record(name);
    if (!r || !columns_take(data, &r->columns)) {
        Py_XDECREF((PyObject *)r);
        return NULL;
    }
    bool good = (size_t)PyTuple_Size(list) == r->columns.count;
    if (!good)
        PyErr_Format(PyExc_ValueError, "%zd names of columns for %zu columns", PyTuple_Size(list),
                     r->columns.count);
    for (size_t k = 0; good && k < r->columns.count; k++) {
        names[k] = PyUnicode_AsUTF8AndSize(PyTuple_GetItem(list, (Py_ssize_t)k), NULL);
        good = names[k] != NULL;
    }
    if (good &&
        imk_array_source_strided(r->columns.count, names, (const double *const *)r->columns.data,
                                 r->columns.stride, r->columns.rows, rate, &r->array, &r->source,
                                 &error) != IMK_OK) {
        raise_error(&error, NULL);
        good = false;
    }
    if (!good)
        Py_CLEAR(r);
    return (PyObject *)r;
}

/** Settings of a log, as imk_log_settings has them. */
static const setting log_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_log_settings, field), words                                     \
    }
    ROW(columns, SETTING_TEXT, NULL),     ROW(map, SETTING_TEXT, NULL),
    ROW(gyro_unit, SETTING_TEXT, NULL),   ROW(accel_unit, SETTING_TEXT, NULL),
    ROW(time_unit, SETTING_TEXT, NULL),   ROW(temperature_unit, SETTING_TEXT, NULL),
    ROW(format, SETTING_TEXT, NULL),      ROW(binary, SETTING_TEXT, NULL),
    ROW(topic, SETTING_TEXT, NULL),       ROW(gyro_scale, SETTING_TEXT, NULL),
    ROW(accel_scale, SETTING_TEXT, NULL), ROW(device, SETTING_TEXT, NULL),
    ROW(gyro_range, SETTING_TEXT, NULL),  ROW(accel_range, SETTING_TEXT, NULL),
    ROW(rate, SETTING_QUANTITY, "Hz"),    ROW(after, SETTING_QUANTITY, "s"),
    ROW(before, SETTING_QUANTITY, "s"),   ROW(axes, SETTING_TEXT, NULL),
    ROW(any_columns, SETTING_FLAG, NULL), ROW(as_written, SETTING_FLAG, NULL),
    ROW(reopened, SETTING_FLAG, NULL),    ROW(instance, SETTING_INT, NULL),
#undef ROW
};

bool log_settings_read(PyObject *dictionary, imk_log_settings *settings)
{
    return SETTINGS_READ(dictionary, log_rows, settings);
}

/* open_log(path, settings) */
static PyObject *open_log(PyObject *module, PyObject *args)
{
    PyObject *path, *dictionary;
    (void)module;
    if (!PyArg_ParseTuple(args, "O&O!", PyUnicode_FSConverter, &path, &PyDict_Type, &dictionary))
        return NULL;
    const char *name = PyBytes_AsString(path);
    imk_log_settings settings = imk_log_default();
    imk_log_reader *reader = NULL;
    imk_error error;
    PyObject *opened = NULL;
    if (SETTINGS_READ(dictionary, log_rows, &settings)) {
        PyThreadState *state = PyEval_SaveThread();
        const imk_status status = imk_log_open(name, &settings, &reader, &error);
        PyEval_RestoreThread(state);
        opened = status == IMK_OK ? record_of_reader(reader, name) : raise_error(&error, name);
    }
    Py_DECREF(path);
    return opened;
}

/* A column of a loaded log: the object that owns all columns, and which one it is. */
typedef struct column {
    PyObject_HEAD PyObject *owner; /* a capsule of the imk_log */
    double *data;
    Py_ssize_t rows, stride;
} column;

static void column_free(PyObject *self)
{
    PyTypeObject *type = Py_TYPE(self);
    Py_XDECREF(((column *)self)->owner);
    ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
    Py_DECREF(type);
}

static int column_buffer(PyObject *self, Py_buffer *view, int flags)
{
    column *c = (column *)self;
    (void)flags;
    *view = (Py_buffer){.buf = c->data,
                        .obj = Py_NewRef(self),
                        .len = c->rows * (Py_ssize_t)sizeof(double),
                        .itemsize = sizeof(double),
                        .ndim = 1,
                        .format = (flags & PyBUF_FORMAT) ? "d" : NULL,
                        .shape = (flags & PyBUF_ND) ? &c->rows : NULL,
                        .strides = (flags & PyBUF_STRIDES) == PyBUF_STRIDES ? &c->stride : NULL};
    return 0;
}

static void free_log(PyObject *capsule)
{
    imk_log *log = PyCapsule_GetPointer(capsule, NULL);
    imk_log_free(log);
    PyMem_Free(log);
}

static PyObject *column_of(PyObject *owner, double *data, size_t rows)
{
    column *c = (column *)PyType_GenericAlloc((PyTypeObject *)column_type, 0);
    if (!c)
        return NULL;
    c->owner = Py_NewRef(owner);
    c->data = data;
    c->rows = (Py_ssize_t)rows;
    c->stride = sizeof(double);
    return (PyObject *)c;
}

/* Name, unit in the file, SI unit, and the numbers. */
static PyObject *describe_column(PyObject *owner, const imk_log *log, size_t k)
{
    const imk_log_column *c = &log->column[k];
    char si[40];
    if (imk_dimension_si(c->unit.dimension, si, sizeof si) == 0)
        si[0] = '\0';
    PyObject *numbers = column_of(owner, log->data[k], log->rows);
    return numbers ? Py_BuildValue("(sssN)", c->name, c->unit.text, si, numbers) : NULL;
}

PyObject *describe_log(imk_log *log)
{
    PyObject *owner = PyCapsule_New(log, NULL, free_log);
    PyObject *list = owner ? PyList_New(0) : NULL;
    for (size_t k = 0; list && k < log->column_count; k++) {
        PyObject *item = describe_column(owner, log, k);
        if (!item || PyList_Append(list, item) != 0)
            Py_CLEAR(list);
        Py_XDECREF(item);
    }
    PyObject *labels = list ? PyList_New(0) : NULL;
    for (size_t k = 0; labels && k < log->label_count; k++) {
        PyObject *text =
            PyUnicode_DecodeUTF8(log->label[k], (Py_ssize_t)strlen(log->label[k]), "replace");
        if (!text || PyList_Append(labels, text) != 0)
            Py_CLEAR(labels);
        Py_XDECREF(text);
    }
    const imk_log_findings *f = &log->findings;
    PyObject *described =
        labels
            ? Py_BuildValue("(OOnddddnnnnN)", list, labels, (Py_ssize_t)log->rows, f->interval,
                            f->first_time, f->last_time, f->time_origin, (Py_ssize_t)f->gaps,
                            (Py_ssize_t)f->missing, (Py_ssize_t)f->not_finite,
                            (Py_ssize_t)f->damaged, PyLong_FromLongLong(f->time_origin_nanoseconds))
            : NULL;
    Py_XDECREF(labels);
    Py_XDECREF(list);
    Py_XDECREF(owner);
    return described;
}

/* load_log(path, settings, progress) */
static PyObject *load_log(PyObject *module, PyObject *args)
{
    PyObject *path, *dictionary, *progress, *loaded = NULL;
    (void)module;
    if (!PyArg_ParseTuple(args, "O&O!O", PyUnicode_FSConverter, &path, &PyDict_Type, &dictionary,
                          &progress))
        return NULL;
    imk_log_settings settings = imk_log_default();
    imk_log *log = PyMem_Calloc(1, sizeof *log);
    imk_error error;
    work w;
    if (!log)
        PyErr_NoMemory();
    else if (SETTINGS_READ(dictionary, log_rows, &settings) && work_begin(&w, 1, progress)) {
        const imk_status status =
            imk_log_load(PyBytes_AsString(path), &settings, &w.job, log, &error);
        const bool good = work_end(&w);
        if (status == IMK_OK && good) {
            loaded = describe_log(log);
            log = NULL;
        } else if (good) {
            raise_error(&error, PyBytes_AsString(path));
        }
        if (status == IMK_OK && log)
            imk_log_free(log);
    }
    PyMem_Free(log);
    Py_DECREF(path);
    return loaded;
}

PyMethodDef record_functions[] = {
    {"arrays", of_arrays, METH_VARARGS, "arrays(name, names, data, rate): a record of arrays."},
    {"open_log", open_log, METH_VARARGS, "open_log(path, settings): a record of a log."},
    {"load_log", load_log, METH_VARARGS, "load_log(path, settings, progress): a log in memory."},
    {NULL, NULL, 0, NULL}};

static PyType_Slot record_slots[] = {{Py_tp_dealloc, (void *)record_free}, {0, NULL}};
static PyType_Spec record_spec = {.name = "imukit._core.Record",
                                  .basicsize = sizeof(record),
                                  .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                                  .slots = record_slots};

static PyType_Slot column_slots[] = {
    {Py_tp_dealloc, (void *)column_free}, {Py_bf_getbuffer, (void *)column_buffer}, {0, NULL}};
static PyType_Spec column_spec = {.name = "imukit._core.Column",
                                  .basicsize = sizeof(column),
                                  .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                                  .slots = column_slots};

bool add_record(PyObject *module)
{
    record_type = PyType_FromSpec(&record_spec);
    column_type = PyType_FromSpec(&column_spec);
    return record_type && column_type &&
           PyModule_AddObjectRef(module, "Record", record_type) == 0 &&
           PyModule_AddObjectRef(module, "Column", column_type) == 0;
}
