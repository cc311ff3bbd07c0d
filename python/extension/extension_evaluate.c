/* SPDX-License-Identifier: Apache-2.0 */
/* Evaluation of references and readings. */
#include "extension_scene.h"

#include "imukit/evaluate_log.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const setting evaluate_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_evaluate_log_settings, field), words                            \
    }
    ROW(confidence, SETTING_NUMBER, NULL), ROW(minimum, SETTING_QUANTITY, "s"),
    ROW(trim, SETTING_QUANTITY, "s"),      ROW(settle, SETTING_QUANTITY, "s"),
    ROW(sections, SETTING_FLAG, NULL),     ROW(keep_delay, SETTING_FLAG, NULL),
#undef ROW
};

/* What is said of the unit, and how it is shown. */
typedef struct sheet {
    const char *unit, *serial, *operator_name, *laboratory, *date, *temperature, *limit;
    bool levels;
    imk_gap_policy gaps;
} sheet;

static const setting sheet_rows[] = {
    {"unit", SETTING_TEXT, offsetof(sheet, unit), NULL},
    {"serial", SETTING_TEXT, offsetof(sheet, serial), NULL},
    {"operator", SETTING_TEXT, offsetof(sheet, operator_name), NULL},
    {"laboratory", SETTING_TEXT, offsetof(sheet, laboratory), NULL},
    {"date", SETTING_TEXT, offsetof(sheet, date), NULL},
    {"at_temperature", SETTING_TEXT, offsetof(sheet, temperature), NULL},
    {"limit", SETTING_TEXT, offsetof(sheet, limit), NULL},
    {"levels", SETTING_FLAG, offsetof(sheet, levels), NULL},
    {"gaps", SETTING_CHOICE, offsetof(sheet, gaps), "refuse|bridge|longest"},
};

typedef struct evaluation {
    imk_evaluate_log_settings settings;
    imk_calibrate_log_settings reading;
    sheet sheet;
    size_t count, limit_count, missed, failed;
    record *record[IMK_EVALUATION_RUNS_MAX], *rest;
    const char *name[IMK_EVALUATION_RUNS_MAX];
    imk_evaluate_limit limit[IMK_EVALUATE_LIMITS];
    motion_use motion;
    PyObject *findings;
    imk_evaluate_log *log;
} evaluation;

static bool records_take(evaluation *v, PyObject *records, PyObject *rest)
{
    const Py_ssize_t count = PyTuple_Size(records);
    if (count > IMK_EVALUATION_RUNS_MAX || (count == 0 && rest == Py_None)) {
        PyErr_Format(PyExc_ValueError, "%zd records: expected 1 to %d, or static", count,
                     (int)IMK_EVALUATION_RUNS_MAX);
        return false;
    }
    for (; v->count < (size_t)count; v->count++) {
        v->record[v->count] = record_begin(PyTuple_GetItem(records, (Py_ssize_t)v->count));
        if (!v->record[v->count])
            return false;
        v->name[v->count] = v->record[v->count]->name;
    }
    if (rest != Py_None)
        v->rest = record_begin(rest);
    return rest == Py_None || v->rest;
}

static void evaluation_free(evaluation *v)
{
    for (size_t k = 0; k < v->count; k++)
        record_end(v->record[k]);
    if (v->rest)
        record_end(v->rest);
    imk_evaluate_log_free(v->log);
    Py_XDECREF(v->findings);
    PyMem_Free(v);
}

static imk_status evaluation_work(evaluation *v, const imk_job *job, imk_error *error)
{
    if (v->motion.file)
        v->reading.motion = imk_motion_file_motion(v->motion.file);
    imk_status status = imk_evaluate_log_create(&v->settings, job, &v->log, error);
    for (v->failed = 0; status == IMK_OK && v->failed < v->count; v->failed++) {
        const record *r = v->record[v->failed];
        status = imk_evaluate_source(v->log, r->name, &r->source, &v->reading, job, error);
        if (status != IMK_OK)
            return status;
    }
    if (status == IMK_OK && v->rest)
        status = imk_evaluate_rest_source(v->log, &v->rest->source, v->sheet.gaps, job, error);
    return status;
}

/* A quantity of the dictionary in the dimension of a unit, above 0 but for zero; untouched where it
 * is None. */
static bool positive(PyObject *dictionary, const char *name, const char *unit, double *value)
{
    PyObject *object = PyDict_GetItemString(dictionary, name);
    double found;
    if (!object || object == Py_None)
        return true;
    if (!quantity_read(object, name, unit, &found))
        return false;
    if (!(found > 0) && strcmp(name, "zero") != 0) {
        PyErr_Format(PyExc_ValueError, "%s=%S: expected a quantity above 0", name, object);
        return false;
    }
    *value = found;
    return true;
}

static bool is_given(PyObject *dictionary, const char *name)
{
    PyObject *object = PyDict_GetItemString(dictionary, name);
    return object && object != Py_None;
}

static bool in_counts(const imk_evaluate_channel *c)
{
    return imk_dimension_equal(c->reading_unit.dimension, imk_unit_of("count").dimension);
}

static bool channel_run(evaluation *v, imk_evaluate_channel *c, PyObject *quantities)
{
    char unit[80];
    double sensitivity = 0, zero = 0;
    imk_error error;
    snprintf(unit, sizeof unit, "count/(%.60s)", c->reference_unit.text);
    if (is_given(quantities, "sensitivity") && in_counts(c)) {
        if (!positive(quantities, "sensitivity", unit, &sensitivity) ||
            !positive(quantities, "zero", "count", &zero))
            return false;
        imk_evaluate_scale(c, sensitivity, zero);
    }
    imk_evaluate_channel_settings(v->log, c);
    if (!positive(quantities, "full_scale", c->reference_unit.text, &c->settings.full_scale) ||
        !positive(quantities, "level_width", c->reference_unit.text, &c->settings.level_width))
        return false;
    if (imk_evaluate_channel_run(v->log, c, &error) == IMK_OK)
        return true;
    raise_error(&error, c->name);
    return false;
}

static bool channels_run(evaluation *v, PyObject *quantities)
{
    bool good = true, counts = false;
    for (size_t k = 0; k < v->log->channel_count; k++)
        counts = counts || in_counts(&v->log->channel[k]);
    if (is_given(quantities, "sensitivity") ? !counts : is_given(quantities, "zero")) {
        PyErr_SetString(PyExc_ValueError,
                        "sensitivity is for readings in counts, and zero goes with it");
        return false;
    }
    for (size_t k = 0; good && k < v->log->channel_count; k++)
        good = channel_run(v, &v->log->channel[k], quantities);
    return good;
}

static bool tell_missed(evaluation *v, const char *name, const imk_evaluate_sheet *sheet)
{
    char text[400];
    bool good = true;
    for (size_t i = 0; good && i < sheet->count; i++)
        if (imk_evaluate_missed(&sheet->row[i])) {
            imk_evaluate_missed_text(name, &sheet->row[i], text, sizeof text);
            good = add_finding(v->findings, IMK_FINDING_WARNING, "limit", "%s", text);
        }
    return good;
}

static bool check_limits(evaluation *v)
{
    imk_error error;
    bool good = true;
    if (imk_evaluate_limits_check(v->log, v->limit_count, v->limit, &v->missed, &error) != IMK_OK) {
        const imk_evaluate_limit *limit = &v->limit[error.index];
        error.index = -1;
        raise_error(&error, limit->refused_by[0] ? limit->key : "limit");
        return false;
    }
    for (size_t k = 0; good && k < v->log->channel_count; k++)
        good = tell_missed(v, v->log->channel[k].name, &v->log->channel[k].sheet);
    for (size_t k = 0; good && k < v->log->rest_count; k++)
        good = tell_missed(v, v->log->rest[k].name, &v->log->rest[k].sheet);
    return good;
}

static PyObject *evaluation_show(evaluation *v)
{
    const imk_evaluate_log *log = v->log;
    const sheet *s = &v->sheet;
    imk_result *result = begin_result("evaluate");
    if (!result)
        return NULL;
    const imk_evaluate_shown shown = {.confidence = v->settings.confidence,
                                      .path_count = v->count,
                                      .path = v->name,
                                      .rest_path = v->rest ? v->rest->name : NULL,
                                      .unit = s->unit,
                                      .serial = s->serial,
                                      .operator_name = s->operator_name,
                                      .laboratory = s->laboratory,
                                      .date = s->date,
                                      .temperature = s->temperature,
                                      .levels = s->levels,
                                      .missed = v->missed > 0,
                                      .channel_count = log->channel_count,
                                      .rest_count = log->rest_count,
                                      .limit_count = v->limit_count,
                                      .channel = log->channel,
                                      .rest = log->rest,
                                      .findings = &log->findings};
    imk_show_evaluate(&shown, result);
    PyObject *object = make_result(result);
    return object ? Py_BuildValue("(NO)", object, v->findings) : NULL;
}

static PyObject *finish(evaluation *v, PyObject *quantities)
{
    const char *name = v->count == 1              ? v->name[0]
                       : v->count == 0 && v->rest ? v->rest->name
                                                  : "the records";
    PyObject *list = list_findings(&v->log->findings, name, "the model");
    const Py_ssize_t end = PyList_Size(v->findings);
    const bool good = list && PyList_SetSlice(v->findings, end, end, list) == 0;
    Py_XDECREF(list);
    imk_error error;
    if (good && imk_evaluate_check_used(v->log, &v->reading, &error) != IMK_OK)
        return raise_error(&error, NULL);
    return good && channels_run(v, quantities) && check_limits(v) ? evaluation_show(v) : NULL;
}

static bool settings_take(evaluation *v, PyObject *settings, PyObject *reading, PyObject *shown)
{
    imk_error error;
    v->settings = imk_evaluate_log_default();
    if (!SETTINGS_READ(settings, evaluate_rows, &v->settings) ||
        !calibrate_settings_read(reading, Py_None, &v->reading) ||
        !SETTINGS_READ(shown, sheet_rows, &v->sheet))
        return false;
    v->reading.activity = false;
    if (imk_evaluate_limits_parse(v->sheet.limit, v->limit, &v->limit_count, &error) == IMK_OK)
        return true;
    raise_error(&error, NULL);
    return false;
}

/* evaluate(records, rest, settings, reading, quantities, sheet, motion, progress)
 * -> (result, findings) */
static PyObject *evaluate(PyObject *module, PyObject *args)
{
    PyObject *records, *rest, *settings, *reading, *quantities, *shown, *motion, *progress,
        *made = NULL;
    work w;
    (void)module;
    if (!PyArg_ParseTuple(args, "O!OO!O!O!O!OO", &PyTuple_Type, &records, &rest, &PyDict_Type,
                          &settings, &PyDict_Type, &reading, &PyDict_Type, &quantities,
                          &PyDict_Type, &shown, &motion, &progress))
        return NULL;
    evaluation *v = PyMem_Calloc(1, sizeof *v);
    if (!v)
        return PyErr_NoMemory();
    v->findings = PyList_New(0);
    bool good =
        v->findings && settings_take(v, settings, reading, shown) && records_take(v, records, rest);
    if (good && motion != Py_None)
        good = motion_take(motion, &v->motion);
    if (good && work_begin(&w, 1, progress)) {
        imk_error error;
        const imk_status status = evaluation_work(v, &w.job, &error);
        const record *r = v->failed < v->count ? v->record[v->failed] : v->rest;
        if (work_end(&w) && status != IMK_OK)
            raise_failure(v->log ? &v->log->findings : NULL, &error, r ? r->name : NULL,
                          "the model");
        made = PyErr_Occurred() ? NULL : finish(v, quantities);
    }
    evaluation_free(v);
    return made;
}

/* is_table(record): has it the columns of a table of readings? */
static PyObject *is_table(PyObject *module, PyObject *object)
{
    (void)module;
    record *r = record_begin(object);
    if (!r)
        return NULL;
    record_end(r);
    return PyBool_FromLong(imk_evaluate_is_table(r->source.column_count, r->source.columns));
}

PyMethodDef evaluate_functions[] = {
    {"is_table", is_table, METH_O, "is_table(record): is it a table of readings?"},
    {"evaluate", evaluate, METH_VARARGS,
     "evaluate(records, rest, settings, reading, quantities, sheet, motion, progress): figures of "
     "a "
     "test."},
    {NULL, NULL, 0, NULL}};
