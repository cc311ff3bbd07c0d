/* SPDX-License-Identifier: Apache-2.0 */
/* The noise that makes a filter consistent on motions. */
#include "extension_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct asked {
    imk_tune_model_settings s;
    double rate; /* 0: not stated */
    uint64_t runs;
} asked;

#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(asked, s.tuning.field), words                                       \
    }
static const setting rows[] = {
    {"rate", SETTING_QUANTITY, offsetof(asked, rate), "Hz"},
    ROW(from, SETTING_QUANTITY, "s"),
    ROW(to, SETTING_QUANTITY, "s"),
    {"windows", SETTING_SIZE, offsetof(asked, s.tuning.window_count), NULL},
    {"gyro_bias", SETTING_QUANTITY, offsetof(asked, s.tuning.bias_sigma[0]), "rad/s"},
    {"accel_bias", SETTING_QUANTITY, offsetof(asked, s.tuning.bias_sigma[1]), "m/s^2"},
    ROW(bias_time, SETTING_QUANTITY, "s"),
    ROW(correlation_time, SETTING_QUANTITY, "s"),
    ROW(learned, SETTING_FLAG, NULL),
    ROW(compensated, SETTING_FLAG, NULL),
    ROW(per_axis, SETTING_FLAG, NULL),
    {"runs", SETTING_COUNT, offsetof(asked, runs), NULL},
    {"seed", SETTING_COUNT, offsetof(asked, s.seed), NULL},
};
#undef ROW

/* One tuning. */
typedef struct tuning {
    asked a;
    model_list list;
    imk_tune_model *r;
    PyObject *findings;
} tuning;

static bool take_motions(tuning *t, PyObject *motions)
{
    imk_filter_tuning_settings *s = &t->a.s.tuning;
    const Py_ssize_t count = PyTuple_Size(motions);
    imk_error error;
    if (count < 1 || count > IMK_TUNING_MOTIONS_MAX) {
        PyErr_Format(PyExc_ValueError, "motions: expected 1 to %d, and there are %zd",
                     IMK_TUNING_MOTIONS_MAX, count);
        return false;
    }
    for (Py_ssize_t m = 0; m < count; m++) {
        motion_use use;
        if (!motion_take(PyTuple_GetItem(motions, m), &use))
            return false;
        const double length = imk_motion_file_duration(use.file);
        s->motion[m] = *imk_motion_file_motion(use.file);
        s->duration[m] = isinf(length) ? 0.0 : length;
        t->a.s.motion[m] = use.name;
    }
    s->motion_count = (size_t)count;
    if (imk_tune_model_rate(t->a.rate, s, &error) == IMK_OK)
        return true;
    raise_error(&error, error.index >= 0 ? t->a.s.motion[error.index] : NULL);
    return false;
}

/* A filter of attitude, velocity and position needs both kinds of sensors. */
static bool check_model(const tuning *t)
{
    imk_error error;
    for (int sensor = 0; sensor < 2; sensor++) {
        if (imk_model_triad(t->list.given[0], sensor)->present)
            continue;
        (void)imk_error_set(&error, IMK_ERROR_UNSUPPORTED, "",
                            sensor == IMK_GYRO ? "the model has no gyros"
                                               : "the model has no accelerometers",
                            "gyros and accelerometers");
        raise_error(&error, t->list.name[0]);
        return false;
    }
    return true;
}

/* ---- what is given back ---- */

static bool tell_unstated(const tuning *t)
{
    imk_unstated unstated;
    char names[600] = "";
    size_t used = 0;
    imk_tune_model_unstated(t->list.given[0], &unstated);
    if (t->list.terms.assume || unstated.count == 0)
        return true;
    for (size_t i = 0; i < unstated.count && used < sizeof names; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", used > 0 ? ", " : "",
                                 unstated.term[i].text);
    return add_finding(t->findings, IMK_FINDING_WARNING, "unstated",
                       "%s does not state %s: here that is zero, and the noise found is too small "
                       "if the unit has it. assume_class='own' takes typical values",
                       t->list.name[0], names);
}

static bool tell(const tuning *t)
{
    const imk_filter_tuning *found = t->r->tuning;
    char text[600];
    bool good = tell_unstated(t);
    for (size_t i = 0; i < found->omitted_count && good; i++)
        good = add_finding(t->findings, IMK_FINDING_WARNING, "left_out",
                           "%s is left out of the prediction", found->omitted[i]);
    imk_tune_verdict(t->r, text, sizeof text);
    return good &&
           (!*text || add_finding(t->findings, IMK_FINDING_WARNING, "inconstant", "%s", text));
}

/* The texts of model files that state the numbers of the answers; None where there is none. */
static PyObject *list_answers(const tuning *t)
{
    imk_model *model = PyMem_Malloc(sizeof *model);
    PyObject *list = model ? PyList_New(0) : PyErr_NoMemory();
    imk_error error;
    for (int kind = 0; list && kind < IMK_FILTER_ANSWERS; kind++) {
        PyObject *text =
            imk_tune_model_answer(t->r, (imk_filter_answer_kind)kind, model, &error) == IMK_OK
                ? model_text_of(model)
                : Py_NewRef(Py_None);
        if (!text || PyList_Append(list, text) != 0)
            Py_CLEAR(list);
        Py_XDECREF(text);
    }
    PyMem_Free(model);
    return list;
}

static PyObject *give(const tuning *t)
{
    imk_result *result = tell(t) ? begin_result("tune") : NULL;
    if (!result)
        return NULL;
    imk_show_tune(t->r, t->list.assumed, result);
    page_models(&t->list, result);
    PyObject *shown = make_result(result), *answers = shown ? list_answers(t) : NULL;
    if (answers)
        return Py_BuildValue("(NON)", shown, t->findings, answers);
    Py_XDECREF(shown);
    return NULL;
}

static PyObject *run(tuning *t, int threads, PyObject *progress)
{
    work w;
    imk_error error;
    if (!work_begin(&w, threads, progress))
        return NULL;
    const imk_status status =
        imk_tune_model_run(t->list.model[0], t->list.name[0], &t->a.s, &w.job, &t->r, &error);
    if (work_end(&w) && status != IMK_OK)
        raise_error(&error, strcmp(error.field, "motion") == 0 && error.index >= 0
                                ? t->a.s.motion[error.index]
                                : NULL);
    return PyErr_Occurred() ? NULL : give(t);
}

/* tune(models, terms, motions, settings, threads, progress) -> (result, findings, answers) */
static PyObject *tune(PyObject *module, PyObject *args)
{
    PyObject *pairs, *tuple, *motions, *dictionary, *progress, *made = NULL;
    int threads;
    model_terms terms;
    tuning t = {.a = {.s = imk_tune_model_default()}};
    (void)module;
    if (!PyArg_ParseTuple(args, "O!O!O!O!iO", &PyTuple_Type, &pairs, &PyTuple_Type, &tuple,
                          &PyTuple_Type, &motions, &PyDict_Type, &dictionary, &threads,
                          &progress) ||
        !SETTINGS_READ(dictionary, rows, &t.a) || !terms_take(tuple, &terms))
        return NULL;
    if (t.a.runs > UINT32_MAX) {
        PyErr_SetString(PyExc_ValueError, "runs: expected at most 4294967295");
        return NULL;
    }
    t.a.s.run_count = (uint32_t)t.a.runs;
    t.findings = PyList_New(0);
    if (t.findings && models_take(pairs, &terms, &t.list) && check_model(&t) &&
        take_motions(&t, motions))
        made = run(&t, threads, progress);
    imk_tune_model_free(t.r);
    models_free(&t.list);
    Py_XDECREF(t.findings);
    return made;
}

PyMethodDef tune_functions[] = {
    {"tune", tune, METH_VARARGS,
     "tune(models, terms, motions, settings, threads, progress): noise of a filter."},
    {NULL, NULL, 0, NULL}};
