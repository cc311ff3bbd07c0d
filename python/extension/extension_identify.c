/* SPDX-License-Identifier: Apache-2.0 */
/* Identification of the noise of a record, of a curve, or of several records together; and how long
 * to record. */
#include "extension.h"

#include "imukit/identify_curve.h"
#include "imukit/show.h"
#include "imukit/utf8.h"

#include <stdlib.h>
#include <string.h>

static const setting identify_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_identify_log_settings, field), words                            \
    }
    ROW(gaps, SETTING_CHOICE, "refuse|bridge|longest|keep"),
    ROW(confidence, SETTING_NUMBER, NULL),
    ROW(significance, SETTING_NUMBER, NULL),
    ROW(take_out, SETTING_INT, NULL),
    ROW(from_allan, SETTING_FLAG, NULL),
    ROW(tolerance, SETTING_NUMBER, NULL),
    ROW(gauss_markov_max, SETTING_INT, NULL),
#undef ROW
};

static const setting curve_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_identify_curve_settings, field), words                          \
    }
    ROW(rate, SETTING_QUANTITY, "Hz"),     ROW(duration, SETTING_QUANTITY, "s"),
    ROW(confidence, SETTING_NUMBER, NULL), ROW(significance, SETTING_NUMBER, NULL),
    ROW(tolerance, SETTING_NUMBER, NULL),  ROW(gauss_markov_max, SETTING_INT, NULL),
    ROW(plain, SETTING_FLAG, NULL),
#undef ROW
};

static const setting plan_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_record_plan_settings, field), words                             \
    }
    ROW(rate, SETTING_QUANTITY, "Hz"),       ROW(duration, SETTING_QUANTITY, "s"),
    ROW(significance, SETTING_NUMBER, NULL), ROW(want, SETTING_TEXT, NULL),
    ROW(curve, SETTING_FLAG, NULL),
#undef ROW
};

/* ---- the model, its twin, and what it is compared with ----------------------------------------
 */

typedef struct ending {
    const char *source, *name; /* of the record in the evidence; of the model, NULL: as it is */
    bool twin, verbose;
    uint64_t seed;
    model_object *truth, *into;                 /* borrowed; NULL: none */
    imk_model model;                            /* of what was identified */
    imk_allan_curve curve[IMK_LOG_COLUMNS_MAX]; /* of the twin */
} ending;

static const setting ending_rows[] = {
    {"source", SETTING_TEXT, offsetof(ending, source), NULL},
    {"name", SETTING_TEXT, offsetof(ending, name), NULL},
    {"twin", SETTING_FLAG, offsetof(ending, twin), NULL},
    {"seed", SETTING_COUNT, offsetof(ending, seed), NULL},
    {"verbose", SETTING_FLAG, offsetof(ending, verbose), NULL},
};

/* Read the settings; false with an exception. NULL for `e` is an exception, too. */
static bool ending_read(ending *e, PyObject *dictionary, PyObject *truth, PyObject *into)
{
    if (!e) {
        PyErr_NoMemory();
        return false;
    }
    e->source = "record";
    e->seed = 1;
    if (!SETTINGS_READ(dictionary, ending_rows, e))
        return false;
    e->truth = truth == Py_None ? NULL : model_of(truth);
    e->into = into == Py_None ? NULL : model_of(into);
    return !PyErr_Occurred();
}

/* The part of the work that needs no lock. */
static imk_status ending_work(ending *e, const imk_identify_log *log, const imk_job *job,
                              imk_error *error)
{
    imk_identify_log_model(log, e->source, &e->model);
    if (!e->twin || (!e->model.gyro.present && !e->model.accel.present))
        return IMK_OK;
    return imk_identify_log_twin(log, &e->model, e->seed, job, e->curve, error);
}

static void ending_free(ending *e)
{
    for (size_t c = 0; e && c < IMK_LOG_COLUMNS_MAX; c++)
        imk_allan_curve_free(&e->curve[c], &(imk_allocator){0});
    PyMem_Free(e);
}

/* The text of the model, or of the one that it goes into; None where nothing is a sensor. */
static PyObject *ending_model(ending *e)
{
    char *text = NULL;
    size_t size = 0;
    imk_error error;
    imk_status status = IMK_OK;
    if (!e->model.gyro.present && !e->model.accel.present)
        return Py_NewRef(Py_None);
    imk_model *model = PyMem_Malloc(sizeof *model);
    if (!model)
        return PyErr_NoMemory();
    *model = e->into ? e->into->model : e->model;
    if (e->into)
        status = imk_model_take_noise(model, &e->model, &error);
    if (e->name)
        imk_utf8_clean(e->name, model->name, sizeof model->name);
    if (status == IMK_OK)
        status = imk_model_print(model, e->into ? e->into->document : NULL, &text, &size, &error);
    PyObject *made =
        status == IMK_OK ? PyUnicode_DecodeUTF8(text, (Py_ssize_t)size, "replace") : NULL;
    if (status != IMK_OK)
        raise_error(&error, "into");
    free(text);
    PyMem_Free(model);
    return made;
}

static imk_identify_shown ending_shown(const ending *e, const imk_identify_log *log,
                                       const char *name, imk_verdict verdict)
{
    const bool drawn = e->twin && (e->model.gyro.present || e->model.accel.present);
    return (imk_identify_shown){.log = log,
                                .name = name,
                                .verdict = verdict,
                                .verbose = e->verbose,
                                .truth = e->truth ? &e->truth->model : NULL,
                                .twin = drawn ? e->curve : NULL};
}

/* ---- one record -------------------------------------------------------------------------------
 */

static PyObject *show(ending *e, const imk_identify_log *log, const record *r)
{
    imk_result *result = begin_result("identify");
    if (!result)
        return NULL;
    const imk_identify_shown shown =
        ending_shown(e, log, r->name, imk_identify_verdict(log, NULL, result));
    imk_show_identify_log(&shown, result);
    return extended(result_with(result, &log->findings, r->name, "the model"), ending_model(e));
}

typedef struct request {
    bool of_curve;
    imk_identify_log_settings log;
    imk_identify_curve_settings curve;
} request;

static bool request_read(request *q, int of_curve, PyObject *dictionary)
{
    *q = (request){.of_curve = of_curve != 0,
                   .log = imk_identify_log_default(),
                   .curve = imk_identify_curve_default()};
    return q->of_curve ? SETTINGS_READ(dictionary, curve_rows, &q->curve)
                       : SETTINGS_READ(dictionary, identify_rows, &q->log);
}

static imk_status request_run(const request *q, const imk_record_source *source, const imk_job *job,
                              imk_identify_log **log, imk_error *error)
{
    return q->of_curve ? imk_identify_curve_run(source, &q->curve, job, log, error)
                       : imk_identify_log_run(source, &q->log, job, log, error);
}

/* identify(record, of_curve, settings, ending, truth, into, threads, progress)
 * -> (result, findings, model) */
static PyObject *identify(PyObject *module, PyObject *args)
{
    PyObject *object, *settings, *dictionary, *truth, *into, *progress, *made = NULL;
    int threads, of_curve;
    request q;
    work w;
    (void)module;
    if (!PyArg_ParseTuple(args, "OpO!O!OOiO", &object, &of_curve, &PyDict_Type, &settings,
                          &PyDict_Type, &dictionary, &truth, &into, &threads, &progress) ||
        !request_read(&q, of_curve, settings))
        return NULL;
    ending *e = PyMem_Calloc(1, sizeof *e);
    record *r = ending_read(e, dictionary, truth, into) ? record_begin(object) : NULL;
    if (r && work_begin(&w, threads, progress)) {
        imk_identify_log *log = NULL;
        imk_error error;
        imk_status status = request_run(&q, &r->source, &w.job, &log, &error);
        const bool found = status == IMK_OK;
        if (found)
            status = ending_work(e, log, &w.job, &error);
        if (work_end(&w) && status != IMK_OK)
            raise_failure(!found && log ? &log->findings : NULL, &error, r->name, "the model");
        made = PyErr_Occurred() ? NULL : show(e, log, r);
        imk_identify_log_free(log);
    }
    if (r)
        record_end(r);
    ending_free(e);
    return made;
}

/* ---- several records --------------------------------------------------------------------------
 */

typedef struct several {
    bool runs;
    size_t count, failed;
    record *record[IMK_JOINT_RECORDS_MAX];
    const char *label[IMK_JOINT_RECORDS_MAX];
    imk_identify_log *log[IMK_JOINT_RECORDS_MAX];
    imk_identify_several *joint;
} several;

static bool several_begin(several *s, PyObject *records)
{
    const Py_ssize_t count = PyTuple_Size(records);
    if (count < 2 || count > IMK_JOINT_RECORDS_MAX) {
        PyErr_Format(PyExc_ValueError, "%zd records: expected 2 to %d", count,
                     (int)IMK_JOINT_RECORDS_MAX);
        return false;
    }
    for (; s->count < (size_t)count; s->count++) {
        record *r = record_begin(PyTuple_GetItem(records, (Py_ssize_t)s->count));
        if (!r)
            return false;
        s->record[s->count] = r;
        s->label[s->count] = r->name;
    }
    return true;
}

static void several_free(several *s)
{
    for (size_t k = 0; s && k < s->count; k++) {
        record_end(s->record[k]);
        imk_identify_log_free(s->log[k]);
    }
    if (s)
        imk_identify_several_free(s->joint);
    PyMem_Free(s);
}

static imk_status several_work(several *s, const imk_identify_log_settings *settings,
                               const imk_job *job, imk_error *error)
{
    const imk_identify_log *const *logs = (const imk_identify_log *const *)s->log;
    imk_status status = IMK_OK;
    for (s->failed = 0; s->failed < s->count; s->failed++) {
        imk_identify_log **log = &s->log[s->failed];
        status = imk_identify_log_run(&s->record[s->failed]->source, settings, job, log, error);
        if (status != IMK_OK)
            return status;
        imk_identify_log_let_samples_go(*log);
        status = imk_identify_comparable(s->log[0], *log, false, error);
        if (status != IMK_OK)
            return status;
    }
    status = s->runs ? imk_identify_runs(s->count, logs, job, &s->joint, error)
                     : imk_identify_devices(s->count, logs, job, &s->joint, error);
    if (status != IMK_OK && error->index >= 0 && (size_t)error->index < s->count)
        s->failed = (size_t)error->index;
    return status;
}

/* Findings of all records; false with an exception. */
static bool add_findings(PyObject *made, const several *s)
{
    PyObject *findings = made ? PyTuple_GetItem(made, 1) : NULL;
    for (size_t k = 0; findings && k < s->count; k++) {
        PyObject *more = list_findings(&s->log[k]->findings, s->label[k], "the model");
        const Py_ssize_t end = PyList_Size(findings);
        if (!more || PyList_SetSlice(findings, end, end, more) != 0)
            findings = NULL;
        Py_XDECREF(more);
    }
    return findings != NULL;
}

static PyObject *several_show(several *s, ending *e, const char *name)
{
    imk_identify_shown *shown = PyMem_Calloc(s->count, sizeof *shown);
    imk_result *result = shown ? begin_result("identify") : NULL;
    if (!result) {
        PyMem_Free(shown);
        return PyErr_Occurred() ? NULL : PyErr_NoMemory();
    }
    for (size_t k = 0; k < s->count; k++)
        shown[k] =
            (imk_identify_shown){.log = s->log[k],
                                 .name = s->label[k],
                                 .label = s->label[k],
                                 .verdict = imk_identify_verdict(s->log[k], s->label[k], result)};
    const imk_identify_shown joint =
        ending_shown(e, &s->joint->joint, name, imk_several_verdict(s->joint, s->label, result));
    imk_show_identify_several(s->joint, &joint, shown, result);
    PyMem_Free(shown);
    PyObject *made = result_with(result, &s->joint->joint.findings, name, "the model");
    if (!add_findings(made, s))
        Py_CLEAR(made);
    return extended(made, !made ? NULL : s->runs ? ending_model(e) : Py_NewRef(Py_None));
}

/* What failed: of one record, or of all. */
static void several_raise(const several *s, const imk_error *error, const char *name)
{
    const bool one = s->failed < s->count;
    const imk_identify_log *log = one ? s->log[s->failed] : NULL;
    raise_failure(log ? &log->findings : NULL, error, one ? s->label[s->failed] : name,
                  "the model");
}

/* identify_several(records, runs, settings, ending, truth, into, threads, progress)
 * -> (result, findings, model) */
static PyObject *identify_several(PyObject *module, PyObject *args)
{
    PyObject *records, *settings, *dictionary, *truth, *into, *progress, *made = NULL;
    int threads, runs;
    imk_identify_log_settings s = imk_identify_log_default();
    work w;
    (void)module;
    if (!PyArg_ParseTuple(args, "O!pO!O!OOiO", &PyTuple_Type, &records, &runs, &PyDict_Type,
                          &settings, &PyDict_Type, &dictionary, &truth, &into, &threads,
                          &progress) ||
        !SETTINGS_READ(settings, identify_rows, &s))
        return NULL;
    s.summarise = runs;
    ending *e = PyMem_Calloc(1, sizeof *e);
    several *all = PyMem_Calloc(1, sizeof *all);
    if (!all)
        PyErr_NoMemory();
    else
        all->runs = runs;
    if (ending_read(e, dictionary, truth, into) && all && several_begin(all, records) &&
        work_begin(&w, threads, progress)) {
        imk_error error;
        imk_status status = several_work(all, &s, &w.job, &error);
        const bool found = status == IMK_OK;
        if (found && runs)
            status = ending_work(e, &all->joint->joint, &w.job, &error);
        if (work_end(&w) && status != IMK_OK)
            found ? (void)raise_error(&error, e->source) : several_raise(all, &error, e->source);
        made = PyErr_Occurred() ? NULL : several_show(all, e, e->source);
    }
    several_free(all);
    ending_free(e);
    return made;
}

/* ---- how long to record -----------------------------------------------------------------------
 */

/* plan_record(model, name, settings) -> (result, findings, duration, met) */
static PyObject *plan_record(PyObject *module, PyObject *args)
{
    PyObject *object, *settings, *made = NULL;
    const char *name;
    imk_record_plan_settings s = imk_record_plan_default();
    imk_record_plan *plan = NULL;
    imk_error error;
    (void)module;
    if (!PyArg_ParseTuple(args, "OsO!", &object, &name, &PyDict_Type, &settings) ||
        !SETTINGS_READ(settings, plan_rows, &s))
        return NULL;
    const model_object *m = model_of(object);
    if (!m)
        return NULL;
    const imk_status status = imk_record_plan_run(&m->model, &s, NULL, &plan, &error);
    imk_result *shown = NULL;
    if (status != IMK_OK)
        raise_failure(plan ? &plan->findings : NULL, &error, name, name);
    else if ((shown = begin_result("identify")) != NULL) {
        imk_show_record_plan(plan, name, shown);
        made = extended(result_with(shown, &plan->findings, name, name),
                        PyFloat_FromDouble(plan->duration));
        made = extended(made, made ? PyBool_FromLong(plan->met) : NULL);
    }
    imk_record_plan_free(plan, &(imk_allocator){0});
    return made;
}

PyMethodDef identify_functions[] = {
    {"identify", identify, METH_VARARGS,
     "identify(record, of_curve, settings, ending, truth, into, threads, progress): noise of a "
     "record at rest."},
    {"identify_several", identify_several, METH_VARARGS,
     "identify_several(records, runs, settings, ending, truth, into, threads, progress): noise of "
     "several."},
    {"plan_record", plan_record, METH_VARARGS,
     "plan_record(model, name, settings): how long to record."},
    {NULL, NULL, 0, NULL}};

bool add_identify(PyObject *module)
{
    return PyModule_AddIntConstant(module, "SCREEN_OUTLIERS", IMK_SCREEN_OUTLIERS) == 0 &&
           PyModule_AddIntConstant(module, "SCREEN_STUCK", IMK_SCREEN_STUCK) == 0 &&
           PyModule_AddIntConstant(module, "SCREEN_SATURATED", IMK_SCREEN_SATURATED) == 0 &&
           PyModule_AddIntConstant(module, "SCREEN_WARM_UP", IMK_SCREEN_WARM_UP) == 0 &&
           PyModule_AddIntConstant(module, "SCREEN_TEMPERATURE", IMK_SCREEN_TEMPERATURE) == 0 &&
           PyModule_AddIntConstant(module, "SCREEN_ALL", IMK_SCREEN_ALL) == 0;
}
