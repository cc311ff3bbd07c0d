/* SPDX-License-Identifier: Apache-2.0 */
/* Records that become other records: compensated, converted, and written to a file. */
#include "extension.h"

#include "imukit/convert_log.h"
#include "imukit/log.h"
#include "imukit/show.h"

#include <stdio.h>
#include <string.h>

static const setting compensate_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_compensate_log_settings, field), words                          \
    }
    ROW(temperature, SETTING_QUANTITY, "K"),     ROW(temperature_time, SETTING_QUANTITY, "s"),
    ROW(powered_for, SETTING_QUANTITY, "s"),     ROW(rate_limit, SETTING_QUANTITY, "rad/s"),
    ROW(force_limit, SETTING_QUANTITY, "m/s^2"), ROW(flags, SETTING_FLAG, NULL),
#undef ROW
};

static const setting convert_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_convert_log_settings, field), words                             \
    }
    ROW(select, SETTING_TEXT, NULL),
    ROW(gravity_free, SETTING_FLAG, NULL),
    ROW(to_point, SETTING_FLAG, NULL),
    ROW(still, SETTING_QUANTITY, "s"),
    ROW(latitude, SETTING_QUANTITY, "rad"),
    ROW(height, SETTING_QUANTITY, "m"),
    ROW(yaw, SETTING_QUANTITY, "rad"),
    {"point_x", SETTING_QUANTITY, offsetof(imk_convert_log_settings, point.v[0]), "m"},
    {"point_y", SETTING_QUANTITY, offsetof(imk_convert_log_settings, point.v[1]), "m"},
    {"point_z", SETTING_QUANTITY, offsetof(imk_convert_log_settings, point.v[2]), "m"},
#undef ROW
};

/* (result, findings, log) of a job that ended well. */
static PyObject *show_compensated(imk_compensate_log *log, log_sink *sink, const record *r,
                                  const char *name)
{
    imk_result *shown = begin_result("compensate");
    if (!shown)
        return log_sink_end(sink, NULL);
    imk_show_compensate_log(log, r->name, name, shown);
    PyObject *both = result_with(shown, &log->findings, r->name, name);
    PyObject *described = log_sink_end(sink, both ? &r->source : NULL);
    PyObject *made =
        described ? PyTuple_Pack(3, PyTuple_GetItem(both, 0), PyTuple_GetItem(both, 1), described)
                  : NULL;
    Py_XDECREF(both);
    Py_XDECREF(described);
    return made;
}

/* compensate(record, model, terms, name of the model, settings, threads, progress); terms: a model,
 * or None -> (result, findings, log) */
static PyObject *compensate(PyObject *module, PyObject *args)
{
    PyObject *object, *whole, *part, *dictionary, *progress, *made = NULL;
    const char *name;
    int threads;
    imk_compensate_log_settings s = imk_compensate_log_default();
    work w;
    log_sink sink;
    (void)module;
    if (!PyArg_ParseTuple(args, "OOOsO!iO", &object, &whole, &part, &name, &PyDict_Type,
                          &dictionary, &threads, &progress) ||
        !SETTINGS_READ(dictionary, compensate_rows, &s))
        return NULL;
    const model_object *model = model_of(whole), *terms = NULL;
    if (!model || (part != Py_None && !(terms = model_of(part))))
        return NULL;
    imk_model *models = PyMem_Malloc(2 * sizeof *models);
    if (!models)
        return PyErr_NoMemory();
    models[0] = model->model;
    if (terms) {
        models[1] = terms->model;
        imk_compensation_model(&models[0], &models[1]);
        s.terms = &models[1];
    }
    record *r = log_sink_begin(&sink) ? record_begin(object) : NULL;
    if (r && work_begin(&w, threads, progress)) {
        imk_compensate_log *log = NULL;
        imk_error error;
        const imk_status status =
            imk_compensate_log_run(&r->source, &models[0], &s, &sink.sink, &w.job, &log, &error);
        if (work_end(&w) && status != IMK_OK)
            raise_failure(log ? &log->findings : NULL, &error, r->name, name);
        made = PyErr_Occurred() ? log_sink_end(&sink, NULL) : show_compensated(log, &sink, r, name);
        imk_compensate_log_free(log);
    } else if (sink.log) {
        log_sink_end(&sink, NULL);
    }
    if (r)
        record_end(r);
    PyMem_Free(models);
    return made;
}

/* convert(record, settings, threads, progress) -> (findings, log) */
static PyObject *convert(PyObject *module, PyObject *args)
{
    PyObject *object, *dictionary, *progress, *made = NULL;
    int threads;
    imk_convert_log_settings s = imk_convert_log_default();
    work w;
    log_sink sink;
    imk_findings findings = {.count = 0};
    (void)module;
    if (!PyArg_ParseTuple(args, "OO!iO", &object, &PyDict_Type, &dictionary, &threads, &progress) ||
        !SETTINGS_READ(dictionary, convert_rows, &s))
        return NULL;
    record *r = log_sink_begin(&sink) ? record_begin(object) : NULL;
    if (r && work_begin(&w, threads, progress)) {
        imk_error error;
        const imk_status status =
            imk_convert_log_run(&r->source, &s, &sink.sink, &w.job, &findings, &error);
        if (work_end(&w) && status != IMK_OK)
            raise_failure(&findings, &error, r->name, "the model");
        PyObject *list = PyErr_Occurred() ? NULL : list_findings(&findings, r->name, "the model");
        PyObject *described = log_sink_end(&sink, list ? &r->source : NULL);
        made = described ? PyTuple_Pack(2, list, described) : NULL;
        Py_XDECREF(list);
        Py_XDECREF(described);
    } else if (sink.log) {
        log_sink_end(&sink, NULL);
    }
    if (r)
        record_end(r);
    return made;
}

static const setting write_rows[] = {
    {"to_time_unit", SETTING_UNIT, offsetof(imk_convert_log_settings, time_unit), NULL},
    {"to_gyro_unit", SETTING_UNIT, offsetof(imk_convert_log_settings, gyro_unit), NULL},
    {"to_accel_unit", SETTING_UNIT, offsetof(imk_convert_log_settings, accel_unit), NULL},
    {"to_temperature_unit", SETTING_UNIT, offsetof(imk_convert_log_settings, temperature_unit),
     NULL},
};

/* What failed while a record was written: the output, a unit, or the record. */
static void raise_unwritten(const imk_findings *findings, imk_error *error, const record *r)
{
    const imk_finding *failure = imk_findings_failure(findings);
    if (!failure && error->status == IMK_ERROR_DIMENSION) {
        char option[sizeof error->field];
        memcpy(option, error->field, sizeof option);
        snprintf(error->field, sizeof error->field, "--to-%.80s", option);
    }
    if (!failure || strcmp(failure->code, "not_written") == 0)
        raise_error(error, NULL);
    else
        raise_failure(findings, error, r->name, "the model");
}

/* write_log(record, path, decimals, origin, settings, threads, progress) -> (findings, rows)
 * decimals  digits after the point; negative: as many as a number needs
 * origin    time from which those of arrays count [ns] */
static PyObject *write_log(PyObject *module, PyObject *args)
{
    PyObject *object, *dictionary, *progress, *made = NULL;
    int threads;
    imk_convert_log_settings s = imk_convert_log_default();
    imk_log_sink written = {.path = NULL};
    long long origin;
    imk_findings findings = {.count = 0};
    work w;
    (void)module;
    if (!PyArg_ParseTuple(args, "OsiLO!iO", &object, &written.path, &written.decimals, &origin,
                          &PyDict_Type, &dictionary, &threads, &progress) ||
        !SETTINGS_READ(dictionary, write_rows, &s))
        return NULL;
    written.fixed = written.decimals >= 0;
    record *r = record_begin(object);
    if (r && work_begin(&w, threads, progress)) {
        imk_error error;
        written.origin = r->reader ? r->source.findings(r->source.context).time_origin_nanoseconds
                                   : (int64_t)origin;
        const imk_record_sink sink = imk_log_sink_of(&written);
        imk_status status = imk_convert_log_run(&r->source, &s, &sink, &w.job, &findings, &error);
        const imk_status ended = imk_log_sink_end(&written, status, &error);
        const bool done = work_end(&w);
        if (done && status == IMK_OK && ended != IMK_OK)
            raise_error(&error, NULL);
        else if (done && status != IMK_OK)
            raise_unwritten(&findings, &error, r);
        PyObject *list = PyErr_Occurred() ? NULL : list_findings(&findings, r->name, "the model");
        made = list ? Py_BuildValue("(NK)", list, (unsigned long long)written.rows) : NULL;
    }
    if (r)
        record_end(r);
    return made;
}

PyMethodDef compensate_functions[] = {
    {"compensate", compensate, METH_VARARGS,
     "compensate(record, model, terms, name, settings, threads, progress)."},
    {"convert", convert, METH_VARARGS, "convert(record, settings, threads, progress)."},
    {"write_log", write_log, METH_VARARGS,
     "write_log(record, path, decimals, origin, settings, threads, progress)."},
    {NULL, NULL, 0, NULL}};
